// SPDX-License-Identifier: GPL-3.0-or-later
// The steps of mechanisms of many joints.
#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "scene/work.hpp"
#include "symbolic/closed_form.hpp"
#include "symbolic/derivation_steps.hpp"
#include "symbolic/exact_points.hpp"
#include "symbolic/link_motions.hpp"
#include "symbolic/quasi_velocities.hpp"
#include "symbolic/step_lines.hpp"

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

/// Which results are short: decided for each, where rates are derivatives and positions are theirs.
void closeShortOnes(const Equations& e, ClosedAlgebra* algebra, std::vector<Result>* results) {
  for (Result& r : *results) {
    if (algebra) r.closed = algebra->shortFormula(r.node);
    if (e.graph.isZero(r.node)) r.closed = Formula::ofNumber(0);
  }
}

/// m (v_x^2 + v_y^2 + v_z^2)/2 + (I_xx omega_x^2 + ...)/2 of a body's links and its rotor, by the
/// names that stand in the step before; none: not all stand there.
std::optional<Formula> kineticByNames(const LinkMotions& motions, int body, ClosedAlgebra* algebra,
                                      const std::set<std::string>& in_velocities) {
  const Formula half = Formula::ofNumber(Rational(1, 2));
  const auto named = [&](const Value& value, const std::string& name) {
    const std::optional<Formula> closed = algebra->shortFormula(value.node);
    const bool zero = closed && isZero(*closed);
    return zero ? *closed : Formula::ofSymbol(name);
  };
  std::vector<Formula> terms;
  const auto add = [&](const Value& number, const std::vector<Formula>& factors) {
    const std::optional<Formula> front = algebra->shortFormula(number.node);
    if (!front) return false;
    if (isZero(*front) || std::any_of(factors.begin(), factors.end(), isZero)) return true;
    std::vector<Formula> all{*front};
    all.insert(all.end(), factors.begin(), factors.end());
    terms.push_back(Formula::product(all));
    return true;
  };
  const Value rotor = motions.rotor_kinetic[static_cast<std::size_t>(body)];
  if (!add(rotor, {})) return std::nullopt;
  for (const LinkMotion& link : motions.links) {
    if (link.body != body) continue;
    if (in_velocities.count(link.link) == 0) return std::nullopt;
    const Value one_half = constant(rotor.graph, Rational(1, 2));
    std::vector<Formula> squares, w;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string of = std::string("_") + "xyz"[k] + "_" + link.link;
      const Formula v = named(link.velocity[k], "v" + of);
      if (!isZero(v)) squares.push_back(Formula::power(v, 2));
      w.push_back(named(link.carried[k], "omega" + of));
    }
    if (!squares.empty() && !add(one_half * link.mass, {Formula::sum(squares)}))
      return std::nullopt;
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) {
        const Formula &a = w[static_cast<std::size_t>(i)], &b = w[static_cast<std::size_t>(j)];
        const bool is_known =
            i == j ? isZero(a) || add(one_half * link.inertia(i, i), {Formula::power(a, 2)})
                   : add(link.inertia(i, j), {a, b});
        if (!is_known) return std::nullopt;
      }
  }
  return Formula::sum(terms);
}

/// T as the sum of the links' shares, where it is no short formula itself.
void sumOfShares(const std::vector<Result>& shares, Result* T) {
  if (T->closed) return;
  std::vector<Formula> names;
  for (const Result& share : shares)
    if (!share.closed || !isZero(*share.closed)) names.push_back(Formula::ofSymbol(share.name));
  T->closed = Formula::sum(names);
}

// ---- short ones beside ------------------------------------------------------------------------

/// More joints have too many of these to read [joints].
constexpr int kMostJointsListed = 12;

/// Equations that are short, and the names of those that are not; what is 0 is left out.
class ShortOnes {
 public:
  ShortOnes(ClosedAlgebra* algebra, Step* step) : algebra_(algebra), step_(*step) {}

