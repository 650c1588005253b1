// SPDX-License-Identifier: GPL-3.0-or-later
// Guaranteed bounds of joint forces and other quantities over ranges of q, qd and qdd.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "crosscheck/reduction/trigonometric.hpp"
#include "scene/uncertain_parameters.hpp"

namespace dynwitness::crosscheck {

/** A quantity of the form

        f(q) + springs(q) + sum a_j(q) qdd_j + sum_{j<=k} c_jk(q) qd_j qd_k + friction_i(qd_i)

    which tau, M, c, g, T, V, T + V and reactions of a tree of turning and sliding joints all are;
    or qdd = M^-1 (tau - c - g - friction) (acceleration.hpp). */
struct EnvelopeQuantity {
  enum class Kind { kTau, kM, kC, kG, kT, kV, kEnergy, kReaction, kQdd };
  Kind kind = Kind::kTau;
  int i = 0, j = 0;  ///< of an entry; of a reaction: rate of its joint, and which of six

  std::string name() const;  ///< "tau_2", "M_1,2", "c_1", "g_2", "T", "reaction_3.fx", "qdd_1"
};

/// The parts of a quantity, friction and springs apart; the first is f(q). Not of qdd and
/// reactions.
std::vector<EnvelopePart> envelopeParts(const TrigonometricModel& model,
                                        const EnvelopeQuantity& quantity);

/// One state of the envelope.
struct EnvelopeState {
  std::vector<double> q, qd, qdd;
  std::vector<double> tau = {};  ///< where qdd is asked for
};

struct EnvelopeBound {
  EnvelopeQuantity quantity;
  double certified = 0;  ///< |x| is at most this everywhere in the envelope; infinite: not bounded
  double sampled = 0;    ///< |x| is at least this at `worst`, by the sweeps
  EnvelopeState worst;
  std::vector<bool> heavier;  ///< there, by weighing link (weighingLinks); none: as they are
  std::vector<bool> higher;   ///< there, by uncertain parameter: at its upper end
  double lost = 0;            ///< of `certified`: what roundings may make
  int boxes = 0;              ///< looked at
  /// certified <= ratio sampled, or 0 but for `lost`; otherwise the budget ended
  bool is_reached = false;

