// SPDX-License-Identifier: GPL-3.0-or-later
// Motions over time: what a step does to a motion that should neither grow nor fade.
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>

#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/tree_motion.hpp"
#include "crosscheck/stability/family.hpp"
#include "crosscheck/stability/make_case.hpp"

namespace dynwitness::crosscheck::stability {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr const char* kEigenvalue =
    "the largest eigenvalue of a step or period, which should be 1 in size";

/// Position and rate, and the acceleration at a time.
using Acceleration = std::function<double(double t, double q, double qd)>;
using Stepper = std::function<Vector2d(const Acceleration&, double t, const Vector2d& x, double h)>;

Vector2d explicitEuler(const Acceleration& a, double t, const Vector2d& x, double h) {
  return {x(0) + h * x(1), x(1) + h * a(t, x(0), x(1))};
}
Vector2d semiImplicitEuler(const Acceleration& a, double t, const Vector2d& x, double h) {
  const double v = x(1) + h * a(t, x(0), x(1));
  return {x(0) + h * v, v};
}
Vector2d verlet(const Acceleration& a, double t, const Vector2d& x, double h) {
  const double v = x(1) + h / 2 * a(t, x(0), x(1)), q = x(0) + h * v;
  return {q, v + h / 2 * a(t + h, q, v)};
}
Vector2d rungeKutta4(const Acceleration& a, double t, const Vector2d& x, double h) {
  const auto f = [&](double at, const Vector2d& y) { return Vector2d(y(1), a(at, y(0), y(1))); };
  const Vector2d k1 = f(t, x), k2 = f(t + h / 2, x + h / 2 * k1), k3 = f(t + h / 2, x + h / 2 * k2),
                 k4 = f(t + h, x + h * k3);
  return x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
}
/// Of an acceleration that is linear in q and does not depend on qd: one equation in the new rate.
Vector2d implicitMidpoint(const Acceleration& a, double t, const Vector2d& x, double h) {
  const double at = t + h / 2, here = a(at, x(0), 0), slope = a(at, x(0) + 1, 0) - here;
  // v = w + h a(x + h (w + v) / 4)
  const double v = (x(1) + h * (here + slope * h / 4 * x(1))) / (1 - h * h / 4 * slope);
  return {x(0) + h / 2 * (x(1) + v), v};
}

/// Largest |eigenvalue| of what `steps` steps from time 0 do to small motions about rest.
double spectralRadius(const Stepper& step, const Acceleration& a, double h, int steps) {
  const double small = std::ldexp(1.0, -30);  // linear: the square of it is below rounding
  Matrix2d map;
  for (int column = 0; column < 2; ++column) {
    Vector2d x = Vector2d::Unit(column) * small;
    for (int k = 0; k < steps; ++k) x = step(a, k * h, x, h);
    map.col(column) = x / small;
  }
  if (!map.allFinite()) return HUGE_VAL;
  return map.eigenvalues().cwiseAbs().maxCoeff();
}

std::shared_ptr<Witness> sweepsOf(const scene::Scene& scene) {
  return selectWitnesses({"fast"}).front().make(PreparedScene(scene)).value();
}

/// A mass of 1 kg on a spring of 1 N/m: omega = 1 rad/s, so that h omega = h.
Acceleration springAcceleration() {
  LinkWords mass;
  mass.joint = scene::JointKind::kPrismatic, mass.mass = "1";
  Case given = caseOf("stiff_spring", {mass}, noGravity(), {0}, {}, {});
  given.scene.mechanism.links[1].joint.stiffness = scene::Number(1);
  const auto witness = sweepsOf(given.scene);
  const auto state = std::make_shared<scene::State<double>>(given.state);
  return [witness, state](double, double q, double qd) {
    state->x[0] = scene::jointPosition(q);
    state->qd[0] = qd;
    return witness->value(Quantity::kQdd, *state)(0, 0);
  };
}

Measure onSpring(const std::string& name, const Stepper& step, const std::string& formula,
                 const std::function<double(double)>& radius) {
  return {
      name, formula, [radius](double z) { return std::abs(radius(z) - 1); },
      [step](double z) { return std::abs(spectralRadius(step, springAcceleration(), z, 1) - 1); }};
}

/// |eigenvalue| of a map of determinant 1 and this trace.
double ofTrace(double trace) {
  const double half = std::abs(trace) / 2;
  return half <= 1 ? 1 : half + std::sqrt(half * half - 1);
}

Family stiffSpring() {
  using Complex = std::complex<double>;
  Family f;
  f.name = "stiff_spring";
  f.title = "A stiff spring and one step";
  f.dial = "h omega, step times natural frequency";
  f.from = 0.01, f.to = 1000;
  f.narrow = 1.001;
  f.measured = kEigenvalue;
  const auto symplectic = [](double z) { return ofTrace(2 - z * z); };
  f.measures = {
      onSpring("explicit_euler", explicitEuler, "|1 + i z| = (1 + z^2)^(1/2): grows at every step",
               [](double z) { return std::abs(Complex(1, z)); }),
      onSpring("runge_kutta4", rungeKutta4,
               "|1 + iz - z^2/2 - i z^3/6 + z^4/24|: fades, and grows from z = 8^(1/2) on",
               [](double z) {
                 const double z2 = z * z;
                 return std::abs(Complex(1 - z2 / 2 + z2 * z2 / 24, z - z2 * z / 6));
               }),
      onSpring("semi_implicit_euler", semiImplicitEuler,
               "trace 2 - z^2, determinant 1: both eigenvalues on the circle up to z = 2",
               symplectic),
      onSpring("verlet", verlet, "the same trace: z = 2", symplectic),
      onSpring("implicit_midpoint", implicitMidpoint, "|(1 + iz/2) / (1 - iz/2)| = 1 for every z",
               [](double) { return 1.0; })};
  f.mechanism =
      "A spring's motion neither grows nor fades: the step's largest eigenvalue should be 1 in "
      "size. Whoever takes the force of the old position alone overshoots: explicit Euler always, "
      "a method of order four a little, until z = 8^(1/2); a symplectic one not at all, until "
      "half a turn fits into one step, z = 2, where it fails at once.";
  f.survivor =
      "The implicit midpoint rule: it turns by the wrong angle where z is large, and never grows.";
  return f;
}

/// A pendulum on a pivot that moves up and down by a cos(omega t), near its upright pose.
/// Amplitude a over length l.
constexpr double kShake = 0.5, kLength = 1, kGravityNumber = 9.81;

/// The pendulum's angle from upright, by the sweeps: the pivot's acceleration is given.
Acceleration kapitzaAcceleration(double omega) {
  LinkWords pivot, pole;
  pivot.joint = scene::JointKind::kPrismatic, pivot.mass = "1";
  pole.parent = 1, pole.axis = {"0", "1", "0"}, pole.mass = "1", pole.com = {"0", "0", "1"};
  const Case given = caseOf("kapitza", {pivot, pole}, gravityDown(), {0, 0}, {}, {});
  const auto witness = sweepsOf(given.scene);
  const auto state = std::make_shared<scene::State<double>>(given.state);
  return [witness, state, omega](double t, double q, double qd) {
    const double phase = omega * t, speed = kShake * kLength * omega;
    state->x = {scene::jointPosition(kShake * kLength * std::cos(phase)), scene::jointPosition(q)};
    state->qd = {-speed * std::sin(phase), qd};
    state->qdd = {-speed * omega * std::cos(phase), 0};
    const double force = witness->value(Quantity::kTau, *state)(1, 0);
    return -force / witness->value(Quantity::kM, *state)(1, 1);
  };
}

/// Mathieu's characteristic number a_0(Q) of even solutions of y'' + (A - 2 Q cos 2 tau) y = 0:
/// least eigenvalue of the tridiagonal matrix of its Fourier series.
double mathieu0(double Q) {
  constexpr int kTerms = 24;  // coefficients fall faster than (Q / 4k^2)^k
  Eigen::MatrixXd hill = Eigen::MatrixXd::Zero(kTerms, kTerms);
  for (int k = 0; k < kTerms; ++k) {
    hill(k, k) = 4.0 * k * k;
    if (k > 0) hill(k, k - 1) = hill(k - 1, k) = k == 1 ? std::sqrt(2.0) * Q : Q;
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(hill).eigenvalues()(0);
}

Family kapitza() {
  Family f;
  f.name = "kapitza";
  f.title = "Kapitza's pendulum, upright on a shaken pivot";
  f.dial = "(2 g l)^(1/2) over the speed a omega of the shaken pivot (a = l / 2)";
  f.from = 0.55, f.to = 2;
  f.measured = kEigenvalue;
  f.narrow = 1.001;
  // A = -4 g / (l omega^2) = a_0(Q), Q = 2 a / l; s = l / a (-A / 2)^(1/2)
  const double threshold = std::sqrt(-mathieu0(2 * kShake) / 2) / kShake;
  const auto measured = [](const Stepper& step) {
    return [step](double s) {
      constexpr int kSteps = 4000;  // a period: what is seen is the motion's, not the step's
      constexpr double kPi = 3.14159265358979323846;
      const double omega = std::sqrt(2 * kGravityNumber * kLength) / (s * kShake * kLength);
      return std::abs(
          spectralRadius(step, kapitzaAcceleration(omega), 2 * kPi / omega / kSteps, kSteps) - 1);
    };
  };
  const auto error = [threshold](double s) { return s > threshold ? 1.0 : std::ldexp(1.0, -53); };
  const char* formula =
      "-4 g / (l omega^2) = a_0(2 a / l), Mathieu's characteristic number, by the eigenvalue of "
      "its Fourier series; to first order in a / l this is s = 1, which is 5 % too high here";
  f.measures = {{"verlet", formula, error, measured(verlet)},
                {"runge_kutta4", formula, error, measured(rungeKutta4)}};
  f.mechanism =
      "Here the motion fails, and every method should see where: a pivot that is shaken too slowly "
      "no longer holds the pendulum upright. Over one period of the pivot the linearized motion "
      "is a matrix of determinant 1; when its eigenvalues leave the unit circle, the pendulum "
      "falls (Floquet). The equations are those of the sweeps, driven at the pivot.";
  f.survivor = "None: it falls. The threshold of first order promises too much.";
  return f;
}

/// The link's axes over the body's principal ones: integers over `over`, by a quaternion.
struct Turn {
  Eigen::Matrix3i numerators;
  int over;
};
Turn turnOf(int a, int b, int c, int d) {
  Turn turn;
  turn.numerators << a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c),
      2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b), 2 * (b * d - a * c),
      2 * (c * d + a * b), a * a - b * b - c * c + d * d;
  turn.over = a * a + b * b + c * c + d * d;
  return turn;
}

