// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of impedances as two sides, in any arithmetic.
#pragma once

#include <stdexcept>
#include <vector>

#include "crosscheck/laws/two_sides.hpp"
#include "crosscheck/scalars/lifted.hpp"
#include "crosscheck/studies/point.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/recursive_lagrange.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {

inline constexpr IdentityInfo kImpedanceLaws[] = {
    {"stiffness of the joints", "d2V/dq2 = J' K J + (dJ'/dq) f", "K", "recursive_lagrange",
     "sweeps"},
    {"compliance of the point", "w' C_x w = dq' K_q dq, C_x = J C_q J', dq = C_q J' w", "C",
     "sweeps", "joints"},
    {"damping of the joints", "qd' J' D J qd = xd' D xd", "D", "sweeps", "recursive_lagrange"},
    {"mobility of the point", "J M^-1 J' f = xdd of a force f at rest", "mobility",
     "composite_body", "articulated_body"},
    {"apparent inertia", "T(M^-1 J' L xd) = xd' L xd / 2, L = (J M^-1 J')^-1", "L", "newton_euler",
     "composite_body"},
    {"there and back", "J^-T (J' K J) J^-1 = K", "K", "sweeps", ""},
    {"another frame, stiffness", "t_f' K_f t_f = t' K t", "K", "spatial algebra", ""},
    {"another frame, compliance and inertia", "trace(C_f M_f) = trace(C M)", "C M",
     "spatial algebra", ""},
};

/// The laws that a scene has: derivatives by q where rates are those, J^-1 where J may be square.
inline std::vector<CheckResult> impedanceLawsOf(const scene::Mechanism& mechanism,
                                                std::vector<CheckResult> checks) {
  if (mechanism.dof() != 3 && mechanism.dof() != 6) checks.erase(checks.begin() + 5);
  for (CheckResult& check : checks)
    if (check.verdict == Verdict::kNotAnswerable &&
        (check.quantity == "L" || check.quantity == "K"))
      check.reason =
          "the point cannot move every way: J M^-1 J' or J is singular (" + check.reason + ")";
  for (const scene::Link& link : mechanism.links)
    if (!scene::ratesArePositionDerivatives(link.joint.kind))
      return {checks.begin() + 1, checks.end()};
  return checks;
}

/// What the laws are asked about, in any arithmetic.
template <typename T>
struct Impedance {
  LinkPoint<T> point;
  recursive::Matrix6<T> K, D;     ///< symmetric, world axes
  recursive::Vector3<T> stretch;  ///< x - x_0
  std::vector<T> joint_compliance;
  recursive::Vector6<T> wrench;
};

template <typename T>
class ImpedanceModel {
 public:
  using Vector = recursive::VectorX<T>;
  using Matrix = recursive::MatrixX<T>;

  template <typename Numbers>
  ImpedanceModel(const scene::Mechanism& mechanism, const Numbers& number)
      : model(recursive::buildModel(mechanism, number)),
        setup_(model),
        points_(mechanism, number),
        // twice differentiable: the same reading of the scene, on nested duals
        points_moving_(mechanism, DualNumbers<DualNumbers<Numbers>>(DualNumbers<Numbers>(number))) {
    for (const scene::Link& link : mechanism.links)
      coordinates_ = coordinates_ && scene::ratesArePositionDerivatives(link.joint.kind);
  }

  /// (dJ'/dq) f of a force f at the point: entry (i, k) is dJ_i'/dq_k f.
  Matrix geometricStiffness(const scene::State<T>& state, const LinkPoint<T>& point,
                            const recursive::Vector3<T>& f) const {
    if (!coordinates_) throw std::domain_error("rates are no derivatives of coordinates");
    using Once = Dual<T>;
    const recursive::Model<Once> moving_model = liftedWithPlaces(point.link);
    const LinkPoint<Once> moving_point = {
        point.link, {Once(point.at.x()), Once(point.at.y()), Once(point.at.z())}};
    Matrix out(model.dof(), model.dof());
    for (int k = 0; k < model.dof(); ++k) {
      std::vector<scene::JointPosition<Once>> x;
      for (int i = 0; i < model.dof(); ++i) x.push_back(moving(state.x[i], T(i == k ? 1 : 0)));
      const recursive::MatrixX<Once> J = pointJacobian(moving_model, x, moving_point);
      for (int i = 0; i < model.dof(); ++i) {
        out(i, k) = T(0);
        for (int a = 0; a < 3; ++a) out(i, k) += J(a, i).derivative * f(a);
      }
    }
    return out;
  }
  Matrix mobility(const scene::State<T>& state, const Matrix& J) {
    Matrix M(model.dof(), model.dof()), response(model.dof(), J.rows());
    recursive::massMatrix(model, state.x, setup_.ws, M);
    recursive::factorize(M);
    for (Eigen::Index k = 0; k < J.rows(); ++k) {
      Vector column = J.row(k).transpose();
      recursive::solve(M, column);
      response.col(k) = column;
    }
    return J * response;
  }
  static Matrix inverse(Matrix A) {  // of a symmetric matrix
    recursive::factorize(A);
    Matrix out(A.rows(), A.cols());
    for (Eigen::Index k = 0; k < A.rows(); ++k) {
      Vector unit = Vector::Constant(A.rows(), T(0));
      unit(k) = T(1);
      recursive::solve(A, unit);
      out.col(k) = unit;
    }
    return out;
  }

