// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of impedances over the field.
#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/studies/impedance.hpp"
#include "crosscheck/studies/impedance_laws.hpp"

namespace dynwitness::crosscheck {
namespace {

/// A symmetric matrix of independent numbers.
template <typename T>
recursive::Matrix6<T> symmetric(Powers<T>* any, int free) {
  recursive::Matrix6<T> m = recursive::Matrix6<T>::Identity();
  for (int i = 0; i < free; ++i)
    for (int j = 0; j <= i; ++j) m(i, j) = m(j, i) = (*any)();
  return m;
}

}  // namespace

std::vector<CheckResult> checkImpedanceExactly(const scene::Scene& scene, const std::string& link,
                                               const ExactOptions& options) {
  requireTreated(scene, Command::kImpedance);
  const int seen = linkNamed(scene, link);
  const auto ask = [&](const FieldNumbers& number, const scene::State<PrimeField>& state) {
    using T = PrimeField;
    // tau is used as joint compliance; the rest is made of qdd, which the laws do not use
    Powers<T> any(state.qdd[0]);
    Impedance<T> z;
    z.point = {seen, any.vector()};
    z.stretch = any.vector();
    z.wrench << any.vector(), any.vector();
    Powers<T> more(state.tau[0] * state.qdd[0] + T(1));
    z.K = symmetric<T>(&more, 3);
    z.D = recursive::Matrix6<T>(z.K * T(2));
    for (int i = 3; i < 6; ++i) z.D(i, 0) = z.D(0, i) = z.K(i - 3, 1);
    z.joint_compliance = state.tau;
    ImpedanceModel<T> model(scene.mechanism, number);
    return ImpedanceLaws::sides(scene.mechanism, ImpedanceAsked<T>(model, state, z));
  };
  return decide(scene, ImpedanceLaws::words(scene.mechanism), ask, options);
}

}  // namespace dynwitness::crosscheck
