// SPDX-License-Identifier: GPL-3.0-or-later
// What a chart measures: one way to compute a quantity in one scalar, ready to be timed.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/scalars/scalar.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/mechanism.hpp"

namespace dynwitness::crosscheck {

using States = std::vector<scene::State<double>>;

class Method {
 public:
  Method(std::string name, Scalar scalar) : name(std::move(name)), scalar(scalar) {}
  virtual ~Method() = default;
  virtual void run(int state) = 0;           ///< what is timed
  virtual MatrixX<Ball> answer() const = 0;  ///< of the last run, exactly as it is

  const std::string name;
  const Scalar scalar;
};

/// How charts and their tables call the methods that are ours; an engine has its witness's name.
struct MethodName {
  static constexpr const char* kClosedForm = "closed form as printed";
  static constexpr const char* kProgram = "straight-line program";
  static constexpr const char* kNewtonEuler = "Newton-Euler sweep";
  static constexpr const char* kCompositeBody = "composite-body sweep";
  static constexpr const char* kCompositeBodySolved = "mass matrix and L D L'";
  static constexpr const char* kArticulatedBody = "articulated-body sweep";
  static constexpr const char* kKernel = "the scene's kernel";
};

/// The closed form, entry by entry, as `dynwitness derive` prints it; qdd by L D L'.
std::unique_ptr<Method> closedFormMethod(Quantity quantity, const scene::Mechanism& mechanism,
                                         const States& states);

/// The derived equations as a straight-line program: nothing is computed twice. qdd by L D L'.
std::unique_ptr<Method> programMethod(Quantity quantity, const scene::Mechanism& mechanism,
                                      const States& states);

/// The scene's own compiled code. @throws std::runtime_error  why there is none, or why it is not
/// used
std::unique_ptr<Method> kernelMethod(Quantity quantity, const scene::Mechanism& mechanism,
                                     const States& states);

/// An outside engine behind the interface of witnesses.
std::unique_ptr<Method> engineMethod(std::unique_ptr<Witness> witness, Quantity quantity,
                                     const States& states);

enum class Sweep { kNewtonEuler, kCompositeBody, kCompositeBodySolved, kArticulatedBody };

// The sweeps in one scalar; each has a source file of its own, because each takes long to compile.
std::unique_ptr<Method> sweepInFloat(Sweep, const scene::Mechanism&, const States&);
std::unique_ptr<Method> sweepInDouble(Sweep, const scene::Mechanism&, const States&);
std::unique_ptr<Method> sweepInLongDouble(Sweep, const scene::Mechanism&, const States&);
std::unique_ptr<Method> sweepInBalls(Sweep, const scene::Mechanism&, const States&);
std::unique_ptr<Method> sweepIn50Digits(Sweep, const scene::Mechanism&, const States&);

}  // namespace dynwitness::crosscheck
