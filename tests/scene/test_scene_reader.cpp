// SPDX-License-Identifier: GPL-3.0-or-later
#include <unistd.h>
#include <urdf_parser/urdf_parser.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <Eigen/Geometry>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "scene/scene.hpp"

namespace data = boost::unit_test::data;
namespace fs = std::filesystem;
using namespace dynwitness::scene;

namespace {

const std::string kDoublePendulum = R"(title = "Double pendulum"
source = "textbook mechanism; parameters chosen here"
gravity = [0, 0, "-g"]

[parameters]
z = 2          # read before g and a, although they come first in the alphabet
g = 9.81
a = "z/4"

[[link]]
name = "base"

[[link]]
name = "upper"
parent = "base"
mass = "z"
com = ["a/2", 0, 0]
inertia = { about = "com", yy = "z*a^2/12", zz = "z*a^2/12", xy = -0.0 }

[link.joint]
name = "shoulder"
kind = "revolute"
axis = [0, 1, 0]
xyz = [0, 0, 1_000.5]
rpy = ["pi/2", 0, 0]
rotor_inertia = 2e-4
gear_ratio = 100
stiffness = 3
rest = 0x10

[[link]]
name = "lower"
parent = "upper"
mass = 1
com = [0, 0,
  0.4318]
inertia = { about = "origin", xx = 0.25, yy = 0.25, rpy = [0, 0, 1] }
joint = { kind = "prismatic", mdh = { a = "a", alpha = "-pi/2" } }

[[wrench]]
link = "lower"
force = [0, 0, 1]
at = ["a", 0, 0]
axes = "world"

[start]
q = ["pi/2", 0]
qd = [0, -1.5]
)";

const std::string kArm = R"(<?xml version="1.0"?>
<!-- a comment -->
<robot name="arm">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="tool">
    <inertial>
      <origin xyz="0.01 -0.02 0.03" rpy="1.570796326794897 0.1 -3.141592653589793"/>
      <mass value="0.4318"/>
      <inertia ixx="0.02" iyy="0.03" izz="0.025" ixy="-0.001" ixz="2e-3" iyz="0"/>
    </inertial>
  </link>
  <link name="base"/>
  <link name="slide"><inertial><mass value="2."/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="turn"><inertial><mass value="3"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j3" type="fixed">
    <origin xyz="0 0 0.1" rpy="0 1.5708 0"/><parent link="turn"/><child link="tool"/>
  </joint>
  <joint name="j2" type="revolute">
    <origin rpy="0.1 0.2 0.3"/><parent link="slide"/><child link="turn"/>
    <axis xyz="0.6 0 0.8"/><limit effort="1" velocity="1" lower="-1" upper="1"/>
    <dynamics damping="0.5" friction="0.0"/>
  </joint>
  <joint name="j1" type="prismatic">
    <parent link="base"/><child link="slide"/>
    <limit effort="1" velocity="1"/><dynamics damping="0" friction="0.25"/><mimic joint="j2"/>
  </joint>
</robot>
)";

/// The value of a number in a scene.
double in(const Scene& scene, const Number& n) {
  return exactValue(n, scene.mechanism.parameterValues()).toDouble();
}

Eigen::Vector3d in(const Scene& scene, const Vector& v) {
  return {in(scene, v[0]), in(scene, v[1]), in(scene, v[2])};
}

/// A chain of steps as a homogeneous matrix, by Eigen.
Eigen::Matrix4d matrix(const std::vector<Step>& steps) {
  const auto number = [](const Number& n) { return exactValue(n, {}).toDouble(); };
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (const Step& step : steps) {
    const Vector& t = step.translation;
    switch (step.kind) {
      case Step::Kind::kTranslate:
        T.translate(Eigen::Vector3d(number(t[0]), number(t[1]), number(t[2])));
        break;
      case Step::Kind::kRotateX:
        T.rotate(Eigen::AngleAxisd(number(step.angle), Eigen::Vector3d::UnitX()));
        break;
      case Step::Kind::kRotateY:
        T.rotate(Eigen::AngleAxisd(number(step.angle), Eigen::Vector3d::UnitY()));
        break;
      case Step::Kind::kRotateZ:
        T.rotate(Eigen::AngleAxisd(number(step.angle), Eigen::Vector3d::UnitZ()));
        break;
    }
  }
  return T.matrix();
}

