// SPDX-License-Identifier: GPL-3.0-or-later
// Campaigns over mechanisms that nobody chose: exact checks, and every witness in double.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "crosscheck/exact/exact.hpp"
#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

struct CampaignOptions {
  /// If it names no witnesses, all are asked but kernels, whose making takes ten times as long as
  /// all other checks together.
  ExactOptions exact;
  std::vector<WitnessKind> in_double = {};  ///< asked in double; empty: nothing is
  int states = 3;                           ///< seeded states a mechanism, in double
};

/// What is found among any number of mechanisms: counts, and the failures whole.
struct RandomCampaign {
  struct Failure {
    scene::Scene scene;
    std::vector<CheckResult> checks;  ///< those that do not agree
    std::vector<Finding> findings;    ///< who stands alone
  };
  int mechanisms = 0, joints = 0;  ///< how many were checked, and their moving joints together
  int checks = 0;                  ///< residuals that are zero, or are not
  int not_answerable = 0;          ///< of them
  /// Exact checks by CheckResult::name(): decided, with nothing to ask, not answerable.
  std::map<std::string, std::array<int, 3>> by_law;
  double error_probability = 0;  ///< the largest of all checks
  int plain = 0;                 ///< mechanisms of plain joints besides, in double
  long comparisons = 0;  ///< in double: of two witnesses, or of one and the truth, at a state
  std::map<std::string, int>
      asked;  ///< how many mechanisms each witness was asked about, in double
  /// What was not answerable in double, by the reason (names and numbers left out) and by the
  /// witness that refused a mechanism, or the quantity: how many checks.
  std::map<std::string, std::map<std::string, int>> unanswered;
  std::vector<Failure> failures;
};

/** Checks `count` random mechanisms exactly, each with exactChecks(), and in double: every pair of
    witnesses, and each against the certified truth, at the seed's states. Where a witness does not
    build the mechanism, all are asked in double about one of plain joints besides
    (JointKinds::kPlain, same seed and index), so that each of them has `count` mechanisms or more
    to testify about.

    A check that disagrees is a failure, and so is an exact one that is not answerable. Memory does
    not grow with `count`, unless failures do; the result is the same however many processes there
    are.
    @param processes  how many of this processor's cores to use
    @param progress   called as mechanisms are done, with the number of those done; may be empty */
RandomCampaign crosscheckRandom(int count, int max_joints, const CampaignOptions& options,
                                int processes = 1, const std::function<void(int)>& progress = {});

/// The same about the random mechanisms of these indices.
RandomCampaign crosscheckRandomOf(const std::vector<int>& indices, int max_joints,
                                  const CampaignOptions& options, int processes = 1,
                                  const std::function<void(int)>& progress = {});

/// The same about the random mechanism of this index, which the caller has drawn.
RandomCampaign crosscheckDrawn(const scene::Scene& scene, int index, int max_joints,
                               const CampaignOptions& options);

/// What does not agree about one mechanism of the caller's choice: exactly, and in double where
/// that is asked for. Nobody is asked about another one instead.
RandomCampaign::Failure disagreementsAbout(const scene::Scene& scene,
                                           const CampaignOptions& options);

/// For people: what failed, and the command and the scene file that show it again.
std::string describeFailure(const RandomCampaign::Failure& failure);

}  // namespace dynwitness::crosscheck
