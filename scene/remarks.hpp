// SPDX-License-Identifier: GPL-3.0-or-later
// What a file says that is right by its format and mostly a slip: words that nobody reads, degrees
// where radians stand, links that were left without inertia.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::scene {

/// How an angle is spelled where it came from.
enum class AngleSpelling {
  kExpression,  ///< 45*pi/180
  kText,        ///< "45*pi/180", in quotes
  kDecimal      ///< 0.7853981633974483
};

/** "45 rad is 7.2 turns; if it is in degrees, write 45*pi/180". Empty where the turns are 1.0 or
    fewer as they are printed: a whole turn to some digits is one. */
std::string moreThanATurn(double angle, AngleSpelling spelling);

/** What is remarkable in a URDF, one "FILE:LINE: ..." each:

    - elements and attributes within <link>, <inertial> and <joint> that URDF has not, where one
      that it has is near (nearest_name.hpp). Other foreign words are extensions, and passed over
      without a remark, as is what stands in a namespace.
    - rpy of more than a turn.
    - limits whose lower end is above the upper; those of revolute joints that are more than two
      turns in radians, and no more than two turns in degrees: beyond, they are meant as none.
    - joints that move no <inertial> at all.

    Empty where the text is no URDF: the reader says why. */
std::vector<std::string> remarksOnUrdf(const std::string& text, const std::string& file);

/** Angles of more than a turn in a TOML scene: placements, axes of inertia, the start of revolute
    joints. Those that are spelled with pi are meant.
    @param file  for messages about the start */
std::vector<std::string> remarksOnAngles(const Scene& scene, const std::filesystem::path& file);

/// Of a URDF, or of the scene that the file is otherwise; none of MJCF.
std::vector<std::string> remarksOn(const Scene& scene, const std::filesystem::path& file);
/// Of a file that may be no scene: those of a URDF.
std::vector<std::string> remarksOnFile(const std::filesystem::path& file);

}  // namespace dynwitness::scene
