// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/reduce.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/kernel/factor.hpp"
#include "crosscheck/kernel/roads.hpp"
#include "crosscheck/reduction/parameter_sequence.hpp"
#include "crosscheck/reduction/reduced_acceleration.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using kernel::Formula;
using scene::JointRanges;
using symbolic::Graph;
using symbolic::Node;
using symbolic::Program;
using Kind = EnvelopeQuantity::Kind;

/// For the largest |tau_i|, of which the value that is seen counts and not its bound. Measured:
/// arms of up to six joints have their bound after 129 at most.
constexpr int kForceBoxes = 2000;
constexpr int kDecisionBoxes = 2000;  ///< what one question "is this within the limit?" may take
constexpr double kFurther = 30;       ///< parameters go until samples err by so many allowed errors
constexpr int kBases = 6;  ///< of the reduced scenes between, so many are tried with terms
constexpr std::size_t kMostTerms = 400;  ///< that are added to one joint's force

/// Shares of the time in percent, by which its end is told. Measured: puma_560 with 5 % takes 1.7,
/// 0.7, 0.7, 4, 80 and 13 % of 20.4 s.
constexpr double kForces = 2, kProgram = 1, kOrder = 1, kScenes = 4, kTerms = 80, kErrors = 12;

/// Nothing of it weighs anything.
scene::Scene weightless(scene::Scene scene) {
  for (scene::Link& link : scene.mechanism.links) {
    link.inertia = {};
    link.joint.rotor_inertia = 0;
    link.joint.gyroscopic = false;
    link.joint.rotors.clear();
  }
  return scene;
}

// ---- terms

Polynomial difference(const Polynomial& a, const Polynomial& b) {
  Polynomial out = a;
  add(b, -1, &out);
  return out;
}

bool counts(const RunningError& c) {
  return std::abs(c.value()) > c.bound();
}

/// The largest that a monomial of a part is, times what it is multiplied by.
class Sizes {
 public:
  Sizes(const TrigonometricModel& model, const std::vector<JointRanges>& ranges)
      : model_(model), ranges_(ranges) {}

  double of(const EnvelopePart& part) const {
    if (part.j < 0) return 1;
    const JointRanges& j = ranges_[static_cast<std::size_t>(part.j)];
    return part.k < 0 ? j.qdd.most()
                      : j.qd.most() * ranges_[static_cast<std::size_t>(part.k)].qd.most();
  }
  double of(Monomial m) const {
    double product = 1;
    for (int k = 0; k < model_.dof; ++k)
      if (model_.slides[static_cast<std::size_t>(k)])
        product *= std::pow(ranges_[static_cast<std::size_t>(k)].q.most(), digit(m, k));
    return product;
  }
  /** At most this everywhere: monomials of the same harmonics are products of cos or sin of each
      joint, whose squares add up to 1 (Cauchy and Schwarz). */
  double bound(const EnvelopePart& part) const {
    std::map<std::vector<int>, double> groups;
    for (const auto& [m, c] : part.f) {
      std::vector<int> group;
      for (int k = 0; k < model_.dof; ++k) {
        const int d = digit(m, k);
        group.push_back(model_.slides[static_cast<std::size_t>(k)] ? d : (d + 1) / 2);
      }
      groups[group] += std::pow((std::abs(c.value()) + c.bound()) * of(m), 2);
    }
    double sum = 0;
    for (const auto& [group, squares] : groups) sum += std::sqrt(squares);
    // roundings u: 39 of of(m) (13 joints, each a power within 2 u and a product), 8 of the other
    // steps of one term, half a one a term below the roots and one above them: 47 + 1.5 terms
    return sum * of(part) * (1 + 64 * RunningError::kUnitRoundoff * (1.0 + part.f.size()));
  }

 private:
  const TrigonometricModel& model_;
  const std::vector<JointRanges>& ranges_;
};

