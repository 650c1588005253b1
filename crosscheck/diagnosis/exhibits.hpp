// SPDX-License-Identifier: GPL-3.0-or-later
// What a witness said at chosen states, each answer judged against the certified truth.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/diagnosis/examine.hpp"
#include "crosscheck/verdicts/backward_error.hpp"
#include "crosscheck/verdicts/truth.hpp"
#include "crosscheck/witnesses/engine_bound.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

/** The questions. They isolate terms, A, B, C, D being seeded states:

        0 A   1 B   2 C             all of q, qd, qdd
        3 A, qd = qdd = 0           gravity, springs and loads
        4 A, qd = 0                 and M qdd
        5 A, qdd = 0                and c and friction: what is odd in qd is friction
        6 A, qdd = 0, -qd
        7 A, qdd = 0, 2 qd          what is even and grows fourfold is c
        8 the mechanism at rest position, moving as in B
        9 D */
enum ChosenState { kGeneric = 0, kStill = 3, kPushed = 4, kMoving = 5, kBackward = 6, kFaster = 7 };
inline constexpr int kChosenStates = 10;
std::vector<scene::State<double>> chosenStates(const scene::Mechanism& mechanism,
                                               const std::string& name, std::uint64_t seed,
                                               bool single);
/// Whether a quantity has something new to say at that state.
bool isAskedAt(Quantity quantity, int state);

/// One answer. qdd is judged by what it leaves of the equations, so it is kept as these: the tau
/// that was given is "said" for the one that goes with qdd.
struct Exhibit {
  Quantity asked = Quantity::kM, compared = Quantity::kM;
  int index = 0;               ///< of the chosen state
  scene::State<double> state;  ///< at which `compared` is asked
  Eigen::MatrixXd said, truth, bound;
  /// What `compared` may lose at that state, where the bound is of what solving for qdd may lose.
  Eigen::MatrixXd sweep_bound;
  Eigen::MatrixXd error;  ///< proven distance from the truth, at least
  bool is_wrong = false;
  double digits = 0, size = 0;  ///< correct digits against the largest entry, that entry
  std::string failure;          ///< no answer: why
  bool is_impossible = false;   ///< then because there is no such number: M is singular
};

/// Asks one witness and judges.
class Bench {
 public:
  /// @param factor  of what double loses: 2^29 for single precision
  Bench(const scene::Scene& scene, Witness& witness, double factor);
  Exhibit ask(Quantity quantity, const scene::State<double>& state, int index);

 private:
  Witness& witness_;
  double factor_;
  EngineBound bound_;
  Truth truth_;
  BackwardError backward_error_;
};

}  // namespace dynwitness::crosscheck
