// SPDX-License-Identifier: GPL-3.0-or-later
// The programs that kernels are made of: the same functions as the sweeps, and how many operations.

#include <map>
#include <string>
#include <vector>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/kernel/factor.hpp"
#include "crosscheck/kernel/general_cost.hpp"
#include "crosscheck/kernel/lean_sweeps.hpp"
#include "crosscheck/kernel/roads.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "recursive/build_model.hpp"
#include "scene/scene.hpp"
#include "symbolic/program.hpp"
#include "tests/fixtures/counted_arms.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using namespace dynwitness::crosscheck::kernel;

namespace {

/// One random point modulo a random prime: the sweeps of recursive/, run there, are the other road.
class Point {
 public:
  Point(const scene::Scene& scene, std::uint64_t index)
      : modulus_(drawPrime(scene.name, 7, index)),
        source_(scene.name, 7, index),
        numbers_(scene.mechanism, source_, Parameters::kAsWritten),
        state_(indeterminateState(scene.mechanism, source_)),
        setup_(recursive::buildModel(scene.mechanism, numbers_)) {}

  std::vector<PrimeField> program(const symbolic::Program& p) const {
    return symbolic::ProgramRun<PrimeField>(p, numbers_)(state_);
  }
  std::vector<PrimeField> sweeps(Formula formula) {
    switch (formula) {
      case Formula::kInverseDynamics:
        return list(ask<NewtonEuler>(Quantity::kTau));
      case Formula::kMassMatrix:
        return list(ask<CompositeBody>(Quantity::kM));
      case Formula::kCoriolis:
        return list(ask<NewtonEuler>(Quantity::kc));
      case Formula::kGravity:
        return list(ask<NewtonEuler>(Quantity::kg));
      case Formula::kForwardDynamics:
        return list(ask<ArticulatedBody>(Quantity::kQdd));
      case Formula::kMassCoriolisGravity:
        break;
    }
    std::vector<PrimeField> all = sweeps(Formula::kMassMatrix);
    for (const Formula more : {Formula::kCoriolis, Formula::kGravity})
      for (const PrimeField x : sweeps(more)) all.push_back(x);
    return all;
  }

 private:
  template <typename Algorithm>
  MatrixX<PrimeField> ask(Quantity quantity) {
    return Algorithm::answer(setup_, quantity, state_);
  }
  static std::vector<PrimeField> list(const MatrixX<PrimeField>& m) {  // M is symmetric
    return {m.data(), m.data() + m.size()};
  }

  PrimeField::Modulus modulus_;
  FieldSource source_;
  FieldNumbers numbers_;
  scene::State<PrimeField> state_;
  Setup<PrimeField> setup_;
};

void everyRoadIsTheSameFunction(const scene::Scene& scene) {
  for (const Formula formula : kAllFormulas) {
    for (const Road& road : roads(scene.mechanism, formula)) {
      for (std::uint64_t index : {0, 1}) {
        Point point(scene, index);
        BOOST_TEST((point.program(road.program) == point.sweeps(formula)),
                   scene.name << ": " << name(formula) << " by " << name(road.kind));
      }
    }
  }
}

symbolic::Program::Operations operations(const scene::Scene& scene, Formula formula) {
  return smallestRoad(scene.mechanism, formula).program.bodyOperations();
}

const std::vector<std::string> kScenes = {
    "double_pendulum",        "cart_pole",    "furuta_pendulum", "scara",
    "elastic_pendulum",       "stanford_arm", "puma_560",        "franka_panda",
    "prismatic_revolute_mix", "heavy_top",    "lead_screw",      "satellite_arm"};

}  // namespace

BOOST_AUTO_TEST_SUITE(same_mathematics)

BOOST_DATA_TEST_CASE(every_road_is_the_same_function_for_bundled_scenes, data::make(kScenes),
                     name) {
  everyRoadIsTheSameFunction(scene::findScene(name));
}

// branches, slides, slanted axes, springs, loads in link and world axes
BOOST_DATA_TEST_CASE(every_road_is_the_same_function_for_random_trees, data::xrange(12), index) {
  scene::Scene scene = randomTreeScene(11, static_cast<std::uint64_t>(index), 5);
  for (scene::Link& link : scene.mechanism.links)  // a program has no sign for Coulomb's part
    link.joint.friction.positive = link.joint.friction.negative = scene::Number(0);
  everyRoadIsTheSameFunction(scene);
}

