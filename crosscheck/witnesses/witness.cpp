// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/witness.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "crosscheck/witnesses/witnesses.hpp"
#include "scene/nearest_name.hpp"

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

std::string WitnessInfo::convention(const std::string& label) const {
  const std::string lines = "\n" + conventions + "\n";
  const std::string start = "\n" + label + ": ";
  const std::size_t at = lines.find(start);
  if (at == std::string::npos) return "";
  const std::size_t begin = at + start.size();
  return lines.substr(begin, lines.find('\n', begin) - begin);
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

std::vector<WitnessKind> selectWitnesses(const std::vector<std::string>& names) {
  std::vector<WitnessKind> selected;
  std::string known;
  std::vector<std::string> all;
  for (const WitnessKind& kind : witnessKinds()) {
    if (kind.info.present) all.push_back(kind.info.name);
    known += (known.empty() ? "" : ", ") + kind.info.name + (kind.info.present ? "" : " (absent)");
    const bool asked = names.empty() ? kind.info.present
                                     : std::count(names.begin(), names.end(), kind.info.name) > 0;
    if (asked && kind.info.present) selected.push_back(kind);
  }
  for (const std::string& name : names) {
    const bool found = std::any_of(selected.begin(), selected.end(),
                                   [&](const WitnessKind& k) { return k.info.name == name; });
    if (!found)
      throw scene::InputError({}, fmt::format("unknown witness '{}'{}, allowed: {}", name,
                                              scene::didYouMean(name, all), known));
  }
  return selected;
}

}  // namespace dynwitness::crosscheck
