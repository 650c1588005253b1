// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mjcf_files.hpp"

#include <system_error>

#include <fmt/format.h>

#include "scene/text_file.hpp"

namespace dynwitness::scene::mjcf {
namespace {

/// MuJoCo's own XML parser takes no more.
constexpr int kMostDepth = 500;

}  // namespace

Node Files::read(const std::string& text, const std::filesystem::path& file) {
  folder_ = file.parent_path();
  read_.insert(file.lexically_normal().string());
  const Element top = parsed(text, file.string());
  if (top.kind() != "mujoco") top.fail("not MJCF, allowed: <mujoco> as the outermost element");
  return node(top, 1);
}

Element Files::parsed(const std::string& text, const std::string& name) {
  Loaded& loaded = loaded_.emplace_back();
  loaded.name = name;
  parseXml(text, name, kMostDepth, &loaded.document);
  if (!loaded.document.RootElement()) throw InputError({name, 0}, "not MJCF: there is no element");
  return {loaded.document.RootElement(), &loaded.name};
}

Node Files::node(const Element& element, int depth) {
  if (depth > kMostDepth)
    element.fail(fmt::format("more than {} elements inside one another", kMostDepth));
  elements_ += 1;
  Node out{element, {}};
  addChildren(element, depth, &out.children);
  return out;
}

void Files::addChildren(const Element& element, int depth, std::vector<Node>* out) {
  for (const TiXmlElement* e = element.xml().FirstChildElement(); e; e = e->NextSiblingElement()) {
    const Element child = element.at(e);
    if (child.kind() != "include") {
      out->push_back(node(child, depth + 1));
      continue;
    }
    if (e->FirstChildElement()) child.fail("has elements, allowed: the attribute file alone");
    const std::filesystem::path file =
        (folder_ / child.attribute("file")).lexically_normal();  // of the main file, as MuJoCo
    if (!read_.insert(file.string()).second)
      child.fail("\"" + file.string() + "\" was read already, allowed: each file once");
    std::error_code error;
    if (!std::filesystem::exists(file, error))
      child.fail("\"" + file.string() + "\" does not exist, allowed: a file beside this one");
    const Element root = parsed(readTextFile(file, "an MJCF file"), file.string());
    if (!root.xml().FirstChildElement()) root.fail("has no elements, allowed: what is included");
    addChildren(root, depth, out);
  }
}

}  // namespace dynwitness::scene::mjcf
