// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/impedance.hpp"

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/studies/given_values.hpp"
#include "crosscheck/studies/impedance_laws.hpp"
#include "crosscheck/studies/squares.hpp"
#include "crosscheck/verdicts/within_bounds.hpp"

namespace dynwitness::crosscheck {
namespace {

using Error = RunningError;

Bounded split(const MatrixX<Error>& m) {
  return {m.unaryExpr([](const Error& e) { return e.value(); }),
          m.unaryExpr([](const Error& e) { return e.bound(); })};
}
recursive::Vector3<Error> vector(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}
recursive::Matrix6<Error> diagonal(const std::array<double, 6>& d) {
  recursive::Matrix6<Error> m = recursive::Matrix6<Error>::Constant(Error(0));
  for (int i = 0; i < 6; ++i) m(i, i) = d[i];
  return m;
}

}  // namespace

ImpedanceAt impedanceAt(const scene::Scene& scene, const ImpedanceOptions& options) {
  const scene::Mechanism& mechanism = scene.mechanism;
  requireTreated(scene, Command::kImpedance);
  requireMotion(scene);
  const scene::RealNumbers<double> number(mechanism);
  const std::vector<double> q = givenOr("q", options.q, inDouble(scene, scene.start_q));
  const std::size_t n = static_cast<std::size_t>(mechanism.dof());
  if (!options.joint_compliance.empty() && options.joint_compliance.size() != n)
    throw scene::InputError({}, fmt::format("joint compliance: {} values, allowed: {}",
                                            options.joint_compliance.size(), n));
  requireSquares("point", options.at);
  requireSquares("stiffness", options.stiffness);
  requireSquares("damping", options.damping);
  requireSquares("stretch", options.stretch);
  requireSquares("joint compliance", options.joint_compliance);
  scene::State<double> state;
  for (const double value : q) state.x.push_back(scene::jointPosition(value));
  state.qd.assign(n, 1.0);
  state.qdd.assign(n, 0.0);
  state.tau = state.qdd;
  const scene::State<Error> at = runningErrorState(state);

  Impedance<Error> z;
  z.point = {linkNamed(scene, options.link), vector(options.at)};
  z.K = diagonal(options.stiffness);
  z.D = diagonal(options.damping);
  z.stretch = vector(options.stretch);
  z.joint_compliance.assign(n, Error(1));
  for (std::size_t i = 0; i < options.joint_compliance.size(); ++i)
    z.joint_compliance[i] = options.joint_compliance[i];
  z.wrench << Error(1), Error(2), Error(3), Error(4), Error(5), Error(6);  // any

  ImpedanceModel<Error> model(mechanism, RunningErrorNumbers(mechanism));
  const MatrixX<Error> J = pointJacobian(model.model, at.x, z.point);
  ImpedanceAt out;
  out.J = split(J);
  out.stiffness = split(J.transpose() * z.K * J);
  out.damping = split(J.transpose() * z.D * J);
  MatrixX<Error> C = MatrixX<Error>::Constant(n, n, Error(0));
  for (std::size_t i = 0; i < n; ++i) C(i, i) = z.joint_compliance[i];
  out.compliance = split(J * C * J.transpose());
  out.mobility = split(model.mobility(at, J));
  const MatrixX<Error> J_linear = J.topRows(3);
  out.inertia = split(ImpedanceModel<Error>::inverse(model.mobility(at, J_linear)));
  const recursive::Vector3<Error> f = z.K.topLeftCorner<3, 3>() * z.stretch;
  try {
    out.geometric = split(model.geometricStiffness(at, z.point, f));
  } catch (const std::domain_error&) {  // quasi-velocities: there is no such matrix
  }
  out.checks = withinBounds(ImpedanceLaws::words(mechanism),
                            ImpedanceLaws::sides(mechanism, ImpedanceAsked<Error>(model, at, z)));
  return out;
}

}  // namespace dynwitness::crosscheck
