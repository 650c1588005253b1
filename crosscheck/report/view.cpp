// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/view.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <boost/math/constants/constants.hpp>
#include <nlohmann/json.hpp>

#include "crosscheck/report/assets.hpp"
#include "crosscheck/report/text.hpp"
#include "scene/mimic.hpp"
#include "scene/numbers.hpp"
#include "scene/turn.hpp"

namespace dynwitness::crosscheck {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;
using Numbers = scene::RealNumbers<double>;
using scene::JointKind;
using scene::SlotKind;

constexpr double kPi = boost::math::constants::pi<double>();

Vector3d vectorOf(const scene::Vector& v, const Numbers& number) {
  return {number(v[0]), number(v[1]), number(v[2])};
}

Matrix3d turnOf(double angle, int axis) {
  return scene::turnAbout(axis, scene::CosSin<double>{std::cos(angle), std::sin(angle)});
}

Isometry3d frameOf(const std::vector<scene::Step>& steps, const Numbers& number) {
  using Kind = scene::Step::Kind;
  Isometry3d frame = Isometry3d::Identity();
  for (const scene::Step& step : steps)
    if (step.kind == Kind::kTranslate)
      frame.translate(vectorOf(step.translation, number));
    else
      frame.rotate(scene::turnAbout(step.kind == Kind::kRotateX   ? 0
                                    : step.kind == Kind::kRotateY ? 1
                                                                  : 2,
                                    number.angle(step.angle)));
  return frame;
}

/// Coordinates in axes of which z is the joint's, to joint axes.
Isometry3d axesOf(const scene::Vector& axis, const Numbers& number) {
  const scene::AxisTurn<double> turn = number.axisTurn(axis);
  Isometry3d axes = Isometry3d::Identity();
  axes.rotate(scene::turnAbout(2, turn.alpha) * scene::turnAbout(1, turn.beta));
  return axes;
}

ViewBody bodyOf(int link, const scene::MassProperties& m, const Numbers& number) {
  ViewBody body;
  body.link = link;
  body.mass = number(m.mass);
  body.com = vectorOf(m.com, number);
  const Matrix3d R = scene::turnAbout(2, number.angle(m.rpy[2])) *
                     scene::turnAbout(1, number.angle(m.rpy[1])) *
                     scene::turnAbout(0, number.angle(m.rpy[0]));
  Matrix3d I;
  const double xy = number(m.xy), xz = number(m.xz), yz = number(m.yz);
  I << number(m.xx), xy, xz, xy, number(m.yy), yz, xz, yz, number(m.zz);
  body.inertia = R * I * R.transpose();
  if (m.about == scene::MassProperties::About::kLinkOrigin)
    body.inertia -= body.mass * (body.com.squaredNorm() * Matrix3d::Identity() -
                                 body.com * body.com.transpose());
  return body;
}

/// Which of a joint's positions, in words.
std::string slotWord(JointKind kind, std::size_t k) {
  static constexpr const char* kFloating[] = {"x", "y", "z", "w", "qx", "qy", "qz"};
  if (kind == JointKind::kFloating) return kFloating[k];
  if (kind == JointKind::kSpherical) return kFloating[k + 3];
  return scene::rateNames(kind)[k];
}

/// "q3", "q1..q7"
std::string range(int first, std::size_t count) {
  return count == 1 ? fmt::format("q{}", first)
                    : fmt::format("q{}..q{}", first, first + static_cast<int>(count) - 1);
}

void addJoints(const scene::Scene& scene, const Numbers& number,
               const std::vector<scene::UrdfPart>& parts, View* view) {
  const std::vector<scene::Link>& links = scene.mechanism.links;
  const std::vector<scene::Number> rest = scene.mechanism.restPosition();
  const std::vector<scene::Follower> followers = scene::followers(scene.mechanism);
  std::vector<int> number_of_slot;  // "q3" is 3; 0 for those of followers
  auto follower = followers.begin();
  int given = 0;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const scene::Joint& joint = links[i].joint;
    const std::vector<SlotKind>& slots = scene::positionSlots(joint.kind);
    ViewLink link;
    link.name = oneLine(links[i].name);
    link.joint = oneLine(joint.name);
    link.parent = links[i].parent;
    link.kind = link.parent < 0 ? JointKind::kFixed : joint.kind;
    const Isometry3d axes =
        joint.kind == JointKind::kFixed ? Isometry3d::Identity() : axesOf(joint.axis, number);
    link.before = frameOf(joint.placement.beforeJoint(), number) * axes;
    link.after = axes.inverse() * frameOf(joint.placement.afterJoint(), number);
    if (joint.kind == JointKind::kHelical) link.pitch = number(joint.pitch);
    link.slot = static_cast<int>(view->slots.size());
    if (!slots.empty() && !joint.mimic) link.label = range(given + 1, slots.size());
    const bool follows = follower != followers.end() && follower->link == static_cast<int>(i);
    if (follows) {
      link.leader_slot = follower->leader_slot;
      link.multiplier = number(scene::Number(follower->multiplier));
      link.offset = number(follower->offset);
      ++follower;
    }
    for (std::size_t k = 0; k < slots.size(); ++k) {
      ViewSlot slot;
      if (!follows) slot.name = fmt::format("q{}", ++given);
      const std::string word = slotWord(joint.kind, k);
      slot.label = link.joint + (word.empty() ? "" : "." + word);
      slot.kind = slots[k];
      slot.start = number(scene.start_q[view->slots.size()]);
      slot.rest = number(rest[view->slots.size()]);
      if (slot.kind == SlotKind::kQuaternion)
        slot.quaternion = link.slot + static_cast<int>(slots.size()) - 4;
      if (slots.size() == 1 && i < parts.size() && parts[i].limits) {
        slot.lower = number(parts[i].limits->lower);
        slot.upper = number(parts[i].limits->upper);
        slot.is_limited = slot.lower < slot.upper;
      }
      view->slots.push_back(slot);
      number_of_slot.push_back(follows ? 0 : given);
    }
    view->links.push_back(link);
  }
  for (ViewLink& link : view->links)
    if (link.leader_slot >= 0)
      link.label = fmt::format("= {:.4g} q{}{}", link.multiplier,
                               number_of_slot[static_cast<std::size_t>(link.leader_slot)],
                               link.offset == 0 ? "" : fmt::format(" {:+.4g}", link.offset));
}

