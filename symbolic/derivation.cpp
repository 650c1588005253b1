// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/derivation.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <stdexcept>

#include "scene/mimic.hpp"
#include "scene/work.hpp"
#include "symbolic/closed_form.hpp"
#include "symbolic/exact_points.hpp"
#include "symbolic/link_motions.hpp"
#include "symbolic/print.hpp"
#include "symbolic/quasi_velocities.hpp"

namespace dynwitness::symbolic {

namespace {

std::string numbered(const std::string& letter, int i) {
  return letter + std::to_string(i + 1);
}
std::string numbered(const std::string& letter, int i, int j) {
  const bool wide = i > 8 || j > 8;
  return letter + std::to_string(i + 1) + (wide ? "_" : "") + std::to_string(j + 1);
}
std::string christoffelName(int i, int j, int k) {
  return numbered("Gamma", i, j) + std::to_string(k + 1);
}

/// M qdd + c + g = tau (+ Q), row i.
StepEquation equationOfMotion(Equations& e, int i) {
  Graph& graph = e.graph;
  Node left_value = graph.add(e.c[i], e.g[i]);
  std::vector<Formula> left;
  for (int j = 0; j < e.dof(); ++j) {
    if (graph.isZero(e.M[i][j])) continue;
    left.push_back(
        Formula::product({Formula::ofSymbol(numbered("M", std::min(i, j), std::max(i, j))),
                          Formula::ofInput(Input::kAcceleration, j)}));
    left_value =
        graph.add(left_value, graph.multiply(e.M[i][j], graph.input(Input::kAcceleration, j)));
  }
  if (!e.graph.isZero(e.c[i])) left.push_back(Formula::ofSymbol(numbered("c", i)));
  if (!e.graph.isZero(e.g[i])) left.push_back(Formula::ofSymbol(numbered("g", i)));
  std::vector<Formula> right{Formula::ofInput(Input::kForce, i)};
  if (!e.graph.isZero(e.Q[i])) right.push_back(Formula::ofSymbol(numbered("Q", i)));
  return {{Formula::sum(left), Formula::sum(right)},
          left_value,
          graph.add(graph.input(Input::kForce, i), e.Q[i])};
}

bool anyOf(const Graph& graph, const std::vector<Node>& nodes) {
  return std::any_of(nodes.begin(), nodes.end(), [&](Node node) { return !graph.isZero(node); });
}
bool isLoaded(const Equations& e) {
  return anyOf(e.graph, e.Q);
}
const char* loadsSentence(const Equations& e) {
  return anyOf(e.graph, e.friction)
             ? "The constant wrenches and friction: Q_i = d(power of the wrenches)/dqd_i "
               "- dR/dqd_i, R = sum of viscous qd^2/2 + coulomb |qd|."
             : "The constant wrenches: Q_i = d(power of the wrenches)/dqd_i.";
}
constexpr const char* kLoadsCheck = "without -dR/dqd_i depends on the position alone";

// ---- closed forms -------------------------------------------------------------------------------

/// Longer rows keep the names of what stands in them [characters of plain text].
constexpr std::size_t kLongestRow = 400, kWidestMatrix = 120;

std::size_t length(const Formula& f) {
  return print(f, Style::kText).size();
}

/// A sum, the terms of its terms written one after the other.
Formula flatSum(const std::vector<Formula>& terms) {
  std::vector<Formula> flat;
  for (const Formula& term : terms) {
    if (term.kind == Formula::Kind::kSum)
      flat.insert(flat.end(), term.operands.begin(), term.operands.end());
    else
      flat.push_back(term);
  }
  return Formula::sum(flat);
}

bool isZero(const Formula& f) {
  return f.kind == Formula::Kind::kNumber && f.number == 0;
}

/// The steps of Lagrange's way in closed form, each checked by another road where it stands.
class ClosedSteps {
 public:
  ClosedSteps(const scene::Mechanism& mechanism, const Options& options, Equations& e,
              bool linearized)
      : e_(e),
        motions_(linkMotions(mechanism, options, e)),
        algebra_(e),
        f_(deriveClosedForm(algebra_, e)) {
    positions();
    velocities();
    energies();
    momenta();
    massMatrix();
    christoffelSymbols();
    forces();
    loads();
    equationsOfMotion();
    if (linearized) linearizedEquations();
  }
  std::vector<Step> steps;

