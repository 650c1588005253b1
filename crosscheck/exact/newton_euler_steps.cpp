// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/exact/newton_euler_steps.hpp"

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/scalars/traced.hpp"
#include "recursive/build_model.hpp"
#include "recursive/newton_euler.hpp"
#include "scene/error.hpp"
#include "symbolic/closed_form.hpp"
#include "symbolic/derivation_steps.hpp"
#include "symbolic/numbers.hpp"

namespace dynwitness::crosscheck {
namespace {

/// The scene's numbers by the names that the derivation has for them.
class DerivationNumbers {
 public:
  using Scalar = Traced;
  explicit DerivationNumbers(const scene::Mechanism& mechanism)
      : number_(std::make_shared<symbolic::NodeNumbers>(mechanism, false, &Traced::graph())) {}

  Traced operator()(const scene::Number& n) const { return Traced((*number_)(n).node); }
  scene::CosSin<Traced> angle(const scene::Number& radians) const {
    return traced(number_->angle(radians));
  }
  scene::AxisTurn<Traced> axisTurn(const scene::Vector& axis) const {
    ++*axes_;
    if (const auto along = number_->alongCoordinate(axis); along.coordinate == 2)  // none to turn
      return {{Traced(1), Traced(0)}, {along.reversed ? -Traced(1) : Traced(1), Traced(0)}};
    const auto turn = number_->axisTurn(axis, *axes_);
    return {traced(turn.alpha), traced(turn.beta)};
  }

 private:
  static scene::CosSin<Traced> traced(const scene::CosSin<symbolic::Value>& x) {
    return {Traced(x.c.node), Traced(x.s.node)};
  }
  std::shared_ptr<symbolic::NodeNumbers> number_;
  std::shared_ptr<int> axes_ = std::make_shared<int>(0);
};

/// Writes down what the sweep left in its workspace.
class SweepSteps {
 public:
  using Step = symbolic::Step;
  SweepSteps(symbolic::Equations& e, const recursive::Model<Traced>& model,
             const recursive::Workspace<Traced>& ws, const std::vector<Traced>& tau)
      : e_(e), model_(model), ws_(ws), tau_(tau), algebra_(e) {}

  std::vector<Step> steps() {
    Step velocities{"beside: velocities, outward",
                    "Newton-Euler: of each link i in its own axes, v_i of the joint's origin and "
                    "omega_i, from those of the link before it and the joint's rate.",
                    {},
                    {},
                    true},
        accelerations{"beside: accelerations, outward",
                      "a_i of the joint's origin and alpha_i in the same way; the base accelerates "
                      "against gravity, so that weight is in all forces.",
                      {},
                      {},
                      true},
        forces{"beside: forces, inward",
               "f_i and moment n_i about the joint's origin that pass through joint i: what "
               "accelerates link i, and what its children take.",
               {},
               {},
               true};
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      add("v", i, ws_.v[i].linear, &velocities);
      add("omega", i, ws_.v[i].angular, &velocities);
      add("a", i, ws_.a[i].linear, &accelerations);
      add("alpha", i, ws_.a[i].angular, &accelerations);
      add("f", i, ws_.f[i].force, &forces);
      add("n", i, ws_.f[i].moment, &forces);
    }
    const Step meeting = meet();
    for (Step* step : {&velocities, &accelerations, &forces}) {
      step->check = "the joint forces that they lead to are Lagrange's";
      step->holds = meeting.holds;
      step->is_beside = true;
    }
    return {velocities, accelerations, forces, meeting};
  }

 private:
  void add(const std::string& letter, std::size_t link, const recursive::Vector3<Traced>& vector,
           Step* step) {
    for (int k = 0; k < 3; ++k) {
      const GiNaC::ex x = algebra_.expression(vector[k].node());
      if (algebra_.isZero(x)) continue;
      const std::string name = letter + std::to_string(link + 1) + std::string(1, "xyz"[k]);
      step->equations.push_back(
          {{symbolic::Formula::ofSymbol(name), algebra_.formula(x)}, {}, vector[k].node()});
    }
  }

