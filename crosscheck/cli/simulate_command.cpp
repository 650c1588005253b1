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
#include "crosscheck/cli/given_states.hpp"
#include "crosscheck/cli/motions_picture.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/inputs/states_file.hpp"
#include "crosscheck/motion/closure_gap.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/motion/formulations.hpp"
#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/motion_tables.hpp"
#include "crosscheck/motion/state_gap.hpp"
#include "crosscheck/report/show.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/witnesses/column_names.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/mimic.hpp"
#include "scene/motion.hpp"
#include "scene/nearest_name.hpp"
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

/// "radau_iia_5, steps of 0.001 s" or "runge_kutta_dopri5, error of a step 1e-10"
std::string describe(const SimulateOptions& options) {
  const bool is_adaptive = !hasEqualSteps(options.method);
  return is_adaptive ? fmt::format("{}, error of a step {:.3g}", options.method, options.step_error)
                     : fmt::format("{}, steps of {} s", options.method, options.step);
}

/** --until "q2 = 0 rising": a coordinate by place (q2, qd1), or a joint with one q by its name, and
    a number. @throws scene::InputError  it says something else */
AwaitedEvent eventOf(const SimulateArguments& arguments, const scene::Scene& scene) {
  const std::string& text = arguments.until;
  if (text.empty()) return {};
  const auto trimmed = [](const std::string& word) {
    const std::size_t begin = word.find_first_not_of(' ');
    return begin == std::string::npos ? std::string()
                                      : word.substr(begin, word.find_last_not_of(' ') - begin + 1);
  };
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

using Forces = std::function<void(double, std::vector<double>*)>;

/// --tau: functions of t, of all joints or by name.
Forces forcesOfTime(const std::vector<std::string>& words, const scene::Scene& scene) {
  const scene::Mechanism& mechanism = scene.mechanism;
  const std::vector<std::string> names = mechanism.rateLabels();
  const std::vector<NamedPlace> places = placesNamed("tau", names);
  const std::vector<const scene::Expression*> motions = mechanism.motions();
  const bool all_named = std::all_of(words.begin(), words.end(), [](const std::string& word) {
    return word.find('=') != std::string::npos;
  });
  std::vector<std::pair<std::size_t, scene::Expression>> parts;
  const auto number = std::make_shared<scene::RealNumbers<double>>(mechanism);
  for (std::size_t k = 0; k < words.size(); ++k) {
    const std::size_t equals = words[k].find('=');
    std::size_t at = k;
    if (all_named) {
      at = static_cast<std::size_t>(placeMeant("--tau", words[k].substr(0, equals), places));
      for (const auto& part : parts)
        if (part.first == at)
          throw scene::InputError(
              {}, fmt::format("--tau: read '{}', which was given before, allowed: each once",
                              words[k]));
    }
    const std::string text = all_named ? words[k].substr(equals + 1) : words[k];
    std::string reason;
    try {
      const scene::Expression function = scene::Expression::parseOfTime(text);
      if (!std::isfinite(scene::motionAt(function, *number, 0.0).value))
        reason = "; it is not finite at t = 0";
      else
        parts.emplace_back(at, function);
    } catch (const scene::InputError& error) {
      reason = std::string("; ") + error.what();
    }
    if (!reason.empty())
      throw scene::InputError({}, fmt::format("--tau: read '{}', allowed: a function of t, in the "
                                              "scene's parameters and pi{}",
                                              text, reason));
    if (at < motions.size() && motions[at] != nullptr)
      throw scene::InputError(
          {}, fmt::format("--tau: '{}' is driven, and its force is what the drive takes, allowed: "
                          "joints that are free",
                          names[at]));
  }
  if (!all_named && words.size() != names.size())
    throw scene::InputError(
        {}, fmt::format("--tau: {} functions, allowed: {}, or by joint, {}=2*sin(3*t)",
                        words.size(), names.size(), names.front()));
  return [parts, number](double time, std::vector<double>* tau) {
    for (const auto& [at, function] : parts)
      (*tau)[at] += scene::motionAt(function, *number, time).value;
  };
}

/// --forces: rows of a file, lines between them.
Forces forcesOfFile(const std::string& file, const scene::Scene& scene, double duration) {
  StatesReader reader(file, scene.mechanism, {{"t", "time_s"}, false, true});
  const std::vector<std::string>& others = reader.otherNames();
  if (others.size() != 1 || !reader.gives("tau"))
    throw scene::InputError({file, 1},
                            "columns t (or time_s) and tau1.. are needed, one of the two "
                            "times and all of tau");
  auto rows = std::make_shared<std::vector<std::pair<double, std::vector<double>>>>();
  scene::State<double> state;
  while (reader.next(&state)) {
    const double time = reader.others().front();
    if (!rows->empty() && !(time > rows->back().first))
      throw scene::InputError(
          {file, 0}, fmt::format("row {}: t = {} s does not come after {} s, allowed: times "
                                 "that rise",
                                 rows->size() + 1, time, rows->back().first));
    rows->emplace_back(time, state.tau);
  }
  if (rows->empty() || rows->front().first > 0 || rows->back().first < duration)
    throw scene::InputError(
        {file, 0}, fmt::format("its times do not span 0 to {} s, allowed: a file that does, or a "
                               "shorter --duration",
                               duration));
  return [rows](double time, std::vector<double>* tau) {
    auto next = std::upper_bound(
        rows->begin(), rows->end(), time,
        [](double t, const std::pair<double, std::vector<double>>& row) { return t < row.first; });
    if (next == rows->begin()) ++next;
    if (next == rows->end()) --next;
    const auto& before = *(next == rows->begin() ? next : next - 1);
    const double share =
        next->first > before.first
            ? std::clamp((time - before.first) / (next->first - before.first), 0.0, 1.0)
            : 0;
    for (std::size_t k = 0; k < tau->size(); ++k)
      (*tau)[k] += before.second[k] + share * (next->second[k] - before.second[k]);
  };
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

/// What a run cost and how far it was off, for programs.
nlohmann::json jsonOf(const Simulation& r) {
  return {{"steps", r.steps},
          {"rejected", r.rejected},
          {"evaluations", r.evaluations},
          {"cpu_s", r.cpu_s},
          {"phi", r.worst_phi},
          {"phi_rate", r.worst_phi_rate},
          {"energy_error_J", r.worst_energy}};
}
nlohmann::json jsonOf(const MotionTable& table, const MotionVerdict& verdict) {
  return {{"title", table.title}, {"worst", verdict.worst}, {"ratio", verdict.ratio}};
}
nlohmann::json jsonHead(const scene::Scene& scene, const SimulateOptions& options) {
  return {{"dynwitness", DYNWITNESS_VERSION},
          {"scene", scene.name},
          {"duration_s", options.duration},
          {"step_error", options.step_error},
          {"step_s", options.step}};
}

/// Acceleration constraints, or the controller's tasks, along the motion.
void printTasks(const Simulation& result, const Controller& controller) {
  for (std::size_t k = 0; k < result.tasks.size(); ++k) {
    const Simulation::Task& task = result.tasks[k];
    std::string drift = fmt::format("xd {:.2g}", task.worst_rate);
    if (task.has_place) drift += fmt::format(", x {:.2g} m", task.worst_place);
    if (!task.has_rate) drift = "no integral: its direction turns with the link";
    fmt::print("{}'{}': nu {:.6g} at the end; {} {}\n",
               k > 0                                                ? "             "
               : controller.tasks == Controller::Tasks::kConstraint ? "held         "
                                                                    : "tasks        ",
               task.name, result.points.back().nu[k],
               !task.has_rate ? ""
               : task.yields  ? "gave way by"
                              : "off its integral by",
               drift);
  }
}
nlohmann::json jsonOf(const Simulation::Task& task) {
  nlohmann::json out = {{"name", task.name}, {"yields", task.yields}};
  if (task.has_rate) out["rate_error"] = task.worst_rate;
  if (task.has_place) out["place_error_m"] = task.worst_place;
  return out;
}

/// What joints transmit along a motion, as `evaluate --quantity reactions` has it.
class ReactionsAlong {
 public:
  explicit ReactionsAlong(const scene::Scene& scene)
      : names_(columnNames(Quantity::kReactions, scene.mechanism)) {
    if (scene.mechanism.isOpenTree() && scene.mechanism.acceleration_constraints.empty())
      sweep_ = selectWitnesses({"newton_euler"}).front().make(scene).value();
    else
      constrained_.emplace(scene);
  }
  const std::vector<std::string>& names() const { return names_; }
  /// NaN where redundant constraints leave them open.
  Eigen::MatrixXd at(const Simulation::Point& point) const {
    scene::State<double> state;
    for (const double q : point.q) state.x.push_back(scene::jointPosition(q));
    state.qd = point.qd;
    state.qdd = point.qdd;
    state.tau = forcesOf(point);
    return sweep_ ? sweep_->value(Quantity::kReactions, state)
                  : constrained_->answer(ConstrainedQuantity::kReactions, state);
  }
  /// Joint forces, zeros where nobody gives any: a states file says what it does not leave out.
  static std::vector<double> forcesOf(const Simulation::Point& point) {
    return point.tau.empty() ? std::vector<double>(point.qd.size(), 0.0) : point.tau;
  }

 private:
  std::vector<std::string> names_;
  std::unique_ptr<Witness> sweep_;
  std::optional<ConstrainedQuantities> constrained_;
};

/// One row an output: time, q, qd, qdd, tau, multipliers, energies, how far constraints and energy
/// are off; and reactions, where they are asked.
std::string csvOf(const Simulation& simulation, const scene::Mechanism& mechanism,
                  const ReactionsAlong* reactions) {
  const Simulation::Point& first = simulation.points.front();
  const std::vector<int> given = scene::givenSlots(mechanism);  // what a states file may say
  std::string csv = hasOrientations(mechanism) ? "# convention: dynwitness\n" : "";
  csv += "time_s";
  for (std::size_t i = 1; i <= given.size(); ++i) csv += fmt::format(",q{}", i);
  for (const char* group : {"qd", "qdd", "tau"})
    for (std::size_t i = 1; i <= first.qd.size(); ++i) csv += fmt::format(",{}{}", group, i);
  for (std::size_t i = 1; i <= first.lambda.size(); ++i) csv += fmt::format(",lambda{}", i);
  for (std::size_t i = 1; i <= first.nu.size(); ++i) csv += fmt::format(",nu{}", i);
  csv += ",kinetic_J,potential_J,phi,phi_rate,energy_error_J";
  if (reactions)
    for (const std::string& name : reactions->names()) csv += ',' + name;
  csv += '\n';
  for (const Simulation::Point& point : simulation.points) {
    const std::vector<double> tau = ReactionsAlong::forcesOf(point);
    csv += fmt::format("{:.17g}", point.time);
    for (const int slot : given) csv += fmt::format(",{:.17g}", point.q[slot]);
    for (const auto* values : {&point.qd, &point.qdd, &tau, &point.lambda, &point.nu})
      for (const double v : *values) csv += fmt::format(",{:.17g}", v);
    csv += fmt::format(",{:.17g},{:.17g}", point.kinetic, point.potential);
    csv += fmt::format(",{:.3g},{:.3g},{:.3g}", point.phi, point.phi_rate, point.energy_error);
    if (reactions) {
      const Eigen::VectorXd transmitted = reactions->at(point).reshaped();
      for (const double v : transmitted) csv += fmt::format(",{:.17g}", v);
    }
    csv += '\n';
  }
  return csv;
}

/// One row an output: time, q, qd, qdd, multipliers, energies, and how far constraints and energy
/// are off; of several runs, whose method it is before.
std::string csvOf(const std::vector<const FormulationRun*>& runs, const scene::Mechanism& mechanism,
                  const ReactionsAlong* reactions) {
  std::string csv;
  for (const FormulationRun* run : runs) {
    const std::string rows = csvOf(run->result, mechanism, reactions);
    const std::size_t head = rows.find("\ntime_s") == std::string::npos ? 0 : rows.find('\n') + 1;
    const std::size_t first = rows.find('\n', head) + 1;
    if (csv.empty()) csv = rows.substr(0, head) + "method," + rows.substr(head, first - head);
    for (std::size_t at = first; at < rows.size();) {
      const std::size_t end = rows.find('\n', at) + 1;
      csv += run->method + "," + rows.substr(at, end - at);
      at = end;
    }
  }
  return csv;
}

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
  for (const double error :
       {result.worst_phi, result.worst_phi_rate, result.worst_energy, result.most_kinetic})
    if (!std::isfinite(error))
      throw std::runtime_error("simulate: energy or constraints are not finite along the motion");
  nlohmann::json all = jsonHead(scene, options);
  all["formulation"] = name(options.formulation);
  all["stabilisation"] = name(options.stabilisation);
  all["method"] = options.method;
  all["constraints"] = {{"equations", result.constraints},
                        {"rank_lowest", result.rank_lowest},
                        {"rank_highest", result.rank_highest},
                        {"start_residual", result.start_residual}};
  all["largest_kinetic_energy_J"] = result.most_kinetic;
  all.update(jsonOf(result));

  fmt::print("{}: {} s with {}\n", scene.name, options.duration, describe(options));
  if (result.constraints > 0) {
    fmt::print("constraints  {} equations of rank {}{}, {} freedoms; kept by {}\n",
               result.constraints, result.rank_highest,
               result.rank_lowest == result.rank_highest
                   ? ""
                   : fmt::format(", {} in singular poses", result.rank_lowest),
               scene.mechanism.dof() - result.rank_highest,
               options.formulation != Formulation::kIndex1     ? name(options.formulation)
               : options.stabilisation == Stabilisation::kNone ? "nothing"
                                                               : name(options.stabilisation));
    const Simulation::Point& last = result.points.back();
    std::string lambda;
    for (std::size_t i = 0; i < last.lambda.size() && last.lambda.size() <= 12; ++i)
      lambda += fmt::format("{}{:.10g}{}", i == 0 ? "" : ", ", last.lambda[i],
                            last.determined[i] ? "" : " (not determined)");
    if (!lambda.empty()) fmt::print("multipliers  {} at t = {} s\n", lambda, last.time);
    fmt::print("drift        |phi| {:.2g}, |J qd| {:.2g}; at the start {:.2g}\n", result.worst_phi,
               result.worst_phi_rate, result.start_residual);
  }
  printTasks(result, options.controller);
  fmt::print("energy       |E - E0 - work| {:.2g} J, largest kinetic energy {:.4g} J{}\n",
             result.worst_energy, result.most_kinetic,
             result.points.back().work == 0
                 ? ""
                 : fmt::format(", work {:.6g} J", result.points.back().work));
  for (const Simulation::Task& task : result.tasks) all["tasks"].push_back(jsonOf(task));
  all["controller"] = name(options.controller.tasks);
  all["work_J"] = result.points.back().work;
  const std::string half =
      hasEqualSteps(options.method)
          ? "steps of half the length"
          : fmt::format("{}, half the error a step and twice the outputs", finer(options).method);
  bool agree = true;
  std::optional<MotionGap> off;  // of the run itself
  if (rerun) off = gapBetween(*rerun, result);
  if (off && off->shared == 0) {
    fmt::print(
        "accuracy     not known: the event is before the first row of the table, allowed: more "
        "--outputs\n");
    off.reset();
  } else if (off) {
    double most = 0;
    for (const Simulation::Point& point : result.points)
      for (const double q : point.q) most = std::max(most, std::abs(q));
    const int shared = sharedDigits(off->q, most);
    agree = shared > 0;
    fmt::print(
        "accuracy     a run with {} is up to {:.2g} (rad, m) and {:.2g} (rad/s, m/s) away: positions "
        "{}\n",
        half, off->q, off->qd, agreementText(shared));
    all["rerun"] = {{"with", half}, {"q", off->q}, {"qd", off->qd}, {"shared_digits", shared}};
  } else if (!no_rerun.empty()) {
    fmt::print("accuracy     not known, a run with {} fails: {}\n", half, no_rerun);
  }
  if (options.until.of) {
    std::string times;
    constexpr std::size_t kMost = 12;
    for (std::size_t k = 0; k < result.events.size() && k < kMost; ++k)
      times += fmt::format("{}{:.10g}", k == 0 ? " at t = " : ", ", result.events[k]);
    if (result.events.size() > kMost) times += ", ...";
    fmt::print("events       {} of {} of {}{}{}\n", result.events.size(), options.until.times,
               arguments.until, times, times.empty() ? "" : " s");
    if (const std::size_t count = result.events.size(); count > 1)
      fmt::print("period       {:.10g} s between the last two, {:.10g} s on average\n",
                 result.events[count - 1] - result.events[count - 2],
                 (result.events.back() - result.events.front()) / static_cast<double>(count - 1));
    all["events"] = {
        {"of", arguments.until}, {"asked", options.until.times}, {"times_s", result.events}};
    if (static_cast<int>(result.events.size()) < options.until.times) agree = false;
    if (rerun) {
      const double apart = eventGap(*rerun, result);
      agree = agree && std::isfinite(apart);
      fmt::print("             a run with {} {}\n", half,
                 std::isfinite(apart)
                     ? fmt::format("has them up to {:.2g} s earlier or later", apart)
                     : fmt::format("DISAGREES: it has {}", rerun->events.size()));
      all["events"]["apart_s"] = std::isfinite(apart) ? nlohmann::json(apart) : nullptr;
    }
  }
  fmt::print("cost         {} steps and {} rejected, {} evaluations, {:.3g} s\n", result.steps,
             result.rejected, result.evaluations, result.cpu_s);
  for (const MotionTable& table : tables) {
    const MotionVerdict verdict = compareMotion(scene, result, table);
    if (verdict.values == 0) {
      fmt::print("published    {}: none of its times within {} s\n", table.title, options.duration);
      continue;
    }
    agree = agree && verdict.ratio <= 1;
    all["published"].push_back(jsonOf(table, verdict));
    fmt::print("published    {}: {} values, {}, worst {:.2g}, {:.0f}% of the limit at t = {} s\n",
               table.title, verdict.values, verdict.ratio <= 1 ? "agree" : "DISAGREE",
               verdict.worst, 100 * verdict.ratio, verdict.worst_time);
  }
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
      "dynwitness simulate two_handed --duration 1              its acceleration constraints hold it\n"
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
