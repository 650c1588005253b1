// SPDX-License-Identifier: GPL-3.0-or-later
// A simulated motion as a CSV file, which states files are read from, too.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/motion/formulations.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::cli {

/// What joints transmit along a motion, as `evaluate --quantity reactions` has it.
class ReactionsAlong {
 public:
  explicit ReactionsAlong(const scene::Scene& scene);
  const std::vector<std::string>& names() const { return names_; }
  /// NaN where redundant constraints leave them open.
  Eigen::MatrixXd at(const crosscheck::Simulation::Point& point) const;

 private:
  std::vector<std::string> names_;
  std::unique_ptr<crosscheck::Witness> sweep_;
  std::optional<crosscheck::ConstrainedQuantities> constrained_;
};

/// One row an output: time, q, qd, qdd, tau, multipliers, energies, how far constraints and energy
/// are off; and reactions. @param reactions  none: not asked
std::string csvOf(const crosscheck::Simulation& simulation, const scene::Mechanism& mechanism,
                  const ReactionsAlong* reactions);
/// The same of several runs, whose method stands in a first column.
std::string csvOf(const std::vector<const crosscheck::FormulationRun*>& runs,
                  const scene::Mechanism& mechanism, const ReactionsAlong* reactions);

}  // namespace dynwitness::cli
