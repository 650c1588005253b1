// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/ascii_math.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>
#include <vector>

#include "crosscheck/report/text.hpp"

namespace dynwitness::crosscheck {
namespace {

bool isLetter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0;
}
bool isDigit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}
bool isAlnum(char c) {
  return isLetter(c) || isDigit(c);
}

std::string tag(const char* name, const std::string& content) {
  return std::string("<") + name + ">" + content + "</" + name + ">";
}
std::string row(const std::string& content) {
  return tag("mrow", content);
}
std::string op(std::string_view sign) {
  return tag("mo", escapeMarkup(sign));
}

constexpr std::array<std::pair<std::string_view, const char*>, 23> kLetters = {{
    {"w", "ω"},     {"wd", "ω"},  {"tau", "τ"},   {"alpha", "α"},  {"beta", "β"},
    {"nu", "ν"},    {"mu", "μ"},  {"rho", "ρ"},   {"lambda", "λ"}, {"theta", "θ"},
    {"phi", "φ"},   {"Phi", "Φ"}, {"delta", "δ"}, {"eps", "ε"},    {"epsilon", "ε"},
    {"omega", "ω"}, {"pi", "π"},  {"kappa", "κ"}, {"sigma", "σ"},  {"Delta", "Δ"},
    {"xi", "ξ"},    {"eta", "η"}, {"Gamma", "Γ"},
}};
const char* greek(std::string_view word) {
  const auto found = std::find_if(kLetters.begin(), kLetters.end(),
                                  [&](const auto& letter) { return letter.first == word; });
  return found == kLetters.end() ? nullptr : found->second;
}

/// A name without subscript: a letter, a Greek one, one or two dots over it, or a word.
std::string nameOf(std::string_view word) {
  const auto dotted = [](const std::string& base, const char* dots) {
    return "<mover accent=\"true\">" + tag("mi", base) + op(dots) + "</mover>";
  };
  if (word == "wd") return dotted("ω", "˙");
  if (const char* letter = greek(word)) return tag("mi", letter);
  if (word.size() == 1) return tag("mi", std::string(word));
  constexpr std::string_view kMove = "qvxXrRMpeTCJ";
  if (word.size() <= 3 && kMove.find(word[0]) != std::string_view::npos) {
    const std::string base(word.substr(0, 1));
    if (word.substr(1) == "d") return dotted(base, "˙");
    if (word.substr(1) == "dd") return dotted(base, "¨");
  }
  if (word.size() == 4 && word.substr(1) == "bar")
    return "<mover accent=\"true\">" + tag("mi", std::string(word.substr(0, 1))) + op("¯") +
           "</mover>";
  if (word.substr(0, 2) == "d2" && word.size() <= 3) {  // d2L/(dqd_i dqd_j): a second one
    const std::string d = "<msup>" + tag("mi", "d") + tag("mn", "2") + "</msup>";
    return word.size() == 2 ? d : row(d + nameOf(word.substr(2)));
  }
  if (word == "dt2")
    return row(tag("mi", "d") + "<msup>" + tag("mi", "t") + tag("mn", "2") + "</msup>");
  if (word[0] == 'd' && word.size() > 1) {  // dM/dt, dL/dqd: a differential
    const std::string_view of = word.substr(1);
    if (of.size() == 1 || of == "qd" || of == "qdd") return row(tag("mi", "d") + nameOf(of));
  }
  return "<mi mathvariant=\"normal\">" + escapeMarkup(word) + "</mi>";
}

class Setter {
 public:
  explicit Setter(std::string_view text) : text_(text) {}

  std::string all() {
    std::string out;
    while (at_ < text_.size()) out += list(std::string_view());
    return row(out);
  }

 private:
  char peek(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }
  bool eat(std::string_view sign) {
    if (text_.substr(at_, sign.size()) != sign) return false;
    at_ += sign.size();
    return true;
  }