/// All lean sweeps of a model are those of recursive/.
void leanSweepsHold(const scene::Scene& scene, const LeanModel& model,
                    const scene::State<Traced>& state, const std::string& after, bool factor) {
  symbolic::Graph& graph = Traced::graph();
  for (const Turning turning : {Turning::kInSteps, Turning::kByMatrix}) {
    const std::pair<Formula, std::vector<Traced>> all[] = {
        {Formula::kInverseDynamics, inverseDynamics(model, state, {}, turning)},
        {Formula::kMassMatrix, massMatrix(model, state, turning)},
        {Formula::kGravity, gravity(model, state, turning)}};
    for (const auto& [formula, values] : all) {
      std::vector<symbolic::Node> nodes;
      for (const Traced& value : values) nodes.push_back(value.node());
      Point point(scene, 3);
      BOOST_TEST((point.program(symbolic::compile(graph, nodes)) == point.sweeps(formula)),
                 name(formula) << " after " << after);
      if (factor)
        BOOST_TEST((point.program(factored(graph, nodes)) == point.sweeps(formula)),
                   name(formula) << " after " << after << ", factored");
    }
  }
}

// Every choice of links whose axes stay: next to parallel axes, the same way round, opposite and
// turned by an angle, next to square and slanted ones, to a slide, and at a branch; with a spring
// and a load.
BOOST_AUTO_TEST_CASE(axes_that_stay_change_no_function) {
  const std::string some = "mass = 1\ninertia = {about = \"com\", xx = 1, yy = 1, zz = 1}";
  scene::Scene scene = counted::withGeneralInertias(
      counted::arm("stay", {{"", some},
                            {"alpha = \"-pi/2\", d = 0.2", some},
                            {"a = 0.4, d = -0.1", some},
                            {"alpha = \"pi\", a = 0.3, d = 0.05, theta = 0.4", some},
                            {"alpha = \"pi/2\", a = 0.1", some, "prismatic"},
                            {"alpha = 0.7, a = 0.2, d = 0.6", some},
                            {"theta = \"pi/2\"", some}}));
  scene.mechanism.links[6].parent = 3;
  scene.mechanism.links[4].joint.stiffness = scene.mechanism.links[4].joint.rest =
      scene::Rational(2, 3);
  scene::Wrench load;
  load.link = 4;
  for (int k = 0; k < 3; ++k) {
    load.force[k] = load.at[k] = scene::Rational(k + 1, 7);
    load.moment[k] = scene::Rational(k - 3, 5);
  }
  scene.mechanism.wrenches = {load};
  symbolic::Graph graph;
  const Traced::Recording recording(graph);
  const scene::State<Traced> state = tracedState(scene.mechanism);
  LeanModel model =
      leanModel(recursive::buildModel(scene.mechanism, TracedNumbers(scene.mechanism)));
  const int n = static_cast<int>(model.links.size());
  for (int stay = 0; stay < 1 << n; ++stay) {
    for (int i = 0; i < n; ++i) model.links[i].stays = model.links[i].turns && (stay >> i & 1);
    if (model.links[4].turns || !(stay >> 4 & 1))  // the slide has no such choice
      leanSweepsHold(scene, model, state, "axes " + std::to_string(stay) + " stay", false);
  }
}

