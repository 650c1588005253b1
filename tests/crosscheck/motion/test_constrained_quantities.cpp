// SPDX-License-Identifier: GPL-3.0-or-later
// What evaluate says about constrained scenes: the sweeps against one dense system in double
// precision, tasks, and the chapter's question about N_0 in numbers.
#include "crosscheck/motion/constrained_quantities.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <nlohmann/json.hpp>

#include "crosscheck/audit/audit.hpp"
#include "crosscheck/motion/simulate.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

double largest(const Eigen::MatrixXd& m) {
  return m.size() == 0 ? 0 : m.cwiseAbs().maxCoeff();
}

/// Exit status and standard output and error of the program.
std::pair<int, std::string> program(const std::string& arguments) {
  std::FILE* pipe =
      popen((std::string(DYNWITNESS_PROGRAM) + " " + arguments + " 2>&1").c_str(), "r");
  std::string text;
  char buffer[256];
  while (pipe && std::fgets(buffer, sizeof buffer, pipe)) text += buffer;
  return {pipe ? WEXITSTATUS(pclose(pipe)) : -1, text};
}

}  // namespace

// Two eliminations of one system: each is off by cond(M) eps of the largest entry. Measured: up to
// 3e-12, of Andrews' mechanism, whose inertias differ by 1e4.
BOOST_DATA_TEST_CASE(sweeps_are_one_dense_system,
                     data::make({"two_handed", "bead_on_hoop", "kapitza_pendulum",
                                 "andrews_squeezer", "loop_on_arm", "four_bars_2",
                                 "humanoid_left_foot", "humanoid_both_feet"}),
                     name) {
  const scene::Scene scene = scene::findScene(std::string(name));
  const ConstrainedQuantities quantities(scene);
  const scene::State<double> start = quantities.start();
  const ConstrainedMotion swept = quantities.motion(start, ConstrainedRoad::kSweeps),
                          dense = quantities.motion(start, ConstrainedRoad::kDense);
  const double limit = 1e-10;
  BOOST_TEST(swept.rank == dense.rank);
  if (dense.rank == dense.rows) {
    BOOST_TEST(largest(swept.lambda - dense.lambda) <= limit * (1 + largest(dense.lambda)));
    BOOST_TEST(largest(swept.nu - dense.nu) <= limit * (1 + largest(dense.nu)));
  }
  BOOST_TEST(largest(swept.qdd - dense.qdd) <= limit * (1 + largest(dense.qdd)));
  BOOST_TEST(largest(swept.tau - dense.tau) <= limit * (1 + largest(dense.tau)));
  for (const bool determined : dense.nu_determined) BOOST_TEST(determined);
}

// the simulation's solver, a third road: QR in M's norm
BOOST_DATA_TEST_CASE(accelerations_are_those_of_the_simulation,
                     data::make({"car_axis", "andrews_squeezer", "bead_on_hoop"}), name) {
  const scene::Scene scene = scene::findScene(std::string(name));
  const ConstrainedQuantities quantities(scene);
  const scene::State<double> start = quantities.start();
  std::vector<double> q;
  for (const auto& x : start.x) q.push_back(x.q);
  const ConstrainedState state = constrainedAccelerations(scene, q, start.qd);
  const ConstrainedMotion motion = quantities.motion(start, quantities.usualRoad());
  for (Eigen::Index i = 0; i < motion.qdd.size(); ++i)
    BOOST_TEST(std::abs(motion.qdd(i) - state.qdd[i]) <= 1e-10 * (1 + largest(motion.qdd)));
  for (Eigen::Index i = 0; i < motion.lambda.size(); ++i)
    BOOST_TEST(std::abs(motion.lambda(i) - state.lambda[i]) <=
               1e-10 * (1 + largest(motion.lambda)));
  for (std::size_t i = 0; i < state.drive.size(); ++i)
    if (state.drive[i] != 0)
      BOOST_TEST(std::abs(motion.tau(i) - state.drive[i]) <= 1e-10 * (1 + largest(motion.tau)));
}

