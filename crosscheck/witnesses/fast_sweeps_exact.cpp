// SPDX-License-Identifier: GPL-3.0-or-later
// The fast sweeps over the prime field.
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "crosscheck/witnesses/coupled.hpp"
#include "crosscheck/witnesses/exact_witness.hpp"
#include "crosscheck/witnesses/fast_sweeps.hpp"
#include "scene/mimic.hpp"
#include "scene/own_rates.hpp"

namespace dynwitness::crosscheck {

template class FastSweeps<PrimeField>;

namespace {

/// The tree of joints with rates of their own. Over the field every rate has the sign 1
/// (scene::directionOf), and of a joint that moves backward when its leader moves forward the tree
/// does not know: it is told by its friction.
scene::Mechanism treeOf(const scene::Mechanism& mechanism) {
  scene::Mechanism tree = scene::withOwnRates(mechanism);
  for (const scene::Follower& f : scene::followers(mechanism)) {
    scene::Friction& friction = tree.links[f.link].joint.friction;
    if (f.multiplier < 0 && friction.isCoulomb())
      friction.positive = scene::Number::parse("-(" + friction.negative.text() + ")");
  }
  return tree;
}

}  // namespace

OrRefusal<ExactWitness> exactFast(const PreparedScene& scene, Parameters) {
  if (std::string reason = scene::hasNoTree(scene.mechanism()); !reason.empty())
    return Refusal{reason};
  const auto on = [mechanism = scene.mechanism()](const FieldNumbers& number) {
    using T = PrimeField;
    return [sweeps = FastSweeps<T>(recursive::buildModel(treeOf(mechanism), number)),
            coupled = mechanism.hasCoupledRates(), coupling = Coupling<T>(mechanism, number)](
               Quantity quantity, const scene::State<T>& state) mutable -> MatrixX<T> {
      return coupled ? coupling(quantity, state, sweeps) : sweeps(quantity, state);
    };
  };
  return ExactWitness{kFastName, FastSweeps<double>::answers, on};
}

}  // namespace dynwitness::crosscheck
