// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/linear_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "scene/work.hpp"
#include "symbolic/closed_form.hpp"
#include "symbolic/derivation_steps.hpp"
#include "symbolic/quasi_velocities.hpp"

namespace dynwitness::symbolic {
namespace {

using Matrix = LinearSystem::Matrix;

/// A fraction is not broken at the end of a line, of which 483 pt in LaTeX hold some 115 characters
/// of plain text (acrobot's longest dividend, 190, took 800 pt).
constexpr std::size_t kWidestFraction = 100;

/// A term is four letters and more: so many do not fit into a row.
constexpr std::size_t kMostTerms = kLongestRow / 4;

/// Nodes of a graph with some inputs put in.
class Substitution {
 public:
  Substitution(Graph* graph, const PutIn& at) : graph_(*graph) {
    const auto put = [this](Input input, int joint, int value) {
      put_[{input, joint}] = graph_.constant(value);
    };
    for (std::size_t k = 0; k < at.right_angles.size(); ++k) {
      if (!at.right_angles[k]) continue;
      const int quarters = *at.right_angles[k], joint = static_cast<int>(k);
      const auto point = scene::quarterTurns<int>(quarters);
      put(Input::kCos, joint, point.c);
      put(Input::kSin, joint, point.s);
      if (quarters == 0) put(Input::kPosition, joint, 0);
    }
    for (int k = 0; k < static_cast<int>(at.is_still.size()); ++k) {
      if (at.isStill(k)) put(Input::kVelocity, k, 0);
      if (at.is_unaccelerated) put(Input::kAcceleration, k, 0);
    }
  }

  Node operator()(Node node) {
    if (!graph_.dependsOnState(node)) return node;
    if (const auto known = done_.find(node.index); known != done_.end()) return known->second;
    const Node a = graph_.left(node), b = graph_.right(node);
    const int joint = graph_.joint(node);
    Node out;
    switch (graph_.op(node)) {
      case Op::kInput:
        out = input(graph_.inputKind(node), joint);
        break;
      case Op::kAdd:
        out = graph_.add((*this)(a), (*this)(b));
        break;
      case Op::kSubtract:
        out = graph_.subtract((*this)(a), (*this)(b));
        break;
      case Op::kMultiply:
        out = graph_.multiply((*this)(a), (*this)(b));
        break;
      case Op::kNegate:
        out = graph_.negate((*this)(a));
        break;
      case Op::kTurn:
        out = graph_.add(graph_.multiply(input(Input::kCos, joint), (*this)(a)),
                         graph_.multiply(input(Input::kSin, joint), (*this)(b)));
        break;
      case Op::kInverse:
        out = graph_.inverse((*this)(a));
        break;
      case Op::kConstant:
      case Op::kAtom:
        out = node;
    }
    return done_[node.index] = out;
  }

 private:
  Node input(Input input, int joint) {
    const auto put = put_.find({input, joint});
    return put == put_.end() ? graph_.input(input, joint) : put->second;
  }

  Graph& graph_;
  std::map<std::pair<Input, int>, Node> put_;
  std::map<int, Node> done_;
};

template <typename T>
using Rows = std::vector<std::vector<T>>;

template <typename T>
Rows<T> withoutRowAndColumn(const Rows<T>& m, std::size_t row, std::size_t column) {
  Rows<T> out;
  for (std::size_t i = 0; i < m.size(); ++i) {
    if (i == row) continue;
    out.emplace_back();
    for (std::size_t j = 0; j < m.size(); ++j)
      if (j != column) out.back().push_back(m[i][j]);
  }
  return out;
}

/// Along the first row; of no rows it is `one`.
template <typename T>
T determinant(const Rows<T>& m, const T& one) {
  if (m.empty()) return one;
  T sum = m[0][0] * determinant(withoutRowAndColumn(m, 0, 0), one);
  for (std::size_t j = 1; j < m.size(); ++j) {
    const T term = m[0][j] * determinant(withoutRowAndColumn(m, 0, j), one);
    sum = j % 2 == 0 ? sum + term : sum - term;
  }
  return sum;
}

/// adj(M)_ij = (-1)^(i + j) det(M without row j and column i): M adj(M) = det(M).
template <typename T>
Rows<T> adjugate(const Rows<T>& m, const T& one) {
  Rows<T> out(m.size());
  for (std::size_t i = 0; i < m.size(); ++i)
    for (std::size_t j = 0; j < m.size(); ++j) {
      const T minor = determinant(withoutRowAndColumn(m, j, i), one);
      out[i].push_back((i + j) % 2 == 0 ? minor : -minor);
    }
  return out;
}

template <typename T>
Rows<T> product(const Rows<T>& a, const Rows<T>& b) {
  Rows<T> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) {
      T sum = a[i][0] * b[0][j];
      for (std::size_t k = 1; k < b.size(); ++k) sum = sum + a[i][k] * b[k][j];
      out[i].push_back(sum);
    }
  return out;
}

/// A formula of names, of which determinants and products can be formed.
struct Named {
  Formula formula;

