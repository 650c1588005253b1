// SPDX-License-Identifier: GPL-3.0-or-later
// What controller_code.cpp computes and what it writes share: a program's numbers.
#pragma once

#include <map>
#include <vector>

#include "crosscheck/scalars/digits50.hpp"
#include "scene/mechanism.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck::kernel {

/// What of a program does not depend on the state, in 50 digits, rounded once where written.
class LiteralValues {
 public:
  LiteralValues(const symbolic::Program& program, const scene::Mechanism& mechanism)
      : run_(program, scene::RealNumbers<Digits50>(mechanism)) {}
  const Digits50& exact(int slot) const { return run_.slot(slot); }
  double nearest(int slot) const { return static_cast<double>(exact(slot).value()); }

 private:
  symbolic::ProgramRun<Digits50> run_;
};

/// Numbers of a program that depend on parameters: computed when those are given, not in a call.
struct Constants {
  std::vector<char> is_parametric;  ///< by slot: a parameter, or made of one and of no state
  std::vector<int> slots;           ///< those that the body or the outputs read
  std::map<int, int> index;         ///< of a slot in slots
};
Constants constantsOf(const symbolic::Program& program);

}  // namespace dynwitness::crosscheck::kernel
