// SPDX-License-Identifier: GPL-3.0-or-later
// Gyroscopic rotors: against the same rotors as bodies of their own, which turn on the parent by a
// joint.
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/conductor/exact_checks.hpp"
#include "crosscheck/exact/exact.hpp"
#include "crosscheck/studies/rotor_models.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/witnesses/exact_sweeps.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "recursive/reactions.hpp"
#include "tests/fixtures/compiled_sweeps.hpp"
#include "tests/fixtures/fixtures.hpp"
#include "tests/fixtures/planted.hpp"

using namespace dynwitness;
using namespace dynwitness::fixtures;
using namespace dynwitness::crosscheck;
namespace data = boost::unit_test::data;

namespace {

constexpr int kSeeds = 6;

/// A scene text: a cart that slides, a helical, a turning and a sliding joint, each with such a
/// rotor.
std::string armText(const std::string& rotor, const std::string& mass = "2") {
  return "gravity = [1, 2, -9]\n"
         "[[link]]\nname = \"ground\"\n"
         "[[link]]\nname = \"a\"\nparent = \"ground\"\nmass = " +
         mass +
         "\ncom = [0.1, 0.2, 0.3]\n"
         "inertia = { xx = 3, yy = 4, zz = 5, xy = 0.1 }\n"
         "[link.joint]\nkind = \"revolute\"\naxis = [3, 4, 12]\n" +
         rotor +
         "[[link]]\nname = \"b\"\nparent = \"a\"\nmass = 1\ncom = [0.2, -0.1, 0]\n"
         "inertia = { xx = 2, yy = 3, zz = 4 }\n"
         "[link.joint]\nkind = \"helical\"\npitch = 0.25\nxyz = [0.5, 0, 0]\naxis = [0, -1, 0]\n" +
         rotor +
         "[[link]]\nname = \"c\"\nparent = \"b\"\nmass = 1\ncom = [0, 0, 0.5]\n"
         "inertia = { xx = 2, yy = 2, zz = 2 }\n"
         "[link.joint]\nkind = \"prismatic\"\nrpy = [\"pi/2\", 0, 0]\naxis = [3, 0, 4]\n" +
         rotor +
         "[[link]]\nname = \"d\"\nparent = \"c\"\nmass = 1\ncom = [0.3, 0, 0]\n"
         "inertia = { xx = 1, yy = 1, zz = 1 }\n"
         "[link.joint]\nkind = \"revolute\"\n"
         "mdh = { a = 0.4, alpha = \"pi/2\", d = 0.1, theta = 0 }\n" +
         rotor;
}
scene::Scene arm(
    const std::string& rotor = "rotor_inertia = 0.125\ngear_ratio = -3\ngyroscopic = true\n") {
  return scene::readSceneToml(armText(rotor), "arm.toml");
}

/** The same with every rotor a body: a point-like disc on the parent (no mass, inertia J about the
    joint's axis only), turning about that axis by a joint of its own, at rate n qd. The rotor's
    inertia is about its axis alone, so what the parent's includes of it as it stands is J z z',
    which is taken off. */
struct WithBodies {
  recursive::Model<Q> model;
  std::vector<int> rotor_of;  ///< rate of the scene -> rate of its rotor in `model`

  WithBodies(const scene::Mechanism& m, const recursive::Model<Q>& plain) {
    using namespace recursive;
    const RationalNumbers number(m);
    model = plain;
    model.gyroscopic = false;
    rotor_of.assign(plain.dof(), -1);
    for (std::size_t i = 0; i < plain.links.size(); ++i) {
      LinkModel<Q>& link = model.links[i];
      const scene::Joint& joint = m.links[i + 1].joint;  // all of these joints have one part
      const Q J = number(joint.rotor_inertia);
      link.rotor = link.spin = Q(0);
      RigidInertia<Q> disc = RigidInertia<Q>::zero();
      disc.I.zz = J;
      LinkModel<Q> rotor;
      rotor.parent = link.parent;
      rotor.kind = scene::JointKind::kRevolute;
      rotor.X_tree = link.X_tree;
      rotor.M = disc;
      rotor.dof = model.dof();
      rotor.slot = model.positions++;
      rotor_of[link.dof] = rotor.dof;
      if (link.parent >= 0) {
        const RigidInertia<Q> standing = link.X_tree.inverseTimes(disc);
        model.links[link.parent].M.I = model.links[link.parent].M.I - standing.I;
      }
      model.link_of_dof.push_back(static_cast<int>(model.links.size()));
      model.links.push_back(rotor);
    }
  }
};

}  // namespace

BOOST_AUTO_TEST_SUITE(identities)

