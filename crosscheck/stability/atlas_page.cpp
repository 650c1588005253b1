// SPDX-License-Identifier: GPL-3.0-or-later
// The atlas as one page: what breaks where at a glance, then a section a family.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/report/page_parts.hpp"
#include "crosscheck/report/page_words.hpp"
#include "crosscheck/stability/atlas_report.hpp"

namespace dynwitness::crosscheck::stability {
namespace {

std::string severityText(double severity) {
  return std::isfinite(severity) ? fmt::format("{:.3g}", severity) : "–";
}

/// What becomes of one group of courses: how many were asked, and where the first and the last
/// break.
struct Group {
  int asked = 0, survive = 0, silent = 0;
  double first = HUGE_VAL, last = 0;

  void add(const Course& course) {
    if (!course.left_out.empty()) return;
    ++asked;
    silent += course.silent();
    if (!course.breaks()) {
      ++survive;
      return;
    }
    first = std::min(first, course.breaks_at);
    last = std::max(last, course.breaks_at);
  }
  std::string words() const {
    if (asked == 0) return "–";
    if (survive == asked) return fmt::format("all {} survive", asked);
    const std::string range =
        first == last ? severityText(first)
                      : fmt::format("{} to {}", severityText(first), severityText(last));
    return survive == 0 ? range : fmt::format("{} of {} survive; {}", survive, asked, range);
  }
};

const char* reasonOf(const Course& course) {
  const std::string verdict = course.verdict();
  if (verdict == "earlier than predicted")
    return "it loses more than the cancellation that the theory is about";
  if (verdict == "later than predicted")
    return "its roundings are fewer or partly exact, or it forms the difference elsewhere";
  if (verdict == "outlasts the theory")
    return "it does not form the difference that the theory is about, or forms it exactly";
  if (verdict == "breaks, not predicted") return "a limit of its own";
  return "";
}

void putGlance(std::string* page, const std::vector<Turned>& atlas) {
  put(page, "<h2 id=\"glance\">At a glance</h2>\n");
  openScroll(page, "Where methods break, by family");
  put(page,
      "<table>\n<caption><span>Severity s from which fewer than {} digits are left, or the method "
      "stops.</span></caption>\n<thead><tr><th>Family</th><th>s is</th><th class=\"n\">theory, "
      "double</th><th>ours, double</th><th>ours, float</th><th>engines</th><th "
      "class=\"n\">silent: ours</th><th class=\"n\">engines</th></tr></thead>\n<tbody>\n",
      kFewestDigits);
  for (const Turned& turned : atlas) {
    const Family& family = familyNamed(turned.family);
    Group ours, in_float, engines;
    for (const Course& course : turned.courses)
      (!course.is_ours ? engines : course.numbers == inDouble().name ? ours : in_float).add(course);
    std::vector<std::string> theories;  // each once: many steps through time have the same
    const auto add = [&](double severity) {
      if (const std::string text = severityText(severity);
          std::find(theories.begin(), theories.end(), text) == theories.end())
        theories.push_back(text);
    };
    for (const Theory& t : family.theories)
      if (t.methods.empty()) add(predictedBreak(family, t, inDouble()));
    for (const Measure& method : family.measures) add(firstBroken(family, method.theory));
    const std::string theory = fmt::format("{}", fmt::join(theories, "<br>"));
    const int silent = ours.silent + in_float.silent;
    put(page,
        "<tr{}><th scope=\"row\"><a href=\"#{}\">{}</a></th><td>{}{}</td><td "
        "class=\"n\">{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"n\">{}</td><td "
        "class=\"n\">{}</td></tr>\n",
        silent > 0 ? " class=\"bad\"" : "", esc(family.name), esc(family.title), esc(family.dial),
        family.unit.empty() ? "" : " [" + esc(family.unit) + "]", theory.empty() ? "none" : theory,
        esc(ours.words()), esc(in_float.words()), esc(engines.words()), silent, engines.silent);
  }
  put(page, "</tbody></table></div>\n");
}

void putFamily(std::string* page, const Turned& turned) {
  const Family& family = familyNamed(turned.family);
  put(page,
      "<section class=\"scene\" id=\"{0}\">\n<h2>{1} <code>{0}</code></h2>\n<p>{2}</p>\n"
      "<p><strong>What survives.</strong> {3}</p>\n",
      esc(family.name), esc(family.title), esc(family.mechanism), esc(family.survivor));
  for (const Theory& theory : family.theories)
    put(page, "<p><strong>{}{}.</strong> {}.</p>\n", theory.isClaimed() ? "Theory" : "No theory",
        !theory.methods.empty()            ? " of " + esc(aboutWords(theory))
        : theory.road == Road::kMassMatrix ? " where M is formed"
        : theory.road == Road::kSweep      ? " of sweeps"
                                           : "",
        esc(theory.formula));
  for (const Measure& method : family.measures)
    put(page, "<p><strong>Theory of {}.</strong> {}.</p>\n", esc(method.name), esc(method.formula));
  put(page,
      "<figure>\n<div class=\"charts scroll\" tabindex=\"0\" role=\"group\" aria-label=\"{0}: "
      "digits against severity\"><img "
      "src=\"{1}.svg\" width=\"1000\" height=\"540\" "
      "alt=\"{0}: decimal digits kept against severity, a line a method, theory dashed; the "
      "numbers are in the table below\"></div>\n<figcaption>A cross below: the method "
      "stops. <a href=\"{1}.csv\">Data</a>, <a href=\"{1}.gp\">script</a>.</figcaption>\n"
      "</figure>\n",
      esc(family.title), esc(family.name));
  openScroll(page, "Breakdown points of " + family.title);
  put(page,
      "<table>\n<thead><tr><th>Method</th><th>numbers</th><th class=\"n\">breaks at s</th><th "
      "class=\"n\">predicted</th><th class=\"n\">ratio</th><th>verdict</th><th>how it "
      "ends</th><th class=\"n\">silent</th></tr></thead>\n<tbody>\n");
  std::map<std::string, std::string> left_out;
  for (const Course& course : turned.courses) {
    if (!course.left_out.empty()) {
      left_out[course.left_out] += (left_out[course.left_out].empty() ? "" : ", ") + course.method;
      continue;
    }
    const double ratio = course.breaks() ? course.ratio() : std::nan("");
    const std::string end = course.end();
    put(page,
        "<tr{}><th scope=\"row\">{}</th><td>{}</td><td class=\"n\">{}</td><td "
        "class=\"n\">{}</td><td class=\"n\">{}</td><td>{}<span class=\"sub\">{}</span></td><td "
        "class=\"which\">{}</td><td class=\"n\">{}</td></tr>\n",
        course.is_ours && course.silent() > 0 ? " class=\"bad\"" : "", esc(course.method),
        esc(course.numbers), severityText(course.breaks_at), severityText(course.predicted),
        std::isfinite(ratio) ? fmt::format("{:.2g}", ratio) : "–", esc(course.verdict()),
        esc(reasonOf(course)),
        !course.breaks() ? "–" : esc(end.empty() ? "digits run out" : end.substr(0, 160)),
        course.silent());
  }
  put(page, "</tbody></table></div>\n");
  if (!left_out.empty()) {
    put(page, "<details><summary>Not asked</summary>\n<ul class=\"reasons\">\n");
    for (const auto& [reason, methods] : left_out)
      put(page, "<li>{}: {}</li>\n", esc(methods), esc(reason.substr(0, 300)));
    put(page, "</ul></details>\n");
  }
  put(page, "<p class=\"top\"><a href=\"#glance\">At a glance</a></p>\n</section>\n");
}

}  // namespace

std::string atlasPage(const std::vector<Turned>& atlas, const std::string& version,
                      const std::string& command) {
  int asked = 0, theories = 0, as_predicted = 0;
  for (const Turned& turned : atlas)
    for (const Course& course : turned.courses) {
      if (!course.left_out.empty()) continue;
      ++asked;
      if (!course.has_theory) continue;
      ++theories;
      if (course.isAsPredicted()) ++as_predicted;
    }
  const int ours = silentOf(atlas, true), others = silentOf(atlas, false);
  const char* css = ours == 0 ? "agree" : "disagree";
  std::string page =
      pageHead("Where methods fail", version, "", "glance", "Skip to the breakdown points");
  put(&page,
      "<main>\n<header id=\"top\">\n<p class=\"eyebrow\"><strong>dynwitness</strong> stability: "
      "where methods fail, and the theory that says so</p>\n<div class=\"verdict {}\">{}\n"
      "<h1><span>{} of {} breakdowns as theory predicts them</span> <span class=\"detail\">within "
      "a factor of two, in {} families and {} courses; wrong without a word: ours, in double and in "
      "float, at {} severities, outside engines at {}</span></h1></div>\n",
      css, icon(css), as_predicted, theories, atlas.size(), asked, ours, others);
  put(&page,
      "<p>A family of mechanisms has one dial, its severity s. Digits are those that a method keeps "
      "of the certified truth (ball arithmetic, precision raised until it is certain), counted of "
      "the largest entry, the worst of {} mechanisms that differ in their numbers alone. A method "
      "has broken where fewer than {} are left or it stops: it throws, dies, or says what is no "
      "number. Roundings are taken at their root mean square: by luck alone the worst of three "
      "mechanisms stays below half of it in 6 of 100 cases, and is above twice it in 13. Where a "
      "method has no theory, its family says why. A wrong answer is silent when nothing told so. Our three textbook sweeps, in "
      "double and in float, and the fast ones tell by sums over their joints, which cost about a tenth "
      "of the sweep, and by an estimate joint by joint where these leave a doubt (<code>"
      "recursive/rounding_filter.hpp</code>); it is too careful at {} severities, where it warns "
      "though {} digits and more are right, most of them where what cancels does so exactly. Our "
      "other methods tell by the bound of their own rounding errors, which costs more than the answer "
      "itself (a run on numbers that carry their bounds); the engines have neither.</p>\n"
      "</header>\n",
      kVariants, kFewestDigits, falseAlarmsOf(atlas), kPlentyOfDigits);
  putGlance(&page, atlas);
  for (const Turned& turned : atlas) putFamily(&page, turned);
  put(&page,
      "</main>\n<footer>\n<h2>Compute it again</h2>\n<pre tabindex=\"0\"><code>{}</code></pre>\n"
      "<dl class=\"meta\">\n<dt>dynwitness</dt><dd>{}</dd>\n<dt>For programs</dt><dd><a "
      "href=\"stability.json\">stability.json</a></dd>\n</dl>\n</footer>\n</body>\n</html>\n",
      esc(command), esc(version));
  return page;
}

}  // namespace dynwitness::crosscheck::stability
