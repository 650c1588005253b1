// SPDX-License-Identifier: GPL-3.0-or-later
// Ladders: a rod that swings from rest has closed forms of what its point mass misses, and is that
// point's pendulum in slower time; what a scene has not is no rung.
#include "crosscheck/reduction/ladder.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <boost/test/unit_test.hpp>

#include "crosscheck/motion/simulate.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

const auto kSilent = [](const std::string&) {};

/// A rod of mass m and length l on a hinge, let go level: I about the hinge is m l^2 / 3, of which
/// its point mass has m l^2 / 4.
const char* const kRod = R"(
gravity = [0, 0, -9.81]
[[link]]
name = "base"
[[link]]
name = "rod"
parent = "base"
mass = 2
com = [0.5, 0, 0]
inertia = { about = "com", yy = "1/6", zz = "1/6" }
[link.joint]
kind = "revolute"
axis = [0, 1, 0]
[start]
q = [0]
)";

/// Everything that a ladder has rungs for.
const char* const kAll = R"(
gravity = [0, 0, -9.81]
[[link]]
name = "base"
[[link]]
name = "arm"
parent = "base"
mass = 2
com = [0.5, 0, 0]
inertia = { about = "com", xx = 0.1, yy = 0.2, zz = 0.2 }
[link.joint]
kind = "revolute"
axis = [0, 1, 0]
rotor_inertia = 1e-4
gear_ratio = 30
friction = { viscous = 0.1 }
[[link]]
name = "hand"
parent = "arm"
mass = 1
com = [0.1, 0.2, 0]
inertia = { about = "com", xx = 0.01, yy = 0.02, zz = 0.02, xy = 0.001 }
[link.joint]
kind = "revolute"
axis = [1, 1, 0]
xyz = [1, 0, 0]
rotor_inertia = 1e-5
gear_ratio = 20
gyroscopic = true
[start]
q = [0.3, 0.2]
qd = [1, 2]
)";

Ladder ladderOfText(const char* text, double duration, int outputs) {
  LadderOptions options;
  options.duration = duration;
  options.outputs = outputs;
  return ladderOf(scene::readSceneToml(text, "scene.toml"), options, kSilent);
}

std::vector<std::string> names(const Ladder& ladder) {
  std::vector<std::string> out;
  for (const Rung& rung : ladder.rungs) out.push_back(rung.adds);
  return out;
}

}  // namespace

// M qdd = -g all the time, so the point mass misses (I - m l^2/4) / I = 1/4 of it wherever it is
BOOST_AUTO_TEST_CASE(a_rod_without_its_moment_of_inertia_misses_a_quarter) {
  const Ladder ladder = ladderOfText(kRod, 1, 50);
  BOOST_REQUIRE(ladder.rungs.size() == 2);
  const Rung& point = ladder.rungs.front();
  BOOST_TEST(ladder.largest.at(0) == 2 * 9.81 * 0.5, boost::test_tools::tolerance(1e-15));
  BOOST_TEST(point.full.share == 0.25, boost::test_tools::tolerance(1e-14));
  BOOST_TEST(point.above.share == point.full.share);
  BOOST_TEST(point.full.force == 0.25 * ladder.largest.at(0), boost::test_tools::tolerance(1e-14));
  BOOST_TEST(ladder.rungs.back().full.share == 0);
  BOOST_TEST(ladder.rungs.back().motion.value().follows_s == 1);
}

// from rest, the pendulum's q is a function of t sqrt(m g l / (2 I)): the point's is the rod's at
// t sqrt(4/3)
BOOST_AUTO_TEST_CASE(a_point_mass_is_the_rod_in_faster_time) {
  const scene::Scene rod = scene::readSceneToml(kRod, "scene.toml");
  const Ladder ladder = ladderOfText(kRod, 1, 50);
  const RungMotion motion = ladder.rungs.front().motion.value();
  SimulateOptions run;
  run.duration = 1;
  run.outputs = 50;
  const Simulation slow = simulate(rod, run);
  run.duration = std::sqrt(4.0 / 3);
  const Simulation fast = simulate(rod, run);
  double gap = 0, travel = 0, follows = 0;
  bool still = true;
  for (std::size_t k = 0; k < slow.points.size(); ++k)
    travel = std::max(travel, slow.points[k].q[0]);
  for (std::size_t k = 0; k < slow.points.size(); ++k) {
    const double here = std::abs(slow.points[k].q[0] - fast.points[k].q[0]);
    gap = std::max(gap, here);
    still = still && here <= Ladder::kFollows * travel;
    if (still) follows = slow.points[k].time;
  }
  BOOST_TEST(motion.gap == gap, boost::test_tools::tolerance(1e-7));  // 1e-10 a step, some 40 steps
  BOOST_TEST(motion.follows_s == follows);
  BOOST_TEST(motion.follows_s > 0);
  BOOST_TEST(motion.follows_s < 0.5);
}

