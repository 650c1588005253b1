// SPDX-License-Identifier: GPL-3.0-or-later
// Reads MJCF files as scenes (scene/mjcf.md says which).
//
// What stands in the file as a decimal stays one: positions, masses, moments, angles about one axis
// or in the order roll, pitch, yaw. What has to be computed (another orientation's roll, pitch and
// yaw; the inertia of shapes; an anchor in turned axes) is formed in long double and printed with
// 18 digits, of which a double keeps 16.
//
// Its elements are read by mjcf_files (with what is included) and mjcf_elements (what one says),
// its sections by mjcf_settings, mjcf_bodies, mjcf_equality and mjcf_keyframes.
#include <algorithm>
#include <string>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>

#include "scene/arrange.hpp"
#include "scene/inertia_need.hpp"
#include "scene/mimic.hpp"
#include "scene/mjcf.hpp"
#include "scene/mjcf_bodies.hpp"
#include "scene/mjcf_elements.hpp"
#include "scene/mjcf_equality.hpp"
#include "scene/mjcf_files.hpp"
#include "scene/mjcf_keyframes.hpp"
#include "scene/mjcf_settings.hpp"
#include "scene/work.hpp"

namespace dynwitness::scene {
namespace mjcf {
namespace {

/// Remarks about all that was left out.
std::vector<std::string> told(const LeftOut& left_out, bool has_limits) {
  std::vector<std::string> lines = left_out.lines;
  std::string list;
  for (const auto& [kind, count] : left_out.elements) {
    if (kind == "keyframe") {
      if (count > 1) lines.push_back(fmt::format("{} more keyframes not modelled", count - 1));
      continue;
    }
    list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, kind);
  }
  if (!list.empty()) lines.push_back(list + " not modelled");
  if (has_limits) lines.push_back("joint limits not modelled");
  return lines;
}

Scene sceneOf(const Node& top, const std::filesystem::path& file, double elements) {
  Scene scene;
  scene.file = file;
  scene.name = file.stem().string();
  scene.source = "MJCF file " + file.filename().string();
  requireKnown(top.element, {"model"});
  requireKnown(
      top, {"compiler", "option", "size", "default", "asset", "worldbody", "visual", "statistic",
            "custom", "contact", "tendon", "actuator", "sensor", "equality", "keyframe"});
  Work work("", 2 * elements);
  scene.title = Said(top.element, kNone).text("model", scene.name);
  Mechanism& mechanism = scene.mechanism;
  mechanism.has_gravity = true;
  mechanism.gravity = {0, 0, Expression::parse("-9.81")};
  Compiler compiler;
  each(top, "compiler", [&](const Node& node) { compiler.read(node); });
  each(top, "option", [&](const Node& node) { readOption(node, &mechanism); });
  if (isZero(mechanism.gravity)) mechanism.has_gravity = false;
  if (!mechanism.has_gravity) mechanism.gravity = {};
  Defaults defaults;
  each(top, "default", [&](const Node& node) { defaults.read(node); });
  LeftOut left_out;
  for (const Node& section : top.children)
    if (isOneOf(section.element.kind(),
                {"asset", "custom", "contact", "tendon", "actuator", "sensor"}))
      left_out.elements["of <" + section.element.kind() + ">"] +=
          static_cast<int>(section.children.size());

  Bodies bodies = readBodies(top, compiler, defaults, &work, &left_out);
  Equalities equalities;
  each(top, "equality",
       [&](const Node& node) { readEquality(node, bodies, defaults, &equalities, &left_out); });
  for (NamedLink& named : bodies.links)
    if (const auto f = equalities.follows.find(named.link.joint.name);
        f != equalities.follows.end())
      named.link.joint.mimic = f->second;

  mechanism.links = arrange(bodies.links, file.string());
  std::unordered_map<std::string, int> index;
  for (const Link& link : mechanism.links) index.emplace(link.name, static_cast<int>(index.size()));
  for (Closing& c : equalities.closings) {
    if (c.closure.name.empty()) c.closure.name = std::to_string(mechanism.closures.size() + 1);
    c.closure.a.link = index.at(c.a);
    c.closure.b.link = index.at(c.b);
    mechanism.closures.push_back(c.closure);
  }
  scene.start_q = mechanism.restPosition();
  scene.start_qd.resize(static_cast<std::size_t>(mechanism.dof()));
  std::size_t slot = 0;
  for (const MovingJoint& joint : bodies.moving) {
    if (const auto start = bodies.free_starts.find(joint.name); start != bodies.free_starts.end())
      std::copy(start->second.begin(), start->second.end(),
                scene.start_q.begin() + static_cast<std::ptrdiff_t>(slot));
    slot += positionSlots(joint.kind).size();
  }
  each(top, "keyframe",
       [&](const Node& node) { readKeyframes(node, bodies, equalities, &scene, &left_out); });
  followLeaders(followers(mechanism), &scene.start_q);
  scene.not_modelled = told(left_out, bodies.has_limits);
  return scene;
}

}  // namespace
}  // namespace mjcf

bool isMjcf(const std::string& text) {
  return outermostElement(text) == "mujoco";
}

Scene readSceneMjcf(const std::string& text, const std::filesystem::path& file) {
  return readSceneMjcf(text, file, InertiaNeed::kOfEachJoint);
}

Scene readSceneMjcf(const std::string& text, const std::filesystem::path& file, InertiaNeed need) {
  mjcf::Files files;
  const mjcf::Node top = files.read(text, file);
  Scene scene = mjcf::sceneOf(top, file, files.elements());
  validate(scene, need);
  return scene;
}

}  // namespace dynwitness::scene
