// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/golden/worst_state.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/witnesses/engine_bound.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr int kGridBits = 10;
constexpr double kQuarterTurn = 1.5707963267948966;
constexpr double kFarthest = 4;  ///< [rad], [m], [rad/s], [m/s]: where the search turns back

/// How much of a quantity rounding may take at a state.
class Loss {
 public:
  Loss(const PreparedScene& scene, Quantity quantity)
      : quantity_(quantity), sweeps_(scene), bound_(scene) {}

  /// @return  largest limit over largest entry; 0 where either is 0 or no number
  double operator()(const scene::State<double>& state) {
    const Eigen::MatrixXd value = quantity_ == Quantity::kQdd
                                      ? ArticulatedBody::answer(sweeps_, quantity_, state)
                                      : NewtonEuler::answer(sweeps_, quantity_, state);
    const double loss = bound_(quantity_, state).maxCoeff() / value.cwiseAbs().maxCoeff();
    return std::isfinite(loss) ? loss : 0;
  }

 private:
  Quantity quantity_;
  Setup<double> sweeps_;
  EngineBound bound_;
};

/// Puts angles near quarter turns, where arms are stretched and axes align.
void straighten(const std::vector<scene::SlotKind>& slots, scene::State<double>* state) {
  for (std::size_t k = 0; k < slots.size(); ++k)
    if (slots[k] == scene::SlotKind::kAngle)
      state->x[k] = scene::jointPosition(
          onGrid(kQuarterTurn * std::nearbyint(state->x[k].q / kQuarterTurn), kGridBits));
}

}  // namespace

double onGrid(double x, int bits) {
  return std::ldexp(std::nearbyint(std::ldexp(x, bits)), -bits) + 0.0;  // no -0
}

scene::State<double> plainState(const scene::Mechanism& mechanism, const std::string& name,
                                std::uint64_t seed, std::uint64_t index) {
  scene::State<double> state = drawState(mechanism, name, seed, index);
  const std::vector<scene::SlotKind> slots = mechanism.slots();
  for (std::size_t k = 0; k < slots.size(); ++k) {
    if (slots[k] != scene::SlotKind::kQuaternion) {
      state.x[k] = scene::jointPosition(onGrid(state.x[k].q, kGridBits));
      continue;
    }
    double length2 = 0;
    for (std::size_t i = k; i < k + 4; ++i) length2 += state.x[i].q * state.x[i].q;
    for (std::size_t i = k; i < k + 4; ++i)
      state.x[i] = scene::jointPosition(onGrid(state.x[i].q / std::sqrt(length2), kGridBits));
    k += 3;
  }
  for (auto* part : {&state.qd, &state.qdd, &state.tau})
    for (double& x : *part) x = onGrid(x, kGridBits);
  return state;
}

WorstState worstState(const PreparedScene& scene, Quantity quantity, std::uint64_t seed) {
  Loss loss(scene, quantity);
  return worstState(scene, quantity, seed,
                    [&loss](const scene::State<double>& state) { return loss(state); });
}

WorstState worstState(const PreparedScene& scene, Quantity quantity, std::uint64_t seed,
                      const std::function<double(const scene::State<double>&)>& loss) {
  constexpr int kDraws = 64, kSteps = 192, kSizes = 9;
  const scene::Mechanism& mechanism = scene.mechanism();
  const std::vector<scene::SlotKind> slots = mechanism.slots();
  const std::string name = scene.scene().name + " worst " + crosscheck::name(quantity);
  WorstState worst;
  std::vector<double> drawn;
  for (int k = 0; k < kDraws; ++k) {
    scene::State<double> state =
        plainState(mechanism, name, seed, static_cast<std::uint64_t>(k) / 2);
    if (k % 2 == 1) straighten(slots, &state);
    const double here = loss(state);
    if (k % 2 == 0) drawn.push_back(here);
    if (k == 0 || here > worst.loss) {
      worst.loss = here;
      worst.state = state;
    }
  }
  worst.looked_at = kDraws;
  std::nth_element(drawn.begin(), drawn.begin() + static_cast<std::ptrdiff_t>(drawn.size() / 2),
                   drawn.end());
  worst.usual = drawn[drawn.size() / 2];
  if (worst.loss == 0) return worst;
  RandomStream random(name + " steps", seed, 0);
  const bool rates_count = quantity != Quantity::kg;
  const auto positions = static_cast<double>(slots.size()),
             rates = rates_count ? static_cast<double>(worst.state.qd.size()) : 0.0;
  for (int k = 0; k < kSteps; ++k) {
    scene::State<double> state = worst.state;
    const auto at = static_cast<std::size_t>(random.uniform(0, positions + rates));
    const double step = std::ldexp(random.uniform(0, 1) < 0.5 ? -1 : 1, -1 - k % kSizes);
    const bool is_position = at < slots.size();
    if (is_position && slots[at] == scene::SlotKind::kQuaternion) continue;
    const double moved = step + (is_position ? state.x[at].q : state.qd[at - slots.size()]);
    if (std::abs(moved) > kFarthest) continue;
    if (is_position)
      state.x[at] = scene::jointPosition(moved);
    else
      state.qd[at - slots.size()] = moved;
    ++worst.looked_at;
    const double here = loss(state);
    if (!(here > worst.loss)) continue;
    worst.loss = here;
    worst.state = state;
  }
  return worst;
}

}  // namespace dynwitness::crosscheck
