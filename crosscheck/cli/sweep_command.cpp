// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness sweep: one pass out and one pass in, link by link, beside Lagrange's equations.
#include <cmath>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/findings.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/state_options.hpp"
#include "crosscheck/studies/given_values.hpp"
#include "crosscheck/studies/shown_sweep.hpp"
#include "crosscheck/system/files.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  GivenScene scene;
  std::string json, link;
  std::optional<StateOption> q, qd, qdd;
};

/// Six digits; what is below the digits of the numbers beside it is 0.
std::string number(double x, double beside) {
  // at most 12 characters, "-0.000123456", and a space; nor is it -0
  return fmt::format("{:>13.6g}", std::abs(x) <= 1e-14 * beside ? 0.0 : x);
}
std::string row(const Eigen::VectorXd& v) {
  const double beside = v.size() == 0 ? 0 : v.cwiseAbs().maxCoeff();
  std::string out;
  for (const double x : v) out += number(x, beside);
  return out;
}
void line(const std::string& name, const Eigen::VectorXd& v, const std::string& words) {
  fmt::print("    {:<8}{}   {}\n", name, row(v), words);
}
void matrix(const std::string& name, const Eigen::MatrixXd& m, const std::string& words) {
  const double beside = m.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    std::string text;
    for (Eigen::Index j = 0; j < m.cols(); ++j) text += number(m(i, j), beside);
    fmt::print("    {:<8}{}   {}\n", i == 0 ? name : "", text, i == 0 ? words : "");
  }
}

std::string nameOf(const ShownSweep& sweep, int link) {
  return link < 0 ? "the world" : sweep.links[static_cast<std::size_t>(link)].name;
}
/// "shoulder q 0.3", of all its rates.
std::string jointOf(const ShownSweep& sweep, const ShownLink& link) {
  std::string out = fmt::format("{} '{}'", link.kind, link.joint);
  for (std::size_t k = 0; k < link.rates.size(); ++k) {
    const std::size_t at = static_cast<std::size_t>(link.first_rate) + k;
    out += fmt::format("; {}: qd {:.6g}, qdd {:.6g}", link.rates[k], sweep.state.qd[at],
                       sweep.state.qdd[at]);
  }
  return out;
}

void printOutward(const ShownSweep& sweep, const ShownLink& link) {
  fmt::print("  {} on {} ({})\n", link.name, nameOf(sweep, link.parent), jointOf(sweep, link));
  matrix("R", link.R, "axes of the frame before to these");
  line("p", link.p, "its origin there [m]");
  for (Eigen::Index k = 0; k < link.Z.cols(); ++k)
    line(k == 0 ? "Z" : "", link.Z.col(k), k == 0 ? "axis of the joint, linear part first" : "");
  line("v", link.v, "= X v_p + Z qd [m/s, rad/s]");
  line("a", link.a, "= X a_p + Z qdd + v x Z qd [m/s^2, rad/s^2]");
  line("f own", link.own, "= M a + v x* M v, without what acts on it from outside [N, N m]");
}

void printInward(const ShownSweep& sweep, const ShownLink& link) {
  fmt::print("  {} to {} ({})\n", link.name, nameOf(sweep, link.parent),
             link.kind + " '" + link.joint + "'");
  line("f", link.f, "= f own + sum of X' f of what hangs on it: through the joint [N, N m]");
  for (std::size_t k = 0; k < link.rates.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const auto at = static_cast<Eigen::Index>(link.first_rate) + i;
    const std::string gyroscopic =
        link.gyroscopic(i) == 0 ? ""
                                : fmt::format(" + gyroscopic rotor ({:.6g})", link.gyroscopic(i));
    fmt::print(
        "    tau {} = Z'f ({:.6g}) + rotor ({:.6g}){} + springs, friction ({:.6g}) = {:.10g}\n",
        link.rates[k], link.Z_f(i), link.rotor(i) + 0.0, gyroscopic, link.passive(i) + 0.0,
        sweep.tau(at));
    std::string terms;
    for (Eigen::Index j = 0; j < sweep.M.cols(); ++j)
      if (const double m = sweep.M(at, j); m != 0)
        terms += fmt::format("{}{:.6g} qdd_{}",
                             terms.empty() ? (m < 0 ? "-" : "")
                             : m < 0       ? " - "
                                           : " + ",
                             std::abs(m), j + 1);
    fmt::print("      Lagrange: {} + c ({:.6g}) + g ({:.6g}){} = {:.10g}\n",
               terms.empty() ? "0" : terms, sweep.c(at), sweep.g(at),
               sweep.has_more ? " + friction - loads" : "", sweep.lagrange(at));
  }
}

