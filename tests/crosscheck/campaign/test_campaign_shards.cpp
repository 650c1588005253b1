// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include <malloc.h>
#include <unistd.h>

#include <boost/test/unit_test.hpp>
#include <nlohmann/json.hpp>

#include "crosscheck/campaign/campaign_plan.hpp"
#include "crosscheck/campaign/merge.hpp"
#include "crosscheck/campaign/shard.hpp"
#include "crosscheck/exact/exact.hpp"
#include "crosscheck/inputs/feature_pairs.hpp"
#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "scene/error.hpp"
#include "tests/fixtures/files.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
namespace fs = std::filesystem;

namespace {

std::string textOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}
void write(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

CampaignPlan planOf(const fs::path& folder, const std::string& text) {
  write(folder / "plan.toml", text);
  return readCampaignPlan(folder / "plan.toml");
}

constexpr const char* kSmall =
    "title = \"small\"\n[[cases]]\nof = \"mechanisms\"\ncount = 23\nmost_joints = 2\n";

CaseRunner runnerOf(const CampaignPlan& plan) {
  return CaseRunner(plan, "/bin/true", {newtonEulerKind(), compositeBodyKind()});
}

ShardDone run(const CampaignPlan& plan, const fs::path& folder, int shard, int shards,
              int processes = 1) {
  return runShard(runnerOf(plan), {shard, shards, folder, processes});
}

/// What merging these folders writes, one file after the other.
std::string merged(const std::vector<fs::path>& folders, const fs::path& into) {
  writeMerged(gatherLedgers(folders), into);
  return textOf(into / "cases.jsonl") + textOf(into / "campaign.json");
}

void refuses(const fs::path& folder, const std::string& text, const std::string& why) {
  try {
    planOf(folder, text);
    BOOST_ERROR("is read: " << text);
  } catch (const scene::InputError& refusal) {
    const std::string said = refusal.what();
    BOOST_TEST(said.find("plan.toml") != std::string::npos, said);
    BOOST_TEST(said.find(why) != std::string::npos, said);
  }
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_plan_is_read_or_refused_by_line) {
  const files::TemporaryFolder folder;
  const CampaignPlan plan =
      planOf(folder.path,
             "title = \"all\"\nseed = 7\n[[cases]]\nof = \"mechanisms\"\ncount = 5\ndraws = 3\n"
             "[[cases]]\nof = \"scenes\"\nscenes = [\"acrobot\", \"puma_560\"]\ncount = 4\n"
             "[[cases]]\nof = \"commands\"\ncommands = [\"version\"]\n");
  BOOST_TEST(plan.cases() == 10);
  BOOST_TEST(caseOf(plan, 5).index == 0);
  BOOST_TEST((caseOf(plan, 9).part->of == CampaignPart::Of::kCommands));
  BOOST_CHECK_THROW(caseOf(plan, 10), std::out_of_range);
  // the text tells apart what is another campaign
  BOOST_TEST(planOf(folder.path, kSmall).text !=
             planOf(folder.path, std::string("seed = 2\n") + kSmall).text);
  const std::string head = "title = \"x\"\n";
  refuses(folder.path, head, "no [[cases]]");
  refuses(folder.path, "[[cases]]\nof = \"mechanisms\"\ncount = 1\n", "title");
  refuses(folder.path, head + "[[cases]]\nof = \"robots\"\n", ":3: of: read 'robots'");
  refuses(folder.path, head + "[[cases]]\nof = \"mechanisms\"\ncount = 0\n", "count: read 0");
  refuses(folder.path, head + "[[cases]]\nof = \"mechanisms\"\n", "count");
  refuses(folder.path, head + "[[cases]]\nof = \"mechanisms\"\ncount = 3000000000\n", "up to");
  refuses(folder.path, head + "[[cases]]\nof = \"commands\"\ncommands = []\n", "commands");
  refuses(folder.path, head + "speed = 3\n[[cases]]\nof = \"mechanisms\"\ncount = 1\n", "speed");
}

BOOST_AUTO_TEST_CASE(a_sealed_line_opens_and_a_changed_one_does_not) {
  std::string line = sealedLine("{\"case\":3,\"text\":\"a,\\\"besides\\\":b\"}", "{\"seconds\":1}");
  BOOST_TEST_REQUIRE(line.back() == '\n');
  line.pop_back();
  SealedLine parts;
  BOOST_TEST_REQUIRE(opened(line, &parts));
  BOOST_TEST(parts.record == "{\"case\":3,\"text\":\"a,\\\"besides\\\":b\"}");
  BOOST_TEST(parts.besides == "{\"seconds\":1}");
  for (std::size_t k = 0; k < line.size(); ++k) {
    std::string changed = line;
    changed[k] ^= 1;
    BOOST_TEST(!opened(changed, &parts), "a bit of character " << k);
    BOOST_TEST(!opened(std::string_view(line).substr(0, k), &parts), "cut after " << k);
  }
}

BOOST_AUTO_TEST_CASE(shards_in_any_number_and_order_come_to_the_same_bytes) {
  const files::TemporaryFolder folder;
  const fs::path& at = folder.path;
  const CampaignPlan plan = planOf(at, kSmall);
  BOOST_TEST(run(plan, at / "one", 1, 1).now == 23);
  const std::string one = merged({at / "one"}, at / "result");
  for (const int shard : {3, 1, 2}) run(plan, at / "three", shard, 3, 2);
  BOOST_TEST(merged({at / "three"}, at / "result") == one);
  for (const int shard : {1, 2, 3, 4}) run(plan, at / ("four" + std::to_string(shard)), shard, 4);
  BOOST_TEST(merged({at / "four2", at / "four4", at / "four1", at / "four3"}, at / "result") ==
             one);
  // some of it twice
  BOOST_TEST(merged({at / "four2", at / "one", at / "three"}, at / "result") == one);
  const GatheredLedgers both = gatherLedgers({at / "one", at / "three"});
  BOOST_TEST(both.twice == 23);
  BOOST_TEST(both.missing_cases == 0);
}

BOOST_AUTO_TEST_CASE(what_is_done_is_not_done_again_and_what_is_missing_is_named) {
  const files::TemporaryFolder folder;
  const fs::path& at = folder.path;
  const CampaignPlan plan = planOf(at, kSmall);
  run(plan, at / "some", 2, 3);
  const GatheredLedgers some = gatherLedgers({at / "some"});
  BOOST_TEST(some.entries.size() == 8u);
  BOOST_TEST(some.missing_cases == 15);
  BOOST_TEST(some.missing.front() == "0");
  BOOST_TEST(some.missing.back() == "20-21");
  const CampaignSum sum = writeMerged(some, at / "result");
  BOOST_TEST(nlohmann::json::parse(textOf(at / "result/campaign.json")).at("verdict") ==
             "incomplete");
  const std::string said = describeSum(some, sum);
  BOOST_TEST(said.find("15 cases are missing: 0, 2-3,") != std::string::npos, said);
  const ShardDone rest = run(plan, at / "some", 1, 1);
  BOOST_TEST(rest.before == 8);
  BOOST_TEST(rest.now == 15);
  BOOST_TEST(run(plan, at / "some", 1, 1).now == 0);
}

BOOST_AUTO_TEST_CASE(damage_is_named_and_left_out_and_done_again) {
  const files::TemporaryFolder folder;
  const fs::path& at = folder.path;
  const CampaignPlan plan = planOf(at, kSmall);
  run(plan, at / "whole", 1, 1);
  const std::string whole = merged({at / "whole"}, at / "result");
  const std::string ledger = textOf(at / "whole/shard-1-of-1.jsonl");
  fs::create_directories(at / "hurt");
  const fs::path file = at / "hurt/shard-1-of-1.jsonl";
  // a digit of the fifth line, and the end of the last
  std::string hurt = ledger.substr(0, ledger.size() - 30);
  std::size_t fifth = 0;
  for (int line = 1; line < 5; ++line) fifth = hurt.find('\n', fifth) + 1;
  hurt[fifth + 60] ^= 1;
  write(file, hurt);
  const GatheredLedgers gathered = gatherLedgers({at / "hurt"});
  BOOST_TEST(gathered.missing_cases == 2);
  BOOST_TEST_REQUIRE(gathered.left_out.size() == 2u);
  BOOST_TEST(gathered.left_out[0].find(":5: the line is damaged") != std::string::npos);
  BOOST_TEST(gathered.left_out[1].find("has no end") != std::string::npos);
  BOOST_TEST(run(plan, at / "hurt", 1, 1).now == 2);
  BOOST_TEST(merged({at / "hurt"}, at / "result") == whole);
  // the damaged lines are still there, and still named
  BOOST_TEST(gatherLedgers({at / "hurt"}).left_out.size() == 2u);
  // nobody knows what lines without a head belong to
  write(file, ledger.substr(ledger.find('\n') + 1));
  BOOST_CHECK_THROW(gatherLedgers({at / "hurt"}), scene::InputError);
}

BOOST_AUTO_TEST_CASE(other_campaigns_and_versions_are_never_mixed) {
  const files::TemporaryFolder folder;
  const fs::path& at = folder.path;
  const CampaignPlan plan = planOf(at, kSmall);
  run(plan, at / "mine", 1, 2);
  const CampaignPlan other = planOf(at, std::string("seed = 2\n") + kSmall);
  BOOST_CHECK_THROW(run(other, at / "mine", 1, 2), scene::InputError);
  BOOST_CHECK_THROW(run(other, at / "mine", 2, 2), scene::InputError);
  run(other, at / "other", 1, 2);
  BOOST_CHECK_THROW(gatherLedgers({at / "mine", at / "other"}), scene::InputError);
  LedgerHead head{"0.0.1", plan.text, plan.cases(), 2, 2};
  fs::create_directories(at / "old");
  write(at / "old/shard-2-of-2.jsonl",
        sealedLine(head.text(), "{}") +
            sealedLine("{\"case\":1,\"of\":\"mechanisms\",\"verdict\":\"agree\"}",
                       "{\"seconds\":1}"));
  const GatheredLedgers gathered = gatherLedgers({at / "mine", at / "old"});
  BOOST_TEST(gathered.missing_cases == 11);
  BOOST_TEST_REQUIRE(gathered.left_out.size() == 1u);
  BOOST_TEST(gathered.left_out[0].find("by version 0.0.1") != std::string::npos);
  // two answers to one question
  head.version = campaignVersion();
  write(at / "old/shard-2-of-2.jsonl",
        sealedLine(head.text(), "{}") +
            sealedLine("{\"case\":0,\"of\":\"mechanisms\",\"verdict\":\"agree\"}",
                       "{\"seconds\":1}"));
  BOOST_CHECK_THROW(gatherLedgers({at / "mine", at / "old"}), scene::InputError);
}

BOOST_AUTO_TEST_CASE(a_shard_is_done_by_one_process_at_a_time) {
  const files::TemporaryFolder folder;
  const CampaignPlan plan = planOf(folder.path, kSmall);
  const LedgerHead head{campaignVersion(), plan.text, plan.cases(), 1, 2};
  const GrowingLedger held(folder.path / "x", head);
  try {
    run(plan, folder.path / "x", 1, 2);
    BOOST_ERROR("two processes add to one file");
  } catch (const scene::InputError& refusal) {
    BOOST_TEST(std::string(refusal.what()).find("another process") != std::string::npos);
  }
  BOOST_TEST(run(plan, folder.path / "x", 2, 2).now == 11);
}

BOOST_AUTO_TEST_CASE(what_crashes_or_hangs_costs_its_own_case_alone) {
  const files::TemporaryFolder folder;
  CampaignPlan plan = planOf(folder.path, kSmall);
  plan.seconds = 1;
  // a witness that ends its process on some mechanisms
  WitnessKind crashes = compositeBodyKind();
  crashes.make_exact = [](const PreparedScene& scene, Parameters) -> OrRefusal<ExactWitness> {
    if (scene.scene().name == "random_1_4") ::kill(::getpid(), SIGKILL);
    if (scene.scene().name == "random_1_9") std::this_thread::sleep_for(std::chrono::hours(1));
    return compositeBodyKind().make_exact(scene, Parameters::kAsWritten);
  };
  const CaseRunner runner(plan, "/bin/true", {newtonEulerKind(), crashes});
  const ShardDone done = runShard(runner, {1, 1, folder.path / "x", 2});
  BOOST_TEST(done.now == 23);
  BOOST_TEST(done.wrong == 2);
  const GatheredLedgers gathered = gatherLedgers({folder.path / "x"});
  const CampaignSum sum = writeMerged(gathered, folder.path / "result");
  BOOST_TEST(sum.verdicts.at("failed") == 2);
  BOOST_TEST(sum.mechanisms == 21);
  BOOST_TEST(!sum.isRight());
}

BOOST_AUTO_TEST_CASE(the_sum_counts_what_the_mechanisms_are) {
  const files::TemporaryFolder folder;
  const CampaignPlan plan = planOf(folder.path, kSmall);
  run(plan, folder.path / "x", 1, 1);
  const CampaignSum sum = writeMerged(gatherLedgers({folder.path / "x"}), folder.path / "result");
  PairTable pairs;
  std::map<std::string, long> kinds, with;
  long closed = 0;
  for (unsigned k = 0; k < 23; ++k) {
    const scene::Scene scene = randomWholeScene(1, k, 2);
    const auto& links = scene.mechanism.links;
    with["no gravity"] += scene.mechanism.has_gravity ? 0 : 1;
    closed += scene.mechanism.closures.empty() ? 0 : 1;
    with["spring"] += std::any_of(links.begin(), links.end(), [](const scene::Link& link) {
      return !link.joint.stiffness.isLiteralZero();
    });
    pairs.add(scene);
    for (std::size_t i = 1; i < scene.mechanism.links.size(); ++i)
      ++kinds[scene::name(scene.mechanism.links[i].joint.kind)];
  }
  BOOST_TEST((sum.coverage.kinds == kinds));
  for (const auto& [term, count] : with) {
    BOOST_TEST(count > 0, term);
    BOOST_TEST(sum.coverage.terms.at(term) == count, term);
  }
  // each check that there is, and those of closures where there are some
  BOOST_TEST(sum.coverage.laws.size() == exactCheckNames().size());
  const std::array<long, 3> by_closures = sum.coverage.laws.at("closures"),
                            by_all = sum.coverage.laws.at("skew symmetry");
  BOOST_TEST(closed > 0);
  BOOST_TEST(closed < 23);
  BOOST_TEST(by_closures[0] + by_closures[1] + by_closures[2] == closed);
  BOOST_TEST(by_all[0] + by_all[1] + by_all[2] == 23);
  BOOST_TEST(std::pow(1 - shareAtMostOf(7), 7) == 0.05, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(shareAtMostOf(0) == 1);
  for (const PairRelation relation : kAllPairRelations)
    BOOST_TEST(sum.coverage.pairs.covered(relation) == pairs.covered(relation));
  // (1 - p)^23 = 0.05
  BOOST_TEST(std::pow(1 - sum.shareAtMost(), 23) == 0.05, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(sum.mechanisms_that_agree == 23);
}

BOOST_AUTO_TEST_CASE(what_a_campaign_has_found_stays_mended) {
  const files::TemporaryFolder folder;
  const auto verdict = [&](int mechanism) {
    const CampaignPlan plan =
        planOf(folder.path,
               "title = \"one\"\nseed = 19\n[[cases]]\nof = \"mechanisms\"\ncount = 1\nfirst = " +
                   std::to_string(mechanism) + "\n");
    const auto record = nlohmann::json::parse(CaseRunner(plan, {}).line(0)).at("record");
    return record.at("verdict").get<std::string>();
  };
  // a slider on the world beside a floating link that is held
  BOOST_TEST(verdict(2472) == "agree");
  // a degree beyond the field disagrees with nothing
  BOOST_TEST(verdict(1043) == "not answerable");
}

BOOST_AUTO_TEST_CASE(a_case_leaves_no_memory_behind) {
  const files::TemporaryFolder folder;
  const CampaignPlan plan = planOf(folder.path, kSmall);
  // what is held after all cases have run so many times more; that they ran before fills what is
  // kept for good
  constexpr int kTimes = 4;
  const auto growth = [&](const CaseRunner& runner) {
    const auto all = [&](int times) {
      for (int time = 0; time < times; ++time)
        for (long k = 0; k < plan.cases(); ++k) runner.line(k);
      return static_cast<long>(mallinfo2().uordblks);
    };
    const long before = all(2);
    return all(kTimes) - before;
  };
  // up to 80 bytes a case were seen (free blocks that malloc keeps for the thread count as held),
  // and a copy of the process does 20 cases
  const long most = kTimes * plan.cases() * 1000;
  BOOST_TEST(growth(runnerOf(plan)) < most);
  // and one that keeps a string of each is noticed
  std::vector<std::unique_ptr<std::string>> kept;
  WitnessKind keeps = compositeBodyKind();
  keeps.make_exact = [&kept](const PreparedScene& scene, Parameters parameters) {
    kept.push_back(std::make_unique<std::string>(1000, 'x'));
    return compositeBodyKind().make_exact(scene, parameters);
  };
  BOOST_TEST(growth(CaseRunner(plan, "/bin/true", {newtonEulerKind(), keeps})) >= most);
}

BOOST_AUTO_TEST_CASE(draws_prefer_mechanisms_with_rare_pairs) {
  const files::TemporaryFolder folder;
  const auto covered = [&](const std::string& draws) {
    const CampaignPlan plan = planOf(folder.path, kSmall + draws);
    PairTable pairs;
    for (long k = 0; k < plan.cases(); ++k) {
      const auto record = nlohmann::json::parse(runnerOf(plan).line(k)).at("record");
      const auto name = record.at("name").get<std::string>();
      pairs.add(randomWholeScene(1, std::stoul(name.substr(name.rfind('_') + 1)), 2));
    }
    int all = 0;
    for (const PairRelation relation : kAllPairRelations) all += pairs.covered(relation);
    return all;
  };
  const int as_they_come = covered(""), of_eight = covered("draws = 8\n");
  BOOST_TEST(of_eight > as_they_come);
}
