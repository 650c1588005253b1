// SPDX-License-Identifier: GPL-3.0-or-later
// Estimates of what rounding did: never less than it did, and not so large that right answers are
// suspected. Expected errors are those against the same sweeps in long double, which has 11 bits
// more.
#include "recursive/rounding_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <boost/test/unit_test.hpp>

#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/fast/warned_dynamics.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/rounding_filter.hpp"
#include "scene/scene.hpp"

using namespace dynwitness;
using namespace dynwitness::recursive;

namespace {

/// A mechanism in one arithmetic, at a state.
template <typename T>
struct Arm {
  explicit Arm(const scene::Mechanism& mechanism)
      : model(buildModel(mechanism, scene::RealNumbers<T>(mechanism))),
        ws(model),
        M(model.dof(), model.dof()) {}

  template <typename Draw>
  void place(const Draw& draw) {
    const auto rates = [&](std::vector<T>* v) {
      v->clear();
      for (int i = 0; i < model.dof(); ++i) v->push_back(T(draw()));
    };
    x.clear();
    for (int i = 0; i < model.positions; ++i) x.push_back(scene::jointPosition(T(draw())));
    rates(&qd), rates(&qdd), rates(&tau);
  }
  std::vector<T> inverse() {
    std::vector<T> out(model.dof());
    inverseDynamics(model, x, qd, qdd, ws, out);
    return out;
  }
  std::vector<T> forward() {
    std::vector<T> out(model.dof());
    forwardDynamics(model, x, qd, tau, ws, out);
    return out;
  }
  /// By M = L D L', which is left in M.
  std::vector<T> solved() {
    const std::vector<T> rest(model.dof(), T(0));
    std::vector<T> out(model.dof());
    inverseDynamics(model, x, qd, rest, ws, out);
    for (int i = 0; i < model.dof(); ++i) out[i] = tau[i] - out[i];
    recursive::massMatrix(model, x, ws, M);
    factorize(M);
    solve(M, out);
    return out;
  }

  Model<T> model;
  Workspace<T> ws;
  MatrixX<T> M;
  std::vector<scene::JointPosition<T>> x;
  std::vector<T> qd, qdd, tau;
};

template <typename T>
double errorOf(const std::vector<T>& answer, const std::vector<long double>& right) {
  long double worst = 0, largest = 0;
  for (std::size_t i = 0; i < answer.size(); ++i) {
    worst = std::max(worst, std::abs(answer[i] - right[i]));
    largest = std::max(largest, std::abs(right[i]));
  }
  return static_cast<double>(worst / largest);
}

/// A compact body at the end of a straight arm (crosscheck/stability, heavy_tip).
scene::Mechanism heavyTip(const std::string& mass) {
  const std::string link = R"(
[[link]]
name = "%"
parent = "^"
mass = &
com = [0.5, 0, 0]
inertia = { about = "com", xx = 0.1, yy = 0.1, zz = 0.1 }
[link.joint]
name = "j%"
kind = "revolute"
axis = [0, 0, 1]
)";
  const auto of = [&](const std::string& name, const std::string& parent, const std::string& m) {
    std::string text = link;
    for (const auto& [mark, word] : {std::pair{'%', name}, {'^', parent}, {'&', m}})
      for (std::size_t at; (at = text.find(mark)) != std::string::npos;) text.replace(at, 1, word);
    return text;
  };
  return scene::readSceneToml(
             "title = \"t\"\nsource = \"chosen here\"\n[[link]]\nname = \"base\"\n" +
                 of("arm", "base", "1") + of("tip", "arm", mass) + "xyz = [1, 0, 0]\n",
             "heavy_tip.toml")
      .mechanism;
}

template <typename T>
struct Lost {
  double by_sweep, by_matrix;
};
template <typename T>
Lost<T> lostOf(const std::string& mass) {
  Arm<T> arm(heavyTip(mass));
  int draws = 0;
  arm.place([&] { return draws++ == 0 ? 0.3 : draws == 8 ? 1.0 : 0.0; });  // q1, and tau1
  RoundingEstimate<T> estimate(arm.model);
  const std::vector<T> qdd = arm.forward();
  const double by_sweep = estimate.forwardDynamics(arm.model, arm.x, arm.qd, arm.tau, arm.ws, qdd);
  const std::vector<T> again = arm.solved();
  return {by_sweep, static_cast<double>(estimate.solved(arm.x, arm.qd, arm.tau, arm.M, again))};
}

}  // namespace

