// SPDX-License-Identifier: GPL-3.0-or-later
// What a result was computed with and where: the report's footer.
#pragma once

#include <string>
#include <vector>

namespace dynwitness::crosscheck {

struct Environment {
  struct Library {
    std::string name, version;
  };
  std::string version;  ///< of dynwitness
  std::string commit;   ///< of its source; empty when it was not built from a git checkout
  std::string compiler, flags;
  std::string cpu;   ///< model name
  std::string date;  ///< UTC, "2025-11-21T10:45:00Z"
  std::vector<Library> libraries;
};

/** The environment of this process.

    @param more  libraries whose version only their own headers tell (Simbody: include it here and
                 caller's layout changes with it), appended in the order given
    @param gnuplot  its version, for callers that asked early (askGnuplotVersion()); empty: asked
      here The date follows SOURCE_DATE_EPOCH where it is set, so that reports can be byte for byte
      equal.
 */
Environment thisEnvironment(const std::vector<Environment::Library>& more = {},
                            const std::string& gnuplot = {});

/// The processor's model name; "unknown" where /proc/cpuinfo has none.
std::string cpuModel();

/// "2025-11-21T10:45:00Z" of a file's or the system's clock [s since 1970].
std::string utcDate(long long seconds);

}  // namespace dynwitness::crosscheck
