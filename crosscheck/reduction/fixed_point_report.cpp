// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/reduction/fixed_point.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;
using Kind = FixedSignal::Kind;

constexpr std::size_t kMostRows = 8;  ///< of results that are printed; JSON has all

const char* word(Kind kind) {
  return kind == Kind::kInput ? "input" : kind == Kind::kConstant ? "constant" : "result";
}

/// Slots of the signals that the code has, inputs first, then the widest.
std::vector<int> slotsOf(const FixedPoint& fixed, Kind kind) {
  std::vector<int> out;
  for (std::size_t s = 0; s < fixed.signals.size(); ++s)
    if (fixed.signals[s].is_used && fixed.signals[s].kind == kind)
      out.push_back(static_cast<int>(s));
  return out;
}

std::string row(const FixedSignal& s) {
  return fmt::format("  {:<10} {:>10.4g} {:>10.4g} {:>6} = 1 {:+d} {:+d}\n", s.name, s.low, s.high,
                     s.word(), s.integer, s.fraction);
}

Json jsonOf(const FixedSignal& s) {
  return {{"name", s.name},
          {"kind", word(s.kind)},
          {"low", s.low},
          {"high", s.high},
          {"word_bits", s.word()},
          {"integer_bits", s.integer},
          {"fraction_bits", s.fraction},
          {"error_at_most", s.error}};
}

}  // namespace

std::string fixedPointText(const scene::Scene& scene, const FixedPoint& fixed) {
  std::string text = fmt::format(
      "{}: tau in whole numbers, each within {:.3g} [N m, N] everywhere in [envelope]\n\n"
      "{:<8} {:>12} {:>12}\n",
      scene.name, fixed.error, "", "certified", "measured");
  for (std::size_t i = 0; i < fixed.forces.size(); ++i)
    text += fmt::format("{:<8} {:>12.3g} {:>12.3g}{}\n", fmt::format("tau_{}", i + 1),
                        fixed.forces[i].certified * (1 + 0.005), fixed.forces[i].measured,
                        fixed.forces[i].measured > fixed.forces[i].certified ? "  above it" : "");
  text += fmt::format(
      "certified: ball arithmetic over {} boxes in q; measured: the compiled code against the sweep in\n"
      "double, at {} states\n\n",
      fixed.boxes, fixed.states);
  text += fmt::format("  {:<10} {:>10} {:>10} {:>6}   sign, before and behind the point\n",
                      "inputs", "from", "to", "bits");
  for (const int slot : slotsOf(fixed, Kind::kInput))
    text += row(fixed.signals[static_cast<std::size_t>(slot)]);
  std::vector<int> results = slotsOf(fixed, Kind::kResult);
  std::stable_sort(results.begin(), results.end(), [&](int a, int b) {
    return fixed.signals[static_cast<std::size_t>(a)].word() >
           fixed.signals[static_cast<std::size_t>(b)].word();
  });
  text += "  the widest results\n";
  for (std::size_t k = 0; k < std::min(kMostRows, results.size()); ++k)
    text += row(fixed.signals[static_cast<std::size_t>(results[k])]);
  if (results.size() > kMostRows)
    text += fmt::format("  and {} more (--json)\n", results.size() - kMostRows);
  const symbolic::Program::Operations count = fixed.program.bodyOperations();
  text += fmt::format(
      "\n{} multiplications, {} additions, {} shifts; words of up to {} bits, products and sums of up "
      "to {}\n",
      count.multiplications, count.additions, fixed.shifts, fixed.widestWord(),
      fixed.widestProduct());
  return text;
}

std::string fixedPointJson(const scene::Scene& scene, const FixedPoint& fixed,
                           const std::string& version) {
  Json signals = Json::array(), forces = Json::array();
  for (const Kind kind : {Kind::kInput, Kind::kConstant, Kind::kResult})
    for (const int slot : slotsOf(fixed, kind))
      signals.push_back(jsonOf(fixed.signals[static_cast<std::size_t>(slot)]));
  for (const FixedForce& f : fixed.forces)
    forces.push_back({{"error_at_most", f.certified},
                      {"error_measured", f.measured},
                      {"q", f.worst.q},
                      {"qd", f.worst.qd},
                      {"qdd", f.worst.qdd}});
  const symbolic::Program::Operations count = fixed.program.bodyOperations();
  return Json{{"dynwitness", version},
              {"scene", scene.name},
              {"error", fixed.error},
              {"boxes", fixed.boxes},
              {"states", fixed.states},
              {"multiplications", count.multiplications},
              {"additions", count.additions},
              {"shifts", fixed.shifts},
              {"widest_word_bits", fixed.widestWord()},
              {"widest_product_bits", fixed.widestProduct()},
              {"forces", forces},
              {"signals", signals}}
             .dump(2) +
         "\n";
}

}  // namespace dynwitness::crosscheck
