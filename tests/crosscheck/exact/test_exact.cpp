// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/exact/exact.hpp"
#include "crosscheck/exact/inquiry.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>
#include <set>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/conductor/exact_checks.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/laws/derivative_roads.hpp"
#include "crosscheck/laws/identities.hpp"
#include "crosscheck/laws/point_laws.hpp"
#include "crosscheck/laws/second_derivative_pairs.hpp"
#include "crosscheck/verdicts/check_identities.hpp"
#include "crosscheck/verdicts/options.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

PrimeField x() {
  return FormulaSizes::indeterminate(1);
}

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  for (const auto& file : scene::bundledScenes()) names.push_back(file.stem().string());
  return names;
}

/// Who answers what, in words: as many comparisons as there are pairs.
std::size_t pairsOf(bool has_kernel) {
  std::set<std::string> here = {"lagrange",         "newton_euler",       "composite_body",
                                "articulated_body", "recursive_lagrange", "fast"};
  if (has_kernel) here.insert("kernel");
  const std::set<std::string> everything = {"lagrange", "newton_euler", "recursive_lagrange"};
  const std::map<std::string, std::set<std::string>> answering = {
      {"M", {"lagrange", "newton_euler", "composite_body", "recursive_lagrange", "fast", "kernel"}},
      {"c", everything},
      {"g", everything},
      {"tau", {"lagrange", "newton_euler", "recursive_lagrange", "fast", "kernel"}},
      {"qdd",
       {"lagrange", "composite_body", "articulated_body", "recursive_lagrange", "fast", "kernel"}},
      {"kinetic", everything},
      {"potential", everything},
      {"momentum", {"newton_euler", "recursive_lagrange"}},
      {"reactions", {"lagrange", "newton_euler"}}};
  std::size_t pairs = 0;
  for (const auto& [quantity, who] : answering) {
    const auto n = static_cast<std::size_t>(std::count_if(
        who.begin(), who.end(), [&](const std::string& name) { return here.count(name) > 0; }));
    pairs += n * (n - 1) / 2;
  }
  return pairs;
}

void requireAllZero(const scene::Mechanism& mechanism, const std::vector<CheckResult>& checks,
                    bool has_kernel) {
  std::map<std::string, std::size_t> count;
  for (const CheckResult& check : checks) ++count[check.name()];
  // a kernel that is not worth having answers less
  const std::size_t of_derivatives =
      derivativePairs(mechanism).size() + secondPairs(mechanism).size();
  BOOST_TEST(count["same"] >= pairsOf(false) + of_derivatives);
  BOOST_TEST(count["same"] <= pairsOf(has_kernel) + of_derivatives);
  BOOST_TEST(count["regressor"] == 1u);
  BOOST_TEST(count["closures"] == (mechanism.closures.empty() ? 0u : 3u));
  const std::vector<LawWords> identities = Identities::words(mechanism);
  for (const LawWords& identity : identities) BOOST_TEST(count[identity.name] == 1u, identity.name);
  // two are of coordinates whose rates are their derivatives
  const bool turns =
      std::any_of(mechanism.links.begin(), mechanism.links.end(), [](const scene::Link& link) {
        return link.joint.kind == scene::JointKind::kSpherical ||
               link.joint.kind == scene::JointKind::kFloating;
      });
  BOOST_TEST(identities.size() == Identities::kCount - (turns ? 2u : 0u));
  const bool constrained = !mechanism.isOpenTree() || mechanism.isDriven() ||
                           !mechanism.acceleration_constraints.empty();
  const std::vector<LawWords> of_points = PointLaws::words(mechanism);
  for (const LawWords& law : of_points) BOOST_TEST(count[law.name] == 1u, law.name);
  const std::size_t rest =
      checks.size() - count["same"] - 1 - count["closures"] - identities.size() - of_points.size();
  BOOST_TEST((rest > 0) == constrained);
  for (const CheckResult& check : checks) {
    BOOST_TEST_CONTEXT(check.name() << " " << check.quantity << " " << check.left << " "
                                    << check.right << " " << check.reason) {
      if (mechanism.links.size() == 2 && check.verdict == Verdict::kNotAnswerable) {
        BOOST_TEST(check.reason == "a single body: there is no other link");  // to be the root
        continue;
      }
      BOOST_TEST((check.verdict == Verdict::kAgree));
      BOOST_TEST_REQUIRE(check.exact.has_value());
      BOOST_TEST(check.exact->residual_zero);
      BOOST_TEST(check.exact->points >= 1);
      BOOST_TEST(check.exact->discarded == 0);
      BOOST_TEST(check.exact->error_probability <= 1e-30);
      BOOST_TEST(check.states == check.exact->points);
    }
  }
}

