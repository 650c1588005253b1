// SPDX-License-Identifier: GPL-3.0-or-later
// What a crosscheck hands down, and the one list that its witnesses come from.
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE prepared_scene
#include <string>

#include <boost/test/unit_test.hpp>

#include "crosscheck/kernel/kernel.hpp"
#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/witnesses/exact_witness.hpp"
#include "crosscheck/witnesses/lagrange.hpp"
#include "crosscheck/witnesses/witness.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;

BOOST_AUTO_TEST_SUITE(prepared_scene)

BOOST_AUTO_TEST_CASE(each_part_is_made_once_whoever_asks) {
  const PreparedScene scene = scene::findScene("puma_560"), handed_down = scene;
  BOOST_TEST(&scene.model<double>() == &handed_down.model<double>());
  BOOST_TEST(&scene.model<RunningError>() == &handed_down.model<RunningError>());
  BOOST_TEST(&scene.modelWithFixedJoints<double>() == &handed_down.modelWithFixedJoints<double>());
  BOOST_TEST(&scene.derived(true) == &handed_down.derived(true));
  BOOST_TEST(&scene.derived(true) != &scene.derived(false));
  BOOST_TEST(&scene.roads() == &handed_down.roads());
  BOOST_TEST(&scene.kernel() == &handed_down.kernel());
}

BOOST_AUTO_TEST_CASE(its_models_are_those_of_their_names) {
  const PreparedScene scene = scene::findScene("kuka_iiwa_14");
  const auto links = scene.mechanism().links.size();
  BOOST_TEST(scene.model<double>().links.size() <
             scene.modelWithFixedJoints<double>().links.size());
  BOOST_TEST(scene.model<double>().joints.size() == links);
  BOOST_TEST(scene.model<RunningError>().links.size() == scene.model<double>().links.size());
}

BOOST_AUTO_TEST_CASE(the_tree_of_a_scene_is_one_scene_too) {
  const PreparedScene gripper = scene::findScene("gripper"), tree = gripper.tree();
  BOOST_TEST(gripper.mechanism().hasMimics());
  BOOST_TEST(!tree.mechanism().hasMimics());
  BOOST_TEST(&tree.scene() == &gripper.tree().scene());
  BOOST_TEST(&tree.scene() == &tree.tree().scene());
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(registry)

BOOST_AUTO_TEST_CASE(both_faces_of_a_witness_have_one_name_and_answer_the_same) {
  const PreparedScene scene = scene::findScene("puma_560");
  int exact = 0;
  for (const WitnessKind& kind : witnessKinds()) {
    if (!kind.info.present || !kind.make_exact) continue;
    BOOST_TEST_CONTEXT(kind.info.name) {
      const auto in_double = kind.make(scene).value();
      const ExactWitness in_field = kind.make_exact(scene, Parameters::kAsWritten).value();
      BOOST_TEST(in_double->name() == kind.info.name);
      BOOST_TEST(in_field.name == kind.info.name);
      for (const Quantity quantity : kAllQuantities)
        BOOST_TEST(in_field.answers(quantity) == in_double->answers(quantity), name(quantity));
      ++exact;
    }
  }
  BOOST_TEST(exact >= 6);
}

BOOST_AUTO_TEST_CASE(a_refusal_is_a_reason) {
  const PreparedScene loop = scene::findScene("bricard");
  for (const WitnessKind& kind : witnessKinds()) {
    if (!kind.info.present || !kind.is_compiled) continue;
    const MadeWitness made = kind.make(loop);
    BOOST_TEST_REQUIRE(made.isRefused());
    BOOST_TEST(made.refusal().find("open trees") != std::string::npos, made.refusal());
    BOOST_CHECK_EXCEPTION(kind.make(loop).value(), std::runtime_error,
                          [&](const auto& error) { return error.what() == made.refusal(); });
    if (!kind.make_exact) continue;
    BOOST_TEST(kind.make_exact(loop, Parameters::kAsWritten).refusal() == made.refusal());
    BOOST_TEST(kind.make_exact(scene::findScene("puma_560"), Parameters::kRandom).isRefused());
  }
}

BOOST_AUTO_TEST_SUITE_END()
