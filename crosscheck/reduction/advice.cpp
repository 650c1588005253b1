// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/advice.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/kernel/compiled.hpp"
#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/simulate.hpp"
#include "crosscheck/motion/state_gap.hpp"
#include "crosscheck/motion/step_trials.hpp"
#include "crosscheck/reduction/code_motion.hpp"
#include "crosscheck/reduction/reduce.hpp"
#include "scene/held_joints.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using kernel::CodeScalar;
using Real = long double;
using End = std::vector<Real>;

/// What is asked of `reduced()`; the scenes that it finds are few.
const std::vector<double> kAllowed = {0.000001, 0.00001, 0.0001, 0.0003, 0.001,
                                      0.003,    0.01,    0.03,   0.1};
/// Of the error that is left for integration, what roundings may have of it.
constexpr double kForRoundings = 0.1;
constexpr int kTimedRuns = 3, kEnvelopeTimes = 1000;
/// Steps of curves, in the advised number of them.
constexpr double kCurve[] = {0.125, 0.25, 0.5, 1, 2, 4, 8, 16, 32};

template <typename T>
End endAfter(const scene::Scene& scene, MotionEquations<T>& motion, const std::string& method,
             double duration, long steps, const End& like) {
  std::vector<T> y = startOf<T>(scene);
  const auto stepper = stepsOf<T>(method, motion);
  const T h = static_cast<T>(duration) / static_cast<T>(steps);
  for (long k = 0; k < steps; ++k) stepper->step(&y, static_cast<T>(k) * h, h);
  return placed(scene.mechanism, y, like);
}

double gap(const End& a, const End& b) {
  return static_cast<double>(largestGap(a, b, b.size()));
}

double cpuSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// The scene with one coordinate of its start moved.
scene::Scene moved(const scene::Scene& scene, std::size_t coordinate, double by) {
  scene::Scene out = scene;
  const std::vector<double> start = startOf<double>(scene);
  scene::Number& number = coordinate < out.start_q.size()
                              ? out.start_q[coordinate]
                              : out.start_qd[coordinate - out.start_q.size()];
  number = scene::Number(scene::Rational(start[coordinate] + by));
  return out;
}

/// Models, each with what its candidates share.
struct Prepared {
  std::unique_ptr<AccelerationCode> code;
  std::unique_ptr<CodeMotion> in_float, in_double;
  std::unique_ptr<LaneMotion> in_lanes;  ///< none: not asked for, or there is no kernel
  std::string why_no_lanes;
  KnownEnd end;

  MotionEquations<double>& motion(AdvisedScalar scalar) const {
    if (scalar == AdvisedScalar::kLanes) return *in_lanes;
    return scalar == AdvisedScalar::kFloat ? *in_float : *in_double;
  }
};

class Adviser {
 public:
  Adviser(const scene::Scene& scene, const std::vector<scene::JointRanges>& ranges,
          const AdviceOptions& options, const std::function<void(const std::string&)>& stage)
      : scene_(scene), ranges_(ranges), options_(options), stage_(stage) {
    requireTreated(scene, Command::kAdvise);
    if (options_.methods.empty()) options_.methods = explicitMethods();
    const std::vector<std::string> all = explicitMethods();
    for (const std::string& method : options_.methods)
      if (std::find(all.begin(), all.end(), method) == all.end())
        throw scene::InputError(
            {}, fmt::format("method '{}', allowed: those that ask for qdd and solve no equations: "
                            "{}; others are compared by dynwitness drift --advise",
                            method, fmt::join(all, ", ")));
    out_.error = options.error;
    out_.duration = options.duration;
    out_.time_budget = options.time_budget;
    out_.motions = options.motions;
  }

  Advice run() {
    const scene::Work work("advice", 3);
    requireAboveRoundings(1);
    prepareScene();
    growth();
    findModels();
    const scene::Work candidates("candidates", static_cast<double>(out_.models.size()), 1);
    for (std::size_t m = 0; m < out_.models.size(); ++m) tryModel(m);
    sort();
    if (options_.draws) draw();
    return std::move(out_);
  }

 private:
  /// Roundings of double on the start, times what the motion makes of them.
  void requireAboveRoundings(double growth) const {
    double size = 1;
    for (const double y : startOf<double>(scene_)) size = std::max(size, std::abs(y));
    const double rounding = growth * size * RunningError::kUnitRoundoff;
    if (options_.error > rounding) return;
    throw scene::InputError(
        {scene_.file.string()},
        growth == 1
            ? fmt::format("an error of {:.3g}: roundings of double alone are {:.2g} of this start, "
                          "allowed: more than that",
                          options_.error, rounding)
            : fmt::format("the motion is chaotic over {} s: what the start is off by grows "
                          "{:.2g}-fold, roundings of double to {:.2g}, so that no arithmetic here "
                          "keeps {:.3g}; allowed: a shorter --duration or a larger --error",
                          options_.duration, growth, rounding, options_.error));
  }

