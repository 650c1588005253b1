// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/dependent_rates.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace dynwitness::crosscheck::hamilton {

Dependence::Dependence(const Problem& problem, const Values& slots) : dof(problem.dof()) {
  const Surface& surface = problem.surface;
  recursive::Constraints<double> closures = problem.closures;
  recursive::Workspace<double> ws(problem.model);
  recursive::constraintEquations(problem.model, slotPositions(slots), Values(dof, 0.0), ws,
                                 closures);
  const Eigen::MatrixXd J = closures.J(surface.rows, Eigen::all);
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(J(Eigen::all, surface.dependent));
  const double size = J.operatorNorm();
  regularity = (lu.matrixLU().diagonal().cwiseAbs() / size).minCoeff();
  if (lu.determinant() < 0) regularity = -regularity;
  inverse = lu.inverse();
  along = Eigen::MatrixXd::Zero(dof, problem.n());
  for (int a = 0; a < problem.n(); ++a) along(surface.rates[static_cast<std::size_t>(a)], a) = 1;
  along(surface.dependent, Eigen::all) = -inverse * J(Eigen::all, surface.rates);
}

}  // namespace dynwitness::crosscheck::hamilton
