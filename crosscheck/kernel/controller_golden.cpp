// SPDX-License-Identifier: GPL-3.0-or-later
// What controller code has to answer, and how near.
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "crosscheck/kernel/controller_code.hpp"
#include "crosscheck/kernel/controller_text.hpp"
#include "crosscheck/kernel/swept_quantity.hpp"
#include "crosscheck/scalars/digits50.hpp"
#include "crosscheck/scalars/exact_state.hpp"
#include "crosscheck/scalars/single_error.hpp"
#include "recursive/build_model.hpp"

namespace dynwitness::crosscheck::kernel {
namespace {

using symbolic::Input;
using symbolic::Program;

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
          swept(function.quantity, model, runningErrorState(state), numbers, parameters_, point_);
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
