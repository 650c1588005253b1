// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/link_motions.hpp"

#include <stdexcept>

#include "symbolic/bodies.hpp"
#include "symbolic/quasi_velocities.hpp"
#include "symbolic/velocities.hpp"

namespace dynwitness::symbolic {
namespace {

void append(FrameSteps* to, const FrameSteps& more) {
  to->insert(to->end(), more.begin(), more.end());
}

Vector3 rate(Graph* graph, const Vector3& x, const Direction& motion) {
  const std::vector<Node> nodes =
      graph->directionalDerivative({x[0].node, x[1].node, x[2].node}, motion);
  return {Value{graph, nodes[0]}, Value{graph, nodes[1]}, Value{graph, nodes[2]}};
}

/// omega of  R' dR/dt = [omega]x  from the columns of R: omega_x = R_z . dR_y/dt, and in a circle.
Vector3 angularVelocity(Graph* graph, const Placed& placed, const Direction& motion) {
  Vector3 omega;
  for (int k = 0; k < 3; ++k)
    omega[k] = dot(placed.columns[(k + 2) % 3], rate(graph, placed.columns[(k + 1) % 3], motion));
  return omega;
}

/// I omega, with the inertia as it is given: about the centre of mass or the link's origin.
Vector3 spun(const scene::MassProperties& inertia, NodeNumbers& number, const Vector3& omega) {
  FrameSteps turns;
  for (int axis : {2, 1, 0}) {  // R = Rz(yaw) Ry(pitch) Rx(roll)
    const auto [c, s] = number.angle(inertia.rpy[axis]);
    turns.push_back(FrameStep::rotation(axis, c, s));
  }
  Vector3 w = omega;
  for (const FrameStep& turn : turns) w = turned(turn, w);
  const Value xy = number(inertia.xy), xz = number(inertia.xz), yz = number(inertia.yz);
  Vector3 h = {number(inertia.xx) * w[0] + xy * w[1] + xz * w[2],
               xy * w[0] + number(inertia.yy) * w[1] + yz * w[2],
               xz * w[0] + yz * w[1] + number(inertia.zz) * w[2]};
  for (auto turn = turns.rbegin(); turn != turns.rend(); ++turn) h = turnedBack(*turn, h);
  return h;
}

/// About the centre of mass: of an inertia about the link's origin without Steiner's part.
Symmetric aboutCom(const scene::MassProperties& inertia, NodeNumbers& number, const Value& mass) {
  Graph* graph = mass.graph;
  Symmetric I = zeroMatrix(graph);
  for (int j = 0; j < 3; ++j) {
    Vector3 unit = zeroVector(graph);
    unit[static_cast<std::size_t>(j)] = constant(graph, 1);
    Vector3 column = spun(inertia, number, unit);
    if (inertia.about == scene::MassProperties::About::kLinkOrigin) {
      const Vector3 com = number.vector(inertia.com);
      column = column + constant(graph, -1) * mass * cross(com, cross(unit, com));
    }
    for (int i = 0; i <= j; ++i) I(i, j) = column[static_cast<std::size_t>(i)];
  }
  return I;
}

Value kineticEnergy(const LinkMotion& link) {
  Graph* graph = link.position[0].graph;
  const Value half = constant(graph, Rational(1, 2));
  const Vector3& w = link.angular;
  const Symmetric& I = link.inertia;
  const Value turning = I.xx * (w[0] * w[0]) + I.yy * (w[1] * w[1]) + I.zz * (w[2] * w[2]),
              mixed = I.xy * (w[0] * w[1]) + I.xz * (w[0] * w[2]) + I.yz * (w[1] * w[2]);
  return half * link.mass * dot(link.velocity, link.velocity) + half * turning + mixed;
}

bool hasMass(const scene::MassProperties& inertia) {
  for (const scene::Number* n : {&inertia.mass, &inertia.xx, &inertia.yy, &inertia.zz, &inertia.xy,
                                 &inertia.xz, &inertia.yz})
    if (!n->isLiteralZero()) return true;
  return false;
}

}  // namespace

LinkMotions linkMotions(const scene::Mechanism& mechanism, const Options& options, Equations& e) {
  if (!e.quasi.empty())
    throw std::invalid_argument("linkMotions: expected rates that are derivatives of positions");
  Graph* graph = &e.graph;
  BodyTree tree(mechanism, options, graph);  // finds the nodes that it made before
  const Direction moving = motion(e);
  LinkMotions result;
  std::vector<FrameSteps> to_body;
  std::vector<Vector3> angular;  // of each body, in its axes
  for (const Body& body : tree.bodies()) {
    FrameSteps steps;
    if (body.parent >= 0) steps = to_body[body.parent];
    append(&steps, body.before);
    append(&steps, jointSteps(graph, body.joint));
    const Placed placed(graph, steps);
    angular.push_back(angularVelocity(graph, placed, moving));
    const Value qd = jointAxes(graph, body.joint)[0].rate;
    Value inboard = angular.back()[body.joint.axis];
    if (body.joint.turns()) inboard = inboard - qd;
    result.rotor_kinetic.push_back(constant(graph, Rational(1, 2)) * body.joint.rotor * (qd * qd) +
                                   body.joint.spin * qd * inboard);
    result.first_moments.push_back(movedBack(steps, body.moments).first);
    to_body.push_back(steps);
  }
  for (const GearedRotor& rotor : tree.rotors()) {
    const Value rate = rotorRate(graph, rotor);
    Value turning = constant(graph, Rational(1, 2)) * rate;
    if (rotor.carrier >= 0) turning = turning + dot(rotor.axis, angular[rotor.carrier]);
    result.rotor_kinetic[rotor.body] += rotor.inertia * rate * turning;
  }
  const std::vector<Velocity> carried = velocities(tree);
  for (std::size_t i = 0; i < mechanism.links.size(); ++i) {
    const scene::Link& link = mechanism.links[i];
    const LinkFrame& frame = tree.frame(static_cast<int>(i));
    if (frame.body < 0 || !hasMass(link.inertia)) continue;
    FrameSteps to_com = to_body[frame.body];
    append(&to_com, frame.offset);
    to_com.push_back(FrameStep::shift(tree.number().vector(link.inertia.com)));
    LinkMotion m;
    m.link = link.name;
    m.body = frame.body;
    m.mass = tree.number()(link.inertia.mass);
    m.position = Placed(graph, to_com).p_AB;
    m.velocity = rate(graph, m.position, moving);
    m.angular = angular[frame.body];
    m.carried = carried[frame.body].angular;
    for (const FrameStep& step : frame.offset)
      if (step.is_rotation)
        for (Vector3* omega : {&m.angular, &m.carried}) *omega = turned(step, *omega);
    m.inertia = aboutCom(link.inertia, tree.number(), m.mass);
    m.kinetic = kineticEnergy(m);
    result.links.push_back(std::move(m));
  }
  return result;
}

}  // namespace dynwitness::symbolic
