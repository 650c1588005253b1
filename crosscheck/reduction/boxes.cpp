// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/boxes.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Boxes before corners are climbed from: by then most arms of three joints have their bound.
constexpr int kFirstLook = 64;

struct SmallerBound {
  bool operator()(const Box& a, const Box& b) const { return a.bound < b.bound; }
};

/// By rate: no less than the products with it or with any later one add; and 0.
std::vector<double> mostOfLater(const Eigen::MatrixXd& form, const Eigen::VectorXd& linear,
                                const std::vector<scene::Range>& qd) {
  std::vector<double> open(qd.size() + 1);
  for (std::size_t a = qd.size(); a-- > 0;) {
    const auto row = static_cast<Eigen::Index>(a);
    double slope = std::abs(linear(row));
    for (std::size_t b = 0; b <= a; ++b)
      slope += std::abs(form(row, static_cast<Eigen::Index>(b))) * qd[b].most();
    open[a] = open[a + 1] + (1 + kLost) * slope * qd[a].most();
  }
  return open;
}

}  // namespace

BoxesSeen bestFirst(Box whole, int boxes, const std::function<void(Box*)>& judge,
                    const std::function<bool(double)>& isKnown, const std::function<void()>& look) {
  const scene::Work work("boxes", boxes);
  std::priority_queue<Box, std::vector<Box>, SmallerBound> queue;
  judge(&whole);
  queue.push(std::move(whole));
  int count = 1, next_look = kFirstLook;
  while (queue.top().split >= 0 && !isKnown(queue.top().bound) && count < boxes) {
    const Box box = queue.top();
    queue.pop();
    for (const bool upper : {false, true}) {
      Box part = box;
      const auto s = static_cast<std::size_t>(box.split);
      scene::Range& r = s < box.q.size() ? part.q[s] : part.qd[s - box.q.size()];
      (upper ? r.low : r.high) = r.low + half(r);
      judge(&part);
      part.bound = std::min(part.bound, box.bound);  // what holds for the whole holds for its part
      queue.push(std::move(part));
      ++count;
    }
    if (count >= next_look) {
      look();
      next_look *= 2;
    }
  }
  return {queue.top().bound, count};
}

void Climb::saw(double value, const std::vector<double>& q) {
  if (!(value > value_)) return;
  value_ = value;
  q_ = q;
}

void Climb::from(const std::vector<scene::Range>& ranges,
                 const std::function<double(const std::vector<double>&)>& at) {
  std::vector<double> q = q_;
  double best = value_;
  const auto moved = [&](std::size_t k, double by) {
    const double before = q[k];
    q[k] = std::clamp(before + by, ranges[k].low, ranges[k].high);
    if (q[k] != before)
      if (const double value = at(q); value > best) {
        best = value;
        return true;
      }
    q[k] = before;
    return false;
  };
  for (double share = 0.25; !q.empty() && share >= 1.0 / 1024; share /= 2) {
    bool any = true;
    while (any) {
      any = false;
      for (std::size_t k = 0; k < q.size(); ++k)
        for (const double by : {share, -share})
          while (moved(k, by * (ranges[k].high - ranges[k].low))) any = true;
    }
  }
  start();
}

double largestAtRates(const Eigen::MatrixXd& form, const Eigen::VectorXd& linear,
                      const std::vector<scene::Range>& qd, int sign, std::vector<double>* worst) {
  std::vector<double> v(qd.size());
  const std::vector<double> open = mostOfLater(form, linear, qd);
  double best = -HUGE_VAL;
  const auto add = [&](const auto& self, std::size_t a, double sum) -> void {
    if (sum + open[a] <= best) return;  // whatever the rates from a on are
    if (a == qd.size()) {
      if (sum > best) {
        best = sum;
        *worst = v;
      }
      return;
    }
    const auto row = static_cast<Eigen::Index>(a);
    for (const double x : {qd[a].low, qd[a].high}) {
      v[a] = x;
      double slope = 0;
      for (std::size_t b = 0; b <= a; ++b) slope += form(row, static_cast<Eigen::Index>(b)) * v[b];
      slope += linear(row);
      self(self, a + 1, sum + sign * slope * x);
      if (qd[a].low == qd[a].high) break;
    }
  };
  add(add, 0, 0);
  return best;
}

double largestDryFriction(const scene::Range& qd, double forward, double backward, int sign) {
  double best = qd.low <= 0 && qd.high >= 0 ? 0 : -HUGE_VAL;
  if (qd.high > 0) best = std::max(best, sign * forward);
  if (qd.low < 0) best = std::max(best, -sign * backward);
  return best;
}

}  // namespace dynwitness::crosscheck
