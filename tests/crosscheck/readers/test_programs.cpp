// SPDX-License-Identifier: GPL-3.0-or-later
// Readers that are programs, and readers that come to grief: what they say is heard, and what they
// do to themselves is a finding and nobody else's end.
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE programs
#include <csignal>
#include <cstdlib>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/readers/compare.hpp"
#include "tests/fixtures/program.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

/// One hinge about x; by hand: I about it is 2 + 3 (0.1^2 + 0.2^2) = 2.15 kg m^2.
const char* const kHinge =
    "<robot name=\"hinge\"><link name=\"base\"/>\n"
    "<link name=\"a\"><inertial><origin xyz=\"0.3 0.1 -0.2\" rpy=\"0 0 1.5707963267948966\"/>"
    "<mass value=\"3\"/><inertia ixx=\"1\" iyy=\"2\" izz=\"1.5\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>"
    "</inertial></link>\n"
    "<joint name=\"hinge\" type=\"continuous\"><parent link=\"base\"/><child link=\"a\"/>"
    "<axis xyz=\"1 0 0\"/></joint></robot>\n";

ReaderResult readBy(const Reader& reader, const ReaderLimits& limits = {}) {
  return examineReaders(kHinge, "hinge.urdf", {reader}, 3, 1, limits).readers.at(0);
}
ReaderResult readByProgram(const std::string& mode) {
  const std::string folder = std::string(DYNWITNESS_SOURCE_DIR) + "/tests/crosscheck/readers";
  return readBy(programReader(
      "engine_1",
      "python3 " + folder + "/reader.py " + mode + " " + DYNWITNESS_DATA_DIR + "/engines", {}));
}
bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

struct Grief {
  const char* name;
  std::function<void()> happen;
  const char* words;
};
std::ostream& operator<<(std::ostream& out, const Grief& grief) {
  return out << grief.name;
}
volatile bool is_forever = true;
const Grief kGriefs[] = {
    {"abort", [] { std::abort(); }, "(Aborted)"},
    {"fault", [] { std::raise(SIGSEGV); }, "(Segmentation fault)"},
    {"exit", [] { std::exit(7); }, "failed with status 7"},
    {"words", [] { std::fprintf(stderr, "first\nassertion x > 0\n"), std::abort(); },
     "its last words: assertion x > 0"},
    {"hang",
     [] {
       while (is_forever) usleep(1000);
     },
     "was not done within 0.5 s"},
    {"memory", [] { std::vector<double> much(std::size_t{1} << 30, 1.0); },
     "it asked for more memory than 1 GB"},
};

}  // namespace

BOOST_DATA_TEST_CASE(what_happens_to_a_reader_is_a_finding_and_nobody_elses_end,
                     data::make(kGriefs), grief) {
  Reader unhappy{"unhappy", "", true, {}};
  unhappy.read = [&](const std::string&, const std::filesystem::path&) -> Reading {
    grief.happen();
    return {};
  };
  ReaderLimits limits;
  limits.seconds = 0.5;
  limits.gigabytes = 1;
  const ReaderResult result = readBy(unhappy, limits);
  BOOST_REQUIRE(result.findings.size() == 1u);
  BOOST_TEST(result.findings[0].quantity == "failure");
  BOOST_TEST(holds(result.failure, grief.words), result.failure);
  BOOST_TEST(!result.has_read);
}

// A crash in the engine's own computation of M counts as well.
BOOST_AUTO_TEST_CASE(a_reader_that_crashes_when_it_answers_fails) {
  Reader reader{"late", "", true, {}};
  reader.read = [](const std::string& text, const std::filesystem::path& file) {
    Reading reading;
    reading.robot = FileParts(scene::readUrdfAsWritten(text, file)).robot();
    reading.answer = [](const std::vector<double>&) -> MassAndGravity { std::abort(); };
    return reading;
  };
  BOOST_TEST(holds(readBy(reader).failure, "(Aborted)"));
}

// What crashes with the shapes and reads without is told with what it then has.
BOOST_AUTO_TEST_CASE(a_reader_that_crashes_at_shapes_is_heard_without_them) {
  std::string file = kHinge;
  file.insert(file.find("</inertial>") + 11,
              "<visual><geometry><sphere radius=\"1\"/></geometry></visual>");
  Reader reader{"shy", "", true, {}};
  reader.read = [](const std::string& text, const std::filesystem::path& path) {
    if (holds(text, "<visual>")) std::abort();
    Reading reading;
    reading.robot = FileParts(scene::readUrdfAsWritten(text, path)).robot();
    return reading;
  };
  const ReaderResult result = examineReaders(file, "hinge.urdf", {reader}, 1, 1).readers.at(0);
  BOOST_TEST(result.has_read);
  BOOST_REQUIRE(result.findings.size() == 1u);
  BOOST_TEST(result.findings[0].quantity == "failure");
}

