// SPDX-License-Identifier: GPL-3.0-or-later
// The fast sweeps are the textbook sweeps: the same functions over a prime field, whatever the
// joints, and the same to rounding in double. The other road is recursive/*.hpp.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/fast_sweeps.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "recursive/build_model.hpp"
#include "recursive/fast/dynamics.hpp"
#include "scene/families.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using recursive::fast::Step;

namespace {

/// One random point modulo a random prime: fast and textbook sweeps on the same model and state.
class Point {
 public:
  Point(const scene::Scene& scene, std::uint64_t index)
      : modulus_(drawPrime(scene.name, 11, index)),
        source_(scene.name, 11, index),
        numbers_(scene.mechanism, source_, Parameters::kAsWritten),
        state_(indeterminateState(scene.mechanism, source_)),
        textbook_(recursive::buildModel(scene.mechanism, numbers_)),
        fast(textbook_.model) {}

  bool isSame(Quantity quantity) {
    const MatrixX<PrimeField> left = fast(quantity, state_);
    switch (quantity) {
      case Quantity::kM:
        return left == CompositeBody::answer(textbook_, quantity, state_);
      case Quantity::kTau:
        return left == NewtonEuler::answer(textbook_, quantity, state_);
      default:
        return left == ArticulatedBody::answer(textbook_, quantity, state_);
    }
  }

 private:
  PrimeField::Modulus modulus_;
  FieldSource source_;
  FieldNumbers numbers_;
  scene::State<PrimeField> state_;
  Setup<PrimeField> textbook_;

 public:
  FastSweeps<PrimeField> fast;
};

constexpr Quantity kQuantities[] = {Quantity::kTau, Quantity::kM, Quantity::kQdd};

std::vector<scene::Scene> scenes() {
  std::vector<scene::Scene> all;
  for (const auto& file : scene::bundledScenes()) {
    all.push_back(scene::readScene(file));
    if (all.back().mechanism.hasCoupledRates())
      all.pop_back();  // a plan is refused: test_mimic.cpp
  }
  for (int index = 0; index < 40; ++index) all.push_back(randomTreeScene(3, index, 9));
  return all;
}

}  // namespace

BOOST_AUTO_TEST_CASE(they_are_the_same_functions_as_the_textbook_sweeps) {
  std::set<Step> steps, with_rotor, with_friction;
  int branches = 0, world_loads = 0;
  for (const scene::Scene& scene : scenes()) {
    for (const Quantity quantity : kQuantities) {
      Point point(scene, 0);
      for (const auto& link : point.fast.plan.links) {
        steps.insert(link.step);
        if (!link.spin.isZero()) with_rotor.insert(link.step);
        if (!link.positive.isZero()) with_friction.insert(link.step);
      }
      branches += point.fast.plan.branches;
      world_loads += static_cast<int>(point.fast.plan.world_loads.size());
      try {
        BOOST_TEST(point.isSame(quantity), scene.name << ": " << name(quantity));
      } catch (const DivisionByZero&) {
        BOOST_TEST((quantity == Quantity::kQdd));  // M is singular there
      }
    }
  }
  BOOST_TEST(steps.size() == 7u);       // every kind of step was taken
  BOOST_TEST(with_rotor.size() >= 6u);  // but for turns after a twist, which pass by the same code
  BOOST_TEST(with_friction.size() >= 6u);
  BOOST_TEST(branches > 0);
  BOOST_TEST(world_loads > 0);
}

// With so many links inverse dynamics asks for data ahead of time.
BOOST_DATA_TEST_CASE(they_are_so_beyond_the_caches, data::make({"chain_20001", "tree_20001"}),
                     name) {
  scene::Scene scene;
  BOOST_REQUIRE(scene::findFamily(name, &scene));
  Point point(scene, 0);
  BOOST_REQUIRE(point.fast.plan.links.size() >
                static_cast<std::size_t>(recursive::fast::detail::kManyLinks));
  BOOST_TEST(point.isSame(Quantity::kTau));
  auto& link = point.fast.plan.links[20000];
  link.mass += PrimeField(1);
  link.h.x += PrimeField(1);
  BOOST_TEST(!point.isSame(Quantity::kTau));
}

BOOST_AUTO_TEST_CASE(a_planted_error_is_seen) {
  const scene::Scene scene = scene::findScene("puma_560");
  for (const Quantity quantity : kQuantities) {
    Point turned(scene, 1), shifted(scene, 1), heavier(scene, 1);
    BOOST_TEST(turned.isSame(quantity));
    auto& link = turned.fast.plan.links[1];
    link.s = -link.s;  // the fixed turn the other way
    BOOST_TEST(!turned.isSame(quantity), name(quantity));
    shifted.fast.plan.links[2].is_apart = false;  // a lever forgotten
    BOOST_TEST(!shifted.isSame(quantity), name(quantity));
    heavier.fast.plan.links[5].rotor += PrimeField(1);
    BOOST_TEST(!heavier.isSame(quantity), name(quantity));
  }
}

