// SPDX-License-Identifier: GPL-3.0-or-later
// Driven joints: functions of time, bases that move as given against the laws of accelerated
// frames, and the motion of closed mechanisms by every index.
#include "scene/motion.hpp"

#include <cmath>

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/motion/formulations.hpp"
#include "crosscheck/motion/motion_tables.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/build_model.hpp"
#include "recursive/energy.hpp"
#include "recursive/hybrid_dynamics.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

using F = PrimeField;

/// Parameters of a scene without links: what functions of time need of numbers.
scene::Mechanism withParameters(const std::vector<std::pair<std::string, int>>& values) {
  scene::Mechanism mechanism;
  for (const auto& [name, value] : values) mechanism.parameters.push_back({name, value, {}});
  return mechanism;
}

bool near(double a, double b) {
  return std::abs(a - b) <= 1e-14 * (1 + std::abs(b));
}

std::string errorOf(const std::string& joint, const std::string& more = "") {
  try {
    scene::readSceneToml(
        "[parameters]\nA = 1\n[[link]]\nname = \"ground\"\n[[link]]\nname = \"body\"\nparent = "
        "\"ground\"\nmass = 1\ncom = [1, 0, 0]\ninertia = { xx = 1, yy = 1, zz = 1 }\njoint = { " +
            joint + " }\n" + more,
        "driven.toml");
  } catch (const scene::InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

BOOST_AUTO_TEST_SUITE(functions_of_time)

// derivatives by hand
BOOST_AUTO_TEST_CASE(rates_are_those_of_calculus) {
  const scene::Mechanism mechanism = withParameters({{"r", 3}, {"w", 2}, {"L", 7}});
  const scene::RealNumbers<double> number(mechanism);
  const double t = 0.4, w = 2, s = std::sin(w * t), c = std::cos(w * t);
  const auto at = [&](const char* text) {
    return scene::motionAt(scene::Expression::parseOfTime(text), number, t);
  };
  const auto wave = at("r*sin(w*t)");
  BOOST_TEST(near(wave.value, 3 * s));
  BOOST_TEST(near(wave.rate, 6 * c));
  BOOST_TEST(near(wave.second, -12 * s));
  const double u = 3 * s / 7, u1 = 6 * c / 7, u2 = -12 * s / 7, root = std::sqrt(1 - u * u);
  const auto slope = at("asin(r*sin(w*t)/L)");
  BOOST_TEST(near(slope.value, std::asin(u)));
  BOOST_TEST(near(slope.rate, u1 / root));
  BOOST_TEST(near(slope.second, u2 / root + u * u1 * u1 / (root * root * root)));
  const auto mixed = at("exp(-t)*sqrt(1 + t^2)/cos(t)");
  // the logarithm's derivatives: f' / f = -1 + t / (1 + t^2) + tan t, f'' / f = its rate and its
  // square
  const double f = std::exp(-t) * std::sqrt(1 + t * t) / std::cos(t), n = 1 + t * t;
  const double g = -1 + t / n + std::tan(t),
               g1 = (1 - t * t) / (n * n) + 1 + std::tan(t) * std::tan(t);
  BOOST_TEST(near(mixed.value, f));
  BOOST_TEST(near(mixed.rate, f * g));
  BOOST_TEST(near(mixed.second, f * (g * g + g1)));
  BOOST_TEST(near(at("1/t^2").second, 6 / std::pow(t, 4)));
}

// (p / q)'' of polynomials over a field: f q = p differentiated twice, without rounding
BOOST_AUTO_TEST_CASE(quotients_of_polynomials_are_exact) {
  const PrimeField::Modulus modulus(drawPrime("motion", 1, 0));
  const FieldSource source("motion", 1, 0);
  const scene::Mechanism mechanism = withParameters({{"a", 5}});
  const FieldNumbers number(mechanism, source, Parameters::kAsWritten);
  const F t = source.element("t");
  const auto at = [&](const char* text) {
    return scene::motionAt(scene::Expression::parseOfTime(text), number, t);
  };
  const auto f = at("(a*t^3 - 2)/(t^2 + a)"), p = at("a*t^3 - 2"), q = at("t^2 + a");
  BOOST_TEST((f.value * q.value == p.value));
  BOOST_TEST((f.rate * q.value + f.value * q.rate == p.rate));
  BOOST_TEST((f.second * q.value + F(2) * f.rate * q.rate + f.value * q.second == p.second));
  BOOST_TEST((p.second == F(30) * t));
}

BOOST_AUTO_TEST_CASE(what_is_no_motion_is_refused) {
  const auto says = [](const std::string& message, const std::string& part) {
    return message.find(part) != std::string::npos;
  };
  BOOST_TEST(errorOf("kind = \"revolute\", motion = \"sin(A*t)\"") == "");
  BOOST_TEST(errorOf("kind = \"planar\", motion = [\"t\", 0, \"A*t\"]") == "");
  BOOST_TEST(
      says(errorOf("kind = \"revolute\", motion = \"tan(t)\""),
           "driven.toml:11: joint \"body\": motion: expression \"tan(t)\": no function \"tan\", "
           "allowed: sin, "
           "cos, asin, sqrt, exp"));
  BOOST_TEST(
      says(errorOf("kind = \"revolute\", motion = \"B*t\""), "parameter \"B\" is not defined"));
  BOOST_TEST(says(errorOf("kind = \"planar\", motion = \"t\""),
                  "1 functions of t, allowed: one a position of the joint, 3"));
  BOOST_TEST(says(errorOf("kind = \"spherical\", motion = \"t\""), "unknown key \"motion\""));
  BOOST_TEST(says(errorOf("kind = \"revolute\", motion = \"sqrt(t)\""),
                  "outside the domain of sqrt at t = 0"));
  BOOST_TEST(says(errorOf("kind = \"revolute\", motion = \"1/t\""), "not finite at t = 0"));
  BOOST_TEST(says(errorOf("kind = \"revolute\", xyz = [\"sin(t)\", 0, 0]"),
                  "\"sin(t)\" is a function of parameter \"t\""));
  const std::string free = "kind = \"revolute\"";
  BOOST_TEST(says(errorOf(free, "[[acceleration_constraint]]\nlink = \"body\"\n"),
                  "direction and rotation are zero"));
  BOOST_TEST(
      says(errorOf(free, "[[acceleration_constraint]]\nlink = \"ground\"\ndirection = [1, 0, 0]\n"),
           "the root rests in the world"));
  BOOST_TEST(says(
      errorOf(free,
              "[[acceleration_constraint]]\nlink = \"body\"\ndirection = [1, 0, 0]\ncompliance = "
              "-1\n"),
      "compliance is -1, allowed: zero or more"));
}

BOOST_AUTO_TEST_CASE(a_scene_is_like_one_that_exists_and_stands_alone) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      scene::readSceneToml(text, scene::dataFolder() / "scenes" / "mine.toml");
    } catch (const scene::InputError& error) {
      return error.what();
    }
    return "";
  };
  BOOST_TEST(message("like = \"double_pendulum\"\n") == "");
  BOOST_TEST(message("like = \"nobody\"\n")
                 .find("mine.toml:1: like is \"nobody\", allowed: a TOML, URDF or MJCF "
                       "file") != std::string::npos);
  BOOST_TEST(
      message("like = \"humanoid_left_foot\"\n").find("which is like a third scene itself") !=
      std::string::npos);
  BOOST_TEST(message("like = \"double_pendulum\"\ngravity = [0, 0, 0]\n") == "");
  BOOST_TEST(message("like = \"double_pendulum\"\nlink = []\n").find("unknown key \"link\"") !=
             std::string::npos);
  BOOST_TEST(message("like = \"double_pendulum\"\n[set]\n\"mass:lower\" = -1\n")
                 .find("mine.toml:3: link \"lower\": mass is -1 kg") != std::string::npos);
  BOOST_TEST(message("like = \"double_pendulum\"\n[set]\n\"mass:lover\" = 1\n")
                 .find("mine.toml:3: set: \"mass:lover\": no link 'lover' (did you mean lower?)") !=
             std::string::npos);
  BOOST_TEST(message("like = \"double_pendulum\"\n[set]\nl1 = 1\n")
                 .find("parameters stand in [parameters]") != std::string::npos);
  BOOST_TEST(message("like = \"double_pendulum\"\n\nbase = \"fixed\"\n")
                 .find("mine.toml:3: base = \"fixed\": no link floats") != std::string::npos);
  BOOST_TEST(message("like = \"double_pendulum\"\n[parameters]\nm1 = \"2*m2\"\n")
                 .find("mine.toml:3: parameter \"m1\": uses \"m2\" before it is defined") !=
             std::string::npos);
  BOOST_TEST(message("gravity = [0, 0, 0]\nbase = \"floating\"\n").find("unknown key \"base\"") !=
             std::string::npos);
}

