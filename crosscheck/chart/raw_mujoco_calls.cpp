// SPDX-License-Identifier: GPL-3.0-or-later
// A part of MuJoCo's module: how its users would ask it.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/chart/raw_engines.hpp"
#include "crosscheck/chart/raw_mujoco.hpp"
#include "crosscheck/witnesses/mjcf.hpp"
#include "crosscheck/witnesses/mujoco_closures.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Its joints and closures alone.
scene::Scene bareScene(scene::Scene scene) {
  scene.mechanism.springs.clear();
  scene.mechanism.wrenches.clear();
  return scene;
}

/// MuJoCo reads no closures from URDF.
std::string mjcfOf(const scene::Scene& scene, const MujocoClosures& closures) {
  const ToldNumbers number(scene.mechanism);
  std::vector<std::string> inertials;
  for (const scene::Link& link : scene.mechanism.links) {
    const ToldNumbers::Inertia m = number.inertia(link.inertia);
    const auto told = [](const ToldNumbers::Real& x) { return static_cast<double>(x); };
    // a plane mechanism may leave out moments about axes that do not turn, which MuJoCo refuses
    const auto I = [&](int i, int k) {
      return i == k ? std::max(told(m.I(i, k)), 1000 * mjMINVAL) : told(m.I(i, k));
    };
    inertials.push_back(
        m.mass == 0
            ? ""
            : fmt::format("<inertial mass=\"{}\" pos=\"{}\" fullinertia=\"{}\"/>",
                          mjcfNumbers({told(m.mass)}),
                          mjcfNumbers({told(m.com[0]), told(m.com[1]), told(m.com[2])}),
                          mjcfNumbers({I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)})));
    inertials.back() += closures.sites(inertials.size() - 1);
  }
  std::string text = mjcf(scene.mechanism, inertials);
  text.insert(text.rfind("</mujoco>"),
              fmt::format("<compiler inertiafromgeom=\"false\" balanceinertia=\"true\"/>"
                          "<size njmax=\"{}\" nconmax=\"1\"/>{}",
                          closures.mostRows(), closures.elements()));
  return text;
}

class MujocoSteps : public RawSteps {
 public:
  MujocoSteps(const scene::Scene& scene, const RawStep& step) {
    if (scene.mechanism.closures.empty()) {
      mujoco_.emplace(scene);
    } else {
      closures_.emplace(scene.mechanism);
      mujoco_.emplace(scene, mjcfOf(scene, *closures_), "scene.xml");
      std::vector<int> links;
      for (std::size_t i = 0; i < scene.mechanism.links.size(); ++i)
        links.push_back(
            mj_name2id(mujoco_->model(), mjOBJ_BODY, mjcfLink(static_cast<int>(i)).c_str()));
      closures_->find(mujoco_->model(), links);
    }
    mjModel* model = mujoco_->model();
    model->opt.integrator = step.is_runge_kutta ? mjINT_RK4 : mjINT_EULER;
    model->opt.timestep = step.h;
    model->opt.disableflags |= mjDSBL_CONTACT | mjDSBL_LIMIT | mjDSBL_FRICTIONLOSS | mjDSBL_SENSOR;
    if (!closures_) model->opt.disableflags |= mjDSBL_CONSTRAINT;
    // damping would be implicit in Euler's steps
    std::fill_n(model->dof_damping, model->nv, 0.0);
    std::fill_n(model->jnt_stiffness, model->njnt, 0.0);
    for (int i = 0; i < model->neq; ++i)  // as hard as it allows
      std::fill_n(model->eq_solimp + mjNIMP * i, 2, mjMAXIMP);
  }

  void start(const scene::State<double>& state) override {
    mjModel* model = mujoco_->model();
    mjData* data = mujoco_->data();
    mj_resetData(model, data);
    for (std::size_t i = 0; i < state.x.size(); ++i) data->qpos[i] = state.x[i].q;
    std::copy(state.qd.begin(), state.qd.end(), data->qvel);
    std::copy(state.tau.begin(), state.tau.end(), data->qfrc_applied);
    if (!closures_) return;
    mj_kinematics(model, data);
    closures_->place(model, data);
  }
  void step() override { mj_step(mujoco_->model(), mujoco_->data()); }
  std::vector<double> positions() const override {
    return {mujoco_->data()->qpos, mujoco_->data()->qpos + mujoco_->model()->nq};
  }
  std::vector<double> rates() const override {
    return {mujoco_->data()->qvel, mujoco_->data()->qvel + mujoco_->model()->nv};
  }

 private:
  std::optional<MujocoClosures> closures_;
  std::optional<RawMujoco> mujoco_;
};

std::unique_ptr<RawSteps> makeSteps(const scene::Scene& scene, const recursive::Model<double>&,
                                    const recursive::Constraints<double>&, const RawStep& step) {
  return std::make_unique<MujocoSteps>(bareScene(scene), step);
}

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

const dynwitness::crosscheck::RawEngine dynwitness_raw_engine = {
    &dynwitness::crosscheck::rawModel, &dynwitness::crosscheck::makeSteps};
