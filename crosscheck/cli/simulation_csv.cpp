// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/simulation_csv.hpp"

#include <fmt/format.h>

#include "crosscheck/inputs/states_file.hpp"
#include "crosscheck/witnesses/column_names.hpp"
#include "scene/mimic.hpp"

namespace dynwitness::cli {

using namespace crosscheck;

namespace {

/// Joint forces, zeros where nobody gives any: a states file says what it does not leave out.
std::vector<double> forcesOf(const Simulation::Point& point) {
  return point.tau.empty() ? std::vector<double>(point.qd.size(), 0.0) : point.tau;
}

}  // namespace

ReactionsAlong::ReactionsAlong(const scene::Scene& scene)
    : names_(columnNames(Quantity::kReactions, scene.mechanism)) {
  if (scene.mechanism.isOpenTree() && scene.mechanism.acceleration_constraints.empty())
    sweep_ = selectWitnesses({"newton_euler"}).front().make(scene).value();
  else
    constrained_.emplace(scene);
}

Eigen::MatrixXd ReactionsAlong::at(const Simulation::Point& point) const {
  scene::State<double> state;
  for (const double q : point.q) state.x.push_back(scene::jointPosition(q));
  state.qd = point.qd;
  state.qdd = point.qdd;
  state.tau = forcesOf(point);
  return sweep_ ? sweep_->value(Quantity::kReactions, state)
                : constrained_->answer(ConstrainedQuantity::kReactions, state);
}

std::string csvOf(const Simulation& simulation, const scene::Mechanism& mechanism,
                  const ReactionsAlong* reactions) {
  const Simulation::Point& first = simulation.points.front();
  const std::vector<int> given = scene::givenSlots(mechanism);  // what a states file may say
  std::string csv = hasOrientations(mechanism) ? "# convention: dynwitness\n" : "";
  csv += "time_s";
  for (std::size_t i = 1; i <= given.size(); ++i) csv += fmt::format(",q{}", i);
  for (const char* group : {"qd", "qdd", "tau"})
    for (std::size_t i = 1; i <= first.qd.size(); ++i) csv += fmt::format(",{}{}", group, i);
  for (std::size_t i = 1; i <= first.lambda.size(); ++i) csv += fmt::format(",lambda{}", i);
  for (std::size_t i = 1; i <= first.nu.size(); ++i) csv += fmt::format(",nu{}", i);
  csv += ",kinetic_J,potential_J,phi,phi_rate,energy_error_J";
  if (reactions)
    for (const std::string& name : reactions->names()) csv += ',' + name;
  csv += '\n';
  for (const Simulation::Point& point : simulation.points) {
    const std::vector<double> tau = forcesOf(point);
    csv += fmt::format("{:.17g}", point.time);
    for (const int slot : given) csv += fmt::format(",{:.17g}", point.q[slot]);
    for (const auto* values : {&point.qd, &point.qdd, &tau, &point.lambda, &point.nu})
      for (const double v : *values) csv += fmt::format(",{:.17g}", v);
    csv += fmt::format(",{:.17g},{:.17g}", point.kinetic, point.potential);
    csv += fmt::format(",{:.3g},{:.3g},{:.3g}", point.phi, point.phi_rate, point.energy_error);
    if (reactions) {
      const Eigen::VectorXd transmitted = reactions->at(point).reshaped();
      for (const double v : transmitted) csv += fmt::format(",{:.17g}", v);
    }
    csv += '\n';
  }
  return csv;
}

std::string csvOf(const std::vector<const FormulationRun*>& runs, const scene::Mechanism& mechanism,
                  const ReactionsAlong* reactions) {
  std::string csv;
  for (const FormulationRun* run : runs) {
    const std::string rows = csvOf(run->result, mechanism, reactions);
    const std::size_t head = rows.find("\ntime_s") == std::string::npos ? 0 : rows.find('\n') + 1;
    const std::size_t first = rows.find('\n', head) + 1;
    if (csv.empty()) csv = rows.substr(0, head) + "method," + rows.substr(head, first - head);
    for (std::size_t at = first; at < rows.size();) {
      const std::size_t end = rows.find('\n', at) + 1;
      csv += run->method + "," + rows.substr(at, end - at);
      at = end;
    }
  }
  return csv;
}

}  // namespace dynwitness::cli