void printArticulated(const ShownLink& link) {
  fmt::print("  {} ({} '{}')\n", link.name, link.kind, link.joint);
  matrix("M", link.M, "of the link");
  matrix("M_C", link.M_C, "composite: of all that hangs on it, joints locked");
  matrix("M_A", link.M_A, "articulated: of all that hangs on it, joints outboard free");
  if (link.rates.empty()) return;
  matrix("D", link.D, "= d + Z' M_A Z");
  matrix("P", link.P, "= 1 - M_A Z D^-1 Z': what the parent feels of a force");
  matrix("P M_A", link.P_M, "what the parent feels of the inertia: symmetric");
  fmt::print("    P P = P{} within {:.2g}; P M_A symmetric within {:.2g}\n",
             link.d != 0 ? " - M_A Z D^-1 d D^-1 Z' (its rotor)" : "", link.projector,
             link.asymmetry);
}

using cli::toJson;
Json toJson(const Eigen::VectorXd& v) {
  return std::vector<double>(v.data(), v.data() + v.size());
}

Json toJson(const ShownSweep& sweep) {
  std::vector<double> q;
  for (const auto& x : sweep.state.x) q.push_back(x.q);
  Json out{{"q", q},
           {"qd", sweep.state.qd},
           {"qdd", sweep.state.qdd},
           {"rates", sweep.rates},
           {"tau", toJson(sweep.tau)},
           {"tau_lagrange", toJson(sweep.lagrange)},
           {"qdd_articulated", toJson(sweep.qdd)},
           {"M", toJson(sweep.M)},
           {"c", toJson(sweep.c)},
           {"g", toJson(sweep.g)},
           {"a_0", toJson(Eigen::VectorXd(sweep.a_0))},
           {"links", Json::array()}};
  for (const ShownLink& link : sweep.links)
    out["links"].push_back({{"name", link.name},
                            {"joint", link.joint},
                            {"kind", link.kind},
                            {"on", nameOf(sweep, link.parent)},
                            {"rates", link.rates},
                            {"R", toJson(Eigen::MatrixXd(link.R))},
                            {"p", toJson(Eigen::VectorXd(link.p))},
                            {"Z", toJson(link.Z)},
                            {"M", toJson(Eigen::MatrixXd(link.M))},
                            {"M_C", toJson(Eigen::MatrixXd(link.M_C))},
                            {"v", toJson(Eigen::VectorXd(link.v))},
                            {"a", toJson(Eigen::VectorXd(link.a))},
                            {"f_own", toJson(Eigen::VectorXd(link.own))},
                            {"f", toJson(Eigen::VectorXd(link.f))},
                            {"M_A", toJson(Eigen::MatrixXd(link.M_A))},
                            {"D", toJson(link.D)},
                            {"P", toJson(Eigen::MatrixXd(link.P))},
                            {"P_M_A", toJson(Eigen::MatrixXd(link.P_M))},
                            {"projector_off", link.projector},
                            {"asymmetry", link.asymmetry}});
  return out;
}

/// Of a scene with a joint that moves no inertia: no articulated body passes it; "": it has none.
std::string whyNoInverse(const scene::Scene& scene) {
  try {
    scene::requireInertiaOfJoints(scene, "");
  } catch (const scene::InputError& why) {
    return why.what();
  }
  return "";
}

