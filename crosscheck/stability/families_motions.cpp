// SPDX-License-Identifier: GPL-3.0-or-later
// Motions: fast spin.
#include <cmath>
#include <string>

#include "crosscheck/stability/family.hpp"
#include "crosscheck/stability/make_case.hpp"

namespace dynwitness::crosscheck::stability {
namespace {

Family spinningBall() {
  Family f;
  f.name = "spinning_ball";
  f.title = "A ball that spins fast under a small torque";
  f.dial = "angular velocity";
  f.unit = "rad/s";
  f.from = 1, f.to = 1e10;
  f.make = [](const std::string& s, int v) {
    LinkWords ball;
    ball.joint = scene::JointKind::kSpherical, ball.mass = "1";
    ball.moments = {kMoment[v], kMoment[v], kMoment[v]};
    const double w = std::stod(s);
    return caseOf("spinning_ball", {ball}, noGravity(), {0.5, 0.1, -0.7, 0.5},
                  {0.4812357 * w, 0.6034191 * w, 0.6359173 * w}, {1, 0.5, -0.3});
  };
  f.theories = {
      {Road::kAny,
       "w x I w = 0 is found as I wy wz - I wz wy: error u I wy wz s^2 over the torque, of "
       "four roundings",
       [](double s, const Arithmetic& a) { return rounded(4, a) * 0.3 * 0.6 * 0.64 * s * s; }},
      theoryOf({"fast"},
               "I - I is formed before it is multiplied by w^2, and is 0: nothing is lost",
               nothingCancels),
      noTheoryOf(
          {"simbody"},
          "it turns I into the axes of the ground, where it is I but for roundings that were "
          "not counted")};
  f.mechanism =
      "A ball has no gyroscopic moment, whatever its spin; computed, w x (I w) is a difference of "
      "equal products, and its roundings grow as w^2 beside a torque that does not.";
  f.survivor =
      "Who forms (Izz - Iyy) wy wz, as equations derived for this ball do, gets exactly 0.";
  return f;
}

Family fastSpin() {
  Family f;
  f.name = "fast_spin";
  f.title = "A double pendulum at any speed";
  f.dial = "angular velocity";
  f.unit = "rad/s";
  f.from = 1, f.to = 1e160;
  f.make = [](const std::string& s, int v) {
    LinkWords upper, lower;
    upper.mass = "1", upper.com = {"0.3", "0", "0"}, upper.moments = {"0.01", "0.05", "0.05"};
    lower.parent = 1, lower.xyz = {kLength[v], "0", "0"}, lower.mass = "1";
    lower.com = {"0.4", "0.1", "0"}, lower.moments = {"0.01", "0.04", "0.04"};
    const double w = std::stod(s);
    return caseOf("fast_spin", {upper, lower}, gravitySideways(), {0.3, 0.9}, {w, -0.5 * w},
                  {1, 0.5});
  };
  f.theories = {{Road::kAny, "w^2 leaves the numbers of the arithmetic: w = sqrt(largest)",
                 untilItsSquareOverflows}};
  f.mechanism =
      "All of qdd grows as w^2, forces that do not are drowned without being missed, and nothing "
      "cancels: 1e6 rad/s is as harmless as 1.";
  f.survivor = "All, as far as their numbers go.";
  return f;
}

}  // namespace

std::vector<Family> familiesOfMotions() {
  return {spinningBall(), fastSpin()};
}

}  // namespace dynwitness::crosscheck::stability