/// The degree in u of values at u = 0, 1, 2, ...: the last difference that is not zero.
int degreeOf(std::vector<PrimeField> values) {
  int degree = 0;
  for (int order = 0; values.size() > 1; ++order) {
    if (values[0] != PrimeField(0)) degree = order;
    for (std::size_t i = 0; i + 1 < values.size(); ++i) values[i] = values[i + 1] - values[i];
    values.pop_back();
  }
  BOOST_REQUIRE((values[0] == PrimeField(0)));  // otherwise there were too few values
  return degree;
}

/** State number u on a curve on which elements have degree 1 in u, and c and s degree 2: there a
    polynomial has its weighted degree in u. */
scene::State<PrimeField> onCurve(const scene::Mechanism& mechanism, int u) {
  const auto a = indeterminateState(mechanism, FieldSource("curve", 1, 0));
  const auto b = indeterminateState(mechanism, FieldSource("curve", 1, 1));
  const auto line = [u](PrimeField start, PrimeField slope) {
    return start + PrimeField(u) * slope;
  };
  scene::State<PrimeField> state = a;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    state.x[i].q = line(a.x[i].q, b.x[i].q);
    state.x[i].c = line(a.x[i].c, b.x[i].c) * line(b.x[i].q, a.x[i].s);
    state.x[i].s = line(a.x[i].s, b.x[i].s) * line(b.qd[i], a.x[i].c);
    state.qd[i] = line(a.qd[i], b.qd[i]);
    state.qdd[i] = line(a.qdd[i], b.qdd[i]);
  }
  return state;
}

/// Two sliders along one line, nothing between them.
scene::Scene singularScene() {
  return scene::readSceneToml(R"([[link]]
name = "base"
[[link]]
name = "shuttle"
parent = "base"
joint = { kind = "prismatic" }
[[link]]
name = "weight"
parent = "shuttle"
mass = 2
joint = { kind = "prismatic" }
)",
                              "singular.toml");
}

}  // namespace

BOOST_AUTO_TEST_SUITE(sizes_of_formulas)

BOOST_AUTO_TEST_CASE(a_product_of_k_inputs_has_degree_k) {
  const FormulaSizes sizes;
  PrimeField product = 1;
  for (int k = 1; k <= 20; ++k) {
    product *= x();
    BOOST_TEST(product.degree() == k);
    BOOST_TEST(product.bits() == 0);
  }
  BOOST_TEST(sizes.totalDegree() == 0);
}

BOOST_AUTO_TEST_CASE(sums_take_the_larger_degree_and_zero_is_no_polynomial_of_any) {
  const FormulaSizes sizes;
  BOOST_TEST((x() * x() + x()).degree() == 2);
  BOOST_TEST((x() * PrimeField(0) + x()).degree() == 1);
  BOOST_TEST((x() * PrimeField(0)).isZero());
  BOOST_TEST((x() - x()).degree() == 1);  // another x: not zero
  BOOST_CHECK_THROW(x() / PrimeField(0), DivisionByZero);
}

BOOST_AUTO_TEST_CASE(sums_of_coefficients_are_bounded) {
  const FormulaSizes sizes;
  const PrimeField f = (x() + x()) * (x() + PrimeField(1000));  // coefficients 1 1, 1 1000
  BOOST_TEST(f.bits() >= std::log2(2.0 * 1001));
  BOOST_TEST(f.bits() <= std::log2(2.0 * 1001) + 2);
  // 0.25 = 1/4: the common denominator of decimals is a power of 2 and 5
  const PrimeField quarter = PrimeField::fromRational(scene::Rational(1, 4));
  const PrimeField sum = quarter + PrimeField::fromRational(scene::Rational(3, 10));  // 11/20
  BOOST_TEST(sum.bits() >= std::log2(11.0));
  BOOST_TEST(sum.bits() <= std::log2(11.0) + 2);
}

