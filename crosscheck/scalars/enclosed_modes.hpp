// SPDX-License-Identifier: GPL-3.0-or-later
// Eigenvalues of a real matrix whose entries are known within bounds, enclosed.
#pragma once

#include <complex>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/scalars/bounded.hpp"

namespace dynwitness::crosscheck {

/// An eigenvalue: |Re - re| <= radius_re, |Im - im| <= radius_im, proven.
struct EnclosedMode {
  std::complex<double> value;
  double radius_re = 0, radius_im = 0;
  bool is_real = false;     ///< proven
  Eigen::VectorXcd right;   ///< eigenvector, the largest entry 1; empty where it is not enclosed
  Eigen::VectorXd reached;  ///< by column b of B: a lower bound of |l' b| / (|l| |b|), l the left
                            ///< eigenvector; 0: not proven to be reached. Empty as `right` is
};

struct EnclosedModes {
  std::vector<EnclosedMode> modes;  ///< all, conjugates too: by falling real part, then imaginary
  bool are_simple = false;  ///< each enclosure holds one eigenvalue. Else those of a cluster share
                            ///< one
  std::string failure;      ///< why some are approximations alone, with infinite radii
};

/** All eigenvalues of every matrix within the bounds of A, in balls: an approximate decomposition,
    then certified as a whole (Arb's acb_mat_eig_simple), and where eigenvalues are
    multiple, or too near to each other for what the entries leave open, Rump's enclosures of
    clusters (acb_mat_eig_multiple), of each block by itself that zeros of A leave: coordinates that
    drive each other in a circle. Where a cluster defies that, each eigenvalue by itself (Rump
    again), and those of the cluster are approximations.
    @param B  rows as A, any number of columns
    @see J. van der Hoeven, B. Mourrain, Efficient certification of numeric solutions to
         eigenproblems (2017); S. M. Rump, Computational error bounds for multiple or nearly
         multiple eigenvalues, Linear Algebra and its Applications 324 (2001) */
EnclosedModes enclosedModes(const Bounded& A, const Bounded& B);

/** Those of [0 1; K 0], K n x n, from the eigenvalues mu of K: lambda = +- sqrt(mu), with
    (v, lambda v) on the right and (lambda w, w) on the left; `reached` is of w. What oscillates
    without loss lies on the axis exactly, and a root that is 0 twice, with one eigenvector, is a
    single one of K.
    @param B  the lower half of that of A, n rows */
EnclosedModes enclosedOscillations(const Bounded& K, const Bounded& B);

/** A lower bound of the rank of [B, A B, A^2 B, ...], proven: elimination in balls, with pivots
    that cannot be 0. */
int reachableDimension(const Bounded& A, const Bounded& B);

}  // namespace dynwitness::crosscheck
