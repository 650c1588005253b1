// SPDX-License-Identifier: GPL-3.0-or-later
// What formulas are held against, over the prime field, and how it is drawn.
#include "crosscheck/audit/robot.hpp"

namespace dynwitness::audit {

Path<T> anyPath(Point& at, Start start) {
  const auto draw = [&](bool moving) {
    const T x = at.number();
    const T xd = moving ? at.number() : T(0);
    return jet<T>(x, xd, at.number());
  };
  const auto drawVector = [&](bool moving) {
    const Jet<T> x = draw(moving), y = draw(moving), z = draw(moving);
    return Vector3<Jet<T>>(x, y, z);
  };
  const Jet<T> w = draw(start == Start::kMoving);
  const Vector3<Jet<T>> u = drawVector(start == Start::kMoving);
  return {Point::rotationOf<Jet<T>>(w, u), drawVector(start != Start::kStandstill)};
}

PointMasses<T> anyBody(Point& at) {
  PointMasses<T> body;
  for (int k = 0; k < 4; ++k) {
    body.m.push_back(at.number());
    body.r.push_back(at.vector());
  }
  return body;
}

Robot<T> anyRobot(Point& at, const std::vector<JointKind>& kinds, Rotors rotors,
                  const std::vector<int>& parents) {
  Robot<T> robot;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    robot.parent.push_back(parents.empty() ? static_cast<int>(i) - 1 : parents[i]);
    robot.kind.push_back(kinds[i]);
    robot.R.push_back(at.rotation());
    robot.r.push_back(at.vector());
    PointMasses<T> body;  // three points off the origin have a regular inertia about it
    for (int k = 0; k < 3; ++k) {
      body.m.push_back(at.number());
      body.r.push_back(at.vector());
    }
    robot.body.push_back(body);
    robot.rotor.push_back(rotors == Rotors::kAll ? at.number() : T(0));
    const scene::CosSin<T> angle = at.angle();
    robot.x.push_back({at.number(), angle.c, angle.s});
    robot.qd.push_back(at.number());
    robot.qdd.push_back(at.number());
    robot.tau.push_back(at.number());
  }
  robot.gravity = at.vector();
  return robot;
}

template Matrix3<T> Point::rotationOf(const T&, const Vector3<T>&);
template Matrix3<Jet<T>> Point::rotationOf(const Jet<T>&, const Vector3<Jet<T>>&);
template struct Path<T>;
template struct PointMasses<T>;
template Path<T> turned(const Path<T>&, const Matrix3<T>&, const Vector3<T>&,
                        const scene::CosSin<T>&, const JointMotion<T>&);
template Path<T> slid(const Path<T>&, const Matrix3<T>&, const Vector3<T>&, const JointMotion<T>&);
template Matrix6<T> massMatrix6(const PointMasses<T>&);
template VectorX<T> solveDense(MatrixX<T>, VectorX<T>);
template Matrix6<T> projectionOf(const Matrix6<T>&, const Vector6<T>&, const T&);
template Matrix6<T> projectedInertia(const Matrix6<T>&, const Vector6<T>&, const T&);
template JointSolution<T> solveJoint(const JointProblem<T>&);
template MatrixX<T> inverseDense(const MatrixX<T>&);
template T determinant(MatrixX<T>);
template struct Robot<T>;
template struct SixVectors<T>;

}  // namespace dynwitness::audit
