// SPDX-License-Identifier: GPL-3.0-or-later
// The atlas of failures: its mechanisms are possible, its theories hold, and what is worse is found
// to be worse.
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <ostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "crosscheck/stability/atlas_report.hpp"
#include "tests/fixtures/program.hpp"

namespace dynwitness::crosscheck::stability {
inline std::ostream& operator<<(std::ostream& out, const Family& family) {
  return out << family.name;
}
}  // namespace dynwitness::crosscheck::stability

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using namespace dynwitness::crosscheck::stability;

namespace {

Settings quick() {
  Settings settings;
  settings.severities = 9;
  return settings;
}

std::vector<stability::Method> methodsNamed(const std::vector<std::string>& names) {
  std::vector<stability::Method> out;
  for (const stability::Method& method : methodsOf(selectWitnesses({})))
    if (std::find(names.begin(), names.end(), method.name) != names.end()) out.push_back(method);
  BOOST_REQUIRE(out.size() == names.size());
  return out;
}

const Course& courseOf(const Turned& turned, const std::string& method) {
  for (const Course& course : turned.courses)
    if (course.method == method) return course;
  BOOST_REQUIRE_MESSAGE(false, turned.family << " has no " << method);
  return turned.courses.front();
}

/// M rounded to float before it is solved with.
class RoundedMatrix : public Witness {
 public:
  explicit RoundedMatrix(const PreparedScene& scene)
      : inner_(selectWitnesses({"composite_body"}).front().make(scene).value()),
        bias_(selectWitnesses({"newton_euler"}).front().make(scene).value()) {}
  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return quantity == Quantity::kQdd; }
  Answer answer(Quantity, const scene::State<double>& state) override {
    scene::State<double> resting = state;
    std::fill(resting.qdd.begin(), resting.qdd.end(), 0);
    const Eigen::MatrixXd M =
        inner_->value(Quantity::kM, state).cast<float>().cast<double>().eval();
    Eigen::VectorXd b = -bias_->value(Quantity::kTau, resting);
    for (Eigen::Index i = 0; i < b.size(); ++i) b(i) += state.tau[static_cast<std::size_t>(i)];
    return {M.fullPivLu().solve(b), Eigen::MatrixXd::Zero(b.size(), 1)};
  }

 private:
  std::string name_ = "rounded_matrix";
  std::unique_ptr<Witness> inner_, bias_;
};

}  // namespace

BOOST_AUTO_TEST_CASE(families_have_names_that_files_can_have_and_explain_themselves) {
  std::set<std::string> names;
  for (const Family& family : families()) {
    BOOST_TEST_CONTEXT(family.name) {
      BOOST_TEST(names.insert(family.name).second);
      BOOST_TEST(std::all_of(family.name.begin(), family.name.end(),
                             [](unsigned char c) { return std::islower(c) || c == '_'; }));
      BOOST_TEST(family.from < family.to);
      for (const std::string& text : {family.title, family.dial, family.mechanism, family.survivor})
        BOOST_TEST(!text.empty());
    }
  }
  BOOST_TEST(names.size() >= 34u);
}

// A name that nobody has would leave a method with the theory of its road.
BOOST_DATA_TEST_CASE(theories_name_methods_that_there_are, data::make(families()), family) {
  std::set<std::string> known;
  for (const WitnessKind& kind : witnessKinds())
    known.insert({kind.info.name, kind.info.name + " float"});
  if (family.whole)
    for (const NamedRoad& road : mechanismRoads(PreparedScene(harmlessCase(family).scene)))
      known.insert(road.name);
  for (const Theory& theory : family.theories) {
    BOOST_TEST((theory.isClaimed() || !theory.methods.empty()), family.name);
    for (const std::string& method : theory.methods)
      BOOST_TEST(known.count(method) == 1, family.name << ": " << method);
  }
}

// caseOf() validates; that there is a truth is what no family can do without.
BOOST_DATA_TEST_CASE(both_ends_of_every_dial_are_possible_and_certified, data::make(families()),
                     family) {
  if (!family.measures.empty()) return;  // they know what is right
  for (const double severity : {family.from, family.to})
    for (int variant = 0; variant < kVariants; ++variant) {
      const Case given = family.make(decimalOf(severity, family.is_whole), variant);
      BOOST_TEST(given.state.x.size() ==
                 static_cast<std::size_t>(given.scene.mechanism.positions()));
      BOOST_TEST(truthOf(family, given).size() > 0);
    }
}

