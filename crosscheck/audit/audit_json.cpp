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
    json["numbers"] = {{"caption", cleanText(entry.numbers->caption)},
                       {"head", entry.numbers->head},
                       {"rows", entry.numbers->rows}};
  }
  json["why"] = cleanText(audit::plain(entry.why));
  json["implemented_in"] = entry.implemented_in;
  return json;
}

}  // namespace

std::string auditJson(const audit::Audit& audit, const Environment& environment) {
  Json json{{"dynwitness", cleanText(environment.version)},
            {"headline", audit.headline()},
            {"source", cleanText(audit.chapter.author + ", " + audit.chapter.title + ", " +
                                 audit.chapter.year)},
            {"seed", audit.seed}};
  if (!environment.commit.empty()) json["commit"] = cleanText(environment.commit);
  json["date"] = environment.date;
  json["entries"] = Json::array();
  for (const audit::Entry& entry : audit.entries) json["entries"].push_back(toJson(entry));
  json["sound"] = audit.isSound();
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace dynwitness::crosscheck
