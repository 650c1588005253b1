// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of time in lanes, and states shared out to threads. Expected by another road: textbook
// sweeps in long double, moved by crosscheck/motion's and Boost.odeint's steps.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>
#include <vector>

#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/tree_motion.hpp"
#include "crosscheck/scalars/many_states.hpp"
#include "recursive/build_model.hpp"
#include "recursive/fast/all_cores.hpp"
#include "tests/fixtures/lanes/many_derivatives.hpp"
#include "tests/fixtures/lanes/many_steps.hpp"
#include "tests/fixtures/lanes/widths.hpp"
#include "tests/fixtures/scene_files.hpp"

namespace {
std::atomic<long> allocations{0};  // threads count, too
}

// not inline: g++ 12 would see malloc and delete side by side and warn that they do not match
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto to = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(to, (size + to - 1) / to * to)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

using namespace dynwitness;
using namespace dynwitness::recursive::fast;
using recursive::Model;

namespace {

constexpr int kStates = 19;
constexpr double kStep = 1e-3;  // [s]
constexpr Integrator kIntegrators[] = {Integrator::kSemiImplicitEuler, Integrator::kRungeKutta4};

/// Seeded states of a scene, one after the other.
struct Start {
  explicit Start(const scene::Scene& scene, int count = kStates)
      : model(recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism))),
        n(model.dof()),
        nq(model.positions) {
    for (int k = 0; k < count; ++k) {
      const auto state = crosscheck::drawState(scene.mechanism, scene.name, 3, k);
      for (const auto& x : state.x) q.push_back(x.q);
      qd.insert(qd.end(), state.qd.begin(), state.qd.end());
      tau.insert(tau.end(), state.tau.begin(), state.tau.end());
    }
  }
  std::size_t count() const { return n == 0 ? 0 : qd.size() / static_cast<std::size_t>(n); }
  /// Both one after the other, after so many steps.
  std::vector<double> moved(int width, Integrator integrator, int steps) const {
    std::vector<double> q_to = q, qd_to = qd;
    ManySteps(model, width)
        .step(count(), integrator, kStep, steps, {q_to.data(), nq}, {qd_to.data(), n},
              {tau.data(), n});
    q_to.insert(q_to.end(), qd_to.begin(), qd_to.end());
    return q_to;
  }
  Model<double> model;
  int n, nq;
  std::vector<double> q, qd, tau;
};

bool sameBits(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return std::memcmp(&x, &y, sizeof x) == 0; });
}

bool isPlanned(const scene::Scene& scene) {
  return !scene.mechanism.hasCoupledRates();
}

}  // namespace

BOOST_AUTO_TEST_CASE(steps_are_those_of_the_textbook_sweeps_in_long_double) {
  std::size_t asked = 0, refused = 0;
  double worst[2] = {0, 0};
  for (const std::string& file : sceneFiles()) {
    const scene::Scene scene = scene::readScene(file);
    if (!isPlanned(scene)) {
      ++refused;
      continue;
    }
    Start start(scene, 5);
    std::fill(start.tau.begin(), start.tau.end(), 0.0);  // TreeMotion knows no joint forces
    crosscheck::TreeMotion<long double> motion(scene.mechanism);
    for (const Integrator integrator : kIntegrators) {
      const bool is_euler = integrator == Integrator::kSemiImplicitEuler;
      const auto moved = start.moved(widestVectors(), integrator, 1);
      for (std::size_t s = 0; s < start.count(); ++s) {
        std::vector<long double> y;
        const auto q = start.q.begin() + static_cast<std::ptrdiff_t>(s) * start.nq,
                   qd = start.qd.begin() + static_cast<std::ptrdiff_t>(s) * start.n;
        y.insert(y.end(), q, q + start.nq);
        y.insert(y.end(), qd, qd + start.n);
        y.push_back(0);
        const auto steps = crosscheck::stepsOf<long double>(
            is_euler ? "semi_implicit_euler" : "runge_kutta4", motion);
        std::vector<long double> rate(y.size());
        motion.rate(y, 0, &rate);
        steps->step(&y, 0, kStep);
        for (int k = 0; k < start.nq + start.n; ++k) {
          const std::size_t at =
              k < start.nq ? s * start.nq + k : start.q.size() + s * start.n + (k - start.nq);
          // what a rounding of y, and one of the sizes that its rate is a sum of, may do
          const double size = 1 + std::abs(static_cast<double>(y[k])) +
                              std::abs(kStep * static_cast<double>(rate[k]));
          const double error = std::abs(moved[at] - static_cast<double>(y[k])) / size;
          worst[is_euler ? 0 : 1] = std::max(worst[is_euler ? 0 : 1], error);
        }
      }
    }
    ++asked;
  }
  BOOST_TEST(asked + refused == sceneFiles().size());
  // measured on x86-64, over all scenes: 2.1e-14 and 8.8e-15, of which M^-1 makes the most; sines
  // of other libraries may double it
  BOOST_TEST(worst[0] <= 1e-13);
  BOOST_TEST(worst[1] <= 1e-13);
}

