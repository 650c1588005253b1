// SPDX-License-Identifier: GPL-3.0-or-later
// Digits kept: what is counted, what is judged, and that planted errors show.
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE digits
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <limits>

#include "crosscheck/digits.hpp"
#include "crosscheck/tables.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
namespace data = boost::unit_test::data;

namespace {

/// The bundled scenes and those of the tables.
std::vector<std::string> sceneFiles() {
  std::vector<std::string> files;
  for (const auto& file : scene::bundledScenes()) files.push_back(file.string());
  for (const auto& table : bundledTables())
    if (const auto file = ownScene(table); !file.empty()) files.push_back(file.string());
  return files;
}

Options fewStates(int states) {
  Options options;
  options.states = states;
  return options;
}

WitnessKind kindNamed(const std::string& name) {
  return selectWitnesses({name}).front();
}

/// newton_euler whose answers at one state are spoiled.
class Spoiled : public Witness {
 public:
  using Spoil = std::function<void(Answer&)>;
  Spoiled(std::unique_ptr<Witness> inner, int state, Spoil spoil)
      : inner_(std::move(inner)), state_(state), spoil_(std::move(spoil)) {}
  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return quantity == Quantity::kTau; }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    Answer out = inner_->answer(quantity, state);
    if (asked_++ == state_) spoil_(out);
    return out;
  }

 private:
  std::string name_ = "spoiled";
  std::unique_ptr<Witness> inner_;
  int state_, asked_ = 0;
  Spoil spoil_;
};

/// The digits of tau of the PUMA 560 by a witness that is spoiled at state 3.
DigitsResult spoiledDigits(const Spoiled::Spoil& spoil) {
  const WitnessKind inner = kindNamed("newton_euler");
  WitnessKind kind = inner;
  kind.make = [&](const scene::Scene& scene) -> std::unique_ptr<Witness> {
    return std::make_unique<Spoiled>(inner.make(scene), 3, spoil);
  };
  const auto all = measureDigits(scene::findScene("puma_560"), {kind}, fewStates(10));
  return *std::find_if(all.begin(), all.end(), [](const DigitsResult& d) {
    return d.witness == "spoiled" && d.quantity == "tau";
  });
}

const DigitsResult& find(const std::vector<DigitsResult>& all, const std::string& witness,
                         const std::string& quantity, const std::string& scalar) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const DigitsResult& d) {
    return d.witness == witness && d.quantity == quantity && d.scalar == scalar;
  });
  BOOST_REQUIRE(found != all.end());
  return *found;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

BOOST_AUTO_TEST_CASE(scalars_keep_the_digits_that_their_mantissas_have_room_for) {
  // measured, median of 100 states: 6.8, 15.9, 18.9
  const auto all = measureDigits(scene::findScene("puma_560"), {kindNamed("newton_euler")}, {});
  const auto median = [&](const char* scalar) {
    return *find(all, "newton_euler", "tau", scalar).median;
  };
  BOOST_TEST(median("float") > 6);
  BOOST_TEST(median("float") < 8);
  BOOST_TEST(median("double") > 15);
  BOOST_TEST(median("double") < 17);
  BOOST_TEST(median("long double") > 18);
  BOOST_TEST(median("long double") < 20);
}

BOOST_AUTO_TEST_CASE(an_exact_answer_has_as_many_digits_as_its_scalar_has_room_for) {
  const auto all = measureDigits(scene::findScene("simple_pendulum"), {kindNamed("composite_body")},
                                 fewStates(5));
  BOOST_TEST(*find(all, "composite_body", "M", "float").worst == 9);
  BOOST_TEST(*find(all, "composite_body", "M", "double").worst == 17);
  BOOST_TEST(*find(all, "composite_body", "M", "long double").worst == 21);
}

BOOST_AUTO_TEST_CASE(a_quantity_that_is_zero_has_no_digits_and_is_judged_all_the_same) {
  const auto all =
      measureDigits(scene::findScene("simple_pendulum"), {kindNamed("newton_euler")}, fewStates(5));
  const DigitsResult& c = find(all, "newton_euler", "c", "double");
  BOOST_TEST(c.states == 0);
  BOOST_TEST(!c.worst.has_value());
  BOOST_TEST(!c.median.has_value());
  BOOST_TEST((c.verdict == Verdict::kAgree));
}

