// SPDX-License-Identifier: GPL-3.0-or-later
// Linearized motion: its laws over the field in the bundled trees, and modes by hand.
#include "crosscheck/studies/linearization.hpp"

#include <cmath>
#include <complex>
#include <fstream>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/studies/linearization_laws.hpp"
#include "crosscheck/verdicts/within_bounds.hpp"
#include "tests/fixtures/files.hpp"
#include "tests/fixtures/treated_scenes.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

/// A scene of this text.
scene::Scene sceneOf(const std::string& text) {
  const files::TemporaryFolder folder;
  const auto file = folder.path / "scene.toml";
  std::ofstream(file) << text;
  return scene::readScene(file);
}

/// Whether one of the enclosures holds the number.
bool holds(const Linearization& at, std::complex<double> value) {
  for (const EnclosedMode& mode : at.modes.modes)
    if (std::abs(mode.value.real() - value.real()) <= mode.radius_re + 1e-15 * std::abs(value) &&
        std::abs(mode.value.imag() - value.imag()) <= mode.radius_im + 1e-15 * std::abs(value))
      return true;
  return false;
}

const char* const kPoint = "mass = 1\ncom = [0, 0, -1]\n";
std::string pendulum(const std::string& name, const std::string& parent, const std::string& at,
                     const std::string& more = "") {
  return "[[link]]\nname = \"" + name + "_link\"\nparent = \"" + parent + "\"\n" + kPoint +
         "[link.joint]\nname = \"" + name +
         "\"\nkind = \"revolute\"\naxis = [0, 1, 0]\nxyz = " + at + "\n" + more;
}
const std::string kWorld = "gravity = [0, 0, -9]\n[[link]]\nname = \"base\"\n";

}  // namespace

BOOST_DATA_TEST_CASE(the_laws_hold_in_every_bundled_tree,
                     data::make(fixtures::scenesTreatedBy(Command::kLinearize)), name) {
  int decided = 0;
  for (const CheckResult& check : checkLinearizationExactly(scene::findScene(name), {})) {
    BOOST_TEST((check.verdict == Verdict::kAgree), check.name() << ": " << check.reason);
    decided += check.verdict == Verdict::kAgree ? 1 : 0;
  }
  BOOST_TEST(decided >= 5);
}

// By hand: l = 1 m, g = 9 m/s^2, a damper of 2 d: lambda^2 + 2 d lambda +- 9 = 0
BOOST_AUTO_TEST_CASE(a_pendulum_hangs_and_stands) {
  const scene::Scene scene =
      sceneOf(kWorld + pendulum("hinge", "base", "[0, 0, 0]", "friction = { viscous = 0.5 }\n"));
  const Linearization hangs = linearize(scene, {});
  BOOST_TEST_REQUIRE(hangs.modes.are_simple);
  const double w = std::sqrt(9 - 0.0625);
  BOOST_TEST(holds(hangs, {-0.25, w}));
  BOOST_TEST(holds(hangs, {-0.25, -w}));
  BOOST_TEST(!holds(hangs, {-0.25, w * (1 + 1e-12)}));
  BOOST_TEST((hangs.stability == Stability::kStable));
  BOOST_TEST(hangs.reached == 2);

  LinearizationOptions up;
  up.q = {M_PI};
  const Linearization stands = linearize(scene, up);
  const double root = std::sqrt(9 + 0.0625);
  BOOST_TEST(holds(stands, {-0.25 + root, 0}));
  BOOST_TEST(holds(stands, {-0.25 - root, 0}));
  for (const EnclosedMode& mode : stands.modes.modes) BOOST_TEST(mode.is_real);
  BOOST_TEST((stands.stability == Stability::kUnstable));
  // at pi as double has it, pi - 1.2e-16, which 9 N m hold there
  BOOST_TEST(std::abs(stands.tau.value(0, 0)) < 1.2e-15);
}

