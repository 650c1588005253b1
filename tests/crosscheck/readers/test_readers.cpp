// SPDX-License-Identifier: GPL-3.0-or-later
// Each mistake that readers make, planted: a reader that reads another text as if it were the file.
// What it has read is written by hand here, not by the code that looks for mistakes, and must be
// named with link and rule first.
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE readers
#include "crosscheck/readers/compare.hpp"

#include <functional>
#include <map>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/mimic.hpp"
#include "tests/fixtures/program.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using fixtures::Program;

namespace {

Matrix3d turn(const Vector3d& rpy) {
  return (Eigen::AngleAxisd(rpy[2], Vector3d::UnitZ()) *
          Eigen::AngleAxisd(rpy[1], Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy[0], Vector3d::UnitX()))
      .toRotationMatrix();
}
Vector3d rpyOf(const Matrix3d& R) {
  const Vector3d ypr = R.eulerAngles(2, 1, 0);
  return {ypr[2], ypr[1], ypr[0]};
}
Matrix3d lever(const Vector3d& c) {
  return c.squaredNorm() * Matrix3d::Identity() - c * c.transpose();
}
Matrix3d inertia(double xx, double yy, double zz, double xy, double xz, double yz) {
  return (Matrix3d() << xx, xy, xz, xy, yy, yz, xz, yz, zz).finished();
}

struct Inertial {
  double mass;
  Vector3d com, rpy;
  Matrix3d I;
};
/// An arm that turns, a tool fixed to it, a sensor without <inertial> on the arm, and a finger that
/// slides on the tool; at lines 3, 4, 5 and 6.
struct Arm {
  Inertial arm{
      2, {0.11, -0.07, 0.23}, {0.3, -0.5, 0.7}, inertia(0.031, 0.042, 0.053, 0.004, -0.003, 0.002)};
  Inertial tool{0.7,
                {0.05, 0.02, -0.04},
                {-0.2, 0.4, 0.6},
                inertia(0.011, 0.007, 0.009, 0.001, 0.002, -0.001)};
  Inertial finger{0.3, {0.01, 0.03, 0.02}, {0, 0, 0}, inertia(0.0011, 0.0012, 0.0013, 0, 0, 0)};
  std::optional<Inertial> sensor;
  Vector3d arm_xyz{0.1, 0.2, 0.3}, arm_rpy{0.4, 0.5, -0.6}, arm_axis{0, 1.2, 1.6};
  Vector3d tool_xyz{0.3, -0.1, 0.2}, tool_rpy{0.5, 0.3, -0.4};
  Vector3d finger_xyz{0.02, 0.01, 0.1}, finger_rpy{0.2, 0.1, 0.3}, finger_axis{0, 0, 1};
  std::string finger_kind = "prismatic";
  double damping = 0.25, lower = -0.5, upper = 0.75;
  std::string mimic;
};

std::string numbers(const Vector3d& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v[0], v[1], v[2]);
}
std::string origin(const Vector3d& xyz, const Vector3d& rpy) {
  return "<origin xyz=\"" + numbers(xyz) + "\" rpy=\"" + numbers(rpy) + "\"/>";
}
std::string text(const Inertial& i) {
  return fmt::format(
      "<inertial><mass value=\"{:.17g}\"/>{}<inertia ixx=\"{:.17g}\" iyy=\"{:.17g}\" izz=\"{:.17g}\" "
      "ixy=\"{:.17g}\" ixz=\"{:.17g}\" iyz=\"{:.17g}\"/></inertial>",
      i.mass, origin(i.com, i.rpy), i.I(0, 0), i.I(1, 1), i.I(2, 2), i.I(0, 1), i.I(0, 2),
      i.I(1, 2));
}
std::string joint(const std::string& name, const std::string& kind, const std::string& parent,
                  const std::string& child, const std::string& rest) {
  return "<joint name=\"" + name + "\" type=\"" + kind + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + rest + "</joint>\n";
}
std::string text(const Arm& a) {
  return "<robot name=\"arm\">\n<link name=\"base\"/>\n<link name=\"arm\">" + text(a.arm) +
         "</link>\n<link name=\"tool\">" + text(a.tool) + "</link>\n<link name=\"sensor\">" +
         (a.sensor ? text(*a.sensor) : "") +
         "<collision><origin xyz=\"0.01 0.02 0.03\" rpy=\"0.1 0.2 0.3\"/><geometry><box size=\"0.1 0.2 0.3\"/></geometry></collision>"
         "</link>\n<link name=\"finger\">" +
         text(a.finger) + "</link>\n" +
         joint("shoulder", "revolute", "base", "arm",
               origin(a.arm_xyz, a.arm_rpy) + "<axis xyz=\"" + numbers(a.arm_axis) + "\"/>" +
                   fmt::format(
                       "<limit lower=\"{:.17g}\" upper=\"{:.17g}\" effort=\"1\" velocity=\"1\"/>"
                       "<dynamics damping=\"{:.17g}\"/>",
                       a.lower, a.upper, a.damping)) +
         joint("weld", "fixed", "arm", "tool", origin(a.tool_xyz, a.tool_rpy)) +
         joint("glue", "fixed", "arm", "sensor", origin({0.2, 0.1, 0}, {0, 0.2, 0})) +
         joint("slide", a.finger_kind, "tool", "finger",
               origin(a.finger_xyz, a.finger_rpy) + "<axis xyz=\"" + numbers(a.finger_axis) +
                   "\"/><limit lower=\"0\" upper=\"1\" effort=\"1\" velocity=\"1\"/>" + a.mimic) +
         "</robot>\n";
}

