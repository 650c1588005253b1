// SPDX-License-Identifier: GPL-3.0-or-later
// The command line.
#include "crosscheck/cli/front.hpp"

int main(int argc, char** argv) {
  using namespace dynwitness::cli;
  return front(argc, argv,
               {{"crosscheck", addCrosscheck},
                {"check", {}, "check", kCheckDescription},
                {"museum", {}, "check", kMuseumDescription},
                {"golden", {}, "check", kGoldenDescription},
                {"grade", {}, "check", kGradeDescription},
                {"derive", addDerive},
                {"evaluate", addEvaluate},
                {"drift", addDrift},
                {"chart", addChart},
                {"audit", {}, "audit", kAuditDescription},
                {"simulate", addSimulate},
                {"rotors", {}, "studies", kRotorsDescription},
                {"parameters", {}, "studies", kParametersDescription},
                {"readers", {}, "readers", kReadersDescription},
                {"same", {}, "readers", kSameDescription},
                {"write", addWrite},
                {"geometry", {}, "studies", kGeometryDescription},
                {"action", {}, "studies", kActionDescription},
                {"impulse", {}, "studies", kImpulseDescription},
                {"impedance", {}, "studies", kImpedanceDescription},
                {"linearize", {}, "studies", kLinearizeDescription},
                {"sweep", {}, "studies", kSweepDescription},
                {"growth", {}, "growth", kGrowthDescription},
                {"show", addShow},
                {"scenes", addScenes},
                {"version", addVersion}});
}
