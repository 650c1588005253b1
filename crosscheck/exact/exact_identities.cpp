// SPDX-License-Identifier: GPL-3.0-or-later
// The identities over the prime field.
#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/laws/compiled_identities.hpp"
#include "crosscheck/verdicts/within_bounds.hpp"

namespace dynwitness::crosscheck {

Inquiry identityInquiry(const scene::Mechanism& mechanism) {
  Inquiry inquiry;
  inquiry.checks = inWords(Identities::words(mechanism));
  inquiry.ask = [&](const FieldNumbers& number, const scene::State<PrimeField>& state) {
    SweptMechanism<PrimeField> swept(mechanism, number);
    return Identities::sides(mechanism, swept.at(state));
  };
  return inquiry;
}

}  // namespace dynwitness::crosscheck
