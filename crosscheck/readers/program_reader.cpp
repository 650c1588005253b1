// SPDX-License-Identifier: GPL-3.0-or-later
// Programs as readers of robot descriptions: they are told where the file is, and say what they
// have made of it, link by link or in M and g alone (crosscheck/witnesses/engine_protocol.md).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>

#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/readers/reader.hpp"
#include "crosscheck/readers/rules.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/system/own_program.hpp"
#include "crosscheck/system/shell.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "scene/scene.hpp"
#include "scene/text_file.hpp"

namespace dynwitness::crosscheck {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

[[noreturn]] void expected(const std::string& where, const std::string& what, const Json& came) {
  constexpr std::size_t kShown = 80;
  std::string text = came.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > kShown) text = text.substr(0, kShown) + "...";
  throw std::runtime_error(where + ": expected " + what + ", got " + text);
}

/// A member, or its stand-in.
const Json& member(const Json& from, const char* key, const Json& otherwise = Json()) {
  const auto at = from.is_object() ? from.find(key) : from.end();
  static const Json none;
  if (!from.is_object() || at == from.end()) return otherwise.is_null() ? none : otherwise;
  return *at;
}

double numberOf(const std::string& where, const Json& from) {
  if (!from.is_number()) expected(where, "a number", from);
  return from.get<double>();
}
double numberOr(const Json& from, const char* key, double otherwise) {
  const auto at = from.find(key);
  return at == from.end() || at->is_null() ? otherwise : numberOf(key, *at);
}
std::string textOr(const Json& from, const char* key, const std::string& otherwise) {
  const auto at = from.find(key);
  if (at == from.end()) return otherwise;
  if (!at->is_string()) expected(key, "text", *at);
  return at->get<std::string>();
}
std::vector<std::string> textsOf(const Json& from, const char* key) {
  std::vector<std::string> out;
  const auto at = from.find(key);
  if (at == from.end()) return out;
  if (!at->is_array()) expected(key, "a list of texts", *at);
  for (const Json& text : *at) {
    if (!text.is_string()) expected(key, "a list of texts", *at);
    out.push_back(text.get<std::string>());
  }
  return out;
}
Vector3d vectorOf(const std::string& where, const Json& from) {
  if (!from.is_array() || from.size() != 3) expected(where, "three numbers", from);
  return {numberOf(where, from[0]), numberOf(where, from[1]), numberOf(where, from[2])};
}
Matrix3d matrixOf(const std::string& where, const Json& from) {
  if (!from.is_array() || from.size() != 3) expected(where, "three rows", from);
  Matrix3d out;
  for (int i = 0; i < 3; ++i)
    out.row(i) = vectorOf(where, from[static_cast<std::size_t>(i)]).transpose();
  return out;
}
/// x_outer = R x_inner + p; nothing: the same frame.
Isometry3d frameOf(const std::string& where, const Json& from) {
  Isometry3d X = Isometry3d::Identity();
  if (from.is_null()) return X;
  if (!from.is_object()) expected(where, "R and p", from);
  X.linear() = matrixOf(where + ".R", member(from, "R"));
  X.translation() = vectorOf(where + ".p", member(from, "p"));
  return X;
}

scene::JointKind kindOf(const std::string& where, const Json& joint) {
  const std::string said = textOr(joint, "kind", "");
  using Kind = scene::JointKind;
  for (const Kind kind :
       {Kind::kFixed, Kind::kRevolute, Kind::kPrismatic, Kind::kHelical, Kind::kCylindrical,
        Kind::kUniversal, Kind::kPlanar, Kind::kSpherical, Kind::kFloating})
    if (said == scene::name(kind)) return kind;
  expected(where + ".kind", "a kind of joint", said);
}

