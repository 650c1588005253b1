// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/inputs/feature_pairs.hpp"

#include <algorithm>
#include <iterator>
#include <set>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/inputs/random_mechanism.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::JointKind;
using Convention = scene::Placement::Convention;

/// Of a joint and the link that it moves. The kinds come first, in their own order.
enum OfJoint {
  kFirstProperty = static_cast<int>(JointKind::kFloating) + 1,
  kOnTheWorld = kFirstProperty,
  kTurnedOnTheWorld,
  kTurned,
  kDisplaced,
  kAxisOffZ,
  kDh,
  kMdh,
  kRotor,
  kGyroscopicRotor,
  kGearedRotor,
  kGearedGyroscopicRotor,
  kViscous,
  kCoulomb,
  kSpring,
  kFollower,
  kMassless,
  kTurnedInertia,
  kInertiaAboutOrigin,
  kLinkWrench,
  kWorldWrench,
  kDriven,
  kOfJointCount
};

const std::vector<const char*>& ofJoint() {
  static const std::vector<const char*> names = [] {
    std::vector<const char*> out;
    for (int kind = 0; kind < kFirstProperty; ++kind)
      out.push_back(scene::name(static_cast<JointKind>(kind)));
    for (const char* name : {"on the world",
                             "turned on the world",
                             "turned frame",
                             "displaced frame",
                             "axis off z",
                             "Denavit-Hartenberg",
                             "modified Denavit-Hartenberg",
                             "rotor",
                             "gyroscopic rotor",
                             "geared to several rates",
                             "gyroscopic, to several rates",
                             "viscous friction",
                             "Coulomb friction",
                             "spring",
                             "follows another",
                             "massless link",
                             "inertia in turned axes",
                             "inertia about the link's origin",
                             "wrench in link axes",
                             "wrench in world axes",
                             "driven"})
      out.push_back(name);
    return out;
  }();
  return names;
}

/// Of a mechanism.
enum OfMechanism { kNoGravity, kGravityAlongZ, kGravityOffZ, kBranches, kFirstFeature };
/// Those of the table of features that make a mechanism more than its tree.
constexpr Feature kBesidesTheTree[] = {
    Feature::kDistanceClosure, Feature::kPlaneClosure,          Feature::kPlanarPointClosure,
    Feature::kPointClosure,    Feature::kHingeClosure,          Feature::kWeldClosure,
    Feature::kSkateClosure,    Feature::kRollingClosure,        Feature::kPointSpring,
    Feature::kPointDamper,     Feature::kAccelerationConstraint};

const std::vector<const char*>& ofMechanism() {
  static const std::vector<const char*> names = [] {
    std::vector<const char*> out = {"no gravity", "gravity along z", "gravity off z", "branches"};
    for (const Feature feature : kBesidesTheTree) out.push_back(name(feature));
    return out;
  }();
  return names;
}

bool isZero(const scene::Vector& v) {
  return std::all_of(v.begin(), v.end(), [](const auto& x) { return x.isLiteralZero(); });
}

