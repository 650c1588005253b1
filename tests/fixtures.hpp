// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of the sweeps share: exact rational arithmetic, random mechanisms whose links are
// clouds of point masses, and the motion of those points by plain 3-D geometry.
//
// Over the rationals an identity holds or it does not: no tolerance is needed. Joint angles are
// points of the circle c = (1 - t^2)/(1 + t^2), s = 2t/(1 + t^2) with a rational t.
#pragma once

#include <cstdint>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <boost/multiprecision/cpp_int.hpp>

#include "crosscheck/arithmetic/eigen_scalar.hpp"
#include "scene/mechanism.hpp"
#include "scene/numbers.hpp"
#include "scene/state.hpp"

namespace dynwitness::fixtures {

/// A rational number as Eigen can hold it. (The bare number type of Boost 1.74 does not compile
/// with Eigen 3.4: it asks every matrix expression whether it is a container of bytes.)
class Q {
 public:
  using Rational = scene::Rational;

  Q() = default;
  Q(int value) : value_(value) {}  // NOLINT(google-explicit-constructor): integers are rationals
  explicit Q(Rational value) : value_(std::move(value)) {}
  explicit Q(double value) : value_(value) {}  ///< exactly the double

  const Rational& rational() const { return value_; }
  double toDouble() const { return value_.convert_to<double>(); }  // within an ulp
  std::string str() const { return value_.str(); }

  friend Q operator+(const Q& a, const Q& b) { return Q(Rational(a.value_ + b.value_)); }
  friend Q operator-(const Q& a, const Q& b) { return Q(Rational(a.value_ - b.value_)); }
  friend Q operator*(const Q& a, const Q& b) { return Q(Rational(a.value_ * b.value_)); }
  friend Q operator/(const Q& a, const Q& b) { return Q(Rational(a.value_ / b.value_)); }
  Q operator-() const { return Q(Rational(-value_)); }
  Q& operator+=(const Q& b) { return value_ += b.value_, *this; }
  Q& operator-=(const Q& b) { return value_ -= b.value_, *this; }
  Q& operator*=(const Q& b) { return value_ *= b.value_, *this; }
  Q& operator/=(const Q& b) { return value_ /= b.value_, *this; }
  friend bool operator==(const Q& a, const Q& b) { return a.value_ == b.value_; }
  friend bool operator!=(const Q& a, const Q& b) { return a.value_ != b.value_; }
  friend bool operator<(const Q& a, const Q& b) { return a.value_ < b.value_; }
  friend bool operator>(const Q& a, const Q& b) { return a.value_ > b.value_; }
  friend bool operator<=(const Q& a, const Q& b) { return a.value_ <= b.value_; }
  friend bool operator>=(const Q& a, const Q& b) { return a.value_ >= b.value_; }
  friend Q abs(const Q& a) { return a.value_ < 0 ? -a : a; }
  friend std::ostream& operator<<(std::ostream& out, const Q& a) { return out << a.value_; }

 private:
  Rational value_ = 0;
};

}  // namespace dynwitness::fixtures

namespace Eigen {
template <>
struct NumTraits<dynwitness::fixtures::Q>
    : dynwitness::crosscheck::EigenScalar<dynwitness::fixtures::Q, 8, 64, 64> {};
}  // namespace Eigen

namespace dynwitness::fixtures {

template <typename T>
using V3 = Eigen::Matrix<T, 3, 1>;
template <typename T>
using M3 = Eigen::Matrix<T, 3, 3>;

inline scene::Number numberOf(const Q& q) {
  return scene::Number(q.rational());
}
inline scene::Vector vectorOf(const V3<Q>& v) {
  return {numberOf(v(0)), numberOf(v(1)), numberOf(v(2))};
}

/// The point of the circle at half-angle tangent t.
inline scene::CosSin<Q> circlePoint(const Q& t) {
  const Q t2 = t * t;
  return {(1 - t2) / (1 + t2), 2 * t / (1 + t2)};
}

/// The square root of a rational that has a rational one. @throws std::domain_error otherwise
inline Q exactRoot(const Q& x) {
  const scene::Integer n = numerator(x.rational()), d = denominator(x.rational());
  if (n < 0) throw std::domain_error("exactRoot: negative");
  const scene::Integer root_n = sqrt(n), root_d = sqrt(d);
  if (root_n * root_n != n || root_d * root_d != d)
    throw std::domain_error("exactRoot: " + x.str() + " is not the square of a rational");
  return Q(scene::Rational(root_n, root_d));
}

/** A scene's numbers as rationals. Quarter turns are exact; any other fixed angle stands for the
   point of the circle whose half-angle tangent is the angle's number (pi counted as 1), so the
   mechanism is another one of the same kind: equal angles are equal points and opposite angles
   opposite points. */
class RationalNumbers {
 public:
  using Scalar = Q;
  explicit RationalNumbers(const scene::Mechanism& mechanism)
      : values_(mechanism.parameterValues()) {}