std::string linksInOrder(const std::string& text) {
  const Scene scene = readSceneToml(text, "order.toml");
  std::string names;
  for (const Link& link : scene.mechanism.links) {
    names += link.name;
    if (link.parent >= 0)
      names += "<" + scene.mechanism.links.at(static_cast<std::size_t>(link.parent)).name;
    names += " ";
  }
  return names;
}

std::string fixedLink(const std::string& name, const std::string& parent) {
  if (parent.empty()) return "[[link]]\nname = \"" + name + "\"\n";
  return "[[link]]\nname = \"" + name + "\"\nparent = \"" + parent +
         "\"\njoint = { kind = \"fixed\" }\n";
}

/// A folder of its own for files of one test, removed at the end.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("dynwitness_test_" + std::to_string(::getpid()))) {
    fs::create_directories(path_ / "scenes");
  }
  ~Folder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
  }

 private:
  fs::path path_;
};

}  // namespace

BOOST_AUTO_TEST_SUITE(toml)

BOOST_AUTO_TEST_CASE(every_key_of_the_format_arrives_in_its_place) {
  const Scene scene = readSceneToml(kDoublePendulum, "some/folder/pendulum.toml");
  const Mechanism& m = scene.mechanism;
  BOOST_TEST(scene.name == "pendulum");
  BOOST_TEST(scene.title == "Double pendulum");
  BOOST_TEST(scene.source == "textbook mechanism; parameters chosen here");
  BOOST_TEST(m.has_gravity);
  BOOST_TEST(m.gravity[2].text() == "-g");
  BOOST_REQUIRE(m.parameters.size() == 3u);
  BOOST_TEST(m.parameters[0].name == "z");
  BOOST_TEST(m.parameters[1].name == "g");
  BOOST_TEST(m.parameters[2].name == "a");
  BOOST_TEST(m.parameters[2].value.text() == "z/4");
  BOOST_TEST(m.parameters[2].where.text() == "some/folder/pendulum.toml:8");
  BOOST_REQUIRE(m.links.size() == 3u);
  BOOST_TEST(m.dof() == 2);
  BOOST_TEST((m.movingLinks() == std::vector<int>{1, 2}));

  const Link& upper = m.links[1];
  BOOST_TEST(upper.parent == 0);
  BOOST_TEST(upper.where.line == 13);
  BOOST_TEST(upper.inertia.mass.text() == "z");
  BOOST_TEST(upper.inertia.com[0].text() == "a/2");
  BOOST_TEST(upper.inertia.xx.isLiteralZero());
  BOOST_TEST(upper.inertia.xy.isLiteralZero());
  BOOST_TEST(upper.inertia.zz.text() == "z*a^2/12");
  BOOST_TEST((upper.inertia.about == MassProperties::About::kCenterOfMass));
  BOOST_TEST(upper.joint.name == "shoulder");
  BOOST_TEST((upper.joint.kind == JointKind::kRevolute));
  BOOST_TEST(in(scene, upper.joint.axis) == Eigen::Vector3d(0, 1, 0));
  BOOST_TEST(upper.joint.placement.xyz[2].text() == "1000.5");
  BOOST_TEST(upper.joint.placement.rpy[0].text() == "pi/2");
  BOOST_TEST(upper.joint.rotor_inertia.text() == "2e-4");
  BOOST_TEST(upper.joint.gear_ratio.text() == "100");
  BOOST_TEST(upper.joint.stiffness.text() == "3");
  BOOST_TEST(upper.joint.rest.text() == "16");

  const Link& lower = m.links[2];
  BOOST_TEST((lower.inertia.com[2].number() == Rational(4318, 10000)));
  BOOST_TEST((lower.inertia.about == MassProperties::About::kLinkOrigin));
  BOOST_TEST(lower.inertia.rpy[2].text() == "1");
  BOOST_TEST(lower.joint.name == "lower");  // the link's name when left out
  BOOST_TEST((lower.joint.kind == JointKind::kPrismatic));
  BOOST_TEST((lower.joint.placement.convention == Placement::Convention::kMdh));
  BOOST_TEST(lower.joint.placement.alpha.text() == "-pi/2");
  BOOST_TEST(lower.joint.placement.theta.isLiteralZero());
  BOOST_TEST(in(scene, lower.joint.axis) == Eigen::Vector3d(0, 0, 1));

  BOOST_REQUIRE(m.wrenches.size() == 1u);
  BOOST_TEST(m.wrenches[0].link == 2);
  BOOST_TEST(in(scene, m.wrenches[0].force) == Eigen::Vector3d(0, 0, 1));
  BOOST_TEST(in(scene, m.wrenches[0].at) == Eigen::Vector3d(0.5, 0, 0));
  BOOST_TEST((m.wrenches[0].axes == Wrench::Axes::kWorld));
  BOOST_TEST(scene.start_q[0].text() == "pi/2");
  BOOST_TEST(scene.start_qd[1].text() == "-1.5");
}

