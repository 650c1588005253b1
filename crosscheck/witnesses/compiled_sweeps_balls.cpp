// SPDX-License-Identifier: GPL-3.0-or-later
// The sweeps on balls.
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::recursive {

DYNWITNESS_SWEEPS(, crosscheck::Ball);
DYNWITNESS_MODELS(, crosscheck::Ball, crosscheck::BallNumbers);

}  // namespace dynwitness::recursive
