// SPDX-License-Identifier: GPL-3.0-or-later
// Every way that we know of to get a scene wrong, and what is said about it.
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "scene/nearest_name.hpp"
#include "scene/scene.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness::scene;

namespace {

struct Bad {
  std::string name, text, message;  ///< the message is to start so
};
std::ostream& operator<<(std::ostream& out, const Bad& bad) {
  return out << bad.name;
}

std::string complaint(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

void requireComplaint(const std::string& message, const std::string& start) {
  BOOST_TEST(message.substr(0, start.size()) == start,
             "said:    " << message << "\nexpected " << start);
}

// Lines 1 to 3 of most scenes below: the root. The case's own text begins at line 4.
const std::string kBase = "[[link]]\nname = \"base\"\n\n";
// ... and a sound link "upper" at lines 4 to 9; the case's own text begins at line 10.
const std::string kUpper = kBase +
                           "[[link]]\nname = \"upper\"\nparent = \"base\"\nmass = 1\n"
                           "com = [1, 0, 0]\njoint = { kind = \"revolute\" }\n";

/// One moving link, with its body and joint to be filled in. The link is at line 4.
std::string oneLink(const std::string& body, const std::string& joint = "kind = \"revolute\"") {
  return kBase + "[[link]]\nname = \"upper\"\nparent = \"base\"\n" + body + "\n[link.joint]\n" +
         joint + "\n";
}

/// A closure (or what is said) at lines 10 and on; `ends` are its a and b.
std::string closure(const std::string& first, const std::string& ends) {
  return kUpper + "\n[[closure]]\n" + first + "\n" + ends + "\n";
}
const std::string kEnds = "a = { link = \"base\" }\nb = { link = \"upper\" }";

const std::string kSolid = "mass = 1\ninertia = { xx = 1, yy = 1, zz = 1 }";

const Bad kToml[] = {
    {"unknown kind of closure", closure("kind = \"glue\"", kEnds),
     "bad.toml:12: closure \"1\": kind is \"glue\", allowed: distance, plane, planar_point, "
     "point, hinge, weld, skate, rolling"},
    {"closure without a kind", closure("", kEnds), "bad.toml:11: closure \"1\": has no kind"},
    {"closure with one end", closure("kind = \"point\"", "a = { link = \"base\" }"),
     "bad.toml:11: closure \"1\": has no b, allowed: { link = \"name\""},
    {"closure on a link that is none",
     closure("kind = \"point\"", "a = { link = \"base\" }\nb = { link = \"nobody\" }"),
     "bad.toml:14: closure \"1\": b: \"nobody\" is not a link of this scene"},
    {"closure of a link with itself",
     closure("kind = \"point\"", "a = { link = \"upper\" }\nb = { link = \"upper\" }"),
     "bad.toml:11: closure \"1\": no joint moves between links \"upper\" and \"upper\""},
    {"distance without length", closure("kind = \"distance\"", kEnds),
     "bad.toml:11: closure \"1\": has no length, allowed: a length above zero"},
    {"distance of zero", closure("kind = \"distance\"\nlength = 0", kEnds),
     "bad.toml:11: closure \"1\": length is 0, allowed: above zero"},
    {"length of a hinge", closure("kind = \"hinge\"\nlength = 1", kEnds),
     "bad.toml:13: closure \"1\": a hinge has no length"},
    {"disc without radius", closure("kind = \"rolling\"", kEnds),
     "bad.toml:11: closure \"1\": has no radius, allowed: a length above zero"},
    {"disc of no radius", closure("kind = \"rolling\"\nradius = -1", kEnds),
     "bad.toml:11: closure \"1\": radius is -1, allowed: above zero"},
    {"length of a disc", closure("kind = \"rolling\"\nradius = 1\nlength = 1", kEnds),
     "bad.toml:14: closure \"1\": a rolling has no length, allowed: of a distance"},
    {"spring that pushes", kUpper + "\n[[spring]]\n" + kEnds + "\nstiffness = -1\n",
     "bad.toml:11: spring \"1\": stiffness is -1, allowed: zero or more"},
    {"spring with axes",
     kUpper + "\n[[spring]]\na = { link = \"base\", rpy = [0, 0, 1] }\nb = { link = \"upper\" }\n",
     "bad.toml:12: spring \"1\": a: unknown key \"rpy\", allowed: link, xyz"},
    {"tables of another name",
     "[[links]]\nname = \"a\"\n[link.joint]\nkind = \"fixed\"\n[[links]]\n[link.joint]\n",
     "bad.toml:1: scene: unknown table [[links]] (did you mean link?)"},
    {"a table twice", kBase + "[link.joint]\nkind = \"fixed\"\n[link.joint]\n",
     "bad.toml:6: not TOML: "},
    {"a number with its unit", kBase + "[[link]]\nname = \"a\"\nmass = \"1 kg\"",
     "bad.toml:6: link \"a\": mass: expression \"1 kg\": column 3: found \"k\", allowed: an operator "
     "+ - * / ^ or the end; numbers have no units here"},
    {"no unit", kBase + "[[link]]\nname = \"a\"\nmass = \"2 + * kg\"",
     "bad.toml:6: link \"a\": mass: expression \"2 + * kg\": column 5: found \"*\", allowed: a number, a "
     "parameter, pi or \"(\""},
    {"syntax error", "title = \"x\"\ngravity = [0, 0\nq", "bad.toml:3: not TOML: "},
    {"overflowing number", "gravity = [0, 0, 1e999]", "bad.toml:1: not TOML: "},
    {"not UTF-8", "title = \"\xff\"", "bad.toml:1: not TOML: "},
    {"unknown key of the scene", "title = \"x\"\ngravitation = 1\n" + kBase,
     "bad.toml:2: scene: unknown key \"gravitation\", allowed: title, source, gravity, "},
    {"unknown key of a link", kBase + "[[link]]\nname = \"a\"\nmas = 1",
     "bad.toml:6: link \"a\": unknown key \"mas\" (did you mean mass?), allowed: name, parent, mass, com, inertia, "
     "joint"},
    {"unknown key of a joint", oneLink("", "kind = \"revolute\"\nangle = 1"),
     "bad.toml:10: joint \"upper\" (revolute): unknown key \"angle\", allowed: name, kind, xyz"},
    {"axis of a fixed joint", oneLink("", "kind = \"fixed\"\naxis = [0, 0, 1]"),
     "bad.toml:10: joint \"upper\" (fixed): unknown key \"axis\", allowed: name, kind, xyz"},
    {"unknown key of an inertia", oneLink("inertia = { ixx = 1 }"),
     "bad.toml:7: link \"upper\": inertia: unknown key \"ixx\" (did you mean xx?), allowed: about, rpy, xx"},
    {"unknown key of a DH row", oneLink("", "kind = \"revolute\"\ndh = { r = 1 }"),
     "bad.toml:10: joint \"upper\": dh: unknown key \"r\", allowed: a, alpha, d, theta"},
    {"unknown key of a wrench", kUpper + "[[wrench]]\nlink = \"upper\"\ntorque = 1",
     "bad.toml:12: wrench: unknown key \"torque\", allowed: link, force, moment"},
    {"unknown key of the start", kUpper + "[start]\nqdd = [1]",
     "bad.toml:11: start: unknown key \"qdd\" (did you mean qd?), allowed: q, qd"},
    {"unknown joint kind", oneLink("", "kind = \"screw\""),
     "bad.toml:9: joint \"upper\": kind is \"screw\", allowed: fixed, revolute, prismatic"},
    {"no joint kind", oneLink("", ""),
     "bad.toml:8: joint \"upper\": has no kind, allowed: fixed, revolute, prismatic"},
    {"unknown parent",
     kBase + "[[link]]\nname = \"a\"\nparent = \"b\"\njoint = { kind = \"fixed\" }",
     "bad.toml:6: link \"a\": parent \"b\" is not a link"},
    {"cycle of links",
     kBase + "[[link]]\nname = \"a\"\nparent = \"b\"\njoint = { kind = \"fixed\" }\n"
             "[[link]]\nname = \"b\"\nparent = \"a\"\njoint = { kind = \"fixed\" }\n",
     "bad.toml:4: cycle of links: \"a\", child of \"b\", child of \"a\", allowed: a tree"},
    {"a link that is its own parent",
     kBase + "[[link]]\nname = \"a\"\nparent = \"a\"\njoint = { kind = \"fixed\" }\n",
     "bad.toml:4: cycle of links: \"a\", child of \"a\""},
    {"two roots", kBase + "[[link]]\nname = \"other\"\n",
     "bad.toml:4: link \"other\": has no parent, but neither has link \"base\" (bad.toml:1), "
     "allowed: one root"},
    {"no root",
     "[[link]]\nname = \"a\"\nparent = \"b\"\njoint = { kind = \"fixed\" }\n"
     "[[link]]\nname = \"b\"\nparent = \"a\"\njoint = { kind = \"fixed\" }\n",
     "bad.toml:1: no root: every link has a parent (\"a\", child of \"b\", child of \"a\"), "
     "allowed: "
     "one link without a parent"},
    {"no link", "title = \"empty\"", "bad.toml: no root: there is no link"},
    {"parent without joint", kBase + "[[link]]\nname = \"a\"\nparent = \"base\"\n",
     "bad.toml:4: link \"a\": has a parent, but no [link.joint]"},
    {"joint without parent", "[[link]]\nname = \"a\"\n[link.joint]\nkind = \"fixed\"",
     "bad.toml:3: link \"a\": has a joint, but no parent"},
    {"parameter before its definition", "[parameters]\nz = \"2*a\"\na = 1\n" + kBase,
     "bad.toml:2: parameter \"z\": uses \"a\" before it is defined (bad.toml:3)"},
    {"parameter defined by itself", "[parameters]\na = 1\nl = \"l/2\"\n" + kBase,
     "bad.toml:3: parameter \"l\": is defined by itself"},
    {"parameter that does not exist", "[parameters]\na = \"b\"\n" + kBase,
     "bad.toml:2: parameter \"a\": expression \"b\": parameter \"b\" is not defined, allowed: pi"},
    {"parameter called pi", "[parameters]\npi = 3\n" + kBase,
     "bad.toml:2: parameter \"pi\": not a name, allowed: letters, digits"},
    {"parameter that is no identifier", "[parameters]\nl-1 = 3\n" + kBase,
     "bad.toml:2: parameter \"l-1\": not a name, allowed: letters, digits"},
    {"unknown parameter in a link", "[parameters]\nm = 1\n" + oneLink("mass = \"M\""),
     "bad.toml:9: link \"upper\": mass: expression \"M\": parameter \"M\" is not defined, allowed: "
     "m, pi"},
    {"duplicate parameters", "[parameters]\nm = 1\nm = 2\n" + kBase, "bad.toml:3: not TOML: "},
    {"duplicate links", kBase + kBase,
     "bad.toml:4: link \"base\": the name is taken by the link of bad.toml:1"},
    {"duplicate joints",
     kUpper + "[[link]]\nname = \"hand\"\nparent = \"base\"\n"
              "joint = { name = \"upper\", kind = \"fixed\" }\n",
     "bad.toml:10: joint \"upper\" of link \"hand\": the name is taken by the joint of link "
     "\"upper\" "
     "(bad.toml:4)"},
    {"infinite number", oneLink("mass = inf"), "bad.toml:7: link \"upper\": mass: not finite"},
    {"nan", oneLink("com = [0,\n nan, 0]"), "bad.toml:8: link \"upper\": com: not finite"},
    {"number beyond double", oneLink("mass = \"1e308*10\""),
     "bad.toml:7: link \"upper\": mass: expression \"1e308*10\": not finite"},
    {"huge exponent", oneLink("mass = \"1e999999999\""),
     "bad.toml:7: link \"upper\": mass: expression \"1e999999999\": number 1e999999999 is too "
     "large"},
    {"division by zero", oneLink("mass = \"1/0\""),
     "bad.toml:7: link \"upper\": mass: expression \"1/0\": division by zero"},
    {"unbalanced parenthesis", oneLink("mass = \"2*(1+1\""),
     "bad.toml:7: link \"upper\": mass: expression \"2*(1+1\": unbalanced parenthesis"},
    {"deep nesting", oneLink("mass = \"" + std::string(5000, '(') + "\""),
     "bad.toml:7: link \"upper\": mass: expression \"(((((((((("},
    {"string where a table belongs", "link = \"base\"",
     "bad.toml:1: link: a string, allowed: [[link]] tables"},
    {"one table where an array belongs", "[link]\nname = \"base\"",
     "bad.toml:1: link: a table, allowed: [[link]] tables"},
    {"array of other things", "link = [1]",
     "bad.toml:1: link: an integer, allowed: [[link]] tables"},
    {"string for a joint",
     kBase + "[[link]]\nname = \"a\"\nparent = \"base\"\njoint = \"revolute\"",
     "bad.toml:7: link \"a\": joint: a string, allowed: a table"},
    {"string for the parameters", "parameters = \"m = 1\"",
     "bad.toml:1: parameters: a string, allowed: a table"},
    {"boolean for a number", oneLink("mass = true"),
     "bad.toml:7: link \"upper\": mass: a boolean, allowed: a number or a string"},
    {"date for a number", oneLink("mass = 2005-01-01"),
     "bad.toml:7: link \"upper\": mass: a date or time, allowed: a number or a string"},
    {"number for a name", "[[link]]\nname = 1",
     "bad.toml:2: link: name: an integer, allowed: a string"},
    {"link without a name", "[[link]]\nmass = 1",
     "bad.toml:1: link: has no name, allowed: a string"},
    {"empty name", "[[link]]\nname = \"\"", "bad.toml:1: a link has an empty name"},
    {"empty joint name", oneLink("", "name = \"\"\nkind = \"fixed\""),
     "bad.toml:9: joint \"\": empty name"},
    {"vector of two", oneLink("com = [1, 2]"),
     "bad.toml:7: link \"upper\": com: an array of 2, allowed: an array of 3 numbers"},
    {"number for a vector", "gravity = -9.81\n" + kBase,
     "bad.toml:1: gravity: a number, allowed: an array of 3 numbers"},
    {"start of wrong length", kUpper + "[start]\nq = [1, 2]",
     "bad.toml:11: start: q: an array of 2, allowed: an array of 1 numbers"},
    {"wrench on an unknown link", kUpper + "[[wrench]]\nlink = \"lower\"",
     "bad.toml:11: wrench: \"lower\" is not a link of this scene"},
    {"wrench without a link", kUpper + "[[wrench]]\nforce = [1, 0, 0]",
     "bad.toml:10: wrench: has no link"},
    {"wrench in unknown axes", kUpper + "[[wrench]]\nlink = \"upper\"\naxes = \"base\"",
     "bad.toml:12: wrench on \"upper\": axes is \"base\", allowed: \"link\", \"world\""},
    {"inertia about nothing known", oneLink("inertia = { about = \"tip\" }"),
     "bad.toml:7: link \"upper\": inertia: about is \"tip\", allowed: \"com\", \"origin\""},
    {"axis with dh", oneLink("", "kind = \"revolute\"\naxis = [0, 0, 1]\ndh = { a = 1 }"),
     "bad.toml:11: joint \"upper\": has both dh and axis, allowed: xyz, rpy and axis, or dh, or "
     "mdh"},
    {"axis with mdh", oneLink("", "kind = \"revolute\"\naxis = [0, 0, 1]\nmdh = { a = 1 }"),
     "bad.toml:11: joint \"upper\": has both mdh and axis"},
    {"xyz with dh", oneLink("", "kind = \"revolute\"\nxyz = [0, 0, 1]\ndh = { a = 1 }"),
     "bad.toml:11: joint \"upper\": has both dh and xyz"},
    {"rpy with mdh", oneLink("", "kind = \"revolute\"\nrpy = [0, 0, 1]\nmdh = { a = 1 }"),
     "bad.toml:11: joint \"upper\": has both mdh and rpy"},
    {"dh with mdh", oneLink("", "kind = \"revolute\"\nmdh = { a = 1 }\ndh = { a = 1 }"),
     "bad.toml:11: joint \"upper\": has both dh and mdh"},
};

// Physics is checked when all is read; the line is that of the link, 4.
const Bad kPhysics[] = {
    {"negative mass", oneLink("mass = -1"),
     "bad.toml:4: link \"upper\": mass is -1 kg, allowed: zero or more"},
    {"inertia that breaks the triangle inequality",
     oneLink("mass = 1\ninertia = { xx = 1, yy = 1, zz = 3 }"),
     "bad.toml:4: link \"upper\": principal moments of inertia about the centre of mass are 1, 1, "
     "3 kg "
     "m^2, which breaks the triangle inequality, allowed: none greater than the sum of the other "
     "two"},
    {"triangle inequality broken in the 40th digit",
     oneLink("mass = 1\ninertia = { xx = 1, yy = 1, zz = \"2 + 1e-40\" }"),
     "bad.toml:4: link \"upper\": principal moments of inertia about the centre of mass are 1, 1, "
     "2 kg"},
    {"triangle inequality broken off the axes",  // [2 1 0; 1 2 0; 0 0 0.5]: moments 0.5, 1, 3
     oneLink("mass = 1\ninertia = { xx = 2, yy = 2, zz = 0.5, xy = 1 }"),
     "bad.toml:4: link \"upper\": principal moments of inertia about the centre of mass are 0.5, "
     "1, 3 kg "
     "m^2, which breaks the triangle inequality"},
    {"inertia that is not positive semidefinite",  // moments 1 - 2, 1 + 2, 3
     oneLink("mass = 1\ninertia = { xx = 1, yy = 1, zz = 3, xy = 2 }"),
     "bad.toml:4: link \"upper\": principal moments of inertia about the centre of mass are -1, 3, "
     "3 kg "
     "m^2, which is not positive semidefinite, allowed: zero or more"},
    {"inertia with two negative moments",  // 1 + 2*2, 1 - 2, 1 - 2
     oneLink("mass = 1\ninertia = { xx = 1, yy = 1, zz = 1, xy = 2, xz = 2, yz = 2 }"),
     "bad.toml:4: link \"upper\": principal moments of inertia about the centre of mass are -1, "
     "-1, 5 "
     "kg m^2, which is not positive semidefinite"},
    {"negative inertia", oneLink("mass = 1\ninertia = { xx = -1, yy = -1, zz = -2 }"),
     "bad.toml:4: link \"upper\": principal moments of inertia about the centre of mass are -2, "
     "-1, -1"},
    {"inertia about the origin too small for the mass",  // 1 - 2 * 1^2 = -1 about y and z
     oneLink("mass = 2\ncom = [1, 0, 0]\ninertia = { about = \"origin\", xx = 1, yy = 1, zz = 1 }"),
     "bad.toml:4: link \"upper\": principal moments of inertia about the centre of mass are -1, "
     "-1, 1 kg"},
    {"inertia without mass", oneLink("inertia = { xx = 1, yy = 1, zz = 1 }"),
     "bad.toml:4: link \"upper\": has inertia but no mass, allowed: a mass with it, or the "
     "rotor_inertia"},
    {"zero-length axis",
     oneLink("mass = 1\ncom = [1, 0, 0]", "kind = \"revolute\"\naxis = [0, 0, \"1-1\"]"),
     "bad.toml:4: joint \"upper\" of link \"upper\": axis is [0, 0, 0], allowed: any length but "
     "zero"},
    {"massless leaf", oneLink("", "name = \"wrist\"\nkind = \"prismatic\""),
     "bad.toml:4: joint \"wrist\" of link \"upper\": nothing that it carries has mass and it has "
     "no "
     "rotor_inertia"},
    {"massless chain",
     kBase + "[[link]]\nname = \"a\"\nparent = \"base\"\njoint = { kind = \"revolute\" }\n"
             "[[link]]\nname = \"b\"\nparent = \"a\"\n"
             "joint = { kind = \"revolute\", rotor_inertia = 1 }\n",
     "bad.toml:4: joint \"a\" of link \"a\": nothing that it carries has mass"},
    {"point mass on the axis", oneLink("mass = 1\ncom = [0, 0, 1]"),
     "bad.toml:4: joint \"upper\" of link \"upper\": what it carries has no inertia about the "
     "joint's axis"},
    {"point mass on a slanted axis",
     oneLink("mass = 1\ncom = [1, 2, 3]", "kind = \"revolute\"\naxis = [2, 4, 6]\nxyz = [5, 0, 0]"),
     "bad.toml:4: joint \"upper\" of link \"upper\": what it carries has no inertia about the "
     "joint's axis"},
    {"rod along the axis of a joint above a fixed joint",
     kBase + "[[link]]\nname = \"a\"\nparent = \"base\"\njoint = { kind = \"revolute\" }\n"
             "[[link]]\nname = \"b\"\nparent = \"a\"\nmass = 1\n"
             "inertia = { rpy = [-0.3, 0, 0], xx = 1, yy = 1, zz = 0 }\n"
             "joint = { kind = \"fixed\", rpy = [0.3, 0, 0] }\n",
     "bad.toml:4: joint \"a\" of link \"a\": what it carries has no inertia about the joint's "
     "axis"},
    {"rod along the axis behind turns of 0.3 + 0.4 - 0.7 rad",
     kBase +
         "[[link]]\nname = \"a\"\nparent = \"base\"\njoint = { kind = \"revolute\" }\n"
         "[[link]]\nname = \"b\"\nparent = \"a\"\njoint = { kind = \"fixed\", rpy = [0.3, 0, 0] }\n"
         "[[link]]\nname = \"c\"\nparent = \"b\"\nmass = 1\n"
         "inertia = { rpy = [-0.7, 0, 0], xx = 1, yy = 1, zz = 0 }\n"
         "joint = { kind = \"fixed\", rpy = [0.4, 0, 0] }\n",
     "bad.toml:4: joint \"a\" of link \"a\": what it carries has no inertia about the joint's "
     "axis"},
    {"point mass on the axis behind a DH row",
     oneLink("mass = 1\ncom = [-2, 0, 0]",
             "kind = \"revolute\"\ndh = { a = 2, alpha = 0.7, theta = 0.4 }"),
     "bad.toml:4: joint \"upper\" of link \"upper\": what it carries has no inertia about the "
     "joint's axis"},
    {"negative rotor inertia",
     oneLink("mass = 1\ncom = [1, 0, 0]", "kind = \"revolute\"\nrotor_inertia = -0.5"),
     "bad.toml:4: joint \"upper\" of link \"upper\": rotor_inertia is -0.5 kg m^2, allowed: zero "
     "or more"},
    {"gear ratio zero", oneLink("", "kind = \"revolute\"\nrotor_inertia = 1\ngear_ratio = 0"),
     "bad.toml:4: joint \"upper\" of link \"upper\": gear_ratio is 0 with a rotor_inertia"},
    {"rotor of one rate in a list",
     oneLink("mass = 1\ncom = [1, 0, 0]",
             "kind = \"revolute\"\nrotors = [{ inertia = 1, ratio = [1] }]"),
     "bad.toml:11: joint \"upper\" (revolute): unknown key \"rotors\""},
    {"rotor_inertia of a universal joint",
     oneLink(kSolid, "kind = \"universal\"\nrotor_inertia = 1"),
     "bad.toml:11: joint \"upper\" (universal): has rotor_inertia, allowed: only with revolute"},
    {"no rotors", oneLink(kSolid, "kind = \"universal\"\nrotors = []"),
     "bad.toml:11: joint \"upper\": rotors: "},
    {"rotor without inertia",
     oneLink(kSolid, "kind = \"universal\"\nrotors = [{ ratio = [1, 1] }]"),
     "bad.toml:11: joint \"upper\": rotors: rotor 1: "},
    {"rotor of three rates on a joint of two",
     oneLink(kSolid, "kind = \"universal\"\nrotors = [{ inertia = 1, ratio = [1, 2, 3] }]"),
     "bad.toml:11: joint \"upper\": rotors: rotor 1: ratio: an array of 3"},
    {"negative rotor of several rates",
     oneLink(kSolid, "kind = \"universal\"\nrotors = [{ inertia = -1, ratio = [1, 2] }]"),
     "bad.toml:4: joint \"upper\" of link \"upper\": rotors: rotor 1: inertia is -1 kg m^2, "
     "allowed: above zero"},
    {"rotor that no rate turns",
     oneLink(kSolid, "kind = \"universal\"\nrotors = [{ inertia = 1, ratio = [0, \"1-1\"] }]"),
     "bad.toml:4: joint \"upper\" of link \"upper\": rotors: rotor 1: all of its ratio is 0"},
    {"rotor about nothing",
     oneLink(kSolid,
             "kind = \"universal\"\nrotors = [{ inertia = 1, ratio = [1, 2], axis = [0, 0, 0] }]"),
     "bad.toml:4: joint \"upper\" of link \"upper\": rotors: rotor 1: axis is [0, 0, 0]"},
    {"geared rotors and a drive",
     oneLink(
         kSolid,
         "kind = \"universal\"\nmotion = [\"t\", \"t\"]\nrotors = [{ inertia = 1, ratio = [1, 2] }]"),
     "bad.toml:4: joint \"upper\" of link \"upper\": has rotors geared to several rates, and there "
     "are driven joints"},
    {"geared gyroscopic rotor heavier than its link",
     kBase + "[[link]]\nname = \"arm\"\nparent = \"base\"\n" + kSolid +
         "\n[link.joint]\nkind = \"revolute\"\n[[link]]\nname = \"hand\"\nparent = \"arm\"\n" +
         kSolid +
         "\n[link.joint]\nkind = \"universal\"\nrotors = [{ inertia = 9, ratio = [1, 2], axis = [1, 0, 0] }]\n",
     "bad.toml:4: link \"arm\": carries the gyroscopic rotor of joint \"hand\", and without it"},
    {"negative stiffness",
     oneLink("mass = 1\ncom = [1, 0, 0]", "kind = \"revolute\"\nstiffness = -2"),
     "bad.toml:4: joint \"upper\" of link \"upper\": stiffness is -2, allowed: zero or more"},
};

// On the border of what exists: none of these may be refused.
const Bad kSound[] = {
    {"point mass off the axis", oneLink("mass = 1\ncom = [1, 0, 0]"), ""},
    {"thin rod", oneLink("mass = 1\ninertia = { yy = 0.1, zz = 0.1 }"), ""},
    {"flat disc", oneLink("mass = 1\ninertia = { xx = 0.1, yy = 0.2, zz = \"0.1 + 0.2\" }"), ""},
    {"thin rod of irrational mass",
     oneLink("mass = \"2*pi\"\ninertia = { yy = \"2*pi*0.3^2/12\", zz = \"2*pi*0.3^2/12\" }"), ""},
    {"point mass given about the origin",
     oneLink("mass = 2\ncom = [1, 2, 3]\ninertia = { about = \"origin\", xx = 26, yy = 20, zz = "
             "10, xy = -4, xz = -6, yz = -12 }"),
     ""},
    // a point mass on the axis that the axes are turned about, so that the turn changes nothing
    {"point mass given about the origin in axes turned by 0.3",
     oneLink("mass = 1\ncom = [1, 0, 0]\n"
             "inertia = { about = \"origin\", rpy = [0.3, 0, 0], yy = 1, zz = 1 }"),
     ""},
    {"point mass given about the origin in axes turned by 0.6",
     oneLink("mass = 1\ncom = [1, 0, 0]\n"
             "inertia = { about = \"origin\", rpy = [0.6, 0, 0], yy = 1, zz = 1 }"),
     ""},
    {"point mass given about the origin in axes turned by -1.2",
     oneLink("mass = 1\ncom = [1, 0, 0]\n"
             "inertia = { about = \"origin\", rpy = [-1.2, 0, 0], yy = 1, zz = 1 }"),
     ""},
    {"point mass given about the origin in axes turned by 1e15",
     oneLink("mass = 1\ncom = [1, 0, 0]\n"
             "inertia = { about = \"origin\", rpy = [1e15, 0, 0], yy = 1, zz = 1 }"),
     ""},
    // c = (1, 0, 1) is (0, -1, 1) in axes turned by pi/2 about z, and there c.c 1 - c c' is this:
    {"point mass given about the origin in axes turned by pi/2",
     oneLink("mass = 1\ncom = [1, 0, 1]\n"
             "inertia = { about = \"origin\", rpy = [0, 0, \"pi/2\"], xx = 2, yy = 1, zz = 1, yz = "
             "1 }"),
     ""},
    {"massless link with a rotor", oneLink("", "kind = \"revolute\"\nrotor_inertia = 1e-4"), ""},
    {"massless link with mass behind it",
     kBase + "[[link]]\nname = \"a\"\nparent = \"base\"\njoint = { kind = \"revolute\" }\n"
             "[[link]]\nname = \"b\"\nparent = \"a\"\nmass = 1\ncom = [1, 0, 0]\n"
             "joint = { kind = \"fixed\" }\n",
     ""},
    {"point mass that another joint brings onto the axis, but only at q = 0",
     kBase + "[[link]]\nname = \"a\"\nparent = \"base\"\njoint = { kind = \"revolute\" }\n"
             "[[link]]\nname = \"b\"\nparent = \"a\"\nmass = 1\ncom = [-1, 0, 0]\n"
             "joint = { kind = \"revolute\", xyz = [1, 0, 0] }\n",
     ""},
    {"point mass at a joint that another joint moves",
     kBase +
         "[[link]]\nname = \"a\"\nparent = \"base\"\nmass = 1\njoint = { kind = \"revolute\" }\n"
         "[[link]]\nname = \"b\"\nparent = \"a\"\nmass = 1\ncom = [1, 0, 0]\n"
         "joint = { kind = \"revolute\", xyz = [1, 0, 0] }\n",
     ""},
};

// A sound URDF robot at lines 1 to 4; the case's own text follows.
const std::string kRobot = "<robot name=\"r\">\n<link name=\"base\"/>\n";
const std::string kHand =
    "<link name=\"hand\"><inertial><origin xyz=\"1 0 0\"/><mass value=\"1\"/>"
    "<inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n";

std::string repeated(const std::string& text, int times) {
  std::string result;
  for (int i = 0; i < times; ++i) result += text;
  return result;
}

std::string robot(const std::string& joint) {
  return kRobot + kHand + "<joint name=\"j\" " + joint +
         "<parent link=\"base\"/><child link=\"hand\"/></joint>\n</robot>\n";
}

const Bad kUrdf[] = {
    {"broken XML", kRobot + kHand + "<joint name=\"j\">\n</robot>", "bad.urdf:5: not XML: "},
    {"elements a million deep", "<robot name=\"r\">\n" + repeated("<a b='/>'>", 1000000),
     "bad.urdf: more than 100 elements inside one another"},
    {"not a robot", "<?xml version=\"1.0\"?>\n<mujoco/>",
     "bad.urdf:2: not URDF: the outermost element is <mujoco>, allowed: <robot>"},
    {"robot without a name", "<robot><link name=\"a\"/></robot>",
     "bad.urdf:1: <robot>: has no name"},
    {"no link", "<robot name=\"r\"/>", "bad.urdf: no root: there is no link"},
    {"screw joint", robot("type=\"screw\">\n"),
     "bad.urdf:4: <joint>: joint \"j\" is of type \"screw\", allowed: fixed, revolute, "
     "continuous, "
     "prismatic"},
    {"spherical joint", robot("type=\"spherical\">\n"),
     "bad.urdf:4: <joint>: joint \"j\" is of type \"spherical\""},
    {"joint without a type", robot(">\n"), "bad.urdf:4: <joint>: has no type"},
    {"joint without parent",
     kRobot + kHand + "<joint name=\"j\" type=\"fixed\">\n<child link=\"hand\"/></joint></robot>",
     "bad.urdf:4: <joint>: has no <parent>"},
    {"unknown parent",
     kRobot + kHand +
         "<joint name=\"j\" type=\"fixed\">\n<parent link=\"x\"/><child "
         "link=\"hand\"/></joint></robot>",
     "bad.urdf:5: link \"hand\": parent \"x\" is not a link"},
    {"unknown child",
     kRobot + kHand +
         "<joint name=\"j\" type=\"fixed\">\n<parent link=\"base\"/>\n<child "
         "link=\"x\"/></joint></robot>",
     "bad.urdf:6: <child>: joint \"j\": child \"x\" is not a link"},
    {"closed loop",
     kRobot + kHand +
         "<joint name=\"j\" type=\"fixed\"><parent link=\"base\"/><child link=\"hand\"/></joint>\n"
         "<joint name=\"k\" type=\"fixed\"><parent link=\"base\"/><child "
         "link=\"hand\"/></joint></robot>",
     "bad.urdf:5: <child>: joint \"k\": link \"hand\" is the child of joint \"j\" already, "
     "allowed: a tree"},
    {"two roots", kRobot + kHand + "</robot>",
     "bad.urdf:3: link \"hand\": has no parent, but neither has link \"base\" (bad.urdf:2)"},
    {"duplicate links", kRobot + "<link name=\"base\"/></robot>",
     "bad.urdf:3: link \"base\": the name is taken by the link of bad.urdf:2"},
    {"inertial without mass",
     kRobot + "<link name=\"hand\">\n<inertial><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" "
              "ixz=\"0\" iyz=\"0\"/></inertial></link></robot>",
     "bad.urdf:4: link \"hand\": <inertial>: has no <mass>"},
    {"number that is none", robot("type=\"continuous\">\n<origin xyz=\"0 ${l} 0\"/>"),
     "bad.urdf:5: <origin>: xyz is \"${l}\", allowed: decimals"},
    {"expression, which URDF has not", robot("type=\"continuous\">\n<origin xyz=\"0 1-2 0\"/>"),
     "bad.urdf:5: <origin>: xyz is \"1-2\", allowed: decimals"},
    {"number that is not finite", robot("type=\"continuous\">\n<origin xyz=\"0 -INF 0\"/>"),
     "bad.urdf:5: <origin>: xyz is \"-INF\", not finite"},
    {"two numbers for a vector", robot("type=\"continuous\">\n<origin xyz=\"0 0\"/>"),
     "bad.urdf:5: <origin>: xyz has 2 numbers, allowed: 3"},
    {"zero-length axis", robot("type=\"continuous\">\n<axis xyz=\"0 0 0\"/>"),
     "bad.urdf:3: joint \"j\" of link \"hand\": axis is [0, 0, 0]"},
    {"mass without inertia",
     kRobot + "<link name=\"hand\">\n<inertial><mass value=\"1\"/></inertial></link></robot>",
     "bad.urdf:4: link \"hand\": <inertial>: has no <inertia>"},
    {"negative mass",
     "<robot name=\"r\">\n<link name=\"a\"><inertial><mass value=\"-1\"/><inertia ixx=\"0\" "
     "iyy=\"0\" "
     "izz=\"0\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link></robot>",
     "bad.urdf:2: link \"a\": mass is -1 kg, allowed: zero or more"},
    {"what only urdfdom knows to be wrong", robot("type=\"revolute\">\n"),
     "bad.urdf: not valid URDF: Joint [j] is of type REVOLUTE but it does not specify limits"},
};

}  // namespace

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_DATA_TEST_CASE(a_bad_toml_file_is_refused_at_its_line, data::make(kToml), bad) {
  requireComplaint(complaint([&] { readSceneToml(bad.text, "bad.toml"); }), bad.message);
}

BOOST_DATA_TEST_CASE(impossible_physics_is_refused_at_the_link, data::make(kPhysics), bad) {
  requireComplaint(complaint([&] { readSceneToml(bad.text, "bad.toml"); }), bad.message);
}

BOOST_DATA_TEST_CASE(what_is_just_possible_is_read, data::make(kSound), sound) {
  requireComplaint(complaint([&] { readSceneToml(sound.text, "sound.toml"); }), "no complaint");
}

BOOST_DATA_TEST_CASE(a_bad_urdf_file_is_refused_at_its_line, data::make(kUrdf), bad) {
  requireComplaint(complaint([&] { readSceneUrdf(bad.text, "bad.urdf"); }), bad.message);
}

// Capitals, then the order of letters, are slips before letters that are others: by eye.
BOOST_AUTO_TEST_CASE(what_is_misspelt_is_guessed) {
  BOOST_TEST(nearestName("L1", {"m1", "m2", "l1", "l2"}) == "l1");
  BOOST_TEST(nearestName("MASS", {"com", "mass"}) == "mass");
  BOOST_TEST(nearestName("dq1", {"q1", "q2", "qd1", "qd2"}) == "qd1");
  BOOST_TEST(nearestName("ddq2", {"q2", "qd2", "qdd2"}) == "qdd2");
  BOOST_TEST(nearestName("xzy", {"rpy", "axis", "xyz"}) == "xyz");
  BOOST_TEST(nearestName("links", {"title", "link"}) == "link");
  BOOST_TEST(nearestName("limits", {"title", "link"}).empty());
}

BOOST_AUTO_TEST_CASE(a_file_that_cannot_be_read_is_named) {
  requireComplaint(complaint([] { readScene("/no/such/file.toml"); }),
                   "/no/such/file.toml: cannot be read: No such file or directory");
  requireComplaint(complaint([] { readScene("/tmp"); }),
                   "/tmp: is a folder, allowed: a TOML, URDF or MJCF file");
}

BOOST_AUTO_TEST_CASE(an_unknown_scene_is_answered_with_the_known_ones) {
  const auto folder = std::filesystem::temp_directory_path() / "dynwitness_no_scenes_here";
  std::filesystem::remove_all(folder);
  ::setenv("DYNWITNESS_DATA", folder.c_str(), 1);
  requireComplaint(complaint([] { bundledScenes(); }),
                   "DYNWITNESS_DATA: '" + folder.string() +
                       "' is no folder, allowed: one with the folders "
                       "audit, scenes and reference");
  std::filesystem::create_directory(folder);
  BOOST_TEST(bundledScenes().empty());
  requireComplaint(complaint([] { findScene("pendulm"); }),
                   "no scene and no file is called \"pendulm\", allowed: the path of a file");
  ::unsetenv("DYNWITNESS_DATA");
  std::filesystem::remove(folder);
}

BOOST_AUTO_TEST_CASE(a_mechanism_built_in_a_program_is_held_to_the_same_rules) {
  const Scene sound = readSceneToml(kUpper, "sound.toml");
  Scene bad = sound;
  bad.mechanism.links[1].parent = 1;
  requireComplaint(complaint([&] { validate(bad); }),
                   "sound.toml:4: link \"upper\": index 1 with parent 1");
  bad = sound;
  bad.start_q.clear();
  requireComplaint(complaint([&] { validate(bad); }),
                   "sound.toml: start: 0 positions and 1 speeds");
  bad = sound;
  bad.mechanism.wrenches.resize(1);
  bad.mechanism.wrenches[0].link = 2;
  requireComplaint(complaint([&] { validate(bad); }),
                   "sound.toml: wrench: there is no link of index 2");
  bad = sound;
  bad.mechanism.links[1].name = "base";
  requireComplaint(complaint([&] { validate(bad); }),
                   "sound.toml:4: link \"base\": the name is taken");
  bad = sound;
  bad.mechanism.links[1].joint.rest = Number::parse("k");
  requireComplaint(complaint([&] { validate(bad); }),
                   "sound.toml:4: expression \"k\": parameter \"k\" is not defined");
  bad = sound;
  bad.mechanism.links.clear();
  requireComplaint(complaint([&] { validate(bad); }), "sound.toml: no root");
}

/// What a file is told of, line by line.
std::vector<std::string> linesOf(const std::string& message) {
  std::istringstream stream(message);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

BOOST_AUTO_TEST_CASE(all_faults_of_a_file_are_told_at_once) {
  const std::string toml =
      "colour = 3\ngravity = [0, 0]\n[parameters]\ng = \"9.81*\"\nl = \"k\"\n[[link]]\n"
      "name = \"base\"\n[[link]]\nname = \"a\"\nparent = \"base\"\nmass = \"mm\"\nweight = 3\n"
      "com = [\"g\", \"l\", 0]\ninertia = { xx = \"q\" }\n"
      "joint = { kind = \"revolut\", xyz = [0, 0] }\n";
  const std::vector<std::string> told =
      linesOf(complaint([&] { readSceneToml(toml, "bad.toml"); }));
  const std::vector<std::string> expected = {"bad.toml:1: scene: unknown key \"colour\"",
                                             "bad.toml:4: parameter \"g\"",
                                             "bad.toml:5: parameter \"l\"",
                                             "bad.toml:2: gravity",
                                             "bad.toml:12: link \"a\": unknown key",
                                             "bad.toml:11: link \"a\": mass",
                                             "bad.toml:14: link \"a\": inertia: xx",
                                             "bad.toml:15: joint \"a\": kind is \"revolut\" (did "
                                             "you mean revolute?), allowed: fixed, revolute",
                                             "bad.toml:15: joint \"a\": xyz: an array of 2"};
  BOOST_TEST_REQUIRE(told.size() == expected.size(),
                     complaint([&] { readSceneToml(toml, "bad.toml"); }));
  for (std::size_t k = 0; k < told.size(); ++k) requireComplaint(told[k], expected[k]);

  // and what numbers can be read, but are those of no mechanism
  const auto hanging = [](const char* name, const char* parent, const char* joint) {
    return fmt::format("[[link]]\nname = \"{}\"\nparent = \"{}\"\nmass = -1\njoint = {{ {} }}\n",
                       name, parent, joint);
  };
  const std::string values = "title = \"x\"\nsource = \"x\"\n[[link]]\nname = \"base\"\n" +
                             hanging("a", "base", "kind = \"revolute\", axis = [0, 0, 0]") +
                             hanging("b", "a", "kind = \"revolute\", stiffness = -3");
  const std::vector<std::string> of_values =
      linesOf(complaint([&] { readSceneToml(values, "bad.toml"); }));
  BOOST_TEST_REQUIRE(of_values.size() >= 4u, complaint([&] { readSceneToml(values, "bad.toml"); }));
  const char* said[] = {"bad.toml:5: joint \"a\" of link \"a\": axis is [0, 0, 0]",
                        "bad.toml:10: joint \"b\" of link \"b\": stiffness is -3",
                        "bad.toml:5: link \"a\": mass is -1",
                        "bad.toml:10: link \"b\": mass is -1"};
  for (std::size_t k = 0; k < 4; ++k) requireComplaint(of_values[k], said[k]);

  const std::string urdf =
      "<robot name=\"r\">\n<link name=\"a\"/>\n<link name=\"b\"><inertial>\n<mass value=\"1x\"/>\n"
      "<inertia ixx=\"nan\" iyy=\"1\" izz=\"z\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n"
      "<joint name=\"j\" type=\"screw\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>\n";
  const std::vector<std::string> of_urdf =
      linesOf(complaint([&] { readSceneUrdf(urdf, "bad.urdf"); }));
  BOOST_TEST_REQUIRE(of_urdf.size() == 4u);
  requireComplaint(of_urdf[0], "bad.urdf:4: <mass>");
  requireComplaint(of_urdf[1], "bad.urdf:5: <inertia>: ixx");
  requireComplaint(of_urdf[2], "bad.urdf:5: <inertia>: izz");
  requireComplaint(of_urdf[3], "bad.urdf:6: <joint>: joint \"j\" is of type");
}

BOOST_AUTO_TEST_CASE(of_many_faults_their_number_is_told) {
  std::string text = "[parameters]\n";
  for (int k = 0; k < 25; ++k) text += "p" + std::to_string(k) + " = \"1+\"\n";
  const std::vector<std::string> told =
      linesOf(complaint([&] { readSceneToml(text + kBase, "bad.toml"); }));
  BOOST_TEST_REQUIRE(told.size() == 21u);
  requireComplaint(told[19], "bad.toml:21: parameter \"p19\"");
  BOOST_TEST(told[20] == "... and 5 more faults");
}

BOOST_AUTO_TEST_SUITE_END()
