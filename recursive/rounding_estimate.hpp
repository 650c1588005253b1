// SPDX-License-Identifier: Apache-2.0
// How much of an answer rounding may have made, told from a few numbers a joint.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "recursive/factorization.hpp"
#include "recursive/joint_forces.hpp"

namespace dynwitness::recursive {

template <typename T>
class RoundingFilter;

/** What rounding may have done to an answer of inverseDynamics(), massMatrix() or
    forwardDynamics(), as a share of the answer's largest entry: 1e-16 is all the digits of a
    double, 1e-3 is three digits, 1 or more is none. It takes under a tenth of the sweep's time
    (dynwitness bench: recursive_warned beside recursive).

    An estimate, and no bound: as in a running error analysis every term is counted by its size and
    not by its sign, but sizes of vectors and inertias are a number each, and how the error of one
    joint's acceleration moves the joints outboard of it is left out. It is made to be too large
    rather than too small: what cancels only because axes of joints and of bodies agree is not seen
    (a ball joint as three revolutes at its singular pose keeps digits that this calls lost).

    With a = sqrt(mass) and c = sqrt(trace(I) / 2) of a link about its frame's origin, p_i how far
    that is from the parent's, and w, v, alpha, b sizes of angular velocity, velocity, angular
    acceleration and acceleration, summed up outward joint by joint (b_0 = |gravity|), a link brings

        (1)  e = a b + c alpha,   s = a v + c w
             force  a (e + w s),   moment  c e + s^2                 at least |M a + v x* (M v)|
        (2)  force and moment of p  +=  force,  moment + p_i force  at least what joint i passes on

    so that tau_i is off by some roundings of (2). Articulated inertias are M_A = M - U U'/D, whose
    roundings are of the size of what was subtracted from. In forward dynamics a, c of e in (1) are
    those of the link with all that it carries, a composite body that is stretched out,

        (3)  a_p^2 += a_i^2,  c_p^2 += (c_i + p_i a_i)^2             at least its sqrt(trace(I) / 2)

    and qdd_i is off by roundings of ((2) + |tau_i|) / D_i: where D_i is what is left of numbers
    that are much larger, their ratio is what is lost. By M = L D L', M_ij is off by roundings of
    N_i N_j, N = a of a slide and c of a turn, and the error of qdd is estimated by solving for such
    residuals whose signs are chosen to make it large.

    "Some roundings": a number passes some thirty of them at each joint (differences, turns, shifts;
    crosscheck/witnesses/solve_bound.hpp counts), each uniform up to the unit roundoff u, which is
    sqrt(30 / 3) u as a root mean square.

    @tparam T  float, double, long double
    @see N. Higham, Accuracy and Stability of Numerical Algorithms (2002), section 3.3 (running
      error analysis), section 15.3 (estimates of |M^-1| r by a solution with chosen signs) */
template <typename T>
class RoundingEstimate {
 public:
  /// @param model  of the sweeps; it is read here alone
  /// @param rounded_positions  the positions have been rounded to T from numbers that were meant:
  ///   an angle q is then off by u |q|, and counts as one more rounding of that size
  explicit RoundingEstimate(const Model<T>& model, bool rounded_positions = false)
      : rounded_positions_(rounded_positions),
        gravity_(size(model.gravity)),
        parts_(model.links.size()),
        sizes_(model.links.size() + 1),
        error_(model.dof(), T(0)),
        weight_(error_) {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const LinkModel<T>& link = model.links[i];
      Part& part = parts_[i];
      part.parent = link.parent + 1;
      part.dof = link.dof, part.axes = axisCount(link.kind);
      part.slot = link.slot, part.spring_slot = link.slot + link.spring_from;
      part.kind = link.kind;
      part.ratio = link.follows ? std::abs(link.ratio) : T(1);
      part.pitch = std::abs(link.pitch);
      part.p = part.tree = size(link.X_tree.p);
      part.own.a = std::sqrt(std::abs(link.M.mass));
      // of a gyroscopic rotor h z'w couples to n^2 J: h^2 / (n^2 J) is its J
      const T rotor = link.spin == T(0) ? T(0) : link.spin * link.spin / link.rotor;
      part.own.c = std::sqrt(std::abs(link.M.I.xx + link.M.I.yy + link.M.I.zz) / 2 + rotor);
      part.force = size(link.load.force), part.moment = size(link.load.moment);
      part.stiffness = link.stiffness, part.rest = std::abs(link.rest);
      part.viscous = link.viscous, part.coulomb = std::max(link.positive, link.negative);
      part.is_turn = link.kind == JointKind::kRevolute && !link.follows;
      part.is_passive = link.stiffness != T(0) || part.viscous != T(0) || part.coulomb != T(0);
      part.is_plain = part.is_turn && !part.is_passive;
      moves_apart_ = moves_apart_ || movesApart(part);
    }
    for (const WorldLoad<T>& load : model.world_loads) {
      parts_[load.link].force += size(load.force);
      parts_[load.link].moment += size(load.moment) + size(load.at) * size(load.force);
    }
    for (Part& part : parts_) part.is_loaded = part.force > T(0) || part.moment > T(0);
    least_ = 3 * static_cast<T>(parts_.size()) * kSmallest;  // sqrt(9)
    composeBodies();
  }

