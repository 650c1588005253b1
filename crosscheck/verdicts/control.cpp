// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/control.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/verdicts/tables.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr int kStates = 3;  ///< that the control is asked at

double sizeOf(int power) {
  return std::pow(10.0, -power);
}

/// Articulated bodies answer it, not Newton-Euler.
bool isForward(Quantity quantity) {
  return quantity == Quantity::kQdd;
}

/// The control at one size, as a witness that believes in its kilogram.
class HeavyWitness : public Witness {
 public:
  explicit HeavyWitness(const PreparedScene& scene)
      : inverse_(newtonEulerKind().make(scene).value()),
        forward_(articulatedBodyKind().make(scene).value()) {}

  const std::string& name() const override { return name_; }
  bool answers(Quantity) const override { return true; }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    return sweep(quantity).answer(quantity, state);
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    return sweep(quantity).value(quantity, state);
  }

 private:
  Witness& sweep(Quantity quantity) { return isForward(quantity) ? *forward_ : *inverse_; }
  std::string name_ = kControl;
  std::unique_ptr<Witness> inverse_, forward_;
};

}  // namespace

scene::Scene heavier(const scene::Scene& scene, int power, TooHeavy what) {
  scene::Scene out = scene;
  const auto times = [power](scene::Number& number, const char* operation) {
    if (!number.isLiteralZero())
      number = scene::Expression::parse(
          fmt::format("({}) {} (1 + 1e-{})", number.text(), operation, power));
  };
  const auto scale = [&times](scene::Number& number) { times(number, "*"); };
  for (scene::Link& link : out.mechanism.links) {
    scene::MassProperties& m = link.inertia;
    for (scene::Number* number : {&m.mass, &m.xx, &m.yy, &m.zz, &m.xy, &m.xz, &m.yz})
      scale(*number);
    scale(link.joint.rotor_inertia);
    for (scene::Rotor& rotor : link.joint.rotors) scale(rotor.inertia);
  }
  if (what == TooHeavy::kInertia) {
    for (int k = 0; k < 3; ++k) times(out.mechanism.gravity[k], "/");
    return out;
  }
  for (scene::Link& link : out.mechanism.links) {
    scene::Joint& joint = link.joint;
    for (scene::Number* number : {&joint.stiffness, &joint.friction.viscous,
                                  &joint.friction.positive, &joint.friction.negative})
      scale(*number);
  }
  for (scene::Wrench& wrench : out.mechanism.wrenches)
    for (int k = 0; k < 3; ++k) {
      scale(wrench.force[k]);
      scale(wrench.moment[k]);
    }
  return out;
}

// ---- among the witnesses ------------------------------------------------------------------------

struct ControlWitness::Impl {
  HeavyWitness& at(int power, Quantity quantity) {
    const TooHeavy what = quantity == Quantity::kQdd ? TooHeavy::kInertia : TooHeavy::kKilogram;
    std::unique_ptr<HeavyWitness>& slot = heavy[{power, what}];
    if (!slot)
      slot = std::make_unique<HeavyWitness>(
          power == 0 ? scene : PreparedScene(heavier(scene.scene(), power, what)));
    return *slot;
  }

  /// By how much an answer is off in what the judge looks at: the largest entry of  x - exact,  or
  /// of M (x - exact)  for x = qdd.
  double offBy(const Eigen::MatrixXd& x, Quantity quantity, const scene::State<double>& state,
               const Certified& exact) {
    Eigen::MatrixXd off = x;
    for (Eigen::Index k = 0; k < x.size(); ++k)
      off.data()[k] = (Ball(x.data()[k]) - exact.value.data()[k]).mid();
    if (quantity == Quantity::kQdd) off = at(0, Quantity::kM).value(Quantity::kM, state) * off;
    return off.cwiseAbs().maxCoeff();
  }

  /// The power of ten that must be found; none where double keeps no digits of the quantity.
  std::optional<int> power(Quantity quantity, const scene::State<double>& state,
                           const Certified& exact) {
    const double honest = offBy(at(0, quantity).value(quantity, state), quantity, state, exact);
    // the fault grows in proportion to its size
    double largest = 0;
    if (quantity == Quantity::kQdd) {
      const Eigen::MatrixXd heavy = at(kUsualPower, quantity).value(quantity, state);
      largest = (offBy(heavy, quantity, state, exact) - honest) / sizeOf(kUsualPower);
    } else {
      for (const Ball& x : exact.value.reshaped()) largest = std::max(largest, x.atLeast());
    }
    for (int power = kUsualPower; power > 0; --power)
      if (sizeOf(power) * largest >= kWidestLimit * honest) return power;
    return {};
  }

