// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witness.hpp"

#include <array>

#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

namespace dynwitness::crosscheck {

const char* name(Quantity quantity) {
  switch (quantity) {
    case Quantity::kM:
      return "M";
    case Quantity::kc:
      return "c";
    case Quantity::kg:
      return "g";
    case Quantity::kTau:
      return "tau";
    case Quantity::kQdd:
      return "qdd";
    case Quantity::kKinetic:
      return "kinetic";
    case Quantity::kPotential:
      return "potential";
    case Quantity::kMomentum:
      return "momentum";
    case Quantity::kReactions:
      return "reactions";
  }
  return "?";
}

Quantity quantityNamed(const std::string& text) {
  std::string names;
  for (const Quantity quantity : kAllQuantities) {
    if (text == name(quantity)) return quantity;
    names += std::string(names.empty() ? "" : ", ") + name(quantity);
  }
  throw scene::InputError({}, "unknown quantity '" + text + "', allowed: " + names);
}

std::unique_ptr<Witness> makeWitness(const WitnessKind& kind, const scene::Scene& scene) {
  try {
    return kind.make(scene);
  } catch (const std::exception& error) {
    return std::make_unique<RefusedWitness>(kind.info.name, error.what());
  }
}

std::vector<WitnessKind> witnessKinds() {
  // MuJoCo twice: as it reads the file, and with the remedy for the digits that it loses then
  return {lagrangeKind(),
          newtonEulerKind(),
          compositeBodyKind(),
          articulatedBodyKind(),
          recursiveLagrangeKind(),
          fastKind(),
          kernelKind(),
          kernelLanesKind(),
          simbodyKind(),
          mujocoKind(),
          mujocoPrincipalKind(),
          dartKind(),
          kdlKind()};
}

}  // namespace dynwitness::crosscheck
