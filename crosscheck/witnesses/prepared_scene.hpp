// SPDX-License-Identifier: GPL-3.0-or-later
// A scene and what its crosscheck makes of it, each part once.
#pragma once

#include <memory>

#include "scene/scene.hpp"

namespace dynwitness::recursive {
template <typename T>
struct Model;
}  // namespace dynwitness::recursive

namespace dynwitness::crosscheck {
namespace kernel {
class Kernel;
class SmallestRoads;
}  // namespace kernel
class DerivedPrograms;

/** A scene, the models of its sweeps, its derived programs and its kernel. A part is made when it
    is first asked for, and then kept: whoever crosschecks a scene makes one of these and hands it
    down. Copies are the same prepared scene; what a function gives lives as long as any of them.
    Not for several threads at once.

    Arithmetics whose numbers change from use to use (the field's at each point, balls at each
    precision, those on a tape) have models of their own. */
class PreparedScene {
 public:
  // NOLINTBEGIN(google-explicit-constructor): a scene is enough for whoever asks one thing of it
  PreparedScene(scene::Scene scene);
  PreparedScene(const scene::Mechanism& mechanism);  ///< where neither name nor start matters
  // NOLINTEND(google-explicit-constructor)

  const scene::Scene& scene() const;
  const scene::Mechanism& mechanism() const { return scene().mechanism; }

  /// The scene with joints that follow others let go, starting at rest; itself where none follows.
  PreparedScene tree() const;

  /// For the sweeps, with the scene's numbers in T: double or RunningError.
  template <typename T>
  const recursive::Model<T>& model() const;
  /// The same with a link for every fixed joint.
  template <typename T>
  const recursive::Model<T>& modelWithFixedJoints() const;

  /// What the Lagrangian gives. @param fold_parameters  see symbolic::Options
  const DerivedPrograms& derived(bool fold_parameters) const;

  /// The programs that kernels are compiled from.
  const kernel::SmallestRoads& roads() const;
  /// @throws what kernel::Kernel does
  const kernel::Kernel& kernel() const;

 private:
  struct Parts;
  std::shared_ptr<Parts> parts_;
};

}  // namespace dynwitness::crosscheck
