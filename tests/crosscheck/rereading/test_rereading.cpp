// SPDX-License-Identifier: GPL-3.0-or-later
// The second reading of scene files: it agrees with the first one on every file that there is, and
// a fault planted into the first one, of each kind that readers are known for, turns it red without
// any table or engine.
#include "crosscheck/verdicts/check_reading.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/conductor/crosscheck.hpp"
#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/rereading/placing.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/tables.hpp"
#include "crosscheck/witnesses/own_file.hpp"
#include "recursive/build_model.hpp"
#include "scene/changes.hpp"
#include "scene/scene.hpp"
#include "tests/fixtures/files.hpp"

namespace data = boost::unit_test::data;
namespace fs = std::filesystem;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using Model = recursive::Model<RunningError>;

namespace {

scene::Scene sceneOf(const std::string& text) {
  return text[0] == '<' ? scene::readSceneUrdf(text, "arm.urdf")
                        : scene::readSceneToml(text, "arm.toml");
}
Model modelOf(const scene::Scene& scene) {
  return PreparedScene(scene).model<RunningError>();
}

/// The checks of a scene, or of what a fault has made of it, against a text.
std::vector<CheckResult> against(const scene::Scene& scene, const Model& model,
                                 const std::string& text) {
  return compareReading(scene, model, rereading::described(text, scene.file), 1);
}
std::vector<CheckResult> against(const scene::Scene& scene, const std::string& text) {
  return against(scene, modelOf(scene), text);
}

void requireGreen(const std::vector<CheckResult>& checks, const std::string& of) {
  BOOST_TEST(checks.size() >= 3u, of);
  for (const CheckResult& check : checks) {
    if (check.asksNothing()) continue;
    BOOST_TEST((check.verdict == Verdict::kAgree),
               of << ": " << check.quantity << ": " << check.reason);
    BOOST_TEST(check.ratio <= 1, of);
  }
}

/// "placements: link 'upper': R[1,1] is ..."
std::string redOf(const std::vector<CheckResult>& checks) {
  std::string red;
  for (const CheckResult& check : checks)
    if (check.verdict == Verdict::kDisagree) red += check.quantity + ": " + check.reason + "\n";
  return red;
}

std::string leftOutOf(const std::vector<CheckResult>& checks) {
  for (const CheckResult& check : checks)
    if (check.asksNothing()) return check.reason;
  return "";
}

scene::Number number(const std::string& text) {
  return scene::Number::parse(text);
}
scene::Number negative(const scene::Number& x) {
  return number("-(" + x.text() + ")");
}

// Everything that a reader can get wrong stands in it: three conventions, two turned inertias, a
// tool on a turned and moved fixed joint, expressions with every order of operations, no gravity.
const std::string kArm = R"(title = "Arm"
source = "chosen here"
[parameters]
a = 0.3
b = 0.5
c = 0.7
d = "a - b + c"
[[link]]
name = "base"
[[link]]
name = "upper"
parent = "base"
mass = "1 + a/b*c"
com = [0.1, "(-a)^2", -0.05]
inertia = { rpy = [0.3, -0.4, 0.5], xx = 0.02, yy = 0.03, zz = 0.04, xy = 0.003, xz = -0.002, yz = 0.001 }
[link.joint]
name = "shoulder"
kind = "revolute"
axis = [1, 2, 2]
xyz = [0.1, 0.2, "d"]
rpy = [0.3, 0.5, -0.7]
rotor_inertia = 1e-4
gear_ratio = 50
friction = { viscous = 0.1, coulomb = { positive = 0.2, negative = 0.3 } }
[[link]]
name = "tool"
parent = "upper"
mass = 0.5
com = [0.02, 0.1, 0.03]
inertia = { xx = 0.002, yy = 0.003, zz = 0.004, xz = 0.0005 }
[link.joint]
kind = "fixed"
xyz = [0.2, -0.1, 0.15]
rpy = [0.4, 0.2, -0.3]
[[link]]
name = "fore"
parent = "upper"
mass = 0.8
com = [0.1, 0, 0.02]
inertia = { about = "origin", xx = 0.02, yy = 0.05, zz = 0.06 }
[link.joint]
kind = "revolute"
dh = { a = 0.4, alpha = 0.6, d = 0.1, theta = 0.2 }
[[link]]
name = "wrist"
parent = "fore"
mass = 0.4
com = [0.05, 0.01, 0]
inertia = { xx = 0.002, yy = 0.003, zz = 0.004 }
[link.joint]
kind = "prismatic"
mdh = { a = 0.2, alpha = -0.5, d = 0.3, theta = 0.7 }
[[link]]
name = "screw"
parent = "wrist"
mass = 0.2
com = [0.01, 0.02, 0.03]
inertia = { xx = 0.001, yy = 0.001, zz = 0.001 }
[link.joint]
kind = "helical"
axis = [0, 0.6, 0.8]
pitch = "pi/100"
[[link]]
name = "hand"
parent = "screw"
mass = 0.2
com = [0.01, 0.02, 0.03]
inertia = { xx = 0.001, yy = 0.001, zz = 0.001 }
[link.joint]
kind = "universal"
rotors = [{ inertia = "a*1e-6", ratio = [50, "-c"] }, { inertia = 2e-6, ratio = [0, 7], axis = [1, 0, "b"] }]
)";

