// SPDX-License-Identifier: GPL-3.0-or-later
// Constraints on link accelerations and the task's view of a mechanism, over the rationals.
#include "recursive/constrained_dynamics.hpp"
#include "recursive/factorization.hpp"

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/scalars/dual.hpp"
#include "recursive/build_model.hpp"
#include "recursive/energy.hpp"
#include "recursive/factorization.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/operational_space.hpp"
#include "tests/fixtures/compiled_sweeps.hpp"
#include "tests/fixtures/fixtures.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::recursive;
using fixtures::mismatch;
using fixtures::Q;

namespace {

constexpr int kSeeds = 5, kJoints = 5, kLines = 3;
using MatrixQ = MatrixX<Q>;
using VectorQ = Eigen::Matrix<Q, Eigen::Dynamic, 1>;
using D = crosscheck::Dual<Q>;
using DD = crosscheck::Dual<D>;

VectorQ column(const std::vector<Q>& v) {
  return Eigen::Map<const VectorQ>(v.data(), static_cast<Eigen::Index>(v.size()));
}

/// A point of a link that is held (or driven) along a direction of the world.
struct Line {
  int link;
  Vector3<Q> at, direction;
  Q acceleration;
};

/** A random branching tree with springs, rotors, loads and gravity, and three independent lines on
   its links. The points' places, and by (nested) dual numbers their velocities and accelerations,
   come from composing 3-D positions: no spatial vector and no Jacobian. */
class Case {
 public:
  explicit Case(int seed)
      : tree(fixtures::randomTree(kJoints, static_cast<std::uint64_t>(seed))),
        state(fixtures::randomState(kJoints, static_cast<std::uint64_t>(seed))),
        numbers(tree.mechanism),
        model(buildModel(tree.mechanism, numbers)),
        ws(model),
        cws(model, kLines) {
    fixtures::Sampler sample(static_cast<std::uint64_t>(seed) + 77u);
    while (lines.size() < std::size_t(kLines)) {
      lines.push_back({model.link_of_dof[sample.pick(kJoints)], sample.vector(), sample.vector(),
                       sample.rational() * 3});
      if (isDependent(jacobian()))
        lines.pop_back();  // redundant: a link near the base moves little
    }
  }
  /// Whether J J' has a pivot that is zero (J J' is positive semidefinite, so the others are not).
  static bool isDependent(const MatrixQ& J) {
    MatrixQ gram = J * J.transpose();
    for (Eigen::Index j = 0; j < gram.rows(); ++j) {
      if (gram(j, j) == 0) return true;
      for (Eigen::Index i = j + 1; i < gram.rows(); ++i) {
        const Q factor = gram(i, j) / gram(j, j);
        gram.row(i) -= gram.row(j) * factor;
      }
    }
    return false;
  }

