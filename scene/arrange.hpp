// SPDX-License-Identifier: GPL-3.0-or-later
// From links that name their parents, as files have them, to a tree. For the readers of scene/.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/mechanism.hpp"

namespace dynwitness::scene {

/// A link as read: its parent by name (none: the root), and where that name stands.
struct NamedLink {
  Link link;
  std::optional<std::string> parent;
  SourceLocation parent_where;
};

/** The links as a tree in topological order: each place goes to the first link of the file whose
    parent has its place already.
    @throws InputError on names used twice, an unknown parent, a cycle, no root or two. */
std::vector<Link> arrange(const std::vector<NamedLink>& links, const std::string& file);

/// @throws InputError when two links, or two joints, have the same name or a name is empty.
void requireUniqueNames(const std::vector<Link>& links);

}  // namespace dynwitness::scene
