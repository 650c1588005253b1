// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdio>

#include "recursive/build_model.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/rounding_estimate.hpp"
#include "scene/scene.hpp"

using namespace dynwitness;

int main() {
  const scene::Mechanism pendulum = scene::findScene("double pendulum").mechanism;
  const auto model = recursive::buildModel(pendulum, scene::RealNumbers<double>(pendulum));
  recursive::Workspace<double> workspace(model);
  const std::vector<scene::JointPosition<double>> x = {scene::jointPosition(0.3),
                                                       scene::jointPosition(-0.7)};
  const std::vector<double> qd = {1.0, -2.0}, qdd = {0.5, 3.0};  // [rad/s], [rad/s^2]
  std::vector<double> tau(2);                                    // [N m]
  recursive::inverseDynamics(model, x, qd, qdd, workspace, tau);
  recursive::RoundingEstimate<double> rounding(model);  // made once, then asked after each sweep
  const double lost = rounding.inverseDynamics(x, qd, qdd, tau);
  std::printf("tau = %.17g %.17g, of which %.0f digits stand\n", tau[0], tau[1], -std::log10(lost));
}
