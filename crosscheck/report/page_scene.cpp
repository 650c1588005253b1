// SPDX-License-Identifier: GPL-3.0-or-later
// The section of one scene: what it is, its equations, and all that was found about it.
#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "crosscheck/report/ledger_report.hpp"
#include "crosscheck/report/page_sections.hpp"
#include "crosscheck/report/page_words.hpp"
#include "crosscheck/report/tree_svg.hpp"
#include "crosscheck/verdicts/causes.hpp"

namespace dynwitness::crosscheck {
namespace {

/// MathML as it is. Text that is no markup is shown as text.
std::string math(const std::string& formula) {
  const std::string clean = cleanText(formula);
  const std::size_t first = clean.find_first_not_of(" \n\t\r");
  if (first == std::string::npos) return {};
  if (clean.compare(first, 5, "<math") == 0) return clean;
  if (clean[first] == '<')
    return "<math xmlns=\"http://www.w3.org/1998/Math/MathML\" display=\"block\">" + clean +
           "</math>";
  return "<code>" + esc(clean) + "</code>";
}

void putTree(std::string* page, const SceneResult& scene, const SceneFiles& files) {
  const std::string svg = treeSvg(scene, SvgUse::kInPage);
  put(page, "<h2>Mechanism</h2>\n");
  const std::string view =
      files.view.empty() ? ""
                         : fmt::format(" <a href=\"{}\">In space, to be moved</a>", files.view);
  if (svg.empty() || files.tree.empty()) {
    put(page, "<p class=\"soft\">{}: too many for a picture.{}</p>\n", esc(treeSentence(scene)),
        view);
    return;
  }
  put(page, "<figure>\n");
  openScroll(page, "Picture of the mechanism");
  *page += svg;
  put(page,
      "</div>\n<figcaption>{}. <a href=\"{}\">Picture as a file</a>{}</figcaption>\n</figure>\n",
      esc(treeSentence(scene)), files.tree, view);
}

void putEquations(std::string* page, const SceneResult& scene) {
  const Equations& equations = scene.equations;
  const bool shown =
      !equations.kinetic.empty() || !equations.potential.empty() || !equations.lines.empty();
  if (!shown && equations.summary.empty()) return;
  put(page, "<h2>Equations</h2>\n");
  if (!equations.summary.empty())
    put(page, "<p class=\"soft small\">{}{}</p>\n", esc(equations.summary),
        shown ? "" : "; too long to read, so they are not shown");
  if (!shown) return;
  openScroll(page, "Equations");
  put(page, "<div class=\"equations\">\n");
  const auto formula = [&](const std::string& text) {
    put(page, "<div class=\"equation\">{}</div>\n", math(text));
  };
  if (!equations.kinetic.empty()) {
    put(page, "<h3>Kinetic energy</h3>\n");
    formula(equations.kinetic);
  }
  if (!equations.potential.empty()) {
    put(page, "<h3>Potential energy</h3>\n");
    formula(equations.potential);
  }
  if (!equations.lines.empty()) {
    put(page, "<h3>M(q) q̈ + c(q, q̇) + g(q) = τ, with</h3>\n");
    for (const std::string& line : equations.lines) formula(line);
  }
  put(page, "</div>\n</div>\n");
}

void putLedger(std::string* page, const SceneResult& scene) {
  if (!scene.ledger) return;
  put(page, "<details>\n<summary>Ledger: what the equations of motion take</summary>\n");
  *page += ledgerHtml(*scene.ledger);
  put(page, "</details>\n");
}

std::string wordOf(Road road) {
  return name(road);
}
const std::string& wordOf(const std::string& witness) {
  return witness;
}

/// What of the control says more than "found by all at the usual size".
void putControls(std::string* page, const SceneResult& scene) {
  std::vector<std::string> lines;
  for (const Control& control : scene.controls) {
    std::string line;
    const auto add = [&line](const std::string& more) {
      line += (line.empty() ? "" : "; ") + more;
    };
    const auto joined = [](const auto& words) {
      std::string text;
      for (const auto& word : words) text += (text.empty() ? "" : ", ") + wordOf(word);
      return text;
    };
    if (!control.missed.empty()) add("not found by " + joined(control.missed));
    if (control.size > 1e-10 * 1.5)
      add(fmt::format("found at {:.0e} by {}", control.size, joined(control.found)));
    if (!control.blind.empty()) add("hidden by the limits of pairs with " + joined(control.blind));
    if (!control.nothing.empty()) add("nothing to plant: " + control.nothing);
    if (!line.empty()) lines.push_back(control.quantity + ": " + line);
  }
  if (lines.empty()) return;
  put(page, "<details>\n<summary>Control</summary>\n<ul class=\"reasons\">\n");
  for (const std::string& line : lines) put(page, "<li>{}</li>\n", esc(line));
  put(page, "</ul>\n</details>\n");
}

/// A row a witness and scalar, a column a quantity: worst digits, median below.
void putDigits(std::string* page, const SceneResult& scene) {
  if (scene.digits.empty()) return;
  std::vector<std::string> quantities;
  using Row = std::pair<std::string, Scalar>;  // witness and scalar
  std::vector<Row> rows;
  std::map<std::pair<std::string, Row>, const DigitsResult*> cells;  // by quantity and row
  for (const DigitsResult& d : scene.digits) {
    if (std::find(quantities.begin(), quantities.end(), d.quantity) == quantities.end())
      quantities.push_back(d.quantity);
    const Row row(d.witness, d.scalar);
    if (std::find(rows.begin(), rows.end(), row) == rows.end()) rows.push_back(row);
    cells[{d.quantity, row}] = &d;
  }
  // what is judged comes first, then the other scalars
  std::stable_partition(rows.begin(), rows.end(),
                        [](const Row& row) { return row.second == Scalar::kDouble; });
  put(page, "<h2>Digits kept</h2>\n");
  openScroll(page, "Table of digits");
  put(page,
      "<table class=\"digits\">\n"
      "<caption><span>Correct decimal digits against the certified truth: "
      "the fewest over the states, their median below. A dash: not answered, or the quantity is 0."
      "</span></caption>\n<thead><tr><th scope=\"col\">Witness</th><th scope=\"col\">Scalar</th>");
  for (const std::string& quantity : quantities)
    put(page, "<th scope=\"col\" class=\"n\">{}</th>", esc(quantity));
  put(page, "</tr></thead>\n<tbody>\n");
  for (const Row& row : rows) {
    put(page, "<tr><th scope=\"row\">{}</th><td>{}</td>", esc(row.first), name(row.second));
    for (const std::string& quantity : quantities) {
      const auto found = cells.find({quantity, row});
      if (found == cells.end() || !found->second->worst)
        put(page, "<td class=\"n\">–</td>");
      else
        put(page, "<td class=\"n\">{:.1f}<span class=\"sub\">{:.1f}</span></td>",
            *found->second->worst, *found->second->median);
    }
    put(page, "</tr>\n");
  }
  put(page, "</tbody>\n</table>\n</div>\n");
}

}  // namespace

void putScene(std::string* page, const SceneResult& scene, const SceneFiles& files,
              const std::string& root) {
  const SceneCounts counts = count(scene);
  std::string word =
      counts.disagree > 0
          ? fmt::format("{} of {} disagree", counts.disagree, plural(counts.answered(), "check"))
      : counts.agree > 0 ? (counts.agree == 1 ? "1 check, agrees"
                                              : fmt::format("{} checks, all agree", counts.agree))
                         : "not answerable";
  put(page,
      "<section class=\"scene\" aria-labelledby=\"{0}\">\n<h1 id=\"{0}\">{1} <code>{2}</code> "
      "{3}</h1>\n",
      files.anchor, esc(sceneTitle(scene)), esc(scene.name), badge(counts.verdict(), word));
  put(page, "<dl class=\"meta\">\n<dt>Size</dt><dd>{}, {}</dd>\n",
      scene.dof == 1 ? "1 degree of freedom" : fmt::format("{} degrees of freedom", scene.dof),
      plural(scene.links, "link"));
  if (!scene.source.empty()) put(page, "<dt>Source</dt><dd>{}</dd>\n", esc(scene.source));
  if (!scene.file.empty()) put(page, "<dt>File</dt><dd><code>{}</code></dd>\n", esc(scene.file));
  if (!scene.not_modelled.empty()) {
    std::string list;
    for (const std::string& item : scene.not_modelled) list += (list.empty() ? "" : ", ") + item;
    put(page, "<dt>Not modelled</dt><dd>{}</dd>\n", esc(list));
  }
  put(page, "</dl>\n");
  for (const Cause& cause : causesOf(scene))
    put(page, "<div class=\"finding\"><p>{} <span class=\"soft\">({})</span></p></div>\n",
        esc(cause.text), plural(static_cast<long>(cause.checks.size()), "check"));
  for (const Finding& finding : scene.findings) {
    if (finding.kind == Finding::Kind::kDisagreement) continue;  // a cause
    put(page, "<div class=\"finding{}\"><p>{}{}</p></div>\n",
        finding.kind == Finding::Kind::kKnownLoss ? " loss" : "", esc(finding.text),
        finding.kind == Finding::Kind::kKnownLoss
            ? " <a href=\"" + root + "index.html#losses\">Why</a>"
            : "");
  }
  putTree(page, scene, files);
  putEquations(page, scene);
  putLedger(page, scene);
  *page += files.models;
  putChecks(page, scene);
  putControls(page, scene);
  putDigits(page, scene);
  putMotions(page, scene);
  putDrift(page, scene, files);
  putChart(page, files);
  put(page, "<p class=\"top\"><a href=\"{}index.html#scenes\">All scenes</a></p>\n</section>\n",
      root);
}

}  // namespace dynwitness::crosscheck