BOOST_AUTO_TEST_CASE(what_is_left_out_is_not_there) {
  const Scene scene = readSceneToml(
      "[[link]]\nname = \"base\"\n[[link]]\nname = \"a\"\nparent = \"base\"\nmass = 1\n"
      "joint = { kind = \"prismatic\" }\n",
      "short.toml");
  BOOST_TEST(!scene.mechanism.has_gravity);
  BOOST_TEST(scene.title.empty());
  BOOST_TEST(scene.start_q.size() == 1u);
  BOOST_TEST(scene.start_q[0].isLiteralZero());
  BOOST_TEST(scene.mechanism.links[1].joint.gear_ratio.text() == "1");
  BOOST_TEST(scene.mechanism.links[1].joint.placement.beforeJoint().empty());
  BOOST_TEST(scene.mechanism.links[1].joint.placement.afterJoint().empty());
}

BOOST_AUTO_TEST_CASE(numbers_are_exact_wherever_they_stand_on_a_line) {
  const Scene scene = readSceneToml(
      "\xEF\xBB\xBFgravity = [0.1, 1_0.000_1, -1e-3]\r\n[parameters]\r\na = 1 # \xC3\xA9\r\n"
      "[[link]]\r\nname = \"\xE6\xA9\x9F\xC3\xA9\"\r\n[[link]]\r\nname = \"b\"\r\n"
      "parent = \"\xE6\xA9\x9F\xC3\xA9\"\r\n"
      "joint = { name = \"\xE6\xA9\x9F\xC3\xA9\", kind = \"fixed\", xyz = [0.3, +0.7, 1.0e+2] }",
      "exact.toml");
  const Mechanism& m = scene.mechanism;
  BOOST_TEST((m.gravity[0].number() == Rational(1, 10)));
  BOOST_TEST((m.gravity[1].number() == Rational(100001, 10000)));
  BOOST_TEST((exactValue(m.gravity[2], {}).rational == Rational(-1, 1000)));
  BOOST_TEST((m.links[1].joint.placement.xyz[0].number() == Rational(3, 10)));
  BOOST_TEST((m.links[1].joint.placement.xyz[1].number() == Rational(7, 10)));
  BOOST_TEST((m.links[1].joint.placement.xyz[2].number() == Rational(100)));
}

