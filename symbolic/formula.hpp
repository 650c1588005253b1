// SPDX-License-Identifier: GPL-3.0-or-later
// Formulas as they are shown: small trees with an order of their own, and their printers.
#pragma once

#include <string>
#include <vector>

#include "symbolic/graph.hpp"

namespace dynwitness::symbolic {

/** A formula to be printed. Operands are printed in the order in which they stand, so the text
    depends on nothing but the formula. */
struct Formula {
  enum class Kind {
    kNumber,
    kSymbol,
    kInput,
    kSum,
    kNegate,
    kProduct,
    kPower,
    kQuotient,
    kCos,
    kSin,
    kMatrix
  };

  Kind kind = Kind::kNumber;
  Rational number = 0;  ///< kNumber
  /// kSymbol: a parameter or a definition, by its plain name. kInput: what a position is called, in
  /// its rates, too; empty: q_k.
  std::string symbol;
  Input input = Input::kPosition;  ///< kInput
  int joint = 0;                   ///< kInput: counted from 0
  int exponent = 1;                ///< kPower, may be negative
  /// Terms, factors, the one operand, dividend and divisor, or entries row by row.
  std::vector<Formula> operands;
  std::size_t columns = 0;  ///< kMatrix

  static Formula ofNumber(const Rational& value);
  static Formula ofSymbol(const std::string& name);
  static Formula ofInput(Input input, int joint);
  static Formula sum(std::vector<Formula> terms);        ///< flattened; of none: 0
  static Formula product(std::vector<Formula> factors);  ///< flattened; of none: 1
  static Formula negate(Formula operand);
  static Formula power(Formula base, int exponent);
  static Formula quotient(Formula dividend, Formula divisor);
  static Formula function(Kind cos_or_sin, Formula angle);
  static Formula matrix(std::vector<Formula> entries, std::size_t columns);  ///< not in code
  /// A number of the scene as its author wrote it.
  static Formula ofExpression(const scene::Number& expression);
  /// A number that stays a symbol: a parameter, pi, or the cosine or sine of a fixed angle.
  static Formula ofAtom(const Atom& atom);
};

/// left = right
struct Equation {
  Formula left, right;
};

enum class Style { kText, kLatex, kMathml, kC, kPython, kSympy };

/** A formula in one of the notations. LaTeX is for math mode. MathML is the content of a `math`
    element, as browsers render it without help. In C and Python, symbols are the identifiers of
    identifier(), and cos(q1), sin(q1), qd1 are the local variables c1, s1, qd1. Python for SymPy
    has rational numbers where Python alone has floating-point ones. */
std::string print(const Formula& formula, Style style);

/// "left = right"; in MathML a whole `math` element, displayed as a block.
std::string print(const Equation& equation, Style style);

/// A plain name as it is shown: theta1 gives \theta_{1} in LaTeX, m1 gives m_{1}.
std::string printName(const std::string& name, Style style);

/// An identifier of C and Python for a parameter of a scene, whatever its name.
std::string identifier(const std::string& parameter);

}  // namespace dynwitness::symbolic
