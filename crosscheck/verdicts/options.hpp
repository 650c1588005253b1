// SPDX-License-Identifier: GPL-3.0-or-later
// What of a crosscheck may be chosen.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "crosscheck/scalars/indeterminates.hpp"

namespace dynwitness::crosscheck {

struct Options {
  std::uint64_t seed = 1;
  int states = 100;
  std::vector<std::string> witnesses;  ///< names to ask; empty: all that are present
  bool drift = true;                   ///< simulate 10 s and watch the energy; published motions
  double error_probability = 1e-30;  ///< chance at most that an exact check passes a wrong formula
  Parameters parameters = Parameters::kAsWritten;  ///< in exact checks: the scene's, or any
};

}  // namespace dynwitness::crosscheck
