// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/coupled.hpp"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "scene/own_rates.hpp"

namespace dynwitness::crosscheck {
namespace {

/** Asks a witness about the tree and sums over followers here. Bounds: the answers of the tree
    enter as RunningError, with what the witness says of their error and with what the rounding of
    the tree's state (positions, rates and accelerations of followers) does to them, which our sweep
    of the tree tells. */
class Summed : public OverTree {
 public:
  Summed(std::unique_ptr<Witness> of_tree, const PreparedScene& scene)
      : of_tree_(std::move(of_tree)),
        mechanism_(scene.mechanism()),
        in_double_(mechanism_, scene::RealNumbers<double>(mechanism_)),
        with_bounds_(mechanism_, RunningErrorNumbers(mechanism_)),
        rotors_(scene.mechanism().hasGearedRotors()),
        held_(scene::hasRotorsHeldAtRest(scene.mechanism())),
        tree_(scene.tree()) {}

  Witness& ofTree() const override { return *of_tree_; }
  scene::State<double> onTree(const scene::State<double>& state) const override {
    return in_double_.onTree(state);
  }
  std::vector<std::pair<Quantity, std::string>> leftOut() const override {
    std::vector<std::pair<Quantity, std::string>> out;
    if (const auto* partial = dynamic_cast<const PartialWitness*>(of_tree_.get()))
      for (auto& [quantity, reason] : partial->leftOut())
        if (quantity != Quantity::kQdd) out.emplace_back(quantity, std::move(reason));
    if (rotors_ && of_tree_->answers(Quantity::kMomentum))
      out.emplace_back(Quantity::kMomentum,
                       "rotors geared to several rates turn in the world of the tree that it is "
                       "asked about, and have no part in the mechanism's momentum");
    if (held_ && of_tree_->answers(Quantity::kReactions))
      out.emplace_back(
          Quantity::kReactions,
          "a fixed joint holds the link of a gyroscopic rotor in the world: in the tree that "
          "this witness is asked about the rotor turns in the world itself, so that "
          "the joint does not bear it");
    if (!answers(Quantity::kQdd))
      out.emplace_back(Quantity::kQdd,
                       fmt::format("where joints follow others qdd is solved from M and tau of the "
                                   "tree, and {} does not answer both",
                                   name()));
    return out;
  }
  const std::string& name() const override { return of_tree_->name(); }
  bool answers(Quantity quantity) const override {
    if (rotors_ && quantity == Quantity::kMomentum) return false;
    if (held_ && quantity == Quantity::kReactions) return false;
    if (quantity != Quantity::kQdd) return of_tree_->answers(quantity);
    return of_tree_->answers(Quantity::kM) && of_tree_->answers(Quantity::kTau);
  }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    Answer out;
    out.value = value(quantity, state);
    bool lossy = false;
    out.bound = bound(quantity, state, true, &lossy);
    if (lossy) out.known_loss = (out.bound - bound(quantity, state, false, &lossy)).cwiseMax(0.0);
    return out;
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    return in_double_(quantity, state, [&](Quantity asked, const scene::State<double>& tree) {
      return of_tree_->value(asked, tree);
    });
  }

 private:
  Eigen::MatrixXd bound(Quantity quantity, const scene::State<double>& state, bool with_loss,
                        bool* lossy) {
    const scene::State<RunningError> uncertain = runningErrorState(state, mechanism_);
    const MatrixX<RunningError> out = with_bounds_(
        quantity, uncertain, [&](Quantity asked, const scene::State<RunningError>& tree) {
          scene::State<double> rounded;  // what the witness was asked
          rounded.x = in_double_.onTree(state).x;
          for (const RunningError& x : tree.qd) rounded.qd.push_back(x.value());
          for (const RunningError& x : tree.qdd) rounded.qdd.push_back(x.value());
          for (const RunningError& x : tree.tau) rounded.tau.push_back(x.value());
          const Answer said = of_tree_->answer(asked, rounded);
          const MatrixX<RunningError> ours = NewtonEuler::answer(tree_, asked, tree);
          MatrixX<RunningError> enclosed(said.value.rows(), said.value.cols());
          for (Eigen::Index j = 0; j < enclosed.cols(); ++j)
            for (Eigen::Index i = 0; i < enclosed.rows(); ++i) {
              double error = said.bound(i, j);
              if (said.known_loss.size() > 0) {
                *lossy = true;
                if (!with_loss) error = std::max(0.0, error - said.known_loss(i, j));
              }
              enclosed(i, j) = RunningError(said.value(i, j), error + ours(i, j).bound());
            }
          return enclosed;
        });
    return out.unaryExpr([](const RunningError& x) { return x.bound(); });
  }

  std::unique_ptr<Witness> of_tree_;
  scene::Mechanism mechanism_;
  Coupling<double> in_double_;
  Coupling<RunningError> with_bounds_;
  bool rotors_;  ///< geared to several rates
  bool held_;    ///< gyroscopic ones among them on links that fixed joints hold
  Setup<RunningError> tree_;
};

}  // namespace

WitnessKind overTree(WitnessKind kind, Lacking lacking) {
  if (!kind.info.conventions.empty())
    kind.info.conventions +=
        "\n"
        "followers (mimic): the tree without them, every joint with a rate of its own, is what it "
        "is asked "
        "about; M = G'MG, c = G'c, g = G'g, tau = G'tau are summed here, and qdd solves M qdd = "
        "tau - bias\n"
        "rotors geared to several rates: links of that tree, on revolute joints in the world that "
        "turn as the gears say; a gyroscopic one " +
        std::string(lacking == Lacking::kRefused ? "is refused" : "turns on the link it is on");
  kind.make = [make = kind.make, lacking](const PreparedScene& scene) -> MadeWitness {
    if (!scene.mechanism().hasCoupledRates()) return make(scene);
    if (std::string reason = scene::hasNoTree(scene.mechanism()); !reason.empty())
      return Refusal{reason};
    if (lacking == Lacking::kRefused && scene::hasLackingLinks(scene.mechanism()))
      return Refusal{
          "a rotor geared to several rates is gyroscopic: as a body of its own it would leave its "
          "link an inertia that no file has"};
    MadeWitness of_tree = make(scene.tree());
    if (of_tree.isRefused()) return of_tree;
    return std::make_unique<Summed>(std::move(of_tree).value(), scene);
  };
  return kind;
}

}  // namespace dynwitness::crosscheck
