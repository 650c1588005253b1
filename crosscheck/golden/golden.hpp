// SPDX-License-Identifier: GPL-3.0-or-later
// Golden vectors: states and certified answers that others may test their programs against.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// What may be asked for: everything that an outside program may be asked.
inline constexpr Quantity kGoldenQuantities[] = {
    Quantity::kM,         Quantity::kc,        Quantity::kg,
    Quantity::kTau,       Quantity::kQdd,      Quantity::kKinetic,
    Quantity::kPotential, Quantity::kMomentum, Quantity::kReactions};

struct GoldenOptions {
  std::vector<Quantity> quantities;  ///< empty: all, but for dear ones of many rates
  std::uint64_t seed = 1;
  int states = 8;  ///< of a group, at most
};

/// A quantity at a state, entry by entry, reactions in a row a joint; `digits` column by column, as
/// Eigen keeps them.
struct GoldenAnswer {
  Quantity quantity = Quantity::kM;
  Eigen::MatrixXd value;            ///< the doubles nearest to the truth
  std::vector<std::string> digits;  ///< the truth at 50 digits
  Eigen::MatrixXd radius;           ///< |truth - digits| is at most that, certified
  /// How far from `value` an answer computed in double may lie; infinite: nothing can be asked.
  Eigen::MatrixXd limit;
  std::string none;  ///< why there is no such number; then all of the above are empty
};

struct GoldenState {
  int index = 0;  ///< counted through all groups
  std::string note;
  scene::State<double> state;
  std::vector<Quantity> asked;
  std::vector<GoldenAnswer> answers;  ///< one a quantity asked
};

struct GoldenGroup {
  std::string name, sentence;  ///< what it separates
  long of = 0;                 ///< so many states there are of this kind; 0: no end of them
  std::vector<GoldenState> states;
};

struct Golden {
  scene::Scene scene;
  std::uint64_t seed = 0;
  std::vector<GoldenGroup> groups;    ///< in the order in which they are to be looked at
  std::vector<std::string> left_out;  ///< sentences
  long states() const;
  long numbers() const;  ///< that are asked for
};

/** The questions, without answers. Groups isolate terms, so that the first that fails says which
    one is wrong. Rates and accelerations, joint forces and slides are multiples of 2^-10, angles
    too (2^-4 where they are large), tiny rates of 2^-20: such a number is the same in decimals, in
    double and in single precision. Costs O(n) a state looked at.

    @param scene  a tree, no joint of which follows another
    @throws scene::InputError  the quantities asked for leave no group, or too many numbers */
Golden goldenQuestions(const scene::Scene& scene, const GoldenOptions& options);

/** Fills in the answers: truths in ball arithmetic (truth.hpp), and as limits what any algorithm of
    the usual kinds, in axes of its own, may lose in double (engine_bound.hpp). */
void answer(Golden& golden);

}  // namespace dynwitness::crosscheck