BOOST_AUTO_TEST_CASE(links_keep_the_order_of_the_file_but_for_parents_before_children) {
  BOOST_TEST(linksInOrder(fixedLink("r", "") + fixedLink("b", "r") + fixedLink("a", "b") +
                          fixedLink("c", "r")) == "r b<r a<b c<r ");
  BOOST_TEST(linksInOrder(fixedLink("c", "b") + fixedLink("d", "a") + fixedLink("a", "") +
                          fixedLink("b", "a")) == "a d<a b<a c<b ");
}

BOOST_AUTO_TEST_CASE(a_chain_of_five_thousand_links_written_tip_first_is_arranged) {
  std::string text;
  const int n = 5000;
  for (int i = n; i > 0; --i) text += fixedLink(std::to_string(i), std::to_string(i - 1));
  text += fixedLink("0", "");
  const Scene scene = readSceneToml(text, "chain.toml");
  BOOST_TEST(scene.mechanism.links.size() == static_cast<std::size_t>(n + 1));
  BOOST_TEST(scene.mechanism.links.back().name == std::to_string(n));
  BOOST_TEST(scene.mechanism.links.back().parent == n - 1);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(placements)

BOOST_AUTO_TEST_CASE(xyz_rpy_moves_then_turns_yaw_pitch_roll) {
  Placement p;
  p.xyz = {1, 2, 3};
  p.rpy = {Number::parse("0.3"), Number::parse("-0.4"), Number::parse("0.5")};
  // the matrix of URDF's and most books' roll, pitch, yaw, written out
  const double cr = std::cos(0.3), sr = std::sin(0.3), cp = std::cos(-0.4), sp = std::sin(-0.4);
  const double cy = std::cos(0.5), sy = std::sin(0.5);
  Eigen::Matrix4d expected;
  expected << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, 1,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, 2,          //
      -sp, cp * sr, cp * cr, 3,                                            //
      0, 0, 0, 1;
  BOOST_TEST((matrix(p.beforeJoint()) - expected).norm() < 1e-15);
  BOOST_TEST(p.afterJoint().empty());
}

BOOST_AUTO_TEST_CASE(dh_follows_the_joint_with_the_matrix_of_the_books) {
  Placement p;
  p.convention = Placement::Convention::kDh;
  p.a = Number::parse("0.7");
  p.alpha = Number::parse("0.3");
  p.d = Number::parse("0.2");
  p.theta = Number::parse("0.5");
  const double ct = std::cos(0.5), st = std::sin(0.5), ca = std::cos(0.3), sa = std::sin(0.3);
  Eigen::Matrix4d expected;                     // e.g. Spong, Hutchinson, Vidyasagar, eq. (3.10)
  expected << ct, -st * ca, st * sa, 0.7 * ct,  //
      st, ct * ca, -ct * sa, 0.7 * st,          //
      0, sa, ca, 0.2,                           //
      0, 0, 0, 1;
  BOOST_TEST((matrix(p.afterJoint()) - expected).norm() < 1e-15);
  BOOST_TEST(p.beforeJoint().empty());
}

BOOST_AUTO_TEST_CASE(mdh_precedes_the_joint_with_craigs_matrix) {
  Placement p;
  p.convention = Placement::Convention::kMdh;
  p.a = Number::parse("0.7");
  p.alpha = Number::parse("0.3");
  p.d = Number::parse("0.2");
  p.theta = Number::parse("0.5");
  const double ct = std::cos(0.5), st = std::sin(0.5), ca = std::cos(0.3), sa = std::sin(0.3);
  Eigen::Matrix4d expected;              // Craig, Introduction to Robotics, eq. (3.6)
  expected << ct, -st, 0, 0.7,           //
      st * ca, ct * ca, -sa, -sa * 0.2,  //
      st * sa, ct * sa, ca, ca * 0.2,    //
      0, 0, 0, 1;
  BOOST_TEST((matrix(p.beforeJoint()) - expected).norm() < 1e-15);
  BOOST_TEST(p.afterJoint().empty());
}

BOOST_AUTO_TEST_CASE(steps_of_literal_zeros_are_left_out) {
  Placement p;
  p.rpy[1] = Number::parse("pi/2");
  BOOST_REQUIRE(p.beforeJoint().size() == 1u);
  BOOST_TEST((p.beforeJoint()[0].kind == Step::Kind::kRotateY));
  p.rpy[1] = Number::parse("1-1");  // zero, but not literally: the author's symbols stay
  BOOST_TEST(p.beforeJoint().size() == 1u);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(writing)

BOOST_AUTO_TEST_CASE(a_written_scene_is_the_text_that_its_author_would_write) {
  const std::string expected = R"(title = "Double pendulum"
source = "textbook mechanism; parameters chosen here"
gravity = [0, 0, "-g"]

[parameters]
z = 2
g = 9.81
a = "z/4"

[[link]]
name = "base"

[[link]]
name = "upper"
parent = "base"
mass = "z"
com = ["a/2", 0, 0]
inertia = { yy = "z*a^2/12", zz = "z*a^2/12" }

[link.joint]
name = "shoulder"
kind = "revolute"
axis = [0, 1, 0]
xyz = [0, 0, 1000.5]
rpy = ["pi/2", 0, 0]
rotor_inertia = 2e-4
gear_ratio = 100
stiffness = 3
rest = 16

[[link]]
name = "lower"
parent = "upper"
mass = 1
com = [0, 0, 0.4318]
inertia = { about = "origin", rpy = [0, 0, 1], xx = 0.25, yy = 0.25 }

[link.joint]
kind = "prismatic"
mdh = { a = "a", alpha = "-pi/2" }

[[wrench]]
link = "lower"
force = [0, 0, 1]
at = ["a", 0, 0]
axes = "world"

[start]
q = ["pi/2", 0]
qd = [0, -1.5]
)";
  const std::string written = writeSceneToml(readSceneToml(kDoublePendulum, "pendulum.toml"));
  BOOST_TEST(written == expected);
  BOOST_TEST(writeSceneToml(readSceneToml(written, "pendulum.toml")) == expected);
}

// reading, writing and reading again keeps rotors geared to several rates
BOOST_AUTO_TEST_CASE(geared_rotors_are_written_as_they_were_read) {
  const std::string line =
      "rotors = [{ inertia = \"z*1e-3\", ratio = [100, \"-z\"] }, { inertia = 2e-4, ratio = [0, 3], "
      "axis = [1, 0, \"z\"] }]\n";
  const std::string text =
      "[parameters]\nz = 0.5\n[[link]]\nname = \"base\"\n[[link]]\nname = \"hand\"\nparent = "
      "\"base\"\nmass = 1\ninertia = { xx = 1, yy = 1, zz = 1 }\n[link.joint]\nkind = "
      "\"universal\"\n" +
      line;
  const Scene scene = readSceneToml(text, "hand.toml");
  const std::vector<Rotor>& rotors = scene.mechanism.links[1].joint.rotors;
  BOOST_REQUIRE(rotors.size() == 2u);
  BOOST_TEST(rotors[0].ratio[1].text() == "-z");
  BOOST_TEST(!rotors[0].axis);
  BOOST_TEST((*rotors[1].axis)[2].text() == "z");
  const std::string written = writeSceneToml(scene);
  BOOST_TEST(written.find(line) != std::string::npos, written);
  BOOST_TEST(writeSceneToml(readSceneToml(written, "hand.toml")) == written);
}

// reading, writing and reading again keeps closures and springs; names that only count are left out
BOOST_AUTO_TEST_CASE(closures_and_springs_are_written_as_they_were_read) {
  const std::string tail = R"([[closure]]
kind = "distance"
a = { link = "base" }
b = { link = "lower", xyz = [1, 0, 0] }
length = "2*z"

[[closure]]
kind = "hinge"
name = "elbow"
a = { link = "base", xyz = [0, "a", 0], rpy = [0, "pi/2", 0] }
b = { link = "lower" }

[[spring]]
a = { link = "upper", xyz = [0, 0, 0.25] }
b = { link = "base" }
stiffness = 50
rest = "z/3"
damping = 2

)";
  const std::string text = writeSceneToml(readSceneToml(kDoublePendulum, "pendulum.toml"));
  const std::string whole =
      text.substr(0, text.find("[start]")) + tail + text.substr(text.find("[start]"));
  const Scene scene = readSceneToml(whole, "pendulum.toml");
  BOOST_TEST(writeSceneToml(scene) == whole);
  BOOST_TEST_REQUIRE(scene.mechanism.closures.size() == 2u);
  BOOST_TEST((scene.mechanism.closures[0].kind == ClosureKind::kDistance));
  BOOST_TEST(scene.mechanism.closures[1].name == "elbow");
  BOOST_TEST(scene.mechanism.closures[1].b.link == 2);
  BOOST_TEST(scene.mechanism.springs.at(0).damping.text() == "2");
}

