// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/kernel/roads.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/kernel/factor.hpp"
#include "crosscheck/kernel/general_cost.hpp"
#include "crosscheck/kernel/lean_sweeps.hpp"
#include "crosscheck/kernel/traced_sweeps.hpp"
#include "recursive/build_model.hpp"
#include "symbolic/equations.hpp"

namespace dynwitness::crosscheck::kernel {
namespace {

using symbolic::Node;
using symbolic::Program;

/// Links beyond which nothing is searched and no Lagrangian derived: both grow with their square.
constexpr std::size_t kLargestSearched = 20;

constexpr LeanTerms kCoriolisTerms{false, true, false, false, false};
constexpr LeanTerms kBiasTerms{false, true, true, true, true};

void append(std::vector<Traced>& to, const std::vector<Traced>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

/// For each joint the next one inboard, -1: none.
std::vector<int> inboard(const LeanModel& model) {
  std::vector<int> joints(model.links.size(), -1);
  for (const LeanLink& link : model.links)
    if (link.parent >= 0) joints[link.dof] = model.links[link.parent].dof;
  return joints;
}

std::vector<Traced> leanSweep(const LeanModel& model, Formula formula,
                              const scene::State<Traced>& state, Turning turning) {
  switch (formula) {
    case Formula::kInverseDynamics:
      return inverseDynamics(model, state, {}, turning);
    case Formula::kMassMatrix:
      return massMatrix(model, state, turning);
    case Formula::kCoriolis:
      return inverseDynamics(model, state, kCoriolisTerms, turning);
    case Formula::kGravity:
      return gravity(model, state, turning);
    case Formula::kMassCoriolisGravity: {
      std::vector<Traced> all = massMatrix(model, state, turning);
      append(all, inverseDynamics(model, state, kCoriolisTerms, turning));
      append(all, gravity(model, state, turning));
      return all;
    }
    case Formula::kForwardDynamics: {
      std::vector<Traced> b = inverseDynamics(model, state, kBiasTerms, turning);
      for (std::size_t i = 0; i < b.size(); ++i) b[i] = state.tau[i] - b[i];
      return solve(massMatrix(model, state, turning), b, inboard(model));
    }
  }
  return {};
}

std::vector<Node> nodes(const std::vector<Traced>& values) {
  std::vector<Node> out;
  for (const Traced& value : values) out.push_back(value.node());
  return out;
}

/** A model and its program, while better ones are looked for: each step of the search changes the
    origins, units or mass parameters of the best model so far, and is kept where the traced program
    becomes smaller. The function stays the same whatever the search decides. */
class LeanSearch {
 public:
  LeanSearch(const LeanModel& as_given, Formula formula, const scene::State<Traced>& state)
      : best_(as_given), formula_(formula), state_(state) {
    for (const LeanLink& link : as_given.links)
      if (isNumber(link.mass)) total_mass_ += number(link.mass);
    regroup(best_);
    cost_ = cost(best_, turning_);
  }

  Program run() {
    if (best_.links.size() > kLargestSearched) return factored(Traced::graph(), outputs());
    for (int round = 0, before = cost_ + 1; cost_ < before && round < 4; ++round) {
      before = cost_;
      for (int i = static_cast<int>(best_.links.size()) - 1; i >= 0; --i) {
        tryOrigins(i);
        tryMasses(i);
        tryMoments(i);
        tryAxes(i);
      }
    }
    tryTurning();
    tryUnits();
    return factored(Traced::graph(), outputs());
  }

 private:
  /** Steps (of factored()) after which the search is content with what it has: 0.4 s here, of which
      the bundled arms need half at most. Steps are counted and no clock is asked, so that a scene
      has the same program on every machine. */
  static constexpr long kMostSteps = 4'000'000;

  bool isSpent() const { return steps_ > kMostSteps; }
  std::vector<Node> outputs() const { return nodes(leanSweep(best_, formula_, state_, turning_)); }
  int cost(const LeanModel& model, Turning turning) const {
    const std::vector<Node> swept = nodes(leanSweep(model, formula_, state_, turning));
    return factored(Traced::graph(), swept, Effort::kQuick, &steps_).bodyOperations().all();
  }
  void consider(const LeanModel& model) {
    if (isSpent()) return;
    const int c = cost(model, turning_);
    if (c >= cost_) return;
    cost_ = c;
    best_ = model;
  }
  // the link's origin nearest to the parent's, or where the next axis comes nearest
  void tryOrigins(int i) {
    if (!best_.links[i].turns) return;
    std::vector<Traced> shifts = {
        -Vector3(best_.links[i].R.row(2).transpose()).dot(best_.links[i].p)};
    for (const LeanLink& child : best_.links)
      if (child.parent == i) shifts.push_back(child.p.z());
    for (const Traced& t : shifts) {
      if (t == Traced(0)) continue;
      LeanModel moved = best_;
      slide(moved, i, t);
      consider(moved);
    }
  }
  // axes that ride with the link or stay
  void tryAxes(int i) {
    if (!best_.links[i].turns) return;
    LeanModel other = best_;
    other.links[i].stays = !other.links[i].stays;
    consider(other);
  }
  // a mass at the link's origin that takes a first moment off the parent
  void tryMasses(int i) {
    const LeanModel start = best_;
    const LeanLink& link = start.links[i];
    if (link.parent < 0 || !link.turns || !start.links[link.parent].turns) return;
    for (int k : {0, 1}) {
      const Traced h = start.links[link.parent].h(k);
      if (!isNumber(link.p(k)) || !isNumber(h)) continue;
      const Traced mass = h / link.p(k);
      // a lever that is short beside the first moment would cost digits
      if (abs(number(mass)) > total_mass_) continue;
      LeanModel changed = start;
      takeRod(changed, i, {mass, 0, 0});
      consider(changed);
    }
  }
  // moments along the link's axis that are one of the parent's
  void tryMoments(int i) {
    const LeanLink& link = best_.links[i];
    if (link.parent < 0 || !link.turns || !best_.links[link.parent].turns) return;
    const LeanLink parent = best_.links[link.parent];
    const Vector3 z = link.R.row(2).transpose();
    const std::array<Traced, 3> S = {parent.S.xx, parent.S.yy, parent.S.zz};
    for (int k = 0; k < 3; ++k) {
      if (z(k) != Traced(1) && z(k) != Traced(-1)) continue;
      if (S[k] != Traced(0)) {
        LeanModel changed = best_;
        takeRod(changed, i, {0, 0, S[k]});
        consider(changed);
      }
      if (parent.h(k) != Traced(0)) {
        LeanModel changed = best_;
        takeRod(changed, i, {0, z(k) * parent.h(k), 0});
        consider(changed);
      }
    }
  }
  void tryTurning() {
    if (isSpent()) return;
    const int c = cost(best_, Turning::kByMatrix);
    if (c >= cost_) return;
    cost_ = c;
    turning_ = Turning::kByMatrix;
  }
  void tryUnits() {
    const LeanModel metres = best_;
    for (const LeanLink& link : metres.links) {
      for (int k = 0; k < 3; ++k) {
        if (!isNumber(link.p(k))) continue;
        LeanModel scaled = metres;
        if (!scaleLengths(scaled, link.p(k))) return;
        consider(scaled);
      }
    }
  }

  /// A rational number that is not 0: only of these it is known how large they are.
  static bool isNumber(Traced x) { return Traced::graph().isConstant(x.node()) && x != Traced(0); }
  static const symbolic::Rational& number(Traced x) { return Traced::graph().value(x.node()); }

  LeanModel best_;
  symbolic::Rational total_mass_ = 0;
  Formula formula_;
  const scene::State<Traced>& state_;
  Turning turning_ = Turning::kInSteps;
  int cost_ = 0;
  mutable long steps_ = 0;
};

std::vector<Node> lagrange(symbolic::Equations& equations, Formula formula,
                           const std::vector<int>& parent_dof) {
  std::vector<Node> M;
  for (const auto& row : equations.M) M.insert(M.end(), row.begin(), row.end());
  switch (formula) {
    case Formula::kInverseDynamics:
      return symbolic::inverseDynamics(equations);
    case Formula::kMassMatrix:
      return M;
    case Formula::kCoriolis:
      return equations.c;
    case Formula::kGravity:
      return equations.g;
    case Formula::kMassCoriolisGravity:
      return symbolic::massCoriolisGravity(equations);
    case Formula::kForwardDynamics:
      break;
  }
  // M qdd = tau - (c + g - Q)
  symbolic::Graph& graph = equations.graph;
  const Traced::Recording recording(graph);
  std::vector<Traced> entries, b;
  for (const Node& node : M) entries.emplace_back(node);
  for (int i = 0; i < equations.dof(); ++i)
    b.push_back(Traced(graph.input(symbolic::Input::kForce, i)) -
                (Traced(equations.c[i]) + Traced(equations.g[i]) - Traced(equations.Q[i])));
  return nodes(solve(entries, b, parent_dof));
}

/// @throws std::runtime_error, std::domain_error  as roads() does
void requireProgram(const scene::Mechanism& mechanism) {
  if (!mechanism.isOpenTree())
    throw std::runtime_error(
        "kernels are made for open trees, without closures or springs between points");
  if (mechanism.hasCoupledRates())
    throw std::domain_error(
        "programs are made for joints that follow no others and rotors of one rate");
  if (mechanism.hasCoulombFriction())
    throw std::domain_error(
        "kernels compute with + - * / alone, and have no sign for Coulomb friction");
}

/// Calls use(kind, make) for each road, where make() writes its program.
template <typename Use>
void forEachRoad(const scene::Mechanism& mechanism, Formula formula, bool fold_parameters,
                 const Use& use) {
  requireProgram(mechanism);
  symbolic::Graph graph;
  const Traced::Recording recording(graph);
  const recursive::Model<Traced> model =
      recursive::buildModel(mechanism, TracedNumbers(mechanism, fold_parameters));
  const scene::State<Traced> state = tracedState(mechanism);
  const auto traced = [&](const recursive::Model<Traced>& traced_model) {
    return factored(graph, nodes(tracedSweep(traced_model, formula, state)));
  };
  if (isLean(model)) {
    const LeanModel lean = leanModel(model);
    use(RoadKind::kLeanSweep, [&] { return LeanSearch(lean, formula, state).run(); });
    use(RoadKind::kTracedOnBase, [&] {
      LeanModel base = lean;
      regroup(base);
      return traced(recursiveModel(base));
    });
    use(RoadKind::kLagrange, [&] {
      symbolic::Options options;
      options.fold_parameters = fold_parameters;
      symbolic::Equations equations = symbolic::derive(mechanism, options);
      const std::vector<Node> outputs = lagrange(equations, formula, inboard(lean));
      return factored(equations.graph, outputs);
    });
  }
  use(RoadKind::kTracedSweep, [&] { return traced(model); });
}

}  // namespace

const char* name(Formula formula) {
  switch (formula) {
    case Formula::kInverseDynamics:
      return "ID";
    case Formula::kMassMatrix:
      return "M";
    case Formula::kCoriolis:
      return "c";
    case Formula::kGravity:
      return "g";
    case Formula::kMassCoriolisGravity:
      return "M + c + g";
    case Formula::kForwardDynamics:
      return "FD";
  }
  return "?";
}

const char* name(RoadKind kind) {
  switch (kind) {
    case RoadKind::kLeanSweep:
      return "lean sweep";
    case RoadKind::kTracedOnBase:
      return "traced on base";
    case RoadKind::kLagrange:
      return "Lagrange";
    case RoadKind::kTracedSweep:
      return "traced sweep";
  }
  return "?";
}

int Road::operations() const {
  return program.bodyOperations().all();
}

std::vector<Road> roads(const scene::Mechanism& mechanism, Formula formula) {
  std::vector<Road> all;
  forEachRoad(mechanism, formula, true, [&](RoadKind kind, const auto& make) {
    all.push_back({kind, make()});
  });
  return all;
}

SmallestRoads::SmallestRoads(const scene::Mechanism& mechanism) : mechanism_(mechanism) {}

namespace {

bool isCounted(Formula formula) {
  return formula == Formula::kInverseDynamics || formula == Formula::kMassMatrix ||
         formula == Formula::kForwardDynamics;
}

/// The smallest road, and the operations of the general sweep where those are counted (else 0).
std::pair<Road, long> smallestOfAll(const scene::Mechanism& mechanism, Formula formula,
                                    bool fold_parameters = true) {
  long general = 0;
  if (mechanism.dof() > kMostDof)
    throw NotUsed(
        fmt::format("{} degrees of freedom, at most {} are written out in a straight line",
                    mechanism.dof(), kMostDof));
  if (isCounted(formula)) {
    requireProgram(mechanism);
    general = generalOperations(mechanism, formula);
    if (general > kMostSaved * kMostOperations)
      throw NotUsed(
          fmt::format("{} operations in the general sweep, which a straight line would not bring "
                      "down to {}",
                      general, kMostOperations));
  }
  std::vector<Road> all;
  forEachRoad(mechanism, formula, fold_parameters, [&](RoadKind kind, const auto& make) {
    const bool is_traced = kind == RoadKind::kTracedOnBase || kind == RoadKind::kTracedSweep;
    if (kind == RoadKind::kLagrange && mechanism.links.size() > kLargestSearched) return;
    if (!is_traced || all.empty()) all.push_back({kind, make()});
  });
  const Road& best = *std::min_element(all.begin(), all.end(), [](const Road& a, const Road& b) {
    return a.operations() < b.operations();
  });
  if (isCounted(formula) && best.operations() > kMostOperations)
    throw NotUsed(fmt::format("{} operations in a straight line, at most {} are compiled",
                              best.operations(), kMostOperations));
  return {best, general};
}

}  // namespace

SmallestRoads::Found SmallestRoads::found(const scene::Mechanism& mechanism, Formula formula) {
  const auto not_used = [&](const std::string& why) {
    return Found{{},
                 fmt::format("no kernel of {} is used: {}; `fast` runs loops", name(formula), why)};
  };
  try {
    const auto [best, general] = smallestOfAll(mechanism, formula);
    if (isCounted(formula) && best.operations() >= general)
      return not_used(
          fmt::format("its {} operations are not fewer than the {} of the general sweep",
                      best.operations(), general));
    return {best, ""};
  } catch (const NotUsed& why) {
    return not_used(why.what());
  }
}

Road smallestWritten(const scene::Mechanism& mechanism, Formula formula, bool fold_parameters) {
  return smallestOfAll(mechanism, formula, fold_parameters).first;
}

const Road& SmallestRoads::operator()(Formula formula) const {
  auto it = known_.find(formula);
  if (it == known_.end()) it = known_.emplace(formula, found(mechanism_, formula)).first;
  if (!it->second.not_used.empty()) throw NotUsed(it->second.not_used);
  return it->second.road;
}

Road smallestRoad(const scene::Mechanism& mechanism, Formula formula) {
  return SmallestRoads(mechanism)(formula);
}

}  // namespace dynwitness::crosscheck::kernel
