// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/formula.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <set>

namespace dynwitness::symbolic {

Formula Formula::ofNumber(const Rational& value) {
  if (value < 0) return negate(ofNumber(-value));
  Formula f;
  f.number = value;
  return f;
}

Formula Formula::ofSymbol(const std::string& name) {
  Formula f;
  f.kind = Kind::kSymbol;
  f.symbol = name;
  return f;
}

Formula Formula::ofInput(Input input, int joint) {
  Formula f;
  f.kind = Kind::kInput;
  f.input = input;
  f.joint = joint;
  return f;
}

Formula Formula::sum(std::vector<Formula> terms) {
  if (terms.empty()) return ofNumber(0);
  if (terms.size() == 1) return terms.front();
  Formula f;
  f.kind = Kind::kSum;
  // only the first operand is opened: a - (b - c) keeps its order of evaluation
  if (terms.front().kind == Kind::kSum) f.operands = terms.front().operands;
  f.operands.insert(f.operands.end(), terms.begin() + (f.operands.empty() ? 0 : 1), terms.end());
  return f;
}

Formula Formula::product(std::vector<Formula> factors) {
  Formula f;
  f.kind = Kind::kProduct;
  bool negative = false;
  for (Formula& factor : factors) {
    if (factor.kind == Kind::kNegate) {
      negative = !negative;
      factor = Formula(factor.operands.front());
    }
    if (factor.kind == Kind::kNumber && factor.number == 1) continue;
    if (factor.kind == Kind::kProduct && f.operands.empty())
      f.operands = factor.operands;
    else
      f.operands.push_back(factor);
  }
  if (f.operands.empty()) f = ofNumber(1);
  if (f.operands.size() == 1) f = Formula(f.operands.front());
  return negative ? negate(f) : f;
}

Formula Formula::negate(Formula operand) {
  if (operand.kind == Kind::kNegate) return operand.operands.front();
  Formula f;
  f.kind = Kind::kNegate;
  f.operands = {std::move(operand)};
  return f;
}

Formula Formula::power(Formula base, int exponent) {
  if (exponent == 1) return base;
  Formula f;
  f.kind = Kind::kPower;
  f.exponent = exponent;
  f.operands = {std::move(base)};
  return f;
}

Formula Formula::quotient(Formula dividend, Formula divisor) {
  Formula f;
  f.kind = Kind::kQuotient;
  f.operands = {std::move(dividend), std::move(divisor)};
  return f;
}

Formula Formula::function(Kind cos_or_sin, Formula angle) {
  Formula f;
  f.kind = cos_or_sin;
  f.operands = {std::move(angle)};
  return f;
}

Formula Formula::matrix(std::vector<Formula> entries, std::size_t columns) {
  Formula f;
  f.kind = Kind::kMatrix;
  f.operands = std::move(entries);
  f.columns = columns;
  return f;
}

namespace {

/// Formulas as the algebra in which scene::evaluateIn writes an expression down.
struct Written {
  Formula f;
  friend Written operator+(const Written& a, const Written& b) {
    return {Formula::sum({a.f, b.f})};
  }
  friend Written operator-(const Written& a, const Written& b) {
    return {Formula::sum({a.f, Formula::negate(b.f)})};
  }
  friend Written operator*(const Written& a, const Written& b) {
    return {Formula::product({a.f, b.f})};
  }
  friend Written operator/(const Written& a, const Written& b) {
    if (b.f.kind == Formula::Kind::kNumber && b.f.number != 0)
      return {Formula::product({Formula::ofNumber(1 / b.f.number), a.f})};
    return {Formula::product({a.f, Formula::power(b.f, -1)})};
  }
  Written operator-() const { return {Formula::negate(f)}; }
};
struct WritingAlgebra {
  Written number(const Rational& r) const { return {Formula::ofNumber(r)}; }
  Written parameter(const std::string& name) const { return {Formula::ofSymbol(name)}; }
  Written pi() const { return {Formula::ofSymbol("pi")}; }
};

}  // namespace

Formula Formula::ofExpression(const scene::Number& expression) {
  return scene::evaluateIn<Written>(expression, WritingAlgebra{}).f;
}

Formula Formula::ofAtom(const Atom& atom) {
  // the angles of an axis have no expression; their name stands in the parentheses
  const auto label = [&atom] { return ofSymbol(atom.name.substr(4, atom.name.size() - 5)); };
  switch (atom.kind) {
    case Atom::Kind::kNumber:
      return ofSymbol(atom.name);
    case Atom::Kind::kCos:
      return function(Kind::kCos, ofExpression(atom.number));
    case Atom::Kind::kSin:
      return function(Kind::kSin, ofExpression(atom.number));
    case Atom::Kind::kCosAlpha:
    case Atom::Kind::kCosBeta:
      return function(Kind::kCos, label());
    case Atom::Kind::kSinAlpha:
    case Atom::Kind::kSinBeta:
      return function(Kind::kSin, label());
  }
  return {};
}

std::string identifier(const std::string& parameter) {
  std::string id = "p_";
  for (char ch : parameter) {
    if (std::isalnum(static_cast<unsigned char>(ch)) || ch == '_')
      id += ch;
    else
      id += "_" + std::to_string(static_cast<int>(static_cast<unsigned char>(ch))) + "_";
  }
  return id;
}

namespace {

struct Greek {
  const char *name, *html;
};
// LaTeX knows these names with a backslash
constexpr std::array<Greek, 33> kGreek = {{
    {"alpha", "&#x3b1;"},   {"beta", "&#x3b2;"},  {"gamma", "&#x3b3;"},   {"delta", "&#x3b4;"},
    {"epsilon", "&#x3f5;"}, {"zeta", "&#x3b6;"},  {"eta", "&#x3b7;"},     {"theta", "&#x3b8;"},
    {"iota", "&#x3b9;"},    {"kappa", "&#x3ba;"}, {"lambda", "&#x3bb;"},  {"mu", "&#x3bc;"},
    {"nu", "&#x3bd;"},      {"xi", "&#x3be;"},    {"pi", "&#x3c0;"},      {"rho", "&#x3c1;"},
    {"sigma", "&#x3c3;"},   {"tau", "&#x3c4;"},   {"phi", "&#x3d5;"},     {"chi", "&#x3c7;"},
    {"psi", "&#x3c8;"},     {"omega", "&#x3c9;"}, {"upsilon", "&#x3c5;"}, {"Gamma", "&#x393;"},
    {"Delta", "&#x394;"},   {"Theta", "&#x398;"}, {"Lambda", "&#x39b;"},  {"Xi", "&#x39e;"},
    {"Pi", "&#x3a0;"},      {"Sigma", "&#x3a3;"}, {"Phi", "&#x3a6;"},     {"Psi", "&#x3a8;"},
    {"Omega", "&#x3a9;"},
}};

const Greek* findGreek(const std::string& name) {
  for (const Greek& g : kGreek)
    if (name == g.name) return &g;
  return nullptr;
}

std::string latexText(const std::string& text) {
  std::string out;
  for (char ch : text) {
    if (ch == '\\') {
      out += "\\backslash ";
      continue;
    }
    if (ch == '~' || ch == '^') {
      out += std::string("\\") + ch + "{}";
      continue;
    }
    if (std::string("_%$#&{}").find(ch) != std::string::npos) out += '\\';
    out += ch;
  }
  return out;
}

std::string xmlText(const std::string& text) {
  std::string out;
  for (char ch : text) {
    if (ch == '<')
      out += "&lt;";
    else if (ch == '>')
      out += "&gt;";
    else if (ch == '&')
      out += "&amp;";
    else
      out += ch;
  }
  return out;
}

/// A name taken apart: the letter that is shown large, and its subscript.
struct NameParts {
  std::string head, subscript;
};

NameParts parts(const std::string& name) {
  std::size_t letters = 0;
  while (letters < name.size() && std::isalpha(static_cast<unsigned char>(name[letters])))
    ++letters;
  std::string head = name.substr(0, letters), rest = name.substr(letters);
  for (char& ch : rest)
    if (ch == '_') ch = ' ';
  while (!rest.empty() && rest.front() == ' ') rest.erase(0, 1);
  while (!rest.empty() && rest.back() == ' ') rest.pop_back();
  // lc1 is the l of c1, and Ixx the I of xx; longer words are words
  if (!findGreek(head) && (head.size() == 2 || head.size() == 3)) {
    rest = head.substr(1) + rest;
    head = head.substr(0, 1);
  }
  if (head.empty()) return {name, ""};
  return {head, rest};
}

std::string latexHead(const std::string& head) {
  return findGreek(head)    ? "\\" + head
         : head.size() == 1 ? head
                            : "\\mathit{" + latexText(head) + "}";
}

std::string latexSubscript(const std::string& text) {
  if (text.empty()) return "";
  const bool is_word = text.find_first_not_of("0123456789") != std::string::npos;
  std::string subscript = latexText(text);
  if (is_word && text.size() > 2) subscript = "\\mathrm{" + subscript + "}";
  for (std::size_t i = 0; (i = subscript.find(' ', i)) != std::string::npos; i += 2)
    subscript.replace(i, 1, "\\,");
  return "_{" + subscript + "}";
}

std::string latexName(const std::string& name) {
  const NameParts p = parts(name);
  return latexHead(p.head) + latexSubscript(p.subscript);
}

std::string mathmlIdentifier(const std::string& head) {
  const Greek* greek = findGreek(head);
  return "<mi>" + (greek ? std::string(greek->html) : xmlText(head)) + "</mi>";
}

std::string mathmlSubscript(const std::string& subscript) {
  const bool is_number = subscript.find_first_not_of("0123456789") == std::string::npos;
  const std::string tag = is_number ? "mn" : "mi";
  return "<" + tag + ">" + xmlText(subscript) + "</" + tag + ">";
}

std::string mathmlName(const std::string& name) {
  const NameParts p = parts(name);
  if (p.subscript.empty()) return mathmlIdentifier(p.head);
  return "<msub>" + mathmlIdentifier(p.head) + mathmlSubscript(p.subscript) + "</msub>";
}

bool isDecimal(const Rational& r) {
  scene::Integer d = denominator(r);
  while (d % 2 == 0) d /= 2;
  while (d % 5 == 0) d /= 5;
  return d == 1;
}

/// A terminating decimal, exactly.
std::string decimal(const Rational& r) {
  scene::Integer n = numerator(r), d = denominator(r);
  std::string text = scene::Integer(n / d).str();
  n %= d;
  if (n != 0) text += ".";
  while (n != 0) {
    n *= 10;
    text += scene::Integer(n / d).str();
    n %= d;
  }
  return text;
}

/// Prints a Formula; the four notations differ in the leaves and in how operands are joined.
class Printer {
 public:
  explicit Printer(Style style) : style_(style) {}

