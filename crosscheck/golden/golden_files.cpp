// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/golden/golden_files.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/witnesses/engine_protocol.hpp"
#include "scene/numbers.hpp"
#include "scene/units.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;
using Named = std::pair<const char*, std::string>;

/// The shortest decimal that is read as this double; "" for what is no number.
std::string text(double x) {
  if (!std::isfinite(x)) return "";
  std::array<char, 32> digits;
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), x).ptr};
}

/// On one line, and nothing in it that would end a comment.
std::string line(std::string words) {
  for (char& c : words)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  for (std::size_t at; (at = words.find("*/")) != std::string::npos;) words.replace(at, 2, "* ");
  return words;
}

bool hasKind(const scene::Mechanism& mechanism, const std::vector<scene::JointKind>& kinds) {
  return std::any_of(mechanism.links.begin(), mechanism.links.end(), [&](const scene::Link& link) {
    return link.parent >= 0 && std::count(kinds.begin(), kinds.end(), link.joint.kind) > 0;
  });
}

/// What one has to know to give the same numbers.
std::vector<Named> conventions(const Golden& golden) {
  using scene::JointKind;
  const scene::Mechanism& mechanism = golden.scene.mechanism;
  std::string gravity = "none";
  if (mechanism.has_gravity) {
    const scene::RealNumbers<double> number(mechanism);
    const auto of = [&](int i) {
      return text(number(mechanism.gravity[static_cast<std::size_t>(i)]));
    };
    gravity = fmt::format(
        "bodies fall with [{}, {}, {}] m/s^2 in world axes, in which the root link rests; tau "
        "includes it",
        of(0), of(1), of(2));
  }
  std::vector<Named> out = {
      {"equation",
       "M(q) qdd + c(q, qd) + g(q) + friction(qd) = tau + loads. c holds velocity products only; "
       "g = dV/dq, springs included; friction and loads are in tau and qdd alone"},
      {"units", "SI: m, kg, s, rad, N, N m, J"},
      {"order",
       "q has the positions and qd, qdd, tau, c, g, rows and columns of M the rates, joint after "
       "joint in the order of the links; fixed joints have none"},
      {"quantities",
       "M mass matrix; c; g; tau: of q, qd, qdd (inverse dynamics); qdd: of q, qd and the tau that "
       "is given (forward dynamics); kinetic energy; potential energy, -gravity . m p summed over "
       "all links, p their centres of mass from the world's origin, and stiffness (q - rest)^2 / 2 "
       "over all springs; momentum of all moving links: linear, then angular about the world's "
       "origin, in world axes; reactions: of q, qd, qdd, row by row for every joint of the scene, "
       "fixed ones too, in the order of the links, force and then moment that the parent exerts on "
       "the link through the joint, about the origin of the moved joint frame, in its axes: all that "
       "passes, what drive, spring and friction do about the axis included"},
      {"joints",
       "a joint moves about or along its axis, positive by the right hand, its frame being placed "
       "on the parent link's; tau > 0 pushes towards larger q"},
      {"gravity", gravity},
      {"inertia",
       "about the centre of mass, in the axes of the link. A rotor adds gear_ratio^2 rotor_inertia "
       "to its joint; friction is viscous qd + Coulomb's, which is 0 at rest"},
      {"inputs",
       "exact: the decimal is the double, and the float. They have no more digits than shown"},
      {"value", "the double nearest to the truth, as the shortest decimal that is read as it"},
      {"digits50",
       "the truth at 50 digits; it lies within radius of that, which is certified (ball "
       "arithmetic), for the decimal numbers of the scene as written"},
      {"limit",
       "how far an answer may lie from value: what an algorithm of the usual kinds (recursive "
       "Newton-Euler, composite bodies, articulated bodies), with rotation matrices in axes of its "
       "own, may lose in double; derived, not tuned. Orientations multiplied as quaternions, and "
       "forces gathered about a far point, may lose a few times as much. None: nothing can be asked "
       "there. In single precision it is 2^29 = 536870912 times as much"}};
  if (hasKind(mechanism, {JointKind::kSpherical, JointKind::kFloating}))
    out.emplace_back(
        "quaternions",
        "w, x, y, z; they turn link axes into the axes of the joint frame. Their length "
        "is near 1 and not 1: normalise first");
  if (hasKind(mechanism, {JointKind::kSpherical}))
    out.emplace_back("spherical",
                     "qd: angular velocity wx, wy, wz of the link against the joint frame, in the "
                     "axes of the link's (moved) joint frame; tau: the moment, in these axes");
  if (hasKind(mechanism, {JointKind::kFloating}))
    out.emplace_back(
        "floating",
        "q: position x, y, z of the moved joint frame's origin in the joint frame, then "
        "the quaternion; qd: velocity of that origin, then angular velocity, both in the "
        "axes of the moved joint frame; qdd their derivatives by components; tau: force, "
        "then moment about that origin, in these axes");
  if (hasKind(mechanism, {JointKind::kCylindrical}))
    out.emplace_back("cylindrical", "q: slide along the axis, then turn about it");
  if (hasKind(mechanism, {JointKind::kUniversal}))
    out.emplace_back("universal", "q: turn about x of the joint frame, then about the new y");
  if (hasKind(mechanism, {JointKind::kPlanar}))
    out.emplace_back("planar", "q: shift along x and y, then turn about z (the axis)");
  if (hasKind(mechanism, {JointKind::kHelical}))
    out.emplace_back("helical", "q: turn about the axis [rad], which advances by pitch q along it");
  return out;
}

