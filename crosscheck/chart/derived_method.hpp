// SPDX-License-Identifier: GPL-3.0-or-later
// What the two derived methods share.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/chart/answers.hpp"
#include "crosscheck/chart/methods.hpp"
#include "recursive/factorization.hpp"

namespace dynwitness::crosscheck {

/// The numbers M, c, g and Q in, the quantity out, in double.
class DerivedMethod : public Method {
 public:
  DerivedMethod(const std::string& name, Quantity quantity, int dof, const States& states)
      : Method(name, Scalar::kDouble),
        quantity_(quantity),
        states_(states),
        M_(dof, dof),
        out_(dof) {}

  MatrixX<Ball> answer() const override {
    return exactlyAll<double>(quantity_ == Quantity::kM ? M_ : MatrixX<double>(column(out_)));
  }

 protected:
  /// qdd from M_ and out_ = tau - c - g + Q.
  void solve() {
    recursive::factorize(M_);
    recursive::solve(M_, out_);
  }
  Quantity quantity_;
  States states_;
  MatrixX<double> M_;
  std::vector<double> out_;
};

}  // namespace dynwitness::crosscheck
