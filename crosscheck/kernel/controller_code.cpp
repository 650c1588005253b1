// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/kernel/controller_code.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "crosscheck/kernel/controller_text.hpp"
#include "crosscheck/kernel/factor.hpp"
#include "crosscheck/scalars/digits50.hpp"
#include "crosscheck/scalars/single_error.hpp"
#include "crosscheck/scalars/traced.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/point_motion.hpp"
#include "recursive/regressor.hpp"
#include "symbolic/equations.hpp"

namespace dynwitness::crosscheck::kernel {
namespace {

using recursive::MatrixX;
using symbolic::Input;
using symbolic::Program;

template <typename T>
std::vector<T> rows(const MatrixX<T>& m) {
  std::vector<T> out;
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index j = 0; j < m.cols(); ++j) out.push_back(m(i, j));
  return out;
}

/// A quantity by the sweeps of recursive/, row by row, on any scalar.
template <typename T, typename Numbers>
std::vector<T> swept(CodeQuantity quantity, const recursive::Model<T>& model,
                     const scene::State<T>& s, const Numbers& number,
                     const std::vector<scene::InertialParameter>& parameters,
                     const std::optional<CodePoint>& point) {
  using recursive::Terms;
  recursive::Workspace<T> ws(model);
  const std::vector<T> none(model.dof(), T(0));
  std::vector<T> out(none);
  const auto inverse = [&](const std::vector<T>& qd, const std::vector<T>& qdd, Terms terms) {
    recursive::inverseDynamics(model, s.x, qd, qdd, ws, out, terms);
    return out;
  };
  switch (quantity) {
    case CodeQuantity::kTau:
      return inverse(s.qd, s.qdd, Terms::all());
    case CodeQuantity::kQdd:
      recursive::forwardDynamics(model, s.x, s.qd, s.tau, ws, out);
      return out;
    case CodeQuantity::kM: {
      MatrixX<T> M(model.dof(), model.dof());
      recursive::massMatrix(model, s.x, ws, M);
      return rows(M);
    }
    case CodeQuantity::kC:
      return rows<T>(recursive::coriolisMatrix(model, s.x, s.qd, ws));
    case CodeQuantity::kc:
      return inverse(s.qd, none, Terms::none());
    case CodeQuantity::kg:
      return inverse(none, none, Terms::potential());
    case CodeQuantity::kY: {
      MatrixX<T> Y(model.dof(), static_cast<Eigen::Index>(parameters.size()));
      recursive::regressor(model, parameters, s.x, s.qd, s.qdd, ws, Y);
      return rows(Y);
    }
    default:
      break;
  }
  const recursive::Vector3<T> at(number(point->at[0]), number(point->at[1]), number(point->at[2]));
  const recursive::PointMotion<T> motion =
      recursive::pointMotion(model, s.x, s.qd, none, static_cast<std::size_t>(point->link), at, ws);
  switch (quantity) {
    case CodeQuantity::kPosition:
      return {motion.position.x(), motion.position.y(), motion.position.z()};
    case CodeQuantity::kOrientation:
      return rows<T>(motion.R);
    case CodeQuantity::kJacobian:
      return rows(motion.J);
    default:
      return rows(motion.J_rate);
  }
}

/** C of Christoffel's symbols of M, which are derivatives of the Lagrangian's:
        C_ij = sum_k (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) qd_k / 2
    Where rates are derivatives of coordinates. */
Program christoffel(const scene::Mechanism& mechanism, bool fold_parameters) {
  symbolic::Options options;
  options.fold_parameters = fold_parameters;
  symbolic::Equations equations = symbolic::derive(mechanism, options);
  symbolic::Graph& graph = equations.graph;
  const Traced::Recording recording(graph);
  const int n = equations.dof();
  std::vector<symbolic::Node> M;
  for (const auto& row : equations.M) M.insert(M.end(), row.begin(), row.end());
  std::vector<std::vector<symbolic::Node>> dM;  // by q_k
  for (const symbolic::Direction& direction : equations.directions)
    dM.push_back(graph.directionalDerivative(M, direction));
  const auto derivative = [&](int i, int j, int k) { return Traced(dM[k][i * n + j]); };
  const Traced half = Traced(1) / Traced(2);
  std::vector<symbolic::Node> out;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      Traced sum = 0;
      for (int k = 0; k < n; ++k)
        sum +=
            (half * derivative(i, j, k) + half * derivative(i, k, j) - half * derivative(j, k, i)) *
            Traced(graph.input(Input::kVelocity, k));
      out.push_back(sum.node());
    }
  return factored(graph, out);
}

