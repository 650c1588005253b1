// SPDX-License-Identifier: GPL-3.0-or-later
// The columns of evaluate's table: what was asked for, whom it is asked of, and its numbers.
#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "crosscheck/cli/asked_quantity.hpp"
#include "crosscheck/cli/converted_columns.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/engine_options.hpp"
#include "crosscheck/cli/given_states.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/motion/derivative_quantities.hpp"
#include "crosscheck/motion/joint_axes.hpp"
#include "crosscheck/motion/joint_quantities.hpp"
#include "crosscheck/motion/point_quantities.hpp"
#include "crosscheck/motion/uncertain_quantities.hpp"
#include "crosscheck/report/plot.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::cli {

/// What the command line asks of evaluate.
struct EvaluateArguments {
  GivenScene scene;
  StatesAsked states;
  std::string witness, output;
  std::vector<std::string> engines;  ///< a command, or none
  crosscheck::Limits limits;         ///< of that program
  std::vector<std::string> quantities;
  std::vector<std::string> joints;  ///< of these alone, what is asked of joints; none: of all
  std::vector<std::string> points;  ///< "LINK,x,y,z"; none: the origins of all links
  std::string format = "csv";
  crosscheck::PictureLook look;  ///< of a picture
  std::string axes;              ///< empty: of joints the link's, of points the world's
  bool units = false, warn = false;
  std::string uncertainty;  ///< readUncertainty(); empty: none
};

/// What constraints need, built when it is first asked for.
class ConstrainedOnDemand {
 public:
  explicit ConstrainedOnDemand(const scene::Scene& scene) : scene_(scene) {}
  const crosscheck::ConstrainedQuantities* operator->() {
    if (!built_) built_.emplace(scene_);
    return &*built_;
  }

 private:
  const scene::Scene& scene_;
  std::optional<crosscheck::ConstrainedQuantities> built_;
};

/// Whom columns without a witness are asked of.
struct ColumnSources {
  const scene::Mechanism& mechanism;
  ConstrainedOnDemand& constrained;
  std::optional<crosscheck::JointQuantities> joints = {};  ///< none: nothing of joints is asked
  std::optional<crosscheck::TurnedAxes> axes = {};  ///< of reactions; none: they are as they come
  std::optional<crosscheck::UncertainQuantities> uncertain = {};
  std::optional<crosscheck::PointQuantities> points = {};  ///< none: nothing of points is asked
  std::optional<crosscheck::DerivativeQuantities> derivatives = {};  ///< none: none is asked
  std::optional<ConvertedColumns> converted = {};  ///< none: in dynwitness' own coordinates

  /// Goes to a state.
  void at(const scene::State<double>& state) {
    if (joints) joints->at(state);
    if (axes) axes->at(state);
    if (points) points->at(state);
  }
};

/// That program failed, or has no value at a state.
struct EngineFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/** The columns of all quantities asked for, in their order; what they are asked of is built in
    sources.
    @param engine  the user's program of --engine; none: ours answer
    @throws scene::InputError  a quantity that is unknown, or that these witnesses do not answer, or
                               options that belong to none of the quantities */
std::vector<EvaluatedColumn> columnsOf(const EvaluateArguments& arguments,
                                       const scene::Scene& scene,
                                       const std::optional<crosscheck::WitnessKind>& engine,
                                       ColumnSources& sources);

/// One quantity at one state, finite. @param row  of the states, from 1
/// @throws EngineFailed       the user's program has no value
/// @throws scene::InputError  it is not finite, or redundant constraints leave it open
Eigen::MatrixXd valueOf(EvaluatedColumn& column, ColumnSources& sources,
                        const scene::State<double>& state, long row);

/// The names of a column's numbers, with units where they are asked for.
std::vector<std::string> headings(const EvaluatedColumn& column, const scene::Scene& scene,
                                  const EvaluateArguments& arguments, States& states,
                                  const ColumnSources& sources);

}  // namespace dynwitness::cli
