// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "scene/error.hpp"
#include "scene/nearest_name.hpp"

namespace dynwitness::crosscheck {

/// The one of a table of integrators, each with a `name`, that is called so.
/// @throws scene::InputError  none is; it lists them
template <typename Methods>
const auto& methodNamed(const Methods& methods, const std::string& name) {
  std::string names;
  std::vector<std::string> all;
  for (const auto& method : methods) {
    if (name == method.name) return method;
    all.emplace_back(method.name);
    names += std::string(names.empty() ? "" : ", ") + method.name;
  }
  throw scene::InputError(
      {}, "unknown method '" + name + '\'' + scene::didYouMean(name, all) + ", allowed: " + names);
}

}  // namespace dynwitness::crosscheck