  std::vector<TwoSides<T>> laws(const scene::State<T>& state, const Impedance<T>& z) {
    std::vector<TwoSides<T>> out(std::size(kImpedanceLaws));
    const auto law = [&](int k, const auto& sides) {
      try {
        out[k] = sides();
      } catch (const std::domain_error& error) {  // a divisor is zero, or there is no such law
        out[k].failure = error.what();
      }
    };
    const auto one = [](const T& value) { return MatrixOf<T>(scalar(value)); };
    const int n = model.dof();
    recursive::Transform<T> X = recursive::Transform<T>::identity();
    const Matrix J = pointJacobian(model, state.x, z.point, &X);
    const Matrix J_linear = J.topRows(3);
    const recursive::Matrix3<T> K_linear = z.K.template topLeftCorner<3, 3>();
    law(0, [&] {
      const recursive::Vector3<T> f = K_linear * z.stretch;
      const Matrix right =
          J_linear.transpose() * K_linear * J_linear + geometricStiffness(state, z.point, f);
      return TwoSides<T>{potentialHessian(state, z), right, {}};
    });
    law(1, [&] {
      Vector dq = J.transpose() * z.wrench;
      Matrix C = Matrix::Constant(n, n, T(0));
      T right = T(0);
      for (int i = 0; i < n; ++i) {
        C(i, i) = z.joint_compliance[i];
        dq(i) = dq(i) * z.joint_compliance[i];
        right += dq(i) * dq(i) / z.joint_compliance[i];
      }
      const Matrix C_x = J * C * J.transpose();
      return TwoSides<T>{one(z.wrench.dot(Vector(C_x * z.wrench))), one(right), {}};
    });
    law(2, [&] {
      const Vector qd = column(state.qd);
      const recursive::Vector6<T> xd = velocity(state, z.point);
      const Matrix D_q = J.transpose() * z.D * J;
      return TwoSides<T>{
          one(qd.dot(Vector(D_q * qd))), one(xd.dot(recursive::Vector6<T>(z.D * xd))), {}};
    });
    law(3, [&] {
      const Vector generalized = J.transpose() * z.wrench;
      std::vector<T> qdd = setup_.zeros();
      const std::vector<T> tau(generalized.data(), generalized.data() + n);
      recursive::forwardDynamics(model, state.x, setup_.zeros(), tau, setup_.ws, qdd,
                                 Terms::none());
      return TwoSides<T>{MatrixOf<T>(mobility(state, J) * z.wrench), J * column(qdd), {}};
    });
    law(4, [&] {
      const Matrix L = inverse(mobility(state, J_linear));
      const Vector xd = z.wrench.template head<3>();
      Vector qd = J_linear.transpose() * Vector(L * xd);
      Matrix M(n, n);
      recursive::massMatrix(model, state.x, setup_.ws, M);
      recursive::factorize(M);
      recursive::solve(M, qd);
      const std::vector<T> rates(qd.data(), qd.data() + n);
      return TwoSides<T>{one(recursive::kineticEnergy(model, state.x, rates, setup_.ws)),
                         one(xd.dot(Vector(L * xd)) / T(2)),
                         {}};
    });
    law(5, [&] {
      if (n != 6 && n != 3) throw std::domain_error("J is not square");
      const Matrix J_square = n == 6 ? J : J_linear;
      const Matrix K = n == 6 ? Matrix(z.K) : Matrix(K_linear);
      // J^-1 = (J'J)^-1 J' of a square regular J
      const Matrix back = inverse(J_square.transpose() * J_square) * J_square.transpose();
      const Matrix K_q = J_square.transpose() * K * J_square;
      return TwoSides<T>{Matrix(back.transpose() * K_q * back), K, {}};
    });
    // the link's frame, its origin at the point, and one somewhere else
    recursive::Transform<T> frame = X;
    frame.p = z.stretch;
    const recursive::Matrix6<T> S = frame.motionMatrix(), S_back = frame.inverse().motionMatrix();
    law(6, [&] {
      const recursive::Matrix6<T> K_f = S_back.transpose() * z.K * S_back;
      const recursive::Vector6<T> t_f = S * z.wrench;  // any six numbers are a twist
      return TwoSides<T>{one(t_f.dot(recursive::Vector6<T>(K_f * t_f))),
                         one(z.wrench.dot(recursive::Vector6<T>(z.K * z.wrench))),
                         {}};
    });
    law(7, [&] {
      const recursive::Matrix6<T> C = J * J.transpose();  // a compliance
      const recursive::Matrix6<T> C_f = S * C * S.transpose(),
                                  M_f = S_back.transpose() * z.K * S_back;
      return TwoSides<T>{one((C_f * M_f).trace()), one((C * z.K).trace()), {}};
    });
    return out;
  }

