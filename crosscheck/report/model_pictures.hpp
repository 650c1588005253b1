// SPDX-License-Identifier: GPL-3.0-or-later
// How little model a scene needs, in the report.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace dynwitness::crosscheck {

/** The section "How little model" of scenes' pages, by the scene's name: of what `dynwitness reduce
    --front` wrote operations against certified error, of what `dynwitness need` wrote the ladder.
    @param files   JSON of either, several of a scene as well
    @param scenes  names of those that the report is about
    @throws scene::InputError  no such file, not what these commands write, or of another scene */
std::map<std::string, std::string> modelSections(const std::vector<std::string>& files,
                                                 const std::vector<std::string>& scenes);

}  // namespace dynwitness::crosscheck
