// SPDX-License-Identifier: GPL-3.0-or-later
// The page around the picture, and the drawing in it that needs no script.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/report/assets.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/report/view.hpp"

namespace dynwitness::crosscheck {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using scene::JointKind;

constexpr double kWidth = 640, kHeight = 480;  // [px]

/// Orthographic, as the script's first view.
class Still {
 public:
  explicit Still(const View& view) : view_(view), in_full_(view.links.size() <= kMostLinksInFull) {
    const Vector3d side = view.up.cross(view.ahead);
    const double c = std::cos(view.azimuth), s = std::sin(view.azimuth);
    const double C = std::cos(view.elevation), S = std::sin(view.elevation);
    right_ = c * side - s * view.ahead;
    toward_ = C * c * view.ahead + C * s * side + S * view.up;
    above_ = toward_.cross(right_);
    scale_ = 0.46 * std::min(kWidth, kHeight) / view.radius;
  }

  Vector2d direction(const Vector3d& v) const {
    return {scale_ * right_.dot(v), -scale_ * above_.dot(v)};
  }
  Vector2d point(const Vector3d& x) const { return direction(x - view_.center); }
  double depth(const Vector3d& x) const { return toward_.dot(x - view_.center); }

  void put(double depth, const std::string& svg) { items_.emplace_back(depth, svg); }
  void line(const Vector3d& a, const Vector3d& b, const char* type) {
    const Vector2d p = point(a), q = point(b);
    if ((p - q).norm() < 0.005) return;  // what two decimals do not show
    if (!in_full_) {
      lines_[type] +=
          fmt::format("M{} {}L{} {}", tenths(p.x()), tenths(p.y()), tenths(q.x()), tenths(q.y()));
      return;
    }
    put((depth(a) + depth(b)) / 2,
        fmt::format(R"svg(<path class="{}" d="M{:.2f} {:.2f}L{:.2f} {:.2f}"/>)svg", type, p.x(),
                    p.y(), q.x(), q.y()));
  }
  void spot(const Vector3d& x, double radius, const char* type) {
    const Vector2d p = point(x);
    put(depth(x), fmt::format(R"svg(<circle class="{}" cx="{:.2f}" cy="{:.2f}" r="{}"/>)svg", type,
                              p.x(), p.y(), radius));
  }
  void text(const Vector3d& x, const std::string& words, const char* type) {
    const Vector2d p = point(x);
    put(kInFront, fmt::format(R"svg(<text class="{}" x="{:.2f}" y="{:.2f}">{}</text>)svg", type,
                              p.x() + 5, p.y() - 5, escapeMarkup(words)));
  }
  /// The unit circle under x = center + u a + v b.
  void ring(const Vector3d& center, const Vector3d& a, const Vector3d& b, const char* type,
            double depth) {
    const Vector2d p = point(center), u = direction(a), v = direction(b);
    put(depth,
        fmt::format(
            R"svg(<circle class="{}" r="1" transform="matrix({:.6g} {:.6g} {:.6g} {:.6g} )svg"
            R"svg({:.6g} {:.6g})"/>)svg",
            type, u.x(), u.y(), v.x(), v.y(), p.x(), p.y()));
  }
  /// The outline is the unit circle under L, where L L' = sum of P P' over the projected half axes.
  void ellipsoid(const Vector3d& center, const Matrix3d& halves, const std::string& type,
                 const std::string& title) {
    constexpr double kLeast = 0.25;  // [px^2]: half a pixel keeps it visible
    double xx = kLeast, xy = 0, yy = kLeast;
    for (int k = 0; k < 3; ++k) {
      const Vector2d P = direction(halves.col(k));
      xx += P.x() * P.x();
      xy += P.x() * P.y();
      yy += P.y() * P.y();
    }
    const double a = std::sqrt(xx), b = xy / a, d = std::sqrt(std::max(yy - b * b, 0.01));
    const Vector2d p = point(center);
    if (!in_full_) {
      // half axes and direction of L L': two half turns of an arc
      const double middle = (xx + yy) / 2, off = std::hypot((xx - yy) / 2, xy);
      const double large = std::sqrt(middle + off),
                   small = std::sqrt(std::max(middle - off, kLeast)),
                   angle = std::atan2(2 * xy, xx - yy) / 2, c = std::cos(angle),
                   s = std::sin(angle);
      const std::string arc = fmt::format("a{} {} {:.0f} 1 0 ", tenths(large), tenths(small),
                                          angle * 180 / static_cast<double>(EIGEN_PI));
      outlines_[type] +=
          fmt::format("M{} {}{}{} {}{}{} {}", tenths(p.x() - large * c), tenths(p.y() - large * s),
                      arc, tenths(2 * large * c), tenths(2 * large * s), arc,
                      tenths(-2 * large * c), tenths(-2 * large * s));
      return;
    }
    put(depth(center),
        fmt::format(R"svg(<g class="{}"><title>{}</title><circle class="outline" r="1" )svg"
                    R"svg(transform="matrix({:.6g} {:.6g} 0 {:.6g} {:.6g} {:.6g})"/></g>)svg",
                    type, escapeMarkup(title), a, b, d, p.x(), p.y()));
    const std::string section = type + " section";
    for (int k = 0; k < 3; ++k)
      ring(center, halves.col(k), halves.col((k + 1) % 3), section.c_str(), depth(center));
  }
  /// What is farther away is drawn first.
  std::string svg() {
    std::stable_sort(items_.begin(), items_.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::string text;
    for (const auto& [depth, item] : items_) text += item + "\n";
    for (const auto& [type, path] : outlines_)
      text += fmt::format("<g class=\"{}\"><path class=\"outline\" d=\"{}\"/></g>\n", type, path);
    for (const auto& [type, path] : lines_)
      text += fmt::format("<path class=\"{}\" d=\"{}\"/>\n", type, path);
    return text;
  }

  static constexpr double kInFront = 1e300, kBehind = -1e300;

 private:
  static std::string tenths(double x) { return fmt::format("{:g}", std::round(10 * x) / 10); }

  const View& view_;
  bool in_full_;
  std::map<std::string, std::string> lines_, outlines_;  ///< of many links: one path a kind
  Vector3d right_, toward_, above_;
  double scale_ = 1;
  std::vector<std::pair<double, std::string>> items_;
};

/// @param in_full  with its name, its tip and which way it turns
void drawJoint(const ViewLink& link, const Isometry3d& before, const Isometry3d& moved, double size,
               bool in_full, Still* still) {
  const Vector3d at = moved.translation(), z = before.linear().col(2) * size;
  switch (link.kind) {
    case JointKind::kFixed:
      return;
    case JointKind::kSpherical:
    case JointKind::kFloating:
      still->spot(at, 6, "joint round");
      if (in_full) still->text(at, link.label, "name");
      return;
    case JointKind::kUniversal:
      for (const Vector3d& axis :
           {Vector3d(before.linear().col(0)), Vector3d(moved.linear().col(1))})
        still->line(at - axis * size, at + axis * size, "joint");
      if (in_full) still->text(at, link.label, "name");
      return;
    default:
      break;
  }
  const bool slides = link.kind == JointKind::kPrismatic;
  still->line(at - z, at + z, slides ? "joint slides" : "joint");
  if (!in_full) return;
  if (!slides)
    still->ring(at + 0.6 * z, before.linear().col(0) * 0.4 * size,
                before.linear().col(1) * 0.4 * size, "joint", still->depth(at + 0.6 * z));
  still->spot(at + z, 2.5, "joint tip");
  still->text(at + z, link.label, "name");
}

std::string legend(const View& view) {
  struct Entry {
    const char *svg, *words;
  };
  std::vector<Entry> entries = {
      {R"svg(<path class="link" d="M2 8H26"/>)svg", "link"},
      {R"svg(<path class="joint" d="M2 8H26"/><circle class="joint tip" cx="26" cy="8" r="2.5"/>)svg",
       "axis of a joint that turns, with its q"},
      {R"svg(<path class="joint slides" d="M2 8H26"/>)svg", "of one that slides"},
      {R"svg(<circle class="com" cx="14" cy="8" r="3.5"/>)svg", "centre of mass"},
      {R"svg(<g class="body"><circle class="outline" r="1" transform="matrix(12 0 0 6 14 8)"/></g>)svg",
       "inertia as written: the ellipsoid of uniform density with this mass and inertia"},
      {R"svg(<path class="axis x" d="M2 8H26"/>)svg", "x"},
      {R"svg(<path class="axis y" d="M2 8H26"/>)svg", "y"},
      {R"svg(<path class="axis z" d="M2 8H26"/>)svg", "z"}};
  if (std::any_of(view.bodies.begin(), view.bodies.end(),
                  [](const ViewBody& body) { return !body.who.empty(); }))
    entries.push_back(
        {R"svg(<g class="body read"><circle class="outline" r="1" transform="matrix(12 0 0 6 14 8)"/></g>)svg",
         "inertia as an engine reads it"});
  if (!view.closures.empty())
    entries.push_back(
        {R"svg(<path class="gap" d="M2 8H26"/>)svg", "what a closure holds together"});
  if (!view.springs.empty())
    entries.push_back({R"svg(<path class="spring" d="M2 8H26"/>)svg", "spring or damper"});
  std::string html = "<p class=\"legend\">";
  for (const Entry& entry : entries)
    html += fmt::format(
        "<span><svg class=\"drawn\" width=\"28\" height=\"16\" viewBox=\"0 0 28 16\" "
        "aria-hidden=\"true\">{}</svg> {}</span>\n",
        entry.svg, entry.words);
  return html + "</p>\n";
}

/// Room for the script's chart, and which line is which.
std::string energyChart(const ViewMotion& motion) {
  std::string html =
      "<svg id=\"energy\" class=\"energy\" role=\"img\" aria-label=\"Energy against "
      "time\"></svg>\n<p class=\"legend small\">";
  for (std::size_t k = 0; k < motion.energies.size(); ++k)
    html += fmt::format(
        "<span><svg class=\"energy\" width=\"28\" height=\"16\" viewBox=\"0 0 28 16\" "
        "aria-hidden=\"true\"><path class=\"line{}\" d=\"M2 8H26\"/></svg> {}</span>\n",
        k, escapeMarkup(motion.energies[k].name));
  return html + "</p>\n";
}

}  // namespace