BOOST_AUTO_TEST_CASE(numbers_and_names_that_toml_cannot_spell_come_back) {
  Scene scene = readSceneToml(kDoublePendulum, "pendulum.toml");
  Mechanism& m = scene.mechanism;
  m.gravity = {Number::parse(".5"), Number::parse("5."), Number::parse("007")};
  m.links[1].inertia.com = {Number(Rational(-1, 3)), Number(Rational(Integer(1) << 70)),
                            Number::parse("1e-390")};
  m.links[1].joint.axis = {Number::parse("9223372036854775807"),
                           Number::parse("9223372036854775808"), Number::parse("-1e2")};
  m.links[1].name = "quote \" backslash \\ line\n tab\t bell\a \xC3\xA9";
  scene.title = "\"";
  const std::string written = writeSceneToml(scene);
  const Scene again = readSceneToml(written, "pendulum.toml");
  BOOST_TEST(writeSceneToml(again) == written);
  BOOST_TEST(again.title == scene.title);
  BOOST_TEST(again.mechanism.links[1].name == m.links[1].name);
  for (std::size_t i = 0; i < 3; ++i) {
    BOOST_TEST(again.mechanism.gravity[i].text() == m.gravity[i].text());
    const Link &a = again.mechanism.links[1], &b = m.links[1];
    BOOST_TEST(a.inertia.com[i].text() == b.inertia.com[i].text());
    BOOST_TEST(a.joint.axis[i].text() == b.joint.axis[i].text());
  }
}

