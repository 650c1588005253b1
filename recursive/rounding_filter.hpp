// SPDX-License-Identifier: Apache-2.0
// Whether rounding may have taken an answer's digits, decided by sums over joints where they
// suffice.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "recursive/rounding_estimate.hpp"

namespace dynwitness::recursive {

/** RoundingEstimate, asked only where something coarser cannot say that there are digits enough.

    What (1) and (2) of RoundingEstimate add up joint by joint is bounded by sums over all joints
    and by numbers that the state cannot change. With W, A sums of |qd|, |qdd| of turns, S, B those
    of slides, L_i the length of the way to link i from the first joint,

        (1)  w <= W,  v <= L W + S,   alpha <= A + W^2,   b <= |gravity| + L (A + 2 W^2) + 2 W S + B
        (2)  force <= a^2 F + a r E,   moment <= a c F + r^2 E + 2 a^2 S^2
             with r = a L + c,   E = A + 5 W^2,   F = |gravity| + 3 W S + B

    of which the sums over what is outboard of a joint are kept. M^-1 of the matrix roads is bounded
    by |L|, D and the sizes of links, since (|L| D |L'|)_ij <= N_i N_j. Never less than the
    estimate: what passes here would have passed there. Where slides move joints apart, they are
    taken to be out as far as any of them ever was, twice that when it grows.

    @tparam T  float, double
    @see S. Fortune, C. Van Wyk, Efficient exact arithmetic for computational geometry (1993):
      floating-point filters */
template <typename T>
class RoundingFilter {
 public:
  /// @param model       of the sweeps; it is read here alone
  /// @param suspicious  error, as a share of the largest entry, up to which nothing more is asked
  /// @param rounded_positions  as of RoundingEstimate
  RoundingFilter(const Model<T>& model, T suspicious, bool rounded_positions = false)
      : suspicious_(suspicious), estimate_(model, rounded_positions) {
    const std::size_t n = static_cast<std::size_t>(model.dof());
    turn_.resize(n), slide_.resize(n), rotors_.resize(n), size_.resize(n);
    of_links_.resize(n), of_bodies_.resize(n);
    by_F_.resize(n), by_E_.resize(n), by_S_.resize(n), fixed_.resize(n), viscous_.resize(n);
    for (const Part& part : estimate_.parts_) {
      const std::ptrdiff_t i = &part - estimate_.parts_.data();
      const T rotor = part.ratio * std::sqrt(std::abs(model.links[i].rotor));
      if (part.stiffness != T(0))
        springs_.push_back({part.spring_slot, part.dof, part.stiffness, part.rest});
      is_rubbed_ = is_rubbed_ || part.viscous != T(0) || part.coulomb != T(0);
      if (part.axes > 1) of_many_axes_.push_back(static_cast<int>(i));
      if (part.axes == 1) append(part.dof, &of_one_axis_);
      is_loaded_ = is_loaded_ || part.is_loaded;
      for (int k = 0; k < part.axes; ++k) {
        const bool is_slide = Estimate::isSlide(part, k);
        (is_slide ? slide_ : turn_)[part.dof + k] += part.ratio;
        rotors_[part.dof + k] = std::hypot(rotors_[part.dof + k], rotor);
        if (part.kind == JointKind::kHelical) slide_[part.dof] += part.ratio * part.pitch;
      }
    }
    for (std::size_t d = 0; d < n; ++d) {
      const int rate = static_cast<int>(d);
      if (turn_[d] == T(1) && slide_[d] == T(0))
        append(rate, &plain_turns_);
      else
        others_.push_back(rate);
    }
    is_plain_ =
        others_.empty() && of_many_axes_.empty() && springs_.empty() && !is_loaded_ && !is_rubbed_;
    compose();
  }

  /// Of tau: at most `suspicious`, or as RoundingEstimate::inverseDynamics().
  T inverseDynamics(const JointPosition<T>* x, const T* qd, const T* qdd, const T* tau,
                    Terms terms = Terms::all()) {
    reach(x);
    T largest;
    const Sums s = sums(qd, qdd, tau, terms, &largest);
    T worst = largest_.F * s.F + largest_.E * s.E;
    if (!is_plain_)
      worst += largest_.S * s.S_2 + largest_.own + largest_viscous_ * s.R + springs(x);
    const T coarse = share(worst, largest, x);
    if (coarse <= suspicious_) return coarse;
    return estimate_.inverseDynamics(x, qd, qdd, tau, terms);
  }

