// SPDX-License-Identifier: GPL-3.0-or-later
// Fewer operations for the same functions: sums and products of a program, regrouped.
#pragma once

#include <vector>

#include "symbolic/graph.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck::kernel {

/// kQuick does what is best in most cases, for searches that ask often.
enum class Effort { kQuick, kFull };

/** The program of some nodes, smaller where regrouping makes it so:
      (1)  a b + a c = a (b + c),  where both products serve this sum alone
      (2)  a + b in two sums, up to a common sign, is formed once
      (3)  before (2), short sums are written out in the sums that use them, so that what cancels
           does: the trace of an inertia, for one, does not notice the turn of a joint
    Sums are taken as sets of terms, so that none of these depends on the order in which they were
    written. Greedy, the largest saving first; programs of more than some thousand terms are left as
    they are, because (2) looks at all pairs of a sum's terms. The functions stay the same;
    roundings do not, so whoever bounds them must bound those of the program that comes out.
    @param graph  gets the new nodes
    @param steps  counts the work: nodes looked at and pairs compared, some ten million a second;
                   may be null */
symbolic::Program factored(symbolic::Graph& graph, const std::vector<symbolic::Node>& outputs,
                           Effort effort = Effort::kFull, long* steps = nullptr);

}  // namespace dynwitness::crosscheck::kernel