std::vector<double> startOf(const View& view) {
  std::vector<double> q;
  for (const ViewSlot& slot : view.slots) q.push_back(slot.start);
  return q;
}

/// What a free joint turns or slides on a slider.
void setRanges(View* view) {
  for (ViewSlot& slot : view->slots) {
    if (slot.is_limited) continue;
    const double reach = slot.kind == SlotKind::kAngle    ? kPi
                         : slot.kind == SlotKind::kLength ? 0.7 * view->radius
                                                          : 1;
    const double middle = slot.kind == SlotKind::kLength ? slot.start : 0;
    slot.lower = std::min(middle - reach, slot.start);
    slot.upper = std::max(middle + reach, slot.start);
  }
}

/// The axis about which all joints of a mechanism in a plane turn, if it is one.
std::optional<Vector3d> planarAxis(const View& view, const ViewPlaces& places) {
  constexpr double kParallel = 0.999, kAcross = 0.05;
  std::optional<Vector3d> axis;
  for (std::size_t i = 0; i < view.links.size(); ++i) {
    const JointKind kind = view.links[i].kind;
    if (kind == JointKind::kFixed || kind == JointKind::kPrismatic) continue;
    if (kind != JointKind::kRevolute && kind != JointKind::kPlanar) return {};
    const Vector3d z = places.before[i].linear().col(2);
    if (!axis) axis = z;
    if (std::abs(axis->dot(z)) < kParallel) return {};
  }
  for (std::size_t i = 0; i < view.links.size() && axis; ++i)
    if (view.links[i].kind == JointKind::kPrismatic &&
        std::abs(axis->dot(places.before[i].linear().col(2))) > kAcross)
      return {};
  return axis;
}

