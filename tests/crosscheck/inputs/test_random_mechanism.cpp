// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/inputs/random_mechanism.hpp"

#include <algorithm>
#include <set>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "scene/scene.hpp"

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
      if (joint.mimic) seen.insert("follower");
      if (!joint.friction.viscous.isLiteralZero()) seen.insert("viscous");
      if (joint.friction.isCoulomb()) seen.insert("coulomb");
      if (link.inertia.mass.isLiteralZero()) seen.insert("massless");
      if (!link.inertia.rpy[0].isLiteralZero()) seen.insert("turned inertia");
      if (link.inertia.about == scene::MassProperties::About::kLinkOrigin)
        seen.insert("about origin");
    }
  }
  for (const char* wanted :
       {"gravity",        "no gravity",  "world load",  "link load",   "fixed",   "revolute",
        "prismatic",      "helical",     "cylindrical", "universal",   "planar",  "spherical",
        "floating",       "placement 0", "placement 1", "placement 2", "branch",  "rotor",
        "spring",         "massless",    "gyroscopic",  "viscous",     "coulomb", "follower",
        "turned inertia", "about origin"})
    BOOST_TEST(seen.count(wanted) == 1u, wanted << " never occurs");
  BOOST_TEST(dofs.size() == 12u);  // 1 to 12 joints, each number
  BOOST_TEST(*dofs.begin() == 1);
  BOOST_TEST(*dofs.rbegin() == 12);
}

BOOST_DATA_TEST_CASE(a_plain_mechanism_has_what_every_engine_builds, data::xrange(40), index) {
  const scene::Scene scene = randomScene(1, index, 12, JointKinds::kPlain);
  for (const scene::Link& link : scene.mechanism.links) {
    const scene::JointKind kind = link.joint.kind;
    BOOST_TEST((kind == scene::JointKind::kFixed || kind == scene::JointKind::kRevolute ||
                kind == scene::JointKind::kPrismatic));
    BOOST_TEST(!link.joint.gyroscopic);
  }
  BOOST_TEST(scene::writeSceneToml(scene) != scene::writeSceneToml(randomScene(1, index, 12)));
}

BOOST_DATA_TEST_CASE(a_whole_mechanism_is_the_same_tree_and_more, data::xrange(60), index) {
  scene::Scene whole = randomWholeScene(1, index, 12);
  const std::string text = scene::writeSceneToml(whole);
  BOOST_TEST(scene::writeSceneToml(scene::readSceneToml(text, whole.file)) == text);
  scene::Mechanism& m = whole.mechanism;
  BOOST_TEST((m.closures.empty() || m.acceleration_constraints.empty()));
  if (m.hasMimics()) BOOST_TEST((m.closures.empty() && !m.isDriven()));
  m.links.erase(m.links.end() - static_cast<std::ptrdiff_t>(m.closures.size()), m.links.end());
  m.closures.clear();
  m.springs.clear();
  m.acceleration_constraints.clear();
  for (scene::Link& link : m.links) link.joint.motion.clear();
  whole.start_q = m.restPosition();
  whole.start_qd.assign(m.dof(), scene::Number(0));
  BOOST_TEST(scene::writeSceneToml(whole) == scene::writeSceneToml(randomScene(1, index, 12)));
}

BOOST_AUTO_TEST_CASE(a_mechanism_without_joints_is_refused) {
  BOOST_CHECK_THROW(randomScene(1, 0, 0), std::invalid_argument);
}

BOOST_AUTO_TEST_SUITE_END()