// A rotor's momentum is felt by its joint and by its parent; friction holds back.
BOOST_AUTO_TEST_CASE(a_planted_error_of_rotor_or_friction_is_seen) {
  for (const Quantity quantity : kQuantities) {
    const scene::Scene wrist = scene::findScene("gyroscopic_wrist");
    Point lost(wrist, 2), backward(wrist, 2), unfelt(wrist, 2);
    auto& spinning = lost.fast.plan.links;
    const auto rotor = std::find_if(spinning.rbegin(), spinning.rend(),
                                    [](const auto& link) { return !link.spin.isZero(); });
    BOOST_REQUIRE((rotor != spinning.rend()));
    const auto k =
        spinning.rend() - rotor - 1;  // the outermost: what the first axes do not feel, these do
    BOOST_TEST(lost.isSame(quantity));
    lost.fast.plan.links[k].spin = PrimeField(0);
    BOOST_TEST(!lost.isSame(quantity), name(quantity));
    backward.fast.plan.links[k].spin = -backward.fast.plan.links[k].spin;
    BOOST_TEST(!backward.isSame(quantity), name(quantity));
    if (quantity == Quantity::kM) continue;  // knows no rates
    unfelt.fast.plan.has_specials = false;
    BOOST_TEST(!unfelt.isSame(quantity), name(quantity));
    const scene::Scene rubbing = scene::findScene("puma_560_friction");
    Point along(rubbing, 2), smooth(rubbing, 2);
    BOOST_TEST(along.isSame(quantity));
    along.fast.plan.links[3].viscous = -along.fast.plan.links[3].viscous;
    BOOST_TEST(!along.isSame(quantity), name(quantity));
    smooth.fast.plan.links[2].positive = PrimeField(0);
    BOOST_TEST(!smooth.isSame(quantity), name(quantity));
  }
}

// What the processor can do must not show in the results: AVX2 or not, the same bits.
BOOST_DATA_TEST_CASE(the_same_bits_with_and_without_avx2,
                     data::make({"franka_panda", "humanoid", "humanoid_floating", "satellite_arm",
                                 "stanford_arm", "mobile", "gyroscopic_wrist",
                                 "puma_560_friction"}),
                     name) {
  namespace fast = recursive::fast;
  if (!fast::kHasAvx2) return;
  const scene::Scene scene = scene::findScene(name);
  const auto model =
      recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
  const fast::Plan<double> plan(model);
  fast::InverseDynamicsWorkspace<double> id(plan);
  fast::MassMatrixWorkspace<double> m(plan);
  fast::ForwardDynamicsWorkspace<double> fd(plan);
  const std::size_t n = plan.dof;
  for (int k = 0; k < 20; ++k) {
    const scene::State<double> s = drawState(scene.mechanism, scene.name, 5, k);
    std::vector<double> a(n * n), b(n * n);
    const auto same = [&] {
      return std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
    };
    fast::inverseDynamics(plan, s.x.data(), s.qd.data(), s.qdd.data(), id, a.data());
    fast::detail::inverseDynamicsBody(plan, s.x.data(), s.qd.data(), s.qdd.data(), id, b.data());
    BOOST_TEST(same());
    fast::massMatrix(plan, s.x.data(), m, a.data());
    fast::detail::massMatrixBody<fast::TwoPairs>(plan, s.x.data(), m, b.data());
    BOOST_TEST(same());
    fast::forwardDynamics(plan, s.x.data(), s.qd.data(), s.tau.data(), fd, a.data());
    fast::detail::forwardDynamicsBody(plan, s.x.data(), s.qd.data(), s.tau.data(), fd, b.data());
    BOOST_TEST(same());
    std::vector<double> q;
    for (const auto& x : s.x) q.push_back(x.q * 400);  // beyond the reduction's range, too
    std::vector<scene::JointPosition<double>> four(q.size()), two(q.size());
    const int count = static_cast<int>(q.size());
    fast::jointPositions(q.data(), count, four.data());
    fast::detail::two::positions(q.data(), count, two.data());
    for (int i = 0; i < count; ++i) {
      // one angle out of range sends its whole vector to the library: then within 2 u each
      BOOST_TEST(std::abs(four[i].c - two[i].c) <= 0x1p-51 * std::abs(two[i].c));
      BOOST_TEST(std::abs(four[i].s - two[i].s) <= 0x1p-51 * std::abs(two[i].s));
    }
  }
}
