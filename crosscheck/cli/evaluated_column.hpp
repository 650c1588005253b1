// SPDX-License-Identifier: GPL-3.0-or-later
// A column of evaluate's table: what was asked for, and whom it is asked of.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/cli/asked_quantity.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/motion/derivative_quantities.hpp"
#include "crosscheck/motion/joint_quantities.hpp"
#include "crosscheck/motion/point_quantities.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::cli {

/// One quantity, of one who answers: a witness, or where there is none joints, points, derivatives
/// or constraints.
struct EvaluatedColumn {
  crosscheck::Quantity quantity = crosscheck::Quantity::kQdd;
  std::unique_ptr<crosscheck::Witness> witness;  ///< none: asked of the constrained quantities
  std::string name;
  bool is_engines = false;  ///< the witness is a program of the user's
  crosscheck::ConstrainedQuantity constrained =
      crosscheck::ConstrainedQuantity::kQdd;                ///< without a witness
  std::optional<crosscheck::JointQuantity> of_joints = {};  ///< then it is this, and no other
  std::vector<Eigen::Index> rows = {};  ///< of these numbers alone; none: all of them
  bool is_deviation = false;            ///< of the column before, by --uncertainty
  std::optional<crosscheck::PointQuantity> of_points = {};        ///< then it is this, and no other
  std::optional<crosscheck::DerivativeQuantity> derivative = {};  ///< then it is this, and no other
  Along along = Along::kNothing;  ///< formed of quantity, which is tau

  bool isOfConstraints() const { return !witness && !of_joints && !of_points && !derivative; }
  bool isOfConstrained(crosscheck::ConstrainedQuantity asked) const {
    return isOfConstraints() && constrained == asked;
  }
  bool isOfReactions() const {
    return isOfConstrained(crosscheck::ConstrainedQuantity::kReactions) ||
           (witness && quantity == crosscheck::Quantity::kReactions);
  }
};

}  // namespace dynwitness::cli