BOOST_AUTO_TEST_CASE(fractions_with_the_same_divisor_share_it) {
  const FormulaSizes sizes;
  const PrimeField d = x() * x() * x();
  PrimeField sum = 0;
  for (int k = 0; k < 100; ++k) sum += x() / d;  // (x1 + ... + x100) / d
  BOOST_TEST(sum.degree() == 1);
  BOOST_TEST((sum - x()).degree() == 4);  // over d: (x1 + ...) - x d
  BOOST_TEST((sum * d).degree() == 1);    // and d cancels
  BOOST_TEST((sum * d - x()).degree() == 1);
  BOOST_TEST(sizes.totalDegree() == 3);
}

BOOST_AUTO_TEST_CASE(nested_fractions_multiply_out) {
  const FormulaSizes sizes;
  const PrimeField a = x() / x();      // x1 / x2
  const PrimeField b = a / (a + x());  // (x1 / x2) / ((x1 + x3 x2) / x2) = x1 / (x1 + x2 x3)
  BOOST_TEST(b.degree() == 1);
  BOOST_TEST((b - x()).degree() == 3);
  BOOST_TEST(sizes.totalDegree() == 1 + 2);
}

BOOST_DATA_TEST_CASE(it_bounds_the_degree_that_interpolation_measures,
                     data::make({"simple_pendulum", "double_pendulum", "cart_pole", "planar_3r",
                                 "elastic_pendulum", "scara", "stanford_arm", "puma_560"})) {
  const scene::Scene scene = scene::findScene(sample);
  const PrimeField::Modulus modulus(drawPrime("degree", 1, 0));
  const FieldSource source("degree", 1, 0);
  const FieldNumbers number(scene.mechanism, source);
  int largest_bound = 0, largest_measured = 0;
  for (const ExactWitness& witness : exactWitnesses(scene, Parameters::kAsWritten)) {
    const auto values = witness.in_field(number);
    for (const Quantity quantity : {Quantity::kM, Quantity::kc, Quantity::kg, Quantity::kTau,
                                    Quantity::kKinetic, Quantity::kPotential}) {
      if (!witness.answers(quantity)) continue;
      const MatrixX<double> bound = [&] {
        const FormulaSizes sizes;
        const FieldNumbers indeterminates(scene.mechanism, source);
        const MatrixX<PrimeField> answer =
            witness.in_field(indeterminates)(quantity, indeterminateState(scene.mechanism, source));
        return MatrixX<double>(answer.unaryExpr([](PrimeField x) { return x.degree(); }));
      }();
      std::vector<MatrixX<PrimeField>> at;
      for (int u = 0; u < 80; ++u) at.push_back(values(quantity, onCurve(scene.mechanism, u)));
      for (Eigen::Index j = 0; j < bound.cols(); ++j) {
        for (Eigen::Index i = 0; i < bound.rows(); ++i) {
          std::vector<PrimeField> entry;
          for (const auto& answer : at) entry.push_back(answer(i, j));
          const int measured = degreeOf(entry);
          BOOST_TEST(measured <= bound(i, j), witness.name << " " << name(quantity));
          largest_bound = std::max(largest_bound, static_cast<int>(bound(i, j)));
          largest_measured = std::max(largest_measured, measured);
        }
      }
    }
  }
  BOOST_TEST_MESSAGE(sample << ": degree " << largest_measured << ", bound " << largest_bound);
  BOOST_TEST(largest_measured > 0);
  BOOST_TEST(largest_bound <=
             4 * largest_measured);  // a bound, and not a wild one: 2.2 is the worst
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(wanted)

/// One check of a number that is the same on both sides.
Inquiry sameNumber() {
  Inquiry inquiry;
  inquiry.checks.resize(1);
  inquiry.checks[0].law = "a number is itself";
  inquiry.ask = [](const FieldNumbers&, const scene::State<PrimeField>& state,
                   const std::vector<char>&) {
    const MatrixX<PrimeField> x = MatrixX<PrimeField>::Constant(1, 1, state.qd.at(0));
    return SidesOfAll{{x, x}};
  };
  return inquiry;
}

BOOST_AUTO_TEST_CASE(sides_that_were_not_computed_do_not_agree) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  Inquiry inquiry = sameNumber();
  BOOST_TEST((decide(scene, inquiry, {}).at(0).verdict == Verdict::kAgree));
  inquiry.ask = [ask = inquiry.ask](const FieldNumbers& number,
                                    const scene::State<PrimeField>& state,
                                    const std::vector<char>& wanted) {
    return PrimeField::isSized() ? ask(number, state, wanted) : SidesOfAll(1);
  };
  BOOST_TEST((decide(scene, inquiry, {}).at(0).verdict == Verdict::kDisagree));
}

