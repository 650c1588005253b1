// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness evaluate: quantities of a scene at given states, as a table.
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <unistd.h>

#include "crosscheck/cli/asked_quantity.hpp"
#include "crosscheck/cli/chart_files.hpp"
#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/engine_options.hpp"
#include "crosscheck/cli/evaluate_picture.hpp"
#include "crosscheck/cli/evaluated_columns.hpp"
#include "crosscheck/cli/given_states.hpp"
#include "crosscheck/cli/number_table.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/cli/uncertain_answers.hpp"
#include "crosscheck/inputs/conventions.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/closure_gap.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/system/growing_file.hpp"
#include "crosscheck/witnesses/certain_digits.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

void admitFor(const scene::Scene& scene, const std::vector<std::string>& quantities) {
  std::vector<Command> commands;
  for (const std::string& text : quantities) commands.push_back(commandOf(text));
  admit(scene, commands);
}

/** Whether qdd has to be found from tau before tau or reactions are asked about, and says so.
    @throws scene::InputError  neither is given, or not what the quantities need */
bool findsQddFirst(const scene::Scene& scene, const EvaluateArguments& arguments,
                   const GivenColumns& given) {
  const scene::SourceLocation file{arguments.states.file, 0};
  const bool from_file = !arguments.states.file.empty();
  bool first = false, asks_qdd = false, asks_tau = false, asks_residual = false;
  for (const std::string& quantity : arguments.quantities) {
    const Needs needs = needsOf(quantity, scene.mechanism);
    if (quantity == kResidual && !(given.qdd && given.tau))
      throw scene::InputError(
          file,
          "residual asked, and not both qdd and tau given, allowed: both, since it is what the "
          "two leave of the equations of motion");
    if (needs == Needs::kQdd && !given.qdd && !given.tau)
      throw scene::InputError(
          file, quantity +
                    " asked, and neither qdd nor tau given, allowed: columns qdd1.. (or "
                    "tau1.., and qdd is found first)");
    if ((quantity == "tau" || quantity == kPower) && given.is_tau_zero && !given.qdd &&
        !given.is_start && !scene.mechanism.isDriven() && !hasMoreThanItsTree(scene.mechanism))
      throw scene::InputError(
          {}, quantity +
                  " asked, and neither --qdd nor --tau given: it would be the zeros that are "
                  "taken for tau; allowed: --qdd, or --tau");
    if (needs == Needs::kTau && !given.tau)
      throw scene::InputError(
          file, fmt::format("{} asked, and no tau given, allowed: {} (zeros: no joint forces)",
                            quantity, from_file ? "columns tau1.." : "--tau beside --qdd"));
    asks_qdd = asks_qdd || needs == Needs::kQdd;
    asks_tau = asks_tau || needs == Needs::kTau;
    asks_residual = asks_residual || quantity == kResidual;
    first = first || (needs == Needs::kQdd && !given.qdd);
    if (from_file && !given.qdd && scene.mechanism.isDriven() &&
        commandOf(quantity) != Command::kEvaluateTasks &&
        commandOf(quantity) != Command::kEvaluateJoints && needs != Needs::kNothing)
      throw scene::InputError(
          file, quantity +
                    " asked of a scene with driven joints, and no qdd given, allowed: "
                    "columns qdd1.. too, of which those of driven joints count");
  }
  if (given.is_start && (asks_qdd || asks_tau || asks_residual))
    tell(fmt::format("{}: no state given: the scene's start\n", scene.name));
  if (given.is_tau_zero && (first || asks_tau))
    tell(fmt::format("{}: no --tau: without joint forces (tau = 0)\n", scene.name));
  if (from_file && !given.qd) tell(fmt::format("{}: no qd given: at rest (qd = 0)\n", scene.name));
  if (first)
    tell(fmt::format("{}: no qdd given: it is found from tau first, by forward dynamics\n",
                     scene.name));
  else if (asks_qdd && asks_tau)
    tell(fmt::format(
        "{}: both given: tau and reactions belong to qdd as given, what is found from tau to "
        "another "
        "motion\n",
        scene.name));
  return first;
}

