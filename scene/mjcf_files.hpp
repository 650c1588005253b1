// SPDX-License-Identifier: GPL-3.0-or-later
// An MJCF file with those that it includes, as one tree of elements. For the reader of MJCF
// (mjcf_*.cpp) alone.
#pragma once

#include <deque>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "scene/xml_element.hpp"

namespace dynwitness::scene::mjcf {

/// An element with its children, those of included files in their place.
struct Node {
  Element element;
  std::vector<Node> children;
};

/// The file and those that it includes, each once.
class Files {
 public:
  Node read(const std::string& text, const std::filesystem::path& file);
  double elements() const { return elements_; }

 private:
  struct Loaded {
    std::string name;
    TiXmlDocument document;
  };

  Element parsed(const std::string& text, const std::string& name);
  Node node(const Element& element, int depth);
  void addChildren(const Element& element, int depth, std::vector<Node>* out);

  std::filesystem::path folder_;
  std::set<std::string> read_;
  std::deque<Loaded> loaded_;  // elements point into it
  double elements_ = 0;
};

}  // namespace dynwitness::scene::mjcf