  /// Binding strength: sum 1, product 2, power 3, everything else 4.
  int strength(const Formula& f) const {
    switch (f.kind) {
      case Formula::Kind::kSum:
      case Formula::Kind::kNegate:
        return 1;
      case Formula::Kind::kProduct:
        return 2;
      case Formula::Kind::kQuotient:
        return isCode() ? 4 : 2;
      case Formula::Kind::kPower:
        return isCode() ? 4 : f.exponent > 0 ? 3 : 2;  // (x*x) in code
      case Formula::Kind::kNumber:
        return isFraction(f.number) && (style_ == Style::kText) ? 2 : 4;
      default:
        return 4;
    }
  }

  std::string at(const Formula& f, int needed) const {
    const std::string text = print(f);
    return strength(f) < needed ? parenthesised(text) : text;
  }

  std::string print(const Formula& f) const {
    switch (f.kind) {
      case Formula::Kind::kNumber:
        return number(f.number);
      case Formula::Kind::kSymbol:
        return printName(f.symbol, style_);
      case Formula::Kind::kInput:
        return input(f);
      case Formula::Kind::kNegate:
        return op(isCode() || style_ == Style::kText || style_ == Style::kLatex ? "-" : "&#x2212;",
                  "", "") +
               at(f.operands.front(), 2);
      case Formula::Kind::kSum:
        return sum(f);
      case Formula::Kind::kProduct:
        return product(f);
      case Formula::Kind::kPower:
        return power(f);
      case Formula::Kind::kQuotient:
        return quotient(f);
      case Formula::Kind::kCos:
        return function("cos", f.operands.front(), 1);
      case Formula::Kind::kSin:
        return function("sin", f.operands.front(), 1);
      case Formula::Kind::kMatrix:
        return matrix(f);
    }
    return "";
  }

