// SPDX-License-Identifier: GPL-3.0-or-later
// The program as its user meets it: exit status, messages, and that nothing is half written.
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/fixtures/program.hpp"

namespace fs = std::filesystem;
using dynwitness::fixtures::Outcome;
using dynwitness::fixtures::Program;
using dynwitness::fixtures::refuses;

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(wrong_usage_is_refused_with_status_2) {
  const Program program;
  refuses(program, "", "no command is given, allowed");
  refuses(program, "crosschek", "(did you mean crosscheck?)");
  refuses(program, "crosscheck --random 0", "--random");
  refuses(program, "crosscheck 'no such scene'", "`dynwitness scenes` lists");
  refuses(program, "crosscheck missing.toml", "missing.toml");
  refuses(program, "crosscheck acrobot --witness simbdy", "newton_euler");
  refuses(program, "derive acrobot --format pdf", "latex");
  refuses(program, "drift acrobot --method rk5", "runge_kutta4");
  refuses(program, "drift acrobot --step 0", "allowed: positive");
  refuses(program, "drift prismatic_revolute_mix", "energy is not constant");
  refuses(program, "drift puma_560_friction", "has Coulomb friction");
  refuses(program, "drift bricard", "dynwitness simulate");
  refuses(program, "simulate bricard --stabilisation hope", "projection");
  refuses(program, "simulate bricard --method rk5", "runge_kutta_dopri5");
  refuses(program, "simulate four_bars_0", "four_bars_N with N from 1 to 200");
  refuses(program, "geometry rolling_coin", "those of no surface");
  refuses(program, "geometry acrobot --q 1", "--q: 1 values, allowed: 2");
  refuses(program, "action rolling_coin", "no action stationary");
  refuses(program, "action acrobot --duration 0", "allowed: positive");
  refuses(program, "impulse acrobot --link nobody", "has no link 'nobody'");
  refuses(program, "impulse acrobot --wall 0,0,1 --impulse 1,0,0",
          "--wall seeks the impulse itself");
  refuses(program, "impulse acrobot --wall 0,0,0", "no direction");
  refuses(program, "impedance acrobot --stiffness 1,2", "--stiffness: 2 values, allowed: 6");
  refuses(program, "chart", "scene");
  refuses(program, "chart acrobot --quantity tau,c", "qdd");
  refuses(program, "chart acrobot --random 0", "--random");
  refuses(program, "chart acrobot --witness simbdy", "simbody");
  refuses(program, "parameters acrobot --uncertainty mas=1 --json p.json", "mass, inertia, rotor");
  refuses(program, "parameters acrobot --random 0", "--random");
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
  program.write("rock.toml",
                "title = \"x\"\nsource = \"x\"\n[[link]]\nname = \"rock\"\nmass = 1\n");
  refuses(program, "crosscheck rock.toml", "rock.toml: no joint moves");
  refuses(program, "drift rock.toml", "rock.toml: no joint moves");
  refuses(program, "chart rock.toml", "rock.toml: no joint moves");
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
  program.write("header.csv", "# motion\n" + good);
  refuses(program, words + "header.csv", "header.csv:2: no state after the header");
  refuses(program, "simulate acrobot --duration 0.1 --states header.csv",
          "header.csv:2: no state after the header");
  const Outcome piped = program.run(words + "-", "< header.csv 2>&1");
  BOOST_TEST(piped.status == 2);
  BOOST_TEST(piped.out.find("standard input:2: no state after the header") != std::string::npos,
             piped.out);
  BOOST_TEST(!program.exists("out.csv"));
  program.write("good.csv", good + "0,0,0,0,0,0\n");
  refuses(program, "evaluate acrobot --quantity torque --states good.csv",
          "unknown quantity 'torque'");
  refuses(program, "evaluate acrobot --quantity qdd --witness newton_euler --states good.csv",
          "does not answer qdd");
  BOOST_TEST(!program.exists("out.csv"));
}

