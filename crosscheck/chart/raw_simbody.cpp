// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled with -UNDEBUG: Debian's Simbody was, and its headers change the layout of its classes
// with it.
#include "crosscheck/chart/raw_simbody.hpp"

#include <Simbody.h>

#include <stdexcept>

#include "recursive/constraints.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Where a frame is whose coordinates X gives: parent axes from its own.
SimTK::Transform placed(const recursive::Transform<double>& X) {
  SimTK::Mat33 R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R(i, j) = X.R(j, i);
  return {SimTK::Rotation(R, true), SimTK::Vec3(X.p.x(), X.p.y(), X.p.z())};
}

}  // namespace

struct RawSimbody::Parts {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::GeneralForceSubsystem forces{system};
  SimTK::Force::Gravity gravity;
  std::vector<SimTK::MobilizedBody> bodies;  ///< of the model's links
  SimTK::State state;
  std::vector<int> q_of_slot, u_of_dof;
  SimTK::Vector in, out;
  SimTK::Matrix M;
  SimTK::Vector_<SimTK::SpatialVec> body_accelerations;
  const double* results = nullptr;

  explicit Parts(const recursive::Model<double>& model)
      : gravity(forces, matter,
                SimTK::Vec3(model.gravity.x(), model.gravity.y(), model.gravity.z())) {
    addBodies(model);
  }

  void addBodies(const recursive::Model<double>& model);
  void close(const recursive::Closure<double>& closure);
  /// All that is in the system was added.
  void finish(const recursive::Model<double>& model);

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

void RawSimbody::Parts::addBodies(const recursive::Model<double>& model) {
  using SimTK::MobilizedBody;
  // Simbody slides along x, the model along z
  const SimTK::Transform along_z(SimTK::Rotation(SimTK::UnitVec3(SimTK::ZAxis), SimTK::XAxis));
  for (const recursive::LinkModel<double>& link : model.links) {
    const SimTK::Transform at = placed(link.X_tree);
    const recursive::RigidInertia<double>& m = link.M;
    const SimTK::Body::Rigid body(
        SimTK::MassProperties(m.mass, SimTK::Vec3(m.h.x(), m.h.y(), m.h.z()) / m.mass,
                              SimTK::Inertia(m.I.xx, m.I.yy, m.I.zz, m.I.xy, m.I.xz, m.I.yz)));
    SimTK::MobilizedBody& parent = link.parent < 0 ? matter.updGround() : bodies[link.parent];
    if (link.kind == recursive::JointKind::kRevolute)
      bodies.push_back(MobilizedBody::Pin(parent, at, body, SimTK::Transform()));
    else if (link.kind == recursive::JointKind::kPrismatic)
      bodies.push_back(MobilizedBody::Slider(parent, at * along_z, body, along_z));
    else if (link.kind == recursive::JointKind::kFloating)
      bodies.push_back(MobilizedBody::Free(parent, at, body, SimTK::Transform()));
    else
      throw std::invalid_argument("RawSimbody: expected revolute, prismatic and floating joints");
  }
}

void RawSimbody::Parts::close(const recursive::Closure<double>& closure) {
  using SimTK::Constraint;
  const auto end = [&](int link) -> SimTK::MobilizedBody& {
    return link < 0 ? matter.updGround() : bodies[static_cast<std::size_t>(link)];
  };
  SimTK::MobilizedBody &a = end(closure.a), &b = end(closure.b);
  const SimTK::Transform X_A = placed(closure.X_A), X_B = placed(closure.X_B);
  if (closure.kind == scene::ClosureKind::kPlanarPoint)
    Constraint::PointOnLine(a, X_A.z(), X_A.p(), b, X_B.p());
  else if (closure.kind == scene::ClosureKind::kPoint)
    Constraint::Ball(a, X_A.p(), b, X_B.p());
  else if (closure.kind == scene::ClosureKind::kWeld)
    Constraint::Weld(a, X_A, b, X_B);
  else
    throw std::invalid_argument("RawSimbody: expected closures at a point, in a plane, or welds");
}

void RawSimbody::Parts::finish(const recursive::Model<double>& model) {
  state = system.realizeTopology();
  system.realizeModel(state);
  q_of_slot.resize(model.positions);
  u_of_dof.resize(model.dof());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const recursive::LinkModel<double>& link = model.links[i];
    const int q = bodies[i].getFirstQIndex(state), u = bodies[i].getFirstUIndex(state);
    if (link.kind == recursive::JointKind::kFloating) {  // Simbody has what turns first
      for (int k = 0; k < 7; ++k) q_of_slot[link.slot + k] = q + (k + 4) % 7;
      for (int k = 0; k < 6; ++k) u_of_dof[link.dof + k] = u + (k + 3) % 6;
    } else {
      q_of_slot[link.slot] = q;
      u_of_dof[link.dof] = u;
    }
  }
  in.resize(model.dof());
}

RawSimbody::RawSimbody(const recursive::Model<double>& model) : parts_(new Parts(model)) {
  parts_->finish(model);
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

namespace {

/// One step after the other, since what ends a step is what the next starts from.
class SimbodySteps : public RawSteps {
 public:
  SimbodySteps(const recursive::Model<double>& model,
               const recursive::Constraints<double>& closures, const RawStep& step)
      : parts_(model), motors_(parts_.forces, parts_.matter) {
    for (const recursive::Closure<double>& closure : closures.closures) parts_.close(closure);
    parts_.finish(model);
    integrator_ = std::make_unique<SimTK::SemiExplicitEulerIntegrator>(parts_.system, step.h);
    integrator_->setReturnEveryInternalStep(true);
  }

  void start(const scene::State<double>& s) override {
    std::vector<double> q;
    for (const scene::JointPosition<double>& x : s.x) q.push_back(x.q);
    parts_.setPositions(q.data());
    parts_.setSpeeds(s.qd.data());
    parts_.setIn(s.tau.data());
    motors_.setAllMobilityForces(parts_.state, parts_.in);
    integrator_->initialize(parts_.state);
    step();  // ends where it starts: to be read
  }
  void step() override { integrator_->stepTo(SimTK::Infinity); }
  std::vector<double> positions() const override {
    std::vector<double> values;
    for (const int q : parts_.q_of_slot) values.push_back(integrator_->getState().getQ()[q]);
    return values;
  }
  std::vector<double> rates() const override {
    std::vector<double> values;
    for (const int u : parts_.u_of_dof) values.push_back(integrator_->getState().getU()[u]);
    return values;
  }

 private:
  RawSimbody::Parts parts_;
  SimTK::Force::DiscreteForces motors_;
  std::unique_ptr<SimTK::SemiExplicitEulerIntegrator> integrator_;
};

}  // namespace

std::unique_ptr<RawSteps> rawSimbodySteps(const recursive::Model<double>& model,
                                          const recursive::Constraints<double>& closures,
                                          const RawStep& step) {
  if (step.is_runge_kutta)
    throw std::invalid_argument("it has no Runge-Kutta method of four evaluations");
  return std::make_unique<SimbodySteps>(model, closures, step);
}

}  // namespace dynwitness::crosscheck
