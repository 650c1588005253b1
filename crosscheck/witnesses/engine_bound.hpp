// SPDX-License-Identifier: GPL-3.0-or-later
// How far an outside engine may be from the truth: the error bound of its algorithm, run by us.
#pragma once

#include <memory>

#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

/// By which numbers an engine keeps the orientation of a spherical or a floating joint.
enum class Attitude { kQuaternion, kRotationVector };

/** Bounds for an engine that computes in double, in axes of its own, on the links as they stand in
    the scene. In our axes much is zero by structure: a joint turns about (0, 0, 1), w x I w has no
    component along the axis of a single joint, and running error bounds are zero there. In other
    axes the same numbers are sums of terms that cancel, and each term leaves its rounding. So the
    bound is earned from the sizes of the terms: it belongs to norms of vectors, which are the same
    in all axes.

    The sweeps of inverse dynamics (newton_euler.hpp) are run on pairs (size, error). The size of a
    vector is the norm of what our own sweep computed, or of the sum of terms where it is none of
    the sweep's; the error follows the equations, to first order in u and with the products of
    errors where they are known:

        a + b     errors add; the sum is rounded, u (|a| + |b|)
        a x b     |a| eb + |b| ea + ea eb, and 3 u |a| |b|: two products and a difference an entry
                  leave 2 u (|a_y b_z| + |a_z b_y|), and the norm of these is below
                  sqrt(2) 2 u |a| |b|. The same for a'b, of three products
        R r       three products and two sums an entry: 3 u |r|, as a vector sqrt(3) times that,
                  6 u |r|; an R uncertain by e (its norm) turns r by e |r| more
        R' I R    two products of matrices, 3 u |row| |column| an entry: 2 * 3 sqrt(3) u, 12 u |I|

    What an engine is given is uncertain by as much as it is turned, beside its rounding to double:
    an engine turns three times to pass a joint (its inboard frame, its motion, its outboard frame),
    each a product of matrices, 9 u; and a quarter turn, exact for us, is for it the cosine of a
    rounded angle, 5 u for all of them: 32 u. This is so in world axes, too: there the product of
    all orientations is rounded at each joint, which is exact for a mechanism that is turned by so
    much there. A quaternion is made one of length 1 first (4 u in each component), R is quadratic
    in it (16 u) and sums products of its components (10 u): 26 u more.

    A rotation vector r of length t, rounded to double, turns by the exponential

        R = 1 + a [r]x + b [r]x^2,    a = sin t / t,  b = (1 - cos t) / t^2

    Its rounding turns by t u at most. t is a root of three squares, off by 2.5 u of itself, which
    changes a t by 2.5 u |t cos t - sin t| and cos t by 2.5 u t sin t; sine, quotient and products
    of the second term leave (1 + 1 + sqrt(2)) u |sin t|, the cosine u, difference and quotient
    (1 + 5 + 1 + 1) u of 1 - cos t, the square of [r]x and its products 2 u and u an entry, together
    3 sqrt(2) u of 1 - cos t, and the last sum sqrt(3) u. For t up to pi, and between there and 2 pi
    for what is almost a whole turn (below 25 u there), the sum is largest near t = 2.7: 41 u.
    (The 60 u of solve_bound.hpp hold for both.)

    An axis is a unit vector (4 u), turned by an outboard orientation: 19 u. Inertias in axes of
    their own (rpy) are turned by three orientations on either side. Rates of spherical and floating
    joints are turned into the engine's axes, and its answers back, by the orientation of the joint.

    An engine may refer a link to the scene's link frame or to its joint frame, which differ where
    the placement goes on after the joint (Denavit and Hartenberg's): sizes hold for either, |v| +
    reach |w| and so on. Points' accelerations in place of spatial ones have w x (w x p) in place of
    v x w: both count. A gyroscopic rotor may be a body that turns n times as fast, w = w_p + n z
    qd, whose moment acts n times on the joint: n |w x J w| is counted although nothing of it is
    left when it is exact.

    M is found column by column. qdd leaves no force unexplained but errors: those of M times qdd,
    of the bias, and of the elimination, (3 n + 1) u |L| |D| |L'| (N. Higham, Accuracy and Stability
    of Numerical Algorithms, 2002, theorem 10.4), at most (3 n + 1) u sqrt(M_ii M_jj); a sweep over
    articulated bodies is that elimination, carried out joint by joint. |M^-1| times that, entry by
    entry, bounds qdd; there is no bound where M might be singular within its errors. */
class EngineBound {
 public:
  /// @param matrices  what an orientation loses when it is made of two others, counted in what a
  ///                  product of matrices loses
  explicit EngineBound(const PreparedScene& scene, double matrices = 1,
                       Attitude attitude = Attitude::kQuaternion);
  ~EngineBound();

  /// Shaped like the quantity. The state is exact, or carries bounds of its own.
  Eigen::MatrixXd operator()(Quantity quantity, const scene::State<double>& state);
  Eigen::MatrixXd operator()(Quantity quantity, const scene::State<RunningError>& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dynwitness::crosscheck
