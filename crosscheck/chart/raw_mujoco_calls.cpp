// SPDX-License-Identifier: GPL-3.0-or-later
// A part of MuJoCo's module: how its users would ask it.
#include <memory>

#include "crosscheck/chart/raw_engines.hpp"
#include "crosscheck/chart/raw_mujoco.hpp"

namespace dynwitness::crosscheck {
namespace {

RawModel rawModel(const scene::Scene& scene, const recursive::Model<double>&, Quantity quantity,
                  const scene::State<double>& check) {
  const auto mujoco = std::make_shared<RawMujoco>(scene);
  const auto tau = std::make_shared<std::vector<double>>(check.qd.size());
  mujoco->inverseDynamics(check, tau->data());
  using State = scene::State<double>;
  using Positions = std::vector<double>;
  switch (quantity) {
    case Quantity::kM:
      return {{[mujoco](const State& s, const Positions&) { mujoco->massMatrix(s); },
               "mujoco: mj_kinematics, mj_comPos, mj_crb (M as MuJoCo keeps it)"},
              *tau};
    case Quantity::kQdd:
      return {{[mujoco](const State& s, const Positions&) { mujoco->forwardDynamics(s); },
               "mujoco: mj_forward; without springs, friction, loads"},
              *tau};
    default:
      return {{[mujoco, tau](const State& s, const Positions&) {
                 mujoco->inverseDynamics(s, tau->data());
               },
               "mujoco: mj_kinematics, mj_comPos, mj_comVel, mj_rne; without rotors, "
               "springs, friction, loads"},
              *tau};
  }
}

}  // namespace
}  // namespace dynwitness::crosscheck

dynwitness::crosscheck::MakeRawModel* const dynwitness_raw_engine =
    &dynwitness::crosscheck::rawModel;
