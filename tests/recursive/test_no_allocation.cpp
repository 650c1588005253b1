// SPDX-License-Identifier: GPL-3.0-or-later
// No allocation in a sweep: counted, through operator new and through Eigen, which allocates on its
// own.

#include <cstdlib>
#include <new>
#include <string>
#include <vector>

namespace {
long allocations = 0;
}

// Eigen takes memory from malloc and asks this macro before each time it does
#define EIGEN_RUNTIME_NO_MALLOC
#define eigen_assert(x)      \
  do {                       \
    if (!(x)) ++allocations; \
  } while (false)
#include <Eigen/Core>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/constrained_dynamics.hpp"
#include "recursive/constraints.hpp"
#include "recursive/derivatives.hpp"
#include "recursive/energy.hpp"
#include "recursive/fast/closed_dynamics.hpp"
#include "recursive/fast/derivatives.hpp"
#include "recursive/fast/dynamics.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/regressor.hpp"
#include "scene/scene.hpp"

// the whole program's; the nothrow, array and sized forms of the library end up in these. Not
// inline: g++ 12 would see malloc and delete side by side and warn that they do not match
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::recursive;

namespace {

/// Allocations while `work` runs.
template <typename Work>
long allocationsIn(const Work& work) {
  Eigen::internal::set_is_malloc_allowed(false);
  const long before = allocations;
  work();
  const long counted = allocations - before;
  Eigen::internal::set_is_malloc_allowed(true);
  return counted;
}

double kept = 0;
/// Keeps the compiler from leaving work out.
void keep(double value) {
  *static_cast<volatile double*>(&kept) = value;
}

}  // namespace

namespace no_allocation {

struct Bench {
  explicit Bench(const std::string& name)
      : mechanism(scene::findScene(name).mechanism),
        model(buildModel(mechanism, scene::RealNumbers<double>(mechanism))),
        ws(model),
        x(static_cast<std::size_t>(model.dof()), scene::jointPosition(0.3)),
        qd(x.size(), 0.7),
        in(x.size(), 1.1),
        out(x.size(), 0.0),
        M(model.dof(), model.dof()) {}

  scene::Mechanism mechanism;
  Model<double> model;
  Workspace<double> ws;
  std::vector<JointPosition<double>> x;
  std::vector<double> qd, in, out;
  MatrixX<double> M;
};

const std::vector<std::string> kScenes = {"franka_panda", "humanoid", "prismatic_revolute_mix"};

}  // namespace no_allocation

using no_allocation::Bench;
using no_allocation::kScenes;

// The counter works: an allocation of either kind is seen.
BOOST_AUTO_TEST_CASE(an_allocation_is_counted) {
  BOOST_TEST(allocationsIn([] { keep(std::vector<double>(100, 1.0)[50]); }) > 0);
  BOOST_TEST(allocationsIn([] { keep(Eigen::MatrixXd(Eigen::MatrixXd::Ones(30, 30))(3, 4)); }) > 0);
  BOOST_TEST(allocationsIn([] { keep(1); }) == 0);
}

// A sweep with an allocation in it is caught: the Coriolis matrix is for checks and does allocate.
BOOST_DATA_TEST_CASE(a_sweep_that_allocates_is_caught, data::make(kScenes), scene) {
  Bench b(scene);
  BOOST_TEST(allocationsIn([&] { coriolisMatrix(b.model, b.x, b.qd, b.ws); }) > 0);
}

BOOST_DATA_TEST_CASE(inverse_dynamics_allocates_nothing, data::make(kScenes), scene) {
  Bench b(scene);
  BOOST_TEST(allocationsIn([&] { inverseDynamics(b.model, b.x, b.qd, b.in, b.ws, b.out); }) == 0);
  BOOST_TEST(b.out[0] != 0);  // it did run
}

BOOST_DATA_TEST_CASE(forward_dynamics_allocates_nothing, data::make(kScenes), scene) {
  Bench b(scene);
  BOOST_TEST(allocationsIn([&] { forwardDynamics(b.model, b.x, b.qd, b.in, b.ws, b.out); }) == 0);
  BOOST_TEST(b.out[0] != 0);
}

BOOST_DATA_TEST_CASE(the_mass_matrix_allocates_nothing, data::make(kScenes), scene) {
  Bench b(scene);
  BOOST_TEST(allocationsIn([&] { massMatrix(b.model, b.x, b.ws, b.M); }) == 0);
  BOOST_TEST(b.M(0, 0) > 0);
}

BOOST_DATA_TEST_CASE(derivatives_allocate_nothing, data::make(kScenes), scene) {
  Bench b(scene);
  DerivativesWorkspace<double> room(b.model);
  InverseDynamicsDerivatives<double> of_tau(b.model);
  ForwardDynamicsDerivatives<double> of_qdd(b.model);
  BOOST_TEST(allocationsIn([&] {
               forwardDynamicsDerivatives(b.model, b.x, b.qd, b.in, room, of_tau, of_qdd);
             }) == 0);
  BOOST_TEST(of_qdd.dqdd_dq.cwiseAbs().maxCoeff() > 0);
}

