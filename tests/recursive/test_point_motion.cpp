// SPDX-License-Identifier: GPL-3.0-or-later
// Where a point of a link is and how it moves: an arm by hand, derivatives by dual numbers, and
// homogeneous matrices over the prime field.
#include "recursive/point_motion.hpp"

#include <cmath>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/exact/point_checks.hpp"
#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/scalars/dual.hpp"
#include "recursive/build_model.hpp"
#include "scene/scene.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using recursive::PointMotion;
using recursive::Vector3;

namespace {

template <typename T, typename Numbers>
PointMotion<T> moved(const scene::Mechanism& mechanism, const Numbers& number,
                     const scene::State<T>& state, std::size_t link, const Vector3<T>& at) {
  const auto model = recursive::buildModel(mechanism, number);
  recursive::Workspace<T> ws(model);
  return recursive::pointMotion<T>(model, state.x, state.qd, state.qdd, link, at, ws);
}

/// Two links of 1 m and 0.7 m in the xy plane, and a tool fixed to the second, turned by pi/2.
const char* const kArm = R"(
title = "arm"
[[link]]
name = "base"
[[link]]
name = "upper"
parent = "base"
mass = 1
joint = { name = "shoulder", kind = "revolute" }
[[link]]
name = "lower"
parent = "upper"
mass = 1
joint = { name = "elbow", kind = "revolute", xyz = [1, 0, 0] }
[[link]]
name = "tool"
parent = "lower"
mass = 1
joint = { name = "grip", kind = "fixed", xyz = [0.7, 0, 0], rpy = [0, 0, "pi/2"] }
)";

}  // namespace

// By hand, with s1 = sin q1, s12 = sin(q1 + q2), ...: p = (c1 + r c12, s1 + r s12) and its
// derivatives by time; r is the tool's 0.7 m and 0.1 m more, which lie along -y of the tool.
BOOST_AUTO_TEST_CASE(an_arm_of_two_links_moves_as_its_formulas_say) {
  const scene::Scene arm = scene::readSceneToml(kArm, "arm.toml");
  const double q1 = 0.3, q2 = 0.9, r = 0.8, u = 1.5, v = -0.4, ud = 0.25, vd = 2;
  const double s1 = std::sin(q1), c1 = std::cos(q1), s = std::sin(q1 + q2), c = std::cos(q1 + q2);
  const double w = u + v, wd = ud + vd;
  const scene::State<double> state{
      {scene::jointPosition(q1), scene::jointPosition(q2)}, {u, v}, {ud, vd}, {}};
  const auto tool = moved<double>(arm.mechanism, scene::RealNumbers<double>(arm.mechanism), state,
                                  3, Vector3<double>(0, -0.1, 0));
  Eigen::MatrixXd J(6, 2), J_rate(6, 2);
  J << -s1 - r * s, -r * s, c1 + r * c, r * c, 0, 0, 0, 0, 0, 0, 1, 1;
  J_rate << -c1 * u - r * c * w, -r * c * w, -s1 * u - r * s * w, -r * s * w, 0, 0, 0, 0, 0, 0, 0,
      0;
  Eigen::Matrix<double, 6, 1> velocity, acceleration;
  velocity << -s1 * u - r * s * w, c1 * u + r * c * w, 0, 0, 0, w;
  acceleration << -s1 * ud - c1 * u * u - r * (s * wd + c * w * w),
      c1 * ud - s1 * u * u + r * (c * wd - s * w * w), 0, 0, 0, wd;
  Eigen::Matrix3d R;  // x of the tool is y of the lower link
  R << -s, -c, 0, c, -s, 0, 0, 0, 1;
  // numbers up to 5 of some twenty roundings
  constexpr double kLimit = 20 * 5 * 0x1p-52;
  BOOST_TEST((tool.position - Vector3<double>(c1 + r * c, s1 + r * s, 0)).norm() < kLimit);
  BOOST_TEST((tool.R - R).norm() < kLimit);
  BOOST_TEST((tool.velocity.vector() - velocity).norm() < kLimit);
  BOOST_TEST((tool.acceleration.vector() - acceleration).norm() < kLimit);
  BOOST_TEST((tool.J - J).norm() < kLimit);
  BOOST_TEST((tool.J_rate - J_rate).norm() < kLimit);
}

