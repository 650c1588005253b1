// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers on the command line: every option that takes one is found in the program's own help and
// given what is no number, no finite one, or none that its type holds.
#include <boost/test/unit_test.hpp>

#include <array>
#include <cstdlib>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

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
  if (command == "envelope" || command == "reduce") return command + " planar_3r";
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

// One grammar: whoever knows an option of one command knows it in all. Behind the colon stands what
// it is for in this one.
BOOST_AUTO_TEST_CASE(an_option_has_one_meaning_and_one_type_in_all_commands) {
  const Program program;
  const std::regex entry("^  (?:-[a-z],)?(--[a-z-]+)(?: (INT|UINT|FLOAT|TEXT)[^ ]*)?.*");
  constexpr std::size_t kColumn = 30;                       // where texts begin
  constexpr std::size_t kMore = 6;                          // and what an option excludes goes on
  std::map<std::string, std::array<std::string, 3>> known;  // type, meaning, command
  int shared = 0;
  for (const std::string& command : commands(program)) {
    std::map<std::string, std::array<std::string, 3>> options;
    std::array<std::string, 3>* at = nullptr;
    std::istringstream lines(program.run(command + " --help").out);
    for (std::string line; std::getline(lines, line);) {
      BOOST_TEST(line.size() <= 80u, command << " --help: longer than 80 columns: " << line);
      std::smatch found;
      if (std::regex_match(line, found, entry))
        at = &(options[found[1]] = {found[2], "", command});
      else if (line.compare(0, kMore, std::string(kMore, ' ')) != 0)
        at = nullptr;
      if (at != nullptr && line.size() > kColumn && line.compare(kColumn - 2, 2, "  ") == 0)
        (*at)[1] += (*at)[1].empty() ? line.substr(kColumn) : " " + line.substr(kColumn);
    }
    for (auto& [name, option] : options) {
      option[1] = option[1].substr(0, option[1].find(": "));
      const auto [other, is_new] = known.emplace(name, option);
      if (is_new) continue;
      ++shared;
      BOOST_TEST(other->second[0] == option[0],
                 name << " of " << command << " and of " << other->second[2] << ": types");
      BOOST_TEST(other->second[1] == option[1], name << ": " << command << " says \"" << option[1]
                                                     << "\", " << other->second[2] << " \""
                                                     << other->second[1] << "\"");
    }
  }
  BOOST_TEST(shared >= 80);  // 96 when this was written
}

// Colours are for people: none where nobody looks, unless they are asked for.
BOOST_AUTO_TEST_CASE(colours_progress_and_remarks_are_as_asked_for) {
  const Program program;
  const auto has = [](const Outcome& outcome, const char* text) {
    return outcome.out.find(text) != std::string::npos;
  };
  const std::string crosscheck =
      "crosscheck simple_pendulum --no-charts --no-drift --random 3 --witness lagrange,newton_euler ";
  for (const char* plain : {"", "--color auto", "--color never", "--color=never --quiet"})
    BOOST_TEST(!has(program.run(crosscheck + plain), "\033["), plain);
  const Outcome colored = program.run(crosscheck + "--color always");
  BOOST_TEST(has(colored, "\033[32magree"), colored.out);
  BOOST_TEST(has(program.run(crosscheck + "--progress auto"), "[1/2] simple_pendulum"));
  const Outcome json = program.run(crosscheck + "--progress json");
  BOOST_TEST(has(json, "{\"progress\":\"simple_pendulum\",\"stage\":1,\"stages\":2,"), json.out);
  for (const char* silent : {"--progress off", "-q", "--quiet", "--quiet --progress json"}) {
    const Outcome outcome = program.run(crosscheck + silent);
    BOOST_TEST(!has(outcome, "[1/2]"), silent);
    BOOST_TEST(!has(outcome, "{\"progress\""), silent);
  }
  const std::string evaluate = "evaluate acrobot --quantity qdd ";
  BOOST_TEST(has(program.run(evaluate), "no state given"));
  BOOST_TEST(program.run(evaluate + "-q").out.compare(0, 5, "qdd1,") == 0);
  // a failure is told in any case
  refuses(program, "evaluate acrobt --quantity M -q", "did you mean acrobot?");
}

BOOST_AUTO_TEST_CASE(every_command_says_how_much_it_says) {
  const Program program;
  for (const std::string& command : commands(program)) {
    const std::string help = program.run(command + " --help").out;
    for (const char* option : {"--color TEXT:{auto,always,never}=auto",
                               "--progress TEXT:{auto,json,off}=auto", "-q,--quiet"})
      BOOST_TEST(help.find(option) != std::string::npos, command << ": " << option);
  }
}

// The ending of the file says the kind of picture; by the first bytes of each.
BOOST_AUTO_TEST_CASE(pictures_are_svg_png_or_pdf) {
  const Program program;
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) return;
  for (const auto& [file, begin] : std::map<std::string, std::string>{
           {"a.svg", "<?xml"}, {"b.png", "\x89PNG"}, {"c.pdf", "%PDF"}}) {
    const Outcome outcome = program.run("drift acrobot --step 0.01,0.005 --duration 1 --plot " +
                                        file + " --background white");
    BOOST_TEST(outcome.status == 0, outcome.out);
    BOOST_TEST((program.read(file).substr(0, begin.size()) == begin), file);
  }
  refuses(program, "drift acrobot --plot a.bmp", "allowed: a file that ends in .svg, .png or .pdf");
}

