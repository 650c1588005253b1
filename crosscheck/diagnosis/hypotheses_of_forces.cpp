// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <functional>

#include <fmt/format.h>

#include "crosscheck/diagnosis/hypothesis_list.hpp"

namespace dynwitness::crosscheck {
namespace {

using Applies = HypothesisList::Applies;

}  // namespace

void addGravity(HypothesisList& list) {
  list.add("gravity_sign", "gravity with the opposite sign",
           [](Belief& b) { b.model.gravity = -b.model.gravity; });
  list.add("gravity_missing", "gravity left out",
           [](Belief& b) { b.model.gravity = Vector3d::Zero(); });
  list.add("gravity_twice", "gravity counted twice", [](Belief& b) { b.model.gravity *= 2; });
  const double size = list.model().gravity.norm();
  for (int axis = 0; axis < 3; ++axis)
    for (const int sign : {-1, 1}) {
      const Vector3d other = sign * size * Vector3d::Unit(axis);
      if (size == 0 || other == list.model().gravity || other == -list.model().gravity) continue;
      list.add("gravity_frame",
               fmt::format("gravity along {}{} of the world", sign < 0 ? "-" : "+", "xyz"[axis]),
               [other](Belief& b) { b.model.gravity = other; });
    }
  std::array<int, 3> order = {0, 1, 2};
  while (std::next_permutation(order.begin(), order.end())) {
    const Vector3d& g = list.model().gravity;
    const Vector3d other(g(order[0]), g(order[1]), g(order[2]));
    list.add("gravity_frame",
             fmt::format("coordinates of gravity in the order {}{}{}", "xyz"[order[0]],
                         "xyz"[order[1]], "xyz"[order[2]]),
             [other](Belief& b) { b.model.gravity = other; });
  }
  list.formula("gravity_frame", "gravity in the world's axes taken as if in the axes of each link",
               [](Formulas& f) { f.gravity_not_turned = true; });
  for (std::size_t i = 0; i < list.model().links.size(); ++i)
    if (list.model().links[i].kind == scene::JointKind::kFloating)
      list.formula("gravity_frame",
                   fmt::format("gravity in the world's axes taken as if in those of link '{}'",
                               list.model().links[i].name),
                   [i](Formulas& f) { f.gravity_turns_with = static_cast<int>(i); });
  for (const bool twice : {true, false})
    list.formula("gravity_in_c",
                 twice ? "gravity included in c (and once more in tau)" : "gravity included in c",
                 [twice](Formulas& f) {
                   f.gravity_in_c = true;
                   f.g_twice_in_tau = twice;
                 });
}

void addJointForces(HypothesisList& list) {
  const Applies has_rotor = [](const TextbookLink& link) { return link.added != 0; };
  list.each("rotor_missing", true, has_rotor, "rotor of {} missing",
            [](TextbookLink& link) { link.added = link.rotor = link.spin = 0; });
  list.each("rotor_doubled", true, has_rotor, "rotor of {} counted twice", [](TextbookLink& link) {
    link.added *= 2;
    link.spin *= 2;
  });
  list.each("rotor_ratio_not_squared", true, has_rotor, "gear ratio of {} not squared",
            [](TextbookLink& link) { link.added = link.gear * link.rotor; });
  list.each("rotor_ratio_not_squared", true, has_rotor, "gear ratio of {} left out",
            [](TextbookLink& link) { link.added = link.rotor; });
  list.each("rotor_sign", true, has_rotor, "rotor of {} with the opposite sign",
            [](TextbookLink& link) { link.added = -link.added; });
  const Applies spins = [](const TextbookLink& link) { return link.spin != 0; };
  list.each("rotor_sign", true, spins, "gyroscopic rotor of {} spins the other way",
            [](TextbookLink& link) { link.spin = -link.spin; });
  list.each("gyroscopic_missing", true, spins,
            "rotor of {} without what its spin does to its parent",
            [](TextbookLink& link) { link.spin = 0; });
  const Applies damped = [](const TextbookLink& link) { return link.viscous != 0; };
  const Applies rubs = [](const TextbookLink& link) {
    return link.viscous != 0 || link.coulomb[0] != 0 || link.coulomb[1] != 0;
  };
  const Applies coulomb = [](const TextbookLink& link) {
    return link.coulomb[0] != 0 || link.coulomb[1] != 0;
  };
  list.each("damping_sign", true, damped, "damping of {} with the opposite sign",
            [](TextbookLink& link) { link.viscous = -link.viscous; });
  list.each("damping_sign", true, rubs, "friction of {} with the opposite sign",
            [](TextbookLink& link) {
              link.viscous = -link.viscous;
              for (double& x : link.coulomb) x = -x;
            });
  list.each("damping_missing", true, damped, "damping of {} left out",
            [](TextbookLink& link) { link.viscous = 0; });
  list.each("friction_missing", true, rubs, "friction of {} left out",
            [](TextbookLink& link) { link.viscous = link.coulomb[0] = link.coulomb[1] = 0; });
  list.each("friction_missing", true, coulomb, "Coulomb friction of {} left out",
            [](TextbookLink& link) { link.coulomb[0] = link.coulomb[1] = 0; });
  list.each(
      "spring_missing", true, [](const TextbookLink& link) { return link.stiffness != 0; },
      "spring of {} left out", [](TextbookLink& link) { link.stiffness = 0; });
  list.each(
      "spring_sign", true, [](const TextbookLink& link) { return link.stiffness != 0; },
      "spring of {} with the opposite sign",
      [](TextbookLink& link) { link.stiffness = -link.stiffness; });
}

void addWrenches(HypothesisList& list) {
  if (list.model().wrenches.empty()) return;
  list.add("wrench_missing", "wrenches left out", [](Belief& b) { b.model.wrenches.clear(); });
  const auto each = [&](const std::string& rule, const std::string& sentence,
                        const std::function<void(TextbookWrench&)>& edit) {
    list.add(rule, sentence, [edit](Belief& b) {
      for (TextbookWrench& wrench : b.model.wrenches) edit(wrench);
    });
  };
  each("wrench_sign", "wrenches with the opposite sign", [](TextbookWrench& w) {
    w.force = -w.force;
    w.moment = -w.moment;
  });
  each("wrench_frame", "wrenches in link axes taken in world axes",
       [](TextbookWrench& w) { w.in_world = true; });
  each("wrench_frame", "wrenches in world axes taken in link axes",
       [](TextbookWrench& w) { w.in_world = false; });
  each("wrench_point", "forces of wrenches taken at the link's origin",
       [](TextbookWrench& w) { w.at = Vector3d::Zero(); });
}

/// How reactions are told.
void addReactions(HypothesisList& list) {
  list.formula("reaction_sign", "reactions that the link exerts on its parent",
               [](Formulas& f) { f.reaction_on_parent = true; });
  list.formula("reaction_order", "reactions with the moment first",
               [](Formulas& f) { f.moment_first = true; });
  struct About {
    const char* words;
    Formulas::About point;
  };
  struct In {
    const char* words;
    Formulas::Axes axes;
  };
  for (const About& about : {About{"", Formulas::About::kJoint},
                             About{" about the link's origin", Formulas::About::kLink},
                             About{" about the link's centre of mass", Formulas::About::kCom}})
    for (const In& in : {In{"", Formulas::Axes::kJoint}, In{" in link axes", Formulas::Axes::kLink},
                         In{" in world axes", Formulas::Axes::kWorld}}) {
      if (*about.words == '\0' && *in.words == '\0') continue;
      list.formula("reaction_frame", fmt::format("reactions{}{}", about.words, in.words),
                   [point = about.point, axes = in.axes](Formulas& f) {
                     f.reaction_about = point;
                     f.reaction_axes = axes;
                   });
    }
}

}  // namespace dynwitness::crosscheck
