// SPDX-License-Identifier: GPL-3.0-or-later
// A witness of a scene, or the reason why it cannot hold that scene.
#pragma once

#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

namespace dynwitness::crosscheck {

/// Why a witness cannot hold a scene.
struct Refusal {
  std::string reason;
};

/// What was asked for, or why there is none: std::expected of C++23.
template <typename W>
class OrRefusal {
 public:
  template <typename U, std::enable_if_t<std::is_convertible_v<U, W>, int> = 0>
  OrRefusal(U made)  // NOLINT(google-explicit-constructor): either is an answer
      : state_(std::in_place_type<W>, std::move(made)) {}
  OrRefusal(Refusal refusal)  // NOLINT(google-explicit-constructor)
      : state_(std::move(refusal)) {}

  bool isRefused() const { return std::holds_alternative<Refusal>(state_); }
  const std::string& refusal() const { return std::get<Refusal>(state_).reason; }
  const W& operator*() const { return std::get<W>(state_); }
  /// For those who have no use for a refusal. @throws std::runtime_error  its reason
  W value() && {
    if (isRefused()) throw std::runtime_error(refusal());
    return std::get<W>(std::move(state_));
  }

 private:
  std::variant<W, Refusal> state_;
};

}  // namespace dynwitness::crosscheck
