// SPDX-License-Identifier: GPL-3.0-or-later
// A mechanism that is struck, in any arithmetic.
#pragma once

#include <utility>
#include <vector>

#include "crosscheck/studies/point.hpp"
#include "crosscheck/witnesses/recursive_lagrange.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "recursive/joint_forces.hpp"

namespace dynwitness::crosscheck {

/// A given impulse, in any arithmetic.
template <typename T>
struct Impulse {
  LinkPoint<T> point;
  recursive::Force<T> p;  ///< at the point, world axes
  std::vector<T> joints;
  recursive::Vector3<T> direction;  ///< of an impact
  T restitution;
};

/// Velocities before and after.
template <typename T>
struct Struck {
  recursive::MatrixX<T> J;  ///< of the point, 6 x n
  recursive::VectorX<T> before, after, closures;
  T energy_before, energy_after;
  recursive::Vector6<T> point_before, point_after, p, momentum_jump, support;
  T effective_mass = T(0);
  std::vector<recursive::Force<T>> through;  ///< the joint of each link of the model
  /// What a gyroscopic rotor feels of its carrier's jump, by joint axis.
  recursive::VectorX<T> felt;
};

template <typename T>
class ImpulseModel {
 public:
  using Vector = recursive::VectorX<T>;
  using Matrix = recursive::MatrixX<T>;

  /// @param rows  equations of the closures that stand for all
  template <typename Numbers>
  ImpulseModel(const scene::Mechanism& mechanism, const Numbers& number, std::vector<int> rows)
      : model(recursive::buildModel(mechanism, number)),
        closures(recursive::buildConstraints(mechanism, number, model)),
        points(mechanism, number),
        setup_(model),
        rows_(std::move(rows)) {}

  /// Closures alone see an impulse as what it makes of velocities: M^-1 (b + J_c' Lambda).
  Struck<T> strike(const scene::State<T>& state, const Impulse<T>& impulse) {
    Struck<T> out = start(state, impulse.point);
    out.p = impulse.p.vector();
    return finish(state, impulse, out, generalized(out, impulse));
  }
  /// p = n s with n' v+ = -e n' v-.
  Struck<T> impact(const scene::State<T>& state, const Impulse<T>& impulse) {
    Struck<T> out = start(state, impulse.point);
    Vector n6 = Vector::Constant(6, T(0));
    n6.head(3) = impulse.direction;
    const Vector along = out.J.transpose() * n6;
    // closures first (they bind whatever happens), then the wall
    const Vector bound = solved(Vector::Constant(model.dof(), T(0)), out.before);
    const Vector response = solved(along, Vector::Constant(model.dof(), T(0)));
    const T inverse_mass = along.dot(response);
    const T towards = along.dot(Vector(out.before + bound));
    out.effective_mass = T(1) / inverse_mass;
    const T s = -(T(1) + impulse.restitution) * towards / inverse_mass;
    out.p = n6 * s;
    return finish(state, impulse, out, along * s);
  }

  /// Of a strike or an impact, as joint impulses: J' p + j.
  Vector generalized(const Struck<T>& struck, const Impulse<T>& impulse) const {
    return Vector(column(impulse.joints)) + Vector(struck.J.transpose() * struck.p);
  }
  /// What joint forces make of the mechanism at rest, by articulated bodies.
  Vector accelerations(const scene::State<T>& state, const Vector& forces) {
    std::vector<T> qdd = setup_.zeros();
    recursive::forwardDynamics(model, state.x, setup_.zeros(), list(forces), setup_.ws, qdd,
                               Terms::none());
    return column(qdd);
  }
  /// J qd of the closures where the last blow fell.
  Vector atClosures(const Vector& qd) const {
    Vector out(rows_.size());
    for (std::size_t k = 0; k < rows_.size(); ++k)
      out(k) = closures.J.row(rows_[k]).transpose().dot(qd);
    return out;
  }
  /// p, given at the point, about the world's origin.
  recursive::Vector6<T> aboutOrigin(const scene::State<T>& state, const LinkPoint<T>& point,
                                    const recursive::Vector6<T>& p) {
    points.kinetic(state.x, state.qd);  // places the bodies
    const int body = points.body_of_link[point.link];
    Vector4<T> at = Vector4<T>::Constant(T(1));
    at.template head<3>() = point.at;
    const Vector4<T> r4 = points.places()[body] * (points.after_of_link[point.link] * at);
    const recursive::Vector3<T> r = r4.template head<3>(), force = p.template head<3>(),
                                moment = p.template tail<3>();
    recursive::Vector6<T> out;
    out << force, moment + r.cross(force);
    return out;
  }

