// SPDX-License-Identifier: GPL-3.0-or-later
// The command line.
#include <cstdio>
#include <new>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/leaving.hpp"
#include "scene/error.hpp"

namespace {

constexpr int kBadInput = 2, kOwnFailure = 3;

/// The status of some work, or of how it failed, which is told.
template <typename Work>
int orFailure(const Work& work) {
  using dynwitness::cli::tell;
  try {
    return work();
  } catch (const dynwitness::scene::InputError& error) {
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

}  // namespace

int main(int argc, char** argv) {
  using namespace dynwitness;
  cli::occupyStandardFiles();
  crosscheck::leaveNothingBehind();
  CLI::App app("Independent computations of a mechanism's dynamics testify against each other.",
               "dynwitness");
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Help of all subcommands");
  app.footer(
      "The wrapper ./dynwitness knows two more words: test builds and runs all tests, bench the "
      "benchmarks.\n"
      "SCENE is the name of a bundled scene ('dynwitness scenes' lists them), a TOML scene file "
      "or a\n"
      "URDF file. Exit status: 0 all agree; 1 a disagreement was found, or too little could be "
      "compared;\n"
      "2 bad usage or bad input; 3 a failure of dynwitness itself.");
  std::vector<std::pair<const char*, cli::Run>> commands = {
      {"crosscheck", cli::addCrosscheck(app)}, {"derive", cli::addDerive(app)},
      {"evaluate", cli::addEvaluate(app)},     {"drift", cli::addDrift(app)},
      {"chart", cli::addChart(app)},           {"audit", cli::addAudit(app)},
      {"simulate", cli::addSimulate(app)},     {"rotors", cli::addRotors(app)},
      {"parameters", cli::addParameters(app)}, {"geometry", cli::addGeometry(app)},
      {"action", cli::addAction(app)},         {"impulse", cli::addImpulse(app)},
      {"impedance", cli::addImpedance(app)},   {"growth", cli::addGrowth(app)},
      {"scenes", cli::addScenes(app)},         {"version", cli::addVersion(app)}};
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return orFailure([&] {
      const int status = app.exit(help);
      cli::requireOutputWritten();
      return status;
    });
  } catch (const CLI::ParseError& error) {
    app.exit(error);
    return kBadInput;
  }
  return orFailure([&] {
    for (const auto& [name, run] : commands)
      if (app.got_subcommand(name)) {
        const int status = run();
        cli::requireOutputWritten();
        return status;
      }
    return kOwnFailure;
  });
}
