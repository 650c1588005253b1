// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/kernel/emit.hpp"
#include "crosscheck/reduction/reduce.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostSentences = 24;  ///< of changed terms that are printed; JSON has all
constexpr int kLanes = 2;                   ///< of C code that is to be read on any machine

/// Rounded up to three digits: what is printed is still a bound.
std::string percent(double share) {
  if (share == 0) return "0";
  const double x = 100 * share;
  const double unit = std::pow(10, std::floor(std::log10(x)) - 2);
  return fmt::format("{:.3g}", std::ceil(x / unit) * unit);
}

/// Outward by what six digits hide.
double outward(double x) {
  return x == 0 ? 0 : std::nextafter(x * (1 + 5e-6), HUGE_VAL);
}

std::string sentence(const ChangedTerm& term) {
  return fmt::format("{}: at most {} % of tau_{}{}", term.name(), percent(term.share), term.i + 1,
                     term.is_dropped ? "" : ", simplified");
}

double seenShare(const ReducedModel& model) {
  double most = 0;
  for (const ReducedForce& force : model.forces)
    if (force.largest > 0) most = std::max(most, force.at_least / force.largest);
  return most;
}

bool isWhole(const ReducedModel& model) {
  return !model.is_explicit && model.parameters.empty() && model.terms.empty();
}

constexpr const char* kLegend =
    "\ncertified: no state of [envelope] errs by more, proven; seen: the largest error at any state "
    "met;\nas a scene: of parameters left out alone, without terms, as --toml writes it\n";

std::string howItIsMade(const ReducedModel& model) {
  if (isWhole(model)) return "nothing left out";
  if (model.is_explicit) return fmt::format("{} terms", model.terms.size());
  return fmt::format(
      "{} parameters less{}", model.parameters.size(),
      model.terms.empty() ? "" : fmt::format(", {} terms added", model.terms.size()));
}

std::string detail(const ReducedModel& model, ReducedQuantity of) {
  std::string text;
  if (!model.is_explicit && !model.parameters.empty()) {
    text += "\nwithout, one after the other (what samples miss with it, in all):\n";
    for (const DroppedParameter& parameter : model.parameters)
      text += fmt::format("  {:<60} {:.2g} %\n", parameter.what, 100 * parameter.sampled);
  }
  if (model.is_explicit) text += "\nall of it in terms, none by a sweep\n";
  std::vector<std::string> lines;
  for (const bool dropped : {true, false})
    for (const ChangedTerm& term : model.changed)
      if (term.is_dropped == dropped) lines.push_back(sentence(term));
  if (!lines.empty())
    text += fmt::format(
        "\n{} terms of the equations of motion are dropped or simplified, "
        "proven for each alone:\n",
        lines.size());
  for (std::size_t k = 0; k < std::min(lines.size(), kMostSentences); ++k)
    text += "  " + lines[k] + "\n";
  if (lines.size() > kMostSentences)
    text += fmt::format("  and {} more (--json)\n", lines.size() - kMostSentences);
  text += kLegend;
  text += fmt::format("\n{:<8} {:>12} {:>12} {:>12} {:>8}\n", "", "largest", "error", "seen", "");
  for (std::size_t i = 0; i < model.forces.size(); ++i) {
    const ReducedForce& force = model.forces[i];
    text += fmt::format("{:<8} {:>12.6g} {:>12.6g} {:>12.6g} {:>8} %\n",
                        fmt::format("{}_{}", name(of), i + 1), force.largest,
                        outward(force.at_most), force.at_least, percent(force.share()));
  }
  return text;
}

Json jsonOf(const ReducedModel& model) {
  Json parameters = Json::array(), terms = Json::array(), changed = Json::array(),
       forces = Json::array();
  for (const DroppedParameter& p : model.parameters)
    parameters.push_back({{"what", p.what}, {"sampled_share", p.sampled}});
  for (const KeptTerm& t : model.terms) {
    Json factors = Json::array();
    for (std::size_t k = 0; k < model.forces.size(); ++k)
      factors.push_back(digit(t.monomial, static_cast<int>(k)));
    terms.push_back({{"tau", t.i + 1},
                     {"coefficient", t.coefficient},
                     {"functions", factors},
                     {"qdd", t.j >= 0 && t.k < 0 ? Json(t.j + 1) : Json(nullptr)},
                     {"qd", t.k >= 0 ? Json({t.j + 1, t.k + 1}) : Json(nullptr)}});
  }
  for (const ChangedTerm& t : model.changed)
    changed.push_back({{"term", t.name()},
                       {"tau", t.i + 1},
                       {"is_dropped", t.is_dropped},
                       {"share_at_most", t.share},
                       {"sentence", sentence(t)}});
  for (const ReducedForce& f : model.forces)
    forces.push_back({{"largest", f.largest},
                      {"error_at_most", f.at_most},
                      {"error_at_least", f.at_least},
                      {"q", f.worst.q},
                      {"qd", f.worst.qd},
                      {"qdd", f.worst.qdd},
                      {"tau", f.worst.tau}});
  return {{"allowed", model.allowed},         {"operations", model.operations()},
          {"certified", model.share()},       {"is_explicit", model.is_explicit},
          {"parameters_dropped", parameters}, {"terms_added", terms},
          {"terms_changed", changed},         {"forces", forces}};
}

}  // namespace

