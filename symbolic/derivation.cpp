// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/derivation.hpp"

#include <algorithm>
#include <stdexcept>

#include "scene/mimic.hpp"
#include "scene/work.hpp"
#include "symbolic/closed_form.hpp"
#include "symbolic/derivation_steps.hpp"
#include "symbolic/link_motions.hpp"
#include "symbolic/quasi_velocities.hpp"

namespace dynwitness::symbolic {

namespace {

// ---- closed forms -------------------------------------------------------------------------------

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
  Step step{"positions", kPositionsSentence, {}, kPositionsCheck, true};
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
  Step step{"velocities",
            kVelocitiesSentence,
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
            kChristoffelSentence,
            {},
            "symmetric in j and k, and dM_ij/dq_k = Gamma_ijk + Gamma_jik",
            true,
            "c"};
  const std::vector<Node> symbols = symbolic::christoffelSymbols(e_);
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j < n_; ++j) {
      for (int k = 0; k < n_; ++k) {
        const Ex& gamma = f_.Gamma[i][j][k];
        step.holds = step.holds && isZero(gamma - f_.Gamma[i][k][j]) &&
                     isZero(byPosition(f_.M[i][j], k) - gamma - f_.Gamma[j][i][k]);
        if (k >= j && !isZero(gamma))
          step.equations.push_back(
              equation(christoffelName(i, j, k), gamma, symbols[(i * n_ + j) * n_ + k]));
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
    for (int j = 0; j < n_; ++j) row += f_.M[i][j] * algebra_.input(Input::kAcceleration, j);
    step.equations.push_back(equationOfMotion(e_, i, [this](const std::string&, Node node) {
      return algebra_.formula(algebra_.expression(node));
    }));
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

Formula Derivation::input(Input input, int joint) const {
  Formula f = Formula::ofInput(input, joint);
  const std::vector<std::string>& names =
      input == Input::kPosition || input == Input::kCos || input == Input::kSin ? positions : rates;
  if (input != Input::kForce && input != Input::kRotation &&
      static_cast<std::size_t>(joint) < names.size())
    f.symbol = names[static_cast<std::size_t>(joint)];
  return f;
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
                                    : programSteps(equations, mechanism, options, points);
  if (!result.steps.empty()) result.steps.front().sentence += followersSentence(mechanism);
  placeParameters(&result);
  return result;
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
