// SPDX-License-Identifier: GPL-3.0-or-later
// Speed against accuracy: what is measured, that planted errors and delays show, and that it is
// drawn.
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <regex>
#include <sstream>

#include "crosscheck/chart/chart.hpp"
#include "crosscheck/chart/raw_engines.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/report/chart_drawing.hpp"
#include "crosscheck/report/plot.hpp"
#include "crosscheck/system/gnuplot.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/error.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
namespace data = boost::unit_test::data;
namespace fs = std::filesystem;

namespace {

const ChartPoint& find(const Chart& chart, const std::string& method, const std::string& scalar) {
  const auto found = std::find_if(
      chart.points.begin(), chart.points.end(),
      [&](const ChartPoint& p) { return p.method == method && name(p.scalar) == scalar; });
  BOOST_REQUIRE_MESSAGE(found != chart.points.end(), method << ", " << scalar);
  return *found;
}

/// An outside engine that is newton_euler, a relative 1e-10 off, and takes its time.
class Planted : public Witness {
 public:
  Planted(std::unique_ptr<Witness> inner, double seconds)
      : inner_(std::move(inner)), seconds_(seconds) {}
  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return quantity == Quantity::kTau; }
  Answer answer(Quantity, const scene::State<double>&) override {
    throw std::logic_error("a chart has no use for bounds");
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    Eigen::MatrixXd out = inner_->value(quantity, state);
    out(0, 0) += 1e-10 * out.cwiseAbs().maxCoeff();
    for (const double end = cpu() + seconds_; cpu() < end;) {
    }
    return out;
  }

 private:
  static double cpu() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }
  std::string name_ = "planted";
  std::unique_ptr<Witness> inner_;
  double seconds_;
};

/// An engine that cannot hold the scene.
class Refusing : public Witness {
 public:
  const std::string& name() const override { return name_; }
  bool answers(Quantity) const override { return true; }
  Answer answer(Quantity, const scene::State<double>&) override {
    throw std::runtime_error("knows no such joint");
  }

 private:
  std::string name_ = "refusing";
};

WitnessKind plantedKind(double seconds) {
  const WitnessKind inner = selectWitnesses({"newton_euler"}).front();
  return {{"planted", "7", "spoiled"}, [=](const PreparedScene& scene) -> MadeWitness {
            return std::make_unique<Planted>(inner.make(scene).value(), seconds);
          }};
}

std::vector<std::string> scenesWithClosedForm() {
  std::vector<std::string> names;
  for (const auto& file : scene::bundledScenes())
    if (const scene::Mechanism m = scene::readScene(file).mechanism;
        m.dof() <= 3 && m.positions() == m.dof())
      names.push_back(file.stem().string());
  return names;
}

class TemporaryFolder {
 public:
  TemporaryFolder() : path(fs::temp_directory_path() / ("chart_" + std::to_string(::getpid()))) {
    fs::create_directories(path);
  }
  ~TemporaryFolder() { fs::remove_all(path); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path / name) << text;
  }
  const fs::path path;
};

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

BOOST_AUTO_TEST_CASE(each_arithmetic_has_the_error_of_its_mantissa) {
  const Chart chart =
      speedAccuracy(scene::findScene("puma_560"), Quantity::kTau, selectWitnesses({}), 100);
  BOOST_TEST(chart.scene == "puma_560");
  BOOST_TEST(chart.quantity == "tau");
  // unit roundoff of each; rounding over a sweep of six joints costs one to three digits of it
  const std::pair<const char*, double> scalars[] = {{"float", 6e-8},
                                                    {"double", 1.1e-16},
                                                    {"long double", 5e-20},
                                                    {"128-bit balls", 2.9e-39},
                                                    {"50 digits", 1.3e-51}};
  for (const auto& [scalar, unit] : scalars) {
    const ChartPoint& p = find(chart, "Newton-Euler sweep", scalar);
    BOOST_TEST(p.error_worst > unit, scalar << " " << p.error_worst);
    BOOST_TEST(p.error_worst < 2e4 * unit, scalar << " " << p.error_worst);
  }
  BOOST_TEST(find(chart, "straight-line program", "double").error_worst < 1e-13);
  BOOST_TEST(find(chart, "simbody", "double").error_worst < 1e-13);
  BOOST_TEST(find(chart, "fast sweeps", "double").error_worst < 1e-13);
  for (const ChartPoint& p : chart.points) {
    BOOST_TEST(p.error_median <= p.error_worst);
    BOOST_TEST(p.time_min_ns > 0);
    BOOST_TEST(p.time_min_ns <= p.time_median_ns);
    BOOST_TEST(p.time_median_ns <= p.time_high_ns);
  }
  BOOST_TEST(std::count(chart.left_out.begin(), chart.left_out.end(),
                        "closed form as printed: more than 3 joints") == 1);
}

