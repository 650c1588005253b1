// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "crosscheck/audit/audit_report.hpp"
#include "crosscheck/report/text.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;

Json textOrNull(const std::string& text) {
  return text.empty() ? Json() : Json(cleanText(audit::plain(text)));
}

Json toJson(const audit::Outcome& outcome) {
  return {{"zero", outcome.zero},
          {"text", cleanText(outcome.residual)},
          {"method", outcome.method},
          {"points", outcome.points},
          {"error_probability", outcome.chance}};
}

Json toJson(const std::optional<audit::Outcome>& outcome) {
  return outcome ? toJson(*outcome) : Json();
}

Json toJson(const audit::Entry& entry) {
  Json json{{"id", entry.id},
            {"kind", entry.kind()},
            {"section", entry.section},
            {"title", cleanText(audit::plain(entry.title))},
            {"printed", cleanText(audit::plain(entry.printed))}};
  if (entry.holds == audit::Holds::kUnderCondition)
    json["holds"] = name(entry.holds);
  else
    json["holds"] = entry.holds == audit::Holds::kTrue;
  json["residual_printed"] = toJson(entry.residual_printed);
  json["corrected"] = textOrNull(entry.corrected);
  json["residual_corrected"] = toJson(entry.residual_corrected);
  json["condition"] = textOrNull(entry.condition);
  json["residual_condition"] = toJson(entry.residual_condition);
  if (entry.numbers) {
    const auto plainly = [](std::vector<std::string> cells) {
      for (std::string& cell : cells) cell = cleanText(audit::plain(cell));
      return cells;
    };
    Json rows = Json::array();
    for (const auto& row : entry.numbers->rows) rows.push_back(plainly(row));
    json["numbers"] = {{"caption", cleanText(audit::plain(entry.numbers->caption))},
                       {"head", plainly(entry.numbers->head)},
                       {"rows", rows}};
  }
  json["why"] = cleanText(audit::plain(entry.why));
  json["implemented_in"] = entry.implemented_in;
  json["implementation_compared"] = entry.comparesOurCode();
  if (entry.residual_ours) json["residual_implementation"] = toJson(*entry.residual_ours);
  return json;
}

}  // namespace

std::string auditJson(const audit::Audit& audit, const Environment& environment) {
  Json json{{"dynwitness", cleanText(environment.version)},
            {"headline", audit.headline()},
            {"source", cleanText(audit.chapter.author + ", " + audit.chapter.title + ", " +
                                 audit.chapter.year)},
            {"seed", audit.seed}};
  json["criterion"] = Json::array();
  for (const std::string& rule : audit.chapter.criterion)
    json["criterion"].push_back(cleanText(audit::plain(rule)));
  if (!environment.commit.empty()) json["commit"] = cleanText(environment.commit);
  json["date"] = environment.date;
  json["entries"] = Json::array();
  for (const audit::Entry& entry : audit.entries) json["entries"].push_back(toJson(entry));
  json["sound"] = audit.isSound();
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace dynwitness::crosscheck
