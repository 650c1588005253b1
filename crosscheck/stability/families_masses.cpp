// SPDX-License-Identifier: GPL-3.0-or-later
// Masses: light beside heavy, long rows, rotors.
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "crosscheck/stability/family.hpp"
#include "crosscheck/stability/make_case.hpp"
#include "scene/families.hpp"

namespace dynwitness::crosscheck::stability {
namespace {

constexpr const char* kLever[kVariants] = {"0.5", "0.47", "0.57"};

/// Eight links in space, axes in turn across each other; the mass of link k is that of the first
/// times ratio^(k/7).
Case spatialChain(const std::string& family, double ratio, int variant) {
  constexpr int kLinks = 8;
  std::vector<LinkWords> links;
  std::vector<double> q, qd, tau;
  for (int k = 0; k < kLinks; ++k) {
    LinkWords link;
    link.parent = k;
    if (k > 0) link.xyz = {kLength[variant], "0.05", "0"};
    link.axis = k % 2 == 0 ? Words{"0", "0", "1"} : Words{"0", "1", "0"};
    link.mass = decimalOf(std::pow(ratio, k / (kLinks - 1.0)), false);
    link.com = {"0.3", "0.02", "-0.03"};
    const std::string inertia = "*" + link.mass;
    link.moments = {"0.02" + inertia, "0.05" + inertia, "0.06" + inertia};
    links.push_back(link);
    q.push_back(0.4 + 0.3 * k);
    qd.push_back(k % 2 == 0 ? 0.7 : -0.4);
    tau.push_back((1 + 0.2 * k) * std::min(1.0, std::pow(ratio, k / (kLinks - 1.0))));
  }
  return caseOf(family, links, gravityDown(), q, qd, tau);
}

Family heavyTip() {
  Family f;
  f.name = "heavy_tip";
  f.title = "A heavy, compact body at the end of a light, straight arm";
  f.dial = "mass of the tip over that of the arm";
  f.from = 1, f.to = 1e16;
  f.make = [](const std::string& s, int v) {
    LinkWords arm, tip;
    arm.mass = "1", arm.com = {"0.35", "0", "0"}, arm.moments = {"0.01", "0.05", "0.05"};
    tip.parent = 1, tip.xyz = {kLength[v], "0", "0"}, tip.mass = s, tip.com = {kLever[v], "0", "0"};
    tip.moments = {"1", "1", "1"};
    return caseOf("heavy_tip", {arm, tip}, noGravity(), {0.3, 0}, {}, {1, 0.5});
  };
  // what the first joint moves: I1 + l^2 J / c^2 in the limit
  const auto moved = [] { return 0.35 * 0.35 + 0.05 + 0.7 * 0.7 / (0.5 * 0.5); };
  f.theories = {
      {Road::kMassMatrix,
       "M00 - M01^2 / M11 cancels s (l + c)^2 down to I1 + l^2 J / c^2: error u s (l + c)^2 / (I1 "
       "+ l^2 J / c^2), of three roundings in each entry, M01's twice, a product and a quotient: "
       "(3 + 4 3 + 3 + 2) / 3 under the root",
       [moved](double s, const Arithmetic& a) { return rounded(20, a) * s * 1.2 * 1.2 / moved(); }},
      {Road::kSweep,
       "the tip's articulated mass s - (s c)^2 / (s c^2 + J) cancels s down to J / c^2: error u s "
       "l^2 / (I1 + l^2 J / c^2), of s c twice, three roundings in s c^2 + J, a product and a "
       "quotient, and three on the way by l: (4 + 3 + 2 + 3) / 3 under the root",
       [moved](double s, const Arithmetic& a) { return rounded(12, a) * s * 0.7 * 0.7 / moved(); }},
      noTheoryOf({"simbody"},
                 "it turns articulated inertias into the axes of the ground, where every entry "
                 "carries s, by roundings that were not counted")};
  f.mechanism =
      "In the straight arm the tip swings about its own centre of mass when the first joint moves: "
      "its mass s, though felt by every intermediate number, drops out, and what is left is J / c^2. "
      "Every method finds that small number as a difference of numbers of size s.";
  f.survivor =
      "None in a given arithmetic: the mechanism is well posed (relative changes of its numbers "
      "change qdd as little), but both M and articulated inertias carry s. Sweeps last a little "
      "longer, as they carry s l^2 and not s (l + c)^2.";
  return f;
}

Family lightCart() {
  Family f;
  f.name = "light_cart";
  f.title = "A light cart under an upright pole";
  f.dial = "mass of the pole over that of the cart";
  f.from = 1, f.to = 1e16;
  f.make = [](const std::string& s, int v) {
    LinkWords cart, pole;
    cart.joint = scene::JointKind::kPrismatic, cart.axis = {"1", "0", "0"};
    cart.mass = "1/(" + s + ")", cart.moments = {"1", "1", "1"};
    pole.parent = 1, pole.axis = {"0", "1", "0"}, pole.mass = "1",
    pole.com = {"0", "0", kLength[v]};
    return caseOf("light_cart", {cart, pole}, gravityDown(), {0.2, 0}, {}, {1, 0});
  };
  f.theories = {{Road::kAny,
                 "(m + 1/s) - (m l)^2 / (m l^2) cancels 1 kg down to 1/s kg: error u s, of some "
                 "three roundings",
                 [](double s, const Arithmetic& a) { return rounded(3, a) * s; }},
                theoryOf({"lagrange"},
                         "its m + 1/s, m l and m l^2 are exact numbers, each rounded once, and m l "
                         "counts twice: with a product and a quotient 8 / 3 under the root",
                         [](double s, const Arithmetic& a) { return rounded(8, a) * s; })};
  f.mechanism =
      "An upright point mass does not resist the cart: pushed sideways, it turns. All that resists "
      "is the cart's 1/s kg, which stands in M beside the pole's 1 kg, and what is left of their "
      "difference has lost as many digits as s has.";
  f.survivor =
      "A sweep whose difference happens to be exactly 0 adds the cart's mass to it and loses "
      "nothing.";
  return f;
}

Family vanishingRotor() {
  Family f;
  f.name = "vanishing_rotor";
  f.title = "A massless link with a small rotor before a body on the same axis";
  f.dial = "1 kg m^2 over the rotor's inertia";
  f.from = 1, f.to = 1e17;
  f.make = [](const std::string& s, int v) {
    LinkWords light, body;
    constexpr const char* kRotor[kVariants] = {"1", "1.13", "0.87"};
    light.rotor = std::string(kRotor[v]) + "/(" + s + ")";
    body.parent = 1, body.mass = "1", body.com = {kLever[v], "0.1", "0"};
    body.moments = {"0.1", "0.3", "0.3"};
    return caseOf("vanishing_rotor", {light, body}, gravitySideways(), {0.3, 0.4}, {0.2, -0.5},
                  {1, 0.5});
  };
  f.theories = {
      {Road::kAny,
       "(J + 1/s) - J^2 / J cancels the body's J = 0.3 + 0.25 + 0.01 down to the rotor's "
       "1/s: error u s J, of some three roundings",
       [](double s, const Arithmetic& a) { return rounded(3, a) * s * 0.56; }},
      theoryOf({"articulated_body", "articulated_body float", "fast", "kernel", "kernel_lanes"},
               "J - J (J / J) is exactly 0, and the rotor is added to that: nothing is "
               "lost",
               nothingCancels),
      noTheoryOf({"recursive_lagrange"},
                 "it finds J as a trace of products of 4 x 4 matrices, by roundings that "
                 "were not counted")};
  f.mechanism =
      "What turns the first joint without the second is the rotor alone; a simulation with links "
      "left massless, or rotors made small to be left out, has to find it as a difference of the "
      "body's inertia with itself.";
  f.survivor =
      "A sweep whose articulated inertia about the shared axis is exactly 0 adds the rotor to it "
      "and loses nothing.";
  return f;
}

Family lightToHeavy() {
  Family f;
  f.name = "light_to_heavy";
  f.title = "Eight links in space, light to heavy";
  f.dial = "mass of the last link over that of the first";
  f.from = 1, f.to = 1e30;
  f.make = [](const std::string& s, int v) {
    return spatialChain("light_to_heavy", std::stod(s), v);
  };
  f.mechanism =
      "In a bent pose the heavy end is felt in every joint, and light links are drowned by it "
      "without being asked about by themselves: nothing cancels.";
  f.survivor = "All that have no smallest or largest mass of their own.";
  return f;
}

Family heavyToLight() {
  Family f = lightToHeavy();
  f.name = "heavy_to_light";
  f.title = "Eight links in space, heavy to light";
  f.dial = "mass of the first link over that of the last";
  f.make = [](const std::string& s, int v) {
    return spatialChain("heavy_to_light", 1 / std::stod(s), v);
  };
  f.mechanism =
      "M is graded: each link adds little to the inertia of those before it. Elimination from the "
      "tip inward never subtracts large numbers to find small ones.";
  f.survivor =
      "Whoever eliminates from the tip inward, as the sweeps and L' D L do: a method that begins "
      "at the heavy root, or takes pivots by size of the wrong end, loses the light end's digits.";
  return f;
}

Family longChain() {
  Family f;
  f.name = "long_chain";
  f.title = "A row of equal links with parallel axes";
  f.dial = "links";
  f.from = 2, f.to = 96;
  f.is_whole = f.is_large = true;
  f.make = [](const std::string& s, int v) {
    const int n = std::stoi(s);
    Case out;
    out.scene = scene::flatChainOf(n);
    for (int k = 0; k < n; ++k) {
      out.state.x.push_back(scene::jointPosition(0.1 * ((7 * k + 3 * v) % 11 - 5)));
      out.state.qd.push_back(0.05 * ((5 * k + v) % 7 - 3));
      out.state.tau.push_back(0.1 * ((3 * k + v) % 5 - 2));
    }
    out.state.qdd.assign(static_cast<std::size_t>(n), 0);
    return out;
  };
  f.theories = {{Road::kMassMatrix,
                 "the condition of M grows as n^4, as that of a beam's bending: error u n^4",
                 [](double n, const Arithmetic& a) { return a.unit * n * n * n * n; }}};
  f.mechanism =
      "M says how much force every joint takes to accelerate every other; its inverse is almost "
      "banded, as in a beam, and forming M first throws that structure away. Its largest entries "
      "grow as n^3, and the inertia that a joint near the tip moves does not.";
  f.survivor = "Sweeps, which never form M: they pass one articulated inertia from link to link.";
  return f;
}

Family gears() {
  Family f;
  f.name = "gears";
  f.title = "Huge gear ratios";
  f.dial = "gear ratio";
  f.from = 1, f.to = 1e160;
  f.make = [](const std::string& s, int v) {
    LinkWords upper, lower;
    upper.mass = "1", upper.com = {"0.3", "0", "0"}, upper.moments = {"0.01", "0.05", "0.05"};
    upper.rotor = "1e-4", upper.gear = s;
    lower.parent = 1, lower.xyz = {kLength[v], "0", "0"}, lower.mass = "1";
    lower.com = {kLever[v], "0.1", "0"}, lower.moments = {"0.01", "0.04", "0.04"};
    lower.rotor = "1e-4";
    return caseOf("gears", {upper, lower}, gravitySideways(), {0.3, 0.4}, {0.2, -0.5}, {1, 0.5});
  };
  f.theories = {
      {Road::kMassMatrix, "n^2 leaves the numbers of the arithmetic: n = sqrt(largest)",
       untilItsSquareOverflows},
      theoryOf({"lagrange", "kernel", "kernel_lanes", "simbody"},
               "n^2 J is formed exactly, or J n first, and leaves the numbers of the "
               "arithmetic: n = sqrt(largest / J), J = 1e-4",
               [](double s, const Arithmetic& a) { return untilItsSquareOverflows(s / 100, a); }),
      theoryOf({"mujoco", "mujoco_principal"},
               "the pivot is infinite, and what it is divided into 0, the joint's "
               "acceleration: nothing breaks",
               nothingCancels),
      noTheoryOf({"dart"}, "it ends the process beyond a size of its own"),
      {Road::kSweep,
       "a sweep divides by D = n^2 J, and 1 / infinite is 0, the joint's acceleration: "
       "nothing breaks",
       nothingCancels}};
  f.mechanism =
      "The rotor's inertia n^2 J stands alone on the diagonal of M. The heavier it is, the more its "
      "joint stands still, and the other joint moves as if it did: nothing cancels until the square "
      "is no number any more.";
  f.survivor = "All, as far as their numbers go; sweeps beyond.";
  return f;
}

}  // namespace

std::vector<Family> familiesOfMasses() {
  return {heavyTip(),     lightCart(), vanishingRotor(), lightToHeavy(),
          heavyToLight(), longChain(), gears()};
}

}  // namespace dynwitness::crosscheck::stability
