// SPDX-License-Identifier: GPL-3.0-or-later
// Which inertial parameters a mechanism's motion can tell, and in which combinations.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/inertial_parameters.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** A constant of the regrouping. It depends on the geometry alone. */
struct Coefficient {
  int base;                              ///< row of K: index into BaseParameters::independent
  int parameter;                         ///< the dependent parameter that it multiplies
  std::optional<scene::Rational> exact;  ///< where the geometry is rational
  std::string symbol = {};  ///< "l1^2", "-2 d": where it is that for all parameters of the scene
  double value = 0, error = 0;  ///< |value - coefficient| <= error, certified
};

/** The base (minimal) parameters of a mechanism.

    tau = Y pi holds for every state, but the columns of Y are not independent as functions of the
    state. With Y_1 some independent columns and Y_2 the others,

        Y_2 = Y_1 K   with K constant,      tau = Y_1 (pi_1 + K pi_2)

    so that the motion knows pi_1 + K pi_2 and nothing else about pi. Y_1 are the columns that do
    not depend on those before them, from the base outward and of each link I before m c before m:
    what cannot be told apart is counted to the link nearer to the base. */
struct BaseParameters {
  enum class Status {
    kAlone,          ///< is a base parameter itself
    kInCombination,  ///< is known as part of a sum only
    kNoEffect        ///< moves no joint
  };
  std::vector<scene::InertialParameter> parameters;
  std::vector<Status> status;    ///< one a parameter
  std::vector<int> independent;  ///< columns of Y_1: as many as there are base parameters
  std::vector<Coefficient> K;    ///< its entries that are not zero, by base, then by parameter
  int states = 0;                ///< generic states whose Y, stacked, have this rank
  int points = 0;                ///< states of the prime field at which Y was stacked, in all
  /// Chance at most that the rank is larger than found. (Smaller it is not: independent columns are
  /// independent, whatever the point.) The rank is that for generic values of the angles that have
  /// no rational cosine and sine.
  double error_probability = 1;

  int count() const { return static_cast<int>(independent.size()); }
  int countWithoutRotors() const;
};

/** Base parameters of a scene: the rank of Y stacked over random states of a prime field, and K
    from the same elimination. K is lifted from residues modulo several primes to rationals and held
    to one prime more; and it is enclosed in balls from doubles, by another elimination, in which
    the independent columns are proven to be so.
    @throws std::logic_error  the two do not meet: one of our arithmetics is wrong */
BaseParameters baseParameters(const scene::Scene& scene, std::uint64_t seed,
                              double error_probability);

/** Rank of the energy regressor d(T + V)/dpi - that of a reference state, from the derivation of
    symbolic/: an independent way to the number of base parameters. A parameter that no joint force
    depends on adds a constant to the energy.
    @return  -1: a combination without effect on the forces changes the energy */
int energyRank(const scene::Scene& scene, const BaseParameters& base, std::uint64_t seed);

/** The number of base parameters, rotors aside, of n revolute joints in a row whose axes are
    parallel or perpendicular to those before them:  7 n - 4 b,  less 2 where gravity does not turn
    the first joint (parallel to its axis, or absent); b joints from the base outward are parallel
    to the first.
    @return  nothing where the mechanism is not of that kind
    @see H. Mayeda, K. Yoshida, K. Osuka, Base parameters of manipulator dynamic models, IEEE Trans.
         Robotics and Automation 6(3), 1990 */
std::optional<int> mayedaCount(const scene::Mechanism& mechanism);

/// "l1^2", "0.18645", "-1/3", "0.866025": in the scene's letters or exact where it can be and
/// short.
std::string text(const Coefficient& coefficient);
/// "Iyy(upper) + l1^2 [m(lower) + m(tool)]": the sum behind a base parameter.
std::string combination(const BaseParameters& base, int row, const scene::Mechanism& mechanism);

}  // namespace dynwitness::crosscheck
