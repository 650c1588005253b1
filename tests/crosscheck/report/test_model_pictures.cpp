// SPDX-License-Identifier: GPL-3.0-or-later
// How little model, in the report: a mark for each model, a bar for each rung, and files that are
// neither.
#include "crosscheck/report/model_pictures.hpp"

#include <fstream>

#include <boost/test/unit_test.hpp>
#include <nlohmann/json.hpp>

#include "scene/error.hpp"
#include "tests/fixtures/files.hpp"

using namespace dynwitness;
using Json = nlohmann::json;

namespace {

Json model(double allowed, int operations, double certified) {
  return {{"allowed", allowed}, {"operations", operations}, {"certified", certified}};
}

Json front() {
  return {{"dynwitness", "1"},
          {"scene", "arm"},
          {"operations", 100},
          {"models", {model(0, 100, 0), model(0.01, 60, 0.008), model(0.1, 40, 0.09)}},
          {"as_scenes", {model(0, 100, 0), model(0.01, 80, 0.009), model(0.1, 70, 0.095)}}};
}

Json rung(const char* adds, const Json& operations, const Json& share) {
  return {{"adds", adds},
          {"operations", operations},
          {"misses_of_scene", share == 0 ? Json(nullptr) : Json({{"share", share}})},
          {"motion", {{"follows_s", 2}}}};
}

Json ladder() {
  return {{"dynwitness", "1"},
          {"scene", "arm"},
          {"duration_s", 2},
          {"rungs",
           {rung("point masses", 50, 0.25), rung("rotors", nullptr, nullptr),
            rung("friction", 100, 0)}}};
}

std::string sectionOf(const std::string& text) {
  const files::TemporaryFolder folder;
  const std::string file = folder.path / "model.json";
  std::ofstream(file) << text;
  return crosscheck::modelSections({file}, {"arm"}).at("arm");
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

BOOST_AUTO_TEST_CASE(a_front_has_a_mark_for_each_model_at_its_place) {
  const std::string page = sectionOf(front().dump());
  BOOST_TEST(files::count(page, "<circle class=\"ours\"") == 3u);
  BOOST_TEST(files::count(page, "<rect class=\"others\"") == 3u);
  BOOST_TEST(files::contains(page, "<title>60 operations, 0.8"));
  BOOST_TEST(files::contains(page, "own program: 100"));
  // 9.5 of 10 % of 514 px, the scene's own program 256 / 1.08 px above the axis
  BOOST_TEST(files::contains(page, "cx=\"544.3\""));
  BOOST_TEST(files::contains(page, "cx=\"56.0\" cy=\"53.0\""));
}

BOOST_AUTO_TEST_CASE(a_ladder_has_bars_in_proportion) {
  const std::string page = sectionOf(ladder().dump());
  BOOST_TEST(files::count(page, "<tr><th scope=\"row\">") == 3u);
  BOOST_TEST(files::contains(page, "width=\"75.0\""));  // 50 of 100 operations, of 150 px
  BOOST_TEST(files::contains(page, ">25 %</text>"));
  BOOST_TEST(files::contains(page, "+ rotors</th><td>–</td>"));
}

BOOST_AUTO_TEST_CASE(what_is_neither_is_refused) {
  BOOST_TEST(
      files::contains(refusalOf("{"), "expected JSON of `dynwitness reduce --front FOLDER`"));
  Json other = front();
  other["scene"] = "leg";
  BOOST_TEST(files::contains(refusalOf(other.dump()), "of scene 'leg', allowed: arm"));
  Json single = front();
  single["models"] = {model(0.01, 60, 0.008)};
  BOOST_TEST(files::contains(refusalOf(single.dump()), "one model alone"));
  Json broken = ladder();
  broken["rungs"][0].erase("adds");
  BOOST_TEST(files::contains(refusalOf(broken.dump()), "adds"));
}
