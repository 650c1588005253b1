// SPDX-License-Identifier: GPL-3.0-or-later
// Section 6: one rigid body. The truth is a cloud of point masses that obeys Newton's law.
#include <utility>

#include "crosscheck/audit/board.hpp"
#include "crosscheck/audit/ours.hpp"
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

Moving<T> anyMoving(Point& at, Start start = Start::kMoving) {
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

Trials eq15() {
  return Trials("eq15")
      .printed(exact([](Point& at) {
        const auto moving = anyMoving(at);
        at.equal("force", moving.force(),
                 moving.M() * moving.path.acceleration().vector() + moving.printedBias());
      }))
      .ours(ourBodies());
}

void spatialBias(Point& at, const Path<T>& path) {
  const Moving<T> moving{path, anyBody(at)};
  at.equal("force", moving.force(),
           moving.M() * moving.spatialAcceleration().vector() + moving.printedBias());
}

Trials eq15Spatial() {
  return Trials("eq15_spatial")
      .printed(exact([](Point& at) { spatialBias(at, anyPath(at)); }))
      .condition(exact([](Point& at) {
        Path<T> path = anyPath(at);
        for (int i = 0; i < 3; ++i) {
          path.p(i).value.derivative = T(0);
          path.p(i).derivative.value = T(0);
        }
        spatialBias(at, path);
      }))
      .corrected(exact([](Point& at) {
        const auto moving = anyMoving(at);
        const PointMasses<T> seen = moving.inWorldAxes();
        const RigidInertia<T> M = seen.inertia();
        const Motion<T> Xd = moving.path.velocity(), a = moving.spatialAcceleration();
        at.equal("our code", moving.force(), (M * a + biasForce(M, Xd)).vector());
        const Vector3<T> h = seen.firstMoment(), &v = Xd.linear, &w = Xd.angular;
        const Force<T> gained{w.cross(v) * seen.mass(), h.cross(w.cross(v))};
        at.equal("written out", moving.force(),
                 moving.M() * a.vector() + moving.printedBias() + gained.vector());
      }));
}

Trials linearInMass() {
  return Trials("linear_in_mass").printed(exact([](Point& at) {
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
      x = jet<T>(x.value.value, T(2) * x.value.derivative, T(4) * x.derivative.derivative);
    };
    for (int i = 0; i < 9; ++i) faster(fast.R(i));
    for (int i = 0; i < 3; ++i) faster(fast.p(i));
    at.equal("twice as fast", Moving<T>{fast, one.body}.force(), one.force() * T(4));
  }));
}

/// m, r_c and I_c of a link.
struct AboutCenter {
  explicit AboutCenter(const RigidInertia<double>& M) : mass(M.mass), r_c(M.h / M.mass) {
    I_c = M.I.matrix() + Matrix3<double>(skew<double>(r_c) * skew<double>(r_c)) * mass;
  }
  double mass;
  Vector3<double> r_c;
  Matrix3<double> I_c;
};
/// Link 2 of the PUMA 560 in its own axes at its centre of mass, where they are principal.
AboutCenter heavyLink() {
  return AboutCenter(OnTheBoard("puma_560").model.links[1].M);
}
Rows balancedRows() {
  const Matrix3<double> I = heavyLink().I_c;
  Rows rows;
  for (int i = 0; i < 3; ++i) {
    const Vector3<double> w = Vector3<double>::Unit(i), moment = w.cross(Vector3<double>(I * w));
    rows.push_back({std::string(1, "xyz"[i]), onBoard(I(i, i)), "not 0", onBoard(moment.norm())});
  }
  return rows;
}
Rows centripetalRows() {
  const OnTheBoard arm("double_pendulum");
  const Motion<double> turning{Vector3<double>::Zero(), Vector3<double>::UnitZ()};
  const double along = biasForce(arm.model.links[0].M, turning).force.x();
  return {{"along the rod", onBoard(-along), onBoard(along)}};
}
Rows diagonalRows() {
  const AboutCenter link = heavyLink();
  const Matrix6<double> M = massMatrix6<double>(link.mass, Vector3<double>::Zero(), link.I_c);
  const Matrix6<double> off = M - Matrix6<double>(M.diagonal().asDiagonal());
  return {{"largest entry off the diagonal", "not 0", onBoard(off.cwiseAbs().maxCoeff())},
          {"`I_xx`, `I_yy`, `I_zz` [kg m^2]", "all equal",
           onBoard(M(3, 3)) + ", " + onBoard(M(4, 4)) + ", " + onBoard(M(5, 5))}};
}
Rows allNotZero(const SixNames& names, const Vector6<double>& so) {
  Rows rows;
  for (int i = 0; i < 6; ++i) rows.push_back({names[i], "not 0", onBoard(so(i))});
  return rows;
}
Rows pushedRows() {
  const AboutCenter link = heavyLink();
  const Matrix6<double> M = massMatrix6<double>(link.mass, Vector3<double>::Zero(), link.I_c);
  return allNotZero(kAccelerationNames, Vector6<double>(M.inverse().col(0)));
}
Rows acceleratedRows() {
  const OnTheBoard arm("puma_560");
  const Motion<double> x{Vector3<double>::UnitX(), Vector3<double>::Zero()};
  return allNotZero(kForceNames, (arm.model.links[1].M * x).vector());
}