// By hand (every textbook): equal masses and lengths, w^2 = (2 -+ sqrt 2) g / l, the second angle
// against the first -1 +- sqrt 2 (relative angles).
BOOST_AUTO_TEST_CASE(a_double_pendulum_swings_in_two_modes) {
  const scene::Scene scene = sceneOf(kWorld + pendulum("one", "base", "[0, 0, 0]") +
                                     pendulum("two", "one_link", "[0, 0, -1]"));
  LinearizationOptions options;
  options.q = {0.4, -0.3};
  options.seeks_equilibrium = true;
  const Linearization at = linearize(scene, options);
  BOOST_TEST(at.newton_steps > 0);
  for (const double q : at.q) BOOST_TEST(std::abs(q) < 1e-15);
  int seen = 0;
  for (const EnclosedMode& mode : at.modes.modes)
    for (const double sign : {-1.0, 1.0}) {
      const double w = std::sqrt((2 + sign * std::sqrt(2)) * 9);
      if (std::abs(mode.value.imag() - w) > 1e-9) continue;
      ++seen;
      BOOST_TEST(std::abs(mode.value - std::complex<double>(0, w)) <=
                 mode.radius_re + mode.radius_im + 1e-14);
      const std::complex<double> ratio = mode.right(1) / mode.right(0);
      BOOST_TEST(std::abs(ratio - (-1 - sign * std::sqrt(2))) < 1e-12);
    }
  BOOST_TEST(seen == 2);
  // one actuator is enough, wherever it is
  for (const char* joint : {"one", "two"}) {
    options.actuated = {joint};
    BOOST_TEST(linearize(scene, options).reached == 4, joint);
  }
}

// Two equal pendulums on one base: the force of one leaves the other alone, and the eigenvalues are
// double. Of unlike ones, the other's modes are not reached.
BOOST_AUTO_TEST_CASE(what_forces_do_not_reach_is_told) {
  LinearizationOptions options;
  options.actuated = {"one"};
  const std::string one = kWorld + pendulum("one", "base", "[0, 0, 0]");
  const Linearization equal =
      linearize(sceneOf(one + pendulum("two", "base", "[1, 0, 0]")), options);
  BOOST_TEST(!equal.modes.are_simple);
  BOOST_TEST(equal.modes.failure == "");
  BOOST_TEST(holds(equal, {0, 3}));
  for (const EnclosedMode& mode : equal.modes.modes)
    BOOST_TEST(mode.radius_re + mode.radius_im < 1e-14);
  BOOST_TEST(equal.reached == 2);
  const Linearization unlike =
      linearize(sceneOf(one + pendulum("two", "base", "[1, 0, 0]", "stiffness = 7\n")), options);
  BOOST_TEST_REQUIRE(unlike.modes.are_simple);
  BOOST_TEST(unlike.reached == 2);
  int reached = 0;
  for (const EnclosedMode& mode : unlike.modes.modes) {
    const bool is_first = std::abs(std::abs(mode.value.imag()) - 3) < 1e-9;
    BOOST_TEST((mode.reached.maxCoeff() > 0) == is_first);
    reached += is_first ? 1 : 0;
    if (!is_first) BOOST_TEST(std::abs(std::abs(mode.value.imag()) - 4) < 1e-9);  // sqrt(9 + 7)
  }
  BOOST_TEST(reached == 2);
}

// A free body at rest: twelve roots at 0, and all of it is reached.
BOOST_AUTO_TEST_CASE(a_free_body_has_no_modes_of_its_own) {
  const scene::Scene scene = sceneOf(
      "[[link]]\nname = \"base\"\n[[link]]\nname = \"body\"\nparent = \"base\"\nmass = 2\n"
      "com = [0.1, 0, 0.2]\ninertia = { xx = 0.4, yy = 0.5, zz = 0.6 }\n"
      "[link.joint]\nname = \"flight\"\nkind = \"floating\"\n[start]\nq = [0,0,0,1,0,0,0]\n");
  const Linearization at = linearize(scene, {});
  BOOST_TEST(at.A.value.bottomRows(6).isZero(1e-14));
  BOOST_TEST(at.reached == 12);
  BOOST_TEST((at.stability == Stability::kUndecided));
}

