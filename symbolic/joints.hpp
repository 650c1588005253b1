// SPDX-License-Identifier: GPL-3.0-or-later
// What a joint does to the body that it carries: where q puts it, and how qd moves it.
#pragma once

#include <string>
#include <vector>

#include "symbolic/frames.hpp"
#include "symbolic/vectors.hpp"

namespace dynwitness::symbolic {

/** A joint moves along or about one coordinate axis of its body, or freely. Cylindrical, universal
    and planar joints are turns and slides in a row. */
struct Joint {
  enum class Kind { kTurn, kSlide, kScrew, kBall, kFree };

  std::string name;
  Kind kind;
  int rate, slot;  ///< first rate (of a follower: its leader's) and first position
  int axis;        ///< in the body's frame: 0, 1, 2
  bool reversed;   ///< the joint's direction is minus that axis
  bool follows;    ///< another joint: it has no rate of its own
  Value ratio;     ///< of a follower's rate to its leader's
  Value rotor;     ///< gear_ratio^2 rotor_inertia
  Value spin;      ///< gear_ratio rotor_inertia of a gyroscopic rotor, otherwise 0
  Value stiffness, rest, pitch;

  bool turns() const { return kind != Kind::kSlide; }
  bool hasOneRate() const { return kind != Kind::kBall && kind != Kind::kFree; }
  int rates() const { return hasOneRate() ? 1 : kind == Kind::kBall ? 3 : 6; }
  int slots() const { return hasOneRate() ? 1 : kind == Kind::kBall ? 4 : 7; }
  int quaternion() const { return kind == Kind::kFree ? slot + 3 : slot; }
};

/// The joint's own motion: a turn by q, a shift by q, or both.
FrameSteps jointSteps(Graph* graph, const Joint& joint);

/// How far a joint has moved from the rest position of its spring.
Value stretch(Graph* graph, const Joint& joint);

/// One thing that a joint does: a turn about a coordinate axis of its body, a shift along it, or
/// both, with this rate.
struct JointAxis {
  int coordinate;
  bool turns, shifts;
  Value rate;
};
std::vector<JointAxis> jointAxes(Graph* graph, const Joint& joint);

/** X_i of the joint's own rates, one after the other: the position of a joint of one rate,
        dp/dt = R v,   dR/dt = R [w]x
    otherwise. A follower has none. */
std::vector<Direction> jointDirections(Graph* graph, const Joint& joint);

}  // namespace dynwitness::symbolic