  KnownEnd endOf(const scene::Scene& scene) const {
    try {
      return knownEnd(scene, options_.duration, options_.error);
    } catch (const scene::InputError&) {
      throw;
    } catch (const std::runtime_error& error) {
      throw scene::InputError(
          {scene_.file.string()},
          fmt::format("the motion is chaotic or too wild over {} s: its end is not known to a "
                      "tenth of {:.3g} by 65536 steps of order 8; allowed: a shorter --duration "
                      "or a larger --error",
                      options_.duration, options_.error));
    }
  }

  Prepared prepared(const scene::Scene& scene) const {
    Prepared out;
    out.code = std::make_unique<AccelerationCode>(scene);
    out.in_float = std::make_unique<CodeMotion>(scene, *out.code, CodeScalar::kFloat);
    out.in_double = std::make_unique<CodeMotion>(scene, *out.code, CodeScalar::kDouble);
    if (out_.motions > 1) {
      try {
        out.in_lanes = std::make_unique<LaneMotion>(scene);
      } catch (const kernel::NotUsed& error) {
        out.why_no_lanes = error.what();
      }
    }
    out.end = endOf(scene);
    return out;
  }

  void prepareScene() {
    stage_("the scene's own motion");
    try {
      prepared_.push_back(prepared(scene_));
    } catch (const kernel::NotUsed& error) {
      throw scene::InputError({scene_.file.string()},
                              std::string("no code of qdd: ") + error.what());
    } catch (const kernel::CannotCompile& error) {
      throw scene::InputError({}, std::string("the code of qdd is not compiled: ") + error.what());
    }
    out_.known_to = prepared_.front().end.error;
    AdvisedModel full;
    full.scene = scene_;
    full.operations = prepared_.front().code->operations();
    takeLanes(prepared_.front(), &full);
    if (const auto& lanes = prepared_.front().in_lanes) out_.lanes = lanes->lanes();
    out_.no_lanes = prepared_.front().why_no_lanes;
    out_.models.push_back(full);
  }

  static void takeLanes(const Prepared& ready, AdvisedModel* model) {
    if (ready.in_lanes) model->lane_operations = ready.in_lanes->operations();
  }

  /// Calls for all motions in lanes, a motion.
  double shareOfLanes() const {
    return static_cast<double>((out_.motions + out_.lanes - 1) / out_.lanes) /
           static_cast<double>(out_.motions);
  }
  double operationsOf(const AdvisedModel& model, AdvisedScalar scalar) const {
    return scalar == AdvisedScalar::kLanes ? model.lane_operations * shareOfLanes()
                                           : model.operations;
  }

  void growth() {
    const std::size_t coordinates = startOf<double>(scene_).size() - 1;
    scene::Work work("neighbours", static_cast<double>(coordinates), 1);
    const End& end = prepared_.front().end.y;
    for (std::size_t k = 0; k < coordinates; ++k, work.done()) {
      stage_("motions beside it");
      const KnownEnd other = endOf(moved(scene_, k, options_.error));
      out_.growth = std::max(out_.growth, gap(other.y, end) / options_.error);
    }
    requireAboveRoundings(std::max(1.0, out_.growth));
  }

  void findModels() {
    if (ranges_.empty()) {
      out_.no_reduction = "the scene has no [envelope], for which smaller models are certified";
      return;
    }
    scene::Scene fixed = scene_;
    std::vector<scene::JointRanges> left = ranges_;
    if (!scene::fixHeldJoints(&fixed, &left).empty()) {
      out_.no_reduction = "its [envelope] holds joints at rest that the scene's motion may move";
      return;
    }
    ReduceOptions options;
    options.allowed = kAllowed;
    options.adds_terms = false;
    Reduction found;
    const scene::Work work("models", 1, 1);
    try {
      found = reduced(scene_, ranges_, options, stage_);
    } catch (const scene::InputError& error) {
      out_.no_reduction = error.what();
      return;
    }
    std::size_t dropped = 0;
    for (const ReducedModel& model : found.scenes) {
      if (model.parameters.size() <= dropped) continue;
      dropped = model.parameters.size();
      addModel(model);
    }
    if (dropped == 0)
      out_.no_reduction = "no parameter can go within a tenth of the joint forces";
    else
      out_.leaves = whereItLeaves();
  }

