// SPDX-License-Identifier: GPL-3.0-or-later
// The judge is judged: faults planted into what draws states, compares entries and bounds errors
// must not leave a run that says "all agree". Each test here fails with one of them in place.
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include <fmt/format.h>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <nlohmann/json.hpp>

#include "crosscheck/conductor/crosscheck.hpp"
#include "crosscheck/exact/exact.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/control.hpp"
#include "crosscheck/verdicts/digits.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/tables.hpp"
#include "crosscheck/witnesses/all_lanes.hpp"
#include "crosscheck/witnesses/exact_sweeps.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

namespace data = boost::unit_test::data;
namespace fs = std::filesystem;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using nlohmann::json;

namespace {

Options few(int states) {
  Options options;
  options.states = states;
  options.drift = false;
  return options;
}

std::vector<std::string> tables() {
  std::vector<std::string> files;
  for (const fs::path& table : bundledTables()) files.push_back(table.string());
  return files;
}

}  // namespace

// ---- states
// ---------------------------------------------------------------------------------------

BOOST_AUTO_TEST_SUITE(states)

/// Whether numbers drawn from [-reach, reach) look like it: 200 uniform ones leave one of the outer
/// fifths empty with a chance of 2 0.8^200 = 1e-19.
void requireSpread(const std::vector<double>& drawn, double reach, const std::string& what) {
  BOOST_TEST(*std::min_element(drawn.begin(), drawn.end()) < -0.6 * reach, what);
  BOOST_TEST(*std::max_element(drawn.begin(), drawn.end()) > 0.6 * reach, what);
  BOOST_TEST(std::set<double>(drawn.begin(), drawn.end()).size() == drawn.size(), what);
}

BOOST_DATA_TEST_CASE(positions_rates_and_forces_fill_their_ranges,
                     data::make({"puma_560", "prismatic_revolute_mix", "humanoid_floating"}),
                     name) {
  const scene::Scene scene = scene::findScene(name);
  std::map<std::string, std::vector<double>> drawn;
  for (int k = 0; k < 200; ++k) {
    const scene::State<double> state = drawState(scene.mechanism, scene.name, 1, k);
    for (std::size_t i = 0; i < state.qd.size(); ++i) {
      drawn[fmt::format("qd {}", i)].push_back(state.qd[i] / 3);
      drawn[fmt::format("qdd {}", i)].push_back(state.qdd[i] / 10);
      drawn[fmt::format("tau {}", i)].push_back(state.tau[i] / 10);
    }
    const std::vector<scene::SlotKind> slots = scene.mechanism.slots();
    for (std::size_t i = 0; i < slots.size(); ++i)
      if (slots[i] != scene::SlotKind::kQuaternion)
        drawn[fmt::format("q {}", i)].push_back(
            state.x[i].q / (slots[i] == scene::SlotKind::kAngle ? 3.141592653589793 : 1));
  }
  for (const auto& [what, numbers] : drawn) requireSpread(numbers, 1, what);
}

BOOST_AUTO_TEST_CASE(quaternions_point_everywhere_and_are_not_of_unit_length) {
  const scene::Scene scene = scene::findScene("humanoid_floating");
  const std::vector<scene::SlotKind> slots = scene.mechanism.slots();
  const auto at =
      std::find(slots.begin(), slots.end(), scene::SlotKind::kQuaternion) - slots.begin();
  std::vector<double> component[4], length;
  for (int k = 0; k < 200; ++k) {
    const scene::State<double> state = drawState(scene.mechanism, scene.name, 1, k);
    double length2 = 0;
    for (int i = 0; i < 4; ++i) {
      component[i].push_back(state.x[at + i].q);
      length2 += component[i].back() * component[i].back();
    }
    length.push_back(std::sqrt(length2));
  }
  for (int i = 0; i < 4; ++i) requireSpread(component[i], 0.8, fmt::format("component {}", i));
  BOOST_TEST(*std::min_element(length.begin(), length.end()) < 0.7);
  BOOST_TEST(*std::max_element(length.begin(), length.end()) > 0.9);
}

