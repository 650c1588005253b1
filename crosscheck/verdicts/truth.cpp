// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "crosscheck/verdicts/tally.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {
namespace {

/// The smallest double with all its digits: no computation in double resolves what lies below.
constexpr double kSmallestDouble = std::numeric_limits<double>::min();

MatrixX<Ball> evaluate(Setup<Ball>& setup, Quantity quantity, const scene::State<Ball>& state) {
  if (quantity == Quantity::kM) return CompositeBody::answer(setup, quantity, state);
  if (quantity == Quantity::kQdd) return ArticulatedBody::answer(setup, quantity, state);
  return NewtonEuler::answer(setup, quantity, state);
}

bool isFinite(const MatrixX<Ball>& value) {
  for (Eigen::Index k = 0; k < value.size(); ++k)
    if (!value.data()[k].isFinite()) return false;
  return true;
}

/// An enclosure at one precision, and whether a higher one would bring nothing more.
struct Attempt {
  Certified result;
  bool final = false;
  double worst_unsharp = 0;  ///< upper bound of the entries that are not sharp
};

/// Which entries are known well enough.
Attempt judged(Quantity quantity, MatrixX<Ball> value, long accuracy) {
  Attempt out;
  Certified& result = out.result;
  double largest = 0;
  for (Eigen::Index k = 0; k < value.size(); ++k)
    largest = std::max(largest, value.data()[k].atLeast());
  const double negligible = std::ldexp(largest, static_cast<int>(-2 * accuracy));
  const Eigen::MatrixXd shape(value.rows(), value.cols());
  out.final = true;
  for (Eigen::Index j = 0; j < value.cols(); ++j) {
    for (Eigen::Index i = 0; i < value.rows(); ++i) {
      const Ball& x = value(i, j);
      if (x.isSharp(accuracy)) {
        ++result.sharp_entries;
        continue;
      }
      out.worst_unsharp = std::max(out.worst_unsharp, x.atMost());
      if (!(x.atMost() < negligible)) out.final = false;
      if (!result.reason.empty()) continue;
      const std::string entry = entryName(name(quantity), i, j, shape);
      result.reason = x.containsZero()
                          ? fmt::format("{} cannot be told from zero: at {} bits, |{}| < {:.1e}",
                                        entry, BallPrecision::bits(), entry, x.atMost())
                          : fmt::format("{} is known to {} only, at {} bits", entry, x.text(6),
                                        BallPrecision::bits());
    }
  }
  result.value = std::move(value);
  return out;
}

}  // namespace

struct Truth::Impl {
  Impl(const scene::Mechanism& m, long a, long b)
      : mechanism(m), numbers(m), accuracy(a), most_bits(b) {}

  /// The model with its numbers enclosed at the precision of the moment.
  Setup<Ball>& setup() {
    std::unique_ptr<Setup<Ball>>& slot = setups[BallPrecision::bits()];
    if (!slot) slot = std::make_unique<Setup<Ball>>(mechanism, numbers);
    return *slot;
  }

  Attempt attempt(Quantity quantity, const scene::State<double>& state, long bits) {
    const BallPrecision precision(bits);
    MatrixX<Ball> value = evaluate(setup(), quantity, ballState(state, mechanism));
    Attempt out =
        isFinite(value) ? judged(quantity, std::move(value), accuracy) : unbounded(quantity);
    out.result.bits = bits;
    return out;
  }

  /// Why the sweep just run has divided by zero.
  Attempt unbounded(Quantity quantity) {
    const Setup<Ball>& s = setup();
    Attempt out;
    out.result.reason =
        fmt::format("{} is not finite at {} bits", name(quantity), BallPrecision::bits());
    if (quantity != Quantity::kQdd) return out;
    for (int i = static_cast<int>(s.model.links.size()) - 1; i >= 0; --i) {
      int dof = s.model.links[i].dof, end = dof + recursive::axisCount(s.model.links[i].kind);
      while (dof < end && !s.ws.D[dof].containsZero()) ++dof;  // in the order of elimination
      if (dof == end) continue;
      const Ball& D = s.ws.D[dof];
      const std::string joint = mechanism.rateLabels()[dof];
      out.final = D.isZero();
      out.result.is_impossible = D.atMost() < kSmallestDouble;
      out.result.reason = fmt::format(
          "M is singular: joint '{}' moves no inertia while the joints beyond it are free (D {})",
          joint,
          out.final ? "= 0"
                    : fmt::format("< {:.1e} at {} bits", D.atMost(), BallPrecision::bits()));
      break;  // joints further inboard divide by what is not finite
    }
    return out;
  }

  scene::Mechanism mechanism;
  BallNumbers numbers;
  long accuracy, most_bits;
  std::map<long, std::unique_ptr<Setup<Ball>>> setups;  ///< by precision
};

Truth::Truth(const scene::Mechanism& mechanism, long accuracy, long most_bits)
    : impl_(new Impl(mechanism, accuracy, most_bits)) {}
Truth::~Truth() = default;

Certified Truth::operator()(Quantity quantity, const scene::State<double>& state) {
  long bits = 128;
  while (bits < impl_->accuracy + 32) bits *= 2;
  for (;; bits *= 2) {
    Attempt attempt = impl_->attempt(quantity, state, bits);
    if (attempt.final) return std::move(attempt.result);
    if (2 * bits <= impl_->most_bits) continue;
    if (attempt.worst_unsharp > kSmallestDouble) attempt.result.value.resize(0, 0);
    return std::move(attempt.result);
  }
}

}  // namespace dynwitness::crosscheck
