// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/readers/same.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/readers/rules.hpp"
#include "crosscheck/scalars/formula_sizes.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/mimic.hpp"
#include "scene/mjcf.hpp"
#include "scene/text_file.hpp"

namespace dynwitness::crosscheck {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Takes the direction of a to that of b, the shortest way.
Matrix3d turnTaking(const Vector3d& a, const Vector3d& b) {
  const Vector3d across = a.cross(b);
  const Vector3d axis = across.isZero(0) ? a.unitOrthogonal() : across.normalized();
  return Eigen::AngleAxisd(std::atan2(across.norm(), a.dot(b)), axis).toRotationMatrix();
}

/// One moving joint of a scene: where its positions and rates are.
struct Place {
  int link, slot, rate;
};

std::vector<Place> placesOf(const scene::Mechanism& mechanism) {
  std::vector<Place> out;
  int slot = 0, rate = 0;
  for (const int link : mechanism.movingLinks()) {
    out.push_back({link, slot, rate});
    const scene::JointKind kind = mechanism.links[static_cast<std::size_t>(link)].joint.kind;
    slot += static_cast<int>(scene::positionSlots(kind).size());
    rate += scene::degreesOfFreedom(kind);
  }
  return out;
}

void requireOpenTree(const scene::Scene& scene) {
  const scene::Mechanism& m = scene.mechanism;
  const char* what = !m.closures.empty()                   ? "closures"
                     : !m.springs.empty()                  ? "springs between points"
                     : !m.wrenches.empty()                 ? "loads"
                     : m.isDriven()                        ? "driven joints"
                     : !m.acceleration_constraints.empty() ? "acceleration constraints"
                     : m.hasGyroscopicRotors()             ? "gyroscopic rotors"
                     : m.hasGearedRotors()                 ? "rotors geared to several rates"
                                                           : nullptr;
  if (what)
    throw scene::InputError(
        {scene.file.string()},
        std::string("has ") + what + ", which are not compared, allowed: open trees of links");
  if (m.movingLinks().empty())
    throw scene::InputError({scene.file.string()},
                            "no joint moves, expected at least one that does");
}

/// A robot with its bodies where they stand at q = 0.
struct Standing {
  const Robot& robot;
  std::vector<Isometry3d> X = robot.placements();

  Vector3d axis(std::size_t i) const { return X[i].linear() * robot.bodies[i].axis; }
};

/// How far a joint of b is from one of a: [m], and the axes' directions.
double distance(const Standing& a, std::size_t i, const Standing& b, std::size_t j) {
  const Vector3d between = b.X[j].translation() - a.X[i].translation(), axis = a.axis(i);
  const bool slides = a.robot.bodies[i].kind == scene::JointKind::kPrismatic;
  return (slides ? 0 : axis.cross(between).norm()) + (axis - b.axis(j)).norm();
}

/// By joint of a, that of b: by name, or else by structure; empty: neither.
std::vector<std::size_t> matched(const Standing& a, const Standing& b, bool* by_name) {
  const std::size_t n = a.robot.bodies.size();
  if (b.robot.bodies.size() != n) return {};
  std::vector<std::size_t> out;
  for (const ReadBody& body : a.robot.bodies)
    for (std::size_t j = 0; j < n; ++j)
      if (b.robot.bodies[j].joint == body.joint) out.push_back(j);
  *by_name = out.size() == n;
  if (*by_name) return out;
  out.clear();
  std::set<std::size_t> taken;
  for (std::size_t i = 0; i < n; ++i) {
    const ReadBody& body = a.robot.bodies[i];
    const int parent =
        body.parent < 0 ? -1 : static_cast<int>(out[static_cast<std::size_t>(body.parent)]);
    std::size_t best = n;
    for (std::size_t j = 0; j < n; ++j) {
      const ReadBody& other = b.robot.bodies[j];
      if (taken.count(j) || other.parent != parent || other.kind != body.kind) continue;
      if (best == n || distance(a, i, b, j) < distance(a, i, b, best)) best = j;
    }
    if (best == n) return {};
    taken.insert(best);
    out.push_back(best);
  }
  return out;
}

std::string shown(const Vector3d& v) {
  return fmt::format("({:.9g}, {:.9g}, {:.9g})", v[0], v[1], v[2]);
}

/// With what its file says beside it.
struct Side : Standing {
  Side(const FileParts& parts, bool limits)
      : Standing{parts.robot()}, file(parts), has_limits(limits) {}
  const FileParts& file;
  bool has_limits;
  double reach(std::size_t i) const { return file.reach(i); }
};

/// What differs by more than rounding, and whether motion must tell it: kinds, limits, friction.
class Differences {
 public:
  Differences(const Side& a, const Side& b, const std::vector<std::size_t>& match)
      : a_(a), b_(b), match_(match) {}