using RobotChange = std::function<void(Robot&)>;

/// A reader that has read `seen` whatever it is given.
Reader readerOf(const std::string& seen, const RobotChange& change = {}) {
  Reader reader{"planted", "", true, {}};
  reader.read = [seen, change](const std::string&, const std::filesystem::path& file) {
    Reading reading;
    reading.robot = FileParts(scene::readUrdfAsWritten(seen, file)).robot();
    if (change) change(reading.robot);
    reading.answer = [robot = reading.robot](const std::vector<double>& q) {
      return massAndGravity(robot, q);
    };
    return reading;
  };
  return reader;
}

/// The same, which says M and g alone.
Reader silentReaderOf(const std::string& seen) {
  Reader reader = readerOf(seen);
  const auto read = reader.read;
  reader.read = [read](const std::string& t, const std::filesystem::path& file) {
    Reading reading = read(t, file);
    reading.robot = FileParts(scene::readUrdfAsWritten(t, file)).robot();
    reading.shows = false;
    return reading;
  };
  return reader;
}

std::vector<Misreading> findingsOf(const std::string& file, const Reader& reader) {
  return examineReaders(file, "arm.urdf", {reader}, 5, 1).readers.at(0).findings;
}

struct Plant {
  const char* name;
  std::function<void(Arm&)> change;
  const char *link, *quantity, *rule;
  const char* by_answers = nullptr;  ///< what M and g alone say; "": nothing; "?": it is not asked
};
std::ostream& operator<<(std::ostream& out, const Plant& plant) {
  return out << plant.name;
}

/// The tool's distance from what it is merged with, in its own axes.
Vector3d fromCommonCom(const Arm& a) {
  const Matrix3d R = turn(a.tool_rpy);
  const Vector3d tool = a.tool_xyz + R * a.tool.com;
  const Vector3d common =
      (a.arm.mass * a.arm.com + a.tool.mass * tool) / (a.arm.mass + a.tool.mass);
  return R.transpose() * (tool - common);
}
/// Adds a multiple of the parallel axis theorem's part, written in the axes of the inertia.
void addLever(Inertial& i, const Vector3d& d, double times) {
  const Matrix3d R = turn(i.rpy);
  i.I += times * i.mass * R.transpose() * lever(d) * R;
}
/// The same for both links about the common centre of mass.
void addLevers(Arm& a, double times) {
  const Vector3d d = fromCommonCom(a);
  const Vector3d tool = a.tool_xyz + turn(a.tool_rpy) * a.tool.com;
  const Vector3d common =
      (a.arm.mass * a.arm.com + a.tool.mass * tool) / (a.arm.mass + a.tool.mass);
  addLever(a.tool, d, times);
  addLever(a.arm, a.arm.com - common, times);
}
void turnOneSide(Inertial& i) {
  const Matrix3d RI = turn(i.rpy) * i.I;
  i.I = RI.triangularView<Eigen::Upper>();
  i.I = (i.I + i.I.transpose() - Matrix3d(i.I.diagonal().asDiagonal())).eval();
  i.rpy.setZero();
}

