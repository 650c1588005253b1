// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/inputs/random_mechanism.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "crosscheck/inputs/states.hpp"
#include "scene/mimic.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::JointKind;
using scene::Number;
using scene::Rational;
using scene::Vector;
using Convention = scene::Placement::Convention;

/// Draws the parts of one mechanism.
class Drawing {
 public:
  Drawing(std::uint64_t seed, std::uint64_t index, JointKinds kinds)
      : kinds_(kinds),
        random_(kinds == JointKinds::kAll ? "random mechanism" : "random plain mechanism", seed,
                index),
        followers_("random followers", seed, index),
        turns_("random turned inertias", seed, index),
        rotors_("random geared rotors", seed, index) {}

  scene::Mechanism mechanism(int max_joints) {
    scene::Mechanism out;
    out.has_gravity = chance(85);
    if (out.has_gravity) {
      out.gravity = {Number(0), Number(0), Number::parse("-9.81")};
      if (chance(30)) out.gravity = vector(-981, 981);
    }
    scene::Link root;
    root.name = "base";
    if (chance(30)) root.inertia = body();
    out.links.push_back(root);
    const int joints = 1 + below(max_joints);
    for (int made = 0; made < joints;) {
      const bool fixed = chance(15);
      out.links.push_back(link(static_cast<int>(out.links.size()), fixed));
      made += fixed ? 0 : 1;
    }
    for (int i = below(3); i > 0; --i) {
      scene::Wrench wrench;
      wrench.link = below(static_cast<int>(out.links.size()));
      wrench.force = vector(-900, 900);
      wrench.moment = vector(-300, 300);
      wrench.at = vector(-50, 50);
      wrench.axes = chance(50) ? scene::Wrench::Axes::kWorld : scene::Wrench::Axes::kLink;
      out.wrenches.push_back(wrench);
    }
    follow(out);
    return out;
  }

  /// Gears one to three rotors to the rates of joints of several, from a stream of its own: what
  /// else is drawn stays. Light ones, but a rod carries none.
  void gear(scene::Mechanism& mechanism) {
    static constexpr int kAxes[][3] = {{0, 0, 1}, {1, 0, 0}, {0, -1, 0},
                                       {3, 0, 4}, {1, 1, 0}, {1, -2, 1}};
    const auto draw = [this](int n) {
      return static_cast<int>(rotors_.next() % static_cast<std::uint64_t>(n));
    };
    if (kinds_ != JointKinds::kAll || draw(100) >= 45) return;
    for (scene::Link& link : mechanism.links) {
      const int rates = scene::degreesOfFreedom(link.joint.kind);
      if (link.parent < 0 || rates < 2 || draw(100) >= 75) continue;
      for (int i = 1 + draw(3); i > 0; --i) {
        scene::Rotor rotor;
        rotor.inertia = Rational(1 + draw(20), 100000);
        for (int k = 0; k < rates; ++k) rotor.ratio.emplace_back(Rational(draw(601) - 300, 10));
        rotor.ratio[draw(rates)] = Rational(5);
        if (draw(100) < 60) {
          const auto& a = kAxes[draw(6)];
          rotor.axis = Vector{Number(a[0]), Number(a[1]), Number(a[2])};
        }
        link.joint.rotors.push_back(rotor);
      }
    }
  }

 private:
  /// Lets some joints of one position follow others, from a stream of its own: what else is drawn
  /// stays.
  void follow(scene::Mechanism& mechanism) {
    static constexpr const char* kMultipliers[] = {"1",   "-1", "-0.5", "2",
                                                   "0.7", "-3", "1/3",  "-1.25"};
    static constexpr const char* kOffsets[] = {"0", "0", "0.1", "-0.25", "pi/4", "1.2"};
    const auto draw = [this](std::size_t n) { return followers_.next() % n; };
    std::vector<int> joints;
    for (std::size_t i = 1; i < mechanism.links.size(); ++i)
      if (scene::degreesOfFreedom(mechanism.links[i].joint.kind) == 1)
        joints.push_back(static_cast<int>(i));
    if (joints.size() < 2 || draw(100) >= 35) return;
    for (std::size_t k = joints.size(); k > 1; --k) std::swap(joints[k - 1], joints[draw(k)]);
    // each follows one that stands before it in this order, so that there is no circle; the first
    // leads
    for (std::size_t k = 1; k < joints.size(); ++k) {
      if (draw(100) >= 50 && k + 1 < joints.size()) continue;
      const std::string& leader = mechanism.links[joints[draw(k)]].joint.name;
      mechanism.links[joints[k]].joint.mimic = scene::Mimic{
          leader, Number::parse(kMultipliers[draw(8)]), Number::parse(kOffsets[draw(6)])};
    }
  }

