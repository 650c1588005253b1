// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/equations.hpp"

#include <numeric>

#include <fmt/format.h>

#include "scene/numbers.hpp"
#include "scene/work.hpp"
#include "symbolic/bodies.hpp"
#include "symbolic/energies.hpp"
#include "symbolic/generalized_forces.hpp"
#include "symbolic/quasi_velocities.hpp"

namespace dynwitness::symbolic {
namespace {

std::vector<Variable> rates(const Equations& e) {
  std::vector<Variable> qd;
  for (int i = 0; i < e.dof(); ++i) qd.push_back({Input::kVelocity, i});
  return qd;
}

// ---- T, V, p ------------------------------------------------------------------------------------

/// What the equations are about: rates, positions and links.
void describe(const BodyTree& tree, Equations& e) {
  for (const Body& body : tree.bodies()) {
    const Joint& joint = body.joint;
    e.links.push_back(body.name);
    if (!joint.hasOneRate())
      e.quasi.push_back(
          {joint.name, joint.kind == Joint::Kind::kFree, joint.rate, joint.quaternion()});
    for (int k = 0; k < joint.rates() && !joint.follows; ++k)
      e.revolute.push_back(joint.hasOneRate() ? joint.turns() : k + 3 >= joint.rates());
  }
  e.positions = tree.slots();
  e.joints = tree.mechanism().rateLabels();
  e.directions = directions(tree);
  // angles add up where bodies, rates and positions are counted alike
  const bool alike = e.quasi.empty() && !tree.mechanism().hasMimics();
  for (int i = 0; i < e.dof(); ++i)
    e.parallel_inboard.push_back(alike ? parallelInboard(tree, i) : -1);
}

void formEnergies(const BodyTree& tree, Equations& e) {
  describe(tree, e);
  for (const Value& share : kineticByVelocities(tree)) {
    e.link_kinetic.push_back(share.node);
    e.kinetic = e.graph.add(e.kinetic, share.node);
  }
  e.potential = potential(tree).node;
  e.p = e.graph.gradient(e.kinetic, rates(e));  // (1)
  for (const Value& momentum : gearMomenta(tree, e.dof())) e.gear_momenta.push_back(momentum.node);
}

// ---- c, g, Q ------------------------------------------------------------------------------------

void formCoriolisAndGravity(Equations& e) {
  Graph& graph = e.graph;
  const std::vector<Node> p_rate = graph.directionalDerivative(e.p, motion(e));
  const std::vector<Node> dT_dq = positionGradient(e, e.kinetic);
  const std::vector<Node> structure = hamelTerms(e, e.p);
  for (int i = 0; i < e.dof(); ++i)
    e.c.push_back(graph.add(graph.subtract(p_rate[i], dT_dq[i]), structure[i]));  // (3), (3')
  e.g = positionGradient(e, e.potential);                                         // (4)
}

void formGeneralizedForces(BodyTree& tree, Equations& e) {
  e.Q = e.graph.gradient(wrenchPower(tree).node, rates(e));  // (5)
  e.friction = e.graph.gradient(dissipation(tree).node, rates(e));
  for (int i = 0; i < e.dof(); ++i) e.Q[i] = e.graph.subtract(e.Q[i], e.friction[i]);
}

// ---- M ------------------------------------------------------------------------------------------

/// Of a chain of 100 joints M derived, compiled and printed took 24 kB an entry.
constexpr double kBytesOfMassEntry = 24e3, kMostMassEntries = 80200;

/// Pairs of a rate and one inboard of it or the same.
double massEntries(const std::vector<Body>& bodies) {
  double entries = 0;
  std::vector<int> rates_inboard;
  for (const Body& body : bodies) {
    rates_inboard.push_back(body.joint.rates() +
                            (body.parent < 0 ? 0 : rates_inboard[body.parent]));
    entries += body.joint.rates() * rates_inboard.back();
  }
  return entries;
}

/// Before anything is derived.
void requireMassMatrixFits(const BodyTree& tree) {
  const double entries = massEntries(tree.bodies());
  if (entries > kMostMassEntries)
    throw scene::InputError(
        {}, fmt::format("M has {:.0f} entries to derive on and above its diagonal, {:.1f} GB of "
                        "operations; allowed: {:.0f}, such as those of a chain of 400 joints",
                        entries, entries * kBytesOfMassEntry / 1e9, kMostMassEntries));
}

void formMassMatrix(const BodyTree& tree, Equations& e) {
  Graph& graph = e.graph;
  const std::vector<Body>& bodies = tree.bodies();
  const int n = e.dof();
  std::vector<std::vector<int>> bodies_of_rate(n);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (int k = 0; k < bodies[b].joint.rates(); ++k)
      bodies_of_rate[bodies[b].joint.rate + k].push_back(static_cast<int>(b));
  const double entries = massEntries(bodies);
  const std::vector<Variable> qd = rates(e);

  // (2): column j is the momentum that a unit rate of joint j alone (and of those that follow it)
  // gives to itself and to the joints inboard of it; the others come from symmetry, or share no
  // body with j
  const std::vector<Node> p_composite = graph.gradient(kineticByCompositeBodies(tree).node, qd);
  e.M.assign(n, std::vector<Node>(n));
  scene::Work work("M derived", entries, 1);
  for (int j = 0; j < n; ++j) {
    std::vector<int> inboard;
    for (const int body : bodies_of_rate[j])
      for (int b = body; b >= 0; b = bodies[b].parent)
        for (int k = 0; k < bodies[b].joint.rates(); ++k)
          inboard.push_back(bodies[b].joint.rate + k);
    work.done(static_cast<double>(inboard.size()));
    if (e.hasFollowers()) {
      // the joints of one rate may hang on those of another, and the other way round: all pairs are
      // asked
      inboard.resize(n);
      std::iota(inboard.begin(), inboard.end(), 0);
    }
    std::vector<Node> p;
    for (int i : inboard) p.push_back(p_composite[i]);
    const std::vector<Node> columns = graph.directionalDerivative(p, {{qd[j], graph.constant(1)}});
    for (std::size_t k = 0; k < inboard.size(); ++k)
      e.M[inboard[k]][j] = e.M[j][inboard[k]] = columns[k];
  }
}

}  // namespace

Equations deriveEnergies(const scene::Mechanism& mechanism, const Options& options) {
  Equations e;
  formEnergies(BodyTree(mechanism, options, &e.graph), e);
  return e;
}

Equations deriveForces(const scene::Mechanism& mechanism, const Options& options) {
  Equations e;
  BodyTree tree(mechanism, options, &e.graph);
  formEnergies(tree, e);
  formCoriolisAndGravity(e);
  formGeneralizedForces(tree, e);
  return e;
}

Equations deriveForInverseDynamics(const scene::Mechanism& mechanism, const Options& options) {
  Equations e;
  BodyTree tree(mechanism, options, &e.graph);
  formEnergies(tree, e);
  formGeneralizedForces(tree, e);
  return e;
}

void addMassMatrix(const scene::Mechanism& mechanism, const Options& options, Equations& e) {
  const BodyTree tree(mechanism, options, &e.graph);  // finds the nodes that it made before
  requireMassMatrixFits(tree);
  formMassMatrix(tree, e);
}

Equations derive(const scene::Mechanism& mechanism, const Options& options) {
  Equations e;
  BodyTree tree(mechanism, options, &e.graph);
  requireMassMatrixFits(tree);
  formEnergies(tree, e);
  formCoriolisAndGravity(e);
  formGeneralizedForces(tree, e);
  formMassMatrix(tree, e);
  // body by body from the world, O(n depth): for readers
  for (const Value& share : potentialByBody(tree)) e.link_potential.push_back(share.node);
  return e;
}

std::vector<Node> inverseDynamics(Equations& e) {
  Graph& graph = e.graph;
  const std::vector<Node> p_rate = graph.directionalDerivative(e.p, motion(e, true));
  const std::vector<Node> structure = hamelTerms(e, e.p);
  const std::vector<Node> lagrangian_slope =
      positionGradient(e, graph.subtract(e.kinetic, e.potential));
  std::vector<Node> tau;
  for (int i = 0; i < e.dof(); ++i)
    tau.push_back(graph.add(graph.subtract(graph.subtract(p_rate[i], lagrangian_slope[i]), e.Q[i]),
                            structure[i]));
  return tau;
}

std::vector<Node> massCoriolisGravity(const Equations& e) {
  std::vector<Node> outputs;
  for (const std::vector<Node>& row : e.M) outputs.insert(outputs.end(), row.begin(), row.end());
  outputs.insert(outputs.end(), e.c.begin(), e.c.end());
  outputs.insert(outputs.end(), e.g.begin(), e.g.end());
  return outputs;
}

}  // namespace dynwitness::symbolic