const Plant kPlants[] = {
    {"inertial rpy dropped", [](Arm& a) { a.arm.rpy.setZero(), a.tool.rpy.setZero(); }, "arm",
     "inertia", "the rpy of <inertial> is dropped (arm, tool)"},
    {"inertial rpy dropped once", [](Arm& a) { a.tool.rpy.setZero(); }, "arm", "inertia",
     "the rpy of <inertial> is dropped (tool)"},
    {"inertial rpy transposed", [](Arm& a) { a.arm.rpy = rpyOf(turn(a.arm.rpy).transpose()); },
     "arm", "inertia", "the rpy of <inertial> is transposed (arm)"},
    {"inertial rpy on one side", [](Arm& a) { turnOneSide(a.arm); }, "arm", "inertia",
     "the rpy of <inertial> turns the inertia on one side only (arm)"},
    {"products dropped",
     [](Arm& a) {
       for (Inertial* i : {&a.arm, &a.tool}) i->I = Matrix3d(i->I.diagonal().asDiagonal());
     },
     "arm", "inertia", "products of inertia are dropped (arm, tool)"},
    {"products negated",
     [](Arm& a) {
       for (Inertial* i : {&a.arm, &a.tool})
         i->I = (2 * Matrix3d(i->I.diagonal().asDiagonal()) - i->I).eval();
     },
     "arm", "inertia", "products of inertia have the other sign (arm, tool)"},
    {"com turned", [](Arm& a) { a.tool.com = turn(a.tool.rpy) * a.tool.com; }, "arm", "inertia",
     "the centre of mass is turned by the rpy of <inertial> (tool)"},
    {"com turned back", [](Arm& a) { a.tool.com = turn(a.tool.rpy).transpose() * a.tool.com; },
     "arm", "inertia", "the centre of mass is turned back by the rpy of <inertial> (tool)"},
    {"com at the origin", [](Arm& a) { a.arm.com.setZero(); }, "arm", "inertia",
     "the centre of mass is taken at the link's origin (arm)"},
    {"inertial rpy applied twice",
     [](Arm& a) { a.arm.rpy = rpyOf(turn(a.arm.rpy) * turn(a.arm.rpy)); }, "arm", "inertia",
     "the rpy of <inertial> is applied twice (arm)"},
    {"a point mass", [](Arm& a) { a.finger.I.setZero(); }, "finger", "inertia",
     "the inertia is dropped, the mass kept (finger)"},
    {"com in the parent",
     [](Arm& a) { a.finger.com = turn(a.finger_rpy).transpose() * (a.finger.com - a.finger_xyz); },
     "finger", "inertia", "the centre of mass is taken in the parent link's frame (finger)"},
    {"inertia taken as about the joint", [](Arm& a) { addLever(a.finger, a.finger.com, -1); },
     "finger", "inertia",
     "the inertia, about the centre of mass, is taken as about the joint (finger)"},
    {"inertia about the joint used as about the com",
     [](Arm& a) { addLever(a.finger, a.finger.com, 1); }, "finger", "inertia",
     "the inertia is kept about the joint and used as about the centre of mass (finger)"},
    {"default mass",
     [](Arm& a) {
       a.sensor = Inertial{1, {0, 0, 0}, {0, 0, 0}, Matrix3d::Identity()};
     },
     "arm", "inertia", "a massless link gets 1 kg and 1 kg m^2 (sensor)"},
    {"default mass alone",
     [](Arm& a) {
       a.sensor = Inertial{1, {0, 0, 0}, {0, 0, 0}, Matrix3d::Zero()};
     },
     "arm", "inertia", "a massless link gets 1 kg (sensor)"},
    {"inertia from geometry",  // 0.1 x 0.2 x 0.3 m of water: 6 kg
     [](Arm& a) {
       a.sensor =
           Inertial{6, {0.01, 0.02, 0.03}, {0.1, 0.2, 0.3}, inertia(0.065, 0.05, 0.025, 0, 0, 0)};
     },
     "arm", "inertia",
     "a massless link gets that of its collision shapes, of 1000 kg/m^3 (sensor)"},
    {"child not rotated",
     [](Arm& a) {
       // the finger hangs on the tool where it was
       a.finger_xyz = turn(a.tool_rpy) * a.finger_xyz;
       a.finger_rpy = rpyOf(turn(a.tool_rpy) * turn(a.finger_rpy));
       a.tool_rpy.setZero();
     },
     "arm", "inertia", "a fixed child is merged without its rotation (tool)"},
    {"child rotated back",
     [](Arm& a) {
       const Matrix3d R = turn(a.tool_rpy);
       a.finger_xyz = R * R * a.finger_xyz;  // in place, seen from the tool that is turned back
       a.finger_rpy = rpyOf(R * R * turn(a.finger_rpy));
       a.tool_rpy = rpyOf(R.transpose());
     },
     "arm", "inertia", "a fixed child is merged with its rotation transposed (tool)"},
    {"child's centre of mass not rotated",
     [](Arm& a) { a.tool.com = turn(a.tool_rpy).transpose() * a.tool.com; }, "arm", "inertia",
     "a fixed child's centre of mass is merged without its rotation (tool)"},
    {"child's inertia not rotated",
     [](Arm& a) { a.tool.rpy = rpyOf(turn(a.tool_rpy).transpose() * turn(a.tool.rpy)); }, "arm",
     "inertia", "a fixed child's inertia is merged without its rotation (tool)"},
    {"child not shifted",
     [](Arm& a) {
       a.finger_xyz += turn(a.tool_rpy).transpose() * a.tool_xyz;
       a.tool_xyz.setZero();
     },
     "arm", "inertia", "a fixed child is merged without its shift (tool)"},
    {"child neither rotated nor shifted",
     [](Arm& a) {
       a.finger_xyz = turn(a.tool_rpy) * a.finger_xyz + a.tool_xyz;
       a.finger_rpy = rpyOf(turn(a.tool_rpy) * turn(a.finger_rpy));
       a.tool_rpy.setZero(), a.tool_xyz.setZero();
     },
     "arm", "inertia",
     "a fixed child is merged without its rotation (tool), and a fixed child is merged without its shift (tool)",
     "a fixed child is merged without its rotation, and a fixed child is merged without its shift"},
    {"child dropped", [](Arm& a) { a.tool.mass = 0, a.tool.I.setZero(); }, "arm", "inertia",
     "a fixed child is dropped (tool)"},
    {"parallel axis missing", [](Arm& a) { addLevers(a, -1); }, "arm", "inertia",
     "the parallel axis theorem is forgotten on merging (arm, tool)"},
    {"parallel axis doubled", [](Arm& a) { addLevers(a, 1); }, "arm", "inertia",
     "the parallel axis theorem is applied twice on merging (arm, tool)"},
    {"parallel axis negated", [](Arm& a) { addLevers(a, -2); }, "arm", "inertia",
     "the parallel axis theorem has the wrong sign on merging (arm, tool)"},
    {"axis in the parent's frame",
     [](Arm& a) { a.arm_axis = turn(a.arm_rpy).transpose() * a.arm_axis; }, "arm", "axis",
     "the axis is taken in the parent link's frame"},
    {"axis with the other sign", [](Arm& a) { a.arm_axis = -a.arm_axis; }, "arm", "axis",
     "the axis has the other sign"},
    {"axis ignored",
     [](Arm& a) {
       a.arm_axis = {1, 0, 0};
     },
     "arm", "axis", "the axis is x, whatever the file says"},
    {"joint rpy dropped", [](Arm& a) { a.arm_rpy.setZero(); }, "arm", "origin",
     "the rpy of the joint's origin is dropped"},
    {"joint rpy transposed", [](Arm& a) { a.arm_rpy = rpyOf(turn(a.arm_rpy).transpose()); }, "arm",
     "origin", "the rpy of the joint's origin is transposed"},
    {"joint xyz dropped", [](Arm& a) { a.arm_xyz.setZero(); }, "arm", "origin",
     "the xyz of the joint's origin is dropped", ""},
    {"joint xyz turned", [](Arm& a) { a.arm_xyz = turn(a.arm_rpy) * a.arm_xyz; }, "arm", "origin",
     "the xyz of the joint's origin is turned by its rpy", ""},
    {"joint rpy in the reverse order",
     [](Arm& a) {
       a.arm_rpy = rpyOf((Eigen::AngleAxisd(a.arm_rpy[0], Vector3d::UnitX()) *
                          Eigen::AngleAxisd(a.arm_rpy[1], Vector3d::UnitY()) *
                          Eigen::AngleAxisd(a.arm_rpy[2], Vector3d::UnitZ()))
                             .toRotationMatrix());
     },
     "arm", "origin", "the rpy of the joint's origin is applied in the reverse order"},
    {"prismatic as revolute", [](Arm& a) { a.finger_kind = "revolute"; }, "finger", "joint kind",
     "prismatic is read as revolute"},
    {"limits in degrees",
     [](Arm& a) { a.lower *= 57.295779513082320877, a.upper *= 57.295779513082320877; }, "arm",
     "limits", "they are kept in degrees", ""},
    {"damping ignored", [](Arm& a) { a.damping = 0; }, "arm", "damping", "it is ignored", ""},
    {"a joint that is not there", [](Arm& a) { a.finger_kind = "fixed"; }, "finger", "tree",
     "the joint is not there, or does not move", "?"},
};

}  // namespace

