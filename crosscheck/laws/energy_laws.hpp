// SPDX-License-Identifier: GPL-3.0-or-later
// Laws of energy: what M, C, g and T are to each other.
#pragma once

#include "crosscheck/laws/swept_mechanism.hpp"

namespace dynwitness::crosscheck {

struct SymmetricMassMatrix : Law {
  static constexpr LawWords kWords = {"symmetric mass matrix", "M = M'", "M", "newton_euler", ""};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    // by columns: the forces of unit accelerations
    recursive::MatrixX<T> M(at.n(), at.n());
    for (int j = 0; j < at.n(); ++j)
      M.col(j) = at.inverse(at.zeros(), at.unit(j), recursive::Terms::none());
    return {M, M.transpose()};
  }
};

struct QuadraticKineticEnergy : Law {
  static constexpr LawWords kWords = {"kinetic energy is quadratic", "T = qd' M qd / 2", "kinetic",
                                      "newton_euler", "composite_body"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    return {at.one(at.kineticEnergy()), (at.qd().transpose() * at.M() * at.qd()) / T(2)};
  }
};

struct PowerBalance : Law {
  static constexpr LawWords kWords = {"power balance",
                                      "d(T + V)/dt = qd' (tau + Q) - (friction's power)", "power",
                                      "newton_euler", ""};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    recursive::Terms without_loads = recursive::Terms::all();
    without_loads.loads = false;
    const recursive::MatrixX<T> tau_and_loads =
        at.inverse(at.state().qd, at.state().qdd, without_loads);
    return {at.one(at.energyRate() + at.frictionPower()), at.qd().transpose() * tau_and_loads};
  }
};

struct CoriolisMatrix : Law {
  static constexpr LawWords kWords = {"Coriolis matrix gives c", "C qd = c", "c", "composite_body",
                                      "newton_euler"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    return {at.C() * at.qd(), at.inverse(at.state().qd, at.zeros(), recursive::Terms::none())};
  }
};

struct SkewSymmetry : Law {
  static constexpr LawWords kWords = {"skew symmetry", "dM/dt - 2 C = -(dM/dt - 2 C)'",
                                      "dM/dt - 2C", "composite_body", ""};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    const recursive::MatrixX<T> skew = at.C() * T(-2) + at.massMatrixRate();
    return {skew, skew.transpose() * T(-1)};
  }
};

struct GradientOfThePotential : Law {
  static constexpr LawWords kWords = {"gradient of the potential", "g = dV/dq", "g", "newton_euler",
                                      ""};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    return {at.inverse(at.zeros(), at.zeros(), recursive::Terms::potential()),
            at.potentialGradient()};
  }
};

}  // namespace dynwitness::crosscheck
