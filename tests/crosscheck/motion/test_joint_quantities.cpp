// SPDX-License-Identifier: GPL-3.0-or-later
// What evaluate shows of joints, against reactions by Newton and Euler, the recursion of the
// chapter, and tasks.
#include "crosscheck/motion/joint_quantities.hpp"

#include <algorithm>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "scene/numbers.hpp"
#include "tests/fixtures/treated_scenes.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

using Six = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Sums of a few hundred products, up to M_A of a humanoid's 60 kg. Measured: up to 2e-12.
constexpr double kLimit = 1e-10;

double off(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / (1 + a.cwiseAbs().maxCoeff());
}

/// Joint by joint, in the order of links: joint i - 1 moves link i.
struct Shown {
  Shown(const scene::Scene& of, const scene::State<double>& state, JointAxes in = JointAxes::kLink)
      : scene(of), quantities(of, {}, in) {
    quantities.at(state);
    for (const scene::Link& link : scene.mechanism.links)
      if (link.parent >= 0) axes.push_back(scene::degreesOfFreedom(link.joint.kind));
  }
  Matrix6 matrix(JointQuantity quantity, std::size_t joint) const {
    const Eigen::VectorXd all = quantities.value(quantity);
    return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(all.data() + 36 * joint);
  }
  Six six(JointQuantity quantity, std::size_t joint) const {
    return quantities.value(quantity).segment<6>(static_cast<Eigen::Index>(6 * joint));
  }
  Eigen::MatrixXd Z(std::size_t joint) const {
    const Eigen::VectorXd all = quantities.value(JointQuantity::kZ);
    Eigen::Index from = 0;
    for (std::size_t k = 0; k < joint; ++k) from += 6 * axes[k];
    return Eigen::Map<const Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>>(
        all.data() + from, 6, axes[joint]);
  }
  /// Of the joint of the parent; -1: the world.
  int inboard(std::size_t joint) const { return scene.mechanism.links[joint + 1].parent - 1; }

  const scene::Scene& scene;
  JointQuantities quantities;
  std::vector<Eigen::Index> axes;
};

scene::State<double> atRest(const scene::Scene& scene) {
  scene::State<double> state = drawState(scene.mechanism, scene.name, 1, 0);
  std::fill(state.qd.begin(), state.qd.end(), 0.0);
  const PreparedScene prepared(scene);
  const Eigen::MatrixXd qdd =
      articulatedBodyKind().make(prepared).value()->value(Quantity::kQdd, state);
  state.qdd.assign(qdd.data(), qdd.data() + qdd.size());
  return state;
}

/// f = M_A a + F through every joint, a carried outward by X and Z: what X, Z, M_A and F say
/// together of a mechanism that is let go at rest, against Newton and Euler.
void requireReactions(const scene::Scene& scene, JointAxes axes = JointAxes::kLink) {
  const scene::State<double> state = atRest(scene);
  const Shown shown(scene, state, axes);
  const PreparedScene prepared(scene);
  TurnedAxes turned(scene, axes);
  turned.at(state);
  const Eigen::MatrixXd reactions =
      turned.turned(newtonEulerKind().make(prepared).value()->value(Quantity::kReactions, state));
  const auto number = scene::RealNumbers<double>(scene.mechanism);
  Six a_0 = Six::Zero();
  if (scene.mechanism.has_gravity)
    for (int k = 0; k < 3; ++k)
      a_0(k) = -number(scene.mechanism.gravity[static_cast<std::size_t>(k)]);
  std::vector<Six> a;
  Eigen::Index rate = 0;
  for (std::size_t i = 0; i < shown.axes.size(); ++i) {
    const int p = shown.inboard(i);
    const Eigen::VectorXd qdd =
        Eigen::Map<const Eigen::VectorXd>(state.qdd.data() + rate, shown.axes[i]);
    rate += shown.axes[i];
    a.push_back(shown.matrix(JointQuantity::kX, i) *
                (p < 0 ? a_0 : a[static_cast<std::size_t>(p)]));
    if (shown.axes[i] > 0) a.back() += shown.Z(i) * qdd;
    const Six f = shown.matrix(JointQuantity::kM_A, i) * a.back() + shown.six(JointQuantity::kF, i);
    const Six by_newton_euler = reactions.block<6, 1>(static_cast<Eigen::Index>(6 * i), 0);
    BOOST_TEST(off(f, by_newton_euler) < kLimit, scene.name << ", joint " << i);
  }
}

