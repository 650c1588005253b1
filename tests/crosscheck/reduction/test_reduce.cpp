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
#include "scene/work.hpp"
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

/// tau - reduced tau, and the tau of both.
template <typename T>
class Difference {
 public:
  template <typename Numbers>
  Difference(const scene::Scene& scene, const ReducedModel& reduced, const Numbers& numbers)
      : model_(recursive::buildModel(scene.mechanism, numbers)),
        ws_(model_),
        program_(reduced.program, numbers),
        tau_(static_cast<std::size_t>(model_.dof())) {}

  std::vector<T> at(const scene::State<T>& state) {
    recursive::inverseDynamics(model_, state.x, state.qd, state.qdd, ws_, tau_);
    std::vector<T> off = program_(state);
    for (std::size_t k = 0; k < tau_.size(); ++k) off[k] = tau_[k] - off[k];
    return off;
  }

 private:
  recursive::Model<T> model_;
  recursive::Workspace<T> ws_;
  symbolic::ProgramRun<T> program_;
  std::vector<T> tau_;
};

/** How far |tau - reduced tau| surely is above these limits at so many states, by joint; half of
    the states are at corners in qd and qdd, where errors are largest. What sweep and program lose
    in double is no allowance that was chosen: where the double is above its limit, both are asked
    again in RunningError, which has the same value and a proven bound of its rounding. */
std::vector<double> surelyAbove(const std::vector<double>& limits, const scene::Scene& scene,
                                const std::vector<scene::JointRanges>& ranges,
                                const ReducedModel& reduced, int states) {
  Difference<double> plain(scene, reduced, scene::RealNumbers<double>(scene.mechanism));
  Difference<RunningError> bounded(scene, reduced, RunningErrorNumbers(scene.mechanism));
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> share(0, 1);
  const auto draw = [&](const scene::Range& r, bool at_end) {
    const double s = share(random);
    return r.low + (at_end ? std::round(s) : s) * (r.high - r.low);
  };
  const std::size_t n = ranges.size();
  scene::State<double> state;
  scene::State<RunningError> same;
  state.x.resize(n);
  state.qd.resize(n);
  state.qdd.resize(n);
  std::vector<double> above(n);
  for (int s = 0; s < states; ++s) {
    same.x.clear();
    for (std::size_t k = 0; k < n; ++k) {
      const double q = draw(ranges[k].q, false);
      state.x[k] = scene::jointPosition(q);
      same.x.push_back(runningErrorPosition(q));
      state.qd[k] = draw(ranges[k].qd, s % 2 == 0);
      state.qdd[k] = draw(ranges[k].qdd, s % 2 == 0);
    }
    const std::vector<double> off = plain.at(state);
    bool is_above = false;
    for (std::size_t k = 0; k < n; ++k)
      is_above = is_above || std::abs(off[k]) > limits[k] + above[k];
    if (!is_above) continue;
    same.qd.assign(state.qd.begin(), state.qd.end());
    same.qdd.assign(state.qdd.begin(), state.qdd.end());
    const std::vector<RunningError> surely = bounded.at(same);
    for (std::size_t k = 0; k < n; ++k)
      above[k] = std::max(above[k], std::abs(surely[k].value()) - surely[k].bound() - limits[k]);
  }
  return above;
}

std::vector<double> certified(const ReducedModel& model) {
  std::vector<double> all;
  for (const ReducedForce& force : model.forces) all.push_back(force.at_most);
  return all;
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
      const std::vector<double> above = surelyAbove(certified(model), scene, ranges, model, states);
      for (std::size_t i = 0; i < above.size(); ++i)
        BOOST_TEST(above[i] == 0,
                   "tau_" << i + 1 << " " << above[i] << " above " << model.forces[i].at_most);
      for (const ReducedForce& force : model.forces) BOOST_TEST(force.at_least <= force.at_most);
      BOOST_TEST(model.share() <= model.allowed);
      BOOST_TEST(model.operations() <= reduction.full.bodyOperations().all());
    }
}

// what is written as a scene is the model: its own sweeps, read again, are the program
BOOST_AUTO_TEST_CASE(a_reduced_scene_read_again_is_the_model) {
  const scene::Scene whole = scene::findScene("puma_560");
  const std::vector<ReducedModel>& models = reductionOf("puma_560").scenes;
  BOOST_TEST(!models.back().parameters.empty());  // otherwise it is the scene itself
  for (const ReducedModel& model : models) {
    const scene::Scene again =
        scene::readSceneToml(scene::writeSceneToml(model.scene), "again.toml");
    const std::vector<double> zero(model.forces.size());
    const std::vector<double> above =
        surelyAbove(zero, again, scene::readEnvelope(whole), model, 1000);
    for (std::size_t i = 0; i < above.size(); ++i)
      BOOST_TEST(above[i] == 0, "tau_" << i + 1 << " " << above[i]);
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
  for (const double above : surelyAbove(certified(rule), scene, ranges, rule, 20000))
    BOOST_TEST(above == 0);
}

// What an end is told from: work that is done stays done, in the last stage most of it is.
BOOST_AUTO_TEST_CASE(the_share_that_is_done_only_grows) {
  const scene::Scene scene = scene::findScene("scara");
  ReduceOptions options;
  options.allowed = {0.01, 0.05};
  options.boxes = 2000;
  double before = 0, most_at_once = 0;
  reduced(scene, scene::readEnvelope(scene), options, [&](const std::string& what) {
    const double share = scene::seenWork().fraction;
    BOOST_TEST(share >= before, what << ": " << share << " after " << before);
    most_at_once = std::max(most_at_once, share - before);
    before = share;
  });
  BOOST_TEST(before > 0.9);
  BOOST_TEST(before < 1);
  BOOST_TEST(most_at_once < 0.15);  // 9 bases with terms share 80 %
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
