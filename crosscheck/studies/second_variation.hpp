// SPDX-License-Identifier: GPL-3.0-or-later
// The second variation of the action: how many directions lower it.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "crosscheck/studies/action_problem.hpp"

namespace dynwitness::crosscheck::hamilton {

/// Second derivatives of L by (zeta, zeta') at each node, 2 n x 2 n.
std::vector<Eigen::MatrixXd> hessians(const Problem& problem, const std::vector<Node>& nodes);

/// The second variation less `least` of its kinetic part, between two nodes that straight lines
/// join: a block each for the ends, and one between them.
struct Element {
  Eigen::MatrixXd left, right, across;
};
/// Of every `2 stride` steps one: Simpson's three nodes.
std::vector<Element> elements(const Problem& problem, const std::vector<Eigen::MatrixXd>& H,
                              int stride, double least);

/** Negative directions of the second variation on all variations that are straight between every
    `2 stride`-th node and 0 at both ends. Block by block, M = L D L' of a block-tridiagonal matrix:
   as many as the blocks of D have negative eigenvalues (Sylvester). A subspace can miss a direction
   of the true second variation, never add one; the finer it is, the fewer it misses.
    @param least  counts eigenvalues over the kinetic part below this one, which is below 1 */
int negativeDirections(const Problem& problem, const std::vector<Eigen::MatrixXd>& H, int stride,
                       double least = 0);

/// The `number`-th lowest eigenvalue of the second variation over its kinetic part, at most 1.
double eigenvalue(const Problem& problem, const std::vector<Eigen::MatrixXd>& H, int number);

}  // namespace dynwitness::crosscheck::hamilton
