// SPDX-License-Identifier: GPL-3.0-or-later
// No kind of check is vacuous: a fault is planted for each kind that a report can hold, and that
// kind turns red. A new kind without a plant here fails the last test.
#include <stdlib.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <set>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <nlohmann/json.hpp>

#include "crosscheck/conductor/crosscheck.hpp"
#include "crosscheck/exact/derivative_checks.hpp"
#include "crosscheck/exact/exact.hpp"
#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/exact/regressor_checks.hpp"
#include "crosscheck/exact/second_derivative_checks.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/laws/compiled_identities.hpp"
#include "crosscheck/laws/point_laws.hpp"
#include "crosscheck/motion/drift.hpp"
#include "crosscheck/verdicts/check_derivatives.hpp"
#include "crosscheck/verdicts/check_drift.hpp"
#include "crosscheck/verdicts/check_identities.hpp"
#include "crosscheck/verdicts/check_mechanism.hpp"
#include "crosscheck/verdicts/check_reading.hpp"
#include "crosscheck/verdicts/check_second_derivatives.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/digits.hpp"
#include "crosscheck/verdicts/identity_tallies.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/tables.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "tests/crosscheck/conductor/faulty_field.hpp"
#include "tests/fixtures/other_arms.hpp"
#include "tests/fixtures/wrong_roads.hpp"

namespace data = boost::unit_test::data;
namespace fs = std::filesystem;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using fixtures::Faulty;
using fixtures::FaultyNumbers;
using fixtures::times;

namespace {

/// A kind: the name of the check and its quantity, where the name alone is that of several.
std::string kindOf(const CheckResult& check) {
  static const std::set<std::string> kSeveral = {
      "closures", "closed loops", "hybrid dynamics", "least constraint", "same", "truth", "table"};
  return kSeveral.count(check.name()) > 0 ? check.name() + ": " + check.quantity : check.name();
}

/// The kinds of which a check disagrees.
std::set<std::string> red(const std::vector<CheckResult>& checks) {
  std::set<std::string> kinds;
  for (const CheckResult& check : checks)
    if (check.verdict == Verdict::kDisagree) kinds.insert(kindOf(check));
  return kinds;
}
void add(std::set<std::string>& all, const std::set<std::string>& more) {
  all.insert(more.begin(), more.end());
}

Options few(int states) {
  Options options;
  options.states = states;
  options.drift = false;
  return options;
}

// ---- plants
// -----------------------------------------------------------------------------------------

/// A witness that is off by one part in a million in everything.
class Off : public Witness {
 public:
  explicit Off(const scene::Scene& scene)
      : inverse_(newtonEulerKind().make(scene).value()),
        forward_(articulatedBodyKind().make(scene).value()) {}
  const std::string& name() const override { return name_; }
  bool answers(Quantity) const override { return true; }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    Answer out = (quantity == Quantity::kQdd ? forward_ : inverse_)->answer(quantity, state);
    out.value *= 1 + 1e-6;
    return out;
  }

 private:
  std::string name_ = "off";
  std::unique_ptr<Witness> inverse_, forward_;
};

WitnessKind offKind() {
  return {{"off", "1", "off by 1e-6"}, [](const PreparedScene& scene) -> MadeWitness {
            return std::make_unique<Off>(scene.scene());
          }};
}

std::set<std::string> redByAWitnessThatIsOff() {
  const scene::Scene scene = scene::findScene("puma_560");
  std::vector<WitnessKind> kinds = selectWitnesses({"newton_euler", "composite_body"});
  kinds.push_back(offKind());
  std::set<std::string> kinds_red = red(compareWitnesses(scene, kinds, few(2)));
  add(kinds_red, red(measureDigits(scene, kinds, few(2)).checks));
  for (const fs::path& table : bundledTables()) {
    const fs::path own = ownScene(table);
    const std::string about = nlohmann::json::parse(std::ifstream(table)).value("scene", "");
    if (own.empty() && about == "simple_pendulum") continue;  // its period
    const scene::Scene asked = own.empty() ? scene::findScene(about) : scene::readScene(own);
    add(kinds_red, red(compareWithTable(table, asked, {offKind()})));
  }
  return kinds_red;
}

