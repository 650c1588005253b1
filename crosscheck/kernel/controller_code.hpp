// SPDX-License-Identifier: GPL-3.0-or-later
// Code that a controller can use: quantities as plain functions, from the smallest programs.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/kernel/code_parameters.hpp"
#include "crosscheck/kernel/roads.hpp"
#include "crosscheck/scalars/running_error.hpp"
#include "scene/inertial_parameters.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck::kernel {

enum class CodeLanguage { kC, kPython, kMatlab, kJulia };
enum class CodeScalar { kDouble, kFloat };
/// Numbers of the scene: literals, or the fields of a struct (code_parameters.hpp).
enum class CodeParameters { kFolded, kStruct };

/** What a function computes, n degrees of freedom; matrices row by row:
      tau          n      = M qdd + c + g + friction - Q, with Q the scene's constant wrenches
      qdd          n      of that equation
      M, c, g      n x n, n, n
      C            n x n  c = C qd, dM/dt - 2 C skew
      Y            n x p  M qdd + c + g = Y pi + springs, pi the scene's inertial parameters
      dtau_dq      n x n  of q, qd, qdd, and dtau_dqd of q, qd: derivatives of tau; by q along the
                          body's axes where rates are no derivatives of coordinates
      dqdd_dq      n x n  of q, qd, tau, dqdd_dqd of q, qd, and dqdd_dtau of q: of qdd
      position     3      of a point, world axes [m]
      orientation  3 x 3  its columns are the link's axes in world axes
      jacobian     6 x n  J qd = (v, w) of the point, world axes
      jacobian_rate 6 x n dJ/dt along qd */
enum class CodeQuantity {
  kTau,
  kQdd,
  kM,
  kC,
  kc,
  kg,
  kY,
  kDtauDq,
  kDtauDqd,
  kDqddDq,
  kDqddDqd,
  kDqddDtau,
  kPosition,
  kOrientation,
  kJacobian,
  kJacobianRate
};
inline constexpr CodeQuantity kCodeQuantities[] = {
    CodeQuantity::kTau,         CodeQuantity::kQdd,         CodeQuantity::kM,
    CodeQuantity::kC,           CodeQuantity::kc,           CodeQuantity::kg,
    CodeQuantity::kY,           CodeQuantity::kDtauDq,      CodeQuantity::kDtauDqd,
    CodeQuantity::kDqddDq,      CodeQuantity::kDqddDqd,     CodeQuantity::kDqddDtau,
    CodeQuantity::kPosition,    CodeQuantity::kOrientation, CodeQuantity::kJacobian,
    CodeQuantity::kJacobianRate};
/// "tau", ..., as `evaluate` calls them
const char* name(CodeQuantity quantity);
bool isOfPoint(CodeQuantity quantity);
/// dtau_dq to dqdd_dtau
bool isDerivative(CodeQuantity quantity);

/// A point of a link of the scene, exactly.
struct CodePoint {
  int link = 0;
  scene::Vector at;  ///< in the link's axes [m]
};

/// One function: its program, without friction, which is a line of its own.
struct CodeFunction {
  CodeQuantity quantity;
  symbolic::Program program;
  int rows, columns;
  std::string road;  ///< "lean sweep": where the program comes from
};

/// Operations a call, as the text has them.
struct CodeCount {
  int multiplications = 0, additions = 0, divisions = 0, trigonometric = 0, comparisons = 0;
};

/// What functions must answer at a state, in the order of the functions.
struct GoldenCase {
  scene::State<double> state;
  std::vector<std::vector<double>> value, limit;
};

/// Operations beyond which no function of C, Y, derivatives or kinematics is written.
inline constexpr int kMostWritten = 20000;

/** The programs of a scene's quantities, to be written in a language.

    tau, qdd, M, c, g: the smallest road (roads.hpp), friction of joints apart, whose sign no
    program has. C, Y, derivatives and kinematics: the sweeps of recursive/, written down and
    regrouped (factored()), derivatives on base parameters where that is less.
    What does not depend on the state is no part of a call: all numbers of the scene are folded, or
    they are fields of a struct, and what depends on these alone is computed once, by NAME_init. */
class ControllerCode {
 public:
  /// @throws NotUsed  a function would be too long; and what roads() throws for scenes that have no
  ///         program
  ControllerCode(const scene::Scene& scene, const std::vector<CodeQuantity>& quantities,
                 const std::optional<CodePoint>& point,
                 CodeParameters parameters = CodeParameters::kFolded);

  const std::vector<CodeFunction>& functions() const { return functions_; }
  CodeCount count(const CodeFunction& function) const;

  /** Answers of recursive/'s own sweeps (newton_euler, composite_body, articulated_body) on
      RunningError at states, and how far an answer of this code may lie from them: its own bound,
      that of exactly these operations on these literals in that scalar, plus theirs. The code's
      cosines and sines are taken to be within 1 ulp. */
  std::vector<GoldenCase> golden(const std::vector<scene::State<double>>& states,
                                 CodeScalar scalar) const;

  /** Files, name and text: for C  NAME.h, NAME.c, NAME_test.c;  Python  NAME.py, NAME_test.py;
      Julia likewise;  MATLAB  one file a function, with a struct NAME_parameters.m and NAME_init.m,
      and NAME_test.m. The same scene gives the same bytes.
      @param golden  what the test file asks; its exit status says whether all is right
      @throws scene::InputError  a number of the scene is none of the scalar; float is for C */
  std::vector<std::pair<std::string, std::string>> files(
      CodeLanguage language, CodeScalar scalar, const std::vector<GoldenCase>& golden) const;

  const std::string& identifier() const { return identifier_; }  ///< NAME

 private:
  friend class CodeLines;
  friend class CodeWriter;
  /// By rate: its joint's friction, where it has one.
  struct JointFriction {
    double viscous = 0, positive = 0, negative = 0;
    bool is_viscous = false, is_coulomb = false;
    bool isNone() const { return !is_viscous && !is_coulomb; }
  };
  bool isFolded() const { return how_ == CodeParameters::kFolded; }
  bool hasFriction(const CodeFunction& function) const;
  bool needsFriction() const;  ///< any function
  void readFriction();
  /// Viscous, positive, negative by rate, in the arithmetic of the code.
  template <typename T>
  std::vector<std::array<T, 3>> frictionAs() const;
  CodeFunction made(CodeQuantity quantity) const;
  /// What of the scene a function's program knows: friction, but for the viscous part that
  /// derivatives by qd have, is apart.
  scene::Mechanism known(CodeQuantity quantity) const;
  void sweepInto(CodeFunction& function, const scene::Mechanism& mechanism) const;
  void derivativesInto(CodeFunction& function, const scene::Mechanism& mechanism) const;

  scene::Scene scene_;
  std::string identifier_;
  std::optional<CodePoint> point_;
  std::vector<scene::InertialParameter> parameters_;  ///< the columns of Y
  std::vector<CodeFunction> functions_;
  std::vector<JointFriction> friction_;
  CodeParameters how_;
  std::vector<CodeParameter> fields_;   ///< of the struct
  std::vector<std::string> folded_;     ///< parameters that are values nevertheless
  symbolic::Program friction_program_;  ///< of a struct: viscous, positive, negative by rate
};

}  // namespace dynwitness::crosscheck::kernel
