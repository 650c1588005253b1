// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mimic.hpp"

#include <map>

namespace dynwitness::scene {
namespace {

[[noreturn]] void fail(const Link& link, const std::string& what) {
  throw InputError(link.where, "joint \"" + link.joint.name + "\" of link \"" + link.name +
                                   "\": mimic: " + what);
}

void requireOnePosition(const Link& link, const Joint& joint, const std::string& who) {
  if (positionSlots(joint.kind).size() != 1 || !ratesArePositionDerivatives(joint.kind))
    fail(link, who + " is " + name(joint.kind) +
                   ", allowed: revolute, prismatic and helical joints, which "
                   "have one position");
  if (!joint.motion.empty())
    fail(link, who + " is driven by a motion, allowed: joints that are not");
}

Rational multiplierOf(const Link& link) {
  const Number& written = link.joint.mimic->multiplier;
  if (!written.parameters().empty())
    fail(link, "multiplier is " + written.text() + ", allowed: a number without parameters");
  const Exact exact = exactValue(written, {}, link.where);
  if (!exact.isRational())
    fail(link, "multiplier is " + written.text() + ", allowed: a number without pi");
  if (exact.isZero())
    fail(link,
         "multiplier is 0, which holds the joint, allowed: any other number, or a fixed joint");
  return exact.rational;
}

/// multiplier q + offset, as short as it can be written.
Number followed(const Rational& multiplier, const Number& q, const Number& offset) {
  std::string text;
  if (!q.isLiteralZero() && !(q.kind() == Number::Kind::kNegate && q.left().isLiteralZero()))
    text = multiplier == 1 ? q.text() : "(" + multiplier.str() + ")*(" + q.text() + ")";
  if (!offset.isLiteralZero()) text += (text.empty() ? "" : " + ") + offset.text();
  return text.empty() ? Number(0) : Number::parse(text);
}

std::vector<int> slotsOfLinks(const Mechanism& mechanism) {
  std::vector<int> first;
  std::size_t slots = 0;
  for (const Link& link : mechanism.links) {
    first.push_back(static_cast<int>(slots));
    slots += positionSlots(link.joint.kind).size();
  }
  return first;
}

}  // namespace

std::vector<Follower> followers(const Mechanism& mechanism) {
  std::vector<Follower> all;
  if (!mechanism.hasMimics()) return all;
  const std::vector<Link>& links = mechanism.links;
  std::map<std::string, int> link_of_joint;
  for (std::size_t i = 1; i < links.size(); ++i)
    link_of_joint[links[i].joint.name] = static_cast<int>(i);
  std::vector<int> rates;  // by link, of leaders
  int count = 0;
  for (const Link& link : links) {
    rates.push_back(count);
    count += link.joint.ownRates();
  }
  const std::vector<int> slots = slotsOfLinks(mechanism);
  // resolved[i]: of a follower that is done, its place in `all`
  std::vector<int> resolved(links.size(), -1), on_way(links.size(), -1);
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (!links[i].joint.mimic || resolved[i] >= 0) continue;
    std::vector<int> way = {static_cast<int>(i)};  // to the first joint that is known
    const int start = way[0];
    on_way[i] = start;
    int head = -1;
    while (head < 0) {
      const Link& link = links[way.back()];
      requireOnePosition(link, link.joint, "the joint");
      const auto found = link_of_joint.find(link.joint.mimic->joint);
      if (found == link_of_joint.end())
        fail(link, "there is no joint \"" + link.joint.mimic->joint +
                       "\", allowed: the name of another joint");
      const Link& leader = links[found->second];
      if (on_way[found->second] == start)
        fail(link, "follows \"" + leader.joint.name +
                       "\", which follows it, allowed: a chain with an end");
      requireOnePosition(link, leader.joint, "the leader \"" + leader.joint.name + "\"");
      if (!leader.joint.mimic || resolved[found->second] >= 0)
        head = found->second;
      else {
        way.push_back(found->second);
        on_way[found->second] = start;
      }
    }
    for (; !way.empty(); way.pop_back()) {
      const int link = way.back();
      const Mimic& mimic = *links[link].joint.mimic;
      Follower f{link,        head,        slots[link],
                 slots[head], rates[head], multiplierOf(links[link]),
                 mimic.offset};
      if (resolved[head] >= 0) {
        const Follower& before = all[resolved[head]];
        f.offset = followed(f.multiplier, before.offset, f.offset);
        f.multiplier *= before.multiplier;
        f.leader = before.leader;
        f.leader_slot = before.leader_slot;
        f.rate = before.rate;
      }
      resolved[link] = static_cast<int>(all.size());
      all.push_back(f);
      head = link;
    }
  }
  std::vector<Follower> in_order;
  for (const int place : resolved)
    if (place >= 0) in_order.push_back(all[place]);
  return in_order;
}

std::vector<int> firstRates(const Mechanism& mechanism) {
  std::vector<int> first;
  int count = 0;
  for (const Link& link : mechanism.links) {
    first.push_back(degreesOfFreedom(link.joint.kind) > 0 ? count : -1);
    count += link.joint.ownRates();
  }
  for (const Follower& f : followers(mechanism)) first[f.link] = f.rate;
  return first;
}

std::vector<int> givenSlots(const Mechanism& mechanism) {
  std::vector<int> given;
  int slot = 0;
  for (const Link& link : mechanism.links)
    for (std::size_t k = 0; k < positionSlots(link.joint.kind).size(); ++k, ++slot)
      if (!link.joint.mimic) given.push_back(slot);
  return given;
}

Mechanism withoutMimics(Mechanism mechanism) {
  for (Link& link : mechanism.links) link.joint.mimic.reset();
  return mechanism;
}

Mechanism withoutGearedRotors(Mechanism mechanism) {
  for (Link& link : mechanism.links) link.joint.rotors.clear();
  return mechanism;
}

void requireNoMimics(const SourceLocation& file, const Mechanism& mechanism,
                     const std::string& why) {
  for (const Link& link : mechanism.links)
    if (link.joint.mimic)
      throw InputError(file, "joint \"" + link.joint.name + "\" follows \"" +
                                 link.joint.mimic->joint + "\" (mimic): " + why +
                                 ", allowed: joints that follow no others");
}

void followLeaders(const std::vector<Follower>& followers, std::vector<Number>* q) {
  for (const Follower& f : followers)
    (*q)[f.slot] = followed(f.multiplier, (*q)[f.leader_slot], f.offset);
}

void followLeaders(const Mechanism& mechanism, std::vector<JointPosition<double>>* x) {
  if (!mechanism.hasMimics()) return;
  const RealNumbers<double> number(mechanism);
  for (const Follower& f : followers(mechanism))
    (*x)[f.slot] =
        jointPosition(number(Number(f.multiplier)) * (*x)[f.leader_slot].q + number(f.offset));
}

std::vector<double> allPositions(const Mechanism& mechanism, const std::vector<double>& q) {
  if (!mechanism.hasMimics()) return q;
  const std::vector<int> given = givenSlots(mechanism);
  std::vector<double> all = q;
  if (q.size() == given.size()) {
    all.assign(mechanism.positions(), 0.0);
    for (std::size_t k = 0; k < given.size(); ++k) all[given[k]] = q[k];
  }
  if (static_cast<int>(all.size()) == mechanism.positions())
    followLeaders(followers(mechanism), RealNumbers<double>(mechanism), &all);
  return all;
}

}  // namespace dynwitness::scene
