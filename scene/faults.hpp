// SPDX-License-Identifier: GPL-3.0-or-later
// What is wrong with a file, told at once and not one fault a run.
#pragma once

#include <string>
#include <vector>

#include "scene/error.hpp"

namespace dynwitness::scene {

/// Faults in the order in which they were found, a line each.
class Faults {
 public:
  /// So many are told; of the others their number.
  static constexpr std::size_t kMostTold = 20;

  /// Does a part of the work; what it finds wrong is kept, and the work goes on with the next part.
  template <typename Part>
  void collect(const Part& part) {
    try {
      part();
    } catch (const InputError& error) {
      add(error.what());
    }
  }
  /// @param message  of one fault, or of several, a line each
  void add(const std::string& message);
  bool isEmpty() const { return count_ == 0; }
  /// @throws InputError  there are any: all of them in one message
  void raise() const;

 private:
  std::vector<std::string> told_;
  std::size_t count_ = 0;
};

}  // namespace dynwitness::scene
