// SPDX-License-Identifier: Apache-2.0
// RBDL as a witness. Run with 3.3.1 (README.md).
//
//     c++ -std=c++17 -O2 -I data/engines $(pkg-config --cflags rbdl eigen3) \
//       -o rbdl_engine data/engines/rbdl_engine.cpp $(pkg-config --libs rbdl)
//     ./dynwitness crosscheck puma_560 --engine ./rbdl_engine
//
// Conventions that are RBDL's own, and undone here: a floating body's first three rates are its
// velocity in the axes of the joint frame, not in its own, so that its accelerations differ by
// w x v; the w of a quaternion stands at the end of all positions. Rotors, springs and friction are
// the user's, and added here; ForwardDynamics() cannot be given rotors, so that qdd is not
// answered where there are any.
#include <rbdl/rbdl.h>
#include <rbdl/rbdl_utils.h>

#include <memory>

#include "moving_bodies.hpp"

using namespace dynwitness_engine;
namespace rbdl = RigidBodyDynamics;
using rbdl::Math::Matrix3d, rbdl::Math::MatrixNd, rbdl::Math::Vector3d, rbdl::Math::VectorNd;

namespace {

rbdl::Joint jointOf(const MovingBody& body) {
  const Vector3& z = body.axis;
  if (body.kind == "revolute") return rbdl::Joint(rbdl::JointTypeRevolute, Vector3d(z));
  if (body.kind == "prismatic") return rbdl::Joint(rbdl::JointTypePrismatic, Vector3d(z));
  if (body.kind == "spherical") return rbdl::Joint(rbdl::JointTypeSpherical);
  if (body.kind == "floating") return rbdl::Joint(rbdl::JointTypeFloatingBase);
  throw std::runtime_error("joint '" + body.name + "' is " + body.kind);
}

struct Arm {
  MovingBodies scene;
  rbdl::Model model;
  std::vector<unsigned> ids;
  VectorNd rotors;

  explicit Arm(const Json& told) : scene(told) {
    rotors = VectorNd::Zero(scene.dof);
    for (const MovingBody& body : scene.bodies) {
      const unsigned parent = body.parent < 0 ? 0 : ids[static_cast<std::size_t>(body.parent)];
      const rbdl::Math::SpatialTransform X(Matrix3d(body.placement.R.transpose()),
                                           Vector3d(body.placement.p));
      const auto bodyOf = [](const Piece& p) {
        return rbdl::Body(p.mass, Vector3d(p.com), Matrix3d(p.inertia));
      };
      const rbdl::Body first = body.pieces.empty() ? rbdl::Body() : bodyOf(body.pieces.front());
      ids.push_back(model.AddBody(parent, X, jointOf(body), first));
      for (std::size_t k = 1; k < body.pieces.size(); ++k)
        model.AddBody(ids.back(), rbdl::Math::SpatialTransform(), rbdl::Joint(rbdl::JointTypeFixed),
                      bodyOf(body.pieces[k]));
      if (body.rates == 1) rotors[body.qd] = body.rotor;
    }
  }

  /// Both are asked with gravity and without.
  void weigh(bool has_weight) {
    model.gravity = has_weight ? Vector3d(scene.gravity) : Vector3d(0, 0, 0);
  }
};

/// A state in RBDL's coordinates: qd_rbdl = J qd, tau = J' tau_rbdl.
struct Posed {
  const Arm& arm;
  VectorNd q, qd;
  MatrixNd J;
  VectorNd bias;  // d/dt(J) qd

  Posed(const Arm& of, const State& s) : arm(of) {
    const int n = arm.scene.dof;
    q = VectorNd::Zero(arm.model.q_size);
    J = MatrixNd::Identity(n, n);
    bias = VectorNd::Zero(n);
    const VectorNd rate = Eigen::Map<const Eigen::VectorXd>(s.qd.data(), n);
    for (std::size_t k = 0; k < arm.ids.size(); ++k) {
      const MovingBody& body = arm.scene.bodies[k];
      const double* const x = s.q.data() + body.q;
      if (body.positions < 4) {
        q[body.qd] = x[0];
        continue;
      }
      const bool floats = body.kind == "floating";
      const double* const wxyz = x + (floats ? 3 : 0);
      const Eigen::Quaterniond turn =
          Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized();
      arm.model.SetQuaternion(arm.ids[k],
                              rbdl::Math::Quaternion(turn.x(), turn.y(), turn.z(), turn.w()), q);
      if (!floats) continue;
      for (int i = 0; i < 3; ++i) q[body.qd + i] = x[i];
      const Matrix3 R = turn.toRotationMatrix();
      const Vector3 v = rate.segment<3>(body.qd), w = rate.segment<3>(body.qd + 3);
      J.block<3, 3>(body.qd, body.qd) = R;
      bias.segment<3>(body.qd) = R * w.cross(v);
    }
    qd = J * rate;
  }
  VectorNd accelerations(const Vector& qdd) const {
    return J * Eigen::Map<const Eigen::VectorXd>(qdd.data(), J.rows()) + bias;
  }
};

Vector plain(const VectorNd& v) {
  return Vector(v.data(), v.data() + v.size());
}

/// Of links alone. @param qdd  ours
VectorNd inverseDynamics(Arm& arm, const State& s, const Vector& qdd, bool has_weight) {
  const Posed posed(arm, s);
  arm.weigh(has_weight);
  VectorNd tau = VectorNd::Zero(arm.scene.dof);
  rbdl::InverseDynamics(arm.model, posed.q, posed.qd, posed.accelerations(qdd), tau);
  return posed.J.transpose() * tau;
}

}  // namespace

