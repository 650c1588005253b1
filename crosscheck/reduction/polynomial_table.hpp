// SPDX-License-Identifier: GPL-3.0-or-later
// Many polynomials in the cosines and sines of joints, looked up together.
#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include "crosscheck/reduction/trigonometric.hpp"

namespace dynwitness::crosscheck {

/** Several polynomials as one table: their values, first and second derivatives at a point, and how
    much these change between points. Columns: 1, d/dq_k of the active joints, d^2/dq_k^2. */
class PolynomialTable {
 public:
  /// @param model, ranges  must outlive it
  /// @throws scene::InputError  more monomials than kMostMonomials / 2
  PolynomialTable(const TrigonometricModel& model, const std::vector<scene::JointRanges>& ranges,
                  const std::vector<Polynomial>& all);

  /// Joints that any of them depends on, or that have a spring.
  const std::vector<int>& active() const { return active_; }
  Eigen::Index columns() const { return 1 + 2 * static_cast<Eigen::Index>(active_.size()); }

  /// Polynomials x columns, at the positions of the active joints.
  Eigen::MatrixXd at(const std::vector<double>& q) const;
  /// Of at(): what it may be off, roundings and what of coefficients is not known.
  const Eigen::MatrixXd& lost() const { return lost_; }
  /// sup of the magnitude of each entry of at(), all over the ranges.
  const Eigen::MatrixXd& largest() const { return largest_; }
  /// sup |d^2/dq_l^2| of each entry of at(), all over the ranges.
  const Eigen::MatrixXd& beyond(std::size_t l) const { return beyond_[l]; }
  /// sup |d^2/dq_k dq_l| of each polynomial, all over the ranges; of k < l.
  const Eigen::VectorXd& mixed(std::size_t k, std::size_t l) const { return mixed_[k][l]; }

 private:
  bool slides(int k) const { return model_.slides[static_cast<std::size_t>(k)]; }
  std::vector<int> digitsOf(Monomial m) const;
  int order(Eigen::Index o, std::size_t k) const;
  double factor(const std::vector<int>& digits, const std::vector<int>& orders) const;
  std::vector<int> orders(Eigen::Index o, int l) const;
  void bound();

  const TrigonometricModel& model_;
  const std::vector<scene::JointRanges>& ranges_;
  std::vector<std::vector<int>> digits_;
  std::vector<int> active_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> coefficients_;
  Eigen::MatrixXd lost_, largest_;
  std::vector<Eigen::MatrixXd> beyond_;
  std::vector<std::vector<Eigen::VectorXd>> mixed_;
};

}  // namespace dynwitness::crosscheck
