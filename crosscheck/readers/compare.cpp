// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/readers/compare.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <boost/math/constants/constants.hpp>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

std::string shown(const Vector3d& v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v[0], v[1], v[2]);
}
std::string shown(const MassMoments& m) {
  const Matrix3d I = m.aboutCom();
  const Vector3d c = m.com();
  return fmt::format(
      "{:.6g} kg, com {}, I about it xx {:.6g} yy {:.6g} zz {:.6g} xy {:.6g} xz {:.6g} yz {:.6g}",
      m.mass, shown(c), I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
}
std::string shown(const Isometry3d& X) {
  const Vector3d ypr = X.linear().eulerAngles(2, 1, 0);
  return fmt::format("xyz {} rpy {}", shown(Vector3d(X.translation())),
                     shown(Vector3d(ypr[2], ypr[1], ypr[0])));
}
std::string shown(const std::optional<double>& x) {
  return x ? fmt::format("{:.6g}", *x) : "none";
}

bool isSameNumber(double a, double b) {
  return std::abs(a - b) <= roundingOf(0) * std::max(std::abs(a), std::abs(b));
}

/// What was compared of one reader.
class Comparison {
 public:
  Comparison(const FileParts& file, const Robot& seen, int states, std::uint64_t seed)
      : file_(file), ours_(file.robot()), seen_(seen), states_(states), seed_(seed) {}

  std::vector<Misreading> findings() {
    if (!isSame(ours_.gravity, seen_.gravity, 0))
      add({"", "gravity", "", shown(ours_.gravity), shown(seen_.gravity), {}});
    for (std::size_t b = 0; b < ours_.bodies.size(); ++b) compareBody(b);
    for (const ReadBody& body : seen_.bodies)
      if (ours_.indexOf(body.link) < 0)
        add({body.link, "tree", "a joint moves that the file has not", "", body.joint, {}});
    // what is no joint there is part of another body here
    std::stable_partition(out_.begin(), out_.end(),
                          [](const Misreading& finding) { return finding.quantity == "tree"; });
    return out_;
  }

 private:
  static bool isSame(const Vector3d& a, const Vector3d& b, double size) {
    return (a - b).norm() <= roundingOf(0) * std::max({a.norm(), b.norm(), size});
  }
  void add(Misreading finding) { out_.push_back(std::move(finding)); }

  /// With the effect of having `changed` in place of our body.
  void addWithEffect(Misreading finding, std::size_t b, const ReadBody& changed) {
    if (allHaveOnePosition(ours_) && hasOnePosition(changed)) {
      Robot robot = ours_;
      robot.bodies[b] = changed;
      finding.has_effect = true;
      finding.effect = effectOf(ours_, robot, states_, seed_);
    }
    add(std::move(finding));
  }

  void compareBody(std::size_t b) {
    const ReadBody& body = ours_.bodies[b];
    const scene::SourceLocation& where = file_.where(b);
    const int found = seen_.indexOf(body.link);
    if (found < 0) {
      add({body.link, "tree", "the joint is not there, or does not move", body.joint, "", where});
      return;
    }
    const ReadBody& seen = seen_.bodies[static_cast<std::size_t>(found)];
    const auto nameOf = [](const Robot& robot, int i) {
      return i < 0 ? std::string("the world") : robot.bodies[static_cast<std::size_t>(i)].link;
    };
    const std::string parent = nameOf(ours_, body.parent),
                      their_parent = nameOf(seen_, seen.parent);
    if (parent != their_parent)
      add({body.link, "tree", "it hangs on another link", parent, their_parent, where});
    if (body.joint != seen.joint) add({body.link, "joint name", "", body.joint, seen.joint, where});
    if (body.kind != seen.kind) {
      add({body.link, "joint kind",
           fmt::format("{} is read as {}", scene::name(body.kind), scene::name(seen.kind)),
           scene::name(body.kind), scene::name(seen.kind), where});
      return;
    }
    comparePlace(b, seen, where);
    if (hasOnePosition(body)) {
      compareAxis(b, seen, where);
      compareNumbers(b, seen, where);
    }
    if (!crosscheck::isSame(body.moments, seen.moments, body.links, seen_.unturned)) {
      ReadBody changed = body;
      changed.moments = seen.moments;
      addWithEffect({body.link, "inertia", explanation(file_, b, seen.moments, seen_.unturned),
                     shown(body.moments), shown(seen.moments), where},
                    b, changed);
    }
  }

  void comparePlace(std::size_t b, const ReadBody& seen, const scene::SourceLocation& where) {
    const ReadBody& body = ours_.bodies[b];
    const auto fits = [&](const Isometry3d& X) {
      const int frames = body.links + 1;
      return (X.linear() - seen.placement.linear()).norm() <= roundingOf(frames) &&
             (X.translation() - seen.placement.translation()).norm() <=
                 roundingOf(frames) * std::max(X.translation().norm(), file_.reach(b));
    };
    if (fits(body.placement)) return;
    std::string rule;
    for (const FrameMistake mistake :
         {FrameMistake::kTurnDropped, FrameMistake::kTurnTransposed, FrameMistake::kTurnReversed,
          FrameMistake::kShiftDropped, FrameMistake::kShiftTurned})
      if (rule.empty() && fits(file_.readOrigin(b, mistake))) rule = words(mistake);
    ReadBody changed = body;
    changed.placement = seen.placement;
    addWithEffect({body.link, "origin", rule, shown(body.placement), shown(seen.placement), where},
                  b, changed);
  }

  void compareAxis(std::size_t b, const ReadBody& seen, const scene::SourceLocation& where) {
    const ReadBody& body = ours_.bodies[b];
    const auto fits = [&](const Vector3d& axis) { return isSame(axis, seen.axis, 0); };
    if (fits(body.axis)) return;
    const Vector3d written = file_.writtenAxis(b);
    const Matrix3d R = file_.turnOfOrigin(b);
    std::string rule;
    if (fits(written))
      rule = "the axis is not normalised";
    else if (fits(R.transpose() * body.axis) || fits(R * body.axis))
      rule = "the axis is taken in the parent link's frame";
    else if (fits(-body.axis))
      rule = "the axis has the other sign";
    else
      for (int k = 0; k < 3; ++k)
        if (fits(Vector3d::Unit(k)))
          rule = fmt::format("the axis is {}, whatever the file says", "xyz"[k]);
    ReadBody changed = body;
    changed.axis = seen.axis;
    addWithEffect({body.link, "axis", rule, shown(written), shown(seen.axis), where}, b, changed);
  }

  void compareNumbers(std::size_t b, const ReadBody& seen, const scene::SourceLocation& where) {
    const ReadBody& body = ours_.bodies[b];
    const auto number = [&](const char* quantity, double ours, double theirs) {
      if (isSameNumber(ours, theirs)) return;
      const std::string rule = ours == 0 ? fmt::format("a default of the reader's, {:.6g}", theirs)
                               : theirs == 0 ? std::string("it is ignored")
                                             : "";
      ReadBody changed = body;
      if (std::string(quantity) == "armature") changed.armature = seen.armature;
      Misreading finding{
          body.link, quantity, rule, fmt::format("{:.6g}", ours), fmt::format("{:.6g}", theirs),
          where};
      addWithEffect(finding, b, changed);
    };
    number("damping", body.damping, seen.damping);
    number("friction", body.friction, seen.friction);
    number("armature", body.armature, seen.armature);
    number("stiffness", body.stiffness, seen.stiffness);
    const std::string limits = shown(body.lower) + " to " + shown(body.upper),
                      their_limits = shown(seen.lower) + " to " + shown(seen.upper);
    // a range of nothing is what URDF says by leaving the numbers out
    const bool has_limits = body.lower && body.upper && *body.lower < *body.upper;
    const bool seen_limits = seen.lower && seen.upper && *seen.lower < *seen.upper;
    const auto fits = [&](double factor) {
      return has_limits && seen_limits && isSameNumber(factor * *body.lower, *seen.lower) &&
             isSameNumber(factor * *body.upper, *seen.upper);
    };
    const double degree = boost::math::constants::degree<double>();
    if ((has_limits || seen_limits) && !fits(1)) {
      std::string rule;
      if (has_limits && !seen_limits) rule = "they are ignored";
      if (!has_limits) rule = "a joint that turns without end gets limits";
      if (fits(degree)) rule = "radians are taken for degrees";
      if (fits(1 / degree)) rule = "they are kept in degrees";
      add({body.link, "limits", rule, limits, their_limits, where});
    }
    if (body.leader != seen.leader || !isSameNumber(body.multiplier, seen.multiplier) ||
        !isSameNumber(body.offset, seen.offset)) {
      const auto mimic = [](const ReadBody& r) {
        return r.leader.empty()
                   ? "none"
                   : fmt::format("{} * {:.6g} + {:.6g}", r.leader, r.multiplier, r.offset);
      };
      add({body.link, "mimic",
           seen.leader.empty() ? "it is ignored: the joint moves by itself" : "", mimic(body),
           mimic(seen), where});
    }
  }

  const FileParts& file_;
  const Robot& ours_;
  const Robot& seen_;
  int states_;
  std::uint64_t seed_;
  std::vector<Misreading> out_;
};

/// One line.
std::string inOneLine(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// What an engine throws is its refusal. Meshes that are not there end some engines' reading: then
/// the file is read without its shapes, which is told.
Reading readBy(const Reader& reader, const std::string& text, const std::filesystem::path& file) {
  const auto attempt = [&](const std::string& bytes) {
    Reading reading;
    try {
      reading = reader.read(bytes, file);
    } catch (const std::exception& error) {
      reading.refusal = error.what();
    }
    reading.refusal = inOneLine(reading.refusal);
    return reading;
  };
  Reading reading = attempt(text);
  if (reading.refusal.empty()) return reading;
  const std::string without_shapes = scene::urdfWithoutShapes(text);
  if (without_shapes == text) return reading;
  Reading again = attempt(without_shapes);
  if (again.refusal.empty())
    again.told.push_back("read without its shapes, since with them: " + reading.refusal);
  else
    again.refusal = reading.refusal + "; without its shapes: " + again.refusal;
  return again;
}

/// The engine's own M and g against those of the robot that it shows.
void compareAnswers(const Reading& reading, int states, std::uint64_t seed, ReaderResult* result) {
  const Robot& robot = reading.robot;
  if (!reading.answer || robot.bodies.empty()) return;
  if (!allHaveOnePosition(robot)) {
    result->told.push_back(
        "its own M and g were not compared: a joint has several degrees of freedom");
    return;
  }
  for (int k = 0; k < states; ++k) {
    const std::vector<double> q = drawPositions(robot, seed, static_cast<std::uint64_t>(k));
    const MassAndGravity shown = massAndGravity(robot, q), own = reading.answer(q);
    for (Eigen::Index i = 0; i < shown.g.size(); ++i) {
      const std::string& link = robot.bodies[static_cast<std::size_t>(i)].link;
      const auto differs = [&](double a, double b, double bound, const char* what) {
        if (std::abs(a - b) <= bound) return false;
        result->findings.push_back({link,
                                    what,
                                    "its own answer is not that of the model it shows",
                                    fmt::format("{:.9g}", a),
                                    fmt::format("{:.9g}", b),
                                    {}});
        return true;
      };
      if (differs(shown.g[i], own.g[i], shown.g_bound[i], "g")) return;
      for (Eigen::Index j = 0; j <= i; ++j)
        if (differs(shown.M(i, j), own.M(i, j), shown.M_bound(i, j), "M")) return;
    }
  }
}

/// The file as --plain writes it, and what it has.
struct Plain {
  Plain(const scene::Urdf& urdf, const std::filesystem::path& file)
      : text(plainUrdf(urdf)), parts(scene::readUrdfAsWritten(text, file)) {}
  std::string text;
  FileParts parts;
};

}  // namespace

Effect effectOf(const Robot& robot, const Robot& changed, int states, std::uint64_t seed) {
  Effect worst;
  for (int k = 0; k < states; ++k) {
    const std::vector<double> q = drawPositions(robot, seed, static_cast<std::uint64_t>(k));
    const MassAndGravity a = massAndGravity(robot, q), b = massAndGravity(changed, q);
    worst.g = std::max(worst.g, (a.g - b.g).cwiseAbs().maxCoeff());
    for (Eigen::Index i = 0; i < a.g.size(); ++i)
      if (a.M(i, i) > 0)
        worst.M_percent =
            std::max(worst.M_percent, 100 * std::abs(b.M(i, i) - a.M(i, i)) / a.M(i, i));
  }
  return worst;
}

bool ReadersResult::anyRead() const {
  return std::any_of(readers.begin(), readers.end(),
                     [](const ReaderResult& r) { return r.hasRead(); });
}
bool ReadersResult::agrees() const {
  return std::all_of(readers.begin(), readers.end(),
                     [](const ReaderResult& r) { return r.findings.empty(); });
}

std::vector<Reader> engineReaders() {
  return {mujocoReader(), dartReader()};
}

ReadersResult examineReaders(const std::string& text, const std::filesystem::path& file,
                             const std::vector<Reader>& readers, int states, std::uint64_t seed) {
  const scene::Urdf urdf = scene::readUrdfAsWritten(text, file);
  const FileParts parts(urdf);
  ReadersResult result;
  result.file = file.string();
  result.links = static_cast<int>(urdf.scene.mechanism.links.size());
  result.states = states;
  result.seed = seed;
  result.impossible = scene::impossibleInertias(urdf.scene);
  for (const ReadBody& body : parts.robot().bodies) result.bodies.push_back(body.link);
  if (result.bodies.empty())
    throw scene::InputError({file.string()}, "no joint moves, expected at least one that does");
  std::optional<Plain> plain;  // which few files need
  for (const Reader& reader : readers) {
    ReaderResult one;
    one.name = reader.name;
    one.version = reader.version;
    one.present = reader.present;
    if (reader.present) {
      const Reading reading = readBy(reader, text, file);
      one.refusal = reading.refusal;
      one.told = reading.told;
      if (reading.refusal.empty()) {
        one.findings = Comparison(parts, reading.robot, states, seed).findings();
        compareAnswers(reading, states, seed, &one);
      }
      if (!one.findings.empty()) {
        if (!plain) plain.emplace(urdf, file);
        const Reading again = readBy(reader, plain->text, file);
        if (again.refusal.empty() &&
            Comparison(plain->parts, again.robot, states, seed).findings().empty())
          one.remedy =
              "--plain OUT.urdf: fixed links merged, inertias in link axes; tried: it then "
              "has the robot of the file";
      }
    }
    result.readers.push_back(std::move(one));
  }
  return result;
}

std::string plainUrdf(const scene::Urdf& urdf) {
  const Robot robot = FileParts(urdf).robot();
  const auto exactly = [](double x) { return scene::Number(scene::Rational(x)); };
  const auto vector = [&](const Vector3d& v) {
    return scene::Vector{exactly(v[0]), exactly(v[1]), exactly(v[2])};
  };
  scene::Scene plain = urdf.scene;
  std::vector<scene::Link> links = {urdf.scene.mechanism.links[0]};
  links[0].inertia = {};
  for (const ReadBody& body : robot.bodies) {
    const auto original =
        std::find_if(urdf.scene.mechanism.links.begin(), urdf.scene.mechanism.links.end(),
                     [&](const scene::Link& link) { return link.name == body.link; });
    scene::Link link = *original;
    link.parent = body.parent + 1;
    const Vector3d ypr = body.placement.linear().eulerAngles(2, 1, 0);
    link.joint.placement = {};
    link.joint.placement.xyz = vector(body.placement.translation());
    link.joint.placement.rpy = vector({ypr[2], ypr[1], ypr[0]});
    const Matrix3d I = body.moments.aboutCom();
    scene::MassProperties m;
    m.mass = exactly(body.moments.mass);
    m.com = vector(body.moments.com());
    m.xx = exactly(I(0, 0));
    m.yy = exactly(I(1, 1));
    m.zz = exactly(I(2, 2));
    m.xy = exactly(I(0, 1));
    m.xz = exactly(I(0, 2));
    m.yz = exactly(I(1, 2));
    link.inertia = m;
    if (hasOnePosition(body)) link.joint.axis = vector(body.axis);
    links.push_back(link);
  }
  plain.mechanism.links = links;
  std::map<std::string, scene::UrdfPart::Limits> limits;
  for (std::size_t i = 0; i < urdf.parts.size(); ++i)
    if (urdf.parts[i].limits)
      limits.emplace(urdf.scene.mechanism.links[i].joint.name, *urdf.parts[i].limits);
  return scene::urdfWithLimits(scene::writeSceneUrdf(plain), limits);
}

}  // namespace dynwitness::crosscheck
