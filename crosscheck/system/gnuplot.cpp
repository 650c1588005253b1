// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/system/gnuplot.hpp"

#include <memory>
#include <string_view>
#include <vector>

#include "crosscheck/system/children.hpp"

namespace dynwitness::crosscheck {

std::function<std::string()> askGnuplotVersion() {
  const auto gnuplot = std::make_shared<Child>(std::vector<std::string>{"gnuplot", "--version"});
  return [gnuplot]() -> std::string {
    const Ending ending = gnuplot->wait();
    if (!ending.problem.empty()) return "not found";
    std::string version = ending.output.substr(0, ending.output.find('\n'));
    constexpr std::string_view kName = "gnuplot ";
    if (version.rfind(kName, 0) == 0) version.erase(0, kName.size());
    return version;
  };
}

std::string gnuplotVersion() {
  return askGnuplotVersion()();
}

}  // namespace dynwitness::crosscheck
