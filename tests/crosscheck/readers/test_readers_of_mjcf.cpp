// SPDX-License-Identifier: GPL-3.0-or-later
// MJCF files under `readers`: an engine that reads what is written agrees, and one that was made to
// read otherwise is told with body and rule. What is planted is computed here by hand.
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE readers_of_mjcf
#include <functional>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include "crosscheck/readers/compare.hpp"
#include "scene/error.hpp"
#include "scene/text_file.hpp"
#include "tests/fixtures/program.hpp"

namespace data = boost::unit_test::data;
namespace fs = std::filesystem;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using Eigen::Vector3d;

namespace {

const fs::path kModels = fs::path(DYNWITNESS_SOURCE_DIR) / "tests/scene/mjcf";

ReaderResult readBy(const std::string& model, const Reader& reader) {
  const fs::path file = kModels / model;
  return examineReaders(scene::readTextFile(file, "MJCF"), file, {reader}, 5, 1).readers.at(0);
}

/// Our reader, changed: as an engine that reads something otherwise.
Reader changed(const std::function<void(Robot&)>& change) {
  Reader reader{"planted", "", true, {}};
  reader.reads_mjcf = true;
  reader.read = [change](const std::string& text, const fs::path& file) {
    Reading reading;
    reading.robot = readParts(text, file).robot();
    change(reading.robot);
    return reading;
  };
  return reader;
}
ReadBody& bodyOf(Robot& robot, const std::string& link) {
  return robot.bodies.at(static_cast<std::size_t>(robot.indexOf(link)));
}
MassMoments box(double mass, const Vector3d& com, const Vector3d& moments) {
  return MassMoments::of(mass, com, moments.asDiagonal());
}

struct Planted {
  const char *model, *link, *quantity, *rule;
  std::function<void(Robot&)> change;
};
std::ostream& operator<<(std::ostream& out, const Planted& planted) {
  return out << planted.model << " " << planted.quantity;
}
const Planted kPlanted[] = {
    {"orientations.xml", "quat", "inertia", "the rpy of <inertial> is dropped (quat)",
     [](Robot& r) {
       bodyOf(r, "quat").moments = box(2, {0.1, 0, -0.2}, {0.02, 0.03, 0.04});
     }},
    {"joints.xml", "three", "inertia", "a fixed child is merged without its rotation (fixed)",
     [](Robot& r) {  // seen from the anchor of h2, the last of its joints
       const Vector3d anchor(-0.1, 0.03, 0.05);
       MassMoments& both = bodyOf(r, "three").moments;
       both = box(0.8, Vector3d(0.1, 0.2, 0) - anchor, {0.01, 0.01, 0.015});
       both += box(0.2, Vector3d(0.1 + 0.05, 0, 0.2) - anchor, {0.001, 0.002, 0.002});
     }},
    {"joints.xml", "three", "axis", "the axis is not normalised",
     [](Robot& r) {
       bodyOf(r, "three").axis = {0, 0, 2};
     }},
    {"joints.xml", "three.s1", "spring rest", "",  // 0.1 - 0.2: springref less ref
     [](Robot& r) {
       BOOST_TEST(bodyOf(r, "three.s1").rest == -0.1);
       bodyOf(r, "three.s1").rest = 0.1;
     }},
    {"closed.xml", "thumb", "mimic", "it is ignored: the joint moves by itself",
     [](Robot& r) {
       bodyOf(r, "thumb").leader = "", bodyOf(r, "thumb").multiplier = 1,
                 bodyOf(r, "thumb").offset = 0;
     }},
    {"shapes.xml", "", "gravity", "it has the other sign",
     [](Robot& r) { r.gravity = -r.gravity; }},
    {"included.xml", "arm", "damping", "it is ignored",
     [](Robot& r) { bodyOf(r, "arm").damping = 0; }},
    {"included.xml", "other_arm", "tree", "it hangs on another link",
     [](Robot& r) { bodyOf(r, "other_arm").parent = r.indexOf("arm"); }},
};

}  // namespace

BOOST_DATA_TEST_CASE(mujoco_has_the_robot_of_an_mjcf_file,
                     data::make({"classes.xml", "closed.xml", "included.xml", "joints.xml",
                                 "orientations.xml", "shapes.xml", "totals.xml"})) {
  const Reader mujoco = mujocoReader();
  if (!mujoco.present) return;
  const ReaderResult result = readBy(sample, mujoco);
  BOOST_TEST(result.has_read, result.refusal << result.failure);
  for (const Misreading& finding : result.findings)
    BOOST_ERROR(finding.link << " " << finding.quantity << ": " << finding.ours << " and "
                             << finding.theirs);
}

BOOST_DATA_TEST_CASE(a_planted_mistake_is_named, data::make(kPlanted), planted) {
  const ReaderResult result = readBy(planted.model, changed(planted.change));
  BOOST_REQUIRE(result.findings.size() == 1u);
  const Misreading& finding = result.findings[0];
  BOOST_TEST(finding.link == planted.link);
  BOOST_TEST(finding.quantity == planted.quantity);
  BOOST_TEST(finding.rule == planted.rule);
}

BOOST_AUTO_TEST_CASE(what_our_reader_does_not_keep_is_told_and_no_finding) {
  const fs::path file = kModels / "classes.xml";  // has limits
  const Reader without = changed([](Robot& robot) {
    for (ReadBody& body : robot.bodies) body.lower = -2;
  });
  const ReadersResult result =
      examineReaders(scene::readTextFile(file, "MJCF"), file, {without}, 2, 1);
  BOOST_TEST(result.agrees());
  BOOST_TEST(result.readers[0].has_read);
  const std::string text = readersText(result, false);
  BOOST_TEST(text.find("classes.xml: joint limits not modelled") != std::string::npos, text);
}

BOOST_AUTO_TEST_CASE(a_reader_of_urdf_alone_agrees_with_nothing) {
  const ReaderResult dart = readBy("classes.xml", dartReader());
  if (!dart.present) return;
  BOOST_TEST(!dart.has_read);
  BOOST_TEST(dart.findings.empty());
  BOOST_TEST(dart.refusal == "it does not read MJCF");
  BOOST_TEST(cellOf(dart, "plain") == "not read");
}

BOOST_AUTO_TEST_CASE(what_is_no_subset_of_ours_is_refused_in_words) {
  const fixtures::Program program;
  program.write("lift.xml",
                "<mujoco>\n<worldbody>\n<body name=\"a\" gravcomp=\"1\"><joint/><geom size=\"1\"/>"
                "</body></worldbody></mujoco>");
  fixtures::refuses(program, "readers lift.xml", "lift.xml:3: <body>: gravcomp is 1");
  program.write("still.xml", "<mujoco><worldbody><geom size=\"1\"/></worldbody></mujoco>");
  fixtures::refuses(program, "readers still.xml", "no joint moves");
  program.write("ball.xml",
                "<mujoco><worldbody><body><joint/><geom size=\"1\"/></body></worldbody></mujoco>");
  fixtures::refuses(program, "readers ball.xml --mend o.urdf", "--mend writes a URDF");
  fixtures::refuses(program, "readers ball.xml --plain o.urdf", "--plain writes a URDF");
  BOOST_TEST(!program.exists("o.urdf"));
}
