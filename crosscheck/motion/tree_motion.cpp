// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/tree_motion.hpp"

#include <algorithm>
#include <cmath>

#include "crosscheck/scalars/lifted.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck {
namespace {

using recursive::Vector3;

template <typename T>
recursive::Model<T> modelOf(const scene::Mechanism& mechanism) {
  return recursive::buildModel(mechanism, scene::RealNumbers<T>(mechanism));
}

template <typename T>
Vector3<T> three(const std::vector<T>& v, int first) {
  return {v[first], v[first + 1], v[first + 2]};
}
template <typename T>
void put(const Vector3<T>& v, std::vector<T>* out, int first) {
  for (int k = 0; k < 3; ++k) (*out)[first + k] = v(k);
}

/// (1 - cos a) / a^2 and (a - sin a) / a^3; below a = 1 by their series, which lose no digit.
template <typename T>
std::pair<T, T> turnFactors(T a) {
  using std::cos;
  using std::sin;
  if (a >= 1) return {(1 - cos(a)) / (a * a), (a - sin(a)) / (a * a * a)};
  T first = 0, second = 0, term = T(1) / 2;
  for (int k = 2; k < 30; ++k) {  // a^(k-2) (-1).. / k!
    (k % 2 == 0 ? first : second) += term;
    term *= (k % 2 == 0 ? 1 : -a * a) / T(k + 1);
  }
  return {first, second};
}

}  // namespace

template <typename T>
TreeMotion<T>::TreeMotion(const scene::Mechanism& mechanism, const scene::Mechanism* moved_by)
    : model_(modelOf<T>(mechanism)),
      moving_(moved_by == nullptr ? model_ : modelOf<T>(*moved_by)),
      ws_(model_),
      lifted_(lifted<Moving>(moving_)),
      ws_lifted_(lifted_),
      x_(model_.positions),
      qd_(model_.dof()),
      qdd_(model_.dof()),
      q_rate_(model_.positions),
      zeros_(model_.dof(), T(0)),
      has_momenta_(model_.positions == model_.dof() && !model_.coupled) {}

template <typename T>
void TreeMotion<T>::split(const State& y) {
  for (int i = 0; i < model_.positions; ++i) x_[i] = scene::jointPosition(y[i]);
  std::copy_n(y.begin() + model_.positions, model_.dof(), qd_.begin());
}

template <typename T>
void TreeMotion<T>::rate(const State& y, T /*time*/, State* rate) {
  ++this->calls;
  split(y);
  recursive::forwardDynamics(moving_, x_, qd_, zeros_, ws_, qdd_);
  recursive::positionRates(model_, x_, qd_, q_rate_);
  std::copy(q_rate_.begin(), q_rate_.end(), rate->begin());
  std::copy(qdd_.begin(), qdd_.end(), rate->begin() + model_.positions);
  rate->back() = recursive::frictionPower(model_, qd_);
}

template <typename T>
T TreeMotion<T>::power(const State& y, T /*time*/) {
  split(y);
  return recursive::frictionPower(model_, qd_);
}

template <typename T>
void TreeMotion<T>::move(State* y, const State& u) const {
  using std::cos;
  using std::sin;
  using std::sqrt;
  for (const auto& link : model_.links) {
    if (link.dof < 0) continue;
    int slot = link.slot, dof = link.dof;
    if (recursive::axisCount(link.kind) == 1) {
      (*y)[slot] += link.follows ? T(link.ratio * u[dof]) : u[dof];
      continue;
    }
    const bool floats = link.kind == recursive::JointKind::kFloating;
    const Vector3<T> w = three(u, floats ? dof + 3 : dof);
    const T angle = sqrt(w.dot(w));
    if (floats) {
      std::vector<scene::JointPosition<T>> q;
      for (int k = 0; k < 4; ++k) q.push_back(scene::jointPosition((*y)[slot + 3 + k]));
      const Vector3<T> v = three(u, dof);
      const auto [one, two] = turnFactors(angle);
      const Vector3<T> turned = v + w.cross(v) * one + w.cross(w.cross(v)) * two;
      put<T>(three(*y, slot) + recursive::rotation(q.data()) * turned, y, slot);
      slot += 3;
    }
    // q <- q (cos a/2, w sin(a/2) / a)
    const T half = angle / 2, c = cos(half), s = angle == 0 ? T(1) / 2 : T(sin(half) / angle);
    const T q_w = (*y)[slot];
    const Vector3<T> q_v = three(*y, slot + 1), turn = w * s;
    (*y)[slot] = q_w * c - q_v.dot(turn);
    put<T>(turn * q_w + q_v * c + q_v.cross(turn), y, slot + 1);
  }
}

