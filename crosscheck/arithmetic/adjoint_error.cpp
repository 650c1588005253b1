// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/arithmetic/adjoint_error.hpp"

#include <algorithm>
#include <array>

namespace dynwitness::crosscheck {
namespace {

/// Derivatives of so many results are carried back at once.
constexpr int kTogether = 8;
using Block = std::array<double, kTogether>;

}  // namespace

template <typename Derivatives>
void AdjointTape::carryBack(std::vector<Derivatives>& derivative, int last, double Node::*error,
                            Derivatives& sum) const {
  for (int i = last; i >= 0; --i) {
    const Derivatives& d = derivative[i];
    double any = 0;
    for (int k = 0; k < kTogether; ++k) any += std::abs(d[k]);
    if (any == 0) continue;
    const Node& node = nodes_[i];
    for (int k = 0; k < kTogether; ++k) sum[k] += std::abs(d[k]) * node.*error;
    if (node.a >= 0)
      for (int k = 0; k < kTogether; ++k) derivative[node.a][k] += node.by_a * d[k];
    if (node.b >= 0)
      for (int k = 0; k < kTogether; ++k) derivative[node.b][k] += node.by_b * d[k];
  }
}

Eigen::MatrixXd AdjointTape::bounds(
    const Eigen::Matrix<AdjointError, Eigen::Dynamic, Eigen::Dynamic>& results) const {
  const Eigen::Index count = results.size();
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(results.rows(), results.cols());
  const double roundings = 2 * RunningError::kUnitRoundoff * static_cast<double>(nodes_.size());
  std::vector<Block> derivative(nodes_.size());
  for (Eigen::Index first = 0; first < count; first += kTogether) {
    const int here = static_cast<int>(std::min<Eigen::Index>(kTogether, count - first));
    std::fill(derivative.begin(), derivative.end(), Block{});
    int last = -1;
    for (int k = 0; k < here; ++k)
      if (const int node = results.data()[first + k].node(); node >= 0) {
        derivative[node][k] = 1;
        last = std::max(last, node);
      }
    Block sum{};
    carryBack(derivative, last, &Node::lost, sum);
    for (int k = 0; k < here; ++k) {
      const double running = results.data()[first + k].running().bound();
      const double weighed = sum[k] * (1 + roundings) + roundings * running;
      out.data()[first + k] = running == 0          ? 0
                              : std::isnan(weighed) ? running
                                                    : std::min(running, weighed);
    }
  }
  return out;
}

Eigen::VectorXd AdjointTape::firstOrder(
    const Eigen::MatrixXd& weights,
    const Eigen::Matrix<AdjointError, Eigen::Dynamic, Eigen::Dynamic>& results) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(weights.rows());
  std::vector<Block> derivative(nodes_.size());
  for (Eigen::Index first = 0; first < weights.rows(); first += kTogether) {
    const int here = static_cast<int>(std::min<Eigen::Index>(kTogether, weights.rows() - first));
    std::fill(derivative.begin(), derivative.end(), Block{});
    int last = -1;
    for (Eigen::Index j = 0; j < results.size(); ++j) {
      const int node = results.data()[j].node();
      if (node < 0) continue;
      for (int k = 0; k < here; ++k) derivative[node][k] += weights(first + k, j);
      last = std::max(last, node);
    }
    Block sum{};
    carryBack(derivative, last, &Node::own, sum);
    for (int k = 0; k < here; ++k) out(first + k) = sum[k];
  }
  return out;
}

scene::State<AdjointError> adjointState(const scene::State<RunningError>& state) {
  scene::State<AdjointError> out;
  for (const scene::JointPosition<RunningError>& x : state.x)
    out.x.push_back({AdjointError(x.q), AdjointError(x.c), AdjointError(x.s)});
  const auto put = [](const std::vector<RunningError>& from, std::vector<AdjointError>& to) {
    for (const RunningError& x : from) to.push_back(AdjointError(x));
  };
  put(state.qd, out.qd);
  put(state.qdd, out.qdd);
  put(state.tau, out.tau);
  return out;
}

}  // namespace dynwitness::crosscheck
