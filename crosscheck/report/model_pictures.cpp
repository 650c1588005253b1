// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/model_pictures.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "crosscheck/report/page_sections.hpp"
#include "crosscheck/report/page_words.hpp"
#include "scene/error.hpp"
#include "scene/text_file.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;

const char* const kWhat = "JSON of `dynwitness reduce --front FOLDER` or `dynwitness need`";

/// Three digits, rounded up: what is printed is still a bound. @param x  percent
std::string bound(double x) {
  if (!(x > 0)) return "0";
  const double unit = std::pow(10, std::floor(std::log10(x)) - 2);
  return fmt::format("{:.3g}", std::ceil(x / unit) * unit);
}

/// The step of an axis up to `most` that has some five of them: 1, 2 or 5 times a power of ten.
double tickOf(double most) {
  const double rough = most / 5, unit = std::pow(10, std::floor(std::log10(rough)));
  for (const double times : {1.0, 2.0, 5.0})
    if (times * unit >= rough) return times * unit;
  return 10 * unit;
}

/// A model of a front: its certified error in percent, and what it takes.
struct Point {
  double error;
  int operations;
};

std::vector<Point> pointsOf(const Json& models) {
  std::vector<Point> out;
  for (const Json& m : models)
    out.push_back({100 * m.at("certified").get<double>(), m.at("operations").get<int>()});
  return out;
}

/// Operations against certified error, two curves and the scene's own program.
class FrontDrawing {
 public:
  FrontDrawing(int full, double most) : full_(full) {
    const double tick = tickOf(most), high = tickOf(full_);
    most_ = std::ceil(most / tick) * tick;
    line("axis", 0, 0, most_, 0);
    line("axis", 0, 0, 0, full_ * kHead);
    for (int k = 0; k <= std::lround(most_ / tick); ++k) {
      line("axis", k * tick, 0, k * tick, -0.015 * full_);
      text(k * tick, 0, 0, 18, "middle", fmt::format("{:.3g}", k * tick));
    }
    for (int k = 1; k * high <= full_; ++k) {
      line("axis", 0, k * high, -0.006 * most_, k * high);
      text(0, k * high, -10, 4, "end", fmt::format("{:.6g}", k * high));
    }
    text(most_ / 2, 0, 0, 38, "middle",
         "error of a joint force at most, proven  [% of its largest]");
    text(0, full_ * kHead, -46, -8, "start", "operations of inverse dynamics");
    line("theory", 0, full_, most_, full_);
    text(most_, full_, 0, -7, "end", fmt::format("the scene's own program: {}", full_));
  }
  void curve(const std::vector<Point>& points, bool is_square, const std::string& words) {
    std::string path;
    const Point* before = nullptr;
    for (const Point& p : points) {
      // a smaller error allows all that a larger one does: a staircase
      if (before) path += fmt::format("H{:.1f}", x(p.error));
      path += fmt::format("{}{}", before ? "V" : fmt::format("M{:.1f},", x(p.error)),
                          fmt::format("{:.1f}", y(p.operations)));
      before = &p;
    }
    svg_ += fmt::format("<path class=\"{}\" d=\"{}\"/>", is_square ? "curve two" : "curve", path);
    for (const Point& p : points) {
      const std::string title =
          fmt::format("<title>{} operations, {} %</title>", p.operations, bound(p.error));
      svg_ += is_square ? fmt::format(
                              "<rect class=\"others\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"8\" "
                              "height=\"8\">{}</rect>",
                              x(p.error) - 4, y(p.operations) - 4, title)
                        : fmt::format(
                              "<circle class=\"ours\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\">{}"
                              "</circle>",
                              x(p.error), y(p.operations), title);
    }
    if (before)
      text(before->error, before->operations, 10, is_square ? 14 : -6, "start",
           fmt::format("{}: {}", words, before->operations));
  }
  std::string svg(const std::string& title) const {
    return fmt::format(
        "<svg class=\"dial models\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {} {}\" "
        "width=\"{}\" height=\"{}\">{}</svg>",
        esc(title), kWidth, kHeight, kWidth, kHeight, svg_);
  }