int run(const Arguments& arguments) {
  requireWritableFile(arguments.json);
  // written as JSON, every number of the sweeps is there
  const scene::Scene scene = admitted(
      arguments.scene, Command::kSweep,
      arguments.json.empty() ? scene::InertiaNeed::kOfNoJoint : scene::InertiaNeed::kOfEachJoint);
  requireMotion(scene);
  const std::string no_inverse = whyNoInverse(scene);
  scene::State<double> state;
  for (const double x : arguments.q->values(scene, inDouble(scene, scene.start_q)))
    state.x.push_back(scene::jointPosition(x));
  state.qd = arguments.qd->values(scene, inDouble(scene, scene.start_qd));
  state.qdd = arguments.qdd->values(scene, std::vector<double>(state.qd.size(), 0.0));
  std::optional<Progress> progress(std::in_place, 1, 1.0);
  progress->stage("sweeps of " + scene.name + ", and its derivation");
  const ShownSweep sweep = shownSweep(scene, state);
  progress.reset();
  requireFinite("tau", Eigen::MatrixXd(sweep.tau));
  if (no_inverse.empty()) requireFinite("qdd", Eigen::MatrixXd(sweep.qdd));

  const auto isShown = [&](const ShownLink& link) {
    return arguments.link.empty() || link.name == arguments.link || link.joint == arguments.link;
  };
  if (std::none_of(sweep.links.begin(), sweep.links.end(), isShown)) {
    std::vector<std::string> names;
    for (const ShownLink& link : sweep.links) names.push_back(link.name);
    throw scene::InputError({scene.file.string(), 0},
                            fmt::format("--link: no link or joint '{}', allowed: {}",
                                        arguments.link, fmt::join(names, ", ")));
  }
  fmt::print(
      "{}: each link in the axes of its moved joint frame, about its origin; linear part first\n",
      scene.name);
  std::string rates;
  for (std::size_t k = 0; k < sweep.rates.size(); ++k)
    rates += fmt::format("{}qdd_{} of {}", k == 0 ? "" : ", ", k + 1, sweep.rates[k]);
  fmt::print("\noutward: motion; a_0 ={} m/s^2 is - gravity\n", row(sweep.a_0.head<3>()));
  for (const ShownLink& link : sweep.links)
    if (isShown(link)) printOutward(sweep, link);
  fmt::print("\ninward: force, and the same line of Lagrange's equations\n  {}\n", rates);
  for (auto link = sweep.links.rbegin(); link != sweep.links.rend(); ++link)
    if (isShown(*link)) printInward(sweep, *link);
  if (!no_inverse.empty()) {
    fmt::print("\nno articulated inertia and no qdd: {}\n", no_inverse);
    return 0;
  }
  fmt::print("\ninward: inertia [kg, kg m, kg m^2]\n");
  for (auto link = sweep.links.rbegin(); link != sweep.links.rend(); ++link)
    if (isShown(*link)) printArticulated(*link);
  fmt::print("\nback: qdd of these tau by articulated bodies\n");
  for (std::size_t k = 0; k < sweep.rates.size(); ++k)
    fmt::print("    {:<12} {:.10g}, given {:.10g}\n", sweep.rates[k],
               sweep.qdd(static_cast<Eigen::Index>(k)), sweep.state.qdd[k]);
  if (!arguments.json.empty())
    writeWholeFile(arguments.json, findingsJson("sweep", scene, toJson(sweep), {}));
  return 0;
}

}  // namespace

Run addSweep(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  addScene(*command, arguments->scene, "Scene");
  arguments->q.emplace(command, StateOption::Part::kQ, "the scene's start");
  arguments->qd.emplace(command, StateOption::Part::kQd, "the scene's start");
  arguments->qdd.emplace(command, StateOption::Part::kQdd, "0");
  command->add_option("--link", arguments->link, "Link: this, or that of this joint, alone");
  addJson(*command, arguments->json);
  command->footer(
      "Example:\n"
      "  dynwitness sweep double_pendulum --q 0.3,0.4 --qd 1,2 --qdd 0.5,-0.5\n"
      "v, a, f, M_C, M_A, P and P M_A are what the sweeps themselves have computed, D is made of "
      "M_A;\nwhether they are right is what crosscheck asks. At many states: dynwitness evaluate.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