  double ratio() const;  ///< certified / sampled; infinite where nothing but 0 was seen
};

struct EnvelopeOptions {
  double ratio = 1.2;                             ///< of certified to sampled, asked for
  int boxes = 200000;                             ///< at most, a quantity
  std::vector<std::string> quantities = {"tau"};  ///< of kEnvelopeQuantities
  /// Every link that moves may be heavier or lighter by this share, as a whole: mass, first moment
  /// and inertia. All quantities but qdd are linear in these, so that the corners are exact.
  scene::Rational masses = 0;
  /// Parameters of the scene in which all quantities but qdd are of degree 1 (requireLinear): exact
  /// corners, too.
  std::vector<scene::UncertainParameter> parameters = {};
};

/// Whether what is asked about |x| follows from a bound and what was seen.
/// @param decide  as boundOfParts()
inline bool isKnown(double certified, double sampled, const EnvelopeOptions& options,
                    double decide) {
  return decide < 0 ? certified <= options.ratio * sampled
                    : certified <= decide || sampled > decide;
}

/// Several boxes, one after the other: a tube around a motion.
using EnvelopeBoxes = std::vector<std::vector<scene::JointRanges>>;

/** Between two rows of a file of states (StatesReader: q, qd, and qdd or tau) the smallest box that
    holds both, ranges of what a row has not being 0. A motion is bounded as far as it stays within
    these between its rows.
    @throws scene::InputError  as StatesReader; no qd, or of qdd and tau not what `quantities` need;
      no row */
EnvelopeBoxes boxesAlong(const std::filesystem::path& file, const scene::Scene& scene,
                         const std::vector<std::string>& quantities);

/// Indices of the links that move and have mass.
std::vector<std::size_t> weighingLinks(const scene::Mechanism& mechanism);

/// What can be asked for: tau, qdd, M, c, g, T, V, energy, reactions.
extern const std::vector<std::string> kEnvelopeQuantities;
/// All entries of what is asked for, in this order.
std::vector<EnvelopeQuantity> envelopeQuantities(int dof, const std::vector<std::string>& names);

/** Bounds of |tau_i|, and of what else is asked for, over the box of the envelope.

    A function f on a box is at most the largest of its values at the corners, plus sum_k w_k^2
    / 2 sup |d^2 f / dx_k^2|, w_k being half the width: the error of linear interpolation in one
    variable after the other. In qdd there is none, since tau is linear; in qd it is the
    diagonal of the quadratic form where that is negative. In q the supremum is bounded in the
    same way by its values at the corners and the fourth derivatives d^4 f / dq_k^2 dq_l^2,
    these by their coefficients. Boxes are halved, the one with the largest bound first, across
    the variable that adds most, until the ratio is reached or the budget is spent. Corners are
    states, so the largest that was seen there is what the sweeps are asked about.
    V is 0 where all masses lie at the world's origin and springs are at rest.
    @throws scene::InputError  as trigonometricModel(); no envelope or one of another size; qdd is
      asked for and the envelope has no tau */
std::vector<EnvelopeBound> envelopeBounds(const scene::Scene& scene,
                                          const std::vector<scene::JointRanges>& ranges,
                                          const EnvelopeOptions& options,
                                          const std::function<void(const std::string&)>& stage);

/** The same over several boxes, and over what links may weigh: the largest of all.
    @throws scene::InputError  as before; masses or parameters are uncertain, and qdd is asked for,
      or they are more than 10, links that move and parameters together; as requireLinear() */
std::vector<EnvelopeBound> envelopeBounds(const scene::Scene& scene, const EnvelopeBoxes& boxes,
                                          const EnvelopeOptions& options,
                                          const std::function<void(const std::string&)>& stage);

/** The same of a sum of parts, without springs and friction; `sampled` is what the parts say at
    `worst`, less the roundings, and no sweep is asked.
    @param decide  zero or more: ends as soon as it is known whether |x| <= decide everywhere, and
      no ratio is asked for */
EnvelopeBound boundOfParts(const TrigonometricModel& model,
                           const std::vector<scene::JointRanges>& ranges,
                           const EnvelopeQuantity& name, const std::vector<EnvelopePart>& parts,
                           const EnvelopeOptions& options, double decide = -1);

/// A quantity, ready to be bounded over boxes within the ranges that it was made for; corners that
/// several boxes share are asked once.
class BoundedQuantity {
 public:
  virtual ~BoundedQuantity() = default;
  /// Without `sampled`, which sweeps tell. @param decide  as boundOfParts()
  virtual EnvelopeBound over(const std::vector<scene::JointRanges>& box,
                             const EnvelopeOptions& options, double decide) = 0;
};
/// @param parts  of a reaction (reactionParts); others are those of the quantity
/// @param model, within  must outlive what is returned
std::unique_ptr<BoundedQuantity> boundedQuantity(const TrigonometricModel& model,
                                                 const std::vector<scene::JointRanges>& within,
                                                 const EnvelopeQuantity& quantity,
                                                 const std::vector<EnvelopePart>& parts);
/// The smallest box that holds all of these.
std::vector<scene::JointRanges> hullOf(const EnvelopeBoxes& boxes);

/// The quantity at one state by the sweeps of recursive/: value, and what rounding may have lost.
RunningError sweptQuantity(const scene::Scene& scene, const EnvelopeQuantity& quantity,
                           const EnvelopeState& state);

/// For people, and for programs (crosscheck/reduction/envelope.schema.json).
std::string envelopeText(const scene::Scene& scene, const std::vector<EnvelopeBound>& bounds,
                         const EnvelopeOptions& options);
std::string envelopeJson(const scene::Scene& scene, const EnvelopeBoxes& boxes,
                         const std::vector<EnvelopeBound>& bounds, const EnvelopeOptions& options,
                         const std::string& version);

}  // namespace dynwitness::crosscheck
