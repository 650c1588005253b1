// SPDX-License-Identifier: GPL-3.0-or-later
// The program as its user runs it, for tests: in a folder of its own, with its exit status and what
// it says.
#pragma once

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <sys/wait.h>
#include <unistd.h>
#include <boost/test/unit_test.hpp>

namespace dynwitness::fixtures {

struct Outcome {
  int status;
  std::string out;  // standard output and standard error
};

/// Runs the program in a folder of its own.
class Program {
 public:
  Program()
      : folder_(std::filesystem::temp_directory_path() /
                ("dynwitness_cli_" + std::to_string(getpid()))) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~Program() { std::filesystem::remove_all(folder_); }

  Outcome run(const std::string& words, const std::string& redirect = "2>&1") const {
    const std::string command =
        "cd '" + folder_.string() + "' && " + DYNWITNESS_PROGRAM + " " + words + " " + redirect;
    FILE* pipe = popen(command.c_str(), "r");
    BOOST_REQUIRE(pipe != nullptr);
    Outcome outcome{0, ""};
    std::array<char, 4096> buffer;
    for (std::size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
      outcome.out.append(buffer.data(), n);
    outcome.status = WEXITSTATUS(pclose(pipe));
    return outcome;
  }
  void write(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ / file) << text;
  }
  std::string read(const std::string& file) const {
    std::ifstream in(folder_ / file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  bool exists(const std::string& file) const { return std::filesystem::exists(folder_ / file); }
  std::size_t fileCount(const std::string& folder = "") const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_ / folder),
                      std::filesystem::directory_iterator()));
  }

 private:
  std::filesystem::path folder_;
};

inline void refuses(const Program& program, const std::string& words, const std::string& part) {
  const Outcome outcome = program.run(words);
  BOOST_TEST_CONTEXT(words << "\n" << outcome.out) {
    BOOST_TEST(outcome.status == 2);
    BOOST_TEST(outcome.out.find(part) != std::string::npos);
  }
}

}  // namespace dynwitness::fixtures
