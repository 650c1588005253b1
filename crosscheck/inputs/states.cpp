// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/inputs/states.hpp"

#include "scene/mimic.hpp"

namespace dynwitness::crosscheck {
namespace {

std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// A direction in four dimensions, all equally likely, and a length between 1/2 and 1: witnesses
/// must not take a quaternion's length for granted.
void drawQuaternion(RandomStream& random, scene::State<double>* state) {
  double q[4], length2;
  do {
    length2 = 0;
    for (double& component : q) {
      component = random.uniform(-1, 1);
      length2 += component * component;
    }
  } while (length2 < 0.25 || length2 > 1);
  for (const double component : q) state->x.push_back(scene::jointPosition(component));
}

}  // namespace

RandomStream::RandomStream(const std::string& name, std::uint64_t seed, std::uint64_t index) {
  std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a
  for (const char ch : name) hash = (hash ^ static_cast<unsigned char>(ch)) * 0x100000001b3u;
  state_ = mixed(hash ^ mixed(seed ^ mixed(index)));
}

std::uint64_t RandomStream::next() {
  return mixed(state_ += 0x9e3779b97f4a7c15u);
}

double RandomStream::uniform(double low, double high) {
  const double unit = static_cast<double>(next() >> 11) * 0x1p-53;
  return low + (high - low) * unit;
}

scene::State<double> drawState(const scene::Mechanism& mechanism, const std::string& scene_name,
                               std::uint64_t seed, std::uint64_t index) {
  RandomStream random(scene_name, seed, index);
  constexpr double kPi = 3.141592653589793;
  scene::State<double> state;
  for (const int i : mechanism.movingLinks()) {
    const scene::JointKind kind = mechanism.links[i].joint.kind;
    if (mechanism.links[i].joint.mimic) {  // where its leader will put it
      state.x.push_back({});
      continue;
    }
    for (const scene::SlotKind slot : scene::positionSlots(kind)) {
      if (slot == scene::SlotKind::kQuaternion) break;  // they come last
      const double reach = slot == scene::SlotKind::kLength ? 1.0 : kPi;
      state.x.push_back(scene::jointPosition(random.uniform(-reach, reach)));
    }
    if (scene::positionSlots(kind).back() == scene::SlotKind::kQuaternion)
      drawQuaternion(random, &state);
    for (int k = 0; k < scene::degreesOfFreedom(kind); ++k) {
      state.qd.push_back(random.uniform(-3, 3));
      state.qdd.push_back(random.uniform(-10, 10));
      state.tau.push_back(random.uniform(-10, 10));
    }
  }
  scene::followLeaders(mechanism, &state.x);
  return state;
}

}  // namespace dynwitness::crosscheck
