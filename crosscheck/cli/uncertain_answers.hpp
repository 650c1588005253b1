// SPDX-License-Identifier: GPL-3.0-or-later
// How many digits rounding leaves to evaluate's answers: what --warn says.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "crosscheck/cli/evaluated_column.hpp"
#include "crosscheck/witnesses/estimated_sweep.hpp"
#include "crosscheck/witnesses/single_precision.hpp"
#include "scene/scene.hpp"

namespace dynwitness::cli {

/** Counts answers to which rounding leaves too few digits: in double, and by the same sweep in
    float. By the sweep's estimate where it has one; otherwise by the answer's own bound, which
    costs many times the sweep. */
class UncertainAnswers {
 public:
  UncertainAnswers(const scene::Scene& scene, const std::vector<EvaluatedColumn>& columns);

  /// @param at  the column's place  @param row  the state's, from 1
  void see(std::size_t at, const EvaluatedColumn& column, const scene::State<double>& state,
           long row);
  /// On standard error. @param rows  how many states there were
  void tell(const std::vector<EvaluatedColumn>& columns, long rows) const;

 private:
  struct Seen {
    long states = 0, row = 0;
    double digits = std::numeric_limits<double>::infinity();
    void count(double left, long at);
  };
  struct Asked {
    Seen seen, single;
    crosscheck::EstimatedSweep estimated, estimated_single;
    crosscheck::SingleSweep bounded_single;
  };
  static void tellOf(const std::string& who, const char* how, const Seen& seen, long rows);

  std::string scene_;
  std::vector<Asked> of_;
};

/// @throws scene::InputError  nobody vouches for digits of it
void requireBound(const EvaluatedColumn& column);

}  // namespace dynwitness::cli