BOOST_AUTO_TEST_CASE(driven_scenes_survive_being_written) {
  for (const char* name : {"car_axis", "two_handed"}) {
    const std::string text = scene::writeSceneToml(scene::findScene(name));
    BOOST_TEST(scene::writeSceneToml(scene::readSceneToml(text, "again.toml")) == text);
    BOOST_TEST(text.find("motion = ") != std::string::npos);
  }
}

BOOST_AUTO_TEST_SUITE_END()
BOOST_AUTO_TEST_SUITE(accelerated_frames)

// Einstein's lift: on a base that accelerates by a along x, whatever its place and speed,
// everything moves as under gravity g - a.
BOOST_DATA_TEST_CASE(an_accelerated_base_is_another_gravity, data::xrange(6u), seed) {
  const scene::Scene still = randomTreeScene(seed, 0, 6);
  if (still.mechanism.dof() == 0) return;
  scene::Scene lift = still;
  std::vector<scene::Link>& links = lift.mechanism.links;
  for (scene::Link& link : links)
    if (link.parent >= 0) ++link.parent;
  scene::Link carrier;
  carrier.name = "carrier";
  carrier.parent = 0;
  carrier.joint.kind = scene::JointKind::kPrismatic;
  carrier.joint.axis = {scene::Number(1), scene::Number(0), scene::Number(0)};
  links.insert(links.begin() + 1, carrier);
  lift.mechanism.wrenches.clear();  // those of the scene name links by index
  scene::Scene fixed = still;
  fixed.mechanism.wrenches.clear();

  const PrimeField::Modulus modulus(drawPrime("lift", seed, 0));
  const FieldSource source("lift", seed, 0);
  const FieldNumbers number(lift.mechanism, source, Parameters::kAsWritten);
  scene::State<F> state = indeterminateState(lift.mechanism, source);
  const auto model = recursive::buildModel(lift.mechanism, number);
  auto of_fixed = recursive::buildModel(fixed.mechanism, number);
  recursive::Workspace<F> ws(model), ws_fixed(of_fixed);
  recursive::ConstraintWorkspace<F> none(model, 0);
  std::vector<char> driven(model.dof(), 0);
  driven[0] = 1;
  std::vector<F> qdd = state.qdd, tau = state.tau;
  recursive::hybridDynamics(model, state.x, state.qd, driven, {}, ws, none, qdd, tau);

  of_fixed.gravity.x() -= state.qdd[0];
  scene::State<F> rest = state;
  rest.x.erase(rest.x.begin());
  for (std::vector<F>* v : {&rest.qd, &rest.qdd, &rest.tau}) v->erase(v->begin());
  std::vector<F> expected = rest.qdd;
  recursive::forwardDynamics(of_fixed, rest.x, rest.qd, rest.tau, ws_fixed, expected);
  for (std::size_t i = 0; i < expected.size(); ++i) BOOST_TEST((qdd[i + 1] == expected[i]));
}

