// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/dimensions.hpp"

#include <array>
#include <set>
#include <utility>

#include "scene/units.hpp"

namespace dynwitness::symbolic {
namespace {

using scene::Expression;

// ---- parameters ---------------------------------------------------------------------------------

/// An expression of the scene, and what its place is counted in.
struct Place {
  Expression expression;
  ParameterUnit unit;
};

ParameterUnit unit(Dimension d) {
  return {d, unitOf(d)};
}

class Places {
 public:
  explicit Places(const scene::Mechanism& m) {
    if (m.has_gravity) addAll(m.gravity, unit({0, 1, -2}));
    for (const scene::Link& link : m.links) {
      addJoint(link.joint);
      addInertia(link.inertia);
    }
    for (const scene::Wrench& w : m.wrenches) {
      addAll(w.force, unit(kForce));
      addAll(w.moment, unit(kMoment));
      addAll(w.at, unit(kLength));
    }
    for (const scene::Closure& c : m.closures) {
      for (const scene::Attachment* at : {&c.a, &c.b}) addAttachment(*at);
      add(c.length, unit(kLength));
    }
    for (const scene::Spring& s : m.springs) {
      for (const scene::Attachment* at : {&s.a, &s.b}) addAttachment(*at);
      add(s.stiffness, {kForce - kLength, "N/m"});
      add(s.rest, unit(kLength));
      add(s.damping, {kForce - kVelocity, "N s/m"});
    }
  }
  std::vector<Place> all;

 private:
  void add(const Expression& e, const ParameterUnit& u) {
    if (!e.parameters().empty()) all.push_back({e, u});
  }
  void addAll(const scene::Vector& v, const ParameterUnit& u) {
    for (const Expression& e : v) add(e, u);
  }
  void addAttachment(const scene::Attachment& at) {
    addAll(at.xyz, unit(kLength));
    addAll(at.rpy, kAngle);
  }
  void addInertia(const scene::MassProperties& inertia) {
    add(inertia.mass, unit(kMass));
    addAll(inertia.com, unit(kLength));
    addAll(inertia.rpy, kAngle);
    for (const Expression* e :
         {&inertia.xx, &inertia.yy, &inertia.zz, &inertia.xy, &inertia.xz, &inertia.yz})
      add(*e, unit(kInertia));
  }
  void addJoint(const scene::Joint& joint) {
    const scene::Placement& p = joint.placement;
    addAll(p.xyz, unit(kLength));
    addAll(p.rpy, kAngle);
    for (const Expression* e : {&p.a, &p.d}) add(*e, unit(kLength));
    for (const Expression* e : {&p.alpha, &p.theta}) add(*e, kAngle);
    add(joint.pitch, {kLength, "m/rad"});
    add(joint.rotor_inertia, unit(kInertia));
    for (const scene::Rotor& rotor : joint.rotors) add(rotor.inertia, unit(kInertia));
    if (scene::degreesOfFreedom(joint.kind) != 1) return;
    const bool slides = scene::slides(joint.kind, 0);
    add(joint.gear_ratio, slides ? ParameterUnit{Dimension{} - kLength, "rad/m"} : unit({}));
    add(joint.friction.viscous, slides ? ParameterUnit{kForce - kVelocity, "N s/m"}
                                       : ParameterUnit{kMoment - kTurning, "N m s/rad"});
    for (const Expression* e : {&joint.friction.positive, &joint.friction.negative})
      add(*e, unit(slides ? kForce : kMoment));
    add(joint.stiffness,
        slides ? ParameterUnit{kForce - kLength, "N/m"} : ParameterUnit{kMoment, "N m/rad"});
    add(joint.rest, slides ? unit(kLength) : kAngle);
    if (joint.mimic) add(joint.mimic->offset, slides ? unit(kLength) : kAngle);
  }

  const ParameterUnit kAngle{{}, "rad"};
};

/// Goes through places until nothing new follows.
class ParameterSolver {
 public:
  ParameterSolver(const scene::Mechanism& m) {
    std::vector<Place> places = Places(m).all;
    for (std::size_t before = 1, after = 0; before != after;) {
      before = known_.size() + disputed_.size();
      for (const Place& place : places) solve(place.expression, place.unit);
      for (const scene::Parameter& p : m.parameters) {
        const auto at = known_.find(p.name);
        if (at != known_.end())
          solve(p.value, at->second);
        else if (const Guess g = of(p.value); g.what == Guess::kKnown)
          learn(p.name, unit(g.dimension));
      }
      after = known_.size() + disputed_.size();
    }
    for (const std::string& name : disputed_) known_.erase(name);
  }
  std::map<std::string, ParameterUnit> take() { return std::move(known_); }

