// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/system/environment.hpp"

#include <cstdlib>
#include <ctime>
#include <fstream>

#include <Eigen/src/Core/util/Macros.h>  // the version alone: Eigen/Core takes a second to compile
#include <fmt/core.h>
#include <fmt/format.h>
#include <ginac/version.h>
#include <CLI/Version.hpp>
#include <boost/version.hpp>
#if __has_include(<toml++/impl/version.hpp>)  // since 3.4
#include <toml++/impl/version.hpp>
#elif __has_include(<toml++/impl/version.h>)
#include <toml++/impl/version.h>
#endif
#include <nlohmann/json.hpp>

#include "crosscheck/system/gnuplot.hpp"

// the build says what the compiler cannot know
#ifndef DYNWITNESS_VERSION
#define DYNWITNESS_VERSION "unknown"
#endif
#ifndef DYNWITNESS_COMMIT
#define DYNWITNESS_COMMIT ""
#endif
#ifndef DYNWITNESS_COMPILER
#define DYNWITNESS_COMPILER __VERSION__
#endif
#ifndef DYNWITNESS_FLAGS
#define DYNWITNESS_FLAGS ""
#endif

namespace dynwitness::crosscheck {
namespace {

std::string triple(int major, int minor, int patch) {
  return fmt::format("{}.{}.{}", major, minor, patch);
}

long long now() {
  // https://reproducible-builds.org/specs/source-date-epoch/
  if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH")) {
    char* end = nullptr;
    const long long seconds = std::strtoll(epoch, &end, 10);
    if (end != epoch && *end == '\0') return seconds;
  }
  return static_cast<long long>(std::time(nullptr));
}

}  // namespace

std::string cpuModel() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(':');
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) {
      const std::size_t start = line.find_first_not_of(' ', colon + 1);
      if (start != std::string::npos) return line.substr(start);
    }
  }
  return "unknown";  // not Linux on x86
}

std::string utcDate(long long seconds) {
  const std::time_t time = static_cast<std::time_t>(seconds);
  std::tm utc{};
  if (gmtime_r(&time, &utc) == nullptr) return "unknown";
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", utc.tm_year + 1900, utc.tm_mon + 1,
                     utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec);
}

Environment thisEnvironment(const std::vector<Environment::Library>& more,
                            const std::string& gnuplot) {
  Environment e;
  e.version = DYNWITNESS_VERSION;
  e.commit = DYNWITNESS_COMMIT;
  e.compiler = DYNWITNESS_COMPILER;
  e.flags = DYNWITNESS_FLAGS;
  e.cpu = cpuModel();
  e.date = utcDate(now());
  e.libraries = {
      {"Eigen", triple(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
      {"GiNaC", GINACLIB_VERSION},
      {"Boost", triple(BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100)},
      {"fmt", triple(FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)},
#ifdef TOML_LIB_MAJOR
      {"toml++", triple(TOML_LIB_MAJOR, TOML_LIB_MINOR, TOML_LIB_PATCH)},
#endif
      {"nlohmann_json", triple(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
                               NLOHMANN_JSON_VERSION_PATCH)},
      {"CLI11", CLI11_VERSION},
      {"gnuplot", gnuplot.empty() ? gnuplotVersion() : gnuplot},
  };
  e.libraries.insert(e.libraries.end(), more.begin(), more.end());
  return e;
}

}  // namespace dynwitness::crosscheck
