// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/parameters/parameters_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/report/text.hpp"
#include "crosscheck/witnesses/column_names.hpp"
#include "scene/units.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;
using Status = BaseParameters::Status;

const char* words(Status status) {
  return status == Status::kAlone           ? "alone"
         : status == Status::kInCombination ? "in combination"
                                            : "not at all";
}
const char* keyword(Status status) {
  return status == Status::kAlone           ? "alone"
         : status == Status::kInCombination ? "combination"
                                            : "none";
}

/// A sum in lines of 100 columns, broken before its signs, the later lines indented.
std::string wrapped(const std::string& text, std::size_t indent) {
  std::string out;
  std::size_t begun = 0, last = 0;  // the line, and the last place to break it
  int depth = 0;
  for (std::size_t k = 0; k < text.size(); ++k) {
    depth += (text[k] == '(') - (text[k] == ')');
    if (k - begun >= 100 - indent && last > begun) {
      out += text.substr(begun, last - begun) + "\n" + std::string(indent, ' ');
      begun = last + 1;
    }
    if (depth == 0 && (text.compare(k, 3, " + ") == 0 || text.compare(k, 3, " - ") == 0)) last = k;
  }
  return out + text.substr(begun);
}

std::string number(const std::optional<double>& x) {
  return x ? fmt::format("{:.3g}", *x) : "-";
}

/// What is 0 but for rounding on its way is 0 for a reader.
double shown(double value, double scale) {
  return std::abs(value) <= 16 * std::numeric_limits<double>::epsilon() * scale ? 0 : value;
}

std::string ratios(const CovarianceCheck& check) {
  return std::isfinite(check.most) ? fmt::format("{:.4f} to {:.4f}", check.least, check.most)
                                   : "beyond all limits";
}

/// Deviations of one number a rate, by inertia, by placement and together, beside the number.
std::string ratesTable(const ParametersResult& result, Quantity quantity,
                       const Deviations& deviations, const Eigen::VectorXd& itself) {
  const std::vector<std::string> labels = result.scene.mechanism.rateLabels();
  const std::vector<std::string> units = columnUnits(quantity, result.scene.mechanism);
  std::size_t width = 5;
  for (const std::string& label : labels) width = std::max(width, label.size());
  std::string out =
      fmt::format("{:<{}}  {:>12}  {:>12}  {:>12}  {:>12}  unit\n", "joint", width, "by inertia",
                  "by placement", "together", std::string(name(quantity)) + " itself");
  const Eigen::VectorXd together = deviations.together();
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    out += fmt::format("{:<{}}  {:>12.4g}  {:>12.4g}  {:>12.4g}  {:>12.4g}  {}\n", labels[i], width,
                       deviations.by_inertia(k), deviations.by_placement(k), together(k), itself(k),
                       units[i]);
  }
  return out;
}

/// What the joints pass on, block by block.
std::string jointsTable(const std::vector<JointDeviation>& joints) {
  std::size_t width = 5;
  for (const JointDeviation& joint : joints) width = std::max(width, joint.joint.size());
  std::string out = fmt::format(
      "\nThe same of M_A and P of each joint, of the roots of sums of squares of blocks of three by "
      "three:\n\n{:<{}}  {:>10}  {:>10}  {:>10}  {:>10}  {:>10}  {:>10}  {:>10}\n{:<{}}",
      "joint", width, "M_A", "M_A", "M_A", "P, f of f", "P, f of m", "P, m of f", "P, m of m", "",
      width);
  for (const char* unit : {"kg", "kg m", "kg m^2", "1", "1/m", "m", "1"})
    out += fmt::format("  {:>10}", unit);
  out += "\n";
  for (const JointDeviation& joint : joints) {
    out += fmt::format("{:<{}}", joint.joint, width);
    for (const double deviation : joint.M_A) out += fmt::format("  {:>10.4g}", deviation);
    for (const double deviation : joint.P) out += fmt::format("  {:>10.4g}", deviation);
    out += "\n";
  }
  return out + "Entry by entry: dynwitness evaluate SCENE --quantity M_A,P --uncertainty ...\n";
}

/// What was drawn, beside what was computed.
std::string drawsText(const ParametersResult& result) {
  const UncertaintyResult& u = *result.uncertainty;
  if (!u.inertia && u.geometry.empty()) return "";
  std::string out = fmt::format(
      "\nDrawn instead, {} times at state 0 of seed {}: sampled / computed deviations of tau\n",
      result.options.samples, result.options.seed);
  if (u.inertia)
    out += fmt::format("  inertia                      {}   {:.4f} to {:.4f} allowed: {}\n",
                       ratios(*u.inertia), u.inertia->low, u.inertia->high,
                       u.inertia->agrees() ? "agree" : "DISAGREE");
  if (u.geometry.empty()) return out;
  for (const GeometryRow& row : u.geometry)
    out += fmt::format("  placement {:>8.3g} m, {:>8.3g} rad   {}   {}\n", row.scale * u.given.xyz,
                       row.scale * u.given.rpy, ratios(row.check),
                       row.check.agrees() ? "first order agrees" : "first order breaks down");
  return out + fmt::format(
                   "Allowed is what chi-square quantiles leave to normal draws: outside with a "
                   "chance of {:.0e}.\n",
                   result.options.chance);
}

