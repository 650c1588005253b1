// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/ladder.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/kernel/general_cost.hpp"
#include "crosscheck/kernel/roads.hpp"
#include "crosscheck/motion/simulate.hpp"
#include "crosscheck/reduction/omissions.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using kernel::Formula;
using scene::Mechanism;

/// What the rungs above the point masses add, the first first.
struct Addition {
  Omission::What what;
  const char* words;
};
constexpr Addition kAdditions[] = {
    {Omission::What::kInertia, "moments of inertia"},
    {Omission::What::kProducts, "products of inertia"},
    {Omission::What::kRotor, "rotors"},
    {Omission::What::kSpin, "spin of gyroscopic rotors"},
    {Omission::What::kFriction, "friction"},
};

/// Takes it from all links. @return whether any had it
bool takeFromAll(Omission::What what, Mechanism* mechanism) {
  bool any = false;
  for (std::size_t l = 1; l < mechanism->links.size(); ++l)
    any = apply({l, what}, mechanism) || any;
  return any;
}

/// The scenes of the rungs, poorest first, and what the scene has not.
void makeRungs(const scene::Scene& scene, Ladder* ladder) {
  scene::Scene richest = scene;
  std::vector<Rung> downwards;
  for (auto addition = std::rbegin(kAdditions); addition != std::rend(kAdditions); ++addition) {
    scene::Scene poorer = richest;
    if (!takeFromAll(addition->what, &poorer.mechanism)) {
      ladder->absent.insert(ladder->absent.begin(), addition->words);
      continue;
    }
    Rung rung;
    rung.adds = addition->words;
    rung.scene = std::exchange(richest, std::move(poorer));
    downwards.push_back(std::move(rung));
  }
  Rung lowest;
  lowest.adds = "point masses";
  lowest.scene = std::move(richest);
  downwards.push_back(std::move(lowest));
  ladder->rungs.assign(std::make_move_iterator(downwards.rbegin()),
                       std::make_move_iterator(downwards.rend()));
}

/// Of the tree: a program has no sign for friction, and closures are no part of tau.
void count(Rung* rung) {
  Mechanism tree = rung->scene.mechanism;
  tree.closures.clear();
  tree.springs.clear();
  takeFromAll(Omission::What::kFriction, &tree);
  try {
    rung->operations = kernel::smallestRoad(tree, Formula::kInverseDynamics).operations();
    rung->is_straight_line = true;
  } catch (const kernel::NotUsed&) {
    rung->operations = kernel::generalOperations(tree, Formula::kInverseDynamics);
  } catch (const std::exception& error) {
    rung->no_count = error.what();
  }
}

using Rows = std::vector<std::vector<double>>;  // one a time

/// tau along a motion, by the recursive sweeps.
class ForcesAlong {
 public:
  explicit ForcesAlong(const Simulation& motion) : motion_(motion) {}

  Rows operator()(const Mechanism& mechanism) const {
    return of(mechanism, {recursive::Terms::all(), true, true});
  }
  /// By joint, the largest of M qdd, c, g with springs, and what friction and loads take.
  std::vector<double> largest(const Mechanism& mechanism) const {
    const Rows all = (*this)(mechanism),
               inertial = of(mechanism, {recursive::Terms::none(), false, true}),
               centrifugal = of(mechanism, {recursive::Terms::none(), true, false}),
               potential = of(mechanism, {recursive::Terms::potential(), false, false});
    std::vector<double> out(static_cast<std::size_t>(mechanism.dof()));
    for (std::size_t t = 0; t < all.size(); ++t)
      for (std::size_t i = 0; i < out.size(); ++i) {
        const double rest = all[t][i] - inertial[t][i] - centrifugal[t][i] - potential[t][i];
        for (const double part : {inertial[t][i], centrifugal[t][i], potential[t][i], rest})
          out[i] = std::max(out[i], std::abs(part));
      }
    return out;
  }

 private:
  struct Part {
    recursive::Terms terms;
    bool moves, accelerates;
  };

