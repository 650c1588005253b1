// SPDX-License-Identifier: GPL-3.0-or-later
// What a crosscheck found: plain data, written by the checks, read by the report.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/motion/drift.hpp"
#include "crosscheck/scalars/scalar.hpp"
#include "crosscheck/verdicts/ledger.hpp"
#include "crosscheck/witnesses/witness_info.hpp"

namespace dynwitness::crosscheck {

enum class Verdict { kAgree, kDisagree, kNotAnswerable };
/// "agree", "disagree", "not answerable"
const char* name(Verdict verdict);

/// What a whole run says. Each but the first two outweighs those before it.
enum class RunVerdict {
  kAgree,          ///< everything that can be compared was, and agrees
  kNotAnswerable,  ///< nothing could be compared
  kIncomplete,     ///< what was compared agrees; too much that can be compared was not (Coverage),
                   ///< or a start leaves closures open, so that the closed mechanism was not met
  kProvesNothing,  ///< the run's own control, a known fault, was not found (Control)
  kDisagree,
};
/// "agree", "not answerable", "incomplete", "proves nothing", "disagree"
const char* name(RunVerdict verdict);
/// Of the program: 0; 3; 1; 3; 1.
int exitStatus(RunVerdict verdict);

/// What kind of question a check is.
enum class CheckKind {
  kLaw,      ///< of mechanics, or of a study: CheckResult::law is its name
  kSame,     ///< do two witnesses say the same?
  kTruth,    ///< is a witness within its bounds of the certified truth?
  kTable,    ///< does a witness say what is printed?
  kWitness,  ///< does a witness testify, or answer one quantity?
  kRefusal,  ///< can a witness hold the scene at all? Not answerable: nothing was asked of it
  kLeftOut,  ///< a part of the crosscheck that this scene does not get: law is its name
};
/// "same", "truth", "table", "witness" (kRefusal too); "" for those that have names of their own.
const char* name(CheckKind kind);

/// What worst and limit of a check are counted in.
enum class Unit {
  kUlp,
  kAbsolute,       ///< the quantity's own unit: its limit is not below its largest entry
  kExact,          ///< over the prime field, where a residual is zero or is not
  kBoundPerPivot,  ///< error bound of a pivot of M, in pivots
  kObservedOrder,
  kPowerOfStepError,  ///< by which a drift falls with the error that a step may have
  kRoundingOfSteps,
  kDirections,
  kPaths,
  // of published numbers
  kPrintedDigit,
  kStatedAccuracy,
  kSourceRounding,
};
/// "ulp", "exact", "observed order (at least)", ...
std::string name(Unit unit);
/// The same without " (at least)".
const char* measure(Unit unit);
/// The limit is what worst must reach, not what it must stay below.
bool isLimitFromBelow(Unit unit);

/** One check over all states.

    A state at which nothing can be judged is voided: it is counted, and says nothing about the
    others. The check is not answerable when that leaves none. A voided state is excused when there
    is nothing that could be compared, whoever tried; Coverage says when.

    Residuals are counted in ulp: |left - right| / (eps * scale), eps = 2^-52, scale = the largest
    magnitude in the compared vector or matrix. `limit` is the error bound of the same computation
    at that state, in the same unit. Both belong to the entry and state that use the largest share
    of their limit; the check agrees when that share, `ratio`, is at most 1. */
struct CheckResult {
  /// The verdict without rounding: both sides over the integers modulo a prime.
  struct Exact {
    std::uint64_t prime = 0;
    int points = 0;                ///< random points at which the residual was evaluated
    int discarded = 0;             ///< points drawn again because a divisor was zero there
    double degree = 0;             ///< bound of the residual's degree in the random inputs
    double error_probability = 1;  ///< chance at most that different formulas pass all points
    bool residual_zero = false;
    std::string parameters;  ///< "as written", or "random": then for every mechanism like this
  };

