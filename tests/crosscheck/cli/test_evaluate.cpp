// SPDX-License-Identifier: GPL-3.0-or-later
// What evaluate takes for granted: nothing. Accelerations that were not given are found or asked
// for, and states that leave closures open are told.
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/motion/closure_gap.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "tests/fixtures/program.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
using fixtures::Outcome;
using fixtures::Program;
using fixtures::refuses;

namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// The second line of what a command says.
std::vector<double> numbers(const std::string& text) {
  std::vector<double> out;
  const char* at = text.c_str() + text.find('\n') + 1;
  for (int used = 0; *at != '\n' && *at != 0; at += used + (at[used] == ',' ? 1 : 0)) {
    double x = 0;
    BOOST_REQUIRE(std::sscanf(at, "%lf%n", &x, &used) == 1);
    out.push_back(x);
  }
  return out;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(accelerations)

// By hand: the simple pendulum has m = l = 1, g = 9.81, and with tau = 2 at q = 1/2 qdd = 2 - 9.81
// sin(1/2); the pivot holds m (g cos q + l qd^2) along the rod and what is left across it.
BOOST_AUTO_TEST_CASE(qdd_is_found_from_tau_where_it_is_not_given) {
  const Program program;
  program.write("s.csv", "q1,qd1,tau1\n0.5,3,2\n");
  const std::string words = "evaluate simple_pendulum --quantity tau,reactions,qdd --states s.csv";
  const std::vector<double> row = numbers(program.run(words, "2>/dev/null").out);
  BOOST_REQUIRE(row.size() == 8u);
  const double qdd = 2 - 9.81 * std::sin(0.5);
  BOOST_TEST(row[0] == 2, boost::test_tools::tolerance(1e-15));
  BOOST_TEST(row[1] == -(qdd + 9.81 * std::sin(0.5)), boost::test_tools::tolerance(1e-14));
  BOOST_TEST(row[3] == 9.81 * std::cos(0.5) + 9, boost::test_tools::tolerance(1e-15));
  BOOST_TEST(row[7] == qdd, boost::test_tools::tolerance(1e-15));
  BOOST_TEST(
      has(program.run(words, "2>&1 >/dev/null").out, "no qdd given: it is found from tau first"));
}

BOOST_AUTO_TEST_CASE(what_is_needed_and_not_given_is_refused) {
  const Program program;
  program.write("neither.csv", "q1,qd1\n0.5,3\n");
  program.write("qdd.csv", "q1,qd1,qdd1\n0.5,3,1\n");
  program.write("driven.csv", "q1,q2,tau1,tau2\n0,3,0,0\n");
  for (const char* quantity : {"tau", "reactions", "M,reactions"})
    refuses(program,
            std::string("evaluate simple_pendulum --states neither.csv --quantity ") + quantity,
            "neither qdd nor tau given");
  for (const char* file : {"neither.csv", "qdd.csv"})
    refuses(program, std::string("evaluate simple_pendulum --quantity qdd --states ") + file,
            std::string(file) + ": qdd asked, and no tau given");
  refuses(program, "evaluate kapitza_pendulum --quantity qdd --states driven.csv",
          "driven joints, and no qdd given");
  BOOST_TEST(program.run("evaluate simple_pendulum --states neither.csv --quantity M,c,g,kinetic")
                 .status == 0);
}

BOOST_AUTO_TEST_CASE(what_is_taken_is_told) {
  const Program program;
  program.write("both.csv", "q1,tau1,qdd1\n0.5,2,1\n");
  const Outcome both = program.run("evaluate simple_pendulum --states both.csv --quantity tau,qdd");
  BOOST_TEST(both.status == 0);
  BOOST_TEST(has(both.out, "no qd given: at rest"), both.out);
  BOOST_TEST(has(both.out, "both given: tau and reactions belong to qdd as given"), both.out);
  BOOST_TEST(has(program.run("evaluate simple_pendulum --quantity qdd").out,
                 "without joint forces (tau = 0)"));
  // of a tree these would be its own zeros; of driven joints and loops they are not
  refuses(program, "evaluate simple_pendulum --quantity tau --q 1",
          "neither --qdd nor --tau given");
  refuses(program, "evaluate acrobot --quantity M,power --qd 1,0", "neither --qdd nor --tau given");
  BOOST_TEST(program.run("evaluate acrobot --quantity tau --tau 0,0").status == 0);
  BOOST_TEST(program.run("evaluate acrobot --quantity tau").status == 0);  // its start, as told
}

// By hand: a block of 2 kg on an upright slide stands on a table, 0.1 m beside the slide, its
// centre of mass 0.3 m beside it. The table holds the weight, the slide the moment of the two.
BOOST_AUTO_TEST_CASE(reactions_of_a_closed_mechanism_are_those_of_its_joints) {
  const Program program;
  const std::string block = R"(
title = "block"
gravity = [0, 0, -9.81]
[[link]]
name = "base"
[[link]]
name = "block"
parent = "base"
mass = 2
com = [0.3, 0, 0.2]
inertia = { xx = 1, yy = 1, zz = 1 }
joint = { name = "slide", kind = "prismatic" }
[[closure]]
kind = "plane"
a = { link = "base" }
b = { link = "block", xyz = [0.1, 0, 0] }
)",
                    foot = R"([[closure]]
kind = "plane"
a = { link = "base" }
b = { link = "block", xyz = [0.5, 0, 0] }
)";
  program.write("block.toml", block);
  program.write("two_feet.toml", block + foot);
  const std::vector<double> row = numbers(
      program.run("evaluate block.toml --quantity lambda,reactions --joint slide", "2>/dev/null")
          .out);
  BOOST_REQUIRE(row.size() == 7u);
  BOOST_TEST(row[0] == 2 * 9.81, boost::test_tools::tolerance(1e-14));
  for (const int zero : {1, 2, 3, 4, 6})
    BOOST_TEST(std::abs(row[static_cast<std::size_t>(zero)]) < 1e-13);
  BOOST_TEST(row[5] == -0.2 * 2 * 9.81, boost::test_tools::tolerance(1e-13));
  refuses(program, "evaluate two_feet.toml --quantity reactions",
          "reactions of slide at state 1 are not determined: redundant constraints");
  refuses(program, "evaluate block.toml --quantity reactions --joint wheel",
          "--joint wheel, expected the name of a joint");
}