  int below(int n) { return static_cast<int>(random_.next() % static_cast<std::uint64_t>(n)); }
  bool chance(int percent) { return below(100) < percent; }

  /// A decimal with two places, low/100 ... high/100.
  Number decimal(int low, int high) {
    const int k = low + below(high - low + 1), magnitude = std::abs(k);
    return Number::parse(
        fmt::format("{}{}.{:02}", k < 0 ? "-" : "", magnitude / 100, magnitude % 100));
  }
  Vector vector(int low, int high) {
    return {decimal(low, high), decimal(low, high), decimal(low, high)};
  }
  Number angle() {
    static constexpr const char* kCommon[] = {"0", "0", "pi/2", "-pi/2", "pi", "pi/3", "-pi/4"};
    return chance(50) ? Number::parse(kCommon[below(7)]) : decimal(-314, 314);
  }
  /// An axis: z, another coordinate axis, of rational length, or any.
  Vector axis() {
    static constexpr int kAxes[][3] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, -1},
                                       {0, 0, 2},  {3, 0, 4},  {0, 4, 3}, {3, -4, 0}, {1, 2, 2},
                                       {-2, 1, 2}, {1, 1, 0},  {1, 0, 1}, {1, 1, 1},  {0, -1, -1}};
    if (chance(40)) return {Number(0), Number(0), Number(1)};
    if (chance(30)) return {decimal(-99, 99), decimal(-99, 99), decimal(1, 99)};
    const auto& a = kAxes[below(15)];
    return {Number(a[0]), Number(a[1]), Number(a[2])};
  }

  scene::Placement placement() {
    scene::Placement p;
    const int kind = below(4);
    if (kind < 2) {
      p.xyz = vector(-60, 60);
      p.rpy = {angle(), angle(), angle()};
      return p;
    }
    p.convention = kind == 2 ? Convention::kDh : Convention::kMdh;
    p.a = decimal(-60, 60);
    p.d = decimal(-60, 60);
    p.alpha = angle();
    p.theta = angle();
    return p;
  }

  /// The mass properties of two to five point masses. The last one, of 1 kg, is where it makes the
  /// centre of mass a short decimal; so all numbers are decimals. Two are a rod, without inertia
  /// about its own line: where a joint turns freely every way, M would be singular.
  scene::MassProperties body(bool may_be_a_rod = true) {
    const bool general = chance(85) || !may_be_a_rod;
    const int count = general ? 4 + below(2) : 2 + below(2);
    // in whole numbers: tenths of a kilogram, thousandths of a metre
    using Whole = std::int64_t;
    Whole mass = 10;
    std::array<Whole, 3> last{0, 0, 0}, com;
    std::vector<std::pair<Whole, std::array<Whole, 3>>> points;  // from the centre of mass
    for (int i = 1; i < count; ++i) {
      const Whole m = 1 + below(20);
      std::array<Whole, 3> r;
      for (int k = 0; k < 3; ++k) {
        r[k] = 10 * (below(61) - 30);
        last[k] -= m * r[k] / 10;
      }
      mass += m;
      points.emplace_back(m, r);
    }
    points.emplace_back(10, last);
    for (Whole& x : com) x = 10 * (below(61) - 30);

    scene::MassProperties out;
    out.mass = Rational(mass, 10);
    for (std::size_t k = 0; k < 3; ++k) out.com[k] = Rational(com[k], 1000);
    const bool at_origin = chance(30);
    if (at_origin)
      out.about = scene::MassProperties::About::kLinkOrigin;
    else if (chance(30))
      out.rpy = {angle(), angle(), angle()};
    Whole I[3][3] = {};  // 1e-7 kg m^2
    for (auto [m, r] : points) {
      if (at_origin)
        for (int k = 0; k < 3; ++k) r[k] += com[k];
      const Whole r2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) I[i][j] += m * ((i == j ? r2 : 0) - r[i] * r[j]);
    }
    const auto inertia = [](Whole value) { return Number(Rational(value, 10000000)); };
    out.xx = inertia(I[0][0]);
    out.yy = inertia(I[1][1]);
    out.zz = inertia(I[2][2]);
    out.xy = inertia(I[0][1]);
    out.xz = inertia(I[0][2]);
    out.yz = inertia(I[1][2]);
    // the same inertia in axes a quarter turn on, from a stream of its own: the rest stays
    if (at_origin && turns_.next() % 100 < 50) {
      out.rpy[2] = Number::parse("pi/2");
      std::swap(out.xx, out.yy);
      out.xy = inertia(-I[0][1]);
      out.xz = inertia(I[1][2]);
      out.yz = inertia(-I[0][2]);
    }
    return out;
  }

  /// Mostly revolute or prismatic.
  JointKind kind() {
    static constexpr JointKind kRare[] = {JointKind::kHelical,   JointKind::kCylindrical,
                                          JointKind::kUniversal, JointKind::kPlanar,
                                          JointKind::kSpherical, JointKind::kFloating};
    if (kinds_ == JointKinds::kAll && chance(30)) return kRare[below(6)];
    return chance(70) ? JointKind::kRevolute : JointKind::kPrismatic;
  }

  scene::Link link(int index, bool fixed) {
    scene::Link out;
    out.name = fmt::format("link_{}", index);
    out.parent = chance(65) ? index - 1 : below(index);
    scene::Joint& joint = out.joint;
    joint.name = fmt::format("joint_{}", index);
    joint.kind = fixed ? JointKind::kFixed : kind();
    const bool has_axis = scene::hasAxis(joint.kind),
               has_one_q = scene::degreesOfFreedom(joint.kind) == 1;
    do {
      joint.placement = placement();
    } while (!fixed && (!has_axis || joint.kind == JointKind::kPlanar) &&
             joint.placement.convention != Convention::kXyzRpy);
    if (joint.placement.convention == Convention::kXyzRpy && has_axis) joint.axis = axis();
    if (joint.kind == JointKind::kHelical) joint.pitch = decimal(-40, 40);
    const bool has_rotor = has_one_q && chance(40);
    if (has_rotor) {
      joint.rotor_inertia = Rational(1 + below(50), 10000);
      joint.gear_ratio = decimal(-9999, 9999);
    }
    if (has_one_q && chance(25)) {
      joint.stiffness = decimal(0, 5000);
      joint.rest = joint.kind != JointKind::kPrismatic ? angle() : decimal(-50, 50);
    }
    joint.gyroscopic = kinds_ == JointKinds::kAll && has_rotor && chance(30);
    if (has_one_q && chance(20)) {
      joint.friction.viscous = decimal(0, 300);
      if (chance(50)) joint.friction.positive = joint.friction.negative = decimal(0, 300);
    }
    // without a mass of its own, or a rotor, a joint could move nothing that another one does not
    if (chance(90) || !(fixed || has_rotor))
      out.inertia = body(joint.kind != JointKind::kSpherical && joint.kind != JointKind::kFloating);
    return out;
  }

  JointKinds kinds_;
  RandomStream random_, followers_, turns_, rotors_;
};

