// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness derive: the equations of motion from T and V, to be read or to be compiled.
#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/kernel/roads.hpp"
#include "crosscheck/kernel/shared_subtrees.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/scene.hpp"
#include "symbolic/derivation.hpp"
#include "symbolic/print.hpp"
#include "symbolic/read_back.hpp"

namespace dynwitness::cli {
namespace {

struct DeriveArguments {
  GivenScene scene;
  std::string output, format = "text", quantity = "all";
  bool operations = false, proof = false;
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

std::string htmlPage(const std::string& title, const std::string& body) {
  static constexpr const char* kStyle = R"(
body { font: 1rem/1.6 serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem }
summary { cursor: pointer }
.step { margin: 1.2rem 0 } .step > summary { font-weight: bold }
.equation { display: flex; align-items: center; gap: .6rem }
.equation math { font-size: 1.1em; overflow-x: auto; overflow-y: hidden; padding: .2rem 0; flex: 1 }
.equation button { font-size: .7rem; opacity: .6 }
.holds, .fails { font-size: .9rem } .fails { font-weight: bold }
@media print { .equation button, .holds { display: none } }
)";
  // a browser without a clipboard (a file opened from disk in some) shows no buttons
  static constexpr const char* kScript = R"(
if (navigator.clipboard) for (const line of document.querySelectorAll('.equation')) {
  const button = document.createElement('button');
  button.textContent = 'copy LaTeX';
  button.onclick = () => navigator.clipboard.writeText(line.dataset.latex);
  line.append(button);
}
)";
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<style>{2}</style></head>\n<body><h1>{0}</h1>\n{1}<script>{3}</script></body></html>\n",
      title, body, kStyle, kScript);
}

std::string latexDocument(const std::string& title, const std::string& body) {
  return fmt::format(
      "\\documentclass{{article}}\n"
      "\\usepackage[T1]{{fontenc}}\n\\usepackage[utf8]{{inputenc}}\n\\usepackage{{amsmath}}\n"
      "\\usepackage[a4paper, margin=25mm]{{geometry}}\n"
      "% an equation is a paragraph, so that long ones are broken at their signs\n"
      "\\newcommand{{\\hangpara}}{{\\hangindent=2em\\hangafter=1\\noindent\\hspace*{{1em}}}}\n"
      "\\binoppenalty=100 \\relpenalty=50 \\allowdisplaybreaks\n"
      "\\setlength{{\\parindent}}{{0pt}}\\setlength{{\\parskip}}{{0.4em}}\n"
      "\\title{{{0}}}\\date{{}}\n"
      "\\begin{{document}}\n\\maketitle\\raggedright\n{1}\\end{{document}}\n",
      title, body);
}

[[noreturn]] void refuseOnly(const std::string& quantity) {
  throw scene::InputError(
      {}, fmt::format("{}: the derivation of this scene is one program of named "
                      "intermediates, not a step a quantity; allowed: --quantity all, "
                      "or --format c or python",
                      quantity));
}

/// The steps that a quantity needs last: its own.
symbolic::Derivation only(symbolic::Derivation derivation, const std::string& quantity) {
  if (quantity == "all") return derivation;
  std::vector<symbolic::Step> kept;
  for (const symbolic::Step& step : derivation.steps)
    if (step.quantity == quantity) kept.push_back(step);
  if (kept.empty()) refuseOnly(quantity);
  derivation.steps = kept;
  return derivation;
}

int runDerive(const DeriveArguments& arguments) {
  crosscheck::requireWritableFile(arguments.output);
  const bool is_program = arguments.format == "c" || arguments.format == "python";
  using crosscheck::Command;
  const scene::Scene scene =
      admitted(arguments.scene, arguments.operations ? Command::kDeriveOperations
                                : is_program         ? Command::kDerivePrograms
                                                     : Command::kDerive);
  std::string text;
  bool holds = true;
  std::optional<symbolic::ReadBack> proof;
  std::optional<Progress> progress(std::in_place, "derivation of " + scene.name);
  if (arguments.operations) {
    text = operationsTable(scene);
  } else if (is_program) {
    if (arguments.proof)
      throw scene::InputError({},
                              "--proof: c and python are programs that tests run: allowed is "
                              "--format text, latex or html");
    if (arguments.quantity != "all")
      throw scene::InputError({}, "--quantity: programs compute all of M, c, g: allowed is 'all'");
    symbolic::Equations equations = symbolic::derive(scene.mechanism);
    text = arguments.format == "c" ? symbolic::emitC(equations, scene.mechanism, scene.name)
                                   : symbolic::emitPython(equations, scene.mechanism, scene.name);
  } else {
    if (arguments.quantity != "all" && !symbolic::hasClosedForm(scene.mechanism))
      refuseOnly(arguments.quantity);
    const symbolic::Derivation whole = symbolic::derivation(scene.mechanism);
    const symbolic::Style style = arguments.format == "html"    ? symbolic::Style::kMathml
                                  : arguments.format == "latex" ? symbolic::Style::kLatex
                                                                : symbolic::Style::kText;
    holds = whole.holds();
    const auto page = [&](const symbolic::Derivation& derivation) {
      const std::string body = symbolic::print(derivation, style);
      if (style == symbolic::Style::kText) return body;
      const std::string title = symbolic::printText(scene.title, style);
      return style == symbolic::Style::kMathml ? htmlPage(title, body) : latexDocument(title, body);
    };
    text = page(only(whole, arguments.quantity));
    if (arguments.proof) proof = symbolic::readBack(whole, page(whole), style);
  }
  progress.reset();
  if (arguments.output.empty())
    fmt::print("{}", text);
  else
    crosscheck::writeWholeFile(arguments.output, text);
  if (!holds) tell("dynwitness: a step of the derivation does not hold\n");
  if (proof && proof->problem.empty()) {
    tell(fmt::format(
        "read back from what is printed: {} formulas are what was derived, at {} random "
        "points modulo 2^61 - 1 (another formula passes with a chance below {:.0g})\n",
        proof->formulas, proof->points, symbolic::kReadBackChance));
  } else if (proof) {
    tell(fmt::format("dynwitness: read back from what is printed: {}\n", proof->problem));
    holds = false;
  }
  return holds ? 0 : 1;
}

}  // namespace

Run addDerive(CLI::App* command) {
  auto arguments = std::make_shared<DeriveArguments>();
  addScene(*command, arguments->scene, "Scene");
  command->add_option("--format", arguments->format, "How it is written")
      ->capture_default_str()
      ->check(oneOf({"text", "latex", "html", "c", "python"}));
  command->add_option("--quantity", arguments->quantity, "Quantities: whose steps are shown")
      ->capture_default_str()
      ->check(oneOf({"M", "c", "g", "all"}));
  command
      ->add_flag("--operations", arguments->operations,
                 "How many operations the programs for ID, M, c, g and FD take, by each road")
      ->excludes("--format", "--quantity");
  command
      ->add_flag("--proof", arguments->proof,
                 "Read the printed formulas back, and compare each exactly with what was derived: "
                 "text, latex and html")
      ->excludes("--operations");
  addOutput(*command, arguments->output, "file; without: standard output");
  return [arguments] { return runDerive(*arguments); };
}

}  // namespace dynwitness::cli
