// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/page.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "crosscheck/report/page_parts.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/report/tree_svg.hpp"

namespace dynwitness::crosscheck {
namespace {

/// More answered checks than this in one scene start with a digest, and the whole table unfolds.
constexpr int kLongTable = 14;
/// Disagreements listed at the top of the page; the scenes list them all.
constexpr int kTopDisagreements = 25;

std::string esc(std::string_view text) {
  return escapeMarkup(text);
}

/// Appends to the page.
template <typename... Args>
void put(std::string* page, const char* format, const Args&... args) {
  fmt::format_to(std::back_inserter(*page), fmt::runtime(format), args...);
}

// ---- words -------------------------------------------------------------------------------------

std::string plural(long n, const char* word) {
  return fmt::format("{} {}{}", n, word, n == 1 ? "" : "s");
}

const char* cssClass(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAgree:
      return "agree";
    case Verdict::kDisagree:
      return "disagree";
    case Verdict::kNotAnswerable:
      break;
  }
  return "none";
}

const char* cssClass(RunVerdict verdict) {
  switch (verdict) {
    case RunVerdict::kAgree:
      return "agree";
    case RunVerdict::kNotAnswerable:
      return "none";
    case RunVerdict::kIncomplete:
    case RunVerdict::kProvesNothing:
    case RunVerdict::kDisagree:
      break;
  }
  return "disagree";
}

std::string badge(Verdict verdict, const std::string& word) {
  return crosscheck::badge(cssClass(verdict), word);
}

/// A quantity in words, as the headings of the check tables say it; names we do not know stay.
std::string quantityWords(const std::string& quantity) {
  static const std::map<std::string, const char*> kWords = {
      {"M", "M, mass matrix"},          {"c", "c, velocity products"},
      {"g", "g, gravity and springs"},  {"tau", "tau, inverse dynamics"},
      {"qdd", "qdd, forward dynamics"}, {"energy", "energy along simulated motion"},
      {"kinetic", "kinetic energy"},    {"potential", "potential energy"},
      {"momentum", "momentum"},         {"reactions", "reactions"},
  };
  const auto found = kWords.find(quantity);
  return found != kWords.end() ? found->second : quantity.empty() ? "other" : quantity;
}

std::string witnesses(const CheckResult& check) {
  if (check.right.empty()) return esc(check.left);
  return esc(check.left) + " <span class=\"soft\">and</span> " + esc(check.right);
}

bool answered(const CheckResult& check) {
  return check.verdict != Verdict::kNotAnswerable;
}

/// For sorting: disagreements first, then what is nearest to its limit. NaN is worse than any
/// number; a limit that contains a known loss says nothing about rounding, and comes last.
double severity(const CheckResult& check) {
  if (!answered(check)) return -1;
  if (check.known_loss && check.verdict == Verdict::kAgree) return 0;
  if (std::isnan(check.ratio)) return std::numeric_limits<double>::infinity();
  return check.ratio + (check.verdict == Verdict::kDisagree ? 1e6 : 0);
}

struct SceneCounts {
  int agree = 0, disagree = 0, not_answerable = 0;
  const CheckResult* worst = nullptr;

