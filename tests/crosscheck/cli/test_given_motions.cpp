// SPDX-License-Identifier: GPL-3.0-or-later
// States, scenes and motions that a user brings along: columns that are kept, coordinates of other
// engines, scenes that are changed, motions that start elsewhere, are pushed, and end at an event.
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <boost/math/special_functions/ellint_1.hpp>

#include <nlohmann/json.hpp>

#include "tests/fixtures/program.hpp"

using namespace dynwitness;
using fixtures::Outcome;
using fixtures::Program;
using fixtures::refuses;

namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Lines but comments, as cells.
std::vector<std::vector<std::string>> table(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

/// The numbers of one row under names that start so and go on with a digit.
std::vector<double> under(const std::vector<std::vector<std::string>>& rows, std::size_t row,
                          const std::string& name) {
  std::vector<double> out;
  for (std::size_t k = 0; k < rows[0].size(); ++k) {
    const std::string& cell = rows[0][k];
    if (cell.compare(0, name.size(), name) == 0 && cell.size() > name.size() &&
        std::isdigit(static_cast<unsigned char>(cell[name.size()])) != 0)
      out.push_back(std::stod(rows[row][k]));
  }
  return out;
}

std::vector<double> answer(const Program& program, const std::string& words,
                           const std::string& name) {
  const Outcome outcome = program.run("evaluate " + words, "2>/dev/null");
  BOOST_TEST_REQUIRE(outcome.status == 0, words);
  return under(table(outcome.out), 1, name);
}

const double g_half = 9.81 * std::sin(0.5);  // of the simple pendulum, m = l = 1, at q = 1/2

}  // namespace

BOOST_AUTO_TEST_SUITE(kept_columns)

BOOST_AUTO_TEST_CASE(columns_that_are_no_states_are_kept_or_refused) {
  const Program program;
  program.write("s.csv", "time,q1,note\n0.125,0.5,first\n1e-3,0.5,1st of 2\n");
  const std::string words = "evaluate simple_pendulum --quantity g --states s.csv";
  refuses(program, words, "s.csv:1: columns 'time', 'note' are unknown");
  BOOST_TEST(has(program.run(words).out, "--keep"));
  const auto rows = table(program.run(words + " --keep", "2>/dev/null").out);
  BOOST_REQUIRE(rows.size() == 3u);
  BOOST_TEST((rows[0] == std::vector<std::string>{"time", "note", "g1"}));
  BOOST_TEST(rows[1][0] == "0.125");
  BOOST_TEST(rows[2][0] == "1e-3");  // as it is written
  BOOST_TEST(rows[2][1] == "1st of 2");
  BOOST_TEST(std::stod(rows[1][2]) == g_half, boost::test_tools::tolerance(1e-15));
  const std::string json = program.run(words + " --keep --format json", "2>/dev/null").out;
  const auto first = nlohmann::json::parse(json.substr(0, json.find('\n')));
  BOOST_TEST(first["time"].get<double>() == 0.125);
  BOOST_TEST(first["note"].get<std::string>() == "first");
  refuses(program, "evaluate simple_pendulum --quantity g --keep", "--states");
  program.write("twice.csv", "q1,g1\n0.5,1\n");
  // what the file has of the answer stands beside it
  const Outcome twice =
      program.run("evaluate simple_pendulum --quantity g --keep --states twice.csv");
  BOOST_TEST(has(twice.out, "given.NAME, since the answer has them, too: g1"), twice.out);
  BOOST_TEST(has(twice.out, "given.g1,g1\n1,"), twice.out);
  program.write("thrice.csv", "q1,g1,given.g1\n0.5,1,2\n");
  refuses(program, "evaluate simple_pendulum --quantity g --keep --states thrice.csv",
          "another name for one in the file");
}