  recursive::Model<T> model;
  recursive::Constraints<T> closures;
  HomogeneousModel<T> points;

 private:
  static std::vector<T> list(const Vector& v) { return {v.data(), v.data() + v.size()}; }

  Struck<T> start(const scene::State<T>& state, const LinkPoint<T>& point) {
    Struck<T> out;
    out.before = column(state.qd);
    out.J = pointJacobian(model, state.x, point);
    M_.resize(model.dof(), model.dof());
    recursive::massMatrix(model, state.x, setup_.ws, M_);
    recursive::factorize(M_);
    recursive::constraintEquations(model, state.x, state.qd, setup_.ws, closures);
    return out;
  }
  /// The jump that impulses b cause where velocities were qd, and the closures' impulses (Schur).
  Vector solved(Vector b, const Vector& qd) {
    recursive::solve(M_, b);
    const int m = static_cast<int>(rows_.size());
    lambda_ = Vector::Constant(m, T(0));
    if (m == 0) return b;
    Matrix J(m, model.dof()), response(model.dof(), m);
    for (int k = 0; k < m; ++k) {
      J.row(k) = closures.J.row(rows_[k]);
      Vector column = J.row(k).transpose();
      recursive::solve(M_, column);
      response.col(k) = column;
    }
    Matrix S = J * response;
    lambda_ = -(J * Vector(qd + b));
    recursive::factorize(S);
    recursive::solve(S, lambda_);
    return b + response * lambda_;
  }
  Struck<T> finish(const scene::State<T>& state, const Impulse<T>& impulse, Struck<T> out,
                   const Vector& b) {
    const Vector jump = solved(b, out.before);
    out.after = out.before + jump;
    out.closures = lambda_;
    out.point_before = out.J * out.before;
    out.point_after = out.J * out.after;
    out.energy_before = recursive::kineticEnergy(model, state.x, state.qd, setup_.ws);
    out.energy_after = recursive::kineticEnergy(model, state.x, list(out.after), setup_.ws);
    out.momentum_jump = points.momentum(state.x, list(out.after)).col(0) -
                        points.momentum(state.x, state.qd).col(0);
    passOn(state, impulse, jump, &out);
    return out;
  }
  /// What passes through each joint, outward in: f = M dv - p, summed over what is outboard, with
  /// the gyroscopic rotors that it carries; and what the world gives, at its origin and in its
  /// axes.
  void passOn(const scene::State<T>& state, const Impulse<T>& impulse, const Vector& jump,
              Struck<T>* out) {
    std::vector<recursive::Force<T>>& through = out->through;
    recursive::linkVelocities(model, state.x, list(jump), setup_.ws);
    for (std::size_t i = 0; i < model.links.size(); ++i)
      through.push_back(model.links[i].M * setup_.ws.v[i]);
    const auto& place = model.places[impulse.point.link];
    recursive::Transform<T> X_LW = recursive::Transform<T>::identity();
    pointJacobian(model, state.x, impulse.point, &X_LW);
    if (place.link >= 0) {
      const recursive::Vector3<T> force = X_LW.R * out->p.template head<3>(),
                                  moment = X_LW.R * out->p.template tail<3>();
      const recursive::Force<T> at_link = {force, moment + impulse.point.at.cross(force)};
      through[place.link] = through[place.link] - place.X.inverseTimes(at_link);
    }
    out->felt = Vector::Constant(model.dof(), T(0));
    recursive::Force<T> world = recursive::Force<T>::zero();
    for (int i = static_cast<int>(model.links.size()) - 1; i >= 0; --i) {
      const auto& link = model.links[i];
      recursive::Force<T>& inboard = link.parent < 0 ? world : through[link.parent];
      recursive::Force<T> f = through[i];
      if (link.dof >= 0 && link.parent >= 0) {
        f = f + recursive::spinAxis(link) * jump(link.dof);
        out->felt(link.dof) = recursive::spinAxis(link).moment.dot(
            (setup_.ws.X_up[i] * setup_.ws.v[link.parent]).angular);
      }
      inboard = inboard + setup_.ws.X_up[i].inverseTimes(f);
    }
    out->support = world.vector();
  }

  Setup<T> setup_;
  std::vector<int> rows_;
  Matrix M_;
  Vector lambda_;
};

}  // namespace dynwitness::crosscheck
