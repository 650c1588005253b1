// SPDX-License-Identifier: GPL-3.0-or-later
// Engines timed by their own calls, as their users make them: no witness around them, no copies of
// answers, no conversions. Charts and benchmarks share this.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::recursive {
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

}  // namespace dynwitness::crosscheck

/// What modules of engines that are called raw define beside the witness (engine_modules.hpp).
extern "C" dynwitness::crosscheck::MakeRawModel* const dynwitness_raw_engine;
