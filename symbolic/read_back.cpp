// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/read_back.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>

#include "scene/state.hpp"
#include "symbolic/mathml_pieces.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::symbolic {
namespace {

/// An integer modulo the prime 2^61 - 1.
class Residue {
 public:
  static constexpr std::uint64_t kPrime = (std::uint64_t{1} << 61) - 1;

  Residue(std::int64_t n = 0) : n_(n < 0 ? kPrime - reduced(-n) : reduced(n)) {}
  static Residue of(const Rational& r) { return of(numerator(r)) / of(denominator(r)); }

  friend Residue operator+(Residue a, Residue b) { return raw(reduced(a.n_ + b.n_)); }
  friend Residue operator-(Residue a, Residue b) { return raw(reduced(a.n_ + kPrime - b.n_)); }
  friend Residue operator*(Residue a, Residue b) {
    __extension__ using Wide = unsigned __int128;
    const Wide product = Wide{a.n_} * b.n_;
    return raw(reduced(static_cast<std::uint64_t>(product & kPrime) +
                       static_cast<std::uint64_t>(product >> 61)));
  }
  friend Residue operator/(Residue a, Residue b) {  // by Fermat: b^(p - 2)
    if (b == Residue()) throw std::runtime_error("division by 0");
    Residue power = a;
    for (std::uint64_t e = kPrime - 2; e != 0; e /= 2, b = b * b)
      if (e % 2 == 1) power = power * b;
    return power;
  }
  Residue operator-() const { return Residue() - *this; }
  friend bool operator==(Residue a, Residue b) { return a.n_ == b.n_; }
  friend bool operator!=(Residue a, Residue b) { return a.n_ != b.n_; }
  /// Stands for the sign of a rate, which the field does not have: some number that belongs to it.
  friend Residue directionOf(Residue rate) { return rate * rate + Residue(3); }

 private:
  static Residue raw(std::uint64_t n) {
    Residue r;
    r.n_ = n;
    return r;
  }
  static std::uint64_t reduced(std::uint64_t n) {
    n = (n & kPrime) + (n >> 61);
    return n >= kPrime ? n - kPrime : n;
  }
  static Residue of(const scene::Integer& n) {
    const scene::Integer rest = n % kPrime;
    return Residue(rest.convert_to<std::int64_t>());
  }

  std::uint64_t n_;
};
using Circle = scene::CosSin<Residue>;

/// Random numbers of the field, the same for the same key.
class Draw {
 public:
  explicit Draw(unsigned seed) : seed_(seed) {}
  Residue number(const std::string& key) const {
    std::seed_seq words(key.begin(), key.end());
    std::vector<std::uint32_t> mixed(2);
    words.generate(mixed.begin(), mixed.end());
    std::seed_seq all{mixed[0], mixed[1], static_cast<std::uint32_t>(key.size()), seed_};
    std::mt19937_64 random(all);
    return Residue(static_cast<std::int64_t>(random() >> 2));
  }
  /// ((1 - t^2)/(1 + t^2), 2 t/(1 + t^2))
  Circle circle(const std::string& key) const {
    const Residue t = number("angle " + key), d = Residue(1) + t * t;
    return {(Residue(1) - t * t) / d, Residue(2) * t / d};
  }

 private:
  unsigned seed_;
};

/// A scene's numbers: parameters, pi and angles are drawn, others are what they are.
class DrawnNumbers {
 public:
  using Scalar = Residue;
  DrawnNumbers(const scene::Mechanism& mechanism, Draw draw) : draw_(draw) {
    drawn_["pi"] = draw.number("pi");
    for (const scene::Parameter& p : mechanism.parameters) drawn_[p.name] = draw.number(p.name);
  }
  Residue operator()(const scene::Number& number) const {
    const auto at = drawn_.find(number.text());
    return at != drawn_.end() ? at->second : Residue::of(scene::exactValue(number, {}).rational);
  }
  Circle angle(const scene::Number& radians) const { return draw_.circle(radians.text()); }
  scene::AxisTurn<Residue> axisTurn(const scene::Vector& axis) const {
    const std::string key = axis[0].text() + "," + axis[1].text() + "," + axis[2].text();
    return {draw_.circle("alpha" + key), draw_.circle("beta" + key)};
  }