// By another model: full rigid bodies, no spin in any formula; virtual work brings the rotor's
// moment n times to its joint.
BOOST_DATA_TEST_CASE(the_rotor_is_a_body_on_the_parent, data::xrange(kSeeds), seed) {
  const scene::Scene scene = arm();
  const scene::Mechanism& m = scene.mechanism;
  const auto model = recursive::buildModel(m, RationalNumbers(m));
  const WithBodies bodies(m, model);
  const Q n = -3;
  const scene::State<Q> state = randomState(4, seed);
  scene::State<Q> both = state;
  for (int i = 0; i < 4; ++i) {
    both.x.push_back(randomState(1, 100 * seed + i).x[0]);  // any angle: the rotor is symmetric
    both.qd.push_back(n * state.qd[i]);
    both.qdd.push_back(n * state.qdd[i]);
  }
  recursive::Workspace<Q> ws(model), ws_bodies(bodies.model);
  std::vector<Q> tau(4), tau_bodies(8), expected(4), qdd(4);
  recursive::inverseDynamics(model, state.x, state.qd, state.qdd, ws, tau);
  recursive::inverseDynamics(bodies.model, both.x, both.qd, both.qdd, ws_bodies, tau_bodies);
  for (int i = 0; i < 4; ++i) expected[i] = tau_bodies[i] + n * tau_bodies[bodies.rotor_of[i]];
  BOOST_TEST(mismatch(tau, expected) == "");
  for (int i = 0; i < 4; ++i)
    BOOST_TEST((ws.f[i].vector() == ws_bodies.f[i].vector()), "reaction of joint " << i + 1);

  // energy, momentum, M, C and forward dynamics follow
  BOOST_TEST(recursive::kineticEnergy(model, state.x, state.qd, ws) ==
             recursive::kineticEnergy(bodies.model, both.x, both.qd, ws_bodies));
  // ... of the bodies, but for the rotor that the ground carries
  auto momentum = recursive::momentum(bodies.model, both.x, both.qd, ws_bodies);
  momentum = momentum - ws_bodies.X_up[4].inverseTimes(bodies.model.links[4].M * ws_bodies.v[4]);
  BOOST_TEST((recursive::momentum(model, state.x, state.qd, ws).vector() == momentum.vector()));
  recursive::MatrixX<Q> M(4, 4), M_bodies(8, 8), E = recursive::MatrixX<Q>::Constant(8, 4, Q(0));
  for (int i = 0; i < 4; ++i) {
    E(i, i) = Q(1);
    E(bodies.rotor_of[i], i) = n;
  }
  recursive::massMatrix(model, state.x, ws, M);
  recursive::massMatrix(bodies.model, both.x, ws_bodies, M_bodies);
  BOOST_TEST(mismatch(M, E.transpose() * M_bodies * E) == "");
  const auto C = recursive::coriolisMatrix(model, state.x, state.qd, ws);
  const auto C_bodies = recursive::coriolisMatrix(bodies.model, both.x, both.qd, ws_bodies);
  BOOST_TEST(mismatch(C, E.transpose() * C_bodies * E) == "");
  recursive::forwardDynamics(model, state.x, state.qd, tau, ws, qdd);
  BOOST_TEST(mismatch(qdd, state.qdd) == "");
}

// All witnesses and laws over the field, Simbody within its bound.
BOOST_AUTO_TEST_CASE(everybody_agrees) {
  for (const scene::Scene& scene : {arm(), scene::findScene("gyroscopic_wrist")}) {
    for (const CheckResult& check : exactChecks(scene, {}))
      BOOST_TEST((check.verdict == Verdict::kAgree),
                 scene.name << ": " << check.name() << " " << check.quantity << " " << check.left
                            << " " << check.right << ": " << check.reason);
    Options options;
    options.states = 10;
    int by_simbody = 0;
    for (const CheckResult& check : compareWitnesses(
             scene, selectWitnesses({"newton_euler", "articulated_body", "simbody"}), options)) {
      by_simbody += check.right == "simbody";
      BOOST_TEST((check.verdict == Verdict::kAgree),
                 scene.name << ": " << check.quantity << " " << check.left << " " << check.right
                            << " ratio " << check.ratio << ": " << check.reason);
    }
    BOOST_TEST(by_simbody == 9);
  }
}