  /// Everything up to one of `end` (which stays), or the end of the text.
  std::string list(std::string_view end) {
    std::string out;
    bool operand = false;  // the last thing was one
    while (at_ < text_.size()) {
      const char c = peek();
      if (end.find(c) != std::string_view::npos) return out;
      if (c == ' ') {
        ++at_;
        continue;
      }
      if (isAlnum(c) || c == '(' || c == '[') {
        if (const std::string sign = crossProduct(operand); !sign.empty()) {
          out += sign;
          operand = false;
          continue;
        }
        // words stand apart from what they follow
        if (operand && at_ > 0 && text_[at_ - 1] == ' ') out += "<mspace width=\"0.28em\"/>";
        out += withPowers(atom());
        operand = true;
        continue;
      }
      out += sign();
      operand = false;
    }
    return out;
  }

  /// An x (or x*) between two operands.
  std::string crossProduct(bool operand) {
    if (!operand || peek() != 'x' || at_ == 0 || text_[at_ - 1] != ' ') return {};
    std::size_t next = 1;
    const bool dual = peek(1) == '*';
    if (dual) ++next;
    if (peek(next) != ' ') return {};
    const char after = peek(next + 1);
    if (!isAlnum(after) && after != '(' && after != '[') return {};
    at_ += next;
    return dual ? "<msup>" + op("×") + op("∗") + "</msup>" : op("×");
  }

  std::string sign() {
    static constexpr std::array<std::pair<std::string_view, const char*>, 8> kSigns = {{
        {"!=", "≠"},
        {"/=", "≠"},
        {"<=", "≤"},
        {">=", "≥"},
        {"->", "→"},
        {"...", "…"},
        {"-", "−"},
        {"*", "·"},
    }};
    for (const auto& [ascii, shown] : kSigns)
      if (eat(ascii)) return op(shown);
    const bool product = peek() == '.';
    const std::string shown(1, text_[at_++]);
    if (product) return op("·");
    if (shown == "/") return "<mo lspace=\"0\" rspace=\"0\">/</mo>";
    if (shown == "," || shown == ";" || shown == ":")
      return "<mo separator=\"true\">" + shown + "</mo><mspace width=\"0.2em\"/>";
    return op(shown);
  }

  std::string atom() {
    const char c = peek();
    if (c == '(') return bracketed('(', ')');
    if (c == '[') return matrix();
    if (isDigit(c)) {
      std::size_t size = 0;
      while (isDigit(peek(size)) || (peek(size) == '.' && isDigit(peek(size + 1)))) ++size;
      const std::string digits(text_.substr(at_, size));
      at_ += size;
      return tag("mn", digits);
    }
    std::size_t size = 0;
    while (isAlnum(peek(size))) ++size;
    const std::string_view word = text_.substr(at_, size);
    at_ += size;
    if (word == "hat" && peek() == '(') {
      ++at_;
      // over a name the hat stands on the letter, its subscript beside both
      const std::size_t start = at_;
      while (isAlnum(peek())) ++at_;
      if (at_ > start && peek() == '_') {
        const std::string_view name = text_.substr(start, at_ - start);
        const std::string whole = subscripted(name, hatted(nameOf(name)));
        if (eat(")")) return whole;
      } else if (at_ > start && peek() == ')') {
        const std::string letter = nameOf(text_.substr(start, at_ - start));
        ++at_;
        return hatted(letter);
      }
      at_ = start;
      const std::string inside = list(")");
      eat(")");
      return hatted(row(op("(") + inside + op(")")));
    }
    const std::string base = word == "sum" ? op("∑") : word == "int" ? op("∫") : nameOf(word);
    return subscripted(word, base);
  }

  static std::string hatted(const std::string& base) {
    return "<mover accent=\"true\">" + base + op("^") + "</mover>";
  }