std::string viewSvg(const View& view) {
  std::vector<double> start;
  for (const ViewSlot& slot : view.slots) start.push_back(slot.start);
  const ViewPlaces places = placesOf(view, start);
  Still still(view);
  still.ring(Vector3d::Zero(), view.ahead * 0.6 * view.radius,
             view.up.cross(view.ahead) * 0.6 * view.radius, "floor", Still::kBehind);
  constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  for (std::size_t k = 0; k < kNames.size(); ++k) {
    const Vector3d tip = Vector3d::Unit(static_cast<int>(k)) * 1.6 * view.glyph;
    still.line(Vector3d::Zero(), tip, fmt::format("axis {}", kNames[k]).c_str());
    still.text(tip, kNames[k], fmt::format("letter {}", kNames[k]).c_str());
  }
  const bool in_full = view.links.size() <= kMostLinksInFull;
  for (const ViewBody& body : view.bodies) {
    if (body.mass == 0) continue;
    const Isometry3d& frame = places.link[static_cast<std::size_t>(body.link)];
    const Vector3d com = frame * body.com;
    const std::string& link = view.links[static_cast<std::size_t>(body.link)].name;
    Vector3d halves;
    Matrix3d axes;
    if (!body.inertia.isZero(0)) {
      const bool possible = ellipsoidOf(body, &halves, &axes);
      still.ellipsoid(
          com, frame.linear() * axes * halves.asDiagonal(),
          fmt::format("body{}{}", body.who.empty() ? "" : " read", possible ? "" : " impossible"),
          fmt::format("{}: {:.6g} kg{}", link, body.mass,
                      body.who.empty() ? "" : ", as " + body.who + " reads it"));
    }
    if (!in_full) continue;
    if (body.who.empty()) still.line(frame.translation(), com, "lever");
    still.spot(com, 3.5, body.who.empty() ? "com" : "com read");
  }
  for (std::size_t i = 0; i < view.links.size(); ++i) {
    const ViewLink& link = view.links[i];
    if (link.parent < 0) continue;
    const Vector3d before = places.before[i].translation(), moved = places.moved[i].translation();
    still.line(places.link[static_cast<std::size_t>(link.parent)].translation(), before, "link");
    still.line(before, moved, "slide");
    still.line(moved, places.link[i].translation(), "link");
    drawJoint(link, places.before[i], places.moved[i], view.glyph, in_full, &still);
  }
  const auto drawPair = [&](const ViewPair& pair, const char* type) {
    still.line(places.link[static_cast<std::size_t>(pair.link_a)] * pair.a.translation(),
               places.link[static_cast<std::size_t>(pair.link_b)] * pair.b.translation(), type);
  };
  const auto drawArm = [&](int link, const Isometry3d& end) {
    const auto i = static_cast<std::size_t>(link);
    if (view.links[i].parent >= 0)
      still.line(places.link[i].translation(), places.link[i] * end.translation(), "link");
  };
  for (const auto* pairs : {&view.closures, &view.springs})
    for (const ViewPair& pair : *pairs) {
      drawArm(pair.link_a, pair.a);
      drawArm(pair.link_b, pair.b);
    }
  for (const ViewPair& pair : view.closures) drawPair(pair, pair.is_rod ? "rod" : "gap");
  for (const ViewPair& pair : view.springs) drawPair(pair, "spring");
  return still.svg();
}

