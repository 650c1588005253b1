// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness simulate: the motion of a scene with its closures, springs and loads.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "crosscheck/cli/chart_files.hpp"
#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/forces_over_time.hpp"
#include "crosscheck/cli/given_states.hpp"
#include "crosscheck/cli/motions_picture.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/simulation_csv.hpp"
#include "crosscheck/cli/simulation_report.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/closure_gap.hpp"
#include "crosscheck/motion/formulations.hpp"
#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/motion_tables.hpp"
#include "crosscheck/report/show.hpp"
#include "crosscheck/system/files.hpp"
#include "scene/mimic.hpp"
#include "scene/words.hpp"
#include "scene/work.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct SimulateArguments {
  GivenScene scene;
  StartAsked start;
  std::string csv, json, view, plot, stabilisation,
      formulation = "index1", controller = name(Controller::Tasks::kConstraint);
  std::vector<std::string> methods;  ///< none: what the formulation takes
  PictureLook look;
  std::vector<double> task_gains, posture;  ///< stiffness and damping, or not given
  double step_error = 0;                    ///< 0: not given
  std::string until, forces;
  std::vector<std::string> tau;
  int times = 1;
  bool compare = false, runs_once = false, reactions = false;
  SimulateOptions options;

  /// One motion by several methods or forms, each held to a reference.
  bool isComparison() const { return compare || methods.size() > 1 || !plot.empty(); }
};

constexpr Stabilisation kStabilisations[] = {Stabilisation::kNone, Stabilisation::kBaumgarte,
                                             Stabilisation::kProjection};
constexpr Controller::Tasks kControllers[] = {Controller::Tasks::kConstraint,
                                              Controller::Tasks::kOperationalSpace,
                                              Controller::Tasks::kImpedance};
constexpr Formulation kFormulations[] = {Formulation::kIndex1, Formulation::kIndex2,
                                         Formulation::kIndex3, Formulation::kGgl};

/// What was not given follows from what was, and from what the published motions take.
SimulateOptions completed(const SimulateArguments& arguments,
                          const std::vector<MotionTable>& tables) {
  SimulateOptions options = arguments.options;
  for (const Formulation formulation : kFormulations)
    if (arguments.formulation == name(formulation)) options.formulation = formulation;
  const bool is_first = options.formulation == Formulation::kIndex1;
  if (!arguments.methods.empty())
    options.method = arguments.methods.front();
  else if (!is_first)
    options.method = "radau_iia_5";
  if (!is_first) options.stabilisation = Stabilisation::kNone;
  for (const Stabilisation stabilisation : kStabilisations)
    if (arguments.stabilisation == name(stabilisation)) options.stabilisation = stabilisation;
  for (const Controller::Tasks tasks : kControllers)
    if (arguments.controller == name(tasks)) options.controller.tasks = tasks;
  if (!arguments.task_gains.empty()) {
    options.controller.task_stiffness = arguments.task_gains[0];
    options.controller.task_damping = arguments.task_gains[1];
  }
  if (!arguments.posture.empty()) {
    options.controller.posture_stiffness = arguments.posture[0];
    options.controller.posture_damping = arguments.posture[1];
  }
  for (const MotionTable& table : tables) {
    const SimulateOptions asked = optionsFor(table);
    options.step_error = std::min(options.step_error, asked.step_error);
    options.more_times.insert(options.more_times.end(), asked.more_times.begin(),
                              asked.more_times.end());
  }
  if (arguments.step_error != 0) options.step_error = arguments.step_error;
  return options;
}

/** --until "q2 = 0 rising": a coordinate by place (q2, qd1), or a joint with one q by its name, and
    a number. @throws scene::InputError  it says something else */
