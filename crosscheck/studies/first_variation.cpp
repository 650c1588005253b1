// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/first_variation.hpp"

#include <cmath>

#include <boost/math/constants/constants.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/studies/dependent_rates.hpp"
#include "crosscheck/studies/near_motion.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck::hamilton {

namespace {

constexpr double kPi = boost::math::constants::pi<double>();
constexpr int kSines = 3;  // a joint, in a varied path

}  // namespace

double phaseOf(const Problem& problem, const Node& node, const std::vector<Node>& nodes) {
  return &node == &nodes.back() ? 0 : kPi * node.time / problem.duration;
}

double Sines::value(int i, double phase) const {
  double sum = 0;
  for (std::size_t m = 0; m < a[i].size(); ++m) sum += a[i][m] * std::sin((m + 1) * phase);
  return sum;
}

double Sines::rate(int i, double phase, double duration) const {
  double sum = 0;
  for (std::size_t m = 0; m < a[i].size(); ++m)
    sum += a[i][m] * (m + 1) * kPi / duration * std::cos((m + 1) * phase);
  return sum;
}

Sines variation(const scene::Scene& scene, int n, std::uint64_t seed, int index) {
  RandomStream random(scene.name + " variation", seed, index);
  Sines zeta;
  for (int i = 0; i < n; ++i) {
    zeta.a.emplace_back();
    for (int m = 0; m < kSines; ++m) zeta.a[i].push_back(random.uniform(-1, 1) / kSines);
  }
  return zeta;
}

FirstVariation firstVariation(const Problem& problem, const std::vector<Node>& nodes,
                              const Sines& zeta) {
  Near<D> near(problem);
  FirstVariation out;
  const int n = problem.n();
  for (const Node& node : nodes) {
    const double phase = phaseOf(problem, node, nodes);
    std::vector<D> z, z_rate;
    double forces = 0;
    for (int i = 0; i < n; ++i) {
      const double value = zeta.value(i, phase);
      const double rate = zeta.rate(i, kPi * node.time / problem.duration, problem.duration);
      z.push_back(D(0.0, value));
      z_rate.push_back(D(0.0, rate));
      forces += node.Q[i] * value;
    }
    near.at(node, z, z_rate);
    const double dL = near.lagrangian().derivative;
    out.action += node.weight * dL;
    out.with_forces += node.weight * (dL + forces);
    // W at all later times, integrated over them
    out.with_work += node.weight * (dL + (problem.duration - node.time) * near.power().derivative);
    out.size += node.weight * (std::abs(dL) + std::abs(forces));
  }
  return out;
}

double movedByRounding(const Problem& problem, const std::vector<Node>& nodes) {
  const int n = problem.dof();
  const recursive::Model<D> model = lifted<D>(problem.model);
  recursive::Workspace<D> ws(model);
  recursive::MatrixX<D> M(n, n);
  double sum = 0;
  for (const Node& node : nodes) {
    Eigen::VectorXd most = Eigen::VectorXd::Ones(n);
    if (problem.isClosed()) most = Dependence(problem, node.slots).along.cwiseAbs().rowwise().sum();
    for (std::size_t k = 0; k < node.slots.size(); ++k) {
      std::vector<D> slots(node.slots.begin(), node.slots.end());
      slots[k].derivative = node.slots[k];
      recursive::massMatrix(model, slotPositions(slots), ws, M);
      for (int i = 0; i < n; ++i) {
        double jump = 0;
        for (int j = 0; j < n; ++j) {
          jump += M(i, j).derivative * node.qd[j];
          if (k == 0) sum += most(i) * std::abs(M(i, j).value * node.qd[j]);
        }
        sum += most(i) * std::abs(jump);
      }
    }
  }
  return kRoundedByStep * sum;
}

}  // namespace dynwitness::crosscheck::hamilton
