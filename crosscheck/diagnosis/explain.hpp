// SPDX-License-Identifier: GPL-3.0-or-later
// Which mistake makes of the mechanism just what was answered.
#pragma once

#include <vector>

#include "crosscheck/diagnosis/exhibits.hpp"
#include "crosscheck/diagnosis/textbook.hpp"

namespace dynwitness::crosscheck {

struct Explained {
  std::vector<CheckFinding> findings;  ///< best first; where none explains, the nearest
  long tried = 0, pairs_tried = 0, pairs = 0;
};

/** Compares every mistake on record with what was said.

    The limit of a comparison is that of the witness (what a sweep of its kind may lose), twice, as
    the prediction is such a computation too, and in proportion to what the mistake makes of the
    quantity; and an ulp of the largest entry, for entries that are zero by structure where nothing
    is mistaken. An explanation has to explain all answers of all quantities that are wrong. It may
    be confined to these: an engine that computes tau and M on two roads can err on one.

    @param chosen  all states, in the order in which they were asked */
Explained explained(const TextbookModel& model, const std::vector<Exhibit>& given,
                    const std::vector<scene::State<double>>& chosen);

}  // namespace dynwitness::crosscheck