std::string viewPage(const View& view, const std::string& version, const std::string& summary,
                     const std::string& facts) {
  const std::string title = escapeMarkup(view.title);
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<meta name=\"generator\" content=\"dynwitness {}\">\n"
      "<title>{}</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>\n{}</style>\n</head>\n<body>\n",
      escapeMarkup(version), title, kViewCss);
  page +=
      fmt::format("<header>\n<h1>{}</h1>\n{}</header>\n<main>\n<div class=\"stage\">\n<figure>\n",
                  title, summary);
  page += fmt::format(
      "<svg id=\"picture\" class=\"drawn\" role=\"img\" aria-label=\"Picture of {}\" "
      "aria-describedby=\"keys\" viewBox=\"{} {} {} {}\">\n{}</svg>\n",
      title, -kWidth / 2, -kHeight / 2, kWidth, kHeight, viewSvg(view));
  page += "<figcaption>\n";
  if (!view.closures.empty())
    page += "<p id=\"gap\">Closures are lines between what they hold together.</p>\n";
  page +=
      "<p id=\"keys\" class=\"keys\">Orbit: drag, or arrow keys. Zoom: wheel, two fingers, + and -. "
      "Pan: Shift with either. 0: as at first.</p>\n" +
      legend(view) +
      "<noscript><p>Without scripts this is a drawing of the start.</p></noscript>\n"
      "</figcaption>\n</figure>\n"
      "<section class=\"controls\" aria-label=\"Controls\">\n<h3>View</h3>\n<div id=\"tools\"></div>\n"
      "<h3>Shown</h3>\n<div id=\"parts\"></div>\n";
  if (view.motion)
    page +=
        "<h3>Motion</h3>\n<button type=\"button\" id=\"play\">Play</button>\n"
        "<input type=\"range\" id=\"time\" min=\"0\" max=\"1\" step=\"1\" value=\"0\" "
        "aria-label=\"time\">\n<p id=\"now\" class=\"small\"></p>\n";
  if (view.motion && !view.motion->energies.empty()) page += energyChart(*view.motion);
  page +=
      "<h3>Joints</h3>\n<div id=\"poses\"></div>\n<div id=\"sliders\"></div>\n</section>\n</div>\n" +
      facts + "</main>\n";
  page +=
      fmt::format("<script type=\"application/json\" id=\"scene\">{}</script>\n", viewJson(view));
  page += fmt::format("<script>\n{}</script>\n</body>\n</html>\n", kViewJs);
  return page;
}

}  // namespace dynwitness::crosscheck
