// SPDX-License-Identifier: GPL-3.0-or-later
// The humanoid on one foot, the other, both, or in the air: welds to the world against the same
// robot with that foot as its base, without rounding; and what two feet leave undetermined.
#include <random>

#include <Eigen/SVD>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/motion/simulate.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/closed_dynamics.hpp"
#include "recursive/constrained_solver.hpp"
#include "recursive/hybrid_dynamics.hpp"
#include "recursive/reroot.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using namespace dynwitness::recursive;

namespace {

using F = PrimeField;

int linkOf(const scene::Mechanism& mechanism, const Model<F>& model, const char* name) {
  for (std::size_t i = 0; i < mechanism.links.size(); ++i)
    if (mechanism.links[i].name == name) return model.places[i].link;
  throw std::logic_error("no such link");
}

/// The floating robot at a random state in which this foot rests, and its feet.
struct Standing {
  Standing(const char* name, const char* foot_name)
      : scene(scene::findScene(name)),
        modulus(drawPrime("standing", 1, 0)),
        source("standing", 1, 0),
        number(scene.mechanism, source, Parameters::kAsWritten),
        model(buildModel(scene.mechanism, number)),
        ws(model),
        foot(linkOf(scene.mechanism, model, foot_name)),
        from_foot(reroot(model, foot)),
        at_foot(indeterminateState(scene.mechanism, source)) {
    for (int k = 0; k < 6; ++k) at_foot.qd[k] = F(0);
    // the same state, seen from the scene's own root: where it is, and its twist, in its own frame
    state = at_foot;
    Workspace<F> ws_foot(from_foot.model);
    linkVelocities(from_foot.model, at_foot.x, at_foot.qd, ws_foot);
    const Transform<F> back = from_foot.X[0].inverse();
    Transform<F> X = back;
    for (int i = from_foot.link[0]; i >= 0; i = from_foot.model.links[i].parent)
      X = X * ws_foot.X_up[i];
    const Matrix3<F> R = X.R.transpose();
    const F q[] = {F(1) + R.trace(), R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)};
    const Motion<F> v = back * ws_foot.v[from_foot.link[0]];
    for (int k = 0; k < 3; ++k) {
      state.x[k].q = X.p(k);
      state.qd[k] = v.linear(k);
      state.qd[3 + k] = v.angular(k);
    }
    for (int k = 0; k < 4; ++k) state.x[3 + k].q = q[k];
    linkVelocities(model, state.x, state.qd, ws);
  }
  scene::Scene scene;
  PrimeField::Modulus modulus;
  FieldSource source;
  FieldNumbers number;
  Model<F> model;
  Workspace<F> ws;
  int foot;
  Rerooted<F> from_foot;
  scene::State<F> at_foot, state;
};

/// The scene's closures, each welded where its foot is now.
Constraints<F> weldedHere(Standing& s) {
  Constraints<F> welds = buildConstraints(s.scene.mechanism, s.number, s.model);
  linkVelocities(s.model, s.state.x, s.state.qd, s.ws);
  std::vector<Transform<F>> X_W(s.model.links.size());
  for (std::size_t i = 0; i < X_W.size(); ++i)
    X_W[i] =
        s.model.links[i].parent < 0 ? s.ws.X_up[i] : s.ws.X_up[i] * X_W[s.model.links[i].parent];
  for (Closure<F>& weld : welds.closures) weld.X_A = weld.X_B * X_W[weld.b];
  constraintEquations(s.model, s.state.x, s.state.qd, s.ws, welds);
  return welds;
}

/// The force and moment of a weld on its foot, in the foot's axes.
Force<F> wrench(const Closure<F>& weld, const VectorX<F>& lambda) {
  Force<F> sum = Force<F>::zero();
  const Transform<F> X_BA = Transform<F>::identity();  // phi = 0
  for (int k = 0; k < 6; ++k) {
    Motion<F> unit = Motion<F>::zero();
    (k < 3 ? unit.linear(k) : unit.angular(k - 3)) = F(1);
    F component = F(0);
    recursive::detail::closureRates(weld, unit, X_BA, [&](int row, const F& rate) {
      component += rate * lambda(weld.row + row);
    });
    (k < 3 ? sum.force(k) : sum.moment(k - 3)) = component;
  }
  return weld.X_B.inverseTimes(sum);
}

}  // namespace

