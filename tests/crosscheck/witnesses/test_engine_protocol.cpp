// SPDX-License-Identifier: GPL-3.0-or-later
// Programs as witnesses: those that are shipped agree, a planted error is seen, and hostile ones
// get a reason each and leave nothing behind.
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>

#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/testimony.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "scene/scene.hpp"
#include "tests/fixtures/files.hpp"
#include "tests/fixtures/program.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
using fixtures::Outcome;
using fixtures::Program;
using fixtures::running;
namespace data = boost::unit_test::data;
namespace fs = std::filesystem;

namespace {

const std::string kEngines = std::string(DYNWITNESS_DATA_DIR) + "/engines";

/// What a hearing makes of one program.
struct Heard {
  std::vector<CheckResult> refusals;
  std::vector<std::pair<std::string, std::string>> remarks;
  std::vector<std::string> answering_M;
};
Heard heard(const std::string& command, const std::string& scene_name, double seconds = 10) {
  const scene::Scene scene = scene::findScene(scene_name);
  Options options;
  options.states = 3;
  Limits limits;
  limits.seconds = seconds;
  limits.gigabytes = 1;
  Hearing hearing(scene, engineKinds({command}, limits, scene), options);
  Heard out;
  out.refusals = hearing.dismissRefused();
  out.remarks = hearing.remarks();
  out.answering_M = hearing.answering(Quantity::kM);
  return out;
}

struct Hostile {
  std::string name, script, reason;
};
std::ostream& operator<<(std::ostream& out, const Hostile& hostile) {
  return out << hostile.name;
}

// of every script: what it needs, and the greeting is read
const std::string kStart = "import json, os, subprocess, sys, time\nline = sys.stdin.readline()\n";
// then it introduces itself, and reads the first batch
const std::string kHello =
    "print(json.dumps({'protocol': 1, 'quantities': ['M', 'tau']}), flush=True)\n"
    "batch = json.loads(sys.stdin.readline())\n"
    "answers = [{'M': [[1]], 'tau': [1]} for _ in batch['states']]\n";
const std::string kSay =
    "print(json.dumps({'batch': batch['batch'], 'answers': answers}), flush=True)\n"
    "sys.stdin.readline()\n";

/// The answer to the batch, letter by letter.
std::string written(const std::string& tau, const std::string& rest = "") {
  return fmt::format(
      "one = '{{\"M\":[[1]],\"tau\":{}}}'\n"
      "print('{{\"batch\":1,\"answers\":[' + ','.join([one] * 3) + ']}}{}', flush=True)\n"
      "sys.stdin.readline()\n",
      tau, rest);
}

// in place of both
const std::string kModel =
    "link = {'link': 'bob', 'mass': 1, 'com': [0, 0, 0], 'inertia': [[0] * 3] * 3}\n"
    "def hello(model): print(json.dumps({'protocol': 1, 'quantities': ['M'], 'model': model}), "
    "flush=True)\n";

// of the simple pendulum, with three states
const std::vector<Hostile> kHostile = {
    {"hangs in the handshake", "time.sleep(100)", "): it did not answer within 2 s and still runs"},
    {"hangs at a batch", kHello + "time.sleep(100)",
     "at batch 1 (3 states): it did not answer within"},
    {"dies in the handshake", "sys.exit(7)", "it failed with status 7, expected an answer"},
    {"ends at a batch", kHello, "at batch 1 (3 states): it ended (status 0), expected an answer"},
    {"crashes", "os.kill(os.getpid(), 11)", "it was ended by a signal (Segmentation fault)"},
    {"throws", kHello + "raise ValueError('elbow')",
     "it failed with status 1, expected an answer; its standard error ends with 'ValueError: "
     "elbow'"},
    {"rubbish", "print('hello', flush=True); time.sleep(100)",
     "expected a JSON object on one line, got 'hello'"},
    {"bytes that are no text", "os.write(1, bytes(range(128, 256)) + b'\\n'); time.sleep(100)",
     "expected a JSON object on one line, got '????"},
    {"nested without end", "print('{\"protocol\":' + '[' * 400000 + ']' * 400000 + '}')",
     "protocol: expected version 1, got "},
    {"a list in place of an object", "print('[1]')",
     "expected a JSON object on one line, got '[1]'"},
    {"another version", "print('{\"protocol\": 2}')", "protocol: expected version 1, got 2"},
    {"no version", "print('{\"quantities\": [\"M\"]}')",
     "protocol: expected version 1, got \"none\""},
    {"knows nothing", "print('{\"protocol\": 1, \"quantities\": []}')",
     "quantities: expected at least one of M, c, g, tau, qdd, kinetic, potential, momentum, "
     "reactions, jacobian, got []"},
    {"a quantity that does not exist", "print('{\"protocol\": 1, \"quantities\": [\"mass\"]}')",
     "quantities: expected names among M, c, g, tau, qdd, kinetic, potential, momentum, reactions, "
     "jacobian, got \"mass\""},
    {"a model that is no list", kModel + "hello(3)", "model: expected a list of links, got 3"},
    {"a model of another arm", kModel + "hello([dict(link, link='wrist')])",
     "model: expected names of links of the scene, base, bob, got \"wrist\""},
    {"a model with a link twice", kModel + "hello([link, link])",
     "model: expected each link once, got \"bob\""},
    {"a model without a mass", kModel + "del link['mass']\nhello([link])",
     "link 1 of model mass: expected a number, got \"none\""},
    {"a model with a flat inertia", kModel + "hello([dict(link, inertia=[1, 2, 3])])",
     "link 1 of model inertia: expected three numbers, got 1"},
    {"joints of another arm",
     "print('{\"protocol\": 1, \"quantities\": [\"M\"], \"joints\": [\"wrist\"]}')",
     "joints: expected all of pivot, in any order, got [\"wrist\"]"},
    {"rates in other axes",
     "print('{\"protocol\": 1, \"quantities\": [\"M\"], \"rates\": \"world\"}')",
     "rates: expected \"link\""},
    {"not a number", kHello + "answers[1]['tau'] = [float('nan')]\n" + kSay,
     "expected numbers, got NaN, which JSON has not"},
    {"a number past double", kHello + "print('{\"batch\":1,\"answers\":[1e999]}')\n" + kSay,
     "expected a JSON object on one line"},
    {"infinite", kHello + "answers[1]['M'] = [[float('inf')]]\n" + kSay,
     "expected numbers, got Infinity, which JSON has not"},
    {"a point without a digit behind it", kHello + written("[1.]"),
     "expected a JSON object on one line"},
    {"a point without a digit before it", kHello + written("[.5]"),
     "expected a JSON object on one line"},
    {"two numbers in one", kHello + written("[1.5.5]"), "expected a JSON object on one line"},
    {"a word behind the answer", kHello + written("[1]", "and so on"),
     "expected a JSON object on one line"},
    {"one row too many", kHello + "answers[2]['M'] = [[1], [1]]\n" + kSay,
     "M of state 3: expected 1 row, got \"2 of them\""},
    {"wrong length", kHello + "answers[1]['tau'] = [1, 2]\n" + kSay,
     "tau of state 2: expected 1 number, got \"2 of them\""},
    {"a vector in place of a matrix", kHello + "answers[2]['M'] = [1]\n" + kSay,
     "M of state 3: expected rows of 1 numbers, got 1"},
    {"words in place of numbers", kHello + "answers[0]['tau'] = ['one']\n" + kSay,
     "tau of state 1: expected 1 number, got [\"one\"]"},
    {"a quantity left out", kHello + "del answers[1]['tau']\n" + kSay,
     "tau of state 2: expected numbers, or a text with the reason"},
    {"a state left out", kHello + "answers.pop()\n" + kSay, "answers: expected a list of 3"},
    {"another batch", kHello + "batch['batch'] = 7\n" + kSay, "batch: expected 1, got 7"},
    {"says more than was asked",
     "print('{\"protocol\": 1, \"quantities\": [\"M\"]}\\n{}', flush=True)\n"
     "time.sleep(100)",
     "it said more than was asked, expected one line: '{}"},
    {"stops in the middle", "print('{\"proto', end='')",
     "it ended (status 0), in the middle of '{\"proto', expected an answer"},
    {"a gigabyte", kHello + "for _ in range(1024): os.write(1, b'x' * 2**20)",
     "its answer has more than"},
    {"closes standard input",
     kHello.substr(0, kHello.find('\n') + 1) + "os.close(0); time.sleep(100)",
     "and has closed its standard input"},
    {"closes standard output", "os.close(1); time.sleep(100)", "it closed its standard output"},
    {"standard error without end", "while True: os.write(2, b'moan ' * 1000 + b'\\n')",
     "it did not answer within"},
    {"much memory", "x = bytearray(2**31)",
     "it failed with status 1, expected an answer; its standard error ends with 'MemoryError'"},
    {"many processes",
     "for _ in range(200): subprocess.Popen(['sh', '-c', 'sleep 100; :', sys.argv[1]])\ntime.sleep(100)",
     "processes, allowed: 64"},
    {"kills its keeper", "os.kill(os.getppid(), 9); time.sleep(100)", "its keeper was killed"},
    {"a child in a session of its own",
     "subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(100)', sys.argv[1]], "
     "start_new_session=True)\nsys.exit(3)",
     "it failed with status 3"},
};

}  // namespace

