// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes: thin, flat, far off, tiny and huge.
#include <algorithm>
#include <cmath>
#include <string>

#include "crosscheck/stability/family.hpp"
#include "crosscheck/stability/make_case.hpp"

namespace dynwitness::crosscheck::stability {
namespace {

Family farCentre() {
  Family f;
  f.name = "far_centre";
  f.title = "A free body, told in a frame far from its centre of mass";
  f.dial = "distance of the centre of mass over the radius of gyration";
  f.from = 1, f.to = 1e9;
  f.make = [](const std::string& s, int v) {
    constexpr const char* kMoment[kVariants] = {"0.97", "0.93", "1.07"};
    LinkWords body;
    body.joint = scene::JointKind::kFloating, body.mass = "1";
    body.com = {"0.36*" + s, "0.48*" + s, "0.8*" + s};
    body.moments = {kMoment[v], "1", "1.03"};
    return caseOf("far_centre", {body}, noGravity(), {0.1, -0.2, 0.3, 0.5, 0.1, -0.7, 0.5}, {},
                  {0.3, -0.2, 0.5, 0.1, 0.7, -0.4});
  };
  f.theories = {{Road::kAny,
                 "(I + m s^2) - m s^2 cancels m s^2 down to I: error u s^2, of some four roundings",
                 [](double s, const Arithmetic& a) { return rounded(4, a) * s * s; }},
                theoryOf({"kernel", "kernel_lanes"},
                         "the origin is moved to the centre of mass before anything is rounded, "
                         "since that makes the program smaller: nothing is lost",
                         nothingCancels)};
  f.mechanism =
      "About an origin that is far from the body, its inertia is I + m s^2, and what turns it is "
      "the part I alone: the linear rows take m s^2 away again.";
  f.survivor =
      "A method that refers every body to its own centre of mass. Sweeps in link frames, and every "
      "M in the rates of a far frame, lose two digits a decade.";
  return f;
}

Family thinRod() {
  Family f;
  f.name = "thin_rod";
  f.title = "A thin rod that turns about itself, inclined to its link's axes";
  f.dial = "moment of inertia across the rod over that along it";
  f.from = 1, f.to = 1e16;
  f.make = [](const std::string& s, int v) {
    struct Direction {
      const char *y, *z, *length, *yy, *zz, *yz;
    };
    // n n' of n = (0, y, z) / length, in exact quotients
    constexpr Direction kDirections[kVariants] = {
        {"3", "4", "5", "9/25", "16/25", "12/25"},
        {"5", "12", "13", "25/169", "144/169", "60/169"},
        {"8", "15", "17", "64/289", "225/289", "120/289"}};
    const Direction& n = kDirections[v];
    const std::string less = "(1/(" + s + ")-1)*";
    LinkWords rod;
    rod.axis = {"0", n.y, n.z}, rod.mass = "1";
    rod.moments = {"1", std::string("1+") + less + n.yy, std::string("1+") + less + n.zz};
    rod.products = {"0", "0", less + n.yz};
    return caseOf("thin_rod", {rod}, noGravity(), {0.4}, {}, {1});
  };
  f.theories = {
      {Road::kAny,
       "n' I n = I_yy n_y^2 + 2 I_yz n_y n_z + I_zz n_z^2, with I = 1 - (1 - 1/s) n n', "
       "cancels 1 down to 1/s: the roundings of the three stored entries alone leave u s "
       "(2 6^(1/2) n_y^2 n_z^2) / 3^(1/2), n = (0, 0.6, 0.8)",
       [](double s, const Arithmetic& a) {
         return rounded(1, a) * s * std::sqrt(6.0) * 0.36 * 0.64;
       }},
      theoryOf({"lagrange", "kernel", "kernel_lanes"},
               "n' I n is one number, found exactly before it is rounded: nothing is lost",
               nothingCancels),
      noTheoryOf({"recursive_lagrange", "simbody"},
                 "they turn the whole tensor into other axes, or into second moments of "
                 "mass, before n' I n is left of it, by roundings that were not counted")};
  f.mechanism =
      "The smallest moment of inertia is not an entry of the inertia matrix but a difference of "
      "entries. Stored in inclined axes, each rounded, the matrix has forgotten it when 1/s is of "
      "the size of the roundings.";
  f.survivor =
      "Whoever is given, or recovers, principal axes before rounding. After rounding nobody: the "
      "loss is in the data, and so in every engine that takes six numbers.";
  return f;
}

Family flatPlate() {
  Family f;
  f.name = "flat_plate";
  f.title = "A plate: inertia at the edge of the triangle inequality";
  f.dial = "moment of inertia over what is left of the inequality";
  f.from = 1, f.to = 1e18;
  f.make = [](const std::string& s, int v) {
    LinkWords carrier, plate;
    carrier.mass = "1", carrier.moments = {"0.2", "0.2", "0.2"};
    plate.parent = 1, plate.xyz = {"0.4", "0", "0.1"}, plate.axis = {"1", "2", "2"};
    plate.mass = "1", plate.com = {"0.1", "0.2", "0.05"};
    plate.moments = {kMoment[v], "0.4", std::string(kMoment[v]) + "+0.4-0.2/(" + s + ")"};
    return caseOf("flat_plate", {carrier, plate}, gravityDown(), {0.3, 0.7}, {0.5, -0.8}, {1, 0.5});
  };
  f.mechanism =
      "A body without thickness has xx + yy = zz. No equation of motion divides by what is left of "
      "that inequality; but who checks it on rounded numbers may find it broken by a rounding.";
  f.survivor = "All that decide what is possible on exact numbers, or do not decide.";
  return f;
}

/// An arm in space of two links with all lengths and radii of gyration times `scale`.
Case scaledArm(const std::string& family, const std::string& scale, int v) {
  const auto by = [&](const char* x) { return std::string(x) + scale; };
  const auto squared = [&](const char* x) { return std::string(x) + scale + scale; };
  LinkWords upper, lower;
  upper.axis = {"0", "1", "0"}, upper.mass = "1", upper.com = {by("0.3"), by("0.05"), "0"};
  upper.moments = {squared("0.02"), squared("0.05"), squared("0.05")};
  lower.parent = 1, lower.xyz = {by(kLength[v]), "0", by("0.1")}, lower.axis = {"1", "2", "2"};
  lower.mass = "1", lower.com = {by("0.2"), by("0.3"), "0"};
  lower.moments = upper.moments;
  return caseOf(family, {upper, lower}, gravityDown(), {0.3, 0.9}, {0, 0}, {});
}

Family tinyLengths() {
  Family f;
  f.name = "tiny_lengths";
  f.title = "A tiny arm";
  f.dial = "1 m over the length of the arm";
  f.from = 1, f.to = 1e165;
  f.make = [](const std::string& s, int v) { return scaledArm("tiny_lengths", "/" + s, v); };
  f.theories = {{Road::kMassMatrix,
                 "moments of inertia of 0.05 kg l^2 sink among the numbers that have fewer digits: "
                 "error (smallest / 2) / (0.05 l^2)",
                 [](double s, const Arithmetic& a) {
                   return std::max(a.unit, a.smallest * s / 2 * s / 0.05);
                 }},
                {Road::kSweep,
                 "1 / D of the last joint, D = 0.13 kg l^2, leaves the numbers of the arithmetic: "
                 "1 / l = sqrt(0.13 largest)",
                 [](double s, const Arithmetic& a) {
                   return s > std::sqrt(0.13) * std::sqrt(a.largest) ? 1 : a.unit;
                 }},
                theoryOf({"mujoco", "mujoco_principal"},
                         "MuJoCo takes a pivot below 1e-15 (its mjMINVAL) for that, and D of the "
                         "last joint is 0.13 kg l^2: 1 / l = sqrt(0.13 / 1e-15)",
                         [](double s, const Arithmetic& a) {
                           return s > std::sqrt(0.13 / 1e-15) ? 1 : a.unit;
                         })};
  f.mechanism =
      "qdd of an arm without drives is g / l times numbers of the order of 1: units cannot matter, "
      "and nothing cancels. Digits go when a square of a length underflows, or where somebody holds "
      "a length against a number of his own.";
  f.survivor =
      "All that have no smallest length, mass or inertia of their own. Lengths of 1e-9 m are far "
      "from where arithmetic breaks.";
  return f;
}

Family hugeLengths() {
  Family f = tinyLengths();
  f.name = "huge_lengths";
  f.title = "A huge arm";
  f.dial = "length of the arm";
  f.unit = "m";
  f.to = 5e154;  // its inertias are still numbers
  f.make = [](const std::string& s, int v) { return scaledArm("huge_lengths", "*" + s, v); };
  f.theories = {{Road::kAny, "kg l^2 leaves the numbers of the arithmetic: l = sqrt(largest)",
                 untilItsSquareOverflows}};
  f.mechanism =
      "The same arm the other way: nothing cancels, until a square of a length overflows. Who forms "
      "U U' before he divides by D has fourth powers there, and half of the range.";
  f.survivor = "All, as far as their numbers go; further who divides before he multiplies.";
  return f;
}

Family counterweight() {
  Family f;
  f.name = "counterweight";
  f.title = "A balanced lever";
  f.dial = "moment of one arm over what is left of their difference";
  f.from = 1, f.to = 1e16;
  f.quantity = Quantity::kTau;
  f.make = [](const std::string& s, int v) {
    LinkWords lever, weight;
    lever.mass = "1.1", lever.com = {kLength[v], "0", "0"}, lever.moments = {"0.1", "0.1", "0.1"};
    weight.parent = 1, weight.joint = scene::JointKind::kFixed,
    weight.mass = "1.1*" + std::string(kLength[v]);
    weight.com = {"-(1-1/(" + s + "))", "0", "0"}, weight.moments = {"0.1", "0.1", "0.1"};
    return caseOf("counterweight", {lever, weight}, gravitySideways(), {0.3}, {}, {});
  };
  f.theories = {{Road::kAny,
                 "m1 c1 - m2 c2 cancels down to 1/s of either: error u s, of four rounded figures "
                 "and two products",
                 [](double s, const Arithmetic& a) { return rounded(6, a) * s; }},
                theoryOf({"lagrange", "kernel", "kernel_lanes"},
                         "m1 c1 - m2 c2 is one number, found exactly before it is rounded: nothing "
                         "is lost",
                         nothingCancels)};
  f.mechanism =
      "The moment that holds the lever is the difference of two that nearly agree. What their "
      "figures lose in being rounded to the arithmetic is all that is left of it in the end.";
  f.survivor = "None: the loss is in the rounded figures. Exact decimals, as in balls, keep it.";
  return f;
}

}  // namespace

std::vector<Family> familiesOfShapes() {
  return {farCentre(), thinRod(), flatPlate(), tinyLengths(), hugeLengths(), counterweight()};
}

}  // namespace dynwitness::crosscheck::stability
