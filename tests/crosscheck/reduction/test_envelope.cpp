// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds over an envelope: no sampled state exceeds them (the sweeps of recursive/ in double, which
// know nothing of polynomials), the closed form of a pendulum,
// refusals.
#include "crosscheck/reduction/envelope.hpp"

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/reduction/acceleration.hpp"
#include "crosscheck/reduction/boxes.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

const auto kNoStage = [](const std::string&) {};

std::vector<EnvelopeBound> boundsOf(const scene::Scene& scene,
                                    const EnvelopeOptions& options = {}) {
  return envelopeBounds(scene, scene::readEnvelope(scene), options, kNoStage);
}

/// The largest |tau_i| of so many states: half of them drawn from the envelope, half from its
/// corners in qd and qdd, where forces are largest.
std::vector<double> sampledWorst(const scene::Scene& scene, int states) {
  const std::vector<scene::JointRanges> ranges = scene::readEnvelope(scene);
  const auto model =
      recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
  recursive::Workspace<double> ws(model);
  std::mt19937_64 random(16);
  std::uniform_real_distribution<double> share(0, 1);
  const auto draw = [&](const scene::Range& r, bool at_end) {
    const double s = share(random);
    return r.low + (at_end ? std::round(s) : s) * (r.high - r.low);
  };
  const std::size_t n = ranges.size();
  std::vector<scene::JointPosition<double>> x(n);
  std::vector<double> qd(n), qdd(n), tau(n), worst(n);
  for (int s = 0; s < states; ++s) {
    for (std::size_t k = 0; k < n; ++k) {
      x[k] = scene::jointPosition(draw(ranges[k].q, false));
      qd[k] = draw(ranges[k].qd, s % 2 == 0);
      qdd[k] = draw(ranges[k].qdd, s % 2 == 0);
    }
    recursive::inverseDynamics(model, x, qd, qdd, ws, tau);
    for (std::size_t k = 0; k < n; ++k) worst[k] = std::max(worst[k], std::abs(tau[k]));
  }
  return worst;
}

template <typename Call>
void refused(Call call, const std::string& reason) {
  BOOST_CHECK_EXCEPTION(call(), scene::InputError, [&](const scene::InputError& error) {
    BOOST_TEST_MESSAGE(error.what());
    return std::string(error.what()).find(reason) != std::string::npos;
  });
}

scene::Scene pendulum(const std::string& envelope) {
  return scene::readSceneToml(
      "gravity = [0, 0, -9.81]\n[[link]]\nname = \"base\"\n"
      "[[link]]\nname = \"rod\"\nparent = \"base\"\nmass = 2\ncom = [0, 0, -0.5]\n"
      "[link.joint]\nname = \"hinge\"\nkind = \"revolute\"\naxis = [0, 1, 0]\n"
      "friction = { viscous = 0.3, coulomb = 0.7 }\nstiffness = 4\nrest = 0.1\n" +
          envelope,
      "pendulum.toml");
}

}  // namespace

BOOST_DATA_TEST_CASE(no_sampled_state_exceeds_a_bound,
                     data::make(std::vector<std::string>{"planar_3r", "scara", "puma_560",
                                                         "kuka_iiwa_14", "franka_panda"}),
                     name) {
  const scene::Scene scene = scene::findScene(name);
  EnvelopeOptions options;
  options.boxes = 2000;  // any number of boxes has to give a bound
  const std::vector<EnvelopeBound> bounds = boundsOf(scene, options);
  const bool is_long = std::getenv("DYNWITNESS_LONG") != nullptr;
  const std::vector<double> worst = sampledWorst(scene, is_long ? 1000000 : 100000);
  BOOST_TEST(bounds.size() == worst.size());
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    BOOST_TEST(worst[i] <= bounds[i].certified, bounds[i].quantity.name());
    BOOST_TEST(bounds[i].sampled <= bounds[i].certified);
    // What is said to have been seen is, by a sweep at the state beside it ...
    if (bounds[i].worst.q.empty()) continue;
    const RunningError seen = sweptQuantity(scene, bounds[i].quantity, bounds[i].worst);
    BOOST_TEST(bounds[i].sampled <= std::abs(seen.value()) + seen.bound(),
               bounds[i].quantity.name() << " " << seen.value());
    // ... and samples come near it: of 20 seeds the worst with 100000 states came to 0.998 of it on
    // planar_3r, 1.000 on scara, 0.986 on puma_560 and 0.920 on kuka_iiwa_14. On franka_panda they
    // do not since what was seen is climbed on from.
    if (name != "franka_panda")
      BOOST_TEST(worst[i] > 0.8 * bounds[i].sampled, bounds[i].quantity.name() << " " << worst[i]);
  }
}

