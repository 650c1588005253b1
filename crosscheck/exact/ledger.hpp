// SPDX-License-Identifier: GPL-3.0-or-later
// The ledger of a scene: sizes, zeros and their reasons, operations.
#pragma once

#include <cstdint>

#include "crosscheck/verdicts/ledger.hpp"
#include "crosscheck/witnesses/prepared_scene.hpp"

namespace dynwitness::crosscheck {

struct LedgerOptions {
  std::uint64_t seed = 1;
  double error_probability = 1e-30;  ///< that an entry called zero is not, that the rank is larger
};

/** Counted, not timed: what is left out of a large scene depends on its size alone, and is told.
    Linear in the joints but for M and c (up to 128 and 40 rates), and for base parameters (the cube
    of their number, up to 400). */
Ledger ledgerOf(const PreparedScene& prepared, const LedgerOptions& options = {});

}  // namespace dynwitness::crosscheck
