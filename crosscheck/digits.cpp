// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/digits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "crosscheck/states.hpp"
#include "crosscheck/tally.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Wide enough for the distance between an answer and a truth, both of which carry more than 53 bits.
constexpr long kDistanceBits = 256;

template <typename Matrix>
MatrixOf<Ball> exactly(const Matrix& answer) {
  return answer.unaryExpr([](const auto& x) { return Ball(x); });
}

template <typename T>
scene::State<T> stateIn(const scene::State<double>& state) {
  scene::State<T> out;
  for (const scene::JointPosition<double>& x : state.x)
    out.x.push_back(scene::jointPosition(static_cast<T>(x.q)));
  out.qd.assign(state.qd.begin(), state.qd.end());
  out.qdd.assign(state.qdd.begin(), state.qdd.end());
  out.tau.assign(state.tau.begin(), state.tau.end());
  return out;
}

/// One quantity of one scene: its states and their truths, met by every witness.
class Course {
 public:
  Course(const scene::Scene& scene, Quantity quantity, const Options& options, Truth& truth)
      : scene_(scene), quantity_(quantity) {
    for (int k = 0; k < options.states; ++k) {
      states_.push_back(drawState(scene.mechanism, scene.name, options.seed, k));
      truths_.push_back(truth(quantity, states_.back()));
    }
  }

  DigitsResult run(Witness& witness) const {
    DigitsTally tally = tallyFor<double>(witness.name(), "double");
    for (std::size_t k = 0; k < states_.size(); ++k) {
      try {
        const Answer answer = witness.answer(quantity_, states_[k]);
        tally.add(static_cast<int>(k), exactly(answer.value), truths_[k], &answer.bound);
      } catch (const std::exception& error) {
        tally.fail(static_cast<int>(k), error.what());
      }
    }
    return tally.result();
  }

  template <typename Algorithm, typename T>
  DigitsResult run(Setup<T>& setup, const char* scalar) const {
    DigitsTally tally = tallyFor<T>(Algorithm::kName, scalar);
    for (std::size_t k = 0; k < states_.size(); ++k)
      tally.add(static_cast<int>(k),
                exactly(Algorithm::answer(setup, quantity_, stateIn<T>(states_[k]))), truths_[k],
                nullptr);
    return tally.result();
  }

 private:
  template <typename T>
  DigitsTally tallyFor(const std::string& witness, const char* scalar) const {
    DigitsResult description;
    description.scene = scene_.name;
    description.witness = witness;
    description.quantity = crosscheck::name(quantity_);
    description.scalar = scalar;
    return DigitsTally(description, scene_.mechanism, std::numeric_limits<T>::max_digits10);
  }

  const scene::Scene& scene_;
  Quantity quantity_;
  std::vector<scene::State<double>> states_;
  std::vector<Certified> truths_;
};

}  // namespace

DigitsTally::DigitsTally(DigitsResult description, const scene::Mechanism& mechanism, int max_digits)
    : result_(std::move(description)), max_digits_(max_digits) {
  for (const int i : mechanism.movingLinks())
    joint_names_.push_back(mechanism.links[i].joint.name);
}

double DigitsTally::digits(double error, double size) const {
  if (error == 0) return max_digits_;
  const double digits = -std::log10(error / size);
  return std::isnan(digits) ? 0 : std::clamp(digits, 0.0, max_digits_);
}

/// " (joint 'elbow')" for an entry that belongs to joints.
std::string DigitsTally::joints(Eigen::Index row, Eigen::Index column, Eigen::Index size) const {
  const auto n = static_cast<Eigen::Index>(joint_names_.size());
  const bool matrix = result_.quantity == name(Quantity::kM);
  if (!matrix && (size != n || result_.quantity == name(Quantity::kKinetic) ||
                  result_.quantity == name(Quantity::kPotential) ||
                  result_.quantity == name(Quantity::kMomentum)))
    return "";
  if (!matrix || row == column) return fmt::format(" (joint '{}')", joint_names_[row]);
  return fmt::format(" (joints '{}' and '{}')", joint_names_[row], joint_names_[column]);
}

