// SPDX-License-Identifier: GPL-3.0-or-later
// The one place that says what is physically possible.
//
// Decisions are made in rational arithmetic, so that a mechanism on the border (a thin rod: one
// principal moment is zero, the other two are equal) is on the right side of it. Where a number has
// pi in it, or an angle is not a multiple of pi/2, sines and the like are rationals with an error
// below 1e-60, and the border gets a slack of 1e-40. Where a function is rounded
// (function_values.hpp) a number is within 1e-50 of itself of what is written, or refused: the same
// slack holds that, too.
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "scene/arrange.hpp"
#include "scene/faults.hpp"
#include "scene/function_values.hpp"
#include "scene/impossible_inertia.hpp"
#include "scene/inertia_need.hpp"
#include "scene/mimic.hpp"
#include "scene/motion.hpp"
#include "scene/scene.hpp"
#include "scene/urdf.hpp"

namespace dynwitness::scene {
namespace {

/** The number itself while it is short; of a long one its first 256 bits, and *is_exact is false
    then. Sums and products over many links grow by the denominators of all: without this a row of
    1000 fixed links takes hours. n roundings of 2^-256 stay below the slack of 1e-40 for any n. */
Rational bounded(const Rational& x, bool* is_exact) {
  constexpr unsigned kMostBits = 2048, kKeptBits = 256;
  if (x.is_zero()) return x;
  const unsigned above = msb(abs(numerator(x))), below = msb(denominator(x));
  if (above <= kMostBits && below <= kMostBits) return x;
  *is_exact = false;
  const int shift = static_cast<int>(kKeptBits) + static_cast<int>(below) - static_cast<int>(above);
  if (shift >= 0) return Rational((numerator(x) << shift) / denominator(x), Integer(1) << shift);
  return Rational(numerator(x) / (denominator(x) << -shift)) * (Integer(1) << -shift);
}

struct SineAndCosine {
  Rational sine, cosine;
  bool is_exact;
};

/// Exact for multiples of pi/2, otherwise with an error below 1e-60.
SineAndCosine sineAndCosine(const Exact& angle) {
  constexpr unsigned kBits = 256;  // of fixed point: plain rationals would grow without bound
  const FixedSineCosine fixed = fixedSineCosine(angle, kBits);
  const Integer one = Integer(1) << kBits;
  return {Rational(fixed.sine, one), Rational(fixed.cosine, one), fixed.error == 0};
}

using scene::operator*;  // which Frame's own would hide

/// A frame seen from another one: x = R x' + p.
struct Frame {
  RationalMatrix R = identity();
  RationalVector p{0, 0, 0};
};

Frame operator*(const Frame& a, const Frame& b) {
  const RationalVector moved = a.R * b.p;
  return {a.R * b.R, {a.p[0] + moved[0], a.p[1] + moved[1], a.p[2] + moved[2]}};
}

// ------------------------------------------------------------------------------------ a mechanism

/// Inertia of one link about its centre of mass, and what it was computed from.
struct Body {
  Rational mass;
  RationalVector com;
  RationalMatrix inertia;
  bool is_exact;       ///< no rounding in it
  const Vector* turn;  ///< from the axes that it is given in to the link's; null: these
};

/// A motion of a joint's link: velocity of the joint frame's origin, and angular velocity.
struct Twist {
  RationalVector v, w;
};

class Validator {
 public:
  explicit Validator(const Scene& scene)
      : scene_(scene), mechanism_(scene.mechanism), file_{scene.file.string(), 0} {}

