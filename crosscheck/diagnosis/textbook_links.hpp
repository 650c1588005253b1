// SPDX-License-Identifier: GPL-3.0-or-later
// What is asked of a textbook's links before something is put wrong with them. For the hypotheses
// and suspects (hypotheses_of_*.cpp, suspects.cpp) alone.
#pragma once

#include "crosscheck/diagnosis/textbook.hpp"

namespace dynwitness::crosscheck {

inline bool hasParent(const TextbookLink& link) {
  return link.parent >= 0;
}
/// Its joint is not a fixed one.
inline bool moves(const TextbookLink& link) {
  return link.parent >= 0 && link.kind != scene::JointKind::kFixed;
}
inline bool hasOneRate(const TextbookLink& link) {
  return link.parent >= 0 && scene::degreesOfFreedom(link.kind) == 1;
}
inline bool hasAxisOfOne(const TextbookLink& link) {
  return hasOneRate(link) && scene::hasAxis(link.kind);
}
inline bool isTrivial(const Frame& frame) {
  return frame.R == Matrix3d::Identity() && frame.p == Vector3d::Zero();
}
/// The link's frame in its parent's at q = 0.
inline Frame atRest(const TextbookLink& link) {
  return link.before * link.after;
}
/// Inertia about a point that is r away.
inline Matrix3d pointMass(double mass, const Vector3d& r) {
  return mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
}
/// What the theorem of parallel axes adds from the centre of mass to the link's origin.
inline Matrix3d toOrigin(const TextbookLink& link) {
  return pointMass(link.mass, link.com);
}

}  // namespace dynwitness::crosscheck
