// SPDX-License-Identifier: GPL-3.0-or-later
// How many steps a recursion over links takes: swept, written out anew, or with equal subtrees
// shared.
#pragma once

#include <algorithm>
#include <map>
#include <vector>

#include "recursive/model.hpp"

namespace dynwitness::crosscheck {

/** Which links carry equal subtrees: links of the same inertia that carry, by joints of the same
    kind in the same places, equal subtrees. The tree is then a directed acyclic graph with fewer
    nodes. */
struct SharedSubtrees {
  std::vector<int> of_link;         ///< node of each link; links without others have the first ones
  std::vector<int> representative;  ///< a link of each node
  int count() const { return static_cast<int>(representative.size()); }
};

/// @param model  its numbers are compared as doubles: what a scene writes the same is the same
inline SharedSubtrees sharedSubtrees(const recursive::Model<double>& model) {
  const int n = static_cast<int>(model.links.size());
  SharedSubtrees out;
  out.of_link.assign(n, -1);
  std::vector<std::vector<std::vector<double>>> children(n);
  std::map<std::vector<double>, int> nodes;
  for (int i = n - 1; i >= 0; --i) {
    const recursive::LinkModel<double>& link = model.links[i];
    const auto& [mass, h, I] = link.M;
    std::vector<double> key = {mass, h.x(), h.y(), h.z(), I.xx, I.yy, I.zz, I.xy, I.xz, I.yz};
    std::sort(children[i].begin(), children[i].end());
    for (const std::vector<double>& child : children[i])
      key.insert(key.end(), child.begin(), child.end());
    const auto [it, is_new] = nodes.emplace(key, out.count());
    if (is_new) out.representative.push_back(i);
    out.of_link[i] = it->second;
    if (link.parent < 0) continue;
    std::vector<double> way = {
        static_cast<double>(link.kind), link.rotor, link.pitch, link.stiffness, link.rest,
        static_cast<double>(it->second)};
    way.insert(way.end(), link.X_tree.p.begin(), link.X_tree.p.end());
    for (const double r : link.X_tree.R.reshaped()) way.push_back(r);
    children[link.parent].push_back(way);
  }
  return out;
}

/** Steps that articulated inertias of all links take; a step is one link's own inertia and the
    projection through one joint. */
struct RecursionSteps {
  int swept = 0;   ///< each subtree's value kept: one a link
  long anew = 0;   ///< the recursion run for each link by itself: one for each link of its subtree
  int shared = 0;  ///< equal subtrees once, where they are in equal poses
};
inline RecursionSteps recursionSteps(const recursive::Model<double>& model) {
  RecursionSteps out;
  out.swept = static_cast<int>(model.links.size());
  for (int i = 0; i < out.swept; ++i)
    for (int k = i; k >= 0; k = model.links[k].parent) ++out.anew;
  out.shared = sharedSubtrees(model).count();
  return out;
}

/** Articulated inertias of all nodes, one step each, in a pose in which equal subtrees are in equal
    poses.
    @return M_A of links.of_link[i] is that of link i */
template <typename T>
std::vector<recursive::ArticulatedInertia<T>> articulatedInertias(
    const recursive::Model<T>& model, const SharedSubtrees& subtrees,
    const std::vector<scene::JointPosition<T>>& x) {
  using namespace recursive;
  std::vector<ArticulatedInertia<T>> M_A;
  for (const int i : subtrees.representative)  // children come before their parents
    M_A.push_back(ArticulatedInertia<T>::fromRigid(model.links[i].M));
  for (int node = 0; node < subtrees.count(); ++node) {
    for (std::size_t j = 0; j < model.links.size(); ++j) {
      const LinkModel<T>& child = model.links[j];
      if (child.parent != subtrees.representative[node]) continue;
      ArticulatedInertia<T> M = M_A[subtrees.of_link[j]];
      for (int k = 0; k < AnyJoints::axes(child); ++k) {
        const Force<T> U = AnyJoints::column(child, k, M);
        M = M.minusOuter(U, T(1) / (child.rotor + AnyJoints::force(child, k, U)));
      }
      M_A[node] = M_A[node] + AnyJoints::transform(child, x).inverseTimes(M);
    }
  }
  return M_A;
}

}  // namespace dynwitness::crosscheck
