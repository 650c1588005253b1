// SPDX-License-Identifier: GPL-3.0-or-later
// Tables, goals and file of the benchmarks, on numbers that were chosen here: no time is measured.
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include <boost/test/unit_test.hpp>
#include <nlohmann/json.hpp>

#include "crosscheck/report/bench.hpp"
#include "crosscheck/report/plot.hpp"
#include "crosscheck/report/report.hpp"
#include "crosscheck/system/gnuplot.hpp"
#include "scene/error.hpp"
#include "tests/fixtures/files.hpp"

namespace fs = std::filesystem;
using namespace dynwitness::crosscheck;
using dynwitness::files::contains;
using dynwitness::files::read;
using dynwitness::files::TemporaryFolder;
using dynwitness::scene::InputError;
using nlohmann::json;

namespace {

const std::string kAwkward = "a<b> & \"c\" 'd', <script>alert(1)</script>";

BenchResult sample() {
  BenchResult r;
  r.environment.version = "0.1.0";
  r.environment.compiler = "GNU 12.2.0";
  r.environment.cpu = kAwkward;
  r.environment.date = "2025-11-21T10:45:00Z";
  r.environment.libraries = {{"simbody", "3.7.0"}};
  r.processors = 2;
  r.load = 0.5;
  r.states = 1000;
  r.seed = 1;
  r.repetitions = 7;
  r.contenders = {{kRawMujoco, "MuJoCo 2.2.2"},
                  {kRawSimbody, "Simbody 3.7.0"},
                  {"fast", "fast sweeps, g++ 12", true},
                  {"kernel", kAwkward, true}};
  r.measured = {{"ID", "arm", kRawMujoco, "ns", 1000}, {"ID", "arm", kRawSimbody, "ns", 5000},
                {"ID", "arm", "fast", "ns", 125},      {"M", "arm", "fast", "ns", 60},
                {"FD", "arm", kRawMujoco, "ns", 1500}, {"FD", "arm", "kernel", "ns", 150},
                {"making", "arm", "kernel", "s", 2.5}, {"derivation", "arm", "lagrange", "MB", 25}};
  r.goals = {{1, "ID", "arm", "fast", kTimesMujoco, 10, true},    // 8 times
             {1, "M", "arm", "fast", kTimesMujoco, 5, true},      // MuJoCo's M is not there
             {2, "FD", "arm", "kernel", kTimesMujoco, 10, true},  // 10 times: reached
             {2, "making", "arm", "kernel", "s", 2, false},       // 2.5 s
             {5, "derivation", "arm", "lagrange", "MB", 50, false}};
  r.left_out = {"SymPy: " + kAwkward};
  return r;
}

struct BenchFolder : TemporaryFolder {
  fs::path file(const std::string& text) const {
    std::ofstream(path / "bench.json", std::ios::binary) << text;
    return path / "bench.json";
  }
};

}  // namespace

BOOST_AUTO_TEST_SUITE(goals)

// expected: by hand, from the numbers above
BOOST_AUTO_TEST_CASE(a_goal_is_reached_or_missed_by_so_much) {
  const BenchResult r = sample();
  const GoalVerdict fast = judge(r, r.goals[0]);
  BOOST_TEST(*fast.measured == 8);
  BOOST_TEST(*fast.times_simbody == 40);
  BOOST_TEST(fast.word() == "missed");
  BOOST_TEST(fast.missed_by == 25);  // 125 ns instead of 100
  const GoalVerdict unknown = judge(r, r.goals[1]);
  BOOST_TEST(!unknown.measured);
  BOOST_TEST(unknown.word() == "not measured");
  const GoalVerdict just = judge(r, r.goals[2]);
  BOOST_TEST(just.word() == "reached");
  BOOST_TEST(just.missed_by == 0);
  const GoalVerdict slow = judge(r, r.goals[3]);
  BOOST_TEST(slow.word() == "missed");
  BOOST_TEST(slow.missed_by == 25);
  BOOST_TEST(judge(r, r.goals[4]).word() == "reached");
}

