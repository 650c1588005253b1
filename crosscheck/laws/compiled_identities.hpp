// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of identities.hpp on the scalars of the crosscheck: compiled once each (swept_in_*.cpp
// the mechanism, identities_in_*.cpp both sides), and not again in every file that asks them.
#pragma once

#include "crosscheck/laws/identities.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/scalars/running_error.hpp"

// NOLINTBEGIN(bugprone-macro-parentheses) PREFIX extern: compiled elsewhere; empty: here
#define DYNWITNESS_SWEPT(PREFIX, T, NUMBERS)                                                 \
  PREFIX template class SweptMechanism<T>;                                                   \
  PREFIX template SweptMechanism<T>::SweptMechanism(const scene::Mechanism&, const NUMBERS&, \
                                                    recursive::Model<T>, recursive::Model<T>)

#define DYNWITNESS_IDENTITIES(PREFIX, T)                                              \
  PREFIX template std::vector<TwoSides<T>> Identities::sides(const scene::Mechanism&, \
                                                             SweptMechanism<T>&)

#define DYNWITNESS_WANTED_IDENTITIES(PREFIX, T)                     \
  PREFIX template std::vector<TwoSides<T>> Identities::wantedSides( \
      const scene::Mechanism&, SweptMechanism<T>&, const std::vector<char>&)
// NOLINTEND(bugprone-macro-parentheses)

namespace dynwitness::crosscheck {

DYNWITNESS_SWEPT(extern, RunningError, RunningErrorNumbers);
DYNWITNESS_IDENTITIES(extern, RunningError);
DYNWITNESS_SWEPT(extern, Ball, BallNumbers);
DYNWITNESS_IDENTITIES(extern, Ball);
DYNWITNESS_SWEPT(extern, PrimeField, FieldNumbers);
DYNWITNESS_IDENTITIES(extern, PrimeField);
DYNWITNESS_WANTED_IDENTITIES(extern, PrimeField);

}  // namespace dynwitness::crosscheck