BOOST_AUTO_TEST_SUITE_END()

// ---- every entry of every state
// -------------------------------------------------------------------

BOOST_AUTO_TEST_SUITE(entries)

/// newton_euler, one entry of M at one state off by 1e-9 of the largest.
class OffInOneEntry : public Witness {
 public:
  OffInOneEntry(const scene::Scene& scene, int i, int j, int state)
      : honest_(newtonEulerKind().make(scene).value()), i_(i), j_(j), state_(state) {}
  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return quantity == Quantity::kM; }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    Answer out = honest_->answer(quantity, state);
    if (asked_++ == state_) out.value(i_, j_) += 1e-9 * out.value.cwiseAbs().maxCoeff();
    return out;
  }

 private:
  std::string name_ = "off";
  std::unique_ptr<Witness> honest_;
  int i_, j_, state_, asked_ = 0;
};

WitnessKind off(int i, int j, int state) {
  return {{"off", "1", "off in one entry"}, [=](const PreparedScene& scene) -> MadeWitness {
            return std::make_unique<OffInOneEntry>(scene.scene(), i, j, state);
          }};
}

constexpr int kStates = 4;

BOOST_DATA_TEST_CASE(a_fault_in_one_entry_of_one_state_is_found_by_pairs_and_truth,
                     data::xrange(9) * data::xrange(kStates), entry, state) {
  const scene::Scene scene = scene::findScene("modern_robotics_3link");
  const int i = entry / 3, j = entry % 3;
  const std::string where = fmt::format("M[{},{}]", i + 1, j + 1);
  std::vector<WitnessKind> kinds = selectWitnesses({"composite_body"});
  kinds.push_back(off(i, j, state));
  std::vector<CheckResult> checks = compareWitnesses(scene, kinds, few(kStates));
  for (const CheckResult& check : measureDigits(scene, kinds, few(kStates)).checks)
    checks.push_back(check);
  int found = 0;
  for (const CheckResult& check : checks) {
    BOOST_TEST(check.states == kStates);
    const bool is_ours = check.left == "off" || check.right == "off";
    BOOST_TEST((check.verdict == (is_ours ? Verdict::kDisagree : Verdict::kAgree)), check.reason);
    if (!is_ours) continue;
    ++found;
    BOOST_TEST(check.worst_entry == where);
    BOOST_TEST(check.worst_state == state);
  }
  BOOST_TEST(found == 2);
}

/// Composite bodies over the field, one entry of M at one point off by one.
ExactWitness offInField(const scene::Scene& scene, int i, int j, int point) {
  ExactWitness witness = sweepWitness<CompositeBody>(scene, [](auto&, const auto&) {});
  witness.name = "off";
  const auto points = std::make_shared<int>(0);
  witness.in_field = [=, honest = witness.in_field](const FieldNumbers& number) {
    const int here = PrimeField::isSized() ? -1 : (*points)++;
    return [=, answer = honest(number)](Quantity quantity, const scene::State<PrimeField>& state) {
      MatrixX<PrimeField> value = answer(quantity, state);
      if (here == point && quantity == Quantity::kM) value(i, j) += PrimeField(1);
      return value;
    };
  };
  return witness;
}

BOOST_DATA_TEST_CASE(a_fault_in_one_entry_of_one_point_is_found_over_the_field,
                     data::xrange(9) * data::xrange(2), entry, point) {
  const scene::Scene scene = scene::findScene("modern_robotics_3link");
  const int i = entry / 3, j = entry % 3;
  const std::vector<ExactWitness> witnesses = {
      sweepWitness<NewtonEuler>(scene, [](auto&, const auto&) {}), offInField(scene, i, j, point)};
  ExactOptions options;
  options.error_probability = 1e-30;  // two points
  const std::vector<CheckResult> checks = compareExactly(scene, witnesses, options);
  BOOST_TEST_REQUIRE(checks.size() == 1u);
  BOOST_TEST((checks[0].verdict == Verdict::kDisagree));
  BOOST_TEST(checks[0].worst_entry == fmt::format("M[{},{}]", i + 1, j + 1));
}