BOOST_AUTO_TEST_CASE(a_program_that_shows_what_it_has_read_is_compared_with_the_file) {
  const ReaderResult result = readByProgram("shows");
  BOOST_TEST(result.name == "test");
  BOOST_TEST(result.version == "7");
  BOOST_TEST(result.findings.empty());
  BOOST_REQUIRE(!result.told.empty());
  BOOST_TEST(result.told[0] == "of the test");
}

BOOST_DATA_TEST_CASE(a_program_that_says_M_and_g_or_tau_has_the_robot_of_the_file,
                     data::make({"answers", "tau"}), mode) {
  const ReaderResult result = readByProgram(mode);
  BOOST_TEST(result.has_read);
  BOOST_TEST(result.failure == "");
  BOOST_TEST(result.findings.empty());
}

BOOST_AUTO_TEST_CASE(a_mistake_of_a_program_that_shows_nothing_is_named) {
  const ReaderResult result = readByProgram("forgets");
  BOOST_REQUIRE(result.findings.size() == 1u);
  BOOST_TEST(result.findings[0].link == "a");
  BOOST_TEST(result.findings[0].rule == "the rpy of <inertial> is dropped (a)");
  BOOST_TEST(result.findings[0].where.line == 2);
  BOOST_TEST(result.findings[0].effect.M_percent == 100 / 2.15, boost::test_tools::tolerance(1e-9));
  BOOST_TEST(result.remedy != "");
}

struct Fault {
  const char *mode, *words;
};
std::ostream& operator<<(std::ostream& out, const Fault& fault) {
  return out << fault.mode;
}
const Fault kFaults[] = {
    {"dies", "I give up"},
    {"nonsense", "expected a JSON object on one line"},
    {"ignores", "KeyError: 'links'"},
    {"order", "joints: expected all of hinge, in any order, got elbow"},
};
BOOST_DATA_TEST_CASE(a_program_that_comes_to_grief_is_a_finding, data::make(kFaults), fault) {
  const ReaderResult result = readByProgram(fault.mode);
  BOOST_REQUIRE(result.findings.size() == 1u);
  BOOST_TEST(result.findings[0].quantity == "failure");
  BOOST_TEST(holds(result.failure, fault.words), result.failure);
}

BOOST_AUTO_TEST_CASE(a_program_that_refuses_says_why) {
  const ReaderResult result = readByProgram("refuses");
  BOOST_TEST(result.refusal == "it is Tuesday");
  BOOST_TEST(result.findings.empty());
  BOOST_TEST(!result.has_read);
}

BOOST_AUTO_TEST_CASE(the_command_takes_a_program_and_writes_a_page) {
  const fixtures::Program program;
  program.write("hinge.urdf", kHinge);
  const std::string folder = std::string(DYNWITNESS_SOURCE_DIR) + "/tests/crosscheck/readers";
  const fixtures::Outcome outcome =
      program.run("readers hinge.urdf --html page.html --engine 'python3 " + folder +
                  "/reader.py forgets " + DYNWITNESS_DATA_DIR + "/engines'");
  BOOST_TEST(outcome.status == 1);
  BOOST_TEST(holds(outcome.out,
                   "test 7: hinge.urdf:2: link \"a\": inertia: the rpy of <inertial> "
                   "is dropped (a); M 46.5 % on its diagonal"),
             outcome.out);
  const std::string page = program.read("page.html"), picture = program.read("page.view.html");
  BOOST_TEST(holds(page, "the rpy of &lt;inertial&gt; is dropped (a)"));
  BOOST_TEST(holds(page, "<a href=\"page.view.html\">"));
  // as written, and as the program reads it: 1, 2, 1.5 about the turned axes, and dropped
  BOOST_TEST(holds(picture, "class=\"body\"><title>a: 3 kg</title>"));
  BOOST_TEST(holds(picture, "class=\"body read\"><title>a: 3 kg, as test 7 reads it</title>"));
  BOOST_TEST(holds(picture, "test 7 has a: the rpy of &lt;inertial&gt; is dropped (a)"));
}
