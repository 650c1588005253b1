// SPDX-License-Identifier: GPL-3.0-or-later
// Straight-line programs as text: numbered statements, C functions, Python functions.
#pragma once

#include <string>
#include <vector>

#include "scene/mechanism.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/formula.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::symbolic {

/// One line of a program: name = value, with the slots whose names the value mentions.
struct Statement {
  int slot;
  std::string name;
  Formula value;
  std::vector<int> reads;
};

/** A program as lines: definitions keep their names, shared values are called t1, t2, ..., and a
    value that is used once stands where it is used.
    @param style  kC, kPython and kSympy write parameters as identifiers */
std::vector<Statement> statements(const Program& program, Style style);

/// The formula of a slot that no statement computes: a number or a component of the state.
Formula leafFormula(const Program& program, int slot, Style style = Style::kText);

/** A C99 translation unit (it needs <math.h> alone) with

        void NAME(const double* q, const double* qd, const double* parameters,
                  double* M, double* c, double* g);

    M is written row by row. `parameters` holds the scene's parameters in the order of the array
    NAME_parameters, which has the scene's own values. When the equations were derived with folded
    parameters, the argument is not read. The same scene gives the same bytes. */
std::string emitC(const Equations& equations, const scene::Mechanism& mechanism,
                  const std::string& name);

/** The same as a Python module of SymPy's expressions with exact numbers: M, c, g, Q (constant
    wrenches and friction) and tau = M qdd + c + g - Q in symbols q1.., qd1.., qdd1.. and the
    parameters, which VALUES maps to the scene's own. */
std::string emitSympy(const Equations& equations, const scene::Mechanism& mechanism);

/// The same as a Python module that needs the standard library alone:
/// NAME(q, qd, parameters=PARAMETERS) returns (M, c, g) as lists.
std::string emitPython(const Equations& equations, const scene::Mechanism& mechanism,
                       const std::string& name);

}  // namespace dynwitness::symbolic
