// SPDX-License-Identifier: GPL-3.0-or-later
// Reduced models: no sampled state errs by more than is certified. The error is taken by another
// road, the sweeps of recursive/ in double against the reduced program run as it is, which knows
// nothing of polynomials and boxes. And refusals, and Armstrong's PUMA.
#include "crosscheck/reduction/reduce.hpp"

#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "tests/fixtures/counted_arms.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

const auto kNoStage = [](const std::string&) {};

/// Of each scene once: it takes seconds.
const Reduction& reductionOf(const std::string& name) {
  static std::map<std::string, Reduction> known;
  const auto it = known.find(name);
  if (it != known.end()) return it->second;
  const scene::Scene scene = scene::findScene(name);
  ReduceOptions options;
  // small arms have no term that is below 5 % everywhere
  options.allowed =
      name == "puma_560" ? std::vector<double>{0.01, 0.05} : std::vector<double>{0.1, 0.3};
  options.boxes = 2000;  // any number of boxes has to give a bound
  return known.emplace(name, reduced(scene, scene::readEnvelope(scene), options, kNoStage))
      .first->second;
}

/// The worst |tau - reduced tau| of so many states, by joint: half of them at corners in qd and
/// qdd, where errors are largest.
std::vector<double> sampledWorst(const scene::Scene& scene,
                                 const std::vector<scene::JointRanges>& ranges,
                                 const ReducedModel& reduced, int states) {
  const scene::RealNumbers<double> numbers(scene.mechanism);
  const auto model = recursive::buildModel(scene.mechanism, numbers);
  recursive::Workspace<double> ws(model);
  symbolic::ProgramRun<double> program(reduced.program, numbers);
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> share(0, 1);
  const auto draw = [&](const scene::Range& r, bool at_end) {
    const double s = share(random);
    return r.low + (at_end ? std::round(s) : s) * (r.high - r.low);
  };
  const std::size_t n = ranges.size();
  scene::State<double> state;
  state.x.resize(n);
  state.qd.resize(n);
  state.qdd.resize(n);
  std::vector<double> tau(n), worst(n);
  for (int s = 0; s < states; ++s) {
    for (std::size_t k = 0; k < n; ++k) {
      state.x[k] = scene::jointPosition(draw(ranges[k].q, false));
      state.qd[k] = draw(ranges[k].qd, s % 2 == 0);
      state.qdd[k] = draw(ranges[k].qdd, s % 2 == 0);
    }
    recursive::inverseDynamics(model, state.x, state.qd, state.qdd, ws, tau);
    const std::vector<double> other = program(state);
    for (std::size_t k = 0; k < n; ++k) worst[k] = std::max(worst[k], std::abs(tau[k] - other[k]));
  }
  return worst;
}

/// What sweeps and programs of these arms lose in double: some hundred roundings of forces of
/// their largest size.
double rounding(const ReducedForce& force) {
  return 1000 * std::numeric_limits<double>::epsilon() * force.largest;
}

template <typename Call>
void refused(Call call, const std::string& reason) {
  BOOST_CHECK_EXCEPTION(call(), scene::InputError, [&](const scene::InputError& error) {
    BOOST_TEST_MESSAGE(error.what());
    return std::string(error.what()).find(reason) != std::string::npos;
  });
}

}  // namespace

BOOST_DATA_TEST_CASE(no_sampled_state_errs_by_more_than_is_certified,
                     data::make(std::vector<std::string>{"planar_3r", "scara", "puma_560"}), name) {
  const scene::Scene scene = scene::findScene(name);
  const std::vector<scene::JointRanges> ranges = scene::readEnvelope(scene);
  const Reduction& reduction = reductionOf(name);
  const int states = std::getenv("DYNWITNESS_LONG") ? 1000000 : 100000;
  for (const auto* models : {&reduction.models, &reduction.scenes})
    for (const ReducedModel& model : *models) {
      const std::vector<double> worst = sampledWorst(scene, ranges, model, states);
      for (std::size_t i = 0; i < worst.size(); ++i) {
        const ReducedForce& force = model.forces[i];
        BOOST_TEST(worst[i] <= force.at_most + rounding(force),
                   "tau_" << i + 1 << " " << worst[i] << " " << force.at_most);
        BOOST_TEST(force.at_least <= force.at_most);
      }
      BOOST_TEST(model.share() <= model.allowed);
      BOOST_TEST(model.operations() <= reduction.full.bodyOperations().all());
    }
}

// what is written as a scene is the model: its own sweeps, read again, are the program
BOOST_DATA_TEST_CASE(a_reduced_scene_read_again_is_the_model,
                     data::make(std::vector<std::string>{"scara", "puma_560"}), name) {
  const scene::Scene whole = scene::findScene(name);
  for (const ReducedModel& model : reductionOf(name).scenes) {
    const scene::Scene again =
        scene::readSceneToml(scene::writeSceneToml(model.scene), "again.toml");
    const std::vector<double> worst = sampledWorst(again, scene::readEnvelope(whole), model, 1000);
    for (std::size_t i = 0; i < worst.size(); ++i)
      BOOST_TEST(worst[i] <= rounding(model.forces[i]), "tau_" << i + 1 << " " << worst[i]);
  }
}

// Armstrong, Khatib and Burdick (1986) left 305 of 1165 operations; 255 here, measured.
BOOST_AUTO_TEST_CASE(armstrongs_puma_takes_fewer_than_he_left) {
  scene::Scene scene = counted::armstrongsPuma();
  // Im of their table: at the joints, geared already
  const char* const rotors[] = {"1.14", "4.71", "0.827", "0.2", "0.179", "0.193"};
  for (std::size_t k = 0; k < 6; ++k)
    scene.mechanism.links[k + 1].joint.rotor_inertia = scene::Expression::parse(rotors[k]);
  const std::vector<scene::JointRanges> ranges = scene::readEnvelope(scene::findScene("puma_560"));
  ReduceOptions options;
  options.armstrong = 0.01;
  options.boxes = 2000;
  const Reduction reduction = reduced(scene, ranges, options, kNoStage);
  const ReducedModel& model = reduction.models.at(0);
  BOOST_TEST_MESSAGE(reductionText(scene, reduction));
  BOOST_TEST(model.operations() <= 255);
  BOOST_TEST(model.share() <= 0.01);
  const ReducedModel& rule = reduction.by_rule.at(0);
  const std::vector<double> worst = sampledWorst(scene, ranges, rule, 20000);
  for (std::size_t i = 0; i < worst.size(); ++i)
    BOOST_TEST(worst[i] <= rule.forces[i].at_most + rounding(rule.forces[i]));
}

BOOST_AUTO_TEST_CASE(what_cannot_be_reduced_is_refused_with_a_reason) {
  const scene::Scene arm = scene::findScene("planar_3r");
  refused([&] { reduced(arm, {}, {}, kNoStage); }, "no [envelope]");
  ReduceOptions fine;
  fine.allowed = {1e-16};
  refused([&] { reduced(arm, scene::readEnvelope(arm), fine, kNoStage); }, "roundings alone");
  scene::Scene rough = arm;
  rough.mechanism.links.back().joint.friction.positive = 1;
  refused([&] { reduced(rough, scene::readEnvelope(arm), {}, kNoStage); }, "Coulomb");
}
