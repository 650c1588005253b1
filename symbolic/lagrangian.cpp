// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/lagrangian.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "scene/numbers.hpp"
#include "scene/work.hpp"

namespace dynwitness::symbolic {

namespace {

// ---- vectors ------------------------------------------------------------------------------------

Vector3 operator+(const Vector3& a, const Vector3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Vector3 operator*(Value s, const Vector3& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
Value dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vector3 column(const Symmetric& m, int j) {
  return {m(0, j), m(1, j), m(2, j)};
}

Symmetric operator+(const Symmetric& a, const Symmetric& b) {
  return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
}
MassMoments operator+(const MassMoments& a, const MassMoments& b) {
  return {a.mass + b.mass, a.first + b.first, a.second + b.second};
}

// ---- elementary motions of a frame --------------------------------------------------------------

/// Coordinates after a rotation to coordinates before it: v_A = R_AB v_B.
Vector3 turnedBack(const FrameStep& r, const Vector3& v) {
  if (r.axis < 0) return v[0] * r.columns[0] + v[1] * r.columns[1] + v[2] * r.columns[2];
  const int x = (r.axis + 1) % 3, y = (r.axis + 2) % 3;
  Vector3 result = v;
  result[x] = r.c * v[x] - r.s * v[y];
  result[y] = r.s * v[x] + r.c * v[y];
  return result;
}

/// Coordinates before a rotation to coordinates after it: v_B = R_AB' v_A.
Vector3 turned(const FrameStep& r, const Vector3& v) {
  if (r.axis < 0) return {dot(r.columns[0], v), dot(r.columns[1], v), dot(r.columns[2], v)};
  const int x = (r.axis + 1) % 3, y = (r.axis + 2) % 3;
  Vector3 result = v;
  result[x] = r.c * v[x] + r.s * v[y];
  result[y] = r.c * v[y] - r.s * v[x];
  return result;
}

/** R I R', for a turn about one axis. With  w = s (I_xx - I_yy) + 2 c I_xy  the turned block is
    [I_xx - s w, c w - I_xy; ., I_yy + s w]: four products in place of ten. */
Symmetric turnedBack(const FrameStep& r, const Symmetric& m) {
  if (r.axis < 0) {
    const std::array<Vector3, 3> R_I = {turnedBack(r, column(m, 0)), turnedBack(r, column(m, 1)),
                                        turnedBack(r, column(m, 2))};
    Symmetric result = m;
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j)
        result(i, j) =
            R_I[0][i] * r.columns[0][j] + R_I[1][i] * r.columns[1][j] + R_I[2][i] * r.columns[2][j];
    return result;
  }
  const int x = (r.axis + 1) % 3, y = (r.axis + 2) % 3, z = r.axis;
  Graph* graph = r.c.graph;
  Symmetric result = m;
  if (graph->isZero(r.s.node)) {  // by 0 or pi
    result(x, z) = r.c * m(x, z);
    result(y, z) = r.c * m(y, z);
    return result;
  }
  result(x, z) = r.c * m(x, z) - r.s * m(y, z);
  result(y, z) = r.s * m(x, z) + r.c * m(y, z);
  if (graph->isZero(r.c.node)) {  // by a right angle
    result(x, x) = m(y, y);
    result(y, y) = m(x, x);
    result(x, y) = -m(x, y);
    return result;
  }
  const Value w = r.s * (m(x, x) - m(y, y)) + r.c * (m(x, y) + m(x, y));
  const Value sw = r.s * w;
  result(x, x) = m(x, x) - sw;
  result(y, y) = m(y, y) + sw;
  result(x, y) = r.c * w - m(x, y);
  return result;
}

/** Moments about a point from which the old origin lies at p:
        first' = first + m p
        second' = second + 2 (p'first) 1 - (p first' + first p') + m (p'p 1 - p p') */
MassMoments shiftedBack(const Vector3& p, const MassMoments& b) {
  MassMoments result = b;
  result.first = b.first + b.mass * p;
  const Vector3 sum = b.first + result.first;
  const Vector3 diagonal = {p[0] * sum[0], p[1] * sum[1], p[2] * sum[2]};
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    result.second(i, i) += diagonal[j] + diagonal[k];
    result.second(i, j) -= p[i] * result.first[j] + p[j] * b.first[i];
  }
  return result;
}

MassMoments movedBack(const FrameStep& step, const MassMoments& b) {
  if (!step.is_rotation) return shiftedBack(step.translation, b);
  return {b.mass, turnedBack(step, b.first), turnedBack(step, b.second)};
}

MassMoments movedBack(const std::vector<FrameStep>& steps, MassMoments b) {
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) b = movedBack(*step, b);
  return b;
}

/** A constant sequence of motions as one: coordinates turn by R, origins shift by p. Three turns
    in a row cost one matrix, and two about different axes no more than themselves. */
struct Placed {
  std::array<Vector3, 3> columns;  ///< of R_AB
  Vector3 p_AB;                    ///< origin of B in A

  Placed(Graph* graph, const std::vector<FrameStep>& steps) {
    const Value zero{graph, graph->constant(0)}, one{graph, graph->constant(1)};
    columns = {{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}};
    p_AB = {zero, zero, zero};
    for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
      if (step->is_rotation) {
        for (Vector3& column : columns) column = symbolic::turnedBack(*step, column);
        p_AB = symbolic::turnedBack(*step, p_AB);
      } else {
        p_AB = step->translation + p_AB;
      }
    }
  }
  Vector3 turned(const Vector3& v_A) const {
    return {dot(columns[0], v_A), dot(columns[1], v_A), dot(columns[2], v_A)};
  }
  Vector3 turnedBack(const Vector3& v_B) const {
    return v_B[0] * columns[0] + v_B[1] * columns[1] + v_B[2] * columns[2];
  }
};

/** The steps themselves while they are few; of many a shift and a turn that stand for all. Along a
    row of fixed links each would otherwise carry the steps of all before it. */
std::vector<FrameStep> shortened(Graph* graph, std::vector<FrameStep> steps) {
  constexpr std::size_t kMostSteps = 16;  // four fixed joints in a row, each with xyz and rpy
  if (steps.size() <= kMostSteps) return steps;
  const Value zero{graph, graph->constant(0)}, one{graph, graph->constant(1)};
  const Placed placed(graph, steps);
  return {{false, 0, one, zero, placed.p_AB},
          {true, -1, one, zero, {zero, zero, zero}, placed.columns}};
}