Trials biasVanishes() {
  return Trials("bias_vanishes")
      .printed(exact([](Point& at) {
        // a top that spins about its own axis: the premise F_b = 0 is part of the comparison
        const Matrix3<T> I = diagonal3<T>(at.number(), at.number(), at.number());
        const Vector3<T> w(T(0), T(0), at.number()), h(T(0), T(0), at.number());
        at.zero("F_b", Force<T>{w.cross(w.cross(h)), w.cross(Vector3<T>(I * w))}.vector());
        at.equal("I_xx and I_yy", I(0, 0), I(1, 1));
        at.zero("r_c", h);
      }))
      .corrected(both(
          exact([](Point& at) {
            // I = any with the eigenvector w: k w w' + what annihilates w
            const Vector3<T> w = at.vector();
            const Matrix3<T> w_hat = skew<T>(w);
            const Matrix3<T> S = at.template symmetric<3>();
            const Matrix3<T> I = w * w.transpose() * at.number() - Matrix3<T>(w_hat * S * w_hat);
            const Vector3<T> h = w * at.number();
            at.zero("F_b", Force<T>{w.cross(w.cross(h)), w.cross(Vector3<T>(I * w))}.vector());
          }),
          differs([](Point& at) {
            const Vector3<T> w = at.vector();
            const Matrix3<T> I = at.template symmetric<3>();
            at.zero("w x I w of any other w", Vector3<T>(w.cross(Vector3<T>(I * w))));
          })))
      .numbers(balancedRows);
}

Trials centripetal() {
  return Trials("centripetal")
      .printed(certified([](RealPoint& at) {
        const Vector3<Ball> w = at.vector(), h = at.vector();
        const Vector3<Ball> r = h - w * (w.dot(h) / w.dot(w));
        at.positive("F_b . r", w.cross(w.cross(h)).dot(r));
      }))
      .corrected(certified([](RealPoint& at) {
        const Vector3<Ball> w = at.vector(), h = at.vector();
        const Vector3<Ball> r = h - w * (w.dot(h) / w.dot(w));
        at.positive("-F_b . r", -w.cross(w.cross(h)).dot(r));
      }))
      .numbers(centripetalRows);
}

Trials eq16() {
  return Trials("eq16")
      .printed(exact([](Point& at) {
        const auto body = anyBody(at);
        const Vector3<T> r_c = body.center();
        const Matrix3<T> hat = skew<T>(r_c), I_c = body.inertiaAbout(r_c);
        const Matrix3<T> I = body.inertiaAbout(Vector3<T>::Zero());
        at.equal("I", I, I_c - Matrix3<T>(hat * hat) * body.mass());
      }))
      .ours(exact([](Point& at) {
        const auto body = anyBody(at);
        const Vector3<T> r_c = body.center();
        const auto I_c = Symmetric3<T>::fromUpper(body.inertiaAbout(r_c));
        at.equal("our code: I", body.inertiaAbout(Vector3<T>::Zero()),
                 RigidInertia<T>::aboutCenterOfMass(body.mass(), r_c, I_c).I.matrix());
      }));
}

void aboutCenter(Point& at, Start start, bool with_bias) {
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
  if (with_bias) {
    const RigidInertia<T> M = RigidInertia<T>::aboutCenterOfMass(
        moving.body.mass(), Vector3<T>::Zero(), Symmetric3<T>::fromUpper(I));
    const Motion<T> turning{Vector3<T>::Zero(), w};
    at.equal("our code: moment", F.moment,
             Vector3<T>((M * Motion<T>{Vector3<T>::Zero(), path.alpha()}).moment +
                        biasForce(M, turning).moment));
  }
}