/// What a kernel might do: three outputs, the third of which is wrong in one lane.
BOOST_DATA_TEST_CASE(a_fault_in_one_lane_is_found, data::xrange(9), wrong_lane) {
  constexpr std::size_t kLanes = 4, kOutputs = 3;  // two blocks and a rest: nine states
  const auto kernel = [&](int wrong) {
    return [wrong](const double* q, const double* qd, const double* w, double* out, long count) {
      for (long k = 0; k < count; ++k) {
        out[k] = q[k] + qd[k];
        out[count + k] = qd[count + k] * w[k];
        out[2 * count + k] = w[count + k] + (k == wrong ? 1e-9 : 0);
      }
    };
  };
  const std::vector<double> q = {0.1, 0.2}, qd = {1, 2}, w = {-3, 5};
  const std::vector<double> right = {0.1 + 1, 2.0 * -3, 5},
                            none = askAllLanes(kernel(-1), kLanes, kOutputs, q, qd, w);
  BOOST_TEST(none == right);
  const std::vector<double> said = askAllLanes(kernel(wrong_lane), kLanes, kOutputs, q, qd, w);
  BOOST_TEST(said[0] == right[0]);
  BOOST_TEST(said[1] == right[1]);
  BOOST_TEST(std::isnan(said[2]));
}

BOOST_AUTO_TEST_SUITE_END()

// ---- tables
// ---------------------------------------------------------------------------------------

BOOST_AUTO_TEST_SUITE(printed_tables)

/// A printed number three units further in its last digit: "0.25" is "0.28", and "0.29" is "0.26".
std::string threeUnitsOff(std::string text) {
  const std::size_t end = std::min(text.find_first_of("eE"), text.size());
  char& last = text[text.find_last_of("0123456789", end - 1)];
  last = static_cast<char>(last <= '6' ? last + 3 : last - 3);
  return text;
}

/// The number off by what the table's own words forbid: a changed text, or none for zeros and
/// expressions.
std::string changed(const json& table, const json& one_case, const std::string& quantity,
                    const std::string& text) {
  if (text.find_first_not_of("+-.0123456789eE") != std::string::npos) return {};
  const double value = std::stod(text);
  if (value == 0) return {};
  const auto stated = [&](const char* key) {
    return one_case.contains(key) && one_case[key].contains(quantity)
               ? one_case[key][quantity].get<int>()
               : -1;
  };
  if (table.contains("accuracy") && table["accuracy"].contains(quantity))
    return fmt::format("{:.17g}",
                       value + 3 * std::stod(table["accuracy"][quantity].get<std::string>()));
  if (stated("digits") >= 0)
    return fmt::format("{:.17g}", value + 3 * std::pow(10.0, -stated("digits")));
  if (stated("significant") > 0)
    return fmt::format("{:.17g}", value * (1 + 3 * std::pow(10.0, 1 - stated("significant"))));
  if (one_case.value("computed_digits", table.value("computed_digits", false)))
    return fmt::format("{:.17g}", value * (1 + 1e-9));  // to the last bits, but for what cancels
  return threeUnitsOff(text);
}

/// The printed entries of a quantity, rows first.
std::vector<json*> entriesOf(json& printed) {
  std::vector<json*> all;
  for (json& entry : printed) {
    if (!entry.is_array())
      all.push_back(&entry);
    else
      for (json& number : entry) all.push_back(&number);
  }
  return all;
}

struct Folder {
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "dynwitness-judge-XXXXXX").string();
    BOOST_REQUIRE(::mkdtemp(pattern.data()) != nullptr);
    path = pattern;
  }
  ~Folder() { fs::remove_all(path); }
  fs::path path;
};

