// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mjcf_bodies.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "scene/mjcf_elements.hpp"
#include "scene/mjcf_inertia.hpp"
#include "scene/mjcf_numbers.hpp"

namespace dynwitness::scene::mjcf {
namespace {

class BodyReader {
 public:
  BodyReader(const Compiler& compiler, const Defaults& defaults, Work* work, LeftOut* left_out)
      : compiler_(compiler), defaults_(defaults), work_(work), left_out_(left_out) {}
  Bodies read(const Node& top);

 private:
  /// What a body hands on to those in it.
  struct Carrier {
    std::string link;
    Vector shift;  ///< of the link's frame from the body's
    Pose pose;     ///< of the body
    const Class* defaults;
    bool rests;
  };

  void takeNames(const Node& body);
  void readBodies(const Node& world, const Carrier& carrier);
  Carrier readBody(const Node& node, const Carrier& parent);
  Carrier readJoints(const Node& node, const Carrier& parent, const Class* defaults,
                     const std::string& name, const MassProperties& inertia, bool is_known);
  Joint readJoint(const Said& said, JointKind kind) const;

  const Compiler& compiler_;
  const Defaults& defaults_;
  Work* work_;
  LeftOut* left_out_;
  Bodies read_;
  std::set<std::string> joint_names_, body_names_;
  int bodies_ = 0, joints_ = 0;
};

Bodies BodyReader::read(const Node& top) {
  NamedLink world;
  world.link.name = "world";
  world.link.where = top.element.where();
  read_.links.push_back(world);
  read_.places["world"] = {"world", {}, {}};
  body_names_.insert("world");
  each(top, "worldbody", [&](const Node& node) { takeNames(node); });
  each(top, "worldbody", [&](const Node& node) {
    requireKnown(node.element, {});
    requireKnown(node, {"geom", "site", "camera", "light", "body"});
    readBodies(node, {"world", {}, {}, &defaults_.main(), true});
  });
  setTotalMass(compiler_, &read_.links);
  return std::move(read_);
}

std::string unusedName(std::set<std::string>* taken, const std::string& base) {
  std::string name = base;
  while (!taken->insert(name).second) name += "_";
  return name;
}

/// So that no name that is made up is one of the file's.
void BodyReader::takeNames(const Node& body) {
  for (const Node& child : body.children) {
    const std::string kind = child.element.kind(), name = child.element.optionalAttribute("name");
    if ((kind == "joint" || kind == "freejoint") && !name.empty() &&
        !joint_names_.insert(name).second)
      child.element.fail("name \"" + name + "\" is taken by another joint");
    if (kind != "body") continue;
    if (!name.empty() && !body_names_.insert(name).second)
      child.element.fail("name \"" + name + "\" is taken by another body");
    takeNames(child);
  }
}

Joint BodyReader::readJoint(const Said& said, JointKind kind) const {
  Joint joint;
  joint.kind = kind;
  const auto nothing = [&](const char* key) {
    if (said.has(key) && !isZero(said.number(key)))
      said.fail(key, fmt::format("is {} at a {} joint, which is not modelled, allowed: 0",
                                 said.text(key), said.text("type")));
  };
  if (said.has("springdamper")) {
    const std::vector<Number> values = said.numbers("springdamper", 2, 2);
    if (!isZero(values[0]) || !isZero(values[1]))
      said.fail("springdamper",
                "is not in the subset that is read, allowed: stiffness and damping");
  }
  if (kind != JointKind::kRevolute && kind != JointKind::kPrismatic) {
    for (const char* key : {"stiffness", "damping", "frictionloss", "armature"}) nothing(key);
    return joint;
  }
  const auto position = [&](const char* key) {
    const Number n = said.number(key);
    return kind == JointKind::kRevolute ? compiler_.angle(n) : n;
  };
  joint.axis = said.vector("axis", {0, 0, 1});
  joint.friction.viscous = said.number("damping");
  joint.friction.positive = joint.friction.negative = said.number("frictionloss");
  joint.rotor_inertia = said.number("armature");
  joint.stiffness = said.number("stiffness");
  if (!isZero(joint.stiffness)) joint.rest = difference(position("springref"), position("ref"));
  return joint;
}

/// In the order of the file, without recursion: bodies lie deep inside one another.
void BodyReader::readBodies(const Node& world, const Carrier& carrier) {
  std::vector<std::pair<const Node*, Carrier>> left;  // bodies, with what carries them
  const auto enter = [&](const Node& node, const Carrier& at) {
    for (const Node& child : node.children) {
      const std::string kind = child.element.kind();
      if (kind == "geom") requireKnownGeom(child.element);
      if (isOneOf(kind, {"geom", "site", "camera", "light"})) ++left_out_->elements[kind];
    }
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
      if (child->element.kind() == "body") left.emplace_back(&*child, at);
  };
  enter(world, carrier);
  while (!left.empty()) {
    const auto [node, at] = std::move(left.back());
    left.pop_back();
    enter(*node, readBody(*node, at));
  }
}

BodyReader::Carrier BodyReader::readBody(const Node& node, const Carrier& parent) {
  requireKnown(node.element,
               {"name", "childclass", "pos", "quat", "euler", "axisangle", "xyaxes", "zaxis",
                "mocap", "gravcomp"},
               {"user"});
  requireKnown(node, {"inertial", "joint", "freejoint", "geom", "site", "camera", "light", "body"});
  const Said said(node.element, kNone);
  const Class* const defaults = &defaults_.classOf(said, "childclass", *parent.defaults);
  if (!isZero(said.number("gravcomp")))
    said.fail("gravcomp",
              "is " + said.text("gravcomp") + ", a force that is not modelled, allowed: 0");
  ++bodies_;
  std::string name = said.text("name");
  if (name.empty()) name = unusedName(&body_names_, fmt::format("body_{}", bodies_));
  const bool has_joint =
      std::any_of(node.children.begin(), node.children.end(), [](const Node& child) {
        return isOneOf(child.element.kind(), {"joint", "freejoint"});
      });
  const bool rests = parent.rests && !has_joint;
  bool is_known = true;
  const MassProperties inertia =
      readInertia(node, compiler_, defaults_, *defaults, rests, &is_known);
  Carrier carrier = readJoints(node, parent, defaults, name, inertia, is_known);
  if (said.flag("mocap", false)) {
    if (!rests)
      said.fail("mocap", "is true, and it moves, allowed: a body that rests in the world");
    left_out_->lines.push_back("body " + name + ": mocap not modelled, it rests where it stands");
  }
  if (!is_known) {
    if (valueOf(compiler_.total_mass) > 0)
      said.fail(
          "settotalmass, and its mass comes from a mesh, which is not read, allowed: "
          "<inertial>");
    left_out_->lines.push_back("body " + name +
                               ": mass of meshes not modelled, it rests in the world");
  }
  read_.places[name] = {carrier.link, carrier.shift, carrier.pose};
  return carrier;
}

/// The joints of a body, in a row of links of which the last is the body.
BodyReader::Carrier BodyReader::readJoints(const Node& node, const Carrier& parent,
                                           const Class* defaults, const std::string& name,
                                           const MassProperties& inertia, bool is_known) {
  const Said body(node.element, kNone);
  const Vector pos = body.vector("pos");
  const Turn turned = turnSaid(body, compiler_);
  Carrier out{name, {}, {}, defaults, parent.rests};
  out.pose.R = parent.pose.R * turned.R;
  out.pose.p = parent.pose.p + parent.pose.R * valueOf(pos);

  struct Read {
    Element element;
    Joint joint;
    Vector anchor;  ///< in the body's frame
  };
  std::vector<Read> joints;
  int dof = 0;
  bool has_ball = false;
  Vector anchor;
  for (const Node& child : node.children) {
    const std::string kind = child.element.kind();
    if (kind != "joint" && kind != "freejoint") continue;
    const bool by_class = kind == "joint";
    if (by_class)
      requireKnownJoint(child.element);
    else
      requireKnown(child.element, {"name", "align"}, {"group"});
    const Said own(child.element, kNone);
    const Said said(child.element,
                    by_class ? defaults_.classOf(own, "class", *defaults).joint : kNone);
    if (!by_class && said.text("align", "auto") == "true")
      said.fail("align", "is true, which is not in the subset that is read, allowed: false");
    const std::string type =
        by_class ? said.word("type", "hinge", {"hinge", "slide", "ball", "free"}) : "free";
    const JointKind joint_kind = type == "hinge"   ? JointKind::kRevolute
                                 : type == "slide" ? JointKind::kPrismatic
                                 : type == "ball"  ? JointKind::kSpherical
                                                   : JointKind::kFloating;
    Read read{child.element, readJoint(said, joint_kind), anchor};
    ++joints_;
    read.joint.name = own.text("name");
    if (read.joint.name.empty())
      read.joint.name = unusedName(&joint_names_, fmt::format("joint_{}", joints_));
    dof += degreesOfFreedom(joint_kind);
    if (dof > 6) said.fail("the joints of its body have more than 6 degrees of freedom");
    if (has_ball && (joint_kind == JointKind::kRevolute || joint_kind == JointKind::kSpherical))
      said.fail("turns after a ball in the same body, allowed: before it");
    has_ball = has_ball || joint_kind == JointKind::kSpherical;
    if (joint_kind == JointKind::kFloating &&
        (parent.link != read_.links.front().link.name || dof != 6 || !joints.empty()))
      said.fail("is free, allowed: the only joint of a body in <worldbody>");
    // a slide may be anchored anywhere, and a free joint is at the body's origin
    if (joint_kind == JointKind::kRevolute || joint_kind == JointKind::kSpherical)
      anchor = said.vector("pos");
    read.anchor = anchor;
    read_.has_limits = read_.has_limits || said.has("range");
    Number ref(0);
    if (joint_kind == JointKind::kRevolute)
      ref = compiler_.angle(said.number("ref"));
    else if (joint_kind == JointKind::kPrismatic)
      ref = said.number("ref");
    if (!isZero(ref))
      left_out_->lines.push_back(fmt::format(
          "joint {}: ref {} not modelled: q is MuJoCo's less that", read.joint.name, ref.text()));
    read_.moving_index.emplace(read.joint.name, read_.moving.size());
    read_.moving.push_back({read.joint.name, joint_kind, ref});
    joints.push_back(read);
  }

  const auto add = [&](const std::string& link_name, const std::string& carried_by, Joint joint,
                       const Vector& shift, bool is_last, const SourceLocation& where) {
    NamedLink named;
    named.link.name = link_name;
    named.link.where = where;
    named.link.joint = std::move(joint);
    named.parent = carried_by;
    named.parent_where = where;
    if (is_last) {
      named.link.inertia = inertia;
      named.link.inertia.com = difference(inertia.com, shift);
      if (!is_known) named.link.inertia = {};
    }
    read_.links.push_back(std::move(named));
    work_->done();
  };
  const Vector from_parent = difference(pos, parent.shift);
  const SourceLocation where = node.element.where();
  if (joints.empty()) {
    Joint fixed;
    fixed.name = name;
    while (joint_names_.count(fixed.name) > 0) fixed.name += "_fixed";
    joint_names_.insert(fixed.name);
    fixed.placement.xyz = from_parent;
    fixed.placement.rpy = turned.rpy;
    add(name, parent.link, fixed, {}, true, where);
    return out;
  }
  out.rests = false;
  if (joints[0].joint.kind == JointKind::kFloating) {
    std::vector<Number> start(pos.begin(), pos.end());
    if (body.has("quat")) {
      for (const Number& n : body.numbers("quat", 4, 4)) start.push_back(n);
    } else {
      const Eigen::Quaternion<Real> q(turned.R);
      for (const Real x : {q.w(), q.x(), q.y(), q.z()}) start.push_back(printed(x, 1, where));
    }
    read_.free_starts[joints[0].joint.name] = start;
    add(name, parent.link, joints[0].joint, {}, true, where);
    return out;
  }
  std::string carried_by = parent.link;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    Read& read = joints[k];
    Placement& placement = read.joint.placement;
    if (k > 0) {
      placement.xyz = difference(read.anchor, joints[k - 1].anchor);
    } else {
      placement.rpy = turned.rpy;
      placement.xyz = from_parent;
      if (!isZero(read.anchor)) {
        const Vector3 moved = turned.R * valueOf(read.anchor), p = valueOf(from_parent) + moved;
        if (turned.isNone()) {
          for (std::size_t j = 0; j < 3; ++j)
            placement.xyz[j] = difference(from_parent[j], negative(read.anchor[j]));
        } else {
          placement.xyz = printed(p, valueOf(from_parent).norm() + moved.norm(), where);
        }
      }
    }
    const bool is_last = k + 1 == joints.size();
    const std::string link = is_last ? name : name + "." + read.joint.name;
    add(link, carried_by, read.joint, read.anchor, is_last, is_last ? where : read.element.where());
    carried_by = link;
  }
  out.shift = joints.back().anchor;
  return out;
}

}  // namespace

Bodies readBodies(const Node& top, const Compiler& compiler, const Defaults& defaults, Work* work,
                  LeftOut* left_out) {
  return BodyReader(compiler, defaults, work, left_out).read(top);
}

}  // namespace dynwitness::scene::mjcf
