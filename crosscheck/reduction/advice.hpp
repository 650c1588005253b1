// SPDX-License-Identifier: GPL-3.0-or-later
// Which model, integrator, step and arithmetic together make a scene's motion at least cost for an
// error.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/reduction/envelope.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// The scene, or a smaller one that reduced() found.
struct AdvisedModel {
  double allowed = 0;      ///< what `reduce --tolerance` was given; 0: the scene itself
  double force_error = 0;  ///< proven over the envelope, share of each joint's largest |tau|
  scene::Scene scene;
  /// Of a call of its qdd: multiplications, additions, divisions, comparisons, cosines and sines.
  int operations = 0;
  int lane_operations = 0;  ///< the same of a call of its kernel, on vectors
  double end_error = 0;     ///< how far its motion ends from the scene's [rad, m, rad/s, m/s]
  std::string why_not;      ///< it is no candidate; "": it is

  std::string name() const;  ///< "full", "within 1 %"
};

enum class AdvisedScalar {
  kFloat,
  kDouble,
  kLanes  ///< double, several motions side by side in the lanes of vectors
};
/// "float", "double", "lanes"
const char* name(AdvisedScalar scalar);

/** One way to move the scene. Errors are of the end [rad, m, rad/s, m/s], the largest of all
    coordinates; by the triangle inequality their sum bounds that of the whole. */
struct AdvisedCandidate {
  std::size_t model = 0;  ///< of Advice::models
  std::string method;
  AdvisedScalar scalar = AdvisedScalar::kDouble;
  long steps = 0;             ///< equal ones; 0: none was found
  double step = 0;            ///< [s]
  double calls = 0;           ///< of qdd, a simulated second
  double operations = 0;      ///< the same, in operations
  double seconds = 0;         ///< of CPU, the same, fastest of some runs; 0: not measured
  double model_error = 0;     ///< of the model's motion by the finest steps
  double step_error = 0;      ///< against that motion, by sweeps in long double
  double rounding_error = 0;  ///< of the code in `scalar` against the same steps in long double
  std::string why_not;        ///< "": it keeps the error, and the time

  double error() const { return model_error + step_error + rounding_error; }
};

/// Error against cost of a model and arithmetic by its best method, over steps.
struct AdvisedCurve {
  std::size_t candidate;  ///< of Advice::candidates, whose step is within it
  struct Point {
    double operations, error;  ///< a simulated second; of the end, all in all
  };
  std::vector<Point> points;
};

struct Advice {
  double error = 0, duration = 0;
  double time_budget = 0;  ///< [s of CPU a simulated second]; 0: none
  long motions = 1;        ///< side by side; costs are those of one of them
  int lanes = 0;           ///< of the kernel; 0: not asked for, or none
  std::string no_lanes;    ///< why there are none where there are several motions
  double known_to = 0;     ///< how far the reference may be off
  /// The end moves by so many times what one coordinate of the start is off by, at most.
  double growth = 0;
  std::string no_reduction;  ///< why there is only the full model; "": there are others
  std::string
      leaves;  ///< "qdd of rate 2 at 0.3 s": where the motion leaves the envelope; "": it does not
  std::vector<AdvisedModel> models;          ///< the scene first
  std::vector<AdvisedCandidate> candidates;  ///< the cheapest first
  std::optional<std::size_t> chosen;         ///< of candidates: the first without `why_not`
  std::vector<AdvisedCurve> curves;
};

struct AdviceOptions {
  double error = 0;                  ///< of the end, all coordinates [rad, m, rad/s, m/s]
  double duration = 10;              ///< [s]
  double time_budget = 0;            ///< [s of CPU a simulated second]; 0: none
  long motions = 1;                  ///< side by side: of several, lanes are a candidate
  std::vector<std::string> methods;  ///< explicit ones; empty: all
  bool draws = false;                ///< also the curves
};

/// Integrators that ask for qdd alone and solve no equations.
std::vector<std::string> explicitMethods();

/** The cheapest combination of

        model       the scene, and where `ranges` are given the scenes without terms that reduced()
                    certifies, allowed to be off by 1e-6 to 0.1
        integrator  explicit, with equal steps: the largest that leaves a tenth of the error to
                    roundings (accurateStep())
        arithmetic  qdd as C code in float or in double (CodeMotion); of several motions side by
                    side also the kernel in lanes (LaneMotion), at its share of a vector's cost

    whose error of the end is at most `options.error`. Cost is counted: calls of qdd a simulated
    second times its operations, integrators' own sums apart; of equal ones float is the cheaper.
    Certified is what joint forces miss by a smaller model, in the envelope; the errors of the end
    are measured, part by part, against runge_kutta_fehlberg78 in long double.
    @param ranges  the scene's envelope; empty: it has none
    @throws scene::InputError  an error within the roundings of double; a motion that makes so much
      of them, or whose end is not known that well (it is chaotic); no code, no C compiler; what
      requireTreated() refuses */
Advice adviceFor(const scene::Scene& scene, const std::vector<scene::JointRanges>& ranges,
                 const AdviceOptions& options,
                 const std::function<void(const std::string&)>& stage);

/// For people; programs (crosscheck/reduction/advise.schema.json); gnuplot:
/// `curve,operations,error`.
/// @param words  the scene as the command line has it
std::string adviceText(const scene::Scene& scene, const Advice& advice, const std::string& words);
std::string adviceJson(const scene::Scene& scene, const Advice& advice, const std::string& words,
                       const std::string& version);
/// The commands that do what is advised, one a line; none: nothing is.
std::vector<std::string> advisedCommands(const scene::Scene& scene, const Advice& advice,
                                         const std::string& words);
std::string adviceCsv(const Advice& advice);
/// What its curve is called there.
std::string curveName(const Advice& advice, const AdvisedCandidate& candidate);

}  // namespace dynwitness::crosscheck
