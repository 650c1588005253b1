// SPDX-License-Identifier: GPL-3.0-or-later
// The steps of mechanisms of many joints.
#include <algorithm>
#include <functional>
#include <map>
#include <optional>

#include "scene/work.hpp"
#include "symbolic/closed_form.hpp"
#include "symbolic/derivation_steps.hpp"
#include "symbolic/exact_points.hpp"
#include "symbolic/print.hpp"
#include "symbolic/quasi_velocities.hpp"

namespace dynwitness::symbolic {
namespace {

/// Are these nodes 0 at random rational points?
bool vanish(const Equations& e, const std::vector<Node>& nodes, const scene::Mechanism& mechanism,
            int points) {
  const Program program = compile(e.graph, nodes);
  for (int seed = 1; seed <= points; ++seed) {
    ProgramRun<Rational> run(program, ExactNumbers(mechanism, seed));
    for (const Rational& residual : run(exactState(e.dof(), seed, e.positions)))
      if (residual != 0) return false;
  }
  return true;
}

/** Which rates are no derivatives, and what they do instead: one step a joint. Checked is what (3')
    of equations.hpp rests on, that directions commute up to the constants b_ijk, for every entry of
    R and every coordinate of p. */
std::vector<Step> quasiSteps(Equations& e, int points,
                             const std::function<bool(const std::vector<Node>&)>& check) {
  Graph& graph = e.graph;
  std::vector<Step> steps;
  for (const QuasiJoint& joint : e.quasi) {
    const int rates = joint.floats ? 6 : 3;
    const auto range = [](const std::string& letter, int first, int count) {
      return numbered(letter, first) + " to " + numbered(letter, first + count - 1);
    };
    const std::string R = "R" + std::to_string(joint.slot + 1);
    std::string sentence =
        R + "_ij are the entries of the rotation of the quaternion (w, x, y, z) = " +
        range("q", joint.slot, 4) + ", from axes of the link to axes of the joint; ";
    if (joint.floats)
      sentence += range("q", joint.slot - 3, 3) + " are the position p of the link's origin, and " +
                  range("qd", joint.rate, 3) + " its velocity v in axes of the link: dp/dt = " + R +
                  " v; ";
    sentence +=
        range("qd", joint.rate + rates - 3, 3) +
        " are the angular velocity w in axes of the link: d" + R + "/dt = " + R +
        " [w]x. No position has them as its derivative (quasi-velocities); X_i f is df/dt when "
        "qd_i alone is 1. X_i X_j f - X_j X_i f = sum of b_ijk X_k f, where turns give "
        "[X_wx, X_wy] = X_wz";
    if (joint.floats) sentence += ", [X_wx, X_vy] = X_vz";
    sentence +=
        " and so on in a circle, so that c has the term sum of b_ijk qd_j p_k: Euler's w x p.";

    // every coordinate f of the joint's position, and all pairs of directions
    std::vector<Node> coordinates, residuals;
    for (int k = 0; k < 9; ++k)
      coordinates.push_back(graph.input(Input::kRotation, 9 * joint.slot + k));
    if (joint.floats)
      for (int k = 0; k < 3; ++k)
        coordinates.push_back(graph.input(Input::kPosition, joint.slot - 3 + k));
    std::vector<std::vector<Node>> X_f(rates);  // X_i of every coordinate
    for (int i = 0; i < rates; ++i)
      X_f[i] = graph.directionalDerivative(coordinates, e.directions[joint.rate + i]);
    for (std::size_t f = 0; f < coordinates.size(); ++f) {
      std::vector<Node> slope(e.dof());
      for (int i = 0; i < rates; ++i) slope[joint.rate + i] = X_f[i][f];
      const std::vector<Node> b_X = structureTerms(e, slope);  // sum of b_ijk qd_j X_k f
      for (int i = 0; i < rates; ++i) {
        Node commutator;
        for (int j = 0; j < rates; ++j) {
          const Node forth =
              graph.directionalDerivative({X_f[j][f]}, e.directions[joint.rate + i])[0];
          const Node back =
              graph.directionalDerivative({X_f[i][f]}, e.directions[joint.rate + j])[0];
          commutator =
              graph.add(commutator, graph.multiply(graph.input(Input::kVelocity, joint.rate + j),
                                                   graph.subtract(forth, back)));
        }
        residuals.push_back(graph.subtract(commutator, b_X[joint.rate + i]));
      }
    }
    steps.push_back(
        {"quasi-velocities of " + joint.joint,
         sentence,
         {},
         "sum of (X_i X_j f - X_j X_i f) qd_j = sum of b_ijk qd_j X_k f for all coordinates f "
         "at " +
             std::to_string(points) + " random rational points",
         check(residuals)});
  }
  return steps;
}

/// What a program's steps are checked by: all are 0.
struct Residuals {
  Node kinetic;                                ///< T by M, less T
  std::vector<Node> momentum, force, gravity;  ///< p and c once more, from M; g from the links' V
  Node power;                                  ///< qd' (M qdd + c + g), less d(T + V)/dt
};

Residuals residualsOf(Equations& e) {
  const int n = e.dof();
  Graph& graph = e.graph;
  const auto velocity = [&](int i) { return graph.input(Input::kVelocity, i); };
  Residuals r;
  std::vector<Node> p_of_M;
  Node T_of_M, V_of_links;
  for (const Node& share : e.link_potential) V_of_links = graph.add(V_of_links, share);
  for (int i = 0; i < n; ++i) {
    Node p;
    for (int j = 0; j < n; ++j) p = graph.add(p, graph.multiply(e.M[i][j], velocity(j)));
    p_of_M.push_back(p);
    r.momentum.push_back(graph.subtract(p, e.p[i]));
    T_of_M = graph.add(T_of_M, graph.multiply(p, velocity(i)));
  }
  T_of_M = graph.multiply(graph.constant(Rational(1, 2)), T_of_M);
  r.kinetic = graph.subtract(T_of_M, e.kinetic);
  const std::vector<Node> p_rate = graph.directionalDerivative(p_of_M, motion(e));
  const std::vector<Node> T_slope = positionGradient(e, T_of_M);
  const std::vector<Node> V_slope = positionGradient(e, V_of_links);
  const std::vector<Node> structure = hamelTerms(e, p_of_M);
  for (int i = 0; i < n; ++i) {
    const Node c = graph.add(graph.subtract(p_rate[i], T_slope[i]), structure[i]);
    r.force.push_back(graph.subtract(c, e.c[i]));
    r.gravity.push_back(graph.subtract(V_slope[i], e.g[i]));
  }
  Node power;  // of tau = M qdd + c + g
  for (int i = 0; i < n; ++i) {
    Node tau = graph.add(e.c[i], e.g[i]);
    for (int j = 0; j < n; ++j)
      tau = graph.add(tau, graph.multiply(e.M[i][j], graph.input(Input::kAcceleration, j)));
    power = graph.add(power, graph.multiply(tau, velocity(i)));
  }
  const Node energy_rate =
      graph.directionalDerivative({graph.add(e.kinetic, e.potential)}, motion(e, true))[0];
  r.power = graph.subtract(power, energy_rate);
  return r;
}

/// How Q without friction changes with the rates, in a direction of any numbers: not at all.
std::vector<Node> rateSlopes(Equations& e) {
  std::vector<Node> wrenches;
  Direction any;
  for (int i = 0; i < e.dof(); ++i) {
    wrenches.push_back(e.graph.add(e.Q[i], e.friction[i]));
    any.push_back({{Input::kVelocity, i}, e.graph.input(Input::kAcceleration, i)});
  }
  return e.graph.directionalDerivative(wrenches, any);
}

/// A result of the program, and the step that it belongs to.
struct Result {
  std::string name;
  Node node;
  std::size_t step;
  std::optional<Formula> closed = {};  ///< none: it is shown as lines
};

/// The program's lines as equations, each under the first step that needs it, and after them what
/// the step is about.
void addLines(const Graph& graph, const std::vector<Result>& results, std::vector<Step>* steps) {
  std::vector<Node> nodes;
  std::vector<const Result*> long_ones;
  for (const Result& r : results)
    if (!r.closed) {
      nodes.push_back(r.node);
      long_ones.push_back(&r);
    }
  const Program program = compile(graph, nodes);
  const std::vector<Statement> lines = statements(program, Style::kText);
  std::map<int, std::size_t> line_of;
  for (std::size_t i = 0; i < lines.size(); ++i) line_of[lines[i].slot] = i;
  std::vector<std::size_t> step_of(lines.size(), steps->size());
  for (std::size_t r = 0; r < long_ones.size(); ++r) {
    std::vector<int> open{program.outputs[r]};
    while (!open.empty()) {
      const auto it = line_of.find(open.back());
      open.pop_back();
      if (it == line_of.end() || step_of[it->second] <= long_ones[r]->step) continue;
      step_of[it->second] = long_ones[r]->step;
      open.insert(open.end(), lines[it->second].reads.begin(), lines[it->second].reads.end());
    }
  }
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (step_of[i] < steps->size())
      (*steps)[step_of[i]].equations.push_back(
          {{Formula::ofSymbol(lines[i].name), lines[i].value}, {}, {}});
  std::map<std::string, Formula> by_lines;
  for (std::size_t r = 0; r < long_ones.size(); ++r) {
    const auto it = line_of.find(program.outputs[r]);
    by_lines[long_ones[r]->name] = it != line_of.end() ? Formula::ofSymbol(lines[it->second].name)
                                                       : leafFormula(program, program.outputs[r]);
  }
  for (const Result& r : results) {
    Step& step = (*steps)[r.step];
    if (r.closed && isZero(*r.closed))
      step.zeros.push_back(r.name);
    else
      step.equations.push_back(
          {{Formula::ofSymbol(r.name), r.closed ? *r.closed : by_lines.at(r.name)}, {}, r.node});
  }
}

/// Which results are short: decided for each, where rates are derivatives and positions are theirs.
void closeShortOnes(const Equations& e, std::vector<Result>* results) {
  const bool is_plain = e.quasi.empty() && !e.hasFollowers();
  std::optional<ClosedAlgebra> algebra;
  if (is_plain) algebra.emplace(e);
  for (Result& r : *results) {
    if (algebra) r.closed = algebra->shortFormula(r.node);
    if (e.graph.isZero(r.node)) r.closed = Formula::ofNumber(0);
  }
}

/// T as the sum of the links' shares, which stand before it, where these are short and T is not.
void splitKinetic(std::size_t links, std::vector<Result>* results) {
  const auto T = results->begin() + static_cast<long>(links);
  const auto is_short = [](const Result& share) { return share.closed.has_value(); };
  if (T->closed || !std::all_of(results->begin(), T, is_short)) {
    results->erase(results->begin(), T);
    return;
  }
  std::vector<Formula> shares;
  for (auto share = results->begin(); share != T; ++share)
    if (!isZero(*share->closed)) shares.push_back(Formula::ofSymbol(share->name));
  T->closed = Formula::sum(shares);
}

/// M as a matrix of names and zeros, where that is narrow enough to be read; none: it is not.
std::optional<StepEquation> namedMatrix(const Equations& e, const std::vector<Result>& results) {
  const int n = e.dof();
  std::vector<Formula> entries;
  std::vector<Node> values;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const std::string name = numbered("M", std::min(i, j), std::max(i, j));
      const auto at = std::find_if(results.begin(), results.end(),
                                   [&](const Result& r) { return r.name == name; });
      const bool zero = at->closed && isZero(*at->closed);
      entries.push_back(zero ? Formula::ofNumber(0) : Formula::ofSymbol(name));
      values.push_back(e.M[i][j]);
    }
  const Formula matrix = Formula::matrix(entries, static_cast<std::size_t>(n));
  if (length(matrix) > kWidestMatrix) return std::nullopt;
  return StepEquation{{Formula::ofSymbol("M"), matrix}, {}, {}, values};
}

}  // namespace

