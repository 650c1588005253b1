// SPDX-License-Identifier: GPL-3.0-or-later
// Joints that do not sit where the scene says, and what that does to the joint forces.
#pragma once

#include <vector>

#include "crosscheck/scalars/dual.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck {

/// Errors of one joint's placement: three shifts, three turns.
inline constexpr int kErrorsOfJoint = 6;

/** The joints that may be misplaced: those of the links that move, fixed ones between them too.
    What is fixed to the world is not among them.
    @param model  built with FixedJoints::kKept, so that each joint is a link of the model
    @return  the model's links, the first of a chain */
template <typename T>
std::vector<int> placedJoints(const scene::Mechanism& mechanism, const recursive::Model<T>& model) {
  std::vector<int> joints;
  for (std::size_t i = 0; i < mechanism.links.size(); ++i)
    if (model.places[i].link >= 0)
      joints.push_back(
          model.places[i].link + 1 -
          static_cast<int>(recursive::detail::partsOf(mechanism.links[i].joint.kind).size()));
  return joints;
}

/** Misplaces a joint: its frame is shifted along the axes of the parent's link, and then turned,
    R = Rz Ry Rx, in the axes of the model's joint frame (z along the joint's axis). */
template <typename T>
void displace(recursive::LinkModel<T>& link, const recursive::Vector3<T>& shift,
              const scene::CosSin<T>& x, const scene::CosSin<T>& y, const scene::CosSin<T>& z) {
  using namespace recursive::detail;
  link.X_tree.p += shift;
  const recursive::Matrix3<T> turn = aboutZ(z) * aboutY(y) * aboutX(x);
  link.X_tree.R = (turn.transpose() * link.X_tree.R).eval();
}

/** J = dtau/d(errors) [n x 6 joints] at no error, by dual numbers: N m per m and N m per rad.
    @param number  outlives the call */
template <typename Numbers, typename T = typename Numbers::Scalar>
recursive::MatrixX<T> placementJacobian(const scene::Mechanism& mechanism, const Numbers& number,
                                        const scene::State<T>& state) {
  using D = Dual<T>;
  const auto model =
      recursive::buildModel(mechanism, DualNumbers<Numbers>(number), recursive::FixedJoints::kKept);
  recursive::Workspace<D> ws(model);
  std::vector<scene::JointPosition<D>> x;
  for (const auto& slot : state.x) x.push_back({D(slot.q), D(slot.c), D(slot.s)});
  const std::vector<D> qd(state.qd.begin(), state.qd.end()),
      qdd(state.qdd.begin(), state.qdd.end());
  const std::vector<int> joints = placedJoints(mechanism, model);
  recursive::MatrixX<T> J(model.dof(), kErrorsOfJoint * joints.size());
  std::vector<D> tau(model.dof(), D(0));
  for (Eigen::Index column = 0; column < J.cols(); ++column) {
    const int error = static_cast<int>(column) % kErrorsOfJoint;
    auto shift = recursive::Vector3<D>(D(0), D(0), D(0));
    scene::CosSin<D> turn[3] = {{D(1), D(0)}, {D(1), D(0)}, {D(1), D(0)}};
    const D small(T(0), T(1));
    if (error < 3)
      shift(error) = small;
    else
      turn[error - 3].s = small;
    auto misplaced = model;
    displace<D>(misplaced.links[joints[column / kErrorsOfJoint]], shift, turn[0], turn[1], turn[2]);
    recursive::inverseDynamics(misplaced, x, qd, qdd, ws, tau);
    for (int i = 0; i < model.dof(); ++i) J(i, column) = tau[i].derivative;
  }
  return J;
}

}  // namespace dynwitness::crosscheck