/// One monomial of D_i, in the order in which they stay.
struct Term {
  std::size_t part;
  Monomial monomial;
  double size;
};

std::vector<Term> termsOf(const std::vector<EnvelopePart>& parts, const Sizes& sizes) {
  std::vector<Term> terms;
  for (std::size_t p = 0; p < parts.size(); ++p)
    for (const auto& [m, c] : parts[p].f)
      if (counts(c))
        terms.push_back({p, m, std::abs(c.value()) * sizes.of(m) * sizes.of(parts[p])});
  std::stable_sort(terms.begin(), terms.end(),
                   [](const Term& a, const Term& b) { return a.size > b.size; });
  return terms;
}

/// D_i without its first `count` terms: what of a coefficient is not known stays.
std::vector<EnvelopePart> without(std::vector<EnvelopePart> parts, const std::vector<Term>& terms,
                                  std::size_t count) {
  for (std::size_t t = 0; t < count; ++t) {
    RunningError& c = parts[terms[t].part].f.at(terms[t].monomial);
    c = RunningError(0, c.bound());
  }
  return parts;
}

/// Whether |sum of parts| <= limit everywhere, as far as is known within so many boxes.
bool isWithin(const TrigonometricModel& model, const std::vector<JointRanges>& ranges, int i,
              const std::vector<EnvelopePart>& parts, double limit, double* bound) {
  const Sizes sizes(model, ranges);
  *bound = 0;
  for (const EnvelopePart& part : parts) *bound += sizes.bound(part);
  if (*bound <= limit) return true;
  EnvelopeOptions options;
  options.boxes = kDecisionBoxes;
  const EnvelopeBound found =
      boundOfParts(model, ranges, {Kind::kTau, i, 0}, parts, options, limit);
  if (found.certified > limit) return false;
  *bound = found.certified;
  return true;
}

/// How many of the terms have to stay, so that the others together are within the limit; none: too
/// many.
struct Kept {
  std::size_t count;
  double bound;
};
std::optional<Kept> kept(const TrigonometricModel& model, const std::vector<JointRanges>& ranges,
                         int i, const std::vector<EnvelopePart>& parts,
                         const std::vector<Term>& terms, double limit) {
  double bound = 0;
  if (isWithin(model, ranges, i, parts, limit, &bound)) return Kept{0, bound};
  // where the bisection begins, what is probably enough; isWithin() decides
  double rest = 0;
  std::size_t high = terms.size();
  while (high > 0 && rest + terms[high - 1].size < 0.9 * limit) rest += terms[--high].size;
  if (high > kMostTerms) return std::nullopt;
  std::size_t low = 0;
  if (!isWithin(model, ranges, i, without(parts, terms, high), limit, &bound)) return std::nullopt;
  Kept best{high, bound};
  while (best.count - low > 1) {
    const std::size_t middle = (low + best.count) / 2;
    if (isWithin(model, ranges, i, without(parts, terms, middle), limit, &bound))
      best = {middle, bound};
    else
      low = middle;
  }
  return best;
}

// ---- programs

/// A program, written down again in another graph.
std::vector<Node> replay(const Program& program, Graph* graph) {
  std::vector<Node> slots(static_cast<std::size_t>(program.slots));
  std::size_t at = 0;
  for (const scene::Rational& r : program.constants) slots[at++] = graph->constant(r);
  for (const symbolic::Atom& a : program.atoms) slots[at++] = graph->atom(a);
  for (const Program::Load& load : program.loads)
    slots[static_cast<std::size_t>(load.slot)] = graph->input(load.input, load.joint);
  for (const auto* code : {&program.prologue, &program.body})
    for (const Program::Instruction& i : *code) {
      const Node a = slots[static_cast<std::size_t>(i.a)], b = slots[static_cast<std::size_t>(i.b)];
      Node& out = slots[static_cast<std::size_t>(i.result)];
      switch (i.code) {
        case Program::Code::kAdd:
          out = graph->add(a, b);
          break;
        case Program::Code::kSubtract:
          out = graph->subtract(a, b);
          break;
        case Program::Code::kMultiply:
          out = graph->multiply(a, b);
          break;
        case Program::Code::kNegate:
          out = graph->negate(a);
          break;
        case Program::Code::kInverse:
          out = graph->inverse(a);
          break;
      }
    }
  std::vector<Node> outputs;
  for (const int slot : program.outputs) outputs.push_back(slots[static_cast<std::size_t>(slot)]);
  return outputs;
}

