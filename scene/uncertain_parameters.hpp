// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters of a scene that are known between two numbers only: [envelope.parameters].
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::scene {

/// A named parameter that may be any number from `low` to `high`; in the parameter's own unit.
struct UncertainParameter {
  std::string name;
  Rational low, high;
};

/** The table [envelope.parameters] of a scene's TOML text, in the order of the scene's parameters:

        m2 = { relative = 0.1 }      from 0.9 to 1.1 times its value
        m3 = [0.8, 1.2]              from the first to the second, which its value lies between

    Numbers or expressions in the parameters, exact. None: the text has no such table.
    @throws InputError  no such parameter, a share below 0 or above 1, a range that is empty or
      without the value, a number that is none or not rational */
std::vector<UncertainParameter> uncertainParametersOf(const std::string& text, const Scene& scene);

/// The same of a file; none where it is no TOML file.
/// @throws InputError  as uncertainParametersOf(); the file cannot be read
std::vector<UncertainParameter> readUncertainParameters(const std::filesystem::path& file,
                                                        const Scene& scene);

/// Whether a file has the table; what stands in it is not looked at.
bool hasUncertainParameters(const std::filesystem::path& file, const Scene& scene);

/// The table as TOML, to stand behind writeEnvelope(); none: no text. What is read back is the
/// same.
std::string writeUncertainParameters(const std::vector<UncertainParameter>& parameters);

}  // namespace dynwitness::scene