// Coriolis: on a table that turns at w and gains wd, a chain of point masses moves as on the ground
// under the forces -m (w x (w x p) + 2 w x v + wd x p) on each of them, p and v seen from the
// table.
BOOST_DATA_TEST_CASE(a_spinning_base_is_centrifugal_and_coriolis_forces, data::xrange(4u), seed) {
  const std::string chain =
      "[[link]]\nname = \"one\"\nparent = \"BASE\"\nmass = 2\ncom = [1, 2, 3]\n"
      "joint = { kind = \"revolute\", axis = [1, 0, 0], xyz = [0.3, 0.2, 0.1] }\n"
      "[[link]]\nname = \"two\"\nparent = \"one\"\nmass = 3\ncom = [0.5, -1, 0.7]\n"
      "joint = { kind = \"prismatic\", axis = [0, 1, 0], xyz = [0.2, 0, 1] }\n"
      "[[link]]\nname = \"three\"\nparent = \"two\"\nmass = 1\ncom = [0.4, 0.6, -2]\n"
      "joint = { kind = \"revolute\", xyz = [0, 0.7, 0.3] }\n";
  const auto on = [&](const std::string& base) {
    std::string text = chain;
    text.replace(text.find("BASE"), 4, base);
    return scene::readSceneToml(
        "gravity = [0, 0, -9.81]\n[[link]]\nname = \"ground\"\n" +
            (base == "ground" ? std::string()
                              : "[[link]]\nname = \"table\"\nparent = \"ground\"\nmass = "
                                "1\ninertia = { zz = 1, xx = 1 }\njoint = { kind = "
                                "\"revolute\" }\n") +
            text,
        "table.toml");
  };
  const scene::Scene table = on("table"), ground = on("ground");
  const PrimeField::Modulus modulus(drawPrime("table", seed, 0));
  const FieldSource source("table", seed, 0);
  const FieldNumbers number(table.mechanism, source, Parameters::kAsWritten);
  scene::State<F> state = indeterminateState(table.mechanism, source);
  state.x[0] = {F(0), F(1), F(0)};  // the table's axes are the ground's just now
  const auto model = recursive::buildModel(table.mechanism, number);
  recursive::Workspace<F> ws(model);
  recursive::ConstraintWorkspace<F> none(model, 0);
  std::vector<F> qdd = state.qdd, tau = state.tau;
  recursive::hybridDynamics(model, state.x, state.qd, {1, 0, 0, 0}, {}, ws, none, qdd, tau);

  auto still = recursive::buildModel(ground.mechanism, number);
  recursive::Workspace<F> ws_still(still);
  scene::State<F> rest = state;
  rest.x.erase(rest.x.begin());
  for (std::vector<F>* v : {&rest.qd, &rest.qdd, &rest.tau}) v->erase(v->begin());
  recursive::linkVelocities(still, rest.x, rest.qd, ws_still);
  const recursive::Vector3<F> w(F(0), F(0), state.qd[0]), wd(F(0), F(0), state.qdd[0]);
  recursive::Transform<F> X = recursive::Transform<F>::identity();
  std::vector<recursive::WorldLoad<F>> loads;
  for (int i = 0; i < 3; ++i) {
    X = ws_still.X_up[i] * X;
    const F& m = still.links[i].M.mass;
    const recursive::Vector3<F> com = still.links[i].M.h * m.inverse();
    const recursive::Vector3<F> p = X.p + X.R.transpose() * com;
    const recursive::Vector3<F> v =
        X.R.transpose() * (ws_still.v[i].linear + ws_still.v[i].angular.cross(com));
    const recursive::Vector3<F> force =
        (w.cross(w.cross(p)) + w.cross(v) * F(2) + wd.cross(p)) * -m;
    loads.push_back({i, force, recursive::Vector3<F>::Zero(), com});
  }
  still.world_loads = loads;
  std::vector<F> expected = rest.qdd;
  recursive::forwardDynamics(still, rest.x, rest.qd, rest.tau, ws_still, expected);
  for (std::size_t i = 0; i < 3; ++i) BOOST_TEST((qdd[i + 1] == expected[i]));
}

