// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/latex_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <regex>
#include <vector>

#include <fmt/format.h>

#include "symbolic/sentence.hpp"

namespace dynwitness::cli {
namespace {

/// What a drawing is made of, y upward [px of the page's drawing].
struct Stroke {
  std::string type;  ///< as the page's style names it: link, joint, axis x, ...
  double x1, y1, x2, y2;
};
struct Spot {
  std::string type;
  double x, y, radius;
};
struct Label {
  std::string words;
  double x, y;
};
struct Drawing {
  std::vector<Stroke> strokes;
  std::vector<Spot> spots;
  std::vector<Label> labels;
};

Drawing drawingOf(const std::string& svg) {
  static const std::regex kStroke(
      R"re(<path class="([^"]*)" d="M(\S+) ([^L"]+)L(\S+) ([^"M]+)"/>)re"),
      kSpot(R"re(<circle class="([^"]*)" cx="([^"]*)" cy="([^"]*)" r="([^"]*)"/>)re"),
      kLabel(R"re(<text class="[^"]*" x="([^"]*)" y="([^"]*)">([^<]*)</text>)re");
  const auto number = [](const std::ssub_match& text) { return std::stod(text.str()); };
  Drawing drawing;
  const std::sregex_iterator end;
  for (std::sregex_iterator m(svg.begin(), svg.end(), kStroke); m != end; ++m)
    drawing.strokes.push_back(
        {(*m)[1], number((*m)[2]), -number((*m)[3]), number((*m)[4]), -number((*m)[5])});
  for (std::sregex_iterator m(svg.begin(), svg.end(), kSpot); m != end; ++m)
    drawing.spots.push_back({(*m)[1], number((*m)[2]), -number((*m)[3]), number((*m)[4])});
  for (std::sregex_iterator m(svg.begin(), svg.end(), kLabel); m != end; ++m)
    drawing.labels.push_back({(*m)[3], number((*m)[1]) + 5, -number((*m)[2]) + 3});
  return drawing;
}

std::string latexOf(const Stroke& s) {
  const bool is_link = s.type == "link", is_axis = s.type.compare(0, 4, "axis") == 0,
             is_joint = s.type == "joint";
  const double length = std::hypot(s.x2 - s.x1, s.y2 - s.y1);
  // a stroke is a Bezier curve, which has any direction: solid as long as its points touch
  const std::string points =
      is_link || is_axis || is_joint ? "" : fmt::format("[{:.0f}]", std::max(2.0, length / 5));
  return fmt::format(
      "\\linethickness{{{}}}\\qbezier{}({:.1f},{:.1f})({:.1f},{:.1f})({:.1f},{:.1f})\n",
      is_link    ? "1.4pt"
      : is_joint ? "0.8pt"
                 : "0.4pt",
      points, s.x1, s.y1, (s.x1 + s.x2) / 2, (s.y1 + s.y2) / 2, s.x2, s.y2);
}

}  // namespace

std::string latexDrawing(const crosscheck::View& view) {
  const Drawing drawing = drawingOf(crosscheck::viewSvg(view));
  if (drawing.strokes.empty() || drawing.labels.empty()) return "";
  double left = 1e300, right = -1e300, low = 1e300, high = -1e300;
  const auto reach = [&](double x, double y) {
    left = std::min(left, x);
    right = std::max(right, x);
    low = std::min(low, y);
    high = std::max(high, y);
  };
  std::string body;
  for (const Stroke& s : drawing.strokes) {
    reach(s.x1, s.y1);
    reach(s.x2, s.y2);
    body += latexOf(s);
  }
  body += "\\thinlines\n";
  for (const Spot& s : drawing.spots)
    body += fmt::format("\\put({:.1f},{:.1f}){{\\circle{}{{{:.1f}}}}}\n", s.x, s.y,
                        s.type == "joint tip" ? "*" : "", 2 * s.radius);
  for (const Label& label : drawing.labels) {
    reach(label.x + 20, label.y + 10);
    body += fmt::format("\\put({:.1f},{:.1f}){{{}}}\n", label.x, label.y,
                        symbolic::printSentence(label.words, symbolic::Style::kLatex));
  }
  return fmt::format(
      "\\begin{{center}}\\setlength{{\\unitlength}}{{0.28mm}}\\small\n"
      "\\begin{{picture}}({:.0f},{:.0f})({:.0f},{:.0f})\n{}\\end{{picture}}\n\n"
      "\\footnotesize Thick: links, dotted to centres of mass (circles). Thin: axes of joints, a dot at "
      "the positive end, broken where they slide. $x$, $y$, $z$: axes of the world.\\end{{center}}\n\n",
      right - left, high - low, left, low, body);
}

}  // namespace dynwitness::cli
