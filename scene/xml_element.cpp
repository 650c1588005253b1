// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/xml_element.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace dynwitness::scene {
namespace {

/// Calls visit(at, kind) for each tag: '<' opens an element, '/' closes one, '>' does both; until
/// visit returns false.
template <typename Visit>
void eachTag(const std::string& text, const Visit& visit) {
  const auto skipTo = [&text](std::size_t from, const char* end) {
    return std::min(text.find(end, from), text.size());
  };
  for (std::size_t at = skipTo(0, "<"); at < text.size(); at = skipTo(at, "<")) {
    const std::size_t begin = at;
    if (text.compare(at, 4, "<!--") == 0) {
      at = skipTo(at, "-->");
    } else if (text.compare(at, 2, "<!") == 0 || text.compare(at, 2, "<?") == 0) {
      at = skipTo(at, ">");
    } else if (text.compare(at, 2, "</") == 0) {
      at = skipTo(at, ">");
      if (!visit(begin, '/')) return;
    } else {
      while (at < text.size() && text[at] != '>') {  // which may stand in a quoted value
        const char quote[] = {text[at], '\0'};
        at = quote[0] == '"' || quote[0] == '\'' ? skipTo(at + 1, quote) + 1 : at + 1;
      }
      if (!visit(begin, text[std::min(at, text.size()) - 1] == '/' ? '>' : '<')) return;
    }
  }
}

/// Whether a text is UTF-8 (RFC 3629): what is written from it, TOML and JSON, has to be.
bool isUtf8(const std::string& text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  for (std::size_t i = 0; i < text.size();) {
    const int lead = byte(i);
    const int more = lead < 0x80 ? 0 : lead < 0xC2 ? -1 : lead < 0xE0 ? 1 : lead < 0xF0 ? 2 : 3;
    if (more < 0 || lead > 0xF4 || i + static_cast<std::size_t>(more) >= text.size()) return false;
    for (int k = 1; k <= more; ++k)
      if ((byte(i + static_cast<std::size_t>(k)) & 0xC0) != 0x80) return false;
    // too long for what they spell, halves of pairs, beyond the last
    if (more > 1) {
      const int second = byte(i + 1);
      if ((lead == 0xE0 && second < 0xA0) || (lead == 0xED && second > 0x9F) ||
          (lead == 0xF0 && second < 0x90) || (lead == 0xF4 && second > 0x8F))
        return false;
    }
    i += 1 + static_cast<std::size_t>(more);
  }
  return true;
}

void requireShallow(const std::string& text, const std::string& file, int most) {
  int depth = 0;
  eachTag(text, [&](std::size_t, char kind) {
    depth += kind == '<' ? 1 : kind == '/' ? -1 : 0;
    if (depth > most)
      throw InputError({file, 0},
                       "more than " + std::to_string(most) + " elements inside one another");
    return true;
  });
}

}  // namespace

Number angleOf(const Number& decimal) {
  const double angle = exactValue(decimal, {}).toDouble();
  constexpr double kPi = 3.14159265358979323846;
  if (std::abs(angle) > 4 * kPi) return decimal;
  for (const int n : {1, 2, 3, 4, 6}) {
    const int k = static_cast<int>(std::lround(angle * n / kPi));
    if (k == 0) continue;
    // its double takes a thousand times as long as this one, which is within 3 units of it
    const double near = std::abs(k) * kPi / n;
    if (std::abs(std::abs(angle) - near) > 8 * std::numeric_limits<double>::epsilon() * near)
      continue;
    const double exact = std::abs(Exact{0, Rational(k, n)}.toDouble());
    const double unit = std::nextafter(exact, HUGE_VAL) - exact;
    if (std::abs(std::abs(angle) - exact) > 2 * unit) continue;
    std::string text = k < 0 ? "-" : "";
    if (std::abs(k) != 1) text += std::to_string(std::abs(k)) + "*";
    text += n == 1 ? "pi" : "pi/" + std::to_string(n);
    return Expression::parse(text);
  }
  return decimal;
}