BOOST_TEST_DECORATOR(*boost::unit_test::timeout(60))
BOOST_DATA_TEST_CASE(a_hostile_program_gets_a_reason_and_leaves_nothing, data::make(kHostile),
                     hostile) {
  const files::TemporaryFolder folder;
  const std::string script = (folder.path / "engine.py").string();
  std::ofstream(script) << kStart << hostile.script << "\n";
  const bool waits = files::contains(hostile.reason, "did not answer") ||
                     files::contains(hostile.reason, "closed its standard input");
  const Heard out =
      heard(fmt::format("exec python3 {0} {0}", script), "simple_pendulum", waits ? 2 : 30);
  BOOST_TEST_REQUIRE(out.refusals.size() == 1u);
  const CheckResult& check = out.refusals.front();
  BOOST_TEST((check.verdict == Verdict::kNotAnswerable));
  BOOST_TEST(files::contains(check.reason, hostile.reason), check.reason);
  BOOST_TEST(check.reason.size() < 600u);
  BOOST_TEST(check.reason.find('\n') == std::string::npos);
  BOOST_TEST(out.answering_M.empty());
  // held against the run
  const std::vector<Coverage> coverage = coverageOf(out.refusals);
  BOOST_TEST_REQUIRE(coverage.size() == 1u);
  BOOST_TEST(coverage.front().isThin());
  BOOST_TEST_REQUIRE(out.remarks.size() == 1u);
  BOOST_TEST(out.remarks.front().second == check.reason);
  BOOST_TEST(running(script) == 0);
}