  Control& control(const std::string& quantity) {
    for (Control& known : controls)
      if (known.quantity == quantity) return known;
    controls.emplace_back();
    controls.back().quantity = quantity;
    return controls.back();
  }

  PreparedScene scene;
  int states;
  std::map<std::pair<int, TooHeavy>, std::unique_ptr<HeavyWitness>> heavy;  ///< power 0: honest
  std::vector<Control> controls;
};

ControlWitness::ControlWitness(const PreparedScene& scene, const Options& options)
    : impl_(new Impl{scene, options.states, {}, {}}) {}
ControlWitness::~ControlWitness() = default;

bool ControlWitness::joins(Quantity quantity, int index, const scene::State<double>& state,
                           const Certified& exact, std::vector<Testimony>& said) {
  if (index >= kStates) return false;
  Control& control = impl_->control(crosscheck::name(quantity));
  const auto nothing = [&](const std::string& why) {
    if (control.size == 0) control.nothing = why;
    return false;
  };
  const auto testifies = [&](int power) {
    said.push_back({kControl, impl_->at(power, quantity).answer(quantity, state), {}});
    said.back().is_control = true;
    return true;
  };
  if (!exact.exists()) return nothing(exact.reason);
  double largest = 0;
  for (Eigen::Index k = 0; k < exact.value.size(); ++k)
    largest = std::max(largest, exact.value.data()[k].atLeast());
  if (largest == 0) return nothing("is zero");
  if (index == 0 && impl_->states > 1) return testifies(0);
  const std::optional<int> power = impl_->power(quantity, state, exact);
  if (!power) return nothing("double keeps no digits of it");
  control.nothing.clear();
  control.size = std::max(control.size, sizeOf(*power));
  return testifies(*power);
}

void ControlWitness::judgedInPairs(const std::vector<CheckResult>& checks) {
  bool found = false, judged = false;
  Control* control = nullptr;
  std::vector<std::string> blind;
  for (const CheckResult& check : checks) {
    if (!check.right_is_control) continue;
    control = &impl_->control(check.quantity);
    judged = judged || check.verdict != Verdict::kNotAnswerable;
    found = found || check.verdict == Verdict::kDisagree;
    if (check.verdict == Verdict::kAgree) blind.push_back(check.left);
  }
  if (control == nullptr || control->size == 0 || !judged) return;
  (found ? control->found : control->missed).push_back(Road::kPairs);
  control->blind = blind;
}

void ControlWitness::takeFrom(DigitsFound& found) {
  const auto isControls = [](const DigitsResult& digits) { return digits.is_control; };
  found.digits.erase(std::remove_if(found.digits.begin(), found.digits.end(), isControls),
                     found.digits.end());
  std::vector<CheckResult> others;
  for (CheckResult& check : found.checks) {
    if (!check.left_is_control) {
      others.push_back(std::move(check));
      continue;
    }
    Control& control = impl_->control(check.quantity);
    if (control.size == 0 || check.verdict == Verdict::kNotAnswerable) continue;
    (check.verdict == Verdict::kDisagree ? control.found : control.missed).push_back(Road::kTruth);
  }
  found.checks = std::move(others);
}

std::vector<Control> ControlWitness::results() const {
  std::vector<Control> controls = impl_->controls;
  for (Control& control : controls)
    if (control.nothing.empty() && control.found.empty() && control.missed.empty())
      control.nothing = "no comparison was possible";
  return controls;
}

// ---- before tables ------------------------------------------------------------------------------