constexpr int kFlipStepsOfSecond = 64;

/** A free body, I = (1, 2, 3) kg m^2, from w = (1/s, 1, 0) rad/s to the middle of its flip, where
    w is (A, 0, -C):  w = (A dn, sn, C cn)(K + l t),  C^2 = 1/3,  A^2 = 1 + 1/s^2,  l^2 = A^2 / 3,
    k' = 1 / (s A),  reached at t = K / l; K = pi / (2 agm(1, k')).
    @return largest error of w, back in principal axes, at steps whose own error is below
    rounding */
double flipError(const Turn& turn, double s) {
  LinkWords body;
  body.joint = scene::JointKind::kSpherical, body.mass = "1";
  const auto entry = [&](int i, int j) {
    int sum = 0;
    for (int k = 0; k < 3; ++k) sum += (k + 1) * turn.numerators(i, k) * turn.numerators(j, k);
    return std::to_string(sum) + "/" + std::to_string(turn.over * turn.over);
  };
  body.moments = {entry(0, 0), entry(1, 1), entry(2, 2)};
  body.products = {entry(0, 1), entry(0, 2), entry(1, 2)};
  const Eigen::Matrix3d R = turn.numerators.cast<double>() / turn.over;
  const Eigen::Vector3d start = R * Eigen::Vector3d(1 / s, 1, 0);
  const Case given =
      caseOf("flip", {body}, noGravity(), {1, 0, 0, 0}, {start(0), start(1), start(2)}, {});

  const double A = std::hypot(1, 1 / s);
  double mean = 1, other = 1 / (s * A);
  for (int k = 0; k < 12; ++k) {  // digits double: eight would do from 1 and 1e-15
    const double product = mean * other;
    mean = (mean + other) / 2, other = std::sqrt(product);
  }
  const double time = std::acos(-1) / (2 * mean) * std::sqrt(3) / A;
  TreeMotion<double> motion(given.scene.mechanism);
  const auto stepper = stepsOf<double>("runge_kutta_fehlberg78", motion);
  std::vector<double> y = {1, 0, 0, 0, start(0), start(1), start(2), 0};
  const auto steps = static_cast<int>(std::ceil(time * kFlipStepsOfSecond));
  for (int k = 0; k < steps; ++k) stepper->step(&y, 0, time / steps);
  const Eigen::Vector3d w = R.transpose() * Eigen::Vector3d(y[4], y[5], y[6]);
  return (w - Eigen::Vector3d(A, 0, -std::sqrt(1.0 / 3))).cwiseAbs().maxCoeff();
}

