// SPDX-License-Identifier: GPL-3.0-or-later
// Sections 2 and 5: frames, and how forces, velocities and accelerations are carried between them.
#include "crosscheck/audit/board.hpp"
#include "crosscheck/audit/ours.hpp"
#include "crosscheck/audit/truths.hpp"
#include "recursive/newton_euler.hpp"

namespace dynwitness::audit {
namespace {

/// Forces at places of space: a force system without any formula for its moment.
template <typename T>
struct ForceSystem {
  std::vector<Vector3<T>> places, forces;

  Force<T> about(const Vector3<T>& point) const {
    Force<T> sum = Force<T>::zero();
    for (std::size_t k = 0; k < places.size(); ++k)
      sum = sum + Force<T>{forces[k], (places[k] - point).cross(forces[k])};
    return sum;
  }
};

ForceSystem<T> anyForces(Point& at) {
  ForceSystem<T> system;
  for (int k = 0; k < 3; ++k) {
    system.places.push_back(at.vector());
    system.forces.push_back(at.vector());
  }
  return system;
}

/// Frames 1 and 2 in the world: R takes their coordinates to the world's, p are their origins.
template <typename T>
struct TwoFrames {
  Matrix3<T> R_1, R_2;
  Vector3<T> p_1, p_2;

  Matrix3<T> R_12() const { return R_1.transpose() * R_2; }          ///< coordinates in 2 to 1
  Vector3<T> r_12() const { return R_1.transpose() * (p_2 - p_1); }  ///< from 1 to 2, in 1
  Vector6<T> in_1(const Force<T>& f) const {
    return Force<T>{R_1.transpose() * f.force, R_1.transpose() * f.moment}.vector();
  }
  Vector6<T> in_2(const Force<T>& f) const {
    return Force<T>{R_2.transpose() * f.force, R_2.transpose() * f.moment}.vector();
  }
  Vector6<T> in_1(const Motion<T>& x) const {
    return Motion<T>{R_1.transpose() * x.linear, R_1.transpose() * x.angular}.vector();
  }
  Vector6<T> in_2(const Motion<T>& x) const {
    return Motion<T>{R_2.transpose() * x.linear, R_2.transpose() * x.angular}.vector();
  }
};

TwoFrames<T> anyFrames(Point& at) {
  const auto R_1 = at.rotation(), R_2 = at.rotation();
  const auto p_1 = at.vector(), p_2 = at.vector();
  return {R_1, R_2, p_1, p_2};
}

template <typename T>
Matrix6<T> blocks(const Matrix3<T>& a, const Matrix3<T>& b, const Matrix3<T>& c,
                  const Matrix3<T>& d) {
  Matrix6<T> m;
  m << a, b, c, d;
  return m;
}
template <typename T>
Matrix3<T> one() {
  return Matrix3<T>::Identity();
}
template <typename T>
Matrix3<T> none() {
  return Matrix3<T>::Zero();
}

// ---- forces ------------------------------------------------------------------------------------

Trials eq1() {
  return Trials("eq1")
      .printed(exact([](Point& at) {
        const auto system = anyForces(at);
        const Vector3<T> p_1 = at.vector(), p_2 = at.vector(), r_12 = p_2 - p_1;
        const Force<T> F_1 = system.about(p_1), F_2 = system.about(p_2);
        at.equal("force", F_1.force, F_2.force);
        at.equal("moment", F_1.moment, F_2.moment + r_12.cross(F_2.force));
      }))
      .ours(ourTransformations());
}

Trials eq2() {
  return Trials("eq2").printed(exact([](Point& at) {
    // forces on points of a moving body; each works at its own point's velocity
    const Path<T> path = anyPath(at);
    T power = T(0);
    Force<T> F = Force<T>::zero();
    for (int k = 0; k < 2; ++k) {
      const Vector3<Jet<T>> x = path.place(at.vector());
      const Vector3<T> f = at.vector();
      power += f.dot(rate<T, 3, 1>(x));
      F = F + Force<T>{f, (now<T, 3, 1>(x) - path.origin()).cross(f)};
    }
    at.equal("power", F.vector().dot(path.velocity().vector()), power);
  }));
}

Trials eq3() {
  return Trials("eq3")
      .printed(exact([](Point& at) {
        const auto system = anyForces(at);
        const Vector3<T> p_1 = at.vector(), p_2 = at.vector(), r_12 = p_2 - p_1;
        const Matrix6<T> T_F = blocks<T>(one<T>(), none<T>(), skew<T>(r_12), one<T>());
        at.equal("F_1", system.about(p_1).vector(), T_F * system.about(p_2).vector());
      }))
      .ours(ourTransformations());
}

Trials eq4() {
  return Trials("eq4")
      .printed(exact([](Point& at) {
        const Vector3<T> r = at.vector(), x = at.vector();
        Matrix3<T> hat;
        hat << T(0), -r.z(), r.y(), r.z(), T(0), -r.x(), -r.y(), r.x(), T(0);
        at.equal("hat(r) x", Vector3<T>(hat * x), r.cross(x));
      }))
      .ours(exact([](Point& at) {
        const Vector3<T> r = at.vector(), x = at.vector();
        at.equal("our code: hat(r) x", Vector3<T>(skew<T>(r) * x), r.cross(x));
      }));
}

Trials eq5() {
  return Trials("eq5")
      .printed(exact([](Point& at) {
        const Vector3<T> p_1 = at.vector(), p_2 = at.vector(), r_12 = p_2 - p_1;
        const Vector3<T> r_21 = p_1 - p_2;
        const Matrix6<T> T_F = blocks<T>(one<T>(), none<T>(), skew<T>(r_12), one<T>());
        const Matrix6<T> back = blocks<T>(one<T>(), none<T>(), -skew<T>(r_12), one<T>());
        at.equal("product", T_F * back, Matrix6<T>::Identity());
        at.equal("second form", back, blocks<T>(one<T>(), none<T>(), skew<T>(r_21), one<T>()));
      }))
      .ours(ourTransformations());
}

/// Matrices of each symmetry from one lever: `[1, 0; A, 1] [1, 0; -A, 1]`, computed.
Rows inverseRows() {
  const Matrix3<double> hat = skew<double>(OnTheBoard("double_pendulum").model.links[1].X_tree.p),
                        zero = none<double>();
  const auto row = [&](const char* name, const Matrix3<double>& A) {
    const Matrix6<double> product = blocks<double>(one<double>(), zero, A, one<double>()) *
                                    blocks<double>(one<double>(), zero, -A, one<double>());
    const double off = (product - Matrix6<double>::Identity()).cwiseAbs().maxCoeff();
    const bool is_antisymmetric = A.transpose() == -A;
    return std::vector<std::string>{name, onBoard(A(1, 2)), onBoard(A(2, 1)),
                                    is_antisymmetric ? "`1`" : "not `1`",
                                    off == 0 ? "`1`" : "`1` but for " + onBoard(off)};
  };
  return {row("`hat(r_12)`, antisymmetric", hat), row("its magnitudes, symmetric", hat.cwiseAbs()),
          row("its lower half, neither", hat.triangularView<Eigen::StrictlyLower>())};
}

Trials inverseReason() {
  return Trials("inverse_reason")
      .printed(differs([](Point& at) {
        const Matrix3<T> A = at.template matrix<3, 3>();
        at.equal("product",
                 blocks<T>(one<T>(), none<T>(), A, one<T>()) *
                     blocks<T>(one<T>(), none<T>(), -A, one<T>()),
                 Matrix6<T>::Identity());
      }))
      .corrected(exact([](Point& at) {
        const Matrix3<T> A = at.template matrix<3, 3>();
        const Matrix6<T> N = blocks<T>(none<T>(), none<T>(), A, none<T>());
        at.zero("square", Matrix6<T>(N * N));
        at.equal("product", (Matrix6<T>::Identity() + N) * (Matrix6<T>::Identity() - N),
                 Matrix6<T>::Identity());
      }))
      .numbers(inverseRows);
}

Trials eq6() {
  return Trials("eq6")
      .printed(exact([](Point& at) {
        const auto system = anyForces(at);
        const auto frames = anyFrames(at);
        const Matrix3<T> R = frames.R_12();
        const Matrix6<T> T_F = blocks<T>(R, none<T>(), skew<T>(frames.r_12()) * R, R);
        at.equal("F_1", frames.in_1(system.about(frames.p_1)),
                 T_F * frames.in_2(system.about(frames.p_2)));
      }))
      .ours(ourTransformations());
}

Trials eq7() {
  return Trials("eq7")
      .printed(exact([](Point& at) {
        const auto system = anyForces(at);
        const auto frames = anyFrames(at);
        const Matrix3<T> R_T = frames.R_12().transpose();
        const Matrix6<T> T_F = blocks<T>(R_T, none<T>(), -(R_T * skew<T>(frames.r_12())), R_T);
        at.equal("F_2", frames.in_2(system.about(frames.p_2)),
                 T_F * frames.in_1(system.about(frames.p_1)));
      }))
      .ours(ourTransformations());
}

Trials momentumTransformation() {
  return Trials("momentum_transformation").printed(exact([](Point& at) {
    // momenta m v of points, as vectors at places, and the linear ones of their mass
    const Path<T> path = anyPath(at);
    const auto body = anyBody(at);
    const auto frames = anyFrames(at);
    ForceSystem<T> momenta;
    for (std::size_t k = 0; k < body.m.size(); ++k) {
      const Vector3<Jet<T>> x = path.place(body.r[k]);
      momenta.places.push_back(now<T, 3, 1>(x));
      momenta.forces.push_back(rate<T, 3, 1>(x) * body.m[k]);
    }
    const Matrix3<T> R = frames.R_12();
    const Matrix6<T> T_F = blocks<T>(R, none<T>(), skew<T>(frames.r_12()) * R, R);
    at.equal("momentum", frames.in_1(momenta.about(frames.p_1)),
             T_F * frames.in_2(momenta.about(frames.p_2)));
  }));
}

// ---- motions -----------------------------------------------------------------------------------

Trials eq8() {
  return Trials("eq8")
      .printed(exact([](Point& at) {
        const Path<T> path = anyPath(at);
        const Vector3<Jet<T>> x_1 = path.place(at.vector()), x_2 = path.place(at.vector());
        const Vector3<T> r_12 = now<T, 3, 1>(x_2) - now<T, 3, 1>(x_1), w = path.omega();
        at.equal("v_1", rate<T, 3, 1>(x_1), rate<T, 3, 1>(x_2) + r_12.cross(w));
      }))
      .ours(ourTransformations());
}

Trials eq9() {
  return Trials("eq9").printed(exact([](Point& at) {
    const Path<T> path = anyPath(at);
    const Vector3<Jet<T>> x_i = path.place(at.vector()), x = path.place(at.vector());
    at.equal("velocity of another point", rate<T, 3, 1>(x),
             rate<T, 3, 1>(x_i) + path.omega().cross(now<T, 3, 1>(x) - now<T, 3, 1>(x_i)));
  }));
}

void velocityBlocks(Point& at, bool turned) {
  const Path<T> path = anyPath(at);
  auto frames = anyFrames(at);
  if (!turned) frames.R_1 = frames.R_2 = one<T>();
  const Vector3<T> w = path.omega(), v = path.velocity().linear, o = path.origin();
  const Vector6<T> x_1 = frames.in_1(Motion<T>{v + w.cross(frames.p_1 - o), w});
  const Vector6<T> x_2 = frames.in_2(Motion<T>{v + w.cross(frames.p_2 - o), w});
  const Matrix3<T> R = frames.R_12();
  const Matrix6<T> T_V = blocks<T>(R, skew<T>(frames.r_12()) * R, none<T>(), R);
  at.equal(turned ? "link frames" : "parallel axes", x_1, T_V * x_2);
}

Trials eq10() {
  return Trials("eq10")
      .printed(exact([](Point& at) {
        // a linear map of velocities: that of a sum of motions is the sum of theirs
        const auto frames = anyFrames(at);
        const auto seen = [&](const Vector6<T>& motion_in_2) {
          // a body with this velocity at frame 2, at frame 1's origin and in its axes
          const Vector3<T> v = frames.R_2 * Vector3<T>(motion_in_2.template head<3>()),
                           w = frames.R_2 * Vector3<T>(motion_in_2.template tail<3>());
          return frames.in_1(Motion<T>{v + w.cross(frames.p_1 - frames.p_2), w});
        };
        const Vector6<T> x = at.vector6(), y = at.vector6();
        const T s = at.number();
        at.equal("Xd_1", seen(Vector6<T>(x + y * s)), seen(x) + seen(y) * s);
      }))
      .ours(ourTransformations());
}

Trials eq11() {
  return Trials("eq11")
      .printed(exact([](Point& at) {
        velocityBlocks(at, false);
        velocityBlocks(at, true);
      }))
      .ours(ourTransformations());
}

Trials eq12() {
  return Trials("eq12")
      .printed(exact([](Point& at) {
        const Matrix3<T> R = at.rotation();
        const Vector3<T> r = at.vector();
        const Matrix6<T> T_V = blocks<T>(R, skew<T>(r) * R, none<T>(), R);
        const Matrix6<T> back =
            blocks<T>(R.transpose(), -(R.transpose() * skew<T>(r)), none<T>(), R.transpose());
        at.equal("product", T_V * back, Matrix6<T>::Identity());
      }))
      .ours(ourTransformations());
}

/// T_F_12 and T_V_12 of (6) and (11).
template <typename T>
struct Transformations {
  explicit Transformations(const TwoFrames<T>& frames)
      : F(blocks<T>(frames.R_12(), none<T>(), skew<T>(frames.r_12()) * frames.R_12(),
                    frames.R_12())),
        V(blocks<T>(frames.R_12(), skew<T>(frames.r_12()) * frames.R_12(), none<T>(),
                    frames.R_12())) {}
  Matrix6<T> F, V;
};

Trials eq13() {
  return Trials("eq13")
      .printed(exact([](Point& at) {
        const auto frames = anyFrames(at);
        const Transformations<T> T_12(frames),
            T_21(TwoFrames<T>{frames.R_2, frames.R_1, frames.p_2, frames.p_1});
        at.equal("T_F_21", T_21.F, T_12.V.transpose());
        at.equal("T_V_21", T_21.V, T_12.F.transpose());
        // what it rests on: power does not depend on the frame
        const Vector6<T> F_2 = at.vector6(), x_2 = at.vector6();
        at.equal("power", T((T_12.V * x_2).dot(T_12.F * F_2)), T(x_2.dot(F_2)));
      }))
      .ours(ourTransformations());
}

Trials velocityOrder() {
  return Trials("velocity_order").printed(exact([](Point& at) {
    const Transformations<T> T_12(anyFrames(at));
    const Vector6<T> x = at.vector6(), y = T_12.V * x;
    const auto angularFirst = [](const Vector6<T>& v) {
      Vector6<T> out;
      out << v.template tail<3>(), v.template head<3>();
      return out;
    };
    at.equal("(w, v)", angularFirst(y), T_12.F * angularFirst(x));
  }));
}

void accelerations(Point& at, const Path<T>& path) {
  const Vector3<Jet<T>> x_1 = path.place(at.vector()), x_2 = path.place(at.vector());
  const Vector3<T> r_12 = now<T, 3, 1>(x_2) - now<T, 3, 1>(x_1);
  at.equal("vd_1", secondRate<T, 3, 1>(x_1), secondRate<T, 3, 1>(x_2) + r_12.cross(path.alpha()));
}

Trials eq14() {
  return Trials("eq14")
      .printed(exact([](Point& at) { accelerations(at, anyPath(at)); }))
      .condition(exact([](Point& at) { accelerations(at, anyPath(at, Start::kNotTurning)); }))
      .corrected(exact([](Point& at) {
        const Path<T> path = anyPath(at);
        const Vector3<Jet<T>> x_1 = path.place(at.vector()), x_2 = path.place(at.vector());
        const Vector3<T> r_12 = now<T, 3, 1>(x_2) - now<T, 3, 1>(x_1);
        const Vector3<T> w = path.omega(), wd = path.alpha();
        const Vector3<T> vd_1 = secondRate<T, 3, 1>(x_1), vd_2 = secondRate<T, 3, 1>(x_2);
        at.equal("vd_1", vd_1, vd_2 + r_12.cross(wd) - w.cross(w.cross(r_12)));
        const Motion<T> a_1{vd_1 - w.cross(rate<T, 3, 1>(x_1)), wd};
        const Motion<T> a_2{vd_2 - w.cross(rate<T, 3, 1>(x_2)), wd};
        at.equal("our code: spatial", a_1, Transform<T>{one<T>(), -r_12} * a_2);
      }))
      .numbers([] {
        OnTheBoard arm("double_pendulum");
        arm.qd = {1, 0};
        recursive::inverseDynamics(arm.model, arm.x, arm.qd, std::vector<double>{0, 0}, arm.ws,
                                   arm.tau, recursive::Terms::none());
        // the elbow moves with either rod: from the lower one, turned into the axes of the upper
        // one
        const Motion<double>&v = arm.ws.v[1], &a = arm.ws.a[1];
        const Matrix3<double> R = arm.ws.X_up[1].R.transpose();
        const Vector3<double> vd_2 = R * (a.linear + v.angular.cross(v.linear)), wd = R * a.angular,
                              r_12 = arm.ws.X_up[1].p, printed = vd_2 + r_12.cross(wd);
        Rows rows;
        for (int i = 0; i < 3; ++i)
          rows.push_back({std::string(1, "xyz"[i]), onBoard(vd_2(i)), onBoard(printed(i)),
                          onBoard(arm.ws.a[0].linear(i))});
        return rows;
      });
}

Trials notADerivative() {
  return Trials("not_a_derivative").printed(differs([](Point& at) {
    // w_a: the angular velocity when coordinate a alone moves at rate 1. Were w dt = dx, d_1 w_2
    // would be d_1 d_2 x = d_2 w_1, in every choice of coordinates.
    const T w = at.number();
    const Vector3<T> u = at.vector();
    const auto R_along = [&](int a, int b) {
      // along a by the inner dual, b by the outer
      Vector3<Jet<T>> moved = still<T, 3, 1>(u);
      moved(a).value.derivative = T(1);
      moved(b).derivative.value += T(1);
      return Point::rotationOf<Jet<T>>(constantJet(w), moved);
    };
    const auto d_b_of_w_a = [&](int a, int b) {
      const Matrix3<Jet<T>> R = R_along(a, b);
      Matrix3<T> R_0, R_a, R_b, R_ab;
      for (int i = 0; i < 9; ++i) {
        R_0(i) = R(i).value.value;
        R_a(i) = R(i).value.derivative;
        R_b(i) = R(i).derivative.value;
        R_ab(i) = R(i).derivative.derivative;
      }
      const Matrix3<T> rate_of_hat = R_ab * R_0.transpose() + R_a * R_b.transpose();
      return Vector3<T>(rate_of_hat(2, 1), rate_of_hat(0, 2), rate_of_hat(1, 0));
    };
    at.equal("d_1 w_2 and d_2 w_1", d_b_of_w_a(1, 0), d_b_of_w_a(0, 1));
  }));
}

}  // namespace

std::vector<Trials> frames() {
  return {eq1(),           eq2(),  eq3(),
          eq4(),           eq5(),  inverseReason(),
          eq6(),           eq7(),  momentumTransformation(),
          eq8(),           eq9(),  eq10(),
          eq11(),          eq12(), eq13(),
          velocityOrder(), eq14(), notADerivative()};
}

}  // namespace dynwitness::audit
