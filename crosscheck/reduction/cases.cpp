// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds over several boxes and over what links may weigh.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "crosscheck/inputs/states_file.hpp"
#include "crosscheck/reduction/acceleration.hpp"
#include "crosscheck/reduction/envelope.hpp"
#include "crosscheck/reduction/uncertainty.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::JointRanges;
using Kind = EnvelopeQuantity::Kind;

constexpr std::size_t kMostUncertain = 10;  ///< 1024 scenes

bool isAsked(const std::vector<EnvelopeQuantity>& quantities, Kind kind) {
  return std::any_of(quantities.begin(), quantities.end(),
                     [&](const EnvelopeQuantity& quantity) { return quantity.kind == kind; });
}

void requireAnswerable(const scene::Scene& scene, const EnvelopeBoxes& boxes,
                       const std::vector<EnvelopeQuantity>& quantities,
                       const EnvelopeOptions& options) {
  const auto refuse = [&](const std::string& what) {
    throw scene::InputError({scene.file.string()}, what);
  };
  const auto n = static_cast<std::size_t>(scene.mechanism.dof());
  if (boxes.empty() || boxes.front().size() != n)
    refuse(
        "no [envelope], allowed: a scene whose file gives ranges of q, qd and qdd for every joint "
        "(data/scenes/README.md)");
  for (std::size_t k = 0; isAsked(quantities, Kind::kQdd) && k < n; ++k)
    if (!boxes.front()[k].tau)
      refuse("qdd: [envelope] has no tau of joint '" + scene.mechanism.rateLabels()[k] +
             "', allowed: tau = [lowest, highest] of every joint");
  const bool is_mass = options.masses != scene::Rational(0);
  if (!is_mass && options.parameters.empty()) return;
  const char* const what = is_mass ? "masses" : "parameters";
  if (isAsked(quantities, Kind::kQdd))
    refuse(
        fmt::format("qdd with uncertain {}: it is not linear in them, allowed: all other "
                    "quantities",
                    what));
  requireLinear(scene, options.parameters);
  const std::size_t links = is_mass ? weighingLinks(scene.mechanism).size() : 0;
  const std::size_t all = links + options.parameters.size();
  if (all <= kMostUncertain) return;
  if (links == 0)
    refuse(fmt::format("{} uncertain parameters, allowed: up to {}", all, kMostUncertain));
  refuse(
      fmt::format("uncertain masses of {} links and {} uncertain parameters, allowed: up to {} "
                  "together",
                  links, options.parameters.size(), kMostUncertain));
}

/// Each number of a link's mass and inertia times a factor; its centre of mass stays.
void scale(const scene::Rational& factor, scene::MassProperties* m) {
  const auto times = [&](scene::Number* x) {
    if (!x->isLiteralZero())
      *x = scene::Expression::parse("(" + x->text() + ")*(" + scene::Expression(factor).text() +
                                    ")");
  };
  for (scene::Number* x : {&m->mass, &m->xx, &m->yy, &m->zz, &m->xy, &m->xz, &m->yz}) times(x);
}

/// Bounds of one scene over several boxes, taken into those of others.
class OneScene {
 public:
  OneScene(const scene::Scene& scene, const EnvelopeBoxes& boxes, const EnvelopeOptions& options,
           std::vector<bool> heavier, std::vector<bool> higher)
      : scene_(scene),
        boxes_(boxes),
        options_(options),
        heavier_(std::move(heavier)),
        higher_(std::move(higher)),
        hull_(hullOf(boxes)),
        model_(trigonometricModel(scene)) {}

  void take(const EnvelopeQuantity& quantity, bool is_first, EnvelopeBound* best) {
    if (quantity.kind == Kind::kReaction && (quantity.j == 0 || reaction_.front().empty()))
      reaction_ = reactionParts(scene_, quantity.i);
    const std::unique_ptr<BoundedQuantity> bounded = boundedOf(quantity);
    scene::Work work("boxes of the motion", static_cast<double>(boxes_.size()));
    for (const std::vector<JointRanges>& box : boxes_) {
      if (is_first) {
        *best = bounded->over(box, options_, -1);
        best->sampled = 0;
        see(*best, best);
        is_first = false;
        continue;
      }
      EnvelopeBound mine = bounded->over(box, options_, best->certified);
      best->boxes += mine.boxes;
      if (mine.certified > best->certified) {  // then how much it is
        see(mine, best);
        mine = bounded->over(box, options_, -1);
        best->boxes += mine.boxes;
      }
      see(mine, best);
      best->certified = std::max(best->certified, mine.certified);
      best->lost = std::max(best->lost, mine.lost);
      work.done();
    }
  }