ReadBody jointOf(const std::string& where, const Json& joint) {
  ReadBody out;
  out.joint = textOr(joint, "name", "");
  out.kind = kindOf(where, joint);
  out.axis.setZero();
  if (!hasOnePosition(out)) return out;
  out.axis = vectorOf(where + ".axis", member(joint, "axis"));
  const auto limit = [&](const char* key) {
    const Json& x = member(joint, key);
    return x.is_null() ? std::optional<double>() : numberOf(where + "." + key, x);
  };
  out.lower = limit("lower");
  out.upper = limit("upper");
  out.damping = numberOr(joint, "viscous", 0);
  out.friction = numberOr(joint, "coulomb", 0);
  out.armature = numberOr(joint, "armature", 0);
  out.stiffness = numberOr(joint, "stiffness", 0);
  out.rest = numberOr(joint, "rest", 0);
  if (const Json& mimic = member(joint, "mimic"); mimic.is_object()) {
    out.leader = textOr(mimic, "joint", "");
    out.multiplier = numberOr(mimic, "multiplier", 1);
    out.offset = numberOr(mimic, "offset", 0);
  }
  return out;
}

/// Links as they are shown, those lumped that are fixed to others.
Robot robotOf(const Json& shows) {
  Robot robot;
  robot.gravity = vectorOf("shows.gravity", member(shows, "gravity"));
  robot.unturned = numberOr(shows, "principal_axes", 0);
  const Json& links = member(shows, "links");
  if (!links.is_array()) expected("shows.links", "a list of links", links);
  struct Carrier {
    int body = -1;
    Isometry3d from = Isometry3d::Identity();
  };
  std::vector<Carrier> carriers;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Json& link = links[i];
    const std::string where = fmt::format("shows.links[{}]", i);
    if (!link.is_object()) expected(where, "a link", link);
    const double parent = numberOr(link, "parent", -1);
    if (!(parent >= -1 && parent < static_cast<double>(i)) || parent != std::floor(parent))
      expected(where + ".parent", "a link before it, or -1", parent);
    Carrier here = parent < 0 ? Carrier() : carriers[static_cast<std::size_t>(parent)];
    if (const Json& joint = member(link, "joint"); joint.is_object()) {
      const Isometry3d before = frameOf(where + ".before", member(joint, "before")),
                       after = frameOf(where + ".after", member(joint, "after"));
      ReadBody body = jointOf(where + ".joint", joint);
      if (body.kind == scene::JointKind::kFixed) {
        here.from = here.from * before * after;
      } else {
        body.link = textOr(link, "name", "");
        body.parent = here.body;
        body.placement = here.from * before;
        here = {static_cast<int>(robot.bodies.size()), after};
        robot.bodies.push_back(body);
      }
    }
    carriers.push_back(here);
    if (here.body < 0) continue;
    robot.bodies[static_cast<std::size_t>(here.body)].moments +=
        MassMoments::of(numberOr(link, "mass", 0), vectorOf(where + ".com", member(link, "com")),
                        matrixOf(where + ".inertia", member(link, "inertia")))
            .movedBy(here.from);
  }
  return robot;
}

Json parsed(const std::string& line) {
  constexpr int kDeepest = 12;  // what is nested more deeply is left out: nothing of ours is
  Json out = Json::parse(
      line, [](int depth, Json::parse_event_t, Json&) { return depth <= kDeepest; }, false);
  if (!out.is_object()) expected("its answer", "a JSON object on one line", line.substr(0, 80));
  return out;
}

/** A program and the order in which it keeps the joints of a robot. */
class Talk {
 public:
  Talk(const std::string& command, const Limits& limits) : program_(command, limits) {}

