// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/rereading/placing.hpp"

#include <cmath>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

namespace dynwitness::crosscheck::rereading {
namespace {

/** Roundings, of kLoss each, that an entry of a matrix here sees at most: of a product of two 3 x 3
    matrices 5 (in the 2-norm 3 times that), of a matrix as printed 4 of sines and 5 of
    operations. */
constexpr double kRoundings = 32;

double size(const Real& x) {
  return static_cast<double>(abs(x));
}
double length(const Column& v) {
  return std::hypot(size(v[0]), size(v[1]), size(v[2]));
}
/// Frobenius norm, which is no less than the 2-norm.
double norm(const Square& m) {
  return std::hypot(length(m[0]), length(m[1]), length(m[2]));
}
Real dot(const Column& a, const Column& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Column operator*(const Square& m, const Column& v) {
  return {dot(m[0], v), dot(m[1], v), dot(m[2], v)};
}
Square transposed(const Square& m) {
  Square out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out[i][j] = m[j][i];
  return out;
}
Square operator*(const Square& a, const Square& b) {
  const Square columns = transposed(b);
  Square out;
  for (int i = 0; i < 3; ++i) out[i] = columns * a[i];
  return out;
}

struct Angle {
  Real c, s;
  double error;
  explicit Angle(const Value& x)
      : c(cos(x.value)), s(sin(x.value)), error(x.error + kLoss * (1 + x.size())) {}
};

double errorOf(const Vector& v) {
  return v[0].error + v[1].error + v[2].error;
}

Frame moved(const Vector& v) {
  Frame out;
  out.p = {v[0].value, v[1].value, v[2].value};
  out.moved = errorOf(v);
  return out;
}

/** Standard Denavit-Hartenberg, as printed:
    [ct -st ca  st sa  a ct; st  ct ca -ct sa  a st; 0 sa ca d]. */
Frame denavitHartenberg(const Value& a, const Value& alpha, const Value& d, const Value& theta) {
  const Angle t(theta), l(alpha);
  Frame out;
  out.R = {{{t.c, -t.s * l.c, t.s * l.s}, {t.s, t.c * l.c, -t.c * l.s}, {0, l.s, l.c}}};
  out.p = {a.value * t.c, a.value * t.s, d.value};
  out.turned = t.error + l.error + kRoundings * kLoss;
  out.moved = a.error + d.error + a.size() * (t.error + kRoundings * kLoss);
  return out;
}

/** Modified (Craig's), as printed:
    [ct -st 0 a; st ca  ct ca  -sa  -sa d; st sa  ct sa  ca  ca d]. */
Frame modifiedDenavitHartenberg(const Value& a, const Value& alpha, const Value& d,
                                const Value& theta) {
  const Angle t(theta), l(alpha);
  Frame out;
  out.R = {{{t.c, -t.s, 0}, {t.s * l.c, t.c * l.c, -l.s}, {t.s * l.s, t.c * l.s, l.c}}};
  out.p = {a.value, -l.s * d.value, l.c * d.value};
  out.turned = t.error + l.error + kRoundings * kLoss;
  out.moved = a.error + d.error + d.size() * (l.error + kRoundings * kLoss);
  return out;
}

/// Of length 1.
struct Direction {
  Column n;
  double error;
  explicit Direction(const Vector& v) {
    const Column given = {v[0].value, v[1].value, v[2].value};
    const Real long_as = sqrt(dot(given, given));
    if (long_as == 0) throw std::runtime_error("an axis without a direction");
    for (int i = 0; i < 3; ++i) n[i] = given[i] / long_as;
    error = 2 * errorOf(v) / static_cast<double>(long_as) + kRoundings * kLoss;
  }
};

/// Rodrigues: R = c 1 + (1 - c) n n' + s [n]x.
Frame turnAbout(const Direction& axis, const Value& q) {
  const Angle t(q);
  const Column& n = axis.n;
  const Real left = 1 - t.c;
  Frame out;
  out.R = {
      {{t.c + left * n[0] * n[0], left * n[0] * n[1] - t.s * n[2], left * n[0] * n[2] + t.s * n[1]},
       {left * n[1] * n[0] + t.s * n[2], t.c + left * n[1] * n[1], left * n[1] * n[2] - t.s * n[0]},
       {left * n[2] * n[0] - t.s * n[1], left * n[2] * n[1] + t.s * n[0],
        t.c + left * n[2] * n[2]}}};
  out.turned = 5 * axis.error + t.error + kRoundings * kLoss;
  return out;
}

Frame slideAlong(const Direction& axis, const Value& q) {
  Frame out;
  for (int i = 0; i < 3; ++i) out.p[i] = axis.n[i] * q.value;
  out.moved = q.error + q.size() * (axis.error + kLoss);
  return out;
}

/// Of a quaternion w, x, y, z of any length, as printed for one of length 1.
Frame turnOf(const double* q) {
  const Real a(q[0]), b(q[1]), c(q[2]), d(q[3]), square = a * a + b * b + c * c + d * d;
  if (square == 0) throw std::runtime_error("a quaternion that is 0");
  Frame out;
  out.R = {{{a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
            {2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)},
            {2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d}}};
  for (Column& row : out.R)
    for (Real& x : row) x /= square;
  out.turned = kRoundings * kLoss;
  return out;
}

/// Axes whose third is n, the others those of Rz(alpha) Ry(beta): (z x, z y, -r)/r, (-y, x, 0)/r.
Frame standingOn(const Direction& normal) {
  const auto& [x, y, z] = normal.n;
  const Real r = sqrt(x * x + y * y);
  Frame out;
  if (r == 0) {
    out.R = {{{z, 0, 0}, {0, 1, 0}, {0, 0, z}}};
    return out;
  }
  out.R = {{{z * x / r, -y / r, x}, {z * y / r, x / r, y}, {-r, 0, z}}};
  out.turned = 4 * (normal.error + kRoundings * kLoss) / static_cast<double>(r);
  return out;
}
Frame backwards(const Frame& turn) {
  Frame out = turn;
  out.R = transposed(turn.R);
  return out;
}

/// Parent's link frame to link frame. @param q  the joint's own positions
Frame acrossJoint(const Joint& joint, const std::vector<Value>& q, const double* quaternion) {
  Value slide, turn;  // along and about one axis
  if (joint.kind == "revolute" || joint.kind == "helical") turn = q[0];
  if (joint.kind == "helical") slide = joint.pitch * q[0];
  if (joint.kind == "prismatic") slide = q[0];
  if (joint.kind == "cylindrical") {
    slide = q[0];
    turn = q[1];
  }
  if (joint.form == Joint::Form::kDh)
    return denavitHartenberg(joint.a, joint.alpha, joint.d + slide, joint.theta + turn);
  if (joint.form == Joint::Form::kMdh)
    return modifiedDenavitHartenberg(joint.a, joint.alpha, joint.d + slide, joint.theta + turn);
  const Frame at = movedAndTurned(joint.xyz, joint.rpy);
  if (joint.kind == "fixed") return at;
  if (joint.kind == "spherical") return at * turnOf(quaternion);
  if (joint.kind == "floating") return at * moved({q[0], q[1], q[2]}) * turnOf(quaternion);
  if (joint.kind == "universal")
    return at * turnAbout(Direction({1, 0, 0}), q[0]) * turnAbout(Direction({0, 1, 0}), q[1]);
  const Direction axis(joint.axis);
  if (joint.kind == "planar") {
    const Frame plane = standingOn(axis);
    return at * plane * moved({q[0], q[1], 0}) * backwards(plane) * turnAbout(axis, q[2]);
  }
  if (joint.kind == "revolute") return at * turnAbout(axis, turn);
  if (joint.kind == "prismatic") return at * slideAlong(axis, slide);
  return at * slideAlong(axis, slide) * turnAbout(axis, turn);
}

/// The position of each joint that has one, followers where their leaders put them.
class Positions {
 public:
  Positions(const Description& description, const std::vector<double>& q)
      : links_(description.links), q_(q) {
    int first = 0;
    for (std::size_t i = 0; i < links_.size(); ++i) {
      first_.push_back(first);
      first += positionCount(links_[i].joint.kind);
      by_joint_.emplace(links_[i].joint.name, i);
    }
    if (first != static_cast<int>(q.size()))
      throw std::runtime_error(fmt::format("{} positions, expected {}", q.size(), first));
  }

  std::vector<Value> of(std::size_t link) const {
    const Joint& joint = links_[link].joint;
    if (joint.follows) return {followed(link)};
    std::vector<Value> out;
    for (int k = 0; k < positionCount(joint.kind); ++k)
      out.push_back(Value::of(q_[first_[link] + k]));
    return out;
  }
  /// Where its quaternion begins.
  const double* quaternionOf(std::size_t link) const {
    const int before = links_[link].joint.kind == "floating" ? 3 : 0;
    return q_.data() + first_[link] + before;
  }

 private:
  Value followed(std::size_t link) const {
    Value ratio = 1, offset;  // q = ratio q_leader + offset
    for (std::size_t steps = 0; links_[link].joint.follows; ++steps) {
      const Following& follows = *links_[link].joint.follows;
      offset = ratio * follows.offset + offset;
      ratio = ratio * follows.multiplier;
      const auto leader = by_joint_.find(follows.leader);
      if (leader == by_joint_.end() || steps > links_.size())
        throw std::runtime_error(fmt::format("nobody leads '{}'", links_[link].joint.name));
      link = leader->second;
    }
    return ratio * Value::of(q_.at(first_[link])) + offset;
  }

  const std::vector<Link>& links_;
  const std::vector<double>& q_;
  std::vector<int> first_;
  std::unordered_map<std::string, std::size_t> by_joint_;
};

}  // namespace

Frame operator*(const Frame& a, const Frame& b) {
  Frame out;
  out.R = a.R * b.R;
  out.p = a.R * b.p;
  for (int i = 0; i < 3; ++i) out.p[i] += a.p[i];
  out.turned = a.turned + b.turned + kRoundings * kLoss;
  const double far = length(b.p);
  out.moved = a.moved + a.turned * far + b.moved + kRoundings * kLoss * (length(a.p) + far);
  return out;
}

Frame movedAndTurned(const Vector& xyz, const Vector& rpy) {
  Frame out = moved(xyz);
  if (rpy[0].value == 0 && rpy[1].value == 0 && rpy[2].value == 0) {
    out.turned = errorOf(rpy);
    return out;
  }
  const Angle r(rpy[0]), p(rpy[1]), y(rpy[2]);
  out.R = {{{y.c * p.c, y.c * p.s * r.s - y.s * r.c, y.c * p.s * r.c + y.s * r.s},
            {y.s * p.c, y.s * p.s * r.s + y.c * r.c, y.s * p.s * r.c - y.c * r.s},
            {-p.s, p.c * r.s, p.c * r.c}}};
  out.turned = r.error + p.error + y.error + kRoundings * kLoss;
  return out;
}

Frame frameOf(const Anchor& anchor) {
  return movedAndTurned(anchor.xyz, anchor.rpy);
}

int positionCount(const std::string& kind) {
  static const std::unordered_map<std::string, int> kCounts = {
      {"fixed", 0},     {"revolute", 1}, {"prismatic", 1}, {"helical", 1}, {"cylindrical", 2},
      {"universal", 2}, {"planar", 3},   {"spherical", 4}, {"floating", 7}};
  const auto found = kCounts.find(kind);
  if (found == kCounts.end()) throw std::runtime_error(fmt::format("a joint is '{}'", kind));
  return found->second;
}

int positionCount(const Description& description) {
  int count = 0;
  for (const Link& link : description.links) count += positionCount(link.joint.kind);
  return count;
}

std::vector<Frame> placed(const Description& description, const std::vector<double>& q) {
  const Positions positions(description, q);
  std::vector<Frame> out;
  for (std::size_t i = 0; i < description.links.size(); ++i) {
    const Link& link = description.links[i];
    out.push_back(link.parent < 0
                      ? Frame()
                      : out[static_cast<std::size_t>(link.parent)] *
                            acrossJoint(link.joint, positions.of(i), positions.quaternionOf(i)));
  }
  return out;
}

void PseudoInertia::add(const PseudoInertia& other) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) S[i][j] += other.S[i][j];
    h[i] += other.h[i];
  }
  mass += other.mass;
  error_S += other.error_S + kLoss * norm(S);
  error_h += other.error_h + kLoss * length(h);
  error_mass += other.error_mass + kLoss * size(mass);
}