BOOST_AUTO_TEST_CASE(checks_that_have_their_points_are_not_asked_again) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  Inquiry two = both(sameNumber(), sameNumber());
  int asked[2] = {0, 0};
  two.ask = [&asked, ask = two.ask](const FieldNumbers& number,
                                    const scene::State<PrimeField>& state,
                                    const std::vector<char>& wanted) {
    SidesOfAll sides = ask(number, state, std::vector<char>(2, 1));
    if (PrimeField::isSized()) {  // the second as of a degree that takes more points
      for (int k = 0; k < 16; ++k) sides[1].left = (sides[1].left * sides[1].left).eval();
      return sides;
    }
    for (int k = 0; k < 2; ++k) asked[k] += wanted[static_cast<std::size_t>(k)] != 0 ? 1 : 0;
    return sides;
  };
  const std::vector<CheckResult> results = decide(scene, two, {});
  BOOST_TEST((results.at(0).verdict == Verdict::kAgree));
  BOOST_TEST((results.at(1).verdict == Verdict::kAgree));
  BOOST_TEST(asked[0] == results[0].exact->points);
  BOOST_TEST(asked[1] == results[1].exact->points);
  BOOST_TEST(asked[0] < asked[1]);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(chances)

/// All zeros of polynomials on two circles modulo a prime small enough to try all points.
BOOST_DATA_TEST_CASE(zeros_on_circles_are_as_rare_as_the_weighted_degree_says, data::xrange(30),
                     seed) {
  constexpr int p = 103;  // 3 mod 4
  const auto inverse = [](int a) {
    int result = 1;
    for (int k = 0; k < p - 2; ++k) result = result * a % p;
    return result;
  };
  std::vector<std::pair<int, int>> circle;
  for (int t = 0; t < p; ++t) {
    const int scale = inverse((1 + t * t) % p);
    circle.emplace_back((1 + (p - 1) * t % p * t) % p * scale % p, 2 * t * scale % p);
  }
  // sum of a_i (products of up to 2 of 1, c1, s1, c2, s2): total degree 2, weighted 4
  RandomStream random("circles", seed, 0);
  int coefficients[5][5];
  for (auto& row : coefficients)
    for (int& a : row)
      a = seed % 3 == 0 && random.next() % 4 != 0 ? 0 : static_cast<int>(random.next() % p);
  coefficients[1][3] = 1;
  int zeros = 0;
  for (const auto& [c1, s1] : circle) {
    for (const auto& [c2, s2] : circle) {
      const int v[5] = {1, c1, s1, c2, s2};
      int sum = 0;
      for (int i = 0; i < 5; ++i)
        for (int j = i; j < 5; ++j) sum = (sum + coefficients[i][j] * v[i] % p * v[j]) % p;
      zeros += sum == 0 ? 1 : 0;
    }
  }
  BOOST_TEST(zeros <= 4 * p);

  // the weight 2 is needed: c1 = c(t) has the zeros t and -t
  int twice = 0;
  for (const auto& [c, s] : circle) twice += c == circle[5 + seed].first ? 1 : 0;
  BOOST_TEST(twice == 2);
}

