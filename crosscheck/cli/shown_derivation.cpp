// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/shown_derivation.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/cli/latex_drawing.hpp"
#include "crosscheck/exact/equation_zeros.hpp"
#include "crosscheck/exact/ledger.hpp"
#include "crosscheck/exact/newton_euler_steps.hpp"
#include "crosscheck/report/show.hpp"
#include "crosscheck/report/view.hpp"
#include "scene/substitution.hpp"
#include "symbolic/derivation.hpp"
#include "symbolic/read_back.hpp"
#include "symbolic/selection.hpp"
#include "symbolic/sentence.hpp"

namespace dynwitness::cli {
namespace {

constexpr const char* kDerivationCss = R"(
summary { cursor: pointer }
.step { margin: 1.2rem 0 } .step > summary { font-weight: bold }
.equation { display: flex; align-items: center; gap: .6rem }
.formula { flex: 1; min-width: 0; overflow-x: auto; overflow-y: hidden; padding: .2rem 0 .2rem 2.5rem; text-indent: -1.5rem; line-height: 1.9 }
.formula math { font-size: 1.1em; text-indent: 0 }
.equation button { font-size: .7rem; opacity: .6 }
.lines { display: flex; flex-wrap: wrap; column-gap: 1.6rem; font-size: .92em }
.lines .equation { flex: 0 1 auto; min-width: 0 } .group, .values { font-size: .92em }
.lines .formula { padding-left: 1.5rem }
.group { margin: .8rem 0 .2rem }
.holds, .fails { font-size: .9rem } .fails { font-weight: bold }
.columns { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); gap: 2rem }
@media (max-width: 60rem) {
  .columns { display: block } .formula { padding-left: 1.5rem }
  .equation { position: relative } .equation button { display: none; position: absolute; right: 0 }
  .equation:hover button, .equation:focus-within button { display: block; opacity: 1 }
}
@media print {
  .equation button { display: none } .columns { display: block } #picture { height: 8cm }
  .formula { overflow: visible; padding-block: .1rem } .formula math { font-size: 1em }
  summary { color: inherit; padding: 0; list-style: none } .holds { font-size: .8rem; color: var(--soft) }
  .holds > summary, .holds > p { display: inline } .holds > summary::after { content: ": " }
  .step { margin: .9rem 0 } .equation, .holds { break-inside: avoid } .holds { break-before: avoid }
  h2, .group, .step > summary, .step > summary + p { break-after: avoid }
}
)";
// A browser without a clipboard (a file opened from disk in some) shows no buttons. What is folded
// away is printed: paper does not unfold.
constexpr const char* kDerivationScript = R"(
if (navigator.clipboard) for (const line of document.querySelectorAll('.equation')) {
  const button = document.createElement('button');
  button.textContent = 'copy LaTeX';
  button.onclick = () => navigator.clipboard.writeText(line.dataset.latex);
  line.append(button);
}
const unfolded = [];
addEventListener('beforeprint', () => {
  for (const fold of document.querySelectorAll('details:not([open])')) { fold.open = true; unfolded.push(fold); }
});
addEventListener('afterprint', () => { for (const fold of unfolded.splice(0)) fold.open = false; });
)";

/// The mechanism as `show` draws it, what each q means, and below it the steps.
std::string htmlPage(const scene::Scene& scene, const std::string& summary,
                     const std::string& body) {
  return crosscheck::viewPage(
      crosscheck::viewOf(scene), DYNWITNESS_VERSION, "<p class=\"soft\">" + summary + "</p>\n",
      fmt::format("{}<style>{}</style>\n<section>\n<h2>Derivation</h2>\n{}</section>\n"
                  "<script>{}</script>\n",
                  crosscheck::jointsHtml(scene), kDerivationCss, body, kDerivationScript));
}

/// Which joint each q is, as tables that fit on a page; empty: none moves.
std::string latexJoints(const scene::Scene& scene) {
  constexpr std::size_t kRows = 40;  // 174 of a page's 257 mm
  const std::vector<std::string> columns = {"q",    "joint",  "kind", "unit",
                                            "axis", "parent", "child"};
  const auto inLatex = [](const std::string& cell) {
    return symbolic::printSentence(cell, symbolic::Style::kLatex);
  };
  std::string text;
  std::size_t row = 0;
  for (const std::vector<std::string>& joint : crosscheck::jointCells(scene, columns)) {
    if (row++ % kRows == 0)
      text +=
          fmt::format("{}{{\\footnotesize\\begin{{tabular}}{{@{{}}{}@{{}}}}\n{} \\\\\n\\hline\n",
                      row == 1 ? "" : "\\end{tabular}}\n\n", std::string(columns.size(), 'l'),
                      fmt::join(columns, " & "));
    std::vector<std::string> cells(joint.size());
    std::transform(joint.begin(), joint.end(), cells.begin(), inLatex);
    text += fmt::format("{} \\\\\n", fmt::join(cells, " & "));
  }
  return text.empty() ? text : text + "\\end{tabular}}\n\n";
}

std::string latexDocument(const std::string& title, const std::string& body) {
  return fmt::format(
      "\\documentclass{{article}}\n"
      "\\usepackage[T1]{{fontenc}}\n\\usepackage[utf8]{{inputenc}}\n\\usepackage{{amsmath}}\n"
      "\\usepackage[a4paper, margin=20mm]{{geometry}}\n"
      "% an equation is a paragraph, so that long ones are broken at their signs\n"
      "\\newcommand{{\\hangpara}}{{\\hangindent=2em\\hangafter=1\\noindent\\hspace*{{1em}}}}\n"
      "\\binoppenalty=100 \\relpenalty=50 \\allowdisplaybreaks\n"
      "\\setlength{{\\parindent}}{{0pt}}\\setlength{{\\parskip}}{{0.4em}}\n"
      "\\renewcommand{{\\arraystretch}}{{1.3}}\n"
      "\\title{{{0}}}\\date{{}}\n"
      "\\begin{{document}}\n\\maketitle\\raggedright\n{1}\\end{{document}}\n",
      title, body);
}

