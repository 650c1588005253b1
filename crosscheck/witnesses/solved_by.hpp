// SPDX-License-Identifier: GPL-3.0-or-later
// By which road a witness finds qdd.
#pragma once

namespace dynwitness::crosscheck {

/// How qdd is found: by a sweep over articulated inertias, from M qdd = tau - c - g, or not known
/// which.
enum class SolvedBy { kSweep, kMassMatrix, kEither };

}  // namespace dynwitness::crosscheck
