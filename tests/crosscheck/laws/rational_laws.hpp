// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of identities.hpp over the rationals: compiled in files of their own, as those over the
// field are.
#pragma once

#include "crosscheck/laws/compiled_identities.hpp"
#include "tests/fixtures/compiled_sweeps.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_SWEPT(extern, fixtures::Q, fixtures::RationalNumbers);
DYNWITNESS_IDENTITIES(extern, fixtures::Q);

}  // namespace dynwitness::crosscheck
