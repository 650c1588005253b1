// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/chart/sweep_method.hpp"

namespace dynwitness::crosscheck {

std::unique_ptr<Method> sweepInLongDouble(Sweep sweep, const scene::Mechanism& mechanism,
                                          const States& states) {
  return std::make_unique<SweepMethod<scene::RealNumbers<long double>>>(sweep, Scalar::kLongDouble,
                                                                        mechanism, states);
}

}  // namespace dynwitness::crosscheck
