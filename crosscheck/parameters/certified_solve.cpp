// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/parameters/certified_solve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/regressor.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr long kSharpBits = 80;
/// What is certainly below this is taken for the zero that special angles make (cos = sin at 45
/// degrees).
const double kNothing = std::ldexp(1, -kSharpBits);

/// Rows of Y as balls, with the columns of Y_1 eliminated to the unit matrix: what K is then stands
/// in the first rows. @return false: a pivot contains zero, more precision is needed
bool eliminate(std::vector<std::vector<Ball>>& rows, const std::vector<int>& columns) {
  scene::Work work("coefficients enclosed", static_cast<double>(columns.size()), 30);
  for (std::size_t k = 0; k < columns.size(); ++k, work.done()) {
    const int j = columns[k];
    std::size_t best = k;
    for (std::size_t i = k; i < rows.size(); ++i)
      if (rows[i][j].atLeast() > rows[best][j].atLeast()) best = i;
    if (k >= rows.size() || rows[best][j].containsZero()) return false;
    std::swap(rows[k], rows[best]);
    const Ball scale = Ball(1) / rows[k][j];
    for (Ball& x : rows[k]) x *= scale;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (i == k || rows[i][j].isZero()) continue;
      const Ball factor = rows[i][j];
      for (std::size_t c = 0; c < rows[i].size(); ++c)
        if (!rows[k][c].isZero()) rows[i][c] -= factor * rows[k][c];
    }
  }
  return true;
}

std::vector<std::vector<Ball>> stackRows(const scene::Scene& scene, std::uint64_t seed,
                                         const BaseParameters& base) {
  const auto model = recursive::buildModel(scene.mechanism, BallNumbers(scene.mechanism));
  recursive::Workspace<Ball> ws(model);
  recursive::MatrixX<Ball> Y(model.dof(), base.parameters.size());
  std::vector<std::vector<Ball>> rows;
  for (int k = 0; k < 2 * base.states; ++k) {  // twice as many as generic states need
    const auto state = ballState(drawState(scene.mechanism, scene.name, seed, k), scene.mechanism);
    recursive::regressor(model, base.parameters, state.x, state.qd, state.qdd, ws, Y);
    for (Eigen::Index i = 0; i < Y.rows(); ++i) {
      rows.emplace_back();
      for (Eigen::Index j = 0; j < Y.cols(); ++j) rows.back().push_back(Y(i, j));
    }
  }
  return rows;
}

}  // namespace

void encloseCoefficients(const scene::Scene& scene, std::uint64_t seed, BaseParameters& base) {
  const auto failed = [&](const std::string& what) {
    return std::logic_error(scene.name + ": regrouping: " + what);
  };
  for (long bits = 256; bits <= 4096; bits *= 2) {
    const BallPrecision precision(bits);
    std::vector<std::vector<Ball>> rows = stackRows(scene, seed, base);
    if (!eliminate(rows, base.independent)) continue;
    bool sharp = true;
    auto next = base.K.begin();
    for (int r = 0; r < base.count(); ++r) {
      for (int j = 0; j < static_cast<int>(base.parameters.size()); ++j) {
        if (std::find(base.independent.begin(), base.independent.end(), j) !=
            base.independent.end())
          continue;
        const Ball& entry = rows[r][j];
        const bool listed = next != base.K.end() && next->base == r && next->parameter == j;
        if (!listed) {
          if (!entry.containsZero()) throw failed("an entry is zero over the field only");
          continue;
        }
        sharp = sharp && (entry.isSharp(kSharpBits) || entry.atMost() < kNothing);
        if (next->exact && !entry.contains(*next->exact))
          throw failed("a rational is not in its ball");
        next->value = entry.mid();
        // the midpoint was rounded to a double
        next->error =
            entry.radius() + std::abs(entry.mid()) * std::numeric_limits<double>::epsilon();
        ++next;
      }
    }
    if (!sharp) continue;
    // at the scene's own angles, where the field has generic ones
    const auto vanishes = [](const Coefficient& c) {
      return std::abs(c.value) + c.error < kNothing;
    };
    base.K.erase(std::remove_if(base.K.begin(), base.K.end(), vanishes), base.K.end());
    return;
  }
  throw failed("no certain digits with 4096 bits");
}

}  // namespace dynwitness::crosscheck
