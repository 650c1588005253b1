// SPDX-License-Identifier: GPL-3.0-or-later
// Writes scenes as URDF, for programs that read nothing else.
//
// Numbers are formed exactly or with 50 digits, and printed with 17: decimals of the scene stay the
// decimals that they are. Every frame of the scene is a frame of the file. A Denavit-Hartenberg
// link, whose frame is not the frame of its joint, hangs on a massless one that is.
#include <tinyxml.h>

#include <array>
#include <iterator>

#include <fmt/format.h>
#include <Eigen/Core>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

#include "scene/mimic.hpp"
#include "scene/numbers.hpp"
#include "scene/scene.hpp"
#include "scene/text_file.hpp"

namespace dynwitness::scene {
namespace {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_50::backend_type,
                                           boost::multiprecision::et_off>;
using Numbers = RealNumbers<Real>;
using Vector3 = Eigen::Matrix<Real, 3, 1>;
using Matrix3 = Eigen::Matrix<Real, 3, 3>;

/// x, or zero where x is what the roundings of 50 digits leave of numbers of this size.
Real settled(const Real& x, const Real& size) {
  return abs(x) < size * Real("1e-40") ? Real(0) : x;
}

/// 17 significant digits, no more than it takes.
std::string text(const Real& x) {
  return x == 0 ? "0" : x.str(17, std::ios_base::fmtflags(0));
}
std::string text(const Vector3& v) {
  return fmt::format("{} {} {}", text(v[0]), text(v[1]), text(v[2]));
}

std::string escaped(const std::string& name) {
  std::string encoded;  // TinyXML is built with TIXML_USE_STL wherever urdfdom is packaged
  TiXmlBase::EncodeString(name, &encoded);
  return encoded;
}

Vector3 vector(const Vector& v, const Numbers& number) {
  return {number(v[0]), number(v[1]), number(v[2])};
}

Matrix3 turn(const CosSin<Real>& a, int axis) {
  const int y = (axis + 1) % 3, z = (axis + 2) % 3;
  Matrix3 R = Matrix3::Identity();
  R(y, y) = R(z, z) = a.c;
  R(z, y) = a.s;
  R(y, z) = -a.s;
  return R;
}

/// <origin>: a frame on its parent's.
struct Origin {
  Vector3 xyz = Vector3::Zero(), rpy = Vector3::Zero();