  /// Of tau, as inverseDynamics() with these terms has found it for this x, qd and qdd.
  T inverseDynamics(const std::vector<JointPosition<T>>& x, const std::vector<T>& qd,
                    const std::vector<T>& qdd, const std::vector<T>& tau,
                    Terms terms = Terms::all()) {
    return inverseDynamics(x.data(), qd.data(), qdd.data(), tau.data(), terms);
  }
  /// The same of arrays, which are trusted to be as long as there.
  T inverseDynamics(const JointPosition<T>* x, const T* qd, const T* qdd, const T* tau,
                    Terms terms = Terms::all()) {
    start(x);
    outward<false>(qd, qdd, terms);
    T worst = 0;
    inward([&](const Part& part, const T& force, const T& moment) {
      if (part.is_plain)
        keepLarger(moment, &worst);
      else
        for (int k = 0; k < part.axes; ++k)
          keepLarger(felt(part, k, force, moment, x, qd, terms), &worst);
    });
    return share(worst, tau);
  }

  /// Of M, as massMatrix() has found it at x.
  T massMatrix(const std::vector<JointPosition<T>>& x, const MatrixX<T>& M) {
    return massMatrix(x.data(), [&](int i) { return M(i, i); });
  }
  /// The same, told the diagonal of M. @param diagonal  (rate d) -> M_dd
  template <typename Diagonal>
  T massMatrix(const JointPosition<T>* x, const Diagonal& diagonal) {
    start(x);
    T largest = 0;  // no entry of a positive definite matrix is larger than those of its diagonal
    for (std::size_t d = 0; d < error_.size(); ++d)
      keepLarger(diagonal(static_cast<int>(d)), &largest);
    return roundings() * ((largest_N_ * largest_N_ + least_) / largest);
  }

  /** Of qdd, as forwardDynamics() with these terms has found it for this x, qd and tau on this
      workspace.
      @throws std::invalid_argument  joints follow others: what was divided by is not kept there */
  T forwardDynamics(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                    const std::vector<T>& qd, const std::vector<T>& tau, const Workspace<T>& ws,
                    const std::vector<T>& qdd, Terms terms = Terms::all()) {
    requireOwnRates(model, "RoundingEstimate::forwardDynamics");
    return forwardDynamics(
        x.data(), qd.data(), tau.data(), qdd.data(), [&](int d) { return ws.D[d]; },
        [&](int i, int d, int l) { return AnyJoints::force(model.links[i], l, ws.U[d]); }, terms);
  }
  /** The same of any articulated-body sweep.
      @param pivot     (rate d) -> D of articulated_step.hpp, (3)
      @param coupling  (link i, rate d of its joint, axis l of it) -> Z_l' U of that rate */
  template <typename Pivot, typename Coupling>
  T forwardDynamics(const JointPosition<T>* x, const T* qd, const T* tau, const T* qdd,
                    const Pivot& pivot, const Coupling& coupling, Terms terms = Terms::all()) {
    start(x);
    outward<true>(qd, qdd, terms);
    T worst = 0;
    inward([&](const Part& part, const T& force, const T& moment) {
      if (part.is_plain) {
        const int d = part.dof;
        const T D = pivot(d), size = moment + std::abs(tau[d]) + least_ * std::abs(qdd[d]);
        return keepLarger(D > T(0) ? size / D : kNothingLeft, &worst);
      }
      for (int k = part.axes - 1, d = part.dof + k; k >= 0; --k, --d) {
        T size = felt(part, k, force, moment, x, qd, terms) + std::abs(tau[d]) +
                 least_ * std::abs(qdd[d]);
        // what the joint's other axes are off by: they are passed after this one
        for (int l = k + 1; l < part.axes; ++l)
          size += std::abs(coupling(static_cast<int>(&part - parts_.data()), d, l)) *
                  error_[part.dof + l];
        const T D = pivot(d);
        error_[d] = D > T(0) ? size / D : kNothingLeft;
        keepLarger(error_[d], &worst);
      }
    });
    return share(worst, qdd);
  }

