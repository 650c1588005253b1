// SPDX-License-Identifier: GPL-3.0-or-later
// What of a scene each command takes into account: one table. The commands obey it, features.md
// shows it, and a test goes through every pair.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// The commands that take a scene. One that answers questions of several kinds stands here once a
/// kind.
enum class Command {
  kCrosscheck,
  kCheck,
  kGolden,
  kGrade,
  kDerive,
  kDerivePrograms,
  kDeriveOperations,
  kDeriveCode,
  kEvaluateTree,
  kEvaluateJoints,
  kEvaluatePoints,
  kEvaluateForces,
  kEvaluateMotion,
  kEvaluateTasks,
  kEvaluateDerivatives,
  kDrift,
  kChart,
  kSimulate,
  kRotors,
  kParameters,
  kGeometry,
  kAction,
  kImpulse,
  kImpedance,
  kLinearize,
  kSweep,
  kEnvelope,
  kReduce,
  kNeed,
  kAdvise,
  kShow,
  kCheckFormulas,
};
inline constexpr Command kAllCommands[] = {Command::kCrosscheck,     Command::kCheck,
                                           Command::kCheckFormulas,  Command::kGolden,
                                           Command::kGrade,          Command::kDerive,
                                           Command::kDerivePrograms, Command::kDeriveOperations,
                                           Command::kDeriveCode,     Command::kEvaluateTree,
                                           Command::kEvaluateJoints, Command::kEvaluatePoints,
                                           Command::kEvaluateForces, Command::kEvaluateMotion,
                                           Command::kEvaluateTasks,  Command::kEvaluateDerivatives,
                                           Command::kDrift,          Command::kChart,
                                           Command::kSimulate,       Command::kRotors,
                                           Command::kParameters,     Command::kGeometry,
                                           Command::kAction,         Command::kImpulse,
                                           Command::kImpedance,      Command::kLinearize,
                                           Command::kSweep,          Command::kEnvelope,
                                           Command::kReduce,         Command::kNeed,
                                           Command::kAdvise,         Command::kShow};
/// "drift", "evaluate (tau)"
const char* name(Command command);

/// What a scene may have. To add one: here, in kAllFeatures, in kWords and featuresOf()
/// (features.cpp), a scene of it in tests/crosscheck/inputs/test_features.cpp, and rules for the
/// commands that do not model it.
enum class Feature {
  kFixed,
  kRevolute,
  kPrismatic,
  kHelical,
  kCylindrical,
  kUniversal,
  kPlanar,
  kSpherical,
  kFloating,
  kGravity,
  kRotor,
  kGyroscopicRotor,
  kGearedRotor,
  kViscousFriction,
  kCoulombFriction,
  kJointSpring,
  kMimic,
  kLinkWrench,
  kWorldWrench,
  kDistanceClosure,
  kPlaneClosure,
  kPlanarPointClosure,
  kPointClosure,
  kHingeClosure,
  kWeldClosure,
  kSkateClosure,
  kRollingClosure,
  kPointSpring,
  kPointDamper,
  kDrivenJoint,
  kAccelerationConstraint,
  kStart,
  kNotModelled,
};
inline constexpr Feature kAllFeatures[] = {Feature::kFixed,
                                           Feature::kRevolute,
                                           Feature::kPrismatic,
                                           Feature::kHelical,
                                           Feature::kCylindrical,
                                           Feature::kUniversal,
                                           Feature::kPlanar,
                                           Feature::kSpherical,
                                           Feature::kFloating,
                                           Feature::kGravity,
                                           Feature::kRotor,
                                           Feature::kGyroscopicRotor,
                                           Feature::kGearedRotor,
                                           Feature::kViscousFriction,
                                           Feature::kCoulombFriction,
                                           Feature::kJointSpring,
                                           Feature::kMimic,
                                           Feature::kLinkWrench,
                                           Feature::kWorldWrench,
                                           Feature::kDistanceClosure,
                                           Feature::kPlaneClosure,
                                           Feature::kPlanarPointClosure,
                                           Feature::kPointClosure,
                                           Feature::kHingeClosure,
                                           Feature::kWeldClosure,
                                           Feature::kSkateClosure,
                                           Feature::kRollingClosure,
                                           Feature::kPointSpring,
                                           Feature::kPointDamper,
                                           Feature::kDrivenJoint,
                                           Feature::kAccelerationConstraint,
                                           Feature::kStart,
                                           Feature::kNotModelled};
/// "Coulomb friction"
const char* name(Feature feature);

/** What a command does about a feature:
      kModelled  what it prints depends on it
      kNoPart    what it prints does not depend on it, rightly: the reason
      kTold      left out, and said on standard error: the reason
      kRefused   the scene is refused (exit status 2): the reason */
struct Treatment {
  enum class Kind { kModelled, kNoPart, kTold, kRefused };
  Kind kind = Kind::kModelled;
  const char* reason = "";
};
Treatment treatment(Command command, Feature feature);

/// A feature of a scene, and the first part of the scene that has it.
struct FoundFeature {
  Feature feature;
  std::string what;  ///< "joint 'elbow' has Coulomb friction"
  scene::SourceLocation where;
};
/// Each feature of the scene once, in the order of kAllFeatures.
std::vector<FoundFeature> featuresOf(const scene::Scene& scene);

/// Why the command refuses the scene: a sentence a reason. None: it takes the scene.
std::vector<std::string> refusals(const scene::Scene& scene, Command command);
/// @throws scene::InputError  the first of refusals(), and which commands model the feature
void requireTreated(const scene::Scene& scene, Command command);
/// @throws scene::InputError when no joint of the scene moves: nothing can be asked about it then
void requireMotion(const scene::Scene& scene);

/// What the command leaves out of the scene and has to tell: a sentence a reason.
std::vector<std::string> leftOut(const scene::Scene& scene, Command command);

/// The table, as features.md has it.
std::string featuresMarkdown();

}  // namespace dynwitness::crosscheck