 private:
  Draw draw_;
  std::map<std::string, Residue> drawn_;
};

// ---- words --------------------------------------------------------------------------------------

struct Token {
  enum class Kind { kNumber, kName, kOperator, kFunction, kAngle, kEnd };
  Kind kind = Kind::kEnd;
  Circle point;      ///< kAngle: one that is no sum of positions, in parentheses
  Residue value;     ///< kNumber, kName
  char symbol = 0;   ///< kOperator: + - * / ^ ( ); kFunction: c or s
  std::string name;  ///< kName, as it is spelled
  std::size_t begin = 0, end = 0;
};

[[noreturn]] void unreadable(const std::string& text, std::size_t at) {
  throw std::runtime_error("cannot be read from '" + text.substr(at, 30) + "' on");
}

/// What names stand for, and how one notation spells words.
class Vocabulary {
 public:
  explicit Vocabulary(Style style) : style_(style) {}

  void define(const std::string& spelled, Residue value) {
    const auto [at, is_new] = names_.emplace(spelled, value);
    // two things that are spelled alike cannot be told apart by who reads them
    if (!is_new && at->second != value)
      throw std::runtime_error("'" + spelled + "' stands for two things");
  }
  /// What a cosine or sine may be taken of, besides sums of positions.
  void defineAngle(const std::string& spelled, Circle point) { angles_[spelled] = point; }
  void definePosition(const std::string& spelled, Residue value, Circle point) {
    define(spelled, value);
    positions_[spelled] = point;
  }

  const std::map<std::string, Circle>& positions() const { return positions_; }

  std::vector<Token> tokens(const std::string& text) const {
    std::vector<Token> out;
    for (std::size_t at = 0; at < text.size();) at = read(text, at, &out);
    Token end;
    end.begin = end.end = text.size();
    out.push_back(end);
    return out;
  }

 private:
  static bool follows(const std::string& text, std::size_t at, const std::string& word) {
    return text.compare(at, word.size(), word) == 0;
  }

  /// The longest name that stands here; null: none.
  const std::pair<const std::string, Residue>* nameAt(const std::string& text,
                                                      std::size_t at) const {
    const std::pair<const std::string, Residue>* longest = nullptr;
    for (const auto& name : names_)
      if (follows(text, at, name.first) && !isCut(text, at + name.first.size()) &&
          (!longest || name.first.size() > longest->first.size()))
        longest = &name;
    return longest;
  }
  /// In plain text q1 is no part of q12.
  bool isCut(const std::string& text, std::size_t end) const {
    return style_ == Style::kText && end < text.size() &&
           (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '_') &&
           std::isalnum(static_cast<unsigned char>(text[end - 1]));
  }

  static std::size_t digitsFrom(const std::string& text, std::size_t at) {
    while (at < text.size() &&
           (std::isdigit(static_cast<unsigned char>(text[at])) || text[at] == '.'))
      ++at;
    return at;
  }
  static Token number(const std::string& text, std::size_t begin, std::size_t end) {
    Token token;
    token.kind = Token::Kind::kNumber;
    token.value = Residue::of(
        scene::exactValue(scene::Number::parse(text.substr(begin, end - begin)), {}).rational);
    token.begin = begin;
    token.end = end;
    return token;
  }
  static Token op(char symbol, std::size_t begin, std::size_t end) {
    Token token;
    token.kind = Token::Kind::kOperator;
    token.symbol = symbol;
    token.begin = begin;
    token.end = end;
    return token;
  }
  static Token function(char symbol, std::size_t begin, std::size_t end) {
    Token token = op(symbol, begin, end);
    token.kind = Token::Kind::kFunction;
    return token;
  }

  /// An angle of the scene in parentheses, behind a function: where it ends; at: none stands here.
  std::size_t readAngle(const std::string& text, std::size_t at, std::vector<Token>* out) const {
    const auto is = [out](std::size_t before_last, Token::Kind kind) {
      return out->size() > before_last && (*out)[out->size() - 1 - before_last].kind == kind;
    };
    const bool called = is(0, Token::Kind::kFunction) ||
                        (is(0, Token::Kind::kNumber) && is(2, Token::Kind::kFunction));
    if (!called) return at;
    for (const auto& [open, close] : std::vector<std::pair<std::string, std::string>>{
             {"(", ")"}, {"\\bigl(", "\\bigr)"}, {"<mo>(</mo>", "<mo>)</mo>"}}) {
      if (!follows(text, at, open)) continue;
      for (const auto& [spelled, point] : angles_) {
        if (!follows(text, at + open.size(), spelled + close)) continue;
        Token token;
        token.kind = Token::Kind::kAngle;
        token.point = point;
        token.begin = at;
        token.end = at + open.size() + spelled.size() + close.size();
        out->push_back(token);
        return token.end;
      }
    }
    return at;
  }

