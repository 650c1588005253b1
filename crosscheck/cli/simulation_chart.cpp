// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/simulation_chart.hpp"

#include <fmt/format.h>

#include "crosscheck/cli/chart_files.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/closed_work.hpp"
#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/report/work_drawing.hpp"
#include "crosscheck/system/environment.hpp"
#include "crosscheck/system/files.hpp"

namespace dynwitness::cli {

using namespace crosscheck;

std::shared_ptr<SimulationChartArguments> addSimulationChart(CLI::App* command) {
  auto arguments = std::make_shared<SimulationChartArguments>();
  CLI::Option* simulate = command->add_flag(
      "--simulate", arguments->is_asked,
      "Whole simulations from the scene's start instead: calls and time against error of the end "
      "and energy error, by steps of each integrator; with closed loops or springs between points by "
      "steps and form of the constraints (projection, Baumgarte, index 1, 2, 3)");
  command
      ->add_option("--method", arguments->options.methods,
                   "Integrators: with --simulate [all that know the scene]; " + integratorNames())
      ->delimiter(',')
      ->needs(simulate);
  command->add_option("--duration", arguments->options.duration, "Duration [s]: with --simulate")
      ->check(positive())
      ->capture_default_str()
      ->needs(simulate);
  return arguments;
}

int runSimulationChart(const GivenScene& given, const SimulationChartArguments& arguments,
                       const std::string& output, const PictureLook& look) {
  const scene::Scene scene = readScene(given);
  const bool is_closed = !scene.mechanism.isOpenTree();
  admit(scene, {is_closed ? Command::kSimulate : Command::kDrift});
  requireMotion(scene);
  if (!output.empty()) requireWritableFolder(output);
  WorkOptions options = arguments.options;
  WorkPrecision work;
  {
    const auto all = is_closed ? closedMethods().size() : integrators().size();
    const auto methods = options.methods.empty() ? all : options.methods.size();
    Progress progress(static_cast<int>(methods) + 1);
    options.progress = [&](const std::string& stage) { progress.stage(stage); };
    work = is_closed ? measureClosedWork(scene, options) : measureWork(scene, options);
  }
  work.machine = cpuModel();
  fmt::print("{}", workCsv(work));
  if (output.empty()) return 0;
  const std::string stem = safeName(scene.name) + "_simulate";
  writeCharts({{stem, workCsv(work)}}, {{stem, workScript(work, stem, kChartStyle)}}, output, look);
  return 0;
}

}  // namespace dynwitness::cli
