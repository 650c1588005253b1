// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/exact/control_in_field.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

namespace dynwitness::crosscheck {
namespace {

std::vector<ExactWitness> sweepsInField(const scene::Scene& scene, const ExactOptions& options) {
  return exactWitnesses(scene, options.parameters, {newtonEulerKind(), articulatedBodyKind()});
}

/// Which quantities are zero, or have no value, at a random point: nothing to be too heavy there.
std::map<std::string, std::string> nothingInField(const scene::Scene& scene,
                                                  const ExactOptions& options) {
  const PrimeField::Modulus modulus(drawPrime(scene.name, options.seed, 0));
  const FieldSource source(scene.name, options.seed, 0);
  const FieldNumbers number(scene.mechanism, source, options.parameters);
  const scene::State<PrimeField> state =
      indeterminateState(scene.mechanism, source, options.parameters);
  std::map<std::string, std::string> nothing;
  for (const ExactWitness& sweep : sweepsInField(scene, options)) {
    for (const Quantity quantity : kAllQuantities) {
      if ((quantity == Quantity::kQdd) != (sweep.name == ArticulatedBody::kName)) continue;
      try {  // the prime may divide a number of the scene, too
        const MatrixX<PrimeField> value = sweep.in_field(number)(quantity, state);
        const bool is_zero = std::all_of(value.data(), value.data() + value.size(),
                                         [](const PrimeField& x) { return x.isZero(); });
        if (is_zero) nothing[name(quantity)] = "is zero";
      } catch (const DivisionByZero& error) {
        nothing[name(quantity)] = error.what();
      }
    }
  }
  return nothing;
}

}  // namespace

std::vector<Control> controlInField(const scene::Scene& scene, const ExactOptions& options) {
  const std::map<std::string, std::string> nothing = nothingInField(scene, options);
  std::vector<ExactWitness> witnesses = sweepsInField(scene, options);
  for (ExactWitness& heavy : sweepsInField(heavier(scene, kUsualPower), options)) {
    heavy.name = kControl;
    heavy.is_control = true;
    witnesses.push_back(std::move(heavy));
  }
  std::vector<Control> controls;
  for (const CheckResult& check : compareExactly(scene, witnesses, options)) {
    if (!check.right_is_control || check.left_is_control) continue;
    Control control;
    control.quantity = check.quantity;
    if (const auto it = nothing.find(check.quantity); it != nothing.end()) {
      control.nothing = it->second;
    } else if (check.verdict == Verdict::kNotAnswerable) {
      control.nothing = check.reason;
    } else {
      control.size = std::pow(10.0, -kUsualPower);
      (check.verdict == Verdict::kDisagree ? control.found : control.missed)
          .push_back(Road::kField);
    }
    controls.push_back(control);
  }
  return controls;
}

}  // namespace dynwitness::crosscheck