const std::string kUrdf = R"(<?xml version="1.0"?>
<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <visual><geometry><sphere radius="1"/></geometry></visual>
    <inertial><origin xyz="0.1 0.02 -0.05" rpy="0.3 -0.4 0.5"/><mass value="1.5"/>
      <inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.003" ixz="-0.002" iyz="0.001"/></inertial>
  </link>
  <link name="tool">
    <inertial><mass value=".5"/><origin xyz="0.02 0.1 0.03"/>
      <inertia ixx="2e-3" iyy="3e-3" izz="4e-3" ixy="0" ixz="5e-4" iyz="0"/></inertial>
  </link>
  <link name="fore">
    <inertial><mass value="0.8"/><inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="finger">
    <inertial><mass value="0.1"/><origin xyz="0 0 0.05"/><inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="grip" type="prismatic"><parent link="fore"/><child link="finger"/>
    <axis xyz="0 1 0"/><origin xyz="0 0.1 0"/><limit lower="0" upper="1" effort="1" velocity="1"/>
    <mimic joint="elbow" multiplier="-0.25" offset="0.1"/></joint>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/>
    <axis xyz="1 2 2"/><origin xyz="0.1 0.2 0.3" rpy="0.3 1.5707963267948966 -0.7"/>
    <dynamics damping="0.1" friction="0.2"/></joint>
  <joint name="glue" type="fixed"><parent link="upper"/><child link="tool"/>
    <origin xyz="0.2 -0.1 0.15" rpy="0.4 0.2 -0.3"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
    <origin xyz="0.4 0 0" rpy="0.1 -0.2 0.9"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <transmission name="drive"><joint name="shoulder"/><actuator name="motor">
    <mechanicalReduction>50</mechanicalReduction></actuator></transmission>
</robot>
)";

/// A fault of a reader.
struct Plant {
  const char* what;
  const std::string& text;
  std::function<void(scene::Scene&)> spoil;
  const char* red;  ///< the check, and where
};
std::ostream& operator<<(std::ostream& out, const Plant& plant) {
  return out << plant.what;
}

scene::Link& link(scene::Scene& scene, const std::string& name) {
  for (scene::Link& found : scene.mechanism.links)
    if (found.name == name) return found;
  throw std::invalid_argument(name);
}
scene::Placement& place(scene::Scene& scene, const std::string& name) {
  return link(scene, name).joint.placement;
}
void noGravity(scene::Scene& scene) {
  scene.mechanism.has_gravity = false;
}

