// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/show.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/report/ledger_report.hpp"
#include "crosscheck/report/text.hpp"
#include "scene/mimic.hpp"
#include "scene/numbers.hpp"
#include "scene/units.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;
using Numbers = scene::RealNumbers<double>;
using scene::JointKind;
using scene::SlotKind;

/// Rows of text; columns of numbers stand on the right.
struct Table {
  struct Column {
    std::string name;
    bool is_number = false;
  };
  std::string title;
  std::vector<Column> columns;
  std::vector<std::vector<std::string>> rows;
};

std::string textOf(const Table& table) {
  std::vector<int> widths;
  for (const Table::Column& column : table.columns) widths.push_back(codePoints(column.name));
  for (const auto& row : table.rows)
    for (std::size_t k = 0; k < row.size(); ++k)
      widths[k] = std::max(widths[k], codePoints(row[k]));
  std::string text = "\n" + table.title + "\n";
  const auto add = [&](const auto& cellOf) {
    std::string line;
    for (std::size_t k = 0; k < table.columns.size(); ++k) {
      const std::string& cell = cellOf(k);
      const std::string gap(static_cast<std::size_t>(widths[k] - codePoints(cell)), ' ');
      line += "  " + (table.columns[k].is_number ? gap + cell : cell + gap);
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  };
  add([&](std::size_t k) -> const std::string& { return table.columns[k].name; });
  for (const auto& row : table.rows)
    add([&](std::size_t k) -> const std::string& { return row[k]; });
  return text;
}

/// @param name  of the scene, whose text has the rows that a page leaves out
std::string htmlOf(const Table& table, const std::string& name) {
  constexpr std::size_t kMostRows = 200;
  std::string html = fmt::format(
      "<h2>{0}</h2>\n<div class=\"scroll\" role=\"region\" aria-label=\"{0}\" tabindex=\"0\">\n"
      "<table>\n<thead><tr>",
      escapeMarkup(table.title));
  const auto type = [&](std::size_t k) { return table.columns[k].is_number ? " class=\"n\"" : ""; };
  for (std::size_t k = 0; k < table.columns.size(); ++k)
    html +=
        fmt::format("<th scope=\"col\"{}>{}</th>", type(k), escapeMarkup(table.columns[k].name));
  html += "</tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < std::min(table.rows.size(), kMostRows); ++i) {
    const std::vector<std::string>& row = table.rows[i];
    html += fmt::format("<tr><th scope=\"row\"{}>{}</th>", type(0), escapeMarkup(row[0]));
    for (std::size_t k = 1; k < row.size(); ++k)
      html += fmt::format("<td{}>{}</td>", type(k), escapeMarkup(row[k]));
    html += "</tr>\n";
  }
  html += "</tbody>\n</table>\n</div>\n";
  if (table.rows.size() > kMostRows)
    html += fmt::format(
        "<p class=\"small\">{} of {} rows; all of them: <code>dynwitness show {}</code></p>\n",
        kMostRows, table.rows.size(), escapeMarkup(name));
  return html;
}

std::string number(double x) {
  return fmt::format("{:.6g}", x == 0 ? 0 : x);  // no -0
}

std::string joined(const std::vector<std::string>& words, const char* between = ", ") {
  return fmt::format("{}", fmt::join(words, between));
}

/// A joint in numbers.
struct JointFacts {
  const scene::Link* link = nullptr;
  const scene::UrdfPart::Limits* limits = nullptr;
  std::vector<int> q, qd;  ///< numbers of its columns in a states file, from 1; none of a follower
  std::vector<std::string> position_names, position_units, rate_names, rate_units;
  std::vector<double> start_q, start_qd;
  std::string leader;  ///< of a follower
  int leader_q = 0, leader_qd = 0;
  double multiplier = 1, offset = 0;
};

/// What there is to say, gathered once.
struct Facts {
  explicit Facts(const Shown& shown);

  const Shown& shown;
  Numbers value;
  View view;
  std::vector<JointFacts> joints;  ///< one a link; of the root, nothing
  std::vector<bool> moves;         ///< by link
  double moving_mass = 0, resting_mass = 0;
};

