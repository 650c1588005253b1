// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness derive: the equations of motion from T and V, to be read or to be compiled.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/point_option.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/shown_derivation.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/kernel/controller_code.hpp"
#include "crosscheck/kernel/roads.hpp"
#include "crosscheck/kernel/shared_subtrees.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/nearest_name.hpp"
#include "scene/scene.hpp"
#include "symbolic/derivation.hpp"
#include "symbolic/print.hpp"

namespace dynwitness::cli {
namespace {

struct DeriveArguments {
  GivenScene scene;
  std::string output, format = "text", point, scalar = "double", parameters = "folded", beside;
  std::vector<std::string> quantities = {"all"}, only, substitutions, names;
  bool operations = false, proof = false, linearized = false, no_checks = false, shorthand = false;

  bool isAll() const { return quantities == std::vector<std::string>{"all"}; }
  bool isProgram() const { return format == "c" || format == "python" || format == "sympy"; }
  /// Code of the smallest roads, not M, c and g of named parameters.
  bool isCode() const {
    return format == "matlab" || format == "julia" ||
           (isProgram() && format != "sympy" && (!isAll() || parameters == "struct"));
  }
  /// An option that only a derivation to be read has; "": none is given.
  std::string ofReading() const {
    return proof                    ? "--proof"
           : linearized             ? "--linearized"
           : !only.empty()          ? "--only"
           : !beside.empty()        ? "--beside"
           : no_checks              ? "--no-checks"
           : shorthand              ? "--shorthand"
           : !substitutions.empty() ? "--substitute"
           : !names.empty()         ? "--rename"
                                    : "";
  }
  ShownDerivation shown() const {
    return {format, quantities, only,  substitutions, names,
            beside, linearized, proof, !no_checks,    shorthand};
  }
  /// What is asked that takes the inverse of M; "": nothing.
  std::string solved() const {
    if (operations) return "forward dynamics";
    if (!isCode()) return "";
    if (isAll()) return "qdd";
    for (const char* one : {"qdd", "dqdd_dq", "dqdd_dqd", "dqdd_dtau"})
      if (std::find(quantities.begin(), quantities.end(), one) != quantities.end()) return one;
    return "";
  }
};

/// How many operations each road to each formula takes, the smallest marked.
std::string operationsTable(const scene::Scene& scene) {
  namespace kernel = crosscheck::kernel;
  std::string text = fmt::format(
      "{}: multiplications/additions/divisions a call, for the scene's own numbers.\n"
      "Cosines and sines are not counted; * marks the smallest, which is the scene's kernel.\n\n",
      scene.name);
  bool first = true;
  for (const kernel::Formula formula : kernel::kAllFormulas) {
    const std::vector<kernel::Road> all = kernel::roads(scene.mechanism, formula);
    const auto smallest =
        std::min_element(all.begin(), all.end(), [](const kernel::Road& a, const kernel::Road& b) {
          return a.operations() < b.operations();
        });
    std::string head = fmt::format("{:<10}", ""), row = fmt::format("{:<10}", name(formula));
    for (const kernel::Road& road : all) {
      const symbolic::Program::Operations o = road.program.bodyOperations();
      head += fmt::format("{:>16}", name(road.kind));
      row += fmt::format("{:>16}", fmt::format("{}{}/{}/{}", &road == &*smallest ? "* " : "",
                                               o.multiplications, o.additions, o.divisions));
    }
    if (first) text += head + "\n";
    first = false;
    text += row + "\n";
  }
  const crosscheck::RecursionSteps steps = crosscheck::recursionSteps(
      recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism)));
  return text +
         fmt::format(
             "\n"
             "Steps of the articulated-body recursion, a step being one link and the joint that "
             "carries it:\n"
             "{:>6}  swept inward, the value of each subtree kept (dynamic programming)\n"
             "{:>6}  the recursion run anew for each link\n"
             "{:>6}  equal subtrees computed once, where they are in equal poses\n",
             steps.swept, steps.anew, steps.shared);
}

namespace kernel = crosscheck::kernel;

