// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/crosscheck.hpp"

#include "crosscheck/drift.hpp"
#include "crosscheck/tables.hpp"

namespace dynwitness::crosscheck {
namespace {

/// "shoulder (revolute)"
std::string jointLabel(const scene::Link& link) {
  if (link.parent < 0) return "";
  return link.joint.name + " (" + scene::name(link.joint.kind) + ")";
}

void describe(const scene::Scene& scene, SceneResult& result) {
  result.name = scene.name;
  result.title = scene.title;
  result.source = scene.source;
  result.file = scene.file.string();
  result.dof = scene.mechanism.dof();
  result.links = static_cast<int>(scene.mechanism.links.size());
  result.not_modelled = scene.not_modelled;
  for (const scene::Link& link : scene.mechanism.links) {
    result.link_names.push_back(link.name);
    result.joint_labels.push_back(jointLabel(link));
    result.parents.push_back(link.parent);
  }
}

void append(std::vector<CheckResult>& all, std::vector<CheckResult> more) {
  all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

}  // namespace

SceneResult crosscheckScene(const scene::Scene& scene, const std::vector<WitnessKind>& kinds,
                            const Options& options) {
  SceneResult result;
  describe(scene, result);
  append(result.checks, compareWitnesses(scene, kinds, options));
  result.findings = findOutliers(scene.name, result.checks);
  append(result.checks, checkIdentities(scene, options));
  for (const std::filesystem::path& table : bundledTables())
    if (isAbout(table, scene)) append(result.checks, compareWithTable(table, scene, kinds));
  if (options.drift && conservesEnergy(scene.mechanism)) {
    result.drift = measureDrift(scene, {});
    result.checks.push_back(checkDrift(*result.drift));
  }
  return result;
}

}  // namespace dynwitness::crosscheck