BOOST_AUTO_TEST_CASE(an_unwritable_report_folder_is_refused_before_any_work) {
  const Program program;
  program.write("file", "");
  refuses(program, "crosscheck acrobot -o file/report", "file");
  refuses(program, "crosscheck acrobot -o /proc/report", "/proc");
  // 100000 states would take minutes
  refuses(program, "chart humanoid --random 100000 -o file/charts", "file");
  refuses(program, "chart humanoid --random 100000 -o /proc/charts", "/proc");
}

BOOST_AUTO_TEST_CASE(an_unwritable_file_is_refused_before_any_work) {
  const Program program;
  program.write("file", "");
  for (const std::string words : {"crosscheck --json ", "derive acrobot -o ",
                                  "evaluate acrobot --states none.csv --quantity M -o ",
                                  "drift acrobot --csv ", "drift acrobot --plot "}) {
    refuses(program, words + "none/out", "none/out: cannot be written: there is no folder none");
    refuses(program, words + "file/out", "there is no folder file");
    refuses(program, words + "/proc/out", "/proc/out: cannot be written");
    refuses(program, words + "/dev/null",
            "/dev/null: cannot be written: expected the name of a file");
    refuses(program, words + ".", "expected the name of a file");
  }
  BOOST_TEST(program.fileCount() == 1u);
}

// What is asked for first, the report's folder, need not exist for a file in it.
BOOST_AUTO_TEST_CASE(a_file_may_lie_in_the_folder_of_the_report) {
  const Program program;
  const std::string words = "crosscheck acrobot --no-drift --random 1 -o new --json new/a.json";
  BOOST_TEST(program.run(words).status == 0);
  BOOST_TEST(program.read("new/a.json") == program.read("new/report.json"));
}

BOOST_AUTO_TEST_SUITE_END()
BOOST_AUTO_TEST_SUITE(results)

