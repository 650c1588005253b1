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
  bool is_real = false;     ///< proven: its enclosure meets the real axis and no other enclosure
  Eigen::VectorXcd right;   ///< eigenvector, the largest entry 1; empty where it is not enclosed
  Eigen::VectorXd reached;  ///< by column b of B: a lower bound of |l' b| / (|l| |b|), l the left
                            ///< eigenvector; 0: not proven to be reached. Empty as `right` is
};

struct EnclosedModes {
  std::vector<EnclosedMode> modes;  ///< all, conjugates too: by falling real part, then imaginary
  bool are_simple = false;  ///< each enclosure holds one eigenvalue. Else those of a cluster share
                            ///< one
  std::string failure;      ///< why there is none
};

/** All eigenvalues of every matrix within the bounds of A, in balls: an approximate decomposition,
    then Krawczyk's operator for each pair (Arb's acb_mat_eig_simple), and where eigenvalues are
    multiple, or too near to each other for what the entries leave open, Rump's enclosures of
    clusters (acb_mat_eig_multiple).
    @param B  rows as A, any number of columns
    @see S. M. Rump, Computational error bounds for multiple or nearly multiple eigenvalues, Linear
         Algebra and its Applications 324 (2001) */
EnclosedModes enclosedModes(const Bounded& A, const Bounded& B);

/** A lower bound of the rank of [B, A B, A^2 B, ...], proven: elimination in balls, with pivots
    that cannot be 0. */
int reachableDimension(const Bounded& A, const Bounded& B);

}  // namespace dynwitness::crosscheck