  bool is(int number) const {
    return formula.kind == Formula::Kind::kNumber && formula.number == number;
  }
  friend Named operator*(const Named& a, const Named& b) {
    if (a.is(0) || b.is(1)) return a;
    if (b.is(0) || a.is(1)) return b;
    return {Formula::product({a.formula, b.formula})};
  }
  friend Named operator+(const Named& a, const Named& b) {
    return a.is(0) ? b : b.is(0) ? a : Named{Formula::sum({a.formula, b.formula})};
  }
  Named operator-() const { return is(0) ? *this : Named{Formula::negate(formula)}; }
  friend Named operator-(const Named& a, const Named& b) { return a + -b; }
};

/// "q1 = pi, q2 = 0, qd = 0, qdd = 0"
std::string sentenceOf(const PutIn& at) {
  std::vector<std::string> said;
  for (std::size_t k = 0; k < at.right_angles.size(); ++k) {
    if (!at.right_angles[k]) continue;
    const int quarters = *at.right_angles[k], size = std::abs(quarters);
    const std::string number = size % 2 == 0 ? std::to_string(size / 2) : std::to_string(size);
    said.push_back(numbered("q", static_cast<int>(k)) + " = " + (quarters < 0 ? "-" : "") +
                   (quarters == 0
                        ? "0"
                        : (number == "1" ? "pi" : number + "*pi") + (size % 2 == 0 ? "" : "/2")));
  }
  const bool is_still =
      std::all_of(at.is_still.begin(), at.is_still.end(), [](bool b) { return b; });
  if (is_still) said.emplace_back("qd = 0");
  for (int k = 0; !is_still && k < static_cast<int>(at.is_still.size()); ++k)
    if (at.isStill(k)) said.push_back(numbered("qd", k) + " = 0");
  if (at.is_unaccelerated) said.emplace_back("qdd = 0");
  std::string text;
  for (const std::string& one : said) text += (text.empty() ? "" : ", ") + one;
  return text.empty() ? "any state" : text;
}

/// A quotient whose dividend can be broken at its signs where it is wide; none: the divisor is.
std::optional<Formula> inLines(const Formula& f) {
  const bool is_negative = f.kind == Formula::Kind::kNegate;
  const Formula& size = is_negative ? f.operands.front() : f;
  if (size.kind != Formula::Kind::kQuotient) return f;
  const Formula &dividend = size.operands[0], &divisor = size.operands[1];
  if (length(divisor) > kWidestFraction) return std::nullopt;
  if (length(dividend) <= kWidestFraction) return f;
  const Formula product = Formula::product({Formula::power(divisor, -1), dividend});
  return is_negative ? Formula::negate(product) : product;
}

/// The steps of linearSystem().
class Steps {
 public:
  Steps(const scene::Mechanism& mechanism, const PutIn& at, const std::vector<int>& actuated)
      : actuated_(actuated) {
    Options options;
    options.regroup_inertias = false;  // as derivation() has it, the same letters in the same order
    const auto whole = std::make_shared<Equations>(derive(mechanism, options));
    e_ = whole.get();
    n_ = e_->dof();
    Substitution put(&e_->graph, at);
    const std::vector<Node> forces = inverseDynamics(*e_);
    const Node one = e_->graph.constant(1);
    for (int i = 0; i < n_; ++i) {
      tau_.push_back(put(forces[i]));
      const std::vector<Node> slopes = positionGradient(*e_, forces[i]);
      for (auto* rows : {&M_, &K_, &D_}) rows->emplace_back();
      for (int j = 0; j < n_; ++j) {
        const Variable rate{Input::kVelocity, j};
        M_[i].push_back(put(e_->M[i][j]));
        K_[i].push_back(put(slopes[j]));
        D_[i].push_back(put(e_->graph.directionalDerivative({forces[i]}, {{rate, one}})[0]));
      }
    }
    algebra_.emplace(*e_);  // which asks for all numbers of the scene, and no others
    invert();
    jointForces(at);
    matrices();
    inverse();
    system();
    out.at = at;
    out.derivation.mechanism = mechanism;
    out.derivation.equations = whole;
    out.derivation.joints = e_->joints;
    out.derivation.closed_form = true;
    placeParameters(&out.derivation);
  }

