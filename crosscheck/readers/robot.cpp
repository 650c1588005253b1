// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/readers/robot.hpp"

#include <algorithm>
#include <limits>

#include <boost/math/constants/constants.hpp>

#include "crosscheck/inputs/states.hpp"

namespace dynwitness::crosscheck {
using Eigen::Matrix3d;
using Eigen::Vector3d;

double roundingOf(int frames) {
  return std::numeric_limits<double>::epsilon() / 2 * kRoundingsOfFrame * (frames + 1.0);
}

bool hasOnePosition(const ReadBody& body) {
  return body.kind == scene::JointKind::kRevolute || body.kind == scene::JointKind::kPrismatic;
}
bool allHaveOnePosition(const Robot& robot) {
  return std::all_of(robot.bodies.begin(), robot.bodies.end(), hasOnePosition);
}

Matrix3d lever(const Vector3d& c) {
  return c.squaredNorm() * Matrix3d::Identity() - c * c.transpose();
}

MassMoments MassMoments::of(double mass, const Vector3d& com, const Matrix3d& about_com) {
  return {mass, mass * com, about_com + mass * lever(com),
          about_com.cwiseAbs().trace() + std::abs(mass) * com.squaredNorm()};
}

MassMoments& MassMoments::operator+=(const MassMoments& other) {
  mass += other.mass;
  first += other.first;
  second += other.second;
  reach2 += other.reach2;
  return *this;
}

Vector3d MassMoments::com() const {
  return mass == 0 ? Vector3d::Zero() : Vector3d(first / mass);
}

Matrix3d MassMoments::aboutCom() const {
  return second - mass * lever(com());
}

MassMoments MassMoments::movedBy(const Eigen::Isometry3d& X) const {
  const Matrix3d R = X.linear();
  MassMoments out = of(mass, X * com(), R * aboutCom() * R.transpose());
  if (mass == 0) out.first = R * first;
  out.reach2 = reach2 + mass * X.translation().squaredNorm();
  return out;
}

int Robot::indexOf(const std::string& link) const {
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].link == link) return static_cast<int>(i);
  return -1;
}

std::vector<Eigen::Isometry3d> Robot::placements() const {
  std::vector<Eigen::Isometry3d> out;
  for (const ReadBody& body : bodies)
    out.push_back(body.parent < 0 ? body.placement
                                  : out[static_cast<std::size_t>(body.parent)] * body.placement);
  return out;
}

std::vector<int> Robot::depths() const {
  std::vector<int> out;
  for (const ReadBody& body : bodies)
    out.push_back(body.parent < 0 ? 1 : out[static_cast<std::size_t>(body.parent)] + 1);
  return out;
}

MassAndGravity massAndGravity(const Robot& robot, const std::vector<double>& q) {
  const auto n = static_cast<Eigen::Index>(robot.bodies.size());
  MassAndGravity out{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n),
                     Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  struct Moved {
    Eigen::Isometry3d X;
    Vector3d axis;
    double reach;  // sum of all levers from the world to here
    int depth;
  };
  std::vector<Moved> moved;
  // engines gather forces about the tree's centre of mass, which other branches may put far away
  double far = 0;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const ReadBody& body = robot.bodies[i];
    far += body.placement.translation().norm() + body.moments.com().norm() +
           (body.kind == scene::JointKind::kPrismatic ? std::abs(q[i]) * body.axis.norm() : 0);
  }
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const ReadBody& body = robot.bodies[i];
    const Moved* parent = body.parent < 0 ? nullptr : &moved[static_cast<std::size_t>(body.parent)];
    Eigen::Isometry3d X = (parent ? parent->X : Eigen::Isometry3d::Identity()) * body.placement;
    const Vector3d axis = X.linear() * body.axis;
    double reach = (parent ? parent->reach : 0) + body.placement.translation().norm();
    if (body.kind == scene::JointKind::kRevolute)
      X.rotate(Eigen::AngleAxisd(q[i] * body.axis.norm(), body.axis.normalized()));
    if (body.kind == scene::JointKind::kPrismatic) {
      X.translate(q[i] * body.axis);
      reach += std::abs(q[i]) * body.axis.norm();
    }
    moved.push_back({X, axis, reach, parent ? parent->depth + 1 : 1});

    // every joint from here to the world feels this body
    const MassMoments& m = body.moments;
    const Vector3d com = X * m.com();
    const Matrix3d I = X.linear() * m.aboutCom() * X.linear().transpose();
    const double lever = far + reach + (m.mass == 0 ? 0 : m.first.norm() / std::abs(m.mass));
    struct Column {
      Eigen::Index joint;
      Vector3d v, w;
      double v_size;
    };
    std::vector<Column> columns;
    for (int j = static_cast<int>(i); j >= 0;
         j = robot.bodies[static_cast<std::size_t>(j)].parent) {
      const Moved& at = moved[static_cast<std::size_t>(j)];
      const scene::JointKind kind = robot.bodies[static_cast<std::size_t>(j)].kind;
      if (kind == scene::JointKind::kRevolute)
        columns.push_back(
            {j, at.axis.cross(com - at.X.translation()), at.axis, at.axis.norm() * lever});
      else if (kind == scene::JointKind::kPrismatic)
        columns.push_back({j, at.axis, Vector3d::Zero(), at.axis.norm()});
    }
    const double unit = roundingOf(moved.back().depth);
    for (const Column& a : columns) {
      out.g[a.joint] -= m.mass * a.v.dot(robot.gravity);
      out.g_bound[a.joint] += unit * std::abs(m.mass) * a.v_size * robot.gravity.norm();
      for (const Column& b : columns) {
        out.M(a.joint, b.joint) += m.mass * a.v.dot(b.v) + a.w.dot(I * b.w);
        out.M_bound(a.joint, b.joint) +=
            unit * (std::abs(m.mass) * a.v_size * b.v_size + a.w.norm() * m.reach2 * b.w.norm());
      }
    }
  }
  for (Eigen::Index i = 0; i < n; ++i)
    out.M(i, i) += robot.bodies[static_cast<std::size_t>(i)].armature;
  return out;
}

std::vector<double> drawPositions(const Robot& robot, std::uint64_t seed, std::uint64_t index) {
  RandomStream random("readers", seed, index);
  const double pi = boost::math::constants::pi<double>();
  std::vector<double> q;
  for (const ReadBody& body : robot.bodies)
    q.push_back(body.kind == scene::JointKind::kPrismatic ? random.uniform(-1, 1)
                                                          : random.uniform(-pi, pi));
  return q;
}

}  // namespace dynwitness::crosscheck
