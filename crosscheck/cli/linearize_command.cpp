// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness linearize: A, B, modes, stability and what forces reach, near a state.
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/findings.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/shown_derivation.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/cli/state_options.hpp"
#include "crosscheck/studies/given_values.hpp"
#include "crosscheck/studies/linear_letters.hpp"
#include "crosscheck/studies/linearization.hpp"
#include "crosscheck/system/files.hpp"
#include "symbolic/read_back.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

constexpr int kMostShown = 4;  // joints whose A and B are printed

struct Arguments {
  GivenScene scene;
  std::string json;
  bool is_symbolic = false;
  std::string format = "text", output;  ///< of what is symbolic
  std::optional<StateOption> q, qd;
  LinearizationOptions options;
};

void print(const char* name, const char* what, const Eigen::MatrixXd& m) {
  fmt::print("{:<12} {}\n", name, what);
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    fmt::print("  ");
    for (Eigen::Index j = 0; j < m.cols(); ++j) fmt::print(" {:>12.6g}", m(i, j));
    fmt::print("\n");
  }
}

/// One line stands for a pair of conjugates.
bool isSecondOfPair(const EnclosedModes& all, const EnclosedMode& mode) {
  return all.are_simple && !mode.is_real && mode.value.imag() < 0;
}

/// "3.13 Hz, damping 0.1", "time constant 0.5 s", "doubles in 0.2 s"
std::string wordsOf(const EnclosedMode& mode) {
  if (!std::isfinite(mode.radius_re)) return "";
  constexpr double kTurn = 2 * 3.14159265358979323846;
  const double re = mode.value.real(), im = std::abs(mode.value.imag());
  std::string out;
  if (im > mode.radius_im) {
    out = fmt::format("{:.6g} Hz", im / kTurn);
    if (std::abs(re) > mode.radius_re)
      out += fmt::format(", damping ratio {:.4g}", -re / std::abs(mode.value));
    return out;
  }
  if (std::abs(re) <= mode.radius_re) return mode.radius_re == 0 ? "drifts" : "0 within its radius";
  return re < 0 ? fmt::format("fades, time constant {:.6g} s", -1 / re)
                : fmt::format("grows, doubles in {:.6g} s", std::log(2) / re);
}

/// The joints that move in it, of positions alone; the largest 1.
std::string shapeOf(const EnclosedMode& mode, const Eigen::MatrixXd& along,
                    const std::vector<std::string>& names) {
  constexpr double kLeast = 0.005;  // of the largest
  const auto n = static_cast<Eigen::Index>(names.size());
  if (mode.right.size() == 0) return "";
  const Eigen::VectorXcd q = along * mode.right.head(along.cols());
  Eigen::Index largest = 0;
  const double most = q.cwiseAbs().maxCoeff(&largest);
  if (!(most > 0)) return "";
  std::string out;
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::complex<double> part = q(i) / q(largest);
    if (std::abs(part) < kLeast) continue;
    out += out.empty() ? "" : ", ";
    out += std::abs(part.imag()) < kLeast
               ? fmt::format("{} {:.3g}", names[static_cast<std::size_t>(i)], part.real())
               : fmt::format("{} {:.3g}{:+.3g}i", names[static_cast<std::size_t>(i)], part.real(),
                             part.imag());
  }
  return out;
}

void printModes(const Linearization& at, const std::vector<std::string>& names) {
  if (!at.modes.failure.empty())
    fmt::print("modes        eigenvalues of A [1/s], where no radius stands approximations: {}\n",
               at.modes.failure);
  else
    fmt::print("modes        eigenvalues of A [1/s], enclosed{}\n",
               at.modes.are_simple ? "" : "; some are multiple, or too near to tell");
  for (const EnclosedMode& mode : at.modes.modes) {
    if (isSecondOfPair(at.modes, mode)) continue;
    const double im = mode.value.imag();
    const bool is_pair = at.modes.are_simple && !mode.is_real;
    // of an approximation: below its digits that are shown
    const double least =
        std::isfinite(mode.radius_re) ? mode.radius_re : 1e-9 * std::abs(mode.value);
    const bool may_be_0 = std::abs(mode.value.real()) <= least;
    fmt::print("   {:>13.9g}{} {}   {}\n", may_be_0 ? 0 : mode.value.real(),
               im == 0 ? std::string(16, ' ')
                       : fmt::format(" {} {:<12.9g}i",
                                     is_pair  ? "+-"
                                     : im < 0 ? "- "
                                              : "+ ",
                                     std::abs(im)),
               boundText(std::max(mode.radius_re, mode.radius_im)), wordsOf(mode));
    if (const std::string shape = shapeOf(mode, at.along, names); !shape.empty())
      fmt::print("                 moves {}\n", shape);
    if (mode.reached.size() > 0 && !(mode.reached.maxCoeff() > 0))
      fmt::print("                 not seen to be reached by the actuated joints\n");
  }
}