  std::vector<Difference> all;
  bool beside_inertia = false;

  void find() {
    if (!near(a_.robot.gravity, b_.robot.gravity, 0))
      all.push_back({"", "gravity [m/s^2]", shown(a_.robot.gravity), shown(b_.robot.gravity)});
    const std::vector<int> depths = a_.robot.depths();
    aligned_.assign(match_.size(), Isometry3d::Identity());
    for (std::size_t i = 0; i < match_.size(); ++i) compare(i, match_[i], depths[i]);
  }

 private:
  static bool near(const Vector3d& a, const Vector3d& b, double size, int frames = 0) {
    return (a - b).norm() <= roundingOf(frames) * std::max({a.norm(), b.norm(), size});
  }
  void compare(std::size_t i, std::size_t j, int depth) {
    const ReadBody &a = a_.robot.bodies[i], &b = b_.robot.bodies[j];
    const int frames = depth + a.links + b.links;
    const auto add = [&](const std::string& quantity, const std::string& x, const std::string& y,
                         bool inertial = false) {
      all.push_back({a.link, quantity, x, y});
      beside_inertia = beside_inertia || !inertial;
    };
    const auto parent = [](const Robot& robot, int p) {
      return p < 0 ? std::string("the world") : robot.bodies[static_cast<std::size_t>(p)].link;
    };
    const int expected =
        a.parent < 0 ? -1 : static_cast<int>(match_[static_cast<std::size_t>(a.parent)]);
    if (b.parent != expected) add("parent", parent(a_.robot, a.parent), parent(b_.robot, b.parent));
    if (a.kind != b.kind) {
      add("joint kind", scene::name(a.kind), scene::name(b.kind));
      return;
    }
    const double reach = a_.X[i].translation().norm() + b_.X[j].translation().norm() + a_.reach(i);
    const bool has_axis =
        a.kind == scene::JointKind::kRevolute || a.kind == scene::JointKind::kPrismatic;
    // of b's frame in a's; where a joint stands elsewhere, what it carries is compared from there
    Isometry3d X = a_.X[i].inverse() * b_.X[j];
    if (b.parent == expected)
      X = a.placement.inverse() *
          (a.parent < 0 ? b.placement : aligned_[static_cast<std::size_t>(a.parent)] * b.placement);
    if (has_axis) {
      const Vector3d axis = X.linear() * b.axis;
      const Vector3d off = X.translation() - X.translation().dot(a.axis) * a.axis;
      if (a.kind == scene::JointKind::kRevolute && off.norm() > roundingOf(frames) * reach) {
        add("point on the axis [m]", shown(Vector3d::Zero()), shown(off));
        X.pretranslate(-off);
      }
      if (!near(a.axis, axis, 1, frames)) {
        add("axis", shown(a.axis), shown(axis));
        X.linear() = turnTaking(axis, a.axis) * X.linear();
      }
    } else if (X.translation().norm() > roundingOf(frames) * reach ||
               (X.linear() - Matrix3d::Identity()).norm() > roundingOf(frames)) {
      add("joint frame [m]", shown(Vector3d::Zero()), shown(Vector3d(X.translation())));
    }
    aligned_[i] = X;
    const auto number = [&](const char* quantity, double x, double y, bool inertial = false) {
      if (std::abs(x - y) > roundingOf(0) * std::max(std::abs(x), std::abs(y)))
        add(quantity, fmt::format("{:.9g}", x), fmt::format("{:.9g}", y), inertial);
    };
    number("damping", a.damping, b.damping);
    number("friction", a.friction, b.friction);
    number("stiffness", a.stiffness, b.stiffness);
    number("rotor", a.armature, b.armature, true);
    if (a_.has_limits && b_.has_limits) {
      const auto limit = [](const std::optional<double>& x) { return x.value_or(HUGE_VAL); };
      if (a.lower.has_value() != b.lower.has_value()) {
        add("limits", a.lower ? "given" : "none", b.lower ? "given" : "none");
      } else if (a.lower) {
        number("lower limit", limit(a.lower), limit(b.lower));
        number("upper limit", limit(a.upper), limit(b.upper));
      }
    }
    const auto leaderOf = [](const Robot& robot, const std::string& joint) {
      for (std::size_t k = 0; k < robot.bodies.size(); ++k)
        if (robot.bodies[k].joint == joint) return static_cast<int>(k);
      return -1;
    };
    const int leader_a = leaderOf(a_.robot, a.leader), leader_b = leaderOf(b_.robot, b.leader);
    if ((leader_a < 0 ? -1 : static_cast<int>(match_[static_cast<std::size_t>(leader_a)])) !=
        leader_b)
      add("mimic", a.leader.empty() ? "none" : a.leader, b.leader.empty() ? "none" : b.leader);
    number("multiplier of mimic", a.multiplier, b.multiplier);
    number("offset of mimic", a.offset, b.offset);

    // the body of b, seen from the frame of a
    MassMoments ours = a.moments, theirs = b.moments.movedBy(X);
    const double size2 = std::max(ours.reach2, theirs.reach2) + std::abs(ours.mass) * reach * reach;
    const double mass = std::max(std::abs(ours.mass), std::abs(theirs.mass));
    number("mass [kg]", ours.mass, theirs.mass, true);
    if ((ours.first - theirs.first).norm() > roundingOf(frames) * std::sqrt(mass * size2) &&
        (ours.com() - theirs.com()).norm() > roundingOf(frames) * std::sqrt(size2 / mass))
      add("centre of mass [m]", shown(ours.com()), shown(theirs.com()), true);
    const Matrix3d I = ours.aboutCom(), J = theirs.aboutCom();
    const char* const names[] = {"xx", "yy", "zz", "xy", "xz", "yz"};
    constexpr int rows[] = {0, 1, 2, 0, 0, 1}, columns[] = {0, 1, 2, 1, 2, 2};
    for (int k = 0; k < 6; ++k)
      if (std::abs(I(rows[k], columns[k]) - J(rows[k], columns[k])) > roundingOf(frames) * size2)
        add(fmt::format("I{} about it [kg m^2]", names[k]),
            fmt::format("{:.9g}", I(rows[k], columns[k])),
            fmt::format("{:.9g}", J(rows[k], columns[k])), true);
  }

