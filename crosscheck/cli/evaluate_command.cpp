// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness evaluate: quantities of a scene at given states, as a table.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/engine_options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/inputs/states_file.hpp"
#include "crosscheck/motion/closure_gap.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/motion/joint_quantities.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/system/growing_file.hpp"
#include "crosscheck/witnesses/column_names.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  std::string scene, states, witness, output;
  std::vector<std::string> engines;  ///< a command, or none
  Limits limits;                     ///< of that program
  std::vector<std::string> quantities;
  std::vector<std::string> joints;  ///< of these alone, what is asked of joints; none: of all
  std::string format = "csv";
  bool units = false;
};

/// nu1, nu2, ...; J11, J12, ... row by row (J1_1 where a number has two digits).
std::vector<std::string> columnNames(ConstrainedQuantity quantity, Eigen::Index rows,
                                     Eigen::Index columns) {
  const bool is_matrix = quantity == ConstrainedQuantity::kN ||
                         quantity == ConstrainedQuantity::kTaskInertia ||
                         quantity == ConstrainedQuantity::kJbar;
  std::vector<std::string> names;
  for (Eigen::Index i = 1; i <= rows; ++i)
    for (Eigen::Index j = 1; j <= columns; ++j)
      names.push_back(
          columns == 1 && !is_matrix
              ? fmt::format("{}{}", name(quantity), i)
              : fmt::format("{}{}{}{}", name(quantity), i, rows > 9 || columns > 9 ? "_" : "", j));
  return names;
}

/// @throws scene::InputError  where a column's unit hangs on what the constraints are
std::vector<std::string> columnUnits(ConstrainedQuantity quantity,
                                     const scene::Mechanism& mechanism) {
  switch (quantity) {
    case ConstrainedQuantity::kQdd:
      return columnUnits(Quantity::kQdd, mechanism);
    case ConstrainedQuantity::kTauDrive:
    case ConstrainedQuantity::kTaskTorque:
    case ConstrainedQuantity::kNullTorque:
      return columnUnits(Quantity::kTau, mechanism);
    default:
      throw scene::InputError(
          {}, fmt::format("--units with {}: its units are those of the scene's closures and "
                          "constraints, allowed: without",
                          name(quantity)));
  }
}

/// Who answers when nobody is named: the sweep made for the quantity.
std::string usualWitness(Quantity quantity) {
  if (quantity == Quantity::kM) return "composite_body";
  if (quantity == Quantity::kQdd) return "articulated_body";
  return "newton_euler";
}

/// What a quantity is asked at, beside q and qd.
enum class Needs { kNothing, kQdd, kTau };

Needs needsOf(const std::string& quantity) {
  for (const char* name : {"tau", "reactions"})
    if (quantity == name) return Needs::kQdd;
  for (const char* name :
       {"qdd", "lambda", "nu", "tau_drive", "task_torque", "null_torque", "F", "PF", "beta"})
    if (quantity == name) return Needs::kTau;
  return Needs::kNothing;
}

/// Which row of the table of features a quantity belongs to.
Command commandOf(const std::string& quantity) {
  for (const char* name : {"tau", "reactions"})
    if (quantity == name) return Command::kEvaluateForces;
  for (const char* name : {"qdd", "lambda", "nu", "tau_drive"})
    if (quantity == name) return Command::kEvaluateMotion;
  for (const char* name : {"N", "Lambda", "J", "Jbar", "task_torque", "null_torque", "E", "beta"})
    if (quantity == name) return Command::kEvaluateTasks;
  if (jointQuantityNamed(quantity)) return Command::kEvaluateJoints;
  return Command::kEvaluateTree;
}

void admitFor(const scene::Scene& scene, const std::vector<std::string>& quantities) {
  std::vector<Command> commands;
  for (const std::string& text : quantities) commands.push_back(commandOf(text));
  admit(scene, commands);
}

/// Which groups of columns the states have; q is always there.
struct GivenColumns {
  bool qd = false, qdd = false, tau = false;
};

/** Whether qdd has to be found from tau before tau or reactions are asked about, and says so.
    @throws scene::InputError  neither is given, or not what the quantities need */