  Rows of(const Mechanism& mechanism, const Part& part) const {
    const auto model = recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism));
    recursive::Workspace<double> ws(model);
    const std::vector<double> none(static_cast<std::size_t>(model.dof()), 0.0);
    Rows rows;
    for (const Simulation::Point& point : motion_.points) {
      std::vector<scene::JointPosition<double>> x;
      for (const double q : point.q) x.push_back(scene::jointPosition(q));
      std::vector<double> tau(none.size());
      recursive::inverseDynamics(model, x, part.moves ? point.qd : none,
                                 part.accelerates ? point.qdd : none, ws, tau, part.terms);
      rows.push_back(std::move(tau));
    }
    return rows;
  }

  const Simulation& motion_;
};

ForceGap gapOf(const Rows& a, const Rows& b, const std::vector<double>& largest,
               const Simulation& motion) {
  ForceGap worst;
  for (std::size_t t = 0; t < a.size(); ++t)
    for (std::size_t i = 0; i < largest.size(); ++i) {
      const double force = std::abs(a[t][i] - b[t][i]);
      if (force == 0) continue;
      const double share = force / largest[i];
      if (share > worst.share) worst = {share, force, motion.points[t].time, static_cast<int>(i)};
    }
  return worst;
}

/// The way of each position between its least and its largest value.
std::vector<double> travels(const Simulation& motion) {
  std::vector<double> low = motion.points.front().q, high = low;
  for (const Simulation::Point& point : motion.points)
    for (std::size_t k = 0; k < low.size(); ++k) {
      low[k] = std::min(low[k], point.q[k]);
      high[k] = std::max(high[k], point.q[k]);
    }
  for (std::size_t k = 0; k < low.size(); ++k) high[k] -= low[k];
  return high;
}

RungMotion motionGap(const Simulation& rung, const Simulation& full) {
  const std::vector<double> travel = travels(full);
  RungMotion out;
  bool follows = true;
  for (std::size_t t = 0; t < full.points.size(); ++t) {
    for (std::size_t k = 0; k < travel.size(); ++k) {
      const double gap = std::abs(rung.points[t].q[k] - full.points[t].q[k]);
      follows = follows && gap <= Ladder::kFollows * travel[k];
      if (gap > out.gap) {
        out.gap = gap;
        out.time = full.points[t].time;
        out.position = static_cast<int>(k);
      }
    }
    if (follows) out.follows_s = full.points[t].time;
  }
  return out;
}

void move(const SimulateOptions& options, const Simulation& full, Rung* rung) {
  try {
    scene::validate(rung->scene);
    rung->motion = motionGap(simulate(rung->scene, options), full);
  } catch (const std::exception& error) {  // M is singular, or becomes so on the way
    rung->no_motion = error.what();
  }
}

}  // namespace

Ladder ladderOf(const scene::Scene& scene, const LadderOptions& options,
                const std::function<void(const std::string&)>& at) {
  Ladder ladder;
  ladder.duration = options.duration;
  makeRungs(scene, &ladder);
  std::vector<Rung>& rungs = ladder.rungs;
  const std::size_t last = rungs.size() - 1;
  scene::Work work("ladder", 1);
  SimulateOptions run;
  run.duration = options.duration;
  run.outputs = options.outputs;
  std::size_t done = 0;
  run.progress = [&](double time) {
    work.doneTo((static_cast<double>(done) + time / options.duration) /
                static_cast<double>(rungs.size()));
  };

  at("the scene's motion");
  const Simulation motion = simulate(scene, run);
  ++done;
  const ForcesAlong forces(motion);
  ladder.largest = forces.largest(scene.mechanism);
  const Rows of_scene = forces(scene.mechanism);
  Rows above = of_scene;
  for (std::size_t r = rungs.size(); r-- > 0;) {
    at(rungs[r].adds);
    count(&rungs[r]);
    if (r == last) {
      rungs[r].motion = RungMotion{0, 0, -1, options.duration};
      continue;
    }
    Rows own = forces(rungs[r].scene.mechanism);
    rungs[r].above = gapOf(own, above, ladder.largest, motion);
    rungs[r].full = gapOf(own, of_scene, ladder.largest, motion);
    move(run, motion, &rungs[r]);
    above = std::move(own);
    ++done;
  }
  return ladder;
}

}  // namespace dynwitness::crosscheck