std::vector<std::string> namesOf(JointKind kind) {
  if (kind == JointKind::kSpherical) return {"w", "x", "y", "z"};
  if (kind == JointKind::kFloating) return {"px", "py", "pz", "w", "x", "y", "z"};
  return scene::rateNames(kind);
}

Facts::Facts(const Shown& of)
    : shown(of), value(of.scene.mechanism), view(viewOf(of.scene, of.parts)) {
  const scene::Mechanism& mechanism = shown.scene.mechanism;
  const std::vector<scene::Follower> followers = scene::followers(mechanism);
  auto follower = followers.begin();
  int q = 0, qd = 0;
  std::size_t slot = 0;
  std::vector<int> q_of_slot;
  for (std::size_t i = 0; i < mechanism.links.size(); ++i) {
    const scene::Link& link = mechanism.links[i];
    const JointKind kind = link.joint.kind;
    JointFacts joint;
    joint.link = &link;
    if (i < shown.parts.size() && shown.parts[i].limits) joint.limits = &*shown.parts[i].limits;
    const bool follows = follower != followers.end() && follower->link == static_cast<int>(i);
    joint.position_names = namesOf(kind);
    for (const SlotKind one : scene::positionSlots(kind)) {
      joint.position_units.emplace_back(scene::unitOf(one));
      joint.start_q.push_back(value(shown.scene.start_q[slot++]));
      if (!follows) joint.q.push_back(++q);
      q_of_slot.push_back(q);
    }
    joint.rate_names = scene::rateNames(kind);
    if (follows) {
      joint.leader = mechanism.links[static_cast<std::size_t>(follower->leader)].joint.name;
      joint.leader_qd = follower->rate + 1;
      joint.multiplier = value(scene::Number(follower->multiplier));
      joint.offset = value(follower->offset);
      ++follower;
    } else {
      for (std::size_t k = 0; k < joint.rate_names.size(); ++k) {
        joint.qd.push_back(++qd);
        joint.start_qd.push_back(value(shown.scene.start_qd[static_cast<std::size_t>(qd) - 1]));
      }
    }
    for (std::size_t k = 0; k < joint.rate_names.size(); ++k)
      joint.rate_units.emplace_back(scene::slides(kind, k) ? "m/s" : "rad/s");
    joints.push_back(std::move(joint));
    const bool moving = link.parent >= 0 &&
                        (kind != JointKind::kFixed || moves[static_cast<std::size_t>(link.parent)]);
    moves.push_back(moving);
    (moving ? moving_mass : resting_mass) += view.bodies[i].mass;
  }
  for (const scene::Follower& f : followers)
    joints[static_cast<std::size_t>(f.link)].leader_q =
        q_of_slot[static_cast<std::size_t>(f.leader_slot)];
}

/// "q3", "q1..q7", "= -1 q2 + 0.1"
std::string columnsOf(const std::vector<int>& numbers, const char* letter) {
  if (numbers.empty()) return "-";
  if (numbers.size() == 1) return fmt::format("{}{}", letter, numbers[0]);
  return fmt::format("{0}{1}..{0}{2}", letter, numbers.front(), numbers.back());
}

std::string valuesOf(const std::vector<double>& values) {
  std::vector<std::string> words;
  for (const double x : values) words.push_back(number(x));
  return words.empty() ? "-" : joined(words, " ");
}

std::string vectorText(const scene::Vector& v, const Numbers& value) {
  return valuesOf({value(v[0]), value(v[1]), value(v[2])});
}

