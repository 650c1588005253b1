// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/check_reading.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <new>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/rereading/placing.hpp"
#include "crosscheck/verdicts/tally.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/mimic.hpp"

namespace dynwitness::crosscheck {
namespace {

namespace fs = std::filesystem;
using rereading::Description;
using rereading::Real;
using rereading::Value;

constexpr const char *kPlacements = "placements", *kMasses = "masses", *kNumbers = "numbers";

// ---- numbers of both sides ----------------------------------------------------------------------

/// One number by both roads.
struct Entry {
  int state, subject;  ///< subject: an index for the comparison's names
  const char *part, *unit;
  double file, scene, limit;

  double share() const {
    const double residual = std::abs(file - scene);
    if (residual == 0) return 0;
    return std::isfinite(residual) && limit > 0 ? residual / limit
                                                : std::numeric_limits<double>::infinity();
  }
};

/// As few digits as tell two numbers apart.
std::pair<std::string, std::string> toldApart(double a, double b) {
  std::string x, y;
  for (int digits = 6; digits <= std::numeric_limits<double>::max_digits10 && x == y; ++digits) {
    x = fmt::format("{:.{}g}", a, digits);
    y = fmt::format("{:.{}g}", b, digits);
  }
  return {x, y};
}

/// Collects one check.
class Comparison {
 public:
  /// @param subject  in words: "link 'arm'"
  Comparison(const char* quantity, std::string statement, std::function<std::string(int)> subject)
      : subject_(std::move(subject)) {
    check_.kind = CheckKind::kLaw;
    check_.law = kReading;
    check_.quantity = quantity;
    check_.statement = std::move(statement);
    check_.left = kRereading;
  }

  void add(int state, int subject, const char* part, const char* unit, const Real& file,
           double error, const RunningError& scene) {
    constexpr double u = RunningError::kUnitRoundoff;
    const auto told = static_cast<double>(file);
    entries_.push_back({state, subject, part, unit, told, scene.value(),
                        (scene.bound() + u * std::abs(told) + error) * RunningError::kInflate});
  }
  void add(int subject, const char* part, const char* unit, const Value& file,
           const RunningError& scene) {
    add(0, subject, part, unit, file.value, file.error, scene);
  }
  void add(int subject, const std::array<const char*, 3>& parts, const char* unit,
           const rereading::Vector& file, const scene::Vector& scene,
           const RunningErrorNumbers& number) {
    for (int k = 0; k < 3; ++k) add(subject, parts[k], unit, file[k], number(scene[k]));
  }
  void add(int state, int subject, const rereading::Frame& file,
           const recursive::Transform<RunningError>& scene) {
    static constexpr const char* kPlaces[] = {"x of the origin", "y of the origin",
                                              "z of the origin"};
    static constexpr const char* kTurns[] = {"R[1,1]", "R[1,2]", "R[1,3]", "R[2,1]", "R[2,2]",
                                             "R[2,3]", "R[3,1]", "R[3,2]", "R[3,3]"};
    for (int i = 0; i < 3; ++i) {
      add(state, subject, kPlaces[i], "m", file.p[i], file.moved, scene.p(i));
      // the transform turns coordinates the other way
      for (int j = 0; j < 3; ++j)
        add(state, subject, kTurns[3 * i + j], "", file.R[i][j], file.turned, scene.R(j, i));
    }
  }

  CheckResult result(std::uint64_t seed) const {
    Tally tally(check_);
    for (std::size_t begin = 0; begin < entries_.size();) {
      std::size_t end = begin;
      while (end < entries_.size() && entries_[end].state == entries_[begin].state) ++end;
      const auto count = static_cast<Eigen::Index>(end - begin);
      Eigen::VectorXd file(count), scene(count), limit(count);
      for (Eigen::Index k = 0; k < count; ++k) {
        const Entry& entry = entries_[begin + static_cast<std::size_t>(k)];
        file(k) = entry.file;
        scene(k) = entry.scene;
        limit(k) = entry.limit;
      }
      tally.add(entries_[begin].state, file, scene, limit);
      begin = end;
    }
    CheckResult out = tally.result();
    out.seed = seed;
    const Entry* worst = nullptr;
    const Entry* first = nullptr;  // the largest share of the first subject that is off
    int off = 0;
    for (const Entry& entry : entries_) {
      const double share = entry.share();
      if (worst == nullptr || share > worst->share()) worst = &entry;
      if (share <= 1) continue;
      ++off;
      if (first == nullptr || (entry.subject == first->subject && entry.state == first->state &&
                               share > first->share()))
        first = &entry;
    }
    if (worst != nullptr) out.worst_entry = nameOf(*worst);
    if (first != nullptr) {
      const auto [file, scene] = toldApart(first->file, first->scene);
      const std::string unit = *first->unit == '\0' ? "" : fmt::format(" {}", first->unit);
      out.reason = fmt::format("{} is {}{} by the file's own text and {}{} in the scene",
                               nameOf(*first), file, unit, scene, unit);
      if (off > 1) out.reason += fmt::format(", and {} numbers more differ", off - 1);
    }
    return out;
  }