 private:
  bool isCode() const {
    return style_ == Style::kC || style_ == Style::kPython || style_ == Style::kSympy;
  }
  bool isFraction(const Rational& r) const {
    return denominator(r) != 1 && (denominator(r) <= 12 || !isDecimal(r));
  }

  /// An operator between operands: spaces are for the plain notations.
  std::string op(const std::string& sign, const std::string& before,
                 const std::string& after) const {
    return style_ == Style::kMathml ? "<mo>" + sign + "</mo>" : before + sign + after;
  }

  std::string parenthesised(const std::string& text) const {
    switch (style_) {
      case Style::kLatex:  // \left( is a group, in which TeX breaks no line
        return text.find("\\frac{") != std::string::npos ? "\\bigl(" + text + "\\bigr)"
                                                         : "(" + text + ")";
      case Style::kMathml:
        return "<mrow><mo>(</mo>" + text + "<mo>)</mo></mrow>";
      default:
        return "(" + text + ")";
    }
  }

  std::string number(const Rational& r) const {
    if (style_ == Style::kSympy)
      return denominator(r) == 1
                 ? r.str()
                 : "Rational(" + numerator(r).str() + ", " + denominator(r).str() + ")";
    if (isCode()) {
      std::array<char, 40> text;
      const auto end =
          std::to_chars(text.data(), text.data() + text.size(), scene::Exact{r, 0}.toDouble());
      std::string literal(text.data(), end.ptr);
      if (literal.find_first_of(".e") == std::string::npos) literal += ".0";
      return literal;
    }
    if (!isFraction(r))
      return style_ == Style::kMathml ? "<mn>" + decimal(r) + "</mn>" : decimal(r);
    const std::string n = numerator(r).str(), d = denominator(r).str();
    switch (style_) {
      case Style::kLatex:
        return "\\tfrac{" + n + "}{" + d + "}";
      case Style::kMathml:
        return "<mfrac><mn>" + n + "</mn><mn>" + d + "</mn></mfrac>";
      default:
        return n + "/" + d;
    }
  }