bool squareRoot(const Rational& square, Rational* root) {
  using boost::multiprecision::sqrt;
  const scene::Integer n = sqrt(scene::Integer(numerator(square)));
  const scene::Integer d = sqrt(scene::Integer(denominator(square)));
  *root = Rational(n, d);
  return *root * *root == square;
}

std::string exactText(const scene::Exact& x) {
  return x.rational.str() + (x.pi_multiple == 0 ? "" : " + " + x.pi_multiple.str() + " pi");
}

const char* const kLetters[] = {"x", "y", "z"};

}  // namespace

Value& Symmetric::operator()(int i, int j) {
  if (i == j) return i == 0 ? xx : i == 1 ? yy : zz;
  return i + j == 1 ? xy : i + j == 2 ? xz : yz;
}

// ---- numbers of the scene -----------------------------------------------------------------------

namespace {

/// Expressions as nodes, with parameters as symbols or as their values.
struct NodeAlgebra {
  Graph* graph;
  bool fold;
  const scene::ParameterValues* values;

  Value number(const Rational& r) const { return {graph, graph->constant(r)}; }
  Value pi() const {
    return {graph, graph->atom({Atom::Kind::kNumber, scene::Number::parse("pi"), {}, "pi"})};
  }
  Value exact(const scene::Exact& x) const {
    Value value = number(x.rational);
    if (x.pi_multiple != 0) value += number(x.pi_multiple) * pi();
    return value;
  }
  Value parameter(const std::string& name) const {
    if (fold) return exact(values->at(name));
    return {graph, graph->atom({Atom::Kind::kNumber, scene::Number::parse(name), {}, name})};
  }
};

}  // namespace

Value Lagrangian::number(const scene::Number& n) {
  const NodeAlgebra algebra{graph_, options_.fold_parameters, &values_};
  if (isExact(n)) return algebra.exact(exactValue(n, values_));
  return scene::evaluateIn<Value>(n, algebra);
}

Vector3 Lagrangian::vector(const scene::Vector& v) {
  return {number(v[0]), number(v[1]), number(v[2])};
}

bool Lagrangian::isExact(const scene::Number& n) const {
  return options_.fold_parameters || n.parameters().empty();
}

std::pair<Value, Value> Lagrangian::cosSin(const scene::Number& angle) {
  scene::Number written = angle;
  std::string name = angle.text();
  bool negate = false;
  if (isExact(angle)) {
    scene::Exact exact = exactValue(angle, values_);
    int quarter = 0;
    if (scene::isQuarterTurn(exact, &quarter)) {
      const auto turns = scene::quarterTurns<int>(quarter);
      return {constant(turns.c), constant(turns.s)};
    }
    const bool is_negative = exact.approximation() < 0;
    if (is_negative) exact = {-exact.rational, -exact.pi_multiple};
    const auto it = angles_.emplace(exactText(exact), std::pair(angle, is_negative)).first;
    written = it->second.first;
    negate = is_negative != it->second.second;
    name = written.text();
  }
  const Value c{graph_, graph_->atom({Atom::Kind::kCos, written, {}, "cos(" + name + ")"})};
  const Value s{graph_, graph_->atom({Atom::Kind::kSin, written, {}, "sin(" + name + ")"})};
  return {c, negate ? -s : s};
}

std::vector<FrameStep> Lagrangian::steps(const std::vector<scene::Step>& scene_steps) {
  const Value zero = constant(0), one = constant(1);
  std::vector<FrameStep> result;
  for (const scene::Step& step : scene_steps) {
    if (step.kind == scene::Step::Kind::kTranslate) {
      result.push_back({false, 0, one, zero, vector(step.translation)});
      continue;
    }
    const int axis = static_cast<int>(step.kind) - static_cast<int>(scene::Step::Kind::kRotateX);
    const auto [c, s] = cosSin(step.angle);
    result.push_back({true, axis, c, s, {zero, zero, zero}});
  }
  return result;
}

std::vector<FrameStep> Lagrangian::axisSteps(const scene::Vector& axis, int* coordinate,
                                             bool* reversed) {
  std::array<scene::Exact, 3> exact;
  std::array<bool, 3> is_zero;
  bool all_rational = true;
  for (int i = 0; i < 3; ++i) {
    exact[i] = exactValue(axis[i], values_);
    is_zero[i] = isExact(axis[i]) && exact[i].isZero();
    all_rational = all_rational && isExact(axis[i]) && exact[i].isRational();
  }
  for (int i = 0; i < 3; ++i) {
    // the sign of a symbol is not known here: only a number may say that the axis is reversed
    if (is_zero[(i + 1) % 3] && is_zero[(i + 2) % 3] && isExact(axis[i])) {
      *coordinate = i;
      *reversed = exact[i].approximation() < 0;
      return {};
    }
  }
  *coordinate = 2;
  *reversed = false;

  // z to the axis: Rz(alpha) Ry(beta), each exact where its square roots are
  const Value zero = constant(0), one = constant(1);
  const std::string text =
      "(" + axis[0].text() + ", " + axis[1].text() + ", " + axis[2].text() + ")";
  const int label = axes_.emplace(text, bodyCount() + 1).first->second;
  const auto symbol = [&](Atom::Kind kind, const std::string& what) {
    // with a space, which no parameter's name has
    return Value{graph_,
                 graph_->atom({kind, 0, axis, what + " axis" + std::to_string(label) + ")"})};
  };
  Value cos_alpha, sin_alpha, cos_beta, sin_beta;
  Rational rho, length;
  const bool rho_exact = all_rational && squareRoot(exact[0].rational * exact[0].rational +
                                                        exact[1].rational * exact[1].rational,
                                                    &rho);
  if (rho_exact) {
    cos_alpha = constant(exact[0].rational / rho);
    sin_alpha = constant(exact[1].rational / rho);
  } else {
    cos_alpha = is_zero[0] ? zero : symbol(Atom::Kind::kCosAlpha, "cos(alpha");
    sin_alpha = is_zero[1] ? zero : symbol(Atom::Kind::kSinAlpha, "sin(alpha");
  }
  if (rho_exact && squareRoot(rho * rho + exact[2].rational * exact[2].rational, &length)) {
    cos_beta = constant(exact[2].rational / length);
    sin_beta = constant(rho / length);
  } else {
    cos_beta = is_zero[2] ? zero : symbol(Atom::Kind::kCosBeta, "cos(beta");
    sin_beta = is_zero[2] ? one : symbol(Atom::Kind::kSinBeta, "sin(beta");
  }
  return {{true, 2, cos_alpha, sin_alpha, {zero, zero, zero}},
          {true, 1, cos_beta, sin_beta, {zero, zero, zero}}};
}

