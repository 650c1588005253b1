// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/reduced_acceleration.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/kernel/roads.hpp"
#include "crosscheck/reduction/acceleration_error.hpp"
#include "crosscheck/reduction/parameter_sequence.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using kernel::Formula;
using scene::JointRanges;
using symbolic::Program;
using Kind = EnvelopeQuantity::Kind;

/// For the scene's accelerations, joint by joint, and for a question whether an error is allowed.
/// Measured: puma_560's are bounded by 2000 boxes to 1.1 to 1.5 times what is seen, its errors near
/// 5 % to 1.3 to 2.1 times, in a second each.
constexpr int kBoxes = 2000;

/// Shares of the time in percent, by which its end is told. Measured: puma_560 with 5 %.
constexpr double kLargest = 25, kOrder = 5, kScenes = 40, kErrors = 30;

class AccelerationReducer {
 public:
  AccelerationReducer(const scene::Scene& scene, const std::vector<JointRanges>& ranges,
                      const ReduceOptions& options,
                      const std::function<void(const std::string&)>& stage)
      : scene_(scene), ranges_(ranges), options_(options), stage_(stage) {
    requireTreated(scene, Command::kReduce);
    if (options.armstrong > 0)
      throw scene::InputError({},
                              "--armstrong with --of qdd: his rule is about terms of tau, "
                              "allowed: --of tau");
    boundAccelerations();
    stage("the scene's own program");
    full_program_ = kernel::smallestRoad(scene.mechanism, Formula::kForwardDynamics).program;
    full_ = trigonometricModel(scene);
  }

  Reduction run() {
    Reduction out;
    out.of = ReducedQuantity::kQdd;
    out.full = full_program_;
    stage_("which parameters are missed least");
    const ReductionSamples samples(scene_.mechanism, ranges_, ReducedQuantity::kQdd);
    {
      const scene::Work work("order", 1, kOrder);
      bases_ = parameterSequence(scene_, samples, largest_, options_.allowed.back());
    }
    findScenes(samples);
    scene::Work work("errors", static_cast<double>(found_.size()), kErrors);
    for (std::size_t t = 0; t < found_.size(); ++t, work.done()) {
      stage_(fmt::format("error at {:.3g} %", 100 * options_.allowed[t]));
      out.models.push_back(t > 0 && found_[t].base == found_[t - 1].base
                               ? out.models.back()
                               : finished(found_[t], samples));
      out.models.back().allowed = options_.allowed[t];
    }
    out.scenes = out.models;
    return out;
  }

 private:
  struct Found {
    std::size_t base = 0;  ///< 0: the scene itself
    Program program;
    std::vector<double> bounds;  ///< of errors, by joint
  };

  void boundAccelerations() {
    EnvelopeOptions options;
    options.boxes = std::min(options_.boxes, kBoxes);
    options.quantities = {"qdd"};
    const scene::Work work("accelerations", 1, kLargest);
    for (const EnvelopeBound& qdd : envelopeBounds(scene_, ranges_, options, stage_)) {
      if (!std::isfinite(qdd.certified))
        throw scene::InputError(
            {scene_.file.string()},
            fmt::format("reduce --of qdd: no bound of {} was found in {} boxes, "
                        "allowed: an [envelope] with smaller ranges of q",
                        qdd.quantity.name(), options.boxes));
      accelerations_.push_back(qdd.certified);
      largest_.push_back(qdd.sampled);
      for (const double allowed : options_.allowed)
        if (allowed > 0 && allowed * qdd.sampled <= 2 * qdd.lost)
          throw scene::InputError(
              {scene_.file.string()},
              fmt::format("reduce: an error of {:.3g} of {}: roundings alone may make {:.2g} of "
                          "it, allowed: twice that or more, or 0",
                          allowed, qdd.quantity.name(), qdd.lost / qdd.sampled));
    }
  }

  /// The last scene of the sequence that is near enough, by what is allowed.
  void findScenes(const ReductionSamples& samples) {
    found_.assign(options_.allowed.size(), {0, full_program_, {}});
    scene::Work work("scenes", static_cast<double>(bases_.size()), kScenes);
    std::vector<bool> has(found_.size(), false);
    for (std::size_t b = bases_.size() - 1; b > 0; --b, work.done()) {
      const auto isWorth = [&](std::size_t t) {
        return !has[t] && bases_[b].sampled <= options_.allowed[t];
      };
      std::vector<std::size_t> asked;
      for (std::size_t t = 0; t < has.size(); ++t)
        if (isWorth(t)) asked.push_back(t);
      if (asked.empty()) continue;
      const std::optional<Program> program = programOf(b);
      if (!program) continue;
      stage_(fmt::format("{} parameters dropped", bases_[b].dropped.size()));
      const TrigonometricModel reduced = trigonometricModel(bases_[b].scene);
      AccelerationErrors errors(full_, reduced, ranges_, accelerations_);
      const std::vector<std::size_t> order = worstFirst(samples.worst(bases_[b].scene.mechanism));
      for (auto t = asked.rbegin(); t != asked.rend(); ++t) {  // the most that is allowed first
        const std::vector<double> bounds = boundsWithin(order, options_.allowed[*t], &errors);
        if (bounds.empty()) break;
        has[*t] = true;
        found_[*t] = {b, *program, bounds};
      }
    }
  }

