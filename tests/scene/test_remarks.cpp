// SPDX-License-Identifier: GPL-3.0-or-later
// Slips that a format lets pass. What is to be said of each is written here by hand; turns and
// degrees are worked out in the comments.
#include "scene/remarks.hpp"

#include <string>
#include <vector>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

namespace data = boost::unit_test::data;
using namespace dynwitness::scene;
using Lines = std::vector<std::string>;

namespace {

/// An arm of one joint; its inertial is at line 3, its joint at line 4.
const std::string kInertial =
    "<inertial><origin xyz=\"1 0 0\" rpy=\"0 0 0.5\"/><mass value=\"1\"/>"
    "<inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";
const std::string kJoint =
    "<joint name=\"elbow\" type=\"revolute\"><origin xyz=\"1 0 0\" rpy=\"0 0 1.5\"/>"
    "<parent link=\"base\"/><child link=\"arm\"/><axis xyz=\"0 0 1\"/>"
    "<limit lower=\"-1.5\" upper=\"1.5\" effort=\"5\" velocity=\"3\"/>"
    "<dynamics damping=\"0.1\" friction=\"0.2\"/></joint>";
std::string robot(const std::string& inertial, const std::string& joint) {
  return "<robot name=\"r\">\n<link name=\"base\"/>\n<link name=\"arm\">" + inertial + "</link>\n" +
         joint + "\n</robot>\n";
}
std::string with(const std::string& from, const std::string& to) {
  std::string text = robot(kInertial, kJoint);
  const std::size_t at = text.find(from);
  BOOST_REQUIRE_MESSAGE(at != std::string::npos, from);
  return text.replace(at, from.size(), to);
}

struct Slip {
  std::string from, to, said;  ///< said: without the file; empty: nothing is
};
std::ostream& operator<<(std::ostream& out, const Slip& slip) {
  return out << slip.to;
}

std::string unknown(const std::string& line, const std::string& owner, const std::string& in,
                    const std::string& what, const std::string& meant) {
  return line + ": " + owner + ": <" + in + "> has an unknown " + what + " (did you mean " + meant +
         "?): it is ignored";
}
const std::string kArm = "link \"arm\"", kElbow = "joint \"elbow\"";

const Slip kSlips[] = {
    // words that URDF has not, near to one that it has
    {"origin", "orign", unknown("3", kArm, "inertial", "element <orign>", "origin")},
    {"<mass", "<Mass", unknown("3", kArm, "inertial", "element <Mass>", "mass")},
    {"xyz=\"1 0 0\" rpy", "xzy=\"1 0 0\" rpy",
     unknown("3", kArm, "origin", "attribute xzy", "xyz")},
    {"rpy=\"0 0 1.5\"", "pry=\"0 0 1.5\"", unknown("4", kElbow, "origin", "attribute pry", "rpy")},
    {"damping", "dampng", unknown("4", kElbow, "dynamics", "attribute dampng", "damping")},
    {"<axis", "<axes", unknown("4", kElbow, "joint", "element <axes>", "axis")},
    {"<axis xyz", "<axis XYZ", unknown("4", kElbow, "axis", "attribute XYZ", "xyz")},
    {"<limit lower", "<limit low", unknown("4", kElbow, "limit", "attribute low", "lower")},
    {"<dynamics", "<dynamic", unknown("4", kElbow, "joint", "element <dynamic>", "dynamics")},
    // of others: extensions that are in use
    {"<inertial>", "<contact/><self_collision_checking/><gravity/><inertial>", ""},
    {"<axis", "<safety_controller k_velocity=\"1\"/><calibration rising=\"0\"/><drake:axes/><axis",
     ""},
    {"damping", "mu_coulomb=\"0\" K=\"1\" drake:dampng=\"1\" damping", ""},
    {"velocity", "gear_velocity=\"1\" current=\"2\" command_effort=\"3\" velocity", ""},
    {"</robot>", "<gazebo><orign/></gazebo><transmission name=\"t\"/><links/></robot>", ""},
    // 90 / 2 pi = 14.32, 90 degrees = pi / 2 = 1.5707963267948966
    {"rpy=\"0 0 1.5\"", "rpy=\"0 0 90\"",
     "4: joint \"elbow\": <origin>: rpy: 90 rad is 14.3 turns; if it is in degrees, write "
     "1.5707963267948966"},
    {"rpy=\"0 0 0.5\"", "rpy=\"0 -45 0\"",
     "3: link \"arm\": <origin>: rpy: -45 rad is 7.2 turns; if it is in degrees, write "
     "-0.7853981633974483"},
    {"rpy=\"0 0 1.5\"", "rpy=\"0 0 6.2832\"", ""},  // a turn to five digits
    {"lower=\"-1.5\" upper=\"1.5\"", "lower=\"1.5\" upper=\"-1.5\"",
     "4: joint \"elbow\": <limit>: lower 1.5 is above upper -1.5"},
    {"lower=\"-1.5\" upper=\"1.5\"", "lower=\"-90\" upper=\"90\"",
     "4: joint \"elbow\": <limit>: -90 to 90 rad is up to 14.3 turns; if it is in degrees, write "
     "lower=\"-1.5707963267948966\" upper=\"1.5707963267948966\""},
    // two turns in radians, and what is more than two turns in degrees, too: meant as no limit
    {"lower=\"-1.5\" upper=\"1.5\"", "lower=\"-12.566\" upper=\"12.566\"", ""},
    {"lower=\"-1.5\" upper=\"1.5\"", "lower=\"-1000\" upper=\"1000\"", ""},
    {"revolute\"><origin xyz=\"1 0 0\" rpy=\"0 0 1.5\"/>", "continuous\">", ""},
    {kInertial, "",
     "3: link \"arm\": neither it nor what it carries has an <inertial>: joint \"elbow\" moves 0 kg"},
    {"</robot>",
     "<link name=\"tip\"/><joint name=\"weld\" type=\"fixed\"><parent link=\"arm\"/><child link=\"tip\"/></joint></robot>",
     ""},
    // what the reader refuses
    {"<robot", "<robots", ""},
    {"value=\"1\"", "value=\"1x\"", ""},
};

}  // namespace

