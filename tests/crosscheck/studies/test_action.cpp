// SPDX-License-Identifier: GPL-3.0-or-later
// Hamilton's principle on simulated motions, and conjugate times against closed forms.
#include "crosscheck/studies/hamilton.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>

#include <Eigen/Eigenvalues>
#include <boost/math/constants/constants.hpp>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/studies/order_of_steps.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

const double kPi = boost::math::constants::pi<double>();

const CheckResult* find(const Action& action, const std::string& name) {
  for (const CheckResult& check : action.checks)
    if (check.name().find(name) != std::string::npos) return &check;
  return nullptr;
}
bool allAgree(const Action& action) {
  return std::all_of(action.checks.begin(), action.checks.end(),
                     [](const CheckResult& c) { return c.verdict == Verdict::kAgree; });
}

bool condemned(const Action& action) {
  return std::any_of(action.checks.begin(), action.checks.end(),
                     [](const CheckResult& c) { return c.verdict == Verdict::kDisagree; });
}

/// Arithmetic-geometric mean.
double agm(double a, double b) {
  for (int k = 0; k < 8; ++k) {
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b);
    a = mean;
  }
  return a;
}

std::vector<std::string> trees() {
  std::vector<std::string> names;
  for (const auto& file : scene::bundledScenes()) {
    const scene::Scene scene = scene::readScene(file);
    // the humanoids take minutes
    if (refusals(scene, Command::kAction).empty() && scene.mechanism.dof() <= 9)
      names.push_back(scene.name);
  }
  return names;
}

}  // namespace

// A pendulum let go at rest: qd is a neighbour of the motion (the same, a little later) that
// vanishes at the start and again where the pendulum turns. So the conjugate time is half the
// period, which the arithmetic-geometric mean gives: T = 2 pi sqrt(l / g) / agm(1, cos(q0 / 2)).
BOOST_DATA_TEST_CASE(a_pendulum_is_conjugate_to_its_start_after_half_a_period,
                     data::make({0.5, 1.5, 2 * kPi / 3, 2.8}), q_0) {
  ActionOptions options;
  options.q = {q_0};
  options.duration = 2.5;
  const Action action = measureAction(scene::findScene("simple_pendulum"), options);
  const double half = kPi * std::sqrt(1 / 9.81) / agm(1, std::cos(q_0 / 2));
  BOOST_REQUIRE(action.conjugates.size() == static_cast<std::size_t>(options.duration / half));
  for (std::size_t k = 0; k < action.conjugates.size(); ++k) {
    const Action::Conjugate& found = action.conjugates[k];
    BOOST_TEST(std::abs(found.time - (k + 1) * half) <= found.error);
    BOOST_TEST(found.error < half / 1000);
  }
  BOOST_TEST(action.negative == static_cast<int>(action.conjugates.size()));
  BOOST_TEST(allAgree(action));
}

// At rest where it hangs, the motion is no motion, and its neighbours are small oscillations: sin(w
// t) of the two modes, w from M and K by hand for two rods.
BOOST_AUTO_TEST_CASE(a_hanging_double_pendulum_is_conjugate_after_half_periods_of_its_modes) {
  const double m1 = 1, m2 = 0.8, l1 = 0.5, l2 = 0.4, g = 9.81;
  const double b = m2 * l1 * l2 / 2, e = m2 * l2 * l2 / 3;
  const double a = m1 * l1 * l1 / 3 + m2 * l1 * l1 + e;
  const double k2 = m2 * g * l2 / 2, k1 = m1 * g * l1 / 2 + m2 * g * l1 + k2;
  Eigen::Matrix2d M, K;
  M << a + 2 * b, e + b, e + b, e;
  K << k1, k2, k2, k2;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(K, M);
  std::vector<double> expected;
  ActionOptions options;
  options.q = {0, 0};
  options.duration = 1.5;
  for (int i = 0; i < 2; ++i)
    for (int k = 1; k * kPi / std::sqrt(modes.eigenvalues()(i)) < options.duration; ++k)
      expected.push_back(k * kPi / std::sqrt(modes.eigenvalues()(i)));
  std::sort(expected.begin(), expected.end());
  BOOST_TEST(expected.size() >= 4u);

  const Action action = measureAction(scene::findScene("double_pendulum"), options);
  BOOST_REQUIRE(action.conjugates.size() == expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k)
    BOOST_TEST(std::abs(action.conjugates[k].time - expected[k]) <= action.conjugates[k].error);
  BOOST_TEST(action.negative == static_cast<int>(expected.size()));
  BOOST_TEST(allAgree(action));
}

