// SPDX-License-Identifier: Apache-2.0
// Steps of time of one mechanism from many states, one a lane of the processor's vectors.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "recursive/fast/forward_dynamics.hpp"
#include "recursive/fast/strided.hpp"

namespace dynwitness::recursive::fast {

enum class Integrator { kSemiImplicitEuler, kRungeKutta4 };

namespace detail {

/// N states at a time.
template <int N>
struct ManyStepsWorkspace {
  using S = States<N>;
  static constexpr int kWidth = N;
  explicit ManyStepsWorkspace(const Plan<double>& plan)
      : x(static_cast<std::size_t>(plan.positions)),
        q(x.size()),
        q_at(q),
        q_rate(q),
        q_sum(q),
        qd(static_cast<std::size_t>(plan.dof)),
        qd_at(qd),
        qdd(qd),
        qd_sum(qd),
        tau(qd),
        fd(plan) {}

  std::vector<JointPosition<S>> x;
  std::vector<S> q, q_at, q_rate, q_sum;  ///< at the step's start, a stage's, its rate, all stages'
  std::vector<S> qd, qd_at, qdd, qd_sum, tau;
  ForwardDynamicsWorkspace<S> fd;
};

/// What steps are asked.
struct AskedSteps {
  double h;  ///< [s]
  int steps;
  std::size_t states;
  Strided<double> q, qd;
  Strided<const double> tau;
};

template <int N>
DYNWITNESS_INLINE States<N> squareRoot(const States<N>& x) {
  States<N> root;
  for (int lane = 0; lane < N; ++lane) root.v[lane] = __builtin_sqrt(x.v[lane]);
  return root;
}

/// q (0, w) / 2 of the quaternion q at x.
template <typename S>
DYNWITNESS_INLINE void quaternionRate(const JointPosition<S>* x, const S* w, S* rate) {
  const S half(0.5);
  const S a = half * x[0].q, b = half * x[1].q, c = half * x[2].q, d = half * x[3].q;
  rate[0] = -(b * w[0] + c * w[1] + d * w[2]);
  rate[1] = a * w[0] + (c * w[2] - d * w[1]);
  rate[2] = a * w[1] + (d * w[0] - b * w[2]);
  rate[3] = a * w[2] + (b * w[1] - c * w[0]);
}

/// R u, of the quaternion at x.
template <typename S>
DYNWITNESS_INLINE Vec<S> turned(const JointPosition<S>* x, const Vec<S>& u) {
  const auto R = rotation(x);
  return {R(0, 0) * u.x + R(0, 1) * u.y + R(0, 2) * u.z,
          R(1, 0) * u.x + R(1, 1) * u.y + R(1, 2) * u.z,
          R(2, 0) * u.x + R(2, 1) * u.y + R(2, 2) * u.z};
}

/// Rates of the positions at x: as recursive::positionRates.
template <typename S>
DYNWITNESS_INLINE void positionRates(const Plan<double>& plan, const JointPosition<S>* x,
                                     const S* qd, S* rates) {
  for (const Link<double>& link : plan.links) {
    if (link.axes == 1) rates[link.slot] = qd[link.dof];
    if (link.axes < 3) continue;
    const bool floats = link.kind == JointKind::kFloating;
    const S* const v = qd + link.dof;
    const int turn = link.slot + (floats ? 3 : 0);
    if (floats) {
      const Vec<S> p = turned(x + turn, Vec<S>{v[0], v[1], v[2]});
      rates[link.slot] = p.x, rates[link.slot + 1] = p.y, rates[link.slot + 2] = p.z;
    }
    quaternionRate(x + turn, v + (floats ? 3 : 0), rates + turn);
  }
}

/// sin(a/2) / a and cos(a/2) of z = a^2.
template <int N>
struct TurnFactors {
  using S = States<N>;
  S a, sine, cosine;

  DYNWITNESS_INLINE explicit TurnFactors(const S& z) : a(squareRoot(z)) {
    S s;
    sineCosine(S(0.5) * a, s, cosine);
    const auto is_zero = z.v == S(0).v;
    sine.v = is_zero ? S(0.5).v : (s / a).v;
  }

