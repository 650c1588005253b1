// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms by GiNaC, for mechanisms of a few joints: the textbook derivation once more, by
// another program's differentiation, and the shortest form to show.
//
// GiNaC is not thread safe, and orders terms differently in every run: nothing here leaves in
// GiNaC's order.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <ginac/ginac.h>

#include "symbolic/equations.hpp"
#include "symbolic/formula.hpp"

namespace dynwitness::symbolic {

/// Closed forms grow about fourteen-fold with each joint; beyond this many those that are short are
/// shown, entry by entry, and the others as lines of a program.
constexpr int kClosedFormJoints = 3;

/** The nodes of a graph as polynomials of GiNaC in parameters, rates, and c_k and s_k. */
class ClosedAlgebra {
 public:
  explicit ClosedAlgebra(const Equations& equations);

  GiNaC::ex expression(Node node);
  const GiNaC::symbol& input(Input input, int joint);

  /// dx / d variable by GiNaC, with  d c_k = -s_k dq_k,  d s_k = c_k dq_k.
  GiNaC::ex derivative(const GiNaC::ex& x, Variable variable);
  /// dx/dt along a motion: sum of dx/dq_i qd_i + dx/dqd_i qdd_i.
  GiNaC::ex rate(const GiNaC::ex& x);

  /// Is x = 0 for all values of its symbols with c_k^2 + s_k^2 = 1? Exact, by normal form.
  bool isZero(const GiNaC::ex& x);

  /** The shortest of several forms of x: polynomials in which the cosines, or the sines, have first
      powers only, written in the joints' angles or in sums of the angles of parallel joints; and a
      sum of cosines and sines of multiple angles. The choice and the order of terms depend on x
      alone. */
  Formula formula(const GiNaC::ex& x);

  /** dividend / divisor, c^2 + s^2 = 1 used first, then common factors divided out, with c and s
      taken for letters; signs are the divisor's, whose first term is positive. Neither is 0.
      @return none: one of them has more than `most_terms` terms, and common factors are not
        looked for */
  std::optional<Formula> quotient(const GiNaC::ex& dividend, const GiNaC::ex& divisor,
                                  std::size_t most_terms);

  /** formula() of a node, multiplied out without GiNaC and given up where that grows: whatever the
      number of joints, what is short is found in a time that its graph decides.
      @return none: on the way, or at last, it has too many terms (see closed_entries.cpp) */
  std::optional<Formula> shortFormula(Node node);

  /// One term of two expanded forms that is not the same in both; 0 where it does not occur.
  struct TermGap {
    Formula term;  ///< without its coefficient
    Rational derived, stated;
  };
  /** Where a stated form differs from the derived one: of the forms that formula() chooses from,
      both expanded, the one with the fewest terms that differ. Empty where both are the same. */
  std::vector<TermGap> termGaps(const GiNaC::ex& derived, const GiNaC::ex& stated);

 private:
  using Monomial = std::vector<std::pair<int, int>>;  ///< (symbol, exponent), symbols increasing
  /// Low degrees first; of equal degree, high powers of early symbols first: x^2, x y, y^2.
  struct DisplayOrder {
    bool operator()(const Monomial& a, const Monomial& b) const;
  };
  using Polynomial = std::map<Monomial, Rational, DisplayOrder>;
  using Angle = std::vector<int>;  ///< integer combination of q

  enum class Role { kNumber, kRate, kCos, kSin };
  struct Symbol {
    Role role;
    Formula shown;
    Angle angle;  ///< kCos, kSin
  };
  class Writer;

  int addSymbol(const Symbol& symbol);
  std::pair<int, int> trigOf(const Angle& angle);  ///< symbols of its cosine and sine
  Polynomial polynomial(const GiNaC::ex& x);
  Polynomial onFixedCircles(Polynomial p) const;
  /// The normal form of a node; null: it has too many terms.
  const Polynomial* multipliedOut(Node node);
  std::optional<Polynomial> multipliedOutAnew(Node node);  ///< its operands are known
  const Polynomial* known(Node node) const;
  std::optional<Polynomial> boundedProduct(const Polynomial& a, const Polynomial& b);
  Polynomial reduced(const Polynomial& p, Role power_kept) const;
  GiNaC::ex withoutCosineSquares(const GiNaC::ex& x);
  Polynomial inSummedAngles(const Polynomial& p);
  Polynomial inMultipleAngles(const Polynomial& p);
  /// The forms that formula() chooses from.
  std::vector<Polynomial> forms(const Polynomial& p);
  /// The shortest of some forms as it is written; none is 0.
  Formula shortest(const std::vector<Polynomial>& forms) const;
  std::size_t differentIn(const Polynomial& p, const std::set<Role>& roles) const;
  static Polynomial product(const Polynomial& a, const Polynomial& b);
  static Monomial product(const Monomial& a, const Monomial& b);
  template <typename Replacement>
  static Polynomial replaced(const Polynomial& p, Replacement replacement);
  static Polynomial withoutSquares(int x, int exponent, int y);
  static void accumulate(const Monomial& m, const Rational& r, Polynomial* total);
  static void accumulate(const Polynomial& terms, Polynomial* total);

  const Equations& equations_;
  std::map<int, GiNaC::ex> expressions_;                     ///< of nodes
  std::map<int, int> number_symbols_;                        ///< of atoms and inverses, by node
  std::map<int, std::optional<Polynomial>> multiplied_out_;  ///< of nodes
  long products_left_ = 2000000;                             ///< of two terms: two seconds
  std::map<std::pair<Input, int>, GiNaC::symbol> inputs_;
  std::map<GiNaC::ex, int, GiNaC::ex_is_less> symbol_of_;
  std::vector<Symbol> symbols_;
  std::map<Angle, std::pair<int, int>> trig_;
  std::map<int, int> fixed_angles_;  ///< among the numbers: the sine of each cosine
};

/// T and V of the graph, and what GiNaC derives from them.
struct ClosedForm {
  GiNaC::ex kinetic, potential;
  std::vector<GiNaC::ex> p, c, g;
  std::vector<std::vector<GiNaC::ex>> M;
  /// Gamma[i][j][k] = (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) / 2
  std::vector<std::vector<std::vector<GiNaC::ex>>> Gamma;
};
ClosedForm deriveClosedForm(ClosedAlgebra& algebra, const Equations& equations);

}  // namespace dynwitness::symbolic
