// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/rooted.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <flint/nmod_mat.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/hybrid_dynamics.hpp"
#include "scene/arrange.hpp"
#include "scene/nearest_name.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::Joint;
using scene::JointKind;
using scene::Link;
using scene::Mechanism;
using scene::Number;
using scene::Placement;
using scene::Step;

Number negative(const Number& n) {
  return n.isLiteralZero() ? Number(0) : Number::parse("-(" + n.text() + ")");
}
Number decimal(double x) {
  return Number::parse(fmt::format("{}", x == 0 ? 0.0 : x));
}

/// The same way back.
std::vector<Step> undone(std::vector<Step> steps) {
  std::reverse(steps.begin(), steps.end());
  for (Step& step : steps) {
    for (Number& n : step.translation) n = negative(n);
    step.angle = negative(step.angle);
  }
  return steps;
}

/// As frames that are moved, then turned about z, y and x: as few as it takes.
std::vector<Placement> placementsOf(const std::vector<Step>& steps) {
  const auto rank = [](Step::Kind kind) {
    return kind == Step::Kind::kTranslate ? 0
           : kind == Step::Kind::kRotateZ ? 1
           : kind == Step::Kind::kRotateY ? 2
                                          : 3;
  };
  std::vector<Placement> out;
  int last = 4;
  for (const Step& step : steps) {
    const int now = rank(step.kind);
    if (now <= last) out.emplace_back();
    if (now == 0)
      out.back().xyz = step.translation;
    else
      out.back().rpy[static_cast<std::size_t>(3 - now)] = step.angle;
    last = now;
  }
  return out;
}

/// M of the rates that no drive has, at the random state `index` of the prime field in scope.
recursive::MatrixX<PrimeField> freeMass(const scene::Scene& scene, std::uint64_t index,
                                        const std::vector<int>& free) {
  const Mechanism& m = scene.mechanism;
  const FieldSource source(scene.name, 1, index);
  const auto model = recursive::buildModel(m, FieldNumbers(m, source));
  recursive::Workspace<PrimeField> ws(model);
  recursive::MatrixX<PrimeField> M(m.dof(), m.dof());
  recursive::massMatrix(model, indeterminateState(m, source).x, ws, M);
  return M(free, free);
}

/** The rates of a motion that moves no inertia in any state; none where M of the free rates is
    regular but in some states. Decided in one random state over a random field: an entry of M turns
    an inertia twice by each joint, so that det M has degree 4 n at most in each of the numbers
    drawn (some ten a joint), and one that is not 0 everywhere is so there with a probability below
    40 n^2 / 2^62 = 1e-17 n^2 (J. T. Schwartz, J. ACM 27 (1980) 701). */
std::vector<int> idleMotion(const scene::Scene& scene) {
  std::vector<int> free;
  const std::vector<char> driven = recursive::drivenRates(scene.mechanism);
  for (std::size_t i = 0; i < driven.size(); ++i)
    if (driven[i] == 0) free.push_back(static_cast<int>(i));
  for (std::uint64_t index = 0;; ++index) {
    const PrimeField::Modulus modulus(drawPrime(scene.name, 1, index));
    try {
      const recursive::MatrixX<PrimeField> M = freeMass(scene, index, free);
      nmod_mat_t entries, kernel;
      nmod_mat_init(entries, M.rows(), M.cols(), PrimeField::modulus());
      nmod_mat_init(kernel, M.rows(), M.cols(), PrimeField::modulus());
      for (Eigen::Index i = 0; i < M.rows(); ++i)
        for (Eigen::Index j = 0; j < M.cols(); ++j)
          nmod_mat_entry(entries, i, j) = M(i, j).residue();
      std::vector<int> idle;
      if (nmod_mat_nullspace(kernel, entries) > 0)
        for (Eigen::Index i = 0; i < M.rows(); ++i)
          if (nmod_mat_entry(kernel, i, 0) != 0) idle.push_back(free[static_cast<std::size_t>(i)]);
      nmod_mat_clear(entries);
      nmod_mat_clear(kernel);
      return idle;
    } catch (const DivisionByZero&) {  // the prime divides a number of the scene: another one
    }
  }
}

/// Where a link is and how it moves, seen from a frame at rest.
struct Pose {
  Eigen::Vector3d position;
  Eigen::Quaterniond turn;
  recursive::Motion<double> twist;
};