Number decimalOf(const std::string& word, const SourceLocation& where, const std::string& what) {
  std::string lower = word;
  for (char& c : lower) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  const std::size_t unsigned_at = lower.find_first_not_of("+-");
  for (const char* word_of_double : {"inf", "nan"}) {
    if (unsigned_at != std::string::npos && lower.compare(unsigned_at, 3, word_of_double) == 0) {
      throw InputError(where, what + " is \"" + word + "\", not finite, allowed: finite decimals");
    }
  }
  if (lower.find_first_not_of("0123456789+-.e") == std::string::npos) {
    try {
      Number n = Expression::parse(word);
      using Kind = Expression::Kind;
      if ((n.kind() == Kind::kNegate ? n.left() : n).kind() == Kind::kNumber) {
        exactValue(n, {});  // refuses what is not finite
        return n;
      }
    } catch (const InputError& error) {
      throw InputError(where, what + ": " + error.what());
    }
  }
  throw InputError(where, what + " is \"" + word + "\", allowed: decimals");
}

std::vector<std::string> wordsOf(const std::string& text) {
  std::istringstream words(text);
  std::vector<std::string> result;
  for (std::string word; words >> word;) result.push_back(word);
  return result;
}

void parseXml(const std::string& text, const std::string& file, int most_depth,
              TiXmlDocument* document) {
  requireShallow(text, file, most_depth);
  document->Parse(text.c_str());
  if (document->Error())
    throw InputError({file, document->ErrorRow()},
                     "not XML: " + std::string(document->ErrorDesc()));
}

std::string outermostElement(const std::string& text) {
  std::string name;
  eachTag(text, [&](std::size_t at, char) {
    const std::size_t end = std::min(text.find_first_of(" \t\r\n/>", at + 1), text.size());
    name = text.substr(at + 1, end - at - 1);
    return false;
  });
  return name;
}

void Element::fail(const std::string& what) const {
  throw InputError(where(), "<" + kind() + ">: " + what);
}

std::optional<Element> Element::child(const char* kind) const {
  const TiXmlElement* first = xml_->FirstChildElement(kind);
  if (!first) return {};
  if (const TiXmlElement* second = first->NextSiblingElement(kind))
    Element(second, file_).fail("a second one, allowed: one in <" + xml_->ValueStr() + ">");
  return Element(first, file_);
}

Element Element::requiredChild(const char* kind) const {
  const std::optional<Element> found = child(kind);
  if (!found) fail("has no <" + std::string(kind) + ">");
  return *found;
}

std::vector<Element> Element::children(const char* kind) const {
  std::vector<Element> found;
  for (const TiXmlElement* e = xml_->FirstChildElement(kind); e; e = e->NextSiblingElement(kind))
    found.emplace_back(e, file_);
  return found;
}

std::vector<Element> Element::children() const {
  std::vector<Element> found;
  for (const TiXmlElement* e = xml_->FirstChildElement(); e; e = e->NextSiblingElement())
    found.emplace_back(e, file_);
  return found;
}

std::string Element::optionalAttribute(const char* key) const {
  const char* text = xml_->Attribute(key);
  if (text != nullptr && !isUtf8(text))
    fail(std::string(key) + " is not UTF-8, allowed: text in UTF-8");
  return text ? text : "";
}

std::string Element::attribute(const char* key) const {
  if (!xml_->Attribute(key)) fail("has no " + std::string(key));
  return optionalAttribute(key);
}

Number Element::numberInside() const {
  const char* text = xml_->GetText();
  const std::vector<std::string> words = wordsOf(text ? text : "");
  if (words.size() != 1) fail("expected one number between its tags");
  return decimalOf(words[0], where(), "<" + kind() + ">: text");
}

Number Element::number(const char* key) const {
  return decimals(key, 1)[0];
}

Number Element::optionalNumber(const char* key, const Number& otherwise) const {
  return xml_->Attribute(key) ? number(key) : otherwise;
}

Vector Element::optionalVector(const char* key) const {
  if (!xml_->Attribute(key)) return {};
  const std::vector<Number> v = decimals(key, 3);
  return {v[0], v[1], v[2]};
}

Vector Element::optionalAngles(const char* key) const {
  Vector v = optionalVector(key);
  for (Number& angle : v) angle = angleOf(angle);
  return v;
}

std::vector<Number> Element::decimals(const char* key, std::size_t count) const {
  std::vector<Number> result;
  for (const std::string& word : wordsOf(attribute(key)))
    result.push_back(decimalOf(word, where(), "<" + kind() + ">: " + key));
  if (result.size() != count)
    fail(std::string(key) + " has " + std::to_string(result.size()) +
         " numbers, allowed: " + std::to_string(count));
  return result;
}

}  // namespace dynwitness::scene