MassMoments Lagrangian::linkMoments(const scene::MassProperties& inertia) {
  const Value zero = constant(0), one = constant(1);
  MassMoments b{number(inertia.mass),
                {zero, zero, zero},
                {number(inertia.xx), number(inertia.yy), number(inertia.zz), number(inertia.xy),
                 number(inertia.xz), number(inertia.yz)}};
  for (int axis : {0, 1, 2}) {  // R = Rz(yaw) Ry(pitch) Rx(roll)
    const auto [c, s] = cosSin(inertia.rpy[axis]);
    b.second = turnedBack(FrameStep{true, axis, c, s, {zero, zero, zero}}, b.second);
  }
  const Vector3 com = vector(inertia.com);
  if (inertia.about == scene::MassProperties::About::kCenterOfMass)
    return movedBack(FrameStep{false, 0, one, zero, com}, b);
  b.first = b.mass * com;
  return b;
}

// ---- bodies -------------------------------------------------------------------------------------

Lagrangian::Lagrangian(const scene::Mechanism& mechanism, const Options& options, Graph* graph)
    : mechanism_(mechanism),
      options_(options),
      graph_(graph),
      values_(mechanism.parameterValues()),
      followers_(scene::followers(mechanism)) {
  const Value zero = constant(0);
  const MassMoments nothing{zero, {zero, zero, zero}, {zero, zero, zero, zero, zero, zero}};
  world_ = nothing;
  // symbols in the order in which the scene declares them
  if (!options_.fold_parameters)
    for (const scene::Parameter& p : mechanism.parameters) number(scene::Number::parse(p.name));
  gravity_ = mechanism.has_gravity ? vector(mechanism.gravity) : Vector3{zero, zero, zero};

  const auto append = [](std::vector<FrameStep>* to, const std::vector<FrameStep>& more) {
    to->insert(to->end(), more.begin(), more.end());
  };
  for (const scene::Link& link : mechanism.links) {
    WorldOrBodyFrame frame{-1, {}};
    if (link.parent >= 0) frame = frames_[link.parent];
    append(&frame.offset, steps(link.joint.placement.beforeJoint()));
    frame.offset = shortened(graph_, std::move(frame.offset));
    if (scene::degreesOfFreedom(link.joint.kind) > 0) addBodies(link, &frame);
    append(&frame.offset, steps(link.joint.placement.afterJoint()));
    const MassMoments moments = movedBack(frame.offset, linkMoments(link.inertia));
    MassMoments& carrier = frame.body < 0 ? world_ : bodies_[frame.body].moments;
    carrier = carrier + moments;
    frames_.push_back(frame);
  }
  if (options_.regroup_inertias) regroup();
}

/// The link that a joint carries, and the massless ones between the parts of the joint.
void Lagrangian::addBodies(const scene::Link& link, WorldOrBodyFrame* frame) {
  using scene::JointKind;
  using Part = Body::Joint;
  const scene::Joint& joint = link.joint;
  std::vector<std::pair<Part, int>> parts;  // what it does, and along which axis of the joint frame
  switch (joint.kind) {
    case JointKind::kFixed:
      return;
    case JointKind::kRevolute:
      parts = {{Part::kTurn, 2}};
      break;
    case JointKind::kPrismatic:
      parts = {{Part::kSlide, 2}};
      break;
    case JointKind::kHelical:
      parts = {{Part::kScrew, 2}};
      break;
    case JointKind::kCylindrical:
      parts = {{Part::kSlide, 2}, {Part::kTurn, 2}};
      break;
    case JointKind::kUniversal:
      parts = {{Part::kTurn, 0}, {Part::kTurn, 1}};
      break;
    case JointKind::kPlanar:
      parts = {{Part::kSlide, 0}, {Part::kSlide, 1}, {Part::kTurn, 2}};
      break;
    case JointKind::kSpherical:
      parts = {{Part::kBall, 2}};
      break;
    case JointKind::kFloating:
      parts = {{Part::kFree, 2}};
      break;
  }
  const Value zero = constant(0);
  const MassMoments nothing{zero, {zero, zero, zero}, {zero, zero, zero, zero, zero, zero}};
  const std::vector<std::string>& rates = scene::rateNames(joint.kind);
  const Value gear = number(joint.gear_ratio), rotor = gear * gear * number(joint.rotor_inertia);
  const Value spin = joint.gyroscopic ? gear * number(joint.rotor_inertia) : zero;
  std::vector<FrameStep> to_axis;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    Body body{link.name,
              joint.name,
              frame->body,
              parts[k].first,
              0,
              0,
              parts[k].second,
              false,
              frame->offset,
              nothing,
              rotor,
              spin,
              number(joint.stiffness),
              number(joint.rest),
              number(joint.pitch),
              constant(1)};
    if (parts.size() > 1) body.joint_name += "." + rates[k];
    if (k + 1 < parts.size()) body.name += "." + rates[k];
    body.rate = rates_;
    body.slot = slots_;
    slots_ += body.rates() + (body.hasOneRate() ? 0 : 1);
    if (!joint.mimic) rates_ += body.rates();
    if (joint.mimic) {
      const scene::Follower& f = followers_[next_follower_++];
      body.follows = true;
      body.rate = f.rate;
      body.ratio = constant(f.multiplier);
    }
    if (k == 0 && joint.kind == JointKind::kPlanar) {
      to_axis = uprightSteps(joint.axis);  // which x and y are matters
    } else if (k == 0 && scene::hasAxis(joint.kind)) {
      to_axis = axisSteps(joint.axis, &body.axis, &body.reversed);
    } else if (joint.kind == JointKind::kCylindrical) {
      body.axis = bodies_.back().axis;
      body.reversed = bodies_.back().reversed;
    }
    if (k == 0) body.before.insert(body.before.end(), to_axis.begin(), to_axis.end());
    *frame = {bodyCount(), {}};
    bodies_.push_back(body);
  }
  for (auto step = to_axis.rbegin(); step != to_axis.rend(); ++step) {
    FrameStep back = *step;
    back.s = -back.s;
    frame->offset.push_back(back);
  }
}