BOOST_AUTO_TEST_CASE(faults_of_a_header_are_told_together) {
  const Program program;
  program.write("s.csv", "q1,q3,time\n0,0,0\n");
  const std::string said = program.run("evaluate acrobot --quantity g --states s.csv").out;
  BOOST_TEST(has(said, "'q3', 'time' are unknown"), said);
  BOOST_TEST(has(said, "'q2' is missing"), said);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(coordinates_of_others)

BOOST_AUTO_TEST_CASE(a_file_says_its_convention_or_is_asked) {
  const Program program;
  const std::string row = "q1,q2,q3,q4,q5,q6,q7,q8,q9,q10\n0.1,0.2,0.3,1,0,0,0.5,0.1,0.2,0.3\n";
  program.write("untold.csv", row);
  program.write("told.csv", "# convention: mujoco\n" + row);
  program.write("wrong.csv", "# convention: mujoko\n" + row);
  const std::string words = "evaluate satellite_arm --quantity kinetic --states ";
  refuses(program, words + "untold.csv",
          "allowed: --convention, or a first line \"# convention: dynwitness\", with one of "
          "dynwitness, pinocchio, mujoco, drake, rbdl, dart, simbody");
  BOOST_TEST(program.run(words + "untold.csv --convention drake").status == 0);
  BOOST_TEST(program.run(words + "told.csv").status == 0);
  BOOST_TEST(program.run(words + "told.csv --convention mujoco").status == 0);
  refuses(program, words + "told.csv --convention drake", "convention is mujoco, and drake");
  refuses(program, words + "wrong.csv", "did you mean mujoco");
  refuses(program, words + "untold.csv --convention bullet", "--convention");
  // where it does not matter nobody is asked
  program.write("plain.csv", "q1\n0.5\n");
  BOOST_TEST(program.run("evaluate simple_pendulum --quantity g --states plain.csv").status == 0);
}

// The equations of motion hold among the columns of each convention, whatever it is; energy and
// power are nobody's coordinates.
BOOST_AUTO_TEST_CASE(the_equations_of_motion_hold_in_every_convention) {
  const Program program;
  std::vector<double> kinetics, powers;
  for (const char* name :
       {"dynwitness", "pinocchio", "mujoco", "drake", "rbdl", "dart", "simbody"}) {
    BOOST_TEST_CONTEXT(name) {
      const Outcome outcome =
          program.run(std::string("evaluate humanoid_floating --random 1 --seed 5 --quantity "
                                  "M,c,g,tau,kinetic --convention ") +
                          name,
                      "2>/dev/null");
      BOOST_TEST_REQUIRE(outcome.status == 0);
      BOOST_TEST(has(outcome.out, std::string("# convention: ") + name + "\n"));
      const auto rows = table(outcome.out);
      const auto qd = under(rows, 1, "qd"), qdd = under(rows, 1, "qdd"), M = under(rows, 1, "M"),
                 c = under(rows, 1, "c"), g = under(rows, 1, "g"), tau = under(rows, 1, "tau");
      const std::size_t n = qd.size();
      BOOST_REQUIRE(M.size() == n * n);
      double most = 0, worst = 0, power = 0;
      for (std::size_t i = 0; i < n; ++i) {
        double sum = c[i] + g[i] - tau[i];
        for (std::size_t j = 0; j < n; ++j) sum += M[i * n + j] * qdd[j];
        worst = std::max(worst, std::abs(sum));
        most = std::max(most, std::abs(tau[i]));
        power += tau[i] * qd[i];
      }
      BOOST_TEST(worst <= 1e-14 * most);  // measured: 1e-16
      kinetics.push_back(std::stod(rows[1].back()));
      powers.push_back(power);
    }
  }
  for (const double kinetic : kinetics)
    BOOST_TEST(kinetic == kinetics[0], boost::test_tools::tolerance(1e-15));
  for (const double power : powers)
    BOOST_TEST(power == powers[0], boost::test_tools::tolerance(1e-12));
}

// What is drawn in other coordinates is the same state when it is read again.
BOOST_AUTO_TEST_CASE(a_table_of_states_is_a_file_of_states) {
  const Program program;
  for (const char* name :
       {"dynwitness", "pinocchio", "mujoco", "drake", "rbdl", "dart", "simbody"}) {
    const std::string drawn =
        program
            .run(std::string("evaluate satellite_arm --random 2 --quantity tau --convention ") +
                     name,
                 "2>/dev/null")
            .out;
    std::string states;  // without the answer, whose columns are the last nine
    std::istringstream lines(drawn);
    for (std::string line; std::getline(lines, line);) {
      if (line[0] != '#')
        for (int k = 0; k < 9; ++k) line.erase(line.rfind(','));
      states += line + "\n";
    }
    program.write("s.csv", states);
    const Outcome again =
        program.run("evaluate satellite_arm --quantity tau --states s.csv", "2>/dev/null");
    BOOST_TEST_REQUIRE(again.status == 0, name);
    const auto before = under(table(drawn), 2, "tau"), after = under(table(again.out), 2, "tau");
    BOOST_REQUIRE(before.size() == 9u);
    double most = 0;
    for (const double x : before) most = std::max(most, std::abs(x));
    for (std::size_t k = 0; k < 9; ++k)
      BOOST_TEST(std::abs(before[k] - after[k]) <= 1e-14 * most, name);  // measured: 2e-16
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(changed_scenes)

// By hand: g = m gravity l sin q of the simple pendulum.
BOOST_AUTO_TEST_CASE(numbers_of_a_scene_are_others) {
  const Program program;
  const auto g = [&](const std::string& changes) {
    const std::vector<double> all =
        answer(program, "simple_pendulum --q 0.5 --quantity g " + changes, "g");
    BOOST_REQUIRE(all.size() == 1u);
    return all[0];
  };
  const auto close = boost::test_tools::tolerance(1e-15);
  BOOST_TEST(g("--set m=2 --set l=3") == 6 * g_half, close);
  BOOST_TEST(g("--set mass:bob=5") == 5 * g_half, close);
  BOOST_TEST(g("--set mass:bob=2*m") == 2 * g_half, close);
  BOOST_TEST(g("--set com:bob=0,0,-2") == 2 * g_half, close);
  BOOST_TEST(g("--gravity 0,0,-1.62") == 1.62 * std::sin(0.5), close);
  BOOST_TEST(g("--gravity 0,0,0") == 0);
  BOOST_TEST(
      answer(program, "simple_pendulum --set inertia:bob=7,7,7,0,0,0 --quantity M", "M")[0] == 8);
  BOOST_TEST(answer(program,
                    "simple_pendulum --set damping:pivot=0.5 --q 0 --qd 2 --qdd 0 --quantity tau",
                    "tau")[0] == 1);
  program.run("write simple_pendulum --set mass:bob=5 --format toml -o five.toml");
  BOOST_TEST(answer(program, "five.toml --q 0.5 --quantity g", "g")[0] == 5 * g_half, close);
}

// A base that floats has the moving masses as the first three of M's diagonal; one that is fixed
// has what is left of M without its rates.
BOOST_AUTO_TEST_CASE(a_base_floats_or_is_fixed) {
  const Program program;
  const auto floating = answer(program, "simple_pendulum --base floating --quantity M", "M");
  BOOST_REQUIRE(floating.size() == 49u);
  for (const std::size_t k : {0u, 8u, 16u}) BOOST_TEST(floating[k] == 1);
  BOOST_TEST(floating[48] == 1);
  const auto all = answer(program, "satellite_arm --quantity M", "M"),
             fixed = answer(program, "satellite_arm --base fixed --quantity M", "M");
  BOOST_REQUIRE(all.size() == 81u);
  BOOST_REQUIRE(fixed.size() == 9u);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      BOOST_TEST(fixed[3 * i + j] == all[9 * (i + 6) + j + 6], boost::test_tools::tolerance(1e-14));
}

// g of the arm's joints depends on how the base is turned, which three angles say otherwise than a
// quaternion; at a pitch of 90 degrees roll and yaw are one.
BOOST_AUTO_TEST_CASE(a_base_that_is_fixed_stands_as_it_floated) {
  const Program program;
  BOOST_TEST_REQUIRE(
      program.run("write satellite_arm --format toml --gravity 1,2,-9.81 -o free.toml").status ==
      0);
  const std::string scene = program.read("free.toml");
  const std::size_t start = scene.find("[start]"), at = scene.find("q = [", start),
                    end = scene.find(']', at);
  BOOST_REQUIRE(end != std::string::npos);
  const double half = std::sqrt(0.5);
  for (const double e : {0.0, 1e-12, 1e-7, 0.01, 0.7})
    for (const double roll : {0.0, 1.1}) {
      // Ry(90 degrees - e) Rx(roll)
      const double c = std::cos(roll / 2), s = std::sin(roll / 2),
                   cy = half * (std::cos(e / 2) + std::sin(e / 2)),
                   sy = half * (std::cos(e / 2) - std::sin(e / 2));
      const std::string position = fmt::format("0.1, 0.2, 0.3, {}, {}, {}, {}, 0.4, 0.5, 0.6",
                                               cy * c, cy * s, sy * c, -sy * s);
      program.write("turned.toml", scene.substr(0, at) + "q = [" + position + scene.substr(end));
      const auto all = answer(program, "turned.toml --quantity g", "g"),
                 fixed = answer(program, "turned.toml --base fixed --quantity g", "g");
      BOOST_REQUIRE(all.size() == 9u);
      BOOST_REQUIRE(fixed.size() == 3u);
      double most = 0;
      for (const double g : all) most = std::max(most, std::abs(g));
      for (std::size_t k = 0; k < 3; ++k)  // 1e-15 seen
        BOOST_TEST(std::abs(fixed[k] - all[k + 6]) < 1e-14 * most,
                   "e = " << e << ", roll " << roll);
    }
}

BOOST_AUTO_TEST_CASE(changes_that_mean_nothing_are_refused) {
  const Program program;
  const std::string words = "evaluate simple_pendulum --quantity M ";
  refuses(program, words + "--set mass:bobb=1", "no link 'bobb' (did you mean bob?)");
  refuses(program, words + "--set weight:bob=1", "'weight' is none");
  refuses(program, words + "--set k=1", "no parameter 'k'");
  refuses(program, words + "--set mass:bob=x", "read 'x'");
  refuses(program, words + "--set mass:bob=-1", "mass");
  refuses(program, words + "--set com:bob=1,2", "x,y,z");
  refuses(program, words + "--gravity 0,1", "x,y,z");
  refuses(program, words + "--base fixed", "no link floats");
  refuses(program, "evaluate satellite_arm --quantity M --base floating", "floats already");
  refuses(program, "evaluate car_axis --quantity M --base floating", "--base floating");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(motions)

// By the complete elliptic integral of the first kind: T = 4 K(sin(q0 / 2)) sqrt(l / g).
BOOST_AUTO_TEST_CASE(a_motion_starts_where_it_is_told_and_ends_at_an_event) {
  const Program program;
  const double period = 4 * boost::math::ellint_1(std::sin(0.5)) / std::sqrt(9.81);
  const std::string words =
      "simulate simple_pendulum --q 1 --qd 0 --once --json out.json --until 'q1 = 0 falling' ";
  const Outcome three = program.run(words + "--times 3");
  BOOST_TEST_REQUIRE(three.status == 0, three.out);
  const auto times = nlohmann::json::parse(program.read("out.json"))["events"]["times_s"];
  BOOST_REQUIRE(times.size() == 3u);
  for (std::size_t k = 0; k < 3; ++k)  // measured: 2e-11, at an error of 1e-10 a step
    BOOST_TEST(std::abs(times[k].get<double>() - (0.25 + static_cast<double>(k)) * period) < 1e-9);
  BOOST_TEST(has(three.out, "period"));
  BOOST_TEST(program.run(words + "--times 100").status == 1);  // 10 s are not enough
  refuses(program, "simulate simple_pendulum --until 'q3 = 0'",
          "--until: \"q3\" is none of the scene's");
  refuses(program, "simulate simple_pendulum --until 'q1 = 0' --method runge_kutta4",
          "with an event to wait for");
  // a row of a file is the same start
  program.write("s.csv", "time_s,q1,qd1\n0,2,0\n0,1,0\n");
  const std::string from_file =
      "simulate simple_pendulum --once --duration 1 --outputs 2 --csv b.csv --states s.csv --row ";
  BOOST_TEST(program.run(from_file + "2").status == 0);
  program.run("simulate simple_pendulum --once --duration 1 --outputs 2 --csv a.csv --q 1 --qd 0");
  BOOST_TEST(program.read("a.csv") == program.read("b.csv"));
  BOOST_TEST(table(program.read("a.csv"))[1][1] == "1");
  refuses(program, from_file + "3", "the file has 2 rows");
  BOOST_TEST(has(program.run("drift simple_pendulum --q 0.1 --qd 0 --duration 1").out, "scale_J"));
}

// By hand: without gravity qdd = tau (m l^2 = 1), so that tau = cos t moves it by 1 - cos t, and
// tau = t, a line between two rows, by t^3 / 6.
BOOST_AUTO_TEST_CASE(forces_over_time_move_a_scene) {
  const Program program;
  const std::string words =
      "simulate simple_pendulum --gravity 0,0,0 --q 0 --qd 0 --once --duration 2 --outputs 4 --csv "
      "m.csv ";
  for (const char* method : {"", "--method runge_kutta4", "--method radau_iia_5"}) {
    BOOST_TEST_REQUIRE(program.run(words + method + " --tau 'pivot=cos(t)'").status == 0, method);
    const auto rows = table(program.read("m.csv"));
    BOOST_REQUIRE(rows.size() == 6u);
    for (std::size_t k = 1; k < 6; ++k) {
      const double t = std::stod(rows[k][0]);
      BOOST_TEST(std::abs(std::stod(rows[k][1]) - (1 - std::cos(t))) < 1e-9, method);  // 5e-12 seen
      BOOST_TEST(std::abs(std::stod(rows[k].back())) < 1e-9,
                 method);  // energy less work: 5e-11 seen
    }
  }
  // what was simulated is a trajectory: nothing is left of its equations, and power is tau qd
  const Outcome along = program.run(
      "evaluate simple_pendulum --gravity 0,0,0 --states m.csv --keep --quantity power,residual",
      "2>/dev/null");
  BOOST_TEST_REQUIRE(along.status == 0);
  const auto motion = table(along.out);
  BOOST_TEST(motion[0][0] == "time_s");
  for (std::size_t k = 1; k < 6; ++k) {
    const double t = std::stod(motion[k][0]);
    BOOST_TEST(std::abs(std::stod(motion[k][motion[k].size() - 2]) - std::cos(t) * std::sin(t)) <
               1e-9);
    BOOST_TEST(std::abs(std::stod(motion[k].back())) < 1e-15);
  }
  program.write("f.csv", "t,tau1\n0,0\n2,2\n");
  BOOST_TEST_REQUIRE(program.run(words + "--forces f.csv").status == 0);
  BOOST_TEST(std::stod(table(program.read("m.csv"))[5][1]) == 8.0 / 6,
             boost::test_tools::tolerance(1e-9));
  program.write("half.csv", "q1,qdd1\n0.5,1\n");
  refuses(program, "evaluate simple_pendulum --quantity residual --states half.csv",
          "not both qdd and tau given");
  program.write("off.csv", "q1,qdd1,tau1\n0,1,0.75\n");  // M = 1
  BOOST_TEST(answer(program, "simple_pendulum --quantity residual --states off.csv",
                    "residual")[0] == 0.25);
  refuses(program, words + "--tau elbow=1", "none of the scene's");
  refuses(program, words + "--tau 'pivot=1/t'", "not finite at t = 0");
  refuses(program, "simulate simple_pendulum --duration 3 --forces f.csv", "do not span 0 to 3 s");
}

// What motors do, a controller's part of it too, is in the table: nothing is left of the equations.
BOOST_AUTO_TEST_CASE(the_forces_of_a_controller_are_in_the_table) {
  const Program program;
  for (const char* how : {"acrobot --posture 100,20 --tau 1,2", "acrobot --posture 100,20",
                          "two_handed --controller impedance --task-gains 100,20 --duration 0.5"}) {
    const std::string scene = std::string(how).substr(0, std::string(how).find(' '));
    const Outcome run = program.run(fmt::format("simulate {} --once --outputs 4 --csv t.csv", how));
    BOOST_TEST_REQUIRE(run.status == 0, run.out);
    if (scene != "acrobot") {  // closures: tau is there, and its residual is not that of a tree
      BOOST_TEST(has(program.read("t.csv"), ",tau1,"));
      continue;
    }
    const auto left = table(
        program.run("evaluate acrobot --states t.csv --keep --quantity residual", "2>/dev/null")
            .out);
    BOOST_REQUIRE(left.size() == 6u);
    for (std::size_t k = 1; k < left.size(); ++k)
      for (std::size_t i = left[k].size() - 2; i < left[k].size(); ++i)
        BOOST_TEST(std::abs(std::stod(left[k][i])) < 1e-11, how);  // of up to 100 N m: 3e-14 seen
  }
}

// Of joints with several axes a posture says nothing.
BOOST_AUTO_TEST_CASE(a_posture_holds_joints_of_one_axis) {
  const Program program;
  BOOST_TEST_REQUIRE(program
                         .run("simulate cylindrical_arm --once --outputs 2 --duration 0.2 --csv "
                              "with.csv --posture 50,5")
                         .status == 0);
  const auto rows = table(program.read("with.csv"));
  const std::vector<double> tau = under(rows, 2, "tau");
  BOOST_REQUIRE(tau.size() == 3u);
  BOOST_TEST(tau[0] == 0);  // slide and turn of one joint
  BOOST_TEST(tau[1] == 0);
  BOOST_TEST(tau[2] != 0);
}

BOOST_AUTO_TEST_CASE(what_was_not_compared_is_not_said_to_agree) {
  const Program program;
  const std::string words =
      "simulate double_pendulum --q 1,0.5 --qd 0,0 --until 'q2 = 0 rising' --step-error 1e-3 ";
  const Outcome first = program.run(words + "--duration 100 --outputs 1");
  BOOST_TEST(has(first.out, "not known: the event is before the first row"));
  BOOST_TEST(!has(first.out, "agree to"));
  BOOST_TEST(has(first.out, "s earlier or later"));
  // a chaotic motion passes another number of times
  const Outcome many = program.run(words + "--times 30 --duration 40 --outputs 100");
  BOOST_TEST(many.status == 1);
}

BOOST_AUTO_TEST_CASE(a_name_that_two_places_have_is_refused) {
  const Program program;
  std::string scene = program.run("write acrobot --format toml", "2>/dev/null").out;
  const auto rename = [&](const std::string& from, const std::string& to) {
    const std::string line = "name = \"" + from + "\"";
    BOOST_REQUIRE(has(scene, line));
    scene.replace(scene.find(line), line.size(), "name = \"" + to + "\"");
  };
  rename("shoulder", "q2");
  rename("elbow", "q1");
  program.write("scene.toml", scene);
  const std::string both = "is a joint's name and the place of another one";
  refuses(program, "evaluate scene.toml --quantity M --q q2=0.3", both);
  refuses(program, "simulate scene.toml --until 'q2 = 0'", both);
  BOOST_TEST(program.run("evaluate scene.toml --quantity M --qd q2=0.3").status == 0);
  refuses(program, "simulate acrobot --tau elbow=1,elbow=2", "given before");
  refuses(program, "evaluate acrobot --quantity qdd --tau elbow=1,tau2=2", "given before");
}

// `show`: the fingers' leader is q2 and the thumb q3; followers are where these put them.
BOOST_AUTO_TEST_CASE(followers_are_no_places_of_their_own) {
  const Program program;
  const auto q = [&](const std::string& words) {
    BOOST_TEST_REQUIRE(
        program
            .run("simulate gripper --qd 0,0,0 --once --duration 1e-6 --outputs 1 --csv q.csv " +
                 words)
            .status == 0);
    return table(program.read("q.csv"))[1];
  };
  BOOST_TEST(q("--q thumb_base=0.5")[3] == "0.5");
  BOOST_TEST(q("--q thumb_base=0.5") == q("--q q3=0.5"), boost::test_tools::per_element());
  BOOST_TEST(q("--q 0.1,0.01,0.5")[2] == "0.01");
  refuses(program, "simulate gripper --q 1,2,3,4,5", "5 values, allowed: 3");
}

BOOST_AUTO_TEST_CASE(a_start_without_rates_is_told_and_columns_that_nobody_reads) {
  const Program program;
  program.write("s.csv", "time_s,q1,q2,qdot1,qdot2\n0,1,0.5,9,9\n");
  const Outcome run =
      program.run("simulate acrobot --states s.csv --once --duration 0.1 --outputs 1", "2>&1");
  BOOST_TEST(has(run.out, "at rest"));
  BOOST_TEST(has(run.out, "not read: qdot1, qdot2"));
}

BOOST_AUTO_TEST_CASE(a_convention_is_told_above_the_header_whatever_its_blanks) {
  const Program program;
  const std::string rows = "q1,q2,q3,q4\n1,0,0,0\n",
                    ask = "evaluate heavy_top --quantity g --states s.csv";
  program.write("s.csv", "#convention:mujoco\n" + rows);
  BOOST_TEST(program.run(ask).status == 0);
  refuses(program, ask + " --convention dynwitness", "the file's convention is mujoco");
  program.write("s.csv", rows + "# convention: mujoco\n");
  refuses(program, ask + " --convention dynwitness", "below the header");
}

BOOST_AUTO_TEST_CASE(columns_may_have_the_names_of_joints) {
  const Program program;
  program.write("named.csv",
                "elbow.qd,shoulder.qd,elbow,shoulder.q,elbow.qdd,shoulder.qdd\n4,3,2,1,6,5\n");
  program.write("numbered.csv", "q1,q2,qd1,qd2,qdd1,qdd2\n1,2,3,4,5,6\n");
  const std::string asked = "evaluate double_pendulum --quantity tau,c --states ";
  const Outcome named = program.run(asked + "named.csv");
  BOOST_TEST(named.status == 0, named.out);
  BOOST_TEST(named.out == program.run(asked + "numbered.csv").out);
  program.write("twice.csv", "shoulder,q1,q2\n1,1,2\n");
  refuses(program, asked + "twice.csv", "twice.csv:1: column 'q1' stands twice");
  program.write("slip.csv", "shoulder,elbow.qs\n1,2\n");
  refuses(
      program, asked + "slip.csv",
      "slip.csv:1: column 'elbow.qs' is unknown (did you mean elbow.q?); column 'q2' is missing, "
      "allowed: q1..q2");
}

BOOST_AUTO_TEST_CASE(all_faults_of_a_states_file_are_told_at_once) {
  const Program program;
  std::string rows = "t,q1,qd1\n0,1,1\n";
  for (int k = 0; k < 15; ++k) rows += "x,y,1\n0,1,1\n";
  program.write("s.csv", rows + "0,1\n");
  const Outcome all =
      program.run("evaluate simple_pendulum --states s.csv --keep --quantity M,c -o out.csv");
  BOOST_TEST(all.status == 2);
  // t is the user's own column
  BOOST_TEST(has(all.out, "s.csv:3: q1 is 'y', allowed: a finite number\ns.csv:5: q1 is 'y'"));
  BOOST_TEST(has(all.out, "s.csv:33: 2 entries, the header names 3"));
  BOOST_TEST(!has(all.out, "more faults"));
  BOOST_TEST(!program.exists("out.csv"));
  program.write("cells.csv", "q1,qd1\nx,\n" + rows.substr(rows.find('\n') + 1));
  const Outcome cells = program.run("evaluate simple_pendulum --states cells.csv --quantity M,c");
  BOOST_TEST(
      has(cells.out, "cells.csv:2: q1 is 'x', allowed: a finite number\ncells.csv:2: qd1 is ''"));
  BOOST_TEST(has(cells.out, "... and 13 more faults"));
  // whoever writes into a pipe is told at once
  const Outcome piped =
      program.run("evaluate simple_pendulum --states - --quantity M,c < cells.csv");
  BOOST_TEST(piped.status == 2);
}

// A tip without mass makes M singular; what it weighs may be said beside the file.
BOOST_AUTO_TEST_CASE(what_a_urdf_lacks_may_be_set) {
  const Program program;
  program.write("arm.urdf",
                "<robot name=\"r\"><link name=\"base\"/><link name=\"tip\"/>\n"
                "<joint name=\"j\" type=\"continuous\"><parent link=\"base\"/><child link=\"tip\"/>"
                "<axis xyz=\"0 1 0\"/></joint></robot>\n");
  refuses(program, "evaluate arm.urdf --quantity qdd --tau 0", "nothing that it carries has mass");
  const std::string asked = " --quantity M,g --q 0",
                    set = " --set mass:tip=2 --set com:tip=0.5,0,0";
  program.write("mine.toml",
                "like = \"arm.urdf\"\n[set]\n\"mass:tip\" = 2\n\"com:tip\" = [0.5, 0, 0]\n");
  for (const std::string& words : {"arm.urdf" + set, std::string("mine.toml")}) {
    const Outcome outcome = program.run("evaluate " + words + asked, "2>/dev/null");
    BOOST_TEST(outcome.status == 0, words);
    const std::vector<std::vector<std::string>> rows = table(outcome.out);
    BOOST_TEST_REQUIRE(rows.size() == 2u, words);
    BOOST_TEST(std::stod(rows[1][0]) == 0.5, boost::test_tools::tolerance(1e-15));    // m c^2
    BOOST_TEST(std::stod(rows[1][1]) == -9.81, boost::test_tools::tolerance(1e-15));  // -m g c
  }
  refuses(program, "simulate arm.urdf --set damping:j=1", "changed by the command line");
}

BOOST_AUTO_TEST_CASE(several_methods_are_drawn_in_one_picture) {
  const Program program;
  const Outcome drawn =
      program.run("drift furuta_pendulum --method runge_kutta4,gauss_4 --duration 1 --plot d.svg");
  BOOST_TEST_REQUIRE(drawn.status == 0, drawn.out);
  const std::string picture = program.read("d.svg");
  for (const char* seen : {"runge_kutta4: order ", "gauss_4: order ", "step size  [s]"})
    BOOST_TEST(has(picture, seen), seen);
  BOOST_TEST(program.fileCount() == 1u);
}

// A picture against the step would be one point a method.
BOOST_AUTO_TEST_CASE(several_methods_with_one_step_are_drawn_against_time) {
  const Program program;
  const Outcome drawn = program.run(
      "drift simple_pendulum --method runge_kutta4,gauss_4 --step 0.05 --duration 20 --plot d.svg");
  BOOST_TEST_REQUIRE(drawn.status == 0, drawn.out);
  const std::string picture = program.read("d.svg");
  for (const char* seen :
       {"runge_kutta4: 0.05 s, at most ", "gauss_4: 0.05 s, at most ", "time  [s]"})
    BOOST_TEST(has(picture, seen), seen);
  BOOST_TEST(program.fileCount() == 1u);
}

BOOST_AUTO_TEST_CASE(a_motion_is_drawn_as_it_is_given) {
  const Program program;
  BOOST_TEST(
      program.run("simulate double_pendulum --duration 1 --outputs 20 --once --csv m.csv").status ==
      0);
  const Outcome drawn = program.run(
      "evaluate double_pendulum --states m.csv --quantity tau,power,kinetic,potential --format svg -o m.svg");
  BOOST_TEST_REQUIRE(drawn.status == 0, drawn.out);
  const std::string picture = program.read("m.svg");
  for (const char* seen :
       {"tau  [N m]", "power  [W]", "energy  [J]", "time  [s]", ">tau2<", ">sum<",
        "Double pendulum of uniform rods", "double_pendulum along m.csv"})
    BOOST_TEST(has(picture, seen), seen);
  BOOST_TEST(program.fileCount() == 2u);  // no work is left behind
  BOOST_TEST(
      program
          .run("evaluate double_pendulum --states m.csv --quantity tau --format svg", "2>/dev/null")
          .out.find("<svg") != std::string::npos);
  program.write("no_time.csv", "q1,q2,qd1,qd2\n0,0,1,1\n");
  refuses(
      program, "evaluate double_pendulum --states no_time.csv --quantity M --format svg -o n.svg",
      "no_time.csv: --format svg, png or pdf without a column of time, allowed: t, time or time_s");
  refuses(program, "evaluate double_pendulum --quantity tau --format svg",
          "--format svg, png or pdf without a motion");
  refuses(program, "evaluate humanoid_floating --states x.csv --quantity X,M_A --format svg",
          "x.csv");
  BOOST_TEST(!program.exists("n.svg"));
}

BOOST_AUTO_TEST_SUITE_END()
