// SPDX-License-Identifier: GPL-3.0-or-later
// Our witnesses over the prime field. Compiled without much optimisation, as
// fast_sweeps_exact.cpp is.
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "crosscheck/kernel/roads.hpp"
#include "crosscheck/witnesses/coupled.hpp"
#include "crosscheck/witnesses/exact_sweeps.hpp"
#include "crosscheck/witnesses/lagrange.hpp"
#include "scene/own_rates.hpp"

namespace dynwitness::crosscheck {
namespace {

const auto kUnchanged = [](auto&, const auto&) {};

/// The programs that kernels are compiled from.
struct KernelPrograms {
  explicit KernelPrograms(const kernel::SmallestRoads& roads) : dof(roads.mechanism().dof()) {
    using kernel::Formula;
    for (const auto& [quantity, formula] : {std::pair(Quantity::kM, Formula::kMassMatrix),
                                            std::pair(Quantity::kTau, Formula::kInverseDynamics),
                                            std::pair(Quantity::kQdd, Formula::kForwardDynamics)}) {
      try {
        programs.emplace(quantity, roads(formula).program);
      } catch (const std::domain_error& error) {
        failures.emplace(quantity, error.what());
      } catch (const kernel::NotUsed&) {  // the kernel's own witness says why
      }
    }
  }
  bool answers(Quantity quantity) const {
    return programs.count(quantity) + failures.count(quantity) > 0;
  }
  std::map<Quantity, symbolic::Program> programs;
  std::map<Quantity, std::string> failures;  ///< why there is none
  int dof;
};

/// The same on numbers.
class KernelAnswers {
 public:
  using T = PrimeField;
  KernelAnswers(std::shared_ptr<const KernelPrograms> programs, const FieldNumbers& number)
      : programs_(std::move(programs)) {
    for (const auto& [quantity, program] : programs_->programs)
      runs_.emplace(quantity, symbolic::ProgramRun<T>(program, number));
  }
  MatrixX<T> operator()(Quantity quantity, const scene::State<T>& state) {
    if (const auto it = programs_->failures.find(quantity); it != programs_->failures.end())
      throw DivisionByZero(it->second);
    const std::vector<T> out = runs_.at(quantity)(state);
    return Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        out.data(), programs_->dof, quantity == Quantity::kM ? programs_->dof : 1);
  }

 private:
  std::shared_ptr<const KernelPrograms> programs_;
  std::map<Quantity, symbolic::ProgramRun<T>> runs_;
};

}  // namespace

OrRefusal<ExactWitness> exactLagrange(const PreparedScene& scene, Parameters parameters) {
  const bool fold = parameters == Parameters::kAsWritten;
  const auto on = [scene, fold](const FieldNumbers& number) {
    return [scene, answer = DerivedAnswers<PrimeField>(scene.derived(fold), number)](
               Quantity quantity, const scene::State<PrimeField>& state) mutable {
      return answer(quantity, state);
    };
  };
  return ExactWitness{"lagrange", DerivedPrograms::answers, on};
}

OrRefusal<ExactWitness> exactNewtonEuler(const PreparedScene& scene, Parameters) {
  return sweepWitness<NewtonEuler>(scene.scene(), kUnchanged);
}
OrRefusal<ExactWitness> exactCompositeBody(const PreparedScene& scene, Parameters) {
  return sweepWitness<CompositeBody>(scene.scene(), kUnchanged);
}
OrRefusal<ExactWitness> exactArticulatedBody(const PreparedScene& scene, Parameters) {
  return sweepWitness<ArticulatedBody>(scene.scene(), kUnchanged);
}

OrRefusal<ExactWitness> exactRecursiveLagrange(const PreparedScene& scene, Parameters) {
  return recursiveLagrangeWitness(scene.scene(), kUnchanged);
}

OrRefusal<ExactWitness> exactKernel(const PreparedScene& scene, Parameters parameters) {
  if (parameters != Parameters::kAsWritten)
    return Refusal{"a kernel is made for the numbers of its scene"};
  if (!scene.mechanism().isOpenTree())
    return Refusal{"kernels are made for open trees, without closures or springs between points"};
  if (scene.mechanism().hasCoulombFriction())
    return Refusal{"kernels compute with + - * / alone, and have no sign for Coulomb friction"};
  if (std::string reason = scene::hasNoTree(scene.mechanism()); !reason.empty())
    return Refusal{reason};
  const auto programs = std::make_shared<const KernelPrograms>(scene.tree().roads());
  const auto on = [programs, mechanism = scene.mechanism()](const FieldNumbers& number) {
    using T = PrimeField;
    return [answers = KernelAnswers(programs, number), coupled = mechanism.hasCoupledRates(),
            coupling = Coupling<T>(mechanism, number)](
               Quantity quantity, const scene::State<T>& state) mutable -> MatrixX<T> {
      return coupled ? coupling(quantity, state, answers) : answers(quantity, state);
    };
  };
  return ExactWitness{"kernel",
                      [programs](Quantity quantity) { return programs->answers(quantity); }, on};
}

}  // namespace dynwitness::crosscheck