// Hanging from a universal joint, a point swings alike in all directions: two neighbours meet at
// once.
BOOST_AUTO_TEST_CASE(two_neighbours_may_meet_at_once) {
  const scene::Scene bob = scene::readSceneToml(R"(
title = "x"
source = "x"
gravity = [0, 0, -10]
[[link]]
name = "base"
[[link]]
name = "bob"
parent = "base"
mass = 3
com = [0, 0, -1]
joint = { kind = "universal" }
)",
                                                "bob.toml");
  ActionOptions options;
  options.duration = 2.5;
  const Action action = measureAction(bob, options);
  BOOST_REQUIRE(action.conjugates.size() == 2u);
  for (int k = 0; k < 2; ++k) {  // by hand: half periods of w^2 = g / l
    BOOST_TEST(std::abs(action.conjugates[k].time - (k + 1) * kPi / std::sqrt(10.0)) < 1e-3);
    BOOST_TEST(action.conjugates[k].multiplicity == 2);
  }
  BOOST_TEST(action.negative == 4);
  BOOST_TEST(allAgree(action));
}

// Balanced upside down, neighbours run away and never come back: the action is least for ever.
BOOST_AUTO_TEST_CASE(an_inverted_pendulum_has_no_conjugate_time) {
  ActionOptions options;
  options.q = {kPi};
  options.duration = 2;
  const Action action = measureAction(scene::findScene("simple_pendulum"), options);
  BOOST_TEST(action.conjugates.empty());
  BOOST_TEST(action.negative == 0);
  BOOST_TEST(allAgree(action));
}

// Short motions have the least action, and every varied path shows it; over a longer time of the
// same motion a slow detour lowers it and a fast one does not.
BOOST_AUTO_TEST_CASE(the_action_is_least_for_short_times_only) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  ActionOptions options;
  options.duration = 0.2;
  const Action brief = measureAction(scene, options);
  BOOST_TEST(brief.negative == 0);
  for (const Action::Path& path : brief.paths) BOOST_TEST(path.change > 0);
  BOOST_TEST(allAgree(brief));
  options.duration = 1;
  const Action later = measureAction(scene, options);
  BOOST_TEST(later.negative >= 1);
  bool slow = false, fast = false;
  for (const Action::Path& path : later.paths) {
    slow = slow || (path.kind == Action::Path::Kind::kSlowest && path.change < 0);
    fast = fast || (path.kind == Action::Path::Kind::kFast && path.change > 0);
  }
  BOOST_TEST(slow);
  BOOST_TEST(fast);
  BOOST_TEST(allAgree(later));
}

BOOST_DATA_TEST_CASE(the_first_variation_vanishes_in_every_bundled_tree, data::make(trees()),
                     name) {
  ActionOptions options;
  options.duration = 0.3;
  const Action action = measureAction(scene::findScene(name), options);
  for (const CheckResult& check : action.checks)
    BOOST_TEST((check.verdict == Verdict::kAgree), check.name() << ": " << check.reason);
  BOOST_REQUIRE(find(action, "principle") != nullptr);
}

// Friction has no potential: the principle of d'Alembert and Lagrange holds, and putting its work
// into the Lagrangian gives something that is not 0 at any step size. A force along a joint that is
// constant may be treated so; that is what a potential is.
BOOST_AUTO_TEST_CASE(work_is_no_part_of_a_lagrangian) {
  ActionOptions options;
  options.damping = 0.2;
  options.duration = 0.5;
  const Action action = measureAction(scene::findScene("double_pendulum"), options);
  BOOST_TEST(allAgree(action));
  BOOST_TEST(!action.conservative);
  BOOST_TEST(action.with_work > 1e-3);
  BOOST_TEST(std::abs(action.with_work / action.with_work_coarse - 1) < 0.01);

  const scene::Scene pushed = scene::readSceneToml(R"(
title = "x"
source = "x"
[[link]]
name = "base"
[[link]]
name = "bead"
parent = "base"
mass = 2
joint = { kind = "prismatic", axis = [1, 0, 0] }
[[wrench]]
link = "bead"
force = [3, 0, 0]
)",
                                                   "pushed.toml");
  options.damping = 0;
  const Action constant = measureAction(pushed, options);
  BOOST_TEST(!constant.conservative);
  BOOST_TEST(allAgree(constant));
  BOOST_TEST(constant.with_work < 1e-12);
}