  Q operator()(const scene::Number& number) const {
    const scene::Exact exact = exactValue(number, values_);
    if (!exact.isRational()) throw std::domain_error("RationalNumbers: pi is not rational");
    return Q(exact.rational);
  }
  scene::CosSin<Q> angle(const scene::Number& radians) const {
    const scene::Exact exact = exactValue(radians, values_);
    int k = 0;
    if (scene::isQuarterTurn(exact, &k)) return scene::quarterTurns<Q>(k);
    return circlePoint(Q(exact.rational) + Q(exact.pi_multiple));
  }
  scene::AxisTurn<Q> axisTurn(const scene::Vector& axis) const {
    const Q x = (*this)(axis[0]), y = (*this)(axis[1]), z = (*this)(axis[2]);
    const Q rho = exactRoot(x * x + y * y), length = exactRoot(x * x + y * y + z * z);
    const scene::CosSin<Q> alpha =
        rho == 0 ? scene::CosSin<Q>{1, 0} : scene::CosSin<Q>{x / rho, y / rho};
    return {alpha, {z / length, rho / length}};
  }

 private:
  scene::ParameterValues values_;
};

/// Seeded small rationals, never zero. (The engine's stream is fixed by the standard.)
class Sampler {
 public:
  explicit Sampler(std::uint64_t seed) : engine_(0x9e3779b97f4a7c15u ^ (seed * 7919u + 17u)) {}

  int pick(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }
  Q positive() { return Q(1 + pick(15)) / 8; }
  Q rational() { return pick(2) == 0 ? positive() : Q(-positive()); }
  V3<Q> vector() { return {rational(), rational(), rational()}; }
  std::vector<Q> rationals(int n) {
    std::vector<Q> v;
    for (int i = 0; i < n; ++i) v.push_back(rational());
    return v;
  }
  scene::CosSin<Q> circle() { return circlePoint(Q((pick(2) == 0 ? 1 : -1) * (1 + pick(7))) / 4); }
  /// A vector of rational length and of rational distance from the z axis.
  V3<Q> axis() {
    static constexpr int kAxes[][3] = {{3, 4, 12},    {-4, 3, 12}, {12, -16, 15}, {-3, -4, -12},
                                       {16, 12, -15}, {-12, 9, 8}, {9, 12, -8},   {5, -12, 84}};
    const int* a = kAxes[pick(8)];
    return V3<Q>(a[0], a[1], a[2]);
  }
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  std::uint64_t bits() { return engine_(); }