std::vector<std::string> chosen(const std::vector<std::string>& names, const std::vector<int>& of) {
  std::vector<std::string> out;
  for (const int i : of) out.push_back(names[static_cast<std::size_t>(i)]);
  return out;
}

/// What may be 0 is written so.
std::vector<double> zeroWithin(const Bounded& v) {
  std::vector<double> out;
  for (Eigen::Index i = 0; i < v.value.size(); ++i)
    out.push_back(std::abs(v.value(i)) <= v.bound(i) ? 0 : v.value(i));
  return out;
}

/// Whether (dq, dqd) of A are those of all rates.
bool isOfAllRates(const Linearization& at, int n) {
  return static_cast<int>(at.positions.size()) == n && static_cast<int>(at.rates.size()) == n;
}

void printMatrices(const Linearization& at, const std::vector<std::string>& names) {
  const int n = static_cast<int>(names.size()), r = static_cast<int>(at.rates.size()),
            p = static_cast<int>(at.positions.size());
  if (!isOfAllRates(at, n))
    fmt::print("independent  dq of {}; dqd of {}: the others' follow\n",
               fmt::join(chosen(names, at.positions), ", "),
               fmt::join(chosen(names, at.rates), ", "));
  if (p > kMostShown || r > kMostShown) return;
  if (at.positions == at.rates) {
    print("dqdd/dq", "", at.A.value.bottomLeftCorner(r, p));
    print("dqdd/dqd", "", at.A.value.bottomRightCorner(r, r));
  } else {
    print("A", "", at.A.value);
  }
  print("dqdd/dtau", "", at.B.value.bottomRows(r));
}

using cli::toJson;
Json toJson(double radius) {
  return std::isfinite(radius) ? Json(radius) : Json("inf");
}

/** What is 0 or a right angle is put in; of an equilibrium that was found also what is as near to
    one as Newton's steps come, if joint forces are 0 there whatever the parameters are. */
symbolic::LinearSystem lettersAt(const scene::Scene& scene, const LinearizationOptions& options,
                                 const Linearization& at) {
  const bool is_unaccelerated = at.rests || !options.has_no_forces;
  const auto letters = [&](double near) {
    return symbolic::linearSystem(
        scene.mechanism, symbolic::putIn(scene.mechanism, at.q, at.qd, is_unaccelerated, near),
        at.actuated);
  };
  if (options.seeks_equilibrium) {
    const double near = std::sqrt(std::numeric_limits<double>::epsilon());
    symbolic::LinearSystem found = letters(near);
    if (found.is_forceless) return found;
  }
  return letters(0);
}

