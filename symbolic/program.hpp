// SPDX-License-Identifier: GPL-3.0-or-later
// Straight-line programs: some nodes of a graph, ready to be evaluated on any scalar.
#pragma once

#include <array>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "scene/numbers.hpp"
#include "scene/state.hpp"
#include "symbolic/graph.hpp"

namespace dynwitness::symbolic {

/** What a program does, as data. Every value has a slot of its own, so instructions never
    overwrite: slots hold, in this order, the numbers of the scene (constants and atoms), the
    components of the state, the results of the prologue, and the results of the body. */
struct Program {
  enum class Code : std::uint8_t { kAdd, kSubtract, kMultiply, kNegate, kInverse };
  struct Instruction {
    Code code;
    int result, a, b;
  };
  struct Load {
    Input input;
    int joint, slot;
  };
  struct Operations {
    int multiplications = 0, additions = 0;  ///< subtractions are additions; signs cost nothing
    int divisions = 0;
    int all() const { return multiplications + additions + divisions; }
  };

  std::vector<Rational> constants;  ///< slots 0 ... constants.size() - 1
  std::vector<Atom> atoms;          ///< the slots after them
  std::vector<Load> loads;
  std::vector<Instruction> prologue;    ///< work on numbers of the scene: done once
  std::vector<Instruction> body;        ///< work on the state
  std::vector<int> outputs;             ///< slots of the results
  std::vector<std::string> slot_names;  ///< names of definitions, "" for values without one
  int slots = 0;

  Operations bodyOperations() const;
};

/// Only what the outputs need; operations on numbers of the scene go to the prologue.
Program compile(const Graph& graph, const std::vector<Node>& outputs);

/** A program with its numbers and its workspace, on scalars of type T.

    T needs + - * / and unary minus; tested with double, float, long double, rationals and a prime
    field. `Numbers` (scene/numbers.hpp) gives it the scene's numbers. A run allocates nothing that
    T itself does not. */
template <typename T>
class ProgramRun {
 public:
  template <typename Numbers>
  ProgramRun(const Program& program, const Numbers& number) : program_(&program) {
    const T zero = number(scene::Number(0));
    slots_.assign(program.slots, zero);
    std::size_t slot = 0;
    for (const Rational& r : program.constants) slots_[slot++] = rational(number, r, 0);
    for (const Atom& a : program.atoms) slots_[slot++] = atomValue(a, number);
    for (const Program::Load& load : program.loads)
      if (load.input == Input::kRotation) rotations_.emplace(load.joint / 9, std::array<T, 9>());
    for (const Program::Instruction& i : program.prologue) execute(i);
  }

  /** Evaluates the outputs.
      @param state    x, qd, qdd and tau as far as the program reads them
      @param outputs  room for program.outputs.size() values */
  void operator()(const scene::State<T>& state, T* outputs) {
    using scene::directionOf;
    for (auto& [first, R] : rotations_) R = rotation(&state.x[first]);
    for (const Program::Load& load : program_->loads) {
      T& slot = slots_[load.slot];
      switch (load.input) {
        case Input::kPosition:
          slot = state.x[load.joint].q;
          break;
        case Input::kCos:
          slot = state.x[load.joint].c;
          break;
        case Input::kSin:
          slot = state.x[load.joint].s;
          break;
        case Input::kVelocity:
          slot = state.qd[load.joint];
          break;
        case Input::kAcceleration:
          slot = state.qdd[load.joint];
          break;
        case Input::kForce:
          slot = state.tau[load.joint];
          break;
        case Input::kDirection:
          slot = T(directionOf(state.qd[load.joint]));
          break;
        case Input::kRotation:
          slot = rotations_[load.joint / 9][load.joint % 9];
          break;
      }
    }
    for (const Program::Instruction& i : program_->body) execute(i);
    for (std::size_t i = 0; i < program_->outputs.size(); ++i)
      outputs[i] = slots_[program_->outputs[i]];
  }

  /// A slot's value: of the numbers of the scene and of what is computed from them alone before a
  /// run, of everything else after it.
  const T& slot(int i) const { return slots_[i]; }

  std::vector<T> operator()(const scene::State<T>& state) {
    std::vector<T> outputs(program_->outputs.size(), slots_.empty() ? T() : slots_[0]);
    (*this)(state, outputs.data());
    return outputs;
  }

 private:
  /// Where numbers take rationals as they are, no text is made of them first.
  template <typename Numbers>
  static auto rational(const Numbers& number, const Rational& value, int)
      -> decltype(T(number.rational(value))) {
    return number.rational(value);
  }
  template <typename Numbers>
  static T rational(const Numbers& number, const Rational& value, long) {
    return number(scene::Number(value));
  }

  template <typename Numbers>
  static T atomValue(const Atom& atom, const Numbers& number) {
    switch (atom.kind) {
      case Atom::Kind::kNumber:
        return number(atom.number);
      case Atom::Kind::kCos:
        return number.angle(atom.number).c;
      case Atom::Kind::kSin:
        return number.angle(atom.number).s;
      case Atom::Kind::kCosAlpha:
        return number.axisTurn(atom.axis).alpha.c;
      case Atom::Kind::kSinAlpha:
        return number.axisTurn(atom.axis).alpha.s;
      case Atom::Kind::kCosBeta:
        return number.axisTurn(atom.axis).beta.c;
      case Atom::Kind::kSinBeta:
        return number.axisTurn(atom.axis).beta.s;
    }
    throw std::logic_error("ProgramRun: unknown kind of atom");
  }

  /** R of a quaternion (w, x, y, z), row by row:
          R_ii = (w^2 + x_i^2 - x_j^2 - x_k^2) / n,   R_ij = 2 (x_i x_j -+ w x_k) / n,   n = q'q */
  static std::array<T, 9> rotation(const scene::JointPosition<T>* slot) {
    const auto [w, x, y, z] = scene::quaternionAt(slot);
    const T ww = w * w, xx = x * x, yy = y * y, zz = z * z;
    const T inverse_n = T(1) / (ww + xx + yy + zz);
    const auto twice = [&](const T& a) { return (a + a) * inverse_n; };
    return {(ww + xx - yy - zz) * inverse_n,
            twice(x * y - w * z),
            twice(x * z + w * y),
            twice(x * y + w * z),
            (ww - xx + yy - zz) * inverse_n,
            twice(y * z - w * x),
            twice(x * z - w * y),
            twice(y * z + w * x),
            (ww - xx - yy + zz) * inverse_n};
  }

  void execute(const Program::Instruction& i) {
    switch (i.code) {
      case Program::Code::kAdd:
        slots_[i.result] = slots_[i.a] + slots_[i.b];
        break;
      case Program::Code::kSubtract:
        slots_[i.result] = slots_[i.a] - slots_[i.b];
        break;
      case Program::Code::kMultiply:
        slots_[i.result] = slots_[i.a] * slots_[i.b];
        break;
      case Program::Code::kNegate:
        slots_[i.result] = -slots_[i.a];
        break;
      case Program::Code::kInverse:
        slots_[i.result] = slots_[0] / slots_[i.a];
        break;
    }
  }

  const Program* program_;
  std::vector<T> slots_;
  std::map<int, std::array<T, 9>> rotations_;  ///< by the first slot of the quaternion
};

}  // namespace dynwitness::symbolic