  /// The position that an input is a function or a rate of.
  static Formula ofPosition(const Formula& f) {
    Formula position = Formula::ofInput(Input::kPosition, f.joint);
    position.symbol = f.symbol;
    return position;
  }

  std::string input(const Formula& f) const {
    const std::string k = std::to_string(f.joint + 1);
    if (isCode()) {
      switch (f.input) {
        case Input::kPosition:
          return "q" + k;
        case Input::kCos:
          return "c" + k;
        case Input::kSin:
          return "s" + k;
        case Input::kVelocity:
          return "qd" + k;
        case Input::kAcceleration:
          return "qdd" + k;
        case Input::kForce:
          return "tau" + k;
        case Input::kDirection:
          return "sign_qd" + k;
        case Input::kRotation:
          return rotation(f.joint);
      }
    }
    switch (f.input) {
      case Input::kPosition:
        return printName(f.symbol.empty() ? "q" + k : f.symbol, style_);
      case Input::kCos:
        return function("cos", ofPosition(f), 1);
      case Input::kSin:
        return function("sin", ofPosition(f), 1);
      case Input::kVelocity:
        return dotted(f, 1);
      case Input::kAcceleration:
        return dotted(f, 2);
      case Input::kForce:
        return printName("tau" + k, style_);
      case Input::kDirection: {
        Formula rate = Formula::ofInput(Input::kVelocity, f.joint);
        rate.symbol = f.symbol;
        return function(style_ == Style::kLatex ? "operatorname{sign}" : "sign", rate, 1, true);
      }
      case Input::kRotation:
        return printName(rotation(f.joint), style_);
    }
    return "";
  }

  /// "R4_23": row 2, column 3 of the rotation whose quaternion starts at q4.
  static std::string rotation(int entry) {
    return "R" + std::to_string(entry / 9 + 1) + "_" + std::to_string(entry % 9 / 3 + 1) +
           std::to_string(entry % 3 + 1);
  }

