// SPDX-License-Identifier: GPL-3.0-or-later
// Equations of pages in pieces between which a line may end: where, and that they are put together
// again; and mathematics in sentences.
#include "symbolic/mathml_pieces.hpp"

#include <boost/test/unit_test.hpp>

#include <regex>

#include "symbolic/sentence.hpp"

using namespace dynwitness::symbolic;

namespace {

Formula symbol(const char* name) {
  return Formula::ofSymbol(name);
}
Formula angle(int k) {
  return Formula::ofInput(Input::kPosition, k);
}

/// a (b + c + ...), as many letters as are asked for.
Formula longSum(const std::string& letters) {
  std::vector<Formula> terms;
  for (const char letter : letters)
    terms.push_back(Formula::power(symbol(std::string(1, letter).c_str()), 2));
  return Formula::sum(terms);
}

std::string mathml(const Formula& right) {
  return print(Equation{symbol("x"), right}, Style::kMathml);
}
int pieces(const Formula& right) {
  const std::string text = inPieces(mathml(right));
  int count = 0;
  for (std::size_t at = 0; (at = text.find("<math ", at)) != std::string::npos; ++at) ++count;
  return count;
}
/// What is put together again, without what tells browsers how to draw it.
std::string whole(const Formula& right) {
  static const std::regex kMarks("<mo [^>]*>");
  std::string text = std::regex_replace(withoutPieces(inPieces(mathml(right))), kMarks, "<mo>");
  const std::string drawn = " displaystyle=\"true\"";
  return text.replace(text.find(drawn), drawn.size(), " display=\"block\"");
}

}  // namespace

BOOST_AUTO_TEST_SUITE(pieces_of_equations)

BOOST_AUTO_TEST_CASE(lines_end_in_front_of_signs_of_long_sums) {
  const Formula sum = longSum("abcdefghijklmnop");  // 16 terms
  BOOST_TEST(pieces(sum) == 16);
  BOOST_TEST(pieces(longSum("abcd")) == 1);  // short
  // within parentheses, too, whose halves are then of one size
  const Formula product = Formula::product({symbol("m"), sum});
  BOOST_TEST(pieces(product) == 16);
  BOOST_TEST(inPieces(mathml(product)).find("<mo stretchy=\"false\">(</mo>") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(lines_end_nowhere_else) {
  const Formula sum = longSum("abcdefghijklmnop"), few = longSum("ab");
  BOOST_TEST(pieces(Formula::power(sum, 2)) == 1);
  BOOST_TEST(pieces(Formula::power(sum, -1)) == 1);
  BOOST_TEST(pieces(Formula::function(Formula::Kind::kCos, sum)) == 1);
  BOOST_TEST(pieces(Formula::matrix({sum, few, few, sum}, 2)) == 1);
  BOOST_TEST(pieces(Formula::negate(Formula::product(
                 {symbol("m"), symbol("averylongnameofamass"), symbol("another")}))) == 1);
  // short parentheses stay as they are
  const Formula factored = Formula::sum(
      {Formula::product({symbol("m"), few}), Formula::product({sum, few}), symbol("z")});
  BOOST_TEST(pieces(factored) == 1 + 1 + 15 + 1);
}

BOOST_AUTO_TEST_CASE(pieces_are_put_together_as_they_were) {
  const Formula sum = longSum("abcdefghijklmnop");
  const Formula turned = Formula::function(Formula::Kind::kSin, Formula::sum({angle(0), angle(1)}));
  for (const Formula& right :
       {sum, Formula::product({symbol("m"), sum, turned}),
        Formula::negate(Formula::product({Formula::ofNumber(Rational(1, 3)), sum, sum})),
        Formula::sum({Formula::product({sum, symbol("l")}), Formula::power(sum, -1)})}) {
    BOOST_TEST(whole(right) == mathml(right));
    BOOST_TEST(pieces(right) > 1);
  }
}

BOOST_AUTO_TEST_CASE(mathematics_in_sentences_is_set_as_such) {
  const auto latex = [](const std::string& text) { return printSentence(text, Style::kLatex); };
  BOOST_TEST(latex("M_ij = dp_i/dqd_j, as in link_3 & I.") ==
             "$M_{ij}$ = $dp_{i}$/$d\\dot{q}_{j}$, as in link\\_3 \\& I.");
  BOOST_TEST(latex("a turn: Gamma112 - omega' I omega of T-pole, d/dt") ==
             "a turn: $\\Gamma_{112}$ $-$ $\\omega$' I $\\omega$ of T-pole, d/$dt$");
  BOOST_TEST(latex("M1_10 and qdd") == "$M_{1\\,10}$ and $\\ddot{q}$");
  BOOST_TEST(
      printSentence("sum of q_i < 1", Style::kMathml) ==
      "sum of <math><mrow><msub><mi>q</mi><mrow><mi>i</mi></mrow></msub></mrow></math> &lt; 1");
  BOOST_TEST(printSentence("M_ij & M12", Style::kText) == "M_ij & M12");
}

BOOST_AUTO_TEST_SUITE_END()