BOOST_AUTO_TEST_CASE(points_follow_from_the_error_probability) {
  BOOST_TEST(pointsNeeded(0, 1e-30) == 1);
  BOOST_TEST(pointsNeeded(1e-31, 1e-30) == 1);
  BOOST_TEST(pointsNeeded(1e-15, 1.001e-30) == 2);
  BOOST_TEST(pointsNeeded(1.1e-15, 1e-30) == 3);
  BOOST_TEST(pointsNeeded(0.1, 1e-30) >= 30);
  BOOST_TEST(pointsNeeded(0.1, 1e-30) <= 31);
  for (const double p : {0.3, 1e-3, 7e-9, 2e-17})
    for (const double target : {1e-2, 1e-20, 1e-30, 1e-100}) {
      const int k = pointsNeeded(p, target);
      BOOST_TEST(k * std::log10(p) <= std::log10(target) * (1 - 1e-12));
      BOOST_TEST((k == 1 || (k - 1) * std::log10(p) > std::log10(target) * (1 + 1e-12)));
    }
  BOOST_CHECK_THROW(pointsNeeded(1, 1e-30), std::invalid_argument);
  BOOST_CHECK_THROW(pointsNeeded(0.5, 0), std::invalid_argument);
  BOOST_CHECK_THROW(pointsNeeded(0.5, 1), std::invalid_argument);
}

BOOST_AUTO_TEST_CASE(the_chance_is_the_degree_over_the_prime_and_the_bits_over_the_primes) {
  const FormulaSizes sizes;
  PrimeField power = 1;
  for (int k = 0; k < 1000; ++k) power *= x();
  const double expected = 1000 / 0x1p62 + 250 / 62.0 / kPrimesDrawnFrom;
  BOOST_TEST(errorProbability(power, sizes) == expected, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(errorProbability(PrimeField(0), sizes) == 0);
  PrimeField huge = x();
  for (int k = 0; k < 63; ++k) huge *= huge;  // degree 2^63
  BOOST_TEST(std::isinf(errorProbability(huge, sizes)));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(checks)

BOOST_DATA_TEST_CASE(all_residuals_of_the_bundled_scenes_are_zero, data::make(sceneNames())) {
  const scene::Scene scene = scene::findScene(sample);
  requireAllZero(scene.mechanism, exactChecks(scene, {}),
                 scene.mechanism.isOpenTree() && !scene.mechanism.hasCoulombFriction());
}

BOOST_DATA_TEST_CASE(they_are_zero_for_every_robot_of_that_structure, data::make(sceneNames())) {
  ExactOptions options;
  options.parameters = Parameters::kRandom;
  const scene::Scene scene = scene::findScene(sample);
  const auto checks = exactChecks(scene, options);
  requireAllZero(scene.mechanism, checks, false);
  for (const CheckResult& check : checks)
    BOOST_TEST((!check.exact || check.exact->parameters == "random"));
}

BOOST_AUTO_TEST_CASE(the_same_seed_gives_the_same_points) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  const auto a = exactChecks(scene, {}), b = exactChecks(scene, {});
  ExactOptions other;
  other.seed = 2;
  const auto c = exactChecks(scene, other);
  for (std::size_t i = 0; i < a.size(); ++i) {
    BOOST_TEST(a[i].exact->prime == b[i].exact->prime);
    BOOST_TEST(a[i].exact->degree == b[i].exact->degree);
    BOOST_TEST(a[i].exact->prime != c[i].exact->prime);
  }
}

BOOST_AUTO_TEST_CASE(a_smaller_error_probability_takes_more_points) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  int before = 0;
  for (const double target : {1e-10, 1e-30, 1e-60, 1e-200}) {
    ExactOptions options;
    options.error_probability = target;
    const std::vector<CheckResult> checks = exactChecks(scene, options);
    const CheckResult tau =
        *std::find_if(checks.begin(), checks.end(),
                      [](const CheckResult& check) { return check.quantity == "tau"; });
    BOOST_TEST(tau.exact->error_probability <= target);
    BOOST_TEST(tau.exact->points > before);
    before = tau.exact->points;
  }
  ExactOptions wrong;
  wrong.error_probability = 0;
  BOOST_CHECK_THROW(exactChecks(scene, wrong), std::invalid_argument);
}

