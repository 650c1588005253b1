// SPDX-License-Identifier: GPL-3.0-or-later
// Copies of this process that cannot harm it, and cells.
#include "crosscheck/system/cell.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include <signal.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <boost/test/unit_test.hpp>

#include "crosscheck/system/children.hpp"
#include "crosscheck/system/processes.hpp"
#include "tests/fixtures/files.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
namespace fs = std::filesystem;

namespace {

/// What work in a cell returns, or what is thrown; the cell is that of a copy.
std::string inside(const Cell& cell, bool hides,
                   const std::function<std::string(const fs::path&)>& work) {
  return triedInCopy(
      [&] {
        try {
          return "returned: " + inCell(cell, hides, work);
        } catch (const std::exception& error) {
          return std::string("thrown: ") + error.what();
        }
      },
      20);
}

bool hides() {
  return whyNothingIsHidden().empty();
}

}  // namespace

BOOST_AUTO_TEST_CASE(copies_end_each_in_its_own_way) {
  constexpr int kCount = 7;
  const auto work = [](int index) -> std::string {
    switch (index) {
      case 0:
        return std::string(1 << 20, 'x');
      case 1:
        throw std::runtime_error("a reason");
      case 2:
        raise(SIGKILL);  // Boost.Test would catch others
        break;
      case 3:
        for (;;) pause();
      case 4:
        _exit(7);
      case 5:
        return "";
      default:
        break;
    }
    return "six";
  };
  for (const int at_a_time : {1, 3, 20}) {
    std::map<int, CopyEnded> all;
    inOwnCopies(at_a_time, kCount, 1, work, [&](int index, const CopyEnded& ended) {
      BOOST_TEST(all.count(index) == 0u);
      all[index] = ended;
    });
    BOOST_TEST_REQUIRE(all.size() == static_cast<std::size_t>(kCount));
    BOOST_TEST(all[0].answer == std::string(1 << 20, 'x'));
    BOOST_TEST(all[1].problem == "a reason");
    BOOST_TEST(all[2].problem == "its process was ended by a signal (Killed)");
    BOOST_TEST(all[3].problem == "was not done within 1 s");
    BOOST_TEST(all[4].problem == "its process failed with status 7");
    BOOST_TEST(all[5].problem.empty());
    BOOST_TEST(all[6].answer == "six");
  }
  inOwnCopies(1, 0, 1, work, [](int, const CopyEnded&) { BOOST_TEST(false); });
}

BOOST_AUTO_TEST_CASE(what_happens_in_a_cell_comes_back) {
  for (const bool hidden : {false, true}) {
    if (hidden && !hides()) continue;
    BOOST_TEST_CONTEXT(hidden) {
      BOOST_TEST(inside({}, hidden, [](const fs::path&) { return "a word"; }) ==
                 "returned: a word");
      BOOST_TEST(inside({}, hidden, [](const fs::path&) -> std::string {
                   throw std::runtime_error("a reason");
                 }) == "thrown: a reason");
      BOOST_TEST(inside({}, hidden, [](const fs::path&) -> std::string { _exit(3); }) ==
                 "thrown: the process that listened to it failed with status 3");
      setenv("KEPT", "1", 1);
      setenv("NOT_KEPT", "1", 1);
      BOOST_TEST(inside({{}, {"KEPT", "NOT_THERE"}}, hidden, [](const fs::path& folder) {
                   int count = 0;
                   for (char** each = environ; *each; ++each) ++count;
                   return std::to_string(count) + std::to_string(getenv("KEPT") != nullptr) +
                          std::to_string(getenv("HOME") == folder.string()) +
                          std::to_string(fs::is_empty(folder)) +
                          std::to_string(fs::current_path() == folder);
                 }) == "returned: 31111");
    }
  }
}

// Who counts processes may not get a turn while they grow.
BOOST_AUTO_TEST_CASE(in_a_cell_nobody_forks_without_end,
                     *boost::unit_test::precondition([](boost::unit_test::test_unit_id) {
                       return boost::test_tools::assertion_result(hides());
                     })) {
  const std::string ours = files::read("/proc/sys/kernel/pid_max");
  Cell cell;
  cell.processes = 20;
  constexpr int kMany = 2000;
  const std::string said = inside(cell, true, [](const fs::path&) {
    int count = 0;
    for (; count < kMany; ++count) {
      const pid_t copy = fork();
      if (copy == 0)
        for (;;) pause();
      if (copy < 0) break;
    }
    return std::to_string(count);
  });
  BOOST_TEST_REQUIRE(said.rfind("returned: ", 0) == 0u, said);
  const int count = std::stoi(said.substr(std::string("returned: ").size()));
  // root is not bound by its limit of processes, but by numbers for them, since Linux 6.14
  BOOST_TEST((count <= 20 || (geteuid() == 0 && count <= kMany)), said);
  utsname kernel{};
  uname(&kernel);
  int major = 0, minor = 0;
  std::sscanf(kernel.release, "%d.%d", &major, &minor);
  if (std::make_pair(major, minor) >= std::make_pair(6, 14)) BOOST_TEST(count <= 301, said);
  BOOST_TEST(files::read("/proc/sys/kernel/pid_max") == ours);
}

BOOST_AUTO_TEST_CASE(a_cell_hides_and_keeps_in,
                     *boost::unit_test::precondition([](boost::unit_test::test_unit_id) {
                       return boost::test_tools::assertion_result(hides());
                     })) {
  const files::TemporaryFolder seen;
  const fs::path var = "/var/tmp";
  const fs::path file = seen.path / "file", folder = seen.path / "folder";
  std::ofstream(file) << "text";
  fs::create_directory(folder);
  BOOST_TEST(inside({{seen.path, DYNWITNESS_PROGRAM, fs::path(DYNWITNESS_DATA_DIR)}, {}}, true,
                    [&](const fs::path&) {
                      std::string said;
                      for (const fs::path& path : {file, folder})
                        said += fs::exists(path) ? "seen " : "hidden ";
                      said += fs::is_empty(DYNWITNESS_DATA_DIR) ? "hidden " : "seen ";
                      std::ifstream program(DYNWITNESS_PROGRAM);
                      said += program.get() == EOF ? "hidden " : "seen ";
                      std::ofstream out(fs::path(DYNWITNESS_SOURCE_DIR) / "left_by_a_test");
                      said += out ? "written " : "not written ";
                      std::ofstream own(var / "left_by_a_test");
                      return said + (own ? "written" : "not written");
                    }) == "returned: hidden hidden hidden hidden not written written");
  BOOST_TEST(!fs::exists(var / "left_by_a_test"));
  BOOST_TEST(fs::exists(file));
}
