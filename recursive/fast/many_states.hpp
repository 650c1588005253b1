// SPDX-License-Identifier: Apache-2.0
// The fast sweeps of one mechanism at many states, one a lane of the processor's vectors: no
// compiler is needed when the program runs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "recursive/fast/forward_dynamics.hpp"
#include "recursive/fast/inverse_dynamics.hpp"
#include "recursive/fast/mass_matrix.hpp"
#include "recursive/fast/states.hpp"

namespace dynwitness::recursive::fast {

/// Numbers of many states, as NumPy lays them out:
///     number k of state s is at[s * state + k * number].
template <typename T>
struct Strided {
  T* at;
  std::ptrdiff_t state, number = 1;  ///< so many numbers (not bytes) to the next
};

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

/// The states [first, first + count) of a block, count <= N; the last one fills what is left.
template <int N>
DYNWITNESS_INLINE States<N> gather(const Strided<const double>& from, std::size_t first, int count,
                                   int number) {
  States<N> out;
  const double* at =
      from.at + static_cast<std::ptrdiff_t>(first) * from.state + number * from.number;
  for (int lane = 0; lane < N; ++lane) {
    out.v[lane] = *at;
    if (lane + 1 < count) at += from.state;
  }
  return out;
}
template <int N>
DYNWITNESS_INLINE void scatter(const States<N>& from, const Strided<double>& to, std::size_t first,
                               int count, int number) {
  double* at = to.at + static_cast<std::ptrdiff_t>(first) * to.state + number * to.number;
  for (int lane = 0;; at += to.state) {
    *at = from.v[lane];
    if (++lane == count) return;
  }
}

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
    for (int k = 0; k < plan.positions; ++k) {
      JointPosition<S>& x = ws.x[static_cast<std::size_t>(k)];
      x.q = gather<N>(asked.q, first, count, k);
      sineCosine(x.q, x.s, x.c);
    }
    if constexpr (kSweep == Sweep::kMassMatrix) {
      massMatrixBody<Lanes<S>>(plan, ws.x.data(), ws.m, ws.M.data());
      for (int k = 0; k < plan.dof * plan.dof; ++k)
        scatter<N>(ws.M[static_cast<std::size_t>(k)], asked.out, first, count, k);
    } else {
      for (int k = 0; k < plan.dof; ++k) {
        ws.rates[static_cast<std::size_t>(k)] = gather<N>(asked.qd, first, count, k);
        ws.given[static_cast<std::size_t>(k)] = gather<N>(asked.given, first, count, k);
      }
      if constexpr (kSweep == Sweep::kInverseDynamics)
        inverseDynamicsBody(plan, ws.x.data(), ws.rates.data(), ws.given.data(), ws.id,
                            ws.out.data());
      else
        forwardDynamicsBody(plan, ws.x.data(), ws.rates.data(), ws.given.data(), ws.fd,
                            ws.out.data());
      for (int k = 0; k < plan.dof; ++k)
        scatter<N>(ws.out[static_cast<std::size_t>(k)], asked.out, first, count, k);
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

/// How many doubles the widest vectors of this processor hold.
inline int widestVectors() {
  return kHasAvx512 ? 8 : kHasAvx2 ? 4 : 2;
}

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
      : plan_(model), workspace_(madeFor(width)) {}

  int width() const {
    return std::visit([](const auto& ws) { return ws.kWidth; }, workspace_);
  }

  /// tau of M qdd + c + g - Q
  void inverseDynamics(std::size_t states, Strided<const double> q, Strided<const double> qd,
                       Strided<const double> qdd, Strided<double> tau) {
    sweep<detail::Sweep::kInverseDynamics>({states, q, qd, qdd, tau});
  }
  void massMatrix(std::size_t states, Strided<const double> q, Strided<double> M) {
    const auto n = static_cast<std::size_t>(plan_.dof);
    std::visit([n](auto& ws) { ws.M.resize(n * n); }, workspace_);
    sweep<detail::Sweep::kMassMatrix>({states, q, {}, {}, M});
  }
  /// qdd of M qdd + c + g = tau + Q
  void forwardDynamics(std::size_t states, Strided<const double> q, Strided<const double> qd,
                       Strided<const double> tau, Strided<double> qdd) {
    sweep<detail::Sweep::kForwardDynamics>({states, q, qd, tau, qdd});
  }

 private:
#ifdef __x86_64__
  using Workspace = std::variant<detail::ManyStatesWorkspace<2>, detail::ManyStatesWorkspace<4>,
                                 detail::ManyStatesWorkspace<8>>;
#else
  using Workspace = std::variant<detail::ManyStatesWorkspace<2>>;
#endif
  Workspace madeFor(int width) const {
    if (width == 2) return Workspace(std::in_place_index<0>, plan_);
#ifdef __x86_64__
    if (width == 4 && kHasAvx2) return Workspace(std::in_place_index<1>, plan_);
    if (width == 8 && kHasAvx512) return Workspace(std::in_place_index<2>, plan_);
#endif
    throw std::invalid_argument(
        "ManyStates: width " + std::to_string(width) +
        " was asked; allowed: 2, 4 with AVX2, 8 with AVX-512 (here at most " +
        std::to_string(widestVectors()) + ")");
  }
  template <detail::Sweep kSweep>
  void sweep(const detail::Asked& asked) {
    std::visit([&](auto& ws) { detail::sweep<kSweep>(plan_, ws, asked); }, workspace_);
  }

  Plan<double> plan_;
  Workspace workspace_;
};

}  // namespace dynwitness::recursive::fast
