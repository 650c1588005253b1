// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

#include "recursive/build_model.hpp"
#include "recursive/newton_euler.hpp"
#include "scene/scene.hpp"

using namespace dynwitness;

int main() {
  const scene::Mechanism pendulum = scene::findScene("double pendulum").mechanism;
  const auto model = recursive::buildModel(pendulum, scene::RealNumbers<double>(pendulum));
  recursive::Workspace<double> workspace(model);
  const std::vector<double> qd = {1.0, -2.0}, qdd = {0.5, 3.0};  // [rad/s], [rad/s^2]
  std::vector<double> tau(2);                                    // [N m]
  recursive::inverseDynamics(model, {scene::jointPosition(0.3), scene::jointPosition(-0.7)}, qd,
                             qdd, workspace, tau);
  std::printf("tau = %.17g %.17g\n", tau[0], tau[1]);
}
