// SPDX-License-Identifier: GPL-3.0-or-later
// What joints transmit: by the inward sweep, by multipliers of a cut mechanism, from mass points,
// and by Simbody.
#include "crosscheck/witnesses/exact_sweeps.hpp"
#include "recursive/reactions.hpp"

#include <algorithm>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/exact/exact.hpp"
#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/scalars/dual.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "symbolic/program.hpp"
#include "symbolic/reactions.hpp"
#include "tests/fixtures/compiled_sweeps.hpp"
#include "tests/fixtures/fixtures.hpp"

using namespace dynwitness;
using namespace dynwitness::fixtures;
using namespace dynwitness::crosscheck;
namespace data = boost::unit_test::data;

namespace {

constexpr int kSeeds = 6;

std::vector<Q> bySweep(const scene::Mechanism& m, const scene::State<Q>& state) {
  const auto model = recursive::buildModel(m, RationalNumbers(m), recursive::FixedJoints::kKept);
  recursive::Workspace<Q> ws(model);
  std::vector<Q> tau(model.dof()), out(6 * (m.links.size() - 1));
  recursive::inverseDynamics(model, state.x, state.qd, state.qdd, ws, tau);
  recursive::jointReactions(model, ws, out);
  return out;
}

std::vector<Q> byMultipliers(const scene::Mechanism& m, const scene::State<Q>& state) {
  const symbolic::Reactions cut = symbolic::reactions(m);
  const symbolic::Program program = symbolic::compile(cut.graph, cut.lambda);
  return symbolic::ProgramRun<Q>(program, RationalNumbers(m))(state);
}

/** From mass points: a subtree's links need  sum m (a - gravity) - loads, and the moment of that
    about the joint, in all; the joint is where it comes from. Accelerations by differentiating
    places twice. (Rotors of the plain kind are no bodies and do not enter.) */
std::vector<Q> byMassPoints(const Tree& tree, const scene::State<Q>& state) {
  using D = Dual<Q>;
  using DD = Dual<D>;
  const scene::Mechanism& m = tree.mechanism;
  const RationalNumbers number(m);
  std::vector<scene::JointPosition<DD>> x;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    const Q qd = state.qd[i], qdd = state.qdd[i];
    const D rate(qd, qdd);
    const scene::JointPosition<D> inner = moving(state.x[i], qd);
    x.push_back({DD(inner.q, rate), DD(inner.c, -inner.s * rate), DD(inner.s, inner.c * rate)});
  }
  const auto poses = linkPoses<DD>(m, x);
  const auto still = linkPoses<Q>(m, state.x);
  const V3<Q> gravity = m.has_gravity ? rationalVector(m, m.gravity) : V3<Q>::Zero();

  std::vector<V3<Q>> force(m.links.size(), V3<Q>::Zero()),
      moment(force);  // about the world's origin
  for (std::size_t i = 0; i < m.links.size(); ++i) {
    for (const Point& point : tree.clouds[i]) {
      const V3<DD> place = placeOf(poses[i], point.at);
      const V3<Q> at = placeOf(still[i], point.at);
      V3<Q> a;
      for (int k = 0; k < 3; ++k) a(k) = place(k).derivative.derivative;
      const V3<Q> f = (a - gravity) * point.mass;
      force[i] += f;
      moment[i] += at.cross(f);
    }
  }
  for (const scene::Wrench& w : m.wrenches) {
    V3<Q> f = rationalVector(m, w.force), free = rationalVector(m, w.moment);
    if (w.axes == scene::Wrench::Axes::kLink) {
      f = (still[w.link].R * f).eval();
      free = (still[w.link].R * free).eval();
    }
    force[w.link] -= f;
    moment[w.link] -= free + placeOf(still[w.link], rationalVector(m, w.at)).cross(f);
  }
  for (std::size_t i = m.links.size(); i-- > 1;) {
    force[m.links[i].parent] += force[i];
    moment[m.links[i].parent] += moment[i];
  }
  std::vector<Q> out;
  for (std::size_t i = 1; i < m.links.size(); ++i) {
    // the moved joint frame is the link's, unless a DH row goes on after the joint
    M3<Q> R = still[i].R;
    V3<Q> o = still[i].o;
    const scene::Placement& place = m.links[i].joint.placement;
    if (place.convention == scene::Placement::Convention::kDh) {
      const M3<Q> R_after = fixtures::detail::rotationZ(number.angle(place.theta)) *
                            fixtures::detail::rotationX(number.angle(place.alpha));
      const V3<Q> p_after = fixtures::detail::rotationZ(number.angle(place.theta)) *
                            V3<Q>(number(place.a), Q(0), number(place.d));
      R = (R * R_after.transpose()).eval();
      o -= R * p_after;
    }
    const V3<Q> f = R.transpose() * force[i],
                t = R.transpose() * V3<Q>(moment[i] - o.cross(force[i]));
    for (int k = 0; k < 3; ++k) out.push_back(f(k));
    for (int k = 0; k < 3; ++k) out.push_back(t(k));
  }
  return out;
}

