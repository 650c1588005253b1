// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/hamilton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "crosscheck/studies/action_verdicts.hpp"
#include "crosscheck/studies/first_variation.hpp"
#include "crosscheck/studies/jacobi_fields.hpp"
#include "crosscheck/studies/motion_nodes.hpp"
#include "crosscheck/studies/nearby_paths.hpp"
#include "crosscheck/studies/order_of_steps.hpp"

namespace dynwitness::crosscheck {
namespace hamilton {
namespace {

constexpr int kHalfWaves = 8;  // of a path that raises the action, a quarter of them

/// Largest magnitude of a member.
double largest(const std::vector<FirstVariation>& all, double FirstVariation::*member) {
  double most = 0;
  for (const FirstVariation& one : all) most = std::max(most, std::abs(one.*member));
  return most;
}

/// A motion by ever more steps, until what must vanish on it is seen to vanish.
class Refinement {
 public:
  Refinement(const Problem& problem, const std::vector<Sines>& variations,
             const ActionOptions& options, scene::Work& work)
      : problem(problem), variations_(variations), options_(options), work_(work) {}

  /// Twice the steps. Where they leave the numbers all begins anew: finer ones may do.
  void follow(int count);
  /// Whether more steps would say nothing new.
  bool tells() const {
    return sharp && !checks.empty() &&
           std::all_of(checks.begin(), checks.end(),
                       [](const CheckResult& c) { return c.verdict == Verdict::kAgree; });
  }

  const Problem& problem;
  int steps = 0;
  std::vector<Node> nodes;
  std::vector<FirstVariation> fine, coarse;  ///< one a variation, by these steps and half of them
  std::vector<CheckResult> checks;           ///< none before two sizes of steps end
  std::vector<Action::Conjugate> conjugates;
  bool sharp = false;  ///< conjugate times are the same at both

 private:
  CheckResult hamilton() const;
  CheckResult late() const;
  CheckResult symmetric() const;
  void compareConjugates();