/// 1, c, s, c^2 - s^2, 2 s c; 1, q, q^2.
Node functionOf(int joint, int digit, bool slides, Graph* graph) {
  if (slides) {
    const Node q = graph->input(symbolic::Input::kPosition, joint);
    return digit == 1 ? q : graph->multiply(q, q);
  }
  const Node c = graph->input(symbolic::Input::kCos, joint),
             s = graph->input(symbolic::Input::kSin, joint);
  switch (digit) {
    case 1:
      return c;
    case 2:
      return s;
    case 3:
      return graph->subtract(graph->constant(1),
                             graph->multiply(graph->constant(2), graph->multiply(s, s)));
    default:
      return graph->multiply(graph->constant(2), graph->multiply(s, c));
  }
}

Program programOf(const Program& sweep, const std::vector<KeptTerm>& terms,
                  const TrigonometricModel& model) {
  if (terms.empty()) return sweep;
  Graph graph;
  std::vector<Node> outputs = replay(sweep, &graph);
  std::map<std::array<int, 3>, std::vector<Node>> functions;  // of q, by i, j, k
  for (const KeptTerm& term : terms) {
    Node product = graph.constant(scene::Rational(term.coefficient));
    for (int k = model.dof - 1; k >= 0; --k)
      if (const int d = digit(term.monomial, k); d != 0)
        product = graph.multiply(
            functionOf(k, d, model.slides[static_cast<std::size_t>(k)], &graph), product);
    functions[{term.i, term.j, term.k}].push_back(product);
  }
  std::map<int, std::vector<Node>> sums;
  for (const auto& [at, f] : functions) {
    Node part = graph.sum(f);
    if (at[1] >= 0 && at[2] < 0)
      part = graph.multiply(part, graph.input(symbolic::Input::kAcceleration, at[1]));
    if (at[2] >= 0)
      part = graph.multiply(part, graph.multiply(graph.input(symbolic::Input::kVelocity, at[1]),
                                                 graph.input(symbolic::Input::kVelocity, at[2])));
    sums[at[0]].push_back(part);
  }
  for (const auto& [i, parts] : sums)
    outputs[static_cast<std::size_t>(i)] =
        graph.add(outputs[static_cast<std::size_t>(i)], graph.sum(parts));
  return kernel::factored(graph, outputs);
}

// ---- all together

/// A base with the terms that have to be added to it.
struct Draft {
  std::vector<KeptTerm> terms;
  std::vector<double> bounds;  ///< of what is left out, by joint
};

/// Times what roundings may make of tau_i: no limit below can be shown. The search for the largest
/// of a quantity that is 0 ends at twice its roundings (EnvelopeBound::lost), and the difference of
/// two models carries those of both.
constexpr double kShown = 2 * 2;

