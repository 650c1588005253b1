// SPDX-License-Identifier: Apache-2.0
// The fast sweeps of one mechanism, each answer with what rounding may have made of it.
#pragma once

#include <cstddef>

#include "recursive/fast/dynamics.hpp"
#include "recursive/rounding_filter.hpp"

namespace dynwitness::recursive::fast {

/** Dynamics, whose calls return an error that rounding may have made, as a share of the answer's
    largest entry: at most `suspicious`, or as RoundingEstimate has it. Instructions more than
    Dynamics', where nothing is suspicious (tests/benchmarks/count_warnings.cpp counts).

    The arrays are those of Dynamics, and are trusted to be as long as there. */
class WarnedDynamics {
 public:
  explicit WarnedDynamics(const Model<double>& model, double suspicious = 1e-3)
      : sweeps_(model), filter_(model, suspicious) {}

  double inverseDynamics(const double* q, const double* qd, const double* qdd, double* tau) {
    sweeps_.inverseDynamics(q, qd, qdd, tau);
    return filter_.inverseDynamics(sweeps_.positions(), qd, qdd, tau);
  }
  double massMatrix(const double* q, double* M) {
    sweeps_.massMatrix(q, M);
    const std::ptrdiff_t next = sweeps_.plan().dof + 1;
    return filter_.massMatrix(sweeps_.positions(), [&](int d) { return M[d * next]; });
  }
  double forwardDynamics(const double* q, const double* qd, const double* tau, double* qdd) {
    sweeps_.forwardDynamics(q, qd, tau, qdd);
    return filter_.forwardDynamics(
        sweeps_.positions(), qd, tau, qdd, [&](int d) { return sweeps_.inversePivot(d); },
        [&](int, int d, int l) { return sweeps_.coupling(d, l); });
  }

 private:
  Dynamics sweeps_;
  RoundingFilter<double> filter_;
};

}  // namespace dynwitness::recursive::fast
