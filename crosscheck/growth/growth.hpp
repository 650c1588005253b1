// SPDX-License-Identifier: GPL-3.0-or-later
// How time, memory and digits grow with the number of links, of our sweeps and of the engines.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

/// What the growth goals compare with: a link's share where there are so many; the model's, up to
/// so many.
inline constexpr int kGrowthFrom = 64, kGrowthBuildTo = 4096;
/// Links from which memory kept is told (below, the heap's own bookkeeping shows), and memory of
/// the whole process (below, it is mostly the program).
inline constexpr int kGrowthBytesFrom = 16, kGrowthPeakFrom = 4096;

/// One method at one number of links. What was not measured is not-a-number.
struct GrowthPoint {
  std::string family;  ///< "chain", "tree"
  int links = 0;
  std::string method;           ///< "fast", "textbook", or an outside engine's name
  double id_ns = 0, fd_ns = 0;  ///< CPU time a link of one call [ns], fastest
  double scene_ns = 0;          ///< from nothing to the scene, a link [ns]
  double build_ns = 0;          ///< from the scene to what is asked, a link [ns]
  /// Kept on the heap to be asked again, a link; without the scene, and without the caller's
  /// arrays; from kGrowthBytesFrom links.
  double bytes = 0;
  /// The most that scene, building and asking take of the process together, a link; from
  /// kGrowthPeakFrom.
  double peak_bytes = 0;
  /// Of forward dynamics: largest |entry - truth| / largest |truth|, certified from above.
  double fd_error = 0;
  std::string failure = {};  ///< why something is missing: it died, or was given up, and doing what
};

struct GrowthOptions {
  std::vector<std::string> families = {"chain", "tree"};
  int most_links = 16384;
  std::uint64_t seed = 1;
  /// Up to how many links the certified truth is computed.
  int most_links_with_truth = 4096;
  /// CPU time [s] that an engine gets at one size, whole seconds; one that needs more is given up.
  int patience = 10;
};

/// Powers of four from 1 on below the largest, and that.
std::vector<int> growthSizes(int most_links);

/** At growthSizes(options.most_links): chain_N and tree_N of scene/families.hpp at their first
    seeded state.

    Every measurement runs in a process of its own: its memory is its own, and an engine that dies
    does so alone. Ours are "fast" (recursive/fast/) and "textbook" (recursive/); neither forms M,
    which at 10^6 links would take 8 TB. No process may take more than 8 GB. */
std::vector<GrowthPoint> growth(const std::vector<WitnessKind>& engines,
                                const GrowthOptions& options,
                                const std::function<void(const std::string&)>& progress = {});

/// The last-level cache of the first processor [bytes]; 0: the system does not say.
double lastLevelCache();

/// Something that was asked of the fast sweeps, and what was measured.
struct GrowthGoal {
  std::string goal, unit;
  std::string family;
  double limit = 0;
  bool is_least = false;  ///< the limit is to be reached, not kept
  double measured = 0;    ///< not-a-number: not measured
  int links = 0;          ///< where
  bool is_time = false;   ///< a busy machine can miss it

  bool isMeasured() const;
  bool isReached() const;
};

/** The goals, family by family, in the order in which they are told:

    - the slowest ID and FD a link against that at 64 links, as long as what is kept and the
      caller's arrays fit into the last-level cache (1.5), and beyond it (3);
    - the slowest scene and model a link beyond 4096 links against the fastest from 64 to 4096 (3);
    - bytes kept a link, from 64 links on (1500);
    - the whole process at 10^6 links (4 GB);
    - digits of FD at the largest number of links up to 4096 whose truth is certified (14). */
std::vector<GrowthGoal> growthGoals(const std::vector<GrowthPoint>& points, double cache);

/// How many links of a family fit into a cache of this size, with the caller's five arrays; 0: not
/// known.
int linksInCache(const std::vector<GrowthPoint>& points, const std::string& family, double cache);

/// One row a point, under `#` lines and before them.
std::string growthCsv(const std::vector<GrowthPoint>& points, const GrowthOptions& options,
                      double cache);

/// The same for programs; crosscheck/growth/growth.schema.json says what it is.
std::string growthJson(const std::vector<GrowthPoint>& points, const GrowthOptions& options,
                       double cache, const std::string& version);

/// Draws FAMILY.svg from growth.csv beside it.
/// @param style  the path of style.gp, as seen from the script's folder
std::string growthScript(const std::vector<GrowthPoint>& points, const std::string& family,
                         double cache, const std::string& style);

}  // namespace dynwitness::crosscheck
