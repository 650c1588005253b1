// SPDX-License-Identifier: GPL-3.0-or-later
// Which entries are zero against the Lagrangian's at another point of another field; why, against
// what is known of the scenes by hand; and rules, asked of what is not zero as well.
#include "crosscheck/exact/ledger.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/exact/equation_zeros.hpp"
#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "scene/scene.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

std::vector<std::string> bundledNames() {
  std::vector<std::string> names;
  for (const auto& file : scene::bundledScenes()) names.push_back(file.stem().string());
  return names;
}

/// Entries of M, c and g that the Lagrangian has as zero at one point.
std::set<std::string> zerosOfLagrange(const scene::Scene& scene) {
  const PrimeField::Modulus field(drawPrime("test_ledger", 7, 0));
  const FieldSource source("test_ledger", 7, 0);
  symbolic::Equations derived = symbolic::derive(scene.mechanism);
  const symbolic::Program program =
      symbolic::compile(derived.graph, symbolic::massCoriolisGravity(derived));
  symbolic::ProgramRun<PrimeField> run(program, FieldNumbers(scene.mechanism, source));
  const std::vector<PrimeField> out = run(indeterminateState(scene.mechanism, source));
  const auto n = static_cast<std::size_t>(scene.mechanism.dof());
  std::set<std::string> zeros;
  const auto name = [](const char* letter, std::size_t i) {
    return letter + std::to_string(i + 1);
  };
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i; j < n; ++j)
      if (out[i * n + j].isZero()) zeros.insert(name("M_", i) + name(",", j));
    if (out[n * n + i].isZero()) zeros.insert(name("c_", i));
    if (out[n * n + n + i].isZero()) zeros.insert(name("g_", i));
  }
  return zeros;
}

/// By entry, products of rates apart.
std::map<std::string, std::string> reasons(const std::vector<Ledger::Zeros>& all,
                                           bool with_products = false) {
  std::map<std::string, std::string> out;
  for (const Ledger::Zeros& zeros : all)
    if (with_products || zeros.quantity != "c_ijk")
      for (const Ledger::Zeros::Group& group : zeros.groups)
        for (const std::string& entry : group.entries) out[entry] = group.reason;
  return out;
}

EquationZeros zerosOf(const scene::Scene& scene) {
  return equationZeros(scene, 1, 1e-30);
}

