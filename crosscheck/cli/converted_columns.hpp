// SPDX-License-Identifier: GPL-3.0-or-later
// Columns of evaluate in the coordinates of another engine.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "crosscheck/cli/evaluated_column.hpp"
#include "crosscheck/inputs/conventions.hpp"
#include "scene/scene.hpp"

namespace dynwitness::cli {

/// Answers in the coordinates of another convention (inputs/conventions.hpp has the equations).
class ConvertedColumns {
 public:
  ConvertedColumns(const scene::Scene& scene, crosscheck::CoordinateConvention convention);

  /// @throws scene::InputError  what it would be there is not known here
  void require(const EvaluatedColumn& column);
  /// Of rates and forces of that convention. @param value  of ours, in the column's shape
  Eigen::MatrixXd value(const EvaluatedColumn& column, const scene::State<double>& state,
                        const Eigen::MatrixXd& value);
  /// The strings, one a number of value(), of the rates that these belong to.
  std::vector<std::string> sorted(const EvaluatedColumn& column,
                                  const std::vector<std::string>& all) const;

 private:
  /// T x, column by column.
  Eigen::MatrixXd rows(const scene::State<double>& state, const Eigen::MatrixXd& x) const;

  const scene::Scene& scene_;
  crosscheck::Coordinates to_;
  std::unique_ptr<crosscheck::Witness> mass_;  ///< M, where c is asked for
};

}  // namespace dynwitness::cli
