// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled without much optimisation: all of a sweep is inlined, which takes a compiler minutes for
// a scalar that is no double.
#include "crosscheck/kernel/general_cost.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/scalars/eigen_scalar.hpp"
#include "recursive/build_model.hpp"
#include "recursive/fast/forward_dynamics.hpp"
#include "recursive/fast/inverse_dynamics.hpp"
#include "recursive/fast/mass_matrix.hpp"

namespace dynwitness::crosscheck::kernel {
namespace {

/// A double (the plan looks for zeros) whose operations are counted; changes of sign are free.
struct Counted {
  double value = 0;

  Counted() = default;
  Counted(double x) : value(x) {}  // NOLINT(google-explicit-constructor): numbers are constants
  bool isZero() const { return value == 0; }

  static thread_local long operations;
  static Counted counted(double x) {
    ++operations;
    return {x};
  }
  friend Counted operator+(Counted a, Counted b) { return counted(a.value + b.value); }
  friend Counted operator-(Counted a, Counted b) { return counted(a.value - b.value); }
  friend Counted operator*(Counted a, Counted b) { return counted(a.value * b.value); }
  friend Counted operator/(Counted a, Counted b) { return counted(a.value / b.value); }
  Counted operator-() const { return {-value}; }
  Counted& operator+=(Counted b) { return *this = *this + b; }
  Counted& operator-=(Counted b) { return *this = *this - b; }
  Counted& operator*=(Counted b) { return *this = *this * b; }
  Counted& operator/=(Counted b) { return *this = *this / b; }
  friend bool operator==(Counted a, Counted b) { return a.value == b.value; }
  friend bool operator!=(Counted a, Counted b) { return a.value != b.value; }
};

thread_local long Counted::operations = 0;

/// A scene's numbers in double.
class CountedNumbers {
 public:
  using Scalar = Counted;
  explicit CountedNumbers(const scene::Mechanism& mechanism) : numbers_(mechanism) {}
  Counted operator()(const scene::Number& number) const { return {numbers_(number)}; }
  scene::CosSin<Counted> angle(const scene::Number& radians) const {
    return of(numbers_.angle(radians));
  }
  scene::AxisTurn<Counted> axisTurn(const scene::Vector& axis) const {
    const scene::AxisTurn<double> turn = numbers_.axisTurn(axis);
    return {of(turn.alpha), of(turn.beta)};
  }

 private:
  static scene::CosSin<Counted> of(const scene::CosSin<double>& x) { return {{x.c}, {x.s}}; }
  scene::RealNumbers<double> numbers_;
};

}  // namespace
}  // namespace dynwitness::crosscheck::kernel

namespace Eigen {
template <>
struct NumTraits<dynwitness::crosscheck::kernel::Counted>
    : dynwitness::crosscheck::EigenScalar<dynwitness::crosscheck::kernel::Counted, 1, 1, 1> {};
}  // namespace Eigen

namespace dynwitness::crosscheck::kernel {

long generalOperations(const scene::Mechanism& mechanism, Formula formula) {
  namespace fast = recursive::fast;
  const fast::Plan<Counted> plan(recursive::buildModel(mechanism, CountedNumbers(mechanism)));
  // any state will do: what is left out is left out whatever the state is
  const std::vector<scene::JointPosition<Counted>> x(plan.positions, {0.5, 0.8, 0.6});
  const std::vector<Counted> rates(plan.dof, 0.25);
  const auto count = [&](auto workspace, std::size_t outputs, const auto& sweep) {
    std::vector<Counted> out(outputs);
    Counted::operations = 0;
    sweep(workspace, out.data());
    return Counted::operations;
  };
  const std::size_t n = plan.dof;
  switch (formula) {
    case Formula::kInverseDynamics:
      return count(fast::InverseDynamicsWorkspace<Counted>(plan), n, [&](auto& ws, Counted* out) {
        fast::inverseDynamics(plan, x.data(), rates.data(), rates.data(), ws, out);
      });
    case Formula::kMassMatrix:
      return count(fast::MassMatrixWorkspace<Counted>(plan), n * n,
                   [&](auto& ws, Counted* out) { fast::massMatrix(plan, x.data(), ws, out); });
    case Formula::kForwardDynamics:
      return count(fast::ForwardDynamicsWorkspace<Counted>(plan), n, [&](auto& ws, Counted* out) {
        fast::forwardDynamics(plan, x.data(), rates.data(), rates.data(), ws, out);
      });
    default:
      throw std::invalid_argument(
          fmt::format("generalOperations: formula: expected ID, M or FD, got {}", name(formula)));
  }
}

}  // namespace dynwitness::crosscheck::kernel
