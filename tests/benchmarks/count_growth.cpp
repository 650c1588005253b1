// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a chain or a tree of so many links and asks it once, for a tool that counts instructions.
//     count_growth FAMILY LINKS
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "recursive/build_model.hpp"
#include "recursive/fast/dynamics.hpp"
#include "scene/families.hpp"

using namespace dynwitness;

// not inlined and named in C: these are what is counted, with all that they call
extern "C" {
[[gnu::noinline]] void growth_scene(const char* name, scene::Scene* scene) {
  if (!scene::findFamily(name, scene)) std::exit(2);
}
[[gnu::noinline]] recursive::fast::Dynamics* growth_model(const scene::Mechanism& mechanism) {
  return new recursive::fast::Dynamics(
      recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism)));
}
[[gnu::noinline]] void growth_ID(recursive::fast::Dynamics& sweeps, const double* q, double* out) {
  sweeps.inverseDynamics(q, q, q, out);
}
[[gnu::noinline]] void growth_FD(recursive::fast::Dynamics& sweeps, const double* q, double* out) {
  sweeps.forwardDynamics(q, q, q, out);
}
}

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  scene::Scene scene;
  growth_scene((std::string(argv[1]) + "_" + argv[2]).c_str(), &scene);
  recursive::fast::Dynamics* const sweeps = growth_model(scene.mechanism);
  std::vector<double> q(sweeps->plan().positions), out(q.size());
  for (std::size_t i = 0; i < q.size(); ++i) q[i] = 0.3 + 0.001 * static_cast<double>(i % 1000);
  growth_ID(*sweeps, q.data(), out.data());
  growth_FD(*sweeps, q.data(), out.data());
  std::printf("%g\n", out[0]);
  delete sweeps;
}