/// Watches states that leave closures open.
class OpenStates {
 public:
  explicit OpenStates(const scene::Scene& scene) : scene_(scene) {
    if (!scene.mechanism.closures.empty()) gaps_ = std::make_unique<ClosureGaps>(scene);
  }
  void see(const scene::State<double>& state) {
    ++row_;
    if (!gaps_) return;
    const ClosureGap gap = gaps_->at(state);
    if (!gap.is_open) return;
    ++open_;
    if (!(gap.phi <= phi_)) phi_ = gap.phi, phi_row_ = row_;
    if (!(gap.phi_rate <= rate_)) rate_ = gap.phi_rate, rate_row_ = row_;
  }
  void tell() const {
    if (open_ == 0) return;
    cli::tell(fmt::format(
        "{}: closures are open at {} of {} states, worst |phi| = {:.3g}{}, |J qd| = {:.3g}{}: "
        "what is said of these is not about the closed mechanism\n",
        scene_.name, open_, row_, phi_, inRow(phi_row_), rate_, inRow(rate_row_)));
  }

 private:
  static std::string inRow(long row) { return row == 0 ? "" : fmt::format(" (state {})", row); }
  const scene::Scene& scene_;
  std::unique_ptr<ClosureGaps> gaps_;  ///< none: no closures
  long row_ = 0, open_ = 0, phi_row_ = 0, rate_row_ = 0;
  double phi_ = 0, rate_ = 0;
};

/// The parts of a state that a table shows, as a file of states has them.
std::vector<std::string> stateColumns(const scene::Mechanism& mechanism, int positions,
                                      const StateUsed& used) {
  std::vector<std::string> names;
  const int n = mechanism.dof();
  for (const auto& [group, count] :
       {std::pair("q", positions), {"qd", n}, {"qdd", used.qdd ? n : 0}, {"tau", used.tau ? n : 0}})
    for (int k = 1; k <= count; ++k) names.push_back(fmt::format("{}{}", group, k));
  return names;
}

/// The state, in the order of stateColumns().
void appendState(const scene::State<double>& state, const StateUsed& used,
                 const Coordinates& coordinates, NumberTable& table, std::string* rows) {
  for (const double q : coordinates.positionsOf(state)) table.append(q, rows);
  const auto append = [&](const std::vector<double>& ours) {
    for (const double x : coordinates.theirs(state, ours)) table.append(x, rows);
  };
  append(state.qd);
  if (used.qdd) {
    std::vector<double> qdd = coordinates.turning(state);
    for (std::size_t k = 0; k < qdd.size(); ++k) qdd[k] += state.qdd[k];
    append(qdd);
  }
  if (used.tau) append(state.tau);
}

/// Reads states in batches, found their qdd where that is needed, and watches closures.
class Batches {
 public:
  /// @param finds_qdd  what is asked needs qdd, which is found from tau first
  /// @param at_once    states that are read before they are answered
  Batches(const EvaluateArguments& arguments, const scene::Scene& scene, States& states,
          std::vector<EvaluatedColumn>& columns, ColumnSources& sources, bool finds_qdd,
          std::size_t at_once)
      : keeps_(arguments.states.keep),
        states_(states),
        columns_(columns),
        sources_(sources),
        finds_qdd_(finds_qdd),
        at_once_(at_once),
        open_(scene) {
    read();
  }
  /// The states to answer next; none: that was all. A program is at the next batch meanwhile.
  bool next() {
    if (at_once_ == 1 && !is_first_) read();
    is_first_ = false;
    std::swap(states_now_, states_ahead_);
    std::swap(kept_now_, kept_ahead_);
    states_ahead_.clear();
    if (states_now_.empty()) return false;
    if (at_once_ > 1) {
      read();
      for (EvaluatedColumn& column : columns_)
        if (column.is_engines) receiveEngineAhead(*column.witness);
    }
    return true;
  }
  const std::vector<scene::State<double>>& states() const { return states_now_; }
  /// Cells of other columns of the file, of a state of this batch.
  const std::vector<std::string>& kept(std::size_t at) const { return kept_now_[at]; }
  void tellOpen() const { open_.tell(); }