  void addModel(const ReducedModel& model) {
    AdvisedModel next;
    next.allowed = model.allowed;
    next.force_error = model.share();
    next.scene = model.scene;
    stage_("the motion of the model " + next.name());
    Prepared ready;
    try {
      scene::validate(next.scene);
      ready = prepared(next.scene);
      next.operations = ready.code->operations();
      takeLanes(ready, &next);
      ready.end.y = placed(scene_.mechanism, withWork(ready.end.y), prepared_.front().end.y);
      next.end_error = gap(ready.end.y, prepared_.front().end.y);
      if (!(next.end_error < options_.error))
        next.why_not = fmt::format("its motion ends {:.2g} away", next.end_error);
      else if (next.operations >= out_.models.front().operations)
        next.why_not = "its qdd takes no fewer operations";
    } catch (const std::exception& error) {  // M is singular, or its motion wild
      next.why_not = error.what();
    }
    prepared_.push_back(std::move(ready));
    out_.models.push_back(std::move(next));
  }

  static End withWork(End y) {
    y.push_back(0);
    return y;
  }

  std::string whereItLeaves() const {
    SimulateOptions run;
    run.duration = options_.duration;
    run.outputs = kEnvelopeTimes;
    for (const Simulation::Point& point : simulate(scene_, run).points)
      for (std::size_t i = 0; i < ranges_.size(); ++i)
        for (const auto& [name, range, x] : {std::make_tuple("q", ranges_[i].q, point.q[i]),
                                             std::make_tuple("qd", ranges_[i].qd, point.qd[i]),
                                             std::make_tuple("qdd", ranges_[i].qdd, point.qdd[i])})
          if (x < range.low || x > range.high)
            return fmt::format("{}_{} = {:.3g} at {:.3g} s", name, i + 1, x, point.time);
    return "";
  }

  void tryModel(std::size_t m) {
    if (!out_.models[m].why_not.empty()) return;
    const std::size_t first = out_.candidates.size();
    for (const std::string& method : options_.methods) {
      stage_(fmt::format("{}, {}", out_.models[m].name(), method));
      tryMethod(m, method);
    }
    for (std::size_t c = first; c < out_.candidates.size(); ++c) judge(&out_.candidates[c]);
  }

  void tryMethod(std::size_t m, const std::string& method) {
    const double left = options_.error - out_.models[m].end_error;
    AdvisedCandidate base;
    base.model = m;
    base.method = method;
    base.model_error = out_.models[m].end_error;
    if (!findStep(left * (1 - kForRoundings), &base)) {
      out_.candidates.push_back(base);
      return;
    }
    for (const AdvisedScalar scalar :
         {AdvisedScalar::kFloat, AdvisedScalar::kDouble, AdvisedScalar::kLanes}) {
      if (scalar == AdvisedScalar::kLanes && !prepared_[m].in_lanes) continue;
      AdvisedCandidate next = base;
      next.scalar = scalar;
      next.operations = next.calls * operationsOf(out_.models[m], scalar);
      measure(&next);
      // once more with the room that these roundings need
      if (next.error() > options_.error && 2 * next.rounding_error < left &&
          findStep(left - 2 * next.rounding_error, &next))
        measure(&next);
      out_.candidates.push_back(next);
    }
  }

  /// @return whether there is one; otherwise why_not says why
  bool findStep(double accuracy, AdvisedCandidate* c) const {
    const AdvisedModel& model = out_.models[c->model];
    const AccurateStep found = accurateStep(model.scene, c->method, options_.duration, accuracy,
                                            options_.duration, prepared_[c->model].end);
    if (found.step <= 0 || found.is_predicted) {
      c->why_not = found.step > 0 ? "more than 524288 steps" : found.why;
      return false;
    }
    c->steps = std::lround(options_.duration / found.step);
    c->step = options_.duration / static_cast<double>(c->steps);
    c->calls = found.calls / options_.duration;
    c->operations = c->calls * operationsOf(model, c->scalar);
    return true;
  }

  void measure(AdvisedCandidate* c) const {
    const AdvisedModel& model = out_.models[c->model];
    const Prepared& ready = prepared_[c->model];
    TreeMotion<Real> exact(model.scene.mechanism);
    const End fine =
        endAfter(model.scene, exact, c->method, options_.duration, c->steps, ready.end.y);
    MotionEquations<double>& code = ready.motion(c->scalar);
    const End coded =
        endAfter(model.scene, code, c->method, options_.duration, c->steps, ready.end.y);
    c->step_error = gap(fine, ready.end.y);
    c->rounding_error = gap(coded, fine);
    if (options_.time_budget > 0) time(c, &code);
  }

