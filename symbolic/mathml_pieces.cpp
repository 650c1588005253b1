// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/mathml_pieces.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

namespace dynwitness::symbolic {
namespace {

/// Letters that are not worth a line's end: of an equation on a phone, and within parentheses.
constexpr std::size_t kShortEquation = 30, kShortParentheses = 18;
/// What a piece begins with, behind the groups that it opens again, and how a group looks.
const std::string kGoesOn = "<math displaystyle=\"true\">", kGroup = "<mrow>",
                  kGroupEnd = "</mrow>", kEnd = "</math>";

struct Part {
  std::string text;
  bool is_tag = false;
};

/// Tags, and what stands between them.
std::vector<Part> partsOf(const std::string& markup) {
  std::vector<Part> parts;
  for (std::size_t at = 0; at < markup.size();) {
    const bool is_tag = markup[at] == '<';
    const std::size_t end = is_tag ? markup.find('>', at) + 1 : markup.find('<', at);
    parts.push_back({markup.substr(at, end - at), is_tag});
    at = std::min(end, markup.size());
  }
  return parts;
}

/// How many letters are seen of a text: an entity is one.
std::size_t lettersOf(const std::string& text) {
  std::size_t letters = 0;
  for (std::size_t at = 0; at < text.size(); ++at, ++letters)
    if (text[at] == '&') at = text.find(';', at);
  return letters;
}

/// The parts of an equation, and what each is to its lines.
class Pieces {
 public:
  explicit Pieces(const std::string& math) : parts_(partsOf(math)) {
    pair();
    choose();
  }

  std::string text() const {
    std::string out;
    std::size_t open = 0;  // groups
    const auto repeated = [](const std::string& what, std::size_t times) {
      std::string all;
      for (std::size_t k = 0; k < times; ++k) all += what;
      return all;
    };
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      const std::string& part = parts_[k].text;
      if (breaks_.count(k) != 0)
        out += repeated(kGroupEnd, open) + kEnd + "\n" + kGoesOn + repeated(kGroup, open) +
               "<mo form=\"infix\" lspace=\"0\">";
      else if (wide_.count(k) != 0)
        out += wide_.at(k);
      else
        out += part;
      if (part == kGroup) ++open;
      if (part == kGroupEnd) --open;
    }
    return out;
  }

 private:
  struct Pair {
    std::size_t open, close, letters;
    bool has_fraction, is_angle;
  };

  bool isOperator(std::size_t k, const std::string& sign) const {
    return parts_[k].text == "<mo>" && parts_[k + 1].text == sign;
  }
  /// Which parentheses belong together, and how much stands in them.
  void pair() {
    std::vector<Pair> open;
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      if (!parts_[k].is_tag) {
        letters_ += lettersOf(parts_[k].text);
        continue;
      }
      if (parts_[k].text == "<mfrac>")
        for (Pair& around : open) around.has_fraction = true;
      if (isOperator(k, "("))  // behind what applies a function, and its group
        open.push_back({k, 0, letters_, false, k > 2 && parts_[k - 3].text == "&#x2061;"});
      if (!isOperator(k, ")")) continue;
      open.back().close = k;
      open.back().letters = letters_ - open.back().letters;
      pairs_.push_back(open.back());
      open.pop_back();
    }
  }
  /// Where lines may end.
  void choose() {
    if (letters_ <= kShortEquation) return;
    std::vector<std::string> elements;  // that are open
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      const std::string& part = parts_[k].text;
      if (!parts_[k].is_tag) continue;
      const bool stands_free = std::all_of(elements.begin(), elements.end(), [](const auto& tag) {
        return tag == kGroup || tag.compare(0, 5, "<math") == 0;
      });
      const bool is_sign = isOperator(k, "+") || isOperator(k, "&#x2212;");
      // one that follows nothing is no sum's
      const bool follows = k > 2 && parts_[k - 1].text.compare(0, 2, "</") == 0 &&
                           parts_[k - 2].text != "=" && parts_[k - 2].text != "(";
      if (is_sign && stands_free && follows) breaks_.insert(k);
      if (part.compare(0, 2, "</") == 0)
        elements.pop_back();
      else
        elements.push_back(part);
    }
    for (const Pair& pair : pairs_) {
      const auto first = breaks_.lower_bound(pair.open), last = breaks_.lower_bound(pair.close);
      if (pair.is_angle || pair.letters <= kShortParentheses) {
        breaks_.erase(first, last);
      } else if (first != last) {
        // both halves as high, whatever stands beside them
        const std::string tag = pair.has_fraction ? "<mo minsize=\"1.8em\" maxsize=\"1.8em\">"
                                                  : "<mo stretchy=\"false\">";
        wide_[pair.open] = wide_[pair.close] = tag;
      }
    }
  }

  std::vector<Part> parts_;
  std::size_t letters_ = 0;
  std::vector<Pair> pairs_;  ///< inner ones first
  std::set<std::size_t> breaks_;
  std::map<std::size_t, std::string> wide_;  ///< tags of parentheses that a line may end within
};

}  // namespace

std::string inPieces(const std::string& math) {
  const std::string block = " display=\"block\"";
  std::string inline_math = math;
  inline_math.replace(inline_math.find(block), block.size(), " displaystyle=\"true\"");
  return Pieces(inline_math).text();
}

std::string withoutPieces(const std::string& page) {
  const std::string between = kEnd + "\n" + kGoesOn;
  std::string out;
  std::size_t at = 0;
  for (std::size_t cut; (cut = page.find(between, at)) != std::string::npos;) {
    std::size_t next = cut + between.size(), groups = 0;
    for (; page.compare(next, kGroup.size(), kGroup) == 0; next += kGroup.size()) ++groups;
    out += page.substr(at, cut - groups * kGroupEnd.size() - at);
    at = next;
  }
  return out + page.substr(at);
}

}  // namespace dynwitness::symbolic
