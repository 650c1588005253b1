// SPDX-License-Identifier: GPL-3.0-or-later
// Reduced scenes whose accelerations stay near: a slide by hand, and no sampled state errs by more
// than is certified, accelerations being solved for by Eigen from M and the forces of a sweep.
#include "crosscheck/reduction/reduced_acceleration.hpp"

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/reduction/acceleration_error.hpp"
#include "crosscheck/reduction/boxes.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

const auto kNoStage = [](const std::string&) {};

/// qdd of q, qd, tau.
class Solved {
 public:
  explicit Solved(const scene::Mechanism& mechanism)
      : model_(recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism))),
        ws_(model_),
        M_(model_.dof(), model_.dof()) {}

  Eigen::VectorXd at(const std::vector<scene::JointPosition<double>>& x,
                     const std::vector<double>& qd, const Eigen::VectorXd& tau) {
    std::vector<double> h(qd.size());
    recursive::inverseDynamics(model_, x, qd, std::vector<double>(qd.size()), ws_, h);
    recursive::massMatrix(model_, x, ws_, M_);
    return Eigen::MatrixXd(M_).ldlt().solve(tau -
                                            Eigen::Map<Eigen::VectorXd>(h.data(), tau.size()));
  }

 private:
  recursive::Model<double> model_;
  recursive::Workspace<double> ws_;
  recursive::MatrixX<double> M_;
};

/// The largest |qdd_i - reduced qdd_i| of so many states, half of them at corners in qd and tau.
std::vector<double> sampledWorst(const scene::Scene& scene, const scene::Scene& reduced,
                                 const std::vector<scene::JointRanges>& ranges, int states) {
  Solved full(scene.mechanism), small(reduced.mechanism);
  std::mt19937_64 random(36);
  std::uniform_real_distribution<double> share(0, 1);
  const auto draw = [&](const scene::Range& r, bool at_end) {
    const double s = share(random);
    return r.low + (at_end ? std::round(s) : s) * (r.high - r.low);
  };
  std::vector<double> worst(ranges.size());
  for (int s = 0; s < states; ++s) {
    std::vector<scene::JointPosition<double>> x;
    std::vector<double> qd;
    Eigen::VectorXd tau(static_cast<Eigen::Index>(ranges.size()));
    for (std::size_t k = 0; k < ranges.size(); ++k) {
      x.push_back(scene::jointPosition(draw(ranges[k].q, false)));
      qd.push_back(draw(ranges[k].qd, s % 2 == 0));
      tau(static_cast<Eigen::Index>(k)) = draw(*ranges[k].tau, s % 2 == 0);
    }
    const Eigen::VectorXd off = full.at(x, qd, tau) - small.at(x, qd, tau);
    for (std::size_t k = 0; k < worst.size(); ++k)
      worst[k] = std::max(worst[k], std::abs(off(static_cast<Eigen::Index>(k))));
  }
  return worst;
}

scene::Scene slide(const char* rotor) {
  return scene::readSceneToml(
      std::string("gravity = [0, 0, -9.81]\n[[link]]\nname = \"base\"\n[[link]]\nname = \"block\"\n"
                  "parent = \"base\"\nmass = 2\n[link.joint]\nname = \"rail\"\n"
                  "kind = \"prismatic\"\nstiffness = 7\nfriction = { viscous = 3 }\n"
                  "rotor_inertia = ") +
          rotor + "\n",
      "slide.toml");
}

}  // namespace

// By hand: M = 2.5 with the rotor and 2 without; weight, spring and friction are those of both, so
// that e = (1/2 - 1/2.5) (tau - 2 g - 7 q - 3 qd) = -0.1 (5 + 19.62 + 7 + 6) at the worst corner.
BOOST_AUTO_TEST_CASE(a_slide_without_its_rotor_by_hand) {
  const TrigonometricModel full = trigonometricModel(slide("0.5")),
                           reduced = trigonometricModel(slide("0"));
  const std::vector<scene::JointRanges> ranges = {{{-1, 1}, {-3, 2}, {0, 0}, scene::Range{-5, 4}}};
  AccelerationErrors errors(full, reduced, ranges, {15.05});
  const EnvelopeBound bound = errors.of(0, {4}, {}, -1);
  BOOST_TEST(bound.certified >= 3.762);
  BOOST_TEST(bound.certified <= 3.762 * (1 + 64 * kLost));  // 27 kLost measured
  BOOST_TEST(bound.worst.q.at(0) == 1);
  BOOST_TEST(bound.worst.qd.at(0) == 2);
  BOOST_TEST(bound.worst.tau.at(0) == -5);
}

