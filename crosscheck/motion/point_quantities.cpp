// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/point_quantities.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "recursive/build_model.hpp"
#include "recursive/point_motion.hpp"
#include "scene/turn.hpp"
#include "scene/units.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr std::array<const char*, 8> kPointNames = {"position", "orientation",  "quaternion",
                                                    "rpy",      "velocity",     "acceleration",
                                                    "jacobian", "jacobian_rate"};
constexpr std::array<const char*, 6> kOfMotion = {"vx", "vy", "vz", "wx", "wy", "wz"};

bool isJacobian(PointQuantity quantity) {
  return quantity == PointQuantity::kJacobian || quantity == PointQuantity::kJacobianRate;
}

/// What stands behind "hand." for each number, row by row.
std::vector<std::string> endings(PointQuantity quantity, Eigen::Index rates) {
  const std::string of = name(quantity);
  std::vector<std::string> out;
  const auto add = [&](std::initializer_list<const char*> parts) {
    for (const char* part : parts) out.push_back(of + "_" + part);
  };
  switch (quantity) {
    case PointQuantity::kPosition:
      add({"x", "y", "z"});
      break;
    case PointQuantity::kOrientation:
      for (int i = 1; i <= 3; ++i)
        for (int j = 1; j <= 3; ++j) out.push_back(fmt::format("{}{}{}", of, i, j));
      break;
    case PointQuantity::kQuaternion:
      add({"w", "x", "y", "z"});
      break;
    case PointQuantity::kRpy:
      add({"roll", "pitch", "yaw"});
      break;
    default:
      for (const char* row : kOfMotion)
        for (Eigen::Index j = 1; j <= (isJacobian(quantity) ? rates : 1); ++j)
          out.push_back(isJacobian(quantity) ? fmt::format("{}_{}_qd{}", of, row, j)
                                             : fmt::format("{}_{}", of, row));
  }
  return out;
}

Eigen::VectorXd byRows(const Eigen::MatrixXd& m) {
  const Eigen::MatrixXd transposed = m.transpose();
  return transposed.reshaped();
}

}  // namespace

const char* name(PointQuantity quantity) {
  return kPointNames[static_cast<std::size_t>(quantity)];
}

std::optional<PointQuantity> pointQuantityNamed(const std::string& text) {
  const auto found = std::find(kPointNames.begin(), kPointNames.end(), text);
  if (found == kPointNames.end()) return std::nullopt;
  return static_cast<PointQuantity>(found - kPointNames.begin());
}

std::vector<std::string> pointQuantityNames() {
  return {kPointNames.begin(), kPointNames.end()};
}

struct PointQuantities::Parts {
  Parts(const scene::Scene& scene, const std::vector<FramePoint>& of, JointAxes in)
      : model(recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism))),
        ws(model),
        axes(in),
        points(of) {
    for (std::size_t i = 1; of.empty() && i < scene.mechanism.links.size(); ++i)
      points.push_back({static_cast<int>(i)});
    for (auto point = points.begin(); point != points.end(); ++point) {
      const auto same = [&](const FramePoint& other) { return other.link == point->link; };
      const auto earlier = std::count_if(points.begin(), point, same);
      const std::string& link = scene.mechanism.links[static_cast<std::size_t>(point->link)].name;
      names.push_back(earlier == 0 ? link : fmt::format("{}#{}", link, earlier + 1));
    }
  }

  recursive::Model<double> model;
  recursive::Workspace<double> ws;
  JointAxes axes;
  std::vector<FramePoint> points;
  std::vector<std::string> names;
  std::vector<recursive::PointMotion<double>> motions;
};

PointQuantities::PointQuantities(const scene::Scene& scene, const std::vector<FramePoint>& points,
                                 JointAxes axes) {
  if (axes == JointAxes::kJoint)
    throw std::invalid_argument("points have axes of the world or of their link, not of a joint");
  parts_ = std::make_unique<Parts>(scene, points, axes);
}
PointQuantities::~PointQuantities() = default;

std::vector<std::string> PointQuantities::columns(PointQuantity quantity) const {
  std::vector<std::string> out;
  for (const std::string& name : parts_->names)
    for (const std::string& ending : endings(quantity, parts_->model.dof()))
      out.push_back(name + "." + ending);
  return out;
}