BOOST_AUTO_TEST_CASE(json_may_be_written_in_many_ways) {
  const files::TemporaryFolder folder;
  const std::string script = (folder.path / "engine.py").string();
  const auto says = [&](const std::string& tau) {
    std::ofstream(script) << kStart << kHello << written(tau);
    return heard("exec python3 " + script, "simple_pendulum").refusals.size();
  };
  // M, tau and nothing else are known: seven quantities are refused
  const std::size_t left_out = says("[1]");
  BOOST_TEST(left_out == 7u);
  for (const char* tau : {" [ 1 ] ", "[1e0]", "[10E-1]", "[-1.0]", "[1], \"more\": {}", "\"none\""})
    BOOST_TEST(says(tau) == left_out, tau);
  std::ofstream(script) << kStart << kHello
                        << "print(json.dumps({'answers': [dict(reversed(a.items())) for a in "
                           "answers], 'batch': 1}), flush=True)\nsys.stdin.readline()\n";
  BOOST_TEST(heard("exec python3 " + script, "simple_pendulum").refusals.size() == left_out);
}

BOOST_AUTO_TEST_CASE(a_refusal_needs_no_words) {
  const Heard out = heard("echo '{\"protocol\": 1, \"refuses\": \"\"}'; cat", "simple_pendulum");
  BOOST_TEST_REQUIRE(out.refusals.size() == 1u);
  BOOST_TEST(files::contains(out.refusals.front().reason, "says: no, and not why"));
}

BOOST_AUTO_TEST_CASE(a_program_that_does_not_exist_is_one_that_failed) {
  const Heard out = heard("no_such_program_of_anybody", "simple_pendulum");
  BOOST_TEST_REQUIRE(out.refusals.size() == 1u);
  BOOST_TEST(files::contains(out.refusals.front().reason, "it failed with status 127"));
  BOOST_TEST(files::contains(out.refusals.front().reason, "not found"));
}

