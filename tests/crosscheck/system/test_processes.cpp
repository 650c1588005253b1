// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/system/processes.hpp"

#include <csignal>
#include <limits>
#include <set>

#include <boost/test/unit_test.hpp>

#include <unistd.h>

#include "crosscheck/conductor/archive.hpp"
#include "crosscheck/conductor/campaign.hpp"
#include "crosscheck/conductor/crosscheck.hpp"
#include "crosscheck/report/json.hpp"
#include "crosscheck/report/ledger_report.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/error.hpp"
#include "scene/scene.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;

BOOST_AUTO_TEST_SUITE(tasks)

BOOST_AUTO_TEST_CASE(answers_come_by_index_from_several_processes) {
  std::set<int> done;
  const std::vector<std::string> answers = inProcesses(
      3, 40,
      [](int i) {
        usleep(1000);
        // longer than a pipe holds, so that an answer comes in pieces
        return std::to_string(getpid()) + ":" + std::string(i * 5000, 'a' + i % 26);
      },
      [&](int i) { BOOST_TEST(done.insert(i).second); });
  BOOST_TEST(done.size() == 40u);
  BOOST_TEST_REQUIRE(answers.size() == 40u);
  std::set<std::string> workers;
  for (int i = 0; i < 40; ++i) {
    const std::size_t colon = answers[i].find(':');
    workers.insert(answers[i].substr(0, colon));
    BOOST_TEST(answers[i].substr(colon + 1) == std::string(i * 5000, 'a' + i % 26));
  }
  BOOST_TEST(workers.count(std::to_string(getpid())) == 0u);
  BOOST_TEST(workers.size() == 3u);
}

BOOST_AUTO_TEST_CASE(one_process_is_this_one) {
  int calls = 0;
  BOOST_TEST(inProcesses(1, 3, [&](int) { return std::to_string(++calls); }).back() == "3");
  BOOST_TEST(calls == 3);
}

BOOST_AUTO_TEST_CASE(bad_input_stays_bad_input) {
  const auto work = [](int i) -> std::string {
    if (i == 2) throw scene::InputError({"arm.toml", 7}, "mass is -1");
    return "";
  };
  BOOST_CHECK_EXCEPTION(inProcesses(2, 5, work), scene::InputError, [](const auto& error) {
    return std::string(error.what()) == "arm.toml:7: mass is -1";
  });
}

