// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/formulas_report.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "symbolic/formula.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;

const char* name(FormulaRelation relation) {
  switch (relation) {
    case FormulaRelation::kEqual:
      return "equal";
    case FormulaRelation::kForThisScene:
      return "equal for this scene";
    case FormulaRelation::kUpToConstant:
      return "up to a constant";
    case FormulaRelation::kNegative:
      return "up to the sign";
    case FormulaRelation::kMultiple:
      return "up to a factor";
    case FormulaRelation::kAnotherQuantity:
      return "another quantity";
    case FormulaRelation::kDifferent:
      return "different";
  }
  return "";
}

std::string sentenceOf(const JudgedFormula& f) {
  switch (f.relation) {
    case FormulaRelation::kEqual:
      return "right";
    case FormulaRelation::kForThisScene:
      return "right      with the scene's numbers, not for other values of its parameters";
    case FormulaRelation::kUpToConstant:
      return "right      up to a constant, which moves nothing";
    case FormulaRelation::kNegative:
      return fmt::format("wrong      up to the sign: it is -{}", f.name);
    case FormulaRelation::kMultiple:
      return fmt::format("wrong      up to a factor: it is {} times {}", f.factor, f.name);
    case FormulaRelation::kAnotherQuantity:
      return fmt::format("wrong      it is {}", f.another);
    case FormulaRelation::kDifferent:
      break;
  }
  if (!f.no_gaps.empty())
    return fmt::format("wrong      at which terms is not told: {}", f.no_gaps);
  return fmt::format("wrong      at {} term{}", f.gaps.size(), f.gaps.size() == 1 ? "" : "s");
}

const char* kindOf(const FormulaGap& gap) {
  return gap.stated == 0 ? "missing" : gap.derived == 0 ? "extra" : "coefficient";
}

/// "1/3", "-0.0009"
std::string number(const scene::Rational& r) {
  const std::string size = print(symbolic::Formula::ofNumber(abs(r)), symbolic::Style::kText);
  return r < 0 ? "-" + size : size;
}

/// "-1/2*l1*qd2": the term with its coefficient.
std::string withCoefficient(const scene::Rational& r, const std::string& term) {
  if (term == "1") return number(r);
  if (r == 1) return term;
  return r == -1 ? "-" + term : number(r) + "*" + term;
}

std::string gapLine(const FormulaGap& gap) {
  const std::string head = fmt::format("{:10}{:<13}", "", kindOf(gap));
  if (gap.stated == 0) return head + withCoefficient(gap.derived, gap.term) + "\n";
  if (gap.derived == 0) return head + withCoefficient(gap.stated, gap.term) + "\n";
  return head +
         fmt::format("of {}: {}, not {}\n", gap.term, number(gap.derived), number(gap.stated));
}

constexpr std::size_t kMostTold = 12;  ///< terms of one formula on a terminal

}  // namespace

std::string formulasText(const JudgedFormulas& judged) {
  std::string text = fmt::format(
      "{}: {} formula{}, decided exactly at {} random point{} modulo a prime of 63 bits (a wrong "
      "one passes with a chance below {:.0e})\n",
      judged.scene, judged.formulas.size(), judged.formulas.size() == 1 ? "" : "s", judged.points,
      judged.points == 1 ? "" : "s", judged.chance);
  std::size_t width = 0;
  for (const JudgedFormula& f : judged.formulas) width = std::max(width, f.name.size());
  for (const JudgedFormula& f : judged.formulas) {
    text += fmt::format("  {:<{}}  {}\n", f.name, width, sentenceOf(f));
    if (f.relation != FormulaRelation::kDifferent) continue;
    for (std::size_t k = 0; k < f.gaps.size() && k < kMostTold; ++k) text += gapLine(f.gaps[k]);
    if (f.gaps.size() > kMostTold)
      text += fmt::format("{:10}and {} more: --format json\n", "", f.gaps.size() - kMostTold);
  }
  return text + (judged.isRight() ? "\nright\n" : "\nWRONG\n");
}

std::string formulasJson(const JudgedFormulas& judged, const std::string& version) {
  Json formulas = Json::array();
  for (const JudgedFormula& f : judged.formulas) {
    Json one = {{"formula", f.text},
                {"name", f.name},
                {"verdict", f.isRight() ? "right" : "wrong"},
                {"relation", name(f.relation)}};
    if (!f.factor.empty()) one["factor"] = f.factor;
    if (!f.another.empty()) one["another"] = f.another;
    if (!f.isRight() && f.no_gaps.empty()) {
      one["terms"] = Json::array();
      for (const FormulaGap& gap : f.gaps)
        one["terms"].push_back({{"kind", kindOf(gap)},
                                {"term", gap.term},
                                {"derived", gap.derived.str()},
                                {"stated", gap.stated.str()}});
    }
    if (!f.no_gaps.empty()) one["terms_not_told"] = f.no_gaps;
    formulas.push_back(one);
  }
  const Json out = {{"dynwitness", version},
                    {"scene", judged.scene},
                    {"verdict", judged.isRight() ? "right" : "wrong"},
                    {"points", judged.points},
                    {"chance", judged.chance},
                    {"formulas", formulas}};
  return out.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace dynwitness::crosscheck
