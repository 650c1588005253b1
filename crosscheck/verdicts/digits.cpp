// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/digits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "crosscheck/verdicts/tally.hpp"
#include "crosscheck/verdicts/truth.hpp"
#include "crosscheck/witnesses/column_names.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Wide enough for the distance between an answer and a truth, both of which carry more than 53
/// bits.
constexpr long kDistanceBits = 256;

template <typename Matrix>
MatrixX<Ball> exactly(const Matrix& answer) {
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
  /// @param description  witness, quantity, scalar
  /// @param max_digits   what the scalar has room for
  DigitsTally(Quantity quantity, DigitsResult description,
              const std::vector<std::string>& joint_names, int max_digits, std::uint64_t seed);

  /// An answer, exactly as it is, against the truth; `bounds` are its bounds, if it has any.
  void add(int state, const MatrixX<Ball>& answer, const Certified& truth, const Answer* bounds);
  /// An answer qdd by what it leaves of the equations; its digits are counted by add().
  void judge(int state, const Testimony& said);
  /// The witness could not answer at this state; there is no answer when `is_excused`.
  void fail(int state, const std::string& reason, bool is_excused);

  Quantity quantity() const { return quantity_; }
  DigitsResult digits() const;
  CheckResult check(const scene::Mechanism& mechanism) const;
  /// "M[1,2] (joints 'a' and 'b') at state 3", where the witness lies farthest beyond rounding but
  /// within its documented loss; empty: nowhere.
  const std::string& lossAt() const { return loss_at_; }
  /// The distance there, as a share of the largest entry, and the digits that the rounding of its
  /// algorithm alone would have left.
  double largestLoss() const { return largest_loss_; }
  double digitsWithoutLoss() const { return digits_without_loss_; }

 private:
  /// An entry at a state; size: what shares are counted of.
  struct Place {
    int state;
    std::string entry, joints;
    std::string joint;  ///< whose own the entry is; empty: of none
    double size, ulp;
  };
  /// The answer that is off by the largest share of the largest entry.
  struct Farthest {
    double share = 0;
    Eigen::Index i = 0, j = 0, rows = 0, columns = 0;
    int state = 0;
    double said = 0, right = 0;
  };
  void judge(const Place& at, double at_least, double bound, double loss);
  void closeState(int state);
  double digitsOf(double error, double size) const;
  std::string entry(Eigen::Index row, Eigen::Index column, const Eigen::MatrixXd& shape) const;
  std::string joints(Eigen::Index row, Eigen::Index column) const;
  std::string joint(Eigen::Index row, Eigen::Index column) const;
  CheckResult::Off off(const scene::Mechanism& mechanism) const;
  std::string beyondItsBound(const CheckResult& check) const;

  Quantity quantity_;
  DigitsResult result_;
  CheckResult check_;
  const std::vector<std::string>& joint_names_;
  double max_digits_;
  std::vector<double> by_state_;
  std::string shapes_differ_, worst_at_, loss_at_, unbounded_;
  double largest_loss_ = 0, digits_without_loss_ = 0;
  double largest_there_ = 0;  ///< at the state of the check's ratio
  Farthest farthest_;
};

DigitsTally::DigitsTally(Quantity quantity, DigitsResult description,
                         const std::vector<std::string>& joint_names, int max_digits,
                         std::uint64_t seed)
    : quantity_(quantity),
      result_(std::move(description)),
      joint_names_(joint_names),
      max_digits_(max_digits) {
  check_.kind = CheckKind::kTruth;
  check_.left_is_control = result_.is_control;
  check_.quantity = result_.quantity;
  check_.left = result_.witness;
  check_.statement =
      quantity == Quantity::kQdd
          ? fmt::format("|M qdd + c + g + friction - tau - Q| <= what solving may leave, qdd by {}",
                        result_.witness)
          : fmt::format("|{} by {} - truth| <= its error bound", result_.quantity, result_.witness);
  check_.seed = seed;
}

double DigitsTally::digitsOf(double error, double size) const {
  if (error == 0) return max_digits_;
  return std::clamp(-std::log10(error / size), 0.0, max_digits_);
}

std::string DigitsTally::entry(Eigen::Index row, Eigen::Index column,
                               const Eigen::MatrixXd& shape) const {
  return entryName(result_.quantity, row, column, shape);
}

/// " (joint 'elbow')" for an entry that belongs to joints.
std::string DigitsTally::joints(Eigen::Index row, Eigen::Index column) const {
  if (quantity_ == Quantity::kM && row != column)
    return fmt::format(" (joints '{}' and '{}')", joint_names_[row], joint_names_[column]);
  const std::string own = joint(row, column);
  return own.empty() ? "" : fmt::format(" (joint '{}')", own);
}

