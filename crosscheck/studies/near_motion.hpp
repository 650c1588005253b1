// SPDX-License-Identifier: GPL-3.0-or-later
// T - V and Q on paths near a motion, in any scalar. Compiled once a scalar: near_motion_in_*.cpp.
#pragma once

#include <vector>

#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/studies/action_problem.hpp"

namespace dynwitness::crosscheck::hamilton {

/** Energies and forces at q + B(q) zeta, B taking rates to rates of slots: what a variation zeta
   with rates zeta' makes of the motion, in any scalar. Of closed mechanisms zeta is of the
   independent rates; the others go with them so that phi stays 0. */
template <typename S>
class Near {
 public:
  explicit Near(const Problem& problem);

  /// Positions and rates of the varied path.
  void at(const Node& node, const std::vector<S>& zeta, const std::vector<S>& zeta_rate);
  S lagrangian();
  /// Q' qd of loads and dampers.
  S power();
  /// Forces that have no potential here: loads and dampers.
  std::vector<S> forces();

 private:
  using Moving = std::vector<Dual<S>>;
  Moving displaced(const Moving& slots, const Moving& zeta);
  /// Newton's steps in the dependent part of zeta until phi and phi' are 0, all with the node's own
  /// Jacobian: on duals each makes one more derivative right. Wherever they come from, the last one
  /// says where phi is 0, and how surely.
  void follow(const Node& node, const Moving& slots, Moving* zeta);

  const Problem& problem_;
  recursive::Model<S> model_;
  recursive::Workspace<S> ws_;
  recursive::Model<Dual<S>> moving_;
  recursive::Workspace<Dual<S>> ws_moving_;
  recursive::Constraints<Dual<S>> closures_;
  std::vector<scene::JointPosition<S>> x_;
  std::vector<S> qd_;
};

extern template class Near<double>;
extern template class Near<D>;
extern template class Near<DD>;
extern template class Near<RunningError>;

}  // namespace dynwitness::crosscheck::hamilton
