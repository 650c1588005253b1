// SPDX-License-Identifier: GPL-3.0-or-later
// Skates and rolling discs: the sweeps against published motions. That they are what Lagrange's
// equations with multipliers say, at any state and without rounding, is in test_constraints.cpp.
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/motion/simulate.hpp"
#include "crosscheck/scalars/digits50.hpp"
#include "recursive/constraints.hpp"
#include "recursive/factorization.hpp"
#include "recursive/newton_euler.hpp"
#include "scene/scene.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using crosscheck::Digits50;

namespace {

using Matrix = recursive::MatrixX<Digits50>;
using Vector = recursive::VectorX<Digits50>;

Vector solved(Matrix A, Vector b) {
  recursive::factorize(A);
  recursive::solve(A, b);
  return b;
}

/// The bicycle in 50 digits. Rates: hub (3), turn of the frame (3), rear wheel, steering, front
/// wheel.
class Bicycle {
 public:
  enum Rate { kForward = 0, kLean = 3, kRearWheel = 6, kSteer = 7, kRates = 9 };

  Bicycle()
      : scene_(scene::findScene("bicycle")),
        number_(scene_.mechanism),
        model_(recursive::buildModel(scene_.mechanism, number_)),
        ws_(model_),
        closures_(recursive::buildConstraints(scene_.mechanism, number_, model_)) {}

  /// Accelerations of lean and steer, where these are off by a little and the rear wheel turns so
  /// that its rim has this speed: rates from the closures, J qd = 0; accelerations from
  /// [M J'; J 0] (qdd, -lambda) = (-bias, -gamma).
  Vector accelerations(const Digits50& speed, const Vector& off) {
    const Digits50 half = off(0) / Digits50(2);
    std::vector<scene::JointPosition<Digits50>> x;
    const Digits50 zero(0);
    for (const Digits50& q : {zero, zero, Digits50(3) / Digits50(10), Digits50(1), half, zero, zero,
                              zero, off(1), zero})
      x.push_back(scene::jointPosition(q));
    std::vector<Digits50> qd(kRates, zero);
    recursive::constraintEquations(model_, x, qd, ws_, closures_);
    const std::vector<int> given = {kLean, kSteer, kRearWheel}, others = {0, 1, 2, 4, 5, 8};
    Vector rates(3);
    rates << off(2), off(3), speed / (Digits50(3) / Digits50(10));
    const Matrix J = closures_.J;
    const Matrix of_others = J(Eigen::all, others);  // regular; 50 digits bear its square
    const Vector rest = solved(of_others.transpose() * of_others,
                               -(of_others.transpose() * Vector(J(Eigen::all, given) * rates)));
    for (int k = 0; k < 3; ++k) qd[given[k]] = rates(k);
    for (int k = 0; k < 6; ++k) qd[others[k]] = rest(k);
    recursive::constraintEquations(model_, x, qd, ws_, closures_);

    std::vector<Digits50> none(kRates, zero), bias(kRates);
    recursive::inverseDynamics(model_, x, qd, none, ws_, bias);
    Matrix M = Matrix::Constant(kRates, kRates, zero);
    recursive::massMatrix(model_, x, ws_, M);
    const int m = closures_.rows();
    Matrix K = Matrix::Constant(kRates + m, kRates + m, zero);
    K.topLeftCorner(kRates, kRates) = M;
    K.bottomLeftCorner(m, kRates) = J;
    K.topRightCorner(kRates, m) = J.transpose();
    Vector b(kRates + m);
    for (int k = 0; k < kRates; ++k) b(k) = -bias[k];
    b.tail(m) = -closures_.gamma;
    const Vector solution = solved(K, b);
    Vector out(2);
    out << solution(kLean), solution(kSteer);
    return out;
  }

  /// d (lean, steer)'' / d (lean, steer, lean', steer'), in the source's axes, where a turn of the
  /// handlebar is counted about z down. Central differences: 1e-16^2 in 50 digits is nothing here.
  Eigen::Matrix<double, 2, 4> linearized(double speed) {
    const Digits50 h(std::ldexp(1.0, -53));
    Eigen::Matrix<double, 2, 4> A;
    for (int k = 0; k < 4; ++k) {
      Vector off = Vector::Constant(4, Digits50(0));
      off(k) = h;
      const Vector change =
          accelerations(Digits50(speed), off) - accelerations(Digits50(speed), -off);
      for (int i = 0; i < 2; ++i) {
        const double slope = static_cast<double>((change(i) / (h + h)).value());
        A(i, k) = (i == 1) == (k % 2 == 1) ? slope : -slope;
      }
    }
    return A;
  }

 private:
  scene::Scene scene_;
  scene::RealNumbers<Digits50> number_;
  recursive::Model<Digits50> model_;
  recursive::Workspace<Digits50> ws_;
  recursive::Constraints<Digits50> closures_;
};

}  // namespace

/* J. P. Meijaard et al., Proc. R. Soc. A 463 (2007) 1955, equations 6.1 to 6.4, with
   q = (lean, steer):

       M q'' + v C1 q' + (g K0 + v^2 K2) q = 0

   All printed digits: M to 1e-14 of its entries and so on, of which the solution by M keeps
   1e-12. */