// By hand: a ball with its centre at the frame's origin keeps v and w in space. Body axes turn with
// it, so that a change of either is seen to turn back:  A = [-ad 1; 0 -w x of v, 0 of w]  and its
// eigenvalues are 0 and +- i w alone.
BOOST_AUTO_TEST_CASE(a_turning_ball_turns_its_own_axes) {
  const scene::Scene scene = sceneOf(
      "[[link]]\nname = \"base\"\n[[link]]\nname = \"ball\"\nparent = \"base\"\nmass = 2\n"
      "inertia = { xx = 0.4, yy = 0.4, zz = 0.4 }\n"
      "[link.joint]\nname = \"flight\"\nkind = \"floating\"\n[start]\nq = [0,0,0,1,0,0,0]\n");
  LinearizationOptions moving;
  moving.qd = {1, 0, 0, 0, 0, 3};
  const Linearization at = linearize(scene, moving);
  // dq' = dqd - [qd, dq]:  (w x dq_v + v x dq_w, w x dq_w), v = x, w = 3 z
  BOOST_TEST(at.A.value(0, 1) == 3);
  BOOST_TEST(at.A.value(1, 0) == -3);
  BOOST_TEST(at.A.value(1, 5) == 1);
  BOOST_TEST(at.A.value(2, 4) == -1);
  BOOST_TEST(at.A.value(3, 4) == 3);
  BOOST_TEST(at.A.value(6, 7) == 3);  // v' = v x w
  BOOST_TEST(at.A.value(7, 11) == -1);
  BOOST_TEST(at.A.value.bottomRightCorner(3, 3).isZero(0));
  BOOST_TEST_REQUIRE(at.by_lagrange.has_value());
  BOOST_TEST((at.by_lagrange->verdict == Verdict::kAgree), at.by_lagrange->reason);
}

// By hand: above sqrt(g / R) a bead rests at cos q = g / (W^2 R) and swings with W sin q there.
BOOST_AUTO_TEST_CASE(a_bead_swings_about_its_place_on_the_hoop) {
  const scene::Scene scene = scene::findScene("bead_on_hoop");
  LinearizationOptions options;
  options.q = {0, 1};
  options.seeks_equilibrium = true;
  const Linearization at = linearize(scene, options);
  const double cosine = 9.81 / (36 * 0.5), w = 6 * std::sqrt(1 - cosine * cosine);
  BOOST_TEST(std::abs(at.q[1] - std::acos(cosine)) < 1e-15);
  BOOST_TEST((at.positions == std::vector<int>{1}));
  BOOST_TEST(holds(at, {0, w}));
  BOOST_TEST(!holds(at, {0, w * (1 + 1e-12)}));
  BOOST_TEST(at.reached == 2);
  options.actuated = {scene.mechanism.links[1].joint.name};  // a drive is no input
  BOOST_CHECK_THROW(linearize(scene, options), scene::InputError);
}

// Meijaard, Papadopoulos, Ruina and Schwab (2007), table 2, at 5 m/s: weave, capsize and castering
// of a mechanism with 7 positions and 3 rates left. The rest are 0: place, heading and speed.
BOOST_AUTO_TEST_CASE(the_benchmark_bicycle_has_the_published_eigenvalues) {
  LinearizationOptions options;
  options.qd = {5, 0, 0, 0, 0, 0, 5 / 0.3, 0, 5 / 0.35};
  options.has_no_forces = true;
  options.actuated = {"steering"};
  const scene::Scene scene = scene::findScene("bicycle");
  const Linearization at = linearize(scene, options);
  BOOST_TEST(at.positions.size() == 7u);
  BOOST_TEST(at.rates.size() == 3u);
  int found = 0;
  for (const std::complex<double> published :
       {std::complex<double>(-0.77534188219585, 4.46486771378823),
        std::complex<double>(-0.77534188219585, -4.46486771378823),
        std::complex<double>(-0.32286642900409, 0), std::complex<double>(-14.07838969279822, 0)})
    for (const EnclosedMode& mode : at.modes.modes)
      // printed to 1e-14, and rim speeds of 5 / 0.3 and 5 / 0.35 are rounded: 4 ulp of the largest
      if (std::abs(mode.value - published) < 1e-13) {
        ++found;
        BOOST_TEST(mode.radius_re + mode.radius_im < 1e-14);  // enclosed, beside a cluster at 0
      }
  BOOST_TEST(found == 4);
  BOOST_TEST_REQUIRE(at.by_lagrange.has_value());
  BOOST_TEST((at.by_lagrange->verdict == Verdict::kAgree), at.by_lagrange->reason);
}

// Both roads to the derivatives, and of what closures leave free that it is what they leave.
BOOST_DATA_TEST_CASE(whole_mechanisms_have_one_linearization,
                     data::make({"andrews_squeezer", "bricard", "flyball_governor", "loop_on_arm",
                                 "satellite_held", "two_handed", "rolling_coin", "car_axis"}),
                     name) {
  const scene::Scene scene = scene::findScene(name);
  const Linearization at = linearize(scene, {});
  BOOST_TEST_REQUIRE(at.by_lagrange.has_value());
  BOOST_TEST((at.by_lagrange->verdict == Verdict::kAgree), at.by_lagrange->reason);
  BOOST_TEST(at.A.value.allFinite());
  BOOST_TEST(at.A.value.rows() == static_cast<Eigen::Index>(at.positions.size() + at.rates.size()));
}

