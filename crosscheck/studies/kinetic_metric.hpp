// SPDX-License-Identifier: GPL-3.0-or-later
// The mass matrix as a metric: connection and curvature at a position, on any scalar.
#pragma once

#include <utility>
#include <vector>

#include "crosscheck/scalars/lifted.hpp"
#include "crosscheck/scalars/lifted_closures.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/studies/closure_forces.hpp"
#include "crosscheck/studies/rate_frame.hpp"
#include "recursive/constraints.hpp"
#include "recursive/factorization.hpp"

namespace dynwitness::crosscheck {

/// Positions that move with rates u.
template <typename T>
std::vector<scene::JointPosition<Dual<T>>> movedAlong(const recursive::Model<T>& model,
                                                      const std::vector<scene::JointPosition<T>>& x,
                                                      const recursive::VectorX<T>& u) {
  std::vector<T> slot_rates(model.positions, T(0));
  recursive::positionRates(model, x, std::vector<T>(u.data(), u.data() + u.size()), slot_rates);
  std::vector<scene::JointPosition<Dual<T>>> out;
  for (std::size_t i = 0; i < x.size(); ++i) out.push_back(moving(x[i], slot_rates[i]));
  return out;
}

/** Geometry of the configuration space of a tree, with M(q) as metric: T = |qd|^2 / 2; or of the
    surface in it on which closures hold. e_i are the frame of the rates (RateFrame).

        (1)  Gamma_i,jk = <e_i, D_j e_k>                                    Koszul's formula
             = (e_j M_ik + e_k M_ij - e_i M_jk
                + <[e_j, e_k], e_i> - <[e_j, e_i], e_k> - <[e_k, e_i], e_j>) / 2
             Christoffel symbols of the first kind where qd are derivatives of q
        (2)  Gamma^i_jk = sum of (M^-1)_il Gamma_l,jk                       second kind
        (3)  R_ijkl = e_i Gamma_k,jl - e_j Gamma_k,il - <D_j e_l, D_i e_k> + <D_i e_l, D_j e_k>
                      - <e_k, D_[i,j] e_l>
        (4)  sectional curvature of the plane of u and v,
             K = R(u, v, u, v) / (|u|^2 |v|^2 - <u, v>^2);    for two freedoms Gauss's curvature

    On a surface phi = const, with N = J M^-1 J' and u, v tangent (J u = 0),

        (5)  h(u, v) = u^i v^j e_i (J_j) - J D_u v                        second derivatives of phi
        (6)  D_u v + M^-1 J' N^-1 h(u, v)                                   the surface's own
        (7)  R(u, v, u, v) + h(u,u)' N^-1 h(v,v) - h(u,v)' N^-1 h(u,v)      Gauss's equation

    M is the composite-body sweep's, J that of constraintEquations(); derivatives are their runs on
    duals and nested duals: no step size, and over a field they are exact. All arguments are
    components of tangent vectors, length n. Curvature is in 1/(kg m^2), for M is in kg m^2.
    @see M. do Carmo, Riemannian Geometry (1992), chapters 2, 4, 6 (whose R has the other sign) */
template <typename T>
class KineticMetric {
 public:
  using Vector = recursive::VectorX<T>;
  using Matrix = recursive::MatrixX<T>;

  /// Of a tree.
  KineticMetric(const recursive::Model<T>& model, std::vector<scene::JointPosition<T>> x);
  /// On the surface where `rows` of the closures' equations keep the values that they have at x.
  /// None of them may depend on the others.
  KineticMetric(const recursive::Model<T>& model, std::vector<scene::JointPosition<T>> x,
                const recursive::Constraints<T>& closures, std::vector<int> rows);

  int n() const { return model_.dof(); }
  const Matrix& M() const { return M_; }
  const RateFrame& frame() const { return frame_; }
  /// e_k M for every k.
  const std::vector<Matrix>& gradient() const { return dM_; }
  /// Of the equations that keep their values, m x n.
  const Matrix& J() const { return J_; }

  T christoffel(int i, int j, int k) const;
  /// Gamma_i,jk u_j v_k for every i: of the tree.
  Vector christoffel(const Vector& u, const Vector& v) const;
  /// M^-1 w: the second kind from the first.
  Vector raised(Vector w) const;
  T product(const Vector& u, const Vector& v) const { return u.dot(Vector(M_ * v)); }

  /// u^i v^j e_i (J_j), what closures ask of accelerations.
  Vector closureSecond(const Vector& u, const Vector& v);
  /// D_u v, v having constant components; on a surface the part along it, for tangent u and v.
  Vector connection(const Vector& u, const Vector& v);
  /// The shortest a with  J a + closureSecond(u, v) = 0.
  Vector byClosures(const Vector& u, const Vector& v);
  /// The nearest tangent vector.
  Vector tangent(const Vector& u) const;

