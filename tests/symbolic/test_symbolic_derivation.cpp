// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms: GiNaC's derivation against the graph's, the exact zero test, and the formulas that
// are shown, which Python evaluates from their printed text.
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <regex>
#include <set>
#include <sstream>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "scene/scene.hpp"
#include "symbolic/closed_form.hpp"
#include "symbolic/derivation.hpp"
#include "symbolic/dimensions.hpp"
#include "symbolic/exact_points.hpp"

using namespace dynwitness;
using namespace dynwitness::symbolic;
namespace data = boost::unit_test::data;
namespace fs = std::filesystem;

namespace {

const Options kAsWritten{false, false};

std::vector<std::string> smallScenes() {
  std::vector<std::string> names;
  for (const auto& path : scene::bundledScenes())
    if (const scene::Mechanism m = scene::readScene(path).mechanism;
        m.dof() <= kClosedFormJoints && m.positions() == m.dof())
      names.push_back(path.string());
  return names;
}

/// Three joints about different axes, the last two parallel, with every symbol that can occur.
scene::Mechanism spatialArm() {
  return scene::readSceneToml(R"toml(
title = "spatial arm"
source = "this test"
gravity = [0, 0, "-g"]
[parameters]
g = 9.81
m = 2
l = 0.5
alpha = 0.7
k = 3
J = 0.25
[[link]]
name = "base"
[[link]]
name = "turret"
parent = "base"
mass = "m"
com = [0.1, 0, "l/3"]
inertia = { zz = "J", xx = "J", yy = "J" }
[link.joint]
kind = "revolute"
stiffness = "k"
rest = "pi/6"
[[link]]
name = "boom"
parent = "turret"
mass = "m/2"
com = ["l/2", 0, 0]
[link.joint]
kind = "revolute"
rpy = ["alpha", 0, 0.3]
axis = [0, -1, 0]
[[link]]
name = "stick"
parent = "boom"
mass = "m/(1 + l)"
com = ["l/2", 0.05, 0]
[link.joint]
kind = "revolute"
xyz = ["l", 0, 0]
axis = [0, -1, 0]
)toml",
                              "arm.toml")
      .mechanism;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(identities)

BOOST_AUTO_TEST_CASE(the_zero_test_knows_the_circle_and_nothing_else) {
  Equations e = derive(spatialArm(), kAsWritten);
  const Node fixed =
      e.graph.atom({Atom::Kind::kCos, scene::Number::parse("alpha"), {}, "cos(alpha)"});
  const Node fixed_sine =
      e.graph.atom({Atom::Kind::kSin, scene::Number::parse("alpha"), {}, "sin(alpha)"});
  ClosedAlgebra algebra(e);
  const GiNaC::ex c = algebra.input(Input::kCos, 0), s = algebra.input(Input::kSin, 0),
                  s2 = algebra.input(Input::kSin, 1);
  BOOST_TEST(algebra.isZero(c * c + s * s - 1));
  BOOST_TEST(algebra.isZero(pow(c, 4) - pow(s, 4) - c * c + s * s));
  BOOST_TEST(!algebra.isZero(c * c + s2 * s2 - 1));
  BOOST_TEST(!algebra.isZero(c * c - s * s));
  BOOST_TEST(!algebra.isZero(c + s - 1));
  const GiNaC::ex cf = algebra.expression(fixed), sf = algebra.expression(fixed_sine);
  BOOST_TEST(algebra.isZero(cf * cf + sf * sf - 1));
  BOOST_TEST(!algebra.isZero(cf - sf));
}

void ginacAgreesWithTheGraph(const scene::Mechanism& m) {
  const Equations e = derive(m, kAsWritten);
  ClosedAlgebra algebra(e);
  const ClosedForm f = deriveClosedForm(algebra, e);
  for (int i = 0; i < e.dof(); ++i) {
    BOOST_TEST(algebra.isZero(f.p[i] - algebra.expression(e.p[i])));
    BOOST_TEST(algebra.isZero(f.c[i] - algebra.expression(e.c[i])));
    BOOST_TEST(algebra.isZero(f.g[i] - algebra.expression(e.g[i])));
    for (int j = 0; j < e.dof(); ++j)
      BOOST_TEST(algebra.isZero(f.M[i][j] - algebra.expression(e.M[i][j])));
    // and the test can fail: a momentum is not its negative
    BOOST_TEST(!algebra.isZero(f.p[i] + algebra.expression(e.p[i])));
  }
}

BOOST_DATA_TEST_CASE(ginac_derives_what_the_graph_derives, data::make(smallScenes()), file) {
  ginacAgreesWithTheGraph(scene::readScene(file).mechanism);
}

BOOST_AUTO_TEST_CASE(ginac_derives_what_the_graph_derives_in_space) {
  ginacAgreesWithTheGraph(spatialArm());
}

BOOST_AUTO_TEST_CASE(parallel_joints_are_found) {
  BOOST_TEST(derive(spatialArm()).parallel_inboard == (std::vector<int>{-1, -1, 1}),
             boost::test_tools::per_element());
  BOOST_TEST(derive(scene::findScene("planar_3r").mechanism).parallel_inboard ==
                 (std::vector<int>{-1, 0, 1}),
             boost::test_tools::per_element());
}

/// Evaluates the printed text of T, V, p, M, c and g in Python and compares with the program.
/// Measured: 2e-15 relative at worst; the limit leaves room for other roundings of sin and cos.
void shownFormulasAreRight(const scene::Mechanism& m) {
  const Equations e = derive(m, kAsWritten);
  ClosedAlgebra algebra(e);
  std::vector<Node> nodes = massCoriolisGravity(e);
  nodes.insert(nodes.end(), e.p.begin(), e.p.end());
  nodes.push_back(e.kinetic);
  nodes.push_back(e.potential);

  const int n = e.dof();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> between(-3, 3);
  scene::State<double> state;
  std::ostringstream script;
  script.precision(17);
  script << "from math import cos, sin, pi\n";
  const scene::ParameterValues values = m.parameterValues();
  for (const scene::Parameter& p : m.parameters)
    script << p.name << " = " << values.at(p.name).toDouble() << "\n";
  for (int i = 0; i < n; ++i) {
    const double q = between(random), qd = between(random);
    state.x.push_back(scene::jointPosition(q));
    state.qd.push_back(qd);
    script << "q" << i + 1 << ", qd" << i + 1 << " = " << q << ", " << qd << "\n";
  }
  // the one bundled scene with an oblique axis has (1, 0, 1)
  script << "alpha_axis, beta_axis = 0, pi/4\n";
  for (Node node : nodes) {
    std::string text = print(algebra.formula(algebra.expression(node)), Style::kText);
    text = std::regex_replace(text, std::regex("\\^"), "**");
    text = std::regex_replace(text, std::regex(" axis[0-9]+"), "_axis");
    script << "print(repr(float(" << text << ")))\n";
  }
  std::string file = (fs::temp_directory_path() / "dynwitness_formula_XXXXXX").string();
  const int descriptor = mkstemp(file.data());
  BOOST_REQUIRE(descriptor >= 0);
  close(descriptor);
  std::ofstream(file) << script.str();
  FILE* pipe = popen(("/usr/bin/python3 '" + file + "'").c_str(), "r");
  BOOST_REQUIRE(pipe != nullptr);
  const Program program = compile(e.graph, nodes);
  for (double expected : ProgramRun<double>(program, scene::RealNumbers<double>(m))(state)) {
    double shown = 0;
    BOOST_REQUIRE(fscanf(pipe, "%lf", &shown) == 1);
    BOOST_TEST(std::abs(shown - expected) <= 1e-13 * std::max(1.0, std::abs(expected)));
  }
  BOOST_TEST(pclose(pipe) == 0);
  fs::remove(file);
}

BOOST_DATA_TEST_CASE(shown_formulas_have_the_right_values, data::make(smallScenes()), file) {
  shownFormulasAreRight(scene::readScene(file).mechanism);
}

BOOST_AUTO_TEST_CASE(shown_formulas_have_the_right_values_in_space) {
  shownFormulasAreRight(spatialArm());
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(derivations)

BOOST_AUTO_TEST_CASE(a_closed_form_has_every_step_of_the_textbook) {
  const Derivation d = derivation(scene::findScene("double_pendulum").mechanism);
  BOOST_TEST(d.closed_form);
  BOOST_TEST(d.holds());
  std::vector<std::string> names;
  for (const Step& s : d.steps) names.push_back(s.name);
  const std::vector<std::string> expected = {"positions",
                                             "velocities",
                                             "kinetic energies of the links",
                                             "kinetic energy T",
                                             "potential energy V",
                                             "momenta p",
                                             "mass matrix M",
                                             "Christoffel symbols",
                                             "Coriolis and centrifugal forces c",
                                             "gravity and springs g",
                                             "equations of motion"};
  BOOST_TEST(names == expected, boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(linearized_equations_are_derivatives_of_those_above_them) {
  const Derivation d = derivation(scene::findScene("double_pendulum").mechanism, true);
  BOOST_TEST(d.holds());
  std::map<std::string, std::string> said;
  for (const Step& step : d.steps)
    for (const StepEquation& e : step.equations)
      said[print(e.left, Style::kText)] = print(e.right, Style::kText);
  // by hand from g2 = m2 g l2 sin(q1 + q2)/2 and c1 = -m2 l1 l2 qd2 (2 qd1 + qd2) sin(q2)/2
  BOOST_TEST(said["H22"] == "1/2*m2*g*l2*cos(q1 + q2)");
  BOOST_TEST(said["D11"] == "-m2*l1*l2*qd2*sin(q2)");
  BOOST_TEST(said["D12"] == "-m2*l1*l2*(qd1 + qd2)*sin(q2)");
  BOOST_TEST(said.count("D22") == 0u);  // c2 has no qd2
  BOOST_CHECK_THROW(derivation(scene::findScene("puma_560").mechanism, true),
                    std::invalid_argument);
}

/// Of a joint's rotor, a link with two parts, an inertia about the link's origin and one turned:
/// what the energies by positions and those by velocities treat differently.
BOOST_AUTO_TEST_CASE(energies_by_positions_are_those_by_velocities) {
  const auto arm = [](const std::string& inertia) {
    return scene::readSceneToml(R"toml(
title = "arm"
source = "this test"
gravity = [0, 0, -10]
[parameters]
m = 2
l = 0.5
[[link]]
name = "base"
[[link]]
name = "turret"
parent = "base"
mass = "m"
com = [0.1, 0, "l/3"]
inertia = { about = "com", xx = 2, yy = 3, zz = 4, xy = 0.5, rpy = [0.3, 0, 0.2] }
[link.joint]
kind = "revolute"
rotor_inertia = 0.01
gear_ratio = 50
gyroscopic = true
[[link]]
name = "boom"
parent = "turret"
mass = "m/2"
com = ["l/2", 0, 0.1]
)toml" + inertia + R"toml(
[link.joint]
kind = "revolute"
xyz = [0, 0.2, 0]
rpy = [1.2, 0, 0.3]
axis = [0, -1, 0]
rotor_inertia = 0.02
gear_ratio = 30
gyroscopic = true
[[link]]
name = "tool"
parent = "boom"
mass = 0.3
com = [0.1, 0.2, 0]
[link.joint]
kind = "fixed"
xyz = ["l", 0, 0]
rpy = [0, 0.4, 0]
)toml",
                                "arm.toml")
        .mechanism;
  };
  for (const char* inertia : {"inertia = { about = \"com\", xx = 1, yy = 1, zz = 1 }",
                              "inertia = { xx = 1, yy = 1, zz = 1, about = \"origin\" }"}) {
    const Derivation d = derivation(arm(inertia));
    BOOST_TEST(d.closed_form);
    for (const Step& step : d.steps) BOOST_TEST(step.holds, step.name);
  }
}

BOOST_AUTO_TEST_CASE(a_large_mechanism_is_derived_as_a_program) {
  const Derivation d = derivation(scene::findScene("puma_560").mechanism);
  BOOST_TEST(!d.closed_form);
  BOOST_TEST(d.holds());
  // every name on a right side was defined on an earlier left side
  const std::regex name("\\b(t[0-9]+|omega[0-9]+[xyz]|v[0-9]+[xyz]|[sI]c[0-9]+[xyz]+)\\b");
  std::set<std::string> defined;
  for (const Step& step : d.steps) {
    for (const Equation& e : step.equations) {
      const std::string right = print(e.right, Style::kText);
      for (std::sregex_iterator i(right.begin(), right.end(), name), end; i != end; ++i)
        BOOST_TEST(defined.count(i->str()) == 1u, i->str() + " in " + step.name);
      defined.insert(print(e.left, Style::kText));
    }
  }
  BOOST_TEST(defined.count("M11") + defined.count("c1") + defined.count("g2") == 3u);
}

/// By hand, as the books print them.
BOOST_AUTO_TEST_CASE(four_joints_have_the_steps_of_the_textbook) {
  const Derivation d = derivation(scene::findScene("scara").mechanism);
  BOOST_TEST(d.holds());
  std::map<std::string, std::string> said;
  for (const Step& step : d.steps)
    for (const StepEquation& e : step.equations) {
      BOOST_TEST((!e.isLine()), print(e, Style::kText) << " in " << step.name);
      said[print(e.left, Style::kText)] = print(e.right, Style::kText);
    }
  BOOST_TEST(said["x_quill"] == "a1*cos(q1) + a2*cos(q1 + q2)");
  BOOST_TEST(said["v_z_flange"] == "-qd3");
  BOOST_TEST(said["T_flange"] ==
             "1/2*m4*(v_x_flange^2 + v_y_flange^2 + v_z_flange^2) + 1/2*I4*omega_z_flange^2");
  BOOST_TEST(said["T"] == "T_link_1 + T_link_2 + T_quill + T_flange");
  BOOST_TEST(said["Gamma214"] == "-0.03*m4*a2*sin(q4)");
  BOOST_TEST(said.count("Gamma111") == 0u);
}

/// Lines are counted in what follows from T in J; by hand of some.
BOOST_AUTO_TEST_CASE(every_line_says_what_it_is_and_its_unit) {
  for (const char* name : {"kuka_iiwa_14", "puma_560", "stanford_arm"}) {
    const Derivation d = derivation(scene::findScene(name).mechanism);
    std::map<std::string, std::string> of;  // line -> noun [unit]
    std::size_t lines = 0;
    for (const Step& step : d.steps)
      for (const StepEquation& e : step.equations) {
        lines += e.isLine() ? 1 : 0;
        if (!e.heading) continue;
        for (const LineGroup::Kind& kind : e.heading->kinds)
          for (const std::string& line : kind.names) {
            BOOST_TEST(!kind.noun.empty(), name << ": " << line);
            of[line] = kind.noun + " [" + kind.unit + "]";
          }
      }
    BOOST_TEST(lines > 50u);
    BOOST_TEST(of.size() >= lines);
    if (std::string(name) != "kuka_iiwa_14") continue;
    BOOST_TEST(of["omega3y"] == "angular velocity [rad/s]");
    BOOST_TEST(of["v3x"] == "velocity [m/s]");
    BOOST_TEST(of["Ic5zz"] == "moment of inertia [kg m^2]");
    BOOST_TEST(of["sc5z"] == "first moment of mass [kg m]");
    // t1 = 0.2045*qd2, where the number is a length
    BOOST_TEST(of["t1"] == "velocity [m/s]");
  }
}

BOOST_AUTO_TEST_CASE(parameters_have_the_units_of_their_places) {
  const auto unitsOf = [](const scene::Mechanism& m) {
    std::map<std::string, std::string> units;
    for (const auto& [name, unit] : parameterUnits(m)) units[name] = unit.text;
    return units;
  };
  const auto scara = unitsOf(scene::findScene("scara").mechanism);
  const std::map<std::string, std::string> by_hand = {
      {"g", "m/s^2"},   {"m1", "kg"},     {"m2", "kg"},     {"m3", "kg"},
      {"m4", "kg"},     {"a1", "m"},      {"a2", "m"},      {"h", "m"},
      {"I1", "kg m^2"}, {"I2", "kg m^2"}, {"I4", "kg m^2"}, {"k3", "N/m"}};
  BOOST_TEST((scara == by_hand));
  // m/(1 + l) is no mass: two things follow of m, and of l
  auto arm = unitsOf(spatialArm());
  BOOST_TEST(arm["alpha"] == "rad");
  BOOST_TEST(arm["k"] == "N m/rad");
  BOOST_TEST(arm.count("l") + arm.count("m") == 0u);
}

BOOST_AUTO_TEST_CASE(a_step_that_fails_is_said_to_fail) {
  Derivation d;
  d.steps = {{"a & b", "sentence", {}, "1 < 2", true}, {"c", "sentence", {}, "2 = 1", false}};
  BOOST_TEST(!d.holds());
  BOOST_TEST(print(d, Style::kText).find("2 = 1: DOES NOT HOLD") != std::string::npos);
  BOOST_TEST(print(d, Style::kMathml).find("class=\"fails\"") != std::string::npos);
  BOOST_TEST(print(d, Style::kMathml).find("a &amp; b") != std::string::npos);
  BOOST_TEST(print(d, Style::kLatex).find("a \\& b") != std::string::npos);
}

BOOST_AUTO_TEST_SUITE_END()
