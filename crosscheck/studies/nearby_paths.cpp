// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/nearby_paths.hpp"

#include <cmath>

#include <boost/math/constants/constants.hpp>

#include "crosscheck/studies/near_motion.hpp"

namespace dynwitness::crosscheck::hamilton {

namespace {

constexpr double kPi = boost::math::constants::pi<double>();

/// S of the path q + amplitude eta by Simpson's sums, whose panels end where eta is bent.
template <typename S>
S actionAlong(const Problem& problem, const std::vector<Node>& nodes, const Lines& eta,
              const S& amplitude) {
  const int n = problem.n(), last = static_cast<int>(nodes.size()) - 1, part = last / eta.parts();
  const double h = problem.duration / last;
  Near<S> near(problem);
  S sum = S(0);
  std::vector<S> z(n, S(0)), z_rate(n, S(0));
  for (int panel = 0; panel < last; panel += 2) {
    const std::size_t k = static_cast<std::size_t>(panel / part);
    const Eigen::VectorXd slope = (eta.at[k + 1] - eta.at[k]) / (h * part);
    for (int point = 0; point < 3; ++point) {
      const double from = static_cast<double>(panel + point) / part - static_cast<double>(k);
      for (int i = 0; i < n; ++i) {
        z[i] = amplitude * S((1 - from) * eta.at[k](i) + from * eta.at[k + 1](i));
        z_rate[i] = amplitude * S(slope(i));
      }
      near.at(nodes[static_cast<std::size_t>(panel + point)], z, z_rate);
      sum += S((point == 1 ? 4 : 1) * h / 3) * near.lagrangian();
    }
  }
  return sum;
}

}  // namespace

PathAction actionOf(const Problem& problem, const std::vector<Node>& nodes, const Sines* zeta,
                    double amplitude) {
  using Error = RunningError;
  Near<Error> near(problem);
  const int n = problem.n();
  PathAction S;
  std::vector<Error> z(n, Error(0)), z_rate(n, Error(0));
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Node& node = nodes[k];
    if (zeta != nullptr)
      for (int i = 0; i < n; ++i) {
        z[i] = amplitude * zeta->value(i, phaseOf(problem, node, nodes));
        z_rate[i] = amplitude * zeta->rate(i, kPi * node.time / problem.duration, problem.duration);
      }
    near.at(node, z, z_rate);
    const Error L = near.lagrangian();
    S.by_all += Error(node.weight) * L;
    // Simpson's weights of steps twice as long: 2 (1, 4, 2, 4, ..., 1)
    const bool is_end = k == 0 || k + 1 == nodes.size();
    if (k % 2 == 0) S.by_half += Error(node.weight * (is_end ? 2 : k % 4 == 2 ? 4 : 2)) * L;
  }
  return S;
}

Action::Path::Change changeOf(const Problem& problem, const std::vector<Node>& nodes,
                              const PathAction& own, const Sines& zeta, double first,
                              double amplitude) {
  const PathAction there = actionOf(problem, nodes, &zeta, amplitude),
                   half = actionOf(problem, nodes, &zeta, amplitude / 2);
  const RunningError change = there.by_all - own.by_all;
  const double longer = (there.by_half - own.by_half).value(),
               higher = change.value() - 4 * (half.by_all - own.by_all).value();
  return {change.value(), change.bound() + std::abs(change.value() - longer) +
                              amplitude * std::abs(first) + 2 * std::abs(higher)};
}

Action::Path::Change changeAlong(const Problem& problem, const std::vector<Node>& nodes,
                                 const std::vector<Node>& coarse, const Lines& eta,
                                 double amplitude, double* first) {
  const auto change = [&](const std::vector<Node>& by, double size) {
    return actionAlong<RunningError>(problem, by, eta, size) -
           actionAlong<RunningError>(problem, by, eta, 0.0);
  };
  *first = actionAlong<D>(problem, nodes, eta, D(0.0, 1.0)).derivative;
  const RunningError fine = change(nodes, amplitude), half = change(nodes, amplitude / 2);
  return {fine.value(), fine.bound() + std::abs(fine.value() - change(coarse, amplitude).value()) +
                            amplitude * std::abs(*first) +
                            2 * std::abs(fine.value() - 4 * half.value())};
}

}  // namespace dynwitness::crosscheck::hamilton