/// The printed period off in its third digit. (No witness answers it: a motion is simulated.)
std::set<std::string> redByAWrongPeriod() {
  std::string pattern = (fs::temp_directory_path() / "dynwitness-kinds-XXXXXX").string();
  BOOST_REQUIRE(::mkdtemp(pattern.data()) != nullptr);
  nlohmann::json table = nlohmann::json::parse(
      std::ifstream(scene::dataFolder() / "reference/simple_pendulum_period.json"));
  nlohmann::json& printed = table["cases"].back()["expect"]["period_ratio"][0];
  std::string text = printed.get<std::string>();
  char& third = text[3];
  third = third == '5' ? '6' : '5';
  printed = text;
  const fs::path copy = fs::path(pattern) / "table.json";
  std::ofstream(copy) << table.dump();
  const std::set<std::string> kinds = red(compareWithTable(
      copy, scene::findScene("simple_pendulum"), selectWitnesses({"articulated_body"})));
  fs::remove_all(pattern);
  return kinds;
}

std::set<std::string> redByANegativeMass() {
  scene::Scene scene = scene::findScene("double_pendulum");
  for (scene::Link& link : scene.mechanism.links)
    for (scene::Number* number :
         {&link.inertia.mass, &link.inertia.xx, &link.inertia.yy, &link.inertia.zz})
      *number = times(*number, "(-1)");
  return red(checkIdentities(scene, few(2)));
}

/// A scene that its file does not say.
std::set<std::string> redByAnotherReading() {
  scene::Scene scene = scene::findScene("puma_560");
  for (scene::Link& link : scene.mechanism.links)
    link.joint.placement.alpha = times(link.joint.placement.alpha, "(-1)");
  return red(checkReading(scene, 1));
}

/// A motion in which gravity pulls upwards, with the energy of one in which it pulls down.
std::set<std::string> redByAWrongMotion() {
  const scene::Scene scene = scene::findScene("double_pendulum");
  scene::Mechanism wrong = scene.mechanism;
  for (scene::Number& g : wrong.gravity) g = times(g, "(-1)");
  DriftOptions options;
  options.duration = 1;
  options.moved_by = &wrong;
  return red({checkDrift(scene, measureDrift(scene, options), options)});
}

// Faults in the derivation that the sweeps are compared with: a mass, and a length.
std::set<std::string> redByAnotherDerivation(const std::string& name) {
  const scene::Scene scene = scene::findScene(name);
  scene::Mechanism mass = scene.mechanism, length = scene.mechanism;
  for (scene::Link& link : mass.links)
    for (scene::Number* number :
         {&link.inertia.mass, &link.inertia.xx, &link.inertia.yy, &link.inertia.zz})
      if (!number->isLiteralZero()) *number = times(*number, "(1 + 1e-18)");
  for (scene::Spring& spring : mass.springs)
    spring.a.xyz[0] = times(spring.a.xyz[0], "(1 + 1e-18)");
  for (scene::Link& link : length.links)
    link.joint.placement.xyz[0] = times(link.joint.placement.xyz[0], "1 + 1e-18");
  for (scene::Closure& closure : length.closures)
    closure.b.xyz[0] = times(closure.b.xyz[0], "1 + 1e-18");
  std::set<std::string> kinds = red(checkConstrainedExactly(scene, {}, &mass));
  add(kinds, red(checkClosuresExactly(scene, {}, &length)));
  add(kinds, red(checkRegressorExactly(scene, {}, &length)));
  return kinds;
}

/// Derivatives: what Lagrange's are derived from, and what is answered in double, of another mass
/// and of other lengths.
std::set<std::string> redByOtherDerivatives() {
  const scene::Scene scene = scene::findScene("puma_560");
  scene::Scene mass = scene, length = scene;
  for (scene::Link& link : mass.mechanism.links)
    link.inertia.mass = times(link.inertia.mass, "(1 + 1e-6)");
  length.mechanism = fixtures::withLengthsTimes(length.mechanism, "(1 + 1e-6)");
  std::set<std::string> kinds;
  for (const scene::Scene* wrong : {&mass, &length}) {
    const PreparedScene answering(*wrong);
    add(kinds, red(checkDerivativesExactly(scene, {}, &wrong->mechanism)));
    add(kinds, red(checkDerivatives(scene, few(1), &answering)));
    add(kinds, red(checkSecondDerivativesExactly(scene, {}, &wrong->mechanism)));
    add(kinds, red(checkSecondDerivatives(scene, few(1), &answering)));
  }
  return kinds;
}