BOOST_AUTO_TEST_CASE(a_planted_error_and_a_planted_delay_show) {
  const Chart chart =
      speedAccuracy(scene::findScene("double_pendulum"), Quantity::kTau, {plantedKind(2e-4)}, 40);
  const ChartPoint& p = find(chart, "planted (by its witness)", "double");
  BOOST_TEST(p.error_worst > 0.99e-10);
  BOOST_TEST(p.error_worst < 1.01e-10);
  BOOST_TEST(p.time_min_ns > 2e5);  // one evaluation, not a batch of two
  BOOST_TEST(p.time_min_ns < 3e5);
  BOOST_TEST(find(chart, "Newton-Euler sweep", "double").time_min_ns < 1e5);
}

/// The witness of Simbody makes copies, and bodies that stand for rotors: its own calls take less.
BOOST_AUTO_TEST_CASE(engines_are_timed_by_their_own_calls) {
  const Chart chart =
      speedAccuracy(scene::findScene("puma_560"), Quantity::kTau, selectWitnesses({}), 40);
  const scene::Scene scene = scene::findScene("puma_560");
  const auto witness = selectWitnesses({"simbody"}).front().make(scene).value();
  timespec start{}, end{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &start);
  for (int k = 0; k < 100; ++k)
    witness->value(Quantity::kTau, drawState(scene.mechanism, scene.name, 1, k));
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &end);
  const double by_witness = (1e9 * static_cast<double>(end.tv_sec - start.tv_sec) +
                             static_cast<double>(end.tv_nsec - start.tv_nsec)) /
                            100;
  BOOST_TEST(find(chart, "simbody", "double").time_median_ns < by_witness);
  BOOST_TEST(std::any_of(chart.own_calls.begin(), chart.own_calls.end(), [](const std::string& s) {
    return s.find("simbody: realize(Velocity)") == 0;
  }));
}

BOOST_AUTO_TEST_CASE(lanes_answer_as_one_state_at_a_time) {
  for (const int states : {1, 7, 45}) {
    const Chart chart = speedAccuracy(scene::findScene("puma_560"), Quantity::kTau,
                                      selectWitnesses({"kernel"}), states);
    const auto lanes =
        std::find_if(chart.points.begin(), chart.points.end(),
                     [](const ChartPoint& p) { return p.method == "the kernel in lanes"; });
    if (lanes == chart.points.end()) return;  // no C compiler here
    const ChartPoint& one = find(chart, "the scene's kernel", "double");
    BOOST_TEST(lanes->error_worst == one.error_worst);
    BOOST_TEST(lanes->error_median == one.error_median);
  }
}

BOOST_AUTO_TEST_CASE(an_exact_answer_has_no_error) {
  const Chart chart = speedAccuracy(scene::findScene("simple_pendulum"), Quantity::kM, {}, 20);
  for (const ChartPoint& p : chart.points)
    BOOST_TEST(p.error_worst == 0, p.method << ", " << name(p.scalar));
}

