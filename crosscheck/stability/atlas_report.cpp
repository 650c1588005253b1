// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/stability/atlas_report.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "crosscheck/report/plot.hpp"
#include "crosscheck/report/text.hpp"
#include "scene/error.hpp"

namespace dynwitness::crosscheck::stability {
namespace {

using Json = nlohmann::ordered_json;

/// What is asked.
std::string askedOf(const Family& family) {
  if (!family.measures.empty()) return family.measured;
  return family.whole ? crosscheck::name(*family.whole) : crosscheck::name(family.quantity);
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Json numberOrNull(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}
double numberOf(const Json& json) {
  return json.is_null() ? kNone : json.get<double>();
}
Json textOrNull(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}
std::string textOf(const Json& json) {
  return json.is_null() ? std::string() : json.get<std::string>();
}

bool isInFloat(const std::string& method) {
  const std::string end = std::string(" ") + inFloat().name;
  return method.size() > end.size() &&
         method.compare(method.size() - end.size(), end.size(), end) == 0;
}

/// Without a comma, which gnuplot takes for the end of a column in quotes as well.
std::string theoryName(const Theory& theory, const Arithmetic& numbers) {
  if (!theory.methods.empty()) {
    std::string names;
    for (const std::string& method : theory.methods)
      if (isInFloat(method) == (&numbers == &inFloat()))
        names += (names.empty() ? "" : " ") + method;
    return "theory: " + names;
  }
  return theory.road == Road::kAny ? fmt::format("theory: {}", numbers.name)
                                   : fmt::format("theory: {} {}", aboutWords(theory), numbers.name);
}

/// The arithmetics that a theory has a line in: of a road both, of methods theirs.
std::vector<const Arithmetic*> arithmeticsOf(const Theory& theory) {
  if (!theory.isClaimed()) return {};
  std::vector<const Arithmetic*> out;
  for (const Arithmetic* numbers : {&inDouble(), &inFloat()})
    if (theory.methods.empty() ||
        std::any_of(theory.methods.begin(), theory.methods.end(),
                    [&](const std::string& m) { return isInFloat(m) == (numbers == &inFloat()); }))
      out.push_back(numbers);
  return out;
}

/// Whether a panel, of ours or of the engines, has a method that the theory names.
bool isAbout(const Theory& theory, const Turned& turned, bool ours) {
  return theory.methods.empty() ||
         std::any_of(turned.courses.begin(), turned.courses.end(), [&](const Course& course) {
           return course.is_ours == ours && !course.points.empty() &&
                  std::find(theory.methods.begin(), theory.methods.end(), course.method) !=
                      theory.methods.end();
         });
}

struct Look {
  int line = 16;          ///< linetype of style.gp: its colour
  const char* rest = "";  ///< dash and marker, where they are others
};

/// Of a method: no two have the same colour and marker in one panel.
Look lookOf(const std::string& method) {
  static const std::map<std::string, Look> known = {{"lagrange", {1}},
                                                    {"newton_euler", {2}},
                                                    {"composite_body", {2}},
                                                    {"articulated_body", {3}},
                                                    {"fast", {4}},
                                                    {"recursive_lagrange", {5}},
                                                    {"kernel", {6}},
                                                    {"kernel_lanes", {16, "pt 1"}},
                                                    {"hybrid_sweep", {3}},
                                                    {"loops_eliminated", {3}},
                                                    {"lagrange_multipliers", {1}},
                                                    {"dense_system", {2}},
                                                    {"newton_euler float", {2, "dt 3 pt 4"}},
                                                    {"composite_body float", {2, "dt 3 pt 4"}},
                                                    {"articulated_body float", {3, "dt 3 pt 8"}},
                                                    {"explicit_euler", {1}},
                                                    {"runge_kutta4", {2}},
                                                    {"semi_implicit_euler", {3}},
                                                    {"verlet", {4}},
                                                    {"implicit_midpoint", {5}}};
  const auto at = known.find(method);
  if (at != known.end()) return at->second;
  return {lineTypeOfEngine(method).value_or(16)};
}

/// Ticks at powers of ten, few enough to be read.
std::string powersOfTen(double from, double to) {
  static const char* const kRaised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  const int first = static_cast<int>(std::ceil(std::log10(from))),
            last = static_cast<int>(std::floor(std::log10(to)));
  constexpr int kMostTicks = 8;
  int step = 1;
  for (const int wider : {2, 5, 10, 20, 50})
    if ((last - first) / step > kMostTicks) step = wider;
  std::string ticks;
  for (int power = first; power <= last; power += step) {
    std::string raised = power < 0 ? "⁻" : "";
    for (const char digit : std::to_string(std::abs(power))) raised += kRaised[digit - '0'];
    ticks += fmt::format("{}'10{}' 1e{}", ticks.empty() ? "" : ", ", raised, power);
  }
  return ticks;
}

Json courseJson(const Course& course) {
  Json points = Json::array();
  for (const Point& point : course.points)
    points.push_back({{"severity", point.severity},
                      {"digits", numberOrNull(point.digits)},
                      {"stop", textOrNull(point.stop)},
                      {"warned", point.warned}});
  return {{"method", course.method},
          {"numbers", course.numbers},
          {"is_ours", course.is_ours},
          {"is_step", course.is_step},
          {"left_out", textOrNull(course.left_out)},
          {"breaks_at", numberOrNull(course.breaks_at)},
          {"has_theory", course.has_theory},
          {"predicted", numberOrNull(course.predicted)},
          {"ratio", course.breaks() ? numberOrNull(course.ratio()) : Json(nullptr)},
          {"verdict", course.verdict()},
          {"silent", course.silent()},
          {"false_alarms", course.falseAlarms()},
          {"points", points}};
}

Course courseOf(const Json& json) {
  Course course;
  course.method = json.at("method");
  course.numbers = json.at("numbers");
  course.is_ours = json.at("is_ours");
  course.is_step = json.at("is_step");
  course.left_out = textOf(json.at("left_out"));
  course.breaks_at = numberOf(json.at("breaks_at"));
  course.has_theory = json.at("has_theory");
  course.predicted = numberOf(json.at("predicted"));
  for (const Json& point : json.at("points"))
    course.points.push_back({point.at("severity"), numberOf(point.at("digits")),
                             textOf(point.at("stop")), point.at("warned")});
  return course;
}

std::string severityWords(double severity, const std::string& unit) {
  if (!std::isfinite(severity)) return "-";
  return fmt::format("{:.3g}{}{}", severity, unit.empty() ? "" : " ", unit);
}

/// "silent", "warns", "stops"; "-" where nothing breaks.
std::string toldWords(const Course& course) {
  if (!course.breaks() || course.is_step) return "-";
  const int silent = course.silent();
  if (silent > 0) return fmt::format("silent at {}", silent);
  const bool stops = std::all_of(course.points.begin(), course.points.end(),
                                 [](const Point& p) { return !p.isBroken() || !p.stop.empty(); });
  return stops ? "stops" : "warns";
}

}  // namespace

std::string aboutWords(const Theory& theory) {
  if (!theory.methods.empty()) return fmt::format("{}", fmt::join(theory.methods, ", "));
  switch (theory.road) {
    case Road::kMassMatrix:
      return "M formed";
    case Road::kSweep:
      return "swept";
    case Road::kAny:
      break;
  }
  return "all";
}

const Family& familyNamed(const std::string& name) {
  std::string known;
  for (const Family& family : families()) {
    if (family.name == name) return family;
    known += (known.empty() ? "" : ", ") + family.name;
  }
  throw scene::InputError({}, fmt::format("no family '{}'; there are {}", name, known));
}

int silentOf(const std::vector<Turned>& atlas, bool ours) {
  int silent = 0;
  for (const Turned& turned : atlas)
    for (const Course& course : turned.courses)
      if (course.is_ours == ours) silent += course.silent();
  return silent;
}

int falseAlarmsOf(const std::vector<Turned>& atlas) {
  int alarms = 0;
  for (const Turned& turned : atlas)
    for (const Course& course : turned.courses) alarms += course.falseAlarms();
  return alarms;
}

std::string tableOf(const Turned& turned) {
  const Family& family = familyNamed(turned.family);
  std::string text = fmt::format(
      "{}: {}\n  s: {}, {:.3g} to {:.3g}{}{}; asked: {}\n  {:<24} {:>12} {:>12} {:>7}  {:<24} {}\n",
      family.name, family.title, family.dial, family.from, family.to,
      family.unit.empty() ? "" : " ", family.unit, askedOf(family), "method", "breaks at",
      "predicted", "ratio", "", "it says");
  for (const Course& course : turned.courses) {
    if (!course.left_out.empty()) {
      text += fmt::format("  {:<24} not asked: {}\n", course.method, oneLine(course.left_out));
      continue;
    }
    const double ratio = course.breaks() ? course.ratio() : kNone;
    text += fmt::format("  {:<24} {:>12} {:>12} {:>7}  {:<24} {}\n", course.method,
                        severityWords(course.breaks_at, ""), severityWords(course.predicted, ""),
                        std::isfinite(ratio) ? fmt::format("{:.2g}", ratio) : "-", course.verdict(),
                        toldWords(course));
  }
  return text;
}

std::string csvOf(const Turned& turned) {
  const Family& family = familyNamed(turned.family);
  std::string text = fmt::format(
      "# {}: {}\n# severity: {}{}\n# digits of {}: -log10(largest |answer - truth| / largest "
      "|truth|), the truth certified by ball arithmetic; worst of {} mechanisms\n"
      "severity,method,digits,stopped,warned\n",
      family.name, oneLine(family.title), oneLine(family.dial),
      family.unit.empty() ? "" : " [" + family.unit + "]", askedOf(family), kVariants);
  for (const Course& course : turned.courses)
    for (const Point& point : course.points)
      text += fmt::format("{:.6g},{},{},{},{}\n", point.severity, course.method,
                          point.stop.empty() ? fmt::format("{:.2f}", point.digits) : "",
                          point.stop.empty() ? 0 : 1, point.warned ? 1 : 0);
  constexpr int kSamples = 120;
  constexpr double kMostDigits = 17;
  for (const Theory& theory : family.theories)
    for (const Arithmetic* numbers : arithmeticsOf(theory))
      for (int k = 0; k <= kSamples; ++k) {
        const double s =
            family.from * std::pow(family.to / family.from, static_cast<double>(k) / kSamples);
        text += fmt::format("{:.6g},{},{:.2f},0,0\n", s, theoryName(theory, *numbers),
                            std::clamp(-std::log10(theory.error(s, *numbers)), 0.0, kMostDigits));
      }
  for (const Measure& method : family.measures)
    for (int k = 0; k <= kSamples; ++k) {
      const double s =
          family.from * std::pow(family.to / family.from, static_cast<double>(k) / kSamples);
      text += fmt::format("{:.6g},theory: {},{:.2f},0,0\n", s, method.name,
                          std::clamp(-std::log10(method.theory(s)), 0.0, kMostDigits));
    }
  return text;
}

std::string scriptOf(const Turned& turned, const std::string& style) {
  const Family& family = familyNamed(turned.family);
  const std::string file = family.name + ".csv";
  const auto rows = [&](const std::string& method, const char* condition, const char* y) {
    return fmt::format("'{}' using (strcol(2) eq {} && {} ? $1 : NaN):{}", file,
                       gnuplotString(method), condition, y);
  };
  const auto panel = [&](bool ours) {
    std::string plot;
    const auto add = [&](const std::string& part) {
      plot += (plot.empty() ? "plot " : ", \\\n     ") + part;
    };
    for (const Theory& theory : family.theories)
      for (const Arithmetic* numbers : arithmeticsOf(theory)) {
        if (!ours && numbers == &inFloat()) continue;  // engines compute in double
        if (!isAbout(theory, turned, ours)) continue;
        // all lines of an arithmetic look alike: whom each is about, the page says
        const std::string title = fmt::format("theory: {}", numbers->name);
        const bool is_first = plot.find("title " + gnuplotString(title)) == std::string::npos;
        add(fmt::format("{} with lines lt 20 dt {} {}",
                        rows(theoryName(theory, *numbers), "1", "3"),
                        numbers == &inFloat() ? "(2,4)" : "(8,4)",
                        is_first ? "title " + gnuplotString(title) : "notitle"));
      }
    for (const Measure& method : family.measures)
      if (ours)
        add(fmt::format("{} with lines lt 20 {}", rows("theory: " + method.name, "1", "3"),
                        &method == &family.measures.front() ? "title 'theory'" : "notitle"));
    for (const Course& course : turned.courses) {
      if (course.is_ours != ours || course.points.empty()) continue;
      const Look look = lookOf(course.method);
      add(fmt::format("{} with linespoints lt {} {} title {}",
                      rows(course.method, "strlen(strcol(3)) > 0", "3"), look.line, look.rest,
                      gnuplotString(course.method)));
      const bool stops = std::any_of(course.points.begin(), course.points.end(),
                                     [](const Point& point) { return !point.stop.empty(); });
      if (stops)
        add(fmt::format("{} with points lt {} pt 2 ps 0.6 notitle",
                        rows(course.method, "strcol(4) eq '1'", "(stopped)"), look.line));
    }
    return plot.empty() ? std::string("plot NaN notitle") : plot;
  };
  const std::string unit = family.unit.empty() ? "" : " [" + family.unit + "]";
  const bool is_wide = family.to / family.from > std::pow(10.0, 3);
  return fmt::format(
             "# {0}. Draw again with:  gnuplot {1}.gp\n"
             "load '{2}'\n"
             "eval canvas(1000, 540, 13)\n"
             "set output picture_file('{1}')\nset multiplot\n"
             "stopped = -1\nset datafile missing NaN\n"
             "set label 1 {3} at screen 0.5, screen 0.965 center textcolor rgb ink font ',15'\n"
             "set logscale x\nset xrange [{4:g}:{5:g}]\n{6}\n"
             "set yrange [-1.8:17.5]\nset ytics ('stops' stopped, 0, {7}, 6, 9, 12, 15)\n"
             "set arrow 1 from graph 0, first {7} to graph 1, first {7} nohead lc rgb soft lw 0.8\n"
             "set xlabel {8}\nset key font ',11'\n"
             "set tmargin at screen 0.87\nset bmargin at screen 0.36\n",
             oneLine(family.title), family.name, style, gnuplotString(family.title), family.from,
             family.to,
             is_wide ? "set xtics (" + powersOfTen(family.from, family.to) + ")"
                     : "set format x '%g'",
             kFewestDigits, gnuplotString("s: " + family.dial + unit)) +
         fmt::format(
             "set lmargin at screen 0.06\nset rmargin at screen {}\n"
             "set key at screen {}, screen 0.125 center center vertical Left reverse maxrows 5 width -5 samplen 2\n"
             "set title {} textcolor rgb soft\n",
             family.measures.empty() ? 0.485 : 0.985, family.measures.empty() ? 0.26 : 0.5,
             gnuplotString((family.measures.empty() ? "Ours: digits of " : "Digits of ") +
                           askedOf(family))) +
         panel(true) +
         (!family.measures.empty()
              ? std::string()
              : "\nunset label 1\nset key at screen 0.77, screen 0.125\nset lmargin at screen 0.56\nset rmargin at screen 0.985\n"
                "set title 'Outside engines' textcolor rgb soft\n" +
                    panel(false)) +
         "\nunset multiplot\nunset output\n";
}

std::string familyJson(const Turned& turned, const std::string& made_by) {
  Json courses = Json::array();
  for (const Course& course : turned.courses) courses.push_back(courseJson(course));
  return Json({{"made_by", made_by}, {"family", turned.family}, {"methods", courses}}).dump(1) +
         "\n";
}

std::optional<Turned> familyFromJson(const std::string& text, const std::string& made_by) {
  try {
    const Json json = Json::parse(text);
    if (json.at("made_by") != made_by) return std::nullopt;
    Turned turned{json.at("family"), {}};
    for (const Json& course : json.at("methods")) turned.courses.push_back(courseOf(course));
    return turned;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

std::string atlasJson(const std::vector<Turned>& atlas, const std::string& version) {
  Json all = Json::array();
  for (const Turned& turned : atlas) {
    const Family& family = familyNamed(turned.family);
    Json theories = Json::array(), courses = Json::array();
    for (const Theory& theory : family.theories) {
      const auto numbers = arithmeticsOf(theory);
      const auto breaksIn = [&](const Arithmetic& in) {
        const bool has_line = std::find(numbers.begin(), numbers.end(), &in) != numbers.end();
        return has_line ? numberOrNull(predictedBreak(family, theory, in)) : Json(nullptr);
      };
      theories.push_back({{"methods", aboutWords(theory)},
                          {"formula", theory.formula},
                          {"is_claimed", theory.isClaimed()},
                          {"breaks_double", breaksIn(inDouble())},
                          {"breaks_float", breaksIn(inFloat())}});
    }
    for (const Measure& method : family.measures)
      theories.push_back({{"methods", method.name},
                          {"formula", method.formula},
                          {"is_claimed", true},
                          {"breaks_double", numberOrNull(firstBroken(family, method.theory))},
                          {"breaks_float", nullptr}});
    for (const Course& course : turned.courses) courses.push_back(courseJson(course));
    all.push_back({{"family", family.name},
                   {"title", family.title},
                   {"dial", family.dial},
                   {"unit", family.unit},
                   {"from", family.from},
                   {"to", family.to},
                   {"quantity", askedOf(family)},
                   {"mechanism", family.mechanism},
                   {"survivor", family.survivor},
                   {"theories", theories},
                   {"methods", courses}});
  }
  return Json({{"dynwitness", version},
               {"fewest_digits", kFewestDigits},
               {"silent_ours", silentOf(atlas, true)},
               {"silent_others", silentOf(atlas, false)},
               {"false_alarms", falseAlarmsOf(atlas)},
               {"families", all}})
             .dump(1) +
         "\n";
}

}  // namespace dynwitness::crosscheck::stability