const std::vector<Plant> kPlants = {
    {"order of rpy", kArm,
     [](auto& s) { std::swap(place(s, "upper").rpy[0], place(s, "upper").rpy[2]); },
     "placements: link 'upper'"},
    {"rpy the other way", kArm,
     [](auto& s) {
       for (scene::Number& x : place(s, "upper").rpy) x = negative(x);
     },
     "placements: link 'upper'"},
    {"DH with theta for alpha", kArm,
     [](auto& s) { std::swap(place(s, "fore").theta, place(s, "fore").alpha); },
     "placements: link 'fore'"},
    {"DH with d for a", kArm, [](auto& s) { std::swap(place(s, "fore").d, place(s, "fore").a); },
     "placements: link 'fore'"},
    {"modified DH read as DH", kArm,
     [](auto& s) { place(s, "wrist").convention = scene::Placement::Convention::kDh; },
     "placements: link 'wrist'"},
    {"DH read as modified DH", kArm,
     [](auto& s) { place(s, "fore").convention = scene::Placement::Convention::kMdh; },
     "placements: link 'fore'"},
    {"the axis as z", kArm,
     [](auto& s) {
       link(s, "upper").joint.axis = {0, 0, 1};
     },
     "placements: link 'upper'"},
    {"the inertial frame not turned", kArm, [](auto& s) { link(s, "upper").inertia.rpy = {}; },
     "masses: link 'upper'"},
    {"the order of an inertia's rpy", kArm,
     [](auto& s) { std::swap(link(s, "upper").inertia.rpy[0], link(s, "upper").inertia.rpy[2]); },
     "masses: link 'upper'"},
    {"signs of products", kArm,
     [](auto& s) {
       scene::MassProperties& m = link(s, "upper").inertia;
       for (scene::Number* x : {&m.xy, &m.xz, &m.yz}) *x = negative(*x);
     },
     "masses: link 'upper'"},
    {"products in another order", kArm,
     [](auto& s) { std::swap(link(s, "upper").inertia.xy, link(s, "upper").inertia.yz); },
     "masses: link 'upper'"},
    {"inertia about the wrong point", kArm,
     [](auto& s) { link(s, "fore").inertia.about = scene::MassProperties::About::kCenterOfMass; },
     "masses: link 'fore'"},
    {"(-a)^2 as -(a^2)", kArm, [](auto& s) { link(s, "upper").inertia.com[1] = number("-(a^2)"); },
     "masses: link 'upper'"},
    {"a/b*c as a/(b*c)", kArm,
     [](auto& s) { link(s, "upper").inertia.mass = number("1 + a/(b*c)"); },
     "masses: link 'upper'"},
    {"a-b+c as a-(b+c)", kArm,
     [](auto& s) { s.mechanism.parameters[3].value = number("a - (b + c)"); },
     "placements: link 'upper': z"},
    {"pitch in degrees", kArm,
     [](auto& s) {
       scene::Number& pitch = link(s, "screw").joint.pitch;
       pitch = number("(" + pitch.text() + ")/57");
     },
     "placements: link 'screw'"},
    {"pitch a turn", kArm, [](auto& s) { link(s, "screw").joint.pitch = number("1/200"); },
     "numbers: joint 'screw': pitch"},
    {"gravity where none is given", kArm,
     [](auto& s) {
       s.mechanism.has_gravity = true;
       s.mechanism.gravity = {0, 0, number("-9.81")};
     },
     "numbers: gravity: z"},
    {"gear ratio not read", kArm, [](auto& s) { link(s, "upper").joint.gear_ratio = 1; },
     "numbers: joint 'shoulder': gear ratio"},
    {"the ratios of a rotor in another order", kArm,
     [](auto& s) {
       std::swap(link(s, "hand").joint.rotors[0].ratio[0],
                 link(s, "hand").joint.rotors[0].ratio[1]);
     },
     "numbers: rotor 1 of joint 'hand': ratio"},
    {"the axis of a rotor turned round", kArm,
     [](auto& s) { (*link(s, "hand").joint.rotors[1].axis)[2] = number("-b"); },
     "numbers: rotor 2 of joint 'hand': axis z"},
    {"a gyroscopic rotor as a plain one", kArm,
     [](auto& s) { link(s, "hand").joint.rotors[1].axis.reset(); },
     "placements: whether a rotor is gyroscopic of link 'hand'"},
    {"friction the same both ways", kArm,
     [](auto& s) {
       scene::Friction& f = link(s, "upper").joint.friction;
       f.negative = f.positive;
     },
     "numbers: joint 'shoulder': Coulomb friction backwards"},
    {"the order of links", kArm,
     [](auto& s) {
       std::swap(s.mechanism.links[2], s.mechanism.links[3]);
       s.mechanism.links[4].parent = 2;
     },
     "placements: link number 3"},
    {"a link on another parent", kArm, [](auto& s) { link(s, "wrist").parent = 1; },
     "placements: the parent of link 'wrist'"},
    {"order of rpy in URDF", kUrdf,
     [](auto& s) { std::swap(place(s, "fore").rpy[0], place(s, "fore").rpy[2]); },
     "placements: link 'fore'"},
    {"degrees in URDF", kUrdf,
     [](auto& s) {
       for (scene::Number& x : place(s, "fore").rpy) x = number("(" + x.text() + ")*pi/180");
     },
     "placements: link 'fore'"},
    {"inertial frame of URDF not turned", kUrdf, [](auto& s) { link(s, "upper").inertia.rpy = {}; },
     "masses: link 'upper'"},
    {"products of URDF with the other sign", kUrdf,
     [](auto& s) { link(s, "upper").inertia.xy = negative(link(s, "upper").inertia.xy); },
     "masses: link 'upper'"},
    {"the axis that URDF leaves out as z", kUrdf,
     [](auto& s) {
       link(s, "fore").joint.axis = {0, 0, 1};
     },
     "placements: link 'fore'"},
    {"URDF without gravity", kUrdf, noGravity, "numbers: gravity: z"},
    {"a follower that does not", kUrdf,
     [](auto& s) { link(s, "finger").joint.mimic->multiplier = number("1/4"); },
     "placements: link 'finger'"},
    {"damping not read", kUrdf, [](auto& s) { link(s, "upper").joint.friction.viscous = 0; },
     "numbers: joint 'shoulder': viscous friction"},
};