int main() {
  int version = rbdl_get_api_version();
  Engine engine("rbdl", std::to_string(version >> 16 & 255) + "." +
                            std::to_string(version >> 8 & 255) + "." +
                            std::to_string(version & 255));
  std::unique_ptr<Arm> arm;
  engine.scene = [&](const Json& scene) {
    arm = std::make_unique<Arm>(scene);
    if (arm->scene.hasRotors()) return;
    engine.vector("qdd", [&](const State& s) {
      const Posed posed(*arm, s);
      arm->weigh(true);
      VectorNd tau = Eigen::Map<const Eigen::VectorXd>(s.tau.data(), arm->scene.dof);
      VectorNd passive = VectorNd::Zero(arm->scene.dof), qdd = passive;
      arm->scene.addSprings(s.q, &passive);
      arm->scene.addFriction(s.qd, &passive);
      tau = posed.J * (tau - passive);  // J is orthogonal
      rbdl::ForwardDynamics(arm->model, posed.q, posed.qd, tau, qdd);
      return plain(posed.J.transpose() * (qdd - posed.bias));
    });
  };
  engine.matrix("M", [&](const State& s) {
    const Posed posed(*arm, s);
    MatrixNd M = MatrixNd::Zero(arm->scene.dof, arm->scene.dof);
    rbdl::CompositeRigidBodyAlgorithm(arm->model, posed.q, M);
    M = (posed.J.transpose() * M * posed.J).eval();
    M.diagonal() += arm->rotors;
    Matrix out;
    for (Eigen::Index i = 0; i < M.rows(); ++i) out.push_back(plain(M.row(i)));
    return out;
  });
  const auto still = [&] { return Vector(static_cast<std::size_t>(arm->scene.dof), 0.0); };
  engine.vector("c",
                [&](const State& s) { return plain(inverseDynamics(*arm, s, still(), false)); });
  engine.vector("g", [&](const State& s) {
    Vector g = plain(inverseDynamics(*arm, {s.q, still(), {}, {}}, still(), true));
    arm->scene.addSprings(s.q, &g);
    return g;
  });
  engine.vector("tau", [&](const State& s) {
    VectorNd tau = inverseDynamics(*arm, s, s.qdd, true);
    tau +=
        arm->rotors.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(s.qdd.data(), arm->scene.dof));
    arm->scene.addSprings(s.q, &tau);
    arm->scene.addFriction(s.qd, &tau);
    return plain(tau);
  });
  engine.number("kinetic", [&](const State& s) {
    const Posed posed(*arm, s);
    return rbdl::Utils::CalcKineticEnergy(arm->model, posed.q, posed.qd) +
           arm->rotors.dot(posed.qd.cwiseAbs2()) / 2;
  });
  engine.number("potential", [&](const State& s) {
    const Posed posed(*arm, s);
    arm->weigh(true);
    return rbdl::Utils::CalcPotentialEnergy(arm->model, posed.q) + arm->scene.restingPotential() +
           arm->scene.springEnergy(s.q);
  });
  engine.vector("momentum", [&](const State& s) {
    const Posed posed(*arm, s);
    double mass = 0;
    Vector3d com, velocity, angular;
    rbdl::Utils::CalcCenterOfMass(arm->model, posed.q, posed.qd, nullptr, mass, com, &velocity,
                                  nullptr, &angular);
    const Vector3 p = mass * velocity, about_origin = angular + com.cross(p);
    return Vector{p[0], p[1], p[2], about_origin[0], about_origin[1], about_origin[2]};
  });
  return engine.testify();
}