/// Where it is seen from: all of it, upright, and a mechanism in a plane from above that.
void aim(const scene::Scene& scene, const Numbers& number, View* view) {
  const ViewPlaces places = placesOf(*view, startOf(*view));
  const std::optional<Vector3d> axis = planarAxis(*view, places);
  const Vector3d gravity =
      scene.mechanism.has_gravity ? vectorOf(scene.mechanism.gravity, number) : Vector3d::Zero();
  view->has_gravity = gravity.norm() > 0;
  if (view->has_gravity)
    view->up = -gravity.normalized();
  else if (axis && std::abs(axis->z()) > 0.5)
    view->up = Vector3d::UnitY();
  int k = 0;  // the coordinate axis that is most across
  view->up.cwiseAbs().minCoeff(&k);
  Vector3d ahead = Vector3d::Unit(k);
  ahead -= view->up * view->up.dot(ahead);
  view->ahead = ahead.normalized();
  view->azimuth = -0.95;
  view->elevation = 0.38;
  if (axis && std::abs(axis->dot(view->up)) < 0.5) {
    int largest = 0;
    axis->cwiseAbs().maxCoeff(&largest);
    const Vector3d from = (*axis)(largest) < 0 ? Vector3d(-*axis) : *axis;
    view->azimuth = std::atan2(from.dot(view->up.cross(view->ahead)), from.dot(view->ahead)) + 0.3;
    view->elevation = 0.2;
  }
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  const auto take = [&](const Vector3d& x, double around) {
    low = low.cwiseMin(x - Vector3d::Constant(around));
    high = high.cwiseMax(x + Vector3d::Constant(around));
  };
  for (std::size_t i = 0; i < view->links.size(); ++i)
    for (const auto* frames : {&places.before, &places.moved, &places.link})
      take((*frames)[i].translation(), 0);
  for (const ViewBody& body : view->bodies) {
    if (body.mass == 0) continue;
    Vector3d halves = Vector3d::Zero();
    Matrix3d axes;
    ellipsoidOf(body, &halves, &axes);
    take(places.link[static_cast<std::size_t>(body.link)] * body.com, halves.maxCoeff());
  }
  view->center = (low + high) / 2;
  const double radius = (high - low).norm() / 2;
  view->radius = radius > 0 ? 1.1 * radius : 1;
  view->glyph = view->radius * 0.13 / std::sqrt(1 + static_cast<double>(view->links.size()) / 12);
}

ViewPair pairOf(const std::string& name, const std::string& kind, const scene::Attachment& a,
                const scene::Attachment& b, const Numbers& number) {
  ViewPair pair;
  pair.name = oneLine(name);
  pair.kind = kind;
  pair.link_a = a.link;
  pair.link_b = b.link;
  pair.a = frameOf(a.steps(), number);
  pair.b = frameOf(b.steps(), number);
  return pair;
}

Isometry3d motionOf(const ViewLink& link, const double* q) {
  Isometry3d motion = Isometry3d::Identity();
  const auto turnBy = [&](const double* x) {
    const double n = x[0] * x[0] + x[1] * x[1] + x[2] * x[2] + x[3] * x[3];
    Matrix3d hat;
    hat << 0, -x[3], x[2], x[3], 0, -x[1], -x[2], x[1], 0;
    motion.rotate(Matrix3d(Matrix3d::Identity() + 2 / n * (x[0] * hat + hat * hat)));
  };
  switch (link.kind) {
    case JointKind::kFixed:
      break;
    case JointKind::kRevolute:
      motion.rotate(turnOf(q[0], 2));
      break;
    case JointKind::kPrismatic:
      motion.translate(Vector3d(0, 0, q[0]));
      break;
    case JointKind::kHelical:
      motion.translate(Vector3d(0, 0, link.pitch * q[0])).rotate(turnOf(q[0], 2));
      break;
    case JointKind::kCylindrical:
      motion.translate(Vector3d(0, 0, q[0])).rotate(turnOf(q[1], 2));
      break;
    case JointKind::kUniversal:
      motion.rotate(turnOf(q[0], 0)).rotate(turnOf(q[1], 1));
      break;
    case JointKind::kPlanar:
      motion.translate(Vector3d(q[0], q[1], 0)).rotate(turnOf(q[2], 2));
      break;
    case JointKind::kSpherical:
      turnBy(q);
      break;
    case JointKind::kFloating:
      motion.translate(Vector3d(q[0], q[1], q[2]));
      turnBy(q + 3);
      break;
  }
  return motion;
}

// -------------------------------------------------------------------------------------- data

