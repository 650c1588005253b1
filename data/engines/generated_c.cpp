// SPDX-License-Identifier: Apache-2.0
// What `dynwitness derive --format c` writes, as a witness, for a scene without joints that follow
// others:
//
//     ./dynwitness derive puma_560 --format c > puma_560.c
//     c++ -std=c++17 -O2 -I data/engines -include puma_560.c -DSCENE=puma_560 -o puma_560
//       data/engines/generated_c.cpp                                       (one line)
//     ./dynwitness crosscheck puma_560 --engine ./puma_560
//
// A controller's own function of the same kind is wrapped in the same way.
#include "dynwitness_engine.hpp"

using namespace dynwitness_engine;

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)
#define JOINED_TO(a, b) a##b
#define JOINED(a, b) JOINED_TO(a, b)

namespace {

struct Terms {
  Vector M, c, g;  // M by rows

  Terms(const State& s) : M(s.qd.size() * s.qd.size()), c(s.qd.size()), g(s.qd.size()) {
    SCENE(s.q.data(), s.qd.data(), JOINED(SCENE, _parameters), M.data(), c.data(), g.data());
  }
};

/// Friction and constant wrenches are in tau, and not in M, c, g.
bool hasForcesOfItsOwn(const Json& scene) {
  for (std::size_t i = 1; i < scene["links"].size(); ++i) {
    const Json& joint = scene["links"][i]["joint"];
    if (joint["viscous"].number() != 0 || joint["coulomb"][0].number() != 0 ||
        joint["coulomb"][1].number() != 0)
      return true;
  }
  return scene["wrenches"].size() > 0;
}

}  // namespace

int main() {
  Engine engine("generated_c");
  engine.scene = [&](const Json& scene) {
    if (scene["name"].text() != TEXT(SCENE))
      throw std::runtime_error("it was generated for " TEXT(SCENE));
    if (hasForcesOfItsOwn(scene)) return;
    engine.vector("tau", [](const State& s) {
      const Terms terms(s);
      Vector tau(s.qd.size());
      for (std::size_t i = 0; i < tau.size(); ++i) {
        tau[i] = terms.c[i] + terms.g[i];
        for (std::size_t j = 0; j < tau.size(); ++j)
          tau[i] += terms.M[i * tau.size() + j] * s.qdd[j];
      }
      return tau;
    });
  };
  engine.matrix("M", [](const State& s) {
    const Terms terms(s);
    Matrix M;
    for (auto row = terms.M.begin(); row != terms.M.end(); row += s.qd.size())
      M.emplace_back(row, row + s.qd.size());
    return M;
  });
  engine.vector("c", [](const State& s) { return Terms(s).c; });
  engine.vector("g", [](const State& s) { return Terms(s).g; });
  return engine.testify();
}
