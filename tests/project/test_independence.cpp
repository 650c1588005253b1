// SPDX-License-Identifier: GPL-3.0-or-later
// What the comparison of witnesses is worth: their folders share the scene's numbers and no
// formula. And what keeps the house standing: arrows between its floors point downward. Reads the
// include lines of the sources, and the link lines.
#include <filesystem>
#include <fstream>
#include <map>
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
    if (extension != ".hpp" && extension != ".cpp" && extension != ".h" && extension != ".inc" &&
        extension != ".in")
      continue;
    std::ifstream source(entry.path());
    for (const std::string& included : includedIn(source))
      all.push_back({entry.path().filename().string(), included});
  }
  return all;
}

const std::set<std::string> kTopFolders = {"scene", "symbolic", "recursive", "tests"};

/// The folder of this project that an include line reaches into, however it is spelled: one of
/// kTopFolders, or a floor of crosscheck/. Empty: its own folder, or another project.
std::string folderOf(const std::string& included) {
  std::string before;
  for (const fs::path& part : fs::path(included)) {
    if (before == "crosscheck" || (before == ".." && part != ".." && part != "crosscheck"))
      return part.string();
    if (kTopFolders.count(part.string()) == 1) return part.string();
    before = part.string();
  }
  return "";
}

/// A folder and the others that it may include.
struct Rule {
  const char* folder;
  std::set<std::string> may_include;

  bool isFloor() const { return kTopFolders.count(folder) == 0; }
  std::string path() const { return (isFloor() ? "crosscheck/" : "") + std::string(folder); }
};
std::ostream& operator<<(std::ostream& out, const Rule& rule) {
  return out << rule.folder;
}

/// The lowest first: arrows point upward in this table, and so downward in the house.
const std::vector<Rule> kRules = {
    {"scene", {}},
    {"symbolic", {"scene"}},
    {"recursive", {"scene"}},
    {"system", {"scene"}},
    {"inputs", {"scene"}},
    {"rereading", {}},  // a witness of what scene/ reads
    {"scalars", {"scene", "symbolic", "recursive", "inputs"}},
    {"kernel", {"scene", "symbolic", "recursive", "system", "scalars"}},
    {"python", {"scene", "symbolic", "recursive", "system", "inputs", "scalars", "kernel"}},
    {"witnesses", {"scene", "symbolic", "recursive", "system", "scalars", "kernel"}},
    {"laws", {"scene", "recursive", "scalars", "witnesses"}},
    {"motion", {"scene", "recursive", "inputs", "scalars", "witnesses"}},
    {"verdicts",
     {"scene", "recursive", "inputs", "rereading", "scalars", "witnesses", "laws", "motion"}},
    {"exact",
     {"scene", "symbolic", "recursive", "scalars", "kernel", "witnesses", "laws", "verdicts"}},
    {"diagnosis", {"scene", "symbolic", "system", "inputs", "scalars", "witnesses", "verdicts"}},
    {"golden", {"scene", "inputs", "scalars", "witnesses", "verdicts"}},
    {"studies",
     {"scene", "symbolic", "recursive", "inputs", "scalars", "witnesses", "laws", "motion",
      "verdicts", "exact"}},
    {"reduction",
     {"scene", "symbolic", "recursive", "inputs", "scalars", "kernel", "witnesses", "motion"}},
    {"conductor",
     {"scene", "symbolic", "system", "inputs", "witnesses", "motion", "verdicts", "exact"}},
    {"chart",
     {"scene", "symbolic", "recursive", "system", "inputs", "scalars", "kernel", "witnesses",
      "verdicts"}},
    {"report", {"scene", "system", "inputs", "motion", "verdicts", "chart"}},
    {"parameters",
     {"scene", "symbolic", "recursive", "inputs", "scalars", "witnesses", "motion", "exact",
      "report"}},
    {"readers", {"scene", "recursive", "system", "inputs", "scalars", "witnesses", "report"}},
    {"audit",
     {"scene", "symbolic", "recursive", "system", "inputs", "scalars", "witnesses", "studies",
      "report"}},
    {"growth", {"scene", "recursive", "system", "inputs", "witnesses", "verdicts", "report"}},
    {"stability",
     {"scene", "recursive", "system", "scalars", "witnesses", "motion", "verdicts", "chart",
      "report"}},
    {"grade", {"scene", "system", "witnesses", "diagnosis", "report"}},
    {"campaign",
     {"scene", "system", "inputs", "witnesses", "verdicts", "exact", "conductor", "report"}},
    {"cli", {"scene",  "symbolic",  "system",    "inputs",     "kernel",  "witnesses",
             "motion", "verdicts",  "exact",     "parameters", "readers", "diagnosis",
             "golden", "studies",   "conductor", "chart",      "report",  "audit",
             "growth", "stability", "grade",     "reduction",  "campaign"}},
};