  /// R_ijkl a_i b_j c_k d_l
  T riemann(const Vector& a, const Vector& b, const Vector& c, const Vector& d);
  T sectional(const Vector& u, const Vector& v);
  Vector unit(int i) const;

 private:
  /// a(<c, d>), components constant.
  T first(const Vector& a, const Vector& c, const Vector& d) const;
  /// a(b(<c, d>)), components constant.
  T second(const Vector& a, const Vector& b, const Vector& c, const Vector& d);
  /// h(a, b)' N^-1 h(c, d)
  T bent(const Vector& a, const Vector& b, const Vector& c, const Vector& d);
  /// Entries (k, j) of J with their derivatives along u.
  template <typename Take>
  void closuresAlong(const Vector& u, Take&& take);

  recursive::Model<T> model_;
  recursive::Model<Dual<T>> once_;
  recursive::Model<Dual<Dual<T>>> twice_;
  recursive::Workspace<Dual<T>> ws_once_;
  recursive::Workspace<Dual<Dual<T>>> ws_;
  RateFrame frame_;
  std::vector<scene::JointPosition<T>> x_;
  Matrix M_, LDL_;
  std::vector<Matrix> dM_;
  std::vector<int> rows_;
  recursive::Constraints<Dual<T>> closures_;
  Matrix J_, by_force_, N_;  ///< M^-1 J', and L D L' of J M^-1 J'
};

// not in the class: what is inline is compiled in every file, extern or not

template <typename T>
KineticMetric<T>::KineticMetric(const recursive::Model<T>& model,
                                std::vector<scene::JointPosition<T>> x)
    : KineticMetric(model, std::move(x), recursive::Constraints<T>(), {}) {}

template <typename T>
KineticMetric<T>::KineticMetric(const recursive::Model<T>& model,
                                std::vector<scene::JointPosition<T>> x,
                                const recursive::Constraints<T>& closures, std::vector<int> rows)
    : model_(model),
      once_(lifted<Dual<T>>(model)),
      twice_(lifted<Dual<Dual<T>>>(model)),
      ws_once_(once_),
      ws_(twice_),
      frame_(model),
      x_(std::move(x)),
      rows_(std::move(rows)) {
  recursive::MatrixX<Dual<T>> M(n(), n());
  M_ = LDL_ = Matrix::Constant(n(), n(), T(0));
  for (int k = 0; k < n(); ++k) {
    recursive::massMatrix(once_, movedAlong(model_, x_, unit(k)), ws_once_, M);
    dM_.push_back(M_);
    for (int i = 0; i < n(); ++i)
      for (int j = 0; j < n(); ++j) {
        M_(i, j) = M(i, j).value;
        dM_.back()(i, j) = M(i, j).derivative;
      }
  }
  LDL_ = M_;
  recursive::factorize(LDL_);
  if (rows_.empty()) return;
  closures_ = lifted<Dual<T>>(closures, n());
  const auto m = static_cast<Eigen::Index>(rows_.size());
  J_ = Matrix(m, n());
  closuresAlong(unit(0),
                [&](Eigen::Index k, int j, const Dual<T>& entry) { J_(k, j) = entry.value; });
  by_force_ = byClosureForces(LDL_, J_);
  N_ = J_ * by_force_;
  recursive::factorize(N_);
}

template <typename T>
T KineticMetric<T>::christoffel(int i, int j, int k) const {
  T twice = dM_[k](i, j) + dM_[j](i, k) - dM_[i](j, k);  // (1)
  for (const RateFrame::Commutator& c : frame_.of(j)) {
    if (c.second == k) twice += M_(c.result, i) * T(c.sign);
    if (c.second == i) twice -= M_(c.result, k) * T(c.sign);
  }
  for (const RateFrame::Commutator& c : frame_.of(k))
    if (c.second == i) twice -= M_(c.result, j) * T(c.sign);
  return twice / T(2);
}

template <typename T>
recursive::VectorX<T> KineticMetric<T>::christoffel(const Vector& u, const Vector& v) const {
  const Vector momentum_u = M_ * u, momentum_v = M_ * v;
  Vector twice = M_ * frame_.commutator(u, v) - frame_.pulledBack(u, momentum_v) -
                 frame_.pulledBack(v, momentum_u);
  for (int k = 0; k < n(); ++k) {
    twice += (dM_[k] * u) * v(k) + (dM_[k] * v) * u(k);
    twice(k) -= u.dot(Vector(dM_[k] * v));
  }
  return twice / T(2);
}

template <typename T>
recursive::VectorX<T> KineticMetric<T>::raised(Vector w) const {  // (2)
  recursive::solve(LDL_, w);
  return w;
}

template <typename T>
recursive::VectorX<T> KineticMetric<T>::closureSecond(const Vector& u, const Vector& v) {
  Vector out = Vector::Constant(J_.rows(), T(0));
  if (!rows_.empty())
    closuresAlong(
        u, [&](Eigen::Index k, int j, const Dual<T>& entry) { out(k) += entry.derivative * v(j); });
  return out;
}

template <typename T>
recursive::VectorX<T> KineticMetric<T>::connection(const Vector& u, const Vector& v) {
  Vector out = raised(christoffel(u, v));
  if (rows_.empty()) return out;
  Vector lambda = closureSecond(u, v) - J_ * out;  // (5)
  recursive::solve(N_, lambda);
  return out + by_force_ * lambda;  // (6)
}

template <typename T>
recursive::VectorX<T> KineticMetric<T>::byClosures(const Vector& u, const Vector& v) {
  if (rows_.empty()) return Vector::Constant(n(), T(0));
  Vector lambda = closureSecond(u, v);
  recursive::solve(N_, lambda);
  return -(by_force_ * lambda);
}

template <typename T>
recursive::VectorX<T> KineticMetric<T>::tangent(const Vector& u) const {
  if (rows_.empty()) return u;
  Vector lambda = J_ * u;
  recursive::solve(N_, lambda);
  return u - by_force_ * lambda;
}

template <typename T>
T KineticMetric<T>::riemann(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
  T twice = second(a, d, b, c) + second(b, c, a, d) - second(a, c, b, d) - second(b, d, a, c);
  T of_tree = christoffel(a, d).dot(raised(christoffel(b, c))) -
              christoffel(b, d).dot(raised(christoffel(a, c)));
  if (!frame_.commutes()) {
    const Vector ab = frame_.commutator(a, b), dc = frame_.commutator(d, c);
    twice += first(ab, c, d) + first(a, frame_.commutator(b, d), c) -
             first(a, frame_.commutator(b, c), d) - first(a, dc, b) -
             first(b, frame_.commutator(a, d), c) + first(b, frame_.commutator(a, c), d) +
             first(b, dc, a);
    of_tree -= c.dot(christoffel(ab, d));
  }
  of_tree += twice / T(2);  // (3)
  if (rows_.empty()) return of_tree;
  return of_tree + bent(a, c, b, d) - bent(a, d, b, c);  // (7)
}

template <typename T>
T KineticMetric<T>::sectional(const Vector& u, const Vector& v) {
  const T across = product(u, v);
  return riemann(u, v, u, v) / (product(u, u) * product(v, v) - across * across);  // (4)
}

template <typename T>
recursive::VectorX<T> KineticMetric<T>::unit(int i) const {
  Vector e = Vector::Constant(n(), T(0));
  e(i) = T(1);
  return e;
}

template <typename T>
T KineticMetric<T>::first(const Vector& a, const Vector& c, const Vector& d) const {
  T sum = T(0);
  for (int k = 0; k < n(); ++k) sum += a(k) * c.dot(Vector(dM_[k] * d));
  return sum;
}

template <typename T>
T KineticMetric<T>::second(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
  recursive::VectorX<Dual<T>> later(n());
  for (int i = 0; i < n(); ++i) later(i) = Dual<T>(b(i));
  recursive::MatrixX<Dual<Dual<T>>> M(n(), n());
  recursive::massMatrix(twice_, movedAlong(once_, movedAlong(model_, x_, a), later), ws_, M);
  T sum = T(0);
  for (int i = 0; i < n(); ++i)
    for (int j = 0; j < n(); ++j) sum += c(i) * M(i, j).derivative.derivative * d(j);
  return sum;
}

template <typename T>
T KineticMetric<T>::bent(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
  const auto h = [&](const Vector& u, const Vector& v) {
    return Vector(closureSecond(u, v) - J_ * raised(christoffel(u, v)));  // (5)
  };
  Vector lambda = h(c, d);
  recursive::solve(N_, lambda);
  return h(a, b).dot(lambda);
}

template <typename T>
template <typename Take>
void KineticMetric<T>::closuresAlong(const Vector& u, Take&& take) {
  const std::vector<Dual<T>> rest(n(), Dual<T>(T(0)));
  recursive::constraintEquations(once_, movedAlong(model_, x_, u), rest, ws_once_, closures_);
  for (std::size_t k = 0; k < rows_.size(); ++k)
    for (int j = 0; j < n(); ++j) take(static_cast<Eigen::Index>(k), j, closures_.J(rows_[k], j));
}

// over the field: compiled once (kinetic_metric_in_field.cpp)
extern template class KineticMetric<PrimeField>;

}  // namespace dynwitness::crosscheck
