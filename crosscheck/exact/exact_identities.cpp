// SPDX-License-Identifier: GPL-3.0-or-later
// The identities over the prime field: apart from exact.cpp, because both are long to compile.
#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/laws/identities.hpp"
#include "crosscheck/verdicts/within_bounds.hpp"

namespace dynwitness::crosscheck {

Inquiry identityInquiry(const scene::Mechanism& mechanism) {
  Inquiry inquiry;
  inquiry.checks = inWords(Identities::words(mechanism));
  inquiry.ask = [&](const FieldNumbers& number, const scene::State<PrimeField>& state) {
    return Identities::sides(mechanism, SweptMechanism<PrimeField>(mechanism, number).at(state));
  };
  return inquiry;
}

}  // namespace dynwitness::crosscheck