 private:
  struct Guess {
    enum { kBare, kKnown, kUnknown } what;  ///< kBare: a number, which may be of anything
    Dimension dimension = {};
  };

  Guess of(const Expression& e) const {
    switch (e.kind()) {
      case Expression::Kind::kParameter: {
        const auto at = known_.find(e.parameter());
        if (at == known_.end()) return {Guess::kUnknown};
        return {Guess::kKnown, at->second.dimension};
      }
      case Expression::Kind::kNegate:
        return of(e.left());
      case Expression::Kind::kAdd:
      case Expression::Kind::kSubtract: {
        const Guess a = of(e.left());
        return a.what == Guess::kKnown ? a : of(e.right());
      }
      case Expression::Kind::kMultiply:
      case Expression::Kind::kDivide: {
        const Guess a = of(e.left()), b = of(e.right());
        if (a.what == Guess::kUnknown || b.what == Guess::kUnknown) return {Guess::kUnknown};
        if (a.what == Guess::kBare && b.what == Guess::kBare) return a;
        const bool divides = e.kind() == Expression::Kind::kDivide;
        return {Guess::kKnown, divides ? a.dimension - b.dimension : a.dimension + b.dimension};
      }
      case Expression::Kind::kPower: {
        const Guess a = of(e.left());
        const int n = e.exponent();
        return {a.what, {n * a.dimension.kg, n * a.dimension.m, n * a.dimension.s}};
      }
      default:
        return {Guess::kBare};
    }
  }

  void learn(const std::string& name, const ParameterUnit& u) {
    const auto [at, is_new] = known_.emplace(name, u);
    if (!is_new && at->second.dimension != u.dimension) disputed_.insert(name);
  }

  void solve(const Expression& e, const ParameterUnit& target) {
    switch (e.kind()) {
      case Expression::Kind::kParameter:
        learn(e.parameter(), target);
        break;
      case Expression::Kind::kNegate:
        solve(e.left(), target);
        break;
      case Expression::Kind::kAdd:
      case Expression::Kind::kSubtract:
        solve(e.left(), target);
        solve(e.right(), target);
        break;
      case Expression::Kind::kMultiply:
      case Expression::Kind::kDivide: {
        const Guess a = of(e.left()), b = of(e.right());
        const bool divides = e.kind() == Expression::Kind::kDivide;
        if (a.what != Guess::kUnknown)
          solve(e.right(), changed(target, divides ? a.dimension - target.dimension
                                                   : target.dimension - a.dimension));
        if (b.what != Guess::kUnknown)
          solve(e.left(), changed(target, divides ? target.dimension + b.dimension
                                                  : target.dimension - b.dimension));
        break;
      }
      case Expression::Kind::kPower: {
        const int n = e.exponent();
        const Dimension d = target.dimension;
        if (n != 0 && d.kg % n == 0 && d.m % n == 0 && d.s % n == 0)
          solve(e.left(), changed(target, {d.kg / n, d.m / n, d.s / n}));
        break;
      }
      default:
        break;
    }
  }
  /// A place keeps its own word as long as its dimension is the same.
  static ParameterUnit changed(const ParameterUnit& target, Dimension d) {
    return d == target.dimension ? target : unit(d);
  }

  std::map<std::string, ParameterUnit> known_;
  std::set<std::string> disputed_;
};

// ---- programs -----------------------------------------------------------------------------------

Dimension dimensionOf(const Program::Load& load, const Equations& e,
                      const std::vector<scene::SlotKind>& slots) {
  const auto k = static_cast<std::size_t>(load.joint);
  switch (load.input) {
    case Input::kPosition:
      return slots[k] == scene::SlotKind::kLength ? kLength : Dimension{};
    case Input::kVelocity:
      return e.revolute[k] ? kTurning : kVelocity;
    case Input::kAcceleration:
      return (e.revolute[k] ? kTurning : kVelocity) + kTurning;
    case Input::kForce:
      return e.revolute[k] ? kMoment : kForce;
    default:
      return {};
  }
}

class ProgramSolver {
 public:
  ProgramSolver(const Program& program, std::size_t slots)
      : constants_(static_cast<int>(program.constants.size())), known_(slots), disputed_(slots) {}