  /// @param file  an absolute path
  Reading greet(const Robot& ours, const fs::path& file) {
    Json joints = Json::array();
    for (const ReadBody& body : ours.bodies) joints.push_back(body.joint);
    const Json greeting = {{"protocol", kEngineProtocol},
                           {"scene",
                            {{"name", file.stem().string()},
                             {"file", file.string()},
                             {"positions", ours.bodies.size()},
                             {"dof", ours.bodies.size()},
                             {"joints", joints}}}};
    constexpr std::size_t kMost = std::size_t{1} << 28;
    const Json said =
        parsed(program_.ask(greeting.dump(-1, ' ', false, Json::error_handler_t::replace), kMost));
    if (member(said, "protocol") != kEngineProtocol)
      expected("protocol", fmt::format("version {}", kEngineProtocol), member(said, "protocol"));
    Reading reading;
    reading.name = textOr(said, "name", "");
    reading.version = textOr(said, "version", "");
    if (said.contains("refuses")) {
      reading.refusal = textOr(said, "refuses", "");
      if (reading.refusal.empty()) reading.refusal = "it gives no reason";
      return reading;
    }
    reading.shows = said.contains("shows");
    if (reading.shows) {
      const Json& shows = said.at("shows");
      if (!shows.is_object()) expected("shows", "what it has read", shows);
      reading.robot = robotOf(shows);
      reading.told = textsOf(shows, "told");
      reading.not_kept = textsOf(shows, "not_kept");
    } else {
      reading.robot = ours;
    }
    const std::vector<std::string> quantities = textsOf(said, "quantities");
    const auto knows = [&](const char* quantity) {
      return std::find(quantities.begin(), quantities.end(), quantity) != quantities.end();
    };
    says_both_ = knows("M") && knows("g");
    says_tau_ = knows("tau");
    if (!says_both_ && !says_tau_ && !reading.shows)
      expected("quantities", "M and g, or tau, or else \"shows\"", quantities);
    takeOrder(reading.robot, textsOf(said, "joints"));
    return reading;
  }

  bool answers() const { return says_both_ || says_tau_; }

  /** M and g; from tau where it says that alone:  g = tau(q, 0, 0),  M e_j = tau(q, 0, e_j) - g. */
  MassAndGravity ask(const std::vector<double>& q) {
    const auto n = static_cast<Eigen::Index>(order_.size());
    MassAndGravity out{Eigen::MatrixXd(n, n), Eigen::VectorXd(n), {}, {}};
    std::vector<Json> states;
    for (Eigen::Index k = 0; k <= (says_both_ ? 0 : n); ++k) {
      std::vector<double> positions, zero(q.size(), 0.0), qdd(q.size(), 0.0);
      for (const int i : order_) positions.push_back(q[static_cast<std::size_t>(i)]);
      if (k > 0) qdd[static_cast<std::size_t>(k - 1)] = 1;
      states.push_back({{"q", positions}, {"qd", zero}, {"qdd", qdd}, {"tau", zero}});
    }
    const std::vector<Json> said = batches(states);
    const auto place = [&](Eigen::Index i) {
      return static_cast<Eigen::Index>(order_[static_cast<std::size_t>(i)]);
    };
    if (says_both_) {
      const Json& M = member(said.at(0), "M");
      if (!M.is_array() || M.size() != order_.size()) expected("M", fmt::format("{} rows", n), M);
      const Eigen::VectorXd g = numbers("g", said.at(0));
      for (Eigen::Index i = 0; i < n; ++i) {
        out.g[place(i)] = g[i];
        const Eigen::VectorXd row = numbers("M", {{"M", M[static_cast<std::size_t>(i)]}});
        for (Eigen::Index j = 0; j < n; ++j) out.M(place(i), place(j)) = row[j];
      }
      return out;
    }
    const Eigen::VectorXd g = numbers("tau", said.at(0));
    for (Eigen::Index j = 0; j < n; ++j) {
      out.g[place(j)] = g[j];
      const Eigen::VectorXd column = numbers("tau", said.at(static_cast<std::size_t>(j) + 1)) - g;
      for (Eigen::Index i = 0; i < n; ++i) out.M(place(i), place(j)) = column[i];
    }
    return out;
  }