/// In every case and quantity one printed number is wrong, each time another: the largest below the
/// diagonal where it is a matrix, and the largest that is printed where it is none.
BOOST_DATA_TEST_CASE(a_wrong_digit_in_any_case_is_found, data::make(tables()), file) {
  const Folder folder;
  json table = json::parse(std::ifstream(file));
  const fs::path own = ownScene(file);
  const scene::Scene scene =
      own.empty() ? scene::findScene(table.at("scene").get<std::string>()) : scene::readScene(own);
  const std::vector<WitnessKind> kinds = selectWitnesses({"newton_euler", "articulated_body"});
  int planted = 0;
  // prints the last bits of a double, and is held to what a program in double may lose: more than
  // three of these
  if (fs::path(file).filename() == "pinocchio_zyx.json") return;
  for (json& one_case : table.at("cases")) {
    for (auto& [quantity, printed] : one_case.at("expect").items()) {
      const std::vector<json*> entries = entriesOf(printed);
      const std::size_t columns = printed[0].is_array() ? printed[0].size() : 1;
      json* chosen = nullptr;
      double largest = 0;
      for (std::size_t k = 0; k < entries.size(); ++k) {
        if (!entries[k]->is_string()) continue;
        if (columns > 1 && k / columns <= k % columns) continue;
        const std::string text = entries[k]->get<std::string>();
        if (changed(table, one_case, quantity, text).empty()) continue;
        if (std::abs(std::stod(text)) > largest) {
          largest = std::abs(std::stod(text));
          chosen = entries[k];
        }
      }
      if (chosen == nullptr) continue;  // zeros, expressions and 1 x 1 matrices
      ++planted;
      const std::string before = *chosen;
      *chosen = changed(table, one_case, quantity, before);
      const fs::path copy = folder.path / "table.json";
      std::ofstream(copy) << table.dump();
      bool found = false;
      for (const CheckResult& check : compareWithTable(copy, scene, kinds))
        found = found || (check.quantity == quantity && check.verdict == Verdict::kDisagree);
      BOOST_TEST(found, fs::path(file).filename().string()
                            << ", case '" << one_case.value("name", "") << "': " << quantity << " "
                            << before << " printed as " << chosen->get<std::string>());
      *chosen = before;
    }
  }
  BOOST_TEST(planted > 0);
}

BOOST_AUTO_TEST_SUITE_END()

// ---- limits: the run's own control
// -----------------------------------------------------------------

BOOST_AUTO_TEST_SUITE(control)

BOOST_DATA_TEST_CASE(a_kilogram_that_is_too_heavy_by_1e_10_is_found_everywhere,
                     data::make({"puma_560", "furuta_pendulum", "humanoid_floating",
                                 "kuka_iiwa_14"}),
                     name) {
  const scene::Scene scene = scene::findScene(name);
  const std::vector<WitnessKind> kinds =
      selectWitnesses({"lagrange", "newton_euler", "composite_body", "articulated_body",
                       "recursive_lagrange", "fast", "simbody"});
  const SceneResult result = crosscheckScene(scene, kinds, few(3));
  std::set<std::string> planted;
  for (const Control& control : result.controls) {
    BOOST_TEST_CONTEXT(control.quantity << " " << control.nothing) {
      BOOST_TEST(control.missed.empty());
      const bool is_of_table = control.found == std::vector<Road>{Road::kTable};
      BOOST_TEST((is_of_table ||
                  control.found == std::vector<Road>{Road::kPairs, Road::kTruth, Road::kField}));
      // 1e-10 is seen in every pair, not in the sharpest one only
      if (name != "humanoid_floating")
        BOOST_TEST(control.blind.empty());  // 38 rates: engines' limits are wider
      // the honest sweep of 38 rates leaves 1e-14 of the force that a heavier inertia changes
      const bool is_long = name == "humanoid_floating" && control.quantity == "qdd";
      if (!is_of_table) BOOST_TEST(control.size == (is_long ? 1e-9 : 1e-10));
      planted.insert(control.quantity);
    }
  }
  BOOST_TEST(planted.size() == std::size(kAllQuantities));
  // the control is no witness
  for (const CheckResult& check : result.checks)
    BOOST_TEST((check.left != kControl && check.right != kControl));
  for (const DigitsResult& digits : result.digits) BOOST_TEST(digits.witness != kControl);
}

