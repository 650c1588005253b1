// SPDX-License-Identifier: GPL-3.0-or-later
// Results as bytes, to go from one process to another: nothing is rounded or left out.
#pragma once

#include <string>

#include "crosscheck/conductor/campaign.hpp"
#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

std::string archived(const SceneResult& result);
std::string archived(const RandomCampaign& campaign);
/// What archived() was given.
SceneResult sceneResultOf(const std::string& bytes);
RandomCampaign randomCampaignOf(const std::string& bytes);

}  // namespace dynwitness::crosscheck