// theta'' = W^2 sin theta cos theta - g/R sin theta, by hand, against the scene's simulation
BOOST_AUTO_TEST_CASE(a_bead_on_a_spinning_hoop_moves_as_by_hand) {
  SimulateOptions options;
  options.duration = 5;
  options.outputs = 20;
  options.step_error = 1e-12;
  const Simulation simulation = simulate(scene::findScene("bead_on_hoop"), options);
  using State = std::array<double, 2>;
  namespace odeint = boost::numeric::odeint;
  auto stepper = odeint::make_controlled(1e-12, 1e-12, odeint::runge_kutta_fehlberg78<State>());
  State y = {0.5, 0};
  double worst = 0;
  for (std::size_t k = 1; k < simulation.points.size(); ++k) {
    odeint::integrate_adaptive(
        stepper,
        [](const State& s, State& rate, double) {
          rate = {s[1], std::sin(s[0]) * (36 * std::cos(s[0]) - 9.81 / 0.5)};
        },
        y, simulation.points[k - 1].time, simulation.points[k].time, 1e-3);
    worst = std::max(worst, std::abs(simulation.points[k].q[1] - y[0]));
    BOOST_TEST(near(simulation.points[k].q[0], 6 * simulation.points[k].time));
  }
  BOOST_TEST(worst <= 1e-10);  // both at 1e-12 a step, some 200 steps
  // the energy changes by what the drive does, 0.05 J and more
  BOOST_TEST(simulation.worst_energy <= 1e-11);
}

