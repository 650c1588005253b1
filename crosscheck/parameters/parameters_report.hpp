// SPDX-License-Identifier: GPL-3.0-or-later
// What `dynwitness parameters` found, for people and for programs.
#pragma once

#include <string>

#include "crosscheck/parameters/parameters.hpp"

namespace dynwitness::crosscheck {

std::string parametersText(const ParametersResult& result);
/// Follows parameters.schema.json.
std::string parametersJson(const ParametersResult& result, const std::string& version);

}  // namespace dynwitness::crosscheck
