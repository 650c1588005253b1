// SPDX-License-Identifier: GPL-3.0-or-later
// What solving M qdd = tau - c - g may leave of the equations: the backward error that a sweep can
// earn.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/prepared_scene.hpp"
#include "crosscheck/witnesses/sharp_bounds.hpp"
#include "crosscheck/witnesses/solved_by.hpp"
#include "recursive/model.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

inline constexpr int kEngineTurns = 3;  ///< of an engine in axes of its own (engine_bound.hpp)

/// The state at which inverse dynamics is asked whether qdd solves the equations.
inline scene::State<double> moving(scene::State<double> state, const Eigen::MatrixXd& qdd) {
  state.qdd.assign(qdd.data(), qdd.data() + qdd.size());
  return state;
}

/** An answer qdd in double is judged by its residual

        r = M qdd + c + g + friction - tau - Q                                                   (1)

    (in balls, so exactly), and not by its distance to the exact qdd: that is r times M^-1, and a
    bound carried through the divisions of a chain grows by a factor at every joint, without any
    digit being lost. Oettli and Prager: qdd solves a system whose numbers differ by as much as the
    limit of r says, and nothing divides by a small number on the way to that limit. It has two
    parts.

    The equations themselves, evaluated at qdd: what inverse dynamics may lose there. Whoever asks
    brings that (running error bounds of our sweep, or EngineBound).

    The elimination. Let  Ic_k = [m 1, -skew(h); skew(h), I]  be the composite inertia of link k and
    all that it carries, in the frame of k. As quadratic forms  0 <= M_A <= Ic  for the articulated
    inertia, whatever is eliminated, so that entries of its blocks are below  a^2, a c, c^2  with

        a_k = sqrt(m),  c_k = sqrt(trace(I) / 2) >= sqrt(|I|)  (no principal moment is above
                                                             the sum of the others)              (2)

    One joint of the sweep rounds, entry by entry and in u times the size of the block:
        M_A - U U'/D                 4     (1/D, two products, the difference; |U_j U_k| / D <= a c)
        turned from both sides       6     a joint; an engine in axes of its own turns `turns` times
        shifted by p                10     (products of p with B and A, at most four a block, and
                                           sums; the block is then of the size of  c + |p| a)
        added to the parent          1
        used: M_A a, U'a, U u / D    9
    A 3 x 3 block whose entries err by e has a norm of at most 3 e. R itself is made of cos and sin,
    each within 2 u, and of fixed numbers; row by row |a c| + |b s| <= 1, in all 8 u in norm (60 u
    where a quaternion gives it: 20 u an entry). It comes in from both sides:

        kInertia = 3 * 24 + (3 * 6 + 2 * 8) turns  [u].                                          (3)

    Of the turns of an engine one alone is the joint's motion, so that a quaternion adds 60 - 8
    once: 2 (8 turns + 52) in place of 2 * 8 turns.

    So what the sweep has computed are the exact articulated inertias of links that err by blocks of
    that size. With the motion (v, w)_ki that a unit rate of joint i gives to the frame of link k,
    and

        N_ki = a_k |v_ki| + (c_k + 2 |p_k| a_k) |w_ki|  (2 |p|: seen from either end)      (4)

    an error of link k is felt at joint i as  N_ki E_k kInertia u,  where E_k is what moves it,

        E_k = a_k |a_k| + (c_k + 2 |p_k| a_k) |alpha_k|,                                         (5)

    a_k and alpha_k being the sums of the magnitudes of what the acceleration of the link at this
    qdd is added up from (that of the parent, the joint's, velocity products). Rounding qdd_k itself
    and the share U u / D of it that is passed on is of the same kind, since |U| / sqrt(D) <= (a,
    c). The sweep's bias wrench p_A differs from the wrench f_k through the joint by M_A a, which
    (5) has, so its rounding adds

        kWrench u (|v_ki| |f_k| + |w_ki| (|m_k| + 2 |p_k| |f_k|)),                               (6)
        kWrench = 2 (9 + (6 + 8) turns)

    (turning a vector: 3 u an entry, below 6 in norm, and R's own 8; products with p, M_A c and the
    sums 9; twice, as every one occurs on the way in and on the way out). By (3) to (6) a sweep
    leaves

        |r_i| <= u sum over k carried by i of  N_ki kInertia E_k + (6).                          (7)

    By M = L D L' (or Cholesky): |dM_ij| <= (3 n + 1) u sqrt(M_ii M_jj) (Higham, theorems 10.3 and
    10.4: |L| D |L'| is below that by Cauchy and Schwarz, with N in place of the root of M_ii), and
    M itself, by composite bodies, errs as in (3) (by columns of inverse dynamics as in (6), on the
    way in and out, which is less), with the wrench of Ic_j Z_j brought down joint by joint:

        |r_i| <= u sum over j of ((3 n + 1) sqrt(M_ii M_jj) + dM_ij) |qdd_j|                     (8)
        dM_ij = kInertia sum over k of N_ki N_kj
              + kWrench sum over joints m from j down to i of
                    N_jj (a_j |v_mi| + (c_j + (|r_mj| + 2 |p_m|) a_j) |w_mi|)                    (9)

    A gyroscopic rotor couples a joint to its parent by h = n J, where D has n^2 J: h^2 / (n^2 J) =
    J is added to c^2, and n sqrt(J), at which the joint's own rate turns the rotor, to N_kk and,
    times that qdd, to E_k: a slide without mass outboard couples by nothing else. A rotor geared to
    several rates does the same with each, sqrt(J) |n_i|, at the link of the rate and at its
    carrier, whose c^2 has J. u^2 is left out: it needs n^3 u of the whole to matter, with n below
    10^4.

    How much of these limits is used is measured in test_backward_error.cpp and written there. */