std::vector<Step> programSteps(Equations& e, const scene::Mechanism& mechanism, int points) {
  const int n = e.dof();
  const std::string at = " at " + std::to_string(points) + " random rational points";
  const bool loaded = isLoaded(e);
  scene::Work work("checks of the steps at rational points", loaded ? 8 : 7, 3);
  const auto check = [&](const std::vector<Node>& residuals) {
    const bool holds = vanish(e, residuals, mechanism, points);
    work.done();
    return holds;
  };
  const Residuals r = residualsOf(e);
  const bool quasi = !e.quasi.empty();
  std::vector<Step> steps = quasiSteps(e, points, check);
  const std::size_t base = steps.size();
  const auto add = [&](const char* name, const char* sentence, const std::string& what,
                       const std::vector<Node>& residuals, const char* quantity = "") {
    steps.push_back({name, sentence, {}, what + at, check(residuals), quantity});
  };
  add("kinetic energy T",
      "Angular velocity omega and velocity v of each link's joint frame, in that frame, and from "
      "them half of mass times velocity squared.",
      "T = qd' M qd / 2", {r.kinetic});
  add("potential energy V", "Minus gravity times the first moment of mass, and the springs.",
      "dV/dq is that of the links' shares", r.gravity);
  add("momentum p", "p_i = dT/dqd_i.", "p = M qd", r.momentum);
  add("mass matrix M", "M_ij = dp_i/dqd_j, with T as a sum over composite bodies.",
      "M qd is the momentum of T as a sum over links", r.momentum, "M");
  add("Coriolis and centrifugal forces c",
      quasi ? "c_i = sum of (X_j p_i) qd_j - X_i T + sum of b_ijk qd_j p_k."
            : "c_i = sum of (dp_i/dq_j) qd_j - dT/dq_i.",
      quasi ? "the same from M alone, with p = M qd and T = qd' M qd/2"
            : "the same from M alone: d(M qd)/dt - d(qd' M qd/2)/dq",
      r.force, "c");
  add("gravity and springs g", quasi ? "g_i = X_i V." : "g_i = dV/dq_i.",
      "equals the derivative of the links' shares", r.gravity, "g");
  if (loaded) add("loads Q", loadsSentence(e), kLoadsCheck, rateSlopes(e));
  add("equations of motion",
      quasi ? "Lagrange's equations in quasi-velocities (Boltzmann, Hamel)."
            : "Lagrange's equations.",
      "power: qd' (M qdd + c + g) = d(T + V)/dt", {r.power});

  std::vector<Result> results;
  for (std::size_t k = 0; k < e.links.size(); ++k)
    results.push_back({"T_" + e.links[k], e.link_kinetic[k], base});
  results.push_back({"T", e.kinetic, base});
  results.push_back({"V", e.potential, base + 1});
  for (int i = 0; i < n; ++i) results.push_back({numbered("p", i), e.p[i], base + 2});
  for (int i = 0; i < n; ++i)
    for (int j = i; j < n; ++j) results.push_back({numbered("M", i, j), e.M[i][j], base + 3});
  for (int i = 0; i < n; ++i) results.push_back({numbered("c", i), e.c[i], base + 4});
  for (int i = 0; i < n; ++i) results.push_back({numbered("g", i), e.g[i], base + 5});
  for (int i = 0; loaded && i < n; ++i) results.push_back({numbered("Q", i), e.Q[i], base + 6});
  closeShortOnes(e, &results);
  splitKinetic(e.links.size(), &results);
  addLines(e.graph, results, &steps);
  if (n > 1 && n <= 12)
    if (const auto matrix = namedMatrix(e, results)) steps[base + 3].equations.push_back(*matrix);
  std::map<std::string, Formula> shown;
  for (const Result& r : results) shown[r.name] = r.closed ? *r.closed : Formula::ofSymbol(r.name);
  for (int i = 0; i < n; ++i)
    steps.back().equations.push_back(
        equationOfMotion(e, i, [&shown](const std::string& name, Node) { return shown.at(name); }));
  return steps;
}

}  // namespace dynwitness::symbolic
