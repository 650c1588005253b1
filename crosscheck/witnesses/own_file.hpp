// SPDX-License-Identifier: GPL-3.0-or-later
// Who reads the user's own file, and who a file that we write.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

/// A witness that is given a file.
class FileReader {
 public:
  virtual ~FileReader() = default;
  /// Whether that is the user's own, without its shapes and <mimic>.
  virtual bool readsOwnFile() const = 0;

 protected:
  FileReader() = default;
  FileReader(const FileReader&) = default;
  FileReader& operator=(const FileReader&) = default;
};

/// Whether a text that scene::urdfForEngines(told) gave is the scene's own file.
bool isOwnFile(const std::string& urdf, const scene::Scene& told);

/// Names of the witnesses that read the scene's own file; of a scene that is no URDF file, none.
std::vector<std::string> readersOfOwnFile(const PreparedScene& scene,
                                          const std::vector<WitnessKind>& kinds);

}  // namespace dynwitness::crosscheck