/// Rotor, friction, spring and what else a joint has.
std::string remarksOn(const JointFacts& facts, const Numbers& value) {
  const scene::Joint& joint = facts.link->joint;
  std::vector<std::string> words;
  const bool slides = joint.kind == JointKind::kPrismatic;
  if (joint.kind == JointKind::kHelical)
    words.push_back(fmt::format("advances {} m/rad", number(value(joint.pitch))));
  if (!joint.rotor_inertia.isLiteralZero())
    words.push_back(
        fmt::format("{}rotor {} kg m^2 geared {}", joint.gyroscopic ? "gyroscopic " : "",
                    number(value(joint.rotor_inertia)), number(value(joint.gear_ratio))));
  for (const scene::Rotor& rotor : joint.rotors) {
    std::vector<double> ratio;
    for (const scene::Number& n : rotor.ratio) ratio.push_back(value(n));
    words.push_back(
        fmt::format("{}rotor {} kg m^2 geared ({}){}", rotor.axis ? "gyroscopic " : "",
                    number(value(rotor.inertia)), valuesOf(ratio),
                    rotor.axis ? " about (" + vectorText(*rotor.axis, value) + ")" : ""));
  }
  if (!joint.friction.viscous.isLiteralZero())
    words.push_back(fmt::format("viscous friction {} {}", number(value(joint.friction.viscous)),
                                slides ? "N s/m" : "N m s/rad"));
  if (joint.friction.isCoulomb()) {
    const double forward = value(joint.friction.positive), back = value(joint.friction.negative);
    words.push_back(fmt::format("Coulomb friction {}{} {}", number(forward),
                                forward == back ? "" : " (back " + number(back) + ")",
                                slides ? "N" : "N m"));
  }
  if (!joint.stiffness.isLiteralZero())
    words.push_back(fmt::format("spring {} {} from {}", number(value(joint.stiffness)),
                                slides ? "N/m" : "N m/rad", number(value(joint.rest))));
  for (const scene::Expression& motion : joint.motion)
    words.push_back("driven, q(t) = " + motion.text());
  if (!facts.leader.empty()) words.push_back("follows " + facts.leader);
  if (facts.limits) {
    const double effort = value(facts.limits->effort), velocity = value(facts.limits->velocity);
    if (effort != 0)
      words.push_back(fmt::format("effort to {} {}", number(effort), slides ? "N" : "N m"));
    if (velocity != 0)
      words.push_back(fmt::format("velocity to {} {}", number(velocity), slides ? "m/s" : "rad/s"));
  }
  return joined(words);
}

Table jointTable(const Facts& facts) {
  Table table{"Joints, in the order of q and qd",
              {{"q"},
               {"qd"},
               {"joint"},
               {"kind"},
               {"unit"},
               {"limits"},
               {"axis"},
               {"parent"},
               {"child"},
               {"start q", true},
               {"start qd", true},
               {"more"}},
              {}};
  const scene::Mechanism& mechanism = facts.shown.scene.mechanism;
  for (const JointFacts& joint : facts.joints) {
    const scene::Joint& j = joint.link->joint;
    if (joint.link->parent < 0 || j.kind == JointKind::kFixed) continue;
    const bool follows = !joint.leader.empty();
    const std::string ratio = follows ? number(joint.multiplier) : "";
    const auto limit = [&](const scene::Number& n) { return number(facts.value(n)); };
    table.rows.push_back(
        {follows ? fmt::format("= {} q{}{}", ratio, joint.leader_q,
                               joint.offset == 0 ? "" : fmt::format(" {:+.6g}", joint.offset))
                 : columnsOf(joint.q, "q"),
         follows ? fmt::format("= {} qd{}", ratio, joint.leader_qd) : columnsOf(joint.qd, "qd"),
         oneLine(j.name), scene::name(j.kind),
         j.kind == JointKind::kSpherical  ? "w x y z"
         : j.kind == JointKind::kFloating ? "m m m w x y z"
                                          : joined(joint.position_units, " "),
         joint.limits ? limit(joint.limits->lower) + " to " + limit(joint.limits->upper) : "-",
         scene::hasAxis(j.kind) ? vectorText(j.axis, facts.value) : "-",
         oneLine(mechanism.links[static_cast<std::size_t>(joint.link->parent)].name),
         oneLine(joint.link->name), valuesOf(joint.start_q), valuesOf(joint.start_qd),
         oneLine(remarksOn(joint, facts.value))});
  }
  return table;
}