std::vector<int> featuresOfJoint(const scene::Mechanism& mechanism, std::size_t i) {
  const scene::Link& link = mechanism.links[i];
  const scene::Joint& joint = link.joint;
  const scene::Placement& p = joint.placement;
  std::vector<int> out = {static_cast<int>(joint.kind)};
  const auto add = [&](bool has, int feature) {
    if (has) out.push_back(feature);
  };
  const bool turned = !isZero(p.rpy) || !p.alpha.isLiteralZero() || !p.theta.isLiteralZero();
  add(link.parent == 0, kOnTheWorld);
  add(link.parent == 0 && turned, kTurnedOnTheWorld);
  add(turned, kTurned);
  add(!isZero(p.xyz) || !p.a.isLiteralZero() || !p.d.isLiteralZero(), kDisplaced);
  add(!joint.axis[0].isLiteralZero() || !joint.axis[1].isLiteralZero(), kAxisOffZ);
  add(p.convention == Convention::kDh, kDh);
  add(p.convention == Convention::kMdh, kMdh);
  const bool has_rotor = !joint.rotor_inertia.isLiteralZero();
  add(has_rotor && !joint.gyroscopic, kRotor);
  add(has_rotor && joint.gyroscopic, kGyroscopicRotor);
  for (const bool gyroscopic : {false, true})
    add(std::any_of(joint.rotors.begin(), joint.rotors.end(),
                    [&](const scene::Rotor& r) { return r.axis.has_value() == gyroscopic; }),
        gyroscopic ? kGearedGyroscopicRotor : kGearedRotor);
  add(!joint.friction.viscous.isLiteralZero(), kViscous);
  add(joint.friction.isCoulomb(), kCoulomb);
  add(!joint.stiffness.isLiteralZero(), kSpring);
  add(joint.mimic.has_value(), kFollower);
  add(link.inertia.mass.isLiteralZero(), kMassless);
  add(!isZero(link.inertia.rpy), kTurnedInertia);
  add(link.inertia.about == scene::MassProperties::About::kLinkOrigin, kInertiaAboutOrigin);
  const auto hasWrench = [&](scene::Wrench::Axes axes) {
    return std::any_of(mechanism.wrenches.begin(), mechanism.wrenches.end(),
                       [&](const scene::Wrench& wrench) {
                         return wrench.link == static_cast<int>(i) && wrench.axes == axes;
                       });
  };
  add(hasWrench(scene::Wrench::Axes::kLink), kLinkWrench);
  add(hasWrench(scene::Wrench::Axes::kWorld), kWorldWrench);
  add(!joint.motion.empty(), kDriven);
  return out;
}

std::vector<int> featuresOfMechanism(const scene::Mechanism& mechanism) {
  std::vector<int> out;
  const scene::Vector& g = mechanism.gravity;
  if (!mechanism.has_gravity || isZero(g))
    out.push_back(kNoGravity);
  else
    out.push_back(g[0].isLiteralZero() && g[1].isLiteralZero() ? kGravityAlongZ : kGravityOffZ);
  std::set<int> parents;
  bool branches = false;
  for (std::size_t i = 1; i < mechanism.links.size(); ++i)
    branches = !parents.insert(mechanism.links[i].parent).second || branches;
  if (branches) out.push_back(kBranches);
  scene::Scene scene;  // the table of features is about scenes
  scene.mechanism = mechanism;
  scene.start_q = mechanism.restPosition();
  for (const FoundFeature& found : featuresOf(scene)) {
    const auto* const at =
        std::find(std::begin(kBesidesTheTree), std::end(kBesidesTheTree), found.feature);
    if (at != std::end(kBesidesTheTree))
      out.push_back(kFirstFeature + static_cast<int>(at - std::begin(kBesidesTheTree)));
  }
  return out;
}

// ---- what can occur -----------------------------------------------------------------------------

bool isKind(std::size_t feature) {
  return feature < kFirstProperty;
}
JointKind kindOf(std::size_t feature) {
  return static_cast<JointKind>(feature);
}

/// Whether the format lets a joint of that kind have it.
bool goesWith(JointKind kind, std::size_t property) {
  const bool has_one_q = scene::degreesOfFreedom(kind) == 1, has_axis = scene::hasAxis(kind);
  switch (property) {
    case kGearedRotor:
    case kGearedGyroscopicRotor:
      return scene::degreesOfFreedom(kind) > 1;
    case kRotor:
    case kGyroscopicRotor:
    case kViscous:
    case kCoulomb:
    case kSpring:
    case kFollower:
      return has_one_q;
    case kAxisOffZ:
      return has_axis;
    case kDh:
    case kMdh:
      return kind == JointKind::kFixed || (has_axis && kind != JointKind::kPlanar);
    case kDriven:
      return scene::degreesOfFreedom(kind) > 0 && scene::ratesArePositionDerivatives(kind);
    default:
      return true;
  }
}

/// Of one and the same joint.
bool excludeEachOther(std::size_t a, std::size_t b) {
  if (isKind(a) && isKind(b)) return true;
  if (isKind(a)) return !goesWith(kindOf(a), b);
  const auto isGeared = [](std::size_t x) {
    return x == kGearedRotor || x == kGearedGyroscopicRotor;
  };
  // of one rate and of several
  if (isGeared(b) && (a == kRotor || a == kGyroscopicRotor)) return true;
  if (isGeared(a) && (b == kViscous || b == kCoulomb || b == kSpring || b == kFollower))
    return true;
  constexpr std::pair<std::size_t, std::size_t> kApart[] = {{kDh, kMdh},
                                                            {kAxisOffZ, kDh},
                                                            {kAxisOffZ, kMdh},
                                                            {kRotor, kGyroscopicRotor},
                                                            {kMassless, kTurnedInertia},
                                                            {kMassless, kInertiaAboutOrigin},
                                                            {kFollower, kDriven}};
  return std::find(std::begin(kApart), std::end(kApart), std::pair{a, b}) != std::end(kApart);
}