void DigitsTally::add(int state, const MatrixOf<Ball>& answer, const Certified& truth,
                      const Eigen::MatrixXd* bound) {
  if (!truth.exists()) return fail(state, "no certified truth: " + truth.reason);
  if (answer.rows() != truth.value.rows() || answer.cols() != truth.value.cols()) {
    disagreement_ = fmt::format("{} x {} numbers at state {}, expected {} x {}", answer.rows(),
                                answer.cols(), state, truth.value.rows(), truth.value.cols());
    return;
  }
  const BallPrecision precision(std::max(kDistanceBits, truth.bits));
  const Eigen::MatrixXd shape(answer.rows(), answer.cols());
  double size = 0, farthest = -1, fewest_single = max_digits_;
  std::string farthest_entry;
  for (Eigen::Index j = 0; j < answer.cols(); ++j) {
    for (Eigen::Index i = 0; i < answer.rows(); ++i) {
      const Ball& exact = truth.value(i, j);
      const Ball distance = answer(i, j) - exact;
      const double at_most = distance.isFinite() ? distance.atMost()
                                                 : std::numeric_limits<double>::infinity();
      const double at_least = distance.isFinite() ? distance.atLeast() : at_most;
      size = std::max(size, exact.atLeast());
      if (at_most > farthest) {
        farthest = at_most;
        farthest_entry = entryName(result_.quantity, i, j, shape);
      }
      if (!exact.containsZero())
        fewest_single = std::min(fewest_single, digits(at_most, exact.atLeast()));
      if (bound != nullptr)
        judge(state, entryName(result_.quantity, i, j, shape) + joints(i, j, answer.size()), at_least,
              at_most, (*bound)(i, j));
    }
  }
  if (!(size > 0)) return;  // all zero: nothing to count digits of
  const double kept = digits(farthest, size);
  if (by_state_.empty() || kept < result_.worst) {
    result_.worst = kept;
    result_.worst_state = state;
    result_.worst_entry = farthest_entry;
  }
  result_.worst_single =
      by_state_.empty() ? fewest_single : std::min(result_.worst_single, fewest_single);
  by_state_.push_back(kept);
}

void DigitsTally::judge(int state, const std::string& where, double at_least, double at_most,
                        double bound) {
  if (!std::isfinite(bound)) {
    undecided_ = fmt::format("no error bound for {} at state {}: a divisor is zero within rounding",
                             where, state);
    return;
  }
  const double ratio = at_most == 0 ? 0 : at_most / bound;
  if (result_.bound_ratio && !(ratio > *result_.bound_ratio)) return;
  result_.bound_ratio = ratio;
  if (at_least > bound)
    disagreement_ = fmt::format("{} is {:.3g} off at state {}, {:.3g} of its bound {:.3g}", where,
                                at_most, state, ratio, bound);
  else if (at_most > bound)
    undecided_ = fmt::format("{} at state {}: the truth is not sharp enough to tell", where, state);
}

void DigitsTally::fail(int state, const std::string& reason) {
  undecided_ = fmt::format("state {}: {}", state, reason);
}

DigitsResult DigitsTally::result() const {
  DigitsResult out = result_;
  out.states = static_cast<int>(by_state_.size());
  if (!by_state_.empty()) {
    std::vector<double> sorted = by_state_;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t n = sorted.size();
    out.median = (sorted[(n - 1) / 2] + sorted[n / 2]) / 2;
  }
  out.reason = !disagreement_.empty() ? disagreement_ : undecided_;
  if (!disagreement_.empty())
    out.verdict = Verdict::kDisagree;
  else if (!undecided_.empty())
    out.verdict = Verdict::kNotAnswerable;
  else if (out.bound_ratio)
    out.verdict = Verdict::kAgree;
  return out;
}

std::vector<DigitsResult> measureDigits(const scene::Scene& scene,
                                        const std::vector<WitnessKind>& kinds,
                                        const Options& options) {
  std::vector<std::unique_ptr<Witness>> witnesses;
  for (const WitnessKind& kind : kinds) witnesses.push_back(kind.make(scene));
  Setup<float> in_float(
      recursive::buildModel(scene.mechanism, scene::RealNumbers<float>(scene.mechanism)));
  Setup<long double> in_long_double(
      recursive::buildModel(scene.mechanism, scene::RealNumbers<long double>(scene.mechanism)));
  Truth truth(scene.mechanism);

  std::vector<DigitsResult> results;
  const auto runSweep = [&](const Course& course, Quantity quantity, auto algorithm) {
    using Algorithm = decltype(algorithm);
    if (!Algorithm::answers(quantity)) return;
    results.push_back(course.run<Algorithm>(in_float, "float"));
    results.push_back(course.run<Algorithm>(in_long_double, "long double"));
  };
  for (const Quantity quantity : kAllQuantities) {
    const Course course(scene, quantity, options, truth);
    for (const auto& witness : witnesses)
      if (witness->answers(quantity)) results.push_back(course.run(*witness));
    runSweep(course, quantity, NewtonEuler());
    runSweep(course, quantity, CompositeBody());
    runSweep(course, quantity, ArticulatedBody());
  }
  return results;
}

}  // namespace dynwitness::crosscheck
