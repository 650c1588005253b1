// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/audit/board.hpp"

#include <cmath>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "recursive/build_model.hpp"

namespace dynwitness::audit {

std::string onBoard(double x) {
  return fmt::format("{:.4g}", std::abs(x) < 1e-12 ? 0.0 : x);
}

OnTheBoard::OnTheBoard(const std::string& name, double rate, double q)
    : scene(scene::findScene(name)),
      model(recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism))),
      ws(model),
      x(static_cast<std::size_t>(model.positions), scene::jointPosition(q)),
      qd(static_cast<std::size_t>(model.dof()), rate),
      qdd(qd.size(), 0.0),
      tau(qd.size(), 0.0) {
  move();
}

void OnTheBoard::move(recursive::Terms terms) {
  recursive::forwardDynamics(model, x, qd, tau, ws, qdd, terms);
}

Matrix6<double> OnTheBoard::M_A(std::size_t i) const {
  return ws.M_A[i].matrix();
}

Vector6<double> OnTheBoard::F(std::size_t i) const {
  return ws.f[i].vector();
}

Vector6<double> OnTheBoard::A(std::size_t i) const {
  return ws.c[i].vector();
}

Matrix6<double> OnTheBoard::T_V(std::size_t i) const {
  return ws.X_up[i].motionMatrix();
}

Matrix6<double> OnTheBoard::T_F(std::size_t i) const {
  return T_V(i).transpose();
}

Matrix6<double> OnTheBoard::P(std::size_t i) const {
  return Matrix6<double>::Identity() - M_A(i) * Z() * (1 / ws.D[i]) * Z().transpose();
}

Vector6<double> OnTheBoard::gravityAtBase() const {
  Vector6<double> a = Vector6<double>::Zero();
  a.head<3>() = -model.gravity;
  return a;
}

PointMasses<double> pointMassesOf(const RigidInertia<double>& body) {
  const Vector3<double> c =
      body.mass == 0 ? Vector3<double>::Zero() : Vector3<double>(body.h / body.mass);
  const Matrix3<double> I = body.I.matrix();
  const Matrix3<double> moments =
      Matrix3<double>::Identity() * (I.trace() / 2) - I - c * body.h.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3<double>> axes(moments);
  PointMasses<double> out{{body.mass - axes.eigenvalues().sum()}, {c}};
  for (int k = 0; k < 3; ++k)
    for (const int side : {-1, 1}) {
      out.m.push_back(axes.eigenvalues()(k) / 2);
      out.r.push_back(c + side * axes.eigenvectors().col(k));
    }
  return out;
}

Robot<double> pointMassesOf(const OnTheBoard& arm) {
  Robot<double> robot;
  for (std::size_t i = 0; i < arm.n(); ++i) {
    const auto& link = arm.model.links[i];
    robot.parent.push_back(link.parent);
    robot.kind.push_back(link.kind);
    robot.R.push_back(link.X_tree.R.transpose());
    robot.r.push_back(link.X_tree.p);
    robot.body.push_back(pointMassesOf(link.M));
    robot.rotor.push_back(link.rotor);
  }
  robot.x = arm.x;
  robot.qd = arm.qd;
  robot.qdd = arm.qdd;
  robot.tau = arm.tau;
  robot.gravity = arm.model.gravity;
  return robot;
}

HeldElbow::HeldElbow(double rate, int direction) : arm("double_pendulum", rate), cws(arm.model, 1) {
  held.link = 1;
  held.A = Vector6<double>::Unit(direction);
  held.b = Eigen::VectorXd::Zero(1);
  recursive::constrainedForwardDynamics(arm.model, arm.x, arm.qd, arm.tau, {held}, arm.ws, cws,
                                        arm.qdd);
}

Vector6<double> HeldElbow::E(std::size_t i) const {
  return cws.E[i].col(0);
}

template struct PointMasses<double>;
template struct Robot<double>;

}  // namespace dynwitness::audit
