// SPDX-License-Identifier: GPL-3.0-or-later
// derive on the command line: single lines, other letters, numbers put in, zeros and their reasons,
// the sweep beside, the page with its drawing; and what is refused.
#include <boost/test/unit_test.hpp>

#include <string>

#include "tests/fixtures/program.hpp"

using dynwitness::fixtures::Outcome;
using dynwitness::fixtures::Program;
using dynwitness::fixtures::refuses;

namespace {

/// The outcome, which has to say this and be read back.
std::string proven(const Program& program, const std::string& words) {
  const Outcome out = program.run("derive " + words + " --proof");
  BOOST_TEST(out.status == 0, words << "\n" << out.out);
  BOOST_TEST(out.out.find("formulas are what was derived") != std::string::npos, out.out);
  return out.out;
}
bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

BOOST_AUTO_TEST_CASE(one_line_in_three_notations) {
  const Program program;
  const std::string words =
      "double_pendulum --only M12,tau2 --no-checks --rename q2=phi "
      "--substitute l1=1/2 --format ";
  const std::string text = proven(program, words + "text"),
                    latex = proven(program, words + "latex"),
                    html = proven(program, words + "html");
  BOOST_TEST(has(text, "M12 = 1/3*m2*l2^2 + 1/4*m2*l2*cos(phi)\n"), text);
  BOOST_TEST(has(text, "= tau2"));
  BOOST_TEST(has(latex, "\\tfrac{1}{4} m_{2} l_{2} \\cos \\phi"), latex);
  BOOST_TEST(has(html, "data-latex=\"M_{12} = "));
  for (const std::string& page : {text, latex, html}) {
    BOOST_TEST(!has(page, "M11"));
    BOOST_TEST(!has(page, "check: "));
    BOOST_TEST(!has(page, "Check: "));
    BOOST_TEST(!has(page, "Checked exactly"));
    BOOST_TEST(has(page, "Put in: l1=1/2"));
  }
  BOOST_TEST(has(text, "phi is q2"));
  BOOST_TEST(has(latex, "$\\phi$ is $q_{2}$"), latex);
  BOOST_TEST(has(html, "<mi>&#x3d5;</mi></mrow></math> is <math><mrow><msub><mi>q</mi>"), html);
}

BOOST_AUTO_TEST_CASE(shorthand_and_parameters_in_three_notations) {
  const Program program;
  const std::string words = "scara --only M11,g --shorthand --format ";
  const std::string text = proven(program, words + "text"),
                    latex = proven(program, words + "latex"),
                    html = proven(program, words + "html");
  BOOST_TEST(has(text, "c2m4 = cos(q2 - q4)\n"), text);
  BOOST_TEST(has(text, "0.06*m4*a1*c2m4"), text);
  BOOST_TEST(has(text, "with m1 = 8 kg, m2 = 6 kg, m3 = 1.5 kg, m4 = 0.5 kg, a1 = 0.35 m"), text);
  BOOST_TEST(has(latex, "$\\displaystyle c_{\\mathrm{2m4}} = \\cos(q_{2} - q_{4})$"), latex);
  BOOST_TEST(has(latex, "$g = 9.81\\,\\mathrm{m/s^{2}}$"), latex);
  BOOST_TEST(has(html, "<mn>9.81</mn></mrow></math> m/s&#xb2;"));
  BOOST_TEST(has(html, "data-latex=\"c_{\\mathrm{2m4}} = "));
  refuses(program, "derive scara --shorthand --format c", "allowed: --format text");
}

BOOST_AUTO_TEST_CASE(zeros_have_the_ledgers_reasons) {
  const Program program;
  const std::string scara = proven(program, "scara --only M,c,g");
  BOOST_TEST(has(scara, "M13 = M23 = M34 = 0: a slide along the axis of a turn"), scara);
  BOOST_TEST(has(scara, "g1 = g2 = g4 = 0: gravity is along the axis"), scara);
  BOOST_TEST(has(scara, "reasons of zeros"));
  const std::string ledger = program.run("show scara").out;
  BOOST_TEST(has(ledger, "a slide along the axis of a turn"));
  // with what is put in, reasons are of what is left
  const std::string light = proven(program, "double_pendulum --only M,g --substitute g=0");
  BOOST_TEST(has(light, "g1 = g2 = 0: "), light);
}

BOOST_AUTO_TEST_CASE(the_sweep_says_the_same_lines) {
  const Program program;
  const std::string both = proven(program, "double_pendulum --only tau1 --beside newton_euler");
  const std::size_t first = both.find("= tau1"), last = both.rfind("= tau1");
  BOOST_TEST(first != last);
  const auto line = [&both](std::size_t at) {
    const std::size_t begin = both.rfind('\n', at) + 1;
    return both.substr(begin, at - begin);
  };
  BOOST_TEST(line(first) == line(last));
  const std::string page = program.run("derive cart_pole --beside newton_euler --format html").out;
  BOOST_TEST(has(page, "<div class=\"columns\"><div>"));
  BOOST_TEST(has(page, "</div><div>"));
  BOOST_TEST(has(page, "where both meet"));
  refuses(program, "derive scara --beside newton_euler", "allowed: up to 3");
}

BOOST_AUTO_TEST_CASE(the_page_begins_with_the_mechanism) {
  const Program program;
  const std::string page = program.run("derive double_pendulum --format html").out;
  const std::size_t picture = page.find("<svg id=\"picture\""),
                    joints = page.find("Joints, in the order of q and qd"),
                    first = page.find("1. positions");
  BOOST_REQUIRE(picture != std::string::npos);
  BOOST_REQUIRE(joints != std::string::npos);
  BOOST_REQUIRE(first != std::string::npos);
  BOOST_TEST(picture < joints);
  BOOST_TEST(joints < first);
}

BOOST_AUTO_TEST_CASE(the_document_begins_with_the_mechanism) {
  const Program program;
  const std::string document = program.run("derive double_pendulum --format latex").out;
  const std::size_t picture = document.find("\\begin{picture}"),
                    joints =
                        document.find("$q_{2}$ & elbow & revolute & rad & 0 1 0 & upper & lower"),
                    first = document.find("\\paragraph{1. positions}");
  BOOST_REQUIRE(picture != std::string::npos);
  BOOST_REQUIRE(joints != std::string::npos);
  BOOST_REQUIRE(first != std::string::npos);
  BOOST_TEST(picture < joints);
  BOOST_TEST(joints < first);
  const std::string text = program.run("derive double_pendulum").out;
  BOOST_TEST(text.rfind("double_pendulum: ", 0) == 0u, text.substr(0, 200));
  BOOST_TEST(text.find("  q2  elbow     revolute  rad   0 1 0  upper   lower\n") <
                 text.find("1. positions"),
             text.substr(0, 400));
  BOOST_TEST(program.run("derive double_pendulum --only M12").out.find("revolute") ==
             std::string::npos);
  // who asks for a line wants that line
  BOOST_TEST(
      !has(program.run("derive double_pendulum --format latex --only M12").out, "{picture}"));
}

/// Browsers end no line within a math element: a page printed, or on a phone, would be cut.
BOOST_AUTO_TEST_CASE(long_equations_of_a_page_may_end_lines) {
  const Program program;
  const std::string page = program.run("derive double_pendulum --format html").out;
  const std::size_t motion = page.find("equations of motion</summary>"),
                    first = page.find("<span class=\"formula\">", motion),
                    last = page.find("</span>", first);
  BOOST_REQUIRE(last != std::string::npos);
  std::size_t pieces = 0;
  for (std::size_t at = first; (at = page.find("<math ", at)) < last; ++at) ++pieces;
  BOOST_TEST(pieces >= 5u);  // terms of the first equation of motion
  BOOST_TEST(has(page, "addEventListener('beforeprint'"));
}

BOOST_AUTO_TEST_CASE(what_is_none_is_refused_with_the_nearest) {
  const Program program;
  refuses(program, "derive double_pendulum --only Gama", "did you mean Gamma?");
  refuses(program, "derive double_pendulum --only M12 --quantity M", "--only");
  refuses(program, "derive double_pendulum --only M12 --format c", "allowed: --format text");
  refuses(program, "derive double_pendulum --substitute l3=1", "did you mean l1?");
  refuses(program, "derive double_pendulum --substitute l1=1/0", "division by zero");
  refuses(program, "derive double_pendulum --rename q4=x", "allowed: q1, q2");
  refuses(program, "derive double_pendulum --rename q1=m1", "a parameter");
  refuses(program, "derive double_pendulum --rename q1", "q1=NAME");
  refuses(program, "derive double_pendulum --beside kane", "newton_euler");
}
