// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/closed_form.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace dynwitness::symbolic {

namespace {

GiNaC::numeric toGinac(const Rational& r) {
  const scene::Integer n = numerator(r), d = denominator(r);
  return GiNaC::numeric(n.str().c_str()) / GiNaC::numeric(d.str().c_str());
}

Rational fromGinac(const GiNaC::numeric& n) {
  std::ostringstream text;
  text << n;
  return Rational(text.str());
}

}  // namespace

// ---- from the graph to GiNaC --------------------------------------------------------------------

ClosedAlgebra::ClosedAlgebra(const Equations& equations) : equations_(equations) {
  // symbols in the order in which they are to be shown: numbers, rates, angles
  const Graph& graph = equations.graph;
  const auto bind = [this](Input input, int joint, int symbol) {
    const GiNaC::symbol s;
    inputs_.emplace(std::pair(input, joint), s);
    symbol_of_.emplace(s, symbol);
  };
  std::vector<int> numbers;  // m l^2 reads better than l^2 m: masses lead
  for (bool masses : {true, false}) {
    for (int i = 0; i < graph.size(); ++i) {
      const Node n{i};
      if (graph.op(n) != Op::kAtom && graph.op(n) != Op::kInverse) continue;
      const bool is_mass = graph.op(n) == Op::kAtom && graph.atom(n).name.front() == 'm';
      if (is_mass == masses) numbers.push_back(i);
    }
  }
  std::map<std::string, int> cosines;  // of fixed angles, by the name of their sine
  for (int i : numbers) {
    const Node n{i};
    const GiNaC::symbol s;
    Formula shown;
    if (graph.op(n) == Op::kAtom) {
      shown = Formula::ofAtom(graph.atom(n));
    } else {
      shown = Formula::power(formula(expression(graph.left(n))), -1);
    }
    symbol_of_.emplace(s, addSymbol({Role::kNumber, shown, {}}));
    number_symbols_[i] = symbol_of_.at(s);
    expressions_[i] = s;
    if (graph.op(n) == Op::kAtom) {
      const std::string& name = graph.atom(n).name;
      const auto cosine = cosines.find(name);
      if (name.compare(0, 3, "cos") == 0) cosines["sin" + name.substr(3)] = symbol_of_.at(s);
      if (cosine != cosines.end()) fixed_angles_[cosine->second] = symbol_of_.at(s);
    }
  }
  for (int k = 0; k < equations.dof(); ++k)
    bind(Input::kPosition, k,
         addSymbol({Role::kNumber, Formula::ofInput(Input::kPosition, k), {}}));
  for (Input input : {Input::kAcceleration, Input::kVelocity})
    for (int k = 0; k < equations.dof(); ++k)
      bind(input, k, addSymbol({Role::kRate, Formula::ofInput(input, k), {}}));
  for (int k = 0; k < equations.dof(); ++k) {
    Angle angle(equations.dof(), 0);
    angle[k] = 1;
    const auto [c, s] = trigOf(angle);
    bind(Input::kCos, k, c);
    bind(Input::kSin, k, s);
  }
  for (int k = 0; k < equations.dof(); ++k)
    bind(Input::kDirection, k,
         addSymbol({Role::kRate, Formula::ofInput(Input::kDirection, k), {}}));
}

int ClosedAlgebra::addSymbol(const Symbol& symbol) {
  symbols_.push_back(symbol);
  return static_cast<int>(symbols_.size()) - 1;
}

std::pair<int, int> ClosedAlgebra::trigOf(const Angle& angle) {
  const auto [it, is_new] = trig_.emplace(angle, std::pair(0, 0));
  if (!is_new) return it->second;
  std::vector<Formula> terms;
  for (std::size_t k = 0; k < angle.size(); ++k) {
    if (angle[k] == 0) continue;
    const Rational size = angle[k] < 0 ? -angle[k] : angle[k];
    const Formula term = Formula::product(
        {Formula::ofNumber(size), Formula::ofInput(Input::kPosition, static_cast<int>(k))});
    terms.push_back(angle[k] < 0 ? Formula::negate(term) : term);
  }
  const Formula sum = Formula::sum(terms);
  it->second.first = addSymbol({Role::kCos, Formula::function(Formula::Kind::kCos, sum), angle});
  it->second.second = addSymbol({Role::kSin, Formula::function(Formula::Kind::kSin, sum), angle});
  return it->second;
}

const GiNaC::symbol& ClosedAlgebra::input(Input input, int joint) {
  return inputs_.at({input, joint});
}

