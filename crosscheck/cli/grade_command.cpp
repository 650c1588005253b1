// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness grade: a folder of submissions on the stand, each with marks and a sentence for them.
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/speech.hpp"
#include "crosscheck/grade/grade.hpp"
#include "crosscheck/system/processes.hpp"
#include "scene/error.hpp"
#include "scene/work.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  std::string folder, rubric, output = "grades";
  int jobs = availableProcessors();
  bool again = false, example = false;
};

int run(const Arguments& arguments) {
  if (arguments.example) {
    fmt::print("{}", exampleRubric());
    return 0;
  }
  if (arguments.folder.empty() || arguments.rubric.empty())
    throw scene::InputError({},
                            "grade: expected FOLDER and --rubric RUBRIC.toml (or --example, "
                            "which prints one)");
  for (const RubricTask& task : readRubric(arguments.rubric).tasks) {
    admit(task.scene, {Command::kGrade});
    requireMotion(task.scene);
  }
  std::optional<Progress> progress(std::in_place, "grading");
  std::optional<scene::Work> work;
  const Grades grades =
      grade({arguments.folder, arguments.rubric, arguments.output, arguments.jobs, arguments.again},
            [&](int of, int done) {
              if (done == 0)
                work.emplace("submissions", of);
              else
                work->done();
              progress->note(fmt::format("{} of {}", done, of));
            });
  work.reset();
  progress.reset();
  writeGrades(grades, arguments.output, DYNWITNESS_VERSION);
  fmt::print("{}written: {}/index.html, grades.csv, junit.xml, gradescope/\n",
             gradesText(grades, tonedVerdict), arguments.output);
  return grades.ungraded() > 0 ? 1 : 0;
}

}  // namespace

Run addGrade(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  command->add_option("folder", arguments->folder, "Folder: one submission a file or sub-folder");
  command->add_option("--rubric", arguments->rubric,
                      "TOML file: how submissions are started, scenes, marks");
  addOutput(*command, arguments->output, "folder for the results")->capture_default_str();
  addProcesses(*command, arguments->jobs, "a submission each at a time");
  command->add_flag("--again", arguments->again, "Run those, too, that were run before");
  command->add_flag("--example", arguments->example, "Print a rubric, with comments");
  command->footer(
      "Examples:\n"
      "  dynwitness grade --example > rubric.toml\n"
      "  dynwitness grade submissions --rubric rubric.toml -o grades\n"
      "Each submission runs on a copy in a folder of its own, within the rubric's limits, and where "
      "the machine\n"
      "can hide anything (user namespaces) sees neither the others nor a network. Ended at any "
      "moment, it goes on\n"
      "where it stopped; what is new or was changed is run (again). Exit status: 0 all are graded, "
      "whatever the\n"
      "marks; 1 some could not be, for a reason that is not theirs.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
