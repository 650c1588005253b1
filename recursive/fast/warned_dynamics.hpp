// SPDX-License-Identifier: Apache-2.0
// The fast sweeps of one mechanism, each answer with what rounding may have made of it.
#pragma once

#include <cstddef>
#include <vector>

#include "recursive/fast/dynamics.hpp"
#include "recursive/rounding_filter.hpp"

namespace dynwitness::recursive::fast {

/** Dynamics, whose calls return an error that rounding may have made, as a share of the answer's
    largest entry: at most `suspicious`, or as RoundingEstimate has it. How many instructions that
    takes is counted by tests/benchmarks/count_warnings.cpp.

    The arrays are those of Dynamics, and are trusted to be as long as there. */
class WarnedDynamics {
 public:
  explicit WarnedDynamics(const Model<double>& model, double suspicious = 1e-3)
      : sweeps_(model), filter_(model, suspicious), moved_by_(model.dof()) {
    const auto& links = sweeps_.plan().links;
    for (std::size_t i = 0; i < links.size(); ++i)
      for (int k = 0; k < links[i].axes; ++k) moved_by_[links[i].dof + k] = i;
  }

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
        sweeps_.positions(), qd, tau, qdd, [&](int d) { return sweeps_.joint(d).inverse_D; },
        [&](int, int d, int l) {
          const auto& joint = sweeps_.joint(d);
          return alongAxis(sweeps_.plan().links[moved_by_[d]], l, joint.U_f, joint.U_n);
        });
  }

 private:
  Dynamics sweeps_;
  RoundingFilter<double> filter_;
  std::vector<std::size_t> moved_by_;  ///< by rate: the link in the plan
};

}  // namespace dynwitness::recursive::fast