  const Side& a_;
  const Side& b_;
  const std::vector<std::size_t>& match_;
  std::vector<Isometry3d> aligned_;  ///< by body of a: of b's frame in a's
};

/// The state of a as b has it.
template <typename T>
scene::State<T> mapped(const scene::State<T>& state, const std::vector<Place>& a,
                       const std::vector<Place>& b, const std::vector<std::size_t>& match,
                       const scene::Mechanism& mechanism) {
  scene::State<T> out = state;
  for (std::size_t i = 0; i < match.size(); ++i) {
    const Place &from = a[i], &to = b[match[i]];
    const scene::JointKind kind = mechanism.links[static_cast<std::size_t>(from.link)].joint.kind;
    for (std::size_t k = 0; k < scene::positionSlots(kind).size(); ++k)
      out.x[static_cast<std::size_t>(to.slot) + k] =
          state.x[static_cast<std::size_t>(from.slot) + k];
    for (int k = 0; k < scene::degreesOfFreedom(kind); ++k) {
      const auto r = static_cast<std::size_t>(from.rate + k),
                 s = static_cast<std::size_t>(to.rate + k);
      out.qd[s] = state.qd[r];
      out.qdd[s] = state.qdd[r];
    }
  }
  return out;
}

template <typename Numbers, typename T = typename Numbers::Scalar>
std::vector<T> forces(const scene::Mechanism& mechanism, const Numbers& number,
                      const scene::State<T>& state, recursive::Terms terms) {
  const auto model = recursive::buildModel(mechanism, number);
  recursive::Workspace<T> ws(model);
  std::vector<T> tau(state.qd.size());
  recursive::inverseDynamics(model, state.x, state.qd, state.qdd, ws, tau, terms);
  return tau;
}

/// Friction is compared by its numbers: over the field no rate has a sign.
constexpr recursive::Terms kWithoutFriction{true, true, false, false};

/// Whether the forces are the same functions, and the chance that others pass.
bool sameForces(const scene::Mechanism& a, const scene::Mechanism& b,
                const std::vector<std::size_t>& match, std::uint64_t seed, double* error) {
  const std::vector<Place> places_a = placesOf(a), places_b = placesOf(b);
  const std::string name = "same";
  const auto rateOf = [&](std::size_t i, int k) {
    return static_cast<std::size_t>(places_b[match[i]].rate + k);
  };
  const auto eachRate = [&](const auto& visit) {
    for (std::size_t i = 0; i < match.size(); ++i) {
      const scene::JointKind kind = a.links[static_cast<std::size_t>(places_a[i].link)].joint.kind;
      for (int k = 0; k < scene::degreesOfFreedom(kind); ++k)
        visit(static_cast<std::size_t>(places_a[i].rate + k), rateOf(i, k));
    }
  };
  const auto differences = [&](std::uint64_t point) {
    const FieldSource source(name, seed, point);
    const auto state = indeterminateState(a, source);
    const auto tau_a = forces(a, FieldNumbers(a, source), state, kWithoutFriction);
    const auto tau_b = forces(b, FieldNumbers(b, source),
                              mapped(state, places_a, places_b, match, a), kWithoutFriction);
    std::vector<PrimeField> all;
    eachRate([&](std::size_t i, std::size_t j) { all.push_back(tau_a[i] - tau_b[j]); });
    return all;
  };
  double chance = 0;
  {
    const FormulaSizes sizes;
    for (const PrimeField& difference : differences(0))
      chance += errorProbability(difference, sizes);
  }
  constexpr int kPoints = 2;
  *error = std::pow(chance, kPoints);
  int done = 0;
  constexpr std::uint64_t kMostPoints = 20;
  for (std::uint64_t point = 0; done < kPoints; ++point) {
    if (point == kMostPoints)
      throw std::runtime_error("same: a divisor vanishes at every point of the prime field");
    const PrimeField::Modulus field(drawPrime(name, seed, point));
    try {
      const std::vector<PrimeField> all = differences(point);
      if (!std::all_of(all.begin(), all.end(), [](const PrimeField& x) { return x.isZero(); }))
        return false;
      ++done;
    } catch (const DivisionByZero&) {  // another point
    }
  }
  return true;
}

const char* words(SameResult::Verdict verdict) {
  switch (verdict) {
    case SameResult::Verdict::kExactly:
      return "the same robot, exactly";
    case SameResult::Verdict::kToMotion:
      return "the same robot to every motion: what differs, no joint force can tell";
    case SameResult::Verdict::kInDouble:
      return "the same robot in double precision: no number differs by more than rounding";
    case SameResult::Verdict::kDifferent:
      return "DIFFERENT robots";
  }
  return "";
}
const char* id(SameResult::Verdict verdict) {
  switch (verdict) {
    case SameResult::Verdict::kExactly:
      return "same";
    case SameResult::Verdict::kToMotion:
      return "same_to_motion";
    case SameResult::Verdict::kInDouble:
      return "same_in_double";
    case SameResult::Verdict::kDifferent:
      return "different";
  }
  return "";
}

}  // namespace