BOOST_DATA_TEST_CASE(a_planted_mistake_is_named_first_with_its_link, data::make(kPlants), plant) {
  const std::string file = text(Arm());
  Arm changed;
  plant.change(changed);
  const std::vector<Misreading> findings = findingsOf(file, readerOf(text(changed)));
  BOOST_REQUIRE(!findings.empty());
  BOOST_TEST(findings[0].link == plant.link);
  BOOST_TEST(findings[0].quantity == plant.quantity);
  BOOST_TEST(findings[0].rule == plant.rule);
  BOOST_TEST(findings[0].where.line == (std::string(plant.link) == "arm" ? 3 : 6));
}

// Of a robot that says M and g alone the same is found, as far as these can tell.
BOOST_DATA_TEST_CASE(a_planted_mistake_is_found_from_M_and_g_alone, data::make(kPlants), plant) {
  Arm changed;
  plant.change(changed);
  const std::vector<Misreading> findings = findingsOf(text(Arm()), silentReaderOf(text(changed)));
  const std::string expected = plant.by_answers ? plant.by_answers : plant.rule;
  if (expected == "?") return;
  BOOST_REQUIRE(findings.empty() == expected.empty());
  if (findings.empty()) return;
  BOOST_TEST(findings[0].link == plant.link);
  BOOST_TEST(findings[0].rule == expected);
}

