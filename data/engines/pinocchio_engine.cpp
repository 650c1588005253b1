// SPDX-License-Identifier: Apache-2.0
// Pinocchio as a witness. Run with 3.7.0 (README.md).
//
//     c++ -std=c++17 -O2 -I data/engines $(pkg-config --cflags pinocchio eigen3) \
//       -o pinocchio_engine data/engines/pinocchio_engine.cpp $(pkg-config --libs pinocchio)
//     ./dynwitness crosscheck puma_560 --engine ./pinocchio_engine
//
// Conventions, as far as they are Pinocchio's own: quaternions are (x, y, z, w), told in the
// handshake, and of length 1, made so here; a free flyer's rates are its velocity and angular
// velocity in its own axes, which are ours; rotors are model.armature. Springs and friction are the
// user's, and added here.
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/centroidal.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/energy.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody/data.hpp>
#include <pinocchio/multibody/model.hpp>

#include <memory>

#include "moving_bodies.hpp"

using namespace dynwitness_engine;
namespace pin = pinocchio;

namespace {

pin::JointModel jointOf(const MovingBody& body) {
  if (body.kind == "revolute") return pin::JointModelRevoluteUnaligned(body.axis);
  if (body.kind == "prismatic") return pin::JointModelPrismaticUnaligned(body.axis);
  if (body.kind == "helical") return pin::JointModelHelicalUnaligned(body.axis, body.pitch);
  if (body.kind == "spherical") return pin::JointModelSpherical();
  if (body.kind == "floating") return pin::JointModelFreeFlyer();
  throw std::runtime_error("joint '" + body.name + "' is " + body.kind);
}

struct Arm {
  MovingBodies scene;
  pin::Model model, weightless;  // the same without gravity: its nonlinear effects are c
  std::unique_ptr<pin::Data> data, weightless_data;

  explicit Arm(const Json& told) : scene(told) {
    std::vector<pin::JointIndex> joints;
    for (const MovingBody& body : scene.bodies) {
      const pin::JointIndex parent =
          body.parent < 0 ? 0 : joints[static_cast<std::size_t>(body.parent)];
      const pin::SE3 placement(body.placement.R, body.placement.p);
      const pin::JointIndex joint = model.addJoint(parent, jointOf(body), placement, body.name);
      for (const Piece& piece : body.pieces)
        model.appendBodyToJoint(joint, pin::Inertia(piece.mass, piece.com, piece.inertia),
                                pin::SE3::Identity());
      if (body.rates == 1) model.armature[body.qd] = body.rotor;
      joints.push_back(joint);
    }
    model.gravity.linear() = scene.gravity;
    weightless = model;
    weightless.gravity.setZero();
    data = std::make_unique<pin::Data>(model);
    weightless_data = std::make_unique<pin::Data>(weightless);
  }

  Eigen::VectorXd q(const State& s) const {
    Eigen::VectorXd out = Eigen::Map<const Eigen::VectorXd>(s.q.data(), model.nq);
    for (const MovingBody& body : scene.bodies)
      if (body.positions > 3) out.segment<4>(body.q + body.positions - 4).normalize();
    return out;
  }
  Eigen::VectorXd rates(const Vector& v) const {
    return Eigen::Map<const Eigen::VectorXd>(v.data(), model.nv);
  }
};

Vector plain(const Eigen::VectorXd& v) {
  return Vector(v.data(), v.data() + v.size());
}

}  // namespace

int main() {
  Engine engine("pinocchio", PINOCCHIO_VERSION);
  engine.quaternion = "xyzw";
  std::unique_ptr<Arm> arm;
  engine.scene = [&](const Json& scene) { arm = std::make_unique<Arm>(scene); };
  engine.matrix("M", [&](const State& s) {
    pin::crba(arm->model, *arm->data, arm->q(s));
    const Eigen::MatrixXd M = arm->data->M.selfadjointView<Eigen::Upper>();
    Matrix out;
    for (Eigen::Index i = 0; i < M.rows(); ++i) out.push_back(plain(M.row(i)));
    return out;
  });
  engine.vector("c", [&](const State& s) {
    return plain(
        pin::nonLinearEffects(arm->weightless, *arm->weightless_data, arm->q(s), arm->rates(s.qd)));
  });
  engine.vector("g", [&](const State& s) {
    Vector g = plain(pin::computeGeneralizedGravity(arm->model, *arm->data, arm->q(s)));
    arm->scene.addSprings(s.q, &g);
    return g;
  });
  engine.vector("tau", [&](const State& s) {
    Vector tau =
        plain(pin::rnea(arm->model, *arm->data, arm->q(s), arm->rates(s.qd), arm->rates(s.qdd)));
    arm->scene.addSprings(s.q, &tau);
    arm->scene.addFriction(s.qd, &tau);
    return tau;
  });
  engine.vector("qdd", [&](const State& s) {
    Eigen::VectorXd passive = Eigen::VectorXd::Zero(arm->model.nv);
    arm->scene.addSprings(s.q, &passive);
    arm->scene.addFriction(s.qd, &passive);
    return plain(
        pin::aba(arm->model, *arm->data, arm->q(s), arm->rates(s.qd), arm->rates(s.tau) - passive));
  });
  engine.number("kinetic", [&](const State& s) {
    return pin::computeKineticEnergy(arm->model, *arm->data, arm->q(s), arm->rates(s.qd));
  });
  engine.number("potential", [&](const State& s) {
    return pin::computePotentialEnergy(arm->model, *arm->data, arm->q(s)) +
           arm->scene.restingPotential() + arm->scene.springEnergy(s.q);
  });
  engine.vector("momentum", [&](const State& s) {
    const pin::Force h =
        pin::computeCentroidalMomentum(arm->model, *arm->data, arm->q(s), arm->rates(s.qd));
    const Vector3 about_origin = h.angular() + arm->data->com[0].cross(h.linear());
    return Vector{h.linear()[0],   h.linear()[1],   h.linear()[2],
                  about_origin[0], about_origin[1], about_origin[2]};
  });
  return engine.testify();
}
