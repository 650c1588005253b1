// SPDX-License-Identifier: GPL-3.0-or-later
// Quaternions whose square is no normal number are scaled, others keep every bit.
#include "scene/state.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include <boost/test/unit_test.hpp>

using namespace dynwitness::scene;

namespace {

template <typename T>
std::array<T, 4> at(T length) {
  const std::array<T, 4> q = {T(0.5) * length, T(0.1) * length, T(-0.7) * length, T(0.5) * length};
  std::vector<JointPosition<T>> x;
  for (const T component : q) x.push_back({component, T(0), T(0)});
  return quaternionAt(x.data());
}

/// What is left of q after scaling by any power of two.
template <typename T>
bool isPowerOfTwoTimes(const std::array<T, 4>& q, T length) {
  int exponent = 0;
  const T original[4] = {T(0.5) * length, T(0.1) * length, T(-0.7) * length, T(0.5) * length};
  const T ratio = q[2] / original[2];
  if (std::frexp(ratio, &exponent) != T(0.5)) return false;
  for (int k = 0; k < 4; ++k)
    if (q[k] != std::ldexp(original[k], exponent - 1)) return false;
  return true;
}

/// A scalar without an order, as elements of a field are.
struct Element {
  int value;
};

}  // namespace

BOOST_AUTO_TEST_CASE(ordinary_quaternions_keep_every_bit) {
  for (const double length : {1.0, 0.3, 1e-150, 1e150}) {
    const std::array<double, 4> q = at(length);
    const double same[4] = {0.5 * length, 0.1 * length, -0.7 * length, 0.5 * length};
    BOOST_TEST(std::memcmp(q.data(), same, sizeof same) == 0, length);
  }
}

BOOST_AUTO_TEST_CASE(others_are_scaled_by_a_power_of_two_to_a_square_that_is_normal) {
  for (const double length : {1e155, 1e300, 1e-155, 1e-300}) {
    const std::array<double, 4> q = at(length);
    BOOST_TEST(std::abs(q[2]) >= 0.5);
    BOOST_TEST(std::abs(q[2]) < 1);
    BOOST_TEST(isPowerOfTwoTimes(q, length), length);
  }
  for (const float length : {1e20F, 1e38F, 1e-20F, 1e-35F})
    BOOST_TEST(isPowerOfTwoTimes(at(length), length), length);
}

BOOST_AUTO_TEST_CASE(the_smallest_numbers_are_large_enough_afterwards_and_zero_stays) {
  const double least = std::numeric_limits<double>::denorm_min();
  std::vector<JointPosition<double>> x(4, {least, 0, 0});
  for (const double component : quaternionAt(x.data()))
    BOOST_TEST(std::isnormal(component * component));
  x.assign(4, {0, 0, 0});
  for (const double component : quaternionAt(x.data())) BOOST_TEST(component == 0);
}

BOOST_AUTO_TEST_CASE(scalars_without_a_largest_number_are_left_alone) {
  const std::vector<JointPosition<Element>> x = {
      {{1}, {0}, {0}}, {{2}, {0}, {0}}, {{3}, {0}, {0}}, {{4}, {0}, {0}}};
  const std::array<Element, 4> q = quaternionAt(x.data());
  for (int k = 0; k < 4; ++k) BOOST_TEST(q[k].value == k + 1);
}
