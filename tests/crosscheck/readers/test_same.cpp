// SPDX-License-Identifier: GPL-3.0-or-later
// Whether two descriptions are the same robot: the same one written in other ways is, and each
// single difference is found with its link and both values.
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE same
#include "crosscheck/readers/same.hpp"

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "tests/fixtures/program.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using Verdict = SameResult::Verdict;

namespace {

/// Two hinges about z and y, in three spellings.
std::string toml(const std::string& upper =
                     "mass = 2\ncom = [0.25, 0, 0.1]\n"
                     "inertia = { about = \"com\", xx = 0.02, yy = 0.05, zz = 0.06, xy = 0.003 }\n",
                 const std::string& joint = "", const std::string& elbow = "elbow") {
  return "title = \"Arm\"\nsource = \"chosen here\"\ngravity = [0, 0, -9.81]\n"
         "[[link]]\nname = \"base\"\n"
         "[[link]]\nname = \"upper\"\nparent = \"base\"\n" +
         upper + "[link.joint]\nname = \"shoulder\"\nkind = \"revolute\"\naxis = [0, 0, 1]\n" +
         joint +
         "[[link]]\nname = \"lower\"\nparent = \"upper\"\nmass = 1\ncom = [0.2, 0, 0]\n"
         "inertia = { about = \"com\", xx = 0.01, yy = 0.02, zz = 0.015 }\n"
         "[link.joint]\nname = \"" +
         elbow + "\"\nkind = \"revolute\"\naxis = [0, 1, 0]\nxyz = [0.5, 0, 0]\n";
}
/// The lower link's frame turned a quarter about x (its own y is the upper's z, its z the upper's -y),
/// half of its mass on a link that is fixed to it, and joints in the other order.
std::string urdf() {
  return "<robot name=\"arm\">"
         "<link name=\"root\"/>"
         "<link name=\"l2\"><inertial><origin xyz=\"0.2 0 0\"/><mass value=\"0.5\"/>"
         "<inertia ixx=\"0.005\" iyy=\"0.0075\" izz=\"0.01\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>"
         "<link name=\"half\"><inertial><mass value=\"0.5\"/>"
         "<inertia ixx=\"0.005\" iyy=\"0.0075\" izz=\"0.01\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>"
         "<link name=\"l1\"><inertial><origin xyz=\"0.25 0 0.1\"/><mass value=\"2\"/>"
         "<inertia ixx=\"0.02\" iyy=\"0.05\" izz=\"0.06\" ixy=\"0.003\" ixz=\"0\" iyz=\"0\"/></inertial></link>"
         "<joint name=\"glue\" type=\"fixed\"><parent link=\"l2\"/><child link=\"half\"/><origin xyz=\"0.2 0 0\"/></joint>"
         "<joint name=\"j2\" type=\"continuous\"><parent link=\"l1\"/><child link=\"l2\"/>"
         "<origin xyz=\"0.5 0 0\" rpy=\"1.5707963267948966 0 0\"/><axis xyz=\"0 0 -2\"/></joint>"
         "<joint name=\"j1\" type=\"continuous\"><parent link=\"root\"/><child link=\"l1\"/><axis xyz=\"0 0 1\"/></joint>"
         "</robot>";
}
Description described(const std::string& text) {
  if (text[0] == '<') return scene::readUrdfAsWritten(text, "b.urdf");
  return {scene::readSceneToml(text, "a.toml"), {}};
}
SameResult compared(const std::string& a, const std::string& b) {
  return compareDescriptions(described(a), described(b), 5, 1);
}

struct Change {
  const char* name;
  std::string text;
  const char *link, *quantity, *a, *b;
  bool is_felt = true;  ///< by the joints
};
std::ostream& operator<<(std::ostream& out, const Change& change) {
  return out << change.name;
}
const std::string kOther =
    "com = [0.25, 0, 0.1]\n"
    "inertia = { about = \"com\", xx = 0.02, yy = 0.05, zz = 0.06, xy = 0.003 }\n";
const Change kChanges[] = {
    {"mass", toml("mass = 2.5\n" + kOther), "upper", "mass [kg]", "2", "2.5"},
    {"damping", toml("mass = 2\n" + kOther, "friction = { viscous = 0.5 }\n"), "upper", "damping",
     "0", "0.5"},
    {"rotor", toml("mass = 2\n" + kOther, "rotor_inertia = 0.25\n"), "upper", "rotor", "0", "0.25"},
    {"place", toml("mass = 2\n" + kOther, "xyz = [0, 0.5, 0]\n"), "upper", "point on the axis [m]",
     "(0, 0, 0)", "(0, 0.5, 0)", false},  // beside the vertical axis
    {"gravity", "gravity = [0, -9.81, 0]\n" + toml().substr(toml().find("[[link]]")), "",
     "gravity [m/s^2]", "(0, 0, -9.81)", "(0, -9.81, 0)"},
};

}  // namespace

