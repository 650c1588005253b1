// SPDX-License-Identifier: GPL-3.0-or-later
// Base parameters: counts of the literature, combinations by hand, and what moving a dependent
// parameter into its base must leave unchanged.
#include <set>
#include <string>
#include <vector>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/parameters/base_parameters.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/regressor.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

constexpr double kChance = 1e-30;

/// All bundled scenes but the humanoids, which take seconds each.
std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const auto& file : scene::bundledScenes())
    if (file.stem().string().rfind("humanoid", 0) != 0) out.push_back(file.stem().string());
  return out;
}
std::vector<std::string> namesAndHumanoid() {
  std::vector<std::string> out = names();
  out.push_back("humanoid");
  return out;
}

struct Count {
  const char* scene;
  int links;
};
std::ostream& operator<<(std::ostream& out, const Count& c) {
  return out << c.scene;
}

}  // namespace

// 36: a PUMA's by H. Mayeda et al. (1990), 7 n - 4 - 2. 43: C. Gaz et al., Dynamic identification
// of the Franka Emika Panda robot, IEEE RA-L 4(4), 2019. The others by hand: two joints about
// parallel axes across gravity have Iyy, mcx, mcz of either link; along gravity the first link's
// moments do not count.
const Count kPublished[] = {{"puma_560", 36},       {"franka_panda", 43}, {"kuka_iiwa_14", 43},
                            {"double_pendulum", 6}, {"acrobot", 6},       {"simple_pendulum", 3},
                            {"planar_3r", 7}};
BOOST_DATA_TEST_CASE(counts_are_those_of_the_literature, data::make(kPublished), known) {
  const scene::Scene scene = scene::findScene(known.scene);
  const BaseParameters base = baseParameters(scene, 1, kChance);
  BOOST_TEST(base.countWithoutRotors() == known.links);
  BOOST_TEST(base.error_probability <= kChance);
}

// Mayeda's closed form counts axes; the rank counts columns.
BOOST_AUTO_TEST_CASE(counts_are_those_of_the_closed_form) {
  int applicable = 0;
  for (const std::string& name : names()) {
    const scene::Scene scene = scene::findScene(name);
    const std::optional<int> expected = mayedaCount(scene.mechanism);
    if (!expected) continue;
    ++applicable;
    BOOST_TEST(baseParameters(scene, 1, kChance).countWithoutRotors() == *expected, name);
  }
  BOOST_TEST(applicable >= 5);
}

// The energies, by the derivation, know as many numbers as the forces, by the sweeps, and the same
// ones.
BOOST_DATA_TEST_CASE(energies_know_what_forces_know, data::make(names()), name) {
  const scene::Scene scene = scene::findScene(name);
  const BaseParameters base = baseParameters(scene, 1, kChance);
  BOOST_TEST(energyRank(scene, base, 1) == base.count());
}

// pi_1 + K pi_2 in the place of pi_1, 0 in the place of pi_2: the same forces, over rational points
// where the geometry is rational.
BOOST_DATA_TEST_CASE(forces_need_the_base_parameters_alone, data::make(names()), name) {
  const scene::Scene scene = scene::findScene(name);
  const BaseParameters base = baseParameters(scene, 1, kChance);
  bool rational = true;
  for (const Coefficient& c : base.K) rational = rational && c.exact;
  if (!rational) return;  // enclosed in balls only
  const PrimeField::Modulus modulus(drawPrime(name, 77, 0));
  const FieldSource source(name, 77, 0);
  const FieldNumbers number(scene.mechanism, source);
  const auto state = indeterminateState(scene.mechanism, source);
  const auto model = recursive::buildModel(scene.mechanism, number);
  recursive::Workspace<PrimeField> ws(model);
  recursive::MatrixX<PrimeField> Y(model.dof(), base.parameters.size());
  recursive::regressor(model, base.parameters, state.x, state.qd, state.qdd, ws, Y);
  std::vector<PrimeField> pi, regrouped(base.parameters.size(), PrimeField(0));
  for (std::size_t j = 0; j < base.parameters.size(); ++j)
    pi.push_back(source.element("pi" + std::to_string(j)));
  for (const int j : base.independent) regrouped[j] = pi[j];
  for (const Coefficient& c : base.K)
    regrouped[base.independent[c.base]] += PrimeField::fromRational(*c.exact) * pi[c.parameter];
  for (Eigen::Index i = 0; i < Y.rows(); ++i) {
    PrimeField left = 0, right = 0;
    for (std::size_t j = 0; j < pi.size(); ++j) {
      left += Y(i, j) * pi[j];
      right += Y(i, j) * regrouped[j];
    }
    BOOST_TEST((left == right), name << ": tau[" << i << "]");
  }
}

// By hand: two rods, joints about y; the lower joint hangs l1 = 1/2 below the upper one. To joint 1
// the lower link's mass is a point at its hinge: m l1^2 of inertia, -m l1 of first moment along z.
BOOST_AUTO_TEST_CASE(the_double_pendulum_regroups_as_by_hand) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  const BaseParameters base = baseParameters(scene, 1, kChance);
  std::set<std::string> sums;
  for (int r = 0; r < base.count(); ++r) sums.insert(combination(base, r, scene.mechanism));
  const std::set<std::string> expected = {"mcx(upper)",
                                          "mcz(upper) - l1 m(lower)",
                                          "Iyy(upper) + l1^2 m(lower)",
                                          "mcx(lower)",
                                          "mcz(lower)",
                                          "Iyy(lower)"};
  BOOST_TEST(sums == expected, boost::test_tools::per_element());
  int alone = 0, together = 0;
  for (const auto status : base.status) {
    alone += status == BaseParameters::Status::kAlone;
    together += status == BaseParameters::Status::kInCombination;
  }
  BOOST_TEST(alone == 4);
  BOOST_TEST(together == 3);
}

// A rational lifted from residues lies in the ball that doubles and balls found without any prime
// (a mismatch throws).
BOOST_DATA_TEST_CASE(rationals_lie_in_their_balls, data::make(namesAndHumanoid()), name) {
  const BaseParameters base = baseParameters(scene::findScene(name), 1, kChance);
  for (const Coefficient& c : base.K) {
    BOOST_TEST(c.error <= std::abs(c.value) * 0x1p-50);
    if (c.exact)
      BOOST_TEST(std::abs(c.exact->convert_to<double>() - c.value) <=
                 c.error + 0x1p-52 * std::abs(c.value));
  }
}
