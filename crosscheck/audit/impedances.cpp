// SPDX-License-Identifier: GPL-3.0-or-later
// Section 16.1: impedances in other frames.
#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "crosscheck/audit/board.hpp"

namespace dynwitness::audit {
namespace {

/// A body held by springs, each along a direction u at a place p of the body's frame; and the same
/// springs seen from another frame. What they do follows from lengthening each, without any 6 x 6
/// transformation.
template <typename T>
struct Springs {
  std::vector<T> k;
  std::vector<Vector3<T>> u, p;

  /// sum k A A', A = (u, p x u)
  Matrix6<T> stiffness() const {
    Matrix6<T> K = Matrix6<T>::Zero();
    for (std::size_t i = 0; i < k.size(); ++i) {
      const Vector6<T> A = Force<T>{u[i], p[i].cross(u[i])}.vector();
      K += (A * k[i]) * A.transpose();
    }
    return K;
  }
  Matrix6<T> compliance() const { return inverseDense<T>(stiffness()); }
  Springs seenFrom(const Transform<T>& X) const {
    Springs out = *this;
    for (std::size_t i = 0; i < k.size(); ++i) {
      out.u[i] = X.R * u[i];
      out.p[i] = X.R * (p[i] - X.p);
    }
    return out;
  }
};
Springs<T> anySprings(Point& at) {
  Springs<T> out;
  for (int i = 0; i < 6; ++i) {
    out.k.push_back(at.number());
    out.u.push_back(at.vector());
    out.p.push_back(at.vector());
  }
  return out;
}
template <typename T>
Matrix6<T> inverse6(const Matrix6<T>& A) {
  return inverseDense<T>(A);
}
/// Moment first: swaps the halves of a wrench.
template <typename T>
Matrix6<T> swapped() {
  Matrix6<T> m = Matrix6<T>::Zero();
  for (int i = 0; i < 6; ++i) m(i, (i + 3) % 6) = T(1);
  return m;
}

Trials eq73() {
  return Trials("eq73").printed(exact([](Point& at) {
    const auto springs = anySprings(at);
    const Transform<T> X = at.transform();
    const Force<T> w = at.force();
    const Force<T> w_f = {X.R * w.force, X.R * (w.moment - X.p.cross(w.force))};
    at.equal("t_f", Vector6<T>(X.motionMatrix() * (springs.compliance() * w.vector())),
             Vector6<T>(springs.seenFrom(X).compliance() * w_f.vector()));
  }));
}

/// A gripper that gives way by 1 mm/N and 0.01 rad/(N m) at frame i, and frame f 0.1 m further
/// along x.
struct Gripper {
  Gripper() {
    C_i.diagonal() << 0.001, 0.001, 0.001, 0.01, 0.01, 0.01;
    const Transform<double> X{Matrix3<double>::Identity(), {0.1, 0, 0}};
    S = X.motionMatrix();
    S_back = X.inverse().motionMatrix();
  }
  Matrix6<double> C_i = Matrix6<double>::Zero(), S, S_back;
};

Rows complianceRows() {
  const Gripper gripper;
  const Vector6<double> w = Vector6<double>::Unit(1);
  const std::array<const char*, 6> names = {"x [m]",   "y [m]",   "z [m]",
                                            "x [rad]", "y [rad]", "z [rad]"};
  return componentRows(names, Vector6<double>(gripper.S * gripper.C_i * gripper.S_back * w),
                       Vector6<double>(gripper.S * gripper.C_i * gripper.S.transpose() * w));
}

/// The eigenvalues of the gripper's compliance, which the chapter leaves unchanged.
Rows eigenvalueRows() {
  const Gripper gripper;
  const Matrix6<double> C_f = gripper.S * gripper.C_i * gripper.S.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6<double>> in_i(gripper.C_i), in_f(C_f);
  Rows rows;
  for (int k = 0; k < 6; ++k)
    rows.push_back(
        {std::to_string(k + 1), onBoard(in_i.eigenvalues()(k)), onBoard(in_f.eigenvalues()(k))});
  return rows;
}

/// The gripper's stiffness at frame f, entry by entry.
Rows stiffnessRows() {
  const Gripper gripper;
  const Matrix6<double> K_i = gripper.C_i.diagonal().cwiseInverse().asDiagonal(),
                        printed = gripper.S * K_i * gripper.S_back,
                        so = gripper.S_back.transpose() * K_i * gripper.S_back;
  Rows rows;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      if (onBoard(printed(i, j)) != onBoard(so(i, j)))
        rows.push_back(
            {fmt::format("{} {}", i + 1, j + 1), onBoard(printed(i, j)), onBoard(so(i, j))});
  return rows;
}

Trials eq74() {
  return Trials("eq74")
      .printed(exact([](Point& at) {
        const auto springs = anySprings(at);
        const Transform<T> X = at.transform();
        const Matrix6<T> S = X.motionMatrix();
        at.equal("C_f", springs.seenFrom(X).compliance(),
                 Matrix6<T>(S * springs.compliance() * X.inverse().motionMatrix()));
      }))
      .condition(exact([](Point& at) {
        const auto springs = anySprings(at);
        const Transform<T> X = at.transform();
        const Matrix6<T> S = X.motionMatrix(), swap = swapped<T>();
        at.equal("C_f", Matrix6<T>(springs.seenFrom(X).compliance() * swap),
                 Matrix6<T>(S * springs.compliance() * swap * X.inverse().motionMatrix()));
      }))
      .corrected(exact([](Point& at) {
        const auto springs = anySprings(at);
        const Transform<T> X = at.transform();
        const Matrix6<T> S = X.motionMatrix();
        at.equal("our code: C_f", springs.seenFrom(X).compliance(),
                 Matrix6<T>(S * springs.compliance() * S.transpose()));
      }))
      .numbers(complianceRows);
}

Trials similarity() {
  return Trials("similarity")
      .printed(exact([](Point& at) {
        const Vector6<T> v = at.vector6(), y = at.vector6();
        const Matrix6<T> C = v * y.transpose();  // eigenvector v, eigenvalue y' v
        const Transform<T> X = at.transform();
        const Matrix6<T> C_f = X.motionMatrix() * C * X.inverse().motionMatrix();
        at.equal("C_f v", Vector6<T>(C_f * v), Vector6<T>(v * y.dot(v)));
      }))
      .corrected(
          both(exact([](Point& at) {
                 const Vector6<T> v = at.vector6(), y = at.vector6();
                 const Transform<T> X = at.transform();
                 const Matrix6<T> S = X.motionMatrix();
                 const Matrix6<T> C_f = S * (v * y.transpose()) * X.inverse().motionMatrix();
                 at.equal("C_f S v", Vector6<T>(C_f * (S * v)), Vector6<T>(S * v * y.dot(v)));
                 const auto springs = anySprings(at);
                 const auto body = anyBody(at);
                 const Matrix6<T> C_i = springs.compliance(), C = springs.seenFrom(X).compliance();
                 const Matrix6<T> M_i = massMatrix6(body),
                                  M = massMatrix6(body.seenFrom(X.R, Vector3<T>(X.R * -X.p)));
                 at.equal("C M", Matrix6<T>(C * M * S), Matrix6<T>(S * C_i * M_i));
                 const Force<T> w = at.force();
                 const Vector6<T> w_f = (X * w).vector();
                 at.equal("energy", T(w_f.dot(C * w_f)), T(w.vector().dot(C_i * w.vector())));
               }),
               differs([](Point& at) {
                 const auto springs = anySprings(at);
                 const Transform<T> X = at.transform();
                 at.equal("sum of the eigenvalues of C", springs.seenFrom(X).compliance().trace(),
                          T(springs.compliance().trace()));
               })))
      .numbers(eigenvalueRows);
}

Trials otherImpedances() {
  return Trials("other_impedances")
      .printed(exact([](Point& at) {
        const auto springs = anySprings(at);
        const auto body = anyBody(at);
        const Transform<T> X = at.transform();
        const Matrix6<T> S = X.motionMatrix(), S_back = X.inverse().motionMatrix();
        at.equal("K_f", springs.seenFrom(X).stiffness(),
                 Matrix6<T>(S * springs.stiffness() * S_back));
        at.equal("M_f", massMatrix6(body.seenFrom(X.R, Vector3<T>(X.R * -X.p))),
                 Matrix6<T>(S * massMatrix6(body) * S_back));
      }))
      .corrected(exact([](Point& at) {
        const auto springs = anySprings(at);
        const auto body = anyBody(at);
        const Transform<T> X = at.transform();
        const Matrix6<T> S_back = X.inverse().motionMatrix();
        at.equal("K_f", springs.seenFrom(X).stiffness(),
                 Matrix6<T>(S_back.transpose() * springs.stiffness() * S_back));
        at.equal("M_f", massMatrix6(body.seenFrom(X.R, Vector3<T>(X.R * -X.p))),
                 Matrix6<T>(S_back.transpose() * massMatrix6(body) * S_back));
      }))
      .numbers(stiffnessRows);
}

}  // namespace

std::vector<Trials> impedances() {
  return {eq73(), eq74(), similarity(), otherImpedances()};
}

}  // namespace dynwitness::audit
