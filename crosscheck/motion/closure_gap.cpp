// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/closure_gap.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/scalars/rounded_state.hpp"
#include "recursive/constraints.hpp"

namespace dynwitness::crosscheck {

std::string ClosureGap::text() const {
  return fmt::format("|phi| = {:.3g}, |J qd| = {:.3g}", phi, phi_rate);
}

struct ClosureGaps::Parts {
  explicit Parts(const PreparedScene& scene)
      : model(scene.model<RunningError>()),
        ws(model),
        closures(recursive::buildConstraints(scene.mechanism(),
                                             RunningErrorNumbers(scene.mechanism()), model)) {}

  recursive::Model<RunningError> model;
  recursive::Workspace<RunningError> ws;
  recursive::Constraints<RunningError> closures;
};

ClosureGaps::ClosureGaps(const PreparedScene& scene) : parts_(std::make_unique<Parts>(scene)) {}
ClosureGaps::~ClosureGaps() = default;

ClosureGap ClosureGaps::at(const scene::State<double>& state) {
  Parts& p = *parts_;
  ClosureGap gap;
  if (p.closures.rows() == 0) return gap;
  std::vector<scene::JointPosition<RunningError>> x;
  for (const scene::JointPosition<double>& q : state.x) x.push_back(roundedPosition(q.q));
  const std::vector<RunningError> qd = rounded(state.qd);
  recursive::constraintEquations(p.model, x, qd, p.ws, p.closures);
  const auto see = [&gap](const RunningError& residual, double* largest) {
    *largest = std::max(*largest, std::abs(residual.value()));
    if (!(std::abs(residual.value()) <= residual.bound())) gap.is_open = true;
  };
  for (int row = 0; row < p.closures.rows(); ++row) {
    RunningError rate = 0.0;
    for (std::size_t i = 0; i < qd.size(); ++i)
      rate += p.closures.J(row, static_cast<Eigen::Index>(i)) * qd[i];
    see(p.closures.phi(row), &gap.phi);
    see(rate, &gap.phi_rate);
  }
  return gap;
}

ClosureGap ClosureGaps::ofStart(const PreparedScene& scene) {
  if (scene.mechanism().closures.empty()) return {};
  return ClosureGaps(scene).at(ConstrainedQuantities(scene.scene()).start());
}

}  // namespace dynwitness::crosscheck
