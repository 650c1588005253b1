// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/inputs/conventions.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

#include "scene/error.hpp"
#include "scene/mimic.hpp"
#include "scene/nearest_name.hpp"
#include "scene/turn.hpp"

namespace dynwitness::crosscheck {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using scene::JointKind;

/// How an orientation is written.
enum class Turn {
  kWxyz,
  kXyzw,
  kWLast,           ///< (x, y, z) in its place, w behind all other positions, joint by joint
  kRotationVector,  ///< axis times angle
  kRpy,             ///< R = Rz(yaw) Ry(pitch) Rx(roll)
};

struct Layout {
  CoordinateConvention convention;
  const char* name;
  Turn turn, of_spherical;  ///< of floating joints and of spherical ones
  bool turn_first;          ///< before the position, in q
  bool angular_first;       ///< before the velocity, in qd
  bool v_in_joint_axes, w_in_joint_axes;
};

/* Where each row is from:
     dynwitness  scene/mechanism.hpp
     pinocchio   joint-free-flyer.hpp, joint-spherical.hpp: (x, y, z, qx, qy, qz, qw); velocity and
                 angular velocity of the child frame, in its own axes
     mujoco      mujoco.readthedocs.io/en/stable/overview.html, "Floating objects", and mjmodel.h,
                 mjtJoint: global position, then quaternion (w, x, y, z); the velocity of a free
                 joint in global axes, its angular velocity and a ball joint's in the body's
     drake       multibody/tree/quaternion_floating_joint.h: (qw, qx, qy, qz, x, y, z), and
                 (w_FM, v_FM), both expressed in F; ball_rpy_joint.h: (r, p, y) with
                 R_FM = Rz(y) Ry(p) Rx(r), and w_FM
     rbdl        Joint.h: the w of a spherical joint stands behind all other positions; a floating
                 base is TranslationXYZ, then Spherical, whose velocity is in the body's axes
     dart        dynamics/FreeJoint.hpp, BallJoint.hpp: rotation vector (math::logMap), then
                 position; angular velocity, then velocity of the child, in its own axes
     simbody     MobilizedBody_Free.h, MobilizedBody_Ball.h: quaternion, then position; angular
                 velocity of M in F, then the velocity of its origin, both expressed in F */
constexpr Layout kLayouts[] = {
    {CoordinateConvention::kDynwitness, "dynwitness", Turn::kWxyz, Turn::kWxyz, false, false, false,
     false},
    {CoordinateConvention::kPinocchio, "pinocchio", Turn::kXyzw, Turn::kXyzw, false, false, false,
     false},
    {CoordinateConvention::kMujoco, "mujoco", Turn::kWxyz, Turn::kWxyz, false, false, true, false},
    {CoordinateConvention::kDrake, "drake", Turn::kWxyz, Turn::kRpy, true, true, true, true},
    {CoordinateConvention::kRbdl, "rbdl", Turn::kWLast, Turn::kWLast, false, false, true, false},
    {CoordinateConvention::kDart, "dart", Turn::kRotationVector, Turn::kRotationVector, true, true,
     false, false},
    {CoordinateConvention::kSimbody, "simbody", Turn::kWxyz, Turn::kWxyz, true, true, true, true},
};

const Layout& layoutOf(CoordinateConvention convention) {
  return *std::find_if(std::begin(kLayouts), std::end(kLayouts),
                       [&](const Layout& layout) { return layout.convention == convention; });
}

/// How many numbers stand in the joint's place.
int length(Turn turn) {
  return turn == Turn::kWxyz || turn == Turn::kXyzw ? 4 : 3;
}

/// The joint's link axes to its joint axes.
Matrix3d turnOf(const scene::State<double>& state, int first) {
  const auto x = [&](int k) { return state.x[static_cast<std::size_t>(first + k)].q; };
  Quaterniond q(x(0), x(1), x(2), x(3));
  q.coeffs().stableNormalize();
  return q.toRotationMatrix();
}

[[noreturn]] void refuse(const std::string& joint, const char* kind, const char* convention,
                         const std::string& why) {
  throw scene::InputError({}, fmt::format("--convention {}: joint '{}' is {}, {}; allowed: "
                                          "dynwitness, and states in its coordinates",
                                          convention, joint, kind, why));
}

}  // namespace

const char* name(CoordinateConvention convention) {
  return layoutOf(convention).name;
}

std::vector<std::string> conventionNames() {
  std::vector<std::string> names;
  for (const Layout& layout : kLayouts) names.emplace_back(layout.name);
  return names;
}

