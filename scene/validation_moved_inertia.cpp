// SPDX-License-Identifier: GPL-3.0-or-later
// Whether every joint moves inertia, without which forward dynamics is singular.
#include <limits>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "scene/mimic.hpp"
#include "scene/validator.hpp"

namespace dynwitness::scene::validation {

/** movesInertia() in doubles, which for a row of 1000 fixed links are a thousand times faster: true
    where that is certain. n links and their frames add up in at most 1024 n roundings of the unit u
    = 2^-53, each relative to `scale`, and the smallest eigenvalue of the block must exceed what
    these can do to it. */
bool Validator::surelyMovesInertia(std::size_t leaf) {
  const std::vector<Link>& links = mechanism_.links;
  const auto real = [](const Rational& x) { return Exact{x, 0}.toDouble(); };
  const auto vectorOf = [&](const RationalVector& v) {
    return Eigen::Vector3d(real(v[0]), real(v[1]), real(v[2]));
  };
  const auto number = [this](const Number& n) { return exactValue(n, values_, file_).toDouble(); };
  const auto placed = [&](Eigen::Isometry3d X, const std::vector<Step>& steps) {
    for (const Step& step : steps) {
      const Vector& t = step.translation;
      if (step.kind == Step::Kind::kTranslate) {
        X.translate(Eigen::Vector3d(number(t[0]), number(t[1]), number(t[2])));
      } else {
        const int axis = step.kind == Step::Kind::kRotateX   ? 0
                         : step.kind == Step::Kind::kRotateY ? 1
                                                             : 2;
        X.rotate(Eigen::AngleAxisd(number(step.angle), Eigen::Vector3d::Unit(axis)));
      }
    }
    return X;
  };
  std::vector<std::pair<std::size_t, Eigen::Isometry3d>> to_visit = {
      {leaf, placed(Eigen::Isometry3d::Identity(), links[leaf].joint.placement.afterJoint())}};
  double mass = 0, size = 0, count = 0;
  Eigen::Vector3d h = Eigen::Vector3d::Zero();
  Eigen::Matrix3d I = Eigen::Matrix3d::Zero();
  for (; !to_visit.empty(); ++count) {
    const auto [i, X] = to_visit.back();
    to_visit.pop_back();
    for (int child = first_child_[i]; child >= 0;
         child = next_child_[static_cast<std::size_t>(child)]) {
      const Placement& placement = links[static_cast<std::size_t>(child)].joint.placement;
      to_visit.push_back({static_cast<std::size_t>(child),
                          placed(placed(X, placement.beforeJoint()), placement.afterJoint())});
    }
    const Body& b = bodies_[i];
    const double m = real(b.mass);
    const Eigen::Vector3d p = X * vectorOf(b.com);
    Eigen::Matrix3d I_b;
    for (Eigen::Index k = 0; k < 3; ++k)
      I_b.row(k) = vectorOf(b.inertia[static_cast<std::size_t>(k)]);
    if (b.turn) {
      Placement turn;
      turn.rpy = *b.turn;
      const Eigen::Matrix3d R = placed(Eigen::Isometry3d::Identity(), turn.beforeJoint()).linear();
      I_b = (R * I_b * R.transpose()).eval();
    }
    mass += m;
    h += m * p;
    I += X.linear() * I_b * X.linear().transpose() +
         m * (p.squaredNorm() * Eigen::Matrix3d::Identity() - p * p.transpose());
    size += m * p.squaredNorm() + I_b.trace();
  }
  const std::vector<Twist> motions = motionsOf(links[leaf].joint);
  const auto n = static_cast<Eigen::Index>(motions.size());
  Eigen::MatrixXd block(n, n);
  double scale = 0;
  for (Eigen::Index l = 0; l < n; ++l) {
    const Eigen::Vector3d v = vectorOf(motions[static_cast<std::size_t>(l)].v),
                          w = vectorOf(motions[static_cast<std::size_t>(l)].w);
    const Eigen::Vector3d linear = mass * v + w.cross(h), angular = h.cross(v) + I * w;
    for (Eigen::Index k = 0; k < n; ++k)
      block(k, l) = vectorOf(motions[static_cast<std::size_t>(k)].v).dot(linear) +
                    vectorOf(motions[static_cast<std::size_t>(k)].w).dot(angular);
    scale += v.squaredNorm() * mass + w.squaredNorm() * size;
  }
  constexpr double kUnit = std::numeric_limits<double>::epsilon() / 2;
  return block.selfadjointView<Eigen::Lower>().eigenvalues()[0] >
         1024 * count * kUnit * scale * static_cast<double>(n);
}

/** Whether every motion of a joint that carries no other moving joint moves mass: the joint's own
    block of M is positive definite. (Of a universal joint only the outer axis is looked at: whether
    the inner one moves mass depends on the position.) */
bool Validator::movesInertia(std::size_t leaf) {
  const std::vector<Link>& links = mechanism_.links;
  const Joint& joint = links[leaf].joint;
  is_exact_ = true;

  // the link and what is fixed to it as one body, in the joint frame
  struct Placed {
    std::size_t link;
    Frame in_joint;  // the link's frame, seen from the joint's
  };
  std::vector<Placed> to_visit = {{leaf, frame(joint.placement.afterJoint())}};
  Rational mass = 0, size = 0;  // size: what rounding in the moments of inertia is relative to
  RationalVector h{0, 0, 0};
  RationalMatrix I{{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
  while (!to_visit.empty()) {
    const auto [i, in_joint] = to_visit.back();
    to_visit.pop_back();
    for (int child = first_child_[i]; child >= 0;
         child = next_child_[static_cast<std::size_t>(child)]) {
      const Placement& placement = links[static_cast<std::size_t>(child)].joint.placement;
      to_visit.push_back(
          {static_cast<std::size_t>(child),
           shortened(in_joint * frame(placement.beforeJoint()) * frame(placement.afterJoint()))});
    }
    const Body& b = inLinkAxes(i);
    is_exact_ = is_exact_ && b.is_exact;
    const Frame com = in_joint * Frame{identity(), b.com};
    const RationalMatrix turned = com.R * b.inertia * transpose(com.R);
    const Rational p2 = dot(com.p, com.p);
    mass = shortened(mass + b.mass);
    size = shortened(size + b.mass * p2 + b.inertia[0][0] + b.inertia[1][1] + b.inertia[2][2]);
    for (std::size_t k = 0; k < 3; ++k) {
      h[k] = shortened(h[k] + b.mass * com.p[k]);
      for (std::size_t l = 0; l < 3; ++l)
        I[k][l] = shortened(I[k][l] + turned[k][l] +
                            b.mass * ((k == l ? p2 : Rational(0)) - com.p[k] * com.p[l]));
    }
  }

  const std::vector<Twist> motions = motionsOf(joint);
  const std::size_t n = motions.size();
  std::vector<std::vector<Rational>> block(n, std::vector<Rational>(n));
  Rational scale = 0;
  for (std::size_t l = 0; l < n; ++l) {
    const auto& [v, w] = motions[l];
    const RationalVector w_h = cross(w, h), h_v = cross(h, v), I_w = I * w;
    RationalVector linear, angular;
    for (std::size_t k = 0; k < 3; ++k) {
      linear[k] = mass * v[k] + w_h[k];
      angular[k] = h_v[k] + I_w[k];
    }
    for (std::size_t k = 0; k < n; ++k)
      block[k][l] = dot(motions[k].v, linear) + dot(motions[k].w, angular);
    scale += dot(v, v) * mass + dot(w, w) * size;
  }
  for (std::size_t j = 0; j < n; ++j) {  // eliminated column by column: all pivots are positive
    if (!(block[j][j] > slack(scale))) return false;
    for (std::size_t i = j + 1; i < n; ++i)
      for (std::size_t k = j + 1; k < n; ++k)
        block[i][k] -= block[i][j] * block[j][k] / block[j][j];
  }
  return true;
}

/// The motions of a joint that span what it can do, in the axes of the moved joint frame.
std::vector<Twist> Validator::motionsOf(const Joint& joint) {
  const RationalVector zero{0, 0, 0};
  const RationalMatrix e = identity();
  const bool along_z = joint.placement.convention != Placement::Convention::kXyzRpy;
  const RationalVector u = along_z ? e[2] : vector(joint.axis);
  switch (joint.kind) {
    case JointKind::kFixed:
      return {};
    case JointKind::kRevolute:
      return {{zero, u}};
    case JointKind::kPrismatic:
      return {{u, zero}};
    case JointKind::kHelical: {
      const Rational pitch = value(joint.pitch);
      return {{{pitch * u[0], pitch * u[1], pitch * u[2]}, u}};
    }
    case JointKind::kCylindrical:
      return {{u, zero}, {zero, u}};
    case JointKind::kUniversal:
      return {{zero, e[1]}};
    case JointKind::kPlanar: {
      const RationalVector across = cross(u, u[0] == 0 && u[1] == 0 ? e[0] : e[2]);
      return {{across, zero}, {cross(u, across), zero}, {zero, u}};
    }
    case JointKind::kSpherical:
      return {{zero, e[0]}, {zero, e[1]}, {zero, e[2]}};
    case JointKind::kFloating:
      return {{e[0], zero}, {e[1], zero}, {e[2], zero}, {zero, e[0]}, {zero, e[1]}, {zero, e[2]}};
  }
  throw std::logic_error("motionsOf: unknown joint kind");
}

/** A joint that moves no inertia leaves a zero on the diagonal of M: forward dynamics is singular
   in every state. (That M is singular in some states, or for two joints together, is not looked for
    here.) Of joints that follow each other one that moves inertia is enough.
    @param asked  what cannot be answered then; "": anything */
void Validator::requireInertiaOutboard(const std::string& asked) {
  const std::vector<Link>& links = mechanism_.links;
  std::vector<bool> carries_mass(links.size(), false), carries_joint(links.size(), false);
  first_child_.assign(links.size(), -1);
  next_child_.assign(links.size(), -1);
  for (std::size_t i = 1; i < links.size(); ++i) {
    int& first = first_child_[static_cast<std::size_t>(links[i].parent)];
    next_child_[i] = first;
    first = static_cast<int>(i);
  }
  std::vector<std::size_t> leader(links.size());
  for (std::size_t i = 0; i < links.size(); ++i) leader[i] = i;
  for (const Follower& f : followers(mechanism_))
    leader[f.link] = static_cast<std::size_t>(f.leader);
  std::map<std::size_t, std::vector<std::pair<std::size_t, std::string>>> idle;  // by leader
  std::map<std::size_t, std::size_t> members;
  for (std::size_t i = links.size(); i-- > 1;) {
    const Link& link = links[i];
    const auto parent = static_cast<std::size_t>(link.parent);
    if (bodies_[i].mass > 0) carries_mass[i] = true;
    if (carries_mass[i]) carries_mass[parent] = true;
    const bool moves = degreesOfFreedom(link.joint.kind) > 0;
    if (moves || carries_joint[i]) carries_joint[parent] = true;
    if (!moves) continue;
    ++members[leader[i]];
    if (value(link.joint.rotor_inertia) > 0) continue;
    if (!carries_mass[i]) {
      idle[leader[i]].emplace_back(
          i,
          "nothing that it carries has mass and it has no rotor_inertia, so forward "
          "dynamics is singular, allowed: a mass, or a rotor_inertia");
      continue;
    }
    if (carries_joint[i] || surelyMovesInertia(i) || movesInertia(i)) continue;
    if (degreesOfFreedom(link.joint.kind) > 1) {
      idle[leader[i]].emplace_back(
          i, std::string("is ") + name(link.joint.kind) +
                 ", and some of its motions move no inertia, so forward dynamics is "
                 "singular, allowed: a link with inertia about every axis of the joint");
      continue;
    }
    idle[leader[i]].emplace_back(
        i,
        "what it carries has no inertia about the joint's axis and it has no "
        "rotor_inertia, so forward dynamics is singular, allowed: inertia about the "
        "axis, or a rotor_inertia");
  }
  for (auto group = idle.rbegin(); group != idle.rend(); ++group)
    if (group->second.size() == members[group->first])
      failJoint(links[group->second.front().first],
                (asked.empty() ? "" : asked + " asked, and ") + group->second.front().second);
}

}  // namespace dynwitness::scene::validation