BOOST_AUTO_TEST_CASE(a_dh_row_of_zeros_is_still_a_dh_row) {
  Scene scene = readSceneToml(kDoublePendulum, "pendulum.toml");
  scene.mechanism.links[2].joint.placement = {};
  scene.mechanism.links[2].joint.placement.convention = Placement::Convention::kDh;
  const Scene again = readSceneToml(writeSceneToml(scene), "pendulum.toml");
  BOOST_TEST((again.mechanism.links[2].joint.placement.convention == Placement::Convention::kDh));
}

BOOST_AUTO_TEST_CASE(every_bundled_scene_comes_back_as_it_was_written) {
  BOOST_TEST(!bundledScenes().empty());
  for (const fs::path& file : bundledScenes()) {
    const std::string written = writeSceneToml(readScene(file));
    BOOST_TEST(writeSceneToml(readSceneToml(written, file)) == written, file.string());
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(urdf_files)

BOOST_AUTO_TEST_CASE(elements_become_the_scene) {
  const Scene scene = readSceneUrdf(kArm, "arm.urdf");
  const Mechanism& m = scene.mechanism;
  BOOST_TEST(scene.title == "arm");
  BOOST_TEST(m.has_gravity);
  BOOST_TEST(in(scene, m.gravity) == Eigen::Vector3d(0, 0, -9.81));
  BOOST_REQUIRE(m.links.size() == 4u);
  BOOST_TEST(m.links[0].name == "base");
  BOOST_TEST(m.links[1].name == "slide");
  BOOST_TEST(m.links[2].name == "turn");
  BOOST_TEST(m.links[3].name == "tool");
  BOOST_TEST(m.links[3].where.line == 5);
  BOOST_TEST(m.links[0].inertia.mass.isLiteralZero());
  BOOST_TEST((m.links[3].inertia.mass.number() == Rational(4318, 10000)));
  BOOST_TEST(m.links[3].inertia.rpy[0].text() == "pi/2");
  BOOST_TEST(m.links[3].inertia.rpy[2].text() == "-pi");
  BOOST_TEST(m.links[3].joint.placement.rpy[1].text() == "1.5708");
  BOOST_TEST(m.links[3].inertia.xy.text() == "-0.001");  // the matrix's own sign
  BOOST_TEST(in(scene, m.links[1].joint.axis) == Eigen::Vector3d(1, 0, 0));  // URDF's default
  BOOST_TEST(m.dof() == 1);  // one of the two follows the other
}

BOOST_AUTO_TEST_CASE(what_is_not_modelled_is_said) {
  const std::vector<std::string> expected{"joint limits (position, velocity, effort) not modelled"};
  BOOST_TEST(readSceneUrdf(kArm, "arm.urdf").not_modelled == expected,
             boost::test_tools::per_element());
}

// urdfdom parses the same text with code of its own, down to quaternions
BOOST_AUTO_TEST_CASE(numbers_agree_with_urdfdom) {
  const Scene scene = readSceneUrdf(kArm, "arm.urdf");
  const auto model = urdf::parseURDF(kArm);
  BOOST_REQUIRE(model);
  const auto turn = [](const Eigen::Vector3d& rpy) -> Eigen::Matrix3d {
    return (Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) *
            Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
            Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX()))
        .toRotationMatrix();
  };
  const auto requirePose = [&](const Vector& xyz, const Vector& rpy, const urdf::Pose& pose) {
    const urdf::Rotation& r = pose.rotation;
    const Eigen::Matrix3d R = Eigen::Quaterniond(r.w, r.x, r.y, r.z).toRotationMatrix();
    const Eigen::Vector3d p(pose.position.x, pose.position.y, pose.position.z);
    BOOST_TEST(in(scene, xyz) == p);
    BOOST_TEST((turn(in(scene, rpy)) - R).norm() < 1e-14);
  };
  for (const Link& link : scene.mechanism.links) {
    const auto theirs = model->getLink(link.name);
    const MassProperties& i = link.inertia;
    if (theirs->inertial) {
      const urdf::Inertial& t = *theirs->inertial;
      BOOST_TEST(in(scene, i.mass) == t.mass);
      requirePose(i.com, i.rpy, t.origin);
      BOOST_TEST(in(scene, Vector{i.xx, i.yy, i.zz}) == Eigen::Vector3d(t.ixx, t.iyy, t.izz));
      BOOST_TEST(in(scene, Vector{i.xy, i.xz, i.yz}) == Eigen::Vector3d(t.ixy, t.ixz, t.iyz));
    } else {
      BOOST_TEST(i.mass.isLiteralZero());
    }
    if (link.parent < 0) continue;
    const auto joint = theirs->parent_joint;
    BOOST_TEST(link.joint.name == joint->name);
    BOOST_TEST(scene.mechanism.links.at(static_cast<std::size_t>(link.parent)).name ==
               joint->parent_link_name);
    requirePose(link.joint.placement.xyz, link.joint.placement.rpy,
                joint->parent_to_joint_origin_transform);
    if (link.joint.kind == JointKind::kFixed) continue;
    BOOST_TEST(in(scene, link.joint.axis) ==
               Eigen::Vector3d(joint->axis.x, joint->axis.y, joint->axis.z));
  }
}

