// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/arrange.hpp"

#include <functional>
#include <map>
#include <queue>

namespace dynwitness::scene {
namespace {

/// The names on the cycle that one meets by going from a link to its parent, again and again.
std::string cycleAbove(std::size_t start, const std::vector<NamedLink>& links,
                       const std::vector<int>& parents) {
  std::vector<bool> seen(links.size(), false);
  std::size_t i = start;
  for (; !seen[i]; i = static_cast<std::size_t>(parents[i])) seen[i] = true;
  constexpr int kMostNames = 10;
  int count = 1;
  std::string names = '"' + links[i].link.name + '"';
  for (auto j = static_cast<std::size_t>(parents[i]); j != i;
       j = static_cast<std::size_t>(parents[j]), ++count) {
    if (count < kMostNames) names += ", child of \"" + links[j].link.name + '"';
  }
  if (count > kMostNames) names += ", and so on through " + std::to_string(count) + " links";
  return names + ", child of \"" + links[i].link.name + '"';
}

std::size_t findRoot(const std::vector<NamedLink>& links, const std::vector<int>& parents,
                     const std::string& file) {
  std::optional<std::size_t> root;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (parents[i] >= 0) continue;
    if (root) {
      const Link& first = links[*root].link;
      throw InputError(links[i].link.where, "link \"" + links[i].link.name +
                                                "\": has no parent, but neither has link \"" +
                                                first.name + "\" (" + first.where.text() +
                                                "), allowed: one root");
    }
    root = i;
  }
  if (root) return *root;
  if (links.empty()) throw InputError({file, 0}, "no root: there is no link at all");
  throw InputError(links.front().link.where, "no root: every link has a parent (" +
                                                 cycleAbove(0, links, parents) +
                                                 "), allowed: one link without a parent");
}

}  // namespace

void requireUniqueNames(const std::vector<Link>& links) {
  std::map<std::string, const Link*> by_link, by_joint;
  for (const Link& link : links) {
    if (link.name.empty()) throw InputError(link.where, "a link has an empty name");
    const auto [other, is_new] = by_link.emplace(link.name, &link);
    if (!is_new) {
      throw InputError(link.where, "link \"" + link.name + "\": the name is taken by the link of " +
                                       other->second->where.text());
    }
  }
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Link& link = links[i];
    if (link.joint.name.empty()) continue;  // the root, which no joint carries
    const auto [other, is_new] = by_joint.emplace(link.joint.name, &link);
    if (!is_new) {
      throw InputError(link.where, "joint \"" + link.joint.name + "\" of link \"" + link.name +
                                       "\": the name is taken by the joint of link \"" +
                                       other->second->name + "\" (" + other->second->where.text() +
                                       ")");
    }
  }
}

std::vector<Link> arrange(const std::vector<NamedLink>& links, const std::string& file) {
  std::vector<Link> in_file_order;
  in_file_order.reserve(links.size());
  for (const NamedLink& named : links) in_file_order.push_back(named.link);
  requireUniqueNames(in_file_order);

  std::map<std::string, int> index;
  for (std::size_t i = 0; i < links.size(); ++i) index[links[i].link.name] = static_cast<int>(i);
  std::vector<int> parents(links.size(), -1);
  std::vector<std::vector<int>> children(links.size());
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (!links[i].parent) continue;
    const auto found = index.find(*links[i].parent);
    if (found == index.end()) {
      throw InputError(links[i].parent_where, "link \"" + links[i].link.name + "\": parent \"" +
                                                  *links[i].parent + "\" is not a link");
    }
    parents[i] = found->second;
    children[static_cast<std::size_t>(found->second)].push_back(static_cast<int>(i));
  }

  std::vector<Link> tree;
  std::vector<int> place(links.size(), -1);
  std::priority_queue<int, std::vector<int>, std::greater<>> ready;  // the first of the file on top
  ready.push(static_cast<int>(findRoot(links, parents, file)));
  while (!ready.empty()) {
    const auto i = static_cast<std::size_t>(ready.top());
    ready.pop();
    place[i] = static_cast<int>(tree.size());
    tree.push_back(in_file_order[i]);
    tree.back().parent = parents[i] < 0 ? -1 : place[static_cast<std::size_t>(parents[i])];
    for (const int child : children[i]) ready.push(child);
  }
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (place[i] >= 0) continue;
    throw InputError(links[i].link.where,
                     "cycle of links: " + cycleAbove(i, links, parents) + ", allowed: a tree");
  }
  return tree;
}

}  // namespace dynwitness::scene
