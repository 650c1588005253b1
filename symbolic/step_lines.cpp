// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/step_lines.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "symbolic/bodies.hpp"
#include "symbolic/derivation_steps.hpp"
#include "symbolic/print.hpp"

namespace dynwitness::symbolic {
namespace {

constexpr Dimension kAcceleration = kVelocity + kTurning, kTurningFaster = kTurning + kTurning;

/// What a quantity of this dimension is in a step; empty: it may be many things.
std::string nounOf(Dimension d, const Step& step) {
  struct Word {
    Dimension d;
    const char* noun;
  };
  static const Word kWords[] = {{{}, "number"},
                                {kMass, "mass"},
                                {kLength, "length"},
                                {kMass + kLength, "first moment of mass"},
                                {kInertia, "moment of inertia"},
                                {kVelocity, "velocity"},
                                {kTurning, "angular velocity"},
                                {kAcceleration, "acceleration without qdd"},
                                {kTurningFaster, "angular acceleration without qdd"},
                                {kMass + kVelocity, "momentum"},
                                {kInertia + kTurning, "angular momentum"},
                                {kForce, "force"},
                                {kMoment, "moment"}};
  const bool is_energy = step.name.find("energ") != std::string::npos;
  if (d == kMoment && is_energy) return "energy";
  if (is_energy && (d == kTurningFaster || d == kVelocity + kVelocity)) return "square of a rate";
  for (const Word& word : kWords)
    if (word.d == d) return word.noun;
  return {};
}

std::string unitIn(Dimension d, const std::string& noun) {
  if (noun == "energy") return "J";
  if (d == kTurning) return "rad/s";
  if (noun.find("angular acceleration") == 0) return "rad/s^2";
  return unitOf(d);
}

/// Of what velocities() and nameCompositeBodies() have named.
std::optional<Dimension> dimensionOfName(const std::string& name) {
  const std::size_t digit = name.find_first_of("0123456789");
  const std::string head = name.substr(0, digit);
  return digit == std::string::npos ? std::nullopt
         : head == "omega"          ? std::optional(kTurning)
         : head == "v"              ? std::optional(kVelocity)
         : head == "mc"             ? std::optional(kMass)
         : head == "sc"             ? std::optional(kMass + kLength)
         : head == "Ic"             ? std::optional(kInertia)
                                    : std::nullopt;
}

/// The lines of a program as equations of steps.
class LinesOfSteps {
 public:
  LinesOfSteps(Equations& e, const scene::Mechanism& mechanism, const std::vector<Result>& results,
               std::vector<Step>* steps)
      : e_(e), steps_(*steps) {
    std::vector<Node> nodes;
    std::vector<Dimension> dimensions;
    for (const Result& r : results)
      if (!r.closed) {
        long_.push_back(&r);
        nodes.push_back(r.node);
        dimensions.push_back(r.dimension);
      }
    program_ = compile(e.graph, nodes);
    for (std::size_t r = 0; r < long_.size(); ++r)
      if (std::string& name = program_.slot_names[static_cast<std::size_t>(program_.outputs[r])];
          name.empty())
        name = long_[r]->name;
    lines_ = statements(program_, Style::kText);
    dimension_of_ = slotDimensions(program_, e, mechanism, dimensions, dimensionOfName);
    for (std::size_t i = 0; i < lines_.size(); ++i) line_of_[lines_[i].slot] = i;
    is_written_.assign(lines_.size(), false);
    findOutmost();
  }

  void write(std::size_t step) {
    std::vector<std::size_t> of_step;  // of long_
    for (std::size_t r = 0; r < long_.size(); ++r)
      if (long_[r]->step == step) of_step.push_back(r);
    writeOutward(of_step, step);
    // results of one link together, from the outermost on
    std::stable_sort(of_step.begin(), of_step.end(),
                     [&](std::size_t a, std::size_t b) { return long_[a]->link > long_[b]->link; });
    for (auto r = of_step.begin(); r != of_step.end();) {
      std::vector<std::size_t> wanted;
      const int link = long_[*r]->link;
      for (; r != of_step.end() && long_[*r]->link == link; ++r)
        if (const auto at = line_of_.find(program_.outputs[*r]); at != line_of_.end()) {
          if (lines_[at->second].name == long_[*r]->name)
            addReads(at->second, &wanted);
          else
            wanted.push_back(at->second);
        }
      writeGroup(needed(wanted), link, step);
    }
  }

