// SPDX-License-Identifier: GPL-3.0-or-later
// States from a CSV file.
#pragma once

#include <filesystem>
#include <vector>

#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/** Reads states of n degrees of freedom. The first line names the columns, in any order: q1 .. qn and
    qd1 .. qdn, then qdd1 .. qddn and/or tau1 .. taun. A group that is left out (except q) is zero.
    Lines that start with # and empty lines are passed over.
    @throws scene::InputError  `file:line: ...` on unknown, doubled or missing columns, on a row of
    another length, and on entries that are not finite numbers */
std::vector<scene::State<double>> readStates(const std::filesystem::path& file, int n);

}  // namespace dynwitness::crosscheck
