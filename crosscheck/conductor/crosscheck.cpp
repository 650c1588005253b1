// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/conductor/crosscheck.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "crosscheck/conductor/archive.hpp"
#include "crosscheck/conductor/ask_witnesses.hpp"
#include "crosscheck/conductor/describe.hpp"
#include "crosscheck/conductor/exact_checks.hpp"
#include "crosscheck/conductor/plan.hpp"
#include "crosscheck/exact/control_in_field.hpp"
#include "crosscheck/exact/ledger.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/closure_gap.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/motion/drift.hpp"
#include "crosscheck/system/processes.hpp"
#include "crosscheck/verdicts/check_derivatives.hpp"
#include "crosscheck/verdicts/check_drift.hpp"
#include "crosscheck/verdicts/check_identities.hpp"
#include "crosscheck/verdicts/check_mechanism.hpp"
#include "crosscheck/verdicts/check_motions.hpp"
#include "crosscheck/verdicts/check_points.hpp"
#include "crosscheck/verdicts/check_reading.hpp"
#include "crosscheck/verdicts/check_second_derivatives.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/control.hpp"
#include "crosscheck/verdicts/tables.hpp"
#include "crosscheck/witnesses/own_file.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Stands in the report where checks would stand that the plan leaves out.
CheckResult leftOut(const Plan& plan, const char* what) {
  CheckResult check;
  check.kind = CheckKind::kLeftOut;
  check.law = what;
  check.statement = fmt::format("{} of this scene", what);
  check.left = what;
  check.verdict = Verdict::kNotAnswerable;
  check.reason = plan.told.back();
  return check;
}

// ---- the parts ----------------------------------------------------------------------------------

SceneResult byWitnesses(const PreparedScene& scene, const std::vector<WitnessKind>& kinds,
                        const Options& options, const Plan& plan) {
  SceneResult result;
  DigitsFound truth = askWitnesses(scene, kinds, options, result.checks, result.controls);
  append(result.checks, std::move(truth.checks));
  if (plan.whole)
    append(result.checks, checkMechanism(scene, options));
  else if (ConstrainedQuantities::isConstrained(scene.mechanism()))
    result.checks.push_back(leftOut(plan, "motion and forces of the whole mechanism"));
  result.digits = std::move(truth.digits);
  result.findings = std::move(truth.losses);
  return result;
}

SceneResult byLaws(const PreparedScene& scene, const Options& options, const Plan& plan) {
  SceneResult result;
  describe(scene.scene(), options, result);
  result.not_modelled.insert(result.not_modelled.end(), plan.told.begin(), plan.told.end());
  result.ledger = ledgerOf(scene, {options.seed, options.error_probability});
  if (!plan.whole) {
    result.checks = {leftOut(plan, "laws of mechanics"),
                     leftOut(plan, "energy of a simulated motion")};
    return result;
  }
  result.equations = equationsOf(scene.mechanism());
  result.checks = checkIdentities(scene, options);
  append(result.checks, checkPoints(scene, options));
  append(result.checks, checkDerivatives(scene, options));
  append(result.checks, checkSecondDerivatives(scene, options));
  if (options.drift && refusals(scene.scene(), Command::kDrift).empty())
    result.drift = measureDrift(scene, {});
  return result;
}

SceneResult exactly(const PreparedScene& scene, const std::vector<WitnessKind>& kinds,
                    const Options& options, const Plan& plan) {
  SceneResult result;
  if (!plan.whole) {
    result.checks = {leftOut(plan, "exact checks")};
    return result;
  }
  ExactOptions exact;
  exact.seed = options.seed;
  exact.error_probability = options.error_probability;
  exact.parameters = options.parameters;
  exact.witnesses = kinds;
  result.checks = exactChecks(scene, exact);
  result.controls = controlInField(scene.scene(), exact);
  return result;
}

/// Against what is no witness of dynamics: the scene's own file, published numbers and motions.
SceneResult byTables(const PreparedScene& scene, const std::vector<WitnessKind>& kinds,
                     const Options& options) {
  SceneResult result;
  result.checks = checkReading(scene, options.seed, readersOfOwnFile(scene, kinds));
  for (const std::filesystem::path& table : bundledTables()) {
    if (!isAbout(table, scene.scene())) continue;
    append(result.checks, compareWithTable(table, scene, kinds));
    for (Control& control : controlOfTable(table, scene))
      result.controls.push_back(std::move(control));
  }
  if (options.drift) result.motions = publishedMotions(scene.scene());
  return result;
}

/// Each asks for nothing that another finds; the longest first.
enum class Part { kWitnesses, kLaws, kExact, kTables };
constexpr int kParts = 4;

SceneResult crosscheckPart(const PreparedScene& scene, const std::vector<WitnessKind>& kinds,
                           Options options, int part) {
  const Plan plan = planFor(scene.scene(), options);
  options.states = plan.states;
  switch (static_cast<Part>(part)) {
    case Part::kWitnesses:
      return byWitnesses(scene, kinds, options, plan);
    case Part::kLaws:
      return byLaws(scene, options, plan);
    case Part::kExact:
      return exactly(scene, kinds, options, plan);
    case Part::kTables:
      return byTables(scene, kinds, options);
  }
  return {};
}

