// SPDX-License-Identifier: GPL-3.0-or-later
// The fast sweeps as each compiler makes them; see fast_by_compiler.cpp.
#pragma once

#include "recursive/model.hpp"

#define DYNWITNESS_FAST_BY(COMPILER)                                                          \
  extern "C" {                                                                                \
  void* COMPILER##_fast_make(const dynwitness::recursive::Model<double>* model);              \
  void COMPILER##_fast_free(void* fast);                                                      \
  void COMPILER##_fast_ID(void* fast, const double* q, const double* qd, const double* qdd,   \
                          double* tau);                                                       \
  void COMPILER##_fast_M(void* fast, const double* q, double* M);                             \
  void COMPILER##_fast_FD(void* fast, const double* q, const double* qd, const double* tau,   \
                          double* qdd);                                                       \
  void* COMPILER##_derivatives_make(const dynwitness::recursive::Model<double>* model);       \
  void COMPILER##_derivatives_free(void* fast);                                               \
  void COMPILER##_fast_dtau(void* fast, const double* q, const double* qd, const double* qdd, \
                            double* three);                                                   \
  void COMPILER##_fast_dqdd(void* fast, const double* q, const double* qd, const double* tau, \
                            double* three);                                                   \
  const char* COMPILER##_fast_compiler();                                                     \
  }
DYNWITNESS_FAST_BY(own)
DYNWITNESS_FAST_BY(second)

namespace dynwitness::benchmarks {

/// What one compiler made.
struct FastBy {
  const char* (*compiler)();
  void* (*make)(const recursive::Model<double>*);
  void (*release)(void*);
  void (*inverseDynamics)(void*, const double*, const double*, const double*, double*);
  void (*massMatrix)(void*, const double*, double*);
  void (*forwardDynamics)(void*, const double*, const double*, const double*, double*);
  // derivatives, three n x n matrices one after the other, of an object of their own
  void* (*makeDerivatives)(const recursive::Model<double>*);
  void (*releaseDerivatives)(void*);
  void (*ofForces)(void*, const double*, const double*, const double*, double*);
  void (*ofAccelerations)(void*, const double*, const double*, const double*, double*);
};

inline constexpr FastBy kFastByOwn = {
    own_fast_compiler, own_fast_make,        own_fast_free,        own_fast_ID,   own_fast_M,
    own_fast_FD,       own_derivatives_make, own_derivatives_free, own_fast_dtau, own_fast_dqdd};
#ifdef DYNWITNESS_SECOND_COMPILER
inline constexpr FastBy kFastBySecond = {
    second_fast_compiler, second_fast_make, second_fast_free,        second_fast_ID,
    second_fast_M,        second_fast_FD,   second_derivatives_make, second_derivatives_free,
    second_fast_dtau,     second_fast_dqdd};
#endif

}  // namespace dynwitness::benchmarks
