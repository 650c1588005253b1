// SPDX-License-Identifier: GPL-3.0-or-later
// The fast sweeps over the prime field and in degrees. Compiled without much optimisation: all of a sweep
// is inlined, which takes a compiler minutes for a scalar that is no double.
#include "crosscheck/witnesses/fast_sweeps.hpp"
#include "recursive/build_model.hpp"

namespace dynwitness::crosscheck {

ExactWitness fastWitness(const scene::Scene& scene) {
  const auto on = [mechanism = scene.mechanism](const auto& number) {
    using T = typename std::decay_t<decltype(number)>::Scalar;
    return [sweeps = FastSweeps<T>(recursive::buildModel(mechanism, number))](
               Quantity quantity, const scene::State<T>& state) mutable {
      return sweeps(quantity, state);
    };
  };
  return {kFastName, FastSweeps<double>::answers, on, on};
}

}  // namespace dynwitness::crosscheck
