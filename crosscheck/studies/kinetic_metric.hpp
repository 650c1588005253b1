// SPDX-License-Identifier: GPL-3.0-or-later
// The mass matrix as a metric: connection and curvature at a position, on any scalar.
#pragma once

#include <stdexcept>
#include <utility>
#include <vector>

#include "crosscheck/scalars/lifted.hpp"
#include "recursive/constraints.hpp"
#include "recursive/factorization.hpp"

namespace dynwitness::crosscheck {

/** Geometry of the configuration space of a tree, with M(q) as metric: T = |qd|^2 / 2. For joints
    whose rates are the derivatives of q.

        (1)  Gamma_i,jk = (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) / 2       Christoffel, first kind
        (2)  Gamma^i_jk = sum of (M^-1)_il Gamma_l,jk                       second kind
        (3)  R_ijkl = (d2M_il/dq_j dq_k + d2M_jk/dq_i dq_l
                       - d2M_ik/dq_j dq_l - d2M_jl/dq_i dq_k) / 2
                      + Gamma_jk' M^-1 Gamma_il - Gamma_jl' M^-1 Gamma_ik
        (4)  sectional curvature of the plane of u and v,
             K = R(u, v, u, v) / (|u|^2 |v|^2 - <u, v>^2);    for two joints Gauss's curvature

    M is the composite-body sweep's; derivatives are its runs on duals and nested duals: no step
    size, and over a field they are exact. All arguments are coordinates of tangent vectors, length
    n. Curvature is in 1/(kg m^2), for M is in kg m^2.
    @see M. do Carmo, Riemannian Geometry (1992), chapters 2 and 4 (whose R has the other sign) */
template <typename T>
class KineticMetric {
 public:
  using Vector = recursive::VectorX<T>;
  using Matrix = recursive::MatrixX<T>;

  KineticMetric(const recursive::Model<T>& model, std::vector<scene::JointPosition<T>> x)
      : model_(lifted<Dual<Dual<T>>>(model)), ws_(model_), x_(std::move(x)) {
    const recursive::Model<Dual<T>> once = lifted<Dual<T>>(model);
    recursive::Workspace<Dual<T>> ws(once);
    recursive::MatrixX<Dual<T>> M(n(), n());
    M_ = LDL_ = Matrix::Constant(n(), n(), T(0));
    for (int k = 0; k < n(); ++k) {
      std::vector<scene::JointPosition<Dual<T>>> moved;
      for (int i = 0; i < n(); ++i) moved.push_back(moving(x_[i], T(i == k ? 1 : 0)));
      recursive::massMatrix(once, moved, ws, M);
      dM_.push_back(M_);
      for (int i = 0; i < n(); ++i)
        for (int j = 0; j < n(); ++j) {
          M_(i, j) = M(i, j).value;
          dM_.back()(i, j) = M(i, j).derivative;
        }
    }
    LDL_ = M_;
    recursive::factorize(LDL_);
  }

  int n() const { return model_.dof(); }
  const Matrix& M() const { return M_; }
  /// dM/dq_k for every k.
  const std::vector<Matrix>& gradient() const { return dM_; }

  T christoffel(int i, int j, int k) const {
    return (dM_[k](i, j) + dM_[j](i, k) - dM_[i](j, k)) / T(2);  // (1)
  }
  /// Gamma_i,jk u_j v_k for every i.
  Vector christoffel(const Vector& u, const Vector& v) const {
    Vector out = Vector::Constant(n(), T(0));
    for (int k = 0; k < n(); ++k) {
      out += (dM_[k] * u) * (v(k) / T(2)) + (dM_[k] * v) * (u(k) / T(2));
      out(k) -= u.dot(Vector(dM_[k] * v)) / T(2);
    }
    return out;
  }
  /// M^-1 w: the second kind from the first.
  Vector raised(Vector w) const {  // (2)
    recursive::solve(LDL_, w);
    return w;
  }
  T product(const Vector& u, const Vector& v) const { return u.dot(Vector(M_ * v)); }

  /// R_ijkl a_i b_j c_k d_l
  T riemann(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
    return (second(b, c, a, d) + second(a, d, b, c) - second(b, d, a, c) - second(a, c, b, d)) /
               T(2) +
           christoffel(b, c).dot(raised(christoffel(a, d))) -
           christoffel(b, d).dot(raised(christoffel(a, c)));  // (3)
  }
  T sectional(const Vector& u, const Vector& v) {
    const T across = product(u, v);
    return riemann(u, v, u, v) / (product(u, u) * product(v, v) - across * across);  // (4)
  }
  Vector unit(int i) const {
    Vector e = Vector::Constant(n(), T(0));
    e(i) = T(1);
    return e;
  }

 private:
  /// The second derivative of <c, d> along a and b, c and d constant.
  T second(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
    std::vector<scene::JointPosition<Dual<Dual<T>>>> moved;
    for (int i = 0; i < n(); ++i) moved.push_back(moving(moving(x_[i], a(i)), Dual<T>(b(i))));
    recursive::MatrixX<Dual<Dual<T>>> M(n(), n());
    recursive::massMatrix(model_, moved, ws_, M);
    T sum = T(0);
    for (int i = 0; i < n(); ++i)
      for (int j = 0; j < n(); ++j) sum += c(i) * M(i, j).derivative.derivative * d(j);
    return sum;
  }

  recursive::Model<Dual<Dual<T>>> model_;
  recursive::Workspace<Dual<Dual<T>>> ws_;
  std::vector<scene::JointPosition<T>> x_;
  Matrix M_, LDL_;
  std::vector<Matrix> dM_;
};

}  // namespace dynwitness::crosscheck
