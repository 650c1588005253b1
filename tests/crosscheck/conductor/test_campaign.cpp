// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/conductor/campaign.hpp"

#include <algorithm>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/conductor/archive.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/laws/identities.hpp"
#include "crosscheck/laws/point_laws.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/witnesses/engine_bound.hpp"
#include "crosscheck/witnesses/exact_sweeps.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

std::vector<WitnessKind> presentEngines() {
  std::vector<WitnessKind> present;
  for (const WitnessKind& kind :
       {simbodyKind(), mujocoKind(), mujocoPrincipalKind(), dartKind(), kdlKind()})
    if (kind.info.present) present.push_back(kind);
  return present;
}

std::vector<WitnessKind> sweepsAnd(std::vector<WitnessKind> others) {
  std::vector<WitnessKind> kinds = {lagrangeKind(), newtonEulerKind(), compositeBodyKind(),
                                    articulatedBodyKind()};
  kinds.insert(kinds.end(), others.begin(), others.end());
  return kinds;
}

/// The sweeps in double and whoever else, nothing exact but the identities.
CampaignOptions inDouble(std::vector<WitnessKind> kinds, std::uint64_t seed = 1) {
  CampaignOptions options;
  options.exact.seed = seed;
  options.exact.witnesses = {newtonEulerKind()};
  options.in_double = std::move(kinds);
  options.states = 2;
  return options;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(exact_campaigns)

BOOST_AUTO_TEST_CASE(all_residuals_of_random_mechanisms_are_zero) {
  CampaignOptions options;
  options.exact.seed = 3;
  int calls = 0;
  const RandomCampaign campaign =
      crosscheckRandom(25, 12, options, 1, [&](int done) { BOOST_TEST(done == 5 * ++calls); });
  BOOST_TEST(calls == 5);
  BOOST_TEST(campaign.mechanisms == 25);
  BOOST_TEST(campaign.joints >= 25);
  // pairs of five or six witnesses (one refuses gyroscopic rotors), the regressor and the
  // identities; some trees have no other root
  BOOST_TEST(campaign.checks > 25 * (12 + Identities::kCount + PointLaws::kCount));
  // up to 15 about closures, springs between points, drives and constraints, and six pairs of roads
  // to each of six derivatives
  BOOST_TEST(campaign.checks <= 25 * (41 + 15 + 36 + Identities::kCount + PointLaws::kCount));
  BOOST_TEST(campaign.not_answerable == 0);
  BOOST_TEST(campaign.error_probability <= 1e-30);
  BOOST_TEST(campaign.error_probability > 0);
  for (const RandomCampaign::Failure& failure : campaign.failures)
    BOOST_ERROR(describeFailure(failure));
}

BOOST_AUTO_TEST_CASE(kernels_take_part_when_they_are_named) {
  CampaignOptions options;
  options.exact.witnesses = {newtonEulerKind()};
  const RandomCampaign without = crosscheckRandom(3, 6, options);
  options.exact.witnesses.push_back(kernelKind());
  const RandomCampaign with = crosscheckRandom(3, 6, options, 2);
  int kernels = 0;  // which have no sign for Coulomb's friction
  for (int index = 0; index < 3; ++index)
    kernels += randomScene(options.exact.seed, index, 6).mechanism.hasCoulombFriction() ? 0 : 1;
  BOOST_TEST(kernels > 0);
  BOOST_TEST(with.checks == without.checks + kernels * 2);  // M and tau, which both answer
  BOOST_TEST(with.failures.empty());
}

BOOST_AUTO_TEST_CASE(an_error_of_one_part_in_a_million_million_million_fails_in_every_mechanism) {
  for (int index = 0; index < 10; ++index) {
    const scene::Scene scene = randomScene(5, index, 6);
    const auto change = [](auto& model, const auto& number) {
      using T = typename std::decay_t<decltype(number)>::Scalar;
      model.links.back().M.mass *= T(1) + T(1) / T(1000000000) / T(1000000000);
      model.links.back().rotor += T(1) / T(1000000000) / T(1000000000);
    };
    std::vector<ExactWitness> witnesses = exactWitnesses(scene, Parameters::kAsWritten);
    witnesses[2] = sweepWitness<CompositeBody>(scene, change);
    RandomCampaign::Failure failure{scene, {}, {}};
    const auto checks = compareExactly(scene, witnesses, {});
    for (const CheckResult& check : checks)
      if (check.verdict == Verdict::kDisagree) failure.checks.push_back(check);
    failure.findings = findOutliers(scene.name, checks);
    std::size_t others = 0;  // that answer M or qdd
    for (const ExactWitness& witness : witnesses)
      for (const Quantity quantity : {Quantity::kM, Quantity::kQdd})
        others += witness.name != "composite_body" && witness.answers(quantity) ? 1 : 0;
    BOOST_TEST_REQUIRE(failure.checks.size() == others);
    BOOST_TEST(std::all_of(failure.findings.begin(), failure.findings.end(),
                           [](const Finding& f) { return f.witness == "composite_body"; }));

    // what is printed is enough to see it again
    const std::string text = describeFailure(failure);
    BOOST_TEST(text.find("composite_body stands alone") != std::string::npos);
    BOOST_TEST(text.find("dynwitness crosscheck " + scene.name + ".toml --seed 1\n") !=
               std::string::npos);
    const std::size_t file = text.find("title = ");
    BOOST_TEST_REQUIRE(file != std::string::npos);
    BOOST_TEST(scene::readSceneToml(text.substr(file), scene.file).mechanism.dof() ==
               scene.mechanism.dof());
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(campaigns_in_double)

BOOST_AUTO_TEST_CASE(engines_agree_and_each_is_asked_about_as_many_mechanisms_as_were_wanted) {
  const std::vector<WitnessKind> engines = presentEngines();
  const RandomCampaign campaign = crosscheckRandom(15, 8, inDouble(sweepsAnd(engines), 4));
  for (const RandomCampaign::Failure& failure : campaign.failures)
    BOOST_ERROR(describeFailure(failure));
  BOOST_TEST(campaign.mechanisms == 15);
  for (const WitnessKind& engine : engines)
    BOOST_TEST(campaign.asked.at(engine.info.name) >= 15, engine.info.name);
  // pairs and truths of nine quantities at two states
  BOOST_TEST(campaign.comparisons > 15 * 2 * 9);
  for (const auto& [reason, counts] : campaign.unanswered)  // nobody's own name
    for (const char* own : {"random_", "joint_", "link_"})
      BOOST_TEST(reason.find(own) == std::string::npos, reason);
  for (const WitnessKind& engine : engines) {
    int refusals = 0;
    for (const auto& [reason, counts] : campaign.unanswered) {
      const auto found = counts.find(engine.info.name);
      if (found != counts.end()) refusals += found->second;
    }
    BOOST_TEST(refusals == 15 + campaign.plain - campaign.asked.at(engine.info.name),
               engine.info.name);
  }
}

BOOST_AUTO_TEST_CASE(the_result_is_the_same_however_many_processes_find_it) {
  const CampaignOptions options = inDouble(sweepsAnd({simbodyKind()}), 6);
  const std::string one = archived(crosscheckRandom(17, 5, options, 1));
  BOOST_TEST((archived(crosscheckRandom(17, 5, options, 2)) == one));
  BOOST_TEST((archived(crosscheckRandom(17, 5, options, 4)) == one));
}

BOOST_AUTO_TEST_CASE(
    an_inertia_that_is_wrong_in_the_ninth_digit_is_found_and_named_with_its_scene) {
  WitnessKind mistaken = simbodyKind();
  mistaken.make = [](const PreparedScene& right) {
    scene::Scene scene = right.scene();
    scene::MassProperties& m = scene.mechanism.links.back().inertia;
    const auto change = [&](scene::Number& x) {
      const scene::Rational exact =
          scene::exactValue(x, scene.mechanism.parameterValues()).rational;
      x = scene::Number(exact + exact / 1000000000);
    };
    for (scene::Number* x : {&m.mass, &m.xx, &m.yy, &m.zz, &m.xy, &m.xz, &m.yz}) change(*x);
    return simbodyKind().make(scene);
  };
  const RandomCampaign campaign = crosscheckRandom(12, 6, inDouble(sweepsAnd({mistaken}), 2));
  for (int index = 0; index < 12; ++index) {
    const scene::Scene scene = randomScene(2, index, 6);
    const std::vector<scene::Link>& links = scene.mechanism.links;
    bool moves = false;
    for (int i = static_cast<int>(links.size()) - 1; i > 0; i = links[i].parent)
      moves = moves || links[i].joint.kind != scene::JointKind::kFixed;
    // Simbody is not asked about rotors that are geared to several rates
    if (scene.mechanism.hasGearedRotors()) continue;
    if (!moves || links.back().inertia.mass.isLiteralZero()) continue;
    BOOST_TEST(std::any_of(campaign.failures.begin(), campaign.failures.end(),
                           [&](const RandomCampaign::Failure& failure) {
                             return failure.scene.name == scene.name;
                           }),
               scene.name << " passed");
  }
  BOOST_TEST(campaign.failures.size() >= 6u);
  for (const RandomCampaign::Failure& failure : campaign.failures) {
    BOOST_TEST(std::any_of(failure.findings.begin(), failure.findings.end(),
                           [](const Finding& finding) { return finding.witness == "simbody"; }));
    for (const CheckResult& check : failure.checks)
      BOOST_TEST((check.left == "simbody" || check.right == "simbody"), describeFailure(failure));
    const std::string text = describeFailure(failure);
    BOOST_TEST(text.find("dynwitness crosscheck " + failure.scene.name + ".toml --seed 2\n") !=
               std::string::npos);
  }
}

BOOST_AUTO_TEST_CASE(an_engine_whose_gravity_points_up_is_found_wherever_there_is_gravity) {
  WitnessKind mistaken = simbodyKind();
  mistaken.make = [](const PreparedScene& right) {
    scene::Scene scene = right.scene();
    for (scene::Number& x : scene.mechanism.gravity)
      x = scene::Number(-scene::exactValue(x, scene.mechanism.parameterValues()).rational);
    return simbodyKind().make(scene);
  };
  const RandomCampaign campaign = crosscheckRandom(12, 6, inDouble(sweepsAnd({mistaken}), 2));
  int with_gravity = 0;
  for (int index = 0; index < 12; ++index)
    with_gravity += randomScene(2, index, 6).mechanism.has_gravity ? 1 : 0;
  BOOST_TEST(static_cast<int>(campaign.failures.size()) == with_gravity);
  BOOST_TEST(with_gravity > 0);
}

BOOST_AUTO_TEST_SUITE_END()

// c of one joint is zero, whatever turns about it, and so is g of an upright axis: for us exactly,
// term by term. In other axes terms cancel, and their rounding is left.
BOOST_AUTO_TEST_SUITE(zero_by_structure)

namespace {

/// A link with products of inertia, on one joint whose axis stands obliquely, in a world where
/// gravity is along that axis.
scene::Scene oblique(const char* kind) {
  return scene::readSceneToml(std::string(R"(
gravity = [3, -4, 12]
[[link]]
name = "base"
[[link]]
name = "link"
parent = "base"
mass = 2
com = [0.3, -0.2, 0.1]
inertia = { xx = 0.5, yy = 0.6, zz = 0.7, xy = 0.1, xz = -0.05, yz = 0.15 }
[link.joint]
name = "joint"
axis = [3, -4, 12]
xyz = [0.1, 0.2, 0.3]
kind = ")") + kind + "\"\n",
                              "oblique.toml");
}

}  // namespace

BOOST_AUTO_TEST_CASE(an_engine_may_lose_some_ulps_of_the_terms_that_cancel_and_no_more) {
  const scene::Scene scene = oblique("revolute");
  EngineBound bound(scene.mechanism);
  constexpr double kUlp = 2.2e-16;
  for (int k = 0; k < 20; ++k) {
    const scene::State<double> state = drawState(scene.mechanism, scene.name, 1, k);
    const double qd = state.qd[0];
    // by hand: |I| about the joint is below 0.5 + 0.6 + 0.7 + 2 m c^2 = 2.4 kg m^2, and gravity 13
    // m/s^2 acts on 2 kg at 0.37 m
    const double of_c = bound(Quantity::kc, state)(0, 0), of_g = bound(Quantity::kg, state)(0, 0);
    BOOST_TEST(of_c > kUlp * 0.5 * qd * qd);
    BOOST_TEST(of_c < 400 * kUlp * 2.4 * qd * qd);
    BOOST_TEST(of_g > kUlp * 13);
    BOOST_TEST(of_g < 100 * kUlp * 13 * 2 * 0.37);
    for (const WitnessKind& engine : presentEngines()) {
      const Answer c = engine.make(scene).value()->answer(Quantity::kc, state);
      BOOST_TEST(std::abs(c.value(0, 0)) <= c.bound(0, 0), engine.info.name);
      const Answer g = engine.make(scene).value()->answer(Quantity::kg, state);
      BOOST_TEST(std::abs(g.value(0, 0)) <= g.bound(0, 0), engine.info.name);
    }
  }
}

BOOST_AUTO_TEST_CASE(what_no_engine_computes_from_anything_is_zero_to_all) {
  const scene::Scene scene = oblique("prismatic");  // nothing turns, so c has no term at all
  const scene::State<double> state = drawState(scene.mechanism, scene.name, 1, 0);
  for (const WitnessKind& engine : presentEngines())
    BOOST_TEST(engine.make(scene).value()->answer(Quantity::kc, state).value(0, 0) == 0,
               engine.info.name);
}

BOOST_AUTO_TEST_SUITE_END()

// What campaigns found, cut down.
BOOST_AUTO_TEST_SUITE(found_by_campaigns)

// Simbody had the rotor of a resting link pinned to the world, whose reaction is nobody's.
BOOST_AUTO_TEST_CASE(a_gyroscopic_rotor_on_a_stand_turns_the_stand_as_it_spins_up) {
  const scene::Scene scene = scene::readSceneToml(R"(
[[link]]
name = "base"
[[link]]
name = "stand"
parent = "base"
mass = 2
[link.joint]
name = "foot"
kind = "fixed"
[[link]]
name = "wheel"
parent = "stand"
mass = 1
inertia = { xx = 0.2, yy = 0.2, zz = 0.4 }
[link.joint]
name = "hub"
kind = "revolute"
rotor_inertia = 0.003
gear_ratio = 50
gyroscopic = true
)",
                                                  "stand.toml");
  scene::State<double> state = drawState(scene.mechanism, scene.name, 1, 0);
  const double qdd = state.qdd[0] = 4;
  for (const WitnessKind& kind : {newtonEulerKind(), lagrangeKind(), simbodyKind()}) {
    const Answer answer = kind.make(scene).value()->answer(Quantity::kReactions, state);
    // by hand: the wheel needs I qdd of the stand, the rotor n J qdd, and the foot holds both
    BOOST_TEST(std::abs(answer.value(5, 0) - (0.4 + 50 * 0.003) * qdd) < 1e-12, kind.info.name);
    BOOST_TEST(std::abs(answer.value(11, 0) - 0.4 * qdd) < 1e-12, kind.info.name);
  }
}

// KDL numbers the joints of a copied tree anew, depth first; its solvers of frames keep copies.
BOOST_AUTO_TEST_CASE(joints_keep_their_numbers_where_links_are_not_written_depth_first) {
  if (!kdlKind().info.present) return;
  scene::Scene scene = scene::findScene("double_pendulum");
  scene::Mechanism& mechanism = scene.mechanism;
  scene::Link branch = mechanism.links[1];
  branch.name = "branch";
  branch.joint.name = "branch_joint";
  branch.inertia.mass = scene::Number(3);
  mechanism.links.insert(mechanism.links.begin() + 2, branch);  // between a link and its child
  BOOST_TEST_REQUIRE(mechanism.links[3].parent == 1);
  Options options;
  options.states = 5;
  for (const CheckResult& check : compareWitnesses(scene, {newtonEulerKind(), kdlKind()}, options))
    BOOST_TEST((check.verdict == Verdict::kAgree), check.statement << ": " << check.reason);
}

BOOST_AUTO_TEST_SUITE_END()