template <typename T>
typename TreeMotion<T>::State TreeMotion<T>::commutator(const State& u, const State& v) const {
  State out(u.size(), T(0));
  for (const auto& link : model_.links) {
    if (link.dof < 0 || recursive::axisCount(link.kind) == 1) continue;
    const bool floats = link.kind == recursive::JointKind::kFloating;
    const int turn = floats ? link.dof + 3 : link.dof;
    const Vector3<T> w_1 = three(u, turn), w_2 = three(v, turn);
    put<T>(w_1.cross(w_2), &out, turn);
    if (floats)
      put<T>(w_1.cross(three(v, link.dof)) + three(u, link.dof).cross(w_2), &out, link.dof);
  }
  return out;
}

template <typename T>
typename TreeMotion<T>::State TreeMotion<T>::momentum(const State& y) {
  ++this->calls;
  split(y);
  State p(zeros_.size());
  recursive::inverseDynamics(moving_, x_, zeros_, qd_, ws_, p, recursive::Terms::none());
  return p;
}

template <typename T>
typename TreeMotion<T>::State TreeMotion<T>::velocity(const State& y, const State& p) {
  ++this->calls;
  split(y);
  State qd(zeros_.size());
  recursive::forwardDynamics(moving_, x_, zeros_, p, ws_, qd, recursive::Terms::none());
  return qd;
}

template <typename T>
typename TreeMotion<T>::State TreeMotion<T>::pull(const State& y) {
  ++this->calls;
  split(y);
  State force(zeros_.size());
  recursive::inverseDynamics(moving_, x_, qd_, zeros_, ws_, force);
  std::vector<scene::JointPosition<Moving>> x;
  std::vector<Moving> qd, p(zeros_.size(), Moving(T(0)));
  const std::vector<Moving> zeros(zeros_.size(), Moving(T(0)));
  for (int i = 0; i < model_.positions; ++i) x.push_back(moving(x_[i], qd_[i]));
  for (const T& v : qd_) qd.push_back(Moving(v));
  recursive::inverseDynamics(lifted_, x, zeros, qd, ws_lifted_, p, recursive::Terms::none());
  for (std::size_t i = 0; i < force.size(); ++i) force[i] = p[i].derivative - force[i];
  return force;
}

template <typename T>
T TreeMotion<T>::kinetic(const State& y) {
  split(y);
  return recursive::kineticEnergy(model_, x_, qd_, ws_);
}

template <typename T>
T TreeMotion<T>::energy(const State& y) {
  const T E = kinetic(y) + recursive::potentialEnergy(model_, x_, ws_);
  return model_.friction ? E + y.back() : E;
}

template <typename T>
typename TreeMotion<T>::State TreeMotion<T>::totalMomentum(const State& y) {
  split(y);
  const recursive::Force<T> p = recursive::momentum(model_, x_, qd_, ws_);
  State out(6);
  put<T>(p.force, &out, 0);
  put<T>(p.moment, &out, 3);
  return out;
}

template <typename T>
typename TreeMotion<T>::State TreeMotion<T>::residual(const State& y, const State& qdd) {
  split(y);
  State tau(zeros_.size());
  recursive::inverseDynamics(moving_, x_, qd_, qdd, ws_, tau);
  return tau;
}

template <typename T>
std::vector<T> startOf(const scene::Scene& scene) {
  const scene::RealNumbers<T> number(scene.mechanism);
  std::vector<T> start;
  for (const scene::Number& q : scene.start_q) start.push_back(number(q));
  for (const scene::Number& qd : scene.start_qd) start.push_back(number(qd));
  start.push_back(T(0));
  return start;
}

template class TreeMotion<double>;
template class TreeMotion<long double>;
template std::vector<double> startOf<double>(const scene::Scene&);
template std::vector<long double> startOf<long double>(const scene::Scene&);

}  // namespace dynwitness::crosscheck
