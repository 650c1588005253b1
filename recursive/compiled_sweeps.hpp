// SPDX-License-Identifier: Apache-2.0
// The sweeps on a scalar compiled once, and not again in every file that runs them: say
//     DYNWITNESS_SWEEPS(extern, MyScalar);
// in namespace dynwitness::recursive of a header, and without the word extern in one source file.
#pragma once

#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/energy.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/reactions.hpp"

// NOLINTBEGIN(bugprone-macro-parentheses) PREFIX extern: compiled elsewhere; empty: here
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
// NOLINTEND(bugprone-macro-parentheses)
