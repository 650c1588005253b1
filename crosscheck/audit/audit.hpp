// SPDX-License-Identifier: GPL-3.0-or-later
// The textbook chapter, equation by equation: what it prints, whether that is so, and what is so.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dynwitness::audit {

/// What came of computing both sides of a statement.
struct Outcome {
  bool zero = false;     ///< the two sides are equal (or the inequality is certain)
  int points = 0;        ///< at which both sides were computed
  double chance = 0;     ///< that different formulas pass as equal
  std::string method;    ///< "prime field", "certified digits", "counterexample", "count"
  std::string residual;  ///< "0 at 1 point modulo p, ...", "not 0: moment (entry 2 of 3)"
};

/// Computes both sides at random points, a pure function of (name, seed).
using Trial = std::function<Outcome(const std::string& name, std::uint64_t seed)>;

/// Numbers that answer a question, computed when the audit runs.
struct Numbers {
  std::string caption;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

/** One statement of the chapter and how to compute it.

    Formulas in the texts stand between backticks, in the notation of
    crosscheck/report/ascii_math.hpp. A statement is told in our own words and symbols.

        Claim("eq1", "5.2", "Force and moment about another point")
            .printed("`m_1 = m_2 + r_12 x f_2`", exact([](auto& at) { ... }))
            .corrected("...", exact(...))
            .why("...")
            .in("recursive/spatial.hpp") */
class Claim {
 public:
  /// @param id       "eq1" ... "eq74", a short name for what has no number
  /// @param section  of the chapter, "5.2"
  /// @param title    what it is about, a few words
  Claim(std::string id, std::string section, std::string title)
      : id(std::move(id)), section(std::move(section)), title(std::move(title)) {}

  /// What the chapter says, and its two sides.
  Claim& printed(std::string text, Trial trial) {
    return set(&printed_text, &printed_trial, std::move(text), std::move(trial));
  }
  /// What is so. Left out where the chapter is right.
  Claim& corrected(std::string text, Trial trial) {
    return set(&corrected_text, &corrected_trial, std::move(text), std::move(trial));
  }
  /// A restriction under which the printed statement holds, tested on points that satisfy it.
  Claim& condition(std::string text, Trial trial) {
    return set(&condition_text, &condition_trial, std::move(text), std::move(trial));
  }
  /// The chapter leaves this open (a TODO, "...", a question): what is printed is then what its
  /// context says or asks.
  Claim& open() {
    is_open = true;
    return *this;
  }
  /// A table beside the verdict.
  Claim& numbers(std::function<Numbers()> table) {
    table_of_numbers = std::move(table);
    return *this;
  }
  /// One or two sentences for a student.
  Claim& why(std::string text) {
    why_text = std::move(text);
    return *this;
  }
  /// The file of this repository that computes it (of the corrected statement, where there is one).
  Claim& in(std::string file) {
    implemented_in = std::move(file);
    return *this;
  }

  std::string id, section, title, printed_text, corrected_text, condition_text, why_text,
      implemented_in;
  bool is_open = false;
  Trial printed_trial, corrected_trial, condition_trial;
  std::function<Numbers()> table_of_numbers;

 private:
  Claim& set(std::string* text, Trial* trial, std::string new_text, Trial new_trial) {
    *text = std::move(new_text);
    *trial = std::move(new_trial);
    return *this;
  }
};

enum class Holds { kTrue, kFalse, kUnderCondition };
const char* name(Holds holds);  ///< "true", "false", "under condition"

/// A claim that was computed.
struct Entry {
  std::string id, section, title, kind, printed, corrected, condition, why, implemented_in;
  Holds holds = Holds::kFalse;
  Outcome residual_printed;
  std::optional<Outcome> residual_corrected, residual_condition;
  std::optional<Numbers> numbers;

  bool isEquation() const { return kind == "equation"; }  ///< or "sentence", "open item"
  /// Our own part stands: what is called corrected or conditional was computed to be so, and
  /// nothing that is wrong lacks a correction.
  bool isSound() const;
};

/** Computes a claim. `holds` follows from the residuals and from nothing else: printed zero is
    true; not zero, and zero under the condition, is "under condition"; else false. */
Entry evaluate(const Claim& claim, std::uint64_t seed);

// The chapter, a file a group of sections.
std::vector<Claim> frames();              ///< 5
std::vector<Claim> rigidBody();           ///< 6
std::vector<Claim> projections();         ///< 7
std::vector<Claim> recursions();          ///< 8
std::vector<Claim> algorithms();          ///< 9
std::vector<Claim> constrainedSystems();  ///< 10
std::vector<Claim> constraints();         ///< 11 to 13
std::vector<Claim> analytical();          ///< 14
std::vector<Claim> lagrange();            ///< 15, 16
std::vector<Claim> geometry();            ///< 16.1, 17

/// Arms, poses and constraints with the eigenvalues of N_0: 11.1.
Numbers definitenessNumbers();

/// All of them, in the order of the chapter.
std::vector<Claim> allClaims();

struct Audit {
  std::uint64_t seed = 1;
  std::vector<Entry> entries;

  int count(Holds holds) const;
  bool isSound() const;
  /// "74 equations and 20 further statements: 60 hold, 5 under a condition, 29 are wrong"
  std::string headline() const;
};

/// @param select  which claims to compute; all when empty
Audit runAudit(std::uint64_t seed, const std::function<bool(const Claim&)>& select = {});

/// Formulas without their backticks, for plain text.
std::string plain(const std::string& text);

}  // namespace dynwitness::audit