// Two mistakes at two links, from the tip inward; and what no rule explains is told in numbers.
BOOST_AUTO_TEST_CASE(M_and_g_alone_tell_link_by_link) {
  Arm changed;
  changed.arm.rpy.setZero();
  changed.finger.com = {0, 0, 0};
  std::vector<Misreading> found = findingsOf(text(Arm()), silentReaderOf(text(changed)));
  BOOST_REQUIRE(found.size() == 2u);
  BOOST_TEST(found[0].rule == "the centre of mass is taken at the link's origin (finger)");
  BOOST_TEST(found[1].rule == "the rpy of <inertial> is dropped (arm)");

  changed = Arm();
  changed.finger.mass = 0.4;
  found = findingsOf(text(Arm()), silentReaderOf(text(changed)));
  BOOST_REQUIRE(found.size() == 1u);
  BOOST_TEST(found[0].link == "finger");
  BOOST_TEST(found[0].rule == "");
  BOOST_TEST(found[0].theirs.find("m +0.1,") != std::string::npos, found[0].theirs);
  Reader reader = silentReaderOf(text(Arm()));
  const auto read = reader.read;
  reader.read = [read](const std::string& t, const std::filesystem::path& file) {
    Reading reading = read(t, file);
    reading.answer = [robot = reading.robot](const std::vector<double>& q) {
      MassAndGravity out = massAndGravity(robot, q);
      out.g *= -1;
      return out;
    };
    return reading;
  };
  found = findingsOf(text(Arm()), reader);
  BOOST_REQUIRE(found.size() == 1u);
  BOOST_TEST(found[0].quantity == "gravity");
  BOOST_TEST(found[0].rule == "it has the other sign");
}

// Those that ask for another file: an inertia that no body has, shapes beside an inertia, a mass
// of 0.
BOOST_AUTO_TEST_CASE(mistakes_about_unusual_files_are_named) {
  Arm file, seen;
  const auto first = [&] {
    const std::vector<Misreading> found = findingsOf(text(file), readerOf(text(seen)));
    BOOST_REQUIRE(!found.empty());
    return found[0].rule;
  };
  file.finger.I = seen.finger.I = Vector3d(0.001, 0.001, 0.004).asDiagonal();
  seen.finger.I = 0.002 * Matrix3d::Identity();
  BOOST_TEST(first() == "the moments of inertia are balanced: all are their mean (finger)");
  file = seen = Arm();
  file.sensor = Inertial{0.1, {0, 0, 0}, {0, 0, 0}, Matrix3d::Identity()};
  seen.sensor =
      Inertial{6, {0.01, 0.02, 0.03}, {0.1, 0.2, 0.3}, inertia(0.065, 0.05, 0.025, 0, 0, 0)};
  BOOST_TEST(first() == "the inertia is that of the collision shapes, of 1000 kg/m^3 (sensor)");
  file.sensor = Inertial{0, {0, 0, 0}, {0, 0, 0}, Matrix3d::Zero()};
  seen.sensor = Inertial{1, {0, 0, 0}, {0, 0, 0}, Matrix3d::Identity()};
  BOOST_TEST(first() == "a massless link gets 1 kg and 1 kg m^2 (sensor)");
}