/// Writes a file, and is the scene in it.
scene::Scene written(const fs::path& file, const std::string& text) {
  std::ofstream(file) << text;
  return scene::readScene(file);
}

}  // namespace

// ---- the evaluator ------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(expressions_have_the_values_that_algebra_gives_them) {
  rereading::Parameters known;
  known["a"] = rereading::decimal("3");
  known["b_1"] = rereading::decimal("2");
  // by hand
  const std::vector<std::pair<const char*, double>> values = {
      {"-a^2", -9},          {"(-a)^2", 9},      {"a/b_1*4", 6},   {"a - b_1 + 4", 5},
      {"a - (b_1 + 4)", -3}, {"2*-a", -6},       {"-a*b_1", -6},   {"2^-2", 0.25},
      {"-2^-2*8", -2},       {"1.5e2", 150},     {".5 + 5.", 5.5}, {"8/2/2", 2},
      {"a*(b_1 - 1)^3", 3},  {"-(a - 1)*2", -4}, {"+a - -a", 6},   {"1e-3*1e3", 1},
      {"((a))", 3},          {" a\t*\n2 ", 6},   {"2*a^2/b_1", 9}, {"10 - 4 - 3", 3},
  };
  for (const auto& [text, value] : values)
    BOOST_TEST(static_cast<double>(rereading::evaluated(text, known).value) == value, text);
  const std::vector<std::pair<const char*, double>> functions = {
      {"cos(pi/3)", 0.5},     {"-2*sin (1)^2", -1.416146836547142},  // -(1 - cos 2)
      {"sqrt(16)/b_1", 2},    {"a*asin(1/2)", 1.5707963267948966},
      {"sqrt(2)*sqrt(2)", 2}, {"sin(-(pi/2))", -1}};
  for (const auto& [text, value] : functions) {
    const rereading::Value found = rereading::evaluated(text, known);
    BOOST_TEST(std::abs(static_cast<double>(found.value) - value) <= 1e-15 * std::abs(value), text);
    BOOST_TEST(found.error < 1e-47, text);
  }
  // where the arcsine is infinitely steep half of the digits are left
  const rereading::Value end = rereading::evaluated("a*asin(1)", known);
  BOOST_TEST(std::abs(static_cast<double>(end.value) - 4.71238898038469) <= 1e-15 * 4.8);
  BOOST_TEST(end.error < 1e-23);
  const rereading::Value pi = rereading::evaluated("2*pi/2", known);
  BOOST_TEST(static_cast<double>(pi.value) == 3.141592653589793);
  for (const char* text :
       {"", "a +", "(a", "a)", "a b_1", "2^a", "x", "1/0", "1/(a - 3)", "a ** 2", "1..2", "exp(1)",
        "a(2)", "sin", "sin 1", "cos()", "asin(2)", "sqrt(-1)", "cos(1"})
    BOOST_CHECK_THROW(rereading::evaluated(text, known), std::runtime_error);
}

BOOST_AUTO_TEST_CASE(a_value_knows_how_far_it_may_be_off) {
  const rereading::Value third = rereading::evaluated("1/3", {});
  BOOST_TEST(third.error > 0);
  BOOST_TEST(static_cast<double>(abs(3 * third.value - 1)) <= 3 * third.error);
  // what cancels leaves the error of what it was
  const rereading::Value left = rereading::evaluated("(1e20 + 1/3) - 1e20", {});
  BOOST_TEST(static_cast<double>(abs(3 * left.value - 1)) <= 3 * left.error);
  BOOST_TEST(left.error > 1e10 * third.error);
}

// ---- both readings agree ------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(every_file_of_ours_is_read_the_same_twice) {
  std::vector<fs::path> files = scene::bundledScenes();
  for (const fs::path& table : bundledTables())
    if (const fs::path own = ownScene(table); !own.empty()) files.push_back(own);
  files.push_back(fs::path(DYNWITNESS_SOURCE_DIR) / "tests/crosscheck/readers/trap.urdf");
  BOOST_TEST(files.size() > 40u);
  for (const fs::path& file : files) {
    const PreparedScene scene(scene::readScene(file));
    const std::vector<CheckResult> checks = checkReading(scene, 1);
    requireGreen(checks, file.filename().string());
    // functions of time are all that is left out
    const std::string left_out = leftOutOf(checks);
    BOOST_TEST(left_out.empty() != scene.mechanism().isDriven(), file << ": " << left_out);
    if (!left_out.empty()) BOOST_TEST(files::contains(left_out, "motion of joint '"), left_out);
  }
}