/// Newton-Euler by the control's name, as somebody's program may call itself.
class Namesake : public Witness {
 public:
  explicit Namesake(const scene::Scene& scene)
      : sweep_(selectWitnesses({"newton_euler"}).front().make(scene).value()) {}
  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return sweep_->answers(quantity); }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    return sweep_->answer(quantity, state);
  }

 private:
  std::unique_ptr<Witness> sweep_;
  std::string name_ = kControl;
};

BOOST_AUTO_TEST_CASE(a_witness_that_is_called_like_the_control_is_judged_like_any_other) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  std::vector<WitnessKind> kinds = selectWitnesses({"newton_euler", "simbody"});
  kinds.push_back({{kControl, "1", "somebody's"}, [](const PreparedScene& s) -> MadeWitness {
                     return std::make_unique<Namesake>(s.scene());
                   }});
  const SceneResult result = crosscheckScene(scene, kinds, few(3));
  int pairs = 0, truths = 0;
  for (const CheckResult& check : result.checks) {
    BOOST_TEST((!check.left_is_control && !check.right_is_control));
    pairs += check.kind == CheckKind::kSame && check.right == kControl ? 1 : 0;
    truths += check.kind == CheckKind::kTruth && check.left == kControl ? 1 : 0;
  }
  BOOST_TEST(pairs > 0);
  BOOST_TEST(truths > 0);
  for (const Control& control : result.controls)
    BOOST_TEST((control.missed.empty() && control.blind.empty()), control.quantity);
}

/// By the dimension of the numbers, not by a formula: see Control.
BOOST_AUTO_TEST_CASE(a_heavier_kilogram_scales_what_has_a_mass_in_it) {
  for (const char* name : {"prismatic_revolute_mix", "gyroscopic_wrist"}) {
    const scene::Scene scene = scene::findScene(name), heavy = heavier(scene, 2);
    const WitnessKind kind = selectWitnesses({"recursive_lagrange"}).front();
    const auto before = kind.make(scene).value(), after = kind.make(heavy).value();
    const scene::State<double> state = drawState(scene.mechanism, scene.name, 1, 0);
    for (const Quantity quantity : kAllQuantities) {
      if (!before->answers(quantity) || quantity == Quantity::kQdd) continue;
      const Eigen::MatrixXd light = before->value(quantity, state),
                            other = after->value(quantity, state);
      const double room =
          1e-12 * light.cwiseAbs().maxCoeff();  // of rounding, beside one part in a hundred
      BOOST_TEST((other - 1.01 * light).cwiseAbs().maxCoeff() <= room,
                 name << " " << crosscheck::name(quantity));
    }
  }
}

BOOST_AUTO_TEST_CASE(where_there_is_nothing_to_plant_the_control_says_so) {
  const scene::Scene scene = scene::findScene("simple_pendulum");
  for (const Control& control :
       crosscheckScene(scene, selectWitnesses({"newton_euler", "lagrange"}), few(3)).controls) {
    BOOST_TEST(control.missed.empty());
    BOOST_TEST((control.nothing == (control.quantity == "c" ? "is zero" : "")), control.quantity);
  }
}

BOOST_AUTO_TEST_SUITE_END()

// ---- verdicts
// ---------------------------------------------------------------------------------------

BOOST_AUTO_TEST_SUITE(verdicts)