std::string textOf(const fs::path& file) {
  std::ifstream source(file);
  std::ostringstream text;
  text << source.rdbuf();
  return text.str();
}

/// Code without comments and without what stands in quotes.
std::string codeOf(const std::string& text) {
  static const std::regex no_code(
      R"re(//[^\n]*|/\*[^*]*\*+([^/*][^*]*\*+)*/|"([^"\\\n]|\\.)*"|'([^'\\\n]|\\.)')re");
  return std::regex_replace(text, no_code, " ");
}

/// Numbers written with a negative power of ten or two.
std::set<std::string> smallNumbersIn(const std::string& code) {
  static const std::regex small(R"re(\b(0x[0-9a-fA-F.]+p-|[0-9][0-9.]*[eE]-)[0-9]+)re");
  std::set<std::string> found;
  for (auto it = std::sregex_iterator(code.begin(), code.end(), small);
       it != std::sregex_iterator(); ++it)
    found.insert(it->str());
  return found;
}

/// The sources of the crosscheck, by their path in the project.
std::map<std::string, std::string> crosscheckSources() {
  std::map<std::string, std::string> sources;
  const fs::path root(DYNWITNESS_SOURCE_DIR);
  for (const auto& entry : fs::recursive_directory_iterator(root / "crosscheck"))
    if (entry.is_regular_file() && entry.path().extension() != ".png")
      sources[entry.path().lexically_relative(root).generic_string()] = textOf(entry.path());
  return sources;
}

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
  BOOST_TEST(folderOf("boost/system/error_code.hpp") == "");
  BOOST_TEST(folderOf("crosscheck/kernel/emit.hpp") == "kernel");
  BOOST_TEST(folderOf("../kernel/emit.hpp") == "kernel");
  BOOST_TEST(folderOf("../../crosscheck/kernel/emit.hpp") == "kernel");
  BOOST_TEST(folderOf("tests/fixtures/fixtures.hpp") == "tests");
}

BOOST_DATA_TEST_CASE(a_folder_includes_only_what_it_may, data::make(kRules), rule) {
  const std::vector<Include> includes = includesOf(rule.path());
  int own = 0;
  for (const Include& include : includes) {
    const std::string folder = folderOf(include.included);
    own += folder == rule.folder ? 1 : 0;
    BOOST_TEST((folder.empty() || folder == rule.folder || rule.may_include.count(folder) == 1),
               rule.path() << "/" << include.file << " includes " << include.included);
  }
  BOOST_TEST(own > 0);  // the folder was read at all
}

BOOST_AUTO_TEST_CASE(a_rule_names_only_folders_above_it_in_the_table) {
  std::set<std::string> lower;
  for (const Rule& rule : kRules) {
    for (const std::string& folder : rule.may_include)
      BOOST_TEST(lower.count(folder) == 1u, rule.folder << " may include " << folder);
    lower.insert(rule.folder);
  }
}

BOOST_AUTO_TEST_CASE(every_folder_of_the_crosscheck_has_a_rule) {
  std::set<std::string> floors, found;
  for (const Rule& rule : kRules)
    if (rule.isFloor()) floors.insert(rule.folder);
  for (const auto& entry : fs::directory_iterator(fs::path(DYNWITNESS_SOURCE_DIR) / "crosscheck")) {
    const std::string name = entry.path().filename().string();
    BOOST_TEST(entry.is_directory(), "crosscheck/" << name << " lies on no floor");
    if (name != "cmake") found.insert(name);
  }
  BOOST_TEST(found == floors, boost::test_tools::per_element());
}

