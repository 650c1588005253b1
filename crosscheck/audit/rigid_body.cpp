// SPDX-License-Identifier: GPL-3.0-or-later
// Section 6: one rigid body. The truth is a cloud of point masses that obeys Newton's law.
#include "crosscheck/audit/truths.hpp"

namespace dynwitness::audit {
namespace {

/// A body on any path, seen in world axes from its frame's origin.
template <typename T>
struct Moving {
  Path<T> path;
  PointMasses<T> body;  ///< in its own frame

  PointMasses<T> inWorldAxes() const { return body.seenFrom(path.axes(), Vector3<T>::Zero()); }
  Matrix6<T> M() const { return massMatrix6(inWorldAxes()); }
  Vector6<T> force() const { return body.force(path, path.origin()).vector(); }
  /// (w x (w x m r_c), w x I w)
  Vector6<T> printedBias() const {
    const PointMasses<T> seen = inWorldAxes();
    const Vector3<T> w = path.omega(), h = seen.firstMoment();
    const Matrix3<T> I = seen.inertiaAbout(Vector3<T>::Zero());
    return Force<T>{w.cross(w.cross(h)), w.cross(Vector3<T>(I * w))}.vector();
  }
  /// Spatial acceleration: that of the body, seen from where its origin is now.
  Motion<T> spatialAcceleration() const {
    const Motion<T> v = path.velocity(), a = path.acceleration();
    return {a.linear - v.angular.cross(v.linear), a.angular};
  }
};

template <typename At>
Moving<ScalarOf<At>> anyMoving(At& at, Start start = Start::kMoving) {
  const auto path = anyPath(at, start);
  return {path, anyBody(at)};
}

template <typename T>
Matrix6<T> inverse6(const Matrix6<T>& M) {
  Matrix6<T> inverse;
  for (int j = 0; j < 6; ++j) {
    VectorX<T> e = VectorX<T>::Constant(6, T(0));
    e(j) = T(1);
    inverse.col(j) = solveDense<T>(M, e);
  }
  return inverse;
}

template <typename T>
Matrix3<T> diagonal3(const T& x, const T& y, const T& z) {
  Matrix3<T> m = Matrix3<T>::Zero();
  m(0, 0) = x;
  m(1, 1) = y;
  m(2, 2) = z;
  return m;
}

/// All entries off the diagonal.
template <typename T>
VectorX<T> offDiagonal(const Matrix6<T>& M) {
  VectorX<T> entries(30);
  int k = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      if (i != j) entries(k++) = M(i, j);
  return entries;
}

void addEquationsOfMotion(std::vector<Claim>* claims) {
  claims->push_back(
      Claim("eq15", "6", "Newton-Euler for a rigid body")
          .printed("`F = M Xdd + F_b`, `F_b = (w x (w x m r_c), w x I w)`", exact([](auto& at) {
                     const auto moving = anyMoving(at);
                     at.equal(
                         "force", moving.force(),
                         moving.M() * moving.path.acceleration().vector() + moving.printedBias());
                   }))
          .why("So it is when `Xdd = (vd, wd)` is the acceleration of the body's point at the "
               "origin, and moments are about that point. It is not the `Xdd` that (14) carries "
               "between frames: see eq15_spatial.")
          .in("recursive/spatial.hpp"));

  const auto spatialBias = [](auto& at, const Path<ScalarOf<decltype(at)>>& path) {
    using T = ScalarOf<decltype(at)>;
    const Moving<T> moving{path, anyBody(at)};
    at.equal("force", moving.force(),
             moving.M() * moving.spatialAcceleration().vector() + moving.printedBias());
  };
  claims->push_back(
      Claim("eq15_spatial", "6", "(15) with the acceleration that (14) transforms")
          .printed("`F = M Xdd + F_b` with the `F_b` of (15) and an `Xdd` for which (14) holds",
                   exact([spatialBias](auto& at) { spatialBias(at, anyPath(at)); }))
          .condition("`v = 0`: the origin of the frame is at rest at this moment",
                     exact([spatialBias](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       Path<T> path = anyPath(at);
                       for (int i = 0; i < 3; ++i) {
                         path.p(i).value.derivative = T(0);
                         path.p(i).derivative.value = T(0);
                       }
                       spatialBias(at, path);
                     }))
          .corrected("`F = M a + Xd x* (M Xd)` with `a = (vd - w x v, wd)`; with that `a`, (15) "
                     "lacks the force `m w x v` and the moment `m r_c x (w x v)`",
                     exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       const auto moving = anyMoving(at);
                       const PointMasses<T> seen = moving.inWorldAxes();
                       const RigidInertia<T> M = seen.inertia();
                       const Motion<T> Xd = moving.path.velocity(),
                                       a = moving.spatialAcceleration();
                       at.equal("our code", moving.force(), (M * a + biasForce(M, Xd)).vector());
                       const Vector3<T> h = seen.firstMoment(), &v = Xd.linear, &w = Xd.angular;
                       const Force<T> gained{w.cross(v) * seen.mass(), h.cross(w.cross(v))};
                       at.equal("written out", moving.force(),
                                moving.M() * a.vector() + moving.printedBias() + gained.vector());
                     }))
          .why("(14) and (15) use one letter for two accelerations. They differ by `w x v`, and "
               "the bias force has to follow the choice.")
          .in("recursive/spatial.hpp"));

