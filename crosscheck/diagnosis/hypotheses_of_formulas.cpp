// SPDX-License-Identifier: GPL-3.0-or-later
#include <string>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/diagnosis/hypothesis_list.hpp"
#include "crosscheck/diagnosis/textbook_links.hpp"

namespace dynwitness::crosscheck {

void addFormulas(HypothesisList& list) {
  for (const bool in_tau : {true, false}) {
    const std::string where = in_tau ? "" : ", not in tau";
    const auto factor = [&](const std::string& rule, const std::string& what, double of_M,
                            double of_c) {
      list.formula(rule, what + where, [=](Formulas& f) {
        f.factor_M = of_M;
        f.factor_c = of_c;
        f.factor_in_tau = in_tau;
      });
    };
    factor("c_twice", "c counted twice", 1, 2);
    factor("c_half", "half of c", 1, 0.5);
    factor("qd_ignored", "c left out", 1, 0);
    factor("half_inertia", "half of M", 0.5, 1);
    factor("double_inertia", "M twice as large", 2, 1);
    factor("half_inertia", "half of M and of c", 0.5, 0.5);
    factor("double_inertia", "M and c twice as large", 2, 2);
    list.formula("c_times_qd", "c multiplied by the rates, entry by entry" + where,
                 [in_tau](Formulas& f) {
                   f.c_times_qd = true;
                   f.factor_in_tau = in_tau;
                 });
  }
  list.formula("double_inertia", "kinetic energy twice as large",
               [](Formulas& f) { f.factor_kinetic = 2; });
  list.formula("half_inertia", "half of the kinetic energy",
               [](Formulas& f) { f.factor_kinetic = 0.5; });
  list.formula("qdd_ignored", "accelerations of the joints ignored in tau",
               [](Formulas& f) { f.qdd_ignored = true; });
  for (const bool in_tau : {false, true}) {
    list.formula("triangle_only", "only the upper triangle of M filled", [in_tau](Formulas& f) {
      f.triangle = Formulas::Triangle::kUpper;
      f.triangle_in_tau = in_tau;
    });
    list.formula("triangle_only", "only the lower triangle of M filled", [in_tau](Formulas& f) {
      f.triangle = Formulas::Triangle::kLower;
      f.triangle_in_tau = in_tau;
    });
  }
  list.formula("gyroscopic_missing", "w x I w left out of the links' moments",
               [](Formulas& f) { f.gyroscopic = false; });
  list.formula("bias_missing",
               "accelerations that come of velocities alone (dJ/dt qd) left out of c",
               [](Formulas& f) { f.point_bias = f.turn_bias = false; });
  list.formula("bias_missing",
               "accelerations of points that come of velocities (dJv/dt qd) left out of c",
               [](Formulas& f) { f.point_bias = false; });
  list.formula("bias_missing",
               "angular accelerations that come of velocities (dJw/dt qd) left out of c",
               [](Formulas& f) { f.turn_bias = false; });
  const std::vector<TextbookLink>& links = list.model().links;
  for (const Formulas::Bias bias : {Formulas::Bias::kMoved, Formulas::Bias::kSpatial}) {
    const std::string what = bias == Formulas::Bias::kMoved
                                 ? "accelerations that a moved axis makes (w x z qd) left out at {}"
                                 : "v x Z qd left out of the spatial acceleration at {}";
    for (std::size_t i = 0; i < links.size(); ++i)
      if (moves(links[i]))
        list.at("bias_missing", i, true, what, [i, bias](Belief& b) {
          b.formulas.joint_bias = bias;
          b.formulas.biased_joint = static_cast<int>(i);
        });
    list.formula("bias_missing", fmt::format(what, "every joint"),
                 [bias](Formulas& f) { f.joint_bias = bias; });
  }
  for (std::size_t i = 0; i < links.size(); ++i)
    if (hasParent(links[i]))
      list.at("gyroscopic_missing", i, false, "w x I w left out of the moment of {}",
              [i](Belief& b) { b.formulas.not_gyroscopic = static_cast<int>(i); });
  list.formula("centrifugal_missing", "c without the squares of rates (Coriolis terms alone)",
               [](Formulas& f) { f.products = Formulas::Products::kMixed; });
  list.formula("centrifugal_missing", "w x (w x r) left out of the accelerations of points",
               [](Formulas& f) { f.centripetal = false; });
  list.formula("coriolis_missing", "2 w x v of slides left out",
               [](Formulas& f) { f.slide_coriolis = false; });
  list.formula("coriolis_missing",
               "c without products of different rates (centrifugal terms alone)",
               [](Formulas& f) { f.products = Formulas::Products::kSquares; });
}

void addSeries(HypothesisList& list) {
  constexpr int kMostTerms = 14;
  for (const bool reduced : {false, true})
    for (int terms = 1; terms <= kMostTerms; ++terms)
      for (const bool in_world : {false, true}) {
        const auto add = [&](const std::string& what, int sine, int cosine) {
          list.formula("sine_series",
                       fmt::format("{} by {} terms of the series{}{}", what, terms,
                                   reduced ? " (angles brought to [-pi, pi])" : "",
                                   in_world ? ", all in world axes" : ""),
                       [=](Formulas& f) {
                         f.sine_terms = sine;
                         f.cosine_terms = cosine;
                         f.reduced = reduced;
                         f.in_world = in_world;
                       });
        };
        add("sine and cosine", terms, terms);
        add("sine", terms, 0);
        add("sine and cosine (one term more)", terms, terms + 1);
        add("cosine", 0, terms);
      }
}

/// The state that was asked before, in part.
void addStale(HypothesisList& list) {
  const auto add = [&](const std::string& what, const Stale& stale) {
    list.add("stale_state", what + " of the question before used again",
             [stale](Belief& b) { b.stale = stale; });
  };
  add("positions", {true, false, false});
  add("positions and rates", {true, true, false});
  add("the state", {true, true, true});
  add("rates", {false, true, false});
  add("accelerations", {false, false, true});
}

}  // namespace dynwitness::crosscheck