  /// A result that is no closed form: its line and those of other results that it reads, where they
  /// are not written yet.
  void writeResult(const Result* result, std::size_t step) {
    const auto r =
        static_cast<std::size_t>(std::find(long_.begin(), long_.end(), result) - long_.begin());
    const int slot = program_.outputs[r];
    const auto at = line_of_.find(slot);
    if (at != line_of_.end()) {
      for (const std::size_t i : needed({at->second})) writeLine(i, step);
      if (lines_[at->second].name == result->name) return;
    }
    steps_[step].equations.push_back(
        {{Formula::ofSymbol(result->name), at != line_of_.end()
                                               ? Formula::ofSymbol(lines_[at->second].name)
                                               : leafFormula(program_, slot)},
         {},
         result->node});
  }

 private:
  /// Of each line the last joint on which it depends.
  void findOutmost() {
    std::vector<int> outmost(static_cast<std::size_t>(program_.slots), -1);
    for (const Program::Load& load : program_.loads)
      outmost[static_cast<std::size_t>(load.slot)] = load.joint;
    for (const auto* part : {&program_.prologue, &program_.body})
      for (const Program::Instruction& i : *part) {
        int& at = outmost[static_cast<std::size_t>(i.result)];
        at = outmost[static_cast<std::size_t>(i.a)];
        if (i.code != Program::Code::kNegate && i.code != Program::Code::kInverse)
          at = std::max(at, outmost[static_cast<std::size_t>(i.b)]);
      }
    for (const Statement& line : lines_)
      outmost_.push_back(outmost[static_cast<std::size_t>(line.slot)]);
  }

  /// Lines that are not written yet and that these are made of, themselves among them, in order.
  std::vector<std::size_t> needed(std::vector<std::size_t> open) const {
    std::vector<char> is_needed(lines_.size(), 0);
    while (!open.empty()) {
      const std::size_t i = open.back();
      open.pop_back();
      if (is_written_[i] || is_needed[i]) continue;
      is_needed[i] = 1;
      addReads(i, &open);
    }
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < lines_.size(); ++i)
      if (is_needed[i]) out.push_back(i);
    return out;
  }

  void addReads(std::size_t line, std::vector<std::size_t>* to) const {
    for (const int slot : lines_[line].reads)
      if (const auto at = line_of_.find(slot); at != line_of_.end()) to->push_back(at->second);
  }

  void writeLine(std::size_t i, std::size_t step) {
    is_written_[i] = true;
    const auto of = std::find_if(long_.begin(), long_.end(),
                                 [&](const Result* r) { return r->name == lines_[i].name; });
    steps_[step].equations.push_back(
        {{Formula::ofSymbol(lines_[i].name), lines_[i].value},
         {},
         of == long_.end() ? std::nullopt : std::optional<Node>((*of)->node)});
  }

  /// Of T all lines, of c those of accelerations: what goes from link to link outward.
  void writeOutward(const std::vector<std::size_t>& of_step, std::size_t step) {
    const bool is_kinetic = steps_[step].name.find("kinetic") == 0;
    if (!is_kinetic && steps_[step].quantity != "c") return;
    if (!e_.quasi.empty() || e_.hasFollowers()) return;  // rates are not counted as links are
    std::vector<std::size_t> all;
    for (const std::size_t r : of_step)
      if (const auto at = line_of_.find(program_.outputs[r]); at != line_of_.end())
        addReads(at->second, &all);
    std::map<int, std::vector<std::size_t>> by_link;
    for (const std::size_t i : needed(all)) {
      const auto& d = dimension_of_[static_cast<std::size_t>(lines_[i].slot)];
      if (is_kinetic || (d && (*d == kAcceleration || *d == kTurningFaster)))
        by_link[outmost_[i]].push_back(i);
    }
    for (const auto& [link, wanted] : by_link) writeGroup(needed(wanted), link, step);
  }

  void writeGroup(const std::vector<std::size_t>& group, int link, std::size_t step) {
    if (group.empty()) return;
    LineGroup heading;
    if (link >= 0 && static_cast<std::size_t>(link) < e_.links.size())
      heading.of = e_.links[static_cast<std::size_t>(link)];
    for (const std::size_t i : group) {
      const auto& d = dimension_of_[static_cast<std::size_t>(lines_[i].slot)];
      const std::string noun = d ? nounOf(*d, steps_[step]) : std::string(),
                        unit = d ? unitIn(*d, noun) : std::string();
      auto kind = std::find_if(heading.kinds.begin(), heading.kinds.end(),
                               [&](const auto& k) { return k.noun == noun && k.unit == unit; });
      if (kind == heading.kinds.end())
        kind = heading.kinds.insert(heading.kinds.end(), {noun, {}, unit});
      kind->names.push_back(lines_[i].name);
    }
    for (const std::size_t i : group) {
      writeLine(i, step);
      if (i == group.front()) steps_[step].equations.back().heading = heading;
    }
  }

