// SPDX-License-Identifier: GPL-3.0-or-later
// How far long work has come. Whoever does it says so in passing; whoever waits may look
// (cli/progress.hpp).
#pragma once

#include <string>

namespace dynwitness::scene {

/** Work under way, counted in units of about equal cost. What begins inside of a unit is a part of
    that unit. Saying so costs a few stores; work of one process is begun and ended by one thread.
    */
class Work {
 public:
  /// @param what   a literal: it is kept, not copied
  /// @param units  how many there are; 0: nobody knows
  /// @param of_outer  how many units of the work that it is a part of it makes; these are done when
  ///   it ends.
  ///                  0: it lies within one unit, which the outer work counts itself
  Work(const char* what, double units, double of_outer = 0);
  ~Work();
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;
  void done(double units = 1);  ///< so many more
  /// Instead of done(): this share of the whole.
  void doneTo(double fraction);
  void expect(double units);  ///< it is known now that there are so many

 private:
  int level_;
};

struct WorkSeen {
  std::string what;  ///< of the innermost work; "": nothing is under way
  double fraction;   ///< of the outermost, what copies of this process (fork) do included
};

/// From any thread. Copies that were made by fork() write to memory that the original can read.
WorkSeen seenWork();

}  // namespace dynwitness::scene
