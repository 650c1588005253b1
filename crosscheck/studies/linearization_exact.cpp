// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of linearized motion over the field, and A and B in letters.
#include <fmt/format.h>

#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/scalars/indeterminates.hpp"
#include "crosscheck/studies/linear_letters.hpp"
#include "crosscheck/studies/linearization.hpp"
#include "crosscheck/studies/linearization_laws.hpp"
#include "symbolic/closed_form.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck {

std::vector<CheckResult> checkLinearizationExactly(const scene::Scene& scene,
                                                   const ExactOptions& options) {
  requireTreated(scene, Command::kLinearize);
  const auto ask = [&](const FieldNumbers& number, const scene::State<PrimeField>& state) {
    return LinearizationLaws::sides(scene.mechanism,
                                    LinearizationAsked<PrimeField>(scene.mechanism, number, state));
  };
  return decide(scene, LinearizationLaws::words(scene.mechanism), ask, options);
}

void requireLetters(const scene::Scene& scene) {
  const auto refuse = [&](const std::string& why) {
    throw scene::InputError(
        {scene.file.string(), 0},
        fmt::format("--symbolic: {}, allowed: trees of up to {} joints, all free, whose rates are "
                    "derivatives of their positions; without it there are numbers of any scene",
                    why, symbolic::kClosedFormJoints));
  };
  const scene::Mechanism& mechanism = scene.mechanism;
  if (ConstrainedQuantities::isConstrained(mechanism))
    refuse(
        "under closures, drives and what else ties joints A is of independent rates, which have "
        "no closed form here");
  if (mechanism.dof() > symbolic::kClosedFormJoints)
    refuse(fmt::format("{} rates, whose entries nobody reads (they grow fourteen-fold a joint)",
                       mechanism.dof()));
  if (!symbolic::hasClosedForm(mechanism))
    refuse("a joint with a quaternion, or one that follows another");
}

std::vector<CheckResult> checkLettersExactly(const scene::Scene& scene,
                                             const symbolic::LinearSystem& letters,
                                             ExactOptions options) {
  const int n = scene.mechanism.dof();
  std::vector<symbolic::Node> nodes;
  for (const auto* block : {&letters.by_position, &letters.by_rate, &letters.by_force})
    for (const std::vector<symbolic::Node>& row : *block)
      nodes.insert(nodes.end(), row.begin(), row.end());
  const symbolic::Program program = symbolic::compile(letters.derivation.equations->graph, nodes);
  options.parameters = Parameters::kRandom;
  const symbolic::PutIn& put_in = letters.at;
  options.at = [&put_in](const FieldNumbers&, scene::State<PrimeField>& state) {
    for (std::size_t k = 0; k < state.x.size(); ++k) {
      if (!put_in.right_angles[k]) continue;
      const auto point = scene::quarterTurns<PrimeField>(*put_in.right_angles[k]);
      state.x[k].c = point.c;
      state.x[k].s = point.s;
      if (*put_in.right_angles[k] == 0) state.x[k].q = PrimeField(0);
    }
    for (std::size_t k = 0; k < state.qd.size(); ++k) {
      if (put_in.is_still[k]) state.qd[k] = PrimeField(0);
      if (put_in.is_unaccelerated) state.qdd[k] = PrimeField(0);
    }
  };
  const auto ask = [&](const FieldNumbers& number, scene::State<PrimeField> state) {
    LinearizationModel<PrimeField> sweeps(scene.mechanism, number);
    state.tau = sweeps.inverse(state);
    symbolic::ProgramRun<PrimeField> run(program, number);
    const std::vector<PrimeField> values = run(state);
    SidesOfAll sides;
    for (const MovedPart part : {MovedPart::kPosition, MovedPart::kRate, MovedPart::kForce}) {
      recursive::MatrixX<PrimeField> block(n, n);
      const std::size_t first = sides.size() * static_cast<std::size_t>(n * n);
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
          block(i, j) = values[first + static_cast<std::size_t>(i * n + j)];
      sides.push_back({block, sweeps.ofForward(state, part)});
    }
    return sides;
  };
  const std::vector<LawWords> words = {
      {"letters of positions", "- M^-1 K = dqdd/dq", "A", "lagrange", "articulated_body"},
      {"letters of rates", "- M^-1 D = dqdd/dqd", "A", "lagrange", "articulated_body"},
      {"letters of forces", "M^-1 = dqdd/dtau", "B", "lagrange", "articulated_body"}};
  return decide(scene, words, ask, options);
}

}  // namespace dynwitness::crosscheck
