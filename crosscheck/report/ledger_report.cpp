// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/ledger_report.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "crosscheck/report/text.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostNamed = 8;  ///< entries of a group that people are shown; JSON has all

std::string counted(int count, const char* one) {
  return fmt::format("{} {}{}", count, one, count == 1 ? "" : "s");
}

std::string parametersLine(const Ledger& ledger) {
  if (!ledger.base_parameters)
    return fmt::format("{} inertial parameters; how many matter after regrouping: {}",
                       ledger.parameters, ledger.no_base_parameters);
  return fmt::format("{} of {} inertial parameters matter after regrouping",
                     *ledger.base_parameters, ledger.parameters);
}

std::string operationsLine(const Ledger& ledger) {
  std::string line = "operations of tau, friction apart: ";
  if (!ledger.general_operations) return line + ledger.no_operations;
  line += fmt::format("{} by a sweep for any mechanism, ", *ledger.general_operations);
  if (ledger.operations)
    return line + fmt::format("{} without what is zero or constant here", *ledger.operations);
  return line + "a program of the scene's own is " + ledger.no_operations;
}

std::string sizeLine(const Ledger& ledger) {
  return fmt::format("{} and {} move, {}", counted(ledger.links, "link"),
                     counted(ledger.joints, "joint"), counted(ledger.rates, "rate"));
}

std::string zerosLine(const Ledger::Zeros& zeros) {
  const std::string what = zeros.quantity == "M"       ? "M (i <= j)"
                           : zeros.quantity == "c_ijk" ? "c_ijk, of qd_j qd_k (j <= k)"
                                                       : zeros.quantity;
  if (!zeros.not_examined.empty()) return what + ": " + zeros.not_examined;
  return fmt::format("{}: {} of {} are always zero", what, zeros.zero, zeros.entries);
}

std::string entriesOf(const Ledger::Zeros::Group& group) {
  std::string line;
  const std::size_t named = std::min(group.entries.size(), kMostNamed);
  for (std::size_t k = 0; k < named; ++k) line += (k == 0 ? "" : " ") + group.entries[k];
  if (named < group.entries.size())
    line += fmt::format(" and {} more", group.entries.size() - named);
  return line;
}

std::string chanceLine(const Ledger& ledger) {
  return fmt::format("decided over prime fields, mistaken with a chance of at most {:.0e}",
                     ledger.error_probability);
}

bool isZeroAnywhere(const Ledger& ledger) {
  return std::any_of(ledger.zeros.begin(), ledger.zeros.end(),
                     [](const auto& zeros) { return zeros.zero > 0; });
}

}  // namespace

std::string ledgerText(const Ledger& ledger) {
  std::string text = fmt::format("  {}\n  {}\n  {}\n", sizeLine(ledger), parametersLine(ledger),
                                 operationsLine(ledger));
  for (const Ledger::Zeros& zeros : ledger.zeros) {
    text += "  " + zerosLine(zeros) + "\n";
    for (const Ledger::Zeros::Group& group : zeros.groups)
      text += fmt::format("    {}: {}\n", group.reason, entriesOf(group));
  }
  if (isZeroAnywhere(ledger)) text += "  " + chanceLine(ledger) + "\n";
  for (const std::string& dispute : ledger.disputes) text += "  a fault of ours: " + dispute + "\n";
  return text;
}

std::string ledgerHtml(const Ledger& ledger) {
  std::string html =
      fmt::format("<ul>\n<li>{}</li>\n<li>{}</li>\n<li>{}</li>\n", sizeLine(ledger),
                  escapeMarkup(parametersLine(ledger)), escapeMarkup(operationsLine(ledger)));
  for (const Ledger::Zeros& zeros : ledger.zeros) {
    html += "<li>" + escapeMarkup(zerosLine(zeros));
    if (!zeros.groups.empty()) html += "\n<ul>\n";
    for (const Ledger::Zeros::Group& group : zeros.groups)
      html += fmt::format("<li>{}: <code>{}</code></li>\n", escapeMarkup(group.reason),
                          entriesOf(group));
    html += zeros.groups.empty() ? "</li>\n" : "</ul>\n</li>\n";
  }
  html += "</ul>\n";
  if (isZeroAnywhere(ledger))
    html += "<p class=\"small\">Zeros are " + chanceLine(ledger) + "</p>\n";
  for (const std::string& dispute : ledger.disputes)
    html += "<p>A fault of ours: " + escapeMarkup(dispute) + "</p>\n";
  return html;
}

Json ledgerJson(const Ledger& ledger) {
  const auto orNull = [](const auto& value) { return value ? Json(*value) : Json(nullptr); };
  Json zeros = Json::array();
  for (const Ledger::Zeros& of : ledger.zeros) {
    Json groups = Json::array();
    for (const Ledger::Zeros::Group& group : of.groups)
      groups.push_back({{"reason", group.reason}, {"entries", group.entries}});
    zeros.push_back({{"of", of.quantity},
                     {"entries", of.entries},
                     {"zero", of.not_examined.empty() ? Json(of.zero) : Json(nullptr)},
                     {"not_examined", of.not_examined},
                     {"why", groups}});
  }
  return {{"moving_links", ledger.links},
          {"moving_joints", ledger.joints},
          {"rates", ledger.rates},
          {"parameters", ledger.parameters},
          {"base_parameters", orNull(ledger.base_parameters)},
          {"no_base_parameters", ledger.no_base_parameters},
          {"operations_of_any_mechanism", orNull(ledger.general_operations)},
          {"operations", orNull(ledger.operations)},
          {"no_operations", ledger.no_operations},
          {"zeros", zeros},
          {"error_probability", ledger.error_probability},
          {"disputes", ledger.disputes}};
}

}  // namespace dynwitness::crosscheck
