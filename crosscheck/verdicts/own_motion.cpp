// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/own_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/state_gap.hpp"
#include "crosscheck/motion/tree_motion.hpp"
#include "crosscheck/witnesses/engine_bound.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"

namespace dynwitness::crosscheck {
namespace {

using Real = long double;

std::vector<Real> stateOf(const OwnMotion::Moment& moment) {
  std::vector<Real> y(moment.q.begin(), moment.q.end());
  y.insert(y.end(), moment.qd.begin(), moment.qd.end());
  y.push_back(0);
  return y;
}

constexpr int kMostParts = 4096;

/// Our equations from one moment to the next, in parts as short as the error allows. Nothing: with
/// kMostParts the ends still differ, or none is finite.
std::optional<std::vector<Real>> advanced(TreeMotion<Real>& motion, const std::vector<Real>& from,
                                          Real duration) {
  const auto isFinite = [](Real x) { return std::isfinite(x); };
  if (!std::all_of(from.begin(), from.end(), isFinite)) return std::nullopt;
  std::vector<Real> before;
  for (int parts = 1; parts <= kMostParts; parts *= 2) {
    std::vector<Real> y = from;
    const auto steps = stepsOf<Real>("runge_kutta_fehlberg78", motion);
    for (int k = 0; k < parts; ++k) steps->step(&y, 0, duration / parts);
    if (!before.empty()) {
      Real change = 0;
      for (std::size_t i = 0; i < y.size(); ++i)
        keepWorse(&change, std::abs(y[i] - before[i]) / (1 + std::abs(y[i])));
      // below what the moments themselves are rounded by; NaN is not
      if (change <= std::numeric_limits<double>::epsilon() / 2) return y;
    }
    before = y;
  }
  return std::nullopt;
}

/// What an engine's qdd may leave by its own account, with what it is known to lose [n]; empty: it
/// has none.
Eigen::MatrixXd ownBound(Witness* by, const scene::State<double>& state) {
  return by == nullptr ? Eigen::MatrixXd() : by->answer(Quantity::kQdd, state).residual_bound;
}

}  // namespace

OwnMotionVerdict judgeOwnMotion(const scene::Scene& scene, const OwnMotion& motion, Witness* by) {
  requireTreated(scene, Command::kDrift);
  if (scene.mechanism.hasFriction())
    throw scene::InputError({scene.file.string(), 0},
                            "friction, allowed: a scene without, whose energy is constant");
  const PreparedScene prepared(scene);
  TreeMotion<Real> ours(scene.mechanism);
  EngineBound bound(prepared);
  SolveBound solve_bound(prepared, SolvedBy::kMassMatrix, kEngineTurns);
  OwnMotionVerdict out;
  out.by = motion.by;
  Real E_0 = 0, most_kinetic = 0, most_change = 0;
  for (std::size_t k = 0; k < motion.moments.size(); ++k) {
    const OwnMotion::Moment& moment = motion.moments[k];
    if (static_cast<int>(moment.q.size()) != ours.positions() ||
        static_cast<int>(moment.qd.size()) != ours.dof() ||
        static_cast<int>(moment.qdd.size()) != ours.dof())
      throw scene::InputError(
          {}, fmt::format("moment {} has {} positions, {} rates and {} accelerations, allowed: {}, "
                          "{} and {}",
                          k, moment.q.size(), moment.qd.size(), moment.qdd.size(), ours.positions(),
                          ours.dof(), ours.dof()));
    const std::vector<Real> y = stateOf(moment);
    const auto residual = ours.residual(y, {moment.qdd.begin(), moment.qdd.end()});
    scene::State<double> state;
    for (const double q : moment.q) state.x.push_back(scene::jointPosition(q));
    state.qd = moment.qd;
    state.qdd = moment.qdd;
    state.tau.assign(moment.qd.size(), 0.0);
    Eigen::VectorXd qdd = Eigen::Map<const Eigen::VectorXd>(
        moment.qdd.data(), static_cast<Eigen::Index>(moment.qdd.size()));
    Eigen::MatrixXd limits = ownBound(by, state);
    if (limits.size() == 0) limits = bound(Quantity::kTau, state) + solve_bound(state, qdd);
    for (Eigen::Index i = 0; i < qdd.size(); ++i) {
      const double left = std::abs(static_cast<double>(residual[static_cast<std::size_t>(i)])),
                   ratio = left == 0 ? 0 : left / limits(i, 0);
      if (!keepWorse(&out.ratio, ratio)) continue;
      out.residual = left;
      out.residual_time = moment.time;
      out.residual_joint = static_cast<int>(i);
    }
    const Real E = ours.energy(y);
    if (k == 0) E_0 = E;
    keepWorse(&most_kinetic, ours.kinetic(y));
    keepWorse(&most_change, std::abs(E - E_0));
    out.time.push_back(moment.time);
    out.energy_change.push_back(static_cast<double>(std::abs(E - E_0)));
    if (k == 0) continue;
    const OwnMotion::Moment& before = motion.moments[k - 1];
    const Real duration = Real(moment.time) - Real(before.time);
    if (!(duration > 0))
      throw scene::InputError({},
                              fmt::format("moment {} is at t = {} s, after {} s, allowed: times "
                                          "that rise",
                                          k, moment.time, before.time));
    const auto end = advanced(ours, stateOf(before), duration);
    if (!end) {
      if (!out.unanswered.empty() && out.unanswered.back().second == before.time)
        out.unanswered.back().second = moment.time;
      else
        out.unanswered.emplace_back(before.time, moment.time);
      continue;
    }
    ++out.answered;
    // a quaternion's length and sign say nothing of where a link is
    const std::vector<Real> there = placed(scene.mechanism, *end),
                            here = placed(scene.mechanism, y, there);
    const Real apart = largestGap(there, here, there.size());
    if (keepWorse(&out.step_error, static_cast<double>(apart / duration)))
      out.step_time = moment.time;
  }
  out.most_kinetic = static_cast<double>(most_kinetic);
  out.energy_error =
      static_cast<double>(most_kinetic > 0 ? most_change / most_kinetic : most_change);
  return out;
}

std::string ownMotionTable(const scene::Scene& scene,
                           const std::vector<OwnMotionVerdict>& verdicts) {
  const std::vector<std::string> joints = scene.mechanism.rateLabels();
  std::string text = fmt::format(
      "# {}: motions of others. Wrong model: what their accelerations leave of our equations at "
      "their own states [N, N m], over what rounding may leave.\n# Wrong step: how far a second of it "
      "is from our solution from their states [rad, m, rad/s, m/s], and how far our T + V moves along "
      "it, over the largest kinetic energy; a wrong model moves both, too.\n"
      "{:<48} {:<34} {:>12} {:>12}\n",
      scene.name, "motion", "wrong model", "step error/s", "energy error");
  for (const OwnMotionVerdict& v : verdicts) {
    text += fmt::format(
        "{:<48} {:<34} {:>12} {:>12.2g}\n", v.by,
        v.isModelWrong() ? fmt::format("YES: {:.2g} at {}, {:.2g} x limit", v.residual,
                                       joints[static_cast<std::size_t>(v.residual_joint)], v.ratio)
                         : fmt::format("no: {:.2g} of the limit", v.ratio),
        v.answered > 0 ? fmt::format("{:.2g}", v.step_error) : "none", v.energy_error);
    for (const auto& [from, to] : v.unanswered)
      text += fmt::format(
          "# {}: step error from t = {} to {} s: not answerable: our own solution does not settle "
          "in {} parts between moments\n",
          v.by, from, to, kMostParts);
  }
  return text;
}

}  // namespace dynwitness::crosscheck