std::vector<CheckResult> about(const char* quantity, std::vector<CheckResult> checks) {
  checks.erase(std::remove_if(checks.begin(), checks.end(),
                              [&](const CheckResult& c) { return c.quantity != quantity; }),
               checks.end());
  return checks;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// By hand: a rod of mass m turns about one end in a vertical plane. Along the rod the pin pulls m
// l/2 qd^2 and holds the weight, across it it gives m l/2 qdd; the moment is that of qdd and
// weight.
BOOST_AUTO_TEST_CASE(the_pin_of_a_rod) {
  scene::Mechanism m;
  m.has_gravity = true;
  m.gravity = {0, -10, 0};
  m.links.resize(2);
  m.links[0].name = "ground";
  scene::Link& rod = m.links[1];
  rod.name = "rod";
  rod.parent = 0;
  rod.joint.name = "pin";
  rod.joint.kind = scene::JointKind::kRevolute;
  rod.inertia.mass = 3;
  rod.inertia.com = {1, 0, 0};
  rod.inertia.yy = rod.inertia.zz = 1;
  const Q c = Q(3) / 5, s = Q(4) / 5, qd = 2, qdd = 7;
  const scene::State<Q> state = {{{Q(0), c, s}}, {qd}, {qdd}, {Q(0)}};
  const std::vector<Q> expected = {3 * (-qd * qd + 10 * s), 3 * (qdd + 10 * c), Q(0), Q(0), Q(0),
                                   4 * qdd + 3 * 10 * c};
  BOOST_TEST(mismatch(bySweep(m, state), expected) == "");
  BOOST_TEST(mismatch(byMultipliers(m, state), expected) == "");
}

// Its own axis is not what a joint holds: the share of a plain rotor and of a spring never reaches
// the link.
BOOST_AUTO_TEST_CASE(rotors_springs_and_friction_take_their_part_before) {
  Features features = Features::bare();
  Tree tree = randomTree(3, 1, features);
  const scene::State<Q> state = randomState(3, 1);
  const std::vector<Q> without = bySweep(tree.mechanism, state);
  for (scene::Link& link : tree.mechanism.links) {
    if (link.joint.kind == scene::JointKind::kFixed) continue;
    link.joint.rotor_inertia = 2;
    link.joint.gear_ratio = 5;
    link.joint.stiffness = 11;
    link.joint.friction = {scene::Number(3), scene::Number(1), scene::Number(2)};
  }
  BOOST_TEST(mismatch(bySweep(tree.mechanism, state), without) == "");
  BOOST_TEST(mismatch(byMultipliers(tree.mechanism, state), without) == "");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

BOOST_DATA_TEST_CASE(sweep_multipliers_and_mass_points_agree, data::xrange(kSeeds), seed) {
  const Tree tree = randomTree(5, seed);
  const scene::State<Q> state = randomState(tree.mechanism.dof(), seed);
  const std::vector<Q> expected = byMassPoints(tree, state);
  BOOST_TEST(mismatch(bySweep(tree.mechanism, state), expected) == "");
  BOOST_TEST(mismatch(byMultipliers(tree.mechanism, state), expected) == "");
}

// All joint kinds, placements, loads, springs, rotors of both models and friction.
BOOST_AUTO_TEST_CASE(random_mechanisms_of_all_kinds_agree_over_the_field) {
  std::size_t asked = 0;
  for (int index = 0; index < 12; ++index) {
    const scene::Scene scene = randomScene(5, index, 5);
    const auto witnesses = exactWitnesses(scene, Parameters::kAsWritten,
                                          selectWitnesses({"lagrange", "newton_euler"}));
    for (const CheckResult& check : about("reactions", compareExactly(scene, witnesses, {}))) {
      ++asked;
      BOOST_TEST((check.verdict == Verdict::kAgree), scene.name << ": " << check.reason);
    }
    for (const CheckResult& check : checkIdentitiesExactly(scene, {}))
      if (check.name().rfind("reactions", 0) == 0)
        BOOST_TEST((check.verdict == Verdict::kAgree),
                   scene.name << ": " << check.name() << ": " << check.reason);
  }
  BOOST_TEST(asked == 12u);
}

BOOST_AUTO_TEST_CASE(simbody_agrees_within_its_bound) {
  std::vector<WitnessKind> kinds;
  for (const WitnessKind& kind : witnessKinds())
    if (kind.info.name == "newton_euler" || kind.info.name == "simbody" ||
        kind.info.name == "lagrange")
      kinds.push_back(kind);
  Options options;
  options.states = 5;
  for (const char* name :
       {"stanford_arm", "humanoid", "lead_screw", "cylindrical_arm", "cardan_pendulum",
        "puck_on_slope", "heavy_top", "satellite_arm", "gyroscopic_wrist", "puma_560_friction"}) {
    const scene::Scene scene = scene::findScene(name);
    const auto checks = about("reactions", compareWitnesses(scene, kinds, options));
    BOOST_TEST(checks.size() == 3u);
    for (const CheckResult& check : checks)
      BOOST_TEST((check.verdict == Verdict::kAgree),
                 name << ": " << check.left << " " << check.right << " " << check.worst_entry
                      << " ratio " << check.ratio << " " << check.reason);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(planted_faults)

namespace {

/// Reactions with a mistake that a person makes.
enum class Mistake { kNone, kSign, kTransposed, kMomentNotMoved, kLoadsLost, kChildrenLost };

template <Mistake mistake>
struct Wrong : NewtonEuler {
  static bool answers(Quantity quantity) { return quantity == Quantity::kReactions; }
  template <typename T>
  static MatrixX<T> answer(Setup<T>& s, Quantity, const scene::State<T>& state) {
    MatrixX<T> right = s.reactions(state);
    Setup<T>& kept = s.with_fixed_joints.empty() ? s : s.with_fixed_joints.front();
    if (mistake == Mistake::kSign) return -right;
    if (mistake == Mistake::kLoadsLost) {
      Terms terms = Terms::all();
      terms.loads = false;
      kept.inverse(state, state.qd, state.qdd, terms);
      std::vector<T> out(right.size(), T(0));
      recursive::jointReactions(kept.model, kept.ws, out);
      return column(out);
    }
    std::vector<recursive::ScenePlace<T>> joints = kept.model.joints;
    for (std::size_t i = 1; i < joints.size(); ++i) {
      recursive::Force<T> f = kept.ws.f[joints[i].link];
      if (mistake == Mistake::kTransposed) joints[i].X.R = joints[i].X.R.transpose().eval();
      if (mistake ==
          Mistake::kMomentNotMoved)  // about the parent's origin, as if that were the joint's
        f = {f.force, f.moment + kept.ws.X_up[joints[i].link].p.cross(f.force)};
      if (mistake == Mistake::kChildrenLost)
        f = kept.model.links[joints[i].link].M * kept.ws.a[joints[i].link] +
            biasForce(kept.model.links[joints[i].link].M, kept.ws.v[joints[i].link]);
      right.block(6 * (i - 1), 0, 6, 1) = (joints[i].X * f).vector();
    }
    return right;
  }
};

template <Mistake mistake>
bool seen(const char* name) {
  const scene::Scene scene = scene::findScene(name);
  std::vector<ExactWitness> witnesses =
      exactWitnesses(scene, Parameters::kAsWritten, selectWitnesses({"lagrange"}));
  witnesses.push_back(sweepWitness<Wrong<mistake>>(scene, [](auto&, const auto&) {}));
  const auto checks = about("reactions", compareExactly(scene, witnesses, {}));
  BOOST_TEST_REQUIRE(checks.size() == 1u);
  return checks[0].verdict == Verdict::kDisagree;
}

}  // namespace

BOOST_AUTO_TEST_CASE(mistakes_are_seen_and_nothing_else_is) {
  BOOST_TEST(!seen<Mistake::kNone>("franka_panda"));
  BOOST_TEST(!seen<Mistake::kNone>("stanford_arm"));
  BOOST_TEST(seen<Mistake::kSign>("franka_panda"));
  BOOST_TEST(seen<Mistake::kTransposed>(
      "gyroscopic_wrist"));  // axes along y: a turn that is not its own inverse
  BOOST_TEST(seen<Mistake::kMomentNotMoved>("franka_panda"));
  BOOST_TEST(seen<Mistake::kChildrenLost>("franka_panda"));
}

// A scene with loads, which the bundled ones do not have.
BOOST_AUTO_TEST_CASE(a_lost_load_is_seen) {
  for (int index = 0; index < 40; ++index) {
    const scene::Scene scene = randomScene(9, index, 4);
    if (scene.mechanism.wrenches.empty()) continue;
    std::vector<ExactWitness> witnesses =
        exactWitnesses(scene, Parameters::kAsWritten, selectWitnesses({"lagrange"}));
    witnesses.push_back(sweepWitness<Wrong<Mistake::kLoadsLost>>(scene, [](auto&, const auto&) {}));
    const auto checks = about("reactions", compareExactly(scene, witnesses, {}));
    BOOST_TEST((checks.at(0).verdict == Verdict::kDisagree));
    return;
  }
  BOOST_ERROR("no load was drawn");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(a_lumped_model_has_no_reactions_of_its_fixed_joints) {
  const Tree tree = randomTree(3, 2);
  const auto model = recursive::buildModel(tree.mechanism, RationalNumbers(tree.mechanism));
  const recursive::Workspace<Q> ws(model);
  std::vector<Q> out(6 * (tree.mechanism.links.size() - 1)), few(6);
  BOOST_CHECK_EXCEPTION(
      recursive::jointReactions(model, ws, out), std::invalid_argument, [](const auto& e) {
        return std::string(e.what()).find("was lumped, expected FixedJoints::kKept") !=
               std::string::npos;
      });
  BOOST_CHECK_EXCEPTION(
      recursive::jointReactions(model, ws, few), std::invalid_argument, [](const auto& e) {
        return std::string(e.what()).rfind("jointReactions: out: expected ", 0) == 0;
      });
}

BOOST_AUTO_TEST_SUITE_END()
