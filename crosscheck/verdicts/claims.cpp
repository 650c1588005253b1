// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/claims.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "crosscheck/verdicts/tally.hpp"
#include "crosscheck/witnesses/told_numbers.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr double u = std::numeric_limits<double>::epsilon() / 2;
using Real = ToldNumbers::Real;
using Vector3 = ToldNumbers::Vector3;
using Matrix3 = ToldNumbers::Matrix3;
using Frame = ToldNumbers::Frame;

/// A link as a part of a body, in the axes of that body's frame.
struct Part {
  Frame frame;
  int turns = 0;     ///< from the link to there
  double lever = 0;  ///< besides that of the centre of mass: from its joint to its origin
  ToldNumbers::Inertia inertia;
};

Matrix3 pointMass(Real mass, const Vector3& r) {
  return mass * (r.squaredNorm() * Matrix3::Identity() - r * r.transpose());
}

/// Mass, com, and the six of the inertia, as parameters are listed; and how far they may be off.
constexpr int kNumbers = 10;
struct Body {
  Eigen::VectorXd values, limits;
};
constexpr struct {
  const char *name, *unit;
} kParameters[kNumbers] = {
    {"mass", "kg"},    {"com x", "m"},    {"com y", "m"},    {"com z", "m"},    {"Ixx", "kg m^2"},
    {"Iyy", "kg m^2"}, {"Izz", "kg m^2"}, {"Ixy", "kg m^2"}, {"Ixz", "kg m^2"}, {"Iyz", "kg m^2"},
};

Body bodyOf(const std::vector<Part>& parts) {
  const double k = static_cast<double>(parts.size());
  Real mass = 0;
  Vector3 moment = Vector3::Zero();
  double weights = 0, moments = 0, inertias = 0;
  int turns = 0;
  for (const Part& part : parts) {
    const Real m = part.inertia.mass;
    mass += m;
    moment += m * (part.frame.p + part.frame.R * part.inertia.com);
    const auto size = static_cast<double>(std::abs(m));
    const double lever =
        static_cast<double>(part.frame.p.norm() + part.inertia.com.norm()) + part.lever;
    const double s = part.turns;
    weights += size;
    moments += size * lever;
    inertias += (78 + 28 * s + k) * u * static_cast<double>(part.inertia.I.norm()) +
                (32 + 28 * s + 3 * k) * u * size * lever * lever;
    turns = std::max(turns, part.turns);
  }
  const Vector3 com = mass == 0 ? Vector3(Vector3::Zero()) : Vector3(moment / mass);
  Matrix3 I = Matrix3::Zero();
  for (const Part& part : parts) {
    const Vector3 r = part.frame.p + part.frame.R * part.inertia.com - com;
    I += part.frame.R * part.inertia.I * part.frame.R.transpose() + pointMass(part.inertia.mass, r);
  }
  Body out;
  out.values.resize(kNumbers);
  out.values << static_cast<double>(mass), static_cast<double>(com(0)), static_cast<double>(com(1)),
      static_cast<double>(com(2)), static_cast<double>(I(0, 0)), static_cast<double>(I(1, 1)),
      static_cast<double>(I(2, 2)), static_cast<double>(I(0, 1)), static_cast<double>(I(0, 2)),
      static_cast<double>(I(1, 2));
  out.limits.resize(kNumbers);
  out.limits(0) = (k + 1) * u * weights;
  // where nothing weighs anything, the centre of it is nowhere
  out.limits.segment<3>(1).setConstant(weights == 0
                                           ? std::numeric_limits<double>::infinity()
                                           : (10 + 14 * turns + k) * u * moments / weights);
  out.limits.tail<6>().setConstant(inertias);
  return out;
}

/// Links that fixed joints hold together, and what is told of them.
class Comparison {
 public:
  Comparison(const scene::Mechanism& mechanism, const std::vector<BelievedLink>& told,
             double factor)
      : mechanism_(mechanism), number_(mechanism), factor_(factor) {
    told_.resize(mechanism.links.size(), nullptr);
    for (const BelievedLink& link : told) told_[static_cast<std::size_t>(link.link)] = &link;
  }

