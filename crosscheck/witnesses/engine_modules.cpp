// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/engine_modules.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <tuple>

#include <dlfcn.h>
#include <fmt/format.h>

#include "crosscheck/system/own_program.hpp"
#include "crosscheck/witnesses/coupled.hpp"
#include "crosscheck/witnesses/engine_bound.hpp"
#include "crosscheck/witnesses/mjcf.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/own_file.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "scene/inertia_need.hpp"
#include "scene/mimic.hpp"
#include "scene/numbers.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {
namespace fs = std::filesystem;
namespace {

/// Of libraries the linker takes what a program calls: this is what modules call beside it, and all
/// that our witnesses do. tests/project/test_engine_modules.py looks whether every program has it.
[[gnu::used]] constexpr auto kKept = std::make_tuple(
    &witnessKinds, &isOwnFile, &mjcf, &overTree,
    static_cast<Eigen::MatrixXd (EngineBound::*)(Quantity, const scene::State<double>&)>(
        &EngineBound::operator()),
    &scene::urdfForEngines, &scene::requireInertiaOfJoints, &scene::isQuarterTurn,
    &scene::firstRates, &scene::followers, &scene::requireNoMimics);

struct Loaded {
  void* object = nullptr;
  const EngineModule* module = nullptr;
  std::string why_not;
};

bool isConfigured(const std::string& engine) {
  return fmt::format(" {} ", DYNWITNESS_ENGINE_MODULES).find(" " + engine + " ") !=
         std::string::npos;
}

Loaded load(const std::string& engine) {
  if (!isConfigured(engine)) return {nullptr, nullptr, kNotFound};
  const fs::path folder = ownProgram().parent_path();
  if (folder.empty()) return {nullptr, nullptr, "the system does not tell where this program is"};
  // programs are in bin/, tests beside it
  const fs::path within = fs::path("lib") / "dynwitness" / ("engine-" + engine + ".so");
  const fs::path places[] = {folder.parent_path() / within, folder / within};
  std::error_code unknown;
  const auto* const file = std::find_if(std::begin(places), std::end(places),
                                        [&](const fs::path& p) { return fs::exists(p, unknown); });
  if (file == std::end(places))
    return {nullptr, nullptr, fmt::format("its module is missing: {}", places[0].string())};
  // lazily: of an engine few functions are called. What is ours is bound at once (-z now)
  void* const object = ::dlopen(file->c_str(), RTLD_LAZY | RTLD_LOCAL | RTLD_NODELETE);
  const auto* const module =
      object == nullptr ? nullptr
                        : static_cast<const EngineModule*>(::dlsym(object, "dynwitness_engine"));
  if (module == nullptr) {
    const char* const why = ::dlerror();
    return {nullptr, nullptr,
            fmt::format("its module does not load: {}", why ? why : file->string())};
  }
  if (std::string(module->version) != DYNWITNESS_VERSION)
    return {nullptr, nullptr,
            fmt::format("its module {} is of dynwitness {}, this is {}", file->string(),
                        module->version, DYNWITNESS_VERSION)};
  return {object, module, ""};
}

std::map<std::string, Loaded> asked_for;
std::mutex guards_asked_for;

const Loaded& loaded(const std::string& engine) {
  const std::lock_guard<std::mutex> lock(guards_asked_for);
  const auto it = asked_for.find(engine);
  return it != asked_for.end() ? it->second : asked_for.emplace(engine, load(engine)).first->second;
}

WitnessKind kindOf(const std::string& engine, const EngineWords& words) {
  if (!isConfigured(engine)) return absentKind(words.name, words.method);
  const Loaded& its = loaded(engine);
  if (its.module != nullptr)
    for (WitnessKind& kind : its.module->kinds())
      if (kind.info.name == words.name) return std::move(kind);
  WitnessInfo info;
  info.name = words.name;
  info.method = words.method;
  return absentKind(std::move(info), its.module == nullptr
                                         ? its.why_not
                                         : fmt::format("its module has no witness {}", words.name));
}

}  // namespace

const EngineModule& engineModule(const std::string& engine) {
  const Loaded& its = loaded(engine);
  if (its.module == nullptr) throw std::runtime_error(its.why_not);
  return *its.module;
}

void* engineSymbol(const std::string& engine, const char* name) {
  void* const object = loaded(engine).object;
  return object == nullptr ? nullptr : ::dlsym(object, name);
}

std::vector<std::string> enginesMissing() {
  std::vector<std::string> missing;
  const std::lock_guard<std::mutex> lock(guards_asked_for);
  for (const auto& [engine, its] : asked_for)
    if (isConfigured(engine) && its.module == nullptr)
      missing.push_back(fmt::format("{}: {}", engine, its.why_not));
  return missing;
}

WitnessKind simbodyKind() {
  return kindOf("simbody", kSimbody);
}
WitnessKind mujocoKind() {
  return kindOf("mujoco", kMujoco);
}
WitnessKind mujocoPrincipalKind() {
  return kindOf("mujoco", kMujocoPrincipal);
}
WitnessKind dartKind() {
  return kindOf("dart", kDart);
}
WitnessKind kdlKind() {
  return kindOf("kdl", kKdl);
}

Eigen::VectorXd simbodyClosedAccelerations(const scene::Scene& scene,
                                           const scene::State<double>& state) {
  return engineModule("simbody").closed_accelerations(scene, state);
}
SimbodyMechanism simbodyMechanism(const PreparedScene& scene) {
  return engineModule("simbody").simbody_mechanism(scene);
}
MujocoMechanism mujocoMechanism(const PreparedScene& scene) {
  return engineModule("mujoco").mujoco_mechanism(scene);
}

}  // namespace dynwitness::crosscheck
