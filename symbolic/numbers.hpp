// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers of a scene as nodes of a graph.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "scene/mechanism.hpp"
#include "scene/numbers.hpp"
#include "symbolic/vectors.hpp"

namespace dynwitness::symbolic {

/** Exact numbers become constants. What has no exact rational value (pi, the cosine of 0.3) and
    parameters that are not folded become atoms, named in the scene's letters. */
class NodeNumbers {
 public:
  /// @param fold_parameters  see Options
  NodeNumbers(const scene::Mechanism& mechanism, bool fold_parameters, Graph* graph);

  Value operator()(const scene::Number& n) const;
  Vector3 vector(const scene::Vector& v) const;

  /// Cosine and sine of a fixed angle. An angle and its negative share their cosine.
  scene::CosSin<Value> angle(const scene::Number& radians);
  /** The turns that take z to an axis, each exact where its square root is.
      @param label  names the angles of an axis that is met for the first time */
  scene::AxisTurn<Value> axisTurn(const scene::Vector& axis, int label);

  /// The coordinate axis that an axis is known to lie along, and in which direction.
  struct AlongCoordinate {
    int coordinate = -1;  ///< 0, 1, 2; -1: none
    bool reversed = false;
  };
  AlongCoordinate alongCoordinate(const scene::Vector& axis) const;

 private:
  bool isExact(const scene::Number& n) const;

  Graph* graph_;
  bool fold_parameters_;
  scene::ParameterValues values_;
  /// Size of an angle -> the angle as first written, and whether that was negative.
  std::map<std::string, std::pair<scene::Number, bool>> angles_;
  std::map<std::string, int> axes_;  ///< axis -> its label
};

}  // namespace dynwitness::symbolic