AwaitedEvent eventOf(const SimulateArguments& arguments, const scene::Scene& scene) {
  const std::string& text = arguments.until;
  if (text.empty()) return {};
  const auto trimmed = [](const std::string& word) { return std::string(scene::trimmed(word)); };
  const std::size_t equals = text.find('=');
  const std::string name = trimmed(text.substr(0, equals));
  std::string value = equals == std::string::npos ? "" : trimmed(text.substr(equals + 1));
  AwaitedEvent event;
  event.times = arguments.times;
  for (const auto& [word, direction] : {std::pair(" rising", 1), {" falling", -1}}) {
    const std::string ending = word;
    if (value.size() <= ending.size() ||
        value.compare(value.size() - ending.size(), ending.size(), ending) != 0)
      continue;
    value = trimmed(value.substr(0, value.size() - ending.size()));
    event.direction = direction;
  }
  if (name.empty() || value.empty())
    throw scene::InputError(
        {}, fmt::format("--until: read '{}', allowed: NAME = NUMBER, then rising or falling or "
                        "neither, NAME one of q1 .., qd1 .., or a joint's",
                        text));
  const std::vector<int> given = scene::givenSlots(scene.mechanism);
  std::vector<NamedPlace> places = placesNamed("q", positionNames(scene.mechanism));
  for (NamedPlace& place : places) place.at = given[static_cast<std::size_t>(place.at)];
  for (int k = 0; k < scene.mechanism.dof(); ++k)  // rates from -1 down
    places.push_back({fmt::format("qd{}", k + 1), -1 - k});
  const double level = numberIn("--until", value, scene);
  const int at = placeMeant("--until", name, places);
  event.of = [at, level](double, const double* q, const double* qd) {
    return (at >= 0 ? q[at] : qd[-1 - at]) - level;
  };
  return event;
}

/// Tells how far runs of the same duration, one after the other, have come.
class Runs {
 public:
  Runs(int count, double duration)
      : count_(count),
        stages_(std::max(kStages / count, 1)),
        duration_(duration),
        progress_(count * stages_, kQuiet, false) {}
  void at(double time) {
    if (time < last_) begun_ = ++runs_ * stages_;
    last_ = time;
    work_.doneTo((runs_ + time / duration_) / count_);
    for (; begun_ <= (runs_ + time / duration_) * stages_; ++begun_)
      progress_.stage(fmt::format("t = {:.3g} of {} s", time, duration_));
  }

 private:
  static constexpr int kStages = 20;
  static constexpr double kQuiet = 2;  // [s]
  int count_, stages_;
  double duration_, last_ = 0;
  int runs_ = 0, begun_ = 0;
  scene::Work work_{"", 1};
  Progress progress_;
};

/// What a comparison leaves beside its table.
void writeComparison(const SimulateArguments& arguments, const scene::Scene& scene,
                     const FormulationComparison& comparison) {
  std::vector<const FormulationRun*> runs;
  for (const FormulationRun& run : comparison.runs)
    if (run.failure.empty()) runs.push_back(&run);
  std::optional<ReactionsAlong> reactions;
  if (arguments.reactions) reactions.emplace(scene);
  if (!arguments.csv.empty())
    writeWholeFile(arguments.csv, csvOf(runs, scene.mechanism, reactions ? &*reactions : nullptr));
  if (!arguments.plot.empty()) drawMotions(scene, comparison, arguments.plot, arguments.look);
}