  /** Of qdd as the solution of M qdd = tau - (c + g - Q), with M by massMatrix() and the bracket by
      inverseDynamics(), both at this state.
      @param LDL  M as factorize() leaves it */
  T solved(const std::vector<JointPosition<T>>& x, const std::vector<T>& qd,
           const std::vector<T>& tau, const MatrixX<T>& LDL, const std::vector<T>& qdd,
           Terms terms = Terms::all()) {
    start(x.data());
    outward<true>(qd.data(), qdd.data(), terms);
    for (std::size_t d = 0; d < tau.size(); ++d) error_[d] = std::abs(tau[d]);
    inward([&](const Part& part, const T& force, const T& moment) {
      for (int k = 0; k < part.axes; ++k)
        error_[part.dof + k] += felt(part, k, force, moment, x.data(), qd.data(), terms);
    });
    for (Eigen::Index i = 0; i < LDL.rows(); ++i)
      if (!(LDL(i, i) > T(0))) return kNothingLeft;
    solveForLarge(LDL, qdd.data());
    T worst = 0;
    for (const T& error : error_) keepLarger(std::abs(error), &worst);
    return share(worst, qdd.data());
  }

 private:
  template <typename>
  friend class RoundingFilter;  // which bounds the same sums

  /// A body about its frame's origin: sqrt(mass) and sqrt(trace(I) / 2).
  struct Body {
    T a = 0, c = 0;
  };
  struct Part {
    int parent = 0;  ///< place of its sizes: 0 is the world
    int dof, axes, slot, spring_slot;
    JointKind kind;
    bool is_turn;   ///< a revolute joint with a rate of its own ...
    bool is_plain;  ///< ... without spring and friction
    bool is_loaded, is_passive;
    T p, tree;            ///< of the joint from the parent: at this x, and where x is 0
    Body own, composite;  ///< (3)
    T ratio, pitch, force, moment, stiffness, rest, viscous, coulomb;
  };
  struct Moving {
    T w, v, alpha, b;
  };
  struct Sizes {
    T w = 0, v = 0, alpha = 0, b = 0, force = 0, moment = 0;
  };
  static Moving movingOf(const Sizes& at) { return {at.w, at.v, at.alpha, at.b}; }

  static T size(const Vector3<T>& v) { return std::sqrt(v.dot(v)); }
  /// What is not a number is kept.
  static void keepLarger(const T& x, T* worst) {
    if (!(x <= *worst)) *worst = x;
  }
  /// From its parent: what is jointed to the world has a place in nobody's composite body.
  static bool movesApart(const Part& part) {
    return part.parent > 0 &&
           (part.kind == JointKind::kPrismatic || part.kind == JointKind::kHelical ||
            part.kind == JointKind::kFloating);
  }
  static bool isSlide(const Part& part, int k) {
    return part.kind == JointKind::kPrismatic || (part.kind == JointKind::kFloating && k < 3);
  }
  /// Along axis k, of what works on slides and on turns.
  static T alongAxis(const Part& part, int k, const T& slide, const T& turn) {
    if (part.is_turn) return turn;
    if (part.kind == JointKind::kHelical) return part.ratio * (turn + part.pitch * slide);
    return part.ratio * (isSlide(part, k) ? slide : turn);
  }
  T roundings() const { return u_ * std::sqrt(T(kRoundings) / 3); }
  T share(const T& worst, const T* answer) const {
    T largest = 0;
    for (std::size_t d = 0; d < error_.size(); ++d) keepLarger(std::abs(answer[d]), &largest);
    return worst == T(0) ? T(0) : roundings() * (worst / largest);
  }

