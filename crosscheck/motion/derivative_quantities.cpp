// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/derivative_quantities.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/derivatives.hpp"
#include "recursive/regressor.hpp"
#include "scene/inertial_parameters.hpp"
#include "scene/units.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr std::array<const char*, 7> kDerivativeNames = {
    "dtau_dq", "dtau_dqd", "dqdd_dq", "dqdd_dqd", "dqdd_dtau", "C", "Y"};

bool isOfForces(DerivativeQuantity quantity) {
  return quantity <= DerivativeQuantity::kDtauDqd;
}

/// Of an entry, its row and its column those of a slide or of a turn.
const char* unitOf(DerivativeQuantity quantity, bool row_slides, bool column_slides) {
  // turn by turn, turn by slide, slide by turn, slide by slide
  if (quantity == DerivativeQuantity::kCoriolis) quantity = DerivativeQuantity::kDtauDqd;
  static constexpr const char* kUnits[][4] = {
      {"N m/rad", "N", "N/rad", "N/m"},
      {"N m s/rad", "N s", "N s/rad", "N s/m"},
      {"1/s^2", "rad/(m s^2)", "m/(rad s^2)", "1/s^2"},
      {"1/s", "rad/(m s)", "m/(rad s)", "1/s"},
      {"1/(kg m^2)", "1/(kg m)", "1/(kg m)", "1/kg"},
  };
  return kUnits[static_cast<int>(quantity)][(row_slides ? 2 : 0) + (column_slides ? 1 : 0)];
}

}  // namespace

const char* name(DerivativeQuantity quantity) {
  return kDerivativeNames[static_cast<std::size_t>(quantity)];
}

std::optional<DerivativeQuantity> derivativeQuantityNamed(const std::string& text) {
  const auto found = std::find(kDerivativeNames.begin(), kDerivativeNames.end(), text);
  if (found == kDerivativeNames.end()) return std::nullopt;
  return static_cast<DerivativeQuantity>(found - kDerivativeNames.begin());
}

std::vector<std::string> derivativeQuantityNames() {
  return {kDerivativeNames.begin(), kDerivativeNames.end()};
}

struct DerivativeQuantities::Parts {
  explicit Parts(const scene::Scene& of)
      : scene(of),
        model(recursive::buildModel(of.mechanism, scene::RealNumbers<double>(of.mechanism))),
        room(model),
        of_inverse(model),
        of_forward(model),
        parameters(scene::inertialParameters(of.mechanism)),
        qdd(static_cast<std::size_t>(model.dof()), 0.0) {}

  /// Between its jumps Coulomb's force does not change; at rest it jumps.
  void requireMoving(const scene::State<double>& state) const {
    for (const scene::Link& link : scene.mechanism.links) {
      const recursive::ScenePlace<double>& place =
          model.joints[static_cast<std::size_t>(&link - scene.mechanism.links.data())];
      if (place.link < 0) continue;
      const recursive::LinkModel<double>& moved = model.links[static_cast<std::size_t>(place.link)];
      if (moved.dof < 0 || (moved.positive == 0 && moved.negative == 0) ||
          state.qd[static_cast<std::size_t>(moved.dof)] != 0)
        continue;
      throw scene::InputError(
          link.where, fmt::format("joint '{}' has Coulomb friction and rests: its force jumps "
                                  "there and has no derivative by qd; allowed: states where it "
                                  "moves, or dtau_dq, dqdd_dq, dqdd_dtau",
                                  link.joint.name));
    }
  }

  scene::Scene scene;
  recursive::Model<double> model;
  recursive::DerivativesWorkspace<double> room;
  recursive::InverseDynamicsDerivatives<double> of_inverse;
  recursive::ForwardDynamicsDerivatives<double> of_forward;
  std::vector<scene::InertialParameter> parameters;
  std::vector<double> qdd;
};

DerivativeQuantities::DerivativeQuantities(const scene::Scene& scene) {
  requireTreated(scene, Command::kEvaluateDerivatives);
  parts_ = std::make_unique<Parts>(scene);
}
DerivativeQuantities::~DerivativeQuantities() = default;

