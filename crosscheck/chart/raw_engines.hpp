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

/// An engine's model of a scene, and what it is compared by.
struct RawModel {
  RawCalls calls;
  std::vector<double> tau;  ///< at the state that it was made with
};
/// @param check  a state of stateForCheck()
using MakeRawModel = RawModel(const scene::Scene& scene, const recursive::Model<double>& model,
                              Quantity quantity, const scene::State<double>& check);

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

/// What steps are made of. @param model, closures  of the scene
using MakeRawSteps = std::unique_ptr<RawSteps>(const scene::Scene& scene,
                                               const recursive::Model<double>& model,
                                               const recursive::Constraints<double>& closures,
                                               const RawStep& step);

/// What a module of an engine that is called raw has for it; null: nothing of the kind.
struct RawEngine {
  MakeRawModel* model;
  MakeRawSteps* steps;
};

/** An engine's steps; null: there is no such engine here.
      mujoco   mj_step, of the scene; closures are equality constraints, which give way a little
      simbody  SemiExplicitEulerIntegrator, of the model
      dart     as World::step does where nothing touches, of the model, without closures
    @param model  bareModel(); Simbody and DART take no rotors from it
    @throws std::invalid_argument  a joint, a closure or a method that is not there */
std::unique_ptr<RawSteps> rawSteps(const std::string& engine, const scene::Scene& scene,
                                   const recursive::Model<double>& model,
                                   const recursive::Constraints<double>& closures,
                                   const RawStep& step);

}  // namespace dynwitness::crosscheck

/// What modules of engines that are called raw define beside the witness (engine_modules.hpp).
extern "C" const dynwitness::crosscheck::RawEngine dynwitness_raw_engine;
