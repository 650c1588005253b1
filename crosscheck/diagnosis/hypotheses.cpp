// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/hypotheses.hpp"

#include "crosscheck/diagnosis/hypothesis_list.hpp"
#include "crosscheck/diagnosis/textbook_links.hpp"

namespace dynwitness::crosscheck {

std::vector<Hypothesis> hypotheses(const TextbookModel& model) {
  HypothesisList list(model);
  addGravity(list);
  addFormulas(list);
  addJointForces(list);
  addInertias(list);
  addWrenches(list);
  addPlacementTurns(list);
  addFixedChildren(list);
  addDenavitHartenberg(list);
  addDegrees(list);
  addCentresOfMass(list);
  addJointOrders(list);
  addJointSigns(list);
  addJointAxes(list);
  addFreeTurns(list);
  addSeries(list);
  addStale(list);
  addReactions(list);
  // the other reading of these words: numbers about the centre of mass taken as if about the joint
  list.each("inertia_about_joint", false, hasParent,
            "inertia of {}, given about the centre of mass, taken as if about the joint",
            [](TextbookLink& link) { link.inertia -= toOrigin(link); });
  return list.take();
}

}  // namespace dynwitness::crosscheck