CoordinateConvention conventionNamed(const std::string& text) {
  for (const Layout& layout : kLayouts)
    if (text == layout.name) return layout.convention;
  const std::vector<std::string> names = conventionNames();
  throw scene::InputError({}, fmt::format("no convention '{}'{}, allowed: {}", text,
                                          scene::didYouMean(text, names), fmt::join(names, ", ")));
}

bool hasOrientations(const scene::Mechanism& mechanism) {
  return std::any_of(mechanism.links.begin(), mechanism.links.end(), [](const scene::Link& link) {
    return !scene::ratesArePositionDerivatives(link.joint.kind);
  });
}

Coordinates::Coordinates(const scene::Mechanism& mechanism, CoordinateConvention convention)
    : mechanism_(&mechanism), convention_(convention) {
  const Layout& layout = layoutOf(convention);
  int slot = 0, rate = 0;
  for (const scene::Link& link : mechanism.links) {
    const scene::Joint& joint = link.joint;
    const int slots = static_cast<int>(scene::positionSlots(joint.kind).size());
    const bool is_planar = joint.kind == JointKind::kPlanar;
    if (!isOurs() && (is_planar || joint.kind == JointKind::kCylindrical))
      refuse(joint.name, scene::name(joint.kind), layout.name,
             "whose coordinates engines sort in other ways, and they are not converted");
    if (scene::ratesArePositionDerivatives(joint.kind)) {
      for (int k = 0; k < slots && !joint.mimic; ++k) plain_.emplace_back(slot + k, positions_++);
    } else {
      const bool floats = joint.kind == JointKind::kFloating;
      if (convention == CoordinateConvention::kMujoco && floats &&
          (link.parent != 0 || !joint.placement.beforeJoint().empty()))
        refuse(joint.name, "floating from another frame than the world's", layout.name,
               "which is where MuJoCo's free joints move from");
      bodies_.push_back({joint.name, slot, rate, positions_, -1, floats});
      positions_ += (floats ? 3 : 0) + length(floats ? layout.turn : layout.of_spherical);
    }
    const int own = joint.ownRates();
    for (int k = 0; k < own; ++k)
      places_.push_back(rate + (own == 6 && layout.angular_first ? (k + 3) % 6 : k));
    slot += slots;
    rate += own;
  }
  for (Body& body : bodies_) {
    const Turn turn = body.floats ? layout.turn : layout.of_spherical;
    const int first = body.at + (body.floats && !layout.turn_first ? 3 : 0);
    if (turn == Turn::kWxyz) body.w = first;
    if (turn == Turn::kXyzw) body.w = first + 3;
    if (turn == Turn::kWLast) body.w = positions_++;
  }
}

