// SPDX-License-Identifier: GPL-3.0-or-later
// How time, memory and digits grow with the number of links, of our sweeps and of the engines.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "crosscheck/witness.hpp"

namespace dynwitness::crosscheck {

/// One method at one number of links. What was not measured is not-a-number.
struct GrowthPoint {
  std::string family;  ///< "chain", "tree"
  int links = 0;
  std::string method;  ///< "fast", "textbook", or an outside engine's name
  double id_ns = 0, fd_ns = 0;  ///< CPU time a link of one call [ns], fastest
  double build_ns = 0;          ///< from the scene to what is asked, a link [ns]
  double bytes = 0;             ///< kept on the heap, a link
  /// Of forward dynamics: largest |entry - truth| / largest |truth|; the truth is certified.
  double fd_error = 0;
  std::string failure;  ///< why there is nothing: it died, or was given up
};

struct GrowthOptions {
  std::vector<std::string> families = {"chain", "tree"};
  int most_links = 16384;
  std::uint64_t seed = 1;
  /// Up to how many links the certified truth is computed.
  int most_links_with_truth = 4096;
  /// An engine that took longer than this [s] for all of a size is not asked for a larger one.
  double patience = 1;
};

/** Powers of four from 1 to options.most_links, and that number itself: chain_N and tree_N of
    scene/families.hpp at their first seeded state.

    Every measurement runs in a process of its own: its memory is its own, and an engine that dies
    does so alone. Ours are "fast" (recursive/fast/) and "textbook" (recursive/); neither forms M. */
std::vector<GrowthPoint> growth(const std::vector<WitnessKind>& engines, const GrowthOptions& options,
                                const std::function<void(const std::string&)>& progress = {});

/// `family,links,method,id_ns_per_link,fd_ns_per_link,build_ns_per_link,bytes_per_link,fd_error`
/// under `#` lines.
std::string growthCsv(const std::vector<GrowthPoint>& points, const GrowthOptions& options);

/// Draws FAMILY.svg and FAMILY_dark.svg from growth.csv beside it.
/// @param style  the path of style.gp, as seen from the script's folder
std::string growthScript(const std::vector<GrowthPoint>& points, const std::string& family,
                         const std::string& style);

}  // namespace dynwitness::crosscheck