/// Of random mechanisms: a link without mass is carried, or has a rotor to turn; where joints
/// follow others there are no constraints besides, which the sweeps could not pass.
bool isDrawn(PairRelation relation, std::size_t row, std::size_t column) {
  const bool of_joint = relation != PairRelation::kOneMechanism;
  const auto isConstraint = [](std::size_t feature) {
    if (feature < kFirstFeature) return false;
    const Feature of = kBesidesTheTree[feature - kFirstFeature];
    return of != Feature::kPointSpring && of != Feature::kPointDamper;
  };
  if (column == kFollower && (of_joint ? row == kDriven : isConstraint(row))) return false;
  if (of_joint && row == kFollower && column == kDriven) return false;
  // the format has no rotors geared to several rates beside what makes more than a tree
  const auto isGeared = [](std::size_t x, bool of) {
    return of && (x == kGearedRotor || x == kGearedGyroscopicRotor);
  };
  if (isGeared(column, true) && (of_joint ? row == kDriven : row >= kFirstFeature)) return false;
  if (isGeared(row, of_joint) && column == kDriven) return false;
  if (relation == PairRelation::kOneJoint && column == kMassless && isGeared(row, true))
    return false;  // a joint of several rates carries mass
  if (relation != PairRelation::kOneJoint || column != kMassless || !isKind(row)) return true;
  return kindOf(row) == JointKind::kFixed || scene::degreesOfFreedom(kindOf(row)) == 1;
}

struct Shape {
  const std::vector<const char*>* rows;
  const std::vector<const char*>* columns;
};
Shape shapeOf(PairRelation relation) {
  return {relation == PairRelation::kOneMechanism ? &ofMechanism() : &ofJoint(), &ofJoint()};
}
std::size_t sizeOf(PairRelation relation) {
  const Shape shape = shapeOf(relation);
  return shape.rows->size() * shape.columns->size();
}
/// Of the relation's first pair among all.
std::size_t offsetOf(PairRelation relation) {
  std::size_t offset = 0;
  for (const PairRelation before : kAllPairRelations)
    if (before < relation) offset += sizeOf(before);
  return offset;
}

template <typename Do>
void forEachPair(const Do& act) {
  for (const PairRelation relation : kAllPairRelations)
    for (std::size_t row = 0; row < shapeOf(relation).rows->size(); ++row)
      for (std::size_t column = 0; column < shapeOf(relation).columns->size(); ++column)
        act(relation, row, column);
}

}  // namespace

const char* name(PairRelation relation) {
  switch (relation) {
    case PairRelation::kOneJoint:
      return "on one joint";
    case PairRelation::kNextOutboard:
      return "on a joint, and on the next outboard";
    case PairRelation::kOneMechanism:
      return "of a mechanism, and on one of its joints";
  }
  return "";
}

int pairCount() {
  std::size_t count = 0;
  for (const PairRelation relation : kAllPairRelations) count += sizeOf(relation);
  return static_cast<int>(count);
}

std::vector<int> pairsOf(const scene::Mechanism& mechanism) {
  std::set<int> out;
  const auto add = [&](PairRelation relation, int row, int column) {
    out.insert(static_cast<int>(offsetOf(relation) +
                                static_cast<std::size_t>(row) * shapeOf(relation).columns->size() +
                                static_cast<std::size_t>(column)));
  };
  const std::vector<int> whole = featuresOfMechanism(mechanism);
  std::vector<std::vector<int>> joints(mechanism.links.size());
  for (std::size_t i = 1; i < mechanism.links.size(); ++i) {
    joints[i] = featuresOfJoint(mechanism, i);
    for (const int column : joints[i]) {
      for (const int row : joints[i])
        if (row < column) add(PairRelation::kOneJoint, row, column);
      for (const int row : joints[static_cast<std::size_t>(mechanism.links[i].parent)])
        add(PairRelation::kNextOutboard, row, column);
      for (const int row : whole) add(PairRelation::kOneMechanism, row, column);
    }
  }
  return {out.begin(), out.end()};
}

