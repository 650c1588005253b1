// SPDX-License-Identifier: GPL-3.0-or-later
// Impedances: laws over the field in the bundled trees, closed forms by hand, and mistakes.
#include "crosscheck/studies/impedance.hpp"

#include <cmath>
#include <ostream>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/studies/impedance_laws.hpp"
#include "crosscheck/verdicts/within_bounds.hpp"
#include "tests/fixtures/treated_scenes.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

BOOST_DATA_TEST_CASE(the_laws_hold_in_every_bundled_tree,
                     data::make(fixtures::scenesTreatedBy(Command::kImpedance)), name) {
  const scene::Scene scene = scene::findScene(name);
  int decided = 0;
  for (const CheckResult& check : checkImpedanceExactly(scene, "", {})) {
    BOOST_TEST((check.verdict != Verdict::kDisagree), check.name() << ": " << check.reason);
    decided += check.verdict == Verdict::kAgree ? 1 : 0;
  }
  BOOST_TEST(decided >= 5);
  ImpedanceOptions options;
  options.stretch = {0.1, -0.2, 0.3};
  for (const CheckResult& check : impedanceAt(scene, options).checks)
    BOOST_TEST((check.verdict != Verdict::kDisagree), check.name() << ": " << check.reason);
}
BOOST_AUTO_TEST_CASE(six_joints_go_there_and_back) {
  bool seen = false;
  for (const CheckResult& check : checkImpedanceExactly(scene::findScene("puma_560"), "", {})) {
    BOOST_TEST((check.verdict == Verdict::kAgree), check.name() << ": " << check.reason);
    seen = seen || check.name() == "there and back";
  }
  BOOST_TEST(seen);
}

// By hand, a rod of length l at angle q from straight down in the x-z plane: its tip is at l (sin
// q, -cos q) up to the sense of y, so J = l (cos q, sin q), K_q = l^2 (kx cos^2 + kz sin^2), and a
// spring along x that is stretched by s adds kx s l (-sin q).
BOOST_AUTO_TEST_CASE(a_pendulum_on_a_spring) {
  const scene::Scene scene = scene::findScene("simple_pendulum");
  ImpedanceOptions options;
  for (const double q : {0.3, 1.2}) {
    options.q = {q};
    options.at = {0, 0, -1};
    options.stiffness = {7, 0, 5, 0, 0, 0};
    options.stretch = {0.1, 0, 0};
    const ImpedanceAt at = impedanceAt(scene, options);
    const double c = std::cos(q), s = std::sin(q);
    const double u = 0x1p-52;  // of the doubles written here
    BOOST_TEST(std::abs(std::abs(at.J.value(0, 0)) - c) <= at.J.bound(0, 0) + u);
    BOOST_TEST(std::abs(at.stiffness.value(0, 0) - (7 * c * c + 5 * s * s)) <=
               at.stiffness.bound(0, 0) + 16 * u);
    const double sense = at.J.value(0, 0) > 0 ? 1 : -1;
    BOOST_TEST(std::abs(at.geometric.value(0, 0) + sense * 7 * 0.1 * s) <=
               at.geometric.bound(0, 0) + 4 * u);
    BOOST_TEST(std::abs(at.mobility.value(0, 0) - c * c) <= at.mobility.bound(0, 0) + 4 * u);
    BOOST_TEST(!at.inertia.bound.allFinite());  // one joint does not move a point every way
  }
}
// By hand, three slides: J = 1, so every matrix is its own image, and the point weighs what is
// moved.
BOOST_AUTO_TEST_CASE(three_slides) {
  const scene::Scene scene = scene::readSceneToml(R"(
title = "x"
source = "x"
[[link]]
name = "base"
[[link]]
name = "a"
parent = "base"
mass = 1
joint = { kind = "prismatic", axis = [1, 0, 0] }
[[link]]
name = "b"
parent = "a"
mass = 2
joint = { kind = "prismatic", axis = [0, 1, 0] }
[[link]]
name = "c"
parent = "b"
mass = 4
joint = { kind = "prismatic", axis = [0, 0, 1] }
)",
                                                  "slides.toml");
  ImpedanceOptions options;
  options.stiffness = {2, 3, 5, 0, 0, 0};
  options.joint_compliance = {0.5, 0.25, 0.125};
  const ImpedanceAt at = impedanceAt(scene, options);
  const double mass[] = {7, 6, 4};
  for (int i = 0; i < 3; ++i) {
    BOOST_TEST(at.stiffness.value(i, i) == options.stiffness[i]);
    BOOST_TEST(at.compliance.value(i, i) == options.joint_compliance[i]);
    BOOST_TEST(std::abs(at.inertia.value(i, i) - mass[i]) <= at.inertia.bound(i, i));
  }
  BOOST_TEST(at.geometric.value.isZero(0));
}