 private:
  using Ex = GiNaC::ex;

  bool isZero(const Ex& x) { return algebra_.isZero(x); }
  bool equals(const Ex& x, Node node) { return isZero(x - algebra_.expression(node)); }
  Ex expression(const Value& value) { return algebra_.expression(value.node); }
  /// name = x, which the graph has as a node.
  StepEquation equation(const std::string& name, const Ex& x, Node node) {
    return {{Formula::ofSymbol(name), algebra_.formula(x)}, {}, node};
  }
  Ex velocity(int i) { return algebra_.input(Input::kVelocity, i); }
  Ex byPosition(const Ex& x, int i) { return algebra_.derivative(x, {Input::kPosition, i}); }
  Ex byVelocity(const Ex& x, int i) { return algebra_.derivative(x, {Input::kVelocity, i}); }
  /// x, y and z of a vector; what is 0 is left out.
  void addComponents(const std::string& letter, const std::string& link, const Vector3& vector,
                     Step* step) {
    for (int k = 0; k < 3; ++k)
      if (const Ex x = expression(vector[k]); !isZero(x))
        step->equations.push_back(
            equation(letter + std::string(1, "xyz"[k]) + "_" + link, x, vector[k].node));
  }

  void positions();
  void velocities();
  void energies();
  void momenta();
  void massMatrix();
  void christoffelSymbols();
  void forces();
  void loads();
  void equationsOfMotion();
  void linearizedEquations();

