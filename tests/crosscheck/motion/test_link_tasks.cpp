// SPDX-License-Identifier: GPL-3.0-or-later
// Acceleration constraints and controllers along motions: closed forms, and torques by the sweeps
// for tasks.
#include "crosscheck/motion/link_tasks.hpp"

#include <cmath>
#include <ostream>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/motion/simulate.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/acceleration_constraints.hpp"
#include "recursive/operational_space.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using Tasks = Controller::Tasks;

namespace {

/// 2 kg on a vertical slide, and what is done to it.
scene::Scene weight(const std::string& more) {
  return scene::readSceneToml(R"(
title = "x"
source = "x"
gravity = [0, 0, -10]
[[link]]
name = "base"
[[link]]
name = "weight"
parent = "base"
mass = 2
joint = { kind = "prismatic", axis = [0, 0, 1] }
)" + more,
                              "weight.toml");
}

/// Three links in a vertical plane; the tip's way along x is asked for.
scene::Scene arm(const std::string& task, const std::string& qd = "[0.2, -0.4, 0.3]") {
  std::string links, parent = "base";
  for (const char* name : {"a", "b", "c"}) {
    links += std::string("[[link]]\nname = \"") + name + "\"\nparent = \"" + parent +
             "\"\nmass = 1\ncom = [0.2, 0, 0]\ninertia = { yy = 0.02, zz = 0.02 }\n"
             "joint = { kind = \"revolute\", axis = [0, 1, 0]" +
             (parent == "base" ? "" : ", xyz = [0.4, 0, 0]") + " }\n";
    parent = name;
  }
  return scene::readSceneToml(
      "title = \"x\"\nsource = \"x\"\ngravity = [0, 0, -9.81]\n[[link]]\nname = \"base\"\n" +
          links + "[[acceleration_constraint]]\nlink = \"c\"\nat = [0.4, 0, 0]\n" + task +
          "[start]\nq = [0.3, 0.5, -0.9]\nqd = " + qd + "\n",
      "arm.toml");
}

/// Half a second: after 0.85 s the arm is stretched and cannot do its task.
Simulation moved(const scene::Scene& scene, const Controller& controller, double duration = 0.5,
                 double step_error = 1e-12) {
  SimulateOptions options;
  options.duration = duration;
  options.outputs = 10;
  options.step_error = step_error;
  options.controller = controller;
  return simulate(scene, options);
}

/// What steps of such an error may leave: each of them its own, times what motion makes of it.
double left(const Simulation& simulation, double step_error) {
  return 100 * step_error * static_cast<double>(simulation.steps);
}

const std::string kUp = "[[acceleration_constraint]]\nlink = \"weight\"\ndirection = [0, 0, 1]\n";

/// x of  x'' + damping x' + stiffness x = -g,  at rest at 0, by hand, underdamped.
double sagging(double stiffness, double damping, double g, double t) {
  const double decay = damping / 2, w = std::sqrt(stiffness - decay * decay),
               x_end = -g / stiffness;
  return x_end * (1 - std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t)));
}

}  // namespace

// By hand: nu = m (g + value); z = value t^2 / 2; the constraint's work is all of T + V.
BOOST_AUTO_TEST_CASE(a_constraint_lifts_a_weight_as_its_value_says) {
  const Simulation simulation = moved(weight(kUp + "value = 0.5\n"), {});
  for (const Simulation::Point& point : simulation.points) {
    const double z = point.time * point.time / 4;
    BOOST_TEST(std::abs(point.q[0] - z) < 1e-12);
    BOOST_TEST(std::abs(point.nu[0] - 21) < 1e-12);
    BOOST_TEST(std::abs(point.work - 21 * z) < 1e-11);
  }
  BOOST_REQUIRE(simulation.tasks.size() == 1u);
  BOOST_TEST(simulation.tasks[0].worst_place < 1e-12);
  BOOST_TEST(simulation.worst_energy < 1e-11);
}

