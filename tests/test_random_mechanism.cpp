// SPDX-License-Identifier: GPL-3.0-or-later
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE random_mechanism
#include "crosscheck/exact/random_mechanism.hpp"

#include <algorithm>
#include <set>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/crosscheck.hpp"
#include "crosscheck/identities.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

BOOST_AUTO_TEST_SUITE(drawing)

BOOST_DATA_TEST_CASE(the_same_seed_and_index_give_the_same_file, data::xrange(20), index) {
  const std::string text = scene::writeSceneToml(randomScene(7, index, 8));
  BOOST_TEST(text == scene::writeSceneToml(randomScene(7, index, 8)));
  BOOST_TEST(text != scene::writeSceneToml(randomScene(8, index, 8)));
  BOOST_TEST(text != scene::writeSceneToml(randomScene(7, index + 1, 8)));
}

BOOST_DATA_TEST_CASE(the_file_reads_back_as_the_same_scene, data::xrange(40), index) {
  const scene::Scene drawn = randomScene(1, index, 12);
  const std::string text = scene::writeSceneToml(drawn);
  const scene::Scene read = scene::readSceneToml(text, drawn.file);  // and it is valid
  BOOST_TEST(scene::writeSceneToml(read) == text);
  BOOST_TEST(read.name == drawn.name);
  BOOST_TEST(read.mechanism.dof() == drawn.mechanism.dof());
}

BOOST_AUTO_TEST_CASE(everything_that_a_scene_can_have_occurs) {
  std::set<int> dofs;
  std::set<std::string> seen;
  for (int index = 0; index < 150; ++index) {
    const scene::Mechanism mechanism = randomScene(1, index, 12).mechanism;
    dofs.insert(static_cast<int>(mechanism.movingLinks().size()));
    seen.insert(mechanism.has_gravity ? "gravity" : "no gravity");
    for (const scene::Wrench& w : mechanism.wrenches)
      seen.insert(w.axes == scene::Wrench::Axes::kWorld ? "world load" : "link load");
    for (std::size_t i = 1; i < mechanism.links.size(); ++i) {
      const scene::Link& link = mechanism.links[i];
      const scene::Joint& joint = link.joint;
      seen.insert(scene::name(joint.kind));
      seen.insert("placement " + std::to_string(static_cast<int>(joint.placement.convention)));
      if (link.parent != static_cast<int>(i) - 1) seen.insert("branch");
      if (!joint.rotor_inertia.isLiteralZero()) seen.insert("rotor");
      if (!joint.stiffness.isLiteralZero()) seen.insert("spring");
      if (joint.gyroscopic) seen.insert("gyroscopic");
      if (!joint.friction.viscous.isLiteralZero()) seen.insert("viscous");
      if (joint.friction.isCoulomb()) seen.insert("coulomb");
      if (link.inertia.mass.isLiteralZero()) seen.insert("massless");
      if (!link.inertia.rpy[0].isLiteralZero()) seen.insert("turned inertia");
      if (link.inertia.about == scene::MassProperties::About::kLinkOrigin) seen.insert("about origin");
    }
  }
  for (const char* wanted :
       {"gravity", "no gravity", "world load", "link load", "fixed", "revolute", "prismatic",
        "helical", "cylindrical", "universal", "planar", "spherical", "floating",
        "placement 0", "placement 1", "placement 2", "branch", "rotor", "spring", "massless",
        "gyroscopic", "viscous", "coulomb",
        "turned inertia", "about origin"})
    BOOST_TEST(seen.count(wanted) == 1u, wanted << " never occurs");
  BOOST_TEST(dofs.size() == 12u);  // 1 to 12 joints, each number
  BOOST_TEST(*dofs.begin() == 1);
  BOOST_TEST(*dofs.rbegin() == 12);
}

BOOST_AUTO_TEST_CASE(a_mechanism_without_joints_is_refused) {
  BOOST_CHECK_THROW(randomScene(1, 0, 0), std::invalid_argument);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(campaigns)

BOOST_AUTO_TEST_CASE(all_residuals_of_random_mechanisms_are_zero) {
  ExactOptions options;
  options.seed = 3;
  int calls = 0;
  const RandomCampaign campaign = crosscheckRandom(25, 12, options, 1, [&](int done) {
    BOOST_TEST(done == 5 * ++calls);
  });
  BOOST_TEST(calls == 5);
  BOOST_TEST(campaign.mechanisms == 25);
  BOOST_TEST(campaign.joints >= 25);
  // pairs of five or six witnesses (one refuses gyroscopic rotors), the regressor and the identities;
  // some trees have no other root
  BOOST_TEST(campaign.checks > 25 * (12 + kIdentityCount));
  BOOST_TEST(campaign.checks <= 25 * (41 + kIdentityCount));
  BOOST_TEST(campaign.not_answerable == 0);
  BOOST_TEST(campaign.error_probability <= 1e-30);
  BOOST_TEST(campaign.error_probability > 0);
  for (const RandomCampaign::Failure& failure : campaign.failures)
    BOOST_ERROR(describeFailure(failure));
}

BOOST_AUTO_TEST_CASE(kernels_take_part_when_they_are_named) {
  ExactOptions options;
  options.witnesses = {"newton_euler"};
  const RandomCampaign without = crosscheckRandom(3, 6, options);
  options.witnesses.push_back("kernel");
  const RandomCampaign with = crosscheckRandom(3, 6, options, 2);
  int kernels = 0;  // which have no sign for Coulomb's friction
  for (int index = 0; index < 3; ++index)
    kernels += randomScene(options.seed, index, 6).mechanism.hasCoulombFriction() ? 0 : 1;
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
    BOOST_TEST(std::all_of(failure.findings.begin(), failure.findings.end(), [](const Finding& f) {
      return f.witness == "composite_body";
    }));

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
