// SPDX-License-Identifier: GPL-3.0-or-later
// The fast sweeps behind a few C functions, so that one program can hold what two compilers make of
// the same source. COMPILER is the prefix of the functions; nothing else is visible outside.
#include "tests/benchmarks/fast_by_compiler.hpp"

#include "recursive/fast/derivatives.hpp"
#include "recursive/fast/dynamics.hpp"

using dynwitness::recursive::fast::Derivatives;
using dynwitness::recursive::fast::Dynamics;

#define JOINED(a, b) a##b
#define NAME(a, b) JOINED(a, b)
#define EXPORTED extern "C" __attribute__((visibility("default")))

EXPORTED void* NAME(COMPILER, _fast_make)(const dynwitness::recursive::Model<double>* model) {
  return new Dynamics(*model);
}
EXPORTED void NAME(COMPILER, _fast_free)(void* fast) {
  delete static_cast<Dynamics*>(fast);
}
EXPORTED void NAME(COMPILER, _fast_ID)(void* fast, const double* q, const double* qd,
                                       const double* qdd, double* tau) {
  static_cast<Dynamics*>(fast)->inverseDynamics(q, qd, qdd, tau);
}
EXPORTED void NAME(COMPILER, _fast_M)(void* fast, const double* q, double* M) {
  static_cast<Dynamics*>(fast)->massMatrix(q, M);
}
EXPORTED void NAME(COMPILER, _fast_FD)(void* fast, const double* q, const double* qd,
                                       const double* tau, double* qdd) {
  static_cast<Dynamics*>(fast)->forwardDynamics(q, qd, tau, qdd);
}
EXPORTED void* NAME(COMPILER,
                    _derivatives_make)(const dynwitness::recursive::Model<double>* model) {
  return new Derivatives(*model);
}
EXPORTED void NAME(COMPILER, _derivatives_free)(void* fast) {
  delete static_cast<Derivatives*>(fast);
}
EXPORTED void NAME(COMPILER, _fast_dtau)(void* fast, const double* q, const double* qd,
                                         const double* qdd, double* three) {
  Derivatives& of = *static_cast<Derivatives*>(fast);
  const int nn = of.plan().dof * of.plan().dof;
  of.inverseDynamics(q, qd, qdd, three, three + nn, three + 2 * nn);
}
EXPORTED void NAME(COMPILER, _fast_dqdd)(void* fast, const double* q, const double* qd,
                                         const double* tau, double* three) {
  Derivatives& of = *static_cast<Derivatives*>(fast);
  const int nn = of.plan().dof * of.plan().dof;
  of.forwardDynamics(q, qd, tau, three, three + nn, three + 2 * nn);
}
EXPORTED const char* NAME(COMPILER, _fast_compiler)() {
#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)
#ifdef __clang__
  return "clang " TEXT(__clang_major__);
#else
  return "g++ " TEXT(__GNUC__);
#endif
}