std::string reductionText(const scene::Scene& scene, const Reduction& reduction) {
  std::string text = fmt::format(
      "{0}: operations (multiplications, additions{2}) of {1}; errors in % of each joint's largest "
      "|{1}|{3}\n\n{4:>10} {5:>10} {6:>10} {7:>8}  {8:<36} {9:>10} {10:>10}\n",
      scene.name, name(reduction.of), reduction.of == ReducedQuantity::kQdd ? ", divisions" : "",
      reduction.of == ReducedQuantity::kQdd ? ",\nfor the same q, qd and tau of [envelope]" : "",
      "allowed", "operations", "certified", "seen", "made by", "as a scene", "certified");
  text += fmt::format("{:>10} {:>10} {:>10} {:>8}  the scene's own program\n", "-",
                      reduction.full.bodyOperations().all(), "0", "0");
  const auto row = [&](const ReducedModel& m, const ReducedModel* s) {
    text += fmt::format("{:>8} % {:>10} {:>8} % {:>6} %  {:<36}",
                        fmt::format("{:.3g}", 100 * m.allowed), m.operations(), percent(m.share()),
                        fmt::format("{:.2g}", 100 * seenShare(m)), howItIsMade(m));
    if (s) text += fmt::format(" {:>10} {:>8} %", s->operations(), percent(s->share()));
    text += "\n";
  };
  for (std::size_t t = 0; t < reduction.models.size(); ++t)
    row(reduction.models[t], &reduction.scenes[t]);
  for (const ReducedModel& m : reduction.by_rule) {
    text += "\nArmstrong's rule, terms below so much of their entry's largest dropped:\n";
    row(m, nullptr);
  }
  for (std::size_t t = 0; t < reduction.models.size(); ++t)
    if (isWhole(reduction.models[t]) && isWhole(reduction.scenes[t]))
      text += fmt::format(
          "{}nothing was found that may be left out within {:.3g} %: it stays the scene's own "
          "program\n",
          t == 0 ? "\n" : "", 100 * reduction.models[t].allowed);
  text += reduction.models.size() == 1 ? detail(reduction.models.front(), reduction.of) : kLegend;
  return text;
}

std::string reductionJson(const scene::Scene& scene, const Reduction& reduction,
                          const std::string& version) {
  Json models = Json::array(), scenes = Json::array(), by_rule = Json::array();
  for (const ReducedModel& m : reduction.models) models.push_back(jsonOf(m));
  for (const ReducedModel& m : reduction.scenes) scenes.push_back(jsonOf(m));
  for (const ReducedModel& m : reduction.by_rule) by_rule.push_back(jsonOf(m));
  return Json{{"dynwitness", version},
              {"scene", scene.name},
              {"of", name(reduction.of)},
              {"operations", reduction.full.bodyOperations().all()},
              {"models", models},
              {"as_scenes", scenes},
              {"by_armstrongs_rule", by_rule}}
             .dump(2) +
         "\n";
}

std::string reductionC(const scene::Scene& scene, const ReducedModel& model, ReducedQuantity of) {
  const bool is_tau = of == ReducedQuantity::kTau;
  std::string text = fmt::format(
      "// {2} of {0}, reduced: {1} operations; out = {2}, u = qd, w = {3}, SI units.\n"
      "// In the scene's [envelope] it is off by no more than, joint by joint (proven, but for the\n"
      "// roundings of this code):\n",
      scene.name, model.operations(), name(of), is_tau ? "qdd" : "tau");
  for (std::size_t i = 0; i < model.forces.size(); ++i)
    text += fmt::format("//   {}_{}: {:.6g}, {} % of its largest\n", name(of), i + 1,
                        outward(model.forces[i].at_most), percent(model.forces[i].share()));
  const symbolic::ProgramRun<double> run(model.program,
                                         scene::RealNumbers<double>(scene.mechanism));
  return text + kernel::emitKernel(model.program, run,
                                   is_tau ? "reduced_inverse_dynamics" : "reduced_forward_dynamics",
                                   kLanes);
}

std::string frontCsv(const scene::Scene& scene, const Reduction& reduction) {
  std::string text = fmt::format(
      "# {0}: operations of {1} against its error, a share of each joint's largest |{1}|; certified: "
      "proven, seen: at some state\n"
      "allowed,operations,certified,seen,scene_operations,scene_certified\n",
      scene.name, name(reduction.of));
  for (std::size_t t = 0; t < reduction.models.size(); ++t) {
    const ReducedModel &m = reduction.models[t], &s = reduction.scenes[t];
    text += fmt::format("{},{},{:.6g},{:.6g},{},{:.6g}\n", m.allowed, m.operations(),
                        outward(m.share()), seenShare(m), s.operations(), outward(s.share()));
  }
  return text;
}

}  // namespace dynwitness::crosscheck
