// SPDX-License-Identifier: GPL-3.0-or-later
// What the witnesses of engines share that may be absent, or may be unable to hold a scene.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

/// Stands in for an engine that cannot hold the scene: its answer to every question is the reason.
class RefusedWitness : public Witness {
 public:
  RefusedWitness(std::string name, std::string reason)
      : name_(std::move(name)), reason_(std::move(reason)) {}

  const std::string& name() const override { return name_; }
  const std::string& reason() const { return reason_; }
  bool answers(Quantity) const override { return true; }
  Answer answer(Quantity, const scene::State<double>&) override {
    throw std::runtime_error(reason_);
  }

 private:
  std::string name_, reason_;
};

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

/// @throws std::runtime_error, which becomes the witness's answer, when a joint is of a kind that
/// the witness does not build.
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

/// A kind whose witnesses are W(scene, arguments...), or what W's constructor threw.
template <typename W, typename... Arguments>
WitnessKind engineKind(WitnessInfo info, Arguments... arguments) {
  const std::string name = info.name;
  return {std::move(info), [=](const scene::Scene& scene) -> std::unique_ptr<Witness> {
            try {
              return std::make_unique<W>(scene, arguments...);
            } catch (const std::exception& error) {
              return std::make_unique<RefusedWitness>(name, error.what());
            }
          }};
}

/// The kind of an engine that was not found when dynwitness was configured.
inline WitnessKind absentKind(const std::string& name, const std::string& method) {
  WitnessInfo info;
  info.name = name;
  info.method = method;
  info.present = false;
  return {info, [name](const scene::Scene&) -> std::unique_ptr<Witness> {
            return std::make_unique<RefusedWitness>(name,
                                                    "not found when dynwitness was configured");
          }};
}

}  // namespace dynwitness::crosscheck