/// Rz(alpha) Ry(beta), which takes z to an axis, for coordinate axes too.
std::vector<FrameStep> Lagrangian::uprightSteps(const scene::Vector& axis) {
  int coordinate = 2;
  bool reversed = false;
  std::vector<FrameStep> steps = axisSteps(axis, &coordinate, &reversed);
  const Value zero = constant(0);
  const auto quarters = [&](int about, int count) {
    const auto turn = scene::quarterTurns<int>(count);
    if (count != 0)
      steps.push_back({true, about, constant(turn.c), constant(turn.s), {zero, zero, zero}});
  };
  if (!steps.empty()) return steps;
  if (coordinate == 0) quarters(2, reversed ? 2 : 0);
  if (coordinate == 1) quarters(2, reversed ? -1 : 1);
  quarters(1, coordinate != 2 ? 1 : reversed ? 2 : 0);
  return steps;
}

void Lagrangian::regroup() {
  const Value zero = constant(0);
  for (int i = bodyCount() - 1; i >= 0; --i) {
    Body& body = bodies_[i];
    MassMoments inboard{zero, {zero, zero, zero}, {zero, zero, zero, zero, zero, zero}};
    if (body.joint != Body::Joint::kTurn && body.joint != Body::Joint::kSlide) continue;
    if (body.turns()) {
      // a mass distribution that looks the same from all sides of the axis, without inertia about
      // the axis itself, does not notice whether it turns with the joint
      const int x = (body.axis + 1) % 3, y = (body.axis + 2) % 3, z = body.axis;
      inboard.mass = body.moments.mass;
      inboard.first[z] = body.moments.first[z];
      inboard.second(x, x) = inboard.second(y, y) = body.moments.second(y, y);
      body.moments.mass = body.moments.first[z] = zero;
      body.moments.second(x, x) -= inboard.second(x, x);
      body.moments.second(y, y) = zero;
    } else {
      // a slider turns as its inboard body does
      inboard.second = body.moments.second;
      body.moments.second = {zero, zero, zero, zero, zero, zero};
    }
    inboard = movedBack(body.before, inboard);
    MassMoments& carrier = body.parent < 0 ? world_ : bodies_[body.parent].moments;
    carrier = carrier + inboard;
  }
}

std::vector<Lagrangian::Axis> Lagrangian::axesOf(int i) {
  const Body& body = bodies_[i];
  std::vector<Axis> axes;
  for (int k = 0; k < body.rates(); ++k) {
    Value qd{graph_, graph_->input(Input::kVelocity, body.rate + k)};
    if (body.follows) qd = body.ratio * qd;
    if (body.hasOneRate()) {
      const bool shifts = body.joint == Body::Joint::kSlide || body.joint == Body::Joint::kScrew;
      axes.push_back({body.axis, body.turns(), shifts, body.rate, body.reversed ? -qd : qd});
    } else {
      const bool shifts = k + 3 < body.rates();
      axes.push_back({k % 3, !shifts, shifts, body.rate + k, qd});
    }
  }
  return axes;
}

std::vector<FrameStep> Lagrangian::jointSteps(int i) {
  const Body& body = bodies_[i];
  const Value zero = constant(0), one = constant(1);
  const auto position = [&](int slot) {
    return Value{graph_, graph_->input(Input::kPosition, slot)};
  };
  std::vector<FrameStep> result;
  if (!body.hasOneRate()) {
    if (body.joint == Body::Joint::kFree)
      result.push_back({false,
                        0,
                        one,
                        zero,
                        {position(body.slot), position(body.slot + 1), position(body.slot + 2)}});
    FrameStep turn{true, -1, one, zero, {zero, zero, zero}};
    for (int row = 0; row < 3; ++row)
      for (int j = 0; j < 3; ++j)
        turn.columns[j][row] = {
            graph_, graph_->input(Input::kRotation, rotationEntry(body.quaternion(), row, j))};
    result.push_back(turn);
    return result;
  }
  if (body.turns()) {
    FrameStep turn{true, body.axis, one, zero, {zero, zero, zero}};
    turn.c = {graph_, graph_->input(Input::kCos, body.slot)};
    turn.s = {graph_, graph_->input(Input::kSin, body.slot)};
    if (body.reversed) turn.s = -turn.s;
    result.push_back(turn);
  }
  if (body.joint != Body::Joint::kTurn) {
    FrameStep shift{false, body.axis, one, zero, {zero, zero, zero}};
    const Value q = position(body.slot), along = body.reversed ? -q : q;
    shift.translation[body.axis] = body.joint == Body::Joint::kScrew ? body.pitch * along : along;
    result.push_back(shift);
  }
  return result;
}

std::vector<Direction> Lagrangian::directions() {
  const Node one = graph_->constant(1);
  std::vector<Direction> all;
  for (int i = 0; i < bodyCount(); ++i) {
    const Body& body = bodies_[i];
    if (body.follows) continue;
    if (body.hasOneRate()) {
      all.push_back({{{Input::kPosition, body.slot}, one}});
      continue;
    }
    const std::array<Vector3, 3> R = jointSteps(i).back().columns;
    if (body.joint == Body::Joint::kFree) {  // dp/dt = R v
      for (int k = 0; k < 3; ++k) {
        all.emplace_back();
        for (int row = 0; row < 3; ++row)
          all.back().push_back({{Input::kPosition, body.slot + row}, R[k][row].node});
      }
    }
    for (int k = 0; k < 3; ++k) {  // dR/dt = R [e_k]x: the next column moves to the one after it
      const int next = (k + 1) % 3, last = (k + 2) % 3;
      all.emplace_back();
      for (int row = 0; row < 3; ++row) {
        const auto entry = [&](int j) {
          return Variable{Input::kRotation, rotationEntry(body.quaternion(), row, j)};
        };
        all.back().push_back({entry(next), R[last][row].node});
        all.back().push_back({entry(last), (-R[next][row]).node});
      }
    }
  }
  for (const Body& body : bodies_)  // a leader's rate moves its followers too
    if (body.follows) all[body.rate].push_back({{Input::kPosition, body.slot}, body.ratio.node});
  return all;
}

int Lagrangian::parallelInboard(int body) {
  if (bodies_[body].joint != Body::Joint::kTurn) return -1;
  const Value zero = constant(0);
  Vector3 direction{zero, zero, zero};
  direction[bodies_[body].axis] = constant(bodies_[body].reversed ? -1 : 1);
  for (int k = body; bodies_[k].parent >= 0;) {
    direction = Placed(graph_, bodies_[k].before).turnedBack(direction);
    k = bodies_[k].parent;
    if (bodies_[k].joint == Body::Joint::kSlide) continue;
    if (bodies_[k].joint != Body::Joint::kTurn) return -1;
    const Node along = direction[bodies_[k].axis].node;
    return along == graph_->constant(bodies_[k].reversed ? -1 : 1) ? k : -1;
  }
  return -1;
}

// ---- energies -----------------------------------------------------------------------------------

