// SPDX-License-Identifier: GPL-3.0-or-later
// Coordinates of other engines: the engines themselves are told states in theirs, and have to see
// the same poses and to need the same forces, which are ours in theirs.
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <unistd.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "crosscheck/inputs/conventions.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/motion/point_quantities.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/formats.hpp"
#include "scene/numbers.hpp"
#include "scene/scene.hpp"

#ifdef DYNWITNESS_HAS_MUJOCO
#include <mujoco/mujoco.h>
#endif
#ifdef DYNWITNESS_HAS_DART
#include <dart/dynamics/BallJoint.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#endif
#include <Simbody.h>

using namespace dynwitness;
using namespace dynwitness::crosscheck;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

// numbers chosen here; nothing is symmetric, so that no two axes can be mistaken for each other
const std::string kText = R"(
title = "a body that floats, another on a ball joint, a third on a hinge"
gravity = [0.3, -1.1, -9.5]
[[link]]
name = "ground"
[[link]]
name = "body"
parent = "ground"
mass = 3
com = [0.1, -0.2, 0.05]
inertia = { xx = 0.5, yy = 0.7, zz = 0.6, xy = 0.03, xz = -0.02, yz = 0.05 }
joint = { name = "free", kind = "floating" }
[[link]]
name = "head"
parent = "body"
mass = 1.25
com = [-0.05, 0.1, 0.3]
inertia = { xx = 0.2, yy = 0.25, zz = 0.15, xy = -0.01, xz = 0.02, yz = 0.01 }
joint = { name = "neck", kind = "spherical", xyz = [0.3, -0.1, 0.4], rpy = [0.3, -0.2, 0.5] }
[[link]]
name = "jaw"
parent = "head"
mass = 0.5
com = [0.1, 0.05, -0.1]
inertia = { xx = 0.02, yy = 0.03, zz = 0.025, xy = 0.002, xz = 0.001, yz = -0.003 }
joint = { name = "hinge", kind = "revolute", xyz = [0.1, 0.2, 0.3] }
)";

/// A drawn state, what belongs to it by our sweeps, and the poses of the links.
struct Ours {
  scene::Scene scene = scene::readSceneToml(kText, "bodies.toml");
  scene::State<double> state;
  VectorXd tau;
  Eigen::MatrixXd M;
  std::vector<Vector3d> place;
  std::vector<Matrix3d> turn;

  explicit Ours(int index) : state(drawState(scene.mechanism, scene.name, 3, index)) {
    const auto answer = [&](const char* who, Quantity quantity) {
      return selectWitnesses({who}).front().make(scene).value()->value(quantity, state);
    };
    tau = answer("newton_euler", Quantity::kTau);
    M = answer("composite_body", Quantity::kM);
    PointQuantities points(scene, {}, JointAxes::kWorld);
    points.at(state);
    const VectorXd p = points.value(PointQuantity::kPosition);
    const VectorXd R = points.value(PointQuantity::kOrientation);  // row by row
    for (Eigen::Index k = 0; k < 3; ++k) {
      place.emplace_back(p.segment<3>(3 * k));
      turn.emplace_back(Eigen::Map<const Matrix3d>(R.data() + 9 * k).transpose());
    }
  }
};

/// Such a state in an engine's coordinates.
struct Theirs {
  std::vector<double> q, qd, qdd, tau;
  Theirs(const Ours& ours, CoordinateConvention convention) {
    const Coordinates coordinates(ours.scene.mechanism, convention);
    q = coordinates.positionsOf(ours.state);
    qd = coordinates.theirs(ours.state, ours.state.qd);
    qdd = coordinates.turning(ours.state);
    for (std::size_t k = 0; k < qdd.size(); ++k) qdd[k] += ours.state.qdd[k];
    qdd = coordinates.theirs(ours.state, qdd);
    tau = coordinates.theirs(ours.state, {ours.tau.data(), ours.tau.data() + ours.tau.size()});
  }
};

