// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/program.hpp"
#include "crosscheck/chart/derived_method.hpp"
#include "symbolic/equations.hpp"

namespace dynwitness::crosscheck {
namespace {

class ProgramMethod : public DerivedMethod {
 public:
  ProgramMethod(Quantity quantity, const scene::Mechanism& mechanism, const States& states)
      : DerivedMethod(MethodName::kProgram, quantity, mechanism.dof(), states),
        program_(programFor(quantity, mechanism)),
        run_(program_, scene::RealNumbers<double>(mechanism)),
        results_(program_.outputs.size()) {}

  void run(int state) override {
    scene::State<double>& s = states_[state];
    for (scene::JointPosition<double>& x : s.x) x = scene::jointPosition(x.q);
    const int n = static_cast<int>(out_.size());
    if (quantity_ == Quantity::kTau) {
      run_(s, out_.data());
      return;
    }
    run_(s, results_.data());
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) M_(i, j) = results_[i * n + j];
    if (quantity_ == Quantity::kM) return;
    const double *c = &results_[n * n], *g = c + n, *Q = g + n;
    for (int i = 0; i < n; ++i) out_[i] = s.tau[i] - c[i] - g[i] + Q[i];
    solve();
  }

 private:
  static symbolic::Program programFor(Quantity quantity, const scene::Mechanism& mechanism) {
    symbolic::Options options;
    options.fold_parameters = true;
    symbolic::Equations e = symbolic::deriveForces(mechanism, options);
    if (quantity == Quantity::kTau) return symbolic::compile(e.graph, symbolic::inverseDynamics(e));
    symbolic::addMassMatrix(mechanism, options, e);
    std::vector<symbolic::Node> nodes;
    for (const auto& row : e.M) nodes.insert(nodes.end(), row.begin(), row.end());
    if (quantity == Quantity::kQdd)
      for (const auto* part : {&e.c, &e.g, &e.Q})
        nodes.insert(nodes.end(), part->begin(), part->end());
    return symbolic::compile(e.graph, nodes);
  }

  symbolic::Program program_;
  symbolic::ProgramRun<double> run_;
  std::vector<double> results_;
};

}  // namespace

std::unique_ptr<Method> programMethod(Quantity quantity, const scene::Mechanism& mechanism,
                                      const States& states) {
  return std::make_unique<ProgramMethod>(quantity, mechanism, states);
}

}  // namespace dynwitness::crosscheck
