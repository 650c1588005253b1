// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/grade/examined.hpp"

#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/diagnosis/check_report.hpp"
#include "crosscheck/diagnosis/examine.hpp"
#include "crosscheck/system/cell.hpp"
#include "crosscheck/system/children.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"

namespace dynwitness::crosscheck {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

/// Where a cell has its folder that hides something; elsewhere that name stands for it.
constexpr const char* kFolderOfAll = "/tmp/submission";

std::string withoutPath(std::string text, const fs::path& folder) {
  const std::string path = folder.string();
  for (std::size_t at = 0; (at = text.find(path, at)) != std::string::npos;)
    text.replace(at, path.size(), kFolderOfAll), at += std::string(kFolderOfAll).size();
  return text;
}

/// What must be done before it can be started. Empty: done
std::string built(const Submission& submission, const Rubric& rubric) {
  if (rubric.build.empty()) return "";
  Limits limits = rubric.limits;
  limits.seconds = rubric.build_seconds;
  constexpr std::size_t kMost = 16;
  try {
    Conversation compiler(
        "( " + commandFor(submission, rubric.build) + "\n) </dev/null >&2 && echo built", limits);
    compiler.ask("", kMost);
  } catch (const std::runtime_error& error) {
    return std::string("it was not built: ") + error.what();
  }
  return "";
}

/// What an examination comes to, as a task of a record.
Json heard(const scene::Scene& scene, const WitnessKind& kind, const CheckOptions& options) {
  try {
    const Examination found = examine(scene, kind, options);
    return {{"scene", scene.name}, {"check", Json::parse(checkJson(found, DYNWITNESS_VERSION))}};
  } catch (const scene::InputError& refusal) {
    std::string why = refusal.what();
    const std::string file = scene.file.string() + ": ";
    if (why.rfind(file, 0) == 0) why.erase(0, file.size());
    return {{"scene", scene.name}, {"problem", why}};
  }
}

std::string examinedThere(const Submission& submission, const Rubric& rubric, Json record,
                          const fs::path& folder) {
  layOut(submission, rubric, folder);
  if (std::string problem = built(submission, rubric); !problem.empty()) {
    record["problem"] = std::move(problem);
  } else {
    CheckOptions options;
    options.seed = rubric.seed;
    options.single = rubric.single;
    options.smallest = false;
    const scene::Scene first = withoutFollowers(rubric.tasks.front().scene);
    const WitnessKind kind =
        engineKinds({commandFor(submission, rubric.command)}, rubric.limits, first).front();
    for (const RubricTask& task : rubric.tasks) {
      endAllInCell();  // what is left would take the numbers of processes from the next
      record["tasks"].push_back(heard(withoutFollowers(task.scene), kind, options));
    }
  }
  return withoutPath(record.dump(1, ' ', false, Json::error_handler_t::replace) + "\n", folder);
}

}  // namespace

std::string examinedRecord(const Submission& submission, const Rubric& rubric, bool hides,
                           const std::vector<fs::path>& hidden) {
  Json record = {{"dynwitness", DYNWITNESS_VERSION},
                 {"submission", submission.name},
                 {"key", keyOf(submission, rubric)},
                 {"hidden", hides},
                 {"remarks", submission.remarks}};
  if (!submission.problem.empty()) {
    record["problem"] = submission.problem;
    return record.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  }
  constexpr int kBeyond = 200;  // threads count there
  const Cell cell{hidden, rubric.environment, rubric.disk, rubric.limits.processes + kBeyond};
  return inCell(cell, hides, [&](const fs::path& folder) {
    return examinedThere(submission, rubric, record, folder);
  });
}

double mostSeconds(const Rubric& rubric) {
  constexpr double kOurs = 600;  // for the certified truth and the mistakes of one task
  const auto tasks = static_cast<double>(rubric.tasks.size());
  return rubric.build_seconds + rubric.limits.seconds * (1 + 2 * tasks) + kOurs * tasks;
}

}  // namespace dynwitness::crosscheck