  std::size_t read(const std::string& text, std::size_t at, std::vector<Token>* out) const {
    if (const std::size_t end = readAngle(text, at, out); end != at) return end;
    if (const auto* name = nameAt(text, at)) {
      Token token;
      token.kind = Token::Kind::kName;
      token.name = name->first;
      token.value = name->second;
      token.begin = at;
      token.end = at + name->first.size();
      out->push_back(token);
      return token.end;
    }
    switch (style_) {
      case Style::kLatex:
        return readLatex(text, at, out);
      case Style::kMathml:
        return readMathml(text, at, out);
      default:
        return readPlain(text, at, out);
    }
  }

  std::size_t readPlain(const std::string& text, std::size_t at, std::vector<Token>* out) const {
    for (const char* function_name : {"cos(", "sin("})
      if (follows(text, at, function_name)) {
        out->push_back(function(function_name[0], at, at + 3));
        return at + 3;
      }
    const std::size_t digits = digitsFrom(text, at);
    if (digits > at) {
      out->push_back(number(text, at, digits));
      return digits;
    }
    if (std::string("+-*/^()").find(text[at]) != std::string::npos)
      out->push_back(op(text[at], at, at + 1));
    else if (text[at] != ' ')
      unreadable(text, at);
    return at + 1;
  }

  /// The end of the group whose brace stands at `at`.
  static std::size_t closing(const std::string& text, std::size_t at) {
    int depth = 0;
    for (std::size_t i = at; i < text.size(); ++i) {
      if (text[i] == '\\') {
        ++i;
        continue;
      }
      if (text[i] == '{') ++depth;
      if (text[i] == '}' && --depth == 0) return i;
    }
    unreadable(text, at);
  }
  /// Tokens of a part of the text, where they stand in the whole.
  void part(const std::string& text, std::size_t begin, std::size_t end,
            std::vector<Token>* out) const {
    const std::string whole = text.substr(0, end);
    for (std::size_t at = begin; at < end;) at = read(whole, at, out);
  }
  void fraction(const std::string& text, std::size_t top, std::size_t top_end, std::size_t bottom,
                std::size_t bottom_end, std::vector<Token>* out) const {
    out->push_back(op('(', top, top));
    out->push_back(op('(', top, top));
    part(text, top, top_end, out);
    out->push_back(op(')', top_end, top_end));
    out->push_back(op('/', top_end, top_end));
    out->push_back(op('(', bottom, bottom));
    part(text, bottom, bottom_end, out);
    out->push_back(op(')', bottom_end, bottom_end));
    out->push_back(op(')', bottom_end, bottom_end));
  }

  std::size_t readLatex(const std::string& text, std::size_t at, std::vector<Token>* out) const {
    for (const char* size : {"\\bigl", "\\bigr"})
      if (follows(text, at, size)) return at + 5;
    if (follows(text, at, "\\cdot")) {
      out->push_back(op('*', at, at + 5));
      return at + 5;
    }
    for (const char* word : {"\\cos", "\\sin"})
      if (follows(text, at, word)) {
        out->push_back(function(word[1], at, at + 4));
        return at + 4;
      }
    for (const std::string word : {"\\tfrac", "\\frac"})
      if (follows(text, at, word)) {
        const std::size_t top = at + word.size(), top_end = closing(text, top),
                          bottom = top_end + 1, bottom_end = closing(text, bottom);
        fraction(text, top + 1, top_end, bottom + 1, bottom_end, out);
        return bottom_end + 1;
      }
    if (text[at] == '{') {  // braces are not seen
      const std::size_t end = closing(text, at);
      part(text, at + 1, end, out);
      return end + 1;
    }
    const std::size_t digits = digitsFrom(text, at);
    if (digits > at) {
      out->push_back(number(text, at, digits));
      return digits;
    }
    if (std::string("+-^()").find(text[at]) != std::string::npos)
      out->push_back(op(text[at], at, at + 1));
    else if (text[at] != ' ')
      unreadable(text, at);
    return at + 1;
  }

