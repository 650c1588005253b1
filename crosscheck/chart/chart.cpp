// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/chart/chart.hpp"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/chart/answers.hpp"
#include "crosscheck/chart/timed_apart.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/system/environment.hpp"
#include "crosscheck/verdicts/truth.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "crosscheck/witnesses/kernel_names.hpp"
#include "recursive/build_model.hpp"
#include "scene/error.hpp"
#include "scene/work.hpp"
#include "symbolic/closed_form.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr double kEnoughSeconds = 1;  // of one method: slow ones get fewer rounds

using Methods = std::vector<std::unique_ptr<Method>>;

/// Time that passes here and elsewhere [s].
double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A program of the user's, asked about as many states at once as are timed together.
class AskedProgram : public Method {
 public:
  AskedProgram(std::unique_ptr<Witness> witness, Quantity quantity, const States& states)
      : Method(witness->name() + " (a program: wall time)", Scalar::kDouble),
        witness_(std::move(witness)),
        quantity_(quantity),
        states_(states) {}
  void run(int state) override {
    const int count = static_cast<int>(states_.size());
    if (state == first_ || state < first_ || state >= last_) {
      first_ = state;
      last_ = std::min({count, state + static_cast<int>(kEngineBatch),
                        state + std::max(1, count / kChartBatches)});
      askEngineAhead(*witness_, quantity_, {states_.begin() + first_, states_.begin() + last_});
    }
    value_ = witness_->value(quantity_, states_[static_cast<std::size_t>(state)]);
  }
  MatrixX<Ball> answer() const override { return exactlyAll<double>(value_); }

 private:
  std::unique_ptr<Witness> witness_;
  Quantity quantity_;
  States states_;
  int first_ = 0, last_ = 0;  ///< of the states that it was asked about
  Eigen::MatrixXd value_;
};

void addSweeps(Sweep sweep, const scene::Mechanism& mechanism, const States& states,
               Methods* methods) {
  for (const auto& inScalar :
       {sweepInFloat, sweepInDouble, sweepInLongDouble, sweepInBalls, sweepIn50Digits})
    methods->push_back(inScalar(sweep, mechanism, states));
}

/// An engine that is linked: timed by its own calls where it can be called so.
std::unique_ptr<Method> linkedEngine(std::unique_ptr<Witness> witness, const scene::Scene& scene,
                                     Quantity quantity, const States& states, Chart* chart) {
  try {
    const auto model =
        recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
    if (auto raw = rawCalls(witness->name(), scene, model, quantity, states.front())) {
      chart->own_calls.push_back(raw->words);
      return rawEngineMethod(std::move(witness), quantity, states, std::move(*raw));
    }
  } catch (const std::exception& error) {
    chart->own_calls.push_back(
        fmt::format("{}: by its witness, since {}", witness->name(), error.what()));
  }
  return engineMethod(std::move(witness), quantity, states);
}

Methods methodsFor(const scene::Scene& scene, Quantity quantity,
                   const std::vector<WitnessKind>& kinds, const States& states, Chart* chart) {
  const scene::Mechanism& mechanism = scene.mechanism;
  Methods methods;
  if (mechanism.positions() != mechanism.dof())
    chart->left_out.push_back(
        fmt::format("{}: not for spherical and floating joints", MethodName::kClosedForm));
  else if (mechanism.dof() <= symbolic::kClosedFormJoints)
    methods.push_back(closedFormMethod(quantity, mechanism, states));
  else
    chart->left_out.push_back(fmt::format("{}: more than {} joints", MethodName::kClosedForm,
                                          symbolic::kClosedFormJoints));
  try {
    methods.push_back(programMethod(quantity, mechanism, states));
  } catch (const scene::InputError& error) {  // too large to be derived
    chart->left_out.push_back(fmt::format("{}: {}", MethodName::kProgram, error.what()));
  }
  if (quantity == Quantity::kTau) addSweeps(Sweep::kNewtonEuler, mechanism, states, &methods);
  if (quantity == Quantity::kM) addSweeps(Sweep::kCompositeBody, mechanism, states, &methods);
  if (quantity == Quantity::kQdd) {
    methods.push_back(sweepInDouble(Sweep::kCompositeBodySolved, mechanism, states));
    addSweeps(Sweep::kArticulatedBody, mechanism, states, &methods);
  }
  try {
    methods.push_back(fastMethod(quantity, mechanism, states));
  } catch (const std::invalid_argument& error) {  // joints that follow others
    chart->left_out.push_back(fmt::format("{}: {}", kFastMethod, error.what()));
  }
  for (const WitnessKind& kind : kinds) {
    if (kind.info.name == kKernelName) {
      try {
        methods.push_back(kernelMethod(quantity, mechanism, states));
        try {
          methods.push_back(lanesMethod(*methods.back(), states, kChartBatches));
        } catch (const std::exception& error) {
          chart->left_out.push_back(fmt::format("{}: {}", kLanesMethod, error.what()));
        }
      } catch (const std::exception& error) {
        chart->left_out.push_back(fmt::format("{}: {}", MethodName::kKernel, error.what()));
      }
    }
    if (kind.info.version == DYNWITNESS_VERSION && !isProgram(kind))
      continue;  // ours: above, without their bounds
    if (!kind.info.present) {
      chart->left_out.push_back(kind.info.name + ": " + kind.info.absent);
      continue;
    }
    MadeWitness made = kind.make(scene);
    if (made.isRefused())
      chart->left_out.push_back(kind.info.name + ": " + made.refusal());
    else if ((*made)->answers(quantity) && isProgram(kind))
      methods.push_back(std::make_unique<AskedProgram>(std::move(made).value(), quantity, states));
    else if ((*made)->answers(quantity))
      methods.push_back(linkedEngine(std::move(made).value(), scene, quantity, states, chart));
    else
      chart->left_out.push_back(
          fmt::format("{}: does not answer {}", kind.info.name, crosscheck::name(quantity)));
  }
  return methods;
}

