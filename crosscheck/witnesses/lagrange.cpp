// SPDX-License-Identifier: GPL-3.0-or-later
// The Lagrangian as a witness: M, c, g derived from T and V in symbolic/, run as straight-line
// programs in double and with running error bounds.
#include "crosscheck/witnesses/lagrange.hpp"

#include <stdexcept>

#include "crosscheck/witnesses/dense_equations.hpp"
#include "crosscheck/witnesses/exact_witness.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/program_answer.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "symbolic/quasi_velocities.hpp"
#include "symbolic/reactions.hpp"

namespace dynwitness::crosscheck {

DerivedPrograms::DerivedPrograms(const scene::Mechanism& mechanism, bool fold_parameters)
    : mechanism_(mechanism) {
  options_.fold_parameters = fold_parameters;
}

symbolic::Equations& DerivedPrograms::forces() const {
  if (!equations_) equations_ = symbolic::deriveForces(mechanism_, options_);
  return *equations_;
}

symbolic::Equations& DerivedPrograms::withMass() const {
  symbolic::Equations& equations = forces();
  if (equations.M.empty()) symbolic::addMassMatrix(mechanism_, options_, equations);
  return equations;
}

const symbolic::Reactions& DerivedPrograms::cut() const {
  if (!cut_)
    cut_ = symbolic::reactionsAlong(mechanism_, options_, constrainedFrames(mechanism_, true));
  return *cut_;
}

std::vector<symbolic::Node> DerivedPrograms::outputs(Quantity quantity) const {
  symbolic::Equations& equations = forces();
  switch (quantity) {
    case Quantity::kM: {
      std::vector<symbolic::Node> M;
      for (const auto& row : withMass().M) M.insert(M.end(), row.begin(), row.end());
      return M;
    }
    case Quantity::kc:
      return equations.c;
    case Quantity::kg:
      return equations.g;
    case Quantity::kTau:
      return symbolic::inverseDynamics(equations);
    case Quantity::kKinetic:
      return {equations.kinetic};
    case Quantity::kPotential:
      return {equations.potential};
    default:
      throw std::logic_error("DerivedPrograms: no program for this quantity");
  }
}

const symbolic::Program& DerivedPrograms::operator[](Quantity quantity) const {
  std::optional<symbolic::Program>& program = programs_[static_cast<int>(quantity)];
  if (program) return *program;
  if (quantity == Quantity::kReactions) {
    program = symbolic::compile(cut().graph, cut().lambda);
  } else if (quantity == Quantity::kg && !equations_) {  // nobody has asked for more
    symbolic::Equations energies = symbolic::deriveEnergies(mechanism_, options_);
    const std::vector<symbolic::Node> g = symbolic::positionGradient(energies, energies.potential);
    program = symbolic::compile(energies.graph, g);
  } else {
    const std::vector<symbolic::Node> nodes = outputs(quantity);
    program = symbolic::compile(equations_->graph, nodes);
  }
  return *program;
}

namespace {

class LagrangeWitness : public Witness {
 public:
  explicit LagrangeWitness(const PreparedScene& scene)
      : scene_(scene),
        in_double_(scene.derived(true), scene::RealNumbers<double>(scene.mechanism())),
        with_bounds_(scene.derived(true), RunningErrorNumbers(scene.mechanism())),
        sharp_([this] {
          auto answers = std::make_unique<DerivedAnswers<AdjointError>>(
              scene_.derived(true), AdjointErrorNumbers(scene_.mechanism()));
          answers->startAll();  // their parameters belong to the kept part of the tape
          return answers;
        }),
        solve_bound_(scene, SolvedBy::kMassMatrix, 1) {}

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return DerivedPrograms::answers(quantity); }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    return answerOfProgram(quantity, state, scene_.mechanism(), with_bounds_, sharp_, solve_bound_,
                           {value(quantity, state), {}});
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    return in_double_(quantity, state);
  }

 private:
  PreparedScene scene_;
  std::string name_ = "lagrange";
  DerivedAnswers<double> in_double_;
  DerivedAnswers<RunningError> with_bounds_;
  SharpBounds<DerivedAnswers<AdjointError>> sharp_;
  SolveBound solve_bound_;
};

}  // namespace

WitnessKind lagrangeKind() {
  return {
      {"lagrange", DYNWITNESS_VERSION, "derived from T and V (Euler-Lagrange), run as a program"},
      [](const PreparedScene& scene) { return makeWitness<LagrangeWitness>(scene); },
      exactLagrange};
}

}  // namespace dynwitness::crosscheck