// The same sweep on dual numbers along the motion differentiates places and Jacobian without a
// step: exactly what velocity and J_rate say by formulas of their own.
BOOST_DATA_TEST_CASE(rates_are_the_derivatives_of_what_they_are_rates_of, data::xrange(12), index) {
  const scene::Scene scene = randomScene(17, index, 8);
  const scene::Mechanism& m = scene.mechanism;
  const scene::State<double> state = drawState(m, scene.name, 1, 0);
  const scene::RealNumbers<double> number(m);
  const std::size_t link = m.links.size() - 1;
  const Vector3<double> at(0.1, -0.2, 0.3);
  const PointMotion<double> motion = moved<double>(m, number, state, link, at);

  const auto model = recursive::buildModel(m, number);
  std::vector<double> rates(state.x.size());
  recursive::positionRates(model, state.x, state.qd, rates);
  scene::State<Dual<double>> along;
  for (std::size_t k = 0; k < rates.size(); ++k) along.x.push_back(moving(state.x[k], rates[k]));
  for (std::size_t k = 0; k < state.qd.size(); ++k) {
    along.qd.emplace_back(state.qd[k], state.qdd[k]);
    along.qdd.emplace_back(0.0);
  }
  const PointMotion<Dual<double>> dual = moved<Dual<double>>(
      m, DualNumbers<scene::RealNumbers<double>>(number), along, link, at.cast<Dual<double>>());
  const auto derivative = [](const auto& matrix) {
    return Eigen::MatrixXd(matrix.unaryExpr([](const Dual<double>& x) { return x.derivative; }));
  };
  const auto off = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).norm() / (1 + a.norm());
  };
  // of eight joints in double; measured up to 4e-16
  constexpr double kLimit = 1e-14;
  BOOST_TEST(off(motion.velocity.linear, derivative(dual.position)) < kLimit);
  BOOST_TEST(off(motion.J_rate, derivative(dual.J)) < kLimit);
  BOOST_TEST(off(motion.acceleration.vector(), derivative(dual.velocity.vector())) < kLimit);
  const Eigen::Matrix3d W = derivative(dual.R) * motion.R.transpose();  // [w]x
  BOOST_TEST(off(motion.velocity.angular, Vector3<double>(W(2, 1), W(0, 2), W(1, 0))) < kLimit);
}

BOOST_DATA_TEST_CASE(sweeps_and_matrices_are_the_same_functions, data::xrange(12), index) {
  const scene::Scene scene = randomScene(5, index, 7);
  const auto checks = checkPointsExactly(scene, {});
  BOOST_TEST(checks.size() == 4u);
  for (const CheckResult& check : checks) {
    BOOST_TEST((check.verdict == Verdict::kAgree), scene.name << ": " << check.law);
    BOOST_TEST(check.exact.has_value());
  }
}

BOOST_AUTO_TEST_CASE(joints_that_follow_others_move_their_links_with_their_leaders_rate) {
  const scene::Scene gripper = scene::findScene("gripper");
  BOOST_TEST_REQUIRE(gripper.mechanism.hasMimics());
  for (const CheckResult& check : checkPointsExactly(gripper, {}))
    BOOST_TEST((check.verdict == Verdict::kAgree), check.law);
}

// A placement that is off by 10^-9 in what one road reads.
BOOST_AUTO_TEST_CASE(a_link_that_stands_elsewhere_is_seen) {
  const scene::Scene right = scene::readSceneToml(kArm, "arm.toml");
  std::string text = kArm;
  text.replace(text.find("[1, 0, 0]"), 9, "[1.000000001, 0, 0]");
  const scene::Scene wrong = scene::readSceneToml(text, "arm.toml");
  const auto checks = checkPointsExactly(right, {}, &wrong.mechanism);
  for (std::size_t k = 0; k < 3; ++k)
    BOOST_TEST((checks[k].verdict == Verdict::kDisagree), checks[k].law);
}

BOOST_AUTO_TEST_CASE(other_lengths_and_links_are_refused) {
  const scene::Scene arm = scene::readSceneToml(kArm, "arm.toml");
  const auto model =
      recursive::buildModel(arm.mechanism, scene::RealNumbers<double>(arm.mechanism));
  recursive::Workspace<double> ws(model);
  const std::vector<scene::JointPosition<double>> x(2, scene::jointPosition(0.0));
  const std::vector<double> two(2), one(1);
  const Vector3<double> at(0, 0, 0);
  BOOST_CHECK_THROW(recursive::pointMotion<double>(model, x, two, one, 1, at, ws),
                    std::invalid_argument);
  BOOST_CHECK_THROW(recursive::pointMotion<double>(model, x, one, two, 1, at, ws),
                    std::invalid_argument);
  BOOST_CHECK_THROW(recursive::pointMotion<double>(model, x, two, two, 4, at, ws),
                    std::invalid_argument);
  // what rests has a place and no motion
  const auto base = recursive::pointMotion<double>(model, x, two, two, 0, at, ws);
  BOOST_TEST(base.J.norm() == 0);
}