BOOST_AUTO_TEST_CASE(a_point_without_a_value_is_drawn_again_and_counted) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  std::vector<ExactWitness> witnesses = exactWitnesses(scene, Parameters::kAsWritten);
  int built = 0;
  witnesses[1].in_field = [&, inner = witnesses[1].in_field](const FieldNumbers& number) {
    const bool fails = !PrimeField::isSized() && built++ == 0;
    return
        [fails, answer = inner(number)](Quantity quantity, const scene::State<PrimeField>& state) {
          if (fails && quantity == Quantity::kc) PrimeField(0).inverse();
          return answer(quantity, state);
        };
  };
  for (const CheckResult& check : compareExactly(scene, witnesses, {})) {
    BOOST_TEST((check.verdict == Verdict::kAgree));
    const bool asks_it = check.left == "newton_euler" || check.right == "newton_euler";
    BOOST_TEST(check.exact->discarded == (check.quantity == "c" && asks_it ? 1 : 0));
    BOOST_TEST(check.exact->points == 2);
  }
}

BOOST_AUTO_TEST_CASE(a_singular_mass_matrix_leaves_forward_dynamics_unanswered) {
  const scene::Scene scene = singularScene();
  for (const CheckResult& check :
       compareExactly(scene, exactWitnesses(scene, Parameters::kAsWritten), {})) {
    const bool singular = check.quantity == "qdd";
    BOOST_TEST((check.verdict == (singular ? Verdict::kNotAnswerable : Verdict::kAgree)));
    BOOST_TEST(check.exact.has_value() == !singular);
    // by 0 at every point, or by a formula that is 0 as it stands
    if (singular) BOOST_TEST(check.reason.find("division by ") != std::string::npos, check.reason);
  }
}

// M = [2 2; 2 2] by hand: the laws that divide by an articulated inertia have no sides, and no
// other.
BOOST_AUTO_TEST_CASE(a_singular_mass_matrix_leaves_only_those_identities_unanswered_that_divide) {
  const scene::Scene scene = singularScene();
  std::set<std::string> dividing = {
      "forward dynamics undoes inverse dynamics", "projector",
      "projected inertia is symmetric",           "projected twice",
      "projections of force and motion are dual", "independence of the chosen root",
      "value function of Gauss' principle",       "accelerations give way to forces",
      "symmetric accelerations by force"};
  const auto requireJudgedAlone = [&](const std::vector<CheckResult>& checks,
                                      const std::string& reason) {
    for (const CheckResult& check : checks) {
      if (check.name() == "positive definite mass matrix") continue;
      const bool divides = dividing.count(check.name()) == 1;
      BOOST_TEST_CONTEXT(check.name() << ": " << check.reason) {
        BOOST_TEST((check.verdict == (divides ? Verdict::kNotAnswerable : Verdict::kAgree)));
        BOOST_TEST((check.reason.find(reason) != std::string::npos) == divides);
      }
    }
  };
  const auto exact = checkIdentitiesExactly(scene, {});
  BOOST_TEST(exact.size() == static_cast<std::size_t>(Identities::kCount));
  requireJudgedAlone(exact, "division by zero");

  // only the accelerations divide by the first joint's D = 0: M_A and f_A are found by then, and
  // doubles go on where the field stops
  dividing.erase("value function of Gauss' principle");
  const auto rounded = checkIdentities(scene, {});
  BOOST_TEST(rounded.size() == 1u + Identities::kCount);
  requireJudgedAlone(rounded, "M is singular");
  BOOST_TEST(rounded.front().name() == "positive definite mass matrix");
  BOOST_TEST((rounded.front().verdict == Verdict::kNotAnswerable));
  BOOST_TEST(rounded.front().reason.find("singular") != std::string::npos, rounded.front().reason);
}

