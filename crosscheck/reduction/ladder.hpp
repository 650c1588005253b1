// SPDX-License-Identifier: GPL-3.0-or-later
// From point masses to the whole scene, rung by rung: what each adds, what it costs, and what a
// model without it gets wrong in the scene's own motion.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// Where a rung's joint forces are furthest from those of another one, along the scene's motion.
struct ForceGap {
  double share = 0;  ///< of that joint's largest force (Ladder::largest)
  double force = 0;  ///< [N m, N]
  double time = 0;   ///< [s]
  int joint = -1;    ///< index of the rate; -1: nowhere
};

/// How far the motion of a rung, from the same start, is from the scene's.
struct RungMotion {
  double gap = 0;        ///< largest difference of a position [rad, m, 1 of quaternions]
  double time = 0;       ///< there [s]
  int position = -1;     ///< which; -1: nowhere
  double follows_s = 0;  ///< so long every position stays within Ladder::kFollows of its travel
};

struct Rung {
  std::string adds;    ///< "moments of inertia", to the rung below
  scene::Scene scene;  ///< of all rungs so far
  /// Multiplications, additions and divisions of tau, friction apart; of the smallest straight
  /// line, or of the general sweep where that is too long; none: `no_count` says why.
  std::optional<long> operations;
  bool is_straight_line = false;
  std::string no_count;
  ForceGap above, full;              ///< to the next richer rung, and to the scene
  std::optional<RungMotion> motion;  ///< none: `no_motion` says why
  std::string no_motion;
};

struct Ladder {
  /// A motion follows another one while no position is off by more than this share of the way
  /// between the least and the largest value that it takes in the scene's motion.
  static constexpr double kFollows = 0.01;

  double duration = 0;  ///< [s]
  std::vector<double>
      largest;              ///< by joint: of M qdd, c, g with springs, friction with loads [N m, N]
  std::vector<Rung> rungs;  ///< the poorest first; the last is the scene
  std::vector<std::string> absent;  ///< what would be rungs, and this scene has not
};

struct LadderOptions {
  double duration = 10;  ///< [s]
  int outputs = 200;     ///< equal intervals, at whose ends rungs are compared
};

/** The ladder of a scene, along the motion that simulate() makes of it from its start.

    Rungs, poorest first: point masses at the centres of mass; their moments of inertia about these,
    in the axes that the file gives; products of inertia; rotors, n^2 J each; the spin of gyroscopic
    ones that their carriers feel; friction. Gravity, springs, loads, closures, drives and
    constraints are in all of them: they are what moves the scene, or where it may move. Forces are
    those of the tree, tau = M qdd + c + g + friction - Q at the scene's own q, qd, qdd.
    @param at  called with words for what is being done
    @throws scene::InputError  nothing moves; what simulate() throws of the scene itself */
Ladder ladderOf(const scene::Scene& scene, const LadderOptions& options,
                const std::function<void(const std::string&)>& at);

/// For people; programs (crosscheck/reduction/need.schema.json); gnuplot.
std::string ladderText(const scene::Scene& scene, const Ladder& ladder);
std::string ladderJson(const scene::Scene& scene, const Ladder& ladder,
                       const LadderOptions& options, const std::string& version);
/// `rung,operations,error_above,error_full`, errors as shares
std::string ladderCsv(const Ladder& ladder);

}  // namespace dynwitness::crosscheck
