// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/engine_introduction.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "crosscheck/witnesses/engine_greeting.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"

namespace dynwitness::crosscheck::engine {
namespace {

std::vector<ToldLink> toldLinks(const Json& said) {
  if (!said.is_array()) expected(kModel, "a list of links", said);
  std::vector<ToldLink> out;
  for (const Json& one : said) {
    const std::string where = fmt::format("link {} of {}", out.size() + 1, kModel);
    if (!one.is_object() || !one.contains("link") || !one.at("link").is_string())
      expected(where, "the name of a link, mass, com and inertia", one);
    ToldLink told;
    told.name = one.at("link").get<std::string>();
    told.link.mass = number(one, "mass", where);
    told.link.com = three(one.contains("com") ? one.at("com") : Json("none"), where + " com");
    const Json rows = one.contains("inertia") ? one.at("inertia") : Json("none");
    if (!rows.is_array() || rows.size() != 3)
      expected(where + " inertia", "three rows of three numbers", rows);
    for (int i = 0; i < 3; ++i)
      told.link.inertia.row(i) =
          three(rows[static_cast<std::size_t>(i)], where + " inertia").transpose();
    out.push_back(told);
  }
  return out;
}

}  // namespace

std::vector<BelievedLink> believedLinks(const std::vector<ToldLink>& told,
                                        const scene::Mechanism& mechanism) {
  std::vector<std::string> names;
  for (const scene::Link& link : mechanism.links) names.push_back(link.name);
  std::vector<BelievedLink> out;
  for (const ToldLink& one : told) {
    const auto at = std::find(names.begin(), names.end(), one.name);
    if (at == names.end())
      expected(kModel, "names of links of the scene, " + listed(names), one.name);
    out.push_back(one.link);
    out.back().link = static_cast<int>(at - names.begin());
    if (std::count_if(out.begin(), out.end(),
                      [&](const BelievedLink& b) { return b.link == out.back().link; }) > 1)
      expected(kModel, "each link once", one.name);
  }
  return out;
}

Introduction::Introduction(const Json& said) {
  const auto version_at = said.find("protocol");
  if (version_at == said.end() || *version_at != kEngineProtocol)
    expected("protocol", fmt::format("version {}", kEngineProtocol),
             version_at == said.end() ? Json("none") : *version_at);
  name = plain(textOr(said, "name", ""));
  version = plain(textOr(said, "version", ""));
  refuses = plain(textOr(said, "refuses", ""));
  if (said.contains("refuses")) {
    if (refuses.empty()) refuses = "no, and not why";
    return;
  }
  if (!said.contains("quantities")) expected("quantities", "a list of names", "none");
  quantities = words(said, "quantities");
  if (said.contains("joints")) joints = words(said, "joints");
  const std::string quaternion = textOr(said, "quaternion", "wxyz"),
                    rates = textOr(said, "rates", "link");
  wxyz = quaternion == "wxyz";
  if (!wxyz && quaternion != "xyzw") expected("quaternion", "\"wxyz\" or \"xyzw\"", quaternion);
  if (rates != "link")
    expected("rates", "\"link\" (of spherical and floating joints, in the link's axes)", rates);
  const std::vector<std::string> allowed = askable();
  for (const std::string& quantity : quantities)
    if (std::find(allowed.begin(), allowed.end(), quantity) == allowed.end())
      expected("quantities", "names among " + listed(allowed), quantity);
  if (said.contains(kModel)) model = toldLinks(said.at(kModel));
  if (quantities.empty() && !model)
    expected("quantities", "at least one of " + listed(allowed), Json::array());
}

Order::Order(const scene::Mechanism& mechanism, const Introduction& engine) {
  struct Place {
    int q, qd, link;
  };
  std::map<std::string, Place> places;
  std::vector<std::string> ours;
  int q = 0, qd = 0;
  for (const int i : mechanism.movingLinks()) {
    const scene::Joint& joint = mechanism.links[i].joint;
    places[joint.name] = {q, qd, i};
    ours.push_back(joint.name);
    q += static_cast<int>(scene::positionSlots(joint.kind).size());
    qd += scene::degreesOfFreedom(joint.kind);
  }
  std::vector<std::string> theirs = engine.joints.empty() ? ours : engine.joints, sorted = theirs;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::string> all = ours;
  std::sort(all.begin(), all.end());
  if (sorted != all) expected("joints", "all of " + listed(ours) + ", in any order", theirs);
  is_ours = theirs == ours;
  for (const std::string& name : theirs) {
    const Place& place = places.at(name);
    const scene::JointKind kind = mechanism.links[place.link].joint.kind;
    const std::vector<scene::SlotKind>& slots = scene::positionSlots(kind);
    const int count = static_cast<int>(slots.size());
    for (int k = 0; k < count; ++k) {
      int from = k;
      if (slots[k] == scene::SlotKind::kQuaternion && !engine.wxyz)
        from = k + 1 < count ? k + 1 : count - 4;  // x, y, z, w of w, x, y, z
      positions.push_back(place.q + from);
    }
    for (int k = 0; k < scene::degreesOfFreedom(kind); ++k) rates.push_back(place.qd + k);
  }
}

}  // namespace dynwitness::crosscheck::engine