/// Whether that is tried: it grows with the third power of n.
bool hasChristoffel(const scene::Mechanism& mechanism) {
  constexpr int kMostChristoffel = 8;
  return mechanism.positions() == mechanism.dof() && mechanism.dof() <= kMostChristoffel &&
         !mechanism.hasGyroscopicRotors();
}

std::optional<Formula> formulaOf(CodeQuantity quantity) {
  switch (quantity) {
    case CodeQuantity::kTau:
      return Formula::kInverseDynamics;
    case CodeQuantity::kQdd:
      return Formula::kForwardDynamics;
    case CodeQuantity::kM:
      return Formula::kMassMatrix;
    case CodeQuantity::kc:
      return Formula::kCoriolis;
    case CodeQuantity::kg:
      return Formula::kGravity;
    default:
      return std::nullopt;
  }
}

scene::Mechanism withoutFriction(scene::Mechanism mechanism) {
  for (scene::Link& link : mechanism.links) link.joint.friction = {};
  return mechanism;
}

template <typename T>
void execute(const Program::Instruction& i, std::vector<T>& slots) {
  const T &a = slots[i.a], &b = slots[i.b];
  switch (i.code) {
    case Program::Code::kAdd:
      slots[i.result] = a + b;
      break;
    case Program::Code::kSubtract:
      slots[i.result] = a - b;
      break;
    case Program::Code::kMultiply:
      slots[i.result] = a * b;
      break;
    case Program::Code::kNegate:
      slots[i.result] = -a;
      break;
    case Program::Code::kInverse:
      slots[i.result] = T(1) / a;
      break;
  }
}

/// Runs a program as the text does: what depends neither on the state nor on parameters of a struct
/// is a literal, and so is such a parameter itself.
/// @param load  of a component of the state
template <typename T, typename OfLiteral, typename OfLoad>
std::vector<T> run(const Program& program, const OfLiteral& literal, const OfLoad& load) {
  std::vector<T> slots(program.slots, T(0));
  const std::vector<char> is_parametric = constantsOf(program).is_parametric;
  const int numbers = static_cast<int>(program.constants.size() + program.atoms.size());
  for (int i = 0; i < numbers; ++i) slots[i] = literal(i);
  for (const Program::Instruction& i : program.prologue)
    if (is_parametric[i.result] != 0)
      execute(i, slots);
    else
      slots[i.result] = literal(i.result);
  for (const Program::Load& l : program.loads) slots[l.slot] = load(l);
  for (const Program::Instruction& i : program.body) execute(i, slots);
  std::vector<T> out;
  for (const int slot : program.outputs) out.push_back(slots[slot]);
  return out;
}

/// A number that was rounded to this literal, and by how much at most.
RunningError known(double literal) {
  return {literal, RunningError::kUnitRoundoff * std::abs(literal)};
}

template <typename T>
T literalAs(const Digits50& exact, double nearest);
template <>
RunningError literalAs<RunningError>(const Digits50&, double nearest) {
  return known(nearest);
}
template <>
SingleError literalAs<SingleError>(const Digits50& exact, double nearest) {
  return {static_cast<float>(exact.value()), known(nearest)};
}

/// @param exact  the cosine or sine; that of single precision is within 1 ulp of it
SingleError singleTrig(const RunningError& exact, float value) {
  constexpr double kUlp = std::numeric_limits<float>::epsilon();
  return {value, RunningError(exact.value(), exact.bound() + kUlp * std::abs(exact.value()))};
}

template <typename T>
scene::JointPosition<T> positionOf(double q);
template <>
scene::JointPosition<RunningError> positionOf<RunningError>(double q) {
  return runningErrorPosition(q);
}
template <>
scene::JointPosition<SingleError> positionOf<SingleError>(double q) {
  const scene::JointPosition<RunningError> exact = runningErrorPosition(q);
  const float rounded = static_cast<float>(q);
  return {SingleError(q), singleTrig(exact.c, std::cos(rounded)),
          singleTrig(exact.s, std::sin(rounded))};
}

