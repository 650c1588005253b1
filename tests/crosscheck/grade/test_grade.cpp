// SPDX-License-Identifier: GPL-3.0-or-later
// Homework on the stand: marks as expected, hostile submissions that get a reason and take nobody
// along, a grader that is killed and goes on, and the same bytes however many run at a time.
#include "crosscheck/grade/grade.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <nlohmann/json.hpp>

#include "crosscheck/system/cell.hpp"
#include "scene/error.hpp"
#include "tests/fixtures/files.hpp"
#include "tests/fixtures/program.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
using files::contains;
using fixtures::Outcome;
namespace data = boost::unit_test::data;
namespace fs = std::filesystem;

namespace {

const std::string kRubric =
    "command = \"/usr/bin/python3 {file}\"\nfiles = [\"" DYNWITNESS_STRANGER
    "\"]\npartial = 0.5\n"
    "[limits]\nseconds = 12\n[partial_by_rule]\ngravity_sign = 0.75\n"
    "[[task]]\nscene = \"double_pendulum\"\n[task.marks]\nM = 3\nc = 3\ng = 2\ntau = 2\n";

/// A submission: the stranger with a mistake, or right.
std::string stranger(const std::string& mistake) {
  return "import stranger\nstranger.main([" +
         (mistake.empty() ? "" : "'--mistake', '" + mistake + "'") + "])\n";
}

/// One that says something of its surroundings in place of answers.
std::string saying(const std::string& expression) {
  return "import json, os, socket, subprocess, sys\nsys.stdin.readline()\n"
         "def tried(f):\n"
         "    try: return str(f())\n"
         "    except BaseException as error: return type(error).__name__\n"
         "print(json.dumps({'protocol': 1, 'refuses': " +
         expression + "}), flush=True)\n";
}

const std::string kHello =
    "import json, os, sys, time\nsys.stdin.readline()\n"
    "print(json.dumps({'protocol': 1, 'quantities': ['M', 'g']}), flush=True)\n"
    "batch = json.loads(sys.stdin.readline())\n"
    "answers = [{'M': [[1, 0], [0, 1]], 'g': [1, 2]} for _ in batch['states']]\n";
const std::string kSay =
    "print(json.dumps({'batch': batch['batch'], 'answers': answers}), flush=True)\n";

/// A course: submissions, a rubric, results.
class Course {
 public:
  explicit Course(const std::string& rubric = kRubric) {
    fs::create_directory(path() / "submissions");
    write("rubric.toml", rubric);
  }
  const fs::path& path() const { return folder_.path; }
  void write(const std::string& file, const std::string& text) const {
    fs::create_directories((path() / file).parent_path());
    std::ofstream(path() / file) << text;
  }
  void handIn(const std::string& name, const std::string& text) const {
    write("submissions/" + name, text);
  }
  std::string command(const std::string& words) const {
    return fmt::format("cd '{}' && exec {} grade submissions --rubric rubric.toml {}",
                       path().string(), DYNWITNESS_PROGRAM, words);
  }
  Outcome grade(const std::string& words = "") const {
    const std::string said = (path() / "said").string();
    const int status = std::system(("( " + command(words) + " ) > '" + said + "' 2>&1").c_str());
    return {WEXITSTATUS(status), files::read(said)};
  }
  std::string read(const std::string& file) const { return files::read(path() / file); }

  /// Lines of grades.csv by submission.
  std::map<std::string, std::string> lines(const std::string& output = "grades") const {
    std::map<std::string, std::string> out;
    std::istringstream csv(read(output + "/grades.csv"));
    for (std::string line; std::getline(csv, line);) out[line.substr(0, line.find(','))] = line;
    return out;
  }
  /// Every file of a folder, by name.
  std::map<std::string, std::string> tree(const std::string& output) const {
    std::map<std::string, std::string> out;
    for (const auto& entry : fs::recursive_directory_iterator(path() / output))
      if (entry.is_regular_file())
        out[entry.path().lexically_relative(path() / output).string()] = files::read(entry.path());
    return out;
  }

 private:
  files::TemporaryFolder folder_;
};

bool hides() {
  static const bool is_so = whyNothingIsHidden().empty();
  return is_so;
}

}  // namespace