  LinearSystem out;

 private:
  using Ex = GiNaC::ex;

  Rows<Value> values(const Matrix& nodes) const {
    Rows<Value> all(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (const Node node : nodes[i]) all[i].push_back({&e_->graph, node});
    return all;
  }
  Rows<Ex> expressions(const Matrix& nodes) {
    Rows<Ex> all(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (const Node node : nodes[i]) all[i].push_back(algebra_->expression(node));
    return all;
  }
  /// sign times a matrix over the determinant.
  Matrix overDeterminant(const Rows<Value>& m, int sign) const {
    Matrix nodes(m.size());
    for (std::size_t i = 0; i < m.size(); ++i)
      for (const Value& value : m[i]) {
        const Value quotient = value / Value{&e_->graph, determinant_};
        nodes[i].push_back((sign < 0 ? -quotient : quotient).node);
      }
    return nodes;
  }
  bool isZero(const Ex& x) { return algebra_->isZero(x); }

  void invert();
  void jointForces(const PutIn& at);
  void matrices();
  void addEntries(const std::string& letter, const Matrix& nodes, bool is_symmetric, Step* step);
  void inverse();
  /// dividends / Delta; what is too long, by names of what stands above.
  Rows<Formula> addQuotients(const std::string& letter, int row, int column,
                             const Rows<Ex>& dividends, const Rows<Named>& in_names,
                             const Matrix& nodes, bool is_symmetric, Step* step);
  void system();
  Rows<Named> namesOf(const std::string& letter, const Rows<Ex>& entries);
  static StepEquation matrixOf(const std::string& letter, const Rows<Formula>& shown,
                               const Rows<Formula>& names, const Matrix& nodes);

  const std::vector<int>& actuated_;
  Equations* e_ = nullptr;
  int n_ = 0;
  std::vector<Node> tau_;
  Matrix M_, K_, D_;
  Node determinant_;
  std::optional<ClosedAlgebra> algebra_;
  Rows<Ex> adjugate_;
  Rows<Formula> W_;
  Ex delta_;
};

void Steps::invert() {
  const Value one{&e_->graph, e_->graph.constant(1)};
  const Rows<Value> M = values(M_), adjugate_of_M = adjugate(M, one);
  determinant_ = determinant(M, one).node;
  adjugate_ = adjugate(expressions(M_), Ex(1));
  delta_ = determinant(expressions(M_), Ex(1)).expand();
  if (isZero(delta_)) throw std::domain_error("M is singular there, whatever the parameters are");
  out.by_position = overDeterminant(product(adjugate_of_M, values(K_)), -1);
  out.by_rate = overDeterminant(product(adjugate_of_M, values(D_)), -1);
  out.by_force = overDeterminant(adjugate_of_M, 1);
}

void Steps::jointForces(const PutIn& at) {
  Step step{"joint forces there",
            "At " + sentenceOf(at) + ": tau = M qdd + c + g - Q.",
            {},
            "equals M qdd + c + g - Q by entries",
            true};
  if (at.is_unaccelerated) step.sentence += " These forces hold it, since qdd = 0.";
  out.is_forceless = true;
  Substitution put(&e_->graph, at);
  for (int i = 0; i < n_; ++i) {
    const Ex tau = algebra_->expression(tau_[i]);
    Node sum = e_->graph.subtract(e_->graph.add(e_->c[i], e_->g[i]), e_->Q[i]);
    for (int j = 0; j < n_; ++j)
      sum = e_->graph.add(
          sum, e_->graph.multiply(e_->M[i][j], e_->graph.input(Input::kAcceleration, j)));
    step.holds = step.holds && isZero(tau - algebra_->expression(put(sum)));
    out.is_forceless = out.is_forceless && isZero(tau);
    step.equations.push_back(
        {{algebra_->formula(tau), Formula::ofInput(Input::kForce, i)}, tau_[i], {}});
  }
  out.derivation.steps.push_back(step);
}

void Steps::addEntries(const std::string& letter, const Matrix& nodes, bool is_symmetric,
                       Step* step) {
  for (int i = 0; i < n_; ++i)
    for (int j = is_symmetric ? i : 0; j < n_; ++j) {
      const Ex x = algebra_->expression(nodes[i][j]);
      const std::string name = numbered(letter, i, j);
      if (isZero(x))
        step->zeros.push_back(name);
      else
        step->equations.push_back(
            {{Formula::ofSymbol(name), algebra_->formula(x)}, {}, nodes[i][j]});
    }
}

void Steps::matrices() {
  const Rows<Ex> M = expressions(M_);
  Step mass{"mass matrix there",
            n_ > 1 ? "M, and Delta = det M." : "M.",
            {},
            "M is symmetric, and M adj(M) = Delta",
            true};
  addEntries("M", M_, true, &mass);
  const Rows<Ex> unit = product(M, adjugate_);
  for (int i = 0; i < n_; ++i)
    for (int j = 0; j < n_; ++j)
      mass.holds = mass.holds && isZero(M[i][j] - M[j][i]) &&
                   isZero(i == j ? unit[i][j] - delta_ : unit[i][j]);
  if (n_ > 1)
    mass.equations.push_back(
        {{Formula::ofSymbol("Delta"), algebra_->formula(delta_)}, {}, determinant_});
  out.derivation.steps.push_back(mass);
  Step slopes{"stiffness and damping there",
              "K_ij = dtau_i/dq_j and D_ij = dtau_i/dqd_j: beside this state, to first order, "
              "M dqdd + D dqd + K dq = dtau.",
              {},
              "",
              true};
  addEntries("K", K_, false, &slopes);
  addEntries("D", D_, false, &slopes);
  out.derivation.steps.push_back(slopes);
}

/// "M12", or 0.
Rows<Named> Steps::namesOf(const std::string& letter, const Rows<Ex>& entries) {
  Rows<Named> names(entries.size());
  for (int i = 0; i < n_; ++i)
    for (int j = 0; j < n_; ++j) {
      const std::string name = letter == "K" || letter == "D"
                                   ? numbered(letter, i, j)
                                   : numbered(letter, std::min(i, j), std::max(i, j));
      const bool is_zero = isZero(entries[i][j]);
      names[i].push_back({is_zero ? Formula::ofNumber(0) : Formula::ofSymbol(name)});
    }
  return names;
}

Rows<Formula> Steps::addQuotients(const std::string& letter, int row, int column,
                                  const Rows<Ex>& dividends, const Rows<Named>& in_names,
                                  const Matrix& nodes, bool is_symmetric, Step* step) {
  Rows<Formula> shown(dividends.size(),
                      std::vector<Formula>(dividends.size(), Formula::ofNumber(0)));
  for (int i = 0; i < n_; ++i)
    for (int j = is_symmetric ? i : 0; j < n_; ++j) {
      if (isZero(dividends[i][j])) continue;
      std::optional<Formula> quotient = algebra_->quotient(dividends[i][j], delta_, kMostTerms);
      if (quotient) quotient = inLines(*quotient);
      const Formula name = Formula::ofSymbol(numbered(letter, row + i, column + j));
      const bool is_long = !quotient || length(*quotient) > kLongestRow;
      const Formula& value = is_long ? in_names[i][j].formula : *quotient;
      step->equations.push_back({{name, value}, {}, nodes[i][j]});
      shown[i][j] = is_long ? name : value;
      if (is_symmetric) shown[j][i] = shown[i][j];
    }
  return shown;
}

void Steps::inverse() {
  Step step{"inverse of the mass matrix", "W is the inverse of M.", {}, "", true};
  Rows<Named> in_names = adjugate(namesOf("M", expressions(M_)), Named{Formula::ofNumber(1)});
  const Formula delta = Formula::ofSymbol(n_ > 1 ? "Delta" : "M11");
  for (auto& row : in_names)
    for (Named& entry : row) entry.formula = Formula::quotient(entry.formula, delta);
  W_ = addQuotients("W", 0, 0, adjugate_, in_names, out.by_force, true, &step);
  out.derivation.steps.push_back(step);
}

/// The matrix, by names where it would be too wide.
StepEquation Steps::matrixOf(const std::string& letter, const Rows<Formula>& shown,
                             const Rows<Formula>& names, const Matrix& nodes) {
  std::vector<Formula> all, all_names;
  std::vector<Node> values;
  std::size_t width = 0;
  const std::size_t columns = shown.front().size();
  for (std::size_t i = 0; i < shown.size(); ++i)
    for (std::size_t j = 0; j < columns; ++j) {
      all.push_back(shown[i][j]);
      all_names.push_back(names[i][j]);
      values.push_back(nodes[i][j]);
      width = std::max(width, length(shown[i][j]));
    }
  return {{Formula::ofSymbol(letter),
           Formula::matrix(width * columns <= kWidestMatrix ? all : all_names, columns)},
          {},
          {},
          values};
}

void Steps::system() {
  Step step{"A and B",
            "The rate of (dq, dqd) is A (dq, dqd) + B dtau: above dqd, below "
            "dqdd = W (dtau - K dq - D dqd).",
            {},
            "M times the lower half of A is -(K, D)",
            true};
  const Rows<Ex> M = expressions(M_);
  const Rows<Named> W = namesOf("W", adjugate_);
  const std::size_t n = static_cast<std::size_t>(n_), columns = actuated_.size();
  const Formula zero = Formula::ofNumber(0), one = Formula::ofNumber(1);
  Rows<Formula> A(2 * n, std::vector<Formula>(2 * n, zero)),
      A_names = A, B(2 * n, std::vector<Formula>(columns, zero)), B_names = B;
  Matrix A_nodes(2 * n, std::vector<Node>(2 * n)), B_nodes(2 * n, std::vector<Node>(columns));
  const auto addBlock = [&](int column, const std::string& letter, const Matrix& slopes,
                            const Matrix& nodes) {
    const Rows<Ex> times = expressions(slopes);
    Rows<Ex> dividends = product(adjugate_, times);
    for (auto& row : dividends)
      for (Ex& x : row) x = (-x).expand();
    const Rows<Ex> left = product(M, dividends);
    Rows<Named> in_names = product(W, namesOf(letter, times));
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < n_; ++j) {
        step.holds = step.holds && isZero(left[i][j] + delta_ * times[i][j]);
        in_names[i][j] = -in_names[i][j];
      }
    const Rows<Formula> shown =
        addQuotients("A", n_, column, dividends, in_names, nodes, false, &step);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        const std::size_t at = j + static_cast<std::size_t>(column);
        A[n + i][at] = A_names[n + i][at] = shown[i][j];
        A_nodes[n + i][at] = nodes[i][j];
        if (!symbolic::isZero(shown[i][j]))
          A_names[n + i][at] =
              Formula::ofSymbol(numbered("A", n_ + static_cast<int>(i), static_cast<int>(at)));
      }
  };
  addBlock(0, "K", K_, out.by_position);
  addBlock(n_, "D", D_, out.by_rate);
  for (std::size_t i = 0; i < n; ++i) {
    A[i][n + i] = A_names[i][n + i] = one;
    A_nodes[i][n + i] = e_->graph.constant(1);
    for (std::size_t k = 0; k < columns; ++k) {
      const auto j = static_cast<std::size_t>(actuated_[k]);
      B[n + i][k] = W_[i][j];
      B_names[n + i][k] = W[i][j].formula;
      B_nodes[n + i][k] = out.by_force[i][j];
    }
  }
  step.equations.push_back(matrixOf("A", A, A_names, A_nodes));
  if (columns > 0) step.equations.push_back(matrixOf("B", B, B_names, B_nodes));
  out.derivation.steps.push_back(step);
}

}  // namespace

