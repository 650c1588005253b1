// SPDX-License-Identifier: GPL-3.0-or-later
// What the laws of mechanics ask about: our sweeps of one mechanism at one state.
#pragma once

#include <utility>
#include <vector>

#include "crosscheck/laws/law.hpp"
#include "crosscheck/scalars/moving_state.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/derivatives.hpp"
#include "recursive/factorization.hpp"
#include "recursive/joint_forces.hpp"
#include "recursive/projection.hpp"
#include "recursive/regressor.hpp"
#include "scene/mimic.hpp"

namespace dynwitness::crosscheck {

/// A moving joint that articulated bodies are passed through, in the letters of section 7 of the
/// chapter.
template <typename T>
struct PassedJoint {
  int dof, axes;
  // as the sweep left it, or passed it on by its own steps
  recursive::Matrix6<T> M;    ///< articulated inertia of its link
  recursive::Matrix6<T> P;    ///< of force: column k is what it makes of the unit force e_k
  recursive::Matrix6<T> P_M;  ///< of inertia: M after all axes
  // what M, axes and rotor say to that
  recursive::JointAxes<T> Z;
  recursive::JointAxes<T> G;        ///< (0, h z) of a gyroscopic rotor that a link carries, or 0
  recursive::JointAxes<T> U;        ///< M Z + G
  recursive::MatrixX<T> d;          ///< the rotor, once an axis
  recursive::MatrixX<T> inverse_D;  ///< D = d + Z'MZ
  recursive::MatrixX<T> leak;  ///< d - Z'G: by it a free joint still passes its axes' forces on
};

/** One mechanism in the arithmetic of T, moved from state to state. What a law asks is computed
    when it is first asked for, and kept for the state: no law computes what another has. */
template <typename T>
class SweptMechanism {
 public:
  using Scalar = T;
  using Matrix = scene::MatrixX<T>;
  using Moving = Dual<T>;  ///< along the motion

  template <typename Numbers>
  SweptMechanism(const scene::Mechanism& mechanism, const Numbers& numbers)
      : SweptMechanism(mechanism, numbers, recursive::buildModel(mechanism, numbers),
                       recursive::buildModel(mechanism, numbers, recursive::FixedJoints::kKept)) {}
  /// @param lumped, kept  its models, without and with a link for every fixed joint
  template <typename Numbers>
  SweptMechanism(const scene::Mechanism& mechanism, const Numbers& numbers,
                 recursive::Model<T> lumped, recursive::Model<T> kept);

  /// To this state; its tau is any direction (alongTau()).
  SweptMechanism& at(scene::State<T> state);

  const scene::State<T>& state() const { return state_; }
  int n() const { return model_.dof(); }
  Matrix qd() const { return column(state_.qd); }
  Matrix qdd() const { return column(state_.qdd); }
  std::vector<T> zeros() const { return std::vector<T>(n(), T(0)); }
  /// All 0 but entry k.
  std::vector<T> unit(int k) const;
  static Matrix column(const std::vector<T>& v);
  static Matrix one(const T& x) { return Matrix::Constant(1, 1, x); }

  // ---- the mechanism's own sweeps ---------------------------------------------------------------

  const recursive::Model<T>& model() const { return model_; }
  /// By Newton-Euler, at this position.
  Matrix inverse(const std::vector<T>& qd, const std::vector<T>& qdd, recursive::Terms terms);
  /// Of the state, all terms.
  const Matrix& tau();
  /// By articulated bodies, at this position and these rates.
  Matrix forward(const Matrix& tau);
  /// By composite bodies.
  const Matrix& M();
  const Matrix& C();
  T kineticEnergy() { return recursive::kineticEnergy(model_, state_.x, state_.qd, ws_); }
  T frictionPower() const;
  /// From parent to link, one a link of the model.
  const std::vector<recursive::Transform<T>>& transforms();
  /// Y pi
  Matrix regressed();
  /// Links of the model whose joints move.
  std::vector<int> movingLinks() const;

