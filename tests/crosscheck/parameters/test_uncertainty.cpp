// SPDX-License-Identifier: GPL-3.0-or-later
// Uncertain numbers: exact derivatives by finite differences that are exact, and draws.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <nlohmann/json.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/motion/parameter_errors.hpp"
#include "crosscheck/parameters/parameters.hpp"
#include "crosscheck/parameters/parameters_report.hpp"
#include "crosscheck/scalars/prime_field.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

using F = PrimeField;

const std::vector<std::string> kScenes = {"double_pendulum", "puma_560",  "prismatic_revolute_mix",
                                          "cardan_pendulum", "heavy_top", "cylindrical_arm"};
const std::vector<std::string> kRoughScenes = {"double_pendulum", "puma_560", "franka_panda"};

/// tau with one joint misplaced by one error.
std::vector<F> forces(const scene::Mechanism& mechanism, const FieldNumbers& number,
                      const scene::State<F>& state, Eigen::Index column, const F& shift,
                      const scene::CosSin<F>& turn) {
  auto model = recursive::buildModel(mechanism, number, recursive::FixedJoints::kKept);
  const int error = static_cast<int>(column) % kErrorsOfJoint;
  recursive::Vector3<F> p(F(0), F(0), F(0));
  scene::CosSin<F> turns[3] = {{F(1), F(0)}, {F(1), F(0)}, {F(1), F(0)}};
  if (error < 3)
    p(error) = shift;
  else
    turns[error - 3] = turn;
  displace<F>(model.links[placedJoints(mechanism, model)[column / kErrorsOfJoint]], p, turns[0],
              turns[1], turns[2]);
  recursive::Workspace<F> ws(model);
  std::vector<F> tau(model.dof(), F(0));
  recursive::inverseDynamics(model, state.x, state.qd, state.qdd, ws, tau);
  return tau;
}

}  // namespace

/* tau is of second degree in one shift s of one joint, and in the cosine and sine of one turn. So,
   exactly,

       shift: (tau(s) - tau(-s)) / (2 s) = tau'
       turn:  tau(a) - tau(-a) = 2 b_1 sin a + 2 b_2 sin 2a,   tau' = b_1 + 2 b_2

   from Newton-Euler's forces of misplaced mechanisms, over the field: no step has to be small. */
BOOST_DATA_TEST_CASE(derivatives_by_placement_are_differences, data::make(kScenes), name) {
  const PrimeField::Modulus modulus(drawPrime(name, 3, 0));
  const scene::Mechanism mechanism = scene::findScene(name).mechanism;
  const FieldSource source("placement of " + name, 3, 0);
  const FieldNumbers number(mechanism, source);
  const auto state = indeterminateState(mechanism, source);
  const auto J = placementJacobian(mechanism, number, state);
  BOOST_TEST(J.cols() > 0);
  const F step = source.element("step");
  const scene::CosSin<F> a = source.circlePoint("first turn"),
                         b = source.circlePoint("second turn");
  int not_zero = 0;
  for (Eigen::Index k = 0; k < J.cols(); ++k) {
    const bool shifts = k % kErrorsOfJoint < 3;
    const auto half = [&](const F& s, const scene::CosSin<F>& turn) {
      const auto plus = forces(mechanism, number, state, k, s, turn);
      const auto minus = forces(mechanism, number, state, k, -s, {turn.c, -turn.s});
      std::vector<F> out;
      for (std::size_t i = 0; i < plus.size(); ++i) out.push_back((plus[i] - minus[i]) / F(2));
      return out;
    };
    const auto at_a = half(step, a), at_b = half(step, b);
    for (Eigen::Index i = 0; i < J.rows(); ++i) {
      F expected = at_a[i] / step;
      if (!shifts) {  // half(t) / sin t = b_1 + 2 b_2 cos t: a line in cos t, wanted at cos t = 1
        const F y_a = at_a[i] / a.s, y_b = at_b[i] / b.s;
        expected = y_a + (y_b - y_a) * (F(1) - a.c) / (b.c - a.c);
      }
      not_zero += !expected.isZero();
      BOOST_TEST((J(i, k) == expected), name << ": dtau[" << i << "]/d error " << k);
    }
  }
  BOOST_TEST(not_zero > 0);
}

// Misplacing a joint of the model is writing other numbers into the scene.
BOOST_AUTO_TEST_CASE(a_misplaced_joint_is_one_that_the_scene_misplaces) {
  using scene::Number;
  const char* const name = "planar_3r";  // joints about z of their frames, which are not turned
  scene::Mechanism mechanism = scene::findScene(name).mechanism;
  const PrimeField::Modulus modulus(drawPrime(name, 3, 0));
  const FieldSource source(name, 3, 0);
  const FieldNumbers number(mechanism, source);
  const auto state = indeterminateState(mechanism, source);
  const Number roll = Number::parse("0.1"), pitch = Number::parse("0.2"),
               yaw = Number::parse("-0.3");

  auto model = recursive::buildModel(mechanism, number, recursive::FixedJoints::kKept);
  const int last = placedJoints(mechanism, model).back();
  displace<F>(model.links[last], {F(2), F(-3), F(5)}, number.angle(roll), number.angle(pitch),
              number.angle(yaw));
  scene::Placement& placement = mechanism.links.back().joint.placement;
  BOOST_REQUIRE((placement.convention == scene::Placement::Convention::kXyzRpy));
  const int shift[] = {2, -3, 5};
  const std::string before[] = {placement.xyz[0].text(), placement.xyz[1].text(),
                                placement.xyz[2].text()};
  for (int k = 0; k < 3; ++k)
    placement.xyz[k] = Number::parse("(" + before[k] + ") + (" + std::to_string(shift[k]) + ")");
  placement.rpy = {roll, pitch, yaw};
  const auto rewritten = recursive::buildModel(mechanism, number, recursive::FixedJoints::kKept);

  recursive::Workspace<F> ws(model);
  std::vector<F> left(model.dof(), F(0)), right = left;
  recursive::inverseDynamics(model, state.x, state.qd, state.qdd, ws, left);
  recursive::inverseDynamics(rewritten, state.x, state.qd, state.qdd, ws, right);
  BOOST_TEST((left == right));
}