std::optional<kernel::CodePoint> pointOf(const std::string& text, const scene::Scene& scene) {
  if (text.empty()) return std::nullopt;
  const PointAsked asked = pointAsked(text, scene);
  kernel::CodePoint point{asked.link, {}};
  for (std::size_t k = 0; k < asked.at.size(); ++k) {
    point.at[k] = scene::Number::parse(asked.at[k], {"--point", 0});
    exactValue(point.at[k], scene.mechanism.parameterValues(), {"--point", 0});
  }
  return point;
}

std::vector<kernel::CodeQuantity> codeQuantities(const std::vector<std::string>& words) {
  std::vector<std::string> names;
  for (const kernel::CodeQuantity quantity : kernel::kCodeQuantities)
    names.emplace_back(name(quantity));
  std::vector<kernel::CodeQuantity> out;
  for (const std::string& word : words) {
    const auto it = std::find(names.begin(), names.end(), word);
    if (it == names.end())
      throw scene::InputError(
          {}, fmt::format("--quantity: read '{}'{}, allowed in code: {}; or all, alone", word,
                          scene::didYouMean(word, names), fmt::join(names, ", ")));
    const kernel::CodeQuantity quantity = kernel::kCodeQuantities[it - names.begin()];
    if (std::find(out.begin(), out.end(), quantity) == out.end()) out.push_back(quantity);
  }
  return out;
}

/// Of a test file: drawn, and the same in single precision.
std::vector<scene::State<double>> goldenStates(const scene::Scene& scene) {
  constexpr int kStates = 4;
  const auto plain = [](double& x) { x = std::round(x * 1024) / 1024; };
  std::vector<scene::State<double>> out;
  for (int k = 0; k < kStates; ++k) {
    scene::State<double> state =
        crosscheck::drawState(scene.mechanism, scene.name, 1, static_cast<std::uint64_t>(k));
    for (scene::JointPosition<double>& x : state.x) {
      plain(x.q);
      x = scene::jointPosition(x.q);
    }
    for (auto* part : {&state.qd, &state.qdd, &state.tau})
      for (double& x : *part) plain(x);
    out.push_back(state);
  }
  return out;
}

/// Files into a folder, or all but the test to standard output.
void writeCode(const DeriveArguments& arguments, const scene::Scene& scene) {
  const std::vector<std::string> words = arguments.isAll()
                                             ? std::vector<std::string>{"tau", "qdd", "M", "c", "g"}
                                             : arguments.quantities;
  const std::vector<kernel::CodeQuantity> quantities = codeQuantities(words);
  const std::optional<kernel::CodePoint> point = pointOf(arguments.point, scene);
  const bool of_point = std::any_of(quantities.begin(), quantities.end(), kernel::isOfPoint);
  if (of_point != point.has_value())
    throw scene::InputError(
        {}, of_point ? "kinematics without a point, allowed: --point LINK or LINK,x,y,z"
                     : "--point without a quantity of points, allowed: position, orientation, "
                       "jacobian, jacobian_rate");
  const kernel::CodeLanguage language =
      arguments.format == "c"        ? kernel::CodeLanguage::kC
      : arguments.format == "python" ? kernel::CodeLanguage::kPython
      : arguments.format == "julia"  ? kernel::CodeLanguage::kJulia
                                     : kernel::CodeLanguage::kMatlab;
  const kernel::CodeScalar scalar =
      arguments.scalar == "float" ? kernel::CodeScalar::kFloat : kernel::CodeScalar::kDouble;
  std::vector<std::pair<std::string, std::string>> files;
  try {
    const kernel::ControllerCode code(scene, quantities, point,
                                      arguments.parameters == "struct"
                                          ? kernel::CodeParameters::kStruct
                                          : kernel::CodeParameters::kFolded);
    const bool tests = !arguments.output.empty();
    files = code.files(
        language, scalar,
        tests ? code.golden(goldenStates(scene), scalar) : std::vector<kernel::GoldenCase>());
  } catch (const kernel::NotUsed& why) {
    throw scene::InputError({}, fmt::format("{}: no code is written: {}", scene.name, why.what()));
  } catch (const std::domain_error& why) {  // M is singular in every state
    throw scene::InputError({}, fmt::format("{}: no code is written: {}", scene.name, why.what()));
  }
  if (arguments.output.empty()) {
    files.pop_back();
    for (const auto& [file, text] : files) {
      // the header stands above
      const std::string include = "#include \"" + files[0].first + "\"\n\n";
      const bool includes = text.compare(0, include.size(), include) == 0;
      fmt::print("{}", includes ? "\n" + text.substr(include.size()) : text);
    }
    return;
  }
  const std::filesystem::path folder = arguments.output;
  std::filesystem::create_directories(folder);
  for (const auto& [file, text] : files) crosscheck::writeWholeFile(folder / file, text);
}

