// SPDX-License-Identifier: GPL-3.0-or-later
// The Lagrangian as a witness: M, c, g derived from T and V in symbolic/, run as straight-line
// programs in double and with running error bounds.
#include "crosscheck/arithmetic/running_error.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "recursive/factorization.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck {
namespace {

/// The program of one quantity, on both scalars.
class Evaluation {
 public:
  Evaluation(const symbolic::Graph& graph, const std::vector<symbolic::Node>& outputs,
             const scene::Mechanism& mechanism)
      : program_(symbolic::compile(graph, outputs)),
        in_double_(program_, scene::RealNumbers<double>(mechanism)),
        with_bounds_(program_, RunningErrorNumbers(mechanism)) {}
  Evaluation(const Evaluation&) = delete;  // the runs point at the program
  Evaluation& operator=(const Evaluation&) = delete;

  std::vector<double> run(const scene::State<double>& state) { return in_double_(state); }
  std::vector<RunningError> run(const scene::State<RunningError>& state) {
    return with_bounds_(state);
  }

 private:
  symbolic::Program program_;
  symbolic::ProgramRun<double> in_double_;
  symbolic::ProgramRun<RunningError> with_bounds_;
};

class LagrangeWitness : public Witness {
 public:
  explicit LagrangeWitness(const scene::Scene& scene) : mechanism_(scene.mechanism) {
    symbolic::Options options;
    options.fold_parameters = true;
    equations_ = symbolic::derive(mechanism_, options);
    tau_ = symbolic::inverseDynamics(equations_);
  }

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return quantity != Quantity::kMomentum; }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    const scene::State<RunningError> bounded = runningErrorState(state);
    return boundedAnswer(value(quantity, state), shaped(quantity, bounded));
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    return shaped(quantity, state);
  }

 private:
  template <typename T>
  MatrixOf<T> shaped(Quantity quantity, const scene::State<T>& state) {
    if (quantity == Quantity::kM) return massMatrix(state);
    if (quantity == Quantity::kQdd) return accelerations(state);
    return column(evaluation(quantity).run(state));
  }

  template <typename T>
  MatrixOf<T> massMatrix(const scene::State<T>& state) {
    const std::vector<T> entries = evaluation(Quantity::kM).run(state);
    const int n = equations_.dof();
    return Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        entries.data(), n, n);
  }

  /// M qdd = tau - tau at qdd = 0
  template <typename T>
  MatrixOf<T> accelerations(const scene::State<T>& state) {
    scene::State<T> coasting = state;
    coasting.qdd.assign(state.qd.size(), T(0));
    const std::vector<T> bias = evaluation(Quantity::kTau).run(coasting);
    std::vector<T> qdd = state.tau;
    for (std::size_t i = 0; i < qdd.size(); ++i) qdd[i] -= bias[i];
    MatrixOf<T> M = massMatrix(state);
    recursive::factorize(M);
    recursive::solve(M, qdd);
    return column(qdd);
  }

  /// Programs are compiled when they are first asked for.
  Evaluation& evaluation(Quantity quantity) {
    std::unique_ptr<Evaluation>& slot = evaluations_[static_cast<int>(quantity)];
    if (!slot) slot = std::make_unique<Evaluation>(equations_.graph, outputs(quantity), mechanism_);
    return *slot;
  }

  std::vector<symbolic::Node> outputs(Quantity quantity) const {
    switch (quantity) {
      case Quantity::kM: {
        std::vector<symbolic::Node> entries;
        for (const auto& row : equations_.M) entries.insert(entries.end(), row.begin(), row.end());
        return entries;
      }
      case Quantity::kc: return equations_.c;
      case Quantity::kg: return equations_.g;
      case Quantity::kTau: return tau_;
      case Quantity::kKinetic: return {equations_.kinetic};
      case Quantity::kPotential: return {equations_.potential};
      case Quantity::kQdd:
      case Quantity::kMomentum: break;
    }
    throw std::logic_error("lagrange: not answered");
  }

  std::string name_ = "lagrange";
  scene::Mechanism mechanism_;
  symbolic::Equations equations_;
  std::vector<symbolic::Node> tau_;
  std::unique_ptr<Evaluation> evaluations_[std::size(kAllQuantities)];
};

}  // namespace

WitnessKind lagrangeKind() {
  return {{"lagrange", DYNWITNESS_VERSION, "derived from T and V (Euler-Lagrange), run as a program"},
          [](const scene::Scene& scene) -> std::unique_ptr<Witness> {
            return std::make_unique<LagrangeWitness>(scene);
          }};
}

}  // namespace dynwitness::crosscheck
