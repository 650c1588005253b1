// SPDX-License-Identifier: GPL-3.0-or-later
// Dynamic programming over links: equal subtrees are computed once, and the values are those of the
// sweep.
#include <map>
#include <string>
#include <vector>

#include <boost/test/unit_test.hpp>

#include "crosscheck/kernel/shared_subtrees.hpp"
#include "crosscheck/laws/gauss_value.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "recursive/build_model.hpp"
#include "scene/scene.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

using F = PrimeField;

recursive::Model<double> modelOf(const std::string& name) {
  const scene::Mechanism mechanism = scene::findScene(name).mechanism;
  return recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism));
}

}  // namespace

// By hand: a binary tree of 7 has subtrees of 7, 3, 3, 1, 1, 1, 1 links: 17 in all, of 3 sorts.
BOOST_AUTO_TEST_CASE(steps_are_those_counted_by_hand) {
  const RecursionSteps tree = recursionSteps(modelOf("mobile"));
  BOOST_TEST(tree.swept == 7);
  BOOST_TEST(tree.anew == 17);
  BOOST_TEST(tree.shared == 3);
  const RecursionSteps chain = recursionSteps(modelOf("planar_chain_5"));
  BOOST_TEST(chain.swept == 5);
  BOOST_TEST(chain.anew == 5 + 4 + 3 + 2 + 1);
  BOOST_TEST(chain.shared == 5);  // no two subtrees of a chain are equal: they differ in size
}

// What the three steps find is what the sweep finds in seven, where equal subtrees are in equal
// poses; and where they are not, it is not.
BOOST_AUTO_TEST_CASE(shared_values_are_those_of_the_sweep) {
  const scene::Mechanism mechanism = scene::findScene("mobile").mechanism;
  const SharedSubtrees subtrees = sharedSubtrees(modelOf("mobile"));
  BOOST_REQUIRE(subtrees.count() == 3);
  const F::Modulus modulus(drawPrime("mobile", 9, 0));
  const FieldSource source("mobile", 9, 0);
  const FieldNumbers number(mechanism, source);
  const auto model = recursive::buildModel(mechanism, number);
  auto state = indeterminateState(mechanism, source);
  for (const bool equal_poses : {true, false}) {
    std::map<std::pair<int, bool>, scene::JointPosition<F>>
        pose;  // one for each place in each node
    for (std::size_t i = 0; equal_poses && i < model.links.size(); ++i) {
      const auto& link = model.links[i];
      const int node = link.parent < 0 ? -1 : subtrees.of_link[link.parent];
      const bool right = link.X_tree.p.x() == number(scene::Number::parse("l/2"));
      state.x[link.slot] = pose.emplace(std::pair(node, right), state.x[link.slot]).first->second;
    }
    recursive::Workspace<F> ws(model);
    std::vector<F> qdd(model.dof(), F(0));
    recursive::forwardDynamics(model, state.x, state.qd, state.tau, ws, qdd);
    const auto M_A = articulatedInertias(model, subtrees, state.x);
    int different = 0;
    for (std::size_t i = 0; i < model.links.size(); ++i)
      different += M_A[subtrees.of_link[i]].matrix() != ws.M_A[i].matrix();
    BOOST_TEST((equal_poses ? different == 0 : different > 0));
    state = indeterminateState(mechanism, source);
  }
}

// The sweep's values are the minimum over all joints of the subtree at once.
BOOST_AUTO_TEST_CASE(articulated_inertia_is_the_least_gauss_function) {
  for (const char* name : {"mobile", "puma_560", "heavy_top", "satellite_arm", "lead_screw"}) {
    const scene::Mechanism mechanism = scene::findScene(name).mechanism;
    const F::Modulus modulus(drawPrime(name, 4, 0));
    const FieldSource source(name, 4, 0);
    const auto model = recursive::buildModel(mechanism, FieldNumbers(mechanism, source));
    const auto state = indeterminateState(mechanism, source);
    recursive::Workspace<F> ws(model);
    std::vector<F> qdd(model.dof(), F(0));
    recursive::forwardDynamics(model, state.x, state.qd, state.tau, ws, qdd);
    BOOST_TEST((sweptGauss(model, ws) == leastGauss(model, state.x, state.qd, state.tau, ws)),
               name);
    // other joint forces outboard: another minimum
    std::vector<F> other = state.tau;
    other.back() += F(1);
    if (model.links.size() > 1)
      BOOST_TEST((sweptGauss(model, ws) != leastGauss(model, state.x, state.qd, other, ws)), name);
  }
}
