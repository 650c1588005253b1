// SPDX-License-Identifier: GPL-3.0-or-later
// What the readers made of a file: as a table, and for programs.
#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/readers/compare.hpp"

namespace dynwitness::crosscheck {

std::string title(const ReaderResult& reader) {
  return reader.version.empty() ? reader.name : reader.name + " " + reader.version;
}

std::string cellOf(const ReaderResult& reader, const std::string& link) {
  if (!reader.present) return "absent";
  if (!reader.has_read) return reader.failure.empty() ? "not read" : "fails";
  std::string cell;
  for (const Misreading& finding : reader.findings)
    if (finding.link == link && cell.find(finding.quantity) == std::string::npos)
      cell += (cell.empty() ? "" : ", ") + finding.quantity;
  return cell.empty() ? "same" : cell;
}

std::string effectText(const Misreading& finding) {
  if (!finding.has_effect) return "";
  if (finding.effect.M_percent == 0 && finding.effect.g == 0) return "M and g do not feel it";
  return fmt::format("M {:.3g} % on its diagonal, g {:.3g} N m at the worst state",
                     finding.effect.M_percent, finding.effect.g);
}

std::vector<std::string> ReadersResult::rows() const {
  std::vector<std::string> links = bodies;
  for (const ReaderResult& reader : readers)
    for (const Misreading& finding : reader.findings)
      if (std::find(links.begin(), links.end(), finding.link) == links.end())
        links.push_back(finding.link);
  return links;
}

std::string readersText(const ReadersResult& result, bool all) {
  std::string out = fmt::format("{}: {} links, {} of them moved by joints of their own\n",
                                result.file, result.links, result.bodies.size());
  for (const std::string& text : result.not_compared)
    out += fmt::format("{}: {}\n", result.file, text);
  for (const std::string& text : result.remarks) out += text + "\n";
  for (const std::string& text : result.impossible) out += text + "\n";
  if (!result.impossible.empty())
    out += fmt::format("{}: {} inertias that no body has (--mend OUT.urdf writes the nearest)\n",
                       result.file, result.impossible.size());

  const std::vector<std::string> links = result.rows();
  const auto differs = [&](const std::string& link) {
    return std::any_of(result.readers.begin(), result.readers.end(), [&](const ReaderResult& r) {
      return std::any_of(r.findings.begin(), r.findings.end(),
                         [&](const Misreading& f) { return f.link == link; });
    });
  };
  std::size_t width = 8;
  for (const std::string& link : links) width = std::max(width, link.size());
  out += fmt::format("\n{:<{}}", "link", width);
  // who is not there is told below
  std::vector<const ReaderResult*> columns;
  for (const ReaderResult& reader : result.readers)
    if (reader.present) columns.push_back(&reader);
  for (const ReaderResult* reader : columns) out += fmt::format("  {:<20}", title(*reader));
  std::size_t rows = 0;
  for (const std::string& link : links) {
    if (!all && !differs(link)) continue;
    ++rows;
    out += fmt::format("\n{:<{}}", link.empty() ? "(all)" : link, width);
    for (const ReaderResult* reader : columns)
      out += fmt::format("  {:<20}", cellOf(*reader, link));
  }
  if (rows < links.size()) {
    out += fmt::format("\n{:<{}}", rows == 0 ? "all" : "others", width);
    for (const ReaderResult* reader : columns)
      out += fmt::format("  {:<20}", reader->has_read ? "same" : cellOf(*reader, ""));
  }
  out += "\n\n";
  for (const ReaderResult& reader : result.readers) {
    if (!reader.present) {
      out += fmt::format("{}: {}\n", reader.name,
                         reader.absence.empty() ? "absent from this build" : reader.absence);
      continue;
    }
    if (!reader.refusal.empty()) {
      out += fmt::format("{}: does not read the file: {}\n", title(reader), reader.refusal);
      continue;
    }
    for (const std::string& told : reader.told) out += fmt::format("{}: {}\n", title(reader), told);
    if (reader.findings.empty())
      out += fmt::format("{}: has the robot of the file\n", title(reader));
    for (const Misreading& f : reader.findings)
      out += fmt::format(
          "{}: {}{}: {}: {}{}{}\n{}    {}: {}\n{}", title(reader),
          f.where.line > 0 ? f.where.text() + ": " : "",
          f.link.empty() ? "robot" : "link \"" + f.link + "\"", f.quantity,
          f.rule.empty() ? "another, by none of the mistakes that are tried" : f.rule,
          effectText(f).empty() ? "" : "; ", effectText(f),
          f.ours.empty() ? "" : "    the file: " + f.ours + "\n", reader.name, f.theirs,
          f.records.empty() ? "" : fmt::format("    on record: {}\n", fmt::join(f.records, ", ")));
    if (!reader.remedy.empty())
      out += fmt::format("{}: remedy: {}\n", title(reader), reader.remedy);
  }
  return out;
}

std::string readersJson(const ReadersResult& result, const std::string& version) {
  using nlohmann::json;
  json out = {{"dynwitness", version},
              {"file", result.file},
              {"format", result.format},
              {"links", result.links},
              {"states", result.states},
              {"seed", result.seed},
              {"agrees", result.agrees()},
              {"moving_links", result.bodies},
              {"remarks", result.remarks},
              {"impossible_inertias", result.impossible},
              {"not_compared", result.not_compared}};
  out["readers"] = json::array();
  for (const ReaderResult& reader : result.readers) {
    json one = {{"name", reader.name},       {"version", reader.version},
                {"present", reader.present}, {"absence", reader.absence},
                {"read", reader.has_read},   {"refusal", reader.refusal},
                {"failure", reader.failure}, {"told", reader.told},
                {"remedy", reader.remedy},   {"findings", json::array()}};
    for (const Misreading& f : reader.findings) {
      json finding = {{"link", f.link},      {"line", f.where.line},  {"quantity", f.quantity},
                      {"rule", f.rule},      {"in_the_file", f.ours}, {"as_read", f.theirs},
                      {"records", f.records}};
      if (f.has_effect) {
        finding["M_percent"] = f.effect.M_percent;
        finding["g_difference"] = f.effect.g;
      }
      one["findings"].push_back(finding);
    }
    out["readers"].push_back(one);
  }
  return out.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace dynwitness::crosscheck
