// SPDX-License-Identifier: Apache-2.0
// Cosines and sines of all joints at once.
#pragma once

#include <math.h>

#include "recursive/fast/dispatch.hpp"
#include "scene/state.hpp"

namespace dynwitness::recursive::fast {
namespace detail {

// Two angles at a time everywhere, four where the processor has AVX2, which is asked when running.
// No pragma lets multiplications and additions fuse, so that the results are the same bits.
namespace two {
typedef double V __attribute__((vector_size(16)));
typedef long long I __attribute__((vector_size(16)));
enum { LANES = 2 };
#include "recursive/fast/sine_cosine.inc"
#include "recursive/fast/sine_cosine_positions.inc"
}  // namespace two

#ifdef __x86_64__
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif
namespace four {
typedef double V __attribute__((vector_size(32)));
typedef long long I __attribute__((vector_size(32)));
enum { LANES = 4 };
// NOLINTBEGIN(readability-duplicate-include): once for each width of vectors
#include "recursive/fast/sine_cosine.inc"
#include "recursive/fast/sine_cosine_positions.inc"
// NOLINTEND(readability-duplicate-include)
}  // namespace four
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#endif

}  // namespace detail

/// The largest angle [rad] in whose range no library is called.
inline constexpr double kLargestAngle = detail::two::LARGEST_ANGLE;

/** Joint positions with cos and sin, each within 2^-52 of its value, as of the C library
    (sine_cosine.inc shows it), some four times as fast for the joints of an arm.
    @param q, x  `count` positions [rad, m]; lanes that are not angles do not mind */
inline void jointPositions(const double* q, int count, scene::JointPosition<double>* x) {
#ifdef __x86_64__
  if (kHasAvx2) return detail::four::positions(q, count, x);
#endif
  detail::two::positions(q, count, x);
}

}  // namespace dynwitness::recursive::fast