  recursive::Model<T> model;

 private:
  /// The model on duals with the one place that is asked for.
  recursive::Model<Dual<T>> liftedWithPlaces(int link) const {
    recursive::Model<Dual<T>> out = lifted<Dual<T>>(model);
    const auto& place = model.places[link];
    out.places.resize(model.places.size());
    recursive::Transform<Dual<T>> X = recursive::Transform<Dual<T>>::identity();
    for (int i = 0; i < 3; ++i) {
      X.p(i) = Dual<T>(place.X.p(i));
      for (int j = 0; j < 3; ++j) X.R(i, j) = Dual<T>(place.X.R(i, j));
    }
    out.places[link] = {place.link, X};
    return out;
  }
  /// Where the point is, by 4 x 4 matrices.
  template <typename S>
  static recursive::Vector3<S> placeOf(const HomogeneousModel<S>& points,
                                       const LinkPoint<T>& point) {
    Vector4<S> at = Vector4<S>::Constant(S(1));
    for (int i = 0; i < 3; ++i) at(i) = S(point.at(i));
    const Vector4<S> r =
        points.places()[points.body_of_link[point.link]] * (points.after_of_link[point.link] * at);
    return r.template head<3>();
  }
  /// Second derivatives of (x - x_0)' K (x - x_0) / 2, x_0 such that x - x_0 is the stretch.
  Matrix potentialHessian(const scene::State<T>& state, const Impedance<T>& z) {
    if (!coordinates_) throw std::domain_error("rates are no derivatives of coordinates");
    using DD = Dual<Dual<T>>;
    const int n = model.dof();
    Matrix out(n, n);
    const std::vector<DD> rest(n, DD(Dual<T>(T(0))));
    for (int i = 0; i < n; ++i)
      for (int j = 0; j <= i; ++j) {
        std::vector<scene::JointPosition<DD>> x;
        for (int k = 0; k < n; ++k)
          x.push_back(moving(moving(state.x[k], T(k == i ? 1 : 0)), Dual<T>(T(k == j ? 1 : 0))));
        points_moving_.kinetic(x, rest);  // places the bodies
        const recursive::Vector3<DD> r = placeOf(points_moving_, z.point);
        DD twice(Dual<T>(T(0)));
        recursive::Vector3<DD> stretch;
        for (int a = 0; a < 3; ++a)
          stretch(a) = r(a) - DD(Dual<T>(r(a).value.value)) + DD(Dual<T>(z.stretch(a)));
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) twice += stretch(a) * DD(Dual<T>(z.K(a, b))) * stretch(b);
        out(i, j) = out(j, i) = twice.derivative.derivative / T(2);
      }
    return out;
  }
  /// The point's velocity and the angular velocity of its link, by the rates of 4 x 4 matrices.
  recursive::Vector6<T> velocity(const scene::State<T>& state, const LinkPoint<T>& point) {
    points_.kinetic(state.x, state.qd);
    const int body = points_.body_of_link[point.link];
    Vector4<T> at = Vector4<T>::Constant(T(1));
    at.template head<3>() = point.at;
    const Matrix4<T>& Wd = points_.rates()[body];
    const Vector4<T> v = Wd * (points_.after_of_link[point.link] * at);
    const Matrix4<T> omega = Wd.template topLeftCorner<4, 3>() *
                             points_.places()[body].template topLeftCorner<4, 3>().transpose();
    recursive::Vector6<T> out;
    out << v(0), v(1), v(2), omega(2, 1), omega(0, 2), omega(1, 0);
    return out;
  }

  Setup<T> setup_;
  HomogeneousModel<T> points_;
  HomogeneousModel<Dual<Dual<T>>> points_moving_;
  bool coordinates_ = true;
};

}  // namespace dynwitness::crosscheck