/* Of all bundled scenes at 5 states each, in double. Seen: an error is 0.67 of its estimate at the
   most (modern_robotics_3link), an estimate 6e-11 (qdd of humanoid_floating by M). */
BOOST_AUTO_TEST_CASE(estimates_are_above_errors_and_suspect_no_bundled_scene) {
  for (const auto& file : scene::bundledScenes()) {
    const scene::Mechanism mechanism = scene::readScene(file).mechanism;
    if (mechanism.dof() == 0 || mechanism.hasCoupledRates()) continue;
    Arm<double> arm(mechanism);
    Arm<long double> exact(mechanism);
    RoundingEstimate<double> estimate(arm.model);
    std::uniform_real_distribution<double> between(-2, 2);
    for (unsigned seed = 1; seed <= 5; ++seed) {
      BOOST_TEST_CONTEXT(file.stem() << ", seed " << seed) {
        std::mt19937 one(seed), other(seed);
        arm.place([&] { return between(one); });
        exact.place([&] { return between(other); });
        const auto holds = [](double error, double estimated) {
          BOOST_TEST(error <= estimated);
          BOOST_TEST(estimated < 1e-9);
        };
        const std::vector<double> tau = arm.inverse();
        holds(errorOf(tau, exact.inverse()), estimate.inverseDynamics(arm.x, arm.qd, arm.qdd, tau));
        const std::vector<double> qdd = arm.forward();
        holds(errorOf(qdd, exact.forward()),
              estimate.forwardDynamics(arm.model, arm.x, arm.qd, arm.tau, arm.ws, qdd));
        const std::vector<double> solved = arm.solved();
        holds(errorOf(solved, exact.solved()),
              estimate.solved(arm.x, arm.qd, arm.tau, arm.M, solved));
        recursive::massMatrix(arm.model, arm.x, arm.ws, arm.M);
        recursive::massMatrix(exact.model, exact.x, exact.ws, exact.M);
        const double largest = arm.M.cwiseAbs().maxCoeff();
        holds(static_cast<double>((arm.M.cast<long double>() - exact.M).cwiseAbs().maxCoeff() /
                                  largest),
              estimate.massMatrix(arm.x, arm.M));
      }
    }
  }
}

// The tip's mass drops out of the shoulder's acceleration, as a difference of numbers of its size.
BOOST_AUTO_TEST_CASE(digits_that_a_heavy_tip_takes_are_missed) {
  BOOST_TEST(lostOf<double>("1").by_sweep < 1e-12);
  BOOST_TEST(lostOf<double>("1").by_matrix < 1e-12);
  BOOST_TEST(lostOf<float>("1").by_sweep < 1e-3);
  BOOST_TEST(lostOf<float>("1e7").by_sweep > 1e-3);
  BOOST_TEST(lostOf<double>("1e7").by_sweep < 1e-3);
  for (const char* mass : {"1e14", "1e15", "1e16", "1e17"}) {
    BOOST_TEST(lostOf<double>(mass).by_sweep > 1e-3, mass);
    BOOST_TEST(lostOf<double>(mass).by_matrix > 1e-3, mass);
  }
}

// An angle that was rounded to float has lost what its turns took.
BOOST_AUTO_TEST_CASE(rounded_positions_count) {
  Arm<float> arm(heavyTip("1"));
  arm.place([] { return 0.5; });
  arm.x[0] = scene::jointPosition(1e6F);
  const std::vector<float> tau = arm.inverse();
  RoundingEstimate<float> as_told(arm.model), as_rounded(arm.model, true);
  BOOST_TEST(as_told.inverseDynamics(arm.x, arm.qd, arm.qdd, tau) < 1e-3);
  BOOST_TEST(as_rounded.inverseDynamics(arm.x, arm.qd, arm.qdd, tau) > 1e-3);
}

BOOST_AUTO_TEST_CASE(followers_are_refused_by_the_articulated_sweep_alone) {
  const scene::Mechanism gripper = scene::findScene("gripper").mechanism;
  BOOST_REQUIRE(gripper.hasMimics());
  Arm<double> arm(gripper);
  arm.place([] { return 0.3; });
  RoundingEstimate<double> estimate(arm.model);
  const std::vector<double> tau = arm.inverse();
  BOOST_TEST(estimate.inverseDynamics(arm.x, arm.qd, arm.qdd, tau) < 1e-9);
  const std::vector<double> qdd = arm.forward();
  BOOST_CHECK_THROW(estimate.forwardDynamics(arm.model, arm.x, arm.qd, arm.tau, arm.ws, qdd),
                    std::invalid_argument);
}

