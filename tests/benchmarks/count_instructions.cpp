// SPDX-License-Identifier: GPL-3.0-or-later
// Calls the fast sweeps of both compilers as often as it is told, for a tool that counts
// instructions.
//     count_instructions CALLS SCENE...     prints the compilers' names, one a line
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "recursive/build_model.hpp"
#include "scene/families.hpp"
#include "scene/scene.hpp"
#include "tests/benchmarks/fast_by_compiler.hpp"

using namespace dynwitness;

int main(int argc, char** argv) {
  std::vector<const benchmarks::FastBy*> compilers = {&benchmarks::kFastByOwn};
#ifdef DYNWITNESS_SECOND_COMPILER
  compilers.push_back(&benchmarks::kFastBySecond);
#endif
  for (const benchmarks::FastBy* by : compilers) std::printf("%s\n", by->compiler());
  const int calls = argc > 1 ? std::atoi(argv[1]) : 0;
  for (int a = 2; a < argc; ++a) {
    scene::Scene scene;
    if (!scene::findFamily(argv[a], &scene)) scene = scene::findScene(argv[a]);
    const auto model =
        recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
    const int n = model.dof();
    std::vector<double> q(model.positions), qd(n), w(n), out(n), M(static_cast<std::size_t>(n) * n),
        three(3 * M.size());
    for (const benchmarks::FastBy* by : compilers) {
      void* const sweeps = by->make(&model);
      void* const derivatives = by->makeDerivatives(&model);
      for (int call = 0; call < calls; ++call) {
        for (std::size_t i = 0; i < q.size(); ++i)
          q[i] = 0.3 + 0.1 * static_cast<double>(i) + 0.01 * call;
        for (int i = 0; i < n; ++i) qd[i] = 0.7 - 0.2 * i, w[i] = 1.1 + 0.3 * i;
        by->inverseDynamics(sweeps, q.data(), qd.data(), w.data(), out.data());
        by->massMatrix(sweeps, q.data(), M.data());
        by->forwardDynamics(sweeps, q.data(), qd.data(), w.data(), out.data());
        by->ofForces(derivatives, q.data(), qd.data(), w.data(), three.data());
        by->ofAccelerations(derivatives, q.data(), qd.data(), w.data(), three.data());
      }
      by->release(sweeps);
      by->releaseDerivatives(derivatives);
    }
  }
}
