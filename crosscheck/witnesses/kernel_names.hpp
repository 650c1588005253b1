// SPDX-License-Identifier: GPL-3.0-or-later
// What the witnesses of kernels are called, for those that treat them apart: their making is slow.
#pragma once

#include "crosscheck/witnesses/witness_info.hpp"

namespace dynwitness::crosscheck {

inline constexpr const char* kKernelName = "kernel";             ///< one state at a time
inline constexpr const char* kKernelLanesName = "kernel_lanes";  ///< several at once

inline bool isKernel(const WitnessInfo& witness) {
  return witness.name == kKernelName || witness.name == kKernelLanesName;
}

}  // namespace dynwitness::crosscheck
