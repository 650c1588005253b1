// SPDX-License-Identifier: GPL-3.0-or-later
// Answers that have been given already: of a program that nobody can start here, or measured.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/inputs/conventions.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

struct Recorded {
  std::vector<scene::State<double>> states;
  /// One a state, in their order.
  std::vector<std::pair<Quantity, std::vector<Eigen::MatrixXd>>> answers;
};

/** Reads a table of answers, columns as `evaluate` writes them, and the states that they belong to.

    @param states  a file of its own, with as many rows; empty: q.., qd.. and qdd.. stand beside the
                   answers, and tau.. is the answer to these
    @param convention  whose coordinates spherical and floating joints have in states and answers
      (inputs/conventions.hpp); none: the file has to say so, where that matters. Others than ours
      want states beside answers, and c only where it is the same force: with v in link axes
    @throws scene::InputError  `file:line: ...`: columns or rows are missing, or say nothing */
Recorded readRecorded(const scene::Scene& scene, const std::filesystem::path& answers,
                      const std::filesystem::path& states,
                      std::optional<CoordinateConvention> convention = {});

/// A witness that answers at the recorded states alone, and is judged as a program from outside.
WitnessKind recordedKind(Recorded recorded, const std::string& name);

}  // namespace dynwitness::crosscheck