PseudoInertia PseudoInertia::seenFrom(const Frame& frame) const {
  const Column turned_h = frame.R * h;
  const Square turned_S = frame.R * S * transposed(frame.R);
  const Column& p = frame.p;
  PseudoInertia out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      out.S[i][j] = turned_S[i][j] + turned_h[i] * p[j] + p[i] * turned_h[j] + mass * p[i] * p[j];
    out.h[i] = turned_h[i] + mass * p[i];
  }
  out.mass = mass;
  const double far = length(p), of_S = norm(S), of_h = length(h), m = size(mass);
  const double turned = frame.turned + kRoundings * kLoss, moved = frame.moved;
  out.error_mass = error_mass;
  out.error_h = error_h + turned * of_h + far * error_mass + (moved + kRoundings * kLoss * far) * m;
  out.error_S = error_S + 2 * turned * of_S + 2 * (far * (error_h + turned * of_h) + moved * of_h) +
                far * far * error_mass + 2 * (moved + kRoundings * kLoss * far) * far * m;
  return out;
}

Square PseudoInertia::inertia() const {
  const Real trace = S[0][0] + S[1][1] + S[2][2];
  Square out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out[i][j] = (i == j ? trace : Real(0)) - S[i][j];
  return out;
}
double PseudoInertia::errorOfInertia() const {
  return 4 * (error_S + kLoss * norm(S));
}

