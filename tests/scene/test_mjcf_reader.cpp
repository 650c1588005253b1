// SPDX-License-Identifier: GPL-3.0-or-later
// MJCF: decimals stay what they are, what is outside the subset is refused by name with file and
// line, and hostile files end in words. What MuJoCo makes of the same bytes is asked in
// tests/crosscheck/readers/test_mjcf.cpp.
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE mjcf_reader
#include "scene/mjcf.hpp"

#include <filesystem>
#include <fstream>

#include <unistd.h>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "scene/formats.hpp"

namespace data = boost::unit_test::data;
namespace fs = std::filesystem;
using namespace dynwitness::scene;

namespace {

Scene read(const std::string& inside, const std::string& file = "robot.xml") {
  return readSceneMjcf("<mujoco>\n" + inside + "\n</mujoco>", file);
}
/// One hinge, with something in its body, its joint, its shape, or beside the world.
std::string arm(const std::string& in_body = "", const std::string& of_joint = "",
                const std::string& geom = "<geom size='0.1' pos='0.1 0 0'/>",
                const std::string& beside = "") {
  return beside + "<worldbody><body name='arm'><joint name='j' axis='0 1 0' " + of_joint + "/>" +
         geom + in_body + "</body></worldbody>";
}
std::string text(const Vector& v) {
  return v[0].text() + " " + v[1].text() + " " + v[2].text();
}
std::string refusal(const std::string& inside) {
  try {
    read(inside);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read";
}

struct Refused {
  std::string inside, message;
};
std::ostream& operator<<(std::ostream& out, const Refused& refused) {
  return out << refused.message;
}

const Refused kRefused[] = {
    {"<compiler angle='grad'/>" + arm(), "<compiler>: angle is \"grad\", allowed: degree, radian"},
    {"<compiler coordinate='global'/>" + arm(), "coordinate is \"global\", allowed: local"},
    {"<compiler eulerseq='xy'/>" + arm(), "eulerseq is \"xy\", allowed: three of x, y, z, X, Y, Z"},
    {"<compiler alignfree='true'/>" + arm(), "alignfree=\"true\" is not in the subset"},
    {"<option density='1.2'/>" + arm(), "density is 1.2: forces of a fluid are not modelled"},
    {"<option><flag passive='disable'/></option>" + arm(), "passive is disable"},
    {"<extension/>" + arm(), "robot.xml:2: <extension>: not in the subset that is read"},
    {"<default class='other'/>" + arm(), "class is \"other\", allowed for the outermost: main"},
    {"<default><default class='a'><default class='a'/></default></default>" + arm(),
     "class \"a\" exists already, allowed: each name once"},
    {arm("", "class='none'"), "class is \"none\", allowed: a class of a <default>"},
    {arm("<composite/>"),
     "robot.xml:2: <composite>: not in the subset that is read, allowed in "
     "<body>: inertial, joint"},
    {arm("<frame><body/></frame>"), "<frame>: not in the subset"},
    {arm("", "springdamper='0.1 1'"), "springdamper is not in the subset"},
    {arm("", "damping='nan'"), "<joint>: damping is \"nan\", not finite"},
    {arm("", "damping='1e400'"), "<joint>: damping: expression \"1e400\": not finite"},
    {arm("", "damping='1 2'"), "damping has 2 numbers, allowed: 1"},
    {arm("", "type='ball' stiffness='1'"), "stiffness is 1 at a ball joint, which is not modelled"},
    {arm("", "type='free' damping='1'"), "damping is 1 at a free joint"},
    {"<worldbody><body><joint axis='0 0 0'/><geom size='1'/></body></worldbody>",
     "axis is [0, 0, 0]"},
    {arm("", "type='screw'"), "type is \"screw\", allowed: hinge, slide, ball, free"},
    {arm("<joint type='ball'/><joint/>"), "turns after a ball in the same body"},
    {arm("<freejoint/>"), "the joints of its body have more than 6"},
    {arm("<body name='b'><freejoint/></body>"), "is free, allowed: the only joint of a body in"},
    {arm("<body name='arm'/>"), "name \"arm\" is taken by another body"},
    {arm("<body><joint name='j'/></body>"), "name \"j\" is taken by another joint"},
    {arm("", "", "<geom type='mesh' mesh='m'/>"), "its mass and inertia come from a mesh"},
    {arm("", "", "<geom type='box' size='1 1'/>"), "type box has 2 sizes, allowed: 3"},
    {arm("", "", "<geom size='-1'/>"), "size is not above zero"},
    {arm("", "", "<geom size='1' shellinertia='true'/>"), "shellinertia is true"},
    {arm("", "", "<geom size='1' colour='red'/>"), "<geom>: colour=\"red\" is not in the subset"},
    {arm("", "", "<geom type='capsule' size='.1' fromto='0 0 0 0 0 0'/>"), "two equal points"},
    {arm("", "", "<geom size='1' quat='0 0 0 0'/>"), "quat is 0 0 0 0, allowed: any other"},
    {arm("", "", "<geom size='1' quat='1 0 0 0' euler='1 0 0'/>"),
     "euler and quat are both given, by it or its class"},
    {arm("", "", "<geom size='1e200'/>"),
     "what follows from its numbers is too large or too small"},
    {arm("", "", "<inertial pos='0 0 0' diaginertia='1 1 1'/>"), "<inertial>: has no mass"},
    {arm("", "", "<inertial mass='1' pos='0 0 0' diaginertia='1 1 3'/>"),
     "principal moments of inertia about the centre of mass are 1, 1, 3 kg m^2"},
    {arm("", "", "<inertial mass='1' pos='0 0 0' fullinertia='1 1 1 0 0 0' quat='1 1 0 0'/>"),
     "fullinertia with an orientation: versions of MuJoCo differ"},
    {"<compiler settotalmass='1'/><worldbody><body><geom type='mesh'/></body></worldbody>",
     "its mass comes from a mesh"},
    {arm() + "<equality><joint joint1='j' polycoef='1 0 0 0 0'/></equality>", "has no joint2"},
    {arm("<body><joint name='k'/><geom size='1'/></body>") +
         "<equality><joint joint1='j' joint2='k' polycoef='0 1 2 0 0'/></equality>",
     "polycoef is 0 1 2 0 0, allowed: a straight line"},
    {arm() + "<equality><connect body1='arm' site1='s'/></equality>", "site1=\"s\" is not in the"},
    {arm() + "<equality><connect body1='none' anchor='0 0 0'/></equality>",
     "body1 is \"none\", allowed: the name of a body"},
    {arm() + "<keyframe><key qpos='1 2'/></keyframe>", "qpos has 2 numbers, allowed: 1"},
    {"<include file='nowhere.xml'/>" + arm(), "\"nowhere.xml\" does not exist"},
    {arm("", "", ""), "nothing that it carries has mass"},
};

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

BOOST_AUTO_TEST_CASE(decimals_and_degrees_stay_what_they_are) {
  const Scene scene = read(
      "<worldbody><body name='a' pos='0.1 .2 1e-3' euler='0 0 90'><joint name='j' ref='30'"
      " stiffness='2' springref='45' damping='0.1' frictionloss='0.2' armature='0.3'/>"
      "<inertial pos='0.1 0 0' mass='0.7' diaginertia='0.01 0.02 0.025' euler='57.29578 0 0'/>"
      "</body></worldbody>");
  BOOST_REQUIRE(scene.mechanism.links.size() == 2u);
  const Link& link = scene.mechanism.links[1];
  BOOST_TEST(link.name == "a");
  BOOST_TEST(link.joint.name == "j");
  BOOST_TEST(text(link.joint.placement.xyz) == "0.1 .2 1e-3");
  BOOST_TEST(text(link.joint.placement.rpy) == "0 0 pi/2");
  BOOST_TEST(link.joint.friction.viscous.text() == "0.1");
  BOOST_TEST(link.joint.friction.negative.text() == "0.2");
  BOOST_TEST(link.joint.rotor_inertia.text() == "0.3");
  BOOST_TEST((exactValue(link.joint.rest, {}) == Exact{0, Rational(1, 12)}));
  BOOST_TEST(text(link.inertia.rpy) == "57.29578*pi/180 0 0");
  BOOST_TEST(text({link.inertia.xx, link.inertia.yy, link.inertia.zz}) == "0.01 0.02 0.025");
  BOOST_TEST(text(scene.mechanism.gravity) == "0 0 -9.81");
  BOOST_REQUIRE(scene.not_modelled.size() == 1u);
  BOOST_TEST(scene.not_modelled[0] == "joint j: ref pi/6 not modelled: q is MuJoCo's less that");
}

// by hand: m = 4/3 pi r^3 1000, I = 2/5 m r^2
BOOST_AUTO_TEST_CASE(a_sphere_has_the_mass_and_inertia_of_a_sphere) {
  const MassProperties m = read(arm()).mechanism.links[1].inertia;
  const double mass = 4.18879020478639098462;
  BOOST_TEST(exactValue(m.mass, {}).toDouble() == mass);
  BOOST_TEST(std::abs(exactValue(m.xx, {}).toDouble() - 0.4 * mass * 0.01) < 1e-17);
}

BOOST_AUTO_TEST_CASE(several_joints_are_a_row_of_links_and_anchors_are_where_they_are) {
  const Scene scene = read(
      "<worldbody><body name='b' pos='1 2 3'><joint name='s' type='slide' axis='1 0 0'/>"
      "<joint name='h' axis='0 1 0' pos='0.1 0 0.2'/><joint name='k' pos='0.3 0 0'/>"
      "<inertial pos='0.5 0 0' mass='1' diaginertia='1 1 1'/>"
      "<body name='c' pos='0.4 0 0'><joint/><geom size='1'/></body></body></worldbody>");
  const auto& links = scene.mechanism.links;
  BOOST_REQUIRE(links.size() == 5u);
  BOOST_TEST(links[1].name == "b.s");
  BOOST_TEST(links[2].name == "b.h");
  BOOST_TEST(links[3].name == "b");
  BOOST_TEST(text(links[1].joint.placement.xyz) == "1 2 3");
  BOOST_TEST(text(links[2].joint.placement.xyz) == "0.1 0 0.2");
  BOOST_TEST(text(links[3].joint.placement.xyz) == "0.2 0 -0.2");
  BOOST_TEST(text(links[3].inertia.com) == "0.2 0 0");
  BOOST_TEST(text(links[4].joint.placement.xyz) == "0.1 0 0");
  BOOST_TEST(links[4].joint.name == "joint_4");
}

BOOST_AUTO_TEST_CASE(a_free_body_starts_where_it_stands) {
  const Scene scene = read(
      "<worldbody><body name='b' pos='1 2 3' quat='2 0 0 1'><freejoint/><geom size='1'/>"
      "</body></worldbody>");
  std::string q;
  for (const Number& n : scene.start_q) q += n.text() + " ";
  BOOST_TEST(q == "1 2 3 2 0 0 1 ");
  BOOST_TEST(text(scene.mechanism.links[1].joint.placement.xyz) == "0 0 0");
}

BOOST_AUTO_TEST_CASE(what_is_not_modelled_is_said) {
  const Scene scene = read(arm("<site/><site/><camera/>", "range='-1 1'") +
                           "<actuator><motor joint='j'/><motor joint='j'/></actuator>"
                           "<keyframe><key name='home' qpos='0.5' ctrl='1 1'/><key/></keyframe>");
  BOOST_REQUIRE(scene.not_modelled.size() == 4u);
  BOOST_TEST(scene.not_modelled[0] == "keyframe home is the start; what else it says not modelled");
  BOOST_TEST(scene.not_modelled[1] == "1 more keyframes not modelled");
  BOOST_TEST(scene.not_modelled[2] == "1 camera, 1 geom, 2 of <actuator>, 2 site not modelled");
  BOOST_TEST(scene.not_modelled[3] == "joint limits not modelled");
  BOOST_TEST(scene.start_q[0].text() == "0.5");
}

BOOST_AUTO_TEST_SUITE_END()
BOOST_AUTO_TEST_SUITE(identities)

// exactly: decimals and quarter turns come back as they were
BOOST_AUTO_TEST_CASE(what_is_written_is_read_as_the_same_text) {
  for (const char* name : {"joints.xml", "classes.xml", "closed.xml", "shapes.xml"}) {
    const Scene scene = readScene(fs::path(DYNWITNESS_SOURCE_DIR) / "tests/scene/mjcf" / name);
    std::vector<std::string> lost;
    const std::string once = writeSceneMjcf(scene, &lost);
    BOOST_TEST(lost.empty(), name);
    const Scene again = readSceneMjcf(once, "again.xml");
    BOOST_TEST(again.mechanism.links.size() == scene.mechanism.links.size());
    BOOST_TEST(writeSceneMjcf(again, &lost) == once, name);
  }
}

BOOST_AUTO_TEST_SUITE_END()
BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_DATA_TEST_CASE(what_is_outside_the_subset_is_refused_by_name, data::make(kRefused)) {
  const std::string said = refusal(sample.inside);
  BOOST_TEST(said.find(sample.message) != std::string::npos, said);
  BOOST_TEST(said.rfind("robot.xml:", 0) == 0u, said);
}

BOOST_AUTO_TEST_CASE(files_that_include_themselves_are_refused) {
  const fs::path folder =
      fs::temp_directory_path() / ("dynwitness_mjcf_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const auto write = [&](const char* name, const std::string& text) {
    std::ofstream(folder / name) << text;
  };
  write("a.xml", "<mujoco><include file='b.xml'/>" + arm() + "</mujoco>");
  write("b.xml", "<mujoco>\n<include file='./a.xml'/></mujoco>");
  BOOST_CHECK_EXCEPTION(readScene(folder / "a.xml"), InputError, [&](const InputError& error) {
    return std::string(error.what())
               .find("b.xml:2: <include>: \"" + (folder / "a.xml").string() +
                     "\" was read already") != std::string::npos;
  });
  fs::remove_all(folder);
}

BOOST_AUTO_TEST_CASE(deep_files_are_read_to_the_depth_that_mujoco_takes) {
  const auto nested = [](int bodies) {
    std::string open, close;
    for (int k = 0; k < bodies; ++k) {
      open += "<body><joint axis='0 1 0'/><geom size='.1' pos='0.1 0 0'/>";
      close += "</body>";
    }
    return "<worldbody>" + open + close + "</worldbody>";
  };
  BOOST_TEST(read(nested(490)).mechanism.dof() == 490);
  BOOST_TEST(refusal(nested(500)) == "robot.xml: more than 500 elements inside one another");
  BOOST_TEST(refusal(nested(100000)) == "robot.xml: more than 500 elements inside one another");
}

BOOST_AUTO_TEST_SUITE_END()
