// SPDX-License-Identifier: GPL-3.0-or-later
// One motion several times: simulate by several methods, and energy along motions that are given.
#include <boost/test/unit_test.hpp>

#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/fixtures/program.hpp"

using dynwitness::fixtures::Outcome;
using dynwitness::fixtures::Program;
using dynwitness::fixtures::refuses;

namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) out.push_back(line);
  return out;
}

/// The number that follows these words; NaN: they are not there.
double after(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  if (at == std::string::npos) return std::nan("");
  return std::strtod(text.c_str() + at + words.size(), nullptr);
}

/// A free pendulum m = l = 1 from q = 1 by steps of Heun's method, of order 2, in rows of a CSV.
std::string heunsMotion(double step, double duration, bool says_tau = false) {
  const auto qdd = [](double q) { return -9.81 * std::sin(q); };
  std::string csv = says_tau ? "t,q1,qd1,qdd1,tau1\n" : "t,q1,qd1,qdd1\n";
  double q = 1, qd = 0;
  const long steps = std::lround(duration / step);
  for (long k = 0; k <= steps; ++k) {
    csv += fmt::format("{:.17g},{:.17g},{:.17g},{:.17g}{}\n", static_cast<double>(k) * step, q, qd,
                       qdd(q), says_tau ? ",0.5" : "");
    const double q_end = q + step * qd, qd_end = qd + step * qdd(q);
    const double next = q + step / 2 * (qd + qd_end);
    qd += step / 2 * (qdd(q) + qdd(q_end));
    q = next;
  }
  return csv;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(motions_that_are_given)

// What Heun's method loses and gains along the way is of its own order.
BOOST_AUTO_TEST_CASE(energy_shows_the_order_between_motions_of_different_steps) {
  const Program program;
  program.write("coarse.csv", heunsMotion(0.001, 1));
  program.write("fine.csv", heunsMotion(0.0005, 1));
  const Outcome seen = program.run(
      "drift simple_pendulum --motion fine.csv,coarse.csv --plot e.svg --csv e.csv", "2>/dev/null");
  BOOST_TEST_REQUIRE(seen.status == 0, seen.out);
  const double order = after(seen.out, "# observed order ");
  BOOST_TEST(std::abs(order - 2) < 0.1, seen.out);
  const std::vector<std::string> table = linesOf(program.read("e.csv"));
  BOOST_REQUIRE(table.size() == 4u);
  BOOST_TEST(table[1] == "method,step_s,worst_error,scale_J");
  BOOST_TEST(has(table[2], "given motions,0.001,"), table[2]);
  BOOST_TEST(has(table[3], "given motions,0.0005,"), table[3]);
  const std::string picture = program.read("e.svg");
  BOOST_TEST(has(picture, "prefers-color-scheme: dark"));  // one for both
  BOOST_TEST(has(picture, "{ fill: #e7eaee }"));           // ink of style.gp in the dark
  for (const char* part : {"observed order", "time  [s]", "step size  [s]", "0.0005 s"})
    BOOST_TEST(has(picture, part), part);
  BOOST_TEST(program.fileCount() == 4u);

  const Outcome one = program.run("drift simple_pendulum --motion fine.csv", "2>/dev/null");
  BOOST_TEST(has(one.out, "# observed order not to be seen in one motion"), one.out);
}

// Rows need not be steps: then the user says what the steps were.
BOOST_AUTO_TEST_CASE(what_simulate_writes_goes_in_with_its_steps) {
  const Program program;
  for (const char* step : {"0.02", "0.01"})
    BOOST_TEST(program
                   .run(fmt::format("simulate double_pendulum --duration 1 --outputs 20 --once "
                                    "--method runge_kutta4 --step {0} --csv m{0}.csv",
                                    step))
                   .status == 0);
  const std::string files = "drift double_pendulum --motion m0.02.csv,m0.01.csv";
  const Outcome without = program.run(files, "2>/dev/null");
  BOOST_TEST(has(without.out, "their steps (--step) do not differ"), without.out);
  const Outcome with = program.run(files + " --step 0.02,0.01", "2>/dev/null");
  BOOST_TEST_REQUIRE(with.status == 0, with.out);
  const double order = after(with.out, "# observed order ");
  BOOST_TEST(order > 3.5, with.out);  // its own is 4, energy's may be 5
  refuses(program, files + " --step 0.02", "--step: 1 steps of 2 motions");
}

// tau is there, so that nothing is left of the equations of motion but rounding; reactions are
// those of evaluate.
BOOST_AUTO_TEST_CASE(what_simulate_writes_is_a_trajectory_with_its_reactions) {
  const Program program;
  BOOST_TEST(program
                 .run("simulate acrobot --duration 0.5 --outputs 2 --once --reactions --csv a.csv "
                      "--tau 'elbow=sin(3*t)'")
                 .status == 0);
  const std::vector<std::string> rows = linesOf(program.read("a.csv"));
  BOOST_REQUIRE(rows.size() == 4u);
  const Outcome again = program.run(
      "evaluate acrobot --states a.csv --keep --quantity residual,power", "2>/dev/null");
  BOOST_TEST_REQUIRE(again.status == 0, again.out);
  const auto cells = [](const std::string& row) {
    std::vector<double> out;
    std::istringstream words(row);
    for (std::string word; std::getline(words, word, ',');) out.push_back(std::stod(word));
    return out;
  };
  const std::vector<double> left = cells(linesOf(again.out)[3]);
  for (std::size_t k = left.size() - 3; k < left.size() - 1; ++k)  // a sum of some 10 N m
    BOOST_TEST(std::abs(left[k]) < 1e-13);
  program.write("q.csv", "q1,q2,qd1,qd2,qdd1,qdd2\n" + rows[3].substr(rows[3].find(',') + 1, [&] {
    std::size_t at = rows[3].find(',');
    for (int k = 0; k < 6; ++k) at = rows[3].find(',', at + 1);
    return at - rows[3].find(',') - 1;
  }()) + "\n");
  const Outcome reactions =
      program.run("evaluate acrobot --states q.csv --quantity reactions", "2>/dev/null");
  const std::vector<double> expected = cells(linesOf(reactions.out)[1]), all = cells(rows[3]);
  BOOST_REQUIRE(expected.size() == 12u);
  for (std::size_t k = 0; k < 12; ++k) BOOST_TEST(all[all.size() - 12 + k] == expected[k]);
}

BOOST_AUTO_TEST_CASE(forces_are_no_energy_error) {
  const Program program;
  program.write("pushed.csv", heunsMotion(0.01, 0.1, true));
  refuses(program, "drift simple_pendulum --motion pushed.csv",
          "pushed.csv: row 1: joint forces (tau), which change the energy");
  refuses(program, "drift simple_pendulum --engine-steps mujoco --plot e.svg",
          "--plot or --csv with --engine-steps");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(several_methods)

BOOST_AUTO_TEST_CASE(each_is_held_to_one_reference) {
  const Program program;
  const Outcome seen = program.run(
      "simulate furuta_pendulum --duration 1 --step 0.01 --method euler,runge_kutta4,gauss_6 "
      "--json m.json --csv m.csv --plot m.svg",
      "2>/dev/null");
  BOOST_TEST_REQUIRE(seen.status == 0, seen.out);
  std::map<std::string, double> off;
  const nlohmann::json said = nlohmann::json::parse(program.read("m.json"));
  for (const auto& run : said["runs"]) off[run["method"]] = run["q_error"];
  BOOST_REQUIRE(off.size() == 3u);
  BOOST_TEST(off["euler"] > 1000 * off["runge_kutta4"]);  // h = 0.01 to the first and fourth power
  BOOST_TEST(off["runge_kutta4"] > 10 * off["gauss_6"]);
  for (const char* method : {"euler", "runge_kutta4", "gauss_6"}) {
    BOOST_TEST(has(seen.out, method), method);
    BOOST_TEST(has(program.read("m.svg"), method), method);
  }
  const std::vector<std::string> rows = linesOf(program.read("m.csv"));
  BOOST_TEST(rows.size() == 1u + 3 * 101);
  BOOST_TEST(has(rows[0], "method,time_s,q1,"), rows[0]);
  BOOST_TEST(has(rows[102], "runge_kutta4,0,"), rows[102]);
  BOOST_TEST(program.fileCount() == 3u);  // no work is left behind
}

BOOST_AUTO_TEST_CASE(what_is_of_one_run_is_refused) {
  const Program program;
  const std::string two = "simulate acrobot --method gauss_4,runge_kutta4 ";
  refuses(program, two + "--until 'q2 = 0'", "--until with several runs");
  refuses(program, two + "--view v.html", "--view with several runs");
  refuses(program, two + "--once", "--once with several runs");
  refuses(program, two + "--compare", "--compare with several methods");
  refuses(program, "simulate acrobot --compare --csv c.csv", "--csv with --compare");
  refuses(program, "simulate acrobot --method gauss_4,gauss4", "unknown method 'gauss4'");
  refuses(program, "simulate acrobot --plot m.jpg", "ends in .svg, .png or .pdf");
  BOOST_TEST(program.fileCount() == 0u);
}

// The list of methods is one.
BOOST_AUTO_TEST_CASE(simulate_and_drift_name_the_same_methods) {
  const Program program;
  const auto listed = [&](const char* command) {
    const std::string out = program.run(fmt::format("{} acrobot --method none", command)).out;
    return out.substr(out.find("allowed: "));
  };
  BOOST_TEST(listed("simulate") == listed("drift"));
}

BOOST_AUTO_TEST_SUITE_END()