// Two programs that compute the same by different roads: forces differ by 1.5e-15 of the largest at
// most, over all states and engines. The limit leaves thirty times that; poses, of the order of 1,
// have twice the limit of forces.
constexpr double kPoses = 1e-13, kForces = 5e-14;

void sameForces(const double* engine, const std::vector<double>& tau) {
  double most = 0, worst = 0;
  for (std::size_t k = 0; k < tau.size(); ++k) {
    most = std::max(most, std::abs(tau[k]));
    worst = std::max(worst, std::abs(tau[k] - engine[k]));
  }
  BOOST_TEST(worst <= kForces * most);
}

constexpr int kStates = 20;

}  // namespace

BOOST_AUTO_TEST_SUITE(engines_asked_themselves)

#ifdef DYNWITNESS_HAS_MUJOCO
BOOST_AUTO_TEST_CASE(mujoco_sees_the_same_pose_and_needs_the_same_forces) {
  const scene::Scene scene = scene::readSceneToml(kText, "bodies.toml");
  const std::string xml = scene::writeSceneAs(scene, scene::Format::kMjcf).text;
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() /
      ("dynwitness_conventions_" + std::to_string(getpid()) + ".xml");
  std::ofstream(file) << xml;
  char error[1000] = "";
  mjModel* model = mj_loadXML(file.c_str(), nullptr, error, sizeof error);
  std::filesystem::remove(file);
  BOOST_REQUIRE_MESSAGE(model != nullptr, error);
  // its own principal axes of a full inertia are good to 1e-8: those of Eigen in their place
  const scene::RealNumbers<double> number(scene.mechanism);
  for (const scene::Link& link : scene.mechanism.links) {
    if (link.parent < 0) continue;
    const auto& i = link.inertia;
    Matrix3d I;
    I << number(i.xx), number(i.xy), number(i.xz), number(i.xy), number(i.yy), number(i.yz),
        number(i.xz), number(i.yz), number(i.zz);
    const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(I);
    Matrix3d axes = principal.eigenvectors();
    if (axes.determinant() < 0) axes.col(0) *= -1;
    const Eigen::Quaterniond turn(axes);
    const int body = mj_name2id(model, mjOBJ_BODY, link.name.c_str());
    const double wxyz[] = {turn.w(), turn.x(), turn.y(), turn.z()};
    std::copy(wxyz, wxyz + 4, model->body_iquat + 4 * body);
    std::copy_n(principal.eigenvalues().data(), 3, model->body_inertia + 3 * body);
    model->body_sameframe[body] = 0;
  }
  mjData* data = mj_makeData(model);
  BOOST_REQUIRE(model->nq == 7 + 4 + 1);
  for (int index = 0; index < kStates; ++index) {
    const Ours ours(index);
    const Theirs theirs(ours, CoordinateConvention::kMujoco);
    std::copy(theirs.q.begin(), theirs.q.end(), data->qpos);
    std::copy(theirs.qd.begin(), theirs.qd.end(), data->qvel);
    std::copy(theirs.qdd.begin(), theirs.qdd.end(), data->qacc);
    mj_inverse(model, data);
    for (int k = 0; k < 3; ++k) {
      const int body =
          mj_name2id(model, mjOBJ_BODY, ours.scene.mechanism.links[k + 1].name.c_str());
      BOOST_REQUIRE(body > 0);
      const Eigen::Map<const Vector3d> p(data->xpos + 3 * body);
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(data->xmat + 9 * body);
      BOOST_TEST((p - ours.place[k]).norm() < kPoses);
      BOOST_TEST((R - ours.turn[k]).norm() < kPoses);
    }
    sameForces(data->qfrc_inverse, theirs.tau);
  }
  mj_deleteData(data);
  mj_deleteModel(model);
}
#endif

#ifdef DYNWITNESS_HAS_DART
namespace joints = dart::dynamics;

