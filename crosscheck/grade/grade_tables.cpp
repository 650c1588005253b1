// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <iterator>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/grade/grade.hpp"
#include "crosscheck/report/page_parts.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/system/files.hpp"

namespace dynwitness::crosscheck {
namespace fs = std::filesystem;
namespace {

using Kind = Mark::Kind;
using Json = nlohmann::ordered_json;

/// "2.5", and "0.3" for what adds up to it.
std::string points(double x) {
  return fmt::format("{:.6g}", x);
}

/// Of marks: "g", or "acrobot g" where there are several scenes.
std::string title(const Grades& grades, const std::string& scene, const std::string& quantity) {
  return grades.rubric.tasks.size() == 1 ? quantity : scene + " " + quantity;
}
std::vector<std::string> titles(const Grades& grades) {
  std::vector<std::string> out;
  for (const RubricTask& task : grades.rubric.tasks)
    for (const auto& [quantity, marks] : task.marks)
      out.push_back(title(grades, task.scene.name, quantity));
  return out;
}

/// In a word or two.
std::string state(const Grade& grade) {
  if (!grade.ungraded.empty()) return "NOT GRADED";
  if (!grade.problem.empty()) return name(Kind::kNotRun);
  for (const Kind kind : {Kind::kNotRun, Kind::kWrong, Kind::kPartial, Kind::kNotAnswered})
    if (std::any_of(grade.marks.begin(), grade.marks.end(),
                    [&](const Mark& mark) { return mark.kind == kind; }))
      return name(kind);
  return name(Kind::kRight);
}

/// The sentence that says most.
std::string reason(const Grade& grade) {
  if (!grade.ungraded.empty()) return grade.ungraded;
  if (!grade.problem.empty()) return grade.problem;
  for (const Mark& mark : grade.marks)
    if (mark.kind != Kind::kRight) return mark.quantity + " " + mark.feedback;
  return "";
}

/// So many characters of a text.
std::string shortened(const std::string& text, int most) {
  if (codePoints(text) <= most) return text;
  std::size_t end = 0;
  for (int count = 0; end < text.size(); ++end)
    if ((static_cast<unsigned char>(text[end]) & 0xC0) != 0x80 && count++ == most) break;
  return text.substr(0, end) + "...";
}

/// All that there is to say, a sentence a line.
std::vector<std::string> sentences(const Grades* grades, const Grade& grade) {
  std::vector<std::string> out;
  if (!grade.ungraded.empty()) return {"not graded: " + grade.ungraded};
  if (!grade.problem.empty()) out.push_back("could not be run: " + grade.problem);
  for (const Mark& mark : grade.marks)
    if (grade.problem.empty() || mark.feedback != grade.problem)
      out.push_back(fmt::format("{}: {}",
                                grades != nullptr ? title(*grades, mark.scene, mark.quantity)
                                                  : mark.scene + " " + mark.quantity,
                                mark.feedback));
  out.insert(out.end(), grade.remarks.begin(), grade.remarks.end());
  return out;
}

std::string hiding(const Grades& grades) {
  const auto seen = std::count_if(grades.all.begin(), grades.all.end(), [](const Grade& grade) {
    return grade.ungraded.empty() && !grade.hidden;
  });
  const std::string kept =
      "Each submission ran on a copy in a folder of its own, with the environment variables that "
      "the rubric names.";
  if (seen == 0)
    return kept +
           " It saw neither the others nor their results, nor any process but its own, could write "
           "nowhere else, and had no network.";
  return kept + fmt::format(
                    " {} of {} could have read the other submissions, written elsewhere and used "
                    "the network: this machine could not hide them{}.",
                    seen, grades.all.size(),
                    grades.not_hidden.empty() ? " when they ran" : " (" + grades.not_hidden + ")");
}

/// A field of a table. What begins like a formula would be one for a spreadsheet.
std::string field(const std::string& text) {
  std::string out = oneLine(text);
  if (!out.empty() && std::string("=+-@").find(out[0]) != std::string::npos) out = "'" + out;
  if (out.find_first_of(",\"") == std::string::npos) return out;
  std::string quoted = "\"";
  for (const char c : out) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

const char* cssOf(const std::string& state) {
  if (state == name(Kind::kRight)) return "agree";
  return state == name(Kind::kNotAnswered) ? "none" : "disagree";
}

double mean(const Grades& grades) {
  double sum = 0;
  for (const Grade& grade : grades.all) sum += grade.total();
  const auto count = static_cast<double>(grades.all.size()) - grades.ungraded();
  return count > 0 ? sum / count : 0;
}

}  // namespace

std::string gradesText(const Grades& grades,
                       const std::function<std::string(const std::string& state)>& shown_as) {
  constexpr int kLongest = 40, kLongestReason = 110;
  const std::vector<std::string> columns = titles(grades);
  int width = 10;
  for (const Grade& grade : grades.all)
    width = std::clamp(codePoints(oneLine(grade.submission)), width, kLongest);
  std::string out =
      fmt::format("grades of {} by {}\n{}\n\n", grades.folder, grades.rubric_file, hiding(grades));
  out += fmt::format("{:<{}}", "submission", width);
  std::vector<int> widths;
  for (const std::string& column : columns) {
    widths.push_back(std::max(5, codePoints(column)));
    out += fmt::format("  {:>{}}", column, widths.back());
  }
  out += fmt::format("  {:>7}  \n", "total");
  for (const Grade& grade : grades.all) {
    const std::string shown = oneLine(grade.submission);
    out +=
        shown + std::string(static_cast<std::size_t>(std::max(0, width - codePoints(shown))), ' ');
    for (std::size_t k = 0; k < columns.size(); ++k)
      out += fmt::format("  {:>{}}", grade.ungraded.empty() ? points(grade.marks[k].marks) : "-",
                         widths[k]);
    out += fmt::format("  {:>7}  {}", grade.ungraded.empty() ? points(grade.total()) : "-",
                       shown_as ? shown_as(state(grade)) : state(grade));
    if (const std::string why = oneLine(reason(grade)); !why.empty())
      out += ": " + shortened(why, kLongestReason);
    out += "\n";
  }
  const int ungraded = grades.ungraded();
  out += fmt::format("\n{} graded, of {} marks {} on average; {} kept from before{}\n",
                     grades.all.size() - static_cast<std::size_t>(ungraded),
                     points(grades.rubric.outOf()), fmt::format("{:.3g}", mean(grades)),
                     grades.kept, ungraded == 0 ? "" : fmt::format("; {} NOT GRADED", ungraded));
  return out;
}

std::string gradesCsv(const Grades& grades) {
  std::string out = "submission,total,out_of";
  const std::vector<std::string> columns = titles(grades);
  for (const std::string& column : columns) out += "," + field(column);
  out += ",state,feedback\n";
  for (const Grade& grade : grades.all) {
    const bool is_graded = grade.ungraded.empty();
    out += fmt::format("{},{},{}", field(grade.submission), is_graded ? points(grade.total()) : "",
                       points(grades.rubric.outOf()));
    for (std::size_t k = 0; k < columns.size(); ++k)
      out += "," + (is_graded ? points(grade.marks[k].marks) : "");
    out += fmt::format(",{},{}\n", field(state(grade)),
                       field(fmt::format("{}", fmt::join(sentences(&grades, grade), "; "))));
  }
  return out;
}

std::string gradesHtml(const Grades& grades, const std::string& version) {
  std::string out = pageHead("Grades: " + grades.folder, version, "", "table", "Skip to the table");
  const auto put = std::back_inserter(out);
  const int ungraded = grades.ungraded();
  const std::size_t count = grades.all.size();
  fmt::format_to(put,
                 "<main>\n<header id=\"top\">\n<p class=\"eyebrow\"><strong>dynwitness</strong> "
                 "grades of {}, by {}</p>\n<div class=\"verdict {}\">{}\n<h1><span>{} submission{} "
                 "graded</span> <span class=\"detail\">{}{} marks on average, of {}</span></h1>"
                 "</div>\n<p>{}</p>\n</header>\n",
                 escapeMarkup(grades.folder), escapeMarkup(grades.rubric_file),
                 ungraded == 0 ? "agree" : "disagree", icon(ungraded == 0 ? "agree" : "disagree"),
                 count - static_cast<std::size_t>(ungraded), count == 1 ? "" : "s",
                 ungraded == 0 ? "" : fmt::format("{} not graded; ", ungraded),
                 fmt::format("{:.3g}", mean(grades)), points(grades.rubric.outOf()),
                 escapeMarkup(hiding(grades)));
  fmt::format_to(
      put,
      "<h2 id=\"table\">Marks</h2>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" "
      "aria-label=\"marks\"><table>\n<thead><tr><th scope=\"col\">submission</th>");
  for (const std::string& column : titles(grades))
    fmt::format_to(put, "<th scope=\"col\" class=\"n\">{}</th>", escapeMarkup(column));
  fmt::format_to(put,
                 "<th scope=\"col\" class=\"n\">total</th><th scope=\"col\">state</th></tr></thead>"
                 "\n<tbody>\n");
  const std::size_t columns = titles(grades).size();
  for (std::size_t i = 0; i < count; ++i) {
    const Grade& grade = grades.all[i];
    const bool is_graded = grade.ungraded.empty();
    fmt::format_to(put, "<tr{}><th scope=\"row\"><a href=\"#s{}\">{}</a></th>",
                   is_graded && grade.problem.empty() ? "" : " class=\"bad\"", i + 1,
                   escapeMarkup(grade.submission));
    for (std::size_t k = 0; k < columns; ++k)
      fmt::format_to(put, "<td class=\"n\">{}</td>", is_graded ? points(grade.marks[k].marks) : "");
    fmt::format_to(put, "<td class=\"n\">{}</td><td>{}</td></tr>\n",
                   is_graded ? points(grade.total()) : "",
                   badge(cssOf(state(grade)), state(grade)));
  }
  fmt::format_to(put, "</tbody></table></div>\n<h2>Feedback</h2>\n");
  for (std::size_t i = 0; i < count; ++i) {
    const Grade& grade = grades.all[i];
    fmt::format_to(put, "<h3 id=\"s{}\">{} {}</h3>\n", i + 1, escapeMarkup(grade.submission),
                   badge(cssOf(state(grade)),
                         grade.ungraded.empty()
                             ? fmt::format("{} of {}", points(grade.total()), points(grade.outOf()))
                             : state(grade)));
    fmt::format_to(put, "<ul class=\"reasons\">\n");
    for (const std::string& sentence : sentences(&grades, grade))
      fmt::format_to(put, "<li>{}</li>\n", escapeMarkup(sentence));
    fmt::format_to(put, "</ul>\n");
  }
  fmt::format_to(put,
                 "<p class=\"top\"><a href=\"#top\">To the top</a></p>\n</main>\n<footer>\n<p "
                 "class=\"small\">dynwitness {}, seed {}, limits of {} precision. The same as a "
                 "table: grades.csv; for programs: junit.xml, gradescope/NAME/results.json, "
                 "records/NAME.json.</p>\n</footer>\n</body>\n</html>\n",
                 escapeMarkup(version), grades.rubric.seed,
                 grades.rubric.single ? "single" : "double");
  return out;
}

std::string gradesJUnit(const Grades& grades) {
  const auto failing = [](const Grade& grade) {
    return std::count_if(grade.marks.begin(), grade.marks.end(),
                         [](const Mark& mark) { return mark.kind != Kind::kRight; });
  };
  std::ptrdiff_t tests = 0, failures = 0;
  for (const Grade& grade : grades.all) {
    tests += static_cast<std::ptrdiff_t>(grade.marks.size()) + 1;
    failures += failing(grade) + (grade.problem.empty() ? 0 : 1);
  }
  std::string out = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<testsuites name=\"dynwitness grade\" tests=\"{}\" failures=\"{}\" errors=\"{}\">\n",
      tests, failures, grades.ungraded());
  const auto put = std::back_inserter(out);
  for (const Grade& grade : grades.all) {
    const std::string suite = escapeMarkup(grade.submission);
    fmt::format_to(put,
                   "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\">\n"
                   "    <testcase classname=\"{}\" name=\"can be run\"",
                   suite, grade.marks.size() + 1, failing(grade) + (grade.problem.empty() ? 0 : 1),
                   grade.ungraded.empty() ? 0 : 1, suite);
    if (!grade.ungraded.empty())
      fmt::format_to(put, "><error type=\"not graded\" message=\"{}\"/></testcase>\n",
                     escapeMarkup(oneLine(grade.ungraded)));
    else if (!grade.problem.empty())
      fmt::format_to(put, "><failure type=\"{}\" message=\"{}\"/></testcase>\n",
                     name(Kind::kNotRun), escapeMarkup(oneLine(grade.problem)));
    else
      fmt::format_to(put, "/>\n");
    for (const Mark& mark : grade.marks) {
      fmt::format_to(put, "    <testcase classname=\"{}\" name=\"{} {}: {} of {}\"", suite,
                     escapeMarkup(mark.scene), mark.quantity, points(mark.marks),
                     points(mark.out_of));
      if (mark.kind == Kind::kRight)
        fmt::format_to(put, "/>\n");
      else
        fmt::format_to(put, "><failure type=\"{}\" message=\"{}\"/></testcase>\n", name(mark.kind),
                       escapeMarkup(oneLine(mark.feedback)));
    }
    fmt::format_to(put, "  </testsuite>\n");
  }
  return out + "</testsuites>\n";
}

std::string gradescopeJson(const Grade& grade) {
  Json tests = Json::array();
  for (const Mark& mark : grade.marks)
    tests.push_back({{"name", mark.scene + ": " + mark.quantity},
                     {"score", mark.marks},
                     {"max_score", mark.out_of},
                     {"status", mark.kind == Kind::kRight ? "passed" : "failed"},
                     {"output", mark.feedback},
                     {"output_format", "text"},
                     {"visibility", "visible"}});
  std::string told;
  if (!grade.problem.empty()) told += "could not be run: " + grade.problem + "\n";
  for (const std::string& remark : grade.remarks) told += remark + "\n";
  return Json{{"score", grade.total()},        {"output", told},
              {"output_format", "text"},       {"visibility", "visible"},
              {"stdout_visibility", "hidden"}, {"tests", tests}}
             .dump(1, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

void writeGrades(const Grades& grades, const fs::path& output, const std::string& version) {
  const fs::path folder = output / "gradescope";
  std::set<std::string> current;
  for (const Grade& grade : grades.all) {
    if (!grade.ungraded.empty()) continue;
    const std::string own = fileNameOf(grade.submission);
    current.insert(own);
    fs::create_directories(folder / own);
    writeWholeFile(folder / own / "results.json", gradescopeJson(grade));
  }
  // of submissions that are no more: nobody is to upload these
  std::vector<fs::path> gone;
  std::error_code none;
  for (fs::directory_iterator entry(folder, none), end; !none && entry != end;
       entry.increment(none))
    if (current.count(entry->path().filename().string()) == 0) gone.push_back(entry->path());
  for (const fs::path& path : gone) {
    fs::remove(path / "results.json", none);
    fs::remove(path, none);  // only where it is empty
  }
  writeWholeFile(output / "grades.csv", gradesCsv(grades));
  writeWholeFile(output / "junit.xml", gradesJUnit(grades));
  writeWholeFile(output / "index.html", gradesHtml(grades, version));
}

}  // namespace dynwitness::crosscheck