// Without the geometric term the joints' stiffness is not the potential's second derivative: a
// plant.
BOOST_AUTO_TEST_CASE(the_geometric_term_is_needed) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  ImpedanceModel<RunningError> model(scene.mechanism, RunningErrorNumbers(scene.mechanism));
  const auto at = runningErrorState(
      {{scene::jointPosition(0.3), scene::jointPosition(0.8)}, {1.0, 2.0}, {0.0, 0.0}, {0.0, 0.0}});
  Impedance<RunningError> z;
  z.point = {2, {0.0, 0.0, -0.4}};
  z.K = recursive::Matrix6<RunningError>::Identity();
  z.D = z.K;
  z.stretch = {0.1, 0.0, 0.2};
  z.joint_compliance = {1.0, 1.0};
  z.wrench << RunningError(1), RunningError(2), RunningError(3), RunningError(1), RunningError(1),
      RunningError(2);
  const std::vector<LawWords> words = ImpedanceLaws::words(scene.mechanism);
  const auto sidesNow = [&] {
    return ImpedanceLaws::sides(scene.mechanism, ImpedanceAsked<RunningError>(model, at, z));
  };
  const auto verdicts = [&] {
    std::string text;
    for (const CheckResult& check : withinBounds(words, sidesNow()))
      if (check.verdict == Verdict::kDisagree) text += check.name() + "; ";
    return text;
  };
  BOOST_TEST(verdicts() == "");
  auto sides = sidesNow();
  const auto f = recursive::Vector3<RunningError>(z.stretch);
  sides[0].right -= model.geometricStiffness(at, z.point, f);
  BOOST_TEST((withinBounds(words, sides)[0].verdict == Verdict::kDisagree));
  // and the two sides do read the scene each for itself
  model.model.links.back().X_tree.p.x() += RunningError(1e-6);
  BOOST_TEST(verdicts() == "stiffness of the joints; damping of the joints; ");
}

BOOST_AUTO_TEST_CASE(bad_questions_are_refused) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  ImpedanceOptions options;
  options.link = "nobody";
  BOOST_CHECK_THROW(impedanceAt(scene, options), scene::InputError);
  options = {};
  options.q = {1};
  BOOST_CHECK_THROW(impedanceAt(scene, options), scene::InputError);
  options = {};
  options.joint_compliance = {1};
  BOOST_CHECK_THROW(impedanceAt(scene, options), scene::InputError);
  BOOST_CHECK_THROW(impedanceAt(scene::findScene("bricard"), {}), scene::InputError);
  // whose products are no normal numbers: limits would let everything pass
  ImpedanceOptions tiny[5];
  tiny[0].stiffness[0] = 1e-320;
  tiny[1].damping[1] = -1e-200;
  tiny[2].stretch[2] = 1e-308;
  tiny[3].joint_compliance = {1, 1e-320};
  tiny[4].at[0] = 1e-150;
  for (const ImpedanceOptions& given : tiny)
    BOOST_CHECK_THROW(impedanceAt(scene, given), scene::InputError);
}