Rows gyroscopicMomentRows() {
  const OnTheBoard arm("puma_560");
  const AboutCenter link(arm.model.links[1].M);
  const Vector3<double> w(1, 1, 1), moment = w.cross(Vector3<double>(link.I_c * w));
  Rows rows;
  for (int i = 0; i < 3; ++i) rows.push_back({std::string(1, "xyz"[i]), "0", onBoard(moment(i))});
  return rows;
}
Rows shiftedInertiaRows() {
  const OnTheBoard arm("double_pendulum");
  const RigidInertia<double>& M = arm.model.links[0].M;
  const Matrix3<double> I_c = AboutCenter(M).I_c, I = M.I.matrix();
  Rows rows;
  for (int i = 0; i < 3; ++i)
    if (onBoard(I(i, i)) != "0")
      rows.push_back(
          {std::string(2, "xyz"[i]), onBoard(I_c(i, i)), onBoard(I_c(i, i)), onBoard(I(i, i))});
  return rows;
}

Trials eq17() {
  return Trials("eq17")
      .printed(exact([](Point& at) { aboutCenter(at, Start::kMoving, false); }))
      .condition(exact([](Point& at) { aboutCenter(at, Start::kNotTurning, false); }))
      .corrected(exact([](Point& at) { aboutCenter(at, Start::kMoving, true); }))
      .numbers(gyroscopicMomentRows);
}

/// Momentum about the origin of the point masses, and twice their kinetic energy, at a velocity.
std::pair<Force<T>, T> momentumOf(const PointMasses<T>& body, const Motion<T>& x) {
  Force<T> momentum = Force<T>::zero();
  T twice_energy = T(0);
  for (std::size_t k = 0; k < body.m.size(); ++k) {
    const Vector3<T> v = x.linear + x.angular.cross(body.r[k]);
    const Vector3<T> p = v * body.m[k];
    momentum = momentum + Force<T>{p, body.r[k].cross(p)};
    twice_energy += v.dot(p);
  }
  return {momentum, twice_energy};
}

Trials eq18() {
  return Trials("eq18")
      .printed(exact([](Point& at) {
        const auto body = anyBody(at);
        const Motion<T> x = at.motion();
        const auto [momentum, twice_energy] = momentumOf(body, x);
        const Matrix6<T> M = massMatrix6(body);
        at.equal("momentum", momentum.vector(), M * x.vector());
        at.equal("kinetic energy", twice_energy, x.vector().dot(M * x.vector()));
      }))
      .ours(exact([](Point& at) {
        const auto body = anyBody(at);
        const Motion<T> x = at.motion();
        at.equal("our code: momentum", momentumOf(body, x).first, body.inertia() * x);
      }));
}

Trials symmetricMass() {
  return Trials("symmetric_mass").printed(exact([](Point& at) {
    const auto body = anyBody(at).seenFrom(at.rotation(), at.vector());
    const Matrix6<T> M = massMatrix6(body);
    at.equal("M", M, M.transpose());
    const Transform<T> X = at.transform();
    const Matrix6<T> M_1 = X.inverse().forceMatrix() * M * X.motionMatrix();
    at.equal("carried elsewhere", M_1, M_1.transpose());
  }));
}