BOOST_AUTO_TEST_CASE(a_description_is_the_same_robot_as_itself) {
  const SameResult result = compared(toml(), toml());
  BOOST_TEST((result.verdict == Verdict::kExactly));
  BOOST_TEST(result.differences.empty());
  BOOST_TEST(result.matched_by_name);
  BOOST_TEST(result.error_probability < 1e-30);
  BOOST_TEST(result.tau == 0);
}

BOOST_AUTO_TEST_CASE(other_formats_frames_names_orders_and_fixed_links_are_the_same_robot) {
  const SameResult result = compared(toml(), urdf());
  BOOST_TEST_CONTEXT(sameText(result)) {
    BOOST_TEST((result.verdict == Verdict::kExactly));
    BOOST_TEST(!result.matched_by_name);
    BOOST_REQUIRE(result.joints.size() == 2u);
    BOOST_TEST(result.joints[1].second == "j2");
  }
}

BOOST_DATA_TEST_CASE(a_difference_is_named_with_its_link_and_both_values, data::make(kChanges),
                     change) {
  const SameResult result = compared(toml(), change.text);
  BOOST_TEST_CONTEXT(sameText(result)) {
    BOOST_TEST((result.verdict == Verdict::kDifferent));
    BOOST_REQUIRE(result.differences.size() == 1u);
    BOOST_TEST(result.differences[0].link == change.link);
    BOOST_TEST(result.differences[0].quantity == change.quantity);
    BOOST_TEST(result.differences[0].a == change.a);
    BOOST_TEST(result.differences[0].b == change.b);
    BOOST_TEST((result.tau > 0) == change.is_felt);
  }
}

// The shoulder turns about a vertical axis: of the upper link it feels Izz and no Ixx, and gravity
// does nothing.
BOOST_AUTO_TEST_CASE(what_no_motion_can_tell_is_the_same_robot_and_told) {
  const std::string other = toml(
      "mass = 2\ncom = [0.25, 0, 0.1]\ninertia = { about = \"com\", xx = 0.03, yy = 0.05, zz = 0.06, xy = 0.003 }\n");
  const SameResult result = compared(toml(), other);
  BOOST_TEST((result.verdict == Verdict::kToMotion));
  BOOST_REQUIRE(result.differences.size() == 1u);
  BOOST_TEST(result.differences[0].quantity == "Ixx about it [kg m^2]");
}

// 1/3 has no decimals: exactly another number, and no other double.
BOOST_AUTO_TEST_CASE(what_differs_in_the_last_digit_of_a_double_is_told_apart_from_what_differs) {
  const auto upper = [](const std::string& mass) { return toml("mass = " + mass + "\n" + kOther); };
  BOOST_TEST(
      (compared(upper("\"1/3\""), upper("0.33333333333333333")).verdict == Verdict::kInDouble));
  BOOST_TEST((compared(upper("\"1/3\""), upper("0.3333333333")).verdict == Verdict::kDifferent));
}

BOOST_AUTO_TEST_CASE(robots_of_other_structure_are_different) {
  const std::string one =
      "title = \"x\"\nsource = \"x\"\n[[link]]\nname = \"base\"\n[[link]]\nname = \"a\"\n"
      "parent = \"base\"\nmass = 1\ncom = [1, 0, 0]\njoint = { kind = \"revolute\" }\n";
  BOOST_TEST((compared(toml(), one).verdict == Verdict::kDifferent));
}

BOOST_AUTO_TEST_CASE(the_command_has_its_exit_status) {
  const fixtures::Program program;
  program.write("a.toml", toml());
  program.write("b.urdf", urdf());
  program.write("c.toml", toml("mass = 2.5\n" + kOther));
  BOOST_TEST(program.run("same a.toml b.urdf --json s.json").status == 0);
  BOOST_TEST(program.exists("s.json"));
  const fixtures::Outcome outcome = program.run("same a.toml c.toml");
  BOOST_TEST(outcome.status == 1);
  BOOST_TEST(outcome.out.find("link \"upper\" mass [kg]: 2 and 2.5") != std::string::npos,
             outcome.out);
  fixtures::refuses(program, "same a.toml none.toml", "none.toml");
  fixtures::refuses(program, "same a.toml bricard", "has closures, which are not compared");
}
