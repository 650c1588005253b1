// SPDX-License-Identifier: GPL-3.0-or-later
// The program as its user meets it: exit status, messages, and that nothing is half written.
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE command_line
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

namespace fs = std::filesystem;

namespace {

struct Outcome {
  int status;
  std::string out;  // standard output and standard error
};

/// Runs the program in a folder of its own.
class Program {
 public:
  Program() : folder_(fs::temp_directory_path() / ("dynwitness_cli_" + std::to_string(getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~Program() { fs::remove_all(folder_); }

  Outcome run(const std::string& words, const std::string& redirect = "2>&1") const {
    const std::string command = "cd '" + folder_.string() + "' && " + DYNWITNESS_PROGRAM + " " +
                                words + " " + redirect;
    FILE* pipe = popen(command.c_str(), "r");
    BOOST_REQUIRE(pipe != nullptr);
    Outcome outcome{0, ""};
    std::array<char, 4096> buffer;
    for (std::size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
      outcome.out.append(buffer.data(), n);
    outcome.status = WEXITSTATUS(pclose(pipe));
    return outcome;
  }
  void write(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ / file) << text;
  }
  std::string read(const std::string& file) const {
    std::ifstream in(folder_ / file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  bool exists(const std::string& file) const { return fs::exists(folder_ / file); }
  std::size_t fileCount() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

 private:
  fs::path folder_;
};

void refuses(const Program& program, const std::string& words, const std::string& part) {
  const Outcome outcome = program.run(words);
  BOOST_TEST_CONTEXT(words << "\n" << outcome.out) {
    BOOST_TEST(outcome.status == 2);
    BOOST_TEST(outcome.out.find(part) != std::string::npos);
  }
}

}  // namespace

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(wrong_usage_is_refused_with_status_2) {
  const Program program;
  refuses(program, "", "subcommand");
  refuses(program, "crosschek", "subcommand");
  refuses(program, "crosscheck --states 0", "--states");
  refuses(program, "crosscheck 'no such scene'", "double_pendulum");  // the names that exist
  refuses(program, "crosscheck missing.toml", "missing.toml");
  refuses(program, "crosscheck acrobot --witness simbdy", "newton_euler");
  refuses(program, "derive acrobot --format pdf", "latex");
  refuses(program, "drift acrobot --method rk5", "runge_kutta4");
  refuses(program, "drift acrobot --step 0", "allowed: positive");
  refuses(program, "drift prismatic_revolute_mix", "energy is not constant");
  refuses(program, "drift bricard", "dynwitness simulate");
  refuses(program, "simulate bricard --stabilisation hope", "projection");
  refuses(program, "simulate bricard --method rk5", "runge_kutta_dopri5");
  refuses(program, "simulate four_bars_0", "four_bars_N with N from 1 to 200");
  BOOST_TEST(program.fileCount() == 0u);  // and nothing was written
}

BOOST_AUTO_TEST_CASE(a_bad_scene_is_refused_with_its_line) {
  const Program program;
  program.write("scene.toml", "title = \"x\"\nsource = \"x\"\ngravty = [0, 0, -9.81]\n");
  refuses(program, "crosscheck scene.toml", "scene.toml:3: ");
  refuses(program, "crosscheck scene.toml", "gravity");  // what is allowed
  BOOST_TEST(!program.exists("report"));
}

BOOST_AUTO_TEST_CASE(a_scene_in_which_nothing_moves_is_refused) {
  const Program program;
  program.write("rock.toml", "title = \"x\"\nsource = \"x\"\n[[link]]\nname = \"rock\"\nmass = 1\n");
  refuses(program, "crosscheck rock.toml", "rock.toml: no joint moves");
  refuses(program, "drift rock.toml", "rock.toml: no joint moves");
}

BOOST_AUTO_TEST_CASE(a_bad_states_file_is_refused_with_its_line) {
  const Program program;
  const std::string words = "evaluate acrobot --quantity tau -o out.csv --states ";
  refuses(program, words + "none.csv", "none.csv: cannot be read");
  const std::string good = "q1,q2,qd1,qd2,qdd1,qdd2\n";
  program.write("nan.csv", good + "0,0,0,nan,0,0\n");
  refuses(program, words + "nan.csv", "nan.csv:2: qd2 is 'nan', allowed: a finite number");
  program.write("word.csv", "# a comment\n" + good + "0,0,0,0,0,0\n0,x,0,0,0,0\n");
  refuses(program, words + "word.csv", "word.csv:4: q2 is 'x'");
  program.write("blank.csv", good + "1 2,0,0,0,0,0\n");  // a lost comma is not the number 12
  refuses(program, words + "blank.csv", "blank.csv:2: q1 is '1 2'");
  program.write("unknown.csv", "q1,q2,q3\n");
  refuses(program, words + "unknown.csv", "unknown.csv:1: column 'q3' is unknown");
  program.write("missing.csv", "q1,qd1,qd2\n");
  refuses(program, words + "missing.csv", "column 'q2' is missing");
  program.write("twice.csv", "q1,q2,q1\n");
  refuses(program, words + "twice.csv", "column 'q1' stands twice");
  program.write("short.csv", good + "0,0,0\n");
  refuses(program, words + "short.csv", "short.csv:2: 3 entries, the header names 6");
  program.write("empty.csv", "");
  refuses(program, words + "empty.csv", "no header");
  program.write("good.csv", good + "0,0,0,0,0,0\n");
  refuses(program, "evaluate acrobot --quantity torque --states good.csv", "unknown quantity 'torque'");
  refuses(program, "evaluate acrobot --quantity qdd --witness newton_euler --states good.csv",
          "does not answer qdd");
  BOOST_TEST(!program.exists("out.csv"));
}

BOOST_AUTO_TEST_CASE(an_unwritable_report_folder_is_refused_before_any_work) {
  const Program program;
  program.write("file", "");
  refuses(program, "crosscheck acrobot --report file/report", "file");
  refuses(program, "crosscheck acrobot --report /proc/report", "/proc");
}

BOOST_AUTO_TEST_SUITE_END()
BOOST_AUTO_TEST_SUITE(results)

// The pendulum of the bundled scene has m = l = 1, g = 9.81: by hand, M = m l^2, g = m g l sin q.
BOOST_AUTO_TEST_CASE(evaluate_writes_one_row_a_state_in_full_precision) {
  const Program program;
  program.write("s.csv", "q1,qd1,qdd1\n0.5,2,3\n");
  const Outcome outcome = program.run(
      "evaluate 'simple pendulum' --quantity M,c,g,tau --states s.csv", "2>/dev/null");
  BOOST_TEST(outcome.status == 0);
  double M = 0, c = 0, g = 0, tau = 0;
  BOOST_TEST_CONTEXT(outcome.out)
  BOOST_REQUIRE(std::sscanf(outcome.out.c_str(), "M11,c1,g1,tau1\n%lf,%lf,%lf,%lf", &M, &c, &g,
                            &tau) == 4);
  BOOST_TEST(M == 1);
  BOOST_TEST(c == 0);
  BOOST_TEST(g == 9.81 * std::sin(0.5));
  BOOST_TEST(tau == 3 + 9.81 * std::sin(0.5));
}

BOOST_AUTO_TEST_CASE(the_same_scene_and_seed_give_the_same_bytes) {
  const Program program;
  const std::string words = "crosscheck furuta_pendulum cart_pole --states 20 --report ";
  const std::string fixed_date = "SOURCE_DATE_EPOCH=0 ";
  for (const char* folder : {"a", "b"})
    BOOST_TEST(program.run("version > /dev/null; " + fixed_date + DYNWITNESS_PROGRAM + " " + words +
                           folder).status == 0);
  for (const char* file : {"report.json", "junit.xml", "index.html"}) {
    BOOST_TEST(!program.read(std::string("a/") + file).empty());
    BOOST_TEST(program.read(std::string("a/") + file) == program.read(std::string("b/") + file));
  }
  for (const char* format : {"text", "latex", "html", "c", "python"}) {
    const std::string derive = std::string("derive furuta_pendulum --format ") + format;
    BOOST_TEST(program.run(derive).out == program.run(derive).out);
  }
}

// In free fall Runge-Kutta makes no error of its own, so no order can be seen: that is no disagreement.
BOOST_AUTO_TEST_CASE(a_motion_without_integration_error_agrees) {
  const Program program;
  program.write("fall.toml",
                "title = \"x\"\nsource = \"x\"\ngravity = [0, 0, -9.81]\n[[link]]\nname = \"base\"\n"
                "[[link]]\nname = \"slide\"\nparent = \"base\"\nmass = 1\n"
                "[link.joint]\nkind = \"prismatic\"\n");
  const Outcome outcome = program.run("crosscheck fall.toml --states 5");
  BOOST_TEST_CONTEXT(outcome.out) BOOST_TEST(outcome.status == 0);
}

// The user's own scene may be called like a bundled one: the published table is not about it.
BOOST_AUTO_TEST_CASE(a_scene_with_a_bundled_name_is_not_held_to_the_table) {
  const Program program;
  program.write("simple_pendulum.toml",
                "title = \"x\"\nsource = \"x\"\ngravity = [0, 0, -1]\n[[link]]\nname = \"base\"\n"
                "[[link]]\nname = \"bob\"\nparent = \"base\"\nmass = 3\ncom = [0, 0, -2]\n"
                "[link.joint]\nkind = \"revolute\"\naxis = [0, 1, 0]\n[start]\nq = [1]\n");
  const Outcome outcome = program.run("crosscheck ./simple_pendulum.toml --states 5");
  BOOST_TEST_CONTEXT(outcome.out) BOOST_TEST(outcome.status == 0);
}

BOOST_AUTO_TEST_CASE(another_seed_draws_other_states) {
  const Program program;
  for (const char* seed : {"1", "2"})
    program.run(std::string("version > /dev/null; SOURCE_DATE_EPOCH=0 ") + DYNWITNESS_PROGRAM +
                " crosscheck acrobot --no-drift --states 20 --report r" + seed + " --seed " + seed);
  BOOST_TEST(program.read("r1/report.json") != program.read("r2/report.json"));
}

BOOST_AUTO_TEST_CASE(help_names_every_subcommand_and_succeeds) {
  const Program program;
  const Outcome outcome = program.run("--help");
  BOOST_TEST(outcome.status == 0);
  for (const char* word : {"crosscheck", "derive", "evaluate", "drift", "simulate", "scenes", "version"}) {
    BOOST_TEST(outcome.out.find(word) != std::string::npos);
    BOOST_TEST(program.run(std::string(word) + " --help").status == 0);
  }
}

BOOST_AUTO_TEST_CASE(simulate_says_drift_cost_and_whether_the_published_motion_agrees) {
  const Program program;
  const Outcome outcome = program.run(
      "simulate andrews_squeezer --duration 0.03 --tolerance 1e-11 --outputs 3 --csv m.csv");
  BOOST_TEST_CONTEXT(outcome.out) {
    BOOST_TEST(outcome.status == 0);
    BOOST_TEST(outcome.out.find("6 equations of rank 6, 1 freedoms") != std::string::npos);
    BOOST_TEST(outcome.out.find("7 values, agree") != std::string::npos);
  }
  const std::string csv = program.read("m.csv");
  BOOST_TEST(csv.find("time_s,q1,") == 0u);
  BOOST_TEST(std::count(csv.begin(), csv.end(), '\n') == 5);  // header, start and three outputs
  // a tolerance that cannot reach the printed digits is found out
  const Outcome coarse =
      program.run("simulate andrews_squeezer --duration 0.03 --tolerance 1e-4");
  BOOST_TEST_CONTEXT(coarse.out) {
    BOOST_TEST(coarse.status == 1);
    BOOST_TEST(coarse.out.find("DISAGREE") != std::string::npos);
  }
}

BOOST_AUTO_TEST_CASE(drift_prints_a_table_and_draws_a_chart) {
  const Program program;
  const Outcome outcome = program.run(
      "drift 'simple pendulum' --step 0.01,0.005 --duration 1 --plot p.svg --csv d.csv", "2>/dev/null");
  BOOST_TEST(outcome.status == 0);
  BOOST_TEST(outcome.out.find("method,step_s,worst_error,scale_J") != std::string::npos);
  BOOST_TEST(program.read("d.csv").find("runge_kutta4,0.005,") != std::string::npos);
  BOOST_TEST(program.read("p.svg").find("</svg>") != std::string::npos);
}

BOOST_AUTO_TEST_SUITE_END()