  /// (a - sin a) / a^3: below 1 its series, which does not cancel; what it leaves is below 1/21!,
  /// 2^-63 of it
  DYNWITNESS_INLINE S third(const S& z) const {
    S s, c;
    sineCosine(a, s, c);
    S series(1.0 / 121645100408832000.0);
    for (const double factorial : {355687428096000.0, 1307674368000.0, 6227020800.0, 39916800.0,
                                   362880.0, 5040.0, 120.0, 6.0})
      series = S(1.0 / factorial) - z * series;
    const auto is_small = z.v < S(1).v;
    S out;
    out.v = is_small ? series.v : ((a - s) / (a * z)).v;
    return out;
  }
};

/** The positions q, at x, moved as rates u do in a time of one: an addition, but of spherical and
    floating joints

        R <- R exp(w^),  p <- p + R (v + (1 - cos a)/a^2 w x v + (a - sin a)/a^3 w x (w x v)),
        a = |w| */
template <int N>
DYNWITNESS_INLINE void movePositions(const Plan<double>& plan, const JointPosition<States<N>>* x,
                                     const States<N>* u, States<N>* q) {
  using S = States<N>;
  for (const Link<double>& link : plan.links) {
    if (link.axes == 1) q[link.slot] += u[link.dof];
    if (link.axes < 3) continue;
    const bool floats = link.kind == JointKind::kFloating;
    const int turn = link.slot + (floats ? 3 : 0), first = link.dof + (floats ? 3 : 0);
    const Vec<S> w = {u[first], u[first + 1], u[first + 2]};
    const S z = w.x * w.x + w.y * w.y + w.z * w.z;
    const TurnFactors<N> by(z);
    if (floats) {
      const Vec<S> v = {u[link.dof], u[link.dof + 1], u[link.dof + 2]}, w_v = cross(w, v);
      const S second = S(2) * by.sine * by.sine;
      const Vec<S> p = turned(x + turn, v + w_v * second + cross(w, w_v) * by.third(z));
      q[link.slot] += p.x, q[link.slot + 1] += p.y, q[link.slot + 2] += p.z;
    }
    // q (cos a/2, w sin(a/2) / a)
    const S a = x[turn].q;
    const Vec<S> b = {x[turn + 1].q, x[turn + 2].q, x[turn + 3].q}, t = w * by.sine;
    const Vec<S> to = t * a + b * by.cosine + cross(b, t);
    q[turn] = a * by.cosine - (b.x * t.x + b.y * t.y + b.z * t.z);
    q[turn + 1] = to.x, q[turn + 2] = to.y, q[turn + 3] = to.z;
  }
}

/// y + factor rate
template <typename S>
DYNWITNESS_INLINE void advance(const std::vector<S>& y, double factor, const std::vector<S>& rate,
                               std::vector<S>& to) {
  for (std::size_t k = 0; k < y.size(); ++k) to[k] = y[k] + S(factor) * rate[k];
}

/// One step from ws.q and ws.qd.
template <Integrator kIntegrator, int N>
DYNWITNESS_INLINE void oneStep(const Plan<double>& plan, ManyStepsWorkspace<N>& ws, double h) {
  constexpr bool kIsEuler = kIntegrator == Integrator::kSemiImplicitEuler;
  ws.q_at = ws.q;
  ws.qd_at = ws.qd;
  for (int stage = 0; stage < (kIsEuler ? 1 : 4); ++stage) {
    for (std::size_t k = 0; k < ws.q.size(); ++k) {
      ws.x[k].q = ws.q_at[k];
      sineCosine(ws.x[k].q, ws.x[k].s, ws.x[k].c);
    }
    forwardDynamicsBody(plan, ws.x.data(), ws.qd_at.data(), ws.tau.data(), ws.fd, ws.qdd.data());
    if constexpr (kIsEuler) {
      advance(ws.qd, h, ws.qdd, ws.qd);
      for (std::size_t k = 0; k < ws.qd.size(); ++k) ws.qd_at[k] = States<N>(h) * ws.qd[k];
      return movePositions<N>(plan, ws.x.data(), ws.qd_at.data(), ws.q.data());
    }
    positionRates(plan, ws.x.data(), ws.qd_at.data(), ws.q_rate.data());
    if (stage == 0) {
      ws.q_sum = ws.q_rate;
      ws.qd_sum = ws.qdd;
    } else {
      const double weight = stage == 3 ? 1 : 2;
      advance(ws.q_sum, weight, ws.q_rate, ws.q_sum);
      advance(ws.qd_sum, weight, ws.qdd, ws.qd_sum);
    }
    if (stage == 3) break;
    const double way = stage == 2 ? h : h / 2;
    advance(ws.q, way, ws.q_rate, ws.q_at);
    advance(ws.qd, way, ws.qdd, ws.qd_at);
  }
  advance(ws.q, h / 6, ws.q_sum, ws.q);
  advance(ws.qd, h / 6, ws.qd_sum, ws.qd);
}

template <Integrator kIntegrator, int N>
DYNWITNESS_INLINE void stepBlocks(const Plan<double>& plan, ManyStepsWorkspace<N>& ws,
                                  const AskedSteps& asked) {
  const auto reading = [](const Strided<double>& a) {
    return Strided<const double>{a.at, a.state, a.number};
  };
  for (std::size_t first = 0; first < asked.states; first += N) {
    const int count = static_cast<int>(std::min<std::size_t>(N, asked.states - first));
    numbersOf(reading(asked.q), first, count, plan.positions, ws.q.data());
    numbersOf(reading(asked.qd), first, count, plan.dof, ws.qd.data());
    numbersOf(asked.tau, first, count, plan.dof, ws.tau.data());
    for (int step = 0; step < asked.steps; ++step) oneStep<kIntegrator>(plan, ws, asked.h);
    scatterAll(ws.q.data(), plan.positions, asked.q, first, count);
    scatterAll(ws.qd.data(), plan.dof, asked.qd, first, count);
  }
}

template <Integrator kIntegrator>
__attribute__((flatten)) void step(const Plan<double>& plan, ManyStepsWorkspace<2>& ws,
                                   const AskedSteps& asked) {
  stepBlocks<kIntegrator>(plan, ws, asked);
}
#ifdef __x86_64__
template <Integrator kIntegrator>
DYNWITNESS_FOR_AVX2 __attribute__((flatten)) void step(const Plan<double>& plan,
                                                       ManyStepsWorkspace<4>& ws,
                                                       const AskedSteps& asked) {
  stepBlocks<kIntegrator>(plan, ws, asked);
}
template <Integrator kIntegrator>
DYNWITNESS_FOR_AVX512 __attribute__((flatten)) void step(const Plan<double>& plan,
                                                         ManyStepsWorkspace<8>& ws,
                                                         const AskedSteps& asked) {
  stepBlocks<kIntegrator>(plan, ws, asked);
}
#endif

}  // namespace detail

/** A tree that is decided when the program runs, made ready once, then moved from many states at
    once. With h the length of a step and tau kept meanwhile:

        semi-implicit Euler  qd <- qd + h qdd(q, qd, tau),  then q moves by h qd; quaternions keep
                             their length
        Runge-Kutta 4        the classical one, of (q, qd) as numbers: a quaternion's length drifts
                             by O(h^5) a step, and no length matters

    Each state moves as if it were alone, with the same bits whatever the width of the vectors; see
    ManyStates for arrays. No call allocates. One object serves one thread. */
class ManySteps {
 public:
  /// @param width  as of ManyStates
  explicit ManySteps(const Model<double>& model, int width = widestVectors())
      : plan_(model), workspace_(plan_, width, "ManySteps") {}

  int width() const { return workspace_.width(); }

  /// `steps` steps of h [s] each.
  /// @param q, qd  are replaced
  void step(std::size_t states, Integrator integrator, double h, int steps, Strided<double> q,
            Strided<double> qd, Strided<const double> tau) {
    const detail::AskedSteps asked{h, steps, states, q, qd, tau};
    workspace_.visit([&](auto& ws) {
      if (integrator == Integrator::kSemiImplicitEuler)
        detail::step<Integrator::kSemiImplicitEuler>(plan_, ws, asked);
      else
        detail::step<Integrator::kRungeKutta4>(plan_, ws, asked);
    });
  }

 private:
  Plan<double> plan_;
  detail::OfWidth<detail::ManyStepsWorkspace> workspace_;
};

}  // namespace dynwitness::recursive::fast