  Equations& e_;
  const int n_ = e_.dof();
  LinkMotions motions_;
  ClosedAlgebra algebra_;
  const ClosedForm f_;
};

void ClosedSteps::positions() {
  Step step{
      "positions",
      "The centre of mass of each link that moves, in axes of the world; what is not listed "
      "is 0.",
      {},
      "sum of m p over the links that move together is their first moment of mass, of which V "
      "is made",
      true};
  std::vector<Vector3> sums(motions_.first_moments.size(), zeroVector(&e_.graph));
  for (const LinkMotion& link : motions_.links) {
    addComponents("", link.link, link.position, &step);
    sums[link.body] = sums[link.body] + link.mass * link.position;
  }
  for (std::size_t body = 0; body < sums.size(); ++body)
    for (int k = 0; k < 3; ++k)
      step.holds =
          step.holds && equals(expression(sums[body][k]), motions_.first_moments[body][k].node);
  steps.push_back(step);
}

void ClosedSteps::velocities() {
  Step step{
      "velocities",
      "v = dp/dt of the same points, in axes of the world; omega of each link, in its own "
      "axes, from the turn R that takes them to the world's: R' dR/dt = [omega]x. What is not "
      "listed is 0.",
      {},
      "the energies of the next step, which are formed from velocities carried from joint to "
      "joint instead",
      true};
  for (const LinkMotion& link : motions_.links) {
    addComponents("v_", link.link, link.velocity, &step);
    addComponents("omega_", link.link, link.angular, &step);
  }
  steps.push_back(step);
}

void ClosedSteps::energies() {
  Step links{"kinetic energies of the links",
             "T = (m v'v + omega' I omega)/2, with I about the centre of mass.",
             {},
             "half of mass times velocity squared, from the velocities of the step before, is that "
             "from velocities carried from joint to joint; sum of qd_j dT/dqd_j = 2 T",
             true};
  std::vector<Ex> by_positions;
  bool has_rotors = false;
  for (const Value& rotor : motions_.rotor_kinetic) {
    by_positions.push_back(expression(rotor));
    has_rotors = has_rotors || !isZero(by_positions.back());
  }
  if (has_rotors)
    links.sentence +=
        " A rotor of a joint adds n^2 J qd^2/2; one geared to several rates J (sum of n_k qd_k)^2/2.";
  for (const LinkMotion& link : motions_.links) by_positions[link.body] += expression(link.kinetic);
  for (std::size_t i = 0; i < e_.links.size(); ++i) {
    const Ex T = algebra_.expression(e_.link_kinetic[i]);
    Ex twice = 0;
    for (int j = 0; j < n_; ++j) twice += velocity(j) * byVelocity(T, j);
    links.holds = links.holds && isZero(twice - 2 * T) && isZero(T - by_positions[i]);
    links.equations.push_back(equation("T_" + e_.links[i], T, e_.link_kinetic[i]));
  }
  steps.back().holds = links.holds;  // of the velocities
  steps.push_back(links);

  Ex quadratic = 0;
  for (int i = 0; i < n_; ++i)
    for (int j = 0; j < n_; ++j)
      quadratic += algebra_.expression(e_.M[i][j]) * velocity(i) * velocity(j) / 2;
  steps.push_back({"kinetic energy T",
                   "The sum over the links.",
                   {equation("T", f_.kinetic, e_.kinetic)},
                   "T = qd' M qd / 2, with M from the composite bodies outboard of each joint",
                   isZero(f_.kinetic - quadratic)});

  Ex shares = 0;
  for (const Node& share : e_.link_potential) shares += algebra_.expression(share);
  bool constant_difference = true;
  for (int i = 0; i < n_; ++i)
    constant_difference = constant_difference && isZero(byPosition(f_.potential - shares, i));
  steps.push_back({"potential energy V",
                   "Minus gravity times the first moment of mass, and what the springs store.",
                   {equation("V", f_.potential, e_.potential)},
                   "V differs from the sum of the links' shares by a constant",
                   constant_difference});
}

void ClosedSteps::momenta() {
  Step step{"momenta p",
            "Of each joint: p_i = dT/dqd_i.",
            {},
            "GiNaC's derivative equals that of the program in reverse mode",
            true};
  for (int i = 0; i < n_; ++i) {
    step.equations.push_back(equation(numbered("p", i), f_.p[i], e_.p[i]));
    step.holds = step.holds && equals(f_.p[i], e_.p[i]);
  }
  steps.push_back(step);
}

void ClosedSteps::massMatrix() {
  Step step{"mass matrix M",
            "M_ij = dp_i/dqd_j.",
            {},
            "equals M_ji, and the matrix of the composite bodies",
            true,
            "M"};
  std::vector<Formula> entries(static_cast<std::size_t>(n_) * n_), names = entries;
  std::vector<Node> values(entries.size());
  std::size_t width = 0;
  for (int i = 0; i < n_; ++i) {
    for (int j = i; j < n_; ++j) {
      const std::string name = numbered("M", i, j);
      step.equations.push_back(equation(name, f_.M[i][j], e_.M[i][j]));
      step.holds = step.holds && isZero(f_.M[i][j] - f_.M[j][i]) && equals(f_.M[i][j], e_.M[i][j]);
      for (const int at : {i * n_ + j, j * n_ + i}) {
        entries[at] = step.equations.back().right;
        values[at] = e_.M[i][j];
        names[at] = symbolic::isZero(entries[at]) ? entries[at] : Formula::ofSymbol(name);
      }
      width = std::max(width, length(step.equations.back().right));
    }
  }
  if (n_ > 1)
    step.equations.push_back(
        {{Formula::ofSymbol("M"), Formula::matrix(width * n_ <= kWidestMatrix ? entries : names,
                                                  static_cast<std::size_t>(n_))},
         {},
         {},
         values});
  steps.push_back(step);
}

void ClosedSteps::christoffelSymbols() {
  Step step{"Christoffel symbols",
            "Gamma_ijk = (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i)/2; those that are not listed are "
            "0, and Gamma_ikj = Gamma_ijk.",
            {},
            "symmetric in j and k, and dM_ij/dq_k = Gamma_ijk + Gamma_jik",
            true,
            "c"};
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j < n_; ++j) {
      for (int k = 0; k < n_; ++k) {
        const Ex& gamma = f_.Gamma[i][j][k];
        step.holds = step.holds && isZero(gamma - f_.Gamma[i][k][j]) &&
                     isZero(byPosition(f_.M[i][j], k) - gamma - f_.Gamma[j][i][k]);
        if (k >= j && !isZero(gamma))
          step.equations.push_back(
              equation(christoffelName(i, j, k), gamma, christoffelSymbol(e_, i, j, k)));
      }
    }
  }
  steps.push_back(step);
}

