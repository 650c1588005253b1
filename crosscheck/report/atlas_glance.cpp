// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/atlas_glance.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "crosscheck/report/page_sections.hpp"
#include "crosscheck/report/page_words.hpp"
#include "scene/error.hpp"
#include "scene/text_file.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kWidth = 240, kHeight = 22, kMargin = 6;  // of the drawing of a dial [px]

enum class Mark { kOurs, kOthers, kFloat, kTheory };

/// At x; shapes differ, and not colours alone.
std::string drawn(Mark mark, double x, const std::string& words) {
  const double y = kHeight / 2;
  const std::string title = "<title>" + esc(words) + "</title>";
  switch (mark) {
    case Mark::kOurs:
      return fmt::format("<circle class=\"ours\" cx=\"{:.1f}\" cy=\"{}\" r=\"3.5\">{}</circle>", x,
                         y, title);
    case Mark::kOthers:
      return fmt::format("<circle class=\"others\" cx=\"{:.1f}\" cy=\"{}\" r=\"4\">{}</circle>", x,
                         y, title);
    case Mark::kFloat:
      return fmt::format(
          "<rect class=\"ours\" x=\"{:.1f}\" y=\"{}\" width=\"5\" height=\"5\">{}</rect>", x - 2.5,
          y - 2.5, title);
    case Mark::kTheory:
      return fmt::format(
          "<line class=\"theory\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"1\" y2=\"{1}\">{2}</line>", x,
          kHeight - 1, title);
  }
  return {};
}

/// A family's dial, from harmless to beyond breakdown, and who breaks where.
class Dial {
 public:
  explicit Dial(const Json& family)
      : from_(std::log(family.at("from").get<double>())),
        to_(std::log(family.at("to").get<double>())) {}
  void put(Mark mark, const Json& severity, const std::string& who) {
    if (severity.is_null()) return;
    const double s = severity.get<double>();
    if (!(s > 0)) return;  // no place on a logarithmic dial
    const double share = std::clamp((std::log(s) - from_) / (to_ - from_), 0.0, 1.0);
    marks_ +=
        drawn(mark, kMargin + share * (kWidth - 2 * kMargin), fmt::format("{}: {:.3g}", who, s));
  }
  std::string svg(const std::string& title) const {
    return fmt::format(
        "<svg class=\"dial\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {} {}\" width=\"{}\" "
        "height=\"{}\"><line class=\"axis\" x1=\"{}\" x2=\"{}\" y1=\"{}\" y2=\"{}\"/>{}</svg>",
        esc(title), kWidth, kHeight, kWidth, kHeight, kMargin, kWidth - kMargin, kHeight / 2,
        kHeight / 2, marks_);
  }

 private:
  double from_, to_;
  std::string marks_;
};

void putFamily(std::string* page, const Json& family) {
  Dial dial(family);
  int asked = 0, survive = 0, silent_ours = 0, silent_others = 0;
  for (const Json& theory : family.at("theories")) {
    const std::string who = "theory of " + theory.at("methods").get<std::string>();
    dial.put(Mark::kTheory, theory.at("breaks_double"), who);
  }
  for (const Json& method : family.at("methods")) {
    if (!method.at("left_out").is_null()) continue;
    const bool is_ours = method.at("is_ours").get<bool>();
    const bool is_double = method.at("numbers") == "double";
    dial.put(!is_double ? Mark::kFloat
             : is_ours  ? Mark::kOurs
                        : Mark::kOthers,
             method.at("breaks_at"), method.at("method").get<std::string>());
    if (!method.at("is_step").get<bool>())
      (is_ours ? silent_ours : silent_others) += method.at("silent").get<int>();
    if (!is_double) continue;
    ++asked;
    survive += method.at("breaks_at").is_null() ? 1 : 0;
  }
  const std::string unit = family.at("unit"), title = family.at("title");
  put(page,
      "<tr><th scope=\"row\">{}<span class=\"sub\">{}{}: {:.2g} to {:.2g}; {}</span></th><td>{}</td>"
      "<td class=\"n\">{} of {}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
      esc(title), esc(family.at("dial").get<std::string>()),
      unit.empty() ? "" : " [" + esc(unit) + "]", family.at("from").get<double>(),
      family.at("to").get<double>(), esc(family.at("quantity").get<std::string>()),
      dial.svg("Where methods break: " + title), survive, asked, silent_ours, silent_others);
}

}  // namespace

std::string atlasSection(const std::filesystem::path& stability_json) {
  const std::string what = "a stability.json that `dynwitness stability` wrote";
  const std::string text = scene::readTextFile(stability_json.string(), what);
  try {
    const Json atlas = Json::parse(text);
    for (const Json& family : atlas.at("families")) {
      const double from = family.at("from").get<double>(), to = family.at("to").get<double>();
      if (from > 0 && to > 0 && from != to) continue;
      throw scene::InputError(
          {stability_json.string(), 0},
          fmt::format("families: {}: from {} to {}, allowed: two different numbers > 0",
                      family.at("title").get<std::string>(), from, to));
    }
    std::string page =
        "<section aria-labelledby=\"atlas\">\n<h2 id=\"atlas\">Where methods fail</h2>\n";
    put(&page,
        "<p>By <code>dynwitness stability</code> {}, whose folder has a page with the pictures, the "
        "theory and the reasons. Each line is a family of mechanisms with one dial, harmless on the "
        "left; a mark stands where fewer than {} digits are left: ● ours, ○ engines, ■ ours in "
        "float, ┆ what theory says. Nothing of the verdict above depends on it. Wrong without a "
        "word: ours {}, engines {}.</p>\n",
        esc(atlas.at("dynwitness").get<std::string>()), atlas.at("fewest_digits").get<int>(),
        atlas.at("silent_ours").get<int>(), atlas.at("silent_others").get<int>());
    openScroll(&page, "Where methods fail");
    page +=
        "<table><thead><tr><th scope=\"col\">Family</th><th scope=\"col\">Who breaks where</th>"
        "<th scope=\"col\">Survive<span class=\"sub\">in double</span></th><th scope=\"col\">Silent"
        "<span class=\"sub\">ours</span></th><th scope=\"col\">Silent<span class=\"sub\">engines"
        "</span></th></tr></thead>\n<tbody>\n";
    for (const Json& family : atlas.at("families")) putFamily(&page, family);
    return page + "</tbody></table></div>\n</section>\n";
  } catch (const Json::exception& error) {
    throw scene::InputError({stability_json.string(), 0},
                            fmt::format("{}; expected {}", error.what(), what));
  }
}

}  // namespace dynwitness::crosscheck