// The drive of Kapitza's pendulum, asked for twice: as the tau of all joints, and as what the drive
// takes.
BOOST_AUTO_TEST_CASE(a_driven_scene_moves_with_its_constrained_accelerations) {
  const Program program;
  const std::vector<double> row =
      numbers(program.run("evaluate kapitza_pendulum --quantity tau,tau_drive", "2>/dev/null").out);
  BOOST_REQUIRE(row.size() == 4u);
  BOOST_TEST(row[0] == row[2], boost::test_tools::tolerance(1e-13));
  BOOST_TEST(std::abs(row[1]) < 1e-13);  // nothing drives the rod
  BOOST_TEST(std::abs(row[0]) > 1);
}

// By hand: the acrobot's arms of 1 m and 2 m hang straight down at q = 0, and turn about y; with
// both rates 1 the elbow moves at -1 m/s, and a point 2 m below it at -1 - 2 (1 + 1).
BOOST_AUTO_TEST_CASE(points_are_where_the_chain_has_them) {
  const Program program;
  const std::string asked =
      "evaluate acrobot --q 0,0 --qd 1,1 --point lower,0,0,-2 --quantity position,velocity";
  const std::vector<double> row = numbers(program.run(asked, "2>/dev/null").out);
  const std::vector<double> expected = {0, 0, -3, -5, 0, 0, 0, 2, 0};
  BOOST_TEST(row == expected);
  // the lower link has turned by a right angle: what is -x of the world is z of the link
  const std::vector<double> turned =
      numbers(program
                  .run("evaluate acrobot --q pi/2,0 --qd 1,0 --point upper,0,0,-1 --axes link "
                       "--quantity velocity,position",
                       "2>/dev/null")
                  .out);
  BOOST_REQUIRE(turned.size() == 9u);
  BOOST_TEST(turned[0] == -1, boost::test_tools::tolerance(1e-15));
  BOOST_TEST(turned[6] == -1, boost::test_tools::tolerance(1e-15));
  refuses(program, "evaluate acrobot --quantity position --point lowr", "did you mean lower?");
  refuses(program, "evaluate acrobot --quantity position --point lower,1", "LINK or LINK,x,y,z");
  refuses(program, "evaluate acrobot --quantity M --point lower", "--point without a quantity");
  refuses(program, "evaluate acrobot --quantity positon", "did you mean position?");
  refuses(program, "evaluate acrobot --quantity position --axes joint", "allowed: world, link");
  refuses(program, "evaluate acrobot --quantity position --witness simbody", "of our sweeps");
}

BOOST_AUTO_TEST_SUITE_END()
BOOST_AUTO_TEST_SUITE(states_of_the_command_line)

BOOST_AUTO_TEST_CASE(a_state_by_options_is_that_of_a_file) {
  const Program program;
  program.write("s.csv", "q1,q2,qd1,qd2,qdd1,qdd2\n0.1,0.3,1,-2,0.5,1\n");
  const std::string asked = "evaluate double_pendulum --quantity M,tau,reactions ";
  const Outcome of_file = program.run(asked + "--states s.csv");
  BOOST_REQUIRE(of_file.status == 0);
  BOOST_TEST(program.run(asked + "--q 0.1,0.3 --qd 1,-2 --qdd 1/2,1").out == of_file.out);
  BOOST_TEST(program.run(asked + "--q q2=0.3,q1=0.1 --qd 1,-2 --qdd 0.5,1").out == of_file.out);
  BOOST_TEST(program.run(asked + "--q 0.1,0.31 --qd 1,-2 --qdd 0.5,1").out != of_file.out);
  // with a torque instead, accelerations are found first, and the torque comes back
  const std::vector<double> row = numbers(
      program.run("evaluate double_pendulum --quantity tau --q 0.1,0.3 --tau 2,-1", "2>/dev/null")
          .out);
  BOOST_REQUIRE(row.size() == 2u);
  BOOST_TEST(row[0] == 2, boost::test_tools::tolerance(1e-13));
  BOOST_TEST(row[1] == -1, boost::test_tools::tolerance(1e-13));
  refuses(program, "evaluate double_pendulum --quantity M --q 0.1", "1 values, allowed: 2");
  refuses(program, "evaluate double_pendulum --quantity qdd --qdd 1,2", "--tau");
  refuses(program, "evaluate double_pendulum --quantity M --q 0,0 --states s.csv",
          "--states excludes --q");
}

