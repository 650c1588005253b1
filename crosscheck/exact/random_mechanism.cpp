// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/exact/random_mechanism.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/archive.hpp"
#include "crosscheck/crosscheck.hpp"
#include "crosscheck/processes.hpp"
#include "crosscheck/states.hpp"

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
  Drawing(std::uint64_t seed, std::uint64_t index) : random_("random mechanism", seed, index) {}

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
    return out;
  }

 private:
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
    Rational mass = 1;
    std::array<Rational, 3> last{0, 0, 0}, com;
    std::vector<std::pair<Rational, std::array<Rational, 3>>> points;  // from the centre of mass
    for (int i = 1; i < count; ++i) {
      const Rational m(1 + below(20), 10);
      std::array<Rational, 3> r;
      for (int k = 0; k < 3; ++k) {
        r[k] = Rational(below(61) - 30, 100);
        last[k] -= m * r[k];
      }
      mass += m;
      points.emplace_back(m, r);
    }
    points.emplace_back(1, last);
    for (Rational& x : com) x = Rational(below(61) - 30, 100);

    scene::MassProperties out;
    out.mass = mass;
    out.com = {Number(com[0]), Number(com[1]), Number(com[2])};
    const bool at_origin = chance(30);
    if (at_origin)
      out.about = scene::MassProperties::About::kLinkOrigin;
    else if (chance(30))
      out.rpy = {angle(), angle(), angle()};
    Rational I[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    for (auto [m, r] : points) {
      if (at_origin)
        for (int k = 0; k < 3; ++k) r[k] += com[k];
      const Rational r2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) I[i][j] += m * ((i == j ? r2 : Rational(0)) - r[i] * r[j]);
    }
    out.xx = I[0][0];
    out.yy = I[1][1];
    out.zz = I[2][2];
    out.xy = I[0][1];
    out.xz = I[0][2];
    out.yz = I[1][2];
    return out;
  }

  /// Mostly revolute or prismatic.
  JointKind kind() {
    static constexpr JointKind kRare[] = {JointKind::kHelical,   JointKind::kCylindrical,
                                          JointKind::kUniversal, JointKind::kPlanar,
                                          JointKind::kSpherical, JointKind::kFloating};
    if (chance(30)) return kRare[below(6)];
    return chance(70) ? JointKind::kRevolute : JointKind::kPrismatic;
  }

  scene::Link link(int index, bool fixed) {
    scene::Link out;
    out.name = fmt::format("link_{}", index);
    out.parent = chance(65) ? index - 1 : below(index);
    scene::Joint& joint = out.joint;
    joint.name = fmt::format("joint_{}", index);
    joint.kind = fixed ? JointKind::kFixed : kind();
    const bool has_axis = scene::hasAxis(joint.kind), has_one_q = scene::degreesOfFreedom(joint.kind) == 1;
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
    joint.gyroscopic = has_rotor && chance(30);
    if (has_one_q && chance(20)) {
      joint.friction.viscous = decimal(0, 300);
      if (chance(50)) joint.friction.positive = joint.friction.negative = decimal(0, 300);
    }
    // without a mass of its own, or a rotor, a joint could move nothing that another one does not
    if (chance(90) || !(fixed || has_rotor)) out.inertia = body(
        joint.kind != JointKind::kSpherical && joint.kind != JointKind::kFloating);
    return out;
  }

  RandomStream random_;
};

}  // namespace

scene::Scene randomScene(std::uint64_t seed, std::uint64_t index, int max_joints) {
  if (max_joints < 1)
    throw std::invalid_argument(
        fmt::format("randomScene: max_joints: expected 1 or more, got {}", max_joints));
  Drawing drawing(seed, index);
  scene::Scene out;
  out.name = fmt::format("random_{}_{}", seed, index);
  out.title = fmt::format("Random mechanism {}", index);
  out.source = fmt::format("dynwitness, random mechanism {} of seed {} with up to {} joints", index,
                           seed, max_joints);
  out.file = out.name + ".toml";
  while (true) {
    out.mechanism = drawing.mechanism(max_joints);
    out.start_q = out.mechanism.restPosition();
    out.start_qd.assign(out.mechanism.dof(), Number(0));
    try {
      scene::validate(out);
      return out;
    } catch (const scene::InputError&) {  // a joint that moves no inertia: the next one, then
    }
  }
}

namespace {

void checkOne(int index, int max_joints, const ExactOptions& options, RandomCampaign& campaign) {
  RandomCampaign::Failure failure{randomScene(options.seed, index, max_joints), {}, {}};
  const std::vector<CheckResult> checks = exactChecks(failure.scene, options);
  for (const CheckResult& check : checks) {
    // a single body has no other root, and there is nothing to ask
    if (check.verdict == Verdict::kNotAnswerable && check.check == "independence of the chosen root")
      continue;
    if (check.verdict != Verdict::kAgree) failure.checks.push_back(check);
    if (check.verdict == Verdict::kNotAnswerable) {
      ++campaign.not_answerable;
      continue;
    }
    ++campaign.checks;
    campaign.error_probability = std::max(campaign.error_probability, check.exact->error_probability);
  }
  ++campaign.mechanisms;
  campaign.joints += failure.scene.mechanism.dof();
  failure.findings = findOutliers(failure.scene.name, checks);
  if (!failure.checks.empty()) campaign.failures.push_back(std::move(failure));
}

void append(RandomCampaign& all, RandomCampaign more) {
  all.mechanisms += more.mechanisms;
  all.joints += more.joints;
  all.checks += more.checks;
  all.not_answerable += more.not_answerable;
  all.error_probability = std::max(all.error_probability, more.error_probability);
  std::move(more.failures.begin(), more.failures.end(), std::back_inserter(all.failures));
}

}  // namespace

RandomCampaign crosscheckRandom(int count, int max_joints, const ExactOptions& options, int processes,
                                const std::function<void(int)>& progress) {
  ExactOptions asked = options;
  if (asked.witnesses.empty())
    for (const WitnessKind& kind : witnessKinds())
      if (kind.info.name.rfind("kernel", 0) != 0) asked.witnesses.push_back(kind.info.name);
  constexpr int kBlock = 5;  // mechanisms a task
  int done = 0;
  const auto size = [=](int block) { return std::min(kBlock, count - block * kBlock); };
  const std::vector<std::string> parts = inProcesses(
      processes, (count + kBlock - 1) / kBlock,
      [&](int block) {
        RandomCampaign part;
        for (int i = 0; i < size(block); ++i)
          checkOne(block * kBlock + i, max_joints, asked, part);
        return archived(part);
      },
      [&](int block) {
        done += size(block);
        if (progress) progress(done);
      });
  RandomCampaign campaign;
  for (const std::string& part : parts) append(campaign, randomCampaignOf(part));
  return campaign;
}

std::string describeFailure(const RandomCampaign::Failure& failure) {
  std::string text;
  for (const Finding& finding : failure.findings) text += finding.text + "\n";
  for (const CheckResult& check : failure.checks)
    text += fmt::format("{}: {}: {}, {} ({}{}{}): {}\n", failure.scene.name, name(check.verdict),
                        check.check, check.quantity, check.left, check.right.empty() ? "" : " and ",
                        check.right, check.reason);
  return text + fmt::format(
                    "to see it again: write the scene below to {0}, then\n"
                    "  dynwitness crosscheck {0} --seed {1}\n\n{2}",
                    failure.scene.file.string(), failure.checks.front().seed,
                    scene::writeSceneToml(failure.scene));
}

}  // namespace dynwitness::crosscheck
