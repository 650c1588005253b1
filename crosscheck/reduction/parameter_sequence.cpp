// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/parameter_sequence.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "crosscheck/reduction/envelope_sampler.hpp"
#include "crosscheck/reduction/omissions.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::Mechanism;

constexpr int kSampled = 400;  ///< states that decide in which order parameters go

bool isPossible(const scene::Scene& scene) {
  try {
    scene::validate(scene);
    return true;
  } catch (const scene::InputError&) {
    return false;
  }
}

/// All that a link that moves can be without.
std::vector<Omission> omissionsOf(const Mechanism& mechanism) {
  using What = Omission::What;
  std::vector<Omission> out;
  const std::vector<scene::Link>& links = mechanism.links;
  std::vector<bool> moves(links.size(), false);  // what rests is in no force
  for (std::size_t l = 1; l < links.size(); ++l) {
    moves[l] = moves[static_cast<std::size_t>(links[l].parent)] ||
               links[l].joint.kind != scene::JointKind::kFixed;
    if (!moves[l]) continue;
    for (const What what :
         {What::kProducts, What::kInertia, What::kOnAxis, What::kMass, What::kRotor})
      out.push_back({l, what});
    for (int k = 0; k < 3; ++k) out.push_back({l, What::kCom, k});
  }
  return out;
}

}  // namespace

ReductionSamples::ReductionSamples(const Mechanism& mechanism,
                                   const std::vector<scene::JointRanges>& ranges,
                                   ReducedQuantity of)
    : of_(of) {
  EnvelopeSampler sampler(
      ranges, 16,
      of == ReducedQuantity::kTau ? EnvelopeSampler::Given::kQdd : EnvelopeSampler::Given::kTau);
  for (int s = 0; s < kSampled; ++s) states_.push_back(sampler.next());
  answers_ = this->of(mechanism);
}

std::vector<std::vector<double>> ReductionSamples::of(const Mechanism& mechanism) const {
  const auto model = recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism));
  recursive::Workspace<double> ws(model);
  std::vector<std::vector<double>> all;
  std::vector<scene::JointPosition<double>> x;
  for (const EnvelopeState& s : states_) {
    x.clear();
    for (const double q : s.q) x.push_back(scene::jointPosition(q));
    std::vector<double> out(s.qd.size());
    if (of_ == ReducedQuantity::kTau)
      recursive::inverseDynamics(model, x, s.qd, s.qdd, ws, out);
    else
      recursive::forwardDynamics(model, x, s.qd, s.tau, ws, out);
    all.push_back(out);
  }
  return all;
}

std::vector<ReductionSamples::Worst> ReductionSamples::worst(const Mechanism& mechanism) const {
  const std::vector<std::vector<double>> mine = of(mechanism);
  std::vector<Worst> out(answers_.front().size());
  for (std::size_t s = 0; s < mine.size(); ++s)
    for (std::size_t i = 0; i < out.size(); ++i)
      if (const double off = std::abs(mine[s][i] - answers_[s][i]); !(off <= out[i].error))
        out[i] = {std::isnan(off) ? HUGE_VAL : off, states_[s]};  // M is singular
  return out;
}

double ReductionSamples::error(const Mechanism& mechanism,
                               const std::vector<double>& largest) const {
  const std::vector<Worst> worst_of = worst(mechanism);
  double most = 0;
  for (std::size_t i = 0; i < largest.size(); ++i)
    if (largest[i] > 0) most = std::max(most, worst_of[i].error / largest[i]);
  return most;
}

std::vector<ReducedBase> parameterSequence(const scene::Scene& scene,
                                           const ReductionSamples& samples,
                                           const std::vector<double>& largest, double until) {
  const std::vector<Omission> omissions = omissionsOf(scene.mechanism);
  std::vector<ReducedBase> all = {{scene, {}, 0}};
  scene::Work work("parameters", static_cast<double>(omissions.size()));
  for (;; work.done()) {
    std::optional<ReducedBase> best;
    for (const Omission& omission : omissions) {
      ReducedBase next = all.back();
      if (!apply(omission, &next.scene.mechanism) || !isPossible(next.scene)) continue;
      next.sampled = samples.error(next.scene.mechanism, largest);
      if (best && best->sampled <= next.sampled) continue;
      next.dropped.push_back({words(omission, scene.mechanism), next.sampled});
      best = next;
    }
    if (!best || best->sampled > until) return all;
    all.push_back(*best);
  }
}

}  // namespace dynwitness::crosscheck
