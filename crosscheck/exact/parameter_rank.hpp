// SPDX-License-Identifier: GPL-3.0-or-later
// How many combinations of inertial parameters joint forces can tell: the rank of the regressor,
// over the prime field.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "crosscheck/scalars/prime_field.hpp"
#include "scene/inertial_parameters.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// Rows of a matrix as they come, in reduced echelon form, columns being tried in an order.
class Echelon {
 public:
  explicit Echelon(const std::vector<int>& order) : order_(order), place_(order.size()) {
    for (std::size_t k = 0; k < order.size(); ++k) place_[order[k]] = static_cast<int>(k);
  }

  /// @return whether the row does not depend on those before
  bool add(const std::vector<PrimeField>& given) {
    std::vector<PrimeField> row;
    for (const int j : order_) row.push_back(given[j]);
    for (const auto& [pivot, other] : rows_) subtract(row, row[pivot], other);
    const auto lead =
        std::find_if(row.begin(), row.end(), [](PrimeField x) { return !x.isZero(); });
    if (lead == row.end()) return false;
    const PrimeField scale = lead->inverse();
    for (PrimeField& x : row) x *= scale;
    const int pivot = static_cast<int>(lead - row.begin());
    for (auto& [p, other] : rows_) subtract(other, other[pivot], row);
    const auto place = std::find_if(rows_.begin(), rows_.end(),
                                    [&](const auto& r) { return order_[r.first] > order_[pivot]; });
    rows_.insert(place, {pivot, std::move(row)});
    return true;
  }
  int rank() const { return static_cast<int>(rows_.size()); }
  /// The first column tried of each row, rising; the rows are 1 there and 0 at each other's.
  std::vector<int> pivots() const {
    std::vector<int> out;
    for (const auto& [pivot, row] : rows_) out.push_back(order_[pivot]);
    return out;
  }
  PrimeField operator()(int row, int column) const { return rows_[row].second[place_[column]]; }
  int columns() const { return static_cast<int>(order_.size()); }

 private:
  static void subtract(std::vector<PrimeField>& row, PrimeField factor,
                       const std::vector<PrimeField>& other) {
    if (factor.isZero()) return;
    for (std::size_t j = 0; j < row.size(); ++j) row[j] -= factor * other[j];
  }
  std::vector<int> order_, place_;  ///< place_[order_[k]] = k; rows are in that order
  std::vector<std::pair<int, std::vector<PrimeField>>> rows_;
};

/** The order in which columns are tried: links from the base outward, of each its inertia, then its
    first moment, then its mass, and rotors last. So what a joint's motion cannot tell apart (a
    point mass on its axis, a rod along it or across it) is what is counted to the link inboard, and
    K is small. */
std::vector<int> eliminationOrder(const std::vector<scene::InertialParameter>& parameters);

/// State k of a trial; the numbers of the scene are the same for all of them.
FieldSource regressorSource(const scene::Scene& scene, std::uint64_t seed, int trial, int k);

/// Y stacked over random states, until one adds nothing: then none does.
struct RegressorStack {
  Echelon echelon;
  int states;
};
/// In the scope of a Modulus.
RegressorStack stackRegressor(const scene::Scene& scene,
                              const std::vector<scene::InertialParameter>& parameters,
                              std::uint64_t seed, int trial,
                              Parameters given = Parameters::kAsWritten);

/** Chance that one trial finds too small a rank. After each state, some minor of at most p rows of
    the stack is not zero as a formula and may vanish at the point: p + 1 states at most. Its size
    is that of p factors, each no larger than the sum of all entries of Y, and p! terms. */
double chanceOfTooSmallRank(const scene::Scene& scene,
                            const std::vector<scene::InertialParameter>& parameters);

}  // namespace dynwitness::crosscheck
