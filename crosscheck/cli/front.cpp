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

#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/system/leaving.hpp"
#include "scene/error.hpp"

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
    tell(fmt::format("dynwitness: {}\n", error.what()));
    return kBadInput;
  } catch (const std::bad_alloc&) {
    tell("dynwitness: failed: not enough memory\n");  // and without asking for any
  } catch (const std::exception& error) {
    tell(fmt::format("dynwitness: failed: {}{}\n", std::ferror(stdout) ? "standard output: " : "",
                     error.what()));
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
  std::error_code ignored;
  std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", ignored);
  if (self.empty()) self = argv[0];
  const std::filesystem::path program = self.parent_path() / command.program;
  execv(program.c_str(), argv);
  tell(fmt::format("dynwitness: {} is in a program of its own, {}: {}; ./dynwitness {} builds it\n",
                   command.name, program.string(), std::strerror(errno), command.name));
  return kBadInput;
}

}  // namespace

int front(int argc, char** argv, const std::vector<Command>& commands) {
  occupyStandardFiles();
  if (const int status = orFailure([] { return requireStack(), 0; }); status != 0) return status;
  for (const Command& command : commands)
    if (!command.add && argc > 1 && command.name == argv[1]) return become(command, argv);
  crosscheck::leaveNothingBehind();
  CLI::App app("Independent computations of a mechanism's dynamics testify against each other.",
               "dynwitness");
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Help of all subcommands");
  app.footer(
      "The wrapper ./dynwitness knows two more words: test builds and runs all tests, bench the "
      "benchmarks.\n"
      "SCENE is the name of a bundled scene ('dynwitness scenes' lists them), a TOML scene file, "
      "a\n"
      "URDF or an MJCF file. Exit status: 0 all agree; 1 a disagreement was found, or too little could be "
      "compared;\n"
      "2 bad usage or bad input; 3 a failure of dynwitness itself.");
  std::vector<Run> runs;
  for (const Command& command : commands) {
    CLI::App* word = app.add_subcommand(command.name, command.description);
    runs.push_back(command.add ? command.add(word) : Run());
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return orFailure([&] {
      const int status = app.exit(help);
      requireOutputWritten();
      return status;
    });
  } catch (const CLI::ParseError& error) {
    app.exit(error);
    return kBadInput;
  }
  return orFailure([&] {
    for (std::size_t k = 0; k < commands.size(); ++k)
      if (app.got_subcommand(commands[k].name)) {
        if (!runs[k]) return become(commands[k], argv);
        const int status = runs[k]();
        requireOutputWritten();
        return status;
      }
    return kOwnFailure;
  });
}

}  // namespace dynwitness::cli
