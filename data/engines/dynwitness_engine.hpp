// SPDX-License-Identifier: Apache-2.0
// Your dynamics code as a witness of dynwitness (crosscheck/witnesses/engine_protocol.md): this
// file and the standard library are all that it takes.
//
//     #include "dynwitness_engine.hpp"
//     using namespace dynwitness_engine;
//
//     int main() {
//       Engine engine("my_arm", "1");
//       engine.matrix("M", [](const State& s) { return Matrix{{...}, {...}}; });
//       engine.vector("tau", [](const State& s) { return Vector{...}; });   // s.q, s.qd, s.qdd
//       engine.number("potential", [](const State& s) { return ...; });
//       engine.matrix("reactions", ...);                          // six numbers a link but the root
//       engine.matrix("jacobian", ...);                           // of s.frame, six rows
//       engine.model = [] { return std::vector<Body>{...}; };     // what you take the links to be
//       return engine.testify();
//     }
//
// A function that throws at a state says that the quantity has no value there, and why. engine.scene
// looks at the scene first; it throws to say that you cannot hold it. What you write to std::cout
// would be taken for an answer: use std::cerr.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace dynwitness_engine {

/// What a line of JSON says. Missing members and elements throw std::out_of_range.
class Json {
 public:
  static Json parsed(const std::string& line) {
    Cursor at{line.data(), line.data() + line.size()};
    return read(at);
  }
  bool has(const std::string& key) const { return members_.count(key) == 1; }
  const Json& operator[](const std::string& key) const { return members_.at(key); }
  const Json& operator[](std::size_t i) const { return elements_.at(i); }
  std::size_t size() const { return elements_.size(); }
  double number() const { return number_; }  ///< true is 1
  const std::string& text() const { return text_; }
  std::vector<double> numbers() const {
    std::vector<double> out;
    for (const Json& element : elements_) out.push_back(element.number_);
    return out;
  }

 private:
  friend class Engine;
  struct Cursor {
    const char *at, *end;
    char operator*() const { return at < end ? *at : '\0'; }
  };

  static void skip(Cursor& c) {
    while (*c == ' ' || *c == '\t' || *c == '\r' || *c == '\n') ++c.at;
  }
  static void take(Cursor& c, char expected) {
    skip(c);
    if (*c != expected)
      throw std::runtime_error(std::string("JSON: expected ") + expected + ", got " + *c);
    ++c.at;
  }
  static std::string string(Cursor& c) {
    std::string out;
    take(c, '"');
    for (; *c != '"' && c.at < c.end; ++c.at) {
      if (*c != '\\') {
        out += *c;
        continue;
      }
      ++c.at;
      const char kind = *c;
      if (kind == 'u') {  // dynwitness writes control characters alone in this way
        if (c.end - c.at < 5) throw std::runtime_error("JSON: expected four digits");
        out += static_cast<char>(std::strtol(std::string(c.at + 1, c.at + 5).c_str(), nullptr, 16));
        c.at += 4;
      } else {
        out += kind == 'n'   ? '\n'
               : kind == 't' ? '\t'
               : kind == 'r' ? '\r'
               : kind == 'b' ? '\b'
               : kind == 'f' ? '\f'
                             : kind;
      }
    }
    take(c, '"');
    return out;
  }
  static double number(Cursor& c) {
    double x = 0;
#if defined(__cpp_lib_to_chars)
    const char* const after = std::from_chars(c.at, c.end, x).ptr;
#else
    char* after = nullptr;
    x = std::strtod(c.at, &after);
#endif
    if (after == c.at) throw std::runtime_error("JSON: expected a value");
    c.at = after;
    return x;
  }
  /// Calls one(key) in front of every value of an object, one("") of a list.
  template <typename One>
  static void each(Cursor& c, const One& one) {
    skip(c);
    const bool has_keys = *c == '{';
    const char close = has_keys ? '}' : ']';
    take(c, has_keys ? '{' : '[');
    skip(c);
    while (*c != close) {
      std::string key;
      if (has_keys) {
        skip(c);
        key = string(c);
        take(c, ':');
      }
      skip(c);
      one(key);
      skip(c);
      if (*c != close) take(c, ',');
    }
    ++c.at;
  }
  static Json read(Cursor& c) {
    Json out;
    skip(c);
    if (*c == '{') {
      each(c, [&](const std::string& key) { out.members_[key] = read(c); });
    } else if (*c == '[') {
      each(c, [&](const std::string&) { out.elements_.push_back(read(c)); });
    } else if (*c == '"') {
      out.text_ = string(c);
    } else if (*c == 't' || *c == 'f' || *c == 'n') {
      out.number_ = *c == 't';
      while (*c >= 'a' && *c <= 'z') ++c.at;
    } else {
      out.number_ = number(c);
    }
    return out;
  }

