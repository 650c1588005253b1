// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/crosscheck/conductor/faulty_field.hpp"

namespace dynwitness::recursive {

DYNWITNESS_SWEEPS(, fixtures::Faulty);
DYNWITNESS_MODELS(, fixtures::Faulty, fixtures::FaultyNumbers);

}  // namespace dynwitness::recursive
