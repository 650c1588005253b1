// SPDX-License-Identifier: GPL-3.0-or-later
// Sections 15 and 16: Hamilton's principle, Lagrange's equations, and what they share with
// Newton's.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "crosscheck/audit/board.hpp"
#include "crosscheck/audit/lifted.hpp"
#include "recursive/energy.hpp"

namespace dynwitness::audit {
namespace {

// ---- paths and actions as polynomials in time ---------------------------------------------------

/// A polynomial in time; its coefficients may be duals.
template <typename T>
struct Poly {
  std::vector<T> c;  ///< c[0] + c[1] t + ...

  Poly(const T& constant = T(0)) : c{constant} {}  // NOLINT(google-explicit-constructor)
  explicit Poly(int constant) : c{T(constant)} {}
  explicit Poly(std::vector<T> coefficients) : c(std::move(coefficients)) {}
  static Poly time() { return Poly(std::vector<T>{T(0), T(1)}); }

  friend Poly operator+(const Poly& a, const Poly& b) { return combined(a, b, T(1)); }
  friend Poly operator-(const Poly& a, const Poly& b) { return combined(a, b, T(-1)); }
  friend Poly operator*(const Poly& a, const Poly& b) {
    std::vector<T> c(a.c.size() + b.c.size() - 1, T(0));
    for (std::size_t i = 0; i < a.c.size(); ++i)
      for (std::size_t j = 0; j < b.c.size(); ++j) c[i + j] += a.c[i] * b.c[j];
    return Poly(c);
  }
  Poly operator-() const { return Poly() - *this; }
  Poly& operator+=(const Poly& b) { return *this = *this + b; }

  Poly derivative() const {
    std::vector<T> d(1, T(0));
    for (std::size_t i = 1; i < c.size(); ++i) {
      d.resize(i, T(0));
      d[i - 1] = c[i] * T(static_cast<int>(i));
    }
    return Poly(d);
  }
  T at(const T& t) const {
    T value = T(0);
    for (std::size_t i = c.size(); i-- > 0;) value = value * t + c[i];
    return value;
  }
  T integral(const T& from, const T& to) const {
    std::vector<T> primitive(1, T(0));
    for (std::size_t i = 0; i < c.size(); ++i)
      primitive.push_back(c[i] / T(static_cast<int>(i + 1)));
    return Poly(primitive).at(to) - Poly(primitive).at(from);
  }

 private:
  static Poly combined(const Poly& a, const Poly& b, const T& factor) {
    std::vector<T> c(std::max(a.c.size(), b.c.size()), T(0));
    for (std::size_t i = 0; i < a.c.size(); ++i) c[i] += a.c[i];
    for (std::size_t i = 0; i < b.c.size(); ++i) c[i] += b.c[i] * factor;
    return Poly(c);
  }
};

/// Polynomials whose coefficients are duals, from polynomials.
template <typename T>
Poly<Dual<T>> lift(const Poly<T>& p) {
  std::vector<Dual<T>> c;
  for (const T& x : p.c) c.push_back(Dual<T>(x));
  return Poly<Dual<T>>(c);
}

Poly<T> anyPoly(Point& at, int degree) {
  std::vector<T> c;
  for (int i = 0; i <= degree; ++i) c.push_back(at.number());
  return Poly<T>(c);
}
/// Any polynomial that vanishes at both instants.
Poly<T> anyVariation(Point& at, const T& t1, const T& t2) {
  const Poly<T> t = Poly<T>::time();
  return (t - Poly<T>(t1)) * (t - Poly<T>(t2)) * anyPoly(at, 1);
}

/// A Lagrangian of two coordinates whose kinetic energy depends on the place and that has every
/// kind of term: what the derivation of the equations must cope with.
template <typename T>
struct Lagrangian {
  T a, b, c, d, e;