// What no text says: kept by the reader alone.
BOOST_AUTO_TEST_CASE(defaults_of_the_reader_are_named) {
  const std::string file = text(Arm());
  const auto first = [&](const RobotChange& change) {
    const std::vector<Misreading> found = findingsOf(file, readerOf(file, change));
    BOOST_REQUIRE(!found.empty());
    return found[0].link + ": " + found[0].quantity + ": " + found[0].rule;
  };
  BOOST_TEST(first([](Robot& r) { r.bodies[0].armature = 0.01; }) ==
             "arm: armature: a default of the reader's, 0.01");
  BOOST_TEST(first([](Robot& r) {
               r.gravity = {0, -9.81, 0};
             }) == ": gravity: it points elsewhere");
  BOOST_TEST(first([](Robot& r) { r.gravity.setZero(); }) == ": gravity: there is none");
  BOOST_TEST(first([](Robot& r) { r.gravity *= -1; }) == ": gravity: it has the other sign");
  BOOST_TEST(first([](Robot& r) { r.gravity *= 10 / 9.81; }) == ": gravity: it has another size");
  BOOST_TEST(first([](Robot& r) { r.bodies[0].axis *= 2; }) ==
             "arm: axis: the axis is not normalised");
  BOOST_TEST(first([](Robot& r) { r.bodies[0].lower.reset(), r.bodies[0].upper.reset(); }) ==
             "arm: limits: they are ignored");
  BOOST_TEST(first([](Robot& r) { r.bodies[0].moments.mass *= 1.001; }) == "arm: inertia: ");
  // small and by no mistake: digits, of which 1e-7 of what is read leaves 7
  BOOST_TEST(first([](Robot& r) { r.bodies[0].moments.mass *= 1 + 1e-7; }) ==
             "arm: inertia: digits are lost: 7.0 are left");
  BOOST_TEST(first([](Robot& r) { r.bodies[0].placement.translation() *= 1 + 2e-7; }) ==
             "arm: origin: digits are lost: 7.0 are left");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  BOOST_TEST(first([&](Robot& r) { r.bodies[0].moments.mass = nan; }) == "arm: inertia: ");
  BOOST_TEST(first([&](Robot& r) { r.bodies[0].moments.second(0, 0) = nan; }) == "arm: inertia: ");
  for (const double share : {0.0, nan, std::numeric_limits<double>::infinity(), 1.0, 2e-4})
    BOOST_TEST(digitsLost(share) == "");
  BOOST_TEST(digitsLost(1e-4) == "digits are lost: 4.0 are left");
  Arm follows;
  follows.mimic = "<mimic joint=\"shoulder\" multiplier=\"-2\"/>";
  const std::vector<Misreading> found = findingsOf(text(follows), readerOf(file));
  BOOST_REQUIRE(found.size() == 1u);
  BOOST_TEST(found[0].rule == "it is ignored: the joint moves by itself");
}

// An engine may show one model and compute with another.
BOOST_AUTO_TEST_CASE(an_answer_that_is_not_that_of_the_model_shown_is_found) {
  const std::string file = text(Arm());
  Reader reader = readerOf(file);
  const auto read = reader.read;
  reader.read = [read](const std::string& t, const std::filesystem::path& f) {
    Reading reading = read(t, f);
    reading.answer = [robot = reading.robot](const std::vector<double>& q) {
      MassAndGravity out = massAndGravity(robot, q);
      out.M(1, 0) *= 1 + 1e-9;
      return out;
    };
    return reading;
  };
  const std::vector<Misreading> found = findingsOf(file, reader);
  BOOST_REQUIRE(found.size() == 1u);
  BOOST_TEST(found[0].quantity == "M");
}

