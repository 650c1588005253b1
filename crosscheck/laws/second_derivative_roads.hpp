// SPDX-License-Identifier: GPL-3.0-or-later
// The second derivatives of a tree's equations of motion by three roads that share no formula of
// differentiation, along two directions.
#pragma once

#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "crosscheck/laws/law.hpp"
#include "crosscheck/laws/second_derivative_pairs.hpp"
#include "crosscheck/scalars/lifted.hpp"
#include "crosscheck/scalars/moving_state.hpp"
#include "crosscheck/witnesses/lagrange_derivatives.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/factorization.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/second_derivatives.hpp"

namespace dynwitness::crosscheck {

/** One mechanism in the arithmetic of T, moved from state to state; each road is gone once a state.

    The directions are u, the state's tau, which has no part in its motion, and w_k = u_k^2: of a
    cube of wrong entries E the sums over j, k of E_ijk w_j u_k are polynomials in u in which every
    entry has a monomial u_j^2 u_k of its own. */
template <typename T>
class SecondDerivativeRoads {
 public:
  using Once = Dual<T>;
  using Twice = Dual<Once>;

  /// @param programs  must outlive it
  template <typename Numbers>
  SecondDerivativeRoads(const scene::Mechanism& mechanism, const LagrangeDerivatives& programs,
                        const Numbers& number)
      : model_(recursive::buildModel(mechanism, number)),
        once_(lifted<Once>(model_)),
        twice_(lifted<Twice>(once_)),
        ws_(model_),
        ws_twice_(twice_),
        lagrange_(programs, DualNumbers<Numbers>(number)) {}

  SecondDerivativeRoads& at(scene::State<T> state) {
    state_ = std::move(state);
    u_ = state_.tau;
    w_.clear();
    for (const T& u : u_) w_.push_back(u * u);
    state_.tau.assign(u_.size(), T(0));
    recursive::inverseDynamics(model_, state_.x, state_.qd, state_.qdd, ws_, state_.tau);
    said_.clear();
    solvers_.clear();
    sweep_.reset();
    return *this;
  }
  TwoSides<T> sides(const SecondPair& pair) {
    const Said &left = hear(pair.quantity, pair.left), &right = hear(pair.quantity, pair.right);
    const std::string& failure = left.failure.empty() ? right.failure : left.failure;
    if (!failure.empty()) return {{}, {}, failure};
    return {left.value, right.value};
  }

 private:
  struct Said {
    MatrixX<T> value;
    std::string failure = {};
  };
  /// Of a state's four parts, one.
  enum class Part { kQ, kQd, kQdd, kTau };
  struct Parts {
    Part first, second;
  };
  static Parts partsOf(SecondDerivative quantity) {
    switch (quantity) {
      case SecondDerivative::kTauByQQ:
      case SecondDerivative::kQddByQQ:
        return {Part::kQ, Part::kQ};
      case SecondDerivative::kTauByQQd:
      case SecondDerivative::kQddByQQd:
        return {Part::kQ, Part::kQd};
      case SecondDerivative::kTauByQdQd:
      case SecondDerivative::kQddByQdQd:
        return {Part::kQd, Part::kQd};
      case SecondDerivative::kTauByQQdd:
        return {Part::kQ, Part::kQdd};
      case SecondDerivative::kQddByQTau:
        return {Part::kQ, Part::kTau};
    }
    return {};
  }
  template <typename S>
  static Direction<S> along(Part part, const std::vector<S>& direction) {
    Direction<S> out;
    (part == Part::kQ     ? out.q
     : part == Part::kQd  ? out.qd
     : part == Part::kQdd ? out.qdd
                          : out.tau) = direction;
    return out;
  }

  const Said& hear(SecondDerivative quantity, SecondRoad road) {
    const auto it = said_.find({quantity, road});
    if (it != said_.end()) return it->second;
    Said said;
    try {
      said.value = road == SecondRoad::kLagrange      ? byLagrange(quantity)
                   : road == SecondRoad::kDualNumbers ? byDuals(quantity)
                                                      : bySweep(quantity);
    } catch (const std::domain_error& error) {
      said.failure = error.what();
    }
    return said_[{quantity, road}] = std::move(said);
  }