std::string angleRead(const std::string& angle) {
  const Scene scene = readSceneUrdf(
      "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/>"
      "<joint name=\"j\" type=\"fixed\"><origin rpy=\"0 " +
          angle + " 0\"/><parent link=\"a\"/><child link=\"b\"/></joint></robot>",
      "angle.urdf");
  return scene.mechanism.links[1].joint.placement.rpy[1].text();
}

BOOST_AUTO_TEST_CASE(angles_that_mean_a_fraction_of_pi_are_recognised_by_sixteen_digits) {
  BOOST_TEST(angleRead("1.5707963267948966") == "pi/2");
  BOOST_TEST(angleRead("1.570796326794897") == "pi/2");
  BOOST_TEST(angleRead("-1.57079632679489661923") == "-pi/2");
  BOOST_TEST(angleRead("3.141592653589793") == "pi");
  BOOST_TEST(angleRead("-6.283185307179586") == "-2*pi");
  BOOST_TEST(angleRead("0.7853981633974483") == "pi/4");
  BOOST_TEST(angleRead("2.356194490192345") == "3*pi/4");
  BOOST_TEST(angleRead("1.0471975511965976") == "pi/3");
  BOOST_TEST(angleRead("0.52359877559829887") == "pi/6");
  for (const char* plain : {"1.5708", "1.57079632679", "3.14159265359", "0", "1e-17", "0.3",
                            "100.0", "1.5707963267949", "0.26179938779914943"}) {
    BOOST_TEST(angleRead(plain) == plain);
  }
}

