// SPDX-License-Identifier: GPL-3.0-or-later
// A scene from another of its links: the same mechanism. Its M is held, through the map of rates
// that the two starts show, to that of the scene itself, by Lagrange's equations from T; V, and how
// the whole mechanism accelerates, with a weld that replaces the floor where there was one, to the
// scene's.
#include "crosscheck/motion/rooted.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <boost/test/unit_test.hpp>

#include "crosscheck/motion/constrained_quantities.hpp"
#include "recursive/build_model.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/energy.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

namespace {

/// Shares of the largest number. M and V are sums of some 40 turns and shifts: measured 2.2e-15 at
/// most. qdd is solved for, twice: 9.7e-12 at most, of the gripper, and 1e-13 of all others.
constexpr double kLimit = 1e-13, kSolvedLimit = 1e-10;

/// At a seeded start; what rests in the world gets mass, which nothing but a weld feels.
scene::Scene seeded(scene::Scene scene, unsigned seed) {
  std::mt19937 random(seed);
  const auto drawn = [&random] {
    return scene::Number(scene::Rational(static_cast<int>(random() % 2001) - 1000, 700));
  };
  if (scene.mechanism.closures.empty() && !scene.mechanism.hasMimics())
    for (scene::Number& q : scene.start_q) q = drawn();
  if (!scene.mechanism.isDriven() && scene.mechanism.closures.empty())
    for (scene::Number& qd : scene.start_qd) qd = drawn();
  scene::MassProperties& base = scene.mechanism.links[0].inertia;
  base = scene::MassProperties();
  base.mass = base.xx = base.yy = base.zz = scene::Number(2);
  return scene;
}

Vector column(const std::vector<scene::Number>& numbers, const scene::Mechanism& m) {
  const scene::RealNumbers<double> number(m);
  Vector out(static_cast<Eigen::Index>(numbers.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i) out(i) = number(numbers[i]);
  return out;
}

Matrix massByLagrange(const scene::Mechanism& m, const scene::State<double>& state) {
  symbolic::Options options;
  options.fold_parameters = true;
  symbolic::Equations e = symbolic::derive(m, options);
  const symbolic::Program program = symbolic::compile(e.graph, symbolic::massCoriolisGravity(e));
  const auto values = symbolic::ProgramRun<double>(program, scene::RealNumbers<double>(m))(state);
  Matrix M(m.dof(), m.dof());
  for (int i = 0; i < M.rows(); ++i)
    for (int j = 0; j < M.cols(); ++j) M(i, j) = values[static_cast<std::size_t>(i * M.cols() + j)];
  return M;
}

struct Swept {
  explicit Swept(const scene::Scene& scene, const scene::State<double>& state)
      : M(scene.mechanism.dof(), scene.mechanism.dof()) {
    const auto model =
        recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
    recursive::Workspace<double> ws(model);
    recursive::massMatrix(model, state.x, ws, M);
    V = recursive::potentialEnergy(model, state.x, ws);
  }
  Matrix M;
  double V = 0;
};

double off(const Matrix& a, const Matrix& b) {
  return (a - b).cwiseAbs().maxCoeff() / std::max(1.0, b.cwiseAbs().maxCoeff());
}

/// The rates of the other tree by those of the scene's, column by column as its starts have them.
Matrix rateMap(scene::Scene scene, const scene::State<double>& at, const std::string& link) {
  const int n = scene.mechanism.dof();
  for (scene::Link& one : scene.mechanism.links) one.joint.motion.clear();  // which knows its rate
  for (std::size_t k = 0; k < at.x.size(); ++k)
    scene.start_q[k] = scene::Number(scene::Rational(at.x[k].q));
  Matrix B;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i)
      scene.start_qd[static_cast<std::size_t>(i)] = scene::Number(i == j ? 1 : 0);
    const scene::Scene other = rooted(scene, link);
    const Vector rates = column(other.start_qd, other.mechanism);
    if (j == 0) B.resize(rates.size(), n);
    B.col(j) = rates;
  }
  return B;
}

/// How far the two trees are apart, as shares of the largest number.
struct Apart {
  double M = 0, V = 0, qdd = 0;
};
Apart apart(const scene::Scene& scene, const std::string& link) {
  const scene::Scene other = rooted(scene, link);
  const ConstrainedQuantities here(scene), there(other);
  scene::State<double> state = here.start(), moved = there.start();
  Apart out;
  const Swept of_scene(scene, state), of_other(other, moved);
  const Matrix B = rateMap(scene, state, link);
  out.M = off(B.transpose() * of_other.M * B, massByLagrange(scene.mechanism, state));
  // what rests in the world has a potential energy in both
  out.V = std::abs(of_other.V - of_scene.V) / std::max(1.0, std::abs(of_scene.V));
  const Vector qdd = here.motion(state, here.usualRoad()).qdd,
               other_qdd = there.motion(moved, there.usualRoad()).qdd;
  const std::vector<std::string> names = scene.mechanism.rateLabels(),
                                 other_names = other.mechanism.rateLabels();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto at = std::find(other_names.begin(), other_names.end(), names[i]);
    const bool keeps_its_q = at != other_names.end() && names[i].find('.') == std::string::npos;
    if (!keeps_its_q) continue;
    const double gap =
        std::abs(other_qdd(at - other_names.begin()) - qdd(static_cast<Eigen::Index>(i)));
    out.qdd = std::max(out.qdd, gap / std::max(1.0, qdd.cwiseAbs().maxCoeff()));
  }
  return out;
}