  int answered() const { return agree + disagree; }
  Verdict verdict() const {
    if (disagree > 0) return Verdict::kDisagree;
    return agree > 0 ? Verdict::kAgree : Verdict::kNotAnswerable;
  }
};

SceneCounts count(const SceneResult& scene) {
  SceneCounts counts;
  for (const CheckResult& check : scene.checks) {
    switch (check.verdict) {
      case Verdict::kAgree:
        ++counts.agree;
        break;
      case Verdict::kDisagree:
        ++counts.disagree;
        break;
      case Verdict::kNotAnswerable:
        ++counts.not_answerable;
        continue;
    }
    if (counts.worst == nullptr || severity(check) > severity(*counts.worst)) counts.worst = &check;
  }
  return counts;
}

std::string sceneTitle(const SceneResult& scene) {
  return scene.title.empty() ? scene.name : scene.title;
}

// ---- pieces ------------------------------------------------------------------------------------

std::string share(const CheckResult& check) {
  const bool over = !(check.ratio <= 1);
  const double part = over ? 100 : std::max(0.0, 100 * check.ratio);
  return fmt::format(
      R"(<span class="bar{}" aria-hidden="true"><i style="--part:{:.1f}%"></i></span><span class="percent">{}</span>)",
      over ? " over" : "", part, esc(shareOfLimit(check.ratio)));
}

/// A box that scrolls sideways where the screen is narrower than its content; the keyboard reaches
/// it.
void openScroll(std::string* page, const std::string& label) {
  put(page, "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{}\">\n",
      esc(label));
}

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

void putCheckHead(std::string* page, const std::string& caption) {
  put(page,
      "<table>\n<caption><span>{}</span></caption>\n<thead><tr><th scope=\"col\">Check</th>"
      "<th scope=\"col\">Witnesses</th><th scope=\"col\" class=\"n\">Worst</th>"
      "<th scope=\"col\" class=\"n\">Limit</th><th scope=\"col\">Unit</th>"
      "<th scope=\"col\">Share of the limit</th>"
      "<th scope=\"col\">Worst at</th><th scope=\"col\" class=\"n\">Seed</th>"
      "<th scope=\"col\">Exactly</th><th scope=\"col\">Verdict</th></tr></thead>\n",
      caption);
}

/// False for checks that no random state belongs to, such as the energy drift.
bool drawn(const CheckResult& check) {
  return !check.worst_entry.empty();
}

std::string worstAt(const CheckResult& check) {
  if (!drawn(check)) return "–";
  return fmt::format("{}<span class=\"sub\">state {} of {}</span>", esc(check.worst_entry),
                     check.worst_state, check.states);
}

/// The verdict over the prime field, or a dash where the check has none (an engine, a table).
std::string exactly(const CheckResult& check) {
  if (!check.exact)
    return check.no_exact.empty()
               ? "–"
               : fmt::format("–<span class=\"sub\">{}</span>", esc(check.no_exact));
  return fmt::format("{}<span class=\"sub\">{} point{}, chance {}</span>",
                     check.exact->residual_zero ? "zero" : "<strong>not zero</strong>",
                     check.exact->points, check.exact->points == 1 ? "" : "s",
                     esc(readable(check.exact->error_probability)));
}

void putCheckRow(std::string* page, const CheckResult& check) {
  const bool bad = check.verdict == Verdict::kDisagree;
  const std::string name = check.name();
  const std::string statement = check.statement.empty() ? name : check.statement;
  put(page, "<tr{}><th scope=\"row\" class=\"statement\">{}", bad ? " class=\"bad\"" : "",
      esc(statement));
  if (statement != name) put(page, "<span class=\"sub\">{}</span>", esc(name));
  if (bad && !check.reason.empty())
    put(page, "<span class=\"sub reason\">{}</span>", esc(check.reason));
  if (check.voided > 0) put(page, "<span class=\"sub\">{}</span>", esc(voidedText(check)));
  put(page,
      "</th><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"unit\">{}</td>"
      "<td class=\"share\">{}</td><td class=\"nowrap\">{}</td><td "
      "class=\"n\">{}</td><td class=\"nowrap\">{}</td><td>{}</td></tr>\n",
      witnesses(check), esc(readable(check.worst)), esc(limitText(check)),
      esc(crosscheck::name(check.unit)), share(check), worstAt(check),
      drawn(check) ? std::to_string(check.seed) : "–", exactly(check),
      badge(check.verdict, crosscheck::name(check.verdict)));
}

using Rows = std::vector<const CheckResult*>;

/// Checks in groups of one quantity, quantities in the order in which the scene has them.
void putCheckTable(std::string* page, const Rows& rows, const std::string& caption) {
  std::vector<std::string> quantities;
  for (const CheckResult* check : rows)
    if (std::find(quantities.begin(), quantities.end(), check->quantity) == quantities.end())
      quantities.push_back(check->quantity);
  openScroll(page, "Table of checks");
  putCheckHead(page, esc(caption));
  for (const std::string& quantity : quantities) {
    Rows group;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(group),
                 [&](const CheckResult* c) { return c->quantity == quantity; });
    std::stable_sort(group.begin(), group.end(), [](const CheckResult* a, const CheckResult* b) {
      return severity(*a) > severity(*b);
    });
    put(page, "<tbody>\n<tr class=\"group\"><th scope=\"rowgroup\" colspan=\"10\">{}</th></tr>\n",
        esc(quantityWords(quantity)));
    for (const CheckResult* check : group) putCheckRow(page, *check);
    put(page, "</tbody>\n");
  }
  put(page, "</table>\n</div>\n");
}