BOOST_AUTO_TEST_CASE(random_mechanisms_are_read_the_same_twice) {
  for (int index = 0; index < 150; ++index) {
    const std::string text = scene::writeSceneToml(randomScene(7, index, 8));
    const scene::Scene scene = scene::readSceneToml(text, "random.toml");
    requireGreen(against(scene, text), "random " + std::to_string(index));
  }
}

BOOST_AUTO_TEST_CASE(what_is_written_as_urdf_is_read_the_same_twice) {
  int count = 0;
  for (const fs::path& file : scene::bundledScenes()) {
    std::string text;
    try {
      text = scene::writeSceneUrdf(scene::readScene(file));
    } catch (const scene::InputError&) {
      continue;  // a joint that URDF has not
    }
    ++count;
    requireGreen(against(scene::readSceneUrdf(text, "again.urdf"), text), file.stem().string());
  }
  BOOST_TEST(count > 20);
}

BOOST_AUTO_TEST_CASE(every_joint_kind_axis_and_placement_is_read_the_same_twice) {
  for (const char* kind : {"revolute", "prismatic", "helical", "cylindrical", "planar", "universal",
                           "spherical", "floating"}) {
    for (const char* axis :
         {"", "axis = [0, 0, -2]\n", "axis = [0.3, -0.4, 1.2]\n", "axis = [1, 0, 0]\n"}) {
      const std::string name = kind;
      if (*axis != '\0' && (name == "universal" || name == "spherical" || name == "floating"))
        continue;
      std::string joint =
          "[link.joint]\nkind = \"" + name + "\"\nxyz = [0.1, 0.2, 0.3]\nrpy = [0.3, 0.5, -0.7]\n";
      joint += axis;
      if (name == "helical") joint += "pitch = 0.03\n";
      const std::string text =
          "title = \"x\"\nsource = \"x\"\n[[link]]\nname = \"base\"\n"
          "[[link]]\nname = \"tip\"\nparent = \"base\"\nmass = 1\ncom = [0.1, 0.2, 0.3]\n"
          "inertia = { xx = 0.1, yy = 0.1, zz = 0.1 }\n" +
          joint;
      requireGreen(against(sceneOf(text), text), name + " " + axis);
    }
  }
}

// Numbers have functions in them: both readers evaluate them, by formulas of their own.
BOOST_AUTO_TEST_CASE(functions_in_placements_and_inertias_are_read_the_same_twice) {
  const std::string text =
      "[parameters]\nk = \"cos(pi/10)\"\n[[link]]\nname = \"base\"\n"
      "[[link]]\nname = \"tip\"\nparent = \"base\"\nmass = \"sqrt(2)\"\n"
      "com = [\"0.3*k\", \"-0.3*sin(pi/10)\", 0]\n"
      "inertia = { xx = 0.1, yy = \"0.1*cos(0.2)\", zz = 0.1 }\n"
      "[link.joint]\nkind = \"revolute\"\nxyz = [\"cos(3*pi/4)\", 0, \"sin(pi/3)\"]\n"
      "rpy = [\"asin(0.3)\", \"asin(1/2)\", 0]\naxis = [\"sin(pi/10)\", 0, \"k\"]\n";
  requireGreen(against(sceneOf(text), text), "functions");
  // what one reader takes for another number
  for (const auto& [was, is, red] :
       {std::array<const char*, 3>{"sin(pi/3)", "sin(pi/3 + 2e-8)", "placements"},
        {"asin(0.3)", "-asin(0.3)", "placements"},
        {"0.1*cos(0.2)", "0.1*cos(0.2001)", "mass"},
        {"sqrt(2)", "sqrt(2.000001)", "mass"}}) {
    std::string other = text;
    other.replace(other.find(was), std::string(was).size(), is);
    const std::string seen = redOf(against(sceneOf(other), text));
    BOOST_TEST(files::contains(seen, red), was << ": " << seen);
  }
}

// ---- a fault of a reader is seen ----------------------------------------------------------------