BOOST_AUTO_TEST_CASE(random_states_stand_in_the_table) {
  const Program program;
  const std::string asked = "evaluate double_pendulum --quantity tau ";
  const Outcome drawn = program.run(asked + "--random 1 --seed 7");
  BOOST_TEST(program.run(asked + "--random 1 --seed 7").out == drawn.out);
  BOOST_TEST(program.run(asked + "--random 1 --seed 8").out != drawn.out);
  // its state, given back, has its torques
  const std::vector<double> row = numbers(drawn.out);
  BOOST_TEST(drawn.out.substr(0, drawn.out.find('\n')) == "q1,q2,qd1,qd2,qdd1,qdd2,tau1,tau2");
  BOOST_REQUIRE(row.size() == 8u);
  const auto two = [&](std::size_t at) {
    return fmt::format("{:.17g},{:.17g}", row[at], row[at + 1]);
  };
  const std::vector<double> again =
      numbers(program.run(asked + "--q=" + two(0) + " --qd=" + two(2) + " --qdd=" + two(4)).out);
  BOOST_TEST(again == std::vector<double>(row.begin() + 6, row.end()));
  // closed where there are closures
  const Outcome closed = program.run("evaluate loop_on_arm --quantity M --random 4", "2>&1");
  BOOST_TEST(closed.status == 0);
  BOOST_TEST(!has(closed.out, "closures are open"));
  // with the accelerations of drives, so that the table is a file of states
  const std::string driven = "evaluate car_axis --quantity lambda ";
  const Outcome first = program.run(driven + "--random 1");
  BOOST_REQUIRE(first.status == 0);
  const std::vector<double> all = numbers(first.out);
  const std::size_t end = first.out.find(",lambda1");
  const std::size_t count = std::count(first.out.begin(), first.out.begin() + end, ',') + 1;
  std::string states = first.out.substr(0, end) + "\n";
  for (std::size_t k = 0; k < count; ++k)
    states += fmt::format("{}{:.17g}", k == 0 ? "" : ",", all[k]);
  program.write("drawn.csv", states + "\n");
  BOOST_TEST(numbers(program.run(driven + "--states drawn.csv").out) ==
             std::vector<double>(all.begin() + count, all.end()));
  refuses(program, "evaluate double_pendulum --quantity tau,qdd --random 2", "column qdd1");
}

// A compact body of 1e7 or 1e16 kg at the end of a straight arm: its mass drops out of the
// shoulder's acceleration, as a difference of numbers as many times as large. That is more than the
// 7 digits of a float leave, and of the 16 of a double 1e16 is. (Measured: 3 and more are left to a
// double of 1e7, 0 to the others.)
BOOST_AUTO_TEST_CASE(too_few_certain_digits_are_told) {
  const Program program;
  const auto told = [&](const std::string& scene) {
    return program.run("evaluate " + scene + " --warn --quantity qdd", "2>&1 >/dev/null").out;
  };
  const std::string
      all_right =
          ": more than 3 digits of the largest entry are left by estimate at each of 1 "
          "states",
      in_double = "qdd by articulated_body", in_single = in_double + " in single precision",
      lost =
          ": at 1 of 1 states no more than 3 digits of the largest entry are left by "
          "estimate";
  const std::string right = told("cart_pole --q 0,0.1");
  BOOST_TEST(has(right, in_double + all_right), right);
  BOOST_TEST(has(right, in_single + all_right), right);
  const auto heavy = [&](const std::string& mass) {
    program.write("heavy.toml", fmt::format(R"(gravity = [0, -9.81, 0]
[[link]]
name = "base"
[[link]]
name = "arm"
parent = "base"
mass = 1
com = [0.5, 0, 0]
inertia = {{ about = "com", xx = 0.1, yy = 0.1, zz = 0.1 }}
[link.joint]
name = "shoulder"
kind = "revolute"
axis = [0, 0, 1]
[[link]]
name = "tip"
parent = "arm"
mass = {}
com = [0.5, 0, 0]
inertia = {{ about = "com", xx = 0.1, yy = 0.1, zz = 0.1 }}
[link.joint]
name = "elbow"
kind = "revolute"
axis = [0, 0, 1]
xyz = [1, 0, 0]
)",
                                            mass));
    return told("./heavy.toml --tau 1,0");
  };
  const std::string lost_in_float = heavy("1e7");
  BOOST_TEST(has(lost_in_float, in_double + all_right), lost_in_float);
  BOOST_TEST(has(lost_in_float, in_single + lost), lost_in_float);
  const std::string lost_in_both = heavy("1e16");
  BOOST_TEST(has(lost_in_both, in_double + lost), lost_in_both);
  BOOST_TEST(has(lost_in_both, in_single + lost), lost_in_both);
  // who has no estimate tells by its running error bound
  const std::string bounded =
      program.run("evaluate cart_pole --warn --quantity kinetic", "2>&1 >/dev/null").out;
  BOOST_TEST(has(bounded,
                 "kinetic by newton_euler: more than 3 digits of the largest entry are "
                 "certain at each of 1 states"),
             bounded);
  refuses(program, "evaluate loop_on_arm --quantity lambda --warn", "without estimate or bound");
  // the acceleration that these belong to has lost its digits, which their own bound cannot know
  refuses(program, "evaluate ./heavy.toml --quantity reactions --tau 1,0 --warn", "nobody vouches");
}

