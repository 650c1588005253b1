// SPDX-License-Identifier: GPL-3.0-or-later
// The sections of the page, each appended to it; page.cpp puts them in order.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/report/page.hpp"
#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

// page_findings.cpp
void putDisagreements(std::string* page, const CrosscheckResult& result,
                      const std::vector<SceneFiles>& files);
/// Who loses digits that its algorithm need not lose: how many, why, and what removes it.
void putKnownLosses(std::string* page, const CrosscheckResult& result);
/// What was not answered, by quantity, and why; what ought to be and was not comes first.
void putCoverage(std::string* page, const CrosscheckResult& result);

// page_overview.cpp
void putSceneTable(std::string* page, const CrosscheckResult& result,
                   const std::vector<SceneFiles>& files);
void putWitnesses(std::string* page, const CrosscheckResult& result);

// page_scene.cpp, and parts of it in files of their own
/// @param root  the report's folder, seen from the page
void putScene(std::string* page, const SceneResult& scene, const SceneFiles& files,
              const std::string& root);
void putChecks(std::string* page, const SceneResult& scene);  ///< page_checks.cpp
/// What is published, what came out, and how far apart they are.
void putMotions(std::string* page, const SceneResult& scene);  ///< page_motions.cpp
// page_charts.cpp
void putDrift(std::string* page, const SceneResult& scene, const SceneFiles& files);
/// No number of the chart is on the page: times differ from run to run, and the page does not.
void putChart(std::string* page, const SceneFiles& files);

}  // namespace dynwitness::crosscheck