BOOST_AUTO_TEST_CASE(a_program_that_says_nothing_is_told_from_one_that_ended) {
  const Program program;
  const Outcome slow =
      program.run("check simple_pendulum --engine 'sleep 30' --engine-seconds 0.5");
  BOOST_TEST(slow.status == 1);
  BOOST_TEST(files::contains(slow.out,
                             "in the handshake (started as sleep 30): it did not answer within "
                             "0.5 s and still runs"),
             slow.out);
  BOOST_TEST(files::contains(slow.out, "--engine-seconds"), slow.out);
  const Outcome ended = program.run("check simple_pendulum --engine 'python3 nofile.py'");
  BOOST_TEST(ended.status == 1);
  BOOST_TEST(files::contains(ended.out, "(started as python3 nofile.py): it failed with status 2"),
             ended.out);
  BOOST_TEST(files::contains(ended.out, "No such file"), ended.out);
  // what somebody wrote who forgot the end of the line is what he has to be told
  const Outcome open =
      program.run("check simple_pendulum --engine 'printf {; sleep 30' --engine-seconds 0.5");
  BOOST_TEST(files::contains(open.out, "has said '{' and no end of the line"), open.out);
}

BOOST_AUTO_TEST_CASE(a_program_gets_none_of_our_files) {
  const int ours = open("/dev/null", O_RDONLY);  // without O_CLOEXEC
  const files::TemporaryFolder folder;
  const std::string script = (folder.path / "engine.py").string();
  std::ofstream(script) << kStart
                        << "print(json.dumps({'protocol': 1, 'refuses': ' '.join(f for f in "
                           "sorted(os.listdir('/proc/self/fd'))\n"
                           "  if os.path.exists('/proc/self/fd/' + f))}))\n";
  const Heard out = heard("python3 " + script, "simple_pendulum");
  close(ours);
  BOOST_TEST_REQUIRE(out.refusals.size() == 1u);
  BOOST_TEST(out.refusals.front().reason == "engine_1 says: 0 1 2");
  BOOST_TEST(coverageOf(out.refusals).empty());  // it may refuse a scene
}

BOOST_AUTO_TEST_CASE(what_it_does_not_know_is_not_answerable) {
  const Heard out = heard("python3 " + kEngines + "/double_pendulum.py", "double_pendulum");
  BOOST_TEST_REQUIRE(out.refusals.size() == 3u);
  BOOST_TEST(out.refusals[0].quantity == "kinetic");
  BOOST_TEST(out.refusals[0].reason ==
             "double_pendulum_by_hand does not know kinetic, it said that it knows M, c, g, tau, "
             "qdd, potential");
  BOOST_TEST(out.refusals[1].quantity == "momentum");
  BOOST_TEST(out.refusals[2].quantity == "reactions");
  BOOST_TEST(out.answering_M.size() == 1u);
  BOOST_TEST(out.remarks.empty());
}

BOOST_AUTO_TEST_SUITE(whole_program)

namespace {

const std::string kShort =
    " --random 20 --no-drift --no-charts --witness newton_euler,lagrange,simbody ";

/// A script that changes what open_chain.py says.
std::string changed(const Program& program, const std::string& change) {
  program.write("changed.py", "import sys\nsys.path.insert(0, '" + kEngines +
                                  "')\nimport open_chain, dynwitness_engine\n"
                                  "def engine(scene):\n"
                                  "    says = open_chain.engine(scene)\n" +
                                  change +
                                  "    return says\n"
                                  "dynwitness_engine.testify(engine, name='changed')\n");
  return " --engine 'python3 changed.py' ";
}

}  // namespace

BOOST_AUTO_TEST_CASE(the_engines_that_are_shipped_agree) {
  const Program program;
  const files::TemporaryFolder built;
  BOOST_TEST_REQUIRE(std::system(("c++ -std=c++17 -O2 -o " + built.path.string() + "/in_cpp " +
                                  kEngines + "/double_pendulum.cpp")
                                     .c_str()) == 0);
  const Outcome two =
      program.run("crosscheck double_pendulum" + kShort + "--engine 'python3 " + kEngines +
                  "/double_pendulum.py' --engine " + built.path.string() + "/in_cpp");
  BOOST_TEST(two.status == 0, two.out);
  const Outcome besides =
      program.run("check double_pendulum --engine " + built.path.string() + "/in_cpp");
  BOOST_TEST(besides.status == 0, besides.out);
  for (const char* said : {"  model      right", "  jacobian   right"})
    BOOST_TEST(files::contains(besides.out, said), besides.out);
  const Outcome chains = program.run(
      "crosscheck double_pendulum puma_560 stanford_arm prismatic_revolute_mix gripper" + kShort +
      "--json r.json --engine 'python3 " + kEngines + "/open_chain.py'");
  BOOST_TEST(chains.status == 0, chains.out);
  const std::string json = program.read("r.json");
  for (const char* name : {"\"open_chain_in_python\"", "open_chain.py'"})
    BOOST_TEST(files::contains(json, name), name);
}

