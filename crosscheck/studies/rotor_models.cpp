// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/rotor_models.hpp"

#include <algorithm>
#include <cmath>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/mimic.hpp"

namespace dynwitness::crosscheck {
namespace {

/// The mechanism with its rotors of one kind, turning `faster` times as fast with the same n^2 J.
scene::Mechanism withRotors(scene::Mechanism mechanism, bool gyroscopic, int faster) {
  using scene::Number;
  for (scene::Link& link : mechanism.links) {
    scene::Joint& joint = link.joint;
    if (joint.rotor_inertia.isLiteralZero()) continue;
    joint.gyroscopic = gyroscopic;
    if (faster == 1) continue;
    const std::string n = "(" + joint.gear_ratio.text() + ")",
                      J = "(" + joint.rotor_inertia.text() + ")";
    const std::string factor = std::to_string(faster);
    joint.gear_ratio = Number::parse(n + "*" + factor);
    joint.rotor_inertia = Number::parse(J + "/" + factor + "^2");
  }
  return mechanism;
}

class InverseDynamics {
 public:
  explicit InverseDynamics(const scene::Mechanism& mechanism)
      : model_(recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism))),
        ws_(model_) {}
  std::vector<double> operator()(const scene::State<double>& state) {
    std::vector<double> tau(model_.dof());
    recursive::inverseDynamics(model_, state.x, state.qd, state.qdd, ws_, tau);
    return tau;
  }

 private:
  recursive::Model<double> model_;
  recursive::Workspace<double> ws_;
};

}  // namespace

const RotorModels::Joint& RotorModels::worst() const {
  return *std::max_element(joints.begin(), joints.end(),
                           [](const Joint& a, const Joint& b) { return a.share() < b.share(); });
}

RotorModels compareRotorModels(const scene::Scene& scene, int states, std::uint64_t seed) {
  constexpr int kFaster = 10;
  scene::requireNoMimics({scene.file.string(), 0}, scene.mechanism,
                         "the rotors are told apart by the force of their own joints");
  RotorModels out;
  out.states = states;
  out.seed = seed;
  const std::vector<std::string> labels = scene.mechanism.rateLabels();
  for (const scene::Link& link : scene.mechanism.links)
    for (int k = 0; k < scene::degreesOfFreedom(link.joint.kind); ++k) {
      out.joints.emplace_back();
      out.joints.back().name = labels[out.joints.size() - 1];
      out.joints.back().has_rotor = !link.joint.rotor_inertia.isLiteralZero();
    }
  if (std::none_of(out.joints.begin(), out.joints.end(), [](const auto& j) { return j.has_rotor; }))
    throw scene::InputError({scene.file.string(), 0},
                            "has no rotor, allowed: a scene with a rotor_inertia at least");

  InverseDynamics plain(withRotors(scene.mechanism, false, 1));
  InverseDynamics gyroscopic(withRotors(scene.mechanism, true, 1));
  InverseDynamics faster(withRotors(scene.mechanism, true, kFaster));
  for (int k = 0; k < states; ++k) {
    const scene::State<double> state = drawState(scene.mechanism, scene.name, seed, k);
    const std::vector<double> a = plain(state), b = gyroscopic(state), c = faster(state);
    for (std::size_t i = 0; i < out.joints.size(); ++i) {
      RotorModels::Joint& joint = out.joints[i];
      joint.largest_tau = std::max(joint.largest_tau, std::abs(b[i]));
      joint.at_ten_times = std::max(joint.at_ten_times, std::abs(c[i] - a[i]));
      if (std::abs(b[i] - a[i]) <= joint.largest) continue;
      joint.largest = std::abs(b[i] - a[i]);
      joint.worst_state = k;
    }
  }
  return out;
}

}  // namespace dynwitness::crosscheck
