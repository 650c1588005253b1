// SPDX-License-Identifier: Apache-2.0
// Which instructions the fast sweeps may use: asked when running, so that one program runs
// everywhere.
#pragma once

namespace dynwitness::recursive::fast {

/** Before a function: compiled for processors with AVX2, whatever the rest of the program is for.
    What is inlined into it is compiled so too. AVX2 alone has no instruction that fuses a
    multiplication with an addition, so that the results are the same bits. */
#if defined(__x86_64__)
#define DYNWITNESS_FOR_AVX2 __attribute__((target("avx2")))
inline const bool kHasAvx2 = (__builtin_cpu_init(), __builtin_cpu_supports("avx2"));
#else
#define DYNWITNESS_FOR_AVX2
inline constexpr bool kHasAvx2 = false;
#endif

/** The same with AVX-512, which has such an instruction: g++ is told to leave it. Clang cannot be
    told from here what it makes of other headers' functions, and stays with AVX2. */
#if defined(__x86_64__)
#ifdef __clang__
#define DYNWITNESS_FOR_AVX512 __attribute__((target("avx512f,avx512dq,avx512vl")))
inline constexpr bool kHasAvx512 = false;
#else
#define DYNWITNESS_FOR_AVX512 \
  __attribute__((target("avx512f,avx512dq,avx512vl"), optimize("fp-contract=off")))
inline const bool kHasAvx512 = (__builtin_cpu_init(), __builtin_cpu_supports("avx512f") &&
                                                          __builtin_cpu_supports("avx512dq") &&
                                                          __builtin_cpu_supports("avx512vl"));
#endif
#else
#define DYNWITNESS_FOR_AVX512
inline constexpr bool kHasAvx512 = false;
#endif

}  // namespace dynwitness::recursive::fast