/// What stands at the top when there are many: the worst of each quantity, and every disagreement.
Rows digest(const Rows& rows) {
  std::map<std::string, const CheckResult*> worst;
  for (const CheckResult* check : rows) {
    const CheckResult*& entry = worst[check->quantity];
    if (entry == nullptr || severity(*check) > severity(*entry)) entry = check;
  }
  Rows short_list;
  for (const CheckResult* check : rows)
    if (worst[check->quantity] == check || check->verdict == Verdict::kDisagree)
      short_list.push_back(check);
  return short_list;
}

// ---- sections ----------------------------------------------------------------------------------

void putHead(std::string* page, const CrosscheckResult& result, const Environment& environment) {
  const char* sign = exitStatus(result.verdict()) == 0 ? "✓" : "✗";
  *page += pageHead(sign + (" " + result.headline()), environment.version, treeStyle(), "scenes",
                    "Skip to the scenes");
}

void putVerdict(std::string* page, const CrosscheckResult& result, const Environment& environment) {
  const std::string headline = result.headline();
  const std::size_t cut = headline.find("; ");
  const char* css = cssClass(result.verdict());
  put(page,
      "<main>\n<header id=\"top\">\n<p class=\"eyebrow\"><strong>dynwitness</strong> crosscheck of "
      "robot dynamics</p>\n<div class=\"verdict {}\">{}\n<h1><span>{}</span>",
      css, icon(css), esc(headline.substr(0, cut)));
  if (cut != std::string::npos)
    put(page, " <span class=\"detail\">{}</span>", esc(headline.substr(cut + 2)));
  put(page, "</h1></div>\n<ul class=\"facts\">\n");
  if (const int n = result.count(Verdict::kDisagree); n > 0)
    put(page, "<li><b>{}</b> disagree</li>\n", n);
  put(page, "<li><b>{}</b> agree</li>\n", result.count(Verdict::kAgree));
  put(page, "<li><b>{}</b> not answerable</li>\n", result.count(Verdict::kNotAnswerable));
  const auto present = std::count_if(result.witnesses.begin(), result.witnesses.end(),
                                     [](const WitnessInfo& w) { return w.present; });
  put(page, "<li><b>{}</b> witness{}</li>\n", present, present == 1 ? "" : "es");
  put(page, "<li><b>{}</b> random state{} a scene</li>\n<li>seed <b>{}</b></li>\n", result.states,
      result.states == 1 ? "" : "s", result.seed);
  put(page, "<li>{}</li>\n</ul>\n<p class=\"soft small\">{}{}</p>\n</header>\n",
      esc(environment.date),
      badge(result.controlMissed() ? Verdict::kDisagree : Verdict::kAgree,
            result.controlMissed() ? "control missed" : "control") +
          " ",
      esc(result.controlLine().substr(std::string("control: ").size())));  // the badge says it
}

