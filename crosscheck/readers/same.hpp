// SPDX-License-Identifier: GPL-3.0-or-later
// Whether two descriptions are the same robot.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "scene/urdf.hpp"

namespace dynwitness::crosscheck {

/// A scene with what its file says beside it; parts is empty where the file is no URDF.
using Description = scene::Urdf;

/// The file of this path, URDF as it is written, or a scene (scene::findScene).
Description findDescription(const std::string& name_or_path);

struct Difference {
  std::string link, quantity;  ///< of the first description
  std::string a, b;
};

struct SameResult {
  enum class Verdict {
    kExactly,   ///< the same forces as functions, and the same numbers
    kToMotion,  ///< the same forces as functions: what differs, no motion can tell
    kInDouble,  ///< nothing differs by more than the rounding of doubles
    kDifferent
  };
  std::string a, b;
  Verdict verdict = Verdict::kDifferent;
  bool matched_by_name = true;
  std::vector<std::pair<std::string, std::string>> joints;  ///< of a, of b
  std::vector<Difference> differences;
  bool same_forces = false;      ///< over the prime field
  double error_probability = 1;  ///< that different forces pass
  int states = 0;
  double M_percent = 0, g = 0, tau = 0;  ///< at the worst of the states
  bool has_M = false;
  bool has_tau = false;

  bool isSame() const { return verdict != Verdict::kDifferent; }
};

/** Compares two open trees. Joints are matched by name, or, where names differ, by structure: kinds
    and places at q = 0, from the base outward. Link frames, order and fixed links may differ: all
    is seen in the frames that the links have at q = 0. That inverse dynamics are the same functions
    of q, qd, qdd is decided over the prime field, which is equality of all base parameters.
    @throws scene::InputError  a scene has closures, springs between points, loads, drives or
      acceleration constraints, or nothing moves */
SameResult compareDescriptions(const Description& a, const Description& b, int states,
                               std::uint64_t seed);

std::string sameText(const SameResult& result);
std::string sameJson(const SameResult& result, const std::string& version);

}  // namespace dynwitness::crosscheck
