// SPDX-License-Identifier: GPL-3.0-or-later
// The three witnesses that are sweeps of recursive/: each answers in double, with the running error
// bound of the same sweep.
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

namespace dynwitness::crosscheck {
namespace {

template <typename Algorithm>
class SweepWitness : public Witness {
 public:
  explicit SweepWitness(const scene::Scene& scene)
      : in_double_(scene.mechanism, scene::RealNumbers<double>(scene.mechanism)),
        with_bounds_(scene.mechanism, RunningErrorNumbers(scene.mechanism)) {}

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return Algorithm::answers(quantity); }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    return boundedAnswer(value(quantity, state),
                         Algorithm::answer(with_bounds_, quantity, runningErrorState(state)));
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    return Algorithm::answer(in_double_, quantity, state);
  }

 private:
  std::string name_ = Algorithm::kName;
  Setup<double> in_double_;
  Setup<RunningError> with_bounds_;
};

template <typename Algorithm>
WitnessKind sweepKind() {
  return {{Algorithm::kName, DYNWITNESS_VERSION, Algorithm::kMethod},
          [](const scene::Scene& scene) -> std::unique_ptr<Witness> {
            return std::make_unique<SweepWitness<Algorithm>>(scene);
          }};
}

}  // namespace

WitnessKind newtonEulerKind() { return sweepKind<NewtonEuler>(); }
WitnessKind compositeBodyKind() { return sweepKind<CompositeBody>(); }
WitnessKind articulatedBodyKind() { return sweepKind<ArticulatedBody>(); }

}  // namespace dynwitness::crosscheck
