// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/chart/raw_engines.hpp"
#include "crosscheck/chart/raw_mujoco.hpp"

namespace dynwitness::crosscheck {

#ifdef DYNWITNESS_HAS_MUJOCO
std::optional<RawCalls> rawMujocoCalls(const scene::Scene& scene,
                                       const recursive::Model<double>& model, Quantity quantity,
                                       const scene::State<double>& state) {
  const auto mujoco = std::make_shared<RawMujoco>(scene);
  const auto tau = std::make_shared<std::vector<double>>(state.qd.size());
  mujoco->inverseDynamics(stateForCheck(model, state), tau->data());
  requireSameModel(model, state, *tau, "mujoco");
  using State = scene::State<double>;
  using Positions = std::vector<double>;
  switch (quantity) {
    case Quantity::kM:
      return RawCalls{[mujoco](const State& s, const Positions&) { mujoco->massMatrix(s); },
                      "mujoco: mj_kinematics, mj_comPos, mj_crb (M as MuJoCo keeps it)"};
    case Quantity::kQdd:
      return RawCalls{[mujoco](const State& s, const Positions&) { mujoco->forwardDynamics(s); },
                      "mujoco: mj_forward; without springs, friction, loads"};
    default:
      return RawCalls{[mujoco, tau](const State& s, const Positions&) {
                        mujoco->inverseDynamics(s, tau->data());
                      },
                      "mujoco: mj_kinematics, mj_comPos, mj_comVel, mj_rne; without rotors, "
                      "springs, friction, loads"};
  }
}
#else
std::optional<RawCalls> rawMujocoCalls(const scene::Scene&, const recursive::Model<double>&,
                                       Quantity, const scene::State<double>&) {
  return std::nullopt;
}
#endif

}  // namespace dynwitness::crosscheck