BOOST_AUTO_TEST_CASE(dart_sees_the_same_pose_and_needs_the_same_forces) {
  const auto skeleton = joints::Skeleton::create();
  skeleton->setGravity({0.3, -1.1, -9.5});
  const auto body = [](const char* name, double mass, const Vector3d& com, const Matrix3d& I) {
    joints::BodyNode::Properties properties{joints::BodyNode::AspectProperties(name)};
    properties.mInertia = joints::Inertia(mass, com, I);
    return properties;
  };
  Matrix3d I;
  I << 0.5, 0.03, -0.02, 0.03, 0.7, 0.05, -0.02, 0.05, 0.6;
  joints::BodyNode* at = skeleton
                             ->createJointAndBodyNodePair<joints::FreeJoint>(
                                 nullptr, {}, body("body", 3, {0.1, -0.2, 0.05}, I))
                             .second;
  joints::BallJoint::Properties neck;
  neck.mName = "neck";
  neck.mT_ParentBodyToJoint.translation() = Vector3d(0.3, -0.1, 0.4);
  neck.mT_ParentBodyToJoint.linear() =
      (Eigen::AngleAxisd(0.5, Vector3d::UnitZ()) * Eigen::AngleAxisd(-0.2, Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.3, Vector3d::UnitX()))
          .toRotationMatrix();
  I << 0.2, -0.01, 0.02, -0.01, 0.25, 0.01, 0.02, 0.01, 0.15;
  at = skeleton
           ->createJointAndBodyNodePair<joints::BallJoint>(at, neck,
                                                           body("head", 1.25, {-0.05, 0.1, 0.3}, I))
           .second;
  joints::RevoluteJoint::Properties hinge;
  hinge.mName = "hinge";
  hinge.mAxis = Vector3d::UnitZ();
  hinge.mT_ParentBodyToJoint.translation() = Vector3d(0.1, 0.2, 0.3);
  I << 0.02, 0.002, 0.001, 0.002, 0.03, -0.003, 0.001, -0.003, 0.025;
  skeleton->createJointAndBodyNodePair<joints::RevoluteJoint>(
      at, hinge, body("jaw", 0.5, {0.1, 0.05, -0.1}, I));
  BOOST_REQUIRE(skeleton->getNumDofs() == 10u);
  const auto vector = [](const std::vector<double>& x) {
    return VectorXd(Eigen::Map<const VectorXd>(x.data(), static_cast<Eigen::Index>(x.size())));
  };
  for (int index = 0; index < kStates; ++index) {
    const Ours ours(index);
    const Theirs theirs(ours, CoordinateConvention::kDart);
    skeleton->setPositions(vector(theirs.q));
    skeleton->setVelocities(vector(theirs.qd));
    skeleton->setAccelerations(vector(theirs.qdd));
    skeleton->computeInverseDynamics();
    for (int k = 0; k < 3; ++k) {
      const Eigen::Isometry3d& X =
          skeleton->getBodyNode(static_cast<std::size_t>(k))->getWorldTransform();
      BOOST_TEST((X.translation() - ours.place[k]).norm() < kPoses);
      BOOST_TEST((X.linear() - ours.turn[k]).norm() < kPoses);
    }
    const VectorXd tau = skeleton->getForces();
    sameForces(tau.data(), theirs.tau);
  }
}
#endif

