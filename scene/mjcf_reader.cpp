// SPDX-License-Identifier: GPL-3.0-or-later
// Reads MJCF files as scenes (scene/mjcf.md says which).
//
// What stands in the file as a decimal stays one: positions, masses, moments, angles about one axis
// or in the order roll, pitch, yaw. What has to be computed (another orientation's roll, pitch and
// yaw; the inertia of shapes; an anchor in turned axes) is formed in long double and printed with
// 18 digits, of which a double keeps 16.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <deque>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "scene/arrange.hpp"
#include "scene/inertia_need.hpp"
#include "scene/mimic.hpp"
#include "scene/mjcf.hpp"
#include "scene/numbers.hpp"
#include "scene/rational_geometry.hpp"
#include "scene/text_file.hpp"
#include "scene/turn.hpp"
#include "scene/work.hpp"
#include "scene/xml_element.hpp"

namespace dynwitness::scene {
namespace {

using Real = long double;
using Vector3 = Eigen::Matrix<Real, 3, 1>;
using Matrix3 = Eigen::Matrix<Real, 3, 3>;
using Names = std::initializer_list<const char*>;

/// MuJoCo's own XML parser takes no more.
constexpr int kMostDepth = 500;

bool isOneOf(const std::string& name, Names names) {
  return std::any_of(names.begin(), names.end(), [&](const char* n) { return name == n; });
}

// ------------------------------------------------------------------------------------- numbers

Real valueOf(const Number& n) {
  return fromExact<Real>(exactValue(n, {}));
}
bool isZero(const Number& n) {
  return n.isLiteralZero() || exactValue(n, {}).isZero();
}
bool isZero(const Vector& v) {
  return isZero(v[0]) && isZero(v[1]) && isZero(v[2]);
}
Vector3 valueOf(const Vector& v) {
  return {valueOf(v[0]), valueOf(v[1]), valueOf(v[2])};
}

/** A computed number as a decimal.
    @param size  of the numbers that it was made of: what their rounding leaves of it is zero */
Number printed(Real x, Real size, const SourceLocation& where) {
  if (x == 0 || std::abs(x) < 1e-18L * size) return Number(0);
  const Real magnitude = std::abs(x);
  if (!(magnitude >= std::numeric_limits<double>::min() &&
        magnitude <= std::numeric_limits<double>::max()))
    throw InputError(where,
                     "what follows from its numbers is too large or too small to be finite in a "
                     "double, allowed: sizes of machines");
  return Expression::parse(fmt::format("{:.18g}", x));
}
Vector printed(const Vector3& v, Real size, const SourceLocation& where) {
  return {printed(v[0], size, where), printed(v[1], size, where), printed(v[2], size, where)};
}

/// a - b, as a decimal where both are, and otherwise as it stands.
Number difference(const Number& a, const Number& b) {
  if (isZero(b)) return a;
  const Exact x = exactValue(a, {}), y = exactValue(b, {});
  if (x.isRational() && y.isRational()) return Number(Rational(x.rational - y.rational));
  return Expression::parse(fmt::format("({}) - ({})", a.text(), b.text()));
}
Vector difference(const Vector& a, const Vector& b) {
  return {difference(a[0], b[0]), difference(a[1], b[1]), difference(a[2], b[2])};
}
Number negative(const Number& n) {
  return isZero(n) ? Number(0) : Expression::parse("-(" + n.text() + ")");
}

/// Degrees as radians, exactly.
Number ofDegrees(const Number& degrees) {
  if (isZero(degrees)) return Number(0);
  const Rational turns = exactValue(degrees, {}).rational / 180;
  if (denominator(turns) > 12) return Expression::parse(fmt::format("{}*pi/180", degrees.text()));
  const Integer n = numerator(turns), d = denominator(turns);
  std::string text = n < 0 ? "-" : "";
  if (abs(n) != 1) text += Integer(abs(n)).str() + "*";
  return Expression::parse(text + "pi" + (d == 1 ? "" : "/" + d.str()));
}

Matrix3 turnAbout(int axis, const Number& angle) {
  static const Mechanism none;
  return turnAbout(axis, RealNumbers<Real>(none).angle(angle));  // quarter turns exactly
}

/** R = 1 + 2 (w [v]x + [v]x^2) / (q'q), for a quaternion q = (w, v) of any length but 0. */
Matrix3 turnOf(Real w, const Vector3& v) {
  Matrix3 cross;
  cross << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return Matrix3::Identity() + 2 / (w * w + v.squaredNorm()) * (w * cross + cross * cross);
}

/// As expressions.
Vector rollPitchYaw(const Matrix3& R, const SourceLocation& where) {
  const auto atan = [](Real y, Real x) {  // of what rounding leaves of zero: zero
    return std::atan2(std::abs(y) < 1e-18L ? 0 : y, std::abs(x) < 1e-18L ? 0 : x);
  };
  Vector rpy = printed(scene::rollPitchYaw(R, atan), 1, where);
  for (Number& angle : rpy) angle = angleOf(angle);
  return rpy;
}

// ------------------------------------------------------------------------------------ elements

/// An element with its children, those of included files in their place.
struct Node {
  Element element;
  std::vector<Node> children;
};

/// The file and those that it includes, each once.
class Files {
 public:
  Node read(const std::string& text, const std::filesystem::path& file) {
    folder_ = file.parent_path();
    read_.insert(file.lexically_normal().string());
    const Element top = parsed(text, file.string());
    if (top.kind() != "mujoco") top.fail("not MJCF, allowed: <mujoco> as the outermost element");
    return node(top, 1);
  }
  double elements() const { return elements_; }

 private:
  struct Loaded {
    std::string name;
    TiXmlDocument document;
  };

  Element parsed(const std::string& text, const std::string& name) {
    Loaded& loaded = loaded_.emplace_back();
    loaded.name = name;
    parseXml(text, name, kMostDepth, &loaded.document);
    if (!loaded.document.RootElement())
      throw InputError({name, 0}, "not MJCF: there is no element");
    return {loaded.document.RootElement(), &loaded.name};
  }

  Node node(const Element& element, int depth) {
    if (depth > kMostDepth)
      element.fail(fmt::format("more than {} elements inside one another", kMostDepth));
    elements_ += 1;
    Node out{element, {}};
    addChildren(element, depth, &out.children);
    return out;
  }

  void addChildren(const Element& element, int depth, std::vector<Node>* out) {
    for (const TiXmlElement* e = element.xml().FirstChildElement(); e;
         e = e->NextSiblingElement()) {
      const Element child = element.at(e);
      if (child.kind() != "include") {
        out->push_back(node(child, depth + 1));
        continue;
      }
      if (e->FirstChildElement()) child.fail("has elements, allowed: the attribute file alone");
      const std::filesystem::path file =
          (folder_ / child.attribute("file")).lexically_normal();  // of the main file, as MuJoCo
      if (!read_.insert(file.string()).second)
        child.fail("\"" + file.string() + "\" was read already, allowed: each file once");
      std::error_code error;
      if (!std::filesystem::exists(file, error))
        child.fail("\"" + file.string() + "\" does not exist, allowed: a file beside this one");
      const Element root = parsed(readTextFile(file, "an MJCF file"), file.string());
      if (!root.xml().FirstChildElement()) root.fail("has no elements, allowed: what is included");
      addChildren(root, depth, out);
    }
  }

  std::filesystem::path folder_;
  std::set<std::string> read_;
  std::deque<Loaded> loaded_;  // elements point into it
  double elements_ = 0;
};

struct Setting {
  std::string text;
  SourceLocation where;
};
using Settings = std::map<std::string, Setting, std::less<>>;

/// The defaults of a class, by kind of element.
struct Class {
  Settings joint, geom, equality;
};

const Settings kNone;

/// What an element says, and where it does not, its class.
class Said {
 public:
  Said(const Element& own, const Settings& otherwise) : own_(own), otherwise_(otherwise) {}

