// SPDX-License-Identifier: GPL-3.0-or-later
// Families of any size, and what dynwitness growth says of them. Times are judged nowhere here.
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include <sys/wait.h>

#include "crosscheck/growth/growth.hpp"
#include "scene/families.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

struct Outcome {
  int status;
  std::string out;
};

Outcome run(const std::string& command) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  BOOST_REQUIRE(pipe != nullptr);
  Outcome outcome{0, ""};
  std::array<char, 4096> buffer;
  for (std::size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    outcome.out.append(buffer.data(), n);
  outcome.status = WEXITSTATUS(pclose(pipe));
  return outcome;
}

GrowthPoint fast(int links, double id, double fd, double build, double bytes, double error) {
  GrowthPoint p{"chain", links, "fast"};
  p.id_ns = id, p.fd_ns = fd, p.scene_ns = 0, p.build_ns = build, p.bytes = bytes,
  p.fd_error = error;
  p.peak_bytes = 2 * bytes;
  return p;
}

const GrowthGoal& goalOf(const std::vector<GrowthGoal>& goals, const std::string& start) {
  for (const GrowthGoal& goal : goals)
    if (goal.goal.compare(0, start.size(), start) == 0) return goal;
  BOOST_REQUIRE_MESSAGE(false, "no goal starts with " << start);
  return goals.front();
}

}  // namespace

// Families are validated by their first links alone; the reader's whole validation finds no more.
BOOST_DATA_TEST_CASE(every_link_of_a_family_passes_the_validation_of_files,
                     data::make({"chain_1", "chain_2", "chain_300", "tree_2", "tree_300"}), name) {
  scene::Scene scene;
  BOOST_REQUIRE(scene::findFamily(name, &scene));
  BOOST_CHECK_NO_THROW(scene::validate(scene));
  scene.mechanism.links.back().inertia.mass = scene::Number(-1);  // it does look at the last
  BOOST_CHECK_THROW(scene::validate(scene), scene::InputError);
}

BOOST_AUTO_TEST_CASE(a_tree_is_balanced_and_a_chain_is_a_row) {
  scene::Scene chain, tree;
  BOOST_REQUIRE((scene::findFamily("chain_31", &chain) && scene::findFamily("tree_31", &tree)));
  std::vector<int> depth = {0}, children(32, 0);
  for (std::size_t i = 1; i <= 31; ++i) {
    BOOST_TEST(chain.mechanism.links[i].parent == static_cast<int>(i) - 1);
    depth.push_back(depth[tree.mechanism.links[i].parent] + 1);
    ++children[tree.mechanism.links[i].parent];
  }
  BOOST_TEST(depth.back() == 5);  // 1 + 2 + 4 + 8 + 16 links
  for (std::size_t i = 1; i <= 15; ++i) BOOST_TEST(children[i] == 2);
}

BOOST_AUTO_TEST_CASE(goals_are_ratios_to_64_links_before_and_after_the_cache_is_left) {
  // 1000 + 40 bytes a link: a cache of 1 MB takes 1008 links
  const std::vector<GrowthPoint> points = {
      fast(1, 900, 900, 9e9, 9000, 0), fast(64, 20, 50, 4000, 1400, 1e-16),
      fast(256, 22, 60, 5000, 1000, 2e-15), fast(4096, 50, 160, 6000, 1000, 5e-15),
      fast(16384, 40, 40, 16000, 1000, kNothing)};
  BOOST_TEST(linksInCache(points, "chain", 1 << 20) == 1008);
  const std::vector<GrowthGoal> goals = growthGoals(points, 1 << 20);
  const auto holds = [&](const char* start, double measured, int links, bool is_reached) {
    const GrowthGoal& goal = goalOf(goals, start);
    BOOST_TEST_CONTEXT(start) {
      BOOST_TEST(goal.measured == measured);
      BOOST_TEST(goal.links == links);
      BOOST_TEST(goal.isReached() == is_reached);
    }
  };
  holds("ID a link, within", 1.1, 256, true);
  holds("ID a link, beyond", 2.5, 4096, true);
  holds("FD a link, within", 1.2, 256, true);
  holds("FD a link, beyond", 3.2, 4096, false);
  holds("scene and model", 4, 16384, false);
  holds("kept", 1400, 64, true);
  holds("certified digits", -std::log10(5e-15), 4096, true);
  BOOST_TEST(!goalOf(goals, "the whole process").isMeasured());  // there are no 10^6 links
}

BOOST_AUTO_TEST_CASE(what_is_missing_is_not_called_reached) {
  std::vector<GrowthPoint> points = {fast(64, 20, 50, 4000, 1600, 2e-14),
                                     fast(256, kNothing, 50, 4000, 1000, 3e-14)};
  for (const GrowthGoal& goal : growthGoals(points, 0)) {  // no cache is known
    const bool is_time = goal.goal.compare(1, 1, "D") == 0;
    if (is_time) BOOST_TEST(!goal.isMeasured(), goal.goal);
  }
  const std::vector<GrowthGoal> goals = growthGoals(points, 1 << 20);
  BOOST_TEST(!goalOf(goals, "ID a link, within").isMeasured());  // one of its points is missing
  BOOST_TEST(goalOf(goals, "FD a link, within").isReached());
  BOOST_TEST(!goalOf(goals, "kept").isReached());
  BOOST_TEST(!goalOf(goals, "certified digits").isReached());
  const GrowthPoint unbuilt = fast(64, 20, 50, kNothing, 1000, 0),
                    large = fast(16384, 20, 50, 4000, 1000, 0);
  BOOST_TEST(!goalOf(growthGoals({unbuilt, large}, 1 << 20), "scene and model").isMeasured());
  BOOST_TEST(growthGoals({}, 1 << 20).empty());
}

// 10^5 links with a stack of 512 kB, where one call a link would need some 5 MB, and with 4 GB in
// all, of which M alone would take 80: whatever is passed from the scene's name to qdd goes link by
// link in loops.
BOOST_DATA_TEST_CASE(many_links_need_neither_a_deep_stack_nor_M, data::make({"chain", "tree"}),
                     family) {
  const Outcome outcome =
      run("ulimit -s 512; ulimit -v 4000000; " DYNWITNESS_PROGRAM " growth --family " +
          std::string(family) + " --links 100000 --truth 64 --witness simbody --patience 1");
  BOOST_TEST_CONTEXT(outcome.out) {
    BOOST_TEST(outcome.status == 0);
    for (const char* method : {"fast", "textbook"}) {
      const std::string start = "\n" + std::string(family) + ",100000," + method + ",";
      const std::size_t row = outcome.out.find(start);
      BOOST_REQUIRE(row != std::string::npos);
      BOOST_TEST(std::isdigit(static_cast<unsigned char>(outcome.out[row + start.size()])));
      BOOST_TEST(outcome.out.find(std::string("# ") + method + " at") == std::string::npos);
    }
  }
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused_with_status_2) {
  const auto refuses = [](const std::string& words, const std::string& part) {
    const Outcome outcome = run(DYNWITNESS_PROGRAM " growth " + words);
    BOOST_TEST_CONTEXT(words << "\n" << outcome.out) {
      BOOST_TEST(outcome.status == 2);
      BOOST_TEST(outcome.out.find(part) != std::string::npos);
    }
  };
  refuses("--links 0", "--links");
  refuses("--links 1000001", "--links");
  refuses("--family ring", "chain");
  refuses("--witness simbdy", "simbody");
  refuses("--patience 0", "--patience");
  refuses("--links 4 --json /nowhere/growth.json", "/nowhere");
}