// M, c, g and T too: at the states of the other quantities' worst
BOOST_AUTO_TEST_CASE(every_quantity_is_bounded_at_every_worst_state) {
  const scene::Scene scene = scene::findScene("scara");
  EnvelopeOptions options;
  options.quantities = {"tau", "M", "c", "g", "T", "V", "energy", "reactions"};
  const std::vector<EnvelopeBound> bounds = boundsOf(scene, options);
  BOOST_TEST(bounds.size() == 4u + 10 + 4 + 4 + 1 + 1 + 1 + 24);
  for (const EnvelopeBound& a : bounds)
    for (const EnvelopeBound& b : bounds) {
      if (b.worst.q.empty()) continue;
      const RunningError x = sweptQuantity(scene, a.quantity, b.worst);
      BOOST_TEST(std::abs(x.value()) <= a.certified + x.bound());
    }
}

BOOST_DATA_TEST_CASE(the_ratio_that_is_asked_for_is_reached,
                     data::make(std::vector<std::string>{"planar_3r", "scara", "puma_560"}), name) {
  for (const EnvelopeBound& bound : boundsOf(scene::findScene(name))) {
    BOOST_TEST(bound.is_reached);
    BOOST_TEST(bound.ratio() <= 1.2);
  }
}

// At seeded states of the envelope and corners: qdd from M and the forces of a sweep at qdd = 0,
// solved by Eigen; energies and reactions by sweeps in double.
BOOST_DATA_TEST_CASE(no_sampled_state_exceeds_accelerations_energies_or_reactions,
                     data::make(std::vector<std::string>{"planar_3r", "scara", "puma_560"}), name) {
  const scene::Scene scene = scene::findScene(name);
  const std::vector<scene::JointRanges> ranges = scene::readEnvelope(scene);
  EnvelopeOptions options;
  options.boxes = 1000;  // any number of boxes has to give a bound
  options.quantities = {"qdd", "V", "energy", "reactions"};
  const std::vector<EnvelopeBound> bounds = boundsOf(scene, options);
  const auto model =
      recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
  recursive::Workspace<double> ws(model);
  const std::size_t n = ranges.size();
  std::mt19937_64 random(16);
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<double> worst(bounds.size());
  std::vector<double> reactions(6 * (model.joints.size() - 1));
  for (int s = 0; s < 20000; ++s) {
    const auto draw = [&](const scene::Range& r) {
      const double x = share(random);
      return r.low + (s % 2 == 0 ? std::round(x) : x) * (r.high - r.low);
    };
    std::vector<scene::JointPosition<double>> x(n);
    std::vector<double> qd(n), qdd(n), tau(n), h(n), zero(n);
    Eigen::VectorXd drive(static_cast<Eigen::Index>(n));
    for (std::size_t k = 0; k < n; ++k) {
      const double at = share(random);
      x[k] = scene::jointPosition(ranges[k].q.low + at * (ranges[k].q.high - ranges[k].q.low));
      qd[k] = draw(ranges[k].qd);
      qdd[k] = draw(ranges[k].qdd);
      drive(static_cast<Eigen::Index>(k)) = draw(*ranges[k].tau);
    }
    recursive::inverseDynamics(model, x, qd, zero, ws, h);
    recursive::MatrixX<double> M(model.dof(), model.dof());
    recursive::massMatrix(model, x, ws, M);
    const Eigen::VectorXd solved = Eigen::MatrixXd(M).ldlt().solve(
        drive - Eigen::Map<Eigen::VectorXd>(h.data(), drive.size()));
    const double V = recursive::potentialEnergy(model, x, ws);
    const double T = recursive::kineticEnergy(model, x, qd, ws);
    recursive::inverseDynamics(model, x, qd, qdd, ws, tau);
    recursive::jointReactions(model, ws, reactions);
    for (std::size_t b = 0; b < bounds.size(); ++b) {
      const EnvelopeQuantity& of = bounds[b].quantity;
      const auto i = static_cast<std::size_t>(of.i);
      const double value = of.kind == EnvelopeQuantity::Kind::kQdd ? solved(of.i)
                           : of.kind == EnvelopeQuantity::Kind::kV ? V
                           : of.kind == EnvelopeQuantity::Kind::kEnergy
                               ? T + V
                               : reactions[6 * i + static_cast<std::size_t>(of.j)];
      worst[b] = std::max(worst[b], std::abs(value));
    }
  }
  for (std::size_t b = 0; b < bounds.size(); ++b) {
    BOOST_TEST(std::isfinite(bounds[b].certified), bounds[b].quantity.name());
    BOOST_TEST(worst[b] <= bounds[b].certified * (1 + 1e-12) + 1e-12, bounds[b].quantity.name());
    BOOST_TEST(bounds[b].sampled <= bounds[b].certified);
    // too much in a polynomial makes bounds that no state comes near: at most 1000 boxes do here
    if (name == "planar_3r") BOOST_TEST(bounds[b].is_reached, bounds[b].quantity.name());
  }
}

