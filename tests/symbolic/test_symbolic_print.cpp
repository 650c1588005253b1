// SPDX-License-Identifier: GPL-3.0-or-later
// What leaves the symbolic side as text: the same bytes every time, code that computes the same
// numbers, markup that other programs accept.
#include <dlfcn.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <random>
#include <sstream>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "scene/mimic.hpp"
#include "scene/scene.hpp"
#include "symbolic/derivation.hpp"
#include "symbolic/print.hpp"
#include "tests/fixtures/scene_files.hpp"

using namespace dynwitness;
using namespace dynwitness::symbolic;
namespace data = boost::unit_test::data;
namespace fs = std::filesystem;

namespace {

/// A folder that is removed again.
struct Folder {
  fs::path path;
  Folder() {
    std::string name = (fs::temp_directory_path() / "dynwitness_print_XXXXXX").string();
    path = mkdtemp(name.data());
  }
  ~Folder() { fs::remove_all(path); }
};

void write(const fs::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

/// Standard output of a command that must succeed.
std::string output(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  BOOST_REQUIRE(pipe != nullptr);
  std::string text;
  std::array<char, 65536> buffer;
  while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe))
    text.append(buffer.data(), n);
  BOOST_REQUIRE_MESSAGE(pclose(pipe) == 0, command);
  return text;
}

struct DoubleState {
  std::vector<double> q, qd;
  scene::State<double> state;
};

DoubleState randomState(int n, unsigned seed, int positions = 0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> between(-3, 3);
  DoubleState s;
  for (int i = 0; i < n; ++i) {
    s.q.push_back(between(random));
    s.qd.push_back(between(random));
    s.state.x.push_back(scene::jointPosition(s.q.back()));
  }
  for (int i = n; i < positions; ++i) {
    s.q.push_back(between(random));
    s.state.x.push_back(scene::jointPosition(s.q.back()));
  }
  s.state.qd = s.qd;
  return s;
}

/// The same of a mechanism: q as the code takes it, without joints that follow others.
DoubleState randomState(const scene::Mechanism& m, unsigned seed) {
  const std::size_t given = scene::givenSlots(m).size();
  DoubleState s = randomState(m.dof(), seed, static_cast<int>(given));
  s.state.x.clear();
  for (const double q : scene::allPositions(m, s.q)) s.state.x.push_back(scene::jointPosition(q));
  return s;
}

std::vector<double> expected(const Equations& e, const scene::Mechanism& m,
                             const scene::State<double>& state) {
  const Program program = compile(e.graph, massCoriolisGravity(e));
  return ProgramRun<double>(program, scene::RealNumbers<double>(m))(state);
}

/// Largest difference in units of round-off of the largest value.
double distance(const std::vector<double>& a, const std::vector<double>& b) {
  BOOST_REQUIRE(a.size() == b.size());
  double scale = 1, worst = 0;
  for (double x : b) scale = std::max(scale, std::abs(x));
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst / scale / std::numeric_limits<double>::epsilon();
}

// measured: 0 on all bundled scenes but modern_robotics_3link (an oblique axis, whose angles the
// emitted code computes by itself): 2
constexpr double kRoundOff = 64;

/// A scene's derivation, once a process: that of a humanoid takes seconds.
const Derivation& derivationOf(const std::string& file) {
  static std::map<std::string, Derivation> known;
  const auto at = known.find(file);
  if (at != known.end()) return at->second;
  return known.emplace(file, derivation(scene::readScene(file).mechanism)).first->second;
}

/// Everything that is printed about a scene.
std::string everything(const std::string& file) {
  const scene::Mechanism m = scene::readScene(file).mechanism;
  const Derivation& d = derivationOf(file);
  const Equations e = derive(m);
  std::string text = print(d, Style::kText) + print(d, Style::kLatex) + print(d, Style::kMathml) +
                     emitC(e, m, "f") + emitPython(e, m, "f");
  for (const ShownEquation& shown : shortClosedForm(m)) text += shown.name + shown.mathml;
  return text;
}