/// "M13" of the ledger's "M_1,3"
std::string lineName(const std::string& entry) {
  const std::size_t comma = entry.find(',');
  const std::string letter = entry.substr(0, entry.find('_')),
                    first = entry.substr(letter.size() + 1, comma - letter.size() - 1);
  if (comma == std::string::npos) return letter + first;
  const std::string second = entry.substr(comma + 1);
  return letter + first + (first.size() + second.size() > 2 ? "_" : "") + second;
}

/// Why entries of M, c and g that a derivation shows as 0 are 0: the ledger's reasons. Each goes
/// where its entry stands, those with the same reason together.
void explainZeros(const scene::Scene& scene, symbolic::Derivation* derivation) {
  const auto isZero = [](const symbolic::StepEquation& e) {
    return e.right.kind == symbolic::Formula::Kind::kNumber && e.right.number == 0;
  };
  bool has_zeros = false;
  for (const symbolic::Step& step : derivation->steps)
    has_zeros = has_zeros || (!step.quantity.empty() &&
                              (!step.zeros.empty() ||
                               std::any_of(step.equations.begin(), step.equations.end(), isZero)));
  if (!has_zeros) return;
  const crosscheck::LedgerOptions options;
  const crosscheck::EquationZeros zeros =
      crosscheck::equationZeros(scene, options.seed, options.error_probability);
  for (symbolic::Step& step : derivation->steps) {
    if (step.quantity.empty()) continue;
    std::vector<std::string> shown = step.zeros;
    for (const symbolic::StepEquation& e : step.equations)
      if (isZero(e)) shown.push_back(e.left.symbol);
    bool is_explained = false;
    for (const crosscheck::Ledger::Zeros& of : zeros.of)
      for (const crosscheck::Ledger::Zeros::Group& group : of.groups) {
        std::vector<std::string> names;
        for (const std::string& entry : group.entries)
          if (const auto at = std::find(shown.begin(), shown.end(), lineName(entry));
              of.quantity != "c_ijk" && at != shown.end())
            names.push_back(*at);
        if (names.empty()) continue;
        is_explained = true;
        step.remarks.push_back(fmt::format("{} = 0: {}", fmt::join(names, " = "), group.reason));
        for (const std::string& name : names)
          step.zeros.erase(std::remove(step.zeros.begin(), step.zeros.end(), name),
                           step.zeros.end());
      }
    if (!is_explained) continue;
    step.check += fmt::format(
        "; reasons of zeros: each rule at random points modulo primes (one that does not hold "
        "passes with a chance below {:.0g})",
        zeros.error_probability);
    for (const std::string& dispute : zeros.disputes) {
      step.check += "; " + dispute;
      step.holds = false;
    }
  }
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

symbolic::Style styleOf(const std::string& format) {
  return format == "html"    ? symbolic::Style::kMathml
         : format == "latex" ? symbolic::Style::kLatex
                             : symbolic::Style::kText;
}

std::string derivationDocument(const scene::Scene& scene, const symbolic::Derivation& shown,
                               symbolic::Style style, const DocumentParts& parts) {
  const std::string body = symbolic::print(shown, style, parts.checks);
  if (style == symbolic::Style::kText) {
    if (!parts.mechanism) return body;
    return fmt::format("{}: {}\n{}\n{}", scene.name, scene.title, crosscheck::jointsText(scene),
                       body);
  }
  if (style == symbolic::Style::kMathml) return htmlPage(scene, parts.summary, body);
  const std::string mechanism =
      parts.mechanism ? latexDrawing(crosscheck::viewOf(scene)) + latexJoints(scene) : "";
  return latexDocument(symbolic::printText(scene.title, style), mechanism + body);
}

DerivationText derivationText(const scene::Scene& scene, const ShownDerivation& asked) {
  const std::string quantity = quantityOf(asked);
  const auto names = pairsOf(asked.names);
  scene::Scene changed = scene;
  if (!asked.substitutions.empty())
    changed.mechanism = scene::substituted(scene.mechanism, asked.substitutions);
  symbolic::Derivation shown = symbolic::derivation(changed.mechanism, asked.linearized);
  if (!asked.beside.empty()) crosscheck::addNewtonEuler(&shown);
  DerivationText out;
  out.holds = shown.holds();
  if (quantity != "all") shown = symbolic::onlyQuantity(shown, quantity);
  if (!asked.only.empty()) shown = symbolic::only(shown, asked.only);
  explainZeros(changed, &shown);
  out.holds = out.holds && shown.holds();
  if (!names.empty()) shown = symbolic::renamed(shown, names);
  if (asked.shorthand) shown = symbolic::withShorthand(shown);
  if (!asked.substitutions.empty() && !shown.steps.empty())
    shown.steps.front().sentence +=
        fmt::format(" Put in: {}.", fmt::join(asked.substitutions, ", "));

  const symbolic::Style style = styleOf(asked.format);
  DocumentParts parts;
  parts.checks = asked.checks;
  parts.mechanism = asked.only.empty();  // who asks for a line wants that line
  out.text = derivationDocument(changed, shown, style, parts);
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
