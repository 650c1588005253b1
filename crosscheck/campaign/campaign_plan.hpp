// SPDX-License-Identifier: GPL-3.0-or-later
// What a campaign tries: a file of parts, each so many cases, numbered through from 0.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** Cases of one kind:

      kMechanisms  random mechanisms, a case each: exactly, and in double where states are asked for
      kScenes      scenes by states: case k is the whole crosscheck of one scene, at the states of
                   seed + k; scenes take turns
      kCommands    other commands of dynwitness, a case each: their exit status is the verdict */
struct CampaignPart {
  enum class Of { kMechanisms, kScenes, kCommands };
  Of of = Of::kMechanisms;
  long count = 0;       ///< cases
  long first = 0;       ///< kMechanisms: index of the first one
  int most_joints = 0;  ///< kMechanisms: most moving joints
  /// kMechanisms: of so many random ones the one that has the rarest pairs of features; 1: as they
  /// come.
  int draws = 1;
  int states = 0;                     ///< in double, a case; 0: nothing is asked in double
  std::vector<scene::Scene> scenes;   ///< kScenes
  std::vector<std::string> commands;  ///< kCommands: words of a command line, without the program
};

struct CampaignPlan {
  std::string title;
  std::uint64_t seed = 1;
  double error_probability = 0;  ///< chance at most that an exact check passes a wrong formula
  double seconds = 0;            ///< after which a case is given up
  std::vector<CampaignPart> parts;
  /// All that decides what a case is, scenes by a name for their content: equal for equal plans.
  std::string text;

  long cases() const;
};

/// One case: its part, and which of the part's cases it is.
struct CampaignCase {
  const CampaignPart* part;
  long index;
};
/// @throws std::out_of_range  unless 0 <= number < cases
CampaignCase caseOf(const CampaignPlan& plan, long number);

/// "mechanisms", "scenes", "commands"
const char* name(CampaignPart::Of of);

/** Reads a plan:

        title = "nightly"
        seed = 1                      # of everything
        error_probability = 1e-30     # the default
        seconds = 600                 # the default

        [[cases]]
        of = "mechanisms"
        count = 100000
        most_joints = 12              # the default
        draws = 4                     # 1 is the default
        states = 2                    # in double; 0 is the default

        [[cases]]
        of = "scenes"
        scenes = ["puma_560", "my_arm.urdf"]   # from the plan's folder
        count = 50
        states = 100

        [[cases]]
        of = "commands"
        commands = ["stability mass_ratio --quick", "check acrobot --engine 'python3 mine.py'"]

    @throws scene::InputError  with file and line, what was read and what is allowed */
CampaignPlan readCampaignPlan(const std::filesystem::path& file);

}  // namespace dynwitness::crosscheck
