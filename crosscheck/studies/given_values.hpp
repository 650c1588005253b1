// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of a state that a user gives, or the scene.
#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>

#include "scene/error.hpp"
#include "scene/numbers.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// The scene's numbers in double: of its start.
inline std::vector<double> inDouble(const scene::Scene& scene,
                                    const std::vector<scene::Number>& from) {
  const scene::RealNumbers<double> number(scene.mechanism);
  std::vector<double> out;
  for (const scene::Number& x : from) out.push_back(number(x));
  return out;
}

/// What an option gives, or where it gives nothing what stands there otherwise.
/// @throws scene::InputError naming the option, on another count
inline std::vector<double> givenOr(const std::string& option, const std::vector<double>& values,
                                   const std::vector<double>& otherwise) {
  if (values.empty()) return otherwise;
  if (values.size() != otherwise.size())
    throw scene::InputError(
        {}, fmt::format("{}: {} values, allowed: {}", option, values.size(), otherwise.size()));
  return values;
}

}  // namespace dynwitness::crosscheck