// --------------------------------------------------------------------------------- measurement

/// Largest distance of an entry to the truth / largest entry of the truth, rounded up.
double relativeError(const MatrixX<Ball>& answer, const MatrixX<Ball>& truth) {
  const BallPrecision precision(kChartTruthBits);
  double size = 0, error = 0;
  for (Eigen::Index k = 0; k < truth.size(); ++k) {
    const Ball distance = answer.data()[k] - truth.data()[k];
    if (!distance.isFinite()) return std::numeric_limits<double>::infinity();
    size = std::max(size, truth.data()[k].atLeast());
    error = std::max(error, distance.atMost());
  }
  return error == 0 ? 0 : error / size;
}

/// CPU time of this thread [s]: other programs on the machine do not count.
double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The value below which this share of a sorted list lies.
double quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1) + 0.5)];
}

/// Times of one evaluation [ns], one a batch of states.
void timeOneRound(Method& method, int states, std::vector<double>* times) {
  const auto seconds = dynamic_cast<AskedProgram*>(&method) ? wallSeconds : cpuSeconds;
  auto* const apart = dynamic_cast<TimedApart*>(&method);
  const int batches = std::min(kChartBatches, states);
  for (int b = 0; b < batches; ++b) {
    const int first = firstOfBatch(states, batches, b), last = firstOfBatch(states, batches, b + 1);
    double spent = 0;
    // on virtual machines the clock may stand still over a batch: that is no time
    for (int attempt = 0; attempt < 10 && !(spent > 0); ++attempt) {
      const double start = seconds();
      if (apart)
        apart->runAll(first, last);
      else
        for (int k = first; k < last; ++k) method.run(k);
      spent = seconds() - start;
    }
    times->push_back(1e9 * std::max(spent, 1e-9) / (last - first));
  }
}

}  // namespace

const std::vector<Quantity>& chartedQuantities() {
  static const std::vector<Quantity> all = {Quantity::kM, Quantity::kTau, Quantity::kQdd};
  return all;
}

Chart speedAccuracy(const scene::Scene& scene, Quantity quantity,
                    const std::vector<WitnessKind>& kinds, int states, std::uint64_t seed) {
  const std::vector<Quantity>& known = chartedQuantities();
  if (std::find(known.begin(), known.end(), quantity) == known.end())
    throw std::invalid_argument(
        fmt::format("speedAccuracy: quantity: expected M, tau or qdd, got {}", name(quantity)));
  Chart chart{scene.name, scene.title, name(quantity), states, seed, cpuModel(), {}, {}, {}};
  States drawn;
  std::vector<MatrixX<Ball>> truths;
  Truth truth(scene.mechanism, kChartTruthBits);
  scene::Work work("", 10);
  std::optional<scene::Work> part(std::in_place, "certified truth", states, 5);
  for (int k = 0; k < states; ++k, part->done()) {
    drawn.push_back(drawState(scene.mechanism, scene.name, seed, k));
    Certified certified = truth(quantity, drawn.back());
    if (!certified.exists())
      throw scene::InputError(
          {scene.file.string()},
          fmt::format("no exact {} to measure errors by: state {} of seed {}: {}", name(quantity),
                      k, seed, certified.reason));
    truths.push_back(std::move(certified.value));
  }

  part.reset();
  Methods methods;
  for (auto& method : methodsFor(scene, quantity, kinds, drawn, &chart)) {
    std::vector<double> errors;
    try {
      for (int k = 0; k < states; ++k) {  // this pass also warms up what the timing needs
        method->run(k);
        errors.push_back(relativeError(method->answer(), truths[k]));
      }
    } catch (const std::exception& error) {  // an engine that cannot hold the scene
      chart.left_out.push_back(fmt::format("{}: {}", method->name, error.what()));
      continue;
    }
    std::sort(errors.begin(), errors.end());
    chart.points.push_back({method->name, method->scalar, errors.back(), quantile(errors, 0.5)});
    methods.push_back(std::move(method));
  }

  std::vector<std::vector<double>> times(methods.size());
  std::vector<double> spent(methods.size(), 0.0);
  work.doneTo(0.7);
  part.emplace("times", kChartRounds, 3);
  for (int round = 0; round < kChartRounds; ++round, part->done()) {
    for (std::size_t i = 0; i < methods.size(); ++i) {
      if (spent[i] > kEnoughSeconds) continue;
      const double start = cpuSeconds();
      timeOneRound(*methods[i], states, &times[i]);
      spent[i] += cpuSeconds() - start;
    }
  }
  for (std::size_t i = 0; i < methods.size(); ++i) {
    std::sort(times[i].begin(), times[i].end());
    chart.points[i].time_min_ns = times[i].front();
    chart.points[i].time_median_ns = quantile(times[i], 0.5);
    chart.points[i].time_high_ns = quantile(times[i], 0.9);
  }
  return chart;
}

}  // namespace dynwitness::crosscheck
