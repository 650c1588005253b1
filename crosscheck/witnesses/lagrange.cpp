// SPDX-License-Identifier: GPL-3.0-or-later
// The Lagrangian as a witness: M, c, g derived from T and V in symbolic/, run as straight-line
// programs in double and with running error bounds.
#include "crosscheck/witnesses/lagrange.hpp"

#include "crosscheck/witnesses/witnesses.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/reactions.hpp"

namespace dynwitness::crosscheck {

DerivedPrograms::DerivedPrograms(const scene::Mechanism& mechanism, bool fold_parameters) {
  symbolic::Options options;
  options.fold_parameters = fold_parameters;
  symbolic::Equations equations = symbolic::derive(mechanism, options);
  const std::vector<symbolic::Node> tau = symbolic::inverseDynamics(equations);
  std::vector<symbolic::Node> M;
  for (const auto& row : equations.M) M.insert(M.end(), row.begin(), row.end());
  dof_ = equations.dof();
  const auto keep = [&](Quantity quantity, const std::vector<symbolic::Node>& outputs) {
    programs_[static_cast<int>(quantity)] = symbolic::compile(equations.graph, outputs);
  };
  keep(Quantity::kM, M);
  keep(Quantity::kc, equations.c);
  keep(Quantity::kg, equations.g);
  keep(Quantity::kTau, tau);
  keep(Quantity::kKinetic, {equations.kinetic});
  keep(Quantity::kPotential, {equations.potential});
  const symbolic::Reactions cut = symbolic::reactions(mechanism, options);
  programs_[static_cast<int>(Quantity::kReactions)] = symbolic::compile(cut.graph, cut.lambda);
}

namespace {

class LagrangeWitness : public Witness {
 public:
  explicit LagrangeWitness(const scene::Scene& scene)
      : programs_(scene.mechanism, true),
        in_double_(programs_, scene::RealNumbers<double>(scene.mechanism)),
        with_bounds_(programs_, RunningErrorNumbers(scene.mechanism)) {}

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return DerivedPrograms::answers(quantity); }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    return boundedAnswer(value(quantity, state), with_bounds_(quantity, runningErrorState(state)));
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    return in_double_(quantity, state);
  }

 private:
  std::string name_ = "lagrange";
  DerivedPrograms programs_;
  DerivedAnswers<double> in_double_;
  DerivedAnswers<RunningError> with_bounds_;
};

}  // namespace

WitnessKind lagrangeKind() {
  return {{"lagrange", DYNWITNESS_VERSION, "derived from T and V (Euler-Lagrange), run as a program"},
          [](const scene::Scene& scene) -> std::unique_ptr<Witness> {
            return std::make_unique<LagrangeWitness>(scene);
          }};
}

}  // namespace dynwitness::crosscheck
