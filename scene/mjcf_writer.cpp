// SPDX-License-Identifier: GPL-3.0-or-later
// Writes scenes as MJCF.
//
// A link is a body. The body's frame is the joint's at q = 0, so that positions and turns are the
// scene's own (euler in the order of roll, pitch, yaw); a Denavit-Hartenberg link's is its own,
// with the joint at its place in it. Massless links that the reader made of several joints in a
// body become that body again.
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "scene/mimic.hpp"
#include "scene/mjcf.hpp"
#include "scene/written_numbers.hpp"

namespace dynwitness::scene {
namespace {

using written::escaped;
using written::Frame;
using written::Matrix3;
using written::Numbers;
using written::Origin;
using written::Real;
using written::text;
using written::Vector3;

/// MuJoCo's own XML parser takes 500 elements inside one another; three are not bodies.
constexpr int kMostBodies = 497;

bool isMassless(const MassProperties& m, const Numbers& number) {
  const auto all = {&m.mass, &m.xx, &m.yy, &m.zz, &m.xy, &m.xz, &m.yz};
  return std::all_of(all.begin(), all.end(), [&](const Number* n) { return number(*n) == 0; });
}

/// A unit quaternion (w, x, y, z) of a rotation, from its largest component.
std::array<Real, 4> quaternionOf(const Matrix3& R) {
  const Real trace = R.trace();
  std::array<Real, 4> q;  // 4 q_k^2, then
  q[0] = 1 + trace;
  for (int k = 0; k < 3; ++k) q[static_cast<std::size_t>(k) + 1] = 1 - trace + 2 * R(k, k);
  const auto largest = static_cast<std::size_t>(std::max_element(q.begin(), q.end()) - q.begin());
  const Real twice = sqrt(q[largest]);
  const Vector3 odd(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  std::array<Real, 4> out;
  out[largest] = twice / 2;
  for (std::size_t k = 0; k < 4; ++k) {
    if (k == largest) continue;
    const auto at = [](std::size_t i) { return static_cast<Eigen::Index>(i) - 1; };
    const Real product = largest == 0 ? odd[at(k)]
                         : k == 0     ? odd[at(largest)]
                                      : R(at(k), at(largest)) + R(at(largest), at(k));
    out[k] = written::settled(product / (2 * twice), Real(1));
  }
  return out;
}

/// The turn of a quaternion of any length but 0.
Matrix3 turnOf(const Real* q) {
  Matrix3 cross;
  cross << 0, -q[3], q[2], q[3], 0, -q[1], -q[2], q[1], 0;
  const Real length2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  return Matrix3::Identity() + 2 / length2 * (q[0] * cross + cross * cross);
}

class MjcfWriter {
 public:
  MjcfWriter(const Scene& scene, std::vector<std::string>* lost)
      : scene_(scene), mechanism_(scene.mechanism), number_(mechanism_), lost_(*lost) {}

  std::string operator()();

 private:
  const Link& link(int i) const { return mechanism_.links[static_cast<std::size_t>(i)]; }
  bool isWorld(int i) const {
    return i == 0 && link(0).name == "world" && isMassless(link(0).inertia, number_);
  }
  void lose(const std::string& what) { lost_.push_back(what); }
  void prepare();
  /// The links of a body from the first to the last joint.
  std::vector<int> rowFrom(int first) const;
  Frame world(int i) const;
  std::string opened(const std::vector<int>& row, const std::string& margin, bool has_bodies);
  std::string bodies(std::vector<int> firsts);
  std::string joints(const std::vector<int>& row, const Frame& after);
  std::string jointElement(const std::string& name, const char* type, const Joint* joint,
                           const Vector3& pos, const Vector3& axis) const;
  std::string placed(const Vector3& pos, const Vector3& rpy) const;
  std::string inertial(const Link& link, const Vector3& shift) const;
  std::string equality();
  std::string keyframe() const;
  void loseRest();

  const Scene& scene_;
  const Mechanism& mechanism_;
  Numbers number_;
  std::vector<std::string>& lost_;
  std::vector<std::vector<int>> children_;
  std::vector<bool> rests_, is_held_;  ///< by link: in the world; by a closure, load, ...
  std::vector<Vector3> shift_;         ///< by link: of its frame in its body's
  std::vector<int> first_slot_;        ///< by link; -1: its joint does not move
  bool start_is_lost_ = false;
};

void MjcfWriter::prepare() {
  const std::size_t n = mechanism_.links.size();
  children_.resize(n);
  rests_.assign(n, true);
  is_held_.assign(n, false);
  shift_.assign(n, Vector3::Zero());
  first_slot_.assign(n, -1);
  std::vector<int> depths(n, 1);
  int slot = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Link& l = mechanism_.links[i];
    if (i > 0 && l.name == "world")
      throw InputError(l.where, "link \"world\": of MJCF that is the root, allowed: another name");
    if (l.parent < 0) continue;
    const auto parent = static_cast<std::size_t>(l.parent);
    children_[parent].push_back(static_cast<int>(i));
    rests_[i] = rests_[parent] && l.joint.kind == JointKind::kFixed;
    depths[i] = depths[parent] + 1;
    if (depths[i] > kMostBodies)
      throw InputError(l.where, fmt::format("link \"{}\" is the end of a row of more than {}, "
                                            "which readers of MJCF do not take, allowed: shorter "
                                            "rows",
                                            l.name, kMostBodies));
    if (l.joint.kind == JointKind::kHelical)
      throw InputError(l.where, fmt::format("joint \"{}\" is helical, allowed in MJCF: all others",
                                            l.joint.name));
    if (l.joint.kind == JointKind::kFixed) continue;
    first_slot_[i] = slot;
    slot += static_cast<int>(positionSlots(l.joint.kind).size());
  }
  const auto hold = [this](int i) { is_held_[static_cast<std::size_t>(i)] = true; };
  for (const Wrench& w : mechanism_.wrenches) hold(w.link);
  for (const Closure& c : mechanism_.closures) {
    hold(c.a.link);
    hold(c.b.link);
  }
  for (const Spring& spring : mechanism_.springs) {
    hold(spring.a.link);
    hold(spring.b.link);
  }
  for (const AccelerationConstraint& c : mechanism_.acceleration_constraints) hold(c.link);
}

std::vector<int> MjcfWriter::rowFrom(int first) const {
  const auto isOrdinary = [this](int i) {
    const Joint& joint = link(i).joint;
    return joint.placement.convention == Placement::Convention::kXyzRpy &&
           (joint.kind == JointKind::kRevolute || joint.kind == JointKind::kPrismatic ||
            joint.kind == JointKind::kSpherical);
  };
  std::vector<int> row = {first};
  while (true) {
    const int i = row.back();
    const std::vector<int>& children = children_[static_cast<std::size_t>(i)];
    if (!isOrdinary(i) || children.size() != 1 || !isOrdinary(children[0]) ||
        is_held_[static_cast<std::size_t>(i)] || !isMassless(link(i).inertia, number_) ||
        !written::vector(link(children[0]).joint.placement.rpy, number_).isZero(0))
      break;
    row.push_back(children[0]);
  }
  // the names say whether the reader made them
  const auto isMadeUp = [&](std::size_t last) {
    for (std::size_t k = 0; k < last; ++k)
      if (link(row[k]).name != link(row[last]).name + "." + link(row[k]).joint.name) return false;
    return true;
  };
  std::size_t last = row.size() - 1;
  while (!isMadeUp(last)) --last;
  row.resize(last + 1);
  return row;
}

/// Where a link is with all q zero, but free joints at the start.
Frame MjcfWriter::world(int i) const {
  std::vector<int> path;
  for (; i > 0; i = link(i).parent) path.push_back(i);
  Frame out;
  const auto move = [&out](const Vector3& p, const Matrix3& R) {
    out.p += out.R * p;
    out.R = out.R * R;
  };
  for (auto at = path.rbegin(); at != path.rend(); ++at) {
    const Joint& joint = link(*at).joint;
    const Frame before = written::frameOf(joint.placement.beforeJoint(), number_),
                after = written::frameOf(joint.placement.afterJoint(), number_);
    move(before.p, before.R);
    if (joint.kind == JointKind::kFloating) {
      const auto slot = static_cast<std::size_t>(first_slot_[static_cast<std::size_t>(*at)]);
      std::array<Real, 7> x;
      for (std::size_t k = 0; k < 7; ++k) x[k] = number_(scene_.start_q[slot + k]);
      move(Vector3(x[0], x[1], x[2]), turnOf(&x[3]));
    }
    move(after.p, after.R);
    out.size += before.size + after.size;
  }
  return out;
}

std::string MjcfWriter::placed(const Vector3& pos, const Vector3& rpy) const {
  std::string out;
  if (!pos.isZero(0)) out += fmt::format(" pos=\"{}\"", text(pos));
  if (!rpy.isZero(0)) out += fmt::format(" euler=\"{}\"", text(rpy));
  return out;
}

std::string MjcfWriter::inertial(const Link& link, const Vector3& shift) const {
  if (isMassless(link.inertia, number_)) return "";
  const written::Inertial m = written::aboutCenterOfMass(link.inertia, number_);
  const Vector3 com = m.origin.xyz + shift;
  std::string out = fmt::format("<inertial mass=\"{}\" pos=\"{}\"", text(m.mass), text(com));
  Matrix3 I = m.I;
  Vector3 rpy = m.origin.rpy;
  if (!I.isDiagonal(0) && !rpy.isZero(0)) {  // of MJCF a full inertia is in the body's axes
    const Matrix3 R = written::turn(link.inertia.rpy, number_);
    const Real size = I.trace();
    I = (R * I * R.transpose())
            .unaryExpr([&](const Real& x) { return written::settled(x, size); })
            .eval();
    rpy.setZero();
  }
  if (I.isDiagonal(0))
    return out + fmt::format("{} diaginertia=\"{} {} {}\"/>", placed(Vector3::Zero(), rpy),
                             text(I(0, 0)), text(I(1, 1)), text(I(2, 2)));
  return out + fmt::format(" fullinertia=\"{} {} {} {} {} {}\"/>", text(I(0, 0)), text(I(1, 1)),
                           text(I(2, 2)), text(I(0, 1)), text(I(0, 2)), text(I(1, 2)));
}

/// @param joint  what it has beside its motion; nullptr: nothing
std::string MjcfWriter::jointElement(const std::string& name, const char* type, const Joint* joint,
                                     const Vector3& pos, const Vector3& axis) const {
  std::string out = fmt::format("<joint name=\"{}\" type=\"{}\"", escaped(name), type);
  if (!pos.isZero(0)) out += fmt::format(" pos=\"{}\"", text(pos));
  if (axis != Vector3::UnitZ()) out += fmt::format(" axis=\"{}\"", text(axis));
  if (joint) {
    const auto say = [&](const char* key, const Real& x) {
      if (x != 0) out += fmt::format(" {}=\"{}\"", key, text(x));
    };
    const Real gear = number_(joint->gear_ratio);
    say("armature", gear * gear * number_(joint->rotor_inertia));
    say("damping", number_(joint->friction.viscous));
    if (number_(joint->friction.positive) == number_(joint->friction.negative))
      say("frictionloss", number_(joint->friction.positive));
    say("stiffness", number_(joint->stiffness));
    if (number_(joint->stiffness) != 0) say("springref", number_(joint->rest));
  }
  return out + "/>";
}

/// @param after  from the joint's frame to the body's
std::string MjcfWriter::joints(const std::vector<int>& row, const Frame& after) {
  std::string out;
  Vector3 anchor = -after.R.transpose() * after.p;
  for (std::size_t k = 0; k < row.size(); ++k) {
    const Joint& joint = link(row[k]).joint;
    if (k > 0) anchor += written::vector(joint.placement.xyz, number_);
    const Vector3 axis = after.R.transpose() * written::vector(joint.axis, number_);
    const auto several = [&](const char* kinds) {
      lose(fmt::format("joint {} is {}: it stands as {} in one body", joint.name,
                       scene::name(joint.kind), kinds));
    };
    const auto add = [&](const std::string& name, const char* type, const Vector3& along) {
      out += jointElement(name, type, nullptr, anchor, along);
    };
    switch (joint.kind) {
      case JointKind::kRevolute:
      case JointKind::kPrismatic:
        out += jointElement(joint.name, joint.kind == JointKind::kRevolute ? "hinge" : "slide",
                            &joint, anchor, axis);
        break;
      case JointKind::kSpherical:
        out += jointElement(joint.name, "ball", nullptr, anchor, Vector3::UnitZ());
        break;
      case JointKind::kCylindrical:
        several("slide and hinge");
        add(joint.name + ".slide", "slide", axis);
        add(joint.name + ".turn", "hinge", axis);
        break;
      case JointKind::kUniversal:
        several("two hinges");
        add(joint.name + ".x", "hinge", Vector3::UnitX());
        add(joint.name + ".y", "hinge", Vector3::UnitY());
        break;
      case JointKind::kPlanar: {  // Rz(alpha) Ry(beta) takes z to the axis
        several("two slides and a hinge");
        const AxisTurn<Real> turned = number_.axisTurn(joint.axis);
        const Vector3 y(-turned.alpha.s, turned.alpha.c, 0), x = y.cross(axis);
        add(joint.name + ".x", "slide", x);
        add(joint.name + ".y", "slide", y);
        add(joint.name + ".turn", "hinge", axis);
        break;
      }
      case JointKind::kFixed:
      case JointKind::kHelical:
      case JointKind::kFloating:
        break;
    }
    shift_[static_cast<std::size_t>(row[k])] = anchor;
  }
  if (link(row.back()).joint.placement.convention != Placement::Convention::kXyzRpy)
    shift_[static_cast<std::size_t>(row.back())].setZero();
  return out;
}

/// A body's element without those in it: its opening tag, or the whole one where it is empty.
std::string MjcfWriter::opened(const std::vector<int>& row, const std::string& margin,
                               bool has_bodies) {
  const int first = row.front();
  const int last = row.back();
  const Link& l = link(last);
  const Joint& joint = link(first).joint;
  std::string inside, out = fmt::format("{}<body name=\"{}\"", margin, escaped(l.name));
  if (joint.kind == JointKind::kFloating) {
    const auto slot = static_cast<std::size_t>(first_slot_[static_cast<std::size_t>(first)]);
    const Frame on = world(l.parent),
                before = written::frameOf(joint.placement.beforeJoint(), number_);
    if (!rests_[static_cast<std::size_t>(l.parent)])
      throw InputError(l.where, fmt::format("joint \"{}\" is floating on a link that moves, "
                                            "allowed in MJCF: on one that rests in the world",
                                            joint.name));
    if (Matrix3 R = on.R * before.R; R.isIdentity(0) && (on.p + on.R * before.p).isZero(0)) {
      std::string p, q;
      for (std::size_t k = 0; k < 7; ++k)
        (k < 3 ? p : q) += (k == 0 || k == 3 ? "" : " ") + text(number_(scene_.start_q[slot + k]));
      if (p != "0 0 0") out += fmt::format(" pos=\"{}\"", p);
      if (q != "1 0 0 0") out += fmt::format(" quat=\"{}\"", q);
    } else {
      lose(
          fmt::format("the frame of the floating joint {}: that of a free joint is the world's, so "
                      "its positions are others, and the start stands in the body's own place",
                      joint.name));
      start_is_lost_ = true;
      const Frame at = world(last);
      out += placed(at.p, written::rollPitchYaw(at.R));
    }
    inside = fmt::format("<freejoint name=\"{}\"/>", escaped(joint.name));
  } else if (last > 0) {
    const Frame after = written::frameOf(joint.placement.afterJoint(), number_);
    Origin origin = written::jointOrigin(joint.placement, number_);
    if (joint.placement.convention != Placement::Convention::kXyzRpy) {
      std::vector<Step> steps = joint.placement.beforeJoint();
      const std::vector<Step> more = joint.placement.afterJoint();
      steps.insert(steps.end(), more.begin(), more.end());
      origin = written::composed(steps, number_);
    }
    out += placed(origin.xyz + shift_[static_cast<std::size_t>(link(first).parent)], origin.rpy);
    inside = joints(row, after);
  }
  inside += inertial(l, shift_[static_cast<std::size_t>(last)]);
  if (inside.empty() && !has_bodies) return out + "/>\n";
  return out + ">" + inside + (has_bodies ? "\n" : "</body>\n");
}

/// Bodies with all in them, without recursion; those with free joints stand in the world, after.
std::string MjcfWriter::bodies(std::vector<int> firsts) {
  struct Task {
    int first;  ///< -1: a tag is closed
    std::size_t indent;
  };
  std::string out;
  while (!firsts.empty()) {
    std::vector<Task> left;
    for (auto first = firsts.rbegin(); first != firsts.rend(); ++first) left.push_back({*first, 4});
    firsts.clear();
    while (!left.empty()) {
      const Task task = left.back();
      left.pop_back();
      const std::string margin(task.indent, ' ');
      if (task.first < 0) {
        out += margin + "</body>\n";
        continue;
      }
      const std::vector<int> row = rowFrom(task.first);
      std::vector<int> inside;
      for (const int child : children_[static_cast<std::size_t>(row.back())])
        (link(child).joint.kind == JointKind::kFloating ? firsts : inside).push_back(child);
      out += opened(row, margin, !inside.empty());
      if (inside.empty()) continue;
      left.push_back({-1, task.indent});
      for (auto child = inside.rbegin(); child != inside.rend(); ++child)
        left.push_back({*child, task.indent + 2});
    }
  }
  return out;
}

/// Closures that MJCF has, and followers.
std::string MjcfWriter::equality() {
  std::string out;
  for (const Closure& c : mechanism_.closures) {
    const auto bodyOf = [this](const Attachment& at) {
      return escaped(isWorld(at.link) ? "world" : link(at.link).name);
    };
    const auto inBody = [this](const Attachment& at) {
      return Vector3(written::vector(at.xyz, number_) + shift_[static_cast<std::size_t>(at.link)]);
    };
    const Vector3 a = inBody(c.a), b = inBody(c.b);
    const std::string between = fmt::format(" name=\"{}\" body1=\"{}\" body2=\"{}\"",
                                            escaped(c.name), bodyOf(c.a), bodyOf(c.b));
    if (c.kind == ClosureKind::kWeld) {
      const std::array<Real, 4> q = quaternionOf(written::turn(c.a.rpy, number_) *
                                                 written::turn(c.b.rpy, number_).transpose());
      out += fmt::format("    <weld{} anchor=\"{}\" relpose=\"{} {} {} {} {}\"/>\n", between,
                         text(b), text(a), text(q[0]), text(q[1]), text(q[2]), text(q[3]));
    } else if (c.kind == ClosureKind::kPoint) {
      const Frame A = world(c.a.link), B = world(c.b.link);
      const Vector3 at_a = A.p + A.R * written::vector(c.a.xyz, number_),
                    at_b = B.p + B.R * written::vector(c.b.xyz, number_);
      // by no more than the last digits of doubles
      if (Real apart = (at_a - at_b).norm();
          apart > (at_a.norm() + at_b.norm() + A.size + B.size) * Real("1e-15")) {
        lose(
            fmt::format("closure {}: connect takes its ends to be together at q = 0, where they "
                        "are {} m apart",
                        c.name, apart.str(3, std::ios_base::fmtflags(0))));
        continue;
      }
      out += fmt::format("    <connect{} anchor=\"{}\"/>\n", between, text(a));
    } else {
      lose(fmt::format("closure {}, which is a {}", c.name, scene::name(c.kind)));
    }
  }
  for (const Link& l : mechanism_.links) {
    if (!l.joint.mimic) continue;
    out +=
        fmt::format("    <joint joint1=\"{}\" joint2=\"{}\" polycoef=\"{} {} 0 0 0\"/>\n",
                    escaped(l.joint.name), escaped(l.joint.mimic->joint),
                    text(number_(l.joint.mimic->offset)), text(number_(l.joint.mimic->multiplier)));
  }
  return out;
}

std::string MjcfWriter::keyframe() const {
  // free joints alone are where their bodies are
  const std::vector<Number> rest = mechanism_.restPosition();
  bool at_rest = true;
  std::string qpos, qvel;
  const auto add = [](std::string* list, const Real& x) {
    *list += (list->empty() ? "" : " ") + text(x);
  };
  std::size_t slot = 0;
  const std::vector<int> rates = firstRates(mechanism_);
  const std::vector<Follower> follow = followers(mechanism_);
  for (const int i : mechanism_.movingLinks()) {
    const Joint& joint = link(i).joint;
    const std::size_t slots = positionSlots(joint.kind).size();
    for (std::size_t k = 0; k < slots; ++k) {
      const Real x = number_(scene_.start_q[slot + k]);
      at_rest = at_rest && (joint.kind == JointKind::kFloating || x == number_(rest[slot + k]));
      add(&qpos, x);
    }
    Real factor = 1;
    for (const Follower& f : follow)
      if (f.link == i) factor = number_(Number(f.multiplier));
    const auto rate = static_cast<std::size_t>(rates[static_cast<std::size_t>(i)]);
    std::vector<Real> v;
    for (int k = 0; k < degreesOfFreedom(joint.kind); ++k) {
      v.push_back(factor * number_(scene_.start_qd[rate + static_cast<std::size_t>(k)]));
      at_rest = at_rest && v.back() == 0;
    }
    if (joint.kind == JointKind::kFloating) {  // MuJoCo's are in the axes of the world
      std::array<Real, 4> q;
      for (std::size_t k = 0; k < 4; ++k) q[k] = number_(scene_.start_q[slot + 3 + k]);
      const Vector3 turned = turnOf(q.data()) * Vector3(v[0], v[1], v[2]);
      std::copy_n(turned.data(), 3, v.begin());
    }
    for (const Real& x : v) add(&qvel, x);
    slot += slots;
  }
  if (at_rest || start_is_lost_) return "";
  return fmt::format("    <key name=\"start\" qpos=\"{}\" qvel=\"{}\"/>\n", qpos, qvel);
}

void MjcfWriter::loseRest() {
  for (const Link& l : mechanism_.links) {
    if (l.joint.gyroscopic)
      lose(fmt::format("the gyroscopic rotor of joint {}: armature stays", l.joint.name));
    if (!l.joint.rotors.empty()) lose(fmt::format("the rotors of joint {}", l.joint.name));
    if (number_(l.joint.friction.positive) != number_(l.joint.friction.negative))
      lose(fmt::format("Coulomb friction of joint {}, which is not the same both ways",
                       l.joint.name));
    if (!l.joint.motion.empty()) lose(fmt::format("the motion of joint {}", l.joint.name));
  }
  if (!mechanism_.wrenches.empty()) lose(fmt::format("{} loads", mechanism_.wrenches.size()));
  if (!mechanism_.springs.empty())
    lose(fmt::format("{} springs between points", mechanism_.springs.size()));
  if (!mechanism_.acceleration_constraints.empty())
    lose(fmt::format("{} acceleration constraints", mechanism_.acceleration_constraints.size()));
}

std::string MjcfWriter::operator()() {
  prepare();
  const std::string tree = bodies(isWorld(0) ? children_[0] : std::vector<int>{0});
  const std::string closed = equality(), start = keyframe();
  loseRest();
  std::string out = fmt::format("<mujoco model=\"{}\">\n", escaped(scene_.title));
  out += "  <compiler angle=\"radian\" eulerseq=\"XYZ\"/>\n";
  out += fmt::format(
      "  <option gravity=\"{}\"/>\n",
      mechanism_.has_gravity ? text(written::vector(mechanism_.gravity, number_)) : "0 0 0");
  out += "  <worldbody>\n" + tree + "  </worldbody>\n";
  if (!closed.empty()) out += "  <equality>\n" + closed + "  </equality>\n";
  if (!start.empty()) out += "  <keyframe>\n" + start + "  </keyframe>\n";
  return out + "</mujoco>\n";
}

}  // namespace

std::string writeSceneMjcf(const Scene& scene, std::vector<std::string>* lost) {
  return MjcfWriter(scene, lost)();
}

}  // namespace dynwitness::scene