BOOST_DATA_TEST_CASE(a_fault_of_a_reader_turns_it_red, data::make(kPlants), plant) {
  scene::Scene scene = sceneOf(plant.text);
  requireGreen(against(scene, plant.text), "without the fault");
  plant.spoil(scene);
  const std::string red = redOf(against(scene, plant.text));
  BOOST_TEST(files::contains(red, plant.red), red);
}

BOOST_AUTO_TEST_CASE(a_fault_of_lumping_turns_it_red) {
  for (const std::string& text : {kArm, kUrdf}) {
    const scene::Scene scene = sceneOf(text);
    scene::Scene straight = scene, centred = scene;
    place(straight, "tool").rpy = {};
    place(centred, "tool").xyz = {};
    link(centred, "tool").inertia.com = {};
    Model not_turned = modelOf(scene), no_parallel_axis = not_turned, no_tool = not_turned;
    // what the tool weighs, and nothing of where it is
    const int upper = not_turned.places[1].link;
    not_turned.links[upper].M = modelOf(straight).links[upper].M;
    no_parallel_axis.links[upper].M.I = modelOf(centred).links[upper].M.I;
    scene::Scene without = scene;
    link(without, "tool").inertia = {};
    no_tool.links[upper].M = modelOf(without).links[upper].M;
    for (const Model* wrong : {&not_turned, &no_parallel_axis, &no_tool}) {
      const std::string red = redOf(against(scene, *wrong, text));
      BOOST_TEST(files::contains(red, "masses: link 'upper'"), red);
      BOOST_TEST(!files::contains(red, "placements"), red);
    }
  }
}

BOOST_AUTO_TEST_CASE(the_smallest_fault_that_double_keeps_is_seen) {
  // 1e-13 of a length, 1e-12 of an angle, 1e-12 of a moment of inertia
  const auto spoilt = [](const std::function<void(scene::Scene&)>& spoil) {
    scene::Scene scene = sceneOf(kArm);
    spoil(scene);
    return redOf(against(scene, kArm));
  };
  BOOST_TEST(
      !spoilt([](auto& s) { place(s, "upper").xyz[0] = number("0.1*(1 + 1e-13)"); }).empty());
  BOOST_TEST(
      !spoilt([](auto& s) { place(s, "upper").rpy[1] = number("0.5*(1 + 1e-12)"); }).empty());
  BOOST_TEST(
      !spoilt([](auto& s) { link(s, "upper").inertia.xx = number("0.02*(1 + 1e-12)"); }).empty());
}

BOOST_AUTO_TEST_CASE(what_differs_is_told_in_the_units_of_the_file) {
  scene::Scene scene = sceneOf(kArm);
  place(scene, "fore").a = number("0.403");
  const std::string red = redOf(against(scene, kArm));
  // at q = 0, the first link that is off: x of the origin of 'fore' alone depends on the rest
  BOOST_TEST(files::contains(red, "placements: link 'fore': "), red);
  BOOST_TEST(files::contains(red, " m by the file's own text and "), red);
  BOOST_TEST(files::contains(red, " m in the scene, and "), red);
}

// ---- in a report --------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(a_crosscheck_of_a_users_file_is_red_where_the_scene_is_not_what_it_says) {
  const files::TemporaryFolder folder;
  scene::Scene scene = written(folder.path / "arm.toml", kArm);
  const std::vector<WitnessKind> kinds = selectWitnesses({"newton_euler", "articulated_body"});
  Options options;
  options.states = 2;
  options.drift = false;
  options.error_probability = 0.5;
  CrosscheckResult result;
  result.scenes = {crosscheckScene(scene, kinds, options)};
  BOOST_TEST((result.verdict() == RunVerdict::kAgree), result.headline());
  std::swap(place(scene, "upper").rpy[0], place(scene, "upper").rpy[2]);
  result.scenes = {crosscheckScene(scene, kinds, options)};
  BOOST_TEST((result.verdict() == RunVerdict::kDisagree), result.headline());
  bool is_told = false;
  for (const Finding& finding : result.scenes[0].findings)
    is_told =
        is_told || (finding.witness == kRereading && files::contains(finding.text, "link 'upper'"));
  BOOST_TEST(is_told);
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

