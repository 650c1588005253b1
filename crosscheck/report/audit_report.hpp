// SPDX-License-Identifier: GPL-3.0-or-later
// The audit for programs (its schema is audit.schema.json).
#pragma once

#include <string>

#include "crosscheck/audit/audit.hpp"
#include "crosscheck/report/environment.hpp"

namespace dynwitness::crosscheck {

/// The audit as JSON, one entry a statement. `holds` is true, false or "under condition"; corrected and
/// condition, with their residuals, are null where there are none. Formulas are plain text.
std::string auditJson(const audit::Audit& audit, const Environment& environment);

}  // namespace dynwitness::crosscheck