scene::State<RunningError> exactInput(const scene::State<double>& state) {
  scene::State<RunningError> out;
  for (const scene::JointPosition<double>& x : state.x) out.x.push_back(runningErrorPosition(x.q));
  out.qd.assign(state.qd.begin(), state.qd.end());
  out.qdd.assign(state.qdd.begin(), state.qdd.end());
  out.tau.assign(state.tau.begin(), state.tau.end());
  return out;
}

std::string identifierOf(const std::string& text) {
  std::string out;
  for (const char ch : text)
    out += std::isalnum(static_cast<unsigned char>(ch)) != 0 && ch > 0 ? ch : '_';
  if (out.empty() || std::isdigit(static_cast<unsigned char>(out[0])) != 0) out = "scene_" + out;
  return out;
}

std::string tooLong(CodeQuantity quantity, int operations) {
  return fmt::format("{}: {} operations in a straight line, at most {} are written", name(quantity),
                     operations, kMostWritten);
}

}  // namespace

const char* name(CodeQuantity quantity) {
  switch (quantity) {
    case CodeQuantity::kTau:
      return "tau";
    case CodeQuantity::kQdd:
      return "qdd";
    case CodeQuantity::kM:
      return "M";
    case CodeQuantity::kC:
      return "C";
    case CodeQuantity::kc:
      return "c";
    case CodeQuantity::kg:
      return "g";
    case CodeQuantity::kY:
      return "Y";
    case CodeQuantity::kPosition:
      return "position";
    case CodeQuantity::kOrientation:
      return "orientation";
    case CodeQuantity::kJacobian:
      return "jacobian";
    case CodeQuantity::kJacobianRate:
      return "jacobian_rate";
  }
  return "?";
}

bool isOfPoint(CodeQuantity quantity) {
  return quantity >= CodeQuantity::kPosition;
}

Constants constantsOf(const Program& program) {
  Constants out;
  out.is_parametric.assign(program.slots, 0);
  for (std::size_t i = 0; i < program.atoms.size(); ++i) {
    const symbolic::Atom& atom = program.atoms[i];
    out.is_parametric[program.constants.size() + i] =
        atom.kind == symbolic::Atom::Kind::kNumber && !atom.number.parameters().empty() ? 1 : 0;
  }
  const auto isBinary = [](const Program::Instruction& i) {
    return i.code != Program::Code::kNegate && i.code != Program::Code::kInverse;
  };
  for (const Program::Instruction& i : program.prologue)
    out.is_parametric[i.result] =
        out.is_parametric[i.a] != 0 || (isBinary(i) && out.is_parametric[i.b] != 0) ? 1 : 0;
  const auto read = [&](int slot) {
    if (out.is_parametric[slot] == 0) return;
    const int next = static_cast<int>(out.slots.size());
    if (out.index.emplace(slot, next).second) out.slots.push_back(slot);
  };
  for (const Program::Instruction& i : program.body) {
    read(i.a);
    if (isBinary(i)) read(i.b);
  }
  for (const int slot : program.outputs) read(slot);
  return out;
}

ControllerCode::ControllerCode(const scene::Scene& scene,
                               const std::vector<CodeQuantity>& quantities,
                               const std::optional<CodePoint>& point, CodeParameters parameters)
    : scene_(scene), identifier_(identifierOf(scene.name)), point_(point), how_(parameters) {
  if (how_ == CodeParameters::kStruct) {
    const ParametrizedMechanism in_fields = parametrized(scene.mechanism);
    scene_.mechanism = in_fields.mechanism;
    fields_ = in_fields.fields;
    folded_ = in_fields.folded;
    if (point_)
      for (scene::Number& number : point_->at) number = in_fields.inFields(number);
  }
  parameters_ = scene::inertialParameters(scene_.mechanism);
  readFriction();
  const scene::Mechanism mechanism = withoutFriction(scene_.mechanism);
  for (const CodeQuantity quantity : quantities) {
    functions_.push_back(made(quantity, mechanism));
    if (const int operations = functions_.back().program.bodyOperations().all();
        operations > kMostWritten)
      throw NotUsed(tooLong(quantity, operations));
  }
}

