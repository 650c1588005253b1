// SPDX-License-Identifier: GPL-3.0-or-later
// The chapter's projections written out.
#include "recursive/projection.hpp"

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "tests/fixtures/fixtures.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::recursive;
using fixtures::mismatch;
using fixtures::Q;

namespace {

constexpr int kSeeds = 8;

Vector6<Q> unit(int i) {
  return Vector6<Q>::Unit(i);
}

/// A generic positive definite 6 x 6 matrix: a sum of squares.
Matrix6<Q> randomInertia(fixtures::Sampler& sample) {
  Matrix6<Q> M = Matrix6<Q>::Identity();
  for (int k = 0; k < 3; ++k) {
    Vector6<Q> column;
    column << sample.vector(), sample.vector();
    M += column * column.transpose();
  }
  return M;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// Equations (31) and (36), typed from the page, Z along the last axis; d = 0 gives (31).
BOOST_DATA_TEST_CASE(the_projection_matrices_are_those_written_out_in_the_chapter,
                     data::xrange(kSeeds) * data::make({false, true}), seed, has_rotor) {
  fixtures::Sampler sample(static_cast<std::uint64_t>(seed));
  const Matrix6<Q> m = randomInertia(sample);
  const Q d = has_rotor ? sample.positive() : Q(0);
  const Q D = d + m(5, 5);
  Matrix6<Q> P;
  P << 1, 0, 0, 0, 0, -m(0, 5) / D, 0, 1, 0, 0, 0, -m(1, 5) / D, 0, 0, 1, 0, 0, -m(2, 5) / D, 0, 0,
      0, 1, 0, -m(3, 5) / D, 0, 0, 0, 0, 1, -m(4, 5) / D,
      // the page prints 0 here in (36) as well; it is 1 - m66/(d + m66), which is 0 without a rotor
      0, 0, 0, 0, 0, d / D;
  BOOST_TEST(mismatch(forceProjection(m, unit(5), d), P) == "");
  BOOST_TEST(mismatch(accelerationProjection(m, unit(5), d), P.transpose()) == "");
}

// Equation (32) prints M with its last row and column erased. That is what P M would be if column 6
// of M were zero elsewhere; with m16 .. m56 each entry also loses m_i6 m_6j / m66, by (26).
BOOST_DATA_TEST_CASE(projected_inertia_has_no_row_and_column_of_the_joint, data::xrange(kSeeds),
                     seed) {
  fixtures::Sampler sample(seed);
  const Matrix6<Q> m = randomInertia(sample);
  Matrix6<Q> P_M;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) P_M(i, j) = m(i, j) - m(i, 5) * m(5, j) / m(5, 5);
  BOOST_TEST(mismatch(inertiaProjection(m, unit(5), Q(0)), P_M) == "");
  BOOST_TEST(mismatch(P_M.row(5), Vector6<Q>::Zero().transpose()) == "");
  BOOST_TEST(mismatch(P_M.col(5), Vector6<Q>::Zero()) == "");
  // decoupled from the joint: the page's (32) entry by entry
  Matrix6<Q> decoupled = m;
  for (int i = 0; i < 5; ++i) decoupled(i, 5) = decoupled(5, i) = 0;
  Matrix6<Q> erased = decoupled;
  erased(5, 5) = 0;
  BOOST_TEST(mismatch(inertiaProjection(decoupled, unit(5), Q(0)), erased) == "");
}

// Equations (20) to (26) solved as they stand: link 1 is given an acceleration A, q2'' makes
// Z' F = -d q2'' (with the rotor), and the force through the joint is F = M (A + Z q2'').
BOOST_DATA_TEST_CASE(the_projection_gives_the_force_that_a_free_joint_passes_on,
                     data::xrange(kSeeds) * data::make({false, true}), seed, has_rotor) {
  fixtures::Sampler sample(static_cast<std::uint64_t>(seed));
  const Matrix6<Q> M = randomInertia(sample);
  const Q d = has_rotor ? sample.positive() : Q(0);
  Vector6<Q> A, Z;
  A << sample.vector(), sample.vector();
  Z << sample.vector(), sample.vector();             // any screw, not only z
  const Q qdd = -Z.dot(M * A) / (d + Z.dot(M * Z));  // (22), (23)
  const Vector6<Q> acceleration = A + Z * qdd;       // (20)
  const Vector6<Q> F = M * acceleration;             // (24)
  BOOST_TEST(Z.dot(F) == -d * qdd);                  // (21)
  BOOST_TEST(mismatch(inertiaProjection(M, Z, d) * A, F) == "");
  BOOST_TEST(mismatch(accelerationProjection(M, Z, d) * A, acceleration) == "");  // (37) to (39)
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

// Equations (28) and (30), the dual (40), and that a projection loses exactly one dimension.
BOOST_DATA_TEST_CASE(without_a_rotor_the_projection_is_a_projector, data::xrange(kSeeds), seed) {
  fixtures::Sampler sample(seed);
  const Matrix6<Q> M = randomInertia(sample);
  Vector6<Q> Z;
  Z << sample.vector(), sample.vector();
  const Matrix6<Q> P = forceProjection(M, Z, Q(0)), P_M = inertiaProjection(M, Z, Q(0));
  BOOST_TEST(mismatch(P * P, P) == "");
  BOOST_TEST(mismatch(P_M, P_M.transpose()) == "");
  BOOST_TEST(mismatch(P_M * P.transpose(), P_M) == "");
  BOOST_TEST(mismatch(Z.transpose() * P, Vector6<Q>::Zero().transpose()) == "");
  BOOST_TEST(mismatch(P * (M * Z), Vector6<Q>::Zero()) == "");
  BOOST_TEST(P.trace() == 5);
}

// With a rotor P has the eigenvalue d / (d + Z'MZ) where the projector has 0.
BOOST_DATA_TEST_CASE(with_a_rotor_the_projection_leaks, data::xrange(kSeeds), seed) {
  fixtures::Sampler sample(seed);
  const Matrix6<Q> M = randomInertia(sample), one = Matrix6<Q>::Identity();
  Vector6<Q> Z;
  Z << sample.vector(), sample.vector();
  const Q d = sample.positive(), leak = d / (d + Z.dot(M * Z));
  const Matrix6<Q> P = forceProjection(M, Z, d);
  BOOST_TEST(mismatch((P - one) * (P - one * leak), Matrix6<Q>::Zero()) == "");
  BOOST_TEST(mismatch(P * P, P) != "");
}

BOOST_AUTO_TEST_SUITE_END()
