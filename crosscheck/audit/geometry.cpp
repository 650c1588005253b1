// SPDX-License-Identifier: GPL-3.0-or-later
// Sections 16.1 and 17: impedances in other frames, and the geometry of the mass matrix.
#include "crosscheck/audit/lifted.hpp"

namespace dynwitness::audit {
namespace {

/// A body held by springs, each along a direction u at a place p of the body's frame; and the same
/// springs seen from another frame. What they do follows from lengthening each, without any 6 x 6
/// transformation.
template <typename T>
struct Springs {
  std::vector<T> k;
  std::vector<Vector3<T>> u, p;

  /// sum k A A', A = (u, p x u)
  Matrix6<T> stiffness() const {
    Matrix6<T> K = Matrix6<T>::Zero();
    for (std::size_t i = 0; i < k.size(); ++i) {
      const Vector6<T> A = Force<T>{u[i], p[i].cross(u[i])}.vector();
      K += (A * k[i]) * A.transpose();
    }
    return K;
  }
  Matrix6<T> compliance() const { return inverseDense<T>(stiffness()); }
  Springs seenFrom(const Transform<T>& X) const {
    Springs out = *this;
    for (std::size_t i = 0; i < k.size(); ++i) {
      out.u[i] = X.R * u[i];
      out.p[i] = X.R * (p[i] - X.p);
    }
    return out;
  }
};
template <typename At>
Springs<ScalarOf<At>> anySprings(At& at) {
  Springs<ScalarOf<At>> out;
  for (int i = 0; i < 6; ++i) {
    out.k.push_back(at.number());
    out.u.push_back(at.vector());
    out.p.push_back(at.vector());
  }
  return out;
}
template <typename T>
Matrix6<T> inverse6(const Matrix6<T>& A) {
  return inverseDense<T>(A);
}
/// Moment first: swaps the halves of a wrench.
template <typename T>
Matrix6<T> swapped() {
  Matrix6<T> m = Matrix6<T>::Zero();
  for (int i = 0; i < 6; ++i) m(i, (i + 3) % 6) = T(1);
  return m;
}

std::vector<Claim> impedances() {
  std::vector<Claim> claims;
  claims.push_back(
      Claim("eq73", "16.1", "A displacement by compliance, in two frames")
          .printed("`t_f = S t_i = S (C_i w_i) = C_f w_f`", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto springs = anySprings(at);
                     const Transform<T> X = at.transform();
                     const Force<T> w = at.force();
                     const Force<T> w_f = {X.R * w.force, X.R * (w.moment - X.p.cross(w.force))};
                     at.equal("t_f",
                              Vector6<T>(X.motionMatrix() * (springs.compliance() * w.vector())),
                              Vector6<T>(springs.seenFrom(X).compliance() * w_f.vector()));
                   }))
          .why("One body on springs, its displacement computed in both frames.")
          .in("recursive/spatial.hpp"));
  claims.push_back(
      Claim("eq74", "16.1", "Compliance in another frame")
          .printed("`C_f = S C_i S^-1`", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto springs = anySprings(at);
                     const Transform<T> X = at.transform();
                     const Matrix6<T> S = X.motionMatrix();
                     at.equal("C_f", springs.seenFrom(X).compliance(),
                              Matrix6<T>(S * springs.compliance() * X.inverse().motionMatrix()));
                   }))
          .condition(
              "wrenches are listed moment first, w = (m, f), against twists (v, w): then both have "
              "the same S",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                const auto springs = anySprings(at);
                const Transform<T> X = at.transform();
                const Matrix6<T> S = X.motionMatrix(), swap = swapped<T>();
                at.equal("C_f", Matrix6<T>(springs.seenFrom(X).compliance() * swap),
                         Matrix6<T>(S * springs.compliance() * swap * X.inverse().motionMatrix()));
              }))
          .corrected("`C_f = S C_i S'`", exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       const auto springs = anySprings(at);
                       const Transform<T> X = at.transform();
                       const Matrix6<T> S = X.motionMatrix();
                       at.equal("C_f", springs.seenFrom(X).compliance(),
                                Matrix6<T>(S * springs.compliance() * S.transpose()));
                     }))
          .why("Wrenches change with the dual matrix, w_i = S' w_f, as (13) says. The result is a "
               "congruence and keeps C symmetric, which a similarity does not.")
          .in("recursive/spatial.hpp"));
  claims.push_back(
      Claim("similarity", "16.1", "What a similarity transformation leaves unchanged")
          .printed("it leaves eigenvalues and eigenvectors of the compliance unchanged",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const Vector6<T> v = at.vector6(), y = at.vector6();
                     const Matrix6<T> C = v * y.transpose();  // eigenvector v, eigenvalue y' v
                     const Transform<T> X = at.transform();
                     const Matrix6<T> C_f = X.motionMatrix() * C * X.inverse().motionMatrix();
                     at.equal("C_f v", Vector6<T>(C_f * v), Vector6<T>(v * y.dot(v)));
                   }))
          .corrected(
              "a similarity leaves eigenvalues and takes eigenvectors to `S v`; the congruence "
              "that "
              "compliances obey leaves neither. What stays is the energy `1/2 w' C w`, and of two "
              "impedances the eigenvalues of `C M`",
              both(exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const Vector6<T> v = at.vector6(), y = at.vector6();
                     const Transform<T> X = at.transform();
                     const Matrix6<T> S = X.motionMatrix();
                     const Matrix6<T> C_f = S * (v * y.transpose()) * X.inverse().motionMatrix();
                     at.equal("C_f S v", Vector6<T>(C_f * (S * v)), Vector6<T>(S * v * y.dot(v)));
                     const auto springs = anySprings(at);
                     const auto body = anyBody(at);
                     const Matrix6<T> C_i = springs.compliance(),
                                      C = springs.seenFrom(X).compliance();
                     const Matrix6<T> M_i = massMatrix6(body),
                                      M = massMatrix6(body.seenFrom(X.R, Vector3<T>(X.R * -X.p)));
                     at.equal("C M", Matrix6<T>(C * M * S), Matrix6<T>(S * C_i * M_i));
                     const Force<T> w = at.force();
                     const Vector6<T> w_f = (X * w).vector();
                     at.equal("energy", T(w_f.dot(C * w_f)), T(w.vector().dot(C_i * w.vector())));
                   }),
                   differs([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto springs = anySprings(at);
                     const Transform<T> X = at.transform();
                     at.equal("sum of the eigenvalues of C",
                              springs.seenFrom(X).compliance().trace(),
                              T(springs.compliance().trace()));
                   })))
          .why("Eigenvalues of a compliance alone add N/m to N m/rad: they depend on the choice of "
               "the origin and mean nothing. Those of C M are squared periods, and do.")
          .in("recursive/spatial.hpp"));
  claims.push_back(
      Claim("other_impedances", "16.1", "Stiffness and inertia in another frame")
          .printed("in the same way, `K_f = S K_i S^-1` and `M_f = S M_i S^-1`",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto springs = anySprings(at);
                     const auto body = anyBody(at);
                     const Transform<T> X = at.transform();
                     const Matrix6<T> S = X.motionMatrix(), S_back = X.inverse().motionMatrix();
                     at.equal("K_f", springs.seenFrom(X).stiffness(),
                              Matrix6<T>(S * springs.stiffness() * S_back));
                     at.equal("M_f", massMatrix6(body.seenFrom(X.R, Vector3<T>(X.R * -X.p))),
                              Matrix6<T>(S * massMatrix6(body) * S_back));
                   }))
          .corrected("`K_f = S^-T K_i S^-1`, and M and damping likewise, as (19) has it",
                     exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       const auto springs = anySprings(at);
                       const auto body = anyBody(at);
                       const Transform<T> X = at.transform();
                       const Matrix6<T> S_back = X.inverse().motionMatrix();
                       at.equal("K_f", springs.seenFrom(X).stiffness(),
                                Matrix6<T>(S_back.transpose() * springs.stiffness() * S_back));
                       at.equal("M_f", massMatrix6(body.seenFrom(X.R, Vector3<T>(X.R * -X.p))),
                                Matrix6<T>(S_back.transpose() * massMatrix6(body) * S_back));
                     }))
          .why("They take motions to forces, so the motion goes in with S^-1 and the force comes "
               "out with the dual S^-T. The chapter's own (19) is of this form.")
          .in("recursive/spatial.hpp"));
  return claims;
}