  Equations& e_;
  std::vector<Step>& steps_;
  std::vector<const Result*> long_;
  Program program_;
  std::vector<Statement> lines_;
  std::vector<std::optional<Dimension>> dimension_of_;
  std::map<int, std::size_t> line_of_;  ///< by slot
  std::vector<int> outmost_;
  std::vector<char> is_written_;
};

constexpr const char* kLinesSentence =
    " Lines that are too long for one formula have names, and stand with the link that needs them "
    "first.";
constexpr const char* kCompositeSentence =
    " Of all that joint k carries, mck is the mass, sck the first moments of mass and Ick the "
    "moments of inertia, about the origin of link k's joint frame, in its axes.";

/// What names mean, where the first of their kind stands.
void explainNames(std::vector<Step>* steps) {
  bool has_lines = false, has_composites = false;
  for (Step& step : *steps)
    for (const StepEquation& line : step.equations) {
      if (line.isLine() && !std::exchange(has_lines, true)) step.sentence += kLinesSentence;
      if (line.isLine() && dimensionOfName(line.left.symbol) && line.left.symbol[1] == 'c' &&
          !std::exchange(has_composites, true))
        step.sentence += kCompositeSentence;
    }
}

}  // namespace

void nameCompositeBodies(const scene::Mechanism& mechanism, const Options& options, Equations& e) {
  BodyTree tree(mechanism, options, &e.graph);  // finds the nodes that it made before
  const auto name = [&](const Value& value, const std::string& word) {
    const auto& all = mechanism.parameters;
    if (std::none_of(all.begin(), all.end(), [&](const auto& p) { return p.name == word; }))
      e.graph.setName(value.node, word);
  };
  std::vector<MassMoments> composite;
  for (const Body& body : tree.bodies()) composite.push_back(body.moments);
  for (int i = tree.size() - 1; i >= 0; --i) {
    const auto k = static_cast<std::size_t>(i);
    const std::string c = "c" + std::to_string(i + 1);
    const MassMoments& b = composite[k];
    for (int x = 0; x < 3; ++x) {
      const std::string letter(1, "xyz"[x]);
      name(b.first[static_cast<std::size_t>(x)], "s" + c + letter);
      for (int y = x; y < 3; ++y) name(b.second(x, y), "I" + c + letter + "xyz"[y]);
    }
    name(b.mass, "m" + c);
    const Body& body = tree.bodies()[k];
    if (body.parent < 0) continue;
    composite[static_cast<std::size_t>(body.parent)] =
        composite[static_cast<std::size_t>(body.parent)] +
        movedBack(body.before, movedBack(jointSteps(&e.graph, body.joint), b));
  }
}

std::vector<int> linksOfRates(const scene::Mechanism& mechanism, const Options& options,
                              Equations& e) {
  const BodyTree tree(mechanism, options, &e.graph);
  std::vector<int> links(static_cast<std::size_t>(e.dof()), -1);
  for (int i = 0; i < tree.size(); ++i) {
    const Joint& joint = tree.bodies()[static_cast<std::size_t>(i)].joint;
    for (int k = 0; k < joint.rates() && !joint.follows; ++k)
      links[static_cast<std::size_t>(joint.rate + k)] = i;
  }
  return links;
}

void addLines(Equations& e, const scene::Mechanism& mechanism, const std::vector<Result>& results,
              std::vector<Step>* steps) {
  LinesOfSteps lines(e, mechanism, results, steps);
  for (std::size_t step = 0; step < steps->size(); ++step) {
    lines.write(step);
    for (const Result& r : results) {
      if (r.step != step) continue;
      if (!r.closed)
        lines.writeResult(&r, step);
      else if (isZero(*r.closed))
        (*steps)[step].zeros.push_back(r.name);
      else
        (*steps)[step].equations.push_back({{Formula::ofSymbol(r.name), *r.closed}, {}, r.node});
    }
  }
  explainNames(steps);
}

}  // namespace dynwitness::symbolic