/// A road of the whole mechanism that goes wrong.
std::set<std::string> redByAWrongRoad(const std::string& name) {
  const PreparedScene scene(scene::findScene(name));
  std::set<std::string> kinds;
  for (const fixtures::MechanismFault fault : fixtures::kMechanismFaults)
    if (fixtures::has(scene.mechanism(), fault))
      add(kinds, red(compareRoads(scene, fixtures::withAWrongRoad(scene, fault), few(2))));
  return kinds;
}

// ---- the identities, with one operation that goes wrong (faulty_field.hpp)
// -----------------------------------------------

/// The identities with operation number `wrong` of their evaluation gone wrong (-1: none), decided
/// as in a run.
std::vector<CheckResult> decidedWithAFault(const scene::Scene& scene, long wrong,
                                           long* operations) {
  Inquiry inquiry = identityInquiry(scene.mechanism);
  inquiry.ask = [&scene, wrong, operations, honest = inquiry.ask](
                    const FieldNumbers& number, const scene::State<PrimeField>& state,
                    const std::vector<char>& wanted) {
    if (PrimeField::isSized()) return honest(number, state, wanted);
    Faulty::wrong = -1;
    const FaultyNumbers numbers(number);
    SweptMechanism<Faulty> swept(scene.mechanism, numbers);
    scene::State<Faulty> at;
    for (const auto& x : state.x) at.x.push_back({x.q, x.c, x.s});
    at.qd.assign(state.qd.begin(), state.qd.end());
    at.qdd.assign(state.qdd.begin(), state.qdd.end());
    at.tau.assign(state.tau.begin(), state.tau.end());
    Faulty::done = 0;
    Faulty::wrong = wrong;
    SidesOfAll all;
    const auto inner = [](const Faulty& x) { return x.inner(); };
    for (const TwoSides<Faulty>& law : Identities::sides(scene.mechanism, swept.at(at)))
      all.push_back({law.left.unaryExpr(inner), law.right.unaryExpr(inner), law.failure});
    *operations = Faulty::done;
    return all;
  };
  ExactOptions options;
  options.error_probability = 0.5;  // one point
  return decide(scene, inquiry, options);
}

/// A law that is the same computation on both sides stays green whichever operation fails.
std::set<std::string> redByAFaultyOperation(const std::string& name) {
  const scene::Scene scene = scene::findScene(name);
  long operations = 0;
  for (const CheckResult& check : decidedWithAFault(scene, -1, &operations))
    BOOST_TEST((check.verdict != Verdict::kDisagree), check.name() << ": " << check.reason);
  std::set<std::string> kinds;
  constexpr long kFaults = 300;
  for (long k = 0; k < kFaults; ++k) {
    long ignored = 0;
    add(kinds, red(decidedWithAFault(scene, (2 * k + 1) * operations / (2 * kFaults), &ignored)));
  }
  return kinds;
}

/// In double: one entry of one side off by more than its bounds, law by law.
std::set<std::string> redByASideThatIsOff() {
  const scene::Scene scene = scene::findScene("puma_560");
  SweptMechanism<RunningError> swept(scene.mechanism, RunningErrorNumbers(scene.mechanism));
  const auto sides = Identities::sides(
      scene.mechanism, swept.at(runningErrorState(drawState(scene.mechanism, scene.name, 1, 0))));
  std::set<std::string> kinds;
  for (std::size_t law = 0; law < sides.size(); ++law) {
    auto spoiled = sides;
    auto& left = spoiled[law].left;
    RunningError& last = left(left.rows() - 1, left.cols() - 1);
    double largest = 1e-300;
    for (const RunningError& x : left.reshaped()) largest = std::max(largest, std::abs(x.value()));
    last = RunningError(last.value() + 1e-6 * largest, last.bound());
    IdentityTallies tallies(Identities::words(scene.mechanism), 1);
    tallies.add(0, spoiled, [](int) { return std::string(); });
    const std::set<std::string> now = red(tallies.results());
    BOOST_TEST(now.size() == 1u);  // this law, and no other
    add(kinds, now);
  }
  return kinds;
}