PairTable::PairTable() {
  for (const PairRelation relation : kAllPairRelations) cells_.emplace_back(sizeOf(relation));
}

void PairTable::add(const scene::Scene& scene) {
  add(scene.name, pairsOf(scene.mechanism));
}

void PairTable::add(const std::string& mechanism, const std::vector<int>& pairs) {
  ++mechanisms_;
  for (const int pair : pairs) {
    auto at = static_cast<std::size_t>(pair);
    std::size_t relation = 0;
    for (; at >= cells_[relation].size(); ++relation) at -= cells_[relation].size();
    Cell& cell = cells_[relation][at];
    if (cell.mechanisms++ == 0) cell.first = mechanism;
  }
}

const std::vector<const char*>& PairTable::rows(PairRelation relation) {
  return *shapeOf(relation).rows;
}
const std::vector<const char*>& PairTable::columns(PairRelation relation) {
  return *shapeOf(relation).columns;
}

PairNeed PairTable::need(PairRelation relation, std::size_t row, std::size_t column) {
  if (relation == PairRelation::kOneJoint && (row >= column || excludeEachOther(row, column)))
    return PairNeed::kCannotOccur;
  // on the world nothing is inboard
  if (relation == PairRelation::kNextOutboard &&
      (column == kOnTheWorld || column == kTurnedOnTheWorld))
    return PairNeed::kCannotOccur;
  return isDrawn(relation, row, column) ? PairNeed::kWanted : PairNeed::kNotDrawn;
}

const PairTable::Cell& PairTable::at(PairRelation relation, std::size_t row,
                                     std::size_t column) const {
  return cells_[static_cast<std::size_t>(relation)][row * columns(relation).size() + column];
}

int PairTable::wanted(PairRelation relation) const {
  int count = 0;
  forEachPair([&](PairRelation of, std::size_t row, std::size_t column) {
    count += of == relation && need(of, row, column) == PairNeed::kWanted ? 1 : 0;
  });
  return count;
}
int PairTable::covered(PairRelation relation) const {
  int count = 0;
  forEachPair([&](PairRelation of, std::size_t row, std::size_t column) {
    count += of == relation && need(of, row, column) == PairNeed::kWanted &&
                     at(of, row, column).mechanisms > 0
                 ? 1
                 : 0;
  });
  return count;
}

std::vector<PairTable::Pair> PairTable::missing() const {
  std::vector<Pair> out;
  forEachPair([&](PairRelation relation, std::size_t row, std::size_t column) {
    if (need(relation, row, column) == PairNeed::kWanted &&
        at(relation, row, column).mechanisms == 0)
      out.push_back({relation, rows(relation)[row], columns(relation)[column]});
  });
  return out;
}

std::vector<int> randomMechanismsOfPairs(std::uint64_t seed, int max_joints, int pool) {
  std::vector<char> is_open;  // by pair: wanted, and not yet found
  forEachPair([&](PairRelation relation, std::size_t row, std::size_t column) {
    is_open.push_back(PairTable::need(relation, row, column) == PairNeed::kWanted ? 1 : 0);
  });
  std::vector<std::vector<int>> pairs;
  for (int index = 0; index < pool; ++index)
    pairs.push_back(
        pairsOf(randomWholeScene(seed, static_cast<std::uint64_t>(index), max_joints).mechanism));
  std::vector<int> chosen;
  for (;;) {
    const auto gain = [&](const std::vector<int>& of) {
      return std::count_if(of.begin(), of.end(),
                           [&](int pair) { return is_open[static_cast<std::size_t>(pair)] != 0; });
    };
    std::size_t best = 0;
    std::ptrdiff_t most = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i)
      if (const auto n = gain(pairs[i]); n > most) most = n, best = i;
    if (most == 0) break;
    for (const int pair : pairs[best]) is_open[static_cast<std::size_t>(pair)] = 0;
    chosen.push_back(static_cast<int>(best));
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace dynwitness::crosscheck