  ModelFound found() {
    for (std::size_t i = 0; i < mechanism_.links.size(); ++i) {
      const scene::Link& link = mechanism_.links[i];
      if (link.parent >= 0 && link.joint.kind != scene::JointKind::kFixed)
        compareBody(static_cast<int>(i));
    }
    return std::move(out_);
  }

 private:
  struct Numbers {
    std::string link;
    Eigen::VectorXd said;
    Body scene;
  };

  /// A link below `base`, on fixed joints.
  Part partOf(int link, int base) const {
    Part part;
    for (int i = link; i != base; i = at(i).parent) {
      const scene::Placement& placement = at(i).joint.placement;
      part.frame = number_.frame(placement.beforeJoint()) * number_.frame(placement.afterJoint()) *
                   part.frame;
      ++part.turns;
    }
    ++part.turns;  // its joint's axes in place of its own
    part.lever = static_cast<double>(number_.frame(at(link).joint.placement.afterJoint()).p.norm());
    part.inertia = number_.inertia(at(link).inertia);
    return part;
  }
  static ToldNumbers::Inertia inertiaOf(const BelievedLink& told) {
    return {told.mass, told.com.cast<Real>(), told.inertia.cast<Real>()};
  }
  static Eigen::VectorXd numbersOf(const BelievedLink& told) {
    const Eigen::Matrix3d& I = told.inertia;
    Eigen::VectorXd out(kNumbers);
    out << told.mass, told.com, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2);
    return out;
  }

  bool differ(const Eigen::VectorXd& said, const Body& scene) const {
    return !((said - scene.values).cwiseAbs().array() <= factor_ * scene.limits.array()).all();
  }

  void compareBody(int root) {
    std::vector<int> members = {root};
    for (std::size_t i = static_cast<std::size_t>(root) + 1; i < mechanism_.links.size(); ++i) {
      const scene::Link& link = mechanism_.links[i];
      if (link.joint.kind == scene::JointKind::kFixed &&
          std::find(members.begin(), members.end(), link.parent) != members.end())
        members.push_back(static_cast<int>(i));
    }
    // who tells of a link: itself, or the one inboard
    std::vector<Numbers> compared;
    std::string merged;
    std::vector<int> missing;
    for (const int i : members) {
      if (toldBy(i, root) < 0 && weighs(i)) missing.push_back(i);
      if (told_[static_cast<std::size_t>(i)] == nullptr) continue;
      std::vector<Part> parts;
      for (const int k : members)
        if (toldBy(k, root) == i) parts.push_back(partOf(k, i));
      if (parts.size() > 1) merged += (merged.empty() ? "" : ", ") + ("'" + at(i).name + "'");
      compared.push_back(
          {at(i).name, numbersOf(*told_[static_cast<std::size_t>(i)]), bodyOf(parts)});
    }
    const bool agrees =
        missing.empty() && std::none_of(compared.begin(), compared.end(), [&](const Numbers& one) {
          return differ(one.said, one.scene);
        });
    if (!agrees) {
      std::vector<Part> theirs, ours;
      for (const int i : members) {
        ours.push_back(partOf(i, root));
        if (told_[static_cast<std::size_t>(i)] == nullptr) continue;
        theirs.push_back(ours.back());
        theirs.back().inertia = inertiaOf(*told_[static_cast<std::size_t>(i)]);
      }
      const Body whole = bodyOf(ours);
      const Eigen::VectorXd said = bodyOf(theirs).values;
      if (members.size() > 1 && !theirs.empty() && !differ(said, whole)) {
        merged = "'" + at(root).name + "'";
        missing.clear();
        compared = {{at(root).name, said, whole}};
      }
    }
    if (!merged.empty())
      out_.merged.push_back(
          fmt::format("keeps link {} and what fixed joints hold there as one body", merged));
    for (const int i : missing) {
      const double mass = bodyOf({partOf(i, i)}).values(0);
      out_.differences.push_back({at(i).name, "", "kg", 0, mass, 0});
    }
    for (const Numbers& one : compared) add(one);
  }

  static void append(Eigen::VectorXd& list, double x) {
    list.conservativeResize(list.size() + 1);
    list(list.size() - 1) = x;
  }
  void add(const Numbers& one) {
    for (Eigen::Index k = 0; k < kNumbers; ++k) {
      const double said = one.said(k), scene = one.scene.values(k),
                   limit = factor_ * one.scene.limits(k);
      if (!std::isfinite(limit)) continue;
      append(out_.said, said);
      append(out_.scene, scene);
      append(out_.limit, limit);
      if (std::abs(said - scene) <= limit) continue;
      out_.differences.push_back(
          {one.link, kParameters[k].name, kParameters[k].unit, said, scene, limit});
    }
  }

  const scene::Link& at(int i) const { return mechanism_.links[static_cast<std::size_t>(i)]; }
  /// -1: nobody
  int toldBy(int link, int root) const {
    for (int i = link;; i = at(i).parent) {
      if (told_[static_cast<std::size_t>(i)] != nullptr) return i;
      if (i == root) return -1;
    }
  }
  bool weighs(int link) const {
    const ToldNumbers::Inertia inertia = number_.inertia(at(link).inertia);
    return inertia.mass != 0 || inertia.I != Matrix3::Zero();
  }

  const scene::Mechanism& mechanism_;
  ToldNumbers number_;
  double factor_;
  std::vector<const BelievedLink*> told_;  ///< by link
  ModelFound out_;
};

