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
  std::vector<int> places;           ///< in M, of packed numbers
  std::vector<S> packed;
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
enum class Sweep { kInverseDynamics, kMassMatrix, kPackedMassMatrix, kForwardDynamics };

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
    } else if constexpr (kSweep == Sweep::kPackedMassMatrix) {
      massMatrixBody<Lanes<S>, false>(plan, ws.x.data(), ws.m, ws.M.data());
      for (std::size_t k = 0; k < ws.places.size(); ++k)
        ws.packed[k] = ws.M[static_cast<std::size_t>(ws.places[k])];
      scatterAll(ws.packed.data(), static_cast<int>(ws.places.size()), asked.out, first, count);
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

/// Where a number of M stands: column <= row.
struct MassMatrixEntry {
  int row, column;
};

/** A mechanism that is decided when the program runs, made ready once, then asked at many states
    at once: each gets the same bits as from Dynamics, one by one (compiled as x86-64 is by default,
    without FMA, or with -ffp-contract=off: which sums fuse is else the compiler's choice).

    Arrays are read and written where they stand (Strided), which may be NumPy's: q has
    model.positions numbers a state, qd, qdd, tau model.dof() each, M the square of that. They may
    not overlap. No call allocates, but that the first massMatrix() and the first packedMassMatrix()
    take room for M of `width()` states. One object serves one thread. */
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
  /// Which entries packedMassMatrix() gives, in this order: of the lower half row by row those that
  /// are not zero by nature, since one rate is inboard of the other.
  std::vector<MassMatrixEntry> packedEntries() const {
    std::vector<MassMatrixEntry> entries;
    const std::vector<std::vector<int>> inboard = ratesInboard(plan_);
    for (int row = 0; row < plan_.dof; ++row) {
      for (const int column : inboard[static_cast<std::size_t>(row)])
        entries.push_back({row, column});
      entries.push_back({row, row});
    }
    return entries;
  }
  /// The numbers of M that say all of it, packedEntries().size() a state, the same bits: a fifth of
  /// a humanoid's n^2.
  void packedMassMatrix(std::size_t states, Strided<const double> q, Strided<double> packed) {
    workspace_.visit([this](auto& ws) {
      if (!ws.places.empty()) return;
      const auto n = static_cast<std::size_t>(plan_.dof);
      ws.M.resize(n * n);
      for (const MassMatrixEntry& e : packedEntries())
        ws.places.push_back(e.column * plan_.dof + e.row);  // the sweep fills the upper half
      ws.packed.resize(ws.places.size());
    });
    sweep<detail::Sweep::kPackedMassMatrix>({states, q, {}, {}, packed});
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