// Where the ground carries the rotor, or a slider, it is n^2 J and nothing else.
BOOST_AUTO_TEST_CASE(no_difference_where_the_parent_does_not_turn) {
  const std::string slide_and_turn =
      "[[link]]\nname = \"ground\"\n"
      "[[link]]\nname = \"cart\"\nparent = \"ground\"\nmass = 2\n"
      "inertia = { xx = 1, yy = 1, zz = 1 }\n"
      "[link.joint]\nkind = \"prismatic\"\nrotor_inertia = 0.1\ngear_ratio = 7\n"
      "[[link]]\nname = \"arm\"\nparent = \"cart\"\nmass = 1\ncom = [1, 0, 0]\n"
      "[link.joint]\nkind = \"revolute\"\naxis = [1, 2, 2]\nrotor_inertia = 0.1\ngear_ratio = 7\n";
  const RotorModels none =
      compareRotorModels(scene::readSceneToml(slide_and_turn, "cart.toml"), 20, 1);
  for (const RotorModels::Joint& joint : none.joints) BOOST_TEST(joint.largest == 0);
  const RotorModels some = compareRotorModels(arm(), 20, 1);
  for (const RotorModels::Joint& joint : some.joints) {
    BOOST_TEST(joint.largest > 0);
    // n J is linear in n at a given n^2 J; rounding of tau, some 100 N m, is all that is between
    BOOST_TEST(std::abs(joint.at_ten_times / joint.largest - 0.1) < 1e-10);
  }
}

// Others say that they cannot.
BOOST_AUTO_TEST_CASE(engines_with_an_armature_refuse) {
  for (const WitnessKind& kind : witnessKinds()) {
    if (!kind.info.present) continue;
    if (kind.info.name != "mujoco" && kind.info.name != "kdl" && kind.info.name != "dart") continue;
    const auto witness = kind.make(scene::findScene("gyroscopic_wrist"));
    BOOST_TEST_REQUIRE(witness.isRefused(), kind.info.name);
    BOOST_TEST(witness.refusal().find("gyroscopic") != std::string::npos, witness.refusal());
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(planted_faults)

namespace {

template <typename Algorithm>
int disagreeing(const fixtures::Planted<recursive::Model>& change) {
  const scene::Scene scene = arm();
  std::vector<ExactWitness> witnesses =
      exactWitnesses(scene, Parameters::kAsWritten, selectWitnesses({"lagrange"}));
  witnesses.push_back(sweepWitness<Algorithm>(scene, change));
  int count = 0;
  for (const CheckResult& check : compareExactly(scene, witnesses, {}))
    count += check.verdict == Verdict::kDisagree;
  return count;
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_wrong_sign_and_lost_rotors_are_seen) {
  const auto nothing = [](auto&, const auto&) {};
  const auto sign = [](auto& model, const auto&) { model.links[2].spin = -model.links[2].spin; };
  const auto lost = [](auto& model, const auto&) { model.gyroscopic = false; };
  const auto one_lost = [](auto& model, const auto& number) {
    using T = typename std::decay_t<decltype(number)>::Scalar;
    model.links[3].spin = T(0);
  };
  BOOST_TEST(disagreeing<NewtonEuler>(nothing) == 0);
  BOOST_TEST(disagreeing<CompositeBody>(nothing) == 0);
  BOOST_TEST(disagreeing<ArticulatedBody>(nothing) == 0);
  BOOST_TEST(disagreeing<NewtonEuler>(sign) == 5);  // M, c, tau, kinetic, reactions
  BOOST_TEST(disagreeing<NewtonEuler>(lost) == 5);
  BOOST_TEST(disagreeing<NewtonEuler>(one_lost) == 5);
  BOOST_TEST(disagreeing<CompositeBody>(sign) == 2);  // M, qdd
  BOOST_TEST(disagreeing<ArticulatedBody>(sign) == 1);
  BOOST_TEST(disagreeing<ArticulatedBody>(lost) == 1);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(scenes)

BOOST_AUTO_TEST_CASE(written_and_read_again) {
  const scene::Scene scene = arm();
  const std::string text = scene::writeSceneToml(scene);
  BOOST_TEST(text.find("gyroscopic = true\n") != std::string::npos);
  BOOST_TEST(scene::writeSceneToml(scene::readSceneToml(text, "arm.toml")) == text);
}

BOOST_AUTO_TEST_CASE(impossible_ones_are_refused) {
  const auto refused = [](const std::string& text, const std::string& why) {
    BOOST_CHECK_EXCEPTION(scene::readSceneToml(text, "arm.toml"), scene::InputError,
                          [&](const auto& e) {
                            BOOST_TEST_MESSAGE(e.what());
                            return std::string(e.what()).find(why) != std::string::npos;
                          });
  };
  refused(armText("gyroscopic = true\n"), "gyroscopic without a rotor");
  refused(armText("rotor_inertia = 1\ngyroscopic = 1\n"),
          "gyroscopic: an integer, allowed: true, false");
  refused(armText("rotor_inertia = 4\ngyroscopic = true\n"),
          "link \"a\": carries the gyroscopic rotor of joint \"b\", and without it");
}

BOOST_AUTO_TEST_SUITE_END()
