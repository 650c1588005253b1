// SPDX-License-Identifier: GPL-3.0-or-later
// How hypotheses are collected, and the families that they come in: hypotheses_of_FAMILY.cpp, which
// alone include this, with hypotheses.cpp, where their order stands.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "crosscheck/diagnosis/hypotheses.hpp"

namespace dynwitness::crosscheck {

/// Collects hypotheses.
class HypothesisList {
 public:
  using Edit = std::function<void(TextbookLink&)>;
  using Applies = std::function<bool(const TextbookLink&)>;

  explicit HypothesisList(const TextbookModel& model) : model_(model) {}

  void add(const std::string& rule, const std::string& sentence,
           std::function<void(Belief&)> apply);
  /// @param sentence  {} stands for "link 'arm'" or "joint 'elbow'"
  void at(const std::string& rule, std::size_t i, bool at_joint, const std::string& sentence,
          std::function<void(Belief&)> apply);
  /// One a link to which it applies, and all of them together.
  void each(
      const std::string& rule, bool at_joint, const Applies& applies, const std::string& sentence,
      const Edit& edit, const std::function<void(Formulas&)>& formula = [](Formulas&) {});
  void formula(const std::string& rule, const std::string& sentence,
               const std::function<void(Formulas&)>& edit);
  const TextbookModel& model() const { return model_; }
  std::vector<Hypothesis> take() { return std::move(out_); }

 private:
  const TextbookModel& model_;
  std::vector<Hypothesis> out_;
};

// forces: of gravity, of joints and their rotors, of wrenches, and what joints pass on
void addGravity(HypothesisList& list);
void addJointForces(HypothesisList& list);
void addWrenches(HypothesisList& list);
void addReactions(HypothesisList& list);

// formulas: terms of the equations of motion, sine and cosine, and what is kept between questions
void addFormulas(HypothesisList& list);
void addSeries(HypothesisList& list);
void addStale(HypothesisList& list);

// inertias
void addInertias(HypothesisList& list);
void addCentresOfMass(HypothesisList& list);

// placements of links and joints
void addPlacementTurns(HypothesisList& list);
void addFixedChildren(HypothesisList& list);
void addDenavitHartenberg(HypothesisList& list);
void addDegrees(HypothesisList& list);

// joints: their order, signs, axes and kinds, and turns in space
void addJointOrders(HypothesisList& list);
void addJointSigns(HypothesisList& list);
void addJointAxes(HypothesisList& list);
void addFreeTurns(HypothesisList& list);

}  // namespace dynwitness::crosscheck