// What a scene changes of another one: the same as the command line changes it, read twice, and
// each change that is lost is seen.
BOOST_AUTO_TEST_CASE(what_a_scene_changes_of_another_is_read_the_same_twice) {
  const files::TemporaryFolder folder;
  const scene::Scene puma = scene::findScene("puma_560_friction");
  write(folder.path / "arm.urdf", scene::writeSceneUrdf(puma));
  const fs::path file = folder.path / "mine.toml";
  const std::string text =
      "like = \"arm.urdf\"\ngravity = [0, \"-payload\", -1.62]\nbase = \"floating\"\n"
      "[parameters]\npayload = 2\n[set]\n\"mass:link_6\" = \"payload/3\"\n"
      "\"com:link_6\" = [0, 0.01, \"1/30\"]\n\"damping:joint_1\" = 0.125\n"
      "\"coulomb:joint_2\" = 3\n\"mass:base\" = 4\n\"inertia:base\" = [1, 1, 1, 0, 0, 0.1]\n";
  write(file, text);
  const scene::Scene mine = scene::readScene(file);
  requireGreen(against(mine, text), "mine");
  BOOST_TEST(leftOutOf(against(mine, text)) == "");

  scene::Changes changes;
  changes.gravity = "0,-2,-1.62";
  changes.base = "floating";
  changes.sets = {"mass:link_6=2/3",       "com:link_6=0,0.01,1/30",
                  "damping:joint_1=0.125", "coulomb:joint_2=3",
                  "mass:base=4",           "inertia:base=1,1,1,0,0,0.1"};
  const scene::Scene by_options =
      scene::changed(scene::readScene(folder.path / "arm.urdf"), changes);
  requireGreen(compareReading(by_options, modelOf(by_options), rereading::described(text, file), 1),
               "by options");
  for (const std::string& lost : changes.sets) {
    scene::Changes others = changes;
    others.sets.erase(std::find(others.sets.begin(), others.sets.end(), lost));
    if (lost == "mass:base=4") continue;  // a base without mass has no inertia
    const scene::Scene without = scene::changed(scene::readScene(folder.path / "arm.urdf"), others);
    BOOST_TEST(
        redOf(compareReading(without, modelOf(without), rereading::described(text, file), 1)) != "",
        lost);
  }
  const std::string flat = scene::writeSceneToml(mine);
  BOOST_TEST(flat.find("like") == std::string::npos);
  requireGreen(against(scene::readSceneToml(flat, "flat.toml"), flat), "flat");
}

BOOST_AUTO_TEST_CASE(parameters_of_another_scene_take_other_values_at_their_places) {
  const files::TemporaryFolder folder;
  const fs::path file = folder.path / "mine.toml";
  write(folder.path / "other.toml",
        files::read(scene::dataFolder() / "scenes" / "double_pendulum.toml"));
  const std::string text =
      "like = \"other\"\n[parameters]\nm2 = \"2*m1\"\nl3 = \"l1 + m2\"\n"
      "[[wrench]]\nlink = \"lower\"\nforce = [0, 0, \"l3\"]\n";
  write(file, text);
  const scene::Scene mine = scene::readScene(file);
  const scene::ParameterValues values = mine.mechanism.parameterValues();
  BOOST_TEST(values.at("m2").toDouble() == 2.0);
  BOOST_TEST(values.at("l3").toDouble() == 2.5);
  requireGreen(against(mine, text), "mine");
  scene::Scene not_replaced = mine;
  for (scene::Parameter& parameter : not_replaced.mechanism.parameters)
    if (parameter.name == "m2") parameter.value = scene::Number::parse("0.8");
  BOOST_TEST(redOf(against(not_replaced, text)) != "");
  // a scene that is bundled is no file beside this one
  const std::string bundled = "like = \"double_pendulum\"\n";
  write(file, bundled);
  const scene::Scene twin = scene::readScene(file);
  BOOST_TEST(twin.mechanism.links.size() == 3u);
  requireGreen(compareReading(twin, modelOf(twin),
                              rereading::described(bundled, file, scene::bundledScenes()), 1),
               "like a bundled one");
  BOOST_CHECK_THROW(rereading::described(bundled, file), rereading::NotReread);
}

BOOST_AUTO_TEST_CASE(what_is_not_read_a_second_time_is_named) {
  const files::TemporaryFolder folder;
  const auto leftOut = [](const scene::Scene& scene) { return leftOutOf(checkReading(scene, 1)); };
  BOOST_TEST(files::contains(leftOut(scene::findScene("four_bars_1")), "comes from no file"));
  const std::string body =
      "<mujoco><worldbody><body><joint/><inertial pos=\"0 0 1\" mass=\"1\" diaginertia=\"1 1 1\"/>"
      "</body></worldbody></mujoco>";
  BOOST_TEST(files::contains(leftOut(written(folder.path / "x.xml", body)), "MJCF"));
  std::string urdf = kUrdf;
  urdf.insert(urdf.find("</robot>"), "<gazebo reference=\"upper\"><mass>3</mass></gazebo>");
  BOOST_TEST(
      files::contains(leftOut(written(folder.path / "x.urdf", urdf)), "<gazebo> of the robot"));
}

