// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of impulses. Trees have those but the last, mechanisms with closures the second and the
// last.
#pragma once

#include "crosscheck/laws/law.hpp"
#include "crosscheck/studies/struck_mechanism.hpp"

namespace dynwitness::crosscheck {

/// A given impulse on a mechanism at a state. Model, state and impulse must outlive it.
template <typename T>
class Blow {
 public:
  using Scalar = T;

  Blow(ImpulseModel<T>& model, const scene::State<T>& state, const Impulse<T>& impulse)
      : model(model), state(state), impulse(impulse) {}

  const Struck<T>& struck() {
    return struck_([&] { return model.strike(state, impulse); });
  }
  static MatrixX<T> one(const T& value) { return MatrixX<T>(scalar(value)); }

  ImpulseModel<T>& model;
  const scene::State<T>& state;
  const Impulse<T>& impulse;

 private:
  Kept<Struck<T>> struck_;
};

struct LawOfTrees : Law {
  static bool appliesTo(const scene::Mechanism& mechanism) { return mechanism.closures.empty(); }
};

struct ImpulseAndAcceleration : LawOfTrees {
  static constexpr LawWords kWords = {"impulse and acceleration",
                                      "qd+ - qd- = qdd of a force J' p + j at rest", "qd",
                                      "composite_body", "articulated_body"};
  template <typename T>
  static TwoSides<T> sides(Blow<T>& at) {
    const Struck<T>& s = at.struck();
    return {s.after - s.before,
            at.model.accelerations(at.state, at.model.generalized(s, at.impulse))};
  }
};

struct EnergyOfAnImpulse : Law {
  static constexpr LawWords kWords = {"energy of an impulse",
                                      "T+ - T- = p' (v+ + v-)/2 + j' (qd+ + qd-)/2", "kinetic",
                                      "newton_euler", "sweep of velocities"};
  template <typename T>
  static TwoSides<T> sides(Blow<T>& at) {
    const Struck<T>& s = at.struck();
    T work = s.p.dot(recursive::Vector6<T>(s.point_before + s.point_after)) / T(2);
    for (Eigen::Index i = 0; i < s.before.size(); ++i)
      work += at.impulse.joints[i] * (s.before(i) + s.after(i)) / T(2);
    // closures that bind suddenly do work on the velocity that they take
    const recursive::VectorX<T> taken = at.model.atClosures(s.before + s.after);
    for (Eigen::Index k = 0; k < taken.size(); ++k) work += s.closures(k) * taken(k) / T(2);
    return {at.one(s.energy_after - s.energy_before), at.one(work)};
  }
};

struct MomentumOfAnImpulse : LawOfTrees {
  static constexpr LawWords kWords = {
      "momentum", "momentum jumps by p and the impulses through joints to the world", "momentum",
      "recursive_lagrange", "newton_euler"};
  template <typename T>
  static TwoSides<T> sides(Blow<T>& at) {
    const Struck<T>& s = at.struck();
    return {s.momentum_jump, s.support + at.model.aboutOrigin(at.state, at.impulse.point, s.p)};
  }
};

struct ImpulsesThroughJoints : LawOfTrees {
  static constexpr LawWords kWords = {"impulses through joints", "Z' f = j - d (qd+ - qd-)",
                                      "impulse", "newton_euler", ""};
  template <typename T>
  static TwoSides<T> sides(Blow<T>& at) {
    const Struck<T>& s = at.struck();
    const recursive::Model<T>& model = at.model.model;
    TwoSides<T> sides = {MatrixX<T>(model.dof(), 1), MatrixX<T>(model.dof(), 1)};
    for (std::size_t i = 0; i < model.links.size(); ++i) {
      const auto& link = model.links[i];
      for (int k = 0; k < recursive::AnyJoints::axes(link); ++k) {
        const int d = link.dof + k;
        sides.left(d, 0) = recursive::AnyJoints::force(link, k, s.through[i]);
        sides.right(d, 0) = at.impulse.joints[d] - link.rotor * (s.after(d) - s.before(d));
      }
      if (link.dof >= 0 && link.parent >= 0) sides.right(link.dof, 0) -= s.felt(link.dof);
    }
    return sides;
  }
};

struct EnergyOfAnImpact : LawOfTrees {
  static constexpr LawWords kWords = {"energy of an impact", "T- - T+ = (1 - e^2)/2 m (n' v-)^2",
                                      "kinetic", "newton_euler", "articulated_body"};
  template <typename T>
  static TwoSides<T> sides(Blow<T>& at) {
    Impulse<T> wall = at.impulse;
    for (T& j : wall.joints) j = T(0);
    const Struck<T> s = at.model.impact(at.state, wall);
    // the point's acceleration under a unit force along n, by articulated bodies
    recursive::VectorX<T> n6 = recursive::VectorX<T>::Constant(6, T(0));
    n6.head(3) = wall.direction;
    const recursive::VectorX<T> along = s.J.transpose() * n6;
    const T inverse_mass = along.dot(at.model.accelerations(at.state, along));
    const T v = wall.direction.dot(s.point_before.template head<3>());
    const T& e = wall.restitution;
    return {at.one(s.energy_before - s.energy_after),
            at.one((T(1) - e * e) * v * v / (T(2) * inverse_mass))};
  }
};

struct ClosuresAfterAnImpulse : Law {
  static constexpr LawWords kWords = {"closures after an impulse", "J qd+ = 0", "J qd", "sweeps",
                                      ""};
  static bool appliesTo(const scene::Mechanism& mechanism) { return !mechanism.closures.empty(); }
  template <typename T>
  static TwoSides<T> sides(Blow<T>& at) {
    const recursive::VectorX<T> after = at.struck().after;
    const MatrixX<T> left = at.model.atClosures(after);
    if (left.size() == 0) return {{}, {}, "no closure restrains a velocity here", true};
    return {left, MatrixX<T>::Constant(left.rows(), 1, T(0))};
  }
};

using ImpulseLaws = Laws<ImpulseAndAcceleration, EnergyOfAnImpulse, MomentumOfAnImpulse,
                         ImpulsesThroughJoints, EnergyOfAnImpact, ClosuresAfterAnImpulse>;

}  // namespace dynwitness::crosscheck