// whatever the search tries, whether it keeps it or not
BOOST_AUTO_TEST_CASE(moved_origins_taken_masses_and_units_change_no_function) {
  const scene::Scene scene = counted::withGeneralInertias(scene::findScene("puma_560"));
  symbolic::Graph graph;
  const Traced::Recording recording(graph);
  const scene::State<Traced> state = tracedState(scene.mechanism);
  LeanModel model =
      leanModel(recursive::buildModel(scene.mechanism, TracedNumbers(scene.mechanism)));
  const auto number = [&](int n, int d) { return Traced(graph.constant(scene::Rational(n, d))); };
  const auto holds = [&](const char* after) { leanSweepsHold(scene, model, state, after, true); };
  holds("nothing");
  slide(model, 1, number(3, 7));
  slide(model, 5, number(-2, 5));
  holds("slide, with masses");
  regroup(model);
  holds("regroup");
  slide(model, 2, number(1, 3));
  takeRod(model, 3, {number(5, 3), number(2, 9), number(-4, 7)});
  takeRod(model, 1, {number(-7, 4), 0, number(1, 8)});
  holds("takeRod");
  BOOST_TEST(scaleLengths(model, number(4318, 10000)));
  holds("scaleLengths");

  // red when one of the moves is wrong: a mass that nobody took
  model.links[3].mass += number(1, 1000000);
  std::vector<symbolic::Node> nodes;
  for (const Traced& value : massMatrix(model, state)) nodes.push_back(value.node());
  Point point(scene, 3);
  BOOST_TEST(
      (point.program(symbolic::compile(graph, nodes)) != point.sweeps(Formula::kMassMatrix)));
}

