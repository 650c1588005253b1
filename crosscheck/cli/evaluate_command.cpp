// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness evaluate: quantities of a scene at given states, as a table.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "crosscheck/cli/chart_files.hpp"
#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/engine_options.hpp"
#include "crosscheck/cli/evaluate_picture.hpp"
#include "crosscheck/cli/given_states.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/inputs/conventions.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/closure_gap.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/motion/derivative_quantities.hpp"
#include "crosscheck/motion/joint_axes.hpp"
#include "crosscheck/motion/joint_quantities.hpp"
#include "crosscheck/motion/point_quantities.hpp"
#include "crosscheck/motion/uncertain_quantities.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/system/growing_file.hpp"
#include "crosscheck/witnesses/certain_digits.hpp"
#include "crosscheck/witnesses/column_names.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "crosscheck/witnesses/estimated_sweep.hpp"
#include "crosscheck/witnesses/single_precision.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/nearest_name.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct EvaluateArguments {
  GivenScene scene;
  StatesAsked states;
  std::string witness, output;
  std::vector<std::string> engines;  ///< a command, or none
  Limits limits;                     ///< of that program
  std::vector<std::string> quantities;
  std::vector<std::string> joints;  ///< of these alone, what is asked of joints; none: of all
  std::vector<std::string> points;  ///< "LINK,x,y,z"; none: the origins of all links
  std::string format = "csv";
  PictureLook look;  ///< of a picture
  std::string axes;  ///< empty: of joints the link's, of points the world's
  bool units = false, warn = false;
  std::string uncertainty;  ///< readUncertainty(); empty: none
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

