// SPDX-License-Identifier: GPL-3.0-or-later
// The mass matrix as a metric, over the prime field.
#include "crosscheck/studies/kinetic_metric.hpp"

namespace dynwitness::crosscheck {

template class KineticMetric<PrimeField>;

}  // namespace dynwitness::crosscheck
