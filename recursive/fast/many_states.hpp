// SPDX-License-Identifier: Apache-2.0
// The fast sweeps of one mechanism at many states, one a lane of the processor's vectors: no
// compiler is needed when the program runs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "recursive/fast/forward_dynamics.hpp"
#include "recursive/fast/inverse_dynamics.hpp"
#include "recursive/fast/mass_matrix.hpp"
#include "recursive/fast/strided.hpp"

namespace dynwitness::recursive::fast {

namespace detail {

/// N states at a time.
template <int N>
struct ManyStatesWorkspace {
  using S = States<N>;
  static constexpr int kWidth = N;
  explicit ManyStatesWorkspace(const Plan<double>& plan)
      : x(static_cast<std::size_t>(plan.positions)),
        rates(static_cast<std::size_t>(plan.dof)),
        given(rates),
        out(rates),
        id(plan),
        m(plan),
        fd(plan) {}

  std::vector<JointPosition<S>> x;
  std::vector<S> rates, given, out;  ///< qd; qdd or tau; the answer
  std::vector<S> M;                  ///< n n numbers, once it was asked for
  InverseDynamicsWorkspace<S> id;
  MassMatrixWorkspace<S> m;
  ForwardDynamicsWorkspace<S> fd;
};

/// What a sweep is asked.
struct Asked {
  std::size_t states;
  Strided<const double> q, qd, given;  ///< given: qdd of tau, tau of qdd
  Strided<double> out;
};
enum class Sweep { kInverseDynamics, kMassMatrix, kForwardDynamics };

template <Sweep kSweep, int N>
DYNWITNESS_INLINE void sweepBlocks(const Plan<double>& plan, ManyStatesWorkspace<N>& ws,
                                   const Asked& asked) {
  using S = States<N>;
  for (std::size_t first = 0; first < asked.states; first += N) {
    const int count = static_cast<int>(std::min<std::size_t>(N, asked.states - first));
    positionsOf(asked.q, first, count, plan.positions, ws.x.data());
    if constexpr (kSweep == Sweep::kMassMatrix) {
      massMatrixBody<Lanes<S>>(plan, ws.x.data(), ws.m, ws.M.data());
      scatterAll(ws.M.data(), plan.dof * plan.dof, asked.out, first, count);
    } else {
      numbersOf(asked.qd, first, count, plan.dof, ws.rates.data());
      numbersOf(asked.given, first, count, plan.dof, ws.given.data());
      if constexpr (kSweep == Sweep::kInverseDynamics)
        inverseDynamicsBody(plan, ws.x.data(), ws.rates.data(), ws.given.data(), ws.id,
                            ws.out.data());
      else
        forwardDynamicsBody(plan, ws.x.data(), ws.rates.data(), ws.given.data(), ws.fd,
                            ws.out.data());
      scatterAll(ws.out.data(), plan.dof, asked.out, first, count);
    }
  }
}

template <Sweep kSweep>
__attribute__((flatten)) void sweep(const Plan<double>& plan, ManyStatesWorkspace<2>& ws,
                                    const Asked& asked) {
  sweepBlocks<kSweep>(plan, ws, asked);
}
#ifdef __x86_64__
template <Sweep kSweep>
DYNWITNESS_FOR_AVX2 __attribute__((flatten)) void sweep(const Plan<double>& plan,
                                                        ManyStatesWorkspace<4>& ws,
                                                        const Asked& asked) {
  sweepBlocks<kSweep>(plan, ws, asked);
}
template <Sweep kSweep>
DYNWITNESS_FOR_AVX512 __attribute__((flatten)) void sweep(const Plan<double>& plan,
                                                          ManyStatesWorkspace<8>& ws,
                                                          const Asked& asked) {
  sweepBlocks<kSweep>(plan, ws, asked);
}
#endif

}  // namespace detail

/** A mechanism that is decided when the program runs, made ready once, then asked at many states
    at once: each gets the same bits as from Dynamics, one by one (compiled as x86-64 is by default,
    without FMA, or with -ffp-contract=off: which sums fuse is else the compiler's choice).

    Arrays are read and written where they stand (Strided), which may be NumPy's: q has
    model.positions numbers a state, qd, qdd, tau model.dof() each, M the square of that. They may
    not overlap. No call allocates, but that the first massMatrix() takes room for M of `width()`
    states. One object serves one thread. */
class ManyStates {
 public:
  /// @param width  states side by side: 2, 4 or 8, as wide as the processor has them or narrower
  explicit ManyStates(const Model<double>& model, int width = widestVectors())
      : plan_(model), workspace_(plan_, width, "ManyStates") {}

  int width() const { return workspace_.width(); }

  /// tau of M qdd + c + g - Q
  void inverseDynamics(std::size_t states, Strided<const double> q, Strided<const double> qd,
                       Strided<const double> qdd, Strided<double> tau) {
    sweep<detail::Sweep::kInverseDynamics>({states, q, qd, qdd, tau});
  }
  void massMatrix(std::size_t states, Strided<const double> q, Strided<double> M) {
    const auto n = static_cast<std::size_t>(plan_.dof);
    workspace_.visit([n](auto& ws) { ws.M.resize(n * n); });
    sweep<detail::Sweep::kMassMatrix>({states, q, {}, {}, M});
  }
  /// qdd of M qdd + c + g = tau + Q
  void forwardDynamics(std::size_t states, Strided<const double> q, Strided<const double> qd,
                       Strided<const double> tau, Strided<double> qdd) {
    sweep<detail::Sweep::kForwardDynamics>({states, q, qd, tau, qdd});
  }

 private:
  template <detail::Sweep kSweep>
  void sweep(const detail::Asked& asked) {
    workspace_.visit([&](auto& ws) { detail::sweep<kSweep>(plan_, ws, asked); });
  }

  Plan<double> plan_;
  detail::OfWidth<detail::ManyStatesWorkspace> workspace_;
};

}  // namespace dynwitness::recursive::fast
