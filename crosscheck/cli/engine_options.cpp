// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/engine_options.hpp"

#include "crosscheck/cli/options.hpp"

namespace dynwitness::cli {

CLI::Option* addEngineOptions(CLI::App& command, std::vector<std::string>& engines,
                              crosscheck::Limits& limits) {
  CLI::Option* engine = command.add_option(
      "--engine", engines,
      "A program of yours as one more witness: a shell's words, \"python3 my_arm.py\". It answers "
      "lines of JSON (crosscheck/witnesses/engine_protocol.md)");
  engine->allow_extra_args(false);  // one word each, so that scenes may follow
  command
      .add_option("--engine-seconds", limits.seconds,
                  "Time that such a program has for one answer [s]")
      ->capture_default_str()
      ->needs(engine)
      ->check(between(0.1, 86400));
  command
      .add_option("--engine-memory", limits.gigabytes,
                  "Address space that each of its processes may have [GB]")
      ->capture_default_str()
      ->needs(engine)
      ->check(between(0.01, 1000000));
  return engine;
}

}  // namespace dynwitness::cli
