// SPDX-License-Identifier: GPL-3.0-or-later
// Formulas as somebody writes them by hand, "M12 = m2*l1*l2*cos(q2)/2", read into the graph that
// has the derived ones.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scene/error.hpp"
#include "scene/mechanism.hpp"
#include "symbolic/equations.hpp"

namespace dynwitness::crosscheck {

struct StatedFormula {
  std::string text;             ///< NAME = EXPRESSION
  scene::SourceLocation where;  ///< file and line, or the option
};

/** The derived equations of a mechanism, and what the letters of a formula stand for there.

    Left of the sign stands a quantity as `derive` prints it: T, V, p1, M12, Gamma112, c1, g1, and
    tau1 = sum of M1j qddj + c1 + g1 - Q1 with friction and constant wrenches in Q. An underscore
    after the letters (M_12) is read over, M21 is M12.

    Right of it stand numbers (decimals are exact), the scene's parameters, pi, q1.., qd1.., qdd1..,
    + - * / ^ with whole exponents, and cos and sin of sums of whole multiples of angles q and of
    fixed angles in the parameters: cos(q1 + q2), sin(2*q1 - alpha). */
class StatedLanguage {
 public:
  /// @throws scene::InputError  rates that are no derivatives of positions, or joints that follow
  explicit StatedLanguage(const scene::Mechanism& mechanism);
  StatedLanguage(const StatedLanguage&) = delete;
  StatedLanguage& operator=(const StatedLanguage&) = delete;

  struct Read {
    std::string text, name;
    symbolic::Node derived, stated;
  };
  /// @throws scene::InputError  `where: ...`, what was read, at which column, what is allowed
  Read read(const StatedFormula& formula);

  const symbolic::Equations& equations() const { return equations_; }
  /// T, V, p, M, c, g and tau: what a formula may be in place of what it is called.
  const std::vector<std::pair<std::string, symbolic::Node>>& quantities() const {
    return quantities_;
  }

 private:
  symbolic::Node quantity(const std::string& name, const scene::SourceLocation& where);
  std::string allowedNames() const;

  const scene::Mechanism& mechanism_;
  symbolic::Equations equations_;
  std::vector<std::pair<std::string, symbolic::Node>> quantities_;
  bool has_tau_ = true;
};

}  // namespace dynwitness::crosscheck
