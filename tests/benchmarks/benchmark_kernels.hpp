// SPDX-License-Identifier: GPL-3.0-or-later
// Kernels by each of the C compilers that are there.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <vector>

#include "crosscheck/kernel/compiled.hpp"
#include "crosscheck/kernel/kernel.hpp"
#include "crosscheck/report/bench.hpp"

namespace dynwitness::benchmarks {

/// A C compiler, and how contenders that it compiled are named.
struct KernelCompiler {
  std::string command, label;  ///< label: "gcc 12"
  const char* suffix;          ///< "", "_second"
};

/// "gcc 12" or "clang 14" of a C compiler.
inline std::string compilerLabel(const std::string& command) {
  const auto said = [&](const char* option) {
    std::string text;
    FILE* pipe = popen(("'" + command + "' " + option + " 2>/dev/null").c_str(), "r");
    for (int c; pipe && (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
    if (pipe) pclose(pipe);
    return text;
  };
  const std::string version = said("-dumpversion");
  return (said("--version").find("clang") != std::string::npos ? "clang " : "gcc ") +
         version.substr(0, version.find_first_of(".\n"));
}

/// While it lives, kernels are compiled by this command and kept in this folder (empty: as before).
class KernelEnvironment {
 public:
  explicit KernelEnvironment(const std::string& command, const std::string& folder = {}) {
    set("DYNWITNESS_CC", command);
    if (!folder.empty()) set("DYNWITNESS_CACHE", folder);
  }
  ~KernelEnvironment() {
    for (const auto& [name, value, was_set] : before_)
      was_set ? setenv(name.c_str(), value.c_str(), 1) : unsetenv(name.c_str());
  }
  KernelEnvironment(const KernelEnvironment&) = delete;
  KernelEnvironment& operator=(const KernelEnvironment&) = delete;

 private:
  struct Variable {
    std::string name, value;
    bool was_set;
  };
  void set(const char* name, const std::string& value) {
    const char* old = std::getenv(name);
    before_.push_back({name, old ? old : "", old != nullptr});
    setenv(name, value.c_str(), 1);
  }
  std::vector<Variable> before_;
};

/// The compiler that kernels are made with, and one of the other family where there is one. Without
/// the first there is none; reasons go to `left_out`.
inline std::vector<KernelCompiler> kernelCompilers(std::vector<std::string>* left_out = nullptr) {
  namespace kernel = crosscheck::kernel;
  std::vector<KernelCompiler> all;
  try {
    const std::string command = kernel::findCompiler()[0];
    kernel::cacheFolder();
    all.push_back({command, compilerLabel(command), ""});
  } catch (const kernel::CannotCompile& error) {
    if (left_out) left_out->push_back(std::string("kernels: ") + error.what());
    return all;
  }
  const bool is_clang = all[0].label.rfind("clang", 0) == 0;
  const std::vector<std::string> others = is_clang ? std::vector<std::string>{"gcc-12", "gcc"}
                                                   : std::vector<std::string>{"clang-14", "clang"};
  for (const std::string& other : others) {
    const KernelEnvironment environment(other);
    try {
      const std::string command = kernel::findCompiler()[0];
      all.push_back({command, compilerLabel(command), "_second"});
      return all;
    } catch (const kernel::CannotCompile&) {
    }
  }
  if (left_out)
    left_out->push_back(std::string("kernels by a second C compiler: no ") +
                        (is_clang ? "gcc" : "clang"));
  return all;
}

}  // namespace dynwitness::benchmarks