/// "elbow" for an entry that is that joint's own.
std::string DigitsTally::joint(Eigen::Index row, Eigen::Index column) const {
  switch (quantity_) {
    case Quantity::kM:
      if (row != column) break;
      [[fallthrough]];
    case Quantity::kc:
    case Quantity::kg:
    case Quantity::kTau:
    case Quantity::kQdd:
      return joint_names_[row];
    case Quantity::kKinetic:
    case Quantity::kPotential:
    case Quantity::kMomentum:
    case Quantity::kReactions:
      break;
  }
  return "";
}

void DigitsTally::add(int state, const MatrixX<Ball>& answer, const Certified& truth,
                      const Answer* bounds) {
  if (!truth.exists())
    return fail(state, "no certified truth: " + truth.reason, truth.is_impossible);
  if (answer.rows() != truth.value.rows() || answer.cols() != truth.value.cols()) {
    shapes_differ_ = fmt::format("{} x {} numbers at state {}, expected {} x {}", answer.rows(),
                                 answer.cols(), state, truth.value.rows(), truth.value.cols());
    return;
  }
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  if (bounds != nullptr) ++check_.states;
  const BallPrecision precision(kDistanceBits);
  const Eigen::MatrixXd shape(answer.rows(), answer.cols());
  double size = 0;
  for (const Ball& exact : truth.value.reshaped()) size = std::max(size, exact.atLeast());
  const double ulp = std::numeric_limits<double>::epsilon() * (size > 0 ? size : 1.0);

  double farthest = -1, fewest_single = max_digits_;
  Eigen::Index farthest_i = 0, farthest_j = 0;
  for (Eigen::Index j = 0; j < answer.cols(); ++j) {
    for (Eigen::Index i = 0; i < answer.rows(); ++i) {
      const Ball& exact = truth.value(i, j);
      const Ball distance = answer(i, j) - exact;
      const double at_most = distance.isFinite() ? distance.atMost() : kInfinite;
      if (at_most > farthest) {
        farthest = at_most;
        farthest_i = i;
        farthest_j = j;
      }
      if (!exact.containsZero())
        fewest_single = std::min(fewest_single, digitsOf(at_most, exact.atLeast()));
      if (bounds == nullptr) continue;
      // what is proven: the distance to the nearest point of the enclosure
      const double at_least = distance.isFinite() ? distance.atLeast() : kInfinite;
      const double loss = bounds->known_loss.size() > 0 ? bounds->known_loss(i, j) : 0;
      judge({state, entry(i, j, shape), joints(i, j), joint(i, j), size, ulp}, at_least,
            bounds->bound(i, j), loss);
    }
  }
  closeState(state);
  if (const double share = farthest / (size > 0 ? size : 1.0); share > farthest_.share) {
    const Ball& exact = truth.value(farthest_i, farthest_j);
    farthest_ = {share,
                 farthest_i,
                 farthest_j,
                 answer.rows(),
                 answer.cols(),
                 state,
                 answer(farthest_i, farthest_j).mid(),
                 exact.containsZero() ? 0 : exact.mid()};
  }
  if (size == 0) return;  // nothing to count digits of
  const double kept = digitsOf(farthest, size);
  if (!result_.worst || kept < *result_.worst) {
    result_.worst = kept;
    result_.worst_state = state;
    result_.worst_entry = entry(farthest_i, farthest_j, shape);
  }
  result_.worst_single = std::min(result_.worst_single.value_or(fewest_single), fewest_single);
  by_state_.push_back(kept);
}

void DigitsTally::judge(int state, const Testimony& said) {
  const Residual& residual = *said.residual;
  ++check_.states;
  check_.condition = std::max(check_.condition.value_or(0), said.condition);
  const Eigen::MatrixXd shape(residual.value.rows(), 1);
  for (Eigen::Index i = 0; i < shape.rows(); ++i) {
    const Ball& r = residual.value(i, 0);
    const double loss = said.answer.residual_loss.size() > 0 ? said.answer.residual_loss(i, 0) : 0;
    judge({state, entry(i, 0, shape), joints(i, 0), joint(i, 0), residual.size,
           std::numeric_limits<double>::epsilon() * residual.size},
          r.isFinite() ? r.atLeast() : std::numeric_limits<double>::infinity(),
          said.answer.residual_bound(i, 0), loss);
  }
  closeState(state);
}

