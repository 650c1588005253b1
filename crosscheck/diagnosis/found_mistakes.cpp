// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/found_mistakes.hpp"

#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace dynwitness::crosscheck::explaining {

Explanation wordsOf(const Hypothesis& h) {
  return {h.rule, h.link, h.at_joint, h.sentence, {}};
}

Explanation wordsOf(const Suspect& suspect, const VectorXd& added, const VectorXd& uncertainty) {
  Explanation out{suspect.rule, suspect.link, suspect.at_joint, "", {}};
  std::string values;
  for (std::size_t k = 0; k < suspect.names.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    Estimate e{suspect.names[k], suspect.unit, suspect.scene[k], suspect.scene[k] + added(i),
               uncertainty(i)};
    if (suspect.names.size() > 1 && std::abs(added(i)) <= uncertainty(i))
      continue;  // as it should be
    values +=
        fmt::format("{}{} = {:.10g} +- {:.1g} {}{}for {:.10g}", values.empty() ? "" : ", ", e.name,
                    e.value, e.uncertainty, e.unit, e.unit.empty() ? "" : " ", e.scene);
    out.estimates.push_back(e);
  }
  out.sentence = fmt::format("{}: {}", suspect.what, values);
  return out;
}

Found findingOf(const Case& all, const Belief& belief, std::vector<Explanation> parts,
                const Misfit& misfit) {
  CheckFinding out;
  out.parts = std::move(parts);
  out.explains = true;
  out.residual = misfit.share;
  out.residual_ulp = misfit.ulp;
  out.residual_relative = misfit.relative;
  all.compareOthers(belief, out);
  return {out, belief};
}

}  // namespace dynwitness::crosscheck::explaining