  /** Of qdd by an articulated-body sweep: at most `suspicious`, or as
      RoundingEstimate::forwardDynamics().
      @param inverse_pivot  (rate d) -> 1 / D of articulated_step.hpp, (3)
      @param coupling       (link i, rate d of its joint, axis l of it) -> Z_l' U of that rate */
  template <typename InversePivot, typename Coupling>
  T forwardDynamics(const JointPosition<T>* x, const T* qd, const T* tau, const T* qdd,
                    const InversePivot& inverse_pivot, const Coupling& coupling,
                    Terms terms = Terms::all()) {
    reach(x);
    T largest, worst = 0;
    Sums s = sums(qd, qdd, qdd, terms, &largest);
    s.least = estimate_.least_ * largest;
    if (is_plain_) {
      for (int d = 0, n = static_cast<int>(size_.size()); d < n; ++d)
        Estimate::keepLarger(divided(plainlyFelt(s, d, tau), inverse_pivot(d)), &worst);
    } else {
      felt(s, x, qd, tau);
      for (const Range& range : of_one_axis_)
        for (int d = range.begin; d < range.end; ++d)
          Estimate::keepLarger(divided(size_[d], inverse_pivot(d)), &worst);
    }
    for (const int i : of_many_axes_) {  // as in RoundingEstimate
      const Part& part = estimate_.parts_[i];
      for (int k = part.axes - 1, d = part.dof + k; k >= 0; --k, --d) {
        T size = size_[d];
        for (int l = k + 1; l < part.axes; ++l)
          size += std::abs(coupling(i, d, l)) * size_[part.dof + l];
        size_[d] = divided(size, inverse_pivot(d));
        Estimate::keepLarger(size_[d], &worst);
      }
    }
    const T coarse = share(worst, largest, x);
    if (coarse <= suspicious_) return coarse;
    return estimate_.forwardDynamics(
        x, qd, tau, qdd, [&](int d) { return T(1) / inverse_pivot(d); }, coupling, terms);
  }
  /// The same of recursive::forwardDynamics() on this workspace.
  /// @throws std::invalid_argument  joints follow others
  T forwardDynamics(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                    const std::vector<T>& qd, const std::vector<T>& tau, const Workspace<T>& ws,
                    const std::vector<T>& qdd, Terms terms = Terms::all()) {
    requireOwnRates(model, "RoundingFilter::forwardDynamics");
    return forwardDynamics(
        x.data(), qd.data(), tau.data(), qdd.data(), [&](int d) { return T(1) / ws.D[d]; },
        [&](int i, int d, int l) { return AnyJoints::force(model.links[i], l, ws.U[d]); }, terms);
  }

  /// Of qdd by M = L D L': at most `suspicious`, or as RoundingEstimate::solved().
  T solved(const std::vector<JointPosition<T>>& x, const std::vector<T>& qd,
           const std::vector<T>& tau, const MatrixX<T>& LDL, const std::vector<T>& qdd,
           Terms terms = Terms::all()) {
    reach(x.data());
    T largest;
    felt(sums(qd.data(), qdd.data(), qdd.data(), terms, &largest), x.data(), qd.data(), tau.data());
    const Eigen::Index n = LDL.rows();
    T moved = 0;
    for (Eigen::Index j = 0; j < n; ++j) moved += of_bodies_[j].N * std::abs(qdd[j]);
    for (Eigen::Index i = 0; i < n; ++i) size_[i] += of_bodies_[i].N * moved;
    T worst = 0;
    for (Eigen::Index k = 0; k < n; ++k)  // by columns, as Eigen keeps them
      for (Eigen::Index i = k + 1; i < n; ++i) size_[i] += std::abs(LDL(i, k)) * size_[k];
    for (Eigen::Index k = n; k-- > 0;) {
      T y = divided(size_[k], T(1) / LDL(k, k));
      for (Eigen::Index i = k + 1; i < n; ++i) y += std::abs(LDL(i, k)) * size_[i];
      size_[k] = y;
      Estimate::keepLarger(y, &worst);
    }
    const T coarse = share(worst, largest, x.data());
    return coarse <= suspicious_ ? coarse : estimate_.solved(x, qd, tau, LDL, qdd, terms);
  }

  /// Of M as RoundingEstimate::massMatrix(), which is a comparison a rate.
  template <typename Diagonal>
  T massMatrix(const JointPosition<T>* x, const Diagonal& diagonal) {
    return estimate_.massMatrix(x, diagonal);
  }

 private:
  using Estimate = RoundingEstimate<T>;
  using Part = typename Estimate::Part;
  using Body = typename Estimate::Body;
  /// What F, E and S^2 of (2) are multiplied by, what loads add, and N of an axis.
  struct Felt {
    T F = 0, E = 0, S = 0, own = 0, N = 0;
  };
  /// R: of |qd|; least: what no entry of an answer is known better than, times 1 / second.
  struct Sums {
    T F, E, S_2, R, least;
  };
  struct Spring {
    int slot, rate;
    T stiffness, rest;
  };
  struct Range {
    int begin, end;
  };
  static void append(int rate, std::vector<Range>* ranges) {
    if (!ranges->empty() && ranges->back().end == rate)
      ++ranges->back().end;
    else
      ranges->push_back({rate, rate + 1});
  }