// ---- the metric M -------------------------------------------------------------------------------

/// R_1212 of the metric M of two joints, from M and its derivatives alone.
template <typename T>
T riemann(const Robot<T>& robot) {
  auto metric = metricOf(robot);
  const VectorX<T> e_1 = metric.unit(0), e_2 = metric.unit(1);
  return metric.riemann(e_1, e_2, e_1, e_2);
}

/// A planar arm of two turning joints about parallel axes, q_2 any angle.
template <typename At>
Robot<ScalarOf<At>> planarArm(At& at) {
  using T = ScalarOf<At>;
  Robot<T> robot = anyRobot(at, {kTurn, kTurn}, Rotors::kNone);
  for (int i = 0; i < 2; ++i) robot.R[i] = Matrix3<T>::Identity();
  return robot;
}

std::vector<Claim> metric() {
  std::vector<Claim> claims;
  claims.push_back(
      Claim("christoffel", "17", "Connection of the kinetic energy")
          .open()
          .printed("Our answer: with M as metric, `1/2 (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) = "
                   "sum of m (dx/dq_i)' (d2x/dq_j dq_k)` over all points, symmetric in j and k",
                   exact([](auto& at) {
                     const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
                     const auto metric = metricOf(robot);
                     for (const auto& [i, j, k] :
                          {std::tuple(0, 1, 2), std::tuple(1, 0, 2), std::tuple(2, 0, 1),
                           std::tuple(0, 2, 2), std::tuple(2, 0, 0)})
                       at.equal(
                           "symbol", metric.christoffel(i, j, k),
                           weighted(robot, firstPartials(robot, i), secondPartials(robot, j, k)));
                   }))
          .why("The robot moves on a surface in the flat space of all its points, each direction "
               "weighted by its mass. Left: from M alone, as one who lives on the surface sees it. "
               "Right: from outside.")
          .in("crosscheck/studies/kinetic_metric.hpp"));
  claims.push_back(
      Claim("metric_compatible", "17", "The connection keeps the metric")
          .open()
          .printed("Our answer: `dM_ij/dq_k = C_ijk + C_jik` with the symbols from the points",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
                     const auto metric = metricOf(robot);
                     const auto C = [&](int i, int j, int k) {
                       return weighted(robot, firstPartials(robot, i), secondPartials(robot, j, k));
                     };
                     for (int k = 0; k < 3; ++k)
                       for (int i = 0; i < 2; ++i)
                         at.equal("dM", metric.gradient()[k](i, 2), T(C(i, 2, k) + C(2, i, k)));
                   }))
          .why("This is dM/dt - 2 C being skew-symmetric, in the language of geometry.")
          .in("crosscheck/studies/kinetic_metric.hpp"));
  claims.push_back(
      Claim("geodesic", "17", "Motion without forces")
          .open()
          .printed(
              "Our answer: without gravity and torques the robot follows a geodesic, `qdd_i + sum "
              "Gamma^i_jk qd_j qd_k = 0`, at constant kinetic energy",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
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
                    for (int i = 0; i < 2; ++i)
                      bend(i) += metric.christoffel(i, j, k) * qd(j) * qd(k);
                    for (int i = 0; i < 2; ++i)
                      rate += metric.gradient()[k](i, j) * qd(i) * qd(j) * qd(k);
                  }
                at.zero("qdd + Gamma qd qd", VectorX<T>(qdd + solveDense<T>(M, bend)));
                at.zero("rate of 2 T", rate);
              }))
          .why("Coriolis and centrifugal forces are not forces of anything: they are what the "
               "coordinates make of going straight on.")
          .in("recursive/composite_body.hpp"));
  claims.push_back(
      Claim("curvature", "17", "Curvature of the configuration space")
          .open()
          .printed(
              "Our answer: `R_1212` from M and its derivatives equals what Gauss's equation gives "
              "from outside, `II_11 II_22 - II_12^2` with the parts of `d2x/dq_j dq_k` normal to "
              "the surface; for two slides it is 0",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
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
              }))
          .why("Gauss's remarkable theorem: bending seen from outside is felt inside. Two slides "
               "move on a plane, so nothing bends.")
          .in("crosscheck/studies/kinetic_metric.hpp"));
  claims.push_back(Claim("planar_curvature", "17", "Curvature of a planar arm with two joints")
                       .open()
                       .printed("Our answer: with `M = (a + 2 b cos q2, e + b cos q2; e + b cos "
                                "q2, e)` (q2 from the stretched pose) the Gaussian curvature is `b "
                                "cos q2 (a e - e^2 - b^2) / (det M)^2`: positive towards the "
                                "stretched pose, negative towards the folded one",
                                exact([](auto& at) {
                                  using T = ScalarOf<decltype(at)>;
                                  Robot<T> robot = planarArm(at);
                                  robot.r[1] = Vector3<T>(at.number(), T(0), T(0));
                                  // the second link's centre of mass on its x axis: q2 = 0 is
                                  // stretched
                                  T moment = T(0);
                                  for (int k = 0; k < 2; ++k)
                                    moment += robot.body[1].m[k] * robot.body[1].r[k].y();
                                  robot.body[1].r[2].y() = -moment / robot.body[1].m[2];
                                  const T c = robot.x[1].c, length = robot.r[1].x();
                                  const T b = length * robot.body[1].firstMoment().x();
                                  const T e = robot.body[1].inertiaAbout(Vector3<T>::Zero())(2, 2);
                                  const T a = robot.body[0].inertiaAbout(Vector3<T>::Zero())(2, 2) +
                                              e + robot.body[1].mass() * length * length;
                                  const MatrixX<T> M = robot.massMatrix();
                                  at.equal("M_11", M(0, 0), T(a + T(2) * b * c));
                                  const T det = M(0, 0) * M(1, 1) - M(0, 1) * M(1, 0);
                                  at.equal("curvature", T(riemann(robot) / det),
                                           T(b * c * (a * e - e * e - b * b) / (det * det)));
                                }))
                       .why("Where the curvature is negative, free motions that start side by side "
                            "run apart; where it is positive they draw together.")
                       .in("crosscheck/studies/kinetic_metric.hpp"));
  return claims;
}

}  // namespace

std::vector<Claim> geometry() {
  std::vector<Claim> claims = impedances();
  for (Claim& claim : metric()) claims.push_back(std::move(claim));
  return claims;
}

}  // namespace dynwitness::audit