 private:
  static constexpr double kWidth = 760, kHeight = 340, kLeft = 56, kRight = 190, kTop = 34,
                          kBottom = 50;  // [px]
  static constexpr double kHead = 1.08;  // above the scene's own program

  double x(double error) const { return kLeft + error / most_ * (kWidth - kLeft - kRight); }
  double y(double operations) const {
    return kHeight - kBottom - operations / (full_ * kHead) * (kHeight - kTop - kBottom);
  }
  void line(const char* what, double x1, double y1, double x2, double y2) {
    svg_ +=
        fmt::format("<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>",
                    what, x(x1), y(y1), x(x2), y(y2));
  }
  void text(double at, double operations, double dx, double dy, const char* anchor,
            const std::string& words) {
    svg_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>", x(at) + dx,
                        y(operations) + dy, anchor, esc(words));
  }

  int full_;
  double most_ = 1;  ///< right end of the axis [%]
  std::string svg_;
};

std::string frontHtml(const Json& front, const std::string& file) {
  const Json& models = front.at("models");
  if (models.size() < 2)
    throw scene::InputError({file, 0},
                            "one model alone, allowed: several, as "
                            "`dynwitness reduce --front FOLDER --json FILE` writes them");
  if (front.value("of", "tau") != "tau")
    throw scene::InputError({file, 0},
                            "models whose accelerations are near, allowed: those whose "
                            "forces are, of `dynwitness reduce --front` without --of");
  const int full = front.at("operations").get<int>();
  const std::vector<Point> scenes = pointsOf(front.at("as_scenes")), all = pointsOf(models);
  double most = 0;
  for (const auto* points : {&scenes, &all})
    for (const Point& p : *points) most = std::max(most, p.error);
  if (!(most > 0) || full <= 0)
    throw scene::InputError({file, 0},
                            "no model errs, or the scene takes no operation: nothing to "
                            "draw");
  FrontDrawing drawing(full, most);
  drawing.curve(scenes, false, "a smaller scene");
  drawing.curve(all, true, "and terms added");
  std::string page = "<figure>\n";
  openScroll(&page, "Operations against certified error");
  page += drawing.svg("Operations of inverse dynamics against certified error");
  put(&page,
      "</div>\n<figcaption>Each mark is a model that takes fewer operations than the scene's own "
      "program, {}. Below it on the axis stands what it may miss of any joint's force, everywhere in the "
      "ranges of q, q̇ and q̈ of [envelope]: proven by <code>dynwitness reduce</code> {}, not "
      "sampled. ● scenes that have lost inertial parameters; □ such scenes with terms "
      "added to their forces.</figcaption>\n</figure>\n",
      full, esc(front.at("dynwitness").get<std::string>()));
  openScroll(&page, "Models of the front");
  page +=
      "<table><thead><tr><th scope=\"col\" class=\"n\">Allowed</th><th scope=\"col\" class=\"n\">"
      "Operations</th><th scope=\"col\" class=\"n\">Proven</th><th scope=\"col\" class=\"n\">As a "
      "scene</th><th scope=\"col\" class=\"n\">Proven</th></tr></thead>\n<tbody>\n";
  for (std::size_t k = 0; k < models.size() && k < scenes.size(); ++k)
    put(&page,
        "<tr><td class=\"n\">{:.3g} %</td><td class=\"n\">{}</td><td class=\"n\">{} %</td><td "
        "class=\"n\">{}</td><td class=\"n\">{} %</td></tr>\n",
        100 * models[k].at("allowed").get<double>(), all[k].operations, bound(all[k].error),
        scenes[k].operations, bound(scenes[k].error));
  return page + "</tbody></table></div>\n";
}