  /// (3), tips first; in squares until a link is reached.
  void composeBodies() {
    for (Part& part : parts_) part.composite = {part.own.a * part.own.a, part.own.c * part.own.c};
    largest_N_ = 0;
    for (std::size_t i = parts_.size(); i-- > 0;) {
      const Part& part = parts_[i];
      Body& body = parts_[i].composite;
      body = {std::sqrt(body.a), std::sqrt(body.c)};
      for (int k = 0; k < part.axes; ++k)
        keepLarger(alongAxis(part, k, body.a, body.c), &largest_N_);
      if (part.parent == 0) continue;
      Body& parent = parts_[part.parent - 1].composite;
      const T moved = body.c + part.p * body.a;
      parent = {parent.a + body.a * body.a, parent.c + moved * moved};
    }
  }
  /// By how much more than its own size the rounding of a position moves something: an angle q by
  /// |q|, a quaternion whose components are no normal numbers by what it misses of these.
  T roundingOf(const JointPosition<T>* x) const {
    T largest = 0;
    for (const Part& part : parts_) {
      if (part.kind == JointKind::kRevolute || part.kind == JointKind::kHelical)
        keepLarger(std::abs(x[part.slot].q), &largest);
      if (part.axes < 3) continue;
      const int first = part.slot + (part.kind == JointKind::kFloating ? 3 : 0);
      T component = 0;
      for (int k = first; k < first + 4; ++k) keepLarger(std::abs(x[k].q), &component);
      if (component < kSmallest) keepLarger(kSmallest / component, &largest);
    }
    return largest;
  }
  /// Lengths at this x, and what a rounding is.
  void start(const JointPosition<T>* x) {
    u_ = std::numeric_limits<T>::epsilon() / 2;
    if (rounded_positions_) u_ += u_ * roundingOf(x);
    if (!moves_apart_) return;
    for (Part& part : parts_) {
      if (!movesApart(part)) continue;
      const T q = std::abs(x[part.slot].q);
      part.p = part.tree + (part.kind == JointKind::kHelical ? part.pitch * q : q);
      if (part.kind == JointKind::kFloating)
        part.p += std::abs(x[part.slot + 1].q) + std::abs(x[part.slot + 2].q);
    }
    composeBodies();
  }
  /// What a joint adds to its link's motion at these rates.
  static void addSizes(const Part& part, const T* rates, T* slide, T* turn) {
    *slide = *turn = T(0);
    for (int k = 0; k < part.axes; ++k)
      *(isSlide(part, k) ? slide : turn) += part.ratio * std::abs(rates[part.dof + k]);
    if (part.kind == JointKind::kHelical) *slide = part.pitch * *turn;
  }
  /// Motions, and (1). @tparam kComposite  whether it is the body with all that it carries whose
  /// inertia is accelerated
  template <bool kComposite>
  void outward(const T* qd, const T* qdd, Terms terms) {
    Sizes& world = sizes_[0];
    world = Sizes();
    if (terms.gravity) world.b = gravity_;
    Moving of = movingOf(world);  // along a chain it stays in registers
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Part& part = parts_[i];
      if (part.parent != static_cast<int>(i)) of = movingOf(sizes_[part.parent]);
      T turn, turn_2, slide = 0, slide_2 = 0;
      if (part.is_turn) {
        turn = std::abs(qd[part.dof]), turn_2 = std::abs(qdd[part.dof]);
      } else {
        addSizes(part, qd, &slide, &turn);
        addSizes(part, qdd, &slide_2, &turn_2);
      }
      const T w = of.w + turn, v = of.v + (part.p * of.w + slide),
              b = of.b + (part.p * of.alpha + (v * turn + (w * slide + slide_2))),
              alpha = of.alpha + (turn_2 + w * turn);
      of = {w, v, alpha, b};
      const Body &own = part.own, &all = kComposite ? part.composite : part.own;
      const T e = all.a * b + all.c * alpha, s = own.a * v + own.c * w;
      T force = all.a * e + own.a * (w * s), moment = all.c * e + s * s;
      if (part.is_loaded && terms.loads) force += part.force, moment += part.moment;
      sizes_[i + 1] = {w, v, alpha, b, force, moment};
    }
  }
  /// (2). @param visit  (part, force, moment), with all that is outboard
  template <typename Visit>
  void inward(const Visit& visit) {
    T force = 0, moment = 0;  // what the link before hands on to this one
    for (std::size_t i = parts_.size(); i > 0; --i) {
      const Part& part = parts_[i - 1];
      force += sizes_[i].force;
      moment += sizes_[i].moment;
      visit(part, force, moment);
      moment += part.p * force;
      if (part.parent == static_cast<int>(i) - 1) continue;
      sizes_[part.parent].force += force;
      sizes_[part.parent].moment += moment;
      force = moment = T(0);
    }
  }
  /// What axis k has to add up.
  T felt(const Part& part, int k, const T& force, const T& moment, const JointPosition<T>* x,
         const T* qd, Terms terms) const {
    T sum = alongAxis(part, k, force, moment);
    return part.is_passive && k == 0 ? sum + passive(part, x, qd, terms) : sum;
  }
  /// Sizes of a joint's spring and friction.
  static T passive(const Part& part, const JointPosition<T>* x, const T* qd, Terms terms) {
    T sum = 0;
    if (terms.springs && part.stiffness != T(0))
      sum += part.stiffness * (std::abs(x[part.spring_slot].q) + part.rest);
    if (terms.friction) sum += part.viscous * std::abs(qd[part.dof]) + part.coulomb;
    return sum;
  }
  /** error_ becomes the solution of L D L' y = (+-)(error_ + |L| D |L'| |x|), each sign chosen on
      the way so that numbers grow. The second part is what factorizing M and solving for x lose, to
      some roundings a row (Higham, theorem 10.3). */
  void solveForLarge(const MatrixX<T>& LDL, const T* x) {
    const Eigen::Index n = LDL.rows();
    for (Eigen::Index k = 0; k < n; ++k) {
      T sum = std::abs(x[k]);
      for (Eigen::Index j = k + 1; j < n; ++j) sum += std::abs(LDL(j, k) * x[j]);
      weight_[k] = (LDL(k, k) + least_) * sum;
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      T own = error_[i] + weight_[i], carried = 0;
      for (Eigen::Index k = 0; k < i; ++k) {
        own += std::abs(LDL(i, k)) * weight_[k];
        carried -= LDL(i, k) * error_[k];
      }
      error_[i] = carried < T(0) ? carried - own : carried + own;
    }
    for (Eigen::Index i = n; i-- > 0;) {
      error_[i] /= LDL(i, i);
      for (Eigen::Index k = i + 1; k < n; ++k) error_[i] -= LDL(k, i) * error_[k];
    }
  }

  static constexpr int kRoundings = 30;
  /// Of joints without any inertia left: their accelerations are anything.
  static constexpr T kNothingLeft = std::numeric_limits<T>::infinity();
  /// Below it a number is off by as much as there, whatever its size.
  static constexpr T kSmallest = std::numeric_limits<T>::min();
  bool rounded_positions_, moves_apart_ = false;
  T gravity_, u_ = 0, largest_N_ = 0;
  /// Times a rounding, what inertias lose below the smallest normal number: there each of the nine
  /// products of a turn is off as if it were that large, on each link.
  T least_;
  std::vector<Part> parts_;
  std::vector<Sizes> sizes_;       ///< the first is the world's
  std::vector<T> error_, weight_;  ///< one a rate
};

}  // namespace dynwitness::recursive