BOOST_AUTO_TEST_CASE(each_instruction_matters_and_the_field_sees_it) {
  const scene::Scene scene = scene::findScene("furuta_pendulum");
  for (const Formula formula :
       {Formula::kInverseDynamics, Formula::kMassMatrix, Formula::kForwardDynamics}) {
    const symbolic::Program program = smallestRoad(scene.mechanism, formula).program;
    Point point(scene, 0);
    const std::vector<PrimeField> right = point.sweeps(formula);
    for (std::size_t i = 0; i < program.body.size(); ++i) {
      using Code = symbolic::Program::Code;
      symbolic::Program wrong = program;
      Code& code = wrong.body[i].code;
      code = code == Code::kAdd       ? Code::kSubtract
             : code == Code::kInverse ? Code::kNegate
                                      : Code::kAdd;
      BOOST_TEST((point.program(wrong) != right), name(formula) << ", instruction " << i);
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(closures_and_springs_between_points_are_refused) {
  BOOST_CHECK_EXCEPTION(smallestRoad(scene::findScene("bricard").mechanism, Formula::kMassMatrix),
                        std::runtime_error, [](const std::exception& e) {
                          return std::string(e.what()).find("open trees") != std::string::npos;
                        });
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bounds)

std::string refusal(const std::string& scene, Formula formula) {
  try {
    smallestRoad(scene::findScene(scene).mechanism, formula);
  } catch (const NotUsed& why) {
    return why.what();
  }
  return "";
}

BOOST_AUTO_TEST_CASE(straight_lines_that_are_too_long_are_not_used) {
  for (const Formula formula :
       {Formula::kInverseDynamics, Formula::kMassMatrix, Formula::kForwardDynamics}) {
    BOOST_TEST(refusal("chain_64", formula).find("no kernel of " + std::string(name(formula))) ==
               0u);
    BOOST_TEST(refusal("chain_1000", formula).find("1000 degrees of freedom, at most 256") !=
               std::string::npos);
    BOOST_TEST(refusal("puma_560", formula) == "");
  }
}

BOOST_AUTO_TEST_CASE(no_program_is_larger_than_what_it_replaces_or_than_what_is_compiled) {
  for (const char* scene :
       {"chain_16", "planar_chain_5", "humanoid", "heavy_top", "simple_pendulum"})
    for (const Formula formula :
         {Formula::kInverseDynamics, Formula::kMassMatrix, Formula::kForwardDynamics}) {
      const scene::Mechanism mechanism = scene::findScene(scene).mechanism;
      if (!refusal(scene, formula).empty()) continue;
      const int operations = smallestRoad(mechanism, formula).operations();
      BOOST_TEST(operations <= kMostOperations);
      BOOST_TEST(operations < generalOperations(mechanism, formula));
    }
}

// the same links over and over, so that each adds the same: a count that depended on anything else
// would not
BOOST_AUTO_TEST_CASE(general_operations_grow_with_the_links_and_with_the_entries_of_M) {
  const auto count = [](int links, Formula formula) {
    return generalOperations(scene::findScene("chain_" + std::to_string(links)).mechanism, formula);
  };
  for (const Formula formula : {Formula::kInverseDynamics, Formula::kForwardDynamics})
    BOOST_TEST(count(96, formula) - count(64, formula) == count(64, formula) - count(32, formula));
  const long m32 = count(32, Formula::kMassMatrix), m64 = count(64, Formula::kMassMatrix),
             m96 = count(96, Formula::kMassMatrix), m128 = count(128, Formula::kMassMatrix);
  BOOST_TEST((m128 - m96) - (m96 - m64) == (m96 - m64) - (m64 - m32));
  BOOST_TEST(m64 > 2 * m32);
  // of tau like M, n^2 entries of a chain; of qdd n^3, by a solution of so many columns
  const auto of = [](int links, bool accelerations) {
    return generalDerivativeOperations(scene::findScene("chain_" + std::to_string(links)).mechanism,
                                       accelerations);
  };
  const long t16 = of(16, false), t32 = of(32, false), t48 = of(48, false), t64 = of(64, false);
  BOOST_TEST((t64 - t48) - (t48 - t32) == (t48 - t32) - (t32 - t16));
  // packs of columns come by twelve, so by three blocks, at a time
  const long a24 = of(24, true), a48 = of(48, true), a72 = of(72, true), a96 = of(96, true),
             a120 = of(120, true);
  BOOST_TEST((a120 - 3 * a96 + 3 * a72 - a48) == (a96 - 3 * a72 + 3 * a48 - a24));
  BOOST_TEST(of(8, true) > of(8, false));
}

// by hand, line by line in sine_cosine.inc: 16 of the reduction, z and z/2, 16 a polynomial, 6 of
// the sine and 9 of the cosine beside
BOOST_AUTO_TEST_CASE(a_sine_and_a_cosine_are_so_many_operations) {
  BOOST_TEST(sineCosineOperations() == 14 + 2 + 2 * 16 + 6 + 9);
}

// Sums of six of eight values each, another eight every time: twice as many sums are twice the
// work. (Pairs were once counted anew after each that was shared, which made it four times.)
BOOST_AUTO_TEST_CASE(sharing_pairs_takes_no_more_than_the_sums_are_long) {
  const auto steps = [](int sums) {
    symbolic::Graph graph;
    std::vector<symbolic::Node> outputs;
    for (int k = 0; k < sums; ++k) {
      symbolic::Node total;
      for (int i = 0; i < 8; ++i)
        if (i != k % 8 && i != (k / 8) % 8)
          total = graph.add(total, graph.input(symbolic::Input::kVelocity, k / 8 * 8 + i));
      outputs.push_back(total);
    }
    long done = 0;
    factored(graph, outputs, Effort::kQuick, &done);
    return done;
  };
  const double ratio = static_cast<double>(steps(256)) / static_cast<double>(steps(128));
  BOOST_TEST(ratio < 2.5);
  BOOST_TEST(ratio > 1.5);
}

BOOST_AUTO_TEST_SUITE_END()

// What the literature reached (counted_arms.hpp), and what ours take in all: neither may grow.
BOOST_AUTO_TEST_SUITE(operation_counts)

BOOST_AUTO_TEST_CASE(our_programs_take_no_more_than_the_best_known) {
  const std::vector<counted::Fewest> all = counted::fewest();
  const std::vector<int> ours = {421, 230, 587, 268,
                                 494, 257, 222, 194};  // in the order of fewest()
  BOOST_REQUIRE(all.size() == ours.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const counted::Fewest& best = all[i];
    const auto o = operations(best.make(), best.formula);
    const auto at_most = [&](int count, int limit, const char* what) {
      BOOST_TEST((limit == 0 || count <= limit), best.arm << " " << name(best.formula) << ": "
                                                          << count << " " << what << ", allowed "
                                                          << limit);
    };
    at_most(o.multiplications, best.multiplications, "multiplications");
    at_most(o.additions, best.additions, "additions");
    at_most(o.multiplications + o.additions, best.in_all, "operations");
    at_most(o.multiplications + o.additions, ours[i], "operations");
  }
}

BOOST_AUTO_TEST_CASE(each_road_of_armstrongs_puma_is_the_same_function) {
  everyRoadIsTheSameFunction(counted::armstrongsPuma());
}

BOOST_AUTO_TEST_SUITE_END()
