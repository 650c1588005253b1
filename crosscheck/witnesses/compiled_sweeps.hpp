// SPDX-License-Identifier: GPL-3.0-or-later
// The sweeps on the scalars of the crosscheck: compiled once each (compiled_sweeps_*.cpp), and not
// again in every file that runs them. What is not listed here is compiled where it is used.
#pragma once

#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/energy.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/reactions.hpp"

namespace dynwitness::crosscheck {

class AdjointError;
class AdjointErrorNumbers;
class Ball;
class BallNumbers;
class FieldSource;
class PrimeField;
class RunningError;
class RunningErrorNumbers;
template <typename Source>
class IndeterminateNumbers;

}  // namespace dynwitness::crosscheck

/// @param PREFIX  extern: compiled elsewhere; empty: compiled here
#define DYNWITNESS_SWEEPS(PREFIX, T)                                                             \
  PREFIX template void inverseDynamics<T>(const Model<T>&, const std::vector<JointPosition<T>>&, \
                                          const std::vector<T>&, const std::vector<T>&,          \
                                          Workspace<T>&, std::vector<T>&, Terms);                \
  PREFIX template void massMatrix<T>(const Model<T>&, const std::vector<JointPosition<T>>&,      \
                                     Workspace<T>&, MatrixX<T>&);                                \
  PREFIX template void forwardDynamics<T>(const Model<T>&, const std::vector<JointPosition<T>>&, \
                                          const std::vector<T>&, const std::vector<T>&,          \
                                          Workspace<T>&, std::vector<T>&, Terms);                \
  PREFIX template T kineticEnergy<T>(const Model<T>&, const std::vector<JointPosition<T>>&,      \
                                     const std::vector<T>&, Workspace<T>&);                      \
  PREFIX template T potentialEnergy<T>(const Model<T>&, const std::vector<JointPosition<T>>&,    \
                                       Workspace<T>&);                                           \
  PREFIX template Force<T> momentum<T>(const Model<T>&, const std::vector<JointPosition<T>>&,    \
                                       const std::vector<T>&, Workspace<T>&);                    \
  PREFIX template void jointReactions<T>(const Model<T>&, const Workspace<T>&, std::vector<T>&)

#define DYNWITNESS_MODELS(PREFIX, T, NUMBERS)                                              \
  PREFIX template Model<T> buildModel<NUMBERS, T>(const scene::Mechanism&, const NUMBERS&, \
                                                  FixedJoints)

namespace dynwitness::recursive {

DYNWITNESS_SWEEPS(extern, double);
DYNWITNESS_MODELS(extern, double, scene::RealNumbers<double>);
DYNWITNESS_SWEEPS(extern, crosscheck::RunningError);
DYNWITNESS_MODELS(extern, crosscheck::RunningError, crosscheck::RunningErrorNumbers);
DYNWITNESS_SWEEPS(extern, crosscheck::AdjointError);
DYNWITNESS_MODELS(extern, crosscheck::AdjointError, crosscheck::AdjointErrorNumbers);
DYNWITNESS_SWEEPS(extern, crosscheck::PrimeField);
DYNWITNESS_MODELS(extern, crosscheck::PrimeField,
                  crosscheck::IndeterminateNumbers<crosscheck::FieldSource>);
DYNWITNESS_SWEEPS(extern, crosscheck::Ball);
DYNWITNESS_MODELS(extern, crosscheck::Ball, crosscheck::BallNumbers);

}  // namespace dynwitness::recursive
