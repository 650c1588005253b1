// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/parameters/uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <boost/math/distributions/chi_squared.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/parameters/placement_errors.hpp"
#include "recursive/regressor.hpp"

namespace dynwitness::crosscheck {
namespace {

using Kind = scene::InertialParameter::Kind;

/// Standard normal numbers in pairs (Box and Muller).
class NormalStream {
 public:
  NormalStream(const char* name, std::uint64_t seed, std::uint64_t index)
      : random_(name, seed, index) {}
  double next() {
    if (has_spare_) return has_spare_ = false, spare_;
    constexpr double kTurn = 2 * 3.141592653589793;
    const double r = std::sqrt(-2 * std::log(1 - random_.uniform(0, 1)));
    const double angle = random_.uniform(0, kTurn);
    spare_ = r * std::sin(angle);
    has_spare_ = true;
    return r * std::cos(angle);
  }
  Eigen::VectorXd next(Eigen::Index size) {
    Eigen::VectorXd z(size);
    for (double& x : z) x = next();
    return z;
  }

 private:
  RandomStream random_;
  double spare_ = 0;
  bool has_spare_ = false;
};

/// Mean and covariance of vectors as they come (Welford).
class Covariance {
 public:
  explicit Covariance(Eigen::Index size)
      : mean_(Eigen::VectorXd::Zero(size)), sum_(Eigen::MatrixXd::Zero(size, size)) {}
  void add(const Eigen::VectorXd& x) {
    ++count_;
    const Eigen::VectorXd before = x - mean_;
    mean_ += before / count_;
    sum_ += before * (x - mean_).transpose();
  }
  Eigen::MatrixXd result() const { return sum_ / (count_ - 1); }

 private:
  int count_ = 0;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd sum_;
};

Eigen::VectorXd asVector(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

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

Eigen::MatrixXd placementEffect(const scene::Mechanism& mechanism,
                                const scene::State<double>& state, const Uncertainty& uncertainty) {
  const scene::RealNumbers<double> number(mechanism);
  Eigen::MatrixXd J = placementJacobian(mechanism, number, state);
  for (Eigen::Index k = 0; k < J.cols(); ++k)
    J.col(k) *= k % kErrorsOfJoint < 3 ? uncertainty.xyz : uncertainty.rpy;
  return J;
}

Eigen::MatrixXd regressorAt(const scene::Mechanism& mechanism,
                            const std::vector<scene::InertialParameter>& parameters,
                            const scene::State<double>& state) {
  const auto model = recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism));
  recursive::Workspace<double> ws(model);
  Eigen::MatrixXd Y(model.dof(), parameters.size());
  recursive::regressor(model, parameters, state.x, state.qd, state.qdd, ws, Y);
  return Y;
}

Eigen::MatrixXd sampledByInertia(const scene::Mechanism& mechanism,
                                 const scene::State<double>& state, const Eigen::MatrixXd& factor,
                                 int samples, std::uint64_t seed) {
  const auto parameters = scene::inertialParameters(mechanism);
  const scene::RealNumbers<double> number(mechanism);
  const Eigen::VectorXd pi = asVector(recursive::inertialValues(mechanism, parameters, number));
  auto model = recursive::buildModel(mechanism, number);
  recursive::Workspace<double> ws(model);
  std::vector<double> tau(model.dof());
  Covariance covariance(model.dof());
  for (int k = 0; k < samples; ++k) {
    const Eigen::VectorXd drawn =
        pi +
        factor * NormalStream("inertia", seed, static_cast<std::uint64_t>(k)).next(factor.cols());
    recursive::setInertialValues(model, parameters,
                                 std::vector<double>(drawn.begin(), drawn.end()));
    recursive::inverseDynamics(model, state.x, state.qd, state.qdd, ws, tau);
    covariance.add(asVector(tau));
  }
  return covariance.result();
}

Eigen::MatrixXd sampledByGeometry(const scene::Mechanism& mechanism,
                                  const scene::State<double>& state, const Uncertainty& uncertainty,
                                  int samples, std::uint64_t seed) {
  const scene::RealNumbers<double> number(mechanism);
  const auto model = recursive::buildModel(mechanism, number, recursive::FixedJoints::kKept);
  const std::vector<int> joints = placedJoints(mechanism, model);
  recursive::Workspace<double> ws(model);
  std::vector<double> tau(model.dof());
  Covariance covariance(model.dof());
  auto misplaced = model;
  for (int k = 0; k < samples; ++k) {
    NormalStream normal("geometry", seed, static_cast<std::uint64_t>(k));
    for (const int joint : joints) {
      misplaced.links[joint].X_tree = model.links[joint].X_tree;
      const Eigen::Vector3d shift = uncertainty.xyz * normal.next(3);
      const Eigen::Vector3d turn = uncertainty.rpy * normal.next(3);
      const auto point = [](double angle) {
        return scene::CosSin<double>{std::cos(angle), std::sin(angle)};
      };
      displace<double>(misplaced.links[joint], shift, point(turn.x()), point(turn.y()),
                       point(turn.z()));
    }
    recursive::inverseDynamics(misplaced, state.x, state.qd, state.qdd, ws, tau);
    covariance.add(asVector(tau));
  }
  return covariance.result();
}

CovarianceCheck compareCovariance(const Eigen::MatrixXd& Sigma, const Eigen::MatrixXd& sampled,
                                  int samples, double chance) {
  const Eigen::Index n = Sigma.rows();
  const double each = chance / static_cast<double>(n * (n + 1) / 2);
  const boost::math::chi_squared distribution(samples - 1);
  CovarianceCheck out{std::sqrt(quantile(distribution, each / 2) / (samples - 1)),
                      std::sqrt(quantile(complement(distribution, each / 2)) / (samples - 1)),
                      std::numeric_limits<double>::infinity(), 0};
  const auto ask = [&](const Eigen::VectorXd& u) {
    const double expected = u.dot(Sigma * u), found = u.dot(sampled * u);
    if (expected == 0 && found == 0) return;
    const double ratio = std::sqrt(found / expected);
    out.least = std::min(out.least, ratio);
    out.most = std::max(out.most, ratio);
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    ask(Eigen::VectorXd::Unit(n, i));
    for (Eigen::Index j = i + 1; j < n; ++j)
      ask(Eigen::VectorXd::Unit(n, i) + Eigen::VectorXd::Unit(n, j));
  }
  if (out.most == 0) out.least = out.most = 1;
  return out;
}

}  // namespace dynwitness::crosscheck