  /// The end of the element that begins here.
  static std::size_t elementEnd(const std::string& text, std::size_t at) {
    int depth = 0;
    for (std::size_t i = at; i < text.size(); ++i) {
      if (text[i] != '<') continue;
      depth += text[i + 1] == '/' ? -1 : 1;
      i = text.find('>', i);
      if (i == std::string::npos) break;
      if (depth == 0) return i + 1;
    }
    unreadable(text, at);
  }
  /// Begin and end of what stands inside an element.
  static std::pair<std::size_t, std::size_t> inside(const std::string& text, std::size_t at) {
    return {text.find('>', at) + 1, text.rfind("</", elementEnd(text, at) - 1)};
  }

  std::size_t readMathml(const std::string& text, std::size_t at, std::vector<Token>* out) const {
    if (text[at] != '<') unreadable(text, at);
    const std::size_t end = elementEnd(text, at);
    const auto [begin, last] = inside(text, at);
    const std::string tag = text.substr(at + 1, text.find_first_of(" >", at) - at - 1),
                      content = text.substr(begin, last - begin);
    if (tag == "mrow") {  // groups are not seen
      part(text, begin, last, out);
    } else if (tag == "mfrac") {
      const std::size_t top = elementEnd(text, begin);
      fraction(text, begin, top, top, last, out);
    } else if (tag == "msup") {
      const std::size_t base = elementEnd(text, begin);
      part(text, begin, base, out);
      out->push_back(op('^', base, base));
      part(text, base, last, out);
    } else if (tag == "mspace") {
      return end;
    } else if (tag == "mn") {
      out->push_back(number(text, begin, last));
    } else if (tag == "mi" && (content == "cos" || content == "sin")) {
      out->push_back(function(content[0], at, end));
    } else if (tag == "mo") {
      static const std::map<std::string, char> kSigns = {
          {"+", '+'}, {"&#x2212;", '-'}, {"&#x2062;", '*'}, {"(", '('}, {")", ')'}};
      if (content != "&#x2061;") {  // what applies a function
        const auto sign = kSigns.find(content);
        if (sign == kSigns.end()) unreadable(text, at);
        out->push_back(op(sign->second, at, end));
      }
    } else {
      unreadable(text, at);
    }
    return end;
  }

  Style style_;
  std::map<std::string, Residue> names_;
  std::map<std::string, Circle> angles_, positions_;
};

// ---- sentences ----------------------------------------------------------------------------------

/** sum      [+-] product ([+-] product)...
    product  power ([*][/] power)..., side by side in LaTeX
    power    atom [^ whole number], of a function after its name, too
    atom     number, name, ( sum ), function of ( angle ) or of the one name after it */
class Sentence {
 public:
  Sentence(const Vocabulary& vocabulary, const std::string& text)
      : vocabulary_(vocabulary), text_(text), tokens_(vocabulary.tokens(text)) {}

  Residue value() {
    const Residue v = sum();
    if (now().kind != Token::Kind::kEnd) unreadable(text_, now().begin);
    return v;
  }

 private:
  const Token& now() const { return tokens_[at_]; }
  bool is(char symbol) const {
    return now().kind == Token::Kind::kOperator && now().symbol == symbol;
  }
  bool take(char symbol) {
    if (!is(symbol)) return false;
    ++at_;
    return true;
  }
  void expect(char symbol) {
    if (!take(symbol)) unreadable(text_, now().begin);
  }

