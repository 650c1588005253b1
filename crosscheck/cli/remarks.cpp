// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/remarks.hpp"

#include <filesystem>
#include <set>

#include "crosscheck/cli/standard_files.hpp"
#include "scene/remarks.hpp"

namespace dynwitness::cli {

std::vector<std::string> remarksOn(const GivenScene& given, const scene::Scene& scene) {
  std::error_code error;
  const bool is_file = std::filesystem::is_regular_file(given.name, error);
  return scene::remarksOn(scene, is_file ? std::filesystem::path(given.name) : scene.file);
}

void remark(const std::vector<std::string>& remarks) {
  static std::set<std::string> told;
  for (const std::string& line : remarks)
    if (told.insert(line).second) tell(line + "\n");
}

}  // namespace dynwitness::cli
