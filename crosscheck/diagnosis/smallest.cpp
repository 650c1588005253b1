// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/smallest.hpp"

#include <algorithm>

#include "crosscheck/witnesses/optional_engine.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {
namespace {

/// The scene without that link, on which no other hangs. What ties points together goes: a witness
/// is asked about the tree.
scene::Scene without(const scene::Scene& scene, int cut) {
  scene::Scene out = scene;
  scene::Mechanism& m = out.mechanism;
  m.closures.clear();
  m.springs.clear();
  m.acceleration_constraints.clear();
  m.links.erase(m.links.begin() + cut);
  for (scene::Link& link : m.links)
    if (link.parent > cut) --link.parent;
  std::vector<scene::Wrench> wrenches;
  for (scene::Wrench w : m.wrenches) {
    if (w.link == cut) continue;
    if (w.link > cut) --w.link;
    wrenches.push_back(w);
  }
  m.wrenches = wrenches;
  out.start_q = m.restPosition();
  out.start_qd.assign(static_cast<std::size_t>(m.dof()), scene::Number(0));
  return out;
}

/// The state without what goes with that link's joint.
scene::State<double> without(const scene::State<double>& state, const scene::Mechanism& mechanism,
                             int cut) {
  std::ptrdiff_t q = 0, qd = 0;
  for (int i = 0; i < cut; ++i) {
    const scene::JointKind kind = mechanism.links[static_cast<std::size_t>(i)].joint.kind;
    q += static_cast<std::ptrdiff_t>(scene::positionSlots(kind).size());
    qd += scene::degreesOfFreedom(kind);
  }
  const scene::JointKind kind = mechanism.links[static_cast<std::size_t>(cut)].joint.kind;
  const auto slots = static_cast<std::ptrdiff_t>(scene::positionSlots(kind).size());
  const std::ptrdiff_t rates = scene::degreesOfFreedom(kind);
  scene::State<double> out = state;
  out.x.erase(out.x.begin() + q, out.x.begin() + q + slots);
  for (auto* part : {&out.qd, &out.qdd, &out.tau})
    part->erase(part->begin() + qd, part->begin() + qd + rates);
  return out;
}

/// Whether the witness made for the scene is wrong there.
class Trial {
 public:
  Trial(const scene::Scene& scene, const WitnessKind& kind, double factor)
      : scene_(scene), witness_(kind.make(scene_)) {
    if (!witness_.isRefused()) bench_ = std::make_unique<Bench>(scene_, **witness_, factor);
  }
  bool isWrong(Quantity quantity, const scene::State<double>& state) {
    if (!bench_ || !(*witness_)->answers(quantity)) return false;
    const Exhibit said = bench_->ask(quantity, state, 0);
    return said.failure.empty() && said.is_wrong;
  }

 private:
  scene::Scene scene_;
  MadeWitness witness_;
  std::unique_ptr<Bench> bench_;
};

}  // namespace

std::optional<Smallest> smallestFailure(const scene::Scene& scene, const WitnessKind& kind,
                                        Quantity quantity, const scene::State<double>& state,
                                        double factor) {
  auto trial = std::make_unique<Trial>(scene, kind, factor);
  if (!trial->isWrong(quantity, state)) return {};
  Smallest out;
  out.scene = scene;
  out.quantity = quantity;
  scene::State<double> at = state;
  for (bool shorter = true; shorter;) {
    shorter = false;
    const scene::Mechanism& m = out.scene.mechanism;
    for (int i = static_cast<int>(m.links.size()) - 1; i > 0 && !shorter; --i) {
      if (std::any_of(m.links.begin(), m.links.end(),
                      [i](const scene::Link& link) { return link.parent == i; }))
        continue;
      const scene::Scene less = without(out.scene, i);
      if (less.mechanism.dof() == 0) continue;
      try {
        scene::validate(less);
      } catch (const scene::InputError&) {
        continue;  // what is left is no mechanism
      }
      const scene::State<double> there = without(at, m, i);
      auto next = std::make_unique<Trial>(less, kind, factor);
      if (!next->isWrong(quantity, there)) continue;
      out.cut.push_back(m.links[static_cast<std::size_t>(i)].name);
      at = there;
      trial = std::move(next);
      out.scene = less;
      shorter = true;
    }
  }

  const auto rest = [&](std::vector<double> scene::State<double>::*part) {
    for (std::size_t i = 0; i < (at.*part).size(); ++i) {
      scene::State<double> calmer = at;
      (calmer.*part)[i] = 0;
      if ((at.*part)[i] != 0 && trial->isWrong(quantity, calmer)) at = calmer;
    }
  };
  rest(&scene::State<double>::qdd);
  rest(&scene::State<double>::qd);
  rest(&scene::State<double>::tau);
  const scene::RealNumbers<double> number(out.scene.mechanism);
  const std::vector<scene::Number> home = out.scene.mechanism.restPosition();
  for (std::size_t i = 0; i < at.x.size(); ++i) {
    scene::State<double> calmer = at;
    calmer.x[i] = scene::jointPosition(number(home[i]));
    if (trial->isWrong(quantity, calmer)) at = calmer;
  }

  for (const auto& x : at.x) out.q.push_back(x.q);
  out.qd = at.qd;
  if (quantity == Quantity::kTau) out.qdd = at.qdd;
  if (quantity == Quantity::kQdd) out.tau = at.tau;
  int q = 0, qd = 0;
  for (const scene::Link& link : out.scene.mechanism.links) {
    const auto slots = static_cast<int>(scene::positionSlots(link.joint.kind).size());
    const int rates = scene::degreesOfFreedom(link.joint.kind);
    bool is_moved = false;
    for (int k = 0; k < slots; ++k)
      is_moved = is_moved || at.x[static_cast<std::size_t>(q + k)].q !=
                                 number(home[static_cast<std::size_t>(q + k)]);
    for (int k = 0; k < rates; ++k)
      for (const auto* part : {&out.qd, &out.qdd, &out.tau})
        is_moved = is_moved || (!part->empty() && (*part)[static_cast<std::size_t>(qd + k)] != 0);
    if (is_moved) out.joints.push_back(link.joint.name);
    q += slots;
    qd += rates;
  }
  out.scene.name = scene.name + "_smallest";
  out.scene.title = "What is left of " + scene.name + " and still fails";
  return out;
}

}  // namespace dynwitness::crosscheck