  static MatrixX<T> derivativeOf(const MatrixX<Once>& m) {
    return m.unaryExpr([](const Once& x) { return x.derivative; });
  }
  /// (dtau/d part) direction, by Lagrange's derivatives at a moving state.
  MatrixX<Once> columnAlong(scene::State<Once> moved, Part part, const std::vector<T>& direction) {
    moved.tau.assign(direction.begin(), direction.end());
    return lagrange_.ofForces(moved).col(static_cast<int>(part));
  }
  /// A state that moves along w by one part, with M there, by L and D; qdd moves as well, by what
  /// M x = -(dtau/d part) w says.
  struct Solver {
    scene::State<Once> moved;
    MatrixX<Once> LDL;
    MatrixX<Once> solved(MatrixX<Once> b) const {
      Eigen::Ref<Eigen::Matrix<Once, Eigen::Dynamic, 1>> column = b.col(0);
      recursive::solve(LDL, column);
      return b;
    }
  };
  const Solver& solverAlong(Part part) {
    const auto it = solvers_.find(part);
    if (it != solvers_.end()) return it->second;
    Solver solver{moving(model_, state_, along(part, w_)), {}};
    solver.LDL = lagrange_.M(solver.moved);
    recursive::factorize(solver.LDL);
    const MatrixX<Once> rate = solver.solved(-columnAlong(solver.moved, part, w_));
    for (std::size_t i = 0; i < solver.moved.qdd.size(); ++i)
      solver.moved.qdd[i].derivative = rate(static_cast<Eigen::Index>(i), 0).value;
    return solvers_.emplace(part, std::move(solver)).first->second;
  }
  /// What its first derivatives say along u, as the state moves along w. Those of qdd solve M x =
  /// -(dtau/dy) u, or u.
  MatrixX<T> byLagrange(SecondDerivative quantity) {
    const Parts parts = partsOf(quantity);
    if (isOfForces(quantity))
      return derivativeOf(
          columnAlong(moving(model_, state_, along(parts.first, w_)), parts.second, u_));
    const Solver& solver = solverAlong(parts.first);
    if (parts.second != Part::kTau)
      return derivativeOf(solver.solved(-columnAlong(solver.moved, parts.second, u_)));
    return derivativeOf(solver.solved(
        Eigen::Map<const MatrixX<T>>(u_.data(), model_.dof(), 1).unaryExpr([](const T& x) {
          return Once(x);
        })));
  }
  MatrixX<T> byDuals(SecondDerivative quantity) {
    const Parts parts = partsOf(quantity);
    const scene::State<Once> once = moving(model_, state_, along(parts.first, w_));
    const scene::State<Twice> at =
        moving(once_, once, along(parts.second, std::vector<Once>(u_.begin(), u_.end())));
    std::vector<Twice> out(u_.size(), Twice(T(0)));
    if (isOfForces(quantity))
      recursive::inverseDynamics(twice_, at.x, at.qd, at.qdd, ws_twice_, out);
    else
      recursive::forwardDynamics(twice_, at.x, at.qd, at.tau, ws_twice_, out);
    MatrixX<T> column(out.size(), 1);
    for (std::size_t i = 0; i < out.size(); ++i)
      column(static_cast<Eigen::Index>(i), 0) = out[i].derivative.derivative;
    return column;
  }
  /// What the sweep has said of a state: n^3 numbers a quantity, made where it is asked.
  struct Sweep {
    explicit Sweep(const recursive::Model<T>& model) : room(model), of_tau(model) {}
    recursive::SecondDerivativesWorkspace<T> room;
    recursive::InverseDynamicsSecondDerivatives<T> of_tau;
    std::optional<recursive::ForwardDynamicsSecondDerivatives<T>> of_qdd;
  };
  const recursive::Cube<T>& sweptCube(SecondDerivative quantity) {
    const bool of_forces = isOfForces(quantity);
    if (!sweep_ || !(of_forces || sweep_->of_qdd)) {
      Sweep sweep(model_);
      if (of_forces)
        recursive::inverseDynamicsSecondDerivatives(model_, state_.x, state_.qd, state_.qdd,
                                                    sweep.room, sweep.of_tau);
      else
        recursive::forwardDynamicsSecondDerivatives(model_, state_.x, state_.qd, state_.qdd,
                                                    sweep.room, sweep.of_tau,
                                                    sweep.of_qdd.emplace(model_));
      sweep_ = std::move(sweep);
    }
    const auto k = static_cast<std::size_t>(quantity);
    return of_forces ? *sweep_->of_tau.all()[k]
                     : *sweep_->of_qdd->all()[k - sweep_->of_tau.all().size()];
  }
  MatrixX<T> bySweep(SecondDerivative quantity) {
    const recursive::Cube<T>& cube = sweptCube(quantity);
    const MatrixX<T> u = Eigen::Map<const MatrixX<T>>(u_.data(), model_.dof(), 1);
    MatrixX<T> sum = MatrixX<T>::Constant(model_.dof(), 1, T(0));
    for (int j = 0; j < model_.dof(); ++j)
      sum += MatrixX<T>(cube.slab(j) * u) * w_[static_cast<std::size_t>(j)];
    return sum;
  }

  recursive::Model<T> model_;
  recursive::Model<Once> once_;
  recursive::Model<Twice> twice_;
  recursive::Workspace<T> ws_;
  recursive::Workspace<Twice> ws_twice_;
  LagrangeDerivativesRun<Once> lagrange_;
  scene::State<T> state_;
  std::vector<T> u_, w_;
  std::map<Part, Solver> solvers_;
  std::optional<Sweep> sweep_;
  std::map<std::pair<SecondDerivative, SecondRoad>, Said> said_;
};

}  // namespace dynwitness::crosscheck
