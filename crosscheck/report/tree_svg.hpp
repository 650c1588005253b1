// SPDX-License-Identifier: GPL-3.0-or-later
// The picture of a mechanism: its links, and the joints between them.
#pragma once

#include <string>

#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

enum class SvgUse {
  kInPage,  ///< takes its colours from the page's style
  kFile,    ///< brings its own, for light and dark
};

/** An SVG picture: links are boxes, joints are labelled edges with a glyph for revolute, prismatic
    and fixed (a joint label ends with " (revolute)" etc.; other joints get a dot). Base to tip runs
    from left to right where that fits a page, from top to bottom otherwise.

    @return the <svg> element; empty when there are no links or more than kLargestTree */
std::string treeSvg(const SceneResult& scene, SvgUse use);

/// Beyond this a picture would be a wall of boxes.
constexpr int kLargestTree = 80;

/// One sentence: "8 links in one chain", "32 links, 5 tips, at most 14 joints from base to tip".
std::string treeSentence(const SceneResult& scene);

/// The CSS rules of kInPage pictures, in terms of the page's variables.
const char* treeStyle();

}  // namespace dynwitness::crosscheck
