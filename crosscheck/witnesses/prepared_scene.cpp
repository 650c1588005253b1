// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/prepared_scene.hpp"

#include <optional>
#include <utility>

#include "crosscheck/kernel/kernel.hpp"
#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "crosscheck/witnesses/lagrange.hpp"
#include "scene/own_rates.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Both models in one arithmetic.
template <typename Numbers>
class Models {
 public:
  using Model = recursive::Model<typename Numbers::Scalar>;

  const Model& lumped(const scene::Mechanism& mechanism) {
    return made(lumped_, mechanism, recursive::FixedJoints::kLumped);
  }
  const Model& kept(const scene::Mechanism& mechanism) {
    return made(kept_, mechanism, recursive::FixedJoints::kKept);
  }

 private:
  static const Model& made(std::optional<Model>& model, const scene::Mechanism& mechanism,
                           recursive::FixedJoints fixed) {
    if (!model) model.emplace(recursive::buildModel(mechanism, Numbers(mechanism), fixed));
    return *model;
  }
  std::optional<Model> lumped_, kept_;
};

}  // namespace

struct PreparedScene::Parts {
  explicit Parts(scene::Scene s) : scene(std::move(s)) {}

  auto& models(double) { return in_double; }
  auto& models(const RunningError&) { return with_bounds; }

  const scene::Scene scene;
  std::optional<PreparedScene> tree;
  Models<scene::RealNumbers<double>> in_double;
  Models<RunningErrorNumbers> with_bounds;
  std::optional<DerivedPrograms> folded, unfolded;
  std::optional<kernel::SmallestRoads> roads;
  std::optional<kernel::Kernel> kernel;
};

PreparedScene::PreparedScene(scene::Scene scene)
    : parts_(std::make_shared<Parts>(std::move(scene))) {}
PreparedScene::PreparedScene(const scene::Mechanism& mechanism)
    : PreparedScene([&mechanism] {
        scene::Scene scene;
        scene.mechanism = mechanism;
        return scene;
      }()) {}

const scene::Scene& PreparedScene::scene() const {
  return parts_->scene;
}

PreparedScene PreparedScene::tree() const {
  if (!mechanism().hasCoupledRates()) return *this;
  if (!parts_->tree) {
    scene::Scene tree = scene();
    tree.mechanism = scene::withOwnRates(mechanism());
    tree.start_q.insert(tree.start_q.end(),
                        static_cast<std::size_t>(tree.mechanism.positions()) - tree.start_q.size(),
                        scene::Number(0));
    tree.start_qd.assign(static_cast<std::size_t>(tree.mechanism.dof()), scene::Number(0));
    parts_->tree.emplace(std::move(tree));
  }
  return *parts_->tree;
}

template <typename T>
const recursive::Model<T>& PreparedScene::model() const {
  return parts_->models(T()).lumped(mechanism());
}
template <typename T>
const recursive::Model<T>& PreparedScene::modelWithFixedJoints() const {
  return parts_->models(T()).kept(mechanism());
}
template const recursive::Model<double>& PreparedScene::model() const;
template const recursive::Model<double>& PreparedScene::modelWithFixedJoints() const;
template const recursive::Model<RunningError>& PreparedScene::model() const;
template const recursive::Model<RunningError>& PreparedScene::modelWithFixedJoints() const;

const DerivedPrograms& PreparedScene::derived(bool fold_parameters) const {
  std::optional<DerivedPrograms>& programs = fold_parameters ? parts_->folded : parts_->unfolded;
  if (!programs) programs.emplace(mechanism(), fold_parameters);
  return *programs;
}

const kernel::SmallestRoads& PreparedScene::roads() const {
  if (!parts_->roads) parts_->roads.emplace(mechanism());
  return *parts_->roads;
}

const kernel::Kernel& PreparedScene::kernel() const {
  if (!parts_->kernel) parts_->kernel.emplace(roads());
  return *parts_->kernel;
}

}  // namespace dynwitness::crosscheck
