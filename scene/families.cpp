// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/families.hpp"

#include <algorithm>
#include <cctype>

namespace dynwitness::scene {
namespace {

Number decimal(const char* text) {
  return Expression::parse(text);
}

constexpr int kValidated = 8;

void startAtRest(Scene& scene) {
  scene.start_q = scene.mechanism.restPosition();
  scene.start_qd.assign(static_cast<std::size_t>(scene.mechanism.dof()), Number(0));
}

/** All links are copies of two, whose numbers they share: a million take no more numbers than two,
    and no more validation than the first few, which have every placement that occurs and a tip. */
Scene familyOf(const std::string& name, const std::string& title, int links, int (*parentOf)(int),
               bool planar = false) {
  Scene scene;
  scene.name = name;
  scene.title = title;
  scene.source = "figures chosen here";
  scene.file = name;
  Mechanism& m = scene.mechanism;
  m.has_gravity = true;
  m.gravity = {decimal("0"), decimal("0"), decimal("-9.81")};
  Link root;
  root.name = "base";
  m.links.reserve(static_cast<std::size_t>(links) + 1);
  m.links.push_back(root);
  Link model;
  model.joint.kind = JointKind::kRevolute;
  model.inertia.mass = decimal("1");
  model.inertia.com = {decimal("0.05"), decimal("0.01"), decimal("-0.02")};
  model.inertia.xx = decimal("0.002");
  model.inertia.yy = decimal("0.003");
  model.inertia.zz = decimal("0.0025");
  model.inertia.xy = decimal("0.0002");
  model.inertia.xz = decimal("-0.0001");
  model.inertia.yz = decimal("0.0003");
  Link turned[2] = {model, model};
  const Number end = decimal("0.1"), quarter[2] = {decimal("pi/2"), decimal("-pi/2")};
  for (int k = 0; k < 2; ++k) turned[k].joint.placement.rpy[0] = quarter[k];
  for (int k = 0; k < links; ++k) {
    Link link = planar && k > 0 ? model : turned[k % 2];  // the plane is upright
    link.name = "link" + std::to_string(k + 1);
    link.joint.name = "joint" + std::to_string(k + 1);
    link.parent = k == 0 ? 0 : parentOf(k) + 1;
    if (k > 0) link.joint.placement.xyz[0] = end;
    m.links.push_back(std::move(link));
    if (k + 1 == std::min(links, kValidated)) {
      startAtRest(scene);
      validate(scene);
    }
  }
  startAtRest(scene);
  return scene;
}

}  // namespace

Scene chainOf(int links) {
  const std::string n = std::to_string(links);
  return familyOf("chain_" + n, "Chain of " + n + " links", links, [](int k) { return k - 1; });
}

Scene flatChainOf(int links) {
  const std::string n = std::to_string(links);
  return familyOf(
      "flat_chain_" + n, "Flat chain of " + n + " links", links, [](int k) { return k - 1; }, true);
}

Scene treeOf(int links) {
  const std::string n = std::to_string(links);
  return familyOf("tree_" + n, "Binary tree of " + n + " links", links,
                  [](int k) { return (k - 1) / 2; });
}

bool findFamily(const std::string& name, Scene* scene) {
  for (const char* prefix : {"chain_", "flat_chain_", "tree_"}) {
    const std::string start = prefix;
    if (name.compare(0, start.size(), start) != 0) continue;
    const std::string digits = name.substr(start.size());
    if (digits.empty() || digits.size() > 7 || digits[0] == '0' ||
        !std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c); }))
      return false;
    const int links = std::stoi(digits);
    if (links > kMostFamilyLinks) return false;
    *scene = start == "chain_"  ? chainOf(links)
             : start == "tree_" ? treeOf(links)
                                : flatChainOf(links);
    return true;
  }
  return false;
}

}  // namespace dynwitness::scene