/// Adds to one mechanism what makes it more than its tree.
class Constraining {
 public:
  Constraining(std::uint64_t seed, std::uint64_t index, scene::Scene& scene)
      : springs_("random springs between points", seed, index),
        drives_("random drives", seed, index),
        constraints_("random constraints", seed, index),
        mechanism_(scene.mechanism),
        start_q_(scene.start_q) {}

  void all() {
    if (mechanism_.hasGearedRotors()) return;  // the format has no more beside them
    addSprings();
    if (mechanism_.hasMimics()) return;
    addDrives();
    const std::uint64_t kind = constraints_.next() % 100;
    if (kind < 45)
      addClosures();
    else if (kind < 75)
      addHeld();
  }

 private:
  using Pose = Eigen::Isometry3d;

  static int below(RandomStream& random, int n) {
    return static_cast<int>(random.next() % static_cast<std::uint64_t>(n));
  }
  /// A decimal with two places, low/100 ... high/100.
  static Number decimal(RandomStream& random, int low, int high) {
    return {Rational(low + below(random, high - low + 1), 100)};
  }
  static Vector vector(RandomStream& random, int low, int high) {
    return {decimal(random, low, high), decimal(random, low, high), decimal(random, low, high)};
  }
  static scene::Attachment attachment(RandomStream& random, int link) {
    return {link, vector(random, -40, 40), vector(random, -300, 300)};
  }
  int links() const { return static_cast<int>(mechanism_.links.size()); }