// ---- their results as one -----------------------------------------------------------------------

/// Puts the exact verdicts beside the rounded ones of the same comparison; those without such a
/// twin become checks of their own. A residual that is not zero outweighs numbers that agree.
void attachExact(std::vector<CheckResult>& checks, const std::vector<CheckResult>& exact) {
  for (const CheckResult& verdict : exact) {
    const auto twin = std::find_if(checks.begin(), checks.end(), [&](const CheckResult& check) {
      return !check.exact && check.asksTheSameAs(verdict);
    });
    if (twin == checks.end()) {
      checks.push_back(verdict);
      continue;
    }
    twin->exact = verdict.exact;
    if (verdict.verdict == Verdict::kNotAnswerable) twin->no_exact = verdict.reason;
    if (verdict.verdict == Verdict::kDisagree) {
      twin->verdict = Verdict::kDisagree;
      twin->reason = verdict.reason;
    }
  }
}

/// That the start leaves closures open, if it does.
std::vector<Finding> openStart(const PreparedScene& scene) {
  const ClosureGap gap = ClosureGaps::ofStart(scene);
  if (!gap.is_open) return {};
  Finding finding;
  finding.kind = Finding::Kind::kOpenStart;
  finding.scene = scene.scene().name;
  finding.quantity = "closures";
  finding.text =
      fmt::format("{}: the start leaves closures open, {}: more than rounding of q and qd explains",
                  finding.scene, gap.text());
  return {finding};
}

/// @param parts  one a Part
SceneResult assembled(const PreparedScene& scene, std::vector<SceneResult> parts) {
  const auto part = [&parts](Part p) -> SceneResult& { return parts.at(static_cast<int>(p)); };
  SceneResult &witnesses = part(Part::kWitnesses), &exact = part(Part::kExact),
              &tables = part(Part::kTables);
  SceneResult result = std::move(part(Part::kLaws));
  std::vector<CheckResult> laws = std::move(result.checks);
  result.checks = std::move(witnesses.checks);
  result.digits = std::move(witnesses.digits);
  append(result.checks, std::move(laws));
  attachExact(result.checks, exact.checks);
  result.findings = findOutliers(result.name, result.checks);
  for (const std::vector<Finding>& more : {witnesses.findings, openStart(scene)})
    result.findings.insert(result.findings.end(), more.begin(), more.end());
  append(result.checks, std::move(tables.checks));
  for (const std::vector<Finding>& more : {findReadingFaults(result.name, result.checks),
                                           findTableDisputes(result.name, result.checks)})
    result.findings.insert(result.findings.end(), more.begin(), more.end());
  result.controls = joinedControls({witnesses.controls, exact.controls, tables.controls});
  result.motions = std::move(tables.motions);
  for (const PublishedMotion& motion : result.motions) result.checks.push_back(checkMotion(motion));
  if (result.drift) {
    result.checks.push_back(checkDrift(scene, *result.drift));
    const bool moves = !result.drift->paths.empty();
    eraseLostPaths(*result.drift);
    if (moves && result.drift->paths.empty()) result.drift.reset();
  }
  return result;
}

}  // namespace

SceneResult crosscheckScene(const PreparedScene& scene, const std::vector<WitnessKind>& kinds,
                            const Options& options) {
  requireMotion(scene.scene());
  std::vector<SceneResult> parts;
  scene::Work work("", kParts);
  for (int part = 0; part < kParts; ++part, work.done())
    parts.push_back(crosscheckPart(scene, kinds, options, part));
  return assembled(scene, std::move(parts));
}

std::vector<SceneResult> crosscheckScenes(const std::vector<scene::Scene>& scenes,
                                          const std::vector<WitnessKind>& kinds,
                                          const Options& options, int processes,
                                          const std::function<void(int)>& done) {
  const int count = static_cast<int>(scenes.size());
  std::vector<SceneResult> results;
  for (const scene::Scene& scene : scenes) planFor(scene, options);  // refuses before the work
  const bool by_scene = count >= processes;
  scene::Work work("", by_scene ? count : count * kParts, count);
  if (by_scene) {
    for (const std::string& bytes : inProcesses(
             processes, count,
             [&](int i) { return archived(crosscheckScene(scenes[i], kinds, options)); },
             [&](int i) {
               work.done();
               if (done) done(i);
             }))
      results.push_back(sceneResultOf(bytes));
    return results;
  }
  for (const scene::Scene& scene : scenes) requireMotion(scene);
  // each process prepares what its parts ask for
  const std::vector<PreparedScene> prepared(scenes.begin(), scenes.end());
  std::vector<int> parts_done(count, 0);
  const std::vector<std::string> bytes = inProcesses(
      processes, count * kParts,
      [&](int i) {
        return archived(crosscheckPart(prepared[i / kParts], kinds, options, i % kParts));
      },
      [&](int i) {
        work.done();
        if (++parts_done[i / kParts] == kParts && done) done(i / kParts);
      });
  for (int i = 0; i < count; ++i) {
    std::vector<SceneResult> parts;
    for (int part = 0; part < kParts; ++part)
      parts.push_back(sceneResultOf(bytes[i * kParts + part]));
    results.push_back(assembled(prepared[i], std::move(parts)));
  }
  return results;
}

}  // namespace dynwitness::crosscheck
