// SPDX-License-Identifier: GPL-3.0-or-later
// The textbook chapter, equation by equation: what it prints, whether that is so, and what is so.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/audit/chapter.hpp"

namespace dynwitness::audit {

/// What came of computing both sides of a statement.
struct Outcome {
  bool zero = false;      ///< the two sides are equal (or the inequality is certain)
  int points = 0;         ///< at which both sides were computed
  double chance = 0;      ///< that different formulas pass as equal
  std::string method;     ///< "prime field", "certified digits", "counterexample", "count"
  std::string residual;   ///< "0 at 1 point modulo p, ...", "not 0: moment (entry 2 of 3)"
  bool our_code = false;  ///< what the code of the repository answers was compared, too
};

/// Computes both sides at random points, a pure function of (name, seed).
using Trial = std::function<Outcome(const std::string& name, std::uint64_t seed)>;

/// Numbers that answer a question, computed when the audit runs, under a caption and heads that the
/// chapter's file gives.
struct Numbers {
  std::string caption;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};
using Rows = std::vector<std::vector<std::string>>;

/** How a statement of data/audit/chapter.toml is computed, found by its id.

        Trials("eq1").printed(exact([](Point& at) { ... })).corrected(exact(...)) */
class Trials {
 public:
  explicit Trials(std::string id) : id(std::move(id)) {}

  /// The two sides of what the chapter says.
  Trials& printed(Trial trial) { return set(&printed_trial, std::move(trial)); }
  /// Those of what is so. Left out where the chapter is right.
  Trials& corrected(Trial trial) { return set(&corrected_trial, std::move(trial)); }
  /// Those of what the chapter says, on points that satisfy the condition.
  Trials& condition(Trial trial) { return set(&condition_trial, std::move(trial)); }
  /// What our code answers, held to the truth of what the equation is about. A fault there is ours:
  /// it decides whether the entry is sound, and not whether the chapter is right.
  Trials& ours(Trial trial) { return set(&ours_trial, std::move(trial)); }
  /// A table beside the verdict.
  Trials& numbers(std::function<Rows()> rows) {
    rows_of_numbers = std::move(rows);
    return *this;
  }

  std::string id;
  Trial printed_trial, corrected_trial, condition_trial, ours_trial;
  std::function<Rows()> rows_of_numbers;

 private:
  Trials& set(Trial* trial, Trial new_trial) {
    *trial = std::move(new_trial);
    return *this;
  }
};

/// A statement, and how it is computed.
struct Claim {
  Statement statement;
  Trials trials;
};

enum class Holds { kTrue, kFalse, kUnderCondition };
const char* name(Holds holds);  ///< "true", "false", "under condition"

/// A claim that was computed.
struct Entry : Statement {
  Holds holds = Holds::kFalse;
  Outcome residual_printed;
  std::optional<Outcome> residual_corrected, residual_condition, residual_ours;
  std::optional<Numbers> numbers;

  std::string kind() const;  ///< "equation", "sentence", "open item", "remark"
  /// Our own part stands: what is called corrected or conditional was computed to be so, what our
  /// code answers is so, and nothing that is wrong lacks a correction.
  bool isSound() const;
  /// What implemented_in answers is one of the sides that were compared.
  bool comparesOurCode() const;
};

/** Computes a claim. `holds` follows from the residuals of what is said and from nothing else:
    printed zero is true; not zero, and zero under the condition, is "under condition"; else
    false. What our code answers is held to the truth beside it: by ours(), or by oursOf() of the
    file that the entry names.
    @throws std::logic_error  the answer of our code decides what the chapter says, or nothing is
    there to compute */
Entry evaluate(const Claim& claim, std::uint64_t seed);

// The trials, a file a group of sections.
std::vector<Trials> frames();              ///< 2, 5
std::vector<Trials> rigidBody();           ///< 6
std::vector<Trials> projections();         ///< 7
std::vector<Trials> recursions();          ///< 4, 8
std::vector<Trials> algorithms();          ///< 9
std::vector<Trials> constrainedSystems();  ///< 10
std::vector<Trials> constraints();         ///< 11.1
std::vector<Trials> tasks();               ///< 11.2 to 13
std::vector<Trials> analytical();          ///< 14
std::vector<Trials> lagrange();            ///< 15, 16
std::vector<Trials> impedances();          ///< 16.1
std::vector<Trials> geometry();            ///< 17
std::vector<Trials> allTrials();

/// Arms, poses and constraints with the eigenvalues of N_0: 11.1. The last column is the verdict.
Rows definitenessRows();

/** Each statement with its trials, in the order of the chapter.
    @throws scene::InputError  a statement without trials or trials without a statement; a
    correction, a condition or a table that one of them has and the other lacks */
std::vector<Claim> joined(const Chapter& chapter, const std::vector<Trials>& trials);

struct Audit {
  std::uint64_t seed = 1;
  Chapter chapter;
  std::vector<Entry> entries;

  int count(Holds holds) const;
  bool isSound() const;
  /// "74 equations: 54 hold, 9 under a condition, 11 wrong; 55 sentences: ...; not counted: 29 that
  /// the chapter leaves open or does not say"
  std::string headline() const;
};

/// @param select  which statements of the bundled chapter to compute; all when empty
/// @throws scene::InputError  as bundledChapter() and joined() do
Audit runAudit(std::uint64_t seed, const std::function<bool(const Statement&)>& select = {});

/// Formulas without their backticks, for plain text.
std::string plain(const std::string& text);

}  // namespace dynwitness::audit