BOOST_AUTO_TEST_CASE(a_file_that_cannot_be_read_a_second_time_is_a_disagreement) {
  const files::TemporaryFolder folder;
  const scene::Scene scene = written(folder.path / "arm.toml", kArm);
  std::ofstream(folder.path / "arm.toml") << "mass = \"1 +\"";
  const std::string red = redOf(checkReading(scene, 1));
  BOOST_TEST(files::contains(red, "the number of links"), red);
  std::ofstream(folder.path / "arm.toml") << "this is no TOML";
  BOOST_TEST(files::contains(redOf(checkReading(scene, 1)), "cannot be read a second time"));
}

BOOST_AUTO_TEST_CASE(the_report_says_who_read_the_file_itself) {
  const files::TemporaryFolder folder;
  const scene::Scene toml = written(folder.path / "arm.toml", kArm),
                     urdf = written(folder.path / "arm.urdf", kUrdf);
  std::vector<WitnessKind> kinds = selectWitnesses({});
  std::vector<std::string> may;  // of those that are in this build
  for (const WitnessKind& kind : kinds)
    if (kind.info.name == "mujoco" || kind.info.name == "dart") may.push_back(kind.info.name);
  BOOST_TEST(readersOfOwnFile(toml, kinds).empty());
  BOOST_TEST(readersOfOwnFile(urdf, kinds) == may, boost::test_tools::per_element());
  // once it says something else, they are told what the scene has
  scene::Scene other = urdf;
  link(other, "upper").inertia.mass = number("2");
  BOOST_TEST(readersOfOwnFile(other, kinds).empty());
  BOOST_TEST(files::contains(whoReads(checkReading(urdf, 1, {"dart", "mujoco"})[0]),
                             "of the engines dart and mujoco read this file"));
  BOOST_TEST(files::contains(whoReads(checkReading(toml, 1)[0]), "no engine reads this file"));
}

BOOST_AUTO_TEST_CASE(where_all_stand_against_a_table_the_finding_names_the_table_or_the_reading) {
  const auto check = [](CheckKind kind, const char* left, const char* right, Verdict verdict) {
    CheckResult out;
    out.kind = kind;
    out.statement = "Someone, table 3";
    out.quantity = "M";
    out.left = left;
    out.right = right;
    out.verdict = verdict;
    return out;
  };
  const Verdict yes = Verdict::kAgree, no = Verdict::kDisagree;
  CheckResult reading = check(CheckKind::kLaw, kRereading, "scene", yes);
  reading.law = kReading;
  reading.quantity = "placements";
  std::vector<CheckResult> checks = {check(CheckKind::kSame, "a", "b", yes),
                                     check(CheckKind::kTable, "table", "a", no),
                                     check(CheckKind::kTable, "table", "b", no)};
  const auto text = [&] {
    const std::vector<Finding> findings = findTableDisputes("arm", checks);
    return findings.size() == 1 ? findings[0].text : std::to_string(findings.size());
  };
  BOOST_TEST(
      files::contains(
          text(),
          "2 witnesses agree with each other and stand against the table 'Someone, table 3'"),
      text());
  BOOST_TEST(files::contains(text(), "wrong is the table, or the reading"), text());
  checks.push_back(reading);
  BOOST_TEST(files::contains(text(), "the figures in the scene's file, which were read twice"),
             text());
  checks.back().verdict = no;
  BOOST_TEST(files::contains(text(), "wrong is the reading"), text());
  checks[2].verdict = yes;  // one of two: who stands alone says the pair
  BOOST_TEST(text() == "0");
  checks[2].verdict = no;
  checks[0].verdict = no;
  BOOST_TEST(text() == "0");
}

// A link is a product of matrices with 50 digits: some 10^5 operations.
BOOST_AUTO_TEST_CASE(the_cost_is_linear_in_the_links) {
  const auto seconds = [](int links) {
    const std::string text =
        scene::writeSceneToml(scene::findScene("chain_" + std::to_string(links)));
    const scene::Scene scene = scene::readSceneToml(text, "chain.toml");
    const Model model = modelOf(scene);
    const std::clock_t begin = std::clock();
    requireGreen(against(scene, model, text), "chain");
    return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  };
  const double few = seconds(100), many = seconds(800);
  BOOST_TEST_MESSAGE("100 links: " << few << " s, 800 links: " << many << " s");
  BOOST_TEST(many < 8 * 4 * few);  // a square would be 64
}