GiNaC::ex ClosedAlgebra::expression(Node node) {
  const auto known = expressions_.find(node.index);
  if (known != expressions_.end()) return known->second;
  const Graph& graph = equations_.graph;
  const Node a = graph.left(node), b = graph.right(node);
  GiNaC::ex x;
  switch (graph.op(node)) {
    case Op::kConstant:
      x = toGinac(graph.value(node));
      break;
    case Op::kInput:
      x = input(graph.inputKind(node), graph.joint(node));
      break;
    case Op::kAdd:
      x = expression(a) + expression(b);
      break;
    case Op::kSubtract:
      x = expression(a) - expression(b);
      break;
    case Op::kMultiply:
      x = expression(a) * expression(b);
      break;
    case Op::kNegate:
      x = -expression(a);
      break;
    case Op::kTurn: {
      const int k = graph.joint(node);
      x = input(Input::kCos, k) * expression(a) + input(Input::kSin, k) * expression(b);
      break;
    }
    case Op::kAtom:
    case Op::kInverse:
      throw std::invalid_argument("ClosedAlgebra: expected a node older than the algebra");
  }
  return expressions_[node.index] = x.expand();
}

GiNaC::ex ClosedAlgebra::derivative(const GiNaC::ex& x, Variable variable) {
  const int k = variable.joint;
  if (variable.input != Input::kPosition) return x.diff(input(variable.input, k));
  const GiNaC::symbol &q = input(Input::kPosition, k), &c = input(Input::kCos, k),
                      &s = input(Input::kSin, k);
  return (x.diff(q) - s * x.diff(c) + c * x.diff(s)).expand();
}

GiNaC::ex ClosedAlgebra::rate(const GiNaC::ex& x) {
  GiNaC::ex total = 0;
  for (int k = 0; k < equations_.dof(); ++k)
    total += derivative(x, {Input::kPosition, k}) * input(Input::kVelocity, k) +
             derivative(x, {Input::kVelocity, k}) * input(Input::kAcceleration, k);
  return total.expand();
}

// ---- from GiNaC to polynomials with an order of our own -----------------------------------------

bool ClosedAlgebra::DisplayOrder::operator()(const Monomial& a, const Monomial& b) const {
  int degree_a = 0, degree_b = 0;
  for (const auto& factor : a) degree_a += factor.second;
  for (const auto& factor : b) degree_b += factor.second;
  if (degree_a != degree_b) return degree_a < degree_b;
  const std::size_t shared = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < shared; ++i) {
    if (a[i].first != b[i].first) return a[i].first < b[i].first;
    if (a[i].second != b[i].second) return a[i].second > b[i].second;
  }
  return a.size() < b.size();
}

ClosedAlgebra::Monomial ClosedAlgebra::product(const Monomial& a, const Monomial& b) {
  Monomial result;
  auto i = a.begin(), j = b.begin();
  while (i != a.end() || j != b.end()) {
    if (j == b.end() || (i != a.end() && i->first < j->first)) {
      result.push_back(*i++);
    } else if (i == a.end() || j->first < i->first) {
      result.push_back(*j++);
    } else {
      if (i->second + j->second != 0) result.emplace_back(i->first, i->second + j->second);
      ++i, ++j;
    }
  }
  return result;
}

ClosedAlgebra::Polynomial ClosedAlgebra::product(const Polynomial& a, const Polynomial& b) {
  Polynomial result;
  for (const auto& [m, r] : a)
    for (const auto& [n, s] : b) accumulate(product(m, n), r * s, &result);
  return result;
}

void ClosedAlgebra::accumulate(const Monomial& m, const Rational& r, Polynomial* total) {
  if (r.is_zero()) return;
  const auto [it, is_new] = total->try_emplace(m, r);
  if (is_new) return;
  it->second += r;
  if (it->second.is_zero()) total->erase(it);
}

void ClosedAlgebra::accumulate(const Polynomial& terms, Polynomial* total) {
  for (const auto& [m, r] : terms) accumulate(m, r, total);
}

