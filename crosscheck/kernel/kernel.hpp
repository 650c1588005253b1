// SPDX-License-Identifier: GPL-3.0-or-later
// A scene's own kernel: inverse dynamics, M and forward dynamics as compiled straight-line code.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "crosscheck/kernel/roads.hpp"
#include "scene/mechanism.hpp"

namespace dynwitness::crosscheck::kernel {

/// Doubles in a vector of this processor: 8 (AVX-512), 4 (AVX2), else 2.
int widestLanes();

/// The same, or fewer where the environment variable DYNWITNESS_LANES says so.
/// @throws scene::InputError  it names a width that is not there
int chosenLanes();

/** Looks for a C compiler and a cache folder, and has a small program compiled (once, then it is
    kept) whose bits show whether sums are reordered, products fused with sums, divisions done by
    reciprocals, or small numbers flushed to zero.
    @throws CannotCompile  there is none, or what it makes does not compute as written; asked once,
                           the answer stays the same for the same compiler */
void requireCompiler();

struct KernelOptions {
  std::vector<Formula> formulas = {Formula::kInverseDynamics, Formula::kMassMatrix,
                                   Formula::kForwardDynamics};
  int lanes = chosenLanes();
};

/** The smallest programs of a mechanism (SmallestRoads), emitted as C, compiled by the system's
    compiler and loaded, after a trial: it must give the very bits of the interpreted program, in
    every lane. Compiled code is kept (cacheFolder()), so that the second time costs the tracing
    alone. A formula whose straight line would not be worth having (NotUsed) has no code, and must
    not be called.

    All functions may be called from several threads at once; they allocate nothing. q has one entry
    a position slot, the others one a degree of freedom; SI units. Of `many` states, component i of
    state k is at [i * count + k]. */
class Kernel {
 public:
  /// @throws CannotCompile (compiled.hpp) where there is no compiler or no cache folder; NotUsed
  ///         when no formula has code; and what else smallestRoad() throws
  explicit Kernel(const SmallestRoads& roads, const KernelOptions& options = {});

  int dof() const { return dof_; }
  int lanes() const { return lanes_; }
  bool has(Formula formula) const;  ///< whether a formula has code
  /// For each formula that was asked for and has no code, why.
  const std::map<Formula, std::string>& notUsed() const { return not_used_; }
  /// The program that a formula's code was made of. @throws std::invalid_argument when there is
  /// none
  const Road& road(Formula formula) const;

  /// tau = M qdd + c + g - loads
  void inverseDynamics(const double* q, const double* qd, const double* qdd, double* tau) const {
    id_.one(q, qd, qdd, tau);
  }
  /// M, n x n, row by row
  void massMatrix(const double* q, double* M) const { m_.one(q, nullptr, nullptr, M); }
  /// qdd of M qdd + c + g = tau + loads
  void forwardDynamics(const double* q, const double* qd, const double* tau, double* qdd) const {
    fd_.one(q, qd, tau, qdd);
  }

  void inverseDynamics(const double* q, const double* qd, const double* qdd, double* tau,
                       long count) const {
    id_.many(q, qd, qdd, tau, count);
  }
  void massMatrix(const double* q, double* M, long count) const {
    m_.many(q, nullptr, nullptr, M, count);
  }
  void forwardDynamics(const double* q, const double* qd, const double* tau, double* qdd,
                       long count) const {
    fd_.many(q, qd, tau, qdd, count);
  }

 private:
  struct Code {
    void (*one)(const double*, const double*, const double*, double*) = nullptr;
    void (*many)(const double*, const double*, const double*, double*, long) = nullptr;
  };

  int dof_, lanes_;
  std::map<Formula, Road> roads_;
  std::map<Formula, std::string> not_used_;
  std::vector<std::shared_ptr<class SharedObject>> objects_;
  Code id_, m_, fd_;
};

}  // namespace dynwitness::crosscheck::kernel
