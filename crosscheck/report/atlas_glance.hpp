// SPDX-License-Identifier: GPL-3.0-or-later
// The stability atlas at a glance, in the report.
#pragma once

#include <filesystem>
#include <string>

namespace dynwitness::crosscheck {

/** The section "Where methods fail" of a stability.json that `dynwitness stability` wrote: a line a
    family, with the severities at which methods break drawn on its dial, and how often somebody was
    wrong without a word.
    @throws scene::InputError  no such file, or not what that command writes */
std::string atlasSection(const std::filesystem::path& stability_json);

}  // namespace dynwitness::crosscheck