// The other way round: the law can fail. A mass of -1 is refused in a scene file, not in a
// mechanism.
BOOST_AUTO_TEST_CASE(a_mass_matrix_that_is_negative_disagrees) {
  scene::Scene scene = singularScene();
  scene.mechanism.links.back().inertia.mass = scene::Number(-1);
  const CheckResult positive = checkIdentities(scene, {}).front();
  BOOST_TEST((positive.verdict == Verdict::kDisagree));
  BOOST_TEST(positive.reason == "D[1] is negative at state 0");
}

BOOST_AUTO_TEST_CASE(only_the_witnesses_asked_for_are_compared) {
  ExactOptions options;
  options.witnesses = selectWitnesses({"simbody", "newton_euler", "composite_body"});
  std::set<std::string> pairs;
  for (const CheckResult& check : exactChecks(scene::findScene("double_pendulum"), options))
    if (check.name() == "same" && check.quantity.find("_d") == std::string::npos)
      pairs.insert(check.quantity + " " + check.left + " " + check.right);
  BOOST_TEST((pairs == std::set<std::string>{"M newton_euler composite_body"}));
  options.witnesses =
      selectWitnesses({"simbody", "newton_euler"});  // simbody computes in double only
  BOOST_TEST(exactChecks(scene::findScene("double_pendulum"), options).size() ==
             static_cast<std::size_t>(Identities::kCount + PointLaws::kCount) +
                 derivativePairs(scene::findScene("double_pendulum").mechanism).size() +
                 secondPairs(scene::findScene("double_pendulum").mechanism).size() +
                 1);  // and the regressor
}

BOOST_AUTO_TEST_CASE(answers_of_other_shapes_disagree) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  std::vector<ExactWitness> witnesses = exactWitnesses(scene, Parameters::kAsWritten);
  witnesses[2].in_field = [inner = witnesses[2].in_field](const FieldNumbers& number) {
    return [answer = inner(number)](Quantity quantity, const scene::State<PrimeField>& state) {
      return MatrixX<PrimeField>(answer(quantity, state).topRows(1));
    };
  };
  const CheckResult check = compareExactly(scene, witnesses, {})[1];
  BOOST_TEST(check.right == "composite_body");
  BOOST_TEST((check.verdict == Verdict::kDisagree));
  BOOST_TEST(check.reason == "shapes differ: 2 x 2 and 1 x 2");
}

BOOST_AUTO_TEST_CASE(the_result_is_told_in_one_sentence) {
  const CheckResult check = exactChecks(scene::findScene("simple_pendulum"), {}).front();
  BOOST_TEST(
      describeExact(*check.exact)
          .rfind(
              "residual zero at 2 points modulo 63-bit primes; chance that different formulas pass "
              "at most ",
              0) == 0u);
}

BOOST_AUTO_TEST_CASE(inverse_dynamics_of_the_puma_is_compared_at_10_000_states_a_second) {
  const scene::Scene scene = scene::findScene("puma_560");
  const PrimeField::Modulus modulus(drawPrime(scene.name, 1, 0));
  const FieldNumbers number(scene.mechanism, FieldSource(scene.name, 1, 0));
  const auto witnesses = exactWitnesses(scene, Parameters::kAsWritten);
  const auto lagrange = witnesses[0].in_field(number), newton_euler = witnesses[1].in_field(number);
  constexpr int kStates = 5000;
  int different = 0;
  const std::clock_t start = std::clock();
  for (int i = 0; i < kStates; ++i) {
    const auto state = indeterminateState(scene.mechanism, FieldSource(scene.name, 1, i));
    different += lagrange(Quantity::kTau, state) != newton_euler(Quantity::kTau, state) ? 1 : 0;
  }
  const double rate = kStates / (static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  BOOST_TEST(different == 0);
  BOOST_TEST_MESSAGE("states a second: " << rate);  // 100 000 where this was written
#if defined(__OPTIMIZE__) && !defined(__SANITIZE_ADDRESS__)
  BOOST_TEST(rate >= 10000);
#endif
}

BOOST_AUTO_TEST_SUITE_END()