  void learn(int slot, Dimension d) {
    if (slot < constants_) return;
    auto& at = known_[static_cast<std::size_t>(slot)];
    if (!at) {
      at = d;
      is_changed_ = true;
    } else if (*at != d) {
      disputed_[static_cast<std::size_t>(slot)] = 1;
    }
  }
  void visit(const Program::Instruction& i) {
    const auto& r = known_[static_cast<std::size_t>(i.result)];
    const auto& a = known_[static_cast<std::size_t>(i.a)];
    if (i.code == Program::Code::kNegate || i.code == Program::Code::kInverse) {
      const bool inverse = i.code == Program::Code::kInverse;
      if (a) learn(i.result, inverse ? Dimension{} - *a : *a);
      if (r) learn(i.a, inverse ? Dimension{} - *r : *r);
      return;
    }
    const auto& b = known_[static_cast<std::size_t>(i.b)];
    if (i.code == Program::Code::kMultiply) {
      if (a && b) learn(i.result, *a + *b);
      if (r && a) learn(i.b, *r - *a);
      if (r && b) learn(i.a, *r - *b);
      return;
    }
    for (const auto* one : {&r, &a, &b})
      if (*one) {
        const Dimension d = **one;
        for (const int slot : {i.result, i.a, i.b}) learn(slot, d);
        return;
      }
  }
  bool takeChange() { return std::exchange(is_changed_, false); }
  std::vector<std::optional<Dimension>> take() {
    for (std::size_t k = 0; k < known_.size(); ++k)
      if (disputed_[k]) known_[k].reset();
    return std::move(known_);
  }

 private:
  int constants_;
  std::vector<std::optional<Dimension>> known_;
  std::vector<char> disputed_;
  bool is_changed_ = false;
};

}  // namespace

std::string unitOf(Dimension d) {
  struct Word {
    Dimension d;
    const char* text;
  };
  static const std::array<Word, 11> kWords = {{{{}, "1"},
                                               {kMoment, "N m"},
                                               {kForce, "N"},
                                               {kForce - kLength, "N/m"},
                                               {kForce - kVelocity, "N s/m"},
                                               {kTurning, "1/s"},
                                               {kTurning + kTurning, "1/s^2"},
                                               {kVelocity, "m/s"},
                                               {kVelocity + kTurning, "m/s^2"},
                                               {kMass + kVelocity, "kg m/s"},
                                               {kInertia + kTurning, "kg m^2/s"}}};
  for (const Word& word : kWords)
    if (word.d == d) return word.text;
  std::string above, below;
  for (const auto& [letter, n] :
       {std::pair<const char*, int>{"kg", d.kg}, {"m", d.m}, {"s", d.s}}) {
    std::string& text = n > 0 ? above : below;
    const int size = n > 0 ? n : -n;
    if (n != 0)
      text += (text.empty() ? "" : " ") + std::string(letter) +
              (size == 1 ? "" : "^" + std::to_string(size));
  }
  std::string text = above.empty() ? "1" : above;
  if (!below.empty())
    text += below.find(' ') == std::string::npos ? "/" + below : "/(" + below + ")";
  return text;
}

std::map<std::string, ParameterUnit> parameterUnits(const scene::Mechanism& mechanism) {
  return ParameterSolver(mechanism).take();
}

std::vector<std::optional<Dimension>> slotDimensions(
    const Program& program, const Equations& e, const scene::Mechanism& mechanism,
    const std::vector<Dimension>& outputs,
    const std::function<std::optional<Dimension>(const std::string&)>& of_names) {
  ProgramSolver solver(program, static_cast<std::size_t>(program.slots));
  const auto parameters = parameterUnits(mechanism);
  for (std::size_t k = 0; k < program.atoms.size(); ++k) {
    const Atom& atom = program.atoms[k];
    const int slot = static_cast<int>(program.constants.size() + k);
    const auto at = parameters.find(atom.name);
    if (atom.kind != Atom::Kind::kNumber || atom.name == "pi")
      solver.learn(slot, {});
    else if (at != parameters.end())
      solver.learn(slot, at->second.dimension);
  }
  const std::vector<scene::SlotKind> slots = mechanism.slots();
  for (const Program::Load& load : program.loads)
    solver.learn(load.slot, dimensionOf(load, e, slots));
  for (std::size_t k = 0; k < outputs.size(); ++k) solver.learn(program.outputs[k], outputs[k]);
  for (std::size_t k = 0; k < program.slot_names.size(); ++k)
    if (const auto d = of_names(program.slot_names[k])) solver.learn(static_cast<int>(k), *d);
  while (solver.takeChange()) {
    for (const auto* part : {&program.prologue, &program.body})
      for (const Program::Instruction& i : *part) solver.visit(i);
    for (const auto* part : {&program.body, &program.prologue})
      for (auto i = part->rbegin(); i != part->rend(); ++i) solver.visit(*i);
  }
  return solver.take();
}

}  // namespace dynwitness::symbolic
