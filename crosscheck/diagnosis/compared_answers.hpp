// SPDX-License-Identifier: GPL-3.0-or-later
// What an engine said beside what a belief predicts, and how far the two are apart. For the search
// of explanations (explain.cpp and what it includes) alone.
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/diagnosis/exhibits.hpp"
#include "crosscheck/diagnosis/textbook.hpp"

namespace dynwitness::crosscheck::explaining {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using State = scene::State<double>;
inline constexpr double kEps = std::numeric_limits<double>::epsilon();

/// Of its entries' magnitudes.
inline double largest(const MatrixXd& m) {
  return m.size() == 0 ? 0 : m.cwiseAbs().maxCoeff();
}

/// How far a prediction is from what was said.
struct Misfit {
  double share = 0;     ///< of the limit
  double ulp = 0;       ///< of the largest entry
  double relative = 0;  ///< to the largest entry
};

Misfit misfitOf(const Exhibit& exhibit, const MatrixXd& predicted, bool permuted);
void keepWorse(Misfit& all, const Misfit& one);

/// Which of the wrong quantities an explanation has to account for.
enum class Scope { kAll, kForces };

/// All that is compared with predictions.
class Case {
 public:
  Case(const TextbookModel& model, const std::vector<Exhibit>& exhibits,
       const std::vector<State>& chosen, Scope scope);

  const Belief& right() const { return right_; }
  const std::vector<const Exhibit*>& heads() const { return heads_; }
  const std::vector<const Exhibit*>& primary() const { return primary_; }

  /// Nothing: it is beyond its limit somewhere.
  std::optional<Misfit> whole(const Belief& belief) const;
  /// Quantities that are right, which the belief would have made wrong; and wrong ones that it does
  /// not account for.
  void compareOthers(const Belief& belief, CheckFinding& finding) const;
  /** Whether two beliefs give the same answers to all that the engine knows, at states that nobody
      has asked: to as many roundings as are allowed at those that were. */
  bool areOne(const Belief& one, const Belief& other) const;
  /// What is left of the misfits, head by head, in units of their limits; or predictions alone.
  /// @param glance  of M what it makes of qdd
  VectorXd stacked(const std::vector<const Exhibit*>& exhibits, const Belief& belief,
                   bool predicted_alone, bool glance = false) const;

 private:
  /// What is compared.
  MatrixXd predicted(const Textbook& textbook, const Belief& belief, const Exhibit& e) const;
  /// The same, of M only what it makes of qdd: one sweep for one a column.
  MatrixXd glanced(const Textbook& textbook, const Belief& belief, const Exhibit& e) const;
  State mixed(const Belief& belief, const Exhibit& e) const;
  /// What roundings are measured in. Forces are sums of terms that may cancel.
  double sizeOf(Quantity quantity, const MatrixXd& value, const State& state) const;
  /// A mistake may make the terms of a sum larger that cancel in it.
  Misfit misfitHere(const Textbook& textbook, const Belief& belief, const Exhibit& e,
                    const MatrixXd& told) const;

  Belief right_;
  const std::vector<State>& chosen_;
  std::vector<const Exhibit*> primary_, others_, heads_;
  std::map<Quantity, double> loose_;  ///< limit of a quantity that is known, of its size
};

}  // namespace dynwitness::crosscheck::explaining
