// SPDX-License-Identifier: GPL-3.0-or-later
// sdformat as a reader of robot descriptions: what Gazebo makes of a URDF. The user's bytes, no
// option set: links that are fixed to others are lumped by it. It simulates nothing.
#include <iostream>
#include <map>
#include <sstream>

#include <sdf/sdf.hh>

#include "crosscheck/readers/one_line.hpp"
#include "crosscheck/readers/programs/shown.hpp"
#include "data/engines/dynwitness_engine.hpp"

namespace {

using namespace dynwitness_engine;
using dynwitness::programs::shown;
using nlohmann::json;

Eigen::Vector3d vector(const ignition::math::Vector3d& v) {
  return {v.X(), v.Y(), v.Z()};
}
Eigen::Isometry3d frame(const ignition::math::Pose3d& pose) {
  const ignition::math::Quaterniond& q = pose.Rot();
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = Eigen::Quaterniond(q.W(), q.X(), q.Y(), q.Z()).normalized().toRotationMatrix();
  X.translation() = vector(pose.Pos());
  return X;
}

/// One line of 300 characters at the most.
std::string firstWords(const std::string& text) {
  constexpr std::size_t kMost = 300;
  std::string out = dynwitness::inOneLine(text);
  const std::size_t end = out.find_last_not_of(' ');
  out.resize(end == std::string::npos ? 0 : end + 1);
  return out.size() > kMost ? out.substr(0, kMost) + "..." : out;
}

void require(const sdf::Errors& errors) {
  if (!errors.empty()) throw std::runtime_error(errors.front().Message());
}

Eigen::Isometry3d resolved(const sdf::SemanticPose& pose, const std::string& seen_from) {
  ignition::math::Pose3d out;
  require(pose.Resolve(out, seen_from));
  return frame(out);
}

json massOf(const sdf::Link& link) {
  const ignition::math::Inertiald& inertial = link.Inertial();
  const ignition::math::Matrix3d I = inertial.Moi();  // in the link's axes
  Eigen::Matrix3d about_com;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) about_com(i, j) = I(i, j);
  return {{"mass", inertial.MassMatrix().Mass()},
          {"com", shown(vector(inertial.Pose().Pos()))},
          {"inertia", shown(about_com)}};
}

/// The joint stands where it is seen from the child, which at q = 0 is where it is.
json jointOf(const sdf::Joint& joint, const sdf::Model& model) {
  const Eigen::Isometry3d in_child = resolved(joint.SemanticPose(), joint.ChildLinkName());
  Eigen::Isometry3d in_parent = resolved(joint.SemanticPose(), "__model__");
  if (const sdf::Link* parent = model.LinkByName(joint.ParentLinkName()))
    in_parent = resolved(parent->SemanticPose(), "__model__").inverse() * in_parent;
  json said = {{"name", joint.Name()},
               {"kind", "fixed"},
               {"before", shown(in_parent)},
               {"after", shown(Eigen::Isometry3d(in_child.inverse()))}};
  using Type = sdf::JointType;
  const Type type = joint.Type();
  if (type == Type::FIXED) return said;
  const sdf::JointAxis* axis = joint.Axis();
  const bool turns = type == Type::REVOLUTE || type == Type::CONTINUOUS;
  if ((!turns && type != Type::PRISMATIC) || !axis) {
    said["kind"] = type == Type::BALL        ? "spherical"
                   : type == Type::UNIVERSAL ? "universal"
                                             : "floating";
    return said;
  }
  said["kind"] = turns ? "revolute" : "prismatic";
  ignition::math::Vector3d xyz;
  require(axis->ResolveXyz(xyz, joint.Name()));
  said["axis"] = shown(vector(xyz));
  said["viscous"] = axis->Damping();
  said["coulomb"] = axis->Friction();
  said["stiffness"] = axis->SpringStiffness();
  constexpr double kUnlimited = 1e16;  // SDFormat's word for it
  if (type != Type::CONTINUOUS && axis->Lower() > -kUnlimited && axis->Upper() < kUnlimited) {
    said["lower"] = axis->Lower();
    said["upper"] = axis->Upper();
  }
  return said;
}

/// Links before those that hang on them.
json linksOf(const sdf::Model& model) {
  json links = json::array();
  std::map<std::string, int> places;
  std::map<std::string, const sdf::Joint*> joints;  // by child
  for (uint64_t k = 0; k < model.JointCount(); ++k)
    joints[model.JointByIndex(k)->ChildLinkName()] = model.JointByIndex(k);
  for (bool more = true; more;) {
    more = false;
    for (uint64_t k = 0; k < model.LinkCount(); ++k) {
      const sdf::Link& link = *model.LinkByIndex(k);
      if (places.count(link.Name()) == 1) continue;
      const auto joint = joints.find(link.Name());
      json one = massOf(link);
      one["name"] = link.Name();
      one["parent"] = -1;
      if (joint != joints.end()) {
        const std::string& parent = joint->second->ParentLinkName();
        const auto at = places.find(parent);
        if (at == places.end() && parent != "world") continue;
        if (at != places.end()) one["parent"] = at->second;
        one["joint"] = jointOf(*joint->second, model);
      } else {  // it may stand where it likes
        one["joint"] = {{"name", ""},
                        {"kind", "fixed"},
                        {"before", shown(resolved(link.SemanticPose(), "__model__"))}};
      }
      places[link.Name()] = static_cast<int>(links.size());
      links.push_back(one);
      more = true;
    }
  }
  return links;
}

}  // namespace

int main() {
  Engine engine("sdformat", std::to_string(SDF_MAJOR_VERSION) + "." +
                                std::to_string(SDF_MINOR_VERSION) + "." +
                                std::to_string(SDF_PATCH_VERSION));
  engine.scene = [&](const Json& scene) {
    sdf::Root root;
    std::ostringstream warnings;  // which say what it leaves out
    std::streambuf* const before = std::cerr.rdbuf(warnings.rdbuf());
    const sdf::Errors errors =
        root.LoadSdfString(dynwitness::programs::textOf(scene["file"].text()));
    std::cerr.rdbuf(before);
    const std::string warned = firstWords(warnings.str());
    const sdf::Model* model = root.Model();
    if (!errors.empty() || !model) {
      std::string why = errors.empty() ? "no model comes of it" : errors.front().Message();
      if (!model || model->LinkCount() == 0)
        why += " (it leaves out links without inertia, and what hangs on them: sdformat issue 199)";
      throw std::runtime_error(why + (warned.empty() ? "" : "; it warned: " + warned));
    }
    engine.shows = json({{"gravity", {0, 0, -9.81}},
                         {"links", linksOf(*model)},
                         {"told", warned.empty() ? json::array() : json({"it warned: " + warned})},
                         {"not_kept", json::array({"gravity"})}})
                       .dump();
  };
  return engine.testify();
}