CheckResult checkOf(const std::string& quantity, int states, int missing, int excused) {
  CheckResult check;
  check.kind = CheckKind::kSame;
  check.quantity = quantity;
  check.left = "a";
  check.right = "b";
  check.states = states;
  for (int k = 0; k < missing; ++k)
    check.addVoided(k, fmt::format("no bound at state {}", k), false);
  for (int k = 0; k < excused; ++k) check.addVoided(missing + k, "M is singular", true);
  if (check.judged() == 0) check.verdict = Verdict::kNotAnswerable;
  return check;
}

CrosscheckResult runOf(const std::vector<CheckResult>& checks) {
  CrosscheckResult result;
  result.scenes.resize(1);
  result.scenes[0].name = "arm";
  result.scenes[0].checks = checks;
  return result;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

BOOST_AUTO_TEST_CASE(a_tenth_that_is_missing_is_told_and_more_is_incomplete) {
  const CrosscheckResult tenth = runOf({checkOf("M", 100, 0, 0), checkOf("qdd", 100, 10, 0)});
  BOOST_TEST((tenth.verdict() == RunVerdict::kAgree));
  BOOST_TEST(contains(tenth.headline(), "all agree"), tenth.headline());
  BOOST_TEST(
      contains(tenth.headline(), "not answered: qdd 10 of 100 comparisons (no bound at state 0)"),
      tenth.headline());
  const CrosscheckResult more = runOf({checkOf("M", 100, 0, 0), checkOf("qdd", 100, 11, 0)});
  BOOST_TEST((more.verdict() == RunVerdict::kIncomplete));
  BOOST_TEST(exitStatus(more.verdict()) == 1);
  BOOST_TEST(!contains(more.headline(), "all agree"), more.headline());
  BOOST_TEST(contains(more.headline(), "too little was of qdd of arm"), more.headline());
}

// The two sides of a law are numbers of its own: the 20th of them is no qdd[20] of two joints.
BOOST_AUTO_TEST_CASE(the_largest_difference_is_told_with_its_place) {
  CheckResult same = checkOf("qdd", 100, 0, 0);
  same.kind = CheckKind::kSame;
  same.left = "a";
  same.right = "b";
  same.worst_entry = "qdd[2]";
  same.worst_state = 7;
  same.ratio = 0.25;
  BOOST_TEST(contains(runOf({same}).headline(),
                      "the largest difference is 25%: qdd[2] of arm at state 7 (a and b)"),
             runOf({same}).headline());
  CheckResult law = checkOf("qdd", 100, 0, 0);
  law.kind = CheckKind::kLaw;
  law.law = "independence of the chosen root";
  law.left = "a";
  law.right.clear();
  law.worst_entry = "qdd[20]";
  law.worst_state = 76;
  law.ratio = 0.5;
  BOOST_TEST(contains(runOf({same, law}).headline(),
                      "50%: independence of the chosen root, entry [20] of arm at state 76 (a)"),
             runOf({same, law}).headline());
}

BOOST_AUTO_TEST_CASE(other_quantities_and_scenes_do_not_dilute_what_is_missing) {
  CrosscheckResult result = runOf({checkOf("M", 10000, 0, 0), checkOf("qdd", 10, 10, 0)});
  result.scenes.push_back(result.scenes[0]);
  result.scenes[1].name = "other";
  result.scenes[1].checks = {checkOf("qdd", 10000, 0, 0)};
  BOOST_TEST((result.verdict() == RunVerdict::kIncomplete));
  BOOST_TEST(result.thinlyCovered() == std::vector<std::string>{"qdd of arm"});
}

BOOST_AUTO_TEST_CASE(what_does_not_exist_is_not_missed) {
  const CrosscheckResult singular = runOf({checkOf("M", 100, 0, 0), checkOf("qdd", 100, 0, 100)});
  BOOST_TEST((singular.verdict() == RunVerdict::kAgree));
  BOOST_TEST(contains(singular.headline(), "not answered: qdd 100 of 100 comparisons"),
             singular.headline());
  // a tenth of what is left
  BOOST_TEST((runOf({checkOf("qdd", 100, 1, 90)}).verdict() == RunVerdict::kAgree));
  BOOST_TEST((runOf({checkOf("qdd", 100, 2, 90)}).verdict() == RunVerdict::kIncomplete));
}

BOOST_AUTO_TEST_CASE(the_first_state_that_ought_to_be_possible_is_named) {
  CheckResult check = checkOf("qdd", 100, 0, 3);
  BOOST_TEST(check.first_voided == 0);
  check.addVoided(7, "a bound ran away", false);
  check.addVoided(8, "another", false);
  BOOST_TEST(check.first_voided == 7);
  BOOST_TEST(check.voided_reason == "a bound ran away");
  BOOST_TEST(check.judged() == 95);
}

BOOST_AUTO_TEST_CASE(a_run_that_misses_its_control_proves_nothing) {
  CrosscheckResult result = runOf({checkOf("M", 100, 0, 0)});
  Control control;
  control.quantity = "M";
  control.size = 1e-10;
  control.found = {Road::kPairs, Road::kField};
  result.scenes[0].controls = {control};
  BOOST_TEST((result.verdict() == RunVerdict::kAgree));
  BOOST_TEST(
      result.controlLine() ==
      "control: a kilogram too heavy by 1e-10 was found in M of 1 scene, by pairs and field");
  result.scenes[0].controls[0].missed = {Road::kTruth};
  BOOST_TEST((result.verdict() == RunVerdict::kProvesNothing));
  BOOST_TEST(exitStatus(result.verdict()) == 3);
  BOOST_TEST(contains(result.headline(), "this run proves nothing"), result.headline());
  BOOST_TEST(contains(result.controlLine(), "was not found in M of arm by truth"),
             result.controlLine());
  // a disagreement stays one, and is told apart
  result.scenes[0].checks[0].verdict = Verdict::kDisagree;
  BOOST_TEST((result.verdict() == RunVerdict::kDisagree));
  BOOST_TEST(
      contains(result.headline(), "1 disagree, and the control, a known fault, was not found"),
      result.headline());
}

/// A witness of energies that throws at every seventh state.
class Forgetful : public Witness {
 public:
  explicit Forgetful(const scene::Scene& scene) : honest_(newtonEulerKind().make(scene).value()) {}
  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return quantity == Quantity::kKinetic; }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    if (asked_++ % 7 == 6) throw std::runtime_error("has forgotten");
    return honest_->answer(quantity, state);
  }

 private:
  std::string name_ = "forgetful";
  std::unique_ptr<Witness> honest_;
  int asked_ = 0;
};

