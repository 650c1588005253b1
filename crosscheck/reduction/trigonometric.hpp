// SPDX-License-Identifier: GPL-3.0-or-later
// M, c and g of a scene as what they are: trigonometric polynomials in q, with certified
// coefficients.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <boost/container/flat_map.hpp>

#include "crosscheck/scalars/running_error.hpp"
#include "scene/envelope.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// Functions of one joint: 1, cos q, sin q, cos 2q, sin 2q where it turns; 1, q, q^2 where it
/// slides.
inline constexpr int kBasis = 5;
/// A product of one function of each joint: digits in base 5, joint 0 the last.
using Monomial = std::uint32_t;
/// Coefficients, each with a bound of its error.
/// In a row: those of seven joints have thousands, most of them within roundings of zero.
using Polynomial = boost::container::flat_map<Monomial, RunningError>;

/** M(q), g(q), V(q) and the loads, as polynomials in cosines and sines of the joints that turn
    and in the positions of those that slide. In the axes of its own link, a link's motion is of
    degree 1 in every joint inboard of it and knows no other; so M is of degree 2 at most, and g
    and loads of degree 1. A joint on the root changes nothing but the whole's place, and M does
    not know it. A polynomial of degree d is what its values at 2 d + 1 equally spaced angles (3
    places on a slide) say: `recursive/` is asked there in RunningError, and a discrete Fourier
    transform in RunningError gives the coefficients. */
struct TrigonometricModel {
  int dof = 0;
  std::vector<bool> slides;                               ///< by rate
  std::vector<std::vector<Polynomial>> M;                 ///< n x n
  std::vector<Polynomial> gravity, loads;                 ///< n; springs are apart
  Polynomial potential;                                   ///< of gravity
  std::vector<RunningError> stiffness, rest;              ///< of springs at the joints
  std::vector<RunningError> viscous, positive, negative;  ///< friction
};

/// A monomial of more does not fit: 5^13 < 2^32 < 5^14.
inline constexpr int kMostJoints = 13;
/// How many values of M are asked for at most: 5^6, an arm of seven joints that turn.
inline constexpr int kMostGridPoints = 15625;
/// And of g: 3^10, ten joints that turn.
inline constexpr int kMostGravityPoints = 59049;

/// @throws scene::InputError  what `envelope` refuses (crosscheck/inputs/features.hpp); no joint
///   moves; more joints or values than these
TrigonometricModel trigonometricModel(const scene::Scene& scene);

/// A function of q, and what it is multiplied by: 1, qdd_j, or qd_j qd_k with j <= k.
struct EnvelopePart {
  Polynomial f;
  int j = -1, k = -1;  ///< j alone: qdd_j; both: qd_j qd_k
};

/** The wrench that the parent exerts on a link through the joint with this rate, as
    recursive::jointReactions() has it: force, then moment about the moved joint frame's origin, in
    that frame, six sums of parts. In that frame it is of degree 2 at most in every joint but those
    on the root, which tell it where gravity points and no more.
    @throws scene::InputError  as trigonometricModel() */
std::array<std::vector<EnvelopePart>, 6> reactionParts(const scene::Scene& scene, int rate);

/// d/dq_k.
Polynomial derivative(const Polynomial& f, int k, bool slides);
/// a + factor b, for factors that are powers of 2.
void add(const Polynomial& b, double factor, Polynomial* a);
/// The factor of joint k in a monomial: 0 to 4.
int digit(Monomial m, int k);
/// sup |d^order/dq^order| of a joint's factor for |q| <= reach.
double mostOfFactor(int digit, bool slides, double reach, int order);

}  // namespace dynwitness::crosscheck
