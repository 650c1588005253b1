// SPDX-License-Identifier: GPL-3.0-or-later
// States from a CSV file.
#pragma once

#include <filesystem>
#include <vector>

#include "scene/mechanism.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/** Reads states of a mechanism. The first line names the columns, in any order: q1 .. q(positions) and
    qd1 .. qdn, then qdd1 .. qddn and/or tau1 .. taun, n its degrees of freedom. A group that is left
    out (except q) is zero. Quaternions need not be of length 1.
    Lines that start with # and empty lines are passed over.
    @throws scene::InputError  `file:line: ...` on unknown, doubled or missing columns, on a row of
    another length, on entries that are not finite numbers and on quaternions that are zero */
std::vector<scene::State<double>> readStates(const std::filesystem::path& file,
                                             const scene::Mechanism& mechanism);

}  // namespace dynwitness::crosscheck
