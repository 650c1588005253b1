// SPDX-License-Identifier: GPL-3.0-or-later
// Friction of joints: part of tau, of no other term; published values; scenes that have it.
#include <algorithm>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/conductor/exact_checks.hpp"
#include "crosscheck/exact/exact.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/kernel/roads.hpp"
#include "crosscheck/motion/drift.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/scalars/dual.hpp"
#include "crosscheck/verdicts/check_drift.hpp"
#include "crosscheck/verdicts/check_identities.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/tables.hpp"
#include "crosscheck/witnesses/exact_sweeps.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "symbolic/derivation.hpp"
#include "symbolic/program.hpp"
#include "tests/fixtures/compiled_sweeps.hpp"
#include "tests/fixtures/fixtures.hpp"
#include "tests/fixtures/planted.hpp"

using namespace dynwitness;
using namespace dynwitness::fixtures;
using namespace dynwitness::crosscheck;
namespace data = boost::unit_test::data;

namespace {

scene::Scene pendulum(const std::string& friction, const std::string& more = "") {
  return scene::readSceneToml(
      "gravity = [0, 0, -10]\n[[link]]\nname = \"base\"\n"
      "[[link]]\nname = \"rod\"\nparent = \"base\"\nmass = 3\ncom = [1, 0, 0]\n"
      "inertia = { yy = 1, zz = 1 }\n"
      "[link.joint]\nname = \"pin\"\nkind = \"revolute\"\naxis = [0, 1, 0]\n" +
          more + (friction.empty() ? "" : "friction = " + friction + "\n") + "[start]\nqd = [1]\n",
      "pendulum.toml");
}

Q tauOf(const scene::Mechanism& m, const scene::State<Q>& state) {
  const auto model = recursive::buildModel(m, RationalNumbers(m));
  recursive::Workspace<Q> ws(model);
  std::vector<Q> tau(model.dof());
  recursive::inverseDynamics(model, state.x, state.qd, state.qdd, ws, tau);
  return tau[0];
}
Q tauOfLagrange(const scene::Mechanism& m, const scene::State<Q>& state) {
  symbolic::Equations e = symbolic::derive(m);
  const symbolic::Program program = symbolic::compile(e.graph, symbolic::inverseDynamics(e));
  return symbolic::ProgramRun<Q>(program, RationalNumbers(m))(state)[0];
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// By hand: 4 kg m^2 about the pin, weight 30 N at 1 m (c = 3/5, y down turns the rod up), friction
// on top.
BOOST_AUTO_TEST_CASE(a_rod_with_friction) {
  const auto m = pendulum("{ viscous = 0.5, coulomb = { positive = 2, negative = 7 } }").mechanism;
  const Q c = Q(3) / 5, s = Q(4) / 5;
  for (const auto& [qd, friction] :
       {std::pair(Q(6), Q(3) + 2), std::pair(Q(-6), Q(-3) - 7), std::pair(Q(0), Q(0))}) {
    const scene::State<Q> state = {{{Q(0), c, s}}, {qd}, {Q(5)}, {Q(0)}};
    const Q expected = 4 * Q(5) - 30 * c + friction;
    BOOST_TEST(tauOf(m, state) == expected);
    BOOST_TEST(tauOfLagrange(m, state) == expected);
  }
}

// Corke's numbers, as printed: with velocity, so that viscous and both directions' Coulomb friction
// count.
BOOST_AUTO_TEST_CASE(the_puma_560_meets_its_published_values) {
  const scene::Scene scene = scene::findScene("puma_560_friction");
  int compared = 0;
  for (const auto& table : bundledTables()) {
    if (!isAbout(table, scene)) continue;
    const auto kinds = selectWitnesses({"lagrange", "newton_euler", "simbody"});
    for (const CheckResult& check : compareWithTable(table, scene, kinds)) {
      ++compared;
      BOOST_TEST((check.verdict == Verdict::kAgree),
                 check.left << " " << check.right << " " << check.worst_entry << " off by "
                            << check.worst << " " << name(check.unit));
    }
  }
  BOOST_TEST(compared >= 3);
}

BOOST_AUTO_TEST_CASE(a_rate_without_a_sign_moves_forward) {
  BOOST_TEST(scene::directionOf(-0.5) == -1);
  BOOST_TEST(scene::directionOf(0.0) == 0);
  BOOST_TEST(scene::directionOf(Q(1) / 7) == 1);
  BOOST_TEST(directionOf(Dual<double>(-1.0, 5.0)) == -1);
  BOOST_TEST(directionOf(Ball(-2)) == -1);
  const PrimeField::Modulus modulus(drawPrime("sign", 1, 0));
  BOOST_TEST(scene::directionOf(PrimeField(-1)) == 1);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

// Every witness that is here, every quantity, every law: rounded and over the field.
BOOST_AUTO_TEST_CASE(everybody_agrees) {
  const scene::Scene scene = scene::findScene("puma_560_friction");
  Options options;
  options.states = 10;
  std::vector<std::string> names;
  for (const WitnessKind& kind : witnessKinds())
    if (kind.info.present && kind.info.name.rfind("kernel", 0) != 0)
      names.push_back(kind.info.name);
  for (const CheckResult& check : compareWitnesses(scene, selectWitnesses(names), options))
    BOOST_TEST((check.verdict == Verdict::kAgree),
               check.quantity << " " << check.left << " " << check.right << " ratio " << check.ratio
                              << " " << check.reason);
  for (const CheckResult& check : checkIdentities(scene, options))
    BOOST_TEST((check.verdict == Verdict::kAgree), check.name() << ": " << check.reason);
  for (const CheckResult& check : exactChecks(scene, {}))
    BOOST_TEST((check.verdict == Verdict::kAgree),
               check.name() << " " << check.quantity << ": " << check.reason);
}

// By its definition: friction is in tau alone, and what it takes is never negative.
BOOST_AUTO_TEST_CASE(friction_is_no_part_of_M_c_and_g) {
  const auto with = pendulum("{ viscous = 3, coulomb = 2 }"), without = pendulum("");
  Setup<double> a(with.mechanism, scene::RealNumbers<double>(with.mechanism));
  Setup<double> b(without.mechanism, scene::RealNumbers<double>(without.mechanism));
  for (int k = 0; k < 20; ++k) {
    const scene::State<double> state = drawState(with.mechanism, "pendulum", 1, k);
    for (const Quantity same :
         {Quantity::kM, Quantity::kc, Quantity::kg, Quantity::kKinetic, Quantity::kReactions})
      BOOST_TEST((NewtonEuler::answer(a, same, state) == NewtonEuler::answer(b, same, state)));
    const double taken = recursive::frictionPower(a.model, state.qd);
    BOOST_TEST(taken > 0);
    const double more = NewtonEuler::answer(a, Quantity::kTau, state)(0) -
                        NewtonEuler::answer(b, Quantity::kTau, state)(0);
    BOOST_TEST(std::abs(more * state.qd[0] - taken) <
               1e-13 * 40);  // 40 J/s at the most, 4 roundings each
  }
}

BOOST_AUTO_TEST_CASE(kernels_have_viscous_friction_and_no_signs) {
  using kernel::Formula;
  const auto viscous =
      kernel::smallestRoad(pendulum("{ viscous = 3 }").mechanism, Formula::kInverseDynamics);
  const auto none = kernel::smallestRoad(pendulum("").mechanism, Formula::kInverseDynamics);
  BOOST_TEST(viscous.operations() == none.operations() + 2);
  BOOST_CHECK_THROW(
      kernel::smallestRoad(pendulum("{ coulomb = 3 }").mechanism, Formula::kInverseDynamics),
      std::domain_error);
}

BOOST_AUTO_TEST_CASE(the_derivation_holds) {
  const auto derived = symbolic::derivation(pendulum("{ viscous = 3, coulomb = 2 }").mechanism);
  BOOST_TEST(derived.holds());
  BOOST_TEST(symbolic::print(derived, symbolic::Style::kText).find("sign") != std::string::npos);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(conservation)

// E falls; with what friction has taken it stays, to the integrator's order.
BOOST_AUTO_TEST_CASE(viscous_friction_takes_what_is_missing) {
  const scene::Scene scene = pendulum("{ viscous = 0.5 }");
  const Drift drift = measureDrift(scene, {});
  BOOST_TEST((checkDrift(scene, drift).verdict == Verdict::kAgree));
  BOOST_TEST(drift.observed_order > 3);
}

BOOST_AUTO_TEST_CASE(nobody_claims_energy_with_coulomb_friction) {
  const scene::Scene scene = pendulum("{ coulomb = 0.5 }");
  BOOST_CHECK_EXCEPTION(measureDrift(scene, {}), scene::InputError, [](const auto& e) {
    return std::string(e.what()).find("has Coulomb friction") != std::string::npos;
  });
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(planted_faults)

namespace {

template <typename Algorithm>
int disagreeing(const std::string& friction, const fixtures::Planted<recursive::Model>& change) {
  const scene::Scene scene = pendulum(friction);
  std::vector<ExactWitness> witnesses =
      exactWitnesses(scene, Parameters::kAsWritten, selectWitnesses({"lagrange"}));
  witnesses.push_back(sweepWitness<Algorithm>(scene, change));
  int count = 0;
  for (const CheckResult& check : compareExactly(scene, witnesses, {}))
    count += check.verdict == Verdict::kDisagree;
  return count;
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_wrong_sign_and_a_lost_term_are_seen) {
  const auto nothing = [](auto&, const auto&) {};
  const auto sign = [](auto& model, const auto&) {
    model.links[0].viscous = -model.links[0].viscous;
  };
  const auto lost = [](auto& model, const auto&) { model.friction = false; };
  const std::string both = "{ viscous = 3, coulomb = 2 }", dry = "{ coulomb = 2 }";
  BOOST_TEST(disagreeing<NewtonEuler>(both, nothing) == 0);
  BOOST_TEST(disagreeing<NewtonEuler>(both, sign) == 1);  // tau
  BOOST_TEST(disagreeing<NewtonEuler>(dry, lost) == 1);
  BOOST_TEST(disagreeing<ArticulatedBody>(both, sign) == 1);  // qdd
  BOOST_TEST(disagreeing<ArticulatedBody>(dry, lost) == 1);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(scenes)

BOOST_AUTO_TEST_CASE(written_and_read_again) {
  for (const char* friction :
       {"{ viscous = 0.5 }", "{ coulomb = 2 }", "{ viscous = 1, coulomb = 2 }",
        "{ coulomb = { positive = 1, negative = 2 } }",
        "{ viscous = 3, coulomb = { negative = 2 } }"}) {
    const std::string text = scene::writeSceneToml(pendulum(friction));
    BOOST_TEST(text.find("friction = ") != std::string::npos);
    const scene::Scene again = scene::readSceneToml(text, "pendulum.toml");
    BOOST_TEST(scene::writeSceneToml(again) == text);
    const scene::Friction a = pendulum(friction).mechanism.links[1].joint.friction,
                          b = again.mechanism.links[1].joint.friction;
    BOOST_TEST(a.viscous.text() == b.viscous.text());
    BOOST_TEST(a.positive.text() == b.positive.text());
    BOOST_TEST(a.negative.text() == b.negative.text());
  }
}

BOOST_AUTO_TEST_CASE(urdf_has_words_for_the_symmetric_kind) {
  const std::string urdf = scene::writeSceneUrdf(pendulum("{ viscous = 0.5, coulomb = 2 }"));
  BOOST_TEST(urdf.find("<dynamics damping=\"0.5\" friction=\"2\"/>") != std::string::npos);
  const scene::Scene again = scene::readSceneUrdf(urdf, "pendulum.urdf");
  BOOST_TEST(again.mechanism.links[1].joint.friction.viscous.text() == "0.5");
  BOOST_TEST(again.mechanism.links[1].joint.friction.positive.text() == "2");
  BOOST_TEST(again.mechanism.links[1].joint.friction.negative.text() == "2");
  BOOST_TEST(scene::writeSceneUrdf(pendulum("{ coulomb = { positive = 1 } }"))
                 .find("Coulomb friction that is not the same both ways") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(impossible_friction_is_refused) {
  const auto refused = [](const std::string& friction, const std::string& why) {
    BOOST_CHECK_EXCEPTION(pendulum(friction), scene::InputError, [&](const auto& e) {
      BOOST_TEST_MESSAGE(e.what());
      return std::string(e.what()).find(why) != std::string::npos;
    });
  };
  refused("{ viscous = -1 }", "friction: viscous is -1, allowed: zero or more");
  refused("{ coulomb = -1 }", "friction: coulomb is -1");
  refused("{ coulomb = { negative = -1 } }", "friction: coulomb.negative is -1");
  refused("{ dry = 1 }", "pendulum.toml:");
  refused("3", "friction: an integer, allowed: ");
}

BOOST_AUTO_TEST_SUITE_END()
