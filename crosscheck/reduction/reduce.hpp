// SPDX-License-Identifier: GPL-3.0-or-later
// Smaller models whose joint forces stay near the scene's over an envelope, guaranteed; which one
// is the smallest nobody proves.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "crosscheck/reduction/envelope.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck {

/// What is promised to be near the scene's.
enum class ReducedQuantity {
  kTau,  ///< forces for q, qd, qdd
  kQdd   ///< accelerations for q, qd, tau
};
/// "tau", "qdd"
const char* name(ReducedQuantity quantity);

/// An inertial parameter that a reduced scene has not.
struct DroppedParameter {
  std::string what;  ///< "link_6: its products of inertia"
  /// The most that dropping it, after those before it in the list, changes any tau_i, or qdd_i, at
  /// sampled states, as a share of its largest: why it was chosen, no bound.
  double sampled = 0;
};

/// A term that is added to the reduced scene's tau_i: coefficient x functions of the joints x what
/// it is multiplied by.
struct KeptTerm {
  int i = 0, j = -1, k = -1;  ///< of tau_i; j, k as in EnvelopePart
  Monomial monomial = 0;
  double coefficient = 0;
};

/// A function of q in tau_i that is another one, or none, in the reduced model.
struct ChangedTerm {
  int i = 0, j = -1, k = -1;
  bool is_dropped = false;  ///< the reduced model has nothing in its place
  double share = 0;  ///< it changes tau_i by at most this share of the largest |tau_i|, proven

  std::string name() const;  ///< "c_2,4,5", "M_1,2", "g_3"
};

/// What becomes of one joint's force, or of its acceleration: tau_i below is qdd_i then.
struct ReducedForce {
  double largest = 0;   ///< |tau_i| is at least this somewhere in the envelope (sweeps)
  double at_most = 0;   ///< |tau_i - reduced tau_i| is at most this everywhere
  double at_least = 0;  ///< and at least this at `worst`: sweeps against the program, rounding off
  EnvelopeState worst;

  double share() const { return largest > 0 ? at_most / largest : 0; }
};

/** A smaller model: a scene with fewer inertial parameters, and terms that are added to its tau.
    Its errors are those of exact arithmetic; a program of it in double rounds as any other. */
struct ReducedModel {
  double allowed = 0;  ///< asked for
  scene::Scene scene;  ///< has a model of its own where no terms are added
  std::vector<DroppedParameter> parameters;
  bool is_explicit = false;  ///< no inertial parameter is left: all is in the terms
  std::vector<KeptTerm> terms;
  std::vector<ChangedTerm> changed;  ///< the largest first
  std::vector<ReducedForce> forces;
  symbolic::Program program;  ///< tau of q, qd, qdd; or qdd of q, qd, tau

  double share() const;  ///< the largest of the joints'
  int operations() const { return program.bodyOperations().all(); }
};

struct Reduction {
  ReducedQuantity of = ReducedQuantity::kTau;
  symbolic::Program full;            ///< the scene's own smallest program of tau, or of qdd
  std::vector<ReducedModel> models;  ///< one an allowed error: the fewest operations found
  std::vector<ReducedModel>
      scenes;  ///< one an allowed error: without terms, so a scene and no more
  std::vector<ReducedModel>
      by_rule;  ///< Armstrong's, if asked for; as it stands, nothing certified
                ///< beforehand
};

struct ReduceOptions {
  ReducedQuantity of = ReducedQuantity::kTau;
  std::vector<double> allowed = {0.01};  ///< shares of the largest |tau_i|, or |qdd_i|, ascending
  double armstrong = 0;                  ///< also his rule with this share; 0: not
  int boxes = 20000;                     ///< at most, for the error of one joint's force in the end
  bool adds_terms = true;                ///< false: scenes alone, in a fifth of the time
};

/** Looks for models of fewer operations with |tau_i - reduced tau_i| <= allowed x max |tau_i| for
    every joint i and all q, qd, qdd of the envelope. Of the largest |tau_i| the value that the
    sweeps find at the worst state is taken, so that the promise is on the safe side.

    Parameters are dropped one after the other, the one first that changes sampled forces least.
    After some of them the difference D to the scene's tau, a polynomial again, is taken apart in
    its monomials: the smallest of them are left out, as many as the bound of all that is left out
    together allows, and the others are added to the reduced scene's sweep. So errors that cancel
    do, and none counts twice. Samples choose the order; what is promised is bounded by
    boundOfParts() alone.

    Of qdd (reduced_acceleration.hpp) the models are scenes without terms.
    @throws scene::InputError  as envelopeBounds(); an allowed error within roundings; Coulomb
    friction,
      which programs have no sign for; of qdd: no range of tau, no bound of qdd, Armstrong's rule */
Reduction reduced(const scene::Scene& scene, const std::vector<scene::JointRanges>& ranges,
                  const ReduceOptions& options,
                  const std::function<void(const std::string&)>& stage);

/// For people; programs (crosscheck/reduction/reduce.schema.json); C.
std::string reductionText(const scene::Scene& scene, const Reduction& reduction);
std::string reductionJson(const scene::Scene& scene, const Reduction& reduction,
                          const std::string& version);
std::string reductionC(const scene::Scene& scene, const ReducedModel& model, ReducedQuantity of);
/// `allowed,operations,certified,seen,scene_operations,scene_certified`, shares of the largest
/// |tau_i|, or |qdd_i|.
std::string frontCsv(const scene::Scene& scene, const Reduction& reduction);

}  // namespace dynwitness::crosscheck