std::vector<Lagrangian::Velocities> Lagrangian::velocities() {
  const Value zero = constant(0);
  std::vector<Velocities> all;
  for (int i = 0; i < bodyCount(); ++i) {
    const Body& body = bodies_[i];
    Velocities v{{zero, zero, zero}, {zero, zero, zero}, zero};
    if (body.parent >= 0) v = all[body.parent];
    // as part of the parent, in the axes of the joint
    const Placed placed(graph_, body.before);
    v.linear = placed.turned(v.linear + cross(v.angular, placed.p_AB));
    v.angular = placed.turned(v.angular);
    v.inboard = v.angular[body.axis];  // the joint's own motion leaves its axis where it is
    // and with the joint's own motion
    for (const FrameStep& step : jointSteps(i)) {
      if (step.is_rotation) {
        v.angular = turned(step, v.angular);
        v.linear = turned(step, v.linear);
      } else {
        v.linear = v.linear + cross(v.angular, step.translation);
      }
    }
    for (const Axis& axis : axesOf(i)) {
      if (axis.turns) v.angular[axis.coordinate] += axis.rate;
      if (axis.shifts) v.linear[axis.coordinate] += axis.turns ? body.pitch * axis.rate : axis.rate;
    }
    const std::string number = std::to_string(i + 1);
    for (int k = 0; k < 3; ++k) {
      graph_->setName(v.angular[k].node, "omega" + number + kLetters[k]);
      graph_->setName(v.linear[k].node, "v" + number + kLetters[k]);
    }
    all.push_back(v);
  }
  return all;
}

std::vector<Value> Lagrangian::kineticByVelocities() {
  const Value half = constant(Rational(1, 2));
  const std::vector<Velocities> v = velocities();
  std::vector<Value> shares;
  for (int i = 0; i < bodyCount(); ++i) {
    const MassMoments& b = bodies_[i].moments;
    const Vector3& omega = v[i].angular;
    Value T =
        half * b.mass * dot(v[i].linear, v[i].linear) + dot(b.first, cross(v[i].linear, omega));
    for (int j = 0; j < 3; ++j) {
      T += half * b.second(j, j) * (omega[j] * omega[j]);
      for (int k = j + 1; k < 3; ++k) T += b.second(j, k) * (omega[j] * omega[k]);
    }
    const Value rate = axesOf(i)[0].rate;  // rotors go with joints of one rate
    T += half * bodies_[i].rotor * (rate * rate) + bodies_[i].spin * rate * v[i].inboard;
    shares.push_back(T);
  }
  return shares;
}

Value Lagrangian::kineticByCompositeBodies() {
  const Value zero = constant(0), half = constant(Rational(1, 2));
  std::vector<MassMoments> composite;
  std::vector<Vector3> linear(bodyCount(), {zero, zero, zero});   // h of the outboard bodies,
  std::vector<Vector3> angular(bodyCount(), {zero, zero, zero});  // about the body's origin
  for (const Body& body : bodies_) composite.push_back(body.moments);

  Value T = zero;
  for (int i = bodyCount() - 1; i >= 0; --i) {
    const Body& body = bodies_[i];
    const MassMoments& b = composite[i];
    const std::vector<Axis> axes = axesOf(i);
    for (const Axis& axis : axes) {
      const Value qd = axis.rate;
      // momentum when the joint moves at unit rate
      Vector3 s{zero, zero, zero};
      s[axis.coordinate] = constant(1);
      Vector3 unit_linear, unit_angular;
      Value inertia, outboard;
      if (!axis.shifts) {
        unit_linear = cross(s, b.first);
        unit_angular = column(b.second, axis.coordinate);
        inertia = unit_angular[axis.coordinate];
        outboard = angular[i][axis.coordinate];
      } else if (!axis.turns) {
        unit_linear = b.mass * s;
        unit_angular = cross(b.first, s);
        inertia = b.mass;
        outboard = linear[i][axis.coordinate];
      } else {
        const Vector3 advance = body.pitch * s;
        unit_linear = cross(s, b.first) + b.mass * advance;
        unit_angular = column(b.second, axis.coordinate) + cross(b.first, advance);
        inertia = unit_angular[axis.coordinate] + body.pitch * unit_linear[axis.coordinate];
        outboard = angular[i][axis.coordinate] + body.pitch * linear[i][axis.coordinate];
      }
      T += half * (inertia + body.rotor) * (qd * qd) + qd * outboard;
      if (body.parent < 0 && axes.size() == 1) break;
      linear[i] = linear[i] + qd * unit_linear;
      angular[i] = angular[i] + qd * unit_angular;
      if (axes.size() == 1)
        angular[i][axis.coordinate] += body.spin * qd;  // the rotor inboard spins too
    }
    if (body.parent < 0) continue;
    // to the parent's axes and origin
    const std::vector<FrameStep> joint = jointSteps(i);
    const Placed placed(graph_, body.before);
    for (auto step = joint.rbegin(); step != joint.rend(); ++step) {
      if (step->is_rotation) {
        linear[i] = turnedBack(*step, linear[i]);
        angular[i] = turnedBack(*step, angular[i]);
      } else {
        angular[i] = angular[i] + cross(step->translation, linear[i]);
      }
    }
    linear[i] = placed.turnedBack(linear[i]);
    angular[i] = placed.turnedBack(angular[i]) + cross(placed.p_AB, linear[i]);
    linear[body.parent] = linear[body.parent] + linear[i];
    angular[body.parent] = angular[body.parent] + angular[i];
    composite[body.parent] = composite[body.parent] + movedBack(body.before, movedBack(joint, b));
  }
  return T;
}

std::vector<Value> Lagrangian::potentialByBody() {
  const Value zero = constant(0), half = constant(Rational(1, 2));
  std::vector<Value> shares;
  for (int i = 0; i < bodyCount(); ++i) {
    // the body's first moment, carried to the world
    MassMoments b = bodies_[i].moments;
    b.second = {zero, zero, zero, zero, zero, zero};
    for (int k = i; k >= 0; k = bodies_[k].parent)
      b = movedBack(bodies_[k].before, movedBack(jointSteps(k), b));
    const Value stretch =
        Value{graph_, graph_->input(Input::kPosition, bodies_[i].slot)} - bodies_[i].rest;
    shares.push_back(-dot(gravity_, b.first) + half * bodies_[i].stiffness * (stretch * stretch));
  }
  return shares;
}

