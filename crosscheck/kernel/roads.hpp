// SPDX-License-Identifier: GPL-3.0-or-later
// The programs that compute a scene's quantities, by every road that we know, and the smallest of
// them.
#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "scene/mechanism.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck::kernel {

/// What a program computes. Outputs: n, but n x n row by row for M, and M, c, g one after the
/// other.
enum class Formula {
  kInverseDynamics,      ///< tau of q, qd, qdd, loads and springs included
  kMassMatrix,           ///< M of q
  kCoriolis,             ///< c of q, qd
  kGravity,              ///< g of q, springs included
  kMassCoriolisGravity,  ///< M, c and g in one program
  kForwardDynamics       ///< qdd of q, qd, tau
};
inline constexpr Formula kAllFormulas[] = {
    Formula::kInverseDynamics, Formula::kMassMatrix,          Formula::kCoriolis,
    Formula::kGravity,         Formula::kMassCoriolisGravity, Formula::kForwardDynamics};

/// "ID", "M", "c", "g", "M + c + g", "FD"
const char* name(Formula formula);

enum class RoadKind { kLeanSweep, kTracedOnBase, kLagrange, kTracedSweep };
/// "lean sweep", "traced on base", "Lagrange", "traced sweep"
const char* name(RoadKind kind);

/// One way to a formula.
struct Road {
  RoadKind kind;
  symbolic::Program program;

  /// Multiplications, additions and divisions on the state together.
  int operations() const;
};

/** All roads to a formula:
      lean sweep       Newton-Euler with body-point accelerations and composite moments of mass, on
                       base parameters, with origins and units where they save most
                       (lean_sweeps.hpp)
      traced sweep     the sweeps of recursive/ as they are (for FD the articulated bodies)
      traced on base   the same on the base parameters
      Lagrange         the derivation of symbolic/
    A road that cannot take the mechanism is left out; "traced sweep" takes all. For the parameters
    of the scene as they are: their zeros are structural, and what depends on them alone is folded.
    @throws std::runtime_error when the mechanism has closures or springs between points
    @throws std::domain_error  of forward dynamics when M is singular in every state */
std::vector<Road> roads(const scene::Mechanism& mechanism, Formula formula);

/** Operations beyond which no straight line is written. Measured on one core (g++ 12, -O1): it
    takes the compiler 0.7 s for 3000, 2 s for 4000 to 5000, 12 s for 10000, since its passes grow
    with their square; and beyond 4000 to 5000 the code leaves the instruction cache and is slower
    than loops (chain_24: M of 4229 took 732 ns and the general sweep 821, the floating humanoid's
    of 4794 1581 against 1321). */
inline constexpr int kMostOperations = 3000;

/// Where the general sweep takes this many times kMostOperations, nothing is written down to find
/// out: of so long sweeps a straight line saves four fifths at most (planar chains), and FD would
/// be written down in up to a hundred thousand operations.
inline constexpr int kMostSaved = 5;

/// Degrees of freedom beyond which operations are not even counted.
inline constexpr int kMostDof = 256;

/// A straight line is not worth having; the message says why, in numbers.
struct NotUsed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/** The road of the fewest operations. Of the traced sweeps, which every bundled scene shows to be
    larger by half, the mechanisms that the lean sweep cannot take are left.

    The search is bounded by counted steps, the same on every machine: about a second for ID, M and
    FD together.
    @throws NotUsed  of ID, M and FD: more than kMostOperations, or not fewer than the general
                     sweep's (general_cost.hpp); and what roads() throws */
Road smallestRoad(const scene::Mechanism& mechanism, Formula formula);

/** The same where a straight line is wanted even if loops take no more: M may be a number.
    @param fold_parameters  whether the scene's named parameters are their values; else they are
                            atoms, and what depends on them alone is the program's prologue
    @throws NotUsed  it is too long; and what roads() throws */
Road smallestWritten(const scene::Mechanism& mechanism, Formula formula,
                     bool fold_parameters = true);

/// The smallest roads of one mechanism, each looked for once, when it is first asked for; not for
/// several threads at once.
class SmallestRoads {
 public:
  SmallestRoads(const scene::Mechanism& mechanism);  // NOLINT(google-explicit-constructor)

  const scene::Mechanism& mechanism() const { return mechanism_; }
  /// smallestRoad(), with what it throws.
  const Road& operator()(Formula formula) const;

 private:
  struct Found {
    Road road = {};
    std::string not_used;  ///< why no road is worth having; empty: one is
  };
  static Found found(const scene::Mechanism& mechanism, Formula formula);

  scene::Mechanism mechanism_;
  mutable std::map<Formula, Found> known_;
};

}  // namespace dynwitness::crosscheck::kernel
