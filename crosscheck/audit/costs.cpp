// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/audit/costs.hpp"

#include <vector>

#include "recursive/articulated_body.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/factorization.hpp"
#include "recursive/newton_euler.hpp"

namespace dynwitness::audit {

using recursive::MatrixX;

recursive::Model<Counted> chainOfTurns(int n) {
  recursive::Model<Counted> model;
  model.positions = n;
  for (int i = 0; i < n; ++i) {
    recursive::LinkModel<Counted> link;
    link.parent = i - 1;
    link.dof = link.slot = i;
    link.kind = recursive::JointKind::kRevolute;
    model.links.push_back(link);
    model.link_of_dof.push_back(i);
  }
  return model;
}

Cost costOf(int n) {
  const recursive::Model<Counted> model = chainOfTurns(n);
  const std::vector<scene::JointPosition<Counted>> x(static_cast<std::size_t>(n));
  recursive::Workspace<Counted> ws(model);
  std::vector<Counted> v(static_cast<std::size_t>(n)), tau = v, qdd = v;
  MatrixX<Counted> M(n, n);
  Cost cost{};
  const auto count = [](long* into, const auto& work) {
    Counted::operations() = {};
    work();
    *into = Counted::operations().total();
  };
  count(&cost.mass_matrix, [&] { recursive::massMatrix(model, x, ws, M); });
  count(&cost.inverse, [&] { recursive::inverseDynamics(model, x, v, qdd, ws, tau); });
  count(&cost.solve, [&] {
    recursive::factorize(M);
    recursive::solve(M, tau);
  });
  cost.solve += cost.inverse + n;  // tau - bias
  count(&cost.articulated, [&] { recursive::forwardDynamics(model, x, v, tau, ws, qdd); });
  return cost;
}

}  // namespace dynwitness::audit