void DigitsTally::judge(const Place& at, double at_least, double bound, double loss) {
  const std::string where = at.entry + at.joints;
  if (!std::isfinite(bound)) {
    if (unbounded_.empty()) unbounded_ = where;
    return;
  }
  const double rounding = bound - loss;
  if (loss > 0 && at_least > rounding && at_least <= bound && at.size > 0 &&
      at_least / at.size > largest_loss_) {
    largest_loss_ = at_least / at.size;
    loss_at_ = fmt::format("{} at state {}", where, at.state);
    digits_without_loss_ = digitsOf(rounding, at.size);
  }
  check_.seen = std::max(check_.seen, at_least);
  check_.loosest = std::max(check_.loosest, bound);
  check_.largest = std::max(check_.largest, at.size);
  const double ratio = at_least == 0 ? 0 : at_least / bound;
  if (ratio > 1 && !at.joint.empty()) addOnce(check_.wrong_joints, at.joint);
  if (!check_.worst_entry.empty() && !(ratio > check_.ratio)) return;
  check_.ratio = ratio;
  largest_there_ = at.size;
  check_.worst = at_least / at.ulp;
  check_.limit = bound / at.ulp;
  check_.worst_state = at.state;
  check_.worst_entry = at.entry;
  worst_at_ = where;
}

/// After the entries of a state: one without a bound voids it.
void DigitsTally::closeState(int state) {
  if (!unbounded_.empty())
    check_.addVoided(
        state,
        fmt::format("no error bound for {} at state {}: a divisor is zero within rounding",
                    unbounded_, state),
        false);
  unbounded_.clear();
}

void DigitsTally::fail(int state, const std::string& reason, bool is_excused) {
  ++check_.states;
  check_.addVoided(state, fmt::format("state {}: {}", state, reason), is_excused);
}

DigitsResult DigitsTally::digits() const {
  DigitsResult out = result_;
  out.states = static_cast<int>(by_state_.size());
  if (!by_state_.empty()) {
    std::vector<double> sorted = by_state_;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t n = sorted.size();
    out.median = (sorted[(n - 1) / 2] + sorted[n / 2]) / 2;
  }
  return out;
}

CheckResult::Off DigitsTally::off(const scene::Mechanism& mechanism) const {
  const Farthest& at = farthest_;
  const std::vector<std::string> units = columnUnits(quantity_, mechanism);
  const auto column = static_cast<std::size_t>(at.i * at.columns + at.j);  // row by row
  return {entryName(result_.quantity, at.i, at.j, at.rows, at.columns),
          joint(at.i, at.j),
          column < units.size() ? units[column] : "",
          at.state,
          at.said,
          at.right};
}

std::string DigitsTally::beyondItsBound(const CheckResult& check) const {
  return fmt::format("{} {} {:.3g} {} {} at state {}, {:.3g} times its bound of {:.3g} {}",
                     worst_at_, check.condition ? "leaves" : "is", check.worst, check.unitName(),
                     check.condition ? "of its equation" : "from the truth", check.worst_state,
                     check.ratio, check.limit, check.unitName());
}

CheckResult DigitsTally::check(const scene::Mechanism& mechanism) const {
  CheckResult out = check_;
  if (!out.worst_entry.empty()) out.useItsOwnUnit(largest_there_);
  out.digits = result_.worst;
  out.known_loss = !loss_at_.empty();
  if (out.ratio > 1 || !shapes_differ_.empty()) {
    out.verdict = Verdict::kDisagree;
    out.reason = shapes_differ_.empty() ? beyondItsBound(out) : shapes_differ_;
    if (farthest_.share > 0) out.off = off(mechanism);
  } else if (out.judged() == 0) {
    out.verdict = Verdict::kNotAnswerable;
    out.reason = out.voided_reason;
  }
  return out;
}

}  // namespace

struct DigitsCount::Impl {
  Impl(const PreparedScene& s, const Options& o)
      : scene(s),
        scene_name(s.scene().name),
        seed(o.seed),
        truth(s.mechanism()),
        in_float(s.mechanism(), scene::RealNumbers<float>(s.mechanism())),
        in_long_double(s.mechanism(), scene::RealNumbers<long double>(s.mechanism())) {
    joint_names = s.mechanism().rateLabels();
  }

  /// The tally of this witness, quantity and scalar; the first answer makes it.
  template <typename T>
  DigitsTally& tally(const std::string& witness, Quantity quantity, Scalar scalar,
                     bool is_control = false) {
    DigitsResult description;
    description.is_control = is_control;
    description.witness = witness;
    description.quantity = crosscheck::name(quantity);
    description.scalar = scalar;
    const auto [at, is_new] =
        place.try_emplace({quantity, witness, scalar, is_control}, tallies.size());
    if (is_new)
      tallies.emplace_back(quantity, description, joint_names, std::numeric_limits<T>::max_digits10,
                           seed);
    return tallies[at->second];
  }