int compareAll(const scene::Scene& scene, SimulateOptions options,
               const std::vector<MotionTable>& tables, const SimulateArguments& arguments) {
  const std::string& json_file = arguments.json;
  const std::vector<std::string> methods =
      arguments.methods.empty() ? std::vector<std::string>{options.method} : arguments.methods;
  FormulationComparison comparison;
  {
    const int count = arguments.compare ? kComparedFormulations : static_cast<int>(methods.size());
    Runs runs(count + 1, options.duration);  // the reference too
    options.progress = [&](double time) { runs.at(time); };
    comparison = arguments.compare ? compareFormulations(scene, options)
                                   : compareMethods(scene, options, methods);
  }
  fmt::print(
      "{}: {} s; methods that choose their steps at an error of {:.3g} a step, others at steps of {} s\n"
      "errors against index 1 with projection, {}\n\n",
      scene.name, options.duration, options.step_error, options.step,
      describe(comparison.reference));
  fmt::print("{:<7} {:<10} {:<22} {:>7} {:>9} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}{}\n",
             "form", "kept by", "method", "steps", "evaluat.", "time s", "phi", "J qd", "energy J",
             "q", "qd", "lambda", tables.empty() ? "" : "  published");
  nlohmann::json rows = nlohmann::json::array();
  for (const FormulationRun& run : comparison.runs) {
    nlohmann::json row = {{"formulation", name(run.formulation)},
                          {"stabilisation", name(run.stabilisation)},
                          {"method", run.method}};
    fmt::print("{:<7} {:<10} {:<22} ", name(run.formulation), name(run.stabilisation), run.method);
    if (!run.failure.empty()) {
      fmt::print("{}\n", run.failure);
      row["failure"] = run.failure;
      rows.push_back(row);
      continue;
    }
    const Simulation& r = run.result;
    const std::string lambda = run.lambda_error ? fmt::format("{:.1e}", *run.lambda_error) : "-";
    fmt::print("{:>7} {:>9} {:>8.2g} {:>8.1e} {:>8.1e} {:>8.1e} {:>8.1e} {:>8.1e} {:>8}", r.steps,
               r.evaluations, r.cpu_s, r.worst_phi, r.worst_phi_rate, r.worst_energy, run.q_error,
               run.qd_error, lambda);
    row.update(jsonOf(r));
    row["q_error"] = run.q_error;
    row["qd_error"] = run.qd_error;
    if (run.lambda_error) row["lambda_error"] = *run.lambda_error;
    for (const MotionTable& table : tables) {
      const MotionVerdict verdict = compareMotion(scene, r, table);
      if (verdict.values == 0) continue;
      fmt::print("  {:.1e}", verdict.worst);
      row["published"].push_back(jsonOf(table, verdict));
    }
    fmt::print("\n");
    rows.push_back(row);
  }
  if (comparison.most_lambda > 0)
    fmt::print("\nlargest multiplier {:.3g}\n", comparison.most_lambda);
  if (!json_file.empty()) {
    nlohmann::json all = jsonHead(scene, options);
    all["reference"] = describe(comparison.reference);
    all["largest_multiplier"] = comparison.most_lambda;
    all["runs"] = rows;
    writeWholeFile(json_file, all.dump(2) + "\n");
  }
  writeComparison(arguments, scene, comparison);
  return std::all_of(comparison.runs.begin(), comparison.runs.end(),
                     [](const FormulationRun& run) { return run.failure.empty(); })
             ? 0
             : 1;
}

/// The scene's picture, with its motion and energy to be played.
std::string viewOfMotion(const scene::Scene& scene, const Simulation& simulation) {
  View view = viewOf(scene);
  ViewMotion motion;
  motion.energies = {{"total", {}}, {"kinetic", {}}, {"potential", {}}};
  for (const Simulation::Point& point : simulation.points) {
    motion.times.push_back(point.time);
    motion.q.push_back(point.q);
    motion.energies[0].joules.push_back(point.kinetic + point.potential);
    motion.energies[1].joules.push_back(point.kinetic);
    motion.energies[2].joules.push_back(point.potential);
  }
  view.motion = std::move(motion);
  return showPage({scene}, view, DYNWITNESS_VERSION);
}

/// @throws scene::InputError  what is of one run, beside several
void requireOfOneRun(const SimulateArguments& arguments) {
  if (!arguments.isComparison()) return;
  const std::pair<const char*, bool> ofOne[] = {{"--until", !arguments.until.empty()},
                                                {"--view", !arguments.view.empty()},
                                                {"--once", arguments.runs_once}};
  for (const auto& [option, is_given] : ofOne)
    if (is_given)
      throw scene::InputError(
          {}, fmt::format("{} with several runs (--compare, --plot, several methods), allowed: "
                          "with one",
                          option));
  if (arguments.compare && !arguments.csv.empty())
    throw scene::InputError({}, "--csv with --compare, allowed: --json, or --csv with one form");
  if (arguments.compare && arguments.methods.size() > 1)
    throw scene::InputError({},
                            "--compare with several methods, allowed: one explicit or implicit "
                            "method, or several without --compare");
}