Table linkTable(const Facts& facts) {
  Table table{"Links: centre of mass and inertia about it in the link's axes (kg, m, kg m^2)",
              {{"link"},
               {"mass", true},
               {"com", true},
               {"Ixx", true},
               {"Iyy", true},
               {"Izz", true},
               {"Ixy", true},
               {"Ixz", true},
               {"Iyz", true},
               {"carried by"}},
              {}};
  for (std::size_t i = 0; i < facts.joints.size(); ++i) {
    const scene::Link& link = *facts.joints[i].link;
    const ViewBody& body = facts.view.bodies[i];
    const Eigen::Matrix3d& I = body.inertia;
    // an inertia that was shifted or turned has rounding where it has zeros
    const double least = I.cwiseAbs().maxCoeff() * 64 * std::numeric_limits<double>::epsilon();
    const auto entry = [&](int j, int k) {
      return number(std::abs(I(j, k)) <= least ? 0 : I(j, k));
    };
    table.rows.push_back(
        {oneLine(link.name), number(body.mass),
         valuesOf({body.com.x(), body.com.y(), body.com.z()}), entry(0, 0), entry(1, 1),
         entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2),
         link.parent < 0 ? "at rest in the world"
         : link.joint.kind == JointKind::kFixed
             ? fmt::format("{} (fixed to {})", oneLine(link.joint.name),
                           oneLine(facts.view.links[static_cast<std::size_t>(link.parent)].name))
             : oneLine(link.joint.name)});
  }
  return table;
}

std::string plural(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

/// What acts beside the joints: a line each.
std::vector<std::string> modelled(const Facts& facts) {
  const scene::Mechanism& m = facts.shown.scene.mechanism;
  const Numbers& value = facts.value;
  const auto link = [&](int i) { return oneLine(m.links[static_cast<std::size_t>(i)].name); };
  const auto ends = [&](const scene::Attachment& a, const scene::Attachment& b) {
    return fmt::format("{} at {} m and {} at {} m", link(a.link), vectorText(a.xyz, value),
                       link(b.link), vectorText(b.xyz, value));
  };
  const auto named = [](const std::string& what, const std::string& name) {
    return oneLine(name.empty() ? what : what + " " + name);
  };
  std::vector<std::string> lines;
  for (const scene::Closure& closure : m.closures) {
    std::string line = fmt::format(
        "{} ({}, {}): {}", named("closure", closure.name), scene::name(closure.kind),
        plural(static_cast<std::size_t>(scene::equationCount(closure.kind)), "equation"),
        ends(closure.a, closure.b));
    if (closure.kind == scene::ClosureKind::kDistance)
      line += fmt::format(", {} m apart", number(value(closure.length)));
    if (closure.kind == scene::ClosureKind::kRolling)
      line += fmt::format(", radius {} m", number(value(closure.length)));
    lines.push_back(line);
  }
  for (const scene::Spring& spring : m.springs)
    lines.push_back(fmt::format("{}: {} N/m from {} m, damping {} N s/m; {}",
                                named("spring", spring.name), number(value(spring.stiffness)),
                                number(value(spring.rest)), number(value(spring.damping)),
                                ends(spring.a, spring.b)));
  for (const scene::Wrench& wrench : m.wrenches)
    lines.push_back(fmt::format("load on {}: force {} N at {} m, moment {} N m, in {} axes",
                                link(wrench.link), vectorText(wrench.force, value),
                                vectorText(wrench.at, value), vectorText(wrench.moment, value),
                                wrench.axes == scene::Wrench::Axes::kLink ? "link" : "world"));
  for (const scene::AccelerationConstraint& c : m.acceleration_constraints)
    lines.push_back(fmt::format(
        "{} on {} at {} m: direction {}, rotation {} in {} axes, value {}, compliance {}",
        named("acceleration constraint", c.name), link(c.link), vectorText(c.at, value),
        vectorText(c.direction, value), vectorText(c.rotation, value),
        c.axes == scene::AccelerationConstraint::Axes::kLink ? "link" : "world",
        number(value(c.value)), number(value(c.compliance))));
  return lines;
}

/// How orientations and rates of joints with quaternions are to be read.
std::vector<std::string> notes(const Facts& facts) {
  std::vector<std::string> lines;
  for (const JointFacts& joint : facts.joints) {
    if (scene::ratesArePositionDerivatives(joint.link->joint.kind)) continue;
    const std::size_t n = joint.q.size();
    const bool floats = joint.link->joint.kind == JointKind::kFloating;
    lines.push_back(fmt::format(
        "{}: {}quaternion q{} (w, x, y, z) of any length but 0; {}angular velocity {}, in the "
        "link's own axes",
        oneLine(joint.link->joint.name),
        floats ? fmt::format("position q{}..q{}, ", joint.q[0], joint.q[2]) : "",
        fmt::format("{}..q{}", joint.q[n - 4], joint.q[n - 1]),
        floats ? fmt::format("velocity of its origin qd{}..qd{}, ", joint.qd[0], joint.qd[2]) : "",
        fmt::format("qd{}..qd{}", joint.qd[joint.qd.size() - 3], joint.qd.back())));
  }
  return lines;
}

constexpr const char* kLedger = "Ledger: what the equations of motion of its tree take";
const char* refusedBy(const Shown& shown) {
  return shown.has_no_inverse ? "Refused by what takes the inverse of M (qdd, simulate, ...)"
                              : "Other commands refuse it";
}

constexpr const char* kNever = "contact, limits of joints and actuators are no part of any scene";

std::string sizeText(const Facts& facts) {
  const scene::Mechanism& m = facts.shown.scene.mechanism;
  const auto moving =
      static_cast<std::size_t>(std::count(facts.moves.begin(), facts.moves.end(), true));
  return fmt::format(
      "{}, {}; {}, {} of them moving",
      m.dof() == 1 ? "1 degree of freedom" : fmt::format("{} degrees of freedom", m.dof()),
      plural(scene::givenSlots(m).size(), "position"), plural(m.links.size(), "link"), moving);
}
std::string massText(const Facts& facts) {
  return fmt::format("{} kg in all: {} kg moves, {} kg rests",
                     number(facts.moving_mass + facts.resting_mass), number(facts.moving_mass),
                     number(facts.resting_mass));
}
std::string gravityText(const Facts& facts) {
  const scene::Mechanism& m = facts.shown.scene.mechanism;
  return m.has_gravity ? vectorText(m.gravity, facts.value) + " m/s^2" : "none";
}

}  // namespace

