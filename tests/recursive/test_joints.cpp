// SPDX-License-Identifier: GPL-3.0-or-later
// Joints of several degrees of freedom, and screws: what each kind means, by other roads than the
// sweeps and the Lagrangian take.
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/conductor/exact_checks.hpp"
#include "crosscheck/exact/exact.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/scalars/dual.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "crosscheck/witnesses/exact_sweeps.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/energy.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/projection.hpp"
#include "symbolic/derivation.hpp"
#include "tests/fixtures/fixtures.hpp"
#include "tests/fixtures/planted.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using recursive::Matrix3;
using recursive::Vector3;
using scene::JointKind;
using F = PrimeField;

namespace {

constexpr std::uint64_t kPrime = 9223372036854775783u;  // the largest below 2^63; 3 mod 4

/// A scene with one link of general inertia on one joint of this kind, which stands askew.
scene::Scene oneBody(const std::string& kind, const std::string& more = "") {
  return scene::readSceneToml(R"(
gravity = [1, -2, -9]
[[link]]
name = "base"
[[link]]
name = "body"
parent = "base"
mass = 3
com = [0.1, -0.2, 0.3]
inertia = { xx = 0.5, yy = 0.6, zz = 0.7, xy = 0.01, xz = -0.02, yz = 0.03 }
[link.joint]
kind = ")" + kind + "\"\nxyz = [0.4, 0.5, -0.6]\nrpy = [0.3, 0.2, -1]\n" +
                                  more,
                              "one_" + kind + ".toml");
}

/// The same with the joint as a chain of joints with one axis each, massless links between.
scene::Scene chain(const std::vector<std::pair<std::string, std::string>>& joints) {
  std::string text = "gravity = [1, -2, -9]\n[[link]]\nname = \"base\"\n";
  std::string parent = "base";
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const bool last = i + 1 == joints.size();
    const std::string name = last ? "body" : "massless_" + std::to_string(i);
    text += "[[link]]\nname = \"" + name + "\"\nparent = \"" + parent + "\"\n";
    if (last)
      text +=
          "mass = 3\ncom = [0.1, -0.2, 0.3]\ninertia = { xx = 0.5, yy = 0.6, zz = 0.7, xy = 0.01, "
          "xz = -0.02, yz = 0.03 }\n";
    text += "[link.joint]\nkind = \"" + joints[i].first + "\"\naxis = " + joints[i].second + "\n";
    if (i == 0) text += "xyz = [0.4, 0.5, -0.6]\nrpy = [0.3, 0.2, -1]\n";
    parent = name;
  }
  return scene::readSceneToml(text, "chain.toml");
}

/// Scenes with each kind on the way to another body: exact checks see every pair of neighbours.
std::string treeOf(const std::string& first, const std::string& second) {
  const auto link = [](const std::string& name, const std::string& parent,
                       const std::string& kind) {
    return "[[link]]\nname = \"" + name + "\"\nparent = \"" + parent +
           "\"\nmass = 2\ncom = [0.1, -0.2, 0.3]\n"
           "inertia = { xx = 0.5, yy = 0.6, zz = 0.7, xy = 0.01, "
           "xz = -0.02, yz = 0.03 }\n[link.joint]\nkind = \"" +
           kind + "\"\nxyz = [0.4, 0.5, -0.6]\nrpy = [\"pi/2\", 0, \"pi/3\"]\n" +
           (kind == "helical" ? "pitch = 0.3\nrotor_inertia = 0.01\ngear_ratio = 3\nstiffness = 7\n"
                              : "") +
           (kind == "helical" || kind == "cylindrical" || kind == "planar" ? "axis = [3, 0, 4]\n"
                                                                           : "");
  };
  return "gravity = [1, -2, -9]\n[[link]]\nname = \"base\"\n" + link("a", "base", first) +
         link("b", "a", second) +
         "[[wrench]]\nlink = \"b\"\nforce = [1, 2, 3]\nmoment = [-1, 0.5, 2]\nat = [0.1, 0, 0.2]\n"
         "axes = "
         "\"world\"\n[[wrench]]\nlink = \"a\"\nforce = [3, 2, 3]\n";
}

const std::vector<std::string> kKinds = {"revolute",  "prismatic", "helical",   "cylindrical",
                                         "universal", "planar",    "spherical", "floating"};
const std::vector<std::string> kNewKinds = {"helical", "cylindrical", "universal",
                                            "planar",  "spherical",   "floating"};