  claims->push_back(
      Claim("linear_in_mass", "6", "What enters linearly")
          .printed(
              "`F` is linear in `M` and `Xdd` and quadratic in the velocity", exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                // two bodies on one path, and one path walked twice as fast
                const auto one = anyMoving(at);
                const Moving<T> other{one.path, anyBody(at)};
                PointMasses<T> together = one.body;
                together.m.insert(together.m.end(), other.body.m.begin(), other.body.m.end());
                together.r.insert(together.r.end(), other.body.r.begin(), other.body.r.end());
                const Moving<T> sum{one.path, together};
                at.equal("bodies add", sum.force(), one.force() + other.force());
                Path<T> fast = one.path;
                const auto faster = [](Jet<T>& x) {
                  x = jet<T>(x.value.value, T(2) * x.value.derivative,
                             T(4) * x.derivative.derivative);
                };
                for (int i = 0; i < 9; ++i) faster(fast.R(i));
                for (int i = 0; i < 3; ++i) faster(fast.p(i));
                at.equal("twice as fast", Moving<T>{fast, one.body}.force(), one.force() * T(4));
              }))
          .why("The bias force has two factors of velocity in each term; walking a path twice as "
               "fast needs four times the force.")
          .in("recursive/spatial.hpp"));

  claims->push_back(
      Claim("bias_vanishes", "6", "When the bias force vanishes")
          .printed(
              "`F_b = 0` for all `w` only if `r_c = 0` and `I` is a multiple of the unit matrix; "
              "otherwise a rotation generates a force: `F_b = 0` at this `w` says `I_xx = I_yy = "
              "I_zz`",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                // a top that spins about its own axis: the premise F_b = 0 is part of the
                // comparison
                const Matrix3<T> I = diagonal3<T>(at.number(), at.number(), at.number());
                const Vector3<T> w(T(0), T(0), at.number()), h(T(0), T(0), at.number());
                at.zero("F_b", Force<T>{w.cross(w.cross(h)), w.cross(Vector3<T>(I * w))}.vector());
                at.equal("I_xx and I_yy", I(0, 0), I(1, 1));
                at.zero("r_c", h);
              }))
          .corrected(
              "`F_b = 0` exactly when `w x (w x r_c) = 0` and `w x I w = 0`: `w` along a principal "
              "axis of `I`, and the centre of mass on the axis of rotation",
              both(exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     // I = any with the eigenvector w: k w w' + what annihilates w
                     const Vector3<T> w = at.vector();
                     const Matrix3<T> w_hat = skew<T>(w);
                     const Matrix3<T> S = at.template symmetric<3>();
                     const Matrix3<T> I =
                         w * w.transpose() * at.number() - Matrix3<T>(w_hat * S * w_hat);
                     const Vector3<T> h = w * at.number();
                     at.zero("F_b",
                             Force<T>{w.cross(w.cross(h)), w.cross(Vector3<T>(I * w))}.vector());
                   }),
                   differs([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const Vector3<T> w = at.vector();
                     const Matrix3<T> I = at.template symmetric<3>();
                     at.zero("w x I w of any other w", Vector3<T>(w.cross(Vector3<T>(I * w))));
                   })))
          .why("A well-made wheel is no sphere and has no bias force: it spins about a principal "
               "axis through its centre of mass. Balancing a tyre is making that so.")
          .in("recursive/spatial.hpp"));

  claims->push_back(
      Claim("centripetal", "6", "Direction of the bias force")
          .printed("The centripetal force moves the object away from the axis: `F_b . r > 0`, `r` "
                   "from the axis to the object",
                   certified([](RealPoint& at) {
                     const Vector3<Ball> w = at.vector(), h = at.vector();
                     const Vector3<Ball> r = h - w * (w.dot(h) / w.dot(w));
                     at.positive("F_b . r", w.cross(w.cross(h)).dot(r));
                   }))
          .corrected(
              "The centripetal force, which (15) asks for, points to the axis: `F_b . r < 0`. What "
              "seems to pull outwards is its reaction",
              certified([](RealPoint& at) {
                const Vector3<Ball> w = at.vector(), h = at.vector();
                const Vector3<Ball> r = h - w * (w.dot(h) / w.dot(w));
                at.positive("-F_b . r", -w.cross(w.cross(h)).dot(r));
              }))
          .why("Centripetal means seeking the centre; the hand feels the opposite (centrifugal) "
               "force.")
          .in("recursive/spatial.hpp"));
}