Json toJson(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
/// Rows of a page's data: their columns are named once, and what is null in a row is not there.
class Table {
 public:
  explicit Table(std::vector<std::string> columns) : columns_(std::move(columns)) {}
  void add(const std::map<std::string, Json>& values) {
    Json row = Json::array();
    for (const std::string& column : columns_) {
      const auto at = values.find(column);
      row.push_back(at == values.end() ? Json() : at->second);
    }
    while (row.back().is_null()) row.erase(row.size() - 1);
    rows_.push_back(std::move(row));
  }
  Json json() { return {{"columns", columns_}, {"rows", std::move(rows_)}}; }

 private:
  std::vector<std::string> columns_;
  Json rows_ = Json::array();
};

/// The numbers of a page, and its frames.
class Sheet {
 public:
  explicit Sheet(const View& view)
      : in_full_(view.links.size() <= kMostLinksInFull),
        zero_(1e-10 * std::min(1.0, view.radius)) {}

  double number(double x) const {
    if (in_full_) return x;
    return std::abs(x) < zero_ ? 0 : std::strtod(fmt::format("{:.7g}", x).c_str(), nullptr);
  }
  Json numbers(const Vector3d& v) const { return {number(v.x()), number(v.y()), number(v.z())}; }
  /// Its number among all: of 12 numbers, its three rows; of 7 or 4, a quaternion w, x, y, z and
  /// the origin, where it is not 0.
  std::size_t frame(const Isometry3d& frame) {
    Json rows = Json::array();
    if (in_full_) {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j) rows.push_back(frame.matrix()(i, j));
    } else {
      const Eigen::Quaterniond turn(frame.linear());
      for (const double x : {turn.w(), turn.x(), turn.y(), turn.z()}) rows.push_back(number(x));
      const Vector3d p = frame.translation();
      if (!p.isZero(0))
        for (const double x : p) rows.push_back(number(x));
    }
    const auto [at, is_new] = index_.emplace(rows.dump(), index_.size());
    if (is_new) frames_.push_back(std::move(rows));
    return at->second;
  }
  Json& frames() { return frames_; }

 private:
  bool in_full_;
  double zero_;  // [m], and of turns
  Json frames_ = Json::array();
  std::unordered_map<std::string, std::size_t> index_;
};

bool isIdentity(const Isometry3d& frame) {
  return frame.matrix() == Isometry3d::Identity().matrix();
}

Json toJson(const ViewPair& pair, Sheet* sheet) {
  Json json{{"name", pair.name},
            {"kind", pair.kind},
            {"a", {{"link", pair.link_a}, {"frame", sheet->frame(pair.a)}}},
            {"b", {{"link", pair.link_b}, {"frame", sheet->frame(pair.b)}}}};
  if (pair.length != 0) json["length"] = pair.length;
  return json;
}

void addBody(const ViewBody& body, Sheet* sheet, Table* bodies) {
  std::map<std::string, Json> row{{"link", body.link}, {"mass", sheet->number(body.mass)}};
  if (!body.who.empty()) row["who"] = oneLine(body.who);
  Isometry3d frame = Isometry3d::Identity();
  frame.translation() = body.com;
  bool possible = true;
  if (body.mass > 0 && !body.inertia.isZero(0)) {
    Vector3d halves;
    Matrix3d axes;
    possible = ellipsoidOf(body, &halves, &axes);
    frame.linear() = axes;
    row["half"] = sheet->numbers(halves);
  }
  row["frame"] = sheet->frame(frame);
  if (!possible) row["impossible"] = true;
  bodies->add(row);
}

}  // namespace

bool ellipsoidOf(const ViewBody& body, Vector3d* halves, Matrix3d* axes) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(body.inertia);
  const Vector3d I = principal.eigenvalues();
  *axes = principal.eigenvectors();
  if (axes->determinant() < 0) axes->col(2) = -axes->col(2);
  // what turning axes and shifting to the centre may round: a thin rod stays possible
  const double rounding = 64 * std::numeric_limits<double>::epsilon() *
                          (I.cwiseAbs().maxCoeff() + body.mass * body.com.squaredNorm());
  bool possible = true;
  for (int k = 0; k < 3; ++k) {
    const double twice = I.sum() - 2 * I(k);
    possible = possible && twice >= -rounding;
    (*halves)(k) = body.mass > 0 && twice > 0 ? std::sqrt(2.5 * twice / body.mass) : 0;
  }
  return possible;
}

View viewOf(const scene::Scene& scene, const std::vector<scene::UrdfPart>& parts) {
  const Numbers number(scene.mechanism);
  View view;
  view.name = oneLine(scene.name);
  view.title = oneLine(scene.title.empty() ? scene.name : scene.title);
  addJoints(scene, number, parts, &view);
  const std::vector<scene::Link>& links = scene.mechanism.links;
  for (std::size_t i = 0; i < links.size(); ++i)
    view.bodies.push_back(bodyOf(static_cast<int>(i), links[i].inertia, number));
  for (const scene::Closure& closure : scene.mechanism.closures) {
    view.closures.push_back(
        pairOf(closure.name, scene::name(closure.kind), closure.a, closure.b, number));
    if (closure.kind != scene::ClosureKind::kDistance) continue;
    view.closures.back().is_rod = true;
    view.closures.back().length = number(closure.length);
  }
  for (const scene::Spring& spring : scene.mechanism.springs)
    view.springs.push_back(pairOf(spring.name, "spring", spring.a, spring.b, number));
  aim(scene, number, &view);
  setRanges(&view);
  return view;
}

