// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/kernel/controller_code.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "crosscheck/kernel/controller_text.hpp"
#include "crosscheck/kernel/factor.hpp"
#include "crosscheck/kernel/lean_sweeps.hpp"
#include "crosscheck/kernel/swept_quantity.hpp"
#include "crosscheck/kernel/traced_sweeps.hpp"
#include "crosscheck/scalars/traced.hpp"
#include "recursive/build_model.hpp"
#include "symbolic/equations.hpp"

namespace dynwitness::crosscheck::kernel {
namespace {

using symbolic::Input;
using symbolic::Program;

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

/// Derivatives by qd, which viscous friction is part of and Coulomb's, between its jumps, is not.
bool isByRates(CodeQuantity quantity) {
  return quantity == CodeQuantity::kDtauDqd || quantity == CodeQuantity::kDqddDqd;
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
    case CodeQuantity::kDtauDq:
      return "dtau_dq";
    case CodeQuantity::kDtauDqd:
      return "dtau_dqd";
    case CodeQuantity::kDqddDq:
      return "dqdd_dq";
    case CodeQuantity::kDqddDqd:
      return "dqdd_dqd";
    case CodeQuantity::kDqddDtau:
      return "dqdd_dtau";
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

bool isDerivative(CodeQuantity quantity) {
  return quantity >= CodeQuantity::kDtauDq && quantity <= CodeQuantity::kDqddDtau;
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
  for (const CodeQuantity quantity : quantities) {
    functions_.push_back(made(quantity));
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

scene::Mechanism ControllerCode::known(CodeQuantity quantity) const {
  scene::Mechanism mechanism = scene_.mechanism;
  for (scene::Link& link : mechanism.links) {
    const scene::Number viscous = link.joint.friction.viscous;
    link.joint.friction = {};
    if (isByRates(quantity)) link.joint.friction.viscous = viscous;
  }
  return mechanism;
}

/// The sweep for derivatives written down on base parameters, where that is less and the mechanism
/// has them. Those forget the viscous part of friction.
void ControllerCode::derivativesInto(CodeFunction& function,
                                     const scene::Mechanism& mechanism) const {
  if (isByRates(function.quantity) && mechanism.hasFriction()) return;
  symbolic::Graph graph;
  const Traced::Recording recording(graph);
  const TracedNumbers traced(mechanism, isFolded());
  const recursive::Model<Traced> model = recursive::buildModel(mechanism, traced);
  if (!isLean(model)) return;
  LeanModel base = leanModel(model);
  regroup(base);
  std::vector<symbolic::Node> nodes;
  for (const Traced& value : swept(function.quantity, recursiveModel(base), tracedState(mechanism),
                                   traced, parameters_, point_))
    nodes.push_back(value.node());
  Program program = factored(graph, nodes);
  if (program.bodyOperations().all() >= function.program.bodyOperations().all()) return;
  function.program = std::move(program);
  function.road = "the sweep, traced on base parameters";
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
  if (isDerivative(quantity)) derivativesInto(function, mechanism);
  if (quantity == CodeQuantity::kC && hasChristoffel(mechanism)) {
    Program symbols = christoffel(mechanism, isFolded());
    if (symbols.bodyOperations().all() < function.program.bodyOperations().all()) {
      function.program = std::move(symbols);
      function.road = "Christoffel symbols of M";
    }
  }
}

CodeFunction ControllerCode::made(CodeQuantity quantity) const {
  const scene::Mechanism mechanism = known(quantity);
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
    case CodeQuantity::kDtauDq:
    case CodeQuantity::kDtauDqd:
    case CodeQuantity::kDqddDq:
    case CodeQuantity::kDqddDqd:
    case CodeQuantity::kDqddDtau:
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
  // of what is left of tau, friction apart, in dqdd_dq, too
  return (function.quantity == CodeQuantity::kTau || function.quantity == CodeQuantity::kQdd ||
          function.quantity == CodeQuantity::kDqddDq) &&
         std::any_of(friction_.begin(), friction_.end(),
                     [](const JointFriction& f) { return !f.isNone(); });
}

bool ControllerCode::needsFriction() const {
  return std::any_of(functions_.begin(), functions_.end(),
                     [&](const CodeFunction& function) { return hasFriction(function); });
}

}  // namespace dynwitness::crosscheck::kernel