int runSimulate(SimulateArguments arguments) {
  for (const std::string& file : {arguments.csv, arguments.json, arguments.view, arguments.plot})
    requireWritableFile(file);
  requireOfOneRun(arguments);
  if (!arguments.plot.empty()) arguments.look = lookOfFile(arguments.plot, arguments.look);
  requireFileOfConvention(arguments.start);
  const scene::Scene scene =
      startedAt(admitted(arguments.scene, Command::kSimulate), arguments.start);
  requireMotion(scene);
  // published motions start where the scene does, and nobody pushes
  const std::vector<MotionTable> tables =
      arguments.start.isGiven() || !arguments.tau.empty() || !arguments.forces.empty()
          ? std::vector<MotionTable>()
          : motionTables(scene);
  SimulateOptions options = completed(arguments, tables);
  options.until = eventOf(arguments, scene);
  if (!arguments.tau.empty()) options.forces = forcesOfTime(arguments.tau, scene);
  if (!arguments.forces.empty())
    options.forces = forcesOfFile(arguments.forces, scene, options.duration);
  if (const ClosureGap gap = ClosureGaps::ofStart(scene); gap.is_open)
    tell(fmt::format("{}: the start leaves closures open, {}: it is moved onto them first\n",
                     scene.name, gap.text()));
  if (arguments.compare && !scene.mechanism.acceleration_constraints.empty())
    throw scene::InputError({scene.file.string(), 0},
                            "--compare with acceleration constraints, which implicit methods do "
                            "not take, allowed: one run by an explicit method");
  if (arguments.isComparison()) return compareAll(scene, options, tables, arguments);
  Simulation result;
  std::optional<Simulation> rerun;
  std::string no_rerun;
  {
    Runs runs(arguments.runs_once ? 1 : 2, options.duration);
    options.progress = [&](double time) { runs.at(time); };
    result = simulate(scene, options);
    try {
      if (!arguments.runs_once) rerun = simulate(scene, finer(options));
    } catch (const std::runtime_error& error) {  // smaller steps than it can take
      no_rerun = error.what();
    }
  }
  nlohmann::json all;
  const bool agree = reportRun(
      {scene, options, arguments.until, tables, result, rerun ? &*rerun : nullptr, no_rerun}, &all);
  std::optional<ReactionsAlong> reactions;
  if (arguments.reactions) reactions.emplace(scene);
  if (!arguments.csv.empty())
    writeWholeFile(arguments.csv,
                   csvOf(result, scene.mechanism, reactions ? &*reactions : nullptr));
  if (!arguments.json.empty()) writeWholeFile(arguments.json, all.dump(2) + "\n");
  if (!arguments.view.empty()) writeWholeFile(arguments.view, viewOfMotion(scene, result));
  return agree ? 0 : 1;
}

}  // namespace

