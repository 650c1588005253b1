// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness-studies: parameters and the studies of one scene, a program of their own (front.hpp).
#include "crosscheck/cli/front.hpp"

int main(int argc, char** argv) {
  using namespace dynwitness::cli;
  return front(argc, argv,
               {{"parameters", addParameters},
                {"geometry", addGeometry},
                {"action", addAction},
                {"impulse", addImpulse},
                {"impedance", addImpedance},
                {"linearize", addLinearize},
                {"sweep", addSweep},
                {"rotors", addRotors}});
}