  std::string dotted(const Formula& f, int dots) const {
    const NameParts p = parts(f.symbol.empty() ? "q" + std::to_string(f.joint + 1) : f.symbol);
    switch (style_) {
      case Style::kLatex:
        return std::string(dots == 1 ? "\\dot" : "\\ddot") + "{" + latexHead(p.head) + "}" +
               latexSubscript(p.subscript);
      case Style::kMathml: {
        // dots as operators: browsers set the accents U+02D9 and U+00A8 onto the letter itself
        const std::string head = "<mover>" + mathmlIdentifier(p.head) + "<mo>" +
                                 (dots == 1 ? "&#x22c5;" : "&#x22c5;&#x22c5;") + "</mo></mover>";
        return p.subscript.empty() ? head
                                   : "<msub>" + head + mathmlSubscript(p.subscript) + "</msub>";
      }
      default:
        if (!f.symbol.empty()) return f.symbol + (dots == 1 ? "_dot" : "_ddot");
        return (dots == 1 ? "qd" : "qdd") + std::to_string(f.joint + 1);
    }
  }

  std::string sum(const Formula& f) const {
    std::string text;
    for (const Formula& term : f.operands) {
      const bool negative = term.kind == Formula::Kind::kNegate;
      const Formula& shown = negative ? term.operands.front() : term;
      // after a sign, a sum needs parentheses
      const std::string operand = text.empty() && !negative ? print(shown) : at(shown, 2);
      if (!text.empty() || negative) {
        const std::string minus = style_ == Style::kMathml ? "&#x2212;" : "-";
        text += text.empty() ? op(minus, "", "") : op(negative ? minus : "+", " ", " ");
      }
      text += operand;
    }
    return style_ == Style::kMathml ? "<mrow>" + text + "</mrow>" : text;
  }

  std::string product(const Formula& f) const {
    std::string text;
    for (std::size_t i = 0; i < f.operands.size(); ++i) {
      const Formula& factor = f.operands[i];
      if (!text.empty()) {
        switch (style_) {
          case Style::kLatex:
            text += " ";
            break;
          case Style::kMathml:
            text += "<mo>&#x2062;</mo>";
            break;
          default:
            text += "*";
            break;
        }
        // two numerals side by side would read as one
        if (factor.kind == Formula::Kind::kNumber && style_ == Style::kLatex) text += "\\cdot ";
      }
      // a*(b*c) keeps its order of evaluation, and a*(1/b) is no a*1/b
      const bool divides = factor.kind == Formula::Kind::kPower && factor.exponent < 0;
      const bool nested = factor.kind == Formula::Kind::kProduct && isCode() && !text.empty();
      // cos q1 x2 would be read as cos(q1 x2)
      const Formula* called =
          style_ == Style::kLatex || style_ == Style::kMathml ? calledIn(factor) : nullptr;
      text +=
          called && i + 1 < f.operands.size()
              ? function(*called, factor.kind == Formula::Kind::kPower ? factor.exponent : 1, true)
              : at(factor, nested                              ? 4
                           : divides && style_ == Style::kText ? 3
                                                               : 2);
    }
    return style_ == Style::kMathml ? "<mrow>" + text + "</mrow>" : text;
  }

  std::string quotient(const Formula& f) const {
    const Formula &dividend = f.operands[0], &divisor = f.operands[1];
    switch (style_) {
      case Style::kLatex:
        return "\\frac{" + print(dividend) + "}{" + print(divisor) + "}";
      case Style::kMathml:
        return "<mfrac><mrow>" + print(dividend) + "</mrow><mrow>" + print(divisor) +
               "</mrow></mfrac>";
      case Style::kText:
        return at(dividend, 2) + "/" + at(divisor, 3);
      default:
        return "(" + at(dividend, 4) + "/" + at(divisor, 4) + ")";
    }
  }

  std::string power(const Formula& f) const {
    const Formula& base = f.operands.front();
    const int n = f.exponent < 0 ? -f.exponent : f.exponent;
    if (isCode()) {
      std::string text = at(base, 4);
      const std::string factor = text;
      for (int i = 1; i < n; ++i) text += "*" + factor;
      if (f.exponent < 0)
        return (style_ == Style::kSympy ? "(1/" : "(1.0/") + (n > 1 ? "(" + text + ")" : text) +
               ")";
      return "(" + text + ")";
    }
    std::string text;
    if (n == 1) {
      text = at(base, style_ == Style::kText ? 4 : 1);
    } else if (const Formula* called = calledIn(base)) {
      text = function(*called, n, false);
    } else {
      const std::string e = std::to_string(n);
      switch (style_) {
        case Style::kLatex:
          text = "{" + at(base, 4) + "}^{" + e + "}";
          break;
        case Style::kMathml:
          text = "<msup><mrow>" + at(base, 4) + "</mrow><mn>" + e + "</mn></msup>";
          break;
        default:
          text = at(base, 4) + "^" + e;
          break;
      }
    }
    if (f.exponent > 0) return text;
    switch (style_) {
      case Style::kLatex:
        return "\\frac{1}{" + text + "}";
      case Style::kMathml:
        return "<mfrac><mn>1</mn><mrow>" + text + "</mrow></mfrac>";
      default:
        return "1/" + text;
    }
  }

