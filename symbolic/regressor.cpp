// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/regressor.hpp"

#include <string>

namespace dynwitness::symbolic {

InertialSymbols inertialSymbols(const scene::Mechanism& given) {
  using Kind = scene::InertialParameter::Kind;
  InertialSymbols out;
  out.mechanism = given;
  out.parameters = scene::inertialParameters(given);
  std::string prefix = "inertial_";  // of names that the scene does not have
  for (const scene::Parameter& p : given.parameters)
    while (p.name.rfind(prefix, 0) == 0) prefix += "_";
  const auto symbol = [&](std::size_t j) { return prefix + std::to_string(j); };
  for (scene::Link& link : out.mechanism.links) {
    link.inertia = scene::MassProperties{};
    link.inertia.about = scene::MassProperties::About::kLinkOrigin;
    link.joint.rotor_inertia = scene::Number(0);
    for (scene::Rotor& rotor : link.joint.rotors) rotor.inertia = scene::Number(0);
  }
  for (std::size_t j = 0; j < out.parameters.size(); ++j) {
    const auto [at, kind, rotor] = out.parameters[j];
    out.mechanism.parameters.push_back({symbol(j), kind == Kind::kMass ? 1 : 0, {}});
    scene::Link& link = out.mechanism.links[at];
    scene::MassProperties& m = link.inertia;
    scene::Number* const numbers[] = {
        &m.mass,
        &m.com[0],
        &m.com[1],
        &m.com[2],
        &m.xx,
        &m.yy,
        &m.zz,
        &m.xy,
        &m.xz,
        &m.yz,
        rotor < 0 ? &link.joint.rotor_inertia : &link.joint.rotors[rotor].inertia};
    std::string value = symbol(j);
    if (kind == Kind::kRotor && rotor < 0)
      value += " / (" + link.joint.gear_ratio.text() + ")^2";  // it is n^2 J
    *numbers[static_cast<int>(kind)] = scene::Number::parse(value);
  }
  out.equations = deriveForInverseDynamics(out.mechanism);
  for (std::size_t j = 0; j < out.parameters.size(); ++j)
    out.symbols.push_back(out.equations.graph.atom(
        {Atom::Kind::kNumber, scene::Number::parse(symbol(j)), {}, symbol(j)}));
  return out;
}

std::vector<Node> byInertialParameters(InertialSymbols& symbols, Node f) {
  using Kind = scene::InertialParameter::Kind;
  Graph& graph = symbols.equations.graph;
  std::vector<Node> d = graph.gradient(f, {}, symbols.symbols);
  for (std::size_t j = 0; j < d.size(); ++j) {
    if (symbols.parameters[j].kind != Kind::kMass) continue;
    const Node per_mass = graph.inverse(symbols.symbols[j]);
    for (std::size_t k = j + 1; k <= j + 3; ++k) {  // h follows its mass
      d[k] = graph.multiply(d[k], per_mass);
      d[j] = graph.subtract(d[j], graph.multiply(symbols.symbols[k], d[k]));
    }
  }
  return d;
}

std::vector<std::vector<Node>> regressor(InertialSymbols& symbols) {
  std::vector<std::vector<Node>> Y;
  for (const Node tau : inverseDynamics(symbols.equations))
    Y.push_back(byInertialParameters(symbols, tau));
  return Y;
}

std::vector<Node> weightedRegressor(InertialSymbols& symbols) {
  Graph& graph = symbols.equations.graph;
  std::vector<Node> terms;
  int i = 0;
  for (const Node tau : inverseDynamics(symbols.equations))
    terms.push_back(graph.multiply(graph.input(Input::kForce, i++), tau));
  return byInertialParameters(symbols, graph.sum(terms));
}

std::vector<Node> energyRegressor(InertialSymbols& symbols) {
  Graph& graph = symbols.equations.graph;
  return byInertialParameters(symbols,
                              graph.add(symbols.equations.kinetic, symbols.equations.potential));
}

}  // namespace dynwitness::symbolic
