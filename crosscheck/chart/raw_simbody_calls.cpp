// SPDX-License-Identifier: GPL-3.0-or-later
// A part of Simbody's module: how its users would ask it.
#include <memory>

#include "crosscheck/chart/raw_engines.hpp"
#include "crosscheck/chart/raw_simbody.hpp"

namespace dynwitness::crosscheck {
namespace {

RawModel rawModel(const scene::Scene&, const recursive::Model<double>& model, Quantity quantity,
                  const scene::State<double>& check) {
  const auto simbody = std::make_shared<RawSimbody>(model);
  std::vector<double> q;
  for (const scene::JointPosition<double>& x : check.x) q.push_back(x.q);
  simbody->inverseDynamics(q.data(), check.qd.data(), check.qdd.data());
  const std::vector<double> tau = simbody->inModelOrder();
  using State = scene::State<double>;
  using Positions = std::vector<double>;
  switch (quantity) {
    case Quantity::kM:
      return {{[simbody](const State&, const Positions& q) { simbody->massMatrix(q.data()); },
               "simbody: realize(Position), calcM; without rotors"},
              tau};
    case Quantity::kQdd:
      return {{[simbody](const State& s, const Positions& q) {
                 simbody->forwardDynamics(q.data(), s.qd.data(), s.tau.data());
               },
               "simbody: realize(Dynamics), calcAccelerationIgnoringConstraints; without rotors, "
               "springs, friction, loads"},
              tau};
    default:
      return {{[simbody](const State& s, const Positions& q) {
                 simbody->inverseDynamics(q.data(), s.qd.data(), s.qdd.data());
               },
               "simbody: realize(Velocity), calcResidualForceIgnoringConstraints; without rotors, "
               "springs, friction, loads"},
              tau};
  }
}

std::unique_ptr<RawSteps> makeSteps(const scene::Scene&, const recursive::Model<double>& model,
                                    const recursive::Constraints<double>& closures,
                                    const RawStep& step) {
  return rawSimbodySteps(model, closures, step);
}

}  // namespace
}  // namespace dynwitness::crosscheck

const dynwitness::crosscheck::RawEngine dynwitness_raw_engine = {
    &dynwitness::crosscheck::rawModel, &dynwitness::crosscheck::makeSteps};