BOOST_DATA_TEST_CASE(the_benchmark_bicycle_is_the_published_one,
                     data::make(std::vector<double>{0, 1, 2.5, 5, 10}), v) {
  Eigen::Matrix2d M, C1, K0, K2;
  M << 80.81722, 2.31941332208709, 2.31941332208709, 0.29784188199686;
  C1 << 0, 33.86641391492494, -0.85035641456978, 1.6854039739756;
  K0 << -80.95, -2.59951685249872, -2.59951685249872, -0.80329488458618;
  K2 << 0, 76.59734589573222, 0, 2.65431523794604;
  const Eigen::FullPivLU<Eigen::Matrix2d> of_M(M);
  Eigen::Matrix<double, 2, 4> published;
  published << of_M.solve(Eigen::Matrix2d(-(9.81 * K0 + v * v * K2))),
      of_M.solve(Eigen::Matrix2d(-v * C1));
  const Eigen::Matrix<double, 2, 4> ours = Bicycle().linearized(v);
  // 5e-15 in an entry of M, C1, K0, K2 as printed is worth this much of the solution
  const double of_digits = 5e-15 * (1 + 9.81 + v + v * v) * M.inverse().cwiseAbs().maxCoeff() *
                           (1 + published.cwiseAbs().maxCoeff());
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 4; ++k)
      BOOST_TEST(std::abs(ours(i, k) - published(i, k)) <= 4 * of_digits,
                 i << ", " << k << ": " << ours(i, k) << " and " << published(i, k) << " differ by "
                   << ours(i, k) - published(i, k) << ", allowed " << 4 * of_digits);
}

/* Chaplygin's sleigh has a closed form: with the forward speed v of the blade, the turn w, the
   distance a to the centre of mass and J = I + m a^2,

       v' = a w^2,  J w' = -m a v w,  v = V tanh(k (t - t0)),  J w^2 = m (V^2 - v^2),
       k = m a V / J */
BOOST_AUTO_TEST_CASE(chaplygins_sleigh_turns_round_as_he_says) {
  const scene::Scene sleigh = scene::findScene("chaplygin_sleigh");
  crosscheck::SimulateOptions options;
  options.duration = 4;
  options.outputs = 20;
  options.step_error = 1e-13;
  const crosscheck::Simulation motion = crosscheck::simulate(sleigh, options);
  const double m = 2, a = 0.25, J = 0.075 + m * a * a, v0 = -0.5, w0 = 1;
  const double V = std::sqrt(v0 * v0 + J / m * w0 * w0), k = m * a * V / J;
  const double t0 = -std::atanh(v0 / V) / k;
  BOOST_TEST(motion.points.front().qd[0] == v0);
  for (const crosscheck::Simulation::Point& at : motion.points) {
    const double heading = at.q[2], v = V * std::tanh(k * (at.time - t0));
    const double forward = std::cos(heading) * at.qd[0] + std::sin(heading) * at.qd[1],
                 sideways = std::cos(heading) * at.qd[1] - std::sin(heading) * at.qd[0];
    BOOST_TEST(std::abs(forward - v) < 1e-11);  // a hundred steps of 1e-13
    BOOST_TEST(std::abs(sideways) < 1e-14);
    BOOST_TEST(std::abs(J * at.qd[2] * at.qd[2] - m * (V * V - v * v)) < 1e-11);
  }
  BOOST_TEST(motion.points.back().qd[0] != v0);
}

/* Euler's disc with its centre at rest: Omega^2 sin a = 4 g / r (H. K. Moffatt, Nature 404 (2000)
   833). The table then carries the weight and nothing sideways, the centre stays, the lean
   stays. */
BOOST_AUTO_TEST_CASE(eulers_disc_goes_round_its_resting_centre) {
  const scene::Scene coin = scene::findScene("rolling_coin");
  crosscheck::SimulateOptions options;
  options.duration = 0.5;  // twice round
  options.outputs = 10;
  options.step_error = 1e-13;
  const crosscheck::Simulation motion = crosscheck::simulate(coin, options);
  BOOST_TEST_REQUIRE(motion.points.size() == 11u);
  for (const crosscheck::Simulation::Point& at : motion.points) {
    const double s = at.q[3], x = at.q[4], y = at.q[5], z = at.q[6];
    const double length = s * s + x * x + y * y + z * z;
    for (int i = 0; i < 2; ++i) BOOST_TEST(std::abs(at.q[i]) < 1e-10);
    BOOST_TEST(std::abs(at.q[2] - 0.062784) < 1e-10);
    BOOST_TEST(std::abs(1 - 2 * (x * x + y * y) / length - 0.6) < 1e-10);  // n . z
    BOOST_TEST(std::abs(at.qd[3] * at.qd[3] + at.qd[4] * at.qd[4] - 400) < 1e-7);
    BOOST_TEST_REQUIRE(at.lambda.size() == 3u);
    BOOST_TEST(std::abs(at.lambda[0]) < 1e-8);
    BOOST_TEST(std::abs(at.lambda[1]) < 1e-8);
    BOOST_TEST(std::abs(at.lambda[2] - 0.4 * 9.81) < 1e-8);
  }
}
