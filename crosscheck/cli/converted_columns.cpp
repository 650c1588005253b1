// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/converted_columns.hpp"

#include <fmt/format.h>

namespace dynwitness::cli {

using namespace crosscheck;

namespace {

/// How a quantity goes over to other rates.
enum class Conversion { kNone, kForce, kQdd, kBias, kMass, kColumns, kRows, kUnknown };

Conversion conversionOf(const EvaluatedColumn& column) {
  if (column.of_joints)
    return *column.of_joints == JointQuantity::kZ ? Conversion::kUnknown : Conversion::kNone;
  if (column.of_points)
    return *column.of_points == PointQuantity::kJacobian       ? Conversion::kColumns
           : *column.of_points == PointQuantity::kJacobianRate ? Conversion::kUnknown
                                                               : Conversion::kNone;
  if (column.derivative) return Conversion::kUnknown;
  if (column.along == Along::kPower) return Conversion::kNone;
  if (column.witness) switch (column.quantity) {
      case Quantity::kM:
        return Conversion::kMass;
      case Quantity::kc:
        return Conversion::kBias;
      case Quantity::kg:
      case Quantity::kTau:
        return Conversion::kForce;
      case Quantity::kQdd:
        return Conversion::kQdd;
      default:
        return Conversion::kNone;
    }
  switch (column.constrained) {
    case ConstrainedQuantity::kQdd:
      return Conversion::kQdd;
    case ConstrainedQuantity::kTauDrive:
    case ConstrainedQuantity::kTaskTorque:
    case ConstrainedQuantity::kNullTorque:
      return Conversion::kForce;
    case ConstrainedQuantity::kJ:
      return Conversion::kColumns;
    case ConstrainedQuantity::kJbar:
      return Conversion::kRows;
    default:
      return Conversion::kNone;
  }
}

}  // namespace

ConvertedColumns::ConvertedColumns(const scene::Scene& scene, CoordinateConvention convention)
    : scene_(scene), to_(scene.mechanism, convention) {}

void ConvertedColumns::require(const EvaluatedColumn& column) {
  const Conversion conversion = conversionOf(column);
  if (conversion == Conversion::kUnknown)
    throw scene::InputError(
        {}, fmt::format("--convention {} with {}, which is of dynwitness' own rates, allowed: "
                        "another quantity, or --convention dynwitness",
                        name(to_.convention()), column.name));
  if (conversion == Conversion::kBias && !mass_)
    mass_ = selectWitnesses({"composite_body"}).front().make(scene_).value();
}

Eigen::MatrixXd ConvertedColumns::value(const EvaluatedColumn& column,
                                        const scene::State<double>& state,
                                        const Eigen::MatrixXd& value) {
  const std::vector<double> turning = to_.turning(state);
  const Eigen::Map<const Eigen::VectorXd> gained(turning.data(),
                                                 static_cast<Eigen::Index>(turning.size()));
  switch (conversionOf(column)) {
    case Conversion::kForce:
    case Conversion::kRows:
      return rows(state, value);
    case Conversion::kQdd:
      return rows(state, value + gained);
    case Conversion::kBias:
      return rows(state, value - mass_->value(Quantity::kM, state) * gained);
    case Conversion::kMass:
      return rows(state, rows(state, value).transpose());
    case Conversion::kColumns: {  // row by row, in one column or in as many as there are rates
      const Eigen::Index n = scene_.mechanism.dof(), count = value.size() / n;
      const Eigen::MatrixXd wide = value.transpose();
      const Eigen::MatrixXd out = rows(
          state, value.cols() == n
                     ? wide
                     : Eigen::MatrixXd(Eigen::Map<const Eigen::MatrixXd>(wide.data(), n, count)));
      if (value.cols() == n) return out.transpose();
      return Eigen::Map<const Eigen::VectorXd>(out.data(), out.size());
    }
    default:
      return value;
  }
}

std::vector<std::string> ConvertedColumns::sorted(const EvaluatedColumn& column,
                                                  const std::vector<std::string>& all) const {
  const Conversion conversion = conversionOf(column);
  if (conversion == Conversion::kNone) return all;
  const auto n = static_cast<std::size_t>(scene_.mechanism.dof());
  const auto at = [&](std::size_t k) {
    return static_cast<std::size_t>(to_.place(static_cast<int>(k)));
  };
  std::vector<std::string> out;
  for (std::size_t k = 0; k < all.size(); ++k)
    out.push_back(all[(conversion == Conversion::kMass ? at(k / n) : k / n) * n + at(k % n)]);
  return out;
}

Eigen::MatrixXd ConvertedColumns::rows(const scene::State<double>& state,
                                       const Eigen::MatrixXd& x) const {
  Eigen::MatrixXd out(x.rows(), x.cols());
  for (Eigen::Index j = 0; j < x.cols(); ++j) {
    const std::vector<double> turned =
        to_.theirs(state, {x.col(j).data(), x.col(j).data() + x.rows()});
    out.col(j) = Eigen::Map<const Eigen::VectorXd>(turned.data(), x.rows());
  }
  return out;
}

}  // namespace dynwitness::cli