int runDerive(const DeriveArguments& arguments) {
  const bool is_code = arguments.isCode(), is_program = arguments.isProgram();
  if (is_code && !arguments.output.empty())
    crosscheck::requireWritableFolder(arguments.output);
  else if (!is_code)
    crosscheck::requireWritableFile(arguments.output);
  if (!is_code && (arguments.scalar != "double" || !arguments.point.empty() ||
                   arguments.parameters != "folded"))
    throw scene::InputError({},
                            "--scalar, --point and --parameters are for code of given quantities, "
                            "allowed: --format c --quantity tau,qdd,...");
  using crosscheck::Command;
  const scene::Scene scene = readSceneFor(arguments.scene, arguments.solved());
  admit(scene, {arguments.operations ? Command::kDeriveOperations
                : is_code            ? Command::kDeriveCode
                : is_program         ? Command::kDerivePrograms
                                     : Command::kDerive});
  crosscheck::requireMotion(scene);
  if (const std::string option = arguments.ofReading(); !option.empty() && (is_program || is_code))
    throw scene::InputError(
        {}, fmt::format("{} with --format {}: programs are run and not read, allowed: --format "
                        "text, latex or html",
                        option, arguments.format));
  if (arguments.linearized && !symbolic::hasClosedForm(scene.mechanism))
    throw scene::InputError(
        {scene.file.string(), 0},
        fmt::format("--linearized of {} joints, allowed: up to three whose rates are derivatives; "
                    "dynwitness linearize has numbers",
                    scene.mechanism.dof()));
  if (is_code) {
    writeCode(arguments, scene);
    return 0;
  }
  DerivationText out;
  {
    const Progress progress("derivation of " + scene.name);
    if (arguments.operations) {
      out.text = operationsTable(scene);
    } else if (is_program) {
      if (!arguments.isAll())
        throw scene::InputError({},
                                fmt::format("--format sympy with --quantity {}: it is M, c, g and "
                                            "tau, allowed: --quantity all",
                                            fmt::join(arguments.quantities, ",")));
      const symbolic::Equations equations = symbolic::derive(scene.mechanism);
      out.text = arguments.format == "c" ? symbolic::emitC(equations, scene.mechanism, scene.name)
                 : arguments.format == "sympy"
                     ? symbolic::emitSympy(equations, scene.mechanism)
                     : symbolic::emitPython(equations, scene.mechanism, scene.name);
    } else {
      out = derivationText(scene, arguments.shown());
    }
  }
  if (arguments.output.empty())
    fmt::print("{}", out.text);
  else
    crosscheck::writeWholeFile(arguments.output, out.text);
  if (!out.holds) tellFailure("dynwitness: a step of the derivation does not hold\n");
  if (!out.problem.empty())
    tellFailure(fmt::format("dynwitness: read back from what is printed: {}\n", out.problem));
  else if (!out.proof.empty())
    tell(out.proof);
  return out.holds && out.problem.empty() ? 0 : 1;
}

}  // namespace