BOOST_AUTO_TEST_CASE(marks_are_as_the_rubric_says) {
  const Course course;
  course.handIn("right.py", stranger(""));
  course.handIn("gravity.py", stranger("gravity_sign"));
  course.handIn("inertia.py", stranger("half_inertia"));
  course.handIn("two mistakes.py", stranger("gravity_sign,c_twice"));
  course.handIn(
      "unknown.py",
      "import stranger\nright = stranger.Engine.c\n"
      "stranger.Engine.c = lambda self, q, qd: [x + v ** 4 / 4 for x, v in zip(right(self, "
      "q, qd), qd)]\nstranger.main([])\n");
  course.handIn(
      "half/my_arm.py",
      "import stranger\nstranger.main(['--quantities', 'M,g'])\n");  // the only file in it
  course.handIn("=1+1.py", stranger(""));
  course.handIn(".hidden.py", stranger(""));
  const Outcome outcome = course.grade();
  BOOST_TEST_REQUIRE(outcome.status == 0, outcome.out);
  const auto lines = course.lines();
  const std::map<std::string, std::string> expected = {
      {"right.py", "right.py,10,10,3,3,2,2,right,"},
      // 3/4 of 2 and 2
      {"gravity.py", "gravity.py,9,10,3,3,1.5,1.5,one mistake,"},
      // half of M and tau: in a plane neither c nor g has a moment of inertia in it
      {"inertia.py", "inertia.py,7.5,10,1.5,3,2,1,one mistake,"},
      {"two mistakes.py", "two mistakes.py,3,10,3,0,0,0,wrong,"},
      {"unknown.py", "unknown.py,5,10,3,0,2,0,wrong,"},
      {"half", "half,5,10,3,0,2,0,not answered,"},
      {"'=1+1.py", "'=1+1.py,10,10,3,3,2,2,right,"}};
  for (const auto& [name, start] : expected)
    BOOST_TEST(lines.at(name).rfind(start, 0) == 0u, lines.at(name) << "\nexpected " << start);
  BOOST_TEST(lines.size() == expected.size() + 1);
  BOOST_TEST(
      contains(lines.at("gravity.py"),
               "explained exactly by: gravity with the opposite sign; as the only mistake it "
               "costs 25 %"));
  BOOST_TEST(contains(lines.at("two mistakes.py"), " AND "));
  BOOST_TEST(contains(lines.at("unknown.py"), "no mistake on record explains it"));
  BOOST_TEST(contains(lines.at("half"), "c: not answered: the engine does not know it"));

  const auto gradescope =
      nlohmann::json::parse(course.read("grades/gradescope/gravity.py/results.json"));
  BOOST_TEST(gradescope.at("score") == 9.0);
  BOOST_TEST(gradescope.at("tests").size() == 4u);
  BOOST_TEST(gradescope.at("tests").at(2).at("score") == 1.5);
  BOOST_TEST(gradescope.at("tests").at(2).at("max_score") == 2.0);
  BOOST_TEST(gradescope.at("tests").at(2).at("status") == "failed");
  const std::string page = course.read("grades/index.html");
  for (const char* part : {"gravity with the opposite sign", "two mistakes.py", "7 submissions"})
    BOOST_TEST(contains(page, part), part);
  BOOST_TEST(!contains(page, "src="));  // alone
  BOOST_TEST(!contains(page, "http"));
  const std::string junit = course.read("grades/junit.xml");
  BOOST_TEST(contains(junit,
                      "<testsuites name=\"dynwitness grade\" tests=\"35\" failures=\"11\" "
                      "errors=\"0\">"),
             junit.substr(0, 200));
  BOOST_TEST(contains(outcome.out, "7 graded, of 10 marks"), outcome.out);
}

