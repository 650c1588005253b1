// SPDX-License-Identifier: GPL-3.0-or-later
// What the witnesses of engines share that may be absent, or may be unable to hold a scene.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

/// A witness that answers some quantities for most scenes, and leaves them out for others, for a
/// reason.
class PartialWitness : public Witness {
 public:
  virtual std::vector<std::pair<Quantity, std::string>> leftOut() const = 0;
};

/// Joints that every engine has, and that URDF has words for, about which its readers agree.
inline bool isPlain(scene::JointKind kind) {
  return kind == scene::JointKind::kFixed || kind == scene::JointKind::kRevolute ||
         kind == scene::JointKind::kPrismatic;
}

/// @throws std::runtime_error, which becomes the refusal, when a joint is of a kind that the
/// witness does not build.
inline void requirePlainJoints(const scene::Mechanism& mechanism) {
  for (const scene::Link& link : mechanism.links)
    if (!isPlain(link.joint.kind))
      throw std::runtime_error("joint '" + link.joint.name + "' is " +
                               scene::name(link.joint.kind) +
                               ", this witness builds fixed, revolute and prismatic joints");
}

/// A witness that may fail as a whole at any time, and is better asked about many states at once.
class OutsideWitness : public PartialWitness {
 public:
  /// Asks about these states; answer() then has them at hand.
  /// @return  why it can testify about nothing (more); empty: it can
  virtual std::string askedAhead(const std::vector<scene::State<double>>& states) = 0;
  /// What it does in another way than the scene, and what was made of it.
  virtual std::vector<std::string> remarks() const = 0;
};

/// W(arguments...). What its constructor throws (engines and compilers say so that they cannot hold
/// a scene) is a reason from here on.
template <typename W, typename... Arguments>
MadeWitness makeWitness(const Arguments&... arguments) {
  try {
    return std::make_unique<W>(arguments...);
  } catch (const std::exception& error) {
    return Refusal{error.what()};
  }
}

/// A kind whose witnesses are W(scene, arguments...).
template <typename W, typename... Arguments>
WitnessKind engineKind(WitnessInfo info, Arguments... arguments) {
  return {std::move(info),
          [=](const PreparedScene& scene) { return makeWitness<W>(scene, arguments...); }};
}

/// Why an engine is absent that dynwitness was built without.
inline constexpr const char* kNotFound = "not found when dynwitness was built";

/// A kind that is not there for a reason that no scene changes.
inline WitnessKind absentKind(WitnessInfo info, const std::string& reason) {
  info.present = false;
  info.absent = reason;
  return {std::move(info), [reason](const PreparedScene&) { return Refusal{reason}; }};
}

/// The kind of an engine that was not found when dynwitness was configured.
inline WitnessKind absentKind(const std::string& name, const std::string& method) {
  WitnessInfo info;
  info.name = name;
  info.method = method;
  return absentKind(std::move(info), kNotFound);
}

}  // namespace dynwitness::crosscheck