  const std::vector<Sines>& variations_;
  const ActionOptions& options_;
  scene::Work& work_;
  JacobiFields fields_, fields_coarse_;
  std::vector<StepResidual> seen_hamilton_, seen_late_, seen_symmetric_;
};

void Refinement::follow(int count) {
  nodes = motionOf(problem, count);
  if (!isFinite(nodes.back().slots, nodes.back().qd)) {
    fine.clear();
    checks.clear();
    for (auto* seen : {&seen_hamilton_, &seen_late_, &seen_symmetric_}) seen->clear();
    return;
  }
  steps = count;
  coarse = std::move(fine);
  fine.clear();
  for (const Sines& zeta : variations_) fine.push_back(firstVariation(problem, nodes, zeta));
  seen_hamilton_.emplace_back();
  for (const FirstVariation& one : fine) seen_hamilton_.back().add(one.with_forces, true);
  seen_hamilton_.back().terms = largest(fine, &FirstVariation::size);
  if (problem.conservative) {
    fields_coarse_ = std::move(fields_);
    fields_ = jacobiFields(problem, steps, work_);
    seen_late_.push_back(fields_.late);
    seen_symmetric_.push_back(fields_.unsymmetric);
  }
  if (coarse.empty()) return;
  checks = {hamilton()};
  if (problem.conservative) {
    checks.push_back(late());
    // one alone is symmetric by itself
    if (problem.coordinates && problem.n() > 1) checks.push_back(symmetric());
  }
  compareConjugates();
}

CheckResult Refinement::hamilton() const {
  CheckResult check =
      problem.conservative
          ? describe("Hamilton's principle", "dS(eta) = 0 for every eta that vanishes at both ends",
                     "dS", "T - V")
          : describe("d'Alembert's and Lagrange's principle",
                     "dS(eta) + integral of Q' eta = 0 for every eta that vanishes at both ends",
                     "dS", "T - V, Q");
  check.right = "articulated_body";
  check.seed = options_.seed;
  check.states = options_.paths;
  judgeOrder(
      &check, seen_hamilton_, seen_hamilton_.back().terms,
      [&] { return movedByRounding(problem, nodes); }, steps);
  return check;
}

CheckResult Refinement::late() const {
  CheckResult check =
      describe("a motion and the same a little later are neighbours",
               "(qd, qdd) solves the variational equation", "J", "articulated_body");
  judgeOrder(
      &check, seen_late_, fields_.size_late + fields_.growth, [] { return 0.0; }, steps);
  return check;
}

CheckResult Refinement::symmetric() const {
  CheckResult check = describe("neighbours of one place stay Lagrangian",
                               "A'P = P'A, P the momenta of A", "J", "articulated_body");
  check.right = "composite_body";
  const auto moved = [&] {
    double most = 0;
    for (const auto& now : fields_.shared) most = std::max(most, movedByRounding(problem, now));
    return most * steps;
  };
  judgeOrder(&check, seen_symmetric_, fields_.unsymmetric.terms, moved, steps);
  return check;
}

void Refinement::compareConjugates() {
  conjugates = fields_.conjugates;
  sharp = conjugates.size() == fields_coarse_.conjugates.size();
  for (std::size_t k = 0; k < conjugates.size(); ++k) {
    conjugates[k].error = sharp ? std::abs(conjugates[k].time - fields_coarse_.conjugates[k].time)
                                : std::numeric_limits<double>::infinity();
    sharp = sharp && conjugates[k].error <= options_.duration / kSharp;
  }
}

/** S(q + zeta) - S(q) of a path that is to decide, by twice the steps and half the amplitude until
    it does: dS, which is 0 but for the steps, falls with their order, higher variations with the
    amplitude. */
void decide(const Refinement& motion, const Sines& zeta, Action::Path* path) {
  std::vector<Node> nodes = motion.nodes;
  for (int steps = motion.steps;; steps *= 2, path->amplitude /= 2) {
    if (steps > motion.steps) nodes = motionOf(motion.problem, steps);
    path->first = firstVariation(motion.problem, nodes, zeta).with_forces;
    const PathAction own = actionOf(motion.problem, nodes, nullptr, 0);
    path->put(changeOf(motion.problem, nodes, own, zeta, path->first, path->amplitude));
    if (path->isSure() || 2 * steps > kMostSteps) return;
  }
}
/// The same of lines, which begin with the steps that they are made of.
void decide(const Refinement& motion, const Lines& eta, Action::Path* path) {
  std::vector<Node> coarse = motionOf(motion.problem, 2 * eta.parts());
  for (int steps = 4 * eta.parts();; steps *= 2, path->amplitude /= 2) {
    std::vector<Node> nodes = motionOf(motion.problem, steps);
    path->put(changeAlong(motion.problem, nodes, coarse, eta, path->amplitude, &path->first));
    if (path->isSure() || steps > kMostSteps) return;
    coarse = std::move(nodes);
  }
}

/// S, S of paths near by, and whether they are as the second variation says of all of them.
void showPaths(const Refinement& motion, const std::vector<Sines>& variations, const Lines& slowest,
               Action* out) {
  using Kind = Action::Path::Kind;
  const Problem& problem = motion.problem;
  const PathAction own = actionOf(problem, motion.nodes, nullptr, 0);
  out->action = own.by_all.value();
  for (std::size_t k = 0; k < variations.size(); ++k) {
    Action::Path path{Kind::kDrawn, fmt::format("path {}", k + 1), kAmplitude,
                      motion.fine[k].with_forces};
    path.put(changeOf(problem, motion.nodes, own, variations[k], path.first, kAmplitude));
    out->paths.push_back(path);
  }
  if (!problem.conservative || out->negative < 0) return;
  CheckResult nearby =
      out->negative == 0
          ? describe("the action is smallest", "S(q + eta) > S(q)", "S", "T - V")
          : describe("the action is a saddle", "S(q + slow) < S(q) < S(q + fast)", "S", "T - V");
  nearby.unit = Unit::kPaths;
  nearby.limit = 0;
  if (out->negative > 0) {
    Sines fast;  // more half waves than directions that lower
    fast.a.assign(problem.n(), Values(4 * std::max(kHalfWaves, out->negative), 0.0));
    fast.a.back().back() = 1;
    out->paths.push_back({Kind::kSlowest, "slow", kAmplitude});
    decide(motion, slowest, &out->paths.back());
    out->paths.push_back({Kind::kFast, "fast", kAmplitude});
    decide(motion, fast, &out->paths.back());
  }
  judgePaths(out->paths, out->negative, &nearby);
  out->checks.push_back(nearby);
}

}  // namespace
}  // namespace hamilton

Action measureAction(const scene::Scene& scene, const ActionOptions& options) {
  using namespace hamilton;
  const Problem problem = problemOf(scene, options);
  std::vector<Sines> variations;
  for (int k = 0; k < options.paths; ++k)
    variations.push_back(variation(scene, problem.n(), options.seed, k));
  requireMotionAtStart(problem);
  scene::Work work("neighbouring motions, with twice the steps until they tell", 1);
  Refinement motion(problem, variations, options, work);
  for (int steps = kFirstSteps; steps <= kMostSteps && !motion.tells(); steps *= 2)
    motion.follow(steps);
  if (motion.checks.empty()) refuseUnresolved(problem);

  Action out;
  out.dof = problem.n();
  out.duration = options.duration;
  out.conservative = problem.conservative;
  out.steps = motion.steps;
  out.checks = motion.checks;
  out.conjugates = motion.conjugates;
  if (!problem.conservative) {
    out.with_work = largest(motion.fine, &FirstVariation::with_work);
    out.with_work_coarse = largest(motion.coarse, &FirstVariation::with_work);
  }
  Lines slowest;
  if (problem.conservative) {
    countDirections(problem, motion.nodes, motion.sharp, &out, &slowest);
    out.energy_drift = energyDrift(problem, motion.nodes);
  }
  showPaths(motion, variations, slowest, &out);
  judgePlaces(motion.nodes, &out);
  return out;
}

}  // namespace dynwitness::crosscheck