// By hand: qdd + C nu = value and m qdd = nu - m g give (m + 1 / C) qdd = value / C - m g.
BOOST_AUTO_TEST_CASE(a_constraint_that_gives_way_is_inertia) {
  const Simulation simulation = moved(weight(kUp + "compliance = 0.125\nvalue = 0.5\n"), {});
  for (const Simulation::Point& point : simulation.points) {  // 10 qdd = 4 - 20
    BOOST_TEST(std::abs(point.q[0] + 0.8 * point.time * point.time) < 1e-12);
    BOOST_TEST(std::abs(point.nu[0] - 16.8) < 1e-12);
  }
  BOOST_TEST(simulation.tasks[0].yields);
  BOOST_TEST(simulation.worst_energy < 1e-11);
}

// An impedance and a posture at one slide are the same spring and damper, and sag alike.
BOOST_AUTO_TEST_CASE(an_impedance_and_a_posture_sag_as_damped_springs) {
  Controller impedance, posture;
  impedance.tasks = Tasks::kImpedance;
  impedance.task_stiffness = posture.posture_stiffness = 80;
  impedance.task_damping = posture.posture_damping = 6;
  for (const Simulation& simulation : {moved(weight(kUp), impedance), moved(weight(""), posture)}) {
    for (const Simulation::Point& point : simulation.points)
      BOOST_TEST(std::abs(point.q[0] - sagging(40, 3, 10, point.time)) <= left(simulation, 1e-12));
    BOOST_TEST(simulation.worst_energy <= left(simulation, 1e-12) * 100);  // N, of tens of newtons
    BOOST_TEST(std::abs(simulation.points.back().work) > 1);
  }
}

// Torques by the sweeps for tasks, and what forward dynamics makes of them, at the states that the
// simulation went through: it solves one system with multipliers instead.
BOOST_DATA_TEST_CASE(an_operational_space_controller_is_the_sweeps_torque,
                     data::make({"direction = [1, 0, 0]\nvalue = 0.3\n",
                                 "direction = [1, 0, 0]\nvalue = 0.3\n[[acceleration_constraint]]\n"
                                 "link = \"c\"\nrotation = [0, 1, 0]\naxes = \"link\"\n"}),
                     task) {
  const scene::Scene scene = arm(task);
  Controller controller;
  controller.tasks = Tasks::kOperationalSpace;
  controller.posture_stiffness = 5;
  controller.posture_damping = 1;
  const Simulation simulation = moved(scene, controller);
  const scene::RealNumbers<double> number(scene.mechanism);
  const auto model = recursive::buildModel(scene.mechanism, number);
  recursive::Workspace<double> ws(model);
  for (const Simulation::Point& point : simulation.points) {
    std::vector<scene::JointPosition<double>> x;
    std::vector<double> tau, qdd(3);
    for (int i = 0; i < 3; ++i) {
      x.push_back(scene::jointPosition(point.q[i]));
      tau.push_back(5 * (simulation.points[0].q[i] - point.q[i]) - point.qd[i]);
    }
    const auto tasks =
        recursive::accelerationConstraints(scene.mechanism, number, model, x, point.qd, ws);
    recursive::ConstraintWorkspace<double> cws(model, static_cast<int>(tasks.size()));
    recursive::taskTorque(model, x, point.qd, tasks, ws, cws, tau);
    recursive::forwardDynamics(model, x, point.qd, tau, ws, qdd);
    // 1e-12 of accelerations of tens: condition numbers of three links
    for (int i = 0; i < 3; ++i) BOOST_TEST(std::abs(qdd[i] - point.qdd[i]) < 1e-11);
  }
  for (const Simulation::Task& kept : simulation.tasks)
    BOOST_TEST(kept.worst_rate <= left(simulation, 1e-12));
  BOOST_TEST(simulation.worst_energy <= left(simulation, 1e-12) * 10);
}