ClosedAlgebra::Polynomial ClosedAlgebra::polynomial(const GiNaC::ex& x) {
  const auto addTerm = [this](const GiNaC::ex& term, Polynomial* to) {
    Rational coefficient = 1;
    Monomial monomial;
    const auto addFactor = [&](const GiNaC::ex& factor) {
      if (GiNaC::is_a<GiNaC::numeric>(factor)) {
        coefficient *= fromGinac(GiNaC::ex_to<GiNaC::numeric>(factor));
      } else if (GiNaC::is_a<GiNaC::power>(factor)) {
        const int exponent = GiNaC::ex_to<GiNaC::numeric>(factor.op(1)).to_int();
        monomial = product(monomial, {{symbol_of_.at(factor.op(0)), exponent}});
      } else {
        monomial = product(monomial, {{symbol_of_.at(factor), 1}});
      }
    };
    if (GiNaC::is_a<GiNaC::mul>(term))
      for (const GiNaC::ex& factor : term) addFactor(factor);
    else
      addFactor(term);
    if (coefficient != 0) (*to)[monomial] += coefficient;
  };
  Polynomial result;
  const GiNaC::ex expanded = x.expand();
  if (GiNaC::is_a<GiNaC::add>(expanded))
    for (const GiNaC::ex& term : expanded) addTerm(term, &result);
  else
    addTerm(expanded, &result);

  return onFixedCircles(std::move(result));
}

/** Every term with some factors x^e replaced by polynomials; one without such a factor goes over as
    it is, most do.
    @param replacement  of (symbol, exponent): a polynomial, or none to keep the factor */
template <typename Replacement>
ClosedAlgebra::Polynomial ClosedAlgebra::replaced(const Polynomial& p, Replacement replacement) {
  Polynomial result;
  for (const auto& [monomial, coefficient] : p) {
    Monomial kept;
    Polynomial terms{{{}, coefficient}};
    for (const auto& factor : monomial) {
      if (const std::optional<Polynomial> by = replacement(factor.first, factor.second))
        terms = product(terms, *by);
      else
        kept.push_back(factor);
    }
    for (const auto& [m, r] : terms) accumulate(product(m, kept), r, &result);
  }
  return result;
}

/// x^e with x^2 = 1 - y^2 as often as it goes; e >= 2.
ClosedAlgebra::Polynomial ClosedAlgebra::withoutSquares(int x, int exponent, int y) {
  const Polynomial one_minus_square = {{{}, 1}, {{{y, 2}}, -1}};
  Polynomial terms{{exponent % 2 == 1 ? Monomial{{x, 1}} : Monomial{}, 1}};
  for (int i = 0; i < exponent / 2; ++i) terms = product(terms, one_minus_square);
  return terms;
}

/// Fixed angles are on the circle too.
ClosedAlgebra::Polynomial ClosedAlgebra::onFixedCircles(Polynomial p) const {
  // most have no square of a cosine: they go over as they are, not circle by circle
  std::map<int, int> sine_of;
  for (const auto& [monomial, r] : p)
    for (const auto& [symbol, exponent] : monomial)
      if (exponent >= 2)
        if (const auto circle = fixed_angles_.find(symbol); circle != fixed_angles_.end())
          sine_of.insert(*circle);
  if (sine_of.empty()) return p;
  return replaced(p, [&](int symbol, int exponent) -> std::optional<Polynomial> {
    const auto sine = sine_of.find(symbol);
    if (sine == sine_of.end() || exponent < 2) return std::nullopt;
    return withoutSquares(symbol, exponent, sine->second);
  });
}

/// Replaces squares of the other function of each angle: c^2 = 1 - s^2 or s^2 = 1 - c^2.
ClosedAlgebra::Polynomial ClosedAlgebra::reduced(const Polynomial& p, Role power_kept) const {
  const auto goes = [&](int symbol, int exponent) {
    const Role role = symbols_[symbol].role;
    return exponent >= 2 && role != power_kept && (role == Role::kCos || role == Role::kSin);
  };
  if (std::none_of(p.begin(), p.end(), [&](const auto& term) {
        return std::any_of(term.first.begin(), term.first.end(),
                           [&](const auto& factor) { return goes(factor.first, factor.second); });
      }))
    return p;
  return replaced(p, [&](int symbol, int exponent) -> std::optional<Polynomial> {
    if (!goes(symbol, exponent)) return std::nullopt;
    const auto [c, s] = trig_.at(symbols_[symbol].angle);
    return withoutSquares(symbol, exponent, symbols_[symbol].role == Role::kCos ? s : c);
  });
}

/** With theta_j the sum of the angles of parallel joints up to j and theta_i the one before it,
    q_j = theta_j - theta_i:  c_j = cos theta_j cos theta_i + sin theta_j sin theta_i, and so on. */
