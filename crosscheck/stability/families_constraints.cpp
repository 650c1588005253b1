// SPDX-License-Identifier: GPL-3.0-or-later
// Constraints: nearly redundant, near singular poses, and such that nothing can hold.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "crosscheck/motion/closed_motion.hpp"
#include "crosscheck/stability/family.hpp"
#include "crosscheck/stability/make_case.hpp"

namespace dynwitness::crosscheck::stability {
namespace {

constexpr double kHalfPi = 1.5707963267948966;  // nearest to pi/2
constexpr const char* kCrankInertia[kVariants] = {"0.2", "0.23", "0.17"};

/// recursive::SemidefiniteSolver takes a pivot for 0 below cbrt(eps)^2 of the first. Of N_0 with
/// the pivots `first` and `second` / s^2.
Theory rankIsLost(double first, double second) {
  return {Road::kSweep,
          "the sweep decides how many equations there are: a pivot of N_0 below cbrt(eps)^2 times "
          "the first is none, from s = ((second times s^2) / first)^(1/2) / cbrt(eps) on",
          [first, second](double s, const Arithmetic& a) {
            const double least = std::cbrt(std::numeric_limits<double>::epsilon());
            return s * least > std::sqrt(second / first) ? 1 : a.unit;
          }};
}

scene::Attachment attachment(int link, const Words& xyz, const Words& rpy) {
  return {link, vectorOf(xyz), vectorOf(rpy)};
}

/// A plate that slides and turns in a plane, which two constraints hold across, 1/s apart.
/// @param told_apart  the second one says what the plate may turn, and not where a point may go
Case heldPlate(const std::string& family, const std::string& s, int v, bool told_apart) {
  LinkWords slide, lift, plate;
  slide.joint = lift.joint = scene::JointKind::kPrismatic;
  slide.axis = {"1", "0", "0"};
  lift.parent = 1, lift.axis = {"0", "1", "0"};
  plate.parent = 2, plate.mass = "1", plate.moments = {"0.2", "0.2", kMoment[v]};
  Case out = caseOf(family, {slide, lift, plate}, noGravity(), {0.1, 0.2, 0.4}, {0.1, -0.2, 0.3},
                    {1, 0.5, -0.3});
  scene::AccelerationConstraint held;
  held.link = 3, held.axes = scene::AccelerationConstraint::Axes::kLink;
  held.name = "first", held.at = vectorOf({"0.4", "0", "0"});
  held.direction = vectorOf({"0", "1", "0"}), held.rotation = vectorOf(noGravity());
  auto& constraints = out.scene.mechanism.acceleration_constraints;
  constraints.push_back(held);
  held.name = "second";
  if (told_apart) {
    held.direction = vectorOf(noGravity());
    held.rotation = vectorOf({"0", "0", "1/(" + s + ")"});
  } else {
    held.at = vectorOf({"0.4+1/(" + s + ")", "0", "0"});
  }
  constraints.push_back(held);
  scene::validate(out.scene);
  return out;
}

Family nearlyRedundant() {
  Family f;
  f.name = "nearly_redundant";
  f.title = "Two constraints that say nearly the same";
  f.dial = "1 m over the distance of the two points that are held";
  f.from = 1, f.to = 1e10;
  f.whole = MechanismQuantity::kNu;
  f.make = [](const std::string& s, int v) { return heldPlate("nearly_redundant", s, v, false); };
  constexpr double kI = 0.3, kN = 1 + 0.4 * 0.4 / kI;
  f.theories = {
      rankIsLost(kN, 1 / (kI * kN)),
      {Road::kMassMatrix,
       "N_0 = J M^-1 J' has the condition s^2: with N = 1/m + p^2/I in all its entries, its second "
       "pivot N - N N / N cancels down to 1 / (s^2 m I N): error u s^2 N^2 m I, of three roundings "
       "in each entry, the mixed one's twice, a product and a quotient: (3 + 4 3 + 3 + 2) / 3 under "
       "the root",
       [](double s, const Arithmetic& a) { return rounded(20, a) * s * s * kN * kN * kI; }}};
  f.mechanism =
      "Two points of one plate, 1/s apart, may not move across. Their rows of J differ by 1/s, the "
      "forces that hold them grow as s, and the matrix that gives these, N_0 = J M^-1 J', knows of "
      "the distance by its square alone: as does the KKT matrix when it is eliminated without "
      "pivots, since what is left of it after M is -N_0.";
  f.survivor =
      "None that is told two points. Who tells the difference instead, one point and the turn, has "
      "the same forces with all their digits (told_apart).";
  return f;
}

Family toldApart() {
  Family f = nearlyRedundant();
  f.name = "told_apart";
  f.title = "The same two constraints, told as one point and the turn";
  f.to = 1e150;
  f.make = [](const std::string& s, int v) { return heldPlate("told_apart", s, v, true); };
  f.theories = {f.theories.front(),
                {Road::kMassMatrix, "1/s^2 leaves the numbers of the arithmetic: s = sqrt(largest)",
                 untilItsSquareOverflows}};
  f.mechanism =
      "The second row of J is the difference of the two, 1/s about the turn, told and not computed. "
      "N_0 has the same condition, and all of it is in the scale of that row, which no elimination "
      "loses a digit by. But who asks how many equations there are compares that row with the "
      "other, which is a question of units.";
  f.survivor =
      "Elimination that does not ask: a large condition that comes of units alone costs nothing. "
      "The sweep counts one equation too few, and says so.";
  return f;
}

/// A parallelogram at the angle 1/s from flat, whose loop is closed in axes on the second crank.
/// @param tilt  of these axes from the crank [rad]
Case parallelogram(const std::string& family, const std::string& s, int v, const char* tilt) {
  LinkWords crank, coupler, second;
  crank.mass = "1", crank.moments = {"0.2", "0.2", kCrankInertia[v]};
  coupler.parent = 1, coupler.xyz = {"0.5", "0", "0"}, coupler.mass = "1";
  coupler.moments = {"0.3", "0.3", kMoment[v]};
  second.xyz = {"0.7", "0", "0"}, second.mass = "1", second.com = {"0.3", "0", "0"};
  second.moments = {"0.2", "0.2", "0.25"};
  const double angle = 1 / std::stod(s);
  Case out = caseOf(family, {crank, coupler, second}, gravitySideways(), {angle, -angle, angle},
                    {0.3, -0.3, 0.3}, {1, 0.5, -0.3});
  scene::Closure loop;
  loop.name = "loop", loop.kind = scene::ClosureKind::kPlanarPoint;
  loop.a = attachment(3, {"0.5", "0", "0"}, {"0", "0", tilt});
  loop.b = attachment(2, {"0.7", "0", "0"}, {"0", "0", "0"});
  out.scene.mechanism.closures.push_back(loop);
  scene::validate(out.scene);
  return out;
}

/// Of the four-bar below, first variant, about where its bars turn [kg m^2], and N_0's n and det.
constexpr double kA = 0.2 + 0.25, kB = 0.3, kC = 0.25 + 0.09;
constexpr double kCranks = 0.25 * (1 / kA + 1 / kC), kCoupler = 0.49 / kB;
constexpr double kAcross = kCranks + kCoupler, kDeterminant = kCranks * kCoupler;

Family deadPoint() {
  Family f;
  f.name = "dead_point";
  f.title = "A four-bar near the pose where it is flat";
  f.dial = "1 rad over the angle that is left";
  f.from = 2, f.to = 1e10;
  f.whole = MechanismQuantity::kQdd;
  f.make = [](const std::string& s, int v) { return parallelogram("dead_point", s, v, "0.6"); };
  const double first = kAcross * std::cos(0.6) * std::cos(0.6);
  f.theories = {
      rankIsLost(first, kDeterminant / first),
      {Road::kMassMatrix,
       "along the flat pose J sees 1/s, across it 1. In axes turned by a = 0.6 rad both rows of J "
       "are nearly the same, N_0 = n t t' + O(1/s), t = (-sin a, cos a), and its second pivot "
       "cancels n cos^2 a down to det / (s^2 n sin^2 a): error u s^2 (n sin a cos a)^2 / det, with "
       "A, B, C the moments of inertia of crank, coupler and second crank about where they turn, n "
       "= l^2 (1/A + 1/C) + L^2 / B, det = l^2 (1/A + 1/C) L^2 / B, of the roundings that "
       "nearly_redundant counts; of qdd this equation makes a share of 0.14",
       [](double s, const Arithmetic& a) {
         // |qdd - qdd without the equation| / |qdd|, from N_0 written out as above, at 1/s = 1e-4
         constexpr double kShare = 0.138;
         const double mixed = kAcross * std::sin(1.2) / 2;
         return rounded(20, a) * s * s * mixed * mixed / kDeterminant * kShare;
       }}};
  f.mechanism =
      "When both cranks lie in the line of the ground, the loop no longer says that they turn "
      "alike: the second crank may go on or back. Close to it, that equation is 1/s beside "
      "another one of size 1; where the axes of the closure mix the two, it is the difference of "
      "rows that nearly agree, and N_0 has it squared.";
  f.survivor =
      "Whoever is told the closure in axes along the crank (dead_point_along), where the small row "
      "stands by itself.";
  return f;
}

Family deadPointAlong() {
  Family f = deadPoint();
  f.name = "dead_point_along";
  f.title = "The same four-bar, its loop closed in axes along the crank";
  f.make = [](const std::string& s, int v) { return parallelogram("dead_point_along", s, v, "0"); };
  f.theories = {
      rankIsLost(kAcross, kDeterminant / kAcross),
      {Road::kMassMatrix,
       "the angle of the coupler against the crank, 1/s, is found from sums of products of size 1 "
       "at the worst: error u s, of some two roundings",
       [](double s, const Arithmetic& a) { return rounded(2, a) * s; }}};
  f.mechanism =
      "The row along the crank is 1/s as a whole, and none of its digits stands behind those of "
      "the other row: N_0 is graded. Who counts equations by comparing pivots still takes the small "
      "row for none.";
  f.survivor = "Elimination that does not count. The sweep counts, and says so.";
  return f;
}

Family drivenCrank() {
  Family f;
  f.name = "driven_crank";
  f.title = "A driven crank whose rod stands across the way of its slider";
  f.dial = "1 rad over the angle that is left";
  f.from = 2, f.to = 1e14;
  f.whole = MechanismQuantity::kDrive;
  f.make = [](const std::string& s, int v) {
    LinkWords crank, rod;
    crank.axis = rod.axis = {"0", "1", "0"};
    crank.mass = "1", crank.com = {"0.2", "0", "0"}, crank.moments = {"0.1", "0.1", "0.1"};
    rod.parent = 1, rod.xyz = {kLength[v], "0", "0"}, rod.mass = "1", rod.com = {"0.2", "0", "0"};
    rod.moments = {"0.2", kMoment[v], "0.2"};
    constexpr double kTurns[kVariants] = {0.6, 0.66, 0.54};
    const double q = kTurns[v];
    Case out = caseOf("driven_crank", {crank, rod}, gravityDown(),
                      {q, kHalfPi - q - 1 / std::stod(s)}, {1, -0.7}, {0, 0.5});
    out.scene.mechanism.links[1].joint.motion = {scene::Expression::parseOfTime("t")};
    out.state.qdd[0] = 0.8;
    scene::Closure way;
    way.name = "way", way.kind = scene::ClosureKind::kPlane;
    way.a = attachment(0, {"0", "0", "-0.9"}, {"0", "0", "0"});
    way.b = attachment(2, {"0.5", "0", "0"}, {"0", "0", "0"});
    out.scene.mechanism.closures.push_back(way);
    scene::validate(out.scene);
    return out;
  };
  f.theories = {
      {Road::kAny,
       "what the rod's turn does to the slider is l cos(q1 + q2) = l (c1 c2 - s1 s2), which cancels "
       "0.47 down to 1/s, and the drive's force has its square: error 2 0.47 u s, of three "
       "roundings in each product",
       [](double s, const Arithmetic& a) {
         return rounded(6, a) * 2 * s * std::cos(0.6) * std::sin(0.6);
       }},
      noTheoryOf({"mujoco"},
                 "its rows are those of a point in space, found by way of the places of links, by "
                 "roundings that were not counted")};
  f.mechanism =
      "The crank is driven, and the rod has to follow: where it stands across the slider's way, no "
      "turn of it moves the slider along, and the drive would need an infinite force. Nothing is "
      "squared on the way there, as one number is left of J; it is a difference of products.";
  f.survivor =
      "None: the angle q1 + q2 is told as two angles. Near such a pose it is the drive that should "
      "be asked elsewhere.";
  return f;
}

Family contradiction() {
  Family f;
  f.name = "contradiction";
  f.title = "A four-bar whose longest bar is too long";
  f.dial = "longest bar over the sum of the others";
  f.from = 0.55, f.to = 2;
  f.narrow = 1.0005;
  f.measured = "closing a loop: the gap that is left over the longest bar";
  const auto gap = [](double s) {
    constexpr double kOthers = 0.5 + 0.4 + 0.7;
    LinkWords crank, coupler, second;
    crank.mass = coupler.mass = second.mass = "1";
    crank.moments = coupler.moments = second.moments = {"0.1", "0.1", "0.1"};
    coupler.parent = 1, coupler.xyz = {"0.5", "0", "0"};
    second.xyz = {"0.7", "0", "0"};
    const std::string length = fmt::format("{:.17g}", s * kOthers);
    // cranks at equal angles from the line of the ground, their ends as far apart as the bar is
    const double angle = std::acos(std::clamp((s * kOthers - 0.7) / 0.9, -0.98, 0.98));
    const double along = std::atan2(-0.1 * std::sin(angle), 0.7 + 0.9 * std::cos(angle));
    Case given = caseOf("contradiction", {crank, coupler, second}, gravitySideways(),
                        {2 * kHalfPi - angle, along - 2 * kHalfPi + angle, angle}, {}, {});
    scene::Closure loop;
    loop.name = "loop", loop.kind = scene::ClosureKind::kPlanarPoint;
    loop.a = attachment(3, {"0.4", "0", "0"}, {"0", "0", "0"});
    loop.b = attachment(2, {length, "0", "0"}, {"0", "0", "0"});
    given.scene.mechanism.closures.push_back(loop);
    for (std::size_t i = 0; i < given.state.x.size(); ++i)
      given.scene.start_q[i] = number(fmt::format("{:.17g}", given.state.x[i].q));
    scene::validate(given.scene);
    ClosedMotion motion(given.scene, 0);
    ClosedMotion::State y = motion.start(given.scene);
    motion.choose(y, 0);
    motion.project(&y, 0);
    motion.equations(y, 0);
    return motion.phi() / (s * kOthers);
  };
  f.measures = {{"projection",
                 "what is too long stays open: no less than 1 - 1/s of the bar, from s = 1 on",
                 [](double s) { return std::max(inDouble().unit, 1 - 1 / s); }, gap}};
  f.mechanism =
      "Four bars close as long as none is longer than the others together. Beyond that the closure "
      "contradicts itself, and Newton's method ends where the gap is smallest: a number like any "
      "other, if nobody looks at the gap.";
  f.survivor =
      "Nobody closes it; who measures the gap says so, as `simulate` does, which refuses such a "
      "start and names the gap that is left.";
  return f;
}

}  // namespace

std::vector<Family> familiesOfConstraints() {
  return {nearlyRedundant(), toldApart(),   deadPoint(),
          deadPointAlong(),  drivenCrank(), contradiction()};
}

}  // namespace dynwitness::crosscheck::stability