namespace {

/// Lets everything pass: what it says is the coarse bound.
template <typename T>
RoundingFilter<T> lettingPass(const Model<T>& model, bool rounded_positions = false) {
  return {model, std::numeric_limits<T>::infinity(), rounded_positions};
}
/// The bound is computed in other operations than what it bounds.
constexpr double kRoundings = 1 + 1e-12;

/// Asked at 5 states, with rates up to 20 rad/s as well. Where slides move joints apart the filter
/// has seen a nearer state before.
void requireNeverLess(Arm<double>* arm, bool has_own_rates) {
  RoundingEstimate<double> estimate(arm->model);
  RoundingFilter<double> filter = lettingPass(arm->model);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937 one(seed);
    std::uniform_real_distribution<double> between(-2, 2);
    arm->place([&] { return between(one) * (seed > 3 ? 10 : 1); });
    const auto holds = [seed](double coarse, double estimated) {
      BOOST_TEST(estimated <= coarse * kRoundings,
                 "seed " << seed << ": " << estimated << ", " << coarse);
    };
    const std::vector<double> tau = arm->inverse();
    holds(filter.inverseDynamics(arm->x.data(), arm->qd.data(), arm->qdd.data(), tau.data()),
          estimate.inverseDynamics(arm->x, arm->qd, arm->qdd, tau));
    const std::vector<double> solved = arm->solved();
    holds(filter.solved(arm->x, arm->qd, arm->tau, arm->M, solved),
          estimate.solved(arm->x, arm->qd, arm->tau, arm->M, solved));
    if (!has_own_rates) continue;
    const std::vector<double> qdd = arm->forward();
    holds(filter.forwardDynamics(arm->model, arm->x, arm->qd, arm->tau, arm->ws, qdd),
          estimate.forwardDynamics(arm->model, arm->x, arm->qd, arm->tau, arm->ws, qdd));
  }
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_filter_never_says_less_than_the_estimate) {
  for (const auto& file : scene::bundledScenes()) {
    const scene::Mechanism mechanism = scene::readScene(file).mechanism;
    if (mechanism.dof() == 0) continue;
    Arm<double> arm(mechanism);
    BOOST_TEST_CONTEXT(file.stem()) {
      requireNeverLess(&arm, !mechanism.hasCoupledRates());
    }
  }
}

// Where one thing alone is large: the tip, a load on it, friction.
BOOST_AUTO_TEST_CASE(a_filter_sees_each_of_what_is_added_up) {
  for (const char* mass : {"1e-6", "1e3", "1e7", "1e12"}) {
    Arm<double> plain(heavyTip(mass)), loaded(heavyTip(mass)), rubbed(heavyTip(mass));
    loaded.model.links[1].load.force = recursive::Vector3<double>(1e14, 0, 0);
    rubbed.model.links[0].viscous = 1e14;
    BOOST_TEST_CONTEXT(mass) {
      requireNeverLess(&plain, true);
      requireNeverLess(&loaded, true);
      requireNeverLess(&rubbed, true);
    }
  }
}

/* A spring at its rest length pulls by a difference of two long lengths, and nothing else is large:
   no force of the joint and no acceleration stands for it. Seen: errors of 2.27e-4, estimates and
   sums of 0.0070 (tau), 0.0029 (qdd by the sweep), 0.0070 (by M). */
