// SPDX-License-Identifier: GPL-3.0-or-later
// One submission, heard in a cell: what was found out, without any marks.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "crosscheck/grade/rubric.hpp"
#include "crosscheck/grade/submission.hpp"

namespace dynwitness::crosscheck {

/** What was found out about a submission, as it is kept: JSON with its name, its key (keyOf),
    whether the others were hidden from it, remarks, why it could not be run, and a list of tasks,
    each with its scene and what `check` would say (check.schema.json), or why it could not be run.

    Leaves this process changed where `hides`: for a copy of it (inOwnCopies).

    @param hides   whether the machine can hide anything (cell.hpp)
    @param hidden  folders and files that it must not see
    @throws std::exception  a reason that is not the submission's */
std::string examinedRecord(const Submission& submission, const Rubric& rubric, bool hides,
                           const std::vector<std::filesystem::path>& hidden);

/// The most seconds that it may take before we are to blame.
double mostSeconds(const Rubric& rubric);

}  // namespace dynwitness::crosscheck