/// M_A = M_i + sum of X' (P M) X and M_C = M_i + sum of X' M_C X over the joints outboard.
void requireRecursions(const scene::Scene& scene) {
  const Shown shown(scene, atRest(scene));
  for (std::size_t i = 0; i < shown.axes.size(); ++i) {
    Matrix6 M_A = shown.matrix(JointQuantity::kM_i, i), M_C = M_A;
    bool turned_by_gyroscope = scene.mechanism.links[i + 1].joint.gyroscopic;
    for (std::size_t k = i + 1; k < shown.axes.size(); ++k) {
      if (shown.inboard(k) != static_cast<int>(i)) continue;
      const Matrix6 X = shown.matrix(JointQuantity::kX, k);
      M_A += X.transpose() * shown.matrix(JointQuantity::kPM, k) * X;
      M_C += X.transpose() * shown.matrix(JointQuantity::kM_C, k) * X;
    }
    BOOST_TEST(off(M_A, shown.matrix(JointQuantity::kM_A, i)) < kLimit, scene.name << ", " << i);
    BOOST_TEST(off(M_C, shown.matrix(JointQuantity::kM_C, i)) < kLimit, scene.name << ", " << i);
    const Matrix6 P = shown.matrix(JointQuantity::kP, i);
    BOOST_TEST(off(P * shown.six(JointQuantity::kF, i), shown.six(JointQuantity::kPF, i)) < kLimit);
    if (turned_by_gyroscope) continue;
    BOOST_TEST(off(P * M_A, shown.matrix(JointQuantity::kPM, i)) < kLimit, scene.name << ", " << i);
    // without a rotor nothing passes along the axes
    if (shown.axes[i] > 0 && scene.mechanism.links[i + 1].joint.rotor_inertia.isLiteralZero())
      BOOST_TEST((shown.Z(i).transpose() * P).cwiseAbs().maxCoeff() < kLimit,
                 scene.name << ", " << i);
  }
}

}  // namespace

BOOST_DATA_TEST_CASE(joints_transmit_what_their_articulated_bodies_say,
                     data::make(fixtures::scenesTreatedBy(Command::kEvaluateJoints)), name) {
  const scene::Scene scene = scene::findScene(name);
  if (!scene.mechanism.links.empty() && scene.mechanism.dof() > 0) requireReactions(scene);
}
BOOST_DATA_TEST_CASE(inertias_follow_the_recursion_of_the_chapter,
                     data::make(fixtures::scenesTreatedBy(Command::kEvaluateJoints)), name) {
  requireRecursions(scene::findScene(name));
}
// Every kind of joint, some of them chains in the model, on turned and displaced frames.
BOOST_DATA_TEST_CASE(so_they_do_in_mechanisms_that_nobody_chose, data::xrange(25), index) {
  requireReactions(randomTreeScene(11, static_cast<std::uint64_t>(index), 8));
  requireRecursions(randomTreeScene(11, static_cast<std::uint64_t>(index), 8));
}

// In other axes the same recursion holds; X turns nothing where all are the world's, and an axis
// is e_z where they are the joint's.
BOOST_DATA_TEST_CASE(other_axes_say_the_same, data::xrange(25), index) {
  const scene::Scene scene = randomTreeScene(11, static_cast<std::uint64_t>(index), 8);
  const scene::State<double> state = atRest(scene);
  const Shown in_world(scene, state, JointAxes::kWorld), in_joints(scene, state, JointAxes::kJoint);
  requireReactions(scene, JointAxes::kWorld);
  requireReactions(scene, JointAxes::kJoint);
  for (std::size_t i = 0; i < in_world.axes.size(); ++i) {
    const Matrix6 X = in_world.matrix(JointQuantity::kX, i);
    BOOST_TEST(off(X.topLeftCorner<3, 3>(), Eigen::Matrix3d::Identity()) < kLimit);
    const scene::JointKind kind = scene.mechanism.links[i + 1].joint.kind;
    if (kind == scene::JointKind::kRevolute) BOOST_TEST(off(in_joints.Z(i), Six::Unit(5)) < kLimit);
    if (kind == scene::JointKind::kPrismatic)
      BOOST_TEST(off(in_joints.Z(i), Six::Unit(2)) < kLimit);
    if (kind != scene::JointKind::kRevolute && kind != scene::JointKind::kPrismatic &&
        kind != scene::JointKind::kHelical)
      BOOST_TEST((TurnedAxes(scene, JointAxes::kJoint).of(i + 1) == Matrix6::Identity()));
  }
}

