// SPDX-License-Identifier: GPL-3.0-or-later
// The witnesses of engines by others, each in a shared object of its own that is loaded when it is
// first asked for: most commands ask none, and loading the engines' libraries takes longer than
// most commands do. A module calls the floors below as they are in the program, so that nothing is
// there twice.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/witnesses/mechanism_roads.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

/// What is said of a witness that may be absent.
struct EngineWords {
  const char *name, *method;
};
inline constexpr EngineWords kSimbody{"simbody", "Simbody; rotors as bodies of their own"};
inline constexpr EngineWords kMujoco{
    "mujoco", "MuJoCo reads URDF or MJCF; M by composite bodies in world axes, qdd from M = L'DL"};
inline constexpr EngineWords kMujocoPrincipal{
    "mujoco_principal", "MuJoCo, the inertias turned into their principal axes before"};
inline constexpr EngineWords kDart{
    "dart",
    "DART reads the URDF, and gets its own free, ball, ... joints; articulated bodies in link "
    "axes; rotors as bodies of their own"};
inline constexpr EngineWords kKdl{
    "kdl",
    "Orocos KDL: recursive Newton-Euler over the tree; on chains M by composite bodies, qdd by its "
    "chain solver"};

/// What a module is asked for; null: nothing of the kind.
struct EngineModule {
  const char* version;  ///< of dynwitness; first, so that it can be read whatever follows
  std::vector<WitnessKind> (*kinds)();
  SimbodyMechanism (*simbody_mechanism)(const PreparedScene&);
  Eigen::VectorXd (*closed_accelerations)(const scene::Scene&, const scene::State<double>&);
  MujocoMechanism (*mujoco_mechanism)(const PreparedScene&);
};

/// The module of an engine ("simbody", "mujoco", "dart", "kdl"), which stays loaded.
/// @throws std::runtime_error  why there is none: the witness's reason
const EngineModule& engineModule(const std::string& engine);

/// What the module of an engine has under that name beside it, for floors above this one; null:
/// nothing, or there is no such module.
void* engineSymbol(const std::string& engine, const char* name);

/// Why engines that dynwitness was built with, and that were asked for, could not be loaded: a line
/// each. Loads none.
std::vector<std::string> enginesMissing();

}  // namespace dynwitness::crosscheck

/// What every module defines under this name.
extern "C" const dynwitness::crosscheck::EngineModule dynwitness_engine;