BOOST_AUTO_TEST_CASE(simbody_sees_the_same_pose_and_needs_the_same_forces) {
  using namespace SimTK;
  MultibodySystem system;
  SimbodyMatterSubsystem matter(system);
  GeneralForceSubsystem forces(system);
  Force::UniformGravity(forces, matter, Vec3(0.3, -1.1, -9.5));
  const auto body = [](double mass, const Vec3& com, const Inertia& about_com) {
    return Body::Rigid(MassProperties(mass, com, about_com.shiftFromMassCenter(com, mass)));
  };
  const Rotation turn(BodyOrSpaceType::SpaceRotationSequence, 0.3, XAxis, -0.2, YAxis, 0.5, ZAxis);
  MobilizedBody::Free first(
      matter.Ground(), Transform(),
      body(3, Vec3(0.1, -0.2, 0.05), Inertia(0.5, 0.7, 0.6, 0.03, -0.02, 0.05)), Transform());
  MobilizedBody::Ball second(
      first, Transform(turn, Vec3(0.3, -0.1, 0.4)),
      body(1.25, Vec3(-0.05, 0.1, 0.3), Inertia(0.2, 0.25, 0.15, -0.01, 0.02, 0.01)), Transform());
  MobilizedBody::Pin third(
      second, Transform(Vec3(0.1, 0.2, 0.3)),
      body(0.5, Vec3(0.1, 0.05, -0.1), Inertia(0.02, 0.03, 0.025, 0.002, 0.001, -0.003)),
      Transform());
  SimTK::State state = system.realizeTopology();
  BOOST_REQUIRE(state.getNQ() == 12);
  for (int index = 0; index < kStates; ++index) {
    const Ours ours(index);
    const Theirs theirs(ours, CoordinateConvention::kSimbody);
    for (int k = 0; k < 12; ++k) state.updQ()[k] = theirs.q[static_cast<std::size_t>(k)];
    for (int k = 0; k < 10; ++k) state.updU()[k] = theirs.qd[static_cast<std::size_t>(k)];
    system.realize(state, Stage::Dynamics);
    SimTK::Vector udot(10), tau;
    for (int k = 0; k < 10; ++k) udot[k] = theirs.qdd[static_cast<std::size_t>(k)];
    matter.calcResidualForceIgnoringConstraints(
        state, system.getMobilityForces(state, Stage::Dynamics),
        system.getRigidBodyForces(state, Stage::Dynamics), udot, tau);
    const MobilizedBody* bodies[] = {&first, &second, &third};
    for (int k = 0; k < 3; ++k) {
      const Transform& X = bodies[k]->getBodyTransform(state);
      double p = 0, R = 0;
      for (int i = 0; i < 3; ++i) {
        p += std::abs(X.p()[i] - ours.place[k][i]);
        for (int j = 0; j < 3; ++j) R += std::abs(X.R()[i][j] - ours.turn[k](i, j));
      }
      BOOST_TEST(p < kPoses);
      BOOST_TEST(R < kPoses);
    }
    std::vector<double> out;
    for (int k = 0; k < 10; ++k) out.push_back(tau[k]);
    sameForces(out.data(), theirs.tau);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(others)

// By hand: turned by 90 degrees about z the body's x axis is the world's y. It moves along its own
// x at 1 m/s and turns about it at 2 rad/s.
BOOST_AUTO_TEST_CASE(a_quarter_turn_is_written_as_each_engine_has_it) {
  const scene::Scene scene = scene::readSceneToml(kText, "bodies.toml");
  scene::State<double> state;
  const double h = std::sqrt(0.5), quarter = std::acos(-1.0) / 2;
  for (const double q : {1.0, 2.0, 3.0, h, 0.0, 0.0, h, h, 0.0, 0.0, h, 0.5})
    state.x.push_back(scene::jointPosition(q));
  state.qd = {1, 0, 0, 2, 0, 0, 3, 0, 0, 7};
  struct Row {
    CoordinateConvention convention;
    std::vector<double> q, qd;
  };
  const std::vector<Row> rows = {{CoordinateConvention::kPinocchio,
                                  {1, 2, 3, 0, 0, h, h, 0, 0, h, h, 0.5},
                                  {1, 0, 0, 2, 0, 0, 3, 0, 0, 7}},
                                 {CoordinateConvention::kMujoco,
                                  {1, 2, 3, h, 0, 0, h, h, 0, 0, h, 0.5},
                                  {0, 1, 0, 2, 0, 0, 3, 0, 0, 7}},
                                 {CoordinateConvention::kRbdl,
                                  {1, 2, 3, 0, 0, h, 0, 0, h, 0.5, h, h},
                                  {0, 1, 0, 2, 0, 0, 3, 0, 0, 7}},
                                 {CoordinateConvention::kDrake,
                                  {h, 0, 0, h, 1, 2, 3, 0, 0, quarter, 0.5},
                                  {0, 2, 0, 0, 1, 0, 0, 3, 0, 7}},
                                 {CoordinateConvention::kSimbody,
                                  {h, 0, 0, h, 1, 2, 3, h, 0, 0, h, 0.5},
                                  {0, 2, 0, 0, 1, 0, 0, 3, 0, 7}},
                                 {CoordinateConvention::kDart,
                                  {0, 0, quarter, 1, 2, 3, 0, 0, quarter, 0.5},
                                  {2, 0, 0, 1, 0, 0, 3, 0, 0, 7}}};
  for (const Row& row : rows) {
    BOOST_TEST_CONTEXT(name(row.convention)) {
      const Coordinates coordinates(scene.mechanism, row.convention);
      const std::vector<double> q = coordinates.positionsOf(state),
                                qd = coordinates.theirs(state, state.qd);
      BOOST_REQUIRE(q.size() == row.q.size());
      // a sine of pi / 2 or a root of 1/2, rounded: a few times 1e-16
      for (std::size_t k = 0; k < q.size(); ++k) BOOST_TEST(std::abs(q[k] - row.q[k]) < 1e-15);
      for (std::size_t k = 0; k < qd.size(); ++k) BOOST_TEST(std::abs(qd[k] - row.qd[k]) < 4e-15);
    }
  }
}

// There and back, by the two directions of every convention.
BOOST_AUTO_TEST_CASE(a_state_comes_back) {
  for (const CoordinateConvention convention : kAllConventions)
    for (int index = 0; index < kStates; ++index) {
      const Ours ours(index);
      const Theirs theirs(ours, convention);
      const Coordinates coordinates(ours.scene.mechanism, convention);
      scene::State<double> back;
      back.qd = theirs.qd, back.qdd = theirs.qdd, back.tau = theirs.tau;
      coordinates.read(theirs.q, &back);
      const auto same = [&](const std::vector<double>& a, const std::vector<double>& b) {
        for (std::size_t k = 0; k < a.size(); ++k)
          BOOST_TEST(std::abs(a[k] - b[k]) < 1e-12, name(convention) << " " << k);
      };
      same(back.qd, ours.state.qd);
      same(back.qdd, ours.state.qdd);
      same(back.tau, {ours.tau.data(), ours.tau.data() + ours.tau.size()});
    }
}

BOOST_AUTO_TEST_CASE(joints_that_are_sorted_otherwise_are_refused) {
  const auto with = [](const std::string& joint) {
    std::string text = kText;
    const std::string is = "joint = { name = \"free\", kind = \"floating\" }";
    return scene::readSceneToml(text.replace(text.find(is), is.size(), joint), "bodies.toml");
  };
  const scene::Scene planar = with("joint = { name = \"p\", kind = \"planar\" }"),
                     moved = with("joint = { name = \"f\", kind = \"floating\", xyz = [0, 0, 1] }");
  BOOST_CHECK_THROW(Coordinates(planar.mechanism, CoordinateConvention::kPinocchio),
                    scene::InputError);
  BOOST_CHECK_THROW(Coordinates(moved.mechanism, CoordinateConvention::kMujoco), scene::InputError);
  BOOST_CHECK_NO_THROW(Coordinates(moved.mechanism, CoordinateConvention::kSimbody));
  BOOST_CHECK_NO_THROW(Coordinates(planar.mechanism, CoordinateConvention::kDynwitness));
}

BOOST_AUTO_TEST_SUITE_END()