  void addSprings() {
    if (below(springs_, 100) >= 40) return;
    std::vector<int> carrier;  // by link: the one that fixed joints make it a part of
    for (int i = 0; i < links(); ++i) {
      const scene::Link& link = mechanism_.links[i];
      const bool rides = link.parent >= 0 && link.joint.kind == JointKind::kFixed;
      carrier.push_back(rides ? carrier[link.parent] : i);
    }
    for (int i = 1 + below(springs_, 2); i > 0; --i) {
      scene::Spring spring;
      spring.name = fmt::format("spring_{}", i);
      do {  // a joint moves between the two: every mechanism has one
        spring.a = {below(springs_, links()), vector(springs_, -40, 40), {}};
        spring.b = {below(springs_, links()), vector(springs_, -40, 40), {}};
      } while (carrier[spring.a.link] == carrier[spring.b.link]);
      spring.stiffness = decimal(springs_, 100, 9000);
      spring.rest = decimal(springs_, 0, 60);
      if (below(springs_, 100) < 60) spring.damping = decimal(springs_, 1, 300);
      mechanism_.springs.push_back(spring);
    }
  }

  /// Motions that are 0 where the scene starts; one joint at least stays free.
  void addDrives() {
    static constexpr const char* kMotions[] = {"0.4*sin(3*t)", "1.5*t", "0.3*t - 0.2*t^2",
                                               "0.5 - 0.5*cos(2*t)"};
    if (below(drives_, 100) >= 40) return;
    std::vector<scene::Joint*> joints;
    for (scene::Link& link : mechanism_.links)
      if (link.parent >= 0 && scene::degreesOfFreedom(link.joint.kind) > 0)
        joints.push_back(&link.joint);
    joints.erase(joints.begin() + below(drives_, static_cast<int>(joints.size())));
    for (scene::Joint* joint : joints) {
      if (!scene::ratesArePositionDerivatives(joint->kind) || below(drives_, 100) >= 35) continue;
      for (int k = 0; k < scene::degreesOfFreedom(joint->kind); ++k)
        joint->motion.push_back(scene::Expression::parseOfTime(kMotions[below(drives_, 4)]));
    }
  }

  /// One; of a link that floats up to three, which are independent there, and so as tasks of a
  /// controller, too.
  void addHeld() {
    std::vector<int> movable;  // by a joint that no drive moves
    std::vector<char> moves(mechanism_.links.size(), 0), floats(moves);
    for (int i = 1; i < links(); ++i) {
      const scene::Link& link = mechanism_.links[i];
      floats[i] = floats[link.parent] || link.joint.kind == JointKind::kFloating;
      moves[i] = moves[link.parent] ||
                 (scene::degreesOfFreedom(link.joint.kind) > 0 && link.joint.motion.empty());
      if (moves[i]) movable.push_back(i);
    }
    const int link = movable[below(constraints_, static_cast<int>(movable.size()))],
              count = 1 + below(constraints_, 3);
    for (int i = 0; i < (floats[link] ? count : 1); ++i) {
      scene::AccelerationConstraint held;
      held.name = fmt::format("held_{}", i);
      held.link = link;
      held.at = vector(constraints_, 1, 40);
      held.direction = vector(constraints_, 1, 99);
      if (below(constraints_, 100) < 50) held.rotation = vector(constraints_, -50, 50);
      held.axes = below(constraints_, 100) < 50 ? scene::AccelerationConstraint::Axes::kWorld
                                                : scene::AccelerationConstraint::Axes::kLink;
      held.value = decimal(constraints_, -500, 500);
      if (below(constraints_, 100) < 40) held.compliance = decimal(constraints_, 5, 100);
      mechanism_.acceleration_constraints.push_back(held);
    }
  }