// The re-rooted robot with its base held by hybrid dynamics: six accelerations given, zero, and six
// forces found.
struct Foot {
  const char *scene, *link;
};
std::ostream& operator<<(std::ostream& out, const Foot& foot) {
  return out << foot.scene;
}
const Foot kFeet[] = {{"humanoid_right_foot", "right_foot"}, {"humanoid_left_foot", "left_foot"}};

BOOST_DATA_TEST_CASE(standing_on_a_foot_is_having_that_foot_as_base, data::make(kFeet), sample) {
  Standing s(sample.scene, sample.link);
  const Constraints<F> welds = weldedHere(s);
  for (Eigen::Index k = 0; k < welds.phi.size(); ++k) BOOST_TEST(welds.phi(k).isZero());
  const auto welded =
      closedForwardDynamics(s.model, s.state.x, s.state.qd, s.state.tau, welds, s.ws);

  Workspace<F> ws(s.from_foot.model);
  ConstraintWorkspace<F> none(s.from_foot.model, 0);
  std::vector<char> driven(s.model.dof(), 0);
  std::fill_n(driven.begin(), 6, 1);
  std::vector<F> qdd(s.model.dof(), F(0)), tau = s.state.tau;
  // joint forces work on the same joints; the root's six are the floating foot's of either tree
  for (int k = 0; k < 6; ++k) s.state.tau[k] = F(0);
  const auto free_root =
      closedForwardDynamics(s.model, s.state.x, s.state.qd, s.state.tau, welds, s.ws);
  hybridDynamics(s.from_foot.model, s.at_foot.x, s.at_foot.qd, driven, {}, ws, none, qdd, tau);
  for (int i = 6; i < s.model.dof(); ++i)
    BOOST_TEST((free_root.qdd[i] == qdd[i]), "joint " << i - 6);
  const Force<F> ground = wrench(welds.closures[0], free_root.lambda);
  for (int k = 0; k < 3; ++k) {
    BOOST_TEST((ground.force(k) == tau[k]), "force " << k);
    BOOST_TEST((ground.moment(k) == tau[3 + k]), "moment " << k);
  }
  BOOST_TEST(!ground.force(2).isZero());
  // what pushes the root without a support does not leave a welded root's joints alone, unless it
  // is the foot
  if (s.foot != 0) BOOST_TEST((welded.qdd[7] != free_root.qdd[7]));
}

// Both feet, from either root: the same accelerations and the same forces of the ground.
BOOST_AUTO_TEST_CASE(on_both_feet_it_does_not_matter_which_is_the_root) {
  Standing right("humanoid_both_feet", "right_foot");
  const Constraints<F> welds = weldedHere(right);
  for (int k = 0; k < 6; ++k) right.state.tau[k] = F(0);
  const auto from_right = closedForwardDynamics(right.model, right.state.x, right.state.qd,
                                                right.state.tau, welds, right.ws);
  for (const char determined : from_right.determined) BOOST_TEST(determined == 1);

  // the same closures on the tree that starts from the left foot
  const int left = linkOf(right.scene.mechanism, right.model, "left_foot");
  const Rerooted<F> tree = reroot(right.model, left);
  scene::State<F> state = right.state;
  rerootState(right.model, tree, right.ws, state.x, state.qd);
  Workspace<F> ws(tree.model);
  Constraints<F> there = welds;
  for (Closure<F>& weld : there.closures) {
    weld.X_B = weld.X_B * tree.X[weld.b].inverse();
    weld.b = tree.link[weld.b];
  }
  there.X_W.assign(tree.model.links.size(), Transform<F>::identity());
  there.chain.assign(tree.model.links.size(), 0);
  constraintEquations(tree.model, state.x, state.qd, ws, there);
  for (Eigen::Index k = 0; k < there.phi.size(); ++k) BOOST_TEST(there.phi(k).isZero());
  const auto from_left = closedForwardDynamics(tree.model, state.x, state.qd, state.tau, there, ws);
  for (int i = 6; i < right.model.dof(); ++i)
    BOOST_TEST((from_right.qdd[i] == from_left.qdd[i]), "joint " << i - 6);
  for (Eigen::Index k = 0; k < 12; ++k)
    BOOST_TEST((from_right.lambda(k) == from_left.lambda(k)), "lambda " << k);
}

