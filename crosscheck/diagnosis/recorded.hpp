// SPDX-License-Identifier: GPL-3.0-or-later
// Answers that have been given already: of a program that nobody can start here, or measured.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

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
    @throws scene::InputError  `file:line: ...`: columns or rows are missing, or say nothing */
Recorded readRecorded(const scene::Scene& scene, const std::filesystem::path& answers,
                      const std::filesystem::path& states);

/// A witness that answers at the recorded states alone, and is judged as a program from outside.
WitnessKind recordedKind(Recorded recorded, const std::string& name);

}  // namespace dynwitness::crosscheck