  template <typename S>
  S operator()(const std::vector<S>& q, const std::vector<S>& v) const {
    const auto k = [](const T& x) { return S(x); };
    return k(a) * v[0] * v[0] + (k(b) + q[0] * q[0]) * v[1] * v[1] + k(c) * q[1] * v[0] * v[1] +
           k(d) * q[0] * v[1] - k(e) * q[0] * q[1] * q[1];
  }
};
Lagrangian<T> anyLagrangian(Point& at) {
  const auto a = at.number(), b = at.number(), c = at.number(), d = at.number();
  return {a, b, c, d, at.number()};
}

/// dL/dq_i or dL/dqd_i along a path, as a function of time.
template <typename T>
Poly<T> partial(const Lagrangian<T>& L, const std::vector<Poly<T>>& q, int i, bool of_rate) {
  using D = Dual<Poly<T>>;
  std::vector<D> x, v;
  for (int j = 0; j < 2; ++j) {
    const Poly<T> seed(T(i == j ? 1 : 0));
    x.push_back(of_rate ? D(q[j]) : D(q[j], seed));
    v.push_back(of_rate ? D(q[j].derivative(), seed) : D(q[j].derivative()));
  }
  const auto lagrangian =
      Lagrangian<Poly<T>>{Poly<T>(L.a), Poly<T>(L.b), Poly<T>(L.c), Poly<T>(L.d), Poly<T>(L.e)};
  return lagrangian(x, v).derivative;
}

template <typename T>
Poly<T> along(const Lagrangian<T>& L, const std::vector<Poly<T>>& q) {
  const Lagrangian<Poly<T>> lagrangian = {Poly<T>(L.a), Poly<T>(L.b), Poly<T>(L.c), Poly<T>(L.d),
                                          Poly<T>(L.e)};
  return lagrangian(q, std::vector<Poly<T>>{q[0].derivative(), q[1].derivative()});
}

/// dPhi/deps_i at a point eps, Phi(eps) the action of q + (eps_1 r_1, eps_2 r_2).
template <typename T>
T actionSlope(const Lagrangian<T>& L, const std::vector<Poly<T>>& q, const std::vector<Poly<T>>& r,
              const std::vector<T>& eps, int i, const T& t1, const T& t2) {
  using D = Dual<T>;
  std::vector<Poly<D>> varied;
  for (int j = 0; j < 2; ++j)
    varied.push_back(lift(q[j]) + Poly<D>(D(eps[j], T(i == j ? 1 : 0))) * lift(r[j]));
  const Lagrangian<D> lagrangian = {D(L.a), D(L.b), D(L.c), D(L.d), D(L.e)};
  return along(lagrangian, varied).integral(D(t1), D(t2)).derivative;
}

/// Everything that a statement about a variation needs.
template <typename T>
struct Varied {
  Lagrangian<T> L;
  T t1, t2;
  std::vector<Poly<T>> q, r;
};
Varied<T> anyVaried(Point& at) {
  const Lagrangian<T> L = anyLagrangian(at);
  const T t1 = at.number(), t2 = at.number();
  const Poly<T> q1 = anyPoly(at, 2), q2 = anyPoly(at, 2);
  const Poly<T> r1 = anyVariation(at, t1, t2), r2 = anyVariation(at, t1, t2);
  return {L, t1, t2, {q1, q2}, {r1, r2}};
}

// ---- Lagrange's equations at one instant --------------------------------------------------------

/// d/dt dL/dqd_i - dL/dq_i of any L(q, qd), by nested duals: inner for the partial derivative,
/// outer for time. Function: called with vectors of Dual<Dual<T>>.
template <typename T, typename Function>
VectorX<T> eulerLagrange(const Function& L, const std::vector<T>& q, const std::vector<T>& qd,
                         const std::vector<T>& qdd) {
  using DD = Dual<Dual<T>>;  // .value: now, .derivative: rate; of each .derivative: the partial
  const int n = static_cast<int>(q.size());
  VectorX<T> out(n);
  for (int i = 0; i < n; ++i) {
    for (const bool of_rate : {true, false}) {
      std::vector<DD> x, v;
      for (int j = 0; j < n; ++j) {
        const T seed = T(i == j ? 1 : 0);
        x.push_back(DD(Dual<T>(q[j], of_rate ? T(0) : seed), Dual<T>(qd[j])));
        v.push_back(DD(Dual<T>(qd[j], of_rate ? seed : T(0)), Dual<T>(qdd[j])));
      }
      const DD value = L(x, v);
      if (of_rate)
        out(i) = value.derivative.derivative;
      else
        out(i) -= value.value.derivative;
    }
  }
  return out;
}

/// The robot over duals of its scalar: what is drawn is constant.
template <typename S, typename T>
Robot<S> robotOver(const Robot<T>& robot) {
  const auto constant = [](const T& x) { return S(Dual<T>(x)); };
  const auto vector = [&](const Vector3<T>& x) {
    return Vector3<S>(constant(x(0)), constant(x(1)), constant(x(2)));
  };
  Robot<S> out;
  out.parent = robot.parent;
  out.kind = robot.kind;
  for (int i = 0; i < robot.n(); ++i) {
    Matrix3<S> R;
    for (int k = 0; k < 9; ++k) R(k) = constant(robot.R[i](k));
    out.R.push_back(R);
    out.r.push_back(vector(robot.r[i]));
    PointMasses<S> body;
    for (const T& m : robot.body[i].m) body.m.push_back(constant(m));
    for (const Vector3<T>& r : robot.body[i].r) body.r.push_back(vector(r));
    out.body.push_back(body);
    out.rotor.push_back(constant(robot.rotor[i]));
  }
  out.gravity = vector(robot.gravity);
  out.base_velocity = Motion<S>::zero();
  return out;
}

/// T + sign V of a robot's point masses and rotors, in q, qd.
template <typename T>
VectorX<T> robotEulerLagrange(const Robot<T>& robot, int sign) {
  using DD = Dual<Dual<T>>;
  Robot<DD> moved = robotOver<DD>(robot);
  std::vector<T> q;
  for (const auto& x : robot.x) q.push_back(x.q);
  const auto L = [&](const std::vector<DD>& q, const std::vector<DD>& qd) {
    moved.x.clear();
    for (int i = 0; i < robot.n(); ++i) {
      // cos and sin of a dual angle at a point of the circle: (c, s) moved by both its small parts
      const Dual<T>& now = q[i].value;
      const T &c = robot.x[i].c, &s = robot.x[i].s;
      const Dual<T> c_now(c, -s * now.derivative), s_now(s, c * now.derivative);
      moved.x.push_back(
          {q[i], {c_now, -s_now * q[i].derivative}, {s_now, c_now * q[i].derivative}});
    }
    const auto [kinetic, potential] = energiesOf(moved, qd);
    return kinetic + potential * DD(sign);
  };
  return eulerLagrange<T>(L, q, robot.qd, robot.qdd);
}

/// m v^2 / 2 - k q^2 / 2 and what W adds to it, against m qdd + k q - Q.
template <typename Work, typename ForceOfRate>
void compareWork(Point& at, const Work& work, const ForceOfRate& force_of_rate) {
  using DD = Dual<Dual<T>>;
  const T m = at.number(), k = at.number(), q = at.number(), qd = at.number(), qdd = at.number();
  const auto L = [&](const std::vector<DD>& x, const std::vector<DD>& v) {
    const auto c = [](const T& value) { return DD(Dual<T>(value)); };
    return (c(m) * v[0] * v[0] - c(k) * x[0] * x[0]) / c(T(2)) + work(x[0], v[0]);
  };
  at.equal("force balance", eulerLagrange<T>(L, {q}, {qd}, {qdd})(0),
           T(m * qdd + k * q - force_of_rate(qd)));
}

/// The first variation of a polynomial path that is made physical by a force F(t), at eps = 0 or
/// with the other eps anywhere.
void compareFirstVariation(Point& at, bool all_zero) {
  const auto v = anyVaried(at);
  std::vector<Poly<T>> F;  // L + F' q is stationary at q:  F = d/dt dL/dqd - dL/dq
  for (int i = 0; i < 2; ++i)
    F.push_back(partial(v.L, v.q, i, true).derivative() - partial(v.L, v.q, i, false));
  T sum = T(0);
  for (int i = 0; i < 2; ++i) {
    std::vector<T> eps = {T(0), T(0)};
    if (!all_zero) eps[1 - i] = at.number();
    const T slope =
        actionSlope<T>(v.L, v.q, v.r, eps, i, v.t1, v.t2) + (F[i] * v.r[i]).integral(v.t1, v.t2);
    sum += at.number() * slope;
  }
  at.zero("first variation", sum);
}

/// A body that turns about a fixed point: moment in its own axes against d/dt dT/dw (+ w x dT/dw).
void compareRotation(Point& at, bool with_gyroscopic_term) {
  Path<T> path = anyPath(at);
  path.p = still<T, 3, 1>(Vector3<T>::Zero());
  const auto body = anyBody(at);
  const Matrix3<T> Rt = path.axes().transpose(), I = body.inertiaAbout(Vector3<T>::Zero());
  // w in body axes, and its rate: that of the components, in which R' (w x w) = 0 drops out
  const Vector3<T> w = Rt * path.omega(), wd = Rt * path.alpha();
  Vector3<T> moment = I * wd;
  if (with_gyroscopic_term) moment += w.cross(Vector3<T>(I * w));
  at.equal("moment", moment, Vector3<T>(Rt * body.force(path, Vector3<T>::Zero()).moment));
}

// ---- second variations of an oscillator ---------------------------------------------------------

/// An oscillator, and a duration.
template <typename T>
struct Oscillator {
  /// What the action of q + r has more than that of any motion q:  integral of (m rd^2 - k r^2) /
  /// 2, exactly, for r = t (duration - t) times a polynomial.
  T excess(const Poly<T>& shape) const {
    const Poly<T> t = Poly<T>::time();
    const Poly<T> r = t * (Poly<T>(duration) - t) * shape, rd = r.derivative();
    return (Poly<T>(m) * rd * rd - Poly<T>(k) * r * r).integral(T(0), duration) / T(2);
  }
  /// 1, and duration - 2 t: one bump and two.
  T slow() const { return excess(Poly<T>(T(1))); }
  T fast() const { return excess(Poly<T>(duration) - Poly<T>(T(2)) * Poly<T>::time()); }

