// SPDX-License-Identifier: GPL-3.0-or-later
// What the witnesses of kernels are called, for those that treat them apart.
#pragma once

namespace dynwitness::crosscheck {

inline constexpr const char* kKernelName = "kernel";             ///< one state at a time
inline constexpr const char* kKernelLanesName = "kernel_lanes";  ///< several at once

}  // namespace dynwitness::crosscheck
