// SPDX-License-Identifier: GPL-3.0-or-later
// Deviations of what joints pass on and of accelerations, against dense inertias of subtrees, whose
// change is an exact difference over a prime field, and against a pendulum by hand.
#include "crosscheck/motion/uncertain_quantities.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/motion/joint_pass.hpp"
#include "crosscheck/motion/parameter_errors.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/factorization.hpp"
#include "scene/scene.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

using F = PrimeField;
using Matrix = recursive::MatrixX<F>;
using Position = std::vector<scene::JointPosition<F>>;

const std::vector<std::string> kScenes = {"double_pendulum",        "puma_560",  "cardan_pendulum",
                                          "prismatic_revolute_mix", "heavy_top", "cylindrical_arm"};

/// Inertia of what hangs on a link of the model, that link free in space: the six rates of the
/// link, then those of all joints outboard, by the Jacobian of each link.
Matrix ofFreeSubtree(const recursive::Model<F>& model, const Position& x, int base) {
  Matrix M = Matrix::Constant(6 + model.dof(), 6 + model.dof(), F(0));
  std::vector<Matrix> J(model.links.size());
  std::vector<Eigen::Index> kept = {0, 1, 2, 3, 4, 5};
  for (int i = base; i < static_cast<int>(model.links.size()); ++i) {
    const recursive::LinkModel<F>& link = model.links[i];
    if (i != base && (link.parent < base || J[link.parent].size() == 0)) continue;
    J[i] = Matrix::Constant(6, M.cols(), F(0));
    if (i == base)
      J[i].leftCols(6) = recursive::Matrix6<F>::Identity();
    else
      J[i] = recursive::AnyJoints::transform(link, x).motionMatrix() * J[link.parent];
    for (int k = 0; i != base && k < recursive::AnyJoints::axes(link); ++k) {
      const Eigen::Index column = 6 + link.dof + k;
      J[i].col(column) = recursive::jointAxis(link, k);
      M(column, column) += link.rotor;
      kept.push_back(column);
    }
    M += J[i].transpose() *
         Matrix(recursive::ArticulatedInertia<F>::fromRigid(link.M).matrix() * J[i]);
  }
  return M(kept, kept);
}

/// W with M_A = W' M W of the free subtree, and so dM_A = W' dM W: (1; -M_jj^-1 M_jb).
Matrix eliminated(const Matrix& M) {
  const Eigen::Index m = M.rows() - 6;
  Matrix W = Matrix::Constant(M.rows(), 6, F(0)), M_jj = M.bottomRightCorner(m, m);
  W.topRows(6) = recursive::Matrix6<F>::Identity();
  recursive::factorize(M_jj);
  for (Eigen::Index k = 0; k < 6; ++k) {
    recursive::VectorX<F> y = -M.col(k).tail(m);
    recursive::solve(M_jj, y);
    W.col(k).tail(m) = y;
  }
  return W;
}

/// What one error does to the numbers of a model, of it as it is and of it changed.
struct Changed {
  std::function<recursive::Model<F>(const F& size, const scene::CosSin<F>& turn)> model;
  bool is_turn;
};

/** The exact derivative by the error of what is a polynomial of at most second degree in an
    inertia or a shift, or of second degree in cosine and sine of a turn; as test_uncertainty
    has it. */
template <typename Of>
Matrix derivative(const Changed& changed, const FieldSource& source, const Of& of) {
  const F step = source.element("step");
  const scene::CosSin<F> none = {F(1), F(0)};
  const auto half = [&](const F& s, const scene::CosSin<F>& turn) {
    const Matrix difference = of(changed.model(s, turn)) - of(changed.model(-s, {turn.c, -turn.s}));
    return Matrix(difference * (F(1) / F(2)));
  };
  if (!changed.is_turn) return half(step, none) * (F(1) / step);
  const scene::CosSin<F> a = source.circlePoint("first"), b = source.circlePoint("second");
  const Matrix y_a = half(F(0), a) * (F(1) / a.s), y_b = half(F(0), b) * (F(1) / b.s);
  return y_a + (y_b - y_a) * ((F(1) - a.c) / (b.c - a.c));
}

struct Case {
  explicit Case(const std::string& name)
      : mechanism(scene::findScene(name).mechanism),
        source("uncertain " + name, 4, 0),
        number(mechanism, source),
        models(mechanism, number),
        state(indeterminateState(mechanism, source)),
        model(recursive::buildModel(mechanism, number, recursive::FixedJoints::kKept)) {}

