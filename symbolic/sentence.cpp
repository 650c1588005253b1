// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/sentence.hpp"

#include <cctype>
#include <optional>

#include "symbolic/derivation.hpp"

namespace dynwitness::symbolic {
namespace {

/// A word that is mathematics: dqd_j is a differential d, the letter q with one dot, and j.
struct Symbol {
  bool is_differential = false;
  std::string head;  ///< a letter, or a Greek one by its name
  int dots = 0;
  std::string subscript;
};

/// Greek letters by name, and letters that stand for quantities in the sentences of derivations; a
/// and I alone are words.
bool isQuantity(const std::string& head, bool has_subscript) {
  if (head.size() > 1) return printName(head, Style::kLatex) == "\\" + head;
  const std::string letters =
      has_subscript ? "ABCDHIJKLMQRTVWXbcdfghmnpqrvwxyz" : "BDHJKLMQRTVWXbcfghijkmnpqvwxyz";
  return head.size() == 1 && letters.find(head) != std::string::npos;
}

/// "ij", "112", "1_10": what may stand below a letter.
bool isIndex(const std::string& text) {
  const bool digits = text.find_first_not_of("0123456789_") == std::string::npos;
  const bool letters = text.size() <= 3 && text.find_first_not_of("ijkhvwxyz") == std::string::npos;
  return !text.empty() && (digits || letters);
}

std::optional<Symbol> symbolOf(const std::string& word) {
  std::size_t end = word.find_first_of("_0123456789");
  if (end == std::string::npos) end = word.size();
  Symbol symbol;
  symbol.head = word.substr(0, end);
  symbol.subscript = word.substr(end < word.size() && word[end] == '_' ? end + 1 : end);
  if (end < word.size() && !isIndex(symbol.subscript)) return std::nullopt;
  const auto settled = [&symbol]() -> std::optional<Symbol> {
    if (symbol.head == "qd" || symbol.head == "qdd") {
      symbol.dots = static_cast<int>(symbol.head.size()) - 1;
      symbol.head = "q";
    }
    const bool known = isQuantity(symbol.head, !symbol.subscript.empty()) ||
                       (symbol.is_differential && symbol.head == "t");
    return known ? std::optional<Symbol>(symbol) : std::nullopt;
  };
  if (auto found = settled()) return found;
  if (symbol.head.size() < 2 || symbol.head[0] != 'd') return std::nullopt;
  symbol.is_differential = true;
  symbol.head.erase(0, 1);
  return settled();
}

std::string latex(const Symbol& s) {
  const std::string head = s.head.size() > 1 ? "\\" + s.head : s.head;
  std::string text = s.is_differential ? "d" : "";
  text += s.dots == 0 ? head : std::string(s.dots == 1 ? "\\dot{" : "\\ddot{") + head + "}";
  std::string below = s.subscript;
  for (std::size_t at = 0; (at = below.find('_', at)) != std::string::npos; at += 2)
    below.replace(at, 1, "\\,");
  return "$" + text + (below.empty() ? "" : "_{" + below + "}") + "$";
}

std::string mathml(const Symbol& s) {
  std::string head = printName(s.head, Style::kMathml), below;
  if (s.dots > 0)
    head = "<mover>" + head + "<mo>" + (s.dots == 1 ? "&#x22c5;" : "&#x22c5;&#x22c5;") +
           "</mo></mover>";
  for (const char ch : s.subscript)
    below += std::isdigit(static_cast<unsigned char>(ch)) ? std::string("<mn>") + ch + "</mn>"
             : ch == '_'                                  ? "<mspace width=\"0.17em\"></mspace>"
                                                          : std::string("<mi>") + ch + "</mi>";
  if (!below.empty()) head = "<msub>" + head + "<mrow>" + below + "</mrow></msub>";
  return std::string("<math><mrow>") + (s.is_differential ? "<mi>d</mi>" : "") + head +
         "</mrow></math>";
}

bool isWordLetter(char ch) {
  return std::isalnum(static_cast<unsigned char>(ch)) != 0 || ch == '_';
}

}  // namespace

std::string printSentence(const std::string& sentence, Style style) {
  if (style != Style::kLatex && style != Style::kMathml) return sentence;
  std::string out;
  for (std::size_t at = 0; at < sentence.size();) {
    std::size_t end = at;
    while (end < sentence.size() && isWordLetter(sentence[end])) ++end;
    if (end > at) {
      const std::string word = sentence.substr(at, end - at);
      // a hyphen or apostrophe makes a letter part of a word: T-pole, it's
      const auto joins = [&](std::size_t k) { return k < sentence.size() && sentence[k] == '-'; };
      const std::optional<Symbol> symbol =
          joins(end) || (at > 0 && joins(at - 1)) ? std::nullopt : symbolOf(word);
      out += !symbol                  ? printText(word, style)
             : style == Style::kLatex ? latex(*symbol)
                                      : mathml(*symbol);
      at = end;
    } else if (sentence.compare(at, 3, " - ") == 0) {
      out += style == Style::kLatex ? " $-$ " : " &#x2212; ";
      at += 3;
    } else {
      out += printText(std::string(1, sentence[at++]), style);
    }
  }
  return out;
}

}  // namespace dynwitness::symbolic