ClosedAlgebra::Polynomial ClosedAlgebra::inSummedAngles(const Polynomial& p) {
  const int n = equations_.dof();
  std::vector<Angle> theta(n, Angle(n, 0));
  std::map<int, Polynomial> replacement;
  for (int j = 0; j < n; ++j) {
    const int i = equations_.parallel_inboard[j];
    if (i >= 0) theta[j] = theta[i];
    theta[j][j] += 1;
    if (i < 0) continue;
    Angle own(n, 0);
    own[j] = 1;
    const auto [c, s] = trigOf(own);
    const auto [c_j, s_j] = trigOf(theta[j]);
    const auto [c_i, s_i] = trigOf(theta[i]);
    replacement[c] = {{product(Monomial{{c_j, 1}}, {{c_i, 1}}), 1},
                      {product(Monomial{{s_j, 1}}, {{s_i, 1}}), 1}};
    replacement[s] = {{product(Monomial{{s_j, 1}}, {{c_i, 1}}), 1},
                      {product(Monomial{{c_j, 1}}, {{s_i, 1}}), -1}};
  }
  return replaced(p, [&](int symbol, int exponent) -> std::optional<Polynomial> {
    const auto by = replacement.find(symbol);
    if (by == replacement.end()) return std::nullopt;
    Polynomial terms{{{}, 1}};
    for (int e = 0; e < exponent; ++e) terms = product(terms, by->second);
    return terms;
  });
}

/// Products of cosines and sines as sums: cos a cos b = (cos(a + b) + cos(a - b)) / 2, and so on.
ClosedAlgebra::Polynomial ClosedAlgebra::inMultipleAngles(const Polynomial& p) {
  struct Wave {
    bool is_sine;
    Angle angle;
    bool operator<(const Wave& o) const {
      return std::tie(is_sine, angle) < std::tie(o.is_sine, o.angle);
    }
  };
  const auto add = [](std::map<Wave, Rational>* to, bool is_sine, Angle angle, Rational r) {
    const auto first = std::find_if(angle.begin(), angle.end(), [](int k) { return k != 0; });
    if (first == angle.end() && is_sine) return;  // sin 0
    if (first != angle.end() && *first < 0) {
      for (int& k : angle) k = -k;
      if (is_sine) r = -r;
    }
    (*to)[{is_sine, angle}] += r;
  };
  const int n = equations_.dof();
  Polynomial result;
  for (const auto& [monomial, coefficient] : p) {
    Monomial rest;
    std::map<Wave, Rational> waves{{{false, Angle(n, 0)}, coefficient}};
    for (const auto& [symbol, exponent] : monomial) {
      const Symbol& s = symbols_[symbol];
      if (s.role != Role::kCos && s.role != Role::kSin) {
        rest.emplace_back(symbol, exponent);
        continue;
      }
      for (int e = 0; e < exponent; ++e) {
        std::map<Wave, Rational> next;
        for (const auto& [wave, r] : waves) {
          Angle sum = wave.angle, difference = wave.angle;
          for (int k = 0; k < n; ++k) {
            sum[k] += s.angle[k];
            difference[k] -= s.angle[k];
          }
          const Rational half = r / 2;
          if (s.role == Role::kCos) {  // cos a cos b, sin a cos b
            add(&next, wave.is_sine, sum, half);
            add(&next, wave.is_sine, difference, half);
          } else {  // cos a sin b = (sin(a+b) - sin(a-b))/2, sin a sin b = (cos(a-b) - cos(a+b))/2
            add(&next, !wave.is_sine, sum, wave.is_sine ? Rational(-half) : half);
            add(&next, !wave.is_sine, difference, wave.is_sine ? half : Rational(-half));
          }
        }
        waves = std::move(next);
      }
    }
    Polynomial terms;
    for (const auto& [wave, r] : waves) {
      Monomial m = rest;
      if (std::any_of(wave.angle.begin(), wave.angle.end(), [](int k) { return k != 0; })) {
        const auto [c, s] = trigOf(wave.angle);
        m = product(m, {{wave.is_sine ? s : c, 1}});
      }
      terms[m] += r;
    }
    accumulate(terms, &result);
  }
  return result;
}

bool ClosedAlgebra::isZero(const GiNaC::ex& x) {
  return reduced(polynomial(x), Role::kSin).empty();
}

GiNaC::ex ClosedAlgebra::withoutCosineSquares(const GiNaC::ex& x) {
  GiNaC::ex out = x.expand();
  for (int k = 0; k < equations_.dof(); ++k) {
    const GiNaC::ex c = input(Input::kCos, k), s = input(Input::kSin, k), rest = 1 - s * s;
    GiNaC::ex sum = 0;
    for (int e = out.ldegree(c); e <= out.degree(c); ++e)
      sum += out.coeff(c, e) * pow(c, e % 2) * pow(rest, e / 2);
    out = sum.expand();
  }
  return out;
}

