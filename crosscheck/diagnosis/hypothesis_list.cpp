// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/hypothesis_list.hpp"

#include <utility>

#include <fmt/format.h>

namespace dynwitness::crosscheck {

void HypothesisList::add(const std::string& rule, const std::string& sentence,
                         std::function<void(Belief&)> apply) {
  out_.push_back({rule, -1, false, sentence, std::move(apply)});
}

void HypothesisList::at(const std::string& rule, std::size_t i, bool at_joint,
                        const std::string& sentence, std::function<void(Belief&)> apply) {
  const TextbookLink& link = model_.links[i];
  const std::string where =
      at_joint ? fmt::format("joint '{}'", link.joint) : fmt::format("link '{}'", link.name);
  out_.push_back(
      {rule, static_cast<int>(i), at_joint, fmt::format(sentence, where), std::move(apply)});
}

void HypothesisList::each(const std::string& rule, bool at_joint, const Applies& applies,
                          const std::string& sentence, const Edit& edit,
                          const std::function<void(Formulas&)>& formula) {
  int count = 0;
  for (std::size_t i = 0; i < model_.links.size(); ++i) {
    if (!applies(model_.links[i])) continue;
    ++count;
    at(rule, i, at_joint, sentence, [edit, formula, i](Belief& b) {
      edit(b.model.links[i]);
      formula(b.formulas);
    });
  }
  if (count < 2) return;
  add(rule, fmt::format(sentence, at_joint ? "every joint" : "every link"),
      [edit, formula, applies](Belief& b) {
        for (TextbookLink& link : b.model.links)
          if (applies(link)) edit(link);
        formula(b.formulas);
      });
}

void HypothesisList::formula(const std::string& rule, const std::string& sentence,
                             const std::function<void(Formulas&)>& edit) {
  add(rule, sentence, [edit](Belief& b) { edit(b.formulas); });
}

}  // namespace dynwitness::crosscheck
