// SPDX-License-Identifier: GPL-3.0-or-later
// The derivation of the equations of motion as named steps that a person can follow, each with an
// exact check that it holds, made anew in every run.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/mechanism.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/formula.hpp"

namespace dynwitness::symbolic {

/// What the lines of a program that follow are: "link_3: velocity t4 [m/s]; ...".
struct LineGroup {
  struct Kind {
    std::string noun;  ///< "velocity"; empty: nothing is known of them
    std::vector<std::string> names;
    std::string unit;
  };
  std::string of;  ///< whose they are; empty: nobody's
  std::vector<Kind> kinds;
};

/// An equation, and what its sides are in the graph, where they are more than a name.
struct StepEquation : Equation {
  std::optional<Node> left_value, right_value;
  std::vector<Node> entries = {};         ///< of a matrix on the right, row by row
  std::optional<LineGroup> heading = {};  ///< before the first line of a group

  /// A line of a program, which stands for nothing but itself.
  bool isLine() const { return !left_value && !right_value && entries.empty(); }
};

/// A parameter of the scene where it is used first: m1 = 2 kg.
struct ShownParameter {
  std::string name;
  std::string decimal;  ///< its value, where that is a decimal number
  Formula value;        ///< otherwise: 1/3, pi/6
  std::string unit;     ///< empty: unknown, or none
};

struct Step {
  std::string name;      ///< "kinetic energy", "c_1", ...
  std::string sentence;  ///< what is done, and from what
  std::vector<StepEquation> equations;
  std::string check;          ///< what was checked, exactly
  bool holds = false;         ///< its outcome in this run
  std::string quantity = {};  ///< "M", "c" or "g", where it leads to one of these
  /// Entries that are 0 and stand in no equation, those with the same reason together.
  std::vector<std::string> zeros = {};
  std::vector<std::string> remarks = {};  ///< said after the equations
  bool is_beside = false;                 ///< of another road, shown beside the others
  std::vector<ShownParameter> parameters = {};
};

struct Derivation {
  std::vector<std::string> joints;
  bool closed_form = false;  ///< all of it; otherwise what is long is a straight-line program
  std::vector<Step> steps;
  scene::Mechanism mechanism;
  std::shared_ptr<const Equations> equations;  ///< what the steps are of
  std::vector<std::string> positions = {};     ///< what each q_k is called; empty: q1, q2, ...
  std::vector<std::string> rates = {};         ///< the position that each qd_k is the rate of

  bool holds() const;
  /// A component of the state as it is called here.
  Formula input(Input input, int joint) const;
};

/// What the parameters are, each with the first step that has it in an equation.
void placeParameters(Derivation* derivation);

/// Whether derivation() of this mechanism lists closed forms, a step an equation.
bool hasClosedForm(const scene::Mechanism& mechanism);

/** Derives M, c and g of a mechanism step by step. Up to kClosedFormJoints joints the steps are
    closed forms, derived by GiNaC and compared with the graph's derivatives by normal form; they
    begin with the positions and velocities of the links, differentiated from the placements. With
    more joints each entry that is short is a closed form (ClosedAlgebra::shortFormula), the others
    are lines of named intermediates, and all are checked by identities in exact rational
    arithmetic at `points` random states. Not thread safe (GiNaC is not).
    @param linearized  the equations of motion to first order beside a motion, too
    @throws std::invalid_argument  linearized without closed forms */
Derivation derivation(const scene::Mechanism& mechanism, bool linearized = false, int points = 2);

/// A derivation as plain text, or as the body of an HTML page with MathML or of a LaTeX document
/// (amsmath; \hangpara begins an equation, a paragraph in which TeX may break lines).
/// @param checks  with what was checked
std::string print(const Derivation& derivation, Style style, bool checks = true);

/// A sentence as one of the styles needs it.
std::string printText(const std::string& text, Style style);

/// A closed form that is short enough to be shown, for a report.
struct ShownEquation {
  enum class Of { kKinetic, kPotential, kMotion };
  Of of;
  std::string name;    ///< "T", "V", "M11", ..., "c1", ..., "g1", ...
  std::string mathml;  ///< a whole `math` element
};
/// T, V, the upper triangle of M, c and g; empty when the mechanism has too many joints for closed
/// forms or one of the equations is longer than `limit` characters as plain text.
std::vector<ShownEquation> shortClosedForm(const scene::Mechanism& mechanism,
                                           std::size_t limit = 600);

}  // namespace dynwitness::symbolic