// Y Sigma Y' is the covariance of draws of pi, each through the whole sweep, within what chi-square
// quantiles leave; and it is not when a link's share is left out.
BOOST_DATA_TEST_CASE(draws_of_inertia_have_the_computed_covariance, data::make(kRoughScenes),
                     name) {
  const scene::Scene scene = scene::findScene(name);
  const auto parameters = scene::inertialParameters(scene.mechanism);
  const scene::State<double> state = drawState(scene.mechanism, name, 5, 0);
  const Uncertainty given = readUncertainty("mass=0.05,com=0.003,inertia=0.2,rotor=0.1");
  Eigen::MatrixXd F_pi = parameterFactor(scene.mechanism, parameters, given);
  const Eigen::MatrixXd Y = regressorAt(scene.mechanism, parameters, state);
  constexpr int kSamples = 5000;
  const Eigen::MatrixXd sampled = sampledByInertia(scene.mechanism, state, F_pi, kSamples, 5);
  const Eigen::MatrixXd Sigma = Y * F_pi * F_pi.transpose() * Y.transpose();
  BOOST_TEST(compareCovariance(Sigma, sampled, kSamples, 1e-9).agrees());
  BOOST_TEST(!compareCovariance(Sigma * 1.3, sampled, kSamples, 1e-9).agrees());
  F_pi.leftCols(4).setZero();  // the first link's density and centre of mass
  const Eigen::MatrixXd less = Y * F_pi * F_pi.transpose() * Y.transpose();
  BOOST_TEST((less - Sigma).norm() > 0);
}

// First order holds for small errors and breaks down for large ones, on the same draws.
BOOST_DATA_TEST_CASE(first_order_breaks_down_where_errors_are_large, data::make(kRoughScenes),
                     name) {
  ParametersOptions options;
  options.uncertainty = "xyz=0.001,rpy=0.005";
  options.samples = 4000;
  const ParametersResult result = examineParameters(scene::findScene(name), options);
  BOOST_REQUIRE(result.uncertainty.has_value());
  const auto& rows = result.uncertainty->geometry;
  BOOST_REQUIRE(rows.size() > 2u);
  BOOST_TEST(rows.front().check.agrees());
  BOOST_TEST(!rows.back().check.agrees());
  BOOST_TEST(result.agrees());
}

// Quantiles by another source: chi-square with 9 degrees of freedom, 2.5 % and 97.5 %: 2.700 and
// 19.023 (NIST/SEMATECH e-Handbook of Statistical Methods, table 1.3.6.7.4).
BOOST_AUTO_TEST_CASE(quantiles_are_those_of_the_tables) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(1, 1);
  const CovarianceCheck check = compareCovariance(one, one, 10, 0.05);
  BOOST_TEST(std::abs(check.low * check.low * 9 - 2.700) < 0.0005);
  BOOST_TEST(std::abs(check.high * check.high * 9 - 19.023) < 0.0005);
}

BOOST_AUTO_TEST_CASE(what_cannot_be_read_is_refused) {
  for (const char* text : {"mas=1", "mass", "mass=", "mass=x", "mass=-1", "mass=1x", "mass=inf", "",
                           "mass=0.1,,com=1"})
    BOOST_CHECK_THROW(readUncertainty(text), scene::InputError);
  const Uncertainty read = readUncertainty("mass=0.05,rpy=1e-3");
  BOOST_TEST(read.mass == 0.05);
  BOOST_TEST(read.rpy == 1e-3);
  BOOST_TEST(read.com == 0.0);
}

// The JSON says what the result says. (The schema is held by ctest's parameters_json_is_valid.)
BOOST_AUTO_TEST_CASE(json_says_what_was_found) {
  const ParametersResult result = examineParameters(scene::findScene("double_pendulum"), {});
  const auto json = nlohmann::json::parse(parametersJson(result, "test"));
  BOOST_TEST(json["rank"]["base"] == 6);
  BOOST_TEST(json["rank"]["energy_rank"] == 6);
  BOOST_TEST(json["base_parameters"].size() == 6u);
  BOOST_TEST(json["parameters"].size() == 20u);
  BOOST_TEST(json["agrees"] == true);
  double sum = 0;  // m2 l1^2 + Iyy of the upper rod, by hand: 0.8/4 + 1 (1/2)^2 / 3
  for (const auto& base : json["base_parameters"])
    if (base["terms"][0]["name"] == "Iyy(upper)") sum = base["value"];
  BOOST_TEST(std::abs(sum - (0.2 + 0.25 / 3)) < 4 * 0x1p-52);
}
