// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <sstream>
#include <string>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <boost/test/unit_test.hpp>
#include <nlohmann/json.hpp>

#include "crosscheck/report/digits_table.hpp"
#include "crosscheck/report/json.hpp"
#include "crosscheck/report/page.hpp"
#include "crosscheck/report/plot.hpp"
#include "crosscheck/report/report.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/report/tree_svg.hpp"
#include "crosscheck/system/gnuplot.hpp"
#include "scene/error.hpp"
#include "tests/fixtures/files.hpp"

namespace fs = std::filesystem;
using namespace dynwitness::crosscheck;
using dynwitness::files::contains;
using dynwitness::files::count;
using dynwitness::files::read;
using dynwitness::files::TemporaryFolder;
using dynwitness::scene::InputError;

namespace {

const std::string kAwkward =
    "a<b> & \"c\" 'd' \xC3\xA9\xE2\x86\x92 </script><script>alert(1)</script>";

std::string formula(const std::string& content) {
  return "<math xmlns=\"http://www.w3.org/1998/Math/MathML\" display=\"block\">" + content +
         "</math>";
}

CheckResult check(const std::string& quantity, const std::string& left, const std::string& right,
                  double worst, double limit) {
  CheckResult c;
  c.kind = right.empty() ? CheckKind::kLaw : CheckKind::kSame;
  if (right.empty()) c.law = "symmetric";
  c.statement = right.empty() ? quantity + " = " + quantity + "'"
                              : quantity + " by " + left + " = " + quantity + " by " + right;
  c.quantity = quantity;
  c.left = left;
  c.right = right;
  c.states = 100;
  c.worst = worst;
  c.limit = limit;
  c.ratio = worst / limit;
  c.worst_state = 17;
  c.worst_entry = quantity + "[1]";
  c.seed = 18446744073709551615u;
  if (c.ratio > 1) {
    c.verdict = Verdict::kDisagree;
    c.reason = "beyond rounding: " + kAwkward;
  }
  return c;
}

SceneResult pendulum() {
  SceneResult scene;
  scene.name = "pendulum";
  scene.title = "Pendulum";
  scene.file = "data/scenes/pendulum.toml";
  scene.dof = 1;
  scene.links = 2;
  scene.link_names = {"base", "bob"};
  scene.joint_labels = {"", "pivot (revolute)"};
  scene.parents = {-1, 0};
  Ledger ledger;
  ledger.links = ledger.joints = ledger.rates = 1;
  ledger.parameters = 10;
  ledger.base_parameters = 3;
  ledger.general_operations = 119;
  ledger.no_operations = "not written: " + kAwkward;
  ledger.zeros = {{"M", 1, 0, {}, ""}, {"c", 1, 1, {{"M does not depend on q", {"c_1"}}}, ""}};
  scene.ledger = ledger;
  scene.equations.summary = "closed form, 3 terms";
  scene.equations.kinetic = formula(
      "<mi>T</mi><mo>=</mo><mfrac><mn>1</mn><mn>2</mn></mfrac><mi>m</mi><msup><mi>l</mi><mn>2</mn></msup><msup><mover><mi>q</mi><mo>˙</mo></mover><mn>2</mn></msup>");
  scene.equations.potential =
      formula("<mi>V</mi><mo>=</mo><mo>−</mo><mi>m</mi><mi>g</mi><mi>l</mi>");
  scene.equations.lines = {formula("<msub><mi>M</mi><mn>11</mn></msub><mo>=</mo><mi>J</mi>")};
  for (const char* quantity : {"M", "c", "g", "tau", "qdd"})
    for (const char* right : {"newton_euler", "simbody", "composite_body"})
      scene.checks.push_back(check(quantity, "lagrange", right, 7.4, 64));
  scene.checks.push_back(check("M", "lagrange", "", 0, 8));
  Drift drift;
  drift.method = "runge_kutta4";
  drift.method_order = 4;
  drift.duration = 10;
  drift.scale = 3.2;
  drift.observed_order = 4.04;
  for (const double step : {0.01, 0.005, 0.0025}) {
    Drift::Path path;
    path.step = step;
    for (int i = 0; i <= 100; ++i) {
      path.time.push_back(0.1 * i);
      path.error.push_back(std::pow(step, 4) * 0.1 * i * std::abs(std::sin(0.3 * i)));
      path.worst = std::max(path.worst, path.error.back());
    }
    drift.paths.push_back(path);
  }
  scene.drift = drift;
  return scene;
}

/// Everything that a report can hold, with strings that break careless writers.
CrosscheckResult sample() {
  CrosscheckResult result;
  result.seed = 18446744073709551615u;
  result.states = 100;
  result.command = "./dynwitness crosscheck 'a<b>' --seed 18446744073709551615";
  result.witnesses = {{"lagrange", "0.1.0", "T and V, differentiated; " + kAwkward},
                      {"simbody", "3.7", "Simbody's matter subsystem", true,
                       "known loss: " + kAwkward + "\nremedy: none"},
                      {"mujoco", "", "reads the URDF itself", false},
                      {"kernel", "0.1.0", "compiled", false, "", "no compiler: " + kAwkward}};
  result.scenes.push_back(pendulum());

  SceneResult awkward = pendulum();
  awkward.name = "../up & <down>";  // must not leave the folder
  awkward.title = kAwkward;
  awkward.source = kAwkward;
  awkward.link_names = {kAwkward, kAwkward};
  awkward.joint_labels = {"", kAwkward + " (prismatic)"};
  awkward.not_modelled = {kAwkward};
  awkward.checks[1] = check("M", "lagrange", "simbody", 9.9e6, 64);
  awkward.checks[2] = check("M", "lagrange", kAwkward, std::nan(""), 64);
  awkward.checks[2].verdict = Verdict::kDisagree;
  awkward.checks[3].verdict = Verdict::kNotAnswerable;
  awkward.checks[3].reason = "no table: " + kAwkward;
  awkward.checks[4].addVoided(2, "M is singular", true);
  awkward.checks[4].addVoided(3, "a bound ran away: " + kAwkward, false);
  awkward.checks[4].no_exact = "too large: " + kAwkward;
  Control control;
  control.quantity = "M";
  control.size = 1e-8;
  control.found = {Road::kPairs, Road::kField};
  control.blind = {kAwkward};
  awkward.controls = {control, {}};
  awkward.controls[1].quantity = "c";
  awkward.controls[1].nothing = "is zero: " + kAwkward;
  Finding alone;
  alone.scene = awkward.name;
  alone.quantity = "M";
  alone.witness = "simbody";
  alone.text = "simbody stands alone: " + kAwkward;
  Finding loss = alone;
  loss.kind = Finding::Kind::kKnownLoss;
  loss.text = "keeps few digits: " + kAwkward;
  loss.digits = 7.3;
  awkward.findings = {alone, loss};
  awkward.digits = {{"simbody", "M", Scalar::kDouble, 100, 7.3, 15.2, 6.9, 17, "M[1,2]"},
                    {kAwkward, "M", Scalar::kFloat, 0, {}, {}, {}, 0, ""}};
  result.scenes.push_back(awkward);

  SceneResult bare;  // nothing but a name, twice
  bare.name = "pendulum";
  result.scenes.push_back(bare);
  return result;
}

Environment environment() {
  Environment e;
  e.version = "0.1.0";
  e.commit = "0123456789ab";
  e.compiler = "GNU 12.2.0";
  e.flags = "-O3 -DX=\"<&>\"";
  e.cpu = "a CPU";
  e.date = "2025-11-21T10:45:00Z";
  e.libraries = {{"Eigen", "3.4.0"}, {"gnuplot", gnuplotVersion()}};
  return e;
}

bool haveGnuplot() {
  return gnuplotVersion() != "not found";
}

/// Every file below a folder with its content.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[entry.path().lexically_relative(folder).generic_string()] = read(entry.path());
  return files;
}

