// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of impulses as two sides, in any arithmetic.
#pragma once

#include <stdexcept>
#include <vector>

#include "crosscheck/laws/two_sides.hpp"
#include "crosscheck/studies/point.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/recursive_lagrange.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "recursive/joint_forces.hpp"

namespace dynwitness::crosscheck {

inline constexpr IdentityInfo kImpulseLaws[] = {
    {"impulse and acceleration", "qd+ - qd- = qdd of a force J' p + j at rest", "qd",
     "composite_body", "articulated_body"},
    {"energy of an impulse", "T+ - T- = p' (v+ + v-)/2 + j' (qd+ + qd-)/2", "kinetic",
     "newton_euler", "sweep of velocities"},
    {"momentum", "momentum jumps by p and the impulses through joints to the world", "momentum",
     "recursive_lagrange", "newton_euler"},
    {"impulses through joints", "Z' f = j - d (qd+ - qd-)", "impulse", "newton_euler", ""},
    {"energy of an impact", "T- - T+ = (1 - e^2)/2 m (n' v-)^2", "kinetic", "newton_euler",
     "articulated_body"},
    {"closures after an impulse", "J qd+ = 0", "J qd", "sweeps", ""},
};

/// The laws that a scene has: trees those but the last, mechanisms with closures the second and the
/// last.
inline std::vector<CheckResult> impulseLawsOf(const scene::Mechanism& mechanism,
                                              const std::vector<CheckResult>& checks) {
  if (mechanism.closures.empty()) return {checks.begin(), checks.end() - 1};
  return {checks[1], checks.back()};
}

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