Value Lagrangian::potential() {
  const Value half = constant(Rational(1, 2));
  std::vector<MassMoments> composite;
  for (const Body& body : bodies_) composite.push_back(body.moments);
  Vector3 first = world_.first;
  Value V = constant(0);
  for (int i = bodyCount() - 1; i >= 0; --i) {
    const Body& body = bodies_[i];
    const MassMoments b = movedBack(body.before, movedBack(jointSteps(i), composite[i]));
    if (body.parent < 0)
      first = first + b.first;
    else
      composite[body.parent] = composite[body.parent] + b;
    const Value stretch = Value{graph_, graph_->input(Input::kPosition, body.slot)} - body.rest;
    V += half * body.stiffness * (stretch * stretch);
  }
  return V - dot(gravity_, first);
}

Value Lagrangian::wrenchPower() {
  Value power = constant(0);
  const std::vector<Velocities> v = velocities();
  for (const scene::Wrench& wrench : mechanism_.wrenches) {
    const WorldOrBodyFrame& frame = frames_[wrench.link];
    if (frame.body < 0) continue;  // the world does not move
    Vector3 force = vector(wrench.force), moment = vector(wrench.moment), at = vector(wrench.at);
    const Placed placed(graph_, frame.offset);
    at = placed.p_AB + placed.turnedBack(at);
    if (wrench.axes == scene::Wrench::Axes::kLink) {
      force = placed.turnedBack(force);
      moment = placed.turnedBack(moment);
    } else {
      std::vector<int> path;  // from the world to the body
      for (int k = frame.body; k >= 0; k = bodies_[k].parent) path.push_back(k);
      std::reverse(path.begin(), path.end());
      for (int k : path) {
        const Placed at_zero(graph_, bodies_[k].before);
        force = at_zero.turned(force);
        moment = at_zero.turned(moment);
        for (const FrameStep& step : jointSteps(k)) {
          if (!step.is_rotation) continue;
          force = turned(step, force);
          moment = turned(step, moment);
        }
      }
    }
    const Velocities& body = v[frame.body];
    power += dot(force, body.linear + cross(body.angular, at)) + dot(moment, body.angular);
  }
  return power;
}

Value Lagrangian::dissipation() {
  const Value half = constant(Rational(1, 2));
  Value R = constant(0);
  for (std::size_t i = 0; i < mechanism_.links.size(); ++i) {
    const scene::Friction& friction = mechanism_.links[i].joint.friction;
    if (friction.isNone()) continue;
    const Body& body = bodies_[frames_[i].body];
    Value qd{graph_, graph_->input(Input::kVelocity, body.rate)};
    Value sign{graph_, graph_->input(Input::kDirection, body.rate)};
    if (body.follows) {
      qd = body.ratio * qd;
      if (graph_->value(body.ratio.node) < 0) sign = -sign;
    }
    const Value positive = number(friction.positive), negative = number(friction.negative);
    R += half * number(friction.viscous) * (qd * qd);
    // positive at sign 1, -negative at sign -1, 0 at 0
    R += half * ((positive + negative) * sign + (positive - negative) * (sign * sign)) * qd;
  }
  return R;
}

// ---- closures -----------------------------------------------------------------------------------

Lagrangian::PlacedFrame Lagrangian::inWorld(const scene::Attachment& at) {
  const Value zero = constant(0), one = constant(1);
  PlacedFrame frame{{zero, zero, zero},
                    {{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}}};
  const auto moveBack = [&frame](const FrameStep& step) {
    if (!step.is_rotation) {
      frame.origin = step.translation + frame.origin;
      return;
    }
    frame.origin = turnedBack(step, frame.origin);
    for (Vector3& axis : frame.axes) axis = turnedBack(step, axis);
  };
  const auto allBack = [&](const std::vector<FrameStep>& steps) {
    for (auto step = steps.rbegin(); step != steps.rend(); ++step) moveBack(*step);
  };
  allBack(steps(at.steps()));
  allBack(frames_[at.link].offset);
  for (int k = frames_[at.link].body; k >= 0; k = bodies_[k].parent) {
    allBack(jointSteps(k));
    allBack(bodies_[k].before);
  }
  return frame;
}

std::vector<Value> Lagrangian::placeAndAxes(const scene::Attachment& at) {
  const PlacedFrame frame = inWorld(at);
  std::vector<Value> all;
  for (const Vector3& v : {frame.origin, frame.axes[0], frame.axes[1], frame.axes[2]})
    for (const int k : {0, 1, 2}) all.push_back(v[k]);
  return all;
}

std::vector<Value> Lagrangian::closureResiduals() {
  std::vector<Value> phi;
  for (const scene::Closure& closure : mechanism_.closures) {
    const PlacedFrame a = inWorld(closure.a), b = inWorld(closure.b);
    const Vector3 d = b.origin + constant(-1) * a.origin;
    if (closure.kind == scene::ClosureKind::kDistance) {
      const Value length = number(closure.length);
      phi.push_back(constant(Rational(1, 2)) * (dot(d, d) - length * length));
      continue;
    }
    if (closure.kind == scene::ClosureKind::kPlane) {
      phi.push_back(dot(a.axes[2], d));
      continue;
    }
    const Value all[] = {dot(a.axes[0], d),         dot(a.axes[1], d),
                         dot(a.axes[2], d),         dot(a.axes[0], b.axes[2]),
                         dot(a.axes[1], b.axes[2]), dot(a.axes[0], b.axes[1])};
    phi.insert(phi.end(), all, all + scene::equationCount(closure.kind));
  }
  return phi;
}

// ---- equations ----------------------------------------------------------------------------------

namespace {

Node combined(Graph& graph, const Direction& direction,
              const std::map<std::pair<Input, int>, Node>& slope) {
  Node sum;
  for (const auto& [variable, node] : direction)
    sum = graph.add(sum, graph.multiply(slope.at({variable.input, variable.joint}), node));
  return sum;
}

/// b_ijk of a joint's rates, turns and shifts, as (j, k, sign) for one i.
struct Bracket {
  int j, k, sign;
};
std::vector<Bracket> brackets(const QuasiJoint& joint, int i) {
  std::vector<Bracket> out;
  const int turns = joint.rate + (joint.floats ? 3 : 0);
  for (const int shift : {1, 2}) {  // e_a x e_b = sign e_c
    const int a = (i - joint.rate) % 3, b = (a + shift) % 3, c = (a + 3 - shift) % 3;
    const int sign = shift == 1 ? 1 : -1;
    if (i >= turns) {
      out.push_back({turns + b, turns + c, sign});  // [turn, turn] = turn
      if (joint.floats)
        out.push_back({joint.rate + b, joint.rate + c, sign});  // [turn, shift] = shift
    } else {
      out.push_back({turns + b, joint.rate + c, sign});  // [shift, turn] = shift
    }
  }
  return out;
}

}  // namespace