  void run(InertiaNeed need) {
    requireTree();
    requireUniqueNames(mechanism_.links);
    findParameters();
    requireValues();
    Faults faults;
    for (const Link& link : mechanism_.links)
      if (link.parent >= 0) faults.collect([&] { requireJoint(link); });
    if (faults.isEmpty())
      requireBodies();
    else
      faults.collect([&] { requireBodies(); });
    faults.raise();
    requireCarriers();
    requireStart();
    if (need == InertiaNeed::kOfEachJoint) requireInertiaOutboard("");
    for (const Closure& closure : mechanism_.closures) {
      const std::string what = "closure \"" + closure.name + '"';
      requireEnds(what, closure.a.link, closure.b.link, closure.where);
      const double length = exactValue(closure.length, values_, closure.where).toDouble();
      const bool is_disc = closure.kind == ClosureKind::kRolling;
      if ((is_disc || closure.kind == ClosureKind::kDistance) && !(length > 0)) {
        throw InputError(closure.where, what + fmt::format(": {} is {}, allowed: above zero",
                                                           is_disc ? "radius" : "length", length));
      }
    }
    for (const Spring& spring : mechanism_.springs) requireSpring(spring);
  }

  std::vector<std::string> impossibleInertias();

  void requireInertiaFor(const std::string& asked) {
    findParameters();
    requireBodies();
    requireInertiaOutboard(asked);
  }

 private:
  [[noreturn]] static void failLink(const Link& link, const std::string& what) {
    throw InputError(link.where, "link \"" + link.name + "\": " + what);
  }
  [[noreturn]] static void failJoint(const Link& link, const std::string& what) {
    throw InputError(link.where,
                     "joint \"" + link.joint.name + "\" of link \"" + link.name + "\": " + what);
  }

  Rational value(const Number& n) {
    const Exact x = exactValue(n, values_, file_);
    is_exact_ = is_exact_ && x.isRational() &&
                errorOfFunctions(n, values_, parameter_errors_, file_).is_zero();
    return x.approximation();
  }
  RationalVector vector(const Vector& v) { return {value(v[0]), value(v[1]), value(v[2])}; }

  void findParameters();
  void requireTree();
  void requireValues() const;
  void requireBodies();
  void requireJoint(const Link& link);
  void requireRotors(const Link& link);
  void requireCarriers();
  void requireStart() const;
  void requireInertiaOutboard(const std::string& asked);
  void requireEnds(const std::string& what, int a, int b, const SourceLocation& where) const;
  void requireSpring(const Spring& spring) const;

  Rational shortened(const Rational& x) { return bounded(x, &is_exact_); }
  Frame shortened(Frame f) {
    for (std::size_t i = 0; i < 3; ++i) {
      f.p[i] = shortened(f.p[i]);
      for (Rational& element : f.R[i]) element = shortened(element);
    }
    return f;
  }
  Frame frame(const std::vector<Step>& steps);
  RationalMatrix turn(const Step& step);
  RationalVector turned(const std::vector<Step>& steps, RationalVector v);  ///< frame(steps).R v
  RationalMatrix turnOf(const Vector& rpy);
  Body body(const Link& link);
  const Body& inLinkAxes(std::size_t i);
  std::string impossible(const Link& link, const RationalMatrix& given, const RationalMatrix& R,
                         const Rational& allowance);
  double sizeOfRobot();
  Rational slack(const Rational& scale) const;
  std::vector<Twist> motionsOf(const Joint& joint);
  bool surelyMovesInertia(std::size_t leaf);
  bool movesInertia(std::size_t leaf);

