// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/evaluated_columns.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/point_option.hpp"
#include "crosscheck/witnesses/column_names.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "scene/nearest_name.hpp"

namespace dynwitness::cli {

using namespace crosscheck;

namespace {

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

template <typename Names>
Names chosen(const Names& all, const std::vector<Eigen::Index>& rows) {
  if (rows.empty()) return all;
  Names out;
  for (const Eigen::Index row : rows) out.push_back(all[static_cast<std::size_t>(row)]);
  return out;
}

/// @throws scene::InputError  names of joints whose reactions redundant constraints leave open
void requireDetermined(const EvaluatedColumn& column, const Eigen::MatrixXd& reactions,
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

Eigen::VectorXd deviationOf(const EvaluatedColumn& column, const UncertainQuantities& uncertain,
                            const scene::State<double>& state) {
  const Deviations of = column.of_joints ? uncertain.joints(*column.of_joints, state)
                        : column.quantity == Quantity::kTau ? uncertain.tau(state)
                                                            : uncertain.qdd(state);
  return of.together();
}

/// A column of deviations after each of those that have one.
/// @throws scene::InputError  one has none
void addDeviations(const scene::Scene& scene, const EvaluateArguments& arguments,
                   ColumnSources& sources, std::vector<EvaluatedColumn>& columns) {
  std::vector<EvaluatedColumn> all;
  for (EvaluatedColumn& column : columns) {
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
    EvaluatedColumn deviation;
    deviation.quantity = column.quantity;
    deviation.name = column.name;
    deviation.constrained = column.constrained;
    deviation.of_joints = column.of_joints;
    deviation.is_deviation = true;
    all.push_back(std::move(column));
    all.push_back(std::move(deviation));
  }
  columns = std::move(all);
  sources.uncertain.emplace(scene, readUncertainty(arguments.uncertainty),
                            sources.joints ? &*sources.joints : nullptr);
}

/// @throws scene::InputError  somebody else is asked
void requireOurs(const EvaluateArguments& arguments, const std::string& quantity) {
  if (arguments.witness.empty() && arguments.engines.empty()) return;
  throw scene::InputError(
      {}, fmt::format("--witness or --engine with {}, which is of our sweeps, allowed: without",
                      quantity));
}

std::vector<FramePoint> pointsOf(const EvaluateArguments& arguments, const scene::Scene& scene) {
  std::vector<FramePoint> out;
  for (const std::string& text : arguments.points) {
    const PointAsked asked = pointAsked(text, scene);
    FramePoint point;
    point.link = asked.link;
    for (std::size_t k = 0; k < asked.at.size(); ++k)
      point.at(static_cast<Eigen::Index>(k)) = numberIn("--point", asked.at[k], scene);
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

/// Of joints, points or derivatives; none: it is none of these.
std::optional<EvaluatedColumn> ownColumnOf(const std::string& text,
                                           const EvaluateArguments& arguments,
                                           const scene::Scene& scene, JointAxes axes,
                                           ColumnSources& sources) {
  EvaluatedColumn column;
  column.name = text;
  column.of_joints = jointQuantityNamed(text);
  if (!column.of_joints) column.of_points = pointQuantityNamed(text);
  if (!column.of_joints && !column.of_points) column.derivative = derivativeQuantityNamed(text);
  if (!column.of_joints && !column.of_points && !column.derivative) return {};
  requireOurs(arguments, text);
  if (column.of_joints && !sources.joints) sources.joints.emplace(scene, arguments.joints, axes);
  if (column.of_points && !sources.points)
    sources.points.emplace(scene, pointsOf(arguments, scene), axesOfPoints(arguments));
  if (column.derivative && !sources.derivatives) sources.derivatives.emplace(scene);
  if (column.derivative) sources.derivatives->require(*column.derivative);
  return column;
}

/// Whether the constraints answer: of a tree alone they have nothing to say.
bool isOfConstraints(const std::optional<ConstrainedQuantity>& quantity,
                     const scene::Mechanism& mechanism) {
  if (quantity == ConstrainedQuantity::kQdd) return ConstrainedQuantities::isConstrained(mechanism);
  if (quantity == ConstrainedQuantity::kReactions) return hasMoreThanItsTree(mechanism);
  return quantity.has_value();
}

/// Of a witness: the one that is named, the user's program, or the usual sweep.
EvaluatedColumn witnessColumnOf(const std::string& text, const EvaluateArguments& arguments,
                                const scene::Scene& scene,
                                const std::optional<WitnessKind>& engine) {
  EvaluatedColumn column;
  column.name = text;
  column.along = alongNamed(text).value_or(Along::kNothing);
  column.quantity = column.along == Along::kNothing ? quantityNamed(text) : Quantity::kTau;
  column.is_engines = engine.has_value();
  const std::string who = engine                      ? engine->info.name
                          : arguments.witness.empty() ? usualWitness(column.quantity)
                                                      : arguments.witness;
  MadeWitness made = (engine ? *engine : selectWitnesses({who}).front()).make(scene);
  if (engine && made.isRefused()) throw scene::InputError({scene.file.string(), 0}, made.refusal());
  column.witness = std::move(made).value();
  if (!column.witness->answers(column.quantity))
    throw scene::InputError({}, fmt::format("witness '{}' does not answer {}", who, text));
  return column;
}

EvaluatedColumn columnOf(const std::string& text, const EvaluateArguments& arguments,
                         const scene::Scene& scene, const std::optional<WitnessKind>& engine,
                         JointAxes axes, ColumnSources& sources) {
  requireQuantity(text);
  if (std::optional<EvaluatedColumn> own = ownColumnOf(text, arguments, scene, axes, sources))
    return std::move(*own);
  std::vector<Eigen::Index> rows;
  if (text == "reactions") {
    rows = rowsOf(arguments.joints, scene.mechanism);
    if (axes != JointAxes::kLink) sources.axes.emplace(scene, axes);
  }
  EvaluatedColumn column;
  if (const auto quantity = constrainedQuantityNamed(text);
      isOfConstraints(quantity, scene.mechanism)) {
    if (!arguments.witness.empty() || engine)
      throw scene::InputError(
          {}, fmt::format("--witness or --engine with {} of a constrained scene, allowed: without",
                          text));
    column.name = text;
    column.constrained = *quantity;
  } else {
    column = witnessColumnOf(text, arguments, scene, engine);
  }
  column.rows = rows;
  return column;
}

/// @throws scene::InputError  options that belong to none of the quantities
void requireUseOfOptions(const EvaluateArguments& arguments, JointAxes axes,
                         const std::vector<EvaluatedColumn>& columns,
                         const ColumnSources& sources) {
  if (axes != JointAxes::kLink && !sources.joints && !sources.axes && !sources.points)
    throw scene::InputError(
        {}, fmt::format("--axes {} without a quantity that has axes of joints, expected reactions, "
                        "velocity, acceleration, jacobian, jacobian_rate or one of X, M_i, M_C, "
                        "M_A, P, PM, Z, F, PF, E; those of lambda are the "
                        "closure's (data/scenes/README.md)",
                        arguments.axes));
  const bool asks_of_joints = sources.joints || std::any_of(columns.begin(), columns.end(),
                                                            [](const EvaluatedColumn& column) {
                                                              return !column.rows.empty();
                                                            });
  if (!arguments.joints.empty() && !asks_of_joints)
    throw scene::InputError({},
                            "--joint without a quantity of joints, expected one of X, M_i, "
                            "M_C, M_A, P, PM, Z, F, PF, E, beta, reactions");
  if (!arguments.points.empty() && !sources.points)
    throw scene::InputError({},
                            fmt::format("--point without a quantity of points, expected one of {}",
                                        fmt::join(pointQuantityNames(), ", ")));
}

}  // namespace

std::vector<EvaluatedColumn> columnsOf(const EvaluateArguments& arguments,
                                       const scene::Scene& scene,
                                       const std::optional<WitnessKind>& engine,
                                       ColumnSources& sources) {
  const JointAxes axes = jointAxesNamed(arguments.axes).value_or(JointAxes::kLink);
  std::vector<EvaluatedColumn> columns;
  for (const std::string& text : arguments.quantities)
    columns.push_back(columnOf(text, arguments, scene, engine, axes, sources));
  requireUseOfOptions(arguments, axes, columns, sources);
  if (!arguments.uncertainty.empty()) addDeviations(scene, arguments, sources, columns);
  return columns;
}

Eigen::MatrixXd valueOf(EvaluatedColumn& column, ColumnSources& sources,
                        const scene::State<double>& state, long row) {
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

std::vector<std::string> headings(const EvaluatedColumn& column, const scene::Scene& scene,
                                  const EvaluateArguments& arguments, States& states,
                                  const ColumnSources& sources) {
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

}  // namespace dynwitness::cli
