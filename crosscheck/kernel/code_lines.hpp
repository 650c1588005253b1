// SPDX-License-Identifier: GPL-3.0-or-later
// The lines of ControllerCode in one language: numbers, operations one after the other.
#pragma once

#include <array>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "crosscheck/kernel/controller_code.hpp"
#include "crosscheck/kernel/controller_text.hpp"

namespace dynwitness::crosscheck::kernel {

class CodeLines {
 public:
  /// @throws scene::InputError  single precision in a language other than C
  CodeLines(const ControllerCode& code, CodeLanguage language, CodeScalar scalar);

  /// The lines of a function, and its results in order.
  struct Body {
    std::string lines;
    std::vector<std::string> results;
    std::set<std::string> reads;  ///< arguments
    bool reads_constants = false, reads_friction = false;
    CodeCount count;
  };
  Body body(const CodeFunction& function) const;

  /// What depends on the parameters alone: lines that fill the constants of all functions.
  struct Init {
    std::string lines;
    bool reads_parameters = false;
    CodeCount count;
  };
  Init init() const;
  /// The arrays of constants, and how many numbers each has: those of functions, and "friction".
  std::vector<std::pair<std::string, int>> constantArrays() const;

  /// A number of the program or of a test.
  std::string number(double x) const;
  /// The same in the scalar. @throws scene::InputError  it is no float
  std::string literal(const Digits50& exact) const;
  std::string element(const std::string& array, int i) const;
  std::string type() const { return scalar_ == CodeScalar::kFloat ? "float" : "double"; }
  /// variable = value
  std::string let(const std::string& variable, const std::string& value) const;
  /// parameters.name, parameters->name
  std::string member(const std::string& of, const std::string& name) const;

 protected:
  const ControllerCode& code_;
  CodeLanguage language_;
  CodeScalar scalar_;

 private:
  struct Writing;
  std::string math(const char* function) const;
  std::string friction(int i, Body& body) const;
  void load(const symbolic::Program::Load& load, Writing& writing) const;
  bool writeTrivial(const symbolic::Program::Instruction& i, Writing& writing) const;
  void write(const symbolic::Program::Instruction& i, Writing& writing) const;
  std::string frictionVariable(int i, Writing& writing) const;
  void initProgram(const symbolic::Program& program, const std::string& array,
                   std::map<std::string, std::string>& known, Init& init) const;
};

/// The word of a quantity in names of functions: C and c are one file in some file systems.
const char* word(CodeQuantity quantity);

}  // namespace dynwitness::crosscheck::kernel
