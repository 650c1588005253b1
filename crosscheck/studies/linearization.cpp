// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/linearization.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/QR>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/studies/bounded_balls.hpp"
#include "crosscheck/studies/constrained_linearization.hpp"
#include "crosscheck/studies/given_values.hpp"
#include "crosscheck/studies/linearization_model.hpp"

namespace dynwitness::crosscheck {
namespace {

using Balls = recursive::MatrixX<Ball>;

constexpr long kMostBits = 4096;

Bounded rounded(const std::vector<Ball>& v) {
  Balls column(static_cast<Eigen::Index>(v.size()), 1);
  for (std::size_t i = 0; i < v.size(); ++i) column(static_cast<Eigen::Index>(i), 0) = v[i];
  return boundedBalls(column);
}

scene::State<Ball> stateAt(const scene::Mechanism& mechanism, const std::vector<double>& q,
                           const std::vector<double>& qd) {
  scene::State<double> state;
  for (const double x : q) state.x.push_back(scene::jointPosition(x));
  state.qd = qd;
  state.qdd.assign(qd.size(), 0.0);
  state.tau = state.qdd;
  return ballState(state, mechanism);
}

/// q moved by rates' worth of dq.
std::vector<double> moved(const recursive::Model<double>& model, std::vector<double> q,
                          const Eigen::VectorXd& dq) {
  std::vector<scene::JointPosition<double>> x;
  for (const double value : q) x.push_back(scene::jointPosition(value));
  std::vector<double> slots(q.size(), 0.0);
  recursive::positionRates(model, x, std::vector<double>(dq.data(), dq.data() + dq.size()), slots);
  for (std::size_t i = 0; i < q.size(); ++i) q[i] += slots[i];
  return q;
}

/** Newton's steps from a guess, of least length where dg/dq is singular, halved while they do not
    bring g down. What is left must be what rounding q to double leaves: half an ulp of q through
    dg/dq, twice that because the last step is rounded as well. */
class Equilibrium {
 public:
  Equilibrium(const scene::Scene& scene, LinearizationModel<Ball>& model)
      : scene_(scene),
        balls_(model),
        model_(
            recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism))) {}

  int steps() const { return steps_; }
  std::vector<double> from(std::vector<double> q) {
    constexpr int kMost = 100, kHalvings = 30;
    weigh(q);
    for (; steps_ < kMost; ++steps_) {
      if ((g_.cwiseAbs().array() <= left(q).array()).all()) return q;
      const Eigen::VectorXd step = -Eigen::MatrixXd(K_).completeOrthogonalDecomposition().solve(g_);
      const double before = g_.norm();
      std::vector<double> next;
      double share = 1;
      for (int halved = 0; halved < kHalvings; ++halved, share /= 2) {
        next = moved(model_, q, share * step);
        weigh(next);
        if (g_.norm() < before) break;
      }
      if (!(g_.norm() < before)) break;
      q = next;
    }
    weigh(q);
    if ((g_.cwiseAbs().array() <= left(q).array()).all()) return q;
    throw scene::InputError(
        {scene_.file.string(), 0},
        fmt::format("no equilibrium found from this guess: after {} steps of Newton's the joints "
                    "still feel {:.3g} N m (N) at q = {:.6g}; allowed: another --q",
                    steps_, g_.cwiseAbs().maxCoeff(), fmt::join(q, ",")));
  }

 private:
  void weigh(const std::vector<double>& q) {
    const scene::State<Ball> state =
        stateAt(scene_.mechanism, q, std::vector<double>(balls_.n(), 0.0));
    g_ = rounded(balls_.inverse(state)).value;
    K_ = boundedBalls(balls_.ofInverse(state, MovedPart::kPosition)).value;
  }
  Eigen::VectorXd left(const std::vector<double>& q) const {
    double largest = 1;
    for (const double x : q) largest = std::max(largest, std::abs(x));
    const double ulp = std::numeric_limits<double>::epsilon() * largest;
    return K_.cwiseAbs().rowwise().sum() * ulp;
  }

  const scene::Scene& scene_;
  LinearizationModel<Ball>& balls_;
  recursive::Model<double> model_;
  Eigen::VectorXd g_;
  Eigen::MatrixXd K_;
  int steps_ = 0;
};

