// SPDX-License-Identifier: GPL-3.0-or-later
// The picture shows the mechanism that the sweeps compute: its frames, by C++ and by the script in
// the page, are held to those of recursive/, another road.
#include "crosscheck/report/view.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <boost/test/unit_test.hpp>
#include <nlohmann/json.hpp>

#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/report/show.hpp"
#include "recursive/build_model.hpp"
#include "recursive/energy.hpp"
#include "scene/mimic.hpp"
#include "tests/fixtures/files.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Json = nlohmann::json;
using files::contains;

namespace {

/// A scene at a state, and where the sweeps' own frames put its links.
struct Case {
  scene::Scene scene;
  std::vector<double> q;
  std::vector<Matrix3d> R;            ///< link axes to world axes
  std::vector<Vector3d> origin, com;  ///< in the world
  double size = 1;                    ///< largest length that is added up [m]
};

Case caseOf(const scene::Scene& scene, std::uint64_t seed) {
  const scene::Mechanism& mechanism = scene.mechanism;
  const scene::RealNumbers<double> number(mechanism);
  const auto model = recursive::buildModel(mechanism, number);
  scene::State<double> state = drawState(mechanism, scene.name, seed, 0);
  scene::followLeaders(mechanism, &state.x);
  recursive::Workspace<double> ws(model);
  recursive::linkVelocities(model, state.x, state.qd, ws);
  std::vector<recursive::Transform<double>> X;  // world to link of the model
  for (std::size_t i = 0; i < model.links.size(); ++i)
    X.push_back(model.links[i].parent < 0 ? ws.X_up[i] : ws.X_up[i] * X[model.links[i].parent]);
  Case one{scene, {}, {}, {}, {}, 1};
  for (const auto& x : state.x) one.q.push_back(x.q);
  for (std::size_t i = 0; i < mechanism.links.size(); ++i) {
    const auto& place = model.places[i];
    const auto X_link = place.link < 0 ? place.X : place.X * X[place.link];
    const scene::Vector& c = mechanism.links[i].inertia.com;
    one.R.push_back(X_link.R.transpose());
    one.origin.push_back(X_link.p);
    one.com.push_back(X_link.p +
                      X_link.R.transpose() * Vector3d(number(c[0]), number(c[1]), number(c[2])));
    one.size = std::max({one.size, one.origin.back().norm(), one.com.back().norm()});
  }
  return one;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const auto& file : scene::bundledScenes()) all.push_back(caseOf(scene::readScene(file), 1));
  for (std::uint64_t i = 0; i < 40; ++i) all.push_back(caseOf(randomScene(7, i, 12), i));
  return all;
}

/// What frames in a row may round, each a few products and sums of lengths up to the largest.
double limitOf(const Case& one) {
  return 32 * std::numeric_limits<double>::epsilon() * one.size *
         static_cast<double>(1 + one.R.size());
}

std::vector<double> startOf(const View& view) {
  std::vector<double> q;
  for (const ViewSlot& slot : view.slots) q.push_back(slot.start);
  return q;
}