// TreeMotion knows no joint forces: here they are drawn, and expected is one rate after the other
BOOST_AUTO_TEST_CASE(joint_forces_are_in_each_step) {
  const Start start(scene::findScene("franka_panda"), 5);
  const std::vector<double> moved = start.moved(widestVectors(), Integrator::kSemiImplicitEuler, 1);
  std::vector<double> qdd(start.qd.size());
  ManyStates(start.model)
      .forwardDynamics(start.count(), {start.q.data(), start.nq}, {start.qd.data(), start.n},
                       {start.tau.data(), start.n}, {qdd.data(), start.n});
  for (std::size_t k = 0; k < qdd.size(); ++k) {
    const double expected = start.qd[k] + kStep * qdd[k];
    // two roundings, or one where they are fused
    BOOST_TEST(std::abs(moved[start.q.size() + k] - expected) <=
               0x1p-52 * (std::abs(start.qd[k]) + std::abs(kStep * qdd[k])));
  }
}

BOOST_AUTO_TEST_CASE(every_width_and_every_place_gives_the_same_bits) {
  for (const std::string& file : sceneFiles()) {
    const scene::Scene scene = scene::readScene(file);
    if (!isPlanned(scene)) continue;
    BOOST_TEST_CONTEXT(file) {
      const Start all(scene);
      for (const Integrator integrator : kIntegrators) {
        const std::vector<double> expected = all.moved(2, integrator, 3);
        for (const int width : widths())
          BOOST_TEST(sameBits(all.moved(width, integrator, 3), expected));
        // alone, and one step after the other
        const int n = all.n, nq = all.nq;
        const std::size_t last = all.count() - 1;
        std::vector<double> q(all.q.end() - nq, all.q.end()), qd(all.qd.end() - n, all.qd.end());
        ManySteps one(all.model);
        for (int step = 0; step < 3; ++step)
          one.step(1, integrator, kStep, 1, {q.data(), 0}, {qd.data(), 0},
                   {all.tau.data() + last * static_cast<std::size_t>(n), 0});
        BOOST_TEST(std::equal(q.begin(), q.end(), expected.begin() + all.q.size() - nq));
        BOOST_TEST(std::equal(qd.begin(), qd.end(), expected.end() - n));
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(quaternions_keep_their_length_by_semi_implicit_steps) {
  const Start start(scene::findScene("satellite_arm"), 8);
  int turn = -1;  // where the first quaternion begins
  for (const auto& link : start.model.links)
    if (turn < 0 && recursive::axisCount(link.kind) >= 3)
      turn = link.slot + (link.kind == recursive::JointKind::kFloating ? 3 : 0);
  BOOST_REQUIRE(turn >= 0);
  const auto moved = start.moved(widestVectors(), Integrator::kSemiImplicitEuler, 1000);
  for (std::size_t s = 0; s < start.count(); ++s) {
    const auto length = [&](const std::vector<double>& q) {
      const double* const at = q.data() + s * static_cast<std::size_t>(start.nq) + turn;
      return std::sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2] + at[3] * at[3]);
    };
    // a dozen roundings a step
    BOOST_TEST(std::abs(length(moved) / length(start.q) - 1) < 12 * 1000 * 0x1p-53);
  }
}

BOOST_AUTO_TEST_CASE(threads_change_no_bit) {
  for (const char* name : {"franka_panda", "satellite_arm"}) {
    for (const int count : {0, 1, 8, 16, 41}) {
      const Start start(scene::findScene(name), count);
      const int n = start.n, nn = n * n;
      const std::size_t states = static_cast<std::size_t>(count);
      const Strided<const double> q{start.q.data(), start.nq}, qd{start.qd.data(), n},
          tau{start.tau.data(), n};
      const auto room = [&](int numbers) { return std::vector<double>(states * numbers, -1); };
      std::vector<double> expected_qdd = room(n), expected_M = room(nn), expected_by_q = room(nn),
                          expected_by_qd = room(nn), expected_by_tau = room(nn);
      ManyStates(start.model).forwardDynamics(states, q, qd, tau, {expected_qdd.data(), n});
      ManyStates(start.model).massMatrix(states, q, {expected_M.data(), nn});
      ManyDerivatives(start.model)
          .forwardDynamics(states, q, qd, tau, {expected_by_q.data(), nn},
                           {expected_by_qd.data(), nn}, {expected_by_tau.data(), nn});
      for (const int threads : {1, 2, 3, 7}) {
        BOOST_TEST_CONTEXT(name << ", states " << count << ", threads " << threads) {
          std::vector<double> qdd = room(n), M = room(nn), by_q = room(nn), by_qd = room(nn),
                              by_tau = room(nn);
          AllCores<ManyStates> many(start.model, threads);
          BOOST_TEST(many.threads() == threads);
          many.ask(&ManyStates::forwardDynamics, states, q, qd, tau, {qdd.data(), n});
          many.ask(&ManyStates::massMatrix, states, q, {M.data(), nn});
          AllCores<ManyDerivatives>(start.model, threads)
              .ask(&ManyDerivatives::forwardDynamics, states, q, qd, tau, {by_q.data(), nn},
                   {by_qd.data(), nn}, {by_tau.data(), nn});
          BOOST_TEST(sameBits(qdd, expected_qdd));
          BOOST_TEST(sameBits(M, expected_M));
          BOOST_TEST(sameBits(by_q, expected_by_q));
          BOOST_TEST(sameBits(by_qd, expected_by_qd));
          BOOST_TEST(sameBits(by_tau, expected_by_tau));
          std::vector<double> q_to = start.q, qd_to = start.qd;
          AllCores<ManySteps>(start.model, threads)
              .ask(&ManySteps::step, states, Integrator::kRungeKutta4, kStep, 2,
                   {q_to.data(), start.nq}, {qd_to.data(), n}, tau);
          q_to.insert(q_to.end(), qd_to.begin(), qd_to.end());
          BOOST_TEST(sameBits(q_to, start.moved(widestVectors(), Integrator::kRungeKutta4, 2)));
        }
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(nothing_allocates) {
  Start start(scene::findScene("satellite_arm"));
  const int n = start.n, nn = n * n;
  const std::size_t states = start.count();
  std::vector<double> one(states * nn), two(one), three(one);
  const Strided<const double> q{start.q.data(), start.nq}, qd{start.qd.data(), n},
      tau{start.tau.data(), n};
  for (const int width : widths()) {
    ManyStates many(start.model, width);
    ManyDerivatives derivatives(start.model, width);
    ManySteps steps(start.model, width);
    const int size = static_cast<int>(many.packedEntries().size());
    many.massMatrix(states, q, {one.data(), nn});  // both take their room the first time
    many.packedMassMatrix(states, q, {one.data(), size});
    const long before = allocations;
    many.inverseDynamics(states, q, qd, tau, {one.data(), n});
    many.massMatrix(states, q, {one.data(), nn});
    many.packedMassMatrix(states, q, {one.data(), size});
    many.forwardDynamics(states, q, qd, tau, {one.data(), n});
    derivatives.inverseDynamics(states, q, qd, tau, {one.data(), nn}, {two.data(), nn},
                                {three.data(), nn});
    derivatives.forwardDynamics(states, q, qd, tau, {one.data(), nn}, {two.data(), nn},
                                {three.data(), nn});
    for (const Integrator integrator : kIntegrators)
      steps.step(states, integrator, kStep, 2, {start.q.data(), start.nq}, {start.qd.data(), n},
                 tau);
    BOOST_TEST(allocations == before);
  }
}
