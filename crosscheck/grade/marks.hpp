// SPDX-License-Identifier: GPL-3.0-or-later
// From what was found out to marks, with a sentence for each.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/grade/rubric.hpp"

namespace dynwitness::crosscheck {

/// One quantity of one task.
struct Mark {
  enum class Kind { kRight, kPartial, kWrong, kNotAnswered, kNotRun };
  std::string scene, quantity;
  Kind kind = Kind::kNotRun;
  double marks = 0, out_of = 0;
  std::string feedback;
};
/// "right", "one mistake", "wrong", "not answered", "could not be run"
const char* name(Mark::Kind kind);

struct Grade {
  std::string submission;
  std::vector<Mark> marks;           ///< in the order of the rubric
  std::vector<std::string> remarks;  ///< what else there is to say
  std::string problem;               ///< why it could not be run, anywhere
  std::string ungraded;              ///< a reason of ours: there are no marks
  bool hidden = false;               ///< whether the others were, from it

  double total() const;
  double outOf() const;
};

/** A quantity that is right has its marks; one that is wrong, or was not answered, has none; but
    where a single mistake explains all wrong answers of the task, those that it speaks of keep the
    rubric's share.

    @param record  as examinedRecord() wrote it
    @throws std::exception  it is no such record */
Grade graded(const std::string& record, const Rubric& rubric);

/// The key of a record; empty: it is none.
std::string keyOfRecord(const std::string& record);

}  // namespace dynwitness::crosscheck
