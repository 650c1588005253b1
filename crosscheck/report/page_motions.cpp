// SPDX-License-Identifier: GPL-3.0-or-later
// Published motions of a scene: where the figures come from, and how many of their digits came out.
#include <cmath>

#include "crosscheck/report/page_sections.hpp"
#include "crosscheck/report/page_words.hpp"

namespace dynwitness::crosscheck {
namespace {

void putEntries(std::string* page, const PublishedMotion& motion) {
  openScroll(page, "Table of a published motion");
  put(page,
      "<table>\n<caption><span>Of each value, the time at which it comes nearest to its "
      "limit.</span></caption>\n<thead><tr><th scope=\"col\">Value</th><th scope=\"col\" "
      "class=\"n\">t [s]</th><th scope=\"col\" class=\"n\">{}</th><th scope=\"col\" "
      "class=\"n\">Simulated</th><th scope=\"col\" class=\"n\">Difference</th><th scope=\"col\" "
      "class=\"n\">Limit</th><th scope=\"col\" class=\"n\">Digits</th></tr></thead>\n<tbody>\n",
      motion.own.empty() ? "Published" : "Reference");
  for (const PublishedMotion::Entry& entry : motion.entries)
    put(page,
        "<tr{}><th scope=\"row\">{}</th><td class=\"n\">{}</td><td class=\"n\">{:.12g}</td>"
        "<td class=\"n\">{:.12g}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>"
        "<td class=\"n\">{:.1f}</td></tr>\n",
        entry.difference <= entry.limit ? "" : " class=\"bad\"", esc(entry.of), entry.time,
        entry.published, entry.ours, esc(readable(entry.difference)), esc(readable(entry.limit)),
        entry.digits);
  put(page, "</tbody>\n</table>\n</div>\n");
}

}  // namespace

void putMotions(std::string* page, const SceneResult& scene) {
  if (scene.motions.empty()) return;
  put(page, "<h2>Published motion</h2>\n");
  for (const PublishedMotion& motion : scene.motions) {
    const bool agrees = motion.failure.empty() && motion.ratio <= 1;
    put(page, "<h3>{} {}</h3>\n<dl class=\"meta\">\n", esc(motion.title),
        badge(agrees ? Verdict::kAgree : Verdict::kDisagree,
              agrees ? plural(motion.values, "value") + " agree" : "disagrees"));
    const auto row = [&](const char* term, const std::string& text) {
      if (!text.empty()) put(page, "<dt>{}</dt><dd>{}</dd>\n", term, esc(text));
    };
    row("Source", motion.source);
    row("Figures", motion.own.empty() ? "as printed there" : motion.own);
    row("Limit", motion.note);
    if (!motion.moved.empty())
      row("Moved", "data/reference/motion/" + motion.moved + ", not this scene itself");
    row("Simulated", fmt::format("{} s with {}, error of a step {:.2g}, {} steps", motion.duration,
                                 motion.method, motion.step_error, motion.steps));
    put(page, "</dl>\n");
    if (motion.failure.empty())
      putEntries(page, motion);
    else
      put(page, "<p>{}</p>\n", esc(motion.failure));
  }
}

}  // namespace dynwitness::crosscheck