 private:
  void read() {
    kept_ahead_.clear();
    states_ahead_.clear();
    for (; states_ahead_.size() < at_once_ && states_.current() != nullptr; states_.next()) {
      states_ahead_.push_back(*states_.current());
      scene::State<double>& state = states_ahead_.back();
      if (keeps_) kept_ahead_.push_back(states_.kept());
      open_.see(state);
      if (!finds_qdd_) continue;
      const Eigen::MatrixXd qdd = sources_.constrained->answer(ConstrainedQuantity::kQdd, state);
      state.qdd.assign(qdd.data(), qdd.data() + qdd.size());
    }
    if (at_once_ == 1) return;
    for (EvaluatedColumn& column : columns_)
      if (column.is_engines) sendEngineAhead(*column.witness, column.quantity, states_ahead_);
  }

  bool keeps_;
  States& states_;
  std::vector<EvaluatedColumn>& columns_;
  ColumnSources& sources_;
  bool finds_qdd_;
  std::size_t at_once_;
  OpenStates open_;
  bool is_first_ = true;
  std::vector<scene::State<double>> states_now_, states_ahead_;
  std::vector<std::vector<std::string>> kept_now_, kept_ahead_;
};

/// Rows a second, on standard error, and the share of the file that is read.
class RowsTold {
 public:
  RowsTold(const EvaluateArguments& arguments, const States& states)
      : work_("", states.fraction() < 0 ? 0 : 1) {
    // rows that scroll by on a terminal are progress enough
    if (!arguments.output.empty() || isatty(STDOUT_FILENO) == 0 ||
        speech().progressAs() == ProgressAs::kJson)
      progress_.emplace("evaluate");
  }
  void done(long row, const States& states) {
    constexpr long kBetweenNotes = 256;
    const auto now = std::chrono::steady_clock::now();
    if (row % kBetweenNotes != kBetweenNotes - 1 && now - noted_ <= std::chrono::milliseconds(200))
      return;
    noted_ = now;
    const std::chrono::duration<double> elapsed = now - begin_;
    if (progress_)
      progress_->note(
          fmt::format("{} rows, {:.0f} a second", row, static_cast<double>(row) / elapsed.count()));
    work_.doneTo(states.fraction());
  }

 private:
  std::optional<Progress> progress_;
  scene::Work work_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now(), noted_ = begin_;
};

/** One row a state, into a file that is there only when all are.
    @param finds_qdd  what is asked needs qdd, which is found from tau first
    @param at_once    states that are read before they are answered */