 private:
  /// theirs[i] is ours[order_[i]]
  void takeOrder(const Robot& robot, const std::vector<std::string>& theirs) {
    order_.clear();
    if (theirs.empty())
      for (std::size_t i = 0; i < robot.bodies.size(); ++i) order_.push_back(static_cast<int>(i));
    for (const std::string& name : theirs) {
      const auto at = std::find_if(robot.bodies.begin(), robot.bodies.end(),
                                   [&](const ReadBody& body) { return body.joint == name; });
      if (at == robot.bodies.end()) throw std::runtime_error(notAll(robot, theirs));
      order_.push_back(static_cast<int>(at - robot.bodies.begin()));
    }
    std::vector<int> sorted = order_;
    std::sort(sorted.begin(), sorted.end());
    if (sorted.size() != robot.bodies.size() ||
        std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
      throw std::runtime_error(notAll(robot, theirs));
  }
  static std::string notAll(const Robot& robot, const std::vector<std::string>& theirs) {
    std::vector<std::string> ours;
    for (const ReadBody& body : robot.bodies) ours.push_back(body.joint);
    return fmt::format("joints: expected all of {}, in any order, got {}", fmt::join(ours, ", "),
                       fmt::join(theirs, ", "));
  }

  std::vector<Json> batches(const std::vector<Json>& states) {
    std::vector<Json> out;
    for (std::size_t from = 0; from < states.size(); from += kEngineBatch) {
      const std::size_t count = std::min(kEngineBatch, states.size() - from);
      Json question = {{"batch", ++batch_},
                       {"quantities", says_both_ ? Json({"M", "g"}) : Json({"tau"})},
                       {"states", Json::array()}};
      for (std::size_t k = 0; k < count; ++k) question["states"].push_back(states[from + k]);
      constexpr std::size_t kPerNumber = 48, kWords = 1 << 16;
      const std::size_t n = order_.size();
      const Json said =
          parsed(program_.ask(question.dump(), kWords + kPerNumber * count * n * (n + 1)));
      const Json& answers = member(said, "answers");
      if (member(said, "batch") != batch_)
        expected("batch", std::to_string(batch_), member(said, "batch"));
      if (!answers.is_array() || answers.size() != count)
        expected("answers", fmt::format("a list of {}, one a state", count), answers);
      for (const Json& answer : answers) out.push_back(answer);
    }
    return out;
  }

  Eigen::VectorXd numbers(const char* quantity, const Json& answer) const {
    const Json& list = member(answer, quantity);
    if (list.is_string())
      throw std::runtime_error(fmt::format("it has no {}: {}", quantity, list.get<std::string>()));
    if (!list.is_array() || list.size() != order_.size())
      expected(quantity, fmt::format("{} numbers", order_.size()), list);
    Eigen::VectorXd out(static_cast<Eigen::Index>(list.size()));
    for (std::size_t i = 0; i < list.size(); ++i)
      out[static_cast<Eigen::Index>(i)] = numberOf(quantity, list[i]);
    return out;
  }

  Conversation program_;
  std::vector<int> order_;
  bool says_both_ = false, says_tau_ = false;
  int batch_ = 0;
};

/// A folder with a text that is no file of the user's, which goes when nobody needs it.
struct Lent {
  std::unique_ptr<DraftFolder> folder;
  fs::path path;