std::vector<std::string> DerivativeQuantities::columns(DerivativeQuantity quantity) const {
  const int n = parts_->model.dof();
  std::vector<std::string> matrix;
  if (quantity == DerivativeQuantity::kCoriolis) {
    for (int i = 1; i <= n; ++i)
      for (int j = 1; j <= n; ++j) matrix.push_back(fmt::format("C{}{}{}", i, n > 9 ? "_" : "", j));
    return matrix;
  }
  if (quantity == DerivativeQuantity::kRegressor) {
    for (int i = 1; i <= n; ++i)
      for (const scene::InertialParameter& parameter : parts_->parameters)
        matrix.push_back(fmt::format("Y{}_{}", i, label(parameter, parts_->scene.mechanism)));
    return matrix;
  }
  const std::string both = name(quantity), of = isOfForces(quantity) ? "dtau" : "dqdd";
  const std::string by = both.substr(of.size());
  std::vector<std::string> out;
  for (int i = 1; i <= n; ++i)
    for (int j = 1; j <= n; ++j) out.push_back(fmt::format("{}{}{}{}", of, i, by, j));
  return out;
}

std::vector<std::string> DerivativeQuantities::units(DerivativeQuantity quantity) const {
  std::vector<bool> slides;
  for (const scene::Link& link : parts_->scene.mechanism.links)
    for (int k = 0; link.parent >= 0 && k < link.joint.ownRates(); ++k)
      slides.push_back(scene::slides(link.joint.kind, static_cast<std::size_t>(k)));
  std::vector<std::string> out;
  if (quantity == DerivativeQuantity::kRegressor) {
    for (const bool row : slides)
      for (const scene::InertialParameter& parameter : parts_->parameters) {
        const std::string by = unit(parameter, parts_->scene.mechanism);
        out.push_back(fmt::format(by.find(' ') == std::string::npos ? "{}/{}" : "{}/({})",
                                  row ? "N" : "N m", by));
      }
    return out;
  }
  for (const bool row : slides)
    for (const bool column : slides) out.emplace_back(unitOf(quantity, row, column));
  return out;
}

Eigen::MatrixXd DerivativeQuantities::value(DerivativeQuantity quantity,
                                            const scene::State<double>& state) {
  Parts& p = *parts_;
  // what the quantity does not hang on may be missing
  const std::vector<double> none(p.qdd.size(), 0.0);
  if (quantity == DerivativeQuantity::kDtauDqd || quantity == DerivativeQuantity::kDqddDqd)
    p.requireMoving(state);
  if (quantity == DerivativeQuantity::kCoriolis)
    return recursive::coriolisMatrix(p.model, state.x, state.qd, p.room.ws).array() + 0.0;
  if (quantity == DerivativeQuantity::kRegressor) {
    Eigen::MatrixXd Y(p.model.dof(), static_cast<Eigen::Index>(p.parameters.size()));
    recursive::regressor(p.model, p.parameters, state.x, state.qd, state.qdd, p.room.ws, Y);
    return Y.array() + 0.0;
  }
  if (isOfForces(quantity)) {
    recursive::inverseDynamicsDerivatives(
        p.model, state.x, state.qd, quantity == DerivativeQuantity::kDtauDq ? state.qdd : none,
        p.room, p.of_inverse);
    return (quantity == DerivativeQuantity::kDtauDq ? p.of_inverse.dtau_dq : p.of_inverse.dtau_dqd)
               .array() +
           0.0;  // not -0
  }
  if (quantity == DerivativeQuantity::kDqddDq)
    recursive::forwardDynamics(p.model, state.x, state.qd, state.tau, p.room.ws, p.qdd);
  recursive::forwardDynamicsDerivatives(p.model, state.x, state.qd,
                                        quantity == DerivativeQuantity::kDqddDq ? p.qdd : none,
                                        p.room, p.of_inverse, p.of_forward);
  const recursive::RowsX<double>& value =
      quantity == DerivativeQuantity::kDqddDq    ? p.of_forward.dqdd_dq
      : quantity == DerivativeQuantity::kDqddDqd ? p.of_forward.dqdd_dqd
                                                 : p.of_forward.dqdd_dtau;
  return value.array() + 0.0;
}

}  // namespace dynwitness::crosscheck