BOOST_AUTO_TEST_SUITE_END()
BOOST_AUTO_TEST_SUITE(open_closures)

BOOST_AUTO_TEST_CASE(the_bundled_starts_are_closed) {
  int closed = 0;
  for (const auto& file : scene::bundledScenes()) {
    const scene::Scene scene = scene::readScene(file);
    const ClosureGap gap = ClosureGaps::ofStart(scene);
    BOOST_TEST(!gap.is_open, scene.name << ": " << gap.text());
    closed += scene.mechanism.closures.empty() ? 0 : 1;
  }
  BOOST_TEST(closed >= 8);
}

// A gap of this size is seen, one of rounding is not: q moved by a millionth of a millionth, and by
// its last place.
BOOST_AUTO_TEST_CASE(more_than_rounding_is_open) {
  const scene::Scene scene = scene::findScene("andrews_squeezer");
  ClosureGaps gaps(scene);
  const scene::State<double> start = ConstrainedQuantities(scene).start();
  const auto moved = [&](double by) {
    scene::State<double> state = start;
    state.x[2] = scene::jointPosition(start.x[2].q + by);
    return gaps.at(state);
  };
  BOOST_TEST(!moved(0).is_open);
  const double last_place = std::nextafter(start.x[2].q, 1.0) - start.x[2].q;
  BOOST_TEST(!moved(last_place).is_open);
  BOOST_TEST(moved(1e-12).is_open);
  // the lever arm is below 1 m and above 1 mm
  BOOST_TEST(moved(1e-3).phi < 1e-3);
  BOOST_TEST(moved(1e-3).phi > 1e-6);

  scene::State<double> running = start;
  running.qd[0] = 1;  // alone, it pulls the loops apart
  const ClosureGap gap = gaps.at(running);
  BOOST_TEST(gap.is_open);
  BOOST_TEST(gap.phi_rate > 1e-3);
}

