// SPDX-License-Identifier: GPL-3.0-or-later
// Which of a scene's numbers are kept, and which are put in at random: what exact checks decide on.
#pragma once

#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {

/// Whether the parameters of a scene are the numbers that it gives, or indeterminates: then the
/// verdict covers every robot with that structure.
enum class Parameters { kAsWritten, kRandom };
/// "as written", "random"
const char* name(Parameters parameters);

/// The square root of a rational that has a rational one.
bool rationalRoot(const scene::Rational& square, scene::Rational* root);

}  // namespace dynwitness::crosscheck