void ControllerCode::readFriction() {
  const scene::Mechanism& mechanism = scene_.mechanism;
  const recursive::Model<double> numbers =
      recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism));
  friction_.resize(numbers.dof());
  for (const recursive::LinkModel<double>& link : numbers.links)
    if (link.dof >= 0)
      friction_[link.dof] = {link.viscous, link.positive, link.negative, link.viscous != 0,
                             link.positive != 0 || link.negative != 0};
  if (isFolded()) return;
  symbolic::Graph graph;
  const Traced::Recording recording(graph);
  const recursive::Model<Traced> model =
      recursive::buildModel(mechanism, TracedNumbers(mechanism, false));
  std::vector<symbolic::Node> nodes(3 * friction_.size());
  for (const recursive::LinkModel<Traced>& link : model.links) {
    if (link.dof < 0) continue;
    JointFriction& friction = friction_[link.dof];
    friction.is_viscous = link.viscous != Traced(0);
    friction.is_coulomb = link.positive != Traced(0) || link.negative != Traced(0);
    const Traced all[] = {link.viscous, link.positive, link.negative};
    for (int k = 0; k < 3; ++k) nodes[3 * link.dof + k] = all[k].node();
  }
  friction_program_ = symbolic::compile(graph, nodes);
}

/// A function whose program is a sweep of recursive/, written down.
void ControllerCode::sweepInto(CodeFunction& function, const scene::Mechanism& mechanism) const {
  const CodeQuantity quantity = function.quantity;
  const int n = mechanism.dof();
  if (n > kMostDof)
    throw NotUsed(fmt::format("{}: {} degrees of freedom, at most {} are written out",
                              name(quantity), n, kMostDof));
  symbolic::Graph graph;
  const Traced::Recording recording(graph);
  const TracedNumbers traced(mechanism, isFolded());
  std::vector<symbolic::Node> nodes;
  for (const Traced& value : swept(quantity, recursive::buildModel(mechanism, traced),
                                   tracedState(mechanism), traced, parameters_, point_))
    nodes.push_back(value.node());
  function.program = factored(graph, nodes);
  if (quantity == CodeQuantity::kC && hasChristoffel(mechanism)) {
    Program symbols = christoffel(mechanism, isFolded());
    if (symbols.bodyOperations().all() < function.program.bodyOperations().all()) {
      function.program = std::move(symbols);
      function.road = "Christoffel symbols of M";
    }
  }
}

CodeFunction ControllerCode::made(CodeQuantity quantity, const scene::Mechanism& mechanism) const {
  const int n = mechanism.dof();
  CodeFunction function{quantity, {}, n, 1, "the sweep, traced"};
  if (const std::optional<Formula> formula = formulaOf(quantity)) {
    try {
      Road road = smallestWritten(mechanism, *formula, isFolded());
      function.road = name(road.kind);
      function.program = std::move(road.program);
    } catch (const NotUsed& why) {
      throw NotUsed(fmt::format("{}: {}", name(quantity), why.what()));
    }
  } else {
    sweepInto(function, mechanism);
  }
  switch (quantity) {
    case CodeQuantity::kM:
    case CodeQuantity::kC:
      function.columns = n;
      break;
    case CodeQuantity::kY:
      function.columns = static_cast<int>(parameters_.size());
      break;
    case CodeQuantity::kPosition:
      function.rows = 3;
      break;
    case CodeQuantity::kOrientation:
      function.rows = function.columns = 3;
      break;
    case CodeQuantity::kJacobian:
    case CodeQuantity::kJacobianRate:
      function.rows = 6;
      function.columns = n;
      break;
    default:
      break;
  }
  return function;
}

bool ControllerCode::hasFriction(const CodeFunction& function) const {
  return (function.quantity == CodeQuantity::kTau || function.quantity == CodeQuantity::kQdd) &&
         std::any_of(friction_.begin(), friction_.end(),
                     [](const JointFriction& f) { return !f.isNone(); });
}

