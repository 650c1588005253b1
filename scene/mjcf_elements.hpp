// SPDX-License-Identifier: GPL-3.0-or-later
// What an element of an MJCF file says, with the defaults of its class where it does not, and what
// it may say: everything else is refused by name. For the reader of MJCF (mjcf_*.cpp) alone.
#pragma once

#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/mjcf_files.hpp"
#include "scene/xml_element.hpp"

namespace dynwitness::scene::mjcf {

using Names = std::initializer_list<const char*>;

bool isOneOf(const std::string& name, Names names);

/// @throws InputError  the element has an attribute of another name
void requireKnown(const Element& element, Names used, Names without_effect = {});
/// @throws InputError  it has an element of another kind
void requireKnown(const Node& node, Names children);
/// What defaults and bodies both say.
void requireKnownGeom(const Element& element);
void requireKnownJoint(const Element& element);

struct Setting {
  std::string text;
  SourceLocation where;
};
using Settings = std::map<std::string, Setting, std::less<>>;

inline const Settings kNone;

/// Visits those of this kind among the children, in their order.
template <typename Visit>
void each(const Node& parent, const char* kind, const Visit& visit) {
  for (const Node& child : parent.children)
    if (child.element.kind() == kind) visit(child);
}

/// What an element says, and where it does not, its class.
class Said {
 public:
  Said(const Element& own, const Settings& otherwise) : own_(own), otherwise_(otherwise) {}

  SourceLocation where() const { return own_.where(); }
  [[noreturn]] void fail(const std::string& what) const { own_.fail(what); }
  [[noreturn]] void fail(const char* key, const std::string& what) const;

  bool has(const char* key) const { return setting(key).has_value(); }
  bool says(const char* key) const { return own_.xml().Attribute(key) != nullptr; }
  std::string text(const char* key, const std::string& otherwise = "") const;
  std::vector<Number> numbers(const char* key, std::size_t least, std::size_t most) const;
  Number number(const char* key, const Number& otherwise = 0) const;
  Vector vector(const char* key, const Vector& otherwise = {}) const;
  /// What the element does not say of a list is that of its class.
  std::vector<Number> overlaid(const char* key, std::size_t most) const;
  std::string word(const char* key, const std::string& otherwise, Names allowed) const;
  bool flag(const char* key, bool otherwise) const;

 private:
  std::optional<Setting> setting(const char* key) const;

  Element own_;
  const Settings& otherwise_;
};

}  // namespace dynwitness::scene::mjcf