/// The script itself, run by node with what the page gives it: by case, how far it is off at most.
std::vector<double> worstOfScript(const std::vector<Case>& all) {
  const files::TemporaryFolder folder;
  {
    std::ofstream in(folder.path / "cases.json");
    in << "[";
    for (std::size_t k = 0; k < all.size(); ++k)
      in << (k == 0 ? "" : ",\n") << "{\"scene\":" << viewJson(viewOf(all[k].scene))
         << ",\"q\":" << Json(all[k].q) << "}";
    in << "]";
  }
  std::ofstream(folder.path / "run.js")
      << "const view = require('" DYNWITNESS_SOURCE_DIR
         "/crosscheck/report/view.js');\n"
         "const cases = JSON.parse(require('fs').readFileSync('cases.json', 'utf8'));\n"
         "console.log(JSON.stringify(cases.map(c => {\n"
         "  const scene = view.unpacked(c.scene), placed = view.place(scene, c.q);\n"
         "  return {link: placed.link, com: view.centres(scene, placed)};\n"
         "})));\n";
  const std::string command = "cd '" + folder.path.string() + "' && node run.js > out.json";
  BOOST_REQUIRE(std::system(command.c_str()) == 0);
  const Json said = Json::parse(std::ifstream(folder.path / "out.json"));
  BOOST_REQUIRE((said.size() == all.size()));
  std::vector<double> worst;
  for (std::size_t k = 0; k < all.size(); ++k) {
    double off = 0;
    for (std::size_t i = 0; i < all[k].R.size(); ++i)
      for (int row = 0; row < 3; ++row) {
        const auto differ = [&](const Json& x, double y) {
          off = std::max(off, std::abs(x.get<double>() - y));
        };
        for (int j = 0; j < 3; ++j) differ(said[k]["link"][i][4 * row + j], all[k].R[i](row, j));
        differ(said[k]["link"][i][4 * row + 3], all[k].origin[i](row));
        differ(said[k]["com"][i][row], all[k].com[i](row));
      }
    worst.push_back(off);
  }
  return worst;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

BOOST_AUTO_TEST_CASE(links_stand_where_the_sweeps_have_them) {
  double worst = 0;
  for (const Case& one : cases()) {
    const View view = viewOf(one.scene);
    const ViewPlaces places = placesOf(view, one.q);
    BOOST_TEST_CONTEXT(one.scene.name)
    for (std::size_t i = 0; i < one.R.size(); ++i) {
      const double off = std::max({(places.link[i].translation() - one.origin[i]).norm(),
                                   (places.link[i] * view.bodies[i].com - one.com[i]).norm(),
                                   (places.link[i].linear() - one.R[i]).norm()});
      worst = std::max(worst, off / limitOf(one));
      BOOST_TEST(off <= limitOf(one), "link " << view.links[i].name << " is off by " << off);
    }
  }
  BOOST_TEST_MESSAGE("worst: " << worst << " of the limit");
}

BOOST_AUTO_TEST_CASE(the_script_of_the_page_puts_them_there_too) {
  if (std::system("command -v node > /dev/null 2>&1") != 0) {
    BOOST_TEST_MESSAGE("skipped: no node (Debian: apt install nodejs)");
    return;
  }
  const std::vector<Case> all = cases();
  const std::vector<double> off = worstOfScript(all);
  for (std::size_t k = 0; k < all.size(); ++k)
    BOOST_TEST(off[k] <= limitOf(all[k]), all[k].scene.name << " is off by " << off[k]);
}

// Moments of a solid ellipsoid with half axes 1, 2, 3 m and 5 kg: m (a_i^2 + a_j^2) / 5.
BOOST_AUTO_TEST_CASE(an_ellipsoid_has_the_half_axes_of_the_solid_one) {
  ViewBody body;
  body.mass = 5;
  body.inertia = Vector3d(4 + 9, 1 + 9, 1 + 4).asDiagonal();
  Vector3d halves;
  Matrix3d axes;
  BOOST_TEST(ellipsoidOf(body, &halves, &axes));
  for (int k = 0; k < 3; ++k) {
    int along = 0;
    axes.col(k).cwiseAbs().maxCoeff(&along);
    BOOST_TEST(halves(k) == 1.0 + along, boost::test_tools::tolerance(1e-14));
  }
  BOOST_TEST(axes.determinant() == 1.0, boost::test_tools::tolerance(1e-14));
}

BOOST_AUTO_TEST_CASE(an_inertia_that_no_body_has_is_told_and_a_thin_rod_is_one) {
  ViewBody body;
  body.mass = 1;
  body.inertia = Vector3d(1, 1, 3).asDiagonal();  // 3 > 1 + 1
  Vector3d halves;
  Matrix3d axes;
  BOOST_TEST(!ellipsoidOf(body, &halves, &axes));
  BOOST_TEST(halves.minCoeff() == 0);
  const Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  body.inertia = turn * Matrix3d(Vector3d(0, 0.1, 0.1).asDiagonal()) * turn.transpose();
  BOOST_TEST(ellipsoidOf(body, &halves, &axes));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(page)

BOOST_AUTO_TEST_CASE(names_cannot_end_the_script_or_make_elements) {
  const scene::Scene scene = scene::readSceneUrdf(
      "<robot name=\"r\"><link name=\"base\"/><link name=\"&lt;/script&gt;&lt;img src=x&gt;\"><inertial>"
      "<mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>"
      "</inertial></link><joint name=\"&lt;b&gt;&amp;\" type=\"continuous\"><parent link=\"base\"/>"
      "<child link=\"&lt;/script&gt;&lt;img src=x&gt;\"/></joint></robot>",
      "r.urdf");
  const std::string page = showPage({scene}, viewOf(scene), "0");
  BOOST_TEST(files::count(page, "<script") == 2u);
  BOOST_TEST(files::count(page, "</script") == 2u);
  BOOST_TEST(!contains(page, "<img"));
  BOOST_TEST(!contains(page, "<b>&"));
}

BOOST_AUTO_TEST_CASE(bodies_as_somebody_reads_them_are_drawn_beside_those_written) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  View view = viewOf(scene);
  const std::size_t written = view.bodies.size();
  view.bodies.push_back({1, "engine", 2, {0, 0, -0.5}, Matrix3d::Identity()});
  BOOST_TEST(files::count(viewSvg(view), "class=\"body read\"") == 1u);
  const Json json = Json::parse(viewJson(view));
  const Json& columns = json["bodies"]["columns"];
  const auto who = std::find(columns.begin(), columns.end(), "who") - columns.begin();
  BOOST_TEST((json["bodies"]["rows"].size() == written + 1));
  BOOST_TEST((json["bodies"]["rows"].back()[static_cast<std::size_t>(who)] == "engine"));
}

BOOST_AUTO_TEST_CASE(a_picture_of_a_thousand_links_is_small) {
  const scene::Scene scene = scene::findScene("chain_1000");
  const std::string page = showPage({scene}, viewOf(scene), "0");
  BOOST_TEST(page.size() < 700000u);
  BOOST_TEST(
      contains(page, "200 of 1000 rows; all of them: <code>dynwitness show chain_1000</code>"));
}

// 7 digits a number in the page of many links; in a row of n frames each may be off by that,
// relative to the largest length, and turns what follows.
BOOST_AUTO_TEST_CASE(a_picture_of_many_links_has_the_digits_of_a_screen) {
  if (std::system("command -v node > /dev/null 2>&1") != 0) return;
  Case one;
  for (std::uint64_t i = 0; one.R.size() <= kMostLinksInFull; ++i)
    one = caseOf(randomScene(7, i, 120), 1);
  const double limit = 5e-7 * one.size * static_cast<double>(one.R.size());
  const double off = worstOfScript({one})[0];
  BOOST_TEST(off < limit);
  BOOST_TEST(off > limitOf(one));  // or nothing was rounded
}

BOOST_AUTO_TEST_CASE(a_picture_of_every_scene_is_small_and_finite) {
  for (const auto& file : scene::bundledScenes()) {
    const scene::Scene scene = scene::readScene(file);
    const View view = viewOf(scene);
    const std::string page = showPage({scene}, view, "0");
    BOOST_TEST_CONTEXT(scene.name) {
      BOOST_TEST(page.size() < 200000u);
      BOOST_TEST(!contains(viewSvg(view), "nan"));
      BOOST_TEST(!contains(viewSvg(view), "inf"));
      BOOST_TEST(startOf(view).size() == static_cast<std::size_t>(scene.mechanism.positions()));
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(tables)

// Followers have no column of their own, and those after them are counted on.
BOOST_AUTO_TEST_CASE(q_are_the_columns_of_a_states_file) {
  const scene::Scene scene = scene::findScene("gripper");
  const Json json = Json::parse(showJson({scene}, "0"));
  std::vector<std::string> q, qd;
  for (const Json& joint : json["joints"]) {
    for (const Json& name : joint["q"]) q.push_back(name);
    for (const Json& name : joint["qd"]) qd.push_back(name);
    if (joint["name"] == "right_finger") {
      BOOST_TEST((joint["q"].empty()));
      BOOST_TEST((joint["follows"]["joint"] == "left_finger"));
      BOOST_TEST((joint["follows"]["multiplier"] == -1));
    }
  }
  BOOST_TEST(q.size() == scene::givenSlots(scene.mechanism).size());
  BOOST_TEST(qd.size() == static_cast<std::size_t>(scene.mechanism.dof()));
  for (std::size_t k = 0; k < q.size(); ++k) BOOST_TEST(q[k] == "q" + std::to_string(k + 1));
  for (std::size_t k = 0; k < qd.size(); ++k) BOOST_TEST(qd[k] == "qd" + std::to_string(k + 1));
}

BOOST_AUTO_TEST_CASE(columns_stand_below_their_heads) {
  const std::string text = showText({scene::findScene("gripper")});
  BOOST_TEST_CONTEXT(text) {
    BOOST_TEST(contains(text, "= -1 q2 -0.002"));
    const std::size_t head = text.find("  q  ");
    BOOST_REQUIRE(head != std::string::npos);
    const std::size_t line = text.rfind('\n', head) + 1;
    const std::size_t kind = text.find("kind", line) - line;
    const std::size_t next = text.find('\n', line) + 1;
    BOOST_TEST(text.compare(next + kind, 8, "revolute") == 0);
    const std::size_t third = text.find('\n', next) + 1;
    BOOST_TEST(text.compare(third + kind, 9, "prismatic") == 0);
  }
}

// 3 rods of 1 kg move; from scene/scene.hpp: all rods of 1 m and 1 kg.
BOOST_AUTO_TEST_CASE(masses_are_summed_and_closures_listed) {
  const scene::Scene scene = scene::findScene("four_bars_1");
  const Json json = Json::parse(showJson({scene}, "0"));
  BOOST_TEST((json["mass_kg"]["moving"] == 3));
  BOOST_TEST((json["mass_kg"]["resting"] == 0));
  BOOST_TEST(contains(showText({scene}), "closure B1 (planar_point, 2 equations)"));
}

BOOST_AUTO_TEST_SUITE_END()
