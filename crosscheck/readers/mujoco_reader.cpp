// SPDX-License-Identifier: GPL-3.0-or-later
// MuJoCo as a reader of robot descriptions: the user's bytes, and no compiler option set. (As a
// witness of the crosscheck it is told to fuse, balance and infer nothing: witnesses/mujoco.cpp.)
#include "crosscheck/readers/reader.hpp"

#ifdef DYNWITNESS_HAS_MUJOCO
#include <mujoco/mujoco.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "crosscheck/witnesses/mujoco_model.hpp"
#endif

namespace dynwitness::crosscheck {

#ifdef DYNWITNESS_HAS_MUJOCO
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

std::shared_ptr<mjModel> compiled(const std::string& text, std::string* refusal) {
  try {
    return mujocoModelOf(text, "robot.urdf", refusal);
  } catch (const std::exception& thrown) {
    *refusal = thrown.what();
    return nullptr;
  }
}

Vector3d vector(const mjtNum* x) {
  return {x[0], x[1], x[2]};
}
Matrix3d turn(const mjtNum* q) {
  return Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}
Eigen::Isometry3d frame(const mjtNum* p, const mjtNum* q) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = turn(q);
  X.translation() = vector(p);
  return X;
}

std::string nameOf(const mjModel& m, mjtObj kind, int id) {
  const char* name = mj_id2name(&m, kind, id);
  return name ? name : "";
}

scene::JointKind kindOf(const mjModel& m, int body) {
  const int first = m.body_jntadr[body], count = m.body_jntnum[body];
  const auto type = [&](int k) { return m.jnt_type[first + k]; };
  if (type(0) == mjJNT_FREE || (count == 4 && type(3) == mjJNT_BALL))
    return scene::JointKind::kFloating;
  if (count == 3) return scene::JointKind::kPlanar;
  if (type(0) == mjJNT_BALL) return scene::JointKind::kSpherical;
  return type(0) == mjJNT_SLIDE ? scene::JointKind::kPrismatic : scene::JointKind::kRevolute;
}

ReadBody readJoint(const mjModel& m, int body) {
  const int joint = m.body_jntadr[body], dof = m.jnt_dofadr[joint];
  ReadBody out;
  out.link = nameOf(m, mjOBJ_BODY, body);
  out.joint = nameOf(m, mjOBJ_JOINT, joint);
  out.kind = kindOf(m, body);
  if (out.kind != scene::JointKind::kRevolute && out.kind != scene::JointKind::kPrismatic) {
    out.axis = Vector3d::Zero();  // several; the axes are not compared
    return out;
  }
  out.axis = vector(m.jnt_axis + 3 * joint);
  if (m.jnt_limited[joint]) {
    out.lower = m.jnt_range[2 * joint];
    out.upper = m.jnt_range[2 * joint + 1];
  }
  out.damping = m.dof_damping[dof];
  out.friction = m.dof_frictionloss[dof];
  out.armature = m.dof_armature[dof];
  out.stiffness = m.jnt_stiffness[joint];
  for (int e = 0; e < m.neq; ++e) {
    if (m.eq_type[e] != mjEQ_JOINT || m.eq_obj1id[e] != joint || m.eq_obj2id[e] < 0) continue;
    out.leader = nameOf(m, mjOBJ_JOINT, m.eq_obj2id[e]);
    out.offset = m.eq_data[mjNEQDATA * e];
    out.multiplier = m.eq_data[mjNEQDATA * e + 1];
  }
  return out;
}

Robot robotOf(const mjModel& m, std::vector<int>* dofs) {
  Robot robot;
  robot.gravity = vector(m.opt.gravity);
  robot.unturned = std::sqrt(2 * kMujocoTurnStop);
  // what a body without joints is fixed to, and where it is seen from there
  std::vector<int> carrier(static_cast<std::size_t>(m.nbody), -1);
  std::vector<Eigen::Isometry3d> from(carrier.size(), Eigen::Isometry3d::Identity());
  for (int b = 1; b < m.nbody; ++b) {
    const auto parent = static_cast<std::size_t>(m.body_parentid[b]),
               i = static_cast<std::size_t>(b);
    Eigen::Isometry3d X = from[parent] * frame(m.body_pos + 3 * b, m.body_quat + 4 * b);
    if (m.body_jntnum[b] == 0) {
      carrier[i] = carrier[parent];
      from[i] = X;
    } else {
      ReadBody body = readJoint(m, b);
      body.parent = carrier[parent];
      // an anchor beside the body's origin is where the joint's frame is
      const Vector3d anchor = vector(m.jnt_pos + 3 * m.body_jntadr[b]);
      body.placement = X * Eigen::Translation3d(anchor);
      from[i] = Eigen::Isometry3d(Eigen::Translation3d(-anchor));
      carrier[i] = static_cast<int>(robot.bodies.size());
      dofs->push_back(m.jnt_dofadr[m.body_jntadr[b]]);
      robot.bodies.push_back(body);
    }
    if (carrier[i] < 0) continue;
    const Matrix3d R = turn(m.body_iquat + 4 * b);
    const Matrix3d I = R * vector(m.body_inertia + 3 * b).asDiagonal() * R.transpose();
    ReadBody& body = robot.bodies[static_cast<std::size_t>(carrier[i])];
    body.moments +=
        MassMoments::of(m.body_mass[b], vector(m.body_ipos + 3 * b), I).movedBy(from[i]);
  }
  return robot;
}

Reading read(const std::string& text, const std::filesystem::path&) {
  installMujocoHandlers();
  Reading reading;
  const std::shared_ptr<mjModel> model = compiled(text, &reading.refusal);
  if (!model) return reading;
  std::vector<int> dofs;
  reading.robot = robotOf(*model, &dofs);
  const std::shared_ptr<mjData> data(mj_makeData(model.get()), MujocoDeleter());
  reading.answer = [model, data, dofs](const std::vector<double>& q) {
    mjModel* m = model.get();
    mjData* d = data.get();
    for (int j = 0, k = 0; j < m->njnt; ++j) {
      if (m->jnt_type[j] != mjJNT_HINGE && m->jnt_type[j] != mjJNT_SLIDE)
        throw std::logic_error("mujoco_reader: a joint of several degrees of freedom");
      d->qpos[m->jnt_qposadr[j]] = q[static_cast<std::size_t>(k++)];
    }
    mju_zero(d->qvel, m->nv);
    mj_kinematics(m, d);
    mj_comPos(m, d);
    mj_crb(m, d);
    mj_comVel(m, d);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> M(m->nv, m->nv);
    mj_fullM(m, M.data(), d->qM);
    Eigen::VectorXd g(m->nv);
    mj_rne(m, d, 0, g.data());
    const auto n = static_cast<Eigen::Index>(dofs.size());
    MassAndGravity out{Eigen::MatrixXd(n, n), Eigen::VectorXd(n), {}, {}};
    for (Eigen::Index i = 0; i < n; ++i) {
      out.g[i] = g[dofs[static_cast<std::size_t>(i)]];
      for (Eigen::Index j = 0; j < n; ++j)
        out.M(i, j) = M(dofs[static_cast<std::size_t>(i)], dofs[static_cast<std::size_t>(j)]);
    }
    return out;
  };
  return reading;
}

}  // namespace

Reader mujocoReader() {
  return {"mujoco", mj_versionString(), true, read};
}
#else
Reader mujocoReader() {
  return {"mujoco", "", false, {}};
}
#endif

}  // namespace dynwitness::crosscheck
