// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/front.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/cli/help.hpp"
#include "crosscheck/cli/old_spellings.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/speech.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/system/leaving.hpp"
#include "crosscheck/system/own_program.hpp"
#include "crosscheck/witnesses/engine_modules.hpp"
#include "scene/error.hpp"
#include "scene/nearest_name.hpp"

namespace dynwitness::cli {
namespace {

constexpr int kBadInput = 2, kOwnFailure = 3;
/// Libraries that we load need 96 KiB, the command line 128.
constexpr rlim_t kLeastStack = 256 << 10;

/// The status of some work, or of how it failed, which is told.
template <typename Work>
int orFailure(const Work& work) {
  try {
    return work();
  } catch (const scene::InputError& error) {
    tellFailure(fmt::format("dynwitness: {}\n", error.what()));
    return kBadInput;
  } catch (const std::bad_alloc&) {
    tellFailure("dynwitness: failed: not enough memory\n");  // and without asking for any
  } catch (const std::exception& error) {
    tellFailure(fmt::format("dynwitness: failed: {}{}\n",
                            std::ferror(stdout) ? "standard output: " : "", error.what()));
  }
  return kOwnFailure;
}

/// That there is room to speak: without stack there is no message, but a crash.
void requireStack() {
  rlimit stack;
  if (getrlimit(RLIMIT_STACK, &stack) != 0 || stack.rlim_cur >= kLeastStack) return;
  stack.rlim_cur = std::min(stack.rlim_max, kLeastStack);
  if (stack.rlim_cur == kLeastStack && setrlimit(RLIMIT_STACK, &stack) == 0) return;
  throw std::runtime_error(fmt::format("the stack is limited to {} KiB, at least {} are needed",
                                       stack.rlim_cur >> 10, kLeastStack >> 10));
}

/// The program that has the command, in place of this one; returns where there is none.
int become(const Command& command, char** argv) {
  std::filesystem::path self = crosscheck::ownProgram();
  if (self.empty()) self = argv[0];
  const std::filesystem::path program = self.parent_path() / command.program;
  execv(program.c_str(), argv);
  tellFailure(
      fmt::format("dynwitness: {} is in a program of its own, {}: {}; ./dynwitness {} builds it\n",
                  command.name, program.string(), std::strerror(errno), command.name));
  return kBadInput;
}

std::vector<std::string> optionNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// That the command is one, and has the options: CLI11 complains of what they leave out first.
void requireKnown(const std::vector<std::string>& words, const CLI::App& app,
                  const std::vector<Command>& commands) {
  const char* const all = "allowed: those that `dynwitness --help` lists";
  if (words.empty()) throw scene::InputError({}, fmt::format("no command is given, {}", all));
  const bool is_option = words[0].compare(0, 1, "-") == 0;
  std::vector<std::string> names = {"-h", "--help", "--help-all", "--version"};
  if (!is_option) names.clear();
  for (const Command& command : commands)
    if (!is_option) names.push_back(command.name);
  if (std::find(names.begin(), names.end(), words[0]) == names.end())
    throw scene::InputError(
        {}, fmt::format("\"{}\" is no command{}{}, {}", words[0],
                        is_option ? " and no option before one" : "",
                        words[0].size() < 3 ? "" : scene::didYouMean(words[0], names), all));
  if (is_option) return;
  const std::vector<std::string> options = optionNames(*app.get_subcommand(words[0]));
  for (std::size_t k = 1; k < words.size() && words[k] != "--"; ++k) {
    const std::string option = optionOf(words[k]);
    if (option.compare(0, 2, "--") != 0 || option == "--help" || option == "--help-all" ||
        std::find(options.begin(), options.end(), option) != options.end())
      continue;
    throw scene::InputError(
        {}, fmt::format("{} has no option {}{}, allowed: those that "
                        "`dynwitness {} --help` lists",
                        words[0], option, scene::didYouMean(option, options), words[0]));
  }
}

/// Runs a command, and says which witnesses it would have had, even where --quiet was asked for:
/// an engine that was built and cannot be loaded is a failure, and what agrees without it is less.
int tellingMissingEngines(const Run& run) {
  const auto tellMissing = [] {
    for (const std::string& why : crosscheck::enginesMissing())
      tellFailure(fmt::format("dynwitness: a witness is left out: {}\n", why));
  };
  try {
    const int status = run();
    tellMissing();
    return status;
  } catch (...) {
    tellMissing();
    throw;
  }
}

/// Runs the one that was parsed, here or in its own program.
int runParsed(const CLI::App& app, const std::vector<Command>& commands,
              const std::vector<Run>& runs, char** argv) {
  for (std::size_t k = 0; k < commands.size(); ++k)
    if (app.got_subcommand(commands[k].name)) {
      if (!runs[k]) return become(commands[k], argv);
      const int status = tellingMissingEngines(runs[k]);
      requireOutputWritten();
      return status;
    }
  return kOwnFailure;
}

}  // namespace

int front(int argc, char** argv, const std::vector<Command>& commands) {
  occupyStandardFiles();
  if (const int status = orFailure([] { return requireStack(), 0; }); status != 0) return status;
  static char help_option[] = "--help";
  if (argc > 1 && std::strcmp(argv[1], "help") == 0) {  // "help derive" is "derive --help"
    std::rotate(argv + 1, argv + 2, argv + argc);
    argv[argc - 1] = help_option;
  }
  for (const Command& command : commands)
    if (!command.add && argc > 1 && command.name == argv[1]) return become(command, argv);
  crosscheck::leaveNothingBehind();
  CLI::App app("Independent computations of a mechanism's dynamics testify against each other.",
               "dynwitness");
  app.require_subcommand(1);
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_version_flag("--version", "dynwitness " DYNWITNESS_VERSION, "The version");
  app.set_help_all_flag("--help-all", "Help of all subcommands");
  app.footer(
      "The wrapper ./dynwitness knows more words: test builds and runs all tests, bench the "
      "benchmarks; package, python and docs build a Debian package, the Python module and the "
      "documentation.\n\n"
      "SCENE is the name of a bundled scene ('dynwitness scenes' lists them), a TOML scene file, a "
      "URDF or an MJCF file. Exit status: 0 all agree; 1 a disagreement was found, or too little "
      "could be compared; 2 bad usage or bad input; 3 a failure of dynwitness itself.");
  std::vector<Run> runs;
  for (const Command& command : commands) {
    CLI::App* word = app.add_subcommand(command.name, command.description);
    runs.push_back(command.add ? command.add(word) : Run());
    addSpeech(*word);
  }
  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  readQuiet(words);
  try {
    const int known = orFailure([&] {
      if (!words.empty()) words = inTodaysSpelling(words);
      requireKnown(words, app, commands);
      return 0;
    });
    if (known != 0) return known;
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::Success& help) {
    return orFailure([&] {
      const int status = app.exit(help);
      requireOutputWritten();
      return status;
    });
  } catch (const CLI::ParseError& error) {
    const std::string who = words[0][0] == '-' ? "dynwitness" : "dynwitness " + words[0];
    tellFailure(fmt::format("{}: {} ({} --help)\n", who, error.what(), who));
    return kBadInput;
  }
  return orFailure([&] { return runParsed(app, commands, runs, argv); });
}

}  // namespace dynwitness::cli
