// SPDX-License-Identifier: GPL-3.0-or-later
// The subcommands. Each adds itself to the command line and, when it was asked for, runs and
// returns the exit status: 0 all agree (or done), 1 a disagreement was found. Bad input is thrown.
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

namespace dynwitness::cli {

using Run = std::function<int()>;

inline constexpr const char* kAuditDescription =
    "H. Bruyninckx, Dynamics of robots (2005), equation by equation: what holds";
inline constexpr const char* kGrowthDescription =
    "Measure time, memory and digits against the number of links";

Run addCrosscheck(CLI::App& app);
Run addCheck(CLI::App& app);
Run addGolden(CLI::App& app);
Run addGrade(CLI::App& app);
Run addMuseum(CLI::App& app);
Run addDerive(CLI::App& app);
Run addEvaluate(CLI::App& app);
Run addDrift(CLI::App& app);
Run addSimulate(CLI::App& app);
Run addRotors(CLI::App& app);
Run addChart(CLI::App& app);
Run addGrowth(CLI::App& app);
Run addAudit(CLI::App& app);
Run addParameters(CLI::App& app);
Run addReaders(CLI::App& app);
Run addSame(CLI::App& app);
Run addGeometry(CLI::App& app);
Run addAction(CLI::App& app);
Run addImpulse(CLI::App& app);
Run addImpedance(CLI::App& app);
Run addScenes(CLI::App& app);
Run addVersion(CLI::App& app);
Run addWrite(CLI::App& app);

}  // namespace dynwitness::cli