  const Scene& scene_;
  const Mechanism& mechanism_;
  SourceLocation file_;
  ParameterValues values_;
  ParameterErrors parameter_errors_;  ///< of those that have rounded functions in them
  std::vector<Body> bodies_;
  std::vector<int> first_child_, next_child_;  ///< of each link; -1: none
  std::vector<int> carriers_;  ///< of each link the link that moves it; 0, the root: none does
  std::vector<std::pair<const Link*, std::string>> complaints_;  ///< about inertias
  std::optional<double> size_;
  bool is_exact_ = true;  ///< no rounding in the decision that is being made
};

void Validator::findParameters() {
  values_ = mechanism_.parameterValues();
  for (const Parameter& p : mechanism_.parameters) {
    const Rational error = errorOfFunctions(p.value, values_, parameter_errors_, p.where);
    if (!error.is_zero()) parameter_errors_[p.name] = error;
  }
}

void Validator::requireTree() {
  const std::vector<Link>& links = mechanism_.links;
  if (links.empty()) throw InputError(file_, "no root: there is no link at all");
  for (std::size_t i = 0; i < links.size(); ++i) {
    const int parent = links[i].parent;
    const bool in_order = i == 0 ? parent == -1 : parent >= 0 && parent < static_cast<int>(i);
    if (!in_order) {
      failLink(links[i], fmt::format("index {} with parent {}, allowed: parents before children, "
                                     "and the root at 0 with parent -1",
                                     i, parent));
    }
    if (i > 0 && links[i].joint.name.empty()) failLink(links[i], "its joint has no name");
    const bool moves = i > 0 && degreesOfFreedom(links[i].joint.kind) > 0;
    carriers_.push_back(i == 0  ? 0
                        : moves ? static_cast<int>(i)
                                : carriers_[static_cast<std::size_t>(parent)]);
  }
  const auto dof = static_cast<std::size_t>(mechanism_.dof());
  const auto positions = static_cast<std::size_t>(mechanism_.positions());
  if (scene_.start_q.size() != positions || scene_.start_qd.size() != dof) {
    throw InputError(file_,
                     fmt::format("start: {} positions and {} speeds, allowed: {} and {}",
                                 scene_.start_q.size(), scene_.start_qd.size(), positions, dof));
  }
  for (const Wrench& wrench : mechanism_.wrenches) {
    if (wrench.link >= 0 && wrench.link < static_cast<int>(links.size())) continue;
    throw InputError(file_, fmt::format("wrench: there is no link of index {}", wrench.link));
  }
}

/// Every number has a finite value. (The readers have said so with a better line number.)
void Validator::requireValues() const {
  const auto require = [this](const auto& numbers, const SourceLocation& where) {
    for (const Number& n : numbers) {
      exactValue(n, values_, where);
      errorOfFunctions(n, values_, parameter_errors_, where);
    }
  };
  require(mechanism_.gravity, file_);
  require(scene_.start_q, file_);
  require(scene_.start_qd, file_);
  for (const Wrench& w : mechanism_.wrenches) {
    for (const Vector& v : {w.force, w.moment, w.at}) require(v, file_);
  }
  for (const Link& link : mechanism_.links) {
    if (link.joint.mimic) exactValue(link.joint.mimic->offset, values_, link.where);
  }
  for (const Closure& c : mechanism_.closures) {
    for (const Vector& v : {c.a.xyz, c.a.rpy, c.b.xyz, c.b.rpy}) require(v, c.where);
  }
  for (const Spring& s : mechanism_.springs) {
    for (const Vector& v : {s.a.xyz, s.b.xyz}) require(v, s.where);
    require(std::initializer_list<Number>{s.stiffness, s.rest, s.damping}, s.where);
  }
  for (const Link& link : mechanism_.links) {
    const MassProperties& i = link.inertia;
    const Placement& p = link.joint.placement;
    const Joint& j = link.joint;
    for (const Vector& v : {i.com, i.rpy, p.xyz, p.rpy, j.axis}) require(v, link.where);
    require(std::initializer_list<Number>{i.mass, i.xx, i.yy, i.zz, i.xy, i.xz, i.yz, p.a, p.alpha,
                                          p.d, p.theta, j.pitch, j.rotor_inertia, j.gear_ratio,
                                          j.stiffness, j.rest, j.friction.viscous,
                                          j.friction.positive, j.friction.negative},
            link.where);
    for (const Rotor& rotor : j.rotors) {
      require(std::initializer_list<Number>{rotor.inertia}, link.where);
      require(rotor.ratio, link.where);
      if (rotor.axis) require(*rotor.axis, link.where);
    }
  }
}

Frame Validator::frame(const std::vector<Step>& steps) {
  Frame result;
  for (const Step& step : steps) {
    if (step.kind == Step::Kind::kTranslate) {
      result = result * Frame{identity(), vector(step.translation)};
      continue;
    }
    result = result * Frame{turn(step), {0, 0, 0}};
  }
  return result;
}

RationalMatrix Validator::turn(const Step& step) {
  const auto [s, c, is_exact] = sineAndCosine(exactValue(step.angle, values_, file_));
  is_exact_ = is_exact_ && is_exact;
  switch (step.kind) {
    case Step::Kind::kRotateX:
      return {{{1, 0, 0}, {0, c, -s}, {0, s, c}}};
    case Step::Kind::kRotateY:
      return {{{c, 0, s}, {0, 1, 0}, {-s, 0, c}}};
    default:
      return {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
  }
}

RationalVector Validator::turned(const std::vector<Step>& steps, RationalVector v) {
  for (auto step = steps.rbegin(); step != steps.rend(); ++step)
    if (step->kind != Step::Kind::kTranslate) v = turn(*step) * v;
  return v;
}

RationalMatrix Validator::turnOf(const Vector& rpy) {
  Placement turn;
  turn.rpy = rpy;
  return frame(turn.beforeJoint()).R;
}

Rational Validator::slack(const Rational& scale) const {
  return is_exact_ ? Rational(0) : scale / boost::multiprecision::pow(Integer(10), 40);
}

/// The longest lever: from a link to a joint on it or to its centre of mass [m].
double Validator::sizeOfRobot() {
  if (size_) return *size_;
  size_ = 0;
  const auto number = [this](const Number& n) { return exactValue(n, values_, file_).toDouble(); };
  for (const Link& link : mechanism_.links) {
    const Placement& p = link.joint.placement;
    for (const Vector& v : {link.inertia.com, p.xyz, {p.a, p.d, Number(0)}})
      size_ = std::max(*size_, std::hypot(number(v[0]), number(v[1]), number(v[2])));
  }
  return *size_;
}

/// What is wrong with an inertia, by how much, and what it may have been meant as; empty: nothing.
std::string Validator::impossible(const Link& link, const RationalMatrix& given,
                                  const RationalMatrix& R, const Rational& allowance) {
  WrittenInertia written{link.inertia, given, {}, value(link.inertia.mass), allowance};
  const RationalVector c = transpose(R) * vector(link.inertia.com);
  const Rational c2 = dot(c, c);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      written.shift[i][j] = written.mass * ((i == j ? c2 : Rational(0)) - c[i] * c[j]);
  const std::string what = impossibility(written);
  if (what.empty()) return "";
  const std::string reason = likelyReason(written, sizeOfRobot());
  return what + (reason.empty() ? "" : "; likely: " + reason);
}

std::vector<std::string> Validator::impossibleInertias() {
  findParameters();
  for (const Link& link : mechanism_.links) bodies_.push_back(body(link));
  std::vector<std::string> out;
  for (const auto& [link, what] : complaints_)
    out.push_back(fmt::format("{}: link \"{}\": {}", link->where.text(), link->name, what));
  return out;
}

/// All links at once: a file with one impossible inertia tends to have many.
void Validator::requireBodies() {
  for (const Link& link : mechanism_.links) bodies_.push_back(body(link));
  if (complaints_.empty()) return;
  std::string all;
  for (const auto& [link, what] : complaints_)
    all += (all.empty() ? "" : "\n" + link->where.text() + ": ") + "link \"" + link->name +
           "\": " + what;
  if (complaints_.size() > 1)
    all += fmt::format("\n{}: {} of {} links have an inertia that no body has", file_.text(),
                       complaints_.size(), mechanism_.links.size());
  throw InputError(complaints_.front().first->where, all);
}

Body Validator::body(const Link& link) {
  const MassProperties& given = link.inertia;
  is_exact_ = true;
  Body b{value(given.mass), vector(given.com), {}, true, nullptr};
  const Rational xx = value(given.xx), yy = value(given.yy), zz = value(given.zz);
  const Rational xy = value(given.xy), xz = value(given.xz), yz = value(given.yz);
  const auto complain = [&](const std::string& what) {
    if (!what.empty()) complaints_.emplace_back(&link, what);
  };
  if (b.mass < 0)
    complain(fmt::format("mass is {} kg, allowed: zero or more",
                         exactValue(given.mass, values_).toDouble()));
  const bool has_inertia = xx != 0 || yy != 0 || zz != 0 || xy != 0 || xz != 0 || yz != 0;
  if (b.mass == 0 && has_inertia)
    complain(
        "has inertia but no mass, allowed: a mass with it, or the rotor_inertia of a "
        "joint");

  b.inertia = {{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}};
  if (b.mass < 0 || (b.mass == 0 && has_inertia) ||
      (!has_inertia && given.about == MassProperties::About::kCenterOfMass)) {
    b.is_exact = is_exact_;
    return b;
  }
  const bool about_origin = given.about == MassProperties::About::kLinkOrigin;
  const RationalMatrix as_written = b.inertia;
  Rational size = abs(xx) + abs(yy) + abs(zz);
  if (about_origin) {  // I_com = I_o - m (c.c 1 - c c')
    const RationalMatrix R = turnOf(given.rpy);
    b.inertia = R * b.inertia * transpose(R);
    const Rational c2 = dot(b.com, b.com);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        b.inertia[i][j] -= b.mass * ((i == j ? c2 : Rational(0)) - b.com[i] * b.com[j]);
    size += b.mass * c2;
  } else {
    b.turn = &given.rpy;
  }
  b.is_exact = is_exact_;
  const Rational allowance = slack(size);
  bool ignored = false;
  if (!isRealizable(b.inertia, allowance, &ignored))
    complain(impossible(link, as_written, turnOf(given.rpy), allowance));
  return b;
}

/// Turned when somebody asks: whether a body has it, its axes do not say, and turning rationals of
/// 256 bits takes most of the reading of a file.
const Body& Validator::inLinkAxes(std::size_t i) {
  Body& b = bodies_[i];
  if (!b.turn) return b;
  const bool was_exact = is_exact_;
  is_exact_ = b.is_exact;
  const RationalMatrix R = turnOf(*b.turn);
  b.inertia = R * b.inertia * transpose(R);
  b.is_exact = is_exact_;
  b.turn = nullptr;
  is_exact_ = was_exact;
  return b;
}

void Validator::requireJoint(const Link& link) {
  const Joint& joint = link.joint;
  if (joint.kind == JointKind::kFixed) return;
  const auto shown = [this](const Number& n) {
    return fmt::format("{}", exactValue(n, values_).toDouble());
  };
  const bool has_axis = std::any_of(joint.axis.begin(), joint.axis.end(), [this](const Number& n) {
    return !exactValue(n, values_).isZero();
  });
  if (!has_axis) failJoint(link, "axis is [0, 0, 0], allowed: any length but zero");
  const bool is_standard = joint.placement.convention == Placement::Convention::kXyzRpy;
  if (!is_standard && (!hasAxis(joint.kind) || joint.kind == JointKind::kPlanar)) {
    failJoint(link, std::string("is ") + name(joint.kind) +
                        " and stands in a Denavit-Hartenberg row, allowed: xyz and rpy");
  }
  if (degreesOfFreedom(joint.kind) > 1 &&
      (value(joint.rotor_inertia) != 0 || value(joint.stiffness) != 0 ||
       !joint.friction.isNone())) {
    failJoint(
        link,
        std::string("is ") + name(joint.kind) +
            " and has a rotor, a spring or friction, allowed: only with joints of one position");
  }
  if (value(joint.rotor_inertia) < 0) {
    failJoint(link,
              "rotor_inertia is " + shown(joint.rotor_inertia) + " kg m^2, allowed: zero or more");
  }
  if (value(joint.rotor_inertia) > 0 && value(joint.gear_ratio) == 0) {
    failJoint(link, "gear_ratio is 0 with a rotor_inertia, allowed: any ratio but zero");
  }
  if (value(joint.stiffness) < 0) {
    failJoint(link, "stiffness is " + shown(joint.stiffness) + ", allowed: zero or more");
  }
  if (joint.gyroscopic && !(value(joint.rotor_inertia) > 0)) {
    failJoint(link, "gyroscopic without a rotor, allowed: with a rotor_inertia above zero");
  }
  requireRotors(link);
  const std::pair<const char*, const Number*> frictions[] = {
      {"viscous", &joint.friction.viscous},
      {"coulomb", &joint.friction.positive},
      {"coulomb.negative", &joint.friction.negative}};
  for (const auto& [key, number] : frictions) {
    if (value(*number) < 0) {
      failJoint(link, std::string("friction: ") + key + " is " + shown(*number) +
                          ", allowed: zero or more (what takes energy away)");
    }
  }
}

void Validator::requireRotors(const Link& link) {
  const Joint& joint = link.joint;
  if (joint.rotors.empty()) return;
  const int rates = degreesOfFreedom(joint.kind);
  if (rates < 2)
    failJoint(link, std::string("is ") + name(joint.kind) +
                        " and has rotors, allowed: rotor_inertia and gear_ratio, or a joint of "
                        "several rates");
  for (std::size_t i = 0; i < joint.rotors.size(); ++i) {
    const Rotor& rotor = joint.rotors[i];
    const std::string what = fmt::format("rotors: rotor {}: ", i + 1);
    const auto allZero = [this](const auto& numbers) {
      return std::all_of(numbers.begin(), numbers.end(),
                         [this](const Number& n) { return exactValue(n, values_).isZero(); });
    };
    if (!(value(rotor.inertia) > 0))
      failJoint(link, what + fmt::format("inertia is {} kg m^2, allowed: above zero",
                                         exactValue(rotor.inertia, values_).toDouble()));
    if (static_cast<int>(rotor.ratio.size()) != rates)
      failJoint(link,
                what + fmt::format("ratio has {} numbers, allowed: {}, one a rate of the joint",
                                   rotor.ratio.size(), rates));
    if (allZero(rotor.ratio))
      failJoint(link, what + "all of its ratio is 0, allowed: a rotor that some rate turns");
    if (rotor.axis && allZero(*rotor.axis))
      failJoint(link, what + "axis is [0, 0, 0], allowed: any length but zero");
  }
  const char* beside = !mechanism_.closures.empty()                   ? "closures"
                       : !mechanism_.springs.empty()                  ? "springs between points"
                       : mechanism_.isDriven()                        ? "driven joints"
                       : !mechanism_.acceleration_constraints.empty() ? "acceleration constraints"
                                                                      : nullptr;
  if (beside != nullptr)
    failJoint(link, std::string("has rotors geared to several rates, and there are ") + beside +
                        ", allowed: one or the other (both together are not modelled)");
}

/** A link that moves contains the gyroscopic rotors of the joints on it: what is left of its
    inertia without them is that of a body. A rotor of inertia J about z is at least a disc, J/2 (1
    + z z'). */
void Validator::requireCarriers() {
  std::vector<bool> rests = {true};
  for (std::size_t i = 1; i < mechanism_.links.size(); ++i) {
    const Link& link = mechanism_.links[i];
    rests.push_back(rests[link.parent] && link.joint.kind == JointKind::kFixed);
  }
  struct Spinning {
    const Link* driven;
    const Vector* axis;
    const Number* inertia;
  };
  std::map<int, std::vector<Spinning>> carriers;
  for (std::size_t i = 1; i < mechanism_.links.size(); ++i) {
    const Link& link = mechanism_.links[i];
    if (rests[link.parent]) continue;
    if (link.joint.gyroscopic)
      carriers[link.parent].push_back({&link, &link.joint.axis, &link.joint.rotor_inertia});
    for (const Rotor& rotor : link.joint.rotors)
      if (rotor.axis) carriers[link.parent].push_back({&link, &*rotor.axis, &rotor.inertia});
  }
  for (const auto& [i, rotors] : carriers) {
    const RationalMatrix& whole = inLinkAxes(static_cast<std::size_t>(i)).inertia;
    Rational size = whole[0][0] + whole[1][1] + whole[2][2];
    is_exact_ = bodies_[i].is_exact;
    // what is left beside the rotors, times `common`: whole numbers need no lowest terms
    Integer common = 1;
    IntegerMatrix left = inWholeNumbers(whole, &common);
    std::string joints;
    for (const Spinning& rotor : rotors) {
      const Joint& joint = rotor.driven->joint;
      joints += (joints.empty() ? "" : ", ") + ('"' + joint.name + '"');
      const RationalVector z = turned(joint.placement.beforeJoint(), vector(*rotor.axis));
      const Rational half = value(*rotor.inertia) / 2;
      size += half;
      // half (1 + z z' / z'z), whatever the length of z
      Integer of_z = 1;
      for (const Rational& x : z) of_z = commonDenominator(of_z, x);
      const Integer n[] = {scaledBy(of_z, z[0]), scaledBy(of_z, z[1]), scaledBy(of_z, z[2])};
      const Integer square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2],
                    factor = bottom(half) * square, share = common * top(half);
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t k = 0; k < 3; ++k)
          left[j][k] = left[j][k] * factor - share * (n[j] * n[k] + (j == k ? square : Integer(0)));
      common *= factor;
    }
    bool is_positive = false;
    const Rational allowance = slack(size);
    for (auto& row : left)
      for (Integer& element : row) element *= bottom(allowance);
    if (isRealizable(left, Integer(top(allowance) * common), &is_positive)) continue;
    failLink(
        mechanism_.links[i],
        "carries the gyroscopic rotor of joint " + joints +
            ", and without it, a disc of that rotor_inertia at the least, its inertia about the "
            "centre of mass is no body's, allowed: an inertia that contains the rotor as it "
            "stands");
  }
}

/// A quaternion of four zeros says nothing about an orientation.
void Validator::requireStart() const {
  std::size_t end = 0;
  for (const Link& link : mechanism_.links) {
    const std::vector<SlotKind>& slots = positionSlots(link.joint.kind);
    end += slots.size();
    if (slots.empty() || slots.back() != SlotKind::kQuaternion) continue;
    const auto first = scene_.start_q.begin() + static_cast<std::ptrdiff_t>(end) - 4;
    if (std::all_of(first, first + 4,
                    [this](const Number& n) { return exactValue(n, values_).isZero(); }))
      failJoint(link, "its quaternion at the start is [0, 0, 0, 0], allowed: any other");
  }
}

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

/// What joins two links must be able to do something: they exist, and a joint between them moves.
void Validator::requireEnds(const std::string& what, int a, int b,
                            const SourceLocation& where) const {
  const std::vector<Link>& links = mechanism_.links;
  for (const int link : {a, b}) {
    if (link >= 0 && link < static_cast<int>(links.size())) continue;
    throw InputError(where, what + fmt::format(": there is no link of index {}", link));
  }
  if (carriers_[static_cast<std::size_t>(a)] != carriers_[static_cast<std::size_t>(b)]) return;
  const auto name = [&links](int link) { return links[static_cast<std::size_t>(link)].name; };
  throw InputError(where, what + ": no joint moves between links \"" + name(a) + "\" and \"" +
                              name(b) + "\", allowed: two links that move on each other");
}

void Validator::requireSpring(const Spring& spring) const {
  const std::string what = "spring \"" + spring.name + '"';
  requireEnds(what, spring.a.link, spring.b.link, spring.where);
  const std::pair<const char*, const Number*> numbers[] = {
      {"stiffness", &spring.stiffness}, {"rest", &spring.rest}, {"damping", &spring.damping}};
  for (const auto& [key, n] : numbers) {
    const double value = exactValue(*n, values_, spring.where).toDouble();
    if (value < 0) {
      throw InputError(spring.where,
                       what + fmt::format(": {} is {}, allowed: zero or more", key, value));
    }
  }
}

}  // namespace

std::vector<std::string> impossibleInertias(const Scene& scene) {
  return Validator(scene).impossibleInertias();
}

void validate(const Scene& scene) {
  validate(scene, InertiaNeed::kOfEachJoint);
}

void validate(const Scene& scene, InertiaNeed need) {
  Validator(scene).run(need);
  validateMotions(scene);
}

void requireInertiaOfJoints(const Scene& scene, const std::string& asked) {
  Validator(scene).requireInertiaFor(asked);
}

}  // namespace dynwitness::scene