BOOST_AUTO_TEST_CASE(a_process_that_dies_is_a_failure_that_names_its_task) {
  const auto work = [](int i) -> std::string {
    if (i == 3) raise(SIGKILL);
    return "";
  };
  BOOST_CHECK_EXCEPTION(inProcesses(2, 5, work), std::runtime_error, [](const auto& error) {
    return std::string(error.what()) == "task 4 of 5 ended its process: Killed";
  });
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(archive)

// every member differs from its default, so a member that the archive forgets shows in the report
BOOST_AUTO_TEST_CASE(a_result_comes_back_whole) {
  CheckResult check;
  check.kind = CheckKind::kSame;
  check.statement = "M by a = M by b";
  check.quantity = "M";
  check.left = "a";
  check.right = "b";
  check.unit = Unit::kPrintedDigit;
  check.states = 7;
  check.worst = std::numeric_limits<double>::infinity();
  check.limit = 0.1;
  check.ratio = 1.0 / 3.0;
  check.worst_state = 3;
  check.worst_entry = "M[1,2]";
  check.seed = std::numeric_limits<std::uint64_t>::max();
  check.verdict = Verdict::kDisagree;
  check.reason = "they differ";
  check.exact = CheckResult::Exact{(1ull << 63) - 25, 2, 1, 17, 1e-33, true, "random"};
  check.digits = 15.5;
  check.is_idle = true;
  check.known_loss = true;
  SceneResult scene;
  scene.name = "n";
  scene.title = "t";
  scene.source = "s";
  scene.file = "f";
  scene.dof = 2;
  scene.links = 3;
  scene.link_names = {"base", "link"};
  scene.joint_labels = {"", "joint (revolute)"};
  scene.parents = {-1, 0};
  scene.not_modelled = {"friction"};
  scene.equations = {"short", "T", "V", {"M", "c"}};
  Ledger ledger;
  ledger.parameters = 20;
  ledger.base_parameters = 5;
  ledger.zeros = {{"g", 2, 1, {{"no gravity", {"g_1"}}}, "not looked for"}};
  ledger.disputes = {"a fault"};
  scene.ledger = ledger;
  scene.checks = {check, CheckResult()};
  scene.digits = {{"a", "M", Scalar::kFloat, 5, 6.5, 7.5, 4.5, 2, "M[2,2]"}, {}};
  scene.findings = {{Finding::Kind::kKnownLoss, "n", "M", "a", "a loses digits", 7.3}};
  scene.drift = Drift{"runge_kutta4", 4, 10, 2.5, 3.9, {{0.01, 1e-9, {0, 0.01}, {0, 1e-9}, 0, {}}}};

  const auto shown = [](const SceneResult& result) {
    CrosscheckResult all;
    all.scenes = {result};
    return reportJson(all, {});
  };
  const SceneResult back = sceneResultOf(archived(scene));
  BOOST_TEST(shown(back) == shown(scene));
  // what report.json leaves to the page
  BOOST_TEST(back.equations.lines == scene.equations.lines, boost::test_tools::per_element());
  BOOST_TEST(back.equations.kinetic == "T");
  BOOST_TEST(back.equations.potential == "V");
  BOOST_TEST(back.equations.summary == "short");
  BOOST_TEST(ledgerJson(*back.ledger) == ledgerJson(ledger));
  BOOST_TEST(back.parents == scene.parents, boost::test_tools::per_element());
  BOOST_TEST(back.link_names == scene.link_names, boost::test_tools::per_element());
  BOOST_TEST(back.joint_labels == scene.joint_labels, boost::test_tools::per_element());
  BOOST_TEST(back.checks[0].worst == scene.checks[0].worst);
  BOOST_TEST(back.checks[0].ratio == scene.checks[0].ratio);
  BOOST_TEST(back.checks[0].seed == scene.checks[0].seed);
  BOOST_TEST(back.checks[0].known_loss);
  BOOST_TEST(back.checks[0].is_idle);
  BOOST_TEST(!back.checks[1].exact.has_value());
  BOOST_TEST(back.drift->paths[0].time == scene.drift->paths[0].time,
             boost::test_tools::per_element());
  BOOST_TEST(back.drift->paths[0].error == scene.drift->paths[0].error,
             boost::test_tools::per_element());
}

// a table, known losses, drift, exact checks with twins and without: everything that parts put
// together
BOOST_AUTO_TEST_CASE(a_scene_in_parts_is_the_same_result) {
  Options options;
  options.states = 5;
  options.witnesses = {"lagrange", "newton_euler", "composite_body", "simbody"};
  const std::vector<scene::Scene> scenes = {scene::findScene("modern_robotics_3link")};
  const std::vector<WitnessKind> kinds = selectWitnesses(options.witnesses);
  const std::string whole = archived(crosscheckScene(scenes[0], kinds, options));
  for (const int processes : {1, 2, 3}) {
    std::vector<int> done;
    const std::vector<SceneResult> shared =
        crosscheckScenes(scenes, kinds, options, processes, [&](int i) { done.push_back(i); });
    BOOST_TEST_REQUIRE(shared.size() == 1u);
    BOOST_TEST((archived(shared[0]) == whole), processes << " processes");
    BOOST_TEST(done == std::vector<int>{0}, boost::test_tools::per_element());
  }
}

BOOST_AUTO_TEST_CASE(a_failure_of_a_campaign_comes_back_with_its_scene) {
  RandomCampaign campaign;
  campaign.mechanisms = 5;
  campaign.joints = 11;
  campaign.checks = 125;
  campaign.not_answerable = 2;
  campaign.error_probability = 1e-31;
  CheckResult check;
  check.reason = "differs";
  check.verdict = Verdict::kDisagree;
  campaign.failures.push_back({randomScene(1, 4, 6), {check}, {}});
  const RandomCampaign back = randomCampaignOf(archived(campaign));
  BOOST_TEST(back.mechanisms == 5);
  BOOST_TEST(back.joints == 11);
  BOOST_TEST(back.checks == 125);
  BOOST_TEST(back.not_answerable == 2);
  BOOST_TEST(back.error_probability == 1e-31);
  BOOST_TEST_REQUIRE(back.failures.size() == 1u);
  BOOST_TEST(describeFailure(back.failures[0]) == describeFailure(campaign.failures[0]));
}

BOOST_AUTO_TEST_SUITE_END()
