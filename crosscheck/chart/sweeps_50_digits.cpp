// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/chart/sweep_method.hpp"
#include "crosscheck/scalars/digits50.hpp"

namespace dynwitness::crosscheck {

std::unique_ptr<Method> sweepIn50Digits(Sweep sweep, const scene::Mechanism& mechanism,
                                        const States& states) {
  return std::make_unique<SweepMethod<scene::RealNumbers<Digits50>>>(sweep, Scalar::k50Digits,
                                                                     mechanism, states);
}

}  // namespace dynwitness::crosscheck
