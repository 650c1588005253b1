// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/selection.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/nearest_name.hpp"

namespace dynwitness::symbolic {
namespace {

/// What an equation is asked for by: its left side, or the force of its joint.
std::string nameOf(const StepEquation& equation) {
  if (!equation.left_value) return equation.left.symbol;
  const Formula& right = equation.right;
  const Formula& force = right.kind == Formula::Kind::kSum ? right.operands.front() : right;
  return print(force, Style::kText);
}

/// M of M12 and of M10_2; empty: no index stands behind the name.
std::string familyOf(const std::string& name) {
  std::size_t letters = 0;
  while (letters < name.size() && std::isalpha(static_cast<unsigned char>(name[letters])))
    ++letters;
  const bool is_indexed = letters > 0 && letters < name.size() &&
                          name.find_first_not_of("0123456789_", letters) == std::string::npos &&
                          name[letters] != '_';
  return is_indexed ? name.substr(0, letters) : std::string();
}

void addSymbols(const Formula& f, std::set<std::string>* names) {
  if (f.kind == Formula::Kind::kSymbol) names->insert(f.symbol);
  for (const Formula& operand : f.operands) addSymbols(operand, names);
}

/// Headings say what is left of their groups, before the first line that is left.
void mendHeadings(const Step& whole, std::vector<StepEquation>* kept) {
  const auto isKept = [kept](const std::string& name) {
    return std::any_of(kept->begin(), kept->end(),
                       [&](const StepEquation& e) { return e.left.symbol == name; });
  };
  std::optional<LineGroup> heading;
  std::map<std::string, LineGroup> before;  // the line of this name
  for (const StepEquation& e : whole.equations) {
    if (e.heading) heading = e.heading;
    if (!heading || e.left_value || !isKept(e.left.symbol)) continue;
    for (auto kind = heading->kinds.begin(); kind != heading->kinds.end();) {
      auto& names = kind->names;
      names.erase(std::remove_if(names.begin(), names.end(),
                                 [&](const std::string& name) { return !isKept(name); }),
                  names.end());
      kind = names.empty() ? heading->kinds.erase(kind) : kind + 1;
    }
    before[e.left.symbol] = *heading;
    heading.reset();
  }
  for (StepEquation& e : *kept) {
    e.heading.reset();
    if (const auto at = before.find(e.left.symbol); at != before.end() && !e.left_value)
      e.heading = at->second;
  }
}

/// Keeps what is wanted, and what its letters stand for: that is written before it.
template <typename Wanted>
Derivation keep(Derivation derivation, const Wanted& wanted) {
  std::set<std::string> needed;
  std::vector<Step> kept;
  for (std::size_t k = derivation.steps.size(); k-- > 0;) {
    Step& step = derivation.steps[k];
    std::vector<StepEquation> equations;
    for (std::size_t e = step.equations.size(); e-- > 0;) {
      const StepEquation& equation = step.equations[e];
      const std::string name = nameOf(equation);
      if (!wanted(step, name) && needed.count(name) == 0) continue;
      addSymbols(equation.left, &needed);
      addSymbols(equation.right, &needed);
      equations.push_back(equation);
    }
    std::reverse(equations.begin(), equations.end());
    mendHeadings(step, &equations);
    step.equations = std::move(equations);
    step.zeros.erase(std::remove_if(step.zeros.begin(), step.zeros.end(),
                                    [&](const std::string& name) { return !wanted(step, name); }),
                     step.zeros.end());
    if (!step.equations.empty() || !step.zeros.empty()) kept.push_back(step);
  }
  std::reverse(kept.begin(), kept.end());
  derivation.steps = std::move(kept);
  placeParameters(&derivation);
  return derivation;
}

/// All that can be asked for: results and families of them, without the lines of programs.
std::vector<std::string> namesIn(const Derivation& derivation) {
  std::vector<std::string> names, families;
  const auto add = [&](const std::string& name) {
    names.push_back(name);
    const std::string family = familyOf(name);
    if (!family.empty() && std::find(families.begin(), families.end(), family) == families.end())
      families.push_back(family);
  };
  for (const Step& step : derivation.steps) {
    for (const StepEquation& e : step.equations)
      if (e.left_value || e.right_value) add(nameOf(e));
    for (const std::string& name : step.zeros) add(name);
  }
  families.insert(families.end(), names.begin(), names.end());
  return families;
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 60;
  const std::size_t shown = std::min(names.size(), kMost);
  return fmt::format("{}{}",
                     fmt::join(names.begin(), names.begin() + static_cast<long>(shown), ", "),
                     shown < names.size() ? ", ..." : "");
}

// ---- other letters ------------------------------------------------------------------------------

void rename(const Derivation& names, Formula* f) {
  if (f->kind == Formula::Kind::kInput) f->symbol = names.input(f->input, f->joint).symbol;
  for (Formula& operand : f->operands) rename(names, &operand);
}

/// Of each rate the position slot that it is the derivative of; -1: of none.
std::vector<int> slotsOfRates(const scene::Mechanism& mechanism) {
  std::vector<int> slots;
  int slot = 0;
  for (const scene::Link& link : mechanism.links) {
    const bool derivatives = scene::ratesArePositionDerivatives(link.joint.kind);
    for (int k = 0; k < link.joint.ownRates(); ++k) slots.push_back(derivatives ? slot + k : -1);
    slot += static_cast<int>(scene::positionSlots(link.joint.kind).size());
  }
  return slots;
}

/// The positions that an angle is the sum of, each as often as it stands there, those that are
/// taken off last; empty: it is none, or one position alone.
std::optional<std::vector<int>> summands(const Formula& angle) {
  std::vector<int> plus, minus;
  const std::vector<Formula> one{angle};
  for (const Formula& given : angle.kind == Formula::Kind::kSum ? angle.operands : one) {
    const bool negative = given.kind == Formula::Kind::kNegate;
    const Formula* term = negative ? &given.operands.front() : &given;
    Rational times = 1;
    if (term->kind == Formula::Kind::kProduct && term->operands.size() == 2 &&
        term->operands[0].kind == Formula::Kind::kNumber) {
      times = term->operands[0].number;
      term = &term->operands[1];
    }
    if (term->kind != Formula::Kind::kInput || term->input != Input::kPosition || times > 9 ||
        denominator(times) != 1)
      return std::nullopt;
    for (Rational k = 0; k < times; k += 1) (negative ? minus : plus).push_back(term->joint);
  }
  for (const int joint : minus) plus.push_back(-1 - joint);
  return plus.size() < 2 ? std::nullopt : std::optional(plus);
}

/// 12 of q1 + q2, 2m4 of q2 - q4, 9_10 of q9 + q10.
std::string digitsOf(const std::vector<int>& joints) {
  const bool wide =
      std::any_of(joints.begin(), joints.end(), [](int joint) { return joint > 8 || joint < -9; });
  std::string text;
  for (const int joint : joints) {
    if (!text.empty() && (joint < 0 || wide)) text += joint < 0 ? "m" : "_";
    text += std::to_string(joint < 0 ? -joint : joint + 1);
  }
  return text;
}

/// Letters that mean something else, in both spellings in which two could be taken for one.
class Taken {
 public:
  explicit Taken(const Derivation& d) {
    for (const scene::Parameter& p : d.mechanism.parameters) add(p.name, "a parameter");
    for (const Step& step : d.steps) {
      for (const StepEquation& e : step.equations)
        if (!e.left_value) add(e.left.symbol, "a result");
      for (const std::string& name : step.zeros) add(name, "a result");
    }
    for (const char* word : {"pi", "cos", "sin", "sign", "M", "T", "V"})
      add(word, "a word of the formulas");
    for (int k = 0; k < d.mechanism.positions(); ++k)
      add("q" + std::to_string(k + 1), "a position by its number");
    for (int k = 0; k < d.equations->dof(); ++k)
      for (const Input input : {Input::kVelocity, Input::kAcceleration, Input::kForce})
        add(print(Formula::ofInput(input, k), Style::kText), "a rate or force");
  }
  void add(const std::string& name, const std::string& what) {
    for (const Style style : {Style::kText, Style::kLatex}) names_[printName(name, style)] = what;
  }
  /// What has this name; empty: nothing.
  std::string by(const std::string& name) const {
    for (const Style style : {Style::kText, Style::kLatex})
      if (const auto at = names_.find(printName(name, style)); at != names_.end())
        return at->second;
    return {};
  }

