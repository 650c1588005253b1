// SPDX-License-Identifier: GPL-3.0-or-later
// Where links are and how they move, by differentiating their positions: the step of a derivation
// on paper that goes before T, and a second road to it.
#pragma once

#include <string>
#include <vector>

#include "symbolic/equations.hpp"
#include "symbolic/vectors.hpp"

namespace dynwitness::symbolic {

/** Of a link that moves and has mass. With its placement R(q), p(q) in the world,
        v = dp/dt,   [omega]x = R' dR/dt
    and no velocity is carried from link to link, as velocities() does, but for `carried`. */
struct LinkMotion {
  std::string link;
  int body;           ///< of Equations::links
  Value mass;         ///< [kg]
  Vector3 position;   ///< of the centre of mass, in axes of the world [m]
  Vector3 velocity;   ///< of the centre of mass, in axes of the world [m/s]
  Vector3 angular;    ///< omega, in axes of the link [rad/s]
  Vector3 carried;    ///< omega once more, from joint to joint: a sum where axes are parallel
  Symmetric inertia;  ///< I about the centre of mass, in axes of the link [kg m^2]
  Value kinetic;      ///< m v'v / 2 + omega' I omega / 2, I about the centre of mass [J]
};

struct LinkMotions {
  std::vector<LinkMotion> links;
  /// Of each body: what its rotor has besides,  n^2 J qd^2 / 2  (and of a gyroscopic rotor
  /// n J qd times the angular velocity of the link that carries it); of one geared to several rates
  /// the same with psi' = sum of n_k qd_k [J].
  std::vector<Value> rotor_kinetic;
  /// Of each body: sum of m p over its links, formed from moments of mass, in axes of the world.
  std::vector<Vector3> first_moments;
};

/** The motions of the links of a mechanism, as nodes of the equations that derive() made of it.
    @param options  those that it was given
    @throws std::invalid_argument  when some rates are no derivatives of positions */
LinkMotions linkMotions(const scene::Mechanism& mechanism, const Options& options,
                        Equations& equations);

}  // namespace dynwitness::symbolic
