// SPDX-License-Identifier: GPL-3.0-or-later
// Engines timed by their own calls, as their users make them: no witness around them, no copies of
// answers, no conversions. Charts and benchmarks share this.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::recursive {
template <typename T>
struct Constraints;
template <typename T>
struct Model;
}  // namespace dynwitness::recursive

namespace dynwitness::crosscheck {

/// The same state with floating links at rest and in the world's axes, where their rates are the
/// same in everybody's conventions.
scene::State<double> stateForCheck(const recursive::Model<double>& model,
                                   const scene::State<double>& state);

/** A wrong model would be timed in vain, and differs in the first digits. Later ones are the
    crosscheck's business: MuJoCo loses some when it reads the inertias.
    @throws std::logic_error  which engine, what of it, by how much */
void requireSame(const std::vector<double>& ours, const std::vector<double>& its,
                 const char* engine, const char* quantity);

/// What engines called so hold of a model: no springs, friction and loads.
/// @param with_rotors  on the diagonal of M
recursive::Model<double> bareModel(const recursive::Model<double>& model, bool with_rotors);

/// @param tau  of an engine at stateForCheck(), without rotors, springs and friction
/// @throws std::logic_error  it is not the model's
void requireSameModel(const recursive::Model<double>& model, const scene::State<double>& state,
                      const std::vector<double>& tau, const char* engine);

/// A quantity by an engine's own calls.
struct RawCalls {
  /// From a state, whose positions are also given as numbers, to where the engine keeps the answer.
  std::function<void(const scene::State<double>& state, const std::vector<double>& q)> call;
  std::string words;  ///< which calls, and what the engine leaves out
};

/** How the users of an engine would ask for the quantity, the engine having been found to hold the
    same model; none for witnesses whose engine is not called so here.
    @param model  of the scene
    @param state  at which the models are compared
    @throws std::exception  why the engine cannot hold the scene without its witness */
std::optional<RawCalls> rawCalls(const std::string& witness, const scene::Scene& scene,
                                 const recursive::Model<double>& model, Quantity quantity,
                                 const scene::State<double>& state);

/// The part of rawCalls() that is built with MuJoCo; none where there is no MuJoCo.
std::optional<RawCalls> rawMujocoCalls(const scene::Scene& scene,
                                       const recursive::Model<double>& model, Quantity quantity,
                                       const scene::State<double>& state);

/** An engine that moves a scene by steps of its own, as its users call them: no contacts, limits,
    springs, friction and loads. */
class RawSteps {
 public:
  virtual ~RawSteps() = default;
  /// From a state on; its tau is kept meanwhile.
  virtual void start(const scene::State<double>& state) = 0;
  virtual void step() = 0;
  // now, in the order of the model: numbers a slot, and a degree of freedom
  virtual std::vector<double> positions() const = 0;
  virtual std::vector<double> rates() const = 0;

 protected:
  RawSteps() = default;
  RawSteps(const RawSteps&) = default;
  RawSteps& operator=(const RawSteps&) = default;
};

/// How an engine steps, and how long a step is [s].
struct RawStep {
  bool is_runge_kutta = false;  ///< the classical one of order 4; else semi-implicit Euler
  double h = 0;
};

/// By mj_step; closures are equality constraints, which give way a little. Rotors are there. Null
/// where there is no MuJoCo.
std::unique_ptr<RawSteps> rawMujocoSteps(const scene::Scene& scene, const RawStep& step);

/** By SemiExplicitEulerIntegrator, without rotors.
    @param closures  of the model
    @throws std::invalid_argument  a joint, a closure or a method that is not there */
std::unique_ptr<RawSteps> rawSimbodySteps(const recursive::Model<double>& model,
                                          const recursive::Constraints<double>& closures,
                                          const RawStep& step);

/** As World::step does where nothing touches, without rotors. Null where there is no DART.
    @throws std::invalid_argument  a joint or a method that is not there */
std::unique_ptr<RawSteps> rawDartSteps(const recursive::Model<double>& model, const RawStep& step);

}  // namespace dynwitness::crosscheck