Run addDerive(CLI::App* command) {
  auto arguments = std::make_shared<DeriveArguments>();
  addScene(*command, arguments->scene, "Scene");
  command->footer(
      "Examples:\n"
      "  dynwitness derive \"double pendulum\"\n"
      "  dynwitness derive double_pendulum --only M12,c2 --substitute l1=1,l2=1 --rename q1=alpha\n"
      "  dynwitness derive puma_560 --format c --quantity tau,qdd,M,c,g -o puma\n"
      "  dynwitness derive puma_560 --format c --quantity tau,M --parameters struct -o puma\n"
      "  dynwitness derive puma_560 --format c --scalar float --quantity jacobian --point link_6\n\n"
      "--quantity all as c, python or sympy: M, c and g of the scene's named parameters, by T and V; "
      "sympy is a Python module of SymPy's expressions, tau among them. Any "
      "other list, --parameters struct, matlab and julia (there all is tau,qdd,M,c,g): code for a controller from "
      "the smallest programs (--operations), all numbers of the scene folded, or with --parameters "
      "struct under names, what depends on them alone computed once; into the folder -o, with a "
      "test of it beside it. What is written for C, Python, SymPy and MATLAB (by Octave) is run by this "
      "project's tests; Julia was never run here: Debian has no package of it. No allocation, no library but libm; friction and wrenches are "
      "in tau and qdd. Refused: closures, springs between points, joints that follow others, and "
      "what takes more operations than a straight line is good for.");
  command->add_option("--format", arguments->format, "How it is written")
      ->capture_default_str()
      ->check(oneOf({"text", "latex", "html", "c", "python", "sympy", "matlab", "julia"}));
  command
      ->add_option(
          "--quantity", arguments->quantities,
          "Quantities: whose steps are shown (M, c, g, all), or which functions code has: "
          "tau, qdd, M, C (Coriolis matrix), c, g, Y (regressor), dtau_dq, dtau_dqd, dqdd_dq, "
          "dqdd_dqd, dqdd_dtau (as evaluate has them), position, orientation, jacobian, "
          "jacobian_rate")
      ->capture_default_str()
      ->delimiter(',');
  command->add_option("--scalar", arguments->scalar, "Arithmetic: of code in C")
      ->capture_default_str()
      ->check(oneOf({"double", "float"}));
  command
      ->add_option(
          "--parameters", arguments->parameters,
          "Parameters: in code all numbers of the scene are folded, or fields of a struct that may be changed "
          "(masses, lengths, gravity, ...)")
      ->capture_default_str()
      ->check(oneOf({"folded", "struct"}));
  command
      ->add_option("--point", arguments->point,
                   "Of which points position, ..., jacobian_rate are: of this link, at x, y, z in "
                   "its axes [m] (without: its origin)")
      ->type_name("LINK[,x,y,z]");
  command
      ->add_flag("--operations", arguments->operations,
                 "How many operations the programs for ID, M, c, g and FD take, by each road")
      ->excludes("--format", "--quantity", "--scalar", "--parameters", "--point");
  command
      ->add_flag("--linearized", arguments->linearized,
                 "The equations of motion to first order, too: up to three joints")
      ->excludes("--operations", "--quantity");
  command
      ->add_option(
          "--only", arguments->only,
          "Entries to print: lines of the derivation, M12, c2, tau1 (an equation of motion), "
          "T, ..., or all of M, c, g, p, Gamma, tau, with the lines that they are made of")
      ->delimiter(',')
      ->excludes("--operations", "--quantity");
  command
      ->add_option("--substitute", arguments->substitutions,
                   "Parameters put in before anything is derived: numbers, which stay exact (1/3, "
                   "0), or expressions in the others (l2=l1); no body need be of such a mass")
      ->delimiter(',')
      ->type_name("NAME=VALUE,...")
      ->excludes("--operations");
  command
      ->add_option("--rename", arguments->names,
                   "What q1, q2, ... are called in formulas: theta, x_1; rates follow (theta_dot)")
      ->delimiter(',')
      ->type_name("q1=NAME,...")
      ->excludes("--operations");
  command
      ->add_option("--beside", arguments->beside,
                   "The same lines once more by the recursive Newton-Euler sweep, until both meet: "
                   "up to three joints")
      ->check(oneOf({"newton_euler"}))
      ->excludes("--operations", "--quantity");
  command
      ->add_flag(
          "--shorthand", arguments->shorthand,
          "Short names for cosines and sines of sums: c12 = cos(q1 + q2), s2m4 = sin(q2 - q4), "
          "with a legend")
      ->excludes("--operations");
  command
      ->add_flag("--no-checks", arguments->no_checks,
                 "What was checked is not printed; it is checked all the same, and what fails is "
                 "told")
      ->excludes("--operations");
  command
      ->add_flag("--proof", arguments->proof,
                 "Read the printed formulas back, and compare each exactly with what was derived: "
                 "text, latex and html")
      ->excludes("--operations");
  addOutput(*command, arguments->output,
            "file, of code for a controller a folder; without: standard output");
  return [arguments] { return runDerive(*arguments); };
}

}  // namespace dynwitness::cli
