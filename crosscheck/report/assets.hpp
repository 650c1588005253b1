// SPDX-License-Identifier: GPL-3.0-or-later
// Files that the build puts into the program (report.cmake and assets.cpp.in beside this).
#pragma once

namespace dynwitness::crosscheck {

extern const char* const kStyleCss;       ///< style.css
extern const char* const kStyleGnuplot;   ///< style.gp
extern const char* const kHowToReadHtml;  ///< how_to_read.html, a section of the page
extern const char* const kViewCss;        ///< view.css
extern const char* const kViewJs;         ///< view.js

}  // namespace dynwitness::crosscheck