BOOST_AUTO_TEST_CASE(a_reader_of_the_file_has_no_finding) {
  BOOST_TEST(findingsOf(text(Arm()), readerOf(text(Arm()))).empty());
}

// A reader that keeps every link in the frame of the whole model rounds where the model is far
// away; four times as much is another place.
BOOST_AUTO_TEST_CASE(rounding_in_the_frame_of_the_whole_model_is_no_finding) {
  Arm far;
  far.arm_xyz = {300, 400, 0};
  far.finger.com.setZero();
  const auto slipped = [&](double by) {
    return findingsOf(text(far), readerOf(text(far), [by](Robot& r) {
                        ReadBody& finger = r.bodies[1];
                        finger.moments = MassMoments::of(finger.moments.mass, {by, 0, 0},
                                                         finger.moments.aboutCom());
                      }));
  };
  const double rounded = 500 * 2 * roundingOf(0);
  BOOST_TEST(slipped(rounded / 2).empty());
  BOOST_TEST(slipped(rounded * 4).size() == 1u);
}

// By hand: a mass 1 on a lever of 1 m has M = 1; without its lever it has 0.
BOOST_AUTO_TEST_CASE(an_effect_is_what_M_and_g_say) {
  Robot robot;
  robot.gravity = {0, 0, -9.81};
  robot.bodies.resize(1);
  robot.bodies[0].axis = {0, 1, 0};
  robot.bodies[0].moments = MassMoments::of(1, {1, 0, 0}, Matrix3d::Zero());
  Robot changed = robot;
  changed.bodies[0].moments = MassMoments::of(1, {0, 0, 0}, Matrix3d::Zero());
  const Effect effect = effectOf(robot, changed, 50, 1);
  BOOST_TEST(effect.M_percent == 100, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(effect.g > 9.0);
  BOOST_TEST(effect.g <= 9.81);
}

// Jacobians against the sweeps, on the scenes whose joints turn or slide.
BOOST_AUTO_TEST_CASE(M_and_g_by_jacobians_are_those_of_the_sweeps) {
  int compared = 0;
  for (const auto& file : scene::bundledScenes()) {
    const scene::Scene scene = scene::readScene(file);
    const scene::Mechanism mechanism = scene::withoutMimics(scene.mechanism);
    if (mechanism.hasGyroscopicRotors()) continue;
    const Robot robot = FileParts(mechanism).robot();
    bool plain = !robot.bodies.empty();
    for (const ReadBody& body : robot.bodies)
      plain =
          plain && body.stiffness == 0 &&
          (body.kind == scene::JointKind::kRevolute || body.kind == scene::JointKind::kPrismatic);
    if (!plain) continue;
    ++compared;
    const auto model = recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism));
    recursive::Workspace<double> ws(model);
    const auto n = static_cast<std::size_t>(mechanism.dof());
    recursive::MatrixX<double> M(n, n);
    std::vector<double> g(n), zeros(n, 0.0);
    const std::vector<double> q = drawPositions(robot, 3, 0);
    std::vector<scene::JointPosition<double>> x;
    for (const double angle : q) x.push_back(scene::jointPosition(angle));
    recursive::massMatrix(model, x, ws, M);
    recursive::inverseDynamics(model, x, zeros, zeros, ws, g, recursive::Terms::potential());
    const MassAndGravity by_jacobians = massAndGravity(robot, q);
    BOOST_TEST_CONTEXT(scene.name) {
      BOOST_TEST(((M - by_jacobians.M).cwiseAbs().array() <= by_jacobians.M_bound.array()).all());
      for (std::size_t i = 0; i < n; ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        BOOST_TEST(std::abs(g[i] - by_jacobians.g[k]) <= by_jacobians.g_bound[k]);
      }
    }
  }
  BOOST_TEST(compared > 10);
}

/// MuJoCo of today has another robot where anything is turned: test_mujoco_of_today.py.
constexpr const char* kOfToday = "mujoco_npm";

/// sdformat leaves out links without inertia, the root with all that hangs on it.
std::string withHeavyBase(std::string file) {
  const std::string base = "<link name=\"base\"/>";
  return file.replace(file.find(base), base.size(),
                      "<link name=\"base\">" + text(Arm().finger) + "</link>");
}

