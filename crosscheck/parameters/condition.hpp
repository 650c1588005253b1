// SPDX-License-Identifier: GPL-3.0-or-later
// How well a matrix can be solved with.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace dynwitness::crosscheck {

/// Its largest singular value by its smallest; nothing where the smallest drowns in the rounding of
/// the largest.
std::optional<double> conditionOf(const Eigen::MatrixXd& W);

}  // namespace dynwitness::crosscheck
