// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness evaluate: quantities of a scene at given states, as a table.
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/studies/constrained_quantities.hpp"
#include "crosscheck/crosscheck.hpp"
#include "crosscheck/report/files.hpp"
#include "crosscheck/states_file.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  std::string scene, states, witness, output;
  std::vector<std::string> quantities;
};

/// M11, M12, ... row by row (M1_1 from ten joints on, where M111 would be two things); c1, c2, ...;
/// a single number has its own name; reactions are those of the joint: elbow.fx, ..., elbow.mz.
std::vector<std::string> columnNames(Quantity quantity, const scene::Mechanism& mechanism) {
  int n = mechanism.dof();
  std::vector<std::string> names;
  switch (quantity) {
    case Quantity::kM:
      for (int i = 1; i <= n; ++i)
        for (int j = 1; j <= n; ++j) names.push_back(fmt::format("M{}{}{}", i, n > 9 ? "_" : "", j));
      return names;
    case Quantity::kKinetic:
    case Quantity::kPotential: return {name(quantity)};
    case Quantity::kMomentum: n = 6; break;
    case Quantity::kReactions:
      for (const scene::Link& link : mechanism.links)
        for (const char* component : {"fx", "fy", "fz", "mx", "my", "mz"})
          if (link.parent >= 0) names.push_back(link.joint.name + "." + component);
      return names;
    default: break;
  }
  for (int i = 1; i <= n; ++i) names.push_back(fmt::format("{}{}", name(quantity), i));
  return names;
}

/// nu1, nu2, ...; J11, J12, ... row by row (J1_1 where a number has two digits).
std::vector<std::string> columnNames(const std::string& name, Eigen::Index rows, Eigen::Index columns) {
  std::vector<std::string> names;
  for (Eigen::Index i = 1; i <= rows; ++i)
    for (Eigen::Index j = 1; j <= columns; ++j)
      names.push_back(columns == 1 && name != "N" && name != "Lambda" && name != "Jbar"
                          ? fmt::format("{}{}", name, i)
                          : fmt::format("{}{}{}{}", name, i, rows > 9 || columns > 9 ? "_" : "", j));
  return names;
}

/// Who answers when nobody is named: the sweep made for the quantity.
std::string usualWitness(Quantity quantity) {
  if (quantity == Quantity::kM) return "composite_body";
  if (quantity == Quantity::kQdd) return "articulated_body";
  return "newton_euler";
}

int run(const Arguments& arguments) {
  requireWritableFile(arguments.output);
  const scene::Scene scene = scene::findScene(arguments.scene);
  requireMotion(scene);
  const ConstrainedQuantities constrained(scene);
  const std::vector<scene::State<double>> states =
      arguments.states.empty() ? std::vector<scene::State<double>>{constrained.start()}
                               : readStates(arguments.states, scene.mechanism);

  struct Column {
    Quantity quantity;
    std::unique_ptr<Witness> witness;  ///< none: asked of `constrained` by name
    std::string name;
  };
  std::vector<Column> columns;
  std::string header;
  for (const std::string& text : arguments.quantities) {
    const auto& special = ConstrainedQuantities::names();
    const bool is_special = std::find(special.begin(), special.end(), text) != special.end();
    if (is_special && (text != "qdd" || constrained.isConstrained())) {
      if (!arguments.witness.empty())
        throw scene::InputError({}, fmt::format("--witness with {} of a constrained scene, allowed: without", text));
      const Eigen::MatrixXd first = states.empty() ? Eigen::MatrixXd() : constrained.answer(text, states.front());
      for (const std::string& column : columnNames(text, first.rows(), first.cols()))
        header += (header.empty() ? "" : ",") + column;
      columns.push_back({Quantity::kQdd, nullptr, text});
      continue;
    }
    const Quantity quantity = quantityNamed(text);
    if (!scene.mechanism.isOpenTree() && (quantity == Quantity::kTau || quantity == Quantity::kReactions))
      throw scene::InputError({scene.file.string(), 0},
                              "has closures, or springs between points: " + text +
                                  " is not that of its tree, allowed: qdd, lambda, and M, c, g, kinetic, "
                                  "potential, momentum of the tree");
    const std::string who = arguments.witness.empty() ? usualWitness(quantity) : arguments.witness;
    std::unique_ptr<Witness> witness = selectWitnesses({who}).front().make(scene);
    if (!witness->answers(quantity))
      throw scene::InputError({}, fmt::format("witness '{}' does not answer {}", who, text));
    columns.push_back({quantity, std::move(witness), text});
    for (const std::string& column : columnNames(quantity, scene.mechanism))
      header += (header.empty() ? "" : ",") + column;
  }

  std::string table = header + "\n";
  for (const scene::State<double>& state : states) {
    std::string row;
    for (Column& column : columns) {
      const Eigen::MatrixXd value = column.witness ? column.witness->answer(column.quantity, state).value
                                                   : constrained.answer(column.name, state);
      for (Eigen::Index i = 0; i < value.rows(); ++i)
        for (Eigen::Index j = 0; j < value.cols(); ++j)
          row += fmt::format("{}{:.17g}", row.empty() ? "" : ",", value(i, j));
    }
    table += row + "\n";
  }
  if (arguments.output.empty()) fmt::print("{}", table);
  else writeWholeFile(arguments.output, table);
  return 0;
}

}  // namespace

Run addEvaluate(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("evaluate", "Quantities of a scene at the states of a CSV file");
  command->footer("dynwitness evaluate acrobot --states s.csv --quantity M,tau\n"
                  "dynwitness evaluate two_handed --quantity qdd,nu,tau_drive\n"
                  "dynwitness evaluate two_handed --quantity Lambda,Jbar,task_torque");
  command->add_option("scene", arguments->scene, "Scene")->required();
  command
      ->add_option("--states", arguments->states,
                   "CSV file: q1..q(positions), qd1..qdn, and qdd1..qddn or tau1..taun; without: the "
                   "scene's start");
  command
      ->add_option("--quantity", arguments->quantities,
                   "M, c, g, tau, qdd, kinetic, potential, momentum, reactions; with closures, driven joints or acceleration "
                   "constraints: qdd under them, lambda, nu, tau_drive; of the constraints as tasks: N, Lambda "
                   "(task inertia), J, Jbar, task_torque (tau the posture's), null_torque; several with commas")
      ->required()
      ->delimiter(',');
  command->add_option("--witness", arguments->witness, "Who answers; without: the usual sweep");
  command->add_option("-o,--output", arguments->output, "File; without: standard output");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
