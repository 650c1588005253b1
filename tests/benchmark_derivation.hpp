// SPDX-License-Identifier: GPL-3.0-or-later
// How long the derivation of M, c and g takes, and how much memory, with SymPy's beside it.
#pragma once

#include <benchmark/benchmark.h>

namespace dynwitness::benchmarks {

/// Adds "derivation/...": model to straight-line program, our scene in memory; where Debian's Python
/// has SymPy, Kane's method on the same scene, once.
void registerDerivations();

/// Takes a run of theirs. @return whether it was one
bool keepDerivation(const benchmark::BenchmarkReporter::Run& run);
/// The goals of the derivation, and what was measured.
void printDerivations();

}  // namespace dynwitness::benchmarks