BOOST_AUTO_TEST_CASE(old_spellings_are_taken_and_told) {
  const Program program;
  const Outcome now = program.run("rotors gyroscopic_wrist --random 3"),
                old = program.run("rotors gyroscopic_wrist --states=3");
  BOOST_TEST(old.out ==
             "dynwitness rotors: --states is called --random now; the old name goes with the next "
             "release\n" +
                 now.out);
  // where a number of states was --states, --random were mechanisms
  const Outcome mechanisms =
      program.run("crosscheck --random 1 --joints 2 --states 1 --witness newton_euler,lagrange");
  BOOST_TEST(mechanisms.status == 0, mechanisms.out);
  BOOST_TEST(mechanisms.out.find("--random is called --mechanisms now") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(a_slip_of_the_pen_is_answered_with_what_may_be_meant) {
  const Program program;
  refuses(program, "evaluat acrobot", "\"evaluat\" is no command (did you mean evaluate?)");
  refuses(program, "evaluate acrobot --quantiti M",
          "evaluate has no option --quantiti (did you mean --quantity?)");
  refuses(program, "evaluate acrobt --quantity M", "\"acrobt\" (did you mean acrobot?)");
  refuses(program, "chart acrobot --quantity taus",
          "read 'taus' (did you mean tau?), allowed: M, tau, qdd, all");
  refuses(program, "evaluate acrobot", "dynwitness evaluate: --quantity is required");
}

BOOST_AUTO_TEST_CASE(a_slip_in_a_file_is_told_by_every_command_that_reads_it) {
  const Program program;
  const std::string head =
                        "<robot name=\"r\">\n<link name=\"base\"/>\n<link name=\"arm\"><inertial>",
                    tail =
                        "<inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>"
                        "</inertial></link>\n<joint name=\"j\" type=\"continuous\"><parent "
                        "link=\"base\"/><child link=\"arm\"/></joint></robot>\n";
  program.write("slip.urdf", head + "<orign xyz=\"1 0 0\"/><mass value=\"1\"/>" + tail);
  program.write("mas.urdf", head + "<mas value=\"1\"/>" + tail);
  const std::string said =
      "slip.urdf:3: link \"arm\": <inertial> has an unknown element <orign> (did you mean origin?): "
      "it is ignored\n";
  const auto count = [&](const std::string& words) {
    const Outcome outcome = program.run(words, "2>&1 >/dev/null");
    BOOST_TEST(outcome.status == 0, outcome.out);
    std::size_t times = 0;
    for (std::size_t at = outcome.out.find(said); at != std::string::npos;
         at = outcome.out.find(said, at + 1))
      ++times;
    return times;
  };
  for (const char* words :
       {"evaluate slip.urdf --quantity M", "show slip.urdf", "derive slip.urdf",
        "write slip.urdf --format toml", "same slip.urdf slip.urdf",
        "evaluate slip.urdf --quantity M --gravity 0,0,0", "simulate slip.urdf --duration 0.1"})
    BOOST_TEST(count(words) == 1u, words);
  BOOST_TEST(count("evaluate slip.urdf --quantity M --quiet") == 0u);
  BOOST_TEST(program.run("show slip.urdf", "2>/dev/null").out.find("\nRemarks\n  " + said) !=
             std::string::npos);
  refuses(program, "evaluate mas.urdf --quantity M",
          "mas.urdf:3: link \"arm\": <inertial>: has no <mass>");
  BOOST_TEST(program.run("evaluate mas.urdf --quantity M").out.find("<mas> (did you mean mass?)") !=
             std::string::npos);

  // 30 and 540 degrees; q2 once, though two rows have it
  program.write("degrees.csv", "q1,q2\n0.5,30\n1,540\n");
  BOOST_TEST(
      program.run("evaluate acrobot --quantity g --states degrees.csv", "2>&1 >/dev/null").out ==
      "acrobot: no qd given: at rest (qd = 0)\n"
      "degrees.csv: q2 = 30 rad is 4.8 turns; if it is in degrees, write "
      "0.5235987755982988\n");
  BOOST_TEST(program.run("evaluate acrobot --quantity g --q 30,0", "2>&1 >/dev/null").out ==
             "--q: q1 = 30 rad is 4.8 turns; if it is in degrees, write 30*pi/180\n");
}

BOOST_AUTO_TEST_CASE(numbers_inside_words_are_finite_too) {
  const Program program;
  for (const char* value : {"nan", "inf", "1e400", "-1", "abc"})
    refuses(program, std::string("parameters acrobot --uncertainty mass=") + value,
            "--uncertainty: read");
  refuses(program, "evaluate acrobot --quantity P --uncertainty mass=nan", "--uncertainty: read");
  refuses(program, "evaluate acrobot --quantity M --uncertainty mass=0.1", "--uncertainty with M");
  refuses(program, "evaluate andrews_squeezer --quantity qdd --uncertainty mass=0.1",
          "qdd under closures, drives or constraints");
  refuses(program, "evaluate acrobot --quantity P --axes world --uncertainty rpy=0.1",
          "--axes link or joint");
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
            ? "1e308,1e308,1e308,1e308,1e308,1e308"
        : option.name == "--q" || option.name == "--qd" || option.name == "--qdd" ||
                option.name == "--joint-impulses" || option.name == "--joint-compliance"
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

// Examples are copied: a broken one goes on in the next line, never breaks within quotes, and what
// is said of it is a comment of the shell.
BOOST_AUTO_TEST_CASE(help_fits_into_80_columns_and_has_examples_that_can_be_copied) {
  const dynwitness::fixtures::Program program;
  const std::regex broken(R"( *\\\n *)"), remark(" +#.*"), option(" (--?[a-z][a-z-]*)"),
      quoted("\"[^\"]*\""), begins_an_example("\n  dynwitness (?=[a-z]+)");
  const std::string all = program.run("--help-all").out;
  for (const std::string& command : commands(program)) {
    const std::string help = program.run(command + " --help").out;
    for (const std::string& text : {help, all}) {
      std::istringstream lines(text);
      for (std::string line; std::getline(lines, line);)
        BOOST_TEST(line.size() <= 80u, command << ": " << line);
    }
    BOOST_TEST(help.find("\nExample") != std::string::npos, command);
    const std::string whole = std::regex_replace(help, broken, " ");
    std::size_t own = 0;
    for (std::sregex_iterator at(whole.begin(), whole.end(), begins_an_example), end; at != end;
         ++at) {
      const auto from = static_cast<std::size_t>(at->position()) + 1;
      std::string line = whole.substr(from, whole.find('\n', from) - from);
      line = std::regex_replace(std::regex_replace(line, remark, ""), quoted, "QUOTED");
      BOOST_TEST(line.find_first_of("\"'\\") == std::string::npos, command << ": " << line);
      if (line.compare(13, command.size() + 1, command + " ") != 0 &&
          line != "  dynwitness " + command)
        continue;  // of another command, whose motion this one takes
      ++own;
      for (std::sregex_iterator word(line.begin(), line.end(), option); word != end; ++word)
        BOOST_TEST(std::regex_search(help, std::regex("\n  (-[a-z],)?" + (*word)[1].str() +
                                                      "\\b|\n  " + (*word)[1].str() + ",")),
                   command << ": " << line << " (" << (*word)[1] << ")");
      // words beside options and their values: the scene, and no remark
      BOOST_TEST(line.find("  ", 2) == std::string::npos, command << ": " << line);
    }
    BOOST_TEST(own > 0u, command << ": no example");
  }
}

BOOST_AUTO_TEST_CASE(help_is_a_word_too_and_what_is_no_command_gets_no_list) {
  const dynwitness::fixtures::Program program;
  for (const char* command : {"derive", "golden"})  // one here, one in a program of its own
    BOOST_TEST(program.run("help " + std::string(command)).out ==
               program.run(std::string(command) + " --help").out);
  BOOST_TEST(program.run("help").out == program.run("--help").out);
  refuses(program, "help evaluat", "(did you mean evaluate?)");
  for (const char* words : {"evaluat acrobot", "frobnicate", "--helpp", "-v", ""}) {
    const Outcome outcome = program.run(words);
    BOOST_TEST(outcome.status == 2, words);
    BOOST_TEST(outcome.out.find("`dynwitness --help` lists") != std::string::npos, outcome.out);
    BOOST_TEST(outcome.out.find("crosscheck,") == std::string::npos, outcome.out);
    BOOST_TEST(outcome.out.size() < 160u, outcome.out);
  }
  refuses(program, "--helpp", "(did you mean --help?)");
}

// "-" is standard output wherever a file is written, and nothing else is there then.
BOOST_AUTO_TEST_CASE(a_hyphen_is_standard_output) {
  const dynwitness::fixtures::Program program;
  const auto out = [&](const std::string& words) {
    const dynwitness::fixtures::Outcome outcome = program.run(words, "2>/dev/null");
    BOOST_TEST(outcome.status == 0, words);
    return outcome.out;
  };
  BOOST_TEST(out("evaluate acrobot --quantity M -o -").find("M11,M12") == 0u);
  BOOST_TEST(out("derive acrobot -o -").find("acrobot: Acrobot\n") == 0u);
  BOOST_TEST(out("write acrobot --format toml -o -").find("title = ") == 0u);
  BOOST_TEST(out("simulate acrobot --duration 0.1 --once --csv -").find("time_s,q1") == 0u);
  BOOST_TEST(nlohmann::json::accept(out("simulate acrobot --duration 0.1 --once --json -")));
  BOOST_TEST(out("drift acrobot --duration 0.1 --plot -").find("<?xml") == 0u);
  BOOST_TEST(program.fileCount() == 0u);
}