  /// The cosine or sine that a factor is, or a positive power of; null: another factor.
  static const Formula* calledIn(const Formula& factor) {
    const bool is_power = factor.kind == Formula::Kind::kPower && factor.exponent > 0;
    const Formula& f = is_power ? factor.operands.front() : factor;
    const bool is_function =
        f.kind == Formula::Kind::kCos || f.kind == Formula::Kind::kSin ||
        (f.kind == Formula::Kind::kInput && (f.input == Input::kCos || f.input == Input::kSin));
    return is_function ? &f : nullptr;
  }

  /// A cosine or sine. @param closed  in parentheses even around a bare letter
  std::string function(const Formula& f, int exponent, bool closed) const {
    const bool is_input = f.kind == Formula::Kind::kInput;
    const bool is_cos = is_input ? f.input == Input::kCos : f.kind == Formula::Kind::kCos;
    const Formula angle = is_input ? ofPosition(f) : f.operands.front();
    return function(is_cos ? "cos" : "sin", angle, exponent, closed);
  }

  std::string matrix(const Formula& f) const {
    std::string text;
    for (std::size_t i = 0; i < f.operands.size(); ++i) {
      const bool first = i % f.columns == 0;
      const std::string entry = print(f.operands[i]);
      switch (style_) {
        case Style::kLatex:
          text += (i == 0 ? "" : first ? " \\\\ " : " & ") + entry;
          break;
        case Style::kMathml:
          text += (i > 0 && first ? "</mtr>" : "") + std::string(first ? "<mtr>" : "") + "<mtd>" +
                  entry + "</mtd>";
          break;
        default:
          text += (i == 0 ? "" : first ? "; " : ", ") + entry;
      }
    }
    switch (style_) {
      case Style::kLatex:
        return "\\begin{pmatrix} " + text + " \\end{pmatrix}";
      case Style::kMathml:
        return "<mrow><mo>(</mo><mtable>" + text + "</mtr></mtable><mo>)</mo></mrow>";
      default:
        return "[" + text + "]";
    }
  }

  std::string function(const std::string& name, const Formula& angle, int exponent,
                       bool closed = false) const {
    const std::string argument = print(angle);
    const std::string e = std::to_string(exponent);
    const bool bare = !closed && angle.kind == Formula::Kind::kInput;
    switch (style_) {
      case Style::kLatex:
        return "\\" + name + (exponent > 1 ? "^{" + e + "}" : "") +
               (bare ? " " + argument : parenthesised(argument));
      case Style::kMathml: {
        const std::string head = exponent > 1
                                     ? "<msup><mi>" + name + "</mi><mn>" + e + "</mn></msup>"
                                     : "<mi>" + name + "</mi>";
        // browsers set l cos q as lcosq
        const std::string space = "<mspace width=\"0.17em\"></mspace>";
        return "<mrow>" + space + head + "<mo>&#x2061;</mo>" +
               (bare ? space + argument : parenthesised(argument)) + "</mrow>";
      }
      default:
        return name + "(" + argument + ")" + (exponent > 1 ? "^" + e : "");
    }
  }

  Style style_;
};

}  // namespace

std::string printName(const std::string& name, Style style) {
  switch (style) {
    case Style::kLatex:
      return latexName(name);
    case Style::kMathml:
      return mathmlName(name);
    default:
      return name;
  }
}

std::string print(const Formula& formula, Style style) {
  return Printer(style).print(formula);
}

std::string print(const Equation& equation, Style style) {
  const std::string left = print(equation.left, style), right = print(equation.right, style);
  if (style == Style::kMathml)
    return "<math xmlns=\"http://www.w3.org/1998/Math/MathML\" display=\"block\"><mrow>" + left +
           "<mo>=</mo>" + right + "</mrow></math>";
  return left + " = " + right;
}

}  // namespace dynwitness::symbolic