BOOST_AUTO_TEST_CASE(what_cannot_be_asked_is_left_out_with_its_reason) {
  const WitnessKind absent = absentKind(plantedKind(0).info, "no such engine");
  const Chart tau = speedAccuracy(scene::findScene("acrobot"), Quantity::kTau, {absent}, 2);
  BOOST_REQUIRE(tau.left_out.size() == 1u);
  BOOST_TEST(tau.left_out[0] == "planted: no such engine");
  const Chart M = speedAccuracy(scene::findScene("acrobot"), Quantity::kM, {plantedKind(0)}, 2);
  BOOST_REQUIRE(M.left_out.size() == 1u);
  BOOST_TEST(M.left_out[0] == "planted: does not answer M");
  WitnessKind refusing = plantedKind(0);
  refusing.make = [](const PreparedScene&) { return std::make_unique<Refusing>(); };
  const Chart qdd = speedAccuracy(scene::findScene("acrobot"), Quantity::kQdd, {refusing}, 2);
  BOOST_REQUIRE(qdd.left_out.size() == 1u);
  BOOST_TEST(qdd.left_out[0] == "refusing (by its witness): knows no such joint");
  BOOST_TEST(!qdd.points.empty());
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

/// What `mujoco` documents as lost at a chart's states, of the largest entry: the principal axes of
/// the pillar of cylindrical_arm, which has products of inertia, are not turned to the end.
double documentedLoss(const WitnessKind& kind, const scene::Scene& scene, Quantity quantity,
                      int states) {
  const auto witness = kind.make(scene).value();
  double worst = 0;
  for (int k = 0; k < states; ++k) {
    const Answer answer = witness->answer(quantity, drawState(scene.mechanism, scene.name, 1, k));
    if (answer.known_loss.size() > 0)
      worst = std::max(worst, answer.known_loss.maxCoeff() / answer.value.cwiseAbs().maxCoeff());
  }
  return worst;
}

// the closed form, the program, the sweeps and Simbody: one quantity. Measured: worst 8.9e-15
BOOST_DATA_TEST_CASE(all_methods_in_double_compute_the_same,
                     data::make(scenesWithClosedForm()) * data::make({"M", "tau", "qdd"}), name,
                     quantity) {
  const Chart chart =
      speedAccuracy(scene::findScene(name), quantityNamed(quantity), selectWitnesses({}), 10);
  find(chart, "closed form as printed", "double");
  find(chart, "straight-line program", "double");
  for (const ChartPoint& p : chart.points) {
    if (p.scalar != Scalar::kDouble) continue;
    double lost = 0;
    if (p.method.substr(0, p.method.find(" (")) == "mujoco")
      lost = documentedLoss(selectWitnesses({"mujoco"}).front(), scene::findScene(name),
                            quantityNamed(quantity), 10);
    BOOST_TEST(p.error_worst < 1e-12 + lost, p.method << " " << p.error_worst);
  }
}

BOOST_AUTO_TEST_CASE(closed_forms_know_slanted_axes_fixed_angles_springs_rotors_and_wrenches) {
  const scene::Scene scene = scene::readSceneToml(R"(
title = "Everything that leaves a symbol in a closed form"
source = "this test"
gravity = [1, 2, -9.81]
[parameters]
tilt = "pi/5"
[[link]]
name = "base"
[[link]]
name = "upper"
parent = "base"
mass = 2
com = [0.1, 0.2, 0.3]
inertia = { about = "com", xx = 1, yy = 1.5, zz = 2, xy = 0.1 }
[link.joint]
name = "one"
kind = "revolute"
axis = [1, -2, 3]
rpy = [0, "tilt", "pi/7"]
stiffness = 3
rest = "pi/3"
rotor_inertia = 2e-4
gear_ratio = 100
[[link]]
name = "lower"
parent = "upper"
mass = 1
com = [0.3, 0.1, 0.2]
inertia = { about = "com", xx = 0.5, yy = 0.6, zz = 0.7 }
[link.joint]
name = "two"
kind = "revolute"
axis = [2, 1, 1]
xyz = [0.5, 0.4, 0.3]
[[wrench]]
link = "lower"
force = [1, 2, 3]
at = [0.1, 0.2, 0]
axes = "world"
)",
                                                  "oblique.toml");
  for (const Quantity quantity : {Quantity::kM, Quantity::kTau, Quantity::kQdd}) {
    const Chart chart = speedAccuracy(scene, quantity, {}, 10);
    for (const char* method : {"closed form as printed", "straight-line program"})
      BOOST_TEST(find(chart, method, "double").error_worst < 1e-12,
                 method << " " << name(quantity));
  }
}