BOOST_AUTO_TEST_CASE(each_part_of_a_scene_is_a_rung_and_what_it_has_not_is_none) {
  const std::vector<std::string> all = {
      "point masses", "moments of inertia",        "products of inertia",
      "rotors",       "spin of gyroscopic rotors", "friction"};
  const Ladder ladder = ladderOfText(kAll, 0.2, 20);
  BOOST_TEST(names(ladder) == all, boost::test_tools::per_element());
  BOOST_TEST(ladder.absent.empty());
  for (std::size_t r = 0; r + 1 < ladder.rungs.size(); ++r)
    BOOST_TEST(ladder.rungs[r].above.share > 1e-6, ladder.rungs[r].adds);  // no rounding
  const Ladder rod = ladderOfText(kRod, 0.2, 20);
  BOOST_TEST(names(rod) == (std::vector<std::string>{all[0], all[1]}),
             boost::test_tools::per_element());
  BOOST_TEST(rod.absent == (std::vector<std::string>{all[2], all[3], all[4], all[5]}),
             boost::test_tools::per_element());
}

// a rotor's n^2 J = 0.09 at the first joint and 0.004 at the second is all that its rung adds
BOOST_AUTO_TEST_CASE(what_a_rung_misses_is_the_force_of_what_it_lacks) {
  const scene::Scene scene = scene::readSceneToml(kAll, "scene.toml");
  const Ladder ladder = ladderOfText(kAll, 0.2, 20);
  SimulateOptions run;
  run.duration = 0.2;
  run.outputs = 20;
  const Simulation motion = simulate(scene, run);
  double share = 0;
  for (const Simulation::Point& p : motion.points) {
    share = std::max(share, 0.09 * std::abs(p.qdd[0]) / ladder.largest[0]);
    share = std::max(share, 0.004 * std::abs(p.qdd[1]) / ladder.largest[1]);
  }
  BOOST_TEST(ladder.rungs[2].adds == "products of inertia");
  BOOST_TEST(ladder.rungs[2].above.share == share, boost::test_tools::tolerance(1e-12));
  double friction = 0;
  for (const Simulation::Point& p : motion.points)
    friction = std::max(friction, 0.1 * std::abs(p.qd[0]) / ladder.largest[0]);
  BOOST_TEST(ladder.rungs[3].full.share !=
             ladder.rungs[3].above.share);  // friction is another rung's
  BOOST_TEST(ladder.rungs[4].full.share == friction, boost::test_tools::tolerance(1e-12));
}

// by Steiner's theorem, on paper; the numbers are then another rounding of the same ones
BOOST_AUTO_TEST_CASE(an_inertia_about_the_origin_has_the_same_rungs) {
  std::string text = kAll;
  const std::string about_com =
      "inertia = { about = \"com\", xx = 0.01, yy = 0.02, zz = 0.02, xy = 0.001 }";
  BOOST_REQUIRE(text.find(about_com) != std::string::npos);
  text.replace(text.find(about_com), about_com.size(),
               "inertia = { about = \"origin\", xx = 0.05, yy = 0.03, zz = 0.07, xy = -0.019 }");
  const Ladder a = ladderOfText(kAll, 0.2, 20), b = ladderOfText(text.c_str(), 0.2, 20);
  BOOST_TEST(names(a) == names(b), boost::test_tools::per_element());
  for (std::size_t r = 0; r + 1 < a.rungs.size(); ++r)
    BOOST_TEST(a.rungs[r].full.share == b.rungs[r].full.share, boost::test_tools::tolerance(1e-9));
}

BOOST_AUTO_TEST_CASE(a_rung_that_cannot_move_says_why) {
  const Ladder ladder = ladderOfText(R"(
[[link]]
name = "base"
[[link]]
name = "wheel"
parent = "base"
mass = 1
inertia = { about = "com", xx = 0.5, yy = 0.5, zz = 1 }
[link.joint]
kind = "revolute"
[start]
qd = [1]
)",
                                     1, 10);
  BOOST_TEST(!ladder.rungs.front().motion.has_value());
  BOOST_TEST(ladder.rungs.front().no_motion.find("wheel") != std::string::npos);
}