class Reducer {
 public:
  Reducer(const scene::Scene& scene, const std::vector<JointRanges>& ranges,
          const ReduceOptions& options, const std::function<void(const std::string&)>& stage)
      : scene_(scene), ranges_(ranges), options_(options), stage_(stage) {
    requireTreated(scene, Command::kReduce);
    EnvelopeOptions forces;
    forces.boxes = std::min(options.boxes, kForceBoxes);
    {
      const scene::Work work("forces", 1, kForces);
      for (const EnvelopeBound& tau : envelopeBounds(scene, ranges, forces, stage)) {
        largest_.push_back(tau.sampled);
        lost_.push_back(tau.lost);
      }
    }
    for (const double allowed : options.allowed)
      for (std::size_t i = 0; i < largest_.size(); ++i)
        if (allowed > 0 && largest_[i] > 0 && limit(i, allowed) < kShown * lost_[i])
          throw scene::InputError(
              {scene.file.string()},
              fmt::format("reduce: an error of {:.3g} of tau_{}: roundings alone may make {:.2g} "
                          "of it, allowed: four times that or more, or 0",
                          allowed, i + 1, lost_[i] / largest_[i]));
    stage("the scene's own program");
    const scene::Work work("program", 1, kProgram);
    full_program_ = kernel::smallestRoad(scene.mechanism, Formula::kInverseDynamics).program;
    full_ = trigonometricModel(scene);
  }

  Reduction run() {
    Reduction out;
    out.full = full_program_;
    stage_("which parameters are missed least");
    const ReductionSamples samples(scene_.mechanism, ranges_, ReducedQuantity::kTau);
    const double most = *std::max_element(options_.allowed.begin(), options_.allowed.end());
    {
      const scene::Work work("order", 1, kOrder);
      bases_ = parameterSequence(scene_, samples, largest_, kFurther * most);
    }
    bases_.push_back({weightless(scene_), {}, HUGE_VAL});
    found_.resize(options_.allowed.size());
    scenes_.resize(options_.allowed.size());
    tryScenes();
    if (options_.adds_terms) tryBases();
    const double rules = options_.armstrong > 0 ? 1 : 0;
    scene::Work work("errors", static_cast<double>(options_.allowed.size()) + rules, kErrors);
    for (std::size_t t = 0; t < options_.allowed.size(); ++t, work.done()) {
      stage_(fmt::format("error at {:.3g} %", 100 * options_.allowed[t]));
      out.models.push_back(finished(*found_[t], options_.allowed[t]));
      out.scenes.push_back(scenes_[t]->base == found_[t]->base && found_[t]->draft.terms.empty()
                               ? out.models.back()
                               : finished(*scenes_[t], options_.allowed[t]));
    }
    if (options_.armstrong > 0) {
      stage_("Armstrong's rule");
      out.by_rule.push_back(finished(byRule(options_.armstrong), options_.armstrong));
    }
    return out;
  }

 private:
  struct Found {
    std::size_t base = 0;
    Draft draft;
    Program program;

    int operations() const { return program.bodyOperations().all(); }
  };

  double limit(std::size_t i, double allowed) const {
    return largest_[i] > 0 ? allowed * largest_[i] : kShown * lost_[i];
  }
  bool isWeightless(std::size_t b) const { return b + 1 == bases_.size(); }

  const Program& sweep(std::size_t b) {
    if (b == 0) return full_program_;
    auto it = sweeps_.find(b);
    if (it == sweeps_.end()) {
      const scene::Work work("program", 1);
      it =
          sweeps_
              .emplace(b, kernel::smallestRoad(bases_[b].scene.mechanism, Formula::kInverseDynamics)
                              .program)
              .first;
    }
    return it->second;
  }

  TrigonometricModel differenceTo(std::size_t b) const {
    TrigonometricModel none = full_;
    if (!isWeightless(b)) return difference(full_, trigonometricModel(bases_[b].scene));
    for (auto& row : none.M)
      for (Polynomial& f : row) f.clear();
    for (Polynomial& f : none.gravity) f.clear();
    return difference(full_, none);
  }

  /// By joint.
  using Parts = std::vector<std::vector<EnvelopePart>>;
  static Parts partsOf(const TrigonometricModel& model) {
    Parts all;
    for (int i = 0; i < model.dof; ++i) all.push_back(envelopeParts(model, {Kind::kTau, i, 0}));
    return all;
  }