 private:
  std::map<std::string, std::string> names_;
};

/// Every slot by its number, or its new name.
std::vector<std::string> positionNames(
    const Derivation& d, const std::vector<std::pair<std::string, std::string>>& names) {
  std::vector<std::string> slots, allowed;
  const std::vector<scene::SlotKind> kinds = d.mechanism.slots();
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    slots.push_back("q" + std::to_string(k + 1));
    if (kinds[k] != scene::SlotKind::kQuaternion) allowed.push_back(slots.back());
  }
  std::vector<std::string> out = slots;
  for (const auto& [from, to] : names) {
    if (std::find(allowed.begin(), allowed.end(), from) == allowed.end())
      throw scene::InputError(
          {}, fmt::format("--rename: no position '{}'{}, allowed: {}", from,
                          scene::didYouMean(from, allowed), fmt::join(allowed, ", ")));
    std::string& slot =
        out[static_cast<std::size_t>(std::find(slots.begin(), slots.end(), from) - slots.begin())];
    if (slot != from)
      throw scene::InputError({},
                              fmt::format("--rename: {} has two names, {} and {}", from, slot, to));
    if (!scene::isParameterName(to) || to.front() == '_')
      throw scene::InputError(
          {},
          fmt::format("--rename: read '{}' for {}, allowed: letters, digits and _, such as theta "
                      "or x_1, a letter first",
                      to, from));
    slot = to;
  }
  return out;
}

/// Writes cosines and sines of sums by their shorthand, and remembers which.
class Shorthand {
 public:
  explicit Shorthand(const Derivation& d) : taken_(d) {}