  // ---- rates along the motion, by dual numbers --------------------------------------------------

  T energyRate();
  Matrix massMatrixRate();
  /// dV/dq_i: the rate of V when joint i alone moves with unit velocity.
  const Matrix& potentialGradient();
  /// Of all links, about the world's origin.
  Matrix momentumRate();
  /// Of tau by Newton-Euler along a direction of q, qd and qdd.
  Matrix tauRate(const Direction<T>& along);
  /// Of qdd by articulated bodies along a direction of q, qd and tau.
  Matrix qddRate(const Direction<T>& along);

  // ---- derivatives by sweeps of their own -------------------------------------------------------

  /// u: one number a rate, drawn for the state, that has no part in its motion. One direction of
  /// numbers drawn at random says as much about a matrix as all its columns: what is wrong with it
  /// is a polynomial in u as well.
  const std::vector<T>& anyDirection() const { return state_.tau; }
  const recursive::InverseDynamicsDerivatives<T>& ofInverse();
  const recursive::ForwardDynamicsDerivatives<T>& ofForward();
  /// dg/dq: at rest, of weights and springs alone.
  Matrix stiffness();

  // ---- with fixed joints kept -------------------------------------------------------------------

  const recursive::Model<T>& withFixedJoints() const { return kept_; }
  const Matrix& tauWithFixedJoints();
  /// As that sweep left the links.
  const recursive::Workspace<T>& sweptWithFixedJoints();
  /// Through the joint of each link of the scene; there is none at its root.
  const std::vector<recursive::Force<T>>& reactions();

  // ---- with joints that follow others let go, without rotors geared to several rates ----------

  const recursive::Model<T>& letGo() const { return free_; }
  /// The same rates with one for every joint.
  std::vector<T> letGo(const std::vector<T>& rates) const;
  /// As forward dynamics left the links, under joint forces as large as qdd: any will do. Friction
  /// apart.
  recursive::Workspace<T>& sweptFree();
  /// All moving joints, passed one by one, each with a rate of its own.
  const std::vector<PassedJoint<T>>& passedJoints();

 private:
  /// Positions that move as they do at these rates.
  std::vector<scene::JointPosition<Moving>> movingAt(const std::vector<T>& qd) const {
    return moving(model_, state_.x, qd);
  }
  std::vector<Moving> movingRates() const;
  static Matrix derivatives(const std::vector<Moving>& v);
  /// Of a symmetric matrix.
  static Matrix inverseOf(Matrix D);
  /// @param swept  a copy of what the sweep of free_ left
  PassedJoint<T> passedJoint(int i, recursive::Workspace<T>& swept) const;

  /// Of the state.
  struct Known {
    Kept<Matrix> tau, M, C, gradient, tau_kept;
    Kept<std::vector<recursive::Transform<T>>> transforms;
    Kept<std::vector<recursive::Force<T>>> reactions;
    Kept<std::vector<T>> qdd_free;
    Kept<std::vector<PassedJoint<T>>> passed;
    Kept<recursive::InverseDynamicsDerivatives<T>> of_inverse;
    Kept<recursive::ForwardDynamicsDerivatives<T>> of_forward;
  };

