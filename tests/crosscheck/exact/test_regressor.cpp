// SPDX-License-Identifier: GPL-3.0-or-later
// Y of the sweeps against three others: the derivative of Newton-Euler's forces by a link's
// numbers, the derivation's own, and a textbook's by hand.
#include <string>
#include <vector>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/exact/regressor_checks.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/regressor.hpp"
#include "scene/scene.hpp"
#include "symbolic/program.hpp"
#include "symbolic/regressor.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

using F = PrimeField;
using MatrixF = recursive::MatrixX<F>;

std::vector<std::string> bundledNames() {
  std::vector<std::string> names;
  for (const auto& file : scene::bundledScenes()) names.push_back(file.stem().string());
  return names;
}

struct Asked {
  explicit Asked(const scene::Mechanism& mechanism, int index = 0)
      : source("test_regressor", 1, index),
        number(mechanism, source),
        state(indeterminateState(mechanism, source)),
        parameters(scene::inertialParameters(mechanism)),
        model(recursive::buildModel(mechanism, number)),
        ws(model),
        Y(model.dof(), parameters.size()) {
    recursive::regressor(model, parameters, state.x, state.qd, state.qdd, ws, Y);
  }
  FieldSource source;
  FieldNumbers number;
  scene::State<F> state;
  std::vector<scene::InertialParameter> parameters;
  recursive::Model<F> model;
  recursive::Workspace<F> ws;
  MatrixF Y;
};

const std::vector<std::string> kSmall = {"double_pendulum", "prismatic_revolute_mix", "heavy_top",
                                         "lead_screw",      "cardan_pendulum",        "puma_560",
                                         "cylindrical_arm", "puck_on_slope"};

}  // namespace

// A column is the change of tau when its parameter grows by 1: Newton-Euler on a changed model.
BOOST_DATA_TEST_CASE(a_column_is_what_one_more_unit_adds_to_newton_euler, data::make(kSmall),
                     name) {
  const PrimeField::Modulus modulus(drawPrime(name, 1, 0));
  const scene::Mechanism mechanism = scene::findScene(name).mechanism;
  Asked at(mechanism);
  const int n = at.model.dof();
  std::vector<F> before(n), after(n);
  recursive::Workspace<F> ws(at.model);
  recursive::inverseDynamics(at.model, at.state.x, at.state.qd, at.state.qdd, ws, before);
  for (std::size_t j = 0; j < at.parameters.size(); ++j) {
    recursive::Model<F> heavier = at.model;
    const recursive::ScenePlace<F>& place = at.model.places[at.parameters[j].link];
    recursive::LinkModel<F>& link = heavier.links[place.link];
    auto one = recursive::RigidInertia<F>::zero();
    F* const numbers[] = {&one.mass, &one.h(0), &one.h(1), &one.h(2), &one.I.xx,  &one.I.yy,
                          &one.I.zz, &one.I.xy, &one.I.xz, &one.I.yz, &link.rotor};
    *numbers[static_cast<int>(at.parameters[j].kind)] += F(1);
    link.M = link.M + place.X.inverseTimes(one);
    recursive::inverseDynamics(heavier, at.state.x, at.state.qd, at.state.qdd, ws, after);
    for (int i = 0; i < n; ++i)
      BOOST_TEST((after[i] - before[i] == at.Y(i, j)),
                 name << ": Y[" << i << "], " << scene::label(at.parameters[j], mechanism));
  }
}

// The other road: T and V by 3-D geometry, differentiated by q, qd, t, and then by the parameters.
BOOST_DATA_TEST_CASE(entries_are_those_of_the_differentiated_lagrangian, data::make(kSmall), name) {
  const PrimeField::Modulus modulus(drawPrime(name, 1, 0));
  const scene::Mechanism mechanism = scene::findScene(name).mechanism;
  Asked at(mechanism);
  symbolic::InertialSymbols symbols = symbolic::inertialSymbols(mechanism);
  std::vector<symbolic::Node> outputs;
  for (const auto& row : symbolic::regressor(symbols))
    outputs.insert(outputs.end(), row.begin(), row.end());
  const symbolic::Program program = symbolic::compile(symbols.equations.graph, outputs);
  const FieldNumbers number(symbols.mechanism, at.source);
  const std::vector<F> derived = symbolic::ProgramRun<F>(program, number)(at.state);
  std::size_t k = 0;
  for (Eigen::Index i = 0; i < at.Y.rows(); ++i)
    for (Eigen::Index j = 0; j < at.Y.cols(); ++j, ++k)
      BOOST_TEST((derived[k] == at.Y(i, j)),
                 name << ": Y[" << i << "], " << scene::label(at.parameters[j], mechanism));
}

// The same with a stated chance of error, as the report has it, for every bundled scene.
BOOST_DATA_TEST_CASE(both_roads_agree_on_every_bundled_scene, data::make(bundledNames()), name) {
  const std::vector<CheckResult> checks = checkRegressorExactly(scene::findScene(name), {});
  BOOST_REQUIRE(checks.size() == 1u);
  BOOST_TEST((checks[0].verdict == Verdict::kAgree), name << ": " << checks[0].reason);
  BOOST_REQUIRE(checks[0].exact.has_value());
  BOOST_TEST(checks[0].exact->error_probability <= 1e-30);
}

// A rod on a hinge, by hand:  tau = Iyy qdd + (mcx) g sin q ...: with the axis along y and gravity
// along -z, a point at (x, z) moves up by dz/dq = -(x cos q + z sin q).
BOOST_AUTO_TEST_CASE(a_simple_pendulum_is_that_of_the_textbook) {
  const scene::Mechanism mechanism =
      scene::readSceneToml(
          "title = \"p\"\nsource = \"t\"\ngravity = [0, 0, -10]\n"
          "[[link]]\nname = \"w\"\n[[link]]\nname = \"rod\"\nparent = \"w\"\nmass = 1\n"
          "inertia = { about = \"com\", xx = 1, yy = 1, zz = 1 }\n"
          "[link.joint]\nname = \"j\"\nkind = \"revolute\"\naxis = [0, 1, 0]\n",
          "pendulum.toml")
          .mechanism;
  const auto parameters = scene::inertialParameters(mechanism);
  const auto model = recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism));
  recursive::Workspace<double> ws(model);
  Eigen::MatrixXd Y(1, parameters.size());
  const double c = 0.6, s = 0.8;  // a right triangle: 3, 4, 5
  recursive::regressor(model, parameters, {{0, c, s}}, {7.0}, {3.0}, ws, Y);
  const double expected[] = {0, -10 * c, 0, -10 * s, 0, 3, 0, 0, 0, 0};
  for (int j = 0; j < 10; ++j) BOOST_TEST(std::abs(Y(0, j) - expected[j]) <= 8 * 10 * 0x1p-52);
}

BOOST_AUTO_TEST_CASE(a_matrix_of_the_wrong_size_is_refused) {
  const scene::Mechanism mechanism = scene::findScene("double_pendulum").mechanism;
  const auto parameters = scene::inertialParameters(mechanism);
  const auto model = recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism));
  recursive::Workspace<double> ws(model);
  Eigen::MatrixXd Y(2, parameters.size() + 1);
  const std::vector<scene::JointPosition<double>> x(2, scene::jointPosition(0.0));
  BOOST_CHECK_THROW(recursive::regressor(model, parameters, x, {0.0, 0.0}, {0.0, 0.0}, ws, Y),
                    std::invalid_argument);
}
