// SPDX-License-Identifier: GPL-3.0-or-later
// Constrained robots over the prime field.
#include "crosscheck/audit/constraints.hpp"

namespace dynwitness::audit {

void compareOutward(Point& at, const Robot<T>& robot, const LinkConstraint<T>& held,
                    Printed printed) {
  const Constrained<T> truth = denseConstrained<T>(robot, {held});
  const SixVectors<T> six(robot);
  const CarriedInward<T> inward = carriedInward(six, held);
  const std::vector<Vector6<T>> F = six.biasForces();
  const VectorX<T> nu = -truth.nu;  // the chapter's: on the environment
  Vector6<T> a_p = six.gravityAtBase();
  for (int i = 0; i < six.n(); ++i) {
    const Vector6<T> handed_on = six.X[i] * a_p;
    const Vector6<T> a = handed_on + six.c[i] + six.Z[i] * truth.qdd[i];
    const Vector6<T> taken =
        printed == Printed::kYes ? Vector6<T>(a - handed_on) : Vector6<T>(handed_on + six.c[i]);
    const Vector6<T> F_all = F[i] + six.M_A[i] * taken + inward.E[i] * nu;
    at.equal("qdd", T((robot.tau[i] - six.Z[i].dot(F_all)) / six.D[i]), truth.qdd[i]);
    a_p = a;
  }
}

template VectorX<T> constrainedAcceleration(const Robot<T>&, const LinkConstraint<T>&,
                                            const std::vector<T>&);
template Constrained<T> denseConstrained(const Robot<T>&, const std::vector<LinkConstraint<T>>&);
template struct Swept<T>;
template MatrixX<T> sweptConsistentInverse(const Robot<T>&, const LinkConstraint<T>&);
template MatrixX<T> responseToBase(Robot<T>, const LinkConstraint<T>&);
template CarriedInward<T> carriedInward(const SixVectors<T>&, const LinkConstraint<T>&,
                                        const std::vector<Vector6<T>>&, bool, int);

}  // namespace dynwitness::audit
