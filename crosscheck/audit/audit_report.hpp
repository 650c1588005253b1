// SPDX-License-Identifier: GPL-3.0-or-later
// The audit for programs (its schema is audit.schema.json) and as a page.
#pragma once

#include <filesystem>
#include <string>

#include "crosscheck/audit/audit.hpp"
#include "crosscheck/system/environment.hpp"

namespace dynwitness::crosscheck {

/// The audit as JSON, one entry a statement. `holds` is true, false or "under condition"; corrected
/// and condition, with their residuals, are null where there are none. Formulas are plain text.
std::string auditJson(const audit::Audit& audit, const Environment& environment);

/// The audit as one HTML page: what is wrong, then every entry. No scripts and no network.
/// @param report  where the crosscheck's report lies, seen from the page; empty: there is none
std::string auditPage(const audit::Audit& audit, const Environment& environment,
                      const std::string& report);

/// index.html and audit.json in a folder; files of others in it stay. In a report's folder the page
/// links back to the report.
/// @throws scene::InputError  the folder cannot be written to or is somebody else's
void writeAudit(const audit::Audit& audit, const Environment& environment,
                const std::filesystem::path& folder);

}  // namespace dynwitness::crosscheck
