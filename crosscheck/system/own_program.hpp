// SPDX-License-Identifier: GPL-3.0-or-later
// Where this program is: others of the project lie beside it.
#pragma once

#include <filesystem>
#include <system_error>

namespace dynwitness::crosscheck {

/// Empty where the system does not tell.
inline std::filesystem::path ownProgram() {
  std::error_code unknown;
  return std::filesystem::read_symlink("/proc/self/exe", unknown);
}

}  // namespace dynwitness::crosscheck