void writeRows(const scene::Scene& scene, const EvaluateArguments& arguments, States& states,
               std::vector<EvaluatedColumn>& columns, ColumnSources& sources, bool finds_qdd,
               std::size_t at_once, NumberTable& table) {
  constexpr std::size_t kPiece = std::size_t{1} << 18;
  const Coordinates coordinates(scene.mechanism, states.convention());
  const StateUsed used = usedBy(arguments.quantities, scene.mechanism, finds_qdd);
  std::optional<UncertainAnswers> uncertain;
  if (arguments.warn) uncertain.emplace(scene, columns);
  std::optional<RowsTold> told(std::in_place, arguments, states);
  GrowingFile file(arguments.output);
  std::string rows = table.header();
  Batches batches(arguments, scene, states, columns, sources, finds_qdd, at_once);
  long row = 0;
  while (batches.next()) {
    for (std::size_t at = 0; at < batches.states().size(); ++at) {
      const scene::State<double>& state = batches.states()[at];
      ++row;
      if (arguments.states.keep)
        for (const std::string& cell : batches.kept(at)) table.append(cell, &rows);
      sources.at(state);
      if (arguments.states.random > 0) appendState(state, used, coordinates, table, &rows);
      for (std::size_t k = 0; k < columns.size(); ++k) {
        Eigen::MatrixXd value = valueOf(columns[k], sources, state, row);
        if (sources.converted) value = sources.converted->value(columns[k], state, value);
        if (uncertain) uncertain->see(k, columns[k], state, row);
        for (Eigen::Index i = 0; i < value.rows(); ++i)
          for (Eigen::Index j = 0; j < value.cols(); ++j) table.append(value(i, j), &rows);
      }
      table.end(&rows);
    }
    const bool is_awaited = states.mayWait();
    if (rows.size() > kPiece || is_awaited) {
      file.write(rows);
      if (is_awaited) file.flush();
      rows.clear();
    }
    told->done(row, states);
  }
  file.write(rows);
  file.finish();
  told.reset();
  batches.tellOpen();
  if (uncertain) uncertain->tell(columns, row);
}

/// What is drawn of the table: columns behind those that are kept of the file.
std::vector<TrajectoryLine> linesOf(const std::vector<EvaluatedColumn>& columns,
                                    const scene::Scene& scene, EvaluateArguments arguments,
                                    States& states, const ColumnSources& sources,
                                    std::size_t kept) {
  std::vector<TrajectoryLine> lines;
  for (const EvaluatedColumn& column : columns) {
    arguments.units = false;
    const std::vector<std::string> names = headings(column, scene, arguments, states, sources);
    std::vector<std::string> with_units = names;
    try {
      arguments.units = true;
      with_units = headings(column, scene, arguments, states, sources);
    } catch (const scene::InputError&) {  // multipliers, whose units are those of the closures
    }
    for (std::size_t k = 0; k < names.size(); ++k) {
      // "tau1 [N m]"
      std::string unit = with_units[k].substr(names[k].size());
      if (!unit.empty()) unit = unit.substr(2, unit.size() - 3);
      lines.push_back({column.name, names[k], unit, static_cast<int>(kept + lines.size()) + 1});
    }
  }
  return lines;
}

/// The table of a picture goes where the picture is drawn.
struct Drawing {
  std::unique_ptr<UnfinishedFolder> folder;
  std::string output;
};

/// @throws scene::InputError  a picture of no motion
Drawing drawingOf(EvaluateArguments& arguments) {
  Drawing drawing;
  if (arguments.format == "csv" || arguments.format == "json") return drawing;
  arguments.look.kind = arguments.format;
  if (arguments.states.file.empty())
    throw scene::InputError(
        {},
        "--format svg, png or pdf without a motion, allowed: --states FILE with a column of "
        "time");
  drawing.output = arguments.output;
  drawing.folder = std::make_unique<UnfinishedFolder>(
      drawing.output.empty() ? std::filesystem::temp_directory_path() / "dynwitness_motion"
                             : std::filesystem::path(drawing.output + ".work"));
  drawing.folder->write("motion.csv", "");
  arguments.output = (drawing.folder->path() / "motion.csv").string();
  arguments.format = "csv";
  arguments.units = false;
  arguments.states.keep = true;
  return drawing;
}

/// The scene; joints have to move inertia where a quantity takes the inverse of M.
scene::Scene readFor(const EvaluateArguments& arguments) {
  for (const std::string& quantity : arguments.quantities)
    if (takesInverse(quantity)) return readSceneFor(arguments.scene, quantity);
  const scene::Scene scene = readSceneFor(arguments.scene, "");
  for (const std::string& quantity : arguments.quantities)
    if (quantity == "reactions" && hasMoreThanItsTree(scene.mechanism))
      scene::requireInertiaOfJoints(scene, quantity);
  return scene;
}

