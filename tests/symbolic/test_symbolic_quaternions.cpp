// SPDX-License-Identifier: GPL-3.0-or-later
// The length of a quaternion says nothing: a power of two in it changes no bit of what is derived,
// also where its square is no number any more.
#include <cmath>
#include <string>
#include <vector>

#include <boost/test/unit_test.hpp>

#include "scene/scene.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

using namespace dynwitness;

BOOST_AUTO_TEST_CASE(a_power_of_two_in_a_quaternion_changes_no_bit) {
  const scene::Mechanism mechanism = scene::findScene("heavy_top").mechanism;
  symbolic::Equations equations = symbolic::derive(mechanism, symbolic::Options());
  const std::vector<symbolic::Node> tau = symbolic::inverseDynamics(equations);
  const symbolic::Program program = symbolic::compile(equations.graph, tau);
  symbolic::ProgramRun<double> run(program, scene::RealNumbers<double>(mechanism));
  const auto at = [&](int exponent) {
    scene::State<double> state;
    for (const double q : {0.5, 0.1, -0.7, 0.5})
      state.x.push_back(scene::jointPosition(std::ldexp(q, exponent)));
    state.qd = {0.3, -0.5, 0.4};
    state.qdd = {1, 0.5, -0.3};
    return run(state);
  };
  const std::vector<double> ordinary = at(0);
  BOOST_TEST(ordinary.size() == 3u);
  for (const int exponent : {-1010, -600, -20, 20, 600, 1020})
    BOOST_TEST(at(exponent) == ordinary, "2^" << exponent);
}