void putDisagreements(std::string* page, const CrosscheckResult& result,
                      const std::vector<SceneFiles>& files) {
  if (result.verdict() != RunVerdict::kDisagree) return;
  put(page,
      "<section aria-labelledby=\"disagreements\">\n<h2 id=\"disagreements\">What "
      "disagrees</h2>\n");
  for (std::size_t i = 0; i < result.scenes.size(); ++i) {
    const SceneResult& scene = result.scenes[i];
    for (const Finding& finding : scene.findings) {
      if (finding.kind != Finding::Kind::kDisagreement) continue;
      put(page, "<div class=\"finding\"><p class=\"who\">");
      if (!finding.witness.empty())
        put(page, "{} stands alone", esc(finding.witness));
      else
        put(page, "No single witness stands alone");
      put(page,
          " <span class=\"soft\">in</span> {} <span class=\"soft\">of</span> "
          "<a href=\"#{}\">{}</a></p><p>{}</p></div>\n",
          esc(finding.quantity), files[i].anchor, esc(sceneTitle(scene)), esc(finding.text));
    }
  }
  struct Entry {
    std::size_t scene;
    const CheckResult* check;
  };
  std::vector<Entry> all;
  for (std::size_t i = 0; i < result.scenes.size(); ++i)
    for (const CheckResult& check : result.scenes[i].checks)
      if (check.verdict == Verdict::kDisagree) all.push_back({i, &check});
  std::stable_sort(all.begin(), all.end(), [](const Entry& a, const Entry& b) {
    return severity(*a.check) > severity(*b.check);
  });
  const std::size_t shown = std::min<std::size_t>(all.size(), kTopDisagreements);
  openScroll(page, "Table of disagreements");
  put(page,
      "<table>\n<caption><span>{}</span></caption>\n<thead><tr><th scope=\"col\">Scene</th><th "
      "scope=\"col\">Check"
      "</th><th scope=\"col\">Witnesses</th><th scope=\"col\" class=\"n\">Worst</th>"
      "<th scope=\"col\" class=\"n\">Limit</th><th scope=\"col\">Unit</th>"
      "<th scope=\"col\" class=\"n\">Beyond it</th>"
      "<th scope=\"col\">Worst at</th></tr></thead>\n<tbody>\n",
      shown < all.size()
          ? fmt::format("The worst {} of {} disagreements; each scene lists its own in full.",
                        shown, all.size())
          : "Checks beyond their limit, worst first.");
  for (std::size_t k = 0; k < shown; ++k) {
    const CheckResult& check = *all[k].check;
    put(page,
        "<tr><th scope=\"row\"><a href=\"#{}\">{}</a></th><td>{}<span class=\"sub\">{}</span></td>"
        "<td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"unit\">{}</td>"
        "<td class=\"n\">{}</td><td class=\"nowrap\">{}</td></tr>\n",
        files[all[k].scene].anchor, esc(sceneTitle(result.scenes[all[k].scene])),
        esc(check.statement.empty() ? check.name() : check.statement),
        esc(quantityWords(check.quantity)), witnesses(check), esc(readable(check.worst)),
        esc(limitText(check)), esc(crosscheck::name(check.unit)), esc(shareOfLimit(check.ratio)),
        worstAt(check));
  }
  put(page, "</tbody>\n</table>\n</div>\n</section>\n");
}

/// Who loses digits that its algorithm need not lose: how many, why, and what removes it.
void putKnownLosses(std::string* page, const CrosscheckResult& result) {
  const std::vector<CrosscheckResult::KnownLoss> losses = result.knownLosses();
  if (losses.empty()) return;
  put(page, "<section aria-labelledby=\"losses\">\n<h2 id=\"losses\">Digits lost, and why</h2>\n");
  for (const CrosscheckResult::KnownLoss& loss : losses) {
    put(page,
        "<div class=\"finding loss\"><p class=\"who\">{} <span class=\"soft\">in</span> {}</p>"
        "<p>Worst in {}.</p><dl class=\"meta\">",
        esc(loss.witness->name), plural(loss.scenes, "scene"), esc(loss.worst->text));
    for (const auto& [term, label] : {std::pair{"Cause", "known loss"}, {"Remedy", "remedy"}})
      if (const std::string text = loss.witness->convention(label); !text.empty())
        put(page, "<dt>{}</dt><dd>{}</dd>", term, esc(text));
    put(page, "</dl></div>\n");
  }
  put(page, "</section>\n");
}

/// What was not answered, by quantity, and why; what ought to be and was not comes first.
void putCoverage(std::string* page, const CrosscheckResult& result) {
  std::vector<Coverage> gaps;
  for (const Coverage& coverage : result.coverage())
    if (coverage.voided > 0) gaps.push_back(coverage);
  if (gaps.empty()) return;
  std::stable_sort(gaps.begin(), gaps.end(),
                   [](const Coverage& a, const Coverage& b) { return a.missing() > b.missing(); });
  put(page, "<section aria-labelledby=\"coverage\">\n<h2 id=\"coverage\">Not answered</h2>\n");
  const std::vector<std::string> thin = result.thinlyCovered();
  if (!thin.empty()) {
    put(page,
        "<div class=\"finding\"><p>More than a tenth of the comparisons that ought to be possible "
        "is "
        "missing:</p><ul class=\"reasons\">");
    for (const std::string& one : thin) put(page, "<li>{}</li>", esc(one));
    put(page, "</ul></div>\n");
  }
  openScroll(page, "Table of comparisons not answered");
  put(page,
      "<table>\n"
      "<caption><span>A comparison is one check at one state. Those at which the quantity does not "
      "exist are excused; the others ought to be possible.</span></caption>\n<thead><tr>"
      "<th scope=\"col\">Quantity</th><th scope=\"col\" class=\"n\">Comparisons</th>"
      "<th scope=\"col\" class=\"n\">Not answered</th><th scope=\"col\" class=\"n\">of these "
      "excused</th>"
      "<th scope=\"col\">The first</th></tr></thead>\n<tbody>\n");
  for (const Coverage& gap : gaps)
    put(page,
        "<tr><th scope=\"row\">{}</th><td class=\"n\">{}</td><td class=\"n\">{}</td>"
        "<td class=\"n\">{}</td><td>{}</td></tr>\n",
        esc(quantityWords(gap.quantity)), gap.asked, gap.voided, gap.excused, esc(gap.reason));
  put(page, "</tbody>\n</table>\n</div>\n</section>\n");
}