std::string uncertaintyText(const ParametersResult& result) {
  const UncertaintyResult& u = *result.uncertainty;
  std::string out =
      fmt::format("\nStandard deviations of tau for {}, root mean squares over {} states:\n\n",
                  result.options.uncertainty, result.options.states);
  out += ratesTable(result, Quantity::kTau, {u.by_inertia, u.by_geometry}, u.tau);
  out +=
      "Inertia: Y Sigma Y', exact, for tau is linear in pi. Placement: first order, by dual "
      "numbers.\n\nThe same of qdd at the joint forces of these states, all of first order:\n\n";
  out += ratesTable(result, Quantity::kQdd, u.of_qdd, u.qdd);
  out +=
      fmt::format("M dqdd = -dtau over a prime field, each inertial parameter and placement: {}\n",
                  u.follows ? "agree" : "DISAGREE");
  if (!u.joints.empty()) out += jointsTable(u.joints);
  return out + drawsText(result);
}

}  // namespace

std::string parametersText(const ParametersResult& result) {
  const scene::Mechanism& mechanism = result.scene.mechanism;
  const BaseParameters& base = result.base;
  std::string out = fmt::format(
      "{}: {}\n\n"
      "tau = Y(q, qd, qdd) pi, plus springs, less loads. pi of a link, in the axes of its frame: "
      "mass m,\n"
      "first moment m c, inertia I about the frame's origin; rotor: gear_ratio^2 rotor_inertia.\n\n",
      result.scene.name, result.scene.title);

  std::size_t width = 4;
  for (const scene::Link& link : mechanism.links)
    width = std::max({width, link.name.size(), link.joint.name.size()});
  out += fmt::format("{:<{}}  {:<9}  {:>12}  {:<6}  the motion knows it\n", "link", width,
                     "parameter", "value", "unit");
  for (std::size_t j = 0; j < base.parameters.size(); ++j) {
    const scene::InertialParameter& parameter = base.parameters[j];
    const scene::Link& link = mechanism.links[parameter.link];
    const bool is_rotor = parameter.kind == scene::InertialParameter::Kind::kRotor;
    double scale = 0;  // of the link's numbers of this kind
    for (std::size_t k = 0; k < base.parameters.size(); ++k)
      if (base.parameters[k].link == parameter.link &&
          unit(base.parameters[k], mechanism) == unit(parameter, mechanism))
        scale = std::max(scale, std::abs(result.values[k]));
    out +=
        fmt::format("{:<{}}  {:<9}  {:>12.6g}  {:<6}  {}\n", is_rotor ? link.joint.name : link.name,
                    width, name(parameter.kind), shown(result.values[j], scale),
                    unit(parameter, mechanism), words(base.status[j]));
  }

  const int p = static_cast<int>(base.parameters.size()), links = base.countWithoutRotors();
  out += fmt::format("\n{} base parameters of {}", base.count(), p);
  if (links != base.count()) out += fmt::format(" ({} without rotors)", links);
  out += fmt::format(
      ": the rank of Y at {} random points of prime fields;\nchance that it is larger: {:.1e}.\n",
      base.points, base.error_probability);
  out += fmt::format(
      "  energies of the Lagrangian, d(T + V)/dpi: {}: {}\n",
      result.energy_rank < 0 ? "other combinations" : fmt::format("rank {}", result.energy_rank),
      result.energy_rank == base.count() ? "agree" : "DISAGREE");
  if (result.closed_form)
    out +=
        fmt::format("  Mayeda, Yoshida and Osuka (1990), 7 n - 4 b [- 2], without rotors: {}: {}\n",
                    *result.closed_form, *result.closed_form == links ? "agree" : "DISAGREE");

  out += "\n  #         value  unit    base parameter\n";
  for (int r = 0; r < base.count(); ++r) {
    double scale = std::abs(result.values[base.independent[r]]);
    for (const Coefficient& c : base.K)
      if (c.base == r) scale = std::max(scale, std::abs(c.value * result.values[c.parameter]));
    out += fmt::format("{:>3}  {:>12.6g}  {:<6}  {}\n", r + 1, shown(result.baseValue(r), scale),
                       unit(base.parameters[base.independent[r]], mechanism),
                       wrapped(combination(base, r, mechanism), 27));
  }
  const bool rational = std::all_of(base.K.begin(), base.K.end(),
                                    [](const Coefficient& c) { return c.exact.has_value(); });
  out +=
      fmt::format("Coefficients {}.\n",
                  rational ? "are exact rationals, held to one prime more and to certified digits"
                           : "have certified digits (some angles have no rational cosine)");
  if (result.condition || result.scaled_condition)
    out += fmt::format(
        "\nCondition number of Y's base columns over {} states of seed {}: {} in SI units, {} with "
        "columns of length 1.\n",
        result.options.states, result.options.seed, number(result.condition),
        number(result.scaled_condition));
  else
    out +=
        fmt::format("\nNo condition number: {} states give {} rows for {} base parameters.\n",
                    result.options.states, result.options.states * mechanism.dof(), base.count());
  if (result.uncertainty) out += uncertaintyText(result);
  return out;
}

