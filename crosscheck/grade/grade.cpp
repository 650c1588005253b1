// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/grade/grade.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/grade/examined.hpp"
#include "crosscheck/grade/submission.hpp"
#include "crosscheck/system/cell.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/system/hash.hpp"
#include "crosscheck/system/leaving.hpp"
#include "crosscheck/system/own_program.hpp"
#include "crosscheck/system/processes.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "scene/error.hpp"

namespace dynwitness::crosscheck {
namespace fs = std::filesystem;
namespace {

using scene::InputError;

constexpr const char* kRecords = "records";
constexpr const char* kMark = "format";  ///< among the records: whose they are
constexpr const char* kFormat = "dynwitness grade 1\n";

std::string contentsOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Whether `inner` is `outer` or lies in it.
bool liesIn(const fs::path& inner, const fs::path& outer) {
  const auto [at, end] = std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end());
  (void)end;
  return at == outer.end();
}

/// The folder of the results, made where it is not there.
void takeOutput(const fs::path& output, const fs::path& folder) {
  requireWritableFolder(output);
  const fs::path out = fs::weakly_canonical(output), in = fs::canonical(folder);
  if (liesIn(out, in) || liesIn(in, out))
    throw InputError({output.string()},
                     fmt::format("and the submissions in {} lie one in the other, allowed: folders "
                                 "beside each other",
                                 folder.string()));
  if (fs::exists(output) && !fs::is_empty(output) &&
      contentsOf(output / kRecords / kMark) != kFormat)
    throw InputError(
        {output.string()},
        "is not empty and holds no records of dynwitness grade, allowed: a new folder, "
        "or one that it has written");
  fs::create_directories(output / kRecords);
  if (contentsOf(output / kRecords / kMark) != kFormat)
    writeWholeFile(output / kRecords / kMark, kFormat);
}

/// What no submission may see: the others, their results, and what knows the answers.
std::vector<fs::path> hiddenBy(const GradeOptions& options, const Rubric& rubric) {
  std::vector<fs::path> hidden = rubric.hide;
  for (const fs::path& path : {options.folder, options.output, scene::dataFolder()})
    hidden.push_back(fs::absolute(path));
  std::error_code none;
  const fs::path self = ownProgram();
  hidden.push_back(self);
  for (const auto& beside : fs::directory_iterator(self.parent_path(), none))  // our other programs
    if (beside.path().filename().string().rfind("dynwitness", 0) == 0)
      hidden.push_back(beside.path());
  // kernels of scenes, wherever they are kept
  for (const auto& [variable, below] :
       {std::pair("DYNWITNESS_CACHE", ""), std::pair("XDG_CACHE_HOME", "dynwitness"),
        std::pair("HOME", ".cache/dynwitness")})
    if (const char* const folder = std::getenv(variable); folder != nullptr && *folder != 0)
      hidden.push_back(fs::absolute(fs::path(folder) / below));
  return hidden;
}

Grade without(const std::string& name, const std::string& why) {
  Grade out;
  out.submission = name;
  out.ungraded = why;
  return out;
}

}  // namespace

int Grades::ungraded() const {
  return static_cast<int>(std::count_if(
      all.begin(), all.end(), [](const Grade& grade) { return !grade.ungraded.empty(); }));
}

std::string fileNameOf(const std::string& submission) {
  constexpr std::size_t kLongest = 200;
  std::string out;
  for (const char c : submission) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
    out += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  if (out.size() > kLongest) out = out.substr(0, kLongest) + "%" + hashOf(submission);
  return out;
}

Grades grade(const GradeOptions& options, const std::function<void(int of, int done)>& done) {
  Grades out;
  out.rubric = readRubric(options.rubric_file);
  out.folder = options.folder.string();
  out.rubric_file = options.rubric_file.filename().string();
  const std::vector<std::string> names = submissionsIn(options.folder);
  takeOutput(options.output, options.folder);
  const WorkLock lock(options.output);
  if (!lock.isHeld())
    throw InputError({options.output.string()},
                     "another dynwitness grade is at work there, allowed: one at a time");
  out.not_hidden = whyNothingIsHidden();
  const bool hides = out.not_hidden.empty();
  const std::vector<fs::path> hidden = hiddenBy(options, out.rubric);
  const auto recordOf = [&](const std::string& name) {
    return options.output / kRecords / (fileNameOf(name) + ".json");
  };

  out.all.resize(names.size());
  std::vector<std::size_t> left;
  const auto take = [&](std::size_t k, const std::string& record) {
    out.all[k] = graded(record, out.rubric);
    out.all[k].submission = names[k];
  };
  for (std::size_t k = 0; k < names.size(); ++k) try {
      const std::string key =
          keyOf(readSubmission(options.folder, names[k], out.rubric), out.rubric);
      const std::string record = options.again ? "" : contentsOf(recordOf(names[k]));
      if (keyOfRecord(record) == key) {
        take(k, record);
        ++out.kept;
      } else {
        left.push_back(k);
      }
    } catch (const std::runtime_error& error) {
      out.all[k] = without(names[k], error.what());
    }

  // what it keeps is made before there are copies, which would each make it anew
  engineKinds({}, out.rubric.limits, out.rubric.tasks.front().scene);
  int count = 0;
  const int of = static_cast<int>(left.size());
  done(of, count);
  inOwnCopies(
      options.jobs, of, mostSeconds(out.rubric),
      [&](int i) {
        const std::string& name = names[left[static_cast<std::size_t>(i)]];
        return examinedRecord(readSubmission(options.folder, name, out.rubric), out.rubric, hides,
                              hidden);
      },
      [&](int i, const CopyEnded& ended) {
        const std::size_t k = left[static_cast<std::size_t>(i)];
        if (ended.problem.empty()) {
          writeWholeFile(recordOf(names[k]), ended.answer);
          take(k, ended.answer);
        } else {
          out.all[k] = without(names[k], ended.problem);
        }
        done(of, ++count);
      });
  return out;
}

}  // namespace dynwitness::crosscheck
