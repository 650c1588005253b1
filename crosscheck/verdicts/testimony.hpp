// SPDX-License-Identifier: GPL-3.0-or-later
// What the witnesses of one scene say, state by state: asked once, judged by all who listen.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "crosscheck/verdicts/backward_error.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/tally.hpp"
#include "crosscheck/verdicts/truth.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

class OutsideClaims;

/// What one witness said about one quantity at one state.
struct Testimony {
  std::string witness;
  Answer answer;
  std::string failure;  ///< not empty: the witness threw this, and there is no answer
  /// Of qdd with a bound in the equations (Answer::residual_bound), which is then what judges it.
  std::optional<Residual> residual = {};
  double condition = 0;     ///< BackwardError::condition(), where there is a residual
  bool is_control = false;  ///< by the run's own control
};

/// All witnesses of a scene.
class Hearing {
 public:
  Hearing(const PreparedScene& scene, const std::vector<WitnessKind>& kinds,
          const Options& options);

  /// Takes the witnesses out that cannot hold the scene: one check each, not answerable, says why;
  /// and one for each quantity that another leaves out for this scene. What a program says besides
  /// quantities is judged here. A program that fails is
  /// taken out as well, but held against the run: that it was asked was somebody's wish.
  std::vector<CheckResult> dismissRefused();

  /// What dismissRefused() found out about programs that testify (--engine): that one has failed,
  /// or does something in a way of its own. By witness.
  const std::vector<std::pair<std::string, std::string>>& remarks() const { return remarks_; }

  /// Names of the witnesses that answer the quantity, in the order of their testimonies.
  std::vector<std::string> answering(Quantity quantity) const;

  using Listener = std::function<void(int index, const scene::State<double>& state,
                                      const std::vector<Testimony>& said)>;
  /// Asks each of them at each of the options' states.
  void hear(Quantity quantity, const Listener& listener);

  /// The residuals of answers qdd that bring a limit for them; hear() has done it for those it
  /// asks.
  void putIntoEquations(const scene::State<double>& state, std::vector<Testimony>& said);

 private:
  struct Seat {
    std::string name;
    MadeWitness witness;
    bool isAsked(Quantity quantity) const;
  };
  scene::State<double> drawn(int index) const;
  std::vector<CheckResult> claimsOf(OutsideClaims& claims, const std::string& witness,
                                    const PreparedScene& scene,
                                    const std::vector<scene::State<double>>& states);

  PreparedScene scene_;
  const Options& options_;
  std::vector<Seat> seats_;
  std::vector<std::pair<std::string, std::string>> remarks_;
  std::unique_ptr<BackwardError> backward_error_;
  std::unique_ptr<Truth> truth_;
};

/// One quantity, each pair of the witnesses that answer it.
class PairComparison {
 public:
  /// @param with_control  the run's own control testifies after these witnesses
  PairComparison(Quantity quantity, std::vector<std::string> witnesses, const Options& options,
                 bool with_control = false);
  /// @param excuse  why the quantity does not exist at this state; empty: it does
  void add(int index, const std::vector<Testimony>& said, const std::string& excuse = {});
  std::vector<CheckResult> results() const;

 private:
  std::vector<Tally> tallies_;
};

}  // namespace dynwitness::crosscheck
