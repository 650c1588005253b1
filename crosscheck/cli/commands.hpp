// SPDX-License-Identifier: GPL-3.0-or-later
// The subcommands. Each adds itself to the command line and, when it was asked for, runs and
// returns the exit status: 0 all agree (or done), 1 a disagreement was found. Bad input is thrown.
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

namespace dynwitness::cli {

using Run = std::function<int()>;

// of commands that are told about by a program that does not have them (front.hpp)
inline constexpr const char* kAuditDescription =
    "H. Bruyninckx, Dynamics of robots (2005), equation by equation: what holds";
inline constexpr const char* kGrowthDescription =
    "Measure time, memory and digits against the number of links";
inline constexpr const char* kActionDescription =
    "Hamilton's principle: the action of a motion and of the paths near it, conjugate times";
inline constexpr const char* kCheckDescription =
    "A program of yours on the stand: is it right, where is it wrong, and why";
inline constexpr const char* kGeometryDescription =
    "The mass matrix as a metric: Christoffel symbols, curvature, geodesics, Jacobi fields";
inline constexpr const char* kGoldenDescription =
    "States and certified answers, for tests of programs that know nothing of this one";
inline constexpr const char* kGradeDescription =
    "Marks for a folder of programs, by a rubric, with the reason for each";
inline constexpr const char* kImpedanceDescription =
    "Stiffness, damping, compliance and inertia of a link's point, seen from the joints";
inline constexpr const char* kImpulseDescription =
    "A blow on a link, on joints or against a wall: velocities, momentum, energy";
inline constexpr const char* kMuseumDescription =
    "Mistakes of real tools, planted again: does `check` name each of them?";
inline constexpr const char* kParametersDescription =
    "Which inertial parameters the motion of a scene knows, and what their errors do";
inline constexpr const char* kReadersDescription =
    "What each engine, with its own defaults, makes of a URDF or MJCF file";
inline constexpr const char* kRotorsDescription =
    "How much the gyroscopic coupling of rotors is, which d = n^2 J leaves out";
inline constexpr const char* kSameDescription = "Whether two descriptions are the same robot";

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
Run addShow(CLI::App& app);
Run addVersion(CLI::App& app);
Run addWrite(CLI::App& app);

}  // namespace dynwitness::cli