namespace {

struct Hostile {
  std::string name, script, reason;
};
const std::vector<Hostile> kHostile = {
    // too many of them, or its shell finds no room for one more
    {"fork_bomb.py", "import os\nwhile True: os.fork()\n", ""},
    // too much of it, or too long on a busy machine
    {"endless.py", "import os\nwhile True: os.write(1, b'x' * 65536)\n", ""},
    {"moaning.py", "import os\nwhile True: os.write(2, b'x' * 65536)\n",
     "it did not answer within"},
    {"gigabytes.py", "x = bytearray(2**31)\n", "MemoryError"},
    {"disk.py", "with open('big', 'wb') as f:\n  for _ in range(4096): f.write(b'x' * 2**20)\n",
     "OSError"},
    {"hang.py", "import time\ntime.sleep(1000)\n", "it did not answer within 12 s"},
    {"rubbish.py", "print('hello', flush=True)\n",
     "expected a JSON object on one line, got 'hello'"},
    {"nan.py", kHello + "answers[1]['g'] = [float('nan'), 0]\n" + kSay,
     "expected numbers, got NaN"},
    {"length.py", kHello + "answers[0]['g'] = [1, 2, 3]\n" + kSay,
     "g of state 1: expected 2 numbers"},
    {"crash.py", "import os\nos.kill(os.getpid(), 11)\n", "Segmentation fault"},
    {"kills_its_keeper.py", "import os, time\nos.kill(os.getppid(), 9)\ntime.sleep(1000)\n", ""},
    {"orphans.py",
     "import subprocess, sys\n"
     "subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(1000)', "
     "'orphan_of_a_submission'], start_new_session=True)\n",
     "it ended (status 0)"},
    {"syntax.py", "def M(q:\n", "SyntaxError"},
    {"empty.py", "", "it ended (status 0), expected an answer"},
};

}  // namespace

BOOST_TEST_DECORATOR(*boost::unit_test::timeout(300))
BOOST_AUTO_TEST_CASE(hostile_submissions_get_no_marks_but_a_reason_and_take_nobody_along) {
  const Course course;
  for (const Hostile& hostile : kHostile) course.handIn(hostile.name, hostile.script);
  course.handIn("right.py", stranger(""));
  course.handIn("zz_right.py", stranger(""));
  fs::create_directory(course.path() / "submissions/nothing");
  fs::create_symlink("/etc/passwd", course.path() / "submissions/link.py");
  const Outcome outcome = course.grade("--processes 3");
  BOOST_TEST(outcome.status == 0, outcome.out);
  const auto lines = course.lines();
  for (const Hostile& hostile : kHostile) {
    const std::string& line = lines.at(hostile.name);
    BOOST_TEST_CONTEXT(line) {
      BOOST_TEST(line.rfind(hostile.name + ",0,10,0,0,0,0,could not be run,", 0) == 0u);
      BOOST_TEST(contains(line, hostile.reason), hostile.reason);
    }
  }
  for (const char* right : {"right.py", "zz_right.py"})
    BOOST_TEST(contains(lines.at(right), ",10,10,3,3,2,2,right,"), lines.at(right));
  BOOST_TEST(contains(lines.at("nothing"), "there is no file in it"));
  BOOST_TEST(contains(lines.at("link.py"), "left out, being no file: link.py"));
  BOOST_TEST(!contains(lines.at("link.py"), "root:"));
  BOOST_TEST(fixtures::running("orphan_of_a_submission") == 0);
  const std::string junit = course.read("grades/junit.xml");
  BOOST_TEST(contains(junit, "<failure type=\"could not be run\""));
}

// It would otherwise end everything of this user's, the test included.
BOOST_AUTO_TEST_CASE(a_submission_that_kills_all_it_can_kills_itself,
                     *boost::unit_test::precondition([](boost::unit_test::test_unit_id) {
                       return boost::test_tools::assertion_result(hides());
                     })) {
  const Course course;
  course.handIn("kills_all.py", "import os, time\nos.kill(-1, 9)\ntime.sleep(1000)\n");
  course.handIn("right.py", stranger(""));
  const Outcome outcome = course.grade("--processes 2");
  BOOST_TEST(outcome.status == 0, outcome.out);
  BOOST_TEST(contains(course.lines().at("kills_all.py"), ",0,10,0,0,0,0,could not be run,"));
  BOOST_TEST(contains(course.lines().at("right.py"), ",10,10,"));
}