// What a folder's library is linked to is what it may include.
BOOST_AUTO_TEST_CASE(link_lines_say_what_the_rules_say) {
  const std::string cmake = textOf(fs::path(DYNWITNESS_SOURCE_DIR) / "CMakeLists.txt");
  static const std::regex floor(R"re(\ndynwitness_floor\((\w+)[^)]*?\bLINK([^)]*)\))re");
  std::map<std::string, std::set<std::string>> linked;
  for (auto it = std::sregex_iterator(cmake.begin(), cmake.end(), floor);
       it != std::sregex_iterator(); ++it) {
    std::istringstream words((*it)[2]);
    for (std::string word; words >> word && word.find("OUTSIDE") == std::string::npos;)
      linked[(*it)[1]].insert(word);
  }
  // commands in programs of their own have more
  static const std::regex program(R"re(\nset\(DYNWITNESS_\w+_LINK([^)]*)\))re");
  for (auto it = std::sregex_iterator(cmake.begin(), cmake.end(), program);
       it != std::sregex_iterator(); ++it) {
    std::istringstream words((*it)[1]);
    for (std::string word; words >> word;)
      linked["cli"].insert(word.substr(std::string("dynwitness::").size()));
  }
  // so has the module
  const std::string python =
      textOf(fs::path(DYNWITNESS_SOURCE_DIR) / "crosscheck/cmake/python.cmake");
  static const std::regex ours(R"re(\bdynwitness::(\w+))re");
  for (auto it = std::sregex_iterator(python.begin(), python.end(), ours);
       it != std::sregex_iterator(); ++it)
    linked["python"].insert((*it)[1]);
  for (const Rule& rule : kRules) {
    if (!rule.isFloor()) continue;
    BOOST_TEST_CONTEXT(rule.folder)
    BOOST_TEST(linked[rule.folder] == rule.may_include, boost::test_tools::per_element());
  }
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

BOOST_AUTO_TEST_CASE(small_numbers_are_found_in_code_only) {
  const std::string source =
      "if (x < 1e-9) return;  // not 1e-8\n/* nor * 1e-7 */ print(\"1e-6 \\\" 1e-5\"); y = "
      "0x1p-53, z = 2.5E-3;\n";
  BOOST_TEST(
      (smallNumbersIn(codeOf(source)) == std::set<std::string>{"1e-9", "0x1p-53", "2.5E-3"}));
}

// A limit comes from an error bound or from a printed digit; a word for one that does not is not
// needed. What a user allows a smaller model to miss is an option, reduce --tolerance.
BOOST_AUTO_TEST_CASE(no_source_of_the_crosscheck_speaks_of_a_tolerance) {
  static const std::regex word("(^|[^-])tolerance", std::regex::icase);
  const auto sources = crosscheckSources();
  BOOST_TEST(sources.size() > 50u);  // the folder was read at all
  for (const auto& [file, text] : sources) BOOST_TEST(!std::regex_search(text, word), file);
}

// --quiet is kept by tell() alone (standard_files.hpp).
BOOST_AUTO_TEST_CASE(no_command_writes_to_standard_error_by_itself) {
  static const std::regex direct(R"re(\b(stderr|cerr|clog)\b)re");
  for (const auto& [file, text] : crosscheckSources())
    if (file.rfind("crosscheck/cli/", 0) == 0 && fs::path(file).stem() != "standard_files" &&
        (fs::path(file).extension() == ".cpp" || fs::path(file).extension() == ".hpp"))
      BOOST_TEST(!std::regex_search(codeOf(text), direct), file);
}

// Small numbers in code are where limits chosen by hand would be: these are all, and what they are.
BOOST_AUTO_TEST_CASE(no_limit_of_the_crosscheck_is_chosen_by_hand) {
  const std::map<std::string, std::set<std::string>> known = {
      {"crosscheck/verdicts/backward_error.cpp",
       {"0x1p-20"}},  // of an ulp: how narrow balls are asked to be
      {"crosscheck/laws/narrow_sides.hpp", {"0x1p-20"}},  // the same
      {"crosscheck/kernel/kernel.cpp",
       {"0x1p-52"}},  // an operand of the program that tells compilers apart
      {"crosscheck/verdicts/check_drift.cpp",
       {"1e-6", "1e-8", "1e-10"}},                            // asked of adaptive steps
      {"crosscheck/report/page_scene.cpp", {"1e-10"}},        // words about the control
      {"crosscheck/witnesses/simbody.cpp", {"1e-100"}},       // a mass [kg] that drops out
      {"crosscheck/chart/chart.cpp", {"1e-9"}},               // seconds in a nanosecond
      {"crosscheck/report/chart_drawing.cpp", {"1e-9"}},      // the same
      {"crosscheck/cli/crosscheck_command.cpp", {"1e-300"}},  // least --error-probability
      {"crosscheck/growth/growth.cpp", {"1e-9"}},             // seconds in a nanosecond
      {"crosscheck/cli/linearize_command.cpp", {"1e-9"}},     // digits printed of approximations
      {"crosscheck/cli/sweep_command.cpp", {"1e-14"}},        // what is printed as 0 beside others
      {"crosscheck/report/view.cpp", {"1e-10"}},              // what is drawn at 0
      {"crosscheck/verdicts/options.hpp", {"1e-30"}},         // default of --error-probability
      {"crosscheck/exact/exact.hpp", {"1e-30"}},              // the same
      {"crosscheck/exact/ledger.hpp", {"1e-30"}},             // the same
      {"crosscheck/audit/trial.cpp", {"1e-30"}},              // the same
      {"crosscheck/audit/board.cpp", {"1e-12"}},              // what is printed as 0 beside others
      {"crosscheck/motion/simulate.hpp", {"1e-10"}},          // default of --step-error
      {"crosscheck/motion/closed_work.cpp", {"1e-2"}},        // first of errors asked of steps
      {"crosscheck/motion/simulate.cpp", {"1e-12"}},  // a step [s] at which integration is given up
      {"crosscheck/diagnosis/judge_formulas.cpp",
       {"1e-18"}},  // chance that a formula passes which is wrong, as exact checks have theirs
      {"crosscheck/motion/step_advice.cpp",
       {"1e-12", "1e-3", "1e-8"}},  // |R| - 1 that is a step's rounding; where scans begin
      {"crosscheck/motion/step_gains.cpp",
       {"1e-4"}},  // asked of steps that adapt, of the state: gains as large as all energy are sought
      {"crosscheck/stability/families_shapes.cpp", {"1e-15"}},  // MuJoCo's own mjMINVAL
      {"crosscheck/motion/work_precision.cpp",
       {"1e-20", "1e-6", "1e-9"}},  // digits counted; from where differences must fall
      {"crosscheck/studies/lowest_direction.cpp",
       {"1e-6"}},  // how far below the lowest eigenvalue iteration starts
      {"crosscheck/studies/motion_nodes.cpp",
       {"1e-6"}},  // from which share on independent rates no longer tell the others
      {"crosscheck/studies/near_motion_in.hpp",
       {"1e-9"}},  // from where Newton's steps have to halve
      {"crosscheck/campaign/campaign_plan.cpp",
       {"1e-30", "1e-300"}},  // chance of an error that a plan may ask for
      {"crosscheck/reduction/envelope_report.cpp",
       {"5e-6"}},  // what printing six digits may hide: bounds are printed outward by it
      {"crosscheck/reduction/reduce_report.cpp", {"5e-6"}},  // the same
      {"crosscheck/cli/reduce_command.cpp", {"1e-6"}},       // least share of Armstrong's rule
      {"crosscheck/parameters/parameters.hpp", {"1e-30", "1e-9"}},  // chances of error, defaults
      {"crosscheck/inputs/states.cpp", {"0x1p-53"}},                // 53 random bits to [0, 1)
      {"crosscheck/motion/uncertain_quantities.cpp", {"1e-10"}},  // least uncertainty that is taken
      {"crosscheck/conductor/plan.cpp",
       {"1.2e-5", "2e-4", "9e-4"}},  // seconds that a run is said to take
      {"crosscheck/witnesses/dart.cpp",
       {"1e-100", "1.001e-3"}},  // a time step that drops out; where DART cuts a series
      {"crosscheck/witnesses/mujoco_model.hpp", {"1e-12"}},  // MuJoCo's own eigEPS
  };
  for (const auto& [file, text] : crosscheckSources()) {
    if (fs::path(file).extension() != ".cpp" && fs::path(file).extension() != ".hpp") continue;
    const auto it = known.find(file);
    for (const std::string& number : smallNumbersIn(codeOf(text)))
      BOOST_TEST((it != known.end() && it->second.count(number) == 1),
                 file << ": " << number << ": derive it, or say here what it is");
  }
}
