// SPDX-License-Identifier: GPL-3.0-or-later
// Poses: singular angles, quaternions of any length, axes that meet, many turns.
#include <algorithm>
#include <cmath>
#include <string>

#include "crosscheck/stability/family.hpp"
#include "crosscheck/stability/make_case.hpp"

namespace dynwitness::crosscheck::stability {
namespace {

constexpr double kHalfPi = 1.5707963267948966;  // nearest to pi/2

Family gimbal() {
  Family f;
  f.name = "gimbal";
  f.title = "A ball joint as three revolutes, near gimbal lock";
  f.dial = "1 rad over the distance from gimbal lock";
  f.from = 1, f.to = 1e10;
  f.make = [](const std::string& s, int v) {
    LinkWords yaw, pitch, body;
    pitch.parent = 1, pitch.axis = {"0", "1", "0"};
    body.parent = 2, body.axis = {"1", "0", "0"}, body.mass = "1";
    body.moments = {kMoment[v], kMoment[v], kMoment[v]};
    return caseOf("gimbal", {yaw, pitch, body}, noGravity(), {0.3, kHalfPi - 1 / std::stod(s), 0.4},
                  {}, {1, 0.5, -0.3});
  };
  f.theories = {
      {Road::kMassMatrix,
       "M00 - M02^2 / M22 = I (1 - sin^2 q2) cancels down to I / s^2: error u s^2, of some "
       "three roundings",
       [](double s, const Arithmetic& a) { return rounded(3, a) * s * s; }},
      {Road::kSweep,
       "D = I cos^2 q2 is a product: nothing is lost but in an angle that is rounded to the "
       "arithmetic, which moves the pose by u: error 2 u s",
       [](double s, const Arithmetic& a) {
         return a.rounds_state ? 2 * rounded(1, a) * s : a.unit;
       }},
      theoryOf({"simbody"},
               "in the axes of the ground what is left about the third axis is no 0 but a rounding "
               "of I, beside I cos^2 q2 = I / s^2: error u s^2, of some three roundings",
               [](double s, const Arithmetic& a) { return rounded(3, a) * s * s; })};
  f.mechanism =
      "Where the first and the third axis meet, three angles can turn the body about two axes "
      "only: M is singular there, though the body is not (Lagrange's coordinates are only local). "
      "M knows of the distance 1/s to that pose by 1 - sin^2 q2 alone.";
  f.survivor =
      "Sweeps: the inertia that is left when the body's own joint is free is exactly 0 about its "
      "axis, and the turn by q2 multiplies by cos q2, which has all its digits. And a quaternion "
      "(ball_joint), which has no such pose.";
  return f;
}

Family ballJoint() {
  Family f = gimbal();
  f.name = "ball_joint";
  f.title = "The same body at the same poses on a spherical joint";
  f.make = [](const std::string& s, int v) {
    LinkWords body;
    body.joint = scene::JointKind::kSpherical, body.mass = "1";
    body.moments = {kMoment[v], kMoment[v], kMoment[v]};
    // Rz(q1) Ry(q2) Rx(q3) by half angles
    const double a = 0.15, b = (kHalfPi - 1 / std::stod(s)) / 2, c = 0.2;
    using std::cos, std::sin;
    return caseOf("ball_joint", {body}, noGravity(),
                  {cos(a) * cos(b) * cos(c) + sin(a) * sin(b) * sin(c),
                   cos(a) * cos(b) * sin(c) - sin(a) * sin(b) * cos(c),
                   cos(a) * sin(b) * cos(c) + sin(a) * cos(b) * sin(c),
                   sin(a) * cos(b) * cos(c) - cos(a) * sin(b) * sin(c)},
                  {}, {1, 0.5, -0.3});
  };
  f.theories = {};
  f.mechanism = "No pose is different from another: M is I in every one of them.";
  f.survivor = "All.";
  return f;
}

Case quaternionCase(const std::string& family, double length, int v) {
  // of length 1, with other components: each rounds by its own luck where they are few units
  constexpr double kTurns[kVariants][4] = {
      {0.5, 0.1, -0.7, 0.5}, {0.3, 0.1, -0.3, 0.9}, {0.8, 0.4, -0.2, 0.4}};
  const double* const turn = kTurns[v];
  LinkWords body;
  body.joint = scene::JointKind::kSpherical, body.mass = "1", body.com = {"0.1", "0.2", "-0.5"};
  body.moments = {kMoment[v], "0.4", "0.5"};
  return caseOf(family, {body}, gravityDown(),
                {turn[0] * length, turn[1] * length, turn[2] * length, turn[3] * length},
                {0.3, -0.5, 0.4}, {1, 0.5, -0.3});
}

Family longQuaternion() {
  Family f;
  f.name = "long_quaternion";
  f.title = "Quaternions that are too long";
  f.dial = "length of the quaternion";
  f.from = 1, f.to = 1e300;
  f.make = [](const std::string& s, int v) {
    return quaternionCase("long_quaternion", std::stod(s), v);
  };
  f.theories = {
      {Road::kAny,
       "a length that is scaled before it is squared cancels exactly, until a component "
       "leaves the numbers of the arithmetic",
       [](double s, const Arithmetic& a) { return s > a.largest ? 1 : a.unit; }},
      theoryOf({"kernel", "kernel_lanes", "simbody"},
               "they square the length as it is: sqrt(largest)", untilItsSquareOverflows)};
  f.mechanism =
      "R = 1 + 2 (w [v]x + [v]x^2) / (q'q) is a rotation for every q but 0: its length cancels "
      "exactly, and only the square of it can leave the numbers of the arithmetic. Where it does, "
      "ours scale q by a power of two, which rounds nothing.";
  f.survivor =
      "Who divides by the largest component, or by a power of two, first. Who squares the length as "
      "it is breaks at the root of the largest number; who takes a quaternion for one of length 1 "
      "without looking has a wrong rotation at once.";
  return f;
}

Family shortQuaternion() {
  Family f = longQuaternion();
  f.name = "short_quaternion";
  f.title = "Quaternions that are too short";
  f.dial = "1 over the length of the quaternion";
  f.make = [](const std::string& s, int v) {
    return quaternionCase("short_quaternion", 1 / std::stod(s), v);
  };
  f.theories = {
      {Road::kAny,
       "a length that is scaled before it is squared cancels exactly; what is told in "
       "double and rounded to the arithmetic misses a multiple of its smallest number in "
       "each component, and the pose twice that over the length: error s smallest",
       [](double s, const Arithmetic& a) {
         return a.rounds_state ? std::max(a.unit, s * a.smallest) : a.unit;
       }},
      theoryOf({"kernel", "kernel_lanes"},
               "they divide by the square of the length as it is: sqrt(largest)",
               untilItsSquareOverflows),
      theoryOf({"simbody"}, "it takes a quaternion shorter than 2^-52 for none (its Quaternion.h)",
               [](double s, const Arithmetic& a) { return s > std::ldexp(1.0, 52) ? 1 : a.unit; })};
  return f;
}

Family nearAxes() {
  Family f;
  f.name = "near_axes";
  f.title = "Two parallel axes that nearly meet, nothing between them";
  f.dial = "1 m over the distance of the axes";
  f.from = 1, f.to = 1e10;
  f.make = [](const std::string& s, int v) {
    constexpr const char* kAcross[kVariants] = {"0.4", "0.43", "0.37"};
    LinkWords between, body;
    body.parent = 1, body.xyz = {"1/(" + s + ")", "0", "0"}, body.mass = "1";
    body.com = {"0.3", kAcross[v], "0"}, body.moments = {"0.1", "0.1", "0.1"};
    return caseOf("near_axes", {between, body}, gravitySideways(), {0.3, 0}, {0.2, -0.4}, {1, 0.5});
  };
  // about the second axis the body has J = 0.1 + 0.25, and across the distance its articulated mass
  // is 1 - 0.09 / J
  f.theories = {
      {Road::kAny,
       "J - J cancels the body's moment of inertia J down to its articulated mass times "
       "1/s^2: error u s^2 J / (m - (m c)^2 / J), of some four roundings",
       [](double s, const Arithmetic& a) {
         constexpr double kJ = 0.35;
         return rounded(4, a) * s * s * kJ / (1 - 0.09 / kJ);
       }},
      theoryOf({"fast"},
               "J - J (J / J) is exactly 0, and m / s^2 is added to that: nothing is lost",
               nothingCancels),
      noTheoryOf({"articulated_body float"},
                 "1 / J times J happens to be 1 in float for all three of these bodies, "
                 "and J - J exactly 0")};
  f.mechanism =
      "Turned about either axis the body moves almost alike. M has two rows that differ by 1/s, "
      "and its determinant by 1/s^2.";
  f.survivor =
      "A sweep whose articulated inertia about the second axis is exactly 0 moves it to the first "
      "by adding m / s^2, and loses nothing.";
  return f;
}

Family manyTurns() {
  Family f;
  f.name = "many_turns";
  f.title = "A joint that has turned many times";
  f.dial = "angle";
  f.unit = "rad";
  f.from = 1, f.to = 1e18;
  f.make = [](const std::string& s, int v) {
    LinkWords upper, lower;
    upper.mass = "1", upper.com = {"0.3", "0", "0"}, upper.moments = {"0.01", "0.05", "0.05"};
    lower.parent = 1, lower.xyz = {"0.7", "0", "0"}, lower.mass = "1";
    lower.com = {"0.4", "0.1", "0"}, lower.moments = {"0.01", kMoment[v], kMoment[v]};
    const double angle = std::stod(s) * (1.0471975511965976 + 0.37 * v);  // of many digits
    return caseOf("many_turns", {upper, lower}, gravitySideways(), {angle, -angle / 3}, {0.2, -0.5},
                  {1, 0.5});
  };
  f.theories = {
      {Road::kAny,
       "an angle told in double and rounded to the arithmetic is off by u s; in double "
       "nothing is rounded, and sines and cosines reduce exactly",
       [](double s, const Arithmetic& a) { return a.rounds_state ? rounded(2, a) * s : a.unit; }}};
  f.mechanism =
      "cos q of a large q is as well defined as of a small one: q is the number that it is. What "
      "is lost is lost where q is rounded, or reduced by a pi of too few digits.";
  f.survivor = "Who reduces with enough digits of pi, as the C library does.";
  return f;
}

}  // namespace

std::vector<Family> familiesOfPoses() {
  return {gimbal(), ballJoint(), longQuaternion(), shortQuaternion(), nearAxes(), manyTurns()};
}

}  // namespace dynwitness::crosscheck::stability