/// The names of all columns: kept ones of the file, the states' where they are drawn, the answers'.
std::vector<std::string> namesOfTable(const scene::Scene& scene, const EvaluateArguments& arguments,
                                      States& states, const std::vector<EvaluatedColumn>& columns,
                                      const ColumnSources& sources, bool finds_qdd) {
  std::vector<std::string> all = states.keptNames();
  const std::size_t kept = all.size();
  if (arguments.states.random > 0)
    for (std::string& name : stateColumns(
             scene.mechanism, Coordinates(scene.mechanism, states.convention()).positions(),
             usedBy(arguments.quantities, scene.mechanism, finds_qdd)))
      all.push_back(std::move(name));
  for (const EvaluatedColumn& column : columns)
    for (std::string& name : headings(column, scene, arguments, states, sources)) {
      all.push_back(std::move(name));
    }
  setApart(arguments.states.file, kept, &all);
  for (const char* asked : {"qdd1", "tau1"})
    if (arguments.states.random > 0 && std::count(all.begin(), all.end(), asked) > 1)
      throw scene::InputError({},
                              fmt::format("--random: column {} would be of the state and of the "
                                          "answer, allowed: tau and qdd in calls of their own",
                                          asked));
  return all;
}

/// @throws scene::InputError  rows of JSON could not say whose positions they hold
NumberTable tableOf(const scene::Scene& scene, const EvaluateArguments& arguments,
                    const States& states, const std::vector<std::string>& names) {
  const bool says_convention = arguments.states.random > 0 && hasOrientations(scene.mechanism);
  if (arguments.format == "json" && says_convention &&
      states.convention() != CoordinateConvention::kDynwitness)
    throw scene::InputError(
        {},
        "--random with --convention: rows of JSON do not say whose positions they hold, allowed: "
        "--format csv, whose first line does");
  return {names, arguments.format == "json",
          says_convention ? fmt::format("# convention: {}\n", name(states.convention())) : ""};
}

/// Columns in the convention of the states.
/// @throws scene::InputError  a column, or what is said of it, is of dynwitness' own rates
void convert(const scene::Scene& scene, const EvaluateArguments& arguments,
             CoordinateConvention convention, const std::vector<EvaluatedColumn>& columns,
             ColumnSources& sources) {
  if (convention == CoordinateConvention::kDynwitness) return;
  if (arguments.warn || !arguments.uncertainty.empty())
    throw scene::InputError(
        {}, fmt::format("{} in coordinates of {}: it is of dynwitness' own, allowed: without",
                        arguments.warn ? "--warn" : "--uncertainty", name(convention)));
  sources.converted.emplace(scene, convention);
  for (const EvaluatedColumn& column : columns) sources.converted->require(column);
}

/// @throws scene::InputError  nobody vouches for what would be warned of
void requireBounds(const EvaluateArguments& arguments, const std::vector<EvaluatedColumn>& columns,
                   bool finds_qdd) {
  if (!arguments.warn) return;
  for (const EvaluatedColumn& column : columns) requireBound(column);
  if (finds_qdd)
    throw scene::InputError({},
                            "--warn of what belongs to qdd that is found from tau first: nobody "
                            "vouches for that qdd; allowed: qdd given, or --quantity qdd");
}