// Khatib's identities: J Jbar = 1, Lambda N = 1, and the null-space torque moves no task
BOOST_AUTO_TEST_CASE(tasks_have_a_consistent_inverse) {
  const ConstrainedQuantities quantities(scene::findScene("two_handed"));
  scene::State<double> state = quantities.start();
  state.tau = {1, -2, 3, 0.5, -1};
  const Eigen::MatrixXd J = quantities.answer(ConstrainedQuantity::kJ, state),
                        Jbar = quantities.answer(ConstrainedQuantity::kJbar, state),
                        N = quantities.answer(ConstrainedQuantity::kN, state),
                        Lambda = quantities.answer(ConstrainedQuantity::kTaskInertia, state);
  const Eigen::Index m = J.rows();
  BOOST_TEST(largest(J * Jbar - Eigen::MatrixXd::Identity(m, m)) < 1e-12);
  BOOST_TEST(largest(Lambda * N - Eigen::MatrixXd::Identity(m, m)) < 1e-12);
  const Eigen::VectorXd null = quantities.answer(ConstrainedQuantity::kNullTorque, state);
  BOOST_TEST(largest(Jbar.transpose() * null) < 1e-12);
  BOOST_TEST(largest(null) > 0.1);
  // the controller's torques differ by the posture's share alone
  const Eigen::VectorXd with = quantities.answer(ConstrainedQuantity::kTaskTorque, state);
  state.tau.assign(5, 0.0);
  BOOST_TEST(largest(with - quantities.answer(ConstrainedQuantity::kTaskTorque, state) - null) <
             1e-12);
}

BOOST_AUTO_TEST_CASE(the_program_answers_and_refuses) {
  auto [status, text] = program("evaluate two_handed --quantity qdd,nu,tau_drive");
  BOOST_TEST(status == 0, text);
  BOOST_TEST(text.find("\nqdd1,qdd2,qdd3,qdd4,qdd5,nu1,nu2,nu3,nu4,tau_drive1") !=
             std::string::npos);  // after what is told
  std::tie(status, text) = program("evaluate andrews_squeezer --quantity qdd,lambda");
  BOOST_TEST(status == 0, text);
  BOOST_TEST(text.find("\n14222.44391") != std::string::npos);  // published (test_constraints)
  std::tie(status, text) = program("evaluate acrobot --quantity nu");
  BOOST_TEST(status == 2);
  BOOST_TEST(
      text.find("nu: the scene has no acceleration_constraint, expected one") != std::string::npos,
      text);
  std::tie(status, text) = program("evaluate andrews_squeezer --quantity tau");
  BOOST_TEST(status == 2);
  std::tie(status, text) =
      program("simulate car_axis --duration 0.1 --formulation index3 --method runge_kutta_dopri5");
  BOOST_TEST(status == 2);
  std::tie(status, text) = program(
      "simulate pendulum_on_slides --duration 0.5 --step 0.01 --compare --json compare.json");
  BOOST_TEST(status == 0, text);
  for (const char* form : {"\nindex1 ", "\nindex2 ", "\nindex3 ", "\nggl "})
    BOOST_TEST(text.find(form) != std::string::npos, form);
  std::ifstream json("compare.json");
  BOOST_TEST(nlohmann::json::parse(json).at("runs").size() == 8u);
  std::remove("compare.json");
  std::tie(status, text) = program("simulate car_axis --duration 3");
  BOOST_TEST(status == 0);
  BOOST_TEST(text.find("10 values, agree") != std::string::npos, text);
}

BOOST_AUTO_TEST_CASE(n_0_is_definite_where_the_constraints_are_independent) {
  const audit::Rows rows = audit::definitenessRows();
  std::vector<std::string> verdicts;
  for (const auto& row : rows) verdicts.push_back(row.back());
  const std::vector<std::string> expected = {
      "definite",     "definite",     "definite",
      "definite",     "semidefinite",               // two rods, stretched last
      "definite",     "semidefinite", "definite",   // PUMA, wrist straight, and soft
      "semidefinite", "semidefinite", "definite"};  // doubled, too many, a joint to spare
  BOOST_TEST(verdicts == expected, boost::test_tools::per_element());
  // det N = s^2 / (1 + s^2) of two rods
  for (int k = 0; k < 4; ++k) {
    const double q[] = {1, 0.1, 0.01, 0.001}, s = std::sin(q[k]);
    const double det = std::stod(rows[k][4]) * std::stod(rows[k][5]);
    BOOST_TEST(std::abs(det / (s * s / (1 + s * s)) - 1) <
               0.01);  // three digits of each are printed
  }
}
