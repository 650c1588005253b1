// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/column_names.hpp"

#include <fmt/format.h>

namespace dynwitness::crosscheck {

std::vector<std::string> columnNames(Quantity quantity, const scene::Mechanism& mechanism) {
  int n = mechanism.dof();
  std::vector<std::string> names;
  switch (quantity) {
    case Quantity::kM:
      for (int i = 1; i <= n; ++i)
        for (int j = 1; j <= n; ++j)
          names.push_back(fmt::format("M{}{}{}", i, n > 9 ? "_" : "", j));
      return names;
    case Quantity::kKinetic:
    case Quantity::kPotential:
      return {name(quantity)};
    case Quantity::kMomentum:
      n = 6;
      break;
    case Quantity::kReactions:
      for (const scene::Link& link : mechanism.links)
        for (const char* component : {"fx", "fy", "fz", "mx", "my", "mz"})
          if (link.parent >= 0) names.push_back(link.joint.name + "." + component);
      return names;
    default:
      break;
  }
  for (int i = 1; i <= n; ++i) names.push_back(fmt::format("{}{}", name(quantity), i));
  return names;
}

namespace {

/// Which rates are of slides and not of turns.
std::vector<bool> slides(const scene::Mechanism& mechanism) {
  using Kind = scene::JointKind;
  std::vector<bool> out;
  for (const scene::Link& link : mechanism.links)
    for (int k = 0; link.parent >= 0 && k < link.joint.ownRates(); ++k) {
      const Kind kind = link.joint.kind;
      out.push_back(kind == Kind::kPrismatic || (kind == Kind::kCylindrical && k == 0) ||
                    (kind == Kind::kPlanar && k < 2) || (kind == Kind::kFloating && k < 3));
    }
  return out;
}

}  // namespace

std::vector<std::string> columnUnits(Quantity quantity, const scene::Mechanism& mechanism) {
  static constexpr const char* kInertia[] = {"kg m^2", "kg m", "kg"};
  const std::vector<bool> slide = slides(mechanism);
  std::vector<std::string> units;
  switch (quantity) {
    case Quantity::kM:
      for (const bool i : slide)
        for (const bool j : slide) units.emplace_back(kInertia[(i ? 1 : 0) + (j ? 1 : 0)]);
      return units;
    case Quantity::kKinetic:
    case Quantity::kPotential:
      return {"J"};
    case Quantity::kMomentum:
      return {"N s", "N s", "N s", "N m s", "N m s", "N m s"};
    case Quantity::kReactions:
      for (std::size_t k = columnNames(quantity, mechanism).size() / 6; k > 0; --k)
        for (int row = 0; row < 6; ++row) units.emplace_back(row < 3 ? "N" : "N m");
      return units;
    case Quantity::kQdd:
      for (const bool of : slide) units.emplace_back(of ? "m/s^2" : "rad/s^2");
      return units;
    default:
      for (const bool of : slide) units.emplace_back(of ? "N" : "N m");
      return units;
  }
}

}  // namespace dynwitness::crosscheck
