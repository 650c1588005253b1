// SPDX-License-Identifier: GPL-3.0-or-later
// Which gnuplot there is.
#pragma once

#include <functional>
#include <string>

namespace dynwitness::crosscheck {

/// "5.4 patchlevel 4"; "not found" where there is no gnuplot.
std::string gnuplotVersion();
/// Starts gnuplot, which takes a while to load, and goes on; what comes back waits for the answer,
/// once.
std::function<std::string()> askGnuplotVersion();

}  // namespace dynwitness::crosscheck