  /// The part of each joint's force along its axis, and Lagrange's left side.
  Step meet() {
    using symbolic::Input;
    Step step{"where both meet",
              "What passes through joint i along its axis, its rotor and its spring are tau_i: the "
              "same lines, M qdd + c + g, without M having been formed.",
              {},
              "the normal form of the difference from Lagrange's left side is 0 for each joint",
              true};
    symbolic::Graph& graph = e_.graph;
    for (int i = 0; i < e_.dof(); ++i) {
      symbolic::Node lagrange = graph.add(e_.c[i], e_.g[i]);
      for (int j = 0; j < e_.dof(); ++j)
        lagrange =
            graph.add(lagrange, graph.multiply(e_.M[i][j], graph.input(Input::kAcceleration, j)));
      const GiNaC::ex swept = algebra_.expression(tau_[i].node());
      step.holds = step.holds && algebra_.isZero(swept - algebra_.expression(lagrange));
      std::vector<symbolic::Formula> right{symbolic::Formula::ofInput(Input::kForce, i)};
      if (!graph.isZero(e_.Q[i]))
        right.push_back(symbolic::Formula::ofSymbol("Q" + std::to_string(i + 1)));
      step.equations.push_back({{byAccelerations(swept), symbolic::Formula::sum(right)},
                                tau_[i].node(),
                                graph.add(graph.input(Input::kForce, i), e_.Q[i])});
    }
    return step;
  }

  /// A line in the order of an equation of motion: what stands before each qdd, then what is left
  /// without them, then what is left at rest.
  symbolic::Formula byAccelerations(const GiNaC::ex& line) {
    using symbolic::Input;
    GiNaC::exmap no_accelerations, at_rest;
    std::vector<symbolic::Formula> terms;
    for (int j = 0; j < e_.dof(); ++j) {
      const GiNaC::symbol& qdd = algebra_.input(Input::kAcceleration, j);
      no_accelerations[qdd] = at_rest[qdd] = 0;
      at_rest[algebra_.input(Input::kVelocity, j)] = 0;
      if (const GiNaC::ex factor = line.diff(qdd); !algebra_.isZero(factor))
        terms.push_back(symbolic::Formula::product(
            {algebra_.formula(factor), symbolic::Formula::ofInput(Input::kAcceleration, j)}));
    }
    const GiNaC::ex g = line.subs(at_rest), c = line.subs(no_accelerations) - g;
    for (const GiNaC::ex& part : {c, g})
      if (!algebra_.isZero(part)) terms.push_back(algebra_.formula(part));
    return symbolic::flatSum(terms);
  }

  symbolic::Equations& e_;
  const recursive::Model<Traced>& model_;
  const recursive::Workspace<Traced>& ws_;
  const std::vector<Traced>& tau_;
  symbolic::ClosedAlgebra algebra_;
};

}  // namespace

void addNewtonEuler(symbolic::Derivation* derivation) {
  const scene::Mechanism& mechanism = derivation->mechanism;
  if (!symbolic::hasClosedForm(mechanism))
    throw scene::InputError(
        {}, fmt::format("--beside newton_euler of {} joints, allowed: up to {} whose rates are "
                        "derivatives of their positions",
                        mechanism.dof(), symbolic::kClosedFormJoints));
  const auto equations = std::make_shared<symbolic::Equations>(*derivation->equations);
  const Traced::Recording recording(equations->graph);
  const recursive::Model<Traced> model =
      recursive::buildModel(mechanism, DerivationNumbers(mechanism));
  const scene::State<Traced> state = tracedState(mechanism);
  recursive::Workspace<Traced> ws(model);
  std::vector<Traced> tau(static_cast<std::size_t>(mechanism.dof()), Traced(0));
  recursive::inverseDynamics(model, state.x, state.qd, state.qdd, ws, tau,
                             recursive::Terms::potential());
  for (symbolic::Step& step : SweepSteps(*equations, model, ws, tau).steps())
    derivation->steps.push_back(std::move(step));
  derivation->equations = equations;
}

}  // namespace dynwitness::crosscheck
