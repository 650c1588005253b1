// SPDX-License-Identifier: GPL-3.0-or-later
// Word lengths: the ranges hold at states of the program in double, the compiled whole numbers stay
// within what is certified, and too few bits are seen.
#include "crosscheck/reduction/fixed_point.hpp"

#include <cmath>
#include <random>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "scene/numbers.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

const auto kNoStage = [](const std::string&) {};

const char* const kSlide = R"(
gravity = [0, 0, -9.75]
[[link]]
name = "base"
[[link]]
name = "block"
parent = "base"
mass = 2
[link.joint]
name = "rail"
kind = "prismatic"
[envelope]
rail = { q = [0, 1], qd = [-1, 1], qdd = [-3, 3] }
)";

/// The program in numbers that are rounded to the signals' units, in long double: its 64 bits hold
/// every product of 63 exactly. By slot.
std::vector<long double> inUnits(const FixedPoint& fixed,
                                 const symbolic::ProgramRun<double>& exact) {
  using Code = symbolic::Program::Code;
  std::vector<long double> out(fixed.signals.size());
  const auto rounded = [&](int slot, long double x) {
    const int fraction = fixed.signals[static_cast<std::size_t>(slot)].fraction;
    out[static_cast<std::size_t>(slot)] =
        std::ldexp(std::floor(std::ldexp(x, fraction) + 0.5L), -fraction);
  };
  for (std::size_t s = 0; s < out.size(); ++s)
    if (fixed.signals[s].kind != FixedSignal::Kind::kResult)
      rounded(static_cast<int>(s), static_cast<long double>(exact.slot(static_cast<int>(s))));
  for (const auto& i : fixed.program.body) {
    const long double a = out[static_cast<std::size_t>(i.a)],
                      b = out[static_cast<std::size_t>(i.b)];
    rounded(i.result, i.code == Code::kNegate     ? -a
                      : i.code == Code::kMultiply ? a * b
                      : i.code == Code::kAdd      ? a + b
                                                  : a - b);
  }
  return out;
}

FixedPoint fixedPointOf(const std::string& name, double error) {
  const scene::Scene scene = scene::findScene(name);
  return fixedPoint(scene, scene::readEnvelope(scene), error, kNoStage);
}

}  // namespace

// By hand: tau = 2 qdd + 19.5 is from 13.5 to 25.5, five bits before the point; 2 and 19.5 are
// whole halves, so that nothing is rounded but qdd, to half a unit, and tau: 2 / 2 units of qdd and
// half a unit of tau.
BOOST_AUTO_TEST_CASE(a_slide_by_hand) {
  const scene::Scene scene = scene::readSceneToml(kSlide, "slide.toml");
  const FixedPoint fixed = fixedPoint(scene, scene::envelopeOf(kSlide, scene), 0.01, kNoStage);
  BOOST_TEST_MESSAGE(fixedPointText(scene, fixed) << fixed.code);
  const auto& load = fixed.program.loads.at(0);
  BOOST_TEST(fixed.program.loads.size() == 1U);
  const FixedSignal& qdd = fixed.signals[static_cast<std::size_t>(load.slot)];
  const FixedSignal& tau = fixed.signals[static_cast<std::size_t>(fixed.program.outputs.at(0))];
  BOOST_TEST(qdd.integer == 2);
  BOOST_TEST(tau.integer == 5);
  BOOST_TEST(std::abs(tau.low - 13.5) <= 1e-12);
  BOOST_TEST(std::abs(tau.high - 25.5) <= 1e-12);
  const FixedForce& force = fixed.forces.at(0);
  BOOST_TEST(force.certified <= 0.01);
  const double by_hand = std::ldexp(1, -qdd.fraction) + std::ldexp(0.5, -tau.fraction);
  BOOST_TEST(std::abs(force.certified - by_hand) <= 1e-12);
  BOOST_TEST(force.measured <= force.certified);
  // at 100000 random states the largest rounding is nearly reached
  BOOST_TEST(force.measured >= 0.9 * std::ldexp(1, -qdd.fraction));
}

BOOST_DATA_TEST_CASE(whole_numbers_stay_within_what_is_certified_and_with_eight_bits_less_do_not,
                     data::make(std::vector<std::string>{"planar_3r", "scara", "puma_560"}), name) {
  const scene::Scene scene = scene::findScene(name);
  FixedPoint fixed = fixedPointOf(name, 1e-3);
  BOOST_TEST_MESSAGE(fixedPointText(scene, fixed));
  BOOST_TEST(fixed.states == 100000);
  BOOST_TEST(fixed.isKept());
  for (const FixedForce& force : fixed.forces) {
    BOOST_TEST(force.certified <= 1e-3);
    BOOST_TEST(force.measured <= force.certified);
  }
  BOOST_TEST(fixed.widestProduct() <= 63);

  // every signal of the program in double is where it was said to be, and in whole numbers as near
  // to it; what double itself is off is below 1e-12, where units are above 2^-30
  std::vector<double> nearest(fixed.signals.size(), 0);
  symbolic::ProgramRun<double> run(fixed.program, scene::RealNumbers<double>(scene.mechanism));
  const auto ranges = scene::readEnvelope(scene);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  for (int s = 0; s < 2000; ++s) {
    scene::State<double> state;
    const auto draw = [&](const scene::Range& r) {
      return r.low + share(random) * (r.high - r.low);
    };
    for (const auto& r : ranges) {
      state.x.push_back(scene::jointPosition(draw(r.q)));
      state.qd.push_back(draw(r.qd));
      state.qdd.push_back(draw(r.qdd));
    }
    run(state);
    for (std::size_t k = 0; k < fixed.signals.size(); ++k) {
      const FixedSignal& signal = fixed.signals[k];
      const double x = run.slot(static_cast<int>(k));
      BOOST_REQUIRE_MESSAGE(x >= signal.low && x <= signal.high, signal.name << " = " << x);
    }
    const std::vector<long double> rounded = inUnits(fixed, run);
    for (std::size_t k = 0; k < rounded.size(); ++k)
      nearest[k] = std::max(
          nearest[k], static_cast<double>(std::abs(rounded[k] - run.slot(static_cast<int>(k)))));
  }

  for (std::size_t k = 0; k < nearest.size(); ++k)
    BOOST_TEST(nearest[k] <= fixed.signals[k].error + 1e-12, fixed.signals[k].name);

  // all signals with eight bits less behind the point: what is certified is no more true (certified
  // is some 20 times what is measured on puma_560, which eight bits less make 256 times as large)
  FixedPoint poor = fixed;
  for (FixedSignal& signal : poor.signals) signal.fraction -= 8;
  for (FixedForce& force : poor.forces) force.measured = 0;
  poor.code = fixedPointC(scene, poor);
  runFixedPoint(scene, ranges, &poor);
  for (std::size_t i = 0; i < poor.forces.size(); ++i)
    BOOST_TEST(poor.forces[i].measured > fixed.forces[i].certified);
}

BOOST_AUTO_TEST_CASE(what_no_word_holds_is_refused) {
  const auto refused = [](const std::string& name, double error, const std::string& reason) {
    BOOST_CHECK_EXCEPTION(fixedPointOf(name, error), scene::InputError,
                          [&](const scene::InputError& e) {
                            BOOST_TEST_MESSAGE(e.what());
                            return std::string(e.what()).find(reason) != std::string::npos;
                          });
  };
  refused("puma_560", 1e-12, "allowed: up to 63");
  refused("acrobot", 1e-3, "no [envelope]");
}