std::string showText(const Shown& shown) {
  const Facts facts(shown);
  const scene::Scene& scene = shown.scene;
  std::string text = fmt::format("{}: {}\n", oneLine(scene.name), oneLine(scene.title));
  if (!scene.source.empty()) text += fmt::format("source   {}\n", oneLine(scene.source));
  text += fmt::format("size     {}\nmass     {}\ngravity  {}\n", sizeText(facts), massText(facts),
                      gravityText(facts));
  const Table joints = jointTable(facts);
  text += joints.rows.empty() ? "\nNo joint moves\n" : textOf(joints);
  for (const std::string& line : notes(facts)) text += "  " + line + "\n";
  text += textOf(linkTable(facts));
  if (const std::vector<std::string> lines = modelled(facts); !lines.empty()) {
    text += "\nModelled besides\n";
    for (const std::string& line : lines) text += "  " + line + "\n";
  }
  text += "\nNot modelled\n";
  for (const std::string& line : scene.not_modelled) text += "  " + oneLine(line) + "\n";
  text += fmt::format("  {}\n", kNever);
  if (!shown.remarks.empty()) {
    text += "\nRemarks\n";
    for (const std::string& line : shown.remarks) text += "  " + oneLine(line) + "\n";
  }
  if (shown.ledger) text += fmt::format("\n{}\n{}", kLedger, ledgerText(*shown.ledger));
  if (!shown.warnings.empty()) {
    text += fmt::format("\n{}\n", refusedBy(shown));
    for (const std::string& line : shown.warnings) text += "  " + oneLine(line) + "\n";
  }
  return text;
}