std::optional<Formula> ClosedAlgebra::quotient(const GiNaC::ex& dividend, const GiNaC::ex& divisor,
                                               std::size_t most_terms) {
  const GiNaC::ex whole = withoutCosineSquares(dividend), by = withoutCosineSquares(divisor);
  for (const GiNaC::ex& x : {whole, by})
    if (GiNaC::is_a<GiNaC::add>(x) && x.nops() > most_terms) return std::nullopt;
  const GiNaC::ex both = (whole / by).normal().numer_denom();
  GiNaC::ex up = both.op(0), down = both.op(1);
  if (reduced(polynomial(down), Role::kSin).begin()->second < 0) {
    up = -up;
    down = -down;
  }
  const auto written = [this](const GiNaC::ex& x) {  // 3 g (2 m1 + m2), and not g (6 m1 + 3 m2)
    const GiNaC::numeric content = x.integer_content();
    return Formula::product({Formula::ofNumber(fromGinac(content)), formula(x / content)});
  };
  const Formula above = written(up.expand()), below = written(down.expand());
  if (below.kind == Formula::Kind::kNumber && below.number == 1) return above;
  if (above.kind == Formula::Kind::kNegate)
    return Formula::negate(Formula::quotient(above.operands.front(), below));
  return Formula::quotient(above, below);
}

// ---- several forms of one polynomial ------------------------------------------------------------

std::vector<ClosedAlgebra::Polynomial> ClosedAlgebra::forms(const Polynomial& p) {
  const Polynomial summed = inSummedAngles(p);
  return {reduced(p, Role::kSin), reduced(p, Role::kCos), reduced(summed, Role::kSin),
          reduced(summed, Role::kCos), inMultipleAngles(p)};
}

std::vector<ClosedAlgebra::TermGap> ClosedAlgebra::termGaps(const GiNaC::ex& derived,
                                                            const GiNaC::ex& stated) {
  const std::vector<Polynomial> of_derived = forms(polynomial(derived)),
                                of_stated = forms(polynomial(stated));
  std::vector<TermGap> best;
  for (std::size_t form = 0; form < of_derived.size(); ++form) {
    std::map<Monomial, std::pair<Rational, Rational>, DisplayOrder> sides;
    for (const auto& [monomial, r] : of_derived[form]) sides[monomial].first = r;
    for (const auto& [monomial, r] : of_stated[form]) sides[monomial].second = r;
    std::vector<TermGap> gaps;
    for (const auto& [monomial, side] : sides) {
      if (side.first == side.second) continue;
      std::vector<Formula> factors;
      for (const auto& [symbol, exponent] : monomial)
        factors.push_back(Formula::power(symbols_[symbol].shown, exponent));
      gaps.push_back({Formula::product(factors), side.first, side.second});
    }
    if (form == 0 || gaps.size() < best.size()) best = gaps;
  }
  return best;
}

// ---- the derivation by GiNaC --------------------------------------------------------------------

ClosedForm deriveClosedForm(ClosedAlgebra& algebra, const Equations& equations) {
  const int n = equations.dof();
  ClosedForm f;
  f.kinetic = algebra.expression(equations.kinetic);
  f.potential = algebra.expression(equations.potential);
  for (int i = 0; i < n; ++i) {
    f.p.push_back(algebra.derivative(f.kinetic, {Input::kVelocity, i}));
    f.g.push_back(algebra.derivative(f.potential, {Input::kPosition, i}));
  }
  for (int i = 0; i < n; ++i) {
    f.M.emplace_back();
    for (int j = 0; j < n; ++j) f.M[i].push_back(algebra.derivative(f.p[i], {Input::kVelocity, j}));
  }
  const auto slope = [&](int i, int j, int k) {
    return algebra.derivative(f.M[i][j], {Input::kPosition, k});
  };
  f.Gamma.assign(n, std::vector<std::vector<GiNaC::ex>>(n, std::vector<GiNaC::ex>(n)));
  for (int i = 0; i < n; ++i) {
    GiNaC::ex c = 0;
    for (int j = 0; j < n; ++j) {
      for (int k = 0; k < n; ++k) {
        f.Gamma[i][j][k] = ((slope(i, j, k) + slope(i, k, j) - slope(j, k, i)) / 2).expand();
        c += f.Gamma[i][j][k] * algebra.input(Input::kVelocity, j) *
             algebra.input(Input::kVelocity, k);
      }
    }
    f.c.push_back(c.expand());
  }
  return f;
}

}  // namespace dynwitness::symbolic
