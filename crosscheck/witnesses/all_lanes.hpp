// SPDX-License-Identifier: GPL-3.0-or-later
// One answer of code that computes several states at once: what every lane says.
#pragma once

#include <cstddef>
#include <cstring>
#include <limits>
#include <vector>

namespace dynwitness::crosscheck {

/** The state in each lane in turn, other states beside it. What two lanes do not agree on, bit for
    bit, is no number, for the comparisons to find.

    @param run      called as run(q, qd, w, out, count): `count` states, entry i of state k at
                    [i * count + k]
    @param lanes    of a vector; two whole blocks of them are asked for, and a rest
    @param outputs  numbers that a state gives */
template <typename Run>
std::vector<double> askAllLanes(const Run& run, std::size_t lanes, std::size_t outputs,
                                const std::vector<double>& q, const std::vector<double>& qd,
                                const std::vector<double>& w) {
  const std::size_t count = 2 * lanes + 1;
  std::vector<double> first(outputs);
  for (std::size_t lane = 0; lane < count; ++lane) {
    const auto spread = [&](const std::vector<double>& x) {
      std::vector<double> all(x.size() * count);
      for (std::size_t i = 0; i < x.size(); ++i)
        for (std::size_t k = 0; k < count; ++k)
          all[i * count + k] =
              k == lane ? x[i] : x[(i + k) % x.size()] * (1.0 + static_cast<double>(k) / 8);
      return all;
    };
    const std::vector<double> all_q = spread(q), all_qd = spread(qd), all_w = spread(w);
    std::vector<double> all(outputs * count), here(outputs);
    run(all_q.data(), all_qd.data(), all_w.data(), all.data(), static_cast<long>(count));
    for (std::size_t i = 0; i < outputs; ++i) here[i] = all[i * count + lane];
    if (lane == 0) first = here;
    for (std::size_t i = 0; i < outputs; ++i)
      if (std::memcmp(&first[i], &here[i], sizeof(double)) != 0)
        first[i] = std::numeric_limits<double>::quiet_NaN();
  }
  return first;
}

}  // namespace dynwitness::crosscheck