/// What each number of q and of qd belongs to.
struct Labels {
  explicit Labels(const scene::Mechanism& mechanism) : rates(mechanism.rateLabels()) {
    for (const int i : mechanism.movingLinks()) {
      const scene::Joint& joint = mechanism.links[static_cast<std::size_t>(i)].joint;
      const std::vector<scene::SlotKind>& slots = scene::positionSlots(joint.kind);
      int part = 0;
      for (const scene::SlotKind slot : slots) {
        positions.push_back(joint.name + (slots.size() == 1 ? "" : fmt::format(".{}", ++part)));
        position_units.emplace_back(scene::unitOf(slot));
      }
    }
  }
  std::vector<std::string> positions, position_units, rates;
};

std::vector<double> positionsOf(const scene::State<double>& state) {
  std::vector<double> q;
  for (const auto& x : state.x) q.push_back(x.q);
  return q;
}
/// The names and numbers that are given.
std::vector<std::pair<const char*, std::vector<double>>> given(const scene::State<double>& state) {
  return {{"q", positionsOf(state)}, {"qd", state.qd}, {"qdd", state.qdd}, {"tau", state.tau}};
}

/// What stands above the numbers, line by line.
std::vector<std::string> heading(const Golden& golden, const std::string& version) {
  const Labels labels(golden.scene.mechanism);
  std::vector<std::string> out = {
      fmt::format("golden vectors of {}, format {}, seed {}, by dynwitness {}", golden.scene.name,
                  kGoldenFormat, golden.seed, version),
      "title: " + golden.scene.title, "source: " + golden.scene.source,
      "mechanism: its links, joints and numbers are in the JSON file, under scene"};
  for (const auto& [key, words] : conventions(golden)) out.push_back(key + (": " + words));
  for (std::size_t k = 0; k < labels.positions.size(); ++k)
    out.push_back(
        fmt::format("q {}: {} [{}]", k + 1, labels.positions[k], labels.position_units[k]));
  for (std::size_t k = 0; k < labels.rates.size(); ++k)
    out.push_back(fmt::format("qd {}: {}", k + 1, labels.rates[k]));
  for (const GoldenGroup& group : golden.groups)
    out.push_back(fmt::format("group {}: {}", group.name, group.sentence));
  for (const GoldenGroup& group : golden.groups)
    for (const GoldenState& state : group.states) {
      if (!state.note.empty()) out.push_back(fmt::format("state {}: {}", state.index, state.note));
      for (const GoldenAnswer& one : state.answers)
        if (!one.none.empty())
          out.push_back(
              fmt::format("state {} has no {}: {}", state.index, name(one.quantity), one.none));
    }
  for (const std::string& sentence : golden.left_out) out.push_back("left out: " + sentence);
  for (std::string& words : out) words = line(std::move(words));
  return out;
}

