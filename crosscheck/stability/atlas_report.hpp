// SPDX-License-Identifier: GPL-3.0-or-later
// The atlas for people and programs: table, data, gnuplot scripts, JSON (its schema is
// stability.schema.json), and a page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "crosscheck/stability/atlas.hpp"

namespace dynwitness::crosscheck::stability {

/// One line a method: where it breaks, where theory says so, how it ends, whether it told.
std::string tableOf(const Turned& turned);

/// `severity,method,digits,stopped,warned`, a method after the other, theories last; under `#`
/// lines.
std::string csvOf(const Turned& turned);

/// Draws FAMILY.svg from FAMILY.csv beside it.
/// @param style  the path of style.gp, as seen from the script's folder
std::string scriptOf(const Turned& turned, const std::string& style);

/// A family's results, by which another run goes on.
/// @param made_by  version, commit and settings: results of another are made again
std::string familyJson(const Turned& turned, const std::string& made_by);
/// Nothing: the text is none, or was made by something else.
std::optional<Turned> familyFromJson(const std::string& text, const std::string& made_by);

std::string atlasJson(const std::vector<Turned>& atlas, const std::string& version);

/// @param version  of dynwitness
/// @param command  that makes the page again
std::string atlasPage(const std::vector<Turned>& atlas, const std::string& version,
                      const std::string& command);

/// Whom a theory is about: "all", "M formed", "swept", or its methods by name.
std::string aboutWords(const Theory& theory);

/// Severities at which a method, of ours in double or in float, was wrong without a word.
int silentOf(const std::vector<Turned>& atlas, bool ours);
/// Severities at which an estimate of ours warned though kPlentyOfDigits and more were right.
int falseAlarmsOf(const std::vector<Turned>& atlas);

/// The family of this name. @throws scene::InputError listing the names that exist
const Family& familyNamed(const std::string& name);

}  // namespace dynwitness::crosscheck::stability
