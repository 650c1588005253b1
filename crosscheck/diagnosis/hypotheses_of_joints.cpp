// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/diagnosis/hypothesis_list.hpp"
#include "crosscheck/diagnosis/textbook_links.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Links whose joints have one position.
std::vector<std::size_t> singleJoints(const TextbookModel& model) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < model.links.size(); ++i)
    if (hasOneRate(model.links[i])) out.push_back(i);
  return out;
}

}  // namespace

void addJointOrders(HypothesisList& list) {
  const TextbookModel& model = list.model();
  const std::vector<std::size_t> single = singleJoints(model);
  const std::size_t n = single.size();
  const auto order = [&](const std::string& sentence, const std::vector<std::size_t>& taken) {
    std::vector<int> rates(static_cast<std::size_t>(model.dof)),
        positions(static_cast<std::size_t>(model.positions));
    std::iota(rates.begin(), rates.end(), 0);
    std::iota(positions.begin(), positions.end(), 0);
    for (std::size_t k = 0; k < n; ++k) {
      const TextbookLink &here = model.links[single[k]], &there = model.links[single[taken[k]]];
      rates[static_cast<std::size_t>(here.qd)] = there.qd;
      positions[static_cast<std::size_t>(here.q)] = there.q;
    }
    list.add("joint_order", sentence, [=](Belief& b) {
      b.passing.order = rates;
      b.passing.position_order = positions;
    });
  };
  std::vector<std::size_t> same(n);
  std::iota(same.begin(), same.end(), std::size_t{0});
  if (n > 1) {
    std::vector<std::size_t> backward(same.rbegin(), same.rend()), on = same;
    if (n > 2) order("joints in the opposite order", backward);
    if (n > 2) {
      std::rotate(on.begin(), on.begin() + 1, on.end());
      order("joints counted from the second on", on);
      std::rotate(on.begin(), on.begin() + static_cast<std::ptrdiff_t>(n) - 2, on.end());
      order("joints counted from the last on", on);
    }
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = a + 1; b < n; ++b) {
        std::vector<std::size_t> swapped = same;
        std::swap(swapped[a], swapped[b]);
        order(fmt::format("joints '{}' and '{}' taken for each other", model.links[single[a]].joint,
                          model.links[single[b]].joint),
              swapped);
      }
  }
}

void addJointSigns(HypothesisList& list) {
  const TextbookModel& model = list.model();
  const std::vector<std::size_t> single = singleJoints(model);
  const auto flip = [&model](Belief& b, std::size_t i) {
    Passing& by = b.passing;
    if (by.sign.empty()) by.sign.assign(static_cast<std::size_t>(model.dof), 1.0);
    if (by.position_sign.empty())
      by.position_sign.assign(static_cast<std::size_t>(model.positions), 1.0);
    by.sign[static_cast<std::size_t>(model.links[i].qd)] *= -1;
    by.position_sign[static_cast<std::size_t>(model.links[i].q)] *= -1;
  };
  for (const std::size_t i : single)
    list.at("joint_sign", i, true, "{} moves in the opposite direction",
            [flip, i](Belief& b) { flip(b, i); });
  if (single.size() > 1)
    list.add("joint_sign", "all joints move in the opposite direction", [flip, single](Belief& b) {
      for (const std::size_t i : single) flip(b, i);
    });
  list.each("joint_sign", true, hasAxisOfOne, "axis of {} points in the opposite direction",
            [](TextbookLink& link) { link.axis = -link.axis; });
}

void addJointAxes(HypothesisList& list) {
  for (int axis = 0; axis < 3; ++axis)
    for (const int sign : {1, -1})
      list.each(
          "axis_wrong", true,
          [axis](const TextbookLink& link) {
            return hasAxisOfOne(link) && std::abs(link.axis(axis)) != 1;
          },
          fmt::format("{{}} moves about {}{} of its frame", sign < 0 ? "-" : "", "xyz"[axis]),
          [axis, sign](TextbookLink& link) { link.axis = sign * Vector3d::Unit(axis); });
  list.each("axis_wrong", true, hasAxisOfOne, "axis of {} taken in the parent's axes",
            [](TextbookLink& link) { link.axis = (link.before.R.transpose() * link.axis).eval(); });
  list.each("axis_wrong", true, hasAxisOfOne, "axis of {} turned by its placement once more",
            [](TextbookLink& link) { link.axis = (link.before.R * link.axis).eval(); });
  list.each(
      "prismatic_as_revolute", true,
      [](const TextbookLink& link) { return link.kind == scene::JointKind::kPrismatic; },
      "{}, prismatic, taken as revolute",
      [](TextbookLink& link) { link.kind = scene::JointKind::kRevolute; });
  list.each(
      "revolute_as_prismatic", true,
      [](const TextbookLink& link) { return link.kind == scene::JointKind::kRevolute; },
      "{}, revolute, taken as prismatic",
      [](TextbookLink& link) { link.kind = scene::JointKind::kPrismatic; });
  list.each(
      "pitch_ignored", true,
      [](const TextbookLink& link) { return link.kind == scene::JointKind::kHelical; },
      "{}, helical, taken as revolute", [](TextbookLink& link) { link.pitch = 0; });
}

/// Of spherical and floating joints.
void addFreeTurns(HypothesisList& list) {
  const TextbookModel& model = list.model();
  const bool turns = std::any_of(model.links.begin(), model.links.end(), [](const TextbookLink& l) {
    return l.parent >= 0 &&
           (l.kind == scene::JointKind::kSpherical || l.kind == scene::JointKind::kFloating);
  });
  if (!turns) return;
  list.add("quaternion_order", "quaternions taken as (x, y, z, w)",
           [](Belief& b) { b.passing.xyzw = true; });
  struct InWorldAxes {
    const char* what;
    bool turns, slides;
  };
  for (const InWorldAxes& which :
       {InWorldAxes{"rates", true, true}, InWorldAxes{"angular velocities", true, false},
        InWorldAxes{"velocities", false, true}})
    for (const bool forces : {true, false})
      list.add("base_twist_world",
               fmt::format("{} of spherical and floating joints taken in world axes{}", which.what,
                           forces ? ", and forces given there" : ""),
               [which, forces](Belief& b) {
                 b.passing.world_turns = which.turns;
                 b.passing.world_slides = which.slides;
                 b.passing.world_forces = forces;
               });
}

}  // namespace dynwitness::crosscheck