class Rooting {
 public:
  Rooting(const scene::Scene& from, const std::string& link) : from_(from), m_(from.mechanism) {
    std::vector<std::string> names;
    for (const Link& one : m_.links) {
      names.push_back(one.name);
      links_.insert(one.name);
      joints_.insert(one.joint.name);
    }
    const auto found = std::find(names.begin(), names.end(), link);
    if (found == names.end())
      refuse(fmt::format("no link is called \"{}\"{}, allowed: {}", link,
                         scene::didYouMean(link, names), fmt::join(names, ", ")));
    for (int i = static_cast<int>(found - names.begin()); i > 0; i = m_.links[index(i)].parent)
      way_.push_back(i);
    if (way_.empty()) return;
    floats_ = m_.links[index(way_.back())].joint.kind == JointKind::kFloating;
    if (!floats_) way_.push_back(0);
    requireTurnable();
  }

  scene::Scene scene() {
    if (way_.size() < 2) return from_;  // it is where the tree starts
    const std::string& start = m_.links[index(way_[0])].name;
    scene::Scene out = from_;
    std::string name = start;
    for (char& c : name)
      if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
    out.name = from_.name + "_from_" + name;
    out.title = fmt::format("{} (its tree starts at {})", from_.title, start);
    out.file = out.name;
    out.mechanism.links = scene::arrange(hung(), from_.file.string());
    takeAlong(out.mechanism);
    putAtStart(out);
    try {
      scene::validate(out);
    } catch (const scene::InputError& error) {
      refuse(
          fmt::format("{} (\"{}\", which rested in the world, moves with the tree then, and has "
                      "to have mass and inertia: any, since it is held)",
                      error.what(), m_.links[0].name));
    }
    requireInertia(out);
    return out;
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  [[noreturn]] void refuse(const std::string& why) const {
    throw scene::InputError({from_.file.string(), 0}, "another root: " + why);
  }
  void requireTurnable() const {
    bool moves = floats_;
    for (std::size_t k = 0; k + 1 < way_.size(); ++k) {
      const Joint& joint = m_.links[index(way_[k])].joint;
      moves = moves || joint.kind != JointKind::kFixed;
      const bool is_other = joint.kind == JointKind::kUniversal ||
                            joint.kind == JointKind::kPlanar || joint.kind == JointKind::kFloating;
      if (is_other)
        refuse(
            fmt::format("joint \"{}\" is {}, and turned round has no coordinates of its kind, "
                        "allowed on the way: fixed, revolute, prismatic, helical, cylindrical "
                        "and spherical ones",
                        joint.name, scene::name(joint.kind)));
      if (!joint.rotors.empty())
        refuse(
            fmt::format("the rotors of joint \"{}\" are geared to the rates that its child has on "
                        "its parent, which turned round are others, allowed: joints without rotors "
                        "of several rates on the way",
                        joint.name));
      if (joint.gyroscopic)
        refuse(
            fmt::format("the gyroscopic rotor of joint \"{}\" would sit on its child, allowed: "
                        "rotors on the parent",
                        joint.name));
    }
    if (!moves)
      refuse(
          fmt::format("link \"{}\" rests in the world as \"{}\" does, allowed: a link that moves",
                      m_.links[index(way_[0])].name, m_.links[0].name));
  }
  /// That every motion of the new tree moves some: its coordinates are more than those of the old.
  void requireInertia(const scene::Scene& out) const {
    const std::vector<int> idle = idleMotion(out);
    if (idle.empty()) return;
    std::vector<const Link*> of_rate;
    for (const Link& link : out.mechanism.links)
      of_rate.insert(of_rate.end(), static_cast<std::size_t>(link.joint.ownRates()), &link);
    const std::vector<std::string> labels = out.mechanism.rateLabels();
    std::vector<std::string> words;
    for (const int rate : idle)
      words.push_back(
          fmt::format("{} of link \"{}\"", labels[index(rate)], movedBy(*of_rate[index(rate)])));
    refuse(fmt::format(
        "a motion of {}{} moves no inertia in any state, and M would be singular (a thin rod has "
        "none about itself), allowed: {} with inertia about every axis, or a root from which every "
        "motion moves some",
        fmt::join(words, " and "), words.size() > 1 ? " together" : " alone",
        words.size() > 1 ? "links" : "a link"));
  }
  /// The link of the scene that a link's joint moves in the new tree.
  std::string movedBy(const Link& link) const {
    for (std::size_t k = 0; k + 1 < way_.size(); ++k)
      if (m_.links[index(way_[k])].joint.name == link.joint.name)
        return m_.links[index(way_[k + 1])].name;
    return link.name;
  }
  /// A name that is not there yet.
  static std::string unused(const std::string& wanted, std::set<std::string>* names) {
    std::string name = wanted;
    for (int k = 2; names->count(name) > 0; ++k) name = fmt::format("{}.{}", wanted, k);
    names->insert(name);
    return name;
  }
  void hang(Link link, const std::string& parent) {
    named_.push_back({std::move(link), parent, {}});
  }
  /// A massless link on a fixed joint.
  std::string fixedFrame(const std::string& parent, const Placement& placement) {
    Link frame;
    frame.name = unused(parent + ".frame", &links_);
    frame.joint.name = unused(frame.name, &joints_);
    frame.joint.placement = placement;
    hang(frame, parent);
    return named_.back().link.name;
  }

  /// Hangs `parent` on `child` by the child's joint, turned round.
  void turnRound(const Link& child, const Link& parent) {
    Joint joint = child.joint;
    std::vector<Placement> to_joint = placementsOf(undone(joint.placement.afterJoint())),
                           to_parent = placementsOf(undone(joint.placement.beforeJoint()));
    joint.placement = Placement();
    if (!to_joint.empty()) {
      joint.placement = to_joint.back();
      to_joint.pop_back();
    }
    if (scene::hasAxis(joint.kind))
      for (Number& n : joint.axis) n = negative(n);
    std::string at = child.name;
    for (const Placement& placement : to_joint) at = fixedFrame(at, placement);
    Link hung = parent;
    if (!to_parent.empty()) {
      Link frame;
      frame.name = unused(joint.name + ".moved", &links_);
      frame.joint = joint;
      hang(frame, at);
      at = frame.name;
      for (std::size_t k = 0; k + 1 < to_parent.size(); ++k) at = fixedFrame(at, to_parent[k]);
      joint = Joint();
      joint.name = unused(parent.name + ".frame", &joints_);
      joint.placement = to_parent.back();
    }
    hung.joint = joint;
    hang(hung, at);
  }

  /// All links, each with the name of its new parent, in the old order.
  std::vector<scene::NamedLink> hung() {
    std::string world = m_.links[0].name;
    Joint floating;
    if (floats_) {
      floating = m_.links[index(way_.back())].joint;
    } else {
      world = unused("world", &links_);
      floating.name = unused(m_.links[index(way_[0])].name + ".in_the_world", &joints_);
      floating.kind = JointKind::kFloating;
      Link rests;
      rests.name = world;
      named_.push_back({rests, std::nullopt, {}});
    }
    for (int i = 0; i < static_cast<int>(m_.links.size()); ++i) {
      const auto on_way = std::find(way_.begin(), way_.end(), i);
      Link link = m_.links[index(i)];
      if (on_way == way_.end()) {
        if (link.parent < 0)
          named_.push_back({link, std::nullopt, {}});
        else
          hang(link, m_.links[index(link.parent)].name);
      } else if (on_way == way_.begin()) {
        link.joint = floating;
        hang(link, world);
      } else {
        turnRound(m_.links[index(*(on_way - 1))], link);
      }
    }
    start_joint_ = floating.name;
    return named_;
  }

  /// What refers to links finds them by name.
  void takeAlong(Mechanism& to) const {
    std::map<std::string, int> place;
    for (std::size_t i = 0; i < to.links.size(); ++i) place[to.links[i].name] = static_cast<int>(i);
    const auto moved = [&](int& link) { link = place.at(m_.links[index(link)].name); };
    for (scene::Wrench& wrench : to.wrenches) moved(wrench.link);
    for (scene::Closure& closure : to.closures) moved(closure.a.link), moved(closure.b.link);
    for (scene::Spring& spring : to.springs) moved(spring.a.link), moved(spring.b.link);
    for (scene::AccelerationConstraint& held : to.acceleration_constraints) moved(held.link);
    if (floats_) return;
    scene::Closure weld;
    weld.name = m_.links[0].name + " in the world";
    weld.kind = scene::ClosureKind::kWeld;
    weld.b.link = place.at(m_.links[0].name);
    to.closures.push_back(weld);
  }

  /// Of the new start, seen from the frame in which it floats.
  Pose pose() const {
    const scene::RealNumbers<double> number(m_);
    const auto model = recursive::buildModel(m_, number);
    recursive::Workspace<double> ws(model);
    // driven joints are where their motion is, the others where the start has them: at quarter
    // turns exactly
    scene::State<double> at = ConstrainedQuantities(from_).start();
    for (std::size_t k = 0; k < at.x.size(); ++k) {
      const auto angle = number.angle(from_.start_q[k]);
      if (at.x[k].q == number(from_.start_q[k])) at.x[k] = {at.x[k].q, angle.c, angle.s};
    }
    recursive::linkVelocities(model, at.x, at.qd, ws);
    const auto& place = model.places[index(way_[0])];
    recursive::Transform<double> X = place.X;  // of the world
    for (int i = place.link; i >= 0; i = model.links[i].parent) X = X * ws.X_up[i];
    if (floats_)
      X = X * recursive::detail::composed<double>(
                  m_.links[index(way_.back())].joint.placement.beforeJoint(), number)
                  .inverse();
    return {X.p, Eigen::Quaterniond(X.R.transpose()), place.X * ws.v[place.link]};
  }

  /// The same pose and motion.
  void putAtStart(scene::Scene& out) const {
    std::map<std::string, std::pair<std::vector<Number>, std::vector<Number>>> old;
    auto q = from_.start_q.begin();
    auto qd = from_.start_qd.begin();
    for (const Link& link : m_.links) {
      const auto slots = static_cast<std::ptrdiff_t>(scene::positionSlots(link.joint.kind).size());
      old[link.joint.name] = {{q, q + slots}, {qd, qd + link.joint.ownRates()}};
      q += slots;
      qd += link.joint.ownRates();
    }
    std::set<std::string> turned;
    for (std::size_t k = 0; k + 1 < way_.size(); ++k)
      turned.insert(m_.links[index(way_[k])].joint.name);
    out.start_q.clear();
    out.start_qd.clear();
    for (const Link& link : out.mechanism.links) {
      const Joint& joint = link.joint;
      if (joint.name == start_joint_ && joint.kind == JointKind::kFloating) {
        const Pose at = pose();
        const Eigen::Vector4d turn = {at.turn.w(), at.turn.x(), at.turn.y(), at.turn.z()};
        for (const double x : at.position) out.start_q.push_back(decimal(x));
        for (const double x : turn) out.start_q.push_back(decimal(x));
        for (const double x : at.twist.vector()) out.start_qd.push_back(decimal(x));
        continue;
      }
      if (joint.kind == JointKind::kFixed) continue;
      auto [own_q, own_qd] = old.at(joint.name);
      if (joint.kind == JointKind::kSpherical && turned.count(joint.name) > 0)
        conjugate(own_q, own_qd);
      out.start_q.insert(out.start_q.end(), own_q.begin(), own_q.end());
      out.start_qd.insert(out.start_qd.end(), own_qd.begin(), own_qd.end());
    }
  }
  /// A spherical joint seen from its other side.
  void conjugate(std::vector<Number>& q, std::vector<Number>& w) const {
    const scene::RealNumbers<double> number(m_);
    const Eigen::Quaterniond turn(number(q[0]), number(q[1]), number(q[2]), number(q[3]));
    const Eigen::Vector3d back =
        -(turn.normalized() * Eigen::Vector3d(number(w[0]), number(w[1]), number(w[2])));
    for (std::size_t k = 0; k < 3; ++k) {
      q[k + 1] = negative(q[k + 1]);
      w[k] = decimal(back(static_cast<Eigen::Index>(k)));
    }
  }

  const scene::Scene& from_;
  const Mechanism& m_;
  std::vector<int> way_;  ///< from the new start to the old one
  bool floats_ = false;   ///< the old one floats in the world; otherwise it is what rests there
  std::set<std::string> links_, joints_;  ///< names that are taken
  std::vector<scene::NamedLink> named_;
  std::string start_joint_;
};

}  // namespace

scene::Scene rooted(const scene::Scene& scene, const std::string& link) {
  return Rooting(scene, link).scene();
}

}  // namespace dynwitness::crosscheck
