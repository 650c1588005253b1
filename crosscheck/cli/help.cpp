// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/help.hpp"

#include <sstream>
#include <vector>

#include <fmt/format.h>

namespace dynwitness::cli {
namespace {

constexpr std::size_t kColumns = 80;

/// Lines of at most so many letters, but for words that are longer.
std::vector<std::string> broken(const std::string& paragraph, std::size_t letters) {
  std::vector<std::string> lines;
  std::istringstream words(paragraph);
  for (std::string word; words >> word;)
    if (!lines.empty() && lines.back().size() + 1 + word.size() <= letters)
      lines.back() += ' ' + word;
    else
      lines.push_back(word);
  return lines;
}

bool staysAsItIs(const std::string& line) {
  return line.empty() || line[0] == ' ';
}

/// An example of at most so many letters a line, to be copied as it stands: broken between words,
/// never within quotes.
std::string brokenExample(const std::string& line) {
  const std::string indent(line.find_first_not_of(' '), ' '), more = indent + "    ";
  std::vector<std::string> words(1);
  char quote = 0;
  for (const char letter : line.substr(indent.size())) {
    if (letter == ' ' && quote == 0) {
      words.emplace_back();
      continue;
    }
    if (letter == quote)
      quote = 0;
    else if (quote == 0 && (letter == '"' || letter == '\''))
      quote = letter;
    words.back() += letter;
  }
  std::string out, row = indent + words[0];
  for (std::size_t k = 1; k < words.size(); ++k) {
    if (row.size() + 1 + words[k].size() + 2 <= kColumns) {
      row += ' ' + words[k];
      continue;
    }
    out += row + " \\\n";
    row = more + words[k];
  }
  return out + row;
}

bool isExample(const std::string& line) {
  const std::size_t first = line.find_first_not_of(' ');
  return first != std::string::npos && line.compare(first, 11, "dynwitness ") == 0;
}

/// What is said of an example stands before it where both do not fit into a line.
std::string example(const std::string& line) {
  if (line.size() <= kColumns) return line;
  const std::size_t remark = line.rfind(" # ");
  if (remark == std::string::npos) return brokenExample(line);
  const std::size_t end = line.find_last_not_of(' ', remark);
  return "  " + line.substr(remark + 1) + "\n" + brokenExample(line.substr(0, end + 1));
}

}  // namespace

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
  // what excludes what may take several lines, which texts and options do not begin like
  const std::string indent = "      ";
  std::string name;
  for (const std::string& line :
       broken(make_option_name(option, is_positional) + make_option_opts(option),
              kColumns - indent.size()))
    name += (name.empty() ? "  " : "\n" + indent) + line;
  const std::size_t width = column_width_;
  std::string out = name.size() + 2 <= width ? fmt::format("{:<{}}", name, width)
                                             : name + "\n" + std::string(width, ' ');
  const std::vector<std::string> lines = broken(make_option_desc(option), kColumns - width);
  for (std::size_t k = 0; k < lines.size(); ++k)
    out += (k == 0 ? "" : "\n" + std::string(width, ' ')) + lines[k];
  return out + "\n";
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
  std::string out = fmt::format("{:<{}}", "  " + command->get_name(), column_width_);
  const std::vector<std::string> lines =
      broken(command->get_description(), kColumns - column_width_);
  for (std::size_t k = 0; k < lines.size(); ++k)
    out += (k == 0 ? "" : "\n" + std::string(column_width_, ' ')) + lines[k];
  return out + "\n";
}

std::string HelpFormatter::make_description(const CLI::App* app) const {
  std::string out;
  for (const std::string& line : broken(app->get_description(), kColumns)) out += line + "\n";
  return out;
}

std::string HelpFormatter::make_footer(const CLI::App* app) const {
  std::istringstream lines(app->get_footer());
  std::string out, paragraph;
  bool after_example = false;
  const auto flow = [&] {
    if (after_example && !paragraph.empty()) out += "\n";
    for (const std::string& line : broken(paragraph, kColumns)) out += "\n" + line;
    paragraph.clear();
  };
  for (std::string line; std::getline(lines, line);) {
    if (!staysAsItIs(line)) {
      paragraph += ' ' + line;
      continue;
    }
    flow();
    after_example = isExample(line);
    out += "\n" + (after_example ? example(line) : line);
  }
  flow();
  return out.empty() ? out : out + "\n";
}

std::string HelpFormatter::make_expanded(const CLI::App* command) const {
  std::string text = CLI::Formatter::make_expanded(command);
  // its indent would make lines of 80 columns longer
  for (std::size_t at = 0; (at = text.find("\n  ", at)) != std::string::npos; ++at)
    text.erase(at + 1, 2);
  return text;
}

}  // namespace dynwitness::cli