 private:
  /// One of all accelerations, which share their work.
  class Acceleration : public BoundedQuantity {
   public:
    Acceleration(AccelerationBounds* all, int i) : all_(all), i_(i) {}
    EnvelopeBound over(const std::vector<JointRanges>& box, const EnvelopeOptions& options,
                       double decide) override {
      return all_->over(i_, box, options, decide);
    }

   private:
    AccelerationBounds* all_;
    int i_;
  };

  std::unique_ptr<BoundedQuantity> boundedOf(const EnvelopeQuantity& quantity) {
    if (quantity.kind == Kind::kQdd) {
      if (!accelerations_) accelerations_ = std::make_unique<AccelerationBounds>(model_, hull_);
      return std::make_unique<Acceleration>(accelerations_.get(), quantity.i);
    }
    return boundedQuantity(model_, hull_, quantity,
                           quantity.kind == Kind::kReaction
                               ? reaction_[static_cast<std::size_t>(quantity.j)]
                               : std::vector<EnvelopePart>());
  }

  /// What the sweeps say at its worst state, not the polynomials.
  void see(const EnvelopeBound& mine, EnvelopeBound* best) const {
    if (mine.worst.q.empty()) return;
    const RunningError swept = sweptQuantity(scene_, mine.quantity, mine.worst);
    const double sampled = std::abs(swept.value()) - swept.bound();
    if (!(sampled > best->sampled)) return;
    best->sampled = sampled;
    best->worst = mine.worst;
    best->heavier = heavier_;
    best->higher = higher_;
  }

  const scene::Scene& scene_;
  const EnvelopeBoxes& boxes_;
  const EnvelopeOptions& options_;
  std::vector<bool> heavier_, higher_;
  std::vector<JointRanges> hull_;
  TrigonometricModel model_;
  std::array<std::vector<EnvelopePart>, 6> reaction_;
  std::unique_ptr<AccelerationBounds> accelerations_;
};

}  // namespace

std::vector<scene::JointRanges> hullOf(const EnvelopeBoxes& boxes) {
  std::vector<scene::JointRanges> out = boxes.front();
  const auto widen = [](scene::Range* a, const scene::Range& b) {
    *a = {std::min(a->low, b.low), std::max(a->high, b.high)};
  };
  for (const std::vector<scene::JointRanges>& box : boxes)
    for (std::size_t k = 0; k < out.size(); ++k) {
      widen(&out[k].q, box[k].q);
      widen(&out[k].qd, box[k].qd);
      widen(&out[k].qdd, box[k].qdd);
      if (out[k].tau) widen(&*out[k].tau, *box[k].tau);
    }
  return out;
}

std::vector<std::size_t> weighingLinks(const scene::Mechanism& mechanism) {
  std::vector<bool> moves(mechanism.links.size(), false);
  std::vector<std::size_t> out;
  for (std::size_t l = 1; l < mechanism.links.size(); ++l) {
    const scene::Link& link = mechanism.links[l];
    moves[l] =
        moves[static_cast<std::size_t>(link.parent)] || link.joint.kind != scene::JointKind::kFixed;
    if (moves[l] && !link.inertia.mass.isLiteralZero()) out.push_back(l);
  }
  return out;
}