  template <typename Algorithm>
  void runSweep(Quantity quantity, int index, const scene::State<double>& state,
                const Certified& exact) {
    if (!Algorithm::answers(quantity)) return;
    const auto run = [&](auto& setup, auto zero, Scalar scalar) {
      using T = decltype(zero);
      tally<T>(Algorithm::kName, quantity, scalar)
          .add(index, exactly(Algorithm::answer(setup, quantity, stateIn<T>(state))), exact,
               nullptr);
    };
    run(in_float, 0.0f, Scalar::kFloat);
    run(in_long_double, 0.0L, Scalar::kLongDouble);
  }

  /// One a witness: its worst quantity that a documented loss explains.
  std::vector<Finding> losses() const {
    std::vector<Finding> findings;
    for (const DigitsTally& tally : tallies) {
      if (tally.lossAt().empty()) continue;
      const DigitsResult digits = tally.digits();
      Finding finding;
      finding.kind = Finding::Kind::kKnownLoss;
      finding.scene = scene_name;
      finding.quantity = digits.quantity;
      finding.witness = digits.witness;
      finding.digits = digits.worst.value_or(0);
      finding.text = fmt::format(
          "{}: {} keeps {:.1f} digits of {}; {} is off by {:.1e} of the largest {}, where rounding "
          "alone would leave {:.1f} digits",
          scene_name, digits.witness, *finding.digits, digits.quantity, tally.lossAt(),
          tally.largestLoss(),
          tally.quantity() == Quantity::kQdd ? "force in the equations" : "entry",
          tally.digitsWithoutLoss());
      const auto same = std::find_if(findings.begin(), findings.end(), [&](const Finding& f) {
        return f.witness == finding.witness;
      });
      if (same == findings.end())
        findings.push_back(finding);
      else if (*finding.digits < *same->digits)
        *same = finding;
    }
    return findings;
  }

  PreparedScene scene;
  std::string scene_name;
  std::uint64_t seed;
  Truth truth;
  Setup<float> in_float;
  Setup<long double> in_long_double;
  std::vector<std::string> joint_names;
  /// Into tallies, by quantity, witness, scalar and whether the witness is the control.
  std::map<std::tuple<Quantity, std::string, Scalar, bool>, std::size_t> place;
  std::vector<DigitsTally> tallies;
};

DigitsCount::DigitsCount(const PreparedScene& scene, const Options& options)
    : impl_(new Impl(scene, options)) {}
DigitsCount::~DigitsCount() = default;

Certified DigitsCount::truth(Quantity quantity, const scene::State<double>& state) {
  return impl_->truth(quantity, state);
}

void DigitsCount::add(Quantity quantity, int index, const scene::State<double>& state,
                      const std::vector<Testimony>& said, const Certified& exact) {
  for (const Testimony& one : said) {
    DigitsTally& tally =
        impl_->tally<double>(one.witness, quantity, Scalar::kDouble, one.is_control);
    if (!one.failure.empty()) {
      tally.fail(index, one.failure, exact.is_impossible);
    } else if (one.residual && exact.exists()) {
      tally.add(index, exactly(one.answer.value), exact, nullptr);
      tally.judge(index, one);
    } else {
      tally.add(index, exactly(one.answer.value), exact, &one.answer);
    }
  }
  impl_->runSweep<NewtonEuler>(quantity, index, state, exact);
  impl_->runSweep<CompositeBody>(quantity, index, state, exact);
  impl_->runSweep<ArticulatedBody>(quantity, index, state, exact);
}

DigitsFound DigitsCount::found() const {
  DigitsFound out;
  for (const DigitsTally& tally : impl_->tallies) {
    out.digits.push_back(tally.digits());
    if (out.digits.back().scalar != Scalar::kDouble) continue;
    out.checks.push_back(tally.check(impl_->scene.mechanism()));
  }
  out.losses = impl_->losses();
  return out;
}

DigitsFound measureDigits(const PreparedScene& scene, const std::vector<WitnessKind>& kinds,
                          const Options& options) {
  Hearing hearing(scene, kinds, options);
  DigitsCount count(scene, options);
  for (const Quantity quantity : kAllQuantities)
    hearing.hear(quantity, [&](int index, const scene::State<double>& state,
                               const std::vector<Testimony>& said) {
      count.add(quantity, index, state, said, count.truth(quantity, state));
    });
  return count.found();
}

}  // namespace dynwitness::crosscheck
