// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled with -UNDEBUG: Debian's Simbody was, and its headers change the layout of its classes
// with it.
#include "crosscheck/chart/raw_simbody.hpp"

#include <Simbody.h>

#include <stdexcept>

namespace dynwitness::crosscheck {

struct RawSimbody::Parts {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::GeneralForceSubsystem forces{system};
  SimTK::Force::Gravity gravity;
  SimTK::State state;
  std::vector<int> q_of_slot, u_of_dof;
  SimTK::Vector in, out;
  SimTK::Matrix M;
  SimTK::Vector_<SimTK::SpatialVec> body_accelerations;
  const double* results = nullptr;

  explicit Parts(const recursive::Model<double>& model)
      : gravity(forces, matter,
                SimTK::Vec3(model.gravity.x(), model.gravity.y(), model.gravity.z())) {}

  void setPositions(const double* q) {
    SimTK::Vector& into = state.updQ();
    for (std::size_t i = 0; i < q_of_slot.size(); ++i) into[q_of_slot[i]] = q[i];
  }
  void setSpeeds(const double* qd) {
    SimTK::Vector& into = state.updU();
    for (std::size_t i = 0; i < u_of_dof.size(); ++i) into[u_of_dof[i]] = qd[i];
  }
  void setIn(const double* x) {
    for (std::size_t i = 0; i < u_of_dof.size(); ++i) in[u_of_dof[i]] = x[i];
  }
};

RawSimbody::RawSimbody(const recursive::Model<double>& model) : parts_(new Parts(model)) {
  using SimTK::MobilizedBody;
  // Simbody slides along x, the model along z
  const SimTK::Transform along_z(SimTK::Rotation(SimTK::UnitVec3(SimTK::ZAxis), SimTK::XAxis));
  std::vector<SimTK::MobilizedBody> bodies;
  for (const recursive::LinkModel<double>& link : model.links) {
    SimTK::Mat33 R;  // parent axes from the unmoved joint frame's
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) R(i, j) = link.X_tree.R(j, i);
    const SimTK::Transform placed(
        SimTK::Rotation(R, true),
        SimTK::Vec3(link.X_tree.p.x(), link.X_tree.p.y(), link.X_tree.p.z()));
    const recursive::RigidInertia<double>& m = link.M;
    const SimTK::Body::Rigid body(
        SimTK::MassProperties(m.mass, SimTK::Vec3(m.h.x(), m.h.y(), m.h.z()) / m.mass,
                              SimTK::Inertia(m.I.xx, m.I.yy, m.I.zz, m.I.xy, m.I.xz, m.I.yz)));
    SimTK::MobilizedBody& parent =
        link.parent < 0 ? parts_->matter.updGround() : bodies[link.parent];
    if (link.kind == recursive::JointKind::kRevolute)
      bodies.push_back(MobilizedBody::Pin(parent, placed, body, SimTK::Transform()));
    else if (link.kind == recursive::JointKind::kPrismatic)
      bodies.push_back(MobilizedBody::Slider(parent, placed * along_z, body, along_z));
    else if (link.kind == recursive::JointKind::kFloating)
      bodies.push_back(MobilizedBody::Free(parent, placed, body, SimTK::Transform()));
    else
      throw std::invalid_argument("RawSimbody: expected revolute, prismatic and floating joints");
  }
  parts_->state = parts_->system.realizeTopology();
  parts_->system.realizeModel(parts_->state);
  parts_->q_of_slot.resize(model.positions);
  parts_->u_of_dof.resize(model.dof());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const recursive::LinkModel<double>& link = model.links[i];
    const int q = bodies[i].getFirstQIndex(parts_->state),
              u = bodies[i].getFirstUIndex(parts_->state);
    if (link.kind == recursive::JointKind::kFloating) {  // Simbody has what turns first
      for (int k = 0; k < 7; ++k) parts_->q_of_slot[link.slot + k] = q + (k + 4) % 7;
      for (int k = 0; k < 6; ++k) parts_->u_of_dof[link.dof + k] = u + (k + 3) % 6;
    } else {
      parts_->q_of_slot[link.slot] = q;
      parts_->u_of_dof[link.dof] = u;
    }
  }
  parts_->in.resize(model.dof());
}
RawSimbody::~RawSimbody() = default;

void RawSimbody::inverseDynamics(const double* q, const double* qd, const double* qdd) {
  Parts& p = *parts_;
  p.setPositions(q);
  p.setSpeeds(qd);
  p.setIn(qdd);
  p.system.realize(p.state, SimTK::Stage::Velocity);
  p.matter.calcResidualForceIgnoringConstraints(p.state, SimTK::Vector(),
                                                p.gravity.getBodyForces(p.state), p.in, p.out);
  p.results = &p.out[0];
}

void RawSimbody::massMatrix(const double* q) {
  Parts& p = *parts_;
  p.setPositions(q);
  p.system.realize(p.state, SimTK::Stage::Position);
  p.matter.calcM(p.state, p.M);
  p.results = &p.M(0, 0);
}

void RawSimbody::forwardDynamics(const double* q, const double* qd, const double* tau) {
  Parts& p = *parts_;
  p.setPositions(q);
  p.setSpeeds(qd);
  p.setIn(tau);
  p.system.realize(p.state, SimTK::Stage::Dynamics);
  p.matter.calcAccelerationIgnoringConstraints(p.state, p.in, p.gravity.getBodyForces(p.state),
                                               p.out, p.body_accelerations);
  p.results = &p.out[0];
}

const double* RawSimbody::results() const {
  return parts_->results;
}

std::vector<double> RawSimbody::inModelOrder() const {
  std::vector<double> values;
  for (const int u : parts_->u_of_dof) values.push_back(parts_->out[u]);
  return values;
}

}  // namespace dynwitness::crosscheck
