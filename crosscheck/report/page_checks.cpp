// SPDX-License-Identifier: GPL-3.0-or-later
// The checks of a scene: the table, its digest where it is long, and what could not be asked.
#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "crosscheck/report/page_sections.hpp"
#include "crosscheck/report/page_words.hpp"

namespace dynwitness::crosscheck {
namespace {

/// More answered checks than this in one scene start with a digest, and the whole table unfolds.
constexpr int kLongTable = 14;

void putCheckHead(std::string* page, const std::string& caption, bool is_digest) {
  put(page,
      "<table{}>\n<caption><span>{}</span></caption>\n<thead><tr><th scope=\"col\">Check</th>"
      "<th scope=\"col\">Verdict</th><th scope=\"col\">Witnesses</th>"
      "<th scope=\"col\">Worst, of its limit</th><th scope=\"col\">Worst at</th>"
      "<th scope=\"col\">Exactly</th></tr></thead>\n",
      is_digest ? " class=\"digest\"" : "", caption);
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
      "</th><td class=\"nowrap\">{}</td><td>{}</td><td class=\"share\">{}<span "
      "class=\"sub\">{}</span></td><td class=\"at\">{}</td><td class=\"exactly\">{}</td></tr>\n",
      badge(check.verdict, crosscheck::name(check.verdict)), witnessesOf(check), share(check),
      esc(worstOfLimit(check)), worstAt(check), exactly(check));
}

using Rows = std::vector<const CheckResult*>;

/// Checks in groups of one quantity, quantities in the order in which the scene has them.
void putCheckTable(std::string* page, const Rows& rows, const std::string& caption,
                   bool is_digest = false) {
  std::vector<std::string> quantities;
  for (const CheckResult* check : rows)
    if (std::find(quantities.begin(), quantities.end(), check->quantity) == quantities.end())
      quantities.push_back(check->quantity);
  openScroll(page, "Table of checks");
  putCheckHead(page, esc(caption), is_digest);
  for (const std::string& quantity : quantities) {
    Rows group;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(group),
                 [&](const CheckResult* c) { return c->quantity == quantity; });
    std::stable_sort(group.begin(), group.end(), [](const CheckResult* a, const CheckResult* b) {
      return severity(*a) > severity(*b);
    });
    put(page, "<tbody>\n<tr class=\"group\"><th scope=\"rowgroup\" colspan=\"6\">{}</th></tr>\n",
        esc(quantityWords(quantity)));
    for (const CheckResult* check : group) putCheckRow(page, *check);
    put(page, "</tbody>\n");
  }
  put(page, "</table>\n</div>\n");
}

/// What stands at the top when there are many: the worst of each quantity.
Rows digest(const Rows& rows) {
  std::map<std::string, const CheckResult*> worst;
  for (const CheckResult* check : rows) {
    const CheckResult*& entry = worst[check->quantity];
    if (entry == nullptr || severity(*check) > severity(*entry)) entry = check;
  }
  Rows short_list;
  for (const CheckResult* check : rows)
    if (worst[check->quantity] == check) short_list.push_back(check);
  return short_list;
}

/// What could not be asked, by reason.
void putNotAsked(std::string* page, const SceneResult& scene) {
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

}  // namespace

void putChecks(std::string* page, const SceneResult& scene) {
  put(page, "<h2>Checks</h2>\n");
  Rows rows;
  for (const CheckResult& check : scene.checks)
    if (answered(check)) rows.push_back(&check);
  if (rows.empty()) put(page, "<p>No check of this scene could be answered.</p>\n");
  if (static_cast<int>(rows.size()) > kLongTable) {
    putCheckTable(
        page, digest(rows),
        "For each quantity the check that comes nearest to its limit, or is farthest beyond it.",
        true);
    put(page, "<details>\n<summary>All {} checks</summary>\n", rows.size());
    putCheckTable(page, rows,
                  "All checks; in each quantity those nearest to their limit come first.");
    put(page, "</details>\n");
  } else if (!rows.empty()) {
    putCheckTable(page, rows,
                  "All checks; in each quantity those nearest to their limit come first.");
  }
  putNotAsked(page, scene);
}

}  // namespace dynwitness::crosscheck
