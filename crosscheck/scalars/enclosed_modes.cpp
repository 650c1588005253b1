// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/enclosed_modes.hpp"

#include <algorithm>
#include <cmath>

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

EnclosedMode modeOf(const acb_t value) {
  EnclosedMode out;
  out.value = middle(value);
  out.radius_re = radius(acb_realref(value));
  out.radius_im = radius(acb_imagref(value));
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
  double l = 0, b = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    acb_addmul(sum.get(), L(k, i), B(i, column), kBits);
    l += std::norm(middle(L(k, i)));
    b += std::norm(middle(B(i, column)));
  }
  arf_t least;
  arf_init(least);
  acb_get_abs_lbound_arf(least, sum.get(), kBits);
  const double out = arf_get_d(least, ARF_RND_DOWN);
  arf_clear(least);
  return out > 0 ? out / std::sqrt(l * b) : 0;
}

}  // namespace

EnclosedModes enclosedModes(const Bounded& A, const Bounded& B) {
  EnclosedModes out;
  const Eigen::Index n = A.value.rows();
  if (!A.value.allFinite() || !A.bound.allFinite()) {
    out.failure = "the matrix is not finite";
    return out;
  }
  ComplexMatrix a(n, n), b(n, B.value.cols()), L(n, n), R(n, n), near_R(n, n);
  ComplexVector E(n), near_E(n);
  set(a, A);
  set(b, B);
  acb_mat_approx_eig_qr(near_E.get(), nullptr, near_R.get(), a.get(), nullptr, 0, kBits);
  out.are_simple = acb_mat_eig_simple(E.get(), L.get(), R.get(), a.get(), near_E.get(),
                                      near_R.get(), kBits) != 0;
  if (!out.are_simple) acb_mat_eig_multiple(E.get(), a.get(), near_E.get(), near_R.get(), kBits);
  for (Eigen::Index k = 0; k < n; ++k) {
    if (!acb_is_finite(E[k])) {
      out.failure = "its eigenvalues are too near to each other, or its entries known too loosely";
      out.modes.clear();
      return out;
    }
    EnclosedMode mode = modeOf(E[k]);
    if (out.are_simple) {
      // the conjugate of an eigenvalue is one too: alone in an enclosure that meets the axis, it is
      // its own
      mode.is_real = arb_contains_zero(acb_imagref(E[k])) != 0;
      if (mode.is_real) mode.value.imag(0), mode.radius_im = 0;
      mode.right = shapeOf(R, k, n);
      mode.reached = Eigen::VectorXd(B.value.cols());
      for (Eigen::Index j = 0; j < B.value.cols(); ++j) mode.reached(j) = reach(L, k, b, j, n);
    }
    out.modes.push_back(std::move(mode));
  }
  std::sort(out.modes.begin(), out.modes.end(), [](const EnclosedMode& x, const EnclosedMode& y) {
    if (x.value.real() != y.value.real()) return x.value.real() > y.value.real();
    if (std::abs(x.value.imag()) != std::abs(y.value.imag()))
      return std::abs(x.value.imag()) < std::abs(y.value.imag());
    return x.value.imag() > y.value.imag();
  });
  return out;
}

int reachableDimension(const Bounded& A, const Bounded& B) {
  const Eigen::Index n = A.value.rows(), m = B.value.cols();
  if (m == 0) return 0;
  ComplexMatrix a(n, n), block(n, m), next(n, m), K(n, n * m);
  set(a, A);
  set(block, B);
  // in another unit of time, so that powers of A neither grow nor vanish: the rank stays
  const double size = A.value.norm();
  const slong shift = size > 0 ? -std::ilogb(size) : 0;
  acb_mat_scalar_mul_2exp_si(a.get(), a.get(), shift);
  for (Eigen::Index power = 0; power < n; ++power) {
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
  for (; rank < n; ++rank) {
    Eigen::Index row = -1, column = -1;
    arf_zero(best);
    for (Eigen::Index i = rank; i < n; ++i)
      for (Eigen::Index j = rank; j < n * m; ++j) {
        acb_get_abs_lbound_arf(here, K(i, j), kBits);
        if (arf_cmp(here, best) <= 0) continue;
        arf_set(best, here);
        row = i, column = j;
      }
    if (row < 0) break;
    for (Eigen::Index j = 0; j < n * m; ++j) acb_swap(K(row, j), K(rank, j));
    for (Eigen::Index i = 0; i < n; ++i) acb_swap(K(i, column), K(i, rank));
    for (Eigen::Index i = rank + 1; i < n; ++i) {
      acb_div(factor.get(), K(i, rank), K(rank, rank), kBits);
      for (Eigen::Index j = rank; j < n * m; ++j)
        acb_submul(K(i, j), factor.get(), K(rank, j), kBits);
    }
  }
  arf_clear(best);
  arf_clear(here);
  return rank;
}

}  // namespace dynwitness::crosscheck
