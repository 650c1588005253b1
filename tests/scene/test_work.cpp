// SPDX-License-Identifier: GPL-3.0-or-later
// Progress of long work, and what a crosscheck of a large scene leaves out.
#include <boost/test/unit_test.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include "crosscheck/conductor/plan.hpp"
#include "crosscheck/witnesses/lagrange.hpp"
#include "scene/families.hpp"
#include "scene/work.hpp"
#include "symbolic/equations.hpp"

using namespace dynwitness;
using scene::seenWork;
using scene::Work;

BOOST_AUTO_TEST_CASE(parts_of_parts_add_up) {
  BOOST_TEST(seenWork().what == "");
  Work whole("whole", 4);
  whole.done();
  BOOST_TEST(seenWork().fraction == 0.25);
  {
    Work part("part", 2);  // within one unit of the whole
    part.done();
    BOOST_TEST(seenWork().fraction == 0.375);
    BOOST_TEST(seenWork().what == "part");
  }
  BOOST_TEST(seenWork().fraction == 0.25);  // which counts that unit itself
  {
    Work part("two units", 10, 2);
    part.doneTo(0.5);
    BOOST_TEST(seenWork().fraction == 0.5);
    const Work unknown("of unknown length", 0);
    BOOST_TEST(seenWork().fraction == 0.5);
  }
  BOOST_TEST(seenWork().fraction == 0.75);
}

BOOST_AUTO_TEST_CASE(what_copies_of_the_process_do_is_seen) {
  const Work whole("", 2);
  int told[2], ends[2];
  BOOST_REQUIRE(pipe(told) == 0);
  BOOST_REQUIRE(pipe(ends) == 0);
  const pid_t copy = fork();
  char letter = 'x';
  if (copy == 0) {
    Work part("in the copy", 4);
    part.done(2);
    if (write(told[1], &letter, 1) != 1 || read(ends[0], &letter, 1) != 1) _exit(1);
    _exit(0);
  }
  BOOST_REQUIRE(read(told[0], &letter, 1) == 1);
  BOOST_TEST(seenWork().fraction == 0.25);  // half of one unit of two
  BOOST_TEST(seenWork().what == "in the copy");
  BOOST_REQUIRE(write(ends[1], &letter, 1) == 1);
  int status = 0;
  waitpid(copy, &status, 0);
  BOOST_TEST(status == 0);
}

BOOST_AUTO_TEST_CASE(a_crosscheck_of_a_large_scene_says_what_it_leaves_out) {
  using crosscheck::planFor;
  crosscheck::Options options;
  const auto plan = [&](int links) { return planFor(scene::chainOf(links), options); };
  BOOST_TEST(plan(64).told.empty());
  BOOST_TEST(plan(64).states == 100);
  BOOST_TEST(plan(128).states == 25);  // twice the joints, four times the cost
  BOOST_TEST(plan(128).whole);
  BOOST_TEST(plan(128).told.size() == 1u);
  BOOST_TEST(!plan(129).whole);
  BOOST_TEST(plan(1000).states == 2);
  BOOST_TEST(plan(1000).told.size() == 2u);
  BOOST_CHECK_THROW(plan(1001), scene::InputError);
  // reactions of fixed links cost the square of their number as well
  scene::Scene fixed = scene::chainOf(1000);
  for (std::size_t i = 2; i < fixed.mechanism.links.size(); ++i)
    fixed.mechanism.links[i].joint.kind = scene::JointKind::kFixed;
  BOOST_TEST(planFor(fixed, options).states == 2);
  BOOST_TEST(planFor(fixed, options).whole);
  BOOST_TEST(expectedSeconds(fixed, planFor(fixed, options)) > 10);
  options.states = 7;
  BOOST_TEST(plan(1000).states == 7);  // as asked
}

BOOST_AUTO_TEST_CASE(only_what_is_asked_is_derived) {
  const auto nodes = [](int n) {
    return symbolic::deriveForces(scene::chainOf(n).mechanism).graph.size();
  };
  const auto nodes_with_M = [](int n) {
    return symbolic::derive(scene::chainOf(n).mechanism).graph.size();
  };
  // M takes four times as many of twice the joints; c and g measured 2.03 times (13385 and 27213
  // nodes)
  BOOST_TEST(nodes(80) < 2.1 * nodes(40));
  BOOST_TEST(nodes_with_M(80) - nodes(80) > 3.5 * (nodes_with_M(40) - nodes(40)));

  // M added later is M derived at once
  const scene::Mechanism mechanism = scene::chainOf(5).mechanism;
  symbolic::Equations later = symbolic::deriveForces(mechanism);
  BOOST_TEST(later.M.empty());
  symbolic::addMassMatrix(mechanism, {}, later);
  const symbolic::Equations at_once = symbolic::derive(mechanism);
  BOOST_TEST(later.graph.size() < at_once.graph.size());  // which has V link by link as well
  BOOST_TEST((later.M == at_once.M));
}

BOOST_AUTO_TEST_CASE(a_mass_matrix_that_fills_memory_is_refused_before_it_is_derived) {
  BOOST_CHECK_EXCEPTION(symbolic::derive(scene::chainOf(1000).mechanism), scene::InputError,
                        [](const scene::InputError& error) {
                          return std::string(error.what()).find("500500 entries") !=
                                 std::string::npos;
                        });
  // a tree of as many has few pairs of joints that share a body
  crosscheck::DerivedPrograms tree(scene::treeOf(300).mechanism, true);
  BOOST_TEST(tree[crosscheck::Quantity::kM].outputs.size() == 90000u);
}

BOOST_AUTO_TEST_CASE(fixed_links_cost_no_derivation) {
  // a hinge and 300 links in a row fixed to it: the same number of nodes as with none, but for
  // their numbers
  const auto rowOf = [](int fixed) {
    scene::Scene scene = scene::chainOf(1);
    for (int k = 0; k < fixed; ++k) {
      scene::Link link = scene.mechanism.links.back();
      link.name = "fixed" + std::to_string(k);
      link.joint.name = link.name;
      link.joint.kind = scene::JointKind::kFixed;
      link.parent = static_cast<int>(scene.mechanism.links.size()) - 1;
      link.joint.placement.xyz[0] = scene::Number::parse("0.1");
      scene.mechanism.links.push_back(link);
    }
    return scene.mechanism;
  };
  const auto operations = [&](int fixed) {
    symbolic::Options options;
    options.fold_parameters = true;
    symbolic::Equations e = symbolic::derive(rowOf(fixed), options);
    return symbolic::compile(e.graph, symbolic::inverseDynamics(e)).body.size();
  };
  BOOST_TEST(operations(300) == operations(1));
}