  double number_ = 0;
  std::string text_;
  std::vector<Json> elements_;
  std::map<std::string, Json> members_;
};

using Vector = std::vector<double>;
using Matrix = std::vector<Vector>;
struct Frame {
  std::size_t link = 0;  ///< an index into the scene's links
  Vector at;             ///< a point of it, in its axes
};
struct State {
  Vector q, qd, qdd, tau;
  Frame frame;  ///< whose Jacobian is asked; nobody's where none is
};
struct Body {
  std::string link;  ///< its name in the scene
  double mass;
  Vector com;      ///< in link axes
  Matrix inertia;  ///< about com, in link axes
};

class Engine {
 public:
  explicit Engine(std::string name, std::string version = "")
      : name_(std::move(name)), version_(std::move(version)) {}

  std::function<void(const Json& scene)> scene;  ///< may be left empty
  std::vector<std::string> joints;               ///< your order of them; empty: the scene's
  std::string quaternion = "wxyz";               ///< or "xyzw", if that is your order
  std::function<std::vector<Body>()> model;      ///< called after `scene`; may be left empty
  /// As a reader of scene["file"] (engine_protocol.md, "Readers"): JSON of what you have read.
  std::string shows;

  void number(const std::string& quantity, std::function<double(const State&)> f) {
    known_[quantity] = [f](const State& s, std::string& to) { write(f(s), to); };
  }
  void vector(const std::string& quantity, std::function<Vector(const State&)> f) {
    known_[quantity] = [f](const State& s, std::string& to) { write(f(s), to); };
  }
  void matrix(const std::string& quantity, std::function<Matrix(const State&)> f) {
    known_[quantity] = [f](const State& s, std::string& to) { write(f(s), to); };
  }

  /// Answers until there are no more questions. @return for main()
  int testify() {
    std::ios::sync_with_stdio(false);
    for (std::string line; std::getline(std::cin, line);)
      std::cout << (line.find("\"scene\"") != std::string::npos ? introduction(Json::parsed(line))
                                                                : answers(line))
                << std::endl;
    return 0;
  }

 private:
  using Known = std::function<void(const State&, std::string&)>;

