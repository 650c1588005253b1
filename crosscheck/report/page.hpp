// SPDX-License-Identifier: GPL-3.0-or-later
// The page that people read.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "crosscheck/system/environment.hpp"
#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

/// What the pages link to, one a scene; paths are relative to the scene's own page.
struct SceneFiles {
  std::string page;    ///< the scene's own, relative to the report's folder; unique
  std::string anchor;  ///< of its headline
  std::string tree;    ///< svg; empty: the tree is too large to draw
  std::string models;  ///< its part of modelSections(), HTML; may be empty
  std::string view;    ///< the picture that moves, a page of its own; empty: left out
  std::string drift_csv, drift_worst_csv, drift_script;  ///< empty: no drift was computed
  std::string drift;                                     ///< svg; empty: left out, see below
  std::string no_plot_reason;                            ///< why there is data and no picture
  // the same of speed against accuracy
  std::string chart_csv, chart_script, chart, no_chart_reason;
};

/** The report's first page: verdict, disagreements, table of scenes, each with a link to its own
    page, and the footer with all that is needed to compute it again. No scripts, no fonts and no
    network.

    @param files  as many as there are scenes
    @param more   sections more, as HTML (pairsSection(), benchSection()); may be empty */
std::string reportPage(const CrosscheckResult& result, const Environment& environment,
                       const std::vector<SceneFiles>& files, const std::string& more = {});

/// The page of one scene, two folders below the report's.
/// @param k  which
std::string scenePage(const CrosscheckResult& result, std::size_t k, const Environment& environment,
                      const SceneFiles& files);

}  // namespace dynwitness::crosscheck