/// Calls back for each number that is wanted.
void forEach(const Golden& golden,
             const std::function<void(const GoldenGroup&, const GoldenState&, const GoldenAnswer&,
                                      Eigen::Index row, Eigen::Index column)>& with) {
  for (const GoldenGroup& group : golden.groups)
    for (const GoldenState& state : group.states)
      for (const GoldenAnswer& one : state.answers)
        for (Eigen::Index i = 0; i < one.value.rows(); ++i)
          for (Eigen::Index j = 0; j < one.value.cols(); ++j) with(group, state, one, i, j);
}
const std::string& digitsOf(const GoldenAnswer& one, Eigen::Index row, Eigen::Index column) {
  return one.digits[static_cast<std::size_t>(column * one.value.rows() + row)];
}

/// A number, a list, or rows, as the quantity is shaped.
Json shaped(Quantity quantity, const Eigen::MatrixXd& m,
            const std::function<Json(Eigen::Index, Eigen::Index)>& at) {
  if (quantity == Quantity::kKinetic || quantity == Quantity::kPotential) return at(0, 0);
  Json out = Json::array();
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    if (quantity != Quantity::kM && quantity != Quantity::kReactions) {
      out.push_back(at(i, 0));
      continue;
    }
    Json row = Json::array();
    for (Eigen::Index j = 0; j < m.cols(); ++j) row.push_back(at(i, j));
    out.push_back(row);
  }
  return out;
}

Json answerJson(const GoldenAnswer& one) {
  if (!one.none.empty()) return {{"none", one.none}};
  const auto numbers = [&](const Eigen::MatrixXd& m) {
    return shaped(one.quantity, m, [&](Eigen::Index i, Eigen::Index j) {
      return std::isfinite(m(i, j)) ? Json(m(i, j)) : Json(nullptr);
    });
  };
  return {{"value", numbers(one.value)},
          {"digits50",
           shaped(one.quantity, one.value,
                  [&](Eigen::Index i, Eigen::Index j) { return Json(digitsOf(one, i, j)); })},
          {"radius", numbers(one.radius)},
          {"limit", numbers(one.limit)}};
}

Json stateJson(const GoldenState& state) {
  Json out = {{"state", state.index}};
  if (!state.note.empty()) out["note"] = state.note;
  for (const auto& [key, numbers] : given(state.state)) out[key] = numbers;
  out["answers"] = Json::object();
  for (const GoldenAnswer& one : state.answers)
    out["answers"][name(one.quantity)] = answerJson(one);
  return out;
}