BOOST_AUTO_TEST_CASE(one_bad_state_of_many_voids_that_state_and_not_the_check) {
  std::vector<WitnessKind> kinds = selectWitnesses({"newton_euler"});
  kinds.push_back({{"forgetful", "1", "throws"}, [](const PreparedScene& scene) -> MadeWitness {
                     return std::make_unique<Forgetful>(scene.scene());
                   }});
  const scene::Scene scene = scene::findScene("double_pendulum");
  for (const auto& [states, outcome] :
       {std::pair(10, RunVerdict::kAgree), std::pair(14, RunVerdict::kAgree)}) {
    CrosscheckResult result;
    result.scenes = {crosscheckScene(scene, kinds, few(states))};
    int partly = 0;
    for (const CheckResult& check : result.scenes[0].checks) {
      if (check.left != "forgetful" && check.right != "forgetful") continue;
      BOOST_TEST((check.verdict == Verdict::kAgree), check.reason);
      BOOST_TEST(check.voided == states / 7);
      BOOST_TEST(check.first_voided == 6);
      BOOST_TEST(contains(check.voided_reason, "has forgotten"), check.voided_reason);
      ++partly;
    }
    BOOST_TEST(partly == 2);  // its pair, and against the truth
    BOOST_TEST(contains(result.headline(), "not answered: kinetic"), result.headline());
    BOOST_TEST((result.verdict() == outcome), result.headline());
  }
}

BOOST_AUTO_TEST_SUITE_END()
