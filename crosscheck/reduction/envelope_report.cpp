// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "crosscheck/reduction/envelope.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;

std::string row(const std::vector<double>& x) {
  std::string text;
  for (const double v : x) text += fmt::format("{}{:.4g}", text.empty() ? "" : ", ", v);
  return text;
}

/// Of a tree of turning and sliding joints.
std::string unitIn(const scene::Scene& scene, const EnvelopeQuantity& of) {
  const std::vector<scene::SlotKind> slots = scene.mechanism.slots();
  const auto turns = [&](int i) {
    return slots[static_cast<std::size_t>(i)] == scene::SlotKind::kAngle;
  };
  switch (of.kind) {
    case EnvelopeQuantity::Kind::kM:
      return turns(of.i) && turns(of.j) ? "kg m^2" : turns(of.i) || turns(of.j) ? "kg m" : "kg";
    case EnvelopeQuantity::Kind::kT:
    case EnvelopeQuantity::Kind::kV:
    case EnvelopeQuantity::Kind::kEnergy:
      return "J";
    case EnvelopeQuantity::Kind::kReaction:
      return of.j < 3 ? "N" : "N m";
    case EnvelopeQuantity::Kind::kQdd:
      return turns(of.i) ? "rad/s^2" : "m/s^2";
    default:
      return turns(of.i) ? "N m" : "N";
  }
}

/// Those that weigh more, or less, at the worst state.
std::vector<std::string> linksOf(const scene::Scene& scene, const EnvelopeBound& bound,
                                 bool heavier) {
  std::vector<std::string> out;
  const std::vector<std::size_t> links = weighingLinks(scene.mechanism);
  for (std::size_t k = 0; k < bound.heavier.size(); ++k)
    if (bound.heavier[k] == heavier) out.push_back(scene.mechanism.links[links[k]].name);
  return out;
}

/// "; heavier: a, b; lighter: c"
std::string weights(const scene::Scene& scene, const EnvelopeBound& bound) {
  std::string text;
  for (const bool heavier : {true, false})
    if (const std::vector<std::string> names = linksOf(scene, bound, heavier); !names.empty())
      text += fmt::format("; {}: {}", heavier ? "heavier" : "lighter", fmt::join(names, ", "));
  return text;
}

double asDouble(const scene::Rational& x) {
  return scene::Exact{x, 0}.toDouble();
}

/// "; m1 = 3.3, m2 = 1.8"
std::string values(const EnvelopeBound& bound,
                   const std::vector<scene::UncertainParameter>& parameters) {
  std::string text;
  for (std::size_t k = 0; k < bound.higher.size(); ++k)
    text += fmt::format("{}{} = {:.4g}", k == 0 ? "; " : ", ", parameters[k].name,
                        asDouble(bound.higher[k] ? parameters[k].high : parameters[k].low));
  return text;
}

Json number(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}

}  // namespace

std::string envelopeText(const scene::Scene& scene, const std::vector<EnvelopeBound>& bounds,
                         const EnvelopeOptions& options) {
  std::string text = fmt::format(
      "{}: |x| over the envelope\n{:<13} {:>12} {:>12} {:<7} {:>7} {:>7}  worst state seen (SI units)\n",
      scene.name, "", "at most", "at least", "", "ratio", "boxes");
  for (const EnvelopeBound& b : bounds) {
    // outward: what is printed is still a bound
    const double shown = std::nextafter(b.certified * (1 + 5e-6), HUGE_VAL);
    text +=
        fmt::format("{:<13} {:>12.6g} {:>12.6g} {:<7} {:>7.4g} {:>7}  ", b.quantity.name(), shown,
                    b.sampled * (1 - 5e-6), unitIn(scene, b.quantity), b.ratio(), b.boxes);
    text += b.worst.q.empty()
                ? std::string(b.is_reached ? "0, but for roundings\n" : "nothing but 0 was seen\n")
                : fmt::format("q = {}; qd = {}; {} = {}{}{}\n", row(b.worst.q), row(b.worst.qd),
                              b.worst.tau.empty() ? "qdd" : "tau",
                              row(b.worst.tau.empty() ? b.worst.qdd : b.worst.tau),
                              weights(scene, b), values(b, options.parameters));
    if (!b.is_reached)
      text += std::string(14, ' ') +
              (std::isfinite(b.certified)
                   ? "the ratio that was asked for was not reached: more --boxes\n"
                   : "no bound was found: more --boxes\n");
  }
  return text;
}

std::string envelopeJson(const scene::Scene& scene, const EnvelopeBoxes& boxes,
                         const std::vector<EnvelopeBound>& bounds, const EnvelopeOptions& options,
                         const std::string& version) {
  Json joints = Json::array(), rows = Json::array(), uncertain = Json::array();
  const std::vector<std::string> labels = scene.mechanism.rateLabels();
  const std::vector<scene::JointRanges> ranges = hullOf(boxes);
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    joints.push_back({{"joint", labels[k]},
                      {"q", {ranges[k].q.low, ranges[k].q.high}},
                      {"qd", {ranges[k].qd.low, ranges[k].qd.high}},
                      {"qdd", {ranges[k].qdd.low, ranges[k].qdd.high}}});
    if (ranges[k].tau) joints.back()["tau"] = {ranges[k].tau->low, ranges[k].tau->high};
  }
  for (const scene::UncertainParameter& p : options.parameters)
    uncertain.push_back(
        {{"parameter", p.name}, {"low", asDouble(p.low)}, {"high", asDouble(p.high)}});
  for (const EnvelopeBound& b : bounds) {
    Json at = Json::array();
    for (std::size_t k = 0; k < b.higher.size(); ++k)
      at.push_back({{"parameter", options.parameters[k].name},
                    {"value", asDouble(b.higher[k] ? options.parameters[k].high
                                                   : options.parameters[k].low)}});
    rows.push_back({{"quantity", b.quantity.name()},
                    {"unit", unitIn(scene, b.quantity)},
                    {"at_most", number(b.certified)},
                    {"at_least", b.sampled},
                    {"ratio", number(b.ratio())},
                    {"ratio_is_reached", b.is_reached},
                    {"boxes", b.boxes},
                    {"q", b.worst.q},
                    {"qd", b.worst.qd},
                    {"qdd", b.worst.qdd},
                    {"tau", b.worst.tau},
                    {"heavier", linksOf(scene, b, true)},
                    {"lighter", linksOf(scene, b, false)},
                    {"parameters", at}});
  }
  return Json{{"dynwitness", version},
              {"scene", scene.name},
              {"ratio_asked", options.ratio},
              {"most_boxes", options.boxes},
              {"masses_within", static_cast<double>(options.masses)},
              {"uncertain_parameters", uncertain},
              {"boxes_of_motion", boxes.size()},
              {"envelope", joints},
              {"bounds", rows}}
             .dump(2) +
         "\n";
}

}  // namespace dynwitness::crosscheck