  Residue sum() {
    const bool negative = take('-');
    Residue total = product();
    if (negative) total = -total;
    while (is('+') || is('-')) {
      const bool minus = is('-');
      ++at_;
      const Residue term = product();
      total = minus ? total - term : total + term;
    }
    return total;
  }
  bool beginsAtom() const {
    return is('(') || now().kind == Token::Kind::kNumber || now().kind == Token::Kind::kName ||
           now().kind == Token::Kind::kFunction;
  }
  Residue product() {
    Residue total = power();
    while (is('*') || is('/') || beginsAtom()) {
      const bool divides = take('/');
      if (!divides) take('*');
      const Residue factor = power();
      total = divides ? total / factor : total * factor;
    }
    return total;
  }
  int exponent() {
    if (now().kind != Token::Kind::kNumber) unreadable(text_, now().begin);
    const Residue n = tokens_[at_++].value;
    for (int k = 0; k < 100; ++k)
      if (n == Residue(k)) return k;
    unreadable(text_, now().begin);
  }
  static Residue raised(Residue base, int n) {
    Residue power(1);
    for (int i = 0; i < n; ++i) power = power * base;
    return power;
  }
  Residue power() {
    const Residue base = atom();
    return take('^') ? raised(base, exponent()) : base;
  }
  Residue atom() {
    const Token token = now();
    if (token.kind == Token::Kind::kNumber || token.kind == Token::Kind::kName) {
      ++at_;
      return token.value;
    }
    if (token.kind == Token::Kind::kFunction) {
      ++at_;
      const int n = take('^') ? exponent() : 1;
      const Circle point = angle();
      return raised(token.symbol == 'c' ? point.c : point.s, n);
    }
    expect('(');
    const Residue inner = sum();
    expect(')');
    return inner;
  }

  /// Cosine and sine of what stands behind a function.
  Circle angle() {
    if (now().kind == Token::Kind::kName) return ofName(tokens_[at_++]);
    if (now().kind == Token::Kind::kAngle) return tokens_[at_++].point;
    expect('(');
    const Circle point = sumOfPositions();
    expect(')');
    return point;
  }
  Circle ofName(const Token& token) const {
    const auto at = vocabulary_.positions().find(token.name);
    if (at == vocabulary_.positions().end()) unreadable(text_, token.begin);
    return at->second;
  }
  static Circle added(Circle a, Circle b) { return {a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s}; }
  Circle sumOfPositions() {
    Circle total{Residue(1), Residue(0)};
    for (bool first = true; first || is('+') || is('-'); first = false) {
      const bool negative = take('-');
      if (!negative) take('+');
      int times = 1;
      if (now().kind == Token::Kind::kNumber) {
        times = exponent();
        take('*');
      }
      if (now().kind != Token::Kind::kName) unreadable(text_, now().begin);
      Circle one = ofName(tokens_[at_++]);
      if (negative) one.s = -one.s;
      for (int k = 0; k < times; ++k) total = added(total, one);
    }
    return total;
  }

