// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of one part in 10^18: no comparison in double can see them, and the field sees them all.
#include <algorithm>

#include <boost/test/unit_test.hpp>

#include "crosscheck/exact/exact.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/witnesses/exact_sweeps.hpp"
#include "crosscheck/witnesses/witness.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

/// One part in 10^18 (in double, 1 + tiny is 1).
template <typename T>
T tiny() {
  return T(1) / T(1000000000) / T(1000000000);
}

template <typename Vector>
void scaleFirstNonZero(Vector&& entries) {
  using T = typename std::decay_t<Vector>::Scalar;
  for (Eigen::Index j = 0; j < entries.cols(); ++j)
    for (Eigen::Index i = 0; i < entries.rows(); ++i)
      if (entries(i, j) != T(0)) {
        entries(i, j) *= T(1) + tiny<T>();
        return;
      }
  throw std::logic_error("nothing to plant an error in");
}

const auto kNothing = [](auto&, const auto&) {};

const auto kParallelAxis = [](auto& model, const auto& number) {
  using T = typename std::decay_t<decltype(number)>::Scalar;
  auto& M = model.links.back().M;
  M.I.xx += tiny<T>() * (M.h.y() * M.h.y() + M.h.z() * M.h.z()) / M.mass;  // m (y^2 + z^2)
};
const auto kRotation = [](auto& model, const auto&) { scaleFirstNonZero(model.links[3].X_tree.R); };
const auto kTranslation = [](auto& model, const auto&) {
  scaleFirstNonZero(model.links[2].X_tree.p);
};
const auto kRotor = [](auto& model, const auto& number) {
  using T = typename std::decay_t<decltype(number)>::Scalar;
  model.links[1].rotor *= T(1) + tiny<T>();
};
const auto kGravity = [](auto& model, const auto&) { scaleFirstNonZero(model.gravity); };

/// Newton-Euler with its velocity products one part in 10^18 too large.
struct WrongCoriolis : NewtonEuler {
  template <typename T>
  static MatrixX<T> answer(Setup<T>& s, Quantity quantity, const scene::State<T>& state) {
    MatrixX<T> value = NewtonEuler::answer(s, quantity, state);
    if (quantity == Quantity::kc || quantity == Quantity::kTau)
      value += NewtonEuler::answer(s, Quantity::kc, state) * tiny<T>();
    return value;
  }
};

/// The same wrong sweep as witness of the comparison in double.
template <typename Algorithm, typename Change>
class PlantedWitness : public Witness {
 public:
  PlantedWitness(const scene::Scene& scene, Change change)
      : in_double_(changed(scene, scene::RealNumbers<double>(scene.mechanism), change)),
        with_bounds_(changed(scene, RunningErrorNumbers(scene.mechanism), change)) {}
  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return Algorithm::answers(quantity); }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    return boundedAnswer(Algorithm::answer(in_double_, quantity, state),
                         Algorithm::answer(with_bounds_, quantity, runningErrorState(state)));
  }

 private:
  template <typename Numbers>
  static Setup<typename Numbers::Scalar> changed(const scene::Scene& scene, const Numbers& number,
                                                 Change change) {
    Setup<typename Numbers::Scalar> setup(scene.mechanism, number);
    change(setup.model, number);
    for (auto& kept : setup.with_fixed_joints) change(kept.model, number);
    return setup;
  }
  std::string name_ = Algorithm::kName;
  Setup<double> in_double_;
  Setup<RunningError> with_bounds_;
};

int disagreeing(const std::vector<CheckResult>& checks, const std::string& witness) {
  return static_cast<int>(std::count_if(checks.begin(), checks.end(), [&](const CheckResult& c) {
    return c.verdict == Verdict::kDisagree && (c.left == witness || c.right == witness);
  }));
}
int disagreeing(const std::vector<CheckResult>& checks) {
  return static_cast<int>(std::count_if(checks.begin(), checks.end(), [](const CheckResult& c) {
    return c.verdict == Verdict::kDisagree;
  }));
}

/// Our sweeps and the Lagrangian, the witness of Algorithm's name replaced by the planted one.
template <typename Algorithm, typename Change>
std::vector<CheckResult> inDouble(const scene::Scene& scene, Change change) {
  std::vector<WitnessKind> kinds;
  for (WitnessKind kind : witnessKinds()) {
    if (kind.info.name == Algorithm::kName)
      kind.make = [change](const PreparedScene& s) -> MadeWitness {
        return std::make_unique<PlantedWitness<Algorithm, Change>>(s.scene(), change);
      };
    for (const char* ours : {"lagrange", "newton_euler", "composite_body", "articulated_body"})
      if (kind.info.name == ours) kinds.push_back(kind);
  }
  BOOST_TEST_REQUIRE(kinds.size() == 4u);
  Options options;
  options.states = 50;
  return compareWitnesses(scene, kinds, options);
}
template <typename Algorithm, typename Change>
std::vector<CheckResult> inField(const scene::Scene& scene, Change change) {
  std::vector<ExactWitness> witnesses = exactWitnesses(scene, Parameters::kAsWritten);
  for (ExactWitness& witness : witnesses)
    if (witness.name == Algorithm::kName) witness = sweepWitness<Algorithm>(scene, change);
  return compareExactly(scene, witnesses, {});
}

