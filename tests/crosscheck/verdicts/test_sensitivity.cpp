// SPDX-License-Identifier: GPL-3.0-or-later
// The smallest fault that each quantity's check notices: a table in the documentation, held here.
//
//     build/test_sensitivity -- --record     writes it anew
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include <boost/test/unit_test.hpp>

#include <fmt/format.h>

#include "crosscheck/verdicts/digits.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/witnesses/sweep_witness.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

constexpr int kStates = 4;
constexpr const char* kQuantities[] = {"M", "c", "g", "tau", "qdd", "reactions"};
constexpr const char* kMechanisms[] = {"simple_pendulum", "puma_560", "franka_panda", "chain_4",
                                       "chain_8",         "chain_16", "chain_32",     "chain_64"};
constexpr const char* kFaults[] = {"mass", "product", "sine"};
const std::string kFile = DYNWITNESS_SOURCE_DIR "/crosscheck/verdicts/sensitivity.md";

struct AllSweeps {
  static constexpr const char* kName = "sweeps";
  static constexpr SolvedBy kSolvedBy = SolvedBy::kSweep;
  static bool answers(Quantity) { return true; }
  template <typename T>
  static MatrixX<T> answer(Setup<T>& s, Quantity quantity, const scene::State<T>& state) {
    return quantity == Quantity::kQdd ? ArticulatedBody::answer(s, quantity, state)
                                      : NewtonEuler::answer(s, quantity, state);
  }
};

/// What the table calls a row: a link in the middle, with a mass.
int faultyLink(const scene::Mechanism& mechanism) {
  const std::vector<int> moving = mechanism.movingLinks();
  return moving[moving.size() / 2];
}

scene::Number times(const scene::Number& number, const std::string& factor) {
  return scene::Expression::parse(fmt::format("({}) * ({})", number.text(), factor));
}

/** Of the mass: that part of it (the link's moments about its centre of mass stay). Of a product of
    inertia: that part of the largest moment is added to it. Of a sine: the link's joint is turned
    by that much more, [rad]. */
scene::Scene withFault(scene::Scene scene, const std::string& kind, double size) {
  scene::Link& link = scene.mechanism.links[faultyLink(scene.mechanism)];
  const std::string part = fmt::format("{:.17e}", size);
  if (kind == "mass") {
    link.inertia.mass = times(link.inertia.mass, "1 + " + part);
  } else {
    const scene::RealNumbers<double> number(scene.mechanism);
    const double largest = std::max({number(link.inertia.xx), number(link.inertia.yy),
                                     number(link.inertia.zz), 1e-3 * number(link.inertia.mass)});
    link.inertia.xy = scene::Expression::parse(
        fmt::format("({}) + ({:.17e}) * ({})", link.inertia.xy.text(), largest, part));
  }
  return scene;
}

/// Reads the position of one joint wrongly.
class Turned : public Witness {
 public:
  Turned(std::unique_ptr<Witness> inner, int slot, double by)
      : inner_(std::move(inner)), slot_(slot), by_(by) {}
  const std::string& name() const override { return inner_->name(); }
  bool answers(Quantity quantity) const override { return inner_->answers(quantity); }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    scene::State<double> turned = state;
    turned.x[slot_] = scene::jointPosition(state.x[slot_].q + by_);
    return inner_->answer(quantity, turned);
  }

 private:
  std::unique_ptr<Witness> inner_;
  int slot_;
  double by_;
};

std::unique_ptr<Witness> sweeps(const scene::Scene& scene) {
  return std::make_unique<SweepWitness<AllSweeps>>(scene);
}

/// Residual / limit of each quantity against the truth, with this fault.
std::map<std::string, double> sharesWith(const scene::Scene& scene, const std::string& kind,
                                         double size) {
  WitnessKind faulty;
  faulty.info.name = "faulty";
  faulty.make = [&](const PreparedScene& asked) -> MadeWitness {
    const scene::Scene& right = asked.scene();
    if (kind != "sine") return sweeps(withFault(right, kind, size));
    const int slot = static_cast<int>(right.mechanism.movingLinks().size()) / 2;
    return std::make_unique<Turned>(sweeps(right), slot, size);
  };
  Options options;
  options.states = kStates;
  std::map<std::string, double> shares;
  for (const CheckResult& check : measureDigits(scene, {faulty}, options).checks)
    shares[check.quantity] = check.ratio;
  return shares;
}

/** The fault whose residual is as large as its limit. Residuals are proportional to small faults,
    so one that is planted far above the limit tells: 1e-6. Empty: the quantity does not change. */
std::map<std::string, std::optional<double>> smallest(const scene::Scene& scene,
                                                      const std::string& kind) {
  constexpr double kPlanted = 1e-6;
  std::map<std::string, std::optional<double>> out;
  for (const auto& [quantity, share] : sharesWith(scene, kind, kPlanted))
    if (share > 10) out[quantity] = kPlanted / share;
  return out;
}

