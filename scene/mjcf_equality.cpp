// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mjcf_equality.hpp"

#include <Eigen/Core>

#include "scene/mjcf_elements.hpp"
#include "scene/mjcf_numbers.hpp"

namespace dynwitness::scene::mjcf {
namespace {

Closing readClosure(const Said& said, const Bodies& bodies, bool is_weld) {
  Closing out;
  out.closure.where = said.where();
  out.closure.kind = is_weld ? ClosureKind::kWeld : ClosureKind::kPoint;
  out.closure.name = said.text("name");
  const auto place = [&](const char* key) -> const Place& {
    const std::string name = said.text(key, "world");
    const auto found = bodies.places.find(name);
    if (found == bodies.places.end())
      said.fail(key, "is \"" + name + "\", allowed: the name of a body");
    return found->second;
  };
  if (!said.has("body1")) said.fail("has no body1");
  const Place &a = place("body1"), &b = place("body2");
  out.a = a.link;
  out.b = b.link;
  const SourceLocation where = said.where();
  Attachment &at_a = out.closure.a, &at_b = out.closure.b;
  const auto seenFrom = [&](const Place& place, const Vector3& world) {
    const Vector3 d = world - place.pose.p;
    return difference(
        printed(Vector3(place.pose.R.transpose() * d), world.norm() + place.pose.p.norm(), where),
        place.shift);
  };
  const Vector anchor = said.vector("anchor");
  if (!is_weld) {
    if (!said.has("anchor")) said.fail("has no anchor");
    at_a.xyz = difference(anchor, a.shift);
    at_b.xyz = seenFrom(b, a.pose.p + a.pose.R * valueOf(anchor));
    return out;
  }
  // the frame of body2, moved to the anchor, is held to one of body1: the relative pose that is
  // given, or that of the reference
  at_b.xyz = difference(anchor, b.shift);
  std::vector<Number> pose = {0, 1, 0, 0, 0, 0, 0};
  if (said.has("relpose")) pose = said.numbers("relpose", 7, 7);
  const Vector3 v(valueOf(pose[4]), valueOf(pose[5]), valueOf(pose[6]));
  if (isZero(pose[3]) && v.isZero(0)) {
    at_a.xyz = seenFrom(a, b.pose.p + b.pose.R * valueOf(anchor));
    at_a.rpy = rollPitchYaw(a.pose.R.transpose() * b.pose.R, where);
  } else {
    at_a.xyz = difference({pose[0], pose[1], pose[2]}, a.shift);
    at_a.rpy = rollPitchYaw(turnOf(valueOf(pose[3]), v), where);
  }
  return out;
}

void readMimic(const Said& said, const Bodies& bodies,
               std::unordered_map<std::string, Mimic>* follows) {
  const auto joint = [&](const char* key) -> const MovingJoint& {
    const std::string name = said.text(key);
    const auto place = bodies.moving_index.find(name);
    if (place == bodies.moving_index.end())
      said.fail(key, "is \"" + name + "\", allowed: the name of a joint");
    const MovingJoint* const found = &bodies.moving[place->second];
    if (found->kind != JointKind::kRevolute && found->kind != JointKind::kPrismatic)
      said.fail(key, "is \"" + name + "\", allowed: a hinge or a slide");
    return *found;
  };
  if (!said.has("joint1")) said.fail("has no joint1");
  if (!said.has("joint2"))
    said.fail(
        "has no joint2: a joint that is held is not in the subset that is read, allowed: two "
        "joints");
  const MovingJoint &follower = joint("joint1"), &leader = joint("joint2");
  std::vector<Number> c = {0, 1, 0, 0, 0};
  if (said.has("polycoef")) c = said.numbers("polycoef", 5, 5);
  if (isZero(c[1]) || !isZero(c[2]) || !isZero(c[3]) || !isZero(c[4]))
    said.fail("polycoef", "is " + said.text("polycoef") +
                              ", allowed: a straight line that rises or falls, A B 0 0 0");
  Mimic mimic{leader.name, c[1], c[0]};
  if (follower.kind == JointKind::kRevolute) mimic.offset = angleOf(mimic.offset);
  if (!follows->emplace(follower.name, mimic).second)
    said.fail("joint1", "is \"" + follower.name + "\", which follows another one already");
}

}  // namespace

void readEquality(const Node& node, const Bodies& bodies, const Defaults& defaults, Equalities* out,
                  LeftOut* left_out) {
  requireKnown(node, {"connect", "weld", "joint", "tendon"});
  for (const Node& child : node.children) {
    const std::string kind = child.element.kind();
    const Said own(child.element, kNone);
    const Said said(child.element, defaults.classOf(own, "class", defaults.main()).equality);
    if (kind == "tendon") {
      ++left_out->elements["equality of tendons"];
      continue;
    }
    if (kind == "joint")
      requireKnown(child.element, {"name", "class", "active", "joint1", "joint2", "polycoef"},
                   {"solref", "solimp"});
    else if (kind == "connect")
      requireKnown(child.element, {"name", "class", "active", "body1", "body2", "anchor"},
                   {"solref", "solimp"});
    else
      requireKnown(child.element,
                   {"name", "class", "active", "body1", "body2", "anchor", "relpose"},
                   {"solref", "solimp", "torquescale"});
    if (!said.flag("active", true)) {
      ++left_out->elements["equality that is not active"];
      continue;
    }
    if (kind == "joint")
      readMimic(said, bodies, &out->follows);
    else
      out->closings.push_back(readClosure(said, bodies, kind == "weld"));
  }
}

}  // namespace dynwitness::scene::mjcf