// the theory of the averaged motion: upright is stable where a w > sqrt(2 g L), L = 2 l / 3: w >
// 80.9 / s
BOOST_AUTO_TEST_CASE(kapitzas_pendulum_stands_where_averaging_says_so) {
  const auto farthest = [](const char* w) {
    scene::Scene scene = scene::findScene("kapitza_pendulum");
    for (scene::Parameter& p : scene.mechanism.parameters)
      if (p.name == "w") p.value = scene::Number::parse(w);
    SimulateOptions options;
    options.duration = 3;
    options.outputs = 300;
    double most = 0;
    for (const Simulation::Point& point : simulate(scene, options).points)
      most = std::max(most, std::abs(point.q[1] - 3.14159265));
    return most;
  };
  BOOST_TEST(farthest("200") < 0.5);
  BOOST_TEST(farthest("100") < 0.8);
  BOOST_TEST(farthest("60") > 3);
}

// a driven body's inertia is the drive's concern alone
BOOST_AUTO_TEST_CASE(the_inertia_of_what_is_driven_makes_no_difference) {
  scene::Scene scene = scene::findScene("kapitza_pendulum");
  std::vector<F> qdd[2], tau[2];
  for (const int heavy : {0, 1}) {
    if (heavy) scene.mechanism.links[1].inertia.mass = scene::Number(1000);
    const PrimeField::Modulus modulus(drawPrime("inertia", 1, 0));
    const FieldSource source("inertia", 1, 0);
    const FieldNumbers number(scene.mechanism, source, Parameters::kAsWritten);
    const scene::State<F> state = indeterminateState(scene.mechanism, source);
    const auto model = recursive::buildModel(scene.mechanism, number);
    recursive::Workspace<F> ws(model);
    recursive::ConstraintWorkspace<F> none(model, 0);
    qdd[heavy] = state.qdd;
    tau[heavy] = state.tau;
    recursive::hybridDynamics(model, state.x, state.qd, {1, 0}, {}, ws, none, qdd[heavy],
                              tau[heavy]);
  }
  BOOST_TEST((qdd[0][1] == qdd[1][1]));
  BOOST_TEST((tau[0][0] != tau[1][0]));
}

BOOST_AUTO_TEST_SUITE_END()
BOOST_AUTO_TEST_SUITE(index_1_2_and_3)