  recursive::Model<T> model_, kept_;
  recursive::Model<T> free_;  ///< without what couples rates
  recursive::Model<Moving> moving_;
  /// Those of kept_ and free_ hold one sweep each; the others serve whatever is asked.
  recursive::Workspace<T> ws_, ws_free_, ws_kept_;
  recursive::Workspace<Moving> ws_moving_;
  recursive::DerivativesWorkspace<T> room_;
  std::vector<scene::InertialParameter> parameters_;
  std::vector<T> pi_;
  scene::State<T> state_;
  Known known_;
};

// not in the class: what is inline is compiled in every file, extern or not

template <typename T>
template <typename Numbers>
SweptMechanism<T>::SweptMechanism(const scene::Mechanism& mechanism, const Numbers& numbers,
                                  recursive::Model<T> lumped, recursive::Model<T> kept)
    : model_(std::move(lumped)),
      kept_(std::move(kept)),
      free_(mechanism.hasCoupledRates()
                ? recursive::buildModel(scene::withoutGearedRotors(scene::withoutMimics(mechanism)),
                                        numbers)
                : model_),
      moving_(recursive::buildModel(mechanism, DualNumbers<Numbers>(numbers),
                                    recursive::FixedJoints::kKept)),
      ws_(model_),
      ws_free_(free_),
      ws_kept_(kept_),
      ws_moving_(moving_),
      room_(model_),
      parameters_(scene::inertialParameters(mechanism)),
      pi_(recursive::inertialValues(mechanism, parameters_, numbers)) {}

template <typename T>
SweptMechanism<T>& SweptMechanism<T>::at(scene::State<T> state) {
  state_ = std::move(state);
  known_ = {};
  return *this;
}

template <typename T>
std::vector<T> SweptMechanism<T>::unit(int k) const {
  std::vector<T> out = zeros();
  out[k] = T(1);
  return out;
}

template <typename T>
recursive::MatrixX<T> SweptMechanism<T>::column(const std::vector<T>& v) {
  return Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, 1>>(v.data(), v.size());
}

template <typename T>
recursive::MatrixX<T> SweptMechanism<T>::inverse(const std::vector<T>& qd,
                                                 const std::vector<T>& qdd,
                                                 recursive::Terms terms) {
  std::vector<T> tau = zeros();
  recursive::inverseDynamics(model_, state_.x, qd, qdd, ws_, tau, terms);
  return column(tau);
}

template <typename T>
const recursive::MatrixX<T>& SweptMechanism<T>::tau() {
  return known_.tau([&] { return inverse(state_.qd, state_.qdd, recursive::Terms::all()); });
}

template <typename T>
recursive::MatrixX<T> SweptMechanism<T>::forward(const Matrix& tau) {
  std::vector<T> qdd = zeros();
  const std::vector<T> forces(tau.data(), tau.data() + tau.size());
  recursive::forwardDynamics(model_, state_.x, state_.qd, forces, ws_, qdd);
  return column(qdd);
}

template <typename T>
const recursive::MatrixX<T>& SweptMechanism<T>::M() {
  return known_.M([&] {
    Matrix M(n(), n());
    recursive::massMatrix(model_, state_.x, ws_, M);
    return M;
  });
}

template <typename T>
const recursive::MatrixX<T>& SweptMechanism<T>::C() {
  return known_.C([&] { return recursive::coriolisMatrix(model_, state_.x, state_.qd, ws_); });
}

template <typename T>
T SweptMechanism<T>::frictionPower() const {
  return recursive::frictionPower(model_, state_.qd);
}

template <typename T>
const std::vector<recursive::Transform<T>>& SweptMechanism<T>::transforms() {
  return known_.transforms([&] {
    inverse(zeros(), zeros(), recursive::Terms::none());
    return std::vector<recursive::Transform<T>>(ws_.X_up.begin(), ws_.X_up.end());
  });
}

template <typename T>
recursive::MatrixX<T> SweptMechanism<T>::regressed() {
  Matrix Y(n(), parameters_.size());
  recursive::regressor(model_, parameters_, state_.x, state_.qd, state_.qdd, ws_, Y);
  return Y * column(pi_);
}

template <typename T>
std::vector<int> SweptMechanism<T>::movingLinks() const {
  std::vector<int> moving;
  for (std::size_t i = 0; i < model_.links.size(); ++i)
    if (model_.links[i].dof >= 0) moving.push_back(static_cast<int>(i));
  return moving;
}

template <typename T>
T SweptMechanism<T>::energyRate() {
  const auto x = movingAt(state_.qd);
  const Moving energy = recursive::kineticEnergy(moving_, x, movingRates(), ws_moving_) +
                        recursive::potentialEnergy(moving_, x, ws_moving_);
  return energy.derivative;
}

template <typename T>
recursive::MatrixX<T> SweptMechanism<T>::massMatrixRate() {
  recursive::MatrixX<Moving> M(n(), n());
  recursive::massMatrix(moving_, movingAt(state_.qd), ws_moving_, M);
  return M.unaryExpr([](const Moving& m) { return m.derivative; });
}

template <typename T>
const recursive::MatrixX<T>& SweptMechanism<T>::potentialGradient() {
  return known_.gradient([&] {
    Matrix gradient(n(), 1);
    for (int i = 0; i < n(); ++i)
      gradient(i, 0) =
          recursive::potentialEnergy(moving_, movingAt(unit(i)), ws_moving_).derivative;
    return gradient;
  });
}

template <typename T>
recursive::MatrixX<T> SweptMechanism<T>::momentumRate() {
  const recursive::Force<Moving> momentum =
      recursive::momentum(moving_, movingAt(state_.qd), movingRates(), ws_moving_);
  Matrix rate(6, 1);
  for (int k = 0; k < 6; ++k) rate(k, 0) = momentum.vector()(k).derivative;
  return rate;
}

template <typename T>
recursive::MatrixX<T> SweptMechanism<T>::derivatives(const std::vector<Moving>& v) {
  Matrix out(v.size(), 1);
  for (std::size_t i = 0; i < v.size(); ++i) out(i, 0) = v[i].derivative;
  return out;
}

template <typename T>
recursive::MatrixX<T> SweptMechanism<T>::tauRate(const Direction<T>& along) {
  const scene::State<Moving> at = moving(model_, state_, along);
  std::vector<Moving> tau(n(), Moving(T(0)));
  recursive::inverseDynamics(moving_, at.x, at.qd, at.qdd, ws_moving_, tau);
  return derivatives(tau);
}

template <typename T>
recursive::MatrixX<T> SweptMechanism<T>::qddRate(const Direction<T>& along) {
  scene::State<T> state = state_;
  state.tau.assign(tau().data(), tau().data() + n());
  const scene::State<Moving> at = moving(model_, state, along);
  std::vector<Moving> qdd(n(), Moving(T(0)));
  recursive::forwardDynamics(moving_, at.x, at.qd, at.tau, ws_moving_, qdd);
  return derivatives(qdd);
}

template <typename T>
const recursive::InverseDynamicsDerivatives<T>& SweptMechanism<T>::ofInverse() {
  return known_.of_inverse([&] {
    recursive::InverseDynamicsDerivatives<T> out(model_);
    recursive::inverseDynamicsDerivatives(model_, state_.x, state_.qd, state_.qdd, room_, out);
    return out;
  });
}

template <typename T>
const recursive::ForwardDynamicsDerivatives<T>& SweptMechanism<T>::ofForward() {
  return known_.of_forward([&] {
    recursive::InverseDynamicsDerivatives<T> of_tau = ofInverse();
    recursive::ForwardDynamicsDerivatives<T> out(model_);
    recursive::solveForAccelerations(model_, room_, of_tau, out);
    return out;
  });
}

template <typename T>
recursive::MatrixX<T> SweptMechanism<T>::stiffness() {
  recursive::InverseDynamicsDerivatives<T> out(model_);
  recursive::inverseDynamicsDerivatives(model_, state_.x, zeros(), zeros(), room_, out,
                                        recursive::Terms::potential());
  return out.dtau_dq;
}

template <typename T>
const recursive::MatrixX<T>& SweptMechanism<T>::tauWithFixedJoints() {
  return known_.tau_kept([&] {
    std::vector<T> tau(kept_.dof(), T(0));
    recursive::inverseDynamics(kept_, state_.x, state_.qd, state_.qdd, ws_kept_, tau,
                               recursive::Terms::all());
    return column(tau);
  });
}

template <typename T>
const recursive::Workspace<T>& SweptMechanism<T>::sweptWithFixedJoints() {
  tauWithFixedJoints();
  return ws_kept_;
}

template <typename T>
const std::vector<recursive::Force<T>>& SweptMechanism<T>::reactions() {
  return known_.reactions([&] {
    tauWithFixedJoints();
    std::vector<T> six(6 * (kept_.joints.size() - 1), T(0));
    recursive::jointReactions(kept_, ws_kept_, six);
    std::vector<recursive::Force<T>> out = {recursive::Force<T>::zero()};
    for (std::size_t i = 0; i < six.size(); i += 6)
      out.push_back({{six[i], six[i + 1], six[i + 2]}, {six[i + 3], six[i + 4], six[i + 5]}});
    return out;
  });
}

template <typename T>
std::vector<T> SweptMechanism<T>::letGo(const std::vector<T>& rates) const {
  std::vector<T> out(free_.dof(), T(0));
  for (std::size_t i = 0; i < free_.links.size(); ++i) {
    const recursive::LinkModel<T>& link = model_.links[i];
    for (int k = 0; k < recursive::axisCount(link.kind); ++k)
      out[free_.links[i].dof + k] =
          link.follows ? T(link.ratio * rates[link.dof]) : rates[link.dof + k];
  }
  return out;
}

template <typename T>
recursive::Workspace<T>& SweptMechanism<T>::sweptFree() {
  known_.qdd_free([&] {
    std::vector<T> qdd(free_.dof(), T(0));
    recursive::forwardDynamics(free_, state_.x, letGo(state_.qd), letGo(state_.qdd), ws_free_, qdd,
                               {true, true, true, false});
    return qdd;
  });
  return ws_free_;
}

template <typename T>
const std::vector<PassedJoint<T>>& SweptMechanism<T>::passedJoints() {
  return known_.passed([&] {
    std::vector<PassedJoint<T>> out;
    recursive::Workspace<T> ws = sweptFree();  // the sweep's own U and D in it
    for (const int i : movingLinks()) out.push_back(passedJoint(i, ws));
    return out;
  });
}

template <typename T>
PassedJoint<T> SweptMechanism<T>::passedJoint(int i, recursive::Workspace<T>& swept) const {
  const recursive::LinkModel<T>& link = free_.links[i];
  PassedJoint<T> joint;
  joint.dof = link.dof;
  joint.axes = recursive::axisCount(link.kind);
  // the articulated inertias do not depend on velocities and forces
  const recursive::SweptProjection<T> passed =
      recursive::sweptProjection(free_, state_.x, swept, i);
  joint.M = swept.M_A[i].matrix();
  joint.P = passed.P;
  joint.P_M = passed.P_M.matrix();

  joint.Z.resize(6, joint.axes);
  joint.G.setConstant(6, joint.axes, T(0));
  for (int k = 0; k < joint.axes; ++k) {
    joint.Z.col(k) = recursive::jointAxis(link, k);
    if (recursive::spinsOnALink(free_, link)) joint.G.col(k) = recursive::spinAxis(link).vector();
  }
  const recursive::JointAxes<T> M_Z = joint.M * joint.Z;
  joint.U = M_Z + joint.G;
  joint.d = Matrix::Identity(joint.axes, joint.axes) * link.rotor;
  joint.inverse_D = inverseOf(Matrix(joint.d + Matrix(joint.Z.transpose() * M_Z)));
  joint.leak = joint.d - Matrix(joint.Z.transpose() * joint.G);
  return joint;
}

template <typename T>
std::vector<Dual<T>> SweptMechanism<T>::movingRates() const {
  std::vector<Moving> out;
  for (int i = 0; i < n(); ++i) out.push_back({state_.qd[i], state_.qdd[i]});
  return out;
}

template <typename T>
recursive::MatrixX<T> SweptMechanism<T>::inverseOf(Matrix D) {
  recursive::factorize(D);
  Matrix columns = Matrix::Identity(D.rows(), D.cols());
  for (Eigen::Index j = 0; j < D.cols(); ++j) {
    Eigen::Ref<Eigen::Matrix<T, Eigen::Dynamic, 1>> column = columns.col(j);
    recursive::solve(D, column);
  }
  return columns;
}

}  // namespace dynwitness::crosscheck