void ClosedSteps::forces() {
  Step coriolis{"Coriolis and centrifugal forces c",
                "c_i = sum of Gamma_ijk qd_j qd_k.",
                {},
                "equals sum of (dp_i/dq_j) qd_j - dT/dq_i by the program",
                true,
                "c"};
  Step gravity{"gravity and springs g",
               "g_i = dV/dq_i.",
               {},
               "GiNaC's derivative equals that of the program in reverse mode",
               true,
               "g"};
  for (int i = 0; i < n_; ++i) {
    coriolis.equations.push_back(equation(numbered("c", i), f_.c[i], e_.c[i]));
    coriolis.holds = coriolis.holds && equals(f_.c[i], e_.c[i]);
    gravity.equations.push_back(equation(numbered("g", i), f_.g[i], e_.g[i]));
    gravity.holds = gravity.holds && equals(f_.g[i], e_.g[i]);
  }
  steps.push_back(coriolis);
  steps.push_back(gravity);
}

void ClosedSteps::loads() {
  if (!isLoaded(e_)) return;
  Step step{"loads Q", loadsSentence(e_), {}, kLoadsCheck, true};
  for (int i = 0; i < n_; ++i) {
    if (e_.graph.isZero(e_.Q[i])) continue;
    const Ex Q = algebra_.expression(e_.Q[i]), wrenches = Q + algebra_.expression(e_.friction[i]);
    for (int j = 0; j < n_; ++j) step.holds = step.holds && isZero(byVelocity(wrenches, j));
    step.equations.push_back(equation(numbered("Q", i), Q, e_.Q[i]));
  }
  steps.push_back(step);
}

void ClosedSteps::equationsOfMotion() {
  Step step{"equations of motion",
            "Lagrange's equation d/dt (dL/dqd_i) - dL/dq_i = tau_i with L = T - V: M qdd + c + g = "
            "tau.",
            {},
            "the left side equals d/dt (dL/dqd_i) - dL/dq_i by GiNaC",
            true};
  if (isLoaded(e_)) step.sentence += " Loads Q stand beside tau.";
  for (int i = 0; i < n_; ++i) {
    Ex row = f_.c[i] + f_.g[i];
    std::vector<Formula> terms;
    for (int j = 0; j < n_; ++j) {
      row += f_.M[i][j] * algebra_.input(Input::kAcceleration, j);
      if (!isZero(f_.M[i][j]))
        terms.push_back(Formula::product(
            {algebra_.formula(f_.M[i][j]), Formula::ofInput(Input::kAcceleration, j)}));
    }
    for (const Ex& x : {f_.c[i], f_.g[i]})
      if (!isZero(x)) terms.push_back(algebra_.formula(x));
    StepEquation equation = equationOfMotion(e_, i);
    if (const Formula written_out = flatSum(terms); length(written_out) <= kLongestRow)
      equation.left = written_out;
    step.equations.push_back(equation);
    const Ex lagrange = algebra_.rate(f_.p[i]) - byPosition(f_.kinetic - f_.potential, i);
    step.holds = step.holds && isZero(row - lagrange);
  }
  steps.push_back(step);
}

