// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers on the command line: every option that takes one is found in the program's own help and
// given what is no number, no finite one, or none that its type holds.
#include <boost/test/unit_test.hpp>

#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/fixtures/program.hpp"

using dynwitness::fixtures::Outcome;
using dynwitness::fixtures::Program;
using dynwitness::fixtures::refuses;

namespace {

/// An option of a command that takes numbers, as the help shows it: "--step FLOAT:> 0".
struct NumberOption {
  std::string command, name, type, range;
};

std::vector<std::string> commands(const Program& program) {
  std::istringstream lines(program.run("--help").out);
  std::vector<std::string> names;
  bool inside = false;
  const std::regex entry("^  ([a-z]+) +[A-Z].*");
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    if (line == "Subcommands:")
      inside = true;
    else if (inside && std::regex_match(line, found, entry))
      names.push_back(found[1]);
  }
  return names;
}

std::vector<NumberOption> numberOptions(const Program& program) {
  std::vector<NumberOption> options;
  const std::regex entry("^  (?:-[a-z],)?(--[a-z-]+) (INT|UINT|FLOAT)(:.*)?");
  for (const std::string& command : commands(program)) {
    std::istringstream lines(program.run(command + " --help").out);
    for (std::string line; std::getline(lines, line);) {
      std::smatch found;
      if (std::regex_match(line, found, entry))
        options.push_back({command, found[1], found[2], found[3]});
    }
  }
  return options;
}

/// What a command needs beside.
std::string callOf(const std::string& command) {
  if (command == "audit" || command == "growth") return command;
  if (command == "action") return command + " acrobot";  // it refuses joints with friction
  if (command == "evaluate") return "evaluate gyroscopic_wrist --quantity M";
  return command + " gyroscopic_wrist";
}

}  // namespace

BOOST_AUTO_TEST_CASE(every_number_on_the_command_line_is_a_number_and_finite) {
  const Program program;
  const std::vector<NumberOption> options = numberOptions(program);
  BOOST_TEST(commands(program).size() >= 16u);
  BOOST_TEST(options.size() >= 40u);  // 48 when this was written
  for (const NumberOption& option : options) {
    BOOST_TEST(!option.range.empty(),
               option.command << " " << option.name << ": nothing checks its numbers");
    std::vector<std::string> bad = {"nan", "inf", "1e400", "abc"};
    if (option.type != "FLOAT" || option.range.find("finite") == std::string::npos)
      bad.push_back("-1e308");
    if (option.type != "FLOAT") bad.insert(bad.end(), {"0.5", "99999999999999999999999"});
    for (const std::string& value : bad) {
      const std::string words = callOf(option.command) + " " + option.name + "=" + value;
      const Outcome outcome = program.run(words);
      BOOST_TEST_CONTEXT(words << "\n" << outcome.out) {
        BOOST_TEST(outcome.status == 2);
        BOOST_TEST(outcome.out.find(option.name + ": read '" + value + "', allowed: ") !=
                   std::string::npos);
      }
    }
  }
  BOOST_TEST(program.fileCount() == 0u);
}

BOOST_AUTO_TEST_CASE(numbers_inside_words_are_finite_too) {
  const Program program;
  for (const char* value : {"nan", "inf", "1e400", "-1", "abc"})
    refuses(program, std::string("parameters acrobot --uncertainty mass=") + value,
            "--uncertainty: read");
  refuses(program, "impulse acrobot --impulse 1,nan,0", "--impulse: read 'nan'");
  refuses(program, "simulate acrobot --step-error 1", "between 0 and 1");
  refuses(program, "drift acrobot --duration 1e300", "allowed: up to");
}

// Numbers that are finite, and whose squares are not.
BOOST_AUTO_TEST_CASE(nothing_prints_nan_or_infinity_and_calls_it_success) {
  const Program program;
  const std::regex not_finite("(^|[^a-z])-?(nan|inf)([^a-z]|$)");
  for (const NumberOption& option : numberOptions(program)) {
    if (option.type != "FLOAT" || option.command == "growth" || option.command == "crosscheck")
      continue;
    // that one ends when it has taken a million steps
    if (option.command == "simulate" && option.name == "--duration") continue;
    const std::string option_value =
        option.name == "--impulse" || option.name == "--moment" || option.name == "--at" ||
                option.name == "--wall" || option.name == "--stretch"
            ? "1e308,1e308,1e308"
        : option.name == "--stiffness" || option.name == "--damping"
            ? (option.command == "action" ? "1e308" : "1e308,1e308,1e308,1e308,1e308,1e308")
        : option.name == "--q" || option.name == "--qd" || option.name == "--qdd" ||
                option.name == "--joints" || option.name == "--joint-compliance"
            ? "1e308,1e308"
            : "1e308";
    const std::string words =
        option.command + " double_pendulum " + option.name + " " + option_value;
    const Outcome outcome = program.run(words);
    BOOST_TEST_CONTEXT(words << "\n" << outcome.out)
    if (outcome.status == 0) BOOST_TEST(!std::regex_search(outcome.out, not_finite));
  }
}

// Two masses on one slide: M is singular, and there is no qdd.
BOOST_AUTO_TEST_CASE(what_has_no_value_is_refused) {
  const Program program;
  program.write(
      "sliders.toml",
      "title = \"x\"\nsource = \"x\"\n[[link]]\nname = \"base\"\n"
      "[[link]]\nname = \"shuttle\"\nparent = \"base\"\njoint = { kind = \"prismatic\" }\n"
      "[[link]]\nname = \"weight\"\nparent = \"shuttle\"\nmass = 2\n"
      "joint = { kind = \"prismatic\" }\n");
  refuses(program, "evaluate sliders.toml --quantity qdd", "qdd is not finite at state 1");
  refuses(program, "impulse sliders.toml", "finite");
  refuses(program, "geometry sliders.toml", "not finite at the start: M is singular there");
  refuses(program, "impedance sliders.toml", "finite");
}