// 1.51 times what is seen at most, measured; norms alone leave 1.65 to 3.2 times.
BOOST_AUTO_TEST_CASE(accelerations_of_six_joints_are_bounded_near_what_is_seen) {
  EnvelopeOptions options;
  options.boxes = 2000;
  options.quantities = {"qdd"};
  for (const EnvelopeBound& bound : boundsOf(scene::findScene("puma_560"), options)) {
    BOOST_TEST(bound.sampled <= bound.certified);
    BOOST_TEST(bound.ratio() <= 1.52, bound.quantity.name());
  }
}

// By forward dynamics with articulated bodies in RunningError, which solves no M. Whichever of the
// two searches saw the state, and however few boxes there were.
BOOST_AUTO_TEST_CASE(the_acceleration_that_was_seen_is_that_of_the_state_beside_it) {
  for (const char* name : {"planar_3r", "puma_560"}) {
    const scene::Scene scene = scene::findScene(name);
    const std::vector<scene::JointRanges> ranges = scene::readEnvelope(scene);
    const TrigonometricModel model = trigonometricModel(scene);
    for (const int boxes : {1, 300, 600}) {  // 300 belong to the first search
      AccelerationBounds bounds(model, ranges);
      EnvelopeOptions options;
      options.boxes = boxes;
      options.ratio = 1.05;
      for (int i = 0; i < model.dof; ++i) {
        const EnvelopeBound bound = bounds.over(i, ranges, options, -1);
        BOOST_TEST_REQUIRE(bound.worst.q.size() == ranges.size());
        const RunningError qdd = sweptQuantity(scene, bound.quantity, bound.worst);
        const double seen = std::abs(qdd.value());
        BOOST_TEST(bound.sampled <= seen + qdd.bound());
        BOOST_TEST(bound.sampled >= seen - qdd.bound() - 2 * bound.lost);
        BOOST_TEST(bound.quantity.i == i);
      }
    }
  }
}

// By hand: cos(x - 0.3) + cos(y + 0.2) is 2 at (0.3, -0.2), and falls by half the squares beside
// it; where that lies outside the ranges, the largest is at their end.
BOOST_AUTO_TEST_CASE(a_climb_ends_where_a_function_is_largest) {
  const auto f = [](const std::vector<double>& q) {
    return std::cos(q[0] - 0.3) + std::cos(q[1] + 0.2);
  };
  double best = 0;
  const auto seen = [&](const std::vector<double>& q) {
    best = std::max(best, f(q));
    return f(q);
  };
  for (const double high : {1.5, 0.1}) {
    Climb climb;
    best = 0;
    climb.saw(f({-1.5, -1.5}), {-1.5, -1.5});
    climb.saw(f({-1.5, -1.6}), {-1.5, -1.6});  // less: no place to begin
    climb.from({{-1.5, high}, {-1.5, 1.5}}, seen);
    const double most = 1 + (high > 0.3 ? 1 : std::cos(0.3 - high));
    BOOST_TEST(best <= most);
    BOOST_TEST(best >= most - std::pow(3.0 / 1024, 2));
    best = 0;
    climb.from({{-1.5, high}, {-1.5, 1.5}}, seen);  // nothing was seen since
    BOOST_TEST(best == 0);
  }
}

// By hand: I = 0.5; qdd = (tau - 0.3 qd - 0.7 sign(qd) - 9.81 sin q - 4 (q - 0.1)) / I is largest
// in magnitude where all resist; V = 9.81 (1 - cos q - 1) + 2 (q - 0.1)^2 with V = 0 at the
// hinge.
BOOST_AUTO_TEST_CASE(acceleration_and_energy_of_a_pendulum_by_hand) {
  const scene::Scene scene = pendulum("");
  const std::vector<scene::JointRanges> ranges = {
      {{0.2, 1.5}, {-1, 2}, {0, 0}, scene::Range{-6, 5}}};
  EnvelopeOptions options;
  options.ratio = 1.001;
  options.quantities = {"qdd", "V", "energy", "reactions"};
  const std::vector<EnvelopeBound> bounds = envelopeBounds(scene, ranges, options, kNoStage);
  const auto holds = [&](std::size_t at, double expected) {
    BOOST_TEST(bounds.at(at).certified >= expected * (1 - 1e-14), bounds[at].quantity.name());
    BOOST_TEST(bounds.at(at).certified <= expected * 1.001, bounds[at].quantity.name());
    BOOST_TEST(std::abs(bounds.at(at).sampled - expected) <= 1e-3 * expected);
  };
  holds(0, (6 + 0.3 * 2 + 0.7 + 9.81 * std::sin(1.5) + 4 * 1.4) / 0.5);
  const auto V = [](double q) { return -9.81 * std::cos(q) + 2 * std::pow(q - 0.1, 2); };
  holds(1, std::abs(V(0.2)));
  holds(2, std::abs(V(0.2)));
  // along the rod at q = 0.2: weight and centripetal force, both up
  holds(5, 2 * (9.81 * std::cos(0.2) + 0.5 * 4));
}

