// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/exact/ledger.hpp"

#include <algorithm>
#include <exception>

#include <fmt/format.h>

#include "crosscheck/exact/equation_zeros.hpp"
#include "crosscheck/exact/parameter_rank.hpp"
#include "crosscheck/kernel/general_cost.hpp"
#include "crosscheck/kernel/roads.hpp"
#include "crosscheck/scalars/formula_sizes.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Parameters beyond which their rank is not computed, which takes the cube of their number.
constexpr std::size_t kMostParameters = 400;

/// Of those that are never told from others no force depends on more.
void countParameters(const scene::Scene& scene, const LedgerOptions& options, Ledger* ledger) {
  const std::vector<scene::InertialParameter> parameters =
      scene::inertialParameters(scene.mechanism);
  ledger->parameters = static_cast<int>(parameters.size());
  if (parameters.size() > kMostParameters) {
    ledger->no_base_parameters = fmt::format("not counted beyond {} parameters", kMostParameters);
    return;
  }
  const double chance = chanceOfTooSmallRank(scene, parameters);
  if (!(chance < 1)) {
    ledger->no_base_parameters = "too large for a rank over primes below 2^63";
    return;
  }
  int rank = 0;
  const int trials = parameters.empty() ? 0 : pointsNeeded(chance, options.error_probability);
  for (int trial = 0; trial < trials; ++trial) {
    const PrimeField::Modulus field(drawPrime(scene.name, options.seed, trial));
    rank = std::max(rank, stackRegressor(scene, parameters, options.seed, trial).echelon.rank());
  }
  ledger->base_parameters = rank;
}

/// Of the tree: a program has no sign for friction, and closures are no part of tau.
scene::Mechanism countedTree(scene::Mechanism mechanism) {
  mechanism.closures.clear();
  mechanism.springs.clear();
  for (scene::Link& link : mechanism.links) link.joint.friction = {};
  return mechanism;
}

void countOperations(const scene::Mechanism& mechanism, Ledger* ledger) {
  const scene::Mechanism tree = countedTree(mechanism);
  if (tree.hasCoupledRates()) {
    ledger->no_operations =
        "not counted where joints follow others, or rotors are geared to several rates";
    return;
  }
  try {
    ledger->general_operations = kernel::generalOperations(tree, kernel::Formula::kInverseDynamics);
    ledger->operations = kernel::smallestRoad(tree, kernel::Formula::kInverseDynamics).operations();
  } catch (const kernel::NotUsed&) {
    ledger->no_operations =
        fmt::format("not written: of more than {} operations, or no fewer than the general sweep",
                    kernel::kMostOperations);
  } catch (const std::exception& error) {
    ledger->no_operations = error.what();
  }
}

}  // namespace

Ledger ledgerOf(const PreparedScene& prepared, const LedgerOptions& options) {
  const scene::Scene& scene = prepared.scene();
  const scene::Mechanism& mechanism = scene.mechanism;
  Ledger ledger;
  std::vector<bool> moves;
  for (const scene::Link& link : mechanism.links) {
    const bool joint = link.parent >= 0 && link.joint.kind != scene::JointKind::kFixed;
    moves.push_back(joint || (link.parent >= 0 && moves[static_cast<std::size_t>(link.parent)]));
    ledger.links += moves.back() ? 1 : 0;
    ledger.joints += joint ? 1 : 0;
  }
  ledger.rates = mechanism.dof();
  if (ledger.rates == 0) return ledger;
  try {
    countParameters(scene, options, &ledger);
  } catch (const DivisionByZero& error) {
    ledger.no_base_parameters = error.what();
  }
  EquationZeros zeros = equationZeros(scene, options.seed, options.error_probability);
  ledger.zeros = std::move(zeros.of);
  ledger.error_probability = zeros.error_probability;
  ledger.disputes = std::move(zeros.disputes);
  countOperations(mechanism, &ledger);
  return ledger;
}

}  // namespace dynwitness::crosscheck