std::string jointsHtml(const scene::Scene& scene) {
  const Shown shown{scene};
  const Facts facts(shown);
  const Table joints = jointTable(facts);
  return joints.rows.empty() ? std::string() : htmlOf(joints, scene.name);
}

std::vector<std::vector<std::string>> jointCells(const scene::Scene& scene,
                                                 const std::vector<std::string>& columns) {
  const Shown shown{scene};
  const Facts facts(shown);
  const Table joints = jointTable(facts);
  std::vector<std::vector<std::string>> cells(joints.rows.size());
  for (const std::string& name : columns) {
    const auto column = std::find_if(joints.columns.begin(), joints.columns.end(),
                                     [&](const Table::Column& c) { return c.name == name; });
    if (column == joints.columns.end()) throw std::logic_error("jointCells: no column " + name);
    const std::ptrdiff_t k = column - joints.columns.begin();
    for (std::size_t i = 0; i < cells.size(); ++i)
      cells[i].push_back(*(joints.rows[i].begin() + k));
  }
  return cells;
}

std::string jointsText(const scene::Scene& scene) {
  const std::vector<std::string> columns = {"q",    "joint",  "kind", "unit",
                                            "axis", "parent", "child"};
  Table table{"Joints, in the order of q", {}, {}};
  for (const std::string& name : columns) table.columns.push_back({name});
  for (const std::vector<std::string>& cells : jointCells(scene, columns))
    table.rows.push_back(cells);
  return table.rows.empty() ? std::string() : textOf(table);
}

std::string showPage(const Shown& shown, const View& view, const std::string& version) {
  const Facts facts(shown);
  const scene::Scene& scene = shown.scene;
  std::string summary =
      fmt::format("<p class=\"soft\"><code>{}</code>: {}; {}; gravity {}</p>\n",
                  escapeMarkup(scene.name), sizeText(facts), massText(facts), gravityText(facts));
  if (!scene.source.empty())
    summary += fmt::format("<p class=\"small\">Source: {}</p>\n", escapeMarkup(scene.source));
  const auto list = [](const std::string& title, const std::vector<std::string>& lines) {
    if (lines.empty()) return std::string();
    std::string html = title.empty() ? "<ul>\n" : "<h2>" + title + "</h2>\n<ul>\n";
    for (const std::string& line : lines) html += "<li>" + escapeMarkup(line) + "</li>\n";
    return html + "</ul>\n";
  };
  std::string body = list(refusedBy(shown), shown.warnings);
  if (const Table joints = jointTable(facts); !joints.rows.empty())
    body += htmlOf(joints, scene.name);
  body += list("", notes(facts)) + htmlOf(linkTable(facts), scene.name);
  body += list("Modelled besides", modelled(facts));
  std::vector<std::string> left_out = scene.not_modelled;
  left_out.emplace_back(kNever);
  body += list("Not modelled", left_out);
  body += list("Remarks", shown.remarks);
  if (shown.ledger) body += fmt::format("<h2>{}</h2>\n{}", kLedger, ledgerHtml(*shown.ledger));
  return viewPage(view, version, summary, body);
}

