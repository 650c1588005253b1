// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/conductor/describe.hpp"

#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "symbolic/derivation.hpp"

namespace dynwitness::crosscheck {
namespace {

/// "shoulder (revolute)"
std::string jointLabel(const scene::Link& link) {
  if (link.parent < 0) return "";
  const std::string follows = link.joint.mimic ? ", follows " + link.joint.mimic->joint : "";
  return link.joint.name + follows + " (" + scene::name(link.joint.kind) + ")";
}

}  // namespace

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
  if (ConstrainedQuantities::isConstrained(scene.mechanism))
    result.not_modelled.emplace_back(
        "M, c, g, tau, qdd, reactions, their digits and the laws are those of the tree that the "
        "joints make, all of them free; what is called the mechanism's is of the whole: closures, "
        "springs between points, drives and acceleration constraints together");
  for (const std::string& sentence : refusals(scene, Command::kDrift))
    if (options.drift) result.not_modelled.push_back("energy along a motion: " + sentence);
  for (const scene::Link& link : scene.mechanism.links) {
    result.link_names.push_back(link.name);
    result.joint_labels.push_back(jointLabel(link));
    result.parents.push_back(link.parent);
  }
}

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

}  // namespace dynwitness::crosscheck