  Changed misplaced(int column) const {
    return {[this, column](const F& size, const scene::CosSin<F>& turn) {
              recursive::Model<F> out = model;
              recursive::Vector3<F> p(F(0), F(0), F(0));
              scene::CosSin<F> turns[3] = {{F(1), F(0)}, {F(1), F(0)}, {F(1), F(0)}};
              const int error = column % kErrorsOfJoint;
              if (error < 3)
                p(error) = size;
              else
                turns[error - 3] = turn;
              displace<F>(out.links[placedJoints(mechanism, out)[column / kErrorsOfJoint]], p,
                          turns[0], turns[1], turns[2]);
              return out;
            },
            column % kErrorsOfJoint >= 3};
  }
  Changed misweighed(const std::vector<F>& direction) const {
    return {[this, direction](const F& size, const scene::CosSin<F>&) {
              recursive::Model<F> out = model;
              std::vector<F> pi = recursive::inertialValues(mechanism, models.parameters(), number);
              for (std::size_t j = 0; j < pi.size(); ++j) pi[j] += size * direction[j];
              recursive::setInertialValues(out, models.parameters(), pi);
              return out;
            },
            false};
  }

  scene::Mechanism mechanism;
  FieldSource source;
  FieldNumbers number;
  ErroneousModels<FieldNumbers> models;
  scene::State<F> state;
  recursive::Model<F> model;
};

template <typename Part>
Matrix partOf(const recursive::MatrixX<Dual<F>>& duals, const Part& part) {
  Matrix out(duals.rows(), duals.cols());
  for (Eigen::Index i = 0; i < out.rows(); ++i)
    for (Eigen::Index j = 0; j < out.cols(); ++j) out(i, j) = part(duals(i, j));
  return out;
}

bool isZero(const Matrix& M) {
  return std::all_of(M.reshaped().begin(), M.reshaped().end(),
                     [](const F& x) { return x.isZero(); });
}

/// (d + Z'M_A Z)^-1 times the rows of B.
Matrix solved(Matrix D, Matrix B) {
  recursive::factorize(D);
  for (Eigen::Index k = 0; k < B.cols(); ++k) {
    recursive::VectorX<F> y = B.col(k);
    recursive::solve(D, y);
    B.col(k) = y;
  }
  return B;
}

/** M_A and P of every joint change by this error as the dense inertias do:
        dP = -P dM_A Z D^-1 Z' + M_A Z D^-1 dd D^-1 Z' @return  how many do change */
int requireChanges(const Case& of, const recursive::Model<Dual<F>>& dual, const Changed& changed) {
  const scene::State<Dual<F>> at = constantState(of.state);
  JointPass<Dual<F>> pass(dual);
  pass.run(at.x, at.qd, at.tau);
  int changes = 0;
  for (std::size_t i = 0; i < of.mechanism.links.size(); ++i) {
    if (of.mechanism.links[i].parent < 0) continue;
    const JointInModel<Dual<F>> joint(of.mechanism, pass.model(), i);
    const int base = joint.parts.front();
    const auto value = [&](JointQuantity quantity) {
      return partOf(pass.of(joint, quantity), [](const Dual<F>& x) { return x.value; });
    };
    const auto change = [&](JointQuantity quantity) {
      return partOf(pass.of(joint, quantity), [](const Dual<F>& x) { return x.derivative; });
    };
    const Matrix W = eliminated(ofFreeSubtree(of.model, of.state.x, base));
    const Matrix dM = derivative(changed, of.source, [&](const recursive::Model<F>& model) {
      return ofFreeSubtree(model, of.state.x, base);
    });
    const Matrix to_link = of.model.joints[i].X.inverse().motionMatrix();
    const Matrix dM_A = to_link.transpose() * Matrix(W.transpose() * dM * W) * to_link;
    BOOST_TEST(isZero(change(JointQuantity::kM_A) - dM_A), "M_A of " << joint.name);
    changes += !isZero(dM_A);

    const Matrix Z = value(JointQuantity::kZ), M_A = value(JointQuantity::kM_A),
                 P = value(JointQuantity::kP);
    const Eigen::Index axes = Z.cols();
    if (axes == 0) continue;
    const auto rotors = [&](const recursive::Model<F>& model) {
      Matrix d = Matrix::Constant(axes, axes, F(0));
      Eigen::Index k = 0;
      for (std::size_t part = joint.parts.size(); part-- > 0;)
        for (int axis = 0; axis < recursive::axisCount(model.links[joint.parts[part]].kind); ++axis)
          d(k, k) = model.links[joint.parts[part]].rotor, ++k;
      return d;
    };
    const Matrix D = rotors(of.model) + Matrix(Z.transpose() * M_A * Z);
    const Matrix D_Z = solved(D, Z.transpose());
    const Matrix dd = derivative(changed, of.source, rotors);
    const Matrix dP = Matrix(M_A * Z) * solved(D, dd * D_Z) - Matrix(P * dM_A * Z) * D_Z;
    BOOST_TEST(isZero(change(JointQuantity::kP) - dP), "P of " << joint.name);
  }
  return changes;
}

}  // namespace