// The section of the README, word by word, where the clone's program and data are.
BOOST_AUTO_TEST_CASE(check_your_own_code_works_by_copy_and_paste) {
  const std::string readme = files::read(fs::path(DYNWITNESS_SOURCE_DIR) / "README.md");
  const std::size_t begin = readme.find("\n## Check your own code\n");
  BOOST_TEST_REQUIRE(begin != std::string::npos);
  const std::string section = readme.substr(begin, readme.find("\n## ", begin + 1) - begin);
  const files::TemporaryFolder clone;
  fs::create_symlink(DYNWITNESS_PROGRAM, clone.path / "dynwitness");
  fs::create_symlink(DYNWITNESS_DATA_DIR, clone.path / "data");
  int blocks = 0;
  const std::string open = "```sh\n", close = "```\n";
  for (std::size_t at = 0; (at = section.find(open, at)) != std::string::npos; ++blocks) {
    at += open.size();
    std::ofstream(clone.path / "block.sh") << section.substr(at, section.find(close, at) - at);
    const std::string command =
        "cd '" + clone.path.string() + "' && sh -e block.sh > said.txt 2>&1";
    const int status = WEXITSTATUS(std::system(command.c_str()));
    const std::string said = files::read(clone.path / "said.txt");
    if (blocks == 2) {  // the stranger's mistake, named
      BOOST_TEST(status == 1, said);
      BOOST_TEST(files::contains(said, "explained exactly by: inertia of link 'link_3'"), said);
      continue;
    }
    if (blocks == 3) {  // formulas by hand, judged as is printed below them
      const std::string shown = "```text\n";
      const std::size_t text = section.find(shown, at) + shown.size();
      BOOST_TEST(status == 1, said);
      BOOST_TEST(files::contains(said, section.substr(text, section.find(close, text) - text)),
                 said);
      continue;
    }
    BOOST_TEST(status == 0, said);
    BOOST_TEST(files::contains(said, "all agree"));
    BOOST_TEST(files::contains(files::read(clone.path / "report/report.json"), "my_arm"));
  }
  BOOST_TEST(blocks == 4);
}

BOOST_AUTO_TEST_CASE(a_planted_sign_is_seen) {
  const Program program;
  const std::string engine = changed(program,
                                     "    c = says['c']\n"
                                     "    says['c'] = lambda q, qd: [-x for x in c(q, qd)]\n");
  const Outcome outcome = program.run("crosscheck double_pendulum" + kShort + engine);
  BOOST_TEST(outcome.status == 1);
  BOOST_TEST(files::contains(outcome.out, "DISAGREE"), outcome.out);
  BOOST_TEST(files::contains(outcome.out, "changed"), outcome.out);
}

