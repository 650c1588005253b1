// SPDX-License-Identifier: GPL-3.0-or-later
// One witness on the stand: is it right, where is it wrong, and why.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/verdicts/claims.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

struct CheckOptions {
  std::uint64_t seed = 1;
  bool single = false;   ///< limits are those of an engine that computes in single precision
  bool explain = true;   ///< seek what explains a mistake
  bool smallest = true;  ///< where nothing does, seek the smallest mechanism that still fails
  /// Asked in place of those that isolate terms.
  std::vector<scene::State<double>> states = {};
};

/// What was found out about one quantity.
struct QuantityFound {
  enum class Verdict { kRight, kWrong, kCannotSay };
  std::string name;          ///< "M", ...; "jacobian"
  bool is_jacobian = false;  ///< of a frame: no quantity of a witness
  Verdict verdict = Verdict::kCannotSay;
  std::string reason;            ///< why nothing can be said
  int states = 0;                ///< at which it was judged
  std::optional<double> digits;  ///< fewest correct ones, counted against the whole quantity
  double seen = 0, limit = 0;    ///< where most of the limit is used [ulp of the largest entry]
  double ratio = 0;              ///< seen / limit
  double largest = 0;            ///< of the certified truth's entries
  std::string entry;             ///< there: "M[1,2]"
  int state = 0;
  std::vector<int> rates;  ///< rows that are wrong somewhere
};
const char* name(QuantityFound::Verdict verdict);

/// A number of the mechanism that explains the answers, where it has another value.
struct Estimate {
  std::string name, unit;
  double scene = 0, value = 0, uncertainty = 0;
};

/// One explanation, or a part of one.
struct Explanation {
  std::string rule;
  int link = -1;
  bool at_joint = false;
  std::string sentence;
  std::vector<Estimate> estimates;
};

struct CheckFinding {
  std::vector<Explanation> parts;    ///< one, or a pair
  bool explains = false;             ///< all answers, within what rounding may leave
  double residual = 0;               ///< largest share of that limit (1: all of it)
  double residual_ulp = 0;           ///< the largest misfit [ulp of the largest entry]
  double residual_relative = 0;      ///< the same as a share of that entry
  double left = 0;                   ///< of the misfit, the share that it leaves unexplained
  bool is_first = false;             ///< at no state can it be told from the first finding
  std::vector<std::string> spared;   ///< quantities that are right nevertheless
  std::vector<std::string> unasked;  ///< wrong quantities that it says nothing about
};

/// Where it is wrong, in words; and how it grows.
struct Where {
  std::vector<std::string> terms;   ///< "M: wrong", "c: right", ...
  std::vector<int> rates;           ///< that are wrong in any
  std::vector<std::string> growth;  ///< sentences
};

/// The smallest question that is still answered wrongly.
struct Smallest {
  scene::Scene scene;
  std::vector<std::string> cut;  ///< names of links cut off
  Quantity quantity = Quantity::kM;
  std::vector<double> q, qd, qdd, tau;
  std::vector<std::string> joints;  ///< that are not at rest there
};

/// What it believes the links to be.
struct ModelExamined {
  bool is_told = false;
  std::vector<ModelDifference> differences;
};

struct Examination {
  std::string scene, engine, version;
  bool single = false;  ///< judged as one that computes in single precision
  std::uint64_t seed = 0;
  int states = 0;
  std::string failure;  ///< it failed as a whole: why
  std::vector<std::string> remarks;
  ModelExamined model;
  std::vector<QuantityFound> quantities;
  std::string frame;             ///< whose Jacobian was asked, in words; empty: nobody's
  std::string jacobian_reading;  ///< what was answered in its place, where that is known
  Where where;
  std::vector<CheckFinding> findings;  ///< best first
  long tried = 0, pairs_tried = 0, pairs = 0;
  std::optional<Smallest> smallest;
  std::vector<std::string> link_names, joint_names, rate_labels;

  bool isWrong() const;
  bool isExplained() const;
};

/// The scene as programs are asked about it: every joint of its tree with a rate of its own.
scene::Scene withoutFollowers(scene::Scene scene);

/** Compares the links that the witness believes in, where it tells them, with the scene's; asks it
    at no more than ten chosen states (or at those given), judges each answer against the certified
    truth by what a sweep of its kind may lose, and compares it with what each mistake on record
    would have made of it.

    @param scene  a tree, no joint of which follows another
    @throws scene::InputError  the witness refuses the scene */
Examination examine(const scene::Scene& scene, const WitnessKind& kind,
                    const CheckOptions& options);

}  // namespace dynwitness::crosscheck