EnvelopeBoxes boxesAlong(const std::filesystem::path& file, const scene::Scene& scene,
                         const std::vector<std::string>& quantities) {
  StatesReader reader(file, scene.mechanism, {{}, true, true});  // a recording has more columns
  const bool is_driven = std::find(quantities.begin(), quantities.end(), "qdd") != quantities.end();
  const auto need = [&](const char* group, const char* of) {
    if (!reader.gives(group))
      throw scene::InputError({file.string()}, fmt::format("no columns of {0}, expected {0}1 to "
                                                           "{0}{1}, which {2} needs",
                                                           group, scene.mechanism.dof(), of));
  };
  need("qd", "a motion");
  if (is_driven) need("tau", "qdd");
  if (!is_driven || quantities.size() > 1) need("qdd", "a motion");
  std::vector<JointRanges> rows, last;
  EnvelopeBoxes out;
  const auto hull = [](const scene::Range& a, const scene::Range& b) {
    return scene::Range{std::min(a.low, b.low), std::max(a.high, b.high)};
  };
  scene::State<double> state;
  bool is_first = true;
  while (reader.next(&state)) {
    std::vector<JointRanges> row;
    for (std::size_t k = 0; k < state.qd.size(); ++k) {
      const auto point = [](double x) { return scene::Range{x, x}; };
      row.push_back({point(state.x[k].q), point(state.qd[k]),
                     point(state.qdd.empty() ? 0 : state.qdd[k]), std::nullopt});
      if (is_driven) row.back().tau = point(state.tau[k]);
    }
    if (out.empty()) {
      out.push_back(row);
    } else {
      if (is_first) out.clear();
      is_first = false;
      out.push_back(row);
      for (std::size_t k = 0; k < row.size(); ++k) {
        JointRanges& r = out.back()[k];
        r.q = hull(r.q, last[k].q);
        r.qd = hull(r.qd, last[k].qd);
        r.qdd = hull(r.qdd, last[k].qdd);
        if (is_driven) r.tau = hull(*r.tau, *last[k].tau);
      }
    }
    last = row;
  }
  return out;
}

std::vector<EnvelopeBound> envelopeBounds(const scene::Scene& scene, const EnvelopeBoxes& boxes,
                                          const EnvelopeOptions& options,
                                          const std::function<void(const std::string&)>& stage) {
  const std::vector<EnvelopeQuantity> quantities =
      envelopeQuantities(scene.mechanism.dof(), options.quantities);
  requireAnswerable(scene, boxes, quantities, options);
  const bool is_uncertain = options.masses != scene::Rational(0);
  const std::vector<std::size_t> links =
      is_uncertain ? weighingLinks(scene.mechanism) : std::vector<std::size_t>();
  const std::vector<scene::UncertainParameter>& parameters = options.parameters;
  const std::size_t scenes = std::size_t{1} << (links.size() + parameters.size());
  std::vector<EnvelopeBound> out(quantities.size());
  scene::Work work("quantities", static_cast<double>(scenes * (1 + quantities.size())));
  for (std::size_t heavy = scenes; heavy-- > 0;) {  // the heaviest first: often it is the worst
    std::vector<bool> heavier, higher;
    for (std::size_t k = 0; k < parameters.size(); ++k)
      higher.push_back((heavy >> (links.size() + k) & 1) != 0);
    scene::Scene mine = atCorner(scene, parameters, higher);
    for (std::size_t k = 0; k < links.size(); ++k) {
      heavier.push_back((heavy >> k & 1) != 0);
      const scene::Rational share =
          heavier.back() ? options.masses : scene::Rational(-options.masses);
      scale(1 + share, &mine.mechanism.links[links[k]].inertia);
    }
    stage("M and g as polynomials");
    OneScene of(mine, boxes, options, heavier, higher);
    work.done();
    for (std::size_t k = 0; k < quantities.size(); ++k) {
      stage(quantities[k].name());
      of.take(quantities[k], heavy + 1 == scenes, &out[k]);
      work.done();
    }
  }
  for (EnvelopeBound& bound : out)
    bound.is_reached =
        bound.certified <= options.ratio * bound.sampled || bound.certified <= 2 * bound.lost;
  return out;
}

std::vector<EnvelopeBound> envelopeBounds(const scene::Scene& scene,
                                          const std::vector<JointRanges>& ranges,
                                          const EnvelopeOptions& options,
                                          const std::function<void(const std::string&)>& stage) {
  return envelopeBounds(scene, ranges.empty() ? EnvelopeBoxes() : EnvelopeBoxes{ranges}, options,
                        stage);
}

}  // namespace dynwitness::crosscheck