bool hasWords(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

BOOST_DATA_TEST_CASE(the_same_entries_are_zero_of_the_Lagrangian, data::make(bundledNames()),
                     name) {
  const scene::Scene scene = scene::findScene(name);
  const EquationZeros found = zerosOf(scene);
  std::set<std::string> zeros;
  for (const auto& [entry, reason] : reasons(found.of)) zeros.insert(entry);
  BOOST_TEST(zeros == zerosOfLagrange(scene), boost::test_tools::per_element());
  BOOST_TEST(found.error_probability <= 1e-30);
  BOOST_TEST(found.disputes.empty(), (found.disputes.empty() ? "" : found.disputes.front()));
}

// a rule that calls an entry zero which is not, or blames axes for what masses do, is a dispute
BOOST_AUTO_TEST_CASE(no_rule_explains_what_is_not_zero_in_random_trees) {
  std::set<std::string> seen;
  for (std::uint64_t k = 0; k < 300; ++k) {
    const EquationZeros found = zerosOf(randomScene(11, k, 7));
    for (const std::string& dispute : found.disputes) BOOST_TEST(dispute == "", k);
    for (const auto& [entry, reason] : reasons(found.of, true)) seen.insert(reason);
  }
  BOOST_TEST(seen.size() >= 8u);  // or nothing was asked
}

BOOST_AUTO_TEST_CASE(reasons_are_those_known_by_hand) {
  const auto is = [](const std::string& scene, const std::string& entry, const std::string& part) {
    const auto all = reasons(zerosOf(scene::findScene(scene)).of, true);
    const auto found = all.find(entry);
    BOOST_TEST((found != all.end() && hasWords(found->second, part)),
               scene << " " << entry << ": " << (found == all.end() ? "not zero" : found->second));
  };
  is("planar_3r", "g_2", "no gravity");
  is("scara", "g_1", "gravity is along the axis");  // a vertical axis
  is("scara", "M_1,3", "a slide along the axis of a turn");
  is("scara", "c_3", "its row of M is constant");
  is("cart_pole", "g_1", "at right angles to gravity");
  is("puma_560", "M_5,6", "balanced");  // the flange turns about its axis of symmetry
  is("puma_560", "M_4,5", "symmetry");  // the wrist's centre of mass is on the last axis
  is("puma_560", "g_6", "centre of mass of all that it carries is on its axis");
  is("pendulum_on_slides", "M_1,2", "two slides at right angles");
  is("pendulum_on_slides", "c_1", "M does not depend on q");
  is("mobile", "M_2,5", "independent branches");
  is("puma_560", "c_1,1,1", "no joint's motion changes");
  is("puma_560", "c_2,1,3", "cancels");
}

BOOST_AUTO_TEST_CASE(a_reason_goes_with_its_cause) {
  scene::Scene puma = scene::findScene("puma_560");
  puma.mechanism.links.back().inertia.xz = scene::Number::parse("0.001");
  auto all = reasons(zerosOf(puma).of);
  BOOST_TEST(all.count("M_5,6") == 0u);  // the flange is not balanced any more
  puma = scene::findScene("puma_560");
  puma.mechanism.gravity = {scene::Number(1), scene::Number(0), scene::Number(-9)};
  all = reasons(zerosOf(puma).of);
  BOOST_TEST(all.count("g_1") == 0u);
  BOOST_TEST(all.count("g_6") == 1u);  // its centre of mass is on the axis all the same
  puma.mechanism.links.back().inertia.com[0] = scene::Number::parse("0.01");
  all = reasons(zerosOf(puma).of);
  BOOST_TEST(all.count("g_6") == 0u);
}

// The second axis, along x, starts 0.3 m before the first; its load is symmetric about the plane
// x = 0.3 m of its own frame: in that plane lies the first axis.
BOOST_AUTO_TEST_CASE(a_plane_of_symmetry_is_where_the_centre_of_mass_is) {
  const auto zerosWith = [](const char* com) {
    const std::string text = std::string(R"(
gravity = [0, 0, -9.81]
[[link]]
name = "base"
[[link]]
name = "yoke"
parent = "base"
mass = 1
[link.joint]
name = "turn"
kind = "revolute"
axis = [0, 0, 1]
[[link]]
name = "beam"
parent = "yoke"
mass = 2
com = [)") + com + R"(, 0.2, 0.1]
inertia = { xx = 0.1, yy = 0.1, zz = 0.1, yz = 0.02 }
[link.joint]
name = "tilt"
kind = "revolute"
axis = [1, 0, 0]
xyz = [-0.3, 0, 0]
)";
    return reasons(zerosOf(scene::readSceneToml(text, "beam.toml")).of);
  };
  BOOST_TEST(hasWords(zerosWith("0.3")["M_1,2"], "symmetry"));
  BOOST_TEST(zerosWith("0.2").count("M_1,2") == 0u);
}

// 7 n - 4 b less 2 where gravity is along the first axis (Mayeda, Yoshida, Osuka 1990), and rotors
// of joints whose inertia about the axis no other motion shows
BOOST_AUTO_TEST_CASE(parameters_that_matter_are_those_of_the_closed_form) {
  const auto count = [](const char* name) {
    return ledgerOf(scene::findScene(name)).base_parameters.value_or(-1);
  };
  BOOST_TEST(count("planar_3r") == 7 * 3 - 4 * 3 - 2);
  BOOST_TEST(count("franka_panda") == 7 * 7 - 4 * 1 - 2);
  BOOST_TEST(count("puma_560") == 7 * 6 - 4 * 1 - 2 + 4);
}

BOOST_AUTO_TEST_CASE(operations_fall_with_what_is_not_there) {
  const Ledger puma = ledgerOf(scene::findScene("puma_560"));
  BOOST_TEST(puma.links == 6);
  BOOST_TEST(puma.parameters == 66);
  BOOST_TEST(*puma.operations < *puma.general_operations);
  const Ledger chain = ledgerOf(scene::findScene("chain_1000"));
  BOOST_TEST(!chain.base_parameters);
  BOOST_TEST(hasWords(chain.no_base_parameters, "not counted beyond"));
  BOOST_TEST(hasWords(chain.zeros.front().not_examined, "not looked for beyond"));
  BOOST_TEST(chain.general_operations.has_value());
  BOOST_TEST(!chain.operations);
}