scene::Scene bundled(const std::string& name) {
  return scene::findScene(name);
}

}  // namespace

// Each bundled scene from its last link and one between.
BOOST_AUTO_TEST_CASE(another_link_is_the_root_of_the_same_mechanism) {
  int held = 0;
  Apart worst;
  for (const auto& file : scene::bundledScenes()) {
    const scene::Scene scene = seeded(scene::readScene(file), 3);
    const auto& links = scene.mechanism.links;
    for (const std::size_t i : {links.size() - 1, links.size() / 2}) {
      BOOST_TEST_CONTEXT(scene.name << " from " << links[i].name) {
        try {
          rooted(scene, links[i].name);
        } catch (const scene::InputError& refusal) {
          BOOST_TEST_MESSAGE(refusal.what());
          continue;
        }
        const Apart by = apart(scene, links[i].name);
        BOOST_TEST_MESSAGE(scene.name << " from " << links[i].name << ": M " << by.M << ", V "
                                      << by.V << ", qdd " << by.qdd);
        BOOST_TEST(by.M <= kLimit);
        BOOST_TEST(by.V <= kLimit);
        BOOST_TEST(by.qdd <= kSolvedLimit);
        worst = {std::max(worst.M, by.M), std::max(worst.V, by.V), std::max(worst.qdd, by.qdd)};
        ++held;
      }
    }
  }
  BOOST_TEST_MESSAGE(held << " trees; worst: M " << worst.M << ", V " << worst.V << ", qdd "
                          << worst.qdd);
  BOOST_TEST(held >= 70);  // the others are refused
}

BOOST_AUTO_TEST_CASE(what_cannot_be_the_root_is_refused_with_the_reason) {
  const auto refusal = [](const scene::Scene& scene, const std::string& link) {
    try {
      rooted(scene, link);
    } catch (const scene::InputError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  const auto says = [](const std::string& text, const std::string& part) {
    BOOST_TEST(text.find(part) != std::string::npos, text);
  };
  says(refusal(bundled("puma_560"), "link6"), "did you mean link_6?");
  says(refusal(bundled("acrobot"), "lower"), "\"base\", which rested in the world, moves with");
  says(refusal(bundled("satellite_arm"), "forearm"), "joint \"shoulder\" is universal");
  scene::Scene wrist = seeded(bundled("gyroscopic_wrist"), 1);
  says(refusal(wrist, wrist.mechanism.links.back().name), "gyroscopic rotor of joint");
  scene::Scene fixed = bundled("double_pendulum");
  fixed.mechanism.links[1].joint.kind = scene::JointKind::kFixed;
  says(refusal(fixed, fixed.mechanism.links[1].name), "rests in the world as");
}

// By hand: the arm of the Furuta pendulum is a thin rod on the axis of its hinge, so that from the
// pendulum it spins on the hinge freely, and from itself, while the hinge turns back. Given any
// moment about that axis (0 <= xx <= yy + zz), it does not.
BOOST_AUTO_TEST_CASE(a_root_from_which_a_motion_moves_no_inertia_is_refused) {
  scene::Scene furuta = bundled("furuta_pendulum");
  const auto refusal = [&](const std::string& link) {
    try {
      rooted(furuta, link);
    } catch (const scene::InputError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  const auto says = [](const std::string& text, const std::string& part) {
    BOOST_TEST(text.find(part) != std::string::npos, text);
  };
  says(refusal("pendulum"),
       "a motion of hinge of link \"arm\" alone moves no inertia in any state");
  says(refusal("arm"),
       "a motion of arm.in_the_world.wx of link \"arm\" and hinge of link \"pendulum\" together");
  furuta.mechanism.links[1].inertia.xx = scene::Number::parse("m1*r^2/1000000");
  BOOST_TEST(refusal("pendulum") == "taken");
  BOOST_TEST(refusal("arm") == "taken");
  // a drive holds the hinge, whatever it moves
  furuta = bundled("furuta_pendulum");
  furuta.mechanism.links[2].joint.motion = {scene::Expression::parseOfTime("sin(t)")};
  BOOST_TEST(refusal("pendulum") == "taken");
}

BOOST_AUTO_TEST_CASE(the_root_that_it_has_changes_nothing) {
  const scene::Scene puma = bundled("puma_560"), humanoid = bundled("humanoid_floating");
  BOOST_TEST(scene::writeSceneToml(rooted(puma, "base")) == scene::writeSceneToml(puma));
  BOOST_TEST(scene::writeSceneToml(rooted(humanoid, "right_foot")) ==
             scene::writeSceneToml(humanoid));
}

// There and back: the first floating tree again, with its own q.
BOOST_AUTO_TEST_CASE(back_to_the_first_root) {
  const scene::Scene scene = bundled("humanoid_floating"),
                     back = rooted(rooted(scene, "left_foot"), "right_foot");
  BOOST_TEST(scene.mechanism.rateLabels() == back.mechanism.rateLabels(),
             boost::test_tools::per_element());
  const Vector q = column(scene.start_q, scene.mechanism),
               q_back = column(back.start_q, back.mechanism);
  BOOST_TEST((q.head(3) - q_back.head(3)).norm() <= 1e-14);  // 30 turns of some 1 m: measured 2e-16
  BOOST_TEST((q.tail(31) - q_back.tail(31)).norm() == 0);
}
