// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness geometry: the mass matrix as a metric.
#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/findings.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/state_options.hpp"
#include "crosscheck/studies/geometry.hpp"
#include "crosscheck/studies/given_values.hpp"
#include "crosscheck/studies/hamilton.hpp"
#include "crosscheck/system/files.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

constexpr int kMostShown = 4;  // joints whose Christoffel symbols are printed

struct Arguments {
  GivenScene scene;
  std::string json;
  std::optional<StateOption> given_q, given_qd;
  ActionOptions geodesic;
};

using cli::toJson;
Json toJson(const std::vector<Bounded>& all) {
  Json json = Json::array();
  for (const Bounded& m : all) json.push_back(toJson(m));
  return json;
}

/// Gamma_i,jk and Gamma^i_jk, those that are not 0.
void printConnection(const MetricAt& at) {
  const auto isZero = [](const Bounded& m, Eigen::Index j, Eigen::Index k) {
    return std::abs(m.value(j, k)) <= m.bound(j, k);
  };
  fmt::print("{}\n",
             at.commutes
                 ? "Christoffel  Gamma_i,jk and Gamma^i_jk, those that are not 0"
                 : "connection   Gamma_i,jk = <e_i, D_j e_k> and Gamma^i_jk, those that are "
                   "not 0; j and k do not commute");
  const Eigen::Index f = at.M.value.rows();
  for (Eigen::Index i = 0; i < f; ++i)
    for (Eigen::Index j = 0; j < f; ++j)
      for (Eigen::Index k = at.commutes ? j : 0; k < f; ++k) {
        const Bounded &first = at.first[static_cast<std::size_t>(i)],
                      &second = at.second[static_cast<std::size_t>(i)];
        if (isZero(first, j, k) && isZero(second, j, k)) continue;
        fmt::print("   {},{}{} {:>14.8g} {:>14.8g}\n", i + 1, j + 1, k + 1, first.value(j, k),
                   second.value(j, k));
      }
}

void printMetric(const scene::Scene& scene, const MetricAt& at) {
  const int n = scene.mechanism.dof(), f = static_cast<int>(at.surface.rates.size());
  const std::vector<std::string> all = scene.mechanism.rateLabels();
  std::vector<std::string> names;
  for (const int rate : at.surface.rates) names.push_back(all[static_cast<std::size_t>(rate)]);
  fmt::print("{}: {} joints, q = {}\n", scene.name, n, fmt::join(at.surface.q, ", "));
  if (!scene.mechanism.closures.empty())
    fmt::print("closures     leave {} of {} rates free{}{}\n", f, n,
               f == 0   ? ": nothing moves"
               : f == 1 ? ": a curve, which is flat"
                        : "",
               at.surface.has_dependent_rows ? "; they depend on each other" : "");
  if (f == 0) return;
  fmt::print("metric       M [kg m^2, kg m, kg]\n");
  for (int i = 0; i < f; ++i) {
    fmt::print("  ");
    for (int j = 0; j < f; ++j) fmt::print(" {:>12.6g}", at.M.value(i, j));
    fmt::print("   {}\n", names[static_cast<std::size_t>(i)]);
  }
  if (f <= kMostShown) printConnection(at);
  if (f < 2) return;
  fmt::print("curvature    of the planes of two {} [1/(kg m^2)]{}\n",
             at.commutes ? "joints" : "rates", f == 2 ? ": Gauss's" : "");
  for (int i = 0; i < f; ++i)
    for (int j = i + 1; j < f; ++j)
      if (f <= 2 * kMostShown)
        fmt::print("   {}{} {:>14.8g} {}   {}, {}\n", i + 1, j + 1, at.sectional.value(i, j),
                   boundText(at.sectional.bound(i, j)), names[static_cast<std::size_t>(i)],
                   names[static_cast<std::size_t>(j)]);
  if (f > 2 * kMostShown)
    fmt::print("   from {:.6g} to {:.6g} over {} planes\n", at.sectional.value.minCoeff(),
               at.sectional.value.maxCoeff(), f * (f - 1) / 2);
}

