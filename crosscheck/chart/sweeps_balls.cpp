// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/chart/sweep_method.hpp"

namespace dynwitness::crosscheck {

std::unique_ptr<Method> sweepInBalls(Sweep sweep, const scene::Mechanism& mechanism,
                                     const States& states) {
  return std::make_unique<SweepMethod<BallNumbers>>(sweep, Scalar::kBalls, mechanism, states);
}

}  // namespace dynwitness::crosscheck