bool findsQddFirst(const scene::Scene& scene, const Arguments& arguments,
                   const GivenColumns& given) {
  const scene::SourceLocation file{arguments.states, 0};
  const bool from_file = !arguments.states.empty();
  bool first = false, asks_qdd = false, asks_tau = false;
  for (const std::string& quantity : arguments.quantities) {
    const Needs needs = needsOf(quantity);
    if (needs == Needs::kQdd && !given.qdd && !given.tau)
      throw scene::InputError(
          file, quantity +
                    " asked, and neither qdd nor tau given, allowed: columns qdd1.. (or "
                    "tau1.., and qdd is found first)");
    if (needs == Needs::kTau && !given.tau)
      throw scene::InputError(
          file, quantity +
                    " asked, and no tau given, allowed: columns tau1.. (zeros: no joint "
                    "forces)");
    asks_qdd = asks_qdd || needs == Needs::kQdd;
    asks_tau = asks_tau || needs == Needs::kTau;
    first = first || (needs == Needs::kQdd && !given.qdd);
    if (from_file && !given.qdd && scene.mechanism.isDriven() &&
        commandOf(quantity) != Command::kEvaluateTasks &&
        commandOf(quantity) != Command::kEvaluateJoints && needs != Needs::kNothing)
      throw scene::InputError(
          file, quantity +
                    " asked of a scene with driven joints, and no qdd given, allowed: "
                    "columns qdd1.. too, of which those of driven joints count");
  }
  if (!from_file && (asks_qdd || asks_tau))
    tell(fmt::format("{}: no --states: the scene's start, without joint forces (tau = 0)\n",
                     scene.name));
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

/// Rows of numbers under these names: CSV, or an object a line.
class Table {
 public:
  Table(const std::vector<std::string>& names, bool is_json) : is_json_(is_json) {
    for (const std::string& name : names) {
      const char* before = keys_.empty() ? "" : ",";
      keys_.push_back(is_json ? (keys_.empty() ? "{" : ",") + nlohmann::json(name).dump() + ":"
                              : before);
      if (!is_json) header_ += before + name;
    }
    if (!is_json) header_ += '\n';
  }
  const std::string& header() const { return header_; }
  /// A number at full double precision.
  void append(double value, std::string* row) {
    char digits[32];  // 17 digits, a sign, a point and an exponent are 24
    const auto end =
        std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 17).ptr;
    *row += keys_[at_++];
    row->append(digits, end);
  }
  void end(std::string* row) {
    *row += is_json_ ? "}\n" : "\n";
    at_ = 0;
  }

 private:
  bool is_json_;
  std::string header_;
  std::vector<std::string> keys_;  ///< what stands before each number
  std::size_t at_ = 0;
};

/// What constraints need, built when it is first asked for.
class Constrained {
 public:
  explicit Constrained(const scene::Scene& scene) : scene_(scene) {}
  const ConstrainedQuantities* operator->() {
    if (!built_) built_.emplace(scene_);
    return &*built_;
  }

 private:
  const scene::Scene& scene_;
  std::optional<ConstrainedQuantities> built_;
};

/// The states of the file, one after the other; without a file the scene's start alone.
class States {
 public:
  States(const Arguments& arguments, const scene::Scene& scene, Constrained& constrained) {
    if (!arguments.states.empty()) reader_.emplace(arguments.states, scene.mechanism);
    if (!reader_) state_ = constrained->start();
  }
  /// The state that the next() below goes on from, read when it is first asked for; nullptr: there
  /// is none left.
  scene::State<double>* current() {
    if (reader_ && !is_read_) has_state_ = reader_->next(&state_);
    is_read_ = true;
    return has_state_ ? &state_ : nullptr;
  }
  void next() {
    is_read_ = false;
    if (!reader_) has_state_ = false;
  }
  /// Somebody who writes the states may be waiting for answers.
  bool mayWait() const { return reader_ && reader_->mayWait(); }
  GivenColumns given() const {
    if (!reader_) return {true, false, true};
    return {reader_->gives("qd"), reader_->gives("qdd"), reader_->gives("tau")};
  }
  double fraction() const { return reader_ ? reader_->fraction() : 0; }

 private:
  std::optional<StatesReader> reader_;
  scene::State<double> state_;
  bool is_read_ = false, has_state_ = true;
};

struct Column {
  Quantity quantity;
  std::unique_ptr<Witness> witness;  ///< none: asked of the constrained quantities
  std::string name;
  bool is_engines = false;  ///< the witness is a program of the user's
  ConstrainedQuantity constrained = ConstrainedQuantity::kQdd;  ///< without a witness
  std::optional<JointQuantity> of_joints = {};                  ///< then it is this, and no other
};

/// Whom columns without a witness are asked of.
struct Sources {
  Constrained& constrained;
  std::optional<JointQuantities> joints;  ///< none: nothing of joints is asked
};

/// That program failed, or has no value at a state.
struct EngineFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One quantity at one state, finite.
Eigen::MatrixXd valueOf(Column& column, const Sources& sources, const scene::State<double>& state,
                        long row) {
  Eigen::MatrixXd value;
  try {
    if (column.of_joints)
      value = sources.joints->value(*column.of_joints);
    else
      value = column.witness ? column.witness->value(column.quantity, state)
                             : sources.constrained->answer(column.constrained, state);
  } catch (const std::runtime_error& error) {
    if (!column.is_engines) throw;
    throw EngineFailed(fmt::format("{} at state {}: {}", column.name, row, error.what()));
  }
  if (!value.allFinite())
    throw scene::InputError(
        {}, fmt::format("{} is not finite at state {}: M is singular there, or numbers are too "
                        "large; allowed: states where it has a value",
                        column.name, row));
  return value;
}