// By hand, a point of 2 kg at 0.5 m: I = 0.5, tau = I qdd + 0.3 qd + 0.7 sign(qd)
// + 9.81 sin q + 4 (q - 0.1), which is largest at the upper ends of q in [0, 1.5], qd and qdd.
BOOST_AUTO_TEST_CASE(a_pendulum_by_hand) {
  const scene::Scene scene = pendulum("");
  const std::vector<scene::JointRanges> ranges = {{{0, 1.5}, {-1, 2}, {-3, 4}}};
  EnvelopeOptions options;
  options.ratio = 1.0001;
  const EnvelopeBound tau = envelopeBounds(scene, ranges, options, kNoStage).at(0);
  const double expected = 0.5 * 4 + 0.3 * 2 + 0.7 + 9.81 * std::sin(1.5) + 4 * 1.4;
  BOOST_TEST(tau.certified >= expected * (1 - 1e-15));
  BOOST_TEST(tau.certified <= expected * 1.0001);
  BOOST_TEST(std::abs(tau.sampled - expected) <= 1e-14 * expected);
  BOOST_TEST(tau.worst.q.at(0) == 1.5);
}

BOOST_AUTO_TEST_CASE(what_has_no_bound_is_refused_with_a_reason) {
  const auto read = [](const std::string& envelope) { return pendulum("[envelope]\n" + envelope); };
  refused([&] { read("hinge = { q = [0, 1], qd = [0, 1] }\n"); }, "qdd");
  refused([&] { read("hinge = { q = [2, 1], qd = [0, 1], qdd = [0, 1] }\n"); }, "is empty");
  refused([&] { read("hinge = { q = [0, inf], qd = [0, 1], qdd = [0, 1] }\n"); }, "not finite");
  refused([&] { read("knee = { q = [0, 1], qd = [0, 1], qdd = [0, 1] }\n"); }, "knee");
  refused([&] { envelopeBounds(pendulum(""), std::vector<scene::JointRanges>(), {}, kNoStage); },
          "no [envelope]");
  EnvelopeOptions accelerations;
  accelerations.quantities = {"qdd"};
  refused(
      [&] {
        const std::vector<scene::JointRanges> ranges = {{{0, 1}, {0, 1}, {0, 1}}};
        envelopeBounds(pendulum(""), ranges, accelerations, kNoStage);
      },
      "no tau of joint 'hinge'");
  refused([&] { trigonometricModel(scene::findScene("heavy_top")); }, "spherical");
  refused([&] { trigonometricModel(scene::findScene("andrews_squeezer")); }, "closed mechanism");
  refused([&] { trigonometricModel(scene::findScene("humanoid")); }, "joints move");
}

// the largest over the corners in qd is looked for without visiting all of them: here they are
BOOST_AUTO_TEST_CASE(at_one_position_no_corner_of_the_rates_is_above_the_bound) {
  const scene::Scene scene = scene::findScene("puma_560");
  for (const double q : {0.3, -0.7, 1.9}) {
    std::vector<scene::JointRanges> ranges;
    for (int k = 0; k < 6; ++k) ranges.push_back({{q + k, q + k}, {-1.0 - k, 2}, {0, 0}});
    EnvelopeOptions options;
    options.boxes = 2000;
    const std::vector<EnvelopeBound> bounds = envelopeBounds(scene, ranges, options, kNoStage);
    for (int corner = 0; corner < 64; ++corner) {
      EnvelopeState state;
      for (std::size_t k = 0; k < 6; ++k) {
        state.q.push_back(ranges[k].q.low);
        state.qd.push_back((corner >> k & 1) != 0 ? ranges[k].qd.high : ranges[k].qd.low);
        state.qdd.push_back(0);
      }
      for (const EnvelopeBound& bound : bounds) {
        const RunningError tau = sweptQuantity(scene, bound.quantity, state);
        BOOST_TEST(std::abs(tau.value()) - tau.bound() <= bound.certified);
      }
    }
  }
}