namespace {

using nlohmann::json;

/** The part of a printed number that three units of its last digit are: "0.25" gives 3 / 25. None
    for an expression, and for zero. Whether zeros at the end were printed makes it smaller, not
    larger. */
std::optional<double> threeUnits(const json& printed) {
  if (!printed.is_string()) return {};
  std::string digits;
  for (const char c : printed.get<std::string>()) {
    if (c == 'e' || c == 'E') break;
    if (c >= '0' && c <= '9')
      digits += c;
    else if (c != '.' && c != '-' && c != '+')
      return {};
  }
  const double units = std::strtod(digits.c_str(), nullptr);
  if (units == 0) return {};
  return 3 / units;
}

/// The smallest over all entries; what the table states about places and accuracy outweighs the
/// print.
double leastPart(const json& table, const json& one_case, const std::string& quantity,
                 const json& printed, const std::optional<double>& accuracy) {
  const auto stated = [&](const char* key) -> std::optional<int> {
    if (!one_case.contains(key) || !one_case[key].contains(quantity)) return {};
    return one_case[key][quantity].get<int>();
  };
  if (printed.is_array()) {
    double least = 1e300;
    for (const json& entry : printed)
      least = std::min(least, leastPart(table, one_case, quantity, entry, accuracy));
    return least;
  }
  const std::optional<double> units = threeUnits(printed);
  if (!units) return 1e300;
  const double value = std::abs(std::strtod(printed.get<std::string>().c_str(), nullptr));
  if (accuracy) return 3 * *accuracy / value;
  if (const auto places = stated("digits")) return 3 * std::pow(10.0, -*places) / value;
  if (const auto significant = stated("significant")) return 3 * std::pow(10.0, 1 - *significant);
  // all digits of a double, which "4" has too
  if (one_case.value("computed_digits", table.value("computed_digits", false))) return 0;
  return *units;
}

/// A case without joint forces moves freely: its qdd is the same in every unit of mass.
bool movesFreely(const json& one_case) {
  const json forces = one_case.value("tau", json::array());
  return std::all_of(forces.begin(), forces.end(), [](const json& force) {
    return (force.is_string() ? force.get<std::string>() : force.dump())
               .find_first_not_of("+-0.") == std::string::npos;
  });
}

}  // namespace

std::vector<Control> controlOfTable(const std::filesystem::path& file, const PreparedScene& scene) {
  std::ifstream in(file);
  const json table = json::parse(in);
  std::map<std::string, double> part;  // by quantity, the least of all cases
  for (const json& one_case : table.at("cases")) {
    for (const auto& [quantity, printed] : one_case.at("expect").items()) {
      const std::optional<Quantity> of_dynamics = tabledQuantity(quantity);
      if (!of_dynamics || (*of_dynamics == Quantity::kQdd && movesFreely(one_case))) continue;
      std::optional<double> accuracy;
      if (table.contains("accuracy") && table["accuracy"].contains(quantity))
        accuracy = std::strtod(table["accuracy"][quantity].get<std::string>().c_str(), nullptr);
      const double least = leastPart(table, one_case, quantity, printed, accuracy);
      if (least > 1e299) continue;  // zeros and expressions
      const auto [it, is_new] = part.try_emplace(quantity, least);
      it->second = std::min(it->second, least);
    }
  }
  std::vector<Control> controls;
  for (const auto& [quantity, least] : part) {
    if (least > 1) {
      controls.emplace_back();
      controls.back().quantity = quantity;
      controls.back().nothing = "a table whose units are larger than its numbers";
      continue;
    }
    int power = kUsualPower;
    while (power > 0 && sizeOf(power) < least) --power;
    const WitnessKind kind = {
        {kControl, DYNWITNESS_VERSION, "a kilogram too heavy"},
        [power](const PreparedScene& asked) -> MadeWitness {
          return std::make_unique<HeavyWitness>(heavier(asked.scene(), power));
        }};
    for (const CheckResult& check : compareWithTable(file, scene, {kind})) {
      if (check.quantity != quantity) continue;
      Control control;
      control.quantity = quantity;
      control.size = sizeOf(power);
      (check.verdict == Verdict::kDisagree ? control.found : control.missed)
          .push_back(Road::kTable);
      controls.push_back(control);
    }
  }
  return controls;
}

std::vector<Control> joinedControls(const std::vector<std::vector<Control>>& parts) {
  std::vector<Control> joined, of_tables;
  for (const std::vector<Control>& part : parts) {
    for (const Control& control : part) {
      const auto isOfTable = [](const std::vector<Road>& roads) {
        return roads == std::vector<Road>{Road::kTable};
      };
      if (isOfTable(control.found) || isOfTable(control.missed)) {
        of_tables.push_back(control);
        continue;
      }
      const auto same = std::find_if(joined.begin(), joined.end(), [&](const Control& c) {
        return c.quantity == control.quantity;
      });
      if (same == joined.end()) {
        joined.push_back(control);
        continue;
      }
      if (same->size == 0)
        same->nothing = control.nothing;  // planted by one road at least, or by none
      else if (control.size > 0)
        same->nothing.clear();
      same->size = std::max(same->size, control.size);
      for (const Road road : control.found) addOnce(same->found, road);
      for (const Road road : control.missed) addOnce(same->missed, road);
      for (const std::string& witness : control.blind) addOnce(same->blind, witness);
    }
  }
  joined.insert(joined.end(), of_tables.begin(), of_tables.end());
  return joined;
}

}  // namespace dynwitness::crosscheck