void ClosedSteps::linearizedEquations() {
  Step near{
      "linearized equations",
      "Beside a motion q, qd, qdd that tau keeps, to first order M dqdd + D dqd + K dq = dtau, "
      "D_ij = d(c - Q)_i/dqd_j, K_ij = d(M qdd + c + g - Q)_i/dq_j: of the state (dq, dqd), "
      "A = [0, 1; -M^-1 K, -M^-1 D] and B = [0; M^-1]. What is not listed is 0.",
      {},
      "GiNaC's derivatives equal those of the graph's inverse dynamics, which forms no M",
      true};
  Step rest{"linearized where it rests",
            "With qd = 0 and qdd = 0, K is H - dQ/dq, H_ij = d2V/dq_i dq_j, and D what friction "
            "leaves of it.",
            {},
            "H is symmetric, and K + dQ/dq without rates and accelerations",
            true};
  GiNaC::exmap at_rest;
  for (int j = 0; j < n_; ++j)
    at_rest[algebra_.input(Input::kVelocity, j)] =
        at_rest[algebra_.input(Input::kAcceleration, j)] = 0;
  const std::vector<Node> tau = inverseDynamics(e_);
  for (int i = 0; i < n_; ++i) {
    const Ex Q = algebra_.expression(e_.Q[i]);
    Ex force = f_.c[i] + f_.g[i] - Q;
    for (int j = 0; j < n_; ++j) force += f_.M[i][j] * algebra_.input(Input::kAcceleration, j);
    const std::vector<Node> slopes = positionGradient(e_, tau[i]);
    for (int j = 0; j < n_; ++j) {
      const Variable qd_j{Input::kVelocity, j};
      const Node by_rate =
          e_.graph.directionalDerivative({tau[i]}, {{qd_j, e_.graph.constant(1)}})[0];
      const Ex D = byVelocity(force, j), K = byPosition(force, j), H = byPosition(f_.g[i], j);
      near.holds = near.holds && equals(D, by_rate) && equals(K, slopes[j]);
      rest.holds = rest.holds && isZero(H - byPosition(f_.g[j], i)) &&
                   isZero((K + byPosition(Q, j)).subs(at_rest) - H);
      if (!isZero(D)) near.equations.push_back(equation(numbered("D", i, j), D, by_rate));
      if (!isZero(K)) near.equations.push_back(equation(numbered("K", i, j), K, slopes[j]));
      if (j >= i && !isZero(H))
        rest.equations.push_back(
            equation(numbered("H", i, j), H, positionGradient(e_, e_.g[i])[j]));
    }
  }
  steps.push_back(near);
  steps.push_back(rest);
}

// ---- straight-line programs ---------------------------------------------------------------------

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
};