  /// The terms to be added to base b, unless they are too many.
  std::optional<Draft> draft(const TrigonometricModel& model, const Parts& parts_of,
                             double allowed) const {
    Draft out;
    const Sizes sizes(model, ranges_);
    for (int i = 0; i < model.dof; ++i) {
      const std::vector<EnvelopePart>& parts = parts_of[static_cast<std::size_t>(i)];
      const std::vector<Term> terms = termsOf(parts, sizes);
      const std::optional<Kept> some =
          kept(model, ranges_, i, parts, terms, limit(static_cast<std::size_t>(i), allowed));
      if (!some) return std::nullopt;
      out.bounds.push_back(some->bound);
      keep(i, parts, terms, some->count, &out);
    }
    return out;
  }

  static void keep(int i, const std::vector<EnvelopePart>& parts, const std::vector<Term>& terms,
                   std::size_t count, Draft* out) {
    for (std::size_t t = 0; t < count; ++t) {
      const EnvelopePart& part = parts[terms[t].part];
      out->terms.push_back(
          {i, part.j, part.k, terms[t].monomial, part.f.at(terms[t].monomial).value()});
    }
  }

  void consider(std::size_t t, Found candidate, std::vector<std::optional<Found>>* into) const {
    std::optional<Found>& best = (*into)[t];
    if (!best || candidate.operations() < best->operations()) best = std::move(candidate);
  }

  /// The last scene of the sequence that is good enough without any term.
  void tryScenes() {
    const Draft nothing{{}, std::vector<double>(largest_.size(), 0)};
    for (std::size_t t = 0; t < found_.size(); ++t) {
      consider(t, {0, nothing, full_program_}, &scenes_);
      consider(t, {0, nothing, full_program_}, &found_);
    }
    scene::Work work("scenes", static_cast<double>(bases_.size()), kScenes);
    std::size_t open = 0;  // those below have their scene
    std::vector<bool> has(found_.size(), false);
    for (std::size_t b = bases_.size() - 1; b-- > 1 && open < has.size(); work.done()) {
      const auto isWorth = [&](std::size_t t) {
        return !has[t] && bases_[b].sampled <= options_.allowed[t];
      };
      bool any = false;
      for (std::size_t t = 0; t < has.size(); ++t) any = any || isWorth(t);
      if (!any) continue;
      stage_(fmt::format("{} parameters dropped", bases_[b].dropped.size()));
      const TrigonometricModel model = differenceTo(b);
      const Parts parts = partsOf(model);
      for (std::size_t t = 0; t < has.size(); ++t) {
        if (!isWorth(t)) continue;
        Draft d;
        bool is_within = true;
        for (int i = 0; i < model.dof && is_within; ++i) {
          double bound = 0;
          is_within = isWithin(model, ranges_, i, parts[static_cast<std::size_t>(i)],
                               limit(static_cast<std::size_t>(i), options_.allowed[t]), &bound);
          d.bounds.push_back(bound);
        }
        if (!is_within) continue;
        has[t] = true;
        ++open;
        consider(t, {b, d, sweep(b)}, &scenes_);
        consider(t, {b, d, sweep(b)}, &found_);
      }
    }
  }

  /// Of the scenes that err by more than each allowed error some, and that without weight.
  std::vector<std::size_t> basesToTry() const {
    std::vector<std::size_t> all;
    const double least = options_.allowed.front() > 0 || options_.allowed.size() == 1
                             ? options_.allowed.front()
                             : options_.allowed[1];
    std::size_t from = 1;
    while (from + 1 < bases_.size() && bases_[from].sampled <= 0.5 * least) ++from;
    const std::size_t count = bases_.size() - 1 - from;
    const auto wanted = static_cast<std::size_t>(kBases) * std::min<std::size_t>(3, found_.size());
    const std::size_t stride = std::max<std::size_t>(1, (count + wanted - 1) / wanted);
    for (std::size_t b = from; b + 1 < bases_.size(); b += stride) all.push_back(b);
    all.push_back(bases_.size() - 1);
    return all;
  }

