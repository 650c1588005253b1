// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/chart/raw_engines.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/chart/raw_simbody.hpp"
#include "recursive/newton_euler.hpp"

namespace dynwitness::crosscheck {

scene::State<double> stateForCheck(const recursive::Model<double>& model,
                                   const scene::State<double>& state) {
  scene::State<double> s = state;
  for (const recursive::LinkModel<double>& link : model.links) {
    if (link.kind != recursive::JointKind::kFloating) continue;
    for (int k = 3; k < 7; ++k) s.x[link.slot + k].q = k == 3 ? 1 : 0;
    for (int k = 0; k < 6; ++k) s.qd[link.dof + k] = 0;
  }
  return s;
}

void requireSame(const std::vector<double>& ours, const std::vector<double>& its,
                 const char* engine, const char* quantity) {
  if (ours.size() != its.size())
    throw std::logic_error(
        fmt::format("{}: another model without its witness: {} has {} numbers, not {}", engine,
                    quantity, its.size(), ours.size()));
  double difference = 0, largest = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const double d = std::abs(ours[i] - its[i]);
    if (!(d <= difference)) difference = std::isnan(difference) ? difference : d;
    largest = std::max(largest, std::abs(ours[i]));
  }
  if (!(difference <= largest / 1000))
    throw std::logic_error(
        fmt::format("{}: another model without its witness: {} differs by {:.2g}, the largest is "
                    "{:.2g}",
                    engine, quantity, difference, largest));
}

recursive::Model<double> bareModel(const recursive::Model<double>& model, bool with_rotors) {
  recursive::Model<double> bare = model;
  for (recursive::LinkModel<double>& link : bare.links) {
    link.spin = link.stiffness = link.viscous = link.positive = link.negative = 0;
    if (!with_rotors) link.rotor = 0;
    link.load = recursive::Force<double>::zero();
  }
  bare.world_loads.clear();
  bare.friction = bare.gyroscopic = false;
  return bare;
}

void requireSameModel(const recursive::Model<double>& model, const scene::State<double>& state,
                      const std::vector<double>& tau, const char* engine) {
  const recursive::Model<double> bare = bareModel(model, false);
  recursive::Workspace<double> workspace(bare);
  const scene::State<double> s = stateForCheck(model, state);
  std::vector<scene::JointPosition<double>> x;
  for (const scene::JointPosition<double>& position : s.x)
    x.push_back(scene::jointPosition(position.q));
  std::vector<double> ours(s.qd.size());
  recursive::inverseDynamics(bare, x, s.qd, s.qdd, workspace, ours);
  requireSame(ours, tau, engine, "tau");
}

namespace {

RawCalls rawSimbodyCalls(const recursive::Model<double>& model, Quantity quantity,
                         const scene::State<double>& state) {
  const auto simbody = std::make_shared<RawSimbody>(model);
  const scene::State<double> check = stateForCheck(model, state);
  std::vector<double> q;
  for (const scene::JointPosition<double>& x : check.x) q.push_back(x.q);
  simbody->inverseDynamics(q.data(), check.qd.data(), check.qdd.data());
  requireSameModel(model, state, simbody->inModelOrder(), "simbody");
  using State = scene::State<double>;
  using Positions = std::vector<double>;
  switch (quantity) {
    case Quantity::kM:
      return {[simbody](const State&, const Positions& q) { simbody->massMatrix(q.data()); },
              "simbody: realize(Position), calcM; without rotors"};
    case Quantity::kQdd:
      return {[simbody](const State& s, const Positions& q) {
                simbody->forwardDynamics(q.data(), s.qd.data(), s.tau.data());
              },
              "simbody: realize(Dynamics), calcAccelerationIgnoringConstraints; without rotors, "
              "springs, friction, loads"};
    default:
      return {[simbody](const State& s, const Positions& q) {
                simbody->inverseDynamics(q.data(), s.qd.data(), s.qdd.data());
              },
              "simbody: realize(Velocity), calcResidualForceIgnoringConstraints; without rotors, "
              "springs, friction, loads"};
  }
}

}  // namespace

std::optional<RawCalls> rawCalls(const std::string& witness, const scene::Scene& scene,
                                 const recursive::Model<double>& model, Quantity quantity,
                                 const scene::State<double>& state) {
  // mujoco_principal has other numbers in the same model, which take the same calls
  if (witness == "mujoco" || witness == "mujoco_principal")
    return rawMujocoCalls(scene, model, quantity, state);
  if (witness == "simbody") return rawSimbodyCalls(model, quantity, state);
  return std::nullopt;
}

}  // namespace dynwitness::crosscheck
