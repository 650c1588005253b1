// SPDX-License-Identifier: GPL-3.0-or-later
// The witness `table`: published numbers, compared at the digits that their source prints.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// What a table prints under this name: a quantity, or (none) the ratio of a pendulum's period to
/// that of small swings, "period_ratio". @throws scene::InputError on another name.
std::optional<Quantity> tabledQuantity(const std::string& name);

/// The tables beside the bundled scenes, in alphabetical order.
std::vector<std::filesystem::path> bundledTables();
/// The table's own scene file, or empty when it speaks about a bundled scene.
std::filesystem::path ownScene(const std::filesystem::path& table);
/// True when the table speaks about this scene.
bool isAbout(const std::filesystem::path& table, const scene::Scene& scene);

/** Every printed quantity of a table against every witness that answers it.
    @throws scene::InputError when the file is not a table or its scene does not fit */
std::vector<CheckResult> compareWithTable(const std::filesystem::path& table,
                                          const PreparedScene& scene,
                                          const std::vector<WitnessKind>& kinds);

/** Quantities of a table against which all witnesses stand who agree with each other: it is the
    table that is wrong, or the reading of the scene, which they share. One finding each, which says
    what the second reading (check_reading.hpp), if it is among the checks, has to say about it. */
std::vector<Finding> findTableDisputes(const std::string& scene_name,
                                       const std::vector<CheckResult>& checks);

}  // namespace dynwitness::crosscheck