/// The first page and those of the scenes.
std::string allPages(const fs::path& report) {
  std::string pages = read(report / "index.html");
  for (const auto& [file, text] : contents(report))
    if (file.compare(0, 7, "scenes/") == 0 && file.size() > 11 &&
        file.compare(file.size() - 11, 11, "/index.html") == 0)
      pages += text;
  return pages;
}

/// The same without a folder.
std::string allPages(const CrosscheckResult& result) {
  const std::vector<SceneFiles> files(result.scenes.size());
  std::string pages = reportPage(result, environment(), files);
  for (std::size_t k = 0; k < files.size(); ++k)
    pages += scenePage(result, k, environment(), files[k]);
  return pages;
}

/// While this lives no file can grow beyond `bytes`, as on a disk that is about to be full.
struct FullDisk {
  rlimit before{};
  explicit FullDisk(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);  // write() then returns EFBIG
    getrlimit(RLIMIT_FSIZE, &before);
    rlimit small = before;
    small.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before); }
};

boost::property_tree::ptree parseXml(const std::string& text) {
  std::istringstream stream(text);
  boost::property_tree::ptree tree;
  boost::property_tree::read_xml(stream, tree);
  return tree;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(whole_report)

BOOST_FIXTURE_TEST_CASE(all_files_are_there, TemporaryFolder) {
  writeReport(sample(), environment(), path / "deep" / "report");
  const auto files = contents(path / "deep" / "report");
  for (const char* file :
       {"index.html", "report.json", "junit.xml", "digits.md", "contents.txt", "scenes/style.gp",
        "scenes/pendulum/index.html", "scenes/pendulum/tree.svg", "scenes/pendulum/drift.csv",
        "scenes/pendulum/drift_worst.csv", "scenes/pendulum/drift.gp"})
    BOOST_TEST(files.count(file) == 1, file);
  if (haveGnuplot()) {
    BOOST_TEST(files.count("scenes/pendulum/drift.svg") == 1);
    BOOST_TEST(files.count("scenes/pendulum/drift_dark.svg") == 0);  // one for light and dark
    BOOST_TEST(!contains(allPages(path / "deep" / "report"), "The plot was left out"));
  }
  // nothing else next to it
  BOOST_TEST(std::distance(fs::directory_iterator(path), fs::directory_iterator()) == 1);
  BOOST_TEST(std::distance(fs::directory_iterator(path / "deep"), fs::directory_iterator()) == 1);
  struct stat status {};
  stat((path / "deep" / "report").c_str(), &status);
  BOOST_TEST((status.st_mode & S_IXUSR) != 0);
}

/// For the tests that open the report in a browser and hold it to the schema.
BOOST_AUTO_TEST_CASE(sample_is_left_where_the_environment_asks) {
  const char* folder = std::getenv("DYNWITNESS_TEST_REPORT");
  if (folder == nullptr) {
    BOOST_TEST_MESSAGE("DYNWITNESS_TEST_REPORT is not set: no sample is left");
    BOOST_TEST(true);
    return;
  }
  writeReport(sample(), environment(), folder);
  BOOST_TEST(fs::exists(fs::path(folder) / "index.html"));
}

BOOST_FIXTURE_TEST_CASE(same_input_gives_the_same_bytes, TemporaryFolder) {
  writeReport(sample(), environment(), path / "one");
  writeReport(sample(), environment(), path / "two");
  writeReport(sample(), environment(), path / "two");
  BOOST_TEST((contents(path / "one") == contents(path / "two")));
}

BOOST_FIXTURE_TEST_CASE(result_without_scenes_is_still_a_report, TemporaryFolder) {
  writeReport({}, environment(), path / "report");
  BOOST_TEST(contains(read(path / "report/index.html"), "0 scenes"));
}

BOOST_FIXTURE_TEST_CASE(the_audit_is_linked_where_it_lies, TemporaryFolder) {
  const char* link = "<a href=\"audit/index.html\">";
  writeReport(sample(), environment(), path / "report");
  BOOST_TEST(!contains(read(path / "report/index.html"), link));
  BOOST_TEST(contains(read(path / "report/index.html"), "dynwitness audit -o"));
  fs::create_directories(path / "report/audit");
  std::ofstream(path / "report/audit/index.html") << "the audit";
  writeReport(sample(), environment(), path / "report");
  BOOST_TEST(contains(read(path / "report/index.html"), link));
  BOOST_TEST(read(path / "report/audit/index.html") == "the audit");
}

/// One a scene of the sample, with these times [ns].
std::vector<Chart> charts(double time) {
  Chart chart;
  chart.scene = kAwkward;
  chart.title = kAwkward;
  chart.quantity = "tau";
  chart.states = 100;
  chart.machine = kAwkward;
  chart.left_out = {kAwkward};
  chart.points = {{"Newton-Euler sweep", Scalar::kFloat, 1e-6, 1e-7, time, 2 * time, 3 * time},
                  {"Newton-Euler sweep", Scalar::kDouble, 1e-15, 1e-16, time, 2 * time, 3 * time},
                  {"simbody", Scalar::kDouble, 0, 0, 5 * time, 6 * time, 7 * time}};
  return {chart, chart, chart};
}

BOOST_FIXTURE_TEST_CASE(charts_are_drawn_and_their_times_stay_out_of_page_and_json,
                        TemporaryFolder) {
  writeReport(sample(), environment(), path / "one", charts(1e3));
  writeReport(sample(), environment(), path / "two", charts(7e6));
  const auto one = contents(path / "one"), two = contents(path / "two");
  BOOST_TEST(count(allPages(path / "one"), "<h2>Speed against accuracy</h2>") == 3u);
  for (const char* file :
       {"index.html", "scenes/pendulum/index.html", "report.json", "junit.xml", "contents.txt"})
    BOOST_TEST(one.at(file) == two.at(file), file);
  BOOST_TEST(one.at("scenes/pendulum/speed.csv") != two.at("scenes/pendulum/speed.csv"));
  BOOST_TEST(one.count("scenes/pendulum/speed.gp") == 1);
  if (haveGnuplot())
    for (const char* file : {"scenes/pendulum/speed.svg", "scenes/___up____down_/speed.svg"})
      BOOST_TEST(one.count(file) == 1, file);
}

BOOST_FIXTURE_TEST_CASE(charts_of_other_scenes_are_refused, TemporaryFolder) {
  std::vector<Chart> two = charts(1);
  two.pop_back();
  BOOST_CHECK_EXCEPTION(writeReport(sample(), environment(), path / "report", two),
                        std::invalid_argument, [](const std::exception& e) {
                          return contains(e.what(), "charts: expected none or 3, got 2");
                        });
  BOOST_TEST(!fs::exists(path / "report"));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(page)

BOOST_AUTO_TEST_CASE(the_ledger_is_on_the_page_of_its_scene) {
  const std::string page = allPages(sample());
  BOOST_TEST(contains(page, "3 of 10 inertial parameters matter after regrouping"));
  BOOST_TEST(contains(page, "c: 1 of 1 are always zero"));
  BOOST_TEST(contains(page, "M does not depend on q: <code>c_1</code>"));
  BOOST_TEST(contains(page, "119 by a sweep for any mechanism, a program of the scene"));
}

BOOST_FIXTURE_TEST_CASE(strings_are_escaped_and_there_is_no_script, TemporaryFolder) {
  writeReport(sample(), environment(), path / "report");
  const std::string page = allPages(path / "report");
  BOOST_TEST(!contains(page, "<script"));
  BOOST_TEST(!contains(page, "a<b>"));
  BOOST_TEST(contains(page, "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39; \xC3\xA9\xE2\x86\x92"));
  BOOST_TEST(
      !contains(page, "http://www.w3.org/1998/Math/MathML&quot;"));  // formulas go in as they are
  BOOST_TEST(!contains(page, "src=\"http"));
  BOOST_TEST(!contains(page, "href=\"http"));
}

BOOST_FIXTURE_TEST_CASE(verdict_comes_first_and_who_stands_alone_next, TemporaryFolder) {
  const CrosscheckResult result = sample();
  writeReport(result, environment(), path / "report");
  const std::string page = read(path / "report/index.html");
  const std::string headline = escapeMarkup(result.headline());
  BOOST_TEST(contains(page, "<title>✗ " + headline));
  const std::size_t verdict = page.find("<h1>"), finding = page.find("class=\"finding\""),
                    scenes = page.find("id=\"scenes\"");
  BOOST_REQUIRE(verdict != std::string::npos);
  BOOST_TEST(verdict < page.find("simbody stands alone", verdict));
  BOOST_TEST(verdict < finding);
  BOOST_TEST(finding < scenes);
  BOOST_TEST(contains(page, "not a number"));
  BOOST_TEST(contains(page, "1.5e+05 × limit"));
}

BOOST_FIXTURE_TEST_CASE(two_scenes_of_one_name_get_two_pages, TemporaryFolder) {
  writeReport(sample(), environment(), path / "report");
  const std::string page = read(path / "report/index.html");
  for (const std::string name : {"pendulum", "pendulum_2", "___up____down_"}) {
    const std::string own = "scenes/" + name + "/index.html";
    BOOST_TEST(contains(page, "href=\"" + own + "\""), name);
    BOOST_TEST(count(read(path / "report" / own), "id=\"scene-" + name + "\"") == 1u, name);
    BOOST_TEST(contains(read(path / "report" / own), "href=\"../../index.html#scenes\""), name);
  }
  BOOST_TEST(!contains(page, "id=\"scene-"));
}

BOOST_FIXTURE_TEST_CASE(reader_is_told_why_a_plot_is_missing, TemporaryFolder) {
  const std::string search_path = std::getenv("PATH");
  setenv("PATH", path.c_str(), 1);  // no gnuplot here
  BOOST_TEST(gnuplotVersion() == "not found");
  writeReport(sample(), environment(), path / "report");
  setenv("PATH", search_path.c_str(), 1);
  const std::string page = allPages(path / "report");
  BOOST_TEST(contains(page, "The plot was left out: gnuplot was not found"));
  BOOST_TEST(!contains(page, "<img"));
  BOOST_TEST(fs::exists(path / "report/scenes/pendulum/drift.csv"));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(for_programs)

BOOST_AUTO_TEST_CASE(json_has_the_fields_that_apply) {
  const auto json = nlohmann::json::parse(reportJson(sample(), environment()));
  BOOST_TEST(json.at("dynwitness") == "0.1.0");
  BOOST_TEST(json.at("verdict") == "disagree");
  BOOST_TEST(json.at("seed") == 18446744073709551615u);
  BOOST_TEST(json.at("witnesses").at(2).at("present") == false);
  BOOST_TEST(!json.at("witnesses").at(2).contains("version"));
  const auto& scene = json.at("scenes").at(1);
  BOOST_TEST(scene.at("title") == kAwkward);
  BOOST_TEST(scene.at("findings").at(0).at("witness") == "simbody");
  BOOST_TEST(scene.at("drift").at("paths").size() == 3u);
  const auto& agree = json.at("scenes").at(0).at("checks").at(0);
  for (const char* field :
       {"check", "statement", "quantity", "left", "right", "states", "unit", "worst", "limit",
        "ratio", "worst_state", "worst_entry", "seed", "verdict"})
    BOOST_TEST(agree.contains(field), field);
  BOOST_TEST(!agree.contains("reason"));
  BOOST_TEST(!json.at("scenes").at(0).at("checks").back().contains("right"));  // an identity
  BOOST_TEST(scene.at("checks").at(2).at("worst") == "nan");
  const auto& unanswered = scene.at("checks").at(3);
  BOOST_TEST(unanswered.at("verdict") == "not answerable");
  BOOST_TEST(unanswered.at("reason") == "no table: " + kAwkward);
  BOOST_TEST(!unanswered.contains("worst"));
  BOOST_TEST(!json.at("scenes").at(2).contains("drift"));
}

BOOST_AUTO_TEST_CASE(digits_and_known_losses_are_in_every_form) {
  const auto report = nlohmann::json::parse(reportJson(sample(), environment()));
  const auto& scene = report["scenes"][1];
  BOOST_TEST(scene["digits"][0]["worst"] == 7.3);
  BOOST_TEST(scene["digits"][0]["median"] == 15.2);
  BOOST_TEST(!scene["digits"][1].contains("worst"));  // none were counted
  BOOST_TEST(scene["findings"][0]["kind"] == "disagreement");
  BOOST_TEST(scene["findings"][1]["kind"] == "known loss");
  const std::string table = digitsTable(sample(), environment());
  BOOST_TEST(contains(table, "| ../up & <down> | 7.3 (15.2) | – |"), table);
  const std::string page = allPages(sample());
  BOOST_TEST(contains(page, "Digits lost, and why"));
  BOOST_TEST(contains(page, "<td class=\"n\">7.3<span class=\"sub\">15.2</span></td>"));
}

BOOST_AUTO_TEST_CASE(a_limit_with_a_known_loss_is_not_the_headline) {
  CrosscheckResult result;
  result.scenes.push_back(pendulum());
  result.scenes[0].checks[3] = check("c", "lagrange", "mujoco", 63, 64);
  BOOST_TEST(result.worst().second->right == "mujoco");
  result.scenes[0].checks[3].known_loss = true;
  BOOST_TEST(result.worst().second->right != "mujoco");
}

BOOST_AUTO_TEST_CASE(bytes_that_are_no_text_do_not_stop_the_json) {
  CrosscheckResult result = sample();
  result.scenes[0].title = "bad \xFF\xC0\x80 byte\x01";
  const auto json = nlohmann::json::parse(reportJson(result, environment()));
  BOOST_TEST(json.at("scenes").at(0).at("title") ==
             "bad \xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD byte\xEF\xBF\xBD");
}

BOOST_AUTO_TEST_CASE(junit_is_well_formed_and_counts_what_it_holds) {
  const CrosscheckResult result = sample();
  const auto tree = parseXml(reportJUnit(result, environment()));
  const auto& suites = tree.get_child("testsuites");
  BOOST_TEST(suites.get<int>("<xmlattr>.failures") == result.count(Verdict::kDisagree));
  BOOST_TEST(suites.get<int>("<xmlattr>.skipped") == 1);
  int suite_count = 0, cases = 0, failures = 0, skipped = 0;
  std::map<std::string, int> names;
  for (const auto& [tag, suite] : suites) {
    if (tag != "testsuite") continue;
    ++suite_count;
    for (const auto& [inner, test] : suite) {
      if (inner != "testcase") continue;
      ++cases;
      ++names[suite.get<std::string>("<xmlattr>.name") + "/" +
              test.get<std::string>("<xmlattr>.name")];
      if (const auto failure = test.get_child_optional("failure")) {
        ++failures;
        if (!failure->get<std::string>("<xmlattr>.message").empty())
          BOOST_TEST(contains(failure->data(), "state 17 of seed 18446744073709551615"));
      }
      if (const auto skip = test.get_child_optional("skipped")) {
        ++skipped;
        BOOST_TEST(skip->get<std::string>("<xmlattr>.message") == "no table: " + kAwkward);
      }
    }
  }
  BOOST_TEST(suite_count == 4);  // one a scene, and that of the run
  BOOST_TEST(cases == suites.get<int>("<xmlattr>.tests"));
  BOOST_TEST(failures == 2);
  BOOST_TEST(skipped == 1);
  for (const auto& [test_name, n] : names) BOOST_TEST(n == 1, test_name);
}

BOOST_AUTO_TEST_CASE(what_was_not_answered_and_the_control_are_in_every_form) {
  const CrosscheckResult result = sample();
  const auto report = nlohmann::json::parse(reportJson(result, environment()));
  const auto& scene = report["scenes"][1];
  const auto& voided = scene["checks"][4]["voided"];
  BOOST_TEST(voided["states"] == 2);
  BOOST_TEST(voided["excused"] == 1);
  BOOST_TEST(voided["first"] == 3);  // not the excused one before it
  BOOST_TEST(voided["reason"] == "a bound ran away: " + kAwkward);
  BOOST_TEST(!scene["checks"][0].contains("voided"));
  BOOST_TEST(scene["checks"][4]["no_exact"] == "too large: " + kAwkward);
  BOOST_TEST(scene["controls"][0]["size"] == 1e-8);
  BOOST_TEST(scene["controls"][0]["blind"][0] == kAwkward);
  BOOST_TEST(scene["controls"][1]["nothing"] == "is zero: " + kAwkward);
  BOOST_TEST(report["control"] == result.controlLine());
  BOOST_TEST(report["witnesses"][3]["absent"] == "no compiler: " + kAwkward);
  const auto& coverage = report["coverage"];
  const auto c = std::find_if(coverage.begin(), coverage.end(),
                              [](const auto& one) { return one["quantity"] == "c"; });
  BOOST_REQUIRE(c != coverage.end());
  BOOST_TEST((*c)["not_answered"] == 3);  // one was not asked at all
  BOOST_TEST((*c)["excused"] == 2);
  const std::string page = allPages(result);
  for (const char* text :
       {"2 of 100 states not judged, the first 3: a bound ran away", "id=\"coverage\"",
        "found at 1e-08 by pairs, field", "nothing to plant: is zero", "absent: no compiler",
        "a kilogram too heavy by 1e-08"})
    BOOST_TEST(contains(page, text), text);
  const std::string xml = reportJUnit(result, environment());
  BOOST_TEST(
      contains(xml, "<system-out>2 of 100 states not judged, the first 3: a bound ran away"));
  BOOST_TEST(contains(xml, "name=\"control\"><system-out>control: "));
  CrosscheckResult missed = result;
  missed.scenes[1].controls[0].missed = {Road::kTruth};
  BOOST_TEST(contains(reportJUnit(missed, environment()), "name=\"control\"><failure"));
}

BOOST_AUTO_TEST_CASE(names_of_equal_checks_are_made_different) {
  CrosscheckResult result;
  result.scenes.push_back(pendulum());
  result.scenes[0].checks = {result.scenes[0].checks[0], result.scenes[0].checks[0]};
  const std::string xml = reportJUnit(result, environment());
  BOOST_TEST(contains(xml, "lagrange and newton_euler\""));
  BOOST_TEST(contains(xml, "lagrange and newton_euler #2\""));
}

BOOST_AUTO_TEST_CASE(date_follows_source_date_epoch) {
  setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
  BOOST_TEST(thisEnvironment().date == "2023-11-14T22:13:20Z");
  setenv("SOURCE_DATE_EPOCH", "nonsense", 1);
  BOOST_TEST(thisEnvironment().date > "2025");
  unsetenv("SOURCE_DATE_EPOCH");
  const Environment here = thisEnvironment({{"Simbody", "3.7"}});
  BOOST_TEST(here.libraries.back().name == "Simbody");
  for (const auto& library : here.libraries) BOOST_TEST(!library.version.empty(), library.name);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(nothing_half_written)

BOOST_FIXTURE_TEST_CASE(folder_that_cannot_be_written_is_refused_before_any_work, TemporaryFolder) {
  std::ofstream(path / "file") << "mine";
  const auto refused = [](const fs::path& folder) {
    BOOST_CHECK_EXCEPTION(requireWritable(folder), InputError, [&](const InputError& e) {
      BOOST_TEST_MESSAGE(e.what());
      return contains(e.what(), folder.string());
    });
    BOOST_CHECK_THROW(writeReport(sample(), environment(), folder), InputError);
  };
  refused(path / "file");  // a file
  refused(path / "file" / "below");
  refused("/proc/report");  // nobody, not even root, makes folders here
  if (geteuid() != 0) {
    fs::create_directory(path / "locked");
    fs::permissions(path / "locked", fs::perms::owner_read | fs::perms::owner_exec);
    refused(path / "locked" / "report");
    refused(path / "locked");
    fs::permissions(path / "locked", fs::perms::owner_all);
    fs::remove(path / "locked");
  }
  BOOST_CHECK_THROW(requireWritable(""), InputError);
  BOOST_TEST((contents(path) == std::map<std::string, std::string>{{"file", "mine"}}));
}

BOOST_FIXTURE_TEST_CASE(asking_leaves_nothing_behind, TemporaryFolder) {
  requireWritable(path / "a" / "b");
  requireWritable(path);
  BOOST_TEST(fs::is_empty(path));
}

BOOST_FIXTURE_TEST_CASE(full_disk_leaves_no_new_folder, TemporaryFolder) {
  {
    FullDisk disk(20000);  // enough for the pictures, not for the page
    BOOST_CHECK_EXCEPTION(
        writeReport(sample(), environment(), path / "deep" / "report"), std::runtime_error,
        [](const std::runtime_error& e) { return contains(e.what(), "File too large"); });
  }
  BOOST_TEST(fs::is_empty(path));
}

BOOST_FIXTURE_TEST_CASE(full_disk_leaves_the_earlier_report, TemporaryFolder) {
  CrosscheckResult earlier = sample();
  earlier.scenes.pop_back();
  writeReport(earlier, environment(), path / "report");
  const auto before = contents(path);
  {
    FullDisk disk(20000);
    BOOST_CHECK_THROW(writeReport(sample(), environment(), path / "report"), std::runtime_error);
  }
  BOOST_TEST((contents(path) == before));
  {
    FullDisk disk(1000);
    BOOST_CHECK_THROW(writeWholeFile(path / "report/report.json", std::string(5000, 'x')),
                      std::runtime_error);
  }
  BOOST_TEST((contents(path) == before));
}

BOOST_FIXTURE_TEST_CASE(picture_cut_off_by_a_full_disk_is_not_shown, TemporaryFolder) {
  if (!haveGnuplot()) return;
  SceneResult scene = pendulum();
  std::ofstream(path / "drift.csv") << driftCsv(scene);
  std::ofstream(path / "drift_worst.csv") << driftWorstCsv(scene);
  std::ofstream(path / "drift.svg") << "<svg>";
  std::ofstream(path / "empty.gp") << "";
  const auto problem = runGnuplot(path, "empty.gp", {"drift.svg"});
  BOOST_REQUIRE(problem.has_value());
  BOOST_TEST(contains(*problem, "did not finish drift.svg"));
  BOOST_TEST(!fs::exists(path / "drift.svg"));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(files_of_others)

BOOST_FIXTURE_TEST_CASE(they_survive_a_new_report, TemporaryFolder) {
  writeReport(sample(), environment(), path);
  std::ofstream(path / "notes.txt") << "mine";
  std::ofstream(path / "scenes/pendulum/notes.txt") << "mine too";
  CrosscheckResult one = sample();
  one.scenes.resize(1);
  one.scenes[0].name = "other";
  writeReport(one, environment(), path);
  const auto files = contents(path);
  BOOST_TEST(files.at("notes.txt") == "mine");
  BOOST_TEST(files.at("scenes/pendulum/notes.txt") == "mine too");
  BOOST_TEST(files.count("scenes/other/tree.svg") == 1);
  // what was ours and is no longer in the report is gone, and so is its folder
  BOOST_TEST(files.count("scenes/pendulum/tree.svg") == 0);
  BOOST_TEST(!fs::exists(path / "scenes/___up____down_"));
  BOOST_TEST(!contains(files.at("contents.txt"), "pendulum"));
}

BOOST_FIXTURE_TEST_CASE(page_of_somebody_else_is_not_overwritten, TemporaryFolder) {
  std::ofstream(path / "index.html") << "my home page";
  BOOST_CHECK_EXCEPTION(writeReport(sample(), environment(), path), InputError,
                        [](const InputError& e) { return contains(e.what(), "index.html"); });
  BOOST_TEST(
      (contents(path) == std::map<std::string, std::string>{{"index.html", "my home page"}}));
}

BOOST_FIXTURE_TEST_CASE(picture_of_somebody_else_is_not_overwritten, TemporaryFolder) {
  fs::create_directories(path / "scenes/pendulum");
  std::ofstream(path / "scenes/pendulum/tree.svg") << "mine";
  const auto before = contents(path);
  BOOST_CHECK_THROW(writeReport(sample(), environment(), path), InputError);
  BOOST_TEST((contents(path) == before));
}

BOOST_FIXTURE_TEST_CASE(contents_list_cannot_reach_outside_its_folder, TemporaryFolder) {
  std::ofstream(path / "precious.txt") << "mine";
  writeReport(sample(), environment(), path / "report");
  std::ofstream(path / "report/contents.txt", std::ios::app)
      << "../precious.txt\n"
      << (path / "precious.txt").string() << "\n";
  writeReport(sample(), environment(), path / "report");
  BOOST_TEST(read(path / "precious.txt") == "mine");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(pieces)

BOOST_AUTO_TEST_CASE(numbers_are_short) {
  const std::pair<double, const char*> cases[] = {
      {0, "0"},
      {7.44, "7.4"},
      {9.96, "10"},
      {0.314, "0.31"},
      {0.0271, "0.027"},
      {0.999, "1.0"},
      {123.4, "123"},
      {999.6, "1.0e+03"},
      {3100, "3.1e+03"},
      {1e-9, "1.0e-09"},
      {std::numeric_limits<double>::infinity(), "infinite"},
      {std::nan(""), "not a number"}};
  for (const auto& [value, text] : cases) BOOST_TEST(readable(value) == text);
  BOOST_TEST(shareOfLimit(0.42) == "42 %");
  BOOST_TEST(shareOfLimit(0.0004) == "<0.1 %");
  BOOST_TEST(shareOfLimit(1) == "100 %");
  BOOST_TEST(shareOfLimit(1.004) == "1.004 × limit");
  BOOST_TEST(shareOfLimit(1.000001) == "just over the limit");
  BOOST_TEST(shareOfLimit(31) == "31 × limit");
}

BOOST_AUTO_TEST_CASE(tree_pictures_are_well_formed_and_hold_every_link) {
  SceneResult scene = pendulum();
  scene.link_names[1] = kAwkward;
  for (int i = 2; i < 40; ++i) {  // a branching tree of 40
    scene.link_names.push_back("link_" + std::to_string(i));
    scene.joint_labels.push_back("joint_" + std::to_string(i) +
                                 (i % 3 == 0 ? " (fixed)" : " (prismatic)"));
    scene.parents.push_back(i % 7 == 0 ? 1 : i - 1);
  }
  for (const SvgUse use : {SvgUse::kInPage, SvgUse::kFile}) {
    const std::string svg = treeSvg(scene, use);
    parseXml(svg);
    BOOST_TEST(count(svg, "class=\"link") == 40u);
    BOOST_TEST(count(svg, "class=\"joint\"") == 39u);
    BOOST_TEST(contains(svg, "role=\"img\" aria-label=\"Tree of Pendulum: 40 links"));
  }
  scene.link_names.resize(kLargestTree + 1, "x");
  BOOST_TEST(treeSvg(scene, SvgUse::kFile).empty());
  BOOST_TEST(treeSvg({}, SvgUse::kFile).empty());
}

BOOST_AUTO_TEST_CASE(drift_data_name_their_units_and_their_reference) {
  const std::string csv = driftCsv(pendulum());
  BOOST_TEST(csv.rfind("# scene: pendulum\n# method: runge_kutta4, order 4", 0) == 0);
  BOOST_TEST(contains(csv, "\nstep_s,time_s,energy_error_over_scale\n0.01,0,0\n"));
  BOOST_TEST(contains(driftWorstCsv(pendulum()), "\nstep_s,worst_energy_error_over_scale\n0.01,"));
}

// a path without a point (a step that was given up) takes no record
BOOST_AUTO_TEST_CASE(curves_of_the_drift_are_the_records_of_their_step) {
  SceneResult scene = pendulum();
  scene.drift->paths[1].time.clear();
  const std::string script = driftScript(scene);
  const auto words = [&](const std::string& name) {
    const std::size_t start = script.find(name + " = '") + name.size() + 4;
    std::istringstream list(script.substr(start, script.find('\'', start) - start));
    return std::vector<std::string>(std::istream_iterator<std::string>(list), {});
  };
  std::vector<std::string> records;  // as gnuplot counts them
  std::istringstream csv(driftCsv(scene));
  for (std::string line; std::getline(csv, line);)
    if (line[0] != '#') records.push_back(line.substr(0, line.find(',')));
  const auto steps = words("steps"), firsts = words("firsts"), lasts = words("lasts");
  BOOST_TEST_REQUIRE(steps.size() == 3u);
  for (const std::size_t k : {0, 2}) {
    const std::size_t first = std::stoul(firsts.at(k)), last = std::stoul(lasts.at(k));
    BOOST_TEST(last - first == 100u);
    for (std::size_t i = first; i <= last; ++i) BOOST_TEST(records.at(i) == steps[k]);
  }
  BOOST_TEST(lasts.at(1) == firsts.at(1));  // gnuplot takes no empty range
}

BOOST_AUTO_TEST_CASE(drift_without_errors_has_no_chart) {
  SceneResult scene = pendulum();
  for (auto& path : scene.drift->paths) path.worst = 0;
  BOOST_TEST(driftScript(scene).empty());
  scene.drift->paths.clear();
  BOOST_TEST(driftScript(scene).empty());
}

BOOST_AUTO_TEST_SUITE_END()