  const Vocabulary& vocabulary_;
  const std::string& text_;
  std::vector<Token> tokens_;
  std::size_t at_ = 0;
};

// ---- documents ----------------------------------------------------------------------------------

struct Sides {
  std::string left, right;
};

/// The equations of a document, as they are marked there.
std::vector<Sides> equationsIn(const std::string& document, Style style) {
  const std::string begin = style == Style::kLatex    ? "$\\displaystyle "
                            : style == Style::kMathml ? "<math "
                                                      : "\n     ",
                    end = style == Style::kLatex    ? "$\n"
                          : style == Style::kMathml ? "</mrow></math>"
                                                    : "\n",
                    equals = style == Style::kMathml ? "<mo>=</mo>" : " = ";
  std::vector<Sides> all;
  for (std::size_t at = 0; (at = document.find(begin, at)) != std::string::npos;) {
    at += begin.size();
    const std::size_t last = document.find(end, at);
    std::string line = document.substr(at, last - at);
    if (style == Style::kMathml) line = line.substr(line.find("<mrow>") + 6);
    const std::size_t sign = line.find(equals);
    if (sign == std::string::npos) throw std::runtime_error("no equation: '" + line + "'");
    all.push_back({line.substr(0, sign), line.substr(sign + equals.size())});
    at = last;
  }
  return all;
}

/// What follows "with" in a document: name, value and unit of each parameter.
struct Given {
  std::string name, value, unit;
};
std::vector<Given> parametersIn(const std::string& document, Style style) {
  const bool latex = style == Style::kLatex, html = style == Style::kMathml;
  const std::string begin = latex  ? "{\\small with "
                            : html ? "<p class=\"values\">with "
                                   : "\n   with ",
                    end = latex  ? ".}\n"
                          : html ? "</p>"
                                 : "\n",
                    equals = html ? "<mo>=</mo>" : " = ";
  std::vector<Given> all;
  for (std::size_t at = 0; (at = document.find(begin, at)) != std::string::npos;) {
    at += begin.size();
    std::string rest = document.substr(at, document.find(end, at) - at) + ", ";
    for (std::size_t comma; (comma = rest.find(", ")) != std::string::npos;
         rest.erase(0, comma + 2)) {
      std::string one = rest.substr(0, comma), unit;
      const std::string before_unit = latex ? "\\,\\mathrm{" : html ? "</mrow></math>" : "";
      if (latex) one = one.substr(1, one.size() - 2);
      if (html) one = one.substr(std::string("<math><mrow>").size());
      const std::size_t sign = one.find(equals);
      if (sign == std::string::npos) throw std::runtime_error("no value: '" + one + "'");
      std::string value = one.substr(sign + equals.size());
      const std::size_t ends = before_unit.empty() ? value.find(' ') : value.find(before_unit);
      if (ends != std::string::npos) {
        unit = value.substr(ends + std::max<std::size_t>(before_unit.size(), 1));
        value.erase(ends);
      }
      all.push_back({one.substr(0, sign), value, unit});
    }
  }
  return all;
}

/// The entries of a printed matrix, row by row.
std::vector<std::string> cellsOf(const std::string& matrix, Style style) {
  std::vector<std::string> cells;
  if (style == Style::kMathml) {
    const std::string begin = "<mtd>", end = "</mtd>";
    for (std::size_t at = 0; (at = matrix.find(begin, at)) != std::string::npos;) {
      at += begin.size();
      cells.push_back(matrix.substr(at, matrix.find(end, at) - at));
    }
    return cells;
  }
  const bool latex = style == Style::kLatex;
  const std::string open = latex ? "\\begin{pmatrix} " : "[",
                    close = latex ? " \\end{pmatrix}" : "]", row = latex ? " \\\\ " : "; ",
                    column = latex ? " & " : ", ";
  const std::size_t begin = matrix.find(open), end = matrix.find(close);
  if (begin == std::string::npos || end == std::string::npos)
    throw std::runtime_error("no matrix: '" + matrix + "'");
  std::string rest = matrix.substr(begin + open.size(), end - begin - open.size());
  for (std::size_t at; (at = std::min(rest.find(row), rest.find(column))) != std::string::npos;) {
    cells.push_back(rest.substr(0, at));
    rest.erase(0, at + (at == rest.find(row) ? row : column).size());
  }
  cells.push_back(rest);
  return cells;
}

/// One random point, and what the letters of a derivation stand for there.
class Point {
 public:
  Point(const Derivation& derivation, Style style, unsigned seed)
      : derivation_(derivation), style_(style), draw_(seed), vocabulary_(style) {
    const Equations& e = *derivation.equations;
    const DrawnNumbers number(derivation.mechanism, draw_);
    scene::State<Residue> state;
    for (int k = 0; k < std::max(e.positions, e.dof()); ++k) {
      const std::string key = std::to_string(k + 1);
      const Circle point = draw_.circle("q" + key);
      state.x.push_back({draw_.number("q" + key), point.c, point.s});
      vocabulary_.definePosition(spelled(Input::kPosition, k), state.x.back().q, point);
    }
    for (int k = 0; k < e.dof(); ++k) {
      const std::string key = std::to_string(k + 1);
      state.qd.push_back(draw_.number("qd" + key));
      state.qdd.push_back(draw_.number("qdd" + key));
      state.tau.push_back(draw_.number("tau" + key));
      vocabulary_.define(spelled(Input::kVelocity, k), state.qd.back());
      vocabulary_.define(spelled(Input::kAcceleration, k), state.qdd.back());
      vocabulary_.define(spelled(Input::kForce, k), state.tau.back());
      vocabulary_.define(spelled(Input::kDirection, k), directionOf(state.qd.back()));
    }

    std::vector<Node> nodes;
    for (const Step& step : derivation.steps)
      for (const StepEquation& equation : step.equations) {
        for (const std::optional<Node>& side : {equation.left_value, equation.right_value})
          if (side) nodes.push_back(*side);
        nodes.insert(nodes.end(), equation.entries.begin(), equation.entries.end());
      }
    const Program program = compile(e.graph, nodes);
    ProgramRun<Residue> run(program, number);
    values_ = run(state);
    for (std::size_t k = 0; k < program.atoms.size(); ++k)
      defineAtom(program.atoms[k], run.slot(static_cast<int>(program.constants.size() + k)),
                 number);
    for (const Program::Load& load : program.loads)
      if (load.input == Input::kRotation)
        vocabulary_.define(spelled(Input::kRotation, load.joint), run.slot(load.slot));
  }