/// The program's lines as equations, each under the first step that needs it, and after them what
/// the step is about.
void addLines(const Graph& graph, const std::vector<Result>& results, std::vector<Step>* steps) {
  std::vector<Node> nodes;
  for (const Result& r : results) nodes.push_back(r.node);
  const Program program = compile(graph, nodes);
  const std::vector<Statement> lines = statements(program, Style::kText);
  std::map<int, std::size_t> line_of;
  for (std::size_t i = 0; i < lines.size(); ++i) line_of[lines[i].slot] = i;
  std::vector<std::size_t> step_of(lines.size(), steps->size());
  for (std::size_t r = 0; r < results.size(); ++r) {
    std::vector<int> open{program.outputs[r]};
    while (!open.empty()) {
      const auto it = line_of.find(open.back());
      open.pop_back();
      if (it == line_of.end() || step_of[it->second] <= results[r].step) continue;
      step_of[it->second] = results[r].step;
      open.insert(open.end(), lines[it->second].reads.begin(), lines[it->second].reads.end());
    }
  }
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (step_of[i] < steps->size())
      (*steps)[step_of[i]].equations.push_back(
          {{Formula::ofSymbol(lines[i].name), lines[i].value}, {}, {}});
  for (std::size_t r = 0; r < results.size(); ++r) {
    if (graph.isZero(results[r].node)) continue;
    const auto it = line_of.find(program.outputs[r]);
    const Formula value = it != line_of.end() ? Formula::ofSymbol(lines[it->second].name)
                                              : leafFormula(program, program.outputs[r]);
    (*steps)[results[r].step].equations.push_back(
        {{Formula::ofSymbol(results[r].name), value}, {}, results[r].node});
  }
}

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
                       const std::vector<Node>& residuals) {
    steps.push_back({name, sentence, {}, what + at, check(residuals)});
  };
  add("kinetic energy T",
      "Angular velocity omega and velocity v of each link's joint frame, in that frame, and from "
      "them half of mass times velocity squared.",
      "T = qd' M qd / 2", {r.kinetic});
  add("potential energy V", "Minus gravity times the first moment of mass, and the springs.",
      "dV/dq is that of the links' shares", r.gravity);
  add("momentum p", "p_i = dT/dqd_i.", "p = M qd", r.momentum);
  add("mass matrix M", "M_ij = dp_i/dqd_j, with T as a sum over composite bodies.",
      "M qd is the momentum of T as a sum over links", r.momentum);
  add("Coriolis and centrifugal forces c",
      quasi ? "c_i = sum of (X_j p_i) qd_j - X_i T + sum of b_ijk qd_j p_k."
            : "c_i = sum of (dp_i/dq_j) qd_j - dT/dq_i.",
      quasi ? "the same from M alone, with p = M qd and T = qd' M qd/2"
            : "the same from M alone: d(M qd)/dt - d(qd' M qd/2)/dq",
      r.force);
  add("gravity and springs g", quasi ? "g_i = X_i V." : "g_i = dV/dq_i.",
      "equals the derivative of the links' shares", r.gravity);
  if (loaded) add("loads Q", loadsSentence(e), kLoadsCheck, rateSlopes(e));
  add("equations of motion",
      quasi ? "Lagrange's equations in quasi-velocities (Boltzmann, Hamel)."
            : "Lagrange's equations.",
      "power: qd' (M qdd + c + g) = d(T + V)/dt", {r.power});

  std::vector<Result> results = {{"T", e.kinetic, base}, {"V", e.potential, base + 1}};
  for (int i = 0; i < n; ++i) results.push_back({numbered("p", i), e.p[i], base + 2});
  for (int i = 0; i < n; ++i)
    for (int j = i; j < n; ++j) results.push_back({numbered("M", i, j), e.M[i][j], base + 3});
  for (int i = 0; i < n; ++i) results.push_back({numbered("c", i), e.c[i], base + 4});
  for (int i = 0; i < n; ++i) results.push_back({numbered("g", i), e.g[i], base + 5});
  for (int i = 0; i < n; ++i) results.push_back({numbered("Q", i), e.Q[i], base + 6});
  addLines(e.graph, results, &steps);
  for (int i = 0; i < n; ++i) steps.back().equations.push_back(equationOfMotion(e, i));
  return steps;
}

/// Which positions are no unknowns; empty without followers.
std::string followersSentence(const scene::Mechanism& mechanism) {
  std::string text;
  for (const scene::Follower& f : scene::followers(mechanism)) {
    const auto name = [&](int link) {
      return mechanism.links[static_cast<std::size_t>(link)].joint.name;
    };
    const std::string offset = f.offset.isLiteralZero() ? "" : " + " + f.offset.text();
    text += " Joint " + name(f.link) + " follows " + name(f.leader) + ": q" +
            std::to_string(f.slot + 1) + " = " + f.multiplier.str() + " q" +
            std::to_string(f.leader_slot + 1) + offset + ", and it has no rate of its own.";
  }
  return text;
}

}  // namespace

bool Derivation::holds() const {
  return std::all_of(steps.begin(), steps.end(), [](const Step& s) { return s.holds; });
}

bool hasClosedForm(const scene::Mechanism& mechanism) {
  return mechanism.dof() <= kClosedFormJoints && mechanism.dof() == mechanism.positions();
}

Derivation derivation(const scene::Mechanism& mechanism, bool linearized, int points) {
  if (linearized && !hasClosedForm(mechanism))
    throw std::invalid_argument("derivation: expected a mechanism with closed forms");
  Options options;
  options.regroup_inertias = false;  // the energy of a link is to be that link's
  scene::Work work("", 4);
  const auto whole = std::make_shared<Equations>(derive(mechanism, options));
  Equations& equations = *whole;
  Derivation result;
  result.mechanism = mechanism;
  result.equations = whole;
  result.joints = equations.joints;
  result.closed_form = hasClosedForm(mechanism);
  result.steps = result.closed_form ? ClosedSteps(mechanism, options, equations, linearized).steps
                                    : programSteps(equations, mechanism, points);
  if (!result.steps.empty()) result.steps.front().sentence += followersSentence(mechanism);
  return result;
}