// By hand: a slide at x = 0.3 m under a spring to a point 0.4 m beside it, of length l = 0.5 m:
// dF/dx = -k (1 - r / l + r x^2 / l^3) = -50 (0.4 + 0.216), over m = 2 kg. (Both roads take
// the same root of a dual number, so that neither would tell on the other.)
BOOST_AUTO_TEST_CASE(a_slanting_spring_has_the_stiffness_of_its_length) {
  const scene::Scene scene = sceneOf(
      "[[link]]\nname = \"base\"\n[[link]]\nname = \"block\"\nparent = \"base\"\nmass = 2\n"
      "[link.joint]\nname = \"slide\"\nkind = \"prismatic\"\naxis = [1, 0, 0]\n"
      "[[spring]]\na = { link = \"block\" }\nb = { link = \"base\", xyz = [0, 0.4, 0] }\n"
      "stiffness = 50\nrest = 0.3\n[start]\nq = [0.3]\n");
  const Linearization at = linearize(scene, {});
  BOOST_TEST(std::abs(at.A.value(1, 0) + 15.4) < 1e-14);
  BOOST_TEST(std::abs(at.tau.value(0) - 50 * 0.2 * 0.6) < 1e-14);
}

// By hand: two equal pendulums of 1 m, 9 m/s^2, whose ends a bar as long as their hinges are apart
// joins, swing as one: the bar of mass m moves on a circle, (2 + m) l w^2 = (2 + m) g where the
// others are points of 1 kg.
BOOST_AUTO_TEST_CASE(a_four_bar_swings_as_a_pendulum) {
  const scene::Scene scene = sceneOf(
      kWorld + pendulum("one", "base", "[0, 0, 0]") + pendulum("two", "base", "[2, 0, 0]") +
      "[[link]]\nname = \"bar\"\nparent = \"one_link\"\nmass = 3\ncom = [1, 0, 0]\n"
      "inertia = { xx = 1, yy = 1, zz = 1 }\n"
      "[link.joint]\nname = \"elbow\"\nkind = \"revolute\"\naxis = [0, 1, 0]\nxyz = [0, 0, -1]\n"
      "[[closure]]\nname = \"end\"\nkind = \"planar_point\"\n"
      "a = { link = \"two_link\", xyz = [0, 0, -1], rpy = [\"pi/2\", 0, 0] }\n"
      "b = { link = \"bar\", xyz = [2, 0, 0] }\n");
  LinearizationOptions options;
  options.q = {0.3, 0.3, -0.3};
  options.seeks_equilibrium = true;
  const Linearization at = linearize(scene, options);
  for (const double q : at.q) BOOST_TEST(std::abs(q) < 1e-15);
  BOOST_TEST(at.positions.size() == 1u);
  BOOST_TEST(holds(at, {0, 3}));
  BOOST_TEST(!holds(at, {0, 3 * (1 + 1e-12)}));
  BOOST_TEST(at.rests);
}

// By hand: a slide of m = 2 on k = 8 with d = 12 is 2 x + 12 v + 8: -3 +- sqrt(5); a second one
// without a spring has 0 and -d / m; the general matrix and its blocks.
BOOST_AUTO_TEST_CASE(damped_modes_and_blocks) {
  const auto slide = [](const std::string& name, const std::string& more) {
    return "[[link]]\nname = \"" + name +
           "_link\"\nparent = \"base\"\nmass = 2\n[link.joint]\nname = \"" + name +
           "\"\nkind = \"prismatic\"\naxis = [1, 0, 0]\n" + more;
  };
  const std::string damped = "stiffness = 8\nfriction = { viscous = 12 }\n";
  const Linearization two =
      linearize(sceneOf(kWorld + slide("a", damped) + slide("b", damped)), {});
  BOOST_TEST(!two.modes.are_simple);
  BOOST_TEST(two.modes.failure == "");
  BOOST_TEST((two.stability == Stability::kStable));
  int seen = 0;
  for (const EnclosedMode& mode : two.modes.modes)
    for (const double root : {-3 + std::sqrt(5.0), -3 - std::sqrt(5.0)})
      if (std::abs(mode.value - root) <= mode.radius_re + mode.radius_im + 1e-15) ++seen;
  BOOST_TEST(seen == 4);
  const Linearization loose = linearize(
      sceneOf(kWorld + slide("a", damped) + slide("b", "friction = { viscous = 12 }\n")), {});
  BOOST_TEST_REQUIRE(loose.modes.are_simple);
  for (const double root : {-3 + std::sqrt(5.0), -3 - std::sqrt(5.0), 0.0, -6.0})
    BOOST_TEST(holds(loose, root), root);
  BOOST_TEST((loose.stability == Stability::kUndecided));
}

