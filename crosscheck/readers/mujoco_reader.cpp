// SPDX-License-Identifier: GPL-3.0-or-later
// MuJoCo as a reader of robot descriptions, URDF and MJCF: the user's bytes, and no compiler option
// set. (As a witness of the crosscheck it is told to fuse, balance and infer nothing:
// witnesses/mujoco.cpp.)
#include "crosscheck/readers/reader.hpp"

#ifdef DYNWITNESS_HAS_MUJOCO
#include <mujoco/mujoco.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "crosscheck/witnesses/mujoco_model.hpp"
#include "scene/mjcf.hpp"
#include "scene/text_file.hpp"
#endif

namespace dynwitness::crosscheck {

#ifdef DYNWITNESS_HAS_MUJOCO
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Whether a text is that of a file: MJCF names others, which lie beside it.
bool isTextOf(const std::string& text, const std::filesystem::path& file) {
  try {
    return scene::readTextFile(file, "an MJCF file") == text;
  } catch (const std::exception&) {  // there is none of this name
    return false;
  }
}

std::shared_ptr<mjModel> compiled(const std::string& text, const std::filesystem::path& file,
                                  bool is_mjcf, std::string* refusal) {
  try {
    if (!is_mjcf || !isTextOf(text, file))
      return mujocoModelOf(text, is_mjcf ? "robot.xml" : "robot.urdf", refusal);
    char said[1000] = "";
    std::shared_ptr<mjModel> model(mj_loadXML(file.c_str(), nullptr, said, sizeof said),
                                   MujocoDeleter());
    if (!model) *refusal = said;
    return model;
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

scene::JointKind kindOf(const mjModel& m, int joint) {
  switch (m.jnt_type[joint]) {
    case mjJNT_FREE:
      return scene::JointKind::kFloating;
    case mjJNT_BALL:
      return scene::JointKind::kSpherical;
    case mjJNT_SLIDE:
      return scene::JointKind::kPrismatic;
    default:
      return scene::JointKind::kRevolute;
  }
}
/// Of a URDF, whose one joint is several for MuJoCo.
scene::JointKind kindOfAll(const mjModel& m, int body) {
  const int first = m.body_jntadr[body], count = m.body_jntnum[body];
  if (count == 4 && m.jnt_type[first + 3] == mjJNT_BALL) return scene::JointKind::kFloating;
  return count == 3 ? scene::JointKind::kPlanar : kindOf(m, first);
}

/// A joint but for its place and link.
ReadBody readJoint(const mjModel& m, int joint, scene::JointKind kind) {
  const int dof = m.jnt_dofadr[joint], slot = m.jnt_qposadr[joint];
  ReadBody out;
  out.joint = nameOf(m, mjOBJ_JOINT, joint);
  out.kind = kind;
  if (!hasOnePosition(out)) {
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
  out.rest = m.qpos_spring[slot] - m.qpos0[slot];
  for (int e = 0; e < m.neq; ++e) {
    if (m.eq_type[e] != mjEQ_JOINT || m.eq_obj1id[e] != joint || m.eq_obj2id[e] < 0 ||
        !m.eq_active[e])
      continue;
    out.leader = nameOf(m, mjOBJ_JOINT, m.eq_obj2id[e]);
    out.offset = m.eq_data[mjNEQDATA * e];
    out.multiplier = m.eq_data[mjNEQDATA * e + 1];
  }
  return out;
}

/** Its bodies, those lumped that are fixed to others.
    @param apart  several joints of a body are a row of bodies, of which the last has the mass and
                  the name, as our reader of MJCF has them; otherwise they are one joint of a URDF
    @param dofs   by body: that of its joint */
Robot robotOf(const mjModel& m, bool apart, std::vector<int>* dofs) {
  Robot robot;
  if (!(m.opt.disableflags & mjDSBL_GRAVITY)) robot.gravity = vector(m.opt.gravity);
  robot.unturned = std::sqrt(2 * kMujocoTurnStop);
  // what a body without joints is fixed to, and where it is seen from there
  std::vector<int> carrier(static_cast<std::size_t>(m.nbody), -1);
  std::vector<Eigen::Isometry3d> from(carrier.size(), Eigen::Isometry3d::Identity());
  for (int b = 1; b < m.nbody; ++b) {
    const auto parent = static_cast<std::size_t>(m.body_parentid[b]),
               i = static_cast<std::size_t>(b);
    Eigen::Isometry3d X = from[parent] * frame(m.body_pos + 3 * b, m.body_quat + 4 * b);
    const int first = m.body_jntadr[b], count = m.body_jntnum[b], rows = apart ? count : count > 0;
    carrier[i] = carrier[parent];
    Vector3d anchor = Vector3d::Zero();  // in the body's frame; a slide may have any
    for (int k = 0; k < rows; ++k) {
      const int joint = first + k;
      ReadBody body = readJoint(m, joint, apart ? kindOf(m, joint) : kindOfAll(m, b));
      if (k + 1 == rows) body.link = nameOf(m, mjOBJ_BODY, b);
      body.parent = carrier[i];
      const Vector3d before = anchor;
      if (m.jnt_type[joint] == mjJNT_HINGE || m.jnt_type[joint] == mjJNT_BALL)
        anchor = vector(m.jnt_pos + 3 * joint);
      body.placement = X * Eigen::Translation3d(anchor - before);
      X.setIdentity();
      carrier[i] = static_cast<int>(robot.bodies.size());
      dofs->push_back(m.jnt_dofadr[joint]);
      robot.bodies.push_back(body);
    }
    from[i] = rows > 0 ? Eigen::Isometry3d(Eigen::Translation3d(-anchor)) : X;
    if (carrier[i] < 0) continue;
    const Matrix3d R = turn(m.body_iquat + 4 * b);
    const Matrix3d I = R * vector(m.body_inertia + 3 * b).asDiagonal() * R.transpose();
    ReadBody& body = robot.bodies[static_cast<std::size_t>(carrier[i])];
    body.moments +=
        MassMoments::of(m.body_mass[b], vector(m.body_ipos + 3 * b), I).movedBy(from[i]);
  }
  return robot;
}

Reading read(const std::string& text, const std::filesystem::path& file) {
  installMujocoHandlers();
  Reading reading;
  const bool is_mjcf = scene::isMjcf(text);
  const std::shared_ptr<mjModel> model = compiled(text, file, is_mjcf, &reading.refusal);
  if (!model) return reading;
  std::vector<int> dofs;
  reading.robot = robotOf(*model, is_mjcf, &dofs);
  const std::shared_ptr<mjData> data(mj_makeData(model.get()), MujocoDeleter());
  reading.answer = [model, data, dofs](const std::vector<double>& q) {
    mjModel* m = model.get();
    mjData* d = data.get();
    for (int j = 0, k = 0; j < m->njnt; ++j) {
      if (m->jnt_type[j] != mjJNT_HINGE && m->jnt_type[j] != mjJNT_SLIDE)
        throw std::logic_error("mujoco_reader: a joint of several degrees of freedom");
      const int slot = m->jnt_qposadr[j];
      d->qpos[slot] = m->qpos0[slot] + q[static_cast<std::size_t>(k++)];
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
  Reader reader{"mujoco", mj_versionString(), true, read};
  reader.reads_mjcf = true;
  return reader;
}
#else
Reader mujocoReader() {
  return {"mujoco", "", false, {}};
}
#endif

}  // namespace dynwitness::crosscheck