BOOST_DATA_TEST_CASE(no_sampled_acceleration_errs_by_more_than_is_certified,
                     data::make(std::vector<std::string>{"planar_3r", "scara", "puma_560"}), name) {
  const scene::Scene scene = scene::findScene(name);
  const std::vector<scene::JointRanges> ranges = scene::readEnvelope(scene);
  ReduceOptions options;
  options.of = ReducedQuantity::kQdd;
  options.allowed = {0.05, 0.5};
  const Reduction reduction = reduced(scene, ranges, options, kNoStage);
  BOOST_TEST_MESSAGE(reductionText(scene, reduction));
  BOOST_TEST(reduction.models.size() == 2U);
  const int states = std::getenv("DYNWITNESS_LONG") ? 1000000 : 20000;
  for (const ReducedModel& model : reduction.models) {
    BOOST_TEST(model.share() <= model.allowed);
    const std::vector<double> worst = sampledWorst(scene, model.scene, ranges, states);
    for (std::size_t i = 0; i < worst.size(); ++i) {
      const ReducedForce& force = model.forces[i];
      BOOST_TEST(worst[i] <= force.at_most, "qdd_" << i + 1);
      BOOST_TEST(force.at_least <= force.at_most);
      // at most 1.2 in scara, 2.3 in puma_560, measured
      if (force.at_least > 0)
        BOOST_TEST(force.at_most <= (name == "puma_560" ? 3 : 1.2) * force.at_least,
                   "qdd_" << i + 1 << ": " << force.at_most << ", seen " << force.at_least);
    }
    if (!model.parameters.empty())
      BOOST_TEST(model.operations() < reduction.full.bodyOperations().all());
  }
  // 112 operations are left of puma_560's 476 with 5 %, 42 of scara's 84 with 50 %, measured; of
  // planar_3r samples miss every parameter by more than 18 %, and two together by more than 54 %
  if (name == "puma_560") BOOST_TEST(reduction.models.front().operations() <= 112);
  if (name == "scara") BOOST_TEST(reduction.models.back().operations() <= 42);
}

// What is asked for is put into the bounds: that must not make anything true.
BOOST_AUTO_TEST_CASE(less_than_is_seen_is_not_granted_for_being_asked) {
  const scene::Scene whole = scene::findScene("planar_3r");
  scene::Scene without = whole;
  without.mechanism.links[1].inertia.zz = 0;
  without.mechanism.links[1].inertia.yy = 0;
  const TrigonometricModel full = trigonometricModel(whole), reduced = trigonometricModel(without);
  const std::vector<scene::JointRanges> ranges = scene::readEnvelope(whole);
  const std::vector<double> seen = sampledWorst(whole, without, ranges, 20000);
  AccelerationErrors errors(full, reduced, ranges, {513, 1874, 3220});  // as envelope bounds them
  for (const double share : {0.9, 0.1, 0.001}) {
    std::vector<double> asked;
    for (const double s : seen) asked.push_back(share * s);
    bool is_granted = true;
    for (int i = 0; i < 3; ++i) {
      const double limit = asked[static_cast<std::size_t>(i)];
      is_granted = is_granted && errors.of(i, asked, {}, limit).certified <= limit;
    }
    BOOST_TEST(!is_granted, share);
  }
  // between the corners of a wide box the bracket of e is not 0: what is asked of all joints counts
  EnvelopeOptions one_box;
  one_box.boxes = 1;
  const auto bound = [&](int i, double e) {
    return errors.of(i, std::vector<double>(3, e), one_box, -1).certified;
  };
  for (int i = 0; i < 3; ++i) BOOST_TEST(bound(i, 1e6) > 2 * bound(i, 1));
}

// Nothing turns with scara's last joint but its flange.
BOOST_AUTO_TEST_CASE(a_model_whose_mass_matrix_has_no_inverse_has_no_bound) {
  const scene::Scene whole = scene::findScene("scara");
  scene::Scene without = whole;
  without.mechanism.links.back().inertia = {};
  without.mechanism.links.back().joint.rotor_inertia = 0;
  const std::vector<scene::JointRanges> ranges = scene::readEnvelope(whole);
  const TrigonometricModel full = trigonometricModel(whole), reduced = trigonometricModel(without);
  AccelerationErrors errors(full, reduced, ranges, std::vector<double>(4, 4000));
  EnvelopeOptions options;
  options.boxes = 50;
  for (int i = 0; i < 4; ++i)
    BOOST_TEST(std::isinf(errors.of(i, std::vector<double>(4, 1000), options, -1).certified));
}

BOOST_AUTO_TEST_CASE(accelerations_that_nobody_can_bound_are_refused) {
  const scene::Scene arm = scene::findScene("planar_3r");
  ReduceOptions options;
  options.of = ReducedQuantity::kQdd;
  const auto refused = [&](std::vector<scene::JointRanges> ranges, const std::string& reason) {
    BOOST_CHECK_EXCEPTION(reduced(arm, ranges, options, kNoStage), scene::InputError,
                          [&](const scene::InputError& error) {
                            BOOST_TEST_MESSAGE(error.what());
                            return std::string(error.what()).find(reason) != std::string::npos;
                          });
  };
  std::vector<scene::JointRanges> ranges = scene::readEnvelope(arm);
  ranges[1].tau.reset();
  refused(ranges, "no tau of joint 'joint_2'");
  options.armstrong = 0.01;
  refused(scene::readEnvelope(arm), "his rule is about terms of tau");
  options.armstrong = 0;
  options.allowed = {1e-16};
  refused(scene::readEnvelope(arm), "roundings alone");
}
