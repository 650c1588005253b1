// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/energies.hpp"

#include "symbolic/velocities.hpp"

namespace dynwitness::symbolic {
namespace {

/// Momentum about the origin of a frame, in its axes.
struct Momentum {
  Vector3 linear, angular;
};

Momentum operator+(const Momentum& a, const Momentum& b) {
  return {a.linear + b.linear, a.angular + b.angular};
}

/// From the frame that the steps lead to, to the one that they start from.
Momentum movedBack(const FrameSteps& steps, Momentum h) {
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    if (step->is_rotation) {
      h.linear = turnedBack(*step, h.linear);
      h.angular = turnedBack(*step, h.angular);
    } else {
      h.angular = h.angular + cross(step->translation, h.linear);
    }
  }
  return h;
}
Momentum movedBack(const Placed& placed, Momentum h) {
  h.linear = placed.turnedBack(h.linear);
  h.angular = placed.turnedBack(h.angular) + cross(placed.p_AB, h.linear);
  return h;
}

/// What a joint axis does at unit rate, a screw advancing by its pitch.
Value alongAxis(const JointAxis& axis, const Joint& joint, const Momentum& h) {
  const int k = axis.coordinate;
  if (!axis.shifts) return h.angular[k];
  if (!axis.turns) return h.linear[k];
  return h.angular[k] + joint.pitch * h.linear[k];
}

/// I s: momentum of a body when a joint axis moves it at unit rate.
Momentum atUnitRate(const JointAxis& axis, const Joint& joint, const MassMoments& b) {
  Graph* graph = b.mass.graph;
  Vector3 s = zeroVector(graph);
  s[axis.coordinate] = constant(graph, 1);
  if (!axis.shifts) return {cross(s, b.first), column(b.second, axis.coordinate)};
  if (!axis.turns) return {b.mass * s, cross(b.first, s)};
  const Vector3 advance = joint.pitch * s;
  return {cross(s, b.first) + b.mass * advance,
          column(b.second, axis.coordinate) + cross(b.first, advance)};
}

Value springEnergy(Graph* graph, const Joint& joint) {
  const Value half = constant(graph, Rational(1, 2)), x = stretch(graph, joint);
  return half * joint.stiffness * (x * x);
}

}  // namespace

std::vector<Value> kineticByVelocities(const BodyTree& tree) {
  Graph* graph = tree.graph();
  const Value half = constant(graph, Rational(1, 2));
  const std::vector<Velocity> v = velocities(tree);
  std::vector<Value> shares;
  for (int i = 0; i < tree.size(); ++i) {
    const Joint& joint = tree.bodies()[i].joint;
    const MassMoments& b = tree.bodies()[i].moments;
    const Vector3& omega = v[i].angular;
    Value T =
        half * b.mass * dot(v[i].linear, v[i].linear) + dot(b.first, cross(v[i].linear, omega));
    for (int j = 0; j < 3; ++j) {
      T += half * b.second(j, j) * (omega[j] * omega[j]);
      for (int k = j + 1; k < 3; ++k) T += b.second(j, k) * (omega[j] * omega[k]);
    }
    const Value rate = jointAxes(graph, joint)[0].rate;  // rotors go with joints of one rate
    T += half * joint.rotor * (rate * rate) + joint.spin * rate * v[i].inboard;
    shares.push_back(T);
  }
  for (const GearedRotor& rotor : tree.rotors()) {
    const Value rate = rotorRate(graph, rotor);
    shares[rotor.body] += half * rotor.inertia * (rate * rate);
    if (rotor.carrier >= 0)
      shares[rotor.body] += rotor.inertia * rate * dot(rotor.axis, v[rotor.carrier].angular);
  }
  return shares;
}

