// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes written as URDF: read back, they must be the same mechanism.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "scene/scene.hpp"

namespace data = boost::unit_test::data;
namespace fs = std::filesystem;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

/// Those without joints of kinds that URDF has not.
std::vector<std::filesystem::path> scenesThatUrdfCanSay() {
  std::vector<std::filesystem::path> files;
  for (const auto& file : scene::bundledScenes()) {
    const scene::Mechanism m = scene::readScene(file).mechanism;
    if (std::none_of(m.links.begin(), m.links.end(), [](const scene::Link& link) {
          using scene::JointKind;
          const JointKind kind = link.joint.kind;
          return kind == JointKind::kHelical || kind == JointKind::kCylindrical ||
                 kind == JointKind::kUniversal || kind == JointKind::kSpherical;
        }))
      files.push_back(file);
  }
  return files;
}

int indexOf(const scene::Mechanism& mechanism, const std::string& link) {
  const auto& links = mechanism.links;
  return static_cast<int>(std::find_if(links.begin(), links.end(),
                                       [&](const scene::Link& l) { return l.name == link; }) -
                          links.begin());
}

/// The scene from its URDF, with what URDF cannot say taken from the scene itself.
scene::Scene throughUrdf(const scene::Scene& original) {
  scene::Scene copy = scene::readSceneUrdf(scene::writeSceneUrdf(original), original.name);
  const scene::Mechanism& from = original.mechanism;
  scene::Mechanism& to = copy.mechanism;
  to.parameters = from.parameters;
  to.has_gravity = from.has_gravity;
  to.gravity = from.gravity;
  const std::vector<int> moving_from = from.movingLinks(), moving_to = to.movingLinks();
  BOOST_REQUIRE_EQUAL(moving_to.size(), moving_from.size());
  for (std::size_t i = 0; i < moving_to.size(); ++i) {
    const scene::Joint& joint = from.links[moving_from[i]].joint;
    scene::Joint& written = to.links[moving_to[i]].joint;
    BOOST_TEST_REQUIRE(written.name == joint.name);
    written.rotor_inertia = joint.rotor_inertia;
    written.gear_ratio = joint.gear_ratio;
    written.stiffness = joint.stiffness;
    written.rest = joint.rest;
    written.gyroscopic = joint.gyroscopic;
    written.friction = joint.friction;  // URDF has words for the symmetric kind only
  }
  for (scene::Wrench wrench : from.wrenches) {
    wrench.link = indexOf(to, from.links[wrench.link].name);
    to.wrenches.push_back(wrench);
  }
  return copy;
}

void requireSameDynamics(const scene::Scene& left, const scene::Scene& right) {
  const auto a = newtonEulerKind().make(left).value(), b = newtonEulerKind().make(right).value();
  for (int k = 0; k < 20; ++k) {
    const scene::State<double> state = drawState(left.mechanism, left.name, 1, k);
    for (const Quantity quantity : kAllQuantities) {
      if (!a->answers(quantity)) continue;
      // a Denavit-Hartenberg joint is two in URDF, which have their reactions each
      if (quantity == Quantity::kReactions) continue;
      const Answer in_a = a->answer(quantity, state), in_b = b->answer(quantity, state);
      // 17 digits are not all digits: up to half a unit of the 17th of the largest number is lost
      // in each, a tenth of a rounding to double
      const double last_digit = 1e-16 * in_a.value.cwiseAbs().maxCoeff();
      const Eigen::MatrixXd room = (in_a.bound + in_b.bound).array() + 4 * last_digit -
                                   (in_a.value - in_b.value).array().abs();
      BOOST_TEST(room.minCoeff() >= 0, left.name << ": " << name(quantity) << " differs at state "
                                                 << k << " by "
                                                 << (in_a.value - in_b.value).norm());
    }
  }
}

scene::Scene sceneOf(const std::string& toml) {
  return scene::readSceneToml(toml, "made_up.toml");
}

