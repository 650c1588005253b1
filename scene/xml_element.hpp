// SPDX-License-Identifier: GPL-3.0-or-later
// Elements of XML files, their numbers as they are spelled, and messages about them. For the
// readers of scene/.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tinyxml.h>

#include "scene/mechanism.hpp"

namespace dynwitness::scene {

/** Angles that decimals cannot spell. A number that is, as a double, within two units in the last
    place of k pi / n, n = 1, 2, 3, 4 or 6, is taken to be that angle: these are all the prints of
    it with 16 or more significant digits (1.570796326794897). A print with fewer digits, such
    as 1.5708, stays the decimal that it is: other programs that read the file turn by that angle,
    too. */
Number angleOf(const Number& decimal);

/** The decimal that a word of a file spells, exactly.
    @param what  begins the message: "<mass>: value"
    @throws InputError  it is none, or not finite in a double */
Number decimalOf(const std::string& word, const SourceLocation& where, const std::string& what);

/// The words of a text, which blanks separate.
std::vector<std::string> wordsOf(const std::string& text);

/** Parses a whole file.
    @param most_depth  how many elements may lie inside one another: TinyXML recurses
    @throws InputError  it is no XML, or deeper */
void parseXml(const std::string& text, const std::string& file, int most_depth,
              TiXmlDocument* document);

/// The name of the outermost element, found without parsing; "": there is none.
std::string outermostElement(const std::string& text);

/// One element of a file, with the messages about it.
class Element {
 public:
  /// @param file  its name, which lives as long as the element is used
  Element(const TiXmlElement* xml, const std::string* file) : xml_(xml), file_(file) {}

  SourceLocation where() const { return {*file_, xml_->Row()}; }
  std::string kind() const { return xml_->ValueStr(); }
  const TiXmlElement& xml() const { return *xml_; }
  /// Another one of the same file.
  Element at(const TiXmlElement* xml) const { return {xml, file_}; }
  [[noreturn]] void fail(const std::string& what) const;

  /// The only child of this kind, if there is one.
  std::optional<Element> child(const char* kind) const;
  Element requiredChild(const char* kind) const;
  std::vector<Element> children(const char* kind) const;
  std::vector<Element> children() const;

  std::string optionalAttribute(const char* key) const;
  std::string attribute(const char* key) const;
  /// The number between the element's tags.
  Number numberInside() const;
  Number number(const char* key) const;
  Number optionalNumber(const char* key, const Number& otherwise = Number(0)) const;
  Vector optionalVector(const char* key) const;
  Vector optionalAngles(const char* key) const;

 private:
  std::vector<Number> decimals(const char* key, std::size_t count) const;

  const TiXmlElement* xml_;
  const std::string* file_;
};

}  // namespace dynwitness::scene
