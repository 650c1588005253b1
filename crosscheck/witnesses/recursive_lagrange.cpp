// SPDX-License-Identifier: GPL-3.0-or-later
// Recursive Lagrange as a witness, in double and with running error bounds.
#include "crosscheck/witnesses/recursive_lagrange.hpp"

#include "crosscheck/witnesses/witnesses.hpp"

namespace dynwitness::crosscheck {
namespace {

class RecursiveLagrangeWitness : public Witness {
 public:
  explicit RecursiveLagrangeWitness(const scene::Scene& scene)
      : in_double_(scene.mechanism, scene::RealNumbers<double>(scene.mechanism)),
        with_bounds_(scene.mechanism, RunningErrorNumbers(scene.mechanism)) {}

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override {
    return RecursiveLagrange<double>::answers(quantity);
  }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    return boundedAnswer(value(quantity, state), with_bounds_(quantity, runningErrorState(state)));
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    return in_double_(quantity, state);
  }

 private:
  std::string name_ = RecursiveLagrange<double>::kName;
  RecursiveLagrange<double> in_double_;
  RecursiveLagrange<RunningError> with_bounds_;
};

}  // namespace

WitnessKind recursiveLagrangeKind() {
  return {{RecursiveLagrange<double>::kName, DYNWITNESS_VERSION,
           "Lagrange's equations link by link, in homogeneous 4 x 4 matrices (Hollerbach)"},
          [](const scene::Scene& scene) -> std::unique_ptr<Witness> {
            return std::make_unique<RecursiveLagrangeWitness>(scene);
          }};
}

}  // namespace dynwitness::crosscheck