void putSceneTable(std::string* page, const CrosscheckResult& result,
                   const std::vector<SceneFiles>& files) {
  put(page, "<section aria-labelledby=\"scenes\">\n<h2 id=\"scenes\">Scenes</h2>\n");
  openScroll(page, "Table of scenes");
  put(page,
      "<table>\n<caption><span>Each scene, with the check that comes nearest to its "
      "limit.</span></caption>\n"
      "<thead><tr><th scope=\"col\">Scene</th><th scope=\"col\">Verdict</th>"
      "<th scope=\"col\" class=\"n\">Degrees of<br>freedom</th><th scope=\"col\" "
      "class=\"n\">Links</th>"
      "<th scope=\"col\" class=\"n\">Checks</th><th scope=\"col\" "
      "class=\"n\">Not<br>answerable</th>"
      "<th scope=\"col\">Nearest to its limit</th><th scope=\"col\">in the "
      "check</th></tr></thead>\n"
      "<tbody>\n");
  for (std::size_t i = 0; i < result.scenes.size(); ++i) {
    const SceneResult& scene = result.scenes[i];
    const SceneCounts counts = count(scene);
    const std::string word = counts.disagree > 0 ? fmt::format("{} disagree", counts.disagree)
                             : counts.agree > 0  ? "all agree"
                                                 : "not answerable";
    put(page,
        "<tr{}><th scope=\"row\"><a href=\"#{}\">{}</a><span "
        "class=\"sub\">{}</span></th><td>{}</td>"
        "<td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td "
        "class=\"n\">{}</td>",
        counts.disagree > 0 ? " class=\"bad\"" : "", files[i].anchor, esc(sceneTitle(scene)),
        esc(scene.name), badge(counts.verdict(), word), scene.dof, scene.links, counts.answered(),
        counts.not_answerable == 0 ? "–" : std::to_string(counts.not_answerable));
    if (counts.worst != nullptr)
      put(page,
          "<td class=\"share\">{}<span class=\"sub\">{}</span></td><td class=\"which\">{} "
          "<span class=\"soft\">{}</span><span class=\"sub\">{}</span></td></tr>\n",
          share(*counts.worst), esc(worstOfLimit(*counts.worst)), esc(counts.worst->quantity),
          esc(counts.worst->name()), witnesses(*counts.worst));
    else
      put(page, "<td>–</td><td>–</td></tr>\n");
  }
  put(page, "</tbody>\n</table>\n</div>\n</section>\n");
}

void putHowToRead(std::string* page) {
  put(page,
      "<section aria-labelledby=\"reading\">\n<h2 id=\"reading\">How to read this</h2>\n"
      "<p>Independent computations, the <em>witnesses</em>, answer the same questions about a "
      "mechanism, and each <em>check</em> compares two answers or asks one witness for an identity "
      "of "
      "mechanics, at random <em>states</em> (positions, velocities, accelerations or forces). "
      "Every "
      "state is a function of scene, seed and index, so the seed draws it again. A residual is "
      "counted "
      "in <em>ulp</em>: 1 ulp is 2<sup>−52</sup> of the largest number compared, the spacing of "
      "double precision. Its <em>limit</em> is not tuned: it is a running bound of the "
      "rounding errors of that very computation at that very state. A residual above its limit "
      "cannot "
      "be rounding; then somebody is wrong. Where ulp is not the measure, the unit says what is: a "
      "published table, for instance, is held to its last printed digit.</p>\n"
      "<p>The column <em>exactly</em> asks another question: is it the same mathematics? Both "
      "sides "
      "are computed once more over the integers modulo a 63-bit prime, with random points of the "
      "circle for the joint angles. There is no rounding there: the residual is zero or it is not, "
      "and <em>chance</em> bounds how probable it is that different formulas pass all points.</p>\n"
      "<p>How many <em>digits</em> survive is counted against a certified truth: our sweeps in "
      "ball "
      "arithmetic, which encloses the exact number, with the precision doubled until the "
      "enclosure is "
      "below 2<sup>−80</sup> of it. The check <em>truth</em> holds each witness to its own error "
      "bound "
      "there.</p>\n"
      "<p>A state at which a check has no bound, no truth or no answer of a witness is left out "
      "of that check "
      "and counted. Every run carries its own <em>control</em>: a witness whose kilogram is too "
      "heavy, by "
      "1e-10 where rounding leaves room for that. It is judged by the same code and has to be "
      "found, in every "
      "quantity of every scene; otherwise the run proves nothing.</p>\n"
      "</section>\n");
}

