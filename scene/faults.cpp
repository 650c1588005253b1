// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/faults.hpp"

#include <sstream>

namespace dynwitness::scene {

void Faults::add(const std::string& message) {
  std::istringstream lines(message);
  for (std::string line; std::getline(lines, line);) {
    if (told_.size() < kMostTold) told_.push_back(line);
    ++count_;
  }
}

void Faults::raise() const {
  if (count_ == 0) return;
  std::string all;
  for (const std::string& line : told_) all += (all.empty() ? "" : "\n") + line;
  if (count_ > told_.size())
    all += "\n... and " + std::to_string(count_ - told_.size()) + " more faults";
  throw InputError({}, all);
}

}  // namespace dynwitness::scene
