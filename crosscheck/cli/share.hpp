// SPDX-License-Identifier: GPL-3.0-or-later
// Shares as options are given them.
#pragma once

#include <string>

#include "scene/error.hpp"
#include "scene/expression.hpp"

namespace dynwitness::cli {

/// "1%", "0.01": exact.
/// @throws scene::InputError  naming the option: no share from 0 to 1
inline scene::Rational shareOf(const std::string& option, const std::string& text) {
  const bool is_percent = !text.empty() && text.back() == '%';
  try {
    const scene::Exact x = scene::exactValue(
        scene::Expression::parse(is_percent ? text.substr(0, text.size() - 1) : text), {});
    const scene::Rational share = x.rational / (is_percent ? 100 : 1);
    if (x.isRational() && share >= 0 && share <= 1) return share;
  } catch (const scene::InputError&) {  // told below
  }
  throw scene::InputError(
      {}, option + ": got '" + text + "', allowed: a share from 0 to 1, or from 0% to 100%");
}

}  // namespace dynwitness::cli
