// SPDX-License-Identifier: Apache-2.0
// Derivatives of one mechanism's inverse and forward dynamics at many states, one a lane of the
// processor's vectors.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "recursive/fast/forward_dynamics.hpp"
#include "recursive/fast/forward_dynamics_derivatives.hpp"
#include "recursive/fast/strided.hpp"

namespace dynwitness::recursive::fast {

namespace detail {

/// N states at a time.
template <int N>
struct ManyDerivativesWorkspace {
  using S = States<N>;
  static constexpr int kWidth = N;
  explicit ManyDerivativesWorkspace(const Plan<double>& plan)
      : x(static_cast<std::size_t>(plan.positions)),
        rates(static_cast<std::size_t>(plan.dof)),
        given(rates),
        qdd(rates),
        fd(plan),
        room(plan),
        three(3 * rates.size() * rates.size(), S(0)) {}

  std::vector<JointPosition<S>> x;
  std::vector<S> rates, given, qdd;
  ForwardDynamicsWorkspace<S> fd;
  AccelerationDerivativesWorkspace<S> room;
  std::vector<S> three;  ///< d tau/dq, d tau/dqd and M; what joints do not feel stays zero
};

/// What is asked of derivatives.
struct AskedDerivatives {
  std::size_t states;
  Strided<const double> q, qd, given;  ///< given: qdd of tau, tau of qdd
  Strided<double> by_q, by_qd, by_third;
};

template <bool kOfAccelerations, int N>
DYNWITNESS_INLINE void differentiateBlocks(const Plan<double>& plan,
                                           ManyDerivativesWorkspace<N>& ws,
                                           const AskedDerivatives& asked) {
  using S = States<N>;
  const int n = plan.dof, nn = n * n;
  for (std::size_t first = 0; first < asked.states; first += N) {
    const int count = static_cast<int>(std::min<std::size_t>(N, asked.states - first));
    positionsOf(asked.q, first, count, plan.positions, ws.x.data());
    numbersOf(asked.qd, first, count, n, ws.rates.data());
    numbersOf(asked.given, first, count, n, ws.given.data());
    if constexpr (kOfAccelerations) {
      forwardDynamicsBody(plan, ws.x.data(), ws.rates.data(), ws.given.data(), ws.fd,
                          ws.qdd.data());
      solveAccelerationDerivatives<Lanes<S>, One<S>>(plan, ws.x.data(), ws.rates.data(),
                                                     ws.qdd.data(), ws.room);
      const int width = static_cast<int>(ws.room.width);
      for (int i = 0; i < n; ++i) {
        const S* const row = ws.room.rows.data() + 2 * i * width;
        scatterAll(row, n, asked.by_q, first, count, i * n);
        scatterAll(row + width, n, asked.by_qd, first, count, i * n);
        scatterAll(ws.room.inverse.data() + i * width, n, asked.by_third, first, count, i * n);
      }
    } else {
      S* const three = ws.three.data();
      const auto stride = static_cast<std::size_t>(n);
      inverseDynamicsDerivativesBody<Lanes<S>, One<S>>(
          plan, ws.x.data(), ws.rates.data(), ws.given.data(), ws.room.of_tau,
          ForceDerivatives<S>{three, three + nn, stride, three + 2 * nn, stride});
      scatterAll(three, nn, asked.by_q, first, count);
      scatterAll(three + nn, nn, asked.by_qd, first, count);
      scatterAll(three + 2 * nn, nn, asked.by_third, first, count);
    }
  }
}

template <bool kOfAccelerations>
__attribute__((flatten)) void differentiate(const Plan<double>& plan,
                                            ManyDerivativesWorkspace<2>& ws,
                                            const AskedDerivatives& asked) {
  differentiateBlocks<kOfAccelerations>(plan, ws, asked);
}
#ifdef __x86_64__
template <bool kOfAccelerations>
DYNWITNESS_FOR_AVX2 __attribute__((flatten)) void differentiate(const Plan<double>& plan,
                                                                ManyDerivativesWorkspace<4>& ws,
                                                                const AskedDerivatives& asked) {
  differentiateBlocks<kOfAccelerations>(plan, ws, asked);
}
template <bool kOfAccelerations>
DYNWITNESS_FOR_AVX512 __attribute__((flatten)) void differentiate(const Plan<double>& plan,
                                                                  ManyDerivativesWorkspace<8>& ws,
                                                                  const AskedDerivatives& asked) {
  differentiateBlocks<kOfAccelerations>(plan, ws, asked);
}
#endif

}  // namespace detail

/** A mechanism that is decided when the program runs, made ready once, then asked for derivatives
    at many states at once: each gets the same bits as from Derivatives, one by one, where
    ManyStates gets those of Dynamics.

    Arrays, strides and what they may not do are those of ManyStates; every matrix has dof^2 numbers
    a state, row by row. Conventions are those of inverseDynamicsDerivatives(). No call allocates.
    One object serves one thread. */
class ManyDerivatives {
 public:
  /// @param width  as of ManyStates
  explicit ManyDerivatives(const Model<double>& model, int width = widestVectors())
      : plan_(model), workspace_(plan_, width, "ManyDerivatives") {}

  int width() const { return workspace_.width(); }

  /// Of tau, with d tau/dqdd = M.
  void inverseDynamics(std::size_t states, Strided<const double> q, Strided<const double> qd,
                       Strided<const double> qdd, Strided<double> dtau_dq, Strided<double> dtau_dqd,
                       Strided<double> M) {
    differentiate<false>({states, q, qd, qdd, dtau_dq, dtau_dqd, M});
  }
  /// Of qdd, with d qdd/dtau = 1/M.
  void forwardDynamics(std::size_t states, Strided<const double> q, Strided<const double> qd,
                       Strided<const double> tau, Strided<double> dqdd_dq, Strided<double> dqdd_dqd,
                       Strided<double> dqdd_dtau) {
    differentiate<true>({states, q, qd, tau, dqdd_dq, dqdd_dqd, dqdd_dtau});
  }

 private:
  template <bool kOfAccelerations>
  void differentiate(const detail::AskedDerivatives& asked) {
    workspace_.visit([&](auto& ws) { detail::differentiate<kOfAccelerations>(plan_, ws, asked); });
  }

  Plan<double> plan_;
  detail::OfWidth<detail::ManyDerivativesWorkspace> workspace_;
};

}  // namespace dynwitness::recursive::fast