int runEvaluate(EvaluateArguments arguments) {
  if (arguments.output == kStandardOutput) arguments.output.clear();
  requireWritableFile(arguments.output);
  const Drawing drawing = drawingOf(arguments);
  const scene::Scene scene = readFor(arguments);
  requireMotion(scene);
  ConstrainedOnDemand constrained(scene);
  const std::unique_ptr<States> states =
      statesOf(arguments.states, scene, [&] { return constrained->start(); });

  std::optional<WitnessKind> engine;
  if (!arguments.engines.empty())
    engine = engineKinds(arguments.engines, arguments.limits, scene).front();
  ColumnSources sources{scene.mechanism, constrained};
  std::vector<EvaluatedColumn> columns = columnsOf(arguments, scene, engine, sources);
  convert(scene, arguments, states->convention(), columns, sources);
  const bool finds_qdd = findsQddFirst(scene, arguments, states->given());
  if (finds_qdd) scene::requireInertiaOfJoints(scene, "qdd (found from tau first)");
  admitFor(scene, arguments.quantities);
  requireBounds(arguments, columns, finds_qdd);
  NumberTable table = tableOf(scene, arguments, *states,
                              namesOfTable(scene, arguments, *states, columns, sources, finds_qdd));
  // a pipe may wait for the answer before it goes on
  const std::size_t at_once = engine && arguments.states.file != "-" ? kEngineBatch : 1;
  try {
    std::vector<TrajectoryLine> lines;
    int time = 0;
    if (drawing.folder) {
      const std::vector<std::string> kept = states->keptNames();
      time = timeAmong(kept, arguments.states.file);
      lines = linesOf(columns, scene, arguments, *states, sources, kept.size());
    }
    writeRows(scene, arguments, *states, columns, sources, finds_qdd, at_once, table);
    if (drawing.folder)
      drawTrajectory(arguments.output, scene.title.empty() ? scene.name : scene.title,
                     fmt::format("{} along {}", scene.name, arguments.states.file), time, lines,
                     drawing.output, arguments.look);
  } catch (const EngineFailed& failed) {
    tell(fmt::format("{}: {}\n", scene.name, failed.what()));
    return 1;
  }
  return 0;
}

/// Which quantities, of which joints and points, in which axes.
void addWhat(CLI::App& command, EvaluateArguments& arguments) {
  command
      .add_option(
          "--quantity", arguments.quantities,
          "Quantities: M, c, g, tau, qdd, kinetic, potential, momentum (world axes, about the world's "
          "origin), reactions; along a motion power (tau' qd [W]) and residual (tau less the tau that is "
          "given: what a motion leaves of its equations); of points of links (--point): position, orientation (its columns are the "
          "link's axes), quaternion (w, x, y, z), rpy, velocity, acceleration, jacobian (velocity = J qd), "
          "jacobian_rate (dJ/dt); of trees, dtau_dq, dtau_dqd, dqdd_dq, dqdd_dqd, dqdd_dtau (columns "
          "dtau1_dq2; by M for dtau_dqdd), the second ones d2tau_dq_dq, d2tau_dq_dqd, d2tau_dqd_dqd, "
          "d2tau_dq_dqdd (dM/dq), d2qdd_dq_dq, d2qdd_dq_dqd, d2qdd_dqd_dqd, d2qdd_dq_dtau (q of spherical and floating joints along the body's axes), C "
          "(Coriolis matrix by Christoffel symbols), Y (regressor, columns Y2_mcx(LINK)); "
          "with closures, driven joints or acceleration constraints: qdd and reactions under them, lambda, nu, tau_drive; of the constraints as tasks: N, "
          "Lambda "
          "(task inertia), J, Jbar, task_torque (tau the posture's), null_torque; of each joint, in "
          "the axes of its moved frame: X, M_i, M_C (composite), M_A (articulated), P, PM, Z, F "
          "(bias force of the articulated body), PF, E and beta (of the acceleration constraints); "
          "several with commas")
      ->required()
      ->delimiter(',');
  command
      .add_option(
          "--joint", arguments.joints,
          "These joints alone, of what is asked of each joint (X, ..., beta, reactions); several "
          "with commas")
      ->delimiter(',');
  command
      .add_option(
          "--point", arguments.points,
          "Of which points position, ..., jacobian_rate are: of this link, at x, y, z in its "
          "axes [m] (without: its origin); again for more. Without: the origins of all links")
      ->type_name("LINK[,x,y,z]");
  command
      .add_option(
          "--axes", arguments.axes,
          "Of reactions and of what is asked of each joint: link (the moved joint frame's, and "
          "what is taken without), joint (z along the joint's axis, as in the chapter), world; "
          "always about the origin of the moved joint frame. Of velocity, acceleration, jacobian "
          "and jacobian_rate of points: world (what is taken without) or link")
      ->check(oneOf({"link", "joint", "world"}));
}

}  // namespace

