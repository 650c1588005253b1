// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of a tree's equations of motion in balls.
#include "crosscheck/studies/linearization_model.hpp"

namespace dynwitness::crosscheck {

template class LinearizationModel<Ball>;
template LinearizationModel<Ball>::LinearizationModel(const scene::Mechanism&, const BallNumbers&);

}  // namespace dynwitness::crosscheck