/// The convention card of a witness: lines of "label: text".
void putConventions(std::string* page, const std::string& conventions) {
  put(page, "<details><summary>conventions</summary><dl>");
  for (std::size_t begin = 0; begin < conventions.size();) {
    const std::size_t end = std::min(conventions.find('\n', begin), conventions.size());
    const std::string line = conventions.substr(begin, end - begin);
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos)
      put(page, "<dd>{}</dd>", esc(line));
    else
      put(page, "<dt>{}</dt><dd>{}</dd>", esc(line.substr(0, colon)), esc(line.substr(colon + 2)));
    begin = end + 1;
  }
  put(page, "</dl></details>");
}

void putWitnesses(std::string* page, const CrosscheckResult& result) {
  put(page, "<section aria-labelledby=\"witnesses\">\n<h2 id=\"witnesses\">Witnesses</h2>\n");
  openScroll(page, "Table of witnesses");
  put(page,
      "<table>\n<caption><span>Who testifies, and how each one "
      "computes.</span></caption>\n<thead><tr>"
      "<th scope=\"col\">Witness</th><th scope=\"col\">Version</th><th scope=\"col\">How it "
      "computes"
      "</th></tr></thead>\n<tbody>\n");
  for (const WitnessInfo& witness : result.witnesses) {
    put(page, "<tr><th scope=\"row\">{}</th><td class=\"nowrap\">{}</td><td>{}", esc(witness.name),
        witness.version.empty() ? "–" : esc(witness.version), esc(witness.method));
    if (!witness.present)
      put(page, " {}",
          badge(Verdict::kNotAnswerable,
                "absent: " + (witness.absent.empty() ? "not found when dynwitness was built"
                                                     : witness.absent)));
    if (!witness.conventions.empty()) putConventions(page, witness.conventions);
    put(page, "</td></tr>\n");
  }
  put(page, "</tbody>\n</table>\n</div>\n</section>\n");
}

void putTree(std::string* page, const SceneResult& scene, const SceneFiles& files) {
  const std::string svg = treeSvg(scene, SvgUse::kInPage);
  put(page, "<h3>Mechanism</h3>\n");
  if (svg.empty() || files.tree.empty()) {
    put(page, "<p class=\"soft\">{}: too many for a picture.</p>\n", esc(treeSentence(scene)));
    return;
  }
  put(page, "<figure>\n");
  openScroll(page, "Picture of the mechanism");
  *page += svg;
  put(page,
      "</div>\n<figcaption>{}. <a href=\"{}\">Picture as a file</a></figcaption>\n</figure>\n",
      esc(treeSentence(scene)), files.tree);
}

void putEquations(std::string* page, const SceneResult& scene) {
  const Equations& equations = scene.equations;
  const bool shown =
      !equations.kinetic.empty() || !equations.potential.empty() || !equations.lines.empty();
  if (!shown && equations.summary.empty()) return;
  put(page, "<h3>Equations</h3>\n");
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
    put(page, "<h4>Kinetic energy</h4>\n");
    formula(equations.kinetic);
  }
  if (!equations.potential.empty()) {
    put(page, "<h4>Potential energy</h4>\n");
    formula(equations.potential);
  }
  if (!equations.lines.empty()) {
    put(page, "<h4>M(q) q̈ + c(q, q̇) + g(q) = τ, with</h4>\n");
    for (const std::string& line : equations.lines) formula(line);
  }
  put(page, "</div>\n</div>\n");
}

