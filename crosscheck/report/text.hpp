// SPDX-License-Identifier: GPL-3.0-or-later
// Text on its way into HTML, XML and file names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

/// Valid UTF-8 without control characters (which XML forbids): what is neither becomes U+FFFD.
std::string cleanText(std::string_view text);

/// cleanText, with & < > " ' escaped: safe as HTML or XML text and inside quoted attributes.
std::string escapeMarkup(std::string_view text);

/// cleanText on one line: for gnuplot titles and CSV comments.
std::string oneLine(std::string_view text);

/// oneLine as a gnuplot string: in single quotes, which take everything literally but themselves.
std::string gnuplotString(std::string_view text);

/// Two digits that can be read at a glance: "0", "0.31", "7.4", "120", "3.1e+03", "infinite".
std::string readable(double value);

/// "0.3 %", "42 %" up to the limit, "31 x limit" beyond it.
std::string shareOfLimit(double ratio);

/// "42% of truth M" up to ten times a limit, "3.1e+05 times truth M" beyond it.
std::string ofLimit(double ratio, const std::string& what);

/// The limit of a check as a reader compares it: "7.4", or "≥ 3.0" where the unit says "(at
/// least)".
std::string limitText(const CheckResult& check);
/// "1.0 of 1.5 ulp"; "observed order 3.8, at least 3.0"
std::string worstOfLimit(const CheckResult& check);

/// Number of characters that a reader sees, near enough for layout: UTF-8 code points.
int codePoints(std::string_view text);

/// A name that is safe as a file and as an anchor: [A-Za-z0-9_-] is kept, the rest becomes '_'.
std::string safeName(std::string_view name);

/// safeName of each scene, different from each other: repeated names get "_2", "_3", ...
std::vector<std::string> safeNames(const std::vector<SceneResult>& scenes);

/// "3 of 100 states not judged, the first 17: no error bound ..", or "" where all were.
std::string voidedText(const CheckResult& check);

/// "same c: lagrange and simbody" or "symmetric M: composite_body"
std::string describe(const CheckResult& check);

}  // namespace dynwitness::crosscheck