namespace {

/// One thing wrong in what open_chain.py says besides quantities, or in its reactions.
struct Beside {
  std::string name, change;  ///< of says['...']
  std::string finding;       ///< by crosscheck
  std::string why;           ///< by check
};
std::ostream& operator<<(std::ostream& out, const Beside& beside) {
  return out << beside.name;
}
const std::string kOfReactions =
                      "    r = says['reactions']\n    says['reactions'] = lambda q, qd, qdd: ",
                  kOfJacobian =
                      "    j = says['jacobian']\n    says['jacobian'] = lambda q, frame: ",
                  kOfModel = "    m = says['model']\n    says['model'] = lambda: ";
const std::vector<Beside> kBeside = {
    {"reactions the other way", kOfReactions + "[[-x for x in row] for row in r(q, qd, qdd)]\n",
     "changed stands alone in reactions",
     "explained exactly by: reactions that the link exerts on its parent"},
    {"moments first", kOfReactions + "[row[3:] + row[:3] for row in r(q, qd, qdd)]\n",
     "changed stands alone in reactions", "explained exactly by: reactions with the moment first"},
    {"one moment off",
     kOfReactions +
         "(lambda R: R[:2] + [R[2][:5] + [R[2][5] * (1 + 1e-9)]] + R[3:])(r(q, qd, qdd))\n",
     "changed stands alone in reactions", "nothing on record explains it"},
    {"a Jacobian of another point", kOfJacobian + "j(q, dict(frame, at=[0, 0, 0]))\n",
     "changed: jacobian: jacobian[",
     "explained exactly by: it is that of the link's origin in place of the point"},
    {"a Jacobian with angular rows first", kOfJacobian + "j(q, frame)[3:] + j(q, frame)[:3]\n",
     "changed: jacobian: jacobian[", "explained exactly by: it is that angular rows first"},
    {"a Jacobian with one entry off",
     kOfJacobian + "(lambda J: [[x * (1 + 1e-9) for x in J[0]]] + J[1:])(j(q, frame))\n",
     "changed: jacobian: jacobian[1,", "nothing on record explains it"},
    {"one mass",
     kOfModel + "[dict(l, mass=1.1 * l['mass']) if l['link'] == 'link_3' else l for l in m()]\n",
     "changed: model: link 'link_3': mass is 5.28 kg in its model and 4.8 kg in the scene",
     "model      wrong      link 'link_3': mass is 5.28 kg in its model and 4.8 kg in the scene"},
    {"one link", kOfModel + "m()[:4] + m()[5:]\n",
     "changed: model: link 'link_5' is missing in its model",
     "model      wrong      link 'link_5' is missing in its model"},
};

}  // namespace

BOOST_DATA_TEST_CASE(what_is_said_besides_quantities_is_judged, data::make(kBeside), beside) {
  const Program program;
  const std::string engine = changed(program, beside.change);
  const Outcome crosschecked = program.run("crosscheck puma_560" + kShort + engine);
  BOOST_TEST(crosschecked.status == 1, crosschecked.out);
  BOOST_TEST(files::contains(crosschecked.out, beside.finding), crosschecked.out);
  const Outcome checked = program.run("check puma_560" + engine);
  BOOST_TEST(checked.status == 1, checked.out);
  BOOST_TEST(files::contains(checked.out, beside.why), checked.out);
  for (const char* right : {"  M          right", "  tau        right"})
    BOOST_TEST(files::contains(checked.out, right), checked.out);
}

BOOST_AUTO_TEST_CASE(another_order_of_joints_is_undone_and_told) {
  const Program program;
  program.write("reversed.py",
                "import sys\nsys.path.insert(0, '" + kEngines +
                    "')\nimport open_chain, dynwitness_engine\n"
                    "def engine(scene):\n"
                    "    says = open_chain.engine(scene)\n"
                    "    return {'M': lambda q: [r[::-1] for r in says['M'](q[::-1])][::-1],\n"
                    "            'c': lambda q, qd: says['c'](q[::-1], qd[::-1])[::-1],\n"
                    "            'jacobian': lambda q, frame: [r[::-1] for r in "
                    "says['jacobian'](q[::-1], frame)],\n"
                    "            'tau': lambda q, qd, qdd: says['tau'](q[::-1], qd[::-1], "
                    "qdd[::-1])[::-1],\n"
                    "            'qdd': lambda q, qd, tau: says['qdd'](q[::-1], qd[::-1], "
                    "tau[::-1])[::-1]}\n"
                    "dynwitness_engine.testify(engine, joints=['elbow', 'shoulder'])\n");
  const Outcome outcome =
      program.run("crosscheck double_pendulum" + kShort + "--engine 'python3 reversed.py'");
  BOOST_TEST(outcome.status == 0, outcome.out);
  BOOST_TEST(files::contains(outcome.out,
                             "engine_1 has its joints in another order than the scene (elbow, "
                             "shoulder): undone"),
             outcome.out);
}

