// SPDX-License-Identifier: GPL-3.0-or-later
// What was computed at corners of boxes, which neighbours share.
#pragma once

#include <cstddef>
#include <cstring>
#include <string>
#include <unordered_map>
#include <vector>

namespace dynwitness::crosscheck {

/// Corners by their q, as many as `most` at a time: then all are forgotten.
template <typename Corner>
class CornersKnown {
 public:
  explicit CornersKnown(std::size_t most) : most_(most) {}
  /// @param computed  computed(q), asked where q is new
  template <typename Computed>
  const Corner& at(const std::vector<double>& q, const Computed& computed) {
    std::string key(q.size() * sizeof(double), '\0');
    if (!q.empty()) std::memcpy(&key[0], q.data(), key.size());
    if (const auto known = known_.find(key); known != known_.end()) return known->second;
    if (known_.size() >= most_) known_.clear();
    return known_.emplace(key, computed(q)).first->second;
  }

 private:
  std::size_t most_;
  std::unordered_map<std::string, Corner> known_;
};

}  // namespace dynwitness::crosscheck