/// Of a point, by both roads: one number of the sweep's off, and then one of its Jacobian.
std::set<std::string> redByAPointThatIsOff() {
  const scene::Scene scene = scene::findScene("puma_560");
  const RunningErrorNumbers number(scene.mechanism);
  const PointOfMechanism<RunningError> right(
      scene.mechanism, recursive::buildModel(scene.mechanism, number), number,
      runningErrorState(drawState(scene.mechanism, scene.name, 1, 0)));
  const auto told = [&](const PointOfMechanism<RunningError>& point) {
    IdentityTallies tallies(PointLaws::words(scene.mechanism), 1);
    tallies.add(0, PointLaws::sides(scene.mechanism, point), [](int) { return std::string(); });
    return red(tallies.results());
  };
  BOOST_TEST(told(right).empty());
  const RunningError off(1e-9);
  std::set<std::string> kinds;
  auto wrong = right;
  wrong.swept.position(2) += off;
  add(kinds, told(wrong));
  BOOST_TEST(kinds.size() == 1u);
  wrong = right;
  wrong.swept.J_rate(5, 2) += off;
  add(kinds, told(wrong));
  BOOST_TEST(kinds.size() == 3u);
  wrong = right;
  wrong.swept.acceleration.angular(0) += off;
  add(kinds, told(wrong));
  return kinds;
}

/// The kinds that a report of all bundled scenes and of those of the tables holds.
std::set<std::string> kindsOfReports() {
  std::vector<scene::Scene> scenes;
  for (const auto& file : scene::bundledScenes()) scenes.push_back(scene::readScene(file));
  for (const fs::path& table : bundledTables())
    if (const fs::path own = ownScene(table); !own.empty()) scenes.push_back(scene::readScene(own));
  std::set<std::string> kinds;
  const std::vector<WitnessKind> witnesses =
      selectWitnesses({"newton_euler", "composite_body", "articulated_body"});
  for (const scene::Scene& scene : scenes) {
    Options options = few(1);
    options.error_probability = 0.5;
    options.drift = scene.name == "simple_pendulum";
    for (const CheckResult& check : crosscheckScene(scene, witnesses, options).checks)
      if (check.verdict != Verdict::kNotAnswerable)  // a refusal has no verdict to miss
        kinds.insert(kindOf(check));
  }
  return kinds;
}

void requireAll(const std::set<std::string>& red, const std::set<std::string>& expected) {
  for (const std::string& kind : expected)
    BOOST_TEST(red.count(kind) == 1u, kind << " stays green");
}

std::set<std::string> allIdentities() {
  std::set<std::string> names;
  for (const LawWords& law : Identities::words()) names.insert(law.name);
  return names;
}

}  // namespace

BOOST_AUTO_TEST_CASE(every_identity_is_red_when_one_operation_goes_wrong) {
  std::set<std::string> red;
  for (const char* name : {"modern_robotics_3link", "prismatic_revolute_mix"})
    add(red, redByAFaultyOperation(name));
  requireAll(red, allIdentities());
}

BOOST_AUTO_TEST_CASE(every_identity_in_double_is_red_when_a_side_is_off) {
  requireAll(redByASideThatIsOff(), allIdentities());
}

BOOST_AUTO_TEST_CASE(every_kind_of_check_that_a_report_holds_has_a_plant_that_turns_it_red) {
  std::set<std::string> red = redByAWitnessThatIsOff();
  add(red, redByAWrongPeriod());
  add(red, redByANegativeMass());
  add(red, redByAnotherReading());
  add(red, redByAWrongMotion());
  add(red, redByASideThatIsOff());
  add(red, redByAPointThatIsOff());
  add(red, redByOtherDerivatives());
  for (const char* name :
       {"car_axis", "andrews_squeezer", "two_handed", "satellite_held", "puma_560"})
    add(red, redByAnotherDerivation(name));
  for (const char* name : {"car_axis", "two_handed"}) add(red, redByAWrongRoad(name));
  const std::set<std::string> kinds = kindsOfReports();
  BOOST_TEST(kinds.size() >= 40u);
  requireAll(red, kinds);
}
