// SPDX-License-Identifier: GPL-3.0-or-later
// Inertias that no body has: all of a file at once, by how much, why, and the nearest possible one.
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE impossible_inertia
#include "scene/impossible_inertia.hpp"

#include <chrono>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "scene/urdf.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness::scene;

namespace {

std::string inertia(const std::string& xx, const std::string& yy, const std::string& zz,
                    const std::string& xy = "0", const std::string& xz = "0",
                    const std::string& yz = "0") {
  return "<inertia ixx=\"" + xx + "\" ixy=\"" + xy + "\" ixz=\"" + xz + "\" iyy=\"" + yy +
         "\" iyz=\"" + yz + "\" izz=\"" + zz + "\"/>";
}
std::string link(const std::string& name, const std::string& inertia,
                 const std::string& xyz = "0.1 0 0", const std::string& mass = "1") {
  return "<link name=\"" + name + "\"><inertial><origin xyz=\"" + xyz + "\"/><mass value=\"" +
         mass + "\"/>" + inertia + "</inertial></link>\n";
}
/// Links in a row, one a line from line 3 on.
std::string robot(const std::vector<std::string>& links) {
  std::string text = "<robot name=\"r\">\n<link name=\"base\"/>\n", joints;
  std::string parent = "base";
  for (const std::string& l : links) {
    const std::string name = l.substr(12, l.find('"', 12) - 12);
    text += l;
    joints += "<joint name=\"to_" + name +
              "\" type=\"continuous\"><origin xyz=\"0.2 0 0\"/><parent link=\"" + parent +
              "\"/><child link=\"" + name + "\"/><axis xyz=\"0 1 0\"/></joint>\n";
    parent = name;
  }
  return text + joints + "</robot>\n";
}
std::string complaint(const std::string& text) {
  try {
    readSceneUrdf(text, "r.urdf");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}
bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

struct Case {
  const char* name;
  std::string inertia;
  const char* reason;
};
std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << c.name;
}
// all with mass 1 and c = (0.1, 0, 0), so that m c^2 = 0.01 about y and z
const Case kCases[] = {
    {"digits", inertia("0.0002", "0.0003", "0.00055"), "digits cut off"},  // +- 0.00005
    {"digits of a zero", inertia("0.001", "0", "0.001"), ""},              // a rod: possible
    {"same", inertia("0.001", "0.001", "0.001", "0.001", "0.001", "0.001"), "six times the same"},
    // [2 1 1; 1 2 1; 1 1 2] has 1, 1, 4: its products negated 3, 3, 0
    {"sign", inertia("2", "2", "2", "1", "1", "1"), "products of inertia of the other sign"},
    {"shift", inertia("0.01", "-0.005", "-0.004"), "m c^2 was taken off once too often"},
    {"order", inertia("0.02", "0.0001", "0.0002", "0.03", "0.025", "0.0003"),
     "in the order of the attributes"},
    {"unit of products", inertia("0.012", "0.013", "0.014", "900.5", "-800.5", "700.5"),
     "products of inertia in kg mm^2"},
    {"decimal point", inertia("0.012", "0.5", "0.014"), "the decimal point of yy: 0.005"},
    {"unit", inertia("3000.5", "4000.5", "9000.5"), "in kg mm^2: the radius of gyration is"},
};

}  // namespace

// A sound one between two that are not.
BOOST_AUTO_TEST_CASE(all_impossible_inertias_are_said_at_once) {
  const std::string text =
      complaint(robot({link("a", inertia("1", "1", "3")), link("b", inertia("1", "1", "1")),
                       link("c", inertia("-1", "1", "1"))}));
  BOOST_TEST(
      has(text,
          "r.urdf:3: link \"a\": principal moments of inertia about the centre of mass are 1, 1, 3 kg"),
      text);
  BOOST_TEST(
      has(text,
          "triangle inequality, allowed: none greater than the sum of the other two: by 1 kg m^2 (33 % "),
      text);
  BOOST_TEST(has(text, "\nr.urdf:5: link \"c\": "), text);
  BOOST_TEST(has(text, "not positive semidefinite, allowed: zero or more: by 1 kg m^2"), text);
  BOOST_TEST(has(text, "\nr.urdf: 2 of 4 links have an inertia that no body has"), text);
  BOOST_TEST(!has(text, "link \"b\""), text);
}

BOOST_DATA_TEST_CASE(the_reason_is_found_by_trying, data::make(kCases), c) {
  const std::string text = complaint(robot({link("a", c.inertia)}));
  if (std::string(c.reason).empty())
    BOOST_TEST(text == "");
  else
    BOOST_TEST(has(text, c.reason), text);
}

// S = tr(I)/2 1 - I of diag(1, 1, 3) is diag(1.5, 1.5, -0.5); without its negative eigenvalue it is
// that of diag(1.5, 1.5, 3).
BOOST_AUTO_TEST_CASE(the_nearest_possible_inertia_loses_what_is_negative) {
  const std::array<double, 6> near = nearestPossible({1, 1, 3, 0, 0, 0});
  const std::array<double, 6> expected = {1.5, 1.5, 3, 0, 0, 0};
  for (std::size_t k = 0; k < 6; ++k) BOOST_TEST(std::abs(near[k] - expected[k]) < 1e-15);
}

BOOST_AUTO_TEST_CASE(a_mended_file_is_read_and_says_what_was_changed) {
  const std::string text =
      robot({link("a", inertia("1", "1", "3")), link("b", inertia("1.5", "1", "1", "0.125")),
             link("c", inertia("0.7", "0.1", "0.1", "0.3", "0.2", "0.3"))});
  std::vector<std::string> changes;
  const std::string mended = mendedUrdf(text, "r.urdf", &changes);
  BOOST_REQUIRE(changes.size() == 2u);
  BOOST_TEST(has(changes[0], "r.urdf:3: link \"a\": ixx=1.5"), changes[0]);
  BOOST_TEST(has(mended, "<!-- mended by dynwitness: no body has ixx=1 iyy=1 izz=3"), mended);
  BOOST_TEST(complaint(mended) == "");
  BOOST_TEST(has(mended, "ixy=\"0.125\""), mended);  // what is possible stays as it is
  std::vector<std::string> again;
  mendedUrdf(mended, "r.urdf", &again);
  BOOST_TEST(again.empty());
  BOOST_CHECK_THROW(
      mendedUrdf(robot({link("a", inertia("1", "1", "1"), "0 0 0", "-1")}), "r.urdf", &changes),
      InputError);
}

// Eight times the links, and not much more than eight times the time: linear, where a square would
// be 64.
BOOST_AUTO_TEST_CASE(reading_is_linear_in_the_links) {
  const auto seconds = [](int n) {
    std::vector<std::string> links;
    for (int i = 0; i < n; ++i)
      links.push_back(link("l" + std::to_string(i), inertia("1", "1", i % 2 == 0 ? "3" : "1")));
    const std::string text = robot(links);
    const auto start = std::chrono::steady_clock::now();
    BOOST_TEST(has(complaint(text), " links have an inertia that no body has"));
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const double small = seconds(500), large = seconds(4000);
  BOOST_TEST_MESSAGE("500 links: " << small << " s, 4000: " << large << " s");
  BOOST_TEST(large < 24 * small);
}