BOOST_AUTO_TEST_CASE(a_sound_file_has_no_remarks) {
  BOOST_TEST(remarksOnUrdf(robot(kInertial, kJoint), "r.urdf") == Lines{},
             boost::test_tools::per_element());
}

BOOST_DATA_TEST_CASE(a_slip_is_told_at_its_place, data::make(kSlips), slip) {
  const Lines expected = slip.said.empty() ? Lines{} : Lines{"r.urdf:" + slip.said};
  BOOST_TEST(remarksOnUrdf(with(slip.from, slip.to), "r.urdf") == expected,
             boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(joints_that_move_nothing_are_told_in_one_line) {
  // the hand's only inertial is carried by a further joint: that one and "wrist" move it
  const std::string text =
      "<robot name=\"r\">\n<link name=\"base\"/>\n<link name=\"arm\"/>\n<link name=\"finger\"/>\n"
      "<link name=\"thumb\"/>\n<link name=\"hand\">" +
      kInertial +
      "</link>\n"
      "<joint name=\"wrist\" type=\"revolute\"><parent link=\"base\"/><child link=\"arm\"/></joint>\n"
      "<joint name=\"turn\" type=\"revolute\"><parent link=\"arm\"/><child link=\"hand\"/></joint>\n"
      "<joint name=\"a\" type=\"revolute\"><parent link=\"hand\"/><child link=\"finger\"/></joint>\n"
      "<joint name=\"b\" type=\"revolute\"><parent link=\"hand\"/><child link=\"thumb\"/></joint>\n"
      "</robot>\n";
  BOOST_TEST(remarksOnUrdf(text, "r.urdf") ==
                 Lines{"r.urdf:4: link \"finger\": neither it nor what it carries has an "
                       "<inertial>: joint \"a\" moves 0 kg, and another joint does"},
             boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(many_remarks_are_counted) {
  std::string axes;
  for (int k = 0; k < 25; ++k) axes += "<axes/>";
  const Lines said = remarksOnUrdf(with("<axis", axes + "<axis"), "r.urdf");
  BOOST_TEST_REQUIRE(said.size() == 21u);
  BOOST_TEST(said[20] == "r.urdf: ... and 5 more remarks");
}

BOOST_AUTO_TEST_CASE(angles_of_a_scene_are_told_but_those_with_pi) {
  const auto arm = [](const std::string& turn, const std::string& start) {
    const std::string text =
        "[[link]]\nname = \"base\"\n\n[[link]]\nname = \"arm\"\nparent = \"base\"\nmass = 1\n"
        "com = [1, 0, 0]\njoint = { kind = \"revolute\", rpy = [0, " +
        turn +
        ", 0] }\n[[link]]\nname = \"slide\"\nparent = \"arm\"\nmass = 1\n"
        "joint = { kind = \"prismatic\" }\n[start]\nq = [" +
        start + ", 90]\n";
    return remarksOnAngles(readSceneToml(text, "arm.toml"), "arm.toml");
  };
  const std::string said = "90 rad is 14.3 turns; if it is in degrees, write \"90*pi/180\"";
  BOOST_TEST(arm("90", "1") == Lines{"arm.toml:4: joint \"arm\": rpy: " + said},
             boost::test_tools::per_element());
  BOOST_TEST(arm("1", "90") == Lines{"arm.toml: [start]: q1: " + said},
             boost::test_tools::per_element());
  BOOST_TEST(arm("\"90*pi/180\"", "\"13*pi/2\"") == Lines{}, boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(no_bundled_scene_has_a_remark) {
  for (const auto& file : bundledScenes())
    BOOST_TEST(remarksOn(readScene(file), file) == Lines{}, boost::test_tools::per_element());
}

// 6.2832 and 6.6 rad: 1.0000 and 1.0504 turns
BOOST_AUTO_TEST_CASE(what_is_printed_as_one_turn_is_none_too_many) {
  BOOST_TEST(moreThanATurn(6.2832, AngleSpelling::kDecimal) == "");
  BOOST_TEST(moreThanATurn(-6.6, AngleSpelling::kExpression) ==
             "-6.6 rad is 1.1 turns; if it is in degrees, write -6.6*pi/180");
}