namespace {

std::vector<double> values(const scene::Scene& scene, const std::vector<scene::Number>& numbers) {
  const scene::RealNumbers<double> number(scene.mechanism);
  std::vector<double> out;
  for (const scene::Number& n : numbers) out.push_back(number(n));
  return out;
}

}  // namespace

// Given the joint forces, two feet have rank twelve, with straight legs too: the pelvis may still
// roll. With the pelvis held as well, each straight leg loses one: how much it is pressed between
// hip and ground is not determined.
BOOST_AUTO_TEST_CASE(redundant_supports_are_told_by_rank) {
  scene::Scene scene = scene::findScene("humanoid_both_feet");
  const scene::Scene legs = scene::findScene("humanoid_right_foot");
  const std::vector<double> qd(37, 0.0), bent = values(scene, scene.start_q),
                                         straight = values(legs, legs.start_q);
  for (const auto* q : {&bent, &straight}) {
    const ConstrainedState state = constrainedAccelerations(scene, *q, qd);
    BOOST_TEST(state.rank == 12);
    for (const bool determined : state.determined) BOOST_TEST(determined);
  }
  scene::Closure corset = scene.mechanism.closures[0];
  for (std::size_t i = 0; i < scene.mechanism.links.size(); ++i)
    if (scene.mechanism.links[i].name == "pelvis") corset.b.link = static_cast<int>(i);
  const auto hold = [&](const std::vector<double>& q) {  // where the pelvis is now
    Simulation here;
    here.points.push_back({});
    here.points.back().q = q;
    here.points.back().qd = qd;
    const auto p = pathOf(scene, here, {corset.b.link, {}, {}})[0];
    for (int k = 0; k < 3; ++k) corset.a.xyz[k] = scene::Number(scene::Rational(p[k]));
    scene::Scene held = scene;
    held.mechanism.closures.push_back(corset);
    return constrainedAccelerations(held, q, qd);
  };
  const ConstrainedState soft = hold(bent), hard = hold(straight);
  BOOST_TEST(soft.rank == 18);
  BOOST_TEST(hard.rank == 16);
  int undetermined = 0;
  for (const bool determined : hard.determined) undetermined += determined ? 0 : 1;
  BOOST_TEST(undetermined >= 4);  // a dependence takes two rows at least
  // the accelerations are right all the same: the feet and the pelvis rest, so the legs do
  // (rounding: 500 N on inertias of 1e-2, over the limit of rank, 6e-6)
  for (int i = 0; i < 18; ++i) BOOST_TEST(std::abs(hard.qdd[i]) < 1e-6);
}

// Given the motion instead: 31 motors and twelve forces of the ground are 43 unknowns of 37
// equations. [S' J'] has rank 37, and six numbers of force between the feet remain free.
BOOST_AUTO_TEST_CASE(given_the_motion_six_forces_between_the_feet_are_free) {
  const scene::Scene scene = scene::findScene("humanoid_both_feet");
  const scene::RealNumbers<double> number(scene.mechanism);
  const auto model = buildModel(scene.mechanism, number);
  Workspace<double> ws(model);
  auto welds = buildConstraints(scene.mechanism, number, model);
  std::vector<scene::JointPosition<double>> x;
  for (const double q : values(scene, scene.start_q)) x.push_back(scene::jointPosition(q));
  constraintEquations(model, x, std::vector<double>(37, 0.0), ws, welds);
  MatrixX<double> columns = MatrixX<double>::Zero(37, 43);
  columns.bottomLeftCorner(31, 31).setIdentity();
  columns.rightCols(12) = welds.J.transpose();
  BOOST_TEST(Eigen::JacobiSVD<MatrixX<double>>(columns).rank() == 37);
}

// Bent knees, soft legs: it sinks, the feet stay, and the energy is kept.
BOOST_DATA_TEST_CASE(the_feet_stay_where_they_are,
                     data::make({"humanoid_right_foot", "humanoid_left_foot",
                                 "humanoid_both_feet"}),
                     name) {
  SimulateOptions options;
  options.duration = 0.2;
  options.outputs = 4;
  options.step_error = 1e-8;
  const Simulation simulation = simulate(scene::findScene(std::string(name)), options);
  BOOST_TEST(simulation.start_residual < 1e-15);  // the start stands on its feet as written
  BOOST_TEST(simulation.worst_phi < 1e-14);
  // some 100 steps of 1e-8, the energy some 500 J
  BOOST_TEST(simulation.worst_energy < 1e-8 * simulation.steps * 100);
}