std::string printText(const std::string& text, Style style) {
  std::string out;
  for (char ch : text) {
    if (style == Style::kMathml && ch == '<') {
      out += "&lt;";
    } else if (style == Style::kMathml && ch == '>') {
      out += "&gt;";
    } else if (style == Style::kMathml && ch == '&') {
      out += "&amp;";
    } else if (style == Style::kLatex && std::string("_%$#&{}").find(ch) != std::string::npos) {
      out += std::string("\\") + ch;
    } else if (style == Style::kLatex && (ch == '^' || ch == '~' || ch == '\\')) {
      out += ch == '\\' ? "\\textbackslash{}" : std::string("\\") + ch + "{}";
    } else {
      out += ch;
    }
  }
  return out;
}

std::string print(const Derivation& derivation, Style style) {
  std::string text;
  int number = 0;
  for (const Step& step : derivation.steps) {
    ++number;
    const std::string head = std::to_string(number) + ". " + printText(step.name, style);
    const std::string sentence = printText(step.sentence, style);
    const std::string verdict =
        printText(step.check, style) + (step.holds ? ": holds" : ": DOES NOT HOLD");
    switch (style) {
      case Style::kLatex:
        text += "\\paragraph{" + head + "} " + sentence + "\n\n";
        for (const Equation& e : step.equations)
          text += "\\hangpara $\\displaystyle " + print(e, style) + "$\n\n";
        text += "{\\small Check: " + verdict + ".}\n\n";
        break;
      case Style::kMathml:
        text += "<details class=\"step\" open=\"open\"><summary>" + head + "</summary>\n<p>" +
                sentence + "</p>\n";
        for (const Equation& e : step.equations)
          text += "<div class=\"equation\" data-latex=\"" +
                  printText(print(e, Style::kLatex), style) + "\">" + print(e, style) + "</div>\n";
        text += "<details class=\"" + std::string(step.holds ? "holds" : "fails") + "\"><summary>" +
                (step.holds ? "Checked exactly" : "DOES NOT HOLD") + "</summary><p>" + verdict +
                "</p></details></details>\n";
        break;
      default:
        text += head + "\n   " + sentence + "\n";
        for (const Equation& e : step.equations) text += "     " + print(e, Style::kText) + "\n";
        text += "   check: " + verdict + "\n\n";
    }
  }
  return text;
}

std::vector<ShownEquation> shortClosedForm(const scene::Mechanism& mechanism, std::size_t limit) {
  if (mechanism.dof() > kClosedFormJoints) return {};
  Options options;
  options.regroup_inertias = false;
  const Equations e = derive(mechanism, options);
  if (!e.quasi.empty() || e.hasFollowers()) return {};
  ClosedAlgebra algebra(e);
  using Of = ShownEquation::Of;
  std::vector<std::tuple<Of, std::string, Node>> wanted = {{Of::kKinetic, "T", e.kinetic},
                                                           {Of::kPotential, "V", e.potential}};
  const auto want = [&](const std::string& name, Node node) {
    wanted.emplace_back(Of::kMotion, name, node);
  };
  for (int i = 0; i < e.dof(); ++i)
    for (int j = i; j < e.dof(); ++j) want(numbered("M", i, j), e.M[i][j]);
  for (int i = 0; i < e.dof(); ++i) want(numbered("c", i), e.c[i]);
  for (int i = 0; i < e.dof(); ++i) want(numbered("g", i), e.g[i]);
  std::vector<ShownEquation> shown;
  for (const auto& [of, name, node] : wanted) {
    const Equation equation{Formula::ofSymbol(name), algebra.formula(algebra.expression(node))};
    if (print(equation, Style::kText).size() > limit) return {};
    shown.push_back({of, name, print(equation, Style::kMathml)});
  }
  return shown;
}

}  // namespace dynwitness::symbolic