namespace {

Simulation run(const scene::Scene& scene, double duration, Formulation formulation, double step,
               const char* method = "radau_iia_5") {
  SimulateOptions options;
  options.duration = duration;
  options.outputs = 1;
  options.method = method;
  options.formulation = formulation;
  options.stabilisation = Stabilisation::kNone;
  options.step = step;
  for (const MotionTable& table : motionTables(scene))
    for (const MotionTable::Row& row : table.rows) options.more_times.push_back(row.time);
  return simulate(scene, options);
}

/// Errors of the pendulum of A01 after 1 s, against the elliptic functions: of q, qd and the rod's
/// force.
std::array<double, 3> pendulumErrors(Formulation formulation, double step, const char* method) {
  const Simulation simulation =
      run(scene::findScene("pendulum_on_slides"), 1, formulation, step, method);
  const Simulation::Point& end = simulation.points.back();
  const double k = std::sqrt(0.5), w = std::sqrt(9.81), K = boost::math::ellint_1(k);
  double cn, dn;
  const double half = k * boost::math::jacobi_elliptic(k, K - w * end.time, &cn, &dn);
  // x = -2 s sqrt(1 - s^2), y = 2 s^2 - 1 with s = sin(angle/2) = k sn; v^2 = -2 g y, speed along
  // the tangent
  const double x = -2 * half * std::sqrt(1 - half * half), y = 2 * half * half - 1;
  const double speed = std::sqrt(-2 * 9.81 * y);
  const double rate = -w * k * cn * dn;  // of sin(angle/2): its sign says which way
  const double sign =
      (4 * half * rate) * x > 0 ? 1 : -1;          // y' = tangent_y speed, tangent = (-y, x)
  const double lambda = 9.81 * y - speed * speed;  // rod: m (a . r) = lambda + m g . r with |r| = 1
  return {std::hypot(end.q[0] - x, end.q[1] - y),
          std::hypot(end.qd[0] + sign * speed * y, end.qd[1] - sign * speed * x),
          std::abs(end.lambda[0] - lambda)};
}

struct Order {
  const char* method;
  Formulation formulation;
  double q, qd, lambda;  ///< 0: not looked at
};
std::ostream& operator<<(std::ostream& out, const Order& o) {
  return out << o.method << " " << name(o.formulation);
}

// RadauIIA's documentation has the theory: 2 s - 1 for what is differential, s and s - 1 for the
// rest. At index 1 multipliers follow from q and qd, with their order.
const Order kOrders[] = {{"radau_iia_5", Formulation::kIndex1, 5, 5, 0},
                         {"radau_iia_5", Formulation::kIndex2, 5, 5, 3},
                         {"radau_iia_5", Formulation::kIndex3, 5, 3, 2},
                         {"radau_iia_5", Formulation::kGgl, 5, 5, 3},
                         {"radau_iia_3", Formulation::kIndex1, 3, 3, 0},
                         {"radau_iia_3", Formulation::kIndex2, 3, 3, 2},
                         {"radau_iia_3", Formulation::kIndex3, 3, 2, 1},
                         {"radau_iia_3", Formulation::kGgl, 3, 3, 2},
                         {"implicit_euler", Formulation::kIndex2, 1, 1, 1}};

}  // namespace

BOOST_DATA_TEST_CASE(errors_fall_with_the_order_of_theory, data::make(kOrders), order) {
  const double h = order.method[0] == 'i' ? 1.0 / 2000 : 1.0 / 80;
  const auto coarse = pendulumErrors(order.formulation, h, order.method),
             fine = pendulumErrors(order.formulation, h / 2, order.method);
  const double expected[] = {order.q, order.qd, order.lambda};
  for (int k = 0; k < 3; ++k) {
    if (expected[k] == 0) continue;
    const double observed = std::log2(coarse[k] / fine[k]);
    // half an order: the terms beyond the leading one are a few percent of it at these steps
    BOOST_TEST_CONTEXT("quantity " << k << ": errors " << coarse[k] << " and " << fine[k])
    BOOST_TEST(std::abs(observed - expected[k]) < 0.5);
  }
}