// Without gravity the motion is a geodesic; on a sphere (a point on crossing axes) all great
// circles from a point meet again at the opposite one, after a half turn.
BOOST_AUTO_TEST_CASE(geodesics_of_a_sphere_meet_after_half_a_turn) {
  const scene::Scene sphere = scene::readSceneToml(R"(
title = "x"
source = "x"
[[link]]
name = "base"
[[link]]
name = "bob"
parent = "base"
mass = 3
com = [2, 0, 0]
[link.joint]
kind = "universal"
rpy = [0, "pi/2", 0]
)",
                                                   "sphere.toml");
  ActionOptions options;
  options.potential = false;
  options.q = {0.1, 0.2};
  options.qd = {0.5, 0.4};
  options.duration = 8;
  // by hand: speed^2 = M_11 qd_1^2 + qd_2^2 on the unit sphere, with the sine or cosine of q2 in
  // M_11
  const Action action = measureAction(sphere, options);
  BOOST_REQUIRE(action.conjugates.size() == 1u);
  bool matches = false;
  for (const double share : {std::cos(0.2), std::sin(0.2)}) {
    const double speed = std::hypot(share * 0.5, 0.4);
    matches =
        matches || std::abs(action.conjugates[0].time - kPi / speed) <= action.conjugates[0].error;
  }
  BOOST_TEST(matches);
  BOOST_TEST(action.negative == 1);
  for (const CheckResult& check : action.checks)
    BOOST_TEST((check.verdict == Verdict::kAgree), check.name() << ": " << check.reason);
}

/// A double pendulum under gravity as a tree, and with its elbow closed between two branches.
scene::Scene elbow(bool is_closed) {
  std::string text = R"(
title = "x"
source = "x"
gravity = [0, -9.81, 0]
[[link]]
name = "base"
[[link]]
name = "upper"
parent = "base"
mass = 1
com = [0.25, 0.1, 0]
inertia = { xx = 0.01, yy = 0.01, zz = 0.02 }
joint = { kind = "revolute" }
[[link]]
name = "lower"
mass = 2
com = [0.3, -0.05, 0]
inertia = { xx = 0.01, yy = 0.02, zz = 0.03 }
)";
  text += is_closed ? R"(parent = "base"
joint = { kind = "planar" }
[[closure]]
kind = "planar_point"
a = { link = "upper", xyz = [0.5, 0, 0] }
b = { link = "lower" }
[start]
q = [0, 0.5, 0, 0.3]
)"
                    : R"(parent = "upper"
joint = { kind = "revolute", xyz = [0.5, 0, 0] }
[start]
q = [0, 0.3]
)";
  return scene::readSceneToml(text, "elbow.toml");
}

// The same mechanism by other coordinates: other neighbours, other elements and closures, and the
// same action, conjugate times and directions.
BOOST_AUTO_TEST_CASE(a_closed_elbow_has_the_action_of_a_tree) {
  ActionOptions options;
  options.duration = 1.2;
  const Action tree = measureAction(elbow(false), options),
               closed = measureAction(elbow(true), options);
  for (const Action* action : {&tree, &closed})
    for (const CheckResult& check : action->checks)
      BOOST_TEST((check.verdict == Verdict::kAgree), check.name() << ": " << check.reason);
  BOOST_TEST(closed.dof == 2);
  // each follows the same motion with steps of order 4, and says how far its energy is off
  BOOST_TEST(std::abs(closed.action - tree.action) <=
             options.duration * (closed.energy_drift + tree.energy_drift) + 1e-9);
  BOOST_REQUIRE(tree.conjugates.size() >= 1u);
  BOOST_REQUIRE(closed.conjugates.size() == tree.conjugates.size());
  for (std::size_t k = 0; k < tree.conjugates.size(); ++k)
    BOOST_TEST(std::abs(closed.conjugates[k].time - tree.conjugates[k].time) <=
               closed.conjugates[k].error + tree.conjugates[k].error);
  BOOST_TEST(closed.negative == tree.negative);
  options.potential = false;
  options.qd = {1, -2};
  const Action geodesic = measureAction(elbow(false), options);
  options.qd = {1, 0, 0.5, -1};  // the elbow at (0.5, 0) goes up at 0.5 m/s
  const Action of_closed = measureAction(elbow(true), options);
  BOOST_TEST(std::abs(geodesic.action - of_closed.action) <=
             options.duration * (geodesic.energy_drift + of_closed.energy_drift) + 1e-9);
  BOOST_TEST(allAgree(of_closed));
}