std::vector<std::string> PointQuantities::units(PointQuantity quantity) const {
  std::vector<bool> slides(static_cast<std::size_t>(parts_->model.dof()), false);
  for (const recursive::LinkModel<double>& link : parts_->model.links)
    for (int k = 0; k < recursive::axisCount(link.kind); ++k)
      if (!link.follows)
        slides[static_cast<std::size_t>(link.dof + k)] =
            scene::slides(link.kind, static_cast<std::size_t>(k));
  std::vector<std::string> one;
  const std::string per = quantity == PointQuantity::kAcceleration ? "/s^2" : "/s";
  switch (quantity) {
    case PointQuantity::kPosition:
      one.assign(3, "m");
      break;
    case PointQuantity::kOrientation:
    case PointQuantity::kQuaternion:
      one.assign(endings(quantity, 0).size(), "1");
      break;
    case PointQuantity::kRpy:
      one.assign(3, "rad");
      break;
    case PointQuantity::kVelocity:
    case PointQuantity::kAcceleration:
      for (int row = 0; row < 6; ++row) one.push_back((row < 3 ? "m" : "rad") + per);
      break;
    default:  // m/rad, m/m, rad/rad, rad/m, of a rate of J a second
      for (int row = 0; row < 6; ++row)
        for (const bool slide : slides) {
          const bool rate = quantity == PointQuantity::kJacobianRate;
          if ((row < 3) == slide)
            one.emplace_back(rate ? "1/s" : "1");
          else
            one.emplace_back(row < 3 ? (rate ? "m/s" : "m") : (rate ? "1/(m s)" : "1/m"));
        }
  }
  std::vector<std::string> out;
  for (std::size_t k = 0; k < parts_->points.size(); ++k)
    out.insert(out.end(), one.begin(), one.end());
  return out;
}

void PointQuantities::at(const scene::State<double>& state) {
  Parts& p = *parts_;
  const auto n = static_cast<std::size_t>(p.model.dof());
  const std::vector<double> qdd = state.qdd.size() == n ? state.qdd : std::vector<double>(n, 0.0);
  p.motions.clear();
  for (const FramePoint& point : p.points) {
    p.motions.push_back(recursive::pointMotion<double>(
        p.model, state.x, state.qd, qdd, static_cast<std::size_t>(point.link), point.at, p.ws));
    if (p.axes == JointAxes::kWorld) continue;
    recursive::PointMotion<double>& motion = p.motions.back();
    recursive::Matrix6<double> turn = recursive::Matrix6<double>::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = motion.R.transpose();
    const auto turned = [&](const recursive::Motion<double>& m) {
      return recursive::Motion<double>{motion.R.transpose() * m.linear,
                                       motion.R.transpose() * m.angular};
    };
    motion.velocity = turned(motion.velocity);
    motion.acceleration = turned(motion.acceleration);
    motion.J = (turn * motion.J).eval();
    motion.J_rate = (turn * motion.J_rate).eval();
  }
}

Eigen::VectorXd PointQuantities::value(PointQuantity quantity) const {
  const auto of = [&](const recursive::PointMotion<double>& motion) -> Eigen::VectorXd {
    switch (quantity) {
      case PointQuantity::kPosition:
        return motion.position;
      case PointQuantity::kOrientation:
        return byRows(motion.R);
      case PointQuantity::kQuaternion: {
        Eigen::Quaterniond q(motion.R);
        q.normalize();
        const double sign = q.w() < 0 ? -1 : 1;
        return Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()) * sign;
      }
      case PointQuantity::kRpy:
        return scene::rollPitchYaw<double>(motion.R,
                                           [](double y, double x) { return std::atan2(y, x); });
      case PointQuantity::kVelocity:
        return motion.velocity.vector();
      case PointQuantity::kAcceleration:
        return motion.acceleration.vector();
      case PointQuantity::kJacobian:
        return byRows(motion.J);
      case PointQuantity::kJacobianRate:
        return byRows(motion.J_rate);
    }
    return {};
  };
  const auto each = static_cast<Eigen::Index>(endings(quantity, parts_->model.dof()).size());
  Eigen::VectorXd out(each * static_cast<Eigen::Index>(parts_->motions.size()));
  Eigen::Index at = 0;
  for (const recursive::PointMotion<double>& motion : parts_->motions) {
    out.segment(at, each) = of(motion).array() + 0.0;  // not -0
    at += each;
  }
  return out;
}

}  // namespace dynwitness::crosscheck
