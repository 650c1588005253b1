// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/enclosed_modes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <acb_mat.h>
#include <arb.h>

namespace dynwitness::crosscheck {
namespace {

constexpr slong kBits = 192;

/// A number of Arb's, set free with its scope.
class Complex {
 public:
  Complex() { acb_init(x_); }
  ~Complex() { acb_clear(x_); }
  Complex(const Complex&) = delete;
  Complex& operator=(const Complex&) = delete;
  acb_ptr get() { return x_; }

 private:
  acb_t x_;
};
class ComplexMatrix {
 public:
  ComplexMatrix(Eigen::Index rows, Eigen::Index columns) { acb_mat_init(x_, rows, columns); }
  ~ComplexMatrix() { acb_mat_clear(x_); }
  ComplexMatrix(const ComplexMatrix&) = delete;
  ComplexMatrix& operator=(const ComplexMatrix&) = delete;
  acb_mat_struct* get() { return x_; }
  acb_ptr operator()(Eigen::Index i, Eigen::Index j) { return acb_mat_entry(x_, i, j); }

 private:
  acb_mat_t x_;
};
class ComplexVector {
 public:
  explicit ComplexVector(Eigen::Index size) : size_(size), x_(_acb_vec_init(size)) {}
  ~ComplexVector() { _acb_vec_clear(x_, size_); }
  ComplexVector(const ComplexVector&) = delete;
  ComplexVector& operator=(const ComplexVector&) = delete;
  acb_ptr get() { return x_; }
  acb_ptr operator[](Eigen::Index k) { return x_ + k; }

 private:
  slong size_;
  acb_ptr x_;
};

void set(acb_ptr out, double value, double bound) {
  acb_set_d(out, value);
  mag_t error;
  mag_init(error);
  mag_set_d(error, bound);
  arb_add_error_mag(acb_realref(out), error);
  mag_clear(error);
}
void set(ComplexMatrix& out, const Bounded& from) {
  for (Eigen::Index i = 0; i < from.value.rows(); ++i)
    for (Eigen::Index j = 0; j < from.value.cols(); ++j)
      set(out(i, j), from.value(i, j), from.bound(i, j));
}

double middle(const arb_t x) {
  return arf_get_d(arb_midref(x), ARF_RND_NEAR);
}
/// Around middle(), which is rounded.
double radius(const arb_t x) {
  arb_t off;
  arb_init(off);
  arb_set_d(off, middle(x));
  arb_sub(off, x, off, kBits);
  arf_t most;
  arf_init(most);
  arb_get_abs_ubound_arf(most, off, kBits);
  const double out = arf_get_d(most, ARF_RND_UP);
  arf_clear(most);
  arb_clear(off);
  return out;
}
std::complex<double> middle(const acb_t x) {
  return {middle(acb_realref(x)), middle(acb_imagref(x))};
}

EnclosedMode modeOf(const acb_t value, bool is_enclosed) {
  EnclosedMode out;
  out.value = middle(value);
  constexpr double kNone = std::numeric_limits<double>::infinity();
  out.radius_re = is_enclosed ? radius(acb_realref(value)) : kNone;
  out.radius_im = is_enclosed ? radius(acb_imagref(value)) : kNone;
  return out;
}

Eigen::VectorXcd shapeOf(ComplexMatrix& R, Eigen::Index k, Eigen::Index n) {
  Eigen::VectorXcd out(n);
  for (Eigen::Index i = 0; i < n; ++i) out(i) = middle(R(i, k));
  Eigen::Index largest = 0;
  out.cwiseAbs().maxCoeff(&largest);
  return out / out(largest);
}

/// |l' b| / (|l| |b|), from below. @param L  left eigenvectors, by row
double reach(ComplexMatrix& L, Eigen::Index k, ComplexMatrix& B, Eigen::Index column,
             Eigen::Index n) {
  Complex sum;
  mag_t l, b, one;
  for (mag_ptr x : {l, b, one}) mag_init(x);
  for (Eigen::Index i = 0; i < n; ++i) {
    acb_addmul(sum.get(), L(k, i), B(i, column), kBits);
    acb_get_mag(one, L(k, i));
    mag_addmul(l, one, one);
    acb_get_mag(one, B(i, column));
    mag_addmul(b, one, one);
  }
  mag_mul(l, l, b);
  mag_sqrt(l, l);  // rounded up
  arf_t least, most;
  arf_init(least);
  arf_init(most);
  acb_get_abs_lbound_arf(least, sum.get(), kBits);
  arf_set_mag(most, l);
  double out = 0;
  if (arf_sgn(least) > 0) {
    arf_div(least, least, most, kBits, ARF_RND_DOWN);
    out = arf_get_d(least, ARF_RND_DOWN);
  }
  arf_clear(least);
  arf_clear(most);
  for (mag_ptr x : {l, b, one}) mag_clear(x);
  return out;
}

/// Eigenvalues of every matrix within the bounds, and their vectors.
class Decomposition {
 public:
  explicit Decomposition(const Bounded& of)
      : n(of.value.rows()), values(n), left(n, n), right(n, n), near_values_(n) {
    if (!of.value.allFinite() || !of.bound.allFinite()) {
      failure = "the matrix is not finite";
      return;
    }
    ComplexMatrix a(n, n), near_right(n, n);
    set(a, of);
    acb_mat_approx_eig_qr(near_values_.get(), nullptr, near_right.get(), a.get(), nullptr, 0,
                          kBits);
    are_simple = acb_mat_eig_simple(values.get(), left.get(), right.get(), a.get(),
                                    near_values_.get(), near_right.get(), kBits) != 0;
    if (are_simple) return;
    acb_mat_eig_multiple(values.get(), a.get(), near_values_.get(), near_right.get(), kBits);
    for (Eigen::Index k = 0; k < n; ++k)
      if (!acb_is_finite(values[k]))
        failure = "some are too near to each other, or entries known too loosely";
    if (failure.empty()) return;
    for (Eigen::Index k = 0; k < n; ++k) encloseAlone(a, near_right, k);
  }
  bool isEnclosed(Eigen::Index k) const { return failure.empty() || is_alone_[k] != 0; }