  CheckKind kind = CheckKind::kLaw;
  std::string law;          ///< its name, where the kind has none
  std::string statement;    ///< one line: what must hold, as a formula
  std::string quantity;     ///< "M", "c", "g", "tau", "qdd", "kinetic", ...
  std::string left, right;  ///< witnesses; right is empty for an identity of one witness
  bool left_is_control = false, right_is_control = false;  ///< the run's own control, see Control
  Unit unit = Unit::kUlp;                                  ///< of worst and limit
  int states = 0;        ///< at which it was asked; cases of a table, points over the field
  int voided = 0;        ///< of them: not judged, or not in all entries
  int excused = 0;       ///< of the voided: there is nothing to compare
  bool is_idle = false;  ///< the mechanism has too little for this law: there is nothing to ask
  int first_voided =
      0;  ///< index of the first voided state that is not excused, or else of the first
  std::string voided_reason;  ///< of that state
  double worst = 0;           ///< residual that uses the largest share of its limit [unit]
  double limit = 0;           ///< that limit [unit]
  double ratio = 0;           ///< largest residual / limit over all states and entries
  // of any entry at any state, in the quantity's own unit
  double seen = 0;          ///< largest residual
  double loosest = 0;       ///< largest limit
  double largest = 0;       ///< largest magnitude, or magnitude of the terms of an equation
  int worst_state = 0;      ///< index of the state of `ratio`; with the seed it can be drawn again
  std::string worst_entry;  ///< "M[1,2]": where in the vector or matrix `ratio` is
  std::uint64_t seed = 0;
  Verdict verdict = Verdict::kAgree;
  std::string reason;  ///< for kDisagree and kNotAnswerable
  /// Of a disagreement with the certified truth: the answer that is off by the largest share of the
  /// largest entry, and what is right there.
  struct Off {
    std::string entry, joint;  ///< "tau[3]"; joint: empty where the entry belongs to none
    std::string unit;          ///< of both numbers: "N m"
    int state = 0;
    double said = 0, right = 0;
  };
  std::optional<Off> off;
  /// Of one: joints whose own entries (c, g, tau, qdd, the diagonal of M) are beyond their limit.
  std::vector<std::string> wrong_joints;
  std::optional<Exact> exact;
  std::string no_exact;          ///< why the field, which was asked, could not decide
  std::optional<double> digits;  ///< fewest correct ones, where the check is against the truth
  std::optional<double>
      condition;  ///< of M, the largest met, where M is solved with (backward_error.hpp)
  /// Beyond rounding, within what a witness documents as its loss: agrees, and its limit hides more
  /// than others do.
  bool known_loss = false;

  /// "same", "truth", ..., or the name of the law.
  std::string name() const;
  /// Of worst and limit: name(unit), or the quantity's own.
  std::string unitName() const;
  /// From ulp to the quantity's own unit, where an ulp of it says nothing: rounding alone could
  /// have left all that is there.
  /// @param largest_there  the largest magnitude at the state of `ratio`
  void useItsOwnUnit(double largest_there);
  /// Both ask the same question of the same witnesses.
  bool asksTheSameAs(const CheckResult& other) const;
  /// It stands for checks that were not asked.
  bool asksNothing() const { return kind == CheckKind::kRefusal || kind == CheckKind::kLeftOut; }
  /// States that were judged.
  int judged() const { return states - voided; }
  /// Counts a voided state; there is nothing to compare when `excused`.
  void addVoided(int state, const std::string& why, bool is_excused);