// The real ones: on a file without traps they have its robot; with one, what they are known to do.
BOOST_AUTO_TEST_CASE(engines_have_the_robot_of_a_plain_file) {
  Arm arm;
  arm.sensor =
      Inertial{0.5, {0.01, 0, 0}, {0.1, 0.2, 0.3}, inertia(0.001, 0.0011, 0.0012, 0, 0, 0)};
  for (const Reader& reader : engineReaders()) {
    if (!reader.present || reader.name == kOfToday) continue;
    const ReadersResult result =
        examineReaders(withHeavyBase(text(arm)), "arm.urdf", {reader}, 5, 1);
    BOOST_TEST(result.readers[0].refusal == "");
    BOOST_TEST_CONTEXT(readersText(result, true)) BOOST_TEST(result.agrees());
  }
}

BOOST_AUTO_TEST_CASE(engines_do_what_they_are_known_to_do_with_a_link_without_inertial) {
  const std::map<std::string, std::string> known = {
      {"mujoco", words(Mistake::kGeometryWithoutInertial)}, {"dart", words(Mistake::kDefaultMass)}};
  for (const Reader& reader : engineReaders()) {
    if (!reader.present || reader.name == kOfToday) continue;
    const ReadersResult result =
        examineReaders(withHeavyBase(text(Arm())), "arm.urdf", {reader}, 5, 1);
    const ReaderResult& one = result.readers[0];
    BOOST_TEST_CONTEXT(readersText(result, true)) {
      BOOST_TEST(one.has_read);
      const auto expected = known.find(reader.name);
      BOOST_REQUIRE(one.findings.empty() == (expected == known.end()));
      if (expected == known.end()) continue;
      BOOST_TEST(one.findings[0].rule == expected->second + " (sensor)");
      BOOST_TEST(one.remedy != "");  // it was tried
    }
  }
}

// A finger without <inertial>, which the planted reader gives its default of 1 kg.
BOOST_AUTO_TEST_CASE(a_body_without_inertial_and_a_slip_of_the_pen_are_told_as_the_file_has_them) {
  const std::string robot =
      "<robot name=\"r\">\n<link name=\"base\"/>\n<link name=\"finger\">{}</link>\n"
      "<joint name=\"bend\" type=\"continuous\"><parent link=\"base\"/><child link=\"finger\"/>"
      "<axes xyz=\"0 0 1\"/></joint>\n</robot>\n";
  const auto urdf = [&](const std::string& inertial) {
    std::string text = robot;
    return text.replace(text.find("{}"), 2, inertial);
  };
  const std::string filled = urdf(
      "<inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" "
      "iyz=\"0\"/></inertial>");
  const ReadersResult result = examineReaders(urdf(""), "r.urdf", {readerOf(filled)}, 5, 1);
  BOOST_TEST_REQUIRE(result.remarks.size() == 2u);
  BOOST_TEST(
      result.remarks[0] ==
      "r.urdf:4: joint \"bend\": <joint> has an unknown element <axes> (did you mean axis?): "
      "it is ignored");
  BOOST_TEST(result.remarks[1].find("r.urdf:3: link \"finger\": neither it nor") == 0u);
  const std::string said = readersText(result, false);
  BOOST_TEST(said.find(result.remarks[0]) != std::string::npos, said);
  BOOST_TEST(said.find("the file: no <inertial>, which is 0 kg") != std::string::npos, said);
  BOOST_TEST(readersJson(result, "x").find("\"remarks\"") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(the_command_has_its_exit_status_table_and_json) {
  const Program program;
  program.write("trap.urdf", text(Arm()));
  const fixtures::Outcome outcome =
      program.run("readers trap.urdf --json r.json --plain plain.urdf --mend mended.urdf");
  BOOST_TEST_CONTEXT(outcome.out) {
    BOOST_TEST(outcome.status == 1);
    BOOST_TEST(outcome.out.find("trap.urdf:3: link \"arm\": inertia: a massless link gets") !=
               std::string::npos);
  }
  BOOST_TEST(program.exists("r.json"));
  BOOST_TEST(program.run("readers plain.urdf --all-links").status == 0);
  BOOST_TEST(program.run("same trap.urdf plain.urdf").status == 0);
  fixtures::refuses(program, "readers none.urdf", "none.urdf: cannot be read");
  program.write("x.toml", "title = \"x\"\n");
  fixtures::refuses(program, "readers x.toml", "x.toml");
  program.write("x.xacro", "<robot name=\"x\"><xacro:property name=\"a\" value=\"1\"/></robot>");
  fixtures::refuses(program, "readers x.xacro", "is in xacro");
}