std::string closed(const std::string& scene, const std::string& name, Style style = Style::kText) {
  for (const Step& s : derivation(scene::findScene(scene).mechanism).steps)
    for (const Equation& e : s.equations)
      if (print(e.left, Style::kText) == name) return print(e, style);
  return "no equation of " + name;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

BOOST_AUTO_TEST_CASE(closed_forms_read_as_in_a_textbook) {
  BOOST_TEST(closed("double_pendulum", "M22") == "M22 = 1/3*m2*l2^2");
  BOOST_TEST(closed("double_pendulum", "M12") == "M12 = 1/3*m2*l2^2 + 1/2*m2*l1*l2*cos(q2)");
  BOOST_TEST(closed("double_pendulum", "c1") == "c1 = -1/2*m2*l1*l2*qd2*(2*qd1 + qd2)*sin(q2)");
  BOOST_TEST(closed("double_pendulum", "c2") == "c2 = 1/2*m2*l1*l2*qd1^2*sin(q2)");
  BOOST_TEST(closed("double_pendulum", "g2") == "g2 = 1/2*m2*g*l2*sin(q1 + q2)");
  BOOST_TEST(closed("elastic_pendulum", "c1") == "c1 = 2*m*(l0 + q2)*qd1*qd2");
  BOOST_TEST(closed("double_pendulum", "g2", Style::kLatex) ==
             "g_{2} = \\tfrac{1}{2} m_{2} g l_{2} \\sin(q_{1} + q_{2})");
}

BOOST_AUTO_TEST_CASE(an_argument_ends_where_it_is_seen_to_end) {
  const Formula c = Formula::ofInput(Input::kCos, 3), v = Formula::ofSymbol("v2x");
  BOOST_TEST(print(Formula::product({v, c}), Style::kLatex) == "v_{2x} \\cos q_{4}");
  BOOST_TEST(print(Formula::product({c, v}), Style::kLatex) == "\\cos(q_{4}) v_{2x}");
  BOOST_TEST(print(Formula::product({Formula::power(c, 2), v}), Style::kLatex) ==
             "\\cos^{2}(q_{4}) v_{2x}");
  BOOST_TEST(print(Formula::product({c, v}), Style::kC) == "c4*v2x");
  BOOST_TEST(print(Formula::matrix({c, v, v, c}, 2), Style::kText) ==
             "[cos(q4), v2x; v2x, cos(q4)]");
}

BOOST_AUTO_TEST_CASE(names_are_typeset) {
  BOOST_TEST(printName("theta1", Style::kLatex) == "\\theta_{1}");
  BOOST_TEST(printName("m1", Style::kLatex) == "m_{1}");
  BOOST_TEST(printName("lc1", Style::kLatex) == "l_{c1}");
  BOOST_TEST(printName("omega3x", Style::kLatex) == "\\omega_{3x}");
  BOOST_TEST(printName("m_upper_arm", Style::kLatex) == "m_{\\mathrm{upper\\,arm}}");
  BOOST_TEST(printName("stroke", Style::kLatex) == "\\mathit{stroke}");
  BOOST_TEST(printName("theta1", Style::kMathml) == "<msub><mi>&#x3b8;</mi><mn>1</mn></msub>");
  BOOST_TEST(printName("T_a<b", Style::kMathml) == "<msub><mi>T</mi><mi>a&lt;b</mi></msub>");
}

BOOST_AUTO_TEST_CASE(numbers_are_exact_in_formulas_and_doubles_in_code) {
  const auto number = [](const Rational& r, Style s) { return print(Formula::ofNumber(r), s); };
  BOOST_TEST(number(Rational(4318, 10000), Style::kText) == "0.4318");
  BOOST_TEST(number(Rational(1, 3), Style::kText) == "1/3");
  BOOST_TEST(number(Rational(1, 3), Style::kLatex) == "\\tfrac{1}{3}");
  BOOST_TEST(number(Rational(1, 3), Style::kC) == "0.3333333333333333");
  BOOST_TEST(number(2, Style::kC) == "2.0");
}

BOOST_AUTO_TEST_CASE(signs_and_parentheses) {
  const Formula a = Formula::ofSymbol("a"), b = Formula::ofSymbol("b"), c = Formula::ofSymbol("c");
  const auto minus = [](const Formula& x, const Formula& y) {
    return Formula::sum({x, Formula::negate(y)});
  };
  BOOST_TEST(print(minus(a, minus(b, c)), Style::kC) == "a - (b - c)");
  BOOST_TEST(print(minus(minus(a, b), c), Style::kC) == "a - b - c");
  BOOST_TEST(print(Formula::product({minus(a, b), Formula::negate(c)}), Style::kC) == "-(a - b)*c");
  BOOST_TEST(print(Formula::product({a, Formula::product({b, c})}), Style::kC) == "a*(b*c)");
  BOOST_TEST(print(Formula::product({a, Formula::power(b, -1)}), Style::kC) == "a*(1.0/b)");
  BOOST_TEST(print(Formula::power(minus(a, b), 2), Style::kText) == "(a - b)^2");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(derivations)

BOOST_DATA_TEST_CASE(every_step_of_every_scene_holds, data::make(derivedSceneFiles()), file) {
  const Derivation& d = derivationOf(file);
  BOOST_TEST(d.steps.size() >= 7u);
  for (const Step& step : d.steps) BOOST_TEST(step.holds, step.name + ": " + step.check);
}

BOOST_AUTO_TEST_CASE(short_closed_forms_for_the_report) {
  const auto pendulum = scene::findScene("double_pendulum").mechanism;
  BOOST_TEST(shortClosedForm(pendulum).size() == 9u);  // T, V, M11, M12, M22, c1, c2, g1, g2
  BOOST_TEST(shortClosedForm(pendulum, 20).empty());
  BOOST_TEST(shortClosedForm(scene::findScene("puma_560").mechanism).empty());
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(determinism)

std::string allScenes() {
  std::string text;
  for (const std::string& file : derivedSceneFiles()) text += everything(file);
  return text;
}

// prints when another test asks for it
BOOST_AUTO_TEST_CASE(child) {
  const char* file = std::getenv("DYNWITNESS_PRINT_TO");
  if (file == nullptr) return;
  write(file, allScenes());
}

BOOST_AUTO_TEST_CASE(two_processes_print_the_same_bytes) {
  const Folder folder;
  const std::string self = fs::read_symlink("/proc/self/exe").string();
  const fs::path file = folder.path / "other";
  output("DYNWITNESS_PRINT_TO='" + file.string() + "' '" + self +
         "' --run_test=determinism/child 2>&1");
  std::ifstream in(file);
  const std::string other((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  BOOST_TEST(other.size() > 100000u);
  BOOST_TEST((other == allScenes()));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(emitted_code)

BOOST_DATA_TEST_CASE(c_computes_what_the_program_computes,
                     data::make(sceneFiles()) * data::make({false, true}), file, fold) {
  const scene::Mechanism m = scene::readScene(file).mechanism;
  const Equations e = derive(m, {fold, true});
  const int n = e.dof();
  const Folder folder;
  const std::string base = (folder.path / "f").string();
  write(base + ".c", emitC(e, m, "eom"));
  // CC as Makefiles have it
  const char* compiler = std::getenv("CC");
  output(std::string(compiler ? compiler : "cc") +
         " -std=c99 -pedantic-errors -Wall -Werror -O0 -ffp-contract=off -shared -fPIC '" + base +
         ".c' -o '" + base + ".so' -lm 2>&1");
  void* library = dlopen((base + ".so").c_str(), RTLD_NOW);
  BOOST_REQUIRE(library != nullptr);
  using Function = void (*)(const double*, const double*, const double*, double*, double*, double*);
  const auto function = reinterpret_cast<Function>(dlsym(library, "eom"));
  const auto parameters = static_cast<const double*>(dlsym(library, "eom_parameters"));
  for (unsigned seed = 0; seed < 5; ++seed) {
    const DoubleState s = randomState(m, seed);
    std::vector<double> result(n * (n + 2));
    function(s.q.data(), s.qd.data(), parameters, result.data(), result.data() + n * n,
             result.data() + n * (n + 1));
    BOOST_TEST(distance(result, expected(e, m, s.state)) <= kRoundOff);
  }
  dlclose(library);
}

BOOST_DATA_TEST_CASE(python_computes_what_the_program_computes, data::make(sceneFiles()), file) {
  const scene::Mechanism m = scene::readScene(file).mechanism;
  const Equations e = derive(m);
  const Folder folder;
  const DoubleState s = randomState(m, 3);
  const auto list = [](const std::vector<double>& v) {
    std::ostringstream text;
    text.precision(17);
    for (double x : v) text << x << ", ";
    return "[" + text.str() + "]";
  };
  write(folder.path / "f.py", emitPython(e, m, "eom") + "\nM, c, g = eom(" + list(s.q) + ", " +
                                  list(s.qd) + ")\nfor x in sum(M, []) + c + g: print(repr(x))\n");
  std::istringstream lines(output("/usr/bin/python3 '" + (folder.path / "f.py").string() + "'"));
  std::vector<double> result;
  for (double x = 0; lines >> x;) result.push_back(x);
  BOOST_TEST(distance(result, expected(e, m, s.state)) <= kRoundOff);
}

BOOST_AUTO_TEST_CASE(parameters_can_be_changed_in_emitted_code) {
  scene::Mechanism m = scene::findScene("double_pendulum").mechanism;
  const std::string code = emitPython(derive(m), m, "eom");
  for (scene::Parameter& p : m.parameters)
    if (p.name == "l1") p.value = scene::Number(Rational(7, 4));
  const scene::ParameterValues changed = m.parameterValues();
  std::string values;
  for (const scene::Parameter& p : m.parameters)
    values += std::to_string(changed.at(p.name).toDouble()) + ", ";
  const Folder folder;
  const DoubleState s = randomState(2, 1);
  std::ostringstream call;
  call.precision(17);
  call << "\nM, c, g = eom([" << s.q[0] << ", " << s.q[1] << "], [" << s.qd[0] << ", " << s.qd[1]
       << "], [" << values << "])\nfor x in sum(M, []) + c + g: print(repr(x))\n";
  write(folder.path / "f.py", code + call.str());
  std::istringstream lines(output("/usr/bin/python3 '" + (folder.path / "f.py").string() + "'"));
  std::vector<double> result;
  for (double x = 0; lines >> x;) result.push_back(x);
  BOOST_TEST(distance(result, expected(derive(m), m, s.state)) <= kRoundOff);
}

BOOST_AUTO_TEST_CASE(any_parameter_name_makes_valid_code) {
  const auto m = scene::readSceneToml(R"(
title = "t"
source = "this test"
gravity = [0, "-return_", 0]
[parameters]
return_ = 9.81
c1 = 2
M = 0.5
double = "c1/3"
[[link]]
name = "base"
[[link]]
name = "a"
parent = "base"
mass = "c1"
com = ["M", "double", 0]
[link.joint]
kind = "revolute"
rpy = ["M", "c1/4", 0]
[[link]]
name = "b"
parent = "a"
mass = "c1"
com = ["M", "double", 0]
[link.joint]
kind = "revolute"
axis = ["M", "c1", 1]
)",
                                      "t.toml")
                     .mechanism;
  const Equations e = derive(m);
  const Folder folder;
  const std::string base = (folder.path / "f").string();
  write(base + ".c", emitC(e, m, "eom"));
  output("cc -std=c99 -pedantic-errors -Wall -Werror -c '" + base + ".c' -o '" + base + ".o' 2>&1");
  const DoubleState s = randomState(2, 2);
  std::ostringstream call;
  call.precision(17);
  call << "\nM, c, g = eom([" << s.q[0] << ", " << s.q[1] << "], [" << s.qd[0] << ", " << s.qd[1]
       << "])\nfor x in sum(M, []) + c + g: print(repr(x))\n";
  write(base + ".py", emitPython(e, m, "eom") + call.str());
  std::istringstream lines(output("/usr/bin/python3 '" + base + ".py'"));
  std::vector<double> result;
  for (double x = 0; lines >> x;) result.push_back(x);
  BOOST_TEST(distance(result, expected(e, m, s.state)) <= kRoundOff);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(markup)

BOOST_DATA_TEST_CASE(latex_is_balanced, data::make(derivedSceneFiles()), file) {
  const std::string text = print(derivationOf(file), Style::kLatex);
  int depth = 0, lowest = 0;
  std::vector<int> open;  // parentheses, by formula
  bool in_formula = false, balanced = true;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\') {
      ++i;  // an escaped brace is no brace
      continue;
    }
    if (text[i] == '$') {
      balanced = balanced && (!in_formula || open.back() == 0);
      in_formula = !in_formula;
      open.push_back(0);
    }
    if (in_formula && (text[i] == '(' || text[i] == ')')) {
      open.back() += text[i] == '(' ? 1 : -1;
      balanced = balanced && open.back() >= 0;
    }
    if (text[i] == '{') ++depth;
    if (text[i] == '}') lowest = std::min(lowest, --depth);
  }
  BOOST_TEST(depth == 0);
  BOOST_TEST(lowest == 0);
  BOOST_TEST(balanced);
  BOOST_TEST(!in_formula);
}

BOOST_DATA_TEST_CASE(mathml_is_well_formed_xml, data::make(derivedSceneFiles()), file) {
  const Folder folder;
  const std::string path = (folder.path / "d.xml").string();
  write(path, "<div>" + print(derivationOf(file), Style::kMathml) + "</div>");
  // every element is one of MathML Core's, msub and friends have as many children as they need
  const std::string count = output(
      "/usr/bin/python3 -c 'import sys, xml.etree.ElementTree as E\n"
      "t = E.parse(sys.argv[1]); n = 0\n"
      "for e in t.iter():\n"
      "    tag = e.tag.split(\"}\")[-1]\n"
      "    if tag in (\"msub\", \"msup\", \"mfrac\", \"mover\"): assert len(e) == 2, "
      "E.tostring(e)\n"
      "    assert tag in \"div details summary p span math mrow mi mn mo msub msup mfrac mover "
      "mtable mtr mtd mspace\".split(), tag\n"
      "    n += tag == \"math\"\n"
      "print(n)' '" +
      path + "'");
  BOOST_TEST(std::stoi(count) > 3);
}

BOOST_AUTO_TEST_SUITE_END()
