// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/witness.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/witnesses/engine_modules.hpp"
#include "crosscheck/witnesses/witness_names.hpp"
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

namespace {

struct Listed {
  const char* name;
  WitnessKind (*kind)();  ///< of an engine: loads its module
};

// MuJoCo twice: as it reads the file, and with the remedy for the digits that it loses then
constexpr Listed kListed[] = {{"lagrange", lagrangeKind},
                              {"newton_euler", newtonEulerKind},
                              {"composite_body", compositeBodyKind},
                              {"articulated_body", articulatedBodyKind},
                              {"recursive_lagrange", recursiveLagrangeKind},
                              {"fast", fastKind},
                              {"kernel", kernelKind},
                              {"kernel_lanes", kernelLanesKind},
                              {kSimbody.name, simbodyKind},
                              {kMujoco.name, mujocoKind},
                              {kMujocoPrincipal.name, mujocoPrincipalKind},
                              {kDart.name, dartKind},
                              {kKdl.name, kdlKind}};

/// Those of these names that are present, in the order of the list.
std::vector<WitnessKind> kindsNamed(const std::vector<std::string>& names) {
  std::vector<WitnessKind> kinds;
  for (const Listed& listed : kListed) {
    if (std::count(names.begin(), names.end(), listed.name) == 0) continue;
    WitnessKind kind = listed.kind();
    if (kind.info.present) kinds.push_back(std::move(kind));
  }
  return kinds;
}

}  // namespace

std::vector<std::string> witnessNames() {
  std::vector<std::string> names;
  for (const Listed& listed : kListed) names.emplace_back(listed.name);
  return names;
}

std::vector<WitnessKind> witnessKinds() {
  std::vector<WitnessKind> kinds;
  for (const Listed& listed : kListed) kinds.push_back(listed.kind());
  return kinds;
}

std::vector<WitnessKind> selectWitnesses(const std::vector<std::string>& names) {
  std::vector<WitnessKind> selected = kindsNamed(names.empty() ? witnessNames() : names);
  for (const std::string& name : names) {
    if (std::any_of(selected.begin(), selected.end(),
                    [&](const WitnessKind& kind) { return kind.info.name == name; }))
      continue;
    std::string known;
    std::vector<std::string> all;
    for (const WitnessKind& kind : witnessKinds()) {
      if (kind.info.present) all.push_back(kind.info.name);
      const std::string why = kind.info.absent.empty() ? "" : ": " + kind.info.absent;
      known += (known.empty() ? "" : ", ") + kind.info.name +
               (kind.info.present ? "" : " (absent" + why + ")");
    }
    throw scene::InputError({}, fmt::format("unknown witness '{}'{}, allowed: {}", name,
                                            scene::didYouMean(name, all), known));
  }
  return selected;
}

}  // namespace dynwitness::crosscheck