int showLetters(const Arguments& arguments, const scene::Scene& scene, const Linearization& at,
                std::optional<Progress>& progress) {
  progress->stage("A and B in letters");
  symbolic::LinearSystem letters;
  try {
    letters = lettersAt(scene, arguments.options, at);
  } catch (const std::domain_error& why) {
    throw scene::InputError(
        {scene.file.string(), 0},
        fmt::format("--symbolic: {}, allowed: states that have an answer", why.what()));
  }
  const symbolic::Derivation& shown = letters.derivation;
  const symbolic::Style style = styleOf(arguments.format);
  DocumentParts parts;
  parts.summary = "Motion near a state to first order, derived from kinetic and potential energy.";
  scene::Scene drawn = scene;  // where it is linearized
  drawn.start_q.clear();
  for (const double q : at.q)
    drawn.start_q.push_back(scene::Number::parse(fmt::format("{}", q == 0 ? 0.0 : q)));
  const std::string text = derivationDocument(drawn, shown, style, parts);
  const symbolic::ReadBack read = symbolic::readBack(shown, text, style);
  const std::vector<CheckResult> checks = checkLettersExactly(scene, letters);
  progress.reset();
  const bool is_page = style != symbolic::Style::kText && arguments.output.empty();
  if (arguments.output.empty())
    fmt::print("{}", text);
  else
    writeWholeFile(arguments.output, text);
  bool disagree = false;
  for (const CheckResult& check : checks) {
    disagree = disagree || check.verdict == Verdict::kDisagree;
    if (is_page && check.verdict != Verdict::kAgree)
      tellFailure(
          fmt::format("dynwitness: {}: {}: {}\n", check.name(), name(check.verdict), check.reason));
  }
  if (!is_page) printFindings(checks);
  if (arguments.options.has_no_forces && !at.rests)
    tell(fmt::format("{}: it does not rest there: qdd are those that joint forces of 0 give\n",
                     scene.name));
  if (!shown.holds()) tellFailure("dynwitness: a step of the derivation does not hold\n");
  if (!read.problem.empty())
    tellFailure(fmt::format("dynwitness: read back from what is printed: {}\n", read.problem));
  return disagree || !shown.holds() || !read.problem.empty() ? 1 : 0;
}

int run(Arguments arguments) {
  requireWritableFile(arguments.json);
  requireWritableFile(arguments.output);
  if (!arguments.is_symbolic && (arguments.format != "text" || !arguments.output.empty()))
    throw scene::InputError({}, "--format and --output are for --symbolic, allowed: --json FILE");
  const scene::Scene scene = admitted(arguments.scene, Command::kLinearize);
  if (arguments.is_symbolic) requireLetters(scene);
  LinearizationOptions& options = arguments.options;
  options.q = arguments.q->values(scene, inDouble(scene, scene.start_q));
  if (arguments.qd->isGiven()) options.qd = arguments.qd->values(scene, restingRates(scene));
  if (options.seeks_equilibrium && arguments.qd->isGiven())
    throw scene::InputError({}, "--qd with --equilibrium, allowed: one of them");
  if (options.seeks_equilibrium && options.has_no_forces)
    throw scene::InputError({},
                            "--free with --equilibrium, which seeks none, allowed: one of them");
  std::optional<Progress> progress(std::in_place, 2, 1.0);
  progress->stage("linearization of " + scene.name);
  const Linearization at = linearize(scene, options);
  for (const auto& [what, m] : {std::pair{"A", &at.A}, {"B", &at.B}}) {
    requireFinite(what, m->value);
    requireFinite(what, m->bound);
  }
  if (arguments.is_symbolic) return showLetters(arguments, scene, at, progress);
  progress->stage("exact checks");
  std::vector<CheckResult> checks = checkLinearizationExactly(scene, {});
  if (at.by_lagrange) checks.push_back(*at.by_lagrange);
  progress.reset();

  const std::vector<std::string> names = scene.mechanism.rateLabels();
  fmt::print(
      "{}: d/dt (dq, dqd) = A (dq, dqd) + B dtau{}\n", scene.name,
      at.newton_steps > 0 ? fmt::format(", equilibrium found in {} steps", at.newton_steps) : "");
  fmt::print("q            {:.10g}\n", fmt::join(at.q, ", "));
  const bool moves = std::any_of(at.qd.begin(), at.qd.end(), [](double v) { return v != 0; });
  if (moves) fmt::print("qd           {:.10g}\n", fmt::join(at.qd, ", "));
  const std::vector<double> tau = zeroWithin(at.tau);
  fmt::print("tau          {:.10g}\n", fmt::join(tau, ", "));
  if (!at.rests)
    fmt::print("qdd          {:.10g}   it does not stay there: A and its modes are of the moment\n",
               fmt::join(zeroWithin(at.qdd), ", "));
  printMatrices(at, names);
  printModes(at, names);
  fmt::print("stability    {}\n", name(at.stability));
  const std::vector<std::string> actuated = chosen(names, at.actuated);
  const int size = static_cast<int>(at.A.value.rows());
  fmt::print("control      forces of {} reach {} of {} dimensions{}\n", fmt::join(actuated, ", "),
             at.reached, size,
             at.reached == size ? ": controllable" : " at least; more is not proven");
  const int status = printFindings(checks);
  if (!arguments.json.empty()) {
    Json json{{"q", at.q},
              {"qd", at.qd},
              {"tau", toJson(at.tau)},
              {"qdd", toJson(at.qdd)},
              {"A", toJson(at.A)},
              {"B", toJson(at.B)},
              {"independent_positions", chosen(names, at.positions)},
              {"independent_rates", chosen(names, at.rates)},
              {"actuated", actuated},
              {"reached_dimension", at.reached},
              {"rests", at.rests},
              {"stability", name(at.stability)},
              {"modes", Json::array()}};
    for (const EnclosedMode& mode : at.modes.modes) {
      Json one{{"re", mode.value.real()},
               {"im", mode.value.imag()},
               {"radius_re", toJson(mode.radius_re)},
               {"radius_im", toJson(mode.radius_im)},
               {"is_real", mode.is_real},
               {"is_simple", at.modes.are_simple}};
      if (mode.right.size() > 0) {
        one["vector_re"] = std::vector<double>();
        one["vector_im"] = std::vector<double>();
        for (const std::complex<double>& x : mode.right) {
          one["vector_re"].push_back(x.real());
          one["vector_im"].push_back(x.imag());
        }
        one["reached_at_least"] =
            std::vector<double>(mode.reached.data(), mode.reached.data() + mode.reached.size());
      }
      json["modes"].push_back(std::move(one));
    }
    if (!at.modes.failure.empty()) json["why_not_enclosed"] = at.modes.failure;
    writeWholeFile(arguments.json, findingsJson("linearize", scene, json, checks));
  }
  return status;
}

}  // namespace

