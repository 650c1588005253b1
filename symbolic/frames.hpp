// SPDX-License-Identifier: GPL-3.0-or-later
// Where a frame B stands in a frame A, as expressions.
//
// The way from A to B is a row of steps, turns and shifts, each in the axes that those before it
// have reached. A turn R_AB gives coordinates in two axes:  v_A = R_AB v_B  (turnedBack),
// v_B = R_AB' v_A  (turned).
#pragma once

#include <array>
#include <vector>

#include "scene/mechanism.hpp"
#include "symbolic/numbers.hpp"
#include "symbolic/vectors.hpp"

namespace dynwitness::symbolic {

/// One elementary motion of a frame, as scene::Step, with nodes for its numbers; or any turn.
struct FrameStep {
  bool is_rotation;
  int axis;    ///< rotation: 0, 1, 2 for x, y, z; -1: the turn that `columns` are
  Value c, s;  ///< rotation: cosine and sine of its angle
  Vector3 translation;
  std::array<Vector3, 3> columns{};  ///< axis -1: R, from coordinates after it to those before it

  static FrameStep rotation(int axis, Value c, Value s);
  static FrameStep rotation(const std::array<Vector3, 3>& columns);
  static FrameStep shift(const Vector3& translation);
};
using FrameSteps = std::vector<FrameStep>;

/// Coordinates after a rotation to coordinates before it: v_A = R_AB v_B.
Vector3 turnedBack(const FrameStep& r, const Vector3& v_B);
/// Coordinates before a rotation to coordinates after it: v_B = R_AB' v_A.
Vector3 turned(const FrameStep& r, const Vector3& v_A);

/// R_AB and p_AB of a row of steps.
struct Placed {
  std::array<Vector3, 3> columns;  ///< of R_AB: the axes of B in A
  Vector3 p_AB;                    ///< origin of B in A

  /// B = A
  explicit Placed(Graph* graph);
  /** Three turns in a row cost one matrix, and two about different axes no more than themselves:
      good for steps that are constant. */
  Placed(Graph* graph, const FrameSteps& steps);

  Vector3 turned(const Vector3& v_A) const;
  Vector3 turnedBack(const Vector3& v_B) const;
};

/// A scene's steps with nodes for their numbers.
FrameSteps frameSteps(const std::vector<scene::Step>& steps, NodeNumbers& number);

/** The steps themselves while they are few; of many a shift and a turn that stand for all. Along a
    row of fixed links each would otherwise carry the steps of all before it. */
FrameSteps shortened(Graph* graph, FrameSteps steps);

/// The way back over turns about coordinate axes.
FrameSteps inverseTurns(const FrameSteps& turns);

}  // namespace dynwitness::symbolic