namespace {

/// The best engine takes 800 ns a step, ours 200.
BenchResult withSteps() {
  BenchResult r = sample();
  r.contenders.push_back({"dart_raw", "DART 6"});
  for (const Measurement& m : {Measurement{kStep, "arm", kRawMujoco, "ns", 1000},
                               {kStep, "arm", "dart_raw", "ns", 800},
                               {kStep, "arm", "fast", "ns", 200},
                               {kRungeKuttaStep, "arm", "fast", "ns", 500}})
    r.measured.push_back(m);
  r.goals = {{8, kStep, "arm", "fast", kTimesBest, 4, true},
             {8, kStep, "arm", "fast", kTimesBest, 5, true},
             {8, kRungeKuttaStep, "arm", "fast", kTimesBest, 4, true}};
  return r;
}

}  // namespace

// expected: by hand
BOOST_AUTO_TEST_CASE(the_best_engine_is_the_fastest_that_is_not_ours) {
  const BenchResult r = withSteps();
  const GoalVerdict just = judge(r, r.goals[0]), missed = judge(r, r.goals[1]);
  BOOST_TEST(*just.measured == 4);
  BOOST_TEST(just.word() == "reached");
  BOOST_TEST(!just.times_simbody);
  BOOST_TEST(missed.missed_by == 25);
  BOOST_TEST(judge(r, r.goals[2]).word() == "not measured");  // no engine took that step
}

BOOST_FIXTURE_TEST_CASE(steps_have_tables_of_their_own, BenchFolder) {
  const BenchResult r = withSteps();
  const std::string text = benchText(r), page = benchSection(r, {});
  BOOST_TEST(contains(text, "arm, whole steps of time"), text);
  BOOST_TEST(contains(text, "200     5000 k    4.00"), text);
  BOOST_TEST(!contains(text, "arm, step: DART"), text);  // among other numbers
  BOOST_TEST(contains(page, "arm: whole steps of time"), page);
  BOOST_TEST(contains(page,
                      "<td class=\"n\">200</td><td class=\"n\">5000 k</td>"
                      "<td class=\"n\">4.00</td>"),
             page);
  BOOST_TEST(benchText(readBench(file(benchJson(r)))) == text);
}

namespace {

/// One core does 10 operations a ns, reads 4 bytes a ns far away and 40 nearby, and writes 8.
BenchResult withMachine() {
  BenchResult r = sample();
  for (const Measurement& m : {Measurement{kOperation, kMachine, "unfused", "ns", 0.125},
                               {kOperation, kMachine, "fused", "ns", 0.1},
                               {kMemoryRead, kMachine, "1024 KiB", "ns", 0.25},
                               {kMemoryRead, kMachine, "16 KiB", "ns", 0.025},
                               {kMemoryWritten, kMachine, "16 KiB", "ns", 0.125},
                               {kMemoryWritten, kMachine, "1024 KiB", "ns", 0.125},
                               {"ID", "arm", "fast", kOperationsWithSines, 250},
                               {"ID", "arm", "fast", kBytesRead, 80},
                               {"ID", "arm", "fast", kBytesWritten, 80},
                               {"ID", "arm", "fast", kBytesAtHand, 100 * 1024}})
    r.measured.push_back(m);
  return r;
}
void set(BenchResult* r, const char* unit, double value) {
  for (Measurement& m : r->measured)
    if (m.unit == unit) m.value = value;
}

}  // namespace

// expected: by hand
BOOST_AUTO_TEST_CASE(a_limit_is_what_takes_the_machine_longest) {
  BenchResult r = withMachine();
  const auto limit = [&] { return limitOf(r, "ID", "arm", "fast").value(); };
  BOOST_TEST(limit().ns == 25);  // 250 operations, 80 bytes in 2 ns, 80 out in 10
  BOOST_TEST(limit().of == "operations");
  BOOST_TEST(limit().times == 5);  // 125 ns
  set(&r, kBytesWritten, 320);
  BOOST_TEST(limit().ns == 40);
  BOOST_TEST(limit().of == "writing");
  set(&r, kBytesRead, 400);
  BOOST_TEST(limit().of == "writing");  // 10 ns of reading, as they are near
  set(&r, kBytesAtHand, 1024 * 1024);
  BOOST_TEST(limit().ns == 100);
  BOOST_TEST(limit().of == "reading");
  set(&r, kBytesAtHand, 1);  // less than the smallest array
  BOOST_TEST(limit().of == "writing");
  BOOST_TEST(!limitOf(r, "FD", "arm", "kernel"));  // nobody counted
  BOOST_TEST(!limitOf(sample(), "ID", "arm", "fast"));
}