// What is not as theory has it is said here, with the reason; all else is within a factor of two.
BOOST_DATA_TEST_CASE(breakdowns_are_where_theory_has_them, data::make(families()), family) {
  const std::map<std::pair<std::string, std::string>, std::string> known = {
      // which entries round by how much is luck; in float, those of these three rods do by little
      {{"thin_rod", "composite_body float"}, "later than predicted"},
      {{"thin_rod", "articulated_body float"}, "later than predicted"},
      {{"counterweight", "newton_euler float"}, "later than predicted"},
  };
  // Estimates that warn of right answers: the first four of what happens to cancel exactly,
  // long_chain of sizes that outgrow what is summed, the others next to the breakdown, where sizes
  // leave the numbers of the arithmetic by a factor before the answer does.
  const std::set<std::pair<std::string, std::string>> too_careful = {
      {"vanishing_rotor", "articulated_body"},
      {"vanishing_rotor", "articulated_body float"},
      {"gimbal", "articulated_body"},
      {"near_axes", "articulated_body float"},
      {"long_chain", "articulated_body float"},
      {"light_to_heavy", "articulated_body float"},
      {"light_to_heavy", "composite_body float"},
      {"spinning_ball", "articulated_body float"},
      {"spinning_ball", "composite_body float"},
      {"fast_spin", "composite_body"},
      {"fast_spin", "articulated_body"},
      {"fast_spin", "composite_body float"},
      {"fast_spin", "articulated_body float"},
      {"huge_lengths", "composite_body"},
      {"huge_lengths", "articulated_body"},
      {"huge_lengths", "composite_body float"},
      {"huge_lengths", "articulated_body float"},
      {"short_quaternion", "composite_body float"},  // once each, next to where they break
      {"short_quaternion", "articulated_body float"}};
  const bool is_tau = family.quantity == Quantity::kTau;
  const std::vector<std::string> in_double = is_tau ? std::vector<std::string>{"newton_euler"}
                                                    : std::vector<std::string>{"composite_body",
                                                                               "articulated_body"},
                                 all = is_tau
                                           ? std::vector<std::string>{"newton_euler",
                                                                      "newton_euler float"}
                                           : std::vector<std::string>{
                                                 "composite_body", "articulated_body",
                                                 "composite_body float", "articulated_body float"};
  const Turned turned = turn(family, methodsNamed(all), quick());
  for (const Course& course : turned.courses) {
    BOOST_TEST_CONTEXT(family.name << ", " << course.method << ": breaks at " << course.breaks_at
                                   << ", predicted " << course.predicted << " "
                                   << course.left_out) {
      BOOST_TEST(course.left_out.empty());
      const auto at = known.find({family.name, course.method});
      if (at != known.end())
        BOOST_TEST(course.verdict() == at->second);
      else if (course.has_theory)
        BOOST_TEST(course.isAsPredicted(), course.verdict());
      BOOST_TEST(course.silent() == 0);
      BOOST_TEST(!course.points.front().warned);  // where all is harmless
      if (too_careful.count({family.name, course.method}) == 0)
        BOOST_TEST(course.falseAlarms() == 0);
    }
  }
  if (!family.measures.empty() || family.whole) return;
  for (const std::string& method : in_double) {
    const Course &more = courseOf(turned, method), &fewer = courseOf(turned, method + " float");
    if (more.breaks() && fewer.has_theory)
      BOOST_TEST((fewer.breaks() && fewer.breaks_at < more.breaks_at),
                 family.name << ", " << method << ": float breaks at " << fewer.breaks_at
                             << ", double at " << more.breaks_at);
  }
}

BOOST_AUTO_TEST_CASE(a_method_that_forgets_is_found_to_break_earlier) {
  std::vector<stability::Method> methods = methodsNamed({"composite_body"});
  WitnessKind planted{{"rounded_matrix", "planted", "M in float"},
                      [](const PreparedScene& scene) -> MadeWitness {
                        return std::unique_ptr<Witness>(std::make_unique<RoundedMatrix>(scene));
                      }};
  methods.push_back(methodsOf({planted}).front());
  const Turned turned = turn(familyNamed("far_centre"), methods, quick());
  const Course &right = courseOf(turned, "composite_body"),
               &wrong = courseOf(turned, "rounded_matrix");
  BOOST_REQUIRE((right.breaks() && wrong.breaks()));
  // u of float over that of double is 2^29, and the error grows as s^2
  BOOST_TEST(right.breaks_at / wrong.breaks_at > 1000);
  BOOST_TEST(right.silent() == 0);
  BOOST_TEST(wrong.silent() > 0);  // nobody told
  BOOST_TEST(!wrong.is_ours);
}

BOOST_AUTO_TEST_CASE(two_runs_say_the_same) {
  const auto run = [] {
    const Turned turned = turn(familyNamed("spinning_ball"),
                               methodsNamed({"fast", "composite_body float", "simbody"}), quick());
    return csvOf(turned) + atlasJson({turned}, "0") + scriptOf(turned, "style.gp") +
           atlasPage({turned}, "0", "command") + tableOf(turned);
  };
  BOOST_TEST(run() == run());
}

BOOST_AUTO_TEST_CASE(results_come_back_from_their_file_and_those_of_another_make_do_not) {
  const Turned turned =
      turn(familyNamed("gimbal"), methodsNamed({"articulated_body", "composite_body"}), quick());
  const std::string text = familyJson(turned, "this");
  const auto again = familyFromJson(text, "this");
  BOOST_REQUIRE(again.has_value());
  BOOST_TEST(familyJson(*again, "this") == text);
  BOOST_TEST(!familyFromJson(text, "another").has_value());
  BOOST_TEST(!familyFromJson(text.substr(0, text.size() / 2), "this").has_value());
  BOOST_TEST(!familyFromJson("", "this").has_value());
}