Run addSimulate(CLI::App* command) {
  auto arguments = std::make_shared<SimulateArguments>();
  command->footer(
      "dynwitness simulate car_axis --duration 3\n"
      "dynwitness simulate car_axis --duration 3 --formulation index3 --step 0.001\n"
      "dynwitness simulate andrews_squeezer --duration 0.03 --step 2.5e-5 --compare\n"
      "dynwitness simulate double_pendulum --q 1,0.5 --until \"q2 = 0 rising\" --times 5\n"
      "dynwitness simulate acrobot --tau \"elbow=2*sin(3*t)\" --csv motion.csv\n"
      "dynwitness simulate acrobot --method runge_kutta4,gauss_4,implicit_midpoint --plot methods.svg\n"
      "dynwitness simulate two_handed --duration 1   # held by its constraints\n"
      "dynwitness simulate two_handed --duration 1 --controller operational_space --task-gains 100,20 --posture "
      "20,4");
  addScene(*command, arguments->scene, "Scene");
  addStart(*command, arguments->start);
  command->add_option("--duration", arguments->options.duration, "Duration [s]: simulated time")
      ->check(positive())
      ->capture_default_str();
  command
      ->add_option(
          "--formulation", arguments->formulation,
          "Which form of the closures is solved: index1 (phi'' = 0), index2 (phi' = 0), index3 "
          "(phi = 0), ggl (the last two, Gear, Leimkuhler and Gupta)")
      ->capture_default_str()
      ->check(oneOf({"index1", "index2", "index3", "ggl"}));
  command
      ->add_option(
          "--method", arguments->methods,
          "Integrators: [runge_kutta_fehlberg78, which with runge_kutta_dopri5 chooses its steps by "
          "--step-error; radau_iia_5 where the formulation is not index1] " +
              integratorNames() +
              "; of several, with commas, a table says what each costs and how far it is off")
      ->delimiter(',');
  command
      ->add_option(
          "--step-error", arguments->step_error,
          "Error of a step of methods that choose theirs, relative and absolute [1e-10, or what a published "
          "motion of the scene takes]")
      ->check(positive());
  command->add_option("--step", arguments->options.step, "Step size [s]: of the other methods")
      ->check(positive())
      ->capture_default_str();
  command
      ->add_option("--stabilisation", arguments->stabilisation,
                   "How index 1 keeps closures: none, baumgarte, or projection after each step "
                   "[projection; none for the others]")
      ->check(oneOf({"none", "baumgarte", "projection"}));
  command
      ->add_option("--baumgarte-rate", arguments->options.baumgarte_rate,
                   "w [1/s] in phi'' + 2 w phi' + w^2 phi = 0")
      ->check(nonNegative())
      ->capture_default_str();
  command
      ->add_option(
          "--controller", arguments->controller,
          "What acceleration constraints of the scene are: constraint (ideal forces hold "
          "them), or tasks that motors do: operational_space (J' Lambda and the posture in "
          "its null space), impedance (J' times a spring and a damper)")
      ->capture_default_str()
      ->check(oneOf({"constraint", "operational_space", "impedance"}));
  command
      ->add_option("--task-gains", arguments->task_gains,
                   "KP,KD of tasks, about the integrals of their values: 1/s^2 and 1/s in "
                   "operational space, N/m and N s/m of an impedance (N m s of turns)")
      ->delimiter(',')
      ->expected(2);
  command
      ->add_option("--posture", arguments->posture,
                   "KP,KD: joint forces KP (q(0) - q) - KD qd of every free joint with one axis "
                   "[N m/rad, N m s/rad; N/m, N s/m]")
      ->delimiter(',')
      ->expected(2);
  command->add_flag(
      "--compare", arguments->compare,
      "All formulations in one table: cost, drift, energy, errors of q, qd and multipliers");
  addJson(*command, arguments->json,
          "ranks, drift, cost and published motions; with --compare its table");
  command
      ->add_option("--outputs", arguments->options.outputs,
                   "Rows of the CSV file, and states of --view")
      ->check(whole(1, 1000000))
      ->capture_default_str();
  CLI::Option* csv = command->add_option(
      "--csv", arguments->csv,
      "Table as a CSV file: time, q, qd, qdd, tau, multipliers, energies, drift, of several methods with a "
      "column method before; `evaluate --states FILE --keep` reads it");
  command
      ->add_flag(
          "--reactions", arguments->reactions,
          "The CSV file has what the joints transmit, too, as `evaluate --quantity reactions` has it")
      ->needs(csv);
  command
      ->add_flag(
          "--once", arguments->runs_once,
          "No second run by another method at half the error (or at half the step), which says how "
          "far off this one is")
      ->excludes("--compare");
  CLI::Option* until = command->add_option(
      "--until", arguments->until,
      "The run ends at an event, \"q2 = 0 rising\": a coordinate (q2, qd1, or a joint's name) passes a "
      "number, rising, falling or either; to be seen it has to be on another side at the ends of a step. "
      "Exit status 1 where the duration ends before");
  until->excludes("--compare");
  command
      ->add_option("--times", arguments->times,
                   "Such events, of which the last ends the run; their times and periods are told")
      ->capture_default_str()
      ->check(whole(1, 1000000))
      ->needs(until);
  CLI::Option* tau = command->add_option(
      "--tau", arguments->tau,
      "Joint forces [N m, N], in the order of `show` or by joint, elbow=0.3; without: none. Functions of "
      "t, elbow=2*sin(3*t), too");
  tau->delimiter(',')->type_name("FLOAT:finite ...");
  command
      ->add_option(
          "--forces", arguments->forces,
          "Joint forces of a CSV file: columns t (or time_s) and tau1.., lines between its rows")
      ->excludes(tau);
  CLI::Option* plot = command->add_option(
      "--plot", arguments->plot,
      "Chart, a file that ends in .svg (as one without ending is), .png or .pdf: energy error and "
      "distance of the methods from a reference against time; their table is printed");
  plot->excludes("--compare");
  addBackground(*command, arguments->look);
  command->get_option("--background")->needs(plot);
  command
      ->add_option("--view", arguments->view,
                   "File: a picture that plays the motion, energy beside it, as HTML")
      ->excludes("--compare");
  return [arguments] { return runSimulate(*arguments); };
}

}  // namespace dynwitness::cli