void Coordinates::read(const std::vector<double>& q, scene::State<double>* state) const {
  const Layout& layout = layoutOf(convention_);
  const auto given = [&](int k) { return q[static_cast<std::size_t>(k)]; };
  const auto set = [&](int k, double x) {
    state->x[static_cast<std::size_t>(k)] = scene::jointPosition(x);
  };
  state->x.resize(static_cast<std::size_t>(mechanism_->positions()));
  for (const auto& [mine, other] : plain_) set(mine, given(other));
  for (const Body& body : bodies_) {
    const Turn turn = body.floats ? layout.turn : layout.of_spherical;
    const int position = body.at + (layout.turn_first ? length(turn) : 0);
    int first = body.at + (body.floats && !layout.turn_first ? 3 : 0);
    for (int k = 0; k < 3 && body.floats; ++k) set(body.slot + k, given(position + k));
    const int to = body.slot + (body.floats ? 3 : 0);
    double w = 0, x = 0, y = 0, z = 0;
    if (body.w >= 0) {
      first += turn == Turn::kWxyz ? 1 : 0;
      w = given(body.w), x = given(first), y = given(first + 1), z = given(first + 2);
      if (w == 0 && x == 0 && y == 0 && z == 0)
        throw scene::InputError(
            {},
            fmt::format("q{} to q{} are the quaternion of joint '{}' and all zero{}, allowed: any "
                        "other (w = 1 and the others 0 is no turn)",
                        first + 1 - (turn == Turn::kWxyz ? 1 : 0),
                        first + 3 + (turn == Turn::kXyzw ? 1 : 0), body.joint,
                        turn == Turn::kWLast ? fmt::format(" (its w is q{})", body.w + 1) : ""));
    } else if (turn == Turn::kRotationVector) {
      const Vector3d r(given(first), given(first + 1), given(first + 2));
      const double angle = r.stableNorm();
      const Vector3d v =
          angle == 0 ? Vector3d::Zero().eval() : (std::sin(angle / 2) / angle * r).eval();
      w = std::cos(angle / 2), x = v.x(), y = v.y(), z = v.z();
    } else {
      const Quaterniond turned = Eigen::AngleAxisd(given(first + 2), Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(given(first + 1), Vector3d::UnitY()) *
                                 Eigen::AngleAxisd(given(first), Vector3d::UnitX());
      w = turned.w(), x = turned.x(), y = turned.y(), z = turned.z();
    }
    set(to, w), set(to + 1, x), set(to + 2, y), set(to + 3, z);
  }
  scene::followLeaders(*mechanism_, &state->x);
  for (std::vector<double>* values : {&state->qd, &state->qdd, &state->tau})
    *values = ours(*state, *values);
  const std::vector<double> gained = turning(*state);
  for (std::size_t k = 0; k < gained.size(); ++k) state->qdd[k] -= gained[k];
}

std::vector<double> Coordinates::positionsOf(const scene::State<double>& state) const {
  const Layout& layout = layoutOf(convention_);
  std::vector<double> q(static_cast<std::size_t>(positions_));
  const auto put = [&](int k, double x) { q[static_cast<std::size_t>(k)] = x; };
  const auto ours = [&](int k) { return state.x[static_cast<std::size_t>(k)].q; };
  for (const auto& [mine, other] : plain_) put(other, ours(mine));
  for (const Body& body : bodies_) {
    const Turn turn = body.floats ? layout.turn : layout.of_spherical;
    const int position = body.at + (layout.turn_first ? length(turn) : 0);
    int first = body.at + (body.floats && !layout.turn_first ? 3 : 0);
    for (int k = 0; k < 3 && body.floats; ++k) put(position + k, ours(body.slot + k));
    const int from = body.slot + (body.floats ? 3 : 0);
    Eigen::Vector4d wxyz(ours(from), ours(from + 1), ours(from + 2), ours(from + 3));
    if (!isOurs()) wxyz.stableNormalize();
    Vector3d three = wxyz.tail<3>();
    if (body.w >= 0) {
      put(body.w, wxyz[0]);
      first += turn == Turn::kWxyz ? 1 : 0;
    } else if (turn == Turn::kRotationVector) {
      const double sine = three.stableNorm(), angle = 2 * std::atan2(sine, std::abs(wxyz[0]));
      if (sine > 0) three *= std::copysign(angle, wxyz[0]) / sine;
    } else {
      const Matrix3d R = turnOf(state, from);
      three = scene::rollPitchYaw(R, [](double y, double x) { return std::atan2(y, x); });
    }
    for (int k = 0; k < 3; ++k) put(first + k, three[k]);
  }
  return q;
}

std::vector<double> Coordinates::sorted(const scene::State<double>& state,
                                        const std::vector<double>& x, bool to_theirs) const {
  const Layout& layout = layoutOf(convention_);
  std::vector<double> turned = x, out(x.size());
  if (!to_theirs)
    for (std::size_t k = 0; k < x.size(); ++k) turned[static_cast<std::size_t>(places_[k])] = x[k];
  for (const Body& body : bodies_) {
    if (!layout.v_in_joint_axes && !layout.w_in_joint_axes) break;
    const Matrix3d R = turnOf(state, body.slot + (body.floats ? 3 : 0));
    for (int part = 0; part < (body.floats ? 2 : 1); ++part) {
      if (!(body.floats && part == 0 ? layout.v_in_joint_axes : layout.w_in_joint_axes)) continue;
      Eigen::Map<Vector3d> vector(&turned[static_cast<std::size_t>(body.rate + 3 * part)]);
      vector = ((to_theirs ? R : Matrix3d(R.transpose())) * vector).eval();
    }
  }
  if (!to_theirs) return turned;
  for (std::size_t k = 0; k < x.size(); ++k) out[k] = turned[static_cast<std::size_t>(places_[k])];
  return out;
}

std::vector<double> Coordinates::theirs(const scene::State<double>& state,
                                        const std::vector<double>& x) const {
  return sorted(state, x, true);
}
std::vector<double> Coordinates::ours(const scene::State<double>& state,
                                      const std::vector<double>& x) const {
  return sorted(state, x, false);
}

std::vector<double> Coordinates::turning(const scene::State<double>& state) const {
  std::vector<double> out(state.qd.size(), 0.0);
  if (!layoutOf(convention_).v_in_joint_axes) return out;
  for (const Body& body : bodies_) {
    if (!body.floats) continue;
    const auto at = static_cast<std::size_t>(body.rate);
    const Eigen::Map<const Vector3d> v(&state.qd[at]), w(&state.qd[at + 3]);
    Eigen::Map<Vector3d> gained(&out[at]);
    gained = w.cross(v);
  }
  return out;
}

}  // namespace dynwitness::crosscheck