void putChecks(std::string* page, const SceneResult& scene) {
  put(page, "<h3>Checks</h3>\n");
  Rows rows;
  for (const CheckResult& check : scene.checks)
    if (answered(check)) rows.push_back(&check);
  if (rows.empty()) put(page, "<p>No check of this scene could be answered.</p>\n");
  if (static_cast<int>(rows.size()) > kLongTable) {
    putCheckTable(
        page, digest(rows),
        "For each quantity the check that comes nearest to its limit, and every disagreement.");
    put(page, "<details>\n<summary>All {} checks</summary>\n", rows.size());
    putCheckTable(page, rows,
                  "All checks; in each quantity those nearest to their limit come first.");
    put(page, "</details>\n");
  } else if (!rows.empty()) {
    putCheckTable(page, rows,
                  "All checks; in each quantity those nearest to their limit come first.");
  }

  // what could not be asked, by reason
  std::vector<std::pair<std::string, std::vector<std::string>>> reasons;
  int total = 0;
  for (const CheckResult& check : scene.checks) {
    if (answered(check)) continue;
    ++total;
    auto at = std::find_if(reasons.begin(), reasons.end(),
                           [&](const auto& entry) { return entry.first == check.reason; });
    if (at == reasons.end()) at = reasons.insert(reasons.end(), {check.reason, {}});
    at->second.push_back(describe(check));
  }
  if (reasons.empty()) return;
  put(page, "<details>\n<summary>{} not answerable</summary>\n<ul class=\"reasons\">\n",
      plural(total, "check"));
  for (const auto& [reason, checks] : reasons) {
    put(page, "<li>{}<br><span class=\"soft\">", esc(reason.empty() ? "no reason given" : reason));
    for (std::size_t i = 0; i < checks.size(); ++i)
      put(page, "{}{}", i > 0 ? "; " : "", esc(checks[i]));
    put(page, "</span></li>\n");
  }
  put(page, "</ul>\n</details>\n");
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
  put(page, "<h3>Digits kept</h3>\n");
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

void putDrift(std::string* page, const SceneResult& scene, const SceneFiles& files) {
  if (!scene.drift) return;
  const Drift& drift = *scene.drift;
  put(page, "<h3>Energy drift</h3>\n");
  std::string sentence = fmt::format(
      "Largest |E − E₀| along a path of {} s, as a share of the largest kinetic energy "
      "({:.3g} J), integrated with {}.",
      drift.duration, drift.scale, drift.method);
  if (std::isfinite(drift.observed_order) && drift.observed_order > 0)
    sentence += fmt::format(" Observed order {:.2f}; the method promises {}.", drift.observed_order,
                            drift.method_order);
  if (!drift.paths.empty()) {
    const Drift::Path& finest = *std::min_element(
        drift.paths.begin(), drift.paths.end(),
        [](const Drift::Path& a, const Drift::Path& b) { return a.step < b.step; });
    sentence +=
        fmt::format(" At the finest step, {} s, it is {}.", finest.step, readable(finest.worst));
  }
  put(page, "<figure class=\"charts\">\n");
  if (!files.drift_light.empty()) {
    openScroll(page, "Charts of the energy drift");
    put(page,
        "<picture><source media=\"screen and (prefers-color-scheme: dark)\" srcset=\"{}\">"
        "<img src=\"{}\" width=\"1000\" height=\"400\" alt=\"Two charts. Left: energy error "
        "against "
        "time, one curve a step size. Right: worst error against step size. "
        "{}\"></picture>\n</div>\n",
        files.drift_dark, files.drift_light, esc(sentence));
  } else {
    put(page, "<p class=\"soft\">The plot was left out: {}. Its data are there.</p>\n",
        esc(files.no_plot_reason));
  }
  put(page,
      "<figcaption>{} Data: <a href=\"{}\">along the paths</a>, <a href=\"{}\">worst of each "
      "step</a>",
      esc(sentence), files.drift_csv, files.drift_worst_csv);
  if (!files.drift_script.empty())
    put(page, "; <a href=\"{}\">gnuplot script</a>", files.drift_script);
  put(page, ".</figcaption>\n</figure>\n");
}

/// No number of the chart is on the page: times differ from run to run, and the page does not.
void putChart(std::string* page, const SceneFiles& files) {
  if (files.chart_csv.empty()) return;
  put(page, "<h3>Speed against accuracy</h3>\n<figure class=\"charts\">\n");
  if (!files.chart_light.empty()) {
    openScroll(page, "Charts of speed against accuracy");
    put(page,
        "<picture><source media=\"screen and (prefers-color-scheme: dark)\" srcset=\"{}\">"
        "<img src=\"{}\" width=\"1000\" height=\"480\" alt=\"Two charts, time of one evaluation "
        "against worst relative error. Left: the sweep in five arithmetics. Right: every method in "
        "double. The numbers are in the data file.\"></picture>\n</div>\n",
        files.chart_dark, files.chart_light);
  } else {
    put(page, "<p class=\"soft\">The plot was left out: {}. Its data are there.</p>\n",
        esc(files.no_chart_reason));
  }
  put(page,
      "<figcaption>tau, inverse dynamics: each method's time and its worst error against the "
      "certified truth; lower left is better. Times are of this machine and of this run, and "
      "nothing here is judged by them. Data: <a href=\"{}\">all methods</a>; <a "
      "href=\"{}\">gnuplot "
      "script</a>.</figcaption>\n</figure>\n",
      files.chart_csv, files.chart_script);
}

void putScene(std::string* page, const SceneResult& scene, const SceneFiles& files) {
  const SceneCounts counts = count(scene);
  std::string word =
      counts.disagree > 0
          ? fmt::format("{} of {} disagree", counts.disagree, plural(counts.answered(), "check"))
      : counts.agree > 0 ? (counts.agree == 1 ? "1 check, agrees"
                                              : fmt::format("{} checks, all agree", counts.agree))
                         : "not answerable";
  put(page,
      "<section class=\"scene\" aria-labelledby=\"{0}\">\n<h2 id=\"{0}\">{1} <code>{2}</code> "
      "{3}</h2>\n",
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
  for (const Finding& finding : scene.findings)
    put(page, "<div class=\"finding{}\"><p>{}{}</p></div>\n",
        finding.kind == Finding::Kind::kKnownLoss ? " loss" : "", esc(finding.text),
        finding.kind == Finding::Kind::kKnownLoss ? " <a href=\"#losses\">Why</a>" : "");
  putTree(page, scene, files);
  putEquations(page, scene);
  putChecks(page, scene);
  putControls(page, scene);
  putDigits(page, scene);
  putDrift(page, scene, files);
  putChart(page, files);
  put(page, "<p class=\"top\"><a href=\"#scenes\">All scenes</a></p>\n</section>\n");
}

void putFooter(std::string* page, const CrosscheckResult& result, const Environment& environment) {
  put(page,
      "</main>\n<footer>\n<h2>Compute it again</h2>\n<pre tabindex=\"0\"><code>{}</code></pre>\n"
      "<dl class=\"meta\">\n<dt>dynwitness</dt><dd>{}{}</dd>\n",
      esc(result.command), esc(environment.version),
      environment.commit.empty() ? "" : ", commit " + esc(environment.commit));
  put(page, "<dt>Compiler</dt><dd>{}</dd>\n", esc(environment.compiler));
  if (!environment.flags.empty())
    put(page, "<dt>Flags</dt><dd><code>{}</code></dd>\n", esc(environment.flags));
  std::string libraries;
  for (const Environment::Library& library : environment.libraries)
    libraries += fmt::format("{}{} {}", libraries.empty() ? "" : ", ", esc(library.name),
                             esc(library.version));
  put(page, "<dt>Libraries</dt><dd>{}</dd>\n<dt>CPU</dt><dd>{}</dd>\n<dt>Date</dt><dd>{}</dd>\n",
      libraries, esc(environment.cpu), esc(environment.date));
  put(page,
      "<dt>Seed</dt><dd>{}</dd>\n<dt>States</dt><dd>{} a scene</dd>\n"
      "<dt>For programs</dt><dd><a href=\"report.json\">report.json</a>, "
      "<a href=\"junit.xml\">junit.xml</a>, "
      "<a href=\"digits.md\">digits.md</a></dd>\n</dl>\n</footer>\n</body>\n</html>\n",
      result.seed, result.states);
}

}  // namespace

std::string reportPage(const CrosscheckResult& result, const Environment& environment,
                       const std::vector<SceneFiles>& files, const std::string& speed) {
  std::string page;
  putHead(&page, result, environment);
  putVerdict(&page, result, environment);
  putDisagreements(&page, result, files);
  putKnownLosses(&page, result);
  putCoverage(&page, result);
  putSceneTable(&page, result, files);
  putHowToRead(&page);
  putWitnesses(&page, result);
  page += speed;
  for (std::size_t i = 0; i < result.scenes.size(); ++i)
    putScene(&page, result.scenes[i], files[i]);
  putFooter(&page, result, environment);
  return page;
}

}  // namespace dynwitness::crosscheck
