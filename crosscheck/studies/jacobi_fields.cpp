// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/jacobi_fields.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "crosscheck/studies/meeting.hpp"
#include "crosscheck/studies/neighbouring_motions.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck::hamilton {

double movedByRounding(const Problem& problem, const std::vector<PhasePoint<D>>& now) {
  const int n = problem.n();
  const recursive::Model<DD> model = lifted<DD>(problem.model);
  recursive::Workspace<DD> ws(model);
  recursive::MatrixX<DD> M(n, n);
  Eigen::MatrixXd A(n, n), moved = Eigen::MatrixXd::Zero(n, n);
  for (int k = 0; k < n; ++k)
    for (int i = 0; i < n; ++i) A(i, k) = now[k].slots[i].derivative;
  for (int which = 0; which < 2 * n; ++which) {
    Eigen::MatrixXd P(n, n);
    for (int k = 0; k < n; ++k) {
      std::vector<DD> slots, qd;
      for (int i = 0; i < n; ++i) {
        const D &q = now[k].slots[i], &v = now[k].qd[i];
        slots.push_back(DD(D(q.value, which == i ? q.value : 0.0), D(q.derivative)));
        qd.push_back(DD(D(v.value, which == n + i ? v.value : 0.0), D(v.derivative)));
      }
      recursive::massMatrix(model, slotPositions(slots), ws, M);
      for (int i = 0; i < n; ++i) {
        DD p(D(0.0));
        for (int j = 0; j < n; ++j) p += M(i, j) * qd[j];
        P(i, k) = p.derivative.derivative;
      }
    }
    const Eigen::MatrixXd product = A.transpose() * P;
    moved += (product - product.transpose()).cwiseAbs();
  }
  return kRoundedByStep * moved.maxCoeff();
}

JacobiFields jacobiFields(const Problem& problem, int steps, scene::Work& work) {
  JacobiFields out;
  Neighbours neighbours(problem);
  Flow<double> plain = problem.flow<double>();
  const double h = problem.duration / steps;
  const auto determinant = [](const Eigen::MatrixXd& A, double t) {
    return (A / t).eval().determinant();
  };
  double before = 0, earlier = 0;           // determinants at the last two nodes
  std::vector<PhasePoint<D>> last_but_one;  // neighbours at the node before the last
  for (int k = 1; k <= steps; ++k) {
    const std::vector<PhasePoint<D>> from = neighbours.now;
    neighbours.step(h);
    work.doneTo((steps - kFirstSteps + k) / (2.0 * std::max(steps, 2 * kFirstSteps) - kFirstSteps));
    const std::vector<PhasePoint<D>> to = neighbours.now;
    const double time = h * k, det = determinant(neighbours.places(), time);
    if (k > 1 && before * det < 0) {  // between: halve the step until nothing is left of it
      double low = 0, high = h;
      for (double middle = h / 2; middle > low && middle < high; middle = low + (high - low) / 2) {
        neighbours.now = from;
        neighbours.step(middle);
        const double at = determinant(neighbours.places(), time - h + middle);
        (before * at > 0 ? low : high) = middle;
      }
      out.conjugates.push_back({time - h + low, 0, 1});
    } else if (k > 2 && std::abs(before) < std::min(std::abs(earlier), std::abs(det)) &&
               earlier * before > 0) {
      // it came near 0 and turned back: several neighbours may meet at once, which changes no sign
      const Action::Conjugate meeting = manyMeet(&neighbours, last_but_one, time - 2 * h, h);
      if (meeting.multiplicity >= 2) out.conjugates.push_back(meeting);
    }
    neighbours.now = to;
    last_but_one = from;
    earlier = before;
    before = det;
    const Eigen::MatrixXd A = neighbours.places();
    const bool is_shared = k % (steps / kFirstSteps) == 0;  // every size of steps comes here

    // neighbours stay Lagrangian: A'P = P'A
    if (problem.coordinates) {
      const Eigen::MatrixXd P = neighbours.momenta(), product = A.transpose() * P;
      for (int i = 0; i < problem.n(); ++i)
        for (int j = 0; j < i; ++j) out.unsymmetric.add(product(i, j) - product(j, i), is_shared);
      out.unsymmetric.terms = std::max(out.unsymmetric.terms, product.cwiseAbs().maxCoeff());
      if (is_shared) out.shared.push_back(neighbours.now);
    }
    // the motion a little later is a neighbour: its place is ahead by qd
    const PhasePoint<D>& later = neighbours.now.back();
    PhasePoint<double> y;
    for (const D& q : later.slots) y.slots.push_back(q.value);
    for (const D& qd : later.qd) y.qd.push_back(qd.value);
    for (const Values* values : {&y.slots, &y.qd})
      for (const double value : *values) out.size_state = std::max(out.size_state, std::abs(value));
    for (int k = 0; k < problem.n(); ++k)
      for (const auto* values : {&neighbours.now[k].slots, &neighbours.now[k].qd})
        for (const D& value : *values)
          out.growth = std::max(out.growth, std::abs(value.derivative));
    const Values slot_rates = plain.slotRates(y), qdd = plain.accelerations(y);
    const auto compare = [&](const D& found, double expected) {
      const double difference = found.derivative - expected;
      out.late.add(difference, is_shared);
      out.size_late = std::max(out.size_late, std::abs(expected));
    };
    for (std::size_t i = 0; i < y.slots.size(); ++i) compare(later.slots[i], slot_rates[i]);
    for (int i = 0; i < problem.dof(); ++i) compare(later.qd[i], qdd[i]);
  }
  // each step rounds the state, and neighbours say how far that carries
  out.late.terms = out.size_late + out.size_state * out.growth;
  return out;
}

}  // namespace dynwitness::crosscheck::hamilton