// Two explicit paths decide a saddle, however little it has of one: just behind the conjugate time
// no sum of a few sines is low enough, and the path that is found is.
BOOST_DATA_TEST_CASE(two_paths_decide_a_saddle, data::make({1.001, 1.01, 1.3, 2.5}), halves) {
  ActionOptions options;
  options.q = {2.8};
  options.duration = halves * kPi * std::sqrt(1 / 9.81) / agm(1, std::cos(1.4));
  const Action action = measureAction(scene::findScene("simple_pendulum"), options);
  BOOST_TEST(allAgree(action));
  BOOST_TEST(action.negative == static_cast<int>(halves));
  BOOST_TEST(action.conjugates.size() == static_cast<std::size_t>(action.negative));
  BOOST_TEST(action.lowest < 0);
  int lower = 0, higher = 0;
  for (const Action::Path& path : action.paths) {
    lower += path.kind == Action::Path::Kind::kSlowest && path.change + path.unsure < 0 ? 1 : 0;
    higher += path.kind == Action::Path::Kind::kFast && path.change - path.unsure > 0 ? 1 : 0;
  }
  BOOST_TEST(lower == 1);
  BOOST_TEST(higher == 1);
}

// Closures that bend: paths follow them by Newton's steps, and are still surely higher and lower.
BOOST_AUTO_TEST_CASE(two_paths_decide_a_saddle_of_a_closed_loop) {
  ActionOptions options;
  options.duration = 0.5;
  const Action action = measureAction(scene::findScene("loop_on_arm"), options);
  for (const CheckResult& check : action.checks)
    BOOST_TEST((check.verdict == Verdict::kAgree), check.name() << ": " << check.reason);
  BOOST_TEST(action.negative == 1);
  BOOST_TEST(action.conjugates.size() == 1u);
}

// The first, longest steps lose these motions, the finer ones do not. M is regular throughout.
BOOST_AUTO_TEST_CASE(a_motion_that_long_steps_lose_is_followed_by_shorter_ones) {
  ActionOptions options;
  options.duration = 7;
  const Action action = measureAction(scene::findScene("double_pendulum"), options);
  BOOST_TEST(!condemned(action));
  BOOST_TEST((find(action, "Hamilton")->verdict == Verdict::kAgree));
}
BOOST_AUTO_TEST_CASE(a_motion_that_no_steps_follow_is_not_called_singular) {
  ActionOptions options;
  options.duration = 1e5;
  std::string message;
  try {
    measureAction(scene::findScene("double_pendulum"), options);
  } catch (const scene::InputError& error) {
    message = error.what();
  }
  BOOST_TEST(message.find("do not resolve the motion; allowed: a shorter") != std::string::npos,
             message);
  BOOST_TEST(message.find("singular") == std::string::npos);
}