  /// @param largest  becomes the largest entry of the answer
  Sums sums(const T* qd, const T* qdd, const T* answer, Terms terms, T* largest) const {
    const int n = static_cast<int>(size_.size());
    const T gravity = terms.gravity ? estimate_.gravity_ : T(0);
    T W = 0, A = 0, S = 0, B = 0, R = 0, most = 0;
    if (is_plain_) {
      for (int d = 0; d < n; ++d) {
        W += std::abs(qd[d]), A += std::abs(qdd[d]);
        most = std::max(most, std::abs(answer[d]));
      }
      *largest = most;
      return {gravity, A + 5 * W * W, T(0), W, T(0)};
    }
    for (int d = 0; d < n; ++d) most = std::max(most, std::abs(answer[d]));
    *largest = most;
    for (const Range& range : plain_turns_)
      for (int d = range.begin; d < range.end; ++d) W += std::abs(qd[d]), A += std::abs(qdd[d]);
    R = W;
    for (const int d : others_) {
      const T rate = std::abs(qd[d]), change = std::abs(qdd[d]);
      R += rate;
      W += turn_[d] * rate, S += slide_[d] * rate;
      A += turn_[d] * change, B += slide_[d] * change;
    }
    return {gravity + (3 * W * S + B), A + 5 * W * W, S * S, R, T(0)};
  }
  static T divided(const T& size, const T& inverse_pivot) {
    return inverse_pivot > T(0) ? size * inverse_pivot : Estimate::kNothingLeft;
  }
  T roundings(const JointPosition<T>* x) const {
    return estimate_.rounded_positions_ ? roundings_ * (1 + estimate_.roundingOf(x)) : roundings_;
  }
  T share(const T& worst, const T& largest, const JointPosition<T>* x) const {
    return worst == T(0) ? T(0) : roundings(x) * (worst / largest);
  }
  T springs(const JointPosition<T>* x) const {
    T sum = 0;
    for (const Spring& k : springs_) sum += k.stiffness * std::abs(x[k.slot].q);
    return sum;
  }
  /// What an axis adds up in forward dynamics where all turn plainly.
  T plainlyFelt(const Sums& s, int d, const T* tau) const {
    return by_F_[d] * s.F + by_E_[d] * s.E + std::abs(tau[d]) + s.least;
  }
  /// The same of any, into size_.
  void felt(const Sums& s, const JointPosition<T>* x, const T* qd, const T* tau) {
    T* const size = size_.data();
    const int n = static_cast<int>(size_.size());
    if (is_plain_) {
      for (int d = 0; d < n; ++d) size[d] = plainlyFelt(s, d, tau);
      return;
    }
    const T *const by_S = by_S_.data(), *const fixed = fixed_.data(), *const b = viscous_.data();
    for (int d = 0; d < n; ++d)
      size[d] = plainlyFelt(s, d, tau) + by_S[d] * s.S_2 + fixed[d] + b[d] * std::abs(qd[d]);
    for (const Spring& k : springs_) size[k.rate] += k.stiffness * std::abs(x[k.slot].q);
  }

  /// Slides that are out farther than was thought of.
  void reach(const JointPosition<T>* x) {
    if (!estimate_.moves_apart_) return;
    T farthest = 0;
    for (const Part& part : estimate_.parts_)
      if (Estimate::movesApart(part))
        for (int k = 0; k < (part.kind == JointKind::kFloating ? 3 : 1); ++k)
          Estimate::keepLarger(std::abs(x[part.slot + k].q), &farthest);
    if (farthest <= reach_) return;
    reach_ = 2 * farthest;
    compose();
  }