  T m, k, duration;
};
/// Any, over a duration that is `low` to `high` times sqrt(m / k); half a period is pi.
Oscillator<Ball> anyOscillator(RealPoint& at, double low, double high) {
  const Ball m = at.number(0.5, 2), k = at.number(0.5, 2);
  return {m, k, sqrt(m / k) * at.number(low, high)};
}

/// (64): a mass of 1 kg on a spring of 1 N/m, shorter and longer than half its period.
Rows actionRows() {
  Rows rows;
  for (const double halves : {0.5, 0.9, 1.1, 1.9}) {
    const Oscillator<double> one = {1, 1, halves * M_PI};
    const double slow = one.slow(), fast = one.fast();
    rows.push_back({fmt::format("{}", halves), onBoard(slow), onBoard(fast),
                    slow > 0 && fast > 0 ? "least" : "neither least nor greatest"});
  }
  return rows;
}

Trial saddle() {
  return certified([](RealPoint& at) {
    const auto oscillator = anyOscillator(at, 3.3, 6);
    at.positive("- (slow) (fast)", -(oscillator.slow() * oscillator.fast()));
  });
}

Trial stationary() {
  return exact([](Point& at) {
    // a free fall: I(q + r) - I(q) has no part linear in r
    const T m = at.number(), g = at.number(), t1 = at.number(), t2 = at.number();
    const Poly<T> q(std::vector<T>{at.number(), at.number(), -g / T(2)});
    const Poly<T> r = anyVariation(at, t1, t2);
    const auto action = [&](const Poly<T>& path) {
      const Poly<T> v = path.derivative();
      return (Poly<T>(m / T(2)) * v * v - Poly<T>(m * g) * path).integral(t1, t2);
    };
    const Poly<T> rd = r.derivative();
    at.equal("I(q + r) - I(q)", T(action(q + r) - action(q)),
             T((Poly<T>(m / T(2)) * rd * rd).integral(t1, t2)));
  });
}

Trials eq64() {
  return Trials("eq64")
      .printed(certified([](RealPoint& at) {
        const auto oscillator = anyOscillator(at, 3.3, 6);
        at.positive("product of the changes that one slow and one fast variation make",
                    oscillator.slow() * oscillator.fast());
      }))
      .condition(certified([](RealPoint& at) {
        const auto oscillator = anyOscillator(at, 0.5, 3.14);
        at.positive("slow", oscillator.slow());
        at.positive("fast", oscillator.fast());
        Poly<Ball> any(std::vector<Ball>{at.number(-1, 1), at.number(-1, 1), at.number(-1, 1),
                                         at.number(-1, 1)});
        at.positive("any", oscillator.excess(any));
      }))
      .corrected(both(stationary(), saddle()))
      .numbers(actionRows);
}

Trials leastAction() {
  return Trials("least_action")
      .printed(certified(
          [](RealPoint& at) { at.positive("I(q + r) - I(q)", anyOscillator(at, 3.3, 6).slow()); }))
      .condition(certified([](RealPoint& at) {
        at.positive("I(q + r) - I(q)", anyOscillator(at, 0.5, 3.14).slow());
      }))
      .corrected(certified([](RealPoint& at) {
        at.positive("I(q) - I(q + r)", -anyOscillator(at, 3.3, 6).slow());
      }));
}

Trials eq65() {
  return Trials("eq65").printed(exact([](Point& at) {
    const auto robot = anyRobot(at, {kTurn, kSlide});
    at.equal("forces", robotEulerLagrange(robot, -1), robot.forces(robot.qdd));
  }));
}

Trials eq66() {
  return Trials("eq66")
      .printed(exact([](Point& at) {
        const T b = at.number();
        compareWork(
            at,
            [&](const auto& q, const auto& qd) {
              using S = std::decay_t<decltype(q)>;
              return -(S(Dual<T>(b)) * qd * q);
            },
            [&](const T& qd) { return -b * qd; });
      }))
      .condition(exact([](Point& at) {
        const T Q = at.number(), rate_of_Q = at.number();
        compareWork(
            at,
            [&](const auto& q, const auto&) {
              using S = std::decay_t<decltype(q)>;
              return S(Dual<T>(Q), Dual<T>(rate_of_Q)) * q;
            },
            [&](const T&) { return Q; });
      }))
      .corrected(exact([](Point& at) {
        // any polynomial path q; Q(t) is what it takes: m qdd + k q
        const T m = at.number(), k = at.number(), t1 = at.number(), t2 = at.number();
        const Poly<T> q = anyPoly(at, 3), r = anyVariation(at, t1, t2);
        const Poly<T> Q = Poly<T>(m) * q.derivative().derivative() + Poly<T>(k) * q;
        const T slope =
            (Poly<T>(m) * q.derivative() * r.derivative() - Poly<T>(k) * q * r).integral(t1, t2);
        at.zero("variation and virtual work", T(slope + (Q * r).integral(t1, t2)));
      }))
      .numbers([] {
        constexpr double kViscous = 2, kPlace = 0.1;
        using DD = Dual<Dual<double>>;
        Rows rows;
        for (const double qd : {1.0, 2.0}) {
          // what W = Q q puts on the side of the forces, Q = -b qd
          const auto W = [&](const std::vector<DD>& q, const std::vector<DD>& v) {
            return -(DD(Dual<double>(kViscous)) * v[0] * q[0]);
          };
          const double force = -eulerLagrange<double>(W, {kPlace}, {qd}, {0})(0);
          rows.push_back({onBoard(qd), onBoard(force), onBoard(-kViscous * qd)});
        }
        return rows;
      });
}

// ---- what (72) is, and what it is enough for

/// W = dE/dqdd and E(qdd = 0), E the left side of (72) at this state.
template <typename T>
struct SecondOrder {
  explicit SecondOrder(const Robot<T>& robot) : W(robot.n(), robot.n()) {
    Robot<T> still = robot;
    still.qdd = robot.zeros();
    rest = robotEulerLagrange(still, -1);
    for (int k = 0; k < robot.n(); ++k) {
      still.qdd = robot.unit(k);
      W.col(k) = robotEulerLagrange(still, -1) - rest;
    }
  }
  MatrixX<T> W;
  VectorX<T> rest;
};

Trials eulerPdes() {
  return Trials("euler_pdes")
      .printed(exact([](Point& at) {
        // were qdd open, W would be singular
        at.zero("det W", determinant<T>(SecondOrder<T>(anyRobot(at, {kTurn, kSlide})).W));
      }))
      .corrected(exact([](Point& at) {
        auto robot = anyRobot(at, {kTurn, kSlide});
        const SecondOrder<T> order(robot);
        at.equal("W", order.W, robot.massMatrix());
        at.equal("W qdd", VectorX<T>(order.W * Robot<T>::column(robot.qdd) + order.rest),
                 VectorX<T>(robotEulerLagrange(robot, -1)));
        robot.tau = robot.zeros();
        const recursive::Model<T> model = robot.model();
        recursive::Workspace<T> ws(model);
        std::vector<T> qdd = robot.zeros();
        recursive::forwardDynamics(model, robot.x, robot.qd, robot.tau, ws, qdd);
        at.equal("our code: qdd", Robot<T>::column(qdd),
                 solveDense<T>(order.W, VectorX<T>(-order.rest)));
      }))
      .numbers([] {
        const OnTheBoard arm("double_pendulum", 1);
        const SecondOrder<double> order(pointMassesOf(arm));
        const VectorX<double> qdd = solveDense<double>(order.W, VectorX<double>(-order.rest));
        return Rows{{"`det W` [kg^2 m^4]", "0", onBoard(determinant<double>(order.W))},
                    {"`qdd_1` [rad/s^2]", "open", onBoard(qdd(0))},
                    {"`qdd_2` [rad/s^2]", "open", onBoard(qdd(1))}};
      });
}

/// A polynomial path with the force that makes it obey (72): the first variation by definition and
/// by (72) with any r.
Trial necessary() {
  return exact([](Point& at) { compareFirstVariation(at, true); });
}

Trials eulerNotSufficient() {
  return Trials("euler_not_sufficient").printed(both(necessary(), saddle()));
}

Trials fullyEquivalent() {
  return Trials("fully_equivalent")
      .printed(certified([](RealPoint& at) {
        const auto oscillator = anyOscillator(at, 3.3, 6);
        at.positive("product of the changes that one slow and one fast variation make",
                    oscillator.slow() * oscillator.fast());
      }))
      .condition(stationary())
      .corrected(
          both(exact([](Point& at) {
                 const auto v = anyVaried(at);
                 T by_definition = T(0), by_72 = T(0);
                 for (int i = 0; i < 2; ++i) {
                   by_definition += actionSlope<T>(v.L, v.q, v.r, {T(0), T(0)}, i, v.t1, v.t2);
                   const Poly<T> E =
                       partial(v.L, v.q, i, false) - partial(v.L, v.q, i, true).derivative();
                   by_72 += (v.r[i] * E).integral(v.t1, v.t2);
                 }
                 at.equal("first order", by_definition, by_72);
               }),
               differs([](Point& at) {  // a path that does not obey (72) has an r that tells
                 const auto v = anyVaried(at);
                 at.zero("first order", actionSlope<T>(v.L, v.q, v.r, {T(0), T(0)}, 0, v.t1, v.t2));
               })));
}

Trials eq67() {
  return Trials("eq67").printed(exact([](Point& at) {
    const T m = at.number(), t1 = at.number(), t2 = at.number();
    const Poly<T> q = anyPoly(at, 1), v = q.derivative();
    const T distance = q.at(t2) - q.at(t1);
    at.equal("I", (Poly<T>(m / T(2)) * v * v).integral(t1, t2),
             T(m * distance * distance / (T(2) * (t2 - t1))));
  }));
}

Trials eq68() {
  return Trials("eq68")
      .printed(exact([](Point& at) {
        const auto v = anyVaried(at);
        // eps' r is one number, added to every coordinate: d/deps_1 moves both along r_1
        const T slope = actionSlope<T>(v.L, v.q, {v.r[0], v.r[0]}, {T(0), T(0)}, 0, v.t1, v.t2) +
                        actionSlope<T>(v.L, v.q, {v.r[0], v.r[0]}, {T(0), T(0)}, 1, v.t1, v.t2);
        at.equal("dPhi/deps_1", slope,
                 (partial(v.L, v.q, 0, false) * v.r[0] +
                  partial(v.L, v.q, 0, true) * v.r[0].derivative())
                     .integral(v.t1, v.t2));
      }))
      .corrected(exact([](Point& at) {
        const auto v = anyVaried(at);
        at.equal("dPhi/deps_1", actionSlope<T>(v.L, v.q, v.r, {T(0), T(0)}, 0, v.t1, v.t2),
                 (partial(v.L, v.q, 0, false) * v.r[0] +
                  partial(v.L, v.q, 0, true) * v.r[0].derivative())
                     .integral(v.t1, v.t2));
      }))
      .numbers([] {
        const double q[] = {0.5, 0.5}, r[] = {1, -2}, eps[] = {0.1, 0.2};
        Rows rows;
        for (int i = 0; i < 2; ++i)
          rows.push_back({std::to_string(i + 1), onBoard(q[i]),
                          onBoard(q[i] + eps[0] * r[0] + eps[1] * r[1]),
                          onBoard(q[i] + eps[i] * r[i])});
        return rows;
      });
}

Trials eq69() {
  // at eps = 0, as the words have it; and elsewhere the sum is not 0
  return Trials("eq69").printed(both(exact([](Point& at) { compareFirstVariation(at, true); }),
                                     differs([](Point& at) { compareFirstVariation(at, false); })));
}

Trials eq70() {
  return Trials("eq70").printed(exact([](Point& at) {
    const auto v = anyVaried(at);
    T left = T(0);
    Poly<T> right;
    for (int i = 0; i < 2; ++i) {
      const T eps = at.number();
      left += eps * actionSlope<T>(v.L, v.q, v.r, {T(0), T(0)}, i, v.t1, v.t2);
      right += Poly<T>(eps) * (partial(v.L, v.q, i, false) * v.r[i] +
                               partial(v.L, v.q, i, true) * v.r[i].derivative());
    }
    at.equal("first variation", left, right.integral(v.t1, v.t2));
  }));
}

Trials eq71() {
  return Trials("eq71").printed(exact([](Point& at) {
    const auto v = anyVaried(at);
    const Poly<T> r = anyPoly(at, 2);  // need not vanish at the ends here
    const Poly<T> p = partial(v.L, v.q, 0, true), f = partial(v.L, v.q, 0, false);
    at.equal(
        "first variation", (f * r + p * r.derivative()).integral(v.t1, v.t2),
        T((r * p).at(v.t2) - (r * p).at(v.t1) + (r * (f - p.derivative())).integral(v.t1, v.t2)));
  }));
}

Trials eq72() {
  return Trials("eq72").printed(exact([](Point& at) {
    auto robot = anyRobot(at, {kTurn, kTurn});
    robot.tau = robot.zeros();
    robot.qdd = robot.accelerations();  // by virtual work
    at.zero("d/dt dL/dqd - dL/dq", VectorX<T>(robotEulerLagrange(robot, -1)));
  }));
}

Trials invariance() {
  return Trials("invariance")
      .printed(exact([](Point& at) { compareRotation(at, false); }))
      .condition(exact([](Point& at) {
        const Lagrangian<T> L = anyLagrangian(at);
        const T a = at.number(), b = at.number(), c = at.number();
        const auto f = [&](const auto& x) {  // any quadratic change of coordinates
          using S = typename std::decay_t<decltype(x)>::value_type;
          const auto k = [](const T& y) { return S(y); };
          return std::vector<S>{x[0] + k(a) * x[1] * x[1], x[1] + k(b) * x[0] * x[1] + k(c) * x[0]};
        };
        const std::vector<T> x = {at.number(), at.number()}, xd = {at.number(), at.number()},
                             xdd = {at.number(), at.number()};
        std::vector<Jet<T>> moving;
        for (int i = 0; i < 2; ++i) moving.push_back(jet<T>(x[i], xd[i], xdd[i]));
        const std::vector<Jet<T>> q = f(moving);
        MatrixX<T> slope(2, 2);
        for (int j = 0; j < 2; ++j) {
          std::vector<Dual<T>> seeded = {{x[0], T(j == 0 ? 1 : 0)}, {x[1], T(j == 1 ? 1 : 0)}};
          const auto moved = f(seeded);
          for (int i = 0; i < 2; ++i) slope(i, j) = moved[i].derivative;
        }
        using DD = Dual<Dual<T>>;
        const auto lifted_L = [&](const std::vector<DD>& q, const std::vector<DD>& v) {
          const auto k = [](const T& y) { return DD(Dual<T>(y)); };
          return Lagrangian<DD>{k(L.a), k(L.b), k(L.c), k(L.d), k(L.e)}(q, v);
        };
        const auto in_x = [&](const std::vector<DD>& y, const std::vector<DD>& yd) {
          // f(y) and its rate along yd, by duals over these scalars
          std::vector<Dual<DD>> path = {{y[0], yd[0]}, {y[1], yd[1]}};
          const auto k = [](const T& z) { return Dual<DD>(DD(Dual<T>(z))); };
          const std::vector<Dual<DD>> image = {path[0] + k(a) * path[1] * path[1],
                                               path[1] + k(b) * path[0] * path[1] + k(c) * path[0]};
          return lifted_L({image[0].value, image[1].value},
                          {image[0].derivative, image[1].derivative});
        };
        const auto part = [&](auto which) { return std::vector<T>{which(q[0]), which(q[1])}; };
        const VectorX<T> E_q =
            eulerLagrange<T>(lifted_L, part([](const Jet<T>& y) { return y.value.value; }),
                             part([](const Jet<T>& y) { return y.value.derivative; }),
                             part([](const Jet<T>& y) { return y.derivative.derivative; }));
        at.equal("E_x", eulerLagrange<T>(in_x, x, xd, xdd), VectorX<T>(slope.transpose() * E_q));
      }))
      .corrected(exact([](Point& at) { compareRotation(at, true); }));
}

Trials cartesianLocal() {
  return Trials("cartesian_local").printed(exact([](Point& at) {
    auto robot = anyRobot(at, {kTurn, kTurn, kTurn});
    robot.R[2] = Matrix3<T>::Identity();
    robot.r[2] = Vector3<T>::Zero();
    const MatrixX<T> J = at.template matrix<3, 6>() * robot.jacobian(2);
    at.zero("det J M^-1 J'",
            determinant<T>(MatrixX<T>(J * inverseDense<T>(robot.massMatrix()) * J.transpose())));
  }));
}

}  // namespace

std::vector<Trials> lagrange() {
  return {eq64(),
          leastAction(),
          eq65(),
          eq66(),
          eulerPdes(),
          eulerNotSufficient(),
          fullyEquivalent(),
          eq67(),
          eq68(),
          eq69(),
          eq70(),
          eq71(),
          eq72(),
          invariance(),
          cartesianLocal()};
}

}  // namespace dynwitness::audit