CheckResult description(const char* law, const std::string& witness, std::string statement) {
  CheckResult check;
  check.law = check.quantity = law;
  check.left = witness;
  check.statement = std::move(statement);
  return check;
}

}  // namespace

std::string sentenceOf(const ModelDifference& d) {
  if (d.parameter.empty())
    return fmt::format("link '{}' is missing in its model, and has {:.17g} kg in the scene", d.link,
                       d.scene);
  // as few digits as tell them apart
  std::string said, scene;
  for (int digits = 6; digits <= std::numeric_limits<double>::max_digits10; ++digits) {
    said = fmt::format("{:.{}g}", d.said, digits);
    scene = fmt::format("{:.{}g}", d.scene, digits);
    if (said != scene) break;
  }
  return fmt::format("link '{}': {} is {} {} in its model and {} {} in the scene", d.link,
                     d.parameter, said, d.unit, scene, d.unit);
}

ModelFound compareModel(const scene::Mechanism& mechanism, const std::vector<BelievedLink>& links,
                        double factor) {
  return Comparison(mechanism, links, factor).found();
}

std::vector<CheckResult> judgeClaims(OutsideClaims& claims, const std::string& witness,
                                     const PreparedScene& scene,
                                     const std::vector<scene::State<double>>& states) {
  std::vector<CheckResult> out;
  const scene::Mechanism& mechanism = scene.mechanism();
  if (const auto links = claims.believedLinks()) {
    const ModelFound found = compareModel(mechanism, *links, 1);
    Tally tally(description("model", witness,
                            fmt::format("masses, centres of mass and inertias of the links, as {} "
                                        "has them, are the scene's",
                                        witness)));
    if (found.said.size() > 0) tally.add(0, found.said, found.scene, found.limit);
    CheckResult check = tally.result();
    if (!found.differences.empty()) {
      check.verdict = Verdict::kDisagree;
      check.states = 1;
      check.reason = sentenceOf(found.differences.front());
      if (found.differences.size() > 1)
        check.reason += fmt::format(", and {} numbers more", found.differences.size() - 1);
    }
    out.push_back(check);
  }
  if (claims.knowsJacobian() && !states.empty()) {
    const FramePoint point = farthestPoint(mechanism);
    const std::vector<OutsideClaims::SaidJacobian> said = claims.jacobians(point, states);
    FrameJacobian ours(scene);
    Tally tally(description("jacobian", witness,
                            fmt::format("J qd = velocity of {} in world axes, and the link's "
                                        "angular velocity",
                                        wordsOf(point, mechanism))));
    for (std::size_t k = 0; k < states.size(); ++k) {
      const int index = static_cast<int>(k);
      if (!said[k].reason.empty()) {
        tally.fail(index, said[k].reason);
        continue;
      }
      const BoundedJacobian J = ours(point, states[k]);
      tally.add(index, said[k].value, J.value, J.bound + J.engine);
    }
    out.push_back(tally.result());
  }
  return out;
}

}  // namespace dynwitness::crosscheck
