// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/readers/compare.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <boost/math/constants/constants.hpp>

#include "crosscheck/readers/answers.hpp"
#include "scene/mjcf.hpp"
#include "scene/remarks.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {
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

namespace {

std::string limit(const std::optional<double>& x) {
  return x ? fmt::format("{:.6g}", *x) : "none";
}

bool isSameNumber(double a, double b) {
  return std::abs(a - b) <= roundingOf(0) * std::max(std::abs(a), std::abs(b));
}

/// What was compared of one reader.
class Comparison {
 public:
  Comparison(const FileParts& file, const Reading& reading, const std::string& reader, int states,
             std::uint64_t seed)
      : file_(file),
        ours_(file.robot()),
        reading_(reading),
        seen_(reading.robot),
        reader_(reader),
        states_(states),
        seed_(seed) {}

  std::vector<Misreading> findings() {
    if (!isSame(ours_.gravity, seen_.gravity, 0))
      add({"",
           "gravity",
           gravityMistake(ours_.gravity, seen_.gravity),
           shown(ours_.gravity),
           shown(seen_.gravity),
           {}});
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
  struct Way {
    double length = 0;  ///< [m]
    int joints = 0;
  };
  /// From the root of the model to the joint of a body, link by link.
  Way fromRoot(std::size_t b) const {
    Way way;
    for (int i = static_cast<int>(b); i >= 0; ++way.joints) {
      const ReadBody& body = ours_.bodies[static_cast<std::size_t>(i)];
      way.length += body.placement.translation().norm();
      i = body.parent;
    }
    return way;
  }
  /// What a reader that places links in the frame of the whole model rounds there [m].
  double slip(std::size_t b) const {
    const Way way = fromRoot(b);
    return roundingOf(way.joints) * way.length;
  }
  /// The largest difference of two readings of a body, as a share of what it is made of; 1 where
  /// what is seen is no number.
  static double shareOf(const MassMoments& a, const MassMoments& b) {
    const double mass = std::max(std::abs(a.mass), std::abs(b.mass));
    const double reach2 = std::max(a.reach2, b.reach2);
    if (mass == 0 || reach2 == 0) return 1;
    if (!std::isfinite(b.mass) || !b.first.allFinite() || !b.second.allFinite()) return 1;
    return std::max({std::abs(a.mass - b.mass) / mass,
                     (a.first - b.first).norm() / std::sqrt(mass * reach2),
                     (a.second - b.second).norm() / reach2});
  }
  void add(Misreading finding) {
    const std::vector<std::string>& left_out = reading_.not_kept;
    if (std::find(left_out.begin(), left_out.end(), finding.quantity) == left_out.end())
      out_.push_back(std::move(finding));
  }

  /// With the effect of having `changed` in place of our body.
  void addWithEffect(Misreading finding, std::size_t b, const ReadBody& changed) {
    if (allHaveOnePosition(ours_) && hasOnePosition(changed) && !isTooLargeToAsk(ours_)) {
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
    if (!crosscheck::isSame(body.moments, seen.moments, body.links, seen_.unturned, slip(b))) {
      ReadBody changed = body;
      changed.moments = seen.moments;
      NamedMistakes why = explanation(file_, b, seen.moments, seen_.unturned);
      if (why.words.empty()) why.words = digitsLost(shareOf(body.moments, seen.moments));
      Misreading finding{
          body.link,
          "inertia",
          why.words,
          (file_.hasInertial(b) ? "" : "no <inertial>, which is ") + shown(body.moments),
          shown(seen.moments),
          where};
      finding.read = seen.moments;
      for (const Mistake mistake : why.mistakes) {
        const std::string record = publicRecord(reader_, mistake);
        std::vector<std::string>& records = finding.records;
        if (!record.empty() && std::find(records.begin(), records.end(), record) == records.end())
          records.push_back(record);
      }
      addWithEffect(finding, b, changed);
    }
  }

  void comparePlace(std::size_t b, const ReadBody& seen, const scene::SourceLocation& where) {
    const ReadBody& body = ours_.bodies[b];
    const auto fits = [&](const Isometry3d& X) {
      const int frames = body.links + 1;
      return (X.linear() - seen.placement.linear()).norm() <= roundingOf(frames) &&
             (X.translation() - seen.placement.translation()).norm() <=
                 roundingOf(frames) * std::max(X.translation().norm(), file_.reach(b)) + slip(b);
    };
    if (fits(body.placement)) return;
    std::string rule;
    for (const JointReading& one : jointMisreadings(file_, b))
      if (rule.empty() && one.quantity == std::string("origin") && fits(one.body.placement))
        rule = one.words;
    if (rule.empty())
      rule =
          digitsLost(std::max((body.placement.linear() - seen.placement.linear()).norm(),
                              (body.placement.translation() - seen.placement.translation()).norm() /
                                  (fromRoot(b).length + file_.reach(b))));
    ReadBody changed = body;
    changed.placement = seen.placement;
    addWithEffect({body.link, "origin", rule, shown(body.placement), shown(seen.placement), where},
                  b, changed);
  }

  void compareAxis(std::size_t b, const ReadBody& seen, const scene::SourceLocation& where) {
    const ReadBody& body = ours_.bodies[b];
    const auto fits = [&](const Vector3d& axis) { return isSame(axis, seen.axis, 0); };
    if (fits(body.axis)) return;
    std::string rule;
    for (const JointReading& one : jointMisreadings(file_, b))
      if (rule.empty() && one.quantity == std::string("axis") && fits(one.body.axis))
        rule = one.words;
    ReadBody changed = body;
    changed.axis = seen.axis;
    addWithEffect({body.link, "axis", rule, shown(file_.writtenAxis(b)), shown(seen.axis), where},
                  b, changed);
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
    // a difference of two positions, which may cancel
    const double turns = std::max({1.0, std::abs(body.rest), std::abs(seen.rest)});
    if (body.stiffness != 0 && std::abs(body.rest - seen.rest) > roundingOf(0) * turns)
      number("spring rest", body.rest, seen.rest);
    const std::string limits = limit(body.lower) + " to " + limit(body.upper),
                      their_limits = limit(seen.lower) + " to " + limit(seen.upper);
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
  const Reading& reading_;
  const Robot& seen_;
  std::string reader_;
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

/// Meshes that are not there end some engines' reading, and some engines: then the file is read
/// without its shapes, which is told.
std::vector<ReadApart> readAll(const std::vector<const Reader*>& readers, const std::string& text,
                               const std::filesystem::path& file, int states, std::uint64_t seed,
                               const ReaderLimits& limits) {
  const auto whyNot = [](const ReadApart& read) {
    return inOneLine(read.failure.empty() ? read.reading.refusal : read.failure);
  };
  std::vector<ReadApart> all = readApart(readers, text, file, states, seed, limits);
  std::vector<const Reader*> others;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].reading.refusal = inOneLine(all[i].reading.refusal);
    if (whyNot(all[i]).empty()) continue;
    others.push_back(readers[i]);
    places.push_back(i);
  }
  const bool has_shapes =
      text.find("<visual") != std::string::npos || text.find("<collision") != std::string::npos;
  if (others.empty() || !has_shapes || scene::isMjcf(text)) return all;
  const std::string without_shapes = scene::urdfWithoutShapes(text);
  const std::vector<ReadApart> again =
      readApart(others, without_shapes, file, states, seed, limits);
  for (std::size_t k = 0; k < again.size(); ++k) {
    ReadApart& first = all[places[k]];
    if (whyNot(again[k]).empty()) {
      // a crash stays a finding; a refusal is a circumstance
      const std::string why = whyNot(first), failure = first.failure;
      first = again[k];
      first.failure = failure;
      first.reading.told.push_back("read without its shapes, since with them: " + why);
    } else if (first.failure.empty()) {
      first.reading.refusal += "; without its shapes: " + whyNot(again[k]);
    }
  }
  return all;
}

/// The engine's own M and g against those of the robot that it shows.
void compareAnswers(const ReadApart& read, std::uint64_t seed, ReaderResult* result) {
  const Robot& robot = read.reading.robot;
  for (std::size_t k = 0; k < read.answers.size(); ++k) {
    const MassAndGravity& own = read.answers[k];
    const MassAndGravity shown = massAndGravity(robot, drawPositions(robot, seed, k));
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

/// Without a copy that lived to tell, there is not even a name.
bool hasRead(const ReadApart& read) {
  const Reading& reading = read.reading;
  return reading.refusal.empty() && (read.failure.empty() || !reading.robot.bodies.empty());
}

/// What a reader has otherwise.
void judge(const FileParts& parts, const ReadApart& read, int states, std::uint64_t seed,
           ReaderResult* result) {
  const Robot& robot = read.reading.robot;
  if (read.reading.shows) {
    result->findings = Comparison(parts, read.reading, result->name, states, seed).findings();
    compareAnswers(read, seed, result);
    if (!allHaveOnePosition(robot))
      result->told.push_back(
          "its own M and g were not compared: a joint has several degrees of freedom");
    else if (isTooLargeToAsk(robot))
      result->told.push_back(
          "its own M and g were not compared: too many joints, and neither is "
          "what findings do to M and g");
    return;
  }
  if (read.answers.empty()) {
    result->has_read = false;
    result->refusal =
        "it says M and g alone, which are not compared: a joint has several degrees "
        "of freedom";
    return;
  }
  std::vector<std::vector<double>> positions;
  for (std::size_t k = 0; k < read.answers.size(); ++k)
    positions.push_back(drawPositions(robot, seed, k));
  result->told.push_back("it says M and g alone: what it has read is found from these");
  result->findings = explainAnswers(parts, positions, read.answers, result->name, states, seed);
}

/** What MJCF leaves open is taken as our reader has it: a body or joint without a name is told by
    its place in the file, and a free one stands in the world, where its own place is its start. */
void alignMjcf(const Robot& ours, Reading* reading) {
  std::vector<ReadBody>& theirs = reading->robot.bodies;
  for (std::size_t k = 0; k < std::min(ours.bodies.size(), theirs.size()); ++k) {
    if (theirs[k].link.empty()) theirs[k].link = ours.bodies[k].link;
    if (theirs[k].joint.empty()) theirs[k].joint = ours.bodies[k].joint;
    if (theirs[k].kind == scene::JointKind::kFloating && theirs[k].parent < 0)
      theirs[k].placement.setIdentity();
  }
  reading->not_kept.emplace_back("limits");  // by ours
}

/// What is in an MJCF file and not in the comparison.
std::vector<std::string> notCompared(const scene::Scene& scene) {
  std::vector<std::string> out = scene.not_modelled;
  const scene::Mechanism& mechanism = scene.mechanism;
  if (!mechanism.closures.empty())
    out.push_back(fmt::format("{} closures not compared", mechanism.closures.size()));
  if (std::any_of(mechanism.links.begin(), mechanism.links.end(), [](const scene::Link& link) {
        return link.joint.kind == scene::JointKind::kFloating;
      }))
    out.emplace_back("where free bodies start not compared");
  return out;
}

/// A robot that leaves readers little to do, and how it is written.
struct Plain {
  std::string text;
  FileParts parts;
  const char* how;
};
Plain plainOf(const scene::Urdf& urdf, bool is_mjcf, const std::filesystem::path& file) {
  std::vector<std::string> lost;
  std::string text = is_mjcf ? scene::writeSceneMjcf(urdf.scene, &lost) : plainUrdf(urdf);
  if (!lost.empty())
    throw scene::InputError({file.string(), 0}, "cannot be written whole: " + lost.front());
  FileParts parts = readParts(text, file);
  return {std::move(text), std::move(parts),
          is_mjcf
              ? "dynwitness write FILE --format mjcf -o OUT.xml: bodies, joints and inertias, and "
                "nothing else; tried: it then has the robot of the file"
              : "--plain OUT.urdf: fixed links merged, inertias in link axes; tried: it then "
                "has the robot of the file"};
}

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
                     [](const ReaderResult& r) { return r.has_read; });
}
bool ReadersResult::agrees() const {
  return std::all_of(readers.begin(), readers.end(),
                     [](const ReaderResult& r) { return r.findings.empty(); });
}

ReadersResult examineReaders(const std::string& text, const std::filesystem::path& file,
                             const std::vector<Reader>& readers, int states, std::uint64_t seed,
                             const ReaderLimits& limits) {
  const bool is_mjcf = scene::isMjcf(text);
  const scene::Urdf urdf = is_mjcf ? scene::Urdf{scene::readSceneMjcf(text, file), {}}
                                   : scene::readUrdfAsWritten(text, file);
  const FileParts parts = is_mjcf ? FileParts(urdf.scene.mechanism) : FileParts(urdf);
  ReadersResult result;
  result.format = is_mjcf ? "mjcf" : "urdf";
  if (is_mjcf) result.not_compared = notCompared(urdf.scene);
  result.file = file.string();
  result.links = static_cast<int>(urdf.scene.mechanism.links.size());
  result.states = states;
  result.seed = seed;
  if (!is_mjcf) result.remarks = scene::remarksOnUrdf(text, file.string());
  result.impossible = scene::impossibleInertias(urdf.scene);
  for (const ReadBody& body : parts.robot().bodies) result.bodies.push_back(body.link);
  if (result.bodies.empty())
    throw scene::InputError({file.string()}, "no joint moves, expected at least one that does");

  std::vector<const Reader*> asked;
  const auto isAsked = [&](const Reader& reader) {
    return reader.present && (reader.reads_mjcf || !is_mjcf);
  };
  for (const Reader& reader : readers)
    if (isAsked(reader)) asked.push_back(&reader);
  const auto readEach = [&](const std::vector<const Reader*>& who, const std::string& what,
                            const Robot& ours) {
    std::vector<ReadApart> all = readAll(who, what, file, states, seed, limits);
    for (ReadApart& one : all)
      if (is_mjcf) alignMjcf(ours, &one.reading);
    return all;
  };
  const std::vector<ReadApart> read = readEach(asked, text, parts.robot());
  std::vector<const Reader*> wrong;
  std::size_t k = 0;
  for (const Reader& reader : readers) {
    ReaderResult one;
    one.name = reader.name;
    one.version = reader.version;
    one.present = reader.present;
    one.absence = reader.absence;
    if (reader.present && !isAsked(reader)) one.refusal = "it does not read MJCF";
    if (isAsked(reader)) {
      const ReadApart& its = read[k++];
      if (!its.reading.name.empty()) one.name = its.reading.name;
      if (!its.reading.version.empty()) one.version = its.reading.version;
      one.refusal = its.reading.refusal;
      one.told = its.reading.told;
      one.failure = its.failure;
      one.has_read = hasRead(its);
      if (one.has_read) judge(parts, its, states, seed, &one);
      if (!its.failure.empty())
        one.findings.insert(one.findings.begin(),
                            {"", "failure", "it fails on this file", "", its.failure, {}});
      if (!one.findings.empty()) wrong.push_back(&reader);
    }
    result.readers.push_back(std::move(one));
  }
  if (wrong.empty()) return result;

  // the remedy is tried
  std::optional<Plain> plain;
  try {
    plain = plainOf(urdf, is_mjcf, file);
  } catch (const scene::InputError&) {  // its format has no word for something: nothing was tried
    return result;
  }
  const std::vector<ReadApart> again = readEach(wrong, plain->text, plain->parts.robot());
  k = 0;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    ReaderResult& one = result.readers[i];
    if (one.findings.empty()) continue;
    const ReadApart& its = again[k++];
    ReaderResult mended;
    mended.name = one.name;
    if (!its.failure.empty() || !hasRead(its)) continue;
    judge(plain->parts, its, states, seed, &mended);
    if (mended.findings.empty() && mended.refusal.empty()) one.remedy = plain->how;
  }
  return result;
}

std::string plainUrdf(const scene::Urdf& urdf) {
  const Robot robot = FileParts(urdf).robot();
  // the shortest decimal that is read as the same double: its exact one has 50 digits, of which
  // reading makes fractions of integers
  const auto exactly = [](double x) {
    return x == 0 ? scene::Number(0) : scene::Expression::parse(fmt::format("{}", x));
  };
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
