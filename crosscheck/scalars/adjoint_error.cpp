// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/adjoint_error.hpp"

#include <algorithm>
#include <array>

namespace dynwitness::crosscheck {
namespace {

/// Derivatives of so many results are carried back at once.
constexpr int kTogether = 8;
using Block = std::array<double, kTogether>;

}  // namespace

/// A block is kept from the first node that leads to its own until that is passed: few are alive
/// at a time, whatever the length of the tape, and these stay in the cache.
class AdjointTape::Derivatives {
 public:
  explicit Derivatives(std::size_t nodes) : place_(nodes, -1) {}

  bool reached(int node) const { return place_[node] >= 0; }
  Block& of(int node) {
    int& place = place_[node];
    if (place >= 0) return blocks_[place];
    if (free_.empty()) {
      place = static_cast<int>(blocks_.size());
      blocks_.emplace_back();
    } else {
      place = free_.back();
      free_.pop_back();
    }
    return blocks_[place] = Block{};
  }
  /// Of a node that is passed: nothing is added to it any more.
  Block taken(int node) {
    free_.push_back(place_[node]);
    place_[node] = -1;
    return blocks_[free_.back()];
  }

 private:
  std::vector<int> place_;  ///< by node, in blocks_
  std::vector<Block> blocks_;
  std::vector<int> free_;
};

void AdjointTape::carryBack(Derivatives& derivatives, int last, double Node::*error,
                            double* sum) const {
  for (int i = last; i >= 0; --i) {
    if (!derivatives.reached(i)) continue;
    const Block d = derivatives.taken(i);
    const Node& node = nodes_[i];
    for (int k = 0; k < kTogether; ++k) sum[k] += std::abs(d[k]) * node.*error;
    const auto pass = [&](int to, double by) {
      if (to < 0) return;
      Block& sums = derivatives.of(to);
      for (int k = 0; k < kTogether; ++k) sums[k] += by * d[k];
    };
    pass(node.a, node.by_a);
    pass(node.b, node.by_b);
  }
}

Eigen::MatrixXd AdjointTape::bounds(
    const Eigen::Matrix<AdjointError, Eigen::Dynamic, Eigen::Dynamic>& results) const {
  const Eigen::Index count = results.size();
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(results.rows(), results.cols());
  const double roundings = 2 * RunningError::kUnitRoundoff * static_cast<double>(nodes_.size());
  Derivatives derivatives(nodes_.size());
  for (Eigen::Index first = 0; first < count; first += kTogether) {
    const int here = static_cast<int>(std::min<Eigen::Index>(kTogether, count - first));
    int last = -1;
    for (int k = 0; k < here; ++k)
      if (const int node = results.data()[first + k].node(); node >= 0) {
        derivatives.of(node)[k] = 1;
        last = std::max(last, node);
      }
    Block sum{};
    carryBack(derivatives, last, &Node::lost, sum.data());
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
  Derivatives derivatives(nodes_.size());
  for (Eigen::Index first = 0; first < weights.rows(); first += kTogether) {
    const int here = static_cast<int>(std::min<Eigen::Index>(kTogether, weights.rows() - first));
    int last = -1;
    for (Eigen::Index j = 0; j < results.size(); ++j) {
      const int node = results.data()[j].node();
      if (node < 0) continue;
      for (int k = 0; k < here; ++k) derivatives.of(node)[k] += weights(first + k, j);
      last = std::max(last, node);
    }
    Block sum{};
    carryBack(derivatives, last, &Node::own, sum.data());
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