 private:
  std::mt19937_64 engine_;
};

/// A mass [kg] at a point of a link's frame [m].
struct Point {
  V3<Q> at;
  Q mass;
};

/// A mechanism and, link by link, the mass points that its inertias were summed from.
struct Tree {
  scene::Mechanism mechanism;
  std::vector<std::vector<Point>> clouds;
};

namespace detail {

template <typename T>
M3<T> rotationX(const scene::CosSin<T>& a) {
  M3<T> R;
  R << T(1), T(0), T(0), T(0), a.c, -a.s, T(0), a.s, a.c;
  return R;
}
template <typename T>
M3<T> rotationY(const scene::CosSin<T>& a) {
  M3<T> R;
  R << a.c, T(0), a.s, T(0), T(1), T(0), -a.s, T(0), a.c;
  return R;
}
template <typename T>
M3<T> rotationZ(const scene::CosSin<T>& a) {
  M3<T> R;
  R << a.c, -a.s, T(0), a.s, a.c, T(0), T(0), T(0), T(1);
  return R;
}

/// Mass properties of a cloud, by the sums that define them.
inline scene::MassProperties massProperties(const std::vector<Point>& cloud, bool about_origin,
                                            const V3<Q>& rpy_half_tangents, bool turned) {
  Q mass = 0;
  V3<Q> moment(0, 0, 0);
  for (const Point& point : cloud) {
    mass += point.mass;
    moment += point.at * point.mass;
  }
  const V3<Q> com = moment / mass;
  M3<Q> R = M3<Q>::Identity();  // link axes turned into the axes in which the six numbers are given
  if (turned)
    R = rotationZ(circlePoint(rpy_half_tangents(2))) *
        rotationY(circlePoint(rpy_half_tangents(1))) * rotationX(circlePoint(rpy_half_tangents(0)));
  M3<Q> I = M3<Q>::Zero();
  for (const Point& point : cloud) {
    const V3<Q> from_point = about_origin ? point.at : V3<Q>(point.at - com);
    const V3<Q> r = R.transpose() * from_point;
    I += (M3<Q>::Identity() * r.dot(r) - r * r.transpose()) * point.mass;
  }
  scene::MassProperties out;
  out.mass = numberOf(mass);
  out.com = vectorOf(com);
  out.about = about_origin ? scene::MassProperties::About::kLinkOrigin
                           : scene::MassProperties::About::kCenterOfMass;
  if (turned) out.rpy = vectorOf(rpy_half_tangents);
  out.xx = numberOf(I(0, 0));
  out.yy = numberOf(I(1, 1));
  out.zz = numberOf(I(2, 2));
  out.xy = numberOf(I(0, 1));
  out.xz = numberOf(I(0, 2));
  out.yz = numberOf(I(1, 2));
  return out;
}

}  // namespace detail

/// What a random tree has besides links and gravity.
struct Features {
  bool fixed_joints = true, rotors = true, springs = true, wrenches = true, gravity = true;
  static Features bare() { return {false, false, false, false, false}; }
};

/** A random branching tree with `moving` revolute and prismatic joints, generic in everything: no
    number is zero, no axis is a coordinate axis (except where DH makes it z), every link is a cloud
   of four to six mass points, placements come in all three conventions. Every third link or so
   hangs on a fixed joint in between. Rational through and through; see RationalNumbers for its
   angles. */
inline Tree randomTree(int moving, std::uint64_t seed, const Features& features = {}) {
  Sampler sample(seed);
  Tree tree;
  scene::Mechanism& m = tree.mechanism;
  if (features.gravity) {
    m.has_gravity = true;
    m.gravity = vectorOf(sample.vector() * Q(5));
  }
  const auto addLink = [&](int parent, scene::JointKind kind) {
    scene::Link link;
    link.name = "link_" + std::to_string(m.links.size());
    link.parent = parent;
    link.joint.name = "joint_" + std::to_string(m.links.size());
    link.joint.kind = kind;
    if (parent >= 0) {
      scene::Placement& place = link.joint.placement;
      const int convention = sample.pick(4);  // xyz + rpy twice as often
      if (convention < 2) {
        place.xyz = vectorOf(sample.vector());
        place.rpy = vectorOf(sample.vector() / Q(2));
        link.joint.axis = vectorOf(sample.axis());
      } else {
        place.convention = convention == 2 ? scene::Placement::Convention::kDh
                                           : scene::Placement::Convention::kMdh;
        place.a = numberOf(sample.rational());
        place.d = numberOf(sample.rational());
        place.alpha = numberOf(sample.rational() / 2);
        place.theta = numberOf(sample.rational() / 2);
      }
    }
    if (kind != scene::JointKind::kFixed && features.rotors) {
      link.joint.rotor_inertia = numberOf(sample.positive() / 4);
      link.joint.gear_ratio = numberOf(sample.positive() + 1);
    }
    if (kind != scene::JointKind::kFixed && features.springs) {
      link.joint.stiffness = numberOf(sample.positive() * 3);
      link.joint.rest = numberOf(sample.rational() / 4);
    }
    std::vector<Point> cloud(static_cast<std::size_t>(4 + sample.pick(3)));
    for (Point& point : cloud) point = {sample.vector() / Q(2), sample.positive() / 2};
    link.inertia = detail::massProperties(cloud, sample.pick(2) == 0, sample.vector() / Q(3),
                                          sample.pick(3) == 0);
    m.links.push_back(link);
    tree.clouds.push_back(cloud);
    return static_cast<int>(m.links.size()) - 1;
  };

  std::vector<int> carriers = {addLink(-1, scene::JointKind::kFixed)};
  for (int i = 0; i < moving; ++i) {
    // long branches rather than a star: one of the last three links, or any
    const int count = static_cast<int>(carriers.size());
    int parent =
        sample.pick(4) == 0
            ? carriers[static_cast<std::size_t>(sample.pick(count))]
            : carriers[static_cast<std::size_t>(count - 1 - sample.pick(count < 3 ? count : 3))];
    if (features.fixed_joints && sample.pick(3) == 0)
      parent = addLink(parent, scene::JointKind::kFixed);
    carriers.push_back(addLink(
        parent, sample.pick(3) == 0 ? scene::JointKind::kPrismatic : scene::JointKind::kRevolute));
  }
  if (features.fixed_joints) addLink(carriers.back(), scene::JointKind::kFixed);  // a fixed leaf
  if (features.wrenches) {
    for (const auto axes : {scene::Wrench::Axes::kLink, scene::Wrench::Axes::kWorld}) {
      scene::Wrench wrench;
      wrench.link = 1 + sample.pick(static_cast<int>(m.links.size()) - 1);
      wrench.force = vectorOf(sample.vector());
      wrench.moment = vectorOf(sample.vector());
      wrench.at = vectorOf(sample.vector() / Q(2));
      wrench.axes = axes;
      m.wrenches.push_back(wrench);
    }
  }
  return tree;
}

/** A tree that floats freely: three slides and three turns in three directions, whose links weigh
    nothing, carry a random tree without rotors, springs or loads. */
inline Tree floatingTree(int moving, std::uint64_t seed, bool gravity) {
  Features features = Features::bare();
  features.fixed_joints = true;
  features.gravity = gravity;
  Tree rest = randomTree(moving, seed, features);
  static constexpr int kAxes[3][3] = {{3, 4, 12}, {-4, 3, 0}, {0, 0, 1}};  // independent
  Tree tree;
  tree.mechanism = rest.mechanism;
  tree.mechanism.links.clear();
  scene::Link world;
  world.name = "world";
  tree.mechanism.links.push_back(world);
  for (int i = 0; i < 6; ++i) {
    scene::Link link;
    link.name = "float_" + std::to_string(i);
    link.parent = i;
    link.joint.name = link.name;
    link.joint.kind = i < 3 ? scene::JointKind::kPrismatic : scene::JointKind::kRevolute;
    const int* axis = kAxes[i % 3];
    link.joint.axis = {scene::Number(axis[0]), scene::Number(axis[1]), scene::Number(axis[2])};
    tree.mechanism.links.push_back(link);
  }
  tree.clouds.assign(7, {});
  for (std::size_t i = 0; i < rest.mechanism.links.size(); ++i) {
    scene::Link link = rest.mechanism.links[i];
    link.parent =
        link.parent < 0 ? 6 : link.parent + 7;  // its root is fixed to the last of the six
    if (link.joint.name.empty() || i == 0) link.joint.name = "mount";
    tree.mechanism.links.push_back(link);
    tree.clouds.push_back(rest.clouds[i]);
  }
  return tree;
}

/// A random state, all of it rational: angles as points of the circle with an unrelated q for
/// springs.
inline scene::State<Q> randomState(int dof, std::uint64_t seed) {
  Sampler sample(seed + 1000003u);
  scene::State<Q> state;
  for (int i = 0; i < dof; ++i) {
    const scene::CosSin<Q> point = sample.circle();
    state.x.push_back({sample.rational(), point.c, point.s});
  }
  state.qd = sample.rationals(dof);
  state.qdd = sample.rationals(dof);
  state.tau = sample.rationals(dof);
  return state;
}

/// Where a link's frame is in the world: x_world = o + R x_link.
template <typename T>
struct Pose {
  M3<T> R;
  V3<T> o;
};

/** Poses of all links, by composing rotations and translations as the scene's author wrote them,
    in active 3 x 3 form; a joint turns by Rodrigues' formula about its own axis. Shares nothing
   with recursive/ and reads only the fields of the scene. T: Q, or duals over Q. */
template <typename T>
std::vector<Pose<T>> linkPoses(const scene::Mechanism& mechanism,
                               const std::vector<scene::JointPosition<T>>& x) {
  const RationalNumbers number(mechanism);
  const auto lifted = [](const Q& q) { return T(q); };
  const auto vector = [&](const scene::Vector& v) {
    return V3<T>(lifted(number(v[0])), lifted(number(v[1])), lifted(number(v[2])));
  };
  const auto angle = [&](const scene::Number& a) {
    const scene::CosSin<Q> p = number.angle(a);
    return scene::CosSin<T>{lifted(p.c), lifted(p.s)};
  };
  std::vector<Pose<T>> poses;
  std::size_t dof = 0;
  for (const scene::Link& link : mechanism.links) {
    if (link.parent < 0) {
      poses.push_back({M3<T>::Identity(), V3<T>::Zero()});
      continue;
    }
    Pose<T> pose = poses[static_cast<std::size_t>(link.parent)];
    const auto move = [&](const V3<T>& r) { pose.o = pose.o + pose.R * r; };
    const auto turn = [&](const M3<T>& R) { pose.R = (pose.R * R).eval(); };
    const scene::Placement& place = link.joint.placement;
    using Convention = scene::Placement::Convention;
    const bool dh = place.convention == Convention::kDh;
    V3<Q> axis(0, 0, 1);
    if (place.convention == Convention::kXyzRpy) {
      move(vector(place.xyz));
      turn(detail::rotationZ(angle(place.rpy[2])));
      turn(detail::rotationY(angle(place.rpy[1])));
      turn(detail::rotationX(angle(place.rpy[0])));
      axis =
          V3<Q>(number(link.joint.axis[0]), number(link.joint.axis[1]), number(link.joint.axis[2]));
      axis /= exactRoot(axis.dot(axis));
    } else if (!dh) {
      turn(detail::rotationX(angle(place.alpha)));
      move({lifted(number(place.a)), T(0), T(0)});
      turn(detail::rotationZ(angle(place.theta)));
      move({T(0), T(0), lifted(number(place.d))});
    }
    const V3<T> u(lifted(axis(0)), lifted(axis(1)), lifted(axis(2)));
    if (link.joint.kind == scene::JointKind::kRevolute) {
      const T c = x[dof].c, s = x[dof].s;
      M3<T> u_hat;
      u_hat << T(0), -u(2), u(1), u(2), T(0), -u(0), -u(1), u(0), T(0);
      const M3<T> R = M3<T>::Identity() + u_hat * s + u_hat * u_hat * (T(1) - c);
      turn(R);
      ++dof;
    } else if (link.joint.kind == scene::JointKind::kPrismatic) {
      move(u * x[dof].q);
      ++dof;
    }
    if (dh) {
      turn(detail::rotationZ(angle(place.theta)));
      move({lifted(number(place.a)), T(0), lifted(number(place.d))});
      turn(detail::rotationX(angle(place.alpha)));
    }
    poses.push_back(pose);
  }
  return poses;
}

/// Where a point of a link's frame is in the world.
template <typename T>
V3<T> placeOf(const Pose<T>& pose, const V3<Q>& at) {
  return pose.o + pose.R * V3<T>(T(at(0)), T(at(1)), T(at(2)));
}

/// The scene's numbers of a vector as rationals.
inline V3<Q> rationalVector(const scene::Mechanism& mechanism, const scene::Vector& v) {
  const RationalNumbers number(mechanism);
  return {number(v[0]), number(v[1]), number(v[2])};
}

/// Empty when two matrices are equal; otherwise shape or first entry that is not, in words.
template <typename A, typename B>
std::string mismatch(const Eigen::MatrixBase<A>& left, const Eigen::MatrixBase<B>& right) {
  std::ostringstream out;
  if (left.rows() != right.rows() || left.cols() != right.cols()) {
    out << "shapes " << left.rows() << " x " << left.cols() << " and " << right.rows() << " x "
        << right.cols();
    return out.str();
  }
  for (Eigen::Index j = 0; j < left.cols(); ++j)
    for (Eigen::Index i = 0; i < left.rows(); ++i)
      if (!(left(i, j) == right(i, j))) {
        out << "[" << i + 1 << "," << j + 1 << "]: " << left(i, j) << " and " << right(i, j);
        return out.str();
      }
  return "";
}
template <typename T>
std::string mismatch(const std::vector<T>& left, const std::vector<T>& right) {
  using Column = Eigen::Matrix<T, Eigen::Dynamic, 1>;
  return mismatch(Eigen::Map<const Column>(left.data(), static_cast<Eigen::Index>(left.size())),
                  Eigen::Map<const Column>(right.data(), static_cast<Eigen::Index>(right.size())));
}

}  // namespace dynwitness::fixtures