BOOST_AUTO_TEST_CASE(a_urdf_scene_is_written_as_toml_and_read_again) {
  const Scene scene = readSceneUrdf(kArm, "arm.urdf");
  const std::string written = writeSceneToml(scene);
  const Scene again = readSceneToml(written, "arm.toml");
  BOOST_TEST(writeSceneToml(again) == written);
  BOOST_TEST(again.mechanism.links.size() == scene.mechanism.links.size());
  BOOST_TEST(in(again, again.mechanism.gravity) == Eigen::Vector3d(0, 0, -9.81));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(finding)

BOOST_AUTO_TEST_CASE(scenes_are_found_by_name_by_path_and_by_content) {
  const Folder folder;
  folder.write("scenes/double_pendulum.toml", kDoublePendulum);
  folder.write("scenes/arm.urdf", kArm);
  folder.write("scenes/README.md", "not a scene");
  folder.write("robot", "  \n" + kArm.substr(kArm.find("<robot")));
  ::setenv("DYNWITNESS_DATA", folder.path().c_str(), 1);
  BOOST_REQUIRE(bundledScenes().size() == 2u);
  BOOST_TEST(bundledScenes()[0].filename() == "arm.urdf");
  BOOST_TEST(bundledScenes()[1].filename() == "double_pendulum.toml");
  for (const char* name : {"double_pendulum", "double pendulum", "Double-Pendulum"}) {
    BOOST_TEST(findScene(name).name == "double_pendulum");
  }
  BOOST_TEST(findScene("arm").title == "arm");
  BOOST_TEST(findScene((folder.path() / "robot").string()).title == "arm");
  BOOST_CHECK_EXCEPTION(findScene("triple"), InputError, [](const InputError& error) {
    return std::string(error.what()) ==
           "no scene and no file is called \"triple\", allowed: one of the 2 that `dynwitness "
           "scenes` lists, four_bars_N with N from 1 to 200, chain_N, flat_chain_N or tree_N with "
           "N from 1 to 1000000, or the path of a file";
  });
  BOOST_CHECK_EXCEPTION(findScene("Double pendulm"), InputError, [](const InputError& error) {
    return std::string(error.what())
               .find("\"Double pendulm\" (did you mean double_pendulum?), allowed") !=
           std::string::npos;
  });
  ::unsetenv("DYNWITNESS_DATA");
}

BOOST_AUTO_TEST_SUITE_END()
