// SPDX-License-Identifier: GPL-3.0-or-later
// What a reader should know before any scene: disagreements, digits lost, what was not answered.
#include <algorithm>
#include <utility>
#include <vector>

#include "crosscheck/report/page_sections.hpp"
#include "crosscheck/report/page_words.hpp"
#include "crosscheck/verdicts/causes.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Disagreements listed at the top of the page; the scenes list them all.
constexpr int kTopDisagreements = 25;

}  // namespace

void putDisagreements(std::string* page, const CrosscheckResult& result,
                      const std::vector<SceneFiles>& files) {
  if (result.verdict() != RunVerdict::kDisagree) return;
  put(page,
      "<section aria-labelledby=\"disagreements\">\n<h2 id=\"disagreements\">What "
      "disagrees</h2>\n");
  for (std::size_t i = 0; i < result.scenes.size(); ++i)
    for (const Cause& cause : causesOf(result.scenes[i]))
      put(page,
          "<div class=\"finding\"><p><a href=\"{}\">{}</a>: {} <span class=\"soft\">({})</span>"
          "</p></div>\n",
          files[i].page, esc(sceneTitle(result.scenes[i])), esc(cause.text),
          plural(static_cast<long>(cause.checks.size()), "check"));
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
  put(page, "<details>\n<summary>{}</summary>\n",
      all.size() == 1 ? "The check" : fmt::format("The {} checks", all.size()));
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
        "<tr><th scope=\"row\"><a href=\"{}\">{}</a></th><td>{}<span class=\"sub\">{}</span></td>"
        "<td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"unit\">{}</td>"
        "<td class=\"n\">{}</td><td class=\"nowrap\">{}</td></tr>\n",
        files[all[k].scene].page, esc(sceneTitle(result.scenes[all[k].scene])),
        esc(check.statement.empty() ? check.name() : check.statement),
        esc(quantityWords(check.quantity)), witnessesOf(check), esc(readable(check.worst)),
        esc(limitText(check)), esc(check.unitName()), esc(shareOfLimit(check.ratio)),
        worstAt(check));
  }
  put(page, "</tbody>\n</table>\n</div>\n</details>\n</section>\n");
}

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

}  // namespace dynwitness::crosscheck