// The list is what main programs are made of, and what the wrapper reads.
BOOST_AUTO_TEST_CASE(every_command_is_in_the_program_that_the_list_names_and_in_the_first_help) {
  const fs::path folder = fs::path(DYNWITNESS_SOURCE_DIR) / "crosscheck/cli";
  std::ifstream list(folder / "commands.txt");
  const Program program;
  const std::string help = program.run("--help").out;
  std::size_t listed = 0, shown_at = 0;
  for (std::string line; std::getline(list, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string name, of, what;
    words >> name >> of >> std::ws;
    std::getline(words, what);
    ++listed;
    const auto shown = help.find("  " + name + " ", shown_at);
    BOOST_TEST(shown != std::string::npos, name << " is not in its place in\n" << help);
    if (shown != std::string::npos) shown_at = shown;
    const fs::path direct = fs::path(DYNWITNESS_PROGRAM).parent_path() / of;
    const Outcome outcome =
        program.run(name + " --help && '" + direct.string() + "' " + name + " --help");
    BOOST_TEST(outcome.status == 0, outcome.out);
    const std::string said = std::regex_replace(outcome.out, std::regex("\n"), " ");
    const auto first = said.find(what), second = said.find(what, first + 1);
    BOOST_TEST((first != std::string::npos && second != std::string::npos),
               name << ": its help does not say '" << what << "':\n"
                    << outcome.out);
  }
  std::size_t commands = 2;  // of small_commands.cpp
  for (const auto& file : fs::directory_iterator(folder))
    commands += std::regex_match(file.path().filename().string(), std::regex("\\w+_command.cpp"));
  BOOST_TEST(listed == commands);
}

// The pendulum of the bundled scene has m = l = 1, g = 9.81: by hand, M = m l^2, g = m g l sin q.
BOOST_AUTO_TEST_CASE(evaluate_writes_one_row_a_state_in_full_precision) {
  const Program program;
  program.write("s.csv", "q1,qd1,qdd1\n0.5,2,3\n");
  const Outcome outcome =
      program.run("evaluate 'simple pendulum' --quantity M,c,g,tau --states s.csv", "2>/dev/null");
  BOOST_TEST(outcome.status == 0);
  double M = 0, c = 0, g = 0, tau = 0;
  BOOST_TEST_CONTEXT(outcome.out)
  BOOST_REQUIRE(
      std::sscanf(outcome.out.c_str(), "M11,c1,g1,tau1\n%lf,%lf,%lf,%lf", &M, &c, &g, &tau) == 4);
  BOOST_TEST(M == 1);
  BOOST_TEST(c == 0);
  BOOST_TEST(g == 9.81 * std::sin(0.5));
  BOOST_TEST(tau == 3 + 9.81 * std::sin(0.5));
}

// By hand, hanging straight down: the rod pulls m (g + l qd^2) up, and pushes m l qdd along -x.
BOOST_AUTO_TEST_CASE(evaluate_names_the_reactions_of_each_joint) {
  const Program program;
  program.write("s.csv", "q1,qd1,qdd1\n0,2,3\n");
  const Outcome outcome =
      program.run("evaluate simple_pendulum --quantity reactions --states s.csv", "2>/dev/null");
  BOOST_TEST(outcome.status == 0);
  double fx = 1, fy = 1, fz = 1, mx = 1, my = 1, mz = 1;
  BOOST_TEST_CONTEXT(outcome.out)
  BOOST_REQUIRE(
      std::sscanf(outcome.out.c_str(),
                  "pivot.fx,pivot.fy,pivot.fz,pivot.mx,pivot.my,pivot.mz\n%lf,%lf,%lf,%lf,%lf,%lf",
                  &fx, &fy, &fz, &mx, &my, &mz) == 6);
  BOOST_TEST(fx == -3);
  BOOST_TEST(fy == 0);
  BOOST_TEST(fz == 9.81 + 4);
  BOOST_TEST(mx == 0);
  BOOST_TEST(my == 3);
  BOOST_TEST(mz == 0);
}

BOOST_AUTO_TEST_CASE(rotors_shows_what_n_squared_J_leaves_out) {
  const Program program;
  const Outcome outcome = program.run("rotors gyroscopic_wrist --random 5 --json r.json");
  BOOST_TEST(outcome.status == 0);
  BOOST_TEST(outcome.out.find("largest tau") != std::string::npos);
  BOOST_TEST(program.fileCount() == 1u);
  refuses(program, "rotors acrobot", "has no rotor");
  refuses(program, "rotors gyroscopic_wrist --random 0", "--random");
}

BOOST_AUTO_TEST_CASE(the_same_scene_and_seed_give_the_same_bytes) {
  const Program program;
  const std::string words = "crosscheck furuta_pendulum cart_pole --random 20 -o ";
  const std::string fixed_date = "SOURCE_DATE_EPOCH=0 ";
  for (const char* folder : {"a --processes 1", "b --processes 2"})
    BOOST_TEST(
        program
            .run("version > /dev/null; " + fixed_date + DYNWITNESS_PROGRAM + " " + words + folder)
            .status == 0);
  for (const char* file : {"report.json", "junit.xml", "digits.md", "index.html"}) {
    BOOST_TEST(!program.read(std::string("a/") + file).empty());
    BOOST_TEST(program.read(std::string("a/") + file) == program.read(std::string("b/") + file));
  }
  for (const char* format : {"text", "latex", "html", "c", "python"}) {
    const std::string derive = std::string("derive furuta_pendulum --format ") + format;
    BOOST_TEST(program.run(derive).out == program.run(derive).out);
  }
}

// In free fall Runge-Kutta makes no error of its own, so no order can be seen: that is no
// disagreement.
BOOST_AUTO_TEST_CASE(a_motion_without_integration_error_agrees) {
  const Program program;
  program.write(
      "fall.toml",
      "title = \"x\"\nsource = \"x\"\ngravity = [0, 0, -9.81]\n[[link]]\nname = \"base\"\n"
      "[[link]]\nname = \"slide\"\nparent = \"base\"\nmass = 1\n"
      "[link.joint]\nkind = \"prismatic\"\n");
  const Outcome outcome = program.run("crosscheck fall.toml --random 5");
  BOOST_TEST_CONTEXT(outcome.out) BOOST_TEST(outcome.status == 0);
}

// Two sliders along one line, nothing between them: M = [2 2; 2 2]. Nobody is wrong about that.
BOOST_AUTO_TEST_CASE(a_singular_mass_matrix_is_no_disagreement) {
  const Program program;
  program.write(
      "sliders.toml",
      "title = \"x\"\nsource = \"x\"\n[[link]]\nname = \"base\"\n"
      "[[link]]\nname = \"shuttle\"\nparent = \"base\"\njoint = { kind = \"prismatic\" }\n"
      "[[link]]\nname = \"weight\"\nparent = \"shuttle\"\nmass = 2\n"
      "joint = { kind = \"prismatic\" }\n");
  const Outcome outcome = program.run(
      "crosscheck sliders.toml --random 5 --witness "
      "lagrange,newton_euler,composite_body,articulated_body");
  BOOST_TEST_CONTEXT(outcome.out) {
    BOOST_TEST(outcome.status == 0);
    BOOST_TEST(outcome.out.find("not answerable: energy drift") != std::string::npos);
    BOOST_TEST(outcome.out.find("not answerable: symmetric mass matrix") == std::string::npos);
  }
  refuses(program, "drift sliders.toml", "sliders.toml: qdd has no value at the start state");
}

// The user's own scene may be called like a bundled one: the published table is not about it.
BOOST_AUTO_TEST_CASE(a_scene_with_a_bundled_name_is_not_held_to_the_table) {
  const Program program;
  program.write("simple_pendulum.toml",
                "title = \"x\"\nsource = \"x\"\ngravity = [0, 0, -1]\n[[link]]\nname = \"base\"\n"
                "[[link]]\nname = \"bob\"\nparent = \"base\"\nmass = 3\ncom = [0, 0, -2]\n"
                "[link.joint]\nkind = \"revolute\"\naxis = [0, 1, 0]\n[start]\nq = [1]\n");
  const Outcome outcome = program.run("crosscheck ./simple_pendulum.toml --random 5");
  BOOST_TEST_CONTEXT(outcome.out) BOOST_TEST(outcome.status == 0);
}

// The parameters are named in the scene, so random ones are other inputs of larger formulas.
BOOST_AUTO_TEST_CASE(exact_checks_take_the_parameters_as_asked_and_say_so) {
  const Program program;
  const std::string words = "crosscheck double_pendulum --no-drift --random 2 -o ";
  BOOST_TEST(program.run(words + "written").status == 0);
  BOOST_TEST(program.run(words + "random --parameters random").status == 0);
  const std::string written = program.read("written/report.json"),
                    random = program.read("random/report.json");
  BOOST_TEST(written.find("\"parameters\": \"as written\"") != std::string::npos);
  BOOST_TEST(written.find("\"parameters\": \"random\"") == std::string::npos);
  BOOST_TEST(random.find("\"parameters\": \"random\"") != std::string::npos);
  BOOST_TEST(random.find("\"parameters\": \"as written\"") == std::string::npos);
  BOOST_TEST(random.find("--parameters random") != std::string::npos);  // the command of the report
  refuses(program, "crosscheck acrobot --parameters none", "as-written");
  refuses(program, "crosscheck --mechanisms 1 --parameters random", "--parameters");
}

BOOST_AUTO_TEST_CASE(campaigns_say_the_same_in_words_and_as_json_however_many_processes) {
  const Program program;
  const std::string words =
      "crosscheck --mechanisms 12 --most-joints 3 --random 2 --quiet "
      "--witness newton_euler,composite_body,simbody ";
  const Outcome one = program.run(words + "--processes 1 --json one.json"),
                three = program.run(words + "--processes 3 --json three.json");
  BOOST_TEST(one.status == 0);
  BOOST_TEST(one.out == three.out);
  BOOST_TEST(one.out.find("in double at 2 states each") != std::string::npos);
  BOOST_TEST(
      one.out.find("mechanisms asked about: composite_body 12, newton_euler 12, simbody 12") !=
      std::string::npos);
  const std::string json = program.read("one.json");
  BOOST_TEST(json == program.read("three.json"));
  BOOST_TEST(json.find("\"verdict\": \"agree\"") != std::string::npos);
  BOOST_TEST(json.find("\"mechanisms\": 12") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(another_seed_draws_other_states) {
  const Program program;
  for (const char* seed : {"1", "2"})
    program.run(std::string("version > /dev/null; SOURCE_DATE_EPOCH=0 ") + DYNWITNESS_PROGRAM +
                " crosscheck acrobot --no-drift --random 20 -o r" + seed + " --seed " + seed);
  BOOST_TEST(program.read("r1/report.json") != program.read("r2/report.json"));
}

BOOST_AUTO_TEST_CASE(help_names_every_subcommand_and_succeeds) {
  const Program program;
  const Outcome outcome = program.run("--help");
  BOOST_TEST(outcome.status == 0);
  for (const char* word : {"crosscheck", "check", "derive", "evaluate", "drift", "simulate",
                           "chart", "rotors", "scenes", "version"}) {
    BOOST_TEST(outcome.out.find(word) != std::string::npos);
    BOOST_TEST(program.run(std::string(word) + " --help").status == 0);
  }
}

BOOST_AUTO_TEST_CASE(simulate_says_drift_cost_and_whether_the_published_motion_agrees) {
  const Program program;
  const Outcome outcome = program.run(
      "simulate andrews_squeezer --duration 0.03 --step-error 1e-11 --outputs 3 --csv m.csv "
      "--json m.json");
  BOOST_TEST_CONTEXT(outcome.out) {
    BOOST_TEST(outcome.status == 0);
    BOOST_TEST(outcome.out.find("6 equations of rank 6, 1 freedoms") != std::string::npos);
    BOOST_TEST(outcome.out.find("7 values, agree") != std::string::npos);
  }
  const std::string json = program.read("m.json");
  for (const char* part : {"\"rank_lowest\": 6", "\"phi\": ", "\"published\": [", "\"ratio\": 0."})
    BOOST_TEST(json.find(part) != std::string::npos, part);
  const std::string csv = program.read("m.csv");
  BOOST_TEST(csv.find("time_s,q1,") == 0u);
  BOOST_TEST(std::count(csv.begin(), csv.end(), '\n') == 5);  // header, start and three outputs
  // a step error that cannot reach the printed digits is found out
  const Outcome coarse = program.run("simulate andrews_squeezer --duration 0.03 --step-error 1e-4");
  BOOST_TEST_CONTEXT(coarse.out) {
    BOOST_TEST(coarse.status == 1);
    BOOST_TEST(coarse.out.find("DISAGREE") != std::string::npos);
  }
}

BOOST_AUTO_TEST_CASE(chart_prints_a_table_and_draws_each_quantity) {
  const Program program;
  const std::string words = "chart cart_pole --random 20 --seed 3 --witness simbody --quantity ";
  const Outcome outcome = program.run(words + "qdd,M,qdd -o 'new/my charts'", "2>/dev/null");
  BOOST_TEST_CONTEXT(outcome.out) {
    BOOST_TEST(outcome.status == 0);
    BOOST_TEST(outcome.out.find("# states: 20, seed 3\n") != std::string::npos);
    const std::string header = "\nquantity,method,scalar,error_worst,";
    BOOST_TEST(outcome.out.find(header) != std::string::npos);
    BOOST_TEST(outcome.out.find(header) == outcome.out.rfind(header));
    for (const char* row : {"\nM,composite-body sweep,50 digits,", "\nM,simbody,double,",
                            "\nqdd,articulated-body sweep,float,"})
      BOOST_TEST(outcome.out.find(row) != std::string::npos, row);
    // each once, and no other engine or quantity
    BOOST_TEST(outcome.out.find("\nqdd,simbody,") == outcome.out.rfind("\nqdd,simbody,"));
    for (const char* row : {"\nqdd,kdl,", "\ntau,"})
      BOOST_TEST(outcome.out.find(row) == std::string::npos, row);
  }
  const std::string folder = "new/my charts/cart_pole_";
  for (const char* picture : {"M.svg", "qdd.svg"}) {
    const std::string svg = program.read(folder + picture);
    BOOST_TEST(svg.find("</svg>") != std::string::npos, picture);
    // one for light and dark: the ink of style.gp for either
    BOOST_TEST(svg.find("prefers-color-scheme: dark") != std::string::npos, picture);
    BOOST_TEST(svg.find("#e7eaee") != std::string::npos, picture);
  }
  for (const char* file : {"M.gp", "M.csv", "qdd.gp", "qdd.csv"})
    BOOST_TEST(program.exists(folder + file), file);
  BOOST_TEST(program.exists("new/my charts/dynwitness_style.gp"));
  BOOST_TEST(program.fileCount("new") == 1u);  // no unfinished folder is left
  BOOST_TEST(program.fileCount("new/my charts") == 7u);

  // a second chart leaves the first, and everybody's files, alone
  program.write("new/my charts/mine.txt", "mine");
  BOOST_TEST(program.run(words + "tau -o 'new/my charts'").status == 0);
  BOOST_TEST(program.fileCount("new/my charts") == 11u);
  BOOST_TEST(program.read("new/my charts/mine.txt") == "mine");
}

// satellite_arm has figures of twelve characters beside each other, "0.00149240.000815303"
BOOST_AUTO_TEST_CASE(a_sweep_keeps_its_figures_apart_and_reads_as_one_writes) {
  const std::string out = Program().run("sweep satellite_arm").out;
  std::istringstream words(out);
  int figures = 0;
  for (std::string word; words >> word; ++figures)
    BOOST_TEST(std::count(word.begin(), word.end(), '.') < 2, word);
  BOOST_TEST(figures > 500);
  BOOST_TEST(out.find("+ -") == std::string::npos);
  BOOST_TEST(out.find(" - 0.62879 qdd_3") != std::string::npos);
  BOOST_TEST(out.find("qdd_9 of elbow") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(a_header_that_is_nearly_one_is_told_what_it_lacks) {
  const Program program;
  const std::string words = "evaluate acrobot --quantity g --states ";
  program.write("semi.csv", "q1;q2;qd1;qd2\n0,1;0,2;0;1\n");
  refuses(program, words + "semi.csv",
          "semi.csv:1: the header's columns are separated by \";\", allowed: commas");
  program.write("tabs.csv", "q1\tq2\n0.1\t0.2\n");
  refuses(program, words + "tabs.csv", "separated by tabs");
  program.write("none.csv", "0.1,0.2,0,1\n");
  refuses(program, words + "none.csv",
          "none.csv:1: '0.1' where the header is expected, allowed as the first line");
  program.write("dq.csv", "q1,q2,dq1,dq2\n0.1,0.2,0,1\n");
  refuses(program, words + "dq.csv",
          "columns 'dq1', 'dq2' are unknown (did you mean qd1, qd2?), allowed: q1..q2");
  program.write("qd3.csv", "q1,q2,qd1,qd3\n0.1,0.2,0,1\n");
  const std::string said = program.run(words + "qd3.csv").out;
  BOOST_TEST(
      said.find("'qd3' is unknown (did you mean qd2?); column 'qd2' is missing, allowed: ") !=
          std::string::npos,
      said);
  BOOST_TEST(said.find("q1..q2") == said.rfind("q1..q2"), said);  // the list once
}

// Which roads agree, of the laws that have one formula on both sides.
BOOST_AUTO_TEST_CASE(laws_of_a_study_name_the_roads_that_agree) {
  const Program program;
  const std::string said = program.run("linearize acrobot").out;
  BOOST_TEST(
      said.find("dtau/dq = dtau/dq, by newton_euler and recursive_lagrange\n") != std::string::npos,
      said);
}

BOOST_AUTO_TEST_CASE(a_report_has_charts_unless_they_are_left_out) {
  const Program program;
  const std::string words =
      "crosscheck acrobot --random 5 --no-drift --witness newton_euler,lagrange";
  BOOST_TEST(program.run(words + " -o with").status == 0);
  BOOST_TEST(program.run(words + " --no-charts -o without").status == 0);
  BOOST_TEST(program.exists("with/scenes/acrobot/speed.svg"));
  BOOST_TEST(!program.exists("without/scenes/acrobot/speed.csv"));
  BOOST_TEST(program.read("without/report.json").find("--no-charts") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(drift_prints_a_table_and_draws_a_chart) {
  const Program program;
  const Outcome outcome =
      program.run("drift 'simple pendulum' --step 0.01,0.005 --duration 1 --plot p.svg --csv d.csv",
                  "2>/dev/null");
  BOOST_TEST(outcome.status == 0);
  BOOST_TEST(outcome.out.find("method,step_s,worst_error,scale_J") != std::string::npos);
  BOOST_TEST(program.read("d.csv").find("runge_kutta4,0.005,") != std::string::npos);
  BOOST_TEST(program.read("p.svg").find("</svg>") != std::string::npos);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_CASE(audit_prints_an_equation_and_refuses_one_that_is_not_there) {
  const Program program;
  const Outcome outcome = program.run("audit --equation 32,eq1 --json a.json -o pages");
  BOOST_TEST(outcome.status == 0, outcome.out);
  BOOST_TEST(outcome.out.find("eq32, section 7.1") != std::string::npos, outcome.out);
  BOOST_TEST(outcome.out.find("WRONG") != std::string::npos, outcome.out);
  BOOST_TEST(outcome.out.find("2 equations: ") != std::string::npos, outcome.out);
  BOOST_TEST(program.exists("a.json"));
  BOOST_TEST(program.exists("pages/index.html"));
  refuses(program, "audit --equation 99", "no entry 'eq99'");
  refuses(program, "audit --only some", "some");
  refuses(program, "audit --json no/such/folder/a.json", "a.json");
}

BOOST_AUTO_TEST_CASE(a_state_is_given_by_place_by_name_and_in_the_scenes_parameters) {
  const Program program;
  const auto jsonOf = [&program](const std::string& words) {
    const Outcome outcome = program.run("sweep double_pendulum --json s.json " + words);
    BOOST_TEST(outcome.status == 0, words << ": " << outcome.out);
    return program.read("s.json");
  };
  const std::string by_place = jsonOf("--q 0.5,0.25 --qd 0,2");
  BOOST_TEST(jsonOf("--q q1=0.5,q2=1/4 --qd qd1=0,qd2=2") == by_place);
  BOOST_TEST(jsonOf("--q shoulder=0.5,elbow=0.25 --qd shoulder=0,elbow=2") == by_place);
  BOOST_TEST(jsonOf("--q 0.5,0.3 --qd 0,2") != by_place);
  BOOST_TEST(
      program.run("sweep double_pendulum --state 0.5,0.25").out.find("--state is called --q now") !=
      std::string::npos);
  refuses(program, "sweep double_pendulum --q 1", "--q: 1 values, allowed: 2");
  refuses(program, "sweep double_pendulum --q 1,q2=3",
          "some numbers have names and some have none");
  refuses(program, "sweep double_pendulum --q wrist=1", "allowed: q1, shoulder, q2, elbow");
  refuses(program, "sweep double_pendulum --q 1,nan", "--q: read 'nan', allowed: a finite number");
  refuses(program, "linearize double_pendulum --qd 1,1 --equilibrium", "--qd with --equilibrium");
  refuses(program, "linearize kapitza_pendulum --q 0.1,3",
          "read 0.1 for joint 'pivot', which is driven: its motion puts it at 0 at t = 0");
  refuses(program, "linearize kapitza_pendulum --qd pivot=0",
          "--qd: read 0 for joint 'pivot', which is driven: its motion puts it at 4");
  BOOST_TEST(program.run("linearize kapitza_pendulum --q rod=3").status == 0);
  refuses(program, "linearize puma_560 --symbolic", "6 rates, whose entries nobody reads");
  refuses(program, "linearize kapitza_pendulum --symbolic", "what else ties joints");
  refuses(program, "linearize acrobot --symbolic --json a.json", "--json");
  refuses(program, "linearize acrobot --format latex", "are for --symbolic");
  const Outcome letters =
      program.run("linearize double_pendulum --symbolic --equilibrium --q 3,0.1");
  BOOST_TEST(letters.status == 0, letters.out);  // Newton's steps end at pi but for rounding
  BOOST_TEST(letters.out.find("At q1 = pi, q2 = 0, qd = 0, qdd = 0") != std::string::npos,
             letters.out);
  refuses(program, "drift double_pendulum --motion none.csv --step 0.1,0.2",
          "--step: 2 steps of 1 motions");
}

// Each looks at one scene, says what its checks found and writes the same as JSON.
BOOST_AUTO_TEST_CASE(geometry_action_impulse_and_impedance_say_what_they_checked) {
  const Program program;
  for (const char* words : {"geometry double_pendulum --q 0,1.2", "geometry scara --duration 0.5",
                            "action simple_pendulum --duration 2", "action acrobot --damping 0.1",
                            "impulse puma_560 --qd 1,0.5,0,0,0,0 --wall 0,0,1 --restitution 0.5",
                            "impulse andrews_squeezer --qd 1,0,0,0,0,0,0",
                            "impedance puma_560 --stiffness 500,500,100,0,0,0 --stretch 0.1,0,0"}) {
    const Outcome outcome = program.run(std::string(words) + " --json out.json");
    BOOST_TEST_CONTEXT(words << "\n" << outcome.out) {
      BOOST_TEST(outcome.status == 0);
      const std::string json = program.read("out.json");
      BOOST_TEST(json.find("\"verdict\": \"agree\"") != std::string::npos);
      BOOST_TEST(json.find("\"disagree\"") == std::string::npos);
      BOOST_TEST(json.find("\"command\": \"" + std::string(words).substr(0, 6)) !=
                 std::string::npos);
    }
  }
}

// A joint that moves no inertia leaves M, c, g, tau and what they are made of to be compared; the
// forward dynamics of DART would end the process there.
BOOST_AUTO_TEST_CASE(of_a_tip_without_mass_what_needs_no_inverse_is_compared) {
  const Program program;
  program.write("tip.toml", R"toml(
gravity = [0, 0, -9.81]
[[link]]
name = "base"
[[link]]
name = "arm"
parent = "base"
mass = 2
com = [0, 0, -0.3]
inertia = { xx = 0.1, yy = 0.1, zz = 0.02 }
joint = { name = "shoulder", kind = "revolute", axis = [0, 1, 0], rotor_inertia = 0.001, gear_ratio = 10 }
[[link]]
name = "tool"
parent = "arm"
joint = { name = "wrist", kind = "revolute", xyz = [0, 0, "-0.4*cos(pi/10)"] }
[envelope]
shoulder = { q = [-1, 1], qd = [-1, 1], qdd = [-1, 1] }
wrist = { q = [-1, 1], qd = [-1, 1], qdd = [-1, 1] }
)toml");
  const Outcome outcome = program.run(
      "crosscheck tip.toml --random 3 --no-charts --witness lagrange,newton_euler,dart");
  BOOST_TEST(outcome.status == 0, outcome.out);
  BOOST_TEST(outcome.out.find("joint 'wrist' moves no inertia") != std::string::npos, outcome.out);
  const std::string json = program.read("report/report.json");
  BOOST_TEST(json.find("\"verdict\": \"agree\"") != std::string::npos);
  BOOST_TEST(json.find("\"disagree\"") == std::string::npos);
  for (const char* command :
       {"rotors tip.toml", "envelope tip.toml", "sweep tip.toml --q 0.3,0.2"}) {
    const Outcome shown = program.run(command);
    BOOST_TEST(shown.status == 0, command << ": " << shown.out);
  }
  BOOST_TEST(program.run("sweep tip.toml").out.find("no articulated inertia and no qdd") !=
             std::string::npos);
  BOOST_TEST(program.run("check tip.toml --answer 'M22 = 0'").status == 0);
  BOOST_TEST(program.run("check tip.toml --answer 'M22 = 1'").status == 1);
  refuses(program, "sweep tip.toml --json sweep.json", "joint \"wrist\"");
}