BOOST_AUTO_TEST_CASE(evaluate_simulate_and_crosscheck_tell_them) {
  const Program program;
  program.write("s.csv", "q1,q2,qd1,qd2,tau1,tau2\n0,0,0,0,0,0\n0.1,0,0,0,0,0\n0,0,0,2,0,0\n");
  const std::string rods =
      "title = \"Rods\"\nsource = \"chosen here\"\n[[link]]\nname = \"base\"\n"
      "[[link]]\nname = \"arm\"\nparent = \"base\"\nmass = 2\ncom = [0.3, 0, 0]\n"
      "inertia = { yy = 0.06, zz = 0.06 }\n"
      "joint = { kind = \"revolute\" }\n"
      "[[link]]\nname = \"tip\"\nparent = \"arm\"\nmass = 1\ncom = [0.2, 0, 0]\n"
      "inertia = { yy = 0.02, zz = 0.02 }\n"
      "joint = { kind = \"revolute\", xyz = [0.5, 0, 0] }\n"
      "[[closure]]\nkind = \"plane\"\n"
      "a = { link = \"base\", xyz = [0, 0, 0], rpy = [\"pi/2\", 0, 0] }\n"
      "b = { link = \"tip\", xyz = [0.25, 0, 0] }\n[start]\nq = [0, 0]\n";
  program.write("closed.toml", rods);
  const Outcome evaluate = program.run("evaluate closed.toml --quantity qdd --states s.csv");
  BOOST_TEST(evaluate.status == 0);
  // by hand: 0.75 sin(0.1) m, and 0.25 m at 2 rad/s
  BOOST_TEST(has(evaluate.out,
                 "open at 2 of 3 states, worst |phi| = 0.0749 (state 2), |J qd| = 0.5 (state 3)"),
             evaluate.out);
  BOOST_TEST(!has(program.run("simulate closed.toml --duration 0.1").out, "open"));

  std::string open = rods;
  open.replace(open.find("q = [0, 0]"), 10, "q = [0, 0.001]");
  program.write("open.toml", open);
  const Outcome simulate = program.run("simulate open.toml --duration 0.1");
  BOOST_TEST(simulate.status == 0);
  BOOST_TEST(has(simulate.out, "the start leaves closures open, |phi| = 0.00025, |J qd| = 0"),
             simulate.out);
  const std::string words = " --witness newton_euler,lagrange --random 2 --no-charts -o r";
  const Outcome crosscheck = program.run("crosscheck open.toml" + words);
  BOOST_TEST(crosscheck.status == 1);
  BOOST_TEST(has(crosscheck.out, "but closures are open at the start of "), crosscheck.out);
  BOOST_TEST(!has(crosscheck.out, "all agree"), crosscheck.out);
  BOOST_TEST(has(program.read("r/report.json"), "the start leaves closures open, |phi| = 0.00025"));
  BOOST_TEST(program.run("crosscheck closed.toml" + words).status == 0);
  BOOST_TEST(!has(program.read("r/report.json"), "leaves closures open"));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(joints)

// By hand: a rod of 1 kg with its centre of mass 1 m below the pivot that turns about y. What
// passes through the free joint has lost all that a turn about y feels: the moment about y, and the
// force across the rod.
BOOST_AUTO_TEST_CASE(columns_are_named_by_joint_and_have_units) {
  const Program program;
  program.write("rod.toml",
                "gravity = [0, 0, -9.81]\n[[link]]\nname = \"base\"\n"
                "[[link]]\nname = \"rod\"\nparent = \"base\"\nmass = 1\ncom = [0, 0, -1]\n"
                "inertia = { xx = 0.5, yy = 0.5 }\n"
                "joint = { name = \"pivot\", kind = \"revolute\", axis = [0, 1, 0] }\n"
                "[[link]]\nname = \"flag\"\nparent = \"rod\"\n"
                "joint = { name = \"top\", kind = \"fixed\", xyz = [0, 0, 2] }\n");
  const std::string all = "evaluate rod.toml --quantity M_A,PM,Z --joint pivot";
  const Outcome plain = program.run(all, "2>/dev/null");
  BOOST_TEST(plain.status == 0);
  BOOST_TEST(plain.out.rfind("pivot.M_A11,pivot.M_A12,", 0) == 0u, plain.out);
  BOOST_TEST(has(plain.out, ",pivot.PM66,pivot.Z_vx,pivot.Z_vy,pivot.Z_vz,pivot.Z_wx,pivot.Z_wy,"));
  const std::vector<double> row = numbers(plain.out);
  BOOST_TEST_REQUIRE(row.size() == 78u);
  BOOST_TEST(row[6 * 4 + 4] == 1.5, boost::test_tools::tolerance(1e-15));  // about the pivot
  // 1 - 1 * 1 / 1.5 across the rod, nothing about y
  BOOST_TEST(row[36] == 1 - 1 / 1.5, boost::test_tools::tolerance(1e-14));
  BOOST_TEST(std::abs(row[36 + 6 * 4 + 4]) < 1e-15);
  BOOST_TEST(row[72 + 4] == 1);

  const Outcome json = program.run(all + " --units --format json", "2>/dev/null");
  BOOST_TEST(json.out.rfind("{\"pivot.M_A11 [kg]\":1,", 0) == 0u, json.out);
  BOOST_TEST(has(json.out, "\"pivot.M_A55 [kg m^2]\":1.5,"), json.out);
  BOOST_TEST(has(json.out, "\"pivot.Z_vx [m]\":0,"), json.out);
  BOOST_TEST(has(program.run("evaluate rod.toml --quantity M,g,qdd --units").out,
                 "M11 [kg m^2],g1 [N m],qdd1 [rad/s^2]\n1.5,"));
  program.write("two.csv", "q1\n0\n0.5\n");
  const std::string two =
      program.run("evaluate rod.toml --quantity X --states two.csv", "2>/dev/null").out;
  BOOST_TEST(std::count(two.begin(), two.end(), '\n') == 3);
  BOOST_TEST(has(two, ",pivot.X66,top.X11,"), two);
}

BOOST_AUTO_TEST_CASE(what_a_joint_or_a_scene_has_not_is_refused) {
  const Program program;
  program.write("q.csv", "q1,q2\n0,0\n");
  for (const auto& [words, reason] : std::vector<std::pair<std::string, std::string>>{
           {"double_pendulum --quantity E", "E: the scene has no acceleration_constraint"},
           {"double_pendulum --quantity M_A --joint knee", "no joint 'knee', allowed: "},
           {"double_pendulum --quantity M --joint elbow", "--joint without a quantity of joints"},
           {"double_pendulum --quantity M_A --witness lagrange", "--witness or --engine with M_A"},
           {"double_pendulum --quantity F --states q.csv", "F asked, and no tau given"},
           {"gripper --quantity M_A", "through a joint alone that shares its rate"},
           {"two_handed --quantity nu --units", "--units with nu"}}) {
    const Outcome outcome = program.run("evaluate " + words);
    BOOST_TEST(outcome.status == 2, words);
    BOOST_TEST(has(outcome.out, reason), outcome.out);
  }
}

// 36 numbers a joint, and no matrix of all joints.
BOOST_AUTO_TEST_CASE(a_thousand_joints_are_a_row) {
  const Program program;
  const std::string one =
      program
          .run("evaluate chain_1000 --quantity M_A,P,F --joint joint1,joint1000 --format json",
               "2>/dev/null")
          .out;
  BOOST_TEST(has(one, "\"joint1000.P66\":"), one.substr(0, 400));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(pipes)

// Who asks one question after the other would wait for ever for an answer that stays in a buffer,
// or that is given when the next question is read.
BOOST_AUTO_TEST_CASE(a_row_is_answered_before_the_next_is_asked) {
  const Program program;
  program.write("exchange.sh",
                "coproc P { exec \"$1\" evaluate simple_pendulum --quantity g --states -; }\n"
                "printf 'q1\\n0\\n' >&${P[1]}\n"
                "read -t 30 -r header <&${P[0]} && read -t 30 -r first <&${P[0]} || exit 1\n"
                "printf '0.5\\n0' >&${P[1]}\n"  // and the beginning of another
                "read -t 30 -r second <&${P[0]} || exit 1\n"
                "printf '.5\\n' >&${P[1]}\n"
                "read -t 30 -r third <&${P[0]} || exit 1\n"
                "echo \"$header $first $second $third\"\n");
  const Outcome outcome = program.run(
      "--version", ">/dev/null; timeout 100 bash exchange.sh " DYNWITNESS_PROGRAM " 2>/dev/null");
  BOOST_TEST_REQUIRE(outcome.status == 0, outcome.out);
  BOOST_TEST(outcome.out.rfind("g1 0 4.70", 0) == 0u, outcome.out);  // 9.81 sin(1/2)
  const std::size_t last = outcome.out.rfind(' ');
  BOOST_TEST(outcome.out.substr(5, last - 5) + "\n" == outcome.out.substr(last + 1));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(derivatives)

BOOST_AUTO_TEST_CASE(second_derivatives_that_there_are_not) {
  const Program program;
  refuses(program, "evaluate chain_300 --quantity d2tau_dq_dq",
          "of 300 rates has 27000000 numbers a state, allowed: at most 10000000");
  refuses(program, "evaluate differential_wrist --quantity d2qdd_dq_dtau",
          "has rotors geared to several rates, allowed: scenes without, or first derivatives");
  refuses(program, "evaluate puma_560_friction --quantity d2tau_dq_dqd",
          "has Coulomb friction and rests");
}

// Against central differences of tau and qdd themselves, asked of a scene that turns and slides:
// h^2 / 6 of a third derivative is 1e-10 of the largest entry or so, a column in another place all
// of it. Angles and lengths have units of their own.
BOOST_AUTO_TEST_CASE(columns_are_the_slopes_of_the_quantity_they_name) {
  constexpr double h = 1e-5;
  const Program program;
  const std::vector<std::vector<double>> at = {
      {0.1, 0.2, 0.3, 0.4, 0.5, 0.6}, {1, 2, 3, 1, 2, 3}, {1, -1, 2, 1, 3, -2}};
  struct Case {
    const char *quantity, *of, *columns;
    std::size_t part;  ///< that is moved
    const char* units;
  };
  for (const Case& one :
       {Case{"dtau_dq", "tau", "qdd", 0, "dtau3_dq2 [N/rad],dtau3_dq3 [N/m]"},
        Case{"dtau_dqd", "tau", "qdd", 1, "dtau3_dqd2 [N s/rad],dtau3_dqd3 [N s/m]"},
        Case{"dqdd_dq", "qdd", "tau", 0, "dqdd3_dq2 [m/(rad s^2)],dqdd3_dq3 [1/s^2]"},
        Case{"dqdd_dqd", "qdd", "tau", 1, "dqdd3_dqd2 [m/(rad s)],dqdd3_dqd3 [1/s]"},
        Case{"dqdd_dtau", "qdd", "tau", 2, "dqdd3_dtau2 [1/(kg m)],dqdd3_dtau3 [1/kg]"},
        Case{"d2tau_dq_dq", "dtau_dq", "qdd", 0,
             "d2tau3_dq2_dq2 [N/rad^2],d2tau3_dq2_dq3 [N/(m rad)]"},
        Case{"d2tau_dq_dqd", "dtau_dqd", "qdd", 0,
             "d2tau3_dq2_dqd2 [N s/rad^2],d2tau3_dq2_dqd3 [N s/(m rad)]"},
        Case{"d2tau_dqd_dqd", "dtau_dqd", "qdd", 1,
             "d2tau3_dqd2_dqd2 [N s^2/rad^2],d2tau3_dqd2_dqd3 [N s^2/(m rad)]"},
        Case{"d2tau_dq_dqdd", "M", "qdd", 0,
             "d2tau3_dq2_dqdd2 [kg m/rad],d2tau3_dq2_dqdd3 [kg/rad]"},
        Case{"d2qdd_dq_dq", "dqdd_dq", "tau", 0,
             "d2qdd3_dq2_dq2 [m/(rad^2 s^2)],d2qdd3_dq2_dq3 [1/(rad s^2)]"},
        Case{"d2qdd_dq_dqd", "dqdd_dqd", "tau", 0,
             "d2qdd3_dq2_dqd2 [m/(rad^2 s)],d2qdd3_dq2_dqd3 [1/(rad s)]"},
        Case{"d2qdd_dqd_dqd", "dqdd_dqd", "tau", 1,
             "d2qdd3_dqd2_dqd2 [m/rad^2],d2qdd3_dqd2_dqd3 [1/rad]"},
        Case{"d2qdd_dq_dtau", "dqdd_dtau", "tau", 0,
             "d2qdd3_dq2_dtau2 [1/(kg m rad)],d2qdd3_dq2_dtau3 [1/(kg rad)]"}}) {
    std::string rows = "q1,q2,q3,q4,q5,q6,qd1,qd2,qd3,qd4,qd5,qd6";
    for (int k = 1; k <= 6; ++k) rows += fmt::format(",{}{}", one.columns, k);
    rows += "\n";
    const auto add = [&](std::size_t joint, double step) {
      std::string row;
      for (std::size_t part = 0; part < 3; ++part)
        for (std::size_t k = 0; k < 6; ++k)
          row += fmt::format("{}{}", row.empty() ? "" : ",",
                             at[part][k] + (part == one.part && k == joint ? step : 0));
      rows += row + "\n";
    };
    add(0, 0);
    for (std::size_t k = 0; k < 6; ++k) add(k, h), add(k, -h);
    program.write("s.csv", rows);
    const std::string words = "evaluate stanford_arm --states s.csv --quantity ";
    const Outcome told = program.run(words + one.quantity + " --units", "2>/dev/null");
    BOOST_TEST_REQUIRE(told.status == 0, one.quantity);
    BOOST_TEST(has(told.out, one.units), told.out.substr(0, told.out.find('\n')));
    const std::vector<double> slopes = numbers(told.out);
    // of a matrix the second index is that of the first derivative's columns
    const std::size_t columns = slopes.size() / 36;
    BOOST_REQUIRE((columns == 1 || columns == 6));
    double most = 0;
    for (const double slope : slopes) most = std::max(most, std::abs(slope));
    std::string values = program.run(words + one.of, "2>/dev/null").out;
    values.erase(0, values.find('\n') + 1);  // the row of the state itself takes the header's place
    for (std::size_t k = 0; k < 6; ++k) {
      const std::vector<double> more = numbers(values);
      values.erase(0, values.find('\n') + 1);
      const std::vector<double> less = numbers(values);
      values.erase(0, values.find('\n') + 1);
      BOOST_REQUIRE(more.size() == 6 * columns);
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < columns; ++j)
          BOOST_TEST(std::abs((more[i * columns + j] - less[i * columns + j]) / (2 * h) -
                              slopes[(6 * i + k) * columns + j]) < 1e-6 * most,
                     one.quantity << " " << i + 1 << ", " << k + 1 << ", " << j + 1);
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(joints_that_move_no_inertia)

namespace {

/// A bar of 2 kg on a hinge, its centre 0.5 m away, and a tool without mass that turns on its tip.
const char* const kMasslessTip = R"(<robot name="tip">
  <link name="base"/>
  <link name="arm"><inertial><origin xyz="0 0 0.5"/><mass value="2"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tool"/>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
  <joint name="wrist" type="continuous"><parent link="arm"/><child link="tool"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/></joint>
</robot>
)";

}  // namespace

// M = diag(I + m c^2, 0), g = -m g c sin q, tau = M qdd + g: no inverse is asked for.
BOOST_AUTO_TEST_CASE(what_needs_no_inverse_of_M_is_answered) {
  const Program program;
  program.write("tip.urdf", kMasslessTip);
  const auto close = boost::test_tools::tolerance(1e-15);
  const std::string at = "evaluate tip.urdf --q 0.5,0.2 --qd 1,-2 ";
  const auto numbers = [&](const std::string& words) {
    const Outcome outcome = program.run(at + words, "2>/dev/null");
    BOOST_TEST_REQUIRE(outcome.status == 0, words);
    std::vector<double> out;
    std::istringstream cells(outcome.out.substr(outcome.out.find('\n') + 1));
    for (std::string cell; std::getline(cells, cell, ',');) out.push_back(std::stod(cell));
    return out;
  };
  const double gravity = -2 * 9.81 * 0.5 * std::sin(0.5);
  for (const char* witness : {"", " --witness lagrange", " --witness composite_body"}) {
    const std::vector<double> M = numbers(std::string("--quantity M") + witness);
    BOOST_TEST(M[0] == 0.6, close);
    for (const std::size_t k : {1u, 2u, 3u}) BOOST_TEST(M[k] == 0.0);
  }
  BOOST_TEST(numbers("--quantity g")[0] == gravity, close);
  BOOST_TEST(numbers("--quantity c")[0] == 0.0);
  const std::vector<double> tau = numbers("--quantity tau --qdd 3,7");
  BOOST_TEST(tau[0] == 0.6 * 3 + gravity, close);
  BOOST_TEST(tau[1] == 0.0);
  BOOST_TEST(numbers("--quantity kinetic")[0] == 0.3, close);
  for (const char* quantity :
       {"potential", "momentum", "position", "jacobian", "dtau_dq --qdd 3,7", "X", "M_i", "M_C",
        "reactions --qdd 3,7", "power --qdd 3,7", "acceleration --qdd 3,7"})
    numbers(std::string("--quantity ") + quantity);
}

BOOST_AUTO_TEST_CASE(what_needs_it_names_the_joint_and_what_was_asked) {
  const Program program;
  program.write("tip.urdf", kMasslessTip);
  const std::string joint = "tip.urdf:5: joint \"wrist\" of link \"tool\": ";
  for (const char* asked : {"qdd --tau 0,0", "M_A", "dqdd_dtau", "Lambda"}) {
    const std::string words = asked;
    refuses(
        program, "evaluate tip.urdf --quantity " + words,
        joint + words.substr(0, words.find(' ')) + " asked, and nothing that it carries has mass");
  }
  refuses(program, "evaluate tip.urdf --quantity tau --tau 0,0",
          joint + "qdd (found from tau first) asked");
  refuses(program, "derive tip.urdf --format c --quantity tau,qdd", joint + "qdd asked");
  refuses(program, "derive tip.urdf --operations", joint + "forward dynamics asked");
  refuses(program, "simulate tip.urdf", joint + "nothing that it carries has mass");
  BOOST_TEST(program.run("derive tip.urdf").status == 0);
  BOOST_TEST(program.run("derive tip.urdf --format c --quantity tau,M,c,g -o code").status == 0);
  BOOST_TEST(program.run("write tip.urdf --format toml -o tip.toml").status == 0);
  BOOST_TEST(program.run("evaluate tip.toml --quantity M").status == 0);
  BOOST_TEST(program.run("simulate tip.urdf --set rotor_inertia:wrist=0.01 --once").status == 0);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(matrices)

BOOST_AUTO_TEST_CASE(c_is_C_qd_and_tau_is_Y_pi) {
  const Program program;
  const auto numbers = [&](const std::string& words) {
    const Outcome outcome = program.run("evaluate " + words, "2>/dev/null");
    BOOST_TEST_REQUIRE(outcome.status == 0, words);
    std::vector<double> out;
    std::istringstream cells(outcome.out.substr(outcome.out.find('\n') + 1));
    for (std::string cell; std::getline(cells, cell, ',');) out.push_back(std::stod(cell));
    return out;
  };
  const std::string at = "acrobot --q 0.5,0.2 --qd 1,-2 --qdd 3,7 --quantity ";
  const std::vector<double> C = numbers(at + "C"), c = numbers(at + "c");
  BOOST_REQUIRE(C.size() == 4u);
  for (const std::size_t i : {0u, 1u})
    BOOST_TEST(C[2 * i] * 1 + C[2 * i + 1] * -2 == c[i], boost::test_tools::tolerance(1e-14));
  // ten numbers a link: m, m c, and inertia about the link's origin
  const std::vector<double> Y = numbers(at + "Y"), tau = numbers(at + "tau");
  BOOST_REQUIRE(Y.size() == 40u);
  const double m1 = 1, m2 = 1, c1 = -0.5, c2 = -1, I1 = 0.083, I2 = 0.33;
  const std::vector<double> pi = {
      m1, 0, 0, m1 * c1, m1 * c1 * c1 + I1, m1 * c1 * c1 + I1, 0, 0, 0, 0,
      m2, 0, 0, m2 * c2, m2 * c2 * c2 + I2, m2 * c2 * c2 + I2, 0, 0, 0, 0};
  for (const std::size_t i : {0u, 1u}) {
    double sum = 0;
    for (std::size_t k = 0; k < 20; ++k) sum += Y[20 * i + k] * pi[k];
    BOOST_TEST(sum == tau[i], boost::test_tools::tolerance(1e-14));
  }
  const std::string names = program.run("evaluate " + at + "C,Y --units", "2>/dev/null").out;
  for (const char* name : {"C12 [N m s/rad]", "Y2_mcx(lower) [N m/(kg m)]", "Y1_m(upper) [N m/kg]"})
    BOOST_TEST(names.find(name) != std::string::npos, name);
  const std::string coupled = "gripper --q 0.3,0.01,0.4 --qd 0.5,-0.1,1.2 --quantity ";
  const std::vector<double> of_coupled = numbers(coupled + "C"), bias = numbers(coupled + "c");
  for (std::size_t i = 0; i < 3; ++i)  // joints that follow others are in it; a sum of 1e-4
    BOOST_TEST(std::abs(of_coupled[3 * i] * 0.5 + of_coupled[3 * i + 1] * -0.1 +
                        of_coupled[3 * i + 2] * 1.2 - bias[i]) < 1e-18);
}

BOOST_AUTO_TEST_CASE(angles_of_more_than_a_turn_are_remarked_on) {
  const Program program;
  const auto said = [&](const std::string& words) {
    const Outcome outcome = program.run("evaluate " + words);
    BOOST_TEST(outcome.status == 0, outcome.out);
    return outcome.out;
  };
  const std::string remark = "write 30*pi/180";
  BOOST_TEST(said("double_pendulum --q 1,30 --quantity g").find(remark) != std::string::npos);
  BOOST_TEST(said("double_pendulum --q 1,-6.2 --quantity g").find("turns") == std::string::npos);
  // a slide's metres are no turns
  BOOST_TEST(said("cart_pole --q 30,1 --quantity g").find("turns") == std::string::npos);
}

BOOST_AUTO_TEST_CASE(a_link_that_is_wrong_is_not_told_to_be_missing_as_well) {
  const Program program;
  program.write("arm.urdf",
                "<robot name=\"arm\"><link name=\"base\"/>"
                "<link name=\"rod\"><inertial><mass value=\"1\"/></inertial></link>"
                "<joint name=\"turn\" type=\"continuous\"><parent link=\"base\"/>"
                "<child link=\"rod\"/></joint></robot>");
  const Outcome outcome = program.run("evaluate arm.urdf --quantity M");
  BOOST_TEST(outcome.status == 2);
  BOOST_TEST(outcome.out.find("has no <inertia>") != std::string::npos, outcome.out);
  BOOST_TEST(outcome.out.find("is not a link") == std::string::npos, outcome.out);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(derivations)

BOOST_AUTO_TEST_CASE(code_to_standard_output_writes_nowhere_and_a_scene_at_rest_is_refused) {
  const Program program;
  program.write("table.toml", "[[link]]\nname = \"table\"\nmass = 1\n");
  for (const char* words : {"", " --format c", " --format latex", " --operations"})
    refuses(program, std::string("derive table.toml") + words, "table.toml: ");
  // in /proc nobody writes
  const Outcome outcome =
      program.run("version", std::string(">/dev/null; cd /proc && ") + DYNWITNESS_PROGRAM +
                                 " derive acrobot --format julia 2>&1");
  BOOST_TEST(outcome.status == 0, outcome.out);
  BOOST_TEST(outcome.out.find("function acrobot_tau!") != std::string::npos);
}

BOOST_AUTO_TEST_SUITE_END()