/// The double comparison agrees, with numbers that are the right ones to the last bit or two; the
/// field disagrees about the quantities named, and with the planted witness only.
template <typename Algorithm, typename Change>
void seenByTheFieldAlone(const std::string& scene_name, Change change,
                         const std::vector<std::string>& quantities) {
  const scene::Scene scene = scene::findScene(scene_name);
  for (const CheckResult& check : inDouble<Algorithm>(scene, change))
    BOOST_TEST((check.verdict == Verdict::kAgree),
               check.quantity << " " << check.left << " " << check.right << " " << check.reason);

  const std::vector<CheckResult> checks = inField<Algorithm>(scene, change);
  BOOST_TEST(disagreeing(checks) == disagreeing(checks, Algorithm::kName));
  for (const std::string& quantity : quantities) {
    const bool seen = std::any_of(checks.begin(), checks.end(), [&](const CheckResult& c) {
      return c.quantity == quantity && c.verdict == Verdict::kDisagree && c.exact->points == 1 &&
             !c.exact->residual_zero;
    });
    BOOST_TEST(seen, quantity << " is wrong and nobody noticed");
  }
}

}  // namespace

BOOST_AUTO_TEST_CASE(without_an_error_everything_agrees) {
  const scene::Scene scene = scene::findScene("puma_560");
  const auto checks = inField<NewtonEuler>(scene, kNothing);
  BOOST_TEST(checks.size() == 54u);  // pairs of seven witnesses, as test_exact counts them
  for (const CheckResult& check : checks) BOOST_TEST((check.verdict == Verdict::kAgree));
}

BOOST_AUTO_TEST_CASE(a_wrong_parallel_axis_term_is_seen) {
  seenByTheFieldAlone<NewtonEuler>("kuka_iiwa_14", kParallelAxis, {"M", "c", "tau", "kinetic"});
}
BOOST_AUTO_TEST_CASE(a_wrong_rotation_is_seen) {
  seenByTheFieldAlone<NewtonEuler>("puma_560", kRotation, {"M", "c", "tau", "kinetic"});
}
BOOST_AUTO_TEST_CASE(a_wrong_translation_is_seen) {
  seenByTheFieldAlone<NewtonEuler>("puma_560", kTranslation, {"M", "c", "g", "tau", "kinetic"});
}
BOOST_AUTO_TEST_CASE(a_wrong_rotor_is_seen) {
  seenByTheFieldAlone<NewtonEuler>("puma_560", kRotor, {"M", "tau", "kinetic"});
}
BOOST_AUTO_TEST_CASE(a_wrong_coriolis_term_is_seen) {
  seenByTheFieldAlone<WrongCoriolis>("puma_560", kNothing, {"c", "tau"});
}
BOOST_AUTO_TEST_CASE(wrong_gravity_is_seen) {
  seenByTheFieldAlone<NewtonEuler>("puma_560", kGravity, {"g", "tau", "potential"});
}
BOOST_AUTO_TEST_CASE(a_wrong_forward_dynamics_is_seen) {
  seenByTheFieldAlone<ArticulatedBody>("puma_560", kRotor, {"qdd"});
}
BOOST_AUTO_TEST_CASE(a_wrong_composite_inertia_is_seen) {
  seenByTheFieldAlone<CompositeBody>("franka_panda", kParallelAxis, {"M", "qdd"});
}

BOOST_AUTO_TEST_CASE(the_planted_number_is_the_right_one_in_double) {
  const scene::Scene scene = scene::findScene("puma_560");
  const scene::RealNumbers<double> number(scene.mechanism);
  const auto right = recursive::buildModel(scene.mechanism, number);
  auto wrong = right;
  kRotor(wrong, number);
  kRotation(wrong, number);
  kTranslation(wrong, number);
  kGravity(wrong, number);
  kParallelAxis(wrong, number);
  BOOST_TEST(wrong.links[1].rotor == right.links[1].rotor);
  BOOST_TEST((wrong.links[1].X_tree.R == right.links[1].X_tree.R));
  BOOST_TEST((wrong.links[2].X_tree.p == right.links[2].X_tree.p));
  BOOST_TEST((wrong.gravity == right.gravity));
  BOOST_TEST(wrong.links.back().M.I.xx == right.links.back().M.I.xx);
}

BOOST_AUTO_TEST_CASE(who_is_wrong_stands_alone) {
  const scene::Scene scene = scene::findScene("puma_560");
  const auto findings = findOutliers(scene.name, inField<ArticulatedBody>(scene, kRotor));
  BOOST_TEST_REQUIRE(findings.size() == 1u);
  BOOST_TEST(findings[0].quantity == "qdd");
  BOOST_TEST(findings[0].witness == "articulated_body");
}

BOOST_AUTO_TEST_CASE(the_reason_says_where) {
  const scene::Scene scene = scene::findScene("puma_560");
  for (const CheckResult& check : inField<NewtonEuler>(scene, kRotor)) {
    if (check.verdict != Verdict::kDisagree || check.quantity != "M") continue;
    BOOST_TEST(check.worst_entry == "M[2,2]");
    BOOST_TEST(check.reason.rfind("M[2,2] differs at point 0 of seed 1: ", 0) == 0u, check.reason);
    return;
  }
  BOOST_ERROR("M agrees");
}
