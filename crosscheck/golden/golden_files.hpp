// SPDX-License-Identifier: GPL-3.0-or-later
// Golden vectors as files that need no dynwitness to be read.
#pragma once

#include <string>

#include "crosscheck/golden/golden.hpp"

namespace dynwitness::crosscheck {

/// The format of these files; what a reader of an older one would misunderstand makes it one more.
inline constexpr int kGoldenFormat = 1;

/// Scene, conventions, groups (golden.schema.json). @param version  of dynwitness
std::string goldenJson(const Golden& golden, const std::string& version);

/** Conventions and groups in lines that begin with #, then one line a number:

        group,state,role,quantity,row,column,value,digits50,radius,limit

    role is `given` (quantity q, qd, qdd, tau) or `wanted`; rows and columns are counted from 1. */
std::string goldenCsv(const Golden& golden, const std::string& version);

/// The same as arrays for C (C99) and C++.
std::string goldenHeader(const Golden& golden, const std::string& version);

}  // namespace dynwitness::crosscheck