  void addClosures() {
    const int count = below(constraints_, 100) < 30 ? 2 : 1, of_tree = links();
    for (int i = 0; i < count; ++i) {
      const std::vector<Pose> at = poses();
      scene::Link body;
      body.name = fmt::format("closing_{}", i);
      body.parent = below(constraints_, of_tree);
      body.inertia = rigidBody();
      body.joint.name = fmt::format("to_closing_{}", i);
      body.joint.kind = JointKind::kFloating;
      body.joint.placement.xyz = vector(constraints_, -60, 60);
      body.joint.placement.rpy = vector(constraints_, -300, 300);

      scene::Closure closure;
      closure.name = fmt::format("closure_{}", i);
      closure.kind = static_cast<scene::ClosureKind>(
          below(constraints_, static_cast<int>(scene::ClosureKind::kRolling) + 1));
      const scene::Attachment on_tree = attachment(constraints_, below(constraints_, of_tree)),
                              on_body = attachment(constraints_, links());
      const bool body_is_b = below(constraints_, 100) < 50;
      closure.a = body_is_b ? on_tree : on_body;
      closure.b = body_is_b ? on_body : on_tree;
      const Pose a_to_b = closed(closure), before = at[static_cast<std::size_t>(body.parent)] *
                                                    composed(body.joint.placement.beforeJoint());
      const Pose there = at[static_cast<std::size_t>(on_tree.link)] * composed(on_tree.steps()) *
                         (body_is_b ? a_to_b : a_to_b.inverse()) *
                         composed(on_body.steps()).inverse();
      addPosition(before.inverse() * there);
      mechanism_.links.push_back(body);
      mechanism_.closures.push_back(closure);
    }
  }

  /// A place of frame b seen from a where the closure is closed.
  Pose closed(scene::Closure& closure) {
    using Kind = scene::ClosureKind;
    const auto turn = [this](const Eigen::Vector3d& axis) {
      return Eigen::AngleAxisd(constraints_.uniform(-3, 3), axis);
    };
    const auto length = [this] { return constraints_.uniform(-0.5, 0.5); };
    const auto z = Eigen::Vector3d::UnitZ();
    Pose pose = Pose::Identity();
    switch (closure.kind) {
      case Kind::kDistance:
        closure.length = Number::parse("0.35");
        pose.translate(turn(Eigen::Vector3d::UnitX()) * (turn(z) * Eigen::Vector3d(0.35, 0, 0)));
        break;
      case Kind::kPlane:
        pose.translate(Eigen::Vector3d(length(), length(), 0));
        break;
      case Kind::kPlanarPoint:
        pose.translate(Eigen::Vector3d(0, 0, length()));
        break;
      case Kind::kPoint:
        break;
      case Kind::kHinge:
        return pose * turn(z);
      case Kind::kWeld:
        return pose;
      case Kind::kSkate:
        pose.translate(Eigen::Vector3d(length(), length(), length()));
        break;
      case Kind::kRolling:  // upright: its centre is as high as its radius
        closure.length = Number::parse("0.25");
        pose.translate(Eigen::Vector3d(length(), length(), 0.25));
        return pose * turn(z) * Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitY()) * turn(z);
    }
    return pose * turn(z) * turn(Eigen::Vector3d::UnitX()) * turn(z);
  }

  /// Three moments that are sums of two squares each, as those of a body are.
  scene::MassProperties rigidBody() {
    scene::MassProperties out;
    out.mass = Rational(50 + below(constraints_, 250), 100);
    out.com = vector(constraints_, -20, 20);
    std::array<Rational, 3> squares;
    for (Rational& square : squares) square = Rational(1 + below(constraints_, 30), 200);
    out.xx = Rational(squares[1] + squares[2]);
    out.yy = Rational(squares[0] + squares[2]);
    out.zz = Rational(squares[0] + squares[1]);
    return out;
  }

  Pose composed(const std::vector<scene::Step>& steps) const {
    using Kind = scene::Step::Kind;
    const scene::RealNumbers<double> number(mechanism_);
    Pose pose = Pose::Identity();
    for (const scene::Step& step : steps) {
      if (step.kind == Kind::kTranslate)
        pose.translate(Eigen::Vector3d(number(step.translation[0]), number(step.translation[1]),
                                       number(step.translation[2])));
      else
        pose.rotate(Eigen::AngleAxisd(number(step.angle),
                                      step.kind == Kind::kRotateX   ? Eigen::Vector3d::UnitX()
                                      : step.kind == Kind::kRotateY ? Eigen::Vector3d::UnitY()
                                                                    : Eigen::Vector3d::UnitZ()));
    }
    return pose;
  }

  /// Link frames in the world where the scene starts: joints of the tree at rest, at 0.
  std::vector<Pose> poses() const {
    std::vector<Pose> out;
    for (const scene::Link& link : mechanism_.links)
      out.push_back(link.parent < 0 ? Pose::Identity()
                                    : Pose(out[static_cast<std::size_t>(link.parent)] *
                                           composed(link.joint.placement.beforeJoint()) *
                                           composed(link.joint.placement.afterJoint())));
    return out;
  }

  /// Position of a floating joint, as decimals.
  void addPosition(const Pose& pose) {
    const Eigen::Quaterniond turn(pose.rotation());
    for (const double x : {pose.translation().x(), pose.translation().y(), pose.translation().z(),
                           turn.w(), turn.x(), turn.y(), turn.z()})
      start_q_.push_back(Number::parse(fmt::format("{:.17f}", x)));
  }

  RandomStream springs_, drives_, constraints_;
  scene::Mechanism& mechanism_;
  std::vector<Number>& start_q_;
};