  const Eigen::Index n;
  ComplexVector values;
  ComplexMatrix left, right;  ///< by row, by column; where they are simple
  bool are_simple = false;
  std::string failure;  ///< values are approximations, but for those that isEnclosed()

 private:
  /// What cannot be enclosed with all may be by itself (Rump), however near others are.
  void encloseAlone(ComplexMatrix& a, ComplexMatrix& near_right, Eigen::Index k) {
    if (!acb_is_finite(near_values_[k])) {
      acb_zero(values[k]);  // what is no number has no place in an order
      return;
    }
    ComplexMatrix near_vector(n, 1), vector(n, 1);
    for (Eigen::Index i = 0; i < n; ++i) acb_set(near_vector(i, 0), near_right(i, k));
    acb_mat_eig_enclosure_rump(values[k], nullptr, vector.get(), a.get(), near_values_[k],
                               near_vector.get(), kBits);
    is_alone_[k] = acb_is_finite(values[k]) != 0;
    if (!is_alone_[k]) acb_set(values[k], near_values_[k]);
  }

  ComplexVector near_values_;
  Eigen::Matrix<char, Eigen::Dynamic, 1> is_alone_ =
      Eigen::Matrix<char, Eigen::Dynamic, 1>::Zero(n);
};

/// The conjugate of an eigenvalue is one too: where the conjugate of an enclosure meets no other
/// enclosure, and they are simple, the eigenvalue is its own.
void makeReal(ComplexVector& values, Eigen::Index k, Eigen::Index n) {
  if (!arb_contains_zero(acb_imagref(values[k]))) return;
  Complex mirrored;
  acb_conj(mirrored.get(), values[k]);
  for (Eigen::Index j = 0; j < n; ++j)
    if (j != k && acb_overlaps(mirrored.get(), values[j])) return;
  arb_zero(acb_imagref(values[k]));
}

/// Puts a mode of A in.
void add(EnclosedModes& out, const acb_t value, bool is_enclosed, Eigen::VectorXcd right,
         Eigen::VectorXd reached) {
  EnclosedMode mode = modeOf(value, is_enclosed);
  if (out.are_simple) {
    mode.is_real = arb_is_zero(acb_imagref(value)) != 0;
    mode.right = std::move(right);
    mode.reached = std::move(reached);
  }
  out.modes.push_back(std::move(mode));
}

/// Indices that reach each other through entries that are not exactly 0: the eigenvalues of the
/// matrix are those of these blocks.
std::vector<std::vector<Eigen::Index>> blocksOf(const Bounded& A) {
  const Eigen::Index n = A.value.rows();
  Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> reaches =
      A.value.array() != 0 || A.bound.array() != 0;
  for (Eigen::Index k = 0; k < n; ++k)
    for (Eigen::Index i = 0; i < n; ++i)
      if (reaches(i, k))
        for (Eigen::Index j = 0; j < n; ++j) reaches(i, j) = reaches(i, j) || reaches(k, j);
  std::vector<std::vector<Eigen::Index>> out;
  std::vector<char> is_in(static_cast<std::size_t>(n), 0);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (is_in[static_cast<std::size_t>(i)]) continue;
    out.push_back({});
    for (Eigen::Index j = i; j < n; ++j)
      if (j == i || (reaches(i, j) && reaches(j, i))) {
        out.back().push_back(j);
        is_in[static_cast<std::size_t>(j)] = 1;
      }
  }
  return out;
}
Bounded blockOf(const Bounded& A, const std::vector<Eigen::Index>& at) {
  return {A.value(at, at), A.bound(at, at)};
}

void sort(EnclosedModes& out) {
  std::sort(out.modes.begin(), out.modes.end(), [](const EnclosedMode& x, const EnclosedMode& y) {
    if (x.value.real() != y.value.real()) return x.value.real() > y.value.real();
    if (std::abs(x.value.imag()) != std::abs(y.value.imag()))
      return std::abs(x.value.imag()) < std::abs(y.value.imag());
    return x.value.imag() > y.value.imag();
  });
}

Eigen::VectorXd reachOf(Decomposition& d, Eigen::Index k, ComplexMatrix& b, Eigen::Index columns) {
  Eigen::VectorXd out(columns);
  for (Eigen::Index j = 0; j < columns; ++j) out(j) = reach(d.left, k, b, j, d.n);
  return out;
}

EnclosedModes wholeModes(const Bounded& A, const Bounded& B) {
  Decomposition d(A);
  EnclosedModes out{{}, d.are_simple, d.failure};
  ComplexMatrix b(d.n, B.value.cols());
  set(b, B);
  for (Eigen::Index k = 0; k < d.n; ++k) {
    if (d.are_simple) makeReal(d.values, k, d.n);
    add(out, d.values[k], d.isEnclosed(k), shapeOf(d.right, k, d.n),
        reachOf(d, k, b, B.value.cols()));
  }
  sort(out);
  return out;
}

EnclosedModes wholeOscillations(const Bounded& K, const Bounded& B) {
  Decomposition d(K);
  // 0 itself is an eigenvalue: where they are simple, the one whose enclosure holds it
  const std::vector<std::vector<Eigen::Index>> blocks = blocksOf(K);
  const bool has_exact_zero = std::any_of(blocks.begin(), blocks.end(), [&](const auto& at) {
    return at.size() == 1 && K.value(at[0], at[0]) == 0 && K.bound(at[0], at[0]) == 0;
  });
  EnclosedModes out{{}, d.are_simple, d.failure};
  ComplexMatrix b(d.n, B.value.cols());
  set(b, B);
  Complex root;
  for (Eigen::Index k = 0; k < d.n; ++k) {
    acb_ptr mu = d.values[k];
    if (d.are_simple) makeReal(d.values, k, d.n);
    if (arb_is_negative(acb_realref(mu))) {  // beside the cut of the square root
      acb_neg(root.get(), mu);
      acb_sqrt(root.get(), root.get(), kBits);
      acb_mul_onei(root.get(), root.get());
    } else {
      acb_sqrt(root.get(), mu, kBits);
    }
    if (acb_contains_zero(mu)) {  // any root of anything within
      mag_t bound;
      mag_init(bound);
      if (!(has_exact_zero && d.are_simple)) acb_get_mag(bound, mu);
      mag_sqrt(bound, bound);
      acb_zero(root.get());
      arb_add_error_mag(acb_realref(root.get()), bound);
      arb_add_error_mag(acb_imagref(root.get()), bound);
      mag_clear(bound);
    }
    const Eigen::VectorXcd v = shapeOf(d.right, k, d.n);
    const Eigen::VectorXd reached = reachOf(d, k, b, B.value.cols());
    for (int side = 0; side < 2; ++side) {
      const std::complex<double> lambda = middle(root.get());
      Eigen::VectorXcd whole(2 * d.n);
      whole << v, lambda * v;
      Eigen::Index largest = 0;
      whole.cwiseAbs().maxCoeff(&largest);
      add(out, root.get(), d.isEnclosed(k), whole / whole(largest), reached);
      acb_neg(root.get(), root.get());
    }
  }
  sort(out);
  return out;
}

/// As a whole where that is enclosed with its vectors, else block by block without.
template <typename Whole>
EnclosedModes byBlocks(const Bounded& A, const Bounded& B, const Whole& whole) {
  EnclosedModes out = whole(A, B);
  const std::vector<std::vector<Eigen::Index>> blocks = blocksOf(A);
  if (out.are_simple || blocks.size() < 2) return out;
  out = {};
  for (const std::vector<Eigen::Index>& at : blocks) {
    const Eigen::MatrixXd none(static_cast<Eigen::Index>(at.size()), 0);
    EnclosedModes part = whole(blockOf(A, at), {none, none});
    if (out.failure.empty()) out.failure = part.failure;
    for (EnclosedMode& mode : part.modes) {
      mode.right.resize(0);
      mode.reached.resize(0);
      out.modes.push_back(std::move(mode));
    }
  }
  sort(out);
  return out;
}

}  // namespace

