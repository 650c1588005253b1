// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <charconv>
#include <iterator>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/audit/audit_report.hpp"
#include "crosscheck/report/ascii_math.hpp"
#include "crosscheck/report/page_parts.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/system/files.hpp"

namespace dynwitness::crosscheck {
namespace {

using audit::Audit;
using audit::Entry;
using audit::Holds;

template <typename... Args>
void put(std::string* page, const char* format, const Args&... args) {
  fmt::format_to(std::back_inserter(*page), fmt::runtime(format), args...);
}

const char* cssClass(Holds holds) {
  switch (holds) {
    case Holds::kTrue:
      return "agree";
    case Holds::kFalse:
      return "disagree";
    case Holds::kUnderCondition:
      break;
  }
  return "none";
}

/// What the chapter does not print cannot be wrong of it.
const char* cssClass(const Entry& entry) {
  return entry.holds == Holds::kFalse && !entry.isPrinted() ? "none" : cssClass(entry.holds);
}

const char* word(const Entry& entry) {
  switch (entry.holds) {
    case Holds::kTrue:
      return "holds";
    case Holds::kFalse:
      return entry.isPrinted() ? "wrong" : "not so";
    case Holds::kUnderCondition:
      break;
  }
  return "under a condition";
}

/// Text with formulas and units: m^2 outside of a formula is a unit.
std::string textWithUnits(const std::string& text) {
  std::string out = textWithMath(text);
  for (std::size_t at = 0; (at = out.find("^2", at)) != std::string::npos;)
    out.replace(at, 2, "\u00b2");
  return out;
}

/// "(15)" for an equation, "" for what has no number.
std::string number(const Entry& entry) {
  return entry.isEquation() ? "(" + entry.id.substr(2) + ")" : "";
}

/// A text that names other entries ("see force_signs") links to them by their titles.
std::string textWithLinks(const Audit& audit, const std::string& text) {
  std::string out = textWithMath(text);
  for (const Entry& entry : audit.entries) {
    if (entry.id.find('_') == std::string::npos) continue;
    for (std::size_t at = 0; (at = out.find("see " + entry.id, at)) != std::string::npos;) {
      const std::string link =
          fmt::format("see <a href=\"#{}\">{}</a>", entry.id, textWithMath(entry.title));
      const char after =
          at + 4 + entry.id.size() < out.size() ? out[at + 4 + entry.id.size()] : ' ';
      if (std::isalnum(static_cast<unsigned char>(after)) || after == '_') {
        at += 4;
        continue;
      }
      out.replace(at, 4 + entry.id.size(), link);
      at += link.size();
    }
  }
  return out;
}

void putStatement(std::string* page, const char* label, const std::string& text,
                  const audit::Outcome& outcome) {
  put(page, "<dt>{}</dt><dd>{}<span class=\"residual\">residual {} [{}]</span></dd>\n", label,
      textWithMath(text), escapeMarkup(outcome.residual), escapeMarkup(outcome.method));
}

/// One of two that stand side by side.
void putSide(std::string* page, const char* css, const char* label, const std::string& text,
             const audit::Outcome& outcome) {
  put(page,
      "<div class=\"{}\"><h4>{}</h4>\n<p>{}<span class=\"residual\">residual {} "
      "[{}]</span></p></div>\n",
      css, label, textWithMath(text), escapeMarkup(outcome.residual), escapeMarkup(outcome.method));
}

/// A whole cell of figures: "-0.5", "4e-05".
bool isNumber(const std::string& cell) {
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc() && end == cell.data() + cell.size();
}

/// Figures stand to the right, under a head that does.
void putNumbers(std::string* page, const Entry& entry) {
  const audit::Numbers& numbers = *entry.numbers;
  put(page,
      "<dt>In numbers</dt><dd id=\"{0}-numbers\">{1}</dd>\n<dd class=\"numbers\"><table "
      "aria-labelledby=\"{0}-numbers\">\n<thead><tr>",
      escapeMarkup(entry.id), textWithUnits(numbers.caption));
  std::vector<const char*> css;
  for (std::size_t k = 0; k < numbers.head.size(); ++k) {
    const bool figures = k > 0 && std::all_of(numbers.rows.begin(), numbers.rows.end(),
                                              [&](const auto& row) { return isNumber(row[k]); });
    css.push_back(figures ? " class=\"n\"" : "");
    put(page, "<th scope=\"col\"{}>{}</th>", css[k], textWithUnits(numbers.head[k]));
  }
  put(page, "</tr></thead>\n<tbody>\n");
  for (const auto& row : numbers.rows) {
    put(page, "<tr>");
    for (std::size_t k = 0; k < row.size(); ++k)
      put(page, "<td{}>{}</td>", css[k], textWithUnits(row[k]));
    put(page, "</tr>\n");
  }
  put(page, "</tbody></table></dd>\n");
}

void putEntry(std::string* page, const Audit& audit, const Entry& entry) {
  put(page,
      "<article class=\"entry {}\" id=\"{}\">\n<h3><span "
      "class=\"id\">{}</span><span>{}</span>{}</h3>\n",
      cssClass(entry), escapeMarkup(entry.id),
      entry.isEquation() ? number(entry) : "§ " + escapeMarkup(entry.section),
      textWithMath(entry.title), badge(cssClass(entry), word(entry)));
  const char* printed = entry.left_open     ? "Left open"
                        : entry.not_printed ? "Not in the chapter"
                                            : "Printed";
  if (entry.residual_corrected) {
    put(page, "<div class=\"sides\">\n");
    putSide(page, cssClass(entry), printed, entry.printed, entry.residual_printed);
    putSide(page, "agree", "Correct", entry.corrected, *entry.residual_corrected);
    put(page, "</div>\n");
  }
  put(page, "<dl>\n");
  if (!entry.residual_corrected) putStatement(page, printed, entry.printed, entry.residual_printed);
  if (entry.residual_condition)
    putStatement(page, "Holds if", entry.condition, *entry.residual_condition);
  if (entry.numbers) putNumbers(page, entry);
  put(page, "<dt>Why</dt><dd>{}</dd>\n<dt>Code</dt><dd><code>{}</code>{}</dd>\n</dl>\n</article>\n",
      textWithLinks(audit, entry.why), escapeMarkup(entry.implemented_in),
      std::string(entry.comparesOurCode() ? ", whose answer was compared, too" : "") +
          (entry.residual_ours && !entry.residual_ours->zero
               ? ": <strong>residual " + escapeMarkup(entry.residual_ours->residual) + "</strong>"
               : ""));
}

/// A list of links to the entries that are wanted.
template <typename Wanted>
void putIndex(std::string* page, const Audit& audit, const char* heading, const Wanted& wanted) {
  if (std::none_of(audit.entries.begin(), audit.entries.end(), wanted)) return;
  put(page, "<h2>{}</h2>\n<ul class=\"index\">\n", heading);
  for (const Entry& entry : audit.entries)
    if (wanted(entry))
      put(page, "<li><a href=\"#{}\">{} {}</a></li>\n", escapeMarkup(entry.id),
          entry.isEquation() ? number(entry) : "§ " + escapeMarkup(entry.section),
          textWithMath(entry.title));
  put(page, "</ul>\n");
}

}  // namespace

std::string auditPage(const Audit& audit, const Environment& environment,
                      const std::string& report) {
  std::string page = pageHead("Audit: " + audit.headline(), environment.version, "", "entries",
                              "Skip to the entries");
  const std::string headline = audit.headline();
  const std::size_t cut = headline.find("; ");
  const char* css = audit.isSound() ? "none" : "disagree";  // what is wrong is the chapter
  put(&page,
      "<main>\n<header id=\"top\">\n<p class=\"eyebrow\"><strong>dynwitness</strong> audit of "
      "{}, {} ({})</p>\n<div class=\"verdict "
      "{}\">{}\n<h1><span>{}</span> "
      "<span class=\"detail\">{}</span></h1></div>\n",
      escapeMarkup(audit.chapter.author), escapeMarkup(audit.chapter.title),
      escapeMarkup(audit.chapter.year), css, icon(css), escapeMarkup(headline.substr(0, cut)),
      escapeMarkup(headline.substr(cut + 2)));
  put(&page, "<p>{}</p>\n",
      audit.isSound()
          ? "Every verdict was computed for this page, and so was every correction: all "
            "corrections hold."
          : "<strong>Not every correction was found to hold</strong>: the entries say which.");
  put(&page, "<details open><summary>By which rule</summary>\n<ul>\n");
  for (const std::string& rule : audit.chapter.criterion)
    put(&page, "<li>{}</li>\n", textWithMath(rule));
  put(&page,
      "</ul></details>\n<details><summary>How to read a residual</summary>\n"
      "<p>Both sides of an equation are computed by different roads, at random points and modulo "
      "random 63-bit primes. There a difference is 0 or it is not, without rounding; “chance of "
      "error” bounds how probable it is that different formulas passed. One point with a "
      "difference "
      "refutes. Inequalities are decided with certified digits.</p>\n"
      "<p>The truth comes from point masses that obey Newton’s law, from positions differentiated "
      "twice, and from linear systems of all bodies and joints together. Symbols: {} is a velocity "
      "or force’s six numbers, linear part first; {} transforms velocities and {} "
      "forces.</p></details>\n"
      "</header>\n",
      textWithMath("`Xd = (v, w)`, `F = (f, m)`"), mathMl("T_V"), mathMl("T_F"));
  const auto printedAnd = [](Holds holds) {
    return [holds](const Entry& entry) { return entry.isPrinted() && entry.holds == holds; };
  };
  putIndex(&page, audit, "Wrong", printedAnd(Holds::kFalse));
  putIndex(&page, audit, "Right under a condition", printedAnd(Holds::kUnderCondition));
  putIndex(&page, audit, "Left open, or not in the chapter: not counted",
           [](const Entry& entry) { return !entry.isPrinted(); });
  put(&page, "<div id=\"entries\"></div>\n");
  std::string section;
  for (const Entry& entry : audit.entries) {
    const std::string chapter = entry.section.substr(0, entry.section.find('.'));
    if (chapter != section) {
      section = chapter;
      const std::string& title = audit.chapter.sections.at(std::stoul(section) - 1);
      put(&page, "<h2>{} {}</h2>\n", escapeMarkup(section), escapeMarkup(title));
    }
    putEntry(&page, audit, entry);
  }
  put(&page,
      "</main>\n<footer>\n<h2>Compute it again</h2>\n<pre tabindex=\"0\"><code>dynwitness audit "
      "--seed "
      "{}</code></pre>\n<dl "
      "class=\"meta\">\n<dt>dynwitness</dt><dd>{}{}</dd>\n<dt>Date</dt><dd>{}</dd>\n"
      "<dt>For programs</dt><dd><a "
      "href=\"audit.json\">audit.json</a></dd>\n{}</dl>\n</footer>\n</body>\n"
      "</html>\n",
      audit.seed, escapeMarkup(environment.version),
      environment.commit.empty() ? "" : ", commit " + escapeMarkup(environment.commit),
      escapeMarkup(environment.date),
      report.empty() ? ""
                     : "<dt>Report</dt><dd><a href=\"" + escapeMarkup(report) +
                           "\">of the crosscheck</a></dd>\n");
  return page;
}

void writeAudit(const Audit& audit, const Environment& environment,
                const std::filesystem::path& folder) {
  requireWritable(folder);
  UnfinishedFolder out(folder);
  out.write("audit.json", auditJson(audit, environment));
  // where the report looks for this page
  const bool beside = std::filesystem::is_regular_file(folder / ".." / "report.json");
  out.write("index.html", auditPage(audit, environment, beside ? "../index.html" : ""));
  out.moveIntoPlace("index.html");
}

}  // namespace dynwitness::crosscheck
