// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/motion.hpp"

#include <algorithm>

namespace dynwitness::scene {

void validateMotions(const Scene& scene) {
  const Mechanism& mechanism = scene.mechanism;
  const RealNumbers<double> number(mechanism);
  const ParameterValues values = mechanism.parameterValues();
  for (const Link& link : mechanism.links) {
    const std::string what =
        "joint \"" + link.joint.name + "\" of link \"" + link.name + "\": motion";
    if (!link.joint.motion.empty() && values.count("t") > 0)
      throw InputError(link.where,
                       what +
                           ": t is the time, and a parameter has the same name, allowed: "
                           "any other name for the parameter");
    for (const Expression& f : link.joint.motion) {
      bool is_finite = false;
      try {
        const Jet<double> start = motionAt(f, number, 0.0);
        is_finite =
            std::isfinite(start.value) && std::isfinite(start.rate) && std::isfinite(start.second);
      } catch (const std::domain_error& error) {
        throw InputError(link.where, what + ": " + error.what() + " at t = 0");
      }
      if (!is_finite)
        throw InputError(link.where,
                         what + ": \"" + f.text() + "\" or its rates are not finite at t = 0");
    }
  }
  for (const AccelerationConstraint& held : mechanism.acceleration_constraints) {
    const std::string what = "acceleration_constraint \"" + held.name + '"';
    if (held.link <= 0 || held.link >= static_cast<int>(mechanism.links.size()))
      throw InputError(held.where, what + ": the root rests in the world, allowed: any other link");
    const auto isZero = [&](const Vector& v) {
      return std::all_of(v.begin(), v.end(), [&](const Number& n) {
        return exactValue(n, values, held.where).isZero();
      });
    };
    if (isZero(held.direction) && isZero(held.rotation))
      throw InputError(held.where,
                       what + ": direction and rotation are zero, allowed: one that is not");
    if (exactValue(held.compliance, values, held.where).toDouble() < 0)
      throw InputError(held.where, what + ": compliance is " + held.compliance.text() +
                                       ", allowed: zero or more");
  }
}

}  // namespace dynwitness::scene
