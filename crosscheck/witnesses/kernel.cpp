// SPDX-License-Identifier: GPL-3.0-or-later
// The scene's own kernel as two witnesses: one state at a time, and in the lanes of vectors.
#include <cstring>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "crosscheck/arithmetic/running_error.hpp"
#include "crosscheck/kernel/compiled.hpp"
#include "crosscheck/kernel/kernel.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

namespace dynwitness::crosscheck {
namespace {

using kernel::Formula;

Formula formulaOf(Quantity quantity) {
  if (quantity == Quantity::kM) return Formula::kMassMatrix;
  return quantity == Quantity::kQdd ? Formula::kForwardDynamics : Formula::kInverseDynamics;
}

/// The kernel of a scene. The two witnesses share one, and so do those of a scene asked for twice.
std::shared_ptr<const kernel::Kernel> kernelOf(const scene::Scene& scene) {
  static std::map<std::string, std::weak_ptr<const kernel::Kernel>> kernels;
  std::weak_ptr<const kernel::Kernel>& known = kernels[scene::writeSceneToml(scene)];
  std::shared_ptr<const kernel::Kernel> kernel = known.lock();
  if (!kernel) known = kernel = std::make_shared<const kernel::Kernel>(scene.mechanism);
  return kernel;
}

/** Values from the compiled code; bounds from the same program run on RunningError. The compiled code
    does what the program says, operation by operation, and its cos and sin are within the error that
    is taken for the C library's (kernel/emit.cpp); so the bound is that of the compiled code. */
class KernelWitness : public Witness {
 public:
  KernelWitness(const scene::Scene& scene, bool lanes)
      : name_(lanes ? "kernel_lanes" : "kernel"), lanes_(lanes), kernel_(kernelOf(scene)) {
    const RunningErrorNumbers numbers(scene.mechanism);
    for (const Quantity quantity : {Quantity::kM, Quantity::kTau, Quantity::kQdd}) {
      const Formula formula = formulaOf(quantity);
      bounds_.try_emplace(formula, kernel_->road(formula).program, numbers);
    }
  }

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override {
    return quantity == Quantity::kM || quantity == Quantity::kTau || quantity == Quantity::kQdd;
  }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    const std::vector<RunningError> bounded =
        bounds_.at(formulaOf(quantity))(runningErrorState(state));
    const int rows = kernel_->dof(), columns = quantity == Quantity::kM ? rows : 1;
    using RowMajor = Eigen::Matrix<RunningError, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return boundedAnswer(value(quantity, state),
                         Eigen::Map<const RowMajor>(bounded.data(), rows, columns));
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    std::vector<double> q;
    for (const scene::JointPosition<double>& x : state.x) q.push_back(x.q);
    const std::vector<double>& w = quantity == Quantity::kQdd ? state.tau : state.qdd;
    const std::vector<double> out =
        lanes_ ? inAllLanes(quantity, q, state.qd, w) : inOne(quantity, q, state.qd, w);
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const RowMajor>(out.data(), kernel_->dof(),
                                      quantity == Quantity::kM ? kernel_->dof() : 1);
  }

 private:
  std::vector<double> inOne(Quantity quantity, const std::vector<double>& q,
                            const std::vector<double>& qd, const std::vector<double>& w) const {
    std::vector<double> out(quantity == Quantity::kM ? qd.size() * qd.size() : qd.size());
    run(quantity, q.data(), qd.data(), w.data(), out.data(), 0);
    return out;
  }

  /// The state in each lane in turn, other states beside it. Should one lane say something else than
  /// the first, that is the answer, for the comparisons to find.
  std::vector<double> inAllLanes(Quantity quantity, const std::vector<double>& q,
                                 const std::vector<double>& qd, const std::vector<double>& w) const {
    const std::size_t n = qd.size(), outputs = quantity == Quantity::kM ? n * n : n;
    const std::size_t lanes = kernel_->lanes(), count = 2 * lanes + 1;  // two whole blocks and a rest
    std::vector<double> first(outputs);
    for (std::size_t lane = 0; lane < count; ++lane) {
      const auto spread = [&](const std::vector<double>& x) {
        std::vector<double> all(x.size() * count);
        for (std::size_t i = 0; i < x.size(); ++i)
          for (std::size_t k = 0; k < count; ++k)
            all[i * count + k] =
                k == lane ? x[i] : x[(i + k) % x.size()] * (1.0 + static_cast<double>(k) / 8);
        return all;
      };
      const std::vector<double> all_q = spread(q), all_qd = spread(qd), all_w = spread(w);
      std::vector<double> all(outputs * count), here(outputs);
      run(quantity, all_q.data(), all_qd.data(), all_w.data(), all.data(), static_cast<long>(count));
      for (std::size_t i = 0; i < outputs; ++i) here[i] = all[i * count + lane];
      if (lane == 0) first = here;
      else if (std::memcmp(first.data(), here.data(), outputs * sizeof(double)) != 0) return here;
    }
    return first;
  }

  void run(Quantity quantity, const double* q, const double* qd, const double* w, double* out,
           long count) const {
    switch (formulaOf(quantity)) {
      case Formula::kMassMatrix:
        return count ? kernel_->massMatrix(q, out, count) : kernel_->massMatrix(q, out);
      case Formula::kForwardDynamics:
        return count ? kernel_->forwardDynamics(q, qd, w, out, count)
                     : kernel_->forwardDynamics(q, qd, w, out);
      default:
        return count ? kernel_->inverseDynamics(q, qd, w, out, count)
                     : kernel_->inverseDynamics(q, qd, w, out);
    }
  }

  std::string name_;
  bool lanes_;
  std::shared_ptr<const kernel::Kernel> kernel_;
  std::map<Formula, symbolic::ProgramRun<RunningError>> bounds_;
};

WitnessKind kindOf(const std::string& name, bool lanes) {
  const std::string method =
      lanes ? fmt::format("the same code on {} states at once, every lane asked", kernel::chosenLanes())
            : "the smallest program of the scene, as compiled C";
  WitnessInfo info{name, DYNWITNESS_VERSION, method};
  try {
    kernel::findCompiler();
    kernel::cacheFolder();
  } catch (const kernel::CannotCompile& error) {
    info.present = false;
    const std::string reason = error.what();
    return {info, [=](const scene::Scene&) -> std::unique_ptr<Witness> {
              return std::make_unique<RefusedWitness>(name, reason);
            }};
  }
  return engineKind<KernelWitness>(info, lanes);
}

}  // namespace

WitnessKind kernelKind() { return kindOf("kernel", false); }
WitnessKind kernelLanesKind() { return kindOf("kernel_lanes", true); }

}  // namespace dynwitness::crosscheck