Description findDescription(const std::string& name_or_path) {
  std::error_code error;
  if (std::filesystem::is_regular_file(name_or_path, error)) {
    const std::string text = scene::readTextFile(name_or_path, "a TOML, URDF or MJCF file");
    const std::size_t start = text.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0;
    const std::size_t first = text.find_first_not_of(" \t\r\n", start);
    if (first != std::string::npos && text[first] == '<' && !scene::isMjcf(text))
      return scene::readUrdfAsWritten(text, name_or_path);
  }
  return {scene::findScene(name_or_path), {}};
}

SameResult compareDescriptions(const Description& a, const Description& b, int states,
                               std::uint64_t seed) {
  requireOpenTree(a.scene);
  requireOpenTree(b.scene);
  const auto partsOf = [](const Description& d) {
    return d.parts.empty() ? FileParts(d.scene.mechanism) : FileParts(d);
  };
  const FileParts parts_a = partsOf(a), parts_b = partsOf(b);
  const Side side_a(parts_a, !a.parts.empty()), side_b(parts_b, !b.parts.empty());
  SameResult result;
  result.a = a.scene.file.string();
  result.b = b.scene.file.string();
  result.states = states;
  const std::vector<std::size_t> match = matched(side_a, side_b, &result.matched_by_name);
  if (match.empty()) {
    result.differences.push_back({"", "moving joints", std::to_string(side_a.robot.bodies.size()),
                                  std::to_string(side_b.robot.bodies.size())});
    if (side_a.robot.bodies.size() == side_b.robot.bodies.size())
      result.differences.back() = {"", "tree", "its joints and kinds", "others"};
    return result;
  }
  for (std::size_t i = 0; i < match.size(); ++i)
    result.joints.emplace_back(side_a.robot.bodies[i].joint, side_b.robot.bodies[match[i]].joint);
  Differences differences(side_a, side_b, match);
  differences.find();
  result.differences = differences.all;
  bool same_kinds = true;
  for (std::size_t i = 0; i < match.size(); ++i)
    same_kinds = same_kinds && side_a.robot.bodies[i].kind == side_b.robot.bodies[match[i]].kind;
  if (!same_kinds) return result;

  const scene::Mechanism tree_a = scene::withoutMimics(a.scene.mechanism),
                         tree_b = scene::withoutMimics(b.scene.mechanism);
  result.same_forces = sameForces(tree_a, tree_b, match, seed, &result.error_probability);
  using Verdict = SameResult::Verdict;
  if (result.differences.empty())
    result.verdict = result.same_forces ? Verdict::kExactly : Verdict::kInDouble;
  else if (result.same_forces && !differences.beside_inertia)
    result.verdict = Verdict::kToMotion;

  // what it does
  const std::vector<Place> places_a = placesOf(tree_a), places_b = placesOf(tree_b);
  const scene::RealNumbers<double> number_a(tree_a), number_b(tree_b);
  result.has_tau = true;
  result.has_M = allHaveOnePosition(side_a.robot);
  for (int k = 0; k < states; ++k) {
    const auto state = drawState(tree_a, "same", seed, static_cast<std::uint64_t>(k));
    const auto tau_a = forces(tree_a, number_a, state, recursive::Terms::all());
    const auto tau_b = forces(tree_b, number_b, mapped(state, places_a, places_b, match, tree_a),
                              recursive::Terms::all());
    for (std::size_t i = 0; i < match.size(); ++i) {
      const scene::JointKind kind =
          tree_a.links[static_cast<std::size_t>(places_a[i].link)].joint.kind;
      for (int d = 0; d < scene::degreesOfFreedom(kind); ++d)
        result.tau = std::max(
            result.tau, std::abs(tau_a[static_cast<std::size_t>(places_a[i].rate + d)] -
                                 tau_b[static_cast<std::size_t>(places_b[match[i]].rate + d)]));
    }
    if (!result.has_M) continue;
    const std::vector<double> q = drawPositions(side_a.robot, seed, static_cast<std::uint64_t>(k));
    std::vector<double> q_b(q.size());
    for (std::size_t i = 0; i < match.size(); ++i) q_b[match[i]] = q[i];
    const MassAndGravity at_a = massAndGravity(side_a.robot, q),
                         at_b = massAndGravity(side_b.robot, q_b);
    for (std::size_t i = 0; i < match.size(); ++i) {
      const auto r = static_cast<Eigen::Index>(i), s = static_cast<Eigen::Index>(match[i]);
      result.g = std::max(result.g, std::abs(at_a.g[r] - at_b.g[s]));
      if (at_a.M(r, r) > 0)
        result.M_percent =
            std::max(result.M_percent, 100 * std::abs(at_a.M(r, r) - at_b.M(s, s)) / at_a.M(r, r));
    }
  }
  return result;
}