  /** How much wider the loosest limit is than the largest residual: what the check can miss,
      counted in what it sees. Less than one ulp of the largest entry of all states cannot be
      expected of any computation in double, so a smaller residual counts as one. Empty where
      nothing is held to rounding, and where both sides are the same numbers. */
  std::optional<double> limitOverSeen() const;
  /// One ulp of `largest`; of 1 where everything is zero.
  double ulp() const;
};

/** How much of one quantity was compared. A comparison is one check at one state.

    Every comparison ought to be possible but these, which are excused:
    - those of a witness that cannot hold the scene at all (a kind of joint that it does not have,
      loads, a scene that its format cannot spell): the check "witness" gives the reason, and none
      of its
      comparisons is asked;
    - those of a quantity that does not exist: M is singular at the state, certified by the
      enclosure of a pivot, and qdd and the laws that divide by an inertia have no value; over the
      field, a divisor
      that is zero as a formula; a law that needs more than the mechanism has (another root, where
      there is one body);
    - energy along a path where nothing moves, or which the fixed steps do not resolve.
    An error bound that runs away, a witness that throws at a state that others answer, an enclosure
    that does not get sharp are held against the run: when more than a tenth of the comparisons of a
    quantity of a scene are missing in this way, the run is incomplete. */
struct Coverage {
  std::string quantity;
  long asked = 0, voided = 0, excused = 0;
  std::string reason;  ///< of the first voided comparison, missing ones before excused ones

  long missing() const { return voided - excused; }
  bool isThin() const { return 10 * missing() > asked - excused; }
  bool isNowhere() const { return asked > 0 && voided == asked; }  ///< for whatever reason
};
/// By quantity, in the order of the checks.
std::vector<Coverage> coverageOf(const std::vector<CheckResult>& checks);

/// By which a control is judged.
enum class Road { kPairs, kTruth, kField, kTable };
/// "pairs", "truth", "field", "table"
const char* name(Road road);

inline constexpr const char* kControl = "control";  ///< how reports call that witness

/** The run's own control: a witness whose kilogram is too heavy by `size`. Then M, c, g, tau,
    reactions, energies and momentum are too large by just that, entry by entry (they have the
    dimension of a mass); for qdd inertia alone is too large, weights are not. It is judged as the
    witnesses are, and must be found; crosscheck/verdicts/control.hpp says how large it is. */
struct Control {
  std::string quantity;
  double size = 0;                  ///< relative; the largest planted
  std::vector<Road> found, missed;  ///< by these
  std::vector<std::string>
      blind;            ///< witnesses whose pairs with the control have limits too wide for it
  std::string nothing;  ///< why nothing can be planted; empty: something was
};

/** What is left of one quantity by one witness, over the states of a crosscheck.

    Digits are counted against the quantity as a whole,
        digits = -log10( max_i |x_i - truth_i| / max_i |truth_i| ),
    because an entry that should be 0 has no digits of its own. Distance to the truth means to the
    farthest point of its enclosure, so no digit is counted that is not there. Digits that a
    scalar has no room for are not counted either: 9 in float, 17 in double, 21 in long double
    (max_digits10). */
struct DigitsResult {
  std::string witness, quantity;
  Scalar scalar = Scalar::kDouble;      ///< our sweeps in float and long double too
  int states = 0;                       ///< that have digits: the truth is certified and not 0
  std::optional<double> worst, median;  ///< digits over those states; empty when there are none
  /// Fewest digits of a single entry against itself, over entries that are not 0.
  std::optional<double> worst_single;
  int worst_state = 0;      ///< where `worst` is
  std::string worst_entry;  ///< the entry farthest from the truth there
  bool is_control = false;  ///< the witness is the run's own control
};

/// What a person should know: who stands alone in a disagreement, or who loses digits and why.
struct Finding {
  /// kOpenStart: the scene's own start leaves closures open. kEngine: a program that testifies has
  /// failed, or does something in a way of its own.
  enum class Kind { kDisagreement, kKnownLoss, kOpenStart, kEngine };
  Kind kind = Kind::kDisagreement;
  std::string scene, quantity;
  std::string witness;           ///< the one that stands alone; empty when no single one does
  std::string text;              ///< a sentence for people
  std::optional<double> digits;  ///< of a known loss: how many are left
};
/// "disagreement", "known loss", "open start", "engine"
const char* name(Finding::Kind kind);

/// The derived equations, ready to be shown; empty when they are too long to read.
struct Equations {
  std::string summary;  ///< "closed form, 34 terms" or "573 multiplications, 412 additions"
  std::string kinetic, potential;  ///< MathML
  std::vector<std::string> lines;  ///< MathML, one equation each: M entries, c, g
};

/** A published motion of a scene, or one found by another road of our own where none is,
    beside what simulate() makes of it. */
struct PublishedMotion {
  /// Of one column: the value that lies closest to its limit, or passes it furthest.
  struct Entry {
    std::string of;  ///< "q2 [rad]", "rod3 (0, 0, l) x [m]"
    double time = 0, published = 0, ours = 0, difference = 0, limit = 0;
    double digits = 0;  ///< decimal ones to which they agree, of the largest published
  };
  std::string title, source;
  std::string own;     ///< by which road we found the figures; empty: they are printed
  std::string note;    ///< why the limit
  std::string moved;   ///< file that is moved in place of the scene, beside the table; empty: none
  std::string method;  ///< of the simulation
  double duration = 0, step_error = 0;
  long steps = 0;
  int values = 0;    ///< compared
  double ratio = 0;  ///< largest difference / limit of all values
  std::vector<Entry> entries;
  std::string failure;  ///< why there is no motion to compare; empty: there is
};

struct SceneResult {
  std::string name, title, source, file;
  int dof = 0, links = 0;
  std::vector<std::string> link_names, joint_labels;  ///< one a link; label of the root is empty
  std::vector<int> parents;                           ///< -1 for the root
  std::vector<std::string> not_modelled;
  std::optional<Ledger> ledger;
  Equations equations;
  std::vector<CheckResult> checks;
  std::vector<DigitsResult> digits;
  std::vector<Finding> findings;
  std::vector<Control> controls;  ///< by quantity
  std::optional<Drift> drift;
  std::vector<PublishedMotion> motions;
};

struct CrosscheckResult {
  std::vector<WitnessInfo> witnesses;
  std::vector<SceneResult> scenes;
  std::uint64_t seed = 0;
  int states = 0;
  std::string command;  ///< reproduces this result