std::string key(const std::string& mechanism, const std::string& fault) {
  return mechanism + " | " + fault;
}

std::string row(const std::string& mechanism, const std::string& fault,
                const std::map<std::string, std::optional<double>>& noticed) {
  std::string line = "| " + key(mechanism, fault) + " |";
  for (const char* quantity : kQuantities) {
    const auto it = noticed.find(quantity);
    line += it == noticed.end() ? " - |" : fmt::format(" {:.0e} |", *it->second);
  }
  return line;
}

/// The numbers of the rows of the file, by their first two cells.
std::map<std::string, std::vector<std::string>> recorded() {
  std::map<std::string, std::vector<std::string>> rows;
  std::ifstream in(kFile);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("| ", 0) != 0) continue;
    std::vector<std::string> cells;
    std::istringstream text(line.substr(1));
    for (std::string cell; std::getline(text, cell, '|');) {
      const std::size_t from = cell.find_first_not_of(' '), to = cell.find_last_not_of(' ');
      cells.push_back(from == std::string::npos ? "" : cell.substr(from, to - from + 1));
    }
    if (cells.size() < 3) continue;
    rows[key(cells[0], cells[1])] = {cells.begin() + 2, cells.end()};
  }
  return rows;
}

constexpr const char* kHead =
    R"(# The smallest fault that is noticed

What a check cannot see it says nothing about. A fault is planted into one link in the middle of a mechanism, behind
a witness that is a sweep of ours, and is noticed when a quantity leaves its limit: the smallest that is, at
4 states, in parts of the true number. `mass`: of the link's mass. `product`: a product of inertia, in parts of
the link's largest moment (or of 0.001 kg m^2 per kg). `sine`: the link's joint is turned by so many rad more, which is
what an error of its sine and cosine does. `-`: the quantity does not change, or by less than ten limits at 1e-6.

Over the prime field the smallest fault that is noticed is any. qdd is judged in the equations (backward_error.hpp), so
that its column does not run away with the condition of M.

)";

bool isToBeRecorded() {
  const auto& suite = boost::unit_test::framework::master_test_suite();
  return std::any_of(suite.argv, suite.argv + suite.argc,
                     [](const char* word) { return std::string(word) == "--record"; });
}

}  // namespace

BOOST_AUTO_TEST_CASE(the_table_of_the_smallest_faults_is_true_within_a_factor_of_ten) {
  const std::map<std::string, std::vector<std::string>> rows = recorded();
  std::string table = kHead + std::string("| mechanism | fault |");
  for (const char* quantity : kQuantities) table += fmt::format(" {} |", quantity);
  table += "\n|---|---|";
  for (std::size_t k = 0; k < std::size(kQuantities); ++k) table += "---|";
  table += "\n";
  for (const char* mechanism : kMechanisms) {
    const scene::Scene scene = scene::findScene(mechanism);
    for (const char* fault : kFaults) {
      const auto noticed = smallest(scene, fault);
      table += row(mechanism, fault, noticed) + "\n";
      if (isToBeRecorded()) continue;
      const auto it = rows.find(key(mechanism, fault));
      BOOST_REQUIRE_MESSAGE(it != rows.end(), key(mechanism, fault) << " is not in " << kFile);
      BOOST_REQUIRE(it->second.size() == std::size(kQuantities));
      for (std::size_t k = 0; k < std::size(kQuantities); ++k) {
        const std::string& cell = it->second[k];
        const auto here = noticed.find(kQuantities[k]);
        const std::string where = fmt::format("{}, {}: {}", mechanism, fault, kQuantities[k]);
        BOOST_TEST((cell == "-") == (here == noticed.end()), where);
        if (cell == "-" || here == noticed.end()) continue;
        const double ratio = *here->second / std::stod(cell);
        BOOST_TEST(ratio > 0.1, where << ": " << *here->second);
        BOOST_TEST(ratio < 10, where << ": " << *here->second);
      }
    }
  }
  if (isToBeRecorded()) std::ofstream(kFile) << table;
}

BOOST_AUTO_TEST_CASE(three_times_the_smallest_fault_is_noticed_and_a_third_of_it_is_not) {
  const scene::Scene scene = scene::findScene("franka_panda");
  for (const char* fault : kFaults) {
    for (const auto& [quantity, size] : smallest(scene, fault)) {
      BOOST_TEST(sharesWith(scene, fault, 3 * *size).at(quantity) > 1, fault << ", " << quantity);
      BOOST_TEST(sharesWith(scene, fault, *size / 3).at(quantity) <= 1, fault << ", " << quantity);
    }
  }
}