  SourceLocation where() const { return own_.where(); }
  [[noreturn]] void fail(const std::string& what) const { own_.fail(what); }
  [[noreturn]] void fail(const char* key, const std::string& what) const {
    const std::optional<Setting> found = setting(key);
    throw InputError(found ? found->where : where(),
                     fmt::format("<{}>: {} {}", own_.kind(), key, what));
  }

  bool has(const char* key) const { return setting(key).has_value(); }
  bool says(const char* key) const { return own_.xml().Attribute(key) != nullptr; }
  std::string text(const char* key, const std::string& otherwise = "") const {
    const std::optional<Setting> found = setting(key);
    return found ? found->text : otherwise;
  }
  std::vector<Number> numbers(const char* key, std::size_t least, std::size_t most) const {
    const Setting found = setting(key).value();
    std::vector<Number> out;
    for (const std::string& word : wordsOf(found.text))
      out.push_back(decimalOf(word, found.where, fmt::format("<{}>: {}", own_.kind(), key)));
    if (out.size() < least || out.size() > most)
      fail(key, fmt::format(
                    "has {} numbers, allowed: {}", out.size(),
                    least == most ? std::to_string(most) : fmt::format("{} to {}", least, most)));
    return out;
  }
  Number number(const char* key, const Number& otherwise = 0) const {
    return has(key) ? numbers(key, 1, 1)[0] : otherwise;
  }
  Vector vector(const char* key, const Vector& otherwise = {}) const {
    if (!has(key)) return otherwise;
    const std::vector<Number> v = numbers(key, 3, 3);
    return {v[0], v[1], v[2]};
  }
  /// What the element does not say of a list is that of its class.
  std::vector<Number> overlaid(const char* key, std::size_t most) const {
    if (!has(key)) return {};
    std::vector<Number> out = numbers(key, 1, most);
    const auto of_class = otherwise_.find(key);
    if (!says(key) || of_class == otherwise_.end()) return out;
    const std::vector<std::string> words = wordsOf(of_class->second.text);
    for (std::size_t k = out.size(); k < std::min(words.size(), most); ++k)
      out.push_back(
          decimalOf(words[k], of_class->second.where, fmt::format("<{}>: {}", own_.kind(), key)));
    return out;
  }
  std::string word(const char* key, const std::string& otherwise, Names allowed) const {
    std::string found = text(key, otherwise);
    if (isOneOf(found, allowed)) return found;
    std::string list;
    for (const char* name : allowed) list += (list.empty() ? "" : ", ") + std::string(name);
    fail(key, "is \"" + found + "\", allowed: " + list);
  }
  bool flag(const char* key, bool otherwise) const {
    return word(key, otherwise ? "true" : "false", {"true", "false"}) == "true";
  }

 private:
  std::optional<Setting> setting(const char* key) const {
    if (says(key)) return Setting{own_.optionalAttribute(key), own_.where()};
    const auto found = otherwise_.find(key);
    if (found == otherwise_.end()) return {};
    return found->second;
  }

  Element own_;
  const Settings& otherwise_;
};

/// @throws InputError  the element has an attribute of another name
void requireKnown(const Element& element, Names used, Names without_effect = {}) {
  for (const TiXmlAttribute* a = element.xml().FirstAttribute(); a; a = a->Next()) {
    if (isOneOf(a->Name(), used) || isOneOf(a->Name(), without_effect)) continue;
    std::string allowed;
    for (const Names& names : {used, without_effect})
      for (const char* name : names) allowed += (allowed.empty() ? "" : ", ") + std::string(name);
    element.fail(fmt::format("{}=\"{}\" is not in the subset that is read, allowed: {}", a->Name(),
                             a->Value(), allowed));
  }
}
void requireKnown(const Node& node, Names children) {
  for (const Node& child : node.children) {
    if (isOneOf(child.element.kind(), children)) continue;
    std::string allowed;
    for (const char* name : children) allowed += (allowed.empty() ? "" : ", ") + std::string(name);
    child.element.fail("not in the subset that is read, allowed in <" + node.element.kind() +
                       ">: " + (allowed.empty() ? "nothing" : allowed));
  }
}

void requireKnownGeom(const Element& element) {
  requireKnown(
      element,
      {"name", "class", "type", "size", "fromto", "pos", "quat", "euler", "axisangle", "xyaxes",
       "zaxis", "mass", "density", "group", "mesh", "contype", "conaffinity", "shellinertia"},
      {"condim", "priority", "material", "friction", "solmix", "solref", "solimp", "margin", "gap",
       "hfield", "fitscale", "rgba", "fluidshape", "fluidcoef", "user"});
}

void requireKnownJoint(const Element& element) {
  requireKnown(element,
               {"name", "class", "type", "pos", "axis", "ref", "springref", "stiffness", "damping",
                "frictionloss", "armature", "springdamper"},
               {"limited", "range", "margin", "solreflimit", "solimplimit", "solreffriction",
                "solimpfriction", "actuatorfrcrange", "actuatorfrclimited", "group", "user"});
}

// ----------------------------------------------------------------------------------- the reader

/// A frame in the world where all joints are at their reference.
struct Pose {
  Matrix3 R = Matrix3::Identity();
  Vector3 p = Vector3::Zero();
};

/// An orientation: as a matrix, and in the scene's words.
struct Turn {
  Matrix3 R = Matrix3::Identity();
  Vector rpy;
  bool isNone() const { return isZero(rpy); }
};

/// Mass [kg], centre of mass and inertia about it, in axes turned by rpy.
struct Solid {
  Number mass;
  Vector com;
  Turn turn;
  Vector moments;  ///< principal, in these axes
};

class MjcfReader {
 public:
  explicit MjcfReader(const std::filesystem::path& file) : file_(file.string()) {
    scene_.file = file;
    scene_.name = file.stem().string();
    scene_.source = "MJCF file " + file.filename().string();
  }
  Scene read(const Node& top, double elements);

 private:
  /// What a body hands on to those in it.
  struct Carrier {
    std::string link;
    Vector shift;  ///< of the link's frame from the body's
    Pose pose;     ///< of the body
    const Class* defaults;
    bool rests;
  };
  struct MovingJoint {
    std::string name;
    JointKind kind;
    Number ref;
  };
  struct Place {
    std::string link;
    Vector shift;
    Pose pose;
  };

  void readCompiler(const Node& node);
  void readOption(const Node& node);
  void readDefaults(const Node& node, const Class* parent);
  void takeNames(const Node& body);
  void readBodies(const Node& world, const Carrier& carrier);
  Carrier readBody(const Node& node, const Carrier& parent);
  Carrier readJoints(const Node& node, const Carrier& parent, const Class* defaults,
                     const std::string& name, const MassProperties& inertia, bool is_known);
  Joint readJoint(const Said& said, JointKind kind) const;
  MassProperties readInertia(const Node& node, const Class& defaults, bool rests,
                             bool* is_known) const;
  MassProperties readInertial(const Element& element) const;
  std::optional<MassProperties> inertiaOfGeoms(const Node& node, const Class& defaults, bool rests,
                                               bool* is_known) const;
  std::optional<Solid> solidOf(const Said& said, bool rests, bool* is_known) const;
  void bound(MassProperties* m, const SourceLocation& where) const;
  void setTotalMass();
  void readEquality(const Node& node);
  void readClosure(const Said& said, bool is_weld);
  void readMimic(const Said& said);
  void readKeyframes(const Node& node);
  void tell();

  Number angle(const Number& n) const { return in_degrees_ ? ofDegrees(n) : angleOf(n); }
  Turn turn(const Said& said) const;
  Turn eulerTurn(const std::vector<Number>& given, const SourceLocation& where) const;
  const Class& classOf(const Said& said, const Class& otherwise) const;
  std::string unusedName(std::set<std::string>* taken, const std::string& base) const;

