// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/parameters/uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <boost/math/distributions/chi_squared.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/motion/parameter_errors.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "recursive/regressor.hpp"

namespace dynwitness::crosscheck {
namespace {

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

}  // namespace

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

bool accelerationsFollowForces(const scene::Scene& scene, std::uint64_t seed) {
  using F = PrimeField;
  const PrimeField::Modulus modulus(drawPrime(scene.name, seed, 0));
  const FieldSource source("uncertainty of " + scene.name, seed, 0);
  const FieldNumbers number(scene.mechanism, source);
  const ErroneousModels<FieldNumbers> models(scene.mechanism, number);
  const auto model = recursive::buildModel(scene.mechanism, number, recursive::FixedJoints::kKept);
  recursive::Workspace<F> ws(model);
  scene::State<F> state = indeterminateState(scene.mechanism, source);
  recursive::forwardDynamics(model, state.x, state.qd, state.tau, ws, state.qdd);
  recursive::MatrixX<F> M(model.dof(), model.dof()), Y(model.dof(), models.parameters().size());
  recursive::massMatrix(model, state.x, ws, M);
  recursive::regressor(model, models.parameters(), state.x, state.qd, state.qdd, ws, Y);
  const scene::State<Dual<F>> at = constantState(state);
  const auto follows = [&](const recursive::VectorX<F>& qdd, const recursive::VectorX<F>& tau) {
    const recursive::VectorX<F> rest = M * qdd + tau;
    return std::all_of(rest.begin(), rest.end(), [](const F& x) { return x.isZero(); });
  };
  for (Eigen::Index j = 0; j < Y.cols(); ++j) {
    std::vector<F> direction(models.parameters().size(), F(0));
    direction[static_cast<std::size_t>(j)] = F(1);
    if (!follows(changeOfQdd(models.misweighed(direction), at), Y.col(j))) return false;
  }
  for (int k = 0; k < models.placements(); ++k) {
    const auto misplaced = models.misplaced(k);
    if (!follows(changeOfQdd(misplaced, at), changeOfTau(misplaced, at))) return false;
  }
  return true;
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
