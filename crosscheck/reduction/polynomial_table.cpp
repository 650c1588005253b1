// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/polynomial_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "crosscheck/reduction/boxes.hpp"

namespace dynwitness::crosscheck {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

PolynomialTable::PolynomialTable(const TrigonometricModel& model,
                                 const std::vector<scene::JointRanges>& ranges,
                                 const std::vector<Polynomial>& all)
    : model_(model), ranges_(ranges) {
  const auto counts = [](const RunningError& c) { return std::abs(c.value()) > c.bound(); };
  std::map<Monomial, Index> column;
  for (const Polynomial& f : all)
    for (const auto& [m, c] : f)
      if (counts(c)) column.emplace(m, 0);
  if (column.size() > kMostMonomials / 2)
    throw scene::InputError({}, "envelope: qdd has " + std::to_string(column.size()) +
                                    " monomials, allowed: up to " +
                                    std::to_string(kMostMonomials / 2));
  for (auto& [m, at] : column) {
    at = static_cast<Index>(digits_.size());
    digits_.push_back(digitsOf(m));
  }
  for (int k = 0; k < model.dof; ++k)
    if (model.stiffness[static_cast<std::size_t>(k)].value() != 0 ||
        std::any_of(digits_.begin(), digits_.end(),
                    [k](const std::vector<int>& d) { return d[static_cast<std::size_t>(k)] != 0; }))
      active_.push_back(k);
  coefficients_.resize(static_cast<Index>(all.size()), static_cast<Index>(digits_.size()));
  lost_.setZero(coefficients_.rows(), columns());
  std::vector<Eigen::Triplet<double>> entries;
  std::map<Monomial, Eigen::RowVectorXd> most;  // of each monomial, by column
  for (std::size_t f = 0; f < all.size(); ++f)
    for (const auto& [m, c] : all[f]) {
      const auto row = static_cast<Index>(f);
      if (counts(c))
        entries.emplace_back(static_cast<int>(row), static_cast<int>(column.at(m)), c.value());
      const double unknown = c.bound() + (counts(c) ? kLost : 1) * std::abs(c.value());
      Eigen::RowVectorXd& factors = most[m];
      if (factors.size() == 0) {
        factors.resize(columns());
        const std::vector<int> digits = digitsOf(m);
        for (Index o = 0; o < columns(); ++o) factors(o) = factor(digits, orders(o, -1));
      }
      lost_.row(row) += unknown * factors;
    }
  coefficients_.setFromTriplets(entries.begin(), entries.end());
  bound();
}

MatrixXd PolynomialTable::at(const std::vector<double>& q) const {
  using Row = std::array<double, kBasis>;
  const std::size_t m = active_.size();
  std::vector<std::array<Row, 3>> f(m);  // by order of derivative
  for (std::size_t k = 0; k < m; ++k) {
    const double x = q[k];
    if (slides(active_[k])) {
      f[k] = {Row{1, x, x * x, 0, 0}, Row{0, 1, 2 * x, 0, 0}, Row{0, 0, 2, 0, 0}};
    } else {
      const double c = std::cos(x), s = std::sin(x), c2 = std::cos(2 * x), s2 = std::sin(2 * x);
      f[k] = {Row{1, c, s, c2, s2}, Row{0, -s, c, -2 * s2, 2 * c2},
              Row{0, -c, -s, -4 * c2, -4 * s2}};
    }
  }
  MatrixXd products(static_cast<Index>(digits_.size()), columns());
  for (std::size_t t = 0; t < digits_.size(); ++t)
    for (Index o = 0; o < columns(); ++o) {
      double product = 1;
      for (std::size_t k = 0; k < m; ++k)
        product *= f[k][static_cast<std::size_t>(order(o, k))]
                    [static_cast<std::size_t>(digits_[t][static_cast<std::size_t>(active_[k])])];
      products(static_cast<Index>(t), o) = product;
    }
  return coefficients_ * products;
}

std::vector<int> PolynomialTable::digitsOf(Monomial m) const {
  std::vector<int> digits;
  for (int k = 0; k < model_.dof; ++k) digits.push_back(digit(m, k));
  return digits;
}

/// How often column o differentiates by active joint k.
int PolynomialTable::order(Index o, std::size_t k) const {
  const auto m = static_cast<Index>(active_.size()), at = static_cast<Index>(k);
  return o == 1 + at ? 1 : o == 1 + m + at ? 2 : 0;
}

/// By active joint, of column o differentiated twice by l; -1: by none.
std::vector<int> PolynomialTable::orders(Index o, int l) const {
  std::vector<int> out;
  for (std::size_t k = 0; k < active_.size(); ++k)
    out.push_back(order(o, k) + (static_cast<int>(k) == l ? 2 : 0));
  return out;
}

/// The most that a monomial is, differentiated so often.
double PolynomialTable::factor(const std::vector<int>& digits,
                               const std::vector<int>& orders) const {
  double product = 1;
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const auto joint = static_cast<std::size_t>(active_[k]);
    product *= mostOfFactor(digits[joint], slides(active_[k]), ranges_[joint].q.most(), orders[k]);
  }
  return product;
}

/// Monomials of the same harmonics are one group, at most the root of the sum of its
/// coefficients' squares (envelope.cpp).
void PolynomialTable::bound() {
  std::map<std::vector<int>, Eigen::SparseVector<double>> groups;
  const Eigen::SparseMatrix<double> by_column = coefficients_;
  for (std::size_t t = 0; t < digits_.size(); ++t) {
    std::vector<int> group = digits_[t];
    for (int k = 0; k < model_.dof; ++k)
      if (int& d = group[static_cast<std::size_t>(k)]; !slides(k)) d = (d + 1) / 2 * 2;
    const Eigen::SparseVector<double> column = by_column.col(static_cast<Index>(t));
    groups.try_emplace(group, coefficients_.rows()).first->second += column.cwiseProduct(column);
  }
  const std::size_t m = active_.size();
  const VectorXd none = VectorXd::Zero(coefficients_.rows());
  largest_.setZero(coefficients_.rows(), columns());
  beyond_.assign(m, largest_);
  mixed_.assign(m, std::vector<VectorXd>(m, none));
  for (const auto& [digits, squares] : groups) {
    const Eigen::SparseVector<double> roots = squares.cwiseSqrt() * (1 + kLost);
    const auto addTo = [&roots = roots, &digits = digits, this](auto to,
                                                                const std::vector<int>& orders) {
      const double by = factor(digits, orders);
      for (Eigen::SparseVector<double>::InnerIterator it(roots); it; ++it)
        to(it.index()) += by * it.value();
    };
    for (Index o = 0; o < columns(); ++o) {
      addTo(largest_.col(o), orders(o, -1));
      for (std::size_t l = 0; l < m; ++l) addTo(beyond_[l].col(o), orders(o, static_cast<int>(l)));
    }
    for (std::size_t l = 0; l < m; ++l)
      for (std::size_t k = 0; k < l; ++k) {
        std::vector<int> once(m, 0);
        once[k] = once[l] = 1;
        addTo(Eigen::Ref<VectorXd>(mixed_[k][l]), once);
      }
  }
  largest_ = largest_ * (1 + kLost) + lost_;
  for (MatrixXd& b : beyond_) b *= 1 + kLost;
  for (auto& row : mixed_)
    for (VectorXd& b : row) b *= 1 + kLost;
}

}  // namespace dynwitness::crosscheck
