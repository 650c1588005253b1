// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/crosscheck.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "crosscheck/archive.hpp"
#include "crosscheck/digits/digits.hpp"
#include "crosscheck/motion/drift.hpp"
#include "crosscheck/exact/exact.hpp"
#include "crosscheck/processes.hpp"
#include "crosscheck/tables.hpp"
#include "symbolic/derivation.hpp"

namespace dynwitness::crosscheck {
namespace {

/// What of a scene's crosscheck asks for nothing that another part finds; the longest first.
enum class Part { kWitnesses, kLaws, kExact, kTables };
constexpr int kParts = 4;

/// "shoulder (revolute)"
std::string jointLabel(const scene::Link& link) {
  if (link.parent < 0) return "";
  return link.joint.name + " (" + scene::name(link.joint.kind) + ")";
}

void describe(const scene::Scene& scene, SceneResult& result) {
  result.name = scene.name;
  result.title = scene.title;
  result.source = scene.source;
  // bundled scenes are known by their place in the project, wherever it lies
  const std::filesystem::path inside = scene.file.lexically_relative(scene::dataFolder());
  result.file = inside.empty() || *inside.begin() == ".." ? scene.file.string()
                                                          : (std::filesystem::path("data") / inside).string();
  result.dof = scene.mechanism.dof();
  result.links = static_cast<int>(scene.mechanism.links.size());
  result.not_modelled = scene.not_modelled;
  if (!scene.mechanism.isOpenTree())
    result.not_modelled.push_back("closures and springs between points, in comparisons of witnesses: "
                                  "these are about the tree that the joints make");
  if (scene.mechanism.isDriven() || !scene.mechanism.acceleration_constraints.empty())
    result.not_modelled.push_back("motions of driven joints and constraints on accelerations, in comparisons of "
                                  "witnesses: all joints of these are free");
  for (const scene::Link& link : scene.mechanism.links) {
    result.link_names.push_back(link.name);
    result.joint_labels.push_back(jointLabel(link));
    result.parents.push_back(link.parent);
  }
}

/// T, V, M, c and g as maths where they are short enough to read, and their size where they are not.
Equations equationsOf(const scene::Mechanism& mechanism) {
  Equations out;
  for (const symbolic::ShownEquation& equation : symbolic::shortClosedForm(mechanism)) {
    if (equation.name == "T") out.kinetic = equation.mathml;
    else if (equation.name == "V") out.potential = equation.mathml;
    else out.lines.push_back(equation.mathml);
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

/// Pairs of witnesses (into `checks`), and each witness against the certified truth.
DigitsFound askWitnesses(const scene::Scene& scene, const std::vector<WitnessKind>& kinds,
                         const Options& options, std::vector<CheckResult>& checks) {
  Hearing hearing(scene, kinds, options);
  append(checks, hearing.dismissRefused());
  DigitsCount count(scene, options);
  for (const Quantity quantity : kAllQuantities) {
    PairComparison pairs(quantity, hearing.answering(quantity), options);
    hearing.hear(quantity, [&](int index, const scene::State<double>& state,
                               const std::vector<Testimony>& said) {
      pairs.add(index, said);
      count.add(quantity, index, state, said);
    });
    append(checks, pairs.results());
  }
  DigitsFound truth = count.found();
  // a limit that contains a loss says so, in the pairs as well
  for (const CheckResult& lossy : truth.checks)
    for (CheckResult& pair : checks)
      if (lossy.known_loss && pair.quantity == lossy.quantity &&
          (pair.left == lossy.left || pair.right == lossy.left))
        pair.known_loss = true;
  return truth;
}

/// Puts the exact verdicts beside the rounded ones of the same comparison; those without such a twin
/// become checks of their own. A residual that is not zero outweighs numbers that agree.
void attachExact(std::vector<CheckResult>& checks, const std::vector<CheckResult>& exact) {
  for (const CheckResult& verdict : exact) {
    const auto twin = std::find_if(checks.begin(), checks.end(), [&](const CheckResult& check) {
      return !check.exact && check.check == verdict.check && check.quantity == verdict.quantity &&
             check.left == verdict.left && check.right == verdict.right;
    });
    if (twin == checks.end()) {
      checks.push_back(verdict);
      continue;
    }
    twin->exact = verdict.exact;
    if (verdict.verdict == Verdict::kDisagree) {
      twin->verdict = Verdict::kDisagree;
      twin->reason = verdict.reason;
    }
  }
}

}  // namespace

void requireMotion(const scene::Scene& scene) {
  if (scene.mechanism.dof() == 0)
    throw scene::InputError({scene.file.string()}, "no joint moves, expected at least one that does");
}

namespace {

SceneResult crosscheckPart(const scene::Scene& scene, const std::vector<WitnessKind>& kinds,
                           const Options& options, int part) {
  SceneResult result;
  switch (static_cast<Part>(part)) {
    case Part::kWitnesses: {
      DigitsFound truth = askWitnesses(scene, kinds, options, result.checks);
      append(result.checks, std::move(truth.checks));
      result.digits = std::move(truth.digits);
      result.findings = std::move(truth.losses);
      break;
    }
    case Part::kLaws:
      describe(scene, result);
      result.equations = equationsOf(scene.mechanism);
      result.checks = checkIdentities(scene, options);
      if (options.drift && conservesEnergy(scene.mechanism)) result.drift = measureDrift(scene, {});
      break;
    case Part::kExact: {
      ExactOptions exact;
      exact.seed = options.seed;
      exact.error_probability = options.error_probability;
      exact.parameters = options.parameters;
      for (const WitnessKind& kind : kinds) exact.witnesses.push_back(kind.info.name);
      result.checks = exactChecks(scene, exact);
      break;
    }
    case Part::kTables:
      for (const std::filesystem::path& table : bundledTables())
        if (isAbout(table, scene)) append(result.checks, compareWithTable(table, scene, kinds));
      break;
  }
  return result;
}

/// All parts of a scene, in their order, as one result.
SceneResult assembled(std::vector<SceneResult> parts) {
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
  append(result.checks, std::move(part(Part::kTables).checks));
  if (result.drift) result.checks.push_back(checkDrift(*result.drift));
  return result;
}

}  // namespace

SceneResult crosscheckScene(const scene::Scene& scene, const std::vector<WitnessKind>& kinds,
                            const Options& options) {
  requireMotion(scene);
  std::vector<SceneResult> parts;
  for (int part = 0; part < kParts; ++part) parts.push_back(crosscheckPart(scene, kinds, options, part));
  return assembled(std::move(parts));
}

std::vector<SceneResult> crosscheckScenes(const std::vector<scene::Scene>& scenes,
                                          const std::vector<WitnessKind>& kinds,
                                          const Options& options, int processes,
                                          const std::function<void(int)>& done) {
  const int count = static_cast<int>(scenes.size());
  std::vector<SceneResult> results;
  if (count >= processes) {  // whole scenes: their parts share what one process keeps of a scene
    for (const std::string& bytes : inProcesses(
             processes, count,
             [&](int i) { return archived(crosscheckScene(scenes[i], kinds, options)); }, done))
      results.push_back(sceneResultOf(bytes));
    return results;
  }
  for (const scene::Scene& scene : scenes) requireMotion(scene);
  std::vector<int> parts_done(count, 0);
  const std::vector<std::string> bytes = inProcesses(
      processes, count * kParts,
      [&](int i) { return archived(crosscheckPart(scenes[i / kParts], kinds, options, i % kParts)); },
      [&](int i) {
        if (++parts_done[i / kParts] == kParts && done) done(i / kParts);
      });
  for (int i = 0; i < count; ++i) {
    std::vector<SceneResult> parts;
    for (int part = 0; part < kParts; ++part)
      parts.push_back(sceneResultOf(bytes[i * kParts + part]));
    results.push_back(assembled(std::move(parts)));
  }
  return results;
}

}  // namespace dynwitness::crosscheck
