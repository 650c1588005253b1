// SPDX-License-Identifier: GPL-3.0-or-later
// Rates that are no derivatives of coordinates, and how they fail to commute.
#pragma once

#include <algorithm>
#include <vector>

#include "recursive/build_model.hpp"

namespace dynwitness::crosscheck {

/** The frame of a tree's rates: e_i f is df/dt where rate i alone is 1. Rates of spherical and
    floating joints are the body's, no derivatives of coordinates, and do not commute:

        [e_j, e_k] = sum of sign e_l,      of rates (v, w): (w_1 x v_2 + v_1 x w_2, w_1 x w_2) */
class RateFrame {
 public:
  struct Commutator {
    int second, result, sign;
  };

  template <typename T>
  explicit RateFrame(const recursive::Model<T>& model) : of_(model.dof()) {
    for (const recursive::LinkModel<T>& link : model.links) {
      const int d = link.dof;
      if (link.kind == recursive::JointKind::kSpherical) add(d, d, d);
      if (link.kind != recursive::JointKind::kFloating) continue;
      add(d + 3, d, d);
      add(d, d + 3, d);
      add(d + 3, d + 3, d + 3);
    }
  }
  /// Whether the rates are derivatives of coordinates.
  bool commutes() const {
    return std::all_of(of_.begin(), of_.end(), [](const auto& of_j) { return of_j.empty(); });
  }
  /// Of e_j with all others.
  const std::vector<Commutator>& of(int j) const { return of_[j]; }

  template <typename T>
  recursive::VectorX<T> commutator(const recursive::VectorX<T>& u,
                                   const recursive::VectorX<T>& v) const {
    recursive::VectorX<T> out = recursive::VectorX<T>::Constant(u.size(), T(0));
    for (std::size_t j = 0; j < of_.size(); ++j)
      for (const Commutator& c : of_[j])
        out(c.result) += u(static_cast<Eigen::Index>(j)) * v(c.second) * T(c.sign);
    return out;
  }
  /// C with C v = [u, v].
  template <typename T>
  recursive::MatrixX<T> commutator(const std::vector<T>& u) const {
    const auto n = static_cast<Eigen::Index>(of_.size());
    recursive::MatrixX<T> out = recursive::MatrixX<T>::Constant(n, n, T(0));
    for (std::size_t j = 0; j < of_.size(); ++j)
      for (const Commutator& c : of_[j]) out(c.result, c.second) = u[j] * T(c.sign);
    return out;
  }
  /// <[u, e_i], f> for every i: f takes covectors' place.
  template <typename T>
  recursive::VectorX<T> pulledBack(const recursive::VectorX<T>& u,
                                   const recursive::VectorX<T>& f) const {
    recursive::VectorX<T> out = recursive::VectorX<T>::Constant(u.size(), T(0));
    for (std::size_t j = 0; j < of_.size(); ++j)
      for (const Commutator& c : of_[j])
        out(c.second) += u(static_cast<Eigen::Index>(j)) * f(c.result) * T(c.sign);
    return out;
  }

 private:
  /// The cross product of three rates from `first` and three from `second`.
  void add(int first, int second, int result) {
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      of_[first + j].push_back({second + k, result + i, 1});
      of_[first + k].push_back({second + j, result + i, -1});
    }
  }
  std::vector<std::vector<Commutator>> of_;
};

}  // namespace dynwitness::crosscheck
