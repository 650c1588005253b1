// SPDX-License-Identifier: GPL-3.0-or-later
// A folder of submissions, graded by a rubric; it goes on where it stopped.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "crosscheck/grade/marks.hpp"
#include "crosscheck/grade/rubric.hpp"

namespace dynwitness::crosscheck {

struct GradeOptions {
  std::filesystem::path folder, rubric_file, output;
  int jobs = 1;
  bool again = false;  ///< those, too, whose records are there
};

struct Grades {
  Rubric rubric;
  std::string folder, rubric_file;  ///< their names
  std::string not_hidden;           ///< why nothing could be hidden from submissions; empty: it was
  std::vector<Grade> all;           ///< by name
  int kept = 0;                     ///< of records that were there

  int ungraded() const;
};

/** Examines what has no record yet (a record is named by a hash of the submission's bytes, of what
    the rubric says but for the marks, and of this program), each in a copy of this process and a
    cell of its own, and writes each record when it is whole: output/records/. Marks are made of
    the records.

    @param done  called with how many are to be examined, and how many have been
    @throws scene::InputError  the folder cannot be read; the output is inside of it or the reverse,
                               is somebody else's, or another one is at work there */
Grades grade(const GradeOptions& options, const std::function<void(int of, int done)>& done);

// grade_tables.cpp: the same bytes for the same records, whatever order they came in.

/// One table for a terminal.
/// @param shown  how a grade's word ("right", "one mistake") is put into it, in colour; none: as is
std::string gradesText(const Grades& grades,
                       const std::function<std::string(const std::string& state)>& shown = {});
/// One line a submission.
std::string gradesCsv(const Grades& grades);
/// One page, alone.
std::string gradesHtml(const Grades& grades, const std::string& version);
/// A test suite a submission, a test case a quantity.
std::string gradesJUnit(const Grades& grades);
/// What Gradescope reads as results.json.
std::string gradescopeJson(const Grade& grade);

/// Writes all of them: grades.csv, index.html, junit.xml, gradescope/NAME/results.json.
void writeGrades(const Grades& grades, const std::filesystem::path& output,
                 const std::string& version);

/// A submission's name as the name of a file: different ones stay different.
std::string fileNameOf(const std::string& submission);

}  // namespace dynwitness::crosscheck