  void tryBases() {
    const std::vector<std::size_t> all = basesToTry();
    scene::Work work("terms", static_cast<double>(all.size()), kTerms);
    for (const std::size_t b : all) {
      tryBase(b);
      work.done();
    }
  }

  void tryBase(std::size_t b) {
    stage_(isWeightless(b) ? std::string("terms alone")
                           : fmt::format("terms after {} parameters", bases_[b].dropped.size()));
    const TrigonometricModel model = differenceTo(b);
    const Parts parts = partsOf(model);
    for (std::size_t t = 0; t < found_.size(); ++t) {
      const double allowed = options_.allowed[t];
      if (allowed <= 0 || (!isWeightless(b) && bases_[b].sampled > kFurther * allowed)) continue;
      // parameters alone would have been found before
      if (sweep(b).bodyOperations().all() >= found_[t]->operations()) continue;
      const std::optional<Draft> d = draft(model, parts, allowed);
      if (!d) continue;
      consider(t, {b, *d, programOf(sweep(b), d->terms, model)}, &found_);
    }
  }

  /** Armstrong, Khatib and Burdick (1986): of each entry M_ij, c_ijk, g_i those terms go that are
      below `share` of the entry's largest. Nothing says beforehand what that does to tau. */
  Found byRule(double share) {
    const std::size_t b = bases_.size() - 1;
    const TrigonometricModel model = differenceTo(b);
    const Sizes sizes(model, ranges_);
    Draft out;
    for (int i = 0; i < model.dof; ++i) {
      const std::vector<EnvelopePart> parts = envelopeParts(model, {Kind::kTau, i, 0});
      for (const EnvelopePart& part : parts) {
        double most = 0;
        for (const auto& [m, c] : part.f)
          if (counts(c)) most = std::max(most, std::abs(c.value()) * sizes.of(m));
        for (const auto& [m, c] : part.f)
          if (counts(c) && std::abs(c.value()) * sizes.of(m) >= share * most)
            out.terms.push_back({i, part.j, part.k, m, c.value()});
      }
      out.bounds.push_back(HUGE_VAL);
    }
    return {b, out, programOf(sweep(b), out.terms, model)};
  }

  /// Bounds of what is left out, by joint and by term.
  ReducedModel finished(const Found& found, double allowed) {
    ReducedModel out;
    out.allowed = allowed;
    out.scene = bases_[found.base].scene;
    out.parameters = bases_[found.base].dropped;
    out.is_explicit = isWeightless(found.base);
    out.terms = found.draft.terms;
    out.program = found.program;
    if (found.base == 0 && out.terms.empty()) {
      for (const double largest : largest_) out.forces.push_back({largest, 0, 0, {}});
      return out;
    }
    const TrigonometricModel model = differenceTo(found.base);
    const Sizes sizes(model, ranges_);
    symbolic::ProgramRun<RunningError> program(out.program, RunningErrorNumbers(scene_.mechanism));
    for (int i = 0; i < model.dof; ++i) {
      const auto row = static_cast<std::size_t>(i);
      std::vector<EnvelopePart> parts = envelopeParts(model, {Kind::kTau, i, 0});
      const std::vector<EnvelopePart> all = envelopeParts(full_, {Kind::kTau, i, 0});
      for (const KeptTerm& term : out.terms)
        if (term.i == i)
          for (EnvelopePart& part : parts)
            if (part.j == term.j && part.k == term.k) {
              RunningError& c = part.f.at(term.monomial);
              c = RunningError(0, c.bound());
            }
      EnvelopeOptions options;
      options.boxes = options_.boxes;
      const EnvelopeBound error = boundOfParts(model, ranges_, {Kind::kTau, i, 0}, parts, options);
      ReducedForce force{largest_[row], std::min(error.certified, found.draft.bounds[row]), 0,
                         error.worst};
      if (found.draft.bounds[row] == 0) force.at_most = error.certified;
      if (!error.worst.q.empty()) {
        const RunningError off = sweptQuantity(scene_, {Kind::kTau, i, 0}, error.worst) -
                                 program(stateOf(error.worst))[row];
        force.at_least = std::max(0.0, std::abs(off.value()) - off.bound());
      }
      out.forces.push_back(force);
      for (const EnvelopePart& part : parts) noteChange(i, part, all, sizes, &out);
    }
    std::stable_sort(out.changed.begin(), out.changed.end(),
                     [](const ChangedTerm& a, const ChangedTerm& b) { return a.share > b.share; });
    return out;
  }