  /// What a document says of each parameter is its value in the scene.
  void checkParameters(const std::string& document) {
    const scene::ParameterValues values = derivation_.mechanism.parameterValues();
    const Residue pi = draw_.number("pi");
    vocabulary_.define(printName("pi", style_), pi);
    std::map<std::string, scene::Exact> spelled;
    for (const auto& [name, value] : values) spelled[printName(name, style_)] = value;
    std::size_t shown = 0, said = 0;
    for (const Step& step : derivation_.steps) shown += step.parameters.size();
    for (const Given& given : parametersIn(document, style_)) {
      ++said;
      const auto at = spelled.find(given.name);
      if (at == spelled.end() || read(given.value) != Residue::of(at->second.rational) +
                                                          Residue::of(at->second.pi_multiple) * pi)
        throw std::runtime_error(given.name + " = " + given.value + " is no value of the scene");
    }
    if (said != shown) throw std::runtime_error("other parameters than the derivation has");
  }

  /// In the order of the steps' equations, left before right, before the entries of a matrix.
  const std::vector<Residue>& values() const { return values_; }
  Residue read(const std::string& text) const { return Sentence(vocabulary_, text).value(); }
  void define(const std::string& name, Residue value) { vocabulary_.define(name, value); }

 private:
  std::string spelled(Input input, int joint) const {
    return print(derivation_.input(input, joint), style_);
  }
  void defineAtom(const Atom& atom, Residue value, const DrawnNumbers& number) {
    const Formula shown = Formula::ofAtom(atom);
    if (atom.kind == Atom::Kind::kNumber) {
      vocabulary_.define(print(shown, style_), value);
      return;
    }
    Circle point;
    switch (atom.kind) {
      case Atom::Kind::kCosAlpha:
      case Atom::Kind::kSinAlpha:
        point = number.axisTurn(atom.axis).alpha;
        break;
      case Atom::Kind::kCosBeta:
      case Atom::Kind::kSinBeta:
        point = number.axisTurn(atom.axis).beta;
        break;
      default:
        point = number.angle(atom.number);
    }
    vocabulary_.defineAngle(print(shown.operands.front(), style_), point);
  }

  const Derivation& derivation_;
  Style style_;
  Draw draw_;
  Vocabulary vocabulary_;
  std::vector<Residue> values_;
};

}  // namespace

ReadBack readBack(const Derivation& derivation, const std::string& document, Style style) {
  constexpr int kPoints = 2;
  ReadBack result;
  result.points = kPoints;
  for (unsigned seed = 1; seed <= kPoints && result.problem.empty(); ++seed) {
    std::string reading;
    try {
      Point point(derivation, style, seed);
      const std::vector<Sides> printed =
          equationsIn(style == Style::kMathml ? withoutPieces(document) : document, style);
      std::size_t next = 0, value = 0;
      result.formulas = 0;
      for (const Step& step : derivation.steps) {
        for (const StepEquation& equation : step.equations) {
          if (next == printed.size()) throw std::runtime_error("fewer equations than were derived");
          const Sides& sides = printed[next++];
          reading = sides.left;
          const auto check = [&](const std::string& side) {
            ++result.formulas;
            if (point.read(side) != point.values()[value++])
              throw std::runtime_error("says something else");
          };
          if (equation.left_value) check(sides.left);
          if (equation.right_value) check(sides.right);
          if (!equation.entries.empty()) {
            const std::vector<std::string> cells = cellsOf(sides.right, style);
            if (cells.size() != equation.entries.size())
              throw std::runtime_error("is a matrix of another size");
            for (const std::string& cell : cells) check(cell);
          } else if (!equation.left_value) {
            point.define(sides.left, point.read(sides.right));
          }
        }
      }
      reading = "parameters";
      point.checkParameters(document);
      if (next != printed.size()) throw std::runtime_error("more equations than were derived");
    } catch (const std::runtime_error& error) {
      result.problem = reading + ": " + error.what();
    }
  }
  return result;
}

}  // namespace dynwitness::symbolic