PseudoInertia pseudoInertia(const Solid& solid) {
  PseudoInertia own;  // in the axes of the six numbers, about the point that they are about
  const Real half = (solid.xx.value + solid.yy.value + solid.zz.value) / 2;
  own.S = {{{half - solid.xx.value, -solid.xy.value, -solid.xz.value},
            {-solid.xy.value, half - solid.yy.value, -solid.yz.value},
            {-solid.xz.value, -solid.yz.value, half - solid.zz.value}}};
  for (const Value* x : {&solid.xx, &solid.yy, &solid.zz, &solid.xy, &solid.xz, &solid.yz})
    own.error_S += 4 * (x->error + kLoss * x->size());
  PseudoInertia point;
  point.mass = solid.mass.value;
  point.error_mass = solid.mass.error;
  if (solid.about_com) {
    PseudoInertia out = own.seenFrom(movedAndTurned({}, solid.rpy));
    out.add(point.seenFrom(moved(solid.com)));
    return out;
  }
  // about the origin: the mass has its moment h, and S has what it is worth already
  PseudoInertia out = own.seenFrom(movedAndTurned({}, solid.rpy));
  point = point.seenFrom(moved(solid.com));
  point.S = {};
  point.error_S = 0;
  out.add(point);
  return out;
}

std::vector<Body> weighed(const Description& description) {
  std::vector<Body> out;
  std::vector<int> body;       // by link: which it is a part of
  std::vector<Frame> on_body;  // and where it is on the link that gives that its frame
  for (std::size_t i = 0; i < description.links.size(); ++i) {
    const Link& link = description.links[i];
    if (link.parent >= 0 && link.joint.kind == "fixed") {
      body.push_back(body[static_cast<std::size_t>(link.parent)]);
      on_body.push_back(on_body[static_cast<std::size_t>(link.parent)] *
                        acrossJoint(link.joint, {}, nullptr));
    } else {
      body.push_back(static_cast<int>(out.size()));
      on_body.emplace_back();
      out.push_back({static_cast<int>(i), {}});
    }
    out[static_cast<std::size_t>(body.back())].inertia.add(
        pseudoInertia(link.solid).seenFrom(on_body.back()));
  }
  return out;
}

}  // namespace dynwitness::crosscheck::rereading
