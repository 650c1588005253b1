// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/uncertain_quantities.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/motion/joint_pass.hpp"
#include "crosscheck/motion/parameter_errors.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck {
namespace {

using Kind = scene::InertialParameter::Kind;
using Numbers = scene::RealNumbers<double>;
using D = Dual<double>;

double largestMomentAboutCom(const double* ten) {
  if (ten[0] == 0) return std::max({ten[4], ten[5], ten[6]});
  const double xx = ten[1] * ten[1] / ten[0], yy = ten[2] * ten[2] / ten[0],
               zz = ten[3] * ten[3] / ten[0];
  return std::max({ten[4] - yy - zz, ten[5] - xx - zz, ten[6] - xx - yy});
}

}  // namespace

Uncertainty readUncertainty(const std::string& text) {
  // draws in double see a relative deviation of 1e-10 to six digits, and squares of 1e10 times
  // any parameter of a scene are numbers
  constexpr double kLeast = 1e-10, kMost = 1e10;
  Uncertainty out;
  const std::pair<const char*, double*> known[] = {{"mass", &out.mass},       {"com", &out.com},
                                                   {"inertia", &out.inertia}, {"rotor", &out.rotor},
                                                   {"xyz", &out.xyz},         {"rpy", &out.rpy}};
  const auto refuse = [&](const std::string& read) {
    throw scene::InputError(
        {}, fmt::format(
                "--uncertainty: read '{}'; allowed is NAME=NUMBER[,...] with 0 or a number from {} "
                "to {} and the names mass, inertia, rotor (relative), com, xyz [m], rpy [rad]",
                read, kLeast, kMost));
  };
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string item = text.substr(at, end - at);
    const std::size_t equals = item.find('=');
    const auto* const it = std::find_if(std::begin(known), std::end(known), [&](const auto& k) {
      return equals != std::string::npos && item.substr(0, equals) == k.first;
    });
    if (it == std::end(known)) refuse(item);
    const std::string digits = item.substr(equals + 1);
    std::size_t used = 0;
    try {
      *it->second = std::stod(digits, &used);
    } catch (const std::exception&) {
      refuse(item);
    }
    const double value = *it->second;
    if (used != digits.size() || !(value == 0 || (value >= kLeast && value <= kMost))) refuse(item);
    at = end + 1;
  }
  return out;
}

Eigen::MatrixXd parameterFactor(const scene::Mechanism& mechanism,
                                const std::vector<scene::InertialParameter>& parameters,
                                const Uncertainty& uncertainty) {
  const auto p = static_cast<Eigen::Index>(parameters.size());
  const std::vector<double> pi =
      recursive::inertialValues(mechanism, parameters, scene::RealNumbers<double>(mechanism));
  std::vector<Eigen::VectorXd> columns;
  const auto add = [&](Eigen::Index j, double size) {
    if (size != 0) columns.push_back(Eigen::VectorXd::Unit(p, j) * size);
  };
  for (Eigen::Index j = 0; j < p; ++j) {
    const Kind kind = parameters[j].kind;
    if (kind == Kind::kRotor) add(j, uncertainty.rotor * pi[j]);
    if (kind != Kind::kMass) continue;
    if (uncertainty.mass > 0) {
      columns.push_back(Eigen::VectorXd::Zero(p));
      for (int k = 0; k < scene::kInertialParametersOfLink; ++k)
        columns.back()(j + k) = uncertainty.mass * pi[j + k];
    }
    for (int k = 1; k <= 3; ++k) add(j + k, uncertainty.com * pi[j]);
    for (int k = 4; k < scene::kInertialParametersOfLink; ++k)
      add(j + k, uncertainty.inertia * largestMomentAboutCom(&pi[j]));
  }
  Eigen::MatrixXd factor(p, columns.size());
  for (std::size_t k = 0; k < columns.size(); ++k) factor.col(k) = columns[k];
  return factor;
}

Eigen::VectorXd Deviations::together() const {
  return (by_inertia.cwiseAbs2() + by_placement.cwiseAbs2()).cwiseSqrt();
}

struct UncertainQuantities::Parts {
  Parts(const scene::Scene& of, const Uncertainty& errors, const JointQuantities* shown)
      : mechanism(of.mechanism),
        given(errors),
        joints(shown),
        number(mechanism),
        models(mechanism, number),
        factor(parameterFactor(mechanism, models.parameters(), given)) {}

  /// @param change  of what is asked, by the error of a model
  template <typename Change>
  Deviations sum(const Change& change) const {
    Eigen::VectorXd by_inertia, by_placement;
    const auto add = [](const Eigen::VectorXd& of, Eigen::VectorXd* to) {
      if (to->size() == 0) *to = Eigen::VectorXd::Zero(of.size());
      *to += of.cwiseAbs2();
    };
    add(0 * change(models.model()), &by_inertia);
    by_placement = by_inertia;
    for (Eigen::Index k = 0; k < factor.cols(); ++k) {
      const Eigen::VectorXd direction = factor.col(k);
      add(change(models.misweighed({direction.begin(), direction.end()})), &by_inertia);
    }
    for (int k = 0; k < models.placements(); ++k) {
      const double size = k % kErrorsOfJoint < 3 ? given.xyz : given.rpy;
      if (size > 0) add(size * change(models.misplaced(k)), &by_placement);
    }
    return {by_inertia.cwiseSqrt(), by_placement.cwiseSqrt()};
  }

  scene::Mechanism mechanism;
  Uncertainty given;
  const JointQuantities* joints;
  Numbers number;
  ErroneousModels<Numbers> models;
  Eigen::MatrixXd factor;
};

UncertainQuantities::UncertainQuantities(const scene::Scene& scene, const Uncertainty& given,
                                         const JointQuantities* of) {
  if (given.ofGeometry() && of != nullptr && of->axes() == JointAxes::kWorld)
    throw scene::InputError(
        {},
        "--uncertainty of xyz or rpy with --axes world, which do not go with the "
        "link that an error turns, allowed: --axes link or joint");
  parts_ = std::make_unique<Parts>(scene, given, of);
}
UncertainQuantities::~UncertainQuantities() = default;

Deviations UncertainQuantities::tau(const scene::State<double>& state) const {
  const scene::State<D> at = constantState(state);
  return parts_->sum([&](const recursive::Model<D>& model) { return changeOfTau(model, at); });
}

Deviations UncertainQuantities::qdd(const scene::State<double>& state) const {
  const scene::State<D> at = constantState(state);
  return parts_->sum([&](const recursive::Model<D>& model) { return changeOfQdd(model, at); });
}

Deviations UncertainQuantities::joints(JointQuantity quantity,
                                       const scene::State<double>& state) const {
  if (quantity == JointQuantity::kE || quantity == JointQuantity::kBeta)
    throw scene::InputError({},
                            fmt::format("--uncertainty with {}, which is of acceleration "
                                        "constraints, allowed: X, M_i, M_C, M_A, P, PM, Z, F, PF",
                                        name(quantity)));
  const Parts& p = *parts_;
  scene::State<D> at = constantState(state);
  at.tau.resize(at.qd.size());
  const std::vector<std::size_t> links = p.joints->links();
  return p.sum([&](const recursive::Model<D>& model) {
    JointPass<D> pass(model);
    pass.run(at.x, at.qd, at.tau);
    return p.joints->arranged(quantity, [&](std::size_t k) -> Eigen::MatrixXd {
      const JointInModel<D> joint(p.mechanism, pass.model(), links[k]);
      return pass.of(joint, quantity).unaryExpr([](const D& x) { return x.derivative; });
    });
  });
}

}  // namespace dynwitness::crosscheck
