// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/closed_states.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/QR>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/motion/closed_motion.hpp"
#include "crosscheck/motion/closure_gap.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/constrained_reactions.hpp"
#include "recursive/hybrid_dynamics.hpp"
#include "scene/mimic.hpp"
#include "scene/motion.hpp"

namespace dynwitness::crosscheck {
namespace {

using Long = long double;
using State = ClosedMotion::State;

}  // namespace

struct ClosedStates::Parts {
  explicit Parts(const PreparedScene& of)
      : prepared(of),
        motion(of.scene(), 0),
        gaps(of),
        number(of.mechanism()),
        model(recursive::buildModel(of.mechanism(), number)),
        ws(model),
        closures(recursive::buildConstraints(of.mechanism(), number, model)) {}

  const scene::Mechanism& mechanism() const { return prepared.mechanism(); }

  /// The start, moved by so much of what is drawn, its closures closed.
  State closed(RandomStream random, double amount, double time) {
    State y = motion.start(prepared.scene());
    motion.choose(y, 0);  // on the closures, where redundant equations can be told
    const std::vector<scene::SlotKind> slots = mechanism().slots();
    for (int i = 0; i < motion.positions(); ++i)
      if (slots[static_cast<std::size_t>(i)] != scene::SlotKind::kQuaternion)
        y[i] += amount * random.uniform(-1, 1);
      else
        y[i] += amount * random.uniform(-1, 1) / 4;
    if (mechanism().hasMimics()) {
      std::vector<double> q(y.begin(), y.begin() + motion.positions());
      scene::followLeaders(scene::followers(mechanism()), scene::RealNumbers<double>(mechanism()),
                           &q);
      std::copy(q.begin(), q.end(), y.begin());
    }
    for (int i = 0; i < motion.dof(); ++i) y[motion.positions() + i] = random.uniform(-3, 3);
    motion.impose(time, &y);
    motion.project(&y, time);
    motion.choose(y, time);
    motion.project(&y, time);
    refine(y);
    const std::vector<int> chosen = motion.chosen();
    motion.choose(y, time);
    arrived = motion.chosen() == chosen;  // if not, it went into a singular pose
    return y;
  }

  /// By reaction: whether redundant closures leave it determined.
  std::vector<char> determined(const scene::State<double>& state) const {
    const scene::RealNumbers<double> in_double(mechanism());
    recursive::MechanismOfJoints<double> of(mechanism(), in_double);
    return recursive::determinedReactions(mechanism(), in_double, state.x, state.qd,
                                          recursive::drivenRates(mechanism()), of);
  }

  void equations(const State& y) {
    x.clear();
    qd.clear();
    for (int i = 0; i < motion.positions(); ++i)
      x.push_back(scene::jointPosition(static_cast<Long>(y[i])));
    for (int i = 0; i < motion.dof(); ++i)
      qd.push_back(static_cast<Long>(y[motion.positions() + i]));
    recursive::constraintEquations(model, x, qd, ws, closures);
  }
  /// The shortest change of free rates by which the chosen equations change by -left.
  std::vector<Long> change(const recursive::VectorX<Long>& left) {
    const auto& rows = motion.chosen();
    const recursive::MatrixX<Long> J = closures.J(rows, motion.freeRates());
    const recursive::VectorX<Long> d =
        J.completeOrthogonalDecomposition().solve(recursive::VectorX<Long>(-left(rows)));
    std::vector<Long> all(static_cast<std::size_t>(motion.dof()), 0);
    for (Eigen::Index i = 0; i < d.size(); ++i)
      all[static_cast<std::size_t>(motion.freeRates()[static_cast<std::size_t>(i)])] = d(i);
    return all;
  }
  /// What is 0 but for rounding beside its likes: nothing that rounds to it closes a closure.
  static void snap(State::iterator from, State::iterator to, double size) {
    for (; from != to; ++from)
      if (std::abs(*from) <= std::numeric_limits<double>::epsilon() * size) *from = 0;
  }
  /// Until rounding to double changes nothing any more; twice is usual.
  void refine(State& y) {
    constexpr int kMostSteps = 5;
    std::vector<Long> rates(static_cast<std::size_t>(motion.positions()));
    for (int step = 0; step < kMostSteps; ++step) {
      equations(y);
      recursive::positionRates(model, x, change(closures.phi), rates);
      const State before = y;
      for (int i = 0; i < motion.positions(); ++i)
        y[i] = static_cast<double>(y[i] + rates[static_cast<std::size_t>(i)]);
      if (y == before) break;
    }
    const auto rate_begin = y.begin() + motion.positions(), rate_end = rate_begin + motion.dof();
    snap(y.begin(), rate_begin, 1);  // of angles, and of lengths in m
    for (int step = 0; step < kMostSteps; ++step) {
      equations(y);
      recursive::VectorX<Long> rate = recursive::VectorX<Long>::Zero(closures.rows());
      for (int i = 0; i < motion.dof(); ++i)
        rate += closures.J.col(i) * qd[static_cast<std::size_t>(i)];
      const std::vector<Long> d = change(rate);
      const State before = y;
      for (int i = 0; i < motion.dof(); ++i) {
        double& of = y[motion.positions() + i];
        of = static_cast<double>(of + d[static_cast<std::size_t>(i)]);
      }
      if (y == before) break;
    }
    double fastest = 0;
    for (auto rate = rate_begin; rate != rate_end; ++rate)
      fastest = std::max(fastest, std::abs(*rate));
    snap(rate_begin, rate_end, fastest);
  }

