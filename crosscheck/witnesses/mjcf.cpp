// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/mjcf.hpp"

#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "crosscheck/witnesses/told_numbers.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::JointKind;
using Real = ToldNumbers::Real;
using Vector3 = ToldNumbers::Vector3;
using Frame = ToldNumbers::Frame;

/// Whether a link rests in the world.
bool rests(const scene::Mechanism& mechanism, int link) {
  for (; link > 0; link = mechanism.links[link].parent)
    if (mechanism.links[link].joint.kind != JointKind::kFixed) return false;
  return true;
}

std::string text(const Vector3& v) {
  return mjcfNumbers(
      {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])});
}

std::string placed(const Frame& X) {
  const Eigen::Quaternion<Real> q = Eigen::Quaternion<Real>(X.R).normalized();
  return fmt::format("pos=\"{}\" quat=\"{}\"", text(X.p),
                     mjcfNumbers({static_cast<double>(q.w()), static_cast<double>(q.x()),
                                  static_cast<double>(q.y()), static_cast<double>(q.z())}));
}

/// The joints of one link, in the frame of its body.
class Joints {
 public:
  Joints(int link, const Frame& after) : name_(mjcfJoint(link)), after_(after) {}

  /// @param axis  in the scene's joint frame
  Joints& add(const char* type, const Vector3& axis) {
    out_ += fmt::format("<joint{} type=\"{}\" pos=\"{}\" axis=\"{}\"/>", name(), type,
                        text(Vector3(-after_.R.transpose() * after_.p)),
                        text(Vector3(after_.R.transpose() * axis)));
    return *this;
  }
  Joints& addBall() {
    out_ += fmt::format("<joint{} type=\"ball\"/>", name());
    return *this;
  }
  Joints& addFree() {
    out_ += fmt::format("<freejoint{}/>", name());
    return *this;
  }
  const std::string& all() const { return out_; }

 private:
  std::string name() {
    return fmt::format(" name=\"{}\"", made_++ == 0 ? name_ : fmt::format("{}.{}", name_, made_));
  }

  std::string name_;
  Frame after_;
  std::string out_;
  int made_ = 0;
};

class Writer {
 public:
  Writer(const scene::Mechanism& mechanism, const std::vector<std::string>& inertials)
      : mechanism_(mechanism), inertials_(inertials), number_(mechanism) {}

  std::string operator()() {
    const std::string tree = body(0);
    return "<mujoco>\n<worldbody>\n" + tree + in_world_ + "</worldbody>\n</mujoco>\n";
  }

 private:
  bool isFree(int link) const {
    return mechanism_.links[link].joint.kind == JointKind::kFloating &&
           rests(mechanism_, mechanism_.links[link].parent);
  }

  std::string body(int i) {
    const scene::Joint& joint = mechanism_.links[i].joint;
    const Frame before = number_.frame(joint.placement.beforeJoint()),
                after = number_.frame(joint.placement.afterJoint());
    const std::string where = isFree(i) ? "" : " " + placed(before * after);
    std::string out = fmt::format("<body name=\"{}\"{}>{}{}\n", mjcfLink(i), where,
                                  joints(i, after), inertials_[i]);
    for (int child = i + 1; child < static_cast<int>(mechanism_.links.size()); ++child) {
      if (mechanism_.links[child].parent != i) continue;
      if (!isFree(child)) {
        out += body(child);
        continue;
      }
      const Frame X = number_.frame(mechanism_.links[child].joint.placement.beforeJoint());
      out += fmt::format("<body name=\"{}\" {}/>\n", mjcfJointFrame(child), placed(X));
      in_world_ += body(child);
    }
    return out + "</body>\n";
  }

  std::string joints(int i, const Frame& after) {
    const scene::Joint& joint = mechanism_.links[i].joint;
    const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY(), z = Vector3::UnitZ();
    const Vector3 axis = number_.vector(joint.axis);
    Joints out(i, after);
    switch (joint.kind) {
      case JointKind::kFixed:
        break;
      case JointKind::kRevolute:
        out.add("hinge", axis);
        break;
      case JointKind::kPrismatic:
        out.add("slide", axis);
        break;
      case JointKind::kHelical:
        throw std::runtime_error("joint '" + joint.name +
                                 "' is helical, MuJoCo has no joint that turns and advances");
      case JointKind::kCylindrical:
        out.add("slide", axis).add("hinge", axis);
        break;
      case JointKind::kUniversal:
        out.add("hinge", x).add("hinge", y);
        break;
      case JointKind::kPlanar: {  // Rz(alpha) Ry(beta) takes z to the axis, x and y to these
        const scene::AxisTurn<Real> turn = number_.axisTurn(joint.axis);
        const Vector3 turned_y(-turn.alpha.s, turn.alpha.c, 0);
        out.add("slide", turned_y.cross(axis)).add("slide", turned_y).add("hinge", axis);
        break;
      }
      case JointKind::kSpherical:
        out.addBall();
        break;
      case JointKind::kFloating:
        if (isFree(i))
          out.addFree();
        else
          out.add("slide", x).add("slide", y).add("slide", z).addBall();
        break;
    }
    return out.all();
  }

  const scene::Mechanism& mechanism_;
  const std::vector<std::string>& inertials_;
  ToldNumbers number_;
  std::string in_world_;  ///< bodies with free joints
};

}  // namespace

std::string mjcfLink(int link) {
  return fmt::format("link {}", link);
}
std::string mjcfJoint(int link) {
  return fmt::format("joint {}", link);
}
std::string mjcfJointFrame(int link) {
  return fmt::format("frame {}", link);
}

std::string mjcf(const scene::Mechanism& mechanism, const std::vector<std::string>& inertials) {
  return Writer(mechanism, inertials)();
}

std::string mjcfNumbers(const std::vector<double>& numbers) {
  std::string out;
  for (const double x : numbers) out += fmt::format("{}{:.17g}", out.empty() ? "" : " ", x);
  return out;
}

}  // namespace dynwitness::crosscheck
