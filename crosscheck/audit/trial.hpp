// SPDX-License-Identifier: GPL-3.0-or-later
// Ways to compute a statement: exactly over a prime field, or with certified digits.
#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "crosscheck/audit/audit.hpp"
#include "crosscheck/audit/products.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/scalars/dual.hpp"
#include "crosscheck/scalars/formula_sizes.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "recursive/spatial.hpp"
#include "scene/matrix.hpp"

namespace dynwitness::audit {

using crosscheck::Ball;
using crosscheck::Dual;
using crosscheck::FieldSource;
using crosscheck::PrimeField;
using recursive::Force;
using recursive::Matrix3;
using recursive::Matrix6;
using recursive::Motion;
using recursive::RigidInertia;
using recursive::skew;
using recursive::Symmetric3;
using recursive::Transform;
using recursive::Vector3;
using recursive::Vector6;

/// The scalar of exact statements; templates over others (Jet<T>, Ball) have a T of their own.
using T = PrimeField;

using scene::MatrixX;
using scene::VectorX;

/// left - right, entry by entry, of one named comparison.
template <typename T>
struct Difference {
  std::string what;
  std::vector<T> entries;
};

/** A random point and what is compared there: the argument of a statement's function.

    Numbers are drawn one after the other, so the same function draws the same point in every
    arithmetic. */
class Point {
 public:
  explicit Point(FieldSource source) : source_(std::move(source)) {}

  T number() { return source_.element(std::to_string(++drawn_)); }
  Vector3<T> vector() {
    const T x = number(), y = number(), z = number();
    return {x, y, z};
  }
  template <int Rows, int Cols>
  Eigen::Matrix<T, Rows, Cols> matrix() {
    Eigen::Matrix<T, Rows, Cols> m;
    for (int j = 0; j < Cols; ++j)
      for (int i = 0; i < Rows; ++i) m(i, j) = number();
    return m;
  }
  Vector6<T> vector6() { return matrix<6, 1>(); }
  Motion<T> motion() {
    const Vector3<T> v = vector();
    return {v, vector()};
  }
  Force<T> force() {
    const Vector3<T> f = vector();
    return {f, vector()};
  }
  /// Any symmetric matrix.
  template <int N>
  Eigen::Matrix<T, N, N> symmetric() {
    Eigen::Matrix<T, N, N> m;
    for (int j = 0; j < N; ++j)
      for (int i = 0; i <= j; ++i) m(i, j) = m(j, i) = number();
    return m;
  }
  /// (cos, sin) of any angle
  scene::CosSin<T> angle() { return source_.circlePoint(std::to_string(++drawn_)); }
  /// A proper rotation: that of any quaternion but those of length zero.
  Matrix3<T> rotation() {
    const T w = number();
    return rotationOf<T>(w, vector());
  }
  /// Any transformation of coordinates X_BA.
  Transform<T> transform() {
    const Matrix3<T> R = rotation();
    return {R, vector()};
  }

  /// @param what  "our code ..." where one side is what a file of the repository answers
  void equal(const char* what, const T& left, const T& right) {
    differences_.push_back({what, {left - right}});
  }
  void equal(const char* what, const Motion<T>& left, const Motion<T>& right) {
    equal(what, left.vector(), right.vector());
  }
  void equal(const char* what, const Force<T>& left, const Force<T>& right) {
    equal(what, left.vector(), right.vector());
  }
  template <typename A, typename B>
  void equal(const char* what, const Eigen::MatrixBase<A>& left,
             const Eigen::MatrixBase<B>& right) {
    static_assert(std::is_same_v<typename A::Scalar, T> && std::is_same_v<typename B::Scalar, T>);
    Difference<T> difference{what, {}};
    for (Eigen::Index i = 0; i < left.rows(); ++i)
      for (Eigen::Index j = 0; j < left.cols(); ++j)
        difference.entries.push_back(left(i, j) - right(i, j));
    differences_.push_back(std::move(difference));
  }
  template <typename A>
  void zero(const char* what, const Eigen::MatrixBase<A>& left) {
    equal(what, left,
          Eigen::Matrix<T, A::RowsAtCompileTime, A::ColsAtCompileTime>::Constant(
              left.rows(), left.cols(), T(0)));
  }
  void zero(const char* what, const T& left) { equal(what, left, T(0)); }

  const std::vector<Difference<T>>& differences() const { return differences_; }

  /// The rotation of a quaternion (w, u) of any length but zero, by rational arithmetic.
  template <typename S>
  static Matrix3<S> rotationOf(const S& w, const Vector3<S>& u);

 private:
  FieldSource source_;
  int drawn_ = 0;
  std::vector<Difference<T>> differences_;
};

template <typename S>
Matrix3<S> Point::rotationOf(const S& w, const Vector3<S>& u) {
  const S scale = S(1) / (w * w + u.dot(u));
  Matrix3<S> R = u * u.transpose() * (S(2) * scale) + skew<S>(u) * (S(2) * scale * w);
  const S diagonal = (w * w - u.dot(u)) * scale;
  for (int i = 0; i < 3; ++i) R(i, i) += diagonal;
  return R;
}

using ExactStatement = std::function<void(Point&)>;

/** Decides an equation over a prime field: zero at as many random points as make the chance that
    different formulas pass at most 1e-30 (formula_sizes.hpp derives it), or a point where it is not
    zero.

    @param statement  called as statement(at) with a Point: draws its indeterminates from it,
    computes both sides by roads of their own, and says at.equal("what", left, right) for each
    equation that the statement makes. What the statement assumes is how the point is drawn. */
Trial exact(ExactStatement statement);

/// The opposite of exact(): the sides are said to differ, and one point where they do proves it.
Trial differs(ExactStatement statement);

/// Both: the first that fails decides.
Trial both(Trial first, Trial second);

/** A random point of real numbers, and the inequalities that are claimed there. */
class RealPoint {
 public:
  using Scalar = Ball;
  RealPoint(const std::string& name, std::uint64_t seed, std::uint64_t index)
      : random_(name, seed, index) {}

  Ball number(double low, double high) { return {random_.uniform(low, high)}; }
  Vector3<Ball> vector(double low = -1, double high = 1) {
    const Ball x = number(low, high), y = number(low, high), z = number(low, high);
    return {x, y, z};
  }
  /// Claims value > 0.
  void positive(const char* what, const Ball& value) { claims_.emplace_back(what, value); }

  const std::vector<std::pair<std::string, Ball>>& claims() const { return claims_; }

 private:
  crosscheck::RandomStream random_;
  std::vector<std::pair<std::string, Ball>> claims_;
};

/** Decides an inequality with certified digits at `points` random points: each value that is
    claimed positive is enclosed, with more digits until the enclosure excludes 0. A negative one
    refutes. That all are positive is certain for these points, and for no others. */
Trial certified(std::function<void(RealPoint&)> statement, int points = 20);

/// What one computation decided, and the words that say what was found.
struct Decision {
  bool holds;
  std::string found;
};
/// A statement that a single computation decides: one counterexample, a count of operations. It is
/// computed when the trial runs.
Trial decided(std::string method, std::function<Decision()> compute);

}  // namespace dynwitness::audit
