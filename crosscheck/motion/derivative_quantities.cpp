// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/derivative_quantities.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include <fmt/format.h>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/derivatives.hpp"
#include "recursive/regressor.hpp"
#include "recursive/second_derivatives.hpp"
#include "scene/inertial_parameters.hpp"
#include "scene/units.hpp"

namespace dynwitness::crosscheck {
namespace {

/// What a derivative is of and by.
struct Letters {
  const char *of, *by, *second = nullptr;
  std::vector<std::string> all() const {
    return second ? std::vector<std::string>{by, second} : std::vector<std::string>{by};
  }
};
struct Named {
  const char* name;
  Letters letters;
};
/// In the order of DerivativeQuantity. C is in the units of dtau_dqd; of Y there is no letter.
constexpr std::array<Named, 15> kDerivatives = {{{"dtau_dq", {"tau", "q"}},
                                                 {"dtau_dqd", {"tau", "qd"}},
                                                 {"dqdd_dq", {"qdd", "q"}},
                                                 {"dqdd_dqd", {"qdd", "qd"}},
                                                 {"dqdd_dtau", {"qdd", "tau"}},
                                                 {"C", {"tau", "qd"}},
                                                 {"Y", {"tau", ""}},
                                                 {"d2tau_dq_dq", {"tau", "q", "q"}},
                                                 {"d2tau_dq_dqd", {"tau", "q", "qd"}},
                                                 {"d2tau_dqd_dqd", {"tau", "qd", "qd"}},
                                                 {"d2tau_dq_dqdd", {"tau", "q", "qdd"}},
                                                 {"d2qdd_dq_dq", {"qdd", "q", "q"}},
                                                 {"d2qdd_dq_dqd", {"qdd", "q", "qd"}},
                                                 {"d2qdd_dqd_dqd", {"qdd", "qd", "qd"}},
                                                 {"d2qdd_dq_dtau", {"qdd", "q", "tau"}}}};

bool isSecond(DerivativeQuantity quantity) {
  return quantity >= DerivativeQuantity::kD2tauDqDq;
}

const Letters& lettersOf(DerivativeQuantity quantity) {
  return kDerivatives[static_cast<std::size_t>(quantity)].letters;
}

/// kg, N, m, rad, s, each to a power.
using Powers = std::array<int, 5>;

std::string inWords(const Powers& powers) {
  constexpr const char* kUnits[] = {"kg", "N", "m", "rad", "s"};
  std::string above, below;
  int factors_below = 0;
  for (std::size_t k = 0; k < powers.size(); ++k) {
    if (powers[k] == 0) continue;
    std::string& to = powers[k] > 0 ? above : below;
    if (powers[k] < 0) ++factors_below;
    const int power = std::abs(powers[k]);
    to += fmt::format("{}{}{}", to.empty() ? "" : " ", kUnits[k],
                      power == 1 ? "" : fmt::format("^{}", power));
  }
  if (above.empty()) above = "1";
  if (below.empty()) return above;
  return fmt::format(factors_below > 1 ? "{}/({})" : "{}/{}", above, below);
}

/// Of an entry in the row of a joint that slides or turns, by letters of joints that do. Of M and
/// 1/M an angle is a number, as everywhere: kg m^2, and not kg m^2/rad.
std::string unitOf(const Letters& letters, bool row_slides, const std::vector<bool>& slide) {
  enum { kKg, kN, kM, kRad, kS };
  Powers powers = {};
  const std::vector<std::string> by = letters.all();
  const bool is_inverse = by.back() == "tau", is_M = by.back() == "qdd";
  if (is_inverse || is_M) {
    const int sign = is_M ? 1 : -1;
    powers[kKg] = sign;
    powers[kM] = sign * ((row_slides ? 0 : 1) + (slide.back() ? 0 : 1));
  } else if (letters.of == std::string("tau")) {
    powers[kN] = 1;
    powers[kM] = row_slides ? 0 : 1;
  } else {
    ++powers[row_slides ? kM : kRad];
    powers[kS] = -2;
  }
  for (std::size_t k = 0; k < by.size(); ++k) {
    if (by[k] == "tau" || by[k] == "qdd") continue;
    --powers[slide[k] ? kM : kRad];
    if (by[k] == "qd") ++powers[kS];
  }
  return inWords(powers);
}

}  // namespace

const char* name(DerivativeQuantity quantity) {
  return kDerivatives[static_cast<std::size_t>(quantity)].name;
}

std::optional<DerivativeQuantity> derivativeQuantityNamed(const std::string& text) {
  const auto* const found = std::find_if(kDerivatives.begin(), kDerivatives.end(),
                                         [&](const Named& one) { return one.name == text; });
  if (found == kDerivatives.end()) return std::nullopt;
  return static_cast<DerivativeQuantity>(found - kDerivatives.begin());
}

std::vector<std::string> derivativeQuantityNames() {
  std::vector<std::string> names;
  for (const Named& one : kDerivatives) names.emplace_back(one.name);
  return names;
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
                                  "moves, or derivatives by q, qdd and tau alone",
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

  /// Made when they are first asked for: n^3 numbers each.
  struct Second {
    explicit Second(const recursive::Model<double>& model) : room(model), of_tau(model) {}
    recursive::SecondDerivativesWorkspace<double> room;
    recursive::InverseDynamicsSecondDerivatives<double> of_tau;
    std::optional<recursive::ForwardDynamicsSecondDerivatives<double>> of_qdd;
  };
  std::unique_ptr<Second> second;

  /// n x n^2, of one cube. @param state  with qdd for d2tau_dq_dq, tau for d2qdd_dq_dq
  Eigen::MatrixXd secondDerivatives(DerivativeQuantity quantity, const scene::State<double>& state);
};

Eigen::MatrixXd DerivativeQuantities::Parts::secondDerivatives(DerivativeQuantity quantity,
                                                               const scene::State<double>& state) {
  using Quantity = DerivativeQuantity;
  if (!second) second = std::make_unique<Second>(model);
  const std::vector<double> none(qdd.size(), 0.0);
  Second& s = *second;
  const auto k =
      static_cast<std::size_t>(quantity) - static_cast<std::size_t>(Quantity::kD2tauDqDq);
  const bool is_of_forces = k < s.of_tau.all().size();
  if (is_of_forces) {
    recursive::inverseDynamicsSecondDerivatives(model, state.x, state.qd,
                                                quantity == Quantity::kD2tauDqDq ? state.qdd : none,
                                                s.room, s.of_tau);
  } else {
    if (!s.of_qdd) s.of_qdd.emplace(model);
    if (quantity == Quantity::kD2qddDqDq)
      recursive::forwardDynamics(model, state.x, state.qd, state.tau, room.ws, qdd);
    recursive::forwardDynamicsSecondDerivatives(model, state.x, state.qd,
                                                quantity == Quantity::kD2qddDqDq ? qdd : none,
                                                s.room, s.of_tau, *s.of_qdd);
  }
  const recursive::Cube<double>& cube =
      is_of_forces ? *s.of_tau.all()[k] : *s.of_qdd->all()[k - s.of_tau.all().size()];
  const int n = model.dof();
  Eigen::MatrixXd out(n, n * n);
  for (int j = 0; j < n; ++j) out.middleCols(j * n, n) = cube.slab(j);
  return out.array() + 0.0;  // not -0
}

DerivativeQuantities::DerivativeQuantities(const scene::Scene& scene) {
  requireTreated(scene, Command::kEvaluateDerivatives);
  parts_ = std::make_unique<Parts>(scene);
}
DerivativeQuantities::~DerivativeQuantities() = default;

void DerivativeQuantities::require(DerivativeQuantity quantity) const {
  if (!isSecond(quantity)) return;
  const scene::Scene& scene = parts_->scene;
  const long n = parts_->model.dof();
  if (n * n * n > kMostNumbers)
    throw scene::InputError(
        {scene.file.string(), 0},
        fmt::format("{} of {} rates has {} numbers a state, allowed: at most {}, or first "
                    "derivatives",
                    name(quantity), n, n * n * n, kMostNumbers));
  for (const scene::Link& link : scene.mechanism.links)
    if (!link.joint.rotors.empty())
      throw scene::InputError(
          link.where, fmt::format("{}: joint \"{}\" has rotors geared to several rates, allowed: "
                                  "scenes without, or first derivatives",
                                  name(quantity), link.joint.name));
}

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
  const Letters letters = lettersOf(quantity);
  std::vector<std::string> out;
  for (int i = 1; i <= n; ++i)
    for (int j = 1; j <= n; ++j) {
      const std::string entry = fmt::format("{}{}{}_d{}{}", isSecond(quantity) ? "d2" : "d",
                                            letters.of, i, letters.by, j);
      if (!isSecond(quantity)) {
        out.push_back(entry);
        continue;
      }
      for (int k = 1; k <= n; ++k) out.push_back(fmt::format("{}_d{}{}", entry, letters.second, k));
    }
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
  const Letters letters = lettersOf(quantity);
  for (const bool row : slides)
    for (const bool first : slides) {
      if (!isSecond(quantity)) {
        out.push_back(unitOf(letters, row, {first}));
        continue;
      }
      for (const bool second : slides) out.push_back(unitOf(letters, row, {first, second}));
    }
  return out;
}

Eigen::MatrixXd DerivativeQuantities::value(DerivativeQuantity quantity,
                                            const scene::State<double>& state) {
  Parts& p = *parts_;
  // what the quantity does not hang on may be missing
  const std::vector<double> none(p.qdd.size(), 0.0);
  const std::vector<std::string> by = lettersOf(quantity).all();
  if (quantity != DerivativeQuantity::kCoriolis && std::count(by.begin(), by.end(), "qd") > 0)
    p.requireMoving(state);
  if (isSecond(quantity)) return p.secondDerivatives(quantity, state);
  if (quantity == DerivativeQuantity::kCoriolis)
    return recursive::coriolisMatrix(p.model, state.x, state.qd, p.room.ws).array() + 0.0;
  if (quantity == DerivativeQuantity::kRegressor) {
    Eigen::MatrixXd Y(p.model.dof(), static_cast<Eigen::Index>(p.parameters.size()));
    recursive::regressor(p.model, p.parameters, state.x, state.qd, state.qdd, p.room.ws, Y);
    return Y.array() + 0.0;
  }
  if (quantity <= DerivativeQuantity::kDtauDqd) {
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
