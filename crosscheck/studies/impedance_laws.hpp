// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of impedances.
#pragma once

#include "crosscheck/laws/law.hpp"
#include "crosscheck/studies/impedance_model.hpp"

namespace dynwitness::crosscheck {

/// A mechanism at a state, whose point has an impedance. All three must outlive it.
template <typename T>
class ImpedanceAsked {
 public:
  using Scalar = T;
  using Matrix = recursive::MatrixX<T>;

  ImpedanceAsked(ImpedanceModel<T>& model, const scene::State<T>& state, const Impedance<T>& z)
      : model(model), state(state), z(z) {
    J = pointJacobian(model.model, state.x, z.point, &frame);
    frame.p = z.stretch;
  }

  int n() const { return model.model.dof(); }
  Matrix linearJ() const { return J.topRows(3); }
  recursive::Matrix3<T> linearK() const { return z.K.template topLeftCorner<3, 3>(); }
  static MatrixX<T> one(const T& value) { return MatrixX<T>(scalar(value)); }

  ImpedanceModel<T>& model;
  const scene::State<T>& state;
  const Impedance<T>& z;
  Matrix J;
  /// The link's axes, and an origin somewhere else than at the point.
  recursive::Transform<T> frame = recursive::Transform<T>::identity();
};

inline constexpr const char* kNotEveryWay =
    "the point cannot move every way: J M^-1 J' or J is singular";

struct StiffnessOfTheJoints : Law {
  static constexpr LawWords kWords = {"stiffness of the joints", "d2V/dq2 = J' K J + (dJ'/dq) f",
                                      "K", "recursive_lagrange", "sweeps"};
  static bool appliesTo(const scene::Mechanism& mechanism) { return hasCoordinates(mechanism); }
  template <typename T>
  static TwoSides<T> sides(ImpedanceAsked<T>& at) {
    const recursive::MatrixX<T> J = at.linearJ();
    const recursive::Vector3<T> f = at.linearK() * at.z.stretch;
    return {
        at.model.potentialHessian(at.state, at.z),
        J.transpose() * at.linearK() * J + at.model.geometricStiffness(at.state, at.z.point, f)};
  }
};

struct ComplianceOfThePoint : Law {
  static constexpr LawWords kWords = {"compliance of the point",
                                      "w' C_x w = dq' K_q dq, C_x = J C_q J', dq = C_q J' w", "C",
                                      "sweeps", "joints"};
  template <typename T>
  static TwoSides<T> sides(ImpedanceAsked<T>& at) {
    using Vector = recursive::VectorX<T>;
    using Matrix = recursive::MatrixX<T>;
    Vector dq = at.J.transpose() * at.z.wrench;
    Matrix C = Matrix::Constant(at.n(), at.n(), T(0));
    T right = T(0);
    for (int i = 0; i < at.n(); ++i) {
      C(i, i) = at.z.joint_compliance[i];
      dq(i) = dq(i) * at.z.joint_compliance[i];
      right += dq(i) * dq(i) / at.z.joint_compliance[i];
    }
    const Matrix C_x = at.J * C * at.J.transpose();
    return {at.one(at.z.wrench.dot(Vector(C_x * at.z.wrench))), at.one(right)};
  }
};

struct DampingOfTheJoints : Law {
  static constexpr LawWords kWords = {"damping of the joints", "qd' J' D J qd = xd' D xd", "D",
                                      "sweeps", "recursive_lagrange"};
  template <typename T>
  static TwoSides<T> sides(ImpedanceAsked<T>& at) {
    using Vector = recursive::VectorX<T>;
    const Vector qd = column(at.state.qd);
    const recursive::Vector6<T> xd = at.model.velocity(at.state, at.z.point);
    const recursive::MatrixX<T> D_q = at.J.transpose() * at.z.D * at.J;
    return {at.one(qd.dot(Vector(D_q * qd))), at.one(xd.dot(recursive::Vector6<T>(at.z.D * xd)))};
  }
};

struct MobilityOfThePoint : Law {
  static constexpr LawWords kWords = {"mobility of the point",
                                      "J M^-1 J' f = xdd of a force f at rest", "mobility",
                                      "composite_body", "articulated_body"};
  template <typename T>
  static TwoSides<T> sides(ImpedanceAsked<T>& at) {
    const recursive::VectorX<T> qdd =
        at.model.accelerations(at.state, at.J.transpose() * at.z.wrench);
    return {at.model.mobility(at.state, at.J) * at.z.wrench, at.J * qdd};
  }
};

struct ApparentInertia : Law {
  static constexpr LawWords kWords = {"apparent inertia",
                                      "T(M^-1 J' L xd) = xd' L xd / 2, L = (J M^-1 J')^-1",
                                      "L",
                                      "newton_euler",
                                      "composite_body",
                                      kNotEveryWay};
  template <typename T>
  static TwoSides<T> sides(ImpedanceAsked<T>& at) {
    using Vector = recursive::VectorX<T>;
    const recursive::MatrixX<T> J = at.linearJ();
    const recursive::MatrixX<T> L = ImpedanceModel<T>::inverse(at.model.mobility(at.state, J));
    const Vector xd = at.z.wrench.template head<3>();
    const Vector qd = at.model.solved(at.state, J.transpose() * Vector(L * xd));
    return {at.one(at.model.kineticEnergy(at.state, qd)), at.one(xd.dot(Vector(L * xd)) / T(2))};
  }
};

/// Where J may be square.
struct ThereAndBack : Law {
  static constexpr LawWords kWords = {"there and back", "J^-T (J' K J) J^-1 = K", "K", "sweeps", "",
                                      kNotEveryWay};
  static bool appliesTo(const scene::Mechanism& mechanism) {
    return mechanism.dof() == 3 || mechanism.dof() == 6;
  }
  template <typename T>
  static TwoSides<T> sides(ImpedanceAsked<T>& at) {
    using Matrix = recursive::MatrixX<T>;
    const bool turns = at.n() == 6;
    const Matrix J = turns ? at.J : at.linearJ();
    const Matrix K = turns ? Matrix(at.z.K) : Matrix(at.linearK());
    // J^-1 = (J'J)^-1 J' of a square regular J
    const Matrix back = ImpedanceModel<T>::inverse(J.transpose() * J) * J.transpose();
    const Matrix K_q = J.transpose() * K * J;
    return {back.transpose() * K_q * back, K};
  }
};

struct StiffnessInAnotherFrame : Law {
  static constexpr LawWords kWords = {"another frame, stiffness", "t_f' K_f t_f = t' K t", "K",
                                      "spatial algebra", ""};
  template <typename T>
  static TwoSides<T> sides(ImpedanceAsked<T>& at) {
    using recursive::Matrix6, recursive::Vector6;
    const Matrix6<T> S = at.frame.motionMatrix(), S_back = at.frame.inverse().motionMatrix();
    const Matrix6<T> K_f = S_back.transpose() * at.z.K * S_back;
    const Vector6<T>& t = at.z.wrench;  // any six numbers are a twist
    const Vector6<T> t_f = S * t;
    return {at.one(t_f.dot(Vector6<T>(K_f * t_f))), at.one(t.dot(Vector6<T>(at.z.K * t)))};
  }
};

struct ComplianceInAnotherFrame : Law {
  static constexpr LawWords kWords = {"another frame, compliance and inertia",
                                      "trace(C_f M_f) = trace(C M)", "C M", "spatial algebra", ""};
  template <typename T>
  static TwoSides<T> sides(ImpedanceAsked<T>& at) {
    using recursive::Matrix6;
    const Matrix6<T> S = at.frame.motionMatrix(), S_back = at.frame.inverse().motionMatrix();
    const Matrix6<T> C = at.J * at.J.transpose();  // a compliance
    const Matrix6<T> C_f = S * C * S.transpose(), M_f = S_back.transpose() * at.z.K * S_back;
    return {at.one((C_f * M_f).trace()), at.one((C * at.z.K).trace())};
  }
};

using ImpedanceLaws =
    Laws<StiffnessOfTheJoints, ComplianceOfThePoint, DampingOfTheJoints, MobilityOfThePoint,
         ApparentInertia, ThereAndBack, StiffnessInAnotherFrame, ComplianceInAnotherFrame>;

}  // namespace dynwitness::crosscheck