BOOST_FIXTURE_TEST_CASE(limits_are_told_in_all_tables_and_in_the_file, BenchFolder) {
  const BenchResult r = withMachine();
  for (const std::string& text : {benchText(r), benchSection(r, {})}) {
    BOOST_TEST(contains(text, "25 ns operations"), text);
    BOOST_TEST(contains(text,
                        "one core: 8 GFLOP/s unfused, 10 GFLOP/s fused; reading 40 GB/s of "
                        "16 KiB, 4 GB/s of 1024 KiB; writing 8 GB/s of 16 KiB"),
               text);
    BOOST_TEST(!contains(text, kOperationsWithSines));
  }
  const std::string text = benchJson(r);
  const json said = json::parse(text)["goals"][0];
  BOOST_TEST(said["limit_ns"] == 25);
  BOOST_TEST(said["limit_of"] == "operations");
  BOOST_TEST(said["times_limit"] == 5);
  BOOST_TEST(!json::parse(text)["goals"][2].contains("limit_ns"));
  BOOST_TEST(benchJson(readBench(file(text))) == text);
}

BOOST_AUTO_TEST_CASE(the_tables_say_which_are_missed_and_by_how_much) {
  for (const std::string& text : {benchText(sample()), benchSection(sample(), {})}) {
    BOOST_TEST(contains(text, "2 of 5 goals reached, 2 missed, 1 not measured"), text);
    BOOST_TEST(contains(text, "MISSED by 25 %"), text);
    BOOST_TEST(contains(text, "fast sweeps, g++ 12"));
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(the_file)

BOOST_FIXTURE_TEST_CASE(what_is_read_is_what_was_written, BenchFolder) {
  const std::string text = benchJson(sample());
  BOOST_TEST(benchJson(readBench(file(text))) == text);
  const json said = json::parse(text);
  BOOST_TEST(said["measured"][2]["times_mujoco"] == 8);
  BOOST_TEST(said["measured"][2]["times_simbody"] == 40);
  BOOST_TEST(!said["measured"][6].contains("times_mujoco"));  // not a time of one evaluation
  BOOST_TEST(said["goals"][0]["missed_by_percent"] == 25);
  BOOST_TEST(!said["goals"][1].contains("measured"));
}

BOOST_FIXTURE_TEST_CASE(a_file_that_contradicts_itself_is_refused_with_the_place, BenchFolder) {
  const auto refused = [&](const std::string& place, const std::function<void(json&)>& change) {
    json said = json::parse(benchJson(sample()));
    change(said);
    const fs::path name = file(said.dump(1));
    BOOST_CHECK_EXCEPTION(readBench(name), InputError, [&](const InputError& e) {
      BOOST_TEST_MESSAGE(e.what());
      return contains(e.what(), name.string() + ": " + place);
    });
  };
  refused("/goals/0/verdict: read \"reached\", by the measurements it is \"missed\"",
          [](json& j) { j["goals"][0]["verdict"] = "reached"; });
  refused("/goals/0/measured: read 12, by the measurements it is 8",
          [](json& j) { j["goals"][0]["measured"] = 12; });
  refused("/measured/2/times_mujoco", [](json& j) { j["measured"][2]["times_mujoco"] = 9; });
  refused("/goals/0/measured: read 8.0, by the measurements it is 16.0",
          [](json& j) { j["measured"][0]["value"] = 2000; });
  refused("/measured/0/value: expected a time above 0 ns",
          [](json& j) { j["measured"][0]["value"] = 0; });
  refused("/measured/0/value: expected a number that is not negative, got \"fast\"",
          [](json& j) { j["measured"][0]["value"] = "fast"; });
  refused("/goals/0/wanted: expected a number above 0",
          [](json& j) { j["goals"][0]["wanted"] = 0; });
  refused("/goals/0/sense: read 'about', allowed are 'at least' and 'at most'",
          [](json& j) { j["goals"][0]["sense"] = "about"; });
  refused("/contenders/0: there is no field 'label'",
          [](json& j) { j["contenders"][0].erase("label"); });
  refused("/contenders: expected a list, got 3", [](json& j) { j["contenders"] = 3; });
  refused("/colour: no such field is expected", [](json& j) { j["colour"] = "red"; });
  refused("there is no field 'measured'", [](json& j) { j = json{{"dynwitness", "0.1.0"}}; });
  refused("expected an object, got [1]", [](json& j) { j = json::array({1}); });
}

BOOST_FIXTURE_TEST_CASE(what_is_no_such_file_is_refused, BenchFolder) {
  BOOST_CHECK_EXCEPTION(
      readBench(file("{\n \"dynwitness\": }")), InputError, [&](const InputError& e) {
        return contains(e.what(),
                        "bench.json:2: is not JSON; expected a file that `dynwitness bench` wrote");
      });
  for (const fs::path& name : {path / "nothing.json", path})
    BOOST_CHECK_EXCEPTION(readBench(name), InputError, [&](const InputError& e) {
      return contains(e.what(), name.string() + ": ");
    });
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(chart)

BOOST_AUTO_TEST_CASE(csv_has_ratios_and_what_the_goals_grant) {
  const std::string csv = benchCsv(sample());
  BOOST_TEST(
      contains(csv, "\nscene,formula,contender,time_ns,times_mujoco,times_simbody,goal_ns\n"), csv);
  BOOST_TEST(contains(csv, "\narm,ID,fast,125,8,40,100\n"), csv);  // 1000 ns / 10
  BOOST_TEST(contains(csv, "\narm,M,fast,60,,,\n"), csv);
  BOOST_TEST(!contains(csv, "making"));
}

BOOST_AUTO_TEST_CASE(without_times_there_is_no_chart) {
  BenchResult r = sample();
  r.measured = {{"making", "arm", "kernel", "s", 2.5}};
  BOOST_TEST(benchScript(r, "style.gp").empty());
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(report)

BOOST_FIXTURE_TEST_CASE(the_section_is_there_when_asked_for_and_only_then, BenchFolder) {
  CrosscheckResult result;
  const Environment environment = sample().environment;
  const BenchResult bench = sample();
  writeReport(result, environment, path / "with", {}, &bench);
  writeReport(result, environment, path / "without");
  const std::string page = read(path / "with/index.html");
  BOOST_TEST(contains(page, "<h2 id=\"speed\">Speed</h2>"));
  BOOST_TEST(!contains(page, "<script"));
  BOOST_TEST(
      (json::parse(read(path / "with/report.json"))["speed"] == json::parse(benchJson(bench))));
  BOOST_TEST(fs::exists(path / "with/bench/bench.csv"));
  if (gnuplotVersion() != "not found") {
    BOOST_TEST(contains(page, "<img src=\"bench/bench.svg\""), page);
    BOOST_TEST(contains(read(path / "with/bench/bench.svg"), "</svg>"));
  }
  BOOST_TEST(!contains(read(path / "without/index.html"), "Speed"));
  BOOST_TEST(!contains(read(path / "without/report.json"), "speed"));
  BOOST_TEST(!fs::exists(path / "without/bench"));
}

BOOST_FIXTURE_TEST_CASE(the_program_refuses_another_file_before_it_works, BenchFolder) {
  const fs::path other = file("{\"headline\": \"a report\"}");
  const std::string command = std::string(DYNWITNESS_PROGRAM) +
                              " crosscheck simple_pendulum --bench " + other.string() + " -o " +
                              (path / "report").string() + " >" + (path / "out").string() + " 2>" +
                              (path / "err").string();
  const int status = std::system(command.c_str());
  BOOST_TEST((WIFEXITED(status) && WEXITSTATUS(status) == 2));
  BOOST_TEST(contains(read(path / "err"), other.string() +
                                              ": there is no field 'measured'; expected a file "
                                              "that `dynwitness bench` wrote"));
  BOOST_TEST(!fs::exists(path / "report"));
}

BOOST_AUTO_TEST_SUITE_END()