std::vector<int> actuatedRates(const scene::Scene& scene, const std::vector<std::string>& names) {
  std::vector<int> out;
  std::vector<std::string> known;
  std::vector<char> found(names.size(), 0);
  int rate = 0;
  for (const scene::Link& link : scene.mechanism.links) {
    if (link.joint.ownRates() == 0) continue;
    if (!link.joint.motion.empty()) {  // its drive's force is no input
      rate += link.joint.ownRates();
      continue;
    }
    known.push_back(link.joint.name);
    bool is_meant = names.empty();
    for (std::size_t k = 0; k < names.size(); ++k)
      if (names[k] == link.joint.name) {
        is_meant = true;
        found[k] = true;
      }
    for (int k = 0; k < link.joint.ownRates(); ++k, ++rate)
      if (is_meant) out.push_back(rate);
  }
  for (std::size_t k = 0; k < names.size(); ++k)
    if (!found[k])
      throw scene::InputError(
          {scene.file.string(), 0},
          fmt::format("--actuated: no joint '{}' that is free to move, allowed: {}", names[k],
                      fmt::join(known, ", ")));
  return out;
}

Stability stabilityOf(const EnclosedModes& modes) {
  bool all_left = !modes.modes.empty() && modes.failure.empty();
  for (const EnclosedMode& mode : modes.modes) {
    if (mode.value.real() - mode.radius_re > 0) return Stability::kUnstable;
    all_left = all_left && mode.value.real() + mode.radius_re < 0;
  }
  return all_left ? Stability::kStable : Stability::kUndecided;
}

/// What the equations of motion are near the state, at the precision of the moment.
void differentiate(const scene::Scene& scene, const LinearizationOptions& options,
                   Linearization& out) {
  const scene::Mechanism& mechanism = scene.mechanism;
  const auto n = static_cast<Eigen::Index>(mechanism.dof());
  LinearizationModel<Ball> model(mechanism, BallNumbers(mechanism));
  scene::State<Ball> state = stateAt(mechanism, out.q, out.qd);
  if (!options.has_no_forces) state.tau = model.inverse(state);
  out.tau = rounded(state.tau);
  out.qdd = rounded(model.forward(state));
  Balls A = Balls::Constant(2 * n, 2 * n, Ball(0));
  for (Eigen::Index i = 0; i < n; ++i) A(i, n + i) = Ball(1);
  A.bottomLeftCorner(n, n) = model.ofForward(state, MovedPart::kPosition);
  A.bottomRightCorner(n, n) = model.ofForward(state, MovedPart::kRate);
  const Balls by_force = model.ofForward(state, MovedPart::kForce);
  Balls B = Balls::Constant(2 * n, static_cast<Eigen::Index>(out.actuated.size()), Ball(0));
  for (Eigen::Index j = 0; j < B.cols(); ++j)
    B.block(n, j, n, 1) = by_force.col(out.actuated[static_cast<std::size_t>(j)]);
  out.A = boundedBalls(A);
  out.B = boundedBalls(B);
  out.positions.resize(static_cast<std::size_t>(n));
  std::iota(out.positions.begin(), out.positions.end(), 0);
  out.rates = out.positions;
  out.along = Eigen::MatrixXd::Identity(n, n);
}

/// Off by no more than what rounding to double takes from the largest entry.
bool isSharp(const Bounded& m) {
  if (!m.value.allFinite() || !m.bound.allFinite()) return false;
  if (m.value.size() == 0) return true;
  return m.bound.maxCoeff() <=
         std::numeric_limits<double>::epsilon() * m.value.cwiseAbs().maxCoeff();
}

}  // namespace

const char* name(Stability stability) {
  switch (stability) {
    case Stability::kStable:
      return "asymptotically stable";
    case Stability::kUnstable:
      return "unstable";
    case Stability::kUndecided:
      return "not decided by linear terms";
  }
  return "";
}

