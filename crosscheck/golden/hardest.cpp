// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/golden/hardest.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/golden/worst_state.hpp"
#include "crosscheck/verdicts/truth.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using State = scene::State<double>;

constexpr double kMostDigits = 17;  // two doubles that differ differ in these

double digitsOf(double loss) {
  return loss > 0 ? std::clamp(-std::log10(loss), 0.0, kMostDigits) : kMostDigits;
}

/// Truths, kept: all engines are asked at the same draws.
class KeptTruths {
 public:
  explicit KeptTruths(const scene::Mechanism& mechanism) : truth_(mechanism) {}

  const Certified& operator()(Quantity quantity, const State& state) {
    std::vector<double> key = {static_cast<double>(static_cast<int>(quantity))};
    for (const auto& x : state.x) key.push_back(x.q);
    for (const auto* part : {&state.qd, &state.qdd, &state.tau})
      key.insert(key.end(), part->begin(), part->end());
    const auto [it, is_new] = kept_.try_emplace(std::move(key));
    if (is_new) it->second = truth_(quantity, state);
    return it->second;
  }

 private:
  Truth truth_;
  std::map<std::vector<double>, Certified> kept_;
};

/// What an answer has lost of the largest entry; 0 where there is nothing to lose.
double lossOf(const Eigen::MatrixXd& answer, const Certified& truth) {
  if (!truth.exists()) return 0;
  const BallPrecision precision(Truth::kAccuracy);
  double farthest = 0, largest = 0;
  for (Eigen::Index k = 0; k < truth.value.size(); ++k) {
    const Ball& exact = truth.value.data()[k];
    if (!std::isfinite(answer.data()[k])) return 1;
    farthest = std::max(farthest, (Ball(answer.data()[k]) - exact).atMost());
    largest = std::max(largest, exact.atLeast());
  }
  return largest > 0 ? std::min(1.0, farthest / largest) : 0;
}

/// What the limits leave of the largest entry.
double allowedDigits(const GoldenAnswer& answer) {
  if (!answer.none.empty()) return 0;
  return digitsOf(answer.limit.maxCoeff() / answer.value.cwiseAbs().maxCoeff());
}

/// Each engine's hardest state of all that were found, whoever was asked there: what is hard for
/// one often is for others, and their searches have missed it.
template <typename LossOf>
void addGroup(Quantity quantity, const std::vector<Witness*>& engines,
              const std::vector<WorstState>& found, const LossOf& lossAt, Hardest* out) {
  GoldenGroup group{fmt::format("hardest_{}", name(quantity)),
                    fmt::format("for each engine the state at which it keeps the fewest digits of "
                                "{}, of those that seeded searches looked at",
                                name(quantity)),
                    0,
                    {}};
  std::map<std::size_t, std::size_t> place;  // found -> in the group
  const int first = static_cast<int>(out->golden.states());
  for (std::size_t e = 0; e < engines.size(); ++e) {
    double most = 0;
    std::size_t at = 0;
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (found[k].loss == 0) continue;
      const double here = lossAt(*engines[e], found[k].state);
      if (here > most) most = here, at = k;
    }
    if (most == 0) {
      out->golden.left_out.push_back(fmt::format("{} of {}: exact, or 0, wherever it was asked",
                                                 name(quantity), engines[e]->name()));
      continue;
    }
    const auto [it, is_new] = place.try_emplace(at, group.states.size());
    if (is_new) {
      GoldenState state;
      state.index = first + static_cast<int>(it->second);
      state.state = found[at].state;
      state.asked = {quantity};
      group.states.push_back(std::move(state));
    }
    GoldenState& state = group.states[it->second];
    const EngineLoss loss{engines[e]->name(), quantity, digitsOf(found[e].usual),
                          digitsOf(most),     0,        state.index};
    state.note += fmt::format("{}{} keeps {:.1f} digits, {:.1f} at half of those drawn",
                              state.note.empty() ? "" : "; ", loss.engine, loss.worst, loss.usual);
    out->losses.push_back(loss);
  }
  if (!group.states.empty()) out->golden.groups.push_back(std::move(group));
}

}  // namespace

Hardest hardestStates(const scene::Scene& scene, const HardestOptions& options) {
  std::vector<Quantity> quantities = options.quantities;
  if (quantities.empty())
    quantities = {Quantity::kM, Quantity::kc, Quantity::kg, Quantity::kTau, Quantity::kQdd};
  Hardest out;
  out.golden.scene = scene;
  out.golden.seed = options.seed;
  const PreparedScene prepared(scene);
  std::vector<std::unique_ptr<Witness>> engines;
  for (const WitnessKind& kind : options.engines) {
    MadeWitness made = kind.make(prepared);
    if (made.isRefused())
      out.golden.left_out.push_back(fmt::format("{}: {}", kind.info.name, made.refusal()));
    else
      engines.push_back(std::move(made).value());
  }
  scene::Work work("hardest states", static_cast<double>(quantities.size() * engines.size()));
  for (const Quantity quantity : quantities) {
    KeptTruths truths(scene.mechanism);
    std::vector<Witness*> asked;
    std::vector<WorstState> found;  // one an engine
    const auto loss = [&](Witness& engine, const State& state) {
      try {
        return lossOf(engine.value(quantity, state), truths(quantity, state));
      } catch (
          const std::runtime_error&) {  // it says that it has none, and does not answer wrongly
        return 0.0;
      }
    };
    for (const auto& engine : engines) {
      if (engine->answers(quantity)) {
        asked.push_back(engine.get());
        found.push_back(worstState(prepared, quantity, options.seed,
                                   [&](const State& state) { return loss(*engine, state); }));
      }
      work.done();
    }
    addGroup(quantity, asked, found, loss, &out);
  }
  answer(out.golden);
  for (const GoldenGroup& group : out.golden.groups)
    for (const GoldenState& state : group.states)
      for (EngineLoss& loss : out.losses)
        if (loss.state == state.index) loss.allowed = allowedDigits(state.answers.front());
  return out;
}

std::string hardestTable(const Hardest& hardest) {
  std::string rows;
  for (const EngineLoss& loss : hardest.losses)
    rows += fmt::format("| {} | {} | {} | {:.1f} | {:.1f} | {:.1f} | {} |\n",
                        hardest.golden.scene.name, name(loss.quantity), loss.engine, loss.usual,
                        loss.worst, loss.allowed, loss.state);
  return rows;
}

}  // namespace dynwitness::crosscheck