void addMassMatrix(std::vector<Claim>* claims) {
  claims->push_back(Claim("eq16", "6", "Inertia about another point")
                        .printed("`I = I_c - m hat(r_c) hat(r_c)`", exact([](auto& at) {
                                   using T = ScalarOf<decltype(at)>;
                                   const auto body = anyBody(at);
                                   const Vector3<T> r_c = body.center();
                                   const Matrix3<T> hat = skew<T>(r_c),
                                                    I_c = body.inertiaAbout(r_c);
                                   const Matrix3<T> I = body.inertiaAbout(Vector3<T>::Zero());
                                   at.equal("I", I, I_c - Matrix3<T>(hat * hat) * body.mass());
                                   at.equal("our code", I,
                                            RigidInertia<T>::aboutCenterOfMass(
                                                body.mass(), r_c, Symmetric3<T>::fromUpper(I_c))
                                                .I.matrix());
                                 }))
                        .why("The parallel axis theorem; `-hat(r) hat(r) = r'r 1 - r r'` is not "
                             "negative, so inertia is least about the centre of mass.")
                        .in("recursive/spatial.hpp"));

  const auto aboutCenter = [](auto& at, Start start, bool with_bias) {
    using T = ScalarOf<decltype(at)>;
    const auto moving = anyMoving(at, start);
    const Vector3<T> center = moving.body.center();
    const Path<T>& path = moving.path;
    const Vector3<Jet<T>> x_c = path.place(center);
    const Force<T> F = moving.body.force(path, now<T, 3, 1>(x_c));
    const Matrix3<T> I = path.axes() * moving.body.inertiaAbout(center) * path.axes().transpose();
    const Vector3<T> w = path.omega();
    Vector3<T> moment = I * path.alpha();
    if (with_bias) moment += w.cross(Vector3<T>(I * w));
    at.equal("force", F.force, secondRate<T, 3, 1>(x_c) * moving.body.mass());
    at.equal("moment", F.moment, moment);
  };
  claims->push_back(
      Claim("eq17", "6", "Newton and Euler about the centre of mass")
          .printed("`f_c = m vd_c`, `m_c = I wd`",
                   exact([aboutCenter](auto& at) { aboutCenter(at, Start::kMoving, false); }))
          .condition("`w = 0` at this moment (or `w` along a principal axis)",
                     exact([aboutCenter](auto& at) { aboutCenter(at, Start::kNotTurning, false); }))
          .corrected("`f_c = m vd_c`, `m_c = I_c wd + w x I_c w`",
                     exact([aboutCenter](auto& at) { aboutCenter(at, Start::kMoving, true); }))
          .why("Angular momentum `I_c w` also changes because the body turns under it. Euler's "
               "equation has this term, and (15) has it back.")
          .in("recursive/spatial.hpp"));

  claims->push_back(Claim("eq18", "6", "The 6 x 6 mass matrix")
                        .printed("`M = [m 1, -m hat(r_c); m hat(r_c), I]`", exact([](auto& at) {
                                   using T = ScalarOf<decltype(at)>;
                                   // momentum of the point masses under any velocity
                                   const auto body = anyBody(at);
                                   const Motion<T> x = at.motion();
                                   Force<T> momentum = Force<T>::zero();
                                   T twice_energy = T(0);
                                   for (std::size_t k = 0; k < body.m.size(); ++k) {
                                     const Vector3<T> v = x.linear + x.angular.cross(body.r[k]);
                                     const Vector3<T> p = v * body.m[k];
                                     momentum = momentum + Force<T>{p, body.r[k].cross(p)};
                                     twice_energy += v.dot(p);
                                   }
                                   const Matrix6<T> M = massMatrix6(body);
                                   at.equal("momentum", momentum.vector(), M * x.vector());
                                   at.equal("kinetic energy", twice_energy,
                                            x.vector().dot(M * x.vector()));
                                   at.equal("our code", momentum, body.inertia() * x);
                                 }))
                        .why("The first row: the centre of mass moves with `v - r_c x w`. The "
                             "second: its momentum has the lever `r_c`.")
                        .in("recursive/spatial.hpp"));

  claims->push_back(Claim("symmetric_mass", "6", "Symmetry of I and M")
                        .printed("`I = I'` and `M = M'` in every frame", exact([](auto& at) {
                                   using T = ScalarOf<decltype(at)>;
                                   const auto body =
                                       anyBody(at).seenFrom(at.rotation(), at.vector());
                                   const Matrix6<T> M = massMatrix6(body);
                                   at.equal("M", M, M.transpose());
                                   const Transform<T> X = at.transform();
                                   const Matrix6<T> M_1 =
                                       X.inverse().forceMatrix() * M * X.motionMatrix();
                                   at.equal("carried elsewhere", M_1, M_1.transpose());
                                 }))
                        .why("Kinetic energy is a quadratic form, and `T_F M T_F'` keeps symmetry.")
                        .in("recursive/spatial.hpp"));

  claims->push_back(
      Claim("diagonal_mass", "6", "When M is diagonal")
          .printed("`M` is diagonal in one case only, at the centre of a perfect sphere: `M` "
                   "diagonal says `I_xx = I_yy = I_zz`",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     // a brick: masses at the corners of a box, seen from its middle along its
                     // edges
                     PointMasses<T> brick;
                     const T a = at.number(), b = at.number(), c = at.number(), m = at.number();
                     for (const int x : {-1, 1})
                       for (const int y : {-1, 1})
                         for (const int z : {-1, 1}) {
                           brick.m.push_back(m);
                           brick.r.push_back({a * T(x), b * T(y), c * T(z)});
                         }
                     const Matrix6<T> M = massMatrix6(brick);
                     at.zero("off the diagonal", offDiagonal<T>(M));
                     at.equal("I_xx and I_yy", M(3, 3), M(4, 4));
                     at.equal("I_yy and I_zz", M(4, 4), M(5, 5));
                   }))
          .corrected("`M` is diagonal for every body, in the principal axes at its centre of mass. "
                     "It stays so however the axes are turned when `I_c = k 1`, as for a sphere or "
                     "a cube",
                     exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       const Matrix3<T> I = diagonal3<T>(at.number(), at.number(), at.number());
                       at.zero("principal axes",
                               offDiagonal<T>(massMatrix6<T>(at.number(), Vector3<T>::Zero(), I)));
                       // the corners of a cube
                       PointMasses<T> cube;
                       const T a = at.number(), m = at.number();
                       for (const int x : {-1, 1})
                         for (const int y : {-1, 1})
                           for (const int z : {-1, 1}) {
                             cube.m.push_back(m);
                             cube.r.push_back({a * T(x), a * T(y), a * T(z)});
                           }
                       at.zero("a cube in any axes", offDiagonal<T>(massMatrix6(cube.seenFrom(
                                                         at.rotation(), Vector3<T>::Zero()))));
                     }))
          .why("A symmetric `I_c` always has principal axes. A brick, seen from its middle along "
               "its edges, has a diagonal `M`.")
          .in("recursive/spatial.hpp"));

  claims->push_back(
      Claim("coupling_force", "6", "One force component, all accelerations")
          .printed(
              "Unless the body is a sphere seen from its centre, a force along one axis "
              "accelerates "
              "along all six: no component of `M^-1 e_1` is 0, for an `M` that is not diagonal",
              certified([](RealPoint& at) {
                // seen from the centre of mass, in axes that are not principal
                Matrix3<Ball> I = diagonal3<Ball>(2, 3, 4);
                I(0, 1) = I(1, 0) = at.number(0.1, 1);
                I(0, 2) = I(2, 0) = at.number(0.1, 1);
                I(1, 2) = I(2, 1) = at.number(0.1, 1);
                const Matrix6<Ball> M =
                    massMatrix6<Ball>(at.number(1, 2), Vector3<Ball>::Zero(), I);
                VectorX<Ball> e = VectorX<Ball>::Constant(6, Ball(0));
                e(0) = Ball(1);
                const VectorX<Ball> acceleration = solveDense<Ball>(M, e);
                for (int i = 0; i < 6; ++i)
                  at.positive("squared component", acceleration(i) * acceleration(i));
              }))
          .corrected(
              "Seen from the centre of mass, force and turning are not coupled at all: a force "
              "along an axis accelerates along that axis alone, and a moment only turns",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                const T m = at.number();
                const Matrix3<T> I = at.template symmetric<3>();
                const Matrix6<T> M_inverse = inverse6<T>(massMatrix6<T>(m, Vector3<T>::Zero(), I));
                at.equal("force to acceleration", M_inverse.template block<3, 3>(0, 0) * m,
                         Matrix3<T>::Identity());
                at.zero("force to turning", Matrix3<T>(M_inverse.template block<3, 3>(3, 0)));
                at.zero("moment to acceleration", Matrix3<T>(M_inverse.template block<3, 3>(0, 3)));
              }))
          .why("That `M` has entries off its diagonal does not say that all of them are there: the "
               "blocks that couple force with turning are zero at the centre of mass.")
          .in("recursive/spatial.hpp"));

  claims->push_back(
      Claim("coupling_acceleration", "6", "One acceleration component, all forces")
          .printed("Unless the body is a sphere seen from its centre, an acceleration along one "
                   "axis alone needs a force in all six components: no entry of `M e_i` is 0",
                   certified([](RealPoint& at) {
                     const Vector3<Ball> h = at.vector(0.1, 1);
                     Matrix3<Ball> I = diagonal3<Ball>(2, 3, 4);
                     I(0, 1) = I(1, 0) = at.number(0.1, 1);
                     const Matrix6<Ball> M = massMatrix6<Ball>(at.number(1, 2), h, I);
                     for (int i = 0; i < 6; ++i)
                       at.positive("squared entry of M e_1", M(i, 0) * M(i, 0));
                   }))
          .corrected(
              "No body does: `M e_i` has at least one 0 for each `i`. A linear acceleration needs "
              "at most its own force and two moments, an angular one at most two forces and three "
              "moments",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                const Matrix6<T> M = massMatrix6(anyBody(at));
                for (int i = 0; i < 3; ++i) {
                  at.zero("other forces",
                          VectorX<T>(
                              (VectorX<T>(2) << M((i + 1) % 3, i), M((i + 2) % 3, i)).finished()));
                  at.zero("moment about the same axis", M(3 + i, i));
                  at.zero("force along the axis of turning", M(i, 3 + i));
                }
              }))
          .why("The blocks `m 1` and `m hat(r_c)` of (18) have zeros that no choice of axes "
               "removes.")
          .in("recursive/spatial.hpp"));

  const auto rotated = [](auto& at, bool same_origin) {
    using T = ScalarOf<decltype(at)>;
    const auto in_2 = anyBody(at);
    const Matrix3<T> R = at.rotation();
    const Vector3<T> r_12 = same_origin ? Vector3<T>(Vector3<T>::Zero()) : at.vector();
    const auto in_1 = in_2.seenFrom(R, r_12);
    const Vector3<T> origin = Vector3<T>::Zero();
    const Transform<T> X_21{R.transpose(), r_12};
    const Matrix6<T> T_F = X_21.inverse().forceMatrix();
    at.equal("I_1", in_1.inertiaAbout(origin), R * in_2.inertiaAbout(origin) * R.transpose());
    at.equal("M_1", massMatrix6(in_1), T_F * massMatrix6(in_2) * T_F.transpose());
  };
  claims->push_back(
      Claim("eq19", "6", "Inertia in another frame")
          .printed("`I_1 = R I_2 R'` and `M_1 = T_F_12 M_2 T_F_12'`",
                   exact([rotated](auto& at) { rotated(at, false); }))
          .condition(
              "`r_12 = 0`: the frames share their origin (the part for `M` needs no condition)",
              exact([rotated](auto& at) { rotated(at, true); }))
          .corrected(
              "`I_1 = R I_2 R' - hat(r_12) hat(h) - hat(h + m r_12) hat(r_12)` with `h = R h_2`, "
              "`h_2 = m r_c` in frame 2; `M_1 = T_F_12 M_2 T_F_12'`",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                const auto in_2 = anyBody(at);
                const Matrix3<T> R = at.rotation();
                const Vector3<T> r = at.vector(), h = R * in_2.firstMoment();
                const auto in_1 = in_2.seenFrom(R, r);
                const Vector3<T> origin = Vector3<T>::Zero(), h_1 = h + r * in_2.mass();
                at.equal("I_1", in_1.inertiaAbout(origin),
                         R * in_2.inertiaAbout(origin) * R.transpose() -
                             Matrix3<T>(skew<T>(r) * skew<T>(h)) -
                             Matrix3<T>(skew<T>(h_1) * skew<T>(r)));
                const Transform<T> X_21{R.transpose(), r};
                const Matrix6<T> T_F = X_21.inverse().forceMatrix();
                at.equal("M_1", massMatrix6(in_1), T_F * massMatrix6(in_2) * T_F.transpose());
                at.equal(
                    "our code", massMatrix6(in_1),
                    recursive::ArticulatedInertia<T>::fromRigid(X_21.inverseTimes(in_2.inertia()))
                        .matrix());
              }))
          .why(
              "`I` is about the frame's origin, so it changes when the origin moves, by (16) "
              "twice. "
              "Kinetic energy `Xd' M Xd / 2` does not know the frame: that gives the part for `M`.")
          .in("recursive/spatial.hpp"));

  claims->push_back(
      Claim("ten_parameters", "6", "Ten numbers describe a body's inertia")
          .printed("`M` has ten parameters: mass, three of the centre of mass, six of `I`",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     // any M of point masses is fixed by ten of its entries
                     const Matrix6<T> M = massMatrix6(anyBody(at));
                     const Vector3<T> h(M(5, 1), M(3, 2), M(4, 0));
                     Matrix3<T> I;
                     I << M(3, 3), M(3, 4), M(3, 5), M(3, 4), M(4, 4), M(4, 5), M(3, 5), M(4, 5),
                         M(5, 5);
                     at.equal("M", M, massMatrix6<T>(M(0, 0), h, I));
                   }))
          .why("Of the 21 numbers of a symmetric 6 x 6 matrix a rigid body uses ten; the "
               "articulated inertia of section 7 uses more.")
          .in("recursive/spatial.hpp"));
}

}  // namespace

std::vector<Claim> rigidBody() {
  std::vector<Claim> claims;
  addEquationsOfMotion(&claims);
  addMassMatrix(&claims);
  return claims;
}

}  // namespace dynwitness::audit