PutIn putIn(const scene::Mechanism& mechanism, const std::vector<double>& q,
            const std::vector<double>& qd, bool is_unaccelerated, double near) {
  PutIn at;
  at.is_unaccelerated = is_unaccelerated;
  const double right_angle = std::acos(0.0);
  std::size_t k = 0;
  for (const scene::Link& link : mechanism.links)
    for (const scene::SlotKind kind : scene::positionSlots(link.joint.kind)) {
      const bool turns =
          kind == scene::SlotKind::kAngle && link.joint.kind != scene::JointKind::kHelical;
      const double turned = turns ? std::round(q[k] / right_angle) : 0;
      at.right_angles.emplace_back();
      const double ulp = std::numeric_limits<double>::epsilon() * std::abs(q[k]);
      if (std::abs(q[k] - turned * right_angle) <= std::max(near, ulp) &&
          std::abs(turned) < std::numeric_limits<int>::max())
        at.right_angles.back() = static_cast<int>(turned);
      ++k;
    }
  for (const double rate : qd) at.is_still.push_back(rate == 0);
  return at;
}

LinearSystem linearSystem(const scene::Mechanism& mechanism, const PutIn& at,
                          const std::vector<int>& actuated) {
  if (!hasClosedForm(mechanism))
    throw std::invalid_argument("linearSystem: expected a mechanism with closed forms");
  const scene::Work work("A and B in letters", 0, 1);
  return std::move(Steps(mechanism, at, actuated).out);
}

}  // namespace dynwitness::symbolic
