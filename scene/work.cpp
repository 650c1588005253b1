// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/work.hpp"

#include <algorithm>
#include <atomic>
#include <new>

#include <pthread.h>
#include <sys/mman.h>

namespace dynwitness::scene {
namespace {

constexpr int kLevels = 8, kRows = 64;

struct Level {
  std::atomic<const char*> what{nullptr};
  std::atomic<double> units{0}, done{0}, of_outer{0};
};
/// The work of one process, from the outermost inward.
struct Row {
  std::atomic<int> depth{0};
  Level levels[kLevels];
};
struct Page {
  std::atomic<int> copies{0};
  Row rows[kRows];  ///< the original, then copies; the 64th copy begins again at 1
};

int my_row = 0;
Page* sharedPage();

void takeRow() {
  Page* page = sharedPage();
  my_row = 1 + page->copies.fetch_add(1) % (kRows - 1);
  page->rows[my_row].depth = 0;
}

Page* sharedPage() {
  static Page* const page = [] {
    void* memory =
        mmap(nullptr, sizeof(Page), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    Page* made = memory == MAP_FAILED ? new Page : new (memory) Page;
    pthread_atfork(nullptr, nullptr, takeRow);
    return made;
  }();
  return page;
}

/// What is done of a row, and the share of one unit of its innermost work.
struct Share {
  double fraction = 0, unit = 1;
  const char* what = nullptr;
};
Share shareOf(const Row& row) {
  Share share;
  const int depth = std::min(row.depth.load(), kLevels);
  for (int i = 0; i < depth; ++i) {
    const Level& level = row.levels[i];
    share.what = level.what;
    const double units = level.units, of_outer = level.of_outer;
    if (of_outer > 0) share.unit *= of_outer;
    if (!(units > 0)) {
      share.unit = 0;
      break;
    }
    share.fraction += share.unit * std::min(1.0, level.done / units);
    share.unit /= units;
  }
  return share;
}

}  // namespace

Work::Work(const char* what, double units, double of_outer) {
  Row& row = sharedPage()->rows[my_row];
  level_ = row.depth;
  if (level_ < kLevels) {
    row.levels[level_].what = what;
    row.levels[level_].units = units;
    row.levels[level_].done = 0;
    row.levels[level_].of_outer = of_outer;
  }
  row.depth = level_ + 1;
}

Work::~Work() {
  Row& row = sharedPage()->rows[my_row];
  row.depth = level_;
  if (level_ == 0 || level_ >= kLevels) return;
  Level& outer = row.levels[level_ - 1];
  outer.done = outer.done + row.levels[level_].of_outer;
}

// NOLINTBEGIN(readability-make-member-function-const): they change what is seen of it
void Work::done(double units) {
  if (level_ >= kLevels) return;
  std::atomic<double>& sum = sharedPage()->rows[my_row].levels[level_].done;
  sum = sum + units;
}

void Work::doneTo(double fraction) {
  if (level_ >= kLevels) return;
  Level& level = sharedPage()->rows[my_row].levels[level_];
  level.done = fraction * level.units;
}

void Work::expect(double units) {
  if (level_ < kLevels) sharedPage()->rows[my_row].levels[level_].units = units;
}
// NOLINTEND(readability-make-member-function-const)

WorkSeen seenWork() {
  const Page* page = sharedPage();
  const Share own = shareOf(page->rows[0]);
  WorkSeen seen{own.what == nullptr ? "" : own.what, own.fraction};
  for (int i = 1; i < kRows; ++i) {
    const Share copy = shareOf(page->rows[i]);
    if (copy.what == nullptr) continue;
    seen.what = copy.what;
    seen.fraction += own.unit * copy.fraction;
  }
  seen.fraction = std::min(seen.fraction, 1.0);
  return seen;
}

}  // namespace dynwitness::scene
