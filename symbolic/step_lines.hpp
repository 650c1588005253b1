// SPDX-License-Identifier: GPL-3.0-or-later
// Results of a derivation that are too long for one formula: as lines of a program, link by link,
// each with what it is and in what it is counted.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "symbolic/derivation.hpp"
#include "symbolic/dimensions.hpp"

namespace dynwitness::symbolic {

/// A result, and the step that it belongs to.
struct Result {
  std::string name;
  Node node;
  std::size_t step;
  int link;  ///< of Equations::links, to which the lines belong that it needs first; -1: to none
  Dimension dimension;
  std::optional<Formula> closed = {};  ///< none: it is shown as lines
};

/** Names what M is made of, as far as nothing else has these names: of each link k with all that it
    carries the mass mck, first moments sckx, ... and moments of inertia Ickxx, ... about the origin
    of its frame, in its axes. */
void nameCompositeBodies(const scene::Mechanism& mechanism, const Options& options, Equations& e);

/// Of each rate the link that its joint carries, an index of Equations::links.
std::vector<int> linksOfRates(const scene::Mechanism& mechanism, const Options& options,
                              Equations& e);

/** The lines, each under the first step that needs it, and after them the results of the step, in
    their order. Lines that only accelerations of one link need stand with that link, others with
    the first result that needs them: T outward, all else inward. */
void addLines(Equations& e, const scene::Mechanism& mechanism, const std::vector<Result>& results,
              std::vector<Step>* steps);

}  // namespace dynwitness::symbolic
