// SPDX-License-Identifier: GPL-3.0-or-later
// Joints that follow others and rotors geared to several rates, for witnesses that know trees of
// independent joints only.
#pragma once

#include <memory>
#include <vector>

#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "recursive/factorization.hpp"
#include "scene/mimic.hpp"

namespace dynwitness::crosscheck {

/** From the tree with all joints let go, and geared rotors links of their own
    (scene::withOwnRates), to the mechanism where some follow others. With G the constant matrix
    that makes all rates of the independent ones (1 for a rate's own joint, k for its followers, its
    ratios for a rotor), all the tree's quantities at  G qd, G qdd  become

        M = G' M_tree G      c = G' c_tree      g = G' g_tree      tau = G' tau_tree

    (dG/dt = 0), energies, momentum and reactions stay what they are, and qdd solves M qdd = tau -
    (tau at qdd = 0). Positions are the same slots in both, and one a rotor after them, where it
    stands at 0: it looks the same from all sides. */
template <typename T>
class Coupling {
 public:
  template <typename Numbers>
  Coupling(const scene::Mechanism& mechanism, const Numbers& number) : dof_(mechanism.dof()) {
    int rate = 0;
    auto follower = scene::followers(mechanism);
    auto next = follower.begin();
    std::vector<Rate> rotors;
    links_ = mechanism.links.size();
    for (const scene::Link& link : mechanism.links) {
      for (const scene::Rotor& rotor : link.joint.rotors) {
        rotors.emplace_back();
        for (std::size_t k = 0; k < rotor.ratio.size(); ++k)
          rotors.back().push_back({rate + static_cast<int>(k), true, number(rotor.ratio[k])});
      }
      if (link.joint.mimic) {
        rates_.push_back({{next->rate, true, number(scene::Number(next->multiplier))}});
        ++next;
      }
      for (int k = 0; k < link.joint.ownRates(); ++k) rates_.push_back({{rate++, false, T(1)}});
    }
    rotors_ = rotors.size();
    rates_.insert(rates_.end(), rotors.begin(), rotors.end());
  }

  /// The tree's state; its tau, which is a question to nobody there, is 0.
  scene::State<T> onTree(const scene::State<T>& state) const {
    scene::State<T> tree = {state.x, expanded(state.qd), expanded(state.qdd),
                            std::vector<T>(rates_.size(), T(0))};
    tree.x.insert(tree.x.end(), rotors_, {T(0), T(1), T(0)});
    return tree;
  }

  /// @param ask  ask(quantity, state of the tree): the tree's answer; of M and tau for qdd
  template <typename Ask>
  MatrixX<T> operator()(Quantity quantity, const scene::State<T>& state, Ask&& ask) const {
    scene::State<T> tree = onTree(state);
    if (quantity == Quantity::kM) return reducedMatrix(ask(quantity, tree));
    if (quantity == Quantity::kc || quantity == Quantity::kg || quantity == Quantity::kTau)
      return reduced(ask(quantity, tree));
    if (quantity == Quantity::kReactions)  // without those of the rotors' own bearings
      return ask(quantity, tree).topRows(6 * (static_cast<Eigen::Index>(links_) - 1));
    if (quantity != Quantity::kQdd) return ask(quantity, tree);
    tree.qdd.assign(rates_.size(), T(0));
    const MatrixX<T> bias = reduced(ask(Quantity::kTau, tree));
    MatrixX<T> M = reducedMatrix(ask(Quantity::kM, tree)), qdd(dof_, 1);
    for (int i = 0; i < dof_; ++i) qdd(i, 0) = state.tau[i] - bias(i, 0);
    recursive::factorize(M);
    Eigen::Ref<Eigen::Matrix<T, Eigen::Dynamic, 1>> b = qdd.col(0);
    recursive::solve(M, b);
    return qdd;
  }

 private:
  struct Share {
    int of;  ///< the independent rate
    bool follows;
    T k;
  };
  using Rate = std::vector<Share>;
  T times(const Share& share, const T& x) const { return share.follows ? T(share.k * x) : x; }

  std::vector<T> expanded(const std::vector<T>& rates) const {
    std::vector<T> all;
    if (rates.empty()) return all;
    for (const Rate& rate : rates_) {
      all.push_back(times(rate[0], rates[rate[0].of]));
      for (std::size_t k = 1; k < rate.size(); ++k) all.back() += times(rate[k], rates[rate[k].of]);
    }
    return all;
  }
  MatrixX<T> reduced(const MatrixX<T>& forces) const {
    MatrixX<T> out = MatrixX<T>::Constant(dof_, forces.cols(), T(0));
    for (std::size_t i = 0; i < rates_.size(); ++i)
      for (const Share& share : rates_[i])
        for (Eigen::Index j = 0; j < forces.cols(); ++j)
          out(share.of, j) += times(share, forces(static_cast<Eigen::Index>(i), j));
    return out;
  }
  MatrixX<T> reducedMatrix(const MatrixX<T>& M) const {
    const MatrixX<T> rows = reduced(M);
    const MatrixX<T> columns = rows.transpose();
    return reduced(columns).transpose();
  }

  int dof_;
  std::size_t links_ = 0, rotors_ = 0;
  std::vector<Rate> rates_;  ///< by rate of the tree
};

/// A witness that is asked about the tree, all joints let go; what it said is put together here.
class OverTree : public PartialWitness {
 public:
  virtual Witness& ofTree() const = 0;
  virtual scene::State<double> onTree(const scene::State<double>& state) const = 0;
};

/// Whether a witness answers for links that have less than no inertia.
enum class Lacking { kRefused, kAnswered };

/// The kind for mechanisms where joints follow others or rotors are geared to several rates as
/// well: its witness is asked about the tree, and bounds pass through Coupling with the answers.
/// Others it makes as it does.
WitnessKind overTree(WitnessKind kind, Lacking lacking = Lacking::kRefused);

}  // namespace dynwitness::crosscheck