Family flip() {
  Family f;
  f.name = "flip";
  f.title = "The flip of a body that spins about its intermediate axis";
  f.dial = "1 rad over the tilt of the spin from the axis";
  f.from = 10, f.to = 1e15;
  f.measured = "the angular velocity in the middle of the flip";
  f.measures = {
      {"inclined axes",
       "every step of Fehlberg 7(8) rounds w seven times; along n = (1, 0, -3^(1/2)), which grows "
       "as e^(t / 3^(1/2)), that is u (7/3)^(1/2) (sum n'^2 w'^2)^(1/2), 1.24 in the worst of "
       "three axes; all steps, each outgrown by those before, leave "
       "(3^(1/2) / 2h)^(1/2) of one, beside a tilt of 1/s",
       [](double s) {
         return rounded(7, inDouble()) * 1.24 * std::sqrt(std::sqrt(3.0) / 2 * kFlipStepsOfSecond) *
                s;
       },
       [](double s) {
         const Turn turns[kVariants] = {turnOf(1, 2, 2, 0), turnOf(1, 2, 4, 2), turnOf(2, 3, 6, 0)};
         return worstOf([&](int v) { return flipError(turns[v], s); });
       }},
      {"principal axes", "the tilt is a number of its own, rounded relative to itself: u",
       [](double) { return inDouble().unit; },
       [](double s) { return flipError(turnOf(1, 0, 0, 0), s); }}};
  f.mechanism =
      "A spin about the intermediate axis is unstable: a tilt of 1/s grows as e^(t / 3^(1/2)) here, "
      "and turns the body over at the time ln(4 s) 3^(1/2). So do roundings. In axes in which all "
      "three rates are large each is rounded by u, and from s u = 1e-3 on it is the roundings "
      "that say when the body flips.";
  f.survivor =
      "The same method in principal axes: what is nearly zero is told to as many digits as what is "
      "not. Nobody's steps are to blame; the tilt was lost when the state was written down.";
  return f;
}

}  // namespace

std::vector<Family> familiesInTime() {
  return {stiffSpring(), kapitza(), flip()};
}

}  // namespace dynwitness::crosscheck::stability
