// SPDX-License-Identifier: GPL-3.0-or-later
// Real robots, for inequalities: in balls.
#include "crosscheck/audit/constraints.hpp"

namespace dynwitness::audit {

Robot<Ball> realRobot(RealPoint& at, int n) {
  Robot<Ball> robot;
  for (int i = 0; i < n; ++i) {
    robot.parent.push_back(i - 1);
    robot.kind.push_back(kTurn);
    robot.R.push_back(Point::rotationOf<Ball>(at.number(0.5, 1), at.vector()));
    robot.r.push_back(at.vector());
    PointMasses<Ball> body;
    for (int k = 0; k < 3; ++k) {
      body.m.push_back(at.number(0.1, 1));
      body.r.push_back(at.vector());
    }
    robot.body.push_back(body);
    robot.rotor.push_back(at.number(0.01, 0.1));
    const scene::CosSin<Ball> angle = cosSin(at.number(-3, 3));
    robot.x.push_back({Ball(0), angle.c, angle.s});
    robot.qd.push_back(at.number(-1, 1));
    robot.qdd.push_back(at.number(-1, 1));
    robot.tau.push_back(at.number(-1, 1));
  }
  robot.gravity = at.vector();
  return robot;
}

LinkConstraint<Ball> realConstraint(RealPoint& at, int link, int m) {
  LinkConstraint<Ball> held;
  held.link = link;
  held.A.resize(6, m);
  held.b.resize(m);
  for (int k = 0; k < m; ++k) {
    for (int i = 0; i < 6; ++i) held.A(i, k) = at.number(-1, 1);
    held.b(k) = at.number(-1, 1);
  }
  return held;
}

template struct Robot<Ball>;
template struct SixVectors<Ball>;

}  // namespace dynwitness::audit
