// SPDX-License-Identifier: GPL-3.0-or-later
// A family of mechanisms with one dial: from harmless to where methods break, and why they do.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/witnesses/certain_digits.hpp"
#include "crosscheck/witnesses/mechanism_roads.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck::stability {

using crosscheck::kFewestDigits;  // with fewer, a method is said to have broken
/// How many mechanisms, alike but for their numbers, stand at one severity: a rounding that happens
/// to be exact in one of them is not in all. The worst counts.
inline constexpr int kVariants = 3;

/// What a theory needs to know of the numbers that a method computes with.
struct Arithmetic {
  const char* name;
  double unit;        ///< unit roundoff
  double largest;     ///< largest number
  double smallest;    ///< smallest number above zero
  bool rounds_state;  ///< whether the state, told in double, is rounded first
};
const Arithmetic& inDouble();
const Arithmetic& inFloat();

/// A mechanism and what it is asked.
struct Case {
  scene::Scene scene;
  scene::State<double> state;
  std::vector<NamedRoad> roads = {};  ///< of a family that asks for a MechanismQuantity
};

/// By which road a method comes to qdd; a theory may be about one of them.
enum class Road { kAny, kMassMatrix, kSweep };

struct Theory {
  Road road = Road::kAny;
  std::string formula;  ///< plain text: the error, and the reason
  /// Expected |answer - truth| / largest |truth|, of rounding errors that are each uniform up to
  /// the unit roundoff. Empty: none is claimed, and `formula` says why.
  std::function<double(double severity, const Arithmetic&)> error;
  /// Those that it is about, whatever their road; none: all of the road that no other names.
  std::vector<std::string> methods = {};

  bool isClaimed() const { return static_cast<bool>(error); }
};

/// What should hold and is measured, with its own theory: of a step through time, of a projector.
struct Measure {
  std::string name, formula;
  std::function<double(double severity)> theory;  ///< error as theory has it
  /// Error of what was computed; what it throws is why it stopped.
  std::function<double(double severity)> measured;
  const Arithmetic* numbers = &inDouble();
};

struct Family {
  std::string name;       ///< [a-z_]: files are called so
  std::string title;      ///< "A light cart under a heavy pole"
  std::string dial;       ///< what the severity s is: "mass of the pole over that of the cart"
  std::string unit;       ///< of s; "": a number
  double from, to;        ///< of s
  bool is_whole = false;  ///< s is a whole number
  /// Too large for what derives or compiles an equation a mechanism.
  bool is_large = false;
  Quantity quantity = Quantity::kQdd;
  /// Of a whole mechanism: this is asked in place of `quantity`, by mechanismRoads().
  std::optional<MechanismQuantity> whole = {};
  /// @param s  the severity as an exact decimal; the mechanism's numbers are decimals in it
  std::function<Case(const std::string& s, int variant)> make;
  /// One that names a method counts, else the first that is about its road; none: none.
  std::vector<Theory> theories;
  /// Of a family that measures what should hold: these, in place of `make`, `quantity` and
  /// `theories`; and what their digits are of.
  std::vector<Measure> measures;
  std::string measured;   ///< "the largest eigenvalue of a step, which should be 1 in size"
  double narrow = 1.1;    ///< between held and broken, where bisection ends
  std::string mechanism;  ///< a paragraph: why digits are lost
  std::string survivor;   ///< which method survives, and why
};

/// In the order of the atlas.
const std::vector<Family>& families();

/// The severity as the exact decimal that scenes are made with: three digits, or a whole number.
std::string decimalOf(double severity, bool is_whole);

// one file a kind
std::vector<Family> familiesOfMasses();
std::vector<Family> familiesOfShapes();
std::vector<Family> familiesOfPoses();
std::vector<Family> familiesOfMotions();
std::vector<Family> familiesOfConstraints();
std::vector<Family> familiesOfLaws();
std::vector<Family> familiesInTime();

}  // namespace dynwitness::crosscheck::stability