ViewPlaces placesOf(const View& view, const std::vector<double>& given) {
  std::vector<double> q = given;
  for (const ViewLink& link : view.links)
    if (link.leader_slot >= 0)
      q[static_cast<std::size_t>(link.slot)] =
          link.multiplier * given[static_cast<std::size_t>(link.leader_slot)] + link.offset;
  ViewPlaces places;
  for (const ViewLink& link : view.links) {
    const Isometry3d parent = link.parent < 0 ? Isometry3d::Identity()
                                              : places.link[static_cast<std::size_t>(link.parent)];
    places.before.push_back(parent * link.before);
    places.moved.push_back(places.before.back() * motionOf(link, q.data() + link.slot));
    places.link.push_back(places.moved.back() * link.after);
  }
  return places;
}

std::string viewJson(const View& view) {
  Json json{{"name", view.name},           {"up", toJson(view.up)},
            {"ahead", toJson(view.ahead)}, {"azimuth", view.azimuth},
            {"elevation", view.elevation}, {"center", toJson(view.center)},
            {"radius", view.radius},       {"glyph", view.glyph}};
  json["ground"] = Json::array({0, 0, 0});
  Sheet sheet(view);
  Table links({"name", "parent", "joint", "kind", "label", "slot", "slots", "before", "after",
               "pitch", "follows"});
  for (const ViewLink& link : view.links) {
    std::map<std::string, Json> row{{"name", link.name},
                                    {"parent", link.parent},
                                    {"joint", link.joint},
                                    {"kind", scene::name(link.kind)},
                                    {"label", link.label},
                                    {"slot", link.slot},
                                    {"slots", scene::positionSlots(link.kind).size()}};
    if (!isIdentity(link.before)) row["before"] = sheet.frame(link.before);
    if (!isIdentity(link.after)) row["after"] = sheet.frame(link.after);
    if (link.kind == JointKind::kHelical) row["pitch"] = link.pitch;
    if (link.leader_slot >= 0)
      row["follows"] = {
          {"slot", link.leader_slot}, {"multiplier", link.multiplier}, {"offset", link.offset}};
    links.add(row);
  }
  json["links"] = links.json();
  Table slots({"name", "label", "kind", "lower", "upper", "start", "rest", "limited", "follows",
               "quaternion"});
  for (const ViewSlot& slot : view.slots) {
    std::map<std::string, Json> row{{"name", slot.name},
                                    {"label", slot.label},
                                    {"kind", slot.kind == SlotKind::kAngle    ? "angle"
                                             : slot.kind == SlotKind::kLength ? "length"
                                                                              : "quaternion"},
                                    {"lower", sheet.number(slot.lower)},
                                    {"upper", sheet.number(slot.upper)}};
    if (slot.start != 0) row["start"] = slot.start;
    if (slot.rest != 0) row["rest"] = slot.rest;
    if (slot.is_limited) row["limited"] = true;
    if (slot.name.empty()) row["follows"] = true;
    if (slot.quaternion >= 0) row["quaternion"] = slot.quaternion;
    slots.add(row);
  }
  json["slots"] = slots.json();
  Table bodies({"link", "mass", "frame", "half", "who", "impossible"});
  for (const ViewBody& body : view.bodies) addBody(body, &sheet, &bodies);
  json["bodies"] = bodies.json();
  Json& closures = json["closures"] = Json::array();
  for (const ViewPair& pair : view.closures) closures.push_back(toJson(pair, &sheet));
  Json& springs = json["springs"] = Json::array();
  for (const ViewPair& pair : view.springs) springs.push_back(toJson(pair, &sheet));
  json["frames"] = std::move(sheet.frames());
  if (view.motion) {
    Json energy = Json::array();
    for (const ViewMotion::Energy& line : view.motion->energies)
      energy.push_back({{"name", oneLine(line.name)}, {"values", line.joules}});
    json["motion"] = {{"time", view.motion->times}, {"q", view.motion->q}, {"energy", energy}};
  }
  std::string safe;
  for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  }
  return safe;
}

}  // namespace dynwitness::crosscheck
