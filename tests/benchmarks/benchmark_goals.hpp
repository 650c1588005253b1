// SPDX-License-Identifier: GPL-3.0-or-later
// What dynwitness wants to reach. Growth with the number of links has a command of its own
// (`dynwitness growth`).
#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "crosscheck/report/bench.hpp"
#include "tests/benchmarks/benchmark_parts.hpp"
#include "tests/fixtures/counted_arms.hpp"

namespace dynwitness::benchmarks {

/// A goal for the first compiler's work is one for the second's, too.
inline std::vector<crosscheck::Goal> goals() {
  std::vector<crosscheck::Goal> all;
  const auto faster = [&](int number, const char* scene, const char* by, double ID, double M,
                          double FD) {
    for (const char* compiler : {"", "_second"})
      for (const auto& [what, times] : {std::pair("ID", ID), {"M", M}, {"FD", FD}})
        if (times > 0)
          all.push_back({number, what, scene, std::string(by) + compiler, crosscheck::kTimesMujoco,
                         times, true});
  };
  faster(1, "franka_panda", "fast", 5.8, 5.4, 3.4);
  faster(1, "humanoid", "fast", 4.8, 4.4, 3.5);
  faster(1, "humanoid_floating", "fast", 4.8, 4.4, 3.5);
  faster(2, "franka_panda", "kernel", 12, 12, 8);
  // from the scene in memory to three functions that can be called, nothing in the cache
  all.push_back({2, "making", "franka_panda", "kernel", "s", 2, false});
  all.push_back({2, "making", "franka_panda", "kernel_second", "s", 2, false});
  for (const counted::Fewest& fewest : counted::fewest())
    for (const auto& [unit, number] : {std::pair("multiplications", fewest.multiplications),
                                       {"additions", fewest.additions},
                                       {"operations", fewest.in_all}})
      if (number > 0)
        all.push_back({2, std::string("count of ") + crosscheck::kernel::name(fewest.formula),
                       fewest.arm, "program", unit, static_cast<double>(number), false});
  faster(3, "franka_panda", "kernel_lanes", 50, 0, 25);
  // Pinocchio 3.7, analytical derivatives, by clang: 2.9 and 14.9 us of tau, 5.5 and 34 us of qdd
  // on a machine of this kind; 2.5 times as fast, in lanes 25 times
  for (const auto& [by, times] :
       {std::pair("fast", 2.5), {"fast_second", 2.5}, {"fast_lanes", 25.0}})
    for (const auto& [what, scene, us] : {std::tuple("dtau", "franka_panda", 2.9),
                                          {"dtau", "humanoid_floating", 14.9},
                                          {"dqdd", "franka_panda", 5.5},
                                          {"dqdd", "humanoid_floating", 34.0}})
      all.push_back({7, what, scene, by, "ns", 1000 * us / times, false});
  // whole steps: of trees four times as many a second as the best engine's in the same run, of
  // closed loops twice
  for (const char* scene : kScenes)
    for (const char* what : crosscheck::kSteps)
      for (const char* by : {"fast", "fast_lanes"})
        all.push_back({8, what, scene, by, crosscheck::kTimesBest, 4, true});
  for (const char* scene : kClosedScenes)
    all.push_back({8, crosscheck::kStep, scene, "fast", crosscheck::kTimesBest, 2, true});
  for (const auto& [scene, ms] : {std::pair("franka_panda", 20.0), {"chain_50", 500.0}}) {
    all.push_back({5, "derivation", scene, "lagrange", "ms", ms, false});
    all.push_back({5, "derivation", scene, "lagrange", "MB", 50, false});
  }
  all.push_back({6, "crosscheck", "double pendulum", "dynwitness", "s", 0.3, false});
  return all;
}

}  // namespace dynwitness::benchmarks