std::string showJson(const Shown& shown, const std::string& version) {
  const Facts facts(shown);
  const scene::Scene& scene = shown.scene;
  const scene::Mechanism& m = scene.mechanism;
  const Numbers& value = facts.value;
  const auto vector = [&](const scene::Vector& v) {
    return Json::array({value(v[0]), value(v[1]), value(v[2])});
  };
  const auto columns = [](const std::vector<int>& numbers, const char* letter) {
    Json names = Json::array();
    for (const int n : numbers) names.push_back(fmt::format("{}{}", letter, n));
    return names;
  };
  const auto link = [&](int i) { return oneLine(m.links[static_cast<std::size_t>(i)].name); };
  Json json{{"dynwitness", cleanText(version)},
            {"scene", oneLine(scene.name)},
            {"title", oneLine(scene.title)},
            {"source", oneLine(scene.source)},
            {"degrees_of_freedom", m.dof()},
            {"positions", scene::givenSlots(m).size()},
            {"mass_kg", {{"moving", facts.moving_mass}, {"resting", facts.resting_mass}}},
            {"gravity", m.has_gravity ? vector(m.gravity) : Json()}};
  Json& joints = json["joints"] = Json::array();
  for (const JointFacts& joint : facts.joints) {
    if (joint.link->parent < 0) continue;
    const scene::Joint& j = joint.link->joint;
    Json rotors = Json::array();
    for (const scene::Rotor& rotor : j.rotors) {
      rotors.push_back({{"inertia", value(rotor.inertia)},
                        {"ratio", Json::array()},
                        {"axis", rotor.axis ? vector(*rotor.axis) : Json()}});
      for (const scene::Number& n : rotor.ratio) rotors.back()["ratio"].push_back(value(n));
    }
    Json motion = Json::array();
    for (const scene::Expression& e : j.motion) motion.push_back(e.text());
    joints.push_back({{"name", oneLine(j.name)},
                      {"kind", scene::name(j.kind)},
                      {"parent", link(joint.link->parent)},
                      {"child", oneLine(joint.link->name)},
                      {"q", columns(joint.q, "q")},
                      {"qd", columns(joint.qd, "qd")},
                      {"position_names", joint.position_names},
                      {"position_units", joint.position_units},
                      {"rate_names", joint.rate_names},
                      {"rate_units", joint.rate_units},
                      {"start_q", joint.start_q},
                      {"start_qd", joint.start_qd},
                      {"axis", scene::hasAxis(j.kind) ? vector(j.axis) : Json()},
                      {"pitch", value(j.pitch)},
                      {"limits", joint.limits ? Json{{"lower", value(joint.limits->lower)},
                                                     {"upper", value(joint.limits->upper)},
                                                     {"effort", value(joint.limits->effort)},
                                                     {"velocity", value(joint.limits->velocity)}}
                                              : Json()},
                      {"follows", joint.leader.empty() ? Json()
                                                       : Json{{"joint", oneLine(joint.leader)},
                                                              {"multiplier", joint.multiplier},
                                                              {"offset", joint.offset}}},
                      {"motion", motion},
                      {"rotor",
                       {{"inertia", value(j.rotor_inertia)},
                        {"gear_ratio", value(j.gear_ratio)},
                        {"gyroscopic", j.gyroscopic}}},
                      {"rotors", rotors},
                      {"friction",
                       {{"viscous", value(j.friction.viscous)},
                        {"positive", value(j.friction.positive)},
                        {"negative", value(j.friction.negative)}}},
                      {"spring", {{"stiffness", value(j.stiffness)}, {"rest", value(j.rest)}}}});
  }
  Json& links = json["links"] = Json::array();
  for (std::size_t i = 0; i < m.links.size(); ++i) {
    const ViewBody& body = facts.view.bodies[i];
    const Eigen::Matrix3d& I = body.inertia;
    links.push_back({{"name", oneLine(m.links[i].name)},
                     {"parent", m.links[i].parent < 0 ? Json() : Json(link(m.links[i].parent))},
                     {"moves", static_cast<bool>(facts.moves[i])},
                     {"mass", body.mass},
                     {"com", {body.com.x(), body.com.y(), body.com.z()}},
                     {"inertia",
                      {{"xx", I(0, 0)},
                       {"yy", I(1, 1)},
                       {"zz", I(2, 2)},
                       {"xy", I(0, 1)},
                       {"xz", I(0, 2)},
                       {"yz", I(1, 2)}}}});
  }
  json["modelled_besides"] = modelled(facts);
  Json left_out = Json::array();
  for (const std::string& line : scene.not_modelled) left_out.push_back(oneLine(line));
  json["not_modelled"] = left_out;
  json["ledger"] = shown.ledger ? ledgerJson(*shown.ledger) : Json();
  json["remarks"] = shown.remarks;
  json["warnings"] = shown.warnings;
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace dynwitness::crosscheck
