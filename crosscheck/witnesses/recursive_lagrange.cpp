// SPDX-License-Identifier: GPL-3.0-or-later
// Recursive Lagrange as a witness, in double and with running error bounds.
#include "crosscheck/witnesses/recursive_lagrange.hpp"

#include "crosscheck/witnesses/exact_witness.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/program_answer.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

namespace dynwitness::crosscheck {
namespace {

class RecursiveLagrangeWitness : public Witness {
 public:
  explicit RecursiveLagrangeWitness(const PreparedScene& scene)
      : mechanism_(scene.mechanism()),
        in_double_(mechanism_, scene::RealNumbers<double>(mechanism_)),
        with_bounds_(mechanism_, RunningErrorNumbers(mechanism_)),
        sharp_([mechanism = mechanism_] {
          return std::make_unique<RecursiveLagrange<AdjointError>>(mechanism,
                                                                   AdjointErrorNumbers(mechanism));
        }),
        solve_bound_(scene, SolvedBy::kMassMatrix, 1) {}

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override {
    return RecursiveLagrange<double>::answers(quantity);
  }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    return answerOfProgram(quantity, state, mechanism_, with_bounds_, sharp_, solve_bound_,
                           {value(quantity, state), {}});
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    return in_double_(quantity, state);
  }

 private:
  scene::Mechanism mechanism_;
  std::string name_ = RecursiveLagrange<double>::kName;
  RecursiveLagrange<double> in_double_;
  RecursiveLagrange<RunningError> with_bounds_;
  SharpBounds<RecursiveLagrange<AdjointError>> sharp_;
  SolveBound solve_bound_;
};

}  // namespace

WitnessKind recursiveLagrangeKind() {
  return {{RecursiveLagrange<double>::kName, DYNWITNESS_VERSION,
           "Lagrange's equations link by link, in homogeneous 4 x 4 matrices (Hollerbach)"},
          [](const PreparedScene& scene) { return makeWitness<RecursiveLagrangeWitness>(scene); },
          exactRecursiveLagrange};
}

}  // namespace dynwitness::crosscheck
