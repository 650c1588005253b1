// SPDX-License-Identifier: GPL-3.0-or-later
// What a report says about a witness.
#pragma once

#include <string>

namespace dynwitness::crosscheck {

struct WitnessInfo {
  std::string name, version, method;  ///< method: one line, how it computes
  bool present = true;  ///< false: not found when dynwitness was configured, or as absent says
  /// The convention card: lines "label: text", how this witness spells what all are asked about,
  /// how it reads the mechanism, and where it is known to lose digits, why, and what removes that.
  std::string conventions = {};
  std::string absent =
      {};  ///< why it is not present, where that is not how dynwitness was configured

  /// The text of the card's line of this label, or "".
  std::string convention(const std::string& label) const;
};

}  // namespace dynwitness::crosscheck