  static void write(double x, std::string& to) {
    if (!std::isfinite(x)) throw std::runtime_error("not finite");
    char text[32];
#if defined(__cpp_lib_to_chars)
    to.append(text, std::to_chars(text, text + sizeof text, x).ptr);  // the same double when read
#else
    std::snprintf(text, sizeof text, "%.17g", x);
    to += text;
#endif
  }
  template <typename T>
  static void write(const std::vector<T>& list, std::string& to) {
    to += '[';
    for (const T& x : list) {
      if (&x != &list.front()) to += ',';
      write(x, to);
    }
    to += ']';
  }
  static std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
      if (c == '"' || c == '\\') out += '\\';
      out += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
    return out + "\"";
  }

  std::string introduction(const Json& asked) const {
    std::string said =
        "{\"protocol\":1,\"name\":" + quoted(name_) + ",\"version\":" + quoted(version_);
    std::string bodies;
    try {
      if (scene) scene(asked["scene"]);
      if (model) bodies = written(model());
    } catch (const std::exception& reason) {
      return said + ",\"refuses\":" + quoted(reason.what()) + "}";
    }
    std::string quantities, names;
    for (const auto& one : known_)
      if (isAsked(asked, one.first))
        quantities += (quantities.empty() ? "" : ",") + quoted(one.first);
    for (const std::string& joint : joints) names += (names.empty() ? "" : ",") + quoted(joint);
    if (!joints.empty()) said += ",\"joints\":[" + names + "]";
    if (!shows.empty()) said += ",\"shows\":" + shows;
    if (quaternion != "wxyz") said += ",\"quaternion\":" + quoted(quaternion);
    if (model) said += ",\"model\":" + bodies;
    return said + ",\"quantities\":[" + quantities + "]}";
  }

  /// Whether the program that asks knows the word.
  static bool isAsked(const Json& asked, const std::string& quantity) {
    if (!asked.has("asks")) return true;
    for (const Json& word : asked["asks"].elements_)
      if (word.text() == quantity) return true;
    return false;
  }
  static std::string written(const std::vector<Body>& bodies) {
    std::string out = "[";
    for (const Body& body : bodies) {
      out += (out.size() > 1 ? ",{\"link\":" : "{\"link\":") + quoted(body.link) + ",\"mass\":";
      write(body.mass, out);
      out += ",\"com\":";
      write(body.com, out);
      out += ",\"inertia\":";
      write(body.inertia, out);
      out += '}';
    }
    return out + "]";
  }

  /// A batch is read as it stands: a tree of it takes longer than most engines' answers.
  std::string answers(const std::string& line) const {
    Json::Cursor c{line.data(), line.data() + line.size()};
    double batch = 0;
    std::vector<std::pair<std::string, const Known*>> asked;
    std::vector<State> states;
    Frame frame;
    const auto readState = [&] {
      states.emplace_back();
      State& s = states.back();
      s.frame = frame;
      if (states.size() > 1) {
        const std::size_t slots = states[states.size() - 2].q.size();
        for (Vector* part : {&s.q, &s.qd, &s.qdd, &s.tau}) part->reserve(slots);
      }
      Json::each(c, [&](const std::string& key) {
        Vector* const to = key == "q"     ? &s.q
                           : key == "qd"  ? &s.qd
                           : key == "qdd" ? &s.qdd
                           : key == "tau" ? &s.tau
                                          : nullptr;
        if (to)
          Json::each(c, [&](const std::string&) { to->push_back(Json::number(c)); });
        else
          Json::read(c);
      });
    };
    Json::each(c, [&](const std::string& key) {
      if (key == "batch") {
        batch = Json::number(c);
      } else if (key == "quantities") {
        for (const Json& one : Json::read(c).elements_)
          asked.emplace_back(quoted(one.text()) + ":", &known_.at(one.text()));
      } else if (key == "frame") {  // comes before the states
        const Json asked_of = Json::read(c);
        frame.link = static_cast<std::size_t>(asked_of["link"].number());
        frame.at = asked_of["at"].numbers();
      } else if (key == "states") {
        Json::each(c, [&](const std::string&) { readState(); });
      } else {
        Json::read(c);
      }
    });
    std::string said = "{\"batch\":";
    write(batch, said);
    said += ",\"answers\":[";
    for (const State& state : states) {
      said += said.back() == '[' ? "{" : ",{";
      for (const auto& [label, function] : asked) {
        if (said.back() != '{') said += ',';
        said += label;
        const std::size_t before = said.size();
        try {
          (*function)(state, said);
        } catch (const std::exception& reason) {
          said.resize(before);
          said += quoted(reason.what());
        }
      }
      said += '}';
    }
    return said + "]}";
  }

  std::string name_, version_;
  std::map<std::string, Known> known_;
};

}  // namespace dynwitness_engine
