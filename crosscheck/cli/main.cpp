// SPDX-License-Identifier: GPL-3.0-or-later
// The command line.
#include "crosscheck/cli/front.hpp"

int main(int argc, char** argv) {
  using namespace dynwitness::cli;
  return front(argc, argv,
               {{"crosscheck", addCrosscheck},
                {"check", addCheck},
                {"museum", addMuseum},
                {"golden", addGolden},
                {"grade", addGrade},
                {"derive", addDerive},
                {"evaluate", addEvaluate},
                {"drift", addDrift},
                {"chart", addChart},
                {"audit", {}, kAuditDescription},
                {"simulate", addSimulate},
                {"rotors", addRotors},
                {"parameters", addParameters},
                {"readers", addReaders},
                {"same", addSame},
                {"write", addWrite},
                {"geometry", addGeometry},
                {"action", addAction},
                {"impulse", addImpulse},
                {"impedance", addImpedance},
                {"growth", {}, kGrowthDescription},
                {"scenes", addScenes},
                {"version", addVersion}});
}
