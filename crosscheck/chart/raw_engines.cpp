// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/chart/raw_engines.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/witnesses/engine_modules.hpp"
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

const RawEngine* rawEngine(const std::string& engine) {
  return static_cast<const RawEngine*>(engineSymbol(engine, "dynwitness_raw_engine"));
}

}  // namespace

std::optional<RawCalls> rawCalls(const std::string& witness, const scene::Scene& scene,
                                 const recursive::Model<double>& model, Quantity quantity,
                                 const scene::State<double>& state) {
  // mujoco_principal has other numbers in the same model, which take the same calls
  const std::string engine = witness == kMujocoPrincipal.name ? kMujoco.name : witness;
  const RawEngine* const raw = rawEngine(engine);
  if (raw == nullptr || raw->model == nullptr) return std::nullopt;
  RawModel its = raw->model(scene, model, quantity, stateForCheck(model, state));
  requireSameModel(model, state, its.tau, engine.c_str());
  return std::move(its.calls);
}

std::unique_ptr<RawSteps> rawSteps(const std::string& engine, const scene::Scene& scene,
                                   const recursive::Model<double>& model,
                                   const recursive::Constraints<double>& closures,
                                   const RawStep& step) {
  const RawEngine* const raw = rawEngine(engine);
  return raw == nullptr || raw->steps == nullptr ? nullptr
                                                 : raw->steps(scene, model, closures, step);
}

}  // namespace dynwitness::crosscheck