// V = -m gravity'(R com), by the formula of a quaternion of any length in scene/mechanism.hpp
BOOST_AUTO_TEST_CASE(another_order_of_a_quaternion_is_undone_and_told) {
  const Program program;
  program.write("top.py", "import sys\nsys.path.insert(0, '" + kEngines +
                              "')\nimport dynwitness_engine\n"
                              "def engine(scene):\n"
                              "    link, g = scene['links'][1], scene['gravity']\n"
                              "    def potential(q):\n"
                              "        v, w = q[:3], q[3]\n"
                              "        def cross(a, b): return [a[1]*b[2]-a[2]*b[1], "
                              "a[2]*b[0]-a[0]*b[2], a[0]*b[1]-a[1]*b[0]]\n"
                              "        a = cross(v, link['com'])\n"
                              "        b = cross(v, a)\n"
                              "        s = sum(x * x for x in q)\n"
                              "        p = [x + 2 * (w * y + z) / s for x, y, z in "
                              "zip(link['com'], a, b)]\n"
                              "        return -link['mass'] * sum(x * y for x, y in zip(g, p))\n"
                              "    return {'potential': potential}\n"
                              "dynwitness_engine.testify(engine, quaternion='xyzw')\n");
  const Outcome outcome =
      program.run("crosscheck heavy_top" + kShort + "--engine 'python3 top.py'");
  BOOST_TEST(outcome.status == 0, outcome.out);
  BOOST_TEST(files::contains(outcome.out, "quaternions as (x, y, z, w): undone"), outcome.out);
}

BOOST_AUTO_TEST_CASE(a_failure_is_told_and_is_no_success) {
  const Program program;
  program.write("dies.py", "import sys\nsys.stdin.readline()\nsys.exit('no licence')\n");
  const Outcome outcome =
      program.run("crosscheck double_pendulum" + kShort + "--engine 'python3 dies.py'");
  BOOST_TEST(outcome.status == 1);
  for (const char* words :
       {"incomplete", "finding: double_pendulum: engine_1 failed", "no licence"})
    BOOST_TEST(files::contains(outcome.out, words), outcome.out);
  BOOST_TEST(
      program.run("evaluate double_pendulum --quantity M --engine 'python3 dies.py'").status == 1);
}

BOOST_AUTO_TEST_CASE(evaluate_asks_it) {
  const Program program;
  program.write("s.csv", "q1,q2,qd1,qd2\n0.5,1,3,2\n");
  const std::string words = "evaluate double_pendulum --states s.csv --quantity M,c ";
  const Outcome theirs =
      program.run(words + "--engine 'python3 " + kEngines + "/double_pendulum.py'");
  const Outcome ours = program.run(words);
  BOOST_TEST_REQUIRE(theirs.status == 0, theirs.out);
  double a[6], b[6];
  const char* const pattern = "%*s %lf,%lf,%lf,%lf,%lf,%lf";
  BOOST_TEST_REQUIRE(
      std::sscanf(theirs.out.c_str(), pattern, a, a + 1, a + 2, a + 3, a + 4, a + 5) == 6);
  BOOST_TEST_REQUIRE(std::sscanf(ours.out.c_str(), pattern, b, b + 1, b + 2, b + 3, b + 4, b + 5) ==
                     6);
  for (int i = 0; i < 6; ++i) BOOST_TEST(a[i] == b[i], boost::test_tools::tolerance(1e-14));
  fixtures::refuses(
      program, words + "--witness simbody --engine 'python3 " + kEngines + "/double_pendulum.py'",
      "--engine");
  fixtures::refuses(program,
                    "evaluate double_pendulum --quantity kinetic --engine 'python3 " + kEngines +
                        "/double_pendulum.py'",
                    "does not answer kinetic");
}

BOOST_AUTO_TEST_CASE(the_same_seed_asks_the_same_bytes_and_gives_the_same_report) {
  const Program program;
  setenv("SOURCE_DATE_EPOCH", "0", 1);
  const std::string words = "crosscheck double_pendulum --processes 1" + kShort +
                            "--engine 'tee asked.txt | python3 " + kEngines +
                            "/double_pendulum.py' --json ";
  BOOST_TEST(program.run(words + "a.json").status == 0);
  const std::string asked = program.read("asked.txt");
  BOOST_TEST(program.run(words + "b.json").status == 0);
  BOOST_TEST(asked.size() > 1000u);
  BOOST_TEST((program.read("asked.txt") == asked));
  BOOST_TEST((program.read("a.json") == program.read("b.json")));
}

BOOST_AUTO_TEST_SUITE_END()