/// Which numbers are of these joints, of reactions; none: all.
std::vector<Eigen::Index> rowsOf(const std::vector<std::string>& joints,
                                 const scene::Mechanism& mechanism) {
  std::vector<Eigen::Index> rows;
  for (const std::string& name : joints) {
    Eigen::Index first = 0;
    auto link = mechanism.links.begin();
    for (; link != mechanism.links.end(); ++link) {
      if (link->parent >= 0 && link->joint.name == name) break;
      first += link->parent >= 0 ? 6 : 0;
    }
    if (link == mechanism.links.end())
      throw scene::InputError(
          {}, fmt::format("--joint {}, expected the name of a joint of the scene", name));
    for (Eigen::Index k = 0; k < 6; ++k) rows.push_back(first + k);
  }
  return rows;
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
    case ConstrainedQuantity::kReactions:
      return columnUnits(Quantity::kReactions, mechanism);
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

/// What is formed of tau as inverse dynamics has it, along a motion.
enum class Along {
  kNothing,
  kPower,     ///< tau' qd, of all joint forces together [W]
  kResidual,  ///< tau - the tau that is given: what a motion leaves of its equations [N m, N]
};
constexpr const char* kPower = "power";
constexpr const char* kResidual = "residual";
std::optional<Along> alongNamed(const std::string& quantity) {
  if (quantity == kPower) return Along::kPower;
  if (quantity == kResidual) return Along::kResidual;
  return {};
}

/// What a quantity is asked at, beside q and qd.
enum class Needs { kNothing, kQdd, kTau };

/// Whether reactions are those of more than the tree and its drives: then qdd alone does not tell
/// them.
bool hasMoreThanItsTree(const scene::Mechanism& mechanism) {
  return !mechanism.isOpenTree() || !mechanism.acceleration_constraints.empty();
}

Needs needsOf(const std::string& quantity, const scene::Mechanism& mechanism) {
  if (quantity == "reactions" && hasMoreThanItsTree(mechanism)) return Needs::kTau;
  for (const char* name : {"tau", "power", "residual", "reactions", "acceleration", "dtau_dq", "Y"})
    if (quantity == name) return Needs::kQdd;
  for (const char* name : {"qdd", "lambda", "nu", "tau_drive", "task_torque", "null_torque", "F",
                           "PF", "beta", "dqdd_dq"})
    if (quantity == name) return Needs::kTau;
  return Needs::kNothing;
}

/// Whether a quantity takes the inverse of M of any scene: where a joint moves no inertia there is
/// none.
bool takesInverse(const std::string& quantity) {
  for (const char* name :
       {"qdd", "lambda", "nu", "tau_drive", "N", "Lambda", "Jbar", "task_torque", "null_torque",
        "M_A", "P", "PM", "F", "PF", "E", "beta", "dqdd_dq", "dqdd_dqd", "dqdd_dtau"})
    if (quantity == name) return true;
  return false;
}

/// Which row of the table of features a quantity belongs to.
Command commandOf(const std::string& quantity) {
  if (alongNamed(quantity)) return Command::kEvaluateForces;
  if (quantity == "tau") return Command::kEvaluateForces;
  for (const char* name : {"qdd", "lambda", "nu", "tau_drive", "reactions"})
    if (quantity == name) return Command::kEvaluateMotion;
  for (const char* name : {"N", "Lambda", "J", "Jbar", "task_torque", "null_torque", "E", "beta"})
    if (quantity == name) return Command::kEvaluateTasks;
  if (jointQuantityNamed(quantity)) return Command::kEvaluateJoints;
  if (pointQuantityNamed(quantity)) return Command::kEvaluatePoints;
  if (derivativeQuantityNamed(quantity)) return Command::kEvaluateDerivatives;
  return Command::kEvaluateTree;
}

void admitFor(const scene::Scene& scene, const std::vector<std::string>& quantities) {
  std::vector<Command> commands;
  for (const std::string& text : quantities) commands.push_back(commandOf(text));
  admit(scene, commands);
}

/// What of a state the answers hang on.
struct Used {
  bool qdd = false, tau = false;
};
Used usedBy(const std::vector<std::string>& quantities, const scene::Mechanism& mechanism,
            bool finds_qdd) {
  Used used{mechanism.isDriven(), finds_qdd};
  for (const std::string& quantity : quantities) {
    used.qdd = used.qdd || needsOf(quantity, mechanism) == Needs::kQdd;
    used.tau = used.tau || needsOf(quantity, mechanism) == Needs::kTau || quantity == kResidual;
  }
  return used;
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

/// Rows of numbers under these names: CSV, or an object a line.
class Table {
 public:
  /// @param comment  a line before those of CSV
  Table(const std::vector<std::string>& names, bool is_json, const std::string& comment)
      : is_json_(is_json) {
    if (!is_json) header_ = comment;
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
  /// What a file has, as it stands there; in JSON a number where it is one.
  void append(const std::string& cell, std::string* row) {
    *row += keys_[at_++];
    double value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    const bool is_number =
        error == std::errc() && end == cell.data() + cell.size() && std::isfinite(value);
    *row += !is_json_   ? cell
            : is_number ? nlohmann::json(value).dump()
                        : nlohmann::json(cell).dump();
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

/// The parts of a state that a table shows, as a file of states has them.
std::vector<std::string> stateColumns(const scene::Mechanism& mechanism, int positions,
                                      const Used& used) {
  std::vector<std::string> names;
  const int n = mechanism.dof();
  for (const auto& [group, count] :
       {std::pair("q", positions), {"qd", n}, {"qdd", used.qdd ? n : 0}, {"tau", used.tau ? n : 0}})
    for (int k = 1; k <= count; ++k) names.push_back(fmt::format("{}{}", group, k));
  return names;
}

struct Column {
  Quantity quantity;
  std::unique_ptr<Witness> witness;  ///< none: asked of the constrained quantities
  std::string name;
  bool is_engines = false;  ///< the witness is a program of the user's
  ConstrainedQuantity constrained = ConstrainedQuantity::kQdd;  ///< without a witness
  std::optional<JointQuantity> of_joints = {};                  ///< then it is this, and no other
  std::vector<Eigen::Index> rows = {};                ///< of these numbers alone; none: all of them
  bool is_deviation = false;                          ///< of the column before, by --uncertainty
  std::optional<PointQuantity> of_points = {};        ///< then it is this, and no other
  std::optional<DerivativeQuantity> derivative = {};  ///< then it is this, and no other
  Along along = Along::kNothing;                      ///< formed of quantity, which is tau

  bool isOfConstraints() const { return !witness && !of_joints && !of_points && !derivative; }
  bool isOfConstrained(ConstrainedQuantity asked) const {
    return isOfConstraints() && constrained == asked;
  }
  bool isOfReactions() const {
    return isOfConstrained(ConstrainedQuantity::kReactions) ||
           (witness && quantity == Quantity::kReactions);
  }
};

/// Answers in the coordinates of another convention (inputs/conventions.hpp has the equations).
class Converted {
 public:
  Converted(const scene::Scene& scene, CoordinateConvention convention)
      : scene_(scene), to_(scene.mechanism, convention) {}
  /// @throws scene::InputError  what it would be there is not known here
  void require(const Column& column) {
    const Kind kind = kindOf(column);
    if (kind == Kind::kUnknown)
      throw scene::InputError(
          {}, fmt::format("--convention {} with {}, which is of dynwitness' own rates, allowed: "
                          "another quantity, or --convention dynwitness",
                          name(to_.convention()), column.name));
    if (kind == Kind::kBias && !mass_)
      mass_ = selectWitnesses({"composite_body"}).front().make(scene_).value();
  }

  Eigen::MatrixXd value(const Column& column, const scene::State<double>& state,
                        const Eigen::MatrixXd& value) {
    const Eigen::Map<const Eigen::VectorXd> gained(turning(state).data(),
                                                   static_cast<Eigen::Index>(gained_.size()));
    switch (kindOf(column)) {
      case Kind::kForce:
      case Kind::kRows:
        return rows(state, value);
      case Kind::kQdd:
        return rows(state, value + gained);
      case Kind::kBias:
        return rows(state, value - mass_->value(Quantity::kM, state) * gained);
      case Kind::kMass:
        return rows(state, rows(state, value).transpose());
      case Kind::kColumns: {  // row by row, in one column or in as many as there are rates
        const Eigen::Index n = scene_.mechanism.dof(), count = value.size() / n;
        const Eigen::MatrixXd wide = value.transpose();
        const Eigen::MatrixXd out = rows(
            state, value.cols() == n
                       ? wide
                       : Eigen::MatrixXd(Eigen::Map<const Eigen::MatrixXd>(wide.data(), n, count)));
        if (value.cols() == n) return out.transpose();
        return Eigen::Map<const Eigen::VectorXd>(out.data(), out.size());
      }
      default:
        return value;
    }
  }

  /// The strings, one a number of value(), of the rates that these belong to.
  std::vector<std::string> sorted(const Column& column, const std::vector<std::string>& all) const {
    const Kind kind = kindOf(column);
    if (kind == Kind::kNone) return all;
    const auto n = static_cast<std::size_t>(scene_.mechanism.dof());
    const auto at = [&](std::size_t k) {
      return static_cast<std::size_t>(to_.place(static_cast<int>(k)));
    };
    std::vector<std::string> out;
    for (std::size_t k = 0; k < all.size(); ++k)
      out.push_back(all[(kind == Kind::kMass ? at(k / n) : k / n) * n + at(k % n)]);
    return out;
  }

 private:
  enum class Kind { kNone, kForce, kQdd, kBias, kMass, kColumns, kRows, kUnknown };
  static Kind kindOf(const Column& column) {
    if (column.of_joints)
      return *column.of_joints == JointQuantity::kZ ? Kind::kUnknown : Kind::kNone;
    if (column.of_points)
      return *column.of_points == PointQuantity::kJacobian       ? Kind::kColumns
             : *column.of_points == PointQuantity::kJacobianRate ? Kind::kUnknown
                                                                 : Kind::kNone;
    if (column.derivative) return Kind::kUnknown;
    if (column.along == Along::kPower) return Kind::kNone;
    if (column.witness) switch (column.quantity) {
        case Quantity::kM:
          return Kind::kMass;
        case Quantity::kc:
          return Kind::kBias;
        case Quantity::kg:
        case Quantity::kTau:
          return Kind::kForce;
        case Quantity::kQdd:
          return Kind::kQdd;
        default:
          return Kind::kNone;
      }
    switch (column.constrained) {
      case ConstrainedQuantity::kQdd:
        return Kind::kQdd;
      case ConstrainedQuantity::kTauDrive:
      case ConstrainedQuantity::kTaskTorque:
      case ConstrainedQuantity::kNullTorque:
        return Kind::kForce;
      case ConstrainedQuantity::kJ:
        return Kind::kColumns;
      case ConstrainedQuantity::kJbar:
        return Kind::kRows;
      default:
        return Kind::kNone;
    }
  }
  const std::vector<double>& turning(const scene::State<double>& state) {
    return gained_ = to_.turning(state);
  }
  /// T x, column by column.
  Eigen::MatrixXd rows(const scene::State<double>& state, const Eigen::MatrixXd& x) const {
    Eigen::MatrixXd out(x.rows(), x.cols());
    for (Eigen::Index j = 0; j < x.cols(); ++j) {
      const std::vector<double> turned =
          to_.theirs(state, {x.col(j).data(), x.col(j).data() + x.rows()});
      out.col(j) = Eigen::Map<const Eigen::VectorXd>(turned.data(), x.rows());
    }
    return out;
  }

  const scene::Scene& scene_;
  Coordinates to_;
  std::unique_ptr<Witness> mass_;  ///< M, where c is asked for
  std::vector<double> gained_;
};

template <typename Names>
Names chosen(const Names& all, const std::vector<Eigen::Index>& rows) {
  if (rows.empty()) return all;
  Names out;
  for (const Eigen::Index row : rows) out.push_back(all[static_cast<std::size_t>(row)]);
  return out;
}

/// Whom columns without a witness are asked of.
struct Sources {
  const scene::Mechanism& mechanism;
  Constrained& constrained;
  std::optional<JointQuantities> joints;  ///< none: nothing of joints is asked
  std::optional<TurnedAxes> axes;         ///< of reactions; none: they are as they come
  std::optional<UncertainQuantities> uncertain;
  std::optional<PointQuantities> points;                 ///< none: nothing of points is asked
  std::optional<DerivativeQuantities> derivatives = {};  ///< none: none is asked
  std::optional<Converted> converted;                    ///< none: in dynwitness' own coordinates
};

/// That program failed, or has no value at a state.
struct EngineFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// @throws scene::InputError  names of joints whose reactions redundant constraints leave open
void requireDetermined(const Column& column, const Eigen::MatrixXd& reactions,
                       const scene::Mechanism& mechanism, long row) {
  std::string joints;
  const std::vector<std::string> names =
      chosen(columnNames(Quantity::kReactions, mechanism), column.rows);
  for (std::size_t i = 0; i < names.size(); i += 6)
    if (reactions.middleRows<6>(static_cast<Eigen::Index>(i)).array().isNaN().any())
      joints += (joints.empty() ? "" : ", ") + names[i].substr(0, names[i].rfind('.'));
  if (!joints.empty())
    throw scene::InputError(
        {}, fmt::format("reactions of {} at state {} are not determined: redundant constraints may "
                        "share what they transmit in many ways; allowed: --joint with others, or "
                        "constraints of which none follows from the others",
                        joints, row));
}

Eigen::VectorXd deviationOf(const Column& column, const UncertainQuantities& uncertain,
                            const scene::State<double>& state) {
  const Deviations of = column.of_joints ? uncertain.joints(*column.of_joints, state)
                        : column.quantity == Quantity::kTau ? uncertain.tau(state)
                                                            : uncertain.qdd(state);
  return of.together();
}

/// A column of deviations after each of those that have one.
/// @throws scene::InputError  one has none
void addDeviations(const scene::Scene& scene, const EvaluateArguments& arguments, Sources& sources,
                   std::vector<Column>& columns) {
  std::vector<Column> all;
  for (Column& column : columns) {
    const bool of_the_tree =
        column.witness && !column.is_engines && column.along == Along::kNothing &&
        (column.quantity == Quantity::kTau || column.quantity == Quantity::kQdd);
    if (!column.of_joints && !of_the_tree)
      throw scene::InputError(
          {scene.file.string(), 0},
          fmt::format(
              "--uncertainty with {}{}, allowed: tau and qdd of a tree by our sweeps, X, M_i, "
              "M_C, M_A, P, PM, Z, F, PF",
              column.name,
              column.isOfConstraints() ? " under closures, drives or constraints" : ""));
    Column deviation{column.quantity,    nullptr,         column.name, false,
                     column.constrained, column.of_joints};
    deviation.is_deviation = true;
    all.push_back(std::move(column));
    all.push_back(std::move(deviation));
  }
  columns = std::move(all);
  sources.uncertain.emplace(scene, readUncertainty(arguments.uncertainty),
                            sources.joints ? &*sources.joints : nullptr);
}

/// One quantity at one state, finite.
Eigen::MatrixXd valueOf(Column& column, Sources& sources, const scene::State<double>& state,
                        long row) {
  Eigen::MatrixXd value;
  try {
    if (column.is_deviation)
      value = deviationOf(column, *sources.uncertain, state);
    else if (column.of_joints)
      value = sources.joints->value(*column.of_joints);
    else if (column.of_points)
      value = sources.points->value(*column.of_points);
    else if (column.derivative)
      value = sources.derivatives->value(*column.derivative, state);
    else
      value = column.witness ? column.witness->value(column.quantity, state)
                             : sources.constrained->answer(column.constrained, state);
    if (column.isOfReactions() && sources.axes) value = sources.axes->turned(value);
    const auto size = static_cast<Eigen::Index>(state.qd.size());
    if (column.along == Along::kResidual)
      value -= Eigen::Map<const Eigen::VectorXd>(state.tau.data(), size);
    if (column.along == Along::kPower)
      value = Eigen::Map<const Eigen::RowVectorXd>(state.qd.data(), size) * value;
  } catch (const std::runtime_error& error) {
    if (!column.is_engines) throw;
    throw EngineFailed(fmt::format("{} at state {}: {}", column.name, row, error.what()));
  }
  if (!column.rows.empty()) value = value(column.rows, Eigen::all).eval();
  if (column.isOfConstrained(ConstrainedQuantity::kReactions))
    requireDetermined(column, value, sources.mechanism, row);
  if (!value.allFinite())
    throw scene::InputError(
        {}, fmt::format("{} is not finite at state {}: M is singular there, or numbers are too "
                        "large; allowed: states where it has a value",
                        column.name, row));
  return value;
}

/** Counts answers to which rounding leaves too few digits: in double, and by the same sweep in
    float. By the sweep's estimate where it has one; otherwise by the answer's own bound, which costs
    many times the sweep. */
class UncertainAnswers {
 public:
  UncertainAnswers(const scene::Scene& scene, const std::vector<Column>& columns)
      : scene_(scene.name), of_(columns.size()) {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const Column& column = columns[k];
      if (!column.witness || column.is_engines) continue;
      const std::string& name = column.witness->name();
      of_[k].estimated = estimatedSweep(name, column.quantity, scene.mechanism, false);
      if (!of_[k].estimated)
        of_[k].estimated = estimatedKernel(*column.witness, column.quantity, scene.mechanism);
      if (of_[k].estimated)
        of_[k].estimated_single = estimatedSweep(name, column.quantity, scene.mechanism, true);
      else
        of_[k].bounded_single = sweepInSinglePrecision(name, scene.mechanism);
    }
  }
  void see(std::size_t at, const Column& column, const scene::State<double>& state, long row) {
    Asked& asked = of_[at];
    if (asked.estimated) {
      count(asked.estimated(state).digits, row, &asked.seen);
      if (asked.estimated_single) count(asked.estimated_single(state).digits, row, &asked.single);
      return;
    }
    count(certain(column, column.witness->answer(column.quantity, state)), row, &asked.seen);
    if (asked.bounded_single)
      count(certain(column, asked.bounded_single(column.quantity, state)), row, &asked.single);
  }
  void tell(const std::vector<Column>& columns, long rows) const {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (!columns[k].witness || columns[k].is_engines) continue;
      const std::string who =
          fmt::format("{}: {} by {}", scene_, columns[k].name, columns[k].witness->name());
      const Asked& asked = of_[k];
      const char* how = asked.estimated ? "left by estimate" : "certain";
      tell(who, how, asked.seen, rows);
      if (asked.estimated_single || asked.bounded_single)
        tell(who + " in single precision", how, asked.single, rows);
    }
  }

 private:
  struct Seen {
    long states = 0, row = 0;
    double digits = std::numeric_limits<double>::infinity();
  };
  struct Asked {
    Seen seen, single;
    EstimatedSweep estimated, estimated_single;
    SingleSweep bounded_single;
  };

  static double certain(const Column& column, Answer answer) {
    if (!column.rows.empty()) {
      answer.value = answer.value(column.rows, Eigen::all).eval();
      answer.bound = answer.bound(column.rows, Eigen::all).eval();
    }
    return certainDigits(answer);
  }
  static void count(double digits, long row, Seen* seen) {
    if (digits > kFewestDigits) return;
    ++seen->states;
    if (!(digits >= seen->digits)) seen->digits = digits, seen->row = row;
  }
  static void tell(const std::string& who, const char* how, const Seen& seen, long rows) {
    if (seen.states == 0)
      cli::tell(
          fmt::format("{}: more than {} digits of the largest entry are {} at each of {} states\n",
                      who, kFewestDigits, how, rows));
    else
      cli::tell(fmt::format(
          "{}: at {} of {} states no more than {} digits of the largest entry are "
          "{}, the fewest {:.1f} (state {}): rounding may have made the "
          "others\n",
          who, seen.states, rows, kFewestDigits, how, std::max(0.0, seen.digits), seen.row));
  }

  std::string scene_;
  std::vector<Asked> of_;
};

/// @throws scene::InputError  nobody vouches for digits of it
void requireBound(const Column& column) {
  if (column.witness && !column.is_engines && column.along == Along::kNothing) return;
  throw scene::InputError(
      {}, fmt::format(
              "--warn with {}{}, which comes without estimate or bound, allowed: what our sweeps "
              "answer of the tree (M, c, g, tau, qdd, kinetic, potential, momentum, reactions)",
              column.name, column.is_engines ? " of a program" : ""));
}

/// The state, in the order of stateColumns().
void appendState(const scene::State<double>& state, const Used& used,
                 const Coordinates& coordinates, Table& table, std::string* rows) {
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

/** One row a state, into a file that is there only when all are.
    @param finds_qdd  what is asked needs qdd, which is found from tau first
    @param at_once    states that are read before they are answered */
void writeRows(const scene::Scene& scene, const EvaluateArguments& arguments, States& states,
               std::vector<Column>& columns, Sources& sources, bool finds_qdd, std::size_t at_once,
               Table& table) {
  constexpr std::size_t kPiece = std::size_t{1} << 18;
  constexpr long kBetweenNotes = 256;
  // rows that scroll by on a terminal are progress enough
  std::optional<Progress> progress;
  if (!arguments.output.empty() || isatty(STDOUT_FILENO) == 0 ||
      speech().progressAs() == ProgressAs::kJson)
    progress.emplace("evaluate");
  scene::Work work("", states.fraction() < 0 ? 0 : 1);
  const auto begin = std::chrono::steady_clock::now();
  auto noted = begin;
  GrowingFile file(arguments.output);
  std::string rows = table.header();
  OpenStates open(scene);
  const Coordinates coordinates(scene.mechanism, states.convention());
  const Used used = usedBy(arguments.quantities, scene.mechanism, finds_qdd);
  std::optional<UncertainAnswers> uncertain;
  if (arguments.warn) uncertain.emplace(scene, columns);
  std::vector<scene::State<double>> batch, next;
  std::vector<std::vector<std::string>> kept, kept_next;  // cells of each
  const auto read = [&] {
    kept_next.clear();
    for (next.clear(); next.size() < at_once && states.current() != nullptr; states.next()) {
      next.push_back(*states.current());
      if (arguments.states.keep) kept_next.push_back(states.kept());
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
  long row = 0;
  while (!next.empty()) {
    std::swap(batch, next);
    std::swap(kept, kept_next);
    next.clear();
    if (at_once > 1) {
      read();  // while the program is at the batch before
      for (Column& column : columns)
        if (column.is_engines) receiveEngineAhead(*column.witness);
    }
    for (std::size_t at = 0; at < batch.size(); ++at) {
      const scene::State<double>& state = batch[at];
      ++row;
      if (arguments.states.keep)
        for (const std::string& cell : kept[at]) table.append(cell, &rows);
      if (sources.joints) sources.joints->at(state);
      if (sources.axes) sources.axes->at(state);
      if (sources.points) sources.points->at(state);
      if (arguments.states.random > 0) {
        appendState(state, used, coordinates, table, &rows);
      }
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
  if (uncertain) uncertain->tell(columns, row);
}

/// The names of a column's numbers, with units where they are asked for.
std::vector<std::string> headings(const Column& column, const scene::Scene& scene,
                                  const EvaluateArguments& arguments, States& states,
                                  const Sources& sources) {
  std::vector<std::string> names, units;
  if (column.of_joints) {
    names = sources.joints->columns(*column.of_joints);
    if (arguments.units) units = sources.joints->units(*column.of_joints);
  } else if (column.of_points) {
    names = sources.points->columns(*column.of_points);
    if (arguments.units) units = sources.points->units(*column.of_points);
  } else if (column.derivative) {
    names = sources.derivatives->columns(*column.derivative);
    if (arguments.units) units = sources.derivatives->units(*column.derivative);
  } else if (column.witness || column.is_deviation) {
    names = chosen(columnNames(column.quantity, scene.mechanism), column.rows);
    if (arguments.units) units = chosen(columnUnits(column.quantity, scene.mechanism), column.rows);
  } else if (column.isOfConstrained(ConstrainedQuantity::kReactions)) {
    names = chosen(columnNames(Quantity::kReactions, scene.mechanism), column.rows);
    if (arguments.units)
      units = chosen(columnUnits(column.constrained, scene.mechanism), column.rows);
  } else {
    if (arguments.units) units = columnUnits(column.constrained, scene.mechanism);
    const Eigen::MatrixXd shape =
        states.current() == nullptr
            ? Eigen::MatrixXd()
            : sources.constrained->answer(column.constrained, *states.current());
    names = columnNames(column.constrained, shape.rows(), shape.cols());
  }
  if (sources.converted) units = sources.converted->sorted(column, units);
  if (column.along == Along::kPower) {
    names = {kPower};
    units = {"W"};
  }
  if (column.along == Along::kResidual)
    for (std::size_t k = 0; k < names.size(); ++k) names[k] = fmt::format("{}{}", kResidual, k + 1);
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (column.is_deviation) names[k] += " +-";
    if (arguments.units) names[k] += fmt::format(" [{}]", units[k]);
  }
  return names;
}

/// @throws scene::InputError  it is none of all that can be asked
void requireQuantity(const std::string& text) {
  std::vector<std::string> all;
  for (const Quantity quantity : kAllQuantities) all.emplace_back(name(quantity));
  for (int k = 0; k <= static_cast<int>(ConstrainedQuantity::kReactions); ++k)
    if (const std::string one = name(static_cast<ConstrainedQuantity>(k));
        std::find(all.begin(), all.end(), one) == all.end())
      all.push_back(one);
  for (const char* one : {kPower, kResidual}) all.emplace_back(one);
  for (const std::string& one : pointQuantityNames()) all.push_back(one);
  for (const std::string& one : derivativeQuantityNames()) all.push_back(one);
  for (int k = 0; k <= static_cast<int>(JointQuantity::kBeta); ++k)
    all.emplace_back(name(static_cast<JointQuantity>(k)));
  if (std::find(all.begin(), all.end(), text) != all.end()) return;
  throw scene::InputError({}, fmt::format("unknown quantity '{}'{}, allowed: {}", text,
                                          scene::didYouMean(text, all), fmt::join(all, ", ")));
}

/// @throws scene::InputError  somebody else is asked
void requireOurs(const EvaluateArguments& arguments, const std::string& quantity) {
  if (arguments.witness.empty() && arguments.engines.empty()) return;
  throw scene::InputError(
      {}, fmt::format("--witness or --engine with {}, which is of our sweeps, allowed: without",
                      quantity));
}

/// --point: "hand", "hand,0,0,l/2". @throws scene::InputError  no such link, or no place in it
std::vector<FramePoint> pointsOf(const EvaluateArguments& arguments, const scene::Scene& scene) {
  std::vector<FramePoint> out;
  std::vector<std::string> links;
  for (const scene::Link& link : scene.mechanism.links) links.push_back(link.name);
  for (const std::string& text : arguments.points) {
    std::vector<std::string> words(1);
    for (const char letter : text)
      if (letter == ',')
        words.emplace_back();
      else
        words.back() += letter;
    const auto link = std::find(links.begin(), links.end(), words[0]);
    if (link == links.end())
      throw scene::InputError(
          {}, fmt::format("--point: no link '{}'{}, allowed: {}", words[0],
                          scene::didYouMean(words[0], links), fmt::join(links, ", ")));
    if (words.size() != 1 && words.size() != 4)
      throw scene::InputError({},
                              fmt::format("--point: read '{}', allowed: LINK or LINK,x,y,z", text));
    FramePoint point;
    point.link = static_cast<int>(link - links.begin());
    for (std::size_t k = 1; k < words.size(); ++k)
      point.at(static_cast<Eigen::Index>(k) - 1) = numberIn("--point", words[k], scene);
    out.push_back(point);
  }
  return out;
}

JointAxes axesOfPoints(const EvaluateArguments& arguments) {
  const JointAxes axes = jointAxesNamed(arguments.axes).value_or(JointAxes::kWorld);
  if (axes == JointAxes::kJoint)
    throw scene::InputError({}, "--axes joint of points, allowed: world, link");
  return axes;
}

Column columnOf(PointQuantity quantity) {
  Column column{};
  column.name = name(quantity);
  column.of_points = quantity;
  return column;
}

/// What is drawn of the table: columns behind those that are kept of the file.
std::vector<TrajectoryLine> linesOf(const std::vector<Column>& columns, const scene::Scene& scene,
                                    EvaluateArguments arguments, States& states,
                                    const Sources& sources, std::size_t kept) {
  std::vector<TrajectoryLine> lines;
  for (const Column& column : columns) {
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

int runEvaluate(EvaluateArguments arguments) {
  if (arguments.output == kStandardOutput) arguments.output.clear();
  requireWritableFile(arguments.output);
  const Drawing drawing = drawingOf(arguments);
  const scene::Scene scene = readFor(arguments);
  requireMotion(scene);
  Constrained constrained(scene);
  const std::unique_ptr<States> states =
      statesOf(arguments.states, scene, [&] { return constrained->start(); });

  std::optional<WitnessKind> engine;
  if (!arguments.engines.empty())
    engine = engineKinds(arguments.engines, arguments.limits, scene).front();
  std::vector<Column> columns;
  Sources sources{scene.mechanism, constrained, {}, {}, {}, {}, {}, {}};
  const JointAxes axes = jointAxesNamed(arguments.axes).value_or(JointAxes::kLink);
  for (const std::string& text : arguments.quantities) {
    requireQuantity(text);
    if (const std::optional<JointQuantity> of_joints = jointQuantityNamed(text)) {
      requireOurs(arguments, text);
      if (!sources.joints) sources.joints.emplace(scene, arguments.joints, axes);
      columns.push_back(
          {Quantity::kQdd, nullptr, text, false, ConstrainedQuantity::kQdd, of_joints});
      continue;
    }
    if (const std::optional<PointQuantity> of_points = pointQuantityNamed(text)) {
      requireOurs(arguments, text);
      if (!sources.points)
        sources.points.emplace(scene, pointsOf(arguments, scene), axesOfPoints(arguments));
      columns.push_back(columnOf(*of_points));
      continue;
    }
    if (const std::optional<DerivativeQuantity> derivative = derivativeQuantityNamed(text)) {
      requireOurs(arguments, text);
      if (!sources.derivatives) sources.derivatives.emplace(scene);
      columns.emplace_back();
      columns.back().name = text;
      columns.back().derivative = derivative;
      continue;
    }
    const std::optional<ConstrainedQuantity> special = constrainedQuantityNamed(text);
    std::vector<Eigen::Index> rows;
    if (text == "reactions") {
      rows = rowsOf(arguments.joints, scene.mechanism);
      if (axes != JointAxes::kLink) sources.axes.emplace(scene, axes);
    }
    const bool is_of_the_tree =
        (special == ConstrainedQuantity::kQdd &&
         !ConstrainedQuantities::isConstrained(scene.mechanism)) ||
        (special == ConstrainedQuantity::kReactions && !hasMoreThanItsTree(scene.mechanism));
    if (special && !is_of_the_tree) {
      if (!arguments.witness.empty() || engine)
        throw scene::InputError(
            {},
            fmt::format("--witness or --engine with {} of a constrained scene, allowed: without",
                        text));
      columns.push_back({Quantity::kQdd, nullptr, text, false, *special, {}, rows});
      continue;
    }
    const std::optional<Along> along = alongNamed(text);
    const Quantity quantity = along ? Quantity::kTau : quantityNamed(text);
    const std::string who = engine                      ? engine->info.name
                            : arguments.witness.empty() ? usualWitness(quantity)
                                                        : arguments.witness;
    MadeWitness made = (engine ? *engine : selectWitnesses({who}).front()).make(scene);
    if (engine && made.isRefused())
      throw scene::InputError({scene.file.string(), 0}, made.refusal());
    std::unique_ptr<Witness> witness = std::move(made).value();
    if (!witness->answers(quantity))
      throw scene::InputError({}, fmt::format("witness '{}' does not answer {}", who, text));
    columns.push_back({quantity,
                       std::move(witness),
                       text,
                       engine.has_value(),
                       ConstrainedQuantity::kQdd,
                       {},
                       rows,
                       false,
                       {},
                       {},
                       along.value_or(Along::kNothing)});
  }
  if (axes != JointAxes::kLink && !sources.joints && !sources.axes && !sources.points)
    throw scene::InputError(
        {}, fmt::format("--axes {} without a quantity that has axes of joints, expected reactions, "
                        "velocity, acceleration, jacobian, jacobian_rate or one of X, M_i, M_C, "
                        "M_A, P, PM, Z, F, PF, E; those of lambda are the "
                        "closure's (data/scenes/README.md)",
                        arguments.axes));
  const bool asks_of_joints =
      sources.joints || std::any_of(columns.begin(), columns.end(),
                                    [](const Column& column) { return !column.rows.empty(); });
  if (!arguments.joints.empty() && !asks_of_joints)
    throw scene::InputError({},
                            "--joint without a quantity of joints, expected one of X, M_i, "
                            "M_C, M_A, P, PM, Z, F, PF, E, beta, reactions");
  if (!arguments.points.empty() && !sources.points)
    throw scene::InputError({},
                            fmt::format("--point without a quantity of points, expected one of {}",
                                        fmt::join(pointQuantityNames(), ", ")));
  if (arguments.warn)
    for (const Column& column : columns) requireBound(column);
  if (!arguments.uncertainty.empty()) addDeviations(scene, arguments, sources, columns);
  if (states->convention() != CoordinateConvention::kDynwitness) {
    if (arguments.warn || !arguments.uncertainty.empty())
      throw scene::InputError(
          {}, fmt::format("{} in coordinates of {}: it is of dynwitness' own, allowed: without",
                          arguments.warn ? "--warn" : "--uncertainty", name(states->convention())));
    sources.converted.emplace(scene, states->convention());
    for (const Column& column : columns) sources.converted->require(column);
  }
  const bool finds_qdd = findsQddFirst(scene, arguments, states->given());
  if (finds_qdd) scene::requireInertiaOfJoints(scene, "qdd (found from tau first)");
  admitFor(scene, arguments.quantities);
  if (arguments.warn && finds_qdd)
    throw scene::InputError({},
                            "--warn of what belongs to qdd that is found from tau first: nobody "
                            "vouches for that qdd; allowed: qdd given, or --quantity qdd");
  std::vector<std::string> all_names;
  if (arguments.states.random > 0)
    all_names = stateColumns(scene.mechanism,
                             Coordinates(scene.mechanism, states->convention()).positions(),
                             usedBy(arguments.quantities, scene.mechanism, finds_qdd));
  const std::vector<std::string> kept = states->keptNames();
  all_names.insert(all_names.begin(), kept.begin(), kept.end());
  for (const Column& column : columns)
    for (std::string& name : headings(column, scene, arguments, *states, sources)) {
      if (std::find(kept.begin(), kept.end(), name) != kept.end())
        throw scene::InputError(
            {arguments.states.file, 0},
            fmt::format("--keep: column '{}' is one of the answer, too, allowed: "
                        "another name for it in the file",
                        name));
      all_names.push_back(std::move(name));
    }
  for (const char* asked : {"qdd1", "tau1"})
    if (arguments.states.random > 0 && std::count(all_names.begin(), all_names.end(), asked) > 1)
      throw scene::InputError({},
                              fmt::format("--random: column {} would be of the state and of the "
                                          "answer, allowed: tau and qdd in calls of their own",
                                          asked));
  if (arguments.format == "json" && arguments.states.random > 0 &&
      hasOrientations(scene.mechanism) && states->convention() != CoordinateConvention::kDynwitness)
    throw scene::InputError(
        {},
        "--random with --convention: rows of JSON do not say whose positions they hold, allowed: "
        "--format csv, whose first line does");
  Table table(all_names, arguments.format == "json",
              arguments.states.random > 0 && hasOrientations(scene.mechanism)
                  ? fmt::format("# convention: {}\n", name(states->convention()))
                  : "");
  // a pipe may wait for the answer before it goes on
  const std::size_t at_once = engine && arguments.states.file != "-" ? kEngineBatch : 1;
  try {
    std::vector<TrajectoryLine> lines;
    int time = 0;
    if (drawing.folder) {
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

}  // namespace

Run addEvaluate(CLI::App* command) {
  auto arguments = std::make_shared<EvaluateArguments>();
  command->footer(
      "dynwitness evaluate acrobot --states s.csv --quantity M,tau\n"
      "dynwitness evaluate acrobot --q elbow=0.3 --qdd 1,0 --quantity tau,reactions --units\n"
      "dynwitness evaluate franka_panda --random 100 --quantity qdd --warn\n"
      "dynwitness evaluate humanoid_floating --states log.csv --convention pinocchio --keep --quantity tau\n"
      "dynwitness evaluate puma_560 --states motion.csv --quantity tau,power,kinetic,potential --format svg -o m.svg\n"
      "dynwitness evaluate two_handed --quantity qdd,nu,tau_drive\n"
      "dynwitness evaluate two_handed --quantity Lambda,Jbar,task_torque\n"
      "dynwitness evaluate puma_560 --quantity X,M_A,P,PM --joint joint_2,joint_3 --units\n"
      "dynwitness evaluate acrobot --quantity position,jacobian --point lower,0,0,-2\n"
      "dynwitness evaluate franka_panda --quantity dqdd_dq,dqdd_dqd,dqdd_dtau --units\n"
      "dynwitness evaluate puma_560 --quantity M_A,P,qdd --uncertainty mass=0.05,rpy=0.001 --units\n"
      "dynwitness evaluate two_handed --quantity E,beta --format json");
  addScene(*command, arguments->scene, "Scene");
  addStates(
      *command, arguments->states,
      "States, a CSV file: or - for standard input; q1..q(positions), qd1..qdn, and qdd1..qddn (of tau, "
      "reactions) or tau1..taun (of qdd, lambda, nu, ..., and of reactions under closures, springs "
      "between points or acceleration constraints; for tau and others' reactions qdd is found first); "
      "joints that follow others have none of these. Without: the scene's start, no joint forces. "
      "Read and answered row by row");
  command
      ->add_option(
          "--quantity", arguments->quantities,
          "Quantities: M, c, g, tau, qdd, kinetic, potential, momentum (world axes, about the world's "
          "origin), reactions; along a motion power (tau' qd [W]) and residual (tau less the tau that is "
          "given: what a motion leaves of its equations); of points of links (--point): position, orientation (its columns are the "
          "link's axes), quaternion (w, x, y, z), rpy, velocity, acceleration, jacobian (velocity = J qd), "
          "jacobian_rate (dJ/dt); of trees, dtau_dq, dtau_dqd, dqdd_dq, dqdd_dqd, dqdd_dtau (columns "
          "dtau1_dq2; by M for dtau_dqdd; q of spherical and floating joints along the body's axes), C "
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
      ->add_option(
          "--joint", arguments->joints,
          "These joints alone, of what is asked of each joint (X, ..., beta, reactions); several "
          "with commas")
      ->delimiter(',');
  command
      ->add_option(
          "--point", arguments->points,
          "Of which points position, ..., jacobian_rate are: of this link, at x, y, z in its "
          "axes [m] (without: its origin); again for more. Without: the origins of all links")
      ->type_name("LINK[,x,y,z]");
  command
      ->add_option(
          "--axes", arguments->axes,
          "Of reactions and of what is asked of each joint: link (the moved joint frame's, and "
          "what is taken without), joint (z along the joint's axis, as in the chapter), world; "
          "always about the origin of the moved joint frame. Of velocity, acceleration, jacobian "
          "and jacobian_rate of points: world (what is taken without) or link")
      ->check(oneOf({"link", "joint", "world"}));
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