  /// None: it is longer than the scene's, or there is none.
  std::optional<Program> programOf(std::size_t b) const {
    try {
      Program program =
          kernel::smallestRoad(bases_[b].scene.mechanism, Formula::kForwardDynamics).program;
      if (program.bodyOperations().all() < full_program_.bodyOperations().all()) return program;
    } catch (const kernel::NotUsed&) {
    } catch (const std::domain_error&) {  // M is singular everywhere
    }
    return std::nullopt;
  }

  /// Joints, that of the largest sampled error first: it is the one to say no.
  std::vector<std::size_t> worstFirst(const std::vector<ReductionSamples::Worst>& sampled) const {
    std::vector<std::size_t> order(sampled.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return sampled[a].error * largest_[b] > sampled[b].error * largest_[a];
    });
    return order;
  }

  /// By joint, none of them above what is allowed; none: that is not known.
  std::vector<double> boundsWithin(const std::vector<std::size_t>& order, double allowed,
                                   AccelerationErrors* errors) const {
    std::vector<double> limits, bounds(largest_.size());
    for (const double largest : largest_) limits.push_back(allowed * largest);
    EnvelopeOptions options;
    options.boxes = kBoxes;
    for (const std::size_t i : order) {
      if (!(limits[i] > 0)) return {};  // what is proven needs room: 0 keeps the scene
      bounds[i] = errors->of(static_cast<int>(i), limits, options, limits[i]).certified;
      if (!(bounds[i] <= limits[i])) return {};
    }
    return bounds;
  }

  ReducedModel finished(const Found& found, const ReductionSamples& samples) const {
    const ReducedBase& base = bases_[found.base];
    ReducedModel out;
    out.scene = base.scene;
    out.parameters = base.dropped;
    out.program = found.program;
    if (found.base == 0) {
      for (const double largest : largest_) out.forces.push_back({largest, 0, 0, {}});
      return out;
    }
    const TrigonometricModel reduced = trigonometricModel(base.scene);
    AccelerationErrors errors(full_, reduced, ranges_, accelerations_);
    EnvelopeOptions options;
    options.boxes = std::min(options_.boxes, kBoxes);
    const std::vector<ReductionSamples::Worst> sampled = samples.worst(base.scene.mechanism);
    for (std::size_t i = 0; i < largest_.size(); ++i) {
      const EnvelopeBound error = errors.of(static_cast<int>(i), found.bounds, options, -1);
      ReducedForce force{largest_[i], std::min(error.certified, found.bounds[i]), 0, {}};
      for (const EnvelopeState& state : {error.worst, sampled[i].state})
        see(base.scene, i, state, &force);
      out.forces.push_back(force);
    }
    return out;
  }

  /// Sweep against sweep.
  void see(const scene::Scene& reduced, std::size_t i, const EnvelopeState& state,
           ReducedForce* force) const {
    if (state.q.empty()) return;
    const EnvelopeQuantity qdd{Kind::kQdd, static_cast<int>(i), 0};
    const RunningError off = sweptQuantity(scene_, qdd, state) - sweptQuantity(reduced, qdd, state);
    const double seen = std::abs(off.value()) - off.bound();
    if (!(seen > force->at_least)) return;
    force->at_least = seen;
    force->worst = state;
  }

  const scene::Scene& scene_;
  const std::vector<JointRanges>& ranges_;
  const ReduceOptions& options_;
  const std::function<void(const std::string&)>& stage_;
  std::vector<double> largest_, accelerations_;  ///< |qdd_i|: at least, and at most
  Program full_program_;
  TrigonometricModel full_;
  std::vector<ReducedBase> bases_;  ///< the scene as it is first
  std::vector<Found> found_;
};

}  // namespace

const char* name(ReducedQuantity quantity) {
  return quantity == ReducedQuantity::kTau ? "tau" : "qdd";
}

Reduction reducedInAcceleration(const scene::Scene& scene, const std::vector<JointRanges>& ranges,
                                const ReduceOptions& options,
                                const std::function<void(const std::string&)>& stage) {
  const scene::Work work("reduction", kLargest + kOrder + kScenes + kErrors);
  return AccelerationReducer(scene, ranges, options, stage).run();
}

}  // namespace dynwitness::crosscheck
