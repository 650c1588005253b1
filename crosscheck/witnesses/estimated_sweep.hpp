// SPDX-License-Identifier: GPL-3.0-or-later
// What our sweeps answer, in double or float, with an estimate of what rounding made of it.
#pragma once

#include <functional>
#include <string>

#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

struct EstimatedAnswer {
  Eigen::MatrixXd value;
  /// Decimal digits, as a share of the largest entry, that rounding is expected to have left; 0 or
  /// less: none. An estimate (recursive/rounding_estimate.hpp), where certainDigits() is proven;
  /// above kFewestDigits one that may be much too low (rounding_filter.hpp).
  double digits;
};
using EstimatedSweep = std::function<EstimatedAnswer(const scene::State<double>&)>;

/** The sweep that the witness of this name runs, in double or float, with the estimate that comes
    with it. In float the state is told in double, and its
    rounding to float counts.
    @return empty: nothing estimates this witness's answer to this quantity. There are tau, c and g
      of newton_euler, M and qdd of composite_body, qdd of articulated_body (not where joints follow
      others), in double tau, M and qdd of fast (the same) */
EstimatedSweep estimatedSweep(const std::string& witness, Quantity quantity,
                              const scene::Mechanism& mechanism, bool in_float);

/** The same of a witness that is a scene's kernel, of tau and M in double: forward dynamics as a
    straight line hands out no D.
    @param witness  has to outlive it
    @return empty: it is no kernel, another quantity, or joints follow others */
EstimatedSweep estimatedKernel(Witness& witness, Quantity quantity,
                               const scene::Mechanism& mechanism);

}  // namespace dynwitness::crosscheck