  /// @param hopeful  false: what it is made of is long
  bool add(const std::string& name, Node node, bool hopeful = true) {
    const std::optional<Formula> closed =
        hopeful ? algebra_->shortFormula(node) : std::optional<Formula>();
    if (!closed)
      long_.push_back(name);
    else if (!isZero(*closed))
      step_.equations.push_back({{Formula::ofSymbol(name), *closed}, {}, node});
    return closed.has_value();
  }
  void sayLongOnes() {
    constexpr std::size_t kMost = 24;
    if (long_.empty()) return;
    std::string text = "Longer than one line, and not shown: ";
    for (std::size_t k = 0; k < std::min(long_.size(), kMost); ++k)
      text += (k == 0 ? "" : ", ") + long_[k];
    if (long_.size() > kMost)
      text += ", and " + std::to_string(long_.size() - kMost) + " others; the rest is 0";
    step_.remarks.push_back(text + ".");
  }

 private:
  ClosedAlgebra* algebra_;
  Step& step_;
  std::vector<std::string> long_;
};

using Check = std::function<bool(const std::vector<Node>&)>;

/// Where the links are and how they move, link by link.
/// @param in_velocities  gets the links of which all velocities are shown or 0
std::vector<Step> motionSteps(Equations& e, const LinkMotions& motions, ClosedAlgebra* algebra,
                              const std::string& at, const Check& check,
                              std::set<std::string>* in_velocities) {
  Graph* graph = &e.graph;
  std::vector<Vector3> sums(motions.first_moments.size(), zeroVector(graph));
  std::vector<Value> kinetic = motions.rotor_kinetic;
  Step positions{"positions", kPositionsSentence, {}, kPositionsCheck + at, false},
      velocities{
          "velocities",
          kVelocitiesSentence,
          {},
          "omega, carried from joint to joint, is that of R; half of mass times velocity squared is T of each link, from velocities carried from joint to joint instead" +
              at,
          false};
  ShortOnes far(algebra, &positions), fast(algebra, &velocities);
  for (const LinkMotion& link : motions.links) {
    sums[static_cast<std::size_t>(link.body)] =
        sums[static_cast<std::size_t>(link.body)] + link.mass * link.position;
    kinetic[static_cast<std::size_t>(link.body)] += link.kinetic;
    bool all_short = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string axis(1, "xyz"[k]);
      const bool near = far.add(axis + "_" + link.link, link.position[k].node);
      const bool slow = fast.add("v_" + axis + "_" + link.link, link.velocity[k].node, near);
      all_short = all_short && slow;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const bool slow =
          fast.add("omega_" + std::string(1, "xyz"[k]) + "_" + link.link, link.carried[k].node);
      all_short = all_short && slow;
    }
    if (all_short) in_velocities->insert(link.link);
  }
  std::vector<Node> moments, energies;
  for (const LinkMotion& link : motions.links)
    for (std::size_t k = 0; k < 3; ++k)
      energies.push_back((link.carried[k] - link.angular[k]).node);
  for (std::size_t body = 0; body < sums.size(); ++body) {
    for (std::size_t k = 0; k < 3; ++k)
      moments.push_back((sums[body][k] - motions.first_moments[body][k]).node);
    energies.push_back((kinetic[body] - Value{graph, e.link_kinetic[body]}).node);
  }
  positions.holds = check(moments);
  velocities.holds = check(energies);
  far.sayLongOnes();
  fast.sayLongOnes();
  return {positions, velocities};
}

