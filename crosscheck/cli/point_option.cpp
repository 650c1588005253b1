// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/point_option.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/nearest_name.hpp"
#include "scene/words.hpp"

namespace dynwitness::cli {

PointAsked pointAsked(const std::string& text, const scene::Scene& scene) {
  const std::vector<std::string> words = scene::splitAtCommas(text);
  std::vector<std::string> links;
  for (const scene::Link& link : scene.mechanism.links) links.push_back(link.name);
  const auto link = std::find(links.begin(), links.end(), words[0]);
  if (link == links.end())
    throw scene::InputError(
        {}, fmt::format("--point: no link '{}'{}, allowed: {}", words[0],
                        scene::didYouMean(words[0], links), fmt::join(links, ", ")));
  if (words.size() != 1 && words.size() != 4)
    throw scene::InputError({},
                            fmt::format("--point: read '{}', allowed: LINK or LINK,x,y,z", text));
  return {static_cast<int>(link - links.begin()), {words.begin() + 1, words.end()}};
}

}  // namespace dynwitness::cli