std::string dumped(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string goldenJson(const Golden& golden, const std::string& version) {
  Json about = {{"format", kGoldenFormat},       {"dynwitness", version},
                {"name", golden.scene.name},     {"title", golden.scene.title},
                {"source", golden.scene.source}, {"seed", golden.seed}};
  for (const auto& [key, words] : conventions(golden)) about["conventions"][key] = words;
  const Labels labels(golden.scene.mechanism);
  about["q"] = labels.positions;
  about["q_units"] = labels.position_units;
  about["qd"] = labels.rates;
  about["left_out"] = golden.left_out;
  // the mechanism as engines are told it: in numbers, rounded once, and as written
  about["scene"] = Json::parse(greetingOf(golden.scene)).at("scene");
  std::string out = "{\n";
  for (const auto& [key, value] : about.items())
    out += fmt::format("\"{}\": {},\n", key, dumped(value, key == "conventions" ? 1 : -1));
  out += "\"groups\": [";
  for (std::size_t g = 0; g < golden.groups.size(); ++g) {
    const GoldenGroup& group = golden.groups[g];
    out += fmt::format("{}\n {{\"group\": \"{}\", \"sentence\": {},{}\n  \"states\": [",
                       g == 0 ? "" : ",", group.name, dumped(group.sentence),
                       group.of > 0 ? fmt::format(" \"of\": {},", group.of) : "");
    for (std::size_t k = 0; k < group.states.size(); ++k)
      out += (k == 0 ? "\n   " : ",\n   ") + dumped(stateJson(group.states[k]));
    out += "\n  ]}";
  }
  return out + "\n]\n}\n";
}

std::string goldenCsv(const Golden& golden, const std::string& version) {
  std::string out;
  for (const std::string& words : heading(golden, version)) out += "# " + words + "\n";
  out += "group,state,role,quantity,row,column,value,digits50,radius,limit\n";
  for (const GoldenGroup& group : golden.groups)
    for (const GoldenState& state : group.states)
      for (const auto& [key, numbers] : given(state.state))
        for (std::size_t k = 0; k < numbers.size(); ++k)
          out += fmt::format("{},{},given,{},{},1,{},,,\n", group.name, state.index, key, k + 1,
                             text(numbers[k]));
  forEach(golden, [&](const GoldenGroup& group, const GoldenState& state, const GoldenAnswer& one,
                      Eigen::Index i, Eigen::Index j) {
    out += fmt::format("{},{},wanted,{},{},{},{},{},{},{}\n", group.name, state.index,
                       name(one.quantity), i + 1, j + 1, text(one.value(i, j)), digitsOf(one, i, j),
                       text(one.radius(i, j)), text(one.limit(i, j)));
  });
  return out;
}

std::string goldenHeader(const Golden& golden, const std::string& version) {
  std::string id = "golden_";
  for (const char c : golden.scene.name)
    id += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '_';
  std::string out = "/*\n";
  for (const std::string& words : heading(golden, version)) out += " * " + words + "\n";
  out += fmt::format(
      " *\n * A limit below 0: none. Rows and columns are counted from 1.\n */\n"
      "#ifndef DYNWITNESS_GOLDEN_NUMBER\n#define DYNWITNESS_GOLDEN_NUMBER\n"
      "struct dynwitness_golden_number {{\n  const char *group;\n  int state;\n  const char "
      "*quantity;\n  int row, column;\n  double value;\n  const char *digits50;\n  double radius, "
      "limit;\n}};\n#endif\n\n");
  std::size_t states = 0, positions = 0, rates = 0;
  for (const GoldenGroup& group : golden.groups)
    for (const GoldenState& state : group.states) {
      ++states;
      positions = state.state.x.size();
      rates = state.state.qd.size();
    }
  long numbers = 0;
  std::string wanted;
  forEach(golden, [&](const GoldenGroup& group, const GoldenState& state, const GoldenAnswer& one,
                      Eigen::Index i, Eigen::Index j) {
    ++numbers;
    const double limit = one.limit(i, j);
    wanted += fmt::format("  {{\"{}\", {}, \"{}\", {}, {}, {}, \"{}\", {}, {}}},\n", group.name,
                          state.index, name(one.quantity), i + 1, j + 1, text(one.value(i, j)),
                          digitsOf(one, i, j), text(one.radius(i, j)),
                          std::isfinite(limit) ? text(limit) : "-1");
  });
  out += fmt::format(
      "enum {{ {0}_states = {1}, {0}_positions = {2}, {0}_rates = {3}, {0}_numbers = {4} }};\n", id,
      states, positions, rates, numbers);
  for (const char* key : {"q", "qd", "qdd", "tau"}) {
    out += fmt::format("static const double {0}_{1}[{0}_states][{0}_{2}] = {{\n", id, key,
                       std::string(key) == "q" ? "positions" : "rates");
    for (const GoldenGroup& group : golden.groups)
      for (const GoldenState& state : group.states)
        for (const auto& [of, values] : given(state.state)) {
          if (std::string(of) != key) continue;
          std::vector<std::string> row;
          for (const double x : values) row.push_back(text(x));
          out += fmt::format("  {{{}}},\n", fmt::join(row, ", "));
        }
    out += "};\n";
  }
  return out +
         fmt::format(
             "static const struct dynwitness_golden_number {0}_wanted[{0}_numbers] = "
             "{{\n",
             id) +
         wanted + "};\n";
}

}  // namespace dynwitness::crosscheck