BOOST_DATA_TEST_CASE(the_fast_sweeps_allocate_nothing, data::make(kScenes), scene) {
  Bench b(scene);
  fast::Dynamics dynamics(b.model);
  const std::vector<double> q(b.x.size(), 0.3);
  BOOST_TEST(allocationsIn([&] {
               dynamics.inverseDynamics(q.data(), b.qd.data(), b.in.data(), b.out.data());
               dynamics.massMatrix(q.data(), b.M.data());
               dynamics.forwardDynamics(q.data(), b.qd.data(), b.in.data(), b.out.data());
             }) == 0);
  BOOST_TEST(b.out[0] != 0);
}

BOOST_DATA_TEST_CASE(the_fast_derivatives_allocate_nothing, data::make(kScenes), scene) {
  Bench b(scene);
  fast::Derivatives of(b.model);
  const std::vector<double> q(b.x.size(), 0.3);
  MatrixX<double> by_q = b.M, by_qd = b.M;
  BOOST_TEST(allocationsIn([&] {
               of.inverseDynamics(q.data(), b.qd.data(), b.in.data(), by_q.data(), by_qd.data(),
                                  b.M.data());
               of.forwardDynamics(q.data(), b.qd.data(), b.in.data(), by_q.data(), by_qd.data(),
                                  b.M.data());
             }) == 0);
  BOOST_TEST(by_q.cwiseAbs().maxCoeff() > 0);
}

BOOST_DATA_TEST_CASE(the_regressor_allocates_nothing, data::make(kScenes), scene) {
  Bench b(scene);
  const auto parameters = dynwitness::scene::inertialParameters(b.mechanism);
  MatrixX<double> Y(b.model.dof(), parameters.size());
  BOOST_TEST(allocationsIn([&] { regressor(b.model, parameters, b.x, b.qd, b.in, b.ws, Y); }) == 0);
  BOOST_TEST(Y.cwiseAbs().maxCoeff() > 0);
}

BOOST_DATA_TEST_CASE(constraint_equations_allocate_nothing,
                     data::make(std::vector<std::string>{"andrews_squeezer", "bricard"}), scene) {
  Bench b(scene);
  Constraints<double> constraints =
      buildConstraints(b.mechanism, scene::RealNumbers<double>(b.mechanism), b.model);
  BOOST_TEST(allocationsIn([&] { constraintEquations(b.model, b.x, b.qd, b.ws, constraints); }) ==
             0);
  BOOST_TEST(constraints.J.cwiseAbs().maxCoeff() > 0);  // it did run
}

BOOST_AUTO_TEST_CASE(fast_closed_dynamics_allocates_nothing) {
  Bench b("andrews_squeezer");
  const scene::RealNumbers<double> number(b.mechanism);
  fast::ClosedDynamics dynamics(b.model, buildConstraints(b.mechanism, number, b.model),
                                buildPointSprings(b.mechanism, number, b.model));
  const std::vector<double> q(b.x.size(), 0.3);
  BOOST_TEST(allocationsIn([&] {
               dynamics.forwardDynamics(q.data(), b.qd.data(), b.in.data(), b.out.data());
             }) == 0);
  BOOST_TEST(dynamics.rank() > 0);
}

BOOST_DATA_TEST_CASE(constrained_forward_dynamics_allocates_nothing, data::make(kScenes), scene) {
  Bench b(scene);
  LinkConstraint<double> held;  // the last link's frame, against moving along and turning about x
  held.link = static_cast<int>(b.model.links.size()) - 1;
  held.A = Eigen::Matrix<double, 6, 2>::Zero();
  held.A(0, 0) = held.A(3, 1) = 1;
  held.b = Eigen::Vector2d::Zero();
  const std::vector<LinkConstraint<double>> constraints = {held};
  ConstraintWorkspace<double> cws(b.model, 2);
  BOOST_TEST(allocationsIn([&] {
               constrainedForwardDynamics(b.model, b.x, b.qd, b.in, constraints, b.ws, cws, b.out);
             }) == 0);
  BOOST_TEST(cws.nu(0) != 0);
}

BOOST_DATA_TEST_CASE(energies_and_momentum_allocate_nothing, data::make(kScenes), scene) {
  Bench b(scene);
  BOOST_TEST(allocationsIn([&] { keep(kineticEnergy(b.model, b.x, b.qd, b.ws)); }) == 0);
  BOOST_TEST(kept > 0);
  BOOST_TEST(allocationsIn([&] { keep(potentialEnergy(b.model, b.x, b.ws)); }) == 0);
  BOOST_TEST(kept != 0);
  BOOST_TEST(allocationsIn([&] { keep(momentum(b.model, b.x, b.qd, b.ws).moment.norm()); }) == 0);
  BOOST_TEST(kept > 0);
}