 private:
  std::string nameOf(const Entry& entry) const {
    const std::string subject = subject_(entry.subject);
    const char* const when = entry.state == 1 ? " at the seeded state" : "";
    return fmt::format("{}{}{}{}", subject, subject.empty() || *entry.part == '\0' ? "" : ": ",
                       entry.part, when);
  }

  CheckResult check_;
  std::function<std::string(int)> subject_;
  std::vector<Entry> entries_;
};

// ---- what is no number --------------------------------------------------------------------------

/// The first word in which they differ: names, kinds, order, who hangs on whom. Empty: none.
std::string otherWords(const scene::Scene& scene, const Description& file) {
  const scene::Mechanism& m = scene.mechanism;
  std::string found;
  const auto same = [&found](const std::string& what, const std::string& by_file,
                             const std::string& in_scene) {
    if (found.empty() && by_file != in_scene)
      found = fmt::format("{} is '{}' by the file's own text and '{}' in the scene", what, by_file,
                          in_scene);
  };
  const auto counted = [&same](const std::string& what, std::size_t by_file, std::size_t in_scene) {
    same(fmt::format("the number of {}", what), std::to_string(by_file), std::to_string(in_scene));
  };
  const auto nameOf = [&m](int link) {
    return link < 0 ? std::string() : m.links[static_cast<std::size_t>(link)].name;
  };
  const auto flag = [](bool yes) { return std::string(yes ? "yes" : "no"); };
  counted("links", file.links.size(), m.links.size());
  for (std::size_t i = 0; i < m.links.size() && found.empty(); ++i) {
    const scene::Link& ours = m.links[i];
    const rereading::Link& link = file.links[i];
    same(fmt::format("link number {}", i + 1), link.name, ours.name);
    if (!found.empty()) break;
    const std::string of = fmt::format(" of link '{}'", ours.name);
    same("the parent" + of, nameOf(link.parent), nameOf(ours.parent));
    if (ours.parent < 0) continue;
    same("the joint" + of, link.joint.name, ours.joint.name);
    same("the kind of joint" + of, link.joint.kind, scene::name(ours.joint.kind));
    same("the leader of the joint" + of, link.joint.follows ? link.joint.follows->leader : "",
         ours.joint.mimic ? ours.joint.mimic->joint : "");
    same("'gyroscopic' of the joint" + of, flag(link.joint.gyroscopic),
         flag(ours.joint.gyroscopic));
    counted("rotors" + of, link.joint.rotors.size(), ours.joint.rotors.size());
    for (std::size_t k = 0; k < ours.joint.rotors.size() && found.empty(); ++k) {
      const scene::Rotor& rotor = ours.joint.rotors[k];
      counted("ratios of a rotor" + of, link.joint.rotors[k].ratio.size(), rotor.ratio.size());
      same("whether a rotor is gyroscopic" + of, flag(link.joint.rotors[k].axis.has_value()),
           flag(rotor.axis.has_value()));
    }
  }
  counted("closures", file.closures.size(), m.closures.size());
  for (std::size_t i = 0; i < m.closures.size() && found.empty(); ++i) {
    same("the kind of a closure", file.closures[i].kind, scene::name(m.closures[i].kind));
    same("a link of a closure", file.closures[i].a.link, nameOf(m.closures[i].a.link));
    same("a link of a closure", file.closures[i].b.link, nameOf(m.closures[i].b.link));
  }
  counted("springs", file.springs.size(), m.springs.size());
  for (std::size_t i = 0; i < m.springs.size() && found.empty(); ++i) {
    same("a link of a spring", file.springs[i].a.link, nameOf(m.springs[i].a.link));
    same("a link of a spring", file.springs[i].b.link, nameOf(m.springs[i].b.link));
  }
  counted("wrenches", file.wrenches.size(), m.wrenches.size());
  for (std::size_t i = 0; i < m.wrenches.size() && found.empty(); ++i) {
    same("the link of a wrench", file.wrenches[i].link, nameOf(m.wrenches[i].link));
    same("'in world axes' of a wrench", flag(file.wrenches[i].in_world_axes),
         flag(m.wrenches[i].axes == scene::Wrench::Axes::kWorld));
  }
  counted("acceleration constraints", file.acceleration_constraints.size(),
          m.acceleration_constraints.size());
  for (std::size_t i = 0; i < m.acceleration_constraints.size() && found.empty(); ++i) {
    const scene::AccelerationConstraint& ours = m.acceleration_constraints[i];
    const rereading::AccelerationConstraint& held = file.acceleration_constraints[i];
    same("the link of an acceleration constraint", held.link, nameOf(ours.link));
    same("'in world axes' of an acceleration constraint", flag(held.in_world_axes),
         flag(ours.axes == scene::AccelerationConstraint::Axes::kWorld));
  }
  const std::size_t given = scene::givenSlots(m).size(), rates = static_cast<std::size_t>(m.dof());
  counted("positions of the start", file.start_q.empty() ? given : file.start_q.size(),
          scene.start_q.size() == static_cast<std::size_t>(m.positions()) ? given
                                                                          : scene.start_q.size());
  counted("rates of the start", file.start_qd.empty() ? rates : file.start_qd.size(),
          scene.start_qd.size());
  return found;
}

// ---- the three checks ---------------------------------------------------------------------------

std::function<std::string(int)> linkNames(const scene::Mechanism& m) {
  return
      [&m](int i) { return fmt::format("link '{}'", m.links[static_cast<std::size_t>(i)].name); };
}

/// In the order of their slots, all joints where they are not moved.
std::vector<double> unmoved(const scene::Mechanism& m) {
  std::vector<double> q;
  for (const scene::Link& link : m.links) {
    const std::size_t count = scene::positionSlots(link.joint.kind).size();
    for (std::size_t k = 0; k < count; ++k)
      q.push_back(scene::positionSlots(link.joint.kind)[k] == scene::SlotKind::kQuaternion &&
                          k + 4 == count
                      ? 1
                      : 0);
  }
  return q;
}

/// Of each link of the scene: the world's coordinates to its own.
std::vector<recursive::Transform<RunningError>> transforms(
    const recursive::Model<RunningError>& model,
    const std::vector<scene::JointPosition<RunningError>>& x) {
  using Transform = recursive::Transform<RunningError>;
  std::vector<Transform> moved;
  for (const recursive::LinkModel<RunningError>& link : model.links) {
    const Transform X = recursive::AnyJoints::transform(link, x);
    moved.push_back(link.parent < 0 ? X : X * moved[static_cast<std::size_t>(link.parent)]);
  }
  std::vector<Transform> out;
  for (const recursive::ScenePlace<RunningError>& place : model.places)
    out.push_back(place.link < 0 ? place.X : place.X * moved[static_cast<std::size_t>(place.link)]);
  return out;
}

CheckResult placements(const scene::Scene& scene, const recursive::Model<RunningError>& model,
                       const Description& file, std::uint64_t seed, std::string statement) {
  const scene::Mechanism& m = scene.mechanism;
  const RunningErrorNumbers number(m);
  const int links = static_cast<int>(m.links.size()),
            closures = static_cast<int>(m.closures.size());
  Comparison out(kPlacements, std::move(statement), [&m, links, closures](int i) {
    if (i < links) return linkNames(m)(i);
    const int anchor = (i - links) % 2, k = (i - links) / 2;
    return fmt::format("end {} of {} {}", anchor == 0 ? "a" : "b",
                       k < closures ? "closure" : "spring",
                       k < closures ? k + 1 : k - closures + 1);
  });
  scene::State<double> states[2];
  for (const double q : unmoved(m)) states[0].x.push_back(scene::jointPosition(q));
  states[1] = drawState(m, scene.name, seed, 0);
  for (int state = 0; state < 2; ++state) {
    std::vector<double> q;
    for (const auto& x : states[state].x) q.push_back(x.q);
    const std::vector<rereading::Frame> frames = rereading::placed(file, q);
    states[state].qd.clear();
    const auto of_scene = transforms(model, runningErrorState(states[state], m).x);
    for (int i = 0; i < links; ++i) out.add(state, i, frames[i], of_scene[i]);
    if (state == 1) break;
    int end = links;
    const auto compareEnd = [&](const rereading::Anchor& anchor, const scene::Attachment& ours) {
      out.add(state, end++, rereading::frameOf(anchor),
              recursive::detail::composed<RunningError>(ours.steps(), number));
    };
    for (std::size_t k = 0; k < m.closures.size(); ++k) {
      compareEnd(file.closures[k].a, m.closures[k].a);
      compareEnd(file.closures[k].b, m.closures[k].b);
    }
    for (std::size_t k = 0; k < m.springs.size(); ++k) {
      compareEnd(file.springs[k].a, m.springs[k].a);
      compareEnd(file.springs[k].b, m.springs[k].b);
    }
  }
  return out.result(seed);
}

CheckResult masses(const scene::Mechanism& m, const recursive::Model<RunningError>& model,
                   const Description& file, std::uint64_t seed) {
  static constexpr const char* kMoments[] = {"x of m com", "y of m com", "z of m com"};
  static constexpr const char* kProducts[3][3] = {
      {"Ixx", "Ixy", "Ixz"}, {"Ixy", "Iyy", "Iyz"}, {"Ixz", "Iyz", "Izz"}};
  Comparison out(kMasses,
                 "mass, first moment and inertia about its origin of each link, with what fixed "
                 "joints hold there, weighed a second time from the file's own text",
                 linkNames(m));
  for (const rereading::Body& body : rereading::weighed(file)) {
    const recursive::ScenePlace<RunningError>& place =
        model.places[static_cast<std::size_t>(body.link)];
    const recursive::RigidInertia<RunningError>& of_model =
        place.link < 0 ? model.base : model.links[static_cast<std::size_t>(place.link)].M;
    const recursive::RigidInertia<RunningError> ours = place.X.inverse().inverseTimes(of_model);
    const rereading::PseudoInertia& theirs = body.inertia;
    out.add(0, body.link, "mass", "kg", theirs.mass, theirs.error_mass, ours.mass);
    const rereading::Square I = theirs.inertia();
    const recursive::Matrix3<RunningError> of_scene = ours.I.matrix();
    for (int i = 0; i < 3; ++i) {
      out.add(0, body.link, kMoments[i], "kg m", theirs.h[i], theirs.error_h, ours.h(i));
      for (int j = i; j < 3; ++j)
        out.add(0, body.link, kProducts[i][j], "kg m^2", I[i][j], theirs.errorOfInertia(),
                of_scene(i, j));
    }
  }
  return out.result(seed);
}

CheckResult numbers(const scene::Scene& scene, const Description& file, std::uint64_t seed) {
  const scene::Mechanism& m = scene.mechanism;
  const RunningErrorNumbers number(m);
  std::vector<std::string> subjects = {"gravity"};
  Comparison out(kNumbers,
                 "gravity, rotors, friction, springs, followers, loads, constraints and the start, "
                 "evaluated a second time from the file's own text",
                 [&subjects](int i) { return subjects[static_cast<std::size_t>(i)]; });
  const auto next = [&subjects](std::string name) {
    subjects.push_back(std::move(name));
    return static_cast<int>(subjects.size()) - 1;
  };
  const scene::Vector nothing = {0, 0, 0};
  out.add(0, {"x", "y", "z"}, "m/s^2", file.gravity, m.has_gravity ? m.gravity : nothing, number);
  for (std::size_t i = 0; i < m.links.size(); ++i) {
    const scene::Joint& ours = m.links[i].joint;
    const rereading::Joint& joint = file.links[i].joint;
    if (ours.kind == scene::JointKind::kFixed) continue;
    const int k = next(fmt::format("joint '{}'", ours.name));
    out.add(k, "pitch", "m/rad", joint.pitch, number(ours.pitch));
    out.add(k, "rotor inertia", "kg m^2", joint.rotor_inertia, number(ours.rotor_inertia));
    out.add(k, "gear ratio", "", joint.gear_ratio, number(ours.gear_ratio));
    out.add(k, "viscous friction", "", joint.viscous, number(ours.friction.viscous));
    out.add(k, "Coulomb friction forwards", "", joint.positive, number(ours.friction.positive));
    out.add(k, "Coulomb friction backwards", "", joint.negative, number(ours.friction.negative));
    out.add(k, "stiffness", "", joint.stiffness, number(ours.stiffness));
    out.add(k, "rest", "", joint.rest, number(ours.rest));
    for (std::size_t r = 0; r < ours.rotors.size(); ++r) {
      const scene::Rotor& rotor = ours.rotors[r];
      const rereading::GearedRotor& read = joint.rotors[r];
      const int of = next(fmt::format("rotor {} of joint '{}'", r + 1, ours.name));
      out.add(of, "inertia", "kg m^2", read.inertia, number(rotor.inertia));
      for (std::size_t j = 0; j < rotor.ratio.size(); ++j)
        out.add(of, "ratio", "", read.ratio[j], number(rotor.ratio[j]));
      if (rotor.axis)
        out.add(of, {"axis x", "axis y", "axis z"}, "", *read.axis, *rotor.axis, number);
    }
    if (!ours.mimic) continue;
    out.add(k, "multiplier", "", joint.follows->multiplier, number(ours.mimic->multiplier));
    out.add(k, "offset", "", joint.follows->offset, number(ours.mimic->offset));
  }
  for (std::size_t i = 0; i < m.wrenches.size(); ++i) {
    const int k = next(fmt::format("wrench {}", i + 1));
    const rereading::Wrench& wrench = file.wrenches[i];
    out.add(k, {"force x", "force y", "force z"}, "N", wrench.force, m.wrenches[i].force, number);
    out.add(k, {"moment x", "moment y", "moment z"}, "N m", wrench.moment, m.wrenches[i].moment,
            number);
    out.add(k, {"at x", "at y", "at z"}, "m", wrench.at, m.wrenches[i].at, number);
  }
  for (std::size_t i = 0; i < m.closures.size(); ++i)
    out.add(next(fmt::format("closure {}", i + 1)), "length", "m", file.closures[i].length,
            number(m.closures[i].length));
  for (std::size_t i = 0; i < m.springs.size(); ++i) {
    const int k = next(fmt::format("spring {}", i + 1));
    out.add(k, "stiffness", "N/m", file.springs[i].stiffness, number(m.springs[i].stiffness));
    out.add(k, "rest", "m", file.springs[i].rest, number(m.springs[i].rest));
    out.add(k, "damping", "N s/m", file.springs[i].damping, number(m.springs[i].damping));
  }
  for (std::size_t i = 0; i < m.acceleration_constraints.size(); ++i) {
    const int k = next(fmt::format("acceleration constraint {}", i + 1));
    const rereading::AccelerationConstraint& held = file.acceleration_constraints[i];
    const scene::AccelerationConstraint& ours = m.acceleration_constraints[i];
    out.add(k, {"at x", "at y", "at z"}, "m", held.at, ours.at, number);
    out.add(k, {"direction x", "direction y", "direction z"}, "", held.direction, ours.direction,
            number);
    out.add(k, {"rotation x", "rotation y", "rotation z"}, "", held.rotation, ours.rotation,
            number);
    out.add(k, "value", "", held.value, number(ours.value));
    out.add(k, "compliance", "", held.compliance, number(ours.compliance));
  }
  const std::vector<double> at_rest = unmoved(m);
  const std::vector<int> given = scene::givenSlots(m);
  for (std::size_t k = 0; k < given.size(); ++k)
    out.add(next(fmt::format("start q{}", k + 1)), "", "",
            file.start_q.empty() ? Value::of(at_rest[static_cast<std::size_t>(given[k])])
                                 : file.start_q[k],
            number(scene.start_q[static_cast<std::size_t>(given[k])]));
  for (std::size_t k = 0; k < scene.start_qd.size(); ++k)
    out.add(next(fmt::format("start qd{}", k + 1)), "", "",
            file.start_qd.empty() ? Value(0) : file.start_qd[k], number(scene.start_qd[k]));
  return out.result(seed);
}

/// @param reason  why nothing was compared
CheckResult notRead(const char* what, const std::string& reason) {
  CheckResult check;
  check.kind = CheckKind::kLeftOut;
  check.law = kReading;
  check.statement = fmt::format("{}, read a second time", what);
  check.left = kRereading;
  check.verdict = Verdict::kNotAnswerable;
  check.reason = reason;
  return check;
}

/// Nothing can be compared number by number, and that is a disagreement.
CheckResult cannotBeCompared(const std::string& statement, const std::string& reason,
                             std::uint64_t seed) {
  CheckResult check;
  check.law = kReading;
  check.quantity = kPlacements;
  check.statement = statement;
  check.left = kRereading;
  check.states = 1;
  check.ratio = std::numeric_limits<double>::infinity();
  check.seed = seed;
  check.verdict = Verdict::kDisagree;
  check.reason = reason;
  return check;
}

constexpr const char* kPlacedAgain =
    "links placed a second time from the file's own text are where the scene has them; ";

std::string placementsStatement(const std::vector<std::string>& engines) {
  return kPlacedAgain +
         (engines.empty()
              ? std::string("no engine reads this file, all are told what the scene has")
              : fmt::format("of the engines {} read{} this file, all others are told what the "
                            "scene has",
                            fmt::join(engines, " and "), engines.size() == 1 ? "s" : ""));
}

}  // namespace

WitnessInfo rereadingInfo(const std::string& version) {
  WitnessInfo info;
  info.name = kRereading;
  info.version = version;
  info.method =
      "places and weighs the links a second time from the file's own text: matrices as printed in "
      "textbooks, pseudo-inertia, 50 digits";
  info.conventions =
      "reads: the user's own file, TOML or URDF; it shares no line with the readers of scenes, only "
      "the parsers of TOML and XML\n"
      "does not read: MJCF, functions of time; both are told";
  return info;
}

std::vector<CheckResult> compareReading(const scene::Scene& scene,
                                        const recursive::Model<RunningError>& model,
                                        const Description& file, std::uint64_t seed,
                                        const std::vector<std::string>& engines) {
  std::vector<CheckResult> checks;
  const std::string statement = placementsStatement(engines);
  if (const std::string differs = otherWords(scene, file); !differs.empty())
    checks.push_back(cannotBeCompared(statement, differs, seed));
  else
    checks = {placements(scene, model, file, seed, statement),
              masses(scene.mechanism, model, file, seed), numbers(scene, file, seed)};
  if (!file.not_read.empty())
    checks.push_back(notRead("the whole file", fmt::format("not read a second time: {}",
                                                           fmt::join(file.not_read, ", "))));
  return checks;
}

std::vector<CheckResult> checkReading(const PreparedScene& prepared, std::uint64_t seed,
                                      const std::vector<std::string>& engines) {
  const scene::Scene& scene = prepared.scene();
  std::error_code error;
  if (!fs::is_regular_file(scene.file, error))
    return {notRead("the file",
                    "the scene comes from no file, so that there is nothing to read a "
                    "second time")};
  std::ifstream stream(scene.file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  Description file;
  try {
    file = rereading::described(text.str(), scene.file, scene::bundledScenes());
  } catch (const rereading::NotReread& no_road) {
    return {notRead("the file", no_road.what())};
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& failure) {
    return {cannotBeCompared(
        placementsStatement(engines),
        fmt::format("the file cannot be read a second time: {}", failure.what()), seed)};
  }
  return compareReading(scene, prepared.model<RunningError>(), file, seed, engines);
}

std::string whoReads(const CheckResult& check) {
  const std::string before = kPlacedAgain;
  return check.statement.rfind(before, 0) == 0 ? check.statement.substr(before.size()) : "";
}

std::vector<Finding> findReadingFaults(const std::string& scene_name,
                                       const std::vector<CheckResult>& checks) {
  std::vector<Finding> findings;
  for (const CheckResult& check : checks) {
    if (check.law != kReading || check.verdict != Verdict::kDisagree) continue;
    Finding finding;
    finding.scene = scene_name;
    finding.quantity = check.quantity;
    finding.witness = kRereading;
    finding.text = fmt::format(
        "{}: {}: the file, read a second time, says otherwise than the scene that all "
        "witnesses were told: {}",
        scene_name, check.quantity, check.reason);
    findings.push_back(finding);
  }
  return findings;
}

}  // namespace dynwitness::crosscheck
