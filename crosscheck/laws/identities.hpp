// SPDX-License-Identifier: GPL-3.0-or-later
// The laws that every mechanism's dynamics must obey.
#pragma once

#include "crosscheck/laws/derivative_laws.hpp"
#include "crosscheck/laws/energy_laws.hpp"
#include "crosscheck/laws/gauss_value.hpp"
#include "crosscheck/laws/projection_laws.hpp"
#include "crosscheck/laws/reaction_laws.hpp"
#include "crosscheck/laws/sweep_laws.hpp"

namespace dynwitness::crosscheck {

/// Of a SweptMechanism, in the order of reports. Where M is singular, the laws that divide by an
/// inertia have no sides, and the others do.
using Identities =
    Laws<SymmetricMassMatrix, QuadraticKineticEnergy, PowerBalance, ForwardUndoesInverse,
         CoriolisMatrix, SkewSymmetry, GradientOfThePotential, LumpingFixedJoints,
         DualityOfTransformations, Projector, SymmetricProjectedInertia, ProjectedTwice,
         DualProjections, IndependenceOfTheRoot, ReactionsAlongAxes, ReactionsAtTheBase,
         LinearInInertialParameters, ValueOfGauss, ForcesByAcceleration, AccelerationsGiveWay,
         SymmetricInverseOfM, SymmetricGravityGradient, CoriolisByRate>;

}  // namespace dynwitness::crosscheck
