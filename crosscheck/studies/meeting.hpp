// SPDX-License-Identifier: GPL-3.0-or-later
// Where several neighbouring motions meet at once: a conjugate time of higher multiplicity.
#pragma once

#include <vector>

#include "crosscheck/studies/neighbouring_motions.hpp"

namespace dynwitness::crosscheck::hamilton {

/** How many singular values of A vanish together within two steps after `from`. Each passes 0 as |t
   - t*|; the least of the smallest is sought by golden sections, and one that would reach 0 within
   duration / kSharp of there counts. */
Action::Conjugate manyMeet(Neighbours* neighbours, const std::vector<PhasePoint<D>>& from,
                           double start, double h);

}  // namespace dynwitness::crosscheck::hamilton
