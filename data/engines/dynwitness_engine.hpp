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
//       return engine.testify();
//     }
//
// A function that throws at a state says that the quantity has no value there, and why. engine.scene
// looks at the scene first; it throws to say that you cannot hold it. What you write to std::cout
// would be taken for an answer: use std::cerr.
#pragma once

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
    const char* at = line.c_str();
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
  static void skip(const char*& at) {
    while (*at == ' ' || *at == '\t' || *at == '\r' || *at == '\n') ++at;
  }
  static void take(const char*& at, char expected) {
    skip(at);
    if (*at != expected)
      throw std::runtime_error(std::string("JSON: expected ") + expected + ", got " + *at);
    ++at;
  }
  static std::string string(const char*& at) {
    std::string out;
    take(at, '"');
    for (; *at != '"' && *at != '\0'; ++at) {
      if (*at != '\\') {
        out += *at;
        continue;
      }
      const char kind = *++at;
      if (kind == 'u') {  // dynwitness writes control characters alone in this way
        out += static_cast<char>(std::strtol(std::string(at + 1, at + 5).c_str(), nullptr, 16));
        at += 4;
      } else {
        out += kind == 'n'   ? '\n'
               : kind == 't' ? '\t'
               : kind == 'r' ? '\r'
               : kind == 'b' ? '\b'
               : kind == 'f' ? '\f'
                             : kind;
      }
    }
    take(at, '"');
    return out;
  }
  static Json read(const char*& at) {
    Json out;
    skip(at);
    if (*at == '{' || *at == '[') {
      const char close = *at == '{' ? '}' : ']';
      ++at;
      skip(at);
      while (*at != close) {
        if (close == '}') {
          skip(at);
          const std::string key = string(at);
          take(at, ':');
          out.members_[key] = read(at);
        } else {
          out.elements_.push_back(read(at));
        }
        skip(at);
        if (*at != close) take(at, ',');
      }
      ++at;
    } else if (*at == '"') {
      out.text_ = string(at);
    } else if (*at == 't' || *at == 'f' || *at == 'n') {
      out.number_ = *at == 't';
      while (*at >= 'a' && *at <= 'z') ++at;
    } else {
      char* end = nullptr;
      out.number_ = std::strtod(at, &end);
      if (end == at) throw std::runtime_error("JSON: expected a value");
      at = end;
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
struct State {
  Vector q, qd, qdd, tau;
};

class Engine {
 public:
  explicit Engine(std::string name, std::string version = "")
      : name_(std::move(name)), version_(std::move(version)) {}

  std::function<void(const Json& scene)> scene;  ///< may be left empty
  std::vector<std::string> joints;               ///< your order of them; empty: the scene's

  void number(const std::string& quantity, std::function<double(const State&)> f) {
    known_[quantity] = [f](const State& s) { return written(f(s)); };
  }
  void vector(const std::string& quantity, std::function<Vector(const State&)> f) {
    known_[quantity] = [f](const State& s) { return written(f(s)); };
  }
  void matrix(const std::string& quantity, std::function<Matrix(const State&)> f) {
    known_[quantity] = [f](const State& s) {
      std::string text;
      for (const Vector& row : f(s)) text += (text.empty() ? "" : ",") + written(row);
      return "[" + text + "]";
    };
  }

  /// Answers until there are no more questions. @return for main()
  int testify() {
    std::ios::sync_with_stdio(false);
    for (std::string line; std::getline(std::cin, line);) {
      const Json asked = Json::parsed(line);
      std::cout << (asked.has("scene") ? introduction(asked["scene"]) : answers(asked))
                << std::endl;
    }
    return 0;
  }

 private:
  static std::string written(double x) {
    if (!std::isfinite(x)) throw std::runtime_error("not finite");
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", x);
    return text;
  }
  static std::string written(const Vector& v) {
    std::string text;
    for (const double x : v) text += (text.empty() ? "" : ",") + written(x);
    return "[" + text + "]";
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
    try {
      if (scene) scene(asked);
    } catch (const std::exception& reason) {
      return said + ",\"refuses\":" + quoted(reason.what()) + "}";
    }
    std::string quantities, names;
    for (const auto& one : known_)
      quantities += (quantities.empty() ? "" : ",") + quoted(one.first);
    for (const std::string& joint : joints) names += (names.empty() ? "" : ",") + quoted(joint);
    if (!joints.empty()) said += ",\"joints\":[" + names + "]";
    return said + ",\"quantities\":[" + quantities + "]}";
  }
  std::string answers(const Json& asked) const {
    std::string all;
    for (std::size_t k = 0; k < asked["states"].size(); ++k) {
      const Json& given = asked["states"][k];
      const State state = {given["q"].numbers(), given["qd"].numbers(), given["qdd"].numbers(),
                           given["tau"].numbers()};
      std::string one;
      for (std::size_t i = 0; i < asked["quantities"].size(); ++i) {
        const std::string& quantity = asked["quantities"][i].text();
        std::string value;
        try {
          value = known_.at(quantity)(state);
        } catch (const std::exception& reason) {
          value = quoted(reason.what());
        }
        one += (one.empty() ? "" : ",") + quoted(quantity) + ":" + value;
      }
      all += std::string(all.empty() ? "" : ",") + "{" + one + "}";
    }
    return "{\"batch\":" + written(asked["batch"].number()) + ",\"answers\":[" + all + "]}";
  }

  std::string name_, version_;
  std::map<std::string, std::function<std::string(const State&)>> known_;
};

}  // namespace dynwitness_engine
