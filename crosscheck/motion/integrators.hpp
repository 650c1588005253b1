// SPDX-License-Identifier: GPL-3.0-or-later
// All integrators, once: those of Boost.odeint and ours, in steps of a given length.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "crosscheck/motion/motion_equations.hpp"

namespace dynwitness::crosscheck {

/// Whether a step keeps dq ^ dp: then energy swings about its value and does not run away.
enum class Symplectic { kNo, kWhereMIsConstant, kYes };
/// "no", "where M is constant", "yes"
const char* name(Symplectic symplectic);

struct Integrator {
  const char* name;  ///< "runge_kutta4"
  int order;         ///< of the error of a path
  Symplectic symplectic;
  /** Largest h |lambda| at which y' = lambda y does not grow, with lambda on the imaginary and on
      the negative real axis. Infinity: any; 0: none. What has momenta is taken as an oscillator
      with a damper. */
  double imaginary_limit, real_limit;
  bool needs_momenta;  ///< knows only joints whose rates are derivatives of their positions
  bool remembers;      ///< goes on from earlier steps: of equal length, and of a y nobody moved
};

const std::vector<Integrator>& integrators();
/// @throws scene::InputError  none is called so; it lists them
const Integrator& integratorNamed(const std::string& name);
/// "euler (order 1), ..."
std::string integratorNames();
/// One line an integrator: name, order, symplectic, limits.
std::string integratorTable();

/** One integrator on one motion.

    Boost.odeint: euler; modified_midpoint; runge_kutta4; runge_kutta_dopri5;
    runge_kutta_fehlberg78 (goes on with its order 8); bulirsch_stoer8 (the modified midpoint with
    2, 4, 6, 8 parts, extrapolated); rosenbrock4 (Jacobian by central differences);
    adams_bashforth_moulton4.

    Ours, h the step, q + v standing for MotionEquations::move:
        semi_implicit_euler  v_1 = v_0 + h qdd(q_0, v_0),  q_1 = q_0 + h v_1
        stormer_verlet       discrete Euler-Lagrange equations of
                             L_d = h (L(q_0, v) + L(q_1, v)) / 2,  v = (q_1 - q_0) / h:
                             p_0 = (M(q_0) + M(q_1)) v / 2 - h/2 (dL/dq + Q)(q_0, v),
                             p_1 = (M(q_0) + M(q_1)) v / 2 + h/2 (dL/dq + Q)(q_1, v)
        implicit_midpoint, gauss_4, gauss_6    collocation at Gauss's nodes, of Hamilton's equations
                             where there are momenta
        implicit_euler, radau_iia_3, radau_iia_5   at Radau's
        lie_runge_kutta4     Munthe-Kaas: the classical stages for u in q = q_0 exp(u),
                             u' = v + [u, v] / 2 + [u, [u, v]] / 12: quaternions keep their length
    @see E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration (2006), VI.6 (Verlet),
    II.1
      (collocation), IV.8 (Lie groups);
         J. E. Marsden, M. West, Acta Numerica 10 (2001) 357-514 */
template <typename T>
class Steps {
 public:
  using State = std::vector<T>;
  Steps() = default;
  Steps(const Steps&) = delete;
  Steps& operator=(const Steps&) = delete;
  virtual ~Steps() = default;
  /// @throws std::runtime_error  equations of an implicit step have no solution that is found
  virtual void step(State* y, T time, T h) = 0;
  /// y was moved by somebody else: what was kept of earlier steps does not go on from it.
  virtual void forget() {}
};

/// @throws scene::InputError  no integrator of this name, or one that these equations are not for
template <typename T>
std::unique_ptr<Steps<T>> stepsOf(const std::string& name, MotionEquations<T>& equations);

/// df/dy at y by central differences, the last column zero; costs two calls a column.
template <typename T>
std::vector<std::vector<T>> columnsOfJacobian(MotionEquations<T>& equations,
                                              const std::vector<T>& y, T time);

/** How much a step of length 1 makes of  y'' = -|z|^2 y + 2 Re z y',  whose eigenvalues are z and
    its conjugate: the largest |eigenvalue| of the step (for steps that remember others, the growth
    a step in the long run). @param re  not positive */
double amplification(const std::string& integrator, double re, double im);

}  // namespace dynwitness::crosscheck
