// SPDX-License-Identifier: GPL-3.0-or-later
// Simbody called as its users call it: no witness around it, each stage realized only as far as
// needed.
#pragma once

#include <memory>
#include <vector>

#include "crosscheck/chart/raw_engines.hpp"
#include "recursive/model.hpp"

namespace dynwitness::crosscheck {

/** A model in Simbody, from the model's own numbers: this is about time, the witness `simbody` is
   about trust. Rotors are left out, since Simbody has no figure for them and the bodies that would
   stand for them cost it time; springs and friction, too. Revolute, prismatic and floating joints,
   the rates of the last as Simbody has them: the same work.
    @throws std::invalid_argument  another joint */
class RawSimbody {
 public:
  explicit RawSimbody(const recursive::Model<double>& model);
  ~RawSimbody();

  /// q has one entry a slot, the others one a degree of freedom, in the model's order.
  void inverseDynamics(const double* q, const double* qd, const double* qdd);
  void massMatrix(const double* q);
  void forwardDynamics(const double* q, const double* qd, const double* tau);

  /// What the last call computed, in Simbody's order (M: column by column).
  const double* results() const;
  std::vector<double> inModelOrder() const;  ///< of tau or qdd

  struct Parts;  // for its steps, too

 private:
  std::unique_ptr<Parts> parts_;
};

/** By SemiExplicitEulerIntegrator.
    @throws std::invalid_argument  a joint, a closure or a method that is not there */
std::unique_ptr<RawSteps> rawSimbodySteps(const recursive::Model<double>& model,
                                          const recursive::Constraints<double>& closures,
                                          const RawStep& step);

}  // namespace dynwitness::crosscheck
