// SPDX-License-Identifier: GPL-3.0-or-later
// What the parameters of a scene are, where a derivation has them first.
#include <set>

#include "symbolic/derivation.hpp"
#include "symbolic/dimensions.hpp"

namespace dynwitness::symbolic {
namespace {

void addSymbols(const Formula& f, std::set<std::string>* names) {
  if (f.kind == Formula::Kind::kSymbol) names->insert(f.symbol);
  for (const Formula& operand : f.operands) addSymbols(operand, names);
}

/// 0.0254 of 127/5000; empty: it does not end.
std::string decimalOf(const Rational& r) {
  scene::Integer n = abs(scene::Integer(numerator(r))), d = denominator(r), rest = d;
  for (const int prime : {2, 5})
    while (rest % prime == 0) rest /= prime;
  if (rest != 1) return {};
  std::string text = (r < 0 ? "-" : "") + scene::Integer(n / d).str();
  n %= d;
  if (n != 0) text += ".";
  for (; n != 0; n %= d) {
    n *= 10;
    text += scene::Integer(n / d).str();
  }
  return text;
}

}  // namespace

void placeParameters(Derivation* derivation) {
  const scene::Mechanism& m = derivation->mechanism;
  const scene::ParameterValues values = m.parameterValues();
  const auto units = parameterUnits(m);
  std::set<std::string> placed;
  for (Step& step : derivation->steps) {
    step.parameters.clear();
    std::set<std::string> used;
    for (const StepEquation& e : step.equations) {
      addSymbols(e.left, &used);
      addSymbols(e.right, &used);
    }
    for (const scene::Parameter& p : m.parameters) {
      if (used.count(p.name) == 0 || !placed.insert(p.name).second) continue;
      const scene::Exact& value = values.at(p.name);
      const auto unit = units.find(p.name);
      const std::string text =
          unit == units.end() || unit->second.text == "1" ? "" : unit->second.text;
      if (value.isRational())
        step.parameters.push_back(
            {p.name, decimalOf(value.rational), Formula::ofNumber(value.rational), text});
      else
        step.parameters.push_back({p.name, "", Formula::ofExpression(p.value), text});
    }
  }
}

}  // namespace dynwitness::symbolic
