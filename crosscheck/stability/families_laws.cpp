// SPDX-License-Identifier: GPL-3.0-or-later
// What mechanics promises, as it decays with conditioning: projectors, positive definiteness,
// momentum; and parameters that are regrouped before they are used.
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "crosscheck/stability/family.hpp"
#include "crosscheck/stability/make_case.hpp"
#include "crosscheck/verdicts/truth.hpp"
#include "recursive/projection.hpp"

namespace dynwitness::crosscheck::stability {
namespace {

constexpr double kHalfPi = 1.5707963267948966;             // nearest to pi/2
constexpr long double kPiByTwo = 1.57079632679489661923L;  // nearest long double

std::unique_ptr<Witness> witnessOf(const char* name, const scene::Scene& scene) {
  return selectWitnesses({name}).front().make(PreparedScene(scene)).value();
}

/// A body's inertia about its link's origin: 1 kg, com beside it.
template <typename T>
recursive::Matrix6<T> inertiaOfBody(int variant) {
  constexpr double kAlong[kVariants] = {0.3, 0.27, 0.35};
  const recursive::Vector3<T> com(T(kAlong[variant]), T(0.2), T(-0.1));
  const recursive::Matrix3<T> c = recursive::skew(com);
  recursive::Matrix6<T> M = recursive::Matrix6<T>::Identity();
  M.template topRightCorner<3, 3>() = -c;
  M.template bottomLeftCorner<3, 3>() = c;
  M.template bottomRightCorner<3, 3>() =
      recursive::Vector3<T>(T(0.3), T(0.4), T(0.5)).asDiagonal().toDenseMatrix() - c * c;
  return M;
}

template <typename T>
struct Projected {
  Projected(double s, int variant) : M(inertiaOfBody<T>(variant)) {
    recursive::JointAxes<T> Z = recursive::JointAxes<T>::Zero(6, 2);
    Z(3, 0) = T(1);
    Z(3, 1) = static_cast<T>(std::cos(1 / s));
    Z(4, 1) = static_cast<T>(std::sin(1 / s));
    P = recursive::forceProjection<T>(M, Z, recursive::MatrixX<T>::Zero(2, 2));
  }
  recursive::Matrix6<T> M, P;
};

/// ||P P - P|| / ||P||
template <typename T>
double lostIdempotence(double s) {
  return worstOf([s](int v) {
    const recursive::Matrix6<double> P = Projected<T>(s, v).P.template cast<double>();
    return (P * P - P).norm() / P.norm();
  });
}
/// ||P M - (P M)'|| / ||P M||
template <typename T>
double lostSymmetry(double s) {
  return worstOf([s](int v) {
    const Projected<T> of(s, v);
    const recursive::Matrix6<double> PM =
        of.P.template cast<double>() * of.M.template cast<double>();
    return (PM - PM.transpose()).norm() / PM.norm();
  });
}

Family projector() {
  Family f;
  f.name = "projector";
  f.title = "The projector of a joint whose two axes are nearly one";
  f.dial = "1 rad over the angle between the axes";
  f.from = 2, f.to = 1e12;
  f.measured = "PP = P and of P M = (P M)' beside their size";
  // Jyy - Jxy^2 / Jxx, which the second axis moves while the first is free, beside Jxx
  const double across = 0.4 + 0.09 + 0.01 - 0.06 * 0.06 / (0.3 + 0.04 + 0.01);
  const auto cancelled = [across](const Arithmetic& a) {
    return [across, &a](double s) { return rounded(6, a) * s * s * 0.35 / across; };
  };
  const char* formula =
      "D = Z'MZ has the pivots Jxx and (Jyy - Jxy^2 / Jxx) / s^2, the second left of Jxx: error u "
      "s^2 Jxx / (Jyy - Jxy^2 / Jxx), of two entries and the quotient's product, two roundings each";
  const auto unsolved = [cancelled](const Arithmetic& a) {
    return [lost = cancelled(a), &a](double s) { return lost(s) > 1 ? 1 : rounded(2, a) * s; };
  };
  const char* of_PM =
      "whatever D is, its L D L' is symmetric: the rounding of a right side that cancels to 1/s, "
      "error u s, until the pivot itself is gone, u s^2 Jxx / (Jyy - Jxy^2 / Jxx) = 1";
  f.measures = {{"PP double", formula, cancelled(inDouble()), lostIdempotence<double>, &inDouble()},
                {"PM double", of_PM, unsolved(inDouble()), lostSymmetry<double>, &inDouble()},
                {"PP float", formula, cancelled(inFloat()), lostIdempotence<float>, &inFloat()},
                {"PM float", of_PM, unsolved(inFloat()), lostSymmetry<float>, &inFloat()}};
  f.mechanism =
      "P = 1 - M Z (Z'MZ)^-1 Z' takes from a force what the joint cannot hold. That PP = P, and that "
      "P M is symmetric, hangs on the inverse being that of Z'MZ; with two axes 1/s apart its "
      "condition is s^2, and P is a projector to as many digits as that leaves.";
  f.survivor =
      "None with these axes. Axes at right angles that span the same (a sum and a difference that "
      "are told, not computed) have a D of condition 1.";
  return f;
}

/// How far the smallest eigenvalue of M is off, as a share of what it is.
double lostDefiniteness(const char* witness, double s) {
  LinkWords yaw, pitch, body;
  pitch.parent = 1, pitch.axis = {"0", "1", "0"};
  body.parent = 2, body.axis = {"1", "0", "0"}, body.mass = "1";
  body.moments = {"0.3", "0.3", "0.3"};
  const double q2 = kHalfPi - 1 / s;
  const Case given =
      caseOf("positive_definite", {yaw, pitch, body}, noGravity(), {0.3, q2, 0.4}, {}, {});
  const Eigen::MatrixXd M = witnessOf(witness, given.scene)->value(Quantity::kM, given.state);
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(M).eigenvalues()(0);
  // I (1 - sin q2) = 2 I sin^2 ((pi/2 - q2) / 2)
  const long double half = std::sin((kPiByTwo - q2) / 2), right = 2 * 0.3L * half * half;
  return static_cast<double>(std::abs(least / right - 1));
}

Family positiveDefinite() {
  Family f;
  f.name = "positive_definite";
  f.title = "M near gimbal lock: whether it is positive definite";
  f.dial = "1 rad over the distance from gimbal lock";
  f.from = 2, f.to = 1e10;
  f.measured = "the smallest eigenvalue of M, which is above 0";
  const auto theory = [](double s) { return rounded(6, inDouble()) * 2 * s * s; };
  const char* formula =
      "I (1 - sin q2) = I / (2 s^2) is left of entries of size I: error 2 u s^2, of two entries of "
      "M, each of some three roundings";
  for (const char* witness : {"composite_body", "recursive_lagrange", "lagrange"})
    f.measures.push_back(
        {witness, formula, theory, [witness](double s) { return lostDefiniteness(witness, s); }});
  f.mechanism =
      "M says that no motion is without energy, x'Mx > 0. Near a pose where a motion is almost "
      "without, the smallest eigenvalue is left of entries of size 1, each rounded: first its "
      "digits go, then its sign, and a factorization that counts on it (Cholesky's) stops.";
  f.survivor =
      "None that forms M: the entries that are stored have forgotten it. Sweeps, which have D = I "
      "cos^2 q2 as a product (gimbal).";
  return f;
}

/// What is left of the force on a free body and its arm, which nothing outside pushes [N], where a
/// motor between them takes 1 N m.
double lostMomentum(const char* witness, double s, int variant) {
  LinkWords body, arm;
  body.joint = scene::JointKind::kFloating, body.mass = "1", body.moments = {"0.3", "0.3", "0.3"};
  arm.parent = 1, arm.xyz = {"0.2", "0", "0"}, arm.mass = decimalOf(s, false);
  constexpr const char* kFar[kVariants] = {"0.5", "0.47", "0.57"};
  arm.com = {kFar[variant], "0.1", "0"};
  const std::string of_mass = "*" + arm.mass;
  arm.moments = {"0.1" + of_mass, "0.3" + of_mass, "0.3" + of_mass};
  Case given = caseOf("momentum", {body, arm}, noGravity(),
                      {0.1, -0.2, 0.3, 0.5, 0.1, -0.7, 0.5, 0.3}, {}, {0, 0, 0, 0, 0, 0, 1});
  const Eigen::MatrixXd qdd = witnessOf(witness, given.scene)->value(Quantity::kQdd, given.state);
  std::copy(qdd.data(), qdd.data() + qdd.size(), given.state.qdd.begin());
  const Certified needed = Truth(given.scene.mechanism)(Quantity::kTau, given.state);
  if (!needed.exists()) throw std::runtime_error(needed.reason);
  double force = 0;  // of the joint's six rates the linear ones come first
  for (int k = 0; k < 3; ++k) force = std::max(force, needed.value(k, 0).atMost());
  return force;
}

Family momentum() {
  Family f;
  f.name = "momentum";
  f.title = "A free light body with a heavy arm: momentum";
  f.dial = "mass of the arm over that of the body";
  f.from = 1, f.to = 1e16;
  f.measured = "the rate of momentum, which should be 0, beside 1 N m / 1 m";
  const auto theory = [](double s) {
    // accelerations of the body's origin and turn, and of the joint, times their levers
    constexpr double kTurn = 1 / (0.3 + 0.04);
    const double terms = std::sqrt(2 * std::pow(kTurn * 0.5, 2) + 2 * std::pow(kTurn * 0.2, 2));
    return rounded(1, inDouble()) * s * terms;
  };
  const char* formula =
      "the arm stands almost still as s times differences of accelerations of size 1, 0.5 m dw of "
      "joint and body and 0.2 m dw of the body's turn and origin: stored in double they leave u s "
      "(2 0.5^2 + 2 0.2^2)^(1/2) dw, dw = 1 / (I + 0.2^2)";
  for (const char* witness : {"composite_body", "articulated_body", "fast", "lagrange"})
    f.measures.push_back({witness, formula, theory, [witness](double s) {
                            return worstOf([&](int v) { return lostMomentum(witness, s, v); });
                          }});
  f.mechanism =
      "Nothing outside pushes, so the momentum of body and arm stays. What is asked of qdd for "
      "that is that s kg of arm stand still while body and joint turn against each other: the "
      "rounding of these accelerations alone, times s, is a force from nowhere.";
  f.survivor =
      "None whose unknowns are the body's motion and the joint's: the loss is in storing qdd, "
      "however well it was found.";
  return f;
}

/// Two axes at right angles; a rod on the second one points along the first.
/// How far the torque is off. @param witness  "": two base parameters
double lostTorque(double s, const std::string& witness, int variant) {
  LinkWords turn, rod;
  turn.mass = "1", turn.moments = {"0.1", "0.1", "0.1"};
  rod.parent = 1, rod.axis = {"0", "1", "0"}, rod.mass = "1";
  constexpr double kFactors[kVariants] = {1, 0.8371, 1.1713};
  const std::string across = decimalOf(s * kFactors[variant], false);
  rod.moments = {"0.01", across, across};
  Case given = caseOf("regrouped", {turn, rod}, noGravity(), {0.3, kHalfPi}, {}, {});
  given.state.qdd = {1, 0};
  const Certified truth = Truth(given.scene.mechanism)(Quantity::kTau, given.state);
  if (!truth.exists()) throw std::runtime_error(truth.reason);
  const double right = truth.value(0, 0).mid();
  if (witness.empty()) {
    // J1 + Jxx sin^2 + Jzz cos^2 = (J1 + Jzz) + (Jxx - Jzz) sin^2: two parameters for three
    const double sine = std::sin(kHalfPi), large = std::stod(across);
    const double sum = 0.1 + large, difference = 0.01 - large;
    return std::abs((sum + difference * sine * sine) / right - 1);
  }
  const double said =
      witnessOf(witness.c_str(), given.scene)->value(Quantity::kTau, given.state)(0, 0);
  return std::abs(said / right - 1);
}

Family regrouped() {
  Family f;
  f.name = "regrouped";
  f.title = "Base parameters: a long rod along the axis that turns it";
  f.dial = "moment of inertia across the rod [kg m^2]";
  f.from = 1, f.to = 1e16;
  f.measured = "the torque that turns it";
  f.measures = {
      {"base_parameters",
       "(J1 + Jzz) + (Jxx - Jzz) sin^2 q2 cancels s down to J1 + Jxx = 0.11: error u s / 0.11, of "
       "sum and difference (sin^2 is 1 as a double, what is left of it adds nothing)",
       [](double s) { return rounded(2, inDouble()) * s / 0.11; },
       [](double s) { return worstOf([&](int v) { return lostTorque(s, "", v); }); }},
      {"recursive_lagrange",
       "the second moments of mass that it computes with are (Jxx + Jzz - Jyy) / 2, s taken from "
       "s: error u s / 0.11, of one sum's rounding a moment, and two of them",
       [](double s) { return rounded(2, inDouble()) * s / 0.11; },
       [](double s) {
         return worstOf([&](int v) { return lostTorque(s, "recursive_lagrange", v); });
       }}};
  for (const char* witness : {"newton_euler", "fast", "lagrange"})
    f.measures.push_back({witness,
                          "J1 + Jxx sin^2 q2 + Jzz cos^2 q2: a sum of what is positive, error u",
                          [](double) { return inDouble().unit; },
                          [witness](double s) {
                            return worstOf([&](int v) { return lostTorque(s, witness, v); });
                          }});
  f.mechanism =
      "Only sums of parameters can be identified, and robots are calibrated by them: J1 + Jzz and "
      "Jxx - Jzz here, with which the inertia about the first axis is a difference of two numbers of "
      "size s. The ten parameters of each link have it as a sum of positive ones; second moments of "
      "mass in their place are differences again.";
  f.survivor =
      "Who computes with the links' own parameters. Regrouping costs as many digits as the rod is "
      "longer than it is thick, squared.";
  return f;
}

}  // namespace

std::vector<Family> familiesOfLaws() {
  return {projector(), positiveDefinite(), momentum(), regrouped()};
}

}  // namespace dynwitness::crosscheck::stability