// The place of the tip by the kinematics of the drawing: nothing but the integrator moves it off.
BOOST_AUTO_TEST_CASE(a_tip_goes_where_its_acceleration_takes_it) {
  const scene::Scene scene = arm("direction = [1, 0, 0]\nvalue = 0.3\n");
  const Simulation simulation = moved(scene, {});
  scene::Attachment tip;
  tip.link = 3;
  tip.xyz = {scene::Number::parse("0.4"), scene::Number(0), scene::Number(0)};
  const auto path = pathOf(scene, simulation, tip);
  // xd(0) by hand: x = sum of l cos(q1 + .. + qk), turned about y
  double x_rate = 0, turned = 0, turning = 0;
  for (int k = 0; k < 3; ++k) {
    turned += simulation.points[0].q[k];
    turning += simulation.points[0].qd[k];
    x_rate -= 0.4 * std::sin(turned) * turning;
  }
  for (std::size_t k = 0; k < path.size(); ++k) {
    const double t = simulation.points[k].time;
    BOOST_TEST(std::abs(path[k][0] - path[0][0] - x_rate * t - 0.15 * t * t) <=
               left(simulation, 1e-12));
  }
}

// Long equal steps let a constraint drift with their order; gains pull the task back.
BOOST_AUTO_TEST_CASE(gains_hold_what_a_constraint_lets_drift) {
  const scene::Scene scene = arm("direction = [1, 0, 0]\n", "[0, 0, 0]");
  SimulateOptions options;
  options.method = "runge_kutta4";
  options.duration = 5;
  struct Off {
    double place, energy;
  };
  const auto off = [&](double step, bool has_gains) {
    options.step = step;
    options.controller = {};
    options.controller.posture_stiffness = 40;
    options.controller.posture_damping = 1;
    if (has_gains) {
      options.controller.tasks = Tasks::kOperationalSpace;
      options.controller.task_stiffness = 100;
      options.controller.task_damping = 20;
    }
    const Simulation simulation = simulate(scene, options);
    return Off{simulation.tasks[0].worst_place, simulation.worst_energy};
  };
  // measured: 4.0e-7 and 2.6e-8 m, with gains 1.1e-9 m; 4.8e-7 and 3.3e-8 J
  const Off loose = off(0.005, false), half = off(0.0025, false), held = off(0.005, true);
  BOOST_TEST(held.place < loose.place / 100);
  for (const double ratio : {loose.place / half.place, loose.energy / half.energy})
    BOOST_TEST(std::abs(std::log2(ratio) - 4) < 0.3);
}

// A waist that turns as driven, hands held, one of them soft; and a floating base that is held.
BOOST_DATA_TEST_CASE(energy_balances_with_what_holds_and_drives,
                     data::make({"two_handed", "satellite_held"}), name) {
  const Simulation simulation = moved(scene::findScene(name), {}, 0.5, 1e-11);
  BOOST_TEST(std::abs(simulation.points.back().work) > 1e-4);
  BOOST_TEST(simulation.worst_energy <= left(simulation, 1e-11) * 100);
  for (const Simulation::Task& task : simulation.tasks)
    if (task.has_rate && !task.yields)
      BOOST_TEST(task.worst_rate <= left(simulation, 1e-11), task.name);
}

BOOST_AUTO_TEST_CASE(what_no_controller_can_do_is_refused) {
  const auto refuses = [](const scene::Scene& scene, const SimulateOptions& options,
                          const std::string& part) {
    BOOST_CHECK_EXCEPTION(simulate(scene, options), scene::InputError,
                          [&](const scene::InputError& error) {
                            return std::string(error.what()).find(part) != std::string::npos;
                          });
  };
  SimulateOptions options;
  options.controller.tasks = Tasks::kImpedance;
  refuses(scene::findScene("double_pendulum"), options, "has no acceleration_constraint");
  options.controller = {};
  options.controller.task_stiffness = 1;
  refuses(weight(kUp), options, "allowed: a controller");
  options.controller = {};
  options.controller.posture_damping = -1;
  refuses(weight(kUp), options, "damping of the posture is -1");
  options.controller = {};
  options.method = "radau_iia_5";
  refuses(weight(kUp), options, "allowed: explicit ones");
  options.method = "runge_kutta_fehlberg78";
  BOOST_CHECK_THROW(simulate(weight(kUp + "value = 1\n" + kUp + "value = 2\n"), options),
                    std::runtime_error);  // they contradict each other
}
