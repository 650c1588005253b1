// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/exact/small_state.hpp"

#include <algorithm>
#include <cstdint>
#include <new>
#include <numeric>
#include <random>

#include <fmt/format.h>

#include "scene/mimic.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr unsigned kDraws = 4;  ///< a magnitude

/// By slot: whether the position is a turn, whose point of the circle formulas read.
std::vector<char> turns(const scene::Mechanism& mechanism) {
  std::vector<char> out;
  for (const scene::SlotKind kind : mechanism.slots())
    out.push_back(kind == scene::SlotKind::kAngle ? 1 : 0);
  return out;
}

std::vector<int*> entriesOf(SmallState& state, const std::vector<char>& follows) {
  std::vector<int*> out;
  for (std::size_t k = 0; k < state.positions.size(); ++k)
    if (follows[k] == 0) out.push_back(&state.positions[k]);
  for (std::vector<int>* rates : {&state.qd, &state.qdd, &state.tau})
    for (int& entry : *rates) out.push_back(&entry);
  return out;
}

std::vector<char> followersOf(const scene::Mechanism& mechanism) {
  std::vector<char> out(mechanism.slots().size(), 0);
  for (const scene::Follower& f : scene::followers(mechanism)) out[f.slot] = 1;
  return out;
}

}  // namespace

void putInto(const SmallState& small, const scene::Mechanism& mechanism, const FieldNumbers& number,
             scene::State<PrimeField>& state) {
  using T = PrimeField;
  const std::vector<char> is_turn = turns(mechanism), follows = followersOf(mechanism);
  for (std::size_t k = 0; k < small.positions.size(); ++k) {
    if (follows[k] != 0) continue;
    const T x = small.positions[k];
    scene::JointPosition<T>& slot = state.x[k];
    if (is_turn[k] == 0) {
      slot.q = x;
      continue;
    }
    const T scale = T(1) / (T(1) + x * x);
    slot.c = (T(1) - x * x) * scale;
    slot.s = (x + x) * scale;
    if (small.positions[k] == 0) slot.q = T(0);
  }
  for (std::size_t k = 0; k < small.qd.size(); ++k) {
    state.qd[k] = small.qd[k];
    state.qdd[k] = small.qdd[k];
    state.tau[k] = small.tau[k];
  }
  for (const scene::Follower& f : scene::followers(mechanism))
    state.x[f.slot].q =
        number(scene::Number(f.multiplier)) * state.x[f.leader_slot].q + number(f.offset);
}

std::vector<scene::Number> positionsOf(const SmallState& small, const scene::Mechanism& mechanism) {
  const std::vector<char> is_turn = turns(mechanism);
  std::vector<scene::Number> out;
  for (std::size_t k = 0; k < small.positions.size(); ++k) {
    const int x = small.positions[k];
    if (is_turn[k] == 0 || x == 0) {
      out.emplace_back(x);
      continue;
    }
    if (x == 1) {
      out.push_back(scene::Number::parse("pi/2"));
      continue;
    }
    // 2 atan x, for x above 1
    const int top = 2 * x, bottom = 1 + x * x, common = std::gcd(top, bottom);
    out.push_back(
        scene::Number::parse(fmt::format("pi-asin({}/{})", top / common, bottom / common)));
  }
  return out;
}

std::optional<FoundState> smallestState(const scene::Mechanism& mechanism, std::uint64_t seed,
                                        const std::function<bool(const SmallState&)>& shows) {
  FoundState out;
  const auto doesShow = [&](const SmallState& state) {
    ++out.trials;
    try {
      return shows(state);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception&) {
      return false;
    }
  };
  const auto n = static_cast<std::size_t>(mechanism.dof());
  const std::vector<char> follows = followersOf(mechanism);
  out.state.positions.assign(follows.size(), 0);
  out.state.qd = out.state.qdd = out.state.tau = std::vector<int>(n, 0);
  const std::vector<int*> entries = entriesOf(out.state, follows);
  bool found = false;
  for (const int most : {9, 99, 999}) {
    for (unsigned draw = 0; draw < kDraws && !found; ++draw) {
      std::mt19937_64 random(seed ^ (static_cast<std::uint64_t>(most) << 32 | draw));
      for (int* entry : entries)
        *entry = 1 + static_cast<int>(random() % static_cast<std::uint64_t>(most));
      found = doesShow(out.state);
    }
  }
  if (!found) return std::nullopt;
  for (bool helped = true; helped;) {
    helped = false;
    for (int* entry : entries)
      for (const int value : {0, 1}) {
        const int was = *entry;
        if (was <= value) continue;
        *entry = value;
        if (doesShow(out.state))
          helped = true;
        else
          *entry = was;
      }
  }
  return out;
}

}  // namespace dynwitness::crosscheck
