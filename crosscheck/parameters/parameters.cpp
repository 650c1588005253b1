// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/parameters/parameters.hpp"

#include <cmath>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/parameters/condition.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/regressor.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

double squareOf(const Eigen::VectorXd& matrices, Eigen::Index joint, int row, int column) {
  double sum = 0;  // of a three by three block, row by row of six
  for (Eigen::Index i = 0; i < 3; ++i)
    sum += matrices.segment<3>(36 * joint + 6 * (row + i) + column).squaredNorm();
  return sum;
}

/// Accelerations at the forces of the states, and what the joints pass on.
void propagateMotion(const scene::Scene& scene, const std::vector<scene::State<double>>& states,
                     UncertaintyResult* out) {
  const auto model =
      recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
  recursive::Workspace<double> ws(model);
  std::optional<JointQuantities> joints;
  if (refusals(scene, Command::kEvaluateJoints).empty())
    joints.emplace(scene, std::vector<std::string>());
  const UncertainQuantities uncertain(scene, out->given, joints ? &*joints : nullptr);
  out->qdd = out->of_qdd.by_inertia = out->of_qdd.by_placement = Eigen::VectorXd::Zero(model.dof());
  if (joints)
    for (const std::size_t link : joints->links())
      out->joints.push_back({scene.mechanism.links[link].joint.name, {}, {}});
  for (const scene::State<double>& state : states) {
    std::vector<double> qdd(static_cast<std::size_t>(model.dof()));
    recursive::forwardDynamics(model, state.x, state.qd, state.tau, ws, qdd);
    out->qdd += Eigen::Map<const Eigen::VectorXd>(qdd.data(), model.dof()).cwiseAbs2();
    const Deviations of_qdd = uncertain.qdd(state);
    out->of_qdd.by_inertia += of_qdd.by_inertia.cwiseAbs2();
    out->of_qdd.by_placement += of_qdd.by_placement.cwiseAbs2();
    if (!joints) continue;
    joints->at(state);
    const Eigen::VectorXd M_A = uncertain.joints(JointQuantity::kM_A, state).together(),
                          P = uncertain.joints(JointQuantity::kP, state).together();
    for (std::size_t k = 0; k < out->joints.size(); ++k) {
      const auto joint = static_cast<Eigen::Index>(k);
      for (int block = 0; block < 3; ++block)
        out->joints[k].M_A[block] += squareOf(M_A, joint, block == 2 ? 3 : 0, block == 0 ? 0 : 3);
      for (int block = 0; block < 4; ++block)
        out->joints[k].P[block] += squareOf(P, joint, 3 * (block / 2), 3 * (block % 2));
    }
  }
  const auto count = static_cast<double>(states.size());
  for (Eigen::VectorXd* v : {&out->qdd, &out->of_qdd.by_inertia, &out->of_qdd.by_placement})
    *v = (*v / count).cwiseSqrt();
  for (JointDeviation& joint : out->joints) {
    for (double& square : joint.M_A) square = std::sqrt(square / count);
    for (double& square : joint.P) square = std::sqrt(square / count);
  }
}

UncertaintyResult propagate(const ParametersResult& result,
                            const std::vector<scene::State<double>>& states,
                            const std::vector<Eigen::MatrixXd>& Y) {
  const scene::Mechanism& mechanism = result.scene.mechanism;
  const ParametersOptions& options = result.options;
  UncertaintyResult out;
  out.given = readUncertainty(options.uncertainty);
  const Eigen::MatrixXd F = parameterFactor(mechanism, result.base.parameters, out.given);
  const Eigen::VectorXd pi = Eigen::Map<const Eigen::VectorXd>(
      result.values.data(), static_cast<Eigen::Index>(result.values.size()));
  const int n = mechanism.dof();
  out.by_inertia = out.by_geometry = out.tau = Eigen::VectorXd::Zero(n);
  for (std::size_t k = 0; k < states.size(); ++k) {
    out.tau += (Y[k] * pi).cwiseAbs2();
    out.by_inertia += (Y[k] * F).rowwise().squaredNorm();
    if (out.given.ofGeometry())
      out.by_geometry += placementEffect(mechanism, states[k], out.given).rowwise().squaredNorm();
  }
  for (Eigen::VectorXd* v : {&out.by_inertia, &out.by_geometry, &out.tau})
    *v = (*v / static_cast<double>(states.size())).cwiseSqrt();

  propagateMotion(result.scene, states, &out);
  out.follows = accelerationsFollowForces(result.scene, options.seed);

  // the same by drawing, at the first state
  const auto compare = [&](const Eigen::MatrixXd& effect, const Eigen::MatrixXd& sampled) {
    return compareCovariance(effect * effect.transpose(), sampled, options.samples, options.chance);
  };
  if (out.given.ofInertia())
    out.inertia =
        compare(Y[0] * F, sampledByInertia(mechanism, states[0], F, options.samples, options.seed));
  if (!out.given.ofGeometry()) return out;
  for (const double scale : {0.01, 0.1, 1.0, 3.0, 10.0, 30.0, 100.0}) {
    Uncertainty scaled = out.given;
    scaled.xyz *= scale;
    scaled.rpy *= scale;
    out.geometry.push_back({scale, compare(placementEffect(mechanism, states[0], scaled),
                                           sampledByGeometry(mechanism, states[0], scaled,
                                                             options.samples, options.seed))});
  }
  return out;
}

}  // namespace

double ParametersResult::baseValue(int row) const {
  double sum = values[base.independent[row]];
  for (const Coefficient& c : base.K)
    if (c.base == row) sum += c.value * values[c.parameter];
  return sum;
}

bool ParametersResult::agrees() const {
  if (energy_rank != base.count() || (closed_form && *closed_form != base.countWithoutRotors()))
    return false;
  if (!uncertainty) return true;
  return uncertainty->follows && (!uncertainty->inertia || uncertainty->inertia->agrees()) &&
         (uncertainty->geometry.empty() || uncertainty->geometry.front().check.agrees());
}

ParametersResult examineParameters(const scene::Scene& scene, const ParametersOptions& options) {
  requireMotion(scene);
  if (!options.uncertainty.empty()) readUncertainty(options.uncertainty);  // before the work
  const scene::Mechanism& mechanism = scene.mechanism;
  ParametersResult out;
  out.scene = scene;
  out.options = options;
  // shares as measured on a chain of 60 joints: two trials over the field, then balls, then the
  // energy
  scene::Work work("", 40);
  out.base = baseParameters(scene, options.seed, options.error_probability);
  out.values = recursive::inertialValues(mechanism, out.base.parameters,
                                         scene::RealNumbers<double>(mechanism));
  out.energy_rank = energyRank(scene, out.base, options.seed);
  out.closed_form = mayedaCount(mechanism);

  std::vector<scene::State<double>> states;
  std::vector<Eigen::MatrixXd> Y;
  Eigen::MatrixXd W(options.states * mechanism.dof(), out.base.count());
  for (int k = 0; k < options.states; ++k) {
    states.push_back(drawState(mechanism, scene.name, options.seed, k));
    Y.push_back(regressorAt(mechanism, out.base.parameters, states[k]));
    for (int c = 0; c < out.base.count(); ++c)
      W.col(c).segment(k * mechanism.dof(), mechanism.dof()) = Y[k].col(out.base.independent[c]);
  }
  out.condition = conditionOf(W);
  out.scaled_condition = conditionOf(W.colwise().normalized());
  if (!options.uncertainty.empty()) out.uncertainty = propagate(out, states, Y);
  return out;
}

}  // namespace dynwitness::crosscheck