BOOST_AUTO_TEST_CASE(a_submission_sees_nothing_that_is_not_its_own,
                     *boost::unit_test::precondition([](boost::unit_test::test_unit_id) {
                       return boost::test_tools::assertion_result(hides());
                     })) {
  const Course course;
  course.write("solution/right.py", stranger(""));
  course.write("rubric.toml", "hide = [\"solution\"]\n" + kRubric);
  const std::string path = course.path().string();
  setenv("SECRET_OF_THE_LECTURER", "42", 1);
  const std::map<std::string, std::pair<std::string, std::string>> asked = {
      {"others.py",
       {"tried(lambda: open('" + path + "/submissions/right.py').read())", "FileNotFoundError"}},
      {"results.py", {"tried(lambda: os.listdir('" + path + "/grades'))", "FileNotFoundError"}},
      {"solution.py", {"tried(lambda: os.listdir('" + path + "/solution'))", "FileNotFoundError"}},
      {"itself.py", {"str(sorted(os.listdir('.')))", "['itself.py', 'stranger.py']"}},
      {"environment.py",
       {"str(sorted(set(os.environ) - {'LANG', 'LC_CTYPE', 'PWD'}))",
        "['HOME', 'PATH', 'TMPDIR']"}},
      {"home.py",
       {"os.environ['HOME'] + os.environ['TMPDIR'] + os.getcwd()",
        "/tmp/submission/tmp/submission/tmp/submission"}},
      {"network.py", {"str(socket.if_nameindex())", "[(1, 'lo')]"}},
      {"processes.py",
       {"str([x for x in os.listdir('/proc') if x == '1' or x == '" + std::to_string(getpid()) +
            "'])",
        "['1']"}},
      {"program.py",
       {"tried(lambda: subprocess.run(['" DYNWITNESS_PROGRAM "', 'version']))", "PermissionError"}},
      {"program_again.py",
       {"tried(lambda: subprocess.run(['/proc/1/exe', 'version']))", "PermissionError"}},
      {"memory.py", {"tried(lambda: open('/proc/1/environ').read())", "PermissionError"}},
      {"data.py", {"tried(lambda: os.listdir('" DYNWITNESS_DATA_DIR "'))", "[]"}},
      {"disk.py", {"tried(lambda: open('/var/left_by_a_submission', 'w'))", "OSError"}},
      {"unmounts.py",
       {"str(subprocess.run(['umount', '/tmp'], capture_output=True).returncode != 0) + "
        "tried(lambda: os.listdir('" +
            path + "'))",
        "TrueFileNotFoundError"}},
      {"powers.py",
       {"[x for x in open('/proc/self/status').read().split('\\n') if 'CapEff' in "
        "x][0].split()[1]",
        "0000000000000000"}},
  };
  for (const auto& [name, question] : asked) course.handIn(name, saying(question.first));
  course.handIn("right.py", stranger(""));
  const Outcome outcome = course.grade();
  BOOST_TEST(outcome.status == 0, outcome.out);
  BOOST_TEST(contains(outcome.out, "It saw neither the others nor their results"), outcome.out);
  for (const auto& [name, question] : asked) {
    const auto record = nlohmann::json::parse(course.read("grades/records/" + name + ".json"));
    BOOST_TEST(record.at("hidden") == true);
    BOOST_TEST(record.at("tasks").at(0).at("problem") == "engine_1 says: " + question.second, name);
  }
}

// Without namespaces there is less to be had, and it is told.
BOOST_AUTO_TEST_CASE(where_nothing_can_be_hidden_that_is_told,
                     *boost::unit_test::precondition([](boost::unit_test::test_unit_id) {
                       return boost::test_tools::assertion_result(hides());
                     })) {
  const Course course;
  course.handIn("right.py", stranger(""));
  course.handIn("environment.py",
                saying("str(sorted(set(os.environ) - {'LANG', 'LC_CTYPE', 'PWD'})) + "
                       "str(os.environ['HOME'] == os.getcwd()) + "
                       "str(sorted(os.listdir('.')))"));
  const std::string command = "unshare -Ur sh -c 'echo 0 > /proc/sys/user/max_user_namespaces; " +
                              course.command("") + "' > '" + (course.path() / "said").string() +
                              "' 2>&1";
  BOOST_TEST(std::system(command.c_str()) == 0);
  const std::string said = course.read("said");
  BOOST_TEST(contains(said, "2 of 2 could have read the other submissions"), said);
  BOOST_TEST(contains(said, "no namespaces"), said);
  BOOST_TEST(contains(course.lines().at("right.py"), ",10,10,"));
  const auto record = nlohmann::json::parse(course.read("grades/records/environment.py.json"));
  BOOST_TEST(record.at("tasks").at(0).at("problem") ==
             "engine_1 says: ['HOME', 'PATH', 'TMPDIR']True['environment.py', 'stranger.py']");
  BOOST_TEST(record.at("hidden") == false);
}