  /// (2), of links and of bodies with all that they carry.
  void compose() {
    const std::vector<Part>& parts = estimate_.parts_;
    std::vector<T> p(parts.size()), way(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Part& part = parts[i];
      p[i] = part.tree;
      if (Estimate::movesApart(part))
        p[i] += reach_ * (part.kind == JointKind::kHelical    ? part.pitch
                          : part.kind == JointKind::kFloating ? T(3)
                                                              : T(1));
      way[i] = part.parent > 0 ? way[part.parent - 1] + p[i] : T(0);
    }
    std::vector<Body> own, all;
    for (const Part& part : parts) own.push_back(part.own);
    all = own;
    for (std::size_t i = parts.size(); i-- > 0;) {
      if (parts[i].parent == 0) continue;
      Body& parent = all[parts[i].parent - 1];
      parent = {std::hypot(parent.a, all[i].a), std::hypot(parent.c, all[i].c + p[i] * all[i].a)};
    }
    feltBy(own, p, way, &of_links_);
    feltBy(all, p, way, &of_bodies_);
    for (std::size_t d = 0; d < rotors_.size(); ++d)
      of_bodies_[d].N = std::hypot(of_bodies_[d].N, rotors_[d]) + std::sqrt(estimate_.least_);
    largest_ = {};
    for (const Felt& k : of_links_) {
      largest_ = {std::max(largest_.F, k.F), std::max(largest_.E, k.E), std::max(largest_.S, k.S),
                  std::max(largest_.own, k.own), T(0)};
    }
    std::fill(viscous_.begin(), viscous_.end(), T(0));
    for (const Part& part : estimate_.parts_) {
      if (!part.is_passive) continue;
      largest_.own += part.coulomb;
      largest_viscous_ = std::max(largest_viscous_, part.viscous);
      of_bodies_[part.dof].own += part.coulomb;
      viscous_[part.dof] += part.viscous;
    }
    for (std::size_t d = 0; d < by_F_.size(); ++d) {
      by_F_[d] = of_bodies_[d].F, by_E_[d] = of_bodies_[d].E;
      by_S_[d] = of_bodies_[d].S, fixed_[d] = of_bodies_[d].own;
    }
    for (const Spring& k : springs_) {
      largest_.own += k.stiffness * k.rest;
      fixed_[k.rate] += k.stiffness * k.rest;
    }
    roundings_ = std::numeric_limits<T>::epsilon() / 2 * std::sqrt(T(Estimate::kRoundings) / 3);
  }
  void feltBy(const std::vector<Body>& bodies, const std::vector<T>& p, const std::vector<T>& way,
              std::vector<Felt>* of_axes) const {
    const std::vector<Part>& parts = estimate_.parts_;
    std::vector<Felt> force(parts.size()), moment(parts.size());
    std::fill(of_axes->begin(), of_axes->end(), Felt());
    for (std::size_t i = parts.size(); i-- > 0;) {
      const Part& part = parts[i];
      const T a = bodies[i].a, c = bodies[i].c, r = a * way[i] + c;
      Felt &f = force[i], &m = moment[i];
      f.F += a * a, f.E += a * r, f.own += part.force;
      m.F += a * c, m.E += r * r, m.S += 2 * a * a, m.own += part.moment;
      for (int k = 0; k < part.axes; ++k) {
        const auto along = [&](const T& slide, const T& turn) {
          return Estimate::alongAxis(part, k, slide, turn);
        };
        Felt& to = (*of_axes)[part.dof + k];  // which followers share
        to = {to.F + along(f.F, m.F), to.E + along(f.E, m.E), to.S + along(f.S, m.S),
              to.own + along(f.own, m.own), to.N + along(a, c)};
      }
      if (part.parent == 0) continue;
      // r^2 has in it what forces a r do from as far as the first joint
      Felt &to_f = force[part.parent - 1], &to_m = moment[part.parent - 1];
      to_f = {to_f.F + f.F, to_f.E + f.E, to_f.S + f.S, to_f.own + f.own, T(0)};
      to_m = {to_m.F + m.F + p[i] * f.F, to_m.E + m.E, to_m.S + m.S,
              to_m.own + m.own + p[i] * f.own, T(0)};
    }
  }

  T suspicious_;
  Estimate estimate_;
  bool is_plain_, is_loaded_ = false,
                  is_rubbed_ = false;  ///< turns alone, each of a rate of its own, ...
  T reach_ = 0, roundings_ = 0;
  std::vector<Range> plain_turns_, of_one_axis_;  ///< of rates
  std::vector<int> others_;                       ///< rates that are no plain turns
  std::vector<int> of_many_axes_;                 ///< places of joints
  std::vector<T> turn_, slide_;                   ///< how much of a rate turns, and slides
  std::vector<T> rotors_;                         ///< sqrt(n^2 J) of a rate
  std::vector<Felt> of_links_, of_bodies_;        ///< one an axis
  Felt largest_;                                  ///< of of_links_
  std::vector<Spring> springs_;
  std::vector<T> by_F_, by_E_, by_S_;  ///< F, E and S of of_bodies_, each together
  std::vector<T> fixed_;               ///< of a rate: loads, Coulomb friction, springs where q is 0
  std::vector<T> viscous_;             ///< of a rate
  T largest_viscous_ = 0;
  std::vector<T> size_;  ///< one a rate
};

}  // namespace dynwitness::recursive