  /// The user's own file, so that meshes are found beside it, or one of the same name.
  Lent(const std::string& text, const fs::path& file) {
    std::error_code ignored;
    std::string written;
    try {
      written = scene::readTextFile(file, "a URDF or MJCF file");
    } catch (const std::exception&) {
      // there is none of this name
    }
    path = fs::absolute(file, ignored);
    if (written == text) return;
    folder = std::make_unique<DraftFolder>(fs::temp_directory_path(), "dynwitness-reader");
    path = folder->path() / file.filename();
    std::ofstream(path, std::ios::binary) << text;
  }
};

/// The first that there is, of a program that was built beside this one (or beside a test).
fs::path built(const std::string& name) {
  for (const fs::path& folder : {ownProgram().parent_path(), ownProgram().parent_path() / "bin"}) {
    std::error_code ignored;
    if (fs::exists(folder / name, ignored)) return folder / name;
  }
  return {};
}

Reader absent(const std::string& name, const std::string& why) {
  Reader reader{name, "", false, {}};
  reader.absence = why;
  return reader;
}

/// What a program of ours has for one answer, on a machine that may be busy: Node compiles 11 MB.
constexpr double kBusy = 50;

/// A reader that was compiled with its library.
Reader builtReader(const std::string& name, const std::string& program, const std::string& package,
                   Limits limits) {
  const fs::path file = built(program);
  if (file.empty()) return absent(name, "absent from this build (Debian: " + package + ")");
  limits.seconds = std::max(limits.seconds, kBusy);
  Reader reader = programReader(name, shellWord(file.string()), limits);
  reader.reads_mjcf = false;
  return reader;
}

bool isOnPath(const std::string& command) {
  const char* const path = std::getenv("PATH");
  std::stringstream folders(path ? path : "/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((fs::path(folder) / command).c_str(), X_OK) == 0) return true;
  return false;
}

/// MuJoCo of today: a package of npm, which the wrapper puts under build/, run by Node.
Reader mujocoByNpm(const Limits& limits) {
  constexpr const char* kName = "mujoco_npm";
  fs::path package;
  for (const fs::path& folder :
       {ownProgram().parent_path().parent_path(), ownProgram().parent_path()}) {
    const fs::path at = folder / "engines" / "mujoco-js" / "dist" / "mujoco_wasm.js";
    std::error_code ignored;
    if (package.empty() && fs::exists(at, ignored)) package = at;
  }
  if (package.empty())
    return absent(kName,
                  "absent: no package mujoco-js under build/engines (./dynwitness readers "
                  "fetches it where there is a network)");
  if (!isOnPath("node")) return absent(kName, "absent: no node (Debian: nodejs)");
  Limits wide = limits;  // Node and WebAssembly reserve more address space than they use
  constexpr double kReserved = 1000;
  wide.gigabytes = std::max(wide.gigabytes, kReserved);
  wide.seconds = std::max(wide.seconds, kBusy);
  return programReader(
      kName,
      "exec node " + shellWord((scene::dataFolder() / "engines" / "mujoco_engine.mjs").string()) +
          " " + shellWord(package.string()),
      wide);
}

}  // namespace

Reader programReader(const std::string& name, const std::string& command, const Limits& limits) {
  Reader reader{name, "", true, {}};
  reader.is_program = true;
  reader.reads_mjcf = true;  // or refuses it in its own words
  reader.read = [command, limits](const std::string& text, const fs::path& file) {
    const FileParts parts = readParts(text, file);
    const auto lent = std::make_shared<Lent>(text, file);
    const auto talk = std::make_shared<Talk>(command, limits);
    Reading reading = talk->greet(parts.robot(), lent->path);
    if (reading.refusal.empty() && talk->answers())
      reading.answer = [talk, lent](const std::vector<double>& q) { return talk->ask(q); };
    return reading;
  };
  return reader;
}

std::vector<Reader> engineReaders(const std::vector<std::string>& commands, const Limits& limits) {
  std::vector<Reader> out = {
      mujocoReader(), mujocoByNpm(limits), dartReader(),
      builtReader("kdl_parser", "dynwitness-reader-kdl", "libkdl-parser-dev", limits),
      builtReader("sdformat", "dynwitness-reader-sdformat", "libsdformat-dev", limits)};
  for (std::size_t k = 0; k < commands.size(); ++k)
    out.push_back(programReader(fmt::format("engine_{}", k + 1), commands[k], limits));
  return out;
}

}  // namespace dynwitness::crosscheck