  std::string file_;
  Scene scene_;
  // compiler
  bool in_degrees_ = true, balance_ = false, discards_visuals_ = false;
  std::string euler_ = "xyz", from_geoms_ = "auto";
  int least_group_ = 0, most_group_ = 5;
  Number total_mass_{-1}, least_mass_{0}, least_inertia_{0};
  SourceLocation total_mass_where_;

  std::map<std::string, Class> classes_;
  std::vector<NamedLink> links_;
  std::set<std::string> joint_names_, body_names_;
  int bodies_ = 0, joints_ = 0;
  std::vector<MovingJoint> moving_;  ///< in the order of MuJoCo's, which is the scene's
  std::unordered_map<std::string, std::size_t> moving_index_;
  std::map<std::string, std::vector<Number>> free_starts_;  ///< by joint
  std::map<std::string, Place> places_;                     ///< by body
  std::unordered_map<std::string, Mimic> follows_;          ///< by the follower's joint
  struct Closing {
    Closure closure;
    std::string a, b;  ///< links
  };
  std::vector<Closing> closings_;
  std::map<std::string, int> left_out_;  ///< kinds of elements, with how many
  bool has_limits_ = false;
  std::unique_ptr<Work> work_;
};

// ------------------------------------------------------------------- compiler, option, defaults

void MjcfReader::readCompiler(const Node& node) {
  requireKnown(node.element,
               {"angle", "eulerseq", "inertiafromgeom", "inertiagrouprange", "balanceinertia",
                "settotalmass", "boundmass", "boundinertia", "discardvisual", "coordinate",
                "autolimits", "fusestatic"},
               {"meshdir", "texturedir", "assetdir", "strippath", "fitaabb", "convexhull",
                "usethread", "exactmeshinertia", "saveinertial"});
  requireKnown(node, {"lengthrange"});
  const Said said(node.element, kNone);
  if (said.has("angle")) in_degrees_ = said.word("angle", "", {"degree", "radian"}) == "degree";
  if (said.has("eulerseq")) {
    euler_ = said.text("eulerseq");
    if (euler_.size() != 3 || euler_.find_first_not_of("xyzXYZ") != std::string::npos)
      said.fail("eulerseq", "is \"" + euler_ + "\", allowed: three of x, y, z, X, Y, Z");
  }
  if (said.has("inertiafromgeom"))
    from_geoms_ = said.word("inertiafromgeom", "", {"true", "false", "auto"});
  if (said.has("inertiagrouprange")) {
    const std::vector<Number> range = said.numbers("inertiagrouprange", 2, 2);
    least_group_ = static_cast<int>(std::floor(std::clamp(valueOf(range[0]), -1e6L, 1e6L)));
    most_group_ = static_cast<int>(std::floor(std::clamp(valueOf(range[1]), -1e6L, 1e6L)));
  }
  balance_ = said.flag("balanceinertia", balance_);
  discards_visuals_ = said.flag("discardvisual", discards_visuals_);
  said.word("coordinate", "local", {"local"});
  said.flag("autolimits", true);
  said.flag("fusestatic", true);
  if (said.has("settotalmass")) {
    total_mass_ = said.number("settotalmass");
    total_mass_where_ = said.where();
  }
  least_mass_ = said.number("boundmass", least_mass_);
  least_inertia_ = said.number("boundinertia", least_inertia_);
}

void MjcfReader::readOption(const Node& node) {
  requireKnown(node.element, {"gravity", "density", "viscosity", "wind"},
               {"timestep",
                "apirate",
                "impratio",
                "tolerance",
                "ls_tolerance",
                "noslip_tolerance",
                "ccd_tolerance",
                "mpr_tolerance",
                "sleep_tolerance",
                "magnetic",
                "o_margin",
                "o_solref",
                "o_solimp",
                "o_friction",
                "integrator",
                "collision",
                "cone",
                "jacobian",
                "solver",
                "iterations",
                "ls_iterations",
                "noslip_iterations",
                "ccd_iterations",
                "mpr_iterations",
                "sdf_iterations",
                "sdf_initpoints",
                "actuatorgroupdisable"});
  requireKnown(node, {"flag"});
  const Said said(node.element, kNone);
  Mechanism& mechanism = scene_.mechanism;
  mechanism.gravity = said.vector("gravity", mechanism.gravity);
  for (const char* key : {"density", "viscosity"})
    if (!isZero(said.number(key)))
      said.fail(key, "is " + said.text(key) + ": forces of a fluid are not modelled, allowed: 0");
  for (const Node& flags : node.children) {
    const Said of_flags(flags.element, kNone);
    for (const TiXmlAttribute* a = flags.element.xml().FirstAttribute(); a; a = a->Next()) {
      const std::string value = of_flags.word(a->Name(), "", {"enable", "disable"});
      if (value == "enable") continue;
      if (isOneOf(a->Name(), {"gravity"})) mechanism.has_gravity = false;
      if (isOneOf(a->Name(),
                  {"passive", "spring", "damper", "frictionloss", "equality", "constraint"}))
        of_flags.fail(a->Name(),
                      "is disable, which is not in the subset that is read, allowed: "
                      "enable");
    }
  }
}

void MjcfReader::readDefaults(const Node& node, const Class* parent) {
  requireKnown(node.element, {"class"});
  requireKnown(node,
               {"default",  "joint",       "geom",   "equality", "mesh",    "material", "site",
                "camera",   "light",       "pair",   "tendon",   "general", "motor",    "position",
                "velocity", "intvelocity", "damper", "cylinder", "muscle",  "adhesion", "texture"});
  const std::string name =
      parent ? node.element.attribute("class") : Said(node.element, kNone).text("class", "main");
  if (!parent && name != "main")
    node.element.fail("class is \"" + name + "\", allowed for the outermost: main");
  if (parent && (name.empty() || classes_.count(name) > 0))
    node.element.fail("class \"" + name + "\" exists already, allowed: each name once");
  Class& own = classes_[name];
  if (parent) own = *parent;
  const auto take = [](const Element& element, Settings* settings) {
    for (const TiXmlAttribute* a = element.xml().FirstAttribute(); a; a = a->Next()) {
      Setting& setting = (*settings)[a->Name()];
      const std::vector<std::string> before = wordsOf(setting.text);
      setting = {a->Value(), element.where()};
      // of a list, what is not said stays: size="0.1 0.2", then size="0.3"
      if (std::string(a->Name()) != "size") continue;
      for (std::size_t k = wordsOf(setting.text).size(); k < before.size(); ++k)
        setting.text += " " + before[k];
    }
  };
  for (const Node& child : node.children) {
    const std::string kind = child.element.kind();
    if (kind == "joint") {
      requireKnownJoint(child.element);
      take(child.element, &own.joint);
    } else if (kind == "geom") {
      requireKnownGeom(child.element);
      take(child.element, &own.geom);
    } else if (kind == "equality") {
      requireKnown(child.element, {"active"}, {"solref", "solimp"});
      take(child.element, &own.equality);
    }
  }
  for (const Node& child : node.children)
    if (child.element.kind() == "default") readDefaults(child, &own);
}

const Class& MjcfReader::classOf(const Said& said, const Class& otherwise) const {
  if (!said.says("class")) return otherwise;
  const auto found = classes_.find(said.text("class"));
  if (found == classes_.end())
    said.fail("class", "is \"" + said.text("class") + "\", allowed: a class of a <default>");
  return found->second;
}

// --------------------------------------------------------------------------------- orientations

Turn MjcfReader::eulerTurn(const std::vector<Number>& given, const SourceLocation& where) const {
  Turn out;
  int turns = 0;
  std::array<Number, 3> angles;
  for (std::size_t k = 0; k < 3; ++k) {
    angles[k] = angle(given[k]);
    if (!isZero(angles[k])) ++turns;
    const int axis = std::tolower(euler_[k]) - 'x';
    const Matrix3 R = turnAbout(axis, angles[k]);
    if (euler_[k] >= 'x')
      out.R = out.R * R;  // about axes that turn along
    else
      out.R = R * out.R;
  }
  // one turn alone, or the order of roll, pitch, yaw, is what a scene says, too
  if (turns <= 1 || euler_ == "XYZ" || euler_ == "zyx") {
    for (std::size_t k = 0; k < 3; ++k)
      if (!isZero(angles[k]))
        out.rpy[static_cast<std::size_t>(std::tolower(euler_[k]) - 'x')] = angles[k];
  } else {
    out.rpy = rollPitchYaw(out.R, where);
  }
  return out;
}

Turn MjcfReader::turn(const Said& said) const {
  constexpr const char* kKinds[] = {"quat", "euler", "axisangle", "xyaxes", "zaxis"};
  const char* kind = nullptr;
  for (const char* k : kKinds) {
    if (!said.has(k)) continue;
    if (kind)
      said.fail(k, fmt::format("and {} are both given, by it or its class, allowed: one "
                               "orientation",
                               kind));
    kind = k;
  }
  Turn out;
  if (!kind) return out;
  const std::string what = kind;
  const SourceLocation where = said.where();
  const auto requireLength = [&](const Vector3& v) {
    if (v.isZero(0)) said.fail(kind, "has a vector of zeros, allowed: any other");
  };
  if (what == "euler") return eulerTurn(said.numbers(kind, 3, 3), where);
  if (what == "quat") {
    const std::vector<Number> q = said.numbers(kind, 4, 4);
    const Vector3 v(valueOf(q[1]), valueOf(q[2]), valueOf(q[3]));
    const Real size = std::max(v.cwiseAbs().maxCoeff(), std::abs(valueOf(q[0])));
    if (size == 0) said.fail(kind, "is 0 0 0 0, allowed: any other");
    out.R = turnOf(valueOf(q[0]) / size, v / size);
    out.rpy = rollPitchYaw(out.R, where);
  } else if (what == "axisangle") {
    const std::vector<Number> a = said.numbers(kind, 4, 4);
    const Vector3 axis(valueOf(a[0]), valueOf(a[1]), valueOf(a[2]));
    requireLength(axis);
    const Number by = angle(a[3]);
    for (int k = 0; k < 3; ++k) {
      if (axis[(k + 1) % 3] != 0 || axis[(k + 2) % 3] != 0) continue;
      out.rpy[static_cast<std::size_t>(k)] = axis[k] > 0 ? by : negative(by);
      out.R = turnAbout(k, out.rpy[static_cast<std::size_t>(k)]);
      return out;
    }
    const Real half = valueOf(by) / 2;
    out.R = turnOf(std::cos(half), std::sin(half) * axis.stableNormalized());
    out.rpy = rollPitchYaw(out.R, where);
  } else if (what == "xyaxes") {
    const std::vector<Number> a = said.numbers(kind, 6, 6);
    const Vector3 x_given(valueOf(a[0]), valueOf(a[1]), valueOf(a[2])),
        y_given(valueOf(a[3]), valueOf(a[4]), valueOf(a[5]));
    requireLength(x_given);
    const Vector3 x = x_given.stableNormalized();
    const Vector3 across = y_given - x.dot(y_given) * x;
    if (across.norm() < 1e-14L * std::max(y_given.norm(), std::numeric_limits<Real>::min()))
      said.fail(kind, "has y along x, allowed: another direction");
    const Vector3 y = across.stableNormalized();
    out.R << x, y, x.cross(y);
    out.rpy = rollPitchYaw(out.R, where);
  } else {
    const Vector3 z = valueOf(said.vector(kind));
    requireLength(z);
    // the shortest turn that takes z there; of a half turn, that about x
    const Vector3 axis = Vector3::UnitZ().cross(z);
    const Real half = std::atan2(axis.norm(), z[2]) / 2;
    out.R = turnOf(std::cos(half), std::sin(half) * (axis.isZero(0) ? Vector3(Vector3::UnitX())
                                                                    : axis.stableNormalized()));
    out.rpy = rollPitchYaw(out.R, where);
  }
  return out;
}

// -------------------------------------------------------------------------------------- inertia

MassProperties MjcfReader::readInertial(const Element& element) const {
  requireKnown(element, {"pos", "quat", "euler", "axisangle", "xyaxes", "zaxis", "mass",
                         "diaginertia", "fullinertia"});
  const Said said(element, kNone);
  MassProperties m;
  for (const char* key : {"pos", "mass"})
    if (!said.has(key)) said.fail(fmt::format("has no {}", key));
  m.mass = said.number("mass");
  m.com = said.vector("pos");
  const Turn turned = turn(said);
  m.rpy = turned.rpy;
  if (said.has("diaginertia")) {
    const Vector d = said.vector("diaginertia");
    m.xx = d[0];
    m.yy = d[1];
    m.zz = d[2];
  }
  if (!said.has("fullinertia")) return m;
  if (said.has("diaginertia"))
    said.fail("fullinertia", "and diaginertia are both given, allowed: one of them");
  if (!turned.isNone())
    said.fail("fullinertia",
              "with an orientation: versions of MuJoCo differ, which drop it or refuse it, "
              "allowed: without, or diaginertia");
  const std::vector<Number> f = said.numbers("fullinertia", 6, 6);
  m.xx = f[0];
  m.yy = f[1];
  m.zz = f[2];
  m.xy = f[3];
  m.xz = f[4];
  m.yz = f[5];
  return m;
}

/// Half lengths, or radius and half length, with what fromto says.
struct Shape {
  std::string type;
  Vector3 size = Vector3::Zero();
};

/** Volume and principal moments for a mass of 1, of solid bodies; z is the axis of capsules and
    cylinders, whose size is radius and half length. */
struct VolumeAndMoments {
  Real volume;
  Vector3 moments;
};
VolumeAndMoments volumeAndMoments(const Shape& shape) {
  const Real pi = boost::math::constants::pi<Real>();
  const Vector3& s = shape.size;
  const auto ofHalves = [&s](Real factor) {  // factor (b^2 + c^2), ...
    const Vector3 q = s.cwiseProduct(s);
    return Vector3(factor * Vector3(q[1] + q[2], q[0] + q[2], q[0] + q[1]));
  };
  if (shape.type == "box") return {8 * s.prod(), ofHalves(Real(1) / 3)};
  if (shape.type == "ellipsoid") return {4 * pi / 3 * s.prod(), ofHalves(Real(1) / 5)};
  const Real r = s[0], h = 2 * s[1];
  if (shape.type == "sphere") return {4 * pi / 3 * r * r * r, Vector3::Constant(2 * r * r / 5)};
  if (shape.type == "cylinder") {
    const Real across = (3 * r * r + h * h) / 12;
    return {pi * r * r * h, {across, across, r * r / 2}};
  }
  // capsule: a cylinder, and two half spheres whose centres of mass are 3r/8 beyond its ends
  const Real cylinder = pi * r * r * h, ball = 4 * pi / 3 * r * r * r, volume = cylinder + ball;
  const Real across =
      cylinder * (3 * r * r + h * h) / 12 + ball * (2 * r * r / 5 + h * h / 4 + 3 * r * h / 8);
  return {volume,
          {across / volume, across / volume, (cylinder / 2 + ball * 2 / 5) * r * r / volume}};
}

std::optional<Solid> MjcfReader::solidOf(const Said& said, bool rests, bool* is_known) const {
  const std::string type = said.word(
      "type", "sphere",
      {"plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf"});
  if (said.has("mass") && isZero(said.number("mass"))) return {};
  if (!said.has("mass") && said.has("density") && isZero(said.number("density"))) return {};
  if (type == "plane" || type == "hfield") return {};
  if (discards_visuals_ && said.text("contype", "1") == "0" && said.text("conaffinity", "1") == "0")
    said.fail(
        "makes inertia and is discarded (discardvisual): versions of MuJoCo differ in what is left "
        "of it, allowed: <inertial> in its body");
  if (type == "mesh" || type == "sdf" || said.has("mesh")) {
    *is_known = false;
    if (rests) return {};
    said.fail(
        "its mass and inertia come from a mesh, which is not read, allowed: <inertial> in its body, "
        "mass=\"0\", or type sphere, capsule, cylinder, ellipsoid, box");
  }
  if (said.flag("shellinertia", false))
    said.fail("shellinertia", "is true, which is not in the subset that is read, allowed: false");
  Solid out;
  const std::vector<Number> given = said.overlaid("size", 3);
  Shape shape{type};
  std::size_t needed = type == "sphere" ? 1 : type == "capsule" || type == "cylinder" ? 2 : 3;
  if (said.has("fromto")) {
    if (type == "sphere")
      said.fail("fromto", "goes with capsule, cylinder, ellipsoid and box, and type is sphere");
    for (const char* key : {"pos", "quat", "euler", "axisangle", "xyaxes", "zaxis"})
      if (said.has(key)) said.fail(key, "and fromto are both given, allowed: one of them");
    const std::vector<Number> ends = said.numbers("fromto", 6, 6);
    const Vector3 from(valueOf(ends[0]), valueOf(ends[1]), valueOf(ends[2])),
        to(valueOf(ends[3]), valueOf(ends[4]), valueOf(ends[5]));
    const Vector3 along = from - to;
    if (along.isZero(0)) said.fail("fromto", "has two equal points, allowed: two that differ");
    out.com = printed(Vector3((from + to) / 2), from.norm() + to.norm(), said.where());
    const Vector3 axis = Vector3::UnitZ().cross(along);
    const Real half = std::atan2(axis.norm(), along[2]) / 2;
    out.turn.R = turnOf(
        std::cos(half),
        std::sin(half) * (axis.isZero(0) ? Vector3(Vector3::UnitX()) : axis.stableNormalized()));
    out.turn.rpy = rollPitchYaw(out.turn.R, said.where());
    if (given.empty()) said.fail("has fromto and no size, allowed: the radius as size");
    const Real r = valueOf(given[0]), length = along.stableNorm() / 2;
    shape.size =
        type == "capsule" || type == "cylinder" ? Vector3(r, length, 0) : Vector3(r, r, length);
  } else {
    if (given.size() < needed)
      said.fail(fmt::format("type {} has {} sizes, allowed: {}", type, given.size(), needed));
    for (std::size_t k = 0; k < needed; ++k)
      shape.size[static_cast<Eigen::Index>(k)] = valueOf(given[k]);
    out.com = said.vector("pos");
    out.turn = turn(said);
  }
  for (std::size_t k = 0; k < needed; ++k)
    if (!(shape.size[static_cast<Eigen::Index>(k)] > 0))
      said.fail("size is not above zero, allowed: sizes above zero");
  const VolumeAndMoments solid = volumeAndMoments(shape);
  const Real density = valueOf(said.number("density", 1000)),
             mass = said.has("mass") ? valueOf(said.number("mass")) : density * solid.volume;
  if (mass < 0) said.fail("mass or density is negative, allowed: zero or more");
  out.mass = said.has("mass") ? said.number("mass") : printed(mass, 0, said.where());
  out.moments = printed(Vector3(mass * solid.moments), 0, said.where());
  return out;
}

std::optional<MassProperties> MjcfReader::inertiaOfGeoms(const Node& node, const Class& defaults,
                                                         bool rests, bool* is_known) const {
  std::vector<Solid> solids;
  for (const Node& child : node.children) {
    if (child.element.kind() != "geom") continue;
    const Said without_class(child.element, kNone);
    const Said said(child.element, classOf(without_class, defaults).geom);
    const Real group = std::floor(valueOf(said.number("group", 0)));
    if (group < least_group_ || group > most_group_) continue;
    if (std::optional<Solid> solid = solidOf(said, rests, is_known)) solids.push_back(*solid);
  }
  if (solids.empty()) return {};
  MassProperties m;
  if (solids.size() == 1) {
    const Solid& s = solids[0];
    m.mass = s.mass;
    m.com = s.com;
    m.rpy = s.turn.rpy;
    m.xx = s.moments[0];
    m.yy = s.moments[1];
    m.zz = s.moments[2];
    return m;
  }
  const SourceLocation where = node.element.where();
  Real mass = 0, size = 0;
  Vector3 first = Vector3::Zero();
  for (const Solid& s : solids) {
    mass += valueOf(s.mass);
    first += valueOf(s.mass) * valueOf(s.com);
    size = std::max(size, valueOf(s.com).norm());
  }
  const Vector3 com = first / mass;
  Matrix3 I = Matrix3::Zero();
  for (const Solid& s : solids) {
    const Vector3 c = valueOf(s.com) - com;
    I += s.turn.R * valueOf(s.moments).asDiagonal() * s.turn.R.transpose() +
         valueOf(s.mass) * (c.squaredNorm() * Matrix3::Identity() - c * c.transpose());
  }
  m.mass = printed(mass, 0, where);
  m.com = printed(com, size, where);
  const Real trace = I.trace();
  m.xx = printed(I(0, 0), 0, where);
  m.yy = printed(I(1, 1), 0, where);
  m.zz = printed(I(2, 2), 0, where);
  m.xy = printed(I(0, 1), trace, where);
  m.xz = printed(I(0, 2), trace, where);
  m.yz = printed(I(1, 2), trace, where);
  return m;
}

/** Inertia is <inertial>, or made of shapes: where there is none (auto), or in any case (true).
    @param is_known  false: it is made of meshes, of a body that rests in the world */
MassProperties MjcfReader::readInertia(const Node& node, const Class& defaults, bool rests,
                                       bool* is_known) const {
  std::optional<Element> inertial;
  for (const Node& child : node.children) {
    if (child.element.kind() != "inertial") continue;
    if (inertial) child.element.fail("a second one, allowed: one in <body>");
    inertial = child.element;
  }
  MassProperties m;
  if (inertial) m = readInertial(*inertial);
  if (from_geoms_ == "true" || (from_geoms_ == "auto" && !inertial))
    if (const auto of_geoms = inertiaOfGeoms(node, defaults, rests, is_known)) m = *of_geoms;
  bound(&m, node.element.where());
  return m;
}

/// boundmass, boundinertia and balanceinertia: least mass and moments, then three equal moments
/// where the triangle inequality is broken.
void MjcfReader::bound(MassProperties* m, const SourceLocation& where) const {
  const auto less = [](const Number& a, const Number& b) {
    return exactValue(a, {}).approximation() < exactValue(b, {}).approximation();
  };
  if (less(m->mass, least_mass_)) m->mass = least_mass_;
  const bool is_diagonal = isZero(m->xy) && isZero(m->xz) && isZero(m->yz);
  const auto value = [](const Number& n) { return exactValue(n, {}).approximation(); };
  const auto matrix = [&] {
    return RationalMatrix{{{value(m->xx), value(m->xy), value(m->xz)},
                           {value(m->xy), value(m->yy), value(m->yz)},
                           {value(m->xz), value(m->yz), value(m->zz)}}};
  };
  if (!isZero(least_inertia_)) {
    RationalMatrix above = matrix();
    for (std::size_t k = 0; k < 3; ++k) above[k][k] -= value(least_inertia_);
    if (is_diagonal) {
      for (Number* n : {&m->xx, &m->yy, &m->zz})
        if (less(*n, least_inertia_)) *n = least_inertia_;
    } else if (!isPositiveSemidefinite(above)) {
      throw InputError(where,
                       "<body>: boundinertia changes an inertia with products, which is not in the "
                       "subset that is read, allowed: diaginertia");
    }
  }
  bool is_positive = true;
  if (!balance_ || isRealizable(matrix(), 0, &is_positive) || !is_positive) return;
  const Number mean =
      Number(Rational((value(m->xx) + value(m->yy) + value(m->zz)) / 3));  // in any axes: the trace
  m->xx = m->yy = m->zz = mean;
  m->xy = m->xz = m->yz = Number(0);
}

/// settotalmass: one factor for all masses and inertias.
void MjcfReader::setTotalMass() {
  if (!(valueOf(total_mass_) > 0)) return;
  Real total = 0;
  for (const NamedLink& named : links_) total += valueOf(named.link.inertia.mass);
  if (!(total > 0))
    throw InputError(total_mass_where_,
                     "<compiler>: settotalmass, and there is no mass, allowed: bodies with mass");
  const Number factor = printed(valueOf(total_mass_) / total, 0, total_mass_where_);
  const Rational by = exactValue(factor, {}).rational;
  for (NamedLink& named : links_) {
    MassProperties& m = named.link.inertia;
    for (Number* n : {&m.mass, &m.xx, &m.yy, &m.zz, &m.xy, &m.xz, &m.yz})
      if (!isZero(*n)) *n = Number(Rational(by * exactValue(*n, {}).rational));
  }
}

// ------------------------------------------------------------------------------- bodies, joints

std::string MjcfReader::unusedName(std::set<std::string>* taken, const std::string& base) const {
  std::string name = base;
  while (!taken->insert(name).second) name += "_";
  return name;
}

/// So that no name that is made up is one of the file's.
void MjcfReader::takeNames(const Node& body) {
  for (const Node& child : body.children) {
    const std::string kind = child.element.kind(), name = child.element.optionalAttribute("name");
    if ((kind == "joint" || kind == "freejoint") && !name.empty() &&
        !joint_names_.insert(name).second)
      child.element.fail("name \"" + name + "\" is taken by another joint");
    if (kind != "body") continue;
    if (!name.empty() && !body_names_.insert(name).second)
      child.element.fail("name \"" + name + "\" is taken by another body");
    takeNames(child);
  }
}

Joint MjcfReader::readJoint(const Said& said, JointKind kind) const {
  Joint joint;
  joint.kind = kind;
  const auto nothing = [&](const char* key) {
    if (said.has(key) && !isZero(said.number(key)))
      said.fail(key, fmt::format("is {} at a {} joint, which is not modelled, allowed: 0",
                                 said.text(key), said.text("type")));
  };
  if (said.has("springdamper")) {
    const std::vector<Number> values = said.numbers("springdamper", 2, 2);
    if (!isZero(values[0]) || !isZero(values[1]))
      said.fail("springdamper",
                "is not in the subset that is read, allowed: stiffness and damping");
  }
  if (kind != JointKind::kRevolute && kind != JointKind::kPrismatic) {
    for (const char* key : {"stiffness", "damping", "frictionloss", "armature"}) nothing(key);
    return joint;
  }
  const auto position = [&](const char* key) {
    const Number n = said.number(key);
    return kind == JointKind::kRevolute ? angle(n) : n;
  };
  joint.axis = said.vector("axis", {0, 0, 1});
  joint.friction.viscous = said.number("damping");
  joint.friction.positive = joint.friction.negative = said.number("frictionloss");
  joint.rotor_inertia = said.number("armature");
  joint.stiffness = said.number("stiffness");
  if (!isZero(joint.stiffness)) joint.rest = difference(position("springref"), position("ref"));
  return joint;
}

/// In the order of the file, without recursion: bodies lie deep inside one another.
void MjcfReader::readBodies(const Node& world, const Carrier& carrier) {
  std::vector<std::pair<const Node*, Carrier>> left;  // bodies, with what carries them
  const auto enter = [&](const Node& node, const Carrier& at) {
    for (const Node& child : node.children) {
      const std::string kind = child.element.kind();
      if (kind == "geom") requireKnownGeom(child.element);
      if (isOneOf(kind, {"geom", "site", "camera", "light"})) ++left_out_[kind];
    }
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
      if (child->element.kind() == "body") left.emplace_back(&*child, at);
  };
  enter(world, carrier);
  while (!left.empty()) {
    const auto [node, at] = std::move(left.back());
    left.pop_back();
    enter(*node, readBody(*node, at));
  }
}

MjcfReader::Carrier MjcfReader::readBody(const Node& node, const Carrier& parent) {
  requireKnown(node.element,
               {"name", "childclass", "pos", "quat", "euler", "axisangle", "xyaxes", "zaxis",
                "mocap", "gravcomp"},
               {"user"});
  requireKnown(node, {"inertial", "joint", "freejoint", "geom", "site", "camera", "light", "body"});
  const Said said(node.element, kNone);
  const Class* defaults = parent.defaults;
  if (said.has("childclass")) {
    const auto found = classes_.find(said.text("childclass"));
    if (found == classes_.end())
      said.fail("childclass",
                "is \"" + said.text("childclass") + "\", allowed: a class of a <default>");
    defaults = &found->second;
  }
  if (!isZero(said.number("gravcomp")))
    said.fail("gravcomp",
              "is " + said.text("gravcomp") + ", a force that is not modelled, allowed: 0");
  ++bodies_;
  std::string name = said.text("name");
  if (name.empty()) name = unusedName(&body_names_, fmt::format("body_{}", bodies_));
  const bool has_joint =
      std::any_of(node.children.begin(), node.children.end(), [](const Node& child) {
        return isOneOf(child.element.kind(), {"joint", "freejoint"});
      });
  const bool rests = parent.rests && !has_joint;
  bool is_known = true;
  const MassProperties inertia = readInertia(node, *defaults, rests, &is_known);
  Carrier carrier = readJoints(node, parent, defaults, name, inertia, is_known);
  if (said.flag("mocap", false)) {
    if (!rests)
      said.fail("mocap", "is true, and it moves, allowed: a body that rests in the world");
    scene_.not_modelled.push_back("body " + name +
                                  ": mocap not modelled, it rests where it stands");
  }
  if (!is_known) {
    if (valueOf(total_mass_) > 0)
      said.fail(
          "settotalmass, and its mass comes from a mesh, which is not read, allowed: "
          "<inertial>");
    scene_.not_modelled.push_back("body " + name +
                                  ": mass of meshes not modelled, it rests in the world");
  }
  places_[name] = {carrier.link, carrier.shift, carrier.pose};
  return carrier;
}

/// The joints of a body, in a row of links of which the last is the body.
MjcfReader::Carrier MjcfReader::readJoints(const Node& node, const Carrier& parent,
                                           const Class* defaults, const std::string& name,
                                           const MassProperties& inertia, bool is_known) {
  const Said body(node.element, kNone);
  const Vector pos = body.vector("pos");
  const Turn turned = turn(body);
  Carrier out{name, {}, {}, defaults, parent.rests};
  out.pose.R = parent.pose.R * turned.R;
  out.pose.p = parent.pose.p + parent.pose.R * valueOf(pos);

  struct Read {
    Element element;
    Joint joint;
    Vector anchor;  ///< in the body's frame
  };
  std::vector<Read> joints;
  int dof = 0;
  bool has_ball = false;
  Vector anchor;
  for (const Node& child : node.children) {
    const std::string kind = child.element.kind();
    if (kind != "joint" && kind != "freejoint") continue;
    const bool by_class = kind == "joint";
    if (by_class)
      requireKnownJoint(child.element);
    else
      requireKnown(child.element, {"name", "align"}, {"group"});
    const Said own(child.element, kNone);
    const Said said(child.element, by_class ? classOf(own, *defaults).joint : kNone);
    if (!by_class && said.text("align", "auto") == "true")
      said.fail("align", "is true, which is not in the subset that is read, allowed: false");
    const std::string type =
        by_class ? said.word("type", "hinge", {"hinge", "slide", "ball", "free"}) : "free";
    const JointKind joint_kind = type == "hinge"   ? JointKind::kRevolute
                                 : type == "slide" ? JointKind::kPrismatic
                                 : type == "ball"  ? JointKind::kSpherical
                                                   : JointKind::kFloating;
    Read read{child.element, readJoint(said, joint_kind), anchor};
    ++joints_;
    read.joint.name = own.text("name");
    if (read.joint.name.empty())
      read.joint.name = unusedName(&joint_names_, fmt::format("joint_{}", joints_));
    dof += degreesOfFreedom(joint_kind);
    if (dof > 6) said.fail("the joints of its body have more than 6 degrees of freedom");
    if (has_ball && (joint_kind == JointKind::kRevolute || joint_kind == JointKind::kSpherical))
      said.fail("turns after a ball in the same body, allowed: before it");
    has_ball = has_ball || joint_kind == JointKind::kSpherical;
    if (joint_kind == JointKind::kFloating &&
        (parent.link != links_.front().link.name || dof != 6 || !joints.empty()))
      said.fail("is free, allowed: the only joint of a body in <worldbody>");
    // a slide may be anchored anywhere, and a free joint is at the body's origin
    if (joint_kind == JointKind::kRevolute || joint_kind == JointKind::kSpherical)
      anchor = said.vector("pos");
    read.anchor = anchor;
    has_limits_ = has_limits_ || said.has("range");
    Number ref(0);
    if (joint_kind == JointKind::kRevolute)
      ref = angle(said.number("ref"));
    else if (joint_kind == JointKind::kPrismatic)
      ref = said.number("ref");
    if (!isZero(ref))
      scene_.not_modelled.push_back(fmt::format(
          "joint {}: ref {} not modelled: q is MuJoCo's less that", read.joint.name, ref.text()));
    moving_index_.emplace(read.joint.name, moving_.size());
    moving_.push_back({read.joint.name, joint_kind, ref});
    joints.push_back(read);
  }

  const auto add = [&](const std::string& link_name, const std::string& carried_by, Joint joint,
                       const Vector& shift, bool is_last, const SourceLocation& where) {
    NamedLink named;
    named.link.name = link_name;
    named.link.where = where;
    named.link.joint = std::move(joint);
    named.parent = carried_by;
    named.parent_where = where;
    if (is_last) {
      named.link.inertia = inertia;
      named.link.inertia.com = difference(inertia.com, shift);
      if (!is_known) named.link.inertia = {};
    }
    links_.push_back(std::move(named));
    if (work_) work_->done();
  };
  const Vector from_parent = difference(pos, parent.shift);
  const SourceLocation where = node.element.where();
  if (joints.empty()) {
    Joint fixed;
    fixed.name = name;
    while (joint_names_.count(fixed.name) > 0) fixed.name += "_fixed";
    joint_names_.insert(fixed.name);
    fixed.placement.xyz = from_parent;
    fixed.placement.rpy = turned.rpy;
    add(name, parent.link, fixed, {}, true, where);
    return out;
  }
  out.rests = false;
  if (joints[0].joint.kind == JointKind::kFloating) {
    std::vector<Number> start(pos.begin(), pos.end());
    if (body.has("quat")) {
      for (const Number& n : body.numbers("quat", 4, 4)) start.push_back(n);
    } else {
      const Eigen::Quaternion<Real> q(turned.R);
      for (const Real x : {q.w(), q.x(), q.y(), q.z()}) start.push_back(printed(x, 1, where));
    }
    free_starts_[joints[0].joint.name] = start;
    add(name, parent.link, joints[0].joint, {}, true, where);
    return out;
  }
  std::string carried_by = parent.link;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    Read& read = joints[k];
    Placement& placement = read.joint.placement;
    if (k > 0) {
      placement.xyz = difference(read.anchor, joints[k - 1].anchor);
    } else {
      placement.rpy = turned.rpy;
      placement.xyz = from_parent;
      if (!isZero(read.anchor)) {
        const Vector3 moved = turned.R * valueOf(read.anchor), p = valueOf(from_parent) + moved;
        if (turned.isNone()) {
          for (std::size_t j = 0; j < 3; ++j)
            placement.xyz[j] = difference(from_parent[j], negative(read.anchor[j]));
        } else {
          placement.xyz = printed(p, valueOf(from_parent).norm() + moved.norm(), where);
        }
      }
    }
    const bool is_last = k + 1 == joints.size();
    const std::string link = is_last ? name : name + "." + read.joint.name;
    add(link, carried_by, read.joint, read.anchor, is_last, is_last ? where : read.element.where());
    carried_by = link;
  }
  out.shift = joints.back().anchor;
  return out;
}

// ------------------------------------------------------------------------- equality, keyframes

void MjcfReader::readClosure(const Said& said, bool is_weld) {
  Closing out;
  out.closure.where = said.where();
  out.closure.kind = is_weld ? ClosureKind::kWeld : ClosureKind::kPoint;
  out.closure.name = said.text("name");
  const auto place = [&](const char* key) -> const Place& {
    const std::string name = said.text(key, "world");
    const auto found = places_.find(name);
    if (found == places_.end()) said.fail(key, "is \"" + name + "\", allowed: the name of a body");
    return found->second;
  };
  if (!said.has("body1")) said.fail("has no body1");
  const Place &a = place("body1"), &b = place("body2");
  out.a = a.link;
  out.b = b.link;
  const SourceLocation where = said.where();
  Attachment &at_a = out.closure.a, &at_b = out.closure.b;
  const auto seenFrom = [&](const Place& place, const Vector3& world) {
    const Vector3 d = world - place.pose.p;
    return difference(
        printed(Vector3(place.pose.R.transpose() * d), world.norm() + place.pose.p.norm(), where),
        place.shift);
  };
  const Vector anchor = said.vector("anchor");
  if (!is_weld) {
    if (!said.has("anchor")) said.fail("has no anchor");
    at_a.xyz = difference(anchor, a.shift);
    at_b.xyz = seenFrom(b, a.pose.p + a.pose.R * valueOf(anchor));
    closings_.push_back(out);
    return;
  }
  // the frame of body2, moved to the anchor, is held to one of body1: the relative pose that is
  // given, or that of the reference
  at_b.xyz = difference(anchor, b.shift);
  std::vector<Number> pose = {0, 1, 0, 0, 0, 0, 0};
  if (said.has("relpose")) pose = said.numbers("relpose", 7, 7);
  const Vector3 v(valueOf(pose[4]), valueOf(pose[5]), valueOf(pose[6]));
  if (isZero(pose[3]) && v.isZero(0)) {
    at_a.xyz = seenFrom(a, b.pose.p + b.pose.R * valueOf(anchor));
    at_a.rpy = rollPitchYaw(a.pose.R.transpose() * b.pose.R, where);
  } else {
    at_a.xyz = difference({pose[0], pose[1], pose[2]}, a.shift);
    at_a.rpy = rollPitchYaw(turnOf(valueOf(pose[3]), v), where);
  }
  closings_.push_back(out);
}

void MjcfReader::readMimic(const Said& said) {
  const auto joint = [&](const char* key) -> const MovingJoint& {
    const std::string name = said.text(key);
    const auto place = moving_index_.find(name);
    if (place == moving_index_.end())
      said.fail(key, "is \"" + name + "\", allowed: the name of a joint");
    const MovingJoint* const found = &moving_[place->second];
    if (found->kind != JointKind::kRevolute && found->kind != JointKind::kPrismatic)
      said.fail(key, "is \"" + name + "\", allowed: a hinge or a slide");
    return *found;
  };
  if (!said.has("joint1")) said.fail("has no joint1");
  if (!said.has("joint2"))
    said.fail(
        "has no joint2: a joint that is held is not in the subset that is read, allowed: two "
        "joints");
  const MovingJoint &follower = joint("joint1"), &leader = joint("joint2");
  std::vector<Number> c = {0, 1, 0, 0, 0};
  if (said.has("polycoef")) c = said.numbers("polycoef", 5, 5);
  if (isZero(c[1]) || !isZero(c[2]) || !isZero(c[3]) || !isZero(c[4]))
    said.fail("polycoef", "is " + said.text("polycoef") +
                              ", allowed: a straight line that rises or falls, A B 0 0 0");
  Mimic mimic{leader.name, c[1], c[0]};
  if (follower.kind == JointKind::kRevolute) mimic.offset = angleOf(mimic.offset);
  if (!follows_.emplace(follower.name, mimic).second)
    said.fail("joint1", "is \"" + follower.name + "\", which follows another one already");
}

void MjcfReader::readEquality(const Node& node) {
  requireKnown(node, {"connect", "weld", "joint", "tendon"});
  for (const Node& child : node.children) {
    const std::string kind = child.element.kind();
    const Said own(child.element, kNone);
    const Said said(child.element, classOf(own, classes_["main"]).equality);
    if (kind == "tendon") {
      ++left_out_["equality of tendons"];
      continue;
    }
    if (kind == "joint")
      requireKnown(child.element, {"name", "class", "active", "joint1", "joint2", "polycoef"},
                   {"solref", "solimp"});
    else if (kind == "connect")
      requireKnown(child.element, {"name", "class", "active", "body1", "body2", "anchor"},
                   {"solref", "solimp"});
    else
      requireKnown(child.element,
                   {"name", "class", "active", "body1", "body2", "anchor", "relpose"},
                   {"solref", "solimp", "torquescale"});
    if (!said.flag("active", true)) {
      ++left_out_["equality that is not active"];
      continue;
    }
    if (kind == "joint")
      readMimic(said);
    else
      readClosure(said, kind == "weld");
  }
}

/// The first one is the start. MuJoCo's speeds of a free joint are in the axes of the world.
void MjcfReader::readKeyframes(const Node& node) {
  requireKnown(node, {"key"});
  for (const Node& child : node.children) {
    requireKnown(child.element, {"name", "qpos", "qvel"}, {"time", "act", "ctrl", "mpos", "mquat"});
    if (left_out_["keyframe"]++ > 0) continue;
    const Said said(child.element, kNone);
    const std::string name = said.text("name");
    scene_.not_modelled.push_back(fmt::format(
        "keyframe {} is the start; what else it says not modelled", name.empty() ? "1" : name));
    if (said.has("qpos")) {
      const auto count = static_cast<std::size_t>(scene_.mechanism.positions());
      scene_.start_q = said.numbers("qpos", count, count);
      std::size_t slot = 0;
      for (const MovingJoint& joint : moving_) {
        if (joint.kind == JointKind::kRevolute)
          scene_.start_q[slot] = angleOf(scene_.start_q[slot]);
        if (!isZero(joint.ref)) scene_.start_q[slot] = difference(scene_.start_q[slot], joint.ref);
        slot += positionSlots(joint.kind).size();
      }
    }
    if (!said.has("qvel")) continue;
    std::size_t count = 0;
    for (const MovingJoint& joint : moving_)
      count += static_cast<std::size_t>(degreesOfFreedom(joint.kind));
    const std::vector<Number> given = said.numbers("qvel", count, count);
    scene_.start_qd.clear();
    std::size_t slot = 0, rate = 0;
    for (const MovingJoint& joint : moving_) {
      const auto dof = static_cast<std::size_t>(degreesOfFreedom(joint.kind));
      Vector v = {0, 0, 0};
      for (std::size_t k = 0; k < std::min<std::size_t>(dof, 3); ++k) v[k] = given[rate + k];
      if (joint.kind == JointKind::kFloating && !isZero(v)) {
        const auto q = [&](std::size_t k) { return valueOf(scene_.start_q[slot + k]); };
        const Matrix3 R = turnOf(q(3), {q(4), q(5), q(6)});
        v = printed(Vector3(R.transpose() * valueOf(v)), valueOf(v).norm(), said.where());
      }
      const bool follows = follows_.count(joint.name) > 0;
      for (std::size_t k = 0; k < dof && !follows; ++k)
        scene_.start_qd.push_back(k < 3 ? v[k] : given[rate + k]);
      rate += dof;
      slot += positionSlots(joint.kind).size();
    }
  }
}

void MjcfReader::tell() {
  std::string list;
  for (const auto& [kind, count] : left_out_) {
    if (kind == "keyframe") {
      if (count > 1)
        scene_.not_modelled.push_back(fmt::format("{} more keyframes not modelled", count - 1));
      continue;
    }
    list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, kind);
  }
  if (!list.empty()) scene_.not_modelled.push_back(list + " not modelled");
  if (has_limits_) scene_.not_modelled.push_back("joint limits not modelled");
}

