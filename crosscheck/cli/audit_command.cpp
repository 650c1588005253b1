// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness audit: the chapter, equation by equation.
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "crosscheck/audit/audit.hpp"
#include "crosscheck/audit/audit_report.hpp"
#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/speech.hpp"
#include "crosscheck/system/files.hpp"
#include "scene/error.hpp"

namespace dynwitness::cli {
namespace {

using namespace audit;

struct Arguments {
  std::vector<std::string> ids;
  std::string only = "all", json, report;
  std::uint64_t seed = 1;
};

/// A label and its text, broken between words into lines of 100.
void printBlock(const char* label, const std::string& text) {
  constexpr std::size_t kWidth = 85;
  std::string rest = plain(text);
  for (const char* lead = label; !rest.empty(); lead = "") {
    std::size_t size = rest.size();
    if (size > kWidth) {
      size = rest.rfind(' ', kWidth);
      if (size == std::string::npos || size == 0) size = std::min(rest.find(' '), rest.size());
    }
    fmt::print("    {:<10} {}\n", lead, rest.substr(0, size));
    rest.erase(0, std::min(size + 1, rest.size()));
  }
}

void print(const Entry& entry) {
  fmt::print("{}, section {}, {}: {}\n", entry.id, entry.section, plain(entry.title),
             entry.holds == Holds::kUnderCondition ? toned(Tone::kDoubt, "holds under a condition")
             : entry.holds == Holds::kTrue         ? toned(Tone::kGood, "holds")
             : entry.isPrinted()                   ? toned(Tone::kBad, "WRONG")
                                                   : toned(Tone::kDoubt, "not so"));
  printBlock(entry.left_open     ? "left open"
             : entry.not_printed ? "not said"
                                 : "printed",
             entry.printed);
  printBlock("", "residual " + entry.residual_printed.residual);
  if (entry.residual_condition) {
    printBlock("holds if", entry.condition);
    printBlock("", "residual " + entry.residual_condition->residual);
  }
  if (entry.residual_corrected) {
    printBlock("correct", entry.corrected);
    printBlock("", "residual " + entry.residual_corrected->residual);
  }
  if (entry.numbers) {
    printBlock("numbers", entry.numbers->caption);
    std::vector<std::size_t> width(entry.numbers->head.size(), 0);
    std::vector<std::vector<std::string>> rows = entry.numbers->rows;
    rows.insert(rows.begin(), entry.numbers->head);
    for (auto& row : rows)
      for (std::string& cell : row) cell = plain(cell);
    for (const auto& row : rows)
      for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());
    for (const auto& row : rows) {
      fmt::print("      ");
      for (std::size_t i = 0; i < row.size(); ++i) fmt::print("  {:<{}}", row[i], width[i]);
      fmt::print("\n");
    }
  }
  printBlock("why", entry.why);
  printBlock("see", entry.implemented_in +
                        (entry.comparesOurCode() ? ", whose answer was compared, too" : ""));
}

/// An id as the user may write it: "eq15" or "15".
std::string canonical(const std::string& id) {
  const bool digits =
      !id.empty() && std::all_of(id.begin(), id.end(), [](char c) { return c >= '0' && c <= '9'; });
  return digits ? "eq" + id : id;
}

void requireKnown(const std::vector<std::string>& ids, const Chapter& chapter) {
  const std::vector<Statement>& all = chapter.statements;
  for (const std::string& id : ids) {
    if (std::any_of(all.begin(), all.end(), [&](const Statement& s) { return s.id == id; }))
      continue;
    std::string known;
    for (const Statement& statement : all) known += (known.empty() ? "" : ", ") + statement.id;
    throw scene::InputError({}, fmt::format("--equation: no entry '{}'; there are {}", id, known));
  }
}

bool shown(const Entry& entry, const std::string& only) {
  return only == "all" || (only == "wrong" && entry.isPrinted() && entry.holds == Holds::kFalse) ||
         (only == "condition" && entry.holds == Holds::kUnderCondition) ||
         (only == "true" && entry.holds == Holds::kTrue);
}

int run(Arguments arguments) {
  for (std::string& id : arguments.ids) id = canonical(id);
  if (!arguments.ids.empty()) requireKnown(arguments.ids, bundledChapter());
  if (!arguments.report.empty()) crosscheck::requireWritable(arguments.report);
  crosscheck::requireWritableFile(arguments.json);
  const Audit audit = runAudit(arguments.seed, [&](const Statement& statement) {
    return arguments.ids.empty() || std::find(arguments.ids.begin(), arguments.ids.end(),
                                              statement.id) != arguments.ids.end();
  });
  for (const Entry& entry : audit.entries)
    if (shown(entry, arguments.only)) {
      print(entry);
      fmt::print("\n");
    }
  fmt::print("{} (seed {})\n", audit.headline(), audit.seed);
  const crosscheck::Environment environment = crosscheck::thisEnvironment();
  if (!arguments.json.empty())
    crosscheck::writeWholeFile(arguments.json, crosscheck::auditJson(audit, environment));
  if (!arguments.report.empty()) {
    crosscheck::writeAudit(audit, environment, arguments.report);
    fmt::print("report: {}\n", (std::filesystem::path(arguments.report) / "index.html").string());
  }
  for (const Entry& entry : audit.entries)
    if (!entry.isSound())
      fmt::print("{}: {}: {}\n", entry.id, toned(Tone::kBad, "OUR OWN PART DOES NOT STAND"),
                 entry.residual_ours && !entry.residual_ours->zero
                     ? entry.implemented_in + ": " + entry.residual_ours->residual
                     : "what is called corrected or conditional is not 0");
  return audit.isSound() ? 0 : 1;
}

}  // namespace

Run addAudit(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("--equation", arguments->ids, "These entries only, e.g. 15, eq15 or eq15,eq16")
      ->delimiter(',');
  command->add_option("--only", arguments->only, "Entries to print: all, wrong, condition or true")
      ->check(oneOf({"all", "wrong", "condition", "true"}))
      ->capture_default_str();
  addJson(*command, arguments->json);
  addOutput(*command, arguments->report, "folder for a page and audit.json");
  addSeed(*command, arguments->seed, "of the random points");
  command->footer(
      "Examples:\n"
      "  dynwitness audit -o audit\n"
      "  dynwitness audit --equation N_definite\n"
      "Every verdict is computed when the command runs: both sides of an equation at random points "
      "of a\n"
      "prime field, where a difference is 0 or it is not, or certified digits for inequalities. "
      "Exit\n"
      "status 1: what is given as correct was not found to be so.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
