// SPDX-License-Identifier: GPL-3.0-or-later
// A law of mechanics: its words, when it applies, and two sides that must be equal, in one struct.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

#include "scene/mechanism.hpp"

namespace dynwitness::crosscheck {

/// How a law is called and whose computations it takes.
struct LawWords {
  const char* name;
  const char* statement;
  const char* quantity;
  const char* left;
  const char* right;
  const char* without_value = "";  ///< what it means that its sides have none
};

/// What must be equal, or why there is nothing to compare: then both sides are empty.
template <typename T>
struct TwoSides {
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> left, right;
  std::string failure = {};
  bool is_idle = false;  ///< nothing is to be asked here, as `failure` says: no division failed
};

/** A law is a struct of this kind:

        struct SkewSymmetry : Law {
          static constexpr LawWords kWords = {"skew symmetry", "dM/dt - 2 C = ...", "dM/dt - 2C",
                                              "composite_body", ""};
          template <typename T>
          static TwoSides<T> sides(SweptMechanism<T>& at);
        };

    The two sides are written once for any scalar; nothing in them is specific to rounding. Where
    one divides by zero and its scalar throws std::domain_error, that is its failure. (A scalar that
    goes on, as RunningError does, gives sides without a finite bound.) A law that needs more than a
    state has says so in `failure`; one that some mechanisms do not have at all hides
    appliesTo(). */
struct Law {
  static bool appliesTo(const scene::Mechanism&) { return true; }
};

/// Laws that are asked of one subject. Words and sides come in the order of this list.
template <typename... SomeLaw>
struct Laws {
  static constexpr int kCount = sizeof...(SomeLaw);

  /// Of those that the mechanism has.
  static std::vector<LawWords> words(const scene::Mechanism& mechanism) {
    std::vector<LawWords> out;
    const auto add = [&](const LawWords& words, bool applies) {
      if (applies) out.push_back(words);
    };
    (add(SomeLaw::kWords, SomeLaw::appliesTo(mechanism)), ...);
    return out;
  }
  /// Of all.
  static std::vector<LawWords> words() { return {SomeLaw::kWords...}; }

  /// @param at  what the laws are asked about: a mechanism at a state
  template <typename Subject>
  static std::vector<TwoSides<typename std::decay_t<Subject>::Scalar>> sides(
      const scene::Mechanism& mechanism, Subject&& at);
  /// The same of some of them: one a law that words() lists, empty where it is not wanted.
  template <typename Subject>
  static std::vector<TwoSides<typename std::decay_t<Subject>::Scalar>> wantedSides(
      const scene::Mechanism& mechanism, Subject&& at, const std::vector<char>& wanted);

 private:
  template <typename One, typename Subject, typename T>
  static void append(const scene::Mechanism& mechanism, Subject& at,
                     std::vector<TwoSides<T>>& out) {
    if (!One::appliesTo(mechanism)) return;
    try {
      out.push_back(One::sides(at));
    } catch (const std::domain_error& error) {
      out.push_back({{}, {}, error.what()});
    }
  }
  template <typename One, typename Subject, typename T>
  static void appendWanted(const scene::Mechanism& mechanism, Subject& at,
                           const std::vector<char>& wanted, std::vector<TwoSides<T>>& out) {
    if (!One::appliesTo(mechanism)) return;
    if (wanted[out.size()] == 0)
      out.emplace_back();
    else
      append<One>(mechanism, at, out);
  }
};

// not in the struct: what is inline is compiled in every file, extern or not
template <typename... SomeLaw>
template <typename Subject>
std::vector<TwoSides<typename std::decay_t<Subject>::Scalar>> Laws<SomeLaw...>::sides(
    const scene::Mechanism& mechanism, Subject&& at) {
  std::vector<TwoSides<typename std::decay_t<Subject>::Scalar>> out;
  (append<SomeLaw>(mechanism, at, out), ...);
  return out;
}

template <typename... SomeLaw>
template <typename Subject>
std::vector<TwoSides<typename std::decay_t<Subject>::Scalar>> Laws<SomeLaw...>::wantedSides(
    const scene::Mechanism& mechanism, Subject&& at, const std::vector<char>& wanted) {
  std::vector<TwoSides<typename std::decay_t<Subject>::Scalar>> out;
  (appendWanted<SomeLaw>(mechanism, at, wanted, out), ...);
  return out;
}

/// A result that is computed when it is first asked for. Where computing throws, nothing is kept.
template <typename Value>
class Kept {
 public:
  template <typename Compute>
  const Value& operator()(const Compute& compute) {
    if (!value_) value_.emplace(compute());
    return *value_;
  }

 private:
  std::optional<Value> value_;
};

}  // namespace dynwitness::crosscheck