/// A scene's model and one state in the field.
struct InField {
  explicit InField(const scene::Scene& scene, int index = 0)
      : modulus(kPrime),
        source(scene.name, 1, index),
        number(scene.mechanism, source),
        model(recursive::buildModel(scene.mechanism, number)),
        ws(model),
        state(indeterminateState(scene.mechanism, source)) {}

  std::vector<F> inverse() {
    std::vector<F> tau(model.dof());
    recursive::inverseDynamics(model, state.x, state.qd, state.qdd, ws, tau);
    return tau;
  }

  PrimeField::Modulus modulus;
  FieldSource source;
  FieldNumbers number;
  recursive::Model<F> model;
  recursive::Workspace<F> ws;
  scene::State<F> state;
};

Vector3<F> vector(F x, F y, F z) {
  return {x, y, z};
}
F rational(int n, int d) {
  return PrimeField::fromRational(scene::Rational(n, d));
}

/// The body of oneBody(), about its frame's origin: mass, first moment, inertia, by plain 3-D sums.
struct PlainBody {
  F m = 3;
  Vector3<F> r = vector(rational(1, 10), rational(-2, 10), rational(3, 10));
  Matrix3<F> I;
  PlainBody() {
    I << rational(5, 10), rational(1, 100), rational(-2, 100), rational(1, 100), rational(6, 10),
        rational(3, 100), rational(-2, 100), rational(3, 100), rational(7, 10);
    I += (Matrix3<F>(Matrix3<F>::Identity() * r.dot(r)) - r * r.transpose()) * m;
  }
};