Scene MjcfReader::read(const Node& top, double elements) {
  requireKnown(top.element, {"model"});
  requireKnown(
      top, {"compiler", "option", "size", "default", "asset", "worldbody", "visual", "statistic",
            "custom", "contact", "tendon", "actuator", "sensor", "equality", "keyframe"});
  work_ = std::make_unique<Work>("", 2 * elements);
  scene_.title = Said(top.element, kNone).text("model", scene_.name);
  Mechanism& mechanism = scene_.mechanism;
  mechanism.has_gravity = true;
  mechanism.gravity = {0, 0, Expression::parse("-9.81")};
  classes_["main"];
  const auto each = [&](const char* kind, const auto& visit) {
    for (const Node& section : top.children)
      if (section.element.kind() == kind) visit(section);
  };
  each("compiler", [&](const Node& node) { readCompiler(node); });
  each("option", [&](const Node& node) { readOption(node); });
  if (isZero(mechanism.gravity)) mechanism.has_gravity = false;
  if (!mechanism.has_gravity) mechanism.gravity = {};
  each("default", [&](const Node& node) { readDefaults(node, nullptr); });
  for (const Node& section : top.children)
    if (isOneOf(section.element.kind(),
                {"asset", "custom", "contact", "tendon", "actuator", "sensor"}))
      left_out_["of <" + section.element.kind() + ">"] += static_cast<int>(section.children.size());

  NamedLink world;
  world.link.name = "world";
  world.link.where = top.element.where();
  links_.push_back(world);
  places_["world"] = {"world", {}, {}};
  body_names_.insert("world");
  each("worldbody", [&](const Node& node) { takeNames(node); });
  each("worldbody", [&](const Node& node) {
    requireKnown(node.element, {});
    requireKnown(node, {"geom", "site", "camera", "light", "body"});
    readBodies(node, {"world", {}, {}, &classes_["main"], true});
  });
  setTotalMass();
  each("equality", [&](const Node& node) { readEquality(node); });
  for (NamedLink& named : links_)
    if (const auto f = follows_.find(named.link.joint.name); f != follows_.end())
      named.link.joint.mimic = f->second;

  mechanism.links = arrange(links_, file_);
  std::unordered_map<std::string, int> index;
  for (const Link& link : mechanism.links) index.emplace(link.name, static_cast<int>(index.size()));
  for (Closing& c : closings_) {
    if (c.closure.name.empty()) c.closure.name = std::to_string(mechanism.closures.size() + 1);
    c.closure.a.link = index.at(c.a);
    c.closure.b.link = index.at(c.b);
    mechanism.closures.push_back(c.closure);
  }
  scene_.start_q = mechanism.restPosition();
  scene_.start_qd.resize(static_cast<std::size_t>(mechanism.dof()));
  std::size_t slot = 0;
  for (const MovingJoint& joint : moving_) {
    if (const auto start = free_starts_.find(joint.name); start != free_starts_.end())
      std::copy(start->second.begin(), start->second.end(),
                scene_.start_q.begin() + static_cast<std::ptrdiff_t>(slot));
    slot += positionSlots(joint.kind).size();
  }
  each("keyframe", [&](const Node& node) { readKeyframes(node); });
  followLeaders(followers(mechanism), &scene_.start_q);
  tell();
  return std::move(scene_);
}

}  // namespace

bool isMjcf(const std::string& text) {
  return outermostElement(text) == "mujoco";
}

Scene readSceneMjcf(const std::string& text, const std::filesystem::path& file) {
  return readSceneMjcf(text, file, InertiaNeed::kOfEachJoint);
}

Scene readSceneMjcf(const std::string& text, const std::filesystem::path& file, InertiaNeed need) {
  Files files;
  const Node top = files.read(text, file);
  Scene scene = MjcfReader(file).read(top, files.elements());
  validate(scene, need);
  return scene;
}

}  // namespace dynwitness::scene
