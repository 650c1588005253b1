// SPDX-License-Identifier: GPL-3.0-or-later
// What the audit says about the chapter: the sentences of data/audit/chapter.toml.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/error.hpp"

namespace dynwitness::audit {

/** One statement of the chapter, in words. Formulas stand between backticks, in the notation of
    crosscheck/report/ascii_math.hpp. A text that is empty was left out. */
struct Statement {
  scene::SourceLocation where;  ///< in the file of sentences
  std::string id;               ///< "eq1" ... "eq74", a short name for what has no number
  std::string section;          ///< of the chapter, "5.2"
  std::string title;            ///< what it is about, a few words
  std::string printed;          ///< what the chapter says
  std::string corrected;        ///< what is so; empty where the chapter is right
  std::string condition;        ///< a restriction under which the printed statement holds
  std::string why;              ///< one or two sentences for a student
  std::string implemented_in;   ///< the file of this repository that computes it
  bool left_open = false;       ///< a TODO, "...", a question: `printed` is what its context says
  bool not_printed = false;  ///< `printed` is what readers may conclude, not what the chapter says
  std::string numbers_caption;  ///< of the table beside the verdict
  std::vector<std::string> numbers_head;

  /// "eq" and digits, and not left open
  bool isEquation() const;
  /// The chapter says it, and is counted for it.
  bool isPrinted() const { return !left_open && !not_printed; }
};

struct Chapter {
  std::string file;  ///< that says all this
  std::string author, title, year;
  std::vector<std::string> criterion;  ///< by which rule a verdict is reached, a sentence each
  std::vector<std::string> sections;   ///< titles of 1, 2, ...
  std::vector<Statement> statements;   ///< in the order of the chapter
};

/** @param text  of a file as data/audit/chapter.toml describes itself
    @throws scene::InputError  its tables are not as they ought to be, an id occurs twice, a section
    is not the chapter's or goes back, or backticks do not come in pairs */
Chapter readChapter(const std::string& text, const std::string& file);

/// That of the data folder.
Chapter bundledChapter();

}  // namespace dynwitness::audit