  void apply(Formula* f) {
    for (Formula& operand : f->operands) apply(&operand);
    if (f->kind != Formula::Kind::kCos && f->kind != Formula::Kind::kSin) return;
    const auto joints = summands(f->operands.front());
    if (!joints) return;
    const std::string name = (f->kind == Formula::Kind::kCos ? "c" : "s") + digitsOf(*joints);
    if (!taken_.by(name).empty()) return;
    legend_.emplace(std::pair(*joints, name), *f);
    *f = Formula::ofSymbol(name);
  }
  std::vector<StepEquation> legend() const {
    std::vector<StepEquation> out;
    for (const auto& [key, angle] : legend_)
      out.push_back({{Formula::ofSymbol(key.second), angle}, {}, {}});
    return out;
  }

 private:
  Taken taken_;
  std::map<std::pair<std::vector<int>, std::string>, Formula> legend_;
};

}  // namespace

Derivation only(const Derivation& derivation, const std::vector<std::string>& names) {
  const std::vector<std::string> allowed = namesIn(derivation);
  for (const std::string& name : names)
    if (std::find(allowed.begin(), allowed.end(), name) == allowed.end())
      throw scene::InputError({}, fmt::format("--only: read '{}'{}, allowed: {}", name,
                                              scene::didYouMean(name, allowed), listed(allowed)));
  return keep(derivation, [&](const Step&, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end() ||
           std::find(names.begin(), names.end(), familyOf(name)) != names.end();
  });
}

Derivation onlyQuantity(const Derivation& derivation, const std::string& quantity) {
  return keep(derivation,
              [&](const Step& step, const std::string&) { return step.quantity == quantity; });
}

Derivation renamed(const Derivation& derivation,
                   const std::vector<std::pair<std::string, std::string>>& names) {
  Derivation out = derivation;
  out.positions = positionNames(derivation, names);
  for (const int slot : slotsOfRates(derivation.mechanism))
    out.rates.push_back(slot < 0 ? std::string() : out.positions[static_cast<std::size_t>(slot)]);
  Taken taken(derivation);
  std::string sentence;
  for (std::size_t k = 0; k < out.positions.size(); ++k) {
    const std::string number = "q" + std::to_string(k + 1);
    std::string& name = out.positions[k];
    const std::string by = name == number ? std::string() : taken.by(name);
    if (!by.empty())
      throw scene::InputError(
          {}, fmt::format("--rename: {} cannot be called {}: that is {}", number, name, by));
    if (name != number) taken.add(name, number + " here");
    taken.add(name + "_dot", "a rate");
    taken.add(name + "_ddot", "an acceleration");
    if (name != number)
      sentence += fmt::format("{}{} is {}", sentence.empty() ? "" : ", ", name, number);
  }
  // a position that keeps its number is spelled by it, and its rates as ever
  const auto keepNumbers = [](std::vector<std::string>* list,
                              const std::vector<std::string>& whole) {
    for (std::string& name : *list)
      for (std::size_t k = 0; k < whole.size(); ++k)
        if (name == "q" + std::to_string(k + 1) && whole[k] == name) name.clear();
  };
  const std::vector<std::string> whole = out.positions;
  keepNumbers(&out.rates, whole);
  keepNumbers(&out.positions, whole);
  for (Step& step : out.steps)
    for (StepEquation& e : step.equations) {
      rename(out, &e.left);
      rename(out, &e.right);
    }
  if (!out.steps.empty()) out.steps.front().sentence += " Here " + sentence + ".";
  return out;
}

Derivation withShorthand(Derivation derivation) {
  Shorthand shorthand(derivation);
  for (Step& step : derivation.steps)
    for (StepEquation& e : step.equations) {
      shorthand.apply(&e.left);
      shorthand.apply(&e.right);
    }
  const std::vector<StepEquation> legend = shorthand.legend();
  if (legend.empty()) return derivation;
  derivation.steps.insert(
      derivation.steps.begin(),
      {"shorthand", "Cosines and sines of sums of positions have short names.", legend, "", true});
  return derivation;
}

}  // namespace dynwitness::symbolic
