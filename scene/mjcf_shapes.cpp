// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mjcf_shapes.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <boost/math/constants/constants.hpp>

namespace dynwitness::scene::mjcf {
namespace {

/// Half lengths, or radius and half length, with what fromto says.
struct Shape {
  std::string type;
  Vector3 size = Vector3::Zero();
};

/** Volume and principal moments for a mass of 1, of solid bodies; z is the axis of capsules and
    cylinders, whose size is radius and half length. */
struct VolumeAndMoments {
  Real volume;
  Vector3 moments;
};
VolumeAndMoments volumeAndMoments(const Shape& shape) {
  const Real pi = boost::math::constants::pi<Real>();
  const Vector3& s = shape.size;
  const auto ofHalves = [&s](Real factor) {  // factor (b^2 + c^2), ...
    const Vector3 q = s.cwiseProduct(s);
    return Vector3(factor * Vector3(q[1] + q[2], q[0] + q[2], q[0] + q[1]));
  };
  if (shape.type == "box") return {8 * s.prod(), ofHalves(Real(1) / 3)};
  if (shape.type == "ellipsoid") return {4 * pi / 3 * s.prod(), ofHalves(Real(1) / 5)};
  const Real r = s[0], h = 2 * s[1];
  if (shape.type == "sphere") return {4 * pi / 3 * r * r * r, Vector3::Constant(2 * r * r / 5)};
  if (shape.type == "cylinder") {
    const Real across = (3 * r * r + h * h) / 12;
    return {pi * r * r * h, {across, across, r * r / 2}};
  }
  // capsule: a cylinder, and two half spheres whose centres of mass are 3r/8 beyond its ends
  const Real cylinder = pi * r * r * h, ball = 4 * pi / 3 * r * r * r, volume = cylinder + ball;
  const Real across =
      cylinder * (3 * r * r + h * h) / 12 + ball * (2 * r * r / 5 + h * h / 4 + 3 * r * h / 8);
  return {volume,
          {across / volume, across / volume, (cylinder / 2 + ball * 2 / 5) * r * r / volume}};
}

}  // namespace

std::optional<Solid> solidOf(const Said& said, const Compiler& compiler, bool rests,
                             bool* is_known) {
  const std::string type = said.word(
      "type", "sphere",
      {"plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf"});
  if (said.has("mass") && isZero(said.number("mass"))) return {};
  if (!said.has("mass") && said.has("density") && isZero(said.number("density"))) return {};
  if (type == "plane" || type == "hfield") return {};
  if (compiler.discards_visuals && said.text("contype", "1") == "0" &&
      said.text("conaffinity", "1") == "0")
    said.fail(
        "makes inertia and is discarded (discardvisual): versions of MuJoCo differ in what is left "
        "of it, allowed: <inertial> in its body");
  if (type == "mesh" || type == "sdf" || said.has("mesh")) {
    *is_known = false;
    if (rests) return {};
    said.fail(
        "its mass and inertia come from a mesh, which is not read, allowed: <inertial> in its body, "
        "mass=\"0\", or type sphere, capsule, cylinder, ellipsoid, box");
  }
  if (said.flag("shellinertia", false))
    said.fail("shellinertia", "is true, which is not in the subset that is read, allowed: false");
  Solid out;
  const std::vector<Number> given = said.overlaid("size", 3);
  Shape shape{type};
  std::size_t needed = type == "sphere" ? 1 : type == "capsule" || type == "cylinder" ? 2 : 3;
  if (said.has("fromto")) {
    if (type == "sphere")
      said.fail("fromto", "goes with capsule, cylinder, ellipsoid and box, and type is sphere");
    for (const char* key : {"pos", "quat", "euler", "axisangle", "xyaxes", "zaxis"})
      if (said.has(key)) said.fail(key, "and fromto are both given, allowed: one of them");
    const std::vector<Number> ends = said.numbers("fromto", 6, 6);
    const Vector3 from(valueOf(ends[0]), valueOf(ends[1]), valueOf(ends[2])),
        to(valueOf(ends[3]), valueOf(ends[4]), valueOf(ends[5]));
    const Vector3 along = from - to;
    if (along.isZero(0)) said.fail("fromto", "has two equal points, allowed: two that differ");
    out.com = printed(Vector3((from + to) / 2), from.norm() + to.norm(), said.where());
    const Vector3 axis = Vector3::UnitZ().cross(along);
    const Real half = std::atan2(axis.norm(), along[2]) / 2;
    out.turn.R = turnOf(
        std::cos(half),
        std::sin(half) * (axis.isZero(0) ? Vector3(Vector3::UnitX()) : axis.stableNormalized()));
    out.turn.rpy = rollPitchYaw(out.turn.R, said.where());
    if (given.empty()) said.fail("has fromto and no size, allowed: the radius as size");
    const Real r = valueOf(given[0]), length = along.stableNorm() / 2;
    shape.size =
        type == "capsule" || type == "cylinder" ? Vector3(r, length, 0) : Vector3(r, r, length);
  } else {
    if (given.size() < needed)
      said.fail(fmt::format("type {} has {} sizes, allowed: {}", type, given.size(), needed));
    for (std::size_t k = 0; k < needed; ++k)
      shape.size[static_cast<Eigen::Index>(k)] = valueOf(given[k]);
    out.com = said.vector("pos");
    out.turn = turnSaid(said, compiler);
  }
  for (std::size_t k = 0; k < needed; ++k)
    if (!(shape.size[static_cast<Eigen::Index>(k)] > 0))
      said.fail("size is not above zero, allowed: sizes above zero");
  const VolumeAndMoments solid = volumeAndMoments(shape);
  const Real density = valueOf(said.number("density", 1000)),
             mass = said.has("mass") ? valueOf(said.number("mass")) : density * solid.volume;
  if (mass < 0) said.fail("mass or density is negative, allowed: zero or more");
  out.mass = said.has("mass") ? said.number("mass") : printed(mass, 0, said.where());
  out.moments = printed(Vector3(mass * solid.moments), 0, said.where());
  return out;
}

}  // namespace dynwitness::scene::mjcf