BOOST_AUTO_TEST_CASE(a_spring_at_rest_loses_digits_that_nothing_else_tells_of) {
  scene::Mechanism mechanism = heavyTip("1");
  mechanism.links[1].joint.stiffness = scene::Number::parse("7");
  mechanism.links[1].joint.rest = scene::Number::parse("1000.1");
  Arm<double> arm(mechanism);
  Arm<long double> exact(mechanism);
  const auto place = [](auto* at) {
    int draws = 0;  // q1 and its acceleration, which inverse dynamics are asked about
    at->place([&] { return draws++ == 0 ? 1000.1 + 1e-10 : 0.0; });
  };
  place(&arm), place(&exact);
  RoundingEstimate<double> estimate(arm.model);
  RoundingFilter<double> filter = lettingPass(arm.model);
  const auto holds = [](double error, double estimated, double coarse) {
    BOOST_TEST_MESSAGE(error << ", " << estimated << ", " << coarse);
    BOOST_TEST(error > 1e-5);  // there is something to be seen
    BOOST_TEST(error <= estimated);
    BOOST_TEST(estimated <= coarse * kRoundings);
    BOOST_TEST(coarse < 1);
  };
  const std::vector<double> tau = arm.inverse();
  holds(errorOf(tau, exact.inverse()), estimate.inverseDynamics(arm.x, arm.qd, arm.qdd, tau),
        filter.inverseDynamics(arm.x.data(), arm.qd.data(), arm.qdd.data(), tau.data()));
  const std::vector<double> qdd = arm.forward();
  holds(errorOf(qdd, exact.forward()),
        estimate.forwardDynamics(arm.model, arm.x, arm.qd, arm.tau, arm.ws, qdd),
        filter.forwardDynamics(arm.model, arm.x, arm.qd, arm.tau, arm.ws, qdd));
  const std::vector<double> solved = arm.solved();
  holds(errorOf(solved, exact.solved()), estimate.solved(arm.x, arm.qd, arm.tau, arm.M, solved),
        filter.solved(arm.x, arm.qd, arm.tau, arm.M, solved));
}

/* Filters of both kinds of sweeps on all bundled scenes: nobody is warned. Seen: tau, qdd by sweeps
   and by M = L D L' pass at the sums in all of them. */
BOOST_AUTO_TEST_CASE(no_bundled_scene_is_suspected_by_sums) {
  for (const auto& file : scene::bundledScenes()) {
    const scene::Mechanism mechanism = scene::readScene(file).mechanism;
    if (mechanism.dof() == 0 || mechanism.hasCoupledRates()) continue;
    BOOST_TEST_CONTEXT(file.stem()) {
      Arm<double> arm(mechanism);
      std::mt19937 one(1);
      std::uniform_real_distribution<double> between(-2, 2);
      arm.place([&] { return between(one); });
      RoundingFilter<double> filter = lettingPass(arm.model);
      const std::vector<double> tau = arm.inverse();
      BOOST_TEST(filter.inverseDynamics(arm.x.data(), arm.qd.data(), arm.qdd.data(), tau.data()) <
                 1e-3);
      const std::vector<double> solved = arm.solved();
      BOOST_TEST(filter.solved(arm.x, arm.qd, arm.tau, arm.M, solved) < 1e-3);
      std::vector<double> q, out(arm.qd.size()), M(out.size() * out.size());
      for (const auto& x : arm.x) q.push_back(x.q);
      fast::WarnedDynamics fast(arm.model, std::numeric_limits<double>::infinity());
      BOOST_TEST(fast.inverseDynamics(q.data(), arm.qd.data(), arm.qdd.data(), out.data()) < 1e-3);
      BOOST_TEST(fast.massMatrix(q.data(), M.data()) < 1e-3);
      BOOST_TEST(fast.forwardDynamics(q.data(), arm.qd.data(), arm.tau.data(), out.data()) < 1e-3);
      const std::vector<double> qdd = arm.forward();
      const double by_recursive =
          filter.forwardDynamics(arm.model, arm.x, arm.qd, arm.tau, arm.ws, qdd);
      BOOST_TEST(by_recursive < 1e-3);
      // D and U are the same numbers on both roads, but for rounding
      BOOST_TEST(
          fast.forwardDynamics(q.data(), arm.qd.data(), arm.tau.data(), out.data()) == by_recursive,
          boost::test_tools::tolerance(1e-6));
    }
  }
}

BOOST_AUTO_TEST_CASE(fast_sweeps_miss_the_digits_that_a_heavy_tip_takes) {
  for (const auto& [mass, is_lost] : {std::pair{"1", false}, {"1e7", false}, {"1e15", true}}) {
    Arm<double> arm(heavyTip(mass));
    fast::WarnedDynamics fast(arm.model);
    const double q[] = {0.3, 0}, qd[] = {0, 0}, tau[] = {1, 0};
    double qdd[2];
    BOOST_TEST((fast.forwardDynamics(q, qd, tau, qdd) > 1e-3) == is_lost, mass);
  }
}