// After many periods elements, steps and the sines of the fast path are too coarse to count; at
// places whose ulp is large the motion itself is. Mechanics is not to blame.
BOOST_DATA_TEST_CASE(steps_that_do_not_decide_condemn_nobody,
                     data::make({75.0, 80.0, 100.0, 1000.0}), duration) {
  ActionOptions options;
  options.duration = duration;
  BOOST_TEST(!condemned(measureAction(scene::findScene("simple_pendulum"), options)));
}
BOOST_DATA_TEST_CASE(rounding_of_a_far_place_condemns_nobody, data::make({1e7, 1e8, 1e13, 1e308}),
                     place) {
  ActionOptions options;
  options.potential = false;
  options.q = {place, place};
  options.qd = {1, 1};
  const Action action = measureAction(scene::findScene("double_pendulum"), options);
  BOOST_TEST(!condemned(action));
  // an ulp of 1e13 rad, 8192 times, reaches paths that are 0.01 rad away
  for (const CheckResult& check : action.checks)
    if (place > 1e12) BOOST_TEST((check.verdict == Verdict::kNotAnswerable), check.name());
}
BOOST_AUTO_TEST_CASE(a_pendulum_that_cannot_move_by_less_than_an_ulp_is_not_answerable) {
  ActionOptions options;
  options.q = {1e16};
  options.qd = {1};
  for (const CheckResult& check :
       measureAction(scene::findScene("simple_pendulum"), options).checks)
    BOOST_TEST((check.verdict == Verdict::kNotAnswerable), check.name());
}

BOOST_AUTO_TEST_SUITE(what_does_not_vanish)

/// The verdict on residuals at three sizes of steps; terms of 1.
CheckResult judged(double longest, double longer, double last, double moved = 0) {
  std::vector<StepResidual> seen(3);
  const double all[] = {longest, longer, last};
  for (int k = 0; k < 3; ++k) {
    seen[k].add(all[k], true);
    seen[k].terms = 1;
  }
  CheckResult check;
  judgeOrder(
      &check, seen, 1, [&] { return moved; }, 256);
  return check;
}

BOOST_AUTO_TEST_CASE(falls_with_the_order_of_the_steps) {
  BOOST_TEST((judged(16e-6, 1e-6, 1e-6 / 16).verdict == Verdict::kAgree));
}
BOOST_AUTO_TEST_CASE(or_settles_and_is_guilty) {
  BOOST_TEST((judged(1e-5 + 16e-6, 1e-5 + 1e-6, 1e-5 + 1e-6 / 16).verdict == Verdict::kDisagree));
  BOOST_TEST((judged(1e-9, 1e-9, 1e-9).verdict == Verdict::kDisagree));
}
BOOST_AUTO_TEST_CASE(or_the_steps_have_not_settled) {
  BOOST_TEST((judged(3e-9, 7e-9, 5e-9).verdict == Verdict::kNotAnswerable));
  // the changes have, 1.4e-5 and 1.6e-6, but the last one could have come from 0
  BOOST_TEST((judged(1.6e-5, 2e-6, 4e-7).verdict == Verdict::kNotAnswerable));
}
BOOST_AUTO_TEST_CASE(or_is_what_rounding_the_state_moves) {
  BOOST_TEST((judged(1e-9, 1e-9, 1e-9, 2e-9).verdict == Verdict::kAgree));
  BOOST_TEST((judged(1e-9, 1e-9, 1e-9, 2).verdict == Verdict::kNotAnswerable));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_CASE(bad_questions_are_refused) {
  const scene::Scene scene = scene::findScene("simple_pendulum");
  ActionOptions options;
  options.duration = 0;
  BOOST_CHECK_THROW(measureAction(scene, options), scene::InputError);
  options = {};
  options.q = {1, 2};
  BOOST_CHECK_THROW(measureAction(scene, options), scene::InputError);
  options = {};
  options.damping = -1;
  BOOST_CHECK_THROW(measureAction(scene, options), scene::InputError);
  options = {};
  options.paths = 0;
  BOOST_CHECK_THROW(measureAction(scene, options), scene::InputError);
  options = {};
  options.qd = {1e-320};
  BOOST_CHECK_THROW(measureAction(scene, options), scene::InputError);
  BOOST_CHECK_THROW(measureAction(scene::findScene("rolling_coin"), {}), scene::InputError);
  options = {};
  options.damping = 0.1;
  BOOST_CHECK_THROW(measureAction(elbow(true), options), scene::InputError);
  options = {};
  options.duration = 2;  // on its slides the pendulum passes where x no longer tells y
  BOOST_CHECK_THROW(measureAction(scene::findScene("pendulum_on_slides"), options),
                    scene::InputError);
}
