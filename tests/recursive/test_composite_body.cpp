// SPDX-License-Identifier: GPL-3.0-or-later
#include "recursive/composite_body.hpp"

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/scalars/dual.hpp"
#include "recursive/build_model.hpp"
#include "recursive/factorization.hpp"
#include "scene/scene.hpp"
#include "tests/fixtures/compiled_sweeps.hpp"
#include "tests/fixtures/fixtures.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::recursive;
using crosscheck::Dual;
using fixtures::mismatch;
using fixtures::Q;
using fixtures::V3;

namespace {

constexpr int kSeeds = 8, kMoving = 6;

MatrixX<Q> massMatrixOf(const scene::Mechanism& m, const scene::State<Q>& state,
                        FixedJoints fixed_joints = FixedJoints::kLumped) {
  const Model<Q> model = buildModel(m, fixtures::RationalNumbers(m), fixed_joints);
  Workspace<Q> ws(model);
  MatrixX<Q> M = MatrixX<Q>::Constant(model.dof(), model.dof(), Q(99));  // written whole
  massMatrix(model, state.x, ws, M);
  return M;
}

MatrixX<Q> coriolisMatrixOf(const scene::Mechanism& m, const scene::State<Q>& state) {
  const Model<Q> model = buildModel(m, fixtures::RationalNumbers(m));
  Workspace<Q> ws(model);
  return coriolisMatrix(model, state.x, state.qd, ws);
}

/// M by its definition on mass points: M_ij = sum m dr/dq_i . dr/dq_j, and the rotors.
template <typename T>
MatrixX<T> massMatrixOfPoints(const fixtures::Tree& tree, const std::vector<JointPosition<T>>& x) {
  const scene::Mechanism& m = tree.mechanism;
  const fixtures::RationalNumbers number(m);
  const int n = m.dof();
  std::vector<std::vector<V3<T>>> columns(static_cast<std::size_t>(n));  // dr/dq_j, all points
  for (int j = 0; j < n; ++j) {
    std::vector<JointPosition<Dual<T>>> x_j;
    for (int i = 0; i < n; ++i)
      x_j.push_back(crosscheck::moving(x[static_cast<std::size_t>(i)], T(i == j ? 1 : 0)));
    const auto poses = fixtures::linkPoses(m, x_j);
    for (std::size_t i = 0; i < m.links.size(); ++i)
      for (const fixtures::Point& point : tree.clouds[i]) {
        // a point of the link as a constant of both dual levels
        const V3<Dual<T>> r = fixtures::placeOf(poses[i], point.at);
        columns[static_cast<std::size_t>(j)].push_back(
            {r(0).derivative, r(1).derivative, r(2).derivative});
      }
  }
  MatrixX<T> M = MatrixX<T>::Constant(n, n, T(0));
  const std::vector<int> moving = m.movingLinks();
  for (int i = 0; i < n; ++i) {
    const scene::Joint& joint =
        m.links[static_cast<std::size_t>(moving[static_cast<std::size_t>(i)])].joint;
    M(i, i) += T(number(joint.gear_ratio) * number(joint.gear_ratio) * number(joint.rotor_inertia));
    for (int j = 0; j < n; ++j) {
      std::size_t k = 0;
      for (const auto& cloud : tree.clouds)
        for (const fixtures::Point& point : cloud) {
          M(i, j) += T(point.mass) * columns[static_cast<std::size_t>(i)][k].dot(
                                         columns[static_cast<std::size_t>(j)][k]);
          ++k;
        }
    }
  }
  return M;
}

MatrixX<Q> columnOf(const std::vector<Q>& v) {
  return Eigen::Map<const Eigen::Matrix<Q, Eigen::Dynamic, 1>>(v.data(),
                                                               static_cast<Eigen::Index>(v.size()));
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// The two uniform rods of data/scenes/double_pendulum.toml by hand (q2 relative):
//   M22 = m2 l2^2/12 + m2 (l2/2)^2,  M12 = M22 + m2 l1 (l2/2) cos q2,
//   M11 = m1 l1^2/12 + m1 (l1/2)^2 + m2 l1^2 + M22 + 2 m2 l1 (l2/2) cos q2.
BOOST_DATA_TEST_CASE(two_rods_have_their_textbook_mass_matrix, data::xrange(kSeeds), seed) {
  const scene::Mechanism m = scene::findScene("double_pendulum").mechanism;
  const scene::ParameterValues values = m.parameterValues();
  const auto value = [&](const char* name) { return Q(values.at(name).rational); };
  const Q m1 = value("m1"), m2 = value("m2"), l1 = value("l1"), l2 = value("l2");
  const scene::State<Q> state = fixtures::randomState(2, seed);
  const Q I1 = m1 * l1 * l1 / 12, I2 = m2 * l2 * l2 / 12, r1 = l1 / 2, r2 = l2 / 2;
  const Q coupling = m2 * l1 * r2 * state.x[1].c;
  MatrixX<Q> M(2, 2);
  M(1, 1) = I2 + m2 * r2 * r2;
  M(0, 1) = M(1, 0) = M(1, 1) + coupling;
  M(0, 0) = I1 + m1 * r1 * r1 + m2 * l1 * l1 + M(1, 1) + Q(2) * coupling;
  BOOST_TEST(mismatch(massMatrixOf(m, state), M) == "");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

// By another road: mass points in the world and derivatives of their places, no bodies at all.
BOOST_DATA_TEST_CASE(the_mass_matrix_is_that_of_the_mass_points, data::xrange(kSeeds), seed) {
  const fixtures::Tree tree = fixtures::randomTree(kMoving, seed);
  const scene::State<Q> state = fixtures::randomState(kMoving, seed);
  const MatrixX<Q> M = massMatrixOfPoints(tree, state.x);
  BOOST_TEST(mismatch(massMatrixOf(tree.mechanism, state), M) == "");
  BOOST_TEST(mismatch(massMatrixOf(tree.mechanism, state, FixedJoints::kKept), M) == "");
}

// C from the Christoffel symbols of the points' mass matrix:
//   C_ij = sum_k (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) qd_k / 2.
BOOST_DATA_TEST_CASE(the_coriolis_matrix_is_that_of_the_christoffel_symbols, data::xrange(4),
                     seed) {
  constexpr int n = 4;
  const fixtures::Tree tree = fixtures::randomTree(n, seed);
  const scene::State<Q> state = fixtures::randomState(n, seed);
  std::vector<MatrixX<Q>> dM;  // by q_k
  for (int k = 0; k < n; ++k) {
    std::vector<JointPosition<Dual<Q>>> x_k;
    for (int i = 0; i < n; ++i)
      x_k.push_back(crosscheck::moving(state.x[static_cast<std::size_t>(i)], Q(i == k ? 1 : 0)));
    const MatrixX<Dual<Q>> M = massMatrixOfPoints(tree, x_k);
    dM.emplace_back(n, n);
    for (int e = 0; e < n * n; ++e) dM.back()(e) = M(e).derivative;
  }
  MatrixX<Q> C = MatrixX<Q>::Constant(n, n, Q(0));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        C(i, j) += (dM[static_cast<std::size_t>(k)](i, j) + dM[static_cast<std::size_t>(j)](i, k) -
                    dM[static_cast<std::size_t>(i)](j, k)) *
                   state.qd[static_cast<std::size_t>(k)] / Q(2);
  BOOST_TEST(mismatch(coriolisMatrixOf(tree.mechanism, state), C) == "");
}

// Multiplied out again: L D L' = M, with all pivots positive; and the solution solves.
BOOST_DATA_TEST_CASE(a_mass_matrix_factorizes_with_positive_pivots, data::xrange(kSeeds), seed) {
  const scene::Mechanism m = fixtures::randomTree(kMoving, seed).mechanism;
  const scene::State<Q> state = fixtures::randomState(kMoving, seed);
  const MatrixX<Q> M = massMatrixOf(m, state);
  MatrixX<Q> LDL = M;
  factorize(LDL);
  MatrixX<Q> L = MatrixX<Q>::Identity(kMoving, kMoving);
  MatrixX<Q> D = MatrixX<Q>::Constant(kMoving, kMoving, Q(0));
  for (int j = 0; j < kMoving; ++j) {
    BOOST_TEST(LDL(j, j) > 0);
    D(j, j) = LDL(j, j);
    for (int i = j + 1; i < kMoving; ++i) L(i, j) = LDL(i, j);
  }
  BOOST_TEST(mismatch(L * D * L.transpose(), M) == "");
  std::vector<Q> b = state.tau;
  solve(LDL, b);
  BOOST_TEST(mismatch(M * columnOf(b), columnOf(state.tau)) == "");
}

BOOST_AUTO_TEST_SUITE_END()