// The cart's position is in no equation: a root that is 0 twice, exactly, beside enclosures that
// are narrow. Where it does not rest, no verdict on stability.
BOOST_AUTO_TEST_CASE(what_drifts_is_zero_exactly) {
  const scene::Scene scene = scene::findScene("cart_pole");
  const Linearization at = linearize(scene, {});
  BOOST_TEST(at.modes.failure == "");
  int zero = 0;
  for (const EnclosedMode& mode : at.modes.modes) {
    BOOST_TEST(mode.radius_re < 1e-12);
    BOOST_TEST(mode.radius_im < 1e-12);
    zero += mode.value == 0.0 && mode.radius_re == 0 && mode.radius_im == 0 ? 1 : 0;
  }
  BOOST_TEST(zero == 2);
  LinearizationOptions falling;
  falling.q = {0, 1};
  falling.has_no_forces = true;
  const Linearization falls = linearize(scene, falling);
  BOOST_TEST(!falls.rests);
  BOOST_TEST((falls.stability == Stability::kUndecided));
  falling.actuated = {scene.mechanism.links[1].joint.name, scene.mechanism.links[1].joint.name};
  BOOST_TEST(linearize(scene, falling).actuated.size() == 1u);  // said twice
}

BOOST_AUTO_TEST_CASE(no_equilibrium_is_told) {
  const scene::Scene falls =
      sceneOf(kWorld +
              "[[link]]\nname = \"weight\"\nparent = \"base\"\nmass = 1\n[link.joint]\n"
              "name = \"fall\"\nkind = \"prismatic\"\naxis = [0, 0, 1]\n");
  LinearizationOptions options;
  options.seeks_equilibrium = true;
  BOOST_CHECK_THROW(linearize(falls, options), scene::InputError);
  options.actuated = {"rise"};
  options.seeks_equilibrium = false;
  BOOST_CHECK_THROW(linearize(falls, options), scene::InputError);
}

// Gravity has its share in dqdd/dq alone; and derivatives are what differences tend to.
BOOST_AUTO_TEST_CASE(differences_tend_to_derivatives) {
  const scene::Scene scene = scene::findScene("puma_560");
  scene::Scene weightless = scene;
  weightless.mechanism.has_gravity = false;
  LinearizationOptions options;
  options.q = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
  const Linearization with = linearize(scene, options), without = linearize(weightless, options);
  BOOST_TEST((with.A.value - without.A.value).bottomLeftCorner(6, 6).norm() > 1);
  BOOST_TEST((with.A.value - without.A.value).bottomRightCorner(6, 6).isZero(1e-14));
  // against differences of the truth's own qdd: h^2 off, so halving h makes a quarter of it
  double off[2];
  for (int k = 0; k < 2; ++k) {
    const double h = 1e-3 / (1 << k);
    off[k] = 0;
    for (int j = 0; j < 6; ++j) {
      LinearizationOptions moved[2] = {options, options};
      Eigen::VectorXd qdd[2];
      for (int side = 0; side < 2; ++side) {
        moved[side].q[static_cast<std::size_t>(j)] += side == 0 ? -h : h;
        moved[side].has_no_forces = true;
        qdd[side] = linearize(scene, moved[side]).qdd.value;
      }
      LinearizationOptions here = options;
      here.has_no_forces = true;
      const Eigen::VectorXd column = linearize(scene, here).A.value.col(j).tail(6);
      off[k] = std::max(off[k], ((qdd[1] - qdd[0]) / (2 * h) - column).cwiseAbs().maxCoeff());
    }
  }
  BOOST_TEST(off[1] < off[0] / 3.9);
  BOOST_TEST(off[0] < 1);
}