BOOST_AUTO_TEST_CASE(killed_it_goes_on_and_late_changes_are_graded_again) {
  const Course course;
  constexpr int kMany = 6;
  for (int k = 0; k < kMany; ++k)
    course.handIn(fmt::format("s{}.py", k),
                  stranger(k % 2 == 0 ? "gravity_sign" : "") + fmt::format("# {}\n", k));
  const auto records = [&] {
    int count = 0;
    std::error_code none;
    for (fs::directory_iterator entry(course.path() / "grades/records", none), end;
         !none && entry != end; entry.increment(none))
      count += entry->path().extension() == ".json" ? 1 : 0;
    return count;
  };
  const pid_t grader = fork();
  if (grader == 0) {
    const std::string command = course.command("--processes 1 > /dev/null 2>&1");
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  for (int i = 0; i < 120'000 && records() < 2; ++i) usleep(1000);
  kill(grader, SIGKILL);
  int status = 0;
  waitpid(grader, &status, 0);
  BOOST_TEST_REQUIRE((WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL));
  const int there = records();
  BOOST_TEST(there < kMany);
  BOOST_TEST(!fs::exists(course.path() / "grades/grades.csv"));
  BOOST_TEST(fixtures::running(course.path().string(), 300) == 0);

  const Outcome again = course.grade("--processes 2");
  BOOST_TEST(again.status == 0, again.out);
  BOOST_TEST(contains(again.out, fmt::format("{} kept from before", there)), again.out);
  const Outcome fresh = course.grade("-o fresh --processes 1");
  BOOST_TEST(contains(fresh.out, "0 kept from before"), fresh.out);
  BOOST_TEST((course.tree("grades") == course.tree("fresh")));

  course.handIn("s1.py", stranger("half_inertia"));  // handed in late
  const Outcome late = course.grade();
  BOOST_TEST(contains(late.out, fmt::format("{} kept from before", kMany - 1)), late.out);
  BOOST_TEST(contains(course.lines().at("s1.py"), "s1.py,7.5,10,1.5,3,2,1,one mistake"));
  // marks alone: nothing has to run
  std::string rubric = kRubric;
  rubric.replace(rubric.find("0.75"), 4, "0.25");
  course.write("rubric.toml", rubric);
  const Outcome stricter = course.grade();
  BOOST_TEST(contains(stricter.out, fmt::format("{} kept from before", kMany)), stricter.out);
  BOOST_TEST(contains(course.lines().at("s0.py"), "s0.py,7,10,3,3,0.5,0.5,one mistake"));
  // other states
  course.write("rubric.toml", "seed = 2\n" + rubric);
  fs::remove(course.path() / "submissions/s2.py");
  const Outcome reseeded = course.grade();
  BOOST_TEST(contains(reseeded.out, "0 kept from before"), reseeded.out);
  BOOST_TEST(course.lines().count("s2.py") == 0u);
  BOOST_TEST(!fs::exists(course.path() / "grades/gradescope/s2.py"));
  BOOST_TEST(contains(course.grade("--again").out, "0 kept from before"));
}

BOOST_AUTO_TEST_CASE(a_record_that_was_cut_off_is_none) {
  const Course course;
  course.handIn("right.py", stranger(""));
  course.grade();
  const std::string record = course.read("grades/records/right.py.json");
  course.write("grades/records/right.py.json", record.substr(0, record.size() / 2));
  const Outcome again = course.grade();
  BOOST_TEST(contains(again.out, "0 kept from before"), again.out);
  BOOST_TEST(course.read("grades/records/right.py.json") == record);
}

BOOST_AUTO_TEST_CASE(a_submission_is_built_first_where_the_rubric_says_so) {
  std::string rubric = kRubric;
  rubric.replace(0, rubric.find('\n'),
                 "build = \"cp {file} built.py && test -s built.py\"\n"
                 "command = \"/usr/bin/python3 built.py # {file}\"");
  const Course course(rubric);
  course.handIn("it's right.py", stranger(""));
  course.handIn("empty.py", "");
  const Outcome outcome = course.grade();
  BOOST_TEST(outcome.status == 0, outcome.out);
  BOOST_TEST(contains(course.lines().at("it's right.py"), ",10,10,"));
  BOOST_TEST(contains(course.lines().at("empty.py"), "it was not built: it failed with status 1"));
}

BOOST_AUTO_TEST_CASE(what_the_grader_cannot_read_is_not_graded_and_is_status_1) {
  if (geteuid() == 0) return;  // who may read everything
  const Course course;
  course.handIn("right.py", stranger(""));
  course.handIn("secret.py", stranger(""));
  fs::permissions(course.path() / "submissions/secret.py", fs::perms::none);
  const Outcome outcome = course.grade();
  BOOST_TEST(outcome.status == 1);
  BOOST_TEST(contains(course.lines().at("secret.py"), "secret.py,,10,,,,,NOT GRADED"));
}

BOOST_AUTO_TEST_CASE(reactions_and_jacobians_have_marks) {
  const std::string engines = DYNWITNESS_DATA_DIR "/engines/";
  const Course course(
      "command = \"/usr/bin/python3 {file}\"\nfiles = [\"" + engines +
      "dynwitness_engine.py\"]\npartial = 0.5\n"
      "[[task]]\nscene = \"puma_560\"\n[task.marks]\nreactions = 4\njacobian = 3\n");
  const std::string right = files::read(engines + "open_chain.py");
  const auto with = [&](const std::string& old, const std::string& changed) {
    std::string text = right;
    BOOST_TEST_REQUIRE(contains(text, old));
    return text.replace(text.find(old), old.size(), changed);
  };
  course.handIn("right.py", right);
  course.handIn("origin.py", with("point = add(p, times(R, frame[\"at\"]))", "point = p"));
  course.handIn("without.py", with("\"reactions\": reactions, ", ""));
  const Outcome outcome = course.grade();
  BOOST_TEST_REQUIRE(outcome.status == 0, outcome.out);
  const auto lines = course.lines();
  BOOST_TEST(lines.at("right.py").rfind("right.py,7,7,4,3,right,", 0) == 0u, lines.at("right.py"));
  BOOST_TEST(lines.at("origin.py").rfind("origin.py,4,7,4,0,wrong,", 0) == 0u,
             lines.at("origin.py"));
  BOOST_TEST(contains(lines.at("origin.py"), "of the link's origin in place of the point"),
             lines.at("origin.py"));
  BOOST_TEST(lines.at("without.py").rfind("without.py,3,7,0,3,not answered,", 0) == 0u,
             lines.at("without.py"));
}

BOOST_AUTO_TEST_CASE(the_example_is_a_rubric_that_works) {
  const Course course(exampleRubric());
  course.handIn("arm.py", files::read(DYNWITNESS_DATA_DIR "/engines/double_pendulum.py"));
  const Outcome outcome = course.grade();
  BOOST_TEST(outcome.status == 0, outcome.out);
  BOOST_TEST(contains(course.lines().at("arm.py"), "arm.py,10,10,3,3,2,2,right"), outcome.out);
}

namespace {

struct Refused {
  std::string rubric, message;
};
std::ostream& operator<<(std::ostream& out, const Refused& refused) {
  return out << refused.message;
}

const std::string kTask = "[[task]]\nscene = \"acrobot\"\n[task.marks]\ng = 1\n";
const std::string kCommand = "command = \"x {file}\"\n";
const std::vector<Refused> kRefused = {
    {"", "rubric.toml:1: rubric: has no command, allowed: a shell's words"},
    {"command = \"x\"\n" + kTask, "rubric.toml:1: command: read 'x', allowed: "},
    {kCommand, "rubric.toml: rubric: has no [[task]]"},
    {kCommand + "comand = 1\n" + kTask,
     "rubric.toml:2: rubric: unknown key \"comand\" (did you mean command?), allowed: "},
    {kCommand + "partial = 1.5\n" + kTask,
     "rubric.toml:2: partial: read 1.5, allowed: a number from 0 to 1"},
    {kCommand + "partial = nan\n" + kTask, "rubric.toml:2: partial: read nan"},
    {kCommand + "seed = -1\n" + kTask, "rubric.toml:2: seed: "},
    {kCommand + "scalar = \"half\"\n" + kTask, "rubric.toml:2: scalar: read 'half', allowed: "},
    {kCommand + "files = [\"no_such\"]\n" + kTask, "rubric.toml:2: files: there is no file "},
    {kCommand + "hide = [\"no_such\"]\n" + kTask, "rubric.toml:2: hide: "},
    {kCommand + "environment = [\"A=1\"]\n" + kTask, "rubric.toml:2: environment: read 'A=1'"},
    {kCommand + "[limits]\nprocesses = 0\n" + kTask,
     "rubric.toml:3: limits: processes: read 0, allowed: "},
    {kCommand + "[limits]\ntime = 1\n" + kTask, "rubric.toml:3: limits: unknown key \"time\""},
    {kCommand + "[partial_by_rule]\ngravity = 1\n" + kTask,
     "rubric.toml:3: partial_by_rule: unknown key \"gravity\", allowed: mistakes that can be made in "
     "these scenes: "},
    {kCommand + "[[task]]\nscene = \"no_such_scene\"\n[task.marks]\ng = 1\n",
     "rubric.toml:3: scene: "},
    {kCommand + kTask + kTask, "rubric.toml:7: scene: 'acrobot' is the scene of another task"},
    {kCommand + "[[task]]\nscene = \"acrobot\"\n[task.marks]\nG = 1\n",
     "rubric.toml:5: marks: unknown key \"G\" (did you mean g?), allowed: M, c, g, tau, "},
    {kCommand + "[[task]]\nscene = \"acrobot\"\n[task.marks]\ng = -1\n",
     "rubric.toml:5: marks: g: read -1, allowed: a number, 0 or more"},
    {kCommand + "[[task]]\nscene = \"acrobot\"\n[task.marks]\ng = 0\n",
     "rubric.toml: rubric: all marks are 0"},
    {kCommand + "[[task]]\nscene = \"acrobot\"\n[task.marks]\n", "rubric.toml:4: marks: is empty"},
    {"command = \n", "rubric.toml:1: not TOML"},
};

}  // namespace

BOOST_DATA_TEST_CASE(a_rubric_is_refused_with_file_and_line, data::make(kRefused), refused) {
  const files::TemporaryFolder folder;
  const fs::path file = folder.path / "rubric.toml";
  std::ofstream(file) << refused.rubric;
  try {
    readRubric(file);
    BOOST_TEST(false, "it was taken");
  } catch (const scene::InputError& error) {
    const std::string said = error.what(), before = folder.path.string() + "/";
    BOOST_TEST(said.rfind(before, 0) == 0u, said);
    BOOST_TEST(said.substr(before.size()).rfind(refused.message, 0) == 0u,
               said << "\nexpected " << refused.message);
  }
}

BOOST_AUTO_TEST_CASE(bad_use_is_status_2) {
  const Course course;
  const auto refuses = [&](const std::string& words, const std::string& part) {
    const Outcome outcome = course.grade(words);
    BOOST_TEST(outcome.status == 2, outcome.out);
    BOOST_TEST(contains(outcome.out, part), outcome.out);
  };
  refuses("", "submissions: is empty, allowed: a folder with one submission a file or sub-folder");
  course.handIn("right.py", stranger(""));
  refuses("-o submissions/grades", "lie one in the other");
  refuses("-o .", "lie one in the other");
  course.write("mine/thesis.tex", "");
  refuses("-o mine", "is not empty and holds no records of dynwitness grade");
  BOOST_TEST(!fs::exists(course.path() / "mine/records"));
  refuses("--processes 0", "allowed: whole numbers");
  course.write("rubric.toml", kCommand);
  refuses("", "rubric.toml: rubric: has no [[task]]");
  fs::remove(course.path() / "rubric.toml");
  refuses("", "rubric.toml");
  const fixtures::Program program;
  fixtures::refuses(program, "grade", "expected FOLDER and --rubric");
}

BOOST_AUTO_TEST_CASE(names_of_files_are_different_where_names_are) {
  std::vector<std::string> names = {
      "a b", "a_b", "a%20b", "ab", "a/b", "\xC3\xA4", std::string(250, 'x'), std::string(251, 'x')};
  std::vector<std::string> out;
  for (const std::string& name : names) out.push_back(fileNameOf(name));
  for (const std::string& name : out) {
    BOOST_TEST(name.find('/') == std::string::npos);
    BOOST_TEST(name.size() < 240u);
  }
  std::sort(out.begin(), out.end());
  BOOST_TEST((std::unique(out.begin(), out.end()) == out.end()));
}