  /// Where a line's point is along it, for motions in any scalar.
  template <typename T, typename Numbers>
  T along(const Line& line, const Numbers& number,
          const std::vector<scene::JointPosition<T>>& x) const {
    const Model<T> lifted = buildModel(tree.mechanism, number);
    Vector3<T> place = line.at.template cast<T>();
    for (int i = line.link; i >= 0; i = lifted.links[i].parent) {
      const Transform<T> X = AnyJoints::transform(lifted.links[i], x);
      place = (X.p + X.R.transpose() * place).eval();
    }
    return place.dot(line.direction.template cast<T>());
  }
  Q velocity(const Line& line, const std::vector<Q>& qd) const {
    std::vector<scene::JointPosition<D>> x;
    for (int i = 0; i < kJoints; ++i) x.push_back(crosscheck::moving(state.x[i], qd[i]));
    return along(line, crosscheck::DualNumbers(numbers), x).derivative;
  }
  Q acceleration(const Line& line, const std::vector<Q>& qdd) const {
    std::vector<scene::JointPosition<DD>> x;
    for (int i = 0; i < kJoints; ++i)
      x.push_back(
          crosscheck::moving(crosscheck::moving(state.x[i], state.qd[i]), D(state.qd[i], qdd[i])));
    const crosscheck::DualNumbers once(numbers);
    return along(line, crosscheck::DualNumbers<decltype(once)>(once), x).derivative.derivative;
  }
  /// One row a line.
  MatrixQ jacobian() const {
    MatrixQ J(lines.size(), kJoints);
    for (int j = 0; j < kJoints; ++j) {
      std::vector<Q> unit(kJoints, Q(0));
      unit[j] = 1;
      for (std::size_t k = 0; k < lines.size(); ++k) J(k, j) = velocity(lines[k], unit);
    }
    return J;
  }
  /// The same lines in the words of the header under test.
  std::vector<LinkConstraint<Q>> constraints() {
    linkVelocities(model, state.x, state.qd, ws);
    std::vector<LinkConstraint<Q>> out;
    for (const Line& line : lines) {
      Matrix3<Q> R = ws.X_up[line.link].R;  // world axes to link axes
      for (int i = model.links[line.link].parent; i >= 0; i = model.links[i].parent)
        R = (R * ws.X_up[i].R).eval();
      const Vector3<Q> u = R * line.direction;
      const Motion<Q>& v = ws.v[line.link];
      const Vector3<Q> v_point = v.linear + v.angular.cross(line.at);
      LinkConstraint<Q> c;
      c.link = line.link;
      c.A = Force<Q>{u, line.at.cross(u)}.vector();
      c.b = VectorQ::Constant(1, line.acceleration - u.dot(v.angular.cross(v_point)));
      out.push_back(c);
    }
    return out;
  }
  VectorQ jointForces(const std::vector<Q>& qdd) {
    std::vector<Q> tau(kJoints, Q(0));
    inverseDynamics(model, state.x, state.qd, qdd, ws, tau);
    return column(tau);
  }

  fixtures::Tree tree;
  scene::State<Q> state;
  fixtures::RationalNumbers numbers;
  Model<Q> model;
  Workspace<Q> ws;
  ConstraintWorkspace<Q> cws;
  std::vector<Line> lines;
};

}  // namespace

namespace Eigen::internal {
template <>
struct cast_impl<Q, DD> {
  static DD run(const Q& x) { return DD(D(x)); }
};
}  // namespace Eigen::internal

BOOST_AUTO_TEST_SUITE(identities)

// The two equations that define the answer, each by another road: accelerations of points by nested
// dual numbers, forces by Newton-Euler, the Jacobian by dual numbers.
BOOST_DATA_TEST_CASE(constrained_motion_obeys_constraints_and_ideal_forces_make_it,
                     data::xrange(kSeeds), seed) {
  Case c(seed);
  std::vector<Q> qdd(kJoints, Q(0));
  constrainedForwardDynamics(c.model, c.state.x, c.state.qd, c.state.tau, c.constraints(), c.ws,
                             c.cws, qdd);
  for (const Line& line : c.lines) BOOST_TEST(c.acceleration(line, qdd) == line.acceleration);
  const VectorQ nu = c.cws.nu;
  BOOST_TEST(mismatch(c.jointForces(qdd) - column(c.state.tau), c.jacobian().transpose() * nu) ==
             "");
  BOOST_TEST(!nu.isZero(0));
}

BOOST_DATA_TEST_CASE(gravity_left_out_is_left_out_of_the_constraints_too, data::xrange(kSeeds),
                     seed) {
  Case c(seed);
  std::vector<Q> qdd(kJoints, Q(0));
  Terms terms;
  terms.gravity = false;
  constrainedForwardDynamics(c.model, c.state.x, c.state.qd, c.state.tau, c.constraints(), c.ws,
                             c.cws, qdd, terms);
  for (const Line& line : c.lines) BOOST_TEST(c.acceleration(line, qdd) == line.acceleration);
}