/// @param is_short  whether M_ij is: no symbol is looked for in others
Step christoffelStep(Equations& e, ClosedAlgebra* algebra, const std::string& at,
                     const Check& check, const std::function<bool(int, int)>& is_short) {
  Step step{"Christoffel symbols",
            kChristoffelSentence,
            {},
            "c_i = sum of Gamma_ijk qd_j qd_k" + at,
            false,
            "c"};
  const int n = e.dof();
  Graph* graph = &e.graph;
  const std::vector<Node> symbols = christoffelSymbols(e);
  ShortOnes all(algebra, &step);
  std::vector<Node> residuals;
  for (int i = 0; i < n; ++i) {
    Value c{graph, graph->negate(e.c[static_cast<std::size_t>(i)])};
    for (int j = 0; j < n; ++j)
      for (int k = j; k < n; ++k) {
        const Value gamma{graph, symbols[static_cast<std::size_t>((i * n + j) * n + k)]};
        all.add(christoffelName(i, j, k), gamma.node,
                e.graph.isZero(gamma.node) || (is_short(i, j) && is_short(i, k) && is_short(j, k)));
        c += constant(graph, j == k ? 1 : 2) * gamma * input(graph, Input::kVelocity, j) *
             input(graph, Input::kVelocity, k);
      }
    residuals.push_back(c.node);
  }
  step.holds = check(residuals);
  all.sayLongOnes();
  return step;
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

/// The steps of a program in their order: residuals first, then results, then what is short.
class ProgramSteps {
 public:
  ProgramSteps(Equations& e, const scene::Mechanism& mechanism, const Options& options, int points)
      : e_(e),
        mechanism_(mechanism),
        points_(points),
        work_("checks of the steps at rational points", (isLoaded(e) ? 8 : 7) + (listed_ ? 3 : 0),
              3),
        check_([this](const std::vector<Node>& residuals) {
          const bool holds = vanish(e_, residuals, mechanism_, points_);
          work_.done();
          return holds;
        }) {
    nameCompositeBodies(mechanism, options, e);
    link_of_ = linksOfRates(mechanism, options, e);
    if (listed_) motions_ = linkMotions(mechanism, options, e);
    if (is_plain_) algebra_.emplace(e);
    const Residuals residuals = residualsOf(e);
    steps_ = quasiSteps(e, points, check_);
    if (listed_) {  // positions and velocities: when it is known what is short
      motion_at_ = static_cast<long>(steps_.size());
      steps_.resize(steps_.size() + 2);
    }
    addSteps(residuals);
    addResults();
    closeResults();
    addLines(e, mechanism, results_, &steps_);
    addEquations();
  }

  std::vector<Step> steps() && { return std::move(steps_); }

 private:
  std::size_t add(const char* name, const std::string& sentence, const std::string& what,
                  const std::vector<Node>& residuals, const char* quantity = "") {
    steps_.push_back({name, sentence, {}, what + at_, check_(residuals), quantity});
    return steps_.size() - 1;
  }
  void addSteps(const Residuals& r);
  void addForces(const Residuals& r);
  void addResults();
  void closeResults();
  void addEquations();
  /// The letter of a joint for each of its forces or momenta.
  void ofJoints(const std::string& letter, const std::vector<Node>& nodes, std::size_t step,
                bool is_momentum = false) {
    for (int i = 0; i < n_; ++i)
      results_.push_back({numbered(letter, i), nodes[static_cast<std::size_t>(i)], step, linkOf(i),
                          is_momentum ? force(i) - kTurning : force(i)});
  }

  bool turns(int i) const { return e_.revolute[static_cast<std::size_t>(i)]; }
  Dimension force(int i) const { return turns(i) ? kMoment : kForce; }
  Dimension rate(int i) const { return turns(i) ? kTurning : kVelocity; }
  int linkOf(int i) const { return link_of_[static_cast<std::size_t>(i)]; }
  ClosedAlgebra* algebra() { return algebra_ ? &*algebra_ : nullptr; }

  Equations& e_;
  const scene::Mechanism& mechanism_;
  const int points_, n_ = e_.dof();
  const std::string at_ = " at " + std::to_string(points_) + " random rational points";
  const bool quasi_ = !e_.quasi.empty(), is_plain_ = !quasi_ && !e_.hasFollowers(),
             listed_ = is_plain_ && n_ <= kMostJointsListed;
  scene::Work work_;
  const Check check_;
  std::vector<int> link_of_;
  std::optional<LinkMotions> motions_;
  std::optional<ClosedAlgebra> algebra_;
  std::vector<Step> steps_;
  std::vector<Result> results_;
  long motion_at_ = 0;  ///< where positions and velocities stand
  std::size_t shares_ = 0, T_ = 0, V_ = 0, p_ = 0, M_ = 0, Gamma_ = 0, c_ = 0, g_ = 0,
              Q_ = 0;  ///< where the steps of these stand
};

void ProgramSteps::addSteps(const Residuals& r) {
  shares_ = add("kinetic energies of the links",
                "Angular velocity omega and velocity v of each link's joint frame, in that frame, "
                "and from them half of mass times velocity squared.",
                "T = qd' M qd / 2", {r.kinetic});
  T_ = add("kinetic energy T", "The sum over the links.", "dT/dqd = M qd", r.momentum);
  V_ = add("potential energy V", "Minus gravity times the first moment of mass, and the springs.",
           "dV/dq is that of the links' shares", r.gravity);
  p_ = add("momenta p", "p_i = dT/dqd_i.", "p = M qd", r.momentum);
  M_ = add("mass matrix M", "M_ij = dp_i/dqd_j, with T as a sum over composite bodies.",
           "M qd is the momentum of T as a sum over links", r.momentum, "M");
  Gamma_ = steps_.size();
  if (listed_) steps_.emplace_back();
  addForces(r);
}

void ProgramSteps::addForces(const Residuals& r) {
  c_ = add("Coriolis and centrifugal forces c",
           quasi_ ? "c_i = sum of (X_j p_i) qd_j - X_i T + sum of b_ijk qd_j p_k."
                  : "c_i = sum of (dp_i/dq_j) qd_j - dT/dq_i.",
           quasi_ ? "the same from M alone, with p = M qd and T = qd' M qd/2"
                  : "the same from M alone: d(M qd)/dt - d(qd' M qd/2)/dq",
           r.force, "c");
  g_ = add("gravity and springs g", quasi_ ? "g_i = X_i V." : "g_i = dV/dq_i.",
           "equals the derivative of the links' shares", r.gravity, "g");
  if (isLoaded(e_)) Q_ = add("loads Q", loadsSentence(e_), kLoadsCheck, rateSlopes(e_));
  add("equations of motion",
      quasi_ ? "Lagrange's equations in quasi-velocities (Boltzmann, Hamel)."
             : "Lagrange's equations.",
      "power: qd' (M qdd + c + g) = d(T + V)/dt", {r.power});
}

void ProgramSteps::addResults() {
  for (std::size_t k = 0; k < e_.links.size(); ++k)
    results_.push_back(
        {"T_" + e_.links[k], e_.link_kinetic[k], shares_, static_cast<int>(k), kMoment});
  results_.push_back({"T", e_.kinetic, T_, -1, kMoment});
  results_.push_back({"V", e_.potential, V_, -1, kMoment});
  ofJoints("p", e_.p, p_, true);
  for (int i = 0; i < n_; ++i)
    for (int j = i; j < n_; ++j)
      results_.push_back({numbered("M", i, j), e_.M[i][j], M_, std::max(linkOf(i), linkOf(j)),
                          force(i) - kTurning - rate(j)});
  ofJoints("c", e_.c, c_);
  ofJoints("g", e_.g, g_);
  if (isLoaded(e_)) ofJoints("Q", e_.Q, Q_);
}

/// Which results are short, and T and its shares by the names of what stands above them.
void ProgramSteps::closeResults() {
  closeShortOnes(e_, algebra(), &results_);
  const auto of_links = static_cast<long>(e_.links.size());
  if (listed_) {
    std::set<std::string> in_velocities;
    const std::vector<Step> motion =
        motionSteps(e_, *motions_, algebra(), at_, check_, &in_velocities);
    std::copy(motion.begin(), motion.end(), steps_.begin() + motion_at_);
    for (long k = 0; k < of_links; ++k)
      if (Result& share = results_[static_cast<std::size_t>(k)]; !share.closed)
        share.closed = kineticByNames(*motions_, static_cast<int>(k), algebra(), in_velocities);
  }
  sumOfShares({results_.begin(), results_.begin() + of_links},
              &results_[static_cast<std::size_t>(of_links)]);
}

/// M as a matrix, the equations of motion and Christoffel symbols.
void ProgramSteps::addEquations() {
  if (n_ > 1 && n_ <= kMostJointsListed)
    if (const auto matrix = namedMatrix(e_, results_)) steps_[M_].equations.push_back(*matrix);
  std::map<std::string, Formula> shown;
  for (const Result& r : results_) shown[r.name] = r.closed ? *r.closed : Formula::ofSymbol(r.name);
  for (int i = 0; i < n_; ++i)
    steps_.back().equations.push_back(equationOfMotion(
        e_, i, [&shown](const std::string& name, Node) { return shown.at(name); }));
  if (!listed_) return;
  steps_[Gamma_] = christoffelStep(e_, algebra(), at_, check_, [&](int i, int j) {
    const std::string name = numbered("M", std::min(i, j), std::max(i, j));
    return shown.at(name).symbol != name;
  });
}

}  // namespace

std::vector<Step> programSteps(Equations& e, const scene::Mechanism& mechanism,
                               const Options& options, int points) {
  return ProgramSteps(e, mechanism, options, points).steps();
}

}  // namespace dynwitness::symbolic
