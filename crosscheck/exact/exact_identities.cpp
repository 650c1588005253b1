// SPDX-License-Identifier: GPL-3.0-or-later
// The identities over the prime field.
#include <algorithm>

#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/laws/compiled_identities.hpp"
#include "crosscheck/laws/point_laws.hpp"
#include "crosscheck/verdicts/within_bounds.hpp"

namespace dynwitness::crosscheck {

Inquiry identityInquiry(const scene::Mechanism& mechanism) {
  Inquiry inquiry;
  inquiry.checks = inWords(Identities::words(mechanism));
  inquiry.ask = [&](const FieldNumbers& number, const scene::State<PrimeField>& state,
                    const std::vector<char>& wanted) {
    SweptMechanism<PrimeField> swept(mechanism, number);
    return Identities::wantedSides(mechanism, swept.at(state), wanted);
  };
  return inquiry;
}

const std::vector<std::string>& exactCheckNames() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names = {"same"};
    for (const LawWords& words : Identities::words()) names.emplace_back(words.name);
    for (const LawWords& words : PointLaws::words()) names.emplace_back(words.name);
    for (const char* name : {"regressor", "closures", "reactions of the whole mechanism",
                             "springs between points", "closed loops", "hybrid dynamics",
                             "operational space", "least constraint", "closed and hybrid dynamics"})
      names.emplace_back(name);
    std::vector<std::string> once;
    for (const std::string& name : names)
      if (std::find(once.begin(), once.end(), name) == once.end()) once.push_back(name);
    return once;
  }();
  return kNames;
}

}  // namespace dynwitness::crosscheck