/// World's gravity in the axes of the joint frame of oneBody().
Vector3<F> gravityInJoint(InField& f) {
  const Matrix3<F> R = f.model.links[0].X_tree.R;  // world to joint axes
  return R * vector(1, -2, -9);
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// Newton and Euler about a fixed point, in the body's axes:
//   I dw/dt + w x I w = tau + r x m (R' g)
BOOST_AUTO_TEST_CASE(a_spherical_joint_gives_eulers_equations_of_a_top) {
  InField f(oneBody("spherical"));
  const PlainBody b;
  const Vector3<F> w = vector(f.state.qd[0], f.state.qd[1], f.state.qd[2]);
  const Vector3<F> a = vector(f.state.qdd[0], f.state.qdd[1], f.state.qdd[2]);
  // R' by turning the vector with the quaternion itself: v - 2 w (q x v) + 2 q x (q x v), over q'q
  const auto& x = f.state.x;
  const F s = x[0].q;
  const Vector3<F> q = vector(x[1].q, x[2].q, x[3].q), g = gravityInJoint(f);
  const F n = s * s + q.dot(q);
  const Vector3<F> g_body = g + (q.cross(q.cross(g)) - q.cross(g) * s) * (F(2) / n);
  const Vector3<F> I_a = b.I * a, I_w = b.I * w;
  const Vector3<F> expected = I_a + w.cross(I_w) - b.r.cross(g_body) * b.m;
  const std::vector<F> tau = f.inverse();
  for (int k = 0; k < 3; ++k) BOOST_TEST((tau[k] == expected(k)));
}

// A free body: m (acceleration of its centre) = force, moment about the origin from that and Euler.
// The origin's acceleration is d(R v)/dt = R (dv/dt + w x v).
BOOST_AUTO_TEST_CASE(a_floating_body_obeys_newton_and_euler_about_its_origin) {
  InField f(oneBody("floating"));
  const PlainBody b;
  const auto three = [](const std::vector<F>& v, int i) {
    return vector(v[i], v[i + 1], v[i + 2]);
  };
  const Vector3<F> v = three(f.state.qd, 0), w = three(f.state.qd, 3);
  const auto& x = f.state.x;
  const F s = x[3].q;
  const Vector3<F> q = vector(x[4].q, x[5].q, x[6].q), g = gravityInJoint(f);
  const F n = s * s + q.dot(q);
  const Vector3<F> g_body = g + (q.cross(q.cross(g)) - q.cross(g) * s) * (F(2) / n);
  const Vector3<F> a = three(f.state.qdd, 0) + w.cross(v) - g_body, alpha = three(f.state.qdd, 3);
  const Vector3<F> w_r = w.cross(b.r), I_alpha = b.I * alpha, I_w = b.I * w;
  const Vector3<F> force = (a + alpha.cross(b.r) + w.cross(w_r)) * b.m;
  const Vector3<F> moment = I_alpha + w.cross(I_w) + b.r.cross(a) * b.m;
  const std::vector<F> tau = f.inverse();
  for (int k = 0; k < 3; ++k) {
    BOOST_TEST((tau[k] == force(k)));
    BOOST_TEST((tau[3 + k] == moment(k)));
  }
}

// One q: T = (I_zz + pitch^2 m) qd^2 / 2 about the screw's axis, V = -m g'(position of the centre)
BOOST_AUTO_TEST_CASE(a_screw_carries_its_mass_up_its_pitch) {
  InField f(oneBody(
      "helical", "pitch = 0.25\nrotor_inertia = 0.5\ngear_ratio = 3\nstiffness = 8\nrest = 2\n"));
  const PlainBody b;
  const F pitch = rational(1, 4), c = f.state.x[0].c, s = f.state.x[0].s;
  const Vector3<F> g = gravityInJoint(f);
  // d/dq of the centre (c x - s y, s x + c y, z + pitch q)
  const Vector3<F> slope = vector(-s * b.r(0) - c * b.r(1), c * b.r(0) - s * b.r(1), pitch);
  const F inertia = b.I(2, 2) + pitch * pitch * b.m + F(9) * rational(1, 2);
  const F expected = inertia * f.state.qdd[0] - b.m * g.dot(slope) + F(8) * (f.state.x[0].q - F(2));
  BOOST_TEST((f.inverse()[0] == expected));
}

struct Chain {
  std::string kind;
  std::vector<std::pair<std::string, std::string>> joints;
};
std::ostream& operator<<(std::ostream& out, const Chain& chain) {
  return out << chain.kind;
}
const std::vector<Chain> kChains = {
    {"cylindrical", {{"prismatic", "[0, 0, 1]"}, {"revolute", "[0, 0, 1]"}}},
    {"universal", {{"revolute", "[1, 0, 0]"}, {"revolute", "[0, 1, 0]"}}},
    {"planar",
     {{"prismatic", "[1, 0, 0]"}, {"prismatic", "[0, 1, 0]"}, {"revolute", "[0, 0, 1]"}}}};

// the chain as its author would have to write it, through the scene reader
BOOST_DATA_TEST_CASE(a_joint_is_the_chain_of_its_motions, data::make(kChains), sample) {
  InField f(oneBody(sample.kind));
  const std::vector<F> tau = f.inverse();
  const scene::Mechanism links = chain(sample.joints).mechanism;
  const recursive::Model<F> model = recursive::buildModel(links, FieldNumbers(links, f.source));
  recursive::Workspace<F> ws(model);
  std::vector<F> expected(tau.size());
  recursive::inverseDynamics(model, f.state.x, f.state.qd, f.state.qdd, ws, expected);
  BOOST_TEST((tau == expected));
}

// The file says that it is written from humanoid.toml: put back on its foot, it is that scene.
BOOST_AUTO_TEST_CASE(the_floating_humanoid_is_the_humanoid_but_for_its_foot) {
  const scene::Scene standing = scene::findScene("humanoid");
  scene::Scene put_back = scene::findScene("humanoid_floating");
  std::vector<scene::Link>& links = put_back.mechanism.links;
  links.erase(links.begin());
  for (scene::Link& link : links) --link.parent;
  links[0].joint = standing.mechanism.links[0].joint;
  put_back.title = standing.title;
  put_back.start_q = standing.start_q;
  put_back.start_qd = standing.start_qd;
  BOOST_TEST(scene::writeSceneToml(put_back) == scene::writeSceneToml(standing));
}

BOOST_AUTO_TEST_CASE(half_the_angle_in_the_quaternion_is_the_angle_of_the_turn) {
  const double angle = 0.7, h = angle / 2;
  std::vector<scene::JointPosition<double>> x;
  for (const double q : {2 * std::cos(h), 0.0, 0.0, 2 * std::sin(h)})  // of length 2
    x.push_back(scene::jointPosition(q));
  const Matrix3<double> R = recursive::rotation(x.data());
  const Matrix3<double> expected =
      Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  BOOST_TEST((R - expected).cwiseAbs().maxCoeff() <= 4 * std::numeric_limits<double>::epsilon());
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

BOOST_AUTO_TEST_CASE(every_quaternion_but_zero_is_a_rotation) {
  const PrimeField::Modulus modulus(kPrime);
  for (int index = 0; index < 20; ++index) {
    const FieldSource source("quaternion", 1, index);
    std::vector<scene::JointPosition<F>> x, scaled;
    for (int k = 0; k < 4; ++k) {
      const F q = source.element("q" + std::to_string(k));
      x.push_back({q, 0, 0});
      scaled.push_back({q * source.element("scale"), 0, 0});
    }
    const Matrix3<F> R = recursive::rotation(x.data());
    const Matrix3<F> one = R.transpose() * R;
    BOOST_TEST((one == Matrix3<F>(Matrix3<F>::Identity())));
    BOOST_TEST((R.col(0).cross(R.col(1)) == R.col(2)));  // det R = 1
    BOOST_TEST((recursive::rotation(scaled.data()) == R));
  }
}

// dR/dt = R [w]x and dp/dt = R v, by dual numbers
BOOST_AUTO_TEST_CASE(positions_move_as_the_rates_of_the_body_say) {
  InField f(oneBody("floating"));
  std::vector<F> rates(7);
  recursive::positionRates(f.model, f.state.x, f.state.qd, rates);
  std::vector<scene::JointPosition<Dual<F>>> x;
  for (int k = 0; k < 7; ++k) x.push_back(moving(f.state.x[k], rates[k]));
  const Matrix3<Dual<F>> R_moving = recursive::rotation(&x[3]);
  const Matrix3<F> R = recursive::rotation(&f.state.x[3]);
  const Matrix3<F> w_hat = recursive::skew<F>(vector(f.state.qd[3], f.state.qd[4], f.state.qd[5]));
  const Matrix3<F> expected = R * w_hat;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) BOOST_TEST((R_moving(i, j).derivative == expected(i, j)));
  const Vector3<F> p_rate = R * vector(f.state.qd[0], f.state.qd[1], f.state.qd[2]);
  for (int k = 0; k < 3; ++k) BOOST_TEST((rates[k] == p_rate(k)));
}

// axis by axis and all axes at once: the articulated inertia that the parent feels
BOOST_AUTO_TEST_CASE(the_spherical_projection_written_out_is_that_of_three_axes) {
  InField f(scene::readSceneToml(treeOf("floating", "spherical"), "projection.toml"));
  std::vector<F> qdd(f.model.dof());
  recursive::forwardDynamics(f.model, f.state.x, f.state.qd, f.state.tau, f.ws, qdd);
  const recursive::ArticulatedInertia<F> M = f.ws.M_A[1];
  recursive::JointAxes<F> Z(6, 3);
  for (int k = 0; k < 3; ++k) Z.col(k) = recursive::jointAxis(f.model.links[1], k);
  const recursive::MatrixX<F> no_rotors = recursive::MatrixX<F>::Constant(3, 3, F(0));
  const recursive::Matrix6<F> P_M =
      recursive::inertiaProjection(recursive::Matrix6<F>(M.matrix()), Z, no_rotors);
  recursive::Matrix6<F> expected = recursive::Matrix6<F>::Constant(F(0));
  expected.topLeftCorner(3, 3) = recursive::inertiaThroughSpherical(M).matrix();
  BOOST_TEST((P_M == expected));
  // one axis after the other, as the sweep does
  recursive::ArticulatedInertia<F> left = M;
  for (int k = 0; k < 3; ++k) {
    const recursive::Force<F> U = left.angularColumn(k);
    left = left.minusOuter(U, F(1) / U.moment(k));
  }
  BOOST_TEST((left.matrix() == expected));
}

// P with a full matrix of joint inertias:  P = 1 - M Z D^-1 Z',  P P = P - M Z D^-1 d D^-1 Z'
BOOST_AUTO_TEST_CASE(projections_allow_coupled_joint_inertias) {
  const PrimeField::Modulus modulus(kPrime);
  const FieldSource source("projection", 1, 0);
  const auto symmetric = [&](int n, const std::string& name) {
    recursive::MatrixX<F> m(n, n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j <= i; ++j)
        m(i, j) = m(j, i) = source.element(name + std::to_string(10 * i + j));
    return m;
  };
  const recursive::Matrix6<F> M = symmetric(6, "M");
  const recursive::MatrixX<F> d = symmetric(2, "d");
  recursive::JointAxes<F> Z(6, 2);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 2; ++j) Z(i, j) = source.element("Z" + std::to_string(10 * i + j));
  const recursive::Matrix6<F> P = recursive::forceProjection(M, Z, d);
  // by Cramer's rule
  const recursive::MatrixX<F> Zt = Z.transpose(), D = d + recursive::MatrixX<F>(Zt * M * Z);
  recursive::MatrixX<F> inverse(2, 2);
  inverse << D(1, 1), -D(0, 1), -D(1, 0), D(0, 0);
  inverse *= F(1) / (D(0, 0) * D(1, 1) - D(0, 1) * D(1, 0));
  const recursive::Matrix6<F> loss = M * Z * inverse * Zt;
  BOOST_TEST((P == recursive::Matrix6<F>(recursive::Matrix6<F>::Identity() - loss)));
  const recursive::Matrix6<F> PP = P * P, leak = M * Z * inverse * d * inverse * Zt;
  BOOST_TEST((PP == recursive::Matrix6<F>(P - leak)));
  const recursive::Matrix6<F> P_M = recursive::inertiaProjection(M, Z, d);
  BOOST_TEST((P_M == recursive::Matrix6<F>(P_M.transpose())));
}

