// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/digits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "crosscheck/states.hpp"
#include "crosscheck/tally.hpp"
#include "crosscheck/truth.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Wide enough for the distance between an answer and a truth, both of which carry more than 53
/// bits.
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

/// One way of computing one quantity: collects answers state by state.
class DigitsTally {
 public:
  /// @param description  scene, witness, quantity, scalar
  /// @param max_digits   what the scalar has room for
  DigitsTally(DigitsResult description, const scene::Mechanism& mechanism, int max_digits);

  /// An answer, exactly as it is, against the truth; `bound` as in Answer, or none.
  void add(int state, const MatrixOf<Ball>& answer, const Certified& truth,
           const Eigen::MatrixXd* bound);
  /// The witness could not answer at this state.
  void fail(int state, const std::string& reason);

  DigitsResult result() const;

 private:
  double digits(double error, double size) const;
  std::string entry(Eigen::Index row, Eigen::Index column, const Eigen::MatrixXd& shape) const;
  std::string joints(Eigen::Index row, Eigen::Index column) const;
  void judge(int state, const std::string& where, double distance, double bound);

  DigitsResult result_;
  std::vector<std::string> joint_names_;
  double max_digits_;
  std::vector<double> by_state_;
  std::string disagreement_, undecided_;
};

DigitsTally::DigitsTally(DigitsResult description, const scene::Mechanism& mechanism,
                         int max_digits)
    : result_(std::move(description)), max_digits_(max_digits) {
  joint_names_ = mechanism.rateLabels();
}

double DigitsTally::digits(double error, double size) const {
  if (error == 0) return max_digits_;
  return std::clamp(-std::log10(error / size), 0.0, max_digits_);
}

std::string DigitsTally::entry(Eigen::Index row, Eigen::Index column,
                               const Eigen::MatrixXd& shape) const {
  return entryName(result_.quantity, row, column, shape);
}

/// " (joint 'elbow')" for an entry that belongs to joints.
std::string DigitsTally::joints(Eigen::Index row, Eigen::Index column) const {
  switch (quantityNamed(result_.quantity)) {
    case Quantity::kM:
      if (row != column)
        return fmt::format(" (joints '{}' and '{}')", joint_names_[row], joint_names_[column]);
      [[fallthrough]];
    case Quantity::kc:
    case Quantity::kg:
    case Quantity::kTau:
    case Quantity::kQdd:
      return fmt::format(" (joint '{}')", joint_names_[row]);
    case Quantity::kKinetic:
    case Quantity::kPotential:
    case Quantity::kMomentum:
      break;
  }
  return "";
}

void DigitsTally::add(int state, const MatrixOf<Ball>& answer, const Certified& truth,
                      const Eigen::MatrixXd* bound) {
  if (!truth.exists()) return fail(state, "no certified truth: " + truth.reason);
  if (answer.rows() != truth.value.rows() || answer.cols() != truth.value.cols()) {
    disagreement_ = fmt::format("{} x {} numbers at state {}, expected {} x {}", answer.rows(),
                                answer.cols(), state, truth.value.rows(), truth.value.cols());
    return;
  }
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const BallPrecision precision(kDistanceBits);
  const Eigen::MatrixXd shape(answer.rows(), answer.cols());
  double size = 0, farthest = -1, fewest_single = max_digits_;
  std::string farthest_entry;
  for (Eigen::Index j = 0; j < answer.cols(); ++j) {
    for (Eigen::Index i = 0; i < answer.rows(); ++i) {
      const Ball& exact = truth.value(i, j);
      const Ball distance = answer(i, j) - exact;
      const double at_most = distance.isFinite() ? distance.atMost() : kInfinite;
      size = std::max(size, exact.atLeast());
      if (at_most > farthest) {
        farthest = at_most;
        farthest_entry = entry(i, j, shape);
      }
      if (!exact.containsZero())
        fewest_single = std::min(fewest_single, digits(at_most, exact.atLeast()));
      if (bound != nullptr)
        judge(state, entry(i, j, shape) + joints(i, j),
              distance.isFinite() ? distance.atLeast() : kInfinite, (*bound)(i, j));
    }
  }
  if (size == 0) return;  // nothing to count digits of
  const double kept = digits(farthest, size);
  if (!result_.worst || kept < *result_.worst) {
    result_.worst = kept;
    result_.worst_state = state;
    result_.worst_entry = farthest_entry;
  }
  result_.worst_single = std::min(result_.worst_single.value_or(fewest_single), fewest_single);
  by_state_.push_back(kept);
}

/// @param distance  to the nearest point of the enclosure: what is proven
void DigitsTally::judge(int state, const std::string& where, double distance, double bound) {
  if (!std::isfinite(bound)) {
    undecided_ = fmt::format("no error bound for {} at state {}: a divisor is zero within rounding",
                             where, state);
    return;
  }
  const double ratio = distance == 0 ? 0 : distance / bound;
  if (result_.bound_ratio && !(ratio > *result_.bound_ratio)) return;
  result_.bound_ratio = ratio;
  if (distance > bound)
    disagreement_ =
        fmt::format("{} is {:.3g} from the truth at state {}, {:.3g} times its bound {:.3g}", where,
                    distance, state, ratio, bound);
}

void DigitsTally::fail(int state, const std::string& reason) {
  if (undecided_.empty()) undecided_ = fmt::format("state {}: {}", state, reason);
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

std::vector<DigitsResult> measureDigits(const scene::Scene& scene,
                                        const std::vector<WitnessKind>& kinds,
                                        const Options& options) {
  std::vector<std::unique_ptr<Witness>> witnesses;
  for (const WitnessKind& kind : kinds) witnesses.push_back(makeWitness(kind, scene));
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
