// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "crosscheck/diagnosis/hypothesis_list.hpp"
#include "crosscheck/diagnosis/textbook_links.hpp"

namespace dynwitness::crosscheck {
namespace {

using Edit = HypothesisList::Edit;
using Applies = HypothesisList::Applies;
constexpr double kDegree = M_PI / 180;

/// A row of Denavit and Hartenberg, read by the other convention.
void readAsModified(TextbookLink& link) {
  std::vector<PlacementStep> turn_z, shift, turn_x;
  for (const PlacementStep& step : link.after_steps)
    (step.axis < 0 ? shift : step.axis == 2 ? turn_z : turn_x).push_back(step);
  const Vector3d p = composed(shift).p;
  Frame a, d;
  a.p = {p(0), 0, 0};
  d.p = {0, 0, p(2)};
  link.before = composed(turn_x) * a * composed(turn_z) * d;
  link.after = Frame();
}
void readAsStandard(TextbookLink& link) {
  std::vector<PlacementStep> turn_z, turn_x;
  Vector3d p = Vector3d::Zero();
  for (const PlacementStep& step : link.before_steps) {
    if (step.axis < 0) p += step.shift;
    if (step.axis == 2) turn_z.push_back(step);
    if (step.axis == 0) turn_x.push_back(step);
  }
  Frame shift;
  shift.p = p;
  link.before = Frame();
  link.after = composed(turn_z) * shift * composed(turn_x);
}

}  // namespace

void addPlacementTurns(HypothesisList& list) {
  const TextbookModel& model = list.model();
  list.each("rotation_transposed", false, hasParent, "rotation of {} (its placement) transposed",
            [](TextbookLink& link) { link.before.R.transposeInPlace(); });
  list.each("rotation_transposed", false, hasParent, "rotation of {} beyond its joint transposed",
            [](TextbookLink& link) { link.after.R.transposeInPlace(); });
  for (std::size_t i = 1; i < model.links.size(); ++i)
    list.at("rotation_transposed", i, false,
            "rotation of {} in its parent, with its joint's, transposed",
            [i](Belief& b) { b.formulas.turned_back = static_cast<int>(i); });
  for (std::size_t i = 1; i < model.links.size(); ++i)
    if (hasOneRate(model.links[i]) && model.links[i].kind != scene::JointKind::kPrismatic)
      list.at("rotation_transposed", i, false, "turn of the joint of {} transposed",
              [i, &model](Belief& b) {
                std::vector<double>& sign = b.passing.position_sign;
                if (sign.empty()) sign.assign(static_cast<std::size_t>(model.positions), 1.0);
                sign[static_cast<std::size_t>(model.links[i].q)] *= -1;
              });
  list.each("rotation_transposed", false, hasParent, "placement of {} inverted",
            [](TextbookLink& link) {
              link.before.R.transposeInPlace();
              link.before.p = (-link.before.R * link.before.p).eval();
            });
  list.each("rpy_order", false, hasParent, "turns of the placement of {} in the opposite order",
            [](TextbookLink& link) {
              Matrix3d R = Matrix3d::Identity();
              for (const PlacementStep& step : link.before_steps)
                if (step.axis >= 0) R = composed({step}).R * R;
              link.before.R = R;
            });
}

void addFixedChildren(HypothesisList& list) {
  const Applies fixed = [](const TextbookLink& link) {
    return link.parent >= 0 && link.kind == scene::JointKind::kFixed;
  };
  const Edit weightless = [](TextbookLink& link) {
    link.mass = 0;
    link.inertia = Matrix3d::Zero();
  };
  list.each("fixed_child_skipped", false, fixed, "{}, on a fixed joint, skipped: its mass",
            weightless);
  list.each("fixed_child_skipped", false, fixed, "{}, on a fixed joint, skipped: its placement",
            [](TextbookLink& link) { link.before = link.after = Frame(); });
  list.each("fixed_child_skipped", false, fixed,
            "{}, on a fixed joint, skipped: its mass and its placement",
            [weightless](TextbookLink& link) {
              weightless(link);
              link.before = link.after = Frame();
            });
}

void addDenavitHartenberg(HypothesisList& list) {
  const TextbookModel& model = list.model();
  // all at once is the likely way
  const bool has_dh = std::any_of(model.links.begin(), model.links.end(),
                                  [](const TextbookLink& link) { return link.is_dh; });
  const bool has_mdh = std::any_of(model.links.begin(), model.links.end(),
                                   [](const TextbookLink& link) { return link.is_mdh; });
  if (has_dh)
    list.each(
        "dh_as_modified", false, [](const TextbookLink& link) { return link.is_dh; },
        "Denavit-Hartenberg row of {} read as a modified one", readAsModified);
  if (has_mdh)
    list.each(
        "dh_as_modified", false, [](const TextbookLink& link) { return link.is_mdh; },
        "modified Denavit-Hartenberg row of {} read as a standard one", readAsStandard);
  list.each(
      "dh_as_modified", false,
      [](const TextbookLink& link) { return hasParent(link) && !isTrivial(link.after); },
      "placement of {} beyond its joint taken before the joint",
      [](TextbookLink& link) {
        link.before = link.before * link.after;
        link.after = Frame();
      });
}

void addDegrees(HypothesisList& list) {
  for (const double unit : {kDegree, 1 / kDegree}) {
    const std::string how =
        unit < 1 ? "in radians taken for degrees" : "in degrees taken for radians";
    const auto scaled = [unit](TextbookLink& link, int axis) {
      for (auto* steps : {&link.before_steps, &link.after_steps})
        for (PlacementStep& step : *steps)
          if (step.axis >= 0 && (axis < 0 || step.axis == axis)) step.angle *= unit;
      link.before = composed(link.before_steps);
      link.after = composed(link.after_steps);
    };
    const Applies turned = [](const TextbookLink& link) {
      return hasParent(link) &&
             (link.before.R != Matrix3d::Identity() || link.after.R != Matrix3d::Identity());
    };
    const auto turns_about = [](const TextbookLink& link, int axis) {
      for (const auto* steps : {&link.before_steps, &link.after_steps})
        for (const PlacementStep& step : *steps)
          if (step.axis == axis && step.angle != 0) return true;
      return false;
    };
    for (int axis = 0; axis < 3; ++axis)
      list.each(
          "angle_in_degrees", false,
          [=](const TextbookLink& link) { return hasParent(link) && turns_about(link, axis); },
          fmt::format("angle about {} of the placement of {{}} {}", "xyz"[axis], how),
          [=](TextbookLink& link) { scaled(link, axis); });
    list.each("angle_in_degrees", false, turned, "angles of the placement of {} " + how,
              [scaled](TextbookLink& link) { scaled(link, -1); });
    const auto rotation = [unit](Matrix3d& R) {
      const Eigen::AngleAxisd turn(R);
      R = Eigen::AngleAxisd(turn.angle() * unit, turn.axis()).toRotationMatrix();
    };
    list.each("angle_in_degrees", false, turned, "angle of the placement of {} " + how,
              [rotation](TextbookLink& link) { rotation(link.before.R); });
    list.each("angle_in_degrees", false, turned, "angle of the placement of {} " + how,
              [rotation](TextbookLink& link) { rotation(link.after.R); });
    list.add("angle_in_degrees", "angles of joints " + how,
             [unit](Belief& b) { b.passing.angle_unit = unit; });
  }
}

}  // namespace dynwitness::crosscheck