/// A bar of a share from 0 to 1, and words behind it.
std::string bar(double share, const std::string& words) {
  constexpr double kLong = 150, kHigh = 12;
  return fmt::format(
      "<svg class=\"dial models\" viewBox=\"0 0 {0} 16\" width=\"{0}\" height=\"16\" role=\"img\" "
      "aria-label=\"{1}\"><rect class=\"ours\" x=\"0\" y=\"2\" width=\"{2:.1f}\" height=\"{3}\"/>"
      "<text x=\"{4:.1f}\" y=\"12\">{1}</text></svg>",
      kLong + 70, esc(words), std::max(1.0, share * kLong), kHigh, share * kLong + 8);
}

std::string ladderHtml(const Json& ladder) {
  const Json& rungs = ladder.at("rungs");
  double most = 1, worst = 0;
  for (const Json& rung : rungs) {
    if (!rung.at("operations").is_null())
      most = std::max(most, rung.at("operations").get<double>());
    const Json& gap = rung.at("misses_of_scene");
    if (!gap.is_null() && !gap.at("share").is_null())
      worst = std::max(worst, gap.at("share").get<double>());
  }
  std::string page;
  openScroll(&page, "Ladder of models");
  put(&page,
      "<table><caption><span>From point masses to the scene, along {} s of its own motion, by "
      "<code>dynwitness need</code> {}: what each rung costs, and what it misses at worst of a "
      "joint's force, in % of that joint's largest.</span></caption>\n<thead><tr><th "
      "scope=\"col\">Rung</th><th scope=\"col\">Operations</th><th scope=\"col\">Forces that it "
      "misses</th><th scope=\"col\" class=\"n\">Moves as the scene for</th></tr></thead>\n<tbody>\n",
      ladder.at("duration_s").get<double>(), esc(ladder.at("dynwitness").get<std::string>()));
  for (const Json& rung : rungs) {
    const Json &gap = rung.at("misses_of_scene"), &motion = rung.at("motion");
    const bool is_all = !gap.is_null() && gap.at("share").is_null();
    const double share = gap.is_null() || is_all ? 0 : gap.at("share").get<double>();
    const bool has_count = !rung.at("operations").is_null();
    const int operations = has_count ? rung.at("operations").get<int>() : 0;
    put(&page,
        "<tr><th scope=\"row\">{}{}</th><td>{}</td><td>{}</td><td class=\"n\">{}</td></tr>\n",
        &rung == &rungs.front() ? "" : "+ ", esc(rung.at("adds").get<std::string>()),
        has_count ? bar(operations / most, std::to_string(operations)) : "–",
        is_all ? bar(1, "all")
               : bar(worst > 0 ? share / worst : 0, fmt::format("{:.3g} %", 100 * share)),
        motion.is_null() ? "–" : fmt::format("{:.3g} s", motion.at("follows_s").get<double>()));
  }
  return page + "</tbody></table></div>\n";
}

}  // namespace

std::map<std::string, std::string> modelSections(const std::vector<std::string>& files,
                                                 const std::vector<std::string>& scenes) {
  std::map<std::string, std::string> out;
  for (const std::string& file : files) {
    const std::string text = scene::readTextFile(file, kWhat);
    try {
      const Json json = Json::parse(text);
      const std::string scene = json.at("scene").get<std::string>();
      if (std::find(scenes.begin(), scenes.end(), scene) == scenes.end())
        throw scene::InputError(
            {file, 0}, fmt::format("of scene '{}', allowed: {}", scene, fmt::join(scenes, ", ")));
      std::string& section = out[scene];
      if (section.empty()) section = "<h2>How little model</h2>\n";
      section += json.contains("rungs") ? ladderHtml(json) : frontHtml(json, file);
    } catch (const Json::exception& error) {
      throw scene::InputError({file, 0}, fmt::format("{}; expected {}", error.what(), kWhat));
    }
  }
  return out;
}

}  // namespace dynwitness::crosscheck
