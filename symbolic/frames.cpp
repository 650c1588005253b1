// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/frames.hpp"

#include <utility>

namespace dynwitness::symbolic {

FrameStep FrameStep::rotation(int axis, Value c, Value s) {
  return {true, axis, c, s, zeroVector(c.graph)};
}

FrameStep FrameStep::rotation(const std::array<Vector3, 3>& columns) {
  Graph* graph = columns[0][0].graph;
  return {true, -1, constant(graph, 1), constant(graph, 0), zeroVector(graph), columns};
}

FrameStep FrameStep::shift(const Vector3& translation) {
  Graph* graph = translation[0].graph;
  return {false, 0, constant(graph, 1), constant(graph, 0), translation};
}

Vector3 turnedBack(const FrameStep& r, const Vector3& v) {
  if (r.axis < 0) return v[0] * r.columns[0] + v[1] * r.columns[1] + v[2] * r.columns[2];
  const int x = (r.axis + 1) % 3, y = (r.axis + 2) % 3;
  Vector3 result = v;
  result[x] = r.c * v[x] - r.s * v[y];
  result[y] = r.s * v[x] + r.c * v[y];
  return result;
}

Vector3 turned(const FrameStep& r, const Vector3& v) {
  if (r.axis < 0) return {dot(r.columns[0], v), dot(r.columns[1], v), dot(r.columns[2], v)};
  const int x = (r.axis + 1) % 3, y = (r.axis + 2) % 3;
  Vector3 result = v;
  result[x] = r.c * v[x] + r.s * v[y];
  result[y] = r.c * v[y] - r.s * v[x];
  return result;
}

Placed::Placed(Graph* graph) : p_AB(zeroVector(graph)) {
  const Value zero = constant(graph, 0), one = constant(graph, 1);
  columns = {{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}};
}

Placed::Placed(Graph* graph, const FrameSteps& steps) : Placed(graph) {
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    if (step->is_rotation) {
      for (Vector3& column : columns) column = symbolic::turnedBack(*step, column);
      p_AB = symbolic::turnedBack(*step, p_AB);
    } else {
      p_AB = step->translation + p_AB;
    }
  }
}

Vector3 Placed::turned(const Vector3& v_A) const {
  return {dot(columns[0], v_A), dot(columns[1], v_A), dot(columns[2], v_A)};
}

Vector3 Placed::turnedBack(const Vector3& v_B) const {
  return v_B[0] * columns[0] + v_B[1] * columns[1] + v_B[2] * columns[2];
}

FrameSteps frameSteps(const std::vector<scene::Step>& scene_steps, NodeNumbers& number) {
  FrameSteps result;
  for (const scene::Step& step : scene_steps) {
    if (step.kind == scene::Step::Kind::kTranslate) {
      result.push_back(FrameStep::shift(number.vector(step.translation)));
      continue;
    }
    const int axis = static_cast<int>(step.kind) - static_cast<int>(scene::Step::Kind::kRotateX);
    const auto [c, s] = number.angle(step.angle);
    result.push_back(FrameStep::rotation(axis, c, s));
  }
  return result;
}

FrameSteps shortened(Graph* graph, FrameSteps steps) {
  constexpr std::size_t kMostSteps = 16;  // four fixed joints in a row, each with xyz and rpy
  if (steps.size() <= kMostSteps) return steps;
  const Placed placed(graph, steps);
  return {FrameStep::shift(placed.p_AB), FrameStep::rotation(placed.columns)};
}

FrameSteps inverseTurns(const FrameSteps& turns) {
  FrameSteps result;
  for (auto turn = turns.rbegin(); turn != turns.rend(); ++turn) {
    FrameStep back = *turn;
    back.s = -back.s;
    result.push_back(back);
  }
  return result;
}

}  // namespace dynwitness::symbolic