  /// Both sides of kImpulseLaws.
  std::vector<TwoSides<T>> laws(const scene::State<T>& state, const Impulse<T>& impulse) {
    std::vector<TwoSides<T>> out(std::size(kImpulseLaws));
    const auto law = [&](int k, const auto& sides) {
      try {
        out[k] = sides();
      } catch (const std::domain_error& error) {  // a divisor is zero
        out[k].failure = error.what();
      }
    };
    const auto one = [](const T& value) { return MatrixOf<T>(scalar(value)); };
    law(0, [&] {
      const Struck<T> struck = strike(state, impulse);
      if (!rows_.empty()) throw std::domain_error("the scene has closures");
      const Vector b = generalized(struck, impulse);
      std::vector<T> qdd = setup_.zeros();
      recursive::forwardDynamics(model, state.x, setup_.zeros(), list(b), setup_.ws, qdd,
                                 Terms::none());
      return TwoSides<T>{Vector(struck.after - struck.before), column(qdd), {}};
    });
    law(1, [&] {
      const Struck<T> s = strike(state, impulse);
      T work = s.p.dot(recursive::Vector6<T>(s.point_before + s.point_after)) / T(2);
      for (int i = 0; i < model.dof(); ++i)
        work += impulse.joints[i] * (s.before(i) + s.after(i)) / T(2);
      // closures that bind suddenly do work on the velocity that they take
      for (std::size_t k = 0; k < rows_.size(); ++k)
        work += s.closures(k) *
                closures.J.row(rows_[k]).transpose().dot(Vector(s.before + s.after)) / T(2);
      return TwoSides<T>{one(s.energy_after - s.energy_before), one(work), {}};
    });
    law(2, [&] {
      const Struck<T> s = strike(state, impulse);
      if (!rows_.empty()) throw std::domain_error("the scene has closures");
      recursive::Vector6<T> right = s.support;
      addAtOrigin(state, impulse.point, s.p, &right);
      return TwoSides<T>{MatrixOf<T>(s.momentum_jump), MatrixOf<T>(right), {}};
    });
    law(3, [&] {
      const Struck<T> s = strike(state, impulse);
      if (!rows_.empty()) throw std::domain_error("the scene has closures");
      MatrixOf<T> left(model.dof(), 1), right(model.dof(), 1);
      for (int i = 0; i < static_cast<int>(model.links.size()); ++i) {
        const auto& link = model.links[i];
        for (int k = 0; k < recursive::AnyJoints::axes(link); ++k) {
          const int d = link.dof + k;
          left(d, 0) = recursive::AnyJoints::force(link, k, through_[i]);
          right(d, 0) = impulse.joints[d] - link.rotor * (s.after(d) - s.before(d));
        }
        if (link.dof >= 0 &&
            link.parent >= 0)  // and what a gyroscopic rotor feels of its carrier's jump
          right(link.dof, 0) -= recursive::spinAxis(link).moment.dot(
              (setup_.ws.X_up[i] * setup_.ws.v[link.parent]).angular);
      }
      return TwoSides<T>{left, right, {}};
    });
    law(4, [&] {
      if (!rows_.empty()) throw std::domain_error("the scene has closures");
      Impulse<T> wall = impulse;
      for (T& j : wall.joints) j = T(0);
      const Struck<T> s = impact(state, wall);
      // the point's acceleration under a unit force along n, by articulated bodies
      Vector n6 = Vector::Constant(6, T(0));
      n6.head(3) = impulse.direction;
      const Vector along = s.J.transpose() * n6;
      std::vector<T> qdd = setup_.zeros();
      recursive::forwardDynamics(model, state.x, setup_.zeros(), list(along), setup_.ws, qdd,
                                 Terms::none());
      const T inverse_mass = along.dot(Vector(column(qdd)));
      const T v = impulse.direction.dot(s.point_before.template head<3>());
      const T& e = impulse.restitution;
      return TwoSides<T>{one(s.energy_before - s.energy_after),
                         one((T(1) - e * e) * v * v / (T(2) * inverse_mass)),
                         {}};
    });
    law(5, [&] {
      if (rows_.empty()) throw std::domain_error("the scene has no closures");
      const Struck<T> s = strike(state, impulse);
      MatrixOf<T> left(rows_.size(), 1);
      for (std::size_t k = 0; k < rows_.size(); ++k)
        left(k, 0) = closures.J.row(rows_[k]).transpose().dot(s.after);
      return TwoSides<T>{left, MatrixOf<T>::Constant(left.rows(), 1, T(0)), {}};
    });
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
  Vector generalized(const Struck<T>& struck, const Impulse<T>& impulse) const {
    return Vector(column(impulse.joints)) + Vector(struck.J.transpose() * struck.p);
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
    passOn(state, impulse, jump, out.p, &out.support);
    return out;
  }
  /// What passes through each joint, outward in: f = M dv - p, summed over what is outboard, with
  /// the gyroscopic rotors that it carries; and what the world gives, at its origin and in its
  /// axes. Leaves the links' jumps in the workspace.
  void passOn(const scene::State<T>& state, const Impulse<T>& impulse, const Vector& jump,
              const recursive::Vector6<T>& p, recursive::Vector6<T>* support) {
    recursive::linkVelocities(model, state.x, list(jump), setup_.ws);
    through_.clear();
    for (std::size_t i = 0; i < model.links.size(); ++i)
      through_.push_back(model.links[i].M * setup_.ws.v[i]);
    const auto& place = model.places[impulse.point.link];
    recursive::Transform<T> X_LW = recursive::Transform<T>::identity();
    pointJacobian(model, state.x, impulse.point, &X_LW);
    recursive::linkVelocities(model, state.x, list(jump), setup_.ws);
    if (place.link >= 0) {
      const recursive::Vector3<T> force = X_LW.R * p.template head<3>(),
                                  moment = X_LW.R * p.template tail<3>();
      const recursive::Force<T> at_link = {force, moment + impulse.point.at.cross(force)};
      through_[place.link] = through_[place.link] - place.X.inverseTimes(at_link);
    }
    recursive::Force<T> world = recursive::Force<T>::zero();
    for (int i = static_cast<int>(model.links.size()) - 1; i >= 0; --i) {
      const auto& link = model.links[i];
      recursive::Force<T>& inboard = link.parent < 0 ? world : through_[link.parent];
      recursive::Force<T> f = through_[i];
      if (link.dof >= 0 && link.parent >= 0) f = f + recursive::spinAxis(link) * jump(link.dof);
      inboard = inboard + setup_.ws.X_up[i].inverseTimes(f);
    }
    *support = world.vector();
  }
  /// p, given at the point, about the world's origin.
  void addAtOrigin(const scene::State<T>& state, const LinkPoint<T>& point,
                   const recursive::Vector6<T>& p, recursive::Vector6<T>* sum) {
    points.kinetic(state.x, state.qd);  // places the bodies
    const int body = points.body_of_link[point.link];
    Vector4<T> at = Vector4<T>::Constant(T(1));
    at.template head<3>() = point.at;
    const Vector4<T> r4 = points.places()[body] * (points.after_of_link[point.link] * at);
    const recursive::Vector3<T> r = r4.template head<3>(), force = p.template head<3>(),
                                moment = p.template tail<3>();
    sum->template head<3>() += force;
    sum->template tail<3>() += moment + r.cross(force);
  }

  Setup<T> setup_;
  std::vector<int> rows_;
  Matrix M_;
  Vector lambda_;
  std::vector<recursive::Force<T>> through_;  ///< of the last strike, by link of the model
};

}  // namespace dynwitness::crosscheck