  void time(AdvisedCandidate* c, MotionEquations<double>* code) const {
    const AdvisedModel& model = out_.models[c->model];
    for (int run = 0; run < kTimedRuns; ++run) {
      // short ones are repeated until the clock, which counts microseconds, sees them
      const double begin = cpuSeconds();
      int times = 0;
      double taken = 0;
      do {
        endAfter(model.scene, *code, c->method, options_.duration, c->steps,
                 prepared_[c->model].end.y);
        ++times;
        taken = cpuSeconds() - begin;
      } while (taken < kShortestRun);
      const double share = c->scalar == AdvisedScalar::kLanes ? shareOfLanes() : 1;
      const double one = share * taken / times / options_.duration;
      c->seconds = run == 0 ? one : std::min(c->seconds, one);
    }
  }

  void judge(AdvisedCandidate* c) const {
    if (!c->why_not.empty()) return;
    if (!(c->error() <= options_.error))
      c->why_not = fmt::format("roundings alone make {:.2g}", c->rounding_error);
    else if (options_.time_budget > 0 && c->seconds > options_.time_budget)
      c->why_not = "takes longer than --time-budget";
  }

  void sort() {
    const auto key = [](const AdvisedCandidate& c) {
      return std::make_tuple(c.steps == 0, c.operations, c.scalar);
    };
    std::stable_sort(
        out_.candidates.begin(), out_.candidates.end(),
        [&](const AdvisedCandidate& a, const AdvisedCandidate& b) { return key(a) < key(b); });
    for (std::size_t c = 0; c < out_.candidates.size() && !out_.chosen; ++c)
      if (out_.candidates[c].why_not.empty()) out_.chosen = c;
  }

  /// Of the scene and the chosen model, in each arithmetic, the cheapest method over steps.
  void draw() {
    const std::size_t model = out_.chosen ? out_.candidates[*out_.chosen].model : 0;
    std::vector<std::pair<std::size_t, AdvisedScalar>> drawn;
    for (std::size_t c = 0; c < out_.candidates.size(); ++c) {
      const AdvisedCandidate& candidate = out_.candidates[c];
      const auto key = std::make_pair(candidate.model, candidate.scalar);
      if (candidate.steps == 0 || (candidate.model != 0 && candidate.model != model) ||
          std::find(drawn.begin(), drawn.end(), key) != drawn.end())
        continue;
      drawn.push_back(key);
      out_.curves.push_back(curveOf(c));
    }
  }

  AdvisedCurve curveOf(std::size_t c) const {
    const AdvisedCandidate& candidate = out_.candidates[c];
    const AdvisedModel& model = out_.models[candidate.model];
    AdvisedCurve curve{c, {}};
    for (const double times : kCurve) {
      const long steps = std::lround(times * static_cast<double>(candidate.steps));
      if (steps < 1) continue;
      MotionEquations<double>& code = prepared_[candidate.model].motion(candidate.scalar);
      const long before = code.calls;
      const double error = gap(endAfter(model.scene, code, candidate.method, options_.duration,
                                        steps, prepared_.front().end.y),
                               prepared_.front().end.y);
      if (std::isfinite(error))
        curve.points.push_back({static_cast<double>(code.calls - before) / options_.duration *
                                    operationsOf(model, candidate.scalar),
                                error});
    }
    return curve;
  }

  static constexpr double kShortestRun = 0.02;  ///< [s]

  const scene::Scene& scene_;
  const std::vector<scene::JointRanges>& ranges_;
  AdviceOptions options_;
  const std::function<void(const std::string&)>& stage_;
  std::vector<Prepared> prepared_;
  Advice out_;
};

}  // namespace

std::string AdvisedModel::name() const {
  return allowed == 0 ? "full" : fmt::format("within {:.6g} %", 100 * allowed);
}

const char* name(AdvisedScalar scalar) {
  return scalar == AdvisedScalar::kFloat    ? "float"
         : scalar == AdvisedScalar::kDouble ? "double"
                                            : "lanes";
}

std::vector<std::string> explicitMethods() {
  std::vector<std::string> out;
  for (const Integrator& method : integrators())
    if (std::isfinite(method.real_limit) && !method.needs_momenta) out.emplace_back(method.name);
  return out;
}

Advice adviceFor(const scene::Scene& scene, const std::vector<scene::JointRanges>& ranges,
                 const AdviceOptions& options,
                 const std::function<void(const std::string&)>& stage) {
  return Adviser(scene, ranges, options, stage).run();
}

}  // namespace dynwitness::crosscheck