class SolveBound {
 public:
  /// @param turns     how often a joint is turned: 1 in our sweeps, 3 by an engine in other axes
  /// @param matrices  what an orientation loses, counted in what one made by matrices does
  SolveBound(const PreparedScene& scene, SolvedBy method, int turns, double matrices = 1);

  /// The elimination's part of the limit of r, entry by entry, for this qdd [N m, N].
  Eigen::VectorXd operator()(const scene::State<double>& state, const Eigen::VectorXd& qdd);

  /** Puts the limit into an answer qdd: the elimination's part, and the equations' own, which is
      this bound of tau at that qdd; or |M| times the answer's own bound, where that is less. */
  void judge(const scene::State<double>& state, const Eigen::MatrixXd& bound_of_tau,
             Answer& answer);

  /** The same for a computation of ours, whose every rounding is known: where the limit is wide,
      the smaller of it and of what each rounding does to the residual, to first order.
      @param run   (Computation&) -> qdd on AdjointError
      @param wide  [ulp of the largest force] */
  template <typename Computation, typename Run>
  void judge(const scene::State<double>& state, const Eigen::MatrixXd& bound_of_tau, Answer& answer,
             SharpBounds<Computation>& sharp, const Run& run, double wide = kWideResidual) {
    judge(state, bound_of_tau, answer);
    if (!isWide(answer.residual_bound, wide)) return;
    const Eigen::VectorXd by_roundings = sharp.residual(M_, run);
    if (by_roundings.allFinite())
      answer.residual_bound = answer.residual_bound.cwiseMin(by_roundings);
  }

  /// The bounds of M: the smaller of its running error bounds and (9).
  Eigen::MatrixXd sharper(const MatrixX<RunningError>& M, const scene::State<double>& state);

  /// (9): how far M by composite bodies may be off, entry by entry; symmetric.
  Eigen::MatrixXd massMatrix(const scene::State<double>& state);

 private:
  /// To N: what rates do to rotors that are geared to several.
  void addGearedRotors(std::size_t links);
  void measure(const scene::State<double>& state, const std::vector<double>& qdd);
  Eigen::MatrixXd massMatrix() const;
  /// The sum over m in (9), for rate j of link k.
  void addBroughtDown(int k, int j, Eigen::MatrixXd& out) const;
  bool isWide(const Eigen::MatrixXd& residual_bound, double wide) const;

  PreparedScene scene_;
  const recursive::Model<double>& model_;  ///< of scene_
  recursive::Workspace<double> ws_;
  SolvedBy method_;
  // one a link; then one row a link and one column a rate
  Eigen::VectorXd inertia_, wrench_;  ///< kInertia u, kWrench u
  Eigen::VectorXd a_, c_, p_;
  std::vector<Eigen::Vector3d> origin_;  ///< in world axes
  Eigen::MatrixXd V_, W_, N_, geared_;
  // of the last answer that was judged
  Eigen::MatrixXd M_;
  double force_ = 0;  ///< the largest sum of magnitudes in its equations
};

}  // namespace dynwitness::crosscheck