// Of a universal joint, a chain of two in the model, neither axis is the joint's.
BOOST_AUTO_TEST_CASE(joints_of_several_axes_are_left_as_they_are) {
  for (const char* kind : {"universal", "cylindrical", "planar", "revolute"}) {
    const scene::Scene scene = scene::readSceneToml(
        std::string("[[link]]\nname = \"base\"\n[[link]]\nname = \"a\"\nparent = \"base\"\n"
                    "mass = 1\ninertia = { xx = 1, yy = 1, zz = 1 }\njoint = { kind = \"") +
            kind + "\"" + (kind[0] == 'u' ? "" : ", axis = [1, 0, 0]") + " }\n",
        "joints.toml");
    const bool is_turned =
        TurnedAxes(scene, JointAxes::kJoint).of(1) != recursive::Matrix6<double>::Identity();
    BOOST_TEST(is_turned == (kind == std::string("revolute")), kind);
  }
}
// The first joint of a scene holds all that it carries: in world axes, straight up.
BOOST_AUTO_TEST_CASE(what_rests_is_held_up_along_the_axis_of_the_world) {
  const scene::Scene scene = scene::findScene("puma_560");
  scene::State<double> state = drawState(scene.mechanism, scene.name, 1, 0);
  std::fill(state.qd.begin(), state.qd.end(), 0.0);
  std::fill(state.qdd.begin(), state.qdd.end(), 0.0);
  TurnedAxes turned(scene, JointAxes::kWorld);
  turned.at(state);
  const Eigen::MatrixXd reactions = turned.turned(
      newtonEulerKind().make(PreparedScene(scene)).value()->value(Quantity::kReactions, state));
  double mass = 0;
  const scene::RealNumbers<double> number(scene.mechanism);
  for (std::size_t i = 1; i < scene.mechanism.links.size(); ++i)
    mass += number(scene.mechanism.links[i].inertia.mass);
  const Eigen::Vector3d held = reactions.block<3, 1>(0, 0);
  const Eigen::Vector3d weight(0, 0, mass * 9.81);
  BOOST_TEST(off(held, weight) < kLimit);
}

// A' a = E_i' a_i + beta_i at every joint inboard of the constraint, whatever moves: in a chain of
// revolute joints with the motion carried outward by X and Z.
BOOST_AUTO_TEST_CASE(unit_forces_and_beta_give_the_acceleration_of_the_constraint) {
  const scene::Scene scene = scene::findScene("two_handed");
  const scene::State<double> state = drawState(scene.mechanism, scene.name, 1, 0);
  const Shown shown(scene, state);
  const PreparedScene prepared(scene);
  const Eigen::MatrixXd qdd =
      articulatedBodyKind().make(prepared).value()->value(Quantity::kQdd, state);
  const auto m = static_cast<Eigen::Index>(scene.mechanism.acceleration_constraints.size());
  const Eigen::VectorXd all_E = shown.quantities.value(JointQuantity::kE),
                        all_beta = shown.quantities.value(JointQuantity::kBeta);
  Six a_0 = Six::Zero();
  a_0(2) = 9.81;
  std::vector<Six> a, v;
  Eigen::MatrixXd seen(m, static_cast<Eigen::Index>(shown.axes.size()));
  for (std::size_t i = 0; i < shown.axes.size(); ++i) {
    const int p = shown.inboard(i);
    const auto at = static_cast<Eigen::Index>(i);
    const Matrix6 X = shown.matrix(JointQuantity::kX, i);
    const Six Z_qd = shown.Z(i) * state.qd[i];
    v.push_back(Z_qd);
    if (p >= 0) v.back() += X * v[static_cast<std::size_t>(p)];
    Six c;
    const Eigen::Vector3d w = v.back().tail<3>(), l = v.back().head<3>(), z = Z_qd.tail<3>(),
                          s = Z_qd.head<3>();
    c << w.cross(s) + l.cross(z), w.cross(z);
    a.push_back(X * (p < 0 ? a_0 : a[static_cast<std::size_t>(p)]) + c + shown.Z(i) * qdd(at, 0));
    const Eigen::Map<const Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>> E(
        all_E.data() + 6 * m * at, 6, m);
    seen.col(at) = E.transpose() * a.back() + all_beta.segment(m * at, m);
  }
  int compared = 0;
  for (Eigen::Index k = 0; k < m; ++k) {
    const auto of = static_cast<std::size_t>(k);
    const int link = scene.mechanism.acceleration_constraints[of].link;
    for (int i = link; i > 0; i = scene.mechanism.links[static_cast<std::size_t>(i)].parent) {
      BOOST_TEST(
          std::abs(seen(k, i - 1) - seen(k, link - 1)) < kLimit * (1 + std::abs(seen(k, i - 1))),
          "constraint " << k << ", link " << i);
      compared += i == link ? 0 : 1;
    }
    BOOST_TEST(std::abs(all_beta(m * (link - 1) + k)) == 0);
  }
  BOOST_TEST(compared >= 6);
}

BOOST_AUTO_TEST_CASE(every_number_has_a_name_and_a_unit) {
  for (const char* name : {"two_handed", "humanoid_floating", "satellite_held"}) {
    const scene::Scene scene = scene::findScene(name);
    JointQuantities quantities(scene, {});
    quantities.at(drawState(scene.mechanism, scene.name, 1, 0));
    for (const char* asked : {"X", "M_i", "M_C", "M_A", "P", "PM", "Z", "F", "PF", "E", "beta"}) {
      const JointQuantity quantity = *jointQuantityNamed(asked);
      if (quantity >= JointQuantity::kE && scene.mechanism.acceleration_constraints.empty())
        continue;
      const auto count = static_cast<std::size_t>(quantities.value(quantity).size());
      BOOST_TEST(quantities.columns(quantity).size() == count, name << ", " << asked);
      BOOST_TEST(quantities.units(quantity).size() == count, name << ", " << asked);
    }
  }
}