namespace {

/// Oscillators' enclosures are of [0 1; K 0]; what else A is, the general ones.
EnclosedModes modesOf(const Linearization& at) {
  const auto isZero = [](const Bounded& m, const auto& part) {
    return (part(m.value).array() == 0).all() && (part(m.bound).array() == 0).all();
  };
  const auto p = static_cast<Eigen::Index>(at.positions.size()),
             r = static_cast<Eigen::Index>(at.rates.size());
  const bool oscillates =
      at.positions == at.rates &&
      isZero(at.A, [p](const Eigen::MatrixXd& m) { return m.topLeftCorner(p, p); }) &&
      isZero(at.A, [r](const Eigen::MatrixXd& m) { return m.bottomRightCorner(r, r); });
  if (!oscillates) return enclosedModes(at.A, at.B);
  const auto lower = [r](const Bounded& m, Eigen::Index columns) {
    return Bounded{m.value.bottomLeftCorner(r, columns), m.bound.bottomLeftCorner(r, columns)};
  };
  return enclosedOscillations(lower(at.A, p), lower(at.B, at.B.value.cols()));
}

/// restingRates() where the motions' own are known.
std::vector<double> restingRates(const scene::Scene& scene, std::vector<double> qd) {
  const std::vector<const scene::Expression*> motions = scene.mechanism.motions();
  for (std::size_t i = 0; i < qd.size(); ++i)
    if (motions[i] == nullptr) qd[i] = 0;
  return qd;
}

/** A drive leaves no choice: what is given for a driven joint is its motion's value at t = 0, or
    the scene's start, which stands where nobody gives one.
    @throws scene::InputError  another one is given */
void requireDriven(const scene::Scene& scene, const Linearization& given,
                   const scene::State<double>& driven) {
  const std::vector<double> start_q = inDouble(scene, scene.start_q),
                            start_qd = inDouble(scene, scene.start_qd);
  const auto require = [&](const scene::Link& link, const char* option, double value, double start,
                           double own) {
    if (value == own || value == start) return;
    throw scene::InputError(
        link.where,
        fmt::format(
            "{}: read {:.10g} for joint '{}', which is driven: its motion puts it at {:.10g} "
            "at t = 0; allowed: this value, or the others by name ({} joint=value)",
            option, value, link.joint.name, own, option));
  };
  std::size_t slot = 0, rate = 0;
  for (const scene::Link& link : scene.mechanism.links) {
    const std::size_t slots = link.joint.mimic ? 1 : scene::positionSlots(link.joint.kind).size(),
                      rates = static_cast<std::size_t>(link.joint.ownRates());
    for (std::size_t k = 0; k < rates && !link.joint.motion.empty(); ++k) {
      require(link, "--q", given.q[slot + k], start_q[slot + k], driven.x[slot + k].q);
      require(link, "--qd", given.qd[rate + k], start_qd[rate + k], driven.qd[rate + k]);
    }
    slot += slots;
    rate += rates;
  }
}

}  // namespace

std::vector<double> restingRates(const scene::Scene& scene) {
  return restingRates(scene, ConstrainedQuantities(scene).start().qd);
}

Linearization linearize(const scene::Scene& scene, const LinearizationOptions& options) {
  const scene::Mechanism& mechanism = scene.mechanism;
  requireTreated(scene, Command::kLinearize);
  requireMotion(scene);
  Linearization out;
  out.q = givenOr("--q", options.q, inDouble(scene, scene.start_q));
  const scene::State<double> driven = ConstrainedQuantities(scene).start();
  out.qd = givenOr("--qd", options.qd, restingRates(scene, driven.qd));
  out.actuated = actuatedRates(scene, options.actuated);
  requireDriven(scene, out, driven);
  if (options.seeks_equilibrium) out.qd = restingRates(scene, driven.qd);

  std::optional<ConstrainedLinearization> constrained;
  if (ConstrainedLinearization::isNeeded(mechanism, out.qd)) constrained.emplace(scene);
  if (options.seeks_equilibrium && constrained) {
    out.newton_steps = constrained->seekEquilibrium(&out.q, &out.qd);
  } else if (options.seeks_equilibrium) {
    LinearizationModel<Ball> model(mechanism, BallNumbers(mechanism));
    Equilibrium equilibrium(scene, model);
    out.q = equilibrium.from(out.q);
    out.newton_steps = equilibrium.steps();
  } else if (constrained) {
    constrained->close(&out.q, &out.qd);
  }
  LinearizationOptions there = options;  // nothing holds an equilibrium that was found
  there.has_no_forces = options.has_no_forces || (options.seeks_equilibrium && constrained);
  // long chains lose bits link by link
  for (long bits = 128; bits <= kMostBits; bits *= 2) {
    const BallPrecision precision(bits);
    if (constrained)
      constrained->differentiate(there, &out);
    else
      differentiate(scene, there, out);
    const bool is_sharp = isSharp(out.A) && isSharp(out.B);
    if (constrained && (is_sharp || 2 * bits > kMostBits))
      out.by_lagrange = constrained->compared();
    if (is_sharp) break;
  }
  out.modes = modesOf(out);
  out.rests = std::all_of(out.qd.begin(), out.qd.end(), [](double v) { return v == 0; }) &&
              (options.seeks_equilibrium ||
               (out.qdd.value.cwiseAbs().array() <= out.qdd.bound.array()).all());
  if (out.rests) out.stability = stabilityOf(out.modes);
  out.reached = reachableDimension(out.A, out.B);
  return out;
}

}  // namespace dynwitness::crosscheck