BOOST_AUTO_TEST_CASE(forward_dynamics_is_charted_by_both_algorithms) {
  const Chart chart = speedAccuracy(scene::findScene("stanford_arm"), Quantity::kQdd, {}, 20);
  BOOST_TEST(find(chart, "mass matrix and L D L'", "double").error_worst < 1e-12);
  BOOST_TEST(find(chart, "articulated-body sweep", "double").error_worst < 1e-12);
  BOOST_TEST(find(chart, "articulated-body sweep", "50 digits").error_worst < 1e-46);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(output)

BOOST_AUTO_TEST_CASE(the_table_has_a_line_a_point_and_says_what_was_measured) {
  const Chart chart = speedAccuracy(scene::findScene("acrobot"), Quantity::kTau, {}, 5, 7);
  std::istringstream csv(chartCsv({chart}));
  std::string comments, header;
  std::vector<std::string> rows;
  for (std::string line; std::getline(csv, line);) {
    if (line[0] == '#')
      comments += line;
    else if (header.empty())
      header = line;
    else
      rows.push_back(line);
  }
  BOOST_TEST(header ==
             "quantity,method,scalar,error_worst,error_median,time_min_ns,time_median_ns,"
             "time_high_ns");
  for (const char* part :
       {"scene: acrobot", "quantity: tau", "states: 5, seed 7", "2^-200", "machine: "})
    BOOST_TEST(comments.find(part) != std::string::npos, part);
  BOOST_REQUIRE(rows.size() == chart.points.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ChartPoint& p = chart.points[i];
    BOOST_TEST(rows[i].rfind("tau," + p.method + "," + name(p.scalar) + ",", 0) == 0u);
    BOOST_TEST(std::count(rows[i].begin(), rows[i].end(), ',') == 7);
    const double error =
        std::stod(rows[i].substr(p.method.size() + std::string(name(p.scalar)).size() + 6));
    BOOST_TEST(std::abs(error - p.error_worst) <= 1e-3 * p.error_worst);
  }
}

BOOST_DATA_TEST_CASE(the_script_draws_both_pictures,
                     data::make({"double_pendulum", "simple_pendulum"}) ^
                         data::make({"qdd", "M"}),  // M = 1: all errors are 0
                     name, quantity) {
  if (gnuplotVersion() == "not found") {
    BOOST_TEST_MESSAGE("no gnuplot here");
    return;
  }
  scene::Scene scene = scene::findScene(name);
  scene.title = "It's a 'test'";
  Chart chart = speedAccuracy(scene, quantityNamed(quantity), {plantedKind(0)}, 5);
  for (const WitnessKind& kind : witnessKinds())  // the key holds them all
    if (kind.info.version != DYNWITNESS_VERSION)
      chart.points.push_back({kind.info.name, Scalar::kDouble, 1e-15, 1e-16, 100, 200, 300});
  const TemporaryFolder folder;
  fs::copy_file(fs::path(DYNWITNESS_SOURCE_DIR) / "crosscheck/report/style.gp",
                folder.path / "style.gp");
  folder.write("speed.csv", chartCsv({chart}));
  folder.write("speed.gp", chartScript(chart, "speed", "style.gp"));
  const auto problem = runGnuplot(folder.path, "speed.gp", {"speed.svg"});
  BOOST_REQUIRE_MESSAGE(!problem, problem.value_or(""));
  std::ifstream file(folder.path / "speed.svg");
  const std::string svg((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  for (const char* part : {"lower left is better", "straight-line program",
                           "closed form as printed", "50 digits", "128-bit balls"})
    BOOST_TEST(svg.find(part) != std::string::npos, part);
  for (const ChartPoint& p : chart.points) {
    const std::string name_in_xml = p.method.substr(0, p.method.find('\''));
    BOOST_TEST(svg.find(">" + name_in_xml) != std::string::npos, p.method);
  }
}

// Colour-blind readers tell methods by their markers: style.gp defines each, and no two are alike.
BOOST_DATA_TEST_CASE(every_method_of_a_chart_has_a_marker_of_its_own,
                     data::make({"M", "tau", "qdd"}), quantity) {
  std::map<std::string, std::string> markers;  // of line types
  std::ifstream style(fs::path(DYNWITNESS_SOURCE_DIR) / "crosscheck/report/style.gp");
  const std::regex defined(R"(set linetype (\d+) .*pointtype (\d+).*)");
  std::smatch match;
  for (std::string line; std::getline(style, line);)
    if (std::regex_match(line, match, defined)) markers[match[1]] = match[2];

  // drawn is drawn, measured or not: all engines that there are, whether this build has them or not
  Chart chart = speedAccuracy(scene::findScene("acrobot"), quantityNamed(quantity), {}, 2);
  for (const WitnessKind& kind : witnessKinds())
    if (kind.info.version != DYNWITNESS_VERSION)
      chart.points.push_back({kind.info.name, Scalar::kDouble, 1e-15, 1e-16, 100, 200, 300});
  chart.points.push_back({"somebody else's", Scalar::kDouble, 1e-15, 1e-16, 100, 200, 300});
  const std::string script = chartScript(chart, "speed", "style.gp");
  const std::regex drawn(R"(xyerrorbars linetype (\d+) [^\n]* title '([^\n]*)')");
  std::map<std::string, std::string> seen;  // method of each marker
  for (std::sregex_iterator it(script.begin(), script.end(), drawn), end; it != end; ++it) {
    const std::string type = (*it)[1], method = (*it)[2];
    BOOST_REQUIRE_MESSAGE(markers.count(type) == 1, "linetype " << type << " of " << method);
    const auto [twin, fresh] = seen.insert({markers[type], method});
    BOOST_TEST(fresh, method << " looks like " << twin->second);
  }
  BOOST_TEST(seen.size() >= 8u);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(other_quantities_are_refused) {
  BOOST_CHECK_EXCEPTION(speedAccuracy(scene::findScene("acrobot"), Quantity::kKinetic, {}, 5),
                        std::invalid_argument, [](const std::exception& e) {
                          return std::string(e.what()) ==
                                 "speedAccuracy: quantity: expected M, tau or qdd, got kinetic";
                        });
}

BOOST_AUTO_TEST_CASE(a_singular_mass_matrix_is_reported) {
  scene::Scene scene = scene::findScene("double_pendulum");
  scene.mechanism.links[2].inertia = {};
  BOOST_CHECK_EXCEPTION(
      speedAccuracy(scene, Quantity::kQdd, {}, 5), scene::InputError, [](const std::exception& e) {
        return std::string(e.what()).find("M is singular: joint 'elbow'") != std::string::npos;
      });
}

BOOST_AUTO_TEST_SUITE_END()

// A model whose answer is no number, or has others beside it, is another one.
BOOST_AUTO_TEST_CASE(only_the_same_numbers_are_of_the_same_model) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  BOOST_CHECK_NO_THROW(requireSame({1, 2}, {1, 2.0001}, "engine", "tau"));
  for (const std::vector<double>& its :
       {std::vector<double>{nan, 2}, {1, nan}, {1, 2.1}, {1}, {1, 2, 3}})
    BOOST_CHECK_THROW(requireSame({1, 2}, its, "engine", "tau"), std::logic_error);
  BOOST_CHECK_THROW(requireSame({1}, {nan}, "engine", "tau"), std::logic_error);
}