std::vector<Node> positionGradient(Equations& e, Node f) {
  std::vector<Variable> variables;
  std::map<std::pair<Input, int>, Node> slope;
  for (const Direction& direction : e.directions)
    for (const auto& [variable, node] : direction)
      if (slope.emplace(std::pair(variable.input, variable.joint), Node{}).second)
        variables.push_back(variable);
  const std::vector<Node> slopes = e.graph.gradient(f, variables);
  for (std::size_t i = 0; i < variables.size(); ++i)
    slope[{variables[i].input, variables[i].joint}] = slopes[i];
  std::vector<Node> result;
  for (const Direction& direction : e.directions)
    result.push_back(combined(e.graph, direction, slope));
  return result;
}

Direction motion(Equations& e, bool with_accelerations) {
  Graph& graph = e.graph;
  std::vector<Variable> order;
  std::map<std::pair<Input, int>, Node> speed;
  for (int i = 0; i < e.dof(); ++i) {
    const Node qd = graph.input(Input::kVelocity, i);
    for (const auto& [variable, node] : e.directions[i]) {
      const auto [it, is_new] = speed.emplace(std::pair(variable.input, variable.joint), Node{});
      if (is_new) order.push_back(variable);
      it->second = graph.add(it->second, graph.multiply(node, qd));
    }
  }
  Direction result;
  for (const Variable& variable : order)
    result.push_back({variable, speed[{variable.input, variable.joint}]});
  if (with_accelerations)
    for (int i = 0; i < e.dof(); ++i)
      result.push_back({{Input::kVelocity, i}, graph.input(Input::kAcceleration, i)});
  return result;
}

std::vector<Node> structureTerms(Equations& e, const std::vector<Node>& p) {
  Graph& graph = e.graph;
  std::vector<Node> terms(p.size());
  for (const QuasiJoint& joint : e.quasi) {
    for (int i = joint.rate; i < joint.rate + (joint.floats ? 6 : 3); ++i) {
      for (const Bracket& b : brackets(joint, i)) {
        const Node term = graph.multiply(graph.input(Input::kVelocity, b.j), p[b.k]);
        terms[i] = b.sign > 0 ? graph.add(terms[i], term) : graph.subtract(terms[i], term);
      }
    }
  }
  return terms;
}

void formEnergies(const scene::Mechanism& mechanism, Lagrangian& lagrangian, Equations& e) {
  Graph& graph = e.graph;
  const std::vector<Body>& bodies = lagrangian.bodies();
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b) {
    const Body& body = bodies[b];
    e.links.push_back(body.name);
    if (!body.hasOneRate())
      e.quasi.push_back(
          {body.joint_name, body.joint == Body::Joint::kFree, body.rate, body.quaternion()});
    for (int k = 0; k < body.rates() && !body.follows; ++k)
      e.revolute.push_back(body.hasOneRate() ? body.turns() : k + 3 >= body.rates());
  }
  e.slots = lagrangian.slots();
  e.joints = mechanism.rateLabels();
  e.directions = lagrangian.directions();
  std::vector<Variable> qd;
  for (int i = 0; i < e.dof(); ++i) {
    // angles add up where bodies, rates and positions are counted alike
    e.parallel_inboard.push_back(
        e.quasi.empty() && !mechanism.hasMimics() ? lagrangian.parallelInboard(i) : -1);
    qd.push_back({Input::kVelocity, i});
  }

  for (const Value& share : lagrangian.kineticByVelocities()) {
    e.link_kinetic.push_back(share.node);
    e.kinetic = graph.add(e.kinetic, share.node);
  }
  e.potential = lagrangian.potential().node;
  e.p = graph.gradient(e.kinetic, qd);  // (1)
}

void formForces(Lagrangian& lagrangian, Equations& e) {
  std::vector<Variable> qd;
  for (int i = 0; i < e.dof(); ++i) qd.push_back({Input::kVelocity, i});
  e.Q = e.graph.gradient(lagrangian.wrenchPower().node, qd);  // (5)
  e.friction = e.graph.gradient(lagrangian.dissipation().node, qd);
  for (int i = 0; i < e.dof(); ++i) e.Q[i] = e.graph.subtract(e.Q[i], e.friction[i]);
}

namespace {

/// Of a chain of 100 joints M derived, compiled and printed took 24 kB an entry.
constexpr double kBytesOfMassEntry = 24e3, kMostMassEntries = 80200;

void formCoriolisAndGravity(Lagrangian& lagrangian, Equations& e) {
  Graph& graph = e.graph;
  const std::vector<Node> p_rate = graph.directionalDerivative(e.p, motion(e));
  const std::vector<Node> dT_dq = positionGradient(e, e.kinetic);
  const std::vector<Node> structure = structureTerms(e, e.p);
  for (int i = 0; i < e.dof(); ++i)
    e.c.push_back(graph.add(graph.subtract(p_rate[i], dT_dq[i]), structure[i]));  // (3), (3')
  e.g = positionGradient(e, e.potential);                                         // (4)
  formForces(lagrangian, e);
}

/// Pairs of a rate and one inboard of it or the same.
double massEntries(const std::vector<Body>& bodies) {
  double entries = 0;
  std::vector<int> rates_inboard;
  for (const Body& body : bodies) {
    rates_inboard.push_back(body.rates() + (body.parent < 0 ? 0 : rates_inboard[body.parent]));
    entries += body.rates() * rates_inboard.back();
  }
  return entries;
}

/// Before anything is derived.
void requireMassMatrixFits(const Lagrangian& lagrangian) {
  const double entries = massEntries(lagrangian.bodies());
  if (entries > kMostMassEntries)
    throw scene::InputError(
        {}, fmt::format("M has {:.0f} entries to derive on and above its diagonal, {:.1f} GB of "
                        "operations; allowed: {:.0f}, such as those of a chain of 400 joints",
                        entries, entries * kBytesOfMassEntry / 1e9, kMostMassEntries));
}

void formMassMatrix(Lagrangian& lagrangian, Equations& e) {
  Graph& graph = e.graph;
  const std::vector<Body>& bodies = lagrangian.bodies();
  const int n = e.dof();
  std::vector<std::vector<int>> bodies_of_rate(n);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (int k = 0; k < bodies[b].rates(); ++k)
      bodies_of_rate[bodies[b].rate + k].push_back(static_cast<int>(b));
  const double entries = massEntries(bodies);
  std::vector<Variable> qd;
  for (int i = 0; i < n; ++i) qd.push_back({Input::kVelocity, i});

  // (2): column j is the momentum that a unit rate of joint j alone (and of those that follow it)
  // gives to itself and to the joints inboard of it; the others come from symmetry, or share no
  // body with j
  const std::vector<Node> p_composite =
      graph.gradient(lagrangian.kineticByCompositeBodies().node, qd);
  e.M.assign(n, std::vector<Node>(n));
  scene::Work work("M derived", entries, 1);
  for (int j = 0; j < n; ++j) {
    std::vector<int> inboard;
    for (const int body : bodies_of_rate[j])
      for (int b = body; b >= 0; b = bodies[b].parent)
        for (int k = 0; k < bodies[b].rates(); ++k) inboard.push_back(bodies[b].rate + k);
    work.done(static_cast<double>(inboard.size()));
    if (e.hasFollowers()) {
      // the joints of one rate may hang on those of another, and the other way round: all pairs are
      // asked
      inboard.resize(n);
      std::iota(inboard.begin(), inboard.end(), 0);
    }
    std::vector<Node> p;
    for (int i : inboard) p.push_back(p_composite[i]);
    const std::vector<Node> columns = graph.directionalDerivative(p, {{qd[j], graph.constant(1)}});
    for (std::size_t k = 0; k < inboard.size(); ++k)
      e.M[inboard[k]][j] = e.M[j][inboard[k]] = columns[k];
  }
}

}  // namespace