Run addEvaluate(CLI::App* command) {
  auto arguments = std::make_shared<EvaluateArguments>();
  command->footer(
      "Examples:\n"
      "  dynwitness evaluate acrobot --states s.csv --quantity M,tau\n"
      "  dynwitness evaluate acrobot --q elbow=0.3 --qdd 1,0 --quantity tau,reactions --units\n"
      "  dynwitness evaluate franka_panda --random 100 --quantity qdd --warn\n"
      "  dynwitness evaluate humanoid_floating --states log.csv --convention pinocchio --keep --quantity tau\n"
      "  dynwitness evaluate puma_560 --states motion.csv --quantity tau,power,kinetic,potential --format svg -o m.svg\n"
      "  dynwitness evaluate two_handed --quantity qdd,nu,tau_drive\n"
      "  dynwitness evaluate two_handed --quantity Lambda,Jbar,task_torque\n"
      "  dynwitness evaluate puma_560 --quantity X,M_A,P,PM --joint joint_2,joint_3 --units\n"
      "  dynwitness evaluate acrobot --quantity position,jacobian --point lower,0,0,-2\n"
      "  dynwitness evaluate franka_panda --quantity dqdd_dq,dqdd_dqd,dqdd_dtau --units\n"
      "  dynwitness evaluate puma_560 --quantity M_A,P,qdd --uncertainty mass=0.05,rpy=0.001 --units\n"
      "  dynwitness evaluate two_handed --quantity E,beta --format json");
  addScene(*command, arguments->scene, "Scene");
  addStates(
      *command, arguments->states,
      "States, a CSV file: or - for standard input; q1.. (as many as `show` has), qd1..qdn, and qdd1..qddn (of tau, "
      "reactions) or tau1..taun (of qdd, lambda, nu, ..., and of reactions under closures, springs "
      "between points or acceleration constraints; for tau and others' reactions qdd is found first); "
      "joints that follow others have none of these. Without: the scene's start, no joint forces. "
      "Read and answered row by row");
  addWhat(*command, *arguments);
  command
      ->add_option(
          "--format", arguments->format,
          "How it is written: csv; json, an object a state on a line of its own; or svg, png or pdf, "
          "a picture against time of --states with a column t, time or time_s")
      ->capture_default_str()
      ->check(oneOf({"csv", "json", "svg", "png", "pdf"}));
  addBackground(*command, arguments->look);
  command
      ->add_flag("--units", arguments->units,
                 "With units in the names: \"elbow.M_A44 [kg m^2]\"")
      ->excludes("--random");  // whose table is a file of states as well
  command->add_flag(
      "--warn", arguments->warn,
      fmt::format(
          "Say at how many states rounding leaves no more than {} digits, in double and by "
          "the same sweep in float: estimated beside the sweep (tau, c, g, M, qdd by the "
          "usual witnesses and by fast, tau and M by kernel), otherwise bounded by a running error analysis, which is far "
          "slower",
          kFewestDigits));
  command
      ->add_option(
          "--uncertainty", arguments->uncertainty,
          "Standard deviations: NAME=NUMBER,... of mass, inertia, rotor (relative), com, "
          "xyz [m], rpy [rad]; after each of tau, qdd and what is asked of joints stand its "
          "own, \"NAME +-\", of first order")
      ->excludes("--warn");
  command->add_option("--witness", arguments->witness,
                      "Witnesses: who answers; without: the usual sweep");
  addEngineOptions(*command, arguments->engines, arguments->limits)
      ->excludes("--witness")
      ->expected(1);
  addOutput(*command, arguments->output, "file; without: standard output");
  return [arguments] { return runEvaluate(*arguments); };
}

}  // namespace dynwitness::cli
