// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/lagrange_derivatives.hpp"

#include "crosscheck/witnesses/lagrange.hpp"
#include "symbolic/quasi_velocities.hpp"

namespace dynwitness::crosscheck {

LagrangeDerivatives::LagrangeDerivatives(const scene::Mechanism& mechanism, bool fold_parameters)
    : LagrangeDerivatives(DerivedPrograms(mechanism, fold_parameters).forces()) {}

LagrangeDerivatives::LagrangeDerivatives(symbolic::Equations& equations) : dof(equations.dof()) {
  using symbolic::Direction;
  using symbolic::Input;
  using symbolic::Node;
  std::vector<Node> u;
  for (int k = 0; k < dof; ++k) u.push_back(equations.graph.input(Input::kForce, k));
  Direction by_qd, by_qdd;
  for (int k = 0; k < dof; ++k) {
    by_qd.push_back({{Input::kVelocity, k}, u[static_cast<std::size_t>(k)]});
    by_qdd.push_back({{Input::kAcceleration, k}, u[static_cast<std::size_t>(k)]});
  }
  const Direction by_q = symbolic::positionsAlong(equations, u);
  const std::vector<Node> tau = symbolic::inverseDynamics(equations);
  std::vector<Node> outputs;
  for (const Direction& along : {by_q, by_qd, by_qdd}) {
    const std::vector<Node> rates = equations.graph.directionalDerivative(tau, along);
    outputs.insert(outputs.end(), rates.begin(), rates.end());
  }
  forces = symbolic::compile(equations.graph, outputs);
  momenta =
      symbolic::compile(equations.graph, equations.graph.directionalDerivative(equations.p, by_qd));
}

}  // namespace dynwitness::crosscheck
