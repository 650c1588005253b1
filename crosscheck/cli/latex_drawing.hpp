// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "crosscheck/report/view.hpp"

namespace dynwitness::cli {

/** The drawing of a mechanism in a LaTeX document, as `show` and pages have it, without ellipsoids:
    a picture environment that needs no package. Empty where links are too many to be drawn one by
    one. */
std::string latexDrawing(const crosscheck::View& view);

}  // namespace dynwitness::cli