// N against the dense J M^-1 J', solved with M by its factorization.
BOOST_DATA_TEST_CASE(constraint_matrix_is_the_dense_one, data::xrange(kSeeds), seed) {
  Case c(seed);
  std::vector<Q> qdd(kJoints, Q(0));
  forwardDynamics(c.model, c.state.x, c.state.qd, c.state.tau, c.ws, qdd);
  propagateConstraints(c.model, c.constraints(), c.ws, c.cws);
  forwardDynamics(c.model, c.state.x, c.state.qd, c.state.tau, c.ws, qdd);
  MatrixQ M(kJoints, kJoints);
  massMatrix(c.model, c.state.x, c.ws, M);
  factorize(M);
  const MatrixQ J = c.jacobian();
  MatrixQ M_inverse_Jt = J.transpose();
  for (Eigen::Index k = 0; k < J.rows(); ++k) {
    VectorQ column = M_inverse_Jt.col(k);
    solve(M, column);
    M_inverse_Jt.col(k) = column;
  }
  BOOST_TEST(mismatch(c.cws.N, J * M_inverse_Jt) == "");
}

BOOST_DATA_TEST_CASE(task_jacobian_is_that_of_the_points, data::xrange(kSeeds), seed) {
  Case c(seed);
  MatrixQ J(kLines, kJoints);
  const auto tasks = c.constraints();
  taskJacobian(c.model, tasks, c.ws, J);
  BOOST_TEST(mismatch(J, c.jacobian()) == "");
}

// Both properties that single the inverse out, without forming it densely.
BOOST_DATA_TEST_CASE(dynamically_consistent_inverse_is_a_right_inverse_weighted_by_M,
                     data::xrange(kSeeds), seed) {
  Case c(seed);
  std::vector<Q> qdd(kJoints, Q(0));
  forwardDynamics(c.model, c.state.x, c.state.qd, c.state.tau, c.ws, qdd);
  const auto tasks = c.constraints();
  forwardDynamics(c.model, c.state.x, c.state.qd, c.state.tau, c.ws, qdd);
  propagateConstraints(c.model, tasks, c.ws, c.cws);
  MatrixQ Jbar(kJoints, kLines), M(kJoints, kJoints);
  dynamicallyConsistentInverse(c.model, c.ws, c.cws, Jbar);
  massMatrix(c.model, c.state.x, c.ws, M);
  const MatrixQ J = c.jacobian();
  BOOST_TEST(mismatch(J * Jbar, MatrixQ::Identity(kLines, kLines)) == "");
  // M Jbar has its columns in the row space of J:  M Jbar = J' (Jbar' M Jbar)
  BOOST_TEST(mismatch(M * Jbar, J.transpose() * (Jbar.transpose() * M * Jbar)) == "");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(constraints_that_do_not_fit_are_refused) {
  Case c(1);
  std::vector<Q> qdd(kJoints, Q(0));
  forwardDynamics(c.model, c.state.x, c.state.qd, c.state.tau, c.ws, qdd);
  const auto message = [&](const std::vector<LinkConstraint<Q>>& constraints) -> std::string {
    try {
      propagateConstraints(c.model, constraints, c.ws, c.cws);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  auto constraints = c.constraints();
  constraints[2].link = 99;
  BOOST_TEST(message(constraints) == "propagateConstraints: link: expected 0 to 4, got 99");
  constraints = c.constraints();
  constraints[1].b = VectorQ::Constant(2, Q(0));
  BOOST_TEST(message(constraints) ==
             "propagateConstraints: b: expected 1 values, one a column of A, got 2");
  constraints = c.constraints();
  constraints.pop_back();
  BOOST_TEST(message(constraints) ==
             "propagateConstraints: workspace: sized for 3 constraints, got 2");
  constraints = c.constraints();
  constraints.push_back(constraints[0]);
  BOOST_TEST(message(constraints) ==
             "propagateConstraints: workspace: sized for 3 constraints, got more");
}

BOOST_AUTO_TEST_SUITE_END()