/// The text without its comment, which speaks of what the scene has and URDF has not.
std::string withoutComment(std::string urdf) {
  const std::size_t begin = urdf.find("  <!--"), end = urdf.find("-->\n", begin);
  return urdf.erase(begin, end + 4 - begin);
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A file of this text that lives as long as the test.
class File {
 public:
  explicit File(const std::string& text)
      : path_(fs::temp_directory_path() / ("dynwitness_" + std::to_string(getpid()) + ".urdf")) {
    std::ofstream(path_) << text;
  }
  ~File() { fs::remove(path_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

const std::string kOneLink = R"(
[[link]]
name = "base"
[[link]]
name = "arm"
parent = "base"
mass = 2
com = [0.1, 0.2, 0.3]
)";

}  // namespace

BOOST_AUTO_TEST_SUITE(identities)

BOOST_DATA_TEST_CASE(a_scene_read_back_from_urdf_has_the_same_dynamics,
                     data::make(scenesThatUrdfCanSay())) {
  const scene::Scene original = scene::readScene(sample);
  requireSameDynamics(original, throughUrdf(original));
}

BOOST_DATA_TEST_CASE(writing_what_was_read_writes_the_same_again,
                     data::make(scenesThatUrdfCanSay())) {
  const scene::Scene original = scene::readScene(sample);
  scene::Scene again = scene::readSceneUrdf(scene::writeSceneUrdf(original), "again.urdf");
  again.title = original.title;
  BOOST_TEST(withoutComment(scene::writeSceneUrdf(again)) ==
             withoutComment(scene::writeSceneUrdf(original)));
}

BOOST_DATA_TEST_CASE(every_link_of_the_scene_is_a_link_of_the_file,
                     data::make(scenesThatUrdfCanSay())) {
  const scene::Scene original = scene::readScene(sample);
  const std::string urdf = scene::writeSceneUrdf(original);
  for (const scene::Link& link : original.mechanism.links)
    BOOST_TEST(contains(urdf, "<link name=\"" + link.name + "\">"));
}

// a turn whose pitch is a right angle has no roll and yaw of its own
BOOST_DATA_TEST_CASE(rows_of_parameters_that_turn_in_any_way_keep_the_dynamics,
                     data::make({"mdh = { alpha = \"pi/2\", theta = \"pi/2\", a = 0.2, d = -0.1 }",
                                 "mdh = { alpha = 0.3, theta = 2.5, a = 0.2, d = -0.1 }",
                                 "mdh = { alpha = -2, theta = \"-pi/2\", d = 0.7 }",
                                 "dh = { alpha = \"-pi/2\", theta = 1, a = 0.4, d = 0.3 }",
                                 "dh = { alpha = 3, theta = \"pi/2\" }",
                                 "xyz = [1, 2, 3]\nrpy = [0.4, \"pi/2\", -2]"})) {
  const scene::Scene original =
      sceneOf("gravity = [1, 2, -9]\n" + kOneLink +
              "inertia = { xx = 0.3, yy = 0.4, zz = 0.5, xy = 0.01, yz = -0.02 }\n"
              "[link.joint]\nkind = \"revolute\"\nrpy = [0.1, 0.2, 0.3]\n"
              "[[link]]\nname = \"hand\"\nparent = \"arm\"\nmass = 1\ncom = [0.3, 0, 0.1]\n"
              "inertia = { about = \"origin\", rpy = [1, 2, 3], xx = 0.3, yy = 0.4, zz = 0.5 }\n"
              "[link.joint]\nkind = \"prismatic\"\n" +
              std::string(sample) +
              "\n"
              "[[link]]\nname = \"finger\"\nparent = \"hand\"\nmass = 0.1\n"
              "inertia = { xx = 0.003, yy = 0.004, zz = 0.005, xz = 0.001 }\n"
              "[link.joint]\nkind = \"fixed\"\n" +
              std::string(sample) +
              "\n"
              "[[wrench]]\nlink = \"hand\"\nforce = [1, 2, 3]\nat = [0.1, 0.2, 0.3]\n");
  requireSameDynamics(original, throughUrdf(original));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(known_answers)

BOOST_AUTO_TEST_CASE(decimals_stay_the_decimals_that_they_are) {
  const std::string urdf = scene::writeSceneUrdf(scene::findScene("franka_panda"));
  BOOST_TEST(contains(urdf, "<mass value=\"4.970684\"/>"));
  BOOST_TEST(contains(urdf,
                      "<inertia ixx=\"0.70337\" ixy=\"-0.000139\" ixz=\"0.006772\" "
                      "iyy=\"0.70661\" iyz=\"0.019169\" izz=\"0.009117\"/>"));
  BOOST_TEST(contains(urdf, "<origin xyz=\"0 -0.316 0\" rpy=\"1.5707963267948966 0 0\"/>"));
}

BOOST_AUTO_TEST_CASE(inertia_about_the_link_origin_is_shifted_exactly) {
  // 2 kg at (0.1, 0.2, 0.3): m (y^2 + z^2) = 0.26, m x y = 0.04, ...
  const std::string urdf =
      scene::writeSceneUrdf(sceneOf(
          kOneLink + "inertia = { about = \"origin\", xx = 0.36, yy = 0.35, zz = 0.24, "
                     "xy = -0.04, xz = -0.05, yz = -0.12 }\n[link.joint]\nkind = \"revolute\"\n"));
  BOOST_TEST(contains(urdf,
                      "<inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0.01\" iyy=\"0.15\" iyz=\"0\" "
                      "izz=\"0.14\"/>"));
}

BOOST_AUTO_TEST_CASE(what_urdf_cannot_say_is_named) {
  BOOST_TEST(contains(scene::writeSceneUrdf(scene::findScene("prismatic_revolute_mix")),
                      "gravity (0.981 0 -9.81), rotors, springs, loads"));
  BOOST_TEST(contains(scene::writeSceneUrdf(scene::findScene("planar_3r")),
                      "URDF cannot: that there is no gravity -->"));
}

BOOST_AUTO_TEST_CASE(names_may_have_characters_that_mean_something_in_xml) {
  scene::Scene original = scene::findScene("simple_pendulum");
  original.title = "\"<&>'";
  original.mechanism.links[1].name = "bob & <string>";
  original.mechanism.links[1].joint.name = "\"pivot\"";
  const scene::Scene read = scene::readSceneUrdf(scene::writeSceneUrdf(original), "x.urdf");
  BOOST_TEST(read.title == original.title);
  BOOST_TEST(read.mechanism.links[1].name == "bob & <string>");
  BOOST_TEST(read.mechanism.links[1].joint.name == "\"pivot\"");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(for_engines)

const std::string kUrdf =
    "<robot name=\"r\"><link name=\"base\"/><link name=\"arm\"><visual><geometry>"
    "<mesh filename=\"nowhere.stl\"/></geometry></visual><inertial><mass value=\"1.50\"/>"
    "<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>"
    "<joint name=\"j\" type=\"continuous\"><parent link=\"base\"/><child link=\"arm\"/></joint>"
    "</robot>";

BOOST_AUTO_TEST_CASE(a_urdf_file_is_handed_on_without_its_shapes) {
  const File file(kUrdf);
  const std::string urdf = scene::urdfForEngines(scene::readScene(file.path()));
  BOOST_TEST(contains(urdf, "<mass value=\"1.50\""));  // as spelled in the file
  BOOST_TEST(contains(urdf, "<link name=\"base\""));
  BOOST_TEST(!contains(urdf, "mesh"));
}

BOOST_AUTO_TEST_CASE(a_scene_that_left_its_file_behind_is_written) {
  const File file(kUrdf);
  scene::Scene changed = scene::readScene(file.path());
  changed.mechanism.links[1].inertia.mass = scene::Number(3);
  BOOST_TEST(scene::urdfForEngines(changed) == scene::writeSceneUrdf(changed));
}

BOOST_AUTO_TEST_SUITE_END()
