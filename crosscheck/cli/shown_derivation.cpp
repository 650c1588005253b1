// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/shown_derivation.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/substitution.hpp"
#include "symbolic/derivation.hpp"
#include "symbolic/read_back.hpp"
#include "symbolic/selection.hpp"

namespace dynwitness::cli {
namespace {

std::string htmlPage(const std::string& title, const std::string& body) {
  static constexpr const char* kStyle = R"(
body { font: 1rem/1.6 serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem }
summary { cursor: pointer }
.step { margin: 1.2rem 0 } .step > summary { font-weight: bold }
.equation { display: flex; align-items: center; gap: .6rem }
.equation math { font-size: 1.1em; overflow-x: auto; overflow-y: hidden; padding: .2rem 0; flex: 1 }
.equation button { font-size: .7rem; opacity: .6 }
.holds, .fails { font-size: .9rem } .fails { font-weight: bold }
@media print { .equation button, .holds { display: none } }
)";
  // a browser without a clipboard (a file opened from disk in some) shows no buttons
  static constexpr const char* kScript = R"(
if (navigator.clipboard) for (const line of document.querySelectorAll('.equation')) {
  const button = document.createElement('button');
  button.textContent = 'copy LaTeX';
  button.onclick = () => navigator.clipboard.writeText(line.dataset.latex);
  line.append(button);
}
)";
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<style>{2}</style></head>\n<body><h1>{0}</h1>\n{1}<script>{3}</script></body></html>\n",
      title, body, kStyle, kScript);
}

std::string latexDocument(const std::string& title, const std::string& body) {
  return fmt::format(
      "\\documentclass{{article}}\n"
      "\\usepackage[T1]{{fontenc}}\n\\usepackage[utf8]{{inputenc}}\n\\usepackage{{amsmath}}\n"
      "\\usepackage[a4paper, margin=25mm]{{geometry}}\n"
      "% an equation is a paragraph, so that long ones are broken at their signs\n"
      "\\newcommand{{\\hangpara}}{{\\hangindent=2em\\hangafter=1\\noindent\\hspace*{{1em}}}}\n"
      "\\binoppenalty=100 \\relpenalty=50 \\allowdisplaybreaks\n"
      "\\setlength{{\\parindent}}{{0pt}}\\setlength{{\\parskip}}{{0.4em}}\n"
      "\\title{{{0}}}\\date{{}}\n"
      "\\begin{{document}}\n\\maketitle\\raggedright\n{1}\\end{{document}}\n",
      title, body);
}

/// "q1=theta"
std::vector<std::pair<std::string, std::string>> pairsOf(const std::vector<std::string>& words) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const std::string& word : words) {
    const std::size_t sign = word.find('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == word.size())
      throw scene::InputError(
          {}, fmt::format("--rename: read '{}', allowed: q1=NAME, such as q1=theta", word));
    pairs.emplace_back(word.substr(0, sign), word.substr(sign + 1));
  }
  return pairs;
}

std::string quantityOf(const ShownDerivation& asked) {
  static const std::vector<std::string> kAllowed = {"M", "c", "g", "all"};
  const std::string quantity = asked.quantities[0];
  if (asked.quantities.size() != 1 ||
      std::find(kAllowed.begin(), kAllowed.end(), quantity) == kAllowed.end())
    throw scene::InputError(
        {}, fmt::format("--quantity: read '{}', allowed for a derivation: one of M, c, g, all; "
                        "others are code: --format c, python, matlab, julia",
                        fmt::join(asked.quantities, ",")));
  return quantity;
}

}  // namespace

DerivationText derivationText(const scene::Scene& scene, const ShownDerivation& asked) {
  const std::string quantity = quantityOf(asked);
  const auto names = pairsOf(asked.names);
  symbolic::Derivation shown = symbolic::derivation(
      asked.substitutions.empty() ? scene.mechanism
                                  : scene::substituted(scene.mechanism, asked.substitutions),
      asked.linearized);
  DerivationText out;
  out.holds = shown.holds();
  if (quantity != "all") shown = symbolic::onlyQuantity(shown, quantity);
  if (!asked.only.empty()) shown = symbolic::only(shown, asked.only);
  if (!names.empty()) shown = symbolic::renamed(shown, names);
  if (!asked.substitutions.empty() && !shown.steps.empty())
    shown.steps.front().sentence +=
        fmt::format(" Put in: {}.", fmt::join(asked.substitutions, ", "));

  const symbolic::Style style = asked.format == "html"    ? symbolic::Style::kMathml
                                : asked.format == "latex" ? symbolic::Style::kLatex
                                                          : symbolic::Style::kText;
  const std::string body = symbolic::print(shown, style, asked.checks),
                    title = symbolic::printText(scene.title, style);
  out.text = style == symbolic::Style::kText     ? body
             : style == symbolic::Style::kMathml ? htmlPage(title, body)
                                                 : latexDocument(title, body);
  if (!asked.proof) return out;
  const symbolic::ReadBack read = symbolic::readBack(shown, out.text, style);
  out.problem = read.problem;
  out.proof = fmt::format(
      "read back from what is printed: {} formulas are what was derived, at {} random "
      "points modulo 2^61 - 1 (another formula passes with a chance below {:.0g})\n",
      read.formulas, read.points, symbolic::kReadBackChance);
  return out;
}

}  // namespace dynwitness::cli
