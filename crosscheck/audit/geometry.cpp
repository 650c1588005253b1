// SPDX-License-Identifier: GPL-3.0-or-later
// Section 17: the geometry of the mass matrix.
#include <tuple>

#include "crosscheck/audit/lifted.hpp"

namespace dynwitness::audit {
namespace {

// ---- the metric M -------------------------------------------------------------------------------

/// R_1212 of the metric M of two joints, from M and its derivatives alone.
template <typename T>
T riemann(const Robot<T>& robot) {
  auto metric = metricOf(robot);
  const VectorX<T> e_1 = metric.unit(0), e_2 = metric.unit(1);
  return metric.riemann(e_1, e_2, e_1, e_2);
}

/// A planar arm of two turning joints about parallel axes, q_2 any angle.
Robot<T> planarArm(Point& at) {
  Robot<T> robot = anyRobot(at, {kTurn, kTurn}, Rotors::kNone);
  for (int i = 0; i < 2; ++i) robot.R[i] = Matrix3<T>::Identity();
  return robot;
}

Trials christoffel() {
  return Trials("christoffel").printed(exact([](Point& at) {
    const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
    const auto metric = metricOf(robot);
    for (const auto& [i, j, k] : {std::tuple(0, 1, 2), std::tuple(1, 0, 2), std::tuple(2, 0, 1),
                                  std::tuple(0, 2, 2), std::tuple(2, 0, 0)})
      at.equal("symbol", metric.christoffel(i, j, k),
               weighted(robot, firstPartials(robot, i), secondPartials(robot, j, k)));
  }));
}

Trials metricCompatible() {
  return Trials("metric_compatible").printed(exact([](Point& at) {
    const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
    const auto metric = metricOf(robot);
    const auto C = [&](int i, int j, int k) {
      return weighted(robot, firstPartials(robot, i), secondPartials(robot, j, k));
    };
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 2; ++i)
        at.equal("dM", metric.gradient()[k](i, 2), T(C(i, 2, k) + C(2, i, k)));
  }));
}

Trials geodesic() {
  return Trials("geodesic").printed(exact([](Point& at) {
    auto robot = anyRobot(at, {kTurn, kSlide});
    robot.gravity = Vector3<T>::Zero();
    robot.tau = robot.zeros();
    const VectorX<T> qdd = Robot<T>::column(robot.accelerations());
    const auto metric = metricOf(robot);
    const MatrixX<T> M = compositeMassMatrix<T>(robot.model(), robot.x);
    const VectorX<T> qd = Robot<T>::column(robot.qd);
    VectorX<T> bend = VectorX<T>::Constant(2, T(0));
    T rate = T(2) * qd.dot(VectorX<T>(M * qdd));
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k) {
        for (int i = 0; i < 2; ++i) bend(i) += metric.christoffel(i, j, k) * qd(j) * qd(k);
        for (int i = 0; i < 2; ++i) rate += metric.gradient()[k](i, j) * qd(i) * qd(j) * qd(k);
      }
    at.zero("qdd + Gamma qd qd", VectorX<T>(qdd + solveDense<T>(M, bend)));
    at.zero("rate of 2 T", rate);
  }));
}

Trials curvature() {
  return Trials("curvature").printed(exact([](Point& at) {
    const auto robot = anyRobot(at, {kTurn, kTurn});
    const MatrixX<T> M_inverse = inverseDense<T>(robot.massMatrix());
    const auto x_11 = secondPartials(robot, 0, 0), x_12 = secondPartials(robot, 0, 1),
               x_22 = secondPartials(robot, 1, 1);
    const auto normal = [&](const auto& a, const auto& b) {
      VectorX<T> along_a(2), along_b(2);
      for (int i = 0; i < 2; ++i) {
        along_a(i) = weighted(robot, firstPartials(robot, i), a);
        along_b(i) = weighted(robot, firstPartials(robot, i), b);
      }
      return T(weighted(robot, a, b) - along_a.dot(VectorX<T>(M_inverse * along_b)));
    };
    at.equal("R_1212", riemann(robot), T(normal(x_11, x_22) - normal(x_12, x_12)));
    at.zero("R_1212 of two slides", riemann(anyRobot(at, {kSlide, kSlide})));
  }));
}

Trials planarCurvature() {
  return Trials("planar_curvature").printed(exact([](Point& at) {
    Robot<T> robot = planarArm(at);
    robot.r[1] = Vector3<T>(at.number(), T(0), T(0));
    // the second link's centre of mass on its x axis: q2 = 0 is stretched
    T moment = T(0);
    for (int k = 0; k < 2; ++k) moment += robot.body[1].m[k] * robot.body[1].r[k].y();
    robot.body[1].r[2].y() = -moment / robot.body[1].m[2];
    const T c = robot.x[1].c, length = robot.r[1].x();
    const T b = length * robot.body[1].firstMoment().x();
    const T e = robot.body[1].inertiaAbout(Vector3<T>::Zero())(2, 2);
    const T a = robot.body[0].inertiaAbout(Vector3<T>::Zero())(2, 2) + e +
                robot.body[1].mass() * length * length;
    const MatrixX<T> M = robot.massMatrix();
    at.equal("M_11", M(0, 0), T(a + T(2) * b * c));
    const T det = M(0, 0) * M(1, 1) - M(0, 1) * M(1, 0);
    at.equal("curvature", T(riemann(robot) / det),
             T(b * c * (a * e - e * e - b * b) / (det * det)));
  }));
}

}  // namespace

std::vector<Trials> geometry() {
  return {christoffel(), metricCompatible(), geodesic(), curvature(), planarCurvature()};
}

}  // namespace dynwitness::audit
