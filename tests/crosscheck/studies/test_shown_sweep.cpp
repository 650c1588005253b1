// SPDX-License-Identifier: GPL-3.0-or-later
// What `sweep` shows: a pendulum by hand, and in all bundled trees what must hold of its numbers.
#include "crosscheck/studies/shown_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/witnesses/engine_bound.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

// By hand, from the world: the lower rod's centre of mass is at r = (l1 sin q1 + c2 sin q12,
// -l1 cos q1 - c2 cos q12), and the elbow carries m (r'' - g).
BOOST_AUTO_TEST_CASE(the_elbow_carries_the_lower_rod) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  const double q1 = 0.3, q2 = 0.4, w1 = 1, w2 = 2, e1 = 0.5, e2 = -0.5, l1 = 0.5, c2 = 0.2, m = 0.8,
               g = 9.81, q12 = q1 + q2, w = w1 + w2, e = e1 + e2;
  scene::State<double> state;
  state.x = {scene::jointPosition(q1), scene::jointPosition(q2)};
  state.qd = {w1, w2};
  state.qdd = {e1, e2};
  const ShownSweep sweep = shownSweep(scene, state);
  BOOST_TEST_REQUIRE(sweep.links.size() == 2u);
  const ShownLink& lower = sweep.links[1];
  const double ax = l1 * (std::cos(q1) * e1 - std::sin(q1) * w1 * w1) +
                    c2 * (std::cos(q12) * e - std::sin(q12) * w * w);
  const double az = l1 * (std::sin(q1) * e1 + std::cos(q1) * w1 * w1) +
                    c2 * (std::sin(q12) * e + std::cos(q12) * w * w);
  BOOST_TEST(lower.f.head<3>().norm() == m * std::hypot(ax, az + g),
             boost::test_tools::tolerance(1e-14));
  BOOST_TEST(lower.v(5) == w, boost::test_tools::tolerance(1e-15));
  BOOST_TEST(sweep.links[0].M_C(0, 0) == 1.8, boost::test_tools::tolerance(1e-15));
  // locked and free, the last link is itself
  BOOST_TEST((lower.M_A - lower.M).isZero(0));
  BOOST_TEST((lower.M_C - lower.M).isZero(0));
}

BOOST_DATA_TEST_CASE(what_is_shown_fits_together,
                     data::make({"double_pendulum", "puma_560", "stanford_arm", "scara",
                                 "cylindrical_arm", "prismatic_revolute_mix", "gyroscopic_wrist",
                                 "satellite_arm", "elastic_pendulum", "puma_560_friction"}),
                     name) {
  const scene::Scene scene = scene::findScene(name);
  const scene::State<double> state = drawState(scene.mechanism, scene.name, 5, 0);
  const ShownSweep sweep = shownSweep(scene, state);
  EngineBound bound(scene.mechanism);
  const Eigen::MatrixXd limit = bound(Quantity::kTau, sweep.state);
  for (const ShownLink& link : sweep.links) {
    const double size = link.M_A.cwiseAbs().maxCoeff(),
                 P = std::max(1.0, link.P.cwiseAbs().maxCoeff());
    // a few products of six terms each; those of D^-1 lose its condition
    const double condition = link.D.size() == 0 ? 1 : link.D.norm() * link.D.inverse().norm();
    const double lost = 100 * std::numeric_limits<double>::epsilon() * condition;
    BOOST_TEST(link.projector <= lost * 6 * P * P, link.name);
    BOOST_TEST(link.asymmetry <= lost * 6 * P * size, link.name);
    BOOST_TEST((link.M - link.M.transpose()).isZero(0));
    for (std::size_t k = 0; k < link.rates.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const Eigen::Index at = link.first_rate + i;
      const double parts = link.Z_f(i) + link.rotor(i) + link.gyroscopic(i) + link.passive(i);
      BOOST_TEST(std::abs(parts - sweep.tau(at)) <= limit(at, 0), link.name);
      BOOST_TEST(std::abs(sweep.lagrange(at) - sweep.tau(at)) <= 2 * limit(at, 0), link.name);
    }
  }
}