  int checkCount() const;  ///< answered checks
  int exactCount() const;  ///< checks whose residual is zero over the prime field
  int count(Verdict verdict) const;
  RunVerdict verdict() const;
  /// Over all scenes.
  std::vector<Coverage> coverage() const;
  /// Quantities of a scene of which too much is missing: "qdd of chain".
  std::vector<std::string> thinlyCovered() const;
  /// Quantities of a scene that no comparison reached: "qdd of chain".
  std::vector<std::string> comparedNowhere() const;
  /// Scenes whose own start leaves closures open.
  std::vector<std::string> openAtStart() const;
  /// "control: a kilogram off by 1e-10 was found in M, c, ... of all 46 scenes by pairs, truth,
  /// field"
  std::string controlLine() const;
  bool controlMissed() const;
  /// The check in ulp with the largest ratio, and its scene. Limits that contain a known loss do
  /// not compete: they say nothing about rounding.
  std::pair<const SceneResult*, const CheckResult*> worst() const;
  /// A witness that loses digits as it documents: the worst finding, and the number of scenes.
  struct KnownLoss {
    const WitnessInfo* witness;
    const Finding* worst;
    int scenes;
  };
  std::vector<KnownLoss> knownLosses() const;
  /// "14 scenes, 1212 checks, all agree; not answered: qdd 3 of 660 comparisons (..); closest .."
  /// In a disagreement what causes it takes the place of what comes closest.
  std::string headline() const;

 private:
  /// "one cause, in arm: simbody stands alone in g, .."
  std::string causesLine() const;
};

/// For lists whose order is that of first appearance.
template <typename T>
void addOnce(std::vector<T>& list, const T& one) {
  if (std::find(list.begin(), list.end(), one) == list.end()) list.push_back(one);
}

/// "a, b and c"
std::string listed(const std::vector<std::string>& words);

}  // namespace dynwitness::crosscheck
