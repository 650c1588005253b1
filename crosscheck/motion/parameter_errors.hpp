// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes whose numbers are not what they say, one error at a time, as models over dual numbers:
// what a sweep answers of such a model has the derivative by that error beside it.
#pragma once

#include <vector>

#include "crosscheck/scalars/dual.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/constraints.hpp"
#include "recursive/regressor.hpp"

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

/// A state that no error changes.
template <typename T>
scene::State<Dual<T>> constantState(const scene::State<T>& state) {
  scene::State<Dual<T>> out;
  for (const auto& slot : state.x) out.x.push_back({slot.q, slot.c, slot.s});
  out.qd.assign(state.qd.begin(), state.qd.end());
  out.qdd.assign(state.qdd.begin(), state.qdd.end());
  out.tau.assign(state.tau.begin(), state.tau.end());
  return out;
}

/** The models of a mechanism that are one error off. Placements: column 6 j + k of
    placementJacobian(), k the shifts [m] and turns [rad] of joint j. Inertia: any direction of
    scene::inertialParameters(). Fixed joints are kept. @param number  outlives this */
template <typename Numbers, typename T = typename Numbers::Scalar>
class ErroneousModels {
 public:
  using D = Dual<T>;
  ErroneousModels(const scene::Mechanism& mechanism, const Numbers& number)
      : model_(recursive::buildModel(mechanism, DualNumbers<Numbers>(number),
                                     recursive::FixedJoints::kKept)),
        joints_(placedJoints(mechanism, model_)),
        parameters_(scene::inertialParameters(mechanism)),
        pi_(recursive::inertialValues(mechanism, parameters_, number)) {}

  const recursive::Model<D>& model() const { return model_; }
  int placements() const { return kErrorsOfJoint * static_cast<int>(joints_.size()); }
  const std::vector<scene::InertialParameter>& parameters() const { return parameters_; }

  recursive::Model<D> misplaced(int column) const {
    const int error = column % kErrorsOfJoint;
    auto shift = recursive::Vector3<D>(D(0), D(0), D(0));
    scene::CosSin<D> turn[3] = {{D(1), D(0)}, {D(1), D(0)}, {D(1), D(0)}};
    const D small(T(0), T(1));
    if (error < 3)
      shift(error) = small;
    else
      turn[error - 3].s = small;
    recursive::Model<D> out = model_;
    displace<D>(out.links[joints_[column / kErrorsOfJoint]], shift, turn[0], turn[1], turn[2]);
    return out;
  }
  /// @param direction  of pi, its length
  recursive::Model<D> misweighed(const std::vector<T>& direction) const {
    std::vector<D> pi;
    for (std::size_t j = 0; j < pi_.size(); ++j) pi.push_back({pi_[j], direction[j]});
    recursive::Model<D> out = model_;
    recursive::setInertialValues(out, parameters_, pi);
    return out;
  }

 private:
  recursive::Model<D> model_;
  std::vector<int> joints_;
  std::vector<scene::InertialParameter> parameters_;
  std::vector<T> pi_;
};

/// Derivatives of what a sweep wrote.
template <typename T>
recursive::VectorX<T> derivatives(const std::vector<Dual<T>>& of) {
  recursive::VectorX<T> out(static_cast<Eigen::Index>(of.size()));
  for (std::size_t i = 0; i < of.size(); ++i) out(static_cast<Eigen::Index>(i)) = of[i].derivative;
  return out;
}

/// d tau by the model's error, at the accelerations of the state.
template <typename T>
recursive::VectorX<T> changeOfTau(const recursive::Model<Dual<T>>& model,
                                  const scene::State<Dual<T>>& state) {
  recursive::Workspace<Dual<T>> ws(model);
  std::vector<Dual<T>> tau(static_cast<std::size_t>(model.dof()));
  recursive::inverseDynamics(model, state.x, state.qd, state.qdd, ws, tau);
  return derivatives(tau);
}

/** d qdd by the model's error, at the joint forces of the state, by the articulated-body sweep.
    With d tau at the accelerations that belong to these forces it is  M d qdd = -d tau. */
template <typename T>
recursive::VectorX<T> changeOfQdd(const recursive::Model<Dual<T>>& model,
                                  const scene::State<Dual<T>>& state) {
  recursive::Workspace<Dual<T>> ws(model);
  std::vector<Dual<T>> qdd(static_cast<std::size_t>(model.dof()));
  recursive::forwardDynamics(model, state.x, state.qd, state.tau, ws, qdd);
  return derivatives(qdd);
}

/** J = dtau/d(errors) [n x 6 joints] at no error, by dual numbers: N m per m and N m per rad.
    @param number  outlives the call */
template <typename Numbers, typename T = typename Numbers::Scalar>
recursive::MatrixX<T> placementJacobian(const scene::Mechanism& mechanism, const Numbers& number,
                                        const scene::State<T>& state) {
  const ErroneousModels<Numbers> models(mechanism, number);
  const scene::State<Dual<T>> at = constantState(state);
  recursive::MatrixX<T> J(models.model().dof(), models.placements());
  for (int column = 0; column < models.placements(); ++column)
    J.col(column) = changeOfTau(models.misplaced(column), at);
  return J;
}

}  // namespace dynwitness::crosscheck
