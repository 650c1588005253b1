// SPDX-License-Identifier: GPL-3.0-or-later
// Apart from general_cost.cpp, since each takes a compiler long.
#include "crosscheck/kernel/counted.hpp"
#include "crosscheck/kernel/general_cost.hpp"
#include "recursive/build_model.hpp"
#include "recursive/fast/forward_dynamics_derivatives.hpp"

namespace dynwitness::crosscheck::kernel {

long generalDerivativeOperations(const scene::Mechanism& mechanism, bool of_accelerations) {
  namespace fast = recursive::fast;
  const fast::Plan<Counted> plan(recursive::buildModel(mechanism, CountedNumbers(mechanism)));
  // any state whose M can be divided by will do
  const std::vector<scene::JointPosition<Counted>> x(plan.positions, {0.5, 0.8, 0.6});
  const std::vector<Counted> rates(plan.dof, 0.25);
  const std::size_t n = plan.dof;
  std::vector<Counted> by_q(n * n), by_qd(n * n), by_third(n * n);
  if (of_accelerations) {
    fast::AccelerationDerivativesWorkspace<Counted> room(plan);
    Counted::operations = 0;
    fast::forwardDynamicsDerivatives(plan, x.data(), rates.data(), rates.data(), room,
                                     {by_q.data(), by_qd.data(), by_third.data()});
    const long solving = Counted::operations;
    return solving + generalOperations(mechanism, Formula::kForwardDynamics);  // qdd comes first
  }
  fast::DerivativesWorkspace<Counted> room(plan);
  Counted::operations = 0;
  fast::inverseDynamicsDerivatives(plan, x.data(), rates.data(), rates.data(), room,
                                   {by_q.data(), by_qd.data(), n, by_third.data(), n});
  return Counted::operations;
}

}  // namespace dynwitness::crosscheck::kernel
