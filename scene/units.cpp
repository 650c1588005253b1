// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/units.hpp"

namespace dynwitness::scene {

const char* unitOf(SlotKind slot) {
  switch (slot) {
    case SlotKind::kAngle:
      return "rad";
    case SlotKind::kLength:
      return "m";
    case SlotKind::kQuaternion:
      return "1";
  }
  return "?";
}

bool slides(JointKind kind, std::size_t rate) {
  if (ratesArePositionDerivatives(kind)) return positionSlots(kind)[rate] == SlotKind::kLength;
  return kind == JointKind::kFloating && rate < 3;  // the velocity comes before the rate of turning
}

}  // namespace dynwitness::scene
