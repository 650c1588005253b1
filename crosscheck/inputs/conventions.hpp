// SPDX-License-Identifier: GPL-3.0-or-later
// Coordinates of spherical and floating joints as other engines have them, there and back.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/mechanism.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// Whose coordinates spherical and floating joints have; all other joints have one q for one qd.
enum class CoordinateConvention {
  kDynwitness,
  kPinocchio,
  kMujoco,
  kDrake,
  kRbdl,
  kDart,
  kSimbody
};
inline constexpr CoordinateConvention kAllConventions[] = {
    CoordinateConvention::kDynwitness, CoordinateConvention::kPinocchio,
    CoordinateConvention::kMujoco,     CoordinateConvention::kDrake,
    CoordinateConvention::kRbdl,       CoordinateConvention::kDart,
    CoordinateConvention::kSimbody};
/// "dynwitness", "pinocchio", ...
const char* name(CoordinateConvention convention);
/// @throws scene::InputError  none of them, with all
CoordinateConvention conventionNamed(const std::string& text);
std::vector<std::string> conventionNames();
/// Whether conventions differ for the mechanism: a joint of it is spherical or floating.
bool hasOrientations(const scene::Mechanism& mechanism);

/** A mechanism's coordinates by a convention, "theirs", beside those of scene::State, "ours".

    Let R turn a joint's link axes into its joint axes, v be the velocity of the link's origin and w
    its angular velocity, both in link axes. All conventions have rates u = T (v, w) with an
    orthogonal T: it sorts, and turns by R what they have in joint axes. Hence

        qd   u  = T qd                       M        T M T'
        qdd  u' = T (qdd + (w x v, 0))       c        T (c - M (w x v, 0))
                                             g, tau   T g, T tau

    where w x v is there only if they have v in joint axes, so that M u' + c + g = tau holds in
    theirs, too, and tau' u stays the power. A Jacobian is J T'. Forces of a floating joint are
    hence those on its link, in the axes of the velocities that they belong to, moments about its
    origin.

    The axes that the joint moves from are its own joint frame's, as in all of these engines but
    MuJoCo, whose free joints move from the world. */
class Coordinates {
 public:
  /// @param mechanism  must outlive it
  /// @throws scene::InputError  a joint whose coordinates are others there and are not converted:
  ///   planar and cylindrical ones, and for MuJoCo floating ones that do not move from the world
  Coordinates(const scene::Mechanism& mechanism, CoordinateConvention convention);

  CoordinateConvention convention() const { return convention_; }
  bool isOurs() const { return convention_ == CoordinateConvention::kDynwitness; }
  /// How many numbers q has; followers have none.
  int positions() const { return positions_; }
  /// Which of our rates their rate `k` is, but for the axes.
  int place(int k) const { return places_[static_cast<std::size_t>(k)]; }

  /** Their numbers as a state. Quaternions need not be of length 1.
      @param q      positions() numbers
      @param state  qd, qdd and tau are theirs before, and ours after; x is set
      @throws scene::InputError  a quaternion is zero */
  void read(const std::vector<double>& q, scene::State<double>* state) const;
  /// q of a state: quaternions of length 1, rotation vectors of at most pi, |pitch| <= pi / 2.
  std::vector<double> positionsOf(const scene::State<double>& state) const;

  /// T x: rates, forces, a row of a Jacobian.
  std::vector<double> theirs(const scene::State<double>& state, const std::vector<double>& x) const;
  /// T' x.
  std::vector<double> ours(const scene::State<double>& state, const std::vector<double>& x) const;
  /// (w x v, 0) of each joint that has v in joint axes, in the order of our rates; else 0.
  std::vector<double> turning(const scene::State<double>& state) const;

 private:
  struct Body {  ///< of a spherical or floating joint
    std::string joint;
    int slot, rate, at, w;  ///< first of ours; first of theirs, and their w (quaternions only)
    bool floats;
  };
  std::vector<double> sorted(const scene::State<double>& state, const std::vector<double>& x,
                             bool to_theirs) const;

  const scene::Mechanism* mechanism_;
  CoordinateConvention convention_;
  int positions_ = 0;
  std::vector<Body> bodies_;
  std::vector<std::pair<int, int>> plain_;  ///< other slots: ours, theirs
  std::vector<int> places_;
};

}  // namespace dynwitness::crosscheck