// every kind carried by every kind: all our witnesses and all identities, over the field
BOOST_DATA_TEST_CASE(all_exact_checks_hold_for_every_pair_of_kinds,
                     data::make(kNewKinds) * data::make(kKinds), first, second) {
  const scene::Scene scene =
      scene::readSceneToml(treeOf(first, second), first + "_" + second + ".toml");
  for (const CheckResult& check : exactChecks(scene, {}))
    BOOST_TEST((check.verdict == Verdict::kAgree), check.name() << " " << check.quantity << " "
                                                                << check.left << " " << check.right
                                                                << ": " << check.reason);
}

BOOST_DATA_TEST_CASE(every_step_of_the_derivation_holds, data::make(kNewKinds), kind) {
  const scene::Mechanism m = scene::readSceneToml(treeOf("revolute", kind), "d.toml").mechanism;
  for (const symbolic::Step& step : symbolic::derivation(m).steps)
    BOOST_TEST(step.holds, step.name << ": " << step.check);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(engines)

std::unique_ptr<Witness> witnessNamed(const std::string& name, const scene::Scene& scene) {
  for (const WitnessKind& kind : witnessKinds())
    if (kind.info.name == name) return kind.make(scene).value();
  throw std::logic_error("no witness " + name);
}

// Simbody's own mobilizers, with other generalised speeds
BOOST_DATA_TEST_CASE(simbody_agrees_for_every_pair_of_kinds,
                     data::make(kNewKinds) * data::make(kKinds), first, second) {
  const scene::Scene scene =
      scene::readSceneToml(treeOf(first, second), first + "_" + second + ".toml");
  const auto simbody = witnessNamed("simbody", scene), ours = witnessNamed("newton_euler", scene),
             forward = witnessNamed("articulated_body", scene);
  for (int k = 0; k < 10; ++k) {
    const scene::State<double> state = drawState(scene.mechanism, scene.name, 1, k);
    for (const Quantity quantity : kAllQuantities) {
      const Answer a = simbody->answer(quantity, state);
      const Answer b = (quantity == Quantity::kQdd ? forward : ours)->answer(quantity, state);
      const double used =
          ((a.value - b.value).array().abs() / (a.bound + b.bound).array().max(1e-300)).maxCoeff();
      BOOST_TEST(used <= 1.0, name(quantity));
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(planted_errors)

void requireFound(const scene::Scene& scene, const fixtures::Planted<recursive::Model>& change) {
  const std::vector<ExactWitness> honest = exactWitnesses(scene, Parameters::kAsWritten);
  int found = 0;
  for (const CheckResult& check :
       compareExactly(scene, {honest[0], sweepWitness<NewtonEuler>(scene, change)}, {}))
    found += check.verdict == Verdict::kDisagree ? 1 : 0;
  BOOST_TEST(found > 0);
}

BOOST_AUTO_TEST_CASE(a_left_handed_screw_is_found) {
  requireFound(scene::findScene("lead_screw"),
               [](auto& model, const auto&) { model.links[0].pitch = -model.links[0].pitch; });
}
BOOST_AUTO_TEST_CASE(cardan_axes_in_the_wrong_order_are_found) {
  requireFound(scene::findScene("cardan_pendulum"), [](auto& model, const auto&) {
    std::swap(model.links[0].slot, model.links[1].slot);
  });
}
BOOST_AUTO_TEST_CASE(quaternions_that_are_mixed_up_are_found) {
  requireFound(scene::readSceneToml(treeOf("spherical", "floating"), "mixed_up.toml"),
               [](auto& model, const auto&) { model.links[1].slot -= 1; });
}
BOOST_AUTO_TEST_CASE(a_top_whose_point_is_elsewhere_is_found) {
  requireFound(scene::findScene("heavy_top"),
               [](auto& model, const auto&) { model.links[0].M.h = -model.links[0].M.h; });
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

void requireRefused(const std::string& text, const std::string& why) {
  BOOST_CHECK_EXCEPTION(scene::readSceneToml(text, "bad.toml"), scene::InputError,
                        [&](const scene::InputError& error) {
                          BOOST_TEST_MESSAGE(error.what());
                          return std::string(error.what()).find(why) != std::string::npos;
                        });
}

std::string withJoint(const std::string& joint,
                      const std::string& link = "mass = 1\ninertia = { xx = 1, yy = 1, zz = 1 }") {
  return "[[link]]\nname = \"base\"\n[[link]]\nname = \"body\"\nparent = \"base\"\n" + link +
         "\n[link.joint]\n" + joint + "\n";
}

BOOST_AUTO_TEST_CASE(what_a_kind_does_not_have_is_refused_with_its_line) {
  requireRefused(withJoint("kind = \"spherical\"\nrotor_inertia = 1"),
                 "bad.toml:10: joint \"body\" (spherical): has rotor_inertia, allowed: only with");
  requireRefused(withJoint("kind = \"planar\"\nstiffness = 1"),
                 "has stiffness, allowed: only with");
  requireRefused(withJoint("kind = \"universal\"\naxis = [1, 0, 0]"), "unknown key \"axis\"");
  requireRefused(withJoint("kind = \"floating\"\ndh = { a = 1 }"), "unknown key \"dh\"");
  requireRefused(withJoint("kind = \"helical\""), "has no pitch");
  requireRefused(withJoint("kind = \"revolute\"\npitch = 1"), "unknown key \"pitch\"");
  requireRefused(withJoint("kind = \"ball\""), "allowed: fixed, revolute, prismatic, helical");
}

BOOST_AUTO_TEST_CASE(motions_that_move_no_inertia_are_refused) {
  const std::string rod = "mass = 1\ncom = [0, 0, 0.5]\ninertia = { xx = 1, yy = 1, zz = 0 }";
  requireRefused(withJoint("kind = \"spherical\"", rod), "some of its motions move no inertia");
  requireRefused(withJoint("kind = \"floating\"", rod), "some of its motions move no inertia");
  requireRefused(withJoint("kind = \"cylindrical\"", rod), "some of its motions move no inertia");
  requireRefused(withJoint("kind = \"universal\"", ""), "nothing that it carries has mass");
  requireRefused(withJoint("kind = \"helical\"\npitch = 0", rod),
                 "no inertia about the joint's axis");
  scene::readSceneToml(withJoint("kind = \"helical\"\npitch = 0.1", rod), "good.toml");
  scene::readSceneToml(withJoint("kind = \"universal\"", rod), "good.toml");
}

BOOST_AUTO_TEST_CASE(a_start_has_one_number_a_slot_and_no_zero_quaternion) {
  const std::string joint = withJoint("kind = \"spherical\"");
  requireRefused(joint + "[start]\nq = [1, 0, 0]\n", "an array of 4 numbers");
  requireRefused(joint + "[start]\nqd = [1, 0, 0, 0]\n", "an array of 3 numbers");
  requireRefused(joint + "[start]\nq = [0, 0, 0, 0]\n",
                 "its quaternion at the start is [0, 0, 0, 0]");
}

BOOST_DATA_TEST_CASE(a_scene_of_every_kind_is_written_and_read_back, data::make(kNewKinds), kind) {
  scene::Scene scene = scene::readSceneToml(treeOf(kind, "floating"), "a.toml");
  scene.start_q.back() = scene::Number(1);
  const std::string text = scene::writeSceneToml(scene);
  const scene::Scene again = scene::readSceneToml(text, "a.toml");
  BOOST_TEST(scene::writeSceneToml(again) == text);
  BOOST_TEST(again.mechanism.positions() == scene.mechanism.positions());
}

BOOST_AUTO_TEST_SUITE_END()