bool ControllerCode::needsFriction() const {
  return std::any_of(functions_.begin(), functions_.end(),
                     [&](const CodeFunction& function) { return hasFriction(function); });
}

namespace {

/// The answers of a function as it is written, with what its roundings may have done.
/// @param friction  by rate: viscous, positive, negative
template <typename T>
std::vector<T> asWritten(const CodeFunction& function, const LiteralValues& literals,
                         const scene::State<double>& state,
                         const std::vector<std::array<T, 3>>& friction) {
  const auto literal = [&](int slot) {
    return literalAs<T>(literals.exact(slot), literals.nearest(slot));
  };
  const auto of_friction = [&](int i) {
    const auto& [viscous, positive, negative] = friction[i];
    const T rate(state.qd[i]);
    return viscous * rate + (state.qd[i] > 0 ? positive : state.qd[i] < 0 ? -negative : T(0));
  };
  std::vector<T> out = run<T>(function.program, literal, [&](const Program::Load& load) -> T {
    switch (load.input) {
      case Input::kPosition:
        return positionOf<T>(state.x[load.joint].q).q;
      case Input::kCos:
        return positionOf<T>(state.x[load.joint].q).c;
      case Input::kSin:
        return positionOf<T>(state.x[load.joint].q).s;
      case Input::kVelocity:
        return T(state.qd[load.joint]);
      case Input::kAcceleration:
        return T(state.qdd[load.joint]);
      case Input::kForce:
        return T(state.tau[load.joint]) - of_friction(load.joint);
      default:
        throw std::logic_error("ControllerCode: no program reads this input");
    }
  });
  if (function.quantity == CodeQuantity::kTau)
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += of_friction(static_cast<int>(i));
  return out;
}

}  // namespace

template <typename T>
std::vector<std::array<T, 3>> ControllerCode::frictionAs() const {
  std::vector<std::array<T, 3>> out;
  if (isFolded()) {
    const auto number = [](double x) { return literalAs<T>(Digits50(x), x); };
    for (const JointFriction& f : friction_)
      out.push_back({number(f.viscous), number(f.positive), number(f.negative)});
    return out;
  }
  const LiteralValues literals(friction_program_, scene_.mechanism);
  const auto none = [](const Program::Load&) -> T {
    throw std::logic_error("ControllerCode: friction reads no state");
  };
  const std::vector<T> all = run<T>(
      friction_program_,
      [&](int slot) { return literalAs<T>(literals.exact(slot), literals.nearest(slot)); }, none);
  for (std::size_t i = 0; i < friction_.size(); ++i)
    out.push_back({all[3 * i], all[3 * i + 1], all[3 * i + 2]});
  return out;
}

std::vector<GoldenCase> ControllerCode::golden(const std::vector<scene::State<double>>& states,
                                               CodeScalar scalar) const {
  const scene::Mechanism& mechanism = scene_.mechanism;
  const RunningErrorNumbers numbers(mechanism);
  const recursive::Model<RunningError> model = recursive::buildModel(mechanism, numbers);
  const auto double_friction = frictionAs<RunningError>();
  const auto single_friction = frictionAs<SingleError>();
  std::vector<GoldenCase> all;
  for (const scene::State<double>& state : states) {
    GoldenCase one{state, {}, {}};
    for (const CodeFunction& function : functions_) {
      const LiteralValues literals(function.program, mechanism);
      const std::vector<RunningError> expected =
          swept(function.quantity, model, exactInput(state), numbers, parameters_, point_);
      std::vector<double> value, limit, own;
      if (scalar == CodeScalar::kDouble)
        for (const RunningError& x :
             asWritten<RunningError>(function, literals, state, double_friction))
          own.push_back(x.bound());
      else
        for (const SingleError& x :
             asWritten<SingleError>(function, literals, state, single_friction))
          own.push_back(x.bound());
      for (std::size_t i = 0; i < own.size(); ++i) {
        value.push_back(expected[i].value());
        limit.push_back((own[i] + expected[i].bound()) * RunningError::kInflate);
      }
      one.value.push_back(value);
      one.limit.push_back(limit);
    }
    all.push_back(one);
  }
  return all;
}

}  // namespace dynwitness::crosscheck::kernel
