// SPDX-License-Identifier: GPL-3.0-or-later
// The length of a quaternion says nothing: a power of two in it changes no bit of what sweeps say,
// also where its square is no number any more.
#include <cmath>
#include <vector>

#include <boost/test/unit_test.hpp>

#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/fast/dynamics.hpp"
#include "scene/scene.hpp"

using namespace dynwitness;
using namespace dynwitness::recursive;

namespace {

template <typename T>
std::vector<T> qddAt(const scene::Mechanism& mechanism, int exponent) {
  const auto model = buildModel(mechanism, scene::RealNumbers<T>(mechanism));
  Workspace<T> ws(model);
  std::vector<scene::JointPosition<T>> x;
  for (const T q : {T(0.5), T(0.1), T(-0.7), T(0.5)})
    x.push_back(scene::jointPosition(std::ldexp(q, exponent)));
  std::vector<T> qdd(3);
  forwardDynamics(model, x, {T(0.3), T(-0.5), T(0.4)}, {T(1), T(0.5), T(-0.3)}, ws, qdd);
  return qdd;
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_power_of_two_in_a_quaternion_changes_no_bit) {
  const scene::Mechanism top = scene::findScene("heavy_top").mechanism;
  const std::vector<double> in_double = qddAt<double>(top, 0);
  const std::vector<float> in_float = qddAt<float>(top, 0);
  for (const int exponent : {-1010, -600, -20, 20, 600, 1020})
    BOOST_TEST(qddAt<double>(top, exponent) == in_double, "2^" << exponent);
  for (const int exponent : {-120, -80, 80, 126})
    BOOST_TEST(qddAt<float>(top, exponent) == in_float, "2^" << exponent << " in float");
}

BOOST_AUTO_TEST_CASE(nor_of_what_the_fast_sweeps_say) {
  const scene::Mechanism top = scene::findScene("heavy_top").mechanism;
  const auto model = buildModel(top, scene::RealNumbers<double>(top));
  fast::Dynamics dynamics(model);
  const std::vector<double> qd = {0.3, -0.5, 0.4}, tau = {1, 0.5, -0.3};
  const auto at = [&](int exponent) {
    std::vector<double> q, qdd(3);
    for (const double component : {0.5, 0.1, -0.7, 0.5})
      q.push_back(std::ldexp(component, exponent));
    dynamics.forwardDynamics(q.data(), qd.data(), tau.data(), qdd.data());
    return qdd;
  };
  const std::vector<double> ordinary = at(0);
  for (const int exponent : {-1010, -600, 600, 1020})
    BOOST_TEST(at(exponent) == ordinary, "2^" << exponent);
}
