// SPDX-License-Identifier: GPL-3.0-or-later
// A name for a text.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace dynwitness::crosscheck {

/// 128 bits of FNV-1a from two starts: against accidents, not against a user's own malice.
inline std::string hashOf(std::string_view text) {
  std::uint64_t a = 0xcbf29ce484222325u, b = 0x84222325cbf29ce4u;
  for (const char ch : text) {
    const auto c = static_cast<unsigned char>(ch);
    a = (a ^ c) * 0x100000001b3u;
    b = (b ^ c ^ (b >> 29)) * 0x100000001b3u;
  }
  return fmt::format("{:016x}{:016x}", a, b);
}

}  // namespace dynwitness::crosscheck