// what each form keeps, it keeps to rounding, and what it does not drifts
BOOST_AUTO_TEST_CASE(every_form_keeps_what_it_solves_for) {
  const scene::Scene scene = scene::findScene("car_axis");
  const Simulation first = run(scene, 3, Formulation::kIndex1, 0.004),
                   second = run(scene, 3, Formulation::kIndex2, 0.004),
                   third = run(scene, 3, Formulation::kIndex3, 0.004),
                   both = run(scene, 3, Formulation::kGgl, 0.004);
  constexpr double kRounding = 1e-14, kOverStep = kRounding / 0.004;  // phi of 1 m; phi' of phi / h
  BOOST_TEST(second.worst_phi_rate < kOverStep);
  BOOST_TEST(third.worst_phi < kRounding);
  BOOST_TEST(both.worst_phi < kRounding);
  BOOST_TEST(both.worst_phi_rate < kOverStep);
  BOOST_TEST(first.worst_phi > 100 * kRounding);
  BOOST_TEST(second.worst_phi > 100 * kRounding);
  BOOST_TEST(third.worst_phi_rate > 100 * kOverStep);
}

// The published values with multipliers: 1e-11 by index 1; by the others with the error of their
// step.
BOOST_AUTO_TEST_CASE(car_axis_reaches_the_published_values) {
  const scene::Scene scene = scene::findScene("car_axis");
  const MotionTable table = motionTables(scene).at(0);
  BOOST_TEST(table.columns.size() == 10u);
  SimulateOptions options;
  options.duration = 3;
  options.step_error = table.step_error;
  options.more_times = {3};
  const MotionVerdict exact = compareMotion(scene, simulate(scene, options), table);
  BOOST_TEST_MESSAGE("car axis, index 1: " << exact.worst);
  BOOST_TEST(exact.values == 10);
  BOOST_TEST(exact.ratio <= 1);
  for (const Formulation formulation :
       {Formulation::kIndex1, Formulation::kIndex2, Formulation::kIndex3, Formulation::kGgl}) {
    const double coarse = compareMotion(scene, run(scene, 3, formulation, 0.004), table).worst,
                 fine = compareMotion(scene, run(scene, 3, formulation, 0.002), table).worst;
    BOOST_TEST_MESSAGE(name(formulation) << ": " << coarse << ", " << fine);
    BOOST_TEST(fine < 1e-6);
    BOOST_TEST(fine < coarse / 6);  // order 3 at least, that of index 3's rates
  }
}

BOOST_AUTO_TEST_CASE(the_comparison_has_every_form_and_measures_them) {
  SimulateOptions options;
  options.duration = 0.5;
  options.outputs = 5;
  options.step = 0.002;
  const FormulationComparison comparison =
      compareFormulations(scene::findScene("car_axis"), options);
  BOOST_TEST(comparison.runs.size() == 8u);
  for (const FormulationRun& run : comparison.runs) {
    BOOST_TEST(run.failure == "");
    BOOST_TEST(run.q_error < 1e-6);
    BOOST_TEST(run.q_error > 0);
    BOOST_TEST((run.lambda_error && *run.lambda_error < 1e-3 * comparison.most_lambda));
  }
}

BOOST_AUTO_TEST_CASE(what_does_not_go_together_is_refused) {
  const scene::Scene scene = scene::findScene("car_axis");
  const auto message = [&](SimulateOptions options) -> std::string {
    options.duration = 0.1;
    try {
      simulate(scene, options);
    } catch (const scene::InputError& error) {
      return error.what();
    }
    return "";
  };
  SimulateOptions options;
  options.formulation = Formulation::kIndex3;
  BOOST_TEST(message(options).find("allowed: radau_iia_5") != std::string::npos);
  options.method = "radau_iia_5";
  BOOST_TEST(message(options).find("index 1 alone is stabilised") != std::string::npos);
  options.stabilisation = Stabilisation::kNone;
  options.step = 0;
  BOOST_TEST(message(options).find("step is 0 s, allowed: positive") != std::string::npos);
  options.step = 0.001;
  BOOST_TEST(message(options) == "");
}

BOOST_AUTO_TEST_SUITE_END()
