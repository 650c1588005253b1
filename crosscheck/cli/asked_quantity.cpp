// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/asked_quantity.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/motion/derivative_quantities.hpp"
#include "crosscheck/motion/joint_quantities.hpp"
#include "crosscheck/motion/point_quantities.hpp"
#include "scene/error.hpp"
#include "scene/nearest_name.hpp"

namespace dynwitness::cli {

using namespace crosscheck;

std::string usualWitness(Quantity quantity) {
  if (quantity == Quantity::kM) return "composite_body";
  if (quantity == Quantity::kQdd) return "articulated_body";
  return "newton_euler";
}

std::optional<Along> alongNamed(const std::string& quantity) {
  if (quantity == kPower) return Along::kPower;
  if (quantity == kResidual) return Along::kResidual;
  return {};
}

bool hasMoreThanItsTree(const scene::Mechanism& mechanism) {
  return !mechanism.isOpenTree() || !mechanism.acceleration_constraints.empty();
}

Needs needsOf(const std::string& quantity, const scene::Mechanism& mechanism) {
  if (quantity == "reactions" && hasMoreThanItsTree(mechanism)) return Needs::kTau;
  for (const char* name :
       {"tau", "power", "residual", "reactions", "acceleration", "dtau_dq", "d2tau_dq_dq", "Y"})
    if (quantity == name) return Needs::kQdd;
  for (const char* name : {"qdd", "lambda", "nu", "tau_drive", "task_torque", "null_torque", "F",
                           "PF", "beta", "dqdd_dq", "d2qdd_dq_dq"})
    if (quantity == name) return Needs::kTau;
  return Needs::kNothing;
}

bool takesInverse(const std::string& quantity) {
  if (quantity.rfind("dqdd_", 0) == 0 || quantity.rfind("d2qdd_", 0) == 0) return true;
  for (const char* name : {"qdd", "lambda", "nu", "tau_drive", "N", "Lambda", "Jbar", "task_torque",
                           "null_torque", "M_A", "P", "PM", "F", "PF", "E", "beta"})
    if (quantity == name) return true;
  return false;
}

Command commandOf(const std::string& quantity) {
  if (alongNamed(quantity)) return Command::kEvaluateForces;
  if (quantity == "tau") return Command::kEvaluateForces;
  for (const char* name : {"qdd", "lambda", "nu", "tau_drive", "reactions"})
    if (quantity == name) return Command::kEvaluateMotion;
  for (const char* name : {"N", "Lambda", "J", "Jbar", "task_torque", "null_torque", "E", "beta"})
    if (quantity == name) return Command::kEvaluateTasks;
  if (jointQuantityNamed(quantity)) return Command::kEvaluateJoints;
  if (pointQuantityNamed(quantity)) return Command::kEvaluatePoints;
  if (derivativeQuantityNamed(quantity)) return Command::kEvaluateDerivatives;
  return Command::kEvaluateTree;
}

StateUsed usedBy(const std::vector<std::string>& quantities, const scene::Mechanism& mechanism,
                 bool finds_qdd) {
  StateUsed used{mechanism.isDriven(), finds_qdd};
  for (const std::string& quantity : quantities) {
    used.qdd = used.qdd || needsOf(quantity, mechanism) == Needs::kQdd;
    used.tau = used.tau || needsOf(quantity, mechanism) == Needs::kTau || quantity == kResidual;
  }
  return used;
}

void requireQuantity(const std::string& text) {
  std::vector<std::string> all;
  for (const Quantity quantity : kAllQuantities) all.emplace_back(name(quantity));
  for (int k = 0; k <= static_cast<int>(ConstrainedQuantity::kReactions); ++k)
    if (const std::string one = name(static_cast<ConstrainedQuantity>(k));
        std::find(all.begin(), all.end(), one) == all.end())
      all.push_back(one);
  for (const char* one : {kPower, kResidual}) all.emplace_back(one);
  for (const std::string& one : pointQuantityNames()) all.push_back(one);
  for (const std::string& one : derivativeQuantityNames()) all.push_back(one);
  for (int k = 0; k <= static_cast<int>(JointQuantity::kBeta); ++k)
    all.emplace_back(name(static_cast<JointQuantity>(k)));
  if (std::find(all.begin(), all.end(), text) != all.end()) return;
  throw scene::InputError({}, fmt::format("unknown quantity '{}'{}, allowed: {}", text,
                                          scene::didYouMean(text, all), fmt::join(all, ", ")));
}

}  // namespace dynwitness::cli
