// SPDX-License-Identifier: GPL-3.0-or-later
// What the comparison of witnesses is worth: their folders share the scene's numbers and no
// formula. Reads the include lines of the sources.
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE independence
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

namespace data = boost::unit_test::data;
namespace fs = std::filesystem;

namespace {

/// "#include <x/y.hpp>" or "x/y.hpp" in quotes, in any spacing.
std::vector<std::string> includedIn(std::istream& source) {
  static const std::regex pattern(R"re(^\s*#\s*include\s*["<]([^">]+)[">].*)re");
  std::vector<std::string> included;
  std::smatch match;
  for (std::string line; std::getline(source, line);)
    if (std::regex_match(line, match, pattern)) included.push_back(match[1]);
  return included;
}

struct Include {
  std::string file, included;
};

std::vector<Include> includesOf(const std::string& folder) {
  std::vector<Include> all;
  for (const auto& entry :
       fs::recursive_directory_iterator(fs::path(DYNWITNESS_SOURCE_DIR) / folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".hpp" && extension != ".cpp" && extension != ".h" && extension != ".inc")
      continue;
    std::ifstream source(entry.path());
    for (const std::string& included : includedIn(source))
      all.push_back({entry.path().filename().string(), included});
  }
  return all;
}

/// The folder of this project that an include line reaches into, however it is spelled.
std::string folderOf(const std::string& included) {
  for (const fs::path& part : fs::path(included))
    for (const char* folder : {"scene", "symbolic", "recursive", "crosscheck"})
      if (part == folder) return folder;
  return "";
}

struct Rule {
  const char* folder;
  std::set<std::string> may_include;
};
std::ostream& operator<<(std::ostream& out, const Rule& rule) {
  return out << rule.folder;
}

const std::vector<Rule> kRules = {{"scene", {"scene"}},
                                  {"symbolic", {"scene", "symbolic"}},
                                  {"recursive", {"scene", "recursive"}}};

}  // namespace

BOOST_AUTO_TEST_CASE(include_lines_are_recognised_in_every_spelling) {
  std::istringstream source(
      "#include \"recursive/model.hpp\"\n"
      "  #  include <symbolic/graph.hpp>  // why\n"
      "// #include \"crosscheck/crosscheck.hpp\"\n"
      "#include \"../recursive/spatial.hpp\"\n");
  const std::vector<std::string> found = includedIn(source);
  BOOST_REQUIRE(found.size() == 3u);
  BOOST_TEST(folderOf(found[0]) == "recursive");
  BOOST_TEST(folderOf(found[1]) == "symbolic");
  BOOST_TEST(folderOf(found[2]) == "recursive");
  BOOST_TEST(folderOf("Eigen/Core") == "");
}

BOOST_DATA_TEST_CASE(a_folder_includes_only_what_it_may, data::make(kRules), rule) {
  const std::vector<Include> includes = includesOf(rule.folder);
  int own = 0;
  for (const Include& include : includes) {
    const std::string folder = folderOf(include.included);
    own += folder == rule.folder ? 1 : 0;
    BOOST_TEST((folder.empty() || rule.may_include.count(folder) == 1),
               rule.folder << "/" << include.file << " includes " << include.included);
  }
  BOOST_TEST(own > 0);  // the folder was read at all
}

// The sweeps need no computer algebra, and the derivation no spatial algebra.
BOOST_AUTO_TEST_CASE(the_two_sides_use_different_libraries) {
  for (const Include& include : includesOf("symbolic"))
    BOOST_TEST((include.included.rfind("Eigen", 0) == std::string::npos),
               "symbolic/" << include.file << " includes " << include.included);
  for (const Include& include : includesOf("recursive"))
    BOOST_TEST((include.included.rfind("ginac", 0) == std::string::npos),
               "recursive/" << include.file << " includes " << include.included);
}
