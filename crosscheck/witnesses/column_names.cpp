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

}  // namespace dynwitness::crosscheck