EnclosedModes enclosedModes(const Bounded& A, const Bounded& B) {
  return byBlocks(A, B, wholeModes);
}

EnclosedModes enclosedOscillations(const Bounded& K, const Bounded& B) {
  return byBlocks(K, B, wholeOscillations);
}

namespace {

/// Of [B, A B, ...], so many blocks.
int reachableIn(const Bounded& A, const Bounded& B, Eigen::Index powers) {
  const Eigen::Index n = A.value.rows(), m = B.value.cols();
  ComplexMatrix a(n, n), block(n, m), next(n, m), K(n, powers * m);
  set(a, A);
  set(block, B);
  // in another unit of time, so that powers of A neither grow nor vanish: the rank stays
  const double size = A.value.norm();
  const slong shift = size > 0 ? -std::ilogb(size) : 0;
  acb_mat_scalar_mul_2exp_si(a.get(), a.get(), shift);
  for (Eigen::Index power = 0; power < powers; ++power) {
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < m; ++j) acb_set(K(i, power * m + j), block(i, j));
    acb_mat_mul(next.get(), a.get(), block.get(), kBits);
    acb_mat_swap(next.get(), block.get());
  }
  // elimination with full pivoting, by the largest number that is certainly not 0
  int rank = 0;
  arf_t best, here;
  arf_init(best);
  arf_init(here);
  Complex factor;
  for (; rank < std::min(n, powers * m); ++rank) {
    Eigen::Index row = -1, column = -1;
    arf_zero(best);
    for (Eigen::Index i = rank; i < n; ++i)
      for (Eigen::Index j = rank; j < powers * m; ++j) {
        acb_get_abs_lbound_arf(here, K(i, j), kBits);
        if (arf_cmp(here, best) <= 0) continue;
        arf_set(best, here);
        row = i, column = j;
      }
    if (row < 0) break;
    for (Eigen::Index j = 0; j < powers * m; ++j) acb_swap(K(row, j), K(rank, j));
    for (Eigen::Index i = 0; i < n; ++i) acb_swap(K(i, column), K(i, rank));
    for (Eigen::Index i = rank + 1; i < n; ++i) {
      acb_div(factor.get(), K(i, rank), K(rank, rank), kBits);
      for (Eigen::Index j = rank; j < powers * m; ++j)
        acb_submul(K(i, j), factor.get(), K(rank, j), kBits);
    }
  }
  arf_clear(best);
  arf_clear(here);
  return rank;
}

}  // namespace

int reachableDimension(const Bounded& A, const Bounded& B) {
  const Eigen::Index n = A.value.rows();
  if (B.value.cols() == 0) return 0;
  // forces of all joints reach all at once and with their first power
  int rank = 0;
  for (Eigen::Index powers = 2;; powers *= 2) {
    rank = std::max(rank, reachableIn(A, B, std::min(powers, n)));
    if (rank == n || powers >= n) return rank;
  }
}

}  // namespace dynwitness::crosscheck
