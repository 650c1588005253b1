// SPDX-License-Identifier: GPL-3.0-or-later
// A scene's ledger for people and for programs.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "crosscheck/verdicts/ledger.hpp"

namespace dynwitness::crosscheck {

/// Lines with two blanks in front.
std::string ledgerText(const Ledger& ledger);
/// A section's inside, its headline apart.
std::string ledgerHtml(const Ledger& ledger);
/// As "ledger" of show.schema.json.
nlohmann::ordered_json ledgerJson(const Ledger& ledger);

}  // namespace dynwitness::crosscheck