/// Gyroscopic where every link can carry them.
void addGearedRotors(Drawing& drawing, scene::Scene& scene) {
  drawing.gear(scene.mechanism);
  const std::vector<scene::Link>& links = scene.mechanism.links;
  if (std::all_of(links.begin(), links.end(),
                  [](const scene::Link& link) { return link.joint.rotors.empty(); }))
    return;  // validated as it is
  try {
    scene::validate(scene);
  } catch (const scene::InputError&) {
    for (scene::Link& link : scene.mechanism.links)
      for (scene::Rotor& rotor : link.joint.rotors) rotor.axis.reset();
    scene::validate(scene);
  }
}

}  // namespace

scene::Scene randomScene(std::uint64_t seed, std::uint64_t index, int max_joints,
                         JointKinds kinds) {
  if (max_joints < 1)
    throw std::invalid_argument(
        fmt::format("randomScene: max_joints: expected 1 or more, got {}", max_joints));
  Drawing drawing(seed, index, kinds);
  const char* plain = kinds == JointKinds::kAll ? "" : "plain ";
  scene::Scene out;
  out.name = fmt::format("random_{}{}_{}", kinds == JointKinds::kAll ? "" : "plain_", seed, index);
  out.title = fmt::format("Random {}mechanism {}", plain, index);
  out.source = fmt::format("dynwitness, random {}mechanism {} of seed {} with up to {} joints",
                           plain, index, seed, max_joints);
  out.file = out.name + ".toml";
  while (true) {
    out.mechanism = drawing.mechanism(max_joints);
    out.start_q = out.mechanism.restPosition();
    out.start_qd.assign(out.mechanism.dof(), Number(0));
    try {
      scene::validate(out);
      addGearedRotors(drawing, out);
      return out;
    } catch (const scene::InputError&) {  // a joint that moves no inertia: the next one, then
    }
  }
}

scene::Scene randomWholeScene(std::uint64_t seed, std::uint64_t index, int max_joints) {
  scene::Scene out = randomScene(seed, index, max_joints);
  Constraining(seed, index, out).all();
  out.start_qd.assign(out.mechanism.dof(), Number(0));
  const scene::Mechanism& all = out.mechanism;
  if (!all.isOpenTree() || all.isDriven() || !all.acceleration_constraints.empty())
    scene::validate(out);  // else it is the tree, which was
  return out;
}

scene::Scene randomTreeScene(std::uint64_t seed, std::uint64_t index, int max_joints) {
  scene::Scene out = randomScene(seed, index, max_joints);
  out.mechanism = scene::withoutGearedRotors(scene::withoutMimics(out.mechanism));
  out.start_q = out.mechanism.restPosition();
  out.start_qd.assign(out.mechanism.dof(), Number(0));
  return out;
}

}  // namespace dynwitness::crosscheck
