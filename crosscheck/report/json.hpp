// SPDX-License-Identifier: GPL-3.0-or-later
// The result for programs: report.json (its schema is report.schema.json) and JUnit XML.
#pragma once

#include <string>

#include "crosscheck/system/environment.hpp"
#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

/** The whole result as JSON. Fields that do not apply are left out; a residual that is no number is
    the string "inf" or "nan", because JSON has no such numbers and null would hide it.
    @param speed  what benchJson() wrote; may be empty
    @param pairs  what pairsJson() wrote; may be empty */
std::string reportJson(const CrosscheckResult& result, const Environment& environment,
                       const std::string& speed = {}, const std::string& pairs = {});

/// One check as JSON, as reportJson() writes it.
std::string checkJson(const CheckResult& check);

/// What it was computed with and where, as JSON, the version left out.
std::string environmentJson(const Environment& environment);

/** JUnit XML for CI systems: a test suite a scene, a test case a check; what is not answerable is
    skipped with its reason. */
std::string reportJUnit(const CrosscheckResult& result, const Environment& environment);

}  // namespace dynwitness::crosscheck
