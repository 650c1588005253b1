// SPDX-License-Identifier: GPL-3.0-or-later
// The audit of sections 9 to 17: its truths against hand formulas, its verdicts against those that
// we derived on paper, and that no entry is missing.
#include "crosscheck/audit/constraints.hpp"

#include <map>
#include <set>

#include <boost/test/unit_test.hpp>

#include "tests/fixtures/fixtures.hpp"

using namespace dynwitness;
using namespace dynwitness::audit;
using fixtures::mismatch;
using fixtures::Q;

namespace {

/// Two turning joints about z, the second at (length, 0, 0), one mass point on each link; gravity
/// along -y.
Robot<Q> planarArm(Q m1, Q l1, Q m2, Q l2, Q length, scene::CosSin<Q> q1, scene::CosSin<Q> q2) {
  Robot<Q> robot;
  for (int i = 0; i < 2; ++i) {
    robot.parent.push_back(i - 1);
    robot.kind.push_back(kTurn);
    robot.R.push_back(Matrix3<Q>::Identity());
    robot.r.push_back({i == 0 ? Q(0) : length, Q(0), Q(0)});
    robot.body.push_back({{i == 0 ? m1 : m2}, {{i == 0 ? l1 : l2, Q(0), Q(0)}}});
    robot.rotor.push_back(0);
    const auto& angle = i == 0 ? q1 : q2;
    robot.x.push_back({Q(0), angle.c, angle.s});
  }
  robot.qd = {2, -3};
  robot.qdd = {5, 7};
  robot.tau = {1, 4};
  robot.gravity = {Q(0), Q(-10), Q(0)};
  return robot;
}

const Q m1 = 2, l1 = Q(1) / 3, m2 = 5, l2 = Q(3) / 4, length = Q(7) / 5;
const scene::CosSin<Q> q1 = fixtures::circlePoint(Q(1) / 2), q2 = fixtures::circlePoint(Q(-2) / 3);

Claim claimOf(const std::string& id) {
  for (const Claim& claim : joined(bundledChapter(), allTrials()))
    if (claim.trials.id == id) return claim;
  throw std::invalid_argument("no claim " + id);
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// The double pendulum's equations, typed from a textbook's closed form.
BOOST_AUTO_TEST_CASE(virtual_work_gives_the_double_pendulum) {
  const Robot<Q> robot = planarArm(m1, l1, m2, l2, length, q1, q2);
  const Q a = m1 * l1 * l1 + m2 * length * length, b = m2 * length * l2, e = m2 * l2 * l2;
  const Q c12 = q1.c * q2.c - q1.s * q2.s;
  MatrixX<Q> M(2, 2);
  M << a + e + 2 * b * q2.c, e + b * q2.c, e + b * q2.c, e;
  BOOST_TEST(mismatch(robot.massMatrix(), M) == "");
  const Q h = -b * q2.s;
  VectorX<Q> c(2), g(2);
  c << h * (2 * robot.qd[0] * robot.qd[1] + robot.qd[1] * robot.qd[1]),
      -h * robot.qd[0] * robot.qd[0];
  g << 10 * ((m1 * l1 + m2 * length) * q1.c + m2 * l2 * c12), 10 * m2 * l2 * c12;
  const VectorX<Q> qdd = Robot<Q>::column(robot.qdd);
  BOOST_TEST(mismatch(robot.forces(robot.qdd), VectorX<Q>(M * qdd + c + g)) == "");
}

BOOST_AUTO_TEST_CASE(accelerations_undo_forces) {
  Robot<Q> robot = planarArm(m1, l1, m2, l2, length, q1, q2);
  robot.tau = Robot<Q>::values(robot.forces(robot.qdd));
  BOOST_TEST(mismatch(Robot<Q>::column(robot.accelerations()), Robot<Q>::column(robot.qdd)) == "");
}

// A wheel that turns with w has spatial acceleration 0 at its hub and w x (w x r) less w x v = 0
// elsewhere.
BOOST_AUTO_TEST_CASE(spatial_acceleration_of_a_steady_turn_is_zero) {
  Robot<Q> robot = planarArm(m1, l1, m2, l2, length, q1, q2);
  const auto paths = robot.paths({Q(3), Q(0)}, {Q(0), Q(0)});
  BOOST_TEST(mismatch(robot.accelerationOf(paths[1]), Vector6<Q>::Zero()) == "");
}

BOOST_AUTO_TEST_CASE(elimination_exchanges_rows) {
  MatrixX<Q> A(3, 3);
  A << 0, 2, 1, 3, 0, 4, 1, 5, 0;
  BOOST_TEST(determinant<Q>(A) == Q(23));  // by Sarrus: 8 + 15
  BOOST_TEST(mismatch(MatrixX<Q>(A * inverseDense<Q>(A)), MatrixX<Q>::Identity(3, 3)) == "");
  A.row(2) = A.row(0) + A.row(1);
  BOOST_TEST(determinant<Q>(A) == Q(0));
  BOOST_CHECK_THROW(inverseDense<Q>(A), crosscheck::DivisionByZero);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(verdicts)

BOOST_AUTO_TEST_CASE(equations_51_to_74_have_one_entry_each) {
  std::map<std::string, int> count;
  for (const Statement& statement : bundledChapter().statements) ++count[statement.id];
  for (int i = 51; i <= 74; ++i) BOOST_TEST(count["eq" + std::to_string(i)] == 1, "eq" << i);
  for (const auto& [id, times] : count) BOOST_TEST(times == 1, id);
}

// Derived on paper, before they were computed.
BOOST_AUTO_TEST_CASE(verdicts_are_those_derived_on_paper) {
  using H = Holds;
  const std::map<std::string, Holds> expected = {{"tip_inertia", H::kFalse},
                                                 {"eq51", H::kFalse},
                                                 {"eq52", H::kUnderCondition},
                                                 {"gravity_start", H::kFalse},
                                                 {"eq53", H::kTrue},
                                                 {"b_curvature", H::kFalse},
                                                 {"eq54", H::kFalse},
                                                 {"eq55", H::kUnderCondition},
                                                 {"eq56", H::kFalse},
                                                 {"eq57", H::kTrue},
                                                 {"balance", H::kUnderCondition},
                                                 {"N_definite", H::kUnderCondition},
                                                 {"eq58", H::kFalse},
                                                 {"eq59", H::kUnderCondition},
                                                 {"eq60", H::kFalse},
                                                 {"E0_rank", H::kUnderCondition},
                                                 {"null_motion", H::kUnderCondition},
                                                 {"eq61", H::kTrue},
                                                 {"eq62", H::kTrue},
                                                 {"eq63", H::kFalse},
                                                 {"composite_order", H::kUnderCondition},
                                                 {"eq64", H::kUnderCondition},
                                                 {"least_action", H::kUnderCondition},
                                                 {"eq65", H::kTrue},
                                                 {"eq66", H::kUnderCondition},
                                                 {"euler_pdes", H::kFalse},
                                                 {"euler_not_sufficient", H::kTrue},
                                                 {"fully_equivalent", H::kUnderCondition},
                                                 {"eq67", H::kTrue},
                                                 {"eq68", H::kFalse},
                                                 {"eq69", H::kTrue},
                                                 {"eq70", H::kTrue},
                                                 {"eq71", H::kTrue},
                                                 {"eq72", H::kTrue},
                                                 {"invariance", H::kUnderCondition},
                                                 {"eq73", H::kTrue},
                                                 {"eq74", H::kUnderCondition},
                                                 {"similarity", H::kFalse},
                                                 {"other_impedances", H::kFalse}};
  for (const auto& [id, holds] : expected)
    BOOST_TEST(name(evaluate(claimOf(id), 2).holds) == name(holds), id);
}

// Whatever the seed, what we give as correct is computed to be so; and each entry says why and
// where.
BOOST_AUTO_TEST_CASE(our_own_part_stands) {
  const std::set<std::string> sections = {"9",  "9.1", "9.2",  "10", "11.1", "11.2", "11.3", "12",
                                          "13", "14",  "14.1", "15", "15.1", "16",   "16.1", "17"};
  std::set<std::string> seen;
  for (const Claim& claim : joined(bundledChapter(), allTrials())) {
    if (sections.count(claim.statement.section) == 0) continue;
    seen.insert(claim.statement.section);
    const Entry entry = evaluate(claim, 3);
    BOOST_TEST(entry.isSound(), claim.trials.id << ": " << entry.residual_printed.residual);
    BOOST_TEST(!entry.implemented_in.empty(), claim.trials.id);
    if (entry.holds != Holds::kTrue) BOOST_TEST(!entry.why.empty(), claim.trials.id);
  }
  BOOST_TEST(seen.size() == sections.size() - 1);  // section 9 has no statement of its own
}

BOOST_AUTO_TEST_SUITE_END()
