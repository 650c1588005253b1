// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/solve_bound.hpp"

#include <cmath>
#include <limits>
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using recursive::Motion;

constexpr double kOrientation = 8, kQuaternion = 60;  ///< [u], in norm
constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2;

}  // namespace

SolveBound::SolveBound(const PreparedScene& scene, SolvedBy method, int turns, double matrices)
    : scene_(scene),  // an engine passes fixed joints too
      model_(turns == 1 ? scene_.model<double>() : scene_.modelWithFixedJoints<double>()),
      ws_(model_),
      method_(method),
      inertia_(static_cast<Eigen::Index>(model_.links.size())),
      wrench_(inertia_) {
  for (std::size_t k = 0; k < model_.links.size(); ++k) {
    const bool by_quaternion = recursive::axisCount(model_.links[k].kind) >= 3;
    // of an engine's turns one is the joint's own; the others are fixed, no quaternion gives them
    const double orientations =
        matrices * kOrientation * turns + (by_quaternion ? kQuaternion - kOrientation : 0);
    inertia_(static_cast<Eigen::Index>(k)) =
        (3 * 24 + 3 * 6 * turns + 2 * orientations) * kUnitRoundoff;
    wrench_(static_cast<Eigen::Index>(k)) = 2 * (9 + 6 * turns + orientations) * kUnitRoundoff;
  }
}

void SolveBound::measure(const scene::State<double>& state, const std::vector<double>& qdd) {
  const int links = static_cast<int>(model_.links.size()), n = model_.dof();
  std::vector<double> tau(n, 0.0);
  recursive::inverseDynamics(model_, state.x, state.qd, qdd, ws_, tau);

  std::vector<recursive::RigidInertia<double>> composite;
  for (const recursive::LinkModel<double>& link : model_.links) composite.push_back(link.M);
  for (int k = links - 1; k >= 0; --k)
    if (const int p = model_.links[k].parent; p >= 0)
      composite[p] = composite[p] + ws_.X_up[k].inverseTimes(composite[k]);

  a_ = c_ = p_ = VectorXd(links);
  V_ = W_ = N_ = MatrixXd::Zero(links, n);
  origin_.assign(links, Eigen::Vector3d::Zero());
  std::vector<Eigen::Matrix3d> R_W(links);  // world to link
  // of each link's joint, in world axes, about the link's origin
  std::vector<std::vector<Motion<double>>> axes(static_cast<std::size_t>(links));
  for (int k = 0; k < links; ++k) {
    const recursive::LinkModel<double>& link = model_.links[k];
    const recursive::Transform<double>& X = ws_.X_up[k];
    const int p = link.parent;
    R_W[k] = p < 0 ? X.R : Eigen::Matrix3d(X.R * R_W[p]);
    origin_[k] = p < 0 ? X.p : Eigen::Vector3d(origin_[p] + R_W[p].transpose() * X.p);
    const recursive::Symmetric3<double>& I = composite[k].I;
    a_(k) = std::sqrt(std::max(composite[k].mass, 0.0));
    const double disc = link.spin == 0 ? 0 : link.spin * link.spin / link.rotor;
    double discs = disc;
    for (const recursive::GearedRotor<double>& rotor : model_.rotors)
      if (rotor.carrier == k) discs += rotor.inertia;
    c_(k) = std::sqrt(std::max((I.xx + I.yy + I.zz) / 2 + discs, 0.0));
    p_(k) = X.p.norm();
    for (int i = 0; link.dof >= 0 && i < recursive::axisCount(link.kind); ++i) {
      Motion<double> Z = Motion<double>::zero();
      recursive::AnyJoints::addMotion(link, i, 1.0, Z);
      axes[k].push_back({R_W[k].transpose() * Z.linear, R_W[k].transpose() * Z.angular});
    }
    for (int i = k; i >= 0; i = model_.links[i].parent) {  // the joints that carry link k
      for (std::size_t j = 0; j < axes[i].size(); ++j) {
        const Motion<double>& axis = axes[i][j];
        const int d = model_.links[i].dof + static_cast<int>(j);  // several joints may share a rate
        V_(k, d) += (axis.linear + axis.angular.cross(origin_[k] - origin_[i])).norm();
        W_(k, d) += axis.angular.norm();
      }
    }
    N_.row(k) = a_(k) * V_.row(k) + (c_(k) + 2 * p_(k) * a_(k)) * W_.row(k);  // (4)
    if (link.spin != 0) N_(k, link.dof) += std::sqrt(link.rotor);
  }
  addGearedRotors(axes.size());
}

void SolveBound::addGearedRotors(std::size_t links) {
  geared_ = MatrixXd::Zero(static_cast<Eigen::Index>(links), model_.dof());
  for (const recursive::GearedRotor<double>& rotor : model_.rotors)
    for (std::size_t i = 0; i < rotor.ratio.size(); ++i) {
      const int d = rotor.dof + static_cast<int>(i);
      const double own = std::sqrt(rotor.inertia) * std::abs(rotor.ratio[i]);
      for (const int k : {model_.link_of_dof[d], rotor.carrier})
        if (k >= 0) geared_(k, d) += own;
    }
  N_ += geared_;
}