BOOST_DATA_TEST_CASE(inertias_pass_joints_changed_as_dense_ones_are, data::make(kScenes), name) {
  const PrimeField::Modulus modulus(drawPrime(name, 4, 0));
  const Case of(name);
  std::vector<F> direction;
  for (std::size_t j = 0; j < of.models.parameters().size(); ++j)
    direction.push_back(of.source.element("direction " + std::to_string(j)));
  BOOST_TEST(requireChanges(of, of.models.misweighed(direction), of.misweighed(direction)) > 0);
}

BOOST_DATA_TEST_CASE(misplaced_joints_pass_on_what_dense_inertias_say, data::make(kScenes), name) {
  const PrimeField::Modulus modulus(drawPrime(name, 4, 0));
  const Case of(name);
  int changes = 0;
  for (int k = 0; k < of.models.placements(); ++k)
    changes += requireChanges(of, of.models.misplaced(k), of.misplaced(k));
  BOOST_TEST((changes > 0 || of.mechanism.links.size() == 2));
}

/* A pendulum about z with m = 2, c = (0.5, 0, 0), Izz = 0.75 about the joint, gravity along -y of
   its frame at q = 0. Its errors are those of m c alone, s = 0.01 m times m = 2 kg along each axis;
   I about the joint's origin stays. So, by hand, with h = m c:

       M_A = [m, -[h]x; [h]x, I]: M_A26 = h_x, M_A16 = -h_y, M_A44 = Ixx: deviations 0.02, 0.02, 0
       P = 1 - U Z' / Izz, U = (-h_y, h_x, 0, Ixz, Iyz, Izz): P16 and P26: 0.02 / 0.75, in 1/m
       qdd = -h_x g / Izz: 0.02 * 10 / 0.75 */
BOOST_AUTO_TEST_CASE(deviations_of_a_pendulum_are_those_on_paper) {
  const scene::Scene scene = scene::readSceneToml(R"(
title = "Pendulum"
gravity = [0, -10, 0]
[[link]]
name = "world"
[[link]]
name = "arm"
parent = "world"
mass = 2
com = [0.5, 0, 0]
inertia = { about = "com", xx = 0.25, yy = 0.25, zz = 0.25 }
[link.joint]
name = "pivot"
kind = "revolute"
axis = [0, 0, 1]
)",
                                                  "pendulum.toml");
  JointQuantities joints(scene, {});
  const UncertainQuantities uncertain(scene, readUncertainty("com=0.01"), &joints);
  scene::State<double> state{{scene::jointPosition(0.0)}, {0.0}, {0.0}, {0.0}};
  const auto at = [&](JointQuantity quantity, const std::string& column) {
    const std::vector<std::string> names = joints.columns(quantity);
    const auto found = std::find(names.begin(), names.end(), column);
    BOOST_REQUIRE((found != names.end()));
    return uncertain.joints(quantity, state).together()(found - names.begin());
  };
  const auto same = [](double a, double b) { return std::abs(a - b) <= 8 * 0x1p-52 * b; };
  joints.at(state);
  for (const char* column : {"pivot.M_A26", "pivot.M_A62", "pivot.M_A16", "pivot.M_A61"})
    BOOST_TEST(same(at(JointQuantity::kM_A, column), 0.02), column);
  for (const char* column : {"pivot.M_A11", "pivot.M_A44", "pivot.M_A66", "pivot.M_A36"})
    BOOST_TEST(at(JointQuantity::kM_A, column) == 0, column);
  for (const char* column : {"pivot.P16", "pivot.P26"})
    BOOST_TEST(same(at(JointQuantity::kP, column), 0.02 / 0.75), column);
  for (const char* column : {"pivot.P61", "pivot.P62", "pivot.P36", "pivot.P66", "pivot.P44"})
    BOOST_TEST(at(JointQuantity::kP, column) == 0, column);
  BOOST_TEST(same(uncertain.qdd(state).together()(0), 0.02 * 10 / 0.75));
  BOOST_TEST(uncertain.qdd(state).by_placement(0) == 0);
  BOOST_TEST(same(uncertain.tau(state).together()(0), 0.02 * 10));
}

BOOST_AUTO_TEST_CASE(what_has_no_deviation_is_refused) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  const Uncertainty turned = readUncertainty("rpy=0.01");
  const JointQuantities world(scene, {}, JointAxes::kWorld);
  BOOST_CHECK_THROW(UncertainQuantities(scene, turned, &world), scene::InputError);
  UncertainQuantities(scene, readUncertainty("mass=0.01"), &world);
  const JointQuantities link(scene, {});
  const UncertainQuantities uncertain(scene, turned, &link);
  const scene::State<double> state = drawState(scene.mechanism, scene.name, 1, 0);
  BOOST_CHECK_THROW(uncertain.joints(JointQuantity::kE, state), scene::InputError);
}
