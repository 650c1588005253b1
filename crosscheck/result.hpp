// SPDX-License-Identifier: GPL-3.0-or-later
// What a crosscheck found: plain data, written by the checks, read by the report.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dynwitness::crosscheck {

enum class Verdict { kAgree, kDisagree, kNotAnswerable };
/// "agree", "disagree", "not answerable"
const char* name(Verdict verdict);

/** One check over all states.

    Residuals are counted in ulp: |left - right| / (eps * scale), eps = 2^-52, scale = the largest
    magnitude in the compared vector or matrix. `limit` is the error bound of the same computation at
    that state, in the same unit. Both belong to the entry and state that use the largest share of their
    limit; the check agrees when that share, `ratio`, is at most 1. */
struct CheckResult {
  /// The verdict without rounding: both sides over the integers modulo a prime.
  struct Exact {
    std::uint64_t prime = 0;
    int points = 0;               ///< random points at which the residual was evaluated
    int discarded = 0;            ///< points drawn again because a divisor was zero there
    double degree = 0;            ///< bound of the residual's degree in the random inputs
    double error_probability = 1; ///< chance at most that different formulas pass all points
    bool residual_zero = false;
    std::string parameters;       ///< "as written", or "random": then for every mechanism like this
  };

  std::string check;      ///< "same", "truth" (distance to the certified one), or the name of an identity
  std::string statement;  ///< one line: what must hold, as a formula
  std::string quantity;   ///< "M", "c", "g", "tau", "qdd", "kinetic", ...
  std::string left, right;  ///< witnesses; right is empty for an identity of one witness
  std::string unit = "ulp";  ///< of worst and limit; a published table counts in its last digit
  int states = 0;
  double worst = 0;       ///< residual that uses the largest share of its limit [unit]
  double limit = 0;       ///< that limit [unit]
  double ratio = 0;       ///< largest residual / limit over all states and entries
  int worst_state = 0;    ///< index of the state of `ratio`; with the seed it can be drawn again
  std::string worst_entry;  ///< "M[1,2]": where in the vector or matrix `ratio` is
  std::uint64_t seed = 0;
  Verdict verdict = Verdict::kAgree;
  std::string reason;     ///< for kDisagree and kNotAnswerable
  std::optional<Exact> exact;
  std::optional<double> digits;  ///< fewest correct ones, where the check is against the truth
  /// Beyond rounding, within what a witness documents as its loss: agrees, and its limit hides more than
  /// others do.
  bool known_loss = false;
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
  std::string scalar;                   ///< "double"; our sweeps in "float" and "long double" too
  int states = 0;                       ///< that have digits: the truth is certified and not 0
  std::optional<double> worst, median;  ///< digits over those states; empty when there are none
  /// Fewest digits of a single entry against itself, over entries that are not 0.
  std::optional<double> worst_single;
  int worst_state = 0;      ///< where `worst` is
  std::string worst_entry;  ///< the entry farthest from the truth there
};

/// What a person should know: who stands alone in a disagreement, or who loses digits and why.
struct Finding {
  enum class Kind { kDisagreement, kKnownLoss };
  Kind kind = Kind::kDisagreement;
  std::string scene, quantity;
  std::string witness;  ///< the one that stands alone; empty when no single one does
  std::string text;     ///< a sentence for people
  std::optional<double> digits;  ///< of a known loss: how many are left
};

/// Energy along simulated paths of one scene with one integrator.
struct Drift {
  struct Path {
    double step = 0;             ///< [s]
    double worst = 0;            ///< largest |E - E0| / scale along the path
    std::vector<double> time;    ///< [s], thinned for charts
    std::vector<double> error;   ///< |E - E0| / scale at those times
  };
  std::string method;            ///< "runge_kutta4"
  int method_order = 0;
  double duration = 0;           ///< [s]
  double scale = 0;              ///< [J]: the largest kinetic energy seen along the finest path
  double observed_order = 0;     ///< of the worst drift, from the two finest steps above rounding
  std::vector<Path> paths;       ///< step sizes falling
};

/// The derived equations, ready to be shown; empty when they are too long to read.
struct Equations {
  std::string summary;  ///< "closed form, 34 terms" or "573 multiplications, 412 additions"
  std::string kinetic, potential;             ///< MathML
  std::vector<std::string> lines;             ///< MathML, one equation each: M entries, c, g
};

struct SceneResult {
  std::string name, title, source, file;
  int dof = 0, links = 0;
  std::vector<std::string> link_names, joint_labels;  ///< one a link; label of the root is empty
  std::vector<int> parents;                           ///< -1 for the root
  std::vector<std::string> not_modelled;
  Equations equations;
  std::vector<CheckResult> checks;
  std::vector<DigitsResult> digits;
  std::vector<Finding> findings;
  std::optional<Drift> drift;
};

struct WitnessInfo {
  std::string name, version, method;  ///< method: one line, how it computes
  bool present = true;                ///< false: not found when dynwitness was configured
  /// The convention card: lines "label: text", how this witness spells what all are asked about, how it
  /// reads the mechanism, and where it is known to lose digits, why, and what removes that.
  std::string conventions = {};

  /// The text of the card's line of this label, or "".
  std::string convention(const std::string& label) const;
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
  Verdict verdict() const;  ///< kDisagree when any check disagrees
  /// The check with the largest ratio, and its scene. Limits that contain a known loss do not compete:
  /// they say nothing about rounding.
  std::pair<const SceneResult*, const CheckResult*> worst() const;
  /// A witness that loses digits as it documents: the worst finding, and the number of scenes.
  struct KnownLoss {
    const WitnessInfo* witness;
    const Finding* worst;
    int scenes;
  };
  std::vector<KnownLoss> knownLosses() const;
  /// "14 scenes, 1212 checks, all agree; worst 7.4 ulp: ..."
  std::string headline() const;
};

}  // namespace dynwitness::crosscheck
