// SPDX-License-Identifier: GPL-3.0-or-later
// Columns and matrices of any scalar, of sizes that a scene decides.
#pragma once

#include <Eigen/Core>

namespace dynwitness::scene {

template <typename T>
using VectorX = Eigen::Matrix<T, Eigen::Dynamic, 1>;
template <typename T>
using MatrixX = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

}  // namespace dynwitness::scene
