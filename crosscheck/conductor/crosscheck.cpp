// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/conductor/crosscheck.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "crosscheck/conductor/archive.hpp"
#include "crosscheck/conductor/ask_witnesses.hpp"
#include "crosscheck/conductor/exact_checks.hpp"
#include "crosscheck/conductor/plan.hpp"
#include "crosscheck/exact/control_in_field.hpp"
#include "crosscheck/exact/exact.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/drift.hpp"
#include "crosscheck/studies/closure_gap.hpp"
#include "crosscheck/system/processes.hpp"
#include "crosscheck/verdicts/check_drift.hpp"
#include "crosscheck/verdicts/check_identities.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/control.hpp"
#include "crosscheck/verdicts/digits.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/tables.hpp"
#include "scene/work.hpp"
#include "symbolic/derivation.hpp"

namespace dynwitness::crosscheck {
namespace {

/// What of a scene's crosscheck asks for nothing that another part finds; the longest first.
enum class Part { kWitnesses, kLaws, kExact, kTables };
constexpr int kParts = 4;

/// "shoulder (revolute)"
std::string jointLabel(const scene::Link& link) {
  if (link.parent < 0) return "";
  const std::string follows = link.joint.mimic ? ", follows " + link.joint.mimic->joint : "";
  return link.joint.name + follows + " (" + scene::name(link.joint.kind) + ")";
}

void describe(const scene::Scene& scene, const Options& options, SceneResult& result) {
  result.name = scene.name;
  result.title = scene.title;
  result.source = scene.source;
  // bundled scenes are known by their place in the project, wherever it lies
  const std::filesystem::path inside = scene.file.lexically_relative(scene::dataFolder());
  result.file = inside.empty() || *inside.begin() == ".."
                    ? scene.file.string()
                    : (std::filesystem::path("data") / inside).string();
  result.dof = scene.mechanism.dof();
  result.links = static_cast<int>(scene.mechanism.links.size());
  for (const std::string& sentence : leftOut(scene, Command::kCrosscheck))
    result.not_modelled.push_back(sentence);
  for (const std::string& sentence : refusals(scene, Command::kDrift))
    if (options.drift) result.not_modelled.push_back("energy along a motion: " + sentence);
  for (const scene::Link& link : scene.mechanism.links) {
    result.link_names.push_back(link.name);
    result.joint_labels.push_back(jointLabel(link));
    result.parents.push_back(link.parent);
  }
}

/// T, V, M, c and g as maths where they are short enough to read, and their size where they are
/// not.
Equations equationsOf(const scene::Mechanism& mechanism) {
  Equations out;
  for (const symbolic::ShownEquation& equation : symbolic::shortClosedForm(mechanism)) {
    switch (equation.of) {
      case symbolic::ShownEquation::Of::kKinetic:
        out.kinetic = equation.mathml;
        break;
      case symbolic::ShownEquation::Of::kPotential:
        out.potential = equation.mathml;
        break;
      case symbolic::ShownEquation::Of::kMotion:
        out.lines.push_back(equation.mathml);
        break;
    }
  }
  symbolic::Equations derived = symbolic::derive(mechanism);
  const symbolic::Program::Operations operations =
      symbolic::compile(derived.graph, symbolic::massCoriolisGravity(derived)).bodyOperations();
  out.summary = fmt::format("M, c and g together: {} multiplications, {} additions",
                            operations.multiplications, operations.additions);
  return out;
}

void append(std::vector<CheckResult>& all, std::vector<CheckResult> more) {
  all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

}  // namespace

DigitsFound askWitnesses(const scene::Scene& scene, const std::vector<WitnessKind>& kinds,
                         const Options& options, std::vector<CheckResult>& checks,
                         std::vector<Control>& controls) {
  Hearing hearing(scene, kinds, options);
  append(checks, hearing.dismissRefused());
  DigitsCount count(scene, options);
  ControlWitness control(scene, options);
  const auto costOf = [&](Quantity q) { return q == Quantity::kM ? scene.mechanism.dof() : 1; };
  double units = 0;
  for (const Quantity quantity : kAllQuantities) units += costOf(quantity) * options.states;
  scene::Work work("pairs of witnesses", units);
  for (const Quantity quantity : kAllQuantities) {
    const std::vector<std::string> names = hearing.answering(quantity);
    PairComparison pairs(quantity, names, options);
    PairComparison pairs_of_control(quantity, names, options, true);
    hearing.hear(quantity, [&](int index, const scene::State<double>& state,
                               const std::vector<Testimony>& said) {
      const Certified exact = count.truth(quantity, state);
      const std::string excuse = exact.is_impossible ? exact.reason : "";
      pairs.add(index, said, excuse);
      std::vector<Testimony> all = said;
      if (control.joins(quantity, index, state, exact, all)) {
        if (quantity == Quantity::kQdd) hearing.putIntoEquations(state, all);
        pairs_of_control.add(index, all, excuse);
      }
      count.add(quantity, index, state, all, exact);
      work.done(costOf(quantity));
    });
    append(checks, pairs.results());
    control.judgedInPairs(pairs_of_control.results());
  }
  DigitsFound truth = count.found();
  control.takeFrom(truth);
  controls = control.results();
  // a limit that contains a loss says so, in the pairs as well
  for (const CheckResult& lossy : truth.checks)
    for (CheckResult& pair : checks)
      if (lossy.known_loss && pair.quantity == lossy.quantity &&
          (pair.left == lossy.left || pair.right == lossy.left))
        pair.known_loss = true;
  for (const auto& [witness, remark] : hearing.remarks()) {
    Finding finding;
    finding.kind = Finding::Kind::kEngine;
    finding.scene = scene.name;
    finding.quantity = "testimony";
    finding.witness = witness;
    finding.text = fmt::format("{}: {}", scene.name, remark);
    truth.losses.push_back(finding);
  }
  return truth;
}

namespace {

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

}  // namespace

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

SceneResult crosscheckPart(const scene::Scene& scene, const std::vector<WitnessKind>& kinds,
                           const Options& asked, int part) {
  const Plan plan = planFor(scene, asked);
  Options options = asked;
  options.states = plan.states;
  SceneResult result;
  switch (static_cast<Part>(part)) {
    case Part::kWitnesses: {
      DigitsFound truth = askWitnesses(scene, kinds, options, result.checks, result.controls);
      append(result.checks, std::move(truth.checks));
      result.digits = std::move(truth.digits);
      result.findings = std::move(truth.losses);
      break;
    }
    case Part::kLaws:
      describe(scene, options, result);
      result.not_modelled.insert(result.not_modelled.end(), plan.told.begin(), plan.told.end());
      if (!plan.whole) {
        result.checks = {leftOut(plan, "laws of mechanics"),
                         leftOut(plan, "energy of a simulated motion")};
        break;
      }
      result.equations = equationsOf(scene.mechanism);
      result.checks = checkIdentities(scene, options);
      if (options.drift && refusals(scene, Command::kDrift).empty())
        result.drift = measureDrift(scene, {});
      break;
    case Part::kExact: {
      if (!plan.whole) {
        result.checks = {leftOut(plan, "exact checks")};
        break;
      }
      ExactOptions exact;
      exact.seed = options.seed;
      exact.error_probability = options.error_probability;
      exact.parameters = options.parameters;
      for (const WitnessKind& kind : kinds) exact.witnesses.push_back(kind.info.name);
      result.checks = exactChecks(scene, exact);
      result.controls = controlInField(scene, exact);
      break;
    }
    case Part::kTables:
      for (const std::filesystem::path& table : bundledTables())
        if (isAbout(table, scene)) {
          append(result.checks, compareWithTable(table, scene, kinds));
          for (Control& control : controlOfTable(table, scene))
            result.controls.push_back(std::move(control));
        }
      break;
  }
  return result;
}

/// That the start leaves closures open, if it does.
std::vector<Finding> openStart(const scene::Scene& scene) {
  const ClosureGap gap = ClosureGaps::ofStart(scene);
  if (!gap.is_open) return {};
  Finding finding;
  finding.kind = Finding::Kind::kOpenStart;
  finding.scene = scene.name;
  finding.quantity = "closures";
  finding.text =
      fmt::format("{}: the start leaves closures open, {}: more than rounding of q and qd explains",
                  scene.name, gap.text());
  return {finding};
}

/// All parts of a scene, in their order, as one result.
SceneResult assembled(const scene::Scene& scene, std::vector<SceneResult> parts) {
  const auto part = [&parts](Part p) -> SceneResult& { return parts.at(static_cast<int>(p)); };
  SceneResult result = std::move(part(Part::kLaws));
  std::vector<CheckResult> laws = std::move(result.checks);
  result.checks = std::move(part(Part::kWitnesses).checks);
  result.digits = std::move(part(Part::kWitnesses).digits);
  append(result.checks, std::move(laws));
  attachExact(result.checks, part(Part::kExact).checks);
  result.findings = findOutliers(result.name, result.checks);
  const std::vector<Finding>& losses = part(Part::kWitnesses).findings;
  result.findings.insert(result.findings.end(), losses.begin(), losses.end());
  for (const Finding& finding : openStart(scene)) result.findings.push_back(finding);
  append(result.checks, std::move(part(Part::kTables).checks));
  result.controls = joinedControls(
      {part(Part::kWitnesses).controls, part(Part::kExact).controls, part(Part::kTables).controls});
  if (result.drift) {
    result.checks.push_back(checkDrift(scene, *result.drift));
    const bool moves = !result.drift->paths.empty();
    eraseLostPaths(*result.drift);
    if (moves && result.drift->paths.empty()) result.drift.reset();
  }
  return result;
}

}  // namespace

SceneResult crosscheckScene(const scene::Scene& scene, const std::vector<WitnessKind>& kinds,
                            const Options& options) {
  requireMotion(scene);
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
  if (by_scene) {  // whole scenes: their parts share what one process keeps of a scene
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
  std::vector<int> parts_done(count, 0);
  const std::vector<std::string> bytes = inProcesses(
      processes, count * kParts,
      [&](int i) {
        return archived(crosscheckPart(scenes[i / kParts], kinds, options, i % kParts));
      },
      [&](int i) {
        work.done();
        if (++parts_done[i / kParts] == kParts && done) done(i / kParts);
      });
  for (int i = 0; i < count; ++i) {
    std::vector<SceneResult> parts;
    for (int part = 0; part < kParts; ++part)
      parts.push_back(sceneResultOf(bytes[i * kParts + part]));
    results.push_back(assembled(scenes[i], std::move(parts)));
  }
  return results;
}

}  // namespace dynwitness::crosscheck