/** One row a state, into a file that is there only when all are.
    @param finds_qdd  what is asked needs qdd, which is found from tau first
    @param at_once    states that are read before they are answered */
void writeRows(const scene::Scene& scene, States& states, std::vector<Column>& columns,
               Sources& sources, bool finds_qdd, std::size_t at_once, Table& table,
               const std::string& output) {
  constexpr std::size_t kPiece = std::size_t{1} << 18;
  constexpr long kBetweenNotes = 256;
  // rows that scroll by on a terminal are progress enough
  std::optional<Progress> progress;
  if (!output.empty() || isatty(STDOUT_FILENO) == 0) progress.emplace("evaluate");
  scene::Work work("", states.fraction() < 0 ? 0 : 1);
  const auto begin = std::chrono::steady_clock::now();
  auto noted = begin;
  GrowingFile file(output);
  std::string rows = table.header();
  OpenStates open(scene);
  std::vector<scene::State<double>> batch, next;
  const auto read = [&] {
    for (next.clear(); next.size() < at_once && states.current() != nullptr; states.next()) {
      next.push_back(*states.current());
      open.see(next.back());
      if (!finds_qdd) continue;
      const Eigen::MatrixXd qdd =
          sources.constrained->answer(ConstrainedQuantity::kQdd, next.back());
      next.back().qdd.assign(qdd.data(), qdd.data() + qdd.size());
    }
    if (at_once == 1) return;
    for (Column& column : columns)
      if (column.is_engines) sendEngineAhead(*column.witness, column.quantity, next);
  };
  read();
  for (long row = 0; !next.empty();) {
    std::swap(batch, next);
    next.clear();
    if (at_once > 1) {
      read();  // while the program is at the batch before
      for (Column& column : columns)
        if (column.is_engines) receiveEngineAhead(*column.witness);
    }
    for (const scene::State<double>& state : batch) {
      ++row;
      if (sources.joints) sources.joints->at(state);
      for (Column& column : columns) {
        const Eigen::MatrixXd value = valueOf(column, sources, state, row);
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
    const auto now = std::chrono::steady_clock::now();
    if (row % kBetweenNotes == kBetweenNotes - 1 || now - noted > std::chrono::milliseconds(200)) {
      noted = now;
      const std::chrono::duration<double> elapsed = now - begin;
      if (progress)
        progress->note(fmt::format("{} rows, {:.0f} a second", row,
                                   static_cast<double>(row) / elapsed.count()));
      work.doneTo(states.fraction());
    }
    if (at_once == 1) read();
  }
  file.write(rows);
  file.finish();
  progress.reset();
  open.tell();
}

int run(const Arguments& arguments) {
  requireWritableFile(arguments.output);
  const scene::Scene scene = readScene(arguments.scene);
  requireMotion(scene);
  Constrained constrained(scene);
  States states(arguments, scene, constrained);

  std::optional<WitnessKind> engine;
  if (!arguments.engines.empty())
    engine = engineKinds(arguments.engines, arguments.limits, scene).front();
  std::vector<Column> columns;
  Sources sources{constrained, std::nullopt};
  for (const std::string& text : arguments.quantities) {
    if (const std::optional<JointQuantity> of_joints = jointQuantityNamed(text)) {
      if (!arguments.witness.empty() || engine)
        throw scene::InputError(
            {},
            fmt::format("--witness or --engine with {}, which is of our sweeps, allowed: without",
                        text));
      if (!sources.joints) sources.joints.emplace(scene, arguments.joints);
      columns.push_back(
          {Quantity::kQdd, nullptr, text, false, ConstrainedQuantity::kQdd, of_joints});
      continue;
    }
    const std::optional<ConstrainedQuantity> special = constrainedQuantityNamed(text);
    if (special && (special != ConstrainedQuantity::kQdd ||
                    ConstrainedQuantities::isConstrained(scene.mechanism))) {
      if (!arguments.witness.empty() || engine)
        throw scene::InputError(
            {},
            fmt::format("--witness or --engine with {} of a constrained scene, allowed: without",
                        text));
      columns.push_back({Quantity::kQdd, nullptr, text, false, *special});
      continue;
    }
    const Quantity quantity = quantityNamed(text);
    const std::string who = engine                      ? engine->info.name
                            : arguments.witness.empty() ? usualWitness(quantity)
                                                        : arguments.witness;
    MadeWitness made = (engine ? *engine : selectWitnesses({who}).front()).make(scene);
    if (engine && made.isRefused())
      throw scene::InputError({scene.file.string(), 0}, made.refusal());
    std::unique_ptr<Witness> witness = std::move(made).value();
    if (!witness->answers(quantity))
      throw scene::InputError({}, fmt::format("witness '{}' does not answer {}", who, text));
    columns.push_back({quantity, std::move(witness), text, engine.has_value()});
  }
  if (!arguments.joints.empty() && !sources.joints)
    throw scene::InputError({},
                            "--joint without a quantity of joints, expected one of X, M_i, "
                            "M_C, M_A, P, PM, Z, F, PF, E, beta");
  const bool finds_qdd = findsQddFirst(scene, arguments, states.given());
  admitFor(scene, arguments.quantities);
  std::vector<std::string> all_names;
  for (const Column& column : columns) {
    std::vector<std::string> names, units;
    if (column.of_joints) {
      names = sources.joints->columns(*column.of_joints);
      if (arguments.units) units = sources.joints->units(*column.of_joints);
    } else if (column.witness) {
      names = columnNames(column.quantity, scene.mechanism);
      if (arguments.units) units = columnUnits(column.quantity, scene.mechanism);
    } else {
      if (arguments.units) units = columnUnits(column.constrained, scene.mechanism);
      const Eigen::MatrixXd shape =
          states.current() == nullptr ? Eigen::MatrixXd()
                                      : constrained->answer(column.constrained, *states.current());
      names = columnNames(column.constrained, shape.rows(), shape.cols());
    }
    for (std::size_t k = 0; k < names.size(); ++k)
      all_names.push_back(arguments.units ? fmt::format("{} [{}]", names[k], units[k]) : names[k]);
  }
  Table table(all_names, arguments.format == "json");
  // a pipe may wait for the answer before it goes on
  const std::size_t at_once = engine && arguments.states != "-" ? kEngineBatch : 1;
  try {
    writeRows(scene, states, columns, sources, finds_qdd, at_once, table, arguments.output);
  } catch (const EngineFailed& failed) {
    tell(fmt::format("{}: {}\n", scene.name, failed.what()));
    return 1;
  }
  return 0;
}

}  // namespace

Run addEvaluate(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  command->footer(
      "dynwitness evaluate acrobot --states s.csv --quantity M,tau\n"
      "dynwitness evaluate two_handed --quantity qdd,nu,tau_drive\n"
      "dynwitness evaluate two_handed --quantity Lambda,Jbar,task_torque\n"
      "dynwitness evaluate puma_560 --quantity X,M_A,P,PM --joint joint_2,joint_3 --units\n"
      "dynwitness evaluate two_handed --quantity E,beta --format json");
  command->add_option("scene", arguments->scene, "Scene")->required();
  command->add_option(
      "--states", arguments->states,
      "CSV file, or - for standard input: q1..q(positions), qd1..qdn, and qdd1..qddn (of tau, "
      "reactions) or tau1..taun (of qdd, lambda, nu, ...; for tau and reactions qdd is found "
      "first); "
      "joints that follow others have none of these. Without: the scene's start, no joint forces. "
      "Read and answered row by row");
  command
      ->add_option(
          "--quantity", arguments->quantities,
          "M, c, g, tau, qdd, kinetic, potential, momentum, reactions; with closures, driven "
          "joints or acceleration "
          "constraints: qdd under them, lambda, nu, tau_drive; of the constraints as tasks: N, "
          "Lambda "
          "(task inertia), J, Jbar, task_torque (tau the posture's), null_torque; of each joint, in "
          "the axes of its moved frame: X, M_i, M_C (composite), M_A (articulated), P, PM, Z, F "
          "(bias force of the articulated body), PF, E and beta (of the acceleration constraints); "
          "several with commas")
      ->required()
      ->delimiter(',');
  command
      ->add_option("--joint", arguments->joints,
                   "These joints alone, of what is asked of each joint (X, ..., beta); several "
                   "with commas")
      ->delimiter(',');
  command
      ->add_option("--format", arguments->format,
                   "csv, or json: an object a state, on a line of its own")
      ->capture_default_str()
      ->check(CLI::IsMember({"csv", "json"}));
  command->add_flag("--units", arguments->units,
                    "With units in the names: \"elbow.M_A44 [kg m^2]\"");
  command->add_option("--witness", arguments->witness, "Who answers; without: the usual sweep");
  addEngineOptions(*command, arguments->engines, arguments->limits)
      ->excludes("--witness")
      ->expected(1);
  command->add_option("-o,--output", arguments->output, "File; without: standard output");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
