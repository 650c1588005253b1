// SPDX-License-Identifier: GPL-3.0-or-later
// MuJoCo called as its users call it: no witness around it, no copies.
#pragma once

#include <mujoco/mujoco.h>

#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "crosscheck/witnesses/mujoco_model.hpp"
#include "scene/numbers.hpp"
#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// A scene in MuJoCo, links on fixed joints fused; springs and friction are left out. Joints keep
/// the order of the file, which is that of the scene for a tree written depth first. Of a floating
/// joint the linear rates are the world's in MuJoCo and the link's in the scene: the same work.
class RawMujoco {
 public:
  explicit RawMujoco(const scene::Scene& scene) : RawMujoco(scene, urdf(scene), "scene.urdf") {}
  /// @param text  the scene as URDF or MJCF, in a file of that name
  RawMujoco(const scene::Scene& scene, const std::string& text, const char* file) {
    std::string error;
    model_ = mujocoModelOf(text, file, &error);
    if (!model_) throw std::runtime_error(error);
    const scene::RealNumbers<double> number(scene.mechanism);
    if (model_->nv != scene.mechanism.dof()) throw std::runtime_error("other joints");
    int dof = 0;
    for (const int link : scene.mechanism.movingLinks()) {
      const scene::Joint& joint = scene.mechanism.links[link].joint;
      const double gear = number(joint.gear_ratio);
      for (int k = 0; k < scene::degreesOfFreedom(joint.kind); ++k)
        model_->dof_armature[dof++] = gear * gear * number(joint.rotor_inertia);
    }
    for (int k = 0; k < 3; ++k)
      model_->opt.gravity[k] = scene.mechanism.has_gravity ? number(scene.mechanism.gravity[k]) : 0;
    data_.reset(mj_makeData(model_.get()));
    mj_setConst(model_.get(), data_.get());
  }

  int bodies() const { return model_->nbody; }
  mjModel* model() const { return model_.get(); }
  mjData* data() const { return data_.get(); }

  void inverseDynamics(const scene::State<double>& s, double* tau) {
    set(s);
    std::memcpy(data_->qvel, s.qd.data(), s.qd.size() * sizeof(double));
    std::memcpy(data_->qacc, s.qdd.data(), s.qdd.size() * sizeof(double));
    mj_kinematics(model_.get(), data_.get());
    mj_comPos(model_.get(), data_.get());
    mj_comVel(model_.get(), data_.get());
    mj_rne(model_.get(), data_.get(), 1, tau);
  }
  void massMatrix(const scene::State<double>& s) {
    set(s);
    mj_kinematics(model_.get(), data_.get());
    mj_comPos(model_.get(), data_.get());
    mj_crb(model_.get(), data_.get());
  }
  void forwardDynamics(const scene::State<double>& s) {
    set(s);
    std::memcpy(data_->qvel, s.qd.data(), s.qd.size() * sizeof(double));
    std::memcpy(data_->qfrc_applied, s.tau.data(), s.tau.size() * sizeof(double));
    mj_forward(model_.get(), data_.get());
  }
  /// One-sided differences of a step, h apart: A of 2n x 2n, how (q, qd) after it follow from those
  /// before.
  void stepDifferences(const scene::State<double>& s, double h, double* A) {
    set(s);
    std::memcpy(data_->qvel, s.qd.data(), s.qd.size() * sizeof(double));
    std::memcpy(data_->qfrc_applied, s.tau.data(), s.tau.size() * sizeof(double));
    mjd_transitionFD(model_.get(), data_.get(), h, 0, A, nullptr, nullptr, nullptr);
  }
  const void* results() const { return data_->qacc; }

 private:
  static std::string urdf(const scene::Scene& scene) {
    std::string text = scene::urdfForEngines(scene);
    text.insert(text.rfind("</robot>"),
                "<mujoco><compiler fusestatic=\"true\" inertiafromgeom=\"false\" "
                "balanceinertia=\"true\"/></mujoco>");
    return text;
  }
  void set(const scene::State<double>& s) {
    for (std::size_t i = 0; i < s.x.size(); ++i) data_->qpos[i] = s.x[i].q;
  }
  MujocoOwned<mjModel> model_;
  MujocoOwned<mjData> data_;
};

}  // namespace dynwitness::crosscheck
