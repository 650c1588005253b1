// SPDX-License-Identifier: GPL-3.0-or-later
// In what parameters and the lines of a program are counted, as far as that follows from where they
// stand: a scene says numbers, and what each is of.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/mechanism.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::symbolic {

/// kg^kg m^m s^s; an angle counts as a number.
struct Dimension {
  int kg = 0, m = 0, s = 0;
  friend constexpr Dimension operator+(Dimension a, Dimension b) {
    return {a.kg + b.kg, a.m + b.m, a.s + b.s};
  }
  friend constexpr Dimension operator-(Dimension a, Dimension b) {
    return {a.kg - b.kg, a.m - b.m, a.s - b.s};
  }
  friend constexpr bool operator==(Dimension a, Dimension b) {
    return a.kg == b.kg && a.m == b.m && a.s == b.s;
  }
  friend constexpr bool operator!=(Dimension a, Dimension b) { return !(a == b); }
};

inline constexpr Dimension kMass{1, 0, 0}, kLength{0, 1, 0}, kInertia{1, 2, 0}, kForce{1, 1, -2},
    kMoment{1, 2, -2}, kVelocity{0, 1, -1}, kTurning{0, 0, -1};

/// "kg m^2"; "1" of a number. Moments and energies are both N m here.
std::string unitOf(Dimension d);

/** What the parameters of a scene are counted in: "kg", "m/s^2", "rad", "N m/rad". A parameter has
    the unit of the place where it stands; of a product or a sum the unit of what is left of it. A
    bare number in a product has none, one in a sum that of its neighbours. Parameters of which
    nothing follows, or two things, are left out. */
struct ParameterUnit {
  Dimension dimension;
  std::string text;
};
std::map<std::string, ParameterUnit> parameterUnits(const scene::Mechanism& mechanism);

/** The same of all slots of a program: sums have terms of one dimension, products add them.
    Constants are folded, and may have any dimension wherever they stand.
    @param outputs   of program.outputs
    @param of_names  of slots with names, as far as it knows them
    @return  one a slot; none: nothing follows, or two things */
std::vector<std::optional<Dimension>> slotDimensions(
    const Program& program, const Equations& e, const scene::Mechanism& mechanism,
    const std::vector<Dimension>& outputs,
    const std::function<std::optional<Dimension>(const std::string&)>& of_names);

}  // namespace dynwitness::symbolic