  std::string subscripted(std::string_view word, std::string base) {
    if (peek() != '_') return base;
    // T_F and T_V: the letter says which of the two transformations
    if (word == "T" && (peek(1) == 'F' || peek(1) == 'V') && !isAlnum(peek(2))) {
      const std::string raised = tag("mi", std::string(1, peek(1)));
      at_ += 2;
      if (peek() != '_') return "<msup>" + base + raised + "</msup>";
      return "<msubsup>" + base + subscript() + raised + "</msubsup>";
    }
    return "<msub>" + base + subscript() + "</msub>";
  }

  /// After a name: "_i6", "_(i+1)", "_A,i", "_i,i+1", "_i+1".
  std::string subscript() {
    ++at_;
    if (eat("(")) {
      const std::string inside = list(")");
      eat(")");
      return row(inside);
    }
    std::string out;
    char last = '\0';
    while (true) {
      const char c = peek();
      if (isDigit(c)) {
        std::string digits;
        for (; isDigit(peek()); ++at_) digits += peek();
        out += tag("mn", digits);
        last = '0';
      } else if (isLetter(c)) {
        std::string word;
        for (; isLetter(peek()); ++at_) word += peek();
        if (word.find_first_not_of("ijk") == std::string::npos)
          for (const char index : word) out += tag("mi", std::string(1, index));
        else
          out += nameOf(word);
        last = word.back();
      } else if ((c == ',' || c == '_') && isAlnum(peek(1))) {
        ++at_;
        out += "<mo separator=\"true\">,</mo>";
      } else if ((c == '+' || c == '-') && isDigit(peek(1)) && (last == 'i' || last == 'j')) {
        ++at_;
        out += op(c == '+' ? "+" : "−");
      } else {
        return row(out);
      }
    }
  }

  std::string bracketed(char open, char close) {
    ++at_;
    const std::string inside = list(std::string(1, close));
    eat(std::string(1, close));
    return row(op(std::string(1, open)) + inside + op(std::string(1, close)));
  }

  std::string matrix() {
    ++at_;
    std::string rows, cells;
    while (at_ < text_.size()) {
      cells += tag("mtd", row(list(",;]")));
      const char c = peek();
      ++at_;
      if (c == ',') continue;
      rows += tag("mtr", cells);
      cells.clear();
      if (c != ';') break;
    }
    return row(op("[") + tag("mtable", rows) + op("]"));
  }

  /// Transposes and powers after an operand.
  std::string withPowers(std::string base) {
    while (true) {
      if (peek() == '_' && isAlnum(peek(1))) {  // of a bracket
        base = "<msub>" + base + subscript() + "</msub>";
      } else if (peek() == '\'') {
        ++at_;
        base = "<msup>" + base + "<mi mathvariant=\"normal\">T</mi></msup>";
      } else if (peek() == '^') {
        ++at_;
        std::string power;
        if (eat("(")) {
          power = row(list(")"));
          eat(")");
        } else {
          if (isLetter(peek()) && peek(1) == '_') {  // Gamma^i_jk: one index up, the others down
            power = tag("mi", std::string(1, text_[at_++]));
            base = "<msubsup>" + base + subscript() + power + "</msubsup>";
            continue;
          }
          if (eat("-")) power = op("−");
          power = row(power + (isAlnum(peek()) ? atom() : std::string()));
        }
        base = "<msup>" + base + power + "</msup>";
      } else {
        return base;
      }
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::string mathMl(std::string_view formula) {
  return "<math xmlns=\"http://www.w3.org/1998/Math/MathML\">" + Setter(formula).all() + "</math>";
}

std::string textWithMath(std::string_view text) {
  std::string out;
  bool in_formula = false;
  while (true) {
    const std::size_t tick = text.find('`');
    const std::string_view piece = text.substr(0, tick);
    out += in_formula ? mathMl(piece) : escapeMarkup(piece);
    if (tick == std::string_view::npos) return out;
    text.remove_prefix(tick + 1);
    in_formula = !in_formula;
  }
}

}  // namespace dynwitness::crosscheck
