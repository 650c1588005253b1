// SPDX-License-Identifier: GPL-3.0-or-later
// The stability atlas in the report: a mark for each breakdown, and files that are no atlas.
#include "crosscheck/report/atlas_glance.hpp"

#include <fstream>

#include <boost/test/unit_test.hpp>
#include <nlohmann/json.hpp>

#include "scene/error.hpp"
#include "tests/fixtures/files.hpp"

using namespace dynwitness;
using Json = nlohmann::json;

namespace {

Json method(const char* name, const Json& breaks_at, bool is_ours, const char* numbers) {
  return {{"method", name},     {"left_out", nullptr},    {"is_ours", is_ours},
          {"numbers", numbers}, {"breaks_at", breaks_at}, {"is_step", false},
          {"silent", 0}};
}

/// One family: three methods break, one survives, one theory.
Json atlas() {
  return {{"dynwitness", "1"},
          {"fewest_digits", 3},
          {"silent_ours", 0},
          {"silent_others", 0},
          {"families",
           {{{"title", "masses"},
             {"dial", "ratio"},
             {"unit", ""},
             {"quantity", "qdd"},
             {"from", 1},
             {"to", 1e12},
             {"theories", {{{"methods", "solved"}, {"breaks_double", 1e9}}}},
             {"methods",
              {method("a", 1e6, true, "double"), method("b", 1e3, true, "float"),
               method("c", 1e8, false, "double"), method("d", nullptr, true, "double"),
               method("e", 0, true, "double")}}}}}};
}

std::string sectionOf(const std::string& text) {
  const files::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "stability.json";
  std::ofstream(file) << text;
  return crosscheck::atlasSection(file);
}

std::string refusalOf(const std::string& text) {
  try {
    sectionOf(text);
  } catch (const scene::InputError& error) {
    return error.what();
  }
  return "not refused";
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_mark_stands_for_each_breakdown) {
  const std::string page = sectionOf(atlas().dump());
  BOOST_TEST(files::count(page, "<title>") == 4u);  // one is harmless, one has no place on the dial
  BOOST_TEST(files::count(page, "<circle class=\"ours\"") == 1u);
  BOOST_TEST(files::count(page, "<circle class=\"others\"") == 1u);
  BOOST_TEST(files::count(page, "<rect class=\"ours\"") == 1u);
  BOOST_TEST(files::count(page, "<line class=\"theory\"") == 1u);
  BOOST_TEST(files::contains(page, "cx=\"120.0\""));  // 1e6 of 1 to 1e12: the middle
  BOOST_TEST(!files::contains(page, "nan"));
}

BOOST_AUTO_TEST_CASE(what_is_no_atlas_is_refused_with_its_name) {
  for (const char* text : {"no JSON", "[]", "{}", "{\"families\": [{}]}"}) {
    const std::string said = refusalOf(text);
    BOOST_TEST(files::contains(said, "stability.json: "), said);
  }
  for (const Json& to : {Json(0), Json(-1), Json(1)}) {
    Json of = atlas();
    of["families"][0]["to"] = to;
    const std::string said = refusalOf(of.dump());
    BOOST_TEST(files::contains(said, "allowed: two different numbers > 0"), said);
  }
}