BOOST_AUTO_TEST_CASE(a_planted_error_of_1e_10_shows_as_ten_digits_at_its_joint_and_state) {
  const DigitsResult d =
      spoiledDigits([](Answer& a) { a.value(4, 0) += 1e-10 * a.value.cwiseAbs().maxCoeff(); });
  BOOST_TEST(*d.worst > 9.99);
  BOOST_TEST(*d.worst < 10.01);
  BOOST_TEST(d.worst_state == 3);
  BOOST_TEST(d.worst_entry == "tau[5]");
  BOOST_TEST(*d.median > 15);  // at the other nine states
  BOOST_REQUIRE((d.verdict == Verdict::kDisagree));
  BOOST_TEST(contains(d.reason, "tau[5] (joint 'joint_5')"), d.reason);
  BOOST_TEST(contains(d.reason, "at state 3"), d.reason);
  BOOST_TEST(*d.bound_ratio > 1000);
}

BOOST_AUTO_TEST_CASE(an_answer_beyond_its_bound_disagrees_however_small_the_error) {
  BOOST_TEST((spoiledDigits([](Answer& a) { a.bound *= 1; }).verdict == Verdict::kAgree));
  BOOST_TEST((spoiledDigits([](Answer& a) { a.bound *= 1e-3; }).verdict == Verdict::kDisagree));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

// Measured at 300 states of each scene: our sweeps and the program use at most 93 % of their
// bounds. An engine may refuse a scene that it cannot hold, but what it answers must lie within its
// bound too.
BOOST_DATA_TEST_CASE(every_witness_lies_within_its_bound, data::make(sceneFiles()), file) {
  const auto all = measureDigits(scene::findScene(file), selectWitnesses({}), fewStates(25));
  const std::vector<std::string> ours = {"lagrange", "newton_euler", "composite_body",
                                         "articulated_body"};
  int judged = 0;
  for (const DigitsResult& d : all) {
    BOOST_TEST(d.verdict.has_value() == (d.scalar == "double"));
    if (!d.verdict) continue;
    BOOST_TEST((d.verdict != Verdict::kDisagree),
               d.witness << " " << d.quantity << ": " << d.reason);
    if (std::count(ours.begin(), ours.end(), d.witness) == 0) continue;
    ++judged;
    BOOST_TEST((d.verdict == Verdict::kAgree), d.witness << " " << d.quantity << ": " << d.reason);
    BOOST_TEST(*d.bound_ratio <= 1);
    if (d.worst) BOOST_TEST(*d.worst <= *d.median);
  }
  BOOST_TEST(judged == 7 + 7 + 2 + 1);  // quantities that each of the four answers
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(an_answer_that_is_no_number_has_no_digits_and_disagrees) {
  const DigitsResult d =
      spoiledDigits([](Answer& a) { a.value(2, 0) = std::numeric_limits<double>::quiet_NaN(); });
  BOOST_TEST(*d.worst == 0);
  BOOST_TEST(d.worst_state == 3);
  BOOST_TEST((d.verdict == Verdict::kDisagree));
  BOOST_TEST(contains(d.reason, "tau[3] (joint 'joint_3')"), d.reason);
}

BOOST_AUTO_TEST_CASE(an_answer_of_another_shape_disagrees) {
  const DigitsResult d = spoiledDigits([](Answer& a) { a.value.conservativeResize(5, 1); });
  BOOST_TEST((d.verdict == Verdict::kDisagree));
  BOOST_TEST(contains(d.reason, "5 x 1 numbers at state 3, expected 6 x 1"), d.reason);
}

BOOST_AUTO_TEST_CASE(an_answer_without_a_finite_bound_cannot_be_judged) {
  const DigitsResult d =
      spoiledDigits([](Answer& a) { a.bound(0, 0) = std::numeric_limits<double>::infinity(); });
  BOOST_TEST((d.verdict == Verdict::kNotAnswerable));
  BOOST_TEST(contains(d.reason, "no error bound for tau[1] (joint 'joint_1') at state 3"),
             d.reason);
}

BOOST_AUTO_TEST_CASE(a_witness_that_throws_cannot_be_judged) {
  const DigitsResult d =
      spoiledDigits([](Answer&) { throw std::runtime_error("out of patience"); });
  BOOST_TEST((d.verdict == Verdict::kNotAnswerable));
  BOOST_TEST(d.reason == "state 3: out of patience");
  BOOST_TEST(d.states == 9);
}

BOOST_AUTO_TEST_CASE(without_a_truth_there_are_no_digits_and_the_reason_is_passed_on) {
  scene::Scene scene = scene::findScene("double_pendulum");
  scene.mechanism.links[2].inertia = {};  // a massless tip: M is singular
  const auto all = measureDigits(scene, {kindNamed("articulated_body")}, fewStates(3));
  const DigitsResult& qdd = find(all, "articulated_body", "qdd", "double");
  BOOST_TEST(qdd.states == 0);
  BOOST_TEST((qdd.verdict == Verdict::kNotAnswerable));
  BOOST_TEST(contains(qdd.reason, "no certified truth: M is singular: joint 'elbow'"), qdd.reason);
}

BOOST_AUTO_TEST_SUITE_END()
