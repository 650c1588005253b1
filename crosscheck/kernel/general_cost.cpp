// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled without much optimisation: all of a sweep is inlined, which takes a compiler minutes for
// a scalar that is no double.
#include "crosscheck/kernel/general_cost.hpp"

#include <math.h>

#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/kernel/counted.hpp"
#include "recursive/build_model.hpp"
#include "recursive/fast/forward_dynamics.hpp"
#include "recursive/fast/inverse_dynamics.hpp"
#include "recursive/fast/mass_matrix.hpp"

namespace dynwitness::crosscheck::kernel {
namespace {

/// What sine_cosine.inc is read with here: one number, counted, and its bits, which are not.
struct Bits {
  long long operator[](int /*lane*/) const { return 0; }
};
[[maybe_unused]] Bits operator&(Bits, Bits) {
  return {};
}
[[maybe_unused]] Bits operator&(Bits, int) {
  return {};
}
[[maybe_unused]] Bits operator|(Bits, Bits) {
  return {};
}
[[maybe_unused]] Bits operator^(Bits, Bits) {
  return {};
}
[[maybe_unused]] Bits operator~(Bits) {
  return {};
}
[[maybe_unused]] Bits operator-(Bits) {
  return {};
}
[[maybe_unused]] Bits operator+(Bits, int) {
  return {};
}
[[maybe_unused]] Bits operator<<(Bits, int) {
  return {};
}
struct Angle : Counted {
  Angle() = default;
  Angle(double x) : Counted(x) {}          // NOLINT(google-explicit-constructor)
  Angle(const Counted& x) : Counted(x) {}  // NOLINT(google-explicit-constructor)
  explicit Angle(Bits /*of*/) {}
  explicit operator Bits() const { return {}; }
  double& operator[](int /*lane*/) { return value; }
  double operator[](int /*lane*/) const { return value; }
  friend Bits operator<=(const Angle&, const Angle&) { return {}; }
  friend Bits operator>=(const Angle&, const Angle&) { return {}; }
};

namespace angles {
using V = Angle;
using I = Bits;
enum { LANES = 1 };
#include "recursive/fast/sine_cosine.inc"
}  // namespace angles

}  // namespace

long sineCosineOperations() {
  static_cast<void>(angles::libraryOf);  // which larger angles than this one take
  Angle sine, cosine;
  Counted::operations = 0;
  angles::sineCosine(0.5, &sine, &cosine);
  return Counted::operations;
}

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