std::vector<Value> gearMomenta(const BodyTree& tree, int rates) {
  Graph* graph = tree.graph();
  std::vector<Value> momenta(static_cast<std::size_t>(rates), constant(graph, 0));
  if (tree.rotors().empty()) return momenta;
  const std::vector<Velocity> v = velocities(tree);
  for (const GearedRotor& rotor : tree.rotors()) {
    Value turning = rotorRate(graph, rotor);
    if (rotor.carrier >= 0) turning += dot(rotor.axis, v[rotor.carrier].angular);
    for (std::size_t k = 0; k < rotor.ratio.size(); ++k)
      momenta[rotor.rate + k] += rotor.ratio[k] * (rotor.inertia * turning);
  }
  return momenta;
}

Value kineticByCompositeBodies(const BodyTree& tree) {
  Graph* graph = tree.graph();
  const Value half = constant(graph, Rational(1, 2));
  std::vector<MassMoments> composite;
  for (const Body& body : tree.bodies()) composite.push_back(body.moments);
  // of the bodies outboard, about the body's origin
  std::vector<Momentum> h(tree.size(), {zeroVector(graph), zeroVector(graph)});

  Value T = constant(graph, 0);
  for (const GearedRotor& rotor : tree.rotors()) {
    const Value rate = rotorRate(graph, rotor);
    T += half * rotor.inertia * (rate * rate);
    if (rotor.carrier >= 0)
      h[rotor.carrier].angular = h[rotor.carrier].angular + rotor.inertia * rate * rotor.axis;
  }
  for (int i = tree.size() - 1; i >= 0; --i) {
    const Body& body = tree.bodies()[i];
    const Joint& joint = body.joint;
    const std::vector<JointAxis> axes = jointAxes(graph, joint);
    for (const JointAxis& axis : axes) {
      const Value qd = axis.rate;
      const Momentum I_s = atUnitRate(axis, joint, composite[i]);
      const Value s_I_s = alongAxis(axis, joint, I_s), s_h = alongAxis(axis, joint, h[i]);
      T += half * (s_I_s + joint.rotor) * (qd * qd) + qd * s_h;
      if (body.parent < 0 && axes.size() == 1) break;
      h[i].linear = h[i].linear + qd * I_s.linear;
      h[i].angular = h[i].angular + qd * I_s.angular;
      if (axes.size() == 1)
        h[i].angular[axis.coordinate] += joint.spin * qd;  // the rotor inboard spins too
    }
    if (body.parent < 0) continue;
    const FrameSteps moved = jointSteps(graph, joint);
    const Placed placed(graph, body.before);
    h[i] = movedBack(placed, movedBack(moved, h[i]));
    h[body.parent] = h[body.parent] + h[i];
    composite[body.parent] =
        composite[body.parent] + movedBack(body.before, movedBack(moved, composite[i]));
  }
  return T;
}

Value potential(const BodyTree& tree) {
  Graph* graph = tree.graph();
  std::vector<MassMoments> composite;
  for (const Body& body : tree.bodies()) composite.push_back(body.moments);
  Vector3 first = tree.world().first;
  Value V = constant(graph, 0);
  for (int i = tree.size() - 1; i >= 0; --i) {
    const Body& body = tree.bodies()[i];
    const MassMoments b =
        movedBack(body.before, movedBack(jointSteps(graph, body.joint), composite[i]));
    if (body.parent < 0)
      first = first + b.first;
    else
      composite[body.parent] = composite[body.parent] + b;
    V += springEnergy(graph, body.joint);
  }
  return V - dot(tree.gravity(), first);
}

std::vector<Value> potentialByBody(const BodyTree& tree) {
  Graph* graph = tree.graph();
  const std::vector<Body>& bodies = tree.bodies();
  std::vector<Value> shares;
  for (int i = 0; i < tree.size(); ++i) {
    MassMoments b = bodies[i].moments;
    b.second = zeroMatrix(graph);
    for (int k = i; k >= 0; k = bodies[k].parent)
      b = movedBack(bodies[k].before, movedBack(jointSteps(graph, bodies[k].joint), b));
    shares.push_back(-dot(tree.gravity(), b.first) + springEnergy(graph, bodies[i].joint));
  }
  return shares;
}

}  // namespace dynwitness::symbolic