  PreparedScene prepared;
  ClosedMotion motion;
  ClosureGaps gaps;
  scene::RealNumbers<Long> number;
  recursive::Model<Long> model;
  recursive::Workspace<Long> ws;
  recursive::Constraints<Long> closures;
  std::vector<scene::JointPosition<Long>> x;
  std::vector<Long> qd;
  bool arrived = false;  ///< of the last closed()
};

ClosedStates::ClosedStates(const PreparedScene& scene) : parts_(std::make_unique<Parts>(scene)) {}
ClosedStates::~ClosedStates() = default;

ClosedState ClosedStates::draw(std::uint64_t seed, int index) {
  Parts& p = *parts_;
  const scene::Mechanism& mechanism = p.mechanism();
  ClosedState out;
  out.state.index = index;
  scene::State<double>& state = out.state.state;
  state = drawState(mechanism, p.prepared.scene().name, seed, static_cast<std::uint64_t>(index));
  const std::vector<const scene::Expression*> motions = mechanism.motions();
  for (std::size_t i = 0; i < motions.size(); ++i) {
    if (motions[i])
      state.tau[i] = 0;  // the drive's, which is asked
    else
      state.qdd[i] = 0;
  }
  if (mechanism.closures.empty()) return out;

  RandomStream random(p.prepared.scene().name, seed, static_cast<std::uint64_t>(index));
  const double time = mechanism.isDriven() ? random.uniform(0, 1) : 0;
  constexpr int kMostHalvings = 10;
  double amount = 1;
  for (int halving = 0; halving <= kMostHalvings; ++halving, amount /= 2) {
    const State y = p.closed(random, amount, time);
    for (int i = 0; i < p.motion.positions(); ++i) state.x[i] = scene::jointPosition(y[i]);
    state.qd.assign(y.begin() + p.motion.positions(),
                    y.begin() + p.motion.positions() + p.motion.dof());
    const bool is_number =
        std::all_of(y.begin(), y.end(), [](double v) { return std::isfinite(v); });
    if (!is_number || !p.arrived || p.gaps.at(state).is_open) continue;
    for (std::size_t i = 0; i < motions.size(); ++i)
      if (motions[i])
        state.qdd[i] =
            scene::motionAt(*motions[i], scene::RealNumbers<double>(mechanism), time).second;
    out.state.rows = p.motion.chosen();
    out.state.is_redundant = static_cast<int>(out.state.rows.size()) < p.motion.rows();
    if (out.state.is_redundant) out.state.determined = p.determined(state);
    return out;
  }
  out.failure = "no small change of the start closes the closures there";
  return out;
}

}  // namespace dynwitness::crosscheck