Run addLinearize(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  LinearizationOptions& options = arguments->options;
  addScene(*command, arguments->scene, "Scene");
  arguments->q.emplace(command, StateOption::Part::kQ, "the scene's start");
  arguments->qd.emplace(command, StateOption::Part::kQd, "at rest");
  command->add_flag("--equilibrium", options.seeks_equilibrium,
                    "Go from there to where it is at rest without joint forces");
  command->add_flag("--free", options.has_no_forces,
                    "No joint forces (default: those that make qdd 0)");
  command
      ->add_option("--actuated", options.actuated, "Joints whose forces are at hand (default: all)")
      ->delimiter(',');
  command
      ->add_flag("--symbolic", arguments->is_symbolic,
                 "A and B in letters instead, from T and V: trees of up to three joints. Angles of "
                 "whole right angles and what is 0 are put in, other q, qd stay letters")
      ->excludes(addJson(*command, arguments->json));
  command->add_option("--format", arguments->format, "How it is written: letters with --symbolic")
      ->capture_default_str()
      ->check(oneOf({"text", "latex", "html"}));
  addOutput(*command, arguments->output, "file, of --symbolic; without: standard output");
  command->footer(
      "Examples:\n"
      "  dynwitness linearize acrobot --q pi,0 --actuated elbow\n"
      "  dynwitness linearize double_pendulum --equilibrium --q 0.3,-0.2\n"
      "  dynwitness linearize bead_on_hoop --equilibrium --q 0,1\n"
      "  dynwitness linearize cart_pole --symbolic --q 0,0 --actuated slide\n"
      "  dynwitness linearize double_pendulum --symbolic --format html -o near.html\n"
      "Under closures and drives A is about as many coordinates as are left; driven joints are where\n"
      "their motions put them at t = 0 (no --q, --qd says otherwise), and q and qd are moved onto the closures.\n"
      "Entries and eigenvalues are enclosed in balls; the derivatives' laws are checked over a "
      "prime field\n"
      "for every state. What --symbolic prints is read back, and compared with dual numbers in the "
      "sweeps for all\n"
      "values of its letters, over a prime field. Exit status 1: one fails.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