Trials diagonalMass() {
  return Trials("diagonal_mass")
      .printed(exact([](Point& at) {
        // a brick: masses at the corners of a box, seen from its middle along its edges
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
      .corrected(exact([](Point& at) {
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
        at.zero("a cube in any axes",
                offDiagonal<T>(massMatrix6(cube.seenFrom(at.rotation(), Vector3<T>::Zero()))));
      }))
      .numbers(diagonalRows);
}

Trials couplingForce() {
  return Trials("coupling_force")
      .printed(certified([](RealPoint& at) {
        // seen from the centre of mass, in axes that are not principal
        Matrix3<Ball> I = diagonal3<Ball>(2, 3, 4);
        I(0, 1) = I(1, 0) = at.number(0.1, 1);
        I(0, 2) = I(2, 0) = at.number(0.1, 1);
        I(1, 2) = I(2, 1) = at.number(0.1, 1);
        const Matrix6<Ball> M = massMatrix6<Ball>(at.number(1, 2), Vector3<Ball>::Zero(), I);
        VectorX<Ball> e = VectorX<Ball>::Constant(6, Ball(0));
        e(0) = Ball(1);
        const VectorX<Ball> acceleration = solveDense<Ball>(M, e);
        for (int i = 0; i < 6; ++i)
          at.positive("squared component", acceleration(i) * acceleration(i));
      }))
      .corrected(exact([](Point& at) {
        const T m = at.number();
        const Matrix3<T> I = at.template symmetric<3>();
        const Matrix6<T> M_inverse = inverse6<T>(massMatrix6<T>(m, Vector3<T>::Zero(), I));
        at.equal("force to acceleration", M_inverse.template block<3, 3>(0, 0) * m,
                 Matrix3<T>::Identity());
        at.zero("force to turning", Matrix3<T>(M_inverse.template block<3, 3>(3, 0)));
        at.zero("moment to acceleration", Matrix3<T>(M_inverse.template block<3, 3>(0, 3)));
      }))
      .numbers(pushedRows);
}

Trials couplingAcceleration() {
  return Trials("coupling_acceleration")
      .printed(certified([](RealPoint& at) {
        const Vector3<Ball> h = at.vector(0.1, 1);
        Matrix3<Ball> I = diagonal3<Ball>(2, 3, 4);
        I(0, 1) = I(1, 0) = at.number(0.1, 1);
        const Matrix6<Ball> M = massMatrix6<Ball>(at.number(1, 2), h, I);
        for (int i = 0; i < 6; ++i) at.positive("squared entry of M e_1", M(i, 0) * M(i, 0));
      }))
      .corrected(exact([](Point& at) {
        const Matrix6<T> M = massMatrix6(anyBody(at));
        for (int i = 0; i < 3; ++i) {
          at.zero("other forces",
                  VectorX<T>((VectorX<T>(2) << M((i + 1) % 3, i), M((i + 2) % 3, i)).finished()));
          at.zero("moment about the same axis", M(3 + i, i));
          at.zero("force along the axis of turning", M(i, 3 + i));
        }
      }))
      .numbers(acceleratedRows);
}

void rotated(Point& at, bool same_origin) {
  const auto in_2 = anyBody(at);
  const Matrix3<T> R = at.rotation();
  const Vector3<T> r_12 = same_origin ? Vector3<T>(Vector3<T>::Zero()) : at.vector();
  const auto in_1 = in_2.seenFrom(R, r_12);
  const Vector3<T> origin = Vector3<T>::Zero();
  const Transform<T> X_21{R.transpose(), r_12};
  const Matrix6<T> T_F = X_21.inverse().forceMatrix();
  at.equal("I_1", in_1.inertiaAbout(origin), R * in_2.inertiaAbout(origin) * R.transpose());
  at.equal("M_1", massMatrix6(in_1), T_F * massMatrix6(in_2) * T_F.transpose());
}

Trials eq19() {
  return Trials("eq19")
      .printed(exact([](Point& at) { rotated(at, false); }))
      .condition(exact([](Point& at) { rotated(at, true); }))
      .corrected(exact([](Point& at) {
        const auto in_2 = anyBody(at);
        const Matrix3<T> R = at.rotation();
        const Vector3<T> r = at.vector(), h = R * in_2.firstMoment();
        const auto in_1 = in_2.seenFrom(R, r);
        const Vector3<T> origin = Vector3<T>::Zero(), h_1 = h + r * in_2.mass();
        at.equal("I_1", in_1.inertiaAbout(origin),
                 R * in_2.inertiaAbout(origin) * R.transpose() -
                     Matrix3<T>(skew<T>(r) * skew<T>(h)) - Matrix3<T>(skew<T>(h_1) * skew<T>(r)));
        const Transform<T> X_21{R.transpose(), r};
        const Matrix6<T> T_F = X_21.inverse().forceMatrix();
        at.equal("M_1", massMatrix6(in_1), T_F * massMatrix6(in_2) * T_F.transpose());
        at.equal("our code", massMatrix6(in_1),
                 recursive::ArticulatedInertia<T>::fromRigid(X_21.inverseTimes(in_2.inertia()))
                     .matrix());
      }))
      .numbers(shiftedInertiaRows);
}

Trials tenParameters() {
  return Trials("ten_parameters").printed(exact([](Point& at) {
    // any M of point masses is fixed by ten of its entries
    const Matrix6<T> M = massMatrix6(anyBody(at));
    const Vector3<T> h(M(5, 1), M(3, 2), M(4, 0));
    Matrix3<T> I;
    I << M(3, 3), M(3, 4), M(3, 5), M(3, 4), M(4, 4), M(4, 5), M(3, 5), M(4, 5), M(5, 5);
    at.equal("M", M, massMatrix6<T>(M(0, 0), h, I));
  }));
}

}  // namespace

std::vector<Trials> rigidBody() {
  return {eq15(),          eq15Spatial(),  linearInMass(),  biasVanishes(),
          centripetal(),   eq16(),         eq17(),          eq18(),
          symmetricMass(), diagonalMass(), couplingForce(), couplingAcceleration(),
          eq19(),          tenParameters()};
}

}  // namespace dynwitness::audit