namespace {

Json toJson(const std::optional<double>& x) {
  return x && std::isfinite(*x) ? Json(*x) : Json();
}
Json toJson(const CovarianceCheck& check) {
  return {{"least_ratio", toJson(std::optional<double>(check.least))},
          {"most_ratio", toJson(std::optional<double>(check.most))},
          {"allowed", {check.low, check.high}},
          {"agrees", check.agrees()}};
}

Json ratesJson(const scene::Mechanism& mechanism, Quantity quantity, const Deviations& deviations,
               const Eigen::VectorXd& itself) {
  Json out = Json::array();
  const std::vector<std::string> labels = mechanism.rateLabels(),
                                 units = columnUnits(quantity, mechanism);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    out.push_back({{"joint", cleanText(labels[i])},
                   {"unit", units[i]},
                   {"by_inertia", deviations.by_inertia(k)},
                   {"by_placement", deviations.by_placement(k)},
                   {name(quantity), itself(k)}});
  }
  return out;
}

}  // namespace

std::string parametersJson(const ParametersResult& result, const std::string& version) {
  const scene::Mechanism& mechanism = result.scene.mechanism;
  const BaseParameters& base = result.base;
  Json json{{"dynwitness", cleanText(version)},
            {"scene", cleanText(result.scene.name)},
            {"states", result.options.states},
            {"seed", result.options.seed},
            {"rank",
             {{"base", base.count()},
              {"base_without_rotors", base.countWithoutRotors()},
              {"parameters", base.parameters.size()},
              {"points", base.points},
              {"error_probability", base.error_probability},
              {"energy_rank", result.energy_rank},
              {"closed_form", result.closed_form ? Json(*result.closed_form) : Json()}}}};
  json["parameters"] = Json::array();
  for (std::size_t j = 0; j < base.parameters.size(); ++j)
    json["parameters"].push_back(
        {{"name", cleanText(label(base.parameters[j], mechanism))},
         {"link", cleanText(mechanism.links[base.parameters[j].link].name)},
         {"parameter", name(base.parameters[j].kind)},
         {"value", result.values[j]},
         {"unit", unit(base.parameters[j], mechanism)},
         {"identifiable", keyword(base.status[j])}});
  json["base_parameters"] = Json::array();
  for (int r = 0; r < base.count(); ++r) {
    const scene::InertialParameter& first = base.parameters[base.independent[r]];
    Json terms = Json::array();
    terms.push_back({{"name", cleanText(label(first, mechanism))},
                     {"coefficient", 1.0},
                     {"error", 0.0},
                     {"exact", "1"},
                     {"symbol", nullptr}});
    for (const Coefficient& c : base.K)
      if (c.base == r)
        terms.push_back({{"name", cleanText(label(base.parameters[c.parameter], mechanism))},
                         {"coefficient", c.value},
                         {"error", c.error},
                         {"exact", c.exact ? Json(c.exact->str()) : Json()},
                         {"symbol", c.symbol.empty() ? Json() : Json(cleanText(c.symbol))}});
    json["base_parameters"].push_back(
        {{"value", result.baseValue(r)}, {"unit", unit(first, mechanism)}, {"terms", terms}});
  }
  json["condition"] = {{"si", toJson(result.condition)},
                       {"unit_columns", toJson(result.scaled_condition)}};
  if (result.uncertainty) {
    const UncertaintyResult& u = *result.uncertainty;
    Json passed_on = Json::array();
    for (const JointDeviation& joint : u.joints)
      passed_on.push_back({{"joint", cleanText(joint.joint)}, {"M_A", joint.M_A}, {"P", joint.P}});
    Json rows = Json::array();
    for (const GeometryRow& row : u.geometry)
      rows.push_back({{"scale", row.scale}, {"check", toJson(row.check)}});
    json["uncertainty"] = {
        {"given", cleanText(result.options.uncertainty)},
        {"joints", ratesJson(mechanism, Quantity::kTau, {u.by_inertia, u.by_geometry}, u.tau)},
        {"accelerations", ratesJson(mechanism, Quantity::kQdd, u.of_qdd, u.qdd)},
        {"accelerations_follow_forces", u.follows},
        {"passed_on", passed_on},
        {"samples", result.options.samples},
        {"chance", result.options.chance},
        {"inertia", u.inertia ? toJson(*u.inertia) : Json()},
        {"placement", rows}};
  }
  json["agrees"] = result.agrees();
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace dynwitness::crosscheck