void printGeodesic(const ActionOptions& options, bool rests, const Action& geodesic) {
  fmt::print("geodesic     {} s from qd = {}{}: |T - T0| {:.2g} J in {} steps of order 4\n",
             options.duration, fmt::join(options.qd, ", "),
             rests ? " (the scene starts at rest)" : "", geodesic.energy_drift, geodesic.steps);
  const bool is_sure =
      std::all_of(geodesic.checks.begin(), geodesic.checks.end(),
                  [](const CheckResult& check) { return check.verdict == Verdict::kAgree; });
  if (geodesic.conjugates.empty())
    fmt::print("             no conjugate point{}\n",
               is_sure ? ": nothing near it is shorter" : " seen");
  for (const Action::Conjugate& conjugate : geodesic.conjugates)
    fmt::print("             conjugate point at t = {:.10g} s {} s: neighbours meet it there\n",
               conjugate.time, boundText(conjugate.error));
}

Json jsonOf(const scene::Scene& scene, const MetricAt& at) {
  const std::vector<std::string> names = scene.mechanism.rateLabels();
  Json rates = Json::array();
  for (const int rate : at.surface.rates) rates.push_back(names[static_cast<std::size_t>(rate)]);
  return {{"q", at.surface.q},
          {"rates", rates},
          {"M", toJson(at.M)},
          {"christoffel_first", toJson(at.first)},
          {"christoffel_second", toJson(at.second)},
          {"sectional_curvature", toJson(at.sectional)}};
}

int run(Arguments arguments) {
  requireWritableFile(arguments.json);
  const scene::Scene scene = admitted(arguments.scene, Command::kGeometry);
  ActionOptions& options = arguments.geodesic;
  options.q = arguments.given_q->values(scene, inDouble(scene, scene.start_q));
  options.qd = arguments.given_qd->values(scene, inDouble(scene, scene.start_qd));
  const bool rests =
      std::all_of(options.qd.begin(), options.qd.end(), [](double v) { return v == 0; });
  if (rests) options.qd.assign(options.qd.size(), 1.0);
  options.potential = false;

  std::optional<Progress> progress(std::in_place, 3, 1.0);
  progress->stage("metric of " + scene.name);
  const MetricAt at = metricAt(scene, options.q);
  progress->stage("geodesic");
  options.q = at.surface.q;
  options.qd = surfaceNear(scene, options.q, options.qd).qd;
  const bool moves = !at.surface.rates.empty();
  const Action geodesic = moves ? measureAction(scene, options) : Action();
  requireFinite("M", at.M.value);
  for (const auto* symbols : {&at.first, &at.second})
    for (const Bounded& m : *symbols) requireFinite("Christoffel symbols", m.value);
  requireFinite("curvature", at.sectional.value);
  requireFinite("the geodesic's energy", std::array{geodesic.energy_drift});
  progress->stage("exact checks");
  std::vector<CheckResult> checks = checkGeometryExactly(scene, {});
  progress.reset();
  for (const CheckResult& check : geodesic.checks) checks.push_back(check);

  printMetric(scene, at);
  if (moves) printGeodesic(options, rests, geodesic);
  const int status = printFindings(checks);
  if (!arguments.json.empty()) {
    Json json = jsonOf(scene, at);
    if (moves) {
      json["geodesic"] = {{"qd", options.qd},
                          {"duration_s", options.duration},
                          {"steps", geodesic.steps},
                          {"energy_drift_J", geodesic.energy_drift},
                          {"conjugate_times_s", Json::array()}};
      for (const Action::Conjugate& conjugate : geodesic.conjugates)
        json["geodesic"]["conjugate_times_s"].push_back(conjugate.time);
    }
    writeWholeFile(arguments.json, findingsJson("geometry", scene, json, checks));
  }
  return status;
}

}  // namespace

Run addGeometry(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  addScene(*command, arguments->scene, "Scene");
  arguments->given_q.emplace(command, StateOption::Part::kQ, "the scene's start");
  arguments->given_qd.emplace(command, StateOption::Part::kQd,
                              "of the geodesic's start; the scene's, or 1 each");
  command->add_option("--duration", arguments->geodesic.duration, "Duration [s]: of the geodesic")
      ->check(positive())
      ->capture_default_str();
  addJson(*command, arguments->json);
  command->footer(
      "Examples:\n"
      "  dynwitness geometry double_pendulum --q 0,1.2\n"
      "  dynwitness geometry double_pendulum --q 0,0 --qd 1,0 --duration 8\n"
      "  dynwitness geometry puma_560 --json geometry.json\n"
      "  dynwitness geometry heavy_top       # a body that turns: its rates do not commute\n"
      "  dynwitness geometry loop_on_arm     # what closures leave free, by Gauss's equation\n"
      "The laws are decided over a prime field, for every state of the scene. Exit status 1: one "
      "fails.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