  std::string text() const {
    std::string attributes;
    if (!xyz.isZero(0)) attributes += fmt::format(" xyz=\"{}\"", scene::text(xyz));
    if (!rpy.isZero(0)) attributes += fmt::format(" rpy=\"{}\"", scene::text(rpy));
    return attributes.empty() ? "" : "<origin" + attributes + "/>";
  }
};

/** Roll, pitch and yaw of R = Rz(yaw) Ry(pitch) Rx(roll). Roll is read off Rz(-yaw) R, so the three
    give R again also where the pitch is a right angle and yaw alone is undetermined. */
Vector3 rollPitchYaw(const Matrix3& R) {
  const Real yaw = atan2(R(1, 0), R(0, 0)), c = cos(yaw), s = sin(yaw);
  const Real pitch = atan2(Real(-R(2, 0)), Real(c * R(0, 0) + s * R(1, 0)));
  const Real roll = atan2(Real(s * R(0, 2) - c * R(1, 2)), Real(c * R(1, 1) - s * R(0, 1)));
  return Vector3(roll, pitch, yaw).unaryExpr([](const Real& x) { return settled(x, Real(1)); });
}

Origin composed(const std::vector<Step>& steps, const Numbers& number) {
  Vector3 p = Vector3::Zero();
  Matrix3 R = Matrix3::Identity();
  Real size = 0;  // of the translations
  for (const Step& step : steps) {
    if (step.kind == Step::Kind::kTranslate) {
      const Vector3 d = vector(step.translation, number);
      p += R * d;
      size += d.lpNorm<1>();
    } else {
      const int axis = static_cast<int>(step.kind) - static_cast<int>(Step::Kind::kRotateX);
      R = R * turn(number.angle(step.angle), axis);
    }
  }
  return {p.unaryExpr([&](const Real& x) { return settled(x, size); }), rollPitchYaw(R)};
}

/// Parent's link frame to joint frame.
Origin jointOrigin(const Placement& placement, const Numbers& number) {
  if (placement.convention != Placement::Convention::kXyzRpy)
    return composed(placement.beforeJoint(), number);
  return {vector(placement.xyz, number), vector(placement.rpy, number)};
}

Matrix3 inertiaMatrix(const MassProperties& p, const Numbers& number) {
  const Real xx = number(p.xx), yy = number(p.yy), zz = number(p.zz), xy = number(p.xy),
             xz = number(p.xz), yz = number(p.yz);
  return (Matrix3() << xx, xy, xz, xy, yy, yz, xz, yz, zz).finished();
}

/// The inertia that URDF asks for: about the centre of mass.
std::string inertial(const MassProperties& p, const Numbers& number) {
  const Real mass = number(p.mass);
  const Vector3 com = vector(p.com, number);
  Origin origin{com, vector(p.rpy, number)};
  Matrix3 I = inertiaMatrix(p, number);
  if (p.about == MassProperties::About::kLinkOrigin && mass != 0 && !com.isZero(0)) {
    const Matrix3 R = turn(number.angle(p.rpy[2]), 2) * turn(number.angle(p.rpy[1]), 1) *
                      turn(number.angle(p.rpy[0]), 0);
    const Matrix3 at_origin = R * I * R.transpose();
    I = at_origin - mass * (com.squaredNorm() * Matrix3::Identity() - com * com.transpose());
    const Real size = at_origin.trace();
    I = I.unaryExpr([&](const Real& x) { return settled(x, size); }).eval();
    origin.rpy.setZero();
  }
  return fmt::format(
      "<inertial>{}<mass value=\"{}\"/><inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" "
      "iyz=\"{}\" izz=\"{}\"/></inertial>",
      origin.text(), text(mass), text(I(0, 0)), text(I(0, 1)), text(I(0, 2)), text(I(1, 1)),
      text(I(1, 2)), text(I(2, 2)));
}

std::string jointElement(const std::string& name, const char* type, const std::string& parent,
                         const std::string& child, const Origin& origin,
                         const std::string& more = "") {
  return fmt::format(
      "  <joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/>{}{}</joint>\n",
      escaped(name), type, escaped(parent), escaped(child), origin.text(), more);
}

std::string linkElement(const std::string& name, const MassProperties& inertia,
                        const Numbers& number) {
  return fmt::format("  <link name=\"{}\">{}</link>\n", escaped(name), inertial(inertia, number));
}

/// Friction, as far as URDF has words for it: viscous, and Coulomb's when it is the same both ways.
std::string dynamics(const Joint& joint, const Numbers& number) {
  const Friction& friction = joint.friction;
  std::string words;
  if (number(friction.viscous) != 0)
    words += fmt::format(" damping=\"{}\"", text(number(friction.viscous)));
  if (number(friction.positive) != 0 && number(friction.positive) == number(friction.negative))
    words += fmt::format(" friction=\"{}\"", text(number(friction.positive)));
  return words.empty() ? "" : "<dynamics" + words + "/>";
}

std::string mimic(const Joint& joint, const Numbers& number) {
  if (!joint.mimic) return "";
  const auto attribute = [&](const char* key, const Number& n, int otherwise) {
    const Real x = number(n);
    return x == otherwise ? std::string() : fmt::format(" {}=\"{}\"", key, text(x));
  };
  return fmt::format("<mimic joint=\"{}\"{}{}/>", escaped(joint.mimic->joint),
                     attribute("multiplier", joint.mimic->multiplier, 1),
                     attribute("offset", joint.mimic->offset, 0));
}

/// What URDF calls a moving joint.
const char* urdfType(const Link& link) {
  switch (link.joint.kind) {
    case JointKind::kRevolute:
      return "continuous";
    case JointKind::kPrismatic:
      return "prismatic";
    case JointKind::kPlanar:
      return "planar";
    case JointKind::kFloating:
      return "floating";
    default:
      throw InputError(link.where,
                       fmt::format("joint \"{}\" is {}, allowed in URDF: fixed, revolute, "
                                   "prismatic, planar, floating",
                                   link.joint.name, name(link.joint.kind)));
  }
}

std::string linkAndJoint(const Mechanism& mechanism, const Link& link, const Numbers& number) {
  std::string element = linkElement(link.name, link.inertia, number);
  if (link.parent < 0) return element;
  const Joint& joint = link.joint;
  const std::string& parent = mechanism.links[link.parent].name;
  const Origin before = jointOrigin(joint.placement, number);
  const std::vector<Step> after_joint = joint.placement.afterJoint();
  if (joint.kind == JointKind::kFixed) {
    std::vector<Step> steps = joint.placement.beforeJoint();
    steps.insert(steps.end(), after_joint.begin(), after_joint.end());
    return element + jointElement(joint.name, "fixed", parent, link.name,
                                  after_joint.empty() ? before : composed(steps, number));
  }

  const char* type = urdfType(link);
  std::string axis = fmt::format("<axis xyz=\"{}\"/>", text(vector(joint.axis, number)));
  if (joint.kind == JointKind::kPrismatic)  // URDF has no slide without ends
    axis += R"(<limit lower="-1e9" upper="1e9" effort="1e9" velocity="1e9"/>)";
  if (joint.kind == JointKind::kFloating) axis.clear();
  axis += dynamics(joint, number) + mimic(joint, number);
  const Origin after = composed(after_joint, number);
  if (after.text().empty())
    return element + jointElement(joint.name, type, parent, link.name, before, axis);
  const std::string moved = link.name + ".joint_frame";
  return linkElement(moved, {}, number) +
         jointElement(joint.name, type, parent, moved, before, axis) + element +
         jointElement(joint.name + ".to_link_frame", "fixed", moved, link.name, after);
}

/// What the scene has and URDF has no words for.
std::string leftOut(const Mechanism& mechanism, const Numbers& number) {
  bool rotors = false, springs = false, one_sided = false;
  for (const Link& link : mechanism.links) {
    rotors = rotors || number(link.joint.rotor_inertia) != 0;
    springs = springs || number(link.joint.stiffness) != 0;
    one_sided =
        one_sided || number(link.joint.friction.positive) != number(link.joint.friction.negative);
  }
  std::string what = mechanism.has_gravity
                         ? "gravity (" + text(vector(mechanism.gravity, number)) + ")"
                         : "that there is no gravity";
  if (rotors) what += ", rotors";
  if (springs) what += ", springs";
  if (one_sided) what += ", Coulomb friction that is not the same both ways";
  if (!mechanism.wrenches.empty()) what += ", loads";
  if (!mechanism.isOpenTree()) what += ", closures and springs between points";
  return what;
}

/// The file without <visual>, <collision> and <mimic>; empty when it is not a URDF file.
std::string withoutGeometryAndMimics(const std::string& file_text) {
  TiXmlDocument document;
  document.Parse(file_text.c_str());
  TiXmlElement* robot = document.RootElement();
  if (document.Error() || !robot || robot->ValueStr() != "robot") return "";
  for (TiXmlElement* link = robot->FirstChildElement("link"); link;
       link = link->NextSiblingElement("link")) {
    for (const char* geometry : {"visual", "collision"})
      while (TiXmlElement* found = link->FirstChildElement(geometry)) link->RemoveChild(found);
  }
  for (TiXmlElement* joint = robot->FirstChildElement("joint"); joint;
       joint = joint->NextSiblingElement("joint"))
    while (TiXmlElement* found = joint->FirstChildElement("mimic")) joint->RemoveChild(found);
  TiXmlPrinter printer;
  document.Accept(&printer);
  return printer.Str();
}

}  // namespace

std::string writeSceneUrdf(const Scene& scene) {
  const Mechanism& mechanism = scene.mechanism;
  const Numbers number(mechanism);
  std::string out = fmt::format("<robot name=\"{}\">\n", escaped(scene.title));
  out += fmt::format("  <!-- the scene also says, and URDF cannot: {} -->\n",
                     leftOut(mechanism, number));
  for (const Link& link : mechanism.links) out += linkAndJoint(mechanism, link, number);
  return out + "</robot>\n";
}

std::string urdfForEngines(const Scene& scene) {
  Scene tree = scene;
  tree.mechanism = withoutMimics(scene.mechanism);
  std::error_code error;
  if (scene.file.extension() == ".urdf" && std::filesystem::is_regular_file(scene.file, error)) {
    const std::string original = readTextFile(scene.file, "a URDF file");
    std::string kept = withoutGeometryAndMimics(original);
    if (!kept.empty()) {
      Scene read = readSceneUrdf(original, scene.file);
      read.mechanism = withoutMimics(read.mechanism);
      if (writeSceneUrdf(read) == writeSceneUrdf(tree)) return kept;
    }
  }
  return writeSceneUrdf(tree);
}

}  // namespace dynwitness::scene
