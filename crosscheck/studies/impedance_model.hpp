// SPDX-License-Identifier: GPL-3.0-or-later
// Stiffness, damping, compliance and inertia between joints and a point, in any arithmetic.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "crosscheck/scalars/lifted.hpp"
#include "crosscheck/studies/point.hpp"
#include "crosscheck/witnesses/recursive_lagrange.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {

/// What the laws are asked about, in any arithmetic.
template <typename T>
struct Impedance {
  LinkPoint<T> point;
  recursive::Matrix6<T> K, D;     ///< symmetric, world axes
  recursive::Vector3<T> stretch;  ///< x - x_0
  std::vector<T> joint_compliance;
  recursive::Vector6<T> wrench;
};

/// Rates are the derivatives of coordinates: there are second derivatives by them.
inline bool hasCoordinates(const scene::Mechanism& mechanism) {
  return std::all_of(mechanism.links.begin(), mechanism.links.end(), [](const scene::Link& link) {
    return scene::ratesArePositionDerivatives(link.joint.kind);
  });
}

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
        points_moving_(mechanism, DualNumbers<DualNumbers<Numbers>>(DualNumbers<Numbers>(number))),
        coordinates_(hasCoordinates(mechanism)) {}

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

  /// M^-1 of joint forces, by composite bodies.
  Vector solved(const scene::State<T>& state, Vector forces) {
    Matrix M(model.dof(), model.dof());
    recursive::massMatrix(model, state.x, setup_.ws, M);
    recursive::factorize(M);
    recursive::solve(M, forces);
    return forces;
  }
  /// What joint forces make of the mechanism at rest, by articulated bodies.
  Vector accelerations(const scene::State<T>& state, const Vector& forces) {
    std::vector<T> qdd = setup_.zeros();
    recursive::forwardDynamics(model, state.x, setup_.zeros(), list(forces), setup_.ws, qdd,
                               Terms::none());
    return column(qdd);
  }
  T kineticEnergy(const scene::State<T>& state, const Vector& qd) {
    return recursive::kineticEnergy(model, state.x, list(qd), setup_.ws);
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

  recursive::Model<T> model;

 private:
  static std::vector<T> list(const Vector& v) { return {v.data(), v.data() + v.size()}; }

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
  Setup<T> setup_;
  HomogeneousModel<T> points_;
  HomogeneousModel<Dual<Dual<T>>> points_moving_;
  bool coordinates_;
};

}  // namespace dynwitness::crosscheck