std::string sameText(const SameResult& result) {
  std::string out = fmt::format("{} and {}: {}\n", result.a, result.b, words(result.verdict));
  if (!result.joints.empty() && !result.matched_by_name) {
    out += "joints matched by structure:";
    for (const auto& [a, b] : result.joints) out += fmt::format(" {} = {}", a, b);
    out += "\n";
  }
  if (result.has_tau)
    out +=
        result.same_forces
            ? fmt::format(
                  "joint forces, friction aside: the same functions of q, qd, qdd over the prime "
                  "field, so all base parameters are equal; chance that different ones pass at most {:.1g}\n",
                  result.error_probability)
            : "joint forces, friction aside: different functions of q, qd, qdd over the prime field\n";
  for (const Difference& d : result.differences)
    out += fmt::format("  {}{}: {} and {}\n", d.link.empty() ? "" : "link \"" + d.link + "\" ",
                       d.quantity, d.a, d.b);
  if (result.has_tau && (result.verdict == SameResult::Verdict::kDifferent ||
                         result.verdict == SameResult::Verdict::kInDouble)) {
    out += fmt::format("at the worst of {} states:", result.states);
    if (result.has_M)
      out += fmt::format(" M {:.3g} % on its diagonal, g {:.3g} N m,", result.M_percent, result.g);
    out += fmt::format(" tau {:.3g} N m (N for slides)\n", result.tau);
  }
  return out;
}

std::string sameJson(const SameResult& result, const std::string& version) {
  nlohmann::json out = {{"dynwitness", version},
                        {"a", result.a},
                        {"b", result.b},
                        {"verdict", id(result.verdict)},
                        {"matched_by", result.matched_by_name ? "name" : "structure"},
                        {"states", result.states},
                        {"differences", nlohmann::json::array()},
                        {"joints", nlohmann::json::array()}};
  for (const auto& [a, b] : result.joints) out["joints"].push_back({{"a", a}, {"b", b}});
  for (const Difference& d : result.differences)
    out["differences"].push_back(
        {{"link", d.link}, {"quantity", d.quantity}, {"a", d.a}, {"b", d.b}});
  if (result.has_tau) {
    out["same_forces"] = result.same_forces;
    out["error_probability"] = result.error_probability;
    out["tau_difference"] = result.tau;
  }
  if (result.has_M) {
    out["M_percent"] = result.M_percent;
    out["g_difference"] = result.g;
  }
  return out.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace dynwitness::crosscheck
