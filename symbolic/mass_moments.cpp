// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/mass_moments.hpp"

#include <array>

namespace dynwitness::symbolic {
namespace {

/** R I R', for a turn about one axis. With  w = s (I_xx - I_yy) + 2 c I_xy  the turned block is
    [I_xx - s w, c w - I_xy; ., I_yy + s w]: four products in place of ten. */
Symmetric turnedBack(const FrameStep& r, const Symmetric& m) {
  if (r.axis < 0) {
    const std::array<Vector3, 3> R_I = {turnedBack(r, column(m, 0)), turnedBack(r, column(m, 1)),
                                        turnedBack(r, column(m, 2))};
    Symmetric result = m;
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j)
        result(i, j) =
            R_I[0][i] * r.columns[0][j] + R_I[1][i] * r.columns[1][j] + R_I[2][i] * r.columns[2][j];
    return result;
  }
  const int x = (r.axis + 1) % 3, y = (r.axis + 2) % 3, z = r.axis;
  Graph* graph = r.c.graph;
  Symmetric result = m;
  if (graph->isZero(r.s.node)) {  // by 0 or pi
    result(x, z) = r.c * m(x, z);
    result(y, z) = r.c * m(y, z);
    return result;
  }
  result(x, z) = r.c * m(x, z) - r.s * m(y, z);
  result(y, z) = r.s * m(x, z) + r.c * m(y, z);
  if (graph->isZero(r.c.node)) {  // by a right angle
    result(x, x) = m(y, y);
    result(y, y) = m(x, x);
    result(x, y) = -m(x, y);
    return result;
  }
  const Value w = r.s * (m(x, x) - m(y, y)) + r.c * (m(x, y) + m(x, y));
  const Value sw = r.s * w;
  result(x, x) = m(x, x) - sw;
  result(y, y) = m(y, y) + sw;
  result(x, y) = r.c * w - m(x, y);
  return result;
}

/** Moments about a point from which the old origin lies at p:
        first' = first + m p
        second' = second + 2 (p'first) 1 - (p first' + first p') + m (p'p 1 - p p') */
MassMoments shiftedBack(const Vector3& p, const MassMoments& b) {
  MassMoments result = b;
  result.first = b.first + b.mass * p;
  const Vector3 sum = b.first + result.first;
  const Vector3 diagonal = {p[0] * sum[0], p[1] * sum[1], p[2] * sum[2]};
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    result.second(i, i) += diagonal[j] + diagonal[k];
    result.second(i, j) -= p[i] * result.first[j] + p[j] * b.first[i];
  }
  return result;
}

}  // namespace

MassMoments noMass(Graph* graph) {
  return {constant(graph, 0), zeroVector(graph), zeroMatrix(graph)};
}

MassMoments operator+(const MassMoments& a, const MassMoments& b) {
  return {a.mass + b.mass, a.first + b.first, a.second + b.second};
}

MassMoments movedBack(const FrameStep& step, const MassMoments& b) {
  if (!step.is_rotation) return shiftedBack(step.translation, b);
  return {b.mass, turnedBack(step, b.first), turnedBack(step, b.second)};
}

MassMoments movedBack(const FrameSteps& steps, MassMoments b) {
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) b = movedBack(*step, b);
  return b;
}

MassMoments linkMoments(const scene::MassProperties& inertia, NodeNumbers& number) {
  MassMoments b;
  b.mass = number(inertia.mass);
  b.first = zeroVector(b.mass.graph);
  b.second = {number(inertia.xx), number(inertia.yy), number(inertia.zz),
              number(inertia.xy), number(inertia.xz), number(inertia.yz)};
  for (int axis : {0, 1, 2}) {  // R = Rz(yaw) Ry(pitch) Rx(roll)
    const auto [c, s] = number.angle(inertia.rpy[axis]);
    b.second = turnedBack(FrameStep::rotation(axis, c, s), b.second);
  }
  const Vector3 com = number.vector(inertia.com);
  if (inertia.about == scene::MassProperties::About::kCenterOfMass)
    return movedBack(FrameStep::shift(com), b);
  b.first = b.mass * com;
  return b;
}

}  // namespace dynwitness::symbolic