VectorXd SolveBound::operator()(const scene::State<double>& state, const VectorXd& qdd) {
  const std::vector<double> rates(qdd.data(), qdd.data() + qdd.size());
  measure(state, rates);
  const int links = static_cast<int>(model_.links.size());
  VectorXd out = VectorXd::Zero(qdd.size());
  if (method_ != SolvedBy::kMassMatrix) {
    VectorXd E(links), force(links), moment(links);
    for (int k = 0; k < links; ++k) {
      const recursive::LinkModel<double>& link = model_.links[k];
      const Motion<double> joint = recursive::AnyJoints::motion(link, rates);
      const Motion<double> v_J = recursive::AnyJoints::motion(link, state.qd);
      const Motion<double> bias = cross(ws_.v[k], v_J);
      // the parent's part is what is left of the sum
      const double linear = 2 * (joint.linear.norm() + bias.linear.norm()) + ws_.a[k].linear.norm();
      const double angular =
          2 * (joint.angular.norm() + bias.angular.norm()) + ws_.a[k].angular.norm();
      E(k) = a_(k) * linear + (c_(k) + 2 * p_(k) * a_(k)) * angular;  // (5)
      if (link.spin != 0) E(k) += std::sqrt(link.rotor) * std::abs(rates[link.dof]);
      E(k) += geared_.row(k).dot(qdd.cwiseAbs());
      force(k) = ws_.f[k].force.norm();
      moment(k) = ws_.f[k].moment.norm() + 2 * p_(k) * force(k);
    }
    out += N_.transpose() * inertia_.cwiseProduct(E) +
           V_.transpose() * wrench_.cwiseProduct(force) +
           W_.transpose() * wrench_.cwiseProduct(moment);  // (7)
  }
  if (method_ != SolvedBy::kSweep) {
    VectorXd root =
        VectorXd::Zero(qdd.size());  // sqrt(M_ii), from above: the rotor's inertia in it
    for (int k = 0; k < links; ++k) {
      const recursive::LinkModel<double>& link = model_.links[k];
      for (int i = link.dof; i >= 0 && i < link.dof + recursive::axisCount(link.kind); ++i)
        root(i) += std::hypot(N_(k, i), std::sqrt(link.rotor));  // over the joints of a rate
    }
    const double steps = 3 * static_cast<double>(qdd.size()) + 1;
    out += massMatrix() * qdd.cwiseAbs() +
           steps * kUnitRoundoff * root.dot(qdd.cwiseAbs()) * root;  // (8)
  }
  return out;
}

void SolveBound::judge(const scene::State<double>& state, const MatrixXd& bound_of_tau,
                       Answer& answer) {
  answer.residual_bound = bound_of_tau + (*this)(state, answer.value);
  M_.resize(model_.dof(), model_.dof());
  recursive::massMatrix(model_, state.x, ws_, M_);
  const Eigen::Map<const VectorXd> tau(state.tau.data(), M_.rows());
  force_ = (M_.cwiseAbs() * answer.value.cwiseAbs() + tau.cwiseAbs()).maxCoeff();
  if (answer.bound.allFinite())
    answer.residual_bound = answer.residual_bound.cwiseMin(M_.cwiseAbs() * answer.bound);
}

bool SolveBound::isWide(const MatrixXd& residual_bound, double wide) const {
  return residual_bound.maxCoeff() > wide * 2 * kUnitRoundoff * force_;
}

MatrixXd SolveBound::sharper(const MatrixX<RunningError>& M, const scene::State<double>& state) {
  const MatrixXd running = boundedAnswer({}, M).bound;
  return crosscheck::isWide(M) ? MatrixXd(running.cwiseMin(massMatrix(state))) : running;
}

MatrixXd SolveBound::massMatrix(const scene::State<double>& state) {
  measure(state, std::vector<double>(model_.dof(), 0.0));
  return massMatrix();
}

MatrixXd SolveBound::massMatrix() const {
  MatrixXd out = N_.transpose() * inertia_.asDiagonal() * N_;  // (9)
  for (int k = 0; k < static_cast<int>(model_.links.size()); ++k) {
    const recursive::LinkModel<double>& outboard = model_.links[k];
    for (int j = outboard.dof; j >= 0 && j < outboard.dof + recursive::axisCount(outboard.kind);
         ++j)
      addBroughtDown(k, j, out);
  }
  return out;
}

void SolveBound::addBroughtDown(int k, int j, MatrixXd& out) const {
  // the sum over the joints passed so far, for every joint further inboard
  VectorXd passed = VectorXd::Zero(model_.dof());
  for (int m = k; m >= 0; m = model_.links[m].parent) {
    const double moment = c_(k) + ((origin_[m] - origin_[k]).norm() + 2 * p_(m)) * a_(k);
    passed += wrench_(m) * N_(k, j) * (a_(k) * V_.row(m) + moment * W_.row(m)).transpose();
  }
  for (int m = k; m >= 0; m = model_.links[m].parent) {
    const recursive::LinkModel<double>& link = model_.links[m];
    for (int i = link.dof; i >= 0 && i < link.dof + recursive::axisCount(link.kind); ++i) {
      out(i, j) += passed(i);
      if (i != j || m != k) out(j, i) += passed(i);  // joints of one rate on a chain meet twice
    }
  }
  out(j, j) += 4 * kUnitRoundoff * model_.links[k].rotor;
}

}  // namespace dynwitness::crosscheck
