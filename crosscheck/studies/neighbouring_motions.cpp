// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/neighbouring_motions.hpp"

#include "crosscheck/studies/dependent_rates.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck::hamilton {

Neighbours::Neighbours(const Problem& problem) : problem(problem), flow(problem.flow<D>()) {
  Flow<double> plain = problem.flow<double>();
  const Values slot_rates = plain.slotRates(problem.start),
               qdd = plain.accelerations(problem.start);
  const Eigen::MatrixXd along = problem.isClosed()
                                    ? Dependence(problem, problem.start.slots).along
                                    : Eigen::MatrixXd::Identity(problem.n(), problem.n());
  for (int k = 0; k <= problem.n(); ++k) {
    PhasePoint<D> y;
    const bool later = k == problem.n();
    for (std::size_t i = 0; i < problem.start.slots.size(); ++i)
      y.slots.push_back(D(problem.start.slots[i], later ? slot_rates[i] : 0.0));
    for (int i = 0; i < problem.dof(); ++i)
      y.qd.push_back(D(problem.start.qd[i], later ? qdd[i] : along(i, k)));
    now.push_back(y);
  }
}

void Neighbours::step(double h) {
  for (PhasePoint<D>& y : now) y = flow.step(y, h);
}

Eigen::MatrixXd Neighbours::places() const {
  Eigen::MatrixXd A(problem.n(), problem.n());
  for (int k = 0; k < problem.n(); ++k) {
    const PhasePoint<D>& y = now[k];
    Values slots, aside;
    for (const D& q : y.slots) {
      slots.push_back(q.value);
      aside.push_back(q.derivative);
    }
    const Values change = ratesOfSlots(problem.model, slotPositions(slots), aside);
    for (int i = 0; i < problem.n(); ++i) A(i, k) = change[problem.surface.rates[i]];
  }
  return A;
}

Eigen::MatrixXd Neighbours::momenta() {
  const recursive::Model<D>& model = flow.model();
  recursive::Workspace<D> ws(model);
  recursive::MatrixX<D> M(problem.n(), problem.n());
  Eigen::MatrixXd P(problem.n(), problem.n());
  for (int k = 0; k < problem.n(); ++k) {
    recursive::massMatrix(model, slotPositions(now[k].slots), ws, M);
    for (int i = 0; i < problem.n(); ++i) {
      D p(0.0);
      for (int j = 0; j < problem.n(); ++j) p += M(i, j) * now[k].qd[j];
      P(i, k) = p.derivative;
    }
  }
  return P;
}

}  // namespace dynwitness::crosscheck::hamilton
