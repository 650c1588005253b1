// SPDX-License-Identifier: GPL-3.0-or-later
// The scene's own kernel as two witnesses: one state at a time, and in the lanes of vectors.
#include <algorithm>
#include <iterator>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "crosscheck/kernel/compiled.hpp"
#include "crosscheck/kernel/kernel.hpp"
#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/witnesses/all_lanes.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/coupled.hpp"
#include "crosscheck/witnesses/exact_witness.hpp"
#include "crosscheck/witnesses/kernel_names.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/sharp_bounds.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

namespace dynwitness::crosscheck {
namespace {

using kernel::Formula;

constexpr Quantity kQuantities[] = {Quantity::kM, Quantity::kTau, Quantity::kQdd};

Formula formulaOf(Quantity quantity) {
  if (quantity == Quantity::kM) return Formula::kMassMatrix;
  return quantity == Quantity::kQdd ? Formula::kForwardDynamics : Formula::kInverseDynamics;
}

/** Values from the compiled code; bounds from the same program run on RunningError. The compiled
    code does what the program says, operation by operation, and its cos and sin are within the
    error that is taken for the C library's (kernel/emit.cpp); so the bound is that of the compiled
    code. */
class KernelWitness : public PartialWitness {
 public:
  KernelWitness(const PreparedScene& scene, bool lanes)
      : name_(lanes ? kKernelLanesName : kKernelName),
        lanes_(lanes),
        scene_(scene),
        kernel_(scene.kernel()),
        solve_bound_(scene, SolvedBy::kEither, 1) {
    const RunningErrorNumbers numbers(scene.mechanism());
    for (const Quantity quantity : kQuantities) {
      const Formula formula = formulaOf(quantity);
      if (!kernel_.has(formula)) continue;
      bounds_.try_emplace(formula, kernel_.road(formula).program, numbers);
      sharp_.try_emplace(formula, [this, formula] {
        return std::make_unique<symbolic::ProgramRun<AdjointError>>(
            kernel_.road(formula).program, AdjointErrorNumbers(scene_.mechanism()));
      });
    }
  }

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override {
    return std::find(std::begin(kQuantities), std::end(kQuantities), quantity) !=
               std::end(kQuantities) &&
           kernel_.has(formulaOf(quantity));
  }
  std::vector<std::pair<Quantity, std::string>> leftOut() const override {
    std::vector<std::pair<Quantity, std::string>> all;
    for (const Quantity quantity : kQuantities)
      if (const auto it = kernel_.notUsed().find(formulaOf(quantity));
          it != kernel_.notUsed().end())
        all.emplace_back(quantity, it->second);
    return all;
  }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    const Formula formula = formulaOf(quantity);
    const scene::State<RunningError> bounded_state = runningErrorState(state);
    const std::vector<RunningError> bounded = bounds_.at(formula)(bounded_state);
    const int rows = kernel_.dof(), columns = quantity == Quantity::kM ? rows : 1;
    using RowMajor = Eigen::Matrix<RunningError, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto sharply = [&](symbolic::ProgramRun<AdjointError>& run) {
      using SharpRowMajor =
          Eigen::Matrix<AdjointError, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      const std::vector<AdjointError> sharp = run(adjointState(bounded_state));
      return MatrixX<AdjointError>(Eigen::Map<const SharpRowMajor>(sharp.data(), rows, columns));
    };
    const MatrixX<RunningError> shaped = Eigen::Map<const RowMajor>(bounded.data(), rows, columns);
    Answer out = boundedAnswer(value(quantity, state), shaped);
    if (quantity != Quantity::kQdd) out.bound = sharp_.at(formula)(shaped, sharply);
    if (quantity == Quantity::kQdd && answers(Quantity::kTau))
      solve_bound_.judge(state, answer(Quantity::kTau, moving(state, out.value)).bound, out,
                         sharp_.at(formula), sharply);
    return out;
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    std::vector<double> q;
    for (const scene::JointPosition<double>& x : state.x) q.push_back(x.q);
    const std::vector<double>& w = quantity == Quantity::kQdd ? state.tau : state.qdd;
    const std::vector<double> out =
        lanes_ ? inAllLanes(quantity, q, state.qd, w) : inOne(quantity, q, state.qd, w);
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const RowMajor>(out.data(), kernel_.dof(),
                                      quantity == Quantity::kM ? kernel_.dof() : 1);
  }

 private:
  std::vector<double> inOne(Quantity quantity, const std::vector<double>& q,
                            const std::vector<double>& qd, const std::vector<double>& w) const {
    std::vector<double> out(quantity == Quantity::kM ? qd.size() * qd.size() : qd.size());
    run(quantity, q.data(), qd.data(), w.data(), out.data(), 0);
    return out;
  }

  std::vector<double> inAllLanes(Quantity quantity, const std::vector<double>& q,
                                 const std::vector<double>& qd,
                                 const std::vector<double>& w) const {
    const std::size_t n = qd.size(), outputs = quantity == Quantity::kM ? n * n : n;
    const auto kernel = [&](const double* all_q, const double* all_qd, const double* all_w,
                            double* out,
                            long count) { run(quantity, all_q, all_qd, all_w, out, count); };
    return askAllLanes(kernel, kernel_.lanes(), outputs, q, qd, w);
  }

  void run(Quantity quantity, const double* q, const double* qd, const double* w, double* out,
           long count) const {
    switch (formulaOf(quantity)) {
      case Formula::kMassMatrix:
        return count ? kernel_.massMatrix(q, out, count) : kernel_.massMatrix(q, out);
      case Formula::kForwardDynamics:
        return count ? kernel_.forwardDynamics(q, qd, w, out, count)
                     : kernel_.forwardDynamics(q, qd, w, out);
      default:
        return count ? kernel_.inverseDynamics(q, qd, w, out, count)
                     : kernel_.inverseDynamics(q, qd, w, out);
    }
  }

  std::string name_;
  bool lanes_;
  PreparedScene scene_;
  const kernel::Kernel& kernel_;  ///< of scene_; both witnesses share it
  SolveBound solve_bound_;
  std::map<Formula, symbolic::ProgramRun<RunningError>> bounds_;
  std::map<Formula, SharpBounds<symbolic::ProgramRun<AdjointError>>> sharp_;
};

WitnessKind kindOf(const std::string& name, bool lanes) {
  const std::string method =
      lanes ? fmt::format("the same code on {} states at once, every lane asked",
                          kernel::chosenLanes())
            : "the smallest program of the scene, as compiled C";
  WitnessInfo info{name, DYNWITNESS_VERSION, method};
  const auto made = [&]() -> WitnessKind {
    try {
      kernel::requireCompiler();
    } catch (const kernel::CannotCompile& error) {
      info.absent = error.what();
      return absentKind(info, info.absent);
    }
    return overTree(engineKind<KernelWitness>(info, lanes), Lacking::kAnswered);
  };
  WitnessKind kind = made();
  kind.is_compiled = true;
  return kind;
}

}  // namespace

WitnessKind kernelKind() {
  WitnessKind kind = kindOf(kKernelName, false);
  kind.make_exact = exactKernel;  // which needs no compiler; the lanes run the same programs
  return kind;
}
WitnessKind kernelLanesKind() {
  return kindOf(kKernelLanesName, true);
}

}  // namespace dynwitness::crosscheck