Equations deriveGravity(const scene::Mechanism& mechanism, const Options& options) {
  Equations e;
  Lagrangian lagrangian(mechanism, options, &e.graph);
  formEnergies(mechanism, lagrangian, e);
  e.g = positionGradient(e, e.potential);
  return e;
}

Equations deriveForces(const scene::Mechanism& mechanism, const Options& options) {
  Equations e;
  Lagrangian lagrangian(mechanism, options, &e.graph);
  formEnergies(mechanism, lagrangian, e);
  formCoriolisAndGravity(lagrangian, e);
  return e;
}

void addMassMatrix(const scene::Mechanism& mechanism, const Options& options, Equations& e) {
  Lagrangian lagrangian(mechanism, options, &e.graph);  // finds the nodes that it made before
  requireMassMatrixFits(lagrangian);
  formMassMatrix(lagrangian, e);
}

Equations derive(const scene::Mechanism& mechanism, const Options& options) {
  Equations e;
  Lagrangian lagrangian(mechanism, options, &e.graph);
  requireMassMatrixFits(lagrangian);
  formEnergies(mechanism, lagrangian, e);
  formCoriolisAndGravity(lagrangian, e);
  formMassMatrix(lagrangian, e);
  // link by link from the world, O(n depth): for readers
  for (const Value& share : lagrangian.potentialByBody()) e.link_potential.push_back(share.node);
  return e;
}

namespace {

/// Functions of the position with their derivatives along the motion.
ClosureEquations differentiated(const std::vector<Value>& functions, Equations& e) {
  Graph& graph = e.graph;
  ClosureEquations closures;
  for (const Value& phi : functions) closures.phi.push_back(phi.node);
  std::vector<Node> phi_rate;
  for (const Node phi : closures.phi) {
    closures.J.push_back(positionGradient(e, phi));
    Node rate;
    for (int i = 0; i < e.dof(); ++i)
      rate =
          graph.add(rate, graph.multiply(closures.J.back()[i], graph.input(Input::kVelocity, i)));
    phi_rate.push_back(rate);
  }
  closures.gamma = graph.directionalDerivative(phi_rate, motion(e));
  return closures;
}

}  // namespace

ClosureEquations closureEquations(const scene::Mechanism& mechanism, const Options& options,
                                  Equations& e) {
  return differentiated(Lagrangian(mechanism, options, &e.graph).closureResiduals(), e);
}

ClosureEquations frameEquations(const scene::Mechanism& mechanism, const Options& options,
                                const std::vector<scene::Attachment>& frames, Equations& e) {
  Lagrangian lagrangian(mechanism, options, &e.graph);
  std::vector<Value> places;
  for (const scene::Attachment& frame : frames)
    for (const Value& component : lagrangian.placeAndAxes(frame)) places.push_back(component);
  return differentiated(places, e);
}

std::vector<std::vector<Node>> christoffelMatrix(Equations& e) {
  const int n = e.dof();
  Graph& graph = e.graph;
  const Direction moving = motion(e);
  std::vector<std::vector<Node>> A;  // A[j][i] = X_j p_i
  for (int j = 0; j < n; ++j) A.push_back(graph.directionalDerivative(e.p, e.directions[j]));
  std::vector<std::vector<Node>> C(n, std::vector<Node>(n));
  const Node half = graph.constant(Rational(1, 2));
  for (int i = 0; i < n; ++i) {
    const std::vector<Node> M_rate = graph.directionalDerivative(e.M[i], moving);
    for (int j = 0; j < n; ++j)
      C[i][j] = graph.multiply(half, graph.add(M_rate[j], graph.subtract(A[j][i], A[i][j])));
  }
  for (const QuasiJoint& joint : e.quasi)
    for (int i = joint.rate; i < joint.rate + (joint.floats ? 6 : 3); ++i)
      for (const Bracket& b : brackets(joint, i))
        C[i][b.j] =
            b.sign > 0 ? graph.add(C[i][b.j], e.p[b.k]) : graph.subtract(C[i][b.j], e.p[b.k]);
  return C;
}

std::vector<Node> inverseDynamics(Equations& e) {
  Graph& graph = e.graph;
  const std::vector<Node> p_rate = graph.directionalDerivative(e.p, motion(e, true));
  const std::vector<Node> structure = structureTerms(e, e.p);
  const std::vector<Node> lagrangian_slope =
      positionGradient(e, graph.subtract(e.kinetic, e.potential));
  std::vector<Node> tau;
  for (int i = 0; i < e.dof(); ++i)
    tau.push_back(graph.add(graph.subtract(graph.subtract(p_rate[i], lagrangian_slope[i]), e.Q[i]),
                            structure[i]));
  return tau;
}

std::vector<Node> massCoriolisGravity(const Equations& e) {
  std::vector<Node> outputs;
  for (const std::vector<Node>& row : e.M) outputs.insert(outputs.end(), row.begin(), row.end());
  outputs.insert(outputs.end(), e.c.begin(), e.c.end());
  outputs.insert(outputs.end(), e.g.begin(), e.g.end());
  return outputs;
}

}  // namespace dynwitness::symbolic
