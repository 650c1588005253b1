// SPDX-License-Identifier: GPL-3.0-or-later
// The textbook of the diagnosis is right where no mistake is put into it: it lies within what an
// engine may lose of the certified truth, for every kind of joint.
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE textbook
#include "crosscheck/diagnosis/textbook.hpp"

#include <limits>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/diagnosis/hypotheses.hpp"
#include "crosscheck/diagnosis/suspects.hpp"
#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/verdicts/truth.hpp"
#include "crosscheck/witnesses/engine_bound.hpp"
#include "scene/mimic.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
namespace data = boost::unit_test::data;

namespace {

constexpr Quantity kKnown[] = {Quantity::kM,   Quantity::kc,       Quantity::kg,
                               Quantity::kTau, Quantity::kKinetic, Quantity::kPotential};

void isRight(const scene::Scene& scene) {
  Belief right;
  right.model = textbookModel(scene);
  const Textbook textbook(right);
  Truth truth(scene.mechanism);
  EngineBound bound(scene.mechanism);
  for (int k = 0; k < 2; ++k) {
    const scene::State<double> state =
        drawState(scene.mechanism, scene.name, 7, static_cast<std::uint64_t>(k));
    for (const Quantity quantity : kKnown) {
      const Certified exact = truth(quantity, state);
      const Eigen::MatrixXd value = textbook(quantity, state), limit = bound(quantity, state);
      const Eigen::MatrixXd middle = exact.value.unaryExpr([](const Ball& x) { return x.mid(); });
      BOOST_TEST_CONTEXT(scene.name << ", " << name(quantity) << "\n"
                                    << value << "\n\n"
                                    << middle) {
        BOOST_TEST_REQUIRE((value.rows() == middle.rows() && value.cols() == middle.cols()));
        // T by M: n more roundings
        const double ulp =
            std::numeric_limits<double>::epsilon() * middle.cwiseAbs().maxCoeff() *
            (quantity == Quantity::kKinetic ? static_cast<double>(state.qd.size()) : 1.0);
        BOOST_TEST(((value - middle).cwiseAbs().array() <= limit.array() + ulp).all());
      }
    }
  }
}

}  // namespace

BOOST_DATA_TEST_CASE(it_is_right_about_bundled_scenes,
                     data::make({"simple_pendulum", "planar_3r", "puma_560_friction",
                                 "kuka_iiwa_14", "humanoid_floating", "stanford_arm", "heavy_top",
                                 "satellite_arm", "lead_screw", "gyroscopic_wrist",
                                 "cylindrical_arm", "cardan_pendulum", "puck_on_slope",
                                 "elastic_pendulum", "prismatic_revolute_mix"}),
                     name) {
  isRight(scene::findScene(name));
}

BOOST_DATA_TEST_CASE(it_is_right_about_random_trees, data::xrange(20), index) {
  isRight(randomTreeScene(3, static_cast<std::uint64_t>(index), 6));
}

// Each mistake changes the numbers of the mechanism that it is about, and can be computed.
BOOST_DATA_TEST_CASE(every_mistake_can_be_computed,
                     data::make({"puma_560_friction", "humanoid_floating", "stanford_arm",
                                 "franka_panda", "prismatic_revolute_mix"}),
                     name) {
  const scene::Scene scene = scene::findScene(name);
  Belief right;
  right.model = textbookModel(scene);
  const scene::State<double> state = drawState(scene.mechanism, scene.name, 7, 0);
  for (const Hypothesis& h : hypotheses(right.model)) {
    Belief belief = right;
    h.apply(belief);
    BOOST_TEST(Textbook(belief)(Quantity::kTau, state).allFinite(), h.sentence);
  }
  for (const Suspect& s : suspects(right.model)) {
    Belief belief = right;
    s.apply(belief, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(s.names.size())));
    const Eigen::MatrixXd same = Textbook(belief)(Quantity::kTau, state);
    BOOST_TEST((same - Textbook(right)(Quantity::kTau, state)).isZero(), s.what);
  }
}