  void noteChange(int i, const EnvelopePart& left_out, const std::vector<EnvelopePart>& full,
                  const Sizes& sizes, ReducedModel* out) const {
    const double largest = largest_[static_cast<std::size_t>(i)];
    if (largest <= 0 || std::none_of(left_out.f.begin(), left_out.f.end(),
                                     [](const auto& term) { return counts(term.second); }))
      return;
    bool is_dropped = true;
    for (const EnvelopePart& part : full)
      if (part.j == left_out.j && part.k == left_out.k)
        for (const auto& [m, c] : part.f) {
          const auto off = left_out.f.find(m);
          is_dropped =
              is_dropped && (off == left_out.f.end() ? !counts(c) : !counts(c - off->second));
        }
    out->changed.push_back(
        {i, left_out.j, left_out.k, is_dropped, sizes.bound(left_out) / largest});
  }

  static scene::State<RunningError> stateOf(const EnvelopeState& state) {
    scene::State<RunningError> out;
    for (const double q : state.q) out.x.push_back(runningErrorPosition(q));
    out.qd.assign(state.qd.begin(), state.qd.end());
    out.qdd.assign(state.qdd.begin(), state.qdd.end());
    return out;
  }

  const scene::Scene& scene_;
  const std::vector<JointRanges>& ranges_;
  const ReduceOptions& options_;
  const std::function<void(const std::string&)>& stage_;
  std::vector<double> largest_, lost_;
  Program full_program_;
  TrigonometricModel full_;
  std::vector<ReducedBase> bases_;  ///< the scene as it is first, nothing that weighs last
  std::map<std::size_t, Program> sweeps_;
  std::vector<std::optional<Found>> found_, scenes_;
};

}  // namespace

TrigonometricModel difference(const TrigonometricModel& a, const TrigonometricModel& b) {
  TrigonometricModel out = a;
  for (std::size_t i = 0; i < a.M.size(); ++i) {
    for (std::size_t j = i; j < a.M.size(); ++j)
      out.M[i][j] = out.M[j][i] = difference(a.M[i][j], b.M[i][j]);
    out.gravity[i] = difference(a.gravity[i], b.gravity[i]);
    out.loads[i].clear();
  }
  return out;
}

std::string ChangedTerm::name() const {
  if (j < 0) return fmt::format("g_{}", i + 1);
  if (k < 0) return fmt::format("M_{},{}", i + 1, j + 1);
  return fmt::format("c_{},{},{}", i + 1, j + 1, k + 1);
}

double ReducedModel::share() const {
  double most = 0;
  for (const ReducedForce& force : forces) most = std::max(most, force.share());
  return most;
}

Reduction reduced(const scene::Scene& scene, const std::vector<JointRanges>& ranges,
                  const ReduceOptions& options,
                  const std::function<void(const std::string&)>& stage) {
  if (options.of == ReducedQuantity::kQdd)
    return reducedInAcceleration(scene, ranges, options, stage);
  const scene::Work work("reduction", kForces + kProgram + kOrder + kScenes + kTerms + kErrors);
  return Reducer(scene, ranges, options, stage).run();
}

}  // namespace dynwitness::crosscheck
