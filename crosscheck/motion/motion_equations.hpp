// SPDX-License-Identifier: GPL-3.0-or-later
// What an integrator knows of a motion.
#pragma once

#include <stdexcept>
#include <vector>

namespace dynwitness::crosscheck {

/** y' = f(y, t) of a mechanism, y = (positions, rates, work), whose last entry feeds nothing back.

    Where rates are the derivatives of positions there are momenta p = M qd as well, and

        q' = M^-1 p,   p' = dL/dq + Q

    is the same motion (Hamilton's equations): what is symplectic there is symplectic. */
template <typename T>
class MotionEquations {
 public:
  using State = std::vector<T>;
  MotionEquations() = default;
  MotionEquations(const MotionEquations&) = delete;
  MotionEquations& operator=(const MotionEquations&) = delete;
  virtual ~MotionEquations() = default;

  virtual int positions() const = 0;
  virtual int dof() const = 0;
  /// @param rate  of the size of y
  virtual void rate(const State& y, T time, State* rate) = 0;
  virtual bool isAutonomous() const { return true; }
  /// What the last entry of y is the integral of [W].
  virtual T power(const State& y, T time) {
    State all(y.size());
    rate(y, time, &all);
    return all.back();
  }

  /** Moves the positions of y as constant rates u do in a time of one: an addition where rates are
      derivatives of positions; for spherical and floating joints, exactly

          R <- R exp(w^),  p <- p + R (1 + (1 - cos a) / a^2 w^ + (a - sin a) / a^3 w^2) v,  a =
          |w| */
  virtual void move(State* y, const State& u) const = 0;
  /// Commutator of rates: of joints of several axes (v_1, w_1), (v_2, w_2) it is (w_1 x v_2 + v_1 x
  /// w_2, w_1 x w_2), of others zero.
  virtual State commutator(const State& u, const State& v) const = 0;

  virtual bool hasMomenta() const { return false; }
  /// p = M qd [n] at y.
  virtual State momentum(const State& /*y*/) { throw std::logic_error("momentum: none"); }
  /// qd = M^-1 p [n] at the positions of y.
  virtual State velocity(const State& /*y*/, const State& /*p*/) {
    throw std::logic_error("velocity: no momenta");
  }
  /// dL/dq + Q [n] at y.
  virtual State pull(const State& /*y*/) { throw std::logic_error("pull: no momenta"); }

  long calls = 0;  ///< of rate(), momentum(), velocity() and pull()
};

}  // namespace dynwitness::crosscheck
