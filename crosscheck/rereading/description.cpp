// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/rereading/description.hpp"

#include <set>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

namespace dynwitness::crosscheck::rereading {

Description described(const std::string& text, const std::filesystem::path& file,
                      const std::vector<std::filesystem::path>& bundled) {
  const std::string content = withoutMark(text);
  const std::size_t first = content.find_first_not_of(" \t\r\n");
  const bool is_xml = first != std::string::npos && content[first] == '<';
  return is_xml ? describedUrdf(content) : describedToml(content, file, bundled);
}

std::string withoutMark(const std::string& text) {
  const std::string mark = "\xEF\xBB\xBF";
  return text.rfind(mark, 0) == 0 ? text.substr(mark.size()) : text;
}

std::vector<Link> inOrder(std::vector<Named> links) {
  std::unordered_map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < links.size(); ++i) index.emplace(links[i].link.name, i);
  std::vector<std::vector<std::size_t>> children(links.size());
  std::set<std::size_t> next;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (!links[i].parent) {
      next.insert(i);
      continue;
    }
    const auto parent = index.find(*links[i].parent);
    if (parent == index.end())
      throw std::runtime_error(fmt::format("there is no link '{}'", *links[i].parent));
    children[parent->second].push_back(i);
  }
  std::vector<Link> out;
  std::vector<int> place(links.size(), -1);
  while (!next.empty()) {
    const std::size_t i = *next.begin();
    next.erase(next.begin());
    place[i] = static_cast<int>(out.size());
    out.push_back(std::move(links[i].link));
    if (links[i].parent) out.back().parent = place[index.at(*links[i].parent)];
    next.insert(children[i].begin(), children[i].end());
  }
  if (out.size() != links.size()) throw std::runtime_error("its links are no tree");
  return out;
}

}  // namespace dynwitness::crosscheck::rereading
